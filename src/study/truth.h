/* The picture that a study compares with, and how far others are from it.
 *
 * It is the mean of two that were made independently of each other.  Their noise has nothing to do
 * with one another, so the mean of (x - a) (x - b) over the pixels is the square of the error of a
 * picture x without that of the halves: what the reference is noisy by does not count.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_STUDY_TRUTH_H
#define PMS_STUDY_TRUTH_H

#include "image/image.h"

/* How far a picture is from the truth.  Squares may come out a little below 0. */
typedef struct TruthError {
    double square;     /* mean of (x - truth)^2 over the channels */
    double rel_square; /* mean of (x - truth)^2 / (truth^2 + COMPARE_REL_EPSILON) */
    double percentile; /* ERROR_PERCENTILE of the pixels have a smaller relative error of luminance
                          (error_scale), with the noise of the reference in it */
    double flip;       /* mean visible difference: see image_flip; with that noise, too */
} TruthError;

typedef struct Truth {
    int width, height;
    float *mean;               /* RGB triples, linear light */
    float *half[2];            /* NULL: a picture was given, which is taken to be exact */
    TruthError noise;          /* of the mean; NaN: unknown */
    double rel_blur2;          /* what it is blurred by, as rel_square; NaN: unknown */
    char method[64];           /* how it was made: "progressive photon mapping, 120 passes" */
    double passes, seconds;    /* of both halves */
} Truth;

/* Make the truth of a size, all black.  Free with truth_done. */
Status truth_init(Diag *diag, int width, int height, bool has_halves, Truth *out);
void truth_done(Truth *truth);

/* Copy the colours of an image into RGB triples: NaN where it has none. */
void truth_colours(const Image *image, float *out);

/* Make the mean of the halves and find its noise. */
Status truth_settle(Diag *diag, Truth *truth);

/* Compare a picture of the same size. */
Status truth_compare(Diag *diag, const Truth *truth, const Image *image, TruthError *out);

/* Return the mean over pixels of what two differences have in common, relative as rel_square: of
 * a[0] - a[1] and b[0] - b[1], RGB triples. */
double truth_common(const Truth *truth, const float *const a[2], const float *const b[2]);

/* Save the mean, and the halves if it has any, as EXR files in a folder; load them again.  In
 * truth_load *is_there tells whether they were; the numbers beside them are the caller's. */
Status truth_save(Diag *diag, const Truth *truth, const char *folder);
Status truth_load(Diag *diag, const char *folder, int width, int height, Truth *out,
                  bool *is_there);

/* Load a single picture as the truth.  ERR_USAGE after a message if its size is another, or if it
 * holds display values. */
Status truth_load_file(Diag *diag, const char *path, int width, int height, Truth *out);

#endif
