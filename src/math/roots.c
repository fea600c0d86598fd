/* Real roots of polynomials by bracketing.
 *
 * Between two neighbouring roots of its derivative a polynomial is monotone, so a change of
 * sign there brackets exactly one root, which Newton steps kept inside the bracket then find.
 * The derivative's roots are found the same way, down to degree two.  The error of a root is
 * what the polynomial's own rounding allows: how far from the root its value stands out of
 * that rounding for sure.  SPDX-License-Identifier: Apache-2.0 */
#include "math/roots.h"

#include "math/eps.h"
#include "math/v3.h"

#include <stdbool.h>
#include <float.h>

enum { DEGREE_MAX = 4 };

typedef struct Poly {
    int degree;
    bool is_plain; /* no error bounds wanted: a derivative */
    double c[DEGREE_MAX + 1], e[DEGREE_MAX + 1];
} Poly;

typedef struct Value {
    double f, slope, error; /* error: bound on the error of f */
} Value;

static Value poly_at(const Poly *p, double x)
{
    double f = p->c[p->degree], slope = 0, size = fabs(f), doubt = p->e[p->degree];
    double a = fabs(x);
    for (int i = p->degree - 1; i >= 0; i--) {
        slope = slope * x + f;
        f = f * x + p->c[i];
        size = size * a + fabs(p->c[i]);
        doubt = doubt * a + p->e[i];
    }
    return (Value){f, slope, doubt + 2 * (p->degree + 1) * EPS_DOUBLE * size};
}

static Poly derivative(const Poly *p)
{
    Poly d = {.degree = p->degree - 1, .is_plain = true, .c = {0}, .e = {0}};
    for (int i = 1; i <= DEGREE_MAX; i++) {
        d.c[i - 1] = i * p->c[i];
        d.e[i - 1] = i * p->e[i];
    }
    return d;
}

/* Twice Fujiwara's max |c_i/c_n|^(1/(n-i)). */
double roots_bound(const double *c, int degree)
{
    int lead, most = -2000;
    frexp(c[degree], &lead);
    for (int i = 0; i < degree; i++) {
        if (c[i] == 0)
            continue;
        int e, n = degree - i;
        frexp(c[i], &e);
        e += 1 - lead;
        int ceiling = e > 0 ? (e + n - 1) / n : -(-e / n);
        most = ceiling > most ? ceiling : most;
    }
    return ldexp(1, most + 1 > 1000 ? 1000 : most + 1);
}

/* Find the root in [lo, hi], where the polynomial changes sign: Newton steps, halving when they
 * leave the bracket or do not shrink it fast. */
static double find_in(const Poly *p, double lo, double hi, bool is_rising)
{
    double x = 0.5 * (lo + hi);
    for (int i = 0; i < 200; i++) {
        Value v = poly_at(p, x);
        if (v.f == 0)
            return x;
        if ((v.f > 0) == is_rising)
            hi = x;
        else
            lo = x;
        double next = x - v.f / v.slope;
        if (!(next > lo && next < hi) || (i & 7) == 7)
            next = 0.5 * (lo + hi);
        if (!(next > lo && next < hi) || next == x)
            return x;
        if (fabs(next - x) <= EPS_DOUBLE * fabs(x))
            return next;
        x = next;
    }
    return x;
}

/* Bound the error of a root: step away until the sign is certain on both sides. */
static double error_of(const Poly *p, double x, double lo, double hi)
{
    Value v = poly_at(p, x);
    double step = 2 * EPS_DOUBLE * fabs(x) + DBL_MIN;
    double guess = 2 * (fabs(v.f) + v.error) / fabs(v.slope);
    if (guess > step && guess < hi - lo)
        step = guess;
    for (int i = 0; i < 64; i++, step *= 2) {
        Value below = poly_at(p, x - step), above = poly_at(p, x + step);
        bool is_sure = fabs(below.f) > below.error && fabs(above.f) > above.error;
        if (is_sure && (below.f > 0) != (above.f > 0))
            break;
        if (step > hi - lo)
            break;
    }
    return step + EPS_DOUBLE * fabs(x);
}

static int solve(const Poly *p, Root *out);

/* Add the double root at the turning point x if the curve touches zero there, to its rounding. */
static int touch(const Poly *p, double x, Root *out)
{
    Value v = poly_at(p, x);
    if (!(fabs(v.f) <= v.error))
        return 0;
    Poly d = derivative(p);
    double bend = fabs(poly_at(&d, x).slope);
    double error = sqrt(4 * v.error / bend) + 2 * EPS_DOUBLE * fabs(x);
    out[0] = out[1] = (Root){x, isfinite(error) ? error : fabs(x)};
    return 2;
}

/* Roots of a polynomial of degree > 2 with a leading coefficient. */
static int solve_by_brackets(const Poly *p, Root *out)
{
    Poly d = derivative(p);
    if (roots_bound(p->c, p->degree) == 0) { /* a power of x */
        out[0] = out[1] = (Root){0, 0};
        return p->degree % 2 ? 1 : 2;
    }
    Root turns[DEGREE_MAX];
    int turn_count = solve(&d, turns), count = 0;
    double bound = roots_bound(p->c, p->degree), at[DEGREE_MAX + 2];
    int last = 0;
    at[0] = -bound;
    for (int i = 0; i < turn_count; i++)
        if (turns[i].x > at[last] && turns[i].x < bound)
            at[++last] = turns[i].x;
    at[++last] = bound;
    bool is_above = poly_at(p, at[0]).f > 0;
    for (int i = 1; i <= last && count < p->degree; i++) {
        double f = poly_at(p, at[i]).f;
        bool next = f > 0 || (f == 0 && is_above);
        if (next != is_above) {
            double x = find_in(p, at[i - 1], at[i], next);
            out[count++] = (Root){x, p->is_plain ? 0 : error_of(p, x, at[0], at[last])};
        } else if (i < last && count + 2 <= p->degree) {
            /* No sign change up to this turning point; is there none after it either? */
            double after = poly_at(p, at[i + 1]).f;
            if ((after > 0) == is_above)
                count += touch(p, at[i], out + count);
        }
        is_above = next;
    }
    return count;
}

static int solve_quadratic(const Poly *p, Root *out)
{
    double a = p->c[2], b = 0.5 * p->c[1], c = p->c[0];
    double product = b * b, other = a * c;
    double disc = product - other;
    /* Where the two cancel, the rounding of the products counts. */
    disc += fma(b, b, -product) - fma(a, c, -other);
    double doubt = fabs(b) * p->e[1] + fabs(a) * p->e[0] + fabs(c) * p->e[2] +
                   4 * EPS_DOUBLE * (fabs(disc) + EPS_DOUBLE * (product + fabs(other)));
    if (disc < -doubt)
        return 0;
    double root = disc > 0 ? sqrt(disc) : 0;
    double q = -(b + copysign(root, b));
    double x0 = q / a, x1 = q != 0 ? c / q : x0;
    double d_root = root > 0 ? num_min(doubt / root, sqrt(doubt)) : sqrt(doubt);
    double own = (d_root + 0.5 * p->e[1]) / fabs(a);
    double e0 = own + fabs(x0) * (p->e[2] / fabs(a) + 8 * EPS_DOUBLE);
    double e1 = q != 0 ? (p->e[0] + fabs(x1) * (d_root + 0.5 * p->e[1])) / fabs(q) +
                             8 * EPS_DOUBLE * fabs(x1)
                       : e0;
    bool is_first = x0 <= x1;
    out[0] = is_first ? (Root){x0, e0} : (Root){x1, e1};
    out[1] = is_first ? (Root){x1, e1} : (Root){x0, e0};
    return 2;
}

static int solve(const Poly *given, Root *out)
{
    Poly p = *given;
    while (p.degree > 0 && p.c[p.degree] == 0)
        p.degree--;
    if (p.degree == 0)
        return 0;
    if (p.degree == 1) {
        double x = -p.c[0] / p.c[1];
        out[0] = (Root){x, (p.e[0] + fabs(x) * p.e[1]) / fabs(p.c[1]) + EPS_DOUBLE * fabs(x)};
        return 1;
    }
    return p.degree == 2 ? solve_quadratic(&p, out) : solve_by_brackets(&p, out);
}

static int solve_degree(int degree, const double *c, const double *c_error, Root *out)
{
    Poly p = {.degree = degree, .is_plain = false, .c = {0}, .e = {0}};
    for (int i = 0; i <= degree; i++) {
        p.c[i] = c[i];
        p.e[i] = c_error ? c_error[i] : 0;
        if (!isfinite(c[i]))
            return 0;
    }
    return solve(&p, out);
}

int roots_quadratic(const double c[3], const double *c_error, Root out[2])
{
    return solve_degree(2, c, c_error, out);
}

int roots_cubic(const double c[4], const double *c_error, Root out[3])
{
    return solve_degree(3, c, c_error, out);
}

int roots_quartic(const double c[5], const double *c_error, Root out[4])
{
    return solve_degree(4, c, c_error, out);
}

/* The largest root of u^3 - 3 u = 2 k for k in [0, 1], which is 2 cos(acos(k) / 3): a parabola is
 * within 1e-4 of it, and a step of Newton's squares that. */
static double largest_of_three(double k)
{
    double u = 1.7321 + k * (0.3333 - 0.0654 * k);
    for (int i = 0; i < 2; i++)
        u -= (u * (u * u - 3) - 2 * k) / (3 * (u * u - 1));
    return u;
}

/* The roots of y^3 + p y + q. */
static int solve_depressed(double p, double q, double out[3])
{
    double third = p / 3, half = 0.5 * fabs(q), disc = half * half + third * third * third;
    if (!(disc < 0)) { /* Cardano's formula, without its difference */
        double cube = half + sqrt(disc), a = cbrt(cube), b = third / a;
        out[0] = a > 0 ? -q / (a * a + third + b * b) : 0;
        return 1;
    }
    double s = sqrt(-third), side = q > 0 ? -1 : 1, k = num_min(1, half / (s * s * s));
    /* Of the others, one is the larger root of what remains; the product of all gives the last. */
    double u = num_min(2, largest_of_three(k)), far = -0.5 * (u + sqrt(3 * (4 - u * u)));
    double largest = side * s * u, other = side * s * far, middle = side * s * (2 * k / (u * far));
    out[0] = side > 0 ? other : largest;
    out[1] = middle;
    out[2] = side > 0 ? largest : other;
    return 3;
}

/* Return e so that |p| 4^-e and |q| 8^-e are about 1 at most, and the larger of them is. */
static int size_of(double p, double q)
{
    int of_p, of_q, least = -100000;
    frexp(p, &of_p);
    frexp(q, &of_q);
    int half = p != 0 ? (of_p - (of_p < 0 ? 1 : 0)) / 2 : least;
    int third = q != 0 ? (of_q - (of_q < 0 ? 2 : 0)) / 3 : least;
    return half > third ? half : third;
}

int roots_cubic_rough(const double c[4], double out[3])
{
    double a = c[2] / c[3], b = c[1] / c[3], third = a / 3;
    double p = b - a * third, q = third * (2 * third * third - b) + c[0] / c[3];
    /* Scaled, so that nothing overflows, and what a power of two is has no part in the digits. */
    int e = p != 0 || q != 0 ? size_of(p, q) : 0;
    int count = solve_depressed(ldexp(p, -2 * e), ldexp(q, -3 * e), out);
    for (int i = 0; i < count; i++)
        out[i] = ldexp(out[i], e) - third;
    return count;
}
