/* The path tracer: all the light of a picture by following paths from the eye, one a sample.
 *
 * It is here to be compared with: it shares scene, rays, surfaces and direct light with the rest
 * of the eye pass, and nothing with the photons.  At each surface the path takes what that gives
 * off and the direct light on it, and goes on in one direction, chosen by how much of the light
 * comes from there; what it finds counts for the inverse of the chance it had.  The mean over
 * paths is then the light itself, but for reflection exponents: they bend what one path sees,
 * and the mean of powers is not the power of the mean.  Media are in path_media.c.
 *
 * Light that comes straight from a light is direct light, by a shadow ray.  Light that comes over
 * mirrors and lenses, where shadow rays are blocked, is found by a path that happens to meet the
 * light; so lights need a size for it (light_meet).  What passes from one medium into another is
 * squeezed by the square of their ior, except between the eye and the first diffuse surface,
 * where the language does not: so the light on a surface under water is what photons bring.
 * SPDX-License-Identifier: Apache-2.0 */
#include "eye/path_int.h"

#include "base/work.h"
#include "math/sample.h"

enum {
    PATH_TURNS_MAX = 10000, /* a guard; few paths come near it */
    ROULETTE_FROM = 4,      /* turns after which a path of little weight may be ended */
    LONG_PATH = 200         /* turns after which any path may be */
};

/* The chance of a long path at each turn: mirrors that lose nothing would keep it for ever. */
#define LONG_CHANCE 0.98f

/* --- what a path finds -------------------------------------------------------------------- */

/* Add the lights met before t that no shadow ray has brought. */
static void add_met_lights(EyeThread *eye, const Path *path, double t, Radiance *out)
{
    if (path->diffuse == 0 || !path->is_shadowed)
        return;
    bool is_caustic = path->diffuse == 1;
    for (int i = 0; i < eye->light_count; i++) {
        LightMeeting met;
        const EyeLight *light = &eye->lights[i];
        if (!light->is_met ||
            !light_meet(light->light, eye->plan->light_radius, &path->ray, t, path->length, &met))
            continue;
        eye->trace.stats.count[STAT_LIGHTS_MET]++;
        Rgb weight = is_caustic ? path->shine : path->weight;
        weight = rgb_mul(weight, interiors_fade(&path->inside, met.t));
        if (eye->has_air)
            weight = rgb_mul(weight, air_clear(eye, &path->ray, met.t, &path->inside));
        add_part(out, is_caustic ? PART_CAUSTIC : PART_INDIRECT, weight, met.radiance);
    }
}

static void add_sky(EyeThread *eye, const Path *path, Radiance *out)
{
    float behind;
    if (path->diffuse > 0 && plan_forbids(eye->plan, FEATURE_SKY_LIGHT))
        return;
    eye->trace.stats.count[STAT_SKY_RAYS]++;
    Rgb sky = sky_light(eye, path->ray.d, path->is_mirrored, &behind);
    add_part(out, path_part(path), path->weight, sky);
    out->transmit = path->transmit * behind;
}

/* Highlights are for the eye: between surfaces they would send on more light than comes. */
static void add_surface(EyeThread *eye, const Path *path, const SurfaceSample *s, Radiance *out)
{
    Rgb light = RGB_BLACK;
    if (path->diffuse == 0 || !plan_forbids(eye->plan, FEATURE_GLOW))
        light = surface_glow(eye->trace.tracer, s);
    if (plan_has(eye->plan, FEATURE_LIGHTS))
        light = rgb_add(light, direct_light(eye, s, path->diffuse == 0));
    add_part(out, path_part(path), path->weight, light);
}

/* --- where it goes on --------------------------------------------------------------------- */

/* How much light comes to the eye from each side, roughly for the diffuse one. */
typedef struct Odds {
    float transmit, diffuse, reflect[SURFACE_LAYERS_MAX], sum;
} Odds;

static void set_odds(const EyeThread *eye, const SurfaceSample *s, Odds *out)
{
    bool is_reflecting = plan_has(eye->plan, FEATURE_REFLECTION);
    *out = (Odds){.transmit = 0};
    if (s->has_transmission && plan_has(eye->plan, FEATURE_REFRACTION))
        out->transmit = s->is_total_reflection ? 3 : rgb_sum_abs(s->filter);
    out->sum = out->transmit;
    for (int i = 0; i < s->layer_count; i++) {
        const SurfaceLayer *layer = &s->layers[i];
        const Finish *finish = layer->finish;
        out->reflect[i] = is_reflecting ? rgb_sum_abs(layer->reflect) : 0;
        float matt = layer->opacity * (fabsf(finish->diffuse) + fabsf(finish->diffuse_back));
        out->diffuse += rgb_sum_abs(rgb_scale(rgb_mul(layer->above, layer->color), matt));
        out->sum += out->reflect[i];
    }
    out->sum += out->diffuse;
}

/* What a choice of probability p makes of the share it is for. */
static void take(Path *path, Rgb share, float p)
{
    path_weigh(path, rgb_scale(share, 1 / p));
}

/* Do shadow rays stop at one of the surfaces that were hit? */
static bool stops_shadow_rays(const EyeThread *eye, const Hit *hit)
{
    bool passes = plan_filters_shadow(eye->plan, hit->surface);
    for (int i = 0; i < hit->tie_count; i++) {
        const Surface *surface = &eye->scene->surfaces[hit->ties[i].crossing.leaf->surface];
        passes = passes && plan_filters_shadow(eye->plan, surface);
    }
    return !passes;
}

static bool go_through(EyeThread *eye, Path *path, const Hit *hit, const SurfaceSample *s, float p)
{
    SurfaceSample wave;
    if (s->spectrum > 0) {
        Rgb color;
        if (!surface_sample_wave(&eye->trace, &path->ray, hit, &path->inside,
                                 sample_1d(eye->path.index, eye->path.wave), &wave, &color))
            return false;
        path_weigh(path, color);
        path->transmit *= rgb_grey(color);
        s = &wave;
    }
    path->ray = trace_ray_from(&s->at, s->transmit_dir);
    if (s->is_total_reflection) {
        take(path, RGB_WHITE, p);
        path->transmit = 0;
        path->is_mirrored = path->is_shadowed = true;
    } else {
        take(path, s->filter, p);
        path->transmit *= rgb_grey(s->filter) / p;
        interiors_copy(&path->inside, &s->inside_after);
        path->is_shadowed = path->is_shadowed || stops_shadow_rays(eye, hit);
        if (path->diffuse > 0)
            path_weigh(path, rgb_gray((float)(s->ior_ratio * s->ior_ratio)));
    }
    if (path->diffuse == 0)
        path->kind = path->is_mirrored ? RAY_REFLECTED : RAY_REFRACTED;
    return true;
}

static void reflect(Path *path, const SurfaceSample *s, const SurfaceLayer *layer, float p,
                    Radiance *out)
{
    path->ray = trace_ray_from(&s->at, layer->reflect_dir);
    take(path, layer->reflect, p);
    path->transmit = 0;
    path->is_mirrored = path->is_shadowed = true;
    if (path->diffuse == 0)
        path->kind = RAY_REFLECTED;
    if (layer->finish->reflection_exponent == 1 || path->root_count == ROOTS_MAX)
        return;
    path->roots[path->root_count++] =
        (Root){*out, path->weight, layer->finish->reflection_exponent};
    *out = (Radiance){.transmit = 0};
    path->weight = path->shine = RGB_WHITE;
}

static bool shows_light_from_behind(const SurfaceSample *s)
{
    bool does = s->surface->is_double_illuminated;
    for (int i = 0; i < s->layer_count; i++)
        does = does || s->layers[i].finish->diffuse_back != 0;
    return does;
}

/* Leave in a direction whose density is its cosine / pi; returns false if no light can come from
 * there. */
static bool bounce(EyeThread *eye, Path *path, const SurfaceSample *s, float p)
{
    V2 u = path->diffuse == 0 ? sample_2d(eye->path.index, eye->path.bounce)
                              : (V2){rng_double(&eye->rng), rng_double(&eye->rng)};
    V3 local = warp_cosine(u), d = warp_to_frame(local, s->layers[0].n);
    double weight = 1 / (local.z * (double)p), side = 1;
    if (shows_light_from_behind(s)) {
        weight *= 2;
        side = rng_double(&eye->rng) < 0.5 ? 1 : -1;
        d = v3_scale(d, side);
    }
    if (!(local.z > 0) || !(side * v3_dot(d, s->ng) > 0))
        return false;
    Rgb matt = rgb_scale(layers_direct(s, d, false), (float)weight), shiny = matt;
    if (path->diffuse == 0 && plan_has(eye->plan, FEATURE_HIGHLIGHTS))
        shiny = rgb_scale(layers_direct(s, d, true), (float)weight);
    path->shine = rgb_mul(path->weight, shiny);
    path->weight = rgb_mul(path->weight, matt);
    path->ray = trace_ray_from(&s->at, d);
    path->kind = RAY_DIFFUSE;
    path->transmit = 0;
    path->diffuse++;
    path->length = 0;
    path->is_mirrored = true;
    path->is_shadowed = false;
    return true;
}

/* The first choice of a pixel's paths is stratified over them. */
static double next_choice(EyeThread *eye, const Path *path)
{
    return path->turns == 1 ? sample_1d(eye->path.index, eye->path.choice) : rng_double(&eye->rng);
}

/* Go on from a surface; returns false if the path ends there. */
static bool leave(EyeThread *eye, Path *path, const Hit *hit, const SurfaceSample *s, Radiance *out)
{
    Odds odds;
    set_odds(eye, s, &odds);
    if (!(odds.sum > 0))
        return false;
    double x = next_choice(eye, path) * (double)odds.sum;
    if (x < (double)odds.transmit)
        return go_through(eye, path, hit, s, odds.transmit / odds.sum);
    x -= (double)odds.transmit;
    for (int i = 0; i < s->layer_count; i++) {
        if (x < (double)odds.reflect[i]) {
            reflect(path, s, &s->layers[i], odds.reflect[i] / odds.sum, out);
            return true;
        }
        x -= (double)odds.reflect[i];
    }
    return odds.diffuse > 0 && bounce(eye, path, s, odds.diffuse / odds.sum);
}

/* End paths of little weight, and endless ones, by a chance that the others make up for. */
static bool survives(EyeThread *eye, Path *path)
{
    float most = fmaxf(rgb_max_abs(path->weight), rgb_max_abs(path->shine));
    float chance = path->turns < ROULETTE_FROM ? 1 : most;
    if (path->turns >= LONG_PATH)
        chance = fminf(chance, LONG_CHANCE);
    if (chance >= 1)
        return most > 0;
    if (!(rng_double(&eye->rng) < (double)chance))
        return false;
    path_weigh(path, rgb_gray(1 / chance));
    return true;
}

/* --- the path ------------------------------------------------------------------------------ */

/* Bend what was seen in reflections with an exponent, the last first. */
static void take_roots(Path *path, Radiance *out)
{
    while (path->root_count > 0) {
        const Root *root = &path->roots[--path->root_count];
        Radiance seen = *out;
        apply_exponent(&seen, root->exponent);
        *out = root->before;
        for (int i = 0; i < PART_COUNT; i++)
            add_part(out, (LightPart)i, root->weight, seen.part[i]);
    }
}

void path_radiance(EyeThread *eye, const Ray *ray, const Interiors *interiors, Radiance *out,
                   EyeSample *first)
{
    Path path = {.ray = *ray,
                 .kind = RAY_CAMERA,
                 .inside = *interiors,
                 .weight = RGB_WHITE,
                 .shine = RGB_WHITE,
                 .transmit = 1};
    *out = (Radiance){.transmit = 0};
    bool goes_on = true;
    while (goes_on && path.turns < PATH_TURNS_MAX && !work_interrupted) {
        Hit hit;
        SurfaceSample s;
        eye->trace.is_dimmed = path.diffuse > 0;
        bool is_hit = trace_closest(&eye->trace, &path.ray, path.kind, &hit);
        double length = is_hit ? hit.t : INFINITY;
        if (is_hit && path.turns == 0) {
            surface_sample(&eye->trace, &path.ray, &hit, &path.inside, &s);
            describe_first(&hit, &s, first);
        }
        add_met_lights(eye, &path, length, out);
        if (eye->has_air && path_cross_air(eye, &path, length, out)) {
            goes_on = survives(eye, &path);
            continue;
        }
        Rgb before = radiance_sum(out);
        if (!is_hit) {
            add_sky(eye, &path, out);
            if (eye->witness)
                witness_tell(eye, &path.ray, path.kind, path.turns, NULL, path.weight,
                             rgb_sub(radiance_sum(out), before));
            break;
        }
        path_weigh(&path, interiors_fade(&path.inside, hit.t));
        path.length += hit.t;
        if (path.turns++ > 0)
            surface_sample(&eye->trace, &path.ray, &hit, &path.inside, &s);
        add_surface(eye, &path, &s, out);
        if (eye->witness)
            witness_tell(eye, &path.ray, path.kind, path.turns - 1, &hit, path.weight,
                         rgb_sub(radiance_sum(out), before));
        goes_on = leave(eye, &path, &hit, &s, out) && survives(eye, &path);
    }
    eye->trace.is_dimmed = false;
    if (goes_on && path.turns == PATH_TURNS_MAX)
        eye->trace.stats.count[STAT_TRACE_LIMIT]++;
    take_roots(&path, out);
}
