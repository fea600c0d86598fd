/* Light in media against closed forms and quadrature: what passes, what glows, what is scattered
 * once; phase functions; hard cases of size and density.
 *
 * The expected values are worked out here in double, from the definition in texture/media.h.
 * SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "lit_scene.h"
#include "table.h"

#include "eye/eye.h"
#include "texture/media.h"

/* Light along one camera ray: the mean over samples, and its standard error (green). */
typedef struct Look {
    Rgb mean;
    double error;
} Look;

static Look look(const char *text, int samples)
{
    LitScene lit;
    EyeThread *eye;
    lit_read(&lit, text, 1, 1);
    EyeOptions options = {.width = 1, .height = 1, .seed = 3};
    assert_int_equal(eye_thread_new(lit.tracer, &options, &lit.diag, &eye), OK);
    double sum[3] = {0}, squares = 0;
    for (int i = 0; i < samples; i++) {
        EyeSample s;
        assert_true(eye_sample(eye, 0.5, 0.5, 0, (uint32_t)i, &s));
        Rgb whole = rgb_add(rgb_add(s.part[0], s.part[1]), s.part[2]);
        sum[0] += (double)whole.r;
        sum[1] += (double)whole.g;
        sum[2] += (double)whole.b;
        squares += (double)whole.g * (double)whole.g;
    }
    double mean = sum[1] / samples, variance = fmax(0, squares / samples - mean * mean);
    eye_thread_free(eye, NULL);
    lit_done(&lit);
    return (Look){rgb((float)(sum[0] / samples), (float)mean, (float)(sum[2] / samples)),
                  sqrt(variance / samples)};
}

/* Within 4 standard errors and this part. */
static void check(const char *what, Look got, double expected, double part)
{
    double value = (double)got.mean.g;
    table_row(what, value, expected, got.error);
    assert_true(fabs(value - expected) <= 4 * got.error + part * fabs(expected));
}

#define HEAD "#version 3.7;\nglobal_settings { assumed_gamma 1 max_trace_level 20 }\n"
#define EYE "camera { orthographic location <0,0,-10> direction z right x*1e-3 up y*1e-3 }\n"
#define WHITE "background { rgb 1 }\n"

/* --- what passes and what glows ------------------------------------------------------------- */

static void beer_lambert_slab(void **state)
{
    (void)state;
    Look got = look(HEAD EYE WHITE "box { <-1,-1,0>, <1,1,1.5> hollow pigment { rgbt 1 }\n"
                                   "  interior { media { absorption <0.2, 1, 3> } } }\n",
                    1);
    check("Beer-Lambert, absorbing slab", got, exp(-1.5), 1e-6);
    assert_true(fabs((double)got.mean.r / exp(-0.3) - 1) < 1e-6);
    assert_true(fabs((double)got.mean.b / exp(-4.5) - 1) < 1e-5);
}

static void several_media_add_up(void **state)
{
    (void)state;
    /* Two in one interior, one around it, one of the atmosphere, which fills 12 units up to a
     * wall. */
    check("media in media",
          look(HEAD EYE "plane { -z, -2 pigment { rgb 1 } finish { ambient 1 diffuse 0 } }\n"
                        "media { absorption 0.02 }\n"
                        "sphere { 0, 1.5 hollow pigment { rgbt 1 }\n"
                        "  interior { media { absorption 0.1 } } }\n"
                        "sphere { 0, 1 hollow pigment { rgbt 1 }\n"
                        "  interior { media { absorption 0.3 } media { absorption 0.05 } } }\n",
               1),
          exp(-(12 * 0.02 + 3 * 0.1 + 2 * 0.35)), 1e-6);
}

static void solids_that_are_not_hollow_are_clear(void **state)
{
    (void)state;
    check("not hollow",
          look(HEAD EYE "plane { -z, -2 pigment { rgb 1 } finish { ambient 1 diffuse 0 } }\n"
                        "media { absorption 0.1 }\n"
                        "sphere { 0, 1 pigment { rgbt 1 } interior { media { absorption 5 } } }\n",
               1),
          exp(-1.0), 1e-6);
}

static void glowing_slab(void **state)
{
    (void)state;
    check("glowing slab",
          look(HEAD EYE "box { <-1,-1,0>, <1,1,2> hollow pigment { rgbt 1 }\n"
                        "  interior { media { emission 0.7 absorption 0.8 } } }\n",
               1),
          0.7 / 0.8 * (1 - exp(-1.6)), 1e-6);
    check("clear glow",
          look(HEAD EYE "box { <-1,-1,0>, <1,1,2> hollow pigment { rgbt 1 }\n"
                        "  interior { media { emission 0.7 } } }\n",
               1),
          1.4, 1e-6);
}

/* Density z over [0,1]: the depth is 1/2; two factors: 1/3. */
static void density_is_integrated(void **state)
{
    (void)state;
    check("gradient",
          look(HEAD EYE WHITE "box { <-1,-1,0>, <1,1,1> hollow pigment { rgbt 1 } interior {\n"
                              "  media { absorption 3 density { gradient z } } } }\n",
               400),
          exp(-1.5), 0.002);
    check("product",
          look(HEAD EYE WHITE "box { <-1,-1,0>, <1,1,1> hollow pigment { rgbt 1 } interior {\n"
                              "  media { absorption 3 density { gradient z }\n"
                              "    density { gradient z } } } }\n",
               400),
          exp(-1.0), 0.002);
    /* A map from density 0 to one that follows x, which is 0.25 here. */
    check("density_map",
          look(HEAD "camera { orthographic location <0.25,0,-10> direction z right x*1e-3 up "
                    "y*1e-3 }\n" WHITE
                    "box { <-1,-1,0>, <1,1,1> hollow pigment { rgbt 1 } interior {\n"
                    "  media { absorption 4 density { gradient z\n"
                    "    density_map { [0 rgb 0] [1 gradient x] } } } } }\n",
               400),
          exp(-0.5), 0.002);
    check("moved with its object",
          look(HEAD EYE WHITE "box { <-1,-1,0>, <1,1,1> hollow pigment { rgbt 1 } interior {\n"
                              "  media { absorption 3 density { gradient z } } }\n"
                              "  translate -0.3*z scale <1,1,2> }\n",
               400),
          exp(-3.0), 0.004);
}

/* --- scattered once ------------------------------------------------------------------------- */

/* A wide slab lit from the eye's side at an angle: S k (1 - exp(-X d (1 + 1/mu))) / (X (1 + 1/mu)).
 */
static void single_scattering_slab(void **state)
{
    (void)state;
    const double mu = 0.8, d = 1.2, scattering = 0.5, absorption = 0.3;
    for (int type = 1; type <= 5; type++) {
        char text[1024];
        snprintf(text, sizeof text,
                 HEAD EYE "light_source { <-60,0,-80> 1 parallel point_at 0 }\n"
                          "box { <-500,-500,0>, <500,500,%g> hollow pigment { rgbt 1 } interior {\n"
                          "  media { absorption %g scattering { %d, %g %s } } } }\n",
                 d, absorption, type, scattering, type == 5 ? "eccentricity 0.6" : "");
        double x = scattering + absorption, way = 1 + 1 / mu;
        double phase = phase_value((PhaseKind)type, 0.6, -mu);
        double expected = scattering * phase * (1 - exp(-x * d * way)) / (x * way);
        char what[64];
        snprintf(what, sizeof what, "single-scattering slab, type %d", type);
        check(what, look(text, 4000), expected, 0.003);
    }
}

/* The light of a lamp in the atmosphere, which dims in it, by quadrature. */
static double lamp_light(double x, double scattering, double far, double aside, double along,
                         double fade)
{
    const int steps = 200000;
    double sum = 0;
    for (int i = 0; i < steps; i++) {
        double t = far * (i + 0.5) / steps, away = hypot(aside, t - along);
        double arrives = 2 / (1 + away * away / (fade * fade)) * exp(-x * away);
        sum += scattering * arrives * exp(-x * t) * far / steps;
    }
    return sum;
}

static void lamp_in_the_atmosphere(void **state)
{
    (void)state;
    /* Also one so near the ray that nearly all comes from a small part of it. */
    const double asides[] = {2, 0.05};
    for (int i = 0; i < 2; i++) {
        char text[1024];
        snprintf(text, sizeof text,
                 HEAD EYE "light_source { <0,%g,-4> 1 fade_distance 0.1 fade_power 2\n"
                          "  media_attenuation on }\n"
                          "media { scattering { 1, 0.05 } absorption 0.03 }\n"
                          "plane { -z, -10 pigment { rgb 0 } finish { ambient 0 diffuse 0 } }\n",
                 asides[i]);
        check("lamp in thin smoke", look(text, 200), lamp_light(0.08, 0.05, 20, asides[i], 6, 0.1),
              0.01);
    }
}

/* A spot light: only what is in its cone counts; where it is, that is all that is needed. */
static void spot_light_in_smoke(void **state)
{
    (void)state;
    /* Straight down through the ray, 5 above it: half a cone's width is 5 tan(falloff). */
    check("spotlight in smoke",
          look(HEAD EYE "light_source { <0,5,0> 1 spotlight point_at 0 radius 20 falloff 20 }\n"
                        "media { scattering { 1, 0.1 extinction 0 } }\n"
                        "plane { -z, -10 pigment { rgb 0 } finish { ambient 0 diffuse 0 } }\n",
               100),
          0.1 * 10 * tan(20 * PMS_PI / 180), 0.003);
    check("beam in smoke",
          look(HEAD EYE "light_source { <0,5,0> 1 cylinder point_at 0 radius 2 falloff 2 }\n"
                        "media { scattering { 1, 0.1 extinction 0 } }\n"
                        "plane { -z, -10 pigment { rgb 0 } finish { ambient 0 diffuse 0 } }\n",
               100),
          0.1 * 4, 0.003);
}

/* A ball half in the light of a lamp: what is dark is found by shadow rays. */
static void shadows_in_smoke(void **state)
{
    (void)state;
    check("shadow of a box",
          look(HEAD EYE "light_source { <0,50,0> 1 parallel point_at 0 }\n"
                        "media { scattering { 1, 0.1 extinction 0 } }\n"
                        "box { <-1,2,-3.3>, <1,3,4.1> pigment { rgb 0 } }\n"
                        "plane { -z, -10 pigment { rgb 0 } finish { ambient 0 diffuse 0 } }\n",
               400),
          0.1 * (20 - 7.4), 0.005);
    check("shadow of glass",
          look(HEAD EYE "light_source { <0,50,0> 1 parallel point_at 0 }\n"
                        "media { scattering { 1, 0.1 extinction 0 } }\n"
                        "box { <-1,2,-3.3>, <1,3,4.1> hollow pigment { rgbt <1,1,1,0.5> }\n"
                        "  interior { media { absorption 0.7 } } }\n"
                        "plane { -z, -10 pigment { rgb 0 } finish { ambient 0 diffuse 0 } }\n",
               400),
          0.1 * (20 - 7.4 + 7.4 * 0.25 * exp(-0.7)), 0.005);
}

/* One body of so many slabs of smoke between the lamp and the floor. */
static void shadow_of_many_slabs(void **state)
{
    (void)state;
    check("shadow of a hundred slabs of smoke",
          look(HEAD "camera { orthographic location <0,1,0> direction -y right x*0.01 up z*0.01 }\n"
                    "light_source { <0,1000,0> 1 media_attenuation on }\n"
                    "box { <-1,-1,-1>, <1,0,1> pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
                    "difference { box { <-1,2,-1>, <1,201,1> }\n"
                    "  #declare I = 0; #while (I < 99)\n"
                    "    box { <-2, 3 + 2 * I, -2>, <2, 4 + 2 * I, 2> } #declare I = I + 1; #end\n"
                    "  hollow pigment { rgbt 1 } finish { ambient 0 diffuse 0 }\n"
                    "  interior { media { absorption 0.0625 } } }\n",
               1),
          exp(-6.25), 1e-4);
}

static void lights_that_do_not_interact_light_no_media(void **state)
{
    (void)state;
    const char *const words[] = {"media_interaction off", "shadowless"};
    for (int i = 0; i < 2; i++) {
        char text[512];
        snprintf(text, sizeof text,
                 HEAD EYE "light_source { <0,50,0> 1 %s }\n"
                          "media { scattering { 1, 0.1 extinction 0 } }\n"
                          "plane { -z, -10 pigment { rgb 0 } finish { ambient 0 diffuse 0 } }\n",
                 words[i]);
        check(words[i], look(text, 1), 0, 0);
    }
}

/* --- phase functions ------------------------------------------------------------------------ */

static void phase_functions_have_their_mean(void **state)
{
    (void)state;
    const int steps = 20000;
    for (int type = 1; type <= 5; type++) {
        double sum = 0;
        for (int i = 0; i < steps; i++)
            sum += phase_value((PhaseKind)type, 0.7, (2 * i + 1.0) / steps - 1) / steps;
        double mean = phase_mean((PhaseKind)type);
        print_message("# type %d: mean %.6f, expected %.6f\n", type, sum, mean);
        assert_true(fabs(sum / mean - 1) < 1e-4);
    }
    assert_true(phase_value(PHASE_HENYEY_GREENSTEIN, 0, 0.3) == 1);
}

/* Samples fill the intervals of the cosine in proportion to the function's integral there. */
static void phase_samples_follow_the_function(void **state)
{
    (void)state;
    enum { BINS = 20, SAMPLES = 200000 };
    const double eccentricities[] = {0, 0, 0, 0, 0.7, -0.4, 0};
    for (int k = 0; k < 7; k++) {
        PhaseKind type = k < 4 ? (PhaseKind)(k + 1) : PHASE_HENYEY_GREENSTEIN;
        double g = eccentricities[k], got[BINS] = {0};
        Rng rng = rng_at(5, 0, (uint64_t)k);
        for (int i = 0; i < SAMPLES; i++) {
            double cosine = phase_sample(type, g, rng_double(&rng));
            assert_true(cosine >= -1 && cosine <= 1);
            int bin = (int)((cosine + 1) / 2 * BINS);
            got[bin < BINS ? bin : BINS - 1]++;
        }
        for (int b = 0; b < BINS; b++) {
            double part = 0;
            for (int i = 0; i < 1000; i++)
                part += phase_value(type, g, -1 + 2 * (b + (i + 0.5) / 1000) / BINS) / 1000 / BINS;
            part /= phase_mean(type);
            assert_true(fabs(got[b] / SAMPLES - part) < 4.5 * sqrt(part / SAMPLES) + 1e-5);
        }
    }
}

/* --- hard cases ----------------------------------------------------------------------------- */

static void extreme_extinction(void **state)
{
    (void)state;
    const char *const scene = HEAD EYE WHITE "light_source { <0,0,-50> 1 parallel point_at 0 }\n"
                                             "box { <-1,-1,0>, <1,1,1> hollow pigment { rgbt 1 }\n"
                                             "  interior { media { scattering { 1, %g } } } }\n";
    char text[1024];
    /* Light comes back from the surface alone: half of what an endless depth scatters. */
    snprintf(text, sizeof text, scene, 1e6);
    check("extinction 1e6", look(text, 50), 0.5, 0.002);
    snprintf(text, sizeof text, scene, 1e-6);
    Look thin = look(text, 1);
    check("extinction 1e-6", thin, 1, 1e-6);
}

static void a_slab_of_next_to_no_thickness(void **state)
{
    (void)state;
    check("1e-6 slab of depth 1",
          look(HEAD EYE WHITE "box { <-1,-1,0>, <1,1,1e-6> hollow pigment { rgbt 1 }\n"
                              "  interior { media { absorption 1e6 } } }\n",
               1),
          exp(-1.0), 1e-6);
    check("a slab of none",
          look(HEAD EYE WHITE "box { <-1,-1,0>, <1,1,0> hollow pigment { rgbt 1 }\n"
                              "  interior { media { absorption 1e6 } } }\n",
               1),
          1, 1e-6);
}

/* The same picture at every scale: lengths grow, coefficients shrink. */
static void scale_does_not_matter(void **state)
{
    (void)state;
    const double scales[] = {1, 1e6, 1e-6};
    double first = 0;
    for (int i = 0; i < 3; i++) {
        double s = scales[i];
        char text[1024];
        snprintf(text, sizeof text,
                 HEAD "camera { orthographic location <0,0,%g> direction z right x*%g up y*%g }\n"
                      "light_source { <0,%g,0> 2 spotlight point_at 0 radius 30 falloff 40 }\n"
                      "box { <%g,%g,%g>, <%g,%g,%g> hollow pigment { rgbt 1 } interior {\n"
                      "  media { absorption %g scattering { 4, %g } } } }\n"
                      "sphere { <0,%g,0>, %g pigment { rgb 1 } }\n",
                 -10 * s, 1e-3 * s, 1e-3 * s, 5 * s, -2 * s, -2 * s, -3 * s, 2 * s, 2 * s, 3 * s,
                 0.2 / s, 0.3 / s, 2.5 * s, 0.5 * s);
        Look got = look(text, 100);
        first = i == 0 ? (double)got.mean.g : first;
        check("scaled", got, first, 0.003);
    }
    assert_true(first > 0.1);
}

/* An eye in smoke sees as much of it as lies before it; a lamp in smoke shines out of it. */
static void eye_and_lamp_inside(void **state)
{
    (void)state;
    check("eye inside",
          look(HEAD EYE WHITE "box { <-1,-1,-20>, <1,1,-5> hollow pigment { rgbt 1 }\n"
                              "  interior { media { absorption 0.1 } } }\n",
               1),
          exp(-0.5), 1e-6);
    check("eye inside an opaque shell",
          look(HEAD EYE "sphere { 0, 30 hollow pigment { rgb 1 } finish { ambient 1 diffuse 0 }\n"
                        "  interior { media { absorption 0.01 } } }\n",
               1),
          exp(-0.4), 1e-6);
    /* The language dims a lamp that is inside only when it is told to. */
    for (int dims = 0; dims < 2; dims++) {
        char text[1024];
        snprintf(text, sizeof text,
                 HEAD "camera { orthographic location <0,0,-10> direction z right x*1e-6 up "
                      "y*1e-6 }\n"
                      "light_source { <0,0,0> 1 media_attenuation %d }\n"
                      "sphere { 0, 2 hollow no_image pigment { rgbt 1 }\n"
                      "  interior { media { absorption 0.3 } } }\n"
                      "plane { -z, -5 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n",
                 dims);
        check("lamp inside", look(text, 1), dims ? exp(-0.6) : 1, 1e-5);
    }
}

/* A ray that meets nothing goes through the atmosphere for good. */
static void endless_rays(void **state)
{
    (void)state;
    check("absorption", look(HEAD EYE WHITE "media { absorption 1e-6 }\n", 1), 0, 0);
    check("emission", look(HEAD EYE WHITE "media { absorption 0.2 emission 0.1 }\n", 1), 0.5, 1e-5);
    check("sunlit",
          look(HEAD EYE "light_source { <0,1000,0> 1 parallel point_at 0 }\n"
                        "media { scattering { 1, 1e-3 } }\n",
               50),
          1, 0.01);
    /* Layers across the ray: half of each unit is dense, up to a distance that counts. */
    check("layers without end",
          look(HEAD EYE WHITE "media { absorption 0.001 density { checker density { rgb 1 }\n"
                              "  density { rgb 0 } } }\n"
                              "sphere { <40,40,900>, 1 }",
               200),
          0, 1e-3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(beer_lambert_slab),
        cmocka_unit_test(several_media_add_up),
        cmocka_unit_test(solids_that_are_not_hollow_are_clear),
        cmocka_unit_test(glowing_slab),
        cmocka_unit_test(density_is_integrated),
        cmocka_unit_test(single_scattering_slab),
        cmocka_unit_test(lamp_in_the_atmosphere),
        cmocka_unit_test(spot_light_in_smoke),
        cmocka_unit_test(shadows_in_smoke),
        cmocka_unit_test(shadow_of_many_slabs),
        cmocka_unit_test(lights_that_do_not_interact_light_no_media),
        cmocka_unit_test(phase_functions_have_their_mean),
        cmocka_unit_test(phase_samples_follow_the_function),
        cmocka_unit_test(extreme_extinction),
        cmocka_unit_test(a_slab_of_next_to_no_thickness),
        cmocka_unit_test(scale_does_not_matter),
        cmocka_unit_test(eye_and_lamp_inside),
        cmocka_unit_test(endless_rays),
    };
    return cmocka_run_group_tests_name("media", tests, NULL, NULL);
}
