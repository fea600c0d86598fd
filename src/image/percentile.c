/* Relative errors of pixels.  SPDX-License-Identifier: Apache-2.0 */
#include "image/percentile.h"

#include "base/mem.h"
#include "math/rgb.h"

#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

/* The dark parts of a picture are measured by this part of its mean luminance. */
#define DARK_PART 0.1

/* Errors are counted in STEPS even steps an octave from 2^LOW_LOG2 on. */
enum { STEPS = 32, LOW_LOG2 = -40, OCTAVES = 60, BINS = STEPS * OCTAVES };
static_assert(STEPS == 1 << (23 - 18), "see bin_of");

/* Side of a tile, and the pixels that one patch of noise covers, as by a photon. */
enum { TILE = 8, PATCH = 16 };

/* Of the normal distribution: below it with a chance of 0.9. */
#define NORMAL_90 1.2816

double error_scale(double luminance, double mean)
{
    double dark = DARK_PART * mean;
    return sqrt(luminance * luminance + dark * dark);
}

/* The bin is made of the exponent and the first bits of the mantissa. */
static int bin_of(float error)
{
    uint32_t bits;
    memcpy(&bits, &error, sizeof bits);
    int bin = (int)(bits >> 18) - (127 + LOW_LOG2) * STEPS;
    return !(error > 0) || bin < 0 ? 0 : bin < BINS ? bin : BINS - 1;
}

/* Return the error at `part` of a bin. */
static double error_at(int bin, double part)
{
    return ldexp(1 + (bin % STEPS + part) / STEPS, bin / STEPS + LOW_LOG2);
}

double error_percentile(const float *errors, size_t count, double part)
{
    uint32_t bins[BINS] = {0};
    double all = 0, below = 0;
    for (size_t i = 0; i < count; i++)
        if (errors[i] >= 0) {
            bins[bin_of(errors[i])]++;
            all++;
        }
    for (int bin = 0; bin < BINS && all > 0; bin++) {
        double here = bins[bin];
        if (here > 0 && below + here >= part * all)
            return bin == 0 ? 0 : error_at(bin, (part * all - below) / here);
        below += here;
    }
    return 0;
}

/* The variance of the number of a tile's errors that are above a limit, as far as it is chance. */
static double tile_variance(const float *errors, int width, int height, int x0, int y0,
                            double limit)
{
    double count = 0, above = 0;
    for (int y = y0; y < y0 + TILE && y < height; y++)
        for (int x = x0; x < x0 + TILE && x < width; x++) {
            double error = (double)errors[(size_t)y * (size_t)width + (size_t)x];
            count += error >= 0;
            above += error > limit;
        }
    return count > 0 ? PATCH * above * (1 - above / count) : 0;
}

double error_bound(const float *errors, int width, int height, double figure)
{
    size_t pixels = (size_t)width * (size_t)height;
    double variance = 0;
    for (int y = 0; y < height; y += TILE)
        for (int x = 0; x < width; x += TILE)
            variance += tile_variance(errors, width, height, x, y, figure);
    double part = ERROR_PERCENTILE + NORMAL_90 * sqrt(variance) / (double)pixels;
    return error_percentile(errors, pixels, fmin(part, 1));
}

static Rgb rgb_at(const float *colours, size_t pixel)
{
    return rgb(colours[3 * pixel], colours[3 * pixel + 1], colours[3 * pixel + 2]);
}

/* The mean luminance of the pixels that are numbers. */
static double mean_luminance(const float *colours, size_t pixels)
{
    double sum = 0;
    size_t used = 0;
    for (size_t i = 0; i < pixels; i++) {
        Rgb light = rgb_at(colours, i);
        sum += rgb_is_finite(light) ? (double)rgb_luminance(light) : 0;
        used += rgb_is_finite(light);
    }
    return used > 0 ? sum / (double)used : 0;
}

bool error_between(const float *colours, const float *reference, size_t pixels, double *out)
{
    float *errors = mem_array(pixels, sizeof *errors);
    if (!errors)
        return false;
    double mean = mean_luminance(reference, pixels);
    for (size_t i = 0; i < pixels; i++) {
        Rgb one = rgb_at(colours, i), other = rgb_at(reference, i);
        double scale = error_scale((double)rgb_luminance(other), mean);
        double error = fabs((double)rgb_luminance(rgb_sub(one, other)));
        bool is_good = rgb_is_finite(one) && rgb_is_finite(other);
        errors[i] = is_good ? (float)(scale > 0 ? error / scale : error) : -1;
    }
    *out = error_percentile(errors, pixels, ERROR_PERCENTILE);
    mem_free(errors);
    return true;
}
