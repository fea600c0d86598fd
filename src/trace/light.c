/* Light arriving from one source, before any shadow.  SPDX-License-Identifier: Apache-2.0 */
#include "trace/trace.h"

static double smoothstep(double x)
{
    return x * x * (3 - 2 * x);
}

static double power_or_one(double base, double exponent)
{
    return exponent == 0 ? 1 : pow(base, exponent);
}

static double spot_factor(const Light *light, V3 to_light)
{
    double cosine = -v3_dot(to_light, light->direction);
    if (!(cosine > 0))
        return 0;
    double inner = light->cos_radius, outer = light->cos_falloff;
    if (cosine >= inner)
        return power_or_one(cosine, light->tightness);
    if (!(cosine > outer))
        return 0;
    return power_or_one(cosine, light->tightness) * smoothstep((cosine - outer) / (inner - outer));
}

static double cylinder_factor(const Light *light, V3 location, V3 p)
{
    V3 from_light = v3_sub(p, location);
    double along = v3_dot(from_light, light->direction);
    double aside = v3_len(v3_mad(from_light, -along, light->direction));
    if (!(along > 0 && aside < light->falloff))
        return 0;
    double rest = 1 - aside / light->falloff;
    double factor = power_or_one(rest, light->tightness);
    if (aside > light->radius)
        factor *= smoothstep(rest / (1 - light->radius / light->falloff));
    return factor;
}

/* The attenuation when the direction to the light is known. */
static double factor_towards(const Light *light, V3 location, V3 p, V3 to_light)
{
    switch (light->kind) {
    case LIGHT_SPOT:
        return spot_factor(light, to_light);
    case LIGHT_CYLINDER:
        return cylinder_factor(light, location, p);
    default:
        return 1;
    }
}

double light_shape_factor(const Light *light, V3 location, V3 p)
{
    if (light->kind == LIGHT_POINT)
        return 1;
    V3 to_light =
        light_is_parallel(light) ? v3_neg(light->direction) : v3_unit(v3_sub(location, p));
    return factor_towards(light, location, p, to_light);
}

double light_fade(const Light *light, double distance)
{
    if (!(light->fade_power > 0) || light->fade_distance == 0)
        return 1;
    double x = fabs(distance / light->fade_distance);
    double power = light->fade_power;
    return 2 / (1 + (power == 2 ? x * x : power == 1 ? x : pow(x, power)));
}

LightSample light_at(const Light *light, V3 location, V3 p)
{
    LightSample out;
    V3 d = v3_sub(location, p);
    if (light_is_parallel(light)) {
        out.to_light = v3_neg(light->direction);
        out.distance = v3_dot(d, out.to_light);
    } else {
        out.distance = v3_len(d);
        out.to_light = out.distance > 0 ? v3_scale(d, 1 / out.distance) : d;
    }
    double factor = factor_towards(light, location, p, out.to_light);
    if (factor != 0)
        factor *= light_fade(light, out.distance);
    out.color = rgb_scale(light->color, (float)factor);
    return out;
}
