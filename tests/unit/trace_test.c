/* Rays: nearest hits, shadows, the interiors they are in, against povray 3.7 where it sets the
 * rule: the numbers are its 16-bit pixels of the same scene.
 * SPDX-License-Identifier: Apache-2.0 */
#include "math/sample.h"
#include "trace/trace.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "world.h"

#define DEG (PMS_PI / 180)

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
        assert_int_equal(trace_closest(&w.thread, &ray, RAY_DIFFUSE, &hit), !(mask & 4));
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
    w.lights[0].area.size1 = w.lights[0].area.size2 = 2;
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
    assert_true(fabs((double)bright.g - 0.60388) < PIXEL_TOLERANCE);
    assert_true(fabs((double)bright.b - 0.34803) < PIXEL_TOLERANCE);
    world_done(&w);
}

/* Each leg is absorbed by what it is in, as for rays of the eye.  (In POV-Ray only legs that end
 * where the ray leaves something are: .90484 for the first.) */
static void test_absorbing_shadows(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    Interior a = fading(rgb(0.9f, 1, 1)), b = fading(rgb(1, 0.9f, 1));
    world_add(&w, box(&w, v3(-2, -2, -2), v3(2, 2, 2)), clear(&w), &a);
    world_add(&w, box(&w, v3(-1, -1, -1), v3(1, 1, 1)), clear(&w), &b);
    world_ready(&w);
    check_rgb(shadow(&w, false), 0.81873, 0.81873, 1);
    /* from inside the inner one, from inside the outer one through the inner, and past it */
    ShapePoint from_inner = {.p = {0, 0, 0.5}, .ng = {0, 0, -1}, .ns = {0, 0, -1}};
    check_rgb(trace_shadow(&w.thread, &from_inner, v3(0, 0, -1), 20, 0, false), 0.90484, 0.86071,
              1);
    ShapePoint behind = {.p = {0, 0, 1.5}, .ng = {0, 0, -1}, .ns = {0, 0, -1}};
    check_rgb(trace_shadow(&w.thread, &behind, v3(0, 0, -1), 20, 0, false), 0.86071, 0.81873, 1);
    ShapePoint from = {.p = {1.5, 0, 0}, .ng = {0, 0, -1}, .ns = {0, 0, -1}, .p_error = 1e-15};
    check_rgb(trace_shadow(&w.thread, &from, v3(0, 0, -1), 20, 0, false), 0.81873, 1, 1);
    /* to a light in the inner one, half way */
    ShapePoint before = {.p = {0, 0, 10}, .ng = {0, 0, -1}, .ns = {0, 0, -1}};
    check_rgb(trace_shadow(&w.thread, &before, v3(0, 0, -1), 10, 0, false), 0.90484, 0.90484, 1);
    world_done(&w);
    /* a lamp in the outer one, seen from there: past the inner one, and through it */
    world_init(&w);
    world_add(&w, box(&w, v3(-2, -2, -2), v3(2, 2, 2)), clear(&w), &a);
    world_add(&w, box(&w, v3(-1, -1, -1), v3(1, 1, 1)), clear(&w), &b);
    w.lights[0] = (Light){.location = {0, 0, -1.5}};
    w.lights[1] = (Light){.location = {1.5, 0, -1.5}};
    world_ready(&w);
    check_rgb(trace_shadow(&w.thread, &behind, v3(0, 0, -1), 3, 0, false), 0.90484, 0.81873, 1);
    check_rgb(trace_shadow(&w.thread, &from, v3(0, 0, -1), 1.5, 1, false), 0.86071, 1, 1);
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
