/* Final gathering: the light that comes to a point from all around, by rays that look up the
 * irradiance where they end.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_EYE_FINAL_GATHER_H
#define PMS_EYE_FINAL_GATHER_H

#include "eye/eye_int.h"

/* Irradiance at a point and how it changes around it. */
typedef struct GatheredLight {
    Rgb irradiance;
    float noise;     /* standard error of its luminance */
    double distance; /* harmonic mean of those to what was seen, scene units; may be infinite */
    double nearest;  /* the least of them */
    float turn[3][3];  /* per channel: change with a turn of the normal, as a vector to be
                          multiplied with the axis times the angle */
    float shift[3][3]; /* per channel: change with a step along the surface, per scene unit */
} GatheredLight;

/* Gather the light that comes to a point without a light source's own: what surfaces and the sky
 * give off or send on.
 *
 * at      the point; rays leave it on the side of n, and bring nothing from below its surface.
 * inside  the interiors there.
 * rays    about how many; those of its light's photons guide a part of them. */
void final_gather(EyeThread *eye, const ShapePoint *at, V3 n, const Interiors *inside, int rays,
                  GatheredLight *out);

/* The same irradiance by a few rays, for one of many passes: those of all samples of a pixel cover
 * the hemisphere evenly. */
Rgb final_gather_few(EyeThread *eye, const ShapePoint *at, V3 n, const Interiors *inside);

/* Look up the irradiance where a gather ray saw a surface near by; returns false if no record holds
 * there.  n: unit, the side that is seen. */
bool nearby_light_read(EyeThread *eye, V3 p, V3 n, Rgb *light);

/* Keep what was gathered there for other gather rays, while the irradiance cache is filled. */
void nearby_light_keep(EyeThread *eye, V3 p, V3 n, const GatheredLight *light);

#endif
