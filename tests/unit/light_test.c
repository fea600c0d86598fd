/* Light sources against povray 3.7: a white plane z = 0 of diffuse 1, seen from -z, lit from
 * <1,0,-5>; the numbers are its 16-bit pixels at x = -3.5, -2.5 ... 3.5.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/trace.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#define DEG (PMS_PI / 180)

/* Half a step of 16 bits, and the five digits the table has. */
#define TOLERANCE 1.4e-5

static Light light_towards(LightKind kind, V3 point_at)
{
    Light light = {.kind = kind, .location = {1, 0, -5}, .point_at = point_at, .color = {1, 1, 1}};
    light.direction = v3_unit(v3_sub(point_at, light.location));
    return light;
}

static void set_cone(Light *light, double radius, double falloff)
{
    light->radius = radius;
    light->falloff = falloff;
    light->cos_radius = cos(radius);
    light->cos_falloff = cos(falloff);
}

static double radiance_at(const Light *light, V3 p)
{
    LightSample sample = light_at(light, light->location, p);
    return (double)sample.color.r * fmax(0, -sample.to_light.z);
}

static void check_row(const Light *light, const double expected[8])
{
    for (int i = 0; i < 8; i++)
        assert_true(fabs(radiance_at(light, v3(-3.5 + i, 0, 0)) - expected[i]) < TOLERANCE);
}

static void test_spotlight(void **state)
{
    (void)state;
    Light light = light_towards(LIGHT_SPOT, v3(0, 0, 0));
    set_cone(&light, 20 * DEG, 40 * DEG);
    check_row(&light, (const double[]){0.41769, 0.77693, 0.89442, 0.95782, 0.99504, 0.99504,
                                       0.71728, 0.04402});
    set_cone(&light, 10 * DEG, 45 * DEG);
    light.tightness = 7;
    check_row(&light, (const double[]){0.14900, 0.37414, 0.68547, 0.92857, 0.96228, 0.70568,
                                       0.27820, 0.03607});
    assert_true(light_shape_factor(&light, light.location, v3(2, 0, -9)) == 0);
}

static void test_spotlight_without_soft_edge(void **state)
{
    (void)state;
    Light light = light_towards(LIGHT_SPOT, v3(1, 0, 0));
    set_cone(&light, 45 * DEG, 45 * DEG);
    assert_true(light_shape_factor(&light, light.location, v3(5.9, 0, 0)) == 1);
    assert_true(light_shape_factor(&light, light.location, v3(6.1, 0, 0)) == 0);
}

static void test_cylinder_light(void **state)
{
    (void)state;
    Light light = light_towards(LIGHT_CYLINDER, v3(0, 0, 0));
    light.radius = 1;
    light.falloff = 3;
    check_row(&light, (const double[]){0, 0.18083, 0.84311, 0.98058, 0.98058, 0.84311, 0.18083, 0});
    light.tightness = 2;
    check_row(&light, (const double[]){0, 0.00604, 0.21904, 0.68626, 0.68626, 0.21904, 0.00604, 0});
    assert_true(light_shape_factor(&light, light.location, v3(1.1, 0, -6)) == 0);
}

static void test_fading(void **state)
{
    (void)state;
    Light point = light_towards(LIGHT_POINT, v3(0, 0, 0));
    point.color = rgb_gray(0.5f);
    point.fade_distance = 6;
    point.fade_power = 2;
    check_row(&point, (const double[]){0.32934, 0.40262, 0.47880, 0.54516, 0.58483, 0.58483,
                                       0.54516, 0.47880});
    Light parallel = point;
    parallel.is_parallel = true;
    parallel.fade_power = 1.5;
    check_row(&parallel, (const double[]){0.50369, 0.51633, 0.52941, 0.54292, 0.55685, 0.57122,
                                          0.58605, 0.60133});
    Light beam = light_towards(LIGHT_CYLINDER, v3(0, 0, 0));
    beam.color = rgb_gray(0.5f);
    beam.radius = 3;
    beam.falloff = 5;
    beam.fade_distance = 6;
    beam.fade_power = 3;
    check_row(&beam, (const double[]){0.45509, 0.54224, 0.56805, 0.59434, 0.62100, 0.64787, 0.67477,
                                      0.61747});
}

static void test_no_fading(void **state)
{
    (void)state;
    Light light = light_towards(LIGHT_POINT, v3(0, 0, 0));
    light.fade_power = 2;
    assert_true(light_fade(&light, 100) == 1);
    light.fade_distance = 1;
    assert_true(light_fade(&light, 0) == 2);
    assert_true(light_fade(&light, INFINITY) == 0);
    light.fade_power = 0;
    assert_true(light_fade(&light, 100) == 1);
}

static void test_parallel_distance_is_to_the_plane(void **state)
{
    (void)state;
    Light light = light_towards(LIGHT_POINT, v3(1, 0, 0));
    light.is_parallel = true;
    LightSample front = light_at(&light, light.location, v3(7, 3, 0));
    assert_true(front.distance == 5 && front.to_light.z == -1);
    LightSample behind = light_at(&light, light.location, v3(7, 3, -8));
    assert_true(behind.distance == -3 && behind.to_light.z == -1 && behind.color.r == 1);
}

static void test_point_on_the_light(void **state)
{
    (void)state;
    Light light = light_towards(LIGHT_SPOT, v3(0, 0, 0));
    set_cone(&light, 1, 1);
    LightSample sample = light_at(&light, light.location, light.location);
    assert_true(sample.distance == 0 && rgb_is_finite(sample.color) &&
                v3_is_finite(sample.to_light));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_spotlight),
        cmocka_unit_test(test_spotlight_without_soft_edge),
        cmocka_unit_test(test_cylinder_light),
        cmocka_unit_test(test_fading),
        cmocka_unit_test(test_no_fading),
        cmocka_unit_test(test_parallel_distance_is_to_the_plane),
        cmocka_unit_test(test_point_on_the_light),
    };
    return cmocka_run_group_tests_name("light", tests, NULL, NULL);
}
