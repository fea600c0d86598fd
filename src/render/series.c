/* The state of a series of passes.  SPDX-License-Identifier: Apache-2.0 */
#include "render/series.h"

Status series_state_init(SeriesState *state, const Film *film, float rate, uint64_t until,
                         Diag *diag)
{
    *state = (SeriesState){.shared_rays = 0};
    Status status = steering_init(&state->steering, film, rate, until, diag);
    for (int i = 0; i < 2 && status == OK; i++)
        status = film_sum_init(&state->halves[i], film, diag);
    if (status != OK)
        series_state_done(state);
    return status;
}

void series_state_done(SeriesState *state)
{
    for (int i = 0; i < 2; i++)
        film_sum_done(&state->halves[i]);
    steering_done(&state->steering);
}
