/* What the comparisons of two images share: their colours.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_IMAGE_COMPARE_INT_H
#define PMS_IMAGE_COMPARE_INT_H

#include "image/image.h"

/* The colours of two images, three floats a pixel, in one encoding; b is the reference. */
typedef struct ColourPair {
    float *a, *b;
    int width, height;
    size_t pixels;
    bool is_display;
} ColourPair;

/* Take the colours of two beauty layers as they look over black; free with colour_pair_done.
 * ERR_USAGE if sizes differ or an image has no colours; there is nothing to free then. */
Status colour_pair_init(Diag *diag, const Image *a, const Image *b, ColourPair *out);
void colour_pair_done(ColourPair *pair);

#endif
