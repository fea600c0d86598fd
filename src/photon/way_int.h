/* A photon on its way: what the files walk*.c and roulette.c share; for photon/ only.
 *
 * walk.c       from surface to surface, and what ends the way
 * roulette.c   what a surface may do with the photon, and the dice
 * walk_turn.c  how the photon goes on as the dice say
 * walk_keep.c  where it is stored
 *
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_PHOTON_WAY_INT_H
#define PMS_PHOTON_WAY_INT_H

#include "photon/walk_int.h"

/* A path on its way. */
typedef struct Walk {
    TraceThread *thread;
    const WalkRules *rules;
    const Beam *beam;
    const BeamRay *start;
    Ray ray;
    Interiors inside;
    double length;      /* gone in all up to the last surface */
    Rgb weight;         /* share of the light that is left */
    Rgb lost;           /* share that was absorbed, until the path is settled */
    bool is_settled;    /* the books know what became of it: it came to a place to be stored at */
    Rgb flux;           /* of a weight of 1 at flux_length; fixed at the first diffuse surface */
    double flux_length; /* negative: not known yet */
    int level;
    bool is_aimed;    /* has met its target, or needs none */
    bool is_specular; /* was reflected or refracted */
    bool is_diffuse;  /* was reflected diffusely */
    int diffuse;      /* how often */
    bool is_straight; /* the last surface did not bend it */
    bool has_chosen;  /* thrown the dice before */
    bool is_scout;
    uint64_t index; /* of the photon */
    Rng *rng;
} Walk;

typedef enum Branch {
    BRANCH_ABSORB,
    BRANCH_DIFFUSE,
    BRANCH_BACK, /* diffusely to the other side */
    BRANCH_REFLECT,
    BRANCH_TRANSMIT
} Branch;

/* What a surface does with light, each channel, and how likely each branch is. */
typedef struct Roulette {
    Rgb diffuse, back, reflect, transmit;
    double p_diffuse, p_back, p_reflect, p_transmit;
    V3 reflect_dir;
} Roulette;

/* --- the books ---------------------------------------------------------------------------- */

/* Return the flux of a weight of 1 where the photon is. */
static inline Rgb walk_flux(Walk *walk)
{
    if (!walk->is_diffuse && walk->flux_length != walk->length) {
        walk->flux = beam_flux(walk->beam, walk->start, walk->length);
        walk->flux_length = walk->length;
    }
    return walk->flux;
}

/* Multiply the weight by what a surface or a way lets go on of it. */
static inline void walk_weaken(Walk *walk, Rgb share)
{
    Rgb rest = rgb_mul(walk->weight, share);
    walk->lost = rgb_add(walk->lost, rgb_sub(walk->weight, rest));
    walk->weight = rest;
}

/* Close the books on the path: it began with a flux of `emitted` and has this share of it left. */
static inline void walk_settle(Walk *walk, Rgb emitted, Rgb share, WalkResult *result)
{
    if (walk->is_settled)
        return;
    walk->is_settled = true;
    result->emitted = emitted;
    result->left = rgb_mul(emitted, share);
    result->balance = rgb_add(walk->lost, share);
}

/* Light that a surface gives off has one reflection less to go: the eye sees it directly, light
 * of a light source by its first reflection. */
static inline int walk_most_diffuse(const Walk *walk)
{
    return walk->rules->max_diffuse - (walk->beam->light == NULL);
}

/* --- the roulette ------------------------------------------------------------------------- */

/* Return the colour with no channel below 0: no light is less than none. */
static inline Rgb rgb_not_negative(Rgb c)
{
    return rgb(fmaxf(c.r, 0), fmaxf(c.g, 0), fmaxf(c.b, 0));
}

/* Fill in what a surface does with a photon and how likely each branch is. */
void roulette_set(const Walk *walk, const SurfaceSample *s, Roulette *out);

/* Return true if some light is scattered diffusely, to either side. */
static inline bool roulette_is_diffuse(const Roulette *r)
{
    return !rgb_is_black(r->diffuse) || !rgb_is_black(r->back);
}

/* Throw the dice. */
Branch roulette_spin(Walk *walk, const Roulette *r);

/* --- going on ----------------------------------------------------------------------------- */

/* Pass an object that photons do not see, straight on. */
void walk_pass_through(Walk *walk, const SurfaceSample *s);

/* Follow the branch the dice chose; returns false when the path ends here. */
bool walk_follow(Walk *walk, const Hit *hit, const SurfaceSample *s, const Roulette *r,
                 Branch branch);

/* --- storing ------------------------------------------------------------------------------ */

/* Return true if a photon is kept where this surface scatters diffusely. */
bool walk_keeps(const Walk *walk, const Hit *hit);

/* Keep the photon where it hits a surface.
 *
 * least  as in photon_walk. */
void walk_keep(Walk *walk, const Hit *hit, float least, PhotonList *out, WalkResult *result);

/* Store a photon at the stop of a leg: its power is what passes there, times the length of way it
 * stands for. */
void walk_keep_stop(Walk *walk, const MediaLeg *leg, PhotonList *out, WalkResult *result);

#endif
