/* Quadrics: u Q u + l u + k = 0, where u is what a point is away from the origin, or from the
 * centre if there is one: whichever is nearer, for the digits of the terms.  Inside is where this
 * is negative.
 *
 * Lines are measured from where they pass there, so that the digits of the coefficients do not
 * depend on how far away they start.  SPDX-License-Identifier: Apache-2.0 */
#include "math/roots.h"
#include "shape/shape_int.h"

/* A determinant that is this small beside its terms says nothing. */
#define FLAT 1e-9

/* Q times a vector. */
static V3 square_times(const QuadricParams *q, V3 u)
{
    V3 s = q->square, m = v3_scale(q->mixed, 0.5);
    return v3(s.x * u.x + m.x * u.y + m.y * u.z, m.x * u.x + s.y * u.y + m.z * u.z,
              m.y * u.x + m.z * u.y + s.z * u.z);
}

/* The rows of the inverse of Q; false if it has none to speak of. */
static bool invert(const QuadricParams *q, V3 row[3])
{
    V3 s = q->square, m = v3_scale(q->mixed, 0.5);
    V3 a = v3(s.x, m.x, m.y), b = v3(m.x, s.y, m.z), c = v3(m.y, m.z, s.z);
    V3 bc = v3_cross(b, c), ca = v3_cross(c, a), ab = v3_cross(a, b);
    double det = v3_dot(a, bc), size = v3_len(a) * v3_len(b) * v3_len(c);
    if (!(fabs(det) > FLAT * size))
        return false;
    row[0] = v3_scale(bc, 1 / det);
    row[1] = v3_scale(ca, 1 / det);
    row[2] = v3_scale(ab, 1 / det);
    return v3_is_finite(row[0]) && v3_is_finite(row[1]) && v3_is_finite(row[2]);
}

/* Write the terms about a place; no entry of Q times a vector is above square_size times the sum of
 * the vector's magnitudes. */
static void move_place(const QuadricParams *q, V3 center, QuadricPlace *out)
{
    const QuadricPlace *origin = &q->place[0];
    V3 half = square_times(q, center);
    double far = v3_sum_abs(center), size = q->square_size * far;
    double terms = far * (size + origin->linear_size) + fabs(origin->constant);
    *out =
        (QuadricPlace){.center = center,
                       .linear = v3_mad(origin->linear, 2, half),
                       .constant = origin->constant + v3_dot(center, v3_add(half, origin->linear)),
                       .linear_doubt = 4 * EPS_DOUBLE * (2 * size + origin->linear_size),
                       .doubt = 8 * EPS_DOUBLE * terms};
    out->linear_size = v3_max_abs(out->linear);
}

Shape *shape_quadric(Arena *arena, V3 square, V3 mixed, V3 linear, double constant)
{
    Shape *shape = leaf_new(arena, SHAPE_QUADRIC);
    if (!shape)
        return NULL;
    QuadricParams *q = &shape->u.quadric;
    *q = (QuadricParams){.square = square, .mixed = mixed, .place_count = 1};
    q->square_size = num_max(v3_max_abs(square), 0.5 * v3_max_abs(mixed));
    q->place[0] =
        (QuadricPlace){.linear = linear, .constant = constant, .linear_size = v3_max_abs(linear)};
    V3 row[3];
    if (invert(q, row) && v3_max_abs(linear) > 0) {
        V3 half = v3_scale(linear, -0.5);
        V3 center = v3(v3_dot(row[0], half), v3_dot(row[1], half), v3_dot(row[2], half));
        move_place(q, center, &q->place[q->place_count++]);
    }
    leaf_place(shape, &XFORM_IDENTITY);
    return shape;
}

/* The value at u, its gradient, and a bound on the error of the value. */
typedef struct Value {
    double f, error;
    V3 gradient;
} Value;

static Value value_at(const QuadricParams *q, const QuadricPlace *place, V3 u)
{
    V3 half = square_times(q, u);
    double f = v3_dot(u, v3_add(half, place->linear)) + place->constant, far = v3_sum_abs(u);
    double terms = far * (q->square_size * far + place->linear_size) + fabs(place->constant);
    double error = 8 * EPS_DOUBLE * terms + place->doubt + far * place->linear_doubt;
    return (Value){f, error, v3_mad(place->linear, 2, half)};
}

/* Return the place whose terms are smaller at p. */
static const QuadricPlace *place_for(const QuadricParams *q, V3 p)
{
    const QuadricPlace *origin = &q->place[0], *center = &q->place[1];
    if (q->place_count == 1)
        return origin;
    double far = v3_sum_abs(p), near = v3_sum_abs(v3_sub(p, center->center));
    double terms = far * (q->square_size * far + origin->linear_size) + fabs(origin->constant);
    double doubt = center->doubt + near * center->linear_doubt;
    bool is_origin = 8 * EPS_DOUBLE * (terms - near * near * q->square_size) < doubt;
    return is_origin ? origin : center;
}

/* Return t where a line is nearest to a point. */
static double nearest(const LocalRay *ray, V3 p)
{
    return -v3_dot(v3_sub(ray->o, p), ray->d) / v3_len2(ray->d);
}

/* The quadratic along a line from u on: its coefficients, and bounds on their errors: those of
 * computing them, and those with what the line is off. */
typedef struct Along {
    double c[3], own[3], all[3];
} Along;

static Along along_line(const QuadricParams *q, const QuadricPlace *place, V3 u,
                        const LocalRay *ray, double off)
{
    double d = v3_sum_abs(ray->d), d_off = v3_sum_abs(ray->d_error), size = q->square_size;
    double slope = 2 * size * v3_sum_abs(u) + place->linear_size;
    Value v = value_at(q, place, u);
    Along a = {.c = {v.f, v3_dot(v.gradient, ray->d), v3_dot(ray->d, square_times(q, ray->d))},
               .own = {v.error, d * (8 * EPS_DOUBLE * slope + place->linear_doubt),
                       8 * EPS_DOUBLE * d * size * d}};
    a.all[0] = a.own[0] + slope * off;
    a.all[1] = a.own[1] + 2 * d * size * off + slope * d_off;
    a.all[2] = a.own[2] + 2 * d * size * d_off;
    return a;
}

/* What is touched only, and planes that are there twice, are not seen: but for its computing the
 * discriminant of these is 0 for every line. */
static bool is_touched(const Along *a)
{
    const double *c = a->c, *e = a->own;
    double disc = c[1] * c[1] - 4 * c[0] * c[2];
    double doubt = 2 * fabs(c[1]) * e[1] + 4 * (fabs(c[0]) * e[2] + fabs(c[2]) * e[0]);
    return disc <= doubt;
}

static void quadric_hits(const Shape *shape, const LocalRay *ray, LeafHits *out)
{
    const QuadricParams *q = &shape->u.quadric;
    double base = nearest(ray, q->place[q->place_count - 1].center);
    const QuadricPlace *place = place_for(q, v3_mad(ray->o, base, ray->d));
    if (q->place_count == 2 && place == q->place)
        base = nearest(ray, place->center);
    V3 u = v3_mad(v3_sub(ray->o, place->center), base, ray->d);
    double off = v3_sum_abs(local_error(ray, base)) + 4 * EPS_DOUBLE * v3_sum_abs(place->center);
    Along a = along_line(q, place, u, ray, off);
    Root root[2];
    bool is_straight = fabs(a.c[2]) <= a.all[2];
    int count = roots_quadratic((double[]){a.c[0], a.c[1], is_straight ? 0 : a.c[2]}, a.all, root);
    out->count = 0;
    out->is_inside_before = is_straight ? a.c[1] > 0 || (a.c[1] == 0 && a.c[0] < 0) : a.c[2] < 0;
    if (count == 2 && is_touched(&a))
        count = 0;
    bool is_inside = out->is_inside_before;
    for (int i = 0; i < count; i++, is_inside = !is_inside) {
        double t = base + root[i].x;
        double error = root[i].error + 4 * EPS_DOUBLE * (fabs(base) + fabs(t));
        if (isfinite(t))
            out->at[out->count++] = (LeafHit){t, error, 0, is_inside ? -1 : 1, true};
    }
}

static void quadric_point(const Shape *shape, const Crossing *crossing, V3 p, LocalPoint *out)
{
    (void)crossing;
    const QuadricParams *q = &shape->u.quadric;
    const QuadricPlace *place = place_for(q, p);
    V3 u = v3_sub(p, place->center);
    Value v = value_at(q, place, u);
    for (int i = 0; i < 3 && fabs(v.f) > v.error; i++) {
        V3 next = v3_mad(u, -v.f / v3_len2(v.gradient), v.gradient);
        Value better = value_at(q, place, next);
        if (!(fabs(better.f) < fabs(v.f)))
            break;
        u = next;
        v = better;
    }
    out->p = v3_add(u, place->center);
    out->ng = v3_unit(v.gradient);
    double slope = v3_len(v.gradient);
    double curve = v3_max_abs(q->square) + v3_max_abs(q->mixed);
    if (!(slope > 0))
        out->ng = v3(1, 0, 0); /* at the tip of a cone */
    /* Next to a tip the gradient says little, and the distance from the tip is a bound. */
    double far = sqrt(4 * v.error / curve), near = 2 * v.error / slope;
    out->error = (near < far || !(far >= 0) ? near : far) +
                 8 * EPS_DOUBLE * (v3_sum_abs(u) + v3_sum_abs(place->center));
}

static bool quadric_is_inside(const Shape *shape, V3 p)
{
    const QuadricParams *q = &shape->u.quadric;
    const QuadricPlace *place = place_for(q, p);
    return value_at(q, place, v3_sub(p, place->center)).f <= 0;
}

/* Is Q positive for all vectors? */
static bool is_positive(const QuadricParams *q)
{
    V3 s = q->square, m = v3_scale(q->mixed, 0.5);
    double minor = s.x * s.y - m.x * m.x;
    double det = v3_dot(v3(s.x, m.x, m.y), v3_cross(v3(m.x, s.y, m.z), v3(m.y, m.z, s.z)));
    return s.x > 0 && minor > 0 && det > 0;
}

/* The half lengths of the box around an ellipsoid. */
static V3 ellipsoid_half(const Shape *shape, const V3 row[3])
{
    const QuadricParams *q = &shape->u.quadric;
    const QuadricPlace *center = &q->place[q->place_count - 1];
    double half[3];
    for (int i = 0; i < 3; i++) {
        const double *m = shape->xform.to[i];
        V3 way = v3(m[0], m[1], m[2]);
        V3 turned = v3(v3_dot(row[0], way), v3_dot(row[1], way), v3_dot(row[2], way));
        half[i] =
            sqrt(num_max(-(center->constant - center->doubt), 0) * num_max(v3_dot(way, turned), 0));
    }
    return v3_scale(v3(half[0], half[1], half[2]), 1 + 64 * FLAT);
}

/* Cylinders along an axis: narrow the box where a section across the axis is an ellipse. */
static void cut_by_section(const Shape *shape, int axis, Bound *b)
{
    const QuadricParams *q = &shape->u.quadric;
    const double s[3] = {q->square.x, q->square.y, q->square.z};
    const QuadricPlace *origin = &q->place[0];
    const double l[3] = {origin->linear.x, origin->linear.y, origin->linear.z};
    const double m[3] = {q->mixed.z, q->mixed.y, q->mixed.x}; /* of the two axes other than i */
    int i = (axis + 1) % 3, k = (axis + 2) % 3;
    bool is_along = s[axis] == 0 && l[axis] == 0 && m[i] == 0 && m[k] == 0;
    if (!is_along || m[axis] != 0 || !(s[i] > 0 && s[k] > 0))
        return;
    double ci = -l[i] / (2 * s[i]), ck = -l[k] / (2 * s[k]);
    double radius2 = s[i] * ci * ci + s[k] * ck * ck - origin->constant;
    double *lo[3] = {&b->lo.x, &b->lo.y, &b->lo.z}, *hi[3] = {&b->hi.x, &b->hi.y, &b->hi.z};
    double hi_half = sqrt(num_max(radius2, 0) / s[i]) * (1 + FLAT) + FLAT * fabs(ci);
    double hk_half = sqrt(num_max(radius2, 0) / s[k]) * (1 + FLAT) + FLAT * fabs(ck);
    *lo[i] = ci - hi_half;
    *hi[i] = ci + hi_half;
    *lo[k] = ck - hk_half;
    *hi[k] = ck + hk_half;
}

static double moved(double scale, double offset, double x)
{
    return isfinite(x) ? scale * x + offset : x;
}

/* Only ellipsoids, and cylinders along an axis, have boxes; where all but an ellipsoid is inside
 * the box is the world. */
static Bound quadric_bound(const Shape *shape)
{
    const QuadricParams *q = &shape->u.quadric;
    V3 row[3];
    if (invert(q, row) && is_positive(q)) {
        V3 c = xform_point(&shape->xform, q->place[q->place_count - 1].center);
        V3 half = ellipsoid_half(shape, row);
        return bound_pad((Bound){v3_sub(c, half), v3_add(c, half)});
    }
    Bound b = BOUND_ALL;
    if (!xform_is_plain(&shape->xform) || q->place_count > 1)
        return b;
    for (int axis = 0; axis < 3; axis++)
        cut_by_section(shape, axis, &b);
    const double(*m)[4] = shape->xform.to;
    b.lo = v3(moved(m[0][0], m[0][3], b.lo.x), moved(m[1][1], m[1][3], b.lo.y),
              moved(m[2][2], m[2][3], b.lo.z));
    b.hi = v3(moved(m[0][0], m[0][3], b.hi.x), moved(m[1][1], m[1][3], b.hi.y),
              moved(m[2][2], m[2][3], b.hi.z));
    return b;
}

const ShapeOps quadric_ops = {.hits = quadric_hits,
                              .point = quadric_point,
                              .is_inside = quadric_is_inside,
                              .bound = quadric_bound};
