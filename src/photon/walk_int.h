/* The way of one photon; for photon/ only.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_PHOTON_WALK_INT_H
#define PMS_PHOTON_WALK_INT_H

#include "base/mem.h"
#include "photon/beam_int.h"
#include "photon/photon.h"

#include <string.h>

/* Which map a photon is for, and so which hits are kept:
 *
 * MAP_CAUSTIC  L S+ D: hits of collecting surfaces that are somewhat diffuse, after at least one
 *              reflection or refraction, the first of them at the target, and none but such.
 *              Passing straight through a pass_through object is none.
 * MAP_GLOBAL   L S* D (S* D)+: every hit of a somewhat diffuse surface after at least one
 *              diffuse reflection; for final gathering all hits, L (S* D)+.  From what glows, E,
 *              all hits always: E (S* D)+.
 *
 * MAP_FOCUS    L S+ M: places in media on the way of light as MAP_CAUSTIC has it.
 * MAP_VOLUME   L (S|D|M)* M with a diffuse reflection or a scattering before the last: light that
 *              media scatter more than once.  From what glows every M: E (S|D|M)* M.  Both go into
 *              one map, the volume map.
 *
 * Looked at by the eye, direct light (L D and L M, by shadow rays that targets block), the caustic
 * map, the global and the volume map count each path once.  Gather rays take glow and the global
 * map alone, so there it holds everything. */
typedef enum MapKind { MAP_CAUSTIC, MAP_GLOBAL, MAP_FOCUS, MAP_VOLUME, MAP_COUNT } MapKind;

/* Are photons for this map sent at targets, over mirrors and glass only? */
static inline bool map_is_aimed(MapKind map)
{
    return map == MAP_CAUSTIC || map == MAP_FOCUS;
}

typedef enum PathEnd { PATH_STORED, PATH_ABSORBED, PATH_ESCAPED, PATH_CUT, PATH_END_COUNT } PathEnd;

/* A growing list of photons. */
typedef struct PhotonList {
    Photon *items;
    PhotonLight *lights; /* of each item in full precision; NULL: not kept */
    size_t count, capacity;
    bool is_short; /* memory ran out: some were not kept */
} PhotonList;

static inline void photon_list_free(PhotonList *list)
{
    mem_free(list->items);
    mem_free(list->lights);
    *list = (PhotonList){0};
}

/* Append the photons of a list to one that has room for them. */
static inline void photon_list_append(PhotonList *to, const PhotonList *from)
{
    if (from->count && to->lights)
        memcpy(to->lights + to->count, from->lights, from->count * sizeof *to->lights);
    if (from->count)
        memcpy(to->items + to->count, from->items, from->count * sizeof *to->items);
    to->count += from->count;
}

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
    bool has_media;
    bool keeps_light; /* photons in full precision too */
} WalkRules;

/* What became of a photon. */
typedef struct WalkResult {
    PathEnd end;
    int stored;  /* photons */
    Rgb emitted; /* flux it started with, as measured where it was first stored, or ended */
    Rgb left;    /* flux it had there */
    Rgb balance; /* shares of what it started with: those that surfaces absorbed up to there, as
                    their reflectances say, and what the dice left; 1 in the mean over photons */
} WalkResult;

/* What media do to a photon between two surfaces. */
typedef struct MediaLeg {
    bool has_stop; /* the photon is to be stored, */
    double stop;   /* at this t, */
    Rgb power;     /* with this share of its own, scene units: see media_place */
    bool is_scattered; /* at t, into direction d; else it gets to the end */
    double t;
    V3 d;
    Rgb weight; /* share of the light that goes on */
} MediaLeg;

/* Find what media do on a leg.  Returns false when there are none.
 *
 * length    to the next surface; infinite: there is none.
 * may_stop, may_scatter  what the map is for.
 * weight    of the photon: the channels that count. */
bool media_leg(TraceThread *thread, const WalkRules *rules, const Ray *ray, double length,
               const Interiors *inside, bool may_stop, bool may_scatter, Rgb weight, Rng *rng,
               MediaLeg *out);

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
