/* Targa: true colour, grey and palettes, plain or run-length coded.
 * SPDX-License-Identifier: Apache-2.0 */
#include "image/bitmap_int.h"

typedef struct TgaHeader {
    unsigned type; /* 1 palette, 2 colour, 3 grey; + 8: runs */
    uint32_t first, map_count, map_bits;
    uint32_t width, height, depth, flags;
} TgaHeader;

static TgaHeader read_header(Bytes *b)
{
    TgaHeader h = {0};
    unsigned id_bytes = byte_next(b);
    byte_next(b); /* whether there is a map: its count tells */
    h.type = byte_next(b);
    h.first = bytes_16(b);
    h.map_count = bytes_16(b);
    h.map_bits = byte_next(b);
    bytes_32(b); /* the origin */
    h.width = bytes_16(b);
    h.height = bytes_16(b);
    h.depth = byte_next(b);
    h.flags = byte_next(b);
    bytes_skip(b, id_bytes);
    return h;
}

/* Read a colour of 15, 16, 24 or 32 bits as RGBA. */
static void read_color(Bytes *b, uint32_t bits, uint8_t out[4])
{
    out[3] = 255;
    if (bits <= 16) {
        uint32_t v = bytes_16(b);
        for (int i = 0; i < 3; i++) {
            uint32_t five = v >> (10 - 5 * i) & 31;
            out[i] = (uint8_t)(five << 3 | five >> 2);
        }
        return;
    }
    out[2] = (uint8_t)byte_next(b);
    out[1] = (uint8_t)byte_next(b);
    out[0] = (uint8_t)byte_next(b);
    if (bits == 32)
        out[3] = (uint8_t)byte_next(b);
}

static void read_pixel(Bytes *b, const TgaHeader *h, int channels, uint8_t out[4])
{
    if (channels == 1) {
        unsigned value = byte_next(b);
        out[0] = (uint8_t)(h->type % 8 == 1 ? value - h->first : value);
    } else {
        read_color(b, h->depth, out);
    }
}

static void put_pixel(const TgaHeader *h, Bitmap *out, size_t i, const uint8_t pixel[4])
{
    size_t width = (size_t)out->width, x = i % width, y = i / width;
    if (h->flags & 0x10)
        x = width - 1 - x;
    if (!(h->flags & 0x20)) /* bottom row first */
        y = (size_t)out->height - 1 - y;
    uint8_t *to = (uint8_t *)out->samples + (y * width + x) * (size_t)out->channels;
    for (int c = 0; c < out->channels; c++)
        to[c] = pixel[c];
}

static void read_pixels(Bytes *b, const TgaHeader *h, Bitmap *out)
{
    size_t count = (size_t)out->width * (size_t)out->height;
    uint8_t pixel[4] = {0};
    for (size_t i = 0; i < count && !b->is_short;) {
        unsigned packet = h->type & 8 ? byte_next(b) : 0;
        bool is_run = packet & 0x80;
        size_t length = (packet & 0x7f) + 1;
        for (size_t k = 0; k < length && i < count; k++, i++) {
            if (k == 0 || !is_run)
                read_pixel(b, h, out->channels, pixel);
            put_pixel(h, out, i, pixel);
        }
    }
}

static Status read_file(Diag *diag, const char *path, Arena *arena, Bitmap *out)
{
    Bytes b;
    TRY(bytes_open(diag, path, arena, &b));
    TgaHeader h = read_header(&b);
    unsigned kind = h.type % 8;
    bool is_known =
        h.type < 12 && (h.type & 4) == 0 &&
        ((kind == 2 && (h.depth == 15 || h.depth == 16 || h.depth == 24 || h.depth == 32)) ||
         ((kind == 1 || kind == 3) && h.depth == 8));
    bool is_map_known = h.map_count == 0 || (h.map_bits >= 15 && h.map_bits <= 32);
    if (!is_known || !is_map_known ||
        (kind == 1 && (h.map_count == 0 || h.map_count > PALETTE_MAX)))
        return bitmap_refuse(diag, path, "it is no Targa file of 8, 16, 24 or 32 bits");
    for (uint32_t i = 0; i < h.map_count; i++) {
        uint8_t color[4];
        read_color(&b, h.map_bits, color);
        for (int c = 0; i < PALETTE_MAX && c < 4; c++)
            out->palette[i][c] = color[c];
    }
    out->is_indexed = kind == 1;
    TRY(bitmap_begin(diag, path, out, h.width, h.height,
                     kind != 2       ? 1
                     : h.depth == 32 ? 4
                                     : 3,
                     8, b.size, h.type & 8 ? 256 : 2));
    read_pixels(&b, &h, out);
    return b.is_short ? bitmap_refuse(diag, path, "the file ends too early") : OK;
}

Status bitmap_read_tga(Diag *diag, const char *path, Bitmap *out)
{
    Arena *arena = arena_new();
    Status status = arena ? read_file(diag, path, arena, out) : diag_no_memory(diag, path);
    arena_free(arena);
    return status;
}
