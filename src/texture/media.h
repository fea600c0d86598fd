/* Participating media: smoke, dust, murky water; and fog and rainbows.
 *
 * A medium absorbs, glows and scatters light.  Along a ray, per scene unit, light is lost by the
 * extinction and added by emission and by what lights send through the scattering:
 *
 *     dL/dt = -X L + E + S sum over lights (phase * light that arrives)
 *     X = absorption + extinction factor * scattering
 *
 * all of them times the density at the place.  Several media in one place add up.  As light has no
 * pi in it, physics has 4 S where the language has S: a medium whose scattering neither adds nor
 * loses light has extinction 4.
 *
 * Nodes live in the scene arena and are immutable once read.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TEXTURE_MEDIA_H
#define PMS_TEXTURE_MEDIA_H

#include "texture/texture.h"

/* The language's scattering types. */
typedef enum PhaseKind {
    PHASE_NONE, /* no scattering */
    PHASE_ISOTROPIC,
    PHASE_MIE_HAZY,
    PHASE_MIE_MURKY,
    PHASE_RAYLEIGH,
    PHASE_HENYEY_GREENSTEIN,
    PHASE_KIND_COUNT
} PhaseKind;

/* Return the phase function at the cosine between the light's direction of travel and that of
 * the scattered light: 1 is straight on.  The language's constants: the mean over the sphere is
 * phase_mean, not quite 1 for the types between isotropic and Henyey-Greenstein. */
double phase_value(PhaseKind kind, double eccentricity, double cosine);
double phase_mean(PhaseKind kind);

/* Draw a cosine with the density of the phase function; u in [0,1). */
double phase_sample(PhaseKind kind, double eccentricity, double u);

typedef struct Density Density;

/* An entry of a density_map. */
typedef struct DensityEntry {
    float key;
    const Density *density;
} DensityEntry;

/* A factor that varies with place: a pattern with colours, or with densities to blend. */
struct Density {
    const Pigment *pigment;  /* its colours; with a map its pattern only */
    const DensityEntry *map; /* in written order; NULL: none */
    int map_count;
    int cost; /* patterns of the map that are looked at for one place, at most */
};

struct Medium {
    Span span;
    Rgb absorption, emission, scattering; /* per scene unit */
    PhaseKind phase;
    float eccentricity;
    float extinction; /* how much of what is scattered the ray loses */
    const Density *const *densities; /* multiplied; NULL: 1 everywhere */
    int density_count;
    int intervals, samples; /* least resolution of the sampling: see media_first_cells */
    float variance, confidence;
    float aa_threshold;
    int aa_level;
    bool is_collecting; /* photons */
};

#define MEDIUM_DEFAULT                                                                             \
    ((Medium){.extinction = 1,                                                                     \
              .intervals = 1,                                                                      \
              .samples = 10,                                                                       \
              .variance = 1.0f / 128,                                                              \
              .confidence = 0.9f,                                                                  \
              .aa_threshold = 0.1f,                                                                \
              .aa_level = 3,                                                                       \
              .is_collecting = true})

/* Return true if the medium is the same everywhere. */
bool medium_is_homogeneous(const Medium *medium);

/* Return true if it does anything to light at all. */
bool medium_is_seen(const Medium *medium);

/* Return what the densities multiply to at a world point; never negative. */
Rgb medium_density(const Medium *medium, V3 p);

/* Return the extinction at density 1, per scene unit. */
static inline Rgb medium_extinction(const Medium *medium)
{
    return rgb_mad(medium->absorption, medium->extinction, medium->scattering);
}

/* Return the factor that makes the medium scatter as much light as its scattering takes away, in
 * the mean over all directions.  What the eye sees is scattered as the language has it; light that
 * goes on to be scattered or reflected again has to keep its energy. */
static inline double medium_gain(const Medium *medium)
{
    return (double)medium->extinction / (4 * phase_mean(medium->phase));
}

/* Return a density, a medium or an interior seen through `xform` (a new node, or the old one
 * when nothing depends on place); NULL when memory is out. */
const Density *density_transform(Arena *arena, const Density *density, const Xform *xform);
const Medium *medium_transform(Arena *arena, const Medium *medium, const Xform *xform);
const Interior *interior_transform(Arena *arena, const Interior *interior, const Xform *xform);

/* fog: a colour that what is far away fades to. */
typedef struct Fog {
    Span span;
    bool is_ground;  /* type 2: thins out above `offset` */
    Color5 color;    /* filter: how much of the view it tints; transmit: what always shows */
    double distance; /* scene units, above 0 */
    double altitude, offset; /* scene units along up; altitude above 0 */
    V3 up;
} Fog;

/* Return what passes a stretch of fog, without filter and transmit.
 *
 * from, to  its ends; `distance` is their distance and may be infinite (then `to` is a direction
 *           from `from`, unit). */
double fog_clearness(const Fog *fog, V3 from, V3 to, double distance);

/* rainbow: colours by the angle from the point opposite the light. */
typedef struct Rainbow {
    Span span;
    V3 toward, up, right; /* unit: from the light, and the plane the arc stands in */
    double angle, width;  /* radians: of its middle; from rim to rim */
    double jitter;        /* parts of the width */
    double arc, falloff;  /* radians, half: where it ends, where it begins to fade */
    double distance;      /* scene units */
    const MapEntry *map;  /* NULL: no colours */
    int map_count;
} Rainbow;

#endif
