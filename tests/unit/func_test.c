/* Functions as code: values, derivatives and ranges of random ones must agree.
 * SPDX-License-Identifier: Apache-2.0 */
#include "func_kit.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

enum { FUNCTIONS = 4000, POINTS = 24 };

static Arena *arena;

static int set_up(void **state)
{
    (void)state;
    arena = arena_new();
    return arena == NULL;
}

static int tear_down(void **state)
{
    (void)state;
    arena_free(arena);
    return 0;
}

static V3 random_point(Rng *rng)
{
    double x = rng_double(rng) * 6 - 3, y = rng_double(rng) * 6 - 3;
    return v3(x, y, rng_double(rng) * 6 - 3);
}

static double value_at(const Func *func, V3 p)
{
    return func_value(func, (double[]){p.x, p.y, p.z});
}

/* Along p + s d for s in [0, 1] every value is within the range, and the change from any point to
 * any other one within the range of the slope. */
static void ranges_hold(void **state)
{
    (void)state;
    Rng rng = rng_at(1, 2, 3);
    int finite = 0, empty = 0;
    static FuncRanges work;
    for (int i = 0; i < FUNCTIONS; i++) {
        const Func *func = random_func(arena, &rng);
        double scale = exp2(-30 * rng_double(&rng));
        V3 p = random_point(&rng), d = v3_scale(random_point(&rng), scale), q = v3_add(p, d);
        const Range at[3] = {{fmin(p.x, q.x), fmax(p.x, q.x)},
                             {fmin(p.y, q.y), fmax(p.y, q.y)},
                             {fmin(p.z, q.z), fmax(p.z, q.z)}};
        const Range along[3] = {{d.x, d.x}, {d.y, d.y}, {d.z, d.z}};
        Range value = func_range(func, at, &work), slope = func_slope(func, along, &work);
        empty += work.has_no_value;
        finite += isfinite(value.lo) && isfinite(slope.lo) && isfinite(slope.hi);
        double last = NAN, last_s = 0;
        for (int k = 0; k <= POINTS; k++) {
            double s = (double)k / POINTS;
            V3 here = k == POINTS ? q : v3_mad(p, s, d);
            here =
                v3(fmin(fmax(here.x, at[0].lo), at[0].hi), fmin(fmax(here.y, at[1].lo), at[1].hi),
                   fmin(fmax(here.z, at[2].lo), at[2].hi));
            double f = value_at(func, here);
            if (isnan(f))
                continue;
            assert_false(work.has_no_value);
            assert_true(f >= value.lo && f <= value.hi);
            double rise = f - last, doubt = 1e-9 * (fabs(value.lo) + fabs(value.hi));
            if (isfinite(rise) && isfinite(doubt)) {
                assert_true(rise <= slope.hi * (s - last_s) + doubt || slope.hi == INFINITY);
                assert_true(rise >= slope.lo * (s - last_s) - doubt || slope.lo == -INFINITY);
            }
            last = f;
            last_s = s;
        }
    }
    /* else this says little */
    assert_true(finite > FUNCTIONS / 3 && empty > FUNCTIONS / 100);
}

/* Where the range of the slope along an axis is narrow, the derivative is in it. */
static void gradients_are_slopes(void **state)
{
    (void)state;
    Rng rng = rng_at(4, 5, 6);
    static FuncRanges work;
    int checked = 0;
    for (int i = 0; i < FUNCTIONS; i++) {
        const Func *func = random_func(arena, &rng);
        V3 p = random_point(&rng), gradient;
        double h = 1e-9;
        func_gradient(func, (double[]){p.x, p.y, p.z}, &gradient);
        for (int axis = 0; axis < 3; axis++) {
            Range at[3] = {{p.x - h, p.x + h}, {p.y - h, p.y + h}, {p.z - h, p.z + h}};
            Range along[3] = {{0, 0}, {0, 0}, {0, 0}};
            along[axis] = (Range){1, 1};
            func_range(func, at, &work);
            Range slope = func_slope(func, along, &work);
            double g = v3_at(gradient, axis);
            if (!(slope.hi - slope.lo < 1e-3) || !isfinite(g))
                continue;
            assert_true(g >= slope.lo - 1e-12 && g <= slope.hi + 1e-12);
            checked += slope.lo != 0 || slope.hi != 0;
        }
    }
    assert_true(checked > FUNCTIONS / 4);
}

/* What is written twice is computed once, and what is constant not at all. */
static void steps_are_shared(void **state)
{
    (void)state;
    FuncBuilder b;
    func_begin(&b, 2);
    int x = func_param(&b, 0), two = func_const(&b, 2), three = func_const(&b, 3);
    int square = func_step(&b, FUNC_MUL, (int[]){x, x});
    assert_int_equal(square, func_step(&b, FUNC_MUL, (int[]){x, x}));
    int five = func_step(&b, FUNC_ADD, (int[]){two, three});
    double value;
    assert_true(func_is_const(&b, five, &value));
    assert_float_equal(value, 5, 0);
    const Func *f = func_end(arena, &b, func_step(&b, FUNC_SUB, (int[]){square, five}));
    assert_int_equal(f->step_count, 2);
    assert_float_equal(func_value(f, (double[]){3, 0}), 4, 0);
}

/* A call yields what the function called does. */
static void calls_are_part_of_the_code(void **state)
{
    (void)state;
    Rng rng = rng_at(7, 8, 9);
    for (int i = 0; i < 200; i++) {
        const Func *callee = random_func(arena, &rng);
        FuncBuilder b;
        func_begin(&b, 3);
        int turned[3] = {func_param(&b, 2), func_param(&b, 0), func_const(&b, 0.75)};
        const Func *caller = func_end(arena, &b, func_call(&b, callee, turned));
        V3 p = random_point(&rng);
        double direct = func_value(callee, (double[]){p.z, p.x, 0.75});
        double called = value_at(caller, p);
        assert_true(direct == called || (isnan(direct) && isnan(called)));
    }
}

/* Too long a function is told of, not cut off. */
static void length_is_limited(void **state)
{
    (void)state;
    FuncBuilder b;
    func_begin(&b, 1);
    int slot = func_param(&b, 0);
    for (int i = 0; i < 2 * FUNC_SLOTS_MAX && slot != NO_SLOT; i++)
        slot = func_step(&b, FUNC_SIN, &slot);
    assert_int_equal(slot, NO_SLOT);
    assert_int_equal(b.step_count, FUNC_SLOTS_MAX - 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(ranges_hold, set_up, tear_down),
        cmocka_unit_test_setup_teardown(gradients_are_slopes, set_up, tear_down),
        cmocka_unit_test_setup_teardown(steps_are_shared, set_up, tear_down),
        cmocka_unit_test_setup_teardown(calls_are_part_of_the_code, set_up, tear_down),
        cmocka_unit_test_setup_teardown(length_is_limited, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
