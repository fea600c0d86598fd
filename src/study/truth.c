/* The picture that a study compares with.  SPDX-License-Identifier: Apache-2.0 */
#include "study/truth.h"

#include "base/file.h"
#include "base/mem.h"
#include "image/compare.h"
#include "image/exr.h"
#include "image/flip.h"
#include "image/percentile.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static size_t pixels_of(const Truth *truth)
{
    return (size_t)truth->width * (size_t)truth->height;
}

Status truth_init(Diag *diag, int width, int height, bool has_halves, Truth *out)
{
    *out =
        (Truth){.width = width, .height = height, .noise = {NAN, NAN, NAN, NAN}, .rel_blur2 = NAN};
    size_t size = 3 * sizeof(float);
    out->mean = mem_array(pixels_of(out), size);
    bool is_good = out->mean != NULL;
    for (int i = 0; i < 2 && has_halves; i++) {
        out->half[i] = mem_array(pixels_of(out), size);
        is_good = is_good && out->half[i];
    }
    if (is_good)
        return OK;
    truth_done(out);
    return diag_no_memory(diag, "the reference");
}

void truth_done(Truth *truth)
{
    mem_free(truth->mean);
    mem_free(truth->half[0]);
    mem_free(truth->half[1]);
    *truth = (Truth){0};
}

/* A grey image has its channel thrice. */
void truth_colours(const Image *image, float *out)
{
    const ImageLayer *layer = image_find_layer(image, "");
    size_t count = (size_t)image->width * (size_t)image->height;
    for (int c = 0; c < 3; c++) {
        int channel = layer ? image_channel(layer, "RGB"[c]) : -1;
        if (layer && channel < 0)
            channel = image_channel(layer, 'Y');
        for (size_t i = 0; i < count; i++)
            out[3 * i + (size_t)c] =
                channel < 0 ? NAN
                            : layer->pixels[i * (size_t)layer->channel_count + (size_t)channel];
    }
}

/* --- comparing ------------------------------------------------------------------------------ */

/* The mean of products, plain and relative to the truth, over what is finite. */
static TruthError mean_product(const Truth *truth, const float *const a[2], const float *const b[2])
{
    double square = 0, rel_square = 0;
    size_t used = 0;
    for (size_t i = 0; i < 3 * pixels_of(truth); i++) {
        double at = (double)truth->mean[i];
        double product = ((double)a[0][i] - (double)a[1][i]) * ((double)b[0][i] - (double)b[1][i]);
        if (!isfinite(product) || !isfinite(at))
            continue;
        used++;
        square += product;
        rel_square += product / (at * at + COMPARE_REL_EPSILON);
    }
    double scale = used ? 1 / (double)used : 0;
    return (TruthError){.square = square * scale, .rel_square = rel_square * scale};
}

double truth_common(const Truth *truth, const float *const a[2], const float *const b[2])
{
    return mean_product(truth, a, b).rel_square;
}

/* FLIP of a picture, what is not finite being left as the truth has it. */
static Status find_flip(Diag *diag, const Truth *truth, const float *colours, double *out)
{
    size_t count = pixels_of(truth);
    float *test = mem_array(count, 3 * sizeof *test), *map = mem_array(count, sizeof *map);
    bool is_good = test && map;
    for (size_t i = 0; is_good && i < 3 * count; i++)
        test[i] = isfinite(colours[i]) ? colours[i] : truth->mean[i];
    is_good = is_good && flip_map(truth->mean, test, truth->width, truth->height, false, map);
    double sum = 0;
    for (size_t i = 0; is_good && i < count; i++)
        sum += (double)map[i];
    *out = sum / (double)count;
    mem_free(test);
    mem_free(map);
    return is_good ? OK : diag_no_memory(diag, "a comparison");
}

/* Find the errors that are not means of products. */
static Status find_seen(Diag *diag, const Truth *truth, const float *colours, TruthError *out)
{
    if (!error_between(colours, truth->mean, pixels_of(truth), &out->percentile))
        return diag_no_memory(diag, "a comparison");
    return find_flip(diag, truth, colours, &out->flip);
}

Status truth_settle(Diag *diag, Truth *truth)
{
    if (!truth->half[0])
        return OK;
    for (size_t i = 0; i < 3 * pixels_of(truth); i++)
        truth->mean[i] = (truth->half[0][i] + truth->half[1][i]) / 2;
    for (size_t i = 0; i < 3 * pixels_of(truth); i++) /* FLIP takes only numbers */
        truth->mean[i] = isfinite(truth->mean[i]) ? truth->mean[i] : 0;
    const float *apart[2] = {truth->half[0], truth->half[1]};
    truth->noise = mean_product(truth, apart, apart);
    truth->noise.square /= 4;
    truth->noise.rel_square /= 4;
    return find_seen(diag, truth, truth->half[0], &truth->noise);
}

Status truth_compare(Diag *diag, const Truth *truth, const Image *image, TruthError *out)
{
    float *colours = mem_array(pixels_of(truth), 3 * sizeof *colours);
    if (!colours)
        return diag_no_memory(diag, "a comparison");
    truth_colours(image, colours);
    bool has_halves = truth->half[0] != NULL;
    const float *a[2] = {colours, has_halves ? truth->half[0] : truth->mean};
    const float *b[2] = {colours, has_halves ? truth->half[1] : truth->mean};
    *out = mean_product(truth, a, b);
    Status status = find_seen(diag, truth, colours, out);
    mem_free(colours);
    return status;
}

/* --- on disk -------------------------------------------------------------------------------- */

static const char *const names[] = {"reference.exr", "reference_a.exr", "reference_b.exr"};

static Status save(Diag *diag, const Truth *truth, const float *colours, const char *path)
{
    Image image;
    image_init(&image, truth->width, truth->height);
    ImageLayer *layer = image_add_layer(&image, "", "RGB");
    Status status = layer ? OK : diag_no_memory(diag, path);
    if (layer) {
        memcpy(layer->pixels, colours, pixels_of(truth) * 3 * sizeof *colours);
        status = exr_write(diag, path, &image, NULL, (ExrOptions){0});
    }
    image_done(&image);
    return status;
}

Status truth_save(Diag *diag, const Truth *truth, const char *folder)
{
    const float *colours[] = {truth->mean, truth->half[0], truth->half[1]};
    char path[FILE_PATH_MAX];
    for (int i = 0; i < 3; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        if (colours[i])
            TRY(save(diag, truth, colours[i], path));
    }
    return OK;
}

static Status load(Diag *diag, const char *path, const Truth *truth, float *colours)
{
    Image image;
    TRY(image_load(diag, path, &image));
    Status status = OK;
    if (image.width != truth->width || image.height != truth->height)
        status = diag_fail(diag, ERR_USAGE, "'%s' is of %dx%d pixels, the study of %dx%d", path,
                           image.width, image.height, truth->width, truth->height);
    else if (image.is_display)
        status =
            diag_fail(diag, ERR_USAGE,
                      "'%s' holds display values; a reference wants linear light, an EXR", path);
    else
        truth_colours(&image, colours);
    image_done(&image);
    return status;
}

Status truth_load(Diag *diag, const char *folder, int width, int height, Truth *out, bool *is_there)
{
    char path[FILE_PATH_MAX];
    snprintf(path, sizeof path, "%s/%s", folder, names[2]);
    *is_there = file_exists(path);
    TRY(truth_init(diag, width, height, true, out));
    for (int i = 0; i < 2 && *is_there; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, names[i + 1]);
        Status status = load(diag, path, out, out->half[i]);
        if (status != OK) {
            truth_done(out);
            return status;
        }
    }
    return OK;
}

Status truth_load_file(Diag *diag, const char *path, int width, int height, Truth *out)
{
    TRY(truth_init(diag, width, height, false, out));
    Status status = load(diag, path, out, out->mean);
    for (size_t i = 0; status == OK && i < 3 * pixels_of(out); i++)
        if (!isfinite(out->mean[i]))
            status = diag_fail(diag, ERR_USAGE,
                               "'%s' has pixels that are no colours: it is no reference", path);
    if (status != OK)
        truth_done(out);
    snprintf(out->method, sizeof out->method, "a picture that was given");
    return status;
}
