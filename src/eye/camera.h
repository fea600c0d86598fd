/* Camera rays: from a place on the film to a ray into the scene.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_EYE_CAMERA_H
#define PMS_EYE_CAMERA_H

#include "math/ray.h"
#include "scene/scene.h"

/* A camera made ready for one film size. */
typedef struct CameraRays {
    CameraKind kind;
    V3 location, direction, right, up; /* as of the scene */
    double inv_width, inv_height;      /* 1 / film size in pixels */
    V3 lens_x, lens_y;                 /* edges of the lens: its radius in scene units */
    double focus;                      /* focal distance / |direction| */
} CameraRays;

void camera_rays_init(CameraRays *rays, const Camera *camera, int width, int height);

/* Return the ray through film position (x, y), pixels from the top left corner. */
Ray camera_ray(const CameraRays *rays, double x, double y);

/* Return the ray through (x, y) that leaves the lens at `lens`, a point of the unit disk.  All
 * rays of one film position meet on the plane of focus. */
Ray camera_lens_ray(const CameraRays *rays, double x, double y, V2 lens);

#endif
