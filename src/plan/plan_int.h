/* Parts of the plan; for plan/ only.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_PLAN_PLAN_INT_H
#define PMS_PLAN_PLAN_INT_H

#include "plan/plan.h"

/* Return the least quality that has an effect; see feature.def. */
int feature_quality(FeatureId feature);

/* Fill a row, the reason as printf does; returns is_on. */
bool row_set(PlanRow *row, bool is_on, Span why, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Return true if the quality asked for has an effect, or the command line forces it. */
bool row_has_quality(const PlanOptions *options, FeatureId feature);

/* Fill the row of an effect that command line or quality rule out; returns whether they do. */
bool row_ruled_out(const PlanOptions *options, FeatureId feature, PlanRow *rows);

/* Note in the rows, when all are filled, what the command line forced. */
void rows_tell_forced(const PlanOptions *options, PlanRow *rows);

/* Set the rows of media, fog and rainbows. */
void plan_media(const Scene *scene, const PlanOptions *options, PlanRow *rows);

/* Return true if some medium that is seen gives off light. */
bool plan_media_glow(const Scene *scene);

/* Set the row of the volume map and what it holds, when all other rows are set. */
void plan_volume(const Scene *scene, const PlanOptions *options, Plan *plan);

#endif
