/* What leaves the lights: photons bring, place by place, what shadow rays bring; they share the
 * light's power; lights share the photons.  SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "lit_eye.h"

/* --- every kind of light, beside direct light ------------------------------------------------ */

enum { SIDE = 8, CELLS = SIDE * SIDE, FINE = 16 };

/* Sums over the cells of the square |x|, |y| < 1 of a screen at z = 0, by channel. */
typedef struct Field {
    double sum[CELLS][3], square[CELLS][3], most;
} Field;

#define SCREEN                                                                                     \
    "camera { orthographic location <0,0,-0.5> direction z right 2*x up 2*y }\n"                   \
    "box { <-9,-9,0>, <9,9,1> pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
#define PANE "pigment { rgbt 1 } finish { ambient 0 diffuse 0 } interior { ior 1 }\n"

/* Flux of the photons in each cell. */
static void flux_of_photons(const PhotonMap *map, Field *field)
{
    memset(field, 0, sizeof *field);
    for (size_t i = 0; i < photon_map_count(map); i++) {
        V3 p = lit_photon_place(map, i);
        Rgb power = lit_photon_power(map, i);
        double channel[3] = {(double)power.r, (double)power.g, (double)power.b};
        assert_true(fabs(p.z) < 1e-6);
        if (fabs(p.x) >= 1 || fabs(p.y) >= 1)
            continue;
        int x = (int)((p.x + 1) / 2 * SIDE), cell = (int)((p.y + 1) / 2 * SIDE) * SIDE + x;
        for (int c = 0; c < 3; c++) {
            field->sum[cell][c] += channel[c];
            field->square[cell][c] += channel[c] * channel[c];
            field->most = fmax(field->most, channel[c]);
        }
    }
}

/* Flux of direct light in each cell: the eye's own, on a screen of reflectance 1. */
static void flux_of_shadow_rays(const char *light, Field *field)
{
    char text[2048];
    snprintf(text, sizeof text, "global_settings { assumed_gamma 1 }\n%s\n" SCREEN, light);
    LitScene lit;
    LitEye eye;
    lit_make(&lit, text, 1, 1);
    lit_eye_open(&eye, &lit, GATHER_LIMITS_DEFAULT);
    memset(field, 0, sizeof *field);
    double area = 4.0 / (SIDE * FINE * SIDE * FINE);
    for (int j = 0; j < SIDE * FINE; j++)
        for (int i = 0; i < SIDE * FINE; i++) {
            EyeSample seen = lit_look(&eye, (i + 0.5) / (SIDE * FINE), (j + 0.5) / (SIDE * FINE));
            Rgb e = seen.part[PART_DIRECT];
            double *sum = field->sum[(SIDE - 1 - j / FINE) * SIDE + i / FINE];
            sum[0] += (double)e.r * area;
            sum[1] += (double)e.g * area;
            sum[2] += (double)e.b * area;
        }
    lit_eye_close(&eye);
    lit_done(&lit);
}

/* Every cell within 4 standard errors of the photons in it (one photon more, where there are
 * few), and the whole; beside that, 0.2 % of the brightest cell for the sums over cells. */
static void check_field(const char *light, const Field *got, const Field *want)
{
    for (int c = 0; c < 3; c++) {
        double sum = 0, square = 0, expected = 0, brightest = 0;
        for (int i = 0; i < CELLS; i++) {
            sum += got->sum[i][c];
            square += got->square[i][c];
            expected += want->sum[i][c];
            brightest = fmax(brightest, want->sum[i][c]);
        }
        for (int i = 0; i < CELLS; i++) {
            double error = 4 * sqrt(got->square[i][c] + got->most * got->most);
            double off = got->sum[i][c] - want->sum[i][c];
            if (fabs(off) > error + 0.002 * brightest)
                fail_msg("%s\ncell %d channel %d: %g, expected %g +- %g", light, i, c,
                         got->sum[i][c], want->sum[i][c], error);
        }
        if (fabs(sum - expected) > 4 * sqrt(square) + 0.002 * expected)
            fail_msg("%s\nchannel %d: %g of %g +- %g", light, c, sum, expected, 4 * sqrt(square));
        if (c == 0)
            print_message("# %.4f (+- %.4f) %s\n", sum / expected, 4 * sqrt(square) / expected,
                          light);
    }
}

static void compare_with_shadow_rays(const char *light, const char *pane)
{
    char text[2048];
    snprintf(text, sizeof text,
             "global_settings { assumed_gamma 1 photons { count 250000 } }\n%s\n" SCREEN "%s " PANE
             " photons { target refraction on collect off } }\n",
             light, pane);
    LitScene lit;
    Field got, want;
    lit_make(&lit, text, 2, 7);
    assert_non_null(lit.maps.caustic);
    flux_of_photons(lit.maps.caustic, &got);
    lit_done(&lit);
    flux_of_shadow_rays(light, &want);
    check_field(light, &got, &want);
}

/* Row S2: photons through a pane that bends nothing bring to every place of a screen what shadow
 * rays bring there without it, in colour, whatever the light, its cone or beam and its fading. */
static void every_light_brings_what_shadow_rays_bring(void **state)
{
    (void)state;
    const char *const lights[] = {
        "light_source { <0.3,0.2,-4> rgb <1,0.7,0.4> }",
        "light_source { <0.5,0,-2.5> rgb <1,2,0.5> fade_distance 1 fade_power 2 }",
        "light_source { <0,0.4,-3> rgb 1 fade_distance 5 fade_power 3.5 }",
        "light_source { <0,0,-4> rgb 1 spotlight point_at 0 radius 8 falloff 16 tightness 5 }",
        "light_source { <0.5,0.5,-4> rgb <1,0.8,0.6> spotlight point_at <0.2,-0.3,0> radius 10\n"
        "  falloff 10 tightness 0 }",
        "light_source { <0,0,-3> rgb 1 spotlight point_at <0.5,0,0> radius 20 falloff 70\n"
        "  fade_distance 2 fade_power 2 }",
        "light_source { <0,0,-3> rgb 1 cylinder point_at 0 radius 0.5 falloff 0.9 tightness 2 }",
        "light_source { <0.2,0,-3> rgb <0.5,1,2> cylinder point_at <0,0.2,0> radius 0.7\n"
        "  falloff 0.7 tightness 0 fade_distance 2 fade_power 1 }",
        "light_source { <0,0,-3> rgb 1 cylinder point_at 0 radius 5 falloff 9 tightness 1 }",
        "light_source { <0,0,-3> rgb <1,0.5,0.25> parallel point_at 0 }",
        "light_source { <0.5,0.3,-3> rgb 1 parallel point_at <0.2,0,0> fade_distance 2\n"
        "  fade_power 2 }",
        "light_source { <0.2,0.1,-3> rgb 1 area_light 0.4*x, 0.4*y, 5, 5 }",
        "light_source { <0.2,0.1,-3> rgb 1 area_light 0.5*x, <0,0.3,0.4>, 9, 9\n"
        "  area_illumination photons { area_light } }",
        "light_source { <0,0,-2.5> rgb 1 area_light x, y, 17, 17 circular orient\n"
        "  area_illumination photons { area_light } fade_distance 1 fade_power 2 }",
        "light_source { <0,0,-3> rgb <1,2,3> area_light 0.6*x, y, 21, 1 area_illumination\n"
        "  photons { area_light } }",
        "light_source { <0,0,-4> rgb 1 spotlight point_at 0 radius 8 falloff 16 tightness 1\n"
        "  area_light 0.4*x, 0.4*y, 9, 9 area_illumination photons { area_light } }",
    };
    for (size_t i = 0; i < sizeof lights / sizeof lights[0]; i++)
        compare_with_shadow_rays(lights[i], "box { <-1.6,-1.6,-1.1>, <1.6,1.6,-1>");
}

/* Row S2: from inside its target a light shines all around. */
static void a_light_inside_its_target(void **state)
{
    (void)state;
    const char *const lights[] = {
        "light_source { <0.2,0.1,-1.2> rgb 1 }",
        "light_source { <0.2,0.1,-1.2> rgb 1 spotlight point_at 0 radius 20 falloff 50 }",
        "light_source { <0.2,0.1,-1.2> rgb 1 area_light 0.2*x, 0.2*y, 9, 9 area_illumination\n"
        "  photons { area_light } }",
    };
    for (size_t i = 0; i < sizeof lights / sizeof lights[0]; i++)
        compare_with_shadow_rays(lights[i], "box { <-3,-3,-2>, <3,3,-0.6>");
}

/* --- the global map -------------------------------------------------------------------------- */

enum { PLACES = 20000, AREA_SIDE = 8 };

/* Direct light from a place of the light onto a sphere of radius 2 around the origin. */
static double flux_onto_sphere(const Light *light, V3 location)
{
    double sum = 0, turn = PMS_PI * (3 - sqrt(5));
    for (int i = 0; i < PLACES; i++) {
        double z = 1 - (2 * i + 1.0) / PLACES, r = sqrt(1 - z * z);
        V3 n = v3(r * cos(turn * i), r * sin(turn * i), z);
        LightSample at = light_at(light, location, v3_scale(n, 2));
        sum += (double)at.color.g * fmax(0, -v3_dot(at.to_light, n));
    }
    return sum * 16 * PMS_PI / PLACES;
}

static double direct_flux(const Light *light)
{
    if (!light->has_area_photons)
        return flux_onto_sphere(light, light->location);
    double sum = 0;
    for (int i = 0; i < AREA_SIDE * AREA_SIDE; i++) {
        double a = (i % AREA_SIDE + 0.5) / AREA_SIDE - 0.5;
        double b = (i / AREA_SIDE + 0.5) / AREA_SIDE - 0.5;
        V3 p = v3_mad(light->location, a, light->area.axis1);
        sum += flux_onto_sphere(light, v3_mad(p, b, light->area.axis2));
    }
    return sum / (AREA_SIDE * AREA_SIDE);
}

/* Row S2: in a closed sphere of reflectance rho the global map holds rho/(1-rho) of the direct
 * light, for every kind of light.  A path of power p leaves k photons with the chance
 * (1-rho) rho^k: the variance is at most the sum of p^2 E[k^2], and that of all photons'
 * squares is the sum of p^2 E[k]. */
static void every_light_fills_the_global_map(void **state)
{
    (void)state;
    const char *const lights[] = {
        "<0.5,-0.3,0.8> rgb 1",
        "<0.5,-0.3,0.8> rgb 3 fade_distance 1 fade_power 2",
        "<0.5,-0.3,0.8> rgb 1 spotlight point_at <0,-2,0> radius 20 falloff 60 tightness 3",
        "<0,0,0> rgb 1 parallel point_at <1,2,3>",
        "<0,0,0> rgb 1 cylinder point_at <1,2,3> radius 0.5 falloff 1.5 tightness 1",
        "<0.3,0,0> rgb 1 area_light <1,0,0>, <0,0.5,0.5>, 3, 3 photons { area_light }",
        "<0.5,-0.3,0.8> rgb 1 shadowless",
    };
    const double rho = 0.5;
    for (size_t i = 0; i < sizeof lights / sizeof lights[0]; i++) {
        char text[1024];
        snprintf(text, sizeof text,
                 "global_settings { assumed_gamma 1 max_trace_level 200\n"
                 "  pms { gi on gi_method map global_photons 100000 } }\n"
                 "light_source { %s }\n"
                 "sphere { 0, 2 hollow pigment { rgb 1 } finish { ambient 0 diffuse %g } }\n",
                 lights[i], rho);
        LitScene lit;
        lit_make(&lit, text, 2, 3);
        double sum = 0, square = 0;
        for (size_t k = 0; k < photon_map_count(lit.maps.global); k++) {
            double power = (double)lit_photon_power(lit.maps.global, k).g;
            sum += power;
            square += power * power;
        }
        double expected = direct_flux(&lit.scene->lights[0]) * rho / (1 - rho);
        double error = sqrt(square * (1 + rho) / (1 - rho));
        print_message("# %.4f (+- %.4f) %s\n", sum / expected, 4 * error / expected, lights[i]);
        assert_true(fabs(sum - expected) < 4 * error + 1e-3 * expected);
        lit_done(&lit);
    }
}

/* --- powers and shares ----------------------------------------------------------------------- */

/* Row S3: the photons of a light carry its power together, in every channel.  A parallel beam of
 * colour 1 has as much flux as it is wide: the ball around its target. */
static void photons_carry_the_power_of_their_light(void **state)
{
    (void)state;
    LitScene lit;
    lit_make(&lit,
             "global_settings { assumed_gamma 1 photons { count 100000 } }\n"
             "light_source { <0,0,-3> rgb <1,0.5,0.02> parallel point_at 0 }\n" SCREEN
             "box { <-1,-1,-1.1>, <1,1,-1> " PANE
             " photons { target refraction on collect off } }\n",
             2, 1);
    const LightBooks *books = &lit.maps.books.caustic[0];
    double sum[3] = {0}, square[3] = {0}, stored = (double)photon_map_count(lit.maps.caustic);
    assert_true(fabs((double)books->flux_emitted.r / (PMS_PI * 2.0025) - 1) < 0.005);
    assert_true(fabs((double)books->flux_stored.r / 4 - 1) < 0.005);
    for (size_t k = 0; k < photon_map_count(lit.maps.caustic); k++) {
        Rgb p = lit_photon_power(lit.maps.caustic, k);
        const double channel[3] = {(double)p.r, (double)p.g, (double)p.b};
        for (int c = 0; c < 3; c++) {
            sum[c] += channel[c];
            square[c] += channel[c] * channel[c];
        }
    }
    /* The map holds what the books say, to the rounding of the stored powers. */
    const double color[3] = {1, 0.5, 0.02};
    for (int c = 0; c < 3; c++) {
        double spread = sqrt(fmax(0, square[c] - sum[c] * sum[c] / stored));
        double expected = (double)books->flux_stored.r * color[c];
        assert_true(fabs(sum[c] - expected) < 4 * spread + 1e-5 * expected);
    }
    lit_done(&lit);
}

#define GRAY_ROOM                                                                                  \
    "sphere { 0, 1 hollow pigment { rgb 1 } finish { ambient 0 diffuse 0.5 } }\n"                  \
    "global_settings { assumed_gamma 1 max_trace_level 100\n"                                      \
    "  pms { gi on gi_method map global_photons %d } }\n"

/* Row S3: each photon has its light's power over the number sent, 4 pi c / n from the middle of a
 * ball, to half a step of RGBE either way (1/128 of the brightest channel at most). */
static void each_photon_has_its_part(void **state)
{
    (void)state;
    for (int n = 100; n <= 10000; n *= 10) {
        char text[1024];
        snprintf(text, sizeof text, GRAY_ROOM "light_source { 0 rgb <3,2,0.5> }\n", n);
        LitScene lit;
        lit_make(&lit, text, 1, 1);
        for (size_t i = 0; i < photon_map_count(lit.maps.global); i++) {
            Rgb power = lit_photon_power(lit.maps.global, i);
            double part = 4 * PMS_PI / n, step = 3 * part / 128;
            assert_true(fabs((double)power.r - 3 * part) <= step);
            assert_true(fabs((double)power.g - 2 * part) <= step);
            assert_true(fabs((double)power.b - 0.5 * part) <= step);
        }
        lit_done(&lit);
    }
}

/* Row S4: the deck's table as a scene.  Powers 9 and 1, 100 photons: 90 and 10, all alike. */
static void the_decks_table_as_a_scene(void **state)
{
    (void)state;
    char text[1024];
    snprintf(text, sizeof text,
             GRAY_ROOM "light_source { 0 rgb 9 } light_source { 0 rgb 1 } light_source { 0 rgb 0 }",
             100);
    LitScene lit;
    lit_make(&lit, text, 1, 1);
    const LightBooks *books = lit.maps.books.global;
    assert_int_equal(books[0].emitted, 90);
    assert_int_equal(books[1].emitted, 10);
    assert_int_equal(books[2].emitted, 0);
    for (size_t i = 0; i < photon_map_count(lit.maps.global); i++) {
        double power = (double)lit_photon_power(lit.maps.global, i).g;
        assert_true(fabs(power / (4 * PMS_PI * 0.1) - 1) <= 1.0 / 128);
    }
    lit_done(&lit);
}

static void make_lamps(LitScene *lit, int lamps)
{
    char text[2048] =
        "global_settings { assumed_gamma 1 photons { count 40000 }\n"
        "  pms { gi on gi_method map global_photons 30000 } }\n" SCREEN
        "box { <-1,-1,-1.1>, <1,1,-1> " PANE " photons { target refraction on collect off } }\n";
    for (int i = 1; i <= lamps; i++) {
        size_t used = strlen(text);
        snprintf(text + used, sizeof text - used, "light_source { <0,0,-3> rgb %d/%d }\n", i,
                 lamps * (lamps + 1) / 2);
    }
    lit_make(lit, text, 2, 1);
}

/* Row S4: however many lamps share the light of one, as many photons are sent, to each by its
 * power as far as the pilot tells.  For caustics the pilot's rays are fewer a lamp, and the
 * outline it finds a little wider. */
static void more_lights_share_the_same_photons(void **state)
{
    (void)state;
    double caustic[5], global[5];
    for (int lamps = 1; lamps <= 5; lamps++) {
        LitScene lit;
        make_lamps(&lit, lamps);
        caustic[lamps - 1] = global[lamps - 1] = 0;
        for (int i = 0; i < lamps; i++) {
            const LightBooks *a = &lit.maps.books.caustic[i], *b = &lit.maps.books.global[i];
            double share = (i + 1) / (lamps * (lamps + 1) / 2.0);
            caustic[lamps - 1] += (double)a->emitted;
            global[lamps - 1] += (double)b->emitted;
            assert_true(fabs(a->share / share - 1) < 0.05 && fabs(b->share / share - 1) < 0.05);
        }
        print_message("# %d lamps: %.0f and %.0f photons\n", lamps, caustic[lamps - 1],
                      global[lamps - 1]);
        assert_true(fabs(caustic[lamps - 1] / caustic[0] - 1) < 0.1);
        assert_true(global[lamps - 1] == 30000);
        lit_done(&lit);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_light_brings_what_shadow_rays_bring),
        cmocka_unit_test(a_light_inside_its_target),
        cmocka_unit_test(every_light_fills_the_global_map),
        cmocka_unit_test(photons_carry_the_power_of_their_light),
        cmocka_unit_test(each_photon_has_its_part),
        cmocka_unit_test(the_decks_table_as_a_scene),
        cmocka_unit_test(more_lights_share_the_same_photons),
    };
    return cmocka_run_group_tests_name("emission", tests, NULL, NULL);
}
