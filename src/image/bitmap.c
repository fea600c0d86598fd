/* Image files: which reader, memory, and what they share.
 * SPDX-License-Identifier: Apache-2.0 */
#include "image/bitmap_int.h"

#include "base/file.h"
#include "base/mem.h"
#include "image/exr.h"

#include <string.h>
#include <strings.h>

enum { FILE_BYTES_MAX = 1 << 30 };

/* Samples one image may have: 4 GB of floats. */
#define SAMPLES_MAX ((double)(1 << 30))

BitmapKind bitmap_kind_of(const char *path)
{
    static const struct {
        const char *extension;
        BitmapKind kind;
    } table[] = {{"png", BITMAP_PNG}, {"jpg", BITMAP_JPEG}, {"jpeg", BITMAP_JPEG},
                 {"gif", BITMAP_GIF}, {"tif", BITMAP_TIFF}, {"tiff", BITMAP_TIFF},
                 {"pgm", BITMAP_PNM}, {"ppm", BITMAP_PNM},  {"pbm", BITMAP_PNM},
                 {"tga", BITMAP_TGA}, {"bmp", BITMAP_BMP},  {"exr", BITMAP_EXR},
                 {"hdr", BITMAP_HDR}};
    const char *extension = path_extension(path);
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++)
        if (strcasecmp(extension, table[i].extension) == 0)
            return table[i].kind;
    return BITMAP_KIND_COUNT;
}

Status bitmap_refuse(Diag *diag, const char *path, const char *what)
{
    return diag_fail(diag, ERR_FILE, "cannot read '%s': %s", path, what);
}

Status bitmap_begin(Diag *diag, const char *path, Bitmap *b, long long width, long long height,
                    int channels, int bits, size_t bytes, double ratio)
{
    if (width < 1 || height < 1 || width > IMAGE_SIDE_MAX || height > IMAGE_SIDE_MAX)
        return diag_fail(diag, ERR_FILE, "cannot read '%s': it is %lld by %lld pixels (limit %d)",
                         path, width, height, IMAGE_SIDE_MAX);
    double samples = (double)width * (double)height * channels;
    if (samples > SAMPLES_MAX)
        return bitmap_refuse(diag, path, "it has more than 2^30 samples");
    if (samples * bits / 8 > ratio * (double)bytes)
        return bitmap_refuse(diag, path, "the file ends too early");
    b->width = (int)width;
    b->height = (int)height;
    b->channels = channels;
    b->bits = bits;
    b->samples = mem_array((size_t)samples, (size_t)bits / 8);
    return b->samples ? OK : diag_no_memory(diag, path);
}

Status bytes_open(Diag *diag, const char *path, Arena *arena, Bytes *out)
{
    const char *text;
    size_t size;
    TRY(file_read(diag, path, FILE_BYTES_MAX, arena, &text, &size));
    *out = (Bytes){(const uint8_t *)text, (const uint8_t *)text + size, size, false};
    return OK;
}

/* Keep the beauty of an EXR, whatever of R, G, B, A and Y it has. */
Status bitmap_read_exr(Diag *diag, const char *path, Bitmap *out)
{
    Image image;
    TRY(exr_read(diag, path, &image));
    const ImageLayer *layer = image_find_layer(&image, "");
    if (!layer && image.layer_count)
        layer = &image.layers[0];
    Status status = layer ? OK : bitmap_refuse(diag, path, "it has no channels");
    int place[4], count = 0;
    static const char wanted[] = "RGBA";
    for (int i = 0; layer && i < 4; i++)
        if (image_channel(layer, wanted[i]) >= 0)
            place[count++] = image_channel(layer, wanted[i]);
    if (count < 3)
        place[0] = 0, count = 1;
    if (status == OK)
        status = bitmap_begin(diag, path, out, image.width, image.height, count, 32, SIZE_MAX, 1);
    float *to = out->samples;
    for (size_t i = 0; status == OK && i < (size_t)image.width * (size_t)image.height; i++)
        for (int c = 0; c < count; c++)
            *to++ = layer->pixels[i * (size_t)layer->channel_count + (size_t)place[c]];
    image_done(&image);
    return status;
}

Status bitmap_read(Diag *diag, const char *path, BitmapKind kind, Bitmap *out)
{
    static Status (*const readers[BITMAP_KIND_COUNT])(Diag *, const char *, Bitmap *) = {
        [BITMAP_PNG] = bitmap_read_png, [BITMAP_JPEG] = bitmap_read_jpeg,
        [BITMAP_GIF] = bitmap_read_gif, [BITMAP_TIFF] = bitmap_read_tiff,
        [BITMAP_PNM] = bitmap_read_pnm, [BITMAP_TGA] = bitmap_read_tga,
        [BITMAP_BMP] = bitmap_read_bmp, [BITMAP_EXR] = bitmap_read_exr,
        [BITMAP_HDR] = bitmap_read_hdr,
    };
    *out = (Bitmap){.kind = kind};
    if (kind >= BITMAP_KIND_COUNT)
        return bitmap_refuse(diag, path, "its extension is that of no kind of image");
    Status status = readers[kind](diag, path, out);
    if (status != OK)
        bitmap_done(out);
    return status;
}

void bitmap_done(Bitmap *bitmap)
{
    mem_free(bitmap->samples);
    bitmap->samples = NULL;
}
