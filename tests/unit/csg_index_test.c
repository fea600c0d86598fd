/* Nodes with many children, and nodes within nodes: the index changes no answer.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape.h"

#include <float.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>

#include "shape_kit.h"

static double range(Rng *rng, double lo, double hi)
{
    return lo + (hi - lo) * rng_double(rng);
}

static V3 random_point(Rng *rng)
{
    double x = range(rng, -2, 2), y = range(rng, -2, 2);
    return v3(x, y, range(rng, -2, 2));
}

static Shape *small_leaf(Rng *rng)
{
    V3 p = random_point(rng);
    double a = range(rng, 0.05, 0.3);
    switch (rng_u32(rng) % 4) {
    case 0:
        return shape_box(arena, p, v3_add(p, v3(a, 0.5 * a, 2 * a)));
    case 1:
        return shape_cone(arena, p, a, v3_add(p, v3(a, a, 2 * a)), 0.1, rng_u32(rng) % 2);
    default:
        return shape_sphere(arena, p, a);
    }
}

static Shape *node_of(ShapeKind kind, Shape **list, int count)
{
    Shape **children = ARENA_ARRAY(arena, Shape *, (size_t)count);
    memcpy(children, list, (size_t)count * sizeof *children);
    return shape_csg(arena, kind, children, count);
}

enum { MANY = 400 };

/* A node with many children; some are pairs, some endless, some inside out. */
static Shape *random_node(Rng *rng, ShapeKind kind)
{
    Shape *list[MANY];
    int count = 10 + (int)(rng_u32(rng) % (MANY - 10));
    bool is_cutting = kind == SHAPE_INTERSECTION;
    for (int i = 0; i < count; i++) {
        Shape *two[2] = {small_leaf(rng), small_leaf(rng)};
        uint32_t what = rng_u32(rng) % 20;
        list[i] = what == 0   ? node_of(SHAPE_UNION, two, 2)
                  : what == 1 ? node_of(SHAPE_MERGE, two, 2)
                              : two[0];
        if (is_cutting || what == 2)
            shape_invert(list[i]);
    }
    if (is_cutting)
        list[rng_u32(rng) % 3] = shape_sphere(arena, v3(0, 0, 0), 2);
    if (rng_u32(rng) % 3 == 0)
        list[count - 1] = shape_plane(arena, v3(0, 1, 0), is_cutting ? 1 : -2);
    return node_of(kind, list, count);
}

static Ray random_ray(Rng *rng)
{
    V3 from = v3_scale(random_dir(rng), range(rng, 0, 5));
    return (Ray){from, v3_unit(v3_sub(random_point(rng), from)), 0, INFINITY};
}

static void check_ray(const Shape *plain, const Shape *fast, ShapeScratch *other, Ray ray, Rng *rng)
{
    CrossList a, b;
    shape_crossings(plain, &ray, scratch, &a);
    shape_crossings(fast, &ray, other, &b);
    assert_int_equal(a.count, b.count);
    assert_int_equal(a.is_inside_before, b.is_inside_before);
    ray.tmin = range(rng, -1, 4);
    ray.tmax = rng_u32(rng) % 2 ? INFINITY : ray.tmin + range(rng, 0, 4);
    const Crossing *first = NULL;
    for (int i = 0; i < a.count; i++) {
        const Crossing *c = &a.items[i];
        assert_true(c->t == b.items[i].t && c->change == b.items[i].change &&
                    c->leaf_change == b.items[i].leaf_change &&
                    c->is_flipped == b.items[i].is_flipped);
        if (!first && c->is_visible && c->t > ray.tmin)
            first = c;
    }
    Crossing found, expected = first ? *first : (Crossing){.t = INFINITY};
    bool is_hit = shape_closest(fast, &ray, other, &found);
    assert_int_equal(is_hit, expected.t < ray.tmax);
    if (is_hit)
        assert_true(found.t == expected.t && found.change == expected.change &&
                    found.leaf->kind == expected.leaf->kind);
}

static void check_node(Shape *plain, Rng *rng, int rays)
{
    Shape *fast = shape_copy(arena, plain);
    ShapeScratch *other = shape_scratch_new();
    shape_finish(arena, fast);
    for (int k = 0; k < rays; k++)
        check_ray(plain, fast, other, random_ray(rng), rng);
    for (int k = 0; k < 10 * rays; k++) {
        V3 p = random_point(rng);
        assert_int_equal(shape_is_inside(plain, p), shape_is_inside(fast, p));
    }
    shape_scratch_free(other);
}

static void test_many(void **state)
{
    (void)state;
    static const ShapeKind kinds[3] = {SHAPE_UNION, SHAPE_MERGE, SHAPE_INTERSECTION};
    for (uint32_t i = 0; i < 60; i++) {
        Rng rng = rng_at(35, 1, i);
        Shape *node = random_node(&rng, kinds[i % 3]);
        if (i % 7 == 0)
            shape_invert(node);
        check_node(node, &rng, 200);
    }
}

/* Children in one place, or in a row: no split tells them apart. */
static void test_piles(void **state)
{
    (void)state;
    Rng rng = rng_at(35, 2, 0);
    Shape *pile[100], *row[100];
    for (int i = 0; i < 100; i++) {
        pile[i] = shape_sphere(arena, v3(0, 0, 0), 0.5 + (i % 3) * 0.1);
        row[i] = shape_sphere(arena, v3(ldexp(1, -i), 0, 0), ldexp(1, -i - 2));
    }
    check_node(node_of(SHAPE_MERGE, pile, 100), &rng, 200);
    check_node(node_of(SHAPE_UNION, row, 100), &rng, 200);
}

/* Blocks side by side: no wall between them, wherever the index cuts. */
static void test_flush(void **state)
{
    (void)state;
    Shape *blocks[64];
    for (int i = 0; i < 64; i++) {
        double x = i / 10.0 - 3;
        blocks[i] = shape_box(arena, v3(x, -1, -1), v3(x + 0.1, 1, 1));
    }
    Shape *bar = node_of(SHAPE_MERGE, blocks, 64);
    shape_finish(arena, bar);
    for (uint32_t i = 0; i < 500; i++) {
        Rng rng = rng_at(35, 3, i);
        V3 from = v3(-10, range(&rng, -0.9, 0.9), range(&rng, -0.9, 0.9));
        V3 to = v3(10, range(&rng, -0.9, 0.9), range(&rng, -0.9, 0.9));
        Ray ray = {from, v3_unit(v3_sub(to, from)), 0, INFINITY};
        CrossList list;
        Crossing found;
        shape_crossings(bar, &ray, scratch, &list);
        assert_int_equal(list.count, 2);
        ray.tmin = list.items[0].t;
        double end = list.items[1].t;
        assert_true(shape_closest(bar, &ray, scratch, &found));
        assert_true(found.t == end);
    }
}

/* A solid cut again and again, each time by a difference around the one before. */
static void test_deep(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 6; i++) {
        Rng rng = rng_at(35, 4, i);
        Shape *solid = shape_box(arena, v3(-1, -1, -1), v3(1, 1, 1));
        for (int k = 0; k < 150; k++) {
            Shape *two[2] = {solid, small_leaf(&rng)};
            bool is_cut = rng_u32(&rng) % 3 > 0;
            if (is_cut)
                shape_invert(two[1]);
            solid = node_of(is_cut  ? SHAPE_INTERSECTION
                            : i % 2 ? SHAPE_UNION
                                    : SHAPE_MERGE,
                            two, 2);
        }
        check_node(solid, &rng, 200);
    }
}

enum { HEAP = 20000 };

/* A heap of spheres with one point in all: along a line out of it nearly all that there is waits at
 * once.  With work that grew with the square of the count, this would not end. */
static void test_heap(void **state)
{
    (void)state;
    Rng rng = rng_at(35, 5, 0);
    Shape **heap = ARENA_ARRAY(arena, Shape *, HEAP + 1);
    for (int i = 0; i < HEAP; i++)
        heap[i] = shape_sphere(arena, v3_scale(random_dir(&rng), 0.1), 1 + i * 1e-5);
    check_node(node_of(SHAPE_MERGE, heap, HEAP), &rng, 20);
    check_node(node_of(SHAPE_UNION, heap, HEAP), &rng, 20);
    for (int i = 0; i < HEAP; i++)
        shape_invert(heap[i]);
    heap[HEAP] = shape_box(arena, v3(-2, -2, -2), v3(2, 2, 2));
    check_node(node_of(SHAPE_INTERSECTION, heap, HEAP + 1), &rng, 20);
}

/* Entered one after the other, all left at one end: those that wait grow while others are ready. */
static void test_sheaf(void **state)
{
    (void)state;
    Rng rng = rng_at(35, 6, 0);
    Shape **sheaf = ARENA_ARRAY(arena, Shape *, HEAP);
    for (int i = 0; i < HEAP; i++)
        sheaf[i] = shape_box(arena, v3(i * 1e-4, -1, -1), v3(4 + i * 1e-6, 1, 1));
    Shape *plain = node_of(SHAPE_MERGE, sheaf, HEAP), *fast = shape_copy(arena, plain);
    ShapeScratch *other = shape_scratch_new();
    shape_finish(arena, fast);
    for (int k = 0; k < 10; k++) {
        V3 from = v3(-1, range(&rng, -0.5, 0.5), range(&rng, -0.5, 0.5));
        V3 to = v3(5, range(&rng, -0.5, 0.5), range(&rng, -0.5, 0.5));
        Ray ray = {from, v3_unit(v3_sub(to, from)), 1.5, INFINITY};
        CrossList list;
        Crossing found;
        shape_crossings(plain, &ray, scratch, &list);
        assert_int_equal(list.count, 2);
        assert_true(shape_closest(fast, &ray, other, &found));
        assert_true(found.t == list.items[1].t);
    }
    shape_scratch_free(other);
}

/* Boxes so big and flat that their areas are no numbers. */
static void test_areas(void **state)
{
    (void)state;
    Shape *slabs[20];
    for (int i = 0; i < 20; i++)
        slabs[i] = shape_box(arena, v3(-DBL_MAX / 2, 0, -1), v3(DBL_MAX / 2, 0, 1));
    Shape *node = node_of(SHAPE_UNION, slabs, 20);
    shape_finish(arena, node);
    Ray ray = {v3(0.1, 1, 0.2), v3(0, -1, 0), 0, INFINITY};
    Crossing found;
    assert_true(shape_closest(node, &ray, scratch, &found));
    assert_true(found.t == 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_many),  cmocka_unit_test(test_piles), cmocka_unit_test(test_flush),
        cmocka_unit_test(test_deep),  cmocka_unit_test(test_heap),  cmocka_unit_test(test_sheaf),
        cmocka_unit_test(test_areas),
    };
    return cmocka_run_group_tests_name("csg_index", tests, set_up, tear_down);
}
