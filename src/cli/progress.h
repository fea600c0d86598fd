/* Progress: one live line on a terminal, or JSON lines for programs.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_CLI_PROGRESS_H
#define PMS_CLI_PROGRESS_H

#include "cli/cli.h"

typedef enum ProgressKind { PROGRESS_NONE, PROGRESS_LINE, PROGRESS_JSON } ProgressKind;

typedef struct Progress {
    ProgressKind kind;
    double last_shown; /* clock_wall of the last line, so that not every tile prints one */
    const char *last_phase;
    bool has_line; /* a live line stands on the terminal */
} Progress;

/* Choose the kind from --progress; "auto" is a line when standard error is a terminal. */
Status progress_init(Progress *progress, const Args *args);

/* The callback for RenderOptions. */
void progress_show(void *ctx, const RenderProgress *now);

/* Clear the live line. */
void progress_done(Progress *progress);

#endif
