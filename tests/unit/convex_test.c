/* The convex core of an intersection says what the merging of lists says.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/rng.h"
#include "math/sample.h"
#include "shape/shape.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

enum { CHILDREN_MAX = 12, SOLIDS = 200, RAYS = 300 };

static V3 random_direction(Rng *rng)
{
    return warp_sphere((V2){rng_double(rng), rng_double(rng)});
}

/* A convex leaf around the origin, or now and then something hollow or cut out. */
static Shape *random_child(Arena *arena, Rng *rng)
{
    V3 d = random_direction(rng);
    switch (rng_u32(rng) % 7) {
    case 0:
        return shape_sphere(arena, v3_scale(d, 0.5), 1.2);
    case 1:
        return shape_box(arena, v3(-1, -1, -1), v3(1, 0.5, 1));
    case 2:
        return shape_cone(arena, v3_scale(d, -1), 1, d, 0.3, false);
    case 3: {
        Shape *hole = shape_sphere(arena, d, 0.7);
        shape_invert(hole);
        return hole;
    }
    case 4: {
        Shape *half = shape_plane(arena, d, -0.6);
        shape_invert(half);
        return half;
    }
    default:
        return shape_plane(arena, d, 0.6);
    }
}

static Shape *random_solid(Arena *arena, Rng *rng)
{
    int count = 2 + (int)(rng_u32(rng) % (CHILDREN_MAX - 1));
    Shape **children = ARENA_ARRAY(arena, Shape *, CHILDREN_MAX);
    for (int i = 0; i < count; i++)
        /* The same child twice coincides with itself. */
        children[i] = i > 1 && rng_u32(rng) % 4 == 0 ? shape_copy(arena, children[i - 1])
                                                     : random_child(arena, rng);
    for (int i = 0; i < count; i++)
        children[i]->surface = (uint32_t)i;
    return shape_csg(arena, SHAPE_INTERSECTION, children, count);
}

static void assert_same(const CrossList *a, const CrossList *b)
{
    assert_int_equal(a->count, b->count);
    assert_int_equal(a->is_inside_before, b->is_inside_before);
    for (int i = 0; i < a->count; i++) {
        const Crossing *p = &a->items[i], *q = &b->items[i];
        assert_true(p->t == q->t && p->leaf->surface == q->leaf->surface);
        assert_true(p->change == q->change && p->is_visible == q->is_visible &&
                    p->is_flipped == q->is_flipped && p->part == q->part);
    }
}

static void test_core_is_merge(void **state)
{
    (void)state;
    Arena *arena = arena_new();
    ShapeScratch *one = shape_scratch_new(), *two = shape_scratch_new();
    Rng rng = rng_at(11, 0, 0);
    int seen = 0;
    for (int n = 0; n < SOLIDS; n++) {
        Shape *plain = random_solid(arena, &rng), *finished = shape_copy(arena, plain);
        shape_finish(arena, finished);
        for (int i = 0; i < RAYS; i++) {
            V3 from = v3_scale(random_direction(&rng), 5), to = random_direction(&rng);
            Ray ray = {from, v3_unit(v3_sub(to, from)), 0, INFINITY};
            CrossList a, b;
            shape_crossings(plain, &ray, one, &a);
            shape_crossings(finished, &ray, two, &b);
            assert_same(&a, &b);
            seen += a.count > 0;
        }
    }
    assert_true(seen > SOLIDS * RAYS / 20);
    shape_scratch_free(one);
    shape_scratch_free(two);
    arena_free(arena);
}

/* A ball hewn by many planes, some twice, some far off, from in and outside. */
static void test_many_planes(void **state)
{
    (void)state;
    Arena *arena = arena_new();
    ShapeScratch *one = shape_scratch_new(), *two = shape_scratch_new();
    Rng rng = rng_at(11, 1, 0);
    enum { PLANES = 900, TURNS = 30 };
    int seen = 0;
    for (int n = 0; n < TURNS; n++) {
        Shape **children = ARENA_ARRAY(arena, Shape *, PLANES);
        int count = 100 + (int)(rng_u32(&rng) % (PLANES - 100));
        for (int i = 0; i < count; i++) {
            V3 d = random_direction(&rng);
            double distance = i % 9 == 0 ? 0.7 : i % 9 == 1 ? 3 : 0.6 + 0.2 * rng_double(&rng);
            children[i] = i % 5 == 4   ? shape_copy(arena, children[i - 3])
                          : i % 3 == 0 ? shape_plane(arena, v3_neg(d), -distance)
                                       : shape_plane(arena, d, distance);
            if (i % 5 != 4 && i % 3 == 0)
                shape_invert(children[i]);
            children[i]->surface = (uint32_t)i;
        }
        Shape *plain = shape_csg(arena, SHAPE_INTERSECTION, children, count);
        Shape *finished = shape_copy(arena, plain);
        shape_finish(arena, finished);
        for (int i = 0; i < RAYS; i++) {
            V3 from = v3_scale(random_direction(&rng), i % 4 ? 3 : 0.3);
            V3 to = v3_scale(random_direction(&rng), 0.8);
            Ray ray = {from, v3_unit(v3_sub(to, from)), 0, INFINITY};
            CrossList a, b;
            shape_crossings(plain, &ray, one, &a);
            shape_crossings(finished, &ray, two, &b);
            assert_same(&a, &b);
            Crossing first;
            bool is_hit = a.count > 0 && a.items[a.count - 1].t > 0;
            assert_int_equal(shape_closest(finished, &ray, two, &first), is_hit);
            if (is_hit)
                assert_true(first.t == a.items[a.items[0].t > 0 ? 0 : 1].t);
            seen += is_hit;
        }
    }
    assert_true(seen > TURNS * RAYS / 2);
    shape_scratch_free(one);
    shape_scratch_free(two);
    arena_free(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_core_is_merge),
                                       cmocka_unit_test(test_many_planes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
