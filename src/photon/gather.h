/* Estimates from a photon map.  The only header of photon/ that the eye pass sees.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_PHOTON_GATHER_H
#define PMS_PHOTON_GATHER_H

#include "math/rgb.h"
#include "math/v3.h"
#include "photon/photon_map.h"
#include "scene/scene.h"

typedef struct GatherLimits {
    int min_photons, max_photons; /* k nearest; max_photons 0: everything within max_radius */
    double max_radius;            /* scene units */
    GatherShape shape;            /* disk: flattened to the surface; sphere */
    GatherKernel kernel;
    double normal_cosine;         /* photons whose surface normal is further off are ignored */
} GatherLimits;

/* One photon of an estimate, decoded: power already weighted by kernel and area, so that the
 * sum over all is the irradiance. */
typedef struct GatheredPhoton {
    V3 from;  /* unit, towards where it came from */
    Rgb irradiance;
} GatheredPhoton;

/* Working memory of one thread; grows to limits.max_photons. */
typedef struct GatherScratch GatherScratch;
GatherScratch *gather_scratch_new(void);
void gather_scratch_free(GatherScratch *scratch);

/* Estimate irradiance at p from the photons in `map`.
 *
 * p, n    scene units; n unit, on the side of the viewer; photons that arrived on the other
 *         side of the sheet never count.
 * out     irradiance per channel, in the lights' own unit; black if nothing was found.
 *
 * Returns the number of photons used.  Never fails.  Any thread. */
int photon_gather(const PhotonMap *map, V3 p, V3 n, const GatherLimits *limits,
                  GatherScratch *scratch, Rgb *out);

/* The same, but hands out the photons, for surfaces that are not merely diffuse.  The array is
 * the scratch's, valid until its next use. */
int photon_gather_list(const PhotonMap *map, V3 p, V3 n, const GatherLimits *limits,
                       GatherScratch *scratch, const GatheredPhoton **out);

/* Return the search radius for a map: the auto radius from the density of its photons. */
double photon_map_radius(const PhotonMap *map, int max_photons);

#endif
