/* Roots within an interval: made from known roots, multiple ones and badly conditioned ones
 * among them.  SPDX-License-Identifier: Apache-2.0 */
#include "math/roots.h"

#include "base/rng.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

/* Multiply out the product of (x - r[i]) in long double; what rounding leaves goes into e. */
static void expand(const double *r, int n, double scale, double *c, double *e)
{
    long double p[ROOTS_DEGREE_MAX + 1] = {scale}, size[ROOTS_DEGREE_MAX + 1] = {fabs(scale)};
    for (int i = 0; i < n; i++)
        for (int k = i + 1; k >= 0; k--) {
            p[k] = (k > 0 ? p[k - 1] : 0) - (k <= i ? p[k] * r[i] : 0);
            size[k] = (k > 0 ? size[k - 1] : 0) + (k <= i ? size[k] * fabs(r[i]) : 0);
        }
    for (int k = 0; k <= n; k++) {
        c[k] = (double)p[k];
        e[k] = (double)(fabsl(p[k] - c[k]) + 2 * n * 0x1p-64 * size[k]);
    }
}

/* Is every root within the bound of one that was found? */
static void assert_covered(const double *r, int n, const Root *found, int count)
{
    for (int i = 0; i < n; i++) {
        int covered = 0;
        for (int k = 0; k < count; k++)
            covered += fabs(found[k].x - r[i]) <= found[k].error;
        assert_true(covered > 0);
    }
    for (int k = 1; k < count; k++)
        assert_true(found[k].x >= found[k - 1].x);
}

/* Random roots of random sizes, some of them double or triple. */
static void test_random(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 20000; i++) {
        Rng rng = rng_at(1, 2, i);
        int n = 3 + (int)(i % 14);
        double r[16], c[17], e[17], size = ldexp(1, (int)(rng_u32(&rng) % 80) - 40);
        for (int k = 0; k < n; k++) {
            r[k] = (2 * rng_double(&rng) - 1) * size;
            if (i % 3 == 0) /* multiple ones away from the ends */
                r[k] *= 0.8;
            if (i % 3 == 0 && k > 0 && rng_u32(&rng) % 3 == 0)
                r[k] = r[k - 1];
        }
        expand(r, n, i & 8 ? -3 : 0.7, c, e);
        Root found[16];
        int count = roots_within(c, e, n, -1.1 * size, 1.1 * size, found);
        assert_true(count <= n);
        assert_covered(r, n, found, count);
        if (i % 3 != 0) {
            assert_int_equal((n - count) % 2, 0);
            count = roots_within(c, e, n, -INFINITY, INFINITY, found);
            assert_true((n - count) % 2 == 0);
            assert_covered(r, n, found, count);
        }
    }
}

/* Separate roots are all found, and sharply; those outside of the interval are not. */
static void test_separate(void **state)
{
    (void)state;
    double r[16], c[17], e[17];
    for (int n = 3; n <= 16; n++) {
        for (int k = 0; k < n; k++)
            r[k] = cos(M_PI * (n - k - 0.5) / n);
        expand(r, n, 1, c, e);
        Root found[16];
        assert_int_equal(roots_within(c, e, n, -1, 1, found), n);
        for (int k = 0; k < n; k++) {
            assert_true(fabs(found[k].x - r[k]) <= found[k].error);
            assert_true(found[k].error < 1e-9);
        }
        int half = roots_within(c, e, n, 0.1, 1, found);
        for (int k = 0; k < half; k++)
            assert_true(fabs(found[k].x - r[n - half + k]) <= found[k].error);
        assert_true(r[n - half] > 0.1 && r[n - half - 1] < 0.1);
    }
}

static int solve_down(const double *highest_first, int degree, Root *out)
{
    double c[ROOTS_DEGREE_MAX + 1];
    for (int i = 0; i <= degree; i++)
        c[i] = highest_first[degree - i];
    return roots_within(c, NULL, degree, -INFINITY, INFINITY, out);
}

/* Quartics of thin rings seen from afar. */
static void test_far(void **state)
{
    (void)state;
    Root r[4];
    const double ring[] = {1, -240, 25449, -1325880, 26471900.25};
    assert_int_equal(solve_down(ring, 4, r), 2);
    /* (x - 60)^4 + 3849 (x - 60)^2 = 344499.75 */
    double away = sqrt((sqrt(3849. * 3849 + 4 * 344499.75) - 3849) / 2);
    assert_true(fabs(r[0].x - (60 - away)) <= r[0].error && r[0].error < 1e-9);
    assert_true(fabs(r[1].x - (60 + away)) <= r[1].error && r[1].error < 1e-9);
    const double none[] = {1, -198.995, 15006.6, -508127, 6.52025e6}; /* at least 6017 */
    assert_int_equal(solve_down(none, 4, r), 0);
}

/* Wilkinson's polynomial: the roots that its coefficients in double still tell. */
static void test_wilkinson(void **state)
{
    (void)state;
    double r[20], c[21], e[21];
    for (int k = 0; k < 20; k++)
        r[k] = k + 1;
    Root found[20];
    expand(r, 12, 1, c, e);
    assert_int_equal(roots_within(c, e, 12, 0, 20, found), 12);
    assert_covered(r, 12, found, 12);
    expand(r, 20, 1, c, e);
    assert_covered(r, 20, found, roots_within(c, e, 20, 0, 25, found));
}

static void test_multiple(void **state)
{
    (void)state;
    Root r[ROOTS_DEGREE_MAX];
    double c[ROOTS_DEGREE_MAX + 1], e[ROOTS_DEGREE_MAX + 1];
    expand((double[]){0.3, 0.3, -0.7, -0.7, 0.1, 0.1}, 6, 1, c, e);
    assert_int_equal(roots_within(c, e, 6, -2, 2, r), 6);
    for (int i = 0; i < 6; i += 2)
        assert_true(r[i].x == r[i + 1].x && r[i].error < 1e-6);
    c[0] += 1e-9; /* apart, and away */
    assert_int_equal(roots_within(c, e, 6, -2, 2, r), 0);
    c[0] -= 2e-9;
    assert_int_equal(roots_within(c, e, 6, -2, 2, r), 6);
    assert_true(r[0].x < r[1].x && r[2].x < r[3].x);
    expand((double[]){0.3, 0.3, 0.3, -0.7}, 4, 1, c, e); /* a triple one */
    assert_int_equal(roots_within(c, e, 4, -2, 2, r), 2);
    assert_true(fabs(r[1].x - 0.3) <= r[1].error && r[1].error < 1e-4);
    for (int n = 3; n <= ROOTS_DEGREE_MAX; n++) { /* powers of x */
        double power[ROOTS_DEGREE_MAX + 1] = {0};
        power[n] = 1;
        int count = roots_within(power, NULL, n, -2, 3, r);
        assert_int_equal(count, n % 2 ? 1 : 2);
        assert_true(fabs(r[0].x) <= r[0].error && r[count - 1].x == r[0].x);
    }
}

/* Many roots in a wide interval whose ends are huge. */
static void test_high_degree(void **state)
{
    (void)state;
    double c[ROOTS_DEGREE_MAX + 1] = {0};
    Root r[ROOTS_DEGREE_MAX];
    c[35] = 1e-20;
    c[0] = -1;
    assert_int_equal(roots_within(c, NULL, 35, -INFINITY, INFINITY, r), 1);
    assert_true(fabs(r[0].x - pow(1e20, 1 / 35.)) <= r[0].error + 1e-15 && r[0].error < 1e-12);
    c[1] = 3;
    c[3] = -1;
    int count = roots_within(c, NULL, 35, -1e9, 1e9, r);
    assert_int_equal(count % 2, 1);
    assert_true(count >= 3);
}

/* x scaled by a power of two: the same bits, scaled. */
static void test_scale(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 500; i++) {
        Rng rng = rng_at(3, 4, i);
        int n = 3 + (int)(i % 10);
        double c[13], d[13], s = ldexp(1, (int)(i % 41) - 20), power = 1;
        for (int k = 0; k <= n; k++, power *= s) {
            c[k] = 2 * rng_double(&rng) - 1;
            d[k] = c[k] / power;
        }
        Root a[12], b[12];
        int count = roots_within(c, NULL, n, -1, 3, a);
        assert_int_equal(roots_within(d, NULL, n, -s, 3 * s, b), count);
        for (int k = 0; k < count; k++)
            assert_true(b[k].x == a[k].x * s && b[k].error == a[k].error * s);
    }
}

/* The first roots, and the sign before them. */
static void test_first(void **state)
{
    (void)state;
    const double c[] = {-36, 0, 49, 0, -14, 0, 1}; /* (x^2 - 1) (x^2 - 4) (x^2 - 9) */
    Root r[6];
    bool is_negative;
    for (int first = -4; first < 3; first++) {
        double sign = 1, lo = first + 0.5;
        for (int k = -3; k <= 3; k++)
            sign *= k != 0 ? lo - k : 1;
        assert_true(roots_first(c, NULL, 6, lo, INFINITY, 1, &is_negative, r) >= 1);
        assert_true(is_negative == (sign < 0));
        double next = first + 1 == 0 ? 1 : first + 1;
        assert_true(fabs(r[0].x - next) <= r[0].error && r[0].error < 1e-8);
    }
    assert_int_equal(roots_first(c, NULL, 6, 4, INFINITY, 1, &is_negative, r), 0);
    assert_false(is_negative);
    const double cubic[] = {0, -1, 0, 1};
    assert_int_equal(roots_first(cubic, NULL, 3, -INFINITY, -50, 3, &is_negative, r), 0);
    assert_true(is_negative);
    assert_int_equal(roots_first((double[]){2, -3, 1}, NULL, 2, 1.5, 9, 1, &is_negative, r), 1);
    assert_true(is_negative && r[0].x == 2);
}

static void test_low_degrees(void **state)
{
    (void)state;
    Root r[4];
    assert_int_equal(roots_within((double[]){-6, 3, 0, 0, 0}, NULL, 4, 0, 5, r), 1);
    assert_true(r[0].x == 2);
    assert_int_equal(roots_within((double[]){2, -3, 1}, NULL, 2, 1.5, 5, r), 1);
    assert_true(r[0].x == 2);
    assert_int_equal(roots_within((double[]){0, 0, 0}, NULL, 2, 0, 5, r), 0);
    assert_int_equal(roots_within((double[]){1, NAN, 0, 1}, NULL, 3, 0, 5, r), 0);
    assert_int_equal(roots_within((double[]){1, 1, 0, 1}, NULL, 3, 5, 0, r), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_random),   cmocka_unit_test(test_separate),
        cmocka_unit_test(test_far),      cmocka_unit_test(test_wilkinson),
        cmocka_unit_test(test_multiple), cmocka_unit_test(test_high_degree),
        cmocka_unit_test(test_scale),    cmocka_unit_test(test_low_degrees),
        cmocka_unit_test(test_first),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
