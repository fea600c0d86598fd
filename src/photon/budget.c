/* Sharing a number of photons by weight.  SPDX-License-Identifier: Apache-2.0 */
#include "photon/photon_pass.h"

/* What is left of an exact share when its whole part has been given. */
static double remainder_of(double weight, double sum, uint64_t total, uint64_t given)
{
    return weight > 0 ? weight / sum * (double)total - (double)given : -1;
}

/* Weights that are not positive numbers count as 0; infinite ones cannot be shared by. */
static double usable(double weight)
{
    return weight > 0 && isfinite(weight) ? weight : 0;
}

void photon_budget(const double *weights, int count, uint64_t total, uint64_t *shares)
{
    double largest = 0, sum = 0;
    for (int i = 0; i < count; i++)
        largest = fmax(largest, usable(weights[i]));
    for (int i = 0; i < count; i++)
        sum += largest > 0 ? usable(weights[i]) / largest : 0; /* so that no sum overflows */
    uint64_t left = sum > 0 ? total : 0;
    for (int i = 0; i < count; i++) {
        double exact = sum > 0 ? usable(weights[i]) / largest / sum * (double)total : 0;
        shares[i] = (uint64_t)exact < left ? (uint64_t)exact : left;
        left -= shares[i];
    }
    /* The rest, one each, to the largest remainders; of equal ones to the first. */
    while (left > 0) {
        int best = -1;
        double best_rest = -1;
        for (int i = 0; i < count; i++) {
            double rest = remainder_of(usable(weights[i]) / largest, sum, total, shares[i]);
            if (rest > best_rest) {
                best = i;
                best_rest = rest;
            }
        }
        if (best < 0) /* rounding left more than one each: the heaviest takes it */
            break;
        shares[best]++;
        left--;
    }
}
