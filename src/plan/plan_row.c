/* A row of the plan: the effect on or off, and the reason.  What the command line forces comes
 * before what the quality leaves out, and that before what the scene calls for.
 * SPDX-License-Identifier: Apache-2.0 */
#include "plan/plan_int.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

bool row_set(PlanRow *row, bool is_on, Span why, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    vsnprintf(row->reason, sizeof row->reason, format, args);
    va_end(args);
    row->is_on = is_on;
    row->why = why;
    return is_on;
}

bool row_has_quality(const PlanOptions *options, FeatureId feature)
{
    return options->effects[feature] == TRI_ON || options->quality >= feature_quality(feature);
}

bool row_ruled_out(const PlanOptions *options, FeatureId feature, PlanRow *rows)
{
    if (options->effects[feature] == TRI_OFF)
        row_set(&rows[feature], false, SPAN_NONE, "switched off on the command line");
    else if (!row_has_quality(options, feature))
        row_set(&rows[feature], false, SPAN_NONE, "quality %d (from %d on)", options->quality,
                feature_quality(feature));
    else
        return false;
    return true;
}

void rows_tell_forced(const PlanOptions *options, PlanRow *rows)
{
    static const char asked[] = "asked for on the command line";
    for (int i = 0; i < FEATURE_COUNT; i++) {
        PlanRow *row = &rows[i];
        char reason[sizeof row->reason];
        row->forced = options->effects[i];
        if (!row->is_on || row->forced != TRI_ON || strstr(row->reason, asked))
            continue;
        memcpy(reason, row->reason, sizeof reason);
        row_set(row, true, row->why, "%s: %.*s", asked, (int)(sizeof reason - sizeof asked - 2),
                reason);
    }
}

Status plan_check(const Plan *plan, Diag *diag)
{
    Status status = OK;
    for (int i = 0; i < FEATURE_COUNT; i++) {
        const PlanRow *row = &plan->rows[i];
        if (row->forced == TRI_ON && !row->is_on)
            status = diag_fail(diag, ERR_USAGE, "--effect %s=on is not possible here: %s",
                               feature_name((FeatureId)i), row->reason);
    }
    return status;
}
