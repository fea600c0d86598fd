/* A photon map: photons of one kind in a balanced kd-tree.
 *
 * The tree is a left-balanced one over blocks of 16 photons, kept in two plain arrays: the
 * blocks, in which equal fields stand together so that a vector unit takes all 16 at once, and
 * one float a block boundary, the split plane.  20.25 bytes a photon in all.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_PHOTON_PHOTON_MAP_H
#define PMS_PHOTON_PHOTON_MAP_H

#include "base/diag.h"
#include "math/bound.h"
#include "photon/photon.h"

#include <stddef.h>

typedef struct PhotonMap PhotonMap;

/* Build a map from photons whose pos is relative to `center`.  Takes ownership of `photons`
 * (from mem_array), also on failure.  Photons at positions that are not finite are dropped.
 * The result is the same bytes for any number of threads.  ERR_MEMORY, ERR_INTERRUPTED or OK.
 * O(n log n); needs another 37 bytes a photon while it runs. */
Status photon_map_new(Diag *diag, Photon *photons, size_t count, V3 center, int threads,
                      PhotonMap **out);
/* The same, with what is kept on demand.
 *
 * lights  of the photons in full precision, or NULL; takes ownership.  Estimates then read that; 24
 *         bytes a photon more.
 * order   NULL, or set to the number that each photon of the map had in `photons`; the caller
 *         frees it with mem_free, also after a failure. */
Status photon_map_new_full(Diag *diag, Photon *photons, PhotonLight *lights, size_t count,
                           V3 center, int threads, uint32_t **order, PhotonMap **out);

/* Make a map keep which of its photons are seen, while no other thread uses it; 1 byte a photon
 * more.  ERR_MEMORY or OK. */
Status photon_map_watch(Diag *diag, PhotonMap *map);
/* Note that photon `index` of a watched map was seen; of others it does nothing.  Any thread. */
void photon_map_see(const PhotonMap *map, size_t index);
bool photon_map_is_seen(const PhotonMap *map, size_t index);
void photon_map_free(PhotonMap *map);
size_t photon_map_count(const PhotonMap *map);
/* Return all the memory the map holds, bytes. */
size_t photon_map_bytes(const PhotonMap *map);
/* Return photon `index` in tree order. */
Photon photon_map_at(const PhotonMap *map, size_t index);
/* Return the point photon positions are relative to. */
V3 photon_map_center(const PhotonMap *map);
/* Return a hash of every byte of the map: equal maps, equal hashes.  Never 0. */
uint64_t photon_map_hash(const PhotonMap *map);

#endif
