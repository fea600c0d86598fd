/* Polynomials on [0, 1] in Bernstein form: b[0..degree], whose ends are the values at 0 and 1.
 *
 * Roots are told from signs alone, so that pieces of a curve that share a knot agree about it:
 * a value of 0 counts as positive, and a polynomial has an odd number of roots exactly when the
 * signs of its ends differ.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_MATH_BERNSTEIN_H
#define PMS_MATH_BERNSTEIN_H

#include <stdbool.h>

enum { BERNSTEIN_DEGREE_MAX = 6 };

static inline bool bernstein_is_below(double value) { return value < 0; }

/* Find where the sign changes, ascending; returns how many.  Up to `degree` roots; a double root,
 * to rounding, is two or none.  Never fails. */
int bernstein_roots(const double *b, int degree, double *out);

/* The same for a polynomial of degree 2 whose discriminant b1^2 - b0 b2 the caller knows better. */
int bernstein_quadratic(const double b[3], double discriminant, double out[2]);

/* Return the value at x, and the derivative. */
double bernstein_at(const double *b, int degree, double x, double *slope);

/* The same polynomial in powers of x - 1/2: faster, and few digits worse. */
typedef struct BernsteinCenter {
    int degree;
    double c[BERNSTEIN_DEGREE_MAX + 1];
} BernsteinCenter;

void bernstein_center(const double *b, int degree, BernsteinCenter *out);

static inline double bernstein_center_at(const BernsteinCenter *p, double x, double *slope)
{
    double h = x - 0.5, value = p->c[p->degree], rise = 0;
    for (int i = p->degree - 1; i >= 0; i--) {
        rise = rise * h + value;
        value = value * h + p->c[i];
    }
    *slope = rise;
    return value;
}

/* Return the value at x alone; degree up to 3. */
double bernstein_value(const double *b, int degree, double x);

/* Write the polynomial on [from, to], seen as [0, 1]. */
void bernstein_part(const double *b, int degree, double from, double to, double *out);

/* Add factor a b, of two polynomials of degree 1 to 3, to one of twice the degree. */
void bernstein_add_product(const double *a, const double *b, int degree, double factor,
                           double *out);

/* Widen *lo and *hi by what the polynomial reaches on [0, 1]. */
void bernstein_range(const double *b, int degree, double *lo, double *hi);

#endif
