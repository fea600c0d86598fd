/* The language's noise: smooth random numbers in space.
 *
 * Space is cut into unit cells.  The corners of a cell have random values and slopes; between them
 * noise is blended, with continuous slopes.  Two families of corners give three generators: 1 and 2
 * stretch the same noise differently (lattice noise), 3 has corners of its own.  All values are
 * those of POV-Ray.  The tables repeat every 4096 cells (2048 for generator 3).
 *
 * What is asked for is asked of the tables, which are made once and never change: any thread.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_MATH_NOISE_H
#define PMS_MATH_NOISE_H

#include "base/arena.h"
#include "math/range.h"
#include "math/v3.h"

#include <stdint.h>

/* The language numbers them from 1. */
enum { NOISE_GENERATORS = 3, NOISE_GENERATOR_DEFAULT = 2 };

typedef struct Noise Noise;

/* Make the tables; NULL when memory is out. */
const Noise *noise_new(Arena *arena);

/* Return the noise at a point, from 0 to 1; its mean is near 1/2. */
double noise_value(const Noise *noise, int generator, V3 p);

/* The same, and its derivatives. */
double noise_gradient(const Noise *noise, int generator, V3 p, V3 *gradient);

/* Bound noise in a box, and its derivatives by x, y and z.  slopes: 3 of them, or NULL. */
Range noise_range(const Noise *noise, int generator, const Range *box, Range *slopes);

/* Return three independent lattice noises around 0, the same for all generators: a displacement. */
V3 noise_vector(const Noise *noise, V3 p);

/* Noise of several sizes added up: each octave lambda times as fine and omega times as strong as
 * the one before. */
typedef struct Turbulence {
    int octaves; /* at least 1 */
    double lambda, omega;
} Turbulence;
#define TURBULENCE_DEFAULT ((Turbulence){6, 2, 0.5})

double noise_turbulence(const Noise *noise, int generator, V3 p, const Turbulence *turbulence);
V3 noise_turbulence_vector(const Noise *noise, V3 p, const Turbulence *turbulence);

/* Return a random number from 0 to 4095 for a cell, the same for coordinates 4096 apart. */
unsigned noise_hash(const Noise *noise, int x, int y, int z);

#endif
