/* Structural similarity of two grey images.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_IMAGE_SSIM_INT_H
#define PMS_IMAGE_SSIM_INT_H

#include <stdbool.h>

/* Find the mean structural similarity of two images of values in [0,1], as image_compare
 * describes it.  Returns false when memory is out. */
bool ssim_mean(const float *a, const float *b, int width, int height, double *out);

#endif
