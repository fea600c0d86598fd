/* Finding a change of sign.  SPDX-License-Identifier: Apache-2.0 */
#include "math/bracket.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

typedef struct Curve {
    double root, power, scale;
    int looks;
} Curve;

/* |x - root|^power with the sign of x - root. */
static double height(const void *ctx, double x)
{
    Curve *c = (Curve *)(uintptr_t)ctx;
    c->looks++;
    return c->scale * copysign(pow(fabs(x - c->root), c->power), x - c->root);
}

/* Straight, flat, steep and falling curves; whichever way the sign changes. */
static void finds_the_change(void **state)
{
    (void)state;
    static const double powers[] = {1, 3, 1. / 3, 0.1, 7};
    for (size_t i = 0; i < sizeof powers / sizeof *powers; i++)
        for (int k = 0; k < 20; k++) {
            Curve c = {.root = 0.05 * k + 0.013, .power = powers[i], .scale = k % 2 ? 1 : -1e6};
            double x = bracket_zero(height, &c, 0, height(&c, 0), 1, height(&c, 1), 0);
            assert_true(fabs(x - c.root) <= 4e-16);
        }
}

/* What is straight is found at once, what is small enough is not improved. */
static void does_not_look_too_often(void **state)
{
    (void)state;
    Curve straight = {.root = 0.3, .power = 1, .scale = 1}, bent = {.power = 3, .scale = 1};
    bracket_zero(height, &straight, 0, -0.3, 1, 0.7, 1e-15);
    assert_true(straight.looks <= 2);
    double x = bracket_zero(height, &bent, -1, -1, 2, 8, 1e-3);
    assert_true(fabs(x) <= 0.1 && bent.looks <= 12);
}

/* A jump is where it is, to the last bit. */
static double jump(const void *ctx, double x)
{
    (void)ctx;
    return x < 0.7 ? -1 : 1e-9;
}

static void finds_a_jump(void **state)
{
    (void)state;
    assert_true(fabs(bracket_zero(jump, NULL, 0, -1, 1, 1e-9, 0) - 0.7) <= 2e-16);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finds_the_change),
        cmocka_unit_test(does_not_look_too_often),
        cmocka_unit_test(finds_a_jump),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
