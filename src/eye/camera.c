/* Camera rays.  SPDX-License-Identifier: Apache-2.0 */
#include "eye/camera.h"

void camera_rays_init(CameraRays *rays, const Camera *camera, int width, int height)
{
    /* The language's aperture is four lens radii. */
    double lens_radius = camera->aperture / 4;
    double length = v3_len(camera->direction);
    V3 across = v3_unit(v3_cross(camera->up, camera->direction));
    V3 along = v3_unit(v3_cross(camera->direction, across));
    *rays = (CameraRays){.kind = camera->kind,
                         .location = camera->location,
                         .direction = camera->direction,
                         .right = camera->right,
                         .up = camera->up,
                         .inv_width = 1.0 / width,
                         .inv_height = 1.0 / height,
                         .lens_x = v3_scale(across, lens_radius),
                         .lens_y = v3_scale(along, lens_radius),
                         .focus = length > 0 ? camera->focal_distance / length : 1};
}

static V3 film_offset(const CameraRays *rays, double x, double y)
{
    V3 right = v3_scale(rays->right, x * rays->inv_width - 0.5);
    return v3_mad(right, 0.5 - y * rays->inv_height, rays->up);
}

/* The ray of a pinhole, its direction not yet unit. */
static Ray pinhole_ray(const CameraRays *rays, double x, double y)
{
    V3 offset = film_offset(rays, x, y);
    if (rays->kind == CAMERA_ORTHOGRAPHIC)
        return (Ray){v3_add(rays->location, offset), rays->direction, 0, INFINITY};
    return (Ray){rays->location, v3_add(rays->direction, offset), 0, INFINITY};
}

Ray camera_ray(const CameraRays *rays, double x, double y)
{
    Ray ray = pinhole_ray(rays, x, y);
    ray.d = v3_unit(ray.d);
    return ray;
}

Ray camera_lens_ray(const CameraRays *rays, double x, double y, V2 lens)
{
    Ray ray = pinhole_ray(rays, x, y);
    V3 shift = v3_mad(v3_scale(rays->lens_x, lens.u), lens.v, rays->lens_y);
    ray.o = v3_add(ray.o, shift);
    ray.d = v3_unit(v3_sub(v3_scale(ray.d, rays->focus), shift));
    return ray;
}
