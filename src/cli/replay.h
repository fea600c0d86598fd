/* pms render --replay: one pixel of a picture, and what became of its rays.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_CLI_REPLAY_H
#define PMS_CLI_REPLAY_H

#include "cli/cli.h"
#include "render/render.h"

/* Render the pixel that --replay names and tell its story on standard output; writes no picture. */
Status replay_run(const Args *args, const Scene *scene, RenderOptions *options);

#endif
