/* What tests of shapes share: an arena, a scratch, random directions.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TESTS_SHAPE_KIT_H
#define PMS_TESTS_SHAPE_KIT_H

#include "base/rng.h"
#include "math/sample.h"
#include "shape/shape.h"

static Arena *arena;
static ShapeScratch *scratch;

static inline int set_up(void **state)
{
    (void)state;
    arena = arena_new();
    scratch = shape_scratch_new();
    return !arena || !scratch;
}

static inline int tear_down(void **state)
{
    (void)state;
    arena_free(arena);
    shape_scratch_free(scratch);
    return 0;
}

static inline V3 random_dir(Rng *rng)
{
    V2 u = {rng_double(rng), 0};
    u.v = rng_double(rng);
    return v3_unit(warp_sphere(u));
}

#endif
