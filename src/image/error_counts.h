/* Relative errors of pixels, and what most of them stay below.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_IMAGE_ERROR_COUNTS_H
#define PMS_IMAGE_ERROR_COUNTS_H

#include "image/image.h"

/* So many of the pixels are to be below the figure. */
#define ERROR_PERCENTILE 0.95

/* Return what the error of a pixel is measured by: its luminance, but in the dark (below about a
 * tenth of the picture's mean luminance) this tenth. */
double error_scale(double luminance, double mean);

/* Counts of relative errors, apart for parts of the picture. */
typedef struct ErrorCounts ErrorCounts;
ErrorCounts *error_counts_new(void); /* NULL when memory is out */
void error_counts_free(ErrorCounts *counts);

/* Count the relative error of the pixel at (x, y), not negative. */
void error_counts_add(ErrorCounts *counts, size_t x, size_t y, double error);

/* Return what ERROR_PERCENTILE of the errors are below, within 2 %; 0 of none. */
double error_counts_percentile(const ErrorCounts *counts);

/* Return what that is below with a confidence of 90 %, as far as the parts of the picture tell: the
 * jackknife over their percentiles' logarithms. */
double error_counts_bound(const ErrorCounts *counts);

#endif
