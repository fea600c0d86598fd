/* Every tolerance of pms, with its reason.
 *
 * No tolerance is an absolute length: each is a multiple of the rounding error of the
 * numbers compared, so a scene scaled by a power of two renders the same picture.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_MATH_EPS_H
#define PMS_MATH_EPS_H

#include <float.h>
#include <math.h>

/* Half an ulp of 1: the relative error of one rounded double operation. */
#define EPS_DOUBLE (DBL_EPSILON / 2)

/* Half an ulp of 1 in float: the relative error of rounding a double to float. */
#define EPS_FLOAT 0x1p-24

/* Bound on the relative error of n rounded operations in a row. */
static inline double eps_gamma(int n)
{
    return n * EPS_DOUBLE / (1 - n * EPS_DOUBLE);
}

/* Truth in the language: |v| > this.  Absolute, because the language says so. */
#define EPS_LANGUAGE 1e-10

#endif
