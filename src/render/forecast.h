/* What a render is expected to take, and what its lights' photons are expected to come to, from
 * pictures in small.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_RENDER_FORECAST_H
#define PMS_RENDER_FORECAST_H

#include "render/cost.h"
#include "render/render.h"

typedef struct Forecast {
    Costs costs;       /* of one pass if there are many */
    PhotonBooks books; /* power, share and budget are those of the render itself, what became of
                          the photons is expected; flux is not set */
} Forecast;

/* Forecast a render of the tracer's scene.  The same for any number of threads.  Free with
 * forecast_done. */
Status forecast_make(const Tracer *tracer, const RenderOptions *options, Diag *diag, Forecast *out);
void forecast_done(Forecast *forecast);

/* The same with the plan of a scene, whose memory comes from `arena`, without rendering: what
 * `explain` prints. */
Status render_forecast(const Scene *scene, const RenderOptions *options, Diag *diag, Arena *arena,
                       Plan *plan, Forecast *out);

#endif
