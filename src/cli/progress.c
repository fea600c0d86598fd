/* Progress.  SPDX-License-Identifier: Apache-2.0 */
#include "cli/progress.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

/* Lines a second. */
#define PROGRESS_INTERVAL 0.1

Status progress_init(Progress *progress, const Args *args)
{
    const char *kind = args->value[OPT_PROGRESS];
    *progress = (Progress){.kind = PROGRESS_NONE};
    if (!kind || strcmp(kind, "auto") == 0)
        progress->kind = isatty(STDERR_FILENO) ? PROGRESS_LINE : PROGRESS_NONE;
    else if (strcmp(kind, "line") == 0)
        progress->kind = PROGRESS_LINE;
    else if (strcmp(kind, "json") == 0)
        progress->kind = PROGRESS_JSON;
    else if (strcmp(kind, "none") != 0)
        return diag_fail(args->diag, ERR_USAGE,
                         "--progress wants auto, line, json or none, got '%s'", kind);
    return OK;
}

static void show_line(const RenderProgress *now, int percent)
{
    char left[32] = "";
    if (now->seconds_left >= 3600)
        snprintf(left, sizeof left, ", %.1f h left", now->seconds_left / 3600);
    else if (now->seconds_left >= 60)
        snprintf(left, sizeof left, ", %.0f min left", ceil(now->seconds_left / 60));
    else if (now->seconds_left >= 0)
        snprintf(left, sizeof left, ", %.0f s left", ceil(now->seconds_left));
    char pass[64] = "";
    if (now->passes)
        snprintf(pass, sizeof pass, "pass %" PRIu64 " of %" PRIu64 ", ", now->pass, now->passes);
    else if (now->pass)
        snprintf(pass, sizeof pass, "pass %" PRIu64 ", ", now->pass);
    fprintf(stderr, "\r\033[K%s%s %d %%%s", pass, now->phase, percent, left);
    fflush(stderr);
}

static void show_json(const RenderProgress *now, int percent)
{
    fputc('{', stderr);
    if (now->pass)
        fprintf(stderr, "\"pass\": %" PRIu64 ", ", now->pass);
    if (now->passes)
        fprintf(stderr, "\"passes\": %" PRIu64 ", ", now->passes);
    fprintf(stderr, "\"phase\": \"%s\", \"percent\": %d, \"seconds_left\": ", now->phase, percent);
    json_number(stderr, now->seconds_left >= 0 ? now->seconds_left : NAN);
    fprintf(stderr, "}\n");
}

void progress_show(void *ctx, const RenderProgress *now)
{
    Progress *progress = ctx;
    double clock = clock_wall();
    /* Passes may be many a second. */
    bool is_new_phase = now->phase != progress->last_phase && now->pass <= 1;
    if (progress->kind == PROGRESS_NONE ||
        (!is_new_phase && clock - progress->last_shown < PROGRESS_INTERVAL))
        return;
    progress->last_shown = clock;
    progress->last_phase = now->phase;
    /* Rounded down: what is not done is never shown as 100 %. */
    int percent = (int)floor(100 * now->fraction);
    percent = percent < 100 ? percent : 99; /* the picture is not written yet */
    if (progress->kind == PROGRESS_JSON) {
        show_json(now, percent);
    } else {
        progress->has_line = true;
        show_line(now, percent);
    }
}

void progress_done(Progress *progress)
{
    if (progress->has_line)
        fputs("\r\033[K", stderr);
    progress->has_line = false;
}
