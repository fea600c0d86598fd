/* What a series of passes has come to: all it takes to go on.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_RENDER_SERIES_H
#define PMS_RENDER_SERIES_H

#include "render/film_sum.h"
#include "render/steer.h"

typedef struct SeriesState {
    PassRadii first;      /* gather radii of the first pass */
    FilmSum halves[2];    /* the first has the passes with even numbers, counted from 0 */
    Steering steering;    /* the plan for the passes to come */
    uint64_t shared_rays; /* of all passes so far: see PassResult */
    uint64_t eye_rays;
} SeriesState;

static inline uint64_t series_passes(const SeriesState *state)
{
    return state->halves[0].passes + state->halves[1].passes;
}

/* Make the state of a series without a pass, for films like this one.
 *
 * rate, until  of the first plan: see Steering.
 *
 * Free with series_state_done. */
Status series_state_init(SeriesState *state, const Film *film, float rate, uint64_t until,
                         Diag *diag);
void series_state_done(SeriesState *state);

#endif
