/* Building the tree of a photon map.
 *
 * Top down: a node's photons are cut at the block boundary that makes the tree left-balanced,
 * across the longest side of their box.  What is moved about are 16-byte keys (position and
 * number); the photons themselves are gathered into blocks once, at the end.  Each cut is a
 * serial selection whose outcome does not depend on who does it, so the tree is the same for
 * any number of threads; subtrees are what threads share.
 * SPDX-License-Identifier: Apache-2.0 */
#include "photon/photon_map_int.h"

#include "base/hash.h"
#include "base/mem.h"
#include "base/work.h"
#include "photon/lanes_int.h"

#include <string.h>

enum {
    CACHE_LINE = 64,
    SHARED_LEVELS = 6,       /* levels whose nodes are handed to threads one by one */
    SHARED_BLOCKS_MIN = 512, /* smaller trees are built by one thread */
    FILL_BLOCKS = 256,       /* blocks filled as one item of work */
    SORT_MAX = 16,           /* ranges up to this length are sorted */
    SAMPLES_MAX = 127
};

typedef struct Key {
    float pos[3];
    uint32_t index; /* of the photon */
} Key;

static_assert(sizeof(Key) == 4 * sizeof(float), "keys are read four floats at a time");

typedef struct Build {
    PhotonMap *map;
    const Photon *photons;
    const PhotonLight *lights; /* of the photons; NULL: not kept */
    Key *keys;
} Build;

/* --- cutting a range of keys ---------------------------------------------------------------- */

static void sort_keys(Key *keys, size_t count, int axis)
{
    for (size_t i = 1; i < count; i++) {
        Key key = keys[i];
        size_t j = i;
        for (; j > 0 && key.pos[axis] < keys[j - 1].pos[axis]; j--)
            keys[j] = keys[j - 1];
        keys[j] = key;
    }
}

/* Move the keys below `pivot` (or not above it) to the front; returns how many they are.
 * Without a branch on the data: it would be mispredicted half the time. */
static size_t partition_keys(Key *keys, size_t count, int axis, float pivot, bool has_equal)
{
    size_t front = 0;
    for (size_t i = 0; i < count; i++) {
        float value = keys[i].pos[axis];
        lanes_swap4(&keys[i], &keys[front]);
        front += has_equal ? value <= pivot : value < pivot;
    }
    return front;
}

/* Pick a value near rank `target` from a sample, a little to the far side of it, so that the
 * next range is cut close to the target from there. */
static float pick_pivot(const Key *keys, size_t count, int axis, size_t target)
{
    size_t wanted = count < 256 ? 7 : count < 8192 ? 31 : SAMPLES_MAX;
    size_t bias = count < 256 ? 0 : count < 8192 ? 3 : 8;
    float sample[SAMPLES_MAX];
    for (size_t i = 0; i < wanted; i++) {
        float value = keys[(2 * i + 1) * count / (2 * wanted)].pos[axis];
        size_t j = i;
        for (; j > 0 && value < sample[j - 1]; j--)
            sample[j] = sample[j - 1];
        sample[j] = value;
    }
    size_t rank = target * wanted / count;
    if (2 * target <= count)
        rank += bias;
    else
        rank = rank > bias ? rank - bias : 0;
    return sample[rank < wanted ? rank : wanted - 1];
}

/* Reorder the keys so that none of the first `target` lies above any of the others; returns a
 * value between the two.  0 < target < count. */
static float cut_keys(Key *keys, size_t count, int axis, size_t target)
{
    size_t begin = 0, end = count;
    while (end - begin > SORT_MAX) {
        float pivot = pick_pivot(keys + begin, end - begin, axis, target - begin);
        size_t below = begin + partition_keys(keys + begin, end - begin, axis, pivot, false);
        if (below == begin) { /* the pivot is the least: set its equals apart, or nothing moves */
            below += partition_keys(keys + begin, end - begin, axis, pivot, true);
            if (target <= below)
                return pivot;
        }
        if (target == below)
            return pivot;
        if (target < below)
            end = below;
        else
            begin = below;
    }
    sort_keys(keys + begin, end - begin, axis);
    return keys[target].pos[axis];
}

static int longest_axis(const Key *keys, size_t count)
{
    float lo[4], hi[4];
    lanes_range4(keys[0].pos, count, lo, hi);
    float dx = hi[0] - lo[0], dy = hi[1] - lo[1], dz = hi[2] - lo[2];
    return dx >= dy ? (dx >= dz ? 0 : 2) : (dy >= dz ? 1 : 2);
}

/* --- the tree ------------------------------------------------------------------------------- */

static uint32_t power_of_two_below(uint32_t n)
{
    uint32_t power = 1;
    while (power <= n / 2)
        power *= 2;
    return power;
}

/* Return how many of the `count` blocks of a left-balanced tree hang on its left. */
static uint32_t left_blocks(uint32_t count)
{
    uint32_t level = power_of_two_below(count), deeper = count - level;
    return level / 2 + (deeper < level / 2 ? deeper : level / 2);
}

static float with_axis(float value, int axis)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    bits = (bits & ~3u) | (uint32_t)axis;
    memcpy(&value, &bits, sizeof bits);
    return value;
}

/* Cut the keys of one node, which holds `blocks` blocks from `first` on. */
static void build_node(const Build *build, uint32_t node, uint32_t first, uint32_t blocks)
{
    size_t begin = (size_t)first * BLOCK_PHOTONS;
    size_t end = begin + (size_t)blocks * BLOCK_PHOTONS;
    if (end > build->map->count)
        end = build->map->count;
    Key *keys = build->keys + begin;
    int axis = longest_axis(keys, end - begin);
    size_t target = (size_t)left_blocks(blocks) * BLOCK_PHOTONS;
    build->map->splits[node] = with_axis(cut_keys(keys, end - begin, axis, target), axis);
}

static void build_subtree(const Build *build, uint32_t node, uint32_t first, uint32_t blocks)
{
    while (blocks > 1) {
        build_node(build, node, first, blocks);
        uint32_t left = left_blocks(blocks);
        build_subtree(build, 2 * node + 1, first, left);
        node = 2 * node + 2;
        first += left;
        blocks -= left;
    }
}

/* Find which blocks hang under a node: its path from the root are the bits of node + 1. */
static void node_blocks(uint32_t node, uint32_t *first, uint32_t *blocks)
{
    for (uint32_t bit = power_of_two_below(node + 1) / 2; bit; bit /= 2) {
        uint32_t left = left_blocks(*blocks);
        if ((node + 1) & bit)
            *first += left;
        *blocks = (node + 1) & bit ? *blocks - left : left;
    }
}

typedef struct LevelWork {
    const Build *build;
    uint32_t first_node;
    bool is_whole; /* the subtrees, not only the nodes */
} LevelWork;

static void build_level_item(void *ctx, size_t index, int thread)
{
    (void)thread;
    const LevelWork *work = ctx;
    uint32_t node = work->first_node + (uint32_t)index;
    uint32_t first = 0, blocks = work->build->map->block_count;
    node_blocks(node, &first, &blocks);
    if (work->is_whole)
        build_subtree(work->build, node, first, blocks);
    else
        build_node(work->build, node, first, blocks);
}

static Status build_tree(const Build *build, int threads)
{
    uint32_t blocks = build->map->block_count;
    if (blocks < SHARED_BLOCKS_MIN) {
        build_subtree(build, 0, 0, blocks);
        return OK;
    }
    for (int level = 0; level <= SHARED_LEVELS; level++) {
        LevelWork work = {build, (1u << level) - 1, level == SHARED_LEVELS};
        TRY(work_for(threads, (size_t)1 << level, build_level_item, &work));
    }
    return OK;
}

/* --- the blocks ----------------------------------------------------------------------------- */

static void fill_block(const Build *build, size_t number)
{
    PhotonBlock *block = &build->map->blocks[number];
    const Key *keys = build->keys + number * BLOCK_PHOTONS;
    size_t count = build->map->count - number * BLOCK_PHOTONS;
    for (size_t i = 0; i < BLOCK_PHOTONS && i < count; i++) {
        const Photon *photon = &build->photons[keys[i].index];
        for (int a = 0; a < 3; a++)
            block->pos[a][i] = photon->pos[a];
        block->rgbe[i] = (uint32_t)photon->rgbe[0] | (uint32_t)photon->rgbe[1] << 8 |
                         (uint32_t)photon->rgbe[2] << 16 | (uint32_t)photon->rgbe[3] << 24;
        block->from[i] = (uint16_t)(photon->phi | photon->theta << 8);
        block->flags[i] = photon->flags;
        if (build->lights)
            build->map->lights[number * BLOCK_PHOTONS + i] = build->lights[keys[i].index];
    }
    for (size_t i = count; i < BLOCK_PHOTONS; i++)
        block->pos[0][i] = block->pos[1][i] = block->pos[2][i] = NAN;
}

static void fill_blocks(void *ctx, size_t index, int thread)
{
    (void)thread;
    const Build *build = ctx;
    for (size_t i = index * FILL_BLOCKS;
         i < (index + 1) * FILL_BLOCKS && i < build->map->block_count; i++)
        fill_block(build, i);
}

/* Make the keys of all photons that are somewhere. */
static void make_keys(Build *build, size_t count)
{
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        const float *pos = build->photons[i].pos;
        build->keys[kept] = (Key){{pos[0], pos[1], pos[2]}, (uint32_t)i};
        kept += isfinite(pos[0]) && isfinite(pos[1]) && isfinite(pos[2]);
    }
    build->map->count = kept;
}

static Status map_fill(Build *build, size_t count, int threads)
{
    PhotonMap *map = build->map;
    make_keys(build, count);
    map->block_count = (uint32_t)((map->count + BLOCK_PHOTONS - 1) / BLOCK_PHOTONS);
    if (map->block_count == 0)
        return OK;
    map->level_blocks = power_of_two_below(map->block_count);
    map->splits = mem_array(map->block_count, sizeof *map->splits);
    map->memory = mem_alloc(map->block_count * sizeof *map->blocks + CACHE_LINE);
    if (build->lights)
        map->lights = mem_array(map->count, sizeof *map->lights);
    if (!map->splits || !map->memory || (build->lights && !map->lights))
        return ERR_MEMORY;
    uintptr_t start = ((uintptr_t)map->memory + CACHE_LINE - 1) & ~(uintptr_t)(CACHE_LINE - 1);
    map->blocks = (PhotonBlock *)start;
    TRY(build_tree(build, threads));
    return work_for(threads, (map->block_count + FILL_BLOCKS - 1) / FILL_BLOCKS, fill_blocks,
                    build);
}

static Status keep_order(const Key *keys, size_t count, uint32_t **order)
{
    *order = mem_array(count + 1, sizeof **order);
    for (size_t i = 0; *order && i < count; i++)
        (*order)[i] = keys[i].index;
    return *order ? OK : ERR_MEMORY;
}

Status photon_map_new_full(Diag *diag, Photon *photons, PhotonLight *lights, size_t count,
                           V3 center, int threads, uint32_t **order, PhotonMap **out)
{
    *out = NULL;
    PhotonMap *map = mem_alloc(sizeof *map);
    Key *keys = count < UINT32_MAX - BLOCK_PHOTONS ? mem_array(count, sizeof *keys) : NULL;
    Status status = map && keys ? OK : ERR_MEMORY;
    if (status == OK) {
        map->center = center;
        Build build = {map, photons, lights, keys};
        status = map_fill(&build, count, threads);
    }
    if (status == OK && order)
        status = keep_order(keys, map->count, order);
    mem_free(keys);
    mem_free(lights);
    mem_free(photons);
    if (status == OK) {
        *out = map;
        return OK;
    }
    photon_map_free(map);
    return status == ERR_MEMORY ? diag_no_memory(diag, "a photon map") : status;
}

Status photon_map_new(Diag *diag, Photon *photons, size_t count, V3 center, int threads,
                      PhotonMap **out)
{
    return photon_map_new_full(diag, photons, NULL, count, center, threads, NULL, out);
}

void photon_map_free(PhotonMap *map)
{
    if (!map)
        return;
    mem_free(map->splits);
    mem_free(map->memory);
    mem_free(map->lights);
    mem_free((void *)(uintptr_t)map->seen);
    mem_free(map);
}

Status photon_map_watch(Diag *diag, PhotonMap *map)
{
    map->seen = mem_array(map->count + 1, sizeof *map->seen);
    return map->seen ? OK : diag_no_memory(diag, "photons seen");
}

void photon_map_see(const PhotonMap *map, size_t index)
{
    if (map->seen)
        atomic_store_explicit(&map->seen[index], 1, memory_order_relaxed);
}

bool photon_map_is_seen(const PhotonMap *map, size_t index)
{
    return map->seen && atomic_load_explicit(&map->seen[index], memory_order_relaxed);
}

size_t photon_map_count(const PhotonMap *map)
{
    return map->count;
}

size_t photon_map_bytes(const PhotonMap *map)
{
    size_t bytes = sizeof *map;
    if (map->block_count)
        bytes += map->block_count * (sizeof *map->blocks + sizeof *map->splits) + CACHE_LINE;
    if (map->lights)
        bytes += map->count * sizeof *map->lights;
    return bytes;
}

V3 photon_map_center(const PhotonMap *map)
{
    return map->center;
}

Photon photon_map_at(const PhotonMap *map, size_t index)
{
    assert(index < map->count);
    const PhotonBlock *block = &map->blocks[index / BLOCK_PHOTONS];
    size_t i = index % BLOCK_PHOTONS;
    uint32_t rgbe = block->rgbe[i];
    return (Photon){
        {block->pos[0][i], block->pos[1][i], block->pos[2][i]},
        {(uint8_t)rgbe, (uint8_t)(rgbe >> 8), (uint8_t)(rgbe >> 16), (uint8_t)(rgbe >> 24)},
        (uint8_t)block->from[i],
        (uint8_t)(block->from[i] >> 8),
        block->flags[i]};
}

uint64_t photon_map_hash(const PhotonMap *map)
{
    uint64_t hash = hash_bytes(map->count, &map->center, sizeof map->center);
    if (map->block_count) {
        hash = hash_bytes(hash, map->blocks, map->block_count * sizeof *map->blocks);
        hash = hash_bytes(hash, map->splits, (map->block_count - 1) * sizeof *map->splits);
    }
    if (map->lights)
        hash = hash_bytes(hash, map->lights, map->count * sizeof *map->lights);
    return hash ? hash : 1;
}
