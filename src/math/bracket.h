/* A change of sign between two places.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_MATH_BRACKET_H
#define PMS_MATH_BRACKET_H

/* A continuous function. */
typedef double (*BracketFn)(const void *ctx, double x);

/* Find where a function changes its sign between a and b, which it has the values fa and fb at.
 *
 * small  a magnitude of the function that is as good as zero.
 *
 * Returns a place in [a, b] where it is that small, or next to where it changes sign.  By the
 * Illinois method: secants, each of which halves what the end counts for that stays; and a halving
 * where these are slow. */
double bracket_zero(BracketFn f, const void *ctx, double a, double fa, double b, double fb,
                    double small);

#endif
