/* Images as heights.  SPDX-License-Identifier: Apache-2.0 */
#include "image/bitmap_height.h"

#include <math.h>

static uint16_t clipped(double height)
{
    return height > 0 ? (uint16_t)(height < 65535 ? height : 65535) : 0;
}

/* Return 8 bits of grey of a PNG without alpha: the language weighs it like a colour, in float,
 * and cuts off what is left. */
static double weighed_grey(double value)
{
    float f = (float)value / 255.0f;
    return floor(255.0f * (0.297f * f + 0.589f * f + 0.114f * f));
}

static uint16_t height_of(const Bitmap *b, const double s[3])
{
    if (b->is_indexed)
        return clipped(s[0] * 256);
    if (b->bits == 32)
        return clipped(b->channels < 3 ? s[0] * 65535 : (256 * s[0] + s[1]) * 255);
    if (b->channels >= 3)
        return clipped(b->bits == 8 ? 256 * s[0] + s[1]
                                    : 0.297 * s[0] + 0.589 * s[1] + 0.114 * s[2]);
    if (b->bits == 16)
        return clipped(s[0]);
    return clipped(257 * (b->kind == BITMAP_PNG && b->channels == 1 ? weighed_grey(s[0]) : s[0]));
}

void bitmap_heights(const Bitmap *bitmap, double gamma, uint16_t *out)
{
    int used = bitmap->channels >= 3 ? 3 : 1;
    double top = bitmap->bits == 32 ? 1 : bitmap->bits == 16 ? 65535 : 255;
    for (int y = bitmap->height - 1; y >= 0; y--) {
        for (int x = 0; x < bitmap->width; x++) {
            double s[3] = {0};
            for (int c = 0; c < used; c++) {
                s[c] = bitmap_at(bitmap, x, y, c);
                if (gamma != 1 && !bitmap->is_indexed && s[c] > 0)
                    s[c] = top * pow(s[c] / top, gamma);
                if (gamma != 1 && bitmap->bits != 32)
                    s[c] = floor(s[c]);
            }
            *out++ = height_of(bitmap, s);
        }
    }
}
