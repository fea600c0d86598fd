/* Vectors in space: points, directions and normals share one type.  What differs between
 * them is the transform (xform.h).  Left-handed axes, as the language has them.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_MATH_V3_H
#define PMS_MATH_V3_H

#include <math.h>
#include <stdbool.h>

#define PMS_PI 3.14159265358979323846

/* The smaller or larger of two numbers; a when b is NaN.  fmin and fmax are calls into the
 * library, for they must look for NaN: too slow for inner loops. */
static inline double num_min(double a, double b) { return b < a ? b : a; }
static inline double num_max(double a, double b) { return b > a ? b : a; }

typedef struct V2 {
    double u, v;
} V2;

typedef struct V3 {
    double x, y, z;
} V3;

static inline V3 v3(double x, double y, double z) { return (V3){x, y, z}; }
static inline V3 v3_add(V3 a, V3 b) { return v3(a.x + b.x, a.y + b.y, a.z + b.z); }
static inline V3 v3_sub(V3 a, V3 b) { return v3(a.x - b.x, a.y - b.y, a.z - b.z); }
static inline V3 v3_mul(V3 a, V3 b) { return v3(a.x * b.x, a.y * b.y, a.z * b.z); }
static inline V3 v3_scale(V3 a, double s) { return v3(a.x * s, a.y * s, a.z * s); }
static inline V3 v3_neg(V3 a) { return v3(-a.x, -a.y, -a.z); }
static inline double v3_dot(V3 a, V3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline double v3_len2(V3 a) { return v3_dot(a, a); }
static inline double v3_len(V3 a) { return sqrt(v3_dot(a, a)); }
static inline double v3_dist(V3 a, V3 b) { return v3_len(v3_sub(a, b)); }

/* Return a + s*b. */
static inline V3 v3_mad(V3 a, double s, V3 b)
{
    return v3(a.x + s * b.x, a.y + s * b.y, a.z + s * b.z);
}

static inline V3 v3_cross(V3 a, V3 b)
{
    return v3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

/* Return a/|a|; the zero vector stays zero.  Scaled first where the square would overflow or
 * underflow. */
static inline V3 v3_unit(V3 a)
{
    double length2 = v3_len2(a);
    if (!(length2 > 1e-280 && length2 < 1e280)) {
        double largest = num_max(num_max(fabs(a.x), fabs(a.y)), fabs(a.z));
        if (!(largest > 0))
            return v3(0, 0, 0);
        int exponent;
        frexp(largest, &exponent);
        a = v3(ldexp(a.x, -exponent), ldexp(a.y, -exponent), ldexp(a.z, -exponent));
        length2 = v3_len2(a);
    }
    return v3_scale(a, 1 / sqrt(length2));
}

/* Component by component; a NaN in b counts for nothing. */
static inline V3 v3_min(V3 a, V3 b)
{
    return v3(num_min(a.x, b.x), num_min(a.y, b.y), num_min(a.z, b.z));
}

static inline V3 v3_max(V3 a, V3 b)
{
    return v3(num_max(a.x, b.x), num_max(a.y, b.y), num_max(a.z, b.z));
}

/* Return the largest magnitude of the components. */
static inline double v3_max_abs(V3 a)
{
    return num_max(num_max(fabs(a.x), fabs(a.y)), fabs(a.z));
}

static inline bool v3_is_finite(V3 a) { return isfinite(a.x) && isfinite(a.y) && isfinite(a.z); }

/* Return component 0, 1 or 2. */
static inline double v3_at(V3 a, int axis) { return axis == 0 ? a.x : axis == 1 ? a.y : a.z; }

/* Return the direction d mirrored at a surface with unit normal n. */
static inline V3 v3_reflect(V3 d, V3 n) { return v3_mad(d, -2 * v3_dot(d, n), n); }

/* Make an orthonormal frame (s, t, n) around the unit vector n.
 * Source: Duff et al., Building an Orthonormal Basis, Revisited, JCGT 6(1), 2017. */
static inline void v3_frame(V3 n, V3 *s, V3 *t)
{
    double sign = copysign(1.0, n.z);
    double a = -1 / (sign + n.z);
    double b = n.x * n.y * a;
    *s = v3(1 + sign * n.x * n.x * a, sign * b, -sign * n.x);
    *t = v3(b, sign + n.y * n.y * a, -n.y);
}

#endif
