/* Polygons: loops and holes, many points against a slow count in long double, shared edges.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/polygon.h"
#include "shape/shape.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include "shape_kit.h"

/* Make a polygon of loops whose lengths end with 0. */
static Shape *polygon_of(const V3 *points, const uint32_t *lengths)
{
    uint32_t count = 0;
    for (int i = 0; lengths[i]; i++)
        count += lengths[i];
    PolygonData *data = ARENA_NEW(arena, PolygonData);
    data->points = arena_copy(arena, points, count * sizeof *points);
    data->next = ARENA_ARRAY(arena, uint32_t, count);
    data->count = count;
    for (uint32_t i = 0, at = 0; lengths[i]; at += lengths[i++])
        for (uint32_t k = 0; k < lengths[i]; k++)
            data->next[at + k] = at + (k + 1) % lengths[i];
    bool is_flat;
    assert_true(polygon_prepare(arena, data, &is_flat));
    return is_flat ? shape_polygon(arena, data) : NULL;
}

static bool is_met(const Shape *shape, V3 o, V3 d, Crossing *c)
{
    Ray ray = {o, d, 0, INFINITY};
    return shape_closest(shape, &ray, scratch, c);
}

static void test_a_square_with_a_hole(void **state)
{
    (void)state;
    const V3 points[] = {{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0},
                         {1, 1, 0}, {2, 1, 0}, {2, 2, 0}, {1, 2, 0}};
    Shape *square = polygon_of(points, (uint32_t[]){4, 4, 0});
    Crossing c;
    Ray ray = {v3(.5, .5, -5), v3(0, 0, 1), 0, INFINITY};
    assert_true(shape_closest(square, &ray, scratch, &c));
    assert_true(c.t == 5 && c.change == 0);
    ShapePoint point;
    shape_point(&c, &ray, &point);
    assert_true(point.ng.x == 0 && point.ng.y == 0 && point.ng.z == 1); /* probe */
    assert_true(point.p.x == .5 && point.p.y == .5 && point.p.z == 0);
    assert_false(is_met(square, v3(1.5, 1.5, -5), v3(0, 0, 1), &c));
    assert_false(is_met(square, v3(3.5, 1.5, -5), v3(0, 0, 1), &c));
    assert_false(is_met(square, v3(.5, .5, -5), v3(0, 1, 0), &c));
    assert_false(shape_is_solid(square));
    assert_false(shape_is_inside(square, v3(.5, .5, 0)));
    Bound b = shape_bound(square);
    assert_true(fabs(b.hi.x - 3) < 1e-12 && fabs(b.lo.z) < 1e-12);
}

static void test_points_off_a_plane_or_on_a_line_make_none(void **state)
{
    (void)state;
    const V3 bent[] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, .1}};
    const V3 line[] = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
    const V3 same[] = {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}};
    assert_null(polygon_of(bent, (uint32_t[]){4, 0}));
    assert_null(polygon_of(line, (uint32_t[]){3, 0}));
    assert_null(polygon_of(same, (uint32_t[]){3, 0}));
}

enum { MANY = 1000 };

/* A star of two rings of points that cross each other, in the plane z = 0. */
static void many_points(Rng *rng, V3 *out, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        double angle = 2 * PMS_PI * 7 * i / count, r = .3 + .7 * rng_double(rng);
        out[i] = v3(r * cos(angle), r * sin(angle), 0);
    }
}

static bool slow_inside(const V3 *p, uint32_t count, long double x, long double y)
{
    bool is_inside = false;
    for (uint32_t i = 0; i < count; i++) {
        V3 a = p[i], b = p[(i + 1) % count];
        if ((a.y > y) != (b.y > y) &&
            x < (b.x - (long double)a.x) * (y - a.y) / (b.y - (long double)a.y) + a.x)
            is_inside = !is_inside;
    }
    return is_inside;
}

static void test_many_points_against_a_slow_count(void **state)
{
    (void)state;
    Rng rng = rng_at(5, 0, 0);
    for (int round = 0; round < 8; round++) {
        V3 points[MANY];
        uint32_t count = round < 4 ? 5 + 6 * (uint32_t)round : MANY;
        many_points(&rng, points, count);
        Shape *flat = polygon_of(points, (uint32_t[]){count, 0});
        Shape *turned = shape_copy(arena, flat);
        Xform x = xform_rotate(v3(.3, 1.1, -2)), shift = xform_translate(v3(4, 5, 6));
        shape_transform(turned, &x);
        shape_transform(turned, &shift);
        x = xform_then(&x, &shift);
        for (int i = 0; i < 2000; i++) {
            V3 p = v3(2 * rng_double(&rng) - 1, 0, 0), d = random_dir(&rng);
            p.y = 2 * rng_double(&rng) - 1;
            V3 from = v3_mad(p, -3, d);
            Crossing c;
            bool wanted = slow_inside(points, count, p.x, p.y);
            assert_int_equal(is_met(flat, from, d, &c), wanted);
            if (wanted)
                assert_true(fabs(c.t - 3) <= 1e-12 / fabs(d.z));
            assert_int_equal(is_met(turned, xform_point(&x, from), xform_dir(&x, d), &c), wanted);
        }
    }
}

/* Rays at the edge that two polygons share meet one of them, and never both. */
static void test_shared_edges_have_no_gap(void **state)
{
    (void)state;
    Rng rng = rng_at(6, 0, 0);
    for (int i = 0; i < 4000; i++) {
        V3 a = random_dir(&rng), b = random_dir(&rng), up = random_dir(&rng);
        V3 side = v3_cross(v3_sub(b, a), up);
        /* From far away, and from a point that the whole of both is in front of. */
        double distance = i % 2 ? 10 : 1e5;
        const V3 left[] = {a, b, v3_mad(b, 2, side), v3_mad(a, 2, side)};
        const V3 right[] = {b, a, v3_mad(a, -2, side), v3_mad(b, -2, side)};
        Shape *one = polygon_of(left, (uint32_t[]){4, 0}),
              *two = polygon_of(right, (uint32_t[]){4, 0});
        if (!one || !two)
            continue;
        for (int k = 0; k < 20; k++) {
            V3 on = v3_mad(a, rng_double(&rng), v3_sub(b, a));
            V3 from = v3_mad(v3_mad(on, distance, up), distance * .1, v3_unit(side));
            V3 d = v3_unit(v3_sub(on, from));
            Crossing c;
            assert_int_equal(is_met(one, from, d, &c) + is_met(two, from, d, &c), 1);
        }
    }
}

static void test_powers_of_two_change_nothing(void **state)
{
    (void)state;
    Rng rng = rng_at(7, 0, 0);
    V3 points[200];
    many_points(&rng, points, 200);
    for (int i = 0; i < 200; i++)
        points[i].z = .4 * points[i].x;
    for (int exponent = -60; exponent <= 60; exponent += 20) {
        double s = ldexp(1, exponent);
        V3 big[200];
        for (int i = 0; i < 200; i++)
            big[i] = v3_scale(points[i], s);
        Shape *small = polygon_of(points, (uint32_t[]){200, 0});
        Shape *scaled = polygon_of(big, (uint32_t[]){200, 0});
        Rng rays = rng_at(8, 0, 0);
        for (int i = 0; i < 2000; i++) {
            V3 o = v3_scale(random_dir(&rays), 4);
            V3 d = v3_unit(v3_sub(v3_scale(random_dir(&rays), .7), o));
            Crossing a, b;
            bool is_hit = is_met(small, o, d, &a);
            assert_int_equal(is_met(scaled, v3_scale(o, s), d, &b), is_hit);
            if (is_hit)
                assert_true(a.t * s == b.t && a.t_error * s == b.t_error);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_a_square_with_a_hole, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_points_off_a_plane_or_on_a_line_make_none, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(test_many_points_against_a_slow_count, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_shared_edges_have_no_gap, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_powers_of_two_change_nothing, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
