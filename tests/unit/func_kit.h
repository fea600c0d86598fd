/* Functions of random steps, for tests.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TESTS_FUNC_KIT_H
#define PMS_TESTS_FUNC_KIT_H

#include "base/rng.h"
#include "math/func.h"

#include <math.h>

enum { KIT_STEPS = 12 };

/* A function of x, y, z of random steps, the last of which is its value. */
static inline const Func *random_func(Arena *arena, Rng *rng)
{
    FuncBuilder b;
    static Arena *tables;
    static const Noise *noise;
    if (!noise) {
        tables = arena_new();
        noise = noise_new(tables);
    }
    func_begin(&b, 3);
    b.noise = noise;
    int nodes[3 + 2 + KIT_STEPS] = {func_param(&b, 0), func_param(&b, 1), func_param(&b, 2)};
    int count = 3;
    nodes[count++] = func_const(&b, floor(rng_double(rng) * 7) - 3);
    nodes[count++] = func_const(&b, rng_double(rng) * 4 - 2);
    while (count < 3 + 2 + KIT_STEPS) {
        int from[FUNC_FROM_MAX];
        for (int i = 0; i < FUNC_FROM_MAX; i++)
            from[i] = nodes[(int)(rng_double(rng) * count)];
        FuncOp op = (FuncOp)(rng_double(rng) * FUNC_OP_COUNT);
        if (op == FUNC_NOISE3) /* goes up in steps of 2e-9, which tests would take for jumps */
            op = FUNC_NOISE2;
        nodes[count] = func_step(&b, op, from);
        count++;
    }
    return func_end(arena, &b, nodes[count - 1]);
}

#endif
