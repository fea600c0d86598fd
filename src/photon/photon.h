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
    float pos[3];      /* scene units, relative to the map's centre */
    uint8_t rgbe[4];   /* power, shared exponent */
    uint8_t phi, theta; /* direction it came from, quantised */
    uint16_t flags;    /* 2 bits: split axis of the tree; 14 bits: surface normal */
} Photon;

static_assert(sizeof(Photon) == 20, "a photon is 20 bytes");

/* Encode a power with stochastic rounding: the mean over `rng` is exact.  Negative and NaN
 * channels become 0, infinite and huge ones the largest power there is (2^127), powers below
 * 2^-128 round to 0 or the smallest one. */
void rgbe_encode(Rgb power, Rng *rng, uint8_t out[4]);
Rgb rgbe_decode(const uint8_t rgbe[4]);

/* Directions in two bytes: 256 steps of azimuth that wrap, 256 of polar angle, both poles hit.
 * The decoder is a table made once by direction_tables (any thread, idempotent). */
enum { DIRECTION_STEPS = 256 };
void direction_encode(V3 unit, uint8_t *phi, uint8_t *theta);
V3 direction_decode(uint8_t phi, uint8_t theta);
/* Largest angle between a direction and its code, radians. */
#define DIRECTION_MAX_ERROR 0.0139

/* Normals in 14 bits (octahedral, 7 bits a side). */
uint16_t normal14_encode(V3 unit);
V3 normal14_decode(uint16_t code);

#endif
