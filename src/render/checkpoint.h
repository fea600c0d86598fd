/* The state of a progressive render on disk: what it takes to go on from the last pass.
 *
 * The file is replaced whole, so that there is either the old state or the new one whenever the
 * program or the machine ends.  It is refused when it is cut short or damaged, and when it belongs
 * to another picture.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_RENDER_CHECKPOINT_H
#define PMS_RENDER_CHECKPOINT_H

#include "render/series.h"

enum { CHECKPOINT_SETTINGS_MAX = 2048 };

/* Describe all that the picture depends on, a line each: "name value". */
void checkpoint_describe(const Scene *scene, const RenderOptions *options,
                         char settings[CHECKPOINT_SETTINGS_MAX]);

/* Put what differs between two descriptions into words. */
void checkpoint_difference(const char *there, const char *here, char *out, size_t size);

/* Write the state.  On ERR_FILE the old one is as it was. */
Status checkpoint_write(Diag *diag, const char *path, const char *settings,
                        const SeriesState *state);

/* Read a state that was written with the same settings, into one made for the same film.  Without
 * a file at `path`, *is_there is false and all else as it was.  ERR_FILE, after a message, for a
 * file that cannot be read, is cut short, damaged or has values that no series has; ERR_USAGE for
 * one of other settings: the message says which.  The state is then of no use. */
Status checkpoint_read(Diag *diag, const char *path, const char *settings, SeriesState *state,
                       bool *is_there);

#endif
