/* Roots of polynomials: made from known roots, and the bounds on their errors.
 * SPDX-License-Identifier: Apache-2.0 */
#include "math/roots.h"

#include "base/rng.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

/* Multiply out the product of (x - r[i]) in long double; the coefficients' rounding to double
 * goes into e. */
static void expand(const double *r, int n, double scale, double *c, double *e)
{
    long double p[5] = {scale};
    for (int i = 0; i < n; i++)
        for (int k = i + 1; k >= 0; k--)
            p[k] = (k > 0 ? p[k - 1] : 0) - (k <= i ? p[k] * r[i] : 0);
    for (int k = 0; k <= n; k++) {
        c[k] = (double)p[k];
        e[k] = fabs((double)(p[k] - c[k])) + 0x1p-60 * fabs(c[k]);
    }
}

static int solve(int n, const double *c, const double *e, Root *out)
{
    return n == 2   ? roots_quadratic(c, e, out)
           : n == 3 ? roots_within(c, e, 3, -INFINITY, INFINITY, out)
                    : roots_within(c, e, 4, -INFINITY, INFINITY, out);
}

static void sort(double *r, int n)
{
    for (int i = 1; i < n; i++)
        for (int k = i; k > 0 && r[k] < r[k - 1]; k--) {
            double x = r[k];
            r[k] = r[k - 1], r[k - 1] = x;
        }
}

/* Random roots of random sizes: all are found, ascending, and lie within their bounds. */
static void test_known_roots(void **state)
{
    (void)state;
    double worst = 0;
    for (uint32_t i = 0; i < 30000; i++) {
        Rng rng = rng_at(1, 2, i);
        int n = 2 + (int)(i % 3);
        double r[4], c[5], e[5], size = ldexp(1, (int)(rng_u32(&rng) % 200) - 100);
        for (int k = 0; k < n; k++)
            r[k] = (2 * rng_double(&rng) - 1) * size * (rng_u32(&rng) % 4 ? 1 : 1e-3);
        sort(r, n);
        expand(r, n, i & 8 ? -3 : 0.7, c, e);
        Root found[4];
        assert_int_equal(solve(n, c, e, found), n);
        for (int k = 0; k < n; k++) {
            double miss = fabs(found[k].x - r[k]);
            assert_true(miss <= found[k].error);
            if (k > 0)
                assert_true(found[k].x >= found[k - 1].x);
            worst = fmax(worst, found[k].error / size);
        }
    }
    assert_true(worst < 1e-3); /* the bounds say something */
}

/* Polynomials without real roots. */
static void test_none(void **state)
{
    (void)state;
    Root r[4];
    assert_int_equal(roots_quadratic((double[]){1, 0, 1}, NULL, r), 0);
    assert_int_equal(roots_within((double[]){1, 0, 0, 0, 1}, NULL, 4, -INFINITY, INFINITY, r), 0);
    assert_int_equal(roots_within((double[]){5, 0, 2, 0, 1}, NULL, 4, -INFINITY, INFINITY, r), 0);
    assert_int_equal(roots_quadratic((double[]){5, 0, 0}, NULL, r), 0);
    assert_int_equal(roots_quadratic((double[]){0, 0, 0}, NULL, r), 0);
    assert_int_equal(roots_quadratic((double[]){NAN, 1, 1}, NULL, r), 0);
    assert_int_equal(roots_within((double[]){1, INFINITY, 1, 1}, NULL, 3, -INFINITY, INFINITY, r),
                     0);
}

/* Lower degrees by zero leading coefficients; a tiny one does not disturb the others. */
static void test_degenerate(void **state)
{
    (void)state;
    Root r[4];
    assert_int_equal(roots_within((double[]){-6, 3, 0, 0, 0}, NULL, 4, -INFINITY, INFINITY, r), 1);
    assert_true(r[0].x == 2);
    assert_int_equal(roots_within((double[]){2, -3, 1, 0}, NULL, 3, -INFINITY, INFINITY, r), 2);
    assert_true(r[0].x == 1 && r[1].x == 2);
    assert_int_equal(roots_quadratic((double[]){-1, 1, 1e-300}, NULL, r), 2);
    assert_true(fabs(r[1].x - 1) <= r[1].error && r[1].error < 1e-14);
    assert_int_equal(roots_within((double[]){0, 0, 0, 1}, NULL, 3, -INFINITY, INFINITY, r), 1);
    assert_true(r[0].x == 0 || fabs(r[0].x) <= r[0].error);
}

/* Double roots are found twice; a curve just above zero has none. */
static void test_double(void **state)
{
    (void)state;
    Root r[4];
    assert_int_equal(roots_quadratic((double[]){1, -2, 1}, NULL, r), 2);
    assert_true(r[0].x == 1 && r[1].x == 1);
    assert_int_equal(roots_within((double[]){-2, 5, -4, 1}, NULL, 3, -INFINITY, INFINITY, r),
                     3); /* (x-1)^2 (x-2) */
    assert_true(fabs(r[0].x - 1) <= r[0].error && fabs(r[1].x - 1) <= r[1].error);
    assert_true(fabs(r[2].x - 2) <= r[2].error && r[2].error < 1e-12);
    assert_int_equal(roots_within((double[]){4, 0, -4, 0, 1}, NULL, 4, -INFINITY, INFINITY, r),
                     4); /* (x^2-2)^2 */
    assert_true(fabs(r[0].x + sqrt(2)) <= r[0].error && r[0].error < 1e-6);
    assert_true(fabs(r[3].x - sqrt(2)) <= r[3].error);
    assert_int_equal(
        roots_within((double[]){4 + 1e-9, 0, -4, 0, 1}, NULL, 4, -INFINITY, INFINITY, r), 0);
    assert_int_equal(
        roots_within((double[]){4 - 1e-9, 0, -4, 0, 1}, NULL, 4, -INFINITY, INFINITY, r), 4);
}

/* x scaled by a power of two: the same bits, scaled. */
static void test_scale(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 500; i++) {
        Rng rng = rng_at(3, 4, i);
        double c[5], d[5], s = ldexp(1, (int)(i % 81) - 40), power = 1;
        for (int k = 0; k < 5; k++, power *= s) {
            c[k] = 2 * rng_double(&rng) - 1;
            d[k] = c[k] / power;
        }
        Root a[4], b[4];
        int n = roots_within(c, NULL, 4, -INFINITY, INFINITY, a);
        assert_int_equal(roots_within(d, NULL, 4, -INFINITY, INFINITY, b), n);
        for (int k = 0; k < n; k++)
            assert_true(b[k].x == a[k].x * s);
    }
}

/* The fast cubic: good to a billionth of the largest root. */
static void test_rough(void **state)
{
    (void)state;
    double x[3];
    for (uint32_t i = 0; i < 20000; i++) {
        Rng rng = rng_at(5, 6, i);
        double r[3], c[5], e[5], size = ldexp(1, 6 * (int)(i % 100) - 300);
        for (int k = 0; k < 3; k++)
            r[k] = (2 * rng_double(&rng) - 1) * size;
        sort(r, 3);
        if (r[1] - r[0] < 1e-3 * size || r[2] - r[1] < 1e-3 * size)
            continue;
        expand(r, 3, i & 1 ? -2 : 1, c, e);
        assert_int_equal(roots_cubic_rough(c, x), 3);
        for (int k = 0; k < 3; k++)
            assert_true(fabs(x[k] - r[k]) < 1e-7 * size);
        /* One real root: (x - r)(x^2 + s^2). */
        double s = size * rng_double(&rng);
        const double d[4] = {-r[0] * s * s, s * s, -r[0], 1};
        assert_int_equal(roots_cubic_rough(d, x), 1);
        assert_true(fabs(x[0] - r[0]) < 1e-7 * size);
    }
    assert_int_equal(roots_cubic_rough((double[]){0, 0, 0, 1}, x), 1);
    assert_true(x[0] == 0);
    assert_int_equal(roots_cubic_rough((double[]){-8, 0, 0, 1}, x), 1);
    assert_true(fabs(x[0] - 2) < 1e-9);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_known_roots), cmocka_unit_test(test_none),
        cmocka_unit_test(test_degenerate),  cmocka_unit_test(test_double),
        cmocka_unit_test(test_scale),       cmocka_unit_test(test_rough),
    };
    return cmocka_run_group_tests_name("roots", tests, NULL, NULL);
}
