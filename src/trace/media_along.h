/* Media along a stretch of a ray: what it lets through and what it is made of.
 *
 * A stretch is cut into cells in each of which the media are taken to be the same throughout:
 * one cell where they are homogeneous, else as many as the estimated error calls for.  Within a
 * cell everything is in closed form.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TRACE_MEDIA_ALONG_H
#define PMS_TRACE_MEDIA_ALONG_H

#include "trace/trace.h"

/* The media in one place: lists of the interiors around it and of the atmosphere. */
typedef struct MediaList {
    const Medium *const *media;
    int count;
} MediaList;

typedef struct MediaHere {
    bool is_open; /* no solid that is not hollow is around: fog and rainbows are seen */
    bool is_homogeneous;
    bool is_conserving; /* scattering adds no light: see medium_gain; the functions here unset it */
    int list_count; /* 0: nothing does anything to light */
    MediaList lists[INTERIORS_MAX + 1];
} MediaHere;

/* Find the media for a ray inside `inside`. */
void media_here(const Tracer *tracer, const Interiors *inside, MediaHere *out);

/* The same for one interior alone. */
void media_of_interior(const Interior *interior, MediaHere *out);

/* The same for the atmosphere alone. */
void media_of_air(const Tracer *tracer, MediaHere *out);

/* Light per scene unit at a place. */
typedef struct MediaPoint {
    Rgb extinction, emission, scattering;
} MediaPoint;
void media_at(const MediaHere *here, V3 p, MediaPoint *out);

/* Scattering times phase function, made ready to be asked for many directions and places. */
typedef struct MediaLobe {
    PhaseKind phase;
    double eccentricity;
    Rgb scattering;
} MediaLobe;

typedef struct MediaLobes {
    const MediaHere *here; /* must outlive this */
    int count;             /* 0: the media are asked at the place itself */
    MediaLobe lobes[INTERIORS_MAX + 1];
} MediaLobes;
void media_lobes(const MediaHere *here, MediaLobes *out);

/* Return their sum at p, for light that turns by an angle of this cosine. */
Rgb media_scattered(const MediaLobes *lobes, V3 p, double cosine);

/* How finely to look: the strictest of the media there. */
typedef struct MediaCare {
    int cells, level; /* to begin with; how often a cell may be halved */
    float tolerance;  /* of the light a stretch adds */
    float threshold;  /* a difference along the whole stretch that matters */
} MediaCare;
MediaCare media_care(const MediaHere *here);

typedef struct MediaCell {
    double begin, end; /* t */
    double at;         /* where the media were looked at */
    MediaPoint point;
    Rgb depth; /* optical depth at its begin */
} MediaCell;

enum { MEDIA_CELLS_MAX = 256 };

typedef struct MediaProfile {
    int count;
    Rgb depth; /* of the whole stretch */
    MediaCell cells[MEDIA_CELLS_MAX];
} MediaProfile;

/* Cut the stretch from t = begin to end into cells.
 *
 * near  where the part of the scene that has objects ends, t: an endless stretch is cut more
 *       coarsely from there on.
 * stats the cells are counted there. */
void media_profile(const MediaHere *here, const Ray *ray, double begin, double end, double near,
                   Rng *rng, Stats *stats, MediaProfile *out);

/* Return exp(-depth), channel by channel. */
static inline Rgb media_clear(Rgb depth)
{
    if (depth.r == depth.g && depth.r == depth.b) {
        float clear = expf(-depth.r);
        return rgb(clear, clear, clear);
    }
    return rgb(expf(-depth.r), expf(-depth.g), expf(-depth.b));
}

/* Return the integral of exp(-x t) over t from 0 to `length`, channel by channel. */
Rgb media_glow_length(Rgb x, double length);

/* Return what passes the stretch. */
Rgb media_transmittance(const MediaHere *here, const Ray *ray, double begin, double end,
                        double near, Rng *rng, Stats *stats);

/* Draw a place along a profile, where it scatters, in proportion to the light that gets there.
 *
 * light   the channels that count, as a photon or path has them.
 * u       in [0,1).
 * weight  what passes up to there, over the density of the places: its mean over many places is
 *         the integral of what passes, over all that scatters.
 *
 * Returns false when nothing scatters. */
bool media_place(const MediaProfile *profile, Rgb light, double u, double *t, Rgb *weight);

/* Draw where light collides with the media.
 *
 * light   what the light is made of: the channels that count.
 * weight  what passes up to t over the chance of it; without a collision: up to the end.
 *
 * Returns true for a collision: *cell is where, and the light left there has lost nothing yet. */
bool media_collide(const MediaProfile *profile, Rgb light, Rng *rng, double *t, Rgb *weight,
                   const MediaCell **cell);

/* Return what a medium scatters at p of light that collides, per scene unit. */
Rgb medium_kept(const Medium *medium, V3 p);

/* Draw one of the media at p by how much it has, as `share` says, of `light`; *weight is its share
 * over the chance.  NULL: none has any. */
const Medium *media_choose(const MediaHere *here, V3 p, Rgb light,
                           Rgb (*share)(const Medium *medium, V3 p), Rng *rng, Rgb *weight);

/* Return what passes the media of objects on a shadow ray.
 *
 * is_to_light  the light dims in media: also those that it is in, or that have no end before
 *              it; the language leaves them out. */
Rgb media_shadow(TraceThread *thread, const Ray *ray, bool is_to_light);

/* Return what of light `light` (index) passes fog and atmosphere on its way to p, from `distance`
 * scene units away in unit direction `to`: all, unless the light dims in media.  Photons do not see
 * fog, so it takes nothing from light that is dimmed as they are. */
Rgb media_air_shadow(TraceThread *thread, V3 p, V3 to, double distance, int light);

#endif
