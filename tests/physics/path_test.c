/* Path tracing against closed forms, and against the photon maps, with which it shares no code.
 * SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "lit_paths.h"

#include "render/render.h"

#define HEAD "#version 3.7;\nglobal_settings { assumed_gamma 1 }\n"

/* --- the closed sphere ------------------------------------------------------------------------ */

/* Light of colour 1 at the centre of a unit sphere of reflectance 1/2: direct 1/2, indirect 1/2. */
static void sphere_has_radiance_1(void **state)
{
    (void)state;
    Mean mean = measure(HEAD "camera { location <0.3,0.1,0.2> look_at <0,1,0.3> angle 100 }\n"
                             "light_source { 0, rgb 1 }\n"
                             "sphere { 0, 1 hollow pigment { rgb 1 }\n"
                             "  finish { ambient 0.5 diffuse 0.5 } }\n",
                        0, 2000, NULL, NULL);
    check("closed sphere, paths", mean.sum, 1, mean.error);
    check("its direct light", mean.part[PART_DIRECT], 0.5, mean.part_error[PART_DIRECT]);
    check("its caustics", mean.part[PART_CAUSTIC], 0, mean.part_error[PART_CAUSTIC]);
}

/* Lights away from the centre: the wall's own light is direct; what it sends round is the same
 * everywhere, rho/(1-rho) of the mean of the direct light. */
typedef struct Lamps {
    V3 at[4];
    double mean; /* irradiance of the sphere */
} Lamps;

static double lamps_irradiance(const Lamps *lamps, V3 p)
{
    double sum = 0;
    for (int i = 0; i < 4; i++)
        sum += 0.25 * v3_dot(v3_unit(v3_sub(lamps->at[i], p)), v3_neg(v3_unit(p)));
    return sum;
}

static double lamps_expected(const void *ctx, V3 p)
{
    const Lamps *lamps = ctx;
    return 0.5 * (lamps_irradiance(lamps, p) + lamps->mean);
}

static void sphere_of_four_lights(void **state)
{
    (void)state;
    Lamps lamps = {{{0.5, 0, 0}, {0, 0.7, 0}, {-0.1, 0.2, 0.3}, {0, -0.3, -0.6}}, 0};
    enum { STEPS = 400 };
    for (int i = 0; i < STEPS; i++)
        for (int j = 0; j < STEPS; j++) {
            double z = 2 * (i + 0.5) / STEPS - 1, a = 2 * PMS_PI * (j + 0.5) / STEPS;
            V3 p = v3(sqrt(1 - z * z) * cos(a), sqrt(1 - z * z) * sin(a), z);
            lamps.mean += lamps_irradiance(&lamps, p) / STEPS / STEPS;
        }
    Mean mean = measure(HEAD "camera { location <0.3,0.1,0.2> look_at <0,1,0.3> angle 100 }\n"
                             "light_source { <0.5,0,0>, rgb 0.25 }\n"
                             "light_source { <0,0.7,0>, rgb 0.25 }\n"
                             "light_source { <-0.1,0.2,0.3>, rgb 0.25 }\n"
                             "light_source { <0,-0.3,-0.6>, rgb 0.25 }\n"
                             "sphere { 0, 1 hollow pigment { rgb 1 } finish { diffuse 0.5 } }\n",
                        0, 2000, lamps_expected, &lamps);
    check("closed sphere, four lamps, paths", mean.sum, mean.expected, mean.error);
}

/* Highlights are for the eye alone. */
static void highlights_send_nothing_on(void **state)
{
    (void)state;
    Mean mean = measure(HEAD "camera { location <0.3,0.1,0.2> look_at <0,1,0.3> angle 100 }\n"
                             "light_source { 0, rgb 1 }\n"
                             "sphere { 0, 1 hollow pigment { rgb 1 }\n"
                             "  finish { ambient 0.5 diffuse 0.5 phong 1 phong_size 2 } }\n",
                        0, 2000, NULL, NULL);
    assert_true(mean.part[PART_DIRECT] > 0.6);
    check("beside highlights", mean.part[PART_INDIRECT], 0.5, mean.part_error[PART_INDIRECT]);
}

static void sphere_that_glows(void **state)
{
    (void)state;
    Mean mean = measure(HEAD "camera { location <0.3,0.1,0.2> look_at <0,1,0.3> angle 100 }\n"
                             "sphere { 0, 1 hollow pigment { rgb 1 }\n"
                             "  finish { ambient 0 diffuse 0.5 emission 0.5 } }\n",
                        0, 2000, NULL, NULL);
    check("closed sphere, glow, paths", mean.sum, 1, mean.error);
    check("its own light", mean.part[PART_DIRECT], 0.5, mean.part_error[PART_DIRECT]);
}

/* Diffuse 1/4 and mirror 1/4.  The light fades as 1/D^2, so its flux stays the same over the
 * mirrors; all light on the wall is then 1/(1 - 1/2) = 2.  The wall sends 1/2 of it on diffusely,
 * and the eye sees that again in the mirrors: 1/2 * 4/3.  Light over mirrors alone onto the wall
 * is 1/4 + 1/16 + ... = 1/3. */
static void sphere_half_of_mirror(void **state)
{
    (void)state;
    Mean mean = measure(HEAD "camera { location <0.3,0.1,0.2> look_at <0,1,0.3> angle 100 }\n"
                             "light_source { 0, rgb 500000.5 fade_distance 0.001 fade_power 2 }\n"
                             "sphere { 0, 1 hollow pigment { rgb 1 }\n"
                             "  finish { ambient 0 diffuse 0.25 reflection 0.25 } }\n",
                        0.2, 6000, NULL, NULL);
    check("closed sphere, half a mirror, paths", mean.sum, 2.0 / 3, mean.error);
    check("its direct light", mean.part[PART_DIRECT], 1.0 / 3, mean.part_error[PART_DIRECT]);
    check("its caustics", mean.part[PART_CAUSTIC], 1.0 / 9, mean.part_error[PART_CAUSTIC]);
}

/* Mirrors that lose nothing keep no path for ever.  In a room of them the matt floor, of
 * reflectance 1/2, is lit by 1 and gets all it sends back: 1/2 * (1 + 1/2 + 1/4 + ...) = 1. */
static void endless_mirrors(void **state)
{
    (void)state;
    Mean mean = measure(HEAD "camera { location <0,0.5,0> look_at <0,0.6,1> }\n"
                             "light_source { <0,0.9,0>, rgb 1 parallel point_at 0 }\n"
                             "box { <-1,0,-1>, <1,1,1> hollow pigment { rgb 0 }\n"
                             "  finish { diffuse 0 reflection 1 } }\n"
                             "box { <-1,-1,-1>, <1,0.001,1> pigment { rgb 1 }\n"
                             "  finish { ambient 0 diffuse 0.5 } }\n",
                        0, 300, NULL, NULL);
    check("room of mirrors", mean.sum, 1, mean.error);
    assert_true(mean.error < 0.02);
    assert_int_equal(mean.stats.count[STAT_TRACE_LIMIT], 0);
}

/* --- furnaces ------------------------------------------------------------------------------ */

/* In even light of radiance 1, radiance is reflectance; where nothing is lost nothing is seen. */
static void furnace(void **state)
{
    (void)state;
    static const struct {
        const char *name, *content;
        double expected;
    } cases[] = {
        {"matt ball", "sphere { 0, 9 pigment { rgb 1 } finish { diffuse 0.8 } }", 0.8},
        {"brilliance 3",
         "sphere { 0, 9 pigment { rgb 1 } finish { diffuse albedo 0.8 brilliance 3 } }", 0.8},
        {"brilliance 0.5",
         "sphere { 0, 9 pigment { rgb 1 } finish { diffuse albedo 0.8 brilliance 0.5 } }", 0.8},
        {"sheet lit from behind", "disc { 0, z, 99 pigment { rgb 1 } finish { diffuse 0.5, 0.3 } }",
         0.8},
        {"two layers",
         "sphere { 0, 9 texture { pigment { rgb 1 } finish { diffuse 0.8 } }\n"
         "  texture { pigment { rgbt <1,1,1,0.25> } finish { diffuse 0.4 } } }",
         0.75 * 0.4 + 0.25 * 0.8},
        {"mirror of an exponent",
         "sphere { 0, 9 pigment { rgb 0 } finish { diffuse 0 reflection { 0.8 exponent 2 } } }",
         0.8},
        {"white balls that touch",
         "sphere { <-1,0,0>, 1 pigment { rgb 1 } finish { diffuse 1 } }\n"
         "sphere { <1,0,0>, 1 pigment { rgb 1 } finish { diffuse 1 } }\n"
         "sphere { <0,1.7,0.3>, 1 pigment { rgb 1 } finish { diffuse 1 } }",
         1},
        {"glass on white",
         "box { <-9,-3,-9>, <9,-1,9> pigment { rgb 1 } finish { diffuse 1 } }\n"
         "sphere { 0, 0.999 pigment { rgbt 1 } interior { ior 1.5 }\n"
         "  finish { diffuse 0 reflection { 0, 1 fresnel } conserve_energy } }",
         1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[2048];
        snprintf(text, sizeof text,
                 HEAD "camera { orthographic location <0,0,-20> look_at 0 right 2*x up 2*y }\n"
                      "background { rgb 1 }\n%s\n",
                 cases[i].content);
        Mean mean = measure(text, 0, 600, NULL, NULL);
        check(cases[i].name, mean.sum, cases[i].expected, mean.error);
    }
}

/* The exponent bends light other than 1: the root of 1/4. */
static void reflection_exponent(void **state)
{
    (void)state;
    Mean mean = measure(HEAD "camera { orthographic location <0,0,-20> look_at 0 right x up y }\n"
                             "background { rgb 0.25 }\n"
                             "sphere { 0, 9 pigment { rgb 0 } finish { ambient 0 diffuse 0\n"
                             "  reflection { 0.8 exponent 2 } } }\n",
                        0, 10, NULL, NULL);
    check("exponent", mean.sum, 0.4, 0);
}

/* --- transparent things -------------------------------------------------------------------- */

#define FLOOR "plane { y, 0 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
#define LOOKING_DOWN "camera { orthographic location <0,0.5,0> direction -y right x up z }\n"

typedef struct Pane {
    const char *look;
    double through, depth; /* exp(-depth) of light straight down is absorbed */
} Pane;

/* Irradiance below a light of colour 1 at height 3, under a pane. */
static double under_pane(const void *ctx, V3 p)
{
    const Pane *pane = ctx;
    double cosine = 3 / sqrt(9 + p.x * p.x + p.z * p.z);
    return pane->through * exp(-pane->depth / cosine) * cosine;
}

/* A pane of ior 1 filters, exactly, and no path brings the light again; nor does one over what
 * casts no shadow. */
static void pane_of_ior_1(void **state)
{
    (void)state;
    static const Pane cases[] = {
        {"pigment { rgbt 1 }", 1, 0},
        {"pigment { rgbf <1,0.5,1,1> }", 0.25, 0},
        {"pigment { rgbt 1 } interior { ior 1 fade_distance 0.1 fade_power 1001 }", 1, 1},
        {"pigment { rgb 0 } no_shadow", 1, 0},
        {"pigment { rgbt 1 } interior { ior 1.5 } no_shadow", 1, 0},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[2048];
        snprintf(text, sizeof text,
                 HEAD LOOKING_DOWN "light_source { <0,3,0>, rgb 1 }\n" FLOOR
                                   "box { <-9,1,-9>, <9,1.1,9> %s finish { diffuse 0 } }\n",
                 cases[i].look);
        Mean mean = measure(text, 0.5, 200, under_pane, &cases[i]);
        check(cases[i].look, mean.sum, mean.expected, mean.error);
        assert_true(mean.part[PART_CAUSTIC] == 0);
        assert_true(mean.error < 1e-4);
    }
}

/* A pane that takes light for its reflection hides the light from shadow rays; paths bring what
 * passes, and no more. */
static void pane_that_conserves_energy(void **state)
{
    (void)state;
    /* Through both sides, and any number of times round in between. */
    const Pane pane = {NULL, 0.75 * 0.75 / (1 - 0.25 * 0.25), 0};
    Mean mean =
        measure(HEAD LOOKING_DOWN "light_source { <0,3,0>, rgb 1 }\n" FLOOR
                                  "box { <-9,1,-9>, <9,1.0001,9> pigment { rgbt 1 }\n"
                                  "  finish { diffuse 0 reflection 0.25 conserve_energy } }\n",
                0.5, 4000, under_pane, &pane);
    assert_true(mean.part[PART_DIRECT] == 0);
    check("pane of a mirror", mean.part[PART_CAUSTIC], mean.expected,
          mean.part_error[PART_CAUSTIC]);
}

/* Light goes into water and stays: its floor has all of it, although rays from there are spread
 * over a narrower cone in the air.  The light is a disk as wide as 0.2 seen from 1: of all
 * directions within the angle a that is (1 + cos a)/2 of light from its middle. */
static void floor_under_water(void **state)
{
    (void)state;
    Mean mean =
        measure(HEAD "camera { orthographic location <0,1.5,0> direction -y right x up z }\n"
                     "light_source { <0,3,0>, rgb 1 parallel point_at <0,2,0> }\n" FLOOR
                     "box { <-9,0,-9>, <9,1,9> pigment { rgbt 1 } finish { diffuse 0 }\n"
                     "  interior { ior 1.5 fade_distance 2 fade_power 1001 } }\n",
                0.2, 8000, NULL, NULL);
    double angle = atan(0.2);
    /* What the water takes it takes on the way down, and for the eye on the way up; slanted rays
     * lose 1 % of the exponent more at most. */
    double expected = 0.5 * (1 + cos(angle)) * exp(-0.5) * exp(-0.5);
    check("floor under water", mean.part[PART_CAUSTIC], expected, mean.part_error[PART_CAUSTIC]);
    assert_true(mean.part_error[PART_CAUSTIC] < 0.01);
}

/* --- lights in a mirror -------------------------------------------------------------------- */

/* A mirror floor, a light above it and a ceiling that only the mirror lights: each light is as if
 * it stood, turned over, below the floor. */
static double mirrored(const void *ctx, V3 p)
{
    const Light *light = ctx;
    LightSample sample = light_at(light, light->location, p);
    return (double)sample.color.g * fmax(0, -sample.to_light.y);
}

static V3 turned_over(V3 v)
{
    return v3(v.x, -v.y, v.z);
}

static Light light_below(const char *text)
{
    LitScene lit;
    lit_read(&lit, text, 1, 1);
    Light light = lit.scene->lights[0];
    light.location = turned_over(light.location);
    light.direction = turned_over(light.direction);
    lit_done(&lit);
    return light;
}

static void lights_in_a_mirror(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double radius, phong;
    } lights[] = {
        {"<0.2,1,0>, rgb 1", 0.25, 0},
        {"<0.2,1,0>, rgb 0.5", 0.25, 1},
        {"<0.2,1,0>, rgb 9 fade_distance 0.5 fade_power 2", 0.25, 0},
        {"<0,1,0>, rgb 1 spotlight point_at 0 radius 5 falloff 20 tightness 2", 0.15, 0},
        {"<0,1,0>, rgb 1 parallel point_at <0.3,0,0>", 0.1, 0},
        {"<0,1,0>, rgb 2 parallel point_at 0 fade_distance 2 fade_power 1", 0.1, 0},
        {"<1,1,0>, rgb 1 cylinder point_at x radius 0.2 falloff 3 tightness 1", 0.07, 0},
        {"<0.2,1,0>, rgb 1 area_light <0.5,0,0>, <0.2,0,0.4>, 3, 5", 0, 0},
        {"<0.2,1,0>, rgb 1 area_light <0.5,0,0.1>, <0,0.2,0.4>, 3, 5 circular", 0, 0},
        {"<0.2,1,0>, rgb 1 area_light <0.5,0,0>, <0,0,0.5>, 3, 3 circular orient", 0, 0},
    };
    for (size_t i = 0; i < sizeof lights / sizeof *lights; i++) {
        char text[2048];
        snprintf(text, sizeof text,
                 HEAD "camera { orthographic location <0,1.5,0> direction y right x up z }\n"
                      "light_source { %s }\n"
                      "plane { y, 0 pigment { rgb 0 } finish { diffuse 0 reflection 0.5 } }\n"
                      "plane { -y, -2 pigment { rgb 1 } finish { ambient 0 diffuse 1\n"
                      "  phong %g phong_size 1 } }\n"
                      "box { <-9,1.2,-9>, <9,1.3,9> pigment { rgbt 1 } interior { ior 1 } }\n",
                 lights[i].text, lights[i].phong);
        Light light = light_below(text);
        Mean mean = measure(text, lights[i].radius, 2500, mirrored, &light);
        /* Seen straight on, a highlight of size 1 is one cosine more.
         * The size of a light changes what it gives by the square of the angle it is seen at. */
        double expected = 0.5 * (1 + lights[i].phong) * mean.expected, size = 0.006 * expected;
        check(lights[i].text, mean.part[PART_CAUSTIC], expected,
              mean.part_error[PART_CAUSTIC] + size / 4);
    }
}

/* The eye sees no lights, not in mirrors either. */
static void lights_are_not_seen(void **state)
{
    (void)state;
    Mean mean = measure(HEAD LOOKING_DOWN
                        "light_source { <0,1,0>, rgb 1 }\n"
                        "plane { y, 0 pigment { rgb 0 } finish { diffuse 0 reflection 0.5 } }\n",
                        0.5, 10, NULL, NULL);
    assert_true(mean.sum == 0);
}

/* Without a size there is no such light, and the plan says so. */
static void lights_without_a_size(void **state)
{
    (void)state;
    const char *text = HEAD "camera { orthographic location <0,1.5,0> direction y right x up z }\n"
                            "light_source { <0,1,0>, rgb 1 }\n"
                            "plane { y, 0 pigment { rgb 0 } finish { diffuse 0 reflection 0.5 } }\n"
                            "plane { -y, -2 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n";
    Mean mean = measure(text, 0, 20, NULL, NULL);
    assert_true(mean.part[PART_CAUSTIC] == 0);
    LitScene lit;
    lit_read_as(&lit, text, 1, 1, (PlanOptions){.integrator = INTEGRATOR_PATH, .quality = 9});
    assert_int_equal(lit.plan.unmet_lights, 1);
    assert_false(plan_has(&lit.plan, FEATURE_PATH_CAUSTICS));
    assert_non_null(strstr(lit.plan.rows[FEATURE_PATH_CAUSTICS].reason, "MISSING"));
    lit_done(&lit);
}

/* --- against the photon maps --------------------------------------------------------------- */

/* All the light that a glass ball brings from an area light to a square of the floor. */
static void caustic_of_a_glass_ball(void **state)
{
    (void)state;
    char text[2048];
    const char *scene =
        "#version 3.7;\n"
        "global_settings { assumed_gamma 1 max_trace_level 20 photons { count 200000 } }\n"
        "camera { orthographic location <0,9,0> direction -y right 4*x up 4*z }\n"
        "light_source { <0.5,5,0>, rgb 1 area_light x, z, 9, 9\n"
        "  photons { area_light } }\n" FLOOR
        "sphere { <0,1.5,0>, 1 pigment { rgbt 1 } interior { ior 1.5 } %s\n"
        "  finish { diffuse 0 reflection { 0, 1 fresnel } conserve_energy }\n"
        "  photons { target refraction on reflection on collect off } }\n";
    LitScene lit;
    snprintf(text, sizeof text, scene, "");
    lit_make(&lit, text, 2, 1);
    double flux = 0, squares = 0;
    for (size_t i = 0; i < photon_map_count(lit.maps.caustic); i++) {
        V3 p = lit_photon_place(lit.maps.caustic, i);
        double power = (double)lit_photon_power(lit.maps.caustic, i).g;
        if (fabs(p.x) < 2 && fabs(p.z) < 2 && fabs(p.y) < 1e-6) {
            flux += power;
            squares += power * power;
        }
    }
    lit_done(&lit);
    /* The camera sees the floor, as if the ball were not there. */
    snprintf(text, sizeof text, scene, "no_image");
    Mean mean = measure(text, 0, 6000, NULL, NULL);
    double error = hypot(16 * mean.part_error[PART_CAUSTIC], sqrt(squares));
    check("caustic of a ball", 16 * mean.part[PART_CAUSTIC], flux, error);
    assert_true(error < 0.03 * flux);
}

static double mean_of_render(const Scene *scene, PlanOptions plan, int samples, Diag *diag)
{
    RenderOptions options = RENDER_OPTIONS_DEFAULT;
    RenderResult result;
    options.width = options.height = 24;
    options.threads = 2;
    options.aa = AA_UNIFORM;
    options.samples = samples;
    options.plan = plan;
    assert_int_equal(render_scene(scene, &options, diag, &result), OK);
    double sum = 0;
    for (size_t i = 0; i < 24 * 24; i++)
        sum += (double)result.image.layers[0].pixels[4 * i + 1] / (24 * 24);
    render_result_done(&result);
    return sum;
}

/* A room of coloured walls with a block in it: indirect light read from the global map is blurred
 * over edges and corners, so the two agree to a few parts in a hundred. */
static void room_agrees_with_the_global_map(void **state)
{
    (void)state;
    LitScene lit;
    lit_read(
        &lit,
        "#version 3.7;\n"
        "global_settings { assumed_gamma 1 max_trace_level 100\n"
        "  pms { gi on global_photons 400000 } }\n"
        "camera { location <0,1,-0.95> look_at <0,1,1> angle 80 right x up y }\n"
        "light_source { <0,1.9,0>, rgb 2 fade_distance 1 fade_power 2 }\n"
        "#default { finish { ambient 0 diffuse 0.7 } }\n"
        "box { <-1,0,-1>, <1,2,1> hollow pigment { checker rgb <1,0.8,0.5>, rgb <0.8,1,0.6> } }\n"
        "box { <-0.6,0,0>, <0,0.9,0.5> pigment { rgb 0.9 } }\n",
        1, 1);
    double map = mean_of_render(lit.scene, PLAN_OPTIONS_DEFAULT, 4, &lit.diag);
    PlanOptions path = {.integrator = INTEGRATOR_PATH, .quality = 9};
    double paths = mean_of_render(lit.scene, path, 256, &lit.diag);
    PlanOptions direct = {.quality = 8};
    print_message("# room: %.4f by paths, %.4f by the map, %.4f without indirect light\n", paths,
                  map, mean_of_render(lit.scene, direct, 4, &lit.diag));
    assert_true(fabs(paths / map - 1) < 0.03);
    lit_done(&lit);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sphere_has_radiance_1),
        cmocka_unit_test(sphere_of_four_lights),
        cmocka_unit_test(highlights_send_nothing_on),
        cmocka_unit_test(sphere_that_glows),
        cmocka_unit_test(sphere_half_of_mirror),
        cmocka_unit_test(endless_mirrors),
        cmocka_unit_test(furnace),
        cmocka_unit_test(reflection_exponent),
        cmocka_unit_test(pane_of_ior_1),
        cmocka_unit_test(pane_that_conserves_energy),
        cmocka_unit_test(floor_under_water),
        cmocka_unit_test(lights_in_a_mirror),
        cmocka_unit_test(lights_are_not_seen),
        cmocka_unit_test(lights_without_a_size),
        cmocka_unit_test(caustic_of_a_glass_ball),
        cmocka_unit_test(room_agrees_with_the_global_map),
    };
    return cmocka_run_group_tests_name("path", tests, NULL, NULL);
}
