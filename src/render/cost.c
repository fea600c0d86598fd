/* What each effect costs.  SPDX-License-Identifier: Apache-2.0 */
#include "render/cost.h"

#include <assert.h>

enum { LESS_MAX = 6 };

typedef struct CostInfo {
    FeatureId feature;
    const char *unit;
    double weight;
    StatId counter, less[LESS_MAX]; /* less[i] 0: there are no more */
} CostInfo;

static_assert(STAT_CAMERA_RAYS == 0, "no effect's counter is the end of a list");

static const CostInfo infos[COST_COUNT] = {
#define X(feature, unit, weight, stat, ...) {feature, unit, weight, stat, {__VA_ARGS__}},
#include "render/cost.def"
#undef X
};

FeatureId cost_feature(int cost)
{
    return infos[cost].feature;
}

const char *cost_unit(int cost)
{
    return infos[cost].unit;
}

bool cost_is_of_estimates(int cost)
{
    StatId counter = infos[cost].counter;
    return counter == STAT_GATHERED || counter == STAT_GATHERED_CAUSTIC ||
           counter == STAT_GATHERED_VOLUME;
}

void costs_find(const Plan *plan, const Stats *stats, Costs *out)
{
    for (int i = 0; i < COST_COUNT; i++) {
        const CostInfo *info = &infos[i];
        out->count[i] = (double)stats->count[info->counter];
        for (int k = 0; k < LESS_MAX && info->less[k]; k++)
            out->count[i] -= (double)stats->count[info->less[k]];
        if (info->feature != FEATURE_COUNT && !plan_has(plan, info->feature))
            out->count[i] = 0;
    }
}

static double work_of(const Costs *costs, int cost)
{
    return costs->count[cost] * infos[cost].weight;
}

double costs_work(const Costs *costs)
{
    double all = 0;
    for (int i = 0; i < COST_COUNT; i++)
        all += work_of(costs, i);
    return all;
}

double costs_share_of(const Costs *costs, int cost)
{
    double all = costs_work(costs);
    return all > 0 ? work_of(costs, cost) / all : 0;
}

double costs_share(const Costs *costs, FeatureId feature)
{
    double sum = 0;
    for (int i = 0; i < COST_COUNT; i++)
        sum += infos[i].feature == feature ? costs_share_of(costs, i) : 0;
    return sum;
}
