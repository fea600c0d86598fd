/* Lights as paths meet them: with a size.
 *
 * Photons set what a light sends: into the solid angle dw, L a(D) D^2 dw of colour L, fading a
 * and D the whole way to the surface they light (as on a bare wall, where D^2 dw is the area).
 * Spread over the light's area A, seen at the cosine c, that is L a(D) D^2 / (A c) for each
 * area across the way and solid angle.  A diffuse surface lit evenly by radiance 1 has, in the
 * language, radiance 1 times its colour, so its light is the mean of what comes over directions
 * drawn by their cosine / pi: radiance is pi times flux, and
 *
 *     radiance = pi L a(D) D^2 / (A c).
 *
 * A parallel light sends L a(D) for each area across it, in one direction; spread over a cone of
 * solid angle W the radiance is pi L a(D) / W.  SPDX-License-Identifier: Apache-2.0 */
#include "eye/eye_int.h"

#include "math/eps.h"

/* A light in the surface of an object is seen from outside of it. */
#define SURFACE_SLACK (1 + 0x1p-40)

/* Set t to where the ray comes nearest to the centre; returns true if that is within `radius`. */
static bool meet_disk(V3 center, double radius, const Ray *ray, double *t)
{
    V3 to = v3_sub(center, ray->o);
    *t = v3_dot(to, ray->d);
    return v3_len2(v3_mad(to, -*t, ray->d)) < radius * radius;
}

/* The same for the parallelogram of an area light, or the ellipse within; `across` is set to its
 * area as the ray sees it. */
static bool meet_area(const AreaLight *area, V3 center, const Ray *ray, double *t, double *across)
{
    V3 n = v3_cross(area->axis1, area->axis2), to = v3_sub(center, ray->o);
    double slope = v3_dot(n, ray->d), size2 = v3_len2(n);
    if (slope == 0 || size2 == 0)
        return false;
    *t = v3_dot(n, to) / slope;
    *across = fabs(slope);
    V3 from = v3_mad(v3_neg(to), *t, ray->d);
    double a = v3_dot(v3_cross(from, area->axis2), n) / size2;
    double b = v3_dot(v3_cross(area->axis1, from), n) / size2;
    if (!area->is_circular)
        return fabs(a) < 0.5 && fabs(b) < 0.5;
    *across *= PMS_PI / 4;
    return a * a + b * b < 0.25;
}

static bool meet_parallel(const Light *light, double light_radius, const Ray *ray, double tmax,
                          double length, LightMeeting *out)
{
    /* As the disk at the light's place would be seen from the point it points at. */
    double angle = atan2(light_radius, v3_dist(light->location, light->point_at));
    double cosine = -v3_dot(ray->d, light->direction);
    if (!(cosine > cos(angle)))
        return false;
    out->t = -v3_dot(v3_sub(light->location, ray->o), light->direction) / cosine;
    if (!(out->t > 0 && out->t < tmax * SURFACE_SLACK))
        return false;
    V3 lit = v3_mad(ray_at(ray, out->t), length + out->t, light->direction);
    LightSample sent = light_at(light, light->location, lit);
    double half = sin(angle / 2), solid_angle = 4 * PMS_PI * half * half;
    out->radiance = rgb_scale(sent.color, (float)(PMS_PI / solid_angle));
    return true;
}

bool light_meet(const Light *light, double light_radius, const Ray *ray, double tmax, double length,
                LightMeeting *out)
{
    const AreaLight *area = &light->area;
    if (!plan_light_has_size(light, light_radius))
        return false;
    if (light->is_parallel || light->kind == LIGHT_CYLINDER)
        return meet_parallel(light, light_radius, ray, tmax, length, out);
    bool has_area = area->size1 > 1 && area->size2 > 1, is_met;
    double across;
    if (has_area && !area->is_oriented) {
        is_met = meet_area(area, light->location, ray, &out->t, &across);
    } else { /* a disk that faces the path */
        double radius = has_area ? v3_len(area->axis1) / 2 : light_radius;
        across = PMS_PI * radius * radius;
        is_met = meet_disk(light->location, radius, ray, &out->t);
    }
    if (!is_met || !(out->t > 0 && out->t < tmax * SURFACE_SLACK))
        return false;
    V3 place = ray_at(ray, out->t);
    double way = length + out->t;
    LightSample sent = light_at(light, place, v3_mad(place, -way, ray->d));
    out->radiance = rgb_scale(sent.color, (float)(PMS_PI * way * way / across));
    return true;
}
