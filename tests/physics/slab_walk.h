/* Light in a slab of smoke by a walk that shares nothing with the program.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TESTS_SLAB_WALK_H
#define PMS_TESTS_SLAB_WALK_H

#include "base/rng.h"

#include <math.h>

/* A slab lit along its normal, seen along it, scattering evenly: the light scattered more than once
 * that comes back, by walks that send to the eye at every turn but the first. */
static inline double slab_walk(double depth, double albedo, int walks, double *error)
{
    double sum = 0, squares = 0;
    for (int i = 0; i < walks; i++) {
        Rng rng = rng_at(23, 0, (uint64_t)i);
        double z = 0, mu = 1, weight = 1, got = 0;
        for (int turn = 0; turn < 1000; turn++) {
            z += -log1p(-rng_double(&rng)) * mu;
            if (!(z > 0 && z < depth))
                break;
            weight *= albedo;
            if (turn > 0)
                got += weight * exp(-z);
            mu = 2 * rng_double(&rng) - 1;
        }
        sum += got / walks;
        squares += got * got / walks;
    }
    *error = sqrt((squares - sum * sum) / walks);
    return sum;
}

#endif
