/* Paths in media against closed forms, a walk through a slab, and the photons in media, with which
 * they share no code.  SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "lit_paths.h"
#include "slab_walk.h"

#include "texture/media.h"

#define HEAD "#version 3.7;\nglobal_settings { assumed_gamma 1 max_trace_level 200\n"
#define EYE "camera { orthographic location <0,0,-10> direction z right x*1 up y*1 }\n"

/* --- known light ------------------------------------------------------------------------------ */

/* Irradiance 1 on a slab.  The walk scatters the part `albedo` of what collides; the eye is shown
 * what the medium's scattering says, 1/extinction of that. */
static void slab(void **state)
{
    (void)state;
    const int groups = table_is_long() ? 8000 : 2000;
    const struct {
        double depth, albedo, extinction;
    } cases[] = {{0.5, 1, 4}, {2, 1, 4}, {2, 0.7, 4}, {0.5, 0.7, 1}, {2, 0.9, 2}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        double depth = cases[i].depth, albedo = cases[i].albedo, e = cases[i].extinction;
        char text[2048], name[96];
        snprintf(text, sizeof text,
                 HEAD "}\n" EYE "light_source { <0,0,-50> 1 parallel point_at 0 }\n"
                      "box { <-99,-99,0>, <99,99,%g> hollow pigment { rgbt 1 }\n"
                      "  finish { ambient 0 diffuse 0 } interior {\n"
                      "  media { scattering { 1, %g extinction %g } absorption %g } } }\n",
                 depth, albedo / e, e, 1 - albedo);
        Mean mean = measure(text, 0, groups, NULL, NULL);
        double walk_error, walk = slab_walk(depth, albedo, 1000000, &walk_error) / e;
        snprintf(name, sizeof name, "slab of depth %g, albedo %g, extinction %g", depth, albedo, e);
        check(name, mean.part[PART_INDIRECT], walk,
              hypot(mean.part_error[PART_INDIRECT], walk_error / e));
        double once = albedo / e * (1 - exp(-2 * depth)) / 2;
        assert_true(fabs(mean.part[PART_DIRECT] / once - 1) < 0.002);
        assert_true(mean.part[PART_CAUSTIC] == 0);
    }
}

/* Where nothing is lost nothing is seen: smoke under a white sky.  What the eye is shown of haze is
 * more than all it scatters, by the language's constants. */
static void smoke_in_a_furnace(void **state)
{
    (void)state;
    static const struct {
        const char *name, *media;
        PhaseKind phase;
    } cases[] = {
        {"smoke of depth 0.6", "media { scattering { 1, 0.075 extinction 4 } }", PHASE_ISOTROPIC},
        {"smoke of depth 6", "media { scattering { 1, 0.75 extinction 4 } }", PHASE_ISOTROPIC},
        {"haze", "media { scattering { 2, 0.25 extinction 4 } }", PHASE_MIE_HAZY},
        {"murky haze", "media { scattering { 3, 0.25 extinction 4 } }", PHASE_MIE_MURKY},
        {"Rayleigh's", "media { scattering { 4, 0.25 extinction 4 } }", PHASE_RAYLEIGH},
        {"forward", "media { scattering { 5, 0.25 eccentricity 0.8 extinction 4 } }",
         PHASE_HENYEY_GREENSTEIN},
        {"uneven smoke",
         "media { scattering { 1, 0.5 extinction 4 }\n"
         "  density { gradient y scale 2 translate -y } samples 60 }",
         PHASE_ISOTROPIC},
        {"two kinds",
         "media { scattering { 1, 0.2 extinction 4 } }\n"
         "media { scattering { 5, 0.3 eccentricity -0.5 extinction 4 } }",
         PHASE_ISOTROPIC},
        {"smoke that glows",
         "media { scattering { 1, 0.125 extinction 4 } absorption 0.5 emission 0.5 }",
         PHASE_ISOTROPIC},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[2048];
        snprintf(text, sizeof text,
                 HEAD "}\n" EYE "background { rgb 1 }\n"
                      "box { -1, 1 hollow pigment { rgbt 1 } finish { ambient 0 diffuse 0 }\n"
                      "  interior { %s } }\n",
                 cases[i].media);
        Mean mean = measure(text, 0, 1000, NULL, NULL);
        double more = (phase_mean(cases[i].phase) - 1) * (1 - exp(-2));
        check(cases[i].name, mean.sum, 1 + more, mean.error + 1e-5);
        assert_true(mean.error < 0.00125);
    }
}

/* A closed sphere that gives off what it does not reflect, full of smoke: radiance 1. */
static void closed_sphere_of_smoke(void **state)
{
    (void)state;
    const double thick[] = {0.1, 1, 10};
    for (int i = 0; i < 3; i++) {
        char text[1024], name[64];
        snprintf(text, sizeof text,
                 HEAD "}\n"
                      "camera { location <0.3,0.1,0.2> look_at <0,1,0.3> angle 100 }\n"
                      "media { scattering { 5, %g eccentricity 0.5 extinction 4 } }\n"
                      "sphere { 0, 1 hollow pigment { rgb 1 }\n"
                      "  finish { ambient 0 diffuse 0.5 emission 0.5 } }\n",
                 thick[i] / 4);
        Mean mean = measure(text, 0, table_is_long() ? 16000 : 4000, NULL, NULL);
        snprintf(name, sizeof name, "closed sphere of smoke, depth %g", thick[i]);
        check(name, mean.sum, 1, mean.error);
        assert_true(mean.error < 0.0025);
    }
}

/* The same, lit from its middle, with a wall that keeps half: all of the flux arrives, wherever the
 * smoke sends it.  Each place of the wall is alike, so a black ball seen from inside it shows
 * nothing but the wall's light, 1/2 of flux / (area / 2). */
static void lamp_in_smoke(void **state)
{
    (void)state;
    const double thick[] = {1e-6, 0.5, 3}, far = 2e-4, flux = 4 * PMS_PI * 2 * far * far;
    for (int i = 0; i < 3; i++) {
        char text[1024], name[64];
        snprintf(text, sizeof text,
                 HEAD "}\n"
                      "camera { location <0,0,0.9999999> look_at <0,0,2> angle 100 }\n"
                      "light_source { 0 %g fade_distance %g fade_power 2 media_attenuation on }\n"
                      "media { scattering { 5, %g eccentricity 0.5 extinction 4 } }\n"
                      "sphere { 0, 1 hollow pigment { rgb 1 } finish { ambient 0 diffuse 0.5 } }\n",
                 4 * PMS_PI / flux, far, thick[i] / 4);
        Mean mean = measure(text, 0, 2000, NULL, NULL);
        snprintf(name, sizeof name, "wall of a sphere of smoke, depth %g", thick[i]);
        check(name, mean.sum, 1, mean.error);
    }
}

/* Scattering that costs the ray nothing adds all that comes: 4 times it, see texture/media.h. */
static void scattering_without_extinction(void **state)
{
    (void)state;
    Mean mean = measure(HEAD "}\n" EYE "background { rgb 1 }\n"
                             "box { <-9,-9,0>, <9,9,2> hollow pigment { rgbt 1 }\n"
                             "  interior { media { scattering { 1, 0.1 extinction 0 } } } }\n",
                        0, 1000, NULL, NULL);
    check("scattering without extinction", mean.sum, 1 + 4 * 0.1 * 2, mean.error);
}

/* --- against photons -------------------------------------------------------------------------- */

enum { SEEDS = 8, NEAREST = 30 };

/* The mean over the film by photons, of several maps (green). */
static Mean by_photons(const char *text, int samples)
{
    Mean mean = {.sum = 0};
    double squares[PART_COUNT] = {0};
    for (int seed = 1; seed <= SEEDS; seed++) {
        LitScene lit;
        EyeThread *eye;
        VolumeIndex *volume;
        lit_make(&lit, text, 2, (uint64_t)seed);
        assert_non_null(lit.maps.volume);
        assert_int_equal(
            volume_index_new(lit.tracer, lit.maps.volume, NEAREST, 0, 2, &lit.diag, &volume), OK);
        EyeOptions options = {.width = 1, .height = 1, .seed = 3, .volume = volume};
        assert_int_equal(eye_thread_new(lit.tracer, &options, &lit.diag, &eye), OK);
        double part[PART_COUNT] = {0};
        for (int i = 0; i < samples; i++) {
            EyeSample sample;
            Rng rng = rng_at(11, (uint32_t)seed, (uint64_t)i);
            double x = rng_double(&rng), y = rng_double(&rng);
            assert_true(eye_sample(eye, x, y, 0, (uint32_t)i, &sample));
            for (int k = 0; k < PART_COUNT; k++)
                part[k] += (double)sample.part[k].g / samples;
        }
        for (int k = 0; k < PART_COUNT; k++) {
            mean.part[k] += part[k];
            squares[k] += part[k] * part[k];
        }
        eye_thread_free(eye, NULL);
        volume_index_free(volume);
        lit_done(&lit);
    }
    for (int k = 0; k < PART_COUNT; k++) {
        mean.part_error[k] = error_of(mean.part[k], squares[k], SEEDS);
        mean.part[k] /= SEEDS;
    }
    return mean;
}

#define BLACK_WALL                                                                                 \
    "box { <-0.8,-0.8,0.9>, <0.8,0.8,0.95> pigment { rgb 0 } finish { diffuse 0 } }\n"

/* What smoke in a room scatters more than once, or after the walls, before a black wall: the media
 * alone send light to the eye. */
static void smoke_in_a_room_agrees_with_photons(void **state)
{
    (void)state;
    static const struct {
        const char *name, *light, *media;
    } cases[] = {
        {"lamp in smoke by photons and paths", "rgb 1 media_attenuation on",
         "media { scattering { 1, 0.15 extinction 4 } }"},
        {"the same, the lamp undimmed to the eye", "rgb 1",
         "media { scattering { 1, 0.15 extinction 4 } }"},
        {"forward, half absorbed", "rgb 1 fade_distance 0.5 fade_power 2 media_attenuation on",
         "media { scattering { 5, 0.15 eccentricity 0.6 extinction 3 } absorption 0.3 }"},
        {"of extinction 1 and 0", "rgb 1 media_attenuation on",
         "media { scattering { 1, 0.3 } } media { scattering { 4, 0.1 extinction 0 } }"},
        {"in a body that fades light", "rgb 1 media_attenuation on",
         "box { -0.99, 0.99 hollow pigment { rgbt 1 } finish { diffuse 0 } interior {\n"
         "  fade_power 1001 fade_distance 0.7 media { scattering { 1, 0.15 extinction 4 } } } }"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[2048];
        snprintf(
            text, sizeof text,
            HEAD
            "adc_bailout 1e-4 pms { gi on gi_method map global_photons 100000 } }\n"
            "camera { orthographic location <0,0,-0.9> direction z right x up y }\n"
            "light_source { <0.3,0.7,-0.2>, %s }\n%s\n"
            "box { -1, 1 hollow pigment { rgb 1 } finish { ambient 0 diffuse 0.5 } }\n" BLACK_WALL,
            cases[i].light, cases[i].media);
        Mean photons = by_photons(text, 600);
        Mean paths = measure(text, 0, 3000, NULL, NULL);
        check(cases[i].name, paths.part[PART_INDIRECT], photons.part[PART_INDIRECT],
              hypot(paths.part_error[PART_INDIRECT], photons.part_error[PART_INDIRECT]));
        double error = hypot(paths.part_error[PART_DIRECT], photons.part_error[PART_DIRECT]);
        assert_true(fabs(paths.part[PART_DIRECT] - photons.part[PART_DIRECT]) < 4 * error + 1e-5);
    }
}

/* What a glass ball and a mirror focus into smoke. */
static void focus_in_smoke_agrees_with_photons(void **state)
{
    (void)state;
    const char *text =
        HEAD "photons { count 200000 media 10 } }\n"
             "camera { orthographic location <0,0.2,-3> direction z right 2*x up 2*y }\n"
             "light_source { <0.2,3,0>, rgb 1 area_light 2*x, 2*z, 9, 9 jitter\n"
             "  media_attenuation on photons { area_light } }\n"
             "box { <-3,-2,-3.5>, <3,4,3> hollow pigment { rgb 0 } finish { diffuse 0 } }\n"
             "box { <-2,-1.5,-2>, <2,2.5,2> hollow pigment { rgbt 1 } finish { diffuse 0 }\n"
             "  interior { media { scattering { 1, 0.05 extinction 4 } } }\n"
             "  photons { pass_through } }\n"
             "sphere { <-0.5,1,0>, 0.4 pigment { rgbt 1 } finish { diffuse 0 }\n"
             "  interior { ior 1.5 } photons { target refraction on reflection off } }\n"
             "box { <0.2,-0.9,-0.6>, <1.2,-0.8,0.6> pigment { rgb 0 }\n"
             "  finish { diffuse 0 reflection 0.8 } photons { target reflection on } }\n";
    Mean photons = by_photons(text, 600);
    Mean paths = measure(text, 0, 20000, NULL, NULL);
    check("light focused in smoke", paths.part[PART_CAUSTIC], photons.part[PART_CAUSTIC],
          hypot(paths.part_error[PART_CAUSTIC], photons.part_error[PART_CAUSTIC]));
    assert_true(paths.part_error[PART_CAUSTIC] < 0.03 * paths.part[PART_CAUSTIC]);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slab),
        cmocka_unit_test(smoke_in_a_furnace),
        cmocka_unit_test(closed_sphere_of_smoke),
        cmocka_unit_test(lamp_in_smoke),
        cmocka_unit_test(scattering_without_extinction),
        cmocka_unit_test(smoke_in_a_room_agrees_with_photons),
        cmocka_unit_test(focus_in_smoke_agrees_with_photons),
    };
    return cmocka_run_group_tests_name("path_media", tests, NULL, NULL);
}
