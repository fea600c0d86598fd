/* The light that media scatter along a ray to its begin, as it would be without shadows.
 *
 * It is smooth, and summed up in pieces as fine as the rule that sums it needs.  Places along the
 * ray are counted by the part of the whole that comes before them.  SPDX-License-Identifier:
 * Apache-2.0 */
#ifndef PMS_EYE_LIGHT_RUN_H
#define PMS_EYE_LIGHT_RUN_H

#include "trace/media_along.h"

enum { LIGHT_PIECES_MAX = 2 * MEDIA_CELLS_MAX + LIT_STRETCHES_MAX };

/* Places in a part of a cell, counted by how much of what comes from there passes it (in the
 * channel that goes furthest): v from 0 to 1. */
typedef struct MediaWarp {
    const MediaCell *cell;
    double begin, length; /* t */
    double x;             /* extinction */
    double lost;          /* part that does not pass; 0: little, v is even in t */
} MediaWarp;

/* A piece of the light along a ray, without shadows. */
typedef struct LightPiece {
    MediaWarp warp;
    double low, high; /* v */
    double light[3];  /* per unit of v at low, middle and high over the mean: a parabola */
    Rgb sum;          /* light up to its end */
    double part;      /* the same as a part of the whole, over the channels */
} LightPiece;

/* The light along a ray, in order from its begin. */
typedef struct LightRun {
    int count;
    Rgb whole;
    LightPiece pieces[LIGHT_PIECES_MAX];
} LightRun;

/* What a run is the light of. */
typedef struct RunSource {
    const MediaProfile *profile;
    const MediaLobes *lobes;
    const Ray *ray;
    const Light *light; /* from its centre */
    float enough;       /* a piece need not be known better than this */
} RunSource;

/* Sum up the light between t = begin and end; returns false when there is none. */
bool light_run_sum(const RunSource *source, double begin, double end, LightRun *out);

/* Sort the light of a run by what is known of its shadows: `open` gets what nothing is known of.
 * Returns what arrives for sure. */
Rgb light_run_sort(const LightRun *run, const LitStretches *known, LightRun *open);

/* Return the light that a part, from 0 to 1, of the whole is; and the t where it ends. */
Rgb light_run_light(const LightRun *run, double part);
double light_run_t(const LightRun *run, double part);

#endif
