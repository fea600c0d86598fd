/* Pictures on the page: made small, PNG, and written as text into the page itself.
 * SPDX-License-Identifier: Apache-2.0 */
#include "study/report_int.h"

#include "base/mem.h"
#include "image/compare.h"
#include "image/ocio.h"
#include "image/png_file.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

/* No wider than this, pixels; larger pictures are made smaller by a whole factor. */
enum { THUMBNAIL_WIDTH = 400, PNG_BYTES_MAX = 16 << 20 };

/* RGB triples of a picture that is being made small. */
typedef struct Small {
    int width, height;
    float *rgb;
} Small;

static Status shrink(Diag *diag, const float *rgb, int width, int height, Small *out)
{
    int step = (width + THUMBNAIL_WIDTH - 1) / THUMBNAIL_WIDTH;
    *out = (Small){width / step, height / step > 0 ? height / step : 1, NULL};
    out->rgb = mem_array((size_t)out->width * (size_t)out->height, 3 * sizeof(float));
    if (!out->rgb)
        return diag_no_memory(diag, "a thumbnail");
    int rows = height < step ? height : step;
    float scale = 1 / (float)(step * rows);
    for (int y = 0; y < out->height * rows; y++) {
        for (int x = 0; x < out->width * step; x++) {
            size_t to = (size_t)(y / rows) * (size_t)out->width + (size_t)(x / step);
            size_t from = (size_t)y * (size_t)width + (size_t)x;
            for (size_t c = 0; c < 3; c++)
                out->rgb[3 * to + c] += scale * rgb[3 * from + c];
        }
    }
    return OK;
}

static void print_base64(FILE *file, const unsigned char *bytes, size_t size)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (size_t i = 0; i < size; i += 3) {
        size_t left = size - i;
        unsigned word = (unsigned)bytes[i] << 16;
        word |= left > 1 ? (unsigned)bytes[i + 1] << 8 : 0;
        word |= left > 2 ? (unsigned)bytes[i + 2] : 0;
        fputc(digits[word >> 18], file);
        fputc(digits[word >> 12 & 63], file);
        fputc(left > 1 ? digits[word >> 6 & 63] : '=', file);
        fputc(left > 2 ? digits[word & 63] : '=', file);
    }
}

static Status print_png(FILE *file, const Study *study, const Small *small, const char *alt)
{
    StudyPath path = study_path(study, "thumbnail.png");
    const char *bytes;
    size_t size;
    TRY(png_write(study->diag, path.text, small->width, small->height, 3, small->rgb, 8, true,
                  NULL));
    Status status = file_read(study->diag, path.text, PNG_BYTES_MAX, study->arena, &bytes, &size);
    unlink(path.text);
    if (status != OK)
        return status;
    fprintf(file, "<img width=\"%d\" height=\"%d\" alt=\"", small->width, small->height);
    html_text(file, alt);
    fputs("\" src=\"data:image/png;base64,", file);
    print_base64(file, (const unsigned char *)bytes, size);
    fputs("\">", file);
    return OK;
}

/* Make a picture small, bring it to the display (NULL: it is for one), and print it. */
static Status print_small(FILE *file, const Study *study, const float *rgb, const ReportLook *look,
                          const char *alt)
{
    Small small;
    Ocio *ocio = NULL;
    TRY(shrink(study->diag, rgb, study->truth.width, study->truth.height, &small));
    size_t count = (size_t)small.width * (size_t)small.height;
    Status status = look ? ocio_new(study->diag, look->ocio_config, &ocio) : OK;
    if (status == OK && look)
        status = ocio_apply(study->diag, ocio, look->display, look->view, small.rgb, count, 3);
    if (status == OK)
        status = print_png(file, study, &small, alt);
    ocio_free(ocio);
    mem_free(small.rgb);
    return status;
}

/* Load a point's picture. */
static Status load_picture(const Study *study, const StudyPoint *point, Image *image)
{
    StudyPath path = study_picture_path(study, point);
    TRY(image_load(study->diag, path.text, image));
    if (image->width == study->truth.width && image->height == study->truth.height)
        return OK;
    image_done(image);
    return diag_fail(study->diag, ERR_FILE, "'%s' is damaged: its size is not the study's",
                     path.text);
}

/* Load the colours of a point's picture; *out is the caller's. */
static Status load_colours(const Study *study, const StudyPoint *point, float **out)
{
    Image image;
    TRY(load_picture(study, point, &image));
    *out = mem_array((size_t)image.width * (size_t)image.height, 3 * sizeof **out);
    if (*out)
        truth_colours(&image, *out);
    image_done(&image);
    return *out ? OK : diag_no_memory(study->diag, "a thumbnail");
}

Status thumbnail_print(FILE *file, const Study *study, const StudyPoint *point,
                       const ReportLook *look, const char *alt)
{
    float *colours;
    if (!point)
        return print_small(file, study, study->truth.mean, look, alt);
    TRY(load_colours(study, point, &colours));
    Status status = print_small(file, study, colours, look, alt);
    mem_free(colours);
    return status;
}

/* The reference as an image, for image_flip. */
static Status reference_image(const Study *study, Image *out)
{
    const Truth *truth = &study->truth;
    image_init(out, truth->width, truth->height);
    ImageLayer *layer = image_add_layer(out, "", "RGB");
    if (!layer)
        return diag_no_memory(study->diag, "a thumbnail");
    memcpy(layer->pixels, truth->mean,
           (size_t)truth->width * (size_t)truth->height * 3 * sizeof *truth->mean);
    return OK;
}

Status thumbnail_print_error(FILE *file, const Study *study, const StudyPoint *point,
                             const char *alt)
{
    Image image, reference, heat = {0};
    TRY(load_picture(study, point, &image));
    Status status = reference_image(study, &reference);
    if (status == OK)
        status = image_flip(study->diag, &image, &reference, &heat);
    if (status == OK)
        status = print_small(file, study, image_find_layer(&heat, "")->pixels, NULL, alt);
    image_done(&heat);
    image_done(&reference);
    image_done(&image);
    return status;
}
