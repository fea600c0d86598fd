/* The light of photons on surfaces that are not merely matt: the finish decides, for the direction
 * each photon came from, as it does for light that came straight.
 * SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "lit_eye.h"

/* A screen of some finish at z = 0, seen at a slant; lit from +z down -z, straight or through a
 * clear pane. */
static void make_screen(LitScene *lit, const char *light, bool has_pane, int photons,
                        const char *look)
{
    char text[2048];
    snprintf(text, sizeof text,
             "global_settings { assumed_gamma 1 photons { count %d } }\n"
             "camera { orthographic location <-0.6,0.3,0.8> direction <0.6,-0.3,-0.8> right 0.6*x\n"
             "  up 0.6*y }\n"
             "light_source { %s }\n%s\n"
             "box { <-9,-9,-1>, <9,9,0> %s }\n",
             photons, light,
             has_pane ? "box { <-2.4,-2.4,0.9>, <2.4,2.4,1> pigment { rgbt 1 } finish { ambient 0\n"
                        "  diffuse 0 } interior { ior 1 } photons { target refraction on } }"
                      : "",
             look);
    lit_make(lit, text, 2, 1);
}

enum { SIDE = 8, LOOKS = SIDE * SIDE };

static void look_at_screen(LitScene *lit, LightPart part, Rgb seen[LOOKS])
{
    LitEye eye;
    lit_eye_open(&eye, lit, lit_within(0.2));
    for (int i = 0; i < LOOKS; i++) {
        EyeSample sample = lit_look(&eye, (i % SIDE + 0.5) / SIDE, (i / SIDE + 0.5) / SIDE);
        for (int k = 0; k < PART_COUNT; k++)
            assert_true(k == (int)part || rgb_is_black(sample.part[k]));
        seen[i] = sample.part[part];
    }
    lit_eye_close(&eye);
}

static const char matt[] = "pigment { rgb 1 } finish { ambient 0 diffuse 1 }";

static const char *const looks[] = {
    "pigment { rgb <0.9,0.5,0.2> } finish { ambient 0 diffuse 0.7 }",
    "pigment { rgb <0.9,0.5,0.2> } finish { ambient 0 diffuse 0.7 brilliance 3.5 }",
    "pigment { rgb 1 } finish { ambient 0 diffuse 0.7 brilliance 0.4 }",
    "pigment { rgb <0.9,0.5,0.2> } finish { ambient 0 diffuse 0.5 phong 0.8 phong_size 12 }",
    "pigment { rgb <0.9,0.5,0.2> } finish { ambient 0 diffuse 0.5 specular 0.8 roughness 0.08 }",
    "pigment { rgb <0.9,0.5,0.2> } finish { ambient 0 diffuse 0.3 brilliance 2 phong 0.8\n"
    "  phong_size 6 metallic 1 }",
    "pigment { rgb 1 } finish { ambient 0 diffuse 0.5 brilliance 2 irid { 0.4 thickness 0.6 } }",
    "texture { pigment { rgb <0.9,0.5,0.2> } finish { ambient 0 diffuse 1 brilliance 4 } }\n"
    "texture { pigment { rgbt <0.2,0.5,0.9,0.5> } finish { ambient 0 diffuse 0.6 specular 0.3 } }",
};
enum { LOOK_COUNT = sizeof looks / sizeof looks[0] };

/* The noise of the photons, which the matt screen shows too, is that of each channel. */
static void check_look(const char *look, Rgb direct, Rgb photons, Rgb matt_direct, Rgb matt_photons)
{
    Rgb noise = rgb(matt_photons.r / matt_direct.r, matt_photons.g / matt_direct.g,
                    matt_photons.b / matt_direct.b);
    assert_true(fminf(noise.r, fminf(noise.g, noise.b)) > 0.8f && rgb_max(noise) < 1.2f);
    Rgb expected = rgb_mul(direct, noise), off = rgb_sub(photons, expected);
    if (rgb_max_abs(off) > 2e-5f * rgb_max(direct))
        fail_msg("%s: %g %g %g, expected %g %g %g", look, (double)photons.r, (double)photons.g,
                 (double)photons.b, (double)expected.r, (double)expected.g, (double)expected.b);
}

/* Row S13: when all photons come from one direction, and one that the two bytes of a photon hold
 * exactly, each finish makes of them what it makes of direct light: the ratio to a matt screen
 * is the same to single floats, noise and all. */
static void parallel_photons_look_like_parallel_light(void **state)
{
    (void)state;
    const uint8_t codes[][2] = {{0, 0}, {20, 30}, {150, 60}, {77, 85}};
    for (size_t d = 0; d < sizeof codes / sizeof codes[0]; d++) {
        char light[256];
        V3 to = direction_decode(codes[d][0], codes[d][1]);
        snprintf(light, sizeof light, "<%.17g,%.17g,%.17g> rgb 1 parallel point_at 0", 3 * to.x,
                 3 * to.y, 3 * to.z);
        LitScene lit;
        Rgb direct[LOOKS], photons[LOOKS], matt_direct[LOOKS], matt_photons[LOOKS];
        make_screen(&lit, light, false, 0, matt);
        look_at_screen(&lit, PART_DIRECT, matt_direct);
        lit_done(&lit);
        make_screen(&lit, light, true, 60000, matt);
        look_at_screen(&lit, PART_CAUSTIC, matt_photons);
        lit_done(&lit);
        for (int k = 0; k < LOOK_COUNT; k++) {
            make_screen(&lit, light, false, 0, looks[k]);
            look_at_screen(&lit, PART_DIRECT, direct);
            lit_done(&lit);
            make_screen(&lit, light, true, 60000, looks[k]);
            look_at_screen(&lit, PART_CAUSTIC, photons);
            lit_done(&lit);
            for (int i = 0; i < LOOKS; i++)
                check_look(looks[k], direct[i], photons[i], matt_direct[i], matt_photons[i]);
        }
    }
}

/* Row S13: from a near lamp, photons come from many directions.  The mean over the picture is that
 * of direct light within 4 standard errors, and 1 % for directions in two bytes. */
static void near_photons_look_like_near_light(void **state)
{
    (void)state;
    const char *light = "<0.8,0.2,2> rgb 1";
    for (int k = 0; k < LOOK_COUNT; k++) {
        LitScene lit;
        Rgb direct[LOOKS], photons[LOOKS];
        make_screen(&lit, light, false, 0, looks[k]);
        look_at_screen(&lit, PART_DIRECT, direct);
        lit_done(&lit);
        make_screen(&lit, light, true, 400000, looks[k]);
        look_at_screen(&lit, PART_CAUSTIC, photons);
        /* photons within the picture, 0.6 by 0.75, decide */
        double near = 0, got = 0, expected = 0;
        for (size_t i = 0; i < photon_map_count(lit.maps.caustic); i++) {
            V3 p = lit_photon_place(lit.maps.caustic, i);
            near += fabs(p.z) < 1e-6 && fabs(p.x) < 0.37 && fabs(p.y) < 0.3;
        }
        lit_done(&lit);
        for (int i = 0; i < LOOKS; i++) {
            got += (double)rgb_sum(photons[i]);
            expected += (double)rgb_sum(direct[i]);
        }
        print_message("# look %d: %.4f of direct light, %.0f photons\n", k, got / expected, near);
        assert_true(near > 500 && fabs(got / expected - 1) < 4 / sqrt(near) + 0.01);
    }
}

/* Row S13: so for indirect light.  In a ball lit from its middle direct light comes head on and
 * indirect light by the cosine law, of which a finish of diffuse d and brilliance b reflects
 * a = 2 d / (b + 1): d / (1 - a) falls on the wall as indirect light, and a of that is seen. */
static void brilliance_weighs_indirect_light(void **state)
{
    (void)state;
    const double cases[][2] = {{0.5, 1}, {0.8, 3}, {0.6, 2}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        double d = cases[i][0], a = 2 * d / (cases[i][1] + 1);
        char text[1024];
        snprintf(text, sizeof text,
                 "global_settings { assumed_gamma 1 max_trace_level 200\n"
                 "  pms { gi on gi_method map global_photons 200000 } }\n"
                 "camera { location <0.6,0,0> direction z right 4*x up 4*y }\n"
                 "light_source { 0 rgb 1 }\n"
                 "sphere { 0, 1 hollow pigment { rgb 1 } finish { ambient 0 diffuse %g\n"
                 "  brilliance %g } }\n",
                 d, cases[i][1]);
        LitScene lit;
        LitEye eye;
        lit_make(&lit, text, 2, 3);
        double falls = 0, square = 0, seen = 0;
        for (size_t k = 0; k < photon_map_count(lit.maps.global); k++) {
            double power = (double)lit_photon_power(lit.maps.global, k).g;
            falls += power;
            square += power * power;
        }
        lit_eye_open(&eye, &lit, lit_within(0.1));
        for (int k = 0; k < 256; k++) {
            EyeSample sample = lit_look(&eye, (k % 16 + 0.5) / 16, (k / 16 + 0.5) / 16);
            assert_true(fabs((double)sample.part[PART_DIRECT].g - d) < 1e-6);
            seen += (double)sample.part[PART_INDIRECT].g / 256;
        }
        lit_eye_close(&eye);
        lit_done(&lit);
        double expected = 4 * PMS_PI * d / (1 - a), error = sqrt(square * (1 + a) / (1 - a));
        print_message("# diffuse %g brilliance %g: %.4f of the flux (+- %.4f), sees %.4f of %.4f\n",
                      d, cases[i][1], falls / expected, 4 * error / expected, seen,
                      a * d / (1 - a));
        assert_true(fabs(falls - expected) < 4 * error);
        /* About 100 separate disks of 250 photons and more, which come several to a path. */
        assert_true(fabs(seen * (1 - a) / (a * d) - 1) < 4 * sqrt(3.0 / 25000));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parallel_photons_look_like_parallel_light),
        cmocka_unit_test(near_photons_look_like_near_light),
        cmocka_unit_test(brilliance_weighs_indirect_light),
    };
    return cmocka_run_group_tests_name("reflectance", tests, NULL, NULL);
}
