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

/* Count a gathering of so many photons. */
static void count_gather(EyeThread *eye, const PhotonMap *map, int photons)
{
    uint64_t *counts = eye->trace.stats.count;
    counts[STAT_GATHERS]++;
    counts[STAT_GATHERED] += (uint64_t)photons;
    if (map == eye->options.caustic)
        counts[STAT_GATHERED_CAUSTIC] += (uint64_t)photons;
    photon_gather_see(map, eye->gather);
}

/* Add a photon, of which a surface sends on a share. */
static void add_photon(LightEstimate *sum, const GatheredPhoton *photon, Rgb share)
{
    Rgb light = rgb_mul(photon->irradiance, share);
    sum->light = rgb_add(sum->light, light);
    sum->blur = rgb_mad(sum->blur, photon->excess, light);
    sum->noise = rgb_add(sum->noise, rgb_mul(light, light)); /* squared until all are there */
}

static Rgb rgb_root(Rgb a)
{
    return rgb(sqrtf(a.r), sqrtf(a.g), sqrtf(a.b));
}

/* The light of a map by finishes for which it matters where light comes from.
 *
 * share  what the surface sends on of a photon. */
static LightEstimate list_gather(EyeThread *eye, const PhotonMap *map, const GatherLimits *limits,
                                 const SurfaceSample *s,
                                 Rgb (*share)(EyeThread *eye, const SurfaceSample *s, V3 from))
{
    const GatheredPhoton *photons;
    LightEstimate sum = {.light = RGB_BLACK};
    GatherLimits own = gather_limits_at(limits, &s->at, s->ng);
    int count = photon_gather_list(map, s->at.p, s->ng, &own, eye->gather, &photons);
    count_gather(eye, map, count);
    for (int i = 0; i < count; i++)
        add_photon(&sum, &photons[i], share(eye, s, photons[i].from));
    sum.noise = limits->has_error ? rgb_root(sum.noise) : RGB_BLACK;
    return sum;
}

static Rgb brilliant_share(EyeThread *eye, const SurfaceSample *s, V3 from)
{
    (void)eye;
    return surface_diffuse_from(s, from);
}

static Rgb directional_share(EyeThread *eye, const SurfaceSample *s, V3 from)
{
    double cosine = fmax(PHOTON_COSINE_MIN, v3_dot(from, s->ng));
    Rgb sent = layers_direct(s, from, plan_has(eye->plan, FEATURE_HIGHLIGHTS));
    return rgb_scale(sent, (float)(1 / cosine));
}

/* Add light of a map on the side of n, of which a surface sends on a part in all directions
 * alike. */
static void add_side(EyeThread *eye, const PhotonMap *map, const GatherLimits *limits,
                     const ShapePoint *at, V3 n, Rgb part, LightEstimate *sum)
{
    if (rgb_is_black(part))
        return;
    LightEstimate estimate;
    GatherLimits own = gather_limits_at(limits, at, n);
    count_gather(eye, map, photon_gather_estimate(map, at->p, n, &own, eye->gather, &estimate));
    light_estimate_add(sum, part, &estimate);
}

/* The light of a map that a surface sends to the viewer: what comes to its front, where it comes
 * from matters if `share` is not NULL, and to its back. */
static LightEstimate map_light(EyeThread *eye, const PhotonMap *map, const GatherLimits *limits,
                               const SurfaceSample *s,
                               Rgb (*share)(EyeThread *eye, const SurfaceSample *s, V3 from))
{
    LightEstimate sum = {.light = RGB_BLACK};
    if (share)
        sum = list_gather(eye, map, limits, s, share);
    else
        add_side(eye, map, limits, &s->at, s->ng, surface_diffuse(s), &sum);
    add_side(eye, map, limits, &s->at, v3_neg(s->ng), surface_diffuse_back(s), &sum);
    return sum;
}

LightEstimate caustic_light(EyeThread *eye, const SurfaceSample *s)
{
    const EyeOptions *options = &eye->options;
    if (!options->caustic || !s->surface->photons.is_collecting ||
        !photon_reach_has(options->caustic_reach, s->at.p))
        return (LightEstimate){.light = RGB_BLACK};
    return map_light(eye, options->caustic, &options->caustic_limits, s,
                     is_directional(s) ? directional_share : NULL);
}

LightEstimate mapped_light(EyeThread *eye, const SurfaceSample *s)
{
    const EyeOptions *options = &eye->options;
    return map_light(eye, options->global, &options->global_limits, s,
                     surface_has_brilliance(s) ? brilliant_share : NULL);
}
