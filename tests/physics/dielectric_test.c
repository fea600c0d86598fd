/* Photons at glass and water: reflection and refraction by Fresnel's equations, total reflection,
 * absorption inside.  The expected values are the textbook's (amplitudes of both polarisations
 * from the two angles), not the renderer's.  SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "lit_scene.h"

#define DEG (PMS_PI / 180)
#define ROOM "box { -9, 9 hollow pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"

/* Photons found somewhere: how many, and their powers. */
typedef struct Caught {
    double count, sum[3], square[3];
} Caught;

static void catch_photon(Caught *caught, Rgb power)
{
    double channel[3] = {(double)power.r, (double)power.g, (double)power.b};
    caught->count++;
    for (int c = 0; c < 3; c++) {
        caught->sum[c] += channel[c];
        caught->square[c] += channel[c] * channel[c];
    }
}

/* Reflectance of unpolarised light from air onto a medium. */
static double reflectance(double ior, double angle)
{
    double c1 = cos(angle), sine = sin(angle) / ior, c2 = sqrt(1 - sine * sine);
    double rs = (c1 - ior * c2) / (c1 + ior * c2), rp = (c2 - ior * c1) / (c2 + ior * c1);
    return 0.5 * (rs * rs + rp * rp);
}

/* A parallel beam at an angle onto a sheet in the middle of a room, so thin that its edges catch
 * nothing; photons stop at their `level`th surface. */
static void light_sheet(const char *look, double angle, int level, Caught *above, Caught *below)
{
    char text[1024];
    snprintf(text, sizeof text,
             "global_settings { assumed_gamma 1 adc_bailout 1e-6\n"
             "  photons { count 60000 max_trace_level %d } }\n"
             "light_source { <%.17g,%.17g,0> rgb 1 parallel point_at 0 }\n" ROOM
             "box { <-1,-1e-7,-1>, <1,0,1> %s\n"
             "  photons { target refraction on reflection on collect off } }\n",
             level, 6 * sin(angle), 6 * cos(angle), look);
    LitScene lit;
    lit_make(&lit, text, 2, 5);
    *above = *below = (Caught){0};
    for (size_t i = 0; i < photon_map_count(lit.maps.caustic); i++)
        catch_photon(lit_photon_place(lit.maps.caustic, i).y > 0 ? above : below,
                     lit_photon_power(lit.maps.caustic, i));
    lit_done(&lit);
}

static void check_caught(const char *what, const Caught *got, const Caught *all, double share,
                         const double factor[3])
{
    double error = sqrt(all->count * share * (1 - share));
    print_message("# %s: %.0f of %.1f\n", what, got->count, share * all->count);
    assert_true(fabs(got->count - share * all->count) < 4 * error + 1);
    for (int c = 0; c < 3; c++) {
        double expected = factor[c] * all->sum[c];
        double spread = sqrt(got->square[c] * (1 - share)) + 1e-3 * expected;
        assert_true(fabs(got->sum[c] - expected) < 4 * spread);
    }
}

/* All is reflected, and yet photons are sent as for glass. */
#define PERFECT "pigment { rgbt 1 } finish { ambient 0 diffuse 0 reflection 1 conserve_energy }"
#define FRESNEL "finish { ambient 0 diffuse 0 reflection { 0, 1 fresnel } conserve_energy }\n"

/* Row S6: of the photons that meet clear glass a part R goes on as reflected, the others as
 * refracted, all with the power they came with; two surfaces let (1-R)^2 straight through. */
static void clear_glass_splits_by_reflectance(void **state)
{
    (void)state;
    const double iors[] = {1.33, 1.5, 2.4}, degrees[] = {0, 30, 60, 80};
    for (int a = 0; a < 4; a++) {
        Caught all, up, down;
        light_sheet(PERFECT, degrees[a] * DEG, 2, &all, &down);
        assert_true(all.count > 5000 && down.count == 0);
        for (int i = 0; i < 3; i++) {
            char look[256];
            double r = reflectance(iors[i], degrees[a] * DEG), t2 = (1 - r) * (1 - r);
            snprintf(look, sizeof look, "pigment { rgbt 1 } " FRESNEL "interior { ior %g }",
                     iors[i]);
            print_message("# ior %g, %g degrees\n", iors[i], degrees[a]);
            light_sheet(look, degrees[a] * DEG, 2, &up, &down);
            assert_true(down.count == 0);
            check_caught("reflected", &up, &all, r, (const double[]){r, r, r});
            light_sheet(look, degrees[a] * DEG, 3, &up, &down);
            check_caught("reflected", &up, &all, r, (const double[]){r, r, r});
            check_caught("refracted", &down, &all, t2, (const double[]){t2, t2, t2});
        }
    }
}

/* Row S6: in coloured glass the branches share the largest channel of R + (1-R) c in proportion
 * to their sums, and each goes on with its part over its chance. */
static void coloured_glass_splits_by_power(void **state)
{
    (void)state;
    const double color[3] = {0.9, 0.5, 0.2}, angle = 75 * DEG;
    Caught all, up, down;
    light_sheet(PERFECT, angle, 2, &all, &down);
    double r = reflectance(1.5, angle), most = 0, sum = 0, through[3], reflected[3] = {r, r, r};
    for (int c = 0; c < 3; c++) {
        through[c] = (1 - r) * color[c];
        most = fmax(most, r + through[c]);
        sum += through[c];
    }
    double p_reflect = most * 3 * r / (3 * r + sum), p_transmit = most - p_reflect;
    const char *look = "pigment { rgbf <0.9,0.5,0.2,1> } " FRESNEL "interior { ior 1.5 }";
    light_sheet(look, angle, 2, &up, &down);
    check_caught("reflected", &up, &all, p_reflect, reflected);
    light_sheet(look, angle, 3, &up, &down);
    check_caught("reflected", &up, &all, p_reflect, reflected);
    double twice[3] = {through[0] * through[0], through[1] * through[1], through[2] * through[2]};
    check_caught("refracted", &down, &all, p_transmit * p_transmit, twice);
}

/* A beam straight down into the top of a right-angled prism, onto its slope from inside at 45
 * degrees; every way over the slope to the left face is 1 long. */
static void light_prism(const char *finish, const char *interior, int level, Caught *left,
                        Caught *rest)
{
    char text[1024];
    snprintf(text, sizeof text,
             "global_settings { assumed_gamma 1 adc_bailout 1e-6\n"
             "  photons { count 40000 max_trace_level %d } }\n"
             "light_source { <0.5,6,0.5> rgb 1 parallel point_at <0.5,0,0.5> }\n" ROOM
             "intersection { box { 0, 1 } plane { <1,-1,0>, 0 }\n"
             "  pigment { rgbt 1 } finish { ambient 0 diffuse 0 %s } interior { %s }\n"
             "  photons { target refraction on reflection on collect off } }\n",
             level, finish, interior);
    LitScene lit;
    lit_make(&lit, text, 2, 5);
    *left = *rest = (Caught){0};
    for (size_t i = 0; i < photon_map_count(lit.maps.caustic); i++) {
        V3 p = lit_photon_place(lit.maps.caustic, i);
        bool is_left = p.x < -8.9 && p.y > 0 && p.y < 1;
        catch_photon(is_left ? left : rest, lit_photon_power(lit.maps.caustic, i));
    }
    lit_done(&lit);
}

static void check_flux(const Caught *caught, double r, double g, double b)
{
    const double expected[3] = {r, g, b};
    for (int c = 0; c < 3; c++)
        if (!(fabs(caught->sum[c] - expected[c]) < 4 * sqrt(caught->square[c]) + 1e-9))
            fail_msg("channel %d: %g, expected %g +- %g", c, caught->sum[c], expected[c],
                     4 * sqrt(caught->square[c]));
}

/* Row S6: beyond the critical angle (41.8 degrees for 1.5, 50.3 for 1.3) every photon is
 * reflected, once, and none leaves through the slope; before it none is. */
static void total_reflection_in_a_prism(void **state)
{
    (void)state;
    Caught left, rest;
    light_prism("", "ior 1.5", 10, &left, &rest);
    assert_true(left.count > 10000 && rest.count == 0);
    check_flux(&left, 1, 1, 1);
    light_prism("", "ior 1.3", 10, &left, &rest);
    assert_true(left.count == 0);
    check_flux(&rest, 1, 1, 1);
    /* Fresnel at the faces that are met head on, nothing lost at the slope. */
    double r = reflectance(1.5, 0), through = (1 - r) * (1 - r);
    light_prism("reflection { 0, 1 fresnel } conserve_energy", "ior 1.5", 4, &left, &rest);
    check_flux(&left, through, through, through);
    /* A finish that does not conserve energy lets all through besides: still once at the slope. */
    light_prism("reflection { 0, 1 fresnel }", "ior 1.5", 4, &left, &rest);
    check_flux(&left, 1, 1, 1);
}

/* Row S6: the light in the prism is absorbed over the whole way inside, exp(-(1-k) 1/0.5). */
static void absorption_over_the_whole_way_inside(void **state)
{
    (void)state;
    Caught left, rest;
    light_prism("", "ior 1.5 fade_distance 0.5 fade_power 1001 fade_color <1,0.8,0.3>", 10, &left,
                &rest);
    assert_true(rest.count == 0);
    check_flux(&left, 1, exp(-0.2 / 0.5), exp(-0.7 / 0.5));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(clear_glass_splits_by_reflectance),
        cmocka_unit_test(coloured_glass_splits_by_power),
        cmocka_unit_test(total_reflection_in_a_prism),
        cmocka_unit_test(absorption_over_the_whole_way_inside),
    };
    return cmocka_run_group_tests_name("dielectric", tests, NULL, NULL);
}
