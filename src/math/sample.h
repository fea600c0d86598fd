/* Low-discrepancy points and the warps that turn them into directions and positions.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_MATH_SAMPLE_H
#define PMS_MATH_SAMPLE_H

#include "math/v3.h"

#include <stdint.h>

/* Return point `index` of a (0,2)-sequence in [0,1)^2, Owen-scrambled and shuffled by `key`.
 * Different keys give independent sequences: use one per pixel and pair of dimensions.
 * Any power-of-two prefix is a (0,m,2)-net. */
V2 sample_2d(uint32_t index, uint64_t key);

/* Return point `index` of the van der Corput sequence in [0,1), scrambled by `key`. */
double sample_1d(uint32_t index, uint64_t key);

/* Return the radical inverse of `index` in [0,1), Owen-scrambled by `key` but in its own order:
 * with index/n it makes a Hammersley set of n points, even better spread than a sequence. */
double sample_inverse(uint32_t index, uint64_t key);

/* Map the unit square to the unit disk, area preserving (concentric map). */
V2 warp_disk(V2 u);

/* Map to the unit sphere, uniform in solid angle. */
V3 warp_sphere(V2 u);

/* Map to the directions within `cos_max` of +z, uniform in solid angle. */
V3 warp_cone(V2 u, double cos_max);

/* Map to the hemisphere around +z with density cos/pi. */
V3 warp_cosine(V2 u);

/* Turn a direction given around +z into the frame of the unit vector n. */
V3 warp_to_frame(V3 local, V3 n);

#endif
