/* Photons in media, found by rays: beside gather.h all that the eye pass sees of photon/.
 *
 * A photon lights the ball around it whose radius fits how dense photons are there, but is none so
 * wide that the photon could not be seen in less; a ray takes from it what it would from a disk
 * across the ray.  So one walk through the tree finds all the light along a ray, however long.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_PHOTON_VOLUME_H
#define PMS_PHOTON_VOLUME_H

#include "math/ray.h"
#include "math/rgb.h"
#include "photon/photon_map.h"
#include "trace/trace.h"

typedef struct VolumeIndex VolumeIndex;

/* Make the index of a map that holds photons of media, which must outlive it.
 *
 * tracer   of the scene, for its media.
 * nearest  photons in the ball around each.
 * radius   of all balls, scene units; 0: from the density.
 *
 * ERR_MEMORY, ERR_INTERRUPTED or OK.  Free with volume_index_free. */
Status volume_index_new(const Tracer *tracer, const PhotonMap *map, int nearest, double radius,
                        int threads, Diag *diag, VolumeIndex **out);
void volume_index_free(VolumeIndex *index);

/* Return the radius that fits the middle density of a map, or 0; scene units. */
double volume_radius(const PhotonMap *map, int nearest);

/* The surfaces that a ray comes from and goes to: unit normals, of either sign; 0: none. */
typedef struct VolumeEnds {
    V3 begin, end;
} VolumeEnds;

/* What a photon gives a ray. */
typedef struct VolumePhoton {
    double t;     /* along the ray */
    double way;   /* how far it lies from the surface the ray comes from */
    V3 aside;     /* from the ray to it */
    V3 from;      /* unit, to where it came from */
    Rgb power;    /* flux times length over volume, integrated over the ray: irradiance across the
                     photon's way times length */
    float excess;    /* of its power, what it would give less were its disk half as large */
    bool is_focused; /* it came over mirrors and glass only */
} VolumePhoton;

/* Hand all photons that a ray cuts between t = 0 and `length` to `visit`, in the order of the
 * tree.
 *
 * A photon beside the ray speaks for the parallel ray through it: whether it is between the ends,
 * and how far from the begin, goes by where that one meets the surfaces there, taken as planes.
 *
 * Any thread. */
void volume_along(const VolumeIndex *index, const Ray *ray, double length, const VolumeEnds *ends,
                  void (*visit)(void *ctx, const VolumePhoton *photon), void *ctx);

#endif
