/* Estimated errors against errors that are known.  SPDX-License-Identifier: Apache-2.0 */
#include "render/error_map.h"

#include "base/mem.h"
#include "base/rng.h"
#include "image/error_counts.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

enum { SIDE = 128, PIXELS = SIDE * SIDE };

static const SceneSettings LINEAR = {.assumed_gamma = 1};

static double normal(Rng *rng)
{
    double u = 1 - rng_double(rng), v = rng_double(rng);
    return sqrt(-2 * log(u)) * cos(2 * PMS_PI * v);
}

/* --- counts --------------------------------------------------------------------------------- */

static void a_percentile_is_what_most_are_below(void **state)
{
    (void)state;
    ErrorCounts *counts = error_counts_new();
    assert_true(error_counts_percentile(counts) == 0);
    for (int i = 0; i < 100000; i++)
        error_counts_add(counts, (size_t)i % 400, (size_t)i / 400, 1e-6 * i);
    assert_true(fabs(error_counts_percentile(counts) / 0.095 - 1) < 0.002);
    assert_true(error_counts_bound(counts) > error_counts_percentile(counts));
    error_counts_free(counts);
}

/* Values that know nothing of each other are below the bound in nine of ten cases. */
static void the_bound_holds_in_nine_of_ten_cases(void **state)
{
    (void)state;
    enum { CASES = 400 };
    int held = 0;
    for (uint64_t k = 0; k < CASES; k++) {
        Rng rng = rng_at(1, 0, k);
        ErrorCounts *counts = error_counts_new();
        for (size_t i = 0; i < 64 * 64; i++)
            error_counts_add(counts, i % 64, i / 64, fabs(normal(&rng)));
        held += error_counts_bound(counts) >= 1.95996;
        error_counts_free(counts);
    }
    /* Standard error 0.015 of the share; the bins are 2 % wide. */
    assert_true(fabs((double)held / CASES - 0.9) < 4 * 0.015);
}

static void extremes_are_counted(void **state)
{
    (void)state;
    ErrorCounts *counts = error_counts_new();
    error_counts_add(counts, 0, 0, 0);
    error_counts_add(counts, 0, 0, 1e-30);
    assert_true(error_counts_percentile(counts) == 0);
    for (int i = 0; i < 100; i++)
        error_counts_add(counts, 0, 0, INFINITY);
    assert_true(error_counts_percentile(counts) > 5e5);
    error_counts_free(counts);
}

/* --- halves --------------------------------------------------------------------------------- */

typedef struct Made {
    Film film;
    FilmSum halves[2];
    ErrorMap map;
} Made;

static void make(Made *made)
{
    RenderOptions options = RENDER_OPTIONS_DEFAULT;
    options.width = options.height = SIDE;
    assert_int_equal(film_init(&made->film, &options, FILM_SAMPLES | FILM_CLUES, NULL), OK);
    made->film.samples = mem_array(PIXELS, sizeof *made->film.samples);
    for (int i = 0; i < 2; i++)
        assert_int_equal(film_sum_init(&made->halves[i], &made->film, NULL), OK);
    assert_int_equal(error_map_init(&made->map, &made->film, NULL), OK);
}

static void unmake(Made *made)
{
    error_map_done(&made->map);
    for (int i = 0; i < 2; i++)
        film_sum_done(&made->halves[i]);
    mem_free(made->film.samples);
    film_done(&made->film);
}

static void set_pixel(Film *film, int pixel, float value, float blur)
{
    float *beauty = film->image.layers[0].pixels + 4 * pixel;
    float *clues = film->image.layers[1].pixels + CLUE_CHANNELS * pixel;
    beauty[0] = beauty[1] = beauty[2] = value;
    clues[CLUE_BLUR] = blur;
    clues[CLUE_SQUARE] = value * value;
}

/* Add a pass to a half: 0.5 with noise of one sample, and a blur with noise of its own. */
static void add_pass(Made *made, int half, uint32_t pass, int samples, double noise, double blur,
                     double blur_noise)
{
    for (int i = 0; i < PIXELS; i++) {
        Rng rng = rng_at(7, pass, (uint64_t)i);
        double value = 0.5 + noise * normal(&rng) / sqrt(samples);
        set_pixel(&made->film, i, (float)value, (float)(blur + blur_noise * normal(&rng)));
        made->film.samples[i].wanted = made->film.samples[i].good = (uint16_t)samples;
    }
    film_sum_add(&made->halves[half], &made->film);
}

/* Twelve samples with a standard deviation of 0.1: that of the mean is 0.0289, and 95 % are within
 * 1.96 times as much of the right 0.5.  However the samples are dealt out. */
static void the_difference_of_halves_is_the_noise(void **state)
{
    (void)state;
    static const int dealt[][2] = {{6, 6}, {11, 1}, {3, 9}};
    for (int k = 0; k < 3; k++) {
        Made made;
        make(&made);
        for (int h = 0; h < 2; h++)
            add_pass(&made, h, (uint32_t)(2 * k + h), dealt[k][h], 0.1, 0, 0);
        error_map_of_halves(made.halves, &made.film, &LINEAR, &made.map);
        ErrorFigure figure = error_figure(&made.map);
        double expected = 1.96 * 0.1 / sqrt(12) / hypot(0.5, 0.05);
        /* 16384 pixels: the percentile's standard error is 1.1 %, and bins are up to 3 % wide. */
        assert_true(figure.is_known && fabs(figure.whole / expected - 1) < 0.06);
        assert_true(figure.bound > figure.whole && figure.bound < 1.1 * figure.whole);
        assert_true(figure.bias == 0 && figure.noise == figure.whole);
        unmake(&made);
    }
}

/* A mean difference of 0.01 between area and half the area is a bias of 0.02, though it is hidden
 * in noise five times as large. */
static void bias_is_found_in_noise(void **state)
{
    (void)state;
    Made made;
    make(&made);
    for (int pass = 0; pass < 16; pass++)
        add_pass(&made, pass % 2, (uint32_t)(100 + pass), 1, 0, 0.01, 0.05);
    error_map_of_halves(made.halves, &made.film, &LINEAR, &made.map);
    double sum2 = 0;
    for (int i = 0; i < PIXELS; i++)
        sum2 += (double)made.map.bias[i] * (double)made.map.bias[i] / PIXELS;
    /* 4 b_a b_b with b = 0.01 +- 0.05/sqrt(8) each, over 49 pixels around, and what is negative cut
     * off: a little more than 0.02 squared. */
    assert_true(sqrt(sum2) > 0.018 && sqrt(sum2) < 0.024);
    unmake(&made);
}

/* Errors are those of linear light where the scene works on other values: here its square. */
static void errors_are_of_linear_light(void **state)
{
    (void)state;
    const SceneSettings squared = {.assumed_gamma = 2};
    Made made;
    make(&made);
    add_pass(&made, 0, 1, 6, 0.01, 0, 0);
    add_pass(&made, 1, 2, 6, 0.01, 0, 0);
    error_map_of_halves(made.halves, &made.film, &squared, &made.map);
    double expected = 1.96 * 2 * 0.5 * 0.01 / sqrt(12) / hypot(0.25, 0.025);
    assert_true(fabs(error_figure(&made.map).whole / expected - 1) < 0.06);
    unmake(&made);
}

/* --- a single pass -------------------------------------------------------------------------- */

/* The picture of a half-plane whose edge lies askew, one sample in the middle of each pixel: nine
 * in ten pixels beside the edge are off by less than what is estimated times the normal's 1.64. */
static void edges_without_antialiasing_are_seen(void **state)
{
    (void)state;
    Made made;
    double slope = 0.3, truth2 = 0, estimate2 = 0;
    make(&made);
    for (int i = 0; i < PIXELS; i++) {
        double edge = i % SIDE + 0.5 + slope * (i / SIDE + 0.5) - 70;
        double part = fmin(1, fmax(0, edge + 0.5)); /* of the pixel, along its middle row */
        set_pixel(&made.film, i, edge > 0 ? 1 : 0, 0);
        truth2 += pow(part - (edge > 0), 2);
    }
    error_map_of_film(&made.film, 1, &LINEAR, &made.map);
    for (int i = 0; i < PIXELS; i++)
        estimate2 += (double)made.map.smooth[i] * (double)made.map.smooth[i];
    assert_true(estimate2 / truth2 > 0.7 && estimate2 / truth2 < 1.5);
    unmake(&made);
}

/* A slope needs no antialiasing, and none is missed. */
static void slopes_are_no_error(void **state)
{
    (void)state;
    Made made;
    make(&made);
    for (int i = 0; i < PIXELS; i++)
        set_pixel(&made.film, i, (float)(i % SIDE) / SIDE, 0);
    error_map_of_film(&made.film, 1, &LINEAR, &made.map);
    assert_true(error_figure(&made.map).whole < 1e-4);
    unmake(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_percentile_is_what_most_are_below),
        cmocka_unit_test(the_bound_holds_in_nine_of_ten_cases),
        cmocka_unit_test(extremes_are_counted),
        cmocka_unit_test(the_difference_of_halves_is_the_noise),
        cmocka_unit_test(bias_is_found_in_noise),
        cmocka_unit_test(errors_are_of_linear_light),
        cmocka_unit_test(edges_without_antialiasing_are_seen),
        cmocka_unit_test(slopes_are_no_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
