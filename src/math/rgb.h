/* Energy: three channels in the scene's linear working space.  A type of its own, so that
 * light and place cannot be mixed up.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_MATH_RGB_H
#define PMS_MATH_RGB_H

#include <math.h>
#include <stdbool.h>

typedef struct Rgb {
    float r, g, b;
} Rgb;

#define RGB_BLACK ((Rgb){0, 0, 0})
#define RGB_WHITE ((Rgb){1, 1, 1})

static inline Rgb rgb(float r, float g, float b) { return (Rgb){r, g, b}; }
static inline Rgb rgb_gray(float v) { return rgb(v, v, v); }
static inline Rgb rgb_add(Rgb a, Rgb b) { return rgb(a.r + b.r, a.g + b.g, a.b + b.b); }
static inline Rgb rgb_sub(Rgb a, Rgb b) { return rgb(a.r - b.r, a.g - b.g, a.b - b.b); }
static inline Rgb rgb_mul(Rgb a, Rgb b) { return rgb(a.r * b.r, a.g * b.g, a.b * b.b); }
static inline Rgb rgb_scale(Rgb a, float s) { return rgb(a.r * s, a.g * s, a.b * s); }

/* Return a + s*b. */
static inline Rgb rgb_mad(Rgb a, float s, Rgb b)
{
    return rgb(a.r + s * b.r, a.g + s * b.g, a.b + s * b.b);
}

static inline Rgb rgb_lerp(Rgb a, Rgb b, float t) { return rgb_mad(a, t, rgb_sub(b, a)); }
static inline float rgb_max(Rgb a)
{
    float m = a.g > a.r ? a.g : a.r;
    return a.b > m ? a.b : m;
}

static inline float rgb_min(Rgb a)
{
    float m = a.g < a.r ? a.g : a.r;
    return a.b < m ? a.b : m;
}
static inline float rgb_sum(Rgb a) { return a.r + a.g + a.b; }

/* Return the largest magnitude of the channels. */
static inline float rgb_max_abs(Rgb a) { return fmaxf(fabsf(a.r), fmaxf(fabsf(a.g), fabsf(a.b))); }

static inline Rgb rgb_abs(Rgb a) { return rgb(fabsf(a.r), fabsf(a.g), fabsf(a.b)); }
static inline float rgb_sum_abs(Rgb a) { return fabsf(a.r) + fabsf(a.g) + fabsf(a.b); }

/* Return the root of the sum of the squares, as standard errors add up. */
static inline Rgb rgb_hypot(Rgb a, Rgb b)
{
    return rgb(hypotf(a.r, b.r), hypotf(a.g, b.g), hypotf(a.b, b.b));
}

/* Return the luminance of linear light with the primaries of sRGB (ITU-R BT.709). */
static inline float rgb_luminance(Rgb a) { return 0.2126f * a.r + 0.7152f * a.g + 0.0722f * a.b; }

/* Return the language's grey value of a colour. */
static inline float rgb_grey(Rgb a) { return 0.297f * a.r + 0.589f * a.g + 0.114f * a.b; }

static inline bool rgb_is_black(Rgb a) { return a.r == 0 && a.g == 0 && a.b == 0; }
static inline bool rgb_is_finite(Rgb a) { return isfinite(a.r) && isfinite(a.g) && isfinite(a.b); }

#endif
