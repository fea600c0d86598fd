/* Media in media: glass around water around a bubble, with walls that overlap, touch, nearly touch
 * or leave a gap; ice half in water; eyes and lights inside.
 *
 * The lists of what a ray is in are compared with what shapes say of points on the ray, and what
 * passes with Snell's and Fresnel's laws.  SPDX-License-Identifier: Apache-2.0 */
#include "base/rng.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "../unit/world.h"
#include "../physics/fresnel_law.h"

static const Interior glass = {.ior = 1.5}, water = {.ior = 1.33}, ice = {.ior = 1.31},
                      solid_ice = {.ior = 1.31, .priority = 1};

static const Texture *fresnel_glass(World *w)
{
    Finish finish = dull;
    finish.reflection_max = RGB_WHITE;
    finish.is_fresnel = true;
    finish.conserves_energy = true;
    return flat(w, (Color5){1, 1, 1, 0, 1}, &finish);
}

static void add_glassy(World *w, Shape *shape, const Interior *interior)
{
    world_add(w, shape, fresnel_glass(w), interior);
}

static Shape *upright(World *w, double bottom, double top, double radius)
{
    return shape_cone(w->scene.arena, v3(0, bottom, 0), radius, v3(0, top, 0), radius, false);
}

static Shape *minus(World *w, Shape *a, Shape *b)
{
    Shape **parts = ARENA_ARRAY(w->scene.arena, Shape *, 2);
    parts[0] = a;
    parts[1] = b;
    shape_invert(b);
    return shape_csg(w->scene.arena, SHAPE_INTERSECTION, parts, 2);
}

/* --- what a ray is in ---------------------------------------------------------------------- */

/* A cup of water with an ice cube and a bubble, on a slab of glass.  `off`: how far the water
 * reaches into the cup; negative: a gap. */
static void fill_cup(World *w, double off, const Xform *turn)
{
    Shape *bowl = minus(w, upright(w, 0, 3, 1), upright(w, 0.25, 3.5, 0.8));
    Shape *shapes[5] = {
        bowl, upright(w, 0.25 - off, 2, 0.8 + off), box(w, v3(-0.3, 1.8, -0.3), v3(0.3, 2.3, 0.3)),
        shape_sphere(w->scene.arena, v3(0.3, 1, 0.1), 0.2), box(w, v3(-3, -1, -3), v3(3, 0, 3))};
    const Interior *interiors[5] = {&glass, &water, &ice, &air, &glass};
    for (int i = 0; i < 5; i++) {
        if (turn)
            shape_transform(shapes[i], turn);
        add_glassy(w, shapes[i], interiors[i]);
    }
}

static unsigned list_mask(const Interiors *list)
{
    unsigned mask = 0;
    for (int i = 0; i < list->count; i++)
        mask |= 1u << list->object[i];
    return mask;
}

static unsigned mask_at(const World *w, V3 p)
{
    unsigned mask = 0;
    for (uint32_t i = 0; i < w->scene.object_count; i++)
        mask |= (unsigned)shape_is_inside(w->objects[i].shape, p) << i;
    return mask;
}

/* Reflect one time in five where something is reflected, else go through; false: neither. */
static bool go_on(World *w, Ray *ray, const Hit *hit, Interiors *inside, Rng *rng)
{
    SurfaceSample s;
    surface_sample(&w->thread, ray, hit, inside, &s);
    if (s.layers[0].reflect.r > 0 && rng_double(rng) < 0.2) {
        *ray = trace_ray_from(&s.at, s.layers[0].reflect_dir);
        return true;
    }
    if (!s.has_transmission)
        return false;
    *inside = s.inside_after;
    *ray = trace_ray_from(&s.at, s.transmit_dir);
    return true;
}

static V3 any_direction(Rng *rng)
{
    double z = 2 * rng_double(rng) - 1, phi = 2 * PMS_PI * rng_double(rng), r = sqrt(1 - z * z);
    return v3(r * cos(phi), z, r * sin(phi));
}

/* Follow rays from in and around the cup; count the legs on which the list is not what the shapes
 * say, and the rays that leave with something in it. */
static int count_wrong(World *w, int rays, const Xform *turn)
{
    int wrong = 0;
    for (int i = 0; i < rays; i++) {
        Rng rng = rng_at(5, 0, (uint64_t)i);
        V3 start = v3(2.4 * rng_double(&rng) - 1.2, 4 * rng_double(&rng) - 0.5,
                      2.4 * rng_double(&rng) - 1.2);
        Ray ray = {turn ? xform_point(turn, start) : start, any_direction(&rng), 0, INFINITY};
        if (i % 2)
            ray.o = v3_mad(ray.o, -20, ray.d);
        Interiors inside;
        interiors_at(w->tracer, ray.o, &inside);
        Hit hit;
        for (int leg = 0; trace_closest(&w->thread, &ray, RAY_CAMERA, &hit); leg++) {
            if (hit.t > 1e-5)
                wrong += mask_at(w, ray_at(&ray, hit.t / 2)) != list_mask(&inside);
            if (leg == 60 || !go_on(w, &ray, &hit, &inside, &rng)) {
                inside.count = 0;
                break;
            }
        }
        wrong += inside.count != 0;
    }
    return wrong;
}

static const double offsets[] = {0,      1e-16,  3e-16,  1e-15, 3e-15,  1e-14,  3e-14,  1e-13,
                                 1e-12,  1e-9,   1e-6,   1e-3,  -1e-16, -1e-15, -5e-15, -1e-14,
                                 -4e-14, -1e-13, -1e-12, -1e-9, -1e-6,  -1e-3};
enum { OFFSETS = sizeof offsets / sizeof *offsets };

static void test_lists_are_what_shapes_say(void **state)
{
    (void)state;
    for (int i = 0; i < OFFSETS; i++) {
        World w;
        world_init(&w);
        fill_cup(&w, offsets[i], NULL);
        world_ready(&w);
        int wrong = count_wrong(&w, 5000, NULL);
        if (wrong)
            fail_msg("water off by %g: %d wrong", offsets[i], wrong);
        world_done(&w);
    }
}

/* Turned and moved far, walls that coincided do so to rounding only. */
static void test_lists_in_a_turned_scene(void **state)
{
    (void)state;
    for (int i = 0; i < OFFSETS; i++) {
        World w;
        world_init(&w);
        Xform turn = xform_rotate(v3(0.3 + i, 0.7, -1.1)), move = xform_translate(v3(70, -30, 11));
        turn = xform_then(&turn, &move);
        fill_cup(&w, offsets[i], &turn);
        world_ready(&w);
        int wrong = count_wrong(&w, 5000, &turn);
        if (wrong)
            fail_msg("water off by %g: %d wrong", offsets[i], wrong);
        world_done(&w);
    }
}

/* --- one interface ------------------------------------------------------------------------- */

/* What became of a ray. */
typedef struct Passed {
    V3 place, direction; /* of the last ray */
    double share;        /* that passed, without what was reflected on the way */
    bool is_through;     /* without total reflection */
    int reflections;     /* surfaces that reflect something */
} Passed;

static Passed pass(World *w, Ray ray)
{
    Passed out = {.share = 1, .is_through = true};
    Interiors inside;
    interiors_at(w->tracer, ray.o, &inside);
    for (int i = 0; i < 20; i++) {
        Hit hit;
        SurfaceSample s;
        if (!trace_closest(&w->thread, &ray, RAY_CAMERA, &hit))
            break;
        surface_sample(&w->thread, &ray, &hit, &inside, &s);
        for (int k = 0; k < s.layer_count; k++)
            out.reflections += s.layers[k].reflect.r > 0;
        if (!s.has_transmission || s.is_total_reflection) {
            out.is_through = false;
            break;
        }
        out.share *= (double)s.through.r;
        inside = s.inside_after;
        ray = trace_ray_from(&s.at, s.transmit_dir);
    }
    out.place = ray.o;
    out.direction = ray.d;
    return out;
}

/* Glass from z = 0 to 1 and water behind it to z = 2, as much as `off` into the glass. */
static void add_slabs(World *w, double off, bool is_water_first)
{
    Shape *pane = box(w, v3(-99, -99, 0), v3(99, 99, 1));
    Shape *pool = box(w, v3(-99, -99, 1 - off), v3(99, 99, 2));
    if (is_water_first)
        add_glassy(w, pool, &water);
    add_glassy(w, pane, &glass);
    if (!is_water_first)
        add_glassy(w, pool, &water);
}

/* Snell and Fresnel through three interfaces, whether the walls touch or overlap. */
static void test_glass_on_water(void **state)
{
    (void)state;
    static const double overlaps[] = {0, 1e-15, 1e-14, 1e-9, 0.25};
    for (int i = 0; i < 10; i++) {
        double off = overlaps[i / 2];
        World w;
        world_init(&w);
        add_slabs(&w, off, i % 2);
        world_ready(&w);
        for (int degrees = 0; degrees < 90; degrees += 3) {
            double sine = sin(degrees * PMS_PI / 180), in_glass = sine / 1.5,
                   in_water = sine / 1.33;
            V3 d = v3(sine, 0, sqrt(1 - sine * sine));
            Passed p = pass(&w, (Ray){v3_scale(d, -1), d, 0, INFINITY});
            double x = (1 - off) * in_glass / sqrt(1 - in_glass * in_glass) +
                       (1 + off) * in_water / sqrt(1 - in_water * in_water);
            double share = (1 - reflectance(1, 1.5, sine)) *
                           (1 - reflectance(1.5, 1.33, in_glass)) *
                           (1 - reflectance(1.33, 1, in_water));
            if (!p.is_through || p.reflections != 3)
                fail_msg("overlap %g, %d degrees: %d reflections", off, degrees, p.reflections);
            assert_true(v3_dist(p.direction, d) < 1e-13);
            assert_true(fabs(p.place.x - x) < 1e-12);
            assert_true(fabs(p.share - share) < 1e-6);
        }
        world_done(&w);
    }
}

/* A gap of air stays one, however thin: from glass to water over it no ray passes beyond the
 * critical angle of glass and air.  Where they touch, rays pass up to that of glass and water. */
static void test_a_gap_is_air(void **state)
{
    (void)state;
    static const double gaps[] = {0, 1e-9, 1e-6, 1e-3};
    double to_air = asin(1 / 1.5), to_water = asin(1.33 / 1.5);
    for (int i = 0; i < 4; i++) {
        World w;
        world_init(&w);
        add_slabs(&w, -gaps[i], false);
        world_ready(&w);
        double critical = i == 0 ? to_water : to_air;
        for (int side = -1; side <= 1; side += 2) {
            double angle = critical + side * 1e-6, sine = sin(angle);
            V3 d = v3(sine, 0, cos(angle));
            Interiors inside;
            Hit hit;
            SurfaceSample s;
            Ray ray = {v3(0, 0, 0.5), d, 0, INFINITY};
            interiors_at(w.tracer, ray.o, &inside);
            assert_int_equal(inside.count, 1);
            assert_true(trace_closest(&w.thread, &ray, RAY_CAMERA, &hit));
            surface_sample(&w.thread, &ray, &hit, &inside, &s);
            double n2 = i == 0 ? 1.33 : 1, r = reflectance(1.5, n2, sine);
            assert_true(fabs((double)s.layers[0].reflect.r - r) < 1e-5);
            assert_true((r < 1) == (s.has_transmission && !s.is_total_reflection));
            if (r < 1)
                assert_true(fabs(s.transmit_dir.x - 1.5 / n2 * sine) < 1e-12);
        }
        world_done(&w);
    }
}

/* Solid glass with water in it, a hollow cup filled to its walls, and one filled a little beyond
 * are the same thing. */
static void test_three_ways_to_fill_a_cup(void **state)
{
    (void)state;
    World ways[4];
    static const double overlap[4] = {0, 0, 1e-14, 1e-9};
    for (int i = 0; i < 4; i++) {
        World *w = &ways[i];
        world_init(w);
        Shape *cup = upright(w, 0, 3, 1);
        if (i > 0)
            cup = minus(w, cup, upright(w, 0.25, 2, 0.8));
        add_glassy(w, cup, &glass);
        add_glassy(w, upright(w, 0.25 - overlap[i], 2 + overlap[i], 0.8 + overlap[i]), &water);
        world_ready(w);
    }
    int compared = 0;
    for (int i = 0; i < 4000; i++) {
        Rng rng = rng_at(6, 0, (uint64_t)i);
        V3 aim = v3(2 * rng_double(&rng) - 1, 3 * rng_double(&rng), 2 * rng_double(&rng) - 1);
        V3 d = any_direction(&rng);
        Ray ray = {v3_mad(aim, -9, d), d, 0, INFINITY};
        Passed first = pass(&ways[0], ray);
        for (int k = 1; k < 4; k++) {
            Passed other = pass(&ways[k], ray);
            if (first.is_through != other.is_through || !(first.share > 0.3))
                continue; /* at the edge of total reflection anything may turn over */
            compared++;
            assert_int_equal(first.reflections, other.reflections);
            assert_true(v3_dist(first.direction, other.direction) < 1e-5);
            assert_true(fabs(first.share - other.share) < 1e-5);
        }
    }
    assert_true(compared > 5000);
    for (int i = 0; i < 4; i++)
        world_done(&ways[i]);
}

/* Nothing may be darker or brighter than an even surround, whatever is in what. */
static void test_nested_furnace(void **state)
{
    (void)state;
    for (int i = 0; i < OFFSETS; i++) {
        World w;
        world_init(&w);
        w.scene.background.color = (Color5){1, 1, 1, 0, 0};
        w.scene.settings.adc_bailout = 1e-5;
        w.scene.settings.max_trace_level = 60;
        fill_cup(&w, offsets[i], NULL);
        world_ready(&w);
        for (int k = 0; k < 20; k++) {
            Rng rng = rng_at(7, 0, (uint64_t)k);
            V3 d = any_direction(&rng);
            Ray ray = {v3_mad(v3(0.1 * rng_double(&rng), 1, 0), -9, d), d, 0, INFINITY};
            Interiors inside;
            interiors_at(w.tracer, ray.o, &inside);
            Rgb seen = look_along(&w, &ray, RAY_CAMERA, &inside, 0, 1, false);
            if (!(fabs((double)seen.g - 1) < 5e-3))
                fail_msg("water off by %g, ray %d: %g", offsets[i], k, (double)seen.g);
        }
        world_done(&w);
    }
}

/* --- priority ------------------------------------------------------------------------------ */

static void add_ice_in_water(World *w, const Interior *cube)
{
    add_glassy(w, upright(w, 0, 2, 1), &water);
    add_glassy(w, box(w, v3(-0.3, 1.6, -0.3), v3(0.3, 2.2, 0.3)), cube);
}

/* The ior a ray is in half way to its next surface. */
static double ior_before(World *w, Ray ray, int surface)
{
    Interiors inside;
    interiors_at(w->tracer, ray.o, &inside);
    for (int i = 0; i < surface; i++) {
        Hit hit;
        SurfaceSample s;
        assert_true(trace_closest(&w->thread, &ray, RAY_CAMERA, &hit));
        surface_sample(&w->thread, &ray, &hit, &inside, &s);
        inside = s.inside_after;
        ray = trace_ray_from(&s.at, s.transmit_dir);
    }
    return inside.count > 0 ? inside.in[inside.count - 1]->ior : 1;
}

/* Of equal priority what was entered last counts: from above the water in the ice, from the side
 * the ice.  (POV-Ray 3.7 shows the same.)  With a priority it is ice both ways. */
static void test_ice_half_in_water(void **state)
{
    (void)state;
    Ray down = {v3(0.05, 4, 0.02), v3(0, -1, 0), 0, INFINITY};
    Ray along = {v3(-4, 1.8, 0.02), v3(1, 0, 0), 0, INFINITY};
    for (int i = 0; i < 2; i++) {
        World w;
        world_init(&w);
        add_ice_in_water(&w, i ? &solid_ice : &ice);
        world_ready(&w);
        assert_true(ior_before(&w, down, 1) == 1.31); /* in the ice above the water */
        assert_true(ior_before(&w, down, 2) == (i ? 1.31 : 1.33));
        assert_true(ior_before(&w, down, 3) == 1.33);
        assert_true(ior_before(&w, along, 2) == 1.31);
        Interiors at;
        interiors_at(w.tracer, v3(0, 1.7, 0), &at);
        assert_true(at.count == 2 && at.in[1]->ior == 1.31);
        world_done(&w);
    }
}

/* The water's surface inside the ice reflects nothing and bends nothing. */
static void test_what_priority_hides(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    add_ice_in_water(&w, &solid_ice);
    world_ready(&w);
    V3 d = v3_unit(v3(0.2, -1, 0.1));
    Passed p = pass(&w, (Ray){v3_mad(v3(0, 2.2, 0), -1, d), d, 0, INFINITY});
    double sine = sqrt(d.x * d.x + d.z * d.z);
    double share = (1 - reflectance(1, 1.31, sine)) * (1 - reflectance(1.31, 1.33, sine / 1.31)) *
                   (1 - reflectance(1.33, 1, sine / 1.33));
    assert_true(p.is_through && p.reflections == 3);
    assert_true(fabs(p.share - share) < 1e-6);
    assert_true(v3_dist(p.direction, d) < 1e-13);
    world_done(&w);
}

/* With different priorities light goes the same way back, overlap or not. */
static void test_priority_is_the_same_both_ways(void **state)
{
    (void)state;
    const Interior strong = {.ior = 1.5, .priority = 2};
    World w;
    world_init(&w);
    add_glassy(&w, box(&w, v3(-99, -99, 0), v3(99, 99, 1)), &strong);
    add_glassy(&w, box(&w, v3(-99, -99, 0.5), v3(99, 99, 2)), &water);
    world_ready(&w);
    for (int i = 0; i < 8; i++) {
        V3 d = v3_unit(v3(0.2 * i, 0, 1));
        Passed forth = pass(&w, (Ray){v3_scale(d, -1), d, 0, INFINITY});
        Ray back = {v3_add(forth.place, forth.direction), v3_neg(forth.direction), 0, INFINITY};
        Passed again = pass(&w, back);
        assert_true(forth.is_through && again.is_through);
        assert_true(v3_dist(again.direction, v3_neg(d)) < 1e-13);
        assert_true(fabs(again.place.x) < 1e-12);
        assert_true(fabs(forth.share - again.share) < 1e-6);
    }
    world_done(&w);
}

/* --- the eye inside ------------------------------------------------------------------------ */

static void test_the_eye_inside(void **state)
{
    (void)state;
    static const struct {
        V3 at;
        double ior; /* negative: nothing */
    } eyes[] = {{{0.9, 1, 0}, 1.5},  {{-0.5, 1, 0}, 1.33}, {{0.3, 1, 0.1}, 1}, {{0, 1.9, 0}, 1.31},
                {{0, 2.2, 0}, 1.31}, {{0, 2.6, 0}, -1},    {{2, 1, 0}, -1},    {{0, -0.5, 0}, 1.5}};
    World w;
    world_init(&w);
    fill_cup(&w, 0, NULL);
    world_ready(&w);
    for (size_t i = 0; i < sizeof eyes / sizeof *eyes; i++) {
        Interiors inside;
        interiors_at(w.tracer, eyes[i].at, &inside);
        if (eyes[i].ior < 0)
            assert_int_equal(inside.count, 0);
        else
            assert_true(inside.in[inside.count - 1]->ior == eyes[i].ior);
    }
    world_done(&w);
}

/* --- many bodies over each other -------------------------------------------------------------- */

/* Shells from the innermost out, so that the list has to be put in order; `ior` grows inwards. */
static void add_shells(World *w, Interior *interiors, int count)
{
    for (int i = 0; i < count; i++) {
        interiors[i] = (Interior){.ior = 1.5 - 0.01 * i};
        world_add(w, shape_sphere(w->scene.arena, v3(0, 0, 0), 1 + 0.1 * i), clear(w),
                  &interiors[i]);
    }
    world_ready(w);
}

/* Walk straight through the middle of all shells; returns the legs on which the last of the list is
 * not the shell that the leg is in. */
static int wrong_on_the_way(World *w, const Interior *interiors, int count)
{
    int wrong = 0;
    Ray ray = {v3(0, 0, -20), v3(0, 0, 1), 0, INFINITY};
    Interiors inside = {.count = 0};
    Hit hit;
    for (int i = 1; trace_closest(&w->thread, &ray, RAY_CAMERA, &hit); i++) {
        SurfaceSample s;
        surface_sample(&w->thread, &ray, &hit, &inside, &s);
        interiors_copy(&inside, &s.inside_after);
        int shell = i <= count ? count - i : i - count;
        const Interior *last = inside.count > 0 ? inside.in[inside.count - 1] : NULL;
        wrong += last != (shell < count ? &interiors[shell] : NULL);
        ray = trace_ray_from(&s.at, ray.d);
    }
    return wrong;
}

/* A ray knows as many bodies as fit its list, whether it enters them or begins in them; of more it
 * leaves out the outermost, and says so. */
static void test_many_bodies_in_one_place(void **state)
{
    (void)state;
    const int counts[] = {1, 4, 5, 13, 20, INTERIORS_MAX, INTERIORS_MAX + 8};
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        Interior interiors[INTERIORS_MAX + 8];
        int count = counts[i], kept = count < INTERIORS_MAX ? count : INTERIORS_MAX;
        World w;
        world_init(&w);
        add_shells(&w, interiors, count);
        Interiors inside;
        interiors_at(w.tracer, v3(0, 0, 0), &inside);
        assert_int_equal(inside.count, kept);
        assert_int_equal(inside.left_out, count - kept);
        for (int k = 0; k < kept; k++)
            assert_ptr_equal(inside.in[k], &interiors[kept - 1 - k]);
        int wrong = wrong_on_the_way(&w, interiors, count);
        /* From where the first is left out to where the ray has left all but one of those. */
        uint64_t crowded = count > kept ? 2 * (uint64_t)(count - kept) - 1 + INTERIORS_MAX : 0;
        assert_true(w.thread.stats.count[STAT_INTERIORS_CUT] == crowded);
        assert_true((wrong > 0) == (count > kept));
        world_done(&w);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lists_are_what_shapes_say),
        cmocka_unit_test(test_lists_in_a_turned_scene),
        cmocka_unit_test(test_glass_on_water),
        cmocka_unit_test(test_a_gap_is_air),
        cmocka_unit_test(test_three_ways_to_fill_a_cup),
        cmocka_unit_test(test_nested_furnace),
        cmocka_unit_test(test_ice_half_in_water),
        cmocka_unit_test(test_what_priority_hides),
        cmocka_unit_test(test_priority_is_the_same_both_ways),
        cmocka_unit_test(test_the_eye_inside),
        cmocka_unit_test(test_many_bodies_in_one_place),
    };
    return cmocka_run_group_tests_name("nested", tests, NULL, NULL);
}
