/* The options of progressive rendering.  SPDX-License-Identifier: Apache-2.0 */
#include "cli/args_int.h"

#include "base/file.h"

#include <limits.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#define SECONDS_MAX 1e9

/* Errors that may be asked for: below them rounding takes over, above them nothing is left. */
#define ERROR_PERCENT_MIN 0.01
#define ERROR_PERCENT_MAX 100.0

/* The file beside the first picture that the state is kept in. */
#define STATE_ENDING ".pmsstate"

/* Numbers with d, h, m or s behind them, in this order; seconds without. */
static bool read_seconds(const char *text, double *seconds)
{
    static const char letters[] = "smhd";
    static const double units[] = {1, 60, 3600, 86400};
    ptrdiff_t below = sizeof units / sizeof *units;
    *seconds = 0;
    do {
        char *end;
        double number = strtod(text, &end);
        const char *letter = *end ? strchr(letters, *end) : letters;
        if (end == text || !(number >= 0) || !letter || letter - letters >= below)
            return false;
        below = letter - letters;
        *seconds += number * units[below];
        text = *end ? end + 1 : end;
    } while (*text);
    return true;
}

Status args_time(const Args *args, double *seconds)
{
    const char *text = args->value[OPT_TIME];
    if (!text)
        return OK;
    if (!read_seconds(text, seconds) || !(*seconds > 0 && *seconds <= SECONDS_MAX))
        return diag_fail(args->diag, ERR_USAGE,
                         "--time wants a time such as 90, 90s, 5m, 4m30s, 1.5h or 2d, got '%s'",
                         text);
    return OK;
}

/* Read a percentage as a part of 1. */
static Status read_error(const Args *args, double *error)
{
    const char *text = args->value[OPT_ERROR];
    if (!text)
        return OK;
    char *end;
    double percent = strtod(text, &end);
    bool is_number = end != text;
    end += strspn(end, " ");
    bool is_percent = is_number && end[0] == '%' && !end[1];
    if (!is_percent || !(percent >= ERROR_PERCENT_MIN && percent <= ERROR_PERCENT_MAX))
        return diag_fail(args->diag, ERR_USAGE,
                         "--error wants a percentage from %g%% to %g%% such as 2%%, got '%s'",
                         ERROR_PERCENT_MIN, ERROR_PERCENT_MAX, text);
    *error = percent / 100;
    return OK;
}

static Status state_of(const Args *args, const char *output, const char **out)
{
    size_t length = strlen(output);
    char *path = arena_alloc(args->arena, length + sizeof STATE_ENDING);
    if (!path)
        return diag_no_memory(args->diag, "the command line");
    memcpy(path, output, length);
    memcpy(path + length, STATE_ENDING, sizeof STATE_ENDING);
    *out = path;
    return OK;
}

/* The state is beside the first output; that to resume from beside the first that has one. */
static Status state_path(const Args *args, const char **out)
{
    for (int i = 0; i < args->output_count && args_has(args, OPT_RESUME); i++) {
        TRY(state_of(args, args->outputs[i], out));
        if (file_exists(*out))
            return OK;
    }
    return args->output_count > 0 ? state_of(args, args->outputs[0], out) : OK;
}

Status args_progressive(const Args *args, RenderOptions *out)
{
    static const OptionId needing[] = {OPT_PASSES, OPT_RESUME};
    static const char *const names[] = {"passes", "resume"};
    ProgressiveOptions *progressive = &out->progressive;
    long passes;
    bool is_kept = args_has(args, OPT_PROGRESSIVE);
    for (int i = 0; i < 2 && !is_kept; i++)
        if (args_has(args, needing[i]))
            return diag_fail(args->diag, ERR_USAGE, "--%s wants --progressive beside it", names[i]);
    out->plan.is_progressive = is_kept || args_has(args, OPT_TIME) || args_has(args, OPT_ERROR);
    if (!out->plan.is_progressive)
        return OK;
    if (args->has_pov_aa)
        return diag_fail(args->diag, ERR_USAGE,
                         "+A has no meaning with --progressive, --time and --error, whose passes "
                         "each take --aa samples of a pixel");
    if (out->samples > UINT16_MAX)
        return diag_fail(args->diag, ERR_USAGE,
                         "a pass takes at most %d samples of a pixel, got --aa %d", UINT16_MAX,
                         out->samples);
    TRY(args_int(args, OPT_PASSES, 1, UINT32_MAX, 0, &passes));
    TRY(args_time(args, &progressive->seconds));
    TRY(read_error(args, &progressive->error));
    progressive->passes = (uint64_t)passes;
    progressive->is_resumed = args_has(args, OPT_RESUME);
    return is_kept ? state_path(args, &progressive->state_path) : OK;
}
