/* Noise: values against what POV-Ray gives, derivatives against differences, bounds against values.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/rng.h"
#include "math/noise.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

enum { POINTS = 20000, BOXES = 20000 };

/* Measured with POV-Ray 3.7: the point, noise of three generators, vector noise, and its
 * turbulence. */
static const double measured[][12] = {
#include "noise_points.def"
};

static Arena *arena;
static const Noise *noise;

static int set_up(void **state)
{
    (void)state;
    arena = arena_new();
    noise = arena ? noise_new(arena) : NULL;
    return !noise;
}

static int tear_down(void **state)
{
    (void)state;
    arena_free(arena);
    return 0;
}

static void assert_near(double a, double b)
{
    assert_true(fabs(a - b) < 2e-12);
}

static void values_are_the_languages(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof measured / sizeof *measured; i++) {
        const double *m = measured[i];
        V3 p = v3(m[0], m[1], m[2]), vector = noise_vector(noise, p);
        V3 turbulence = noise_turbulence_vector(noise, p, &TURBULENCE_DEFAULT);
        for (int generator = 1; generator <= NOISE_GENERATORS; generator++)
            assert_near(noise_value(noise, generator, p), m[2 + generator]);
        for (int k = 0; k < 3; k++) {
            assert_near(v3_at(vector, k), m[6 + k]);
            assert_near(v3_at(turbulence, k), m[9 + k]);
        }
    }
}

/* Of the first octave of generators 2 and 3 what is beyond 0 to 1 is cut off, of others not. */
static void turbulence_adds_octaves(void **state)
{
    (void)state;
    V3 p = v3(0.3, 0.4, 0.5);
    double once = noise_value(noise, 2, p), twice = noise_value(noise, 2, v3_scale(p, 2));
    assert_near(once, 0.475871266933387);
    assert_near(noise_turbulence(noise, 2, p, &(Turbulence){1, 2, 0.5}), 2 * once - 0.5);
    assert_near(noise_turbulence(noise, 2, p, &(Turbulence){2, 2, 0.25}),
                2 * once - 0.5 + 0.25 * (2 * twice - 0.5));
    assert_near(noise_turbulence(noise, 1, p, &(Turbulence){1, 2, 0.5}), noise_value(noise, 1, p));
}

static double spread(Rng *rng)
{
    return 40 * rng_double(rng) - 20;
}

static void derivatives_are_differences(void **state)
{
    (void)state;
    Rng rng = rng_at(31, 0, 0);
    for (int i = 0; i < POINTS; i++) {
        double at[3] = {spread(&rng), spread(&rng), spread(&rng)};
        int generator = 1 + i % 3;
        V3 g;
        double value = noise_gradient(noise, generator, v3(at[0], at[1], at[2]), &g);
        assert_near(value, noise_value(noise, generator, v3(at[0], at[1], at[2])));
        if (value < 1e-3 || value > 1 - 1e-3)
            continue;
        for (int k = 0; k < 3; k++) {
            double h = 1e-5 * (generator == 3 ? 10 : 1), keep = at[k];
            at[k] = keep + h;
            double above = noise_value(noise, generator, v3(at[0], at[1], at[2]));
            at[k] = keep - h;
            double below = noise_value(noise, generator, v3(at[0], at[1], at[2]));
            at[k] = keep;
            assert_true(fabs((above - below) / (2 * h) - v3_at(g, k)) < 2e-4);
        }
    }
}

/* Bounds hold in boxes of all sizes, and are narrow in small ones. */
static void bounds_hold(void **state)
{
    (void)state;
    Rng rng = rng_at(32, 0, 0);
    double widest = 0;
    for (int i = 0; i < BOXES; i++) {
        double size = exp2(-(i % 20));
        int generator = 1 + i / 20 % 3;
        Range box[3], slopes[3];
        for (int k = 0; k < 3; k++) {
            box[k].lo = i % 7 ? spread(&rng) : floor(spread(&rng));
            box[k].hi = box[k].lo + 3 * size * rng_double(&rng);
            if (i % 11 == k) /* next to a whole number */
                box[k] = (Range){-3 - 5e-11 * rng_double(&rng), -3 + (i % 2 ? 1e-11 : -1e-12)};
            if (box[k].lo > box[k].hi)
                box[k].lo = box[k].hi - 4e-11;
        }
        Range value = noise_range(noise, generator, box, slopes);
        for (int j = 0; j < 20; j++) {
            double p[3];
            for (int k = 0; k < 3; k++)
                p[k] =
                    box[k].lo + (box[k].hi - box[k].lo) * (j < 8 ? j >> k & 1 : rng_double(&rng));
            V3 g;
            double here = noise_gradient(noise, generator, v3(p[0], p[1], p[2]), &g);
            assert_true(here >= value.lo && here <= value.hi);
            for (int k = 0; k < 3; k++)
                assert_true(v3_at(g, k) >= slopes[k].lo && v3_at(g, k) <= slopes[k].hi);
        }
        if (i % 20 >= 8)
            widest = fmax(widest, (value.hi - value.lo) / size);
    }
    assert_true(widest < 60);
}

static void cells_have_random_numbers(void **state)
{
    (void)state;
    double sum = 0;
    for (int i = 0; i < 4096; i++)
        sum += noise_hash(noise, i % 16 - 8, i / 16 % 16 - 8, i / 256 - 8);
    assert_true(fabs(sum / 4096 - 2047.5) < 4 * 4096 / sqrt(12 * 4096.0));
    assert_int_equal(noise_hash(noise, -1, 5, 7), noise_hash(noise, 4095, 5 - 4096, 7));
}

/* Far away, and at what is no place. */
static void anywhere_is_safe(void **state)
{
    (void)state;
    static const double far[] = {1e9, -1e9, 1e17, -1e300, INFINITY, NAN};
    for (int i = 0; i < 6; i++) {
        for (int generator = 1; generator <= 3; generator++) {
            V3 g;
            double value = noise_gradient(noise, generator, v3(0, far[i], 0.5), &g);
            assert_true(isfinite(far[i]) ? value >= 0 && value <= 1 : isnan(value));
            Range box[3] = {{0, 0}, {far[i], far[i]}, {0.5, 0.5}};
            Range range = noise_range(noise, generator, box, NULL);
            assert_true(!isfinite(far[i]) || (range.lo <= value && range.hi >= value));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_are_the_languages),    cmocka_unit_test(turbulence_adds_octaves),
        cmocka_unit_test(derivatives_are_differences), cmocka_unit_test(bounds_hold),
        cmocka_unit_test(cells_have_random_numbers),   cmocka_unit_test(anywhere_is_safe),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
