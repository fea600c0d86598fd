/* Do two noisy pictures show the same?  SPDX-License-Identifier: Apache-2.0 */
#include "image/z_test.h"

#include "image/compare_int.h"
#include "math/rgb.h"
#include "math/v3.h"

#include <math.h>

/* What rounding may change of a luminance, as part of it: a few steps of a float where pictures are
 * sums of passes. */
#define ROUNDING 1e-6

/* One of the two pictures; noise and bias are NULL where it has none. */
typedef struct Side {
    const float *rgb;
    const ImageLayer *noise, *bias;
} Side;

double z_test_sidak(double whole, size_t count)
{
    return -expm1(log1p(-whole) / (double)count);
}

/* For an odd number n of degrees of freedom, with a = atan(t/sqrt(n)):
 * 2/pi (pi/2 - a - sin a (cos a + 2/3 cos^3 a + 2*4/(3*5) cos^5 a + ... to cos^(n-2) a)). */
double z_test_p_value(double z)
{
    double angle = atan2(sqrt(Z_TEST_FREEDOM), z), cosine = sin(angle); /* pi/2 - a */
    double term = cosine, sum = term;
    for (int i = 3; i < Z_TEST_FREEDOM; i += 2) {
        term *= cosine * cosine * (i - 1) / i;
        sum += term;
    }
    return 2 / PMS_PI * (angle - cos(angle) * sum);
}

double z_test_quantile(double level)
{
    double low = 0, high = 1;
    while (z_test_p_value(high) > level)
        high *= 2;
    for (int i = 0; i < 100; i++) {
        double middle = 0.5 * (low + high);
        if (z_test_p_value(middle) > level)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}

static double layer_value(const ImageLayer *layer, size_t pixel)
{
    return layer ? (double)layer->pixels[pixel * (size_t)layer->channel_count] : 0;
}

static double luminance(const Side *side, size_t pixel)
{
    const float *p = side->rgb + 3 * pixel;
    return (double)rgb_luminance(rgb(p[0], p[1], p[2]));
}

/* Return how many standard errors two pixels are apart: infinite where there is no noise that could
 * explain their difference, NaN where one is no number. */
static double pixel_z(const Side *a, const Side *b, size_t pixel)
{
    double value_a = luminance(a, pixel), value_b = luminance(b, pixel);
    double noise = hypot(layer_value(a->noise, pixel), layer_value(b->noise, pixel));
    double bias = fabs(layer_value(a->bias, pixel)) + fabs(layer_value(b->bias, pixel));
    double rounding = ROUNDING * fmax(fabs(value_a), fabs(value_b));
    double apart = fabs(value_a - value_b) - bias - rounding;
    if (!isfinite(apart) || !isfinite(noise))
        return NAN;
    return apart <= 0 ? 0 : apart / noise;
}

static void test_pixels(const Side *a, const Side *b, int width, ZTest *out)
{
    out->worst = -1;
    for (size_t i = 0; i < out->pixels; i++) {
        double z = pixel_z(a, b, i);
        out->bad += isnan(z) ? 1 : 0;
        out->accepted += z <= out->critical ? 1 : 0;
        z = isnan(z) ? INFINITY : z;
        if (z > out->worst) {
            out->worst = z;
            out->worst_x = (int)(i % (size_t)width);
            out->worst_y = (int)(i / (size_t)width);
        }
    }
    out->share = (double)out->accepted / (double)out->pixels;
    out->passes = out->share >= Z_TEST_SHARE;
}

static Side side_of(const Image *image, const float *rgb)
{
    return (Side){rgb, image_find_layer(image, Z_TEST_NOISE_LAYER),
                  image_find_layer(image, Z_TEST_BIAS_LAYER)};
}

Status z_test(Diag *diag, const Image *a, const Image *reference, ZTest *out)
{
    ColourPair pair;
    *out = (ZTest){0};
    if (a->is_display || reference->is_display)
        return diag_fail(diag, ERR_USAGE,
                         "the z-test wants linear light with its noise, from two EXR files; a PNG "
                         "has neither");
    TRY(colour_pair_init(diag, a, reference, &pair));
    Side sides[2] = {side_of(a, pair.a), side_of(reference, pair.b)};
    Status status = OK;
    if (sides[0].noise || sides[1].noise) {
        out->pixels = pair.pixels;
        out->level = z_test_sidak(Z_TEST_LEVEL, pair.pixels);
        out->critical = z_test_quantile(out->level);
        out->is_exact_a = !sides[0].noise;
        out->is_exact_b = !sides[1].noise;
        out->has_bias = sides[0].bias || sides[1].bias;
        test_pixels(&sides[0], &sides[1], pair.width, out);
    } else {
        status = diag_fail(diag, ERR_USAGE,
                           "the z-test wants to know the noise, but neither image has the layer "
                           "'" Z_TEST_NOISE_LAYER "': render with pms SCENE --layers "
                           "error.noise,error.bias -o FILE.exr");
    }
    colour_pair_done(&pair);
    return status;
}
