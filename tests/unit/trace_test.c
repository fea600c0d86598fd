/* Nearest hits, surfaces, interiors and shadows, against povray 3.7 where it sets the rule: the
 * numbers are its 16-bit pixels of the same scene.  SPDX-License-Identifier: Apache-2.0 */
#include "math/sample.h"
#include "trace/trace.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "world.h"

#define TOLERANCE 1.6e-5 /* half a step of 16 bits, five digits, float colours */
#define DEG (PMS_PI / 180)

static void check_rgb(Rgb c, double r, double g, double b)
{
    if (!(fabs((double)c.r - r) < TOLERANCE && fabs((double)c.g - g) < TOLERANCE &&
          fabs((double)c.b - b) < TOLERANCE))
        fail_msg("got %.5f %.5f %.5f, wanted %.5f %.5f %.5f", (double)c.r, (double)c.g, (double)c.b,
                 r, g, b);
}

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

static Interior fading(Rgb color)
{
    return (Interior){.ior = 1, .fade_distance = 1, .fade_power = 1000, .fade_color = color};
}

/* Absorption happens where a ray leaves, over the stretch since the last surface. */
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
    check_rgb(look(&w), 0.90484, 0.81874, 1);
    world_done(&w);
}

static void test_mirror_inside_absorbs_on_the_way_out(void **state)
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
    check_rgb(look(&w), 0.74083, 1, 1);
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
    surface->mesh_textures = list;
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

/* --- nearest hits --------------------------------------------------------------------------- */

/* Which object is seen in one place must not depend on the index. */
static void test_coincident_objects(void **state)
{
    (void)state;
    for (int order = 0; order < 2; order++) {
        World w;
        world_init(&w);
        const Texture *red = emitter(&w, 1, 0, 0), *blue = emitter(&w, 0, 0, 1);
        Shape *turned = box(&w, v3(-1, -1, -1), v3(1, 1, 1));
        Xform turn = xform_rotate(v3(0, 0, 30 * DEG)), there = xform_rotate(v3(20 * DEG, 0, 0));
        Xform back = xform_inverse(&there);
        shape_transform(turned, &turn);
        shape_transform(turned, &there);
        shape_transform(turned, &back);
        Shape *straight = box(&w, v3(-1, -1, -1), v3(1, 1, 1));
        Shape *far_away = box(&w, v3(-50, -50, 50), v3(50, 50, 51));
        world_add(&w, far_away, blue, &air);
        world_add(&w, order ? turned : straight, red, &air);
        world_add(&w, order ? straight : turned, blue, &air);
        world_ready(&w);
        for (int i = 0; i < 400; i++) {
            Ray ray = {{-3 + 0.001 * i, 0.3, -7}, v3_unit(v3(0.43, -0.04, 1)), 0, INFINITY};
            Hit hit;
            assert_true(trace_closest(&w.thread, &ray, RAY_CAMERA, &hit));
            V3 p = hit.point.p;
            if (fabs(p.z + 1) > 1e-9 || fabs(p.x) > 0.7 || fabs(p.y) > 0.7)
                continue;
            assert_ptr_equal(hit.object, &w.objects[1]);
            /* a ray that leaves towards the eye's side meets neither again */
            Ray out = trace_ray_from(&hit.point, v3_unit(v3(0.999, 0, -1e-7)));
            assert_false(trace_closest(&w.thread, &out, RAY_CAMERA, &hit));
        }
        world_done(&w);
    }
}

static void test_visibility_by_kind(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    Shape *ball = shape_sphere(w.scene.arena, v3(0, 0, 0), 1);
    world_add(&w, ball, emitter(&w, 1, 1, 1), &air);
    Ray ray = {{0, 0, -10}, {0, 0, 1}, 0, INFINITY};
    ShapePoint from = {.p = {0, 0, -10}, .ng = {0, 0, 1}, .ns = {0, 0, 1}};
    for (int mask = 0; mask < 8; mask++) {
        w.objects[0].no_image = mask & 1;
        w.objects[0].no_reflection = mask & 2;
        w.objects[0].no_shadow = mask & 4;
        world_ready(&w);
        Hit hit;
        assert_int_equal(trace_closest(&w.thread, &ray, RAY_CAMERA, &hit), !(mask & 1));
        assert_int_equal(trace_closest(&w.thread, &ray, RAY_REFRACTED, &hit), !(mask & 1));
        assert_int_equal(trace_closest(&w.thread, &ray, RAY_PHOTON, &hit), !(mask & 5));
        assert_int_equal(trace_closest(&w.thread, &ray, RAY_REFLECTED, &hit), !(mask & 2));
        Rgb light = trace_shadow(&w.thread, &from, v3(0, 0, 1), 20, 0, false);
        assert_true(light.r == (mask & 4 ? 1.0f : 0.0f));
        assert_int_equal(w.thread.stats.count[STAT_CAMERA_RAYS], 1);
        trace_thread_done(&w.thread);
        tracer_free(w.tracer);
    }
    world_ready(&w);
    world_done(&w);
}

/* The views of the eye and of a light change no answer. */
static void test_views_agree_with_the_index(void **state)
{
    (void)state;
    for (int crowd = 0; crowd < 2; crowd++) {
        World w;
        world_init(&w);
        Rng rng = rng_at(7, 0, (uint64_t)crowd);
        V3 eye = v3(0.1, 2.5, -4), lamp = v3(-1.3, 3.1, 0.7);
        w.lights[0] = (Light){.kind = LIGHT_POINT, .location = lamp, .color = {1, 1, 1}};
        w.scene.camera.location = eye;
        const Texture *red = emitter(&w, 1, 0, 0);
        const Texture *half = flat(&w, (Color5){1, 0.5f, 1, 0.5f, 0.25f}, &dull);
        for (int i = 0; i < (crowd ? 60 : 12); i++) {
            V3 u = v3(rng_double(&rng), rng_double(&rng), rng_double(&rng));
            V3 c = v3(6 * u.x - 3, 3 * u.y, 6 * u.z - 3);
            double size = 0.05 + 0.5 * rng_double(&rng);
            Shape *shape = i % 3 ? shape_sphere(w.scene.arena, c, size)
                                 : box(&w, c, v3_add(c, v3(size, 3 * size, 0.5 * size)));
            world_add(&w, shape, i % 4 ? red : half, &air);
        }
        world_add(&w, shape_plane(w.scene.arena, v3(0, 1, 0), 0), red, &air);
        world_ready(&w);
        int hits = 0, shadows = 0;
        for (int i = 0; i < 20000; i++) {
            Hit a, b;
            Ray ray = {eye, warp_sphere((V2){rng_double(&rng), rng_double(&rng)}), 0, INFINITY};
            bool is_hit = trace_closest(&w.thread, &ray, RAY_CAMERA, &a);
            assert_int_equal(is_hit, trace_closest(&w.thread, &ray, RAY_REFRACTED, &b));
            if (!is_hit)
                continue;
            hits++;
            assert_true(a.t == b.t && a.object == b.object);
            LightSample light = light_at(&w.lights[0], lamp, a.point.p);
            Rgb by_view =
                trace_shadow(&w.thread, &a.point, light.to_light, light.distance, 0, false);
            Rgb by_index =
                trace_shadow(&w.thread, &a.point, light.to_light, light.distance, -1, false);
            assert_memory_equal(&by_view, &by_index, sizeof by_view);
            shadows += by_view.r < 1;
        }
        assert_true(hits > 10000 && shadows > 1000 && shadows < hits);
        world_done(&w);
    }
}

/* A bundle leaves out no object that one of its rays meets. */
static void test_bundles_agree_with_single_rays(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    Rng rng = rng_at(8, 0, 0);
    const Texture *red = emitter(&w, 1, 0, 0);
    const Texture *half = flat(&w, (Color5){1, 0.5f, 1, 0.5f, 0.25f}, &dull);
    for (int i = 0; i < 14; i++) {
        V3 u = v3(rng_double(&rng), rng_double(&rng), rng_double(&rng));
        V3 c = v3(8 * u.x - 4, 3 * u.y, 8 * u.z - 4);
        double size = 0.05 + 0.6 * rng_double(&rng);
        Shape *shape = i % 3 ? shape_sphere(w.scene.arena, c, size)
                             : box(&w, c, v3_add(c, v3(size, 3 * size, 0.5 * size)));
        world_add(&w, shape, i % 4 ? red : half, &air);
    }
    world_add(&w, shape_plane(w.scene.arena, v3(0, 1, 0), 0), red, &air);
    world_ready(&w);
    V3 lamp = v3(1, 4, -2);
    int empty = 0, rays = 0, shadows = 0;
    for (int i = 0; i < 4000; i++) {
        Ray ray = {v3(0.1, 2.5, -6), warp_sphere((V2){rng_double(&rng), rng_double(&rng)}), 0,
                   INFINITY};
        Hit hit;
        if (!trace_closest(&w.thread, &ray, RAY_REFRACTED, &hit))
            continue;
        double radius = i % 2 ? 1.5 : 0.1;
        V3 to_center = v3_sub(lamp, hit.point.p);
        ShadowBundle bundle;
        trace_shadow_bundle(w.tracer, &hit.point, to_center, radius, &bundle);
        empty += bundle.count == 0;
        for (int k = 0; k < 8; k++) {
            V3 aside = warp_sphere((V2){rng_double(&rng), rng_double(&rng)});
            V3 to = v3_mad(to_center, radius, aside);
            double distance = v3_len(to);
            to = v3_unit(to);
            Rgb a = trace_shadow_of(&w.thread, &bundle, &hit.point, to, distance, -1, false);
            Rgb b = trace_shadow(&w.thread, &hit.point, to, distance, -1, false);
            assert_memory_equal(&a, &b, sizeof a);
            rays++;
            shadows += b.r < 1;
        }
    }
    if (!(empty > 100 && shadows > 500 && shadows < rays))
        fail_msg("%d empty bundles, %d of %d rays in shadow", empty, shadows, rays);
    world_done(&w);
}

/* The ends of a cube of directions: axes, edges and corners. */
static void test_views_at_edges(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    V3 eye = v3(0, 0, 0);
    w.scene.camera.location = eye;
    for (int i = 0; i < 27; i++) {
        V3 c = v3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        if (i != 13)
            world_add(&w, shape_sphere(w.scene.arena, c, 1e-6), emitter(&w, 1, 1, 1), &air);
    }
    world_ready(&w);
    for (int i = 0; i < 27; i++) {
        V3 c = v3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        Ray ray = {eye, v3_unit(c), 0, INFINITY};
        Hit hit;
        if (i != 13)
            assert_true(trace_closest(&w.thread, &ray, RAY_CAMERA, &hit));
    }
    world_done(&w);
}

static void test_empty_scene(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    world_ready(&w);
    Ray ray = {{0, 0, -10}, {0, 0, 1}, 0, INFINITY};
    Hit hit;
    assert_false(trace_closest(&w.thread, &ray, RAY_CAMERA, &hit));
    assert_true(bound_is_finite(tracer_bound(w.tracer)));
    ShapePoint from = {.ng = {0, 1, 0}};
    assert_true(trace_shadow(&w.thread, &from, v3(0, 1, 0), 1, -1, false).r == 1);
    world_done(&w);
}

/* A ray that leaves a surface does not meet it again, at any scale and slant. */
static void test_no_self_hits(void **state)
{
    (void)state;
    static const double scales[] = {1e-9, 1e-3, 1, 1e4, 1e9};
    for (size_t k = 0; k < sizeof scales / sizeof *scales; k++) {
        double size = scales[k];
        World w;
        world_init(&w);
        V3 center = v3(3 * size, -2 * size, 5 * size);
        world_add(&w, shape_sphere(w.scene.arena, center, size), emitter(&w, 1, 1, 1), &air);
        world_ready(&w);
        Rng rng = rng_at(1, 0, k);
        for (int i = 0; i < 2000; i++) {
            V3 aim = v3_mad(center, size, warp_sphere((V2){rng_double(&rng), rng_double(&rng)}));
            V3 o = v3(0, 0, -10 * size);
            Ray ray = {o, v3_unit(v3_sub(aim, o)), 0, INFINITY};
            Hit hit;
            if (!trace_closest(&w.thread, &ray, RAY_CAMERA, &hit))
                continue;
            V3 d = v3_reflect(ray.d, hit.point.ng);
            if (i & 1) /* almost along the surface */
                d = v3_unit(v3_mad(d, 1e-9 - v3_dot(d, hit.point.ng), hit.point.ng));
            Ray out = trace_ray_from(&hit.point, d);
            assert_false(trace_closest(&w.thread, &out, RAY_REFLECTED, &hit));
            assert_true(trace_shadow(&w.thread, &hit.point, d, 100 * size, -1, false).r == 1);
        }
        world_done(&w);
    }
}

/* --- shadows --------------------------------------------------------------------------------- */

/* Light that reaches <0,0,5> from z = -20. */
static Rgb shadow(World *w, bool blocks_targets)
{
    ShapePoint from = {.p = {0, 0, 5}, .ng = {0, 0, -1}, .ns = {0, 0, -1}, .p_error = 1e-15};
    return trace_shadow(&w->thread, &from, v3(0, 0, -1), 25, 0, blocks_targets);
}

static void test_filtered_shadows(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    const Interior plain = {.ior = 1}, caustic = {.ior = 1, .caustics = 0.2f};
    Shape *slab = box(&w, v3(-2, -2, 0), v3(2, 2, 1));
    Shape *ball = shape_sphere(w.scene.arena, v3(0.3, 0, 0), 1);
    const Texture *tint = flat(&w, (Color5){0.8f, 0.5f, 0.3f, 0.6f, 0.1f}, &dull);
    const Texture *over = flat(&w, (Color5){0.9f, 0.7f, 0.9f, 0.3f, 0.5f}, &dull);
    Surface *a = world_add(&w, slab, tint, &plain), *b = world_add(&w, ball, tint, &caustic);
    w.objects[1].no_shadow = true;
    world_ready(&w);
    check_rgb(shadow(&w, false), 0.33640, 0.16001, 0.07840);
    assert_int_equal(w.thread.stats.count[STAT_SHADOW_FILTER_WALKS], 1);
    a->texture = two_layers(&w, tint, over);
    check_rgb(shadow(&w, false), 0.19945, 0.08066, 0.04648);
    trace_thread_done(&w.thread);
    tracer_free(w.tracer);
    w.objects[0].no_shadow = true;
    w.objects[1].no_shadow = false;
    world_ready(&w);
    check_rgb(shadow(&w, false), 0.92047, 0.43780, 0.21453);
    b->texture = two_layers(&w, tint, over);
    Rgb bright = shadow(&w, false);
    assert_true(fabs((double)bright.g - 0.60388) < TOLERANCE);
    assert_true(fabs((double)bright.b - 0.34803) < TOLERANCE);
    world_done(&w);
}

static void test_absorbing_shadows(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    Interior a = fading(rgb(0.9f, 1, 1)), b = fading(rgb(1, 0.9f, 1));
    world_add(&w, box(&w, v3(-2, -2, -2), v3(2, 2, 2)), clear(&w), &a);
    world_add(&w, box(&w, v3(-1, -1, -1), v3(1, 1, 1)), clear(&w), &b);
    world_ready(&w);
    check_rgb(shadow(&w, false), 0.90484, 0.81874, 1);
    /* from inside the outer one */
    ShapePoint from = {.p = {1.5, 0, 0}, .ng = {0, 0, -1}, .ns = {0, 0, -1}, .p_error = 1e-15};
    check_rgb(trace_shadow(&w.thread, &from, v3(0, 0, -1), 20, 0, false), 0.81873, 1, 1);
    world_done(&w);
}

static void test_opaque_among_filters(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    const Texture *half = flat(&w, (Color5){1, 1, 1, 0, 0.5f}, &dull);
    for (int i = 0; i < 5; i++)
        world_add(&w, box(&w, v3(-2, -2, -2 * i), v3(2, 2, 1 - 2 * i)), half, &air);
    world_ready(&w);
    assert_true(shadow(&w, false).r == 0x1p-10f);
    trace_thread_done(&w.thread);
    tracer_free(w.tracer);
    Surface *wall =
        world_add(&w, box(&w, v3(-2, -2, -15), v3(2, 2, -14)), emitter(&w, 1, 1, 1), &air);
    world_ready(&w);
    assert_true(rgb_is_black(shadow(&w, false)));
    assert_int_equal(w.thread.blockers[0], 5);
    /* the remembered blocker does not block where it is not */
    ShapePoint aside = {.p = {3, 0, 5}, .ng = {0, 0, -1}, .ns = {0, 0, -1}, .p_error = 1e-15};
    assert_true(trace_shadow(&w.thread, &aside, v3(0, 0, -1), 25, 0, false).r == 1);
    assert_int_equal(w.thread.stats.count[STAT_SHADOW_FILTER_WALKS], 0);
    (void)wall;
    world_done(&w);
}

static void test_photon_targets_block(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    Surface *glass = world_add(&w, box(&w, v3(-2, -2, 0), v3(2, 2, 1)), clear(&w), &air);
    glass->is_target = true;
    glass->photons.refraction = TRI_ON;
    world_add(&w, box(&w, v3(-2, -2, -4), v3(2, 2, -3)),
              flat(&w, (Color5){1, 1, 1, 0, 0.5f}, &dull), &air);
    world_ready(&w);
    assert_true(rgb_is_black(shadow(&w, true)));
    assert_true(shadow(&w, false).r == 0.25f); /* the remembered blocker lets this light pass */
    assert_true(rgb_is_black(shadow(&w, true)));
    world_done(&w);
}

static void test_light_on_a_surface(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    world_add(&w, box(&w, v3(-2, -2, -21), v3(2, 2, -20)), emitter(&w, 1, 1, 1), &air);
    world_add(&w, shape_plane(w.scene.arena, v3(0, 0, 1), -20), emitter(&w, 1, 1, 1), &air);
    world_ready(&w);
    assert_true(shadow(&w, false).r == 1);
    ShapePoint from = {.p = {0, 0, -15}, .ng = {0, 0, 1}, .ns = {0, 0, 1}};
    assert_true(trace_shadow(&w.thread, &from, v3(0, 0, -1), -3, 0, false).r == 1);
    assert_true(rgb_is_black(trace_shadow(&w.thread, &from, v3(0, 0, -1), 5.001, 0, false)));
    world_done(&w);
}

/* --- interiors ------------------------------------------------------------------------------- */

static void test_interiors_at(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    const Interior a = {.ior = 1.1}, b = {.ior = 1.2}, c = {.ior = 1.3};
    Arena *arena = w.scene.arena;
    world_add(&w, shape_sphere(arena, v3(0, 0, 0), 1), clear(&w), &a);
    world_add(&w, shape_sphere(arena, v3(0, 0, 0), 3), clear(&w), &b);
    world_add(&w, shape_plane(arena, v3(0, 1, 0), 0.5), clear(&w), &c);
    world_ready(&w);
    Interiors in;
    interiors_at(w.tracer, v3(0, 0, 0), &in);
    assert_int_equal(in.count, 3);
    assert_ptr_equal(in.in[0], &c);
    assert_ptr_equal(in.in[1], &b);
    assert_ptr_equal(in.in[2], &a);
    assert_int_equal(in.object[2], 0);
    interiors_at(w.tracer, v3(0, 2, 0), &in);
    assert_int_equal(in.count, 1);
    assert_ptr_equal(in.in[0], &b);
    world_done(&w);
}

/* A ray that starts inside without knowing leaves as from inside. */
static void test_missed_entry(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    const Interior glass = {.ior = 1.5};
    world_add(&w, box(&w, v3(-1, -1, -1), v3(1, 1, 1)), clear(&w), &glass);
    world_ready(&w);
    Ray ray = {{0, 0, 0}, v3_unit(v3(0.3, 0, 1)), 0, INFINITY};
    Interiors none = {.count = 0};
    Hit hit;
    SurfaceSample s;
    assert_true(trace_closest(&w.thread, &ray, RAY_CAMERA, &hit));
    surface_sample(&w.thread, &ray, &hit, &none, &s);
    assert_int_equal(s.inside_after.count, 0);
    assert_true(fabs(s.transmit_dir.x - 1.5 * ray.d.x) < 1e-15);
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
        cmocka_unit_test(test_mirror_inside_absorbs_on_the_way_out),
        cmocka_unit_test(test_overlapping_glass_is_one_glass),
        cmocka_unit_test(test_touching_media),
        cmocka_unit_test(test_wall_inside_a_union),
        cmocka_unit_test(test_glass_on_a_table),
        cmocka_unit_test(test_interior_texture),
        cmocka_unit_test(test_mesh_textures),
        cmocka_unit_test(test_smooth_normal_at_a_silhouette),
        cmocka_unit_test(test_coincident_objects),
        cmocka_unit_test(test_visibility_by_kind),
        cmocka_unit_test(test_views_agree_with_the_index),
        cmocka_unit_test(test_bundles_agree_with_single_rays),
        cmocka_unit_test(test_views_at_edges),
        cmocka_unit_test(test_empty_scene),
        cmocka_unit_test(test_no_self_hits),
        cmocka_unit_test(test_filtered_shadows),
        cmocka_unit_test(test_absorbing_shadows),
        cmocka_unit_test(test_opaque_among_filters),
        cmocka_unit_test(test_photon_targets_block),
        cmocka_unit_test(test_light_on_a_surface),
        cmocka_unit_test(test_interiors_at),
        cmocka_unit_test(test_missed_entry),
    };
    return cmocka_run_group_tests_name("trace", tests, NULL, NULL);
}
