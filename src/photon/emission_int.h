/* Who sends how many photons where; for photon/ only.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_PHOTON_EMISSION_INT_H
#define PMS_PHOTON_EMISSION_INT_H

#include "photon/photon_pass.h"
#include "photon/walk_int.h"

/* The emission for one map. */
typedef struct Emission {
    const Tracer *tracer;
    const PhotonOptions *options;
    Diag *diag;
    WalkRules rules;
    Interiors *inside; /* per light */
    Beam *beams;       /* by light, then by target */
    int beam_count;
    TraceThread *threads;
    int thread_count;
    LightBooks *books; /* per source; the caller's after the pass */
    int source_count;  /* the lights, the objects that glow, the sky */
    uint64_t budget;   /* photons in all */
    uint64_t draw;     /* of emission_set_keys */
} Emission;

/* Aim the beams, try them with a few photons each, and share the photons out.  Free with
 * emission_done, also after a failure. */
Status emission_init(Emission *emission, const Tracer *tracer, MapKind map,
                     const PhotonOptions *options, Diag *diag);
void emission_done(Emission *emission, Stats *add_to);

/* Try every beam with a small part of `photons` rays: set its cells and its flux. */
Status emission_pilot(Emission *emission, double photons);

static inline uint64_t emission_beam_number(const Emission *emission, const Beam *beam)
{
    return (uint64_t)(beam - emission->beams);
}

/* Return the counter that rays of a beam's photons are counted in, beside that of all. */
static inline StatId emission_ray_counter(const Emission *emission, const Beam *beam)
{
    static const StatId of_lamps[MAP_COUNT] = {STAT_CAUSTIC_PHOTON_RAYS, STAT_GLOBAL_PHOTON_RAYS,
                                               STAT_VOLUME_PHOTON_RAYS, STAT_VOLUME_PHOTON_RAYS};
    if (beam->light)
        return of_lamps[emission->rules.map];
    return beam->emitter ? STAT_GLOW_PHOTON_RAYS : STAT_SKY_PHOTON_RAYS;
}

/* Draw ray `index` of a beam.  Returns false where the light does not shine. */
bool emission_ray(TraceThread *thread, const Beam *beam, uint64_t index, BeamRay *out);

/* Make the ray at a point of a beam's square; `more` and `choice` pick what it has besides. */
static inline bool emission_ray_at(TraceThread *thread, const Beam *beam, V2 square, V2 more,
                                   double choice, BeamRay *out)
{
    return beam->light ? beam_ray(beam, square, more, out)
                       : emitter_ray(thread, beam, square, more, choice, out);
}

/* Return the generator of a photon. */
Rng emission_rng(const Emission *emission, const Beam *beam, uint64_t index);

/* Send all photons; *out holds them in order of light, target and index. */
Status emission_run(Emission *emission, PhotonList *out);

/* Send one for every `part` photons, at least one of a beam, others than emission_run sends: for
 * places that do not depend on those.  The books do not count them. */
Status emission_run_places(Emission *emission, double part, PhotonList *out);

/* Draw new sequences of points for all beams, and new numbers for all photons. */
void emission_set_keys(Emission *emission, uint64_t draw);

#endif
