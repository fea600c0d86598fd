/* Studies: fits, the front, advice, the grid of settings, the file of runs, errors free of the
 * reference's noise.  SPDX-License-Identifier: Apache-2.0 */
#include "base/rng.h"
#include "study/analysis.h"
#include "study/reference.h"
#include "study/schedule.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "folder.h"
#include "quiet.h"

#include "sdl/sdl.h"

static void near(double found, double wanted, double tolerance)
{
    if (!(fabs(found - wanted) <= tolerance))
        fail_msg("got %g, wanted %g", found, wanted);
}

/* --- fits and fronts ------------------------------------------------------------------------ */

static void a_power_law_is_found(void **state)
{
    (void)state;
    double seconds[6], errors[6];
    for (int i = 0; i < 6; i++) {
        seconds[i] = 0.1 * pow(3, i);
        errors[i] = 0.2 * pow(seconds[i], -0.4);
    }
    StudyFit fit = study_fit(seconds, errors, 6);
    assert_int_equal(fit.count, 6);
    near(fit.slope, -0.4, 1e-12);
    near(fit.base, log(0.2), 1e-12);
    errors[2] = NAN; /* too small to tell: left out */
    seconds[4] = 0;
    fit = study_fit(seconds, errors, 6);
    assert_int_equal(fit.count, 4);
    near(fit.slope, -0.4, 1e-12);
    assert_true(fit.lo == seconds[0] && fit.hi == seconds[5]);
}

static void no_slope_without_seconds_apart(void **state)
{
    (void)state;
    const double seconds[] = {1, 1.1, 1.2}, errors[] = {1, 2, 3};
    assert_int_equal(study_fit(seconds, errors, 3).count, 0);
    assert_int_equal(study_fit(seconds, errors, 1).count, 0);
    assert_int_equal(study_fit(seconds, errors, 0).count, 0);
}

/* Against all pairs, on random points with many equal ones. */
static void the_front_is_what_nothing_beats(void **state)
{
    (void)state;
    enum { COUNT = 40 };
    double seconds[COUNT], errors[COUNT];
    bool is_front[COUNT];
    for (uint64_t round = 0; round < 200; round++) {
        Rng rng = rng_at(1, 0, round);
        for (int i = 0; i < COUNT; i++) {
            seconds[i] = 1 + floor(8 * rng_double(&rng));
            errors[i] = rng_double(&rng) < 0.1 ? NAN : 1 + floor(8 * rng_double(&rng));
        }
        int found = study_front(seconds, errors, COUNT, is_front), counted = 0;
        for (int i = 0; i < COUNT; i++) {
            bool is_beaten = isnan(errors[i]), has_twin = false;
            for (int j = 0; j < COUNT; j++) {
                bool is_same = seconds[j] == seconds[i] && errors[j] == errors[i];
                has_twin |= is_same && j < i;
                is_beaten |= !is_same && seconds[j] <= seconds[i] && errors[j] <= errors[i];
            }
            assert_int_equal(is_front[i], !is_beaten && !has_twin);
            counted += is_front[i];
        }
        assert_int_equal(found, counted);
    }
}

/* --- a scene -------------------------------------------------------------------------------- */

typedef struct Setup {
    Scene *scene;
    RenderOptions options;
    Plan plan;
    StudyBase base;
    StudyPoint *points;
    int count;
} Setup;

static const char glass[] =
    "#version 3.7;\n"
    "global_settings { assumed_gamma 1 photons { count 1000 gather 20, 90 } }\n"
    "camera { location <0,3,-6> look_at 0 }\nlight_source { <-4,7,3>, 1 }\n"
    "plane { y, 0 pigment { rgb 1 } }\n"
    "sphere { <0,1,0>, 1 pigment { rgbt 1 } interior { ior 1.5 }\n"
    "  photons { target refraction on } }\n";

static const char indirect[] =
    "#version 3.7;\n"
    "global_settings { assumed_gamma 1 pms { gi on global_photons 5000 } }\n"
    "camera { location <0,3,-6> look_at 0 aperture 0.1 focal_point 0 blur_samples 8 }\n"
    "light_source { <-4,7,3>, 1 }\nmedia { scattering { 1, 0.01 } }\n"
    "plane { y, 0 hollow pigment { rgb 1 } }\n";

static void set_up(Setup *s, const char *text, int samples)
{
    SdlOptions sdl = {.threads = 1};
    assert_int_equal(sdl_load_text(quiet(), "s.pms", text, strlen(text), &sdl, &s->scene), OK);
    s->options = RENDER_OPTIONS_DEFAULT;
    s->options.aa = samples > 1 ? AA_UNIFORM : AA_NONE;
    s->options.samples = samples;
    assert_int_equal(plan_make(s->scene, &s->options.plan, s->scene->arena, &s->plan), OK);
    s->base = (StudyBase){.scene = s->scene, .options = &s->options, .plan = &s->plan, .radius = 2};
    assert_int_equal(setting_grid(&s->base, s->scene->arena, &s->points, &s->count), OK);
}

static const StudyPoint *find_point(const Setup *s, SettingId setting, double value, bool is_fine)
{
    for (int i = 0; i < s->count; i++)
        if (s->points[i].setting == (int)setting && s->points[i].is_fine == is_fine &&
            fabs(s->points[i].value - value) < 1e-6)
            return &s->points[i];
    return NULL;
}

static bool is_tried(const Setup *s, SettingId setting)
{
    for (int i = 0; i < s->count; i++)
        if (s->points[i].setting == (int)setting)
            return true;
    return false;
}

static void only_what_matters_is_tried(void **state)
{
    (void)state;
    Setup s;
    set_up(&s, glass, 1);
    assert_int_equal(s.points[0].setting, SETTING_OWN);
    static const SettingId some[] = {SETTING_SAMPLES, SETTING_PHOTONS,   SETTING_GATHER,
                                     SETTING_RADIUS,  SETTING_KERNEL,    SETTING_SHAPE,
                                     SETTING_LEVEL,   SETTING_PRECISION, SETTING_PASSES};
    static const SettingId none[] = {SETTING_SPACING, SETTING_GLOBAL, SETTING_RAYS, SETTING_CACHE,
                                     SETTING_MEDIA,   SETTING_BLUR,   SETTING_PATHS};
    for (size_t i = 0; i < sizeof some / sizeof *some; i++)
        assert_true(is_tried(&s, some[i]));
    for (size_t i = 0; i < sizeof none / sizeof *none; i++)
        assert_false(is_tried(&s, none[i]));
    scene_free(s.scene);
    set_up(&s, indirect, 16);
    static const SettingId others[] = {SETTING_GLOBAL, SETTING_RAYS, SETTING_CACHE,
                                       SETTING_METHOD, SETTING_BLUR, SETTING_MEDIA};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        assert_true(is_tried(&s, others[i]));
    assert_false(is_tried(&s, SETTING_PHOTONS));
    for (int i = 0; i < s.count; i++) /* 16 samples are enough */
        assert_false(s.points[i].is_fine);
    scene_free(s.scene);
}

/* Paths are the truth only where photons bring all of the light. */
static void paths_are_true_without_glass(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        bool is_true;
    } cases[] = {
        {glass, false},
        {indirect, false}, /* media */
        {"#version 3.7;\nglobal_settings { pms { gi on } }\nlight_source { 0, 1 }\n"
         "plane { y, -1 pigment { rgb 1 } }\n",
         true},
        {"#version 3.7;\nlight_source { 0, 1 }\nplane { y, -1 pigment { rgb 1 } }\n", false},
        {"#version 3.7;\nglobal_settings { pms { gi on } }\nlight_source { 0, 1 }\n"
         "plane { y, -1 pigment { rgb 1 } finish { reflection 0.1 } }\n",
         false}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        Setup s;
        set_up(&s, cases[i].text, 1);
        bool found = reference_can_be_path(s.scene, &s.options, &s.plan);
        assert_int_equal(found, cases[i].is_true);
        scene_free(s.scene);
    }
}

static void points_set_what_they_say(void **state)
{
    (void)state;
    Setup s;
    set_up(&s, glass, 1);
    const StudyPoint *point = find_point(&s, SETTING_PHOTONS, 4000, false);
    assert_non_null(point);
    assert_int_equal(point->scene.settings.photons.count, 4000);
    assert_int_equal(s.scene->settings.photons.count, 1000); /* the scene is as it was */
    assert_string_equal(point->how, "global_settings { photons { count 4000 } }");
    near(point->photon_cost, 4, 1e-12);
    point = find_point(&s, SETTING_PHOTONS, 4000, true);
    assert_int_equal(point->options.samples, FINE_SAMPLES);
    assert_string_equal(point->how, "--aa 16 and global_settings { photons { count 4000 } }");
    point = find_point(&s, SETTING_GATHER, 400, false);
    assert_string_equal(point->how, "global_settings { photons { gather 89, 400 } }");
    assert_null(find_point(&s, SETTING_GATHER, 90, false));
    point = find_point(&s, SETTING_RADIUS, 1, false);
    near(point->scene.settings.photons.radius, 1, 0);
    point = find_point(&s, SETTING_BALANCED, 32, false);
    assert_int_equal(point->options.samples, 32);
    assert_int_equal(point->scene.settings.photons.count, 16000);
    assert_int_equal(point->scene.settings.photons.gather_max, 571);
    point = find_point(&s, SETTING_PRECISION, 1, false);
    assert_true(point->options.has_full_photons);
    scene_free(s.scene);
}

static void media_are_copied_to_be_changed(void **state)
{
    (void)state;
    Setup s;
    set_up(&s, indirect, 1);
    double own = setting_own(SETTING_MEDIA, &s.base);
    const StudyPoint *point = find_point(&s, SETTING_MEDIA, 16 * own, false);
    assert_non_null(point);
    near((double)point->scene.atmosphere.media[0]->variance, 16 * own, 1e-9);
    near((double)s.scene->atmosphere.media[0]->variance, own, 1e-12);
    scene_free(s.scene);
}

/* --- runs ----------------------------------------------------------------------------------- */

static RunKey kept_key[8];
static StudyRun kept_run[8];
static int kept_count;

static void keep_one(void *ctx, const RunKey *key, const StudyRun *run)
{
    (void)ctx;
    kept_key[kept_count] = *key;
    kept_run[kept_count++] = *run;
}

static void read_back(const char *path)
{
    Arena *arena = arena_new();
    kept_count = 0;
    assert_int_equal(record_read(quiet(), path, arena, keep_one, NULL), OK);
    arena_free(arena);
}

static void runs_come_back(void **state)
{
    (void)state;
    const char *path = in_folder("runs.csv");
    RunKey keys[] = {{SETTING_OWN, 0, false, 0}, {SETTING_CACHE, 1.0 / 3, true, 2}};
    StudyRun run = {.is_done = true,
                    .seconds = 0.1,
                    .error = {-1e-9, 0.25, 0.5, 0.125},
                    .estimate = NAN,
                    .bound = 0.75,
                    .radius = 1e-30};
    run.phase[PHASE_EYE] = 0.0625;
    read_back(path);
    assert_int_equal(kept_count, 0);
    for (int i = 0; i < 2; i++)
        assert_int_equal(record_append(quiet(), path, &keys[i], &run), OK);
    read_back(path);
    assert_int_equal(kept_count, 2);
    assert_int_equal(kept_key[0].setting, SETTING_OWN);
    assert_int_equal(kept_key[1].setting, SETTING_CACHE);
    assert_true(kept_key[1].value == 1.0 / 3 && kept_key[1].is_fine && kept_key[1].seed == 2);
    assert_true(kept_run[1].is_done && kept_run[1].seconds == 0.1);
    assert_memory_equal(&kept_run[1].error, &run.error, sizeof run.error);
    assert_memory_equal(kept_run[1].phase, run.phase, sizeof run.phase);
    assert_true(isnan(kept_run[1].estimate) && kept_run[1].bound == 0.75);
    assert_true(kept_run[1].radius == 1e-30);
}

/* Cut anywhere, only whole lines count. */
static void lines_cut_short_are_skipped(void **state)
{
    (void)state;
    const char *path = in_folder("cut.csv");
    RunKey key = {SETTING_OWN, 0, false, 1};
    StudyRun run = {.is_done = true, .seconds = 1};
    char *bytes;
    for (int i = 0; i < 2; i++)
        assert_int_equal(record_append(quiet(), path, &key, &run), OK);
    size_t size = slurp(path, &bytes);
    size_t heading = strcspn(bytes, "\n") + 1, line = (size - heading) / 2;
    for (size_t length = 0; length <= size; length++) {
        spill(path, bytes, length);
        read_back(path);
        assert_int_equal(kept_count, length < heading + line ? 0 : length < size ? 1 : 2);
    }
    free(bytes);
}

/* Put `field` in place of the n-th of the last line. */
static void spoil(const char *path, const char *bytes, int n, const char *field)
{
    char text[4096];
    const char *at = bytes + strcspn(bytes, "\n") + 1;
    for (int i = 0; i < n; i++)
        at += strcspn(at, ",") + 1;
    snprintf(text, sizeof text, "%.*s%s%s", (int)(at - bytes), bytes, field,
             at + strcspn(at, ",\n"));
    spill(path, text, strlen(text));
}

/* Return whether a run is read from the line whose n-th field is `field`. */
static bool is_read_with(const char *bytes, int n, const char *field)
{
    const char *path = in_folder("spoiled.csv");
    spoil(path, bytes, n, field);
    read_back(path);
    return kept_count == 1;
}

/* Numbers that no run has are of no run; what was no number when it was measured is. */
static void runs_that_make_no_sense_are_skipped(void **state)
{
    (void)state;
    enum { VALUE = 1, FINE, SEED, SECONDS, PHASE, MSE = SECONDS + 1 + PHASE_COUNT, RELMSE };
    enum { PERCENTILE = RELMSE + 1, FLIP, ESTIMATE, BOUND, RADIUS };
    const char *path = in_folder("sense.csv");
    RunKey key = {SETTING_PHOTONS, 4000, false, 1};
    StudyRun run = {.is_done = true, .seconds = 1};
    static const char *const garbage[] = {"inf", "-inf", "nan",  "1e999", "word", "1x",
                                          " 1",  "0x1p", "-0.5", "1,1",   "-"};
    static const int never_empty[] = {VALUE, FINE, SEED, SECONDS, PHASE};
    static const int not_negative[] = {SECONDS, PHASE, PERCENTILE, FLIP, ESTIMATE, BOUND, RADIUS};
    char *bytes;
    assert_int_equal(record_append(quiet(), path, &key, &run), OK);
    slurp(path, &bytes);
    for (int n = VALUE; n <= RADIUS; n++) {
        assert_true(is_read_with(bytes, n, n == FINE ? "1" : "2"));
        for (size_t i = 0; i < sizeof garbage / sizeof *garbage; i++)
            if (strcmp(garbage[i], "-0.5") != 0 && is_read_with(bytes, n, garbage[i]))
                fail_msg("field %d was '%s' and read", n, garbage[i]);
    }
    for (size_t i = 0; i < sizeof never_empty / sizeof *never_empty; i++)
        assert_false(is_read_with(bytes, never_empty[i], ""));
    for (size_t i = 0; i < sizeof not_negative / sizeof *not_negative; i++)
        assert_false(is_read_with(bytes, not_negative[i], "-0.5"));
    assert_true(is_read_with(bytes, MSE, "-0.5") && is_read_with(bytes, RELMSE, "-0.5"));
    for (int n = MSE; n <= RADIUS; n++)
        assert_true(is_read_with(bytes, n, ""));
    static const char *const seeds[] = {"-1", "0.5", "1e30", "1001"};
    for (size_t i = 0; i < sizeof seeds / sizeof *seeds; i++)
        assert_false(is_read_with(bytes, SEED, seeds[i]));
    assert_false(is_read_with(bytes, FINE, "2"));
    free(bytes);
}

/* --- analysis ------------------------------------------------------------------------------- */

typedef struct Runs {
    Setup setup;
    StudyRun *runs;
    StudyAnalysis analysis;
} Runs;

static void put_run(Runs *r, const StudyPoint *point, int seed, double seconds, double error)
{
    StudyRun *run = &r->runs[STUDY_SEEDS * (point - r->setup.points) + seed];
    *run = (StudyRun){.is_done = true,
                      .seconds = seconds,
                      .error = {error * error, error * error, error, error},
                      .estimate = error,
                      .bound = 1.2 * error};
}

static void begin(Runs *r)
{
    set_up(&r->setup, glass, 1);
    r->runs = calloc((size_t)(STUDY_SEEDS * r->setup.count), sizeof *r->runs);
    put_run(r, &r->setup.points[0], 0, 1, 0.2);
}

static void analyse(Runs *r, double noise)
{
    assert_int_equal(study_analyse(&r->setup.base, r->setup.points, r->setup.count, r->runs, noise,
                                   r->setup.scene->arena, &r->analysis),
                     OK);
}

static void end(Runs *r)
{
    free(r->runs);
    scene_free(r->setup.scene);
}

static const StudyTrend *trend_of(const Runs *r, SettingId setting)
{
    for (int i = 0; i < r->analysis.trend_count; i++)
        if (r->analysis.trends[i].setting == (int)setting)
            return &r->analysis.trends[i];
    return NULL;
}

static void means_and_noise(void **state)
{
    (void)state;
    Runs r;
    begin(&r);
    const StudyPoint *point = find_point(&r.setup, SETTING_SAMPLES, 4, false);
    put_run(&r, point, 0, 2, 0.05);
    put_run(&r, point, 1, 4, 0.05);
    put_run(&r, find_point(&r.setup, SETTING_SAMPLES, 16, false), 0, 9, 0.031);
    analyse(&r, 0.03);
    const StudyRow *row = &r.analysis.rows[1];
    assert_int_equal(r.analysis.row_count, 3);
    assert_true(row->point == point && row->seeds == 2);
    near(row->seconds, 2, 1e-12);  /* the faster one */
    near(row->error, 0.04, 1e-12); /* 0.05^2 = 0.04^2 + 0.03^2 */
    near(row->spread, 0, 1e-7);
    assert_true(isnan(r.analysis.rows[0].spread));
    assert_true(isnan(r.analysis.rows[2].error)); /* nothing but the reference's noise */
    end(&r);
}

static void trends_and_advice(void **state)
{
    (void)state;
    Runs r;
    begin(&r);
    for (int i = 0; i < 3; i++) { /* error = 0.2 seconds^-1/2 */
        double seconds = pow(4, i + 1);
        const StudyPoint *point = find_point(&r.setup, SETTING_PASSES, seconds / 2, false);
        put_run(&r, point, 0, seconds, 0.2 / sqrt(seconds));
    }
    put_run(&r, find_point(&r.setup, SETTING_PHOTONS, 4000, false), 0, 3, 0.1999);
    analyse(&r, NAN);
    const StudyTrend *passes = trend_of(&r, SETTING_PASSES);
    near(passes->fit.slope, -0.5, 1e-12);
    near(passes->halving, 4, 1e-9);
    near(passes->best, 0.025, 1e-12);
    assert_true(isinf(trend_of(&r, SETTING_PHOTONS)->halving));
    const StudyAdvice *advice = r.analysis.advice;
    assert_int_equal(advice[0].kind, ADVICE_MEASURED); /* 5 %: the front has exactly that */
    near(advice[0].seconds, 16, 1e-12);
    assert_string_equal(
        advice[0].how,
        "--progressive --passes 8 and global_settings { max_trace_level 10 adc_bailout 0.00098 }");
    assert_int_equal(advice[1].kind, ADVICE_EXTRAPOLATED);
    near(advice[1].seconds, 400, 1e-6);
    assert_string_equal(advice[1].how, "--progressive --passes 200 and global_settings { "
                                       "max_trace_level 10 adc_bailout 0.00098 }");
    near(advice[2].seconds, 10000, 1e-3);
    assert_int_equal(r.analysis.front_count, 4);
    end(&r);
}

static void fine_trends_tell_more(void **state)
{
    (void)state;
    Runs r;
    begin(&r);
    put_run(&r, find_point(&r.setup, SETTING_PHOTONS, 4000, false), 0, 3, 0.2);
    put_run(&r, find_point(&r.setup, SETTING_PHOTONS, 4000, true), 0, 20, 0.01);
    analyse(&r, NAN);
    assert_false(trend_of(&r, SETTING_PHOTONS)->is_fine); /* nothing to compare it with yet */
    put_run(&r, find_point(&r.setup, SETTING_SAMPLES, FINE_SAMPLES, false), 0, 10, 0.02);
    analyse(&r, NAN);
    const StudyTrend *trend = trend_of(&r, SETTING_PHOTONS);
    assert_true(trend->is_fine && trend->count == 2);
    near(trend->part, 0.5, 1e-12);
    near(trend->fit.slope, -1, 1e-12);
    near(study_trend_value(&r.analysis, trend, 0), 1000, 0);
    end(&r);
}

/* More photons an estimate are worse; more samples are not, though the scene as it stands took
 * longer when the machine was busy. */
static void a_busy_machine_makes_nothing_worse(void **state)
{
    (void)state;
    Runs r;
    begin(&r);
    put_run(&r, find_point(&r.setup, SETTING_GATHER, 400, false), 0, 2, 0.4);
    put_run(&r, find_point(&r.setup, SETTING_SAMPLES, 4, false), 0, 0.5, 0.1);
    analyse(&r, NAN);
    assert_true(trend_of(&r, SETTING_GATHER)->is_worse);
    assert_true(trend_of(&r, SETTING_SAMPLES)->fit.slope > 0);
    assert_false(trend_of(&r, SETTING_SAMPLES)->is_worse);
    end(&r);
}

static void no_runs_no_claims(void **state)
{
    (void)state;
    Runs r;
    begin(&r);
    analyse(&r, NAN);
    assert_int_equal(r.analysis.row_count, 1);
    assert_int_equal(r.analysis.trend_count, 0);
    for (int i = 0; i < STUDY_TARGETS; i++)
        assert_int_equal(r.analysis.advice[i].kind, ADVICE_NONE);
    r.runs[0].is_done = false;
    analyse(&r, NAN);
    assert_int_equal(r.analysis.row_count, 0);
    end(&r);
}

/* --- order ---------------------------------------------------------------------------------- */

/* Return a study of these runs, none of which is left out; it lives as long as the scene. */
static Study study_of(const Runs *r)
{
    Arena *arena = r->setup.scene->arena;
    size_t count = (size_t)r->setup.count, runs = STUDY_SEEDS * count;
    Study study = {.points = r->setup.points,
                   .count = r->setup.count,
                   .runs = r->runs,
                   .is_left = ARENA_ARRAY(arena, bool, runs),
                   .refusals = ARENA_ARRAY(arena, const char *, count)};
    assert_non_null(study.is_left);
    assert_non_null(study.refusals);
    return study;
}

/* One value of each setting comes before the second of any, and all comes at last. */
static void every_setting_has_its_turn(void **state)
{
    (void)state;
    Runs r;
    begin(&r);
    r.runs[0].phase[PHASE_EYE] = 1;
    bool is_seen[SETTING_COUNT] = {false}, is_second = false;
    Study study = study_of(&r);
    int next, done = 1;
    while ((next = schedule_next(&study)) >= 0) {
        const StudyPoint *point = &r.setup.points[next / STUDY_SEEDS];
        assert_false(r.runs[next].is_done);
        r.runs[next].is_done = true;
        r.runs[next].seconds = schedule_cost(&study, next / STUDY_SEEDS);
        done++;
        if (point->setting == SETTING_OWN || is_seen[point->setting] || next % STUDY_SEEDS) {
            is_second = true;
            continue;
        }
        assert_false(is_second);
        is_seen[point->setting] = true;
    }
    assert_int_equal(done, STUDY_SEEDS * r.setup.count);
    end(&r);
}

/* What cannot be rendered never comes, and another value of its setting comes first instead. */
static void what_is_refused_has_no_turn(void **state)
{
    (void)state;
    Runs r;
    begin(&r);
    r.runs[0].phase[PHASE_EYE] = 1;
    Study study = study_of(&r);
    int refused = schedule_next(&study) / STUDY_SEEDS, next, done = 1;
    study.refusals[refused] = "not possible";
    int other = schedule_next(&study) / STUDY_SEEDS;
    assert_int_equal(r.setup.points[other].setting, r.setup.points[refused].setting);
    while ((next = schedule_next(&study)) >= 0) {
        assert_int_not_equal(next / STUDY_SEEDS, refused);
        r.runs[next].is_done = true;
        done++;
    }
    assert_int_equal(done, STUDY_SEEDS * (r.setup.count - 1));
    assert_int_equal(study_left_count(&study), 0);
    end(&r);
}

/* Errors are kept for the report, warnings go on. */
static void errors_are_taken_aside(void **state)
{
    (void)state;
    Aside aside;
    Diag *shown = quiet();
    aside_init(&aside, shown);
    assert_string_equal(aside_reason(&aside, ERR_MEMORY), status_text(ERR_MEMORY));
    diag_warn(&aside.diag, WARN_RENDER, SPAN_NONE, "dim");
    assert_string_equal(last_message, "pms: warning: dim\n");
    diag_fail(&aside.diag, ERR_USAGE, "no %s", "light");
    diag_fail(&aside.diag, ERR_USAGE, "no shade");
    assert_string_equal(last_message, "pms: warning: dim\n");
    assert_string_equal(aside_reason(&aside, ERR_USAGE), "no light; no shade");
    aside_clear(&aside);
    assert_string_equal(aside_reason(&aside, ERR_USAGE), status_text(ERR_USAGE));
    aside_done(&aside);
}

/* --- the reference -------------------------------------------------------------------------- */

static void fill(Image *image, int width, int height, float value, float noise, uint64_t key)
{
    image_init(image, width, height);
    ImageLayer *layer = image_add_layer(image, "", "RGB");
    Rng rng = rng_at(5, 0, key);
    for (int i = 0; i < 3 * width * height; i++)
        layer->pixels[i] = value + noise * (2 * rng_float(&rng) - 1);
}

/* The halves are noisy by 0.1 / sqrt(3) each, evenly distributed; a picture is 0.01 off.  The mean
 * of n products of such noise has a standard error of 0.0033 / sqrt(n). */
static void noise_of_the_reference_cancels(void **state)
{
    (void)state;
    enum { SIDE = 100 };
    Truth truth;
    TruthError error;
    Image image;
    double products = 3 * SIDE * SIDE, square = 0.01 / 3;
    assert_int_equal(truth_init(quiet(), SIDE, SIDE, true, &truth), OK);
    for (int i = 0; i < 2; i++) {
        fill(&image, SIDE, SIDE, 0.5f, 0.1f, (uint64_t)i);
        truth_colours(&image, truth.half[i]);
        image_done(&image);
    }
    assert_int_equal(truth_settle(quiet(), &truth), OK);
    near(truth.noise.square, square / 2, 4 * square / sqrt(products));
    fill(&image, SIDE, SIDE, 0.51f, 0, 0);
    assert_int_equal(truth_compare(quiet(), &truth, &image, &error), OK);
    near(error.square, 1e-4, 4 * (square + 2 * 0.01 * sqrt(square)) / sqrt(products));
    assert_true(error.percentile > 0.02 && truth.noise.percentile > 0.02);
    assert_true(truth.noise.flip > 0);
    image_done(&image);
    truth_done(&truth);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_power_law_is_found),
        cmocka_unit_test(no_slope_without_seconds_apart),
        cmocka_unit_test(the_front_is_what_nothing_beats),
        cmocka_unit_test(only_what_matters_is_tried),
        cmocka_unit_test(paths_are_true_without_glass),
        cmocka_unit_test(points_set_what_they_say),
        cmocka_unit_test(media_are_copied_to_be_changed),
        cmocka_unit_test(runs_come_back),
        cmocka_unit_test(lines_cut_short_are_skipped),
        cmocka_unit_test(runs_that_make_no_sense_are_skipped),
        cmocka_unit_test(means_and_noise),
        cmocka_unit_test(trends_and_advice),
        cmocka_unit_test(fine_trends_tell_more),
        cmocka_unit_test(a_busy_machine_makes_nothing_worse),
        cmocka_unit_test(no_runs_no_claims),
        cmocka_unit_test(every_setting_has_its_turn),
        cmocka_unit_test(what_is_refused_has_no_turn),
        cmocka_unit_test(errors_are_taken_aside),
        cmocka_unit_test(noise_of_the_reference_cancels),
    };
    return cmocka_run_group_tests_name("study", tests, make_folder, remove_folder);
}
