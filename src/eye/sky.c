/* What a ray sees that meets nothing: sky spheres, then the background.
 * SPDX-License-Identifier: Apache-2.0 */
#include "eye/eye_int.h"

/* Add one layer of sky in front of what is behind it; `seen` is what passes the layers before. */
static void sky_layer(const Sky *sky, const Pigment *pigment, V3 direction, Rgb *seen, Rgb *sum)
{
    Color5 c = pigment_at(pigment, direction);
    Rgb glow = rgb_mul(color5_rgb(c), sky->emission);
    *sum = rgb_mad(*sum, 1 - c.filter - c.transmit, rgb_mul(glow, *seen));
    *seen = rgb_mul(*seen, color5_through(c));
}

/* Only an alpha channel shows what the background lets through; without one that is black.  In
 * a mirror the background is opaque. */
static Rgb background_light(const EyeThread *eye, bool is_mirrored, float *transmit)
{
    Color5 c = eye->scene->background.color;
    bool has_alpha = eye->options.has_alpha;
    *transmit = has_alpha && !is_mirrored ? c.transmit : 0;
    return rgb_scale(color5_rgb(c), has_alpha && is_mirrored ? 1 : 1 - c.transmit);
}

Rgb sky_light(const EyeThread *eye, V3 direction, bool is_mirrored, float *transmit)
{
    Rgb sum = RGB_BLACK, seen = RGB_WHITE;
    if (plan_has(eye->plan, FEATURE_SKY)) {
        const Sky *sky = &eye->scene->sky;
        for (int i = sky->pigment_count - 1; i >= 0; i--)
            sky_layer(sky, sky->pigments[i], direction, &seen, &sum);
    }
    float behind;
    Rgb background = background_light(eye, is_mirrored, &behind);
    *transmit = behind * rgb_grey(seen);
    return rgb_add(sum, rgb_mul(background, seen));
}
