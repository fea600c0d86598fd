/* What compare and validate share: metrics on paper and thresholds.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_CLI_VERDICT_H
#define PMS_CLI_VERDICT_H

#include "cli/cli.h"
#include "image/compare.h"

/* Bounds on the metrics; NaN: not asked for. */
typedef struct Thresholds {
    double max_rmse, max_rel_mse, max_flip, min_psnr, min_ssim;
} Thresholds;

/* Read --max-rmse and its kin. */
Status thresholds_read(const Args *args, Thresholds *out);

/* Cut both images to --crop, if it was given.  ERR_USAGE if it does not lie in them.
 *
 * corner  its place in the images, x and y: 0 without --crop. */
Status crop_apply(const Args *args, Image *a, Image *b, int corner[2]);

/* Return ERR_COMPARE, after saying which, if a metric is past its bound; an image with pixels
 * that are no numbers fails any bound. */
Status thresholds_check(Diag *diag, const Thresholds *limits, const CompareResult *result);

/* Print the metrics as lines for people, or as the members of a JSON object without braces. */
void metrics_print(FILE *file, const CompareResult *result);
void metrics_print_json(FILE *file, const CompareResult *result);

/* Say early that a file could not be written, or has no known format. */
Status picture_preflight(const Args *args, const char *path);

/* Write an image as .exr, or as 8-bit .png: linear images are clipped and sRGB-encoded for it. */
Status picture_write(Diag *diag, const char *path, const Image *image);

#endif
