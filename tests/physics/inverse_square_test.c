/* The language's fading obeys the inverse square law far from the light: the flux through any
 * closed surface around it is the same.  In the language's units, without pi, a light of
 * colour 1 far beyond its fade_distance f has irradiance 2 (f/d)^2, so its flux is 8 pi f^2.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/trace.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "table.h"

static Light small_light(V3 location)
{
    return (Light){.kind = LIGHT_POINT,
                   .location = location,
                   .color = {1, 1, 1},
                   .fade_distance = 1e-3,
                   .fade_power = 2};
}

static double irradiance(const Light *light, V3 p, V3 n)
{
    LightSample sample = light_at(light, light->location, p);
    return (double)sample.color.g * fmax(0, v3_dot(sample.to_light, n));
}

static void test_ratio(void **state)
{
    (void)state;
    Light light = small_light(v3(0, 0, 0));
    V3 n = v3(-1, 0, 0);
    for (double d = 1; d < 1e6; d *= 10) {
        double near = irradiance(&light, v3(d, 0, 0), n);
        double far = irradiance(&light, v3(3 * d, 0, 0), n);
        assert_true(fabs(near / far / 9 - 1) < 2e-6); /* (f/d)^2 and float */
    }
}

static void test_cosine(void **state)
{
    (void)state;
    Light light = small_light(v3(0, 0, 0));
    double straight = irradiance(&light, v3(0, 0, 7), v3(0, 0, -1));
    for (int degrees = 0; degrees < 90; degrees += 10) {
        double a = degrees * PMS_PI / 180;
        double slanted = irradiance(&light, v3(0, 0, 7), v3(sin(a), 0, -cos(a)));
        assert_true(fabs(slanted / straight - cos(a)) < 1e-7);
    }
}

/* A point light at height h over a plane: irradiance falls as h / (h^2 + r^2)^(3/2). */
static void test_plane(void **state)
{
    (void)state;
    const double h = 1.5;
    Light light = small_light(v3(0, h, 0));
    double below = irradiance(&light, v3(0, 0, 0), v3(0, 1, 0));
    for (int r = 1; r <= 5; r += 2) {
        char what[64];
        double seen = irradiance(&light, v3(r, 0, 0), v3(0, 1, 0)) / below;
        double expected = h * h * h / pow(h * h + r * r, 1.5);
        snprintf(what, sizeof what, "point light over a plane, %d from below it", r);
        table_row(what, seen, expected, 0);
        assert_true(fabs(seen / expected - 1) < 2e-6);
    }
}

/* The flux into a box around the light, by the midpoint rule on its faces. */
static double flux_into_box(const Light *light, V3 half)
{
    enum { STEPS = 200 };
    double sum = 0, size[3] = {half.x, half.y, half.z};
    for (int face = 0; face < 6; face++) {
        int a = face / 2, b = (a + 1) % 3, c = (a + 2) % 3;
        double side = face % 2 ? 1 : -1, area = 4 * size[b] * size[c] / STEPS / STEPS;
        for (int i = 0; i < STEPS * STEPS; i++) {
            double p[3], n[3] = {0, 0, 0};
            p[a] = side * size[a];
            p[b] = (2 * (i % STEPS + 0.5) / STEPS - 1) * size[b];
            p[c] = (2 * (i / STEPS + 0.5) / STEPS - 1) * size[c];
            n[a] = -side;
            sum += area * irradiance(light, v3(p[0], p[1], p[2]), v3(n[0], n[1], n[2]));
        }
    }
    return sum;
}

static void test_flux_is_the_same_through_every_box(void **state)
{
    (void)state;
    Light light = small_light(v3(0.2, -0.1, 0.3));
    double expected = 8 * PMS_PI * light.fade_distance * light.fade_distance;
    assert_true(fabs(flux_into_box(&light, v3(1, 1, 1)) / expected - 1) < 1e-4);
    assert_true(fabs(flux_into_box(&light, v3(5, 2, 9)) / expected - 1) < 3e-4);
    assert_true(fabs(flux_into_box(&light, v3(100, 100, 70)) / expected - 1) < 1e-4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_ratio),
        cmocka_unit_test(test_cosine),
        cmocka_unit_test(test_plane),
        cmocka_unit_test(test_flux_is_the_same_through_every_box),
    };
    return cmocka_run_group_tests_name("inverse_square", tests, NULL, NULL);
}
