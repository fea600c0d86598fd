/* Error metrics between two images.
 *
 * Both beauty layers are first brought to three planar channels in one encoding; everything
 * else works on these.  SPDX-License-Identifier: Apache-2.0 */
#include "image/compare.h"

#include "base/file.h"
#include "base/mem.h"
#include "image/compare_int.h"
#include "image/exr.h"
#include "image/flip.h"
#include "image/percentile.h"
#include "image/png_file.h"
#include "image/ssim_int.h"
#include "image/srgb.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

static const ImageLayer *beauty_of(const Image *image)
{
    const ImageLayer *layer = image_find_layer(image, "");
    bool has_colour = layer && (image_channel(layer, 'Y') >= 0 ||
                                (image_channel(layer, 'R') >= 0 && image_channel(layer, 'G') >= 0 &&
                                 image_channel(layer, 'B') >= 0));
    return has_colour ? layer : NULL;
}

static float clip(float v)
{
    return v < 0 ? 0 : v > 1 ? 1 : v; /* NaN stays */
}

static float encode(float v)
{
    return srgb_encode(clip(v));
}

/* A display image's colours are not premultiplied: lay them over black, in light. */
static float over_black(float v, float alpha)
{
    return alpha >= 1 ? v : srgb_encode(srgb_decode(v) * alpha);
}

/* Copy the colours of an image; grey images become colours. */
static Status extract(Diag *diag, const Image *image, bool to_display, float **out)
{
    const ImageLayer *layer = beauty_of(image);
    if (!layer)
        return diag_fail(diag, ERR_USAGE, "an image without R, G and B cannot be compared");
    size_t count = (size_t)image->width * (size_t)image->height;
    float *rgb = *out = mem_array(count, 3 * sizeof *rgb);
    if (!rgb)
        return diag_no_memory(diag, "a comparison");
    bool is_grey = image_channel(layer, 'R') < 0;
    int alpha = image->is_display ? image_channel(layer, 'A') : -1;
    for (int c = 0; c < 3; c++) {
        const float *from = layer->pixels + image_channel(layer, is_grey ? 'Y' : "RGB"[c]);
        const float *a = alpha < 0 ? NULL : layer->pixels + alpha;
        for (size_t i = 0; i < count; i++) {
            size_t at = i * (size_t)layer->channel_count;
            float v = a ? over_black(from[at], a[at]) : from[at];
            rgb[3 * i + (size_t)c] = to_display && !image->is_display ? encode(v) : v;
        }
    }
    return OK;
}

Status colour_pair_init(Diag *diag, const Image *a, const Image *b, ColourPair *out)
{
    *out = (ColourPair){.width = a->width, .height = a->height};
    if (a->width != b->width || a->height != b->height)
        return diag_fail(diag, ERR_USAGE, "the images differ in size: %dx%d and %dx%d", a->width,
                         a->height, b->width, b->height);
    out->pixels = (size_t)a->width * (size_t)a->height;
    out->is_display = a->is_display || b->is_display;
    Status status = extract(diag, a, out->is_display, &out->a);
    if (status == OK)
        status = extract(diag, b, out->is_display, &out->b);
    if (status != OK)
        colour_pair_done(out);
    return status;
}

void colour_pair_done(ColourPair *pair)
{
    mem_free(pair->a);
    mem_free(pair->b);
    *pair = (ColourPair){0};
}

static bool is_finite_pixel(const float *rgb)
{
    return isfinite(rgb[0]) && isfinite(rgb[1]) && isfinite(rgb[2]);
}

static double light_of(float v, bool is_display)
{
    return (double)(is_display ? srgb_decode(v) : v);
}

static void sum_errors(const ColourPair *pair, CompareResult *out)
{
    const float *a = pair->a, *b = pair->b;
    double squares = 0, sum = 0, relative = 0, mean_a = 0, mean_b = 0, light_a = 0, light_b = 0;
    size_t used = 0;
    for (size_t i = 0; i < pair->pixels; i++, a += 3, b += 3) {
        bool is_good_a = is_finite_pixel(a), is_good_b = is_finite_pixel(b);
        out->bad_a += !is_good_a;
        out->bad_b += !is_good_b;
        if (!is_good_a || !is_good_b)
            continue;
        used += 3;
        for (int c = 0; c < 3; c++) {
            double va = a[c], vb = b[c], d = va - vb;
            squares += d * d;
            sum += fabs(d);
            relative += d * d / (vb * vb + COMPARE_REL_EPSILON);
            out->max_error = fmax(out->max_error, fabs(d));
            mean_a += va;
            mean_b += vb;
            light_a += light_of(a[c], out->is_display);
            light_b += light_of(b[c], out->is_display);
        }
    }
    double scale = used ? 1 / (double)used : 0;
    out->rmse = sqrt(squares * scale);
    out->mae = sum * scale;
    out->rel_mse = relative * scale;
    out->psnr = squares > 0 ? -10 * log10(squares * scale) : INFINITY;
    out->mean_a = mean_a * scale;
    out->mean_b = mean_b * scale;
    out->light_a = light_a * scale;
    out->light_b = light_b * scale;
}

/* Linear colours; of display values, decoded. */
static void decode_light(const float *rgb, const ColourPair *pair, float *out)
{
    for (size_t i = 0; i < 3 * pair->pixels; i++)
        out[i] = (float)light_of(rgb[i], pair->is_display);
}

static Status find_error95(Diag *diag, const ColourPair *pair, double *out)
{
    float *light = mem_array(pair->pixels, 6 * sizeof *light);
    bool is_done = light != NULL;
    if (is_done) {
        decode_light(pair->a, pair, light);
        decode_light(pair->b, pair, light + 3 * pair->pixels);
        is_done = error_between(light, light + 3 * pair->pixels, pair->pixels, out);
    }
    mem_free(light);
    return is_done ? OK : diag_no_memory(diag, "a comparison");
}

static bool is_good_pixel(const ColourPair *pair, size_t i)
{
    return is_finite_pixel(pair->a + 3 * i) && is_finite_pixel(pair->b + 3 * i);
}

/* Return the display-encoded luma of each pixel; what cannot be compared is black in both. */
static void luma_of(const float *rgb, const ColourPair *pair, float *luma)
{
    static const float weight[3] = {0.2126f, 0.7152f, 0.0722f};
    for (size_t i = 0; i < pair->pixels; i++) {
        const float *p = rgb + 3 * i;
        luma[i] = 0;
        if (!is_good_pixel(pair, i))
            continue;
        for (int c = 0; c < 3; c++)
            luma[i] += weight[c] * (pair->is_display ? clip(p[c]) : encode(p[c]));
    }
}

static Status find_ssim(Diag *diag, const ColourPair *pair, double *ssim)
{
    float *luma = mem_array(pair->pixels, 2 * sizeof *luma);
    if (!luma)
        return diag_no_memory(diag, "a comparison");
    luma_of(pair->a, pair, luma);
    luma_of(pair->b, pair, luma + pair->pixels);
    bool is_done = ssim_mean(luma, luma + pair->pixels, pair->width, pair->height, ssim);
    mem_free(luma);
    return is_done ? OK : diag_no_memory(diag, "a comparison");
}

/* Linear colours for FLIP; what cannot be compared is black in both. */
static void light_for_flip(const float *rgb, const ColourPair *pair, float *out)
{
    for (size_t i = 0; i < pair->pixels; i++) {
        bool is_good = is_good_pixel(pair, i);
        for (size_t c = 3 * i; c < 3 * i + 3; c++) {
            float v = is_good ? rgb[c] : 0;
            out[c] = pair->is_display ? srgb_decode(clip(v)) : v;
        }
    }
}

/* Fill `map` with a value a pixel. */
static Status fill_flip(Diag *diag, const ColourPair *pair, float *map)
{
    float *light = mem_array(pair->pixels, 6 * sizeof *light);
    if (!light)
        return diag_no_memory(diag, "a comparison");
    float *test = light + 3 * pair->pixels;
    light_for_flip(pair->b, pair, light);
    light_for_flip(pair->a, pair, test);
    bool is_done = flip_map(light, test, pair->width, pair->height, pair->is_display, map);
    mem_free(light);
    return is_done ? OK : diag_no_memory(diag, "a comparison");
}

/* Show a value a pixel as heat. */
static Status paint_map(Diag *diag, const ColourPair *pair, const float *map, Image *out)
{
    image_init(out, pair->width, pair->height);
    out->is_display = true;
    ImageLayer *layer = image_add_layer(out, "", "RGB");
    if (!layer) {
        image_done(out);
        return diag_no_memory(diag, "a difference image");
    }
    for (size_t i = 0; i < pair->pixels; i++)
        image_heat(map[i], layer->pixels + 3 * i);
    return OK;
}

/* Find FLIP's mean, and the picture of it unless `out` is NULL. */
static Status find_flip(Diag *diag, const ColourPair *pair, double *mean, Image *out)
{
    float *map = mem_array(pair->pixels, sizeof *map);
    if (!map)
        return diag_no_memory(diag, "a comparison");
    Status status = fill_flip(diag, pair, map);
    if (status == OK) {
        double sum = 0;
        for (size_t i = 0; i < pair->pixels; i++)
            sum += (double)map[i];
        *mean = sum / (double)pair->pixels;
        if (out)
            status = paint_map(diag, pair, map, out);
    }
    mem_free(map);
    return status;
}

Status image_compare(Diag *diag, const Image *a, const Image *reference, CompareResult *out)
{
    return image_compare_flip(diag, a, reference, out, NULL);
}

Status image_compare_flip(Diag *diag, const Image *a, const Image *reference, CompareResult *out,
                          Image *flip)
{
    ColourPair pair;
    *out = (CompareResult){0};
    if (flip)
        *flip = (Image){0};
    TRY(colour_pair_init(diag, a, reference, &pair));
    out->is_display = pair.is_display;
    sum_errors(&pair, out);
    Status status = find_ssim(diag, &pair, &out->ssim);
    if (status == OK)
        status = find_error95(diag, &pair, &out->error95);
    if (status == OK)
        status = find_flip(diag, &pair, &out->flip, flip);
    colour_pair_done(&pair);
    return status;
}

static void subtract(const float *a, const float *b, size_t pixels, float gain, float *out)
{
    static const float bad[3] = {1, 0, 1};
    for (size_t i = 0; i < pixels; i++, a += 3, b += 3, out += 3) {
        bool is_good = is_finite_pixel(a) && is_finite_pixel(b);
        for (int c = 0; c < 3; c++)
            out[c] = is_good ? gain * fabsf(a[c] - b[c]) : bad[c];
    }
}

Status image_difference(Diag *diag, const Image *a, const Image *b, float gain, Image *out)
{
    ColourPair pair;
    *out = (Image){0};
    TRY(colour_pair_init(diag, a, b, &pair));
    image_init(out, a->width, a->height);
    out->is_display = pair.is_display;
    ImageLayer *layer = image_add_layer(out, "", "RGB");
    if (layer)
        subtract(pair.a, pair.b, pair.pixels, gain, layer->pixels);
    else
        image_done(out);
    colour_pair_done(&pair);
    return layer ? OK : diag_no_memory(diag, "a difference image");
}

void image_heat(float x, float out[3])
{
    static const float stops[][3] = {{0.001f, 0, 0.014f},
                                     {0.317f, 0.072f, 0.485f},
                                     {0.716f, 0.215f, 0.475f},
                                     {0.987f, 0.536f, 0.382f},
                                     {0.987f, 0.991f, 0.75f}};
    const int last = sizeof stops / sizeof *stops - 1;
    float place = clip(x) * (float)last;
    int i = place < (float)last ? (int)place : last - 1;
    for (int c = 0; c < 3; c++)
        out[c] = stops[i][c] + (place - (float)i) * (stops[i + 1][c] - stops[i][c]);
}

Status image_flip(Diag *diag, const Image *a, const Image *reference, Image *out)
{
    ColourPair pair;
    double mean;
    *out = (Image){0};
    TRY(colour_pair_init(diag, a, reference, &pair));
    Status status = find_flip(diag, &pair, &mean, out);
    colour_pair_done(&pair);
    return status;
}

Status image_load(Diag *diag, const char *path, Image *out)
{
    static const unsigned char exr_magic[4] = {0x76, 0x2f, 0x31, 0x01};
    static const unsigned char png_magic[4] = {0x89, 'P', 'N', 'G'};
    unsigned char start[4] = {0};
    int fd;
    size_t size;
    *out = (Image){0};
    TRY(file_open_input(diag, path, &fd, &size));
    ssize_t got = read(fd, start, sizeof start);
    close(fd);
    if (got == sizeof start && memcmp(start, exr_magic, sizeof start) == 0)
        return exr_read(diag, path, out);
    if (got == sizeof start && memcmp(start, png_magic, sizeof start) == 0)
        return png_read(diag, path, out);
    return diag_fail(diag, ERR_FILE, "cannot read '%s': neither an OpenEXR nor a PNG file", path);
}

void image_to_display(Image *image)
{
    ImageLayer *layer = image_find_layer(image, "");
    if (image->is_display || !layer)
        return;
    size_t count = (size_t)image->width * (size_t)image->height;
    for (size_t i = 0; i < count; i++) {
        float *pixel = layer->pixels + i * (size_t)layer->channel_count;
        for (int c = 0; c < layer->channel_count; c++) {
            if (layer->channels[c] != 'A')
                pixel[c] = encode(pixel[c]);
        }
    }
    image->is_display = true;
}
