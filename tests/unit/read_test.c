/* The block readers: what a text becomes in the scene.  The files of tests/lang say what is
 * accepted; here are the values.  SPDX-License-Identifier: Apache-2.0 */
#include "base/mem.h"
#include "sdl/sdl.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#define BALL "sphere { 0, 1 }\n"

static void ignore_message(void *ctx, const char *text)
{
    (void)ctx;
    (void)text;
}

static Status load(const char *text, Scene **out)
{
    Diag diag;
    diag_init(&diag, ignore_message, NULL);
    const SdlOptions options = {.width = 320, .height = 240, .threads = 1};
    Status status = sdl_load_text(&diag, "test.pms", text, strlen(text), &options, out);
    diag_done(&diag);
    return status;
}

static Scene *scene_of(const char *text)
{
    Scene *scene = NULL;
    assert_int_equal(load(text, &scene), OK);
    assert_non_null(scene);
    return scene;
}

static bool is_near(double a, double b)
{
    return fabs(a - b) <= 1e-6 * (1 + fabs(b));
}

static bool is_at(V3 a, double x, double y, double z)
{
    return v3_dist(a, v3(x, y, z)) <= 1e-9 * (1 + v3_len(a));
}

static const Finish *finish_of(const Scene *scene, int object)
{
    return scene->surfaces[object].texture->layers[0].finish;
}

static const Pigment *pigment_of(const Scene *scene, int object)
{
    return scene->surfaces[object].texture->layers[0].pigment;
}

/* --- objects ------------------------------------------------------------------------------- */

static void test_negative_sizes_mean_their_absolute_value(void **state)
{
    (void)state;
    Scene *scene = scene_of("sphere { 0, -2 } cylinder { 0, y, -3 } torus { -2, 0.5 }");
    assert_true(shape_is_inside(scene->objects[0].shape, v3(1.9, 0, 0)));
    assert_true(shape_is_inside(scene->objects[1].shape, v3(2.9, 0.5, 0)));
    assert_true(shape_is_inside(scene->objects[2].shape, v3(2.4, 0, 0)));
    scene_free(scene);
}

static void test_shapes_without_size_vanish(void **state)
{
    (void)state;
    Scene *scene = scene_of("sphere { 0, 0 } triangle { 0, x, 2*x } disc { 0, y, 1, 1 }\n"
                            "difference { box { -1, 1 } sphere { 0, 0 } }\n"
                            "intersection { box { -1, 1 } sphere { 0, 0 } }");
    assert_int_equal(scene->object_count, 1);
    assert_true(shape_is_inside(scene->objects[0].shape, v3(0, 0, 0)));
    scene_free(scene);
}

static void test_difference_is_the_first_minus_the_others(void **state)
{
    (void)state;
    Scene *scene =
        scene_of("difference { box { -1, 1 } sphere { <1, 1, 1>, 1 } plane { y, -0.5 } }");
    const Shape *shape = scene->objects[0].shape;
    assert_true(shape_is_inside(shape, v3(0, 0, 0)));
    assert_false(shape_is_inside(shape, v3(0.8, 0.8, 0.8)));
    assert_false(shape_is_inside(shape, v3(0, -0.8, 0)));
    assert_false(shape_is_inside(shape, v3(2, 0, 0)));
    scene_free(scene);
}

static void test_inverse_on_groups_is_de_morgan(void **state)
{
    (void)state;
    Scene *scene = scene_of("union { sphere { 0, 1 } sphere { x, 1 } inverse }\n"
                            "difference { sphere { 0, 2 } sphere { 0, 1 } inverse }");
    assert_true(shape_is_inside(scene->objects[0].shape, v3(5, 0, 0)));
    assert_false(shape_is_inside(scene->objects[0].shape, v3(1.5, 0, 0)));
    assert_true(shape_is_inside(scene->objects[1].shape, v3(0, 0, 0)));
    assert_false(shape_is_inside(scene->objects[1].shape, v3(1.5, 0, 0)));
    assert_true(shape_is_inside(scene->objects[1].shape, v3(3, 0, 0)));
    scene_free(scene);
}

static void test_transforms_apply_in_written_order(void **state)
{
    (void)state;
    Scene *scene = scene_of("sphere { 0, 0.1 translate x rotate 90*y scale <1, 1, 3> }\n"
                            "sphere { x, 0.1 transform { translate 5*x inverse } }\n"
                            "sphere { 0, 0.1 matrix <1,0,0, 0,1,0, 0,0,1, 2,3,4> }");
    assert_true(shape_is_inside(scene->objects[0].shape, v3(0, 0, -3)));
    assert_true(shape_is_inside(scene->objects[1].shape, v3(-4, 0, 0)));
    assert_true(shape_is_inside(scene->objects[2].shape, v3(2, 3, 4)));
    scene_free(scene);
}

static void test_clips_move_with_the_object(void **state)
{
    (void)state;
    Scene *scene = scene_of("sphere { 0, 1 clipped_by { box { <-2, 0, -2>, 2 } } translate 5*x }\n"
                            "sphere { 0, 1 translate 5*x clipped_by { box { <-9, 0, -9>, 9 } } }\n"
                            "sphere { 0, 1 bounded_by { box { <-2, 0, -2>, 2 } }\n"
                            "         clipped_by { bounded_by } translate 5*x }");
    for (uint32_t i = 0; i < 3; i++) {
        assert_true(shape_is_inside(scene->objects[i].shape, v3(5, 0.5, 0)));
        assert_false(shape_is_inside(scene->objects[i].shape, v3(5, -0.5, 0)));
    }
    scene_free(scene);
}

static void test_names_reach_the_scene(void **state)
{
    (void)state;
    Scene *scene = scene_of("#declare Ball = sphere { 0, 1 }\n"
                            "Ball object { Ball } sphere { 0, 1 }\n"
                            "#declare Lamp = light_source { 5, rgb 1 }\n"
                            "light_source { 4, rgb 1 } object { Lamp }\n");
    assert_string_equal(scene->objects[0].name, "Ball");
    assert_string_equal(scene->objects[1].name, "Ball");
    assert_string_equal(scene->objects[2].name, "sphere");
    assert_int_equal(span_place(scene->objects[1].span).line, 2);
    assert_string_equal(scene->lights[0].name, "light 1");
    assert_string_equal(scene->lights[1].name, "Lamp");
    scene_free(scene);
}

static void test_mesh_and_mesh2_give_the_same_triangles(void **state)
{
    (void)state;
    Scene *scene =
        scene_of("mesh { smooth_triangle { 0, -z, x, -2*z, y, <0, 1, -1> } triangle { 0, x, z } }\n"
                 "mesh2 { vertex_vectors { 4, 0, x, y, z }\n"
                 "  normal_vectors { 3, -z, -2*z, <0, 1, -1> }\n"
                 "  face_indices { 2, <0, 1, 2>, <0, 1, 3> } normal_indices { 1, <0, 1, 2> } }");
    assert_int_equal(scene->mesh_count, 2);
    for (int i = 0; i < 2; i++) {
        const MeshData *m = scene->meshes[i];
        assert_int_equal(m->triangle_count, 2);
        assert_true(is_at(m->vertices[m->corners[2]], 0, 1, 0));
        assert_true(is_at(m->vertices[m->corners[5]], 0, 0, 1));
        assert_true(is_at(m->normals[m->normal_corners[1]], 0, 0, -1));
        assert_true(is_at(m->normals[m->normal_corners[2]], 0, sqrt(0.5), -sqrt(0.5)));
        assert_true(m->normal_corners[3] == UINT32_MAX);
        assert_null(m->uvs);
        assert_null(m->textures);
    }
    scene_free(scene);
}

/* Triangles of plain vectors are scanned, those with anything else are parsed: they are the same
 * mesh, and points that several share are kept once. */
static void test_plain_triangles_are_scanned(void **state)
{
    (void)state;
    Scene *scene = scene_of(
        "mesh { triangle { <0, 0, 0>, <1, 0, 0>, <0, 1, 0> }\n"
        "  smooth_triangle{<0,0,0>,<0,0,-1>,<1,0,0>,<0,0,-2> <0,1e0,0> <0,1,-1>,}\n"
        "  triangle { <0, 0, 0>, <1, 0, 0>, <.5, 0, 0> }\n"
        "  triangle { <0, 0, 0>, <1, 0, 0>, <0, 0, 2> texture { pigment { rgb 1 } } }\n"
        "  triangle { <0, 0, 0>, <1, 0, 0>, <0, 0, 2> * 2 }\n"
        "  triangle { <0, 0, 0>, <1, 0, 0>, <0, 0, -2.5> } triangle { <0,0,0>,<0,0,2>,<0,1,0> } }\n"
        "mesh { triangle { 0, x, y } smooth_triangle { 0, -z, x, -2*z, y, <0, 1, -1> }\n"
        "  triangle { 0, x, x/2 } triangle { 0, x, 2*z texture { pigment { rgb 1 } } }\n"
        "  triangle { 0, x, 4*z } triangle { 0, x, -2.5*z } triangle { 0, 2*z, y } }");
    const MeshData *a = scene->meshes[0], *b = scene->meshes[1];
    size_t bytes = 6 * 3 * sizeof(uint32_t);
    assert_int_equal(a->triangle_count, 6);
    assert_int_equal(b->triangle_count, 6);
    assert_int_equal(a->vertex_count, 6);
    assert_int_equal(b->vertex_count, 6);
    assert_memory_equal(a->corners, b->corners, bytes);
    assert_memory_equal(a->normal_corners, b->normal_corners, bytes);
    assert_memory_equal(a->textures, b->textures, bytes);
    for (uint32_t i = 0; i < 6; i++)
        assert_true(v3_dist(a->vertices[i], b->vertices[i]) == 0);
    assert_true(is_at(a->vertices[a->corners[14]], 0, 0, -2.5));
    const uint32_t *n = a->normal_corners;
    assert_true(n[0] == UINT32_MAX && n[3] == n[4] && n[5] != n[4] && n[6] == UINT32_MAX);
    assert_true(a->textures[5] == MESH_NO_TEXTURE && a->textures[6] == 0);
    scene_free(scene);
}

static void test_uv_mapping_marks_pigments(void **state)
{
    (void)state;
    Scene *scene = scene_of(
        "#declare C = pigment { checker scale 1/8 }\n"
        "sphere { 0, 1 uv_mapping texture { pigment { C } } texture { pigment { C } } scale 2 }\n"
        "sphere { 0, 1 texture { pigment { uv_mapping C scale 2 } scale 2 } }\n"
        "sphere { 0, 1 texture { uv_mapping pigment { C } scale 2 } scale 5 }\n"
        "union { sphere { 0, 1 } sphere { x, 1 pigment { C } } uv_mapping pigment { C } }\n");
    static const double scale[5] = {0.125, 0.25, 0.25, 0.125, 0.125};
    for (uint32_t i = 0; i < 5; i++) {
        const Texture *texture = scene->surfaces[i].texture;
        const Pigment *pigment = texture->layers[texture->layer_count - 1].pigment;
        assert_int_equal(texture_has_uv(texture), i != 4);
        assert_int_equal(pigment->is_uv, i != 4);
        assert_true(is_near(pigment->pattern.xform.to[0][0], scale[i]));
    }
    assert_true(scene->surfaces[0].texture->layers[0].pigment->is_uv);
    scene_free(scene);
}

/* Does a surface show so much red and green at p, the mean of what it shows there? */
static bool shows(const Surface *surface, V3 p, double red, double green)
{
    double count = 0, sum[2] = {0, 0};
    for (int i = 0; surface->cutaway && i < surface->cutaway->count; i++) {
        if (!shape_is_inside(surface->cutaway->solids[i], p))
            continue;
        Color5 c = surface->cutaway->textures[i]->layers[0].pigment->color;
        sum[0] += (double)c.r;
        sum[1] += (double)c.g;
        count++;
    }
    if (count == 0) {
        Color5 c = surface->texture->layers[0].pigment->color;
        return is_near((double)c.r, red) && is_near((double)c.g, green);
    }
    return is_near(sum[0] / count, red) && is_near(sum[1] / count, green);
}

/* Cutters without a texture show what they cut, wherever they are in the tree. */
static void test_cutaway_shows_what_is_cut(void **state)
{
    (void)state;
    Scene *scene = scene_of(
        "#default { pigment { rgb <0, 0, 1> } }\n"
        "#declare Pair = union { sphere { -x/2, 1 pigment { rgb x } } sphere { x/2, 1 } }\n"
        "difference { object { Pair pigment { rgb y } } box { -1, 0 } "
        "  union { box { 0, 1 } box { 1, 2 pigment { rgb <1, 1, 0> } } } cutaway_textures }\n"
        "union { difference { sphere { 0, 1 pigment { rgb x } } box { 0, 1 } cutaway_textures }"
        "  sphere { 5, 1 } pigment { rgb y } }\n"
        "difference { sphere { 0, 1 pigment { rgb x } } box { 0, 1 } }\n");
    const Surface *s = scene->surfaces;
    assert_int_equal(scene->surface_count, 10);
    assert_true(shows(&s[0], v3(1.2, 0, 0), 1, 0)); /* a sphere of its own texture */
    for (int i = 2; i < 4; i++) {                   /* boxes that cut */
        assert_true(shows(&s[i], v3(-1.2, 0, 0), 1, 0));
        assert_true(shows(&s[i], v3(1.2, 0, 0), 0, 1));
        assert_true(shows(&s[i], v3(0, 0, 0), 0.5, 0.5));
        assert_true(shows(&s[i], v3(9, 0, 0), 0, 0)); /* nothing is there: the default */
    }
    assert_true(shows(&s[4], v3(0, 0, 0), 1, 1)); /* one with a texture */
    assert_true(shows(&s[6], v3(0, 0, 0), 0, 1)); /* one that gets the union's */
    assert_true(shows(&s[9], v3(0, 0, 0), 0, 0)); /* one without cutaway_textures */
    scene_free(scene);
}

static void test_instances_share_their_mesh(void **state)
{
    (void)state;
    Scene *scene = scene_of("#declare M = mesh { triangle { 0, x, y } }\n"
                            "object { M } object { M translate 2*z } M");
    assert_int_equal(scene->mesh_count, 1);
    assert_int_equal(scene->object_count, 3);
    assert_ptr_equal(scene->objects[0].shape->u.mesh, scene->objects[1].shape->u.mesh);
    scene_free(scene);
}

static void test_mesh_textures_are_listed_once(void **state)
{
    (void)state;
    Scene *scene = scene_of("#declare A = texture { pigment { rgb x } }\n"
                            "#declare B = texture { pigment { rgb y } }\n"
                            "mesh2 { vertex_vectors { 3, 0, x, y }\n"
                            "  texture_list { 2, texture { A } texture { B } }\n"
                            "  face_indices { 3, <0, 1, 2>, 1, <0, 1, 2>, 0, 1, 1 <0, 1, 2> } }");
    const Surface *s = &scene->surfaces[0];
    assert_int_equal(s->part_texture_count, 2);
    assert_true(s->part_textures[1]->layers[0].pigment->color.g == 1);
    const uint32_t expected[9] = {
        1, 1, 1, 0, 1, 1, MESH_NO_TEXTURE, MESH_NO_TEXTURE, MESH_NO_TEXTURE};
    assert_memory_equal(scene->meshes[0]->textures, expected, sizeof expected);
    scene_free(scene);
}

/* --- looks --------------------------------------------------------------------------------- */

static void test_layers_lie_in_written_order(void **state)
{
    (void)state;
    Scene *scene =
        scene_of("sphere { 0, 1 texture { pigment { rgb <1, 0, 0> } }\n"
                 "  texture { pigment { rgbt <0, 1, 0, 0.5> } } finish { phong 0.5 } }\n"
                 "#declare T = texture { pigment { rgb 1 } } texture { pigment { rgbt 0.5 } }\n"
                 "sphere { 0, 1 texture { T pigment { rgbf <0, 0, 1, 0.5> } } }");
    const Texture *t = scene->surfaces[0].texture;
    assert_int_equal(t->layer_count, 2);
    assert_true(t->layers[0].pigment->color.r == 1 && t->layers[0].finish->phong == 0);
    assert_true(t->layers[1].pigment->color.transmit == 0.5f && t->layers[1].finish->phong == 0.5f);
    t = scene->surfaces[1].texture;
    assert_true(t->layer_count == 2 && t->layers[1].pigment->color.filter == 0.5f);
    assert_true(scene->surfaces[0].may_transmit == false || t->layer_count == 2);
    scene_free(scene);
}

static void test_defaults_of_objects_and_finish(void **state)
{
    (void)state;
    Scene *scene = scene_of(BALL);
    const Finish *f = finish_of(scene, 0);
    assert_true(pigment_of(scene, 0)->is_solid && pigment_of(scene, 0)->color.r == 0);
    assert_true(f->ambient.r == 0.1f && f->diffuse == 0.6f && f->brilliance == 1);
    assert_true(f->phong == 0 && f->phong_size == 40 && f->specular == 0 && f->roughness == 0.05f);
    assert_true(rgb_is_black(f->reflection_max) && f->reflection_exponent == 1);
    assert_true(scene->surfaces[0].interior->ior == 1);
    assert_true(scene->surfaces[0].photons.is_collecting);
    scene_free(scene);
}

static void test_albedo_factors(void **state)
{
    (void)state;
    Scene *scene =
        scene_of("#declare F = finish { diffuse albedo 0.4 phong albedo 0.2 specular albedo 0.1 }\n"
                 "sphere { 0, 1 finish { diffuse albedo 0.4, 0.2 brilliance 3 phong albedo 0.2\n"
                 "  phong_size 59 specular albedo 0.1 roughness 0.01 } }\n"
                 "sphere { 0, 1 finish { F brilliance 3 phong_size 59 roughness 0.01 } }");
    /* (1/r + 2) / (4 (2 - 2^(-1/2r))) at r = 0.01: 102 / 8, but for 2^-50. */
    for (int i = 0; i < 2; i++) {
        const Finish *f = finish_of(scene, i);
        assert_true(is_near(f->diffuse, 0.8));
        assert_true(is_near(f->phong, 6));
        assert_true(is_near(f->specular, 0.1 * 102 / 8));
    }
    assert_true(is_near(finish_of(scene, 0)->diffuse_back, 0.4));
    scene_free(scene);
}

static void test_forms_of_reflection(void **state)
{
    (void)state;
    Scene *scene =
        scene_of("sphere { 0, 1 finish { reflection 0.3 } }\n"
                 "sphere { 0, 1 finish { reflection { 0.3 } } }\n"
                 "sphere { 0, 1 finish { reflection { 0.1, rgb <0.5, 0.6, 0.7> falloff 2\n"
                 "  exponent 1.5 metallic } } }\n"
                 "sphere { 0, 1 finish { reflection { 0.9 fresnel on } } }");
    assert_true(finish_of(scene, 0)->reflection_min.r == 0.3f);
    assert_true(finish_of(scene, 1)->reflection_min.g == 0.3f);
    const Finish *f = finish_of(scene, 2);
    assert_true(f->reflection_min.b == 0.1f && f->reflection_max.b == 0.7f);
    assert_true(f->reflection_falloff == 2 && f->reflection_exponent == 1.5f);
    assert_true(f->reflection_metallic == 1 && !f->is_fresnel);
    f = finish_of(scene, 3);
    assert_true(f->is_fresnel && f->reflection_min.r == 0 && f->reflection_max.r == 0.9f);
    for (int i = 0; i < 4; i++)
        assert_true(scene->surfaces[i].may_reflect);
    scene_free(scene);
}

static void test_color_map_keys_and_old_form(void **state)
{
    (void)state;
    Scene *scene =
        scene_of("#declare Red = rgb <1, 0, 0>;\n"
                 "plane { y, 0 pigment { gradient x color_map { [0 Red*0.5] [0.25, rgb 1] } } }\n"
                 "plane { y, 0 pigment { gradient x\n"
                 "  color_map { [0 0.5 color Red color rgb 0] [0.5 1 rgb 0 Red] } frequency 3 } }");
    const Pigment *p = pigment_of(scene, 0);
    assert_true(p->map_count == 2 && p->map[0].color.r == 0.5f && p->map[1].key == 0.25f);
    p = pigment_of(scene, 1);
    assert_int_equal(p->map_count, 4);
    assert_true(p->map[1].key == 0.5f && p->map[1].color.r == 0);
    assert_true(p->map[3].key == 1 && p->map[3].color.r == 1);
    assert_true(p->pattern.frequency == 3);
    scene_free(scene);
}

static void test_textures_keep_their_place_in_the_order(void **state)
{
    (void)state;
    Scene *scene = scene_of("#declare P = pigment { gradient x }\n"
                            "plane { y, 0 pigment { P } translate 0.25*x }\n"
                            "plane { y, 0 translate 0.25*x pigment { P } }\n"
                            "plane { y, 0 texture { pigment { P } scale 2 } }\n");
    assert_true(is_near(pigment_at(pigment_of(scene, 0), v3(0.5, 0, 0)).r, 0.25));
    assert_true(is_near(pigment_at(pigment_of(scene, 1), v3(0.5, 0, 0)).r, 0.5));
    assert_true(is_near(pigment_at(pigment_of(scene, 2), v3(0.5, 0, 0)).r, 0.25));
    scene_free(scene);
}

static void test_interior_and_material(void **state)
{
    (void)state;
    Scene *scene = scene_of(
        "#declare M = material { texture { pigment { rgbf 1 } } interior { ior 1.5 caustics 0.5\n"
        "  fade_distance 2 fade_power 1001 fade_color rgb <0.9, 0.5, 0.1> } }\n"
        "sphere { 0, 1 material { M } }");
    const Interior *in = scene->surfaces[0].interior;
    assert_true(in->ior == 1.5 && in->fade_distance == 2 && in->fade_power == 1001);
    assert_true(in->fade_color.g == 0.5f && in->caustics == 0.5f);
    assert_true(scene->surfaces[0].may_transmit);
    scene_free(scene);
}

/* --- lights -------------------------------------------------------------------------------- */

static void test_light_angles_and_kinds(void **state)
{
    (void)state;
    Scene *scene = scene_of(
        BALL "light_source { <0, 5, 0>, rgb 2 spotlight point_at 0 radius 10 falloff 20 }\n"
             "light_source { <0, 5, 0>, 1 cylinder point_at 0 }\n"
             "light_source { <0, 5, 0>, 1 spotlight point_at 0 shadowless }\n"
             "light_source { <0, 5, 0>, 1 shadowless spotlight }\n");
    const Light *l = scene->lights;
    assert_true(l[0].kind == LIGHT_SPOT && is_near(l[0].radius, PMS_PI / 18));
    assert_true(is_near(l[0].falloff, PMS_PI / 9) && l[0].color.g == 2);
    assert_true(is_at(l[0].direction, 0, -1, 0) && !l[0].is_parallel);
    assert_true(l[1].kind == LIGHT_CYLINDER && l[1].is_parallel);
    assert_true(l[1].radius == 0.75 && l[1].falloff == 1);
    /* The last of these words holds. */
    assert_true(l[2].kind == LIGHT_POINT && l[2].is_shadowless);
    assert_true(l[3].kind == LIGHT_SPOT && !l[3].is_shadowless);
    assert_true(is_near(l[3].radius, PMS_PI / 6) && is_near(l[3].falloff, PMS_PI / 4));
    scene_free(scene);
}

static void test_area_light(void **state)
{
    (void)state;
    Scene *scene =
        scene_of(BALL "light_source { y, 1 area_light 2*x, 3*z, 4.9, 5 adaptive 1 jitter\n"
                      "  circular orient area_illumination rotate 90*y translate 9*y\n"
                      "  photons { reflection off refraction on area_light } }\n"
                      "light_source { y, 1 }");
    const Light *l = &scene->lights[0];
    assert_true(l->area.size1 == 4 && l->area.size2 == 5 && l->area.adaptive == 1);
    assert_true(l->area.has_jitter && l->area.is_circular && l->area.is_oriented);
    assert_true(l->area.has_illumination && l->has_area_photons);
    assert_true(is_at(l->area.axis1, 0, 0, -2) && is_at(l->location, 0, 10, 0));
    assert_true(l->photon_reflection == TRI_OFF && l->photon_refraction == TRI_ON);
    assert_true(scene->lights[1].area.size1 == 0 && scene->lights[1].area.adaptive == 100);
    assert_true(scene->lights[1].photon_share == 1);
    scene_free(scene);
}

/* --- camera -------------------------------------------------------------------------------- */

static void test_camera_angle_and_look_at(void **state)
{
    (void)state;
    Scene *scene = scene_of(BALL "camera { look_at <0, 0, 0> location <0, 0, -10> angle 90\n"
                                 "  right 2*x up y }");
    const Camera *c = &scene->camera;
    assert_true(is_at(c->location, 0, 0, -10));
    assert_true(is_at(c->direction, 0, 0, 1)); /* |right|/2 / tan 45 */
    assert_true(is_at(c->right, 2, 0, 0) && is_at(c->up, 0, 1, 0));
    assert_true(c->kind == CAMERA_PERSPECTIVE && c->aperture == 0);
    scene_free(scene);
}

static void test_camera_keeps_its_handedness(void **state)
{
    (void)state;
    Scene *scene = scene_of(BALL "camera { right -1.5*x location <5, 0, 0> look_at 0 }");
    assert_true(is_at(scene->camera.direction, -1, 0, 0));
    assert_true(is_at(scene->camera.right, 0, 0, -1.5));
    scene_free(scene);
    scene = scene_of(BALL "camera { location <5, 0, 0> look_at 0 sky z }");
    assert_true(is_at(scene->camera.up, 0, 0, 1));
    assert_true(is_at(scene->camera.right, 0, -1.33, 0));
    scene_free(scene);
}

static void test_camera_transforms_come_last(void **state)
{
    (void)state;
    Scene *scene = scene_of(BALL "camera { translate 5*y location -3*z rotate 90*x look_at 0 }");
    assert_true(is_at(scene->camera.location, 0, 3, 5));
    assert_true(is_at(scene->camera.direction, 0, -1, 0));
    scene_free(scene);
}

static void test_orthographic_size(void **state)
{
    (void)state;
    Scene *scene = scene_of(BALL "camera { orthographic location -10*z look_at 0 }");
    assert_true(scene->camera.kind == CAMERA_ORTHOGRAPHIC);
    assert_true(is_at(scene->camera.right, 13.3, 0, 0) && is_at(scene->camera.up, 0, 10, 0));
    scene_free(scene);
    scene = scene_of(BALL "camera { orthographic location -10*z look_at 0 right 4*x up 3*y }");
    assert_true(is_at(scene->camera.right, 4, 0, 0) && is_at(scene->camera.up, 0, 3, 0));
    scene_free(scene);
    scene =
        scene_of(BALL "camera { orthographic location -10*z look_at 0 right 4*x up 3*y angle 90 }");
    assert_true(is_at(scene->camera.right, 20, 0, 0)); /* 4 * 10 / |direction| = 2 */
    scene_free(scene);
}

static void test_focal_blur(void **state)
{
    (void)state;
    Scene *scene =
        scene_of(BALL "camera { location -10*z look_at 0 aperture 0.4 blur_samples 4, 20\n"
                      "  focal_point <0, 0, -4> confidence 0.95 variance 0.001 }");
    const Camera *c = &scene->camera;
    assert_true(c->aperture == 0.4 && c->blur_samples == 20 && is_near(c->focal_distance, 6));
    assert_true(c->blur_confidence == 0.95 && c->blur_variance == 0.001);
    scene_free(scene);
    scene = scene_of(BALL "camera { location -10*z look_at 0 aperture 0.4 }");
    assert_true(scene->camera.aperture == 0); /* no samples: no blur */
    scene_free(scene);
}

/* --- settings ------------------------------------------------------------------------------ */

static void test_global_settings(void **state)
{
    (void)state;
    Scene *scene = scene_of(
        BALL "global_settings { ambient_light rgb <1, 2, 3> max_trace_level 300 adc_bailout 0.1\n"
             "  photons { count 1000 gather 5, 70 radius 0.5 jitter 0.1 autostop 0\n"
             "  max_trace_level 9 adc_bailout 0.2 } }\n"
             "global_settings { #ifdef (pms_version) pms { gi global_photons 777\n"
             "  kernel gaussian_jensen gather sphere } #end }");
    const SceneSettings *s = &scene->settings;
    assert_true(s->ambient_light.b == 3 && s->max_trace_level == 256 && s->adc_bailout == 0.1);
    assert_true(s->photons.is_on && s->photons.count == 1000 && s->photons.radius == 0.5);
    assert_true(s->photons.gather_min == 5 && s->photons.gather_max == 70);
    assert_true(s->photons.jitter == 0.1 && s->photons.autostop == 0);
    assert_true(s->photons.max_trace_level == 9 && s->photons.adc_bailout == 0.2);
    assert_true(s->pms.has_indirect && s->pms.global_count == 777);
    assert_true(s->pms.kernel == KERNEL_GAUSSIAN_JENSEN && s->pms.gather_shape == GATHER_SPHERE);
    scene_free(scene);
}

static void test_defaults_of_settings(void **state)
{
    (void)state;
    Scene *scene = scene_of(BALL);
    const SceneSettings *s = &scene->settings;
    assert_true(s->max_trace_level == 5 && s->ambient_light.r == 1);
    assert_true(is_near(s->adc_bailout, 1.0 / 255) && !s->photons.is_on && !s->pms.has_indirect);
    assert_true(s->photons.gather_min == 20 && s->photons.gather_max == 100);
    assert_true(scene->background.color.transmit == 1 && !scene->background.is_given);
    assert_null(scene->sky.pigments);
    assert_true(is_at(scene->camera.right, 1.33, 0, 0) && !scene->camera.span.source);
    scene_free(scene);
}

static void test_sky_and_background(void **state)
{
    (void)state;
    Scene *scene = scene_of(BALL "background { rgb <0.1, 0.2, 0.3> }\n"
                                 "sky_sphere { pigment { gradient y } scale 2\n"
                                 "  pigment { rgbt <1, 0, 0, 0.5> } emission rgb 2 }");
    assert_true(scene->background.is_given && scene->background.color.g == 0.2f);
    assert_int_equal(scene->sky.pigment_count, 2);
    assert_true(is_near(pigment_at(scene->sky.pigments[0], v3(0, 1, 0)).r, 0.5));
    assert_true(scene->sky.pigments[1]->color.transmit == 0.5f && scene->sky.emission.r == 2);
    scene_free(scene);
}

/* --- accidents ----------------------------------------------------------------------------- */

/* Every block there is, so that each allocation of the readers fails once. */
static const char everything[] =
    "#declare M = mesh { triangle { 0, x, y } smooth_triangle { 0, -z, x, -z, y, -z } }\n"
    "#declare T = texture { pigment { checker rgb 1, rgb 0 } finish { phong 1 } }\n"
    "union { object { M } sphere { 0, 1 texture { T } clipped_by { box { 0, 1 } } }\n"
    "  light_source { 5, rgb 1 area_light x, y, 2, 2 } rotate 5*y }\n"
    "difference { box { -1, 1 } cylinder { -y, y, 0.5 } interior { ior 1.5 }\n"
    "  pigment { gradient x color_map { [0 rgb 0] [1 rgb 1] } scale 2 } }\n"
    "mesh2 { vertex_vectors { 3, 0, x, y } face_indices { 1, <0, 1, 2> } }\n"
    "camera { location -5*z look_at 0 } sky_sphere { pigment { gradient y } }\n"
    "global_settings { photons { count 10 } }\n";

static void test_no_allocation_failure_breaks_a_load(void **state)
{
    (void)state;
    Status status = ERR_MEMORY;
    for (long n = 1; n < 2000 && status != OK; n++) {
        Scene *scene = NULL;
        mem_fail_from(n);
        status = load(everything, &scene);
        mem_fail_from(0);
        assert_true(status == OK || status == ERR_MEMORY || status == ERR_LIBRARY);
        assert_true((scene != NULL) == (status == OK));
        scene_free(scene);
    }
    assert_int_equal(status, OK);
}

static void test_truncation_anywhere_is_no_accident(void **state)
{
    (void)state;
    char text[sizeof everything];
    for (size_t size = 0; size < sizeof everything - 1; size++) {
        memcpy(text, everything, size);
        text[size] = 0;
        Scene *scene = NULL;
        Status status = load(text, &scene);
        assert_true(status == OK || status == ERR_SYNTAX || status == ERR_SCENE);
        assert_true((scene != NULL) == (status == OK));
        scene_free(scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_negative_sizes_mean_their_absolute_value),
        cmocka_unit_test(test_shapes_without_size_vanish),
        cmocka_unit_test(test_difference_is_the_first_minus_the_others),
        cmocka_unit_test(test_inverse_on_groups_is_de_morgan),
        cmocka_unit_test(test_transforms_apply_in_written_order),
        cmocka_unit_test(test_clips_move_with_the_object),
        cmocka_unit_test(test_names_reach_the_scene),
        cmocka_unit_test(test_mesh_and_mesh2_give_the_same_triangles),
        cmocka_unit_test(test_plain_triangles_are_scanned),
        cmocka_unit_test(test_uv_mapping_marks_pigments),
        cmocka_unit_test(test_cutaway_shows_what_is_cut),
        cmocka_unit_test(test_instances_share_their_mesh),
        cmocka_unit_test(test_mesh_textures_are_listed_once),
        cmocka_unit_test(test_layers_lie_in_written_order),
        cmocka_unit_test(test_defaults_of_objects_and_finish),
        cmocka_unit_test(test_albedo_factors),
        cmocka_unit_test(test_forms_of_reflection),
        cmocka_unit_test(test_color_map_keys_and_old_form),
        cmocka_unit_test(test_textures_keep_their_place_in_the_order),
        cmocka_unit_test(test_interior_and_material),
        cmocka_unit_test(test_light_angles_and_kinds),
        cmocka_unit_test(test_area_light),
        cmocka_unit_test(test_camera_angle_and_look_at),
        cmocka_unit_test(test_camera_keeps_its_handedness),
        cmocka_unit_test(test_camera_transforms_come_last),
        cmocka_unit_test(test_orthographic_size),
        cmocka_unit_test(test_focal_blur),
        cmocka_unit_test(test_global_settings),
        cmocka_unit_test(test_defaults_of_settings),
        cmocka_unit_test(test_sky_and_background),
        cmocka_unit_test(test_no_allocation_failure_breaks_a_load),
        cmocka_unit_test(test_truncation_anywhere_is_no_accident),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
