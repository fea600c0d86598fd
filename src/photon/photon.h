/* The photon as it is stored: 20 bytes.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_PHOTON_PHOTON_H
#define PMS_PHOTON_PHOTON_H

#include "base/rng.h"
#include "math/rgb.h"
#include "math/v3.h"

#include <assert.h>
#include <stdint.h>

typedef struct Photon {
    float pos[3];       /* scene units, relative to the map's centre */
    uint8_t rgbe[4];    /* power, shared exponent */
    uint8_t phi, theta; /* direction it came from, quantised */
    uint16_t flags;     /* high 14 bits: surface normal on the side it arrived at; low 2:
                           PHOTON_INSIDE or 0.  In media: PHOTON_FOCUSED or 0 */
} Photon;

static_assert(sizeof(Photon) == 20, "a photon is 20 bytes");

/* Power and direction of a photon as they were before they went into its 20 bytes: kept beside it
 * only to measure what the 20 bytes cost. */
typedef struct PhotonLight {
    Rgb power;
    float from[3]; /* unit, towards where it came from */
} PhotonLight;

/* A photon in media that came over mirrors and glass only. */
enum { PHOTON_FOCUSED = 1 };

/* A photon that hit the surface of a solid from inside.  In a thin one it lies where those on the
 * outside of the other face lie, with the same normal. */
enum { PHOTON_INSIDE = 2 };

/* The shared exponent of RGBE: a channel is byte * 2^(exponent - RGBE_BIAS).  Exponents below
 * RGBE_LEAST are not used, so that every step is a normal float; exponent 0 means black. */
enum { RGBE_BIAS = 136, RGBE_LEAST = 10, RGBE_MOST = 255 };

/* Encode a power with stochastic rounding: the mean over `rng` is exact.  Negative and NaN
 * channels become 0, infinite and huge ones the largest value there is (255 * 2^119), values
 * below the smallest step (2^-126) become 0 or that step.  Uses one number of `rng`. */
void rgbe_encode(Rgb power, Rng *rng, uint8_t out[4]);
Rgb rgbe_decode(const uint8_t rgbe[4]);

/* Directions in two bytes: 256 steps of azimuth that wrap, 256 of polar angle from z, both
 * poles hit.  Decoding reads tables.  A direction that is not finite decodes to some unit
 * vector. */
enum { DIRECTION_STEPS = 256 };
void direction_encode(V3 unit, uint8_t *phi, uint8_t *theta);
V3 direction_decode(uint8_t phi, uint8_t theta);
/* Largest angle between a direction and its code, radians: half a step each way. */
#define DIRECTION_MAX_ERROR 0.0139

/* Normals in 14 bits: octahedral, 127 steps a side, so that the axes are exact. */
enum { NORMAL_STEPS = 127 };
uint16_t normal14_encode(V3 unit);
V3 normal14_decode(uint16_t code);
/* Largest angle between a normal and its code, radians. */
#define NORMAL14_MAX_ERROR 0.0335

#endif
