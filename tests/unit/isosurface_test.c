/* Isosurfaces: crossings against dense samples of random functions, and against closed forms.
 * SPDX-License-Identifier: Apache-2.0 */
#include "func_kit.h"
#include "shape_kit.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

enum { FUNCTIONS = 400, SAMPLES = 200, RAYS = 20000 };

static int square(FuncBuilder *b, int a)
{
    return func_step(b, FUNC_MUL, (int[]){a, a});
}

/* (x^2 + y^2 + z^2 - r^2)^power */
static const Func *ball(double radius, int power)
{
    FuncBuilder b;
    func_begin(&b, 3);
    int sum = func_const(&b, -radius * radius);
    for (int i = 0; i < 3; i++)
        sum = func_step(&b, FUNC_ADD, (int[]){sum, square(&b, func_param(&b, i))});
    return func_end(arena, &b, power == 2 ? square(&b, sum) : sum);
}

static Shape *in_box(const Func *func, double half, bool is_open)
{
    Shape *box = shape_box(arena, v3(-half, -half, -half), v3(half, half, half));
    return shape_isosurface(arena, func, 0, box, is_open);
}

static double value_at(const Func *func, const Ray *ray, double t)
{
    V3 p = ray_at(ray, t);
    return func_value(func, (double[]){p.x, p.y, p.z});
}

/* How much of a line is told wrong: samples on the wrong side of the crossings around them. */
static int count_wrong(const Shape *shape, const Ray *ray, const CrossList *list, int *inside)
{
    int wrong = 0;
    for (int i = 0; i < SAMPLES; i++) {
        double t = -6 + 12.0 * (i + 0.5) / SAMPLES, clear = INFINITY;
        bool is_inside = list->is_inside_before;
        for (int k = 0; k < list->count; k++) {
            clear = fmin(clear, fabs(list->items[k].t - t) - list->items[k].t_error);
            if (list->items[k].t < t)
                is_inside = list->items[k].change > 0;
        }
        bool is_true = shape_is_inside(shape, ray_at(ray, t));
        wrong += clear > 1e-9 && is_true != is_inside;
        *inside += is_true;
    }
    return wrong;
}

static void crossings_agree_with_samples(void **state)
{
    (void)state;
    Rng rng = rng_at(11, 0, 0);
    int inside = 0, crossings = 0, wrong = 0;
    for (int i = 0; i < FUNCTIONS; i++) {
        Shape *shape = in_box(random_func(arena, &rng), 2, false);
        shape_finish(arena, shape);
        V3 o = v3_scale(random_dir(&rng), 3);
        Ray ray = {o, v3_unit(v3_sub(v3_scale(random_dir(&rng), rng_double(&rng)), o)), 0,
                   INFINITY};
        CrossList list;
        shape_crossings(shape, &ray, scratch, &list);
        crossings += list.count;
        for (int k = 0; k + 1 < list.count; k++) {
            assert_true(list.items[k].t <= list.items[k + 1].t);
            assert_int_equal(list.items[k].change, -list.items[k + 1].change);
        }
        wrong += count_wrong(shape, &ray, &list, &inside);
    }
    assert_true(crossings > FUNCTIONS && inside > 10 * FUNCTIONS);
    /* Functions that jump may do so more finely than they are looked at. */
    assert_true(wrong <= 2);
}

/* From far away and near, the ball is where it is. */
static void a_ball_is_a_sphere(void **state)
{
    (void)state;
    static const double far[] = {0.5, 3, 1e3, 1e6};
    Rng rng = rng_at(12, 0, 0);
    Shape *iso = in_box(ball(1, 1), 1.5, false), *sphere = shape_sphere(arena, v3(0, 0, 0), 1);
    for (int i = 0; i < RAYS; i++) {
        V3 o = v3_scale(random_dir(&rng), far[i % 4]);
        V3 to = v3_scale(random_dir(&rng), 1.01 * rng_double(&rng));
        Ray ray = {o, v3_unit(v3_sub(to, o)), 0, INFINITY};
        Crossing a, b;
        bool is_hit = shape_closest(sphere, &ray, scratch, &b);
        bool is_found = shape_closest(iso, &ray, scratch, &a);
        if (is_hit != is_found) {
            V3 nearest = v3_mad(o, -v3_dot(o, ray.d), ray.d);
            assert_true(fabs(v3_len(nearest) - 1) < 1e-15 * far[i % 4] + 1e-12);
            continue;
        }
        if (!is_hit)
            continue;
        assert_true(fabs(a.t - b.t) <= a.t_error + b.t_error);
        assert_true(a.t_error < 1e-6);
        ShapePoint point;
        shape_point(&a, &ray, &point);
        assert_true(fabs(v3_len(point.p) - 1) <= point.p_error && point.p_error < 1e-8);
        assert_true(v3_dist(point.ng, v3_unit(point.p)) < 1e-9);
    }
}

/* A surface that is only touched, everywhere, bounds nothing. */
static void touching_is_no_crossing(void **state)
{
    (void)state;
    Shape *shape = in_box(ball(1, 2), 1.5, false);
    Rng rng = rng_at(13, 0, 0);
    for (int i = 0; i < 300; i++) {
        V3 o = v3_scale(random_dir(&rng), 3), to = v3_scale(random_dir(&rng), 0.9);
        Ray ray = {o, v3_unit(v3_sub(to, o)), 0, INFINITY};
        CrossList list;
        shape_crossings(shape, &ray, scratch, &list);
        assert_int_equal(list.count % 2, 0);
        for (int k = 0; k < list.count; k += 2)
            assert_true(list.items[k + 1].t - list.items[k].t < 1e-6);
    }
}

/* The container closes what it cuts, unless it is open; then nothing is seen there. */
static void containers_close(void **state)
{
    (void)state;
    Ray ray = {v3(0.1, 0.2, -9), v3(0, 0, 1), 0, INFINITY};
    Crossing hit;
    Shape *closed = in_box(ball(3, 1), 2, false), *open = in_box(ball(3, 1), 2, true);
    ShapePoint point;
    assert_true(shape_closest(closed, &ray, scratch, &hit));
    assert_true(fabs(hit.t - (7)) <= 1e-12);
    shape_point(&hit, &ray, &point);
    assert_true(fabs(point.ng.z - (-1)) <= 0);
    assert_false(shape_closest(open, &ray, scratch, &hit));
    assert_true(shape_is_inside(open, v3(0, 0, 0)) && !shape_is_inside(open, v3(0, 0, 2.5)));
    CrossList list;
    shape_crossings(open, &ray, scratch, &list);
    assert_int_equal(list.count, 2);
}

/* Scaling by a power of two moves no bit. */
static void scale_is_exact(void **state)
{
    (void)state;
    Rng rng = rng_at(14, 0, 0);
    for (int i = 0; i < 300; i++) {
        const Func *func = random_func(arena, &rng);
        Shape *shape = in_box(func, 2, false), *scaled = in_box(func, 2, false);
        double size = ldexp(1, i % 41 - 20);
        Xform x = xform_scale(v3(size, size, size));
        shape_transform(scaled, &x);
        V3 o = v3_scale(random_dir(&rng), 3), d = v3_unit(v3_sub(random_dir(&rng), o));
        Ray ray = {o, d, 0, INFINITY}, far = {v3_scale(o, size), d, 0, INFINITY};
        Crossing a, b;
        bool is_hit = shape_closest(shape, &ray, scratch, &a);
        assert_int_equal(is_hit, shape_closest(scaled, &far, scratch, &b));
        if (!is_hit)
            continue;
        assert_true(fabs(b.t - (a.t * size)) <= 0);
        ShapePoint p, q;
        shape_point(&a, &ray, &p);
        shape_point(&b, &far, &q);
        assert_true(fabs(v3_dist(q.p, v3_scale(p.p, size)) - (0)) <= 0);
        assert_true(fabs(v3_dist(q.ng, p.ng) - (0)) <= 0);
    }
}

/* As POV-Ray finds it to the accuracy asked for, and where it is by its formula. */
static void known_hits(void **state)
{
    (void)state;
    Shape *shape =
        shape_isosurface(arena, ball(0, 1), 2, shape_sphere(arena, v3(0, 0, 0), 2), false);
    Ray ray = {v3(0, 0, -9), v3(0, 0, 1), 0, INFINITY};
    Crossing hit;
    assert_true(shape_closest(shape, &ray, scratch, &hit));
    assert_true(fabs(hit.t - (9 - sqrt(2))) <= 1e-14);
    ray.tmin = hit.t + 1e-9;
    assert_true(shape_closest(shape, &ray, scratch, &hit));
    assert_true(fabs(hit.t - (9 + sqrt(2))) <= 1e-14);
    assert_int_equal(hit.change, -1);
    assert_true(fabs(value_at(ball(0, 1), &ray, hit.t) - (2)) <= 1e-13);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(crossings_agree_with_samples, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_ball_is_a_sphere, set_up, tear_down),
        cmocka_unit_test_setup_teardown(touching_is_no_crossing, set_up, tear_down),
        cmocka_unit_test_setup_teardown(containers_close, set_up, tear_down),
        cmocka_unit_test_setup_teardown(scale_is_exact, set_up, tear_down),
        cmocka_unit_test_setup_teardown(known_hits, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
