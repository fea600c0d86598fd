/* Which run of a study comes next, and what it will take.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_STUDY_SCHEDULE_H
#define PMS_STUDY_SCHEDULE_H

#include "study/study.h"

/* Return the seconds that a run of a point is expected to take, from those that are done. */
double schedule_cost(const Study *study, int point);

/* Return the seconds of all runs that are neither done nor left out. */
double schedule_rest(const Study *study);

/* Return the number of the next run (STUDY_SEEDS * point + seed); -1: none is left.  The cheapest
 * value of every setting comes first, then what costs little, and seeds after the first later. */
int schedule_next(const Study *study);

#endif
