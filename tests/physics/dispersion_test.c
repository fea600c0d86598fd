/* Dispersion against Snell's law wavelength by wavelength: prisms at minimum deviation, the
 * spectrum photons throw on a screen, and white that stays white when all of it is put together
 * again.  SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "../unit/world.h"
#include "lit_eye.h"
#include "table.h"

#include "math/spectrum.h"
#include "render/render.h"
#include "fresnel_law.h"

static const Interior language_glass = {.ior = 1.5,
                                        .dispersion = DISPERSION_RATIO,
                                        .dispersion_samples = 7,
                                        .coefficients = {1.08}},
                      backward = {.ior = 1.6,
                                  .dispersion = DISPERSION_RATIO,
                                  .dispersion_samples = 7,
                                  .coefficients = {0.9}},
                      air_with_colours = {.ior = 1,
                                          .dispersion = DISPERSION_RATIO,
                                          .dispersion_samples = 7,
                                          .coefficients = {1.2}},
                      cauchy_glass = {.ior = 1.52,
                                      .dispersion = DISPERSION_CAUCHY,
                                      .dispersion_samples = 7,
                                      .coefficients = {1.5046, 0.0042}},
                      bk7 = {.ior = 1.5168,
                             .dispersion = DISPERSION_SELLMEIER,
                             .dispersion_samples = 7,
                             .coefficients = {1.03961212, 0.00600069867, 0.231792344, 0.0200179144,
                                              1.01046945, 103.560653}};

/* --- a prism, ray by ray ------------------------------------------------------------------- */

#define APEX_DEG 40
#define HALF_APEX (APEX_DEG * PMS_PI / 360)

static void prism_world(World *w, const Interior *interior)
{
    world_init(w);
    w->plan.rows[FEATURE_DISPERSION].is_on = true;
    Arena *arena = w->scene.arena;
    double c = cos(HALF_APEX), s = sin(HALF_APEX);
    Shape **sides = ARENA_ARRAY(arena, Shape *, 3);
    sides[0] = shape_plane(arena, v3(-c, s, 0), s);
    sides[1] = shape_plane(arena, v3(c, s, 0), s);
    sides[2] = shape_plane(arena, v3(0, -1, 0), 5);
    world_add(w, shape_csg(arena, SHAPE_INTERSECTION, sides, 3), clear(w), interior);
    world_ready(w);
}

/* Return the angle by which a prism turns a ray of a wavelength that falls on its left side. */
static double deviation(World *w, double incidence, double wavelength)
{
    double up = incidence - HALF_APEX;
    V3 d = v3(cos(up), sin(up), 0);
    Ray ray = {v3_mad(v3(-0.1, 0.1, 0), -3, d), d, 0, INFINITY};
    Interiors inside = {.wavelength = (float)wavelength};
    for (int i = 0; i < 2; i++) {
        Hit hit;
        SurfaceSample s;
        assert_true(trace_closest(&w->thread, &ray, RAY_CAMERA, &hit));
        surface_sample(&w->thread, &ray, &hit, &inside, &s);
        assert_true(s.has_transmission && !s.is_total_reflection && s.spectrum == 0);
        inside = s.inside_after;
        ray = trace_ray_from(&s.at, s.transmit_dir);
    }
    assert_true(inside.count == 0 && inside.wavelength == (float)wavelength);
    return acos(v3_dot(ray.d, d)) * (v3_cross(ray.d, d).z > 0 ? 1 : -1);
}

static void prisms_at_minimum_deviation(void **state)
{
    (void)state;
    const Interior *glasses[] = {&language_glass, &backward, &air_with_colours, &cauchy_glass,
                                 &bk7};
    for (int k = 0; k < 5; k++) {
        World w;
        prism_world(&w, glasses[k]);
        for (double wavelength = 380; wavelength <= 730; wavelength += 25) {
            double n = interior_ior(glasses[k], wavelength);
            double incidence = asin(n * sin(HALF_APEX));
            double least = deviation(&w, incidence, wavelength);
            double expected = 2 * incidence - 2 * HALF_APEX;
            assert_true(fabs(least - expected) < 1e-7); /* acos near 1 */
            if (glasses[k] == &bk7 && fmod(wavelength - 405, 150) == 0)
                table_row(wavelength < 500   ? "prism of BK7, 405 nm: least deviation, degrees"
                          : wavelength < 600 ? "prism of BK7, 555 nm"
                                             : "prism of BK7, 705 nm",
                          least * 180 / PMS_PI, expected * 180 / PMS_PI, 0);
            for (int side = -1; side <= 1; side += 2) {
                double turned = deviation(&w, incidence + side * 0.05, wavelength);
                assert_true(fabs(turned) > fabs(least) - 1e-7); /* n = 1: both 0 */
            }
        }
        world_done(&w);
    }
}

/* Violet is turned more than red; with a dispersion below 1 less. */
static void the_order_of_colours(void **state)
{
    (void)state;
    World w;
    prism_world(&w, &language_glass);
    assert_true(deviation(&w, 0.5, 400) > deviation(&w, 0.5, 700) + 0.01);
    world_done(&w);
    prism_world(&w, &backward);
    assert_true(deviation(&w, 0.5, 400) < deviation(&w, 0.5, 700) - 0.01);
    world_done(&w);
}

/* Two media that disperse, in touch: Snell's law between them. */
static void from_glass_to_glass(void **state)
{
    (void)state;
    World w;
    world_init(&w);
    w.plan.rows[FEATURE_DISPERSION].is_on = true;
    Interior more = bk7;
    more.dispersion_samples = 11;
    world_add(&w, box(&w, v3(-9, -9, 0), v3(9, 9, 1)), clear(&w), &language_glass);
    world_add(&w, box(&w, v3(-9, -9, 1), v3(9, 9, 2)), clear(&w), &more);
    world_ready(&w);
    V3 d = v3(0.3, 0, sqrt(1 - 0.09));
    for (int i = 0; i < 6; i++) {
        double wavelength = i ? 350 + 60.0 * i : 0;
        Ray ray = {v3(0, 0, 0.5), d, 0, INFINITY};
        Interiors inside;
        Hit hit;
        SurfaceSample s;
        interiors_at(w.tracer, ray.o, &inside);
        inside.wavelength = (float)wavelength;
        assert_true(trace_closest(&w.thread, &ray, RAY_CAMERA, &hit) && hit.tie_count == 1);
        surface_sample(&w.thread, &ray, &hit, &inside, &s);
        assert_int_equal(s.spectrum, i ? 0 : 11);
        double ratio = interior_ior(&language_glass, wavelength) / interior_ior(&more, wavelength);
        assert_true(fabs(s.transmit_dir.x - 0.3 * ratio) < 1e-6); /* float wavelength */
    }
    world_done(&w);
}

/* --- what the eye sees --------------------------------------------------------------------- */

#define HEAD                                                                                       \
    "#version 3.7;\nglobal_settings { assumed_gamma 1 max_trace_level 60 adc_bailout 1e-5 }\n"
#define FRESNEL "finish { ambient 0 diffuse 0 conserve_energy reflection { 0, 1 fresnel on } }\n"

static void open_text(LitScene *lit, LitEye *eye, const char *text)
{
    lit_read(lit, text, 1, 1);
    lit_eye_open(eye, lit, lit_within(1));
}

static void close_text(LitScene *lit, LitEye *eye)
{
    lit_eye_close(eye);
    lit_done(lit);
}

static Rgb beauty(const EyeSample *s)
{
    return rgb_add(rgb_add(s->part[0], s->part[1]), s->part[2]);
}

/* Whatever light is taken apart by, in an even surround all of it is white, and the beam lets
 * through as much of what is behind as it shows of that. */
static void white_stays_white(void **state)
{
    (void)state;
    static const char *const interiors[] = {
        "ior 1.5 dispersion 1.1",     "ior 1.5 dispersion 1.1 dispersion_samples 2",
        "ior 2.4 dispersion 1.05",    "ior 1.5 dispersion 1.3 dispersion_samples 150",
        "ior 1.5 dispersion 0.9",     "ior 1 dispersion 1.1",
        "pms { cauchy 1.7, 0.0132 }", "ior 0.8 dispersion 1.02"};
    /* the eye outside, and inside where total reflection traps no light */
    static const char *const bodies[] = {
        "camera { location <0.2,0.1,-4> look_at <0.1,0.3,0.2> angle 30 } sphere { 0, 1",
        "camera { location <0.2,0.1,-4> look_at <0.1,0.3,0.2> angle 30 }\n"
        "box { -0.7, 0.7 rotate <30, 40, 0>",
        "camera { location <0.2,0.1,-0.3> look_at <0.1,0.3,0.2> angle 80 } sphere { 0, 1",
        "camera { location -5*z look_at 0 angle 170 } plane { z, 0"};
    for (int k = 0; k < 8 * 4 * 2; k++) {
        char text[2048];
        snprintf(text, sizeof text,
                 HEAD "background { rgb 1 }\n%s pigment { rgbt 1 } %s interior { %s } }\n",
                 bodies[k / 2 % 4], k % 2 ? FRESNEL : "finish { ambient 0 diffuse 0 }\n",
                 interiors[k / 8]);
        LitScene lit;
        LitEye eye;
        open_text(&lit, &eye, text);
        for (int i = 0; i < 40; i++) {
            Rng rng = rng_at(3, 0, (uint64_t)i);
            EyeSample s = lit_look(&eye, rng_double(&rng), rng_double(&rng));
            Rgb seen = beauty(&s);
            if (!((double)rgb_max_abs(rgb_sub(seen, RGB_WHITE)) < 5e-3))
                fail_msg("case %d, ray %d: %g %g %g of\n%s", k, i, (double)seen.r, (double)seen.g,
                         (double)seen.b, text);
        }
        close_text(&lit, &eye);
    }
}

/* From within glass: at angles where some wavelengths are mirrored and others pass, what passes
 * is the sum of the bands Snell's law lets through, each weakened by Fresnel's. */
static void some_wavelengths_pass(void **state)
{
    (void)state;
    for (int fresnel = 0; fresnel < 2; fresnel++) {
        char text[2048];
        snprintf(text, sizeof text,
                 HEAD "camera { location <0,0,-5> right 0.5*x up 0.001*y direction <0.97,0,1> }\n"
                      "background { rgb 1 }\n"
                      "plane { z, 0 pigment { rgbt 1 } %s\n"
                      "  interior { ior 1.5 dispersion 1.2 dispersion_samples 20 } }\n"
                      "plane { z, -6 pigment { rgb 0 } finish { ambient 0 diffuse 0 } }\n",
                 fresnel ? FRESNEL : "finish { ambient 0 diffuse 0 }\n");
        LitScene lit;
        LitEye eye;
        open_text(&lit, &eye, text);
        int partly = 0;
        for (int i = 0; i < 100; i++) {
            double x = (i + 0.5) / 100, tangent = 0.97 + 0.5 * (x - 0.5);
            double sine = tangent / sqrt(1 + tangent * tangent);
            Rgb expected = RGB_BLACK;
            int passed = 0;
            for (int k = 0; k < 20; k++) {
                SpectrumBand band = spectrum_band(k, 20);
                double n = 1.5 * pow(1.2, (555 - band.wavelength) / 350);
                if (n * sine >= 1)
                    continue;
                passed++;
                double share = fresnel ? 1 - reflectance(n, 1, sine) : 1;
                expected = rgb_mad(expected, (float)share, band.color);
            }
            partly += passed > 0 && passed < 20;
            EyeSample s = lit_look(&eye, x, 0.5);
            assert_true((double)rgb_max_abs(rgb_sub(beauty(&s), expected)) < 2e-4);
        }
        assert_true(partly > 50);
        close_text(&lit, &eye);
    }
}

/* Dispersion 1 is none; where there is none the plan says so. */
static void dispersion_of_one_is_none(void **state)
{
    (void)state;
    static const char *const interiors[] = {"ior 1.5", "ior 1.5 dispersion 1",
                                            "ior 1.5 dispersion 1.1 pms { cauchy 2, 0 } ior 1.5",
                                            "ior 1.5 dispersion 1 dispersion_samples 20"};
    Rgb first[20];
    for (int k = 0; k < 4; k++) {
        char text[2048];
        snprintf(text, sizeof text,
                 HEAD
                 "camera { location <0,0,-4> look_at 0 angle 30 }\n"
                 "plane { z, 9 hollow pigment { gradient x } finish { ambient 1 diffuse 0 } }\n"
                 "sphere { 0, 1 pigment { rgbt 1 } " FRESNEL " interior { %s } }\n",
                 interiors[k]);
        LitScene lit;
        LitEye eye;
        open_text(&lit, &eye, text);
        assert_false(plan_has(&lit.plan, FEATURE_DISPERSION));
        for (int i = 0; i < 20; i++) {
            EyeSample s = lit_look(&eye, i / 20.0, 0.4);
            Rgb seen = beauty(&s);
            if (k == 0)
                first[i] = seen;
            assert_memory_equal(&first[i], &seen, sizeof seen);
        }
        close_text(&lit, &eye);
    }
}

/* --- what photons bring -------------------------------------------------------------------- */

/* A thin beam through a prism of glass onto a screen.  Its middle meets the left side at
 * (-t tan(apex/2), 1 - t), t being STRIKE. */
#define BEAM_RADIUS 0.05
#define SCREEN_X 40.0
#define STRIKE 0.3
#define INCIDENCE 0.55

static void prism_scene(char *text, size_t size, const char *interior)
{
    double c = cos(HALF_APEX), s = sin(HALF_APEX), up = INCIDENCE - HALF_APEX;
    V3 at = v3(-STRIKE * s / c, 1 - STRIKE, 0), from = v3_mad(at, -4, v3(cos(up), sin(up), 0));
    snprintf(text, size,
             "#version 3.7; global_settings { assumed_gamma 1 photons { count 2000000 } }\n"
             "light_source { <%.17g,%.17g,0> rgb 1 cylinder radius %g falloff %g tightness 0\n"
             "  parallel point_at <%.17g,%.17g,0> }\n"
             "plane { -x, -%g pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
             "intersection { plane { <%.17g,%.17g,0>, %.17g } plane { <%.17g,%.17g,0>, %.17g }\n"
             "  plane { -y, -0.5 } plane { z, 0.1 } plane { -z, 0.1 }\n"
             "  bounded_by { box { <-0.2,0.5,-0.1>, <0.2,1,0.1> } }\n"
             "  pigment { rgbt 1 } " FRESNEL " interior { %s }\n"
             "  photons { target refraction on reflection off collect off } }\n",
             from.x, from.y, BEAM_RADIUS, BEAM_RADIUS, at.x, at.y, SCREEN_X, -c, s, s, c, s, s,
             interior);
}

/* Where a ray that strikes at t meets the screen, by the index, and what is left of it. */
static double screen_y(double n, double strike, double *left)
{
    double within = asin(sin(INCIDENCE) / n), along = within - HALF_APEX;
    double tangent = tan(HALF_APEX), x = -strike * tangent, y = 1 - strike;
    /* the right side: x = (1 - y) tan(apex/2) */
    double t = ((1 - y) * tangent - x) / (cos(along) + sin(along) * tangent);
    x += t * cos(along);
    y += t * sin(along);
    double second = 2 * HALF_APEX - within, out = asin(n * sin(second));
    *left = (1 - reflectance(1, n, sin(INCIDENCE))) * (1 - reflectance(n, 1, sin(second)));
    return y + (SCREEN_X - x) * tan(HALF_APEX - out);
}

enum { BINS = 14, WAVES = 1400, CHORDS = 41 };

typedef struct Bins {
    double first, last; /* y of the ends */
    double sum[BINS][3];
} Bins;

static int bin_of(const Bins *bins, double y)
{
    int bin = (int)(BINS * (y - bins->first) / (bins->last - bins->first));
    return bin < 0 ? 0 : bin < BINS ? bin : BINS - 1;
}

/* Add up what Snell's law sends where, over wavelengths and over chords of the beam. */
static void expect_spectrum(const Interior *glass, Bins *bins)
{
    double left, chords = 0;
    *bins = (Bins){screen_y(interior_ior(glass, 380), STRIKE, &left),
                   screen_y(interior_ior(glass, 730), STRIKE, &left),
                   {{0}}};
    for (int k = 0; k < CHORDS; k++)
        chords += sqrt(1 - pow(2 * (k + 0.5) / CHORDS - 1, 2));
    for (int i = 0; i < WAVES; i++) {
        SpectrumBand band = spectrum_band(i, WAVES);
        double n = interior_ior(glass, band.wavelength);
        double wanted[3] = {(double)band.color.r, (double)band.color.g, (double)band.color.b};
        for (int k = 0; k < CHORDS; k++) {
            double off = 2 * (k + 0.5) / CHORDS - 1, chord = sqrt(1 - off * off) / chords;
            double strike = STRIKE + off * BEAM_RADIUS / cos(INCIDENCE) * cos(HALF_APEX);
            int bin = bin_of(bins, screen_y(n, strike, &left));
            for (int c = 0; c < 3; c++)
                bins->sum[bin][c] += wanted[c] * left * chord;
        }
    }
}

/* Each band of wavelengths arrives where Snell's law sends it, with the band's colour. */
static void check_spectrum(const char *interior)
{
    static LitScene lit;
    char text[4096];
    prism_scene(text, sizeof text, interior);
    lit_make(&lit, text, 2, 11);
    assert_non_null(lit.maps.caustic);
    Bins wanted, got, squares;
    expect_spectrum(lit.scene->surfaces[1].interior, &wanted);
    got = squares = (Bins){wanted.first, wanted.last, {{0}}};
    double flux = PMS_PI * BEAM_RADIUS * BEAM_RADIUS;
    for (size_t i = 0; i < photon_map_count(lit.maps.caustic); i++) {
        Rgb power = lit_photon_power(lit.maps.caustic, i);
        int bin = bin_of(&got, lit_photon_place(lit.maps.caustic, i).y);
        double channel[3] = {(double)power.r, (double)power.g, (double)power.b};
        for (int c = 0; c < 3; c++) {
            got.sum[bin][c] += channel[c] / flux;
            squares.sum[bin][c] += channel[c] * channel[c] / (flux * flux);
        }
    }
    print_message("# %s: %zu photons\n", interior, photon_map_count(lit.maps.caustic));
    for (int i = 0; i < BINS; i++)
        for (int c = 0; c < 3; c++) {
            if (c == 1 && i % 3 == 0 && wanted.sum[i][c] > 0.05) {
                char what[64];
                snprintf(what, sizeof what, "spectrum of %.20s..., band %d, green", interior, i);
                table_row(what, got.sum[i][c], wanted.sum[i][c], sqrt(squares.sum[i][c]));
            }
            double error = sqrt(squares.sum[i][c]), off = got.sum[i][c] - wanted.sum[i][c];
            if (!(fabs(off) < 4 * error + 2e-4)) /* of the sum over chords */
                fail_msg("%s, bin %d, channel %d: %.5f, expected %.5f +- %.5f", interior, i, c,
                         got.sum[i][c], wanted.sum[i][c], error);
        }
    lit_done(&lit);
}

static void photons_make_a_spectrum(void **state)
{
    (void)state;
    check_spectrum("ior 1.5 dispersion 1.08");
    check_spectrum("ior 1.6 dispersion 0.93");
    check_spectrum("ior 1 dispersion 1.15");
    check_spectrum("pms { cauchy 1.7, 0.02 }");
    check_spectrum("pms { sellmeier 1.73759695, 0.013188707, 0.313747346, 0.0623068142, "
                   "1.89878101, 155.23629 }");
}

static void sum_photons(const LitScene *lit, double sum[3], double error[3])
{
    for (int c = 0; c < 3; c++)
        sum[c] = error[c] = 0;
    for (size_t i = 0; i < photon_map_count(lit->maps.caustic); i++) {
        Rgb power = lit_photon_power(lit->maps.caustic, i);
        double channel[3] = {(double)power.r, (double)power.g, (double)power.b};
        for (int c = 0; c < 3; c++) {
            sum[c] += channel[c];
            error[c] += channel[c] * channel[c];
        }
    }
    for (int c = 0; c < 3; c++)
        error[c] = sqrt(error[c]);
}

/* All that comes through a tilted pane is white but for what Fresnel's law takes. */
static void photons_of_all_wavelengths_are_white(void **state)
{
    (void)state;
    static LitScene lit;
    lit_make(&lit,
             "#version 3.7; global_settings { assumed_gamma 1 photons { count 600000 } }\n"
             "light_source { <0,20,0> rgb 1 cylinder radius 1 falloff 1 tightness 0\n"
             "  parallel point_at 0 }\n"
             "plane { y, 0 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
             "box { <-3,0,-3>, <3,0.5,3> rotate 40*z translate 4*y pigment { rgbt 1 } " FRESNEL
             "  interior { ior 1.5 dispersion 1.1 }\n"
             "  photons { target refraction on reflection off collect off } }\n",
             2, 3);
    double sum[3], error[3], sine = sin(40 * PMS_PI / 180);
    sum_photons(&lit, sum, error);
    double expected[3] = {0};
    for (int i = 0; i < 50; i++) {
        SpectrumBand band = spectrum_band(i, 50);
        double n = 1.5 * pow(1.1, (555 - band.wavelength) / 350);
        double left = pow(1 - reflectance(1, n, sine), 2) * PMS_PI;
        expected[0] += (double)band.color.r * left;
        expected[1] += (double)band.color.g * left;
        expected[2] += (double)band.color.b * left;
    }
    for (int c = 0; c < 3; c++) {
        static const char *const what[3] = {"pane that disperses, all photons, red",
                                            "pane that disperses, all photons, green",
                                            "pane that disperses, all photons, blue"};
        table_row(what[c], sum[c] / PMS_PI, expected[c] / PMS_PI, error[c] / PMS_PI);
        assert_true(fabs(sum[c] - expected[c]) < 4 * error[c]);
        assert_true(fabs(sum[c] / expected[c] - 1) < 5e-3);
    }
    lit_done(&lit);
}

/* A photon that is reflected has not been taken apart. */
static void reflected_photons_are_white(void **state)
{
    (void)state;
    static LitScene lit;
    lit_make(&lit,
             "#version 3.7; global_settings { assumed_gamma 1 photons { count 20000 } }\n"
             "light_source { <0,5,0> rgb 1 }\n"
             "plane { -y, -6 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
             "sphere { 0, 1 pigment { rgbt 1 } " FRESNEL "  interior { ior 1.5 dispersion 1.02 }\n"
             "  photons { target refraction off reflection on collect off } }\n",
             1, 3);
    assert_true(photon_map_count(lit.maps.caustic) > 300);
    for (size_t i = 0; i < photon_map_count(lit.maps.caustic); i++) {
        Rgb power = lit_photon_power(lit.maps.caustic, i);
        assert_true(rgb_min(power) > 0.93f * rgb_max(power));
    }
    lit_done(&lit);
}

/* --- paths --------------------------------------------------------------------------------- */

/* Paths of one wavelength each find what the eye sees in many bands. */
static void paths_see_what_the_eye_sees(void **state)
{
    (void)state;
    enum { PATHS = 40000, RAYS = 100 };
    static const char text[] =
        HEAD "camera { location <0.9,0.1,-4> look_at <0.4,0.1,0> angle 12 }\n"
             "plane { -z, -3 pigment { gradient x color_map { [0 rgb 0] [0.5 rgb 0] [0.5 rgb 1]\n"
             "  [1 rgb 1] } scale 0.7 } finish { ambient 0 emission 1 diffuse 0 } }\n"
             "sphere { 0, 1 pigment { rgbt 1 } " FRESNEL
             "  interior { ior 1.6 dispersion 1.15 dispersion_samples 150 } }\n";
    LitScene lit;
    LitEye eye;
    open_text(&lit, &eye, text);
    double wanted[3] = {0}, sum[3] = {0}, squares[3] = {0};
    for (int i = 0; i < RAYS; i++) {
        EyeSample s = lit_look(&eye, (i + 0.5) / RAYS, 0.5);
        Rgb seen = beauty(&s);
        wanted[0] += (double)seen.r / RAYS;
        wanted[1] += (double)seen.g / RAYS;
        wanted[2] += (double)seen.b / RAYS;
    }
    close_text(&lit, &eye);
    PlanOptions plan = {.integrator = INTEGRATOR_PATH, .quality = 9};
    lit_read_as(&lit, text, 1, 1, plan);
    lit_eye_open(&eye, &lit, lit_within(1));
    for (int i = 0; i < PATHS; i++) {
        EyeSample s;
        assert_true(eye_sample(eye.thread, (i % RAYS + 0.5) / RAYS, 0.5, (uint32_t)(i % RAYS),
                               (uint32_t)(i / RAYS), &s));
        Rgb seen = beauty(&s);
        double channel[3] = {(double)seen.r, (double)seen.g, (double)seen.b};
        for (int c = 0; c < 3; c++) {
            sum[c] += channel[c] / PATHS;
            squares[c] += channel[c] * channel[c] / PATHS;
        }
    }
    close_text(&lit, &eye);
    for (int c = 0; c < 3; c++) {
        double error = sqrt((squares[c] - sum[c] * sum[c]) / PATHS);
        print_message("# channel %d: %.5f, expected %.5f +- %.5f\n", c, sum[c], wanted[c], error);
        assert_true(fabs(sum[c] - wanted[c]) < 4 * error);
    }
    assert_true(fabs(wanted[0] - wanted[2]) > 0.005); /* there are colours */
}

/* A closed room of radiance 1 with a ball of glass in it stays white, by every way of finding the
 * light. */
static void white_room(void **state)
{
    (void)state;
    static const struct {
        const char *name;
        PlanOptions plan;
        int samples;
    } ways[] = {{"by paths", {.quality = 9, .integrator = INTEGRATOR_PATH}, 400},
                {"gathered", {.quality = 9, .has_indirect = true, .indirect = INDIRECT_GATHER}, 1},
                {"cached", {.quality = 9, .has_indirect = true}, 1}};
    static const char text[] =
        "#version 3.7; global_settings { assumed_gamma 1 max_trace_level 40 adc_bailout 1e-4\n"
        "  pms { global_photons 400000 } }\n"
        "camera { location <0,0,-0.6> look_at z angle 80 right x up y }\n"
        "sphere { 0, 1 hollow pigment { rgb 1 } finish { ambient 0 emission 0.5 diffuse 0.5 } }\n"
        "sphere { <0.1,0,0.3>, 0.4 pigment { rgbt 1 } " FRESNEL
        "  interior { ior 1.6 dispersion 1.1 } }\n";
    for (int k = 0; k < 3; k++) {
        enum { SIDE = 20 };
        static LitScene lit;
        RenderResult result;
        RenderOptions options = RENDER_OPTIONS_DEFAULT;
        lit_read_as(&lit, text, 1, 1, ways[k].plan);
        options.width = options.height = SIDE;
        options.threads = 2;
        options.plan = ways[k].plan;
        options.samples = ways[k].samples;
        options.aa = AA_UNIFORM;
        assert_int_equal(render_scene(lit.scene, &options, &lit.diag, &result), OK);
        const ImageLayer *layer = &result.image.layers[0];
        for (int c = 0; c < 3; c++) {
            double sum = 0, squares = 0;
            for (int i = 0; i < SIDE * SIDE; i++) {
                double pixel = (double)layer->pixels[i * layer->channel_count + c];
                sum += pixel / (SIDE * SIDE);
                squares += pixel * pixel / (SIDE * SIDE);
            }
            double error = sqrt(fmax(0, squares - sum * sum) / (SIDE * SIDE));
            char what[64];
            snprintf(what, sizeof what, "white room with glass that disperses, %s, %s",
                     ways[k].name,
                     c == 0   ? "red"
                     : c == 1 ? "green"
                              : "blue");
            table_row(what, sum, 1, error);
            /* Pixels share photons: their scatter is not all of the error of those. */
            assert_true(fabs(sum - 1) < 4 * error + (k > 0 ? 1.5e-3 : 0));
            assert_true(fabs(sum - 1) < 5e-3);
        }
        render_result_done(&result);
        lit_done(&lit);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(prisms_at_minimum_deviation),
        cmocka_unit_test(the_order_of_colours),
        cmocka_unit_test(from_glass_to_glass),
        cmocka_unit_test(white_stays_white),
        cmocka_unit_test(some_wavelengths_pass),
        cmocka_unit_test(dispersion_of_one_is_none),
        cmocka_unit_test(photons_make_a_spectrum),
        cmocka_unit_test(photons_of_all_wavelengths_are_white),
        cmocka_unit_test(reflected_photons_are_white),
        cmocka_unit_test(paths_see_what_the_eye_sees),
        cmocka_unit_test(white_room),
    };
    return cmocka_run_group_tests_name("dispersion", tests, NULL, NULL);
}
