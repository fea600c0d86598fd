/* One pass: photons from the lights into the maps, rays from the eye onto the film.  A render is
 * one of them, a progressive one the mean of many.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_RENDER_PASS_H
#define PMS_RENDER_PASS_H

#include "render/film.h"

/* What makes a pass one of many: photons are gathered within a part of the radius that fits their
 * density at the point (or of the one asked for), all of them, and the part goes to zero: so the
 * mean over passes is right. */
typedef struct PassSeries {
    double shrink;      /* gather radius over that of the first pass */
    double photon_part; /* of the photons the scene asks for */
    bool is_repeat;     /* a pass has been run before: what there is to warn of was said */
    PassRadii *first;   /* gather radii of the first pass where its map is of common density; those
                           that are 0 are found and set */
} PassSeries;

typedef struct PassOptions {
    const RenderOptions *render;
    uint64_t photon_seed;
    const PassSeries *series; /* NULL: the only pass */
    const Miniature *miniature; /* NULL: a full picture */
} PassOptions;

/* What a pass leaves beside the picture.  Free with pass_result_done. */
typedef struct PassResult {
    PhotonBooks books;
    uint64_t shared_rays; /* of photons, places and records: what all samples of the pass share */
    uint64_t eye_rays;    /* of the samples */
    Stats photon_stats; /* of the counters those of the photon maps */
    PassRadii radii; /* of a pass that is the only one */
    uint64_t caustic_hash, global_hash, volume_hash; /* of the photon maps' bytes, 0: no map */
} PassResult;

/* Run a pass into `film`, which is there.  Counters are added to *stats.  After a failure the
 * film holds some of the picture, and *out nothing. */
Status pass_render(const Tracer *tracer, const PassOptions *options, Diag *diag, Stats *stats,
                   Film *film, PassResult *out);
void pass_result_done(PassResult *result);

/* Return true if the plan calls for photons at all. */
bool pass_needs_photons(const Plan *plan);

/* Return the options of the photons of a pass; progress is reported to those of the render. */
PhotonOptions pass_photon_options(const RenderOptions *options, uint64_t seed);

#endif
