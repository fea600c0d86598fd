/* A claim of the self-test: what was expected, what was found, and whether that holds.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SELFTEST_CLAIM_H
#define PMS_SELFTEST_CLAIM_H

#include <stdbool.h>

/* What chance decides may be off by so many standard errors. */
#define CLAIM_ERRORS_MOST 4.0

/* A standard error above this part of what is expected shows nothing: the claim does not hold. */
#define CLAIM_ERROR_PART 0.02

typedef struct Claim {
    const char *name; /* "inverse square" */
    const char *what; /* what is measured, in words */
    double expected, measured;
    double error; /* standard error of `measured`; 0: no chance in it */
    double limit; /* how much it may be off but for chance, relative; absolute where nothing is
                     expected */
} Claim;

/* Make the claim that the mean of `count` measurements is what is expected: chance is in it if
 * they differ so much that their mean may be off by more than the limit. */
Claim claim_of_mean(const char *name, const char *what, const double *measured, int count,
                    double expected, double limit);

static inline bool claim_has_chance(const Claim *claim)
{
    return claim->error > 0;
}

/* Return how much it is off: in standard errors if chance is in it, else as `limit`. */
double claim_off(const Claim *claim);

/* Return how much it may be off, chance included, in the same unit. */
double claim_limit(const Claim *claim);

bool claim_holds(const Claim *claim);

#endif
