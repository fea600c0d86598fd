/* Progress.  SPDX-License-Identifier: Apache-2.0 */
#include "cli/progress.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

/* Seconds from one line to the next: on a terminal, which shows the last one only, and for
 * programs; and in a log, which keeps them all. */
#define LIVE_INTERVAL 0.1
#define LOG_INTERVAL 10

Status progress_init(Progress *progress, const Args *args)
{
    const char *kind = args->value[OPT_PROGRESS];
    *progress = (Progress){.kind = PROGRESS_NONE, .is_terminal = isatty(STDERR_FILENO)};
    if (!kind || strcmp(kind, "auto") == 0)
        progress->kind = progress->is_terminal ? PROGRESS_LINE : PROGRESS_END;
    else if (strcmp(kind, "line") == 0)
        progress->kind = PROGRESS_LINE;
    else if (strcmp(kind, "json") == 0)
        progress->kind = PROGRESS_JSON;
    else if (strcmp(kind, "none") != 0)
        return diag_fail(args->diag, ERR_USAGE,
                         "--progress wants auto, line, json or none, got '%s'", kind);
    return OK;
}

/* Write over the line before on a terminal, one line more elsewhere. */
static void show_line(const Progress *progress, const RenderProgress *now, int percent)
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
    char error[64] = "";
    if (now->error > 0 && now->error_wanted > 0)
        snprintf(error, sizeof error, "error below %.3g %%, %.3g %% wanted, ", 100 * now->error,
                 100 * now->error_wanted);
    else if (now->error > 0)
        snprintf(error, sizeof error, "error below %.3g %%, ", 100 * now->error);
    fprintf(stderr, "%s%s%s%s %d %%%s%s", progress->is_terminal ? "\r\033[K" : "", pass, error,
            now->phase, percent, left, progress->is_terminal ? "" : "\n");
    fflush(stderr);
}

void progress_tell_plan(void *ctx, const SeriesPlan *plan)
{
    Progress *progress = ctx;
    if (progress->kind == PROGRESS_NONE)
        return;
    progress_done(progress);
    if (progress->kind == PROGRESS_JSON) {
        fprintf(stderr, "{\"plan\": true");
        json_field(stderr, "passes", plan->passes);
        json_field(stderr, "seconds_a_pass", plan->seconds);
        json_field(stderr, "photons", plan->photons);
        json_field(stderr, "samples", plan->samples);
        json_field(stderr, "error", plan->error);
        fprintf(stderr, "}\n");
        return;
    }
    fprintf(stderr,
            "pms: error below %.3g %% after %" PRIu64 " passes; the plan: ", 100 * plan->error,
            plan->passes_so_far);
    double more = ceil(plan->passes - (double)plan->passes_so_far);
    if (isfinite(more))
        fprintf(stderr, "about %.0f more of %.2g s, ", more, plan->seconds);
    else
        fprintf(stderr, "passes of %.2g s, ", plan->seconds);
    if (plan->photons >= 1)
        fprintf(stderr, "each with all photons and ");
    else if (plan->photons > 0)
        fprintf(stderr, "each with %.0f %% of the photons and ", 100 * plan->photons);
    fprintf(stderr, "%.2g samples a pixel, where the error is\n", plan->samples);
}

static void show_json(const RenderProgress *now, int percent)
{
    fputc('{', stderr);
    if (now->pass)
        fprintf(stderr, "\"pass\": %" PRIu64 ", ", now->pass);
    if (now->passes)
        fprintf(stderr, "\"passes\": %" PRIu64 ", ", now->passes);
    if (now->error > 0)
        fprintf(stderr, "\"error\": %.9g, ", now->error);
    fprintf(stderr, "\"phase\": \"%s\", \"percent\": %d, \"seconds_left\": ", now->phase, percent);
    json_number(stderr, now->seconds_left >= 0 ? now->seconds_left : NAN);
    fprintf(stderr, "}\n");
}

void progress_show(void *ctx, const RenderProgress *now)
{
    Progress *progress = ctx;
    double clock = clock_wall();
    bool is_log = progress->kind == PROGRESS_LINE && !progress->is_terminal;
    double interval = is_log ? LOG_INTERVAL : LIVE_INTERVAL;
    /* Passes may be many a second. */
    bool is_new_phase = now->phase != progress->last_phase && now->pass <= 1;
    if (progress->kind == PROGRESS_NONE || progress->kind == PROGRESS_END ||
        (!is_new_phase && clock - progress->last_shown < interval))
        return;
    progress->last_shown = clock;
    progress->last_phase = now->phase;
    /* Rounded down: what is not done is never shown as 100 %. */
    int percent = (int)floor(100 * now->fraction);
    percent = percent < 100 ? percent : 99; /* the picture is not written yet */
    if (progress->kind == PROGRESS_JSON) {
        show_json(now, percent);
    } else {
        progress->has_line = progress->is_terminal;
        show_line(progress, now, percent);
    }
}

void progress_done(Progress *progress)
{
    if (progress->has_line)
        fputs("\r\033[K", stderr);
    progress->has_line = false;
}

static void say_passes_json(const Args *args, const RenderResult *result, double seconds)
{
    fprintf(stderr, "{\"done\": true, \"passes\": %" PRIu64 ", \"passes_of_this_run\": %" PRIu64,
            result->passes, result->new_passes);
    json_field(stderr, "seconds", seconds);
    if (result->error.is_known) {
        json_field(stderr, "error", result->error.whole);
        json_field(stderr, "error_bound", result->error.bound);
    }
    fprintf(stderr, ", \"files\": [");
    for (int i = 0; i < args->output_count; i++) {
        fputs(i ? ", " : "", stderr);
        json_string(stderr, args->outputs[i]);
    }
    fprintf(stderr, "]}\n");
}

void progress_say_passes(const Progress *progress, const Args *args, const RenderResult *result,
                         double seconds, double error_wanted)
{
    if (progress->kind == PROGRESS_NONE)
        return;
    if (progress->kind == PROGRESS_JSON) {
        say_passes_json(args, result, seconds);
        return;
    }
    fprintf(stderr, "pms: %" PRIu64 " pass%s", result->passes, result->passes == 1 ? "" : "es");
    if (result->new_passes != result->passes)
        fprintf(stderr, ", %" PRIu64 " of them in this run,", result->new_passes);
    fprintf(stderr, " in %.*f s", seconds < 10 ? 2 : 0, seconds);
    if (result->error.is_known)
        fprintf(stderr, ", error %.3g %% (with 90 %% confidence below %.3g %%)",
                100 * result->error.whole, 100 * result->error.bound);
    if (result->error.is_known && result->error.bound > error_wanted && error_wanted > 0)
        fprintf(stderr, ", not sure to be below the %.3g %% wanted", 100 * error_wanted);
    fputs(", saved in", stderr);
    for (int i = 0; i < args->output_count; i++)
        fprintf(stderr, "%s '%s'", i ? "," : "", args->outputs[i]);
    fputc('\n', stderr);
}
