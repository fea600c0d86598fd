/* Portable maps: P1 to P6.  SPDX-License-Identifier: Apache-2.0 */
#include "image/bitmap_int.h"

/* Skip blanks and comments and read a number; false when there is none. */
static bool read_number(Bytes *b, long *out)
{
    unsigned c = byte_next(b);
    while (!b->is_short && (c == ' ' || (c >= '\t' && c <= '\r') || c == '#')) {
        while (c == '#' && !b->is_short && (c = byte_next(b)) != '\n')
            c = '#';
        c = byte_next(b);
    }
    long value = 0;
    if (c < '0' || c > '9')
        return false;
    for (; c >= '0' && c <= '9' && value < 100000000; c = byte_next(b))
        value = value * 10 + (c - '0');
    b->is_short = false; /* the last number may end the file */
    *out = value;
    return true;
}

/* Read one sample of a text or binary map, scaled to the sample's bits. */
static bool read_sample(Bytes *b, bool is_text, bool is_bit, long top, long scale, long *out)
{
    long value;
    if (is_text && is_bit) { /* the digits need no blanks between them */
        unsigned c;
        do
            c = byte_next(b);
        while (!b->is_short && (c == ' ' || (c >= '\t' && c <= '\r')));
        if (c != '0' && c != '1')
            return false;
        value = '1' - (long)c;
    } else if (is_text) {
        if (!read_number(b, &value))
            return false;
    } else {
        value = (long)byte_next(b);
        if (top > 255)
            value = value << 8 | (long)byte_next(b);
    }
    value = value < top ? value : top;
    *out = top == scale ? value : (value * scale + top / 2) / top;
    return true;
}

/* P4: eight pixels a byte, 1 is black. */
static void read_packed(Bytes *b, Bitmap *out)
{
    uint8_t *samples = out->samples;
    for (int y = 0; y < out->height; y++) {
        unsigned bits = 0;
        for (int x = 0; x < out->width; x++) {
            bits = x % 8 ? bits << 1 : byte_next(b);
            *samples++ = bits & 0x80 ? 0 : 255;
        }
    }
}

static Status read_samples(Diag *diag, const char *path, Bytes *b, int type, long top, Bitmap *out)
{
    long scale = out->bits == 8 ? 255 : 65535;
    bool is_text = type <= 3;
    if (type == 4)
        read_packed(b, out);
    size_t count = (size_t)out->width * (size_t)out->height * (size_t)out->channels;
    for (size_t i = 0; type != 4 && i < count; i++) {
        long value;
        if (!read_sample(b, is_text, type == 1, top, scale, &value))
            return bitmap_refuse(diag, path, "a number was wanted among its pixels");
        if (out->bits == 8)
            ((uint8_t *)out->samples)[i] = (uint8_t)value;
        else
            ((uint16_t *)out->samples)[i] = (uint16_t)value;
    }
    return b->is_short ? bitmap_refuse(diag, path, "the file ends too early") : OK;
}

static Status read_map(Diag *diag, const char *path, Arena *arena, Bitmap *out)
{
    Bytes b;
    TRY(bytes_open(diag, path, arena, &b));
    long width, height, top = 1;
    int type = byte_next(&b) == 'P' ? (int)byte_next(&b) - '0' : 0;
    if (type < 1 || type > 6)
        return bitmap_refuse(diag, path, "it is no portable map (P1 to P6)");
    if (!read_number(&b, &width) || !read_number(&b, &height) ||
        (type % 3 != 1 && !read_number(&b, &top)) || top < 1 || top > 65535)
        return bitmap_refuse(diag, path, "its header is broken");
    TRY(bitmap_begin(diag, path, out, width, height, type % 3 == 0 ? 3 : 1, top > 255 ? 16 : 8,
                     b.size, type % 3 == 1 ? 8 : 2));
    return read_samples(diag, path, &b, type, top, out);
}

Status bitmap_read_pnm(Diag *diag, const char *path, Bitmap *out)
{
    Arena *arena = arena_new();
    Status status = arena ? read_map(diag, path, arena, out) : diag_no_memory(diag, path);
    arena_free(arena);
    return status;
}
