/* The plan: each row for the scene that calls for it and the one that does not.
 * SPDX-License-Identifier: Apache-2.0 */
#include "plan/plan.h"

#include "quiet.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

/* A scene of one surface and one light, to be changed by each test. */
typedef struct Small {
    Finish finish;
    Pigment pigment;
    Layer layer;
    Texture texture;
    Interior interior;
    Surface surface;
    Light light;
    Scene scene;
    Source source;
    Arena *arena;
    Plan plan;
} Small;

static Span span_at(Small *s, uint32_t begin)
{
    return (Span){&s->source, begin, begin + 1};
}

static int set_up(void **state)
{
    static Small s;
    memset(&s, 0, sizeof s);
    s.arena = arena_new();
    s.source = (Source){"a.pms", "0123456789", 10};
    s.finish = FINISH_DEFAULT;
    s.pigment = (Pigment){.is_solid = true, .color = {1, 1, 1, 0, 0}};
    s.layer = (Layer){&s.pigment, &s.finish};
    s.texture = (Texture){.layers = &s.layer, .layer_count = 1};
    s.interior = INTERIOR_DEFAULT;
    s.surface = (Surface){.texture = &s.texture,
                          .interior = &s.interior,
                          .photons = PHOTON_FLAGS_DEFAULT,
                          .span = span_at(&s, 1)};
    s.light = (Light){.color = {1, 1, 1}, .photon_share = 1, .span = span_at(&s, 2)};
    s.scene = (Scene){.surfaces = &s.surface,
                      .surface_count = 1,
                      .lights = &s.light,
                      .light_count = 1,
                      .settings.photons.gather_max = 100};
    *state = &s;
    return s.arena ? 0 : -1;
}

static int tear_down(void **state)
{
    arena_free(((Small *)*state)->arena);
    return 0;
}

static bool has(Small *s, PlanOptions options, FeatureId feature)
{
    assert_int_equal(plan_make(&s->scene, &options, s->arena, &s->plan), OK);
    return plan_has(&s->plan, feature);
}

static void make_glass(Small *s)
{
    s->surface.may_transmit = true;
    s->surface.is_target = true;
    s->surface.photons.is_target = true;
    s->surface.photons.refraction = TRI_ON;
}

static void every_row_has_a_reason(void **state)
{
    Small *s = *state;
    for (int quality = 0; quality <= 9; quality++) {
        has(s, (PlanOptions){.quality = quality}, FEATURE_SKY);
        for (int i = 0; i < FEATURE_COUNT; i++) {
            assert_true(s->plan.rows[i].reason[0] != '\0');
            assert_true(feature_name((FeatureId)i)[0] && feature_text((FeatureId)i)[0]);
        }
    }
}

static void a_plain_scene_needs_light_and_shadows_only(void **state)
{
    Small *s = *state;
    has(s, PLAN_OPTIONS_DEFAULT, FEATURE_SKY);
    for (int i = 0; i < FEATURE_COUNT; i++)
        assert_int_equal(plan_has(&s->plan, (FeatureId)i),
                         i == FEATURE_LIGHTS || i == FEATURE_SHADOWS);
    assert_true(s->plan.has_ambient && !s->plan.is_unlit);
}

static void dispersion_wants_a_transparent_interior_that_has_it(void **state)
{
    Small *s = *state;
    const PlanRow *row = &s->plan.rows[FEATURE_DISPERSION];
    s->interior.dispersion = DISPERSION_RATIO;
    s->interior.coefficients[0] = 1.1;
    assert_false(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_DISPERSION)); /* opaque */
    s->surface.may_transmit = true;
    assert_true(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_DISPERSION));
    assert_int_equal(row->why.begin, 1);
    assert_string_equal(row->reason, "an interior with dispersion 1.1, seen in 7 bands");
    s->interior.dispersion = DISPERSION_CAUCHY;
    assert_true(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_DISPERSION));
    assert_non_null(strstr(row->reason, "cauchy"));
    s->interior.dispersion = DISPERSION_SELLMEIER;
    s->interior.dispersion_samples = 20;
    assert_true(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_DISPERSION));
    assert_string_equal(row->reason, "an interior with sellmeier in pms{}, seen in 20 bands");
    assert_false(has(s, (PlanOptions){.quality = 5}, FEATURE_DISPERSION));
}

static void an_empty_scene_needs_nothing(void **state)
{
    Small *s = *state;
    s->scene.surface_count = 0;
    s->scene.light_count = 0;
    s->scene.settings.photons.is_on = true;
    has(s, (PlanOptions){.quality = 9, .has_indirect = true}, FEATURE_SKY);
    for (int i = 0; i < FEATURE_COUNT; i++)
        assert_false(plan_has(&s->plan, (FeatureId)i));
}

static void caustics_want_photons_a_light_and_a_target(void **state)
{
    Small *s = *state;
    make_glass(s);
    assert_false(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_CAUSTIC_MAP));
    assert_non_null(strstr(s->plan.rows[FEATURE_CAUSTIC_MAP].reason, "filtered shadows"));
    s->scene.settings.photons.is_on = true;
    s->scene.settings.photons.count = 12345;
    s->scene.settings.photons.span = span_at(s, 3);
    assert_true(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_CAUSTIC_MAP));
    assert_true(s->plan.light_makes_caustics[0]);
    assert_int_equal(s->plan.caustic_photons, 12345);
    assert_int_equal(s->plan.rows[FEATURE_CAUSTIC_MAP].why.begin, 3);

    assert_false(has(s, (PlanOptions){.quality = 9, .effects[FEATURE_CAUSTIC_MAP] = TRI_OFF},
                     FEATURE_CAUSTIC_MAP));
    assert_false(s->plan.light_makes_caustics[0]);
    assert_int_equal(s->plan.caustic_photons, 0);
    s->light.is_shadowless = true;
    assert_false(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_CAUSTIC_MAP));
    s->light.is_shadowless = false;
    s->light.color = RGB_BLACK;
    assert_false(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_CAUSTIC_MAP));
}

static void on_at_object_or_light_counts_and_off_at_either_wins(void **state)
{
    Small *s = *state;
    make_glass(s);
    s->scene.settings.photons.is_on = true;
    s->surface.photons.refraction = TRI_UNSET;
    assert_false(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_CAUSTIC_MAP));
    s->light.photon_refraction = TRI_ON;
    assert_true(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_CAUSTIC_MAP));
    s->surface.photons.refraction = TRI_OFF;
    assert_false(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_CAUSTIC_MAP));
    s->surface.photons.refraction = TRI_ON;
    s->light.photon_refraction = TRI_OFF;
    assert_false(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_CAUSTIC_MAP));
}

static void no_specular_surface_no_photon_pass(void **state)
{
    Small *s = *state;
    s->scene.settings.photons.is_on = true;
    s->surface.is_target = s->surface.photons.is_target = true;
    s->surface.photons.refraction = s->surface.photons.reflection = TRI_ON;
    assert_false(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_CAUSTIC_MAP));
    assert_non_null(strstr(s->plan.rows[FEATURE_CAUSTIC_MAP].reason, "no surface"));
}

static void indirect_light_replaces_ambient(void **state)
{
    Small *s = *state;
    PlanOptions options = {.quality = 9, .has_indirect = true};
    assert_true(has(s, options, FEATURE_GLOBAL_MAP));
    assert_false(s->plan.has_ambient);
    assert_true(s->plan.global_photons > 0);
    s->scene.settings.pms = (PmsSettings){.has_indirect = true, .global_count = 777};
    assert_true(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_GLOBAL_MAP));
    assert_int_equal(s->plan.global_photons, 777);
    options.quality = 8;
    assert_false(has(s, options, FEATURE_GLOBAL_MAP));
    assert_true(s->plan.has_ambient);
}

static const PlanOptions paths = {.integrator = INTEGRATOR_PATH, .quality = 9};

static void paths_take_the_place_of_maps(void **state)
{
    Small *s = *state;
    make_glass(s);
    s->scene.settings.photons.is_on = true;
    s->scene.settings.pms.has_indirect = true;
    assert_true(has(s, paths, FEATURE_PATHS));
    for (int i = 0; i < 2; i++) {
        const PlanRow *row = &s->plan.rows[i ? FEATURE_GLOBAL_MAP : FEATURE_CAUSTIC_MAP];
        assert_false(row->is_on);
        assert_string_equal(row->reason, "path tracing finds that light itself");
    }
    assert_false(s->plan.has_ambient || s->plan.light_makes_caustics[0]);
    assert_false(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_PATHS));
    assert_false(has(s, (PlanOptions){.integrator = INTEGRATOR_PATH, .quality = 8}, FEATURE_PATHS));
    assert_true(s->plan.has_ambient);
}

static void paths_want_lights_of_a_size(void **state)
{
    Small *s = *state;
    PlanOptions wide = paths;
    wide.light_radius = 0.5;
    assert_false(has(s, paths, FEATURE_PATH_CAUSTICS));
    assert_int_equal(s->plan.unmet_lights, 0);
    s->surface.may_reflect = true;
    assert_false(has(s, paths, FEATURE_PATH_CAUSTICS));
    assert_int_equal(s->plan.unmet_lights, 1);
    assert_int_equal(s->plan.rows[FEATURE_PATH_CAUSTICS].why.begin, 2);
    assert_true(has(s, wide, FEATURE_PATH_CAUSTICS));
    assert_int_equal(s->plan.unmet_lights, 0);
    s->light.area = (AreaLight){.size1 = 2, .size2 = 2};
    assert_true(has(s, paths, FEATURE_PATH_CAUSTICS));
    s->light.is_parallel = true;
    assert_false(has(s, paths, FEATURE_PATH_CAUSTICS));
    s->light.is_parallel = false;
    s->light.area.size2 = 1;
    assert_false(has(s, paths, FEATURE_PATH_CAUSTICS));
    s->light.is_shadowless = true;
    assert_false(has(s, wide, FEATURE_PATH_CAUSTICS));
    assert_int_equal(s->plan.unmet_lights, 0);
}

static void paths_leave_filters_to_shadow_rays(void **state)
{
    Small *s = *state;
    s->surface.may_transmit = true;
    assert_false(has(s, paths, FEATURE_TRANSPARENT_SHADOWS));
    assert_false(plan_filters_shadow(&s->plan, &s->surface));
    s->surface.is_filter = true;
    assert_true(has(s, paths, FEATURE_TRANSPARENT_SHADOWS));
    assert_true(plan_filters_shadow(&s->plan, &s->surface));
    assert_false(has(s, paths, FEATURE_PATH_CAUSTICS));
    s->surface.is_filter = false;
    assert_true(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_TRANSPARENT_SHADOWS));
    assert_true(plan_filters_shadow(&s->plan, &s->surface));
}

static void transparent_shadows_want_a_transparent_blocker(void **state)
{
    Small *s = *state;
    s->surface.may_transmit = true;
    assert_true(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_TRANSPARENT_SHADOWS));
    assert_true(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_REFRACTION));
    assert_int_equal(s->plan.rows[FEATURE_TRANSPARENT_SHADOWS].why.begin, 1);
    s->surface.no_shadow = true;
    assert_false(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_TRANSPARENT_SHADOWS));
    assert_false(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_SHADOWS));
}

static void quality_switches_effects_off(void **state)
{
    Small *s = *state;
    s->surface.may_transmit = s->surface.may_reflect = true;
    s->light.area = (AreaLight){.size1 = 3, .size2 = 3};
    s->finish.phong = 1;
    const struct {
        FeatureId feature;
        int from;
    } wanted[] = {{FEATURE_LIGHTS, 2},      {FEATURE_HIGHLIGHTS, 2},
                  {FEATURE_SHADOWS, 4},     {FEATURE_TRANSPARENT_SHADOWS, 4},
                  {FEATURE_AREA_LIGHTS, 5}, {FEATURE_REFRACTION, 6},
                  {FEATURE_REFLECTION, 8}};
    for (int quality = 0; quality <= 9; quality++)
        for (size_t i = 0; i < sizeof wanted / sizeof *wanted; i++)
            assert_int_equal(has(s, (PlanOptions){.quality = quality}, wanted[i].feature),
                             quality >= wanted[i].from);
    has(s, (PlanOptions){.quality = 1}, FEATURE_LIGHTS);
    assert_true(s->plan.is_unlit);
}

/* Options with one effect forced. */
static PlanOptions forcing(int quality, FeatureId feature, Tri wanted)
{
    PlanOptions options = {.quality = quality};
    options.effects[feature] = wanted;
    return options;
}

static void the_command_line_forces_effects(void **state)
{
    Small *s = *state;
    s->surface.may_transmit = s->surface.may_reflect = true;
    s->finish.phong = 1;
    s->finish.emission = rgb(1, 0, 0);
    const PlanRow *rows = s->plan.rows;
    for (int i = 0; i < FEATURE_COUNT; i++) {
        assert_false(has(s, forcing(9, (FeatureId)i, TRI_OFF), (FeatureId)i));
        assert_string_equal(rows[i].reason, i == FEATURE_PATHS || i == FEATURE_PROGRESSIVE
                                                ? rows[i].reason
                                                : "switched off on the command line");
        assert_true(plan_forbids(&s->plan, (FeatureId)i));
    }
    assert_true(has(s, forcing(0, FEATURE_REFLECTION, TRI_ON), FEATURE_REFLECTION));
    assert_non_null(strstr(rows[FEATURE_REFLECTION].reason, "asked for on the command line: "));
    assert_true(has(s, forcing(9, FEATURE_PATHS, TRI_ON), FEATURE_PATHS));
    assert_true(has(s, forcing(9, FEATURE_GLOW, TRI_ON), FEATURE_GLOW));
    assert_true(plan_has(&s->plan, FEATURE_GLOBAL_MAP) && plan_has(&s->plan, FEATURE_FINAL_GATHER));
    assert_true(has(s, forcing(9, FEATURE_IRRADIANCE_CACHE, TRI_ON), FEATURE_IRRADIANCE_CACHE));
    PlanOptions options = forcing(9, FEATURE_FINAL_GATHER, TRI_OFF);
    options.has_indirect = true;
    assert_false(has(s, options, FEATURE_IRRADIANCE_CACHE));
    assert_true(plan_has(&s->plan, FEATURE_GLOBAL_MAP));
}

static void an_effect_that_nothing_makes_cannot_be_forced(void **state)
{
    Small *s = *state;
    Diag *diag = quiet();
    assert_false(has(s, forcing(9, FEATURE_FOG, TRI_ON), FEATURE_FOG));
    assert_int_equal(plan_check(&s->plan, diag), ERR_USAGE);
    assert_non_null(strstr(last_message, "fog=on is not possible here: no fog"));
    assert_true(has(s, forcing(9, FEATURE_LIGHTS, TRI_ON), FEATURE_LIGHTS));
    assert_int_equal(plan_check(&s->plan, diag), OK);
}

static void effects_have_names(void **state)
{
    (void)state;
    for (int i = 0; i < FEATURE_COUNT; i++) {
        const char *name = feature_name((FeatureId)i);
        assert_int_equal(feature_find(name, strlen(name)), i);
    }
    assert_int_equal(feature_find("gi=on", 2), FEATURE_GLOBAL_MAP);
    assert_int_equal(feature_find("indirect", 8), FEATURE_GLOBAL_MAP);
    assert_int_equal(feature_find("caustics", 8), FEATURE_CAUSTIC_MAP);
    assert_int_equal(feature_find("caustic", 7), FEATURE_COUNT);
    assert_int_equal(feature_find("", 0), FEATURE_COUNT);
}

static void highlights_want_a_light_that_makes_them(void **state)
{
    Small *s = *state;
    s->finish.specular = 0.5f;
    assert_true(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_HIGHLIGHTS));
    s->light.is_shadowless = true;
    assert_false(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_HIGHLIGHTS));
}

static void camera_sky_and_interior_have_their_rows(void **state)
{
    Small *s = *state;
    s->scene.camera = (Camera){.aperture = 1, .blur_samples = 0};
    assert_false(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_FOCAL_BLUR));
    s->scene.camera.blur_samples = 10;
    assert_true(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_FOCAL_BLUR));
    s->scene.sky.pigment_count = 1;
    assert_true(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_SKY));
    s->interior.fade_distance = 1;
    assert_false(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_ABSORPTION));
    s->surface.may_transmit = true;
    assert_true(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_ABSORPTION));
}

static void media_fog_and_rainbows_have_their_rows(void **state)
{
    Small *s = *state;
    Medium medium = MEDIUM_DEFAULT;
    const Medium *media[1] = {&medium};
    medium.span = span_at(s, 5);
    s->interior.media = media;
    s->interior.media_count = 1;
    s->interior.is_hollow = true;
    assert_false(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_MEDIA)); /* it does nothing */
    medium.absorption = rgb(0, 0, 1);
    assert_true(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_MEDIA));
    assert_int_equal(s->plan.rows[FEATURE_MEDIA].why.begin, 5);
    assert_false(has(s, (PlanOptions){.quality = 8}, FEATURE_MEDIA));
    s->interior.is_hollow = false;
    assert_false(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_MEDIA));
    s->scene.atmosphere.media = media;
    s->scene.atmosphere.media_count = 1;
    assert_true(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_MEDIA));

    Fog fog = {.distance = 0, .span = span_at(s, 6)};
    const Fog *fogs[1] = {&fog};
    s->scene.atmosphere.fogs = fogs;
    s->scene.atmosphere.fog_count = 1;
    assert_false(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_FOG));
    fog.distance = 10;
    assert_true(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_FOG));
    assert_int_equal(s->plan.rows[FEATURE_FOG].why.begin, 6);

    const MapEntry colors[1] = {{0, {1, 1, 1, 0, 0}}};
    Rainbow bow = {.span = span_at(s, 7)};
    const Rainbow *bows[1] = {&bow};
    s->scene.atmosphere.rainbows = bows;
    s->scene.atmosphere.rainbow_count = 1;
    assert_false(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_RAINBOW));
    bow.map = colors;
    bow.map_count = 1;
    assert_true(has(s, PLAN_OPTIONS_DEFAULT, FEATURE_RAINBOW));
    assert_false(has(s, (PlanOptions){.quality = 8}, FEATURE_RAINBOW));
}

#define PLAN_TEST(f) cmocka_unit_test_setup_teardown(f, set_up, tear_down)

int main(void)
{
    const struct CMUnitTest tests[] = {
        PLAN_TEST(every_row_has_a_reason),
        PLAN_TEST(a_plain_scene_needs_light_and_shadows_only),
        PLAN_TEST(dispersion_wants_a_transparent_interior_that_has_it),
        PLAN_TEST(an_empty_scene_needs_nothing),
        PLAN_TEST(caustics_want_photons_a_light_and_a_target),
        PLAN_TEST(on_at_object_or_light_counts_and_off_at_either_wins),
        PLAN_TEST(no_specular_surface_no_photon_pass),
        PLAN_TEST(indirect_light_replaces_ambient),
        PLAN_TEST(paths_take_the_place_of_maps),
        PLAN_TEST(paths_want_lights_of_a_size),
        PLAN_TEST(paths_leave_filters_to_shadow_rays),
        PLAN_TEST(transparent_shadows_want_a_transparent_blocker),
        PLAN_TEST(quality_switches_effects_off),
        PLAN_TEST(the_command_line_forces_effects),
        PLAN_TEST(an_effect_that_nothing_makes_cannot_be_forced),
        PLAN_TEST(effects_have_names),
        PLAN_TEST(highlights_want_a_light_that_makes_them),
        PLAN_TEST(camera_sky_and_interior_have_their_rows),
        PLAN_TEST(media_fog_and_rainbows_have_their_rows),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
