/* The report of a study as data, and as a table for the terminal.
 * SPDX-License-Identifier: Apache-2.0 */
#include "study/report.h"

#include "base/json.h"

#include <math.h>
#include <string.h>

/* --- names and numbers for people ----------------------------------------------------------- */

const char *report_name(const StudyPoint *point)
{
    return point->setting == SETTING_OWN ? "own" : setting_name((SettingId)point->setting);
}

void report_percent(double error, char out[32])
{
    double percent = 100 * error;
    if (isnan(error))
        snprintf(out, 32, "too small to tell");
    else
        snprintf(out, 32, "%.*f %%",
                 percent < 0.1  ? 3
                 : percent < 1  ? 2
                 : percent < 20 ? 1
                                : 0,
                 percent);
}

void report_time(double seconds, char out[32])
{
    if (seconds < 10)
        snprintf(out, 32, "%.2g s", seconds);
    else if (seconds < 100)
        snprintf(out, 32, "%.0f s", seconds);
    else if (seconds < 6000)
        snprintf(out, 32, "%.1f min", seconds / 60);
    else
        snprintf(out, 32, "%.1f h", seconds / 3600);
}

void report_halving(const StudyTrend *trend, char out[48])
{
    enum { TIMES_MOST = 1000 };
    if (trend->count < 2)
        snprintf(out, 48, "one value measured");
    else if (trend->fit.count < 2)
        snprintf(out, 48, "costs no time");
    else if (trend->is_worse)
        snprintf(out, 48, "more is worse");
    else if (!(trend->halving < TIMES_MOST))
        snprintf(out, 48, "not by this alone");
    else
        snprintf(out, 48, "%.*f times the time", trend->halving < 20 ? 1 : 0, trend->halving);
}

/* Return true if it is known how a way to render goes on. */
static bool has_known_way(const Study *study)
{
    const StudyAnalysis *all = &study->analysis;
    for (int i = 0; i < all->trend_count; i++) {
        const StudyTrend *trend = &all->trends[i];
        if (setting_kind((SettingId)trend->setting) == SETTING_WAYS && isfinite(trend->halving))
            return true;
    }
    return false;
}

void report_basis(const Study *study, const StudyAdvice *advice, char out[160])
{
    const StudyRow *row = &study->analysis.rows[advice->row];
    char error[32];
    report_percent(row->error, error);
    if (advice->kind == ADVICE_MEASURED)
        snprintf(out, 160, "measured: %s", error);
    else if (advice->kind == ADVICE_EXTRAPOLATED)
        snprintf(out, 160, "extrapolated from %s at %s, where it was %s",
                 setting_name((SettingId)row->point->setting), row->point->label, error);
    else
        snprintf(out, 160, "%s: the best measured is %s",
                 has_known_way(study) ? "out of reach" : "not reached in this time", error);
}

/* --- CSV ------------------------------------------------------------------------------------ */

static void csv_number(FILE *file, double number)
{
    if (isfinite(number))
        fprintf(file, ",%.9g", number);
    else
        fputc(',', file);
}

/* Quotes in a field are doubled. */
static void csv_text(FILE *file, const char *text)
{
    fputs(",\"", file);
    for (; *text; text++)
        fputs(*text == '"' ? "\"\"" : (char[]){*text, 0}, file);
    fputc('"', file);
}

static void csv_row(FILE *file, const StudyRow *row)
{
    fprintf(file, "%s,%.9g,%d", report_name(row->point), row->point->value, row->point->is_fine);
    csv_text(file, row->point->label);
    csv_text(file, row->point->how);
    fprintf(file, ",%d", row->seeds);
    csv_number(file, row->seconds);
    for (int i = 0; i < PHASE_COUNT; i++)
        csv_number(file, row->phase[i]);
    csv_number(file, row->rmse);
    csv_number(file, row->rel_mse);
    csv_number(file, row->error);
    csv_number(file, row->flip);
    csv_number(file, row->estimate);
    csv_number(file, row->bound);
    csv_number(file, row->spread);
    fprintf(file, ",%d\n", row->is_front);
}

void report_print_csv(FILE *file, const Study *study)
{
    fputs("setting,value,fine,label,how,seeds,seconds", file);
    for (int i = 0; i < PHASE_COUNT; i++)
        fprintf(file, ",%s", phase_name((PhaseId)i));
    fputs(",rmse,relmse,error,flip,estimate,bound,spread,front\n", file);
    for (int i = 0; i < study->analysis.row_count; i++)
        csv_row(file, &study->analysis.rows[i]);
}

/* --- JSON ----------------------------------------------------------------------------------- */

static void json_row(FILE *file, const StudyRow *row)
{
    fprintf(file, "    {\"setting\": \"%s\"", report_name(row->point));
    json_field(file, "value", row->point->value);
    json_text(file, "label", row->point->label);
    json_text(file, "how", row->point->how);
    fprintf(file, ", \"fine\": %s", row->point->is_fine ? "true" : "false");
    json_field(file, "seeds", row->seeds);
    json_field(file, "seconds", row->seconds);
    fputs(", \"phases\": {", file);
    for (int i = 0; i < PHASE_COUNT; i++) {
        fprintf(file, "%s\"%s\": ", i ? ", " : "", phase_name((PhaseId)i));
        json_number(file, row->phase[i]);
    }
    fputc('}', file);
    json_field(file, "rmse", row->rmse);
    json_field(file, "relmse", row->rel_mse);
    json_field(file, "error", row->error);
    json_field(file, "flip", row->flip);
    json_field(file, "estimate", row->estimate);
    json_field(file, "bound", row->bound);
    json_field(file, "spread", row->spread);
    fprintf(file, ", \"front\": %s}", row->is_front ? "true" : "false");
}

static void json_trend(FILE *file, const StudyTrend *trend)
{
    bool has_fit = trend->fit.count >= 2;
    fprintf(file, "    {\"setting\": \"%s\"", setting_name((SettingId)trend->setting));
    json_text(file, "title", setting_title((SettingId)trend->setting));
    json_field(file, "own", trend->own);
    json_field(file, "samples", trend->is_fine ? FINE_SAMPLES : NAN);
    json_field(file, "best", trend->best);
    json_field(file, "slope", has_fit ? trend->fit.slope : NAN);
    json_field(file, "halving_times", trend->halving);
    fputc('}', file);
}

static void json_advice(FILE *file, const Study *study, const StudyAdvice *advice)
{
    static const char *const kinds[] = {"none", "measured", "extrapolated"};
    char basis[160];
    report_basis(study, advice, basis);
    fprintf(file, "    {\"target\": %g, \"kind\": \"%s\"", advice->target, kinds[advice->kind]);
    json_field(file, "seconds", advice->seconds);
    json_text(file, "how", advice->how);
    json_text(file, "basis", basis);
    fputc('}', file);
}

static void json_reference(FILE *file, const Study *study)
{
    const Truth *truth = &study->truth;
    fputs("  \"reference\": {\"method\": ", file);
    json_string(file, truth->method);
    json_field(file, "seconds", truth->seconds);
    json_field(file, "passes", truth->passes);
    json_field(file, "noise", truth->noise.percentile);
    json_field(file, "noise_rmse", sqrt(truth->noise.square));
    json_field(file, "noise_relmse", truth->noise.rel_square);
    json_field(file, "noise_flip", truth->noise.flip);
    json_field(file, "blur_relmse", truth->rel_blur2);
    fputs("},\n", file);
}

static void json_head(FILE *file, const Study *study)
{
    const RenderOptions *render = &study->options.render;
    fputs("{\n  \"program\": \"pms " PMS_VERSION "\",\n  \"scene\": ", file);
    json_string(file, study->base.scene->path);
    fprintf(file, ",\n  \"width\": %d, \"height\": %d, \"threads\": %d,\n", render->width,
            render->height, render->threads);
    fprintf(file, "  \"runs\": %d, \"runs_done\": %d, \"points_left_out\": %d,\n",
            study_run_count(study), study_done_count(study), study_missing_points(study));
    json_reference(file, study);
}

/* Print the items of a list between brackets. */
#define JSON_LIST(file, name, count, item)                                                         \
    do {                                                                                           \
        fprintf(file, "  \"%s\": [\n", name);                                                      \
        for (int i = 0; i < (count); i++) {                                                        \
            item;                                                                                  \
            fputs(i + 1 < (count) ? ",\n" : "\n", file);                                           \
        }                                                                                          \
        fputs("  ]", file);                                                                        \
    } while (0)

static void json_left_out(FILE *file, const Study *study)
{
    const char *comma = "";
    fputs("  \"left_out\": [", file);
    for (int i = 0; i < study->count; i++) {
        if (study->runs[STUDY_SEEDS * i].is_done && !study->refusals[i])
            continue;
        fprintf(file, "%s\n    {\"setting\": \"%s\"", comma, report_name(&study->points[i]));
        json_text(file, "label", study->points[i].label);
        fprintf(file, ", \"fine\": %s", study->points[i].is_fine ? "true" : "false");
        fprintf(file, ", \"possible\": %s", study->refusals[i] ? "false" : "true");
        json_text(file, "reason", study->refusals[i] ? study->refusals[i] : "no time");
        fputc('}', file);
        comma = ",";
    }
    fputs(*comma ? "\n  ]" : "]", file);
}

void report_print_json(FILE *file, const Study *study)
{
    const StudyAnalysis *all = &study->analysis;
    json_head(file, study);
    JSON_LIST(file, "points", all->row_count, json_row(file, &all->rows[i]));
    fputs(",\n", file);
    JSON_LIST(file, "settings", all->trend_count, json_trend(file, &all->trends[i]));
    fputs(",\n", file);
    JSON_LIST(file, "recommended", STUDY_TARGETS, json_advice(file, study, &all->advice[i]));
    fputs(",\n", file);
    json_left_out(file, study);
    fputs("\n}\n", file);
}

/* --- the terminal --------------------------------------------------------------------------- */

static void print_trends(FILE *file, const Study *study)
{
    const StudyAnalysis *all = &study->analysis;
    fprintf(file, "\n%-16s %8s %12s   %s\n", "setting", "samples", "best error",
            "halving the error takes");
    for (int i = 0; i < all->trend_count; i++) {
        char best[32], halving[48];
        report_percent(all->trends[i].best, best);
        report_halving(&all->trends[i], halving);
        fprintf(file, "%-16s %8s %12s   %s\n", setting_name((SettingId)all->trends[i].setting),
                all->trends[i].is_fine ? "16" : "", best, halving);
    }
}

static void print_front(FILE *file, const Study *study)
{
    const StudyAnalysis *all = &study->analysis;
    fprintf(file, "\nnothing measured is both faster and better than these:\n");
    fprintf(file, "%10s %12s   %s\n", "time", "error", "how");
    for (int i = 0; i < all->front_count; i++) {
        const StudyRow *row = &all->rows[all->front[i]];
        char time[32], error[32];
        report_time(row->seconds, time);
        report_percent(row->error, error);
        fprintf(file, "%10s %12s   %s\n", time, error, row->point->how);
    }
}

static void print_advice(FILE *file, const Study *study)
{
    fprintf(file, "\n%10s %10s   %s\n", "for", "time", "use");
    for (int i = 0; i < STUDY_TARGETS; i++) {
        const StudyAdvice *advice = &study->analysis.advice[i];
        char target[32], time[32] = "-", basis[160];
        report_percent(advice->target, target);
        report_basis(study, advice, basis);
        if (advice->kind != ADVICE_NONE)
            report_time(advice->seconds, time);
        fprintf(file, "%10s %10s   %s%s(%s)\n", target, time, advice->how, *advice->how ? "  " : "",
                basis);
    }
}

/* What cannot be rendered, and what there was no time for. */
static void print_left_out(FILE *file, const Study *study)
{
    const char *head = "\nleft out, since it cannot be rendered\n";
    for (int i = 0; i < study->count; i++) {
        const StudyPoint *point = &study->points[i];
        if (!study->refusals[i])
            continue;
        fprintf(file, "%s%-16s %8s %12s   %s\n", head, report_name(point),
                point->is_fine ? "16" : "", point->label, study->refusals[i]);
        head = "";
    }
    int left = study_left_count(study);
    if (left > 0)
        fprintf(file, "\n%d of %d runs were left out; the same command with more --time goes on\n",
                left, study_run_count(study));
}

void report_print_text(FILE *file, const Study *study)
{
    const Truth *truth = &study->truth;
    const StudyRow *own = study->analysis.rows;
    char error[32], time[32], noise[32] = "unknown";
    if (!isnan(truth->noise.percentile))
        report_percent(truth->noise.percentile, noise);
    report_percent(own->error, error);
    report_time(own->seconds, time);
    fprintf(file,
            "%s at %dx%d takes %s as it stands; the error is %s\n"
            "(95 %% of the pixels have a smaller relative error)\n",
            study->base.scene->path, study->options.render.width, study->options.render.height,
            time, error);
    fprintf(file, "reference: %s; its own noise is %s\n", truth->method, noise);
    print_trends(file, study);
    print_front(file, study);
    print_advice(file, study);
    print_left_out(file, study);
}
