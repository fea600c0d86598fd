/* Real roots of polynomials of degree two to four, with bounds on their errors.
 *
 * Coefficients are given lowest first: c[0] + c[1] x + c[2] x^2 ...  c_error holds bounds on
 * their absolute errors, or is NULL when they are exact.  No tolerance is absolute: scaling x
 * by a power of two scales the roots and nothing else.  Leading coefficients that are exactly
 * zero lower the degree.  A double root, to the precision of the coefficients, is reported as
 * two equal ones.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_MATH_ROOTS_H
#define PMS_MATH_ROOTS_H

typedef struct Root {
    double x;
    double error; /* bound on |x - exact root| */
} Root;

/* Find the real roots, ascending; returns how many.  A polynomial that is zero everywhere has
 * none.  Never fails. */
int roots_quadratic(const double c[3], const double *c_error, Root out[2]);
int roots_cubic(const double c[4], const double *c_error, Root out[3]);
int roots_quartic(const double c[5], const double *c_error, Root out[4]);

/* Find the real roots of a cubic fast, to about 1e-9 of the size of the largest; c[3] is not 0.
 * A double root may be given twice, once or not at all. */
int roots_cubic_rough(const double c[4], double out[3]);

#endif
