/* Meshes as shapes: solids and sheets, smooth normals, uv, instances, CSG.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/mesh.h"

#include "base/rng.h"
#include "math/sample.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <cmocka.h>

static Arena *arena;
static ShapeScratch *scratch;
static Diag diag;

static void no_sink(void *ctx, const char *text)
{
    (void)ctx, (void)text;
}

static int set_up(void **state)
{
    (void)state;
    arena = arena_new();
    scratch = shape_scratch_new();
    diag_init(&diag, no_sink, NULL);
    return !arena || !scratch;
}

static int tear_down(void **state)
{
    (void)state;
    arena_free(arena);
    shape_scratch_free(scratch);
    diag_done(&diag);
    return 0;
}

/* A cube of two triangles a side; is_turned: wound the other way. */
static MeshData *cube_mesh(bool has_inside, bool is_turned, int triangles)
{
    static const uint32_t sides[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6},
                                          {0, 1, 5}, {0, 5, 4}, {2, 6, 7}, {2, 7, 3},
                                          {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    MeshData *mesh = ARENA_NEW(arena, MeshData);
    mesh->vertices = ARENA_ARRAY(arena, V3, 8);
    for (int i = 0; i < 8; i++)
        mesh->vertices[i] = v3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    mesh->vertex_count = 8;
    mesh->triangle_count = (uint32_t)triangles;
    mesh->corners = ARENA_ARRAY(arena, uint32_t, 36);
    for (int i = 0; i < 12; i++)
        for (int k = 0; k < 3; k++)
            mesh->corners[3 * i + (is_turned ? 2 - k : k)] = sides[i][k];
    mesh->has_inside = has_inside;
    mesh->inside_vector = v3(0, 1, 0);
    assert_int_equal(mesh_index(&diag, mesh, 1), OK);
    return mesh;
}

static Ray random_ray(Rng *rng)
{
    V2 u = {rng_double(rng), rng_double(rng)}, w = {rng_double(rng), rng_double(rng)};
    return (Ray){v3_scale(warp_sphere(w), 2.5), warp_sphere(u), 0, INFINITY};
}

/* The solid mesh of a cube is the cube: the same crossings, inside, and outward normals
 * whatever the winding. */
static void check_is_cube(MeshData *mesh, const Xform *xform)
{
    Shape *a = shape_mesh(arena, mesh), *b = shape_box(arena, v3(-1, -1, -1), v3(1, 1, 1));
    shape_transform(a, xform);
    shape_transform(b, xform);
    ShapeScratch *other = shape_scratch_new();
    for (uint32_t i = 0; i < 3000; i++) {
        Rng rng = rng_at(41, 1, i);
        Ray ray = random_ray(&rng);
        ray.o = xform_point(xform, ray.o);
        CrossList p, q;
        shape_crossings(a, &ray, scratch, &p);
        shape_crossings(b, &ray, other, &q);
        assert_int_equal(p.count, q.count);
        for (int k = 0; k < p.count; k++) {
            ShapePoint m, n;
            assert_true(fabs(p.items[k].t - q.items[k].t) <=
                        p.items[k].t_error + q.items[k].t_error);
            assert_int_equal(p.items[k].change, q.items[k].change);
            shape_point(&p.items[k], &ray, &m);
            shape_point(&q.items[k], &ray, &n);
            assert_true(v3_dot(m.ng, n.ng) > 1 - 1e-12);
            assert_true(v3_dist(m.p, n.p) <
                        p.items[k].t_error + q.items[k].t_error + m.p_error + n.p_error);
        }
        Crossing c;
        if (shape_closest(a, &ray, scratch, &c)) {
            int first = q.items[0].t > 0 ? 0 : 1;
            assert_int_equal(c.change, q.items[first].change);
        }
        assert_int_equal(shape_is_inside(a, ray.o), shape_is_inside(b, ray.o));
    }
    shape_scratch_free(other);
}

static void test_solid(void **state)
{
    (void)state;
    MeshData *mesh = cube_mesh(true, false, 12), *turned = cube_mesh(true, true, 12);
    assert_int_not_equal(mesh->is_turned, turned->is_turned);
    Xform plain = XFORM_IDENTITY, stretch = xform_scale(v3(1, -0.5, 2));
    Xform turn = xform_rotate(v3(1, 2, 3)), move = xform_translate(v3(3, -4, 5));
    Xform x = xform_then(&stretch, &turn);
    x = xform_then(&x, &move);
    check_is_cube(mesh, &plain);
    check_is_cube(turned, &plain);
    check_is_cube(mesh, &x); /* an instance: the data is shared */
    check_is_cube(turned, &x);
    mesh_done(mesh);
    mesh_done(turned);
}

/* Edges and corners are met once: a ray through the middle of a face, along its diagonal. */
static void test_edges(void **state)
{
    (void)state;
    MeshData *mesh = cube_mesh(true, false, 12);
    Shape *shape = shape_mesh(arena, mesh);
    CrossList list;
    static const V3 aims[4] = {{0, 0, 0}, {0.5, 0.5, 0}, {-0.25, -0.25, 0}, {0.25, -0.25, 0}};
    for (int i = 0; i < 4; i++) {
        Ray ray = {v3_add(aims[i], v3(0, 0, -5)), {0, 0, 1}, 0, INFINITY};
        shape_crossings(shape, &ray, scratch, &list);
        assert_int_equal(list.count, 2);
        assert_int_equal(list.items[0].change, 1);
    }
    mesh_done(mesh);
}

/* Without an inside vector, or where it has a hole, a mesh is sheets. */
static void test_sheets(void **state)
{
    (void)state;
    MeshData *open = cube_mesh(true, false, 2), *thin = cube_mesh(false, false, 12);
    Shape *a = shape_mesh(arena, open), *b = shape_mesh(arena, thin);
    Ray ray = {{0.1, 0.2, -5}, {0, 0, 1}, 0, INFINITY};
    CrossList list;
    shape_crossings(a, &ray, scratch, &list);
    assert_int_equal(list.count, 1);
    assert_int_equal(list.items[0].change, 0);
    shape_crossings(b, &ray, scratch, &list);
    assert_int_equal(list.count, 2);
    assert_int_equal(list.items[1].change, 0);
    assert_false(shape_is_solid(b));
    assert_false(shape_is_inside(b, v3(0, 0, 0)));
    assert_true(shape_is_solid(a));
    Crossing c;
    assert_true(shape_closest(b, &ray, scratch, &c));
    assert_true(c.t == 4 && c.change == 0);
    mesh_done(open);
    mesh_done(thin);
}

/* A hole drilled through a mesh. */
static void test_csg(void **state)
{
    (void)state;
    MeshData *mesh = cube_mesh(true, false, 12);
    Shape *children[2] = {shape_mesh(arena, mesh), shape_sphere(arena, v3(0, 0, 0), 0.5)};
    shape_invert(children[1]);
    Shape *d = shape_csg(arena, SHAPE_INTERSECTION, children, 2);
    shape_finish(arena, d);
    Ray ray = {{0, 0, -5}, {0, 0, 1}, 0, INFINITY};
    CrossList list;
    shape_crossings(d, &ray, scratch, &list);
    assert_int_equal(list.count, 4);
    static const double at[4] = {4, 4.5, 5.5, 6};
    for (int i = 0; i < 4; i++)
        assert_true(fabs(list.items[i].t - at[i]) < 1e-14);
    mesh_done(mesh);
}

static void test_smooth_and_uv(void **state)
{
    (void)state;
    MeshData mesh = {.vertex_count = 3, .triangle_count = 2};
    V3 vertices[3] = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
    V3 normals[3] = {v3_unit(v3(-1, 0, -1)), v3_unit(v3(1, 0, -1)), v3_unit(v3(0, 1, -1))};
    V2 uvs[3] = {{0, 0}, {1, 0}, {0.5, 1}};
    uint32_t corners[6] = {0, 1, 2, 0, 1, 2};
    uint32_t normal_corners[6] = {0, 1, 2, UINT32_MAX, UINT32_MAX, UINT32_MAX};
    mesh.vertices = vertices, mesh.corners = corners, mesh.uv_corners = corners;
    mesh.normals = normals, mesh.normal_corners = normal_corners, mesh.uvs = uvs;
    assert_int_equal(mesh_index(&diag, &mesh, 1), OK);
    Shape *shape = shape_mesh(arena, &mesh);
    Ray ray = {{0.25, -0.25, -5}, {0, 0, 1}, 0, INFINITY};
    Crossing c;
    ShapePoint p;
    assert_true(shape_closest(shape, &ray, scratch, &c));
    assert_int_equal(c.part, 0); /* of two equal triangles the first */
    V2 uv = shape_uv(shape, c.part, c.u, c.v, ray_at(&ray, c.t));
    assert_true(fabs(uv.u - 0.625) < 1e-12 && fabs(uv.v - 0.375) < 1e-12); /* measured */
    shape_point(&c, &ray, &p);
    assert_true(p.ng.z == -1 && p.ns.z > -1 && p.ns.z < 0);
    c.part = 1;
    shape_point(&c, &ray, &p);
    assert_true(p.ns.z == -1);
    mesh_done(&mesh);
}

static void test_empty(void **state)
{
    (void)state;
    MeshData mesh = {.vertex_count = 0};
    assert_int_equal(mesh_index(&diag, &mesh, 1), OK);
    Shape *shape = shape_mesh(arena, &mesh);
    Ray ray = {{0, 0, -5}, {0, 0, 1}, 0, INFINITY};
    Crossing c;
    assert_false(shape_closest(shape, &ray, scratch, &c));
    assert_true(bound_is_empty(shape_bound(shape)));
    mesh_done(&mesh);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_solid),         cmocka_unit_test(test_edges),
        cmocka_unit_test(test_sheets),        cmocka_unit_test(test_csg),
        cmocka_unit_test(test_smooth_and_uv), cmocka_unit_test(test_empty),
    };
    return cmocka_run_group_tests_name("mesh", tests, set_up, tear_down);
}
