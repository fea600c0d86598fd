/* Direct light on a layer against povray 3.7: a plane z = 0 of colour <.9,.5,.2>, seen from -z,
 * lit from <1,2,-5> by <1,.8,.6>; the numbers are its 16-bit pixels along x.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/trace.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#define TOLERANCE 1.6e-5 /* half a step of 16 bits, five digits, float colours */

static const SceneSettings settings = {.irid_wavelength = {0.70f, 0.52f, 0.48f}};

typedef struct Setup {
    Finish finish;
    Light light;
    float opacity;
    bool is_double;
} Setup;

static Setup setup(void)
{
    Setup s = {.finish = FINISH_DEFAULT, .opacity = 1};
    s.light = (Light){.location = {1, 2, -5}, .color = {1, 0.8f, 0.6f}};
    return s;
}

static Rgb radiance_at(const Setup *s, double x)
{
    SurfaceSample sample = {.at = {.p = {x, 0, 0}}, .wo = {0, 0, -1}, .settings = &settings};
    SurfaceLayer layer = {.color = {0.9f, 0.5f, 0.2f},
                          .opacity = s->opacity,
                          .above = {1, 1, 1},
                          .finish = &s->finish,
                          .n = {0, 0, -1}};
    LightSample light = light_at(&s->light, s->light.location, sample.at.p);
    Rgb k = layer_direct(&layer, &sample, light.to_light, true, s->is_double);
    return rgb_mul(k, light.color);
}

static void check(const Setup *s, double x, double r, double g, double b)
{
    Rgb c = radiance_at(s, x);
    assert_true(fabs((double)c.r - r) < TOLERANCE);
    assert_true(fabs((double)c.g - g) < TOLERANCE);
    assert_true(fabs((double)c.b - b) < TOLERANCE);
}

static void test_brilliance(void **state)
{
    (void)state;
    Setup s = setup();
    s.finish.diffuse = 0.7f;
    s.finish.brilliance = 3.5f;
    check(&s, -3.5, 0.19232, 0.08548, 0.02564);
    check(&s, -0.5, 0.42634, 0.18949, 0.05684);
    check(&s, 1.5, 0.47864, 0.21273, 0.06381);
}

static void test_back(void **state)
{
    (void)state;
    Setup s = setup();
    s.light.location = v3(1, 2, 5);
    s.finish.diffuse = 0.7f;
    s.finish.brilliance = 2;
    s.finish.phong = 1;
    assert_true(rgb_is_black(radiance_at(&s, 0)));
    s.finish.diffuse_back = 0.3f;
    check(&s, -3.5, 0.13706, 0.06091, 0.01828);
    check(&s, 1.5, 0.23076, 0.10257, 0.03076);
    s.is_double = true;
    check(&s, -2.5, 0.38181, 0.16970, 0.05090);
    check(&s, 0.5, 0.53846, 0.23932, 0.07179);
}

static void test_phong(void **state)
{
    (void)state;
    Setup s = setup();
    s.finish.diffuse = 0;
    s.finish.phong = 0.8f;
    s.finish.phong_size = 12;
    check(&s, -3.5, 0.01369, 0.01096, 0.00821);
    check(&s, 0.5, 0.31186, 0.24950, 0.18712);
}

static void test_specular(void **state)
{
    (void)state;
    Setup s = setup();
    s.finish.diffuse = 0;
    s.finish.specular = 0.8f;
    s.finish.roughness = 0.08f;
    check(&s, -2.5, 0.38415, 0.30732, 0.23049);
    check(&s, 1.5, 0.62899, 0.50318, 0.37739);
    s.finish.metallic = 0.7f;
    check(&s, -3.5, 0.28257, 0.15987, 0.08267);
    check(&s, 1.5, 0.58529, 0.32840, 0.16765);
}

static void test_metallic_at_grazing_light(void **state)
{
    (void)state;
    Setup s = setup();
    s.finish.diffuse = 0;
    s.finish.phong = 0.8f;
    s.finish.phong_size = 2;
    s.finish.metallic = 1;
    s.light = (Light){.location = {30, 2, -5}, .color = {1, 1, 1}};
    check(&s, -3.5, 0.01616, 0.01134, 0.00772);
    check(&s, 3.5, 0.02528, 0.01703, 0.01082);
}

static void test_iridescence(void **state)
{
    (void)state;
    Setup s = setup();
    s.finish.diffuse = 0.5f;
    s.finish.specular = 0.3f;
    s.finish.roughness = 0.1f;
    s.finish.irid = 0.4f;
    s.finish.irid_thickness = 0.6f;
    check(&s, -3.5, 0.27893, 0.35297, 0.15747);
    check(&s, -1.5, 0.37459, 0.41985, 0.14777);
    check(&s, 0.5, 0.50694, 0.41105, 0.13631);
}

static void test_opacity_dims_diffuse_only(void **state)
{
    (void)state;
    Setup s = setup();
    s.finish.diffuse = 0.7f;
    s.finish.specular = 0.3f;
    s.opacity = 0.5f;
    check(&s, -3.5, 0.28797, 0.15058, 0.06806);
    check(&s, 1.5, 0.49540, 0.29277, 0.16133);
}

static void test_crand(void **state)
{
    (void)state;
    Setup smooth = setup(), rough = setup();
    rough.finish.crand = 0.25f;
    double sum = 0;
    enum { COUNT = 4096 };
    for (int i = 0; i < COUNT; i++) {
        double x = (i + 0.5) / COUNT;
        Rgb a = radiance_at(&smooth, x), b = radiance_at(&rough, x), again = radiance_at(&rough, x);
        assert_true(b.r == again.r);
        sum += (double)((a.r - b.r) / (0.9f * 0.25f));
    }
    /* uniform in [0,1): mean 1/2, standard error 1/sqrt(12 n) */
    assert_true(fabs(sum / COUNT - 0.5) < 4 / sqrt(12.0 * COUNT));
}

static void test_diffuse_of_layers(void **state)
{
    (void)state;
    const Finish a = {.diffuse = 0.5f}, b = {.diffuse = 1};
    SurfaceSample s = {.layer_count = 2};
    s.layers[0] =
        (SurfaceLayer){.color = {1, 0.5f, 0}, .opacity = 0.5f, .above = {1, 1, 1}, .finish = &a};
    s.layers[1] = (SurfaceLayer){
        .color = {0.5f, 0.5f, 1}, .opacity = 1, .above = {0.5f, 0.5f, 0.5f}, .finish = &b};
    Rgb d = surface_diffuse(&s);
    assert_true(d.r == 0.5f && d.g == 0.375f && d.b == 0.5f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_brilliance),
        cmocka_unit_test(test_back),
        cmocka_unit_test(test_phong),
        cmocka_unit_test(test_specular),
        cmocka_unit_test(test_metallic_at_grazing_light),
        cmocka_unit_test(test_iridescence),
        cmocka_unit_test(test_opacity_dims_diffuse_only),
        cmocka_unit_test(test_crand),
        cmocka_unit_test(test_diffuse_of_layers),
    };
    return cmocka_run_group_tests_name("shade", tests, NULL, NULL);
}
