/* Light that reaches a surface: from the light sources, and from the photon maps.
 * SPDX-License-Identifier: Apache-2.0 */
#include "eye/air_int.h"

Rgb layers_direct(const SurfaceSample *s, V3 to_light, bool has_highlights)
{
    Rgb sum = RGB_BLACK;
    for (int i = 0; i < s->layer_count; i++)
        sum = rgb_add(sum, layer_direct(&s->layers[i], s, to_light, has_highlights,
                                        s->surface->is_double_illuminated));
    return sum;
}

/* Direct light averaged over the grid of an area light, each point shining from its own place;
 * without shadows. */
static Rgb area_illumination(EyeThread *eye, const EyeLight *light, const SurfaceSample *s,
                             const LightSample *center, bool has_highlights)
{
    const Light *source = light->light;
    AreaFrame frame = area_frame(source, center->to_light);
    Rgb sum = RGB_BLACK;
    for (int j = 0; j < source->area.size2; j++)
        for (int i = 0; i < source->area.size1; i++) {
            V3 offset = area_offset(source, &frame, i, j, &eye->rng);
            LightSample at = light_at(source, v3_add(source->location, offset), s->at.p);
            if (rgb_is_black(at.color))
                continue;
            Rgb sent = layers_direct(s, at.to_light, has_highlights);
            sum = rgb_add(sum, rgb_mul(sent, at.color));
        }
    return rgb_scale(sum, 1.0f / (float)(source->area.size1 * source->area.size2));
}

static Rgb light_shadow(EyeThread *eye, const EyeLight *light, const SurfaceSample *s,
                        const LightSample *sample)
{
    if (!light->has_shadow)
        return RGB_WHITE;
    if (light->is_area)
        return area_shadow(eye, light, s, sample);
    bool blocks_targets = light->makes_caustics && s->surface->photons.is_collecting;
    return trace_shadow(&eye->trace, &s->at, sample->to_light, sample->distance, light->index,
                        blocks_targets);
}

static Rgb light_from(EyeThread *eye, const EyeLight *light, const SurfaceSample *s,
                      bool has_highlights)
{
    has_highlights = has_highlights && light->has_highlights;
    eye->trace.stats.count[STAT_LIT]++;
    LightSample sample = light_at(light->light, light->light->location, s->at.p);
    Rgb sent;
    if (light->is_area && light->light->area.has_illumination) {
        sent = area_illumination(eye, light, s, &sample, has_highlights);
    } else {
        if (rgb_is_black(sample.color))
            return RGB_BLACK;
        sent = rgb_mul(layers_direct(s, sample.to_light, has_highlights), sample.color);
    }
    if (rgb_is_black(sent))
        return RGB_BLACK;
    if (eye->has_air)
        sent = rgb_mul(sent, media_air_shadow(&eye->trace, s->at.p, sample.to_light,
                                              sample.distance, light->index));
    return rgb_mul(sent, light_shadow(eye, light, s, &sample));
}

Rgb direct_light(EyeThread *eye, const SurfaceSample *s, bool has_highlights)
{
    Rgb sum = RGB_BLACK;
    for (int i = 0; i < eye->light_count; i++)
        sum = rgb_add(sum, light_from(eye, &eye->lights[i], s, has_highlights));
    return sum;
}

/* Does it matter where light comes from, beyond its cosine? */
static bool is_directional(const SurfaceSample *s)
{
    for (int i = 0; i < s->layer_count; i++)
        if (s->layers[i].finish->phong != 0 || s->layers[i].finish->specular != 0)
            return true;
    return surface_has_brilliance(s);
}

static void note_gather(EyeThread *eye, const PhotonMap *map, int count)
{
    uint64_t *counts = eye->trace.stats.count;
    counts[STAT_GATHERS]++;
    counts[STAT_GATHERED] += (uint64_t)count;
    if (map == eye->options.caustic)
        counts[STAT_GATHERED_CAUSTIC] += (uint64_t)count;
}

/* The light of a map by finishes whose brilliance weighs where it comes from. */
static Rgb brilliant_gather(EyeThread *eye, const PhotonMap *map, const GatherLimits *limits,
                            const SurfaceSample *s)
{
    const GatheredPhoton *photons;
    GatherLimits own = gather_limits_at(limits, &s->at, s->ng);
    int count = photon_gather_list(map, s->at.p, s->ng, &own, eye->gather, &photons);
    note_gather(eye, map, count);
    Rgb sum = RGB_BLACK;
    for (int i = 0; i < count; i++) {
        Rgb reflectance = surface_diffuse_from(s, photons[i].from);
        sum = rgb_add(sum, rgb_mul(photons[i].irradiance, reflectance));
    }
    return sum;
}

static Rgb directional_caustic(EyeThread *eye, const SurfaceSample *s)
{
    const GatheredPhoton *photons;
    const EyeOptions *options = &eye->options;
    GatherLimits limits = gather_limits_at(&options->caustic_limits, &s->at, s->ng);
    int count =
        photon_gather_list(options->caustic, s->at.p, s->ng, &limits, eye->gather, &photons);
    note_gather(eye, options->caustic, count);
    Rgb sum = RGB_BLACK;
    for (int i = 0; i < count; i++) {
        double cosine = fmax(PHOTON_COSINE_MIN, v3_dot(photons[i].from, s->ng));
        Rgb sent = layers_direct(s, photons[i].from, plan_has(eye->plan, FEATURE_HIGHLIGHTS));
        sum = rgb_mad(sum, (float)(1 / cosine), rgb_mul(photons[i].irradiance, sent));
    }
    return sum;
}

/* Light of a map on the side of n, of which a surface sends on a part in all directions alike. */
static Rgb side_gather(EyeThread *eye, const PhotonMap *map, const GatherLimits *limits,
                       const ShapePoint *at, V3 n, Rgb part)
{
    if (rgb_is_black(part))
        return RGB_BLACK;
    Rgb irradiance;
    GatherLimits own = gather_limits_at(limits, at, n);
    int count = photon_gather(map, at->p, n, &own, eye->gather, &irradiance);
    note_gather(eye, map, count);
    return rgb_mul(irradiance, part);
}

static Rgb diffuse_gather(EyeThread *eye, const PhotonMap *map, const GatherLimits *limits,
                          const SurfaceSample *s)
{
    return side_gather(eye, map, limits, &s->at, s->ng, surface_diffuse(s));
}

static Rgb back_gather(EyeThread *eye, const PhotonMap *map, const GatherLimits *limits,
                       const SurfaceSample *s)
{
    return side_gather(eye, map, limits, &s->at, v3_neg(s->ng), surface_diffuse_back(s));
}

Rgb caustic_light(EyeThread *eye, const SurfaceSample *s)
{
    const EyeOptions *options = &eye->options;
    if (!options->caustic || !s->surface->photons.is_collecting ||
        !photon_reach_has(options->caustic_reach, s->at.p))
        return RGB_BLACK;
    const GatherLimits *limits = &options->caustic_limits;
    Rgb behind = back_gather(eye, options->caustic, limits, s);
    if (!is_directional(s))
        return rgb_add(behind, diffuse_gather(eye, options->caustic, limits, s));
    return rgb_add(behind, directional_caustic(eye, s));
}

Rgb mapped_light(EyeThread *eye, const SurfaceSample *s)
{
    const EyeOptions *options = &eye->options;
    const GatherLimits *limits = &options->global_limits;
    Rgb behind = back_gather(eye, options->global, limits, s);
    if (surface_has_brilliance(s))
        return rgb_add(behind, brilliant_gather(eye, options->global, limits, s));
    return rgb_add(behind, diffuse_gather(eye, options->global, limits, s));
}
