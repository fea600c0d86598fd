/* Sixteen floats at a time.
 *
 * Plain loops that compilers turn into vector code, and the two steps they do not: a comparison
 * as a bit mask, and packing the chosen lanes together.  Every version computes the same bits.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_PHOTON_LANES_INT_H
#define PMS_PHOTON_LANES_INT_H

#include <stddef.h>
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

/* Return the mask of lanes whose bits chosen by `bits` are `wanted`. */
static inline unsigned lanes_with_bits(const uint16_t value[LANES], unsigned bits, unsigned wanted)
{
#if defined(__SSE2__)
    __m128i chosen = _mm_set1_epi16((short)bits), want = _mm_set1_epi16((short)wanted);
    __m128i low = _mm_loadu_si128((const __m128i *)(const void *)value);
    __m128i high = _mm_loadu_si128((const __m128i *)(const void *)(value + LANES / 2));
    low = _mm_cmpeq_epi16(_mm_and_si128(low, chosen), want);
    high = _mm_cmpeq_epi16(_mm_and_si128(high, chosen), want);
    return (unsigned)_mm_movemask_epi8(_mm_packs_epi16(low, high));
#else
    unsigned mask = 0;
    for (int i = 0; i < LANES; i++)
        mask |= (unsigned)((value[i] & bits) == wanted) << i;
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

/* Move the chosen lanes of two arrays together to the front of two others, which may be the same
 * ones or begin earlier; room as for lanes_pack. */
static inline unsigned lanes_keep(unsigned mask, const float *value, const uint32_t *number,
                                  float *values, uint32_t *numbers)
{
    unsigned count = (unsigned)__builtin_popcount(mask);
#if defined(__AVX512F__)
    __mmask16 chosen = (__mmask16)mask;
    __m512 v = _mm512_maskz_compress_ps(chosen, _mm512_loadu_ps(value));
    __m512i n = _mm512_maskz_compress_epi32(chosen, _mm512_loadu_si512(number));
    _mm512_storeu_ps(values, v);
    _mm512_storeu_si512(numbers, n);
#else
    for (unsigned i = 0; mask; i++, mask &= mask - 1) {
        unsigned lane = (unsigned)__builtin_ctz(mask);
        values[i] = value[lane];
        numbers[i] = number[lane];
    }
#endif
    return count;
}

/* Return the mask of the lanes there are, of `left` items. */
static inline unsigned lanes_there(size_t left)
{
    return left >= LANES ? 0xffffu : (1u << left) - 1;
}

/* Return how many of `count` values are <= limit; `values` may be read up to whole LANES. */
static inline size_t lanes_count(const float *values, size_t count, float limit)
{
    size_t total = 0;
    for (size_t i = 0; i < count; i += LANES)
        total +=
            (size_t)__builtin_popcount(lanes_not_above(values + i, limit) & lanes_there(count - i));
    return total;
}

/* Swap two rows of 16 bytes, whole: copied in parts, a row just written could not be read back
 * before its parts have reached memory. */
static inline void lanes_swap4(void *a, void *b)
{
    typedef uint32_t Row __attribute__((vector_size(16), aligned(4), may_alias));
    Row row = *(Row *)a;
    *(Row *)a = *(Row *)b;
    *(Row *)b = row;
}

/* Find the least and largest of each of four floats over `count` rows of four, at least one row.
 * A lane that holds no number may come out as anything. */
static inline void lanes_range4(const float *rows, size_t count, float lo[4], float hi[4])
{
#if defined(__SSE2__)
    __m128 least = _mm_loadu_ps(rows), most = least;
    for (size_t i = 1; i < count; i++) {
        __m128 row = _mm_loadu_ps(rows + 4 * i);
        least = _mm_min_ps(row, least);
        most = _mm_max_ps(row, most);
    }
    _mm_storeu_ps(lo, least);
    _mm_storeu_ps(hi, most);
#else
    for (int a = 0; a < 4; a++)
        lo[a] = hi[a] = rows[a];
    for (size_t i = 1; i < count; i++)
        for (size_t a = 0; a < 4; a++) {
            float value = rows[4 * i + a];
            lo[a] = value < lo[a] ? value : lo[a];
            hi[a] = value > hi[a] ? value : hi[a];
        }
#endif
}

#endif
