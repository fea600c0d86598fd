/* Shading: what a ray brings back, with the language's finish arithmetic.
 *
 * The ray that goes on through a surface is followed in a loop, since what it brings back is
 * only multiplied by what it passed; reflections recurse, since a reflection exponent bends
 * their sum.  SPDX-License-Identifier: Apache-2.0 */
#include "eye/air_int.h"

#include "base/work.h"
#include "math/sample.h"
#include "math/spectrum.h"

/* Surfaces one path may pass: straight ones do not count as trace levels, so a stack of
 * perfectly clear sheets would have no end but this. */
enum { PATH_SURFACES_MAX = 10000 };

/* A ray on its way, and what became of it so far. */
typedef struct Path {
    Ray ray;
    const Object *from; /* whose surface it comes from; NULL: none */
    V3 from_normal;     /* unit, of that surface */
    RayKind kind;
    int level;        /* rays traced up to here that count */
    float weight;     /* the largest share of the picture it can still have */
    bool is_straight; /* the ray goes on from a surface that did not bend it */
    bool is_mirrored; /* seen in a reflection */
    Interiors inside;
    Rgb through;    /* share of what comes along the ray that counts */
    float transmit; /* the same for the picture behind everything */
} Path;

static void radiance(EyeThread *eye, Path *path, Radiance *out, EyeSample *first);

void add_part(Radiance *out, LightPart part, Rgb through, Rgb light)
{
    out->part[part] = rgb_add(out->part[part], rgb_mul(through, light));
}

void add_estimate(Radiance *out, LightPart part, Rgb through, const LightEstimate *estimate)
{
    add_part(out, part, through, estimate->light);
    add_part(out, PART_BLUR, through, estimate->blur);
    add_part(out, PART_NOISE, through, estimate->noise);
}

static float channel_power(float sum, float power)
{
    return sum > 0 ? powf(sum, power) / sum : 0;
}

void apply_exponent(Radiance *light, float exponent)
{
    Rgb sum = radiance_sum(light);
    float power = 1 / exponent;
    Rgb factor =
        rgb(channel_power(sum.r, power), channel_power(sum.g, power), channel_power(sum.b, power));
    for (int i = 0; i < PART_COUNT; i++)
        light->part[i] = rgb_mul(light->part[i], factor);
}

static float reflection_weight(const SurfaceLayer *layer)
{
    const Finish *finish = layer->finish;
    if (finish->is_fresnel)
        return rgb_max(layer->reflect);
    return fmaxf(rgb_max(finish->reflection_min), rgb_max(finish->reflection_max));
}

/* May a ray of this weight be traced?  Rays that go straight on need a level too.  None may once
 * the render is interrupted: what mirrors a sample stands between can make it as good as endless.
 */
static bool may_trace(EyeThread *eye, int level, float weight)
{
    const SceneSettings *settings = &eye->scene->settings;
    if (!((double)weight >= settings->adc_bailout) || work_interrupted)
        return false;
    return !stat_rare(&eye->trace.stats, STAT_TRACE_LIMIT, level >= settings->max_trace_level);
}

static void reflect_layer(EyeThread *eye, const Path *path, const SurfaceSample *s,
                          const SurfaceLayer *layer, Radiance *out)
{
    float weight = path->weight * reflection_weight(layer);
    if (!may_trace(eye, path->level, weight))
        return;
    Path mirrored;
    mirrored.ray = trace_ray_from(&s->at, layer->reflect_dir);
    mirrored.from = path->from;
    mirrored.from_normal = s->ng;
    mirrored.kind = RAY_REFLECTED;
    mirrored.level = path->level;
    mirrored.weight = weight;
    mirrored.is_straight = false;
    mirrored.is_mirrored = true;
    interiors_copy(&mirrored.inside, &path->inside);
    mirrored.through = RGB_WHITE;
    mirrored.transmit = 1;
    Radiance seen;
    radiance(eye, &mirrored, &seen, NULL);
    if (layer->finish->reflection_exponent != 1)
        apply_exponent(&seen, layer->finish->reflection_exponent);
    Rgb share = rgb_mul(path->through, layer->reflect);
    for (int i = 0; i < PART_COUNT; i++)
        add_part(out, (LightPart)i, share, seen.part[i]);
}

/* Mirrors show the whole of what they see: the layers above do not filter it. */
static void add_reflections(EyeThread *eye, const Path *path, const SurfaceSample *s, Radiance *out)
{
    for (int i = 0; i < s->layer_count; i++)
        if (!rgb_is_black(s->layers[i].reflect))
            reflect_layer(eye, path, s, &s->layers[i], out);
}

/* Turn the path into the ray that goes on through the surface; false: none does. */
static bool go_on(EyeThread *eye, Path *path, const SurfaceSample *s)
{
    if (s->is_total_reflection) {
        path->transmit = 0;
        path->is_mirrored = true;
        path->kind = RAY_REFLECTED;
    } else {
        path->transmit *= rgb_grey(s->filter);
        path->weight *= rgb_max_abs(s->filter);
        path->kind = path->is_mirrored ? RAY_REFLECTED : RAY_REFRACTED;
        interiors_copy(&path->inside, &s->inside_after);
    }
    path->through = rgb_mul(path->through, s->through);
    if (!may_trace(eye, path->level, path->weight))
        return false;
    path->is_straight = s->is_straight && !s->is_total_reflection;
    path->ray = trace_ray_from(&s->at, s->transmit_dir);
    path->from_normal = s->ng;
    return true;
}

void describe_first(const Hit *hit, const SurfaceSample *s, EyeSample *first)
{
    Rgb albedo = RGB_BLACK;
    for (int i = 0; i < s->layer_count; i++) {
        const SurfaceLayer *layer = &s->layers[i];
        albedo = rgb_mad(albedo, layer->opacity, rgb_mul(layer->above, layer->color));
    }
    first->depth = hit->t;
    first->normal = s->layers[0].n;
    first->albedo = albedo;
}

static void add_indirect(EyeThread *eye, const Path *path, const SurfaceSample *s, Radiance *out)
{
    LightEstimate estimate = {.light = RGB_BLACK};
    if (plan_has(eye->plan, FEATURE_FINAL_GATHER))
        estimate = gathered_light(eye, s, &path->inside, path->weight);
    else if (eye->options.global)
        estimate = mapped_light(eye, s);
    add_estimate(out, PART_INDIRECT, path->through, &estimate);
}

static void add_surface(EyeThread *eye, const Path *path, const Hit *hit, const SurfaceSample *s,
                        Radiance *out)
{
    Rgb before = radiance_sum(out);
    if (!eye->fresh) {
        Rgb direct = surface_glow(eye->trace.tracer, s);
        if (plan_has(eye->plan, FEATURE_LIGHTS))
            direct = rgb_add(direct, direct_light(eye, s, true));
        add_part(out, PART_DIRECT, path->through, direct);
        if (eye->options.caustic) {
            LightEstimate caustic = caustic_light(eye, s);
            add_estimate(out, PART_CAUSTIC, path->through, &caustic);
        }
    }
    if (plan_has(eye->plan, FEATURE_GLOBAL_MAP))
        add_indirect(eye, path, s, out);
    if (eye->witness)
        witness_tell(eye, &path->ray, path->kind, path->level, hit, path->through,
                     rgb_sub(radiance_sum(out), before));
    if (plan_has(eye->plan, FEATURE_REFLECTION))
        add_reflections(eye, path, s, out);
}

/* What the path sees through from here on lies behind the air along its ray.
 *
 * hit  what the ray meets; NULL: nothing. */
static void add_air(EyeThread *eye, Path *path, const Hit *hit, Radiance *out)
{
    Veil veil;
    AirEnds ends = {.planes.begin = path->from_normal, .from = path->from};
    if (hit)
        ends.planes.end = hit->point.ng;
    air_between(eye, &path->ray, hit ? hit->t : INFINITY, &ends, &path->inside, AIR_SEEN, &veil);
    for (int i = 0; i < PART_COUNT; i++)
        add_part(out, (LightPart)i, path->through, veil.light[i]);
    path->through = rgb_mul(path->through, veil.through);
    path->transmit *= rgb_grey(veil.through);
    path->weight *= rgb_max(veil.through);
}

/* Follow the bands of light that a surface disperses, each on its own.  In one of many passes they
 * are moved along the spectrum, so that the mean has no bands. */
static void split(EyeThread *eye, const Path *path, const Hit *hit, int bands, Radiance *out)
{
    bool is_moved = eye->options.is_progressive;
    double shift = is_moved ? sample_1d(eye->path.index, eye->path.wave) : 0;
    for (int i = 0; i < bands + is_moved; i++) {
        SpectrumBand band =
            is_moved ? spectrum_band_moved(i, bands, shift) : spectrum_band(i, bands);
        SurfaceSample s;
        Path part = *path;
        part.inside.wavelength = (float)band.wavelength;
        part.through = rgb_mul(path->through, band.color);
        part.transmit = path->transmit * rgb_grey(band.color);
        surface_sample(&eye->trace, &path->ray, hit, &part.inside, &s);
        if (!s.has_transmission || !go_on(eye, &part, &s))
            continue;
        Radiance seen;
        radiance(eye, &part, &seen, NULL);
        for (int k = 0; k < PART_COUNT; k++)
            out->part[k] = rgb_add(out->part[k], seen.part[k]);
        out->transmit += seen.transmit;
    }
}

/* Follow one path; the caller has made sure that it may be traced. */
static void radiance(EyeThread *eye, Path *path, Radiance *out, EyeSample *first)
{
    SurfaceSample s;
    *out = (Radiance){.transmit = 0};
    for (int surfaces = 0; surfaces < PATH_SURFACES_MAX; surfaces++) {
        Hit hit;
        bool is_met = trace_closest(&eye->trace, &path->ray, path->kind, &hit);
        eye->trace.stats.count[STAT_BAND_RAYS] +=
            path->kind == RAY_REFRACTED && path->inside.wavelength > 0;
        if (eye->has_air)
            add_air(eye, path, is_met ? &hit : NULL, out);
        if (!is_met) {
            float behind;
            eye->trace.stats.count[STAT_SKY_RAYS]++;
            Rgb sky = sky_light(eye, path->ray.d, path->is_mirrored, &behind);
            add_part(out, PART_DIRECT, path->through, sky);
            if (eye->witness)
                witness_tell(eye, &path->ray, path->kind, path->level, NULL, path->through,
                             rgb_mul(path->through, sky));
            out->transmit = path->transmit * behind;
            return;
        }
        if (rgb_is_black(path->through))
            return; /* nothing shows through the air */
        if (!path->is_straight)
            path->level++;
        path->through = rgb_mul(path->through, interiors_fade(&path->inside, hit.t));
        surface_sample(&eye->trace, &path->ray, &hit, &path->inside, &s);
        path->from = hit.object;
        if (first && surfaces == 0)
            describe_first(&hit, &s, first);
        add_surface(eye, path, &hit, &s, out);
        bool is_followed = s.has_transmission && plan_has(eye->plan, FEATURE_REFRACTION);
        if (is_followed && s.spectrum > 0) {
            split(eye, path, &hit, s.spectrum, out);
            return;
        }
        if (!is_followed || !go_on(eye, path, &s))
            return;
    }
    eye->trace.stats.count[STAT_TRACE_LIMIT]++;
}

void camera_radiance(EyeThread *eye, const Ray *ray, const Interiors *interiors, Radiance *out,
                     EyeSample *first)
{
    Path path;
    path.ray = *ray;
    path.from = NULL;
    path.from_normal = v3(0, 0, 0);
    path.kind = RAY_CAMERA;
    path.level = 0;
    path.weight = 1;
    path.is_straight = path.is_mirrored = false;
    interiors_copy(&path.inside, interiors);
    path.through = RGB_WHITE;
    path.transmit = 1;
    radiance(eye, &path, out, first);
}
