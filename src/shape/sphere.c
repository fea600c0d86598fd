/* Spheres.
 *
 * The quadratic is solved about the point of the line nearest to the centre, where nothing
 * cancels however far the ray starts away.  SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape_int.h"

Shape *shape_sphere(Arena *arena, V3 center, double radius)
{
    Shape *shape = leaf_new(arena, SHAPE_SPHERE);
    if (!shape)
        return NULL;
    shape->u.sphere = (SphereParams){center, radius};
    leaf_place(shape, &XFORM_IDENTITY);
    return shape;
}

/* The chord of a line in a sphere. */
typedef struct Chord {
    double middle, half2; /* t, and half its length squared; not above 0: there is none */
    double inverse;       /* 1 / |d|^2 */
    V3 o;                 /* the ray's origin from the centre */
} Chord;

static inline Chord find_chord(const SphereParams *sphere, const LocalRay *ray)
{
    V3 o = v3_sub(ray->o, sphere->center);
    double a = v3_len2(ray->d), inverse = 1 / a;
    double nearest = -v3_dot(o, ray->d) * inverse;
    V3 f = v3_mad(o, nearest, ray->d);
    /* What rounding left of f along the ray is put back. */
    double left = v3_dot(f, ray->d) * inverse;
    double inside = sphere->radius * sphere->radius - v3_len2(f) + left * left * a;
    return (Chord){nearest - left, inside * inverse, inverse, o};
}

bool sphere_is_met(const Shape *shape, const LocalRay *ray, double tmin, double tmax)
{
    Chord chord = find_chord(&shape->u.sphere, ray);
    double ahead = chord.middle - tmin, left = tmax - chord.middle;
    if (!(chord.half2 > 0))
        return false;
    bool starts_before = ahead > 0 && ahead * ahead > chord.half2;
    bool ends_behind = left > 0 && left * left > chord.half2;
    return (starts_before && (left > 0 || left * left < chord.half2)) ||
           (ends_behind && (ahead > 0 || ahead * ahead < chord.half2));
}

static void sphere_hits(const Shape *shape, const LocalRay *ray, LeafHits *out)
{
    double r = shape->u.sphere.radius;
    Chord chord = find_chord(&shape->u.sphere, ray);
    V3 o = chord.o;
    out->count = 0;
    out->is_inside_before = false;
    if (!(chord.half2 > 0))
        return;
    double middle = chord.middle, half = sqrt(chord.half2);
    /* f is off by `off`; the half chord by off f / half, or the root of what `missed` is off. */
    double off = 4 * EPS_DOUBLE * v3_sum_abs(o) + v3_sum_abs(ray->o_error) +
                 fabs(middle) * v3_sum_abs(ray->d_error) + shape->rounding.place;
    double speed2 = chord.inverse; /* (1/|d|)^2 */
    double doubt = 2 * r * off + 6 * EPS_DOUBLE * r * r;
    double own = doubt * speed2 / half, most = sqrt(doubt * speed2);
    double error =
        (own < most ? own : most) + off * sqrt(speed2) + 4 * EPS_DOUBLE * (fabs(middle) + half);
    out->count = 2;
    out->at[0] = (LeafHit){middle - half, error, 0, 1, true};
    out->at[1] = (LeafHit){middle + half, error, 0, -1, true};
}

static void sphere_point(const Shape *shape, const Crossing *crossing, V3 p, LocalPoint *out)
{
    double r = shape->u.sphere.radius;
    V3 n = v3_unit(v3_sub(p, shape->u.sphere.center));
    (void)crossing;
    out->p = v3_mad(shape->u.sphere.center, r, n);
    out->ng = n;
    out->error = shape->rounding.place + 8 * EPS_DOUBLE * r;
}

static V2 sphere_uv(const Shape *shape, uint32_t part, double u, double v, V3 p)
{
    (void)part, (void)u, (void)v;
    V3 n = v3_unit(v3_sub(p, shape->u.sphere.center));
    double turn = atan2(n.z, n.x) / (2 * PMS_PI);
    return (V2){turn < 0 ? turn + 1 : turn, 0.5 + asin(num_max(-1, num_min(1, n.y))) / PMS_PI};
}

static bool sphere_is_inside(const Shape *shape, V3 p)
{
    double r = shape->u.sphere.radius;
    return v3_len2(v3_sub(p, shape->u.sphere.center)) < r * r;
}

static Bound sphere_bound(const Shape *shape)
{
    double r = shape->u.sphere.radius;
    V3 c = shape->u.sphere.center, half = v3(r, r, r);
    if (shape->is_transformed) {
        /* The rows of the matrix are how far the unit ball reaches along each axis. */
        const double(*m)[4] = shape->xform.to;
        c = xform_point(&shape->xform, c);
        half =
            v3(r * v3_len(v3(m[0][0], m[0][1], m[0][2])), r * v3_len(v3(m[1][0], m[1][1], m[1][2])),
               r * v3_len(v3(m[2][0], m[2][1], m[2][2])));
    }
    return bound_pad((Bound){v3_sub(c, half), v3_add(c, half)});
}

static V3 sphere_farthest(const Shape *shape, V3 n)
{
    return v3_mad(shape->u.sphere.center, shape->u.sphere.radius, v3_unit(n));
}

static double sphere_size(const Shape *shape)
{
    return v3_sum_abs(shape->u.sphere.center) + shape->u.sphere.radius;
}

static bool sphere_transform(Shape *shape, const Xform *x)
{
    if (shape->is_transformed || !xform_is_plain(x) || !xform_keeps_normals(x))
        return false;
    shape->u.sphere.center = xform_point(x, shape->u.sphere.center);
    shape->u.sphere.radius *= x->to[0][0];
    return true;
}

const ShapeOps sphere_ops = {.hits = sphere_hits,
                             .point = sphere_point,
                             .uv = sphere_uv,
                             .is_inside = sphere_is_inside,
                             .bound = sphere_bound,
                             .farthest = sphere_farthest,
                             .size = sphere_size,
                             .transform = sphere_transform};
