/* Sums of films: what many passes saw, in double precision.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_RENDER_FILM_SUM_H
#define PMS_RENDER_FILM_SUM_H

#include "render/film.h"

/* The order of the numbers is that of the film's layers, and in each of its pixels. */
typedef struct FilmSum {
    double *values;
    size_t count;
    size_t z_begin, z_end; /* depths: of these the nearest is kept, not the sum */
    uint64_t passes;       /* added so far */
} FilmSum;

/* Make an empty sum for films like this one.  Free with film_sum_done. */
Status film_sum_init(FilmSum *sum, const Film *film, Diag *diag);
void film_sum_done(FilmSum *sum);

/* Add the film of a pass.  What is NaN counts as the mean of the passes before. */
void film_sum_add(FilmSum *sum, const Film *film);

/* Fill the film with the mean; black without a pass. */
void film_sum_mean(const FilmSum *sum, Film *film);

#endif
