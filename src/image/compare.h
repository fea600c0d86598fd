/* Error metrics between two images.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_IMAGE_COMPARE_H
#define PMS_IMAGE_COMPARE_H

#include "image/image.h"

typedef struct CompareResult {
    double rmse;      /* over the RGB channels */
    double mae;       /* mean of |a-b| */
    double rel_mse;   /* mean of (a-b)^2 / (b^2 + COMPARE_REL_EPSILON), b is the reference */
    double psnr;      /* dB, peak 1; infinite for equal images */
    double ssim;      /* mean structural similarity of luma, display-encoded; Wang et al. 2004 */
    double flip;      /* mean visible difference, 0 to 1: see image_flip */
    double error95;   /* 95 % of the pixels differ by less than this part of the reference's
                         luminance (linear light; in the dark see error_scale) */
    double max_error; /* largest difference of a channel */
    double mean_a, mean_b;
    double light_a, light_b; /* mean linear light, display values decoded */
    size_t bad_a, bad_b; /* pixels with a NaN or infinity: left out of the sums, black in SSIM */
    bool is_display;     /* what was compared: display values, or (both images linear) light */
} CompareResult;

#define COMPARE_REL_EPSILON 0.01

/* Compare the colours of the beauty layers as they look over black.
 *
 * Linear images are clipped and brought to display encoding (sRGB curve) for SSIM and when the
 * other one is a PNG.  SSIM: Gaussian window of 11x11 with sigma 1.5, K1 .01, K2 .03, L 1, on
 * luma (Rec.709 weights), windows that lie wholly inside the image; for images with a side
 * under 11, windows are cut at the edge and all count.
 * ERR_USAGE if sizes differ or an image has no colours.  O(pixels). */
Status image_compare(Diag *diag, const Image *a, const Image *reference, CompareResult *out);

/* Do the same, and make the picture of image_flip of what was found; `flip` NULL: none. */
Status image_compare_flip(Diag *diag, const Image *a, const Image *reference, CompareResult *out,
                          Image *flip);

/* Make the difference image |a-b| scaled by `gain`; is_display as in CompareResult.  Pixels
 * that cannot be compared are magenta. */
Status image_difference(Diag *diag, const Image *a, const Image *b, float gain, Image *out);

/* Make the picture of how visible the differences are, by pixel, from black (not) through purple
 * and orange to near white: LDR-FLIP if display values are compared, else HDR-FLIP.  Pixels that
 * are no numbers are black in both.
 * Source: Andersson et al., "FLIP: A Difference Evaluator for Alternating Images", 2020, and
 * "Visualizing Errors in Rendered High Dynamic Range Images", 2021. */
Status image_flip(Diag *diag, const Image *a, const Image *reference, Image *out);

/* Return in `out` the colour of heat for 0 to 1, display values: even steps look alike. */
void image_heat(float x, float out[3]);

/* Read an EXR or PNG by its content. */
Status image_load(Diag *diag, const char *path, Image *out);

/* Clip and encode the colours of the beauty layer with the sRGB curve, unless they are display
 * values already. */
void image_to_display(Image *image);

#endif
