/* PNG as it is: palettes stay palettes, grey stays grey, 16 bits stay 16.
 * SPDX-License-Identifier: Apache-2.0 */
#include "image/bitmap_int.h"
#include "image/png_int.h"

#include "base/mem.h"

#include <math.h>
#include <string.h>

/* Ask libpng for whole bytes and the machine's byte order. */
static void keep_samples(PngJob *job)
{
    if (png_get_color_type(job->png, job->info) == PNG_COLOR_TYPE_PALETTE)
        png_set_packing(job->png);
    else
        png_set_expand_gray_1_2_4_to_8(job->png);
    const uint16_t one = 1;
    if (*(const uint8_t *)&one)
        png_set_swap(job->png);
    png_set_interlace_handling(job->png);
    png_read_update_info(job->png, job->info);
}

static void take_palette(PngJob *job, Bitmap *out)
{
    png_colorp colors = NULL;
    png_bytep alphas = NULL;
    int color_count = 0, alpha_count = 0;
    png_get_PLTE(job->png, job->info, &colors, &color_count);
    png_get_tRNS(job->png, job->info, &alphas, &alpha_count, NULL);
    for (int i = 0; i < color_count && i < PALETTE_MAX; i++) {
        uint8_t *entry = out->palette[i];
        entry[0] = colors[i].red, entry[1] = colors[i].green, entry[2] = colors[i].blue;
        entry[3] = alphas && i < alpha_count ? alphas[i] : 255;
    }
}

static Status take_samples(PngJob *job, Bitmap *out)
{
    png_uint_32 width = png_get_image_width(job->png, job->info);
    png_uint_32 height = png_get_image_height(job->png, job->info);
    int channels = png_get_channels(job->png, job->info);
    int bits = png_get_bit_depth(job->png, job->info);
    size_t row_bytes = (size_t)width * (size_t)channels * (size_t)bits / 8;
    if ((bits != 8 && bits != 16) || png_get_rowbytes(job->png, job->info) != row_bytes)
        return bitmap_refuse(job->diag, job->path, "its samples have an unknown size");
    TRY(png_job_rows(job));
    out->is_indexed = png_get_color_type(job->png, job->info) == PNG_COLOR_TYPE_PALETTE;
    if (out->is_indexed)
        take_palette(job, out);
    out->gamma = png_job_gamma(job);
    TRY(bitmap_begin(job->diag, job->path, out, width, height, channels, bits, SIZE_MAX, 1));
    memcpy(out->samples, job->bytes, row_bytes * height);
    return OK;
}

Status bitmap_read_png(Diag *diag, const char *path, Bitmap *out)
{
    PngJob job = {.diag = diag, .path = path};
    Status status = png_job_begin(&job, keep_samples);
    if (status == OK)
        status = take_samples(&job, out);
    png_job_end(&job);
    return status;
}
