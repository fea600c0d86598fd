/* Russian roulette at a surface: one throw of the dice picks what the photon does, with odds in
 * proportion to the light that each branch sends on.  SPDX-License-Identifier: Apache-2.0 */
#include "photon/way_int.h"

/* May photons of this light be reflected (refracted) here?  What photons{} says is about
 * caustics; indirect light goes wherever light can. */
static bool may_reflect(const Walk *walk, const Surface *surface)
{
    return !map_is_aimed(walk->rules->map) || plan_photons_reflect(walk->beam->light, surface);
}

static bool may_refract(const Walk *walk, const Surface *surface)
{
    return !map_is_aimed(walk->rules->map) || plan_photons_refract(walk->beam->light, surface);
}

/* The probabilities of the branches: that of going on at all is the largest channel of
 * all that is sent on, and it is shared in proportion to what each branch sends. */
static void set_odds(Roulette *r)
{
    Rgb all = rgb_add(rgb_add(r->diffuse, r->back), rgb_add(r->reflect, r->transmit));
    double sum = (double)rgb_sum(all), most = fmin(1, (double)rgb_max(all));
    double scale = sum > 0 ? most / sum : 0;
    r->p_diffuse = scale * (double)rgb_sum(r->diffuse);
    r->p_back = scale * (double)rgb_sum(r->back);
    r->p_reflect = scale * (double)rgb_sum(r->reflect);
    r->p_transmit = scale * (double)rgb_sum(r->transmit);
}

void roulette_set(const Walk *walk, const SurfaceSample *s, Roulette *out)
{
    *out = (Roulette){.diffuse = rgb_not_negative(surface_diffuse_from(s, s->wo)),
                      .back = rgb_not_negative(surface_diffuse_back(s))};
    if (s->has_transmission && may_refract(walk, s->surface))
        out->transmit = s->is_total_reflection ? RGB_WHITE : rgb_not_negative(s->filter);
    if (may_reflect(walk, s->surface))
        for (int i = 0; i < s->layer_count; i++) {
            Rgb reflect = rgb_not_negative(s->layers[i].reflect);
            if (rgb_is_black(reflect))
                continue;
            if (rgb_is_black(out->reflect))
                out->reflect_dir = s->layers[i].reflect_dir;
            out->reflect = rgb_add(out->reflect, reflect);
        }
    set_odds(out);
}

/* The first choice of the photons of a beam is stratified over them. */
static double next_choice(Walk *walk)
{
    if (walk->has_chosen)
        return rng_double(walk->rng);
    walk->has_chosen = true;
    return sample_1d((uint32_t)walk->index, walk->beam->choice_key);
}

Branch roulette_spin(Walk *walk, const Roulette *r)
{
    if (r->p_transmit >= 1) /* a surface that leaves no choice, not to the dice either */
        return BRANCH_TRANSMIT;
    double x = next_choice(walk);
    if (x < r->p_transmit)
        return BRANCH_TRANSMIT;
    x -= r->p_transmit;
    if (x < r->p_reflect)
        return BRANCH_REFLECT;
    x -= r->p_reflect;
    if (x < r->p_diffuse)
        return BRANCH_DIFFUSE;
    x -= r->p_diffuse;
    return x < r->p_back ? BRANCH_BACK : BRANCH_ABSORB;
}
