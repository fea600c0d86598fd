/* Rays.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_MATH_RAY_H
#define PMS_MATH_RAY_H

#include "math/v3.h"

typedef struct Ray {
    V3 o;              /* origin, scene units */
    V3 d;              /* unit direction */
    double tmin, tmax; /* only hits with tmin < t < tmax count, scene units */
} Ray;

static inline V3 ray_at(const Ray *ray, double t) { return v3_mad(ray->o, t, ray->d); }

#endif
