/* What lies between the eye and what it sees.
 *
 * The language's order, from what is seen to the eye: rainbows, media, fog.  All of them are
 * outside solids that are not hollow.  SPDX-License-Identifier: Apache-2.0 */
#include "eye/air_int.h"

/* Gather rays are many: each looks for photons in one of so many parts of its way. */
enum { RAY_PARTS = 16 };

/* --- fog ---------------------------------------------------------------------------------- */

/* Lay a layer over what is seen: `clear` is what passes it, `color` its own light. */
static void add_layer(Veil *veil, Rgb clear, Rgb color)
{
    veil->light[PART_DIRECT] = rgb_add(veil->light[PART_DIRECT], rgb_mul(veil->through, color));
    veil->through = rgb_mul(veil->through, clear);
}

/* Several fogs: what passes multiplies, each adds its own colour as if it were alone. */
static void add_fogs(const Scene *scene, const Ray *ray, double length, Veil *veil)
{
    V3 end = isfinite(length) ? ray_at(ray, length) : ray->d;
    Rgb all = RGB_WHITE, light = RGB_BLACK;
    for (int i = 0; i < scene->atmosphere.fog_count; i++) {
        const Fog *fog = scene->atmosphere.fogs[i];
        if (!(fog->distance > 0))
            continue;
        double clear = fog_clearness(fog, ray->o, end, length);
        float passed = (float)fmax(clear, (double)fog->color.transmit);
        Rgb color = color5_rgb(fog->color);
        light = rgb_mad(light, 1 - passed, color);
        all = rgb_mul(all, rgb_scale(rgb_lerp(RGB_WHITE, color, fog->color.filter), passed));
    }
    add_layer(veil, all, light);
}

/* --- rainbows ----------------------------------------------------------------------------- */

static double smoothstep(double x)
{
    return x * x * (3 - 2 * x);
}

/* How far the arc has faded where a ray looks: 0 not at all, 1 away. */
static double arc_fade(const Rainbow *bow, V3 d)
{
    double across = v3_dot(d, bow->right), up = v3_dot(d, bow->up);
    double length = hypot(across, up);
    double phi = length > 0 ? acos(fmin(1, fmax(-1, up / length))) : 0;
    if (phi > bow->arc)
        return 1;
    if (phi <= bow->falloff)
        return 0;
    return smoothstep((phi - bow->falloff) / (bow->arc - bow->falloff));
}

/* Where a ray cuts the bow, 0 to 1 from rim to rim; negative: nowhere. */
static double bow_place(const Rainbow *bow, V3 d, Rng *rng)
{
    double cosine = v3_dot(d, bow->toward);
    if (!(cosine >= 0 && bow->width > 0))
        return -1;
    double place = (acos(fmin(1, cosine)) - (bow->angle - bow->width / 2)) / bow->width;
    if (bow->jitter > 0)
        place += (2 * rng_double(rng) - 1) * bow->jitter;
    return place < 1 ? place : -1;
}

static Color5 map_at(const Rainbow *bow, double place)
{
    const Pigment colors = {.map = bow->map, .map_count = bow->map_count};
    return pigment_map_color(&colors, place);
}

/* Several rainbows: their average. */
static void add_rainbows(EyeThread *eye, const Ray *ray, double length, Veil *veil)
{
    const Atmosphere *air = &eye->scene->atmosphere;
    Rgb clear = RGB_BLACK, light = RGB_BLACK;
    int count = 0;
    for (int i = 0; i < air->rainbow_count; i++) {
        const Rainbow *bow = air->rainbows[i];
        double place = bow_place(bow, ray->d, &eye->rng);
        if (!bow->map || !(place >= 0))
            continue;
        double fade = arc_fade(bow, ray->d);
        Color5 c = map_at(bow, place);
        double k = exp(-length / bow->distance);
        k = fmax(k, fade * (1 - (double)c.transmit) + (double)c.transmit);
        float filter = c.filter * (float)(1 - k);
        Rgb tint = rgb_lerp(RGB_WHITE, color5_rgb(c), filter);
        clear = rgb_mad(clear, (float)k, tint);
        light = rgb_mad(light, (float)(1 - k), color5_rgb(c));
        count++;
    }
    if (count > 0) {
        veil->back = rgb_scale(clear, 1.0f / (float)count);
        add_layer(veil, veil->back, rgb_scale(light, 1.0f / (float)count));
    }
}

/* --- media -------------------------------------------------------------------------------- */

/* Emission of the cells, each dimmed by those before it. */
static Rgb glow(const MediaProfile *profile)
{
    Rgb sum = RGB_BLACK;
    for (int i = 0; i < profile->count; i++) {
        const MediaCell *cell = &profile->cells[i];
        if (rgb_is_black(cell->point.emission))
            continue;
        Rgb length = media_glow_length(cell->point.extinction, cell->end - cell->begin);
        Rgb seen = rgb_mul(media_clear(cell->depth), length);
        sum = rgb_add(sum, rgb_mul(cell->point.emission, seen));
    }
    return sum;
}

/* Where the part of the scene that has objects ends along a ray. */
static double scene_end(const Tracer *tracer, const Ray *ray)
{
    Bound bound = tracer_bound(tracer);
    double radius = bound_radius(bound);
    double along = v3_dot(v3_sub(bound_center(bound), ray->o), ray->d);
    return fmax(along, 0) + 2 * radius;
}

Rgb air_shadow(EyeThread *eye, const EyeLight *light, V3 p, const LightSample *sample,
               bool blocks_targets)
{
    if (!light->has_shadow)
        return RGB_WHITE;
    uint64_t *counts = eye->trace.stats.count, before = counts[STAT_SHADOW_RAYS];
    ShapePoint from = {.p = p, .ng = sample->to_light, .ns = sample->to_light};
    Rgb passed = trace_shadow(&eye->trace, &from, sample->to_light, sample->distance, light->index,
                              blocks_targets);
    counts[STAT_MEDIA_SHADOW_RAYS] += counts[STAT_SHADOW_RAYS] - before;
    return passed;
}

void air_profile(EyeThread *eye, const MediaHere *here, const Ray *ray, double length,
                 MediaProfile *out)
{
    double end = isfinite(length) ? length : eye->scene->atmosphere.media_end;
    media_profile(here, ray, 0, end, scene_end(eye->trace.tracer, ray), &eye->rng,
                  &eye->trace.stats, out);
}

/* The light of one of the lamps, for all of them. */
static Rgb some_lamp(EyeThread *eye, const MediaHere *here, const MediaProfile *profile,
                     const Interiors *inside, const Ray *ray)
{
    int count = 0;
    for (int i = 0; i < eye->light_count; i++)
        count += eye->lights[i].lights_media;
    if (count == 0)
        return RGB_BLACK;
    int chosen = (int)(rng_double(&eye->rng) * count), i = 0;
    while (!eye->lights[i].lights_media || chosen-- > 0)
        i++;
    MediaLobes lobes;
    media_lobes(here, &lobes);
    Rgb light = media_scatter_some(eye, &eye->lights[i], &lobes, profile, inside, ray);
    return rgb_scale(light, (float)count);
}

const MediaCell *air_cell_at(const MediaProfile *profile, double t)
{
    int low = 0, high = profile->count - 1;
    while (low < high) {
        int middle = (low + high) / 2;
        if (profile->cells[middle].end <= t)
            low = middle + 1;
        else
            high = middle;
    }
    return &profile->cells[low];
}

/* The photons of a part of a ray drawn at random, for all of it. */
static void some_photons(EyeThread *eye, const MediaHere *here, const MediaProfile *profile,
                         const Ray *ray, Rgb light[PART_COUNT])
{
    Rgb found[PART_COUNT] = {RGB_BLACK};
    double end = profile->cells[profile->count - 1].end;
    end = fmin(end, scene_end(eye->trace.tracer, ray));
    int part = (int)(rng_double(&eye->rng) * RAY_PARTS);
    const AirEnds none = {.from = NULL};
    media_photons(eye, here, profile, ray, end * part / RAY_PARTS, end * (part + 1) / RAY_PARTS,
                  &none, found);
    for (int i = 0; i < PART_COUNT; i++)
        light[i] = rgb_scale(found[i], RAY_PARTS);
}

static void add_media(EyeThread *eye, const MediaHere *here, const Ray *ray, double length,
                      const AirEnds *ends, const Interiors *inside, AirLight wanted, Veil *veil)
{
    MediaProfile profile;
    air_profile(eye, here, ray, length, &profile);
    Rgb light = glow(&profile);
    if (wanted == AIR_SEEN && plan_has(eye->plan, FEATURE_LIGHTS))
        media_scatter(eye, here, &profile, ray, &light);
    if (wanted == AIR_GATHERED && plan_has(eye->plan, FEATURE_LIGHTS))
        light = rgb_add(light, some_lamp(eye, here, &profile, inside, ray));
    if (wanted != AIR_GLOW && eye->options.volume) {
        Rgb found[PART_COUNT] = {RGB_BLACK};
        double end = profile.cells[profile.count - 1].end;
        if (wanted == AIR_SEEN)
            media_photons(eye, here, &profile, ray, 0, end, ends, found);
        else
            some_photons(eye, here, &profile, ray, found);
        for (int i = 0; i < PART_COUNT; i++)
            veil->light[i] = rgb_add(veil->light[i], rgb_mul(veil->through, found[i]));
    }
    add_layer(veil, media_clear(profile.depth), light);
}

void air_between(EyeThread *eye, const Ray *ray, double length, const AirEnds *ends,
                 const Interiors *inside, AirLight wanted, Veil *out)
{
    MediaHere here;
    *out = (Veil){.through = RGB_WHITE, .front = RGB_WHITE, .back = RGB_WHITE};
    media_here(eye->trace.tracer, inside, &here);
    here.is_conserving = wanted != AIR_SEEN;
    if (!here.is_open)
        return;
    eye->trace.stats.count[STAT_FOG_RAYS] += plan_has(eye->plan, FEATURE_FOG);
    if (plan_has(eye->plan, FEATURE_FOG))
        add_fogs(eye->scene, ray, length, out);
    out->front = out->through;
    if (plan_has(eye->plan, FEATURE_MEDIA) && here.list_count > 0)
        add_media(eye, &here, ray, length, ends, inside, wanted, out);
    eye->trace.stats.count[STAT_RAINBOW_RAYS] += plan_has(eye->plan, FEATURE_RAINBOW);
    if (plan_has(eye->plan, FEATURE_RAINBOW))
        add_rainbows(eye, ray, length, out);
}

void air_along(EyeThread *eye, const Ray *ray, double length, const Interiors *inside,
               AirLight wanted, Veil *out)
{
    const AirEnds none = {.from = NULL};
    air_between(eye, ray, length, &none, inside, wanted, out);
}

Rgb air_clear(EyeThread *eye, const Ray *ray, double length, const Interiors *inside)
{
    MediaHere here;
    media_here(eye->trace.tracer, inside, &here);
    return media_transmittance(&here, ray, 0, length, scene_end(eye->trace.tracer, ray), &eye->rng,
                               &eye->trace.stats);
}
