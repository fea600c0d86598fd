/* What each effect costs: counts of what was done for it, and its share of all the work.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_RENDER_COST_H
#define PMS_RENDER_COST_H

#include "base/stats.h"
#include "plan/plan.h"

/* The kinds of work, one after the other as in cost.def: an effect may have several. */
enum {
    COST_COUNT = 0
#define X(feature, unit, weight, ...) +1
#include "render/cost.def"
#undef X
};

typedef struct Costs {
    double count[COST_COUNT];
} Costs;

/* Return the effect a kind of work is for; FEATURE_COUNT: for any picture. */
FeatureId cost_feature(int cost);
/* Return what is counted: "shadow rays". */
const char *cost_unit(int cost);

/* Return true if what is counted are photons that estimates are made of. */
bool cost_is_of_estimates(int cost);

/* Find what was done for the effects of a plan in a run with these counters. */
void costs_find(const Plan *plan, const Stats *stats, Costs *out);

/* Return all the work, in the unit of the weights of cost.def. */
double costs_work(const Costs *costs);

/* Return work as a part of all: of one kind, and of an effect (FEATURE_COUNT: of any picture). */
double costs_share_of(const Costs *costs, int cost);
double costs_share(const Costs *costs, FeatureId feature);

#endif
