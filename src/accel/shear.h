/* Watertight tests of triangles, in double.
 *
 * The test shears space so that the ray becomes the z axis and asks on which side of each edge
 * the ray passes.  The sign of an edge function is exact for the sheared points, the same for
 * both triangles at an edge, and an exact zero is decided as if the ray were moved by an
 * infinitesimal step; so a line meets exactly one of the triangles around an edge or a corner
 * on each side of a closed mesh.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_ACCEL_SHEAR_H
#define PMS_ACCEL_SHEAR_H

#include "accel/accel.h"
#include "math/eps.h"

/* A ray made the z axis. */
typedef struct Shear {
    V3 o;           /* origin, moved to where the ray enters the index */
    int kx, ky, kz; /* kz: the axis the ray goes along most */
    double sx, sy, sz;
    double start;   /* t of o */
    double o_error; /* rounding of o */
} Shear;

/* A vertex in the sheared space: the ray is x = y = 0, and z is t along it. */
typedef struct Sheared {
    double x, y, z;
} Sheared;

static inline Sheared shear_point(const Shear *s, V3 p)
{
    p = v3_sub(p, s->o);
    double along = v3_at(p, s->kz);
    return (Sheared){v3_at(p, s->kx) - s->sx * along, v3_at(p, s->ky) - s->sy * along,
                     s->sz * along};
}

/* Return a.x b.y - a.y b.x with the right sign.  The rounding error of the difference of two
 * rounded products is below 2 ulps of the larger one; inside that the error terms decide. */
static inline double shear_edge(Sheared a, Sheared b)
{
    double p = a.x * b.y, q = a.y * b.x, e = p - q;
    if (fabs(e) > 4 * EPS_DOUBLE * (fabs(p) + fabs(q)))
        return e;
    return e + (fma(a.x, b.y, -p) - fma(a.y, b.x, -q));
}

/* Return the side of an edge the ray passes on: as if it were moved a little in x, and much
 * less in y, when it meets the edge exactly. */
static inline bool shear_is_left(double e, Sheared a, Sheared b)
{
    if (e != 0)
        return e > 0;
    return a.y != b.y ? a.y > b.y : b.x > a.x;
}

/* Make the shear of a ray that is moved to t = start. */
static inline void shear_init(Shear *s, const Ray *ray, double start)
{
    V3 d = ray->d, o = start == 0 ? ray->o : ray_at(ray, start);
    double far = v3_max_abs(ray->o) + fabs(start) * v3_max_abs(d);
    s->start = start;
    s->o_error = start == 0 ? 0 : 2 * EPS_DOUBLE * far;
    V3 size = v3(fabs(d.x), fabs(d.y), fabs(d.z));
    s->o = o;
    s->kz = size.x > size.y ? (size.x > size.z ? 0 : 2) : (size.y > size.z ? 1 : 2);
    s->kx = (s->kz + 1) % 3;
    s->ky = (s->kz + 2) % 3;
    double z = v3_at(d, s->kz);
    s->sx = v3_at(d, s->kx) / z;
    s->sy = v3_at(d, s->ky) / z;
    s->sz = 1 / z;
}

/* Bound the error of t: the sheared points are off by a few ulps of their distance, which moves
 * t by that much, and by the slope of the triangle times it. */
static inline void shear_bound_error(const Shear *s, const Sheared p[3], double det, TriHit *hit)
{
    double width = 0, depth = 0, far = 0;
    for (int i = 0; i < 3; i++) {
        int next = i == 2 ? 0 : i + 1;
        width = num_max(width, fabs(p[next].x - p[i].x) + fabs(p[next].y - p[i].y));
        depth = num_max(depth, fabs(p[next].z - p[i].z));
        far = num_max(far, fabs(p[i].z));
    }
    /* Along the ray's main axis a unit of t is at least 1/sqrt(3) of its length. */
    double per_z = fabs(s->sz);
    double off = s->o_error + 8 * EPS_DOUBLE * (far / per_z + width);
    hit->t_slope = per_z + 2 * depth * width / fabs(det);
    hit->t_error = off * hit->t_slope + 4 * EPS_DOUBLE * (fabs(s->start) + far);
}

/* Find where the line meets a triangle; false when it does not or t is not in (tmin, tmax). */
static inline bool sheared_meets(const Shear *s, const Sheared p[3], double tmin, double tmax,
                                 TriHit *out)
{
    double e0 = shear_edge(p[1], p[2]), e1 = shear_edge(p[2], p[0]), e2 = shear_edge(p[0], p[1]);
    bool left = shear_is_left(e0, p[1], p[2]);
    if (left != shear_is_left(e1, p[2], p[0]) || left != shear_is_left(e2, p[0], p[1]))
        return false;
    double det = e0 + e1 + e2;
    if (det == 0) /* seen from its edge */
        return false;
    out->is_along = left == (s->sz > 0);
    out->u = e1 / det;
    out->v = e2 / det;
    out->t = s->start + (e0 * p[0].z + e1 * p[1].z + e2 * p[2].z) / det;
    if (!(out->t > tmin && out->t < tmax))
        return false;
    shear_bound_error(s, p, det, out);
    return true;
}

/* The same for corners that are not yet sheared. */
static inline bool sheared_test(const Shear *s, const V3 *a, const V3 *b, const V3 *c, double tmin,
                                double tmax, TriHit *out)
{
    const Sheared p[3] = {shear_point(s, *a), shear_point(s, *b), shear_point(s, *c)};
    return sheared_meets(s, p, tmin, tmax, out);
}

#endif
