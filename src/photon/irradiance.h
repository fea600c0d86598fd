/* Irradiance computed ahead: what a gather ray looks up where it ends.
 *
 * The places are hits of photons of their own, so that there are many where there is much light,
 * and yet the estimates know nothing of the photons they are made from.  Each is the light of all
 * kinds that arrives on that side of the surface.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_PHOTON_IRRADIANCE_H
#define PMS_PHOTON_IRRADIANCE_H

#include "photon/photon_map.h"
#include "trace/trace.h"

typedef struct IrradianceMap IrradianceMap;

typedef struct IrradianceOptions {
    uint64_t seed;
    int threads;
    double area;   /* of disks, over that of the photons an estimate is made of */
    double radius; /* of searches in the photon map, scene units */
    Stats *stats;  /* counters are added there */
    bool is_watched; /* the photons are: keep which places are looked up */
} IrradianceOptions;

/* Estimate the irradiance at places.  Takes ownership of `places` (their powers and directions do
 * not matter), as photon_map_new does.  Deterministic for any number of threads.  Free with
 * irradiance_map_free. */
Status irradiance_map_new(const Tracer *tracer, const PhotonMap *photons, Photon *places,
                          size_t count, const IrradianceOptions *options, Diag *diag,
                          IrradianceMap **out);
void irradiance_map_free(IrradianceMap *map);

/* Of a watched map: note as seen all photons that speak at places which were looked up. */
Status irradiance_map_see(const IrradianceMap *map, Diag *diag);

struct GatherScratch;

/* Look up the irradiance at a point of a surface.
 *
 * map     NULL: there is none.
 * n       unit, the side that is seen.
 * radius  set to how far around the estimate was made, scene units: it says nothing of what is
 *         smaller.  0: there is none.
 *
 * Black where no photon came near.  Any thread, with a scratch of its own. */
Rgb irradiance_at(const IrradianceMap *map, TraceThread *thread, struct GatherScratch *scratch,
                  const ShapePoint *at, V3 n, double *radius);

#endif
