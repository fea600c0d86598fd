/* Sums of films: what many passes saw, in double precision.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_RENDER_FILM_SUM_H
#define PMS_RENDER_FILM_SUM_H

#include "render/film.h"

/* A pixel's values are summed over its usable samples, so that passes may take different numbers of
 * them.  The order of the numbers is that of the film's layers, and in each of its pixels. */
typedef struct FilmSum {
    double *values;
    uint32_t *taken, *good; /* samples of each pixel: all, and those that could be used */
    size_t count, pixels;
    size_t clues;          /* those begin here, and are the last */
    size_t z_begin, z_end; /* depths: of these the nearest is kept, not the sum */
    uint64_t passes;       /* added so far */
} FilmSum;

/* Make an empty sum for films like this one.  Free with film_sum_done. */
Status film_sum_init(FilmSum *sum, const Film *film, Diag *diag);
void film_sum_done(FilmSum *sum);

/* Make the samples of the film's next pass follow those of the sum. */
void film_sum_follow(const FilmSum *sum, Film *film);

/* Add the film of a pass, with film->samples. */
void film_sum_add(FilmSum *sum, const Film *film);

/* Fill a picture with the mean of `n` sums; black where there is no usable sample.  Its first
 * layers are the film's but for the clues. */
void film_sum_mean(const FilmSum *sums, int n, Image *picture);

/* Return the mean of the values of a layer's channel at a pixel; 0 without a usable sample.
 *
 * at  of the pixel's first channel, among the values. */
static inline double film_sum_value(const FilmSum *sum, size_t pixel, size_t at)
{
    return sum->good[pixel] ? sum->values[at] / sum->good[pixel] : 0;
}

#endif
