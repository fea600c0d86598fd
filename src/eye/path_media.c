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

/* Turn a path from the eye off in media, or let it pass. */
static bool show(EyeThread *eye, Path *path, const MediaHere *here, const MediaProfile *profile,
                 const Veil *veil)
{
    float own = rgb_sum_abs(rgb_mul(path->weight, rgb_mul(veil->front, all_shown(profile))));
    float rest = rgb_sum_abs(rgb_mul(path->weight, veil->through)), chance = own / (own + rest);
    double t;
    Rgb weight, kept;
    if (!(own > 0) || !(rng_float(&eye->rng) < chance)) {
        path_weigh(path, rgb_scale(veil->through, 1 / (1 - (own > 0 ? chance : 0))));
        path->transmit *= rgb_grey(veil->through) / (1 - (own > 0 ? chance : 0));
        return false;
    }
    path_weigh(path, rgb_scale(veil->front, 1 / chance));
    const Medium *medium = NULL;
    if (media_place(profile, rgb_abs(path->weight), rng_double(&eye->rng), &t, &weight)) {
        path_weigh(path, weight);
        medium = media_choose(here, ray_at(&path->ray, t), path->weight, shown, &eye->rng, &kept);
    }
    if (!medium) { /* nothing scatters there after all */
        path_weigh(path, RGB_BLACK);
        return true;
    }
    path_weigh(path, kept);
    turn(eye, path, ray_at(&path->ray, t), medium);
    return true;
}

/* Add the light of the lamps that media scatter anywhere along the ray. */
static void add_lamps(EyeThread *eye, const Path *path, const MediaHere *here,
                      const MediaProfile *profile, const Veil *veil, Radiance *out)
{
    Rgb sum = RGB_BLACK;
    MediaLobes lobes;
    media_lobes(here, &lobes);
    for (int i = 0; i < eye->light_count; i++)
        if (eye->lights[i].lights_media)
            sum = rgb_add(sum, media_scatter_some(eye, &eye->lights[i], &lobes, profile,
                                                  &path->inside, &path->ray));
    add_part(out, PART_INDIRECT, rgb_mul(path->weight, veil->front), sum);
}

/* Let a path that was scattered before collide, or pass. */
static bool collide(EyeThread *eye, Path *path, const MediaHere *here, const MediaProfile *profile,
                    const Veil *veil, Radiance *out)
{
    const MediaCell *cell;
    double t;
    Rgb clear, kept = RGB_BLACK;
    if (plan_has(eye->plan, FEATURE_LIGHTS))
        add_lamps(eye, path, here, profile, veil, out);
    bool is_met = media_collide(profile, rgb_abs(path->weight), &eye->rng, &t, &clear, &cell);
    path_weigh(path, rgb_mul(veil->front, clear));
    if (!is_met) {
        path_weigh(path, veil->back);
        return false;
    }
    V3 p = ray_at(&path->ray, t);
    V3 looked_at = here->is_homogeneous ? p : ray_at(&path->ray, cell->at);
    const Medium *medium =
        media_choose(here, looked_at, path->weight, medium_kept, &eye->rng, &kept);
    path_weigh(path, rgb_mul(kept, interiors_fade(&path->inside, t)));
    if (!medium)
        return true;
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
