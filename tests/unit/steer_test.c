/* Where samples go, and how much of a pass fits into the time.  SPDX-License-Identifier: Apache-2.0
 */
#include "render/steer.h"

#include "render/pace.h"
#include "render/series.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

enum { SIDE = 64, PIXELS = SIDE * SIDE };

/* A grey picture after so many samples a pixel, with the same standard error everywhere but in the
 * upper quarter. */
typedef struct Made {
    Film film;
    SeriesState state;
    ErrorMap map;
    PixelSamples samples[PIXELS];
} Made;

static bool is_above(size_t pixel)
{
    return pixel < PIXELS / 4;
}

static void make(Made *made, float above, float below, float shared)
{
    RenderOptions options = RENDER_OPTIONS_DEFAULT;
    options.width = options.height = SIDE;
    *made = (Made){.film.width = 0};
    assert_int_equal(film_init(&made->film, &options, FILM_SAMPLES | FILM_CLUES, NULL), OK);
    made->film.samples = made->samples;
    assert_int_equal(series_state_init(&made->state, &made->film, 1, 4, NULL), OK);
    assert_int_equal(error_map_init(&made->map, &made->film, NULL), OK);
    for (size_t i = 0; i < PIXELS; i++) {
        made->state.halves[0].good[i] = made->state.halves[1].good[i] = 2;
        made->map.luminance[i] = made->map.value[i] = 1;
        made->map.smooth[i] = made->map.noise[i] = is_above(i) ? above : below;
        made->map.shared[i] = shared;
    }
}

static void unmake(Made *made)
{
    error_map_done(&made->map);
    series_state_done(&made->state);
    film_done(&made->film);
}

static void plan(Made *made, double error, double shared_work)
{
    SteeringGoal goal = {.error = error, .shared_work = shared_work, .passes_left = INFINITY};
    ErrorFigure figure = error_figure(&made->map);
    steering_plan(&made->state.steering, &made->map, made->state.halves, &figure, 4, &goal);
}

/* A quarter with twice the error needs four times the samples in all: of 8 a pixel on average, 4 of
 * which are there, 4 * 8/7 stay below and 16 * 8/7 come to be above. */
static void samples_make_errors_alike(void **state)
{
    (void)state;
    Made made;
    make(&made, 0.2f, 0.1f, 0);
    plan(&made, 0, 0);
    const float *rate = made.state.steering.rate;
    assert_int_equal(made.state.steering.until, 8);
    /* where the worst begin is known within 3 % */
    assert_true(fabs((double)rate[0] - (16 * 8.0 / 7 - 4) / 4) < 0.15);
    assert_true(fabs((double)rate[PIXELS - 1] - (4 * 8.0 / 7 - 4) / 4) < 0.05);
    assert_true(fabs(steering_samples(&made.state.steering) / PIXELS - 1) < 0.01);
    unmake(&made);
}

/* A tenth of the pixels that are worse by far do not take the samples of all others. */
static void the_worst_take_no_more_than_others(void **state)
{
    (void)state;
    Made made;
    make(&made, 0.1f, 0.1f, 0);
    for (size_t i = 0; i < PIXELS / 10; i++)
        made.map.smooth[i] = made.map.noise[i] = 2;
    plan(&made, 0, 0);
    const float *rate = made.state.steering.rate;
    assert_true(rate[0] >= rate[PIXELS - 1]);
    assert_true(fabs((double)(rate[0] / rate[PIXELS - 1]) - 1) < 0.1);
    unmake(&made);
}

/* Pixels that are good enough for what is wanted get next to none. */
static void samples_stop_where_the_error_is_reached(void **state)
{
    (void)state;
    Made made;
    make(&made, 0.2f, 0.01f, 0);
    plan(&made, 0.15, 0);
    assert_true(made.state.steering.rate[0] > 1);
    assert_true(made.state.steering.rate[PIXELS - 1] == 0.125f);
    unmake(&made);
}

/* Where photons make the noise, a sample a pass is all that helps; else photons that cost as much
 * as nine samples a pixel ask for more samples a pass. */
static void samples_share_photons_only_while_it_helps(void **state)
{
    (void)state;
    Made made;
    make(&made, 0.1f, 0.1f, 0.1f);
    plan(&made, 0, 9.0 * PIXELS);
    assert_true(made.state.steering.rate[0] == 1);
    for (size_t i = 0; i < PIXELS; i++)
        made.map.shared[i] = 0;
    plan(&made, 0, 9.0 * PIXELS);
    assert_true(fabs((double)made.state.steering.rate[0] - 9) < 0.01);
    unmake(&made);
}

/* What a pixel's own samples seem to be has no say in how many more it gets. */
static void lucky_pixels_get_as_many_as_others(void **state)
{
    (void)state;
    Made made;
    size_t middle = SIDE * SIDE / 2 + SIDE / 2;
    make(&made, 0.1f, 0.1f, 0);
    made.map.noise[middle] = 0.4f; /* and its smooth error, from 9 pixels, is */
    made.map.smooth[middle] = (float)sqrt((8 * 0.1 * 0.1 + 0.4 * 0.4) / 9);
    made.map.value[middle] = 3;
    made.map.luminance[middle] = (8 * 1 + 3) / 9.0f;
    plan(&made, 0, 0);
    const float *rate = made.state.steering.rate;
    assert_true(fabs((double)(rate[middle] / rate[0]) - 1) < 1e-3);
    unmake(&made);
}

/* A goal that is near is not overshot by far: an error a tenth above what is wanted takes a fifth
 * of the passes again. */
static void plans_end_where_the_goal_is_expected(void **state)
{
    (void)state;
    SteeringGoal goal = {.error = 0.1, .passes_left = INFINITY};
    ErrorFigure figure = {true, 0.1, 0.11, 0.1, 0};
    Made made;
    make(&made, 0.05f, 0.05f, 0);
    steering_plan(&made.state.steering, &made.map, made.state.halves, &figure, 100, &goal);
    assert_int_equal(made.state.steering.until, 122);
    goal.passes_left = 5;
    steering_plan(&made.state.steering, &made.map, made.state.halves, &figure, 100, &goal);
    assert_int_equal(made.state.steering.until, 106);
    unmake(&made);
}

/* A rate of 0.3 is three samples in ten pairs of passes, spread over the pixels; both passes of a
 * pair get the same. */
static void parts_of_samples_are_dealt_out_evenly(void **state)
{
    (void)state;
    Made made;
    make(&made, 0.1f, 0.1f, 0);
    int sum[PIXELS] = {0};
    for (size_t i = 0; i < PIXELS; i++)
        made.state.steering.rate[i] = 0.3f;
    for (uint64_t pass = 0; pass < 20; pass++) {
        int all = 0;
        steering_deal(&made.state.steering, pass, 1, &made.film);
        for (size_t i = 0; i < PIXELS; i++) {
            sum[i] += pass % 2 ? -made.samples[i].wanted : 11 * made.samples[i].wanted;
            all += made.samples[i].wanted;
        }
        assert_true(abs(all - (int)(0.3 * PIXELS)) < 4);
    }
    for (size_t i = 0; i < PIXELS; i++)
        assert_int_equal(sum[i], 30);
    unmake(&made);
}

/* --- pace ----------------------------------------------------------------------------------- */

static void the_last_pass_is_as_much_as_there_is_time_for(void **state)
{
    (void)state;
    Pace pace = {.seconds = 100, .started = clock_wall(), .photon_part = 1};
    const double spent[PHASE_COUNT] = {[PHASE_PHOTON_EMIT] = 3, [PHASE_EYE] = 5};
    pace_learn(&pace, spent, 0.5, 100);
    assert_true(fabs(pace_pass_seconds(&pace, 200) - 16) < 1e-9);
    assert_true(pace_part(&pace, 200) == 1);
    pace.seconds = 8;
    assert_true(fabs(pace_part(&pace, 200) - 0.5) < 0.01);
    pace.seconds = 0.1;
    assert_true(pace_part(&pace, 200) == 0);
    pace.seconds = 0; /* no limit */
    assert_true(pace_part(&pace, 200) == 1);
}

static void photons_are_cut_until_some_passes_fit(void **state)
{
    (void)state;
    Pace pace = {.seconds = 32, .started = clock_wall(), .photon_seconds = 10, .sample_seconds = 1};
    pace_fit_photons(&pace, 1); /* 8 passes of 4 seconds, one of them the eye's */
    assert_true(fabs(pace.photon_part - 0.3) < 0.01);
    pace_fit_photons(&pace, 3); /* not to less than the eye's work */
    assert_true(fabs(pace.photon_part - 0.3) < 0.01);
    pace_fit_photons(&pace, 6);
    assert_true(fabs(pace.photon_part - 0.6) < 0.01);
    pace.seconds = 1000;
    pace_fit_photons(&pace, 1);
    assert_true(pace.photon_part == 1);
    pace.seconds = 104; /* records of 10 seconds in each pass are no reason for fewer photons */
    pace.photon_seconds = 1.5;
    pace.record_seconds = 10;
    pace_fit_photons(&pace, 1);
    assert_true(pace.photon_part == 1);
}

static void samples_are_cut_until_some_passes_fit(void **state)
{
    (void)state;
    Pace pace = {.seconds = 40,
                 .started = clock_wall(),
                 .photon_part = 0.5,
                 .photon_seconds = 4,
                 .sample_seconds = 0.5};
    assert_true(pace_fit_samples(&pace, 15, 4) == 1); /* 2 of photons, 8 of samples */
    assert_true(fabs(pace_fit_samples(&pace, 64, 4) - 0.25) < 0.01);
    assert_true(pace_fit_samples(&pace, 64, 40) == 0);
    pace.seconds = 0; /* no limit */
    assert_true(pace_fit_samples(&pace, 1e9, 4) == 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(samples_make_errors_alike),
        cmocka_unit_test(the_worst_take_no_more_than_others),
        cmocka_unit_test(samples_stop_where_the_error_is_reached),
        cmocka_unit_test(samples_share_photons_only_while_it_helps),
        cmocka_unit_test(lucky_pixels_get_as_many_as_others),
        cmocka_unit_test(plans_end_where_the_goal_is_expected),
        cmocka_unit_test(parts_of_samples_are_dealt_out_evenly),
        cmocka_unit_test(the_last_pass_is_as_much_as_there_is_time_for),
        cmocka_unit_test(photons_are_cut_until_some_passes_fit),
        cmocka_unit_test(samples_are_cut_until_some_passes_fit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
