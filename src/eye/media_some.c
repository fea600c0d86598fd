/* Light of a lamp that media scatter once, from one place along a ray drawn at random: for rays
 * that are many, as those that gather light and those of paths.  SPDX-License-Identifier:
 * Apache-2.0 */
#include "eye/air_int.h"

/* What arrives at p of a light, from a point of it. */
static Rgb arriving_light(EyeThread *eye, const EyeLight *light, V3 point, V3 p)
{
    const Light *source = light->light;
    LightSample center = light_at(source, source->location, p);
    if (rgb_is_black(center.color))
        return RGB_BLACK;
    LightSample sample = light_at(source, point, p);
    if (!(sample.distance > 0))
        return center.color;
    Rgb arrived = media_air_shadow(&eye->trace, p, sample.to_light, sample.distance, light->index);
    arrived = rgb_mul(arrived, air_shadow(eye, light, p, &sample, false));
    return rgb_mul(center.color, arrived);
}

static V3 direction_to(const EyeLight *light, V3 p)
{
    return light_at(light->light, light->light->location, p).to_light;
}

/* Light that fades is without limit near the lamp: its places follow from where that is. */
static bool is_fading(const Light *light)
{
    return light->fade_power > 0 && light->fade_distance > 0 && !light->is_parallel &&
           light->kind != LIGHT_CYLINDER;
}

/* Draw a place evenly by the angle that the ray is seen under from a point; *weight is what passes
 * up to there over the density of the places. */
static bool place_by_angle(const MediaProfile *profile, const Ray *ray, V3 point, double u,
                           double *t, Rgb *weight)
{
    double nearest = v3_dot(v3_sub(point, ray->o), ray->d);
    double away = v3_dist(point, ray_at(ray, nearest));
    double begin = profile->cells[0].begin, end = profile->cells[profile->count - 1].end;
    double low = atan2(begin - nearest, away), high = atan2(end - nearest, away);
    double angle = low + (high - low) * u, cosine = cos(angle);
    if (!(away > 0 && high > low && cosine > 0))
        return false;
    *t = fmin(end, fmax(begin, nearest + away * tan(angle)));
    const MediaCell *cell = air_cell_at(profile, *t);
    Rgb depth = rgb_mad(cell->depth, (float)(*t - cell->begin), cell->point.extinction);
    *weight = rgb_scale(media_clear(depth), (float)((high - low) * away / (cosine * cosine)));
    return true;
}

Rgb media_scatter_some(EyeThread *eye, const EyeLight *light, const MediaLobes *lobes,
                       const MediaProfile *profile, const Interiors *inside, const Ray *ray)
{
    V3 point = light_point(eye, light, ray->o);
    double t, u = rng_double(&eye->rng);
    Rgb weight;
    if (is_fading(light->light) ? !place_by_angle(profile, ray, point, u, &t, &weight)
                                : !media_place(profile, RGB_WHITE, u, &t, &weight))
        return RGB_BLACK;
    V3 p = ray_at(ray, t);
    V3 looked_at = lobes->here->is_homogeneous ? p : ray_at(ray, air_cell_at(profile, t)->at);
    Rgb light_there = media_scattered(lobes, looked_at, v3_dot(direction_to(light, p), ray->d));
    light_there = rgb_mul(rgb_mul(light_there, weight), interiors_fade(inside, t));
    if (rgb_is_black(light_there))
        return RGB_BLACK;
    return rgb_mul(light_there, arriving_light(eye, light, point, p));
}
