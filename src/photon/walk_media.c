/* What media do to a photon between two surfaces: where it is stored, and where it is scattered.
 *
 * A photon is stored at a place drawn on its way, whether it is scattered there or not: in thin
 * smoke few are scattered, and all of them light it.  SPDX-License-Identifier: Apache-2.0 */
#include "photon/walk_int.h"

#include "trace/media_along.h"

/* Of photons scattered far away, at most this part is aimed at what is near. */
#define AIMED_MOST 0.5

/* Scattered so many mean free ways off, one in about so many photons is aimed. */
#define AIMED_FALL 3

/* Of places far from what is seen, where the light is smooth, one in so many is stored. */
#define FAR_STOPS 4

/* Where the parts of a leg end: far from what is seen, near it, and far again. */
static void leg_ends(const WalkRules *rules, const Ray *ray, double length, double ends[LEG_PARTS])
{
    V3 to = v3_sub(rules->center, ray->o);
    double along = v3_dot(to, ray->d), radius = NEAR_RADII * rules->radius;
    double half2 = radius * radius - (v3_len2(to) - along * along);
    double half = half2 > 0 ? sqrt(half2) : 0;
    ends[1] = half2 > 0 ? fmin(length, fmax(0, along + half)) : 0;
    ends[0] = fmin(ends[1], fmax(0, along - half));
    ends[2] = length;
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

/* Return the part of the photons scattered at a distance from what is near, in mean free ways, that
 * is aimed at it: as what comes there at once, of all that ever will. */
static double part_aimed(double ways)
{
    double at_once = exp(-ways);
    return AIMED_MOST * at_once / (at_once + AIMED_MOST * AIMED_FALL * ways);
}

/* Draw where a medium sends a photon from p.  From far away, next to none would come to what is
 * near: some are aimed at it; *boost makes up for that. */
static V3 turn(const WalkRules *rules, V3 p, V3 d, const Medium *medium, double extinction,
               Rng *rng, double *boost)
{
    double e = (double)medium->eccentricity, radius = NEAR_RADII * rules->radius;
    V3 to = v3_sub(rules->center, p);
    double distance = v3_len(to), rim = ball_rim(radius, distance);
    bool is_far = distance > radius;
    double aimed = is_far ? part_aimed(extinction * (distance - radius)) : 0;
    double choice = is_far ? rng_double(rng) : 1;
    V2 u = {rng_double(rng), 0};
    u.v = rng_double(rng);
    V3 axis = is_far ? v3_scale(to, 1 / distance) : d, out;
    if (choice < aimed) {
        out = warp_to_frame(cone_direction(u, rim), axis);
    } else {
        double cosine = phase_sample(medium->phase, e, u.u);
        double around = 2 * PMS_PI * u.v, sine = sqrt(fmax(0, 1 - cosine * cosine));
        out = warp_to_frame(v3(sine * cos(around), sine * sin(around), cosine), d);
    }
    *boost = 1;
    if (is_far) {
        double phase = phase_value(medium->phase, e, v3_dot(d, out)) / phase_mean(medium->phase);
        bool comes = choice < aimed || meets_ball(to, out, radius);
        *boost = phase / ((1 - aimed) * phase + (comes ? aimed * 2 / rim : 0));
    }
    return out;
}

/* Draw where in a part of the leg the photon collides and whether it goes on from there. */
static void scatter(const WalkRules *rules, const MediaHere *here, const MediaProfile *profile,
                    const Ray *ray, Rgb weight, Rng *rng, MediaLeg *out)
{
    const MediaCell *cell;
    Rgb clear, kept;
    if (!media_collide(profile, weight, rng, &out->t, &clear, &cell)) {
        out->weight = rgb_mul(out->weight, clear);
        return;
    }
    Rgb before = out->weight;
    out->is_scattered = true;
    out->weight = RGB_BLACK;
    V3 at = ray_at(ray, out->t), p = here->is_homogeneous ? at : ray_at(ray, cell->at);
    const Medium *medium = media_choose(here, p, rgb_mul(weight, clear), medium_kept, rng, &kept);
    if (!medium)
        return;
    Rgb share = rgb_mul(clear, kept);
    double chance = fmin(1, (double)(rgb_max(rgb_mul(weight, share)) / rgb_max(weight)));
    if (!(rng_double(rng) < chance))
        return;
    out->weight = rgb_mul(before, rgb_scale(share, (float)(1 / chance)));
    out->is_far = v3_dist(at, rules->center) > NEAR_RADII * rules->radius;
    out->d =
        turn(rules, at, ray->d, medium, (double)rgb_grey(cell->point.extinction), rng, &out->boost);
}

/* Draw where in a part of the leg the photon is stored: in parts that are far by chance, and the
 * less the less gets there. */
static void stop(const MediaProfile *profile, Rgb weight, Rgb passed, bool is_near, Rng *rng,
                 MediaLeg *out)
{
    MediaStop *stop = &out->stops[out->stop_count];
    float chance = is_near ? 1 : fminf(1, rgb_max(passed)) / FAR_STOPS;
    if (chance < 1 && !(rng_float(rng) < chance))
        return;
    if (!media_place(profile, weight, rng_double(rng), &stop->t, &stop->power))
        return;
    stop->power = rgb_mul(stop->power, rgb_scale(passed, 1 / chance));
    out->stop_count++;
}

bool media_leg(TraceThread *thread, const WalkRules *rules, const Ray *ray, double length,
               const Interiors *inside, bool may_stop, bool may_scatter, Rgb weight, Rng *rng,
               MediaLeg *out)
{
    MediaHere here;
    media_here(thread->tracer, inside, &here);
    if (here.list_count == 0 || rgb_is_black(weight))
        return false;
    *out = (MediaLeg){.weight = RGB_WHITE, .boost = 1};
    if (!isfinite(length))
        length = tracer_scene(thread->tracer)->atmosphere.media_end;
    double ends[LEG_PARTS], begin = 0;
    leg_ends(rules, ray, length, ends);
    may_stop = may_stop && is_stored_in(&here);
    Rgb passed = RGB_WHITE;
    for (int i = 0; i < LEG_PARTS && (may_stop || !out->is_scattered); begin = ends[i++]) {
        if (!(ends[i] > begin))
            continue;
        MediaProfile profile;
        media_profile(&here, ray, begin, ends[i], i == 2 ? begin + rules->radius : ends[i], rng,
                      &thread->stats, &profile);
        if (may_stop)
            stop(&profile, weight, passed, i == 1, rng, out);
        if (may_scatter && !out->is_scattered)
            scatter(rules, &here, &profile, ray, rgb_mul(weight, out->weight), rng, out);
        passed = rgb_mul(passed, media_clear(profile.depth));
    }
    if (!may_scatter)
        out->weight = passed;
    return true;
}
