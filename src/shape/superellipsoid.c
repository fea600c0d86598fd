/* Superellipsoids: the points that are at the distance 1 from the origin, as measured by
 * N = ((|x|^p + |y|^p)^(q/p) + |z|^q)^(1/q) with p = 2/e and q = 2/n.
 *
 * N grows in proportion, so that p / N(p) is on the surface, exactly.  Where p and q are at least 1
 * it is convex along a line: Newton's method from outside never passes the surface.  Otherwise the
 * line is cut at the planes between octants, where N has cusps, and halved until bounds on
 * N, or on its slope, tell what happens.  SPDX-License-Identifier: Apache-2.0 */
#include "math/bracket.h"
#include "shape/shape_int.h"

/* Bound on the relative rounding of N, for exponents of 1; small p and q raise it. */
#define NORM_EPS (64 * EPS_DOUBLE)

/* What is searched reaches as much beyond the surface, so that its ends are outside. */
#define BOX_SLACK 0x1p-40

enum { DEPTH_MAX = 44 };

/* Powers up to this do not vanish for any coordinate that rounding can leave. */
#define POWER_MAX 4

Shape *shape_superellipsoid(Arena *arena, double e, double n)
{
    Shape *shape = leaf_new(arena, SHAPE_SUPERELLIPSOID);
    if (!shape)
        return NULL;
    shape->u.super = (SuperParams){2 / e, 2 / n};
    leaf_place(shape, &XFORM_IDENTITY);
    return shape;
}

/* --- the norm ------------------------------------------------------------------------------ */

/* (a^p + b^p)^(1/p) for a, b >= 0. */
static double norm2(double a, double b, double p)
{
    double most = num_max(a, b), least = num_min(a, b);
    if (!(least > 0))
        return most;
    double share = exp(p * log(least / most));
    return share < 0x1p-60 ? most : most * exp(log1p(share) / p);
}

/* (a / norm2(a, b, p)): from 0 to 1. */
static double part2(double a, double b, double p)
{
    if (!(a > 0))
        return 0;
    if (b <= a)
        return exp(-log1p(b > 0 ? exp(p * log(b / a)) : 0) / p);
    double share = exp(p * log(a / b));
    return a / b * exp(-log1p(share) / p);
}

static double norm_at(const SuperParams *s, V3 p)
{
    return norm2(norm2(fabs(p.x), fabs(p.y), s->p), fabs(p.z), s->q);
}

/* norm2 and its slopes in a and b; infinite across a cusp. */
static double norm2_slopes(double a, double b, double p, double *by_a, double *by_b)
{
    double most = num_max(a, b), least = num_min(a, b), value = most, by_most = 1, by_least;
    if (!(least > 0)) {
        by_least = p > 1 ? 0 : p == 1 ? 1 : INFINITY;
    } else {
        double ratio = least / most, share = exp(p * log(ratio));
        if (share < 0x1p-60) {
            by_least = share / ratio;
        } else {
            double grow = exp(log1p(share) / p);
            value = most * grow;
            by_most = grow / (1 + share);
            by_least = by_most * share / ratio;
        }
    }
    *by_a = a >= b ? by_most : by_least;
    *by_b = a >= b ? by_least : by_most;
    return value;
}

typedef struct Norm {
    double value;
    V3 gradient;
} Norm;

static Norm norm_slopes(const SuperParams *s, V3 p)
{
    double x, y, flat, z;
    double a = norm2_slopes(fabs(p.x), fabs(p.y), s->p, &x, &y);
    double value = norm2_slopes(a, fabs(p.z), s->q, &flat, &z);
    /* Nothing times infinity: no slope towards a cusp that is not there. */
    V3 g = v3(x == 0 || flat == 0 ? 0 : x * flat, y == 0 || flat == 0 ? 0 : y * flat, z);
    return (Norm){value, v3(copysign(g.x, p.x), copysign(g.y, p.y), copysign(g.z, p.z))};
}

static double norm_error(const SuperParams *s)
{
    return NORM_EPS * (1 + 1 / s->p + 1 / s->q);
}

/* --- along a line -------------------------------------------------------------------------- */

typedef struct SuperLine {
    const SuperParams *s;
    V3 o, d;  /* about t = base of the ray */
    V3 error; /* of o */
    double base;
    double lo, hi; /* within the box, and where it is searched */
    bool is_convex;
} SuperLine;

/* Cut a line to where n . p is between -1 and 1. */
static void cut_to_slab(SuperLine *l, V3 n)
{
    double o = v3_dot(n, l->o), d = v3_dot(n, l->d), side = 1 + BOX_SLACK;
    if (d == 0) {
        l->hi = fabs(o) > side ? -INFINITY : l->hi;
        return;
    }
    double a = (-side - o) / d, b = (side - o) / d;
    l->lo = num_max(l->lo, num_min(a, b));
    l->hi = num_min(l->hi, num_max(a, b));
}

/* Cut to what is known to hold the surface; false when that is missed.  N grows as p and q fall: it
 * is no less than with 1 for those that are not above 1, and with infinity for the others. */
static bool cut_to_hull(SuperLine *l)
{
    bool is_sum_xy = l->s->p <= 1, is_sum_z = l->s->q <= 1;
    for (int i = 0; i < 3; i++)
        cut_to_slab(l, v3(i == 0, i == 1, i == 2));
    for (int side = -1; side <= 1; side += 2) {
        if (is_sum_xy && is_sum_z) {
            cut_to_slab(l, v3(1, side, 1));
            cut_to_slab(l, v3(1, side, -1));
        } else if (is_sum_xy) {
            cut_to_slab(l, v3(1, side, 0));
        } else if (is_sum_z) {
            cut_to_slab(l, v3(1, 0, side));
            cut_to_slab(l, v3(0, 1, side));
        }
    }
    return l->lo < l->hi;
}

static bool line_init(SuperLine *l, const Shape *shape, const Ray *ray, double near, double far)
{
    LocalRay local;
    local_ray(shape, ray, &local);
    l->s = &shape->u.super;
    l->is_convex = l->s->p >= 1 && l->s->q >= 1;
    l->base = -v3_dot(local.o, local.d) / v3_len2(local.d);
    l->o = v3_mad(local.o, l->base, local.d);
    l->d = local.d;
    l->error = local_error(&local, l->base);
    l->lo = near - l->base;
    l->hi = far - l->base;
    return cut_to_hull(l);
}

static V3 line_at(const SuperLine *l, double t)
{
    return v3_mad(l->o, t, l->d);
}

static double height_at(const void *ctx, double t)
{
    const SuperLine *l = ctx;
    return norm_at(l->s, line_at(l, t)) - 1;
}

/* Multiply, where nothing times infinity is nothing. */
static double slope_along(V3 g, V3 d)
{
    return (d.x != 0 ? g.x * d.x : 0) + (d.y != 0 ? g.y * d.y : 0) + (d.z != 0 ? g.z * d.z : 0);
}

static LeafHit make_hit(const SuperLine *l, double t, V3 gradient, int change)
{
    double doubt = 2 * norm_error(l->s) + slope_along(v3_abs(gradient), l->error);
    double error = doubt / fabs(slope_along(gradient, l->d));
    double at = l->base + t, most = v3_len(l->d);
    /* Across a cusp both are infinite: the place is as certain as the point. */
    if (!(error * most < 1))
        error = v3_sum_abs(l->error) / most + sqrt(doubt < 1 ? doubt : EPS_DOUBLE) / most;
    return (LeafHit){at, error + 4 * EPS_DOUBLE * (fabs(l->base) + fabs(t)), 0, (int8_t)change,
                     true};
}

/* --- convex ones --------------------------------------------------------------------------- */

/* Go from a place to the surface; way: 1 forwards, -1 back.  Newton's method stays outside.
 * Returns what was found there. */
typedef enum Approach { APPROACH_MISS, APPROACH_HIT, APPROACH_INSIDE } Approach;

static Approach approach(const SuperLine *l, double from, int way, LeafHit *out)
{
    double t = from, certain = norm_error(l->s);
    for (int i = 0; i < 200; i++) {
        Norm n = norm_slopes(l->s, line_at(l, t));
        double f = n.value - 1, slope = slope_along(n.gradient, l->d), next = t - f / slope;
        if (i == 0 && f < 0)
            return APPROACH_INSIDE;
        if (f <= certain || (next == t && slope * way < 0)) {
            *out = make_hit(l, t, n.gradient, way);
            return APPROACH_HIT;
        }
        if (!(slope * way < 0) || next < l->lo || next > l->hi)
            return APPROACH_MISS;
        t = next;
    }
    return APPROACH_MISS;
}

/* Find the two crossings of a convex one on [lo, hi]; ends that are inside have none.  most: 1 if
 * the exit is not wanted where there is an entry. */
static int convex_hits(const SuperLine *l, bool *is_inside_before, LeafHit *out, int most)
{
    Approach entry = approach(l, l->lo, 1, &out[0]);
    *is_inside_before = entry == APPROACH_INSIDE;
    if (entry == APPROACH_MISS)
        return 0;
    int count = entry == APPROACH_HIT;
    if (count >= most)
        return count;
    Approach exit = approach(l, l->hi, -1, &out[count]);
    if (exit == APPROACH_INSIDE)
        return count;
    /* What is met from one side alone is touched. */
    if (count == 1 && (exit == APPROACH_MISS || !(out[0].t < out[1].t)))
        return 0;
    return count + (exit == APPROACH_HIT);
}

/* --- the others ---------------------------------------------------------------------------- */

/* Magnitudes of x, y, z on a part of the line within an octant. */
typedef struct Corner {
    V3 lo, hi;
} Corner;

static Corner corner_of(const SuperLine *l, double a, double b)
{
    V3 p = v3_abs(line_at(l, a)), q = v3_abs(line_at(l, b));
    return (Corner){v3_min(p, q), v3_max(p, q)};
}

/* x^(p - 1) for x from 0 to 1. */
static double power_less(double x, double p)
{
    return p == 1 ? 1 : pow(x, p - 1);
}

/* The least and the largest of x^(p - 1) for x in [lo, hi]. */
static void power_range(double lo, double hi, double p, double out[2])
{
    out[0] = power_less(p >= 1 ? lo : hi, p);
    out[1] = power_less(p >= 1 ? hi : lo, p);
}

static void add_slope(const double range[2], double speed, double *least, double *most)
{
    if (speed == 0)
        return;
    *least += (speed > 0 ? range[0] : range[1]) * speed;
    *most += (speed > 0 ? range[1] : range[0]) * speed;
}

/* Is N monotone within an octant between two t? */
static bool is_monotone(const SuperLine *l, const Corner *c, double middle)
{
    const SuperParams *s = l->s;
    V3 p = line_at(l, middle);
    V3 speed = v3(copysign(1, p.x) * l->d.x, copysign(1, p.y) * l->d.y, copysign(1, p.z) * l->d.z);
    double a_lo = norm2(c->lo.x, c->lo.y, s->p), a_hi = norm2(c->hi.x, c->hi.y, s->p);
    double flat[2], x[2], y[2], z[2], least = 0, most = 0;
    power_range(part2(a_lo, c->hi.z, s->q), part2(a_hi, c->lo.z, s->q), s->q, flat);
    power_range(part2(c->lo.x, c->hi.y, s->p), part2(c->hi.x, c->lo.y, s->p), s->p, x);
    power_range(part2(c->lo.y, c->hi.x, s->p), part2(c->hi.y, c->lo.x, s->p), s->p, y);
    power_range(part2(c->lo.z, a_hi, s->q), part2(c->hi.z, a_lo, s->q), s->q, z);
    for (int i = 0; i < 2; i++) {
        x[i] *= flat[i];
        y[i] *= flat[i];
    }
    add_slope(x, speed.x, &least, &most);
    add_slope(y, speed.y, &least, &most);
    add_slope(z, speed.z, &least, &most);
    return least > 0 || most < 0;
}

typedef struct HitList {
    LeafHit *at;
    int count, most;
} HitList;

static void add_crossing(const SuperLine *l, double t, int change, HitList *out)
{
    V3 gradient = norm_slopes(l->s, line_at(l, t)).gradient;
    out->at[out->count++] = make_hit(l, t, gradient, change);
}

/* --- by powers: where these cannot vanish -------------------------------------------------- */

/* A place on the line within an octant: the magnitudes of x, y and z, their powers p, p and q, and
 * what these add up to: 1 on the surface, as N^q. */
typedef struct SuperPlace {
    double t, sum;
    double at[3], power[3];
} SuperPlace;

static bool has_powers(const SuperParams *s)
{
    return s->p <= POWER_MAX && s->q <= POWER_MAX;
}

static double sum_of(const SuperParams *s, const double power[3])
{
    double flat = power[0] + power[1];
    return (s->p == s->q ? flat : pow(flat, s->q / s->p)) + power[2];
}

static SuperPlace place_at(const SuperLine *l, double t)
{
    V3 p = v3_abs(line_at(l, t));
    SuperPlace place = {.t = t, .at = {p.x, p.y, p.z}};
    for (int i = 0; i < 3; i++)
        place.power[i] = pow(place.at[i], i < 2 ? l->s->p : l->s->q);
    place.sum = sum_of(l->s, place.power);
    return place;
}

/* Is the sum above 1 (or below it) all the way between two places, for sure? */
static bool is_one_sided(const SuperParams *s, const SuperPlace *a, const SuperPlace *b)
{
    double least[3], most[3], doubt = s->q * norm_error(s);
    for (int i = 0; i < 3; i++) {
        least[i] = num_min(a->power[i], b->power[i]);
        most[i] = num_max(a->power[i], b->power[i]);
    }
    return sum_of(s, least) > 1 + doubt || sum_of(s, most) < 1 - doubt;
}

/* x^(p - 1) of a coordinate. */
static double power_per(const SuperParams *s, const SuperPlace *place, int i)
{
    double p = i < 2 ? s->p : s->q;
    if (place->at[i] == 0)
        return p < 1 ? INFINITY : p == 1 ? 1 : 0;
    return place->power[i] / place->at[i];
}

/* Return how the sum's slope is bounded between two places: 1 or -1: it has this sign, 0: unknown.
 * x^(p - 1) is monotone. */
static int slope_sign(const SuperLine *l, const SuperPlace *a, const SuperPlace *b)
{
    const SuperParams *s = l->s;
    const double d[3] = {l->d.x, l->d.y, l->d.z};
    double flat_a = 1, flat_b = 1, least = 0, most = 0;
    if (s->p != s->q) {
        /* (x^p + y^p)^(q/p - 1): the sum is between those of the least and of the largest powers.
         */
        double lo = num_min(a->power[0], b->power[0]) + num_min(a->power[1], b->power[1]);
        double hi = num_max(a->power[0], b->power[0]) + num_max(a->power[1], b->power[1]);
        flat_a = pow(lo, s->q / s->p - 1);
        flat_b = pow(hi, s->q / s->p - 1);
    }
    for (int i = 0; i < 3; i++) {
        if (d[i] == 0)
            continue;
        double one = power_per(l->s, a, i), other = power_per(l->s, b, i);
        double speed = fabs(d[i]) * (b->at[i] > a->at[i] ? 1 : -1);
        double range[2] = {num_min(one, other), num_max(one, other)};
        if (i < 2) {
            range[0] *= num_min(flat_a, flat_b);
            range[1] *= num_max(flat_a, flat_b);
        }
        add_slope(range, speed, &least, &most);
    }
    return least > 0 ? 1 : most < 0 ? -1 : 0;
}

static double sum_at(const void *ctx, double t)
{
    return place_at(ctx, t).sum - 1;
}

static void search_powers(const SuperLine *l, const SuperPlace *a, const SuperPlace *b, int depth,
                          HitList *out)
{
    bool is_crossed = (a->sum > 1) != (b->sum > 1);
    if (out->count >= out->most || (!is_crossed && is_one_sided(l->s, a, b)))
        return;
    double middle = 0.5 * (a->t + b->t);
    if (depth >= DEPTH_MAX || !(middle > a->t && middle < b->t) || slope_sign(l, a, b) != 0) {
        double fa = a->sum - 1, fb = b->sum - 1, small = 0.25 * l->s->q * norm_error(l->s);
        if (is_crossed)
            add_crossing(l, bracket_zero(sum_at, l, a->t, fa, b->t, fb, small), fa > 0 ? 1 : -1,
                         out);
        return;
    }
    SuperPlace m = place_at(l, middle);
    search_powers(l, a, &m, depth + 1, out);
    search_powers(l, &m, b, depth + 1, out);
}

/* --- octant by octant ---------------------------------------------------------------------- */

static void search(const SuperLine *l, double a, double b, double fa, double fb, int depth,
                   HitList *out)
{
    bool is_crossed = (fa > 0) != (fb > 0);
    if (out->count >= out->most)
        return;
    Corner c = corner_of(l, a, b);
    if (norm_at(l->s, c.lo) > 1 + norm_error(l->s) || norm_at(l->s, c.hi) < 1 - norm_error(l->s)) {
        if (!is_crossed)
            return;
    }
    double middle = 0.5 * (a + b);
    if (depth >= DEPTH_MAX || !(middle > a && middle < b) || is_monotone(l, &c, middle)) {
        if (is_crossed)
            add_crossing(l, bracket_zero(height_at, l, a, fa, b, fb, 0), fa > 0 ? 1 : -1, out);
        return;
    }
    double f = height_at(l, middle);
    search(l, a, middle, fa, f, depth + 1, out);
    search(l, middle, b, f, fb, depth + 1, out);
}

/* Search between `count` cuts and the end behind them; returns whether it starts inside. */
static bool search_norm(const SuperLine *l, const double *cut, int count, HitList *out)
{
    double first = height_at(l, cut[0]), f = first;
    for (int i = 0; i < count; i++) {
        double next = height_at(l, cut[i + 1]);
        if (cut[i + 1] > cut[i])
            search(l, cut[i], cut[i + 1], f, next, 0, out);
        f = next;
    }
    return first <= 0;
}

static bool search_places(const SuperLine *l, const double *cut, int count, HitList *out)
{
    SuperPlace place = place_at(l, cut[0]);
    bool is_inside = place.sum <= 1;
    for (int i = 0; i < count && out->count < out->most; i++) {
        SuperPlace next = place_at(l, cut[i + 1]);
        if (next.t > place.t)
            search_powers(l, &place, &next, 0, out);
        place = next;
    }
    return is_inside;
}

/* Search octant by octant. */
static int general_hits(const SuperLine *l, bool *is_inside_before, LeafHit *at, int most)
{
    const double o[3] = {l->o.x, l->o.y, l->o.z}, d[3] = {l->d.x, l->d.y, l->d.z};
    double cut[5] = {l->lo};
    int count = 1;
    for (int i = 0; i < 3; i++) {
        double t = -o[i] / d[i];
        if (!(t > l->lo && t < l->hi))
            continue;
        int place = count++;
        for (; place > 1 && cut[place - 1] > t; place--)
            cut[place] = cut[place - 1];
        cut[place] = t;
    }
    cut[count] = l->hi;
    HitList list = {at, 0, most};
    *is_inside_before =
        has_powers(l->s) ? search_places(l, cut, count, &list) : search_norm(l, cut, count, &list);
    return list.count;
}

/* --- operations ---------------------------------------------------------------------------- */

enum { HITS_MAX = 32 };

/* Find the first crossings, `most` or a few more. */
static int find(const Shape *shape, const Ray *ray, double near, double far, int most,
                bool *is_inside_before, LeafHit out[HITS_MAX])
{
    SuperLine l;
    *is_inside_before = false;
    if (!line_init(&l, shape, ray, near, far))
        return 0;
    return l.is_convex ? convex_hits(&l, is_inside_before, out, most)
                       : general_hits(&l, is_inside_before, out, most);
}

static bool super_list(const Shape *shape, const Line *line, ShapeScratch *scratch)
{
    bool is_inside;
    LeafHit hits[HITS_MAX];
    Crossing crossing;
    int count = find(shape, line->ray, line->near, line->far, HITS_MAX, &is_inside, hits);
    for (int i = 0; i < count; i++) {
        crossing_fill(shape, &hits[i], &crossing);
        scratch_push(scratch, &crossing);
    }
    return is_inside;
}

static bool super_closest(const Shape *shape, const Ray *ray, ShapeScratch *scratch, Crossing *out)
{
    (void)scratch;
    bool is_inside;
    LeafHit hits[HITS_MAX];
    /* The first may be at tmin itself: then the others count. */
    for (int most = 1; most <= HITS_MAX; most += HITS_MAX - 1) {
        int count = find(shape, ray, ray->tmin, ray->tmax, most, &is_inside, hits);
        for (int i = 0; i < count; i++)
            if (hits[i].t > ray->tmin && hits[i].t < ray->tmax) {
                crossing_fill(shape, &hits[i], out);
                return true;
            }
        if (count == 0)
            return false;
    }
    return false;
}

/* A unit normal from a gradient that may be infinite along some axes. */
static V3 normal_of(V3 g)
{
    double most = v3_max_abs(g);
    if (isfinite(most))
        return v3_unit(g);
    V3 n = v3(isinf(g.x) ? copysign(1, g.x) : 0, isinf(g.y) ? copysign(1, g.y) : 0,
              isinf(g.z) ? copysign(1, g.z) : 0);
    return v3_len2(n) > 0 ? v3_unit(n) : v3(1, 0, 0);
}

static void super_point(const Shape *shape, const Crossing *crossing, V3 p, LocalPoint *out)
{
    (void)crossing;
    const SuperParams *s = &shape->u.super;
    double norm = norm_at(s, p);
    out->p = norm > 0 ? v3_scale(p, 1 / norm) : p;
    out->ng = normal_of(norm_slopes(s, out->p).gradient);
    out->error = (4 * norm_error(s) + 8 * EPS_DOUBLE) * v3_sum_abs(out->p);
}

static bool super_is_inside(const Shape *shape, V3 p)
{
    return norm_at(&shape->u.super, p) <= 1;
}

static Bound super_bound(const Shape *shape)
{
    double side = 1 + BOX_SLACK;
    Bound box = {v3(-side, -side, -side), v3(side, side, side)};
    return bound_pad(bound_transform(box, &shape->xform));
}

const ShapeOps super_ops = {.list = super_list,
                            .closest = super_closest,
                            .point = super_point,
                            .is_inside = super_is_inside,
                            .bound = super_bound};
