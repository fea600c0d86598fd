/* Julia fractals: where they are, which way they face, and that lines go in and out in turn.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape_kit.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

enum { RAYS = 400, SAMPLES = 300 };

static JuliaForm form_of(bool is_hypercomplex, JuliaFunction function, int iterations)
{
    return (JuliaForm){.is_hypercomplex = is_hypercomplex,
                       .function = function,
                       .c = {-0.08, 0.1, -0.83, -0.025},
                       .power = {3, 0.5},
                       .iterations = iterations,
                       .precision = 15,
                       .slice = {0, 0, 0, 1}};
}

/* POV-Ray's own hits along z from <0.1, 0.2, -9>, which it finds to 1e-7. */
static void known_hits(void **state)
{
    (void)state;
    static const struct {
        bool is_hypercomplex;
        JuliaFunction function;
        double z;
        V3 n;
    } cases[] = {
        {false, JULIA_SQR, -0.3205519, {0.8696251, 0.1613028, -0.4666193}},
        {false, JULIA_CUBE, -1.0999030, {0.0827668, 0.2063335, -0.9749750}},
        {true, JULIA_SQR, -0.1379675, {0.1542676, 0.6986458, -0.6986384}},
        {true, JULIA_CUBE, -0.1379675, {0.1542676, 0.6986458, -0.6986384}},
    };
    Ray ray = {v3(0.1, 0.2, -9), v3(0, 0, 1), 0, INFINITY};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        JuliaForm form = form_of(cases[i].is_hypercomplex, cases[i].function, 8);
        Shape *shape = shape_julia(arena, &form);
        Crossing hit;
        ShapePoint point;
        assert_true(shape_closest(shape, &ray, scratch, &hit));
        shape_point(&hit, &ray, &point);
        assert_true(fabs(point.p.z - cases[i].z) < 2e-6);
        assert_true(v3_dist(point.ns, cases[i].n) < 1e-4);
    }
}

/* The points of three rays beside each other lie in a plane that the normal is square to; but
 * powers jump along a cut, which is a surface as well. */
static void normals_are_square(void **state)
{
    (void)state;
    Rng rng = rng_at(21, 0, 0);
    int checked = 0, wrong = 0;
    for (int function = JULIA_SQR; function < JULIA_PWR; function++) {
        for (int i = 0; i < RAYS; i++) {
            JuliaForm form = form_of(true, (JuliaFunction)function, 3);
            form.is_hypercomplex = function > JULIA_CUBE || i % 2;
            form.slice[0] = 0.3;
            form.slice_distance = 0.1;
            Shape *shape = shape_julia(arena, &form);
            V3 o = v3_scale(random_dir(&rng), 6), d = v3_unit(v3_sub(random_dir(&rng), o)), s, t;
            v3_frame(d, &s, &t);
            const V3 from[3] = {o, v3_mad(o, 1e-5, s), v3_mad(o, 1e-5, t)};
            V3 p[3], n = v3(0, 0, 0);
            int found = 0;
            for (int k = 0; k < 3; k++) {
                Ray ray = {from[k], d, 0, INFINITY};
                Crossing hit;
                ShapePoint point;
                if (!shape_closest(shape, &ray, scratch, &hit))
                    break;
                shape_point(&hit, &ray, &point);
                p[found++] = point.p;
                n = k == 0 ? point.ng : n;
            }
            bool is_smooth = found == 3 && v3_dist(p[0], p[1]) < 1e-4 && v3_dist(p[0], p[2]) < 1e-4;
            double radius = form.is_hypercomplex ? 4 : 2;
            if (!is_smooth || v3_len(p[0]) > 0.9 * radius)
                continue;
            V3 flat = v3_unit(v3_cross(v3_sub(p[1], p[0]), v3_sub(p[2], p[0])));
            checked++;
            wrong += fabs(v3_dot(flat, n)) <= 0.98;
        }
    }
    assert_true(checked > RAYS);
    assert_true(wrong <= checked / 200); /* edges, and the cut of logarithms */
}

/* Lists alternate, and tell the inside of points that they are not too near to. */
static void lists_agree_with_inside(void **state)
{
    (void)state;
    Rng rng = rng_at(22, 0, 0);
    int inside = 0, wrong = 0;
    for (int i = 0; i < RAYS; i++) {
        JuliaForm form = form_of(i % 2, JULIA_SQR, 6);
        form.precision = 200;
        Shape *shape = shape_julia(arena, &form);
        V3 o = v3_scale(random_dir(&rng), 6), d = v3_unit(v3_sub(random_dir(&rng), o));
        Ray ray = {o, d, 0, INFINITY};
        CrossList list;
        shape_crossings(shape, &ray, scratch, &list);
        assert_int_equal(list.count % 2, 0);
        for (int k = 0; k < list.count; k++)
            assert_int_equal(list.items[k].change, k % 2 ? -1 : 1);
        for (int k = 0; k < SAMPLES; k++) {
            double t = 12.0 * k / SAMPLES;
            bool is_in = false;
            for (int c = 0; c < list.count && list.items[c].t < t; c++)
                is_in = list.items[c].change > 0;
            bool is_true = shape_is_inside(shape, ray_at(&ray, t));
            inside += is_true;
            wrong += is_in != is_true;
        }
    }
    assert_true(inside > 2 * RAYS);
    assert_true(wrong < RAYS * SAMPLES / 2000); /* what is finer than the precision */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(known_hits, set_up, tear_down),
        cmocka_unit_test_setup_teardown(normals_are_square, set_up, tear_down),
        cmocka_unit_test_setup_teardown(lists_agree_with_inside, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
