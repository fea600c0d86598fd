/* Hard cases of light: photons with nowhere or everywhere to go, and numbers far apart.
 * SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <cmocka.h>

#include "../physics/lit_scene.h"

static void check_near(const char *what, double got, double expected, double error)
{
    print_message("# %s: %.5f, expected %.5f +- %.5f\n", what, got, expected, error);
    assert_true(fabs(got - expected) < 4 * error);
}

static double stored_flux(const LitScene *lit)
{
    double sum = 0;
    for (size_t i = 0; i < photon_map_count(lit->maps.caustic); i++) {
        double power = (double)lit_photon_power(lit->maps.caustic, i).g;
        assert_true(isfinite(power) && power >= 0);
        sum += power;
    }
    return sum;
}

/* A floor without bounds mirrors a lamp onto a wall: the same light as from the lamp's image under
 * the floor, times the reflectance. */
static void endless_mirror(void **state)
{
    (void)state;
    LitScene lit;
    lit_make(&lit,
             "#version 3.7; global_settings { assumed_gamma 1 photons { count 600000 } }\n"
             "camera { location <0,2,-6> look_at <0,1,0> }\n"
             "light_source { <-4,5,0> rgb 1 }\n"
             "plane { y, 0 pigment { rgb 0 } finish { ambient 0 diffuse 0 reflection 0.8 }\n"
             "  photons { target reflection on } }\n"
             "plane { x, 3 inverse pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n",
             2, 7);
    assert_non_null(lit.maps.caustic);
    assert_string_equal(lit.messages, "");
    GatherLimits limits = lit_within(0.3);
    for (int i = 0; i < 9; i++) {
        V3 p = v3(3, 0.5 + i / 3, i % 3 - 1);
        Rgb e;
        int photons = photon_gather(lit.maps.caustic, p, v3(-1, 0, 0), &limits, lit.scratch, &e);
        double expected = 0.8 * 7 / sqrt(49 + (p.y + 5) * (p.y + 5) + p.z * p.z);
        check_near("light of a mirrored lamp", (double)e.g, expected, expected / sqrt(photons));
    }
    lit_done(&lit);
}

/* Nothing stands for photons that would have to go through a surface without end: its shadow stays
 * a filtered one, and that is said. */
static void endless_water(void **state)
{
    (void)state;
    LitScene lit;
    lit_make(
        &lit,
        "#version 3.7; global_settings { assumed_gamma 1 photons { count 1000 } }\n"
        "light_source { <0,5,0> rgb 1 }\n"
        "plane { y, 0 pigment { rgbt 1 } finish { ambient 0 diffuse 0 } interior { ior 1.33 }\n"
        "  photons { target refraction on } }\n"
        "plane { y, -2 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n",
        1, 7);
    assert_null(lit.maps.caustic);
    assert_non_null(strstr(lit.messages, "its shadow is filtered instead"));
    TraceThread thread;
    assert_int_equal(trace_thread_init(&thread, lit.tracer, &lit.diag), OK);
    ShapePoint bottom = {.p = v3(0, -2, 0), .p_error = 1e-9, .ng = v3(0, 1, 0), .ns = v3(0, 1, 0)};
    assert_true(trace_shadow(&thread, &bottom, v3(0, 1, 0), 7, 0, true).g > 0.9f);
    trace_thread_done(&thread);
    lit_done(&lit);
}

/* A lamp in the middle of a glass ball: no ray bends, and every one arrives. */
static void lamp_inside_glass(void **state)
{
    (void)state;
    LitScene lit;
    lit_make(
        &lit,
        "#version 3.7; global_settings { assumed_gamma 1 photons { count 100000 } }\n"
        "light_source { 0 rgb 1 }\n"
        "sphere { 0, 1 pigment { rgbt 1 } finish { ambient 0 diffuse 0 } interior { ior 1.5 }\n"
        "  photons { target refraction on reflection off collect off } }\n"
        "sphere { 0, 2 hollow pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n",
        2, 8);
    assert_non_null(lit.maps.caustic);
    double area = 16 * PMS_PI;
    check_near("irradiance around a lamp in glass", stored_flux(&lit) / area, 1, 2e-3);
    lit_done(&lit);
}

/* A lamp of 1e12 beside one of 1e-12: all photons are the strong one's, none is lost or infinite.
 */
static void powers_far_apart(void **state)
{
    (void)state;
    static const char scene[] =
        "#version 3.7; global_settings { assumed_gamma 1 photons { count 20000 } }\n"
        "%s %s\n"
        "plane { y, 0 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
        "sphere { <0,3,0>, 1 pigment { rgbt 1 } finish { ambient 0 diffuse 0 }\n"
        "  interior { ior 1.5 } photons { target refraction on reflection off collect off } }\n";
    static const char strong[] = "light_source { <0,9,0> rgb 1e12 }";
    static const char weak[] = "light_source { <1,9,0> rgb 1e-12 }";
    double flux[2];
    for (int i = 0; i < 2; i++) {
        char text[1024];
        LitScene lit;
        snprintf(text, sizeof text, scene, strong, i ? weak : "");
        lit_make(&lit, text, 2, 8);
        flux[i] = stored_flux(&lit);
        if (i) {
            assert_true(lit.maps.books.caustic[0].stored > 5000);
            assert_int_equal(lit.maps.books.caustic[1].budget, 0);
        }
        lit_done(&lit);
        if (i == 0) { /* the weak one alone gives its light as well */
            snprintf(text, sizeof text, scene, "", weak);
            lit_make(&lit, text, 2, 8);
            assert_true(stored_flux(&lit) > 1e-12 && stored_flux(&lit) < 1e-9);
            lit_done(&lit);
        }
    }
    check_near("light beside a weak lamp over that alone", flux[1] / flux[0], 1, 2e-3);
}

/* A thousand lamps share the photons of one, and give a thousand times its light. */
static void thousand_lamps(void **state)
{
    (void)state;
    enum { LAMPS = 1000 };
    char *text = malloc(LAMPS * 64 + 1024);
    assert_non_null(text);
    double flux[2];
    for (int i = 0; i < 2; i++) {
        int lamps = i ? LAMPS : 1;
        int at = sprintf(text, "#version 3.7; global_settings { assumed_gamma 1 photons {\n"
                               "  count 100000 } }\n"
                               "plane { y, 0 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
                               "sphere { <0,3,0>, 1 pigment { rgbt 1 } finish { ambient 0\n"
                               "  diffuse 0 } interior { ior 1.5 } photons { target\n"
                               "  refraction on reflection off collect off } }\n");
        for (int k = 0; k < lamps; k++)
            at += sprintf(text + at, "light_source { <0,9,0> rgb 1 }\n");
        LitScene lit;
        lit_make(&lit, text, 2, 8);
        uint64_t budget = 0, least = UINT64_MAX, most = 0;
        for (int k = 0; k < lamps; k++) {
            uint64_t own = lit.maps.books.caustic[k].budget;
            budget += own;
            least = own < least ? own : least;
            most = own > most ? own : most;
        }
        /* The pilot has few rays for each of so many. */
        assert_true(budget > 10000 && least > 0 && most < 5 * least);
        flux[i] = stored_flux(&lit);
        lit_done(&lit);
    }
    free(text);
    check_near("light of a thousand lamps over that of one", flux[1] / flux[0], LAMPS, 3);
}

/* Mirrors all around: photons end at the trace limit and are booked as cut. */
static void box_of_mirrors(void **state)
{
    (void)state;
    LitScene lit;
    lit_make(&lit,
             "#version 3.7; global_settings { assumed_gamma 1 max_trace_level 256\n"
             "  photons { count 20000 } }\n"
             "light_source { 0.1 rgb 1 }\n"
             "box { -1, 1 hollow pigment { rgb 1 } finish { ambient 0 diffuse 0 reflection 1 }\n"
             "  photons { target reflection on } }\n",
             2, 8);
    assert_null(lit.maps.caustic);
    const LightBooks *books = &lit.maps.books.caustic[0];
    assert_true(books->emitted > 1000);
    assert_true(books->cut == books->emitted);
    lit_done(&lit);
}

/* Light through a slab whose ior is next to 1 or below it; at a slant it is reflected in whole
 * where sin(angle) > ior. */
static double through_slab(const char *ior, double angle)
{
    char text[1024];
    snprintf(text, sizeof text,
             "#version 3.7; global_settings { assumed_gamma 1 photons { count 100000 } }\n"
             "light_source { <%.17g,%.17g,0> rgb 1 parallel point_at 0 }\n"
             "plane { y, -3 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
             "cylinder { 0, y*0.2, 2 pigment { rgbt 1 } finish { ambient 0 diffuse 0 }\n"
             "  interior { ior %s } photons { target refraction on reflection off collect off } }\n"
             "difference { box { <-40,-0.1,-40>, <40,-0.05,40> } cylinder { -y, y, 1\n"
             "  translate x*%.17g } pigment { rgb 0 } finish { ambient 0 diffuse 0 } }\n",
             20 * sin(angle), 20 * cos(angle), ior, -0.075 * tan(angle));
    LitScene lit;
    lit_make(&lit, text, 2, 8);
    double flux = lit.maps.caustic ? stored_flux(&lit) / (PMS_PI * cos(angle)) : 0;
    lit_done(&lit);
    return flux;
}

static void ior_next_to_1(void **state)
{
    (void)state;
    static const char *const iors[] = {"1", "1.0000001", "0.9999999", "0.8", "1e-3"};
    for (size_t i = 0; i < sizeof iors / sizeof *iors; i++)
        check_near(iors[i], through_slab(iors[i], 0), 1, 4e-3);
    double critical = asin(0.8);
    assert_true(through_slab("0.8", critical + 0.01) == 0);
    assert_true(through_slab("0.8", critical - 0.1) > 0.2);
    assert_true(through_slab("1.0000001", 1.2) > 0.5);
}

/* More photons asked for than there are: all of them count, over the radius that holds them. */
static void fewer_photons_than_asked_for(void **state)
{
    (void)state;
    LitScene lit;
    lit_make(
        &lit,
        "#version 3.7; global_settings { assumed_gamma 1 photons { count 40 gather 1000,2000 } }\n"
        "light_source { <0,9,0> rgb 1 }\n"
        "plane { y, 0 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
        "sphere { <0,3,0>, 1 pigment { rgbt 1 } finish { ambient 0 diffuse 0 }\n"
        "  interior { ior 1.5 } photons { target refraction on reflection off collect off } }\n",
        1, 8);
    assert_non_null(lit.maps.caustic);
    size_t count = photon_map_count(lit.maps.caustic);
    assert_true(count > 5 && count < 1000);
    assert_true(isfinite(lit.maps.caustic_radius) && lit.maps.caustic_radius > 0);
    GatherLimits limits = {.max_photons = 2000, .max_radius = 100, .normal_cosine = -1};
    Rgb e;
    int used = photon_gather(lit.maps.caustic, v3(0, 0, 0), v3(0, 1, 0), &limits, lit.scratch, &e);
    assert_int_equal(used, (int)count);
    double expected = stored_flux(&lit) / (PMS_PI * 1e4);
    assert_true(fabs((double)e.g / expected - 1) < 1e-5);
    lit_done(&lit);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(endless_mirror),    cmocka_unit_test(endless_water),
        cmocka_unit_test(lamp_inside_glass), cmocka_unit_test(powers_far_apart),
        cmocka_unit_test(thousand_lamps),    cmocka_unit_test(box_of_mirrors),
        cmocka_unit_test(ior_next_to_1),     cmocka_unit_test(fewer_photons_than_asked_for),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
