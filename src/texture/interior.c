/* Absorption inside interiors.  SPDX-License-Identifier: Apache-2.0 */
#include "texture/texture.h"

/* From this power on the language means the exponential law. */
#define EXPONENTIAL_POWER 1000.0

Rgb interior_fade(const Interior *interior, double distance, bool is_shadow)
{
    double power = interior->fade_power;
    if (interior->fade_distance == 0 || (is_shadow && !(power > 0)))
        return RGB_WHITE;
    Rgb k = interior->fade_color;
    double depth = distance / interior->fade_distance;
    if (power >= EXPONENTIAL_POWER) {
        return rgb((float)exp(-(1 - (double)k.r) * depth), (float)exp(-(1 - (double)k.g) * depth),
                   (float)exp(-(1 - (double)k.b) * depth));
    }
    float rest = (float)(1 / (1 + pow(depth, power)));
    return rgb(k.r + (1 - k.r) * rest, k.g + (1 - k.g) * rest, k.b + (1 - k.b) * rest);
}
