/* Metrics on paper, and thresholds.  SPDX-License-Identifier: Apache-2.0 */
#include "cli/verdict.h"

#include "base/file.h"
#include "base/mem.h"
#include "image/exr.h"
#include "image/png_file.h"
#include "image/srgb.h"

#include <math.h>
#include <string.h>
#include <strings.h>

Status thresholds_read(const Args *args, Thresholds *out)
{
    TRY(args_number(args, OPT_MAX_RMSE, 0, INFINITY, NAN, &out->max_rmse));
    TRY(args_number(args, OPT_MAX_RELMSE, 0, INFINITY, NAN, &out->max_rel_mse));
    TRY(args_number(args, OPT_MAX_FLIP, 0, 1, NAN, &out->max_flip));
    TRY(args_number(args, OPT_MIN_PSNR, -INFINITY, INFINITY, NAN, &out->min_psnr));
    return args_number(args, OPT_MIN_SSIM, -1, 1, NAN, &out->min_ssim);
}

static bool is_inside(const int r[4], const Image *image)
{
    return r[0] >= 0 && r[1] >= 0 && r[2] >= 1 && r[3] >= 1 && r[0] < image->width &&
           r[1] < image->height && r[2] <= image->width - r[0] && r[3] <= image->height - r[1];
}

Status crop_apply(const Args *args, Image *a, Image *b, int corner[2])
{
    const char *text = args->value[OPT_CROP];
    int r[4], length = 0;
    corner[0] = corner[1] = 0;
    if (!text)
        return OK;
    if (sscanf(text, "%d,%d,%d,%d%n", &r[0], &r[1], &r[2], &r[3], &length) != 4 || text[length])
        return diag_fail(args->diag, ERR_USAGE, "--crop wants X,Y,W,H, got '%s'", text);
    if (!is_inside(r, a) || !is_inside(r, b))
        return diag_fail(args->diag, ERR_USAGE, "the rectangle %s does not lie in the images",
                         text);
    image_crop(a, r[0], r[1], r[2], r[3]);
    image_crop(b, r[0], r[1], r[2], r[3]);
    corner[0] = r[0];
    corner[1] = r[1];
    return OK;
}

static Status check_most(Diag *diag, const char *name, double found, double limit)
{
    if (isnan(limit) || found <= limit)
        return OK;
    return diag_fail(diag, ERR_COMPARE, "%s is %.6g, more than %.6g", name, found, limit);
}

static Status check_least(Diag *diag, const char *name, double found, double limit)
{
    if (isnan(limit) || found >= limit)
        return OK;
    return diag_fail(diag, ERR_COMPARE, "%s is %.6g, less than %.6g", name, found, limit);
}

Status thresholds_check(Diag *diag, const Thresholds *limits, const CompareResult *result)
{
    bool has_limit = !isnan(limits->max_rmse) || !isnan(limits->max_rel_mse) ||
                     !isnan(limits->max_flip) || !isnan(limits->min_psnr) ||
                     !isnan(limits->min_ssim);
    Status status[] = {
        check_most(diag, "rmse", result->rmse, limits->max_rmse),
        check_most(diag, "relmse", result->rel_mse, limits->max_rel_mse),
        check_most(diag, "flip", result->flip, limits->max_flip),
        check_least(diag, "psnr", result->psnr, limits->min_psnr),
        check_least(diag, "ssim", result->ssim, limits->min_ssim),
    };
    if (has_limit && result->bad_a + result->bad_b > 0)
        return diag_fail(diag, ERR_COMPARE, "%zu and %zu pixels are not numbers", result->bad_a,
                         result->bad_b);
    for (size_t i = 0; i < sizeof status / sizeof *status; i++)
        TRY(status[i]);
    return OK;
}

void metrics_print(FILE *file, const CompareResult *r)
{
    fprintf(file, "compared %s\n", r->is_display ? "display values (sRGB)" : "linear light");
    fprintf(file, "rmse     %.6g\n", r->rmse);
    fprintf(file, "mae      %.6g\n", r->mae);
    fprintf(file, "relmse   %.6g  (epsilon %g)\n", r->rel_mse, COMPARE_REL_EPSILON);
    fprintf(file, "psnr     %.4g dB\n", r->psnr);
    fprintf(file, "ssim     %.6f\n", r->ssim);
    fprintf(file, "flip     %.6f\n", r->flip);
    fprintf(file, "error95  %.6g\n", r->error95);
    fprintf(file, "max      %.6g\n", r->max_error);
    fprintf(file, "means    %.6g %.6g\n", r->mean_a, r->mean_b);
    fprintf(file, "light    %.6g %.6g\n", r->light_a, r->light_b);
    if (r->bad_a + r->bad_b > 0)
        fprintf(file, "not numbers: %zu and %zu pixels, left out\n", r->bad_a, r->bad_b);
}

void metrics_print_json(FILE *file, const CompareResult *r)
{
    const struct {
        const char *name;
        double value;
    } items[] = {{"rmse", r->rmse},
                 {"mae", r->mae},
                 {"relmse", r->rel_mse},
                 {"psnr", r->psnr},
                 {"ssim", r->ssim},
                 {"flip", r->flip},
                 {"error95", r->error95},
                 {"max", r->max_error},
                 {"mean_a", r->mean_a},
                 {"mean_b", r->mean_b},
                 {"light_a", r->light_a},
                 {"light_b", r->light_b},
                 {"bad_a", (double)r->bad_a},
                 {"bad_b", (double)r->bad_b},
                 {"relmse_epsilon", COMPARE_REL_EPSILON}};
    fprintf(file, "\"space\": \"%s\"", r->is_display ? "display" : "linear");
    for (size_t i = 0; i < sizeof items / sizeof *items; i++) {
        json_field(file, items[i].name, items[i].value);
    }
}

/* Copy the colours of an image (RGB first in its beauty layer) as display values. */
static void display_colours(const Image *image, float *out)
{
    const ImageLayer *layer = image_find_layer(image, "");
    size_t count = (size_t)image->width * (size_t)image->height;
    for (size_t i = 0; i < count; i++) {
        for (size_t c = 0; c < 3; c++) {
            float v = layer->pixels[i * (size_t)layer->channel_count + c];
            out[3 * i + c] = image->is_display ? v : srgb_encode(fminf(fmaxf(v, 0), 1));
        }
    }
}

static Status check_extension(Diag *diag, const char *path)
{
    const char *extension = path_extension(path);
    if (strcasecmp(extension, "exr") == 0 || strcasecmp(extension, "png") == 0)
        return OK;
    return diag_fail(diag, ERR_USAGE,
                     "cannot tell the format of '%s': it should end in .exr or .png", path);
}

Status picture_preflight(const Args *args, const char *path)
{
    TRY(check_extension(args->diag, path));
    return output_can_write(args, path);
}

Status picture_write(Diag *diag, const char *path, const Image *image)
{
    TRY(check_extension(diag, path));
    if (strcasecmp(path_extension(path), "exr") == 0)
        return exr_write(diag, path, image, NULL, (ExrOptions){0});
    float *pixels = mem_array((size_t)image->width * (size_t)image->height, 3 * sizeof *pixels);
    if (!pixels)
        return diag_no_memory(diag, path);
    display_colours(image, pixels);
    Status status = png_write(diag, path, image->width, image->height, 3, pixels, 8, true, NULL);
    mem_free(pixels);
    return status;
}
