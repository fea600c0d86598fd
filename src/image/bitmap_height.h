/* Images as heights.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_IMAGE_BITMAP_HEIGHT_H
#define PMS_IMAGE_BITMAP_HEIGHT_H

#include "image/bitmap.h"

/* Turn an image into heights, 0 to 65535, bottom row first, the way the language does: an index
 * counts 256, 8 bits of red 256 and of green 1, grey of 16 bits 1.
 *
 * gamma  samples are raised to it first; 1: as they are.
 * out    width * height numbers. */
void bitmap_heights(const Bitmap *bitmap, double gamma, uint16_t *out);

#endif
