/* Bicubic patches: measured values, flatness, and edges that fit.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/patch.h"

#include "base/rng.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include <string.h>

#include "shape_kit.h"

static const V2 square[4] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};

/* Rows z = 0..3, columns x = 0..3, the inner four points at y = 3. */
static Patch bump(int steps, double flatness)
{
    Patch patch = {.flatness = flatness, .u_steps = steps, .v_steps = steps};
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            patch.point[i][j] = v3(j, i % 3 && j % 3 ? 3 : 0, i);
    memcpy(patch.uv, square, sizeof square);
    return patch;
}

static MeshData cut(const Patch *patch, int *rows, int *columns)
{
    MeshData mesh;
    int u, v;
    assert_true(patch_halvings(patch, &u, &v));
    assert_true(patch_mesh(arena, patch, u, v, &mesh));
    *rows = 1 << u, *columns = 1 << v;
    return mesh;
}

static void trace_down(const Patch *patch, double x, double z, V3 *p, V3 *n, V2 *uv)
{
    Diag diag;
    diag_init(&diag, diag_drop, NULL);
    int rows, columns;
    MeshData mesh = cut(patch, &rows, &columns);
    assert_int_equal(mesh_index(&diag, &mesh, 1), OK);
    Shape *shape = shape_mesh(arena, &mesh);
    Ray ray = {v3(x, 5, z), v3(0, -1, 0), 0, INFINITY};
    Crossing c;
    assert_true(shape_closest(shape, &ray, scratch, &c));
    ShapePoint point;
    shape_point(&c, &ray, &point);
    *p = point.p;
    *n = point.ns;
    *uv = shape_uv(shape, c.part, c.u, c.v, point.p);
    mesh_done(&mesh);
    diag_done(&diag);
}

static void check(int steps, double flatness, double x, double z, double y, V3 normal)
{
    Patch patch = bump(steps, flatness);
    V3 p, n;
    V2 uv;
    trace_down(&patch, x, z, &p, &n, &uv);
    assert_true(fabs(p.y - y) < 2e-6);
    assert_true(v3_dist(n, v3_unit(normal)) < 2e-6);
    /* The bump is as wide as its points, so that uv is the place. */
    assert_true(fabs(uv.u - x / 3) < 1e-9 && fabs(uv.v - z / 3) < 1e-9);
}

static void test_measured_values(void **state)
{
    (void)state;
    check(3, .01, 1.5, 1.5, 1.6875, v3(0, 1, 0));
    check(0, 0, 1.1, .7, 0, v3(0, 1, 0));
    check(1, 0, 1.1, .7, .7875, v3(0, .960549, -.278112));
    check(5, .0, 1.1, .7, 1.119679, v3(-.274887, .643015, -.714820));
}

static void test_flatness_saves_triangles(void **state)
{
    (void)state;
    for (int i = 1; i < 6; i++) {
        Patch patch = bump(9, ldexp(1, -2 * i));
        int rows, columns;
        MeshData mesh = cut(&patch, &rows, &columns);
        double worst = 0;
        assert_true(rows < 512);
        for (uint32_t t = 0; t < mesh.triangle_count; t++) {
            /* The middle of a triangle against the surface: y = 27 u(1-u) v(1-v). */
            const uint32_t *c = mesh.corners + 3 * t;
            V3 m = v3_scale(
                v3_add(v3_add(mesh.vertices[c[0]], mesh.vertices[c[1]]), mesh.vertices[c[2]]),
                1 / 3.);
            double u = m.x / 3, v = m.z / 3;
            double off = m.y - 27 * u * (1 - u) * v * (1 - v);
            worst = fmax(worst, fabs(off) / patch.flatness);
        }
        assert_true(worst < 2);
    }
}

static void test_too_many_cells_are_refused(void **state)
{
    (void)state;
    int u, v;
    Patch patch = bump(11, 0);
    assert_false(patch_halvings(&patch, &u, &v));
    patch = bump(1000, 1e-30);
    assert_false(patch_halvings(&patch, &u, &v));
    patch = bump(1000, 1e-3);
    assert_true(patch_halvings(&patch, &u, &v));
}

static void test_a_patch_without_area_has_no_triangle(void **state)
{
    (void)state;
    Patch patch = bump(3, 0);
    for (int i = 0; i < 16; i++)
        patch.point[i / 4][i % 4] = v3(1, 2, 3);
    int rows, columns;
    assert_int_equal(cut(&patch, &rows, &columns).triangle_count, 0);
}

static V3 corner_of(const MeshData *mesh, int i, int j, int columns)
{
    return mesh->vertices[i * (columns + 1) + j];
}

/* Return how far a corner of one edge is from the chords of the other. */
static double off_chords(V3 p, const MeshData *mesh, int rows, int columns, int j)
{
    double best = INFINITY;
    for (int i = 0; i < rows; i++) {
        V3 a = corner_of(mesh, i, j, columns), ab = v3_sub(corner_of(mesh, i + 1, j, columns), a);
        double t = fmin(1, fmax(0, v3_dot(v3_sub(p, a), ab) / v3_len2(ab)));
        best = fmin(best, v3_dist(p, v3_mad(a, t, ab)));
    }
    return best;
}

/* A patch of any form, and another that has its edge v = 1, run backwards, as its own v = 0. */
static void test_edges_fit(void **state)
{
    (void)state;
    int different = 0;
    for (uint64_t round = 0; round < 60; round++) {
        Rng rng = rng_at(11, 1, round);
        Patch one = bump(4, round % 4 ? .3 / (double)(1 + round % 7) : 0), two = one;
        for (int i = 0; i < 16; i++) {
            V3 off = v3_scale(random_dir(&rng), .4), more = v3_scale(random_dir(&rng), .4);
            one.point[i / 4][i % 4] = v3_add(one.point[i / 4][i % 4], off);
            two.point[i / 4][i % 4] = v3_mad(v3_scale(two.point[i / 4][i % 4], .3), 1, more);
        }
        for (int i = 0; i < 4; i++)
            two.point[i][0] = one.point[3 - i][3];
        int rows[2], columns[2];
        MeshData a = cut(&one, &rows[0], &columns[0]), b = cut(&two, &rows[1], &columns[1]);
        different += rows[0] != rows[1];
        for (int i = 0; i <= rows[0]; i++) {
            V3 p = corner_of(&a, i, columns[0], columns[0]);
            V3 q = corner_of(&b, rows[1] - (i < rows[1] ? i : rows[1]), 0, columns[1]);
            assert_true(off_chords(p, &b, rows[1], columns[1], 0) < 1e-14);
            assert_true(rows[0] != rows[1] || memcmp(&p, &q, sizeof p) == 0);
        }
        for (int i = 0; i <= rows[1]; i++)
            assert_true(off_chords(corner_of(&b, i, 0, columns[1]), &a, rows[0], columns[0],
                                   columns[0]) < 1e-14);
    }
    assert_true(different > 5);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_measured_values, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_flatness_saves_triangles, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_too_many_cells_are_refused, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_a_patch_without_area_has_no_triangle, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(test_edges_fit, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
