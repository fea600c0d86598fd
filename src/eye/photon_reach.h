/* Where a photon map can give anything at all: most surfaces of a scene lie far from every
 * caustic, and need not search for one.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_EYE_PHOTON_REACH_H
#define PMS_EYE_PHOTON_REACH_H

#include "base/diag.h"
#include "math/v3.h"
#include "photon/photon_map.h"

#include <stdint.h>

/* Which cells of an endless grid hold photons: a table of bits, found by the hash of a cell.
 * Cells that share a bit with a full one look full, which costs a search and nothing else. */
typedef struct PhotonReach {
    V3 center;       /* of the grid, scene units */
    double per_unit; /* cells a scene unit: a cell is as wide as a search */
    int shift;       /* 64 less the bits of a place in the table */
    uint64_t *bits;
} PhotonReach;

/* Make the table for searches that go no further than `radius` scene units; an infinite radius
 * makes one that is true everywhere.  ERR_MEMORY or OK.  Free with photon_reach_done. */
Status photon_reach_init(PhotonReach *reach, const PhotonMap *map, double radius, Diag *diag);
void photon_reach_done(PhotonReach *reach);

/* Return false if no photon is within the radius of p.  Any thread. */
bool photon_reach_has(const PhotonReach *reach, V3 p);

#endif
