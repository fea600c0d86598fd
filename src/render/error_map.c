/* How wrong a picture may be.  SPDX-License-Identifier: Apache-2.0 */
#include "render/error_map.h"

#include "base/mem.h"
#include "image/compare.h"
#include "image/percentile.h"

#include <string.h>

/* Pixels on either side over which squares and products are averaged: noise has fine structure,
 * blur is as wide as a gathering. */
enum { NOISE_REACH = 1, BIAS_REACH = 3 };

/* What the estimate does not see is allowed for by this factor in the bound: with few samples
 * errors are lopsided, as where a rare highlight is missed by all of them. */
#define BOUND_MARGIN 1.25

/* The relative error that is black in the picture of the errors; 1 is white. */
#define HEAT_LEAST 1e-3

Status error_map_init(ErrorMap *map, const Film *film, Diag *diag)
{
    size_t pixels = (size_t)film->width * (size_t)film->height;
    *map = (ErrorMap){.width = film->width, .height = film->height};
    map->noise = mem_array(pixels, sizeof(float));
    map->smooth = mem_array(pixels, sizeof(float));
    map->shared = mem_array(pixels, sizeof(float));
    map->bias = mem_array(pixels, sizeof(float));
    map->value = mem_array(pixels, sizeof(float));
    map->luminance = mem_array(pixels, sizeof(float));
    map->scratch = mem_array(pixels, sizeof(float));
    map->spare = mem_array(pixels, sizeof(float));
    if (map->noise && map->smooth && map->shared && map->bias && map->value && map->luminance &&
        map->scratch && map->spare)
        return OK;
    error_map_done(map);
    return diag_no_memory(diag, "the errors of the picture");
}

void error_map_done(ErrorMap *map)
{
    mem_free(map->noise);
    mem_free(map->smooth);
    mem_free(map->shared);
    mem_free(map->bias);
    mem_free(map->value);
    mem_free(map->luminance);
    mem_free(map->scratch);
    mem_free(map->spare);
    *map = (ErrorMap){.width = 0};
}

/* --- the halves ----------------------------------------------------------------------------- */

static double half_luminance(const FilmSum *half, size_t pixel)
{
    size_t at = 4 * pixel; /* the beauty comes first */
    return (double)rgb_luminance(rgb((float)film_sum_value(half, pixel, at),
                                     (float)film_sum_value(half, pixel, at + 1),
                                     (float)film_sum_value(half, pixel, at + 2)));
}

static double half_clue(const FilmSum *half, size_t pixel, ClueChannel clue)
{
    return film_sum_value(half, pixel, half->clues + CLUE_CHANNELS * pixel + (size_t)clue);
}

/* Half of the difference of two means of n_a and n_b samples; where they differ, what has the
 * variance of the mean of all: v/(n_a + n_b), of a difference of variance v/n_a + v/n_b. */
static double half_difference(double a, double b, double n_a, double n_b)
{
    return (a - b) * sqrt(n_a * n_b) / (n_a + n_b);
}

/* --- averages over neighbours --------------------------------------------------------------- */

static int clamped(int i, int end)
{
    return i < 0 ? 0 : i < end ? i : end - 1;
}

/* Average values over the pixels around each, as far as `reach`; at the border those that there
 * are count twice.  Along the rows, then down the columns, a row at once. */
static void average_row(const float *in, float *out, int width, int reach)
{
    float scale = (float)(2 * reach + 1);
    for (int x = 0; x < width; x++) {
        bool is_inner = x >= reach && x + reach < width;
        float sum = 0;
        for (int k = x - reach; k <= x + reach; k++)
            sum += in[is_inner ? k : clamped(k, width)];
        out[x] = sum / scale;
    }
}

static void average_rows(const float *in, float *out, int width, int height, int y, int reach)
{
    float scale = (float)(2 * reach + 1);
    for (int x = 0; x < width; x++)
        out[x] = 0;
    for (int k = y - reach; k <= y + reach; k++) {
        const float *row = in + (size_t)clamped(k, height) * (size_t)width;
        for (int x = 0; x < width; x++)
            out[x] += row[x];
    }
    for (int x = 0; x < width; x++)
        out[x] /= scale;
}

static bool is_zero(const float *values, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (values[i] != 0)
            return false;
    return true;
}

static void average_around(float *values, float *scratch, int width, int height, int reach)
{
    size_t row = (size_t)width;
    if (is_zero(values, row * (size_t)height))
        return;
    for (int y = 0; y < height; y++)
        average_row(values + (size_t)y * row, scratch + (size_t)y * row, width, reach);
    for (int y = 0; y < height; y++)
        average_rows(scratch, values + (size_t)y * row, width, height, y, reach);
}

/* --- the map -------------------------------------------------------------------------------- */

/* Turn squares of biases, which are mostly noise, into biases: the mean over the pixels around is
 * taken for one only as far as it is above its own standard error, else noise that happens to be
 * positive would count as bias. */
static void finish_bias(ErrorMap *map)
{
    const float around = (2 * BIAS_REACH + 1) * (2 * BIAS_REACH + 1);
    size_t pixels = (size_t)map->width * (size_t)map->height;
    if (is_zero(map->bias, pixels))
        return;
    for (size_t i = 0; i < pixels; i++)
        map->spare[i] = map->bias[i] * map->bias[i];
    average_around(map->bias, map->scratch, map->width, map->height, BIAS_REACH);
    average_around(map->spare, map->scratch, map->width, map->height, BIAS_REACH);
    for (size_t i = 0; i < pixels; i++) {
        float mean = map->bias[i], variance = fmaxf(0, map->spare[i] - mean * mean);
        float sure = mean - sqrtf(variance / around);
        map->bias[i] = sure > 0 ? sqrtf(sure) : 0;
    }
}

/* Average what was filled in pixel by pixel. */
static void finish_map(ErrorMap *map)
{
    size_t pixels = (size_t)map->width * (size_t)map->height;
    average_around(map->luminance, map->scratch, map->width, map->height, NOISE_REACH);
    average_around(map->smooth, map->scratch, map->width, map->height, NOISE_REACH);
    average_around(map->shared, map->scratch, map->width, map->height, NOISE_REACH);
    for (size_t i = 0; i < pixels; i++) {
        map->smooth[i] = sqrtf(map->smooth[i]);
        map->shared[i] = sqrtf(map->shared[i]);
    }
    finish_bias(map);
}

void error_map_of_halves(const FilmSum halves[2], const Film *film, const SceneSettings *settings,
                         ErrorMap *map)
{
    size_t pixels = (size_t)film->width * (size_t)film->height;
    for (size_t i = 0; i < pixels; i++) {
        double a = half_luminance(&halves[0], i), b = half_luminance(&halves[1], i);
        double n_a = halves[0].good[i], n_b = halves[1].good[i], all = n_a + n_b;
        double value = all > 0 ? (a * n_a + b * n_b) / all : 0, slope = film_slope(settings, value);
        double noise = all > 0 ? half_difference(a, b, n_a, n_b) * slope : 0;
        double blur_a = half_clue(&halves[0], i, CLUE_BLUR);
        double blur_b = half_clue(&halves[1], i, CLUE_BLUR);
        map->luminance[i] = map->value[i] = (float)film_linear(settings, value);
        map->noise[i] = (float)noise;
        double shared_a = half_clue(&halves[0], i, CLUE_SHARED);
        double shared_b = half_clue(&halves[1], i, CLUE_SHARED);
        double shared = all > 0 ? half_difference(shared_a, shared_b, n_a, n_b) * slope : 0;
        map->smooth[i] = (float)(noise * noise);
        map->shared[i] = (float)(shared * shared);
        map->bias[i] = (float)(4 * blur_a * blur_b * slope * slope);
    }
    finish_map(map);
}

/* --- one pass ------------------------------------------------------------------------------- */

/* What a pixel with one sample in its middle may be off, squared, over the squares of the second
 * differences across it.  An edge with a step of J between two such samples, anywhere with equal
 * chance, makes each of the two pixels wrong by J^2/24 in the mean square; a slope makes none.
 * Noise that is drawn anew for every pixel is in the two differences 12 times. */
#define BEND_PART (1.0 / 24)
#define BEND_PART_RANDOM (1.0 / 12)

/* The error squared of n samples spread evenly over a pixel falls as n^-1 where they are noise and
 * as n^-1.5 along an edge. */
#define SPREAD_POWER 1.25

/* Values of the normal distribution that are equally probable, up to the sign. */
static const float NORMAL_PARTS[8] = {0.0784f, 0.2372f, 0.4023f, 0.5791f,
                                      0.7764f, 1.0100f, 1.3180f, 1.8627f};

/* Samples of a pixel are the same when their squares say so within rounding. */
#define SAME_SAMPLES 1e-6

static double bend2(const float *values, int x, int y, int width, int height)
{
    const float *row = values + (size_t)y * (size_t)width;
    const float *above = values + (size_t)clamped(y - 1, height) * (size_t)width;
    const float *below = values + (size_t)clamped(y + 1, height) * (size_t)width;
    double here = 2 * (double)row[x];
    double across = (double)row[clamped(x - 1, width)] + (double)row[clamped(x + 1, width)] - here;
    double down = (double)above[x] + (double)below[x] - here;
    return across * across + down * down;
}

/* The luminance of the film's pixels, in working values. */
static void film_luminances(const Film *film, float *out)
{
    size_t pixels = (size_t)film->width * (size_t)film->height;
    const float *p = film->image.layers[0].pixels;
    for (size_t i = 0; i < pixels; i++, p += 4)
        out[i] = rgb_luminance(rgb(p[0], p[1], p[2]));
}

typedef struct Sampling {
    PixelSampling kind;
    int samples;
    double divisor;   /* of the spread of samples */
    double bend_part; /* of the squares of second differences */
} Sampling;

static Sampling make_sampling(PixelSampling kind, int samples)
{
    bool is_random = kind == SAMPLED_AT_RANDOM;
    return (Sampling){.kind = kind,
                      .samples = samples,
                      .divisor = is_random ? fmax(1, samples - 1) : pow(samples, SPREAD_POWER),
                      .bend_part = is_random ? BEND_PART_RANDOM : BEND_PART};
}

/* Square of the error that the samples of a pixel leave. */
static double sampling_error2(const float *values, const float *clues, const Sampling *sampling,
                              int x, int y, const ErrorMap *map)
{
    size_t i = (size_t)y * (size_t)map->width + (size_t)x;
    double value = (double)values[i], square = (double)clues[CLUE_SQUARE];
    double spread = square - value * value;
    if (sampling->kind == SAMPLED_ALL_OVER)
        return (double)clues[CLUE_LENS] / sampling->samples;
    if (sampling->samples > 1 && spread > SAME_SAMPLES * square)
        return spread / sampling->divisor;
    return sampling->bend_part * bend2(values, x, y, map->width, map->height);
}

void error_map_of_film(const Film *film, PixelSampling kind, int samples,
                       const SceneSettings *settings, ErrorMap *map)
{
    const Sampling sampling = make_sampling(kind, samples);
    const double blur_variance = gather_blur_variance(settings->pms.kernel);
    const float *clues = film->image.layers[film->image.layer_count - 1].pixels;
    float *values = map->scratch;
    film_luminances(film, values);
    for (int y = 0; y < map->height; y++)
        for (int x = 0; x < map->width; x++, clues += CLUE_CHANNELS) {
            size_t i = (size_t)y * (size_t)map->width + (size_t)x;
            double value = (double)values[i], slope = film_slope(settings, value);
            double noise = (double)clues[CLUE_NOISE], blur = (double)clues[CLUE_BLUR];
            double error2 = noise * noise + sampling_error2(values, clues, &sampling, x, y, map);
            double error = slope * sqrt(error2);
            map->luminance[i] = map->value[i] = (float)film_linear(settings, value);
            map->smooth[i] = (float)(error * error);
            map->noise[i] = (float)error * NORMAL_PARTS[(5 * x + 3 * y) % 8];
            double bias2 = 4 * (blur * blur - blur_variance * noise * noise);
            map->bias[i] = (float)(bias2 * slope * slope);
        }
    finish_map(map);
}

/* --- figures -------------------------------------------------------------------------------- */

/* The mean over the pixels around one, without itself, of what is the mean with it. */
static double mean_around(double mean, double own)
{
    const double all = (2 * NOISE_REACH + 1) * (2 * NOISE_REACH + 1);
    return fmax(0, (all * mean - own) / (all - 1));
}

double error_map_around(const ErrorMap *map, size_t pixel, double mean)
{
    double smooth = (double)map->smooth[pixel], own = (double)map->noise[pixel];
    double luminance = mean_around((double)map->luminance[pixel], (double)map->value[pixel]);
    double scale = error_scale(luminance, mean);
    return scale > 0 ? sqrt(mean_around(smooth * smooth, own * own)) / scale : 0;
}

double error_map_mean(const ErrorMap *map)
{
    size_t pixels = (size_t)map->width * (size_t)map->height;
    double mean = 0;
    for (size_t i = 0; i < pixels; i++)
        mean += (double)map->luminance[i] / (double)pixels;
    return mean;
}

/* Fill an array with relative errors of so much of the noise and the bias; the one may add to the
 * other or take from it.
 *
 * mean  luminance of the picture. */
static void fill_errors(const ErrorMap *map, double mean, double noise, double bias, float *out)
{
    size_t i = 0;
    for (int y = 0; y < map->height; y++)
        for (int x = 0; x < map->width; x++, i++) {
            double scale = error_scale((double)map->luminance[i], mean);
            double sign = (5 * x + 3 * y) % 16 < 8 ? 1 : -1;
            double error = noise * (double)map->noise[i] + sign * bias * (double)map->bias[i];
            out[i] = (float)(scale > 0 ? fabs(error) / scale : 0);
        }
}

/* The relative error of the picture's mean that 95 % of such pictures are within.  Where light
 * comes in rare bright samples most pixels have seen none, and seem to agree; the mean does not. */
static double mean_error(const ErrorMap *map, double mean)
{
    size_t pixels = (size_t)map->width * (size_t)map->height;
    double sum2 = 0;
    for (size_t i = 0; i < pixels; i++)
        sum2 += (double)map->noise[i] * (double)map->noise[i];
    return mean > 0 ? NORMAL_95 * sqrt(sum2) / (double)pixels / mean : 0;
}

ErrorFigure error_figure(const ErrorMap *map)
{
    size_t pixels = (size_t)map->width * (size_t)map->height;
    double mean = error_map_mean(map), least = mean_error(map, mean);
    float *errors = map->scratch;
    ErrorFigure figure = {.is_known = true};
    fill_errors(map, mean, 1, 0, errors);
    figure.noise = figure.whole = error_percentile(errors, pixels, ERROR_PERCENTILE);
    if (!is_zero(map->bias, pixels)) {
        fill_errors(map, mean, 0, 1, errors);
        figure.bias = error_percentile(errors, pixels, ERROR_PERCENTILE);
        fill_errors(map, mean, 1, 1, errors);
        figure.whole = error_percentile(errors, pixels, ERROR_PERCENTILE);
    }
    double bound = error_bound(errors, map->width, map->height, figure.whole);
    figure.bound = BOUND_MARGIN * fmax(least, bound);
    figure.whole = fmax(least, figure.whole);
    return figure;
}

static void show_layers(const ErrorMap *map, Image *picture)
{
    size_t size = (size_t)map->width * (size_t)map->height * sizeof(float);
    ImageLayer *noise = image_find_layer(picture, film_layer_name(LAYER_ERROR_NOISE));
    ImageLayer *bias = image_find_layer(picture, film_layer_name(LAYER_ERROR_BIAS));
    if (noise)
        memcpy(noise->pixels, map->smooth, size);
    if (bias)
        memcpy(bias->pixels, map->bias, size);
}

/* The relative error as heat. */
static void paint_errors(const ErrorMap *map, float *rgb_values)
{
    size_t pixels = (size_t)map->width * (size_t)map->height;
    double mean = error_map_mean(map);
    for (size_t i = 0; i < pixels; i++) {
        double error = hypot((double)map->smooth[i], (double)map->bias[i]);
        double scale = error_scale((double)map->luminance[i], mean);
        double shown = scale > 0 && error > 0 ? log10(error / scale / HEAT_LEAST) : 0;
        image_heat((float)(shown / -log10(HEAT_LEAST)), rgb_values + 3 * i);
    }
}

static Status show_picture(const ErrorMap *map, Diag *diag, Image *out)
{
    if (out->layer_count == 0) {
        image_init(out, map->width, map->height);
        out->is_display = true;
        if (!image_add_layer(out, "", "RGB"))
            return diag_no_memory(diag, "the picture of the errors");
    }
    paint_errors(map, out->layers[0].pixels);
    return OK;
}

Status error_map_show(const ErrorMap *map, Image *picture, const RenderOptions *options, Diag *diag,
                      Image *error_picture)
{
    show_layers(map, picture);
    return options->has_error_picture ? show_picture(map, diag, error_picture) : OK;
}
