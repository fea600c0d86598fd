/* Patterns against values measured with povray 3.7.  SPDX-License-Identifier: Apache-2.0 */
#include "texture/texture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

typedef struct Row {
    Pattern pattern;
    V3 p;
    double value; /* as povray prints it: 8 digits */
} Row;

#define CHECKER                                                                                    \
    {                                                                                              \
        .kind = PATTERN_CHECKER                                                                    \
    }
#define GRADIENT_X .kind = PATTERN_GRADIENT, .direction = {1, 0, 0}, .frequency = 1
#define WAVE(w)                                                                                    \
    {                                                                                              \
        GRADIENT_X, .wave = w                                                                      \
    }
#define GRADIENT_121                                                                               \
    {                                                                                              \
        .kind = PATTERN_GRADIENT, .frequency = 1, .direction = {                                   \
            0.40824829046386302,                                                                   \
            0.81649658092772603,                                                                   \
            -0.40824829046386302                                                                   \
        }                                                                                          \
    }
#define POLY                                                                                       \
    {                                                                                              \
        GRADIENT_X, .wave = WAVE_POLY, .exponent = 2.5f                                            \
    }
#define FREQUENT                                                                                   \
    {                                                                                              \
        .kind = PATTERN_GRADIENT, .direction = {1, 0, 0}, .frequency = 3, .phase = 0.25f           \
    }

static void test_measured_values(void **state)
{
    (void)state;
    static const Row rows[] = {
        {CHECKER, {-1.06005, 1.00856, -3.82585}, 1},
        {CHECKER, {0.54029, -2.67295, 2.76596}, 1},
        {CHECKER, {0.79053, -2.74452, 0.85118}, 1},
        {CHECKER, {3.32063, 2.52048, 2.25864}, 1},
        {GRADIENT_121, {0.51234, -2.06096, -3.80975}, 0.08171906},
        {GRADIENT_121, {-3.36911, -3.49265, 1.69351}, 0.081497256},
        {GRADIENT_121, {1.20992, -1.36392, -2.57095}, 0.4298977},
        {GRADIENT_121, {1.98352, -2.28033, -0.42904}, 0.12304185},
        {WAVE(WAVE_SINE), {3.43022, -1.74627, -2.63461}, 0.71226407},
        {WAVE(WAVE_SINE), {2.89953, -2.69530, 1.96047}, 0.2049141},
        {WAVE(WAVE_SINE), {0.05951, 0.88208, -1.57635}, 0.68263013},
        {WAVE(WAVE_SINE), {-0.49062, -0.38509, 1.06095}, 0.47054892},
        {WAVE(WAVE_TRIANGLE), {3.23437, -0.07687, 1.57349}, 0.46874},
        {WAVE(WAVE_TRIANGLE), {-2.86002, 0.91590, 0.45994}, 0.28},
        {WAVE(WAVE_TRIANGLE), {-3.48199, 1.02474, -3.08512}, 0.96392},
        {WAVE(WAVE_SCALLOP), {1.73074, 0.98844, 3.80901}, 0.74857164},
        {WAVE(WAVE_SCALLOP), {-0.93685, -3.85275, -3.16598}, 0.19709271},
        {WAVE(WAVE_CUBIC), {2.46003, -3.08862, -2.19120}, 0.44017271},
        {WAVE(WAVE_CUBIC), {-3.48842, 0.64684, -2.61868}, 0.51741187},
        {POLY, {-0.21789, 3.96323, 2.93112}, 0.54096553},
        {POLY, {2.59063, -2.20300, -1.10582}, 0.26809503},
        {FREQUENT, {3.65478, -0.04648, -3.79060}, 0.21432},
        {FREQUENT, {-3.98197, 3.88495, -1.14251}, 0.3042},
        {FREQUENT, {1.39182, -1.97400, 0.18177}, 0.42545},
        {FREQUENT, {1.02847, 2.93825, -3.18871}, 0.33541},
    };
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
        assert_true(fabs(pattern_value(&rows[i].pattern, rows[i].p) - rows[i].value) < 2e-8);
}

static void test_checker_edges(void **state)
{
    (void)state;
    Pattern checker = CHECKER;
    assert_true(pattern_value(&checker, v3(0.5, 0.5, 0.5)) == 0);
    assert_true(pattern_value(&checker, v3(-0.5, 0.5, 0.5)) == 1);
    /* a plane at y = 0 met from either side of its rounding shows the same squares */
    assert_true(pattern_value(&checker, v3(0.5, 1e-14, 0.5)) == 0);
    assert_true(pattern_value(&checker, v3(0.5, -1e-14, 0.5)) == 0);
    assert_true(pattern_value(&checker, v3(0.5, -1e-9, 0.5)) == 1);
    assert_true(pattern_value(&checker, v3(1e15 + 0.5, 0.5, 0.5)) == 0);
    assert_true(pattern_value(&checker, v3(1e15 + 1.5, 0.5, 0.5)) == 1);
}

static void test_gradient_keeps_one(void **state)
{
    (void)state;
    Pattern ramp = {GRADIENT_X};
    assert_true(pattern_value(&ramp, v3(1, 0, 0)) == 1);
    assert_true(pattern_value(&ramp, v3(0, 0, 0)) == 0);
    assert_true(pattern_value(&ramp, v3(-1, 0, 0)) == 0);
    assert_true(fabs(pattern_value(&ramp, v3(-0.25, 0, 0)) - 0.75) < 1e-15);
}

static void test_transform(void **state)
{
    (void)state;
    Pattern ramp = {GRADIENT_X, .is_transformed = true};
    Xform grow = xform_scale(v3(2, 1, 1)), move = xform_translate(v3(0.5, 0, 0));
    ramp.xform = xform_then(&grow, &move);
    assert_true(fabs(pattern_value(&ramp, v3(1, 0, 0)) - 0.25) < 1e-15);
    assert_true(fabs(pattern_point(&ramp, v3(1, 2, 3)).x - 0.25) < 1e-15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_measured_values),
        cmocka_unit_test(test_checker_edges),
        cmocka_unit_test(test_gradient_keeps_one),
        cmocka_unit_test(test_transform),
    };
    return cmocka_run_group_tests_name("pattern", tests, NULL, NULL);
}
