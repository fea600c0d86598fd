/* Parts of the plan; for plan/ only.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_PLAN_PLAN_INT_H
#define PMS_PLAN_PLAN_INT_H

#include "plan/plan.h"

/* Set the rows of media, fog and rainbows. */
void plan_media(const Scene *scene, int quality, PlanRow *rows);

/* Return true if some medium that is seen gives off light. */
bool plan_media_glow(const Scene *scene);

/* Set the row of the volume map and what it holds, when all other rows are set. */
void plan_volume(const Scene *scene, Plan *plan);

#endif
