/* Low-discrepancy points and warps.
 *
 * The sequence is the first two dimensions of Sobol's, whose generator matrices are the
 * identity and Pascal's triangle modulo 2; the scramble hashes each digit with the ones
 * above it, so that the points stay a net.  SPDX-License-Identifier: Apache-2.0 */
#include "math/sample.h"

#include "base/rng.h"

static uint32_t reverse_bits(uint32_t x)
{
    x = (x >> 16) | (x << 16);
    x = ((x & 0x00ff00ffu) << 8) | ((x & 0xff00ff00u) >> 8);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x & 0xf0f0f0f0u) >> 4);
    x = ((x & 0x33333333u) << 2) | ((x & 0xccccccccu) >> 2);
    return ((x & 0x55555555u) << 1) | ((x & 0xaaaaaaaau) >> 1);
}

/* Permute so that each bit depends only on itself and lower ones: multiplications and
 * additions carry upward only.  On reversed numbers this is an Owen scramble. */
static uint32_t mix_upward(uint32_t x, uint32_t seed)
{
    x += seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return x;
}

/* Scramble a fraction whose digits are given in reverse. */
static uint32_t scramble_reversed(uint32_t x, uint32_t seed)
{
    return reverse_bits(mix_upward(x, seed));
}

/* Second Sobol dimension, as a reversed fraction: digit j is the sum of the digits i of the
 * index whose bits include those of j (binomials modulo 2, by Lucas), all five bits in turn. */
static uint32_t sobol_second_reversed(uint32_t index)
{
    index ^= (index >> 1) & 0x55555555u;
    index ^= (index >> 2) & 0x33333333u;
    index ^= (index >> 4) & 0x0f0f0f0fu;
    index ^= (index >> 8) & 0x00ff00ffu;
    return index ^ (index >> 16);
}

static double to_unit(uint32_t x)
{
    return x * 0x1p-32;
}

V2 sample_2d(uint32_t index, uint64_t key)
{
    uint64_t seeds = rng_mix(key + 0x9e3779b97f4a7c15u), more = rng_mix(seeds + key);
    index = reverse_bits(mix_upward(reverse_bits(index), (uint32_t)more));
    uint32_t first = scramble_reversed(index, (uint32_t)seeds);
    uint32_t second = scramble_reversed(sobol_second_reversed(index), (uint32_t)(seeds >> 32));
    return (V2){to_unit(first), to_unit(second)};
}

double sample_1d(uint32_t index, uint64_t key)
{
    return sample_2d(index, key).u;
}

double sample_inverse(uint32_t index, uint64_t key)
{
    return to_unit(scramble_reversed(index, (uint32_t)rng_mix(key + 0x9e3779b97f4a7c15u)));
}

V2 warp_disk(V2 u)
{
    double a = 2 * u.u - 1, b = 2 * u.v - 1;
    if (a == 0 && b == 0)
        return (V2){0, 0};
    bool is_wide = fabs(a) > fabs(b);
    double r = is_wide ? a : b;
    double phi = is_wide ? PMS_PI / 4 * (b / a) : PMS_PI / 2 - PMS_PI / 4 * (a / b);
    return (V2){r * cos(phi), r * sin(phi)};
}

V3 warp_cone(V2 u, double cos_max)
{
    double z = 1 - u.u * (1 - cos_max);
    double r = sqrt(num_max(0, 1 - z * z)), phi = 2 * PMS_PI * u.v;
    return v3(r * cos(phi), r * sin(phi), z);
}

V3 warp_sphere(V2 u)
{
    return warp_cone(u, -1);
}

V3 warp_cosine(V2 u)
{
    V2 p = warp_disk(u);
    return v3(p.u, p.v, sqrt(num_max(0, 1 - p.u * p.u - p.v * p.v)));
}

V3 warp_to_frame(V3 local, V3 n)
{
    V3 s, t;
    v3_frame(n, &s, &t);
    return v3_mad(v3_mad(v3_scale(n, local.z), local.x, s), local.y, t);
}
