/* Claims.  SPDX-License-Identifier: Apache-2.0 */
#include "selftest/claim.h"

#include <math.h>

Claim claim_of_mean(const char *name, const char *what, const double *measured, int count,
                    double expected, double limit)
{
    double sum = 0, squares = 0;
    for (int i = 0; i < count; i++)
        sum += measured[i];
    double mean = sum / count;
    for (int i = 0; i < count; i++)
        squares += (measured[i] - mean) * (measured[i] - mean);
    double error = count > 1 ? sqrt(squares / (count - 1) / count) : 0;
    if (!(CLAIM_ERRORS_MOST * error > limit * fabs(expected)))
        error = 0;
    return (Claim){name, what, expected, mean, error, limit};
}

double claim_off(const Claim *claim)
{
    double off = fabs(claim->measured - claim->expected);
    if (claim_has_chance(claim))
        return off / claim->error;
    return claim->expected != 0 ? off / fabs(claim->expected) : off;
}

double claim_limit(const Claim *claim)
{
    if (!claim_has_chance(claim))
        return claim->limit;
    return CLAIM_ERRORS_MOST + claim->limit * fabs(claim->expected) / claim->error;
}

bool claim_holds(const Claim *claim)
{
    bool is_sharp = !(claim->error > CLAIM_ERROR_PART * fabs(claim->expected));
    return is_sharp && claim_off(claim) <= claim_limit(claim);
}
