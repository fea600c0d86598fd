/* Sixteen floats at a time.
 *
 * Plain loops that compilers turn into vector code, and the two steps they do not: a comparison
 * as a bit mask, and packing the chosen lanes together.  Every version computes the same bits.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_PHOTON_LANES_INT_H
#define PMS_PHOTON_LANES_INT_H

#include <stdint.h>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

enum { LANES = 16 };

/* Return the mask of lanes with value <= limit (NaN is not). */
static inline unsigned lanes_not_above(const float value[LANES], float limit)
{
#if defined(__AVX512F__)
    return _mm512_cmp_ps_mask(_mm512_loadu_ps(value), _mm512_set1_ps(limit), _CMP_LE_OQ);
#elif defined(__SSE2__)
    unsigned mask = 0;
    __m128 most = _mm_set1_ps(limit);
    for (int i = 0; i < LANES; i += 4)
        mask |= (unsigned)_mm_movemask_ps(_mm_cmple_ps(_mm_loadu_ps(value + i), most)) << i;
    return mask;
#else
    unsigned mask = 0;
    for (int i = 0; i < LANES; i++)
        mask |= (unsigned)(value[i] <= limit) << i;
    return mask;
#endif
}

/* Append the chosen lanes of `value` and their numbers first + lane; both arrays need room for
 * LANES items.  Returns how many. */
static inline unsigned lanes_pack(unsigned mask, const float value[LANES], uint32_t first,
                                  float *values, uint32_t *numbers)
{
    unsigned count = (unsigned)__builtin_popcount(mask);
#if defined(__AVX512F__)
    const __m512i lane = _mm512_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
    __m512i number = _mm512_add_epi32(lane, _mm512_set1_epi32((int)first));
    __mmask16 chosen = (__mmask16)mask;
    _mm512_storeu_ps(values, _mm512_maskz_compress_ps(chosen, _mm512_loadu_ps(value)));
    _mm512_storeu_si512(numbers, _mm512_maskz_compress_epi32(chosen, number));
#else
    for (unsigned i = 0; mask; i++, mask &= mask - 1) {
        unsigned lane = (unsigned)__builtin_ctz(mask);
        values[i] = value[lane];
        numbers[i] = first + lane;
    }
#endif
    return count;
}

#endif
