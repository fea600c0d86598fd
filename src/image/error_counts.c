/* Relative errors of pixels.  SPDX-License-Identifier: Apache-2.0 */
#include "image/error_counts.h"

#include "base/mem.h"

#include <assert.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

/* The dark parts of a picture are measured by this part of its mean luminance. */
#define DARK_PART 0.1

/* Errors are counted in STEPS even steps an octave from 2^LOW_LOG2 on, apart for each of GROUPS
 * parts of the picture, made of tiles all over it. */
enum { STEPS = 32, LOW_LOG2 = -40, OCTAVES = 60, BINS = STEPS * OCTAVES, GROUPS = 16, TILE = 16 };

/* Of Student's distribution with GROUPS - 1 degrees of freedom: below it with a chance of 0.9. */
#define STUDENT_90 1.341

static_assert(STEPS == 1 << (23 - 18), "see bin_of");

struct ErrorCounts {
    uint32_t count[GROUPS][BINS];
};

double error_scale(double luminance, double mean)
{
    return hypot(luminance, DARK_PART * mean);
}

ErrorCounts *error_counts_new(void)
{
    return mem_alloc(sizeof(ErrorCounts));
}

void error_counts_free(ErrorCounts *counts)
{
    mem_free(counts);
}

static size_t group_of(size_t x, size_t y)
{
    return (x / TILE + 5 * (y / TILE)) % GROUPS;
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

void error_counts_add(ErrorCounts *counts, size_t x, size_t y, double error)
{
    counts->count[group_of(x, y)][bin_of((float)error)]++;
}

/* How many errors of a bin there are without those of one group. */
static double errors_in(const ErrorCounts *counts, int bin, int without)
{
    double sum = 0;
    for (int g = 0; g < GROUPS; g++)
        sum += g == without ? 0 : counts->count[g][bin];
    return sum;
}

static double percentile(const ErrorCounts *counts, int without)
{
    double all = 0, below = 0;
    for (int bin = 0; bin < BINS; bin++)
        all += errors_in(counts, bin, without);
    for (int bin = 0; bin < BINS && all > 0; bin++) {
        double here = errors_in(counts, bin, without);
        if (here > 0 && below + here >= ERROR_PERCENTILE * all) {
            double part = (ERROR_PERCENTILE * all - below) / here;
            return bin == 0 ? 0 : error_at(bin, part);
        }
        below += here;
    }
    return 0;
}

double error_counts_percentile(const ErrorCounts *counts)
{
    return percentile(counts, -1);
}

double error_counts_bound(const ErrorCounts *counts)
{
    double whole = percentile(counts, -1), sum = 0, sum2 = 0;
    for (int g = 0; g < GROUPS; g++) {
        double without = percentile(counts, g);
        double step = without > 0 && whole > 0 ? log(without / whole) : 0;
        sum += step;
        sum2 += step * step;
    }
    double spread = (sum2 - sum * sum / GROUPS) * (GROUPS - 1) / GROUPS;
    return whole * exp(STUDENT_90 * sqrt(fmax(0, spread)));
}
