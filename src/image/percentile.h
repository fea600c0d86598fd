/* Relative errors of pixels, and what most of them stay below.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_IMAGE_PERCENTILE_H
#define PMS_IMAGE_PERCENTILE_H

#include <stdbool.h>
#include <stddef.h>

/* So many of the pixels are to be below the figure. */
#define ERROR_PERCENTILE 0.95

/* 95 % of the values of a normal distribution are within so many standard deviations. */
#define NORMAL_95 1.96

/* Return what the error of a pixel is measured by: its luminance, but in the dark (below about a
 * tenth of the picture's mean luminance) this tenth. */
double error_scale(double luminance, double mean);

/* Return what a part of the errors are below, within 3 %; of no errors 0.  Those that are negative
 * are left out. */
double error_percentile(const float *errors, size_t count, double part);

/* Return what ERROR_PERCENTILE of the errors of a picture are below with a confidence of 90 %, were
 * the picture made once more.
 *
 * Which pixels are easy and which are not is not by chance: only where some of a small tile's
 * errors are above the figure and some below is it chance that decides, for all pixels of a patch
 * of noise alike.
 *
 * figure  error_percentile of them for ERROR_PERCENTILE. */
double error_bound(const float *errors, int width, int height, double figure);

/* Find what ERROR_PERCENTILE of the pixels of a picture differ by less from a reference, relative
 * to its luminance; both linear RGB.  Pixels that are no numbers in either are left out.  Returns
 * false when memory is out. */
bool error_between(const float *colours, const float *reference, size_t pixels, double *out);

#endif
