/* Polygons.
 *
 * Where a ray meets the plane, the edges at that height are counted: bands of equal height list
 * those to look at.  When the point is nearer to one of them than its own rounding, all are
 * looked at once more, along the ray and with exact signs (loops_hold): so polygons that share
 * an edge leave no gap.  SPDX-License-Identifier: Apache-2.0 */
#include "shape/polygon.h"
#include "shape/shape_int.h"

/* Off the plane, relative to the polygon's extent: what points with the digits of a file are. */
#define FLAT_SLACK 1e-8

/* Bands may list an edge this often in the mean. */
enum { BAND_SHARE = 8 };

Shape *shape_polygon(Arena *arena, const PolygonData *data)
{
    Shape *shape = leaf_new(arena, SHAPE_POLYGON);
    if (!shape)
        return NULL;
    shape->u.polygon = data;
    leaf_place(shape, &XFORM_IDENTITY);
    return shape;
}

/* --- making -------------------------------------------------------------------------------- */

/* Return the point that lies furthest from the line through the origin along u, or from the
 * origin if u is 0. */
static V3 farthest_off(const PolygonData *d, V3 u)
{
    V3 best = {0};
    double size = 0;
    for (uint32_t i = 1; i < d->count; i++) {
        V3 p = v3_sub(d->points[i], d->origin);
        V3 off = v3_len2(u) > 0 ? v3_cross(u, p) : p;
        if (v3_len2(off) > size) {
            size = v3_len2(off);
            best = p;
        }
    }
    return best;
}

/* Return the side the language's normal is on: that of the first points not on a line. */
static double facing(const PolygonData *d, double extent)
{
    V3 first = {0};
    for (uint32_t i = 1; i < d->count; i++) {
        V3 p = v3_sub(d->points[i], d->origin);
        if (v3_len2(first) == 0) {
            if (v3_len(p) > FLAT_SLACK * extent)
                first = p;
            continue;
        }
        V3 n = v3_cross(first, p);
        if (v3_len(n) > FLAT_SLACK * v3_len(first) * extent)
            return v3_dot(n, d->normal) < 0 ? -1 : 1;
    }
    return 1;
}

/* Find the plane; returns false if there is none. */
static bool find_plane(PolygonData *d)
{
    d->origin = d->points[0];
    V3 along = farthest_off(d, v3(0, 0, 0));
    double extent = v3_len(along);
    d->u = v3_unit(along);
    V3 off = farthest_off(d, d->u);
    d->normal = v3_unit(v3_cross(d->u, off));
    if (!(v3_len(v3_cross(d->u, off)) > FLAT_SLACK * extent) || !(v3_len2(d->normal) > 0))
        return false;
    d->normal = v3_scale(d->normal, facing(d, extent));
    d->v = v3_unit(v3_cross(d->normal, d->u));
    for (uint32_t i = 0; i < d->count; i++)
        d->offset = fmax(d->offset, fabs(v3_dot(d->normal, v3_sub(d->points[i], d->origin))));
    d->pad = FLAT_SLACK * extent;
    return d->offset <= FLAT_SLACK * extent;
}

static V2 in_plane(const PolygonData *d, V3 p)
{
    p = v3_sub(p, d->origin);
    return (V2){v3_dot(d->u, p), v3_dot(d->v, p)};
}

static bool make_edges(Arena *arena, PolygonData *d)
{
    d->edges = ARENA_ARRAY(arena, PolygonEdge, d->count);
    if (!d->edges)
        return false;
    d->lo = d->hi = (V2){0, 0};
    d->bound = BOUND_EMPTY;
    for (uint32_t i = 0; i < d->count; i++) {
        V2 a = in_plane(d, d->points[i]), b = in_plane(d, d->points[d->next[i]]);
        d->edges[i] = (PolygonEdge){a, b, hypot(b.u - a.u, b.v - a.v)};
        d->lo = (V2){fmin(d->lo.u, a.u), fmin(d->lo.v, a.v)};
        d->hi = (V2){fmax(d->hi.u, a.u), fmax(d->hi.v, a.v)};
        d->bound = bound_add(d->bound, d->points[i]);
    }
    d->bound = bound_pad(d->bound);
    return true;
}

static uint32_t band_of(const PolygonData *d, double v)
{
    double band = (v - d->lo.v) * d->band_scale;
    if (!(band > 0))
        return 0;
    return band < d->band_count ? (uint32_t)band : d->band_count - 1;
}

/* The bands an edge is listed in. */
static void edge_bands(const PolygonData *d, uint32_t edge, uint32_t *first, uint32_t *last)
{
    const PolygonEdge *e = &d->edges[edge];
    *first = band_of(d, fmin(e->from.v, e->to.v) - d->pad);
    *last = band_of(d, fmax(e->from.v, e->to.v) + d->pad);
}

static size_t count_entries(PolygonData *d, uint32_t band_count)
{
    size_t entries = 0;
    d->band_count = band_count;
    d->band_scale = band_count / (d->hi.v - d->lo.v);
    for (uint32_t i = 0; i < d->count; i++) {
        uint32_t first, last;
        edge_bands(d, i, &first, &last);
        entries += last - first + 1;
    }
    return entries;
}

/* List the edges of each band: count them, then fill from the back. */
static bool make_bands(Arena *arena, PolygonData *d)
{
    uint32_t band_count = d->count;
    size_t entries = count_entries(d, band_count);
    while (band_count > 1 && entries > (size_t)BAND_SHARE * d->count)
        entries = count_entries(d, band_count /= 2);
    d->bands = ARENA_ARRAY(arena, uint32_t, (size_t)d->band_count + 1);
    d->band_edges = ARENA_ARRAY(arena, uint32_t, entries);
    if (!d->bands || !d->band_edges)
        return false;
    uint32_t first, last;
    for (uint32_t i = 0; i < d->count; i++) {
        edge_bands(d, i, &first, &last);
        for (uint32_t band = first; band <= last; band++)
            d->bands[band]++;
    }
    for (uint32_t band = 1; band <= d->band_count; band++)
        d->bands[band] += d->bands[band - 1];
    for (uint32_t i = d->count; i-- > 0;) {
        edge_bands(d, i, &first, &last);
        for (uint32_t band = first; band <= last; band++)
            d->band_edges[--d->bands[band]] = i;
    }
    return true;
}

bool polygon_prepare(Arena *arena, PolygonData *data, bool *is_flat)
{
    *is_flat = find_plane(data);
    return !*is_flat || (make_edges(arena, data) && make_bands(arena, data));
}

/* --- asking -------------------------------------------------------------------------------- */

typedef enum Side { SIDE_OUTSIDE, SIDE_INSIDE, SIDE_UNSURE } Side;

/* Is the point nearer to the edge than `error`? */
static bool is_near(const PolygonEdge *e, V2 p, double error)
{
    if (p.u < fmin(e->from.u, e->to.u) - error || p.u > fmax(e->from.u, e->to.u) + error ||
        p.v < fmin(e->from.v, e->to.v) - error || p.v > fmax(e->from.v, e->to.v) + error)
        return false;
    double cross =
        (e->to.u - e->from.u) * (p.v - e->from.v) - (e->to.v - e->from.v) * (p.u - e->from.u);
    return fabs(cross) <= 2 * error * e->length;
}

/* Count the edges to the right of a point, which is off by up to `error`. */
static Side side_of(const PolygonData *d, V2 p, double error)
{
    if (!(error < d->pad))
        return SIDE_UNSURE;
    if (p.u < d->lo.u - error || p.u > d->hi.u + error || p.v < d->lo.v - error ||
        p.v > d->hi.v + error)
        return SIDE_OUTSIDE;
    uint32_t band = band_of(d, p.v);
    bool is_inside = false;
    for (uint32_t i = d->bands[band]; i < d->bands[band + 1]; i++) {
        const PolygonEdge *e = &d->edges[d->band_edges[i]];
        if (is_near(e, p, error))
            return SIDE_UNSURE;
        if ((e->from.v > p.v) == (e->to.v > p.v))
            continue;
        double cross =
            (e->to.u - e->from.u) * (p.v - e->from.v) - (e->to.v - e->from.v) * (p.u - e->from.u);
        is_inside ^= (cross > 0) == (e->to.v > p.v);
    }
    return is_inside ? SIDE_INSIDE : SIDE_OUTSIDE;
}

static void polygon_hits(const Shape *shape, const LocalRay *ray, LeafHits *out)
{
    const PolygonData *d = shape->u.polygon;
    out->is_inside_before = false;
    out->count = 0;
    double speed = v3_dot(d->normal, ray->d), height = v3_dot(d->normal, v3_sub(d->origin, ray->o));
    double t = height / speed;
    if (speed == 0 || !isfinite(t))
        return;
    double off = v3_sum_abs(local_error(ray, t)) + 2 * shape->rounding.place;
    double turned = 8 * EPS_DOUBLE * v3_sum_abs(ray->d);
    double error = (off + fabs(t) * turned) / fabs(speed) + 4 * EPS_DOUBLE * fabs(t);
    V3 p = v3_mad(ray->o, t, ray->d);
    Side side = side_of(d, in_plane(d, p), off + 2 * error * v3_sum_abs(ray->d));
    if (side == SIDE_UNSURE) {
        Ray line = {ray->o, ray->d, -INFINITY, INFINITY};
        side = loops_hold(d->points, d->next, d->count, &line) ? SIDE_INSIDE : SIDE_OUTSIDE;
    }
    if (side == SIDE_INSIDE)
        out->at[out->count++] = (LeafHit){.t = t, .t_error = error, .is_visible = true};
}

static void polygon_point(const Shape *shape, const Crossing *crossing, V3 p, LocalPoint *out)
{
    const PolygonData *d = shape->u.polygon;
    (void)crossing;
    double off = v3_dot(d->normal, v3_sub(p, d->origin));
    *out = (LocalPoint){.p = v3_mad(p, -off, d->normal),
                        .ng = d->normal,
                        .error = 2 * shape->rounding.place + 4 * EPS_DOUBLE * fabs(off)};
}

static Bound polygon_bound(const Shape *shape)
{
    Bound b = shape->u.polygon->bound;
    if (shape->is_transformed)
        b = bound_transform(b, &shape->xform);
    return shape->rounding.is_exact ? b : bound_pad(b);
}

/* The points' distance from the plane counts as rounding of their numbers. */
static double polygon_size(const Shape *shape)
{
    const PolygonData *d = shape->u.polygon;
    return v3_max_abs(v3_max(v3_abs(d->bound.lo), v3_abs(d->bound.hi))) + d->offset / PLACE_EPS;
}

const ShapeOps polygon_ops = {
    .hits = polygon_hits, .point = polygon_point, .bound = polygon_bound, .size = polygon_size};
