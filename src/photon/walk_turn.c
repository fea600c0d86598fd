/* How a photon goes on from a surface, by the branch that the dice chose.
 * SPDX-License-Identifier: Apache-2.0 */
#include "photon/way_int.h"

/* Go on in direction d from a surface. */
static void leave(Walk *walk, const SurfaceSample *s, V3 d, bool is_straight)
{
    walk->ray = trace_ray_from(&s->at, d);
    walk->is_straight = is_straight;
}

void walk_pass_through(Walk *walk, const SurfaceSample *s)
{
    walk_weaken(walk, s->has_transmission ? rgb_not_negative(s->filter) : RGB_BLACK);
    if (s->has_transmission && !s->is_total_reflection)
        interiors_copy(&walk->inside, &s->inside_after);
    leave(walk, s, walk->ray.d, true);
}

/* A direction around +z with density cos/pi: above a point of the unit disk, found by trying, as
 * that is cheaper than sines. */
static V3 cosine_direction(Rng *rng)
{
    for (;;) {
        double x = 2 * rng_double(rng) - 1, y = 2 * rng_double(rng) - 1, r2 = x * x + y * y;
        if (r2 < 1)
            return v3(x, y, sqrt(1 - r2));
    }
}

/* Leave a surface to the side of n with a share of the light. */
static void bounce_diffusely(Walk *walk, const SurfaceSample *s, V3 n, Rgb share)
{
    walk->weight = rgb_scale(rgb_mul(walk->weight, share), walk->rules->brightness);
    walk_flux(walk);
    walk->is_diffuse = true;
    walk->diffuse++;
    if (walk->level < walk->rules->max_level)
        walk->level = 0; /* the limit is for mirrors and glass between; here the dice end it */
    leave(walk, s, warp_to_frame(cosine_direction(walk->rng), n), false);
}

/* Go through a surface with a share of the light. */
static void transmit(Walk *walk, const SurfaceSample *s, Rgb share)
{
    walk->weight = rgb_mul(walk->weight, share);
    if (!s->is_total_reflection)
        interiors_copy(&walk->inside, &s->inside_after);
    leave(walk, s, s->transmit_dir, s->is_straight && !s->is_total_reflection);
    walk->is_specular = true;
}

/* Choose the wavelength that the photon has from here on, stratified over those of a beam. */
static double next_wave(Walk *walk)
{
    return walk->is_scout ? rng_double(walk->rng)
                          : sample_1d((uint32_t)walk->index, walk->beam->wave_key);
}

/* Go through a surface that disperses; returns false when the wavelength chosen does not pass. */
static bool disperse(Walk *walk, const Hit *hit, double p_transmit)
{
    Rgb color;
    SurfaceSample s;
    if (!surface_sample_wave(walk->thread, &walk->ray, hit, &walk->inside, next_wave(walk), &s,
                             &color))
        return false;
    transmit(walk, &s,
             rgb_scale(rgb_mul(color, rgb_not_negative(s.through)), (float)(1 / p_transmit)));
    return true;
}

bool walk_follow(Walk *walk, const Hit *hit, const SurfaceSample *s, const Roulette *r,
                 Branch branch)
{
    switch (branch) {
    case BRANCH_TRANSMIT:
        if (s->spectrum > 0)
            return disperse(walk, hit, r->p_transmit);
        transmit(walk, s, rgb_scale(r->transmit, (float)(1 / r->p_transmit)));
        return true;
    case BRANCH_REFLECT:
        walk->weight = rgb_mul(walk->weight, rgb_scale(r->reflect, (float)(1 / r->p_reflect)));
        leave(walk, s, r->reflect_dir, false);
        walk->is_specular = true;
        return true;
    case BRANCH_DIFFUSE:
        if (map_is_aimed(walk->rules->map))
            return false;
        bounce_diffusely(walk, s, s->ng, rgb_scale(r->diffuse, (float)(1 / r->p_diffuse)));
        return true;
    case BRANCH_BACK:
        if (map_is_aimed(walk->rules->map))
            return false;
        bounce_diffusely(walk, s, v3_neg(s->ng), rgb_scale(r->back, (float)(1 / r->p_back)));
        return true;
    case BRANCH_ABSORB:
        break;
    }
    return false;
}
