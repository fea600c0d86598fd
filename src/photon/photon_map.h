/* A photon map: photons of one kind, balanced into a kd-tree kept in one array.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_PHOTON_PHOTON_MAP_H
#define PMS_PHOTON_PHOTON_MAP_H

#include "base/diag.h"
#include "math/bound.h"
#include "photon/photon.h"

#include <stddef.h>

typedef struct PhotonMap PhotonMap;

/* Build a map from photons whose pos is relative to `center`.  Takes ownership of `photons`
 * (from mem_array), also on failure.  The result is the same bytes for any number of threads.
 * ERR_MEMORY or OK. */
Status photon_map_new(Diag *diag, Photon *photons, size_t count, V3 center, int threads,
                      PhotonMap **out);
void photon_map_free(PhotonMap *map);
size_t photon_map_count(const PhotonMap *map);
/* Return all the memory the map holds, bytes. */
size_t photon_map_bytes(const PhotonMap *map);
/* Return the photons in tree order, for tests and hashes. */
const Photon *photon_map_photons(const PhotonMap *map);

#endif
