/* Estimated errors against errors that are known.  SPDX-License-Identifier: Apache-2.0 */
#include "render/error_map.h"

#include "base/mem.h"
#include "base/rng.h"
#include "image/percentile.h"

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

/* --- percentiles ---------------------------------------------------------------------------- */

static void a_percentile_is_what_most_are_below(void **state)
{
    (void)state;
    static float errors[20000];
    errors[0] = 1;
    assert_true(error_percentile(errors, 0, 0.95) == 0);
    for (int i = 0; i < 20000; i++)
        errors[i] = i % 2 ? -1 : 1e-6f * (float)i; /* every other one is left out */
    assert_true(fabs(error_percentile(errors, 20000, 0.95) / 0.019 - 1) < 0.002);
}

static void extremes_are_counted(void **state)
{
    (void)state;
    const float few[] = {0, 1e-30f}, many[] = {0, INFINITY, INFINITY, NAN};
    assert_true(error_percentile(few, 2, 0.95) == 0);
    assert_true(error_percentile(many, 4, 0.95) > 5e5);
}

/* The bound of noise in patches of 4 by 4 pixels is above what another picture of the same kind has
 * in nine of ten cases. */
static void the_bound_holds_in_nine_of_ten_cases(void **state)
{
    (void)state;
    enum { CASES = 400, WIDTH = 64 };
    static float errors[WIDTH * WIDTH];
    int held = 0;
    for (uint32_t k = 0; k < CASES; k++) {
        for (size_t i = 0; i < WIDTH * WIDTH; i++) {
            Rng rng = rng_at(1, k, i % WIDTH / 4 + 100 * (i / WIDTH / 4));
            errors[i] = (float)fabs(normal(&rng));
        }
        double figure = error_percentile(errors, WIDTH * WIDTH, ERROR_PERCENTILE);
        held += error_bound(errors, WIDTH, WIDTH, figure) >= 1.95996;
    }
    /* Standard error 0.015 of the share; a tile holds but four patches, so the bound is rough. */
    assert_true(fabs((double)held / CASES - 0.9) < 4 * 0.015);
}

/* A part of the picture that is wrong in every pixel is no matter of chance. */
static void what_is_sure_widens_no_bound(void **state)
{
    (void)state;
    static float errors[64 * 64];
    for (size_t i = 0; i < 64 * 64; i++)
        errors[i] = i / 64 < 8 ? 1e3f : 1;
    double figure = error_percentile(errors, 64 * 64, ERROR_PERCENTILE);
    assert_true(error_bound(errors, 64, 64, figure) == figure);
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
        assert_true(figure.bound > 1.25 * figure.whole && figure.bound < 1.35 * figure.whole);
        assert_true(figure.bias == 0 && figure.noise == figure.whole);
        unmake(&made);
    }
}

/* A mean difference of 0.01 between area and half the area is a bias of 0.02, though it is hidden
 * in noise twice as large. */
static void bias_is_found_in_noise(void **state)
{
    (void)state;
    Made made;
    make(&made);
    for (int pass = 0; pass < 16; pass++)
        add_pass(&made, pass % 2, (uint32_t)(100 + pass), 1, 0, 0.01, 0.02);
    error_map_of_halves(made.halves, &made.film, &LINEAR, &made.map);
    double sum2 = 0;
    for (int i = 0; i < PIXELS; i++)
        sum2 += (double)made.map.bias[i] * (double)made.map.bias[i] / PIXELS;
    /* 4 b_a b_b with b = 0.01 +- 0.02/sqrt(8) each has a standard deviation of 4.5e-4, of which a
     * seventh, for 49 pixels around, is taken off 0.02 squared: 0.0184. */
    assert_true(sqrt(sum2) > 0.0175 && sqrt(sum2) < 0.0195);
    unmake(&made);
}

/* One pixel in a hundred has seen light, in one of the halves: more than 95 % agree on black, but
 * the mean of 164 pixels is known to 1.96 / sqrt(164) only. */
static void rare_light_is_no_accuracy(void **state)
{
    (void)state;
    Made made;
    make(&made);
    for (int half = 0; half < 2; half++) {
        for (int i = 0; i < PIXELS; i++) {
            set_pixel(&made.film, i, i % 100 == 0 && i / 100 % 2 == half ? 1 : 0, 0);
            made.film.samples[i].wanted = made.film.samples[i].good = 1;
        }
        film_sum_add(&made.halves[half], &made.film);
    }
    error_map_of_halves(made.halves, &made.film, &LINEAR, &made.map);
    assert_true(fabs(error_figure(&made.map).whole / (1.96 / sqrt(164)) - 1) < 0.02);
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
    error_map_of_film(&made.film, SAMPLED_EVENLY, 1, &LINEAR, &made.map);
    for (int i = 0; i < PIXELS; i++)
        estimate2 += (double)made.map.smooth[i] * (double)made.map.smooth[i];
    assert_true(estimate2 / truth2 > 0.7 && estimate2 / truth2 < 1.5);
    unmake(&made);
}

/* Pictures of noise alone, one sample or four a pixel: the estimate is the standard error. */
static void chance_is_known_from_samples_and_neighbours(void **state)
{
    (void)state;
    Made made;
    make(&made);
    for (int samples = 1; samples <= 4; samples += 3) {
        double mean2 = 0, noise = 0.1;
        for (int i = 0; i < PIXELS; i++) {
            Rng rng = rng_at(3, (uint32_t)samples, (uint64_t)i);
            double sum = 0, sum2 = 0;
            for (int k = 0; k < samples; k++) {
                double value = 1 + noise * normal(&rng);
                sum += value / samples;
                sum2 += value * value / samples;
            }
            set_pixel(&made.film, i, (float)sum, 0);
            made.film.image.layers[1].pixels[CLUE_CHANNELS * i + CLUE_SQUARE] = (float)sum2;
        }
        error_map_of_film(&made.film, SAMPLED_AT_RANDOM, samples, &LINEAR, &made.map);
        for (int i = 0; i < PIXELS; i++)
            mean2 += (double)made.map.smooth[i] * (double)made.map.smooth[i] / PIXELS;
        assert_true(fabs(mean2 * samples / (noise * noise) - 1) < 0.06);
    }
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
    error_map_of_film(&made.film, SAMPLED_EVENLY, 1, &LINEAR, &made.map);
    assert_true(error_figure(&made.map).whole < 1e-4);
    unmake(&made);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_percentile_is_what_most_are_below),
        cmocka_unit_test(extremes_are_counted),
        cmocka_unit_test(the_bound_holds_in_nine_of_ten_cases),
        cmocka_unit_test(what_is_sure_widens_no_bound),
        cmocka_unit_test(the_difference_of_halves_is_the_noise),
        cmocka_unit_test(bias_is_found_in_noise),
        cmocka_unit_test(rare_light_is_no_accuracy),
        cmocka_unit_test(errors_are_of_linear_light),
        cmocka_unit_test(edges_without_antialiasing_are_seen),
        cmocka_unit_test(chance_is_known_from_samples_and_neighbours),
        cmocka_unit_test(slopes_are_no_error),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
