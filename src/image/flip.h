/* FLIP: how visible differences are.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_IMAGE_FLIP_H
#define PMS_IMAGE_FLIP_H

#include <stdbool.h>

/* How visible the differences of two pictures are when one flips between them, by pixel, 0 to 1.
 *
 * reference, test  linear RGB triples; of pictures for a display from 0 to 1, else what is below 0
 *                  counts as 0.  No NaN, no infinity.
 * is_display       false: the pictures are looked at in several exposures, each pixel in the worst.
 * out              width x height values.
 *
 * Source: Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astroem, Fairchild, "FLIP: A Difference
 * Evaluator for Alternating Images", 2020, and Andersson, Nilsson, Shirley, Akenine-Moeller,
 * "Visualizing Errors in Rendered High Dynamic Range Images", 2021; a screen 0.7 m wide with 3840
 * pixels, looked at from 0.7 m; the film curve of the ACES.  Constants as in the authors' program.
 *
 * Returns false when memory is out. */
bool flip_map(const float *reference, const float *test, int width, int height, bool is_display,
              float *out);

#endif
