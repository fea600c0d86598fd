/* The codecs of the stored photon.
 *
 * RGBE keeps three mantissas and one exponent; rounding them down darkens (a channel 100 times
 * dimmer than the brightest loses over a quarter of its light), so each is rounded up or down
 * at random such that its mean is exact.  The direction tables are constant expressions: sines
 * by their series, unrolled by the preprocessor, so that no one has to fill them at run time.
 * SPDX-License-Identifier: Apache-2.0 */
#include "photon/photon.h"

#include <math.h>
#include <string.h>

/* sin(x) for |x| <= pi/2 from its series in y = x*x; the error is below 1e-13. */
#define SERIES(x, y)                                                                               \
    ((x) *                                                                                         \
     (1 -                                                                                          \
      (y) / 6 *                                                                                    \
          (1 - (y) / 20 *                                                                          \
                   (1 - (y) / 42 *                                                                 \
                            (1 - (y) / 72 *                                                        \
                                     (1 - (y) / 110 *                                              \
                                              (1 - (y) / 156 *                                     \
                                                       (1 - (y) / 210 * (1 - (y) / 272)))))))))
#define SIN(x) ((float)SERIES((x), ((x) * (x))))

/* Step i of azimuth is 2 pi i/256; of the polar angle pi i/255. */
#define PHI_SIN(i)                                                                                 \
    SIN((i) <= 64    ? (i) * (PMS_PI / 128)                                                        \
        : (i) <= 192 ? (128 - (i)) * (PMS_PI / 128)                                                \
                     : ((i)-256) * (PMS_PI / 128)),
#define PHI_COS(i) PHI_SIN(((i) + 64) % 256)
#define THETA_SIN(i) SIN(((i) <= 127 ? (i) : 255 - (i)) * (PMS_PI / 255)),
#define THETA_COS(i) SIN((127.5 - (i)) * (PMS_PI / 255)),

#define TABLE_4(f, i) f((i)) f((i) + 1) f((i) + 2) f((i) + 3)
#define TABLE_16(f, i) TABLE_4(f, i) TABLE_4(f, (i) + 4) TABLE_4(f, (i) + 8) TABLE_4(f, (i) + 12)
#define TABLE_64(f, i)                                                                             \
    TABLE_16(f, i) TABLE_16(f, (i) + 16) TABLE_16(f, (i) + 32) TABLE_16(f, (i) + 48)
#define TABLE_256(f)                                                                               \
    {                                                                                              \
        TABLE_64(f, 0) TABLE_64(f, 64) TABLE_64(f, 128) TABLE_64(f, 192)                           \
    }

static const float phi_sin[DIRECTION_STEPS] = TABLE_256(PHI_SIN);
static const float phi_cos[DIRECTION_STEPS] = TABLE_256(PHI_COS);
static const float theta_sin[DIRECTION_STEPS] = TABLE_256(THETA_SIN);
static const float theta_cos[DIRECTION_STEPS] = TABLE_256(THETA_COS);

/* Return e with x = m 2^e, m in [1/2, 1), of a positive normal number; far below for 0. */
static int exponent_of(double x)
{
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return (int)(bits >> 52) - 1022;
}

/* Return 2^e, for e in the range of normal doubles. */
static double power_of_two(int e)
{
    uint64_t bits = (uint64_t)(e + 1023) << 52;
    double x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

/* Make a channel something that can be stored. */
static double tame(float channel)
{
    const double most = 255 * 0x1p119;
    return !(channel > 0) ? 0 : channel > most ? most : (double)channel;
}

/* Round up with the probability of the fraction; `bits` is uniform in [0, 2^21). */
static uint8_t round_at_random(double steps, uint64_t bits)
{
    int whole = (int)steps;
    return (uint8_t)(whole + ((double)bits * 0x1p-21 < steps - whole));
}

void rgbe_encode(Rgb power, Rng *rng, uint8_t out[4])
{
    double r = tame(power.r), g = tame(power.g), b = tame(power.b);
    uint64_t bits = rng_u64(rng);
    double most = r > g ? r : g;
    most = most > b ? most : b;
    int exponent = exponent_of(most) + RGBE_BIAS - 8;
    if (exponent < RGBE_LEAST)
        exponent = RGBE_LEAST;
    if (most * power_of_two(RGBE_BIAS - exponent) > 255) /* it could round up to 256 */
        exponent++;
    double scale = power_of_two(RGBE_BIAS - exponent);
    out[0] = round_at_random(r * scale, bits & 0x1fffff);
    out[1] = round_at_random(g * scale, bits >> 21 & 0x1fffff);
    out[2] = round_at_random(b * scale, bits >> 42 & 0x1fffff);
    out[3] = out[0] | out[1] | out[2] ? (uint8_t)exponent : 0;
}

Rgb rgbe_decode(const uint8_t rgbe[4])
{
    if (rgbe[3] == 0)
        return RGB_BLACK;
    float step = (float)power_of_two(rgbe[3] - RGBE_BIAS);
    return rgb((float)rgbe[0] * step, (float)rgbe[1] * step, (float)rgbe[2] * step);
}

/* Return the angle of (x, y) from the x axis, 0 to pi, for y >= 0; the error is below 2e-5, a
 * hundredth of what a step of the codes allows.  The odd polynomial is a fit of the arc tangent
 * on [0,1]. */
static double upper_angle(double x, double y)
{
    double across = fabs(x), big = across > y ? across : y, small = across > y ? y : across;
    double t = big > 0 ? small / big : 0, u = t * t;
    double angle =
        t * (0.9998660 + u * (-0.3302995 + u * (0.1801410 + u * (-0.0851330 + u * 0.0208351))));
    angle = y > across ? PMS_PI / 2 - angle : angle;
    return x < 0 ? PMS_PI - angle : angle;
}

void direction_encode(V3 unit, uint8_t *phi, uint8_t *theta)
{
    if (!v3_is_finite(unit))
        unit = v3(0, 0, 1);
    double polar = upper_angle(unit.z, sqrt(unit.x * unit.x + unit.y * unit.y));
    double azimuth = upper_angle(unit.x, fabs(unit.y));
    int steps = (int)(azimuth * (DIRECTION_STEPS / (2 * PMS_PI)) + 0.5);
    *theta = (uint8_t)(polar * ((DIRECTION_STEPS - 1) / PMS_PI) + 0.5);
    *phi = (uint8_t)((unit.y < 0 ? -steps : steps) & (DIRECTION_STEPS - 1));
}

V3 direction_decode(uint8_t phi, uint8_t theta)
{
    double s = theta_sin[theta];
    return v3(s * phi_cos[phi], s * phi_sin[phi], theta_cos[theta]);
}

/* One coordinate of the octahedral square, [-1,1] to 0..126. */
static unsigned octahedral_step(double x)
{
    double step = (x + 1) * ((NORMAL_STEPS - 1) / 2) + 0.5;
    return step < NORMAL_STEPS - 1 ? (unsigned)step : NORMAL_STEPS - 1;
}

uint16_t normal14_encode(V3 unit)
{
    double sum = fabs(unit.x) + fabs(unit.y) + fabs(unit.z);
    if (!(sum > 0) || !isfinite(sum))
        return normal14_encode(v3(0, 0, 1));
    double x = unit.x / sum, y = unit.y / sum;
    if (unit.z < 0) { /* the lower half is folded out over the corners */
        double folded = copysign(1 - fabs(y), x);
        y = copysign(1 - fabs(x), y);
        x = folded;
    }
    return (uint16_t)(octahedral_step(x) | octahedral_step(y) << 7);
}

V3 normal14_decode(uint16_t code)
{
    const double step = 2.0 / (NORMAL_STEPS - 1);
    double x = (code & 127) * step - 1, y = (code >> 7 & 127) * step - 1;
    double z = 1 - fabs(x) - fabs(y), fold = fmax(-z, 0);
    return v3_unit(v3(x - copysign(fold, x), y - copysign(fold, y), z));
}
