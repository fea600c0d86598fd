/* Where a photon map can give anything.
 *
 * Caustics are small and bright with a few stray photons far away, so a grid over all of them
 * would be too coarse to be of use: the cells are as small as the searches and are hashed.
 * SPDX-License-Identifier: Apache-2.0 */
#include "eye/photon_reach.h"

#include "base/mem.h"

/* Bits of the table for a photon, and in all: 2 megabytes stay in the cache. */
enum { BITS_PER_PHOTON = 32, TABLE_LOG2_MIN = 10, TABLE_LOG2_MAX = 24 };

/* Widens the searches by more than the rounding of places kept as floats. */
#define REACH_SLACK 1e-3

/* Cells further out than this are all taken for full: their numbers would not be exact. */
#define CELL_MAX 0x1p40

static uint64_t cell_hash(int64_t x, int64_t y, int64_t z)
{
    uint64_t h = (uint64_t)x * 0x9e3779b97f4a7c15u ^ (uint64_t)y * 0xc2b2ae3d27d4eb4fu ^
                 (uint64_t)z * 0x165667b19e3779f9u;
    h ^= h >> 32;
    return h * 0xd6e8feb86659fd93u;
}

static void set_cell(PhotonReach *reach, V3 q)
{
    uint64_t place =
        cell_hash((int64_t)floor(q.x), (int64_t)floor(q.y), (int64_t)floor(q.z)) >> reach->shift;
    reach->bits[place >> 6] |= (uint64_t)1 << (place & 63);
}

static bool has_cell(const PhotonReach *reach, int64_t x, int64_t y, int64_t z)
{
    uint64_t place = cell_hash(x, y, z) >> reach->shift;
    return reach->bits[place >> 6] >> (place & 63) & 1;
}

/* Return the largest distance of a photon from the map's centre along an axis. */
static double extent_of(const PhotonMap *map)
{
    double extent = 0;
    for (size_t i = 0; i < photon_map_count(map); i++) {
        Photon photon = photon_map_at(map, i);
        for (int axis = 0; axis < 3; axis++)
            extent = fmax(extent, fabs((double)photon.pos[axis]));
    }
    return extent;
}

Status photon_reach_init(PhotonReach *reach, const PhotonMap *map, double radius, Diag *diag)
{
    *reach = (PhotonReach){.center = photon_map_center(map)};
    size_t count = photon_map_count(map);
    double widened = radius * (1 + REACH_SLACK) + extent_of(map) * 0x1p-22;
    if (!isfinite(widened) || !(widened > 0))
        return OK;
    reach->per_unit = 0.5 / widened;
    int log2 = TABLE_LOG2_MIN;
    while (log2 < TABLE_LOG2_MAX && ((size_t)1 << log2) < count * BITS_PER_PHOTON)
        log2++;
    reach->shift = 64 - log2;
    reach->bits = mem_array((size_t)1 << (log2 - 6), sizeof *reach->bits);
    if (!reach->bits)
        return diag_no_memory(diag, "the reach of the photons");
    for (size_t i = 0; i < count; i++) {
        Photon photon = photon_map_at(map, i);
        V3 q = v3((double)photon.pos[0], (double)photon.pos[1], (double)photon.pos[2]);
        set_cell(reach, v3_scale(q, reach->per_unit));
    }
    return OK;
}

void photon_reach_done(PhotonReach *reach)
{
    mem_free(reach->bits);
    *reach = (PhotonReach){.bits = NULL};
}

/* A search is at most one cell wide: it lies in two cells along each axis. */
bool photon_reach_has(const PhotonReach *reach, V3 p)
{
    if (!reach->bits)
        return true;
    V3 q = v3_scale(v3_sub(p, reach->center), reach->per_unit);
    if (!(v3_max_abs(q) < CELL_MAX))
        return true;
    int64_t x = (int64_t)floor(q.x - 0.5), y = (int64_t)floor(q.y - 0.5),
            z = (int64_t)floor(q.z - 0.5);
    for (int i = 0; i < 8; i++)
        if (has_cell(reach, x + (i & 1), y + (i >> 1 & 1), z + (i >> 2)))
            return true;
    return false;
}
