/* Indirect light inside a closed sphere, where it is known: a light of colour 1 at the centre of
 * a unit sphere of reflectance rho makes direct irradiance 1 and indirect rho/(1-rho) everywhere.
 * SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "lit_scene.h"
#include "table.h"

static V3 somewhere(uint64_t index)
{
    Rng rng = rng_at(8, 0, index);
    double z = 2 * rng_double(&rng) - 1, a = 2 * PMS_PI * rng_double(&rng);
    return v3(sqrt(1 - z * z) * cos(a), sqrt(1 - z * z) * sin(a), z);
}

/* Mean of the estimate over the sphere, and photons in each. */
static double mean_indirect(LitScene *lit, double scale, double *photons)
{
    const int queries = 300;
    GatherLimits limits = lit_within(0.2 * scale);
    double sum = 0;
    *photons = 0;
    for (int i = 0; i < queries; i++) {
        V3 n = somewhere((uint64_t)i);
        Rgb e;
        *photons += photon_gather(lit->maps.global, v3_scale(n, scale), v3_neg(n), &limits,
                                  lit->scratch, &e);
        sum += (double)e.g / queries;
    }
    *photons /= queries;
    return sum;
}

static void check_sphere(double rho, double scale, const char *light, double expected)
{
    char text[1024];
    snprintf(text, sizeof text,
             "global_settings { assumed_gamma 1 max_trace_level 200\n"
             "  pms { gi on gi_method map global_photons 200000 } }\n"
             "light_source { <0,0,0> %s }\n"
             "sphere { 0, %g hollow pigment { rgb 1 } finish { ambient 0 diffuse %g } }\n",
             light, scale, rho);
    LitScene lit;
    lit_make(&lit, text, 2, 3);
    assert_non_null(lit.maps.global);
    assert_null(lit.maps.caustic);
    double photons, mean = mean_indirect(&lit, scale, &photons);
    /* A cap is 1/100 of the sphere: about 100 independent estimates of so many photons, and
     * photons of one path are not independent. */
    double error = expected / sqrt(photons * 100) / (1 - rho);
    char what[100];
    snprintf(what, sizeof what, "closed sphere, reflectance %g, size %g: indirect", rho, scale);
    table_row(what, mean, expected, error);
    assert_true(fabs(mean - expected) < 4 * error);
    assert_true(fabs(mean / expected - 1) < 0.01);
    /* The books say the same: nothing escapes, and nothing is lost. */
    const LightBooks *books = &lit.maps.books.global[0];
    assert_true(books->escaped == 0);
    assert_true(books->emitted == books->stored_paths + books->absorbed + books->cut);
    lit_done(&lit);
}

static void radiance_is_1_everywhere(void **state)
{
    (void)state;
    check_sphere(0.5, 1, "rgb 1", 1);
}

static void other_reflectances(void **state)
{
    (void)state;
    check_sphere(0.1, 1, "rgb 1", 0.1 / 0.9);
    check_sphere(0.8, 1, "rgb 1", 4);
}

static void size_does_not_matter(void **state)
{
    (void)state;
    check_sphere(0.5, 1e-4, "rgb 1", 1);
    check_sphere(0.5, 1e5, "rgb 1", 1);
}

/* fade: 2/(1+1) = 1 at the wall; a spot lights a part, but in a sphere a diffuse wall sends the
 * same to every place: the mean over the sphere is the flux over its area. */
static void other_lights(void **state)
{
    (void)state;
    check_sphere(0.5, 1, "rgb 1 fade_distance 1 fade_power 2", 1);
    check_sphere(0.5, 1, "rgb 8 spotlight radius 60 falloff 60 point_at <0,0,1>",
                 8 * (1 - cos(PMS_PI / 3)) / 2);
}

/* Row S14: a clear ball of index 1 around the light changes nothing.  As a photon target it casts a
 * full shadow and the caustic map brings the direct light; as a mere transparent object it lets
 * shadow rays pass and there is nothing in that map.  Indirect light is the same either way. */
static void no_path_counts_twice(void **state)
{
    (void)state;
    for (int is_target = 0; is_target < 2; is_target++) {
        char text[1024];
        snprintf(text, sizeof text,
                 "#version 3.7;\n"
                 "global_settings { assumed_gamma 1 max_trace_level 200 photons { count 100000 }\n"
                 "  pms { gi on gi_method map global_photons 200000 } }\n"
                 "light_source { <0,0,0> rgb 1 }\n"
                 "sphere { 0, 1 hollow pigment { rgb 1 } finish { ambient 0 diffuse 0.5 } }\n"
                 "sphere { 0, 0.5 pigment { rgbt 1 } finish { ambient 0 diffuse 0 }\n"
                 "  interior { ior 1 } photons { %s } }\n",
                 is_target ? "target refraction on collect off" : "refraction off");
        LitScene lit;
        lit_make(&lit, text, 2, 3);
        TraceThread thread;
        assert_int_equal(trace_thread_init(&thread, lit.tracer, &lit.diag), OK);
        GatherLimits limits = lit_within(0.2);
        double direct = 0, caustic = 0, photons;
        for (int i = 0; i < 300; i++) {
            V3 n = somewhere((uint64_t)i);
            ShapePoint wall = {.p = n, .p_error = 1e-9, .ng = v3_neg(n), .ns = v3_neg(n)};
            Rgb shadow = trace_shadow(&thread, &wall, v3_neg(n), 1, 0, is_target), e = RGB_BLACK;
            if (lit.maps.caustic)
                photon_gather(lit.maps.caustic, n, v3_neg(n), &limits, lit.scratch, &e);
            direct += (double)shadow.g / 300;
            caustic += (double)e.g / 300;
        }
        double indirect = mean_indirect(&lit, 1, &photons);
        print_message("# direct %.4f caustic %.4f indirect %.4f\n", direct, caustic, indirect);
        assert_true(fabs(direct - !is_target) < 1e-6);
        assert_true(fabs(caustic - is_target) < 0.01);
        assert_true(fabs(indirect - 1) < 4 * 0.0045);
        trace_thread_done(&thread);
        lit_done(&lit);
    }
}

/* Direct light is not in the map: black walls keep nothing, and the pass says so. */
static void black_walls_store_nothing(void **state)
{
    (void)state;
    LitScene lit;
    lit_make(
        &lit,
        "global_settings { assumed_gamma 1 pms { gi on gi_method map global_photons 10000 } }\n"
        "light_source { 0 rgb 1 }\n"
        "sphere { 0, 1 hollow pigment { rgb 0 } finish { ambient 0 diffuse 0 } }\n",
        1, 1);
    assert_null(lit.maps.global);
    assert_non_null(strstr(lit.messages, "no global map"));
    lit_done(&lit);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(radiance_is_1_everywhere), cmocka_unit_test(other_reflectances),
        cmocka_unit_test(size_does_not_matter),     cmocka_unit_test(other_lights),
        cmocka_unit_test(no_path_counts_twice),     cmocka_unit_test(black_walls_store_nothing),
    };
    return cmocka_run_group_tests_name("photon_sphere", tests, NULL, NULL);
}
