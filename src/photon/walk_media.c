/* What media do to a photon between two surfaces: where it is stored, and where it is scattered.
 *
 * A photon is stored at a place drawn on its way, whether it is scattered there or not: in thin
 * smoke few are scattered, and all of them light it.  SPDX-License-Identifier: Apache-2.0 */
#include "photon/walk_int.h"

#include "trace/media_along.h"

/* Photons further from the middle of the scene than this many radii light nothing that is seen. */
#define MEDIA_RADII 2

/* The part of a leg within reach of what is seen; the end is before the begin when none is. */
static void leg_part(const WalkRules *rules, const Ray *ray, double length, double *begin,
                     double *end)
{
    V3 to = v3_sub(rules->center, ray->o);
    double along = v3_dot(to, ray->d), radius = MEDIA_RADII * rules->radius;
    double half2 = radius * radius - (v3_len2(to) - along * along);
    double half = half2 > 0 ? sqrt(half2) : 0;
    *begin = fmax(0, along - half);
    *end = half2 > 0 ? fmin(length, along + half) : 0;
}

static bool is_stored_in(const MediaHere *here)
{
    for (int l = 0; l < here->list_count; l++)
        for (int i = 0; i < here->lists[l].count; i++) {
            const Medium *medium = here->lists[l].media[i];
            if (medium->is_collecting && !rgb_is_black(medium->scattering))
                return true;
        }
    return false;
}

/* Draw where the photon collides and whether it goes on from there. */
static void scatter(const MediaHere *here, const MediaProfile *profile, const Ray *ray, Rgb weight,
                    Rng *rng, MediaLeg *out)
{
    const MediaCell *cell;
    Rgb clear, kept;
    if (!media_collide(profile, weight, rng, &out->t, &clear, &cell)) {
        out->weight = clear;
        return;
    }
    out->is_scattered = true;
    out->weight = RGB_BLACK;
    V3 p = ray_at(ray, here->is_homogeneous ? out->t : cell->at);
    const Medium *medium = media_choose(here, p, rgb_mul(weight, clear), medium_kept, rng, &kept);
    if (!medium)
        return;
    Rgb share = rgb_mul(clear, kept);
    double chance = fmin(1, (double)(rgb_max(rgb_mul(weight, share)) / rgb_max(weight)));
    if (!(rng_double(rng) < chance))
        return;
    out->weight = rgb_scale(share, (float)(1 / chance));
    double cosine = phase_sample(medium->phase, (double)medium->eccentricity, rng_double(rng));
    double turn = 2 * PMS_PI * rng_double(rng), sine = sqrt(fmax(0, 1 - cosine * cosine));
    out->d = warp_to_frame(v3(sine * cos(turn), sine * sin(turn), cosine), ray->d);
}

bool media_leg(TraceThread *thread, const WalkRules *rules, const Ray *ray, double length,
               const Interiors *inside, bool may_stop, bool may_scatter, Rgb weight, Rng *rng,
               MediaLeg *out)
{
    MediaHere here;
    media_here(thread->tracer, inside, &here);
    if (here.list_count == 0 || rgb_is_black(weight))
        return false;
    *out = (MediaLeg){.weight = RGB_WHITE};
    double begin, end;
    leg_part(rules, ray, length, &begin, &end);
    if (!(end > begin)) { /* far off: what is lost there is all that matters */
        if (isfinite(length))
            out->weight = media_transmittance(&here, ray, 0, length, 0, rng, &thread->stats);
        return true;
    }
    MediaProfile profile;
    Rgb before = media_transmittance(&here, ray, 0, begin, 0, rng, &thread->stats);
    media_profile(&here, ray, begin, end, end, rng, &thread->stats, &profile);
    if (may_stop && is_stored_in(&here))
        out->has_stop = media_place(&profile, weight, rng_double(rng), &out->stop, &out->power);
    if (may_scatter)
        scatter(&here, &profile, ray, weight, rng, out);
    else
        out->weight = media_clear(profile.depth);
    out->power = rgb_mul(out->power, before);
    out->weight = rgb_mul(out->weight, before);
    if (!out->is_scattered && isfinite(length))
        out->weight = rgb_mul(
            out->weight, media_transmittance(&here, ray, end, length, end, rng, &thread->stats));
    return true;
}
