/* CSG: lists against membership of points, coincident faces, walls, clips, sheets.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape.h"

#include "base/rng.h"
#include "math/sample.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>

#include "shape_kit.h"

static Shape *csg(ShapeKind kind, int count, ...)
{
    Shape **children = ARENA_ARRAY(arena, Shape *, (size_t)count);
    va_list args;
    va_start(args, count);
    for (int i = 0; i < count; i++)
        children[i] = va_arg(args, Shape *);
    va_end(args);
    return shape_csg(arena, kind, children, count);
}

static Shape *inverse(Shape *shape)
{
    shape_invert(shape);
    return shape;
}

static Shape *difference(Shape *a, Shape *b)
{
    return csg(SHAPE_INTERSECTION, 2, a, inverse(b));
}

static Shape *clipped(Shape *shape, Shape *clip)
{
    shape->clips = ARENA_ARRAY(arena, Shape *, 1);
    shape->clips[0] = clip;
    shape->clip_count = 1;
    return shape;
}

static Shape *ball(double x, double r)
{
    return shape_sphere(arena, v3(x, 0, 0), r);
}
static Shape *box(V3 a, V3 b)
{
    return shape_box(arena, a, b);
}
static Shape *cube(double a, double b)
{
    return box(v3(a, -1, -1), v3(b, 1, 1));
}

static CrossList list_x(const Shape *shape)
{
    CrossList list;
    Ray ray = {{-10, 0.1, 0.2}, {1, 0, 0}, 0, INFINITY};
    shape_crossings(shape, &ray, scratch, &list);
    assert_false(list.is_overflown);
    return list;
}

/* Compare a line along x with a text such as "+-1 |0 -2": change and x, `|` for inner walls;
 * only what is visible. */
static void check_x(const Shape *shape, int count, const double *x, const int *change)
{
    for (int round = 0; round < 2; round++) {
        CrossList list = list_x(shape);
        int seen = 0;
        for (int i = 0; i < list.count; i++) {
            if (!list.items[i].is_visible)
                continue;
            assert_in_range(seen, 0, count - 1);
            assert_true(fabs(list.items[i].t - 10 - x[seen]) < 1e-7);
            assert_int_equal(list.items[i].change, change[seen]);
            seen++;
        }
        assert_int_equal(seen, count);
        shape_finish(arena, (Shape *)shape);
    }
}

#define CHECK_X(shape, n, xs, changes) check_x(shape, n, (const double[])xs, (const int[])changes)
#define L(...)                                                                                     \
    {                                                                                              \
        __VA_ARGS__                                                                                \
    }

static void test_operators(void **state)
{
    (void)state;
    double r = sqrt(1 - 0.05);
    CHECK_X(csg(SHAPE_UNION, 2, ball(0, 1), ball(1, 1)), 4, L(-r, 1 - r, r, 1 + r), L(1, 0, 0, -1));
    CHECK_X(csg(SHAPE_MERGE, 2, ball(0, 1), ball(1, 1)), 2, L(-r, 1 + r), L(1, -1));
    CHECK_X(csg(SHAPE_INTERSECTION, 2, ball(0, 1), ball(1, 1)), 2, L(1 - r, r), L(1, -1));
    CHECK_X(difference(ball(0, 1), ball(1, 1)), 2, L(-r, 1 - r), L(1, -1));
    CHECK_X(difference(cube(-2, 2), cube(-1, 1)), 4, L(-2, -1, 1, 2), L(1, -1, 1, -1));
    CHECK_X(inverse(csg(SHAPE_UNION, 2, ball(0, 1), ball(1, 1))), 2, L(-r, 1 + r), L(-1, 1));
    CHECK_X(csg(SHAPE_UNION, 0), 0, L(0), L(0));
    CHECK_X(csg(SHAPE_UNION, 1, ball(0, 1)), 2, L(-r, r), L(1, -1));
    Shape *half = csg(SHAPE_INTERSECTION, 2, ball(0, 1), shape_plane(arena, v3(1, 0, 0), 0));
    CHECK_X(half, 2, L(-r, 0), L(1, -1));
    Bound b = shape_bound(half);
    assert_true(b.hi.x < 1e-10 && b.hi.x >= 0);
}

/* The cut face is the cutter's, turned to the outside of what remains. */
static void test_look(void **state)
{
    (void)state;
    Shape *a = ball(0, 1), *b = ball(1, 1), *d = difference(a, b);
    Ray ray = {{10, 0, 0}, {-1, 0, 0}, 0, INFINITY};
    Crossing c;
    ShapePoint p;
    assert_true(shape_closest(d, &ray, scratch, &c));
    assert_ptr_equal(c.leaf, b);
    shape_point(&c, &ray, &p);
    assert_true(fabs(p.p.x) < 1e-12 && p.ng.x > 0.999);
    ray.tmin = c.t;
    assert_true(shape_closest(d, &ray, scratch, &c));
    assert_ptr_equal(c.leaf, a);
    assert_true(c.change == -1 && c.leaf_change == -1);
}

/* Identical and touching faces, exactly and up to rounding: no skin, no wall, no gap. */
static void test_coincident(void **state)
{
    (void)state;
    CHECK_X(difference(cube(-1, 1), cube(-1, 1)), 0, L(0), L(0));
    CHECK_X(difference(ball(0, 1), ball(0, 1)), 0, L(0), L(0));
    CHECK_X(csg(SHAPE_INTERSECTION, 2, cube(-1, 1), cube(-1, 1)), 2, L(-1, 1), L(1, -1));
    CHECK_X(csg(SHAPE_MERGE, 2, cube(-1, 1), cube(-1, 1)), 2, L(-1, 1), L(1, -1));
    CHECK_X(csg(SHAPE_MERGE, 2, cube(-1, 0.3), cube(0.1 + 0.2, 1)), 2, L(-1, 1), L(1, -1));
    CHECK_X(csg(SHAPE_MERGE, 2, cube(-1, 0.1 + 0.2), cube(0.3, 1)), 2, L(-1, 1), L(1, -1));
    CHECK_X(csg(SHAPE_UNION, 2, cube(-1, 0.3), cube(0.1 + 0.2, 1)), 3, L(-1, 0.3, 1), L(1, 0, -1));
    CHECK_X(difference(cube(-1, 1), cube(0.5, 1)), 2, L(-1, 0.5), L(1, -1));
    CHECK_X(difference(cube(-1, 1), cube(1, 2)), 2, L(-1, 1), L(1, -1));
    CHECK_X(difference(csg(SHAPE_MERGE, 2, cube(-1, 0), cube(0, 1)), cube(-1, 0)), 2, L(0, 1),
            L(1, -1));
    CHECK_X(csg(SHAPE_INTERSECTION, 2, cube(-1, 0), cube(0, 1)), 0, L(0), L(0));
}

/* At the wall of two abutting solids nothing is entered or left on the whole. */
static void test_abutting(void **state)
{
    (void)state;
    Shape *a = cube(-1, 0), *b = cube(0, 1);
    CrossList list = list_x(csg(SHAPE_UNION, 2, a, b));
    assert_int_equal(list.count, 3);
    assert_int_equal(list.items[1].leaf_change, 0);
    assert_ptr_equal(list.items[1].leaf, a);
    assert_int_equal(list.items[0].leaf_change, 1);
    assert_int_equal(list.items[2].leaf_change, -1);
    list = list_x(csg(SHAPE_UNION, 2, cube(-1, 0.5), cube(0, 1)));
    assert_int_equal(list.count, 4);
    assert_int_equal(list.items[1].leaf_change, 1);
    assert_int_equal(list.items[2].leaf_change, -1);
}

/* The same, turned: coordinates differ in their last bits, and still no skin is left. */
static void test_coincident_turned(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 200; i++) {
        Rng rng = rng_at(31, 1, i);
        V3 angles = v3(6 * rng_double(&rng), 6 * rng_double(&rng), 6 * rng_double(&rng));
        Xform turn = xform_rotate(angles),
              move = xform_translate(v3_scale(angles, i % 2 ? 1 : 100));
        Xform both = xform_then(&turn, &move);
        /* One is transformed in one step, the other in two. */
        Shape *a = cube(-1, 1), *b = cube(-1, 1), *c = cube(1, 2);
        shape_transform(a, &both);
        shape_transform(b, &turn);
        shape_transform(b, &move);
        shape_transform(c, &turn);
        shape_transform(c, &move);
        Shape *none = difference(shape_copy(arena, a), b);
        Shape *whole = csg(SHAPE_MERGE, 2, a, c);
        for (int k = 0; k < 50; k++) {
            V2 u = {rng_double(&rng), rng_double(&rng)};
            V3 d = warp_sphere(u), at = v3(2 * rng_double(&rng) - 1, 0.5, 0.5 - rng_double(&rng));
            Ray ray = {v3_mad(xform_point(&both, at), -5, d), d, 0, INFINITY};
            CrossList list;
            shape_crossings(none, &ray, scratch, &list);
            assert_int_equal(list.count, 0);
            shape_crossings(whole, &ray, scratch, &list);
            assert_int_equal(list.count, 2);
        }
    }
}

static void test_clip(void **state)
{
    (void)state;
    double r = sqrt(1 - 0.05);
    /* Clipped: no cap is seen, but the solid ends there. */
    Shape *s = clipped(ball(0, 1), cube(-0.5, 5));
    CHECK_X(s, 1, L(r), L(-1));
    assert_int_equal(list_x(s).count, 2);
    assert_true(shape_is_inside(s, v3(0.1, 0, 0)));
    assert_false(shape_is_inside(s, v3(-0.7, 0, 0)));
    CHECK_X(clipped(ball(0, 1), inverse(cube(-0.5, 0.5))), 2, L(-r, r), L(1, -1));
    /* A clipped child in a difference. */
    Shape *d = difference(cube(-2, 2), clipped(ball(0, 1), cube(0, 5)));
    assert_false(shape_is_inside(d, v3(0.5, 0, 0)));
    /* A union clipped as a whole. */
    Shape *u = clipped(csg(SHAPE_UNION, 2, ball(0, 1), ball(1, 1)), cube(-5, 0.5));
    CHECK_X(u, 2, L(-r, 1 - r), L(1, 0));
}

/* Sheets: triangles in CSG follow the language's rules. */
static void test_sheets(void **state)
{
    (void)state;
    V3 corner[3] = {{0, -5, -5}, {0, 5, -5}, {0, 0, 9}};
    Shape *t = shape_triangle(arena, corner, NULL);
    double r = sqrt(1 - 0.05);
    CHECK_X(csg(SHAPE_UNION, 2, ball(0, 1), shape_copy(arena, t)), 3, L(-r, 0, r), L(1, 0, -1));
    CHECK_X(csg(SHAPE_MERGE, 2, ball(0, 1), shape_copy(arena, t)), 2, L(-r, r), L(1, -1));
    CHECK_X(csg(SHAPE_INTERSECTION, 2, ball(0, 1), shape_copy(arena, t)), 1, L(0), L(0));
    CHECK_X(difference(ball(0, 1), shape_copy(arena, t)), 3, L(-r, 0, r), L(1, 0, -1));
    CHECK_X(csg(SHAPE_INTERSECTION, 2, ball(5, 1), shape_copy(arena, t)), 0, L(0), L(0));
    assert_false(shape_is_solid(t));
}

/* Discs and open cones bound their solids unseen. */
static void test_unseen(void **state)
{
    (void)state;
    double r = sqrt(1 - 0.05);
    Shape *half =
        csg(SHAPE_INTERSECTION, 2, ball(0, 1), shape_disc(arena, v3(0, 0, 0), v3(1, 0, 0), 0.1, 0));
    CHECK_X(half, 1, L(-r), L(1)); /* the line passes outside of the disc */
    assert_int_equal(list_x(half).count, 2);
    half =
        csg(SHAPE_INTERSECTION, 2, ball(0, 1), shape_disc(arena, v3(0, 0, 0), v3(1, 0, 0), 0.5, 0));
    CHECK_X(half, 2, L(-r, 0), L(1, -1));
    Shape *tube = shape_cone(arena, v3(-1, 0, 0), 0.5, v3(1, 0, 0), 0.5, true);
    CHECK_X(difference(cube(-2, 2), tube), 2, L(-2, 2), L(1, -1));
}

/* A thick plate with many holes: as many crossings as there should be, and only those. */
static void test_many_children(void **state)
{
    (void)state;
    enum { HOLES = 500 };
    Shape **children = ARENA_ARRAY(arena, Shape *, HOLES + 1);
    children[0] = box(v3(-1, -1, -1), v3(HOLES + 1, 1, 1));
    for (int i = 0; i < HOLES; i++)
        children[i + 1] = inverse(ball(i + 0.5, 0.25));
    Shape *d = shape_csg(arena, SHAPE_INTERSECTION, children, HOLES + 1);
    assert_int_equal(list_x(d).count, 2 + 2 * HOLES);
    shape_finish(arena, d);
    assert_int_equal(list_x(d).count, 2 + 2 * HOLES);
    Ray ray = {{7.5, 5, 0}, {0, -1, 0}, 0, INFINITY};
    CrossList list;
    shape_crossings(d, &ray, scratch, &list);
    assert_int_equal(list.count, 4);
    assert_ptr_equal(list.items[1].leaf, children[8]);
    for (int i = 1; i < list.count; i++)
        assert_true(list.items[i].t >= list.items[i - 1].t);
}

/* More crossings than a list holds: some are dropped, and it says so. */
static void test_overflow(void **state)
{
    (void)state;
    int count = CROSSINGS_MAX / 2 + 10;
    Shape **children = ARENA_ARRAY(arena, Shape *, (size_t)count);
    for (int i = 0; i < count; i++)
        children[i] = ball(i, 0.3);
    Shape *u = shape_csg(arena, SHAPE_UNION, children, count);
    Ray ray = {{-10, 0.1, 0.2}, {1, 0, 0}, 0, INFINITY};
    CrossList list;
    shape_crossings(u, &ray, scratch, &list);
    assert_true(list.is_overflown);
    Crossing c;
    assert_true(shape_closest(u, &ray, scratch, &c));
    assert_true(fabs(c.t - (10 - 0.2)) < 0.01);
}

static Shape *random_leaf(Rng *rng)
{
    double a = 0.3 + rng_double(rng), x = 2 * rng_double(rng) - 1, y = 2 * rng_double(rng) - 1;
    V3 p = v3(x, y, a - 1), q = v3(y + 0.3, x - 0.6, 1.3 - a);
    switch (rng_u32(rng) % 6) {
    case 0:
        return shape_sphere(arena, p, a);
    case 1:
        return shape_box(arena, p, v3(-y - 0.1, -x + 0.2, a));
    case 2:
        return shape_cone(arena, p, a, q, 0.4, rng_u32(rng) % 2);
    case 3:
        return shape_plane(arena, v3(x, y, a), 0.5 * x);
    case 4:
        return shape_disc(arena, p, q, a, 0.3 * a);
    default: {
        Shape *torus = shape_torus(arena, a, 0.5 * a);
        Xform turn = xform_rotate(v3(x, y, 1)), move = xform_translate(p);
        shape_transform(torus, &turn);
        shape_transform(torus, &move);
        return torus;
    }
    }
}

static Shape *random_tree(Rng *rng, int depth)
{
    Shape *shape;
    if (depth == 0 || rng_u32(rng) % 5 == 0) {
        shape = random_leaf(rng);
    } else {
        int count = 2 + (int)(rng_u32(rng) % 3);
        Shape **children = ARENA_ARRAY(arena, Shape *, (size_t)count);
        for (int i = 0; i < count; i++)
            children[i] = random_tree(rng, depth - 1);
        static const ShapeKind kinds[3] = {SHAPE_UNION, SHAPE_MERGE, SHAPE_INTERSECTION};
        shape = shape_csg(arena, kinds[rng_u32(rng) % 3], children, count);
    }
    if (rng_u32(rng) % 4 == 0)
        shape_invert(shape);
    if (rng_u32(rng) % 6 == 0)
        clipped(shape, random_leaf(rng));
    return shape;
}

/* Walk one list: its state between crossings is that of the points there. */
static void check_walk(const Shape *shape, const Ray *ray, const CrossList *list)
{
    int inside = list->is_inside_before;
    double last = -50;
    for (int k = 0; k <= list->count; k++) {
        double t = k < list->count ? list->items[k].t : 50;
        assert_true(t >= last || k == 0 || k == list->count);
        if (t - last > 1e-6)
            assert_int_equal(shape_is_inside(shape, ray_at(ray, 0.5 * (t + last))), inside);
        if (k < list->count)
            inside += list->items[k].change;
        assert_in_range(inside, 0, 1);
        last = t;
    }
}

/* The search along a part of the line finds what the whole list has there. */
static void check_closest(const Shape *shape, Ray ray, const CrossList *list, Rng *rng)
{
    Crossing found;
    ShapeScratch *other = shape_scratch_new();
    ray.tmin = 4 * rng_double(rng) - 1;
    ray.tmax = rng_u32(rng) % 2 ? INFINITY : ray.tmin + 3 * rng_double(rng);
    int first = 0;
    while (first < list->count &&
           !(list->items[first].is_visible && list->items[first].t > ray.tmin))
        first++;
    bool is_hit = first < list->count && list->items[first].t < ray.tmax;
    assert_int_equal(shape_closest(shape, &ray, other, &found), is_hit);
    if (is_hit) {
        assert_true(found.t == list->items[first].t);
        assert_ptr_equal(found.leaf, list->items[first].leaf);
        assert_int_equal(found.change, list->items[first].change);
    }
    shape_scratch_free(other);
}

/* Random trees: the list agrees with membership, with and without the derived bounds, and
 * what is seen lies in the box. */
static void test_random_trees(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 3000; i++) {
        Rng rng = rng_at(33, 1, i);
        Shape *plain = random_tree(&rng, 3), *fast = shape_copy(arena, plain);
        shape_finish(arena, fast);
        Bound box = shape_bound(fast);
        for (int k = 0; k < 20; k++) {
            V2 u = {rng_double(&rng), rng_double(&rng)}, w = {rng_double(&rng), rng_double(&rng)};
            Ray ray = {v3_scale(warp_sphere(w), 3), warp_sphere(u), 0, INFINITY};
            CrossList a, b;
            ShapeScratch *other = shape_scratch_new();
            shape_crossings(plain, &ray, scratch, &a);
            shape_crossings(fast, &ray, other, &b);
            assert_int_equal(a.count, b.count);
            assert_int_equal(a.is_inside_before, b.is_inside_before);
            for (int n = 0; n < a.count; n++) {
                assert_true(a.items[n].t == b.items[n].t);
                assert_int_equal(a.items[n].is_visible, b.items[n].is_visible);
                V3 p = ray_at(&ray, a.items[n].t);
                if (a.items[n].is_visible && v3_max_abs(p) < 1e3)
                    assert_true(p.x > box.lo.x - 1e-9 && p.x < box.hi.x + 1e-9 &&
                                p.y > box.lo.y - 1e-9 && p.y < box.hi.y + 1e-9 &&
                                p.z > box.lo.z - 1e-9 && p.z < box.hi.z + 1e-9);
            }
            check_walk(plain, &ray, &a);
            check_walk(fast, &ray, &b);
            check_closest(fast, ray, &b, &rng);
            shape_scratch_free(other);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_operators),
        cmocka_unit_test(test_look),
        cmocka_unit_test(test_coincident),
        cmocka_unit_test(test_abutting),
        cmocka_unit_test(test_coincident_turned),
        cmocka_unit_test(test_clip),
        cmocka_unit_test(test_sheets),
        cmocka_unit_test(test_unseen),
        cmocka_unit_test(test_many_children),
        cmocka_unit_test(test_overflow),
        cmocka_unit_test(test_random_trees),
    };
    return cmocka_run_group_tests_name("csg", tests, set_up, tear_down);
}
