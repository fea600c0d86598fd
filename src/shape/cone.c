/* Cones and cylinders: along the z axis from z = 0 to their height.  Parts: 0 wall, 1 bottom, 2
 * top.
 *
 * The line is cut to the slab between the caps and to the inside of the wall; what is left is
 * one piece, so that wall and caps meet without a gap.  The wall's discriminant is kept as a
 * difference of squares, and the quadratic is solved about the point nearest to the middle.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape_int.h"

Shape *shape_cone(Arena *arena, V3 bottom, double bottom_radius, V3 top, double top_radius,
                  bool is_open)
{
    Shape *shape = leaf_new(arena, SHAPE_CONE);
    if (!shape)
        return NULL;
    V3 axis = v3_sub(top, bottom), n = v3_unit(axis), s, t;
    shape->u.cone = (ConeParams){bottom_radius, top_radius, v3_dot(axis, n)};
    shape->is_open = is_open;
    v3_frame(n, &s, &t);
    Xform place = xform_frame(s, t, n, bottom);
    leaf_place(shape, &place);
    return shape;
}

/* The part of a line inside a convex solid. */
typedef struct Chord {
    LeafHit in, out; /* t may be infinite; then the other fields mean nothing */
} Chord;

#define CHORD_LINE ((Chord){{.t = -INFINITY}, {.t = INFINITY}})

/* Cut a chord to the slab lo <= o + t d <= hi; lo_part and hi_part name its sides.  Returns
 * false when nothing is left. */
static bool cut_slab(Chord *chord, double o, double d, double error, double lo, double hi,
                     uint32_t lo_part, uint32_t hi_part, bool is_visible)
{
    if (d == 0)
        return o >= lo && o <= hi;
    double first = (lo - o) / d, last = (hi - o) / d;
    if (d < 0) {
        double swap = first;
        first = last, last = swap;
        uint32_t swap_part = lo_part;
        lo_part = hi_part, hi_part = swap_part;
    }
    double per = 1 / fabs(d);
    if (first > chord->in.t)
        chord->in =
            (LeafHit){first, error * per + 4 * EPS_DOUBLE * fabs(first), lo_part, 1, is_visible};
    if (last < chord->out.t)
        chord->out =
            (LeafHit){last, error * per + 4 * EPS_DOUBLE * fabs(last), hi_part, -1, is_visible};
    return chord->in.t <= chord->out.t;
}

/* Turn a chord into hits. */
static void chord_hits(const Chord *chord, LeafHits *out)
{
    out->count = 0;
    out->is_inside_before = chord->in.t == -INFINITY;
    if (chord->in.t > -INFINITY)
        out->at[out->count++] = chord->in;
    if (chord->out.t < INFINITY)
        out->at[out->count++] = chord->out;
}

/* The wall x^2 + y^2 = (radius + growth z)^2 along a line: a h^2 + 2 b h + c < 0 inside. */
typedef struct Wall {
    double a, b, c, disc;
    double doubt;      /* bound on the error of the left side near a root */
    double disc_doubt; /* and of computing disc */
} Wall;

static double growth_of(const ConeParams *cone)
{
    return (cone->top - cone->bottom) / cone->height;
}

static Wall wall_of(const ConeParams *cone, V3 f, V3 d, V3 error)
{
    double growth = growth_of(cone), k = growth * d.z;
    double radius = cone->bottom + growth * f.z;
    double gx = radius * d.x - k * f.x, gy = radius * d.y - k * f.y;
    double cross = f.x * d.y - f.y * d.x;
    double g = sqrt(gx * gx + gy * gy);
    double most = num_max(cone->bottom, cone->top);
    double terms = fabs(radius) * (fabs(d.x) + fabs(d.y)) + fabs(k) * (fabs(f.x) + fabs(f.y)) +
                   fabs(f.x * d.y) + fabs(f.y * d.x);
    Wall w = {.a = d.x * d.x + d.y * d.y - k * k,
              .b = f.x * d.x + f.y * d.y - k * radius,
              .c = f.x * f.x + f.y * f.y - radius * radius,
              .disc = (g - fabs(cross)) * (g + fabs(cross)),
              .disc_doubt = 12 * EPS_DOUBLE * terms * (g + fabs(cross))};
    w.doubt = 2 * most * (error.x + error.y + fabs(growth) * error.z + 4 * PLACE_EPS * most);
    return w;
}

/* Bound the error of a root of the wall; per_root: how much it moves with the root of disc. */
static double root_error(const Wall *w, double per_root)
{
    double all = w->doubt + w->disc_doubt / fabs(w->a), touching = sqrt(2 * all / fabs(w->a));
    return num_min((w->doubt + per_root * w->disc_doubt) / sqrt(w->disc), touching);
}

/* Cut the chord at t, from above or below. */
static void cut_in(Chord *chord, double t, double error)
{
    if (t > chord->in.t)
        chord->in = (LeafHit){t, error, 0, 1, true};
}

static void cut_out(Chord *chord, double t, double error)
{
    if (t < chord->out.t)
        chord->out = (LeafHit){t, error, 0, -1, true};
}

/* Cut the chord to the inside of the wall; `base` is the t of h = 0.  Returns false when
 * nothing is left. */
static bool cut_wall(Chord *chord, const Wall *w, double base)
{
    if (!(w->disc > 0))
        return w->a < 0 || (w->a == 0 && w->c < 0);
    double root = sqrt(w->disc), q = -(w->b + copysign(root, w->b));
    double h0 = q / w->a, h1 = w->c / q, own = 4 * EPS_DOUBLE * fabs(base);
    double t0 = base + h0, t1 = base + h1;
    double e0 = own + 4 * EPS_DOUBLE * fabs(t0) + root_error(w, fabs(1 / w->a));
    double e1 = own + 4 * EPS_DOUBLE * fabs(t1) + root_error(w, fabs(h1 / q));
    bool is_swapped = h1 < h0;
    double first = is_swapped ? t1 : t0, first_error = is_swapped ? e1 : e0;
    double last = is_swapped ? t0 : t1, last_error = is_swapped ? e0 : e1;
    if (w->a > 0) {
        cut_in(chord, first, first_error);
        cut_out(chord, last, last_error);
    } else if (w->a < 0) {
        /* Inside before the first root and after the last, in one of the two nappes. */
        double before = num_min(chord->out.t, first) - chord->in.t;
        double after = chord->out.t - num_max(chord->in.t, last);
        if (before > after)
            cut_out(chord, first, first_error);
        else
            cut_in(chord, last, last_error);
    } else { /* along the wall: one root */
        if (w->b > 0)
            cut_out(chord, t1, e1);
        else
            cut_in(chord, t1, e1);
    }
    return chord->in.t < chord->out.t;
}

static void cone_hits(const Shape *shape, const LocalRay *ray, LeafHits *out)
{
    const ConeParams *cone = &shape->u.cone;
    out->count = 0;
    out->is_inside_before = false;
    V3 o = v3(ray->o.x, ray->o.y, ray->o.z - 0.5 * cone->height);
    double speed2 = v3_len2(ray->d), base = -v3_dot(o, ray->d) / speed2;
    double reach = (num_max(cone->bottom, cone->top) + 0.5 * cone->height) / sqrt(speed2);
    V3 f = v3_mad(ray->o, base, ray->d), error = local_error(ray, fabs(base) + reach);
    Chord chord = CHORD_LINE;
    if (!cut_slab(&chord, ray->o.z, ray->d.z, error.z + PLACE_EPS * cone->height, 0, cone->height,
                  1, 2, !shape->is_open))
        return;
    Wall wall = wall_of(cone, f, ray->d, error);
    if (cut_wall(&chord, &wall, base) && chord.in.t < chord.out.t)
        chord_hits(&chord, out);
}

static void cone_point(const Shape *shape, const Crossing *crossing, V3 p, LocalPoint *out)
{
    uint32_t part = crossing->part;
    const ConeParams *cone = &shape->u.cone;
    double growth = growth_of(cone);
    out->error = 2 * PLACE_EPS * (part ? cone->height : num_max(cone->bottom, cone->top));
    if (part) {
        p.z = part == 1 ? 0 : cone->height;
        out->p = p;
        out->ng = v3(0, 0, part == 1 ? -1 : 1);
        return;
    }
    p.z = num_max(0, num_min(cone->height, p.z));
    double radius = cone->bottom + growth * p.z, rho = sqrt(p.x * p.x + p.y * p.y);
    double pull = rho > 0 ? radius / rho : 0;
    out->p = v3(p.x * pull, p.y * pull, p.z);
    /* At the tip there is no normal: along the axis is as good as any. */
    V3 n = v3(p.x / rho, p.y / rho, -growth);
    out->ng = rho > 0 ? v3_unit(n) : v3(0, 0, growth < 0 ? 1 : -1);
}

static bool cone_is_inside(const Shape *shape, V3 p)
{
    const ConeParams *cone = &shape->u.cone;
    double radius = cone->bottom + growth_of(cone) * p.z;
    double w = p.x * p.x + p.y * p.y;
    if (shape->is_open)
        return p.z >= 0 && p.z <= cone->height && w <= radius * radius;
    return p.z > 0 && p.z < cone->height && w < radius * radius;
}

static Bound cone_bound(const Shape *shape)
{
    const double(*m)[4] = shape->xform.to;
    V3 reach = v3(hypot(m[0][0], m[0][1]), hypot(m[1][0], m[1][1]), hypot(m[2][0], m[2][1]));
    Bound b = BOUND_EMPTY;
    for (int end = 0; end < 2; end++) {
        V3 c = xform_point(&shape->xform, v3(0, 0, end ? shape->u.cone.height : 0));
        double r = end ? shape->u.cone.top : shape->u.cone.bottom;
        b = bound_add(bound_add(b, v3_mad(c, r, reach)), v3_mad(c, -r, reach));
    }
    return bound_pad(b);
}

/* On one of the circles at its ends. */
static V3 cone_farthest(const Shape *shape, V3 n)
{
    const ConeParams *cone = &shape->u.cone;
    V3 bottom = circle_farthest(cone->bottom, 0, n);
    V3 top = circle_farthest(cone->top, cone->height, n);
    return v3_dot(bottom, n) > v3_dot(top, n) ? bottom : top;
}

const ShapeOps cone_ops = {.hits = cone_hits,
                           .point = cone_point,
                           .is_inside = cone_is_inside,
                           .bound = cone_bound,
                           .farthest = cone_farthest};
