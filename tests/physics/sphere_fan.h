/* Rays through a glass ball over a floor, by Snell's law in the plane of the axis: what its caustic
 * is compared with.  The ball has radius 1, ior 1.5 and its centre at height 1.5.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TESTS_SPHERE_FAN_H
#define PMS_TESTS_SPHERE_FAN_H

#include <math.h>
#include <stdbool.h>

/* Where a ray that starts on the axis at height 6 with angle `angle` to it (point), or beside
 * it by `aside` (parallel), meets the floor after the sphere; false: it does not. */
static inline bool through_sphere(double angle, double aside, double *radius, double *length)
{
    double x = aside, y = 6, dx = sin(angle), dy = -cos(angle), total = 0;
    for (int surface = 0; surface < 2; surface++) {
        double cx = x, cy = y - 1.5, b = cx * dx + cy * dy, c = cx * cx + cy * cy - 1;
        double under = b * b - c;
        if (surface == 0 && under <= 0)
            return false;
        double t = surface == 0 ? -b - sqrt(under) : -b + sqrt(fmax(0, under));
        x += t * dx;
        y += t * dy;
        total += t;
        double nx = x, ny = y - 1.5, cosine = -(nx * dx + ny * dy);
        if (cosine < 0) {
            nx = -nx;
            ny = -ny;
            cosine = -cosine;
        }
        double ratio = surface == 0 ? 1 / 1.5 : 1.5;
        double k = 1 + ratio * ratio * (cosine * cosine - 1);
        if (k < 0)
            return false;
        double w = ratio * cosine - sqrt(k);
        dx = ratio * dx + w * nx;
        dy = ratio * dy + w * ny;
    }
    if (dy >= 0)
        return false;
    *radius = fabs(x + y / -dy * dx);
    *length = total + y / -dy;
    return true;
}

/* Irradiance of the floor under a point light of colour 1 at height 6, by rings of `width`. */
static inline void fan_profile(double *profile, int rings, double width)
{
    enum { RAYS = 8000000 };
    double most = asin(1 / 4.5);
    for (int i = 0; i < rings; i++)
        profile[i] = 0;
    for (int i = 0; i < RAYS; i++) {
        double radius, length, angle = most * (i + 0.5) / RAYS;
        if (!through_sphere(angle, 0, &radius, &length) || radius >= rings * width)
            continue;
        int ring = (int)(radius / width);
        profile[ring] +=
            2 * sin(angle) * most / RAYS * length * length / (width * width * (2 * ring + 1));
    }
}

#endif
