/* Finding photons near a point; for photon/ only.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_PHOTON_SEARCH_INT_H
#define PMS_PHOTON_SEARCH_INT_H

#include "photon/gather.h"

enum { GATHER_GUESSES = 3 }; /* a pixel asks so many maps in turn */

/* Photons found.  distance2 has room for whole blocks past count. */
typedef struct FoundPhotons {
    float *distance2; /* as the gather shape measures it, scene units squared */
    uint32_t *index;
    float *excess; /* see GatheredPhoton; with has_error only */
    size_t count, capacity;
} FoundPhotons;

struct GatherScratch {
    FoundPhotons found;
    GatheredPhoton *list;
    size_t list_capacity;
    const PhotonMap *guess_map[GATHER_GUESSES]; /* whose last squared radius is known */
    float guess_radius2[GATHER_GUESSES];
};

/* Leave in scratch->found the photons an estimate is made from, in the order the tree is walked;
 * *radius2 is the square of the radius they fill.  Returns whether the search had to widen. */
bool photon_search(const PhotonMap *map, V3 p, V3 n, const GatherLimits *limits,
                   GatherScratch *scratch, float *radius2);

#endif
