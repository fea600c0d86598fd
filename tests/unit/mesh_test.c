/* Meshes as they are read: lists of plain vectors and of expressions are the same, and normals.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/rng.h"
#include "sdl/sdl.h"
#include "sdl/vector_scan.h"
#include "shape/mesh.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static Status load(const char *text, Scene **out)
{
    Diag diag;
    diag_init(&diag, diag_drop, NULL);
    const SdlOptions options = {.width = 320, .height = 240, .threads = 1};
    Status status = sdl_load_text(&diag, "test.pms", text, strlen(text), &options, out);
    diag_done(&diag);
    return status;
}

static Scene *scene_of(const char *text)
{
    Scene *scene = NULL;
    assert_int_equal(load(text, &scene), OK);
    return scene;
}

/* The same mesh2 four times: plain, as expressions, with comments, and from a loop. */
static void test_plain_vectors_are_what_expressions_are(void **state)
{
    (void)state;
    Scene *scene = scene_of(
        "#version 3.7;\n"
        "#declare A = array[2] { <0,1,2>, <1,2,3> }\n"
        "mesh2 { vertex_vectors { 4, <0,0,.5>,<1.5e0,-0,0> , < +0.1 , 1 , -2.25E-1 >\n<1,1,1> }\n"
        "  normal_vectors { 2, <0,0,-1>,<0,.5,-1> } uv_vectors { 2, <0,0>,<1,.25> }\n"
        "  face_indices { 2, <0,1,2>,<1,2,3> } uv_indices { 2, <0,1,1>, <1,1,0> }\n"
        "  normal_indices { 1, <0,1,1> } inside_vector z }\n"
        "mesh2 { vertex_vectors { 4, z/2, <3,0,0>*.5, <.1,1,-.225>+0, (<1,1,1>) }\n"
        "  normal_vectors { 2, -z, y/2-z } uv_vectors { 2, 0*u, <2,.5>/2 }\n"
        "  face_indices { 1+1, <0,1,1+1>,<1,2,sqrt(9)> } uv_indices { 2, <0,1,1>+0, <1,1,0>*1 }\n"
        "  normal_indices { 1, y+z } inside_vector z }\n"
        "mesh2 { vertex_vectors { 4, <0,0,.5>, /* a */ <1.5,0,0>, // b\n <.1,1,-.225>,\n"
        "    vaxis_rotate(<1,1,1>, <0,1,0>, 0) }\n"
        "  normal_vectors { 2, <0,0,-1>, <0,.5,-1>*1 } uv_vectors { 2, <0,0> + 0, <1,.25>, }\n"
        "  face_indices { 2, <0,1,2>, <1,2,3>, } uv_indices { 2 <0,1,1> <1,1,0> }\n"
        "  normal_indices { 1, <0,1,1> } inside_vector z }\n"
        "mesh2 { vertex_vectors { 4, #if (1 < 2) <0,0,.5>, #end <1.5,0,0>\n"
        "    #local I = 0; #while (I < 1) , <.1,1,-.225> #local I = I + 1; #end, <1,1,1> }\n"
        "  normal_vectors { 2, <0,0,-1>,<0,.5,-1> } uv_vectors { 2, <0,0>,<1,.25> }\n"
        "  face_indices { 2, A[0], A[1] } uv_indices { 2, <0,1,1>, <1,1,0> }\n"
        "  normal_indices { 1, <0,1,1> } inside_vector z }\n");
    assert_int_equal(scene->mesh_count, 4);
    const MeshData *a = scene->meshes[0];
    assert_true(a->vertices[2].z == -.225 && a->vertices[1].x == 1.5);
    for (int i = 1; i < 4; i++) {
        const MeshData *b = scene->meshes[i];
        assert_int_equal(b->vertex_count, 4);
        assert_int_equal(b->triangle_count, 2);
        for (int k = 0; k < 4; k++)
            assert_true(v3_dist(a->vertices[k], b->vertices[k]) < 1e-15);
        for (int k = 0; k < 2; k++)
            assert_true(v3_dist(a->normals[k], b->normals[k]) == 0);
        assert_memory_equal(a->uvs, b->uvs, 2 * sizeof(V2));
        assert_memory_equal(a->corners, b->corners, 6 * sizeof(uint32_t));
        assert_memory_equal(a->uv_corners, b->uv_corners, 6 * sizeof(uint32_t));
        assert_memory_equal(a->normal_corners, b->normal_corners, 6 * sizeof(uint32_t));
    }
    scene_free(scene);
}

static void test_counts_are_kept(void **state)
{
    (void)state;
    Scene *scene = NULL;
    assert_int_equal(load("mesh2 { vertex_vectors { 2, <0,0,0>,<1,0,0>,<0,1,0> }\n"
                          "face_indices { 1, <0,1,1> } }",
                          &scene),
                     ERR_SYNTAX);
    assert_int_equal(load("mesh2 { vertex_vectors { 4, <0,0,0>,<1,0,0>,<0,1,0> }\n"
                          "face_indices { 1, <0,1,2> } }",
                          &scene),
                     ERR_SYNTAX);
    assert_int_equal(load("mesh2 { vertex_vectors { 3, <0,0,0>,<1,0,0>,<0,1,0> }\n"
                          "face_indices { 400000000, <0,1,2> } }",
                          &scene),
                     ERR_SYNTAX);
    /* A list that the lexer takes for another one. */
    assert_int_equal(load("mesh2 { vertex_vectors { 3, #if (0) } uv_vectors { 3, #end\n"
                          "<0,0>,<1,0>,<0,1> } }",
                          &scene),
                     ERR_SYNTAX);
}

static void test_flat_faces_are_dropped_from_all_lists(void **state)
{
    (void)state;
    Scene *scene =
        scene_of("mesh2 { vertex_vectors { 4, <0,0,0>,<1,0,0>,<0,1,0>,<2,0,0> }\n"
                 "normal_vectors { 4, <0,0,1>,<0,1,1>,<0,2,1>,<0,3,1> }\n"
                 "texture_list { 2, texture { pigment { rgb 1 } } texture { pigment { rgb 0 } } }\n"
                 "face_indices { 3, <0,1,2>,0, <0,1,3>, <1,2,3>,1 } }\n");
    const MeshData *m = scene->meshes[0];
    const uint32_t corners[] = {0, 1, 2, 1, 2, 3}, textures[] = {0, 0, 0, 1, 1, 1};
    assert_int_equal(m->triangle_count, 2);
    assert_memory_equal(m->corners, corners, sizeof corners);
    assert_memory_equal(m->normal_corners, corners, sizeof corners);
    assert_memory_equal(m->textures, textures, sizeof textures);
    scene_free(scene);
}

static void test_equal_normals_are_flat(void **state)
{
    (void)state;
    Scene *scene =
        scene_of("mesh { smooth_triangle { 0, y, <1,1,0>, y, <0,1,1>, y } }\n" /* probe */
                 "mesh { smooth_triangle { 0, y, <1,1,0>, y, <0,1,1>, y+x/1000 } }\n");
    ShapeScratch *scratch = shape_scratch_new();
    for (int i = 0; i < 2; i++) {
        Ray ray = {v3(.2, 5, .2), v3(0, -1, 0), 0, INFINITY};
        Crossing c;
        ShapePoint point;
        assert_true(shape_closest(scene->objects[i].shape, &ray, scratch, &c));
        shape_point(&c, &ray, &point);
        assert_true(fabs(point.ns.y - (i ? 1 : .5773502691896258)) < 1e-6);
    }
    shape_scratch_free(scratch);
    scene_free(scene);
}

static void test_plain_numbers_are_exact(void **state)
{
    (void)state;
    Rng rng = rng_at(12, 1, 0);
    for (int i = 0; i < 20000; i++) {
        char text[100];
        double x = ldexp(rng_double(&rng) - .5, (int)(20 * rng_double(&rng)) - 10), out[3];
        int digits = (int)(14 * rng_double(&rng));
        int length =
            snprintf(text, sizeof text, i % 2 ? "<%.*f,1 , -.5>" : "<%.*e,1,-.5>", digits, x);
        const char *end = scan_vector(text, text + length, 3, out);
        if (!end)
            continue; /* too many digits */
        assert_ptr_equal(end, text + length);
        assert_true(out[0] == strtod(text + 1, NULL) && out[1] == 1 && out[2] == -.5);
        assert_null(scan_vector(text, text + length - 1, 3, out));
        assert_null(scan_vector(text, text + length, 2, out));
    }
    double out[3];
    static const char *const none[] = {"<1,2>",       "<1,2,x>",      "<1,2,3+1>",
                                       "<1,,3>",      "<.,1,2>",      "<1e,2,3>",
                                       "<1,2,1.2.3>", "<1,2,3/*a*/>", "<1234567890123456,1,1>"};
    for (size_t i = 0; i < sizeof none / sizeof none[0]; i++)
        assert_null(scan_vector(none[i], none[i] + strlen(none[i]), 3, out));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_plain_vectors_are_what_expressions_are),
        cmocka_unit_test(test_counts_are_kept),
        cmocka_unit_test(test_flat_faces_are_dropped_from_all_lists),
        cmocka_unit_test(test_equal_normals_are_flat),
        cmocka_unit_test(test_plain_numbers_are_exact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
