/* Area lights: a grid of points whose shadows are averaged.
 *
 * The average is the language's: a rectangle of the grid is the mean of its corners, or of its
 * four parts when its corners disagree, so the weights are not those of a plain mean.
 * SPDX-License-Identifier: Apache-2.0 */
#include "eye/eye_int.h"

#include "base/rng.h"

/* Corners further apart than this, over the channels of the light that arrives, are a shadow's
 * edge. */
#define EDGE_DIFFERENCE 0.1f

/* Keeps the centre of a circular light's grid off the undefined point of its map. */
#define CIRCULAR_SHIFT 0.001

typedef struct ShadowGrid {
    EyeThread *eye;
    const Light *light;
    const SurfaceSample *s;
    V3 to_center; /* from the surface to the light's centre */
    Rgb color;    /* of the light as it would arrive */
    AreaFrame frame;
    int light_index;
    bool blocks_targets;
    ShadowBundle bundle;
} ShadowGrid;

typedef struct GridRect {
    int i1, j1, i2, j2;
} GridRect;

AreaFrame area_frame(const Light *light, V3 to_light)
{
    const AreaLight *area = &light->area;
    if (!area->is_oriented)
        return (AreaFrame){area->axis1, area->axis2};
    V3 helper = fabs(to_light.z) > 0.99 ? v3(0, 1, 0) : v3(0, 0, 1);
    V3 across = v3_unit(v3_cross(to_light, helper));
    double length = v3_len(area->axis1);
    return (AreaFrame){v3_scale(across, length), v3_scale(v3_cross(to_light, across), length)};
}

/* Place of grid line k of n, -0.5 to 0.5. */
static double grid_place(int k, int n, double jitter)
{
    return n > 1 ? (k + jitter) / (n - 1) - 0.5 : 0;
}

/* How far from the middle a grid line may lie, parts of the axis. */
static double grid_reach(int n, bool has_jitter)
{
    double jitter = has_jitter && n > 1 ? 0.5 / (n - 1) : 0;
    return 0.5 + jitter + CIRCULAR_SHIFT;
}

/* Bound the distance of the light's points from its centre. */
static double area_radius(const AreaLight *area, const AreaFrame *frame)
{
    double reach1 = grid_reach(area->size1, area->has_jitter);
    double reach2 = grid_reach(area->size2, area->has_jitter);
    V3 a = v3_scale(frame->axis1, reach1), b = v3_scale(frame->axis2, reach2);
    double corner2 = fmax(v3_len2(v3_add(a, b)), v3_len2(v3_sub(a, b)));
    if (area->is_circular || area->is_oriented) {
        /* The unit square goes to the unit disk: s A + t B with s^2 + t^2 <= reach^2. */
        double reach = fmax(reach1, reach2), skew = fabs(v3_dot(frame->axis1, frame->axis2));
        double longest2 = fmax(v3_len2(frame->axis1), v3_len2(frame->axis2)) + skew;
        corner2 = fmin(corner2, reach * reach * longest2);
    }
    return sqrt(corner2);
}

V3 area_offset(const Light *light, const AreaFrame *frame, int i, int j, Rng *rng)
{
    const AreaLight *area = &light->area;
    double shift1 = area->has_jitter ? rng_double(rng) - 0.5 : 0;
    double shift2 = area->has_jitter ? rng_double(rng) - 0.5 : 0;
    double a = grid_place(i, area->size1, shift1), b = grid_place(j, area->size2, shift2);
    if (area->is_circular || area->is_oriented) {
        a += CIRCULAR_SHIFT;
        b += CIRCULAR_SHIFT;
        double length = sqrt(a * a + b * b);
        double squeeze = length > 0 ? fmax(fabs(a), fabs(b)) / length : 0;
        a *= squeeze;
        b *= squeeze;
    }
    return v3_mad(v3_scale(frame->axis1, a), b, frame->axis2);
}

static Rgb grid_at(ShadowGrid *grid, int i, int j)
{
    EyeThread *eye = grid->eye;
    int cell = j * grid->light->area.size1 + i;
    if (eye->grid_marks[cell] != eye->grid_mark) {
        V3 offset = area_offset(grid->light, &grid->frame, i, j, &eye->rng);
        V3 to = v3_add(grid->to_center, offset);
        eye->grid[cell] = trace_shadow_of(&eye->trace, &grid->bundle, &grid->s->at, v3_unit(to),
                                          v3_len(to), grid->light_index, grid->blocks_targets);
        eye->grid_marks[cell] = eye->grid_mark;
    }
    return eye->grid[cell];
}

static bool has_edge(const ShadowGrid *grid, Rgb a, Rgb b)
{
    Rgb d = rgb_mul(rgb_sub(a, b), grid->color);
    return fabsf(d.r) + fabsf(d.g) + fabsf(d.b) > EDGE_DIFFERENCE;
}

static Rgb mean_of_4(Rgb a, Rgb b, Rgb c, Rgb d)
{
    return rgb_scale(rgb_add(rgb_add(a, b), rgb_add(c, d)), 0.25f);
}

static Rgb rect_mean(ShadowGrid *grid, GridRect r, int level)
{
    Rgb a = grid_at(grid, r.i1, r.j1), b = grid_at(grid, r.i2, r.j1);
    Rgb c = grid_at(grid, r.i1, r.j2), d = grid_at(grid, r.i2, r.j2);
    bool is_splittable = r.i2 - r.i1 > 1 || r.j2 - r.j1 > 1;
    if (!is_splittable || (level >= grid->light->area.adaptive && !has_edge(grid, a, b) &&
                           !has_edge(grid, a, c) && !has_edge(grid, b, d) && !has_edge(grid, c, d)))
        return mean_of_4(a, b, c, d);
    int i_low = (r.i1 + r.i2) / 2, i_high = (r.i1 + r.i2 + 1) / 2;
    int j_low = (r.j1 + r.j2) / 2, j_high = (r.j1 + r.j2 + 1) / 2;
    level++;
    a = rect_mean(grid, (GridRect){r.i1, r.j1, i_low, j_low}, level);
    b = rect_mean(grid, (GridRect){i_high, r.j1, r.i2, j_low}, level);
    c = rect_mean(grid, (GridRect){r.i1, j_high, i_low, r.j2}, level);
    d = rect_mean(grid, (GridRect){i_high, j_high, r.i2, r.j2}, level);
    return mean_of_4(a, b, c, d);
}

Rgb area_shadow(EyeThread *eye, const EyeLight *light, const SurfaceSample *s,
                const LightSample *center)
{
    const AreaLight *area = &light->light->area;
    if (!(center->distance > 0))
        return RGB_WHITE; /* behind a parallel light */
    ShadowGrid grid = {.eye = eye,
                       .light = light->light,
                       .s = s,
                       .to_center = v3_scale(center->to_light, center->distance),
                       .color = center->color,
                       .frame = area_frame(light->light, center->to_light),
                       .light_index = light->index,
                       .blocks_targets =
                           light->makes_caustics && s->surface->photons.is_collecting};
    double radius = area_radius(area, &grid.frame);
    trace_shadow_bundle(eye->trace.tracer, &s->at, grid.to_center, radius, &grid.bundle);
    if (grid.bundle.count == 0)
        return RGB_WHITE;
    eye->grid_mark++;
    return rect_mean(&grid, (GridRect){0, 0, area->size1 - 1, area->size2 - 1}, 0);
}

V3 light_point(EyeThread *eye, const EyeLight *light, V3 p)
{
    const Light *source = light->light;
    if (!light->is_area)
        return source->location;
    LightSample center = light_at(source, source->location, p);
    AreaFrame frame = area_frame(source, center.to_light);
    int i = (int)(rng_double(&eye->rng) * source->area.size1);
    int j = (int)(rng_double(&eye->rng) * source->area.size2);
    return v3_add(source->location, area_offset(source, &frame, i, j, &eye->rng));
}
