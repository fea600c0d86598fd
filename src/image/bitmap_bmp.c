/* Windows bitmaps: 1, 4, 8, 16, 24 and 32 bits, plain, with masks, or run-length coded.
 * SPDX-License-Identifier: Apache-2.0 */
#include "image/bitmap_int.h"

enum { BMP_PLAIN, BMP_RLE8, BMP_RLE4, BMP_MASKS };

typedef struct BmpHeader {
    uint32_t pixels_at, header_bytes, bits, method, colors;
    int64_t width, height;
    bool is_top_down;
    uint32_t mask[4]; /* red green blue alpha */
} BmpHeader;

static bool read_header(Bytes *b, BmpHeader *h)
{
    const uint8_t *start = b->at;
    *h = (BmpHeader){0};
    if (byte_next(b) != 'B' || byte_next(b) != 'M')
        return false;
    bytes_skip(b, 8);
    h->pixels_at = bytes_32(b);
    h->header_bytes = bytes_32(b);
    bool is_old = h->header_bytes == 12;
    if (!is_old && (h->header_bytes < 40 || h->header_bytes > 1000))
        return false;
    h->width = is_old ? (int64_t)bytes_16(b) : (int32_t)bytes_32(b);
    h->height = is_old ? (int64_t)bytes_16(b) : (int32_t)bytes_32(b);
    h->is_top_down = h->height < 0;
    h->height = h->is_top_down ? -h->height : h->height;
    bytes_16(b); /* planes */
    h->bits = bytes_16(b);
    if (!is_old) {
        h->method = bytes_32(b);
        bytes_skip(b, 12);
        h->colors = bytes_32(b);
        bytes_32(b);
    }
    static const uint32_t five[3] = {0x7c00, 0x3e0, 0x1f}, eight[3] = {0xff0000, 0xff00, 0xff};
    for (int i = 0; i < 3; i++)
        h->mask[i] = h->method == BMP_MASKS ? bytes_32(b) : h->bits == 16 ? five[i] : eight[i];
    if (h->method == BMP_MASKS && h->header_bytes >= 56)
        h->mask[3] = bytes_32(b);
    size_t colors_at = 14 + (size_t)h->header_bytes;
    if (h->method == BMP_MASKS && h->header_bytes == 40)
        colors_at += 12;
    b->at = start;
    bytes_skip(b, colors_at);
    return !b->is_short;
}

static void read_palette(Bytes *b, const BmpHeader *h, Bitmap *out)
{
    uint32_t count = h->colors ? h->colors : 1u << h->bits;
    for (uint32_t i = 0; i < count && i < PALETTE_MAX; i++) {
        for (int c = 2; c >= 0; c--)
            out->palette[i][c] = (uint8_t)byte_next(b);
        out->palette[i][3] = 255;
        if (h->header_bytes != 12)
            byte_next(b);
    }
}

/* Return the value under a mask, scaled to 8 bits. */
static uint8_t masked(uint32_t value, uint32_t mask)
{
    if (mask == 0)
        return 0;
    while (!(mask & 1))
        mask >>= 1, value >>= 1;
    return (uint8_t)((uint64_t)(value & mask) * 255 / mask);
}

static uint8_t *row_of(const BmpHeader *h, const Bitmap *out, int row)
{
    int y = h->is_top_down ? row : out->height - 1 - row;
    return (uint8_t *)out->samples + (size_t)y * (size_t)out->width * (size_t)out->channels;
}

static void read_row(Bytes *b, const BmpHeader *h, Bitmap *out, uint8_t *to)
{
    const uint8_t *start = b->at;
    unsigned packed = 0;
    for (int x = 0; x < out->width; x++) {
        if (h->bits <= 8) {
            unsigned per_byte = 8 / h->bits, at = (unsigned)x % per_byte;
            packed = at ? packed : byte_next(b);
            *to++ = (uint8_t)(packed >> (8 - h->bits * (at + 1)) & ((1u << h->bits) - 1));
            continue;
        }
        uint32_t value = bytes_16(b);
        if (h->bits > 16)
            value |= byte_next(b) << 16;
        if (h->bits == 32)
            value |= (uint32_t)byte_next(b) << 24;
        for (int c = 0; c < out->channels; c++)
            *to++ = masked(value, h->mask[c]);
    }
    while (!b->is_short && (b->at - start) % 4) /* rows are padded */
        byte_next(b);
}

/* Read runs of indices: a count and a colour, or 0 and an escape. */
static void read_runs(Bytes *b, const BmpHeader *h, Bitmap *out)
{
    int x = 0, row = 0;
    while (!b->is_short && row < out->height) {
        unsigned count = byte_next(b), value = byte_next(b);
        if (count == 0 && value == 0) {
            x = 0, row++;
        } else if (count == 0 && value == 1) {
            return;
        } else if (count == 0 && value == 2) {
            x += (int)byte_next(b);
            row += (int)byte_next(b);
        } else {
            bool is_literal = count == 0;
            unsigned length = is_literal ? value : count, taken = 0;
            for (unsigned i = 0; i < length; i++) {
                bool is_low = h->method == BMP_RLE4 && i % 2;
                if (is_literal && !is_low)
                    value = byte_next(b), taken++;
                unsigned index = h->method == BMP_RLE8 ? value : is_low ? value & 15 : value >> 4;
                if (x < out->width)
                    row_of(h, out, row)[x++] = (uint8_t)index;
            }
            if (taken % 2)
                byte_next(b);
        }
    }
}

static Status read_file(Diag *diag, const char *path, Arena *arena, Bitmap *out)
{
    Bytes b;
    BmpHeader h;
    TRY(bytes_open(diag, path, arena, &b));
    Bytes all = b;
    bool is_indexed = read_header(&b, &h) && h.bits <= 8;
    bool is_run = h.method == BMP_RLE8 || h.method == BMP_RLE4;
    if (b.is_short || h.method > BMP_MASKS ||
        !(h.bits == 1 || h.bits == 4 || h.bits == 8 || h.bits == 16 || h.bits == 24 ||
          h.bits == 32) ||
        (is_run && h.bits != (h.method == BMP_RLE8 ? 8 : 4)))
        return bitmap_refuse(diag, path, "it is no Windows bitmap that can be read");
    if (is_indexed)
        read_palette(&b, &h, out);
    TRY(bitmap_begin(diag, path, out, h.width, h.height,
                     is_indexed  ? 1
                     : h.mask[3] ? 4
                                 : 3,
                     8, b.size, is_run ? 1e4 : 8));
    out->is_indexed = is_indexed;
    b = all;
    bytes_skip(&b, h.pixels_at);
    if (is_run)
        read_runs(&b, &h, out);
    for (int row = 0; !is_run && row < out->height; row++)
        read_row(&b, &h, out, row_of(&h, out, row));
    return b.is_short ? bitmap_refuse(diag, path, "the file ends too early") : OK;
}

Status bitmap_read_bmp(Diag *diag, const char *path, Bitmap *out)
{
    Arena *arena = arena_new();
    Status status = arena ? read_file(diag, path, arena, out) : diag_no_memory(diag, path);
    arena_free(arena);
    return status;
}
