/* Quadrics: u Q u + l u + k = 0, where u is what a point is away from the centre.  Inside is where
 * this is negative.  Without a centre (paraboloids, cylinders) u starts at the origin.
 *
 * Lines are measured from where they pass the centre, so that the digits of the coefficients
 * do not depend on how far away they start.  SPDX-License-Identifier: Apache-2.0 */
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

/* The magnitudes that errors are bounded by: no entry of Q times a vector is above square_size
 * times the sum of the vector's magnitudes. */
static void measure(QuadricParams *q)
{
    q->square_size = num_max(v3_max_abs(q->square), 0.5 * v3_max_abs(q->mixed));
    q->linear_size = v3_max_abs(q->linear);
    q->linear_doubt_size = v3_max_abs(q->linear_doubt);
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

/* Move the origin of u to a place. */
static void move_center(QuadricParams *q, V3 center)
{
    V3 half = square_times(q, center);
    double far = v3_sum_abs(center), size = q->square_size * far;
    q->center = center;
    q->doubt = 8 * EPS_DOUBLE * (far * (size + q->linear_size) + fabs(q->constant));
    q->constant += v3_dot(center, v3_add(half, q->linear));
    double doubt = 4 * EPS_DOUBLE * (2 * size + q->linear_size);
    q->linear_doubt = v3(doubt, doubt, doubt);
    q->linear = v3_mad(q->linear, 2, half);
}

Shape *shape_quadric(Arena *arena, V3 square, V3 mixed, V3 linear, double constant)
{
    Shape *shape = leaf_new(arena, SHAPE_QUADRIC);
    if (!shape)
        return NULL;
    QuadricParams *q = &shape->u.quadric;
    *q = (QuadricParams){.square = square, .mixed = mixed, .linear = linear, .constant = constant};
    V3 row[3];
    measure(q);
    if (invert(q, row) && v3_max_abs(linear) > 0) {
        V3 half = v3_scale(linear, -0.5);
        move_center(q, v3(v3_dot(row[0], half), v3_dot(row[1], half), v3_dot(row[2], half)));
        measure(q);
    }
    leaf_place(shape, &XFORM_IDENTITY);
    return shape;
}

/* The value at u, its gradient, and a bound on the error of the value; off: that of u, summed over
 * the axes. */
typedef struct Value {
    double f, error;
    V3 gradient;
} Value;

static Value value_at(const QuadricParams *q, V3 u, double off)
{
    V3 half = square_times(q, u);
    double f = v3_dot(u, v3_add(half, q->linear)) + q->constant, far = v3_sum_abs(u);
    double size = q->square_size * far;
    double error = 8 * EPS_DOUBLE * (far * (size + q->linear_size) + fabs(q->constant)) + q->doubt +
                   far * q->linear_doubt_size + (2 * size + q->linear_size) * off;
    return (Value){f, error, v3_mad(q->linear, 2, half)};
}

static void quadric_hits(const Shape *shape, const LocalRay *ray, LeafHits *out)
{
    const QuadricParams *q = &shape->u.quadric;
    V3 from = v3_sub(ray->o, q->center);
    double base = -v3_dot(from, ray->d) / v3_len2(ray->d);
    V3 u = v3_mad(from, base, ray->d);
    double off = v3_sum_abs(local_error(ray, base)) + 4 * EPS_DOUBLE * v3_sum_abs(q->center);
    double d = v3_sum_abs(ray->d), d_off = v3_sum_abs(ray->d_error), size = q->square_size;
    double slope = 2 * size * v3_sum_abs(u) + q->linear_size;
    Value v = value_at(q, u, off);
    const double c[3] = {v.f, v3_dot(v.gradient, ray->d), v3_dot(ray->d, square_times(q, ray->d))};
    const double e[3] = {v.error,
                         d * (8 * EPS_DOUBLE * slope + q->linear_doubt_size + 2 * size * off) +
                             slope * d_off,
                         d * size * (8 * EPS_DOUBLE * d + 2 * d_off)};
    Root root[2];
    bool is_straight = fabs(c[2]) <= e[2];
    int count = roots_quadratic((double[]){c[0], c[1], is_straight ? 0 : c[2]}, e, root);
    out->count = 0;
    out->is_inside_before = is_straight ? c[1] > 0 || (c[1] == 0 && c[0] < 0) : c[2] < 0;
    /* What is touched only, and planes that are there twice, are not seen. */
    if (count == 2 && root[0].x + root[0].error >= root[1].x - root[1].error)
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
    V3 u = v3_sub(p, q->center);
    Value v = value_at(q, u, 0);
    for (int i = 0; i < 3 && fabs(v.f) > v.error; i++) {
        V3 next = v3_mad(u, -v.f / v3_len2(v.gradient), v.gradient);
        Value better = value_at(q, next, 0);
        if (!(fabs(better.f) < fabs(v.f)))
            break;
        u = next;
        v = better;
    }
    out->p = v3_add(u, q->center);
    out->ng = v3_unit(v.gradient);
    double slope = v3_len(v.gradient);
    double curve = v3_max_abs(q->square) + v3_max_abs(q->mixed);
    if (!(slope > 0))
        out->ng = v3(1, 0, 0); /* at the tip of a cone */
    /* Next to a tip the gradient says little, and the distance from the tip is a bound. */
    double far = sqrt(4 * v.error / curve), near = 2 * v.error / slope;
    out->error = (near < far || !(far >= 0) ? near : far) +
                 8 * EPS_DOUBLE * (v3_sum_abs(u) + v3_sum_abs(q->center));
}

static bool quadric_is_inside(const Shape *shape, V3 p)
{
    const QuadricParams *q = &shape->u.quadric;
    return value_at(q, v3_sub(p, q->center), 0).f <= 0;
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
    double half[3];
    for (int i = 0; i < 3; i++) {
        const double *m = shape->xform.to[i];
        V3 way = v3(m[0], m[1], m[2]);
        V3 turned = v3(v3_dot(row[0], way), v3_dot(row[1], way), v3_dot(row[2], way));
        half[i] = sqrt(num_max(-(q->constant - q->doubt), 0) * num_max(v3_dot(way, turned), 0));
    }
    return v3_scale(v3(half[0], half[1], half[2]), 1 + 64 * FLAT);
}

/* Cylinders along an axis: narrow the box where a section across the axis is an ellipse. */
static void cut_by_section(const Shape *shape, int axis, Bound *b)
{
    const QuadricParams *q = &shape->u.quadric;
    const double s[3] = {q->square.x, q->square.y, q->square.z};
    const double l[3] = {q->linear.x, q->linear.y, q->linear.z};
    const double m[3] = {q->mixed.z, q->mixed.y, q->mixed.x}; /* of the two axes other than i */
    int i = (axis + 1) % 3, k = (axis + 2) % 3;
    bool is_along = s[axis] == 0 && l[axis] == 0 && m[i] == 0 && m[k] == 0;
    if (!is_along || m[axis] != 0 || !(s[i] > 0 && s[k] > 0))
        return;
    double ci = -l[i] / (2 * s[i]), ck = -l[k] / (2 * s[k]);
    double radius2 = s[i] * ci * ci + s[k] * ck * ck - q->constant;
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
        V3 c = xform_point(&shape->xform, q->center), half = ellipsoid_half(shape, row);
        return bound_pad((Bound){v3_sub(c, half), v3_add(c, half)});
    }
    Bound b = BOUND_ALL;
    if (!xform_is_plain(&shape->xform) || q->center.x != 0 || q->center.y != 0 || q->center.z != 0)
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
