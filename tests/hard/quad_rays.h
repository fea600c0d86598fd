/* The rays of the oracle: random ones, and those that are hard.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TESTS_QUAD_RAYS_H
#define PMS_TESTS_QUAD_RAYS_H

#include "quad_world.h"

#include "base/rng.h"
#include "math/v3.h"

/* What rays at a model are made with. */
typedef struct RayMaker {
    Model *model; /* in the world of double */
    Rng rng;
    V3 lo, hi;   /* around the shape, or the middle of it if that is infinite */
    double size; /* of this box */
} RayMaker;

typedef struct TestRay {
    V3 o, d;
} TestRay;

typedef struct RayKind {
    const char *name;
    bool is_hard;
    TestRay (*make)(RayMaker *maker);
} RayKind;

enum { RAY_KINDS = 9 };
extern const RayKind ray_kinds[RAY_KINDS];

void ray_maker_init(RayMaker *maker, Model *model, uint64_t seed);

/* Return ray number i: those of even numbers are random ones. */
TestRay ray_make(RayMaker *maker, long i, const RayKind **kind);

V3 random_unit(Rng *rng);

#endif
