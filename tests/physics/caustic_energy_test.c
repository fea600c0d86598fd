/* Caustics hold the light that went into them.
 *
 * The expected values do not come from the photon walk: they are closed forms, or sums over a
 * fan of rays bent by Snell's law in the plane of the axis.  SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "lit_scene.h"
#include "sphere_fan.h"
#include "table.h"

static const char sphere_scene[] =
    "global_settings { assumed_gamma 1 max_trace_level 10 photons { count %d } }\n"
    "camera { location <0,6,-7> look_at <0,0,0> }\n"
    "%s\n"
    "plane { y, 0 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
    "sphere { <0,1.5,0>, 1 pigment { rgbt 1 } finish { ambient 0 diffuse 0 }\n"
    "  interior { ior 1.5 } photons { target refraction on reflection off collect off } }\n";

static const char point_light[] = "light_source { <0,6,0> rgb 1 }";
static const char parallel_light[] = "light_source { <0,6,0> rgb 1 parallel point_at 0 }";

static void make_sphere(LitScene *lit, const char *light, int photons)
{
    char text[1024];
    snprintf(text, sizeof text, sphere_scene, photons, light);
    lit_make(lit, text, 2, 1);
}

enum { BINS = 40 };
#define BIN_WIDTH 0.0666666667

/* Flux the fan brings into rings of the floor, by the language's power: colour length^2 dw for
 * a point light, colour dA for a parallel one. */
static double fan(bool is_parallel, double flux[BINS])
{
    enum { RAYS = 2000000 };
    double total = 0;
    memset(flux, 0, BINS * sizeof *flux);
    for (int i = 0; i < RAYS; i++) {
        double x = (i + 0.5) / RAYS, radius, length;
        double most = asin(1 / 4.5), angle = is_parallel ? 0 : most * x;
        if (!through_sphere(angle, is_parallel ? x : 0, &radius, &length))
            continue;
        double part = is_parallel ? 2 * PMS_PI * x / RAYS
                                  : 2 * PMS_PI * sin(angle) * most / RAYS * length * length;
        total += part;
        if (radius < BINS * BIN_WIDTH)
            flux[(int)(radius / BIN_WIDTH)] += part;
    }
    return total;
}

/* Every ring within 4 standard errors of the photons in it, and the sum within 0.5 %. */
static void check_rings(const char *light, bool is_parallel)
{
    LitScene lit;
    make_sphere(&lit, light, 200000);
    double expected[BINS], got[BINS] = {0}, square[BINS] = {0}, sum = 0;
    double total = fan(is_parallel, expected);
    const PhotonMap *map = lit.maps.caustic;
    for (size_t i = 0; i < photon_map_count(map); i++) {
        V3 p = lit_photon_place(map, i);
        double power = (double)lit_photon_power(map, i).g, radius = hypot(p.x, p.z);
        assert_true(fabs(p.y) < 1e-6);
        sum += power;
        if (radius < BINS * BIN_WIDTH) {
            got[(int)(radius / BIN_WIDTH)] += power;
            square[(int)(radius / BIN_WIDTH)] += power * power;
        }
    }
    double error = 0;
    for (int i = 0; i < BINS; i++)
        error += square[i];
    table_row(is_parallel ? "flux through a glass sphere, parallel light"
                          : "flux through a glass sphere, point light",
              sum, total, sqrt(error));
    assert_true(fabs(sum / total - 1) < 0.005);
    for (int i = 0; i < BINS; i++)
        assert_true(fabs(got[i] - expected[i]) < 4 * sqrt(square[i]) + 1e-3 * expected[i]);
    lit_done(&lit);
}

static void glass_sphere_point_light(void **state)
{
    (void)state;
    check_rings(point_light, false);
}

static void glass_sphere_parallel_light(void **state)
{
    (void)state;
    check_rings(parallel_light, true);
}

/* --- the picture of it --------------------------------------------------------------------- */

enum { RINGS = 1600 };
#define RING_WIDTH 0.001
#define PIXEL 0.0125 /* of a picture 320 wide of a floor 4 wide */

/* The mean of what the eye would see at a distance from the axis. */
static double seen_at(LitScene *lit, double radius)
{
    enum { PLACES = 256 };
    GatherLimits limits = GATHER_LIMITS_DEFAULT;
    limits.max_radius = lit->maps.caustic_radius;
    limits.far_radius = lit->maps.caustic_far;
    double sum = 0;
    for (int i = 0; i < PLACES; i++) {
        double angle = 2 * PMS_PI * (i + 0.5) / PLACES;
        V3 p = v3(radius * cos(angle), 0, radius * sin(angle));
        Rgb e;
        photon_gather(lit->maps.caustic, p, v3(0, 1, 0), &limits, lit->scratch, &e);
        sum += (double)e.g / PLACES;
    }
    return sum;
}

/* Where a profile falls through a level for the last time. */
static double fall(const double *profile, int count, double width, double level)
{
    int last = 0;
    for (int i = 0; i < count; i++)
        if (profile[i] > level)
            last = i;
    return (last + 1) * width;
}

/* Gathered as for a picture, the caustic has its profile within 2 % where it is smooth, and its
 * bright edge, a fold behind which there is a thirtieth of the light, within a pixel. */
static void profile_and_edge(void **state)
{
    (void)state;
    enum { STEPS = 160 };
    const double edge_level = 30, step = PIXEL / 8;
    static double expected[RINGS];
    double near_edge[STEPS];
    LitScene lit;
    fan_profile(expected, RINGS, RING_WIDTH);
    make_sphere(&lit, point_light, table_is_long() ? 4000000 : 1000000);
    for (double radius = 0.2; radius < 1.15; radius += 0.1) {
        double seen = seen_at(&lit, radius), wanted = expected[(int)(radius / RING_WIDTH)];
        char what[64];
        snprintf(what, sizeof what, "caustic of a glass sphere, %.1f from the axis", radius);
        table_row(what, seen, wanted, 0);
        assert_true(fabs(seen / wanted - 1) < 0.02);
    }
    for (int i = 0; i < STEPS; i++)
        near_edge[i] = seen_at(&lit, (i + 0.5) * step);
    double seen = fall(near_edge, STEPS, step, edge_level);
    double wanted = fall(expected, RINGS, RING_WIDTH, edge_level);
    table_row("its bright edge, pixels of 320", seen / PIXEL, wanted / PIXEL, 0);
    assert_true(fabs(seen - wanted) < PIXEL);
    lit_done(&lit);
}

/* The radial profile as measured in povray: irradiance of rings 2 to 12 of width 1/15. */
static void profile_matches_povray(void **state)
{
    (void)state;
    const double expected[] = {3.59, 2.03, 1.27, .85, .59, .43, .32, .24, .18, .14, .11};
    double flux[BINS];
    fan(false, flux);
    for (int i = 0; i < 11; i++) {
        int ring = i + 2;
        double area = PMS_PI * BIN_WIDTH * BIN_WIDTH * (2 * ring + 1);
        assert_true(fabs(flux[ring] / area - expected[i]) < 0.02 * expected[i] + 0.005);
    }
}

/* The gathered irradiance, integrated over the floor, is the stored flux: fixed radius exactly
 * (a photon counts pi r^2 / pi r^2 in all). */
static void gather_keeps_the_energy(void **state)
{
    (void)state;
    LitScene lit;
    lit_make(&lit,
             "global_settings { assumed_gamma 1 photons { count 100000 } }\n"
             "light_source { <0,3,0> rgb 1 parallel point_at 0 }\n"
             "plane { y, 0 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
             "cylinder { <0,1,0>, <0,2,0>, 1 pigment { rgbt 1 } finish { ambient 0 diffuse 0 }\n"
             "  interior { ior 1.5 } photons { target refraction on collect off } }\n",
             2, 1);
    GatherLimits limits = lit_within(0.05);
    double sum = 0, step = 0.0125, half = 1.6;
    for (double z = -half + step / 2; z < half; z += step)
        for (double x = -half + step / 2; x < half; x += step) {
            Rgb e;
            photon_gather(lit.maps.caustic, v3(x, 0, z), v3(0, 1, 0), &limits, lit.scratch, &e);
            sum += (double)e.g * step * step;
        }
    double stored = (double)lit.maps.books.caustic[0].flux_stored.g;
    assert_true(fabs(sum / stored - 1) < 0.003);
    assert_true(fabs(sum / PMS_PI - 1) < 0.01);
    lit_done(&lit);
}

/* Row S6: absorption on the way through: exp(-(1-k) d/D) as the language has it. */
static void absorbing_slab(void **state)
{
    (void)state;
    LitScene lit;
    lit_make(&lit,
             "global_settings { assumed_gamma 1 photons { count 50000 } }\n"
             "light_source { <0,3,0> rgb 1 parallel point_at 0 }\n"
             "plane { y, 0 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
             "box { <-1,1,-1>, <1,1.5,1> pigment { rgbt 1 } finish { ambient 0 diffuse 0 }\n"
             "  interior { ior 1.3 fade_distance 0.25 fade_power 1001 fade_color <1,0.5,0> }\n"
             "  photons { target refraction on reflection off collect off } }\n",
             2, 5);
    Rgb flux = lit.maps.books.caustic[0].flux_stored;
    assert_true(fabs((double)flux.r / 4 - 1) < 0.005);
    assert_true(fabs((double)flux.g / (4 * exp(-0.5 * 0.5 / 0.25)) - 1) < 0.005);
    assert_true(fabs((double)flux.b / (4 * exp(-0.5 / 0.25)) - 1) < 0.005);
    lit_done(&lit);
}

/* Row S6: Fresnel splits light without losing any: what a slab reflects and what it lets pass, both
 * caught by diffuse walls around, is what came. */
static void fresnel_loses_nothing(void **state)
{
    (void)state;
    LitScene lit;
    lit_make(
        &lit,
        "global_settings { assumed_gamma 1 max_trace_level 50 photons { count 100000 } }\n"
        "light_source { <0,3,0> rgb 1 parallel point_at <0.9,0,0> }\n"
        "box { <-9,-1,-9>, <9,5,9> hollow pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
        "box { <-1,1,-1>, <1,1.5,1> pigment { rgbt 1 }\n"
        "  finish { ambient 0 diffuse 0 reflection { 0, 1 fresnel } conserve_energy }\n"
        "  interior { ior 1.5 } photons { target refraction on reflection on collect off } }\n",
        2, 5);
    /* The box, 2 x 2 x 0.5, seen along the light: top and one side. */
    double length = hypot(0.9, 3), flux = 4 * 3 / length + 1 * 0.9 / length;
    const LightBooks *books = &lit.maps.books.caustic[0];
    print_message("# flux %.4f of %.4f\n", (double)books->flux_stored.g, flux);
    double error = 1 / sqrt((double)books->stored);
    assert_true(fabs((double)books->flux_stored.g / flux - 1) < 4 * error + 0.002);
    lit_done(&lit);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(glass_sphere_point_light), cmocka_unit_test(glass_sphere_parallel_light),
        cmocka_unit_test(profile_matches_povray),   cmocka_unit_test(gather_keeps_the_energy),
        cmocka_unit_test(absorbing_slab),           cmocka_unit_test(fresnel_loses_nothing),
        cmocka_unit_test(profile_and_edge),
    };
    return cmocka_run_group_tests_name("caustic_energy", tests, NULL, NULL);
}
