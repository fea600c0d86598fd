/* The scene floor: nodes, what children take from parents, transforms, the last check.
 * Nodes are made by hand here; read_test.c goes through the readers.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/node.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

typedef struct World {
    Scene *scene;
    SceneBuild build;
    Diag diag;
    char said[4096]; /* all messages, one after the other */
} World;

static void keep_message(void *ctx, const char *text)
{
    World *w = ctx;
    strncat(w->said, text, sizeof w->said - strlen(w->said) - 1);
}

static World *world_new(void)
{
    World *w = test_calloc(1, sizeof *w);
    w->scene = scene_new();
    assert_non_null(w->scene);
    w->build.arena = w->scene->arena;
    diag_init(&w->diag, keep_message, w);
    return w;
}

static void world_free(World *w)
{
    scene_free(w->scene);
    diag_done(&w->diag);
    test_free(w);
}

static Status finish(World *w)
{
    Status status = scene_build_finish(&w->build, w->scene, &w->diag);
    return status == OK ? scene_check(w->scene, &w->diag) : status;
}

static Node *node_new(World *w, NodeKind kind)
{
    Node *node = ARENA_NEW(w->scene->arena, Node);
    node->kind = kind;
    node->name = "thing";
    return node;
}

static Node *ball(World *w, V3 center)
{
    Node *node = node_new(w, NODE_LEAF);
    node->shape = shape_sphere(w->scene->arena, center, 1);
    node->name = "sphere";
    return node;
}

static Node *group(World *w, ShapeKind kind, int count, Node *const *children)
{
    Node *node = node_new(w, NODE_CSG);
    node->csg = kind;
    node->children = arena_copy(w->scene->arena, children, (size_t)count * sizeof *children);
    node->child_count = count;
    return node;
}

static const Texture *paint(World *w, float red)
{
    Arena *arena = w->scene->arena;
    Pigment *pigment = ARENA_NEW(arena, Pigment);
    *pigment = (Pigment){.is_solid = true, .color = {.r = red}};
    const Finish standard = FINISH_DEFAULT;
    Layer *layer = ARENA_NEW(arena, Layer);
    *layer = (Layer){pigment, arena_copy(arena, &standard, sizeof standard)};
    Texture *texture = ARENA_NEW(arena, Texture);
    *texture = (Texture){.layers = layer, .layer_count = 1};
    return texture;
}

static float red_of(const Surface *surface)
{
    return surface->texture->layers[0].pigment->color.r;
}

static Node *lamp(World *w, V3 location)
{
    Node *node = node_new(w, NODE_LIGHT);
    node->light = ARENA_NEW(w->scene->arena, Light);
    *node->light = (Light){.location = location, .point_at = {0, 0, 1}, .color = RGB_WHITE};
    return node;
}

/* --- tests --------------------------------------------------------------------------------- */

static void test_empty_scene_is_good_and_warns(void **state)
{
    (void)state;
    World *w = world_new();
    assert_int_equal(finish(w), OK);
    assert_int_equal(w->scene->object_count, 0);
    assert_int_equal(w->scene->light_count, 0);
    assert_non_null(strstr(w->said, "no object"));
    world_free(w);
}

static void test_unions_dissolve_at_any_depth(void **state)
{
    (void)state;
    World *w = world_new();
    Node *inner[2] = {ball(w, v3(0, 0, 0)), ball(w, v3(3, 0, 0))};
    Node *outer[2] = {group(w, SHAPE_UNION, 2, inner), ball(w, v3(6, 0, 0))};
    scene_build_add(&w->build, group(w, SHAPE_UNION, 2, outer));
    assert_int_equal(finish(w), OK);
    assert_int_equal(w->scene->object_count, 3);
    assert_int_equal(w->scene->surface_count, 3);
    for (uint32_t i = 0; i < 3; i++) {
        const Object *object = &w->scene->objects[i];
        assert_int_equal(object->shape->kind, SHAPE_SPHERE);
        assert_int_equal(object->shape->surface, i);
        assert_int_equal(w->scene->surfaces[i].object, i);
        assert_true(fabs(bound_center(object->bound).x - 3.0 * i) < 1e-9);
        assert_string_equal(object->name, "sphere");
    }
    world_free(w);
}

static void test_named_union_lends_its_name(void **state)
{
    (void)state;
    World *w = world_new();
    Node *balls[2] = {ball(w, v3(0, 0, 0)), ball(w, v3(3, 0, 0))};
    balls[1]->name = "Inner";
    balls[1]->is_named = true;
    Node *both = group(w, SHAPE_UNION, 2, balls);
    both->name = "Glass";
    both->is_named = true;
    scene_build_add(&w->build, both);
    assert_int_equal(finish(w), OK);
    assert_string_equal(w->scene->objects[0].name, "Glass");
    assert_string_equal(w->scene->objects[1].name, "Inner");
    world_free(w);
}

static void test_clipped_and_inverted_unions_stay_whole(void **state)
{
    (void)state;
    World *w = world_new();
    Node *first[2] = {ball(w, v3(0, 0, 0)), ball(w, v3(1, 0, 0))};
    Node *clipped = group(w, SHAPE_UNION, 2, first);
    Node *clip[1] = {ball(w, v3(0.5, 0, 0))};
    clipped->clips = clip;
    clipped->clip_count = 1;
    Node *second[2] = {ball(w, v3(0, 0, 0)), ball(w, v3(1, 0, 0))};
    Node *inverted = group(w, SHAPE_UNION, 2, second);
    node_invert(inverted);
    scene_build_add(&w->build, clipped);
    scene_build_add(&w->build, inverted);
    assert_int_equal(finish(w), OK);
    assert_int_equal(w->scene->object_count, 2);
    assert_int_equal(w->scene->surface_count, 4);
    assert_int_equal(w->scene->objects[0].shape->clip_count, 1);
    assert_int_equal(w->scene->objects[1].shape->kind, SHAPE_INTERSECTION);
    assert_true(shape_is_inside(w->scene->objects[1].shape, v3(9, 9, 9)));
    assert_false(shape_is_inside(w->scene->objects[1].shape, v3(0, 0, 0)));
    /* The clip counts for the inside of the clipped one. */
    assert_false(shape_is_inside(w->scene->objects[0].shape, v3(-0.9, 0, 0)));
    assert_true(shape_is_inside(w->scene->objects[0].shape, v3(0.5, 0, 0)));
    world_free(w);
}

static void test_difference_of_one_is_that_one(void **state)
{
    (void)state;
    World *w = world_new();
    Node *only[1] = {ball(w, v3(0, 0, 0))};
    scene_build_add(&w->build, group(w, SHAPE_INTERSECTION, 1, only));
    assert_int_equal(finish(w), OK);
    assert_int_equal(w->scene->objects[0].shape->kind, SHAPE_SPHERE);
    world_free(w);
}

static void test_intersection_of_things_apart_is_nothing(void **state)
{
    (void)state;
    World *w = world_new();
    Node *apart[2] = {ball(w, v3(0, 0, 0)), ball(w, v3(9, 0, 0))};
    scene_build_add(&w->build, group(w, SHAPE_INTERSECTION, 2, apart));
    scene_build_add(&w->build, ball(w, v3(0, 0, 0)));
    assert_int_equal(finish(w), OK);
    assert_int_equal(w->scene->object_count, 1);
    assert_int_equal(w->scene->surface_count, 1);
    assert_int_equal(w->scene->objects[0].shape->surface, 0);
    assert_int_equal(w->scene->surfaces[0].object, 0);
    world_free(w);
}

static void test_children_take_what_they_lack(void **state)
{
    (void)state;
    World *w = world_new();
    Interior *glass = ARENA_NEW(w->scene->arena, Interior);
    *glass = INTERIOR_DEFAULT;
    glass->ior = 1.5;
    Interior *water = ARENA_NEW(w->scene->arena, Interior);
    *water = INTERIOR_DEFAULT;
    water->ior = 1.33;
    Node *children[3] = {ball(w, v3(0, 0, 0)), ball(w, v3(3, 0, 0)), ball(w, v3(6, 0, 0))};
    children[1]->texture = paint(w, 0.25f);
    children[1]->hollow = TRI_OFF;
    children[2]->interior = water;
    children[2]->has_photons = true;
    children[2]->photons = PHOTON_FLAGS_DEFAULT;
    children[2]->photons.is_collecting = false;
    children[2]->no_shadow = true;
    Node *parent = group(w, SHAPE_UNION, 3, children);
    parent->texture = paint(w, 0.5f);
    parent->interior = glass;
    parent->hollow = TRI_ON;
    parent->double_illuminate = TRI_ON;
    parent->no_image = true;
    parent->has_photons = true;
    parent->photons = PHOTON_FLAGS_DEFAULT;
    parent->photons.is_target = true;
    parent->photons.refraction = TRI_ON;
    scene_build_add(&w->build, parent);
    assert_int_equal(finish(w), OK);

    const Surface *s = w->scene->surfaces;
    assert_true(red_of(&s[0]) == 0.5f && red_of(&s[1]) == 0.25f && red_of(&s[2]) == 0.5f);
    assert_true(s[0].interior->ior == 1.5 && s[1].interior->ior == 1.5);
    assert_true(s[2].interior->ior == 1.33);
    assert_true(s[0].is_hollow && !s[1].is_hollow && s[2].is_hollow);
    assert_true(s[0].no_image && s[1].no_image && s[2].no_image);
    assert_true(!s[0].no_shadow && s[2].no_shadow);
    assert_true(s[0].is_double_illuminated && s[2].is_double_illuminated);
    assert_true(s[0].is_target && s[1].is_target && s[2].is_target);
    assert_true(s[2].photons.refraction == TRI_ON);
    assert_true(s[0].photons.is_collecting && !s[2].photons.is_collecting);
    assert_true(w->scene->objects[0].is_target);
    assert_true(w->scene->objects[0].no_image);
    world_free(w);
}

/* Measured with POV-Ray 3.7.0.10 by the photons it shoots. */
static void test_photon_items_of_parents_override(void **state)
{
    (void)state;
    World *w = world_new();
    Node *child = ball(w, v3(0, 0, 0));
    child->has_photons = true;
    child->photons = PHOTON_FLAGS_DEFAULT;
    child->photons.is_target = true;
    child->photons.refraction = TRI_ON;
    child->photons.reflection = TRI_ON;
    child->photons.is_collecting = false;
    Node *parent = group(w, SHAPE_UNION, 1, &child);
    parent->has_photons = true;
    parent->photons = PHOTON_FLAGS_DEFAULT;
    parent->photons.refraction = TRI_OFF;
    scene_build_add(&w->build, parent);
    assert_int_equal(finish(w), OK);
    const PhotonFlags *photons = &w->scene->surfaces[0].photons;
    assert_true(photons->is_target && !photons->is_collecting);
    assert_true(photons->refraction == TRI_OFF && photons->reflection == TRI_ON);
    world_free(w);
}

static void test_default_texture_is_that_of_the_placing(void **state)
{
    (void)state;
    World *w = world_new();
    scene_build_add(&w->build, ball(w, v3(0, 0, 0)));
    w->build.default_texture = paint(w, 0.75f);
    scene_build_add(&w->build, ball(w, v3(3, 0, 0)));
    assert_int_equal(finish(w), OK);
    assert_true(red_of(&w->scene->surfaces[0]) == 0);
    assert_true(red_of(&w->scene->surfaces[1]) == 0.75f);
    assert_true(w->scene->surfaces[0].texture->layers[0].finish->ambient.r == 0.1f);
    world_free(w);
}

static void test_old_ior_of_a_finish_makes_an_interior(void **state)
{
    (void)state;
    World *w = world_new();
    Node *node = ball(w, v3(0, 0, 0));
    Texture *texture = arena_copy(w->scene->arena, paint(w, 1), sizeof *texture);
    Finish *old = ARENA_NEW(w->scene->arena, Finish);
    *old = FINISH_DEFAULT;
    old->ior = 1.25f;
    Layer *layer = arena_copy(w->scene->arena, texture->layers, sizeof *layer);
    layer->finish = old;
    texture->layers = layer;
    node->texture = texture;
    scene_build_add(&w->build, node);
    assert_int_equal(finish(w), OK);
    assert_true(w->scene->surfaces[0].interior->ior == 1.25);
    world_free(w);
}

static void test_copies_are_deep(void **state)
{
    (void)state;
    World *w = world_new();
    Node *children[2] = {ball(w, v3(0, 0, 0)), lamp(w, v3(0, 5, 0))};
    Node *clip[1] = {ball(w, v3(0, 0, 0))};
    Node *node = group(w, SHAPE_UNION, 2, children);
    children[0]->clips = clip;
    children[0]->clip_count = 1;
    Node *copy = node_copy(w->scene->arena, node);
    assert_non_null(copy);
    Xform move = xform_translate(v3(10, 0, 0));
    assert_true(node_transform(w->scene->arena, copy, &move));
    assert_true(shape_is_inside(copy->children[0]->shape, v3(10, 0, 0)));
    assert_true(shape_is_inside(copy->children[0]->clips[0]->shape, v3(10, 0, 0)));
    assert_true(copy->children[1]->light->location.x == 10);
    assert_true(shape_is_inside(node->children[0]->shape, v3(0, 0, 0)));
    assert_true(shape_is_inside(clip[0]->shape, v3(0, 0, 0)));
    assert_true(node->children[1]->light->location.x == 0);
    world_free(w);
}

static void test_textures_move_with_what_was_written_before(void **state)
{
    (void)state;
    World *w = world_new();
    Pigment *pigment = ARENA_NEW(w->scene->arena, Pigment);
    static const MapEntry map[2] = {{0, {0}}, {1, {.r = 1}}};
    *pigment = (Pigment){.pattern = {.kind = PATTERN_GRADIENT,
                                     .direction = {1, 0, 0},
                                     .frequency = 1,
                                     .xform = XFORM_IDENTITY},
                         .map = map,
                         .map_count = 2};
    Texture *texture = arena_copy(w->scene->arena, paint(w, 1), sizeof *texture);
    Layer *layer = arena_copy(w->scene->arena, texture->layers, sizeof *layer);
    layer->pigment = pigment;
    texture->layers = layer;
    Node *child = ball(w, v3(0, 0, 0)), *children[1] = {child};
    child->texture = texture;
    Node *parent = group(w, SHAPE_UNION, 1, children);
    Xform move = xform_translate(v3(0.25, 0, 0));
    assert_true(node_transform(w->scene->arena, parent, &move));
    const Pigment *moved = child->texture->layers[0].pigment;
    assert_true(fabsf(pigment_at(pigment, v3(0.5, 0, 0)).r - 0.5f) < 1e-6f);
    assert_true(fabsf(pigment_at(moved, v3(0.75, 0, 0)).r - 0.5f) < 1e-6f);
    world_free(w);
}

static void test_lights_come_out_of_objects(void **state)
{
    (void)state;
    World *w = world_new();
    Node *inside[3] = {lamp(w, v3(0, 1, 0)), ball(w, v3(0, 0, 0)), ball(w, v3(0.5, 0, 0))};
    Node *named = lamp(w, v3(0, 2, 0));
    named->name = "Sun";
    named->is_named = true;
    scene_build_add(&w->build, named);
    scene_build_add(&w->build, group(w, SHAPE_INTERSECTION, 3, inside));
    assert_int_equal(finish(w), OK);
    assert_int_equal(w->scene->light_count, 2);
    assert_string_equal(w->scene->lights[0].name, "Sun");
    assert_string_equal(w->scene->lights[1].name, "light 2");
    assert_int_equal(w->scene->objects[0].shape->child_count, 2);
    world_free(w);
}

static void test_lamps_look_like_objects_without_shadow(void **state)
{
    (void)state;
    World *w = world_new();
    Node *bulb = ball(w, v3(0, 5, 0)), *shining = lamp(w, v3(0, 5, 0));
    shining->children = &bulb;
    shining->child_count = 1;
    Node *inside[3] = {ball(w, v3(0, 0, 0)), shining, ball(w, v3(0.5, 0, 0))};
    Node *both = group(w, SHAPE_INTERSECTION, 3, inside);
    both->texture = paint(w, 0.5f);
    Xform move = xform_translate(v3(1, 0, 0));
    assert_true(node_transform(w->scene->arena, both, &move));
    scene_build_add(&w->build, both);
    assert_int_equal(finish(w), OK);
    assert_int_equal(w->scene->light_count, 1);
    assert_int_equal(w->scene->object_count, 2);
    assert_int_equal(w->scene->surface_count, 3);
    assert_true(w->scene->objects[1].no_shadow && !w->scene->objects[0].no_shadow);
    assert_int_equal(w->scene->surfaces[2].object, 1);
    assert_true(shape_is_inside(w->scene->objects[1].shape, v3(1, 5, 0)));
    world_free(w);
}

static void test_light_moves_with_its_aim_and_area(void **state)
{
    (void)state;
    World *w = world_new();
    Node *node = lamp(w, v3(0, 0, 0));
    node->light->area.axis1 = v3(1, 0, 0);
    Xform turn = xform_rotate(v3(0, 0, PMS_PI / 2)), move = xform_translate(v3(0, 0, 7));
    Xform both = xform_then(&turn, &move);
    assert_true(node_transform(w->scene->arena, node, &both));
    assert_true(v3_dist(node->light->location, v3(0, 0, 7)) < 1e-12);
    assert_true(v3_dist(node->light->direction, v3(0, 0, 1)) < 1e-12);
    assert_true(v3_dist(node->light->area.axis1, v3(0, 1, 0)) < 1e-12);
    world_free(w);
}

static void test_user_bounds_serve_infinite_objects_only(void **state)
{
    (void)state;
    World *w = world_new();
    Arena *arena = w->scene->arena;
    Node *box = node_new(w, NODE_LEAF);
    box->shape = shape_box(arena, v3(-5, -5, -5), v3(5, 5, 5));
    Node *small = node_new(w, NODE_LEAF);
    small->shape = shape_box(arena, v3(0, 0, 0), v3(0.1, 0.1, 0.1));
    Node *plane = node_new(w, NODE_LEAF);
    plane->shape = shape_plane(arena, v3(0, 1, 0), 0);
    Node *free_plane = node_copy(arena, plane);
    Node *finite = ball(w, v3(0, 0, 0));
    plane->bounds = &box;
    plane->bound_count = 1;
    finite->bounds = &small;
    finite->bound_count = 1;
    scene_build_add(&w->build, plane);
    scene_build_add(&w->build, finite);
    scene_build_add(&w->build, free_plane);
    assert_int_equal(finish(w), OK);
    assert_true(bound_is_finite(w->scene->objects[0].bound));
    assert_true(w->scene->objects[0].bound.hi.x < 5.1);
    assert_true(w->scene->objects[1].bound.lo.x <= -1);
    assert_false(bound_is_finite(w->scene->objects[2].bound));
    world_free(w);
}

/* --- targets and problems ------------------------------------------------------------------ */

static Node *mirror_ball(World *w, V3 center)
{
    Node *node = ball(w, center);
    Texture *texture = arena_copy(w->scene->arena, paint(w, 1), sizeof *texture);
    Finish *shiny = ARENA_NEW(w->scene->arena, Finish);
    *shiny = FINISH_DEFAULT;
    shiny->reflection_min = shiny->reflection_max = RGB_WHITE;
    Layer *layer = arena_copy(w->scene->arena, texture->layers, sizeof *layer);
    layer->finish = shiny;
    texture->layers = layer;
    node->texture = texture;
    return node;
}

static void test_specular_objects_become_targets_when_none_is_marked(void **state)
{
    (void)state;
    World *w = world_new();
    w->scene->settings.photons.is_on = true;
    scene_build_add(&w->build, ball(w, v3(0, 0, 0)));
    scene_build_add(&w->build, mirror_ball(w, v3(3, 0, 0)));
    Node *off = mirror_ball(w, v3(6, 0, 0));
    off->has_photons = true;
    off->photons = PHOTON_FLAGS_DEFAULT;
    off->photons.reflection = TRI_OFF;
    scene_build_add(&w->build, off);
    assert_int_equal(finish(w), OK);
    const Surface *s = w->scene->surfaces;
    assert_false(s[0].is_target);
    assert_true(s[1].is_target && s[1].photons.reflection == TRI_ON);
    assert_false(s[2].is_target);
    assert_true(s[1].may_reflect && !s[0].may_reflect && !s[1].may_transmit);
    world_free(w);
}

static Node *ball_of(World *w, double ior, float caustics)
{
    Node *node = ball(w, v3(0, 0, 0));
    Interior interior = {.ior = ior, .caustics = caustics};
    node->interior = arena_copy(w->scene->arena, &interior, sizeof interior);
    return node;
}

static void test_filters_bend_nothing_and_take_nothing_for_a_mirror(void **state)
{
    (void)state;
    World *w = world_new();
    scene_build_add(&w->build, ball(w, v3(0, 0, 0)));
    scene_build_add(&w->build, ball_of(w, 1, 0));
    scene_build_add(&w->build, ball_of(w, 1.5, 0));
    scene_build_add(&w->build, ball_of(w, 1, 0.5f));
    scene_build_add(&w->build, mirror_ball(w, v3(0, 0, 0)));
    Node *saving = mirror_ball(w, v3(0, 0, 0));
    Finish *finish_of_it = (Finish *)(uintptr_t)saving->texture->layers[0].finish;
    finish_of_it->conserves_energy = true;
    scene_build_add(&w->build, saving);
    assert_int_equal(finish(w), OK);
    const Surface *s = w->scene->surfaces;
    assert_true(s[0].is_filter && s[1].is_filter && s[4].is_filter);
    assert_false(s[2].is_filter || s[3].is_filter || s[5].is_filter);
    world_free(w);
}

static void test_no_target_without_photons(void **state)
{
    (void)state;
    World *w = world_new();
    scene_build_add(&w->build, mirror_ball(w, v3(3, 0, 0)));
    assert_int_equal(finish(w), OK);
    assert_false(w->scene->surfaces[0].is_target);
    assert_true(w->said[0] == 0);
    world_free(w);
}

static void test_marked_target_rules_out_the_others(void **state)
{
    (void)state;
    World *w = world_new();
    w->scene->settings.photons.is_on = true;
    Node *marked = mirror_ball(w, v3(0, 0, 0));
    marked->has_photons = true;
    marked->photons = PHOTON_FLAGS_DEFAULT;
    marked->photons.is_target = true;
    marked->photons.reflection = TRI_ON;
    scene_build_add(&w->build, mirror_ball(w, v3(3, 0, 0)));
    scene_build_add(&w->build, marked);
    assert_int_equal(finish(w), OK);
    assert_false(w->scene->surfaces[0].is_target);
    assert_true(w->scene->surfaces[1].is_target);
    world_free(w);
}

static void test_problems_of_camera_and_lights(void **state)
{
    (void)state;
    World *w = world_new();
    scene_build_add(&w->build, ball(w, v3(0, 0, 0)));
    Node *aimless = lamp(w, v3(0, 0, 1));
    aimless->light->kind = LIGHT_SPOT;
    scene_build_add(&w->build, aimless);
    Node *dark = lamp(w, v3(0, 5, 0));
    dark->light->color = RGB_BLACK;
    scene_build_add(&w->build, dark);
    w->scene->camera.right = v3(0, 0, 1);
    assert_int_equal(finish(w), ERR_SCENE);
    /* Every problem is reported, not only the first. */
    assert_non_null(strstr(w->said, "lie in one plane"));
    assert_non_null(strstr(w->said, "no direction"));
    assert_non_null(strstr(w->said, "black"));
    assert_int_equal(w->diag.errors, 2);
    world_free(w);
}

static void test_huge_and_tiny_cameras_are_fine(void **state)
{
    (void)state;
    static const double sizes[] = {1e-200, 1e-12, 1, 1e12, 1e200};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        World *w = world_new();
        scene_build_add(&w->build, ball(w, v3(0, 0, 0)));
        w->scene->camera.right = v3(sizes[i], 0, 0);
        w->scene->camera.up = v3(0, sizes[i], 0);
        w->scene->camera.direction = v3(0, 0, sizes[i]);
        assert_int_equal(finish(w), OK);
        assert_true(w->said[0] == 0);
        world_free(w);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_empty_scene_is_good_and_warns),
        cmocka_unit_test(test_unions_dissolve_at_any_depth),
        cmocka_unit_test(test_named_union_lends_its_name),
        cmocka_unit_test(test_clipped_and_inverted_unions_stay_whole),
        cmocka_unit_test(test_difference_of_one_is_that_one),
        cmocka_unit_test(test_intersection_of_things_apart_is_nothing),
        cmocka_unit_test(test_children_take_what_they_lack),
        cmocka_unit_test(test_photon_items_of_parents_override),
        cmocka_unit_test(test_default_texture_is_that_of_the_placing),
        cmocka_unit_test(test_old_ior_of_a_finish_makes_an_interior),
        cmocka_unit_test(test_copies_are_deep),
        cmocka_unit_test(test_textures_move_with_what_was_written_before),
        cmocka_unit_test(test_lights_come_out_of_objects),
        cmocka_unit_test(test_lamps_look_like_objects_without_shadow),
        cmocka_unit_test(test_light_moves_with_its_aim_and_area),
        cmocka_unit_test(test_user_bounds_serve_infinite_objects_only),
        cmocka_unit_test(test_specular_objects_become_targets_when_none_is_marked),
        cmocka_unit_test(test_filters_bend_nothing_and_take_nothing_for_a_mirror),
        cmocka_unit_test(test_no_target_without_photons),
        cmocka_unit_test(test_marked_target_rules_out_the_others),
        cmocka_unit_test(test_problems_of_camera_and_lights),
        cmocka_unit_test(test_huge_and_tiny_cameras_are_fine),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
