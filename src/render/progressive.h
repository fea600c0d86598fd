/* Progressive rendering.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_RENDER_PROGRESSIVE_H
#define PMS_RENDER_PROGRESSIVE_H

#include "render/render.h"

/* Run passes until one of the limits of options->progressive, or Ctrl-C.
 *
 * started  of the render, by clock_wall.
 * out      as of render_scene. */
Status progressive_render(const Tracer *tracer, const RenderOptions *options, double started,
                          Diag *diag, RenderResult *out);

/* Return the gather radius of a pass, counted from 1, over that of the first. */
double progressive_shrink(uint64_t pass);

#endif
