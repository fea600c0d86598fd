/* Radiance pictures: RGB with a shared exponent, plain or run-length coded.
 * SPDX-License-Identifier: Apache-2.0 */
#include "image/bitmap_int.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { RUN_WIDTH_MIN = 8, RUN_WIDTH_MAX = 0x7fff }; /* rows the newer code of runs fits */

/* Read a line of the header, without its end; false at the end of the file. */
static bool read_line(Bytes *b, char *out, size_t size)
{
    size_t length = 0;
    for (;;) {
        unsigned c = byte_next(b);
        if (b->is_short)
            return false;
        if (c == '\n')
            break;
        if (length + 1 < size)
            out[length++] = (char)c;
    }
    out[length] = 0;
    return true;
}

/* Read one row of the newer code: the four bytes of all pixels one after another, in runs. */
static bool read_run_row(Bytes *b, size_t width, uint8_t *row)
{
    for (int c = 0; c < 4; c++) {
        for (size_t x = 0; x < width;) {
            unsigned count = byte_next(b);
            bool is_run = count > 128;
            count = is_run ? count - 128 : count;
            if (b->is_short || count == 0 || count > width - x)
                return false;
            unsigned value = is_run ? byte_next(b) : 0;
            for (; count > 0; count--)
                row[4 * x++ + (size_t)c] = (uint8_t)(is_run ? value : byte_next(b));
        }
    }
    return true;
}

/* Read one row of the older code: pixels; (1, 1, 1, n) repeats the one before. */
static bool read_plain_row(Bytes *b, size_t width, uint8_t *row)
{
    unsigned shift = 0;
    for (size_t x = 0; x < width;) {
        uint8_t pixel[4];
        for (int c = 0; c < 4; c++)
            pixel[c] = (uint8_t)byte_next(b);
        if (b->is_short)
            return false;
        if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
            memcpy(row + 4 * x++, pixel, 4);
            shift = 0;
            continue;
        }
        size_t count = shift < 24 ? (size_t)pixel[3] << shift : 0;
        if (x == 0 || count > width - x)
            return false;
        for (; count > 0; count--, x++)
            memcpy(row + 4 * x, row + 4 * x - 4, 4);
        shift += 8;
    }
    return true;
}

static bool read_row(Bytes *b, size_t width, uint8_t *row)
{
    bool has_runs = width >= RUN_WIDTH_MIN && width <= RUN_WIDTH_MAX && b->end - b->at >= 4 &&
                    b->at[0] == 2 && b->at[1] == 2 && (size_t)(b->at[2] << 8 | b->at[3]) == width;
    if (!has_runs)
        return read_plain_row(b, width, row);
    bytes_skip(b, 4);
    return read_run_row(b, width, row);
}

static Status read_file(Diag *diag, const char *path, Arena *arena, Bitmap *out)
{
    Bytes b;
    char line[256];
    int width = 0, height = 0;
    TRY(bytes_open(diag, path, arena, &b));
    bool is_read = read_line(&b, line, sizeof line) && strncmp(line, "#?", 2) == 0;
    while (is_read && read_line(&b, line, sizeof line) && line[0])
        if (strncmp(line, "FORMAT=", 7) == 0)
            is_read = strcmp(line + 7, "32-bit_rle_rgbe") == 0;
    if (!is_read || !read_line(&b, line, sizeof line) ||
        sscanf(line, "-Y %d +X %d", &height, &width) != 2)
        return bitmap_refuse(diag, path, "it is no Radiance picture of RGB, top row first");
    TRY(bitmap_begin(diag, path, out, width, height, 3, 32, b.size, 512));
    uint8_t *row = arena_array(arena, (size_t)width, 4);
    if (!row)
        return diag_no_memory(diag, path);
    float *to = out->samples;
    for (int y = 0; y < height; y++) {
        if (!read_row(&b, (size_t)width, row))
            return bitmap_refuse(diag, path, "the file is broken or ends too early");
        for (int x = 0; x < width; x++)
            for (int c = 0; c < 3; c++)
                *to++ = row[4 * x + 3] ? ldexpf((float)row[4 * x + c], row[4 * x + 3] - 136) : 0;
    }
    return OK;
}

Status bitmap_read_hdr(Diag *diag, const char *path, Bitmap *out)
{
    Arena *arena = arena_new();
    Status status = arena ? read_file(diag, path, arena, out) : diag_no_memory(diag, path);
    arena_free(arena);
    return status;
}
