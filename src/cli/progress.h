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

/* Say what a render with a limit is going to do; the callback for ProgressiveOptions. */
void progress_tell_plan(void *ctx, const SeriesPlan *plan);

/* Clear the live line. */
void progress_done(Progress *progress);

/* Say how a progressive render ended: passes, seconds, error and where they were saved.
 *
 * error_wanted  0: none was. */
void progress_say_passes(const Progress *progress, const Args *args, const RenderResult *result,
                         double seconds, double error_wanted);

#endif
