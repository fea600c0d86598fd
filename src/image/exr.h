/* OpenEXR in and out, through OpenEXRCore.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_IMAGE_EXR_H
#define PMS_IMAGE_EXR_H

#include "image/image.h"

typedef struct ExrOptions {
    bool is_half; /* colour channels as half; Z, N and other data stay float */
    int threads;  /* that compress; 0: one */
} ExrOptions;

/* Write every layer to one part: the beauty as R,G,B,A, others as name.channel; zip-compressed,
 * Rec.709 chromaticities, `meta` as string attributes.  Whole or not at all.  The bytes are the
 * same on any number of threads. */
Status exr_write(Diag *diag, const char *path, const Image *image, const Meta *meta,
                 ExrOptions options);

/* Read every channel of a single-part scanline or tiled file, half, float or uint.  Refuses
 * images over IMAGE_SIDE_MAX.  Free with image_done. */
Status exr_read(Diag *diag, const char *path, Image *out);

#endif
