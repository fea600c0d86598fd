/* Final gathering.
 *
 * The hemisphere is divided into cells of equal cosine-weighted size.  Each gets one ray, and
 * those where photons came from get more; a cell counts the mean of its rays, so that the number
 * of rays in it, which does not depend on what they see, changes the noise and nothing else.  The
 * gradients come from the differences between cells: with a step to the side the border of two
 * cells moves by the step over the distance of the nearer.
 *
 * A ray that ends where the irradiance was estimated over a disk as large as the ray is long would
 * show that disk's blur: there the light is found anew, by shadow rays and a small gathering, once
 * a ray at most: where a disk is larger than the object, every hit is near.  A ray that goes on and
 * on, as by total reflection, is ended by dice that make up for it.
 *
 * Media dim a ray and send it what they give off, what they scatter of a lamp from a place drawn at
 * random, and the photons in them.
 * SPDX-License-Identifier: Apache-2.0 */
#include "eye/final_gather.h"

#include "base/work.h"
#include "eye/air_int.h"
#include "math/sample.h"

#include <string.h>

enum {
    CELLS_MAX = 4096,
    ROWS_MAX = 64,
    GUIDED_PART = 3,     /* one in so many rays goes where photons came from */
    GUIDE_PHOTONS = 64,  /* looked at for that */
    NEAR_RAYS = 24,      /* of the small gathering */
    NEAR_RAYS_KEPT = 64, /* if it serves other rays too */
    CHAIN_MAX = 64,      /* mirrors and panes a ray may pass */
    CHAIN_SURE = 4,      /* and those before the dice are thrown for going on at all */
    FEW_RAYS = 4
};

/* A ray shorter than this many radii of the estimate where it ends sees its blur. */
#define NEAR_RADII 0.5

/* How far those may be, in search radii of the map. */
#define GUIDE_RADII 3

/* The hemisphere in cells: rows from the normal down, columns around it. */
typedef struct Cells {
    int rows, columns;
    double azimuth;            /* where the first column begins, radians */
    V3 x, y, n;                /* the frame */
    float light[CELLS_MAX][3]; /* mean of the cell's rays */
    float distance[CELLS_MAX]; /* the least of them */
    uint16_t more[CELLS_MAX];  /* guided rays */
} Cells;

/* A gather ray on its way through mirrors and glass. */
typedef struct GatherRay {
    Ray ray;
    Interiors inside;
    Rgb weight;
    int depth;         /* of the gathering it belongs to */
    int passed;        /* mirrors and panes */
    bool has_gathered; /* light anew, on the way */
} GatherRay;

static void gather_ray_init(GatherRay *way, const ShapePoint *at, V3 d, const Interiors *inside,
                            int depth)
{
    way->ray = trace_ray_from(at, d);
    interiors_copy(&way->inside, inside);
    way->weight = RGB_WHITE;
    way->depth = depth;
    way->passed = 0;
    way->has_gathered = false;
}

static void gather_at(EyeThread *eye, const ShapePoint *at, V3 n, const Interiors *inside, int rays,
                      int depth, GatheredLight *out);

/* --- what a ray brings --------------------------------------------------------------------- */

/* The light of other surfaces that arrives at a side of one: another ray may have asked for it. */
static Rgb irradiance_nearby(EyeThread *eye, const SurfaceSample *s, V3 n, const Interiors *inside,
                             int depth)
{
    Rgb kept;
    GatheredLight gathered;
    if (nearby_light_read(eye, s->at.p, n, &kept))
        return kept;
    gather_at(eye, &s->at, n, inside, eye->fresh ? NEAR_RAYS_KEPT : NEAR_RAYS, depth + 1,
              &gathered);
    nearby_light_keep(eye, s->at.p, n, &gathered);
    return gathered.irradiance;
}

/* What a surface sends on of the light that comes to it, found anew instead of looked up. */
static Rgb light_nearby(EyeThread *eye, const SurfaceSample *s, const Interiors *inside,
                        Rgb diffuse, Rgb back, int depth)
{
    Rgb light = RGB_BLACK;
    if (plan_has(eye->plan, FEATURE_LIGHTS))
        light = direct_light(eye, s, false);
    if (eye->options.caustic)
        light = rgb_add(light, caustic_light(eye, s).light);
    light = rgb_add(light, rgb_mul(diffuse, irradiance_nearby(eye, s, s->ng, inside, depth)));
    if (rgb_is_black(back))
        return light;
    Rgb behind = irradiance_nearby(eye, s, v3_neg(s->ng), inside, depth);
    return rgb_add(light, rgb_mul(back, behind));
}

/* The light that arrives at a side of a surface: looked up, or in one of many passes without places
 * from the photons within the radius of the pass.  radius: see irradiance_at. */
static Rgb irradiance_there(EyeThread *eye, const SurfaceSample *s, V3 n, double *radius)
{
    const EyeOptions *options = &eye->options;
    eye->trace.stats.count[STAT_LOOKUPS]++;
    if (options->irradiance || !options->is_progressive)
        return irradiance_at(options->irradiance, &eye->trace, eye->gather, &s->at, n, radius);
    Rgb light = RGB_BLACK;
    *radius = 0;
    if (options->global) {
        GatherLimits limits = gather_limits_at(&options->global_limits, &s->at, n);
        int count = photon_gather(options->global, s->at.p, n, &limits, eye->gather, &light);
        eye->trace.stats.count[STAT_GATHERS]++;
        eye->trace.stats.count[STAT_GATHERED] += (uint64_t)count;
        photon_gather_see(options->global, eye->gather);
    }
    return light;
}

/* What a surface met after t sends on of the light that comes to it. */
static Rgb reflected_light(EyeThread *eye, GatherRay *way, const SurfaceSample *s, double t)
{
    Rgb diffuse = surface_diffuse_even(s), back = surface_diffuse_back(s), light = RGB_BLACK;
    double radius;
    if (!rgb_is_black(diffuse)) {
        Rgb e = irradiance_there(eye, s, s->ng, &radius);
        if (t < NEAR_RADII * radius && way->depth == 0 && !way->has_gathered) {
            way->has_gathered = true;
            return light_nearby(eye, s, &way->inside, diffuse, back, way->depth);
        }
        light = rgb_mul(diffuse, e);
    }
    if (!rgb_is_black(back)) {
        Rgb e = irradiance_there(eye, s, v3_neg(s->ng), &radius);
        light = rgb_add(light, rgb_mul(back, e));
    }
    return light;
}

static float part_of(Rgb share)
{
    return rgb_max_abs(share);
}

static void go_through(GatherRay *way, const SurfaceSample *s, Rgb share)
{
    way->weight = rgb_mul(way->weight, share);
    if (!s->is_total_reflection) {
        interiors_copy(&way->inside, &s->inside_after);
        way->weight = rgb_scale(way->weight, (float)(s->ior_ratio * s->ior_ratio));
    }
    way->ray = trace_ray_from(&s->at, s->transmit_dir);
}

/* Go through a surface that disperses; returns false when the wavelength chosen does not pass. */
static bool disperse(EyeThread *eye, GatherRay *way, const Hit *hit)
{
    Rgb color;
    SurfaceSample wave;
    if (!surface_sample_wave(&eye->trace, &way->ray, hit, &way->inside, rng_double(&eye->rng),
                             &wave, &color))
        return false;
    go_through(way, &wave, rgb_mul(color, wave.through));
    return true;
}

/* The most the chance of going on may be.  A ray that loses nothing on its way passes n surfaces
 * with the chance CHAIN_SURE / n, so that its weight grows no faster than their number. */
static float chance_most(const GatherRay *way)
{
    return way->passed < CHAIN_SURE ? 1 : (float)way->passed / (float)(way->passed + 1);
}

/* Turn the ray into one of those that go on through the surface or off it, with the chance of how
 * much they bring; returns false if it ends there. */
static bool go_on(EyeThread *eye, GatherRay *way, const Hit *hit, const SurfaceSample *s)
{
    Rgb through = s->is_total_reflection ? RGB_WHITE : s->filter;
    float transmit = s->has_transmission ? part_of(through) : 0, total = transmit;
    for (int i = 0; i < s->layer_count; i++)
        total += part_of(s->layers[i].reflect);
    float most = fminf(chance_most(way), total), x = rng_float(&eye->rng);
    if (!(x < most))
        return false;
    way->passed++;
    float scale = total / most; /* a share of part p is taken with the chance p / scale */
    x *= scale;
    if (x < transmit) {
        way->weight = rgb_scale(way->weight, scale / transmit);
        if (s->spectrum > 0)
            return disperse(eye, way, hit);
        go_through(way, s, through);
        return true;
    }
    x -= transmit;
    for (int i = 0; i < s->layer_count; i++) {
        const SurfaceLayer *layer = &s->layers[i];
        float part = part_of(layer->reflect);
        if (x < part) {
            way->weight = rgb_mul(way->weight, rgb_scale(layer->reflect, scale / part));
            way->ray = trace_ray_from(&s->at, layer->reflect_dir);
            return true;
        }
        x -= part;
    }
    return false;
}

static Rgb limited(Rgb light, double most)
{
    double above = (double)rgb_max(light) / most;
    return most > 0 && above > 1 ? rgb_scale(light, (float)(1 / above)) : light;
}

/* Take what lies in the air along the next `length` of the way. */
static Rgb air_light(EyeThread *eye, GatherRay *way, double length)
{
    Veil veil;
    Rgb sum = RGB_BLACK;
    air_along(eye, &way->ray, length, &way->inside, AIR_GATHERED, &veil);
    for (int i = 0; i < PART_LIGHTS; i++)
        sum = rgb_add(sum, veil.light[i]);
    sum = rgb_mul(way->weight, sum);
    way->weight = rgb_mul(way->weight, veil.through);
    return sum;
}

/* Follow a gather ray; *distance is that of the first surface, infinite if there is none. */
static Rgb follow(EyeThread *eye, GatherRay *way, double *distance)
{
    Rgb sum = RGB_BLACK;
    double length = 0;
    bool was_dimmed = eye->trace.is_dimmed;
    eye->trace.is_dimmed = true; /* as the photons are */
    *distance = INFINITY;
    for (int i = 0; i < CHAIN_MAX && !work_interrupted; i++) {
        Hit hit;
        SurfaceSample s;
        bool is_hit = trace_closest(&eye->trace, &way->ray, RAY_DIFFUSE, &hit);
        if (eye->has_air)
            sum = rgb_add(sum, air_light(eye, way, is_hit ? hit.t : INFINITY));
        if (!is_hit) {
            if (plan_has(eye->plan, FEATURE_SKY_LIGHT)) {
                eye->trace.stats.count[STAT_SKY_RAYS]++;
                Rgb sky = sky_light_from(eye->trace.tracer, way->ray.d);
                sum = rgb_add(sum, rgb_mul(way->weight, sky));
            }
            break;
        }
        way->weight = rgb_mul(way->weight, interiors_fade(&way->inside, hit.t));
        length += hit.t;
        if (i == 0)
            *distance = hit.t;
        surface_sample(&eye->trace, &way->ray, &hit, &way->inside, &s);
        Rgb light = reflected_light(eye, way, &s, length);
        if (!plan_forbids(eye->plan, FEATURE_GLOW))
            light = rgb_add(surface_glow(eye->trace.tracer, &s), light);
        sum = rgb_add(sum, rgb_mul(way->weight, light));
        if (!go_on(eye, way, &hit, &s))
            break;
    }
    eye->trace.is_dimmed = was_dimmed;
    return limited(sum, eye->scene->settings.radiosity.max_sample);
}

/* --- the cells ------------------------------------------------------------------------------ */

static void cells_init(Cells *cells, EyeThread *eye, V3 n, int rays)
{
    double rows = sqrt((double)rays / PMS_PI);
    cells->rows = rows < 2 ? 2 : rows > ROWS_MAX ? ROWS_MAX : (int)lrint(rows);
    cells->columns = (int)lrint(fmax(4, (double)rays / cells->rows));
    if (cells->columns > CELLS_MAX / cells->rows)
        cells->columns = CELLS_MAX / cells->rows;
    cells->azimuth = 2 * PMS_PI * rng_double(&eye->rng);
    cells->n = n;
    v3_frame(n, &cells->x, &cells->y);
    memset(cells->more, 0, (size_t)(cells->rows * cells->columns) * sizeof *cells->more);
}

/* The cell a direction above the surface lies in. */
static int cell_of(const Cells *cells, V3 d, double height)
{
    double angle = atan2(v3_dot(d, cells->y), v3_dot(d, cells->x)) - cells->azimuth;
    angle -= floor(angle / (2 * PMS_PI)) * 2 * PMS_PI;
    int row = (int)((1 - height * height) * cells->rows);
    int column = (int)(angle / (2 * PMS_PI) * cells->columns);
    row = row < cells->rows ? row : cells->rows - 1;
    column = column < cells->columns ? column : cells->columns - 1;
    return row * cells->columns + column;
}

/* Give out rays to the cells that the light of photons nearby came from, in proportion. */
static void guide(Cells *cells, EyeThread *eye, const ShapePoint *at, int rays)
{
    const GatheredPhoton *photons;
    GatherLimits limits = gather_limits_at(&eye->options.global_limits, at, cells->n);
    limits.max_photons = GUIDE_PHOTONS;
    limits.min_photons = 0;
    limits.max_radius *= GUIDE_RADII;
    int count =
        photon_gather_list(eye->options.global, at->p, cells->n, &limits, eye->gather, &photons);
    float sum = 0, seen = 0;
    for (int i = 0; i < count; i++)
        sum += rgb_sum(photons[i].irradiance);
    if (!(sum > 0))
        return;
    float next = rng_float(&eye->rng) * sum / (float)rays, step = sum / (float)rays;
    for (int i = 0; i < count; i++) {
        double height = v3_dot(photons[i].from, cells->n);
        seen += rgb_sum(photons[i].irradiance);
        for (; next < seen; next += step)
            if (height > 0)
                cells->more[cell_of(cells, photons[i].from, height)]++;
    }
}

/* A direction in a cell, by two numbers in [0,1). */
static V3 cell_direction(const Cells *cells, int row, int column, double u, double v)
{
    double sine2 = (row + u) / cells->rows, sine = sqrt(sine2), cosine = sqrt(1 - sine2);
    double angle = cells->azimuth + 2 * PMS_PI * (column + v) / cells->columns;
    V3 d = v3_scale(cells->n, cosine);
    return v3_mad(v3_mad(d, sine * cos(angle), cells->x), sine * sin(angle), cells->y);
}

static void gather_cell(Cells *cells, EyeThread *eye, const ShapePoint *at, V3 ng,
                        const Interiors *inside, int cell, int depth)
{
    int rays = 1 + cells->more[cell], row = cell / cells->columns, column = cell % cells->columns;
    uint64_t key = rays > 1 ? rng_u64(&eye->rng) : 0;
    float *light = cells->light[cell];
    double nearest = INFINITY;
    light[0] = light[1] = light[2] = 0;
    for (int i = 0; i < rays; i++) {
        V2 u = rays > 1 ? sample_2d((uint32_t)i, key) : (V2){rng_double(&eye->rng), 0};
        if (rays == 1)
            u.v = rng_double(&eye->rng);
        V3 d = cell_direction(cells, row, column, u.u, u.v);
        if (!(v3_dot(d, ng) > 0))
            continue;
        GatherRay way;
        gather_ray_init(&way, at, d, inside, depth);
        way.inside.wavelength = 0; /* what is gathered serves rays of all wavelengths */
        double distance;
        Rgb found = follow(eye, &way, &distance);
        light[0] += found.r / (float)rays;
        light[1] += found.g / (float)rays;
        light[2] += found.b / (float)rays;
        nearest = fmin(nearest, distance);
    }
    cells->distance[cell] = (float)nearest;
}

/* --- what they add up to ---------------------------------------------------------------------- */

static V3 around(const Cells *cells, double column)
{
    double angle = cells->azimuth + 2 * PMS_PI * column / cells->columns;
    return v3_add(v3_scale(cells->x, cos(angle)), v3_scale(cells->y, sin(angle)));
}

static void add_vector(float out[3], V3 v, double scale)
{
    out[0] += (float)(scale * v.x);
    out[1] += (float)(scale * v.y);
    out[2] += (float)(scale * v.z);
}

/* The least distance of two cells beside each other. */
static double step_distance(const Cells *cells, int a, int b)
{
    return (double)fminf(cells->distance[a], cells->distance[b]);
}

/* The gradients' part of a cell: a turn of the normal towards the cell raises its cosine; with a
 * step the borders to the cells inside and before it move, the faster the nearer they are. */
static void add_gradients(const Cells *cells, int row, int column, GatheredLight *out)
{
    int columns = cells->columns, cell = row * columns + column;
    int inner = cell - columns, before = row * columns + (column + columns - 1) % columns;
    double middle2 = (row + 0.5) / cells->rows, low2 = (double)row / cells->rows;
    double low = sqrt(low2), high = sqrt((double)(row + 1) / cells->rows);
    double tangent = sqrt(middle2 / (1 - middle2));
    V3 u = around(cells, column + 0.5), v = v3_cross(cells->n, u);
    V3 w = v3_cross(cells->n, around(cells, column));
    double inward =
        row > 0 ? 2 * low * (1 - low2) / columns / step_distance(cells, cell, inner) : 0;
    double sideward = (high - low) / PMS_PI / step_distance(cells, cell, before);
    for (int c = 0; c < 3; c++) {
        double light = (double)cells->light[cell][c];
        add_vector(out->turn[c], v, tangent * light / (cells->rows * columns));
        if (row > 0)
            add_vector(out->shift[c], u, inward * (light - (double)cells->light[inner][c]));
        add_vector(out->shift[c], w, sideward * (light - (double)cells->light[before][c]));
    }
}

/* The standard error of the mean of the cells: each counts what one direction in it saw, which
 * varies about as much as from it to the one beside it. */
static float cells_noise(const Cells *cells)
{
    double sum = 0;
    int count = cells->rows * cells->columns;
    for (int i = 0; i < count; i++) {
        bool is_last = (i + 1) % cells->columns == 0;
        const float *a = cells->light[i],
                    *b = cells->light[is_last ? i + 1 - cells->columns : i + 1];
        double step = (double)rgb_luminance(rgb(a[0] - b[0], a[1] - b[1], a[2] - b[2]));
        sum += step * step / (2 * (1 + cells->more[i]));
    }
    return (float)(sqrt(sum) / count);
}

static void sum_cells(const Cells *cells, bool has_gradients, GatheredLight *out)
{
    int count = cells->rows * cells->columns;
    double sum[3] = {0}, inverse = 0;
    *out = (GatheredLight){.nearest = INFINITY};
    for (int i = 0; i < count; i++) {
        for (int c = 0; c < 3; c++)
            sum[c] += (double)cells->light[i][c];
        inverse += 1 / (double)cells->distance[i];
        out->nearest = fmin(out->nearest, (double)cells->distance[i]);
    }
    out->irradiance =
        rgb((float)(sum[0] / count), (float)(sum[1] / count), (float)(sum[2] / count));
    out->distance = count / inverse;
    out->noise = cells_noise(cells);
    for (int i = 0; has_gradients && i < count; i++)
        add_gradients(cells, i / cells->columns, i % cells->columns, out);
}

static void gather_at(EyeThread *eye, const ShapePoint *at, V3 n, const Interiors *inside, int rays,
                      int depth, GatheredLight *out)
{
    Cells cells;
    V3 ng = v3_dot(at->ng, n) < 0 ? v3_neg(at->ng) : at->ng;
    int guided = eye->options.global && depth == 0 ? rays / GUIDED_PART : 0;
    cells_init(&cells, eye, n, rays - guided);
    eye->trace.stats.count[STAT_FINAL_GATHERS]++;
    if (guided > 0)
        guide(&cells, eye, at, guided);
    for (int i = 0; i < cells.rows * cells.columns; i++)
        gather_cell(&cells, eye, at, ng, inside, i, depth);
    sum_cells(&cells, depth == 0 || eye->fresh, out);
}

void final_gather(EyeThread *eye, const ShapePoint *at, V3 n, const Interiors *inside, int rays,
                  GatheredLight *out)
{
    gather_at(eye, at, n, inside, rays, 0, out);
}

Rgb final_gather_few(EyeThread *eye, const ShapePoint *at, V3 n, const Interiors *inside)
{
    V3 ng = v3_dot(at->ng, n) < 0 ? v3_neg(at->ng) : at->ng;
    uint64_t key = eye->path.gather++;
    Rgb sum = RGB_BLACK;
    eye->trace.stats.count[STAT_FINAL_GATHERS]++;
    for (uint32_t i = 0; i < FEW_RAYS; i++) {
        V2 u = sample_2d(eye->path.index * FEW_RAYS + i, key);
        V3 d = warp_to_frame(warp_cosine(u), n);
        if (!(v3_dot(d, ng) > 0))
            continue;
        double distance;
        GatherRay way;
        gather_ray_init(&way, at, d, inside, 0);
        sum = rgb_add(sum, follow(eye, &way, &distance));
    }
    return rgb_scale(sum, 1.0f / FEW_RAYS);
}
