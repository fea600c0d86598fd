/* Shapes and ray indices when memory runs out: an error or a list marked as overflown, never a
 * crash or a leak.  SPDX-License-Identifier: Apache-2.0 */
#include "shape/mesh.h"

#include "base/mem.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <float.h>
#include <cmocka.h>

static void no_sink(void *ctx, const char *text)
{
    (void)ctx, (void)text;
}

/* Fail the first, second, ... allocation until the call succeeds. */
static void test_box_index(void **state)
{
    (void)state;
    Diag diag;
    diag_init(&diag, no_sink, NULL);
    Bound boxes[20];
    for (int i = 0; i < 20; i++)
        boxes[i] = (Bound){{i, 0, 0}, {i + 0.5, 1, 1}};
    int failures = 0;
    for (long n = 1; n < 20; n++) {
        BoxIndex *index;
        mem_fail_from(n);
        Status status = box_index_new(&diag, boxes, 20, 1, &index);
        mem_fail_from(0);
        if (status == OK) {
            box_index_free(index);
            break;
        }
        failures++;
        assert_int_equal(status, ERR_MEMORY);
        assert_null(index);
    }
    assert_in_range(failures, 1, 10);
    diag_done(&diag);
}

static void test_tri_index(void **state)
{
    (void)state;
    Diag diag;
    diag_init(&diag, no_sink, NULL);
    V3 vertices[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    uint32_t corners[3] = {0, 1, 2};
    TriIndex *index;
    mem_fail_from(1);
    assert_int_equal(tri_index_new(&diag, vertices, 3, corners, 1, 1, &index), ERR_MEMORY);
    mem_fail_from(0);
    assert_null(index);
    diag_done(&diag);
}

/* A list that cannot grow says that it lost crossings. */
static void test_crossings(void **state)
{
    (void)state;
    Arena *arena = arena_new();
    Shape *children[3];
    for (int i = 0; i < 3; i++)
        children[i] = shape_sphere(arena, v3(3 * i, 0, 0), 1);
    Shape *shape = shape_csg(arena, SHAPE_UNION, children, 3);
    Ray ray = {{-9, 0, 0}, {1, 0, 0}, 0, INFINITY};
    for (long n = 1; n < 5; n++) {
        ShapeScratch *scratch = shape_scratch_new();
        CrossList list;
        mem_fail_from(n);
        shape_crossings(shape, &ray, scratch, &list);
        mem_fail_from(0);
        assert_int_equal(list.is_overflown, n <= 2);
        if (n > 2)
            assert_int_equal(list.count, 6);
        shape_crossings(shape, &ray, scratch, &list);
        assert_int_equal(list.count, 6);
        assert_false(list.is_overflown);
        shape_scratch_free(scratch);
    }
    /* Without memory shape_finish only loses speed. */
    mem_fail_from(1);
    shape_finish(arena, shape);
    assert_null(shape_scratch_new());
    mem_fail_from(0);
    ShapeScratch *scratch = shape_scratch_new();
    Crossing crossing;
    assert_true(shape_closest(shape, &ray, scratch, &crossing));
    assert_true(crossing.t == 8);
    shape_scratch_free(scratch);
    arena_free(arena);
}

/* Embree leaves the processor's treatment of tiny numbers as it is. */
static void test_denormals(void **state)
{
    (void)state;
    Diag diag;
    diag_init(&diag, no_sink, NULL);
    Bound boxes[20];
    for (int i = 0; i < 20; i++)
        boxes[i] = (Bound){{i, 0, 0}, {i + 0.5, 1, 1}};
    BoxIndex *index;
    assert_int_equal(box_index_new(&diag, boxes, 20, 1, &index), OK);
    volatile double tiny = DBL_MIN;
    assert_true(tiny / 4 > 0);
    box_index_free(index);
    diag_done(&diag);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_box_index),
        cmocka_unit_test(test_tri_index),
        cmocka_unit_test(test_crossings),
        cmocka_unit_test(test_denormals),
    };
    return cmocka_run_group_tests_name("shape_fault", tests, NULL, NULL);
}
