/* Statistics: counters and seconds of a run.  Each thread counts in its own Stats; they are
 * added up when a phase ends.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_BASE_STATS_H
#define PMS_BASE_STATS_H

#include <stdint.h>
#include <stdio.h>

typedef enum StatId {
#define X(id, name, text) id,
#include "base/stat.def"
#undef X
    STAT_COUNT
} StatId;

typedef enum PhaseId {
#define X(id, name) id,
#include "base/phase.def"
#undef X
    PHASE_COUNT
} PhaseId;

typedef struct Stats {
    uint64_t count[STAT_COUNT];
    double seconds[PHASE_COUNT]; /* wall */
} Stats;

/* Return the dotted name of a counter, as --stats writes it. */
const char *stat_name(StatId id);

/* Return the name of a phase. */
const char *phase_name(PhaseId id);

/* Add the counters and seconds of `from` to `into`. */
void stats_add(Stats *into, const Stats *from);

/* Count an accident that is tolerable when rare; returns `happened`. */
static inline int stat_rare(Stats *stats, StatId id, int happened)
{
    stats->count[id] += happened != 0;
    return happened;
}

/* Return seconds of a clock that only goes forward. */
double clock_wall(void);

/* Return the processor seconds this process has used. */
double clock_cpu(void);

#endif
