/* Random numbers as a function of where they are used, never of a shared stream.
 *
 * A generator is made from (seed, pass, index) and yields a sequence of its own, so the
 * same photon or pixel sample sees the same numbers on any thread.  The mixer is the
 * finaliser of splitmix64.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_BASE_RNG_H
#define PMS_BASE_RNG_H

#include <stdint.h>

typedef struct Rng {
    uint64_t key;     /* identifies the sequence */
    uint64_t counter; /* position in it */
} Rng;

/* Scramble 64 bits; a bijection with full avalanche. */
static inline uint64_t rng_mix(uint64_t x)
{
    x ^= x >> 30;
    x *= 0xbf58476d1ce4e5b9u;
    x ^= x >> 27;
    x *= 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

/* Return what names the generators of a pass under `seed`. */
static inline uint64_t rng_pass(uint64_t seed, uint32_t pass)
{
    uint64_t key = rng_mix(seed + 0x9e3779b97f4a7c15u);
    return rng_mix(key ^ (uint64_t)pass * 0xd1342543de82ef95u);
}

/* Return the generator of item `index` of what rng_pass named. */
static inline Rng rng_of(uint64_t pass, uint64_t index)
{
    return (Rng){rng_mix(pass ^ index * 0x9e3779b97f4a7c15u), 0};
}

/* Return the generator of item `index` of `pass` under `seed`. */
static inline Rng rng_at(uint64_t seed, uint32_t pass, uint64_t index)
{
    return rng_of(rng_pass(seed, pass), index);
}

static inline uint64_t rng_u64(Rng *rng)
{
    return rng_mix(rng->key + 0x9e3779b97f4a7c15u * ++rng->counter);
}

static inline uint32_t rng_u32(Rng *rng)
{
    return (uint32_t)(rng_u64(rng) >> 32);
}

/* Return a number in [0,1), a multiple of 2^-53. */
static inline double rng_double(Rng *rng)
{
    return (double)(rng_u64(rng) >> 11) * 0x1p-53;
}

/* Return a number in [0,1), a multiple of 2^-24. */
static inline float rng_float(Rng *rng)
{
    return (float)(rng_u64(rng) >> 40) * 0x1p-24f;
}

#endif
