/* The eye pass over the film: blocks of pixels handed to threads.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_RENDER_TILES_H
#define PMS_RENDER_TILES_H

#include "render/film.h"

/* Fill the film.  Every pixel is a function of scene, options and maps alone, so the blocks
 * may be done in any order.  Counters are added to *stats. */
Status tiles_render(const Tracer *tracer, const RenderOptions *options, const EyeOptions *eye,
                    Diag *diag, Stats *stats, Film *film);

#endif
