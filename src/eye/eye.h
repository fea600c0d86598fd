/* The eye pass: radiance along a camera ray.
 *
 * Direct light by shadow rays, reflection and refraction by recursion with the language's
 * finish arithmetic, caustics from the caustic map, indirect light by final gathering over the
 * global map, or from it directly.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_EYE_EYE_H
#define PMS_EYE_EYE_H

#include "eye/photon_reach.h"
#include "photon/gather.h"
#include "photon/irradiance.h"
#include "photon/volume.h"
#include "trace/trace.h"

/* Light by where it comes from; the first PART_LIGHTS add up to the beauty.  What may be wrong with
 * the light of photons goes the same way as that light. */
typedef enum LightPart {
    PART_DIRECT,   /* ambient, emission, lights, highlights and the background */
    PART_CAUSTIC,  /* from the caustic map */
    PART_INDIRECT, /* gathered, or from the global map */
    PART_LIGHTS,
    PART_BLUR = PART_LIGHTS, /* see LightEstimate */
    PART_NOISE,              /* see LightEstimate; added up as if of the same photons */
    PART_COUNT
} LightPart;

typedef struct EyeOptions {
    int width, height; /* of the film, pixels */
    bool has_alpha;    /* the background shows in alpha instead of being opaque */
    uint64_t seed;
    bool is_progressive;   /* one of many passes, whose mean is the picture: what is spread (a
                              lens) is a single point for each sample */
    const PhotonMap *caustic, *global; /* NULL: none */
    const IrradianceMap *irradiance;   /* for final gathering; NULL: it finds glow alone */
    const struct IrradianceCache *cache; /* NULL: gather everywhere */
    const struct IrradianceCache *near_cache; /* for what gather rays see near by; NULL: none */
    double record_reach; /* how far its records hold, over what the scene asks for */
    int gather_rays;     /* of a record */
    const VolumeIndex *volume;         /* photons in media; NULL: none */
    bool has_no_caustics, has_no_focus; /* no light reaches a target, so that none casts a full
                                           shadow: on surfaces, in media */
    const PhotonReach *caustic_reach;  /* for caustic_limits */
    GatherLimits caustic_limits, global_limits;
    bool has_error; /* errors of the light of photons are estimated, as the limits should say */
} EyeOptions;

typedef struct EyeSample {
    Rgb part[PART_COUNT]; /* radiance; blur and noise are black without limits.has_error */
    Rgb lens_noise;       /* standard error that the rays of focal blur leave */
    float alpha;          /* 1 - transmit of the ray */
    double depth;         /* distance to the first surface, scene units; infinite: none */
    V3 normal;            /* of the first surface, world, facing the camera; 0: none */
    Rgb albedo;           /* pigment of the first surface */
} EyeSample;

/* Per-thread state of the pass. */
typedef struct EyeThread EyeThread;
Status eye_thread_new(const Tracer *tracer, const EyeOptions *options, Diag *diag, EyeThread **out);
void eye_thread_free(EyeThread *eye, Stats *add_to);

/* Trace sample `index` through film position (x, y), pixels from the top left corner (a
 * pixel's centre is at +0.5).  The random numbers depend on pixel, index and seed only.  With
 * focal blur one sample is many rays, spread over a pixel's area around (x, y); in a progressive
 * pass it is one.
 *
 * Returns false, counts it and makes the sample black when some of it is not a number. */
bool eye_sample(EyeThread *eye, double x, double y, uint32_t pixel, uint32_t index, EyeSample *out);

/* What became of one ray of a sample. */
typedef struct EyeStep {
    RayKind kind;
    int level; /* rays before it that count */
    Ray ray;
    const Object *object; /* that it met; NULL: none */
    double t;             /* what follows holds where it met something */
    V3 p, n;              /* n: unit, geometric, outward */
    double p_error;       /* bound on the distance of p from the surface */
    bool is_entering;
    Rgb through; /* the share of the light from here that counts */
    Rgb light;   /* that the sample got here; what other rays bring is told of those */
} EyeStep;

/* Is all of it numbers? */
bool eye_step_is_finite(const EyeStep *step);

/* One who is told of every ray of a sample, in the order that they are traced in. */
typedef struct EyeWitness {
    void (*step)(void *ctx, const EyeStep *step);
    void *ctx;
} EyeWitness;

/* Let `witness`, borrowed, see the samples to come; NULL: nobody. */
void eye_watch(EyeThread *eye, const EyeWitness *witness);

/* Return how many samples of this thread were no numbers. */
uint64_t eye_fault_count(const EyeThread *eye);

/* Trace a sample that is no number again; returns the object at which it first was none: NULL if it
 * is the sky, or the camera. */
const Object *eye_find_fault(EyeThread *eye, double x, double y, uint32_t pixel, uint32_t index);

#endif
