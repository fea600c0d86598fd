/* Closed forms: quadratics with bounds on the errors of their roots, cubics roughly, and how far
 * out the roots of any polynomial can be.  SPDX-License-Identifier: Apache-2.0 */
#include "math/roots.h"

#include "math/eps.h"
#include "math/v3.h"

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

static int solve_linear(const double c[2], const double e[2], Root *out)
{
    if (c[1] == 0)
        return 0;
    double x = -c[0] / c[1];
    out[0] = (Root){x, (e[0] + fabs(x) * e[1]) / fabs(c[1]) + EPS_DOUBLE * fabs(x)};
    return 1;
}

int roots_quadratic(const double c[3], const double *c_error, Root out[2])
{
    const double exact[3] = {0, 0, 0}, *e = c_error ? c_error : exact;
    if (!isfinite(c[0]) || !isfinite(c[1]) || !isfinite(c[2]))
        return 0;
    if (c[2] == 0)
        return solve_linear(c, e, out);
    double a = c[2], b = 0.5 * c[1];
    double product = b * b, other = a * c[0];
    double disc = product - other;
    /* Where the two cancel, the rounding of the products counts. */
    disc += fma(b, b, -product) - fma(a, c[0], -other);
    double doubt = fabs(b) * e[1] + fabs(a) * e[0] + fabs(c[0]) * e[2] +
                   4 * EPS_DOUBLE * (fabs(disc) + EPS_DOUBLE * (product + fabs(other)));
    if (disc < -doubt)
        return 0;
    double root = disc > 0 ? sqrt(disc) : 0;
    double q = -(b + copysign(root, b));
    double x0 = q / a, x1 = q != 0 ? c[0] / q : x0;
    double d_root = root > 0 ? num_min(doubt / root, sqrt(doubt)) : sqrt(doubt);
    double own = (d_root + 0.5 * e[1]) / fabs(a);
    double e0 = own + fabs(x0) * (e[2] / fabs(a) + 8 * EPS_DOUBLE);
    double e1 =
        q != 0 ? (e[0] + fabs(x1) * (d_root + 0.5 * e[1])) / fabs(q) + 8 * EPS_DOUBLE * fabs(x1)
               : e0;
    bool is_first = x0 <= x1;
    out[0] = is_first ? (Root){x0, e0} : (Root){x1, e1};
    out[1] = is_first ? (Root){x1, e1} : (Root){x0, e0};
    return 2;
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
