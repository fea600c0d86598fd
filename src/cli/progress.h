/* Progress: one live line on a terminal, lines now and then in a log, or JSON lines for programs.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_CLI_PROGRESS_H
#define PMS_CLI_PROGRESS_H

#include "cli/cli.h"

/* PROGRESS_END: nothing but how it ended. */
typedef enum ProgressKind {
    PROGRESS_NONE, PROGRESS_END, PROGRESS_LINE, PROGRESS_JSON
} ProgressKind;

typedef struct Progress {
    ProgressKind kind;
    double last_shown; /* clock_wall of the last line, so that not every tile prints one */
    const char *last_phase;
    bool is_terminal; /* standard error is one */
    bool has_line;    /* a live line stands on it */
} Progress;

/* Choose the kind from --progress; "auto" is a line when standard error is a terminal, else the end
 * of a progressive render. */
Status progress_init(Progress *progress, const Args *args);

/* The callback for RenderOptions. */
void progress_show(void *ctx, const RenderProgress *now);

/* Clear the live line. */
void progress_done(Progress *progress);

/* Say how a progressive render ended: passes, seconds and where they were saved. */
void progress_say_passes(const Progress *progress, const Args *args, const RenderResult *result,
                         double seconds);

#endif
