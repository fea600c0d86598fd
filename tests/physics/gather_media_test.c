/* Gathered light in media: against closed forms, and against paths.
 * SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "lit_methods.h"

#define HEAD                                                                                       \
    "#version 3.7;\n"                                                                              \
    "global_settings { assumed_gamma 1 max_trace_level 100 adc_bailout 1e-4\n"                     \
    "  pms { global_photons 100000 } }\n"

/* 2 E3(x): what of even light passes a layer of this depth to a floor. */
static double passes_layer(double depth)
{
    enum { STEPS = 100000 };
    double sum = 0;
    for (int i = 0; i < STEPS; i++) {
        double mu = (i + 0.5) / STEPS;
        sum += 2 * mu * exp(-depth / mu) / STEPS;
    }
    return sum;
}

/* A white floor under a layer that absorbs and glows, under a sky: the floor gets e/x of what the
 * layer does not let pass, and the sky through the rest. */
static void floor_under_a_glowing_layer(void **state)
{
    (void)state;
    const double absorption = 0.8, emission = 0.6, sky = 0.5, heights[] = {1, 0.1, 5};
    bool is_good = true;
    for (int i = 0; i < (table_is_long() ? 3 : 1); i++) {
        char text[2048], name[64];
        snprintf(text, sizeof text,
                 HEAD "camera { orthographic location <0,1e-6,0> direction -y right x up z }\n"
                      "background { rgb %g }\n"
                      "box { <-1e4,1e-9,-1e4>, <1e4,%g,1e4> hollow pigment { rgbt 1 }\n"
                      "  finish { ambient 0 diffuse 0 }\n"
                      "  interior { media { absorption %g emission %g } } }\n"
                      "disc { 0, y, 1 pigment { rgb 1 } finish { ambient 0 diffuse 0.5 } }\n",
                 sky, heights[i], absorption, emission);
        double passed = passes_layer(absorption * heights[i]);
        double expected = 0.5 * (sky * passed + emission / absorption * (1 - passed));
        snprintf(name, sizeof name, "floor under a glowing layer of depth %g",
                 absorption * heights[i]);
        const int ways[] = {BY_PATHS, BY_GATHERING, BY_CACHE, BY_PASSES};
        for (int k = 0; k < 4; k++)
            is_good &= method_expect(name, text, &methods[ways[k]], expected, 0.003);
    }
    assert_true(is_good);
}

/* A closed sphere of smoke that loses no light; the wall gives off what it does not reflect. */
static void closed_sphere_of_smoke(void **state)
{
    (void)state;
    bool is_good = true;
    const double depths[] = {0.1, 1};
    for (int i = 0; i < (table_is_long() ? 2 : 1); i++) {
        char text[2048], name[64];
        snprintf(text, sizeof text,
                 HEAD "camera { location <0,0,-0.3> look_at z angle 90 right x up y }\n"
                      "media { scattering { 1, %g extinction 4 } }\n"
                      "sphere { 0, 1 hollow pigment { rgb 1 }\n"
                      "  finish { ambient 0 diffuse 0.5 emission 0.5 } }\n",
                 depths[i] / 4);
        snprintf(name, sizeof name, "closed sphere of smoke, depth %g", depths[i]);
        for (int k = 0; k < METHOD_COUNT; k++)
            is_good &= method_expect(name, text, &methods[k], 1, 0.01);
    }
    assert_true(is_good);
}

/* A lamp in smoke over a floor in a room; by paths and by photons. */
static void smoke_in_a_room(void **state)
{
    (void)state;
    static const struct {
        const char *name, *lamp, *media;
    } cases[] = {
        {"room of smoke", "rgb 2 fade_distance 1 fade_power 2 media_attenuation on",
         "media { scattering { 1, 0.1 extinction 4 } }"},
        {"room of forward smoke", "rgb 1 media_attenuation on",
         "media { scattering { 5, 0.1 eccentricity 0.6 extinction 4 } absorption 0.2 }"},
        {"room of extinction 1, undimmed", "rgb 1", "media { scattering { 1, 0.3 } }"},
    };
    bool is_good = true;
    for (int i = 0; i < (table_is_long() ? 3 : 1); i++) {
        char text[2048];
        snprintf(text, sizeof text,
                 HEAD "camera { location <0,1,-0.95> look_at <0,1,1> angle 80 right x up y }\n"
                      "light_source { <0.3,1.7,0>, %s }\n%s\n"
                      "#default { finish { ambient 0 diffuse 0.6 } }\n"
                      "box { <-1,0,-1>, <1,2,1> hollow pigment { rgb 1 } }\n"
                      "box { <-0.6,0,0>, <0,0.9,0.5> pigment { rgb 0.8 } }\n",
                 cases[i].lamp, cases[i].media);
        double error, paths = method_mean(text, &methods[BY_PATHS], &error);
        print_message("# %s: %.5f +- %.5f by paths\n", cases[i].name, paths, error);
        for (int k = BY_GATHERING; k < METHOD_COUNT; k++)
            is_good &= method_expect(cases[i].name, text, &methods[k], paths,
                                     4 * error / paths + (k == BY_MAP ? 0.03 : 0.01));
    }
    assert_true(is_good);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(floor_under_a_glowing_layer),
        cmocka_unit_test(closed_sphere_of_smoke),
        cmocka_unit_test(smoke_in_a_room),
    };
    return cmocka_run_group_tests_name("gather_media", tests, NULL, NULL);
}
