/* Hulls of shadow rays: what is said to be missed is met by no ray.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/hull.h"

#include "base/rng.h"
#include "math/sample.h"
#include "trace/trace.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static Rng rng;

static double pick(double lo, double hi)
{
    return lo + (hi - lo) * rng_double(&rng);
}

static V3 pick_v3(double size)
{
    return v3(pick(-size, size), pick(-size, size), pick(-size, size));
}

static V3 in_ball(V3 center, double radius)
{
    V3 d = warp_sphere((V2){rng_double(&rng), rng_double(&rng)});
    return v3_mad(center, radius * cbrt(rng_double(&rng)), d);
}

static Shape *leaf(Arena *arena)
{
    V3 a = pick_v3(1);
    switch ((int)pick(0, 7)) {
    case 0:
        return shape_sphere(arena, a, pick(0.2, 1.5));
    case 1:
        return shape_box(arena, a, v3_add(a, v3(pick(0.1, 2), pick(0.1, 2), pick(0.1, 2))));
    case 2:
        return shape_cone(arena, a, pick(0.1, 1), pick_v3(2), pick(0, 1), pick(0, 1) < 0.5);
    case 3:
        return shape_plane(arena, v3_unit(pick_v3(1)), pick(-1, 1));
    case 4:
        return shape_torus(arena, pick(0.5, 1), pick(0.1, 0.4));
    case 5:
        return shape_disc(arena, a, v3_unit(pick_v3(1)), pick(0.5, 2), 0);
    default:
        return shape_sphere(arena, v3(0, 0, 0), 3);
    }
}

/* A leaf or a tree of them, turned, stretched, inverted. */
static Shape *any_shape(Arena *arena, int depth)
{
    Shape *shape;
    if (depth > 0 && pick(0, 1) < 0.6) {
        Shape **children = ARENA_ARRAY(arena, Shape *, 3);
        int count = 2 + (pick(0, 1) < 0.5);
        for (int i = 0; i < count; i++)
            children[i] = any_shape(arena, depth - 1);
        const ShapeKind kinds[] = {SHAPE_UNION, SHAPE_MERGE, SHAPE_INTERSECTION};
        shape = shape_csg(arena, kinds[(int)pick(0, 3)], children, count);
    } else {
        shape = leaf(arena);
    }
    if (pick(0, 1) < 0.5) {
        Xform scale = xform_scale(v3(pick(0.3, 2), pick(0.3, 2), pick(0.3, 2)));
        Xform turn = xform_rotate(pick_v3(3));
        Xform both = xform_then(&scale, &turn);
        shape_transform(shape, &both);
    }
    if (pick(0, 1) < 0.25)
        shape_invert(shape);
    return shape;
}

/* A point of the shape's surface that some ray meets, as rays leave it. */
static bool surface_point(const Shape *shape, ShapeScratch *scratch, ShapePoint *out)
{
    V3 from = in_ball(v3(0, 0, 0), 6);
    Ray ray = {from, v3_unit(v3_sub(pick_v3(1), from)), 0, INFINITY};
    Crossing crossing;
    if (!shape_closest(shape, &ray, scratch, &crossing))
        return false;
    shape_point(&crossing, &ray, out);
    return true;
}

static int rays_that_meet(const Shape *shape, ShapeScratch *scratch, V3 apex, V3 center,
                          double radius)
{
    int met = 0;
    for (int i = 0; i < 40; i++) {
        V3 to = v3_sub(in_ball(center, radius), apex);
        Ray ray = {apex, v3_unit(to), 0, v3_len(to)};
        Crossing crossing;
        met += shape_closest(shape, &ray, scratch, &crossing);
    }
    return met;
}

static void missed_shapes_are_met_by_no_ray(void **state)
{
    (void)state;
    ShapeScratch *scratch = shape_scratch_new();
    int proved = 0, tries = 0;
    for (uint32_t i = 0; i < 4000; i++) {
        rng = rng_at(11, 1, i);
        Arena *arena = arena_new();
        Shape *shape = any_shape(arena, 2);
        V3 apex = pick_v3(4), center = pick_v3(8);
        double radius = pick(0, 1.5), error = 0;
        ShapePoint at;
        if (pick(0, 1) < 0.6 && surface_point(shape, scratch, &at)) {
            apex = trace_ray_from(&at, v3_sub(center, at.p)).o;
            error = 16 * at.p_error;
            /* Rays that leave on both sides of the surface have no common start. */
            if (!(fabs(v3_dot(v3_sub(center, at.p), at.ng)) > radius))
                radius = 0;
        }
        Hull hull;
        if (hull_init(&hull, apex, error, center, radius)) {
            tries++;
            if (hull_misses_shape(&hull, shape)) {
                proved++;
                int met = rays_that_meet(shape, scratch, apex, center, radius);
                if (met)
                    fail_msg("shape %u: %d rays meet what was said to be missed", i, met);
            }
        }
        arena_free(arena);
    }
    /* The test must have something to bite on. */
    assert_true(tries > 3000 && proved > tries / 5 && proved < tries);
    shape_scratch_free(scratch);
}

static void a_convex_surface_does_not_hide_what_is_above_it(void **state)
{
    (void)state;
    ShapeScratch *scratch = shape_scratch_new();
    Arena *arena = arena_new();
    Shape *shapes[] = {shape_sphere(arena, v3(0.1, 0.2, 0.3), 1),
                       shape_box(arena, v3(-1, -1, -1), v3(1, 1, 1)),
                       shape_plane(arena, v3(0, 1, 0), 0.3),
                       shape_cone(arena, v3(0, 0, 0), 1, v3(0, 1, 0), 1, false)};
    for (int i = 0; i < 4; i++) {
        Ray ray = {v3(0.3, 5, 0.2), v3(0, -1, 0), 0, INFINITY};
        Crossing crossing;
        ShapePoint at;
        assert_true(shape_closest(shapes[i], &ray, scratch, &crossing));
        shape_point(&crossing, &ray, &at);
        Hull hull;
        V3 light = v3(2, 9, 1);
        V3 apex = trace_ray_from(&at, v3_sub(light, at.p)).o;
        assert_true(hull_init(&hull, apex, 16 * at.p_error, light, 1));
        assert_true(hull_misses_shape(&hull, shapes[i]));
        /* From below nothing is proved. */
        assert_true(hull_init(&hull, v3(0.3, -9, 0.2), 0, light, 1));
        assert_false(hull_misses_shape(&hull, shapes[i]));
    }
    arena_free(arena);
    shape_scratch_free(scratch);
}

static void within_a_room_its_walls_are_missed(void **state)
{
    (void)state;
    Arena *arena = arena_new();
    Shape *room = shape_box(arena, v3(-5, -5, -5), v3(5, 5, 5));
    Hull hull;
    assert_true(hull_init(&hull, v3(-4, -4, 0), 0, v3(3, 3, 3), 1));
    assert_true(hull_misses_shape(&hull, room));
    assert_true(hull_init(&hull, v3(-4, -4, 0), 0, v3(4.5, 3, 3), 1));
    assert_false(hull_misses_shape(&hull, room));
    arena_free(arena);
}

static void balls_beside_and_behind_are_missed(void **state)
{
    (void)state;
    Hull hull;
    assert_false(hull_init(&hull, v3(0, 0, 0), 0, v3(0, 0, 1), 1));
    assert_true(hull_init(&hull, v3(0, 0, 0), 0, v3(0, 0, 10), 1));
    assert_false(hull_misses_ball(&hull, v3(0, 0, 5), 0.1));
    assert_false(hull_misses_ball(&hull, v3(1.5, 0, 5), 1.01));
    assert_true(hull_misses_ball(&hull, v3(1.6, 0, 5), 1));
    assert_true(hull_misses_ball(&hull, v3(0, 0, -2), 1));
    assert_true(hull_misses_ball(&hull, v3(0, 0, 13), 1));
}

/* No surface point of a leaf is further than the furthest, and that is on it or the box around. */
static void nothing_is_further_than_the_farthest(void **state)
{
    (void)state;
    ShapeScratch *scratch = shape_scratch_new();
    int met = 0;
    for (uint32_t i = 0; i < 1000; i++) {
        rng = rng_at(12, 1, i);
        Arena *arena = arena_new();
        Shape *shape = any_shape(arena, 0);
        V3 n = v3_scale(v3_unit(pick_v3(1)), pick(0.1, 10));
        for (int k = 0; k < 40 && shape->kind != SHAPE_PLANE; k++) {
            ShapePoint at;
            if (!surface_point(shape, scratch, &at))
                continue;
            V3 farthest = shape_farthest(shape, n);
            assert_true(v3_dot(n, at.p) <= v3_dot(n, farthest) + v3_len(n) * 1e-9);
            met++;
        }
        arena_free(arena);
    }
    assert_true(met > 5000);
    shape_scratch_free(scratch);
}

/* It is a point of the leaf: a little further in is inside. */
static void farthest_points_are_on_the_leaf(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 1000; i++) {
        rng = rng_at(13, 1, i);
        Arena *arena = arena_new();
        Shape *shape = any_shape(arena, 0);
        V3 n = pick_v3(1);
        if (shape_is_convex(shape) && shape->kind != SHAPE_PLANE) {
            V3 farthest = shape_farthest(shape, n), middle = bound_center(shape_bound(shape));
            assert_true(shape_is_inside(shape, v3_mad(farthest, 1e-6, v3_sub(middle, farthest))));
            assert_false(shape_is_inside(shape, v3_mad(farthest, 1e-6, v3_unit(n))));
        }
        arena_free(arena);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(missed_shapes_are_met_by_no_ray),
        cmocka_unit_test(nothing_is_further_than_the_farthest),
        cmocka_unit_test(farthest_points_are_on_the_leaf),
        cmocka_unit_test(a_convex_surface_does_not_hide_what_is_above_it),
        cmocka_unit_test(within_a_room_its_walls_are_missed),
        cmocka_unit_test(balls_beside_and_behind_are_missed),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
