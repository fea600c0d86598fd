/* Surfaces: reflection, refraction, absorption, textures, against povray 3.7 where it sets the
 * rule: the numbers are its 16-bit pixels of the same scene.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/trace.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "world.h"

#define DEG (PMS_PI / 180)

/* --- reflection ---------------------------------------------------------------------------- */

static Rgb mirror_at(double degrees, const Finish *finish, Color5 color, double ior)
{
    World w;
    world_init(&w);
    w.scene.background.color = (Color5){1, 1, 1, 0, 0};
    Interior interior = {.ior = ior};
    V3 normal = v3(sin(degrees * DEG), 0, -cos(degrees * DEG));
    world_add(&w, shape_plane(w.scene.arena, normal, 0), flat(&w, color, finish), &interior);
    world_ready(&w);
    Rgb seen = look(&w);
    world_done(&w);
    return seen;
}

static void test_fresnel_reflection(void **state)
{
    (void)state;
    Finish finish = dull;
    finish.reflection_min = rgb(0.1f, 0.05f, 0);
    finish.reflection_max = rgb(1, 0.9f, 0.8f);
    finish.is_fresnel = true;
    Color5 black = {0, 0, 0, 0, 0};
    check_rgb(mirror_at(0, &finish, black, 1.5), 0.13600, 0.08400, 0.03200);
    check_rgb(mirror_at(30, &finish, black, 1.5), 0.13738, 0.08530, 0.03322);
    check_rgb(mirror_at(60, &finish, black, 1.5), 0.18027, 0.12581, 0.07135);
    check_rgb(mirror_at(80, &finish, black, 1.5), 0.44894, 0.37955, 0.31017);
}

static void test_reflection_falloff(void **state)
{
    (void)state;
    Finish finish = dull;
    finish.reflection_min = rgb(0.1f, 0.2f, 0.3f);
    finish.reflection_max = rgb(0.9f, 0.8f, 0.7f);
    finish.reflection_falloff = 3;
    Color5 black = {0, 0, 0, 0, 0};
    check_rgb(mirror_at(0, &finish, black, 1), 0.10001, 0.20000, 0.30001);
    check_rgb(mirror_at(30, &finish, black, 1), 0.10193, 0.20145, 0.30097);
    check_rgb(mirror_at(80, &finish, black, 1), 0.55143, 0.53857, 0.52572);
}

static void test_metallic_reflection(void **state)
{
    (void)state;
    Finish finish = dull;
    finish.reflection_min = finish.reflection_max = rgb_gray(0.8f);
    finish.reflection_metallic = 0.7f;
    Color5 brass = {0.9f, 0.5f, 0.2f, 0, 0};
    check_rgb(mirror_at(0, &finish, brass, 1), 0.74400, 0.52000, 0.35200);
    check_rgb(mirror_at(60, &finish, brass, 1), 0.74733, 0.53660, 0.37855);
    check_rgb(mirror_at(80, &finish, brass, 1), 0.75862, 0.59312, 0.46899);
}

static void test_iridescent_reflection(void **state)
{
    (void)state;
    Finish finish = dull;
    finish.reflection_min = finish.reflection_max = rgb_gray(0.25f);
    finish.irid = 0.5f;
    finish.irid_thickness = 0.3f;
    check_rgb(mirror_at(0, &finish, (Color5){0, 0, 0, 0, 0}, 1), 0.32793, 0.32100, 0.25);
}

/* The bottom layer's mirror is not filtered, and not seen at all under an opaque layer. */
static void test_mirror_under_a_layer(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    w.scene.background.color = (Color5){1, 1, 1, 0, 0};
    Finish mirror = dull, glow = dull;
    mirror.reflection_min = mirror.reflection_max = rgb_gray(0.5f);
    glow.ambient = RGB_WHITE;
    const Texture *bottom = flat(&w, (Color5){0, 0, 0, 0, 0}, &mirror);
    const Texture *half = flat(&w, (Color5){0, 0, 0.5f, 0, 0.5f}, &glow);
    const Texture *opaque = flat(&w, (Color5){0, 0, 0.5f, 0, 0}, &glow);
    Surface *surface =
        world_add(&w, box(&w, v3(-1, -1, -1), v3(1, 1, 1)), two_layers(&w, bottom, half), &air);
    world_ready(&w);
    check_rgb(look(&w), 0.5, 0.5, 0.75);
    surface->texture = two_layers(&w, bottom, opaque);
    check_rgb(look(&w), 0, 0, 0.5);
    world_done(&w);
}

static void test_layers(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    w.scene.background.color = (Color5){1, 0.5f, 0.25f, 0, 0};
    Finish low = dull, high = dull;
    low.ambient = rgb_gray(0.5f);
    low.reflection_min = low.reflection_max = rgb_gray(0.2f);
    high.ambient = rgb_gray(0.3f);
    high.reflection_min = high.reflection_max = rgb_gray(0.1f);
    high.conserves_energy = true;
    const Texture *bottom = flat(&w, (Color5){0.9f, 0.8f, 0.7f, 0.3f, 0.2f}, &low);
    const Texture *top = flat(&w, (Color5){0.2f, 0.5f, 0.9f, 0.6f, 0.1f}, &high);
    world_add(&w, box(&w, v3(-9, -9, 0), v3(9, 9, 1)), two_layers(&w, bottom, top), &air);
    world_ready(&w);
    w.scene.settings.max_trace_level = 2;
    check_rgb(look(&w), 0.37877, 0.30364, 0.32656);
    w.scene.settings.max_trace_level = 1;
    check_rgb(look(&w), 0.06255, 0.11701, 0.18180);
    world_done(&w);
}

/* Filter weighs with the strongest channel before 3.7: 1 - 0.8 * 0.9 instead of 1 - 0.8. */
static void test_opacity_of_old_versions(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    Finish finish = dull;
    finish.ambient = rgb_gray(0.5f);
    const Texture *filter = flat(&w, (Color5){0.6f, 0.9f, 0.7f, 0.8f, 0}, &finish);
    world_add(&w, box(&w, v3(-9, -9, 0), v3(9, 9, 1)), filter, &air);
    world_ready(&w);
    w.scene.settings.max_trace_level = 1;
    check_rgb(look(&w), 0.06, 0.09, 0.07);
    w.scene.settings.version = 3.5;
    check_rgb(look(&w), 0.084, 0.126, 0.098);
    world_done(&w);
}

/* --- transmission -------------------------------------------------------------------------- */

static const Texture *fresnel_glass(World *w, bool conserves_energy)
{
    Finish finish = dull;
    finish.reflection_max = RGB_WHITE;
    finish.is_fresnel = true;
    finish.conserves_energy = conserves_energy;
    return flat(w, (Color5){1, 1, 1, 0, 1}, &finish);
}

static Rgb through_slabs(int count, bool conserves_energy, int max_level)
{
    World w;
    world_init(&w);
    w.scene.settings.max_trace_level = max_level;
    const Interior crown = {.ior = 1.5}, heavy = {.ior = 2};
    world_add(&w, box(&w, v3(-90, -90, 50), v3(90, 90, 51)), emitter(&w, 1, 0.5f, 0.25f), &air);
    const Texture *glass = fresnel_glass(&w, conserves_energy);
    world_add(&w, box(&w, v3(-9, -9, 0), v3(9, 9, 1)), glass, &crown);
    if (count > 1)
        world_add(&w, box(&w, v3(-9, -9, 3), v3(9, 9, 4)), glass, &heavy);
    world_ready(&w);
    Rgb seen = look(&w);
    world_done(&w);
    return seen;
}

static void test_fresnel_slabs(void **state)
{
    (void)state;
    check_rgb(through_slabs(1, true, 2), 0, 0, 0);
    check_rgb(through_slabs(1, true, 3), 0.92160, 0.46081, 0.23040);
    check_rgb(through_slabs(1, true, 10), 0.92160, 0.46081, 0.23040);
    check_rgb(through_slabs(1, false, 5), 1, 0.5, 0.25);
    check_rgb(through_slabs(2, true, 20), 0.73716, 0.36858, 0.18430);
}

/* Into a right-angled prism, off its slope, out of its side; both legs absorb. */
static void test_total_reflection(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    Arena *arena = w.scene.arena;
    const Interior glass = {
        .ior = 1.5, .fade_distance = 1, .fade_power = 1000, .fade_color = {0.5f, 0.8f, 1}};
    Shape *sides[3] = {shape_plane(arena, v3(0, 0, -1), 0), shape_plane(arena, v3(1, 0, 0), 0.5),
                       shape_plane(arena, v3_unit(v3(-1, 0, 1)), 0.5 * sqrt(0.5))};
    Shape *prism = shape_csg(arena, SHAPE_INTERSECTION, sides, 3);
    world_add(&w, prism, clear(&w), &glass);
    world_add(&w, box(&w, v3(5, -90, -90), v3(6, 90, 90)), emitter(&w, 1, 0.5f, 0.25f), &air);
    world_ready(&w);
    w.scene.settings.max_trace_level = 3;
    check_rgb(look(&w), 0, 0, 0);
    w.scene.settings.max_trace_level = 4;
    check_rgb(look(&w), 0.60653, 0.40937, 0.25);
    world_done(&w);
}

/* A gradient from 0 at x = -2 to 1 at x = 2, behind everything. */
static void add_ruler(World *w)
{
    static const MapEntry map[] = {{0, {0, 0, 0, 0, 0}}, {1, {1, 1, 1, 0, 0}}};
    Arena *arena = w->scene.arena;
    Pigment pigment = {.map = map, .map_count = 2};
    pigment.pattern = (Pattern){.kind = PATTERN_GRADIENT, .direction = {1, 0, 0}, .frequency = 1};
    Xform grow = xform_scale(v3(4, 4, 4)), move = xform_translate(v3(-2, 0, 0));
    pigment.pattern.xform = xform_then(&grow, &move);
    pigment.pattern.is_transformed = true;
    Finish *glow = arena_copy(arena, &dull, sizeof dull);
    glow->ambient = RGB_WHITE;
    Layer layer = {arena_copy(arena, &pigment, sizeof pigment), glow};
    Texture texture = {.layers = arena_copy(arena, &layer, sizeof layer), .layer_count = 1};
    world_add(w, box(w, v3(-9, -9, 9), v3(9, 9, 10)), arena_copy(arena, &texture, sizeof texture),
              &air);
}

static void test_tilted_slab_displaces(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    add_ruler(&w);
    const Interior glass = {.ior = 1.5};
    Shape *slab = box(&w, v3(-9, -9, 0), v3(9, 9, 1));
    Xform turn = xform_rotate(v3(0, 40 * DEG, 0));
    shape_transform(slab, &turn);
    world_add(&w, slab, clear(&w), &glass);
    world_ready(&w);
    check_rgb(look(&w), 0.56986, 0.56986, 0.56986);
    world_done(&w);
}

static void test_spheres_bend(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    add_ruler(&w);
    Interior outer = {.ior = 1.3}, inner = {.ior = 1.2};
    world_add(&w, shape_sphere(w.scene.arena, v3(-0.5, 0, 0), 1), clear(&w), &outer);
    world_ready(&w);
    check_rgb(look(&w), 0.91145, 0.91145, 0.91145);
    trace_thread_done(&w.thread);
    tracer_free(w.tracer);
    /* one in the other: the way out of the inner leads into the outer */
    outer.ior = 1.5;
    world_add(&w, shape_sphere(w.scene.arena, v3(-0.5, 0, 0), 0.8), clear(&w), &inner);
    world_ready(&w);
    check_rgb(look(&w), 0.20368, 0.20368, 0.20368);
    world_done(&w);
}

/* Every leg inside absorbs by what it is in, whatever it ends at.  (In POV-Ray only legs that end
 * where the ray leaves do: .90484 and .74083 for the last two.) */
static void test_nested_absorption(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    Interior a = fading(rgb(0.9f, 1, 1)), b = fading(rgb(1, 0.9f, 1));
    world_add(&w, box(&w, v3(-2, -2, -2), v3(2, 2, 2)), clear(&w), &a);
    world_add(&w, box(&w, v3(-9, -9, 50), v3(9, 9, 51)), emitter(&w, 1, 1, 1), &air);
    world_ready(&w);
    check_rgb(look(&w), 0.67032, 1, 1);
    trace_thread_done(&w.thread);
    tracer_free(w.tracer);
    world_add(&w, box(&w, v3(-1, -1, -1), v3(1, 1, 1)), clear(&w), &b);
    world_ready(&w);
    check_rgb(look(&w), 0.81873, 0.81873, 1);
    world_done(&w);
}

static void test_mirror_inside_absorbs_both_ways(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    w.scene.background.color = (Color5){1, 1, 1, 0, 0};
    Interior a = fading(rgb(0.9f, 1, 1));
    Finish mirror = dull;
    mirror.reflection_min = mirror.reflection_max = RGB_WHITE;
    world_add(&w, box(&w, v3(-2, -2, -2), v3(2, 2, 2)), clear(&w), &a);
    world_add(&w, box(&w, v3(-1, -1, 1), v3(1, 1, 1.5)), flat(&w, (Color5){0, 0, 0, 0, 0}, &mirror),
              &air);
    world_ready(&w);
    check_rgb(look(&w), 0.54881, 1, 1);
    world_done(&w);
}

/* Where a ray from <0,0,-1> along d meets the ruler. */
static double ruler_x(World *w, V3 d)
{
    Ray ray = {{0, 0, -1}, d, 0, INFINITY};
    Interiors inside = {.count = 0};
    return 4 * (double)look_along(w, &ray, RAY_CAMERA, &inside, 0, 1, false).r - 2;
}

/* Union members that overlap: their inner walls bend nothing. */
static void test_overlapping_glass_is_one_glass(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    add_ruler(&w);
    const Interior glass = {.ior = 1.5};
    w.scene.settings.max_trace_level = 10;
    world_add(&w, box(&w, v3(-9, -9, 0), v3(9, 9, 1)), clear(&w), &glass);
    world_add(&w, box(&w, v3(-9, -9, 0.5), v3(9, 9, 2)), clear(&w), &glass);
    world_ready(&w);
    for (int i = 0; i < 3; i++) {
        V3 d = v3_unit(v3(0.05 * i, 0, 1));
        double sine = d.x / 1.5, in_glass = 2 * sine / sqrt(1 - sine * sine);
        assert_true(fabs(ruler_x(&w, d) - (8 * d.x / d.z + in_glass)) < 1e-6);
    }
    world_done(&w);
}

/* Glass and water that share a face: the ray passes from one into the other, whichever was
 * written first. */
static void test_touching_media(void **state)
{
    (void)state;
    const Interior glass = {.ior = 1.5}, water = {.ior = 1.33};
    V3 d = v3_unit(v3(0.2, 0, 1));
    double in_glass = d.x / 1.5, in_water = d.x / 1.33;
    double expected = 7 * d.x / d.z + in_glass / sqrt(1 - in_glass * in_glass) +
                      2 * in_water / sqrt(1 - in_water * in_water);
    for (int order = 0; order < 2; order++) {
        World w;
        world_init(&w);
        add_ruler(&w);
        Shape *a = box(&w, v3(-9, -9, 0), v3(9, 9, 1)), *b = box(&w, v3(-9, -9, 1), v3(9, 9, 3));
        if (order)
            world_add(&w, b, clear(&w), &water);
        world_add(&w, a, clear(&w), &glass);
        if (!order)
            world_add(&w, b, clear(&w), &water);
        world_ready(&w);
        assert_true(fabs(ruler_x(&w, d) - expected) < 1e-6);
        world_done(&w);
    }
}

/* The same glass as one union of two touching boxes. */
static void test_wall_inside_a_union(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    add_ruler(&w);
    const Interior glass = {.ior = 1.5};
    Shape *halves[2] = {box(&w, v3(-9, -9, 0), v3(9, 9, 1)), box(&w, v3(-9, -9, 1), v3(9, 9, 3))};
    world_add(&w, shape_csg(w.scene.arena, SHAPE_UNION, halves, 2), clear(&w), &glass);
    world_ready(&w);
    V3 d = v3_unit(v3(0.2, 0, 1));
    double in_glass = d.x / 1.5;
    double expected = 7 * d.x / d.z + 3 * in_glass / sqrt(1 - in_glass * in_glass);
    assert_true(fabs(ruler_x(&w, d) - expected) < 1e-6);
    world_done(&w);
}

/* Glass that stands on a table shows the table. */
static void test_glass_on_a_table(void **state)
{
    (void)state;
    for (int order = 0; order < 2; order++) {
        World w;
        world_init(&w);
        const Interior glass = {.ior = 1.5};
        Shape *block = box(&w, v3(-1, -1, 0), v3(1, 1, 1));
        Shape *table = shape_plane(w.scene.arena, v3(0, 0, -1), -1);
        const Texture *tinted = flat(&w, (Color5){0.5f, 1, 1, 1, 0}, &dull);
        if (order)
            world_add(&w, table, emitter(&w, 1, 0.5f, 0.25f), &air);
        world_add(&w, block, tinted, &glass);
        if (!order)
            world_add(&w, table, emitter(&w, 1, 0.5f, 0.25f), &air);
        world_ready(&w);
        /* the bottom face filters once more when it is written first */
        check_rgb(look(&w), order ? 0.5 : 0.25, 0.5, 0.25);
        world_done(&w);
    }
}

/* --- which texture -------------------------------------------------------------------------- */

static void test_interior_texture(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    Surface *surface = world_add(&w, box(&w, v3(-2, -2, -2), v3(2, 2, 2)), clear(&w), &air);
    surface->inner_texture = emitter(&w, 0.25f, 0.5f, 1);
    world_ready(&w);
    check_rgb(look(&w), 0.25, 0.5, 1);
    world_done(&w);
}

static void test_mesh_textures(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    Arena *arena = w.scene.arena;
    V3 vertices[4] = {{-1, -1, 0}, {1, -1, 0}, {-1, 1, 0}, {1, 1, 0}};
    uint32_t corners[6] = {0, 1, 2, 2, 1, 3}, textures[6] = {0, 0, 1, MESH_NO_TEXTURE, 0, 0};
    MeshData mesh = {.vertices = vertices,
                     .vertex_count = 4,
                     .corners = corners,
                     .triangle_count = 2,
                     .textures = textures};
    textures[3] = textures[4] = textures[5] = MESH_NO_TEXTURE;
    assert_int_equal(mesh_index(&w.diag, &mesh, 1), OK);
    const Texture *list[2] = {emitter(&w, 1, 0, 0), emitter(&w, 0, 1, 0)};
    Surface *surface = world_add(&w, shape_mesh(arena, &mesh), emitter(&w, 0, 0, 1), &air);
    surface->part_textures = list;
    world_ready(&w);
    /* barycentrics of corner 2, the green one: (y+1)/2 */
    Interiors inside = {.count = 0};
    Ray ray = {{-0.5, -0.5, -10}, {0, 0, 1}, 0, INFINITY};
    check_rgb(look_along(&w, &ray, RAY_CAMERA, &inside, 0, 1, false), 0.75, 0.25, 0);
    ray.o = v3(0.5, 0.5, -10);
    check_rgb(look_along(&w, &ray, RAY_CAMERA, &inside, 0, 1, false), 0, 0, 1);
    world_done(&w);
    mesh_done(&mesh);
}

/* A cut shows the mean of the solids around the point, or its own texture where there is none. */
static void test_cutaway(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    Arena *arena = w.scene.arena;
    const Shape *solids[2] = {shape_sphere(arena, v3(-1, 0, 0), 2),
                              shape_sphere(arena, v3(1, 0, 0), 2)};
    const Texture *list[2] = {emitter(&w, 1, 0, 0), emitter(&w, 0, 1, 0)};
    const Cutaway cutaway = {solids, list, 2};
    Surface *surface =
        world_add(&w, box(&w, v3(-9, -9, 0), v3(9, 9, 1)), emitter(&w, 0, 0, 1), &air);
    surface->part_textures = list;
    surface->cutaway = &cutaway;
    world_ready(&w);
    Interiors inside = {.count = 0};
    Ray ray = {{0, 0, -10}, {0, 0, 1}, 0, INFINITY};
    check_rgb(look_along(&w, &ray, RAY_CAMERA, &inside, 0, 1, false), 0.5, 0.5, 0);
    ray.o.x = -2;
    check_rgb(look_along(&w, &ray, RAY_CAMERA, &inside, 0, 1, false), 1, 0, 0);
    ray.o.x = 5;
    check_rgb(look_along(&w, &ray, RAY_CAMERA, &inside, 0, 1, false), 0, 0, 1);
    world_done(&w);
}

static void test_smooth_normal_at_a_silhouette(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    V3 corner[3] = {{-9, -9, -52}, {9, -9, 52}, {0, 9, 0}}; /* seen at a slant */
    V3 normal[3];
    for (int i = 0; i < 3; i++)
        normal[i] = v3_unit(v3(1, 0, 0.05)); /* looks away from the eye */
    world_add(&w, shape_triangle(w.scene.arena, corner, normal), emitter(&w, 1, 1, 1), &air);
    world_ready(&w);
    Ray ray = {{0, 0, -100}, {0, 0, 1}, 0, INFINITY};
    Hit hit;
    SurfaceSample s;
    Interiors inside = {.count = 0};
    assert_true(trace_closest(&w.thread, &ray, RAY_CAMERA, &hit));
    surface_sample(&w.thread, &ray, &hit, &inside, &s);
    assert_true(v3_dot(s.ng, s.wo) > 0 && v3_dot(s.layers[0].n, s.ng) > 0);
    assert_true(v3_dot(s.layers[0].n, s.wo) > -1e-15);
    assert_true(fabs(v3_len(s.layers[0].n) - 1) < 1e-15);
    world_done(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fresnel_reflection),
        cmocka_unit_test(test_reflection_falloff),
        cmocka_unit_test(test_metallic_reflection),
        cmocka_unit_test(test_iridescent_reflection),
        cmocka_unit_test(test_mirror_under_a_layer),
        cmocka_unit_test(test_layers),
        cmocka_unit_test(test_opacity_of_old_versions),
        cmocka_unit_test(test_fresnel_slabs),
        cmocka_unit_test(test_total_reflection),
        cmocka_unit_test(test_tilted_slab_displaces),
        cmocka_unit_test(test_spheres_bend),
        cmocka_unit_test(test_nested_absorption),
        cmocka_unit_test(test_mirror_inside_absorbs_both_ways),
        cmocka_unit_test(test_overlapping_glass_is_one_glass),
        cmocka_unit_test(test_touching_media),
        cmocka_unit_test(test_wall_inside_a_union),
        cmocka_unit_test(test_glass_on_a_table),
        cmocka_unit_test(test_interior_texture),
        cmocka_unit_test(test_mesh_textures),
        cmocka_unit_test(test_cutaway),
        cmocka_unit_test(test_smooth_normal_at_a_silhouette),
    };
    return cmocka_run_group_tests_name("surface_sample", tests, NULL, NULL);
}
