/* Do two noisy pictures show the same?
 *
 * Each pixel is tested by itself.  Its standard error is that of the nine pixels around it, itself
 * an estimate; so z is held against Student's t with nine degrees of freedom instead of the normal
 * distribution.  Nine is right beside an exact picture; of two noisy ones the difference has up to
 * 18, but fewer where an edge gives all of the noise to three of the nine pixels.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_IMAGE_Z_TEST_H
#define PMS_IMAGE_Z_TEST_H

#include "image/image.h"

/* The layers that are read: the standard error and the magnitude of the bias of each pixel's
 * luminance. */
#define Z_TEST_NOISE_LAYER "error.noise"
#define Z_TEST_BIAS_LAYER "error.bias"

/* The chance that noise alone lets any pixel of a picture reject, and the share of the pixels that
 * must accept: noise that few samples saw is not what its standard error says. */
#define Z_TEST_LEVEL 0.01
#define Z_TEST_SHARE 0.9975

enum { Z_TEST_FREEDOM = 9 }; /* odd */

typedef struct ZTest {
    size_t pixels, accepted;
    double level;                /* p-value from which a pixel accepts, corrected after Sidak */
    double critical;             /* its z */
    double share;                /* of the pixels that accept */
    double worst;                /* largest z; infinite without noise or where there is no number */
    int worst_x, worst_y;        /* its pixel, from the upper left */
    size_t bad;                  /* pixels that are no numbers in either picture: they reject */
    bool is_exact_a, is_exact_b; /* without noise of its own */
    bool has_bias;               /* in either: subtracted from the difference */
    bool passes;
} ZTest;

/* Test pixel by pixel whether the luminances of linear images differ by more than their noise:
 * z = (|a-b| - bias_a - bias_b) / sqrt(noise_a^2 + noise_b^2).  A layer that is not there is 0.
 * ERR_USAGE, after a message, for display values, for images of two sizes, and without the layer of
 * the noise in either. */
Status z_test(Diag *diag, const Image *a, const Image *reference, ZTest *out);

/* Return the level of each of `count` independent tests that reject together with the chance
 * `whole`: 1 - (1 - whole)^(1/count). */
double z_test_sidak(double whole, size_t count);

/* Return the two-sided p-value of z >= 0: that chance makes a difference as large. */
double z_test_p_value(double z);

/* Return the z of a p-value from 1e-12 to 1, to five digits or more. */
double z_test_quantile(double level);

#endif
