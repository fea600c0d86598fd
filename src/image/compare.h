/* Error metrics between two images.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_IMAGE_COMPARE_H
#define PMS_IMAGE_COMPARE_H

#include "image/image.h"

typedef struct CompareResult {
    double rmse;      /* over the RGB channels */
    double rel_mse;   /* mean of (a-b)^2 / (b^2 + COMPARE_REL_EPSILON), b is the reference */
    double psnr;      /* dB, peak 1; infinite for equal images */
    double ssim;      /* mean structural similarity of luma, display-encoded; Wang et al. 2004 */
    double max_error; /* largest difference of a channel */
    double mean_a, mean_b;
} CompareResult;

#define COMPARE_REL_EPSILON 0.01

/* Compare the beauty layers.  Linear images are brought to display encoding (sRGB curve) for
 * SSIM and when the other one is a PNG.  ERR_USAGE if sizes differ. */
Status image_compare(Diag *diag, const Image *a, const Image *reference, CompareResult *out);

/* Make the difference image |a-b| scaled by `gain`, as a linear RGB image. */
Status image_difference(Diag *diag, const Image *a, const Image *b, float gain, Image *out);

/* Read an EXR or PNG by its content. */
Status image_load(Diag *diag, const char *path, Image *out);

#endif
