/* Real roots of polynomials, with bounds on their errors.
 *
 * Coefficients are given lowest first: c[0] + c[1] x + c[2] x^2 ...  c_error holds bounds on
 * their absolute errors, or is NULL when they are exact.  No tolerance is absolute: scaling x
 * by a power of two scales the roots and nothing else.  Leading coefficients that are exactly
 * zero lower the degree.  A double root, to the precision of the coefficients, is reported as
 * two equal ones.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_MATH_ROOTS_H
#define PMS_MATH_ROOTS_H

#include <stdbool.h>

typedef struct Root {
    double x;
    double error; /* bound on |x - exact root| */
} Root;

/* Find the real roots of a quadratic, ascending; returns how many.  One that is zero everywhere has
 * none.  Never fails. */
int roots_quadratic(const double c[3], const double *c_error, Root out[2]);

/* Find the real roots of a polynomial of any degree up to ROOTS_DEGREE_MAX from lo to hi,
 * ascending; returns how many.  lo and hi may be infinite.
 *
 * c, c_error  degree + 1 numbers each, as above.
 * out         room for `degree` roots.
 *
 * Roots of even multiplicity, to the precision of the coefficients, are two equal ones, other
 * multiple roots are one; their bounds are as wide as the polynomial cannot be told from zero.
 * At lo and hi the sign that is computed counts, so a root there may be left out.  The digits are
 * best when 0 is near the roots.  Never fails; what is not finite has no roots. */
enum { ROOTS_DEGREE_MAX = 35 };
int roots_within(const double *c, const double *c_error, int degree, double lo, double hi,
                 Root *out);

/* The same for the first roots: ends after `most` of them, or a few more.  *is_negative: the sign
 * at lo that goes with them; each root that is not one of two equal ones changes it. */
int roots_first(const double *c, const double *c_error, int degree, double lo, double hi, int most,
                bool *is_negative, Root *out);

/* Return a power of two beyond all roots of a polynomial whose leading coefficient is not 0. */
double roots_bound(const double *c, int degree);

/* Find the real roots of a cubic fast, to about 1e-9 of the size of the largest; c[3] is not 0.
 * A double root may be given twice, once or not at all. */
int roots_cubic_rough(const double c[4], double out[3]);

#endif
