/* GIF, through giflib: the first picture of the file, as indices.
 * SPDX-License-Identifier: Apache-2.0 */
#include "image/bitmap_int.h"

#include "base/mem.h"

#include <gif_lib.h>
#include <string.h>

/* A code of LZW stands for at most 4096 pixels and has at least 3 bits. */
#define GIF_RATIO_MAX (4096 * 8 / 3.0)

static int read_bytes(GifFileType *gif, GifByteType *to, int count)
{
    Bytes *b = gif->UserData;
    size_t left = (size_t)(b->end - b->at), taken = (size_t)count < left ? (size_t)count : left;
    memcpy(to, b->at, taken);
    b->at += taken;
    return (int)taken;
}

/* Go on to the first picture; remembers which index is transparent (-1: none). */
static bool find_picture(GifFileType *gif, int *transparent)
{
    GifRecordType type;
    *transparent = NO_TRANSPARENT_COLOR;
    while (DGifGetRecordType(gif, &type) == GIF_OK && type != TERMINATE_RECORD_TYPE) {
        if (type == IMAGE_DESC_RECORD_TYPE)
            return DGifGetImageDesc(gif) == GIF_OK;
        if (type != EXTENSION_RECORD_TYPE)
            continue;
        int code;
        GifByteType *block;
        if (DGifGetExtension(gif, &code, &block) != GIF_OK)
            return false;
        while (block) {
            GraphicsControlBlock control;
            if (code == GRAPHICS_EXT_FUNC_CODE && block[0] >= 4 &&
                DGifExtensionToGCB(block[0], block + 1, &control) == GIF_OK)
                *transparent = control.TransparentColor;
            if (DGifGetExtensionNext(gif, &block) != GIF_OK)
                return false;
        }
    }
    return false;
}

/* Read the rows of the picture, which may come in four passes. */
static bool read_rows(GifFileType *gif, Bitmap *out)
{
    static const int first[4] = {0, 4, 2, 1}, step[4] = {8, 8, 4, 2};
    for (int pass = 0; pass < (gif->Image.Interlace ? 4 : 1); pass++) {
        int y = gif->Image.Interlace ? first[pass] : 0, by = gif->Image.Interlace ? step[pass] : 1;
        for (; y < out->height; y += by)
            if (DGifGetLine(gif, (uint8_t *)out->samples + (size_t)y * (size_t)out->width,
                            out->width) != GIF_OK)
                return false;
    }
    return true;
}

static Status read_picture(Diag *diag, const char *path, GifFileType *gif, size_t bytes,
                           Bitmap *out)
{
    int transparent;
    if (!find_picture(gif, &transparent))
        return bitmap_refuse(diag, path, "it has no picture");
    TRY(bitmap_begin(diag, path, out, gif->Image.Width, gif->Image.Height, 1, 8, bytes,
                     GIF_RATIO_MAX));
    out->is_indexed = true;
    if (!read_rows(gif, out))
        return bitmap_refuse(diag, path, "the file is broken or ends too early");
    const ColorMapObject *colors = gif->Image.ColorMap ? gif->Image.ColorMap : gif->SColorMap;
    for (int i = 0; colors && i < colors->ColorCount && i < PALETTE_MAX; i++) {
        const GifColorType *c = &colors->Colors[i];
        const uint8_t entry[4] = {c->Red, c->Green, c->Blue, i == transparent ? 0 : 255};
        memcpy(out->palette[i], entry, sizeof entry);
    }
    return OK;
}

Status bitmap_read_gif(Diag *diag, const char *path, Bitmap *out)
{
    Bytes bytes;
    Arena *arena = arena_new();
    if (!arena)
        return diag_no_memory(diag, path);
    Status status = bytes_open(diag, path, arena, &bytes);
    if (status == OK) {
        int error;
        GifFileType *gif = DGifOpen(&bytes, read_bytes, &error);
        status = gif ? read_picture(diag, path, gif, bytes.size, out)
                     : bitmap_refuse(diag, path, "it is no GIF file");
        if (gif)
            DGifCloseFile(gif, &error);
    }
    arena_free(arena);
    return status;
}
