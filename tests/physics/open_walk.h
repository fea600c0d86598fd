/* Light in smoke without end over an endless floor, by walks that share nothing with the program.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TESTS_OPEN_WALK_H
#define PMS_TESTS_OPEN_WALK_H

#include "base/rng.h"
#include "math/v3.h"

#include <math.h>

/* Smoke that scatters evenly and keeps all light, extinction `x`; a floor at y = 0 that keeps half;
 * a lamp of irradiance `power` / (1 + d^2). */
typedef struct OpenAir {
    double x, power;
    V3 lamp;
} OpenAir;

static inline double open_lamp(const OpenAir *air, V3 p, double *cosine)
{
    V3 to = v3_sub(air->lamp, p);
    double d = v3_len(to);
    *cosine = to.y / d;
    return air->power / (1 + d * d) * exp(-air->x * d);
}

static inline V3 open_direction(Rng *rng)
{
    double z = 2 * rng_double(rng) - 1, around = 2 * PMS_PI * rng_double(rng), r = sqrt(1 - z * z);
    return v3(r * cos(around), r * sin(around), z);
}

/* What one walk from p in direction d finds. */
static inline double open_walk(const OpenAir *air, V3 p, V3 d, Rng *rng)
{
    enum { SURE_TURNS = 20 };
    double found = 0, weight = 1, cosine;
    for (int turn = 0;; turn++) {
        double floor = d.y < 0 ? -p.y / d.y : INFINITY, way = -log1p(-rng_double(rng)) / air->x;
        p = v3_mad(p, fmin(way, floor), d);
        double light = weight * open_lamp(air, p, &cosine);
        if (way < floor) {
            found += light / 4;
            d = open_direction(rng);
        } else {
            weight /= 2;
            found += light / 2 * fmax(cosine, 0);
            d = v3_unit(v3_add(v3(0, 1, 0), open_direction(rng)));
            p.y = 0;
        }
        double chance = turn < SURE_TURNS ? 1 : fmin(weight, 0.98);
        if (!(rng_double(rng) < chance))
            return found;
        weight /= chance;
    }
}

#endif
