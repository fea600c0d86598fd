/* Tori around the y axis.  Parts: 0 the outer surface, 1 the inner one of a torus whose tube is
 * wider than its ring.
 *
 * The turning points of the quartic along the line, found from its derivative about the point
 * nearest to the centre, separate its roots.  Signs and roots come from the distance to the
 * ring itself, g = (rho - R)^2 + y^2 - r^2, which keeps its digits where the expanded quartic
 * loses them (thin tubes).  SPDX-License-Identifier: Apache-2.0 */
#include "math/roots.h"
#include "shape/shape_int.h"

Shape *shape_torus(Arena *arena, double major, double minor)
{
    Shape *shape = leaf_new(arena, SHAPE_TORUS);
    if (!shape)
        return NULL;
    shape->u.torus = (TorusParams){major, minor};
    leaf_place(shape, &XFORM_IDENTITY);
    return shape;
}

/* The line in units of length about its middle point f. */
typedef struct TorusLine {
    V3 f, e;            /* e unit */
    double base, speed; /* of the ray: t is base + h / speed */
    double major, minor;
    double side; /* +1: the outer surface, -1: the inner one (the ring's far side) */
} TorusLine;

typedef struct TorusValue {
    double g, slope;
} TorusValue;

static TorusValue torus_at(const TorusLine *l, double h)
{
    V3 p = v3_mad(l->f, h, l->e);
    double rho = sqrt(p.x * p.x + p.z * p.z), w = rho - l->side * l->major;
    double turn = rho > 0 ? (p.x * l->e.x + p.z * l->e.z) / rho : 0;
    return (TorusValue){w * w + (p.y - l->minor) * (p.y + l->minor), 2 * (w * turn + p.y * l->e.y)};
}

/* Find the root between two separators, where g has the values given: first as if g were a
 * parabola with its top at the inner one, then by Newton steps kept inside the bracket. */
static double torus_root(const TorusLine *l, double lo, double hi, double g_lo, double g_hi)
{
    bool is_rising = g_hi > 0;
    double share = sqrt(is_rising ? g_lo / (g_lo - g_hi) : g_hi / (g_hi - g_lo));
    double x = is_rising ? lo + (hi - lo) * share : hi - (hi - lo) * share;
    double size = l->major + l->minor;
    if (!(x > lo && x < hi))
        x = 0.5 * (lo + hi);
    for (int i = 0; i < 120; i++) {
        TorusValue v = torus_at(l, x);
        if (v.g == 0)
            return x;
        if ((v.g > 0) == is_rising)
            hi = x;
        else
            lo = x;
        double step = v.g / v.slope, next = x - step;
        /* The error after a step is about its square over the slope. */
        if (next > lo && next < hi && 4 * step * step <= EPS_DOUBLE * size * fabs(v.slope))
            return next;
        if (!(next > lo && next < hi) || (i & 7) == 7)
            next = 0.5 * (lo + hi);
        if (!(next > lo && next < hi) || fabs(next - x) <= EPS_DOUBLE * fabs(x))
            return x;
        x = next;
    }
    return x;
}

/* Points along the line, ascending: the first and the last are outside, and between two there is
 * one root at most. */
typedef struct Separators {
    int count;
    double h[5];
} Separators;

static void separate(const TorusLine *l, double lo, double hi, Separators *out)
{
    double k = v3_dot(l->f, l->e), m = v3_len2(l->f), ring = l->major * l->major;
    double rest = m + (l->major - l->minor) * (l->major + l->minor);
    double flat = l->e.x * l->e.x + l->e.z * l->e.z, along = l->f.x * l->e.x + l->f.z * l->e.z;
    const double c[4] = {k * rest - 2 * ring * along, 2 * k * k + rest - 2 * ring * flat, 3 * k, 1};
    double turns[3];
    int turn_count = roots_cubic_rough(c, turns);
    out->count = 0;
    out->h[out->count++] = lo;
    for (int i = 0; i < turn_count; i++)
        if (turns[i] > out->h[out->count - 1] && turns[i] < hi)
            out->h[out->count++] = turns[i];
    out->h[out->count++] = hi;
}

/* Add the crossings of one of the surfaces, up to the first behind tmin if that is all that is
 * wanted. */
static void add_roots(const TorusLine *l, const Separators *at, const LocalRay *ray, double wanted,
                      LeafHits *out)
{
    double size = l->major + l->minor, outside = l->minor * l->minor * 0x1p-40;
    /* Both ends are outside, whatever rounding makes of them. */
    double last = num_max(torus_at(l, at->h[0]).g, outside);
    for (int i = 1; i < at->count; i++) {
        double g = torus_at(l, at->h[i]).g, before = last;
        if (i == at->count - 1)
            g = num_max(g, outside);
        last = g;
        bool next = g > 0;
        if (next == (before > 0) || out->count == LEAF_HITS_MAX)
            continue;
        if (l->base + at->h[i] / l->speed < wanted)
            continue;
        double h = torus_root(l, at->h[i - 1], at->h[i], before, g), t = l->base + h / l->speed;
        /* g moves by 2 r times what the point is off; twice that covers its bend. */
        double off = v3_sum_abs(local_error(ray, t)) + 2 * PLACE_EPS * size;
        double own = 4 * l->minor * (off + 4 * EPS_DOUBLE * l->minor) / fabs(torus_at(l, h).slope);
        double error = own / l->speed + 4 * EPS_DOUBLE * (fabs(l->base) + fabs(t));
        int8_t change = l->side < 0 ? 0 : next ? -1 : 1;
        out->at[out->count++] = (LeafHit){t, error, l->side < 0, change, true};
        if (t > wanted && wanted > -INFINITY)
            return;
    }
}

static void sort_hits(LeafHits *hits)
{
    for (int i = 1; i < hits->count; i++) {
        LeafHit hit = hits->at[i];
        int place = i;
        for (; place > 0 && hits->at[place - 1].t > hit.t; place--)
            hits->at[place] = hits->at[place - 1];
        hits->at[place] = hit;
    }
}

/* List all crossings, or, if `wanted` is not -INFINITY, at least the first with a larger t. */
static void find_hits(const Shape *shape, const LocalRay *ray, double wanted, LeafHits *out)
{
    TorusLine l = {.major = shape->u.torus.major, .minor = shape->u.torus.minor, .side = 1};
    out->count = 0;
    out->is_inside_before = false;
    double size = l.major + l.minor, inverse = 1 / v3_len2(ray->d);
    l.base = -v3_dot(ray->o, ray->d) * inverse;
    l.speed = v3_len(ray->d);
    l.f = v3_mad(ray->o, l.base, ray->d);
    l.e = v3_scale(ray->d, 1 / l.speed);
    /* The piece within the sphere around the torus and between its lids. */
    double room = size * size * (1 + 0x1p-40) - v3_len2(l.f);
    if (!(room > 0) || !(l.minor > 0))
        return;
    double hi = sqrt(room), lo = -hi, lid = l.minor * (1 + 0x1p-40);
    if (l.e.y != 0) {
        double a = (-lid - l.f.y) / l.e.y, b = (lid - l.f.y) / l.e.y;
        lo = num_max(lo, num_min(a, b));
        hi = num_min(hi, num_max(a, b));
    } else if (fabs(l.f.y) > lid) {
        return;
    }
    if (!(lo < hi))
        return;
    Separators at;
    separate(&l, lo, hi, &at);
    bool has_inner = l.major > 0 && l.major < l.minor;
    add_roots(&l, &at, ray, wanted, out);
    if (has_inner) {
        l.side = -1;
        add_roots(&l, &at, ray, wanted, out);
        sort_hits(out);
    }
}

static void torus_hits(const Shape *shape, const LocalRay *ray, LeafHits *out)
{
    find_hits(shape, ray, -INFINITY, out);
}

static bool torus_closest(const Shape *shape, const Ray *ray, ShapeScratch *scratch, Crossing *out)
{
    (void)scratch;
    LocalRay local;
    LeafHits hits;
    local_ray(shape, ray, &local);
    find_hits(shape, &local, ray->tmin, &hits);
    return hits_closest(shape, &hits, ray, out);
}

static void torus_point(const Shape *shape, const Crossing *crossing, V3 p, LocalPoint *out)
{
    uint32_t part = crossing->part;
    double major = shape->u.torus.major, minor = shape->u.torus.minor;
    double rho = sqrt(p.x * p.x + p.z * p.z);
    double to_ring = rho > 0 ? (part ? -major : major) / rho : 0;
    V3 ring = v3(p.x * to_ring, 0, p.z * to_ring);
    V3 n = v3_unit(v3_sub(p, ring));
    out->p = rho > 0 ? v3_mad(ring, minor, n) : p;
    out->ng = part ? v3_neg(n) : n;
    out->error = 2 * PLACE_EPS * (major + minor);
}

static V2 torus_uv(const Shape *shape, uint32_t part, double u, double v, V3 p)
{
    (void)part, (void)u, (void)v;
    double rho = sqrt(p.x * p.x + p.z * p.z);
    return (V2){1 - (atan2(p.z, p.x) + PMS_PI) / (2 * PMS_PI),
                (atan2(p.y, rho - shape->u.torus.major) + PMS_PI) / (2 * PMS_PI)};
}

static bool torus_is_inside(const Shape *shape, V3 p)
{
    double w = sqrt(p.x * p.x + p.z * p.z) - shape->u.torus.major, r = shape->u.torus.minor;
    return w * w + p.y * p.y <= r * r;
}

static Bound torus_bound(const Shape *shape)
{
    /* The ring's box, grown by the tube's ball. */
    const double(*m)[4] = shape->xform.to;
    double major = shape->u.torus.major, minor = shape->u.torus.minor;
    V3 c = xform_point(&shape->xform, v3(0, 0, 0)), half;
    half.x = major * hypot(m[0][0], m[0][2]) + minor * v3_len(v3(m[0][0], m[0][1], m[0][2]));
    half.y = major * hypot(m[1][0], m[1][2]) + minor * v3_len(v3(m[1][0], m[1][1], m[1][2]));
    half.z = major * hypot(m[2][0], m[2][2]) + minor * v3_len(v3(m[2][0], m[2][1], m[2][2]));
    return bound_pad((Bound){v3_sub(c, half), v3_add(c, half)});
}

static V3 torus_farthest(const Shape *shape, V3 n)
{
    V3 ring = circle_farthest(shape->u.torus.major, 0, v3(n.z, n.x, n.y));
    return v3_mad(v3(ring.y, ring.z, ring.x), shape->u.torus.minor, v3_unit(n));
}

const ShapeOps torus_ops = {.hits = torus_hits,
                            .closest = torus_closest,
                            .point = torus_point,
                            .uv = torus_uv,
                            .is_inside = torus_is_inside,
                            .bound = torus_bound,
                            .farthest = torus_farthest};
