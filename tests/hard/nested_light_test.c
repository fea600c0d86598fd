/* Photons through media in media: walls that touch are one interface for them too, and a light may
 * stand in the middle of it all.  SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "../physics/lit_scene.h"
#include "../physics/fresnel_law.h"

#define GLASSY                                                                                     \
    "pigment { rgbt 1 } finish { ambient 0 diffuse 0 conserve_energy reflection { 0, 1 fresnel "   \
    "on } }\n"
#define REFRACTS " photons { target refraction on reflection off collect off } }\n"

typedef struct Sum {
    double flux, error, x; /* x: mean place */
} Sum;

static Sum sum_photons(const LitScene *lit)
{
    Sum sum = {0};
    size_t count = photon_map_count(lit->maps.caustic);
    for (size_t i = 0; i < count; i++) {
        double power = (double)lit_photon_power(lit->maps.caustic, i).g;
        sum.flux += power;
        sum.error += power * power;
        sum.x += lit_photon_place(lit->maps.caustic, i).x * power;
    }
    sum.x /= sum.flux;
    sum.error = sqrt(sum.error);
    return sum;
}

static void check(const char *what, double got, double expected, double error)
{
    print_message("# %s: %.5f, expected %.5f +- %.5f\n", what, got, expected, error);
    assert_true(fabs(got - expected) < 4 * error);
    assert_true(fabs(got / expected - 1) < 5e-3);
}

/* A slanting beam through glass that lies on water: three interfaces, whether the two overlap,
 * touch, or nearly do.  They float above the floor, or stand on it and on each other. */
static void beam_through_glass_on_water(void **state)
{
    (void)state;
    static const struct {
        double overlap, lift;
    } cases[] = {{0, 1}, {1e-15, 1}, {3e-14, 1}, {1e-9, 1}, {0, 0}, {0.5, 1}};
    double sine = 0.6, cosine = 0.8;
    for (int i = 0; i < 6; i++) {
        static LitScene lit;
        char text[2048];
        double lift = cases[i].lift, off = cases[i].overlap;
        snprintf(text, sizeof text,
                 "#version 3.7; global_settings { assumed_gamma 1 photons { count 400000 } }\n"
                 "light_source { <-6,11,0> rgb 1 cylinder radius 1 falloff 1 tightness 0\n"
                 "  parallel point_at <0,3,0> }\n"
                 "plane { y, 0 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
                 "union { box { <-5,%.17g,-5>, <5,%.17g,5> " GLASSY " interior { ior 1.5 } }\n"
                 "box { <-5,%.17g,-5>, <5,%.17g,5> " GLASSY " interior { ior 1.33 } }" REFRACTS,
                 lift + 1, lift + 2, lift, lift + 1 + off);
        lit_make(&lit, text, 2, 4);
        Sum sum = sum_photons(&lit);
        /* From above: glass down to where the water begins.  On the floor photons are stored
         * before what is in touch with it takes its part. */
        double glass = 1 - off, water = 1 + off, in_glass = sine / 1.5, in_water = sine / 1.33;
        double left = (1 - reflectance(1, 1.5, sine)) * (1 - reflectance(1.5, 1.33, in_glass)) *
                      (lift > 0 ? 1 - reflectance(1.33, 1, in_water) : 1);
        double x = -6 + (11 - lift - 2) * sine / cosine +
                   glass * in_glass / sqrt(1 - in_glass * in_glass) +
                   water * in_water / sqrt(1 - in_water * in_water) + lift * sine / cosine;
        check("flux", sum.flux / PMS_PI, left, sum.error / PMS_PI);
        assert_true(fabs(sum.x - x) < 4 * sum.error / sum.flux);
        lit_done(&lit);
    }
}

/* A lamp in the middle of balls within each other, all of clear glass: all of its light comes
 * out.  It fades so that its power is 4 pi whatever the length of the way. */
static void lamp_inside(void **state)
{
    (void)state;
    static const char *const balls[] = {
        "sphere { 0, 1 interior { ior 1.5 } }",
        "sphere { 0, 0.5 interior { ior 1 } } sphere { 0, 1 interior { ior 1.5 } }",
        "sphere { 0, 0.5 interior { ior 1.33 } }\n"
        "difference { sphere { 0, 1 } sphere { 0, 0.5 } interior { ior 1.5 } }",
        "sphere { 0, 0.5 interior { ior 2.4 } }\n"
        "difference { sphere { 0, 1 } sphere { 0, 0.49 } interior { ior 1.5 } }",
        "sphere { 0, 0.5 interior { ior 2.4 dispersion 1.05 } }\n"
        "difference { sphere { 0, 1 } sphere { 0, 0.5 } interior { ior 1.5 dispersion 1.1 } }"};
    for (int i = 0; i < 5; i++) {
        static LitScene lit;
        char text[2048];
        snprintf(text, sizeof text,
                 "#version 3.7; global_settings { assumed_gamma 1 max_trace_level 60\n"
                 "  adc_bailout 1e-6 photons { count 100000 } }\n"
                 "light_source { 0 rgb 1 fade_distance 1e-4 fade_power 2 }\n"
                 "sphere { 0, 3 hollow pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
                 "union { %s " GLASSY
                 " photons { target refraction on reflection on collect off } }\n",
                 balls[i]);
        lit_make(&lit, text, 2, 4);
        assert_non_null(lit.maps.caustic);
        Sum sum = sum_photons(&lit);
        double power = 4 * PMS_PI * 2 * 1e-8;
        check("light of a lamp inside", sum.flux / power, 1, sum.error / power);
        const LightBooks *books = &lit.maps.books.caustic[0];
        assert_int_equal(books->emitted,
                         books->stored_paths + books->absorbed + books->escaped + books->cut);
        lit_done(&lit);
    }
}

/* With nothing marked as a target photons pass a bubble in glass, whose ior is that of air. */
static void bubble_in_glass(void **state)
{
    (void)state;
    double flux[2];
    for (int i = 0; i < 2; i++) {
        static LitScene lit;
        char text[2048];
        snprintf(text, sizeof text,
                 "#version 3.7; global_settings { assumed_gamma 1 photons { count 100000 } }\n"
                 "light_source { <0,20,0> rgb 1 cylinder radius 1 falloff 1 tightness 0\n"
                 "  parallel point_at 0 }\n"
                 "plane { y, 0 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
                 "box { <-2,1,-2>, <2,3,2> " GLASSY " interior { ior 1.5 } }\n"
                 "%s\n",
                 i ? "box { <-2,1.5,-2>, <2,2.5,2> " GLASSY " interior { ior 1 } }" : "");
        lit_make(&lit, text, 2, 4);
        Sum sum = sum_photons(&lit);
        flux[i] = sum.flux / PMS_PI;
        double faces = i ? 4 : 2;
        assert_true(flux[i] > pow(0.96, faces) - 4 * sum.error / PMS_PI);
        lit_done(&lit);
    }
}

/* Glass that collects nothing stands on a table: the light below it is the table's. */
static void caustic_under_a_foot(void **state)
{
    (void)state;
    for (int i = 0; i < 2; i++) {
        static LitScene lit;
        char text[2048];
        const char *table = "plane { y, 0 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n";
        snprintf(text, sizeof text,
                 "#version 3.7; global_settings { assumed_gamma 1 photons { count 100000 } }\n"
                 "light_source { <0,20,0> rgb 1 cylinder radius 1 falloff 1 tightness 0\n"
                 "  parallel point_at 0 }\n"
                 "%s box { <-2,0,-2>, <2,1,2> " GLASSY " interior { ior 1.5 }" REFRACTS " %s\n",
                 i ? table : "", i ? "" : table);
        lit_make(&lit, text, 2, 4);
        assert_non_null(lit.maps.caustic);
        Sum sum = sum_photons(&lit);
        print_message("# written %s: %.5f\n", i ? "last" : "first", sum.flux / PMS_PI);
        check("flux under a foot", sum.flux / PMS_PI, 0.96, sum.error / PMS_PI);
        lit_done(&lit);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(beam_through_glass_on_water),
        cmocka_unit_test(lamp_inside),
        cmocka_unit_test(bubble_in_glass),
        cmocka_unit_test(caustic_under_a_foot),
    };
    return cmocka_run_group_tests_name("nested light", tests, NULL, NULL);
}
