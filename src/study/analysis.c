/* What the runs of a study say.  SPDX-License-Identifier: Apache-2.0 */
#include "study/analysis.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A square below this part of that of the reference's noise cannot be told from 0. */
#define SQUARE_PART 0.2

/* On the front an error must be below this part of that of the next faster one. */
#define GAIN_LEAST 0.97

/* Seconds must spread by this factor for a slope to mean anything. */
#define SPREAD_LEAST 1.3

/* An error that falls by less than this power of the seconds does not pay. */
#define SLOPE_LEAST 0.05

/* An error that grows by more than this power of the seconds is no accident. */
#define SLOPE_WORSE 0.1

/* A trend is followed to so many times the seconds it was measured at, no further. */
#define FOLLOW_MOST 1000

const double *study_targets(void)
{
    static const double targets[STUDY_TARGETS] = {0.05, 0.01, 0.002};
    return targets;
}

/* --- rows ----------------------------------------------------------------------------------- */

/* What chance makes of the reference adds to the error of a picture as squares do. */
static double error_of(const StudyRun *run, double noise)
{
    double least = isnan(noise) ? 0 : noise * noise;
    double square = run->error.percentile * run->error.percentile - least;
    return square > SQUARE_PART * least ? sqrt(square) : NAN;
}

/* The mean and the standard deviation of the errors. */
static void find_errors(const StudyRun *runs, double noise, StudyRow *row)
{
    double sum = 0, squares = 0;
    for (int s = 0; s < STUDY_SEEDS; s++) {
        double error = runs[s].is_done ? error_of(&runs[s], noise) : 0;
        sum += error;
        squares += error * error;
    }
    double count = row->seeds, variance = (squares - sum * sum / count) / (count - 1);
    row->error = sum / count;
    row->spread = count > 1 && !isnan(variance) ? sqrt(fmax(0, variance)) : NAN;
}

static void add_run(const StudyRun *run, StudyRow *row)
{
    if (row->seeds++ == 0 || run->seconds < row->seconds) {
        row->seconds = run->seconds;
        memcpy(row->phase, run->phase, sizeof row->phase);
    }
    row->rmse += run->error.square;
    row->rel_mse += run->error.rel_square;
    row->flip += run->error.flip;
    row->estimate += run->estimate;
    row->bound += run->bound;
}

/* Make the row of a point; false: it has no run. */
static bool make_row(const StudyPoint *point, const StudyRun *runs, double noise, StudyRow *row)
{
    *row = (StudyRow){.point = point};
    for (int s = 0; s < STUDY_SEEDS; s++)
        if (runs[s].is_done)
            add_run(&runs[s], row);
    if (row->seeds == 0)
        return false;
    double scale = 1.0 / row->seeds;
    row->rmse = sqrt(fmax(0, row->rmse * scale));
    row->rel_mse = fmax(0, row->rel_mse * scale);
    row->flip *= scale;
    row->estimate *= scale;
    row->bound *= scale;
    find_errors(runs, noise, row);
    return true;
}

/* --- the front ------------------------------------------------------------------------------ */

int study_front(const double *seconds, const double *errors, int count, bool *is_front)
{
    int found = 0;
    for (int i = 0; i < count; i++) {
        is_front[i] = errors[i] > 0;
        for (int j = 0; j < count && is_front[i]; j++) {
            bool is_as_good = seconds[j] <= seconds[i] && errors[j] <= errors[i];
            bool is_better = seconds[j] < seconds[i] || errors[j] < errors[i] || j < i;
            is_front[i] = !(j != i && is_as_good && is_better);
        }
        found += is_front[i];
    }
    return found;
}

/* Take off the front, which is in order of seconds, what is hardly better than what is faster. */
static void thin_front(StudyAnalysis *out)
{
    int kept = 0;
    for (int i = 0; i < out->front_count; i++) {
        StudyRow *row = &out->rows[out->front[i]];
        row->is_front =
            kept == 0 || row->error < GAIN_LEAST * out->rows[out->front[kept - 1]].error;
        if (row->is_front)
            out->front[kept++] = out->front[i];
    }
    out->front_count = kept;
}

static Status find_front(StudyAnalysis *out, Arena *arena)
{
    int count = out->row_count;
    double *seconds = ARENA_ARRAY(arena, double, (size_t)count);
    double *errors = ARENA_ARRAY(arena, double, (size_t)count);
    bool *is_front = ARENA_ARRAY(arena, bool, (size_t)count);
    out->front = ARENA_ARRAY(arena, int, (size_t)count);
    if (!seconds || !errors || !is_front || !out->front)
        return ERR_MEMORY;
    for (int i = 0; i < count; i++) {
        seconds[i] = out->rows[i].seconds;
        errors[i] = out->rows[i].error;
    }
    study_front(seconds, errors, count, is_front);
    for (int i = 0; i < count; i++) {
        if (!is_front[i])
            continue;
        int at = out->front_count++;
        for (; at > 0 && seconds[out->front[at - 1]] > seconds[i]; at--)
            out->front[at] = out->front[at - 1];
        out->front[at] = i;
    }
    thin_front(out);
    return OK;
}

/* --- trends --------------------------------------------------------------------------------- */

StudyFit study_fit(const double *seconds, const double *errors, int count)
{
    StudyFit fit = {.lo = INFINITY, .hi = 0};
    double x = 0, y = 0, xx = 0, xy = 0;
    for (int i = 0; i < count; i++) {
        if (!(seconds[i] > 0) || !(errors[i] > 0))
            continue;
        double a = log(seconds[i]), b = log(errors[i]);
        fit.count++;
        x += a;
        y += b;
        xx += a * a;
        xy += a * b;
        fit.lo = fmin(fit.lo, seconds[i]);
        fit.hi = fmax(fit.hi, seconds[i]);
    }
    double n = fit.count, spread = n * xx - x * x;
    if (fit.count < 2 || !(fit.hi > SPREAD_LEAST * fit.lo)) {
        fit.count = 0;
        return fit;
    }
    fit.slope = (n * xy - x * y) / spread;
    fit.base = (y - fit.slope * x) / n;
    return fit;
}

static double value_of(const StudyTrend *trend, const StudyRow *rows, int row)
{
    return row == trend->own_row ? trend->own : rows[row].point->value;
}

double study_trend_value(const StudyAnalysis *all, const StudyTrend *trend, int i)
{
    return value_of(trend, all->rows, trend->rows[i]);
}

static void insert_row(StudyTrend *trend, const StudyRow *rows, int row)
{
    double value = value_of(trend, rows, row);
    int at = trend->count++;
    for (; at > 0 && value_of(trend, rows, trend->rows[at - 1]) > value; at--)
        trend->rows[at] = trend->rows[at - 1];
    trend->rows[at] = row;
}

/* Return the row that has the scene's own value of every setting: of the scene as it stands, or
 * with more samples; -1: it was not measured. */
static int find_own(const StudyAnalysis *all, bool is_fine)
{
    for (int i = 0; i < all->row_count && is_fine; i++) {
        const StudyPoint *point = all->rows[i].point;
        if (point->setting == SETTING_SAMPLES && point->value == FINE_SAMPLES)
            return i;
    }
    return is_fine ? -1 : 0;
}

/* Collect the rows of a setting; false: it has none but the scene's own. */
static bool collect_rows(const StudyBase *base, const StudyAnalysis *all, StudyTrend *out)
{
    SettingId setting = (SettingId)out->setting;
    bool has_own = setting_kind(setting) != SETTING_WAYS;
    out->own = has_own ? setting_own(setting, base) : NAN;
    out->own_row = has_own ? find_own(all, out->is_fine) : -1;
    for (int i = 1; i < all->row_count; i++)
        if (all->rows[i].point->setting == out->setting &&
            all->rows[i].point->is_fine == out->is_fine)
            insert_row(out, all->rows, i);
    bool has_rows = out->count > 0 && (!out->is_fine || out->own_row >= 0);
    if (has_rows && out->own_row >= 0)
        insert_row(out, all->rows, out->own_row);
    return has_rows;
}

/* Return true if the point that should cost most has a larger error than the one that should cost
 * least.  Seconds do not tell: a busy machine spoils the short ones. */
static bool grows_with_cost(const StudyTrend *trend, const StudyRow *rows)
{
    double least = INFINITY, most = 0, error_least = NAN, error_most = NAN;
    for (int i = 0; i < trend->count; i++) {
        const StudyRow *row = &rows[trend->rows[i]];
        double cost = row->point->photon_cost + row->point->eye_cost;
        if (cost < least) {
            least = cost;
            error_least = row->error;
        }
        if (cost > most) {
            most = cost;
            error_most = row->error;
        }
    }
    return error_most > error_least;
}

/* Find the trend of a setting. */
static bool make_trend(const StudyBase *base, int setting, bool is_fine, const StudyAnalysis *all,
                       StudyTrend *out)
{
    double seconds[SETTING_VALUES_MAX + 1], errors[SETTING_VALUES_MAX + 1];
    *out = (StudyTrend){.setting = setting, .is_fine = is_fine, .best = INFINITY};
    if (!collect_rows(base, all, out))
        return false;
    for (int i = 0; i < out->count; i++) {
        const StudyRow *row = &all->rows[out->rows[i]];
        seconds[i] = row->seconds;
        errors[i] = row->error;
        out->best = row->error < out->best ? row->error : out->best;
    }
    out->part = out->best / all->rows[out->own_row >= 0 ? out->own_row : 0].error;
    bool has_order = setting_kind((SettingId)setting) != SETTING_WORDS;
    out->fit = study_fit(seconds, errors, has_order ? out->count : 0);
    bool falls = out->fit.count >= 2 && out->fit.slope < -SLOPE_LEAST;
    out->is_worse =
        out->fit.count >= 2 && out->fit.slope > SLOPE_WORSE && grows_with_cost(out, all->rows);
    out->halving = falls ? pow(2, -1 / out->fit.slope) : INFINITY;
    return true;
}

/* Where a setting was tried with more samples, too, that trend tells more. */
static void find_trends(const StudyBase *base, StudyAnalysis *out)
{
    for (int setting = 0; setting < SETTING_COUNT; setting++) {
        StudyTrend trend;
        if (!make_trend(base, setting, true, out, &trend) &&
            !make_trend(base, setting, false, out, &trend))
            continue;
        int at = out->trend_count++;
        for (; at > 0 && out->trends[at - 1].part > trend.part; at--)
            out->trends[at] = out->trends[at - 1];
        out->trends[at] = trend;
    }
}

/* --- advice --------------------------------------------------------------------------------- */

static bool is_way(const StudyTrend *trend)
{
    return setting_kind((SettingId)trend->setting) == SETTING_WAYS;
}

/* Follow a trend to the target: its seconds and the point there.  Ways to render alone go on for
 * ever; any other setting ends at what the rest of the scene leaves. */
static bool follow(const StudyBase *base, const StudyAnalysis *all, const StudyTrend *trend,
                   double target, StudyAdvice *out)
{
    if (!is_way(trend) || !isfinite(trend->halving))
        return false;
    int last = trend->rows[trend->count - 1];
    const StudyRow *row = &all->rows[last];
    double times = pow(row->error / target, -1 / trend->fit.slope);
    if (!(times > 1 && times <= FOLLOW_MOST))
        return false;
    StudyPoint point;
    double value = ceil(row->point->value * times * (1 - 1e-9)); /* not one more by rounding */
    if (setting_point((SettingId)trend->setting, base, value, false, &point) != OK)
        return false;
    *out = (StudyAdvice){.target = target,
                         .kind = ADVICE_EXTRAPOLATED,
                         .row = last,
                         .seconds = row->seconds * times,
                         .error = target};
    memcpy(out->how, point.how, sizeof out->how);
    return true;
}

static void advise(const StudyBase *base, const StudyAnalysis *all, double target, StudyAdvice *out)
{
    *out = (StudyAdvice){.target = target, .seconds = INFINITY};
    for (int i = 0; i < all->front_count; i++) { /* by seconds: the first is the cheapest */
        const StudyRow *row = &all->rows[all->front[i]];
        out->row = all->front[i];
        out->error = row->error;
        if (row->error > target)
            continue;
        out->kind = ADVICE_MEASURED;
        out->seconds = row->seconds;
        memcpy(out->how, row->point->how, sizeof out->how);
        return;
    }
    for (int i = 0; i < all->trend_count; i++) {
        StudyAdvice way;
        if (follow(base, all, &all->trends[i], target, &way) && way.seconds < out->seconds)
            *out = way;
    }
}

Status study_analyse(const StudyBase *base, const StudyPoint *points, int count,
                     const StudyRun *runs, double noise, Arena *arena, StudyAnalysis *out)
{
    *out = (StudyAnalysis){.rows = ARENA_ARRAY(arena, StudyRow, (size_t)count)};
    if (!out->rows)
        return ERR_MEMORY;
    for (int i = 0; i < count; i++) {
        bool has_run =
            make_row(&points[i], &runs[STUDY_SEEDS * i], noise, &out->rows[out->row_count]);
        if (i == 0 && !has_run)
            return OK;
        out->row_count += has_run;
    }
    TRY(find_front(out, arena));
    find_trends(base, out);
    for (int i = 0; i < STUDY_TARGETS; i++)
        advise(base, out, study_targets()[i], &out->advice[i]);
    return OK;
}
