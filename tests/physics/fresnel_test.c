/* Reflection at dielectrics against Fresnel's equations in their textbook form (amplitudes of
 * both polarisations from the two angles), and energy: clear glass in even light is invisible.
 * SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "../unit/world.h"
#include "table.h"

/* Reflectance of unpolarised light from a medium of ior n1 onto one of n2; p-polarised apart. */
static double reflectance(double n1, double n2, double angle, double *p_part)
{
    double sine = n1 / n2 * sin(angle);
    *p_part = 1;
    if (sine >= 1)
        return 1;
    double c1 = cos(angle), c2 = sqrt(1 - sine * sine);
    double rs = (n1 * c1 - n2 * c2) / (n1 * c1 + n2 * c2);
    double rp = (n1 * c2 - n2 * c1) / (n1 * c2 + n2 * c1);
    *p_part = rp * rp;
    return 0.5 * (rs * rs + rp * rp);
}

static const Texture *fresnel_glass(World *w)
{
    Finish finish = dull;
    finish.reflection_max = RGB_WHITE;
    finish.is_fresnel = true;
    finish.conserves_energy = true;
    return flat(w, (Color5){1, 1, 1, 0, 1}, &finish);
}

static void sample_block(double ior, double angle, bool is_from_inside, SurfaceSample *out)
{
    World w;
    world_init(&w);
    const Interior glass = {.ior = ior};
    world_add(&w, box(&w, v3(-9, -9, 0), v3(9, 9, 1)), fresnel_glass(&w), &glass);
    world_ready(&w);
    V3 d = v3(sin(angle), 0, cos(angle));
    Ray ray = {v3_scale(d, -1e-3), d, 0, INFINITY};
    if (is_from_inside)
        ray.o = v3_add(ray.o, v3(0, 0, 1));
    Interiors inside;
    interiors_at(w.tracer, ray.o, &inside);
    Hit hit;
    assert_true(trace_closest(&w.thread, &ray, RAY_CAMERA, &hit));
    surface_sample(&w.thread, &ray, &hit, &inside, out);
    world_done(&w);
}

/* Row S6: the reflectance by which photons and rays are split, and Snell's law. */
static void test_fresnel_equations(void **state)
{
    (void)state;
    static const double iors[] = {1.0003, 1.33, 1.5, 2.42};
    for (size_t k = 0; k < sizeof iors / sizeof *iors; k++) {
        for (int degrees = 0; degrees < 90; degrees++) {
            double angle = degrees * PMS_PI / 180, p_part;
            SurfaceSample s;
            sample_block(iors[k], angle, false, &s);
            double expected = reflectance(1, iors[k], angle, &p_part);
            assert_true(fabs((double)s.layers[0].reflect.r - expected) < 1e-6);
            assert_true(fabs((double)s.filter.r - (1 - expected)) < 1e-6);
            /* Snell's law */
            if (s.has_transmission)
                assert_true(fabs(s.transmit_dir.x * iors[k] - sin(angle)) < 1e-14);
            sample_block(iors[k], angle, true, &s);
            expected = reflectance(iors[k], 1, angle, &p_part);
            if (expected < 1)
                assert_true(fabs((double)s.layers[0].reflect.r - expected) < 1e-6);
            else /* all of it is in one mirrored ray: reflected, or transmitted as total reflection
                  */
                assert_true(s.has_transmission ? s.is_total_reflection
                                               : s.layers[0].reflect.r == 1);
        }
    }
}

static void test_brewster_angle(void **state)
{
    (void)state;
    double p_part, angle = atan(1.5);
    SurfaceSample s;
    sample_block(1.5, angle, false, &s);
    double r = reflectance(1, 1.5, angle, &p_part);
    assert_true(p_part < 1e-30);
    assert_true(fabs((double)s.layers[0].reflect.r - r) < 1e-7);
    assert_true(fabs(v3_dot(s.layers[0].reflect_dir, s.transmit_dir)) < 1e-15);
}

/* Row S6: beyond the critical angle all is reflected. */
static void test_critical_angle(void **state)
{
    (void)state;
    double critical = asin(1 / 1.5);
    Finish plain = dull;
    for (int side = -1; side <= 1; side += 2) {
        World w;
        world_init(&w);
        const Interior glass = {.ior = 1.5};
        world_add(&w, box(&w, v3(-9, -9, 0), v3(9, 9, 1)),
                  flat(&w, (Color5){1, 1, 1, 0, 1}, &plain), &glass);
        world_ready(&w);
        double angle = critical + side * 1e-6;
        Ray ray = {{0, 0, 0.5}, v3(sin(angle), 0, cos(angle)), 0, INFINITY};
        Interiors inside;
        interiors_at(w.tracer, ray.o, &inside);
        Hit hit;
        SurfaceSample s;
        assert_true(trace_closest(&w.thread, &ray, RAY_CAMERA, &hit));
        surface_sample(&w.thread, &ray, &hit, &inside, &s);
        assert_true(s.has_transmission && s.is_total_reflection == (side > 0));
        assert_true(side > 0 ? s.transmit_dir.z < 0 : s.transmit_dir.z > 0);
        world_done(&w);
    }
}

/* Light is neither made nor lost: in an even surround of radiance 1 a ball, a ball in a ball
 * and a slab of conserving glass all show radiance 1. */
static void test_white_furnace(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    w.scene.background.color = (Color5){1, 1, 1, 0, 0};
    w.scene.settings.adc_bailout = 1e-7;
    w.scene.settings.max_trace_level = 40;
    const Interior glass = {.ior = 1.5}, water = {.ior = 1.33};
    Arena *arena = w.scene.arena;
    world_add(&w, shape_sphere(arena, v3(0, 0, 0), 1), fresnel_glass(&w), &glass);
    world_add(&w, shape_sphere(arena, v3(0.2, 0, 0), 0.5), fresnel_glass(&w), &water);
    world_add(&w, box(&w, v3(-5, 2, -1), v3(5, 2.5, 1)), fresnel_glass(&w), &glass);
    world_ready(&w);
    double mean = 0;
    for (int i = 0; i < 60; i++) {
        Ray ray = {{-1.2 + 0.04 * i, -0.3 + 0.05 * i, -10}, {0, 0, 1}, 0, INFINITY};
        Interiors inside = {.count = 0};
        Rgb seen = look_along(&w, &ray, RAY_CAMERA, &inside, 0, 1, false);
        assert_true(fabs((double)seen.g - 1) < 2e-4);
        mean += (double)seen.g / 60;
    }
    table_row("white surround, balls and slab of glass", mean, 1, 0);
    world_done(&w);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_fresnel_equations),
        cmocka_unit_test(test_brewster_angle),
        cmocka_unit_test(test_critical_angle),
        cmocka_unit_test(test_white_furnace),
    };
    return cmocka_run_group_tests_name("fresnel", tests, NULL, NULL);
}
