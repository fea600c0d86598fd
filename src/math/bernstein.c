/* Roots of polynomials in Bernstein form.
 *
 * The coefficients change sign at least as often as the polynomial: never means no root, once
 * means one, which Newton steps kept inside its bracket find.  Else the interval is halved; both
 * halves get the same value at the middle, so no root is lost or found twice there.
 * SPDX-License-Identifier: Apache-2.0 */
#include "math/bernstein.h"

#include "math/eps.h"

#include <float.h>
#include <math.h>

/* Halvings until a double root is given up: its halves then differ by rounding alone. */
enum { DEPTH_MAX = (DBL_MANT_DIG + 11) / 2 };

typedef struct RootList {
    double *out;
    int count, degree;
} RootList;

static int sign_changes(const double *b, int degree)
{
    int changes = 0;
    for (int i = 0; i < degree; i++)
        changes += (b[i] < 0) != (b[i + 1] < 0);
    return changes;
}

/* de Casteljau's scheme, for a degree that the compiler knows. */
#define ALWAYS_INLINE static inline __attribute__((always_inline))

ALWAYS_INLINE double at_of_degree(const double *b, int degree, double x, double *slope)
{
    double p[BERNSTEIN_DEGREE_MAX + 1], y = 1 - x;
    for (int i = 0; i <= degree; i++)
        p[i] = b[i];
    for (int k = degree; k > 1; k--)
        for (int i = 0; i < k; i++)
            p[i] = y * p[i] + x * p[i + 1];
    *slope = degree * (p[1] - p[0]);
    return y * p[0] + x * p[1];
}

double bernstein_at(const double *b, int degree, double x, double *slope)
{
    switch (degree) {
    case 1:
        return at_of_degree(b, 1, x, slope);
    case 2:
        return at_of_degree(b, 2, x, slope);
    case 3:
        return at_of_degree(b, 3, x, slope);
    case 4:
        return at_of_degree(b, 4, x, slope);
    case 5:
        return at_of_degree(b, 5, x, slope);
    default:
        return at_of_degree(b, 6, x, slope);
    }
}

double bernstein_value(const double *b, int degree, double x)
{
    double y = 1 - x;
    if (degree == 1)
        return y * b[0] + x * b[1];
    if (degree == 2)
        return y * (y * b[0] + 2 * x * b[1]) + x * x * b[2];
    return y * y * (y * b[0] + 3 * x * b[1]) + x * x * (3 * y * b[2] + x * b[3]);
}

ALWAYS_INLINE void split_of_degree(const double *b, int degree, double x, double *lo, double *hi)
{
    double y = 1 - x;
    for (int i = 0; i <= degree; i++)
        hi[i] = b[i];
    lo[0] = hi[0];
    for (int k = degree; k > 0; k--) {
        for (int i = 0; i < k; i++)
            hi[i] = y * hi[i] + x * hi[i + 1];
        lo[degree - k + 1] = hi[0];
    }
}

/* Split at x: the coefficients of both sides. */
static void split(const double *b, int degree, double x, double *lo, double *hi)
{
    switch (degree) {
    case 3:
        split_of_degree(b, 3, x, lo, hi);
        break;
    case 4:
        split_of_degree(b, 4, x, lo, hi);
        break;
    case 6:
        split_of_degree(b, 6, x, lo, hi);
        break;
    default:
        split_of_degree(b, degree, x, lo, hi);
    }
}

ALWAYS_INLINE void center_of_degree(const double *b, int degree, BernsteinCenter *out)
{
    double lo[BERNSTEIN_DEGREE_MAX + 1], hi[BERNSTEIN_DEGREE_MAX + 1] = {0}, factor = 1;
    split_of_degree(b, degree, 0.5, lo, hi);
    /* The k-th difference of the upper half's coefficients, times the binomial, times 2^k. */
    out->degree = degree;
    out->c[0] = hi[0];
    for (int k = 1; k <= degree; k++) {
        for (int i = 0; i <= degree - k; i++)
            hi[i] = hi[i + 1] - hi[i];
        factor = factor * (2 * (degree - k + 1)) / k;
        out->c[k] = factor * hi[0];
    }
}

void bernstein_center(const double *b, int degree, BernsteinCenter *out)
{
    switch (degree) {
    case 3:
        center_of_degree(b, 3, out);
        break;
    case 4:
        center_of_degree(b, 4, out);
        break;
    case 6:
        center_of_degree(b, 6, out);
        break;
    default:
        center_of_degree(b, degree, out);
    }
}

void bernstein_part(const double *b, int degree, double from, double to, double *out)
{
    double rest[BERNSTEIN_DEGREE_MAX + 1] = {0}, unused[BERNSTEIN_DEGREE_MAX + 1];
    if (from == 0) {
        split(b, degree, to, out, unused);
        return;
    }
    if (to == 1) {
        split(b, degree, from, unused, out);
        return;
    }
    split(b, degree, from, unused, rest);
    double share = from < 1 ? (to - from) / (1 - from) : 0;
    split(rest, degree, share, out, unused);
}

void bernstein_add_product(const double *a, const double *b, int degree, double factor, double *out)
{
    if (degree == 1) {
        out[0] += factor * (a[0] * b[0]);
        out[1] += factor * (0.5 * (a[0] * b[1] + a[1] * b[0]));
        out[2] += factor * (a[1] * b[1]);
    } else if (degree == 2) {
        out[0] += factor * (a[0] * b[0]);
        out[1] += factor * (0.5 * (a[0] * b[1] + a[1] * b[0]));
        out[2] += factor * ((a[0] * b[2] + a[2] * b[0] + 4 * (a[1] * b[1])) / 6);
        out[3] += factor * (0.5 * (a[1] * b[2] + a[2] * b[1]));
        out[4] += factor * (a[2] * b[2]);
    } else {
        const double unit = 1, fifth = unit / 5, fifths = 3 * unit / 5; /* with all digits */
        const double outer = unit / 20, inner = 9 * unit / 20;
        out[0] += factor * (a[0] * b[0]);
        out[1] += factor * (0.5 * (a[0] * b[1] + a[1] * b[0]));
        out[2] += factor * (fifth * (a[0] * b[2] + a[2] * b[0]) + fifths * (a[1] * b[1]));
        out[3] +=
            factor * (outer * (a[0] * b[3] + a[3] * b[0]) + inner * (a[1] * b[2] + a[2] * b[1]));
        out[4] += factor * (fifth * (a[1] * b[3] + a[3] * b[1]) + fifths * (a[2] * b[2]));
        out[5] += factor * (0.5 * (a[2] * b[3] + a[3] * b[2]));
        out[6] += factor * (a[3] * b[3]);
    }
}

int bernstein_quadratic(const double b[3], double discriminant, double out[2])
{
    /* With z = x / (1 - x): b0 + 2 b1 z + b2 z^2 = 0 for z > 0. */
    bool is_low = b[0] < 0;
    double q = -(b[1] + copysign(sqrt(discriminant > 0 ? discriminant : 0), b[1]));
    double first = b[0] != q ? b[0] / (b[0] + q) : 0.5, last = q != -b[2] ? q / (q + b[2]) : 0.5;
    if (is_low != (b[2] < 0)) {
        /* One has z > 0: z = b0 / q or q / b2. */
        bool is_first = is_low ? q < 0 : q > 0;
        double x = is_first ? first : last;
        out[0] = x >= 0 && x <= 1 ? x : x > 1 ? 1 : 0;
        return 1;
    }
    if (is_low == (b[1] < 0) || !(discriminant > 0))
        return 0;
    out[0] = fmin(first, last);
    out[1] = fmax(first, last);
    return 2;
}

/* Guess the root between lo and hi: where the parabola at the middle of [0, 1] has it. */
static inline double guess(const BernsteinCenter *p, double lo, double hi)
{
    double a = p->c[2], b = 0.5 * p->c[1], c = p->c[0], room = b * b - a * c;
    double q = -(b + copysign(sqrt(room > 0 ? room : 0), b));
    double first = 0.5 + c / q, last = 0.5 + q / a;
    return first > lo && first < hi ? first : last > lo && last < hi ? last : 0.5 * (lo + hi);
}

/* Find the one root, by the signs of the ends: Newton steps, halving where they leave the bracket
 * or do not shrink it fast. */
ALWAYS_INLINE double find_of_degree(const double *b, int degree)
{
    bool is_rising = b[0] < 0;
    BernsteinCenter center;
    center_of_degree(b, degree, &center);
    center.degree = degree;
    bool is_late = (center.c[0] < 0) == is_rising;
    double lo = is_late ? 0.5 : 0, hi = is_late ? 1 : 0.5, x = guess(&center, lo, hi);
    for (int i = 0; i < 100; i++) {
        double slope, value = bernstein_center_at(&center, x, &slope);
        if ((value < 0) == is_rising)
            lo = x;
        else
            hi = x;
        double step = value / slope, next = x - step;
        if (!(next >= lo && next <= hi) || (i & 7) == 7) {
            next = 0.5 * (lo + hi);
            step = next - x;
        }
        x = next;
        if (step * step <= 2 * EPS_DOUBLE)
            break;
    }
    /* The last step, with all digits. */
    double slope, value = bernstein_at(b, degree, x, &slope), next = x - value / slope;
    return next >= 0 && next <= 1 ? next : next < 0 ? 0 : next > 1 ? 1 : x;
}

static double find_only(const double *b, int degree)
{
    switch (degree) {
    case 1:
        return b[0] / (b[0] - b[1]);
    case 3:
        return find_of_degree(b, 3);
    case 4:
        return find_of_degree(b, 4);
    case 6:
        return find_of_degree(b, 6);
    default:
        return find_of_degree(b, degree);
    }
}

static void isolate(const double *b, double lo, double hi, int depth, RootList *list)
{
    int degree = list->degree, changes = sign_changes(b, degree);
    if (changes == 0)
        return;
    bool is_odd = (b[0] < 0) != (b[degree] < 0);
    if (changes == 1 || depth == DEPTH_MAX) {
        if (is_odd && list->count < degree)
            list->out[list->count++] = lo + (hi - lo) * find_only(b, degree);
        return;
    }
    double left[BERNSTEIN_DEGREE_MAX + 1], right[BERNSTEIN_DEGREE_MAX + 1];
    split(b, degree, 0.5, left, right);
    double middle = 0.5 * (lo + hi);
    isolate(left, lo, middle, depth + 1, list);
    isolate(right, middle, hi, depth + 1, list);
}

int bernstein_roots(const double *b, int degree, double *out)
{
    if (degree == 2)
        return bernstein_quadratic(b, b[1] * b[1] - b[0] * b[2], out);
    if (degree == 0)
        return 0;
    RootList list = {out, 0, degree};
    isolate(b, 0, 1, 0, &list);
    return list.count;
}

void bernstein_range(const double *b, int degree, double *lo, double *hi)
{
    double slope[BERNSTEIN_DEGREE_MAX], turns[BERNSTEIN_DEGREE_MAX], ignored;
    for (int i = 0; i < degree; i++)
        slope[i] = b[i + 1] - b[i];
    int count = degree > 1 ? bernstein_roots(slope, degree - 1, turns) : 0;
    *lo = fmin(*lo, fmin(b[0], b[degree]));
    *hi = fmax(*hi, fmax(b[0], b[degree]));
    for (int i = 0; i < count; i++) {
        double value = bernstein_at(b, degree, turns[i], &ignored);
        *lo = fmin(*lo, value);
        *hi = fmax(*hi, value);
    }
}
