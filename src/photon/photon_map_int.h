/* How a photon map is laid out; for photon/ only.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_PHOTON_PHOTON_MAP_INT_H
#define PMS_PHOTON_PHOTON_MAP_INT_H

#include "photon/photon_map.h"

#include <stdatomic.h>
#include <string.h>

enum { BLOCK_PHOTONS = 16 };

/* Sixteen photons, field by field: five cache lines, three of them positions. */
typedef struct PhotonBlock {
    float pos[3][BLOCK_PHOTONS];  /* unused places are NaN: nearer to nothing */
    uint32_t rgbe[BLOCK_PHOTONS]; /* r in the low byte, exponent in the high one */
    uint16_t from[BLOCK_PHOTONS]; /* phi | theta << 8 */
    uint16_t flags[BLOCK_PHOTONS];
} PhotonBlock;

static_assert(sizeof(PhotonBlock) == 20 * BLOCK_PHOTONS, "20 bytes a photon");

/* Replacing two mantissa bits moves a split plane by at most 3 units in its last place. */
#define SPLIT_ERROR 0x1p-21f
#define SPLIT_ERROR_LEAST 0x1p-146f /* of planes too close to 0 for a full mantissa */

/* Nodes are numbered as in a heap: the children of i are 2i+1 and 2i+2.  With m blocks the
 * inner nodes are 0 .. m-2, each a split plane whose two lowest mantissa bits are replaced by
 * its axis; the rest are blocks (block_of_node). */
struct PhotonMap {
    PhotonBlock *blocks; /* aligned to a cache line, in space order */
    float *splits;       /* block_count - 1 */
    size_t count;        /* photons */
    uint32_t block_count;
    uint32_t level_blocks; /* largest power of two not above block_count */
    V3 center;
    void *memory;        /* of blocks */
    _Atomic uint8_t *seen; /* of each photon; NULL: not watched */
    PhotonLight *lights; /* of each photon of the blocks in turn; NULL: 20 bytes are all */
};

/* Return the power step of a stored photon: 2^(exponent - RGBE_BIAS); the exponents in use
 * make it a normal float, black photons have no mantissa to multiply. */
static inline float rgbe_step(uint32_t rgbe)
{
    uint32_t exponent = rgbe >> 24;
    exponent = exponent < RGBE_LEAST ? RGBE_LEAST : exponent;
    uint32_t bits = (exponent - RGBE_BIAS + 127) << 23;
    float step;
    memcpy(&step, &bits, sizeof step);
    return step;
}

static inline Rgb rgbe_power(uint32_t rgbe)
{
    float step = rgbe_step(rgbe);
    return rgb((float)(rgbe & 255) * step, (float)(rgbe >> 8 & 255) * step,
               (float)(rgbe >> 16 & 255) * step);
}

/* Return the power of photon `index`, and where it came from. */
static inline Rgb photon_map_power(const PhotonMap *map, size_t index)
{
    if (map->lights)
        return map->lights[index].power;
    return rgbe_power(map->blocks[index / BLOCK_PHOTONS].rgbe[index % BLOCK_PHOTONS]);
}

static inline V3 photon_map_from(const PhotonMap *map, size_t index)
{
    if (map->lights) {
        const float *from = map->lights[index].from;
        return v3((double)from[0], (double)from[1], (double)from[2]);
    }
    uint16_t from = map->blocks[index / BLOCK_PHOTONS].from[index % BLOCK_PHOTONS];
    return direction_decode((uint8_t)from, (uint8_t)(from >> 8));
}

/* Return the block a leaf node stands for. */
static inline uint32_t block_of_node(const PhotonMap *map, uint32_t node)
{
    uint32_t level = map->level_blocks, deeper = map->block_count - level;
    return node >= 2 * level - 1 ? node - (2 * level - 1) : node - (level - 1) + deeper;
}

#endif
