/* Image files that scenes name: pixels as the file has them.
 *
 * Files come from anywhere: a broken one is refused with a message, and sizes are compared with
 * the file's own length before memory is asked for.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_IMAGE_BITMAP_H
#define PMS_IMAGE_BITMAP_H

#include "base/diag.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef enum BitmapKind {
    BITMAP_PNG,
    BITMAP_JPEG,
    BITMAP_GIF,
    BITMAP_TIFF,
    BITMAP_PNM, /* pgm, ppm, pbm, pfm's integer relatives */
    BITMAP_TGA,
    BITMAP_BMP,
    BITMAP_EXR,
    BITMAP_HDR,
    BITMAP_KIND_COUNT /* none of them */
} BitmapKind;

enum { PALETTE_MAX = 256 };

typedef struct Bitmap {
    BitmapKind kind;
    int width, height;               /* 1 to IMAGE_SIDE_MAX */
    int channels;                    /* 1 grey or index, 2 grey and alpha, 3 RGB, 4 RGBA */
    int bits;                        /* of a sample: 8, 16 or 32; 32 are floats, linear */
    bool is_indexed;                 /* samples are places in the palette */
    uint8_t palette[PALETTE_MAX][4]; /* RGBA; unused entries are black */
    void *samples;                   /* top row first, interleaved, of the machine's byte order */
    double gamma; /* light = sample ^ gamma, as the file says; 0: it does not, or sRGB */
} Bitmap;

/* Return the kind that the extension of a path stands for, BITMAP_KIND_COUNT if none. */
BitmapKind bitmap_kind_of(const char *path);

/* Read a file of this kind.  ERR_FILE or ERR_MEMORY, the message given.  Free with
 * bitmap_done.  Any thread. */
Status bitmap_read(Diag *diag, const char *path, BitmapKind kind, Bitmap *out);
void bitmap_done(Bitmap *bitmap);

/* Return a sample, in the file's scale. */
static inline double bitmap_at(const Bitmap *b, int x, int y, int channel)
{
    size_t i = ((size_t)y * (size_t)b->width + (size_t)x) * (size_t)b->channels + (size_t)channel;
    if (b->bits == 8)
        return ((const uint8_t *)b->samples)[i];
    return b->bits == 16 ? ((const uint16_t *)b->samples)[i]
                         : (double)((const float *)b->samples)[i];
}

#endif
