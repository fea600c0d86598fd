/* What the readers of image files share.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_IMAGE_BITMAP_INT_H
#define PMS_IMAGE_BITMAP_INT_H

#include "base/arena.h"
#include "image/bitmap.h"
#include "image/image.h"

/* Each reads the file at `path` into *out, whose kind is set, and leaves memory in it to
 * bitmap_done whether it fails or not. */
Status bitmap_read_png(Diag *diag, const char *path, Bitmap *out);
Status bitmap_read_jpeg(Diag *diag, const char *path, Bitmap *out);
Status bitmap_read_gif(Diag *diag, const char *path, Bitmap *out);
Status bitmap_read_tiff(Diag *diag, const char *path, Bitmap *out);
Status bitmap_read_pnm(Diag *diag, const char *path, Bitmap *out);
Status bitmap_read_tga(Diag *diag, const char *path, Bitmap *out);
Status bitmap_read_bmp(Diag *diag, const char *path, Bitmap *out);
Status bitmap_read_exr(Diag *diag, const char *path, Bitmap *out);
Status bitmap_read_hdr(Diag *diag, const char *path, Bitmap *out);

/* Set size and format and make room for the samples, zeroed.
 *
 * bytes  of the file, and `ratio`: how many bytes of samples one of them can stand for at best.
 *        What wants more is refused as cut off. */
Status bitmap_begin(Diag *diag, const char *path, Bitmap *b, long long width, long long height,
                    int channels, int bits, size_t bytes, double ratio);

/* Refuse a file: "cannot read 'path': what". */
Status bitmap_refuse(Diag *diag, const char *path, const char *what);

/* A file in memory, read from front to back; reading past the end gives 0 and sets is_short. */
typedef struct Bytes {
    const uint8_t *at, *end;
    size_t size;
    bool is_short;
} Bytes;

/* Read a whole file into `arena`. */
Status bytes_open(Diag *diag, const char *path, Arena *arena, Bytes *out);

static inline unsigned byte_next(Bytes *b)
{
    if (b->at < b->end)
        return *b->at++;
    b->is_short = true;
    return 0;
}

/* Little-endian numbers. */
static inline uint32_t bytes_16(Bytes *b)
{
    uint32_t low = byte_next(b);
    return low | byte_next(b) << 8;
}
static inline uint32_t bytes_32(Bytes *b)
{
    uint32_t low = bytes_16(b);
    return low | bytes_16(b) << 16;
}
static inline void bytes_skip(Bytes *b, size_t count)
{
    if (count > (size_t)(b->end - b->at)) {
        count = (size_t)(b->end - b->at);
        b->is_short = true;
    }
    b->at += count;
}

#endif
