/* What a ray sees that meets nothing: sky spheres, then the background.
 * SPDX-License-Identifier: Apache-2.0 */
#include "eye/eye_int.h"

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
    Rgb seen, sum = sky_glow(eye->trace.tracer, direction, &seen);
    float behind;
    Rgb background = background_light(eye, is_mirrored, &behind);
    *transmit = behind * rgb_grey(seen);
    return rgb_add(sum, rgb_mul(background, seen));
}
