/* Height fields: against every triangle tried in turn, edges without gaps, and as solids.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/height_field.h"

#include "base/rng.h"
#include "math/sample.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include "shape_kit.h"

static HeightData *field(int columns, int rows, uint64_t seed, double water, bool is_smooth)
{
    HeightData *data = ARENA_NEW(arena, HeightData);
    uint16_t *heights = ARENA_ARRAY(arena, uint16_t, (size_t)columns * (size_t)rows);
    Rng rng = rng_at(seed, 1, 0);
    for (int i = 0; i < columns * rows; i++)
        heights[i] = (uint16_t)(20000 + 30000 * rng_double(&rng));
    *data = (HeightData){.heights = heights,
                         .columns = columns,
                         .rows = rows,
                         .water = water * HEIGHT_SCALE,
                         .is_smooth = is_smooth};
    assert_true(height_prepare(arena, data));
    return data;
}

static V3 point_at(const HeightData *d, int x, int z)
{
    return v3((double)x / (d->columns - 1), d->heights[z * d->columns + x] / 65536.,
              (double)z / (d->rows - 1));
}

/* The nearest of all triangles. */
static double slow_closest(const HeightData *d, const Ray *ray)
{
    double best = INFINITY;
    for (int z = 0; z < d->rows - 1; z++) {
        for (int x = 0; x < d->columns - 1; x++) {
            V3 b = point_at(d, x + 1, z), c = point_at(d, x, z + 1);
            const V3 low[3] = {point_at(d, x, z), b, c},
                     high[3] = {point_at(d, x + 1, z + 1), b, c};
            TriHit hit;
            for (int i = 0; i < 2; i++)
                if (tri_test(i ? high : low, ray, &hit) && hit.t < best &&
                    ray_at(ray, hit.t).y * HEIGHT_SCALE >= d->water)
                    best = hit.t;
        }
    }
    return best;
}

static void test_rays_against_every_triangle(void **state)
{
    (void)state;
    static const int size[4][2] = {{2, 2}, {17, 9}, {3, 40}, {33, 33}};
    int hits = 0;
    for (uint64_t k = 0; k < 4; k++) {
        HeightData *data = field(size[k][0], size[k][1], k, k % 2 ? .5 : 0, false);
        Shape *shape = shape_height_field(arena, data);
        Rng rng = rng_at(5, 1, k);
        for (int i = 0; i < 3000; i++) {
            V3 to = v3(rng_double(&rng), 0, 0), d = random_dir(&rng);
            to.y = .3 + .5 * rng_double(&rng), to.z = rng_double(&rng);
            Ray ray = {v3_mad(to, -4 * rng_double(&rng), d), d, 0, INFINITY};
            Crossing c;
            double t = slow_closest(data, &ray);
            bool is_hit = shape_closest(shape, &ray, scratch, &c);
            hits += is_hit;
            assert_int_equal(is_hit, t < INFINITY);
            if (is_hit) {
                assert_true(fabs(c.t - t) <= 1e-11 + 2 * c.t_error);
                ShapePoint point;
                shape_point(&c, &ray, &point);
                assert_true(v3_dist(point.p, ray_at(&ray, t)) < 1e-9);
                assert_true(point.ng.y > 0);
            }
        }
    }
    assert_true(hits > 3000);
}

/* Rays straight at points and edges pass nowhere, from any distance. */
static void test_no_gaps(void **state)
{
    (void)state;
    HeightData *data = field(9, 17, 3, 0, false);
    Shape *shape = shape_height_field(arena, data);
    Rng rng = rng_at(6, 1, 0);
    for (int i = 0; i < 20000; i++) {
        int x = 1 + (int)(7 * rng_double(&rng)), z = 1 + (int)(15 * rng_double(&rng));
        V3 a = point_at(data, x, z), b = point_at(data, x + i % 2, z + i / 2 % 2);
        V3 to = v3_mad(a, rng_double(&rng), v3_sub(b, a));
        V3 d = v3_unit(v3(rng_double(&rng) - .5, -8, rng_double(&rng) - .5));
        double away = i % 3 == 0 ? 1e6 : i % 3;
        Ray ray = {v3_mad(to, -(1 + away), d), d, 0, INFINITY};
        Crossing c;
        assert_true(shape_closest(shape, &ray, scratch, &c));
    }
}

/* Along a line, the state that the list tells is what is inside. */
static void test_as_a_solid(void **state)
{
    (void)state;
    int crossings = 0;
    for (uint64_t k = 0; k < 3; k++) {
        HeightData *data = field(9, 12, k, k == 1 ? .5 : k == 2 ? .9 : 0, false);
        Shape *shape = shape_height_field(arena, data);
        Rng rng = rng_at(7, 1, k);
        for (int i = 0; i < 2000; i++) {
            V3 to = v3(rng_double(&rng), 0, 0), d = random_dir(&rng);
            to.y = rng_double(&rng), to.z = rng_double(&rng);
            if (i % 10 == 0)
                d = v3(0, i % 20 ? 1 : -1, 0);
            if (i % 10 == 1)
                d = v3(i % 20 == 1, 0, i % 20 != 1);
            Ray ray = {v3_mad(to, -3, d), d, 0, INFINITY};
            CrossList list;
            shape_crossings(shape, &ray, scratch, &list);
            bool is_inside = list.is_inside_before;
            double from = -1e9;
            crossings += list.count;
            for (int j = 0; j <= list.count; j++) {
                double until = j < list.count ? list.items[j].t : 1e9;
                assert_true(until >= from);
                /* The list is for the whole line: a point of it between two crossings. */
                if (until - from > 1e-9)
                    assert_int_equal(shape_is_inside(shape, ray_at(&ray, .5 * (from + until))),
                                     is_inside);
                if (j < list.count) {
                    assert_int_equal(list.items[j].change, is_inside ? -1 : 1);
                    is_inside = !is_inside;
                }
                from = until;
            }
        }
    }
    assert_true(crossings > 5000);
}

static void test_water_cuts_the_surface_off(void **state)
{
    (void)state;
    Shape *shape = shape_height_field(arena, field(5, 5, 1, .9, false));
    Crossing c;
    Ray ray = {v3(.4, 3, .4), v3(0, -1, 0), 0, INFINITY};
    assert_false(shape_closest(shape, &ray, scratch, &c));
    assert_true(shape_is_inside(shape, v3(.4, -100, .4))); /* probe */
    assert_false(shape_is_inside(shape, v3(1.4, -100, .4)));
}

/* A slope as smooth as it gets: the normal is the plane's everywhere. */
static void test_smooth_normals_of_a_plane(void **state)
{
    (void)state;
    uint16_t heights[25];
    for (int i = 0; i < 25; i++)
        heights[i] = (uint16_t)(1000 * (i % 5) + 3000 * (i / 5));
    HeightData data = {.heights = heights, .columns = 5, .rows = 5, .is_smooth = true};
    assert_true(height_prepare(arena, &data));
    Shape *shape = shape_height_field(arena, &data);
    Xform x = xform_scale(v3(3, 40, 2)), turn = xform_rotate(v3(.3, 1, 2));
    shape_transform(shape, &x);
    shape_transform(shape, &turn);
    V3 wanted = v3(-1000 * 4 / 65536. * 40 / 3, 1, -3000 * 4 / 65536. * 40 / 2);
    wanted = v3_unit(xform_dir(&turn, wanted));
    for (int i = 1; i < 100; i++) {
        V3 on = v3(3 * (.005 + .0099 * i), 50, 2 * fmod(.37 * i, 1));
        Ray ray = {xform_point(&turn, on), xform_dir(&turn, v3(0, -1, 0)), 0, INFINITY};
        Crossing c;
        ShapePoint point;
        assert_true(shape_closest(shape, &ray, scratch, &c));
        shape_point(&c, &ray, &point);
        assert_true(v3_dist(point.ns, wanted) < 1e-12);
        assert_true(v3_dist(point.ng, wanted) < 1e-12);
    }
}

static void test_powers_of_two_change_nothing(void **state)
{
    (void)state;
    HeightData *data = field(20, 20, 9, .4, true);
    for (int exponent = -40; exponent <= 40; exponent += 20) {
        double s = ldexp(1, exponent);
        Shape *one = shape_height_field(arena, data), *two = shape_height_field(arena, data);
        Xform x = xform_scale(v3(s, s, s));
        shape_transform(two, &x);
        Rng rng = rng_at(8, 1, 0);
        for (int i = 0; i < 1000; i++) {
            V3 o = v3_scale(random_dir(&rng), 2), to = v3(rng_double(&rng), .6, 0);
            to.z = rng_double(&rng);
            V3 d = v3_unit(v3_sub(to, o));
            Ray a = {o, d, 0, INFINITY}, b = {v3_scale(o, s), d, 0, INFINITY};
            Crossing p, q;
            bool is_hit = shape_closest(one, &a, scratch, &p);
            assert_int_equal(shape_closest(two, &b, scratch, &q), is_hit);
            if (is_hit)
                assert_true(p.t * s == q.t && p.t_error * s == q.t_error && p.part == q.part);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_rays_against_every_triangle, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_no_gaps, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_as_a_solid, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_water_cuts_the_surface_off, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_smooth_normals_of_a_plane, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_powers_of_two_change_nothing, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
