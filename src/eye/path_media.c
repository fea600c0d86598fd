/* Paths in media.
 *
 * On its way from the eye a path sees what media give off and scatter once just as the eye pass
 * does, by sums along the ray: the language lets the eye see more or less than a medium scatters,
 * as its extinction may be any part of that.  For what is scattered more than once the path turns
 * off at a place drawn from those that show, with a chance that fits how much they show beside what
 * is behind.  From then on light is scattered as its energy is kept: the path collides where the
 * extinction is, takes the light of the lamps there, and goes on by the phase function.
 * SPDX-License-Identifier: Apache-2.0 */
#include "eye/path_int.h"

#include "math/sample.h"

/* Light without pi in it: physics has 4 where the language has 1, see texture/media.h. */
#define SCATTERING_UNIT 4

/* --- light of the lamps where a path was scattered -------------------------------------------- */

/* A point of the light: of an area light any of its grid. */
static V3 some_point(EyeThread *eye, const EyeLight *light, V3 to_light)
{
    const Light *source = light->light;
    if (!light->is_area)
        return source->location;
    AreaFrame frame = area_frame(source, to_light);
    int i = (int)(rng_double(&eye->rng) * source->area.size1);
    int j = (int)(rng_double(&eye->rng) * source->area.size2);
    return v3_add(source->location, area_offset(source, &frame, i, j, &eye->rng));
}

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
    ShapePoint from = {.p = p, .ng = sample.to_light, .ns = sample.to_light};
    Rgb arrived = media_air_shadow(&eye->trace, p, sample.to_light, sample.distance, light->index);
    if (light->has_shadow)
        arrived = rgb_mul(arrived, trace_shadow(&eye->trace, &from, sample.to_light,
                                                sample.distance, light->index, false));
    return rgb_mul(center.color, arrived);
}

static V3 direction_to(const EyeLight *light, V3 p)
{
    return light_at(light->light, light->light->location, p).to_light;
}

/* The light of a lamp that a medium scatters into direction -d, of light that collides. */
static Rgb scattered_at(EyeThread *eye, const EyeLight *light, const Medium *medium, V3 p, V3 d)
{
    V3 to = direction_to(light, p);
    double phase = phase_value(medium->phase, (double)medium->eccentricity, v3_dot(to, d));
    double scale = 1 / (SCATTERING_UNIT * phase_mean(medium->phase));
    return rgb_scale(arriving_light(eye, light, some_point(eye, light, to), p),
                     (float)(phase * scale));
}

/* Light that fades is without limit near the lamp: where paths collide is no measure of it. */
static bool is_fading(const Light *light)
{
    return light->fade_power > 0 && light->fade_distance > 0 && !light->is_parallel &&
           light->kind != LIGHT_CYLINDER;
}

static const MediaCell *cell_at(const MediaProfile *profile, double t)
{
    int i = 0;
    while (i + 1 < profile->count && t >= profile->cells[i].end)
        i++;
    return &profile->cells[i];
}

/* The light of a lamp that media scatter along a ray, from a place drawn evenly by the angle that
 * the ray is seen under from the lamp. */
static Rgb scattered_along(EyeThread *eye, const EyeLight *light, const MediaHere *here,
                           const MediaProfile *profile, const Interiors *inside, const Ray *ray)
{
    V3 point = some_point(eye, light, direction_to(light, ray->o)), to = v3_sub(point, ray->o);
    double nearest = v3_dot(to, ray->d), away = v3_dist(point, ray_at(ray, nearest));
    double end = profile->cells[profile->count - 1].end;
    double low = atan2(-nearest, away), high = atan2(end - nearest, away);
    double angle = low + (high - low) * rng_double(&eye->rng), cosine = cos(angle);
    if (!(away > 0 && high > low && cosine > 0))
        return RGB_BLACK;
    double t = fmin(end, fmax(0, nearest + away * tan(angle)));
    double over_density = (high - low) * away / (cosine * cosine);
    const MediaCell *cell = cell_at(profile, t);
    V3 p = ray_at(ray, t), looked_at = here->is_homogeneous ? p : ray_at(ray, cell->at);
    MediaLobes lobes;
    media_lobes(here, &lobes);
    Rgb scattered = media_scattered(&lobes, looked_at, v3_dot(direction_to(light, p), ray->d));
    if (rgb_is_black(scattered))
        return RGB_BLACK;
    Rgb depth = rgb_mad(cell->depth, (float)(t - cell->begin), cell->point.extinction);
    Rgb seen = rgb_mul(rgb_mul(scattered, media_clear(depth)), interiors_fade(inside, t));
    return rgb_scale(rgb_mul(seen, arriving_light(eye, light, point, p)), (float)over_density);
}

/* --- turning off ------------------------------------------------------------------------------ */

/* Go on from p, scattered by a medium. */
static void turn(EyeThread *eye, Path *path, V3 p, const Medium *medium)
{
    double u = rng_double(&eye->rng), around = 2 * PMS_PI * rng_double(&eye->rng);
    double cosine = phase_sample(medium->phase, (double)medium->eccentricity, u);
    double sine = sqrt(fmax(0, 1 - cosine * cosine));
    V3 local = v3(sine * cos(around), sine * sin(around), cosine);
    path->ray = (Ray){p, warp_to_frame(local, path->ray.d), 0, INFINITY};
    path->kind = RAY_DIFFUSE;
    path->shine = path->weight;
    path->transmit = 0;
    path->turns++;
    path->diffuse++;
    path->length = 0;
    path->is_mirrored = true;
    path->is_shadowed = false;
}

/* What a medium scatters at p as the eye sees it, per scene unit, of light that comes evenly. */
static Rgb shown(const Medium *medium, V3 p)
{
    double scale = SCATTERING_UNIT * phase_mean(medium->phase);
    return rgb_scale(rgb_mul(medium_density(medium, p), medium->scattering), (float)scale);
}

/* Draw one of the media at p by how much it shows of `light`; *weight is that over the chance. */
static const Medium *choose_shown(const MediaHere *here, V3 p, Rgb light, Rng *rng, Rgb *weight)
{
    double all = 0, chance = 0;
    for (int l = 0; l < here->list_count; l++)
        for (int i = 0; i < here->lists[l].count; i++)
            all += (double)rgb_sum(rgb_mul(shown(here->lists[l].media[i], p), light));
    double rest = rng_double(rng) * all;
    const Medium *chosen = NULL;
    for (int l = 0; l < here->list_count && rest >= 0; l++)
        for (int i = 0; i < here->lists[l].count && rest >= 0; i++) {
            const Medium *medium = here->lists[l].media[i];
            double own = (double)rgb_sum(rgb_mul(shown(medium, p), light));
            if (!(own > 0))
                continue;
            chosen = medium;
            chance = own / all;
            rest -= own;
        }
    if (chosen)
        *weight = rgb_scale(shown(chosen, p), (float)(1 / chance));
    return chosen;
}

/* How much of light that comes evenly the media along a profile show. */
static Rgb all_shown(const MediaProfile *profile)
{
    Rgb sum = RGB_BLACK;
    for (int i = 0; i < profile->count; i++) {
        const MediaCell *cell = &profile->cells[i];
        Rgb length = media_glow_length(cell->point.extinction, cell->end - cell->begin);
        Rgb seen = rgb_mul(media_clear(cell->depth), length);
        sum = rgb_add(sum, rgb_mul(seen, cell->point.scattering));
    }
    return rgb_scale(sum, SCATTERING_UNIT);
}

static float amount(Rgb c)
{
    return fabsf(c.r) + fabsf(c.g) + fabsf(c.b);
}

/* Turn a path from the eye off in media, or let it pass. */
static bool show(EyeThread *eye, Path *path, const MediaHere *here, const MediaProfile *profile,
                 const Veil *veil)
{
    float own = amount(rgb_mul(path->weight, rgb_mul(veil->front, all_shown(profile))));
    float rest = amount(rgb_mul(path->weight, veil->through)), chance = own / (own + rest);
    double t;
    Rgb weight, kept;
    if (!(own > 0) || !(rng_float(&eye->rng) < chance)) {
        path_weigh(path, rgb_scale(veil->through, 1 / (1 - (own > 0 ? chance : 0))));
        path->transmit *= rgb_grey(veil->through) / (1 - (own > 0 ? chance : 0));
        return false;
    }
    path_weigh(path, rgb_scale(veil->front, 1 / chance));
    const Medium *medium = NULL;
    if (media_place(profile, rng_double(&eye->rng), &t, &weight)) {
        path_weigh(path, weight);
        medium = choose_shown(here, ray_at(&path->ray, t), path->weight, &eye->rng, &kept);
    }
    if (!medium) { /* nothing scatters there after all */
        path_weigh(path, RGB_BLACK);
        return true;
    }
    path_weigh(path, kept);
    turn(eye, path, ray_at(&path->ray, t), medium);
    return true;
}

/* Add the light of the lamps that fade, scattered anywhere along the ray. */
static void add_fading(EyeThread *eye, const Path *path, const MediaHere *here,
                       const MediaProfile *profile, const Veil *veil, Radiance *out)
{
    Rgb sum = RGB_BLACK;
    for (int i = 0; i < eye->light_count; i++) {
        const EyeLight *light = &eye->lights[i];
        if (light->lights_media && is_fading(light->light))
            sum =
                rgb_add(sum, scattered_along(eye, light, here, profile, &path->inside, &path->ray));
    }
    add_part(out, PART_INDIRECT, rgb_mul(path->weight, veil->front), sum);
}

/* Add the light of the others, where the path collided. */
static void add_collided(EyeThread *eye, const Path *path, const Medium *medium, V3 p,
                         Radiance *out)
{
    Rgb sum = RGB_BLACK;
    for (int i = 0; i < eye->light_count; i++) {
        const EyeLight *light = &eye->lights[i];
        if (light->lights_media && !is_fading(light->light))
            sum = rgb_add(sum, scattered_at(eye, light, medium, p, path->ray.d));
    }
    add_part(out, PART_INDIRECT, path->weight, sum);
}

/* Let a path that was scattered before collide, or pass. */
static bool collide(EyeThread *eye, Path *path, const MediaHere *here, const MediaProfile *profile,
                    const Veil *veil, Radiance *out)
{
    const MediaCell *cell;
    double t;
    Rgb clear, kept = RGB_BLACK, w = path->weight;
    bool has_lights = plan_has(eye->plan, FEATURE_LIGHTS);
    if (has_lights)
        add_fading(eye, path, here, profile, veil, out);
    bool is_met = media_collide(profile, rgb(fabsf(w.r), fabsf(w.g), fabsf(w.b)), &eye->rng, &t,
                                &clear, &cell);
    path_weigh(path, rgb_mul(veil->front, clear));
    if (!is_met) {
        path_weigh(path, veil->back);
        return false;
    }
    V3 p = ray_at(&path->ray, t);
    V3 looked_at = here->is_homogeneous ? p : ray_at(&path->ray, cell->at);
    const Medium *medium = media_choose(here, looked_at, path->weight, &eye->rng, &kept);
    path_weigh(path, rgb_mul(kept, interiors_fade(&path->inside, t)));
    if (!medium)
        return true;
    if (has_lights)
        add_collided(eye, path, medium, p, out);
    turn(eye, path, p, medium);
    return true;
}

bool path_cross_air(EyeThread *eye, Path *path, double length, Radiance *out)
{
    Veil veil;
    MediaHere here;
    bool is_seen = path->diffuse == 0;
    air_along(eye, &path->ray, length, &path->inside, is_seen ? AIR_SEEN : AIR_GLOW, &veil);
    add_part(out, path_part(path), path->weight, veil.light[PART_DIRECT]);
    media_here(eye->trace.tracer, &path->inside, &here);
    here.is_conserving = !is_seen;
    if (!plan_has(eye->plan, FEATURE_MEDIA) || here.list_count == 0) {
        path_weigh(path, veil.through);
        path->transmit *= rgb_grey(veil.through);
        return false;
    }
    MediaProfile profile;
    air_profile(eye, &here, &path->ray, length, &profile);
    return is_seen ? show(eye, path, &here, &profile, &veil)
                   : collide(eye, path, &here, &profile, &veil, out);
}
