/* Finding photons near a point.
 *
 * The tree is walked once, near side first, within a radius guessed from the last search; what
 * lies within is packed into a flat array, and the k-th smallest distance is then found by
 * interpolating on counts, which a vector unit makes fast.  A guess that was too small is
 * widened and the walk repeated; one that was too large is cut down when the array is full.
 * The outcome (set and order) depends on neither: the photons kept are always those nearer
 * than the k-th, in the order of the walk.  SPDX-License-Identifier: Apache-2.0 */
#include "photon/search_int.h"

#include "base/mem.h"
#include "photon/lanes_int.h"
#include "photon/photon_map_int.h"

#include <string.h>

static_assert((int)LANES == (int)BLOCK_PHOTONS, "a block is one vector");

enum {
    STACK_MAX = 40,  /* deeper than any tree of 2^32 photons */
    ROOM_FACTOR = 4, /* room for so many times k before the radius is cut down */
    ROOM_MIN = 256,
    COUNTING_MAX = 12, /* rounds of interpolation before bisecting */
    SELECT_MAX = 12    /* candidates worth sorting */
};

/* Cells as far as the radius are still walked: their distance was rounded. */
#define REACH_FACTOR (1 + 0x1p-20f)

/* The next search starts with this many times the area the last one needed. */
#define GUESS_FACTOR 1.25f

typedef struct Search {
    const PhotonMap *map;
    FoundPhotons *found;
    float q[3], n[3];
    float slab;               /* 1/GATHER_SLAB^2, or 0 for a ball */
    float cosine2;            /* signed square of the least cosine */
    bool has_normals;         /* look at them at all */
    uint16_t side_bits, side; /* the flags looked at, and how they are to be */
    size_t wanted;            /* k, or SIZE_MAX: all */
    float radius2;
} Search;

typedef struct Cell {
    uint32_t node;
    float distance2; /* from q to the cell */
    float off[3];    /* the same by axis */
} Cell;

/* --- one block -------------------------------------------------------------------------- */

static void block_distances(const Search *search, const PhotonBlock *block, float out[LANES])
{
    const float qx = search->q[0], qy = search->q[1], qz = search->q[2];
    const float nx = search->n[0], ny = search->n[1], nz = search->n[2];
    for (int i = 0; i < LANES; i++) {
        float dx = block->pos[0][i] - qx, dy = block->pos[1][i] - qy, dz = block->pos[2][i] - qz;
        float d2 = dx * dx + dy * dy + dz * dz;
        float height = nx * dx + ny * dy + nz * dz;
        float slab2 = height * height * search->slab;
        out[i] = slab2 > d2 ? slab2 : d2;
    }
}

/* Leave in out[i] whether photon i lies on a surface that looks the right way: the cosine
 * times its own magnitude, less the limit; the octahedral code is decoded without a root. */
static void block_facing(const Search *search, const PhotonBlock *block, float out[LANES])
{
    const float step = 2.0f / (NORMAL_STEPS - 1);
    const float nx = search->n[0], ny = search->n[1], nz = search->n[2];
    for (int i = 0; i < LANES; i++) {
        int code = block->flags[i] >> 2;
        float x = (float)(code & 127) * step - 1, y = (float)(code >> 7) * step - 1;
        float z = 1 - fabsf(x) - fabsf(y);
        float fold = z < 0 ? -z : 0;
        x += x < 0 ? fold : -fold;
        y += y < 0 ? fold : -fold;
        float dot = nx * x + ny * y + nz * z;
        out[i] = search->cosine2 * (x * x + y * y + z * z) - dot * fabsf(dot);
    }
}

/* --- cutting down to k ------------------------------------------------------------------ */

/* Return the rank-th smallest (from 1) of the `wanted` values in (below, above]. */
static float select_between(const float *values, size_t count, float below, float above,
                            size_t rank)
{
    float sorted[SELECT_MAX + 1];
    size_t found = 0;
    for (size_t i = 0; i < count; i++) {
        float value = values[i];
        sorted[found] = value;
        found += value > below && value <= above;
    }
    for (size_t i = 1; i < found; i++) {
        float value = sorted[i];
        size_t j = i;
        for (; j > 0 && value < sorted[j - 1]; j--)
            sorted[j] = sorted[j - 1];
        sorted[j] = value;
    }
    return sorted[rank - 1];
}

static float float_of_bits(uint32_t bits)
{
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* The same for any number of candidates: bisect on the bits, which order like the numbers. */
static float bisect_bits(const float *values, size_t count, size_t k)
{
    uint32_t last = 0;
    for (uint32_t bit = 1u << 30; bit; bit >>= 1)
        if (lanes_count(values, count, float_of_bits(last + (bit - 1))) < k)
            last += bit;
    return float_of_bits(last);
}

static float largest_of(const float *values, size_t count)
{
    float largest = 0;
    for (size_t i = 0; i < count; i++)
        largest = values[i] > largest ? values[i] : largest;
    return largest;
}

/* Return the k-th smallest of `count` values, none negative, all <= most; 0 < k <= count. */
static float kth_smallest(const float *values, size_t count, size_t k, float most)
{
    float below = -1, above = isfinite(most) ? most : largest_of(values, count);
    size_t count_below = 0, count_above = count;
    for (int round = 0; count_above - count_below > SELECT_MAX; round++) {
        float share = ((float)(k - count_below) - 0.5f) / (float)(count_above - count_below);
        float low = below < 0 ? 0 : below, middle = low + (above - low) * share;
        if (round == COUNTING_MAX || !(middle > below && middle < above))
            return bisect_bits(values, count, k);
        size_t here = lanes_count(values, count, middle);
        if (here >= k) {
            above = middle;
            count_above = here;
        } else {
            below = middle;
            count_below = here;
        }
    }
    return select_between(values, count, below, above, k - count_below);
}

/* Return the least number such that `wanted` of the photons at distance `level` are not above
 * it.  Bisected bit by bit: a great many may be equally far. */
static uint32_t last_of_ties(const FoundPhotons *found, float level, size_t wanted)
{
    uint32_t last = 0;
    for (uint32_t bit = 1u << 31; bit; bit >>= 1) {
        uint32_t middle = last + (bit - 1);
        size_t here = 0;
        for (size_t i = 0; i < found->count; i++)
            here += found->distance2[i] == level && found->index[i] <= middle;
        if (here < wanted)
            last += bit;
    }
    return last;
}

/* Keep of what was found the photons nearer than `level`, and as many of those as far as it as
 * are needed to make `keep`, lowest numbers first.  The order stays. */
static void keep_nearest(FoundPhotons *found, float level, size_t keep)
{
    float *distance2 = found->distance2;
    uint32_t *index = found->index;
    float nearer_limit = nextafterf(level, -1);
    size_t nearer = lanes_count(distance2, found->count, nearer_limit), kept = 0;
    size_t up_to = lanes_count(distance2, found->count, level);
    uint32_t last = keep < up_to && keep > nearer ? last_of_ties(found, level, keep - nearer) : 0;
    for (size_t i = 0; i < found->count; i += LANES) {
        unsigned there = lanes_there(found->count - i);
        unsigned mask = lanes_not_above(distance2 + i, nearer_limit) & there;
        if (keep > nearer) { /* some of those at the level belong to it */
            unsigned ties = lanes_not_above(distance2 + i, level) & there & ~mask;
            for (; ties; ties &= ties - 1) {
                int lane = __builtin_ctz(ties);
                if (keep >= up_to || index[i + (size_t)lane] <= last)
                    mask |= 1u << lane;
            }
        }
        kept += lanes_keep(mask, distance2 + i, index + i, distance2 + kept, index + kept);
    }
    found->count = kept;
}

/* Make room for so many photons; returns false when memory is out. */
static bool has_room(FoundPhotons *found, size_t capacity)
{
    if (found->capacity >= capacity)
        return true;
    float *distance2 = mem_resize(found->distance2, (capacity + LANES) * sizeof *distance2);
    if (distance2)
        found->distance2 = distance2;
    uint32_t *index =
        distance2 ? mem_resize(found->index, (capacity + LANES) * sizeof *index) : NULL;
    if (index)
        found->index = index;
    float *excess = index ? mem_resize(found->excess, (capacity + LANES) * sizeof *excess) : NULL;
    if (excess) {
        found->excess = excess;
        found->capacity = capacity;
    }
    return excess != NULL;
}

/* Make room for another block: cut down to the k nearest, or grow.  When memory is out, the
 * nearest half is what there is. */
static void make_room(Search *search)
{
    FoundPhotons *found = search->found;
    if (search->wanted == SIZE_MAX) {
        if (has_room(found, found->capacity * 2))
            return;
        search->wanted = found->capacity / 2;
    }
    search->radius2 = kth_smallest(found->distance2, found->count, search->wanted, search->radius2);
    keep_nearest(found, search->radius2, search->wanted);
}

/* --- the walk --------------------------------------------------------------------------- */

static void visit_block(Search *search, uint32_t number)
{
    const PhotonBlock *block = &search->map->blocks[number];
    FoundPhotons *found = search->found;
    float distance2[LANES], facing[LANES];
    block_distances(search, block, distance2);
    unsigned mask = lanes_not_above(distance2, search->radius2);
    if (!mask)
        return;
    if (search->has_normals) {
        block_facing(search, block, facing);
        mask &= lanes_not_above(facing, 0);
        mask &= lanes_with_bits(block->flags, search->side_bits, search->side);
    }
    if (found->count + LANES > found->capacity)
        make_room(search);
    found->count += lanes_pack(mask, distance2, number * LANES, found->distance2 + found->count,
                               found->index + found->count);
}

static inline int split_axis(float split)
{
    uint32_t bits;
    memcpy(&bits, &split, sizeof bits);
    return (int)(bits & 3);
}

static void walk(Search *search)
{
    const PhotonMap *map = search->map;
    const uint32_t inner = map->block_count - 1;
    Cell stack[STACK_MAX], cell = {0};
    int depth = 0;
    for (;;) {
        while (cell.node < inner) {
            float split = map->splits[cell.node];
            int axis = split_axis(split);
            float delta = search->q[axis] - split;
            bool is_right = delta >= 0;
            Cell far = cell;
            far.node = 2 * cell.node + (is_right ? 1 : 2);
            float off = fabsf(delta) - (fabsf(split) * SPLIT_ERROR + SPLIT_ERROR_LEAST);
            far.off[axis] = off > 0 ? off : 0;
            far.distance2 =
                far.off[0] * far.off[0] + far.off[1] * far.off[1] + far.off[2] * far.off[2];
            stack[depth] = far;
            depth += far.distance2 <= search->radius2 * REACH_FACTOR;
            cell.node = 2 * cell.node + (is_right ? 2 : 1);
        }
        visit_block(search, block_of_node(map, cell.node));
        do {
            if (depth == 0)
                return;
            cell = stack[--depth];
        } while (!(cell.distance2 <= search->radius2 * REACH_FACTOR));
    }
}

/* --- the search ------------------------------------------------------------------------- */

static float *guess_at(GatherScratch *scratch, const PhotonMap *map)
{
    for (int i = 0; i < GATHER_GUESSES; i++)
        if (scratch->guess_map[i] == map)
            return &scratch->guess_radius2[i];
    for (int i = GATHER_GUESSES - 1; i > 0; i--) {
        scratch->guess_map[i] = scratch->guess_map[i - 1];
        scratch->guess_radius2[i] = scratch->guess_radius2[i - 1];
    }
    scratch->guess_map[0] = map;
    scratch->guess_radius2[0] = INFINITY;
    return &scratch->guess_radius2[0];
}

/* Return the squared radius to try next, when `count` photons were within `tried`. */
static float wider_than(float tried, size_t count, size_t wanted)
{
    float factor = 1.5f * (float)wanted / (float)(count + 1);
    return tried * fminf(fmaxf(factor, 2), 64);
}

/* Walk with a radius growing from `start` until k photons are found, or `most` is reached; returns
 * whether they were. */
static bool search_nearest(Search *search, float start, float most)
{
    FoundPhotons *found = search->found;
    search->radius2 = fminf(start, most);
    for (;;) {
        float tried = search->radius2;
        found->count = 0;
        walk(search);
        if (found->count >= search->wanted || !(tried < most))
            break;
        float wider = wider_than(tried, found->count, search->wanted);
        search->radius2 = wider > tried ? fminf(wider, most) : most;
    }
    if (found->count < search->wanted) {
        search->radius2 = most;
        return false;
    }
    search->radius2 = kth_smallest(found->distance2, found->count, search->wanted, search->radius2);
    keep_nearest(found, search->radius2, search->wanted - 1);
    return true;
}

static Search make_search(const PhotonMap *map, V3 q, V3 n, const GatherLimits *limits,
                          FoundPhotons *found)
{
    double cosine = limits->normal_cosine;
    return (Search){.map = map,
                    .found = found,
                    .q = {(float)q.x, (float)q.y, (float)q.z},
                    .n = {(float)n.x, (float)n.y, (float)n.z},
                    .slab =
                        limits->shape == GATHER_DISK ? (float)(1 / (GATHER_SLAB * GATHER_SLAB)) : 0,
                    .cosine2 = (float)(cosine * fabs(cosine)),
                    .has_normals = cosine > -1,
                    .side_bits = limits->side == GATHER_ALL_SIDES ? 0 : PHOTON_INSIDE,
                    .side = limits->side == GATHER_INSIDE ? PHOTON_INSIDE : 0};
}

/* Return k as a number of photons there may be room for: when memory is out, fewer. */
static size_t photons_wanted(const FoundPhotons *found, int k)
{
    size_t wanted = k > 0 ? (size_t)k : SIZE_MAX;
    return wanted < SIZE_MAX && wanted > found->capacity / 2 ? found->capacity / 2 : wanted;
}

bool photon_search(const PhotonMap *map, V3 p, V3 n, const GatherLimits *limits,
                   GatherScratch *scratch, float *radius2)
{
    FoundPhotons *found = &scratch->found;
    V3 q = v3_sub(p, map->center);
    float most = (float)(limits->max_radius * limits->max_radius);
    int k = limits->max_photons > limits->min_photons ? limits->max_photons : limits->min_photons;
    found->count = 0;
    *radius2 = most;
    if (!has_room(found, (size_t)k * ROOM_FACTOR + ROOM_MIN) && found->capacity < ROOM_MIN)
        return false;
    if (map->block_count == 0 || !v3_is_finite(q) || !(most >= 0))
        return false;
    Search search = make_search(map, q, n, limits, found);
    search.wanted = photons_wanted(found, limits->max_photons);
    float *guess = guess_at(scratch, map), start = search.wanted < SIZE_MAX ? *guess : most;
    bool is_full = search_nearest(&search, start, most);
    *guess = is_full ? search.radius2 * GUESS_FACTOR : most;
    bool is_widened = !is_full && found->count + 1 < (size_t)limits->min_photons &&
                      limits->far_radius > limits->max_radius;
    if (is_widened) {
        search.wanted = photons_wanted(found, limits->min_photons);
        start = wider_than(most, found->count, search.wanted);
        search_nearest(&search, start, (float)(limits->far_radius * limits->far_radius));
    }
    *radius2 = search.radius2;
    return is_widened;
}
