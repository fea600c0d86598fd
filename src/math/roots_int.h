/* What the files of the roots share: a polynomial whose numbers go with bounds on their errors.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_MATH_ROOTS_INT_H
#define PMS_MATH_ROOTS_INT_H

#include "math/eps.h"
#include "math/roots.h"

enum { TERMS_MAX = ROOTS_DEGREE_MAX + 1 };

/* A value, and a bound on its error. */
typedef double Pair __attribute__((vector_size(2 * sizeof(double))));
#define PAIR(value, error) ((Pair){(value), (error)})

typedef struct Solver {
    int degree, count, cuts, most;
    bool is_negative;  /* at the lower end */
    Pair c[TERMS_MAX]; /* lowest first; error: that of the coefficient and of its use in a sum */
    double widening;   /* bounds for pieces are as much wider than those for places */
    double spare;      /* what more a piece allows for, in parts of a coefficient */
    double third;      /* bound on a sixth of the third derivative */
    double scale;      /* x of the caller for 1 here */
    double lo, hi;     /* the interval */
    Root *out;
} Solver;

typedef struct Value {
    double f, slope, bend, error; /* error: bound on that of f */
} Value;

static inline Value value_at(const Solver *s, double x)
{
    Pair f = s->c[s->degree], way = PAIR(x, fabs(x));
    double slope = 0;
    for (int i = s->degree - 1; i >= 0; i--) {
        slope = slope * x + f[0];
        f = f * way + s->c[i];
    }
    return (Value){.f = f[0], .slope = slope, .error = f[1]};
}

/* The same with half of the second derivative. */
static inline Value bend_at(const Solver *s, double x)
{
    Pair f = s->c[s->degree], way = PAIR(x, fabs(x));
    double slope = 0, bend = 0;
    for (int i = s->degree - 1; i >= 0; i--) {
        bend = bend * x + slope;
        slope = slope * x + f[0];
        f = f * way + s->c[i];
    }
    return (Value){f[0], slope, bend, f[1]};
}

/* Return the sign of a value, or 0 where it is not certain. */
static inline int sign_of(double value, double error)
{
    return value > error ? 1 : value < -error ? -1 : 0;
}

/* Add a root; its error is within [-1, 1], too. */
void solver_add(Solver *s, double x, double error);

/* Find the only root of [a, b] from a guess, and add it.
 *
 * sign_b  of the polynomial at b, +1 or -1. */
void solver_find(Solver *s, double a, double b, int sign_b, double x);

/* Find the roots of a cubic or quartic whose signs at its turning points are certain; false when
 * they are not, or the turning points are out of reach: nothing is done then. */
bool solver_monotone(Solver *s);

#endif
