/* Statistics.  SPDX-License-Identifier: Apache-2.0 */
#include "base/stats.h"

#include <time.h>

const char *stat_name(StatId id)
{
    static const char *const names[] = {
#define X(id_, name, text) name,
#include "base/stat.def"
#undef X
    };
    return names[id];
}

const char *phase_name(PhaseId id)
{
    static const char *const names[] = {
#define X(id_, name) name,
#include "base/phase.def"
#undef X
    };
    return names[id];
}

void stats_add(Stats *into, const Stats *from)
{
    for (int i = 0; i < STAT_COUNT; i++)
        into->count[i] += from->count[i];
    for (int i = 0; i < PHASE_COUNT; i++)
        into->seconds[i] += from->seconds[i];
}

static double clock_of(clockid_t id)
{
    struct timespec now;
    clock_gettime(id, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

double clock_wall(void)
{
    return clock_of(CLOCK_MONOTONIC);
}

double clock_cpu(void)
{
    return clock_of(CLOCK_PROCESS_CPUTIME_ID);
}
