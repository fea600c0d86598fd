/* The sRGB transfer curve (IEC 61966-2-1).  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_IMAGE_SRGB_H
#define PMS_IMAGE_SRGB_H

#include <math.h>

/* Return the display value of light `v`; below 0 it continues as a straight line.  Nothing is
 * clipped. */
static inline float srgb_encode(float v)
{
    return v <= 0.0031308f ? 12.92f * v : 1.055f * powf(v, 1 / 2.4f) - 0.055f;
}

/* Return the light of display value `v`. */
static inline float srgb_decode(float v)
{
    return v <= 0.04045f ? v / 12.92f : powf((v + 0.055f) / 1.055f, 2.4f);
}

#endif
