/* Light that media scatter once, from the lights to the eye.
 *
 * Along a ray the light that would arrive without shadows is cheap and smooth: it is summed up
 * over places spread by what passes the media and by the angle the light is seen under, as finely
 * as the rule that sums it needs.  What costs is the shadow rays.  They are sent from places spread
 * evenly over that light, few at first, and more only where neighbours differ by what can be seen.
 * SPDX-License-Identifier: Apache-2.0 */
#include "eye/air_int.h"

enum {
    PIECES_MAX = 2 * MEDIA_CELLS_MAX, /* of the light along a ray */
    HALVINGS_MAX = 10,                /* of a piece */
    CELLS_SMALL = 32,                 /* more cells than these are small enough as they are */
    BREAKS_BY_ANGLE = 6,
    PLACES_FIRST_MAX = 64,
    PLACES_MAX = 256 /* shadow rays to one light for one ray */
};

/* Pieces of the light are halved until the rules that sum them differ by less than this part of
 * what is known of the whole, or of the tolerance: what they are wrong by is far below that. */
#define PIECE_ERROR 1e-3f
#define PIECE_TOLERANCE 0.05f

/* Places in a part of a cell that is thinner than this are even. */
#define THIN_DEPTH 0.25

/* Places in a part of a cell, counted by how much of what comes from there passes it (in the
 * channel that goes furthest): v from 0 to 1. */
typedef struct Warp {
    const MediaCell *cell;
    double begin, length; /* t */
    double x;             /* extinction */
    double lost;          /* part that does not pass; 0: little, v is even in t */
} Warp;

/* Between two places whose shadows differ by more than this, over the channels, is an edge. */
#define END_STEP 0.75f

/* A piece of the light along a ray, without shadows. */
typedef struct Piece {
    Warp warp;
    double low, high; /* v */
    double skew;      /* share of its begin in the light of begin and end; even between them */
    Rgb sum;          /* light up to its end */
    double part;      /* the same as a part of the whole, over the channels */
} Piece;

/* The light along a ray, in order from its begin. */
typedef struct LightRun {
    int count;
    Rgb whole;
    Piece pieces[PIECES_MAX];
} LightRun;

/* What a shadow ray found, for a stretch of the light of a run. */
typedef struct LightPlace {
    double begin, end, at; /* parts of the whole */
    Rgb arrived;
} LightPlace;

typedef struct Scatter {
    EyeThread *eye;
    const MediaProfile *profile;
    MediaLobes lobes;
    const Ray *ray;
    const EyeLight *light;
    MediaCare care;
    float enough; /* a piece need not be known better than this */
    LightRun run;
    int count;
    LightPlace places[PLACES_MAX];
} Scatter;

/* --- the light without shadows ------------------------------------------------------------ */

static Warp make_warp(const MediaCell *cell, double begin, double end)
{
    Warp warp = {.cell = cell, .begin = begin, .length = end - begin};
    warp.x = (double)rgb_min(cell->point.extinction);
    warp.lost = warp.x * warp.length > THIN_DEPTH ? -expm1(-warp.x * warp.length) : 0;
    return warp;
}

static double warp_t(const Warp *warp, double v)
{
    if (warp->lost == 0)
        return warp->begin + v * warp->length;
    return warp->begin + fmin(warp->length, -log1p(-v * warp->lost) / warp->x);
}

static double warp_v(const Warp *warp, double t)
{
    double way = t - warp->begin;
    return warp->lost == 0 ? way / warp->length : -expm1(-warp->x * way) / warp->lost;
}

/* Light per unit of v at a place. */
static Rgb light_here(const Scatter *s, const Warp *warp, double v)
{
    double t = warp_t(warp, v);
    const MediaCell *cell = warp->cell;
    const Light *light = s->light->light;
    LightSample sample = light_at(light, light->location, ray_at(s->ray, t));
    if (rgb_is_black(sample.color))
        return RGB_BLACK;
    V3 p = ray_at(s->ray, cell->at);
    Rgb scattered = media_scattered(&s->lobes, p, v3_dot(sample.to_light, s->ray->d));
    /* What passes up to here, over the part of it that v stands for. */
    Rgb x = cell->point.extinction;
    float way = (float)(t - warp->begin), rest = warp->lost == 0 ? 0 : (float)warp->x;
    Rgb depth = rgb_mad(cell->depth, (float)(warp->begin - cell->begin), x);
    depth = rgb_add(depth, rgb((x.r - rest) * way, (x.g - rest) * way, (x.b - rest) * way));
    double measure = warp->lost == 0 ? warp->length : warp->lost / warp->x;
    return rgb_scale(rgb_mul(rgb_mul(scattered, sample.color), media_clear(depth)), (float)measure);
}

static void add_piece(Scatter *s, const Warp *warp, double low, double high, double skew, Rgb light)
{
    LightRun *run = &s->run;
    if (run->count == PIECES_MAX)
        return;
    run->whole = rgb_add(run->whole, light);
    run->pieces[run->count++] =
        (Piece){.warp = *warp, .low = low, .high = high, .skew = skew, .sum = run->whole};
}

/* Sum up the light between two values of v by Simpson's rule, halving where that differs from the
 * rule of trapezes. */
static void sum_light(Scatter *s, const Warp *warp, double low, Rgb first, double high, Rgb last,
                      int halvings)
{
    double middle = 0.5 * (low + high);
    Rgb between = light_here(s, warp, middle), ends = rgb_add(first, last);
    float width = (float)(high - low);
    Rgb simpson = rgb_scale(rgb_mad(ends, 4, between), width / 6);
    Rgb trapeze = rgb_scale(rgb_mad(ends, 2, between), width / 4);
    float error = rgb_sum_abs(rgb_sub(simpson, trapeze));
    float limit = fmaxf(s->enough, PIECE_ERROR * rgb_sum_abs(s->run.whole));
    if (error <= limit || halvings == 0 || s->run.count > PIECES_MAX / 2) {
        float all = rgb_sum(ends);
        add_piece(s, warp, low, high, all > 0 ? (double)(rgb_sum(first) / all) : 0.5, simpson);
        return;
    }
    sum_light(s, warp, low, first, middle, between, halvings - 1);
    sum_light(s, warp, middle, between, high, last, halvings - 1);
}

/* Places at equal steps of the angle under which the light is seen. */
static int breaks_by_angle(const Light *light, const Ray *ray, double begin, double end, double *t)
{
    double nearest = v3_dot(v3_sub(light->location, ray->o), ray->d);
    double away = v3_dist(light->location, ray_at(ray, nearest));
    away = fmax(away, 1e-6 * (fabs(nearest) + away));
    if (light_is_parallel(light) || !(away > 0))
        return 0;
    double low = atan2(begin - nearest, away), high = atan2(end - nearest, away);
    for (int i = 0; i < BREAKS_BY_ANGLE; i++)
        t[i] = nearest + away * tan(low + (high - low) * (i + 1) / (BREAKS_BY_ANGLE + 1));
    return BREAKS_BY_ANGLE;
}

/* Sum up the light of a part of a cell. */
static void add_cell(Scatter *s, const MediaCell *cell, double begin, double end,
                     const double *breaks, int break_count)
{
    if (!(end > begin) || rgb_is_black(cell->point.scattering))
        return;
    Warp warp = make_warp(cell, begin, end);
    if (s->profile->count > CELLS_SMALL) {
        add_piece(s, &warp, 0, 1, 0.5, light_here(s, &warp, 0.5));
        return;
    }
    double low = 0;
    Rgb first = light_here(s, &warp, 0);
    for (int i = 0; i <= break_count; i++) {
        double high = i < break_count ? warp_v(&warp, breaks[i]) : 1;
        if (!(high > low && high <= 1))
            continue;
        Rgb last = light_here(s, &warp, high);
        sum_light(s, &warp, low, first, high, last, HALVINGS_MAX);
        low = high;
        first = last;
    }
}

/* Returns false when there is no light at all. */
static bool fill_run(Scatter *s, double begin, double end)
{
    double breaks[BREAKS_BY_ANGLE];
    int count = breaks_by_angle(s->light->light, s->ray, begin, end, breaks);
    LightRun *run = &s->run;
    run->count = 0;
    run->whole = RGB_BLACK;
    for (int i = 0; i < s->profile->count; i++) {
        const MediaCell *cell = &s->profile->cells[i];
        add_cell(s, cell, fmax(begin, cell->begin), fmin(end, cell->end), breaks, count);
    }
    double all = (double)rgb_sum(run->whole);
    for (int i = 0; i < run->count; i++)
        run->pieces[i].part = i + 1 < run->count ? (double)rgb_sum(run->pieces[i].sum) / all : 1;
    return all > 0 && isfinite(all);
}

/* Return the piece in which a part of the light ends, and where in it (0 to 1). */
static const Piece *run_piece(const LightRun *run, double part, double *inside)
{
    int low = 0, high = run->count - 1;
    while (low < high) {
        int middle = (low + high) / 2;
        if (run->pieces[middle].part <= part)
            low = middle + 1;
        else
            high = middle;
    }
    double before = low > 0 ? run->pieces[low - 1].part : 0;
    double width = run->pieces[low].part - before;
    *inside = width > 0 ? fmin(1, (part - before) / width) : 0.5;
    return &run->pieces[low];
}

static Rgb run_light(const LightRun *run, double part)
{
    double inside;
    const Piece *piece = run_piece(run, part, &inside);
    Rgb before = piece > run->pieces ? piece[-1].sum : RGB_BLACK;
    return rgb_lerp(before, piece->sum, (float)inside);
}

static double run_t(const LightRun *run, double part)
{
    double inside;
    const Piece *piece = run_piece(run, part, &inside);
    double skew = piece->skew, way = skew + sqrt(skew * skew + (1 - 2 * skew) * inside);
    double share = way > 0 ? fmin(1, inside / way) : 0;
    return warp_t(&piece->warp, piece->low + (piece->high - piece->low) * share);
}

/* --- shadows ------------------------------------------------------------------------------ */

/* Return what arrives of a light at a place. */
static Rgb look_at_light(const Scatter *s, double t)
{
    EyeThread *eye = s->eye;
    const EyeLight *light = s->light;
    V3 p = ray_at(s->ray, t);
    LightSample sample = light_at(light->light, light_point(eye, light, p), p);
    if (!(sample.distance > 0))
        return RGB_WHITE;
    ShapePoint from = {.p = p, .ng = sample.to_light, .ns = sample.to_light};
    Rgb arrived = RGB_WHITE;
    if (light->has_shadow)
        arrived = trace_shadow(&eye->trace, &from, sample.to_light, sample.distance, light->index,
                               light->makes_volume);
    if (rgb_is_black(arrived))
        return arrived;
    return rgb_mul(
        arrived, media_air_shadow(&eye->trace, p, sample.to_light, sample.distance, light->index));
}

static LightPlace make_place(const Scatter *s, double begin, double end, double u)
{
    LightPlace place = {.begin = begin, .end = end, .at = begin + (end - begin) * u};
    place.arrived = look_at_light(s, run_t(&s->run, place.at));
    return place;
}

static float whole_difference(const Scatter *s, const LightPlace *a, const LightPlace *b)
{
    Rgb d = rgb_mul(rgb_sub(a->arrived, b->arrived), s->run.whole);
    return rgb_sum_abs(d);
}

/* Halve the stretches beside a visible step; returns whether there were any. */
static bool refine(Scatter *s)
{
    bool is_marked[PLACES_MAX] = {false};
    int count = s->count, marked = 0;
    for (int i = 0; i + 1 < count; i++) {
        const LightPlace *a = &s->places[i], *b = a + 1;
        float step = whole_difference(s, a, b);
        float width = (float)fmax(a->end - a->begin, b->end - b->begin);
        if (step > s->care.threshold && step * width / 2 > s->care.tolerance)
            is_marked[i] = is_marked[i + 1] = true;
    }
    for (int i = 0; i < count; i++)
        marked += is_marked[i];
    if (marked == 0 || count + marked > PLACES_MAX)
        return false;
    int to = s->count = count + marked;
    for (int i = count - 1; i >= 0; i--) {
        LightPlace place = s->places[i];
        if (!is_marked[i]) {
            s->places[--to] = place;
            continue;
        }
        double middle = 0.5 * (place.begin + place.end), u = rng_double(&s->eye->rng);
        bool is_right = place.at >= middle;
        LightPlace other =
            is_right ? make_place(s, place.begin, middle, u) : make_place(s, middle, place.end, u);
        place.begin = is_right ? middle : place.begin;
        place.end = is_right ? place.end : middle;
        s->places[--to] = is_right ? place : other;
        s->places[--to] = is_right ? other : place;
    }
    return true;
}

/* How many places are looked at first: such that a shadow between two of them, which more places
 * would not be looked for, is within the tolerance in the mean; and as many as the scene asks for,
 * unless the light is too dim to matter. */
static int first_places(const Scatter *s)
{
    float most = rgb_max(s->run.whole);
    int asked = most > s->care.threshold ? s->care.cells : most > s->care.tolerance ? 2 : 1;
    float needed = ceilf(most / (4 * s->care.tolerance));
    int places = needed < PLACES_FIRST_MAX ? (int)needed : PLACES_FIRST_MAX;
    return places > asked ? places : asked;
}

static float unit(float x)
{
    return fminf(1, fmaxf(0, x));
}

/* What arrives at an end of the light: as the two places nearest to it go on, unless there is a
 * step between them. */
static Rgb arrived_at_end(const LightPlace *place, const LightPlace *next, double end)
{
    Rgb step = rgb_sub(place->arrived, next->arrived);
    if (rgb_sum_abs(step) > END_STEP || place->at == next->at)
        return place->arrived;
    float way = (float)((end - place->at) / (place->at - next->at));
    Rgb there = rgb_mad(place->arrived, way, step);
    return rgb(unit(there.r), unit(there.g), unit(there.b));
}

/* Sum up the light, what arrives of it going straight from place to place. */
static Rgb join_places(const Scatter *s)
{
    const LightPlace *first = s->places, *last = s->places + s->count - 1;
    if (first == last)
        return rgb_mul(s->run.whole, first->arrived);
    Rgb sum = RGB_BLACK, before = RGB_BLACK;
    Rgb arrived = arrived_at_end(first, first + 1, 0);
    for (const LightPlace *place = first; place <= last + 1; place++) {
        bool is_end = place > last;
        Rgb after = is_end ? s->run.whole : run_light(&s->run, place->at);
        Rgb next = is_end ? arrived_at_end(last, last - 1, 1) : place->arrived;
        Rgb mean = rgb_scale(rgb_add(arrived, next), 0.5f);
        sum = rgb_add(sum, rgb_mul(rgb_sub(after, before), mean));
        before = after;
        arrived = next;
    }
    return sum;
}

static Rgb shadowed(Scatter *s)
{
    int first = first_places(s);
    double u = rng_double(&s->eye->rng);
    s->count = 0;
    for (int i = 0; i < first; i++)
        s->places[s->count++] = make_place(s, (double)i / first, (i + 1.0) / first, u);
    for (int level = 0; level < s->care.level && refine(s); level++)
        ;
    return join_places(s);
}

void media_scatter(EyeThread *eye, const MediaHere *here, const MediaProfile *profile,
                   const Ray *ray, Rgb *light)
{
    bool has_scattering = false;
    for (int i = 0; i < profile->count; i++)
        has_scattering |= !rgb_is_black(profile->cells[i].point.scattering);
    if (!has_scattering)
        return;
    Scatter s;
    s.eye = eye;
    s.profile = profile;
    s.ray = ray;
    s.care = media_care(here);
    s.enough = PIECE_TOLERANCE * s.care.tolerance;
    media_lobes(here, &s.lobes);
    for (int i = 0; i < eye->light_count; i++) {
        s.light = &eye->lights[i];
        double begin = profile->cells[0].begin, end = profile->cells[profile->count - 1].end;
        if (!s.light->lights_media || !light_stretch(s.light->light, ray, &begin, &end) ||
            !fill_run(&s, begin, end))
            continue;
        *light = rgb_add(*light, shadowed(&s));
    }
}
