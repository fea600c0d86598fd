/* Affine transforms, always kept with their inverse.
 *
 * A 3x4 matrix m maps the column (x,y,z,1): p'_i = m[i][0]x + m[i][1]y + m[i][2]z + m[i][3].
 * (The language writes row vectors; the readers transpose.)
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_MATH_XFORM_H
#define PMS_MATH_XFORM_H

#include "math/v3.h"

typedef struct Xform {
    double to[3][4];   /* object space to world space */
    double from[3][4]; /* world space to object space */
} Xform;

#define XFORM_IDENTITY                                                                             \
    ((Xform){{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}},                                           \
             {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}})

static inline V3 matrix_point(const double m[3][4], V3 p)
{
    return v3(m[0][0] * p.x + m[0][1] * p.y + m[0][2] * p.z + m[0][3],
              m[1][0] * p.x + m[1][1] * p.y + m[1][2] * p.z + m[1][3],
              m[2][0] * p.x + m[2][1] * p.y + m[2][2] * p.z + m[2][3]);
}

static inline V3 matrix_dir(const double m[3][4], V3 d)
{
    return v3(m[0][0] * d.x + m[0][1] * d.y + m[0][2] * d.z,
              m[1][0] * d.x + m[1][1] * d.y + m[1][2] * d.z,
              m[2][0] * d.x + m[2][1] * d.y + m[2][2] * d.z);
}

/* Multiply by the transpose of the 3x3 part. */
static inline V3 matrix_transposed_dir(const double m[3][4], V3 d)
{
    return v3(m[0][0] * d.x + m[1][0] * d.y + m[2][0] * d.z,
              m[0][1] * d.x + m[1][1] * d.y + m[2][1] * d.z,
              m[0][2] * d.x + m[1][2] * d.y + m[2][2] * d.z);
}

/* Object to world.  xform_normal does not make the result unit. */
static inline V3 xform_point(const Xform *x, V3 p) { return matrix_point(x->to, p); }
static inline V3 xform_dir(const Xform *x, V3 d) { return matrix_dir(x->to, d); }
static inline V3 xform_normal(const Xform *x, V3 n) { return matrix_transposed_dir(x->from, n); }

/* World to object. */
static inline V3 xform_point_back(const Xform *x, V3 p) { return matrix_point(x->from, p); }
static inline V3 xform_dir_back(const Xform *x, V3 d) { return matrix_dir(x->from, d); }
static inline V3 xform_normal_back(const Xform *x, V3 n) { return matrix_transposed_dir(x->to, n); }

/* Return the transform that applies `first` and then `second`. */
Xform xform_then(const Xform *first, const Xform *second);

/* Return the inverse; swaps the two matrices, no arithmetic. */
Xform xform_inverse(const Xform *x);

Xform xform_translate(V3 by);

/* Scale; no component of `by` may be 0. */
Xform xform_scale(V3 by);

/* Rotate about x, then y, then z, by radians, in the language's (left-hand) sense. */
Xform xform_rotate(V3 angles);

/* Rotate about a unit axis by radians, in the language's sense. */
Xform xform_axis_rotate(V3 axis, double angle);

/* Return the frame that maps x,y,z to s,t,n and the origin to `o`; s,t,n orthonormal. */
Xform xform_frame(V3 s, V3 t, V3 n, V3 o);

/* Make a transform from a matrix; returns false when it has no finite inverse (singular to
 * the precision of its numbers). */
bool xform_from_matrix(const double to[3][4], Xform *out);

/* Return true if the transform is exactly the identity. */
bool xform_is_identity(const Xform *x);

/* Return the largest factor by which the transform stretches any direction (an upper bound:
 * the Frobenius norm of its linear part). */
double xform_stretch(const Xform *x);

#endif
