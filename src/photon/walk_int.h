/* The way of one photon; for photon/ only.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_PHOTON_WALK_INT_H
#define PMS_PHOTON_WALK_INT_H

#include "photon/beam_int.h"
#include "photon/photon.h"

/* Which map a photon is for, and so which hits are kept:
 *
 * MAP_CAUSTIC  L S+ D: hits of collecting surfaces that are somewhat diffuse, after at least one
 *              reflection or refraction, the first of them at the target, and none but such.
 *              Passing straight through a pass_through object is none.
 * MAP_GLOBAL   L S* D (S* D)+: every hit of a somewhat diffuse surface after at least one
 *              diffuse reflection; for final gathering all hits, L (S* D)+.  From what glows, E,
 *              all hits always: E (S* D)+.
 *
 * Looked at by the eye, direct light (L D, by shadow rays that targets block), the caustic map and
 * the global map count each path once.  Gather rays take glow and the global map alone, so there
 * it holds everything. */
typedef enum MapKind { MAP_CAUSTIC, MAP_GLOBAL, MAP_COUNT } MapKind;

typedef enum PathEnd { PATH_STORED, PATH_ABSORBED, PATH_ESCAPED, PATH_CUT, PATH_END_COUNT } PathEnd;

/* A growing list of photons. */
typedef struct PhotonList {
    Photon *items;
    size_t count, capacity;
    bool is_short; /* memory ran out: some were not kept */
} PhotonList;

/* What all walks of a pass share. */
typedef struct WalkRules {
    MapKind map;
    V3 center;     /* photon positions are relative to it */
    double radius; /* of the part of the scene that matters, around the centre */
    Bound part;    /* that part's box */
    double reach;  /* first diffuse hits further from the centre are cut (global) */
    int max_level; /* max_trace_level of photons */
    float adc_bailout;
    bool keeps_first;   /* first hits of photons from lights too (global) */
    int max_diffuse;    /* diffuse reflections before the last hit that is kept (global) */
    float brightness;   /* factor of every diffuse reflection (global) */
    const Interiors *inside; /* per light: the interiors it is in; what glows is asked for */
} WalkRules;

/* What became of a photon. */
typedef struct WalkResult {
    PathEnd end;
    int stored;  /* photons */
    Rgb emitted; /* flux it started with, as measured where it ended */
    Rgb left;    /* flux it had there (when first stored, for PATH_STORED) */
} WalkResult;

/* Follow a photon, adding what is stored to `out`.
 *
 * index  of the photon in its beam: the first roulettes of all are stratified.
 * least  photons of less power are thinned out to this one, largest channel. */
void photon_walk(TraceThread *thread, const WalkRules *rules, const Beam *beam,
                 const BeamRay *start, uint64_t index, float least, Rng *rng, PhotonList *out,
                 WalkResult *result);

/* Follow a photon to the first place that matters (the target; a diffuse surface, for the global
 * map) and return its flux there, or black; *at is the place. */
Rgb photon_scout(TraceThread *thread, const WalkRules *rules, const Beam *beam,
                 const BeamRay *start, Rng *rng, V3 *at);

#endif
