/* Which run of a study comes next.  SPDX-License-Identifier: Apache-2.0 */
#include "study/schedule.h"

#include <math.h>

/* How much later a run of the next seed comes: as if it cost so many times more.  Of a setting that
 * is tried with more samples, too, those runs tell more than other seeds. */
#define SEED_WEIGHT 2
#define SEED_WEIGHT_COARSE 16

/* Ways to render are what is recommended in the end: they come as if they cost less. */
#define WAY_WEIGHT 0.5

/* Return the seconds of the scene as it stands times what a point is taken to cost more. */
static double model_cost(const Study *study, const StudyPoint *point)
{
    const double *phase = study->runs[0].phase;
    double photons = phase[PHASE_INDEX] + phase[PHASE_PHOTON_EMIT] + phase[PHASE_PHOTON_BUILD];
    double eye = phase[PHASE_IRRADIANCE] + phase[PHASE_EYE];
    return photons * point->photon_cost + eye * point->eye_cost;
}

/* Return the mean seconds of the runs of a point that are done; NaN: none is. */
static double measured_cost(const Study *study, int point)
{
    double sum = 0;
    int count = 0;
    for (int s = 0; s < STUDY_SEEDS; s++) {
        const StudyRun *run = &study->runs[STUDY_SEEDS * point + s];
        sum += run->is_done ? run->seconds : 0;
        count += run->is_done;
    }
    return count ? sum / count : NAN;
}

/* Return true for points of the same setting, alike in samples. */
static bool is_like(const StudyPoint *a, const StudyPoint *b)
{
    return a->setting == b->setting && a->is_fine == b->is_fine;
}

/* The model is put right by the costliest point of the same setting that was measured. */
double schedule_cost(const Study *study, int point)
{
    double measured = measured_cost(study, point), most = 0, factor = 1;
    if (!isnan(measured))
        return measured;
    if (study->points[point].seconds > 0)
        return study->points[point].seconds;
    for (int i = 1; i < study->count; i++) {
        double other = measured_cost(study, i), model = model_cost(study, &study->points[i]);
        bool is_same = is_like(&study->points[i], &study->points[point]);
        if (!is_same || isnan(other) || !(model > most))
            continue;
        most = model;
        factor = other / model;
    }
    return factor * model_cost(study, &study->points[point]);
}

static bool is_pending(const Study *study, int run)
{
    return !study->runs[run].is_done && !study->is_left[run] && !study->refusals[run / STUDY_SEEDS];
}

double schedule_rest(const Study *study)
{
    double sum = 0;
    for (int i = 0; i < STUDY_SEEDS * study->count; i++)
        sum += is_pending(study, i) ? schedule_cost(study, i / STUDY_SEEDS) : 0;
    return sum;
}

/* Return true if no other point of the setting that can be rendered is cheaper, or was rendered
 * already. */
static bool is_first_of_setting(const Study *study, int point)
{
    for (int i = 1; i < study->count; i++) {
        bool is_other = i != point && !study->refusals[i];
        if (!is_other || !is_like(&study->points[i], &study->points[point]))
            continue;
        double cost = schedule_cost(study, i), own = schedule_cost(study, point);
        if (study->runs[STUDY_SEEDS * i].is_done || cost < own || (cost == own && i < point))
            return false;
    }
    return true;
}

static bool is_coarse(const Study *study, int point)
{
    const StudyPoint *points = study->points;
    for (int i = 0; i < study->count; i++)
        if (points[i].is_fine && points[i].setting == points[point].setting)
            return !points[point].is_fine;
    return false;
}

static bool is_way(const StudyPoint *point)
{
    return point->setting != SETTING_OWN && setting_kind((SettingId)point->setting) == SETTING_WAYS;
}

int schedule_next(const Study *study)
{
    int best = -1;
    double least = INFINITY;
    for (int i = 0; i < STUDY_SEEDS * study->count; i++) {
        int point = i / STUDY_SEEDS, seed = i % STUDY_SEEDS;
        if (!is_pending(study, i))
            continue;
        double weight = is_coarse(study, point) ? SEED_WEIGHT_COARSE : SEED_WEIGHT;
        double score = schedule_cost(study, point) * (1 + weight * seed);
        if (is_way(&study->points[point]))
            score *= WAY_WEIGHT;
        if (seed == 0 && !study->points[point].is_fine && is_first_of_setting(study, point))
            score -= 1e9; /* before all others, the cheapest first */
        if (score < least) {
            least = score;
            best = i;
        }
    }
    return best;
}
