/* PNG in and out, through libpng.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_IMAGE_PNG_FILE_H
#define PMS_IMAGE_PNG_FILE_H

#include "image/image.h"

/* Write display-encoded pixels: values are clipped to [0,1] and rounded to `bits` (8 or 16);
 * channels 3 (RGB) or 4 (RGBA, not premultiplied).  An sRGB chunk is written if is_srgb. */
Status png_write(Diag *diag, const char *path, int width, int height, int channels,
                 const float *pixels, int bits, bool is_srgb, const Meta *meta);

/* Read as one beauty layer, RGB or RGBA, values 0 to 1, is_display set. */
Status png_read(Diag *diag, const char *path, Image *out);

#endif
