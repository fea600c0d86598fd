/* Structural similarity (Wang, Bovik, Sheikh, Simoncelli: "Image Quality Assessment: From Error
 * Visibility to Structural Similarity", 2004), without downsampling.
 *
 * The five local sums (a, b, a^2, b^2, ab) are blurred one line at a time: a ring of 11 lines
 * blurred along x is kept, and each output line is their weighted sum along y.
 * SPDX-License-Identifier: Apache-2.0 */
#include "image/ssim_int.h"

#include "base/mem.h"

#include <math.h>
#include <stddef.h>

enum { SSIM_RADIUS = 5, SSIM_TAPS = 2 * SSIM_RADIUS + 1, SSIM_SUMS = 5 };

static const double ssim_sigma = 1.5;
static const double ssim_c1 = 0.01 * 0.01; /* (K1 L)^2, L = 1 */
static const double ssim_c2 = 0.03 * 0.03; /* (K2 L)^2 */

typedef struct Ssim {
    const float *a, *b;
    int width, height;
    double tap[SSIM_TAPS];
    double *ring; /* SSIM_TAPS lines of width * SSIM_SUMS, blurred along x */
} Ssim;

/* Return the weight of all taps that stay inside [0, size) around `at`. */
static double weight_inside(const Ssim *s, int at, int size)
{
    double weight = 0;
    for (int k = -SSIM_RADIUS; k <= SSIM_RADIUS; k++) {
        if (at + k >= 0 && at + k < size)
            weight += s->tap[k + SSIM_RADIUS];
    }
    return weight;
}

static double *ring_line(const Ssim *s, int y)
{
    return s->ring + (size_t)(y % SSIM_TAPS) * (size_t)s->width * SSIM_SUMS;
}

static void blur_line(const Ssim *s, int y)
{
    const float *a = s->a + (size_t)y * (size_t)s->width;
    const float *b = s->b + (size_t)y * (size_t)s->width;
    double *out = ring_line(s, y);
    for (int x = 0; x < s->width; x++, out += SSIM_SUMS) {
        double sum[SSIM_SUMS] = {0};
        for (int k = -SSIM_RADIUS; k <= SSIM_RADIUS; k++) {
            if (x + k < 0 || x + k >= s->width)
                continue;
            double w = s->tap[k + SSIM_RADIUS], va = a[x + k], vb = b[x + k];
            sum[0] += w * va;
            sum[1] += w * vb;
            sum[2] += w * va * va;
            sum[3] += w * vb * vb;
            sum[4] += w * va * vb;
        }
        double scale = 1 / weight_inside(s, x, s->width);
        for (int i = 0; i < SSIM_SUMS; i++)
            out[i] = sum[i] * scale;
    }
}

static double similarity(const double m[SSIM_SUMS])
{
    double var_a = m[2] - m[0] * m[0];
    double var_b = m[3] - m[1] * m[1];
    double covar = m[4] - m[0] * m[1];
    return (2 * m[0] * m[1] + ssim_c1) * (2 * covar + ssim_c2) /
           ((m[0] * m[0] + m[1] * m[1] + ssim_c1) * (var_a + var_b + ssim_c2));
}

/* Return the sum of the similarities of line `y`, columns [first, end). */
static double sum_line(const Ssim *s, int y, int first, int end)
{
    double total = 0;
    double scale = 1 / weight_inside(s, y, s->height);
    for (int x = first; x < end; x++) {
        double m[SSIM_SUMS] = {0};
        for (int k = -SSIM_RADIUS; k <= SSIM_RADIUS; k++) {
            if (y + k < 0 || y + k >= s->height)
                continue;
            const double *line = ring_line(s, y + k) + (size_t)x * SSIM_SUMS;
            for (int i = 0; i < SSIM_SUMS; i++)
                m[i] += s->tap[k + SSIM_RADIUS] * scale * line[i];
        }
        total += similarity(m);
    }
    return total;
}

static void make_taps(Ssim *s)
{
    double sum = 0;
    for (int k = 0; k < SSIM_TAPS; k++) {
        double d = (k - SSIM_RADIUS) / ssim_sigma;
        sum += s->tap[k] = exp(-0.5 * d * d);
    }
    for (int k = 0; k < SSIM_TAPS; k++)
        s->tap[k] /= sum;
}

bool ssim_mean(const float *a, const float *b, int width, int height, double *out)
{
    Ssim s = {.a = a, .b = b, .width = width, .height = height};
    s.ring = mem_array((size_t)width * SSIM_TAPS, SSIM_SUMS * sizeof *s.ring);
    if (!s.ring)
        return false;
    make_taps(&s);
    bool is_small = width < SSIM_TAPS || height < SSIM_TAPS;
    int margin = is_small ? 0 : SSIM_RADIUS;
    double total = 0;
    int blurred = 0;
    for (int y = margin; y < height - margin; y++) {
        for (; blurred < height && blurred <= y + SSIM_RADIUS; blurred++)
            blur_line(&s, blurred);
        total += sum_line(&s, y, margin, width - margin);
    }
    mem_free(s.ring);
    *out = total / ((double)(width - 2 * margin) * (height - 2 * margin));
    return true;
}
