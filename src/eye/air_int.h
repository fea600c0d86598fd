/* What lies between the eye and what it sees: media, fog, rainbows; for eye/ only.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_EYE_AIR_INT_H
#define PMS_EYE_AIR_INT_H

#include "eye/eye_int.h"
#include "trace/media_along.h"

/* What a stretch of a ray does to what is seen through it. */
typedef struct Veil {
    Rgb through;           /* share of what lies behind that is seen */
    Rgb front, back;       /* of it what fog before the media and rainbows behind them let pass */
    Rgb light[PART_COUNT]; /* added in front of it */
} Veil;

/* The surfaces that a ray comes from and goes to. */
typedef struct AirEnds {
    VolumeEnds planes;
    const Object *from; /* that the ray comes from; NULL: none */
} AirEnds;

/* What a ray looks for in media. */
typedef enum AirLight {
    AIR_SEEN,     /* their own light and what they scatter to the eye */
    AIR_GATHERED, /* the same for light that will be reflected: it keeps its energy, and is that of
                     one place drawn at random */
    AIR_GLOW      /* their own light */
} AirLight;

/* Find what lies along the first `length` scene units of a ray inside `inside`; an infinite length
 * is that of a ray that meets nothing. */
void air_along(EyeThread *eye, const Ray *ray, double length, const Interiors *inside,
               AirLight wanted, Veil *out);

/* The same with photons in media, for a ray between two surfaces. */
void air_between(EyeThread *eye, const Ray *ray, double length, const AirEnds *ends,
                 const Interiors *inside, AirLight wanted, Veil *out);

/* Return what of a light, as a place in media sees it, is not in shadow there:
 * see trace_shadow. */
Rgb air_shadow(EyeThread *eye, const EyeLight *light, V3 p, const LightSample *sample,
               bool blocks_targets);

/* Cut the first `length` scene units of a ray into cells. */
void air_profile(EyeThread *eye, const MediaHere *here, const Ray *ray, double length,
                 MediaProfile *out);

/* Return the cell of a profile at t. */
const MediaCell *air_cell_at(const MediaProfile *profile, double t);

/* Return what passes the media along the first `length` scene units of a ray. */
Rgb air_clear(EyeThread *eye, const Ray *ray, double length, const Interiors *inside);

/* Add to *light what the lights send through the media to the eye, once scattered. */
void media_scatter(EyeThread *eye, const MediaHere *here, const MediaProfile *profile,
                   const Ray *ray, Rgb *light);

/* Return the light of a lamp that media scatter along a ray to its begin, from one place drawn at
 * random; the mean over many is all of it. */
Rgb media_scatter_some(EyeThread *eye, const EyeLight *light, const MediaLobes *lobes,
                       const MediaProfile *profile, const Interiors *inside, const Ray *ray);

/* Add the light of the photons in the media along a ray, from t = begin to end, to the parts it
 * belongs to; `ends` are the surfaces there. */
void media_photons(EyeThread *eye, const MediaHere *here, const MediaProfile *profile,
                   const Ray *ray, double begin, double end, const AirEnds *ends,
                   Rgb light[PART_COUNT]);

/* The part of a ray, from begin to end, on which a light can shine; returns false if none is. */
bool light_stretch(const Light *light, const Ray *ray, double *begin, double *end);

#endif
