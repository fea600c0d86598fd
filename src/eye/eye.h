/* The eye pass: radiance along a camera ray.
 *
 * Direct light by shadow rays, reflection and refraction by recursion with the language's
 * finish arithmetic, caustics from the caustic map, indirect light from the global map.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_EYE_EYE_H
#define PMS_EYE_EYE_H

#include "photon/gather.h"
#include "trace/trace.h"

/* Light by where it comes from; they add up to the beauty. */
typedef enum LightPart {
    PART_DIRECT,   /* ambient, emission, lights, highlights and the background */
    PART_CAUSTIC,  /* from the caustic map */
    PART_INDIRECT, /* from the global map */
    PART_COUNT
} LightPart;

typedef struct EyeMaps {
    const PhotonMap *caustic, *global; /* NULL: none */
    GatherLimits caustic_limits, global_limits;
} EyeMaps;

typedef struct EyeSample {
    Rgb part[PART_COUNT]; /* radiance */
    float alpha;          /* 1 - transmit of the ray */
    double depth;         /* distance to the first surface, scene units; infinite: none */
    V3 normal;            /* of the first surface, world, facing the camera; 0: none */
    Rgb albedo;           /* pigment of the first surface */
} EyeSample;

/* Per-thread state of the pass. */
typedef struct EyeThread EyeThread;
Status eye_thread_new(const Tracer *tracer, const EyeMaps *maps, uint64_t seed, Diag *diag,
                      EyeThread **out);
void eye_thread_free(EyeThread *eye, Stats *add_to);

/* Trace sample `index` through film position (x, y), pixels from the top left corner (a
 * pixel's centre is at +0.5), of a width x height film.  The random numbers depend on pixel,
 * index and seed only. */
void eye_sample(EyeThread *eye, double x, double y, int width, int height, uint32_t pixel,
                uint32_t index, EyeSample *out);

#endif
