/* The way of one photon: from the light over reflections and refractions to where it is stored,
 * with one throw of the dice a surface.  SPDX-License-Identifier: Apache-2.0 */
#include "photon/walk_int.h"

#include "base/mem.h"

/* Surfaces one path may pass: straight ones do not count as levels. */
enum { PATH_SURFACES_MAX = 10000 };

/* A path on its way. */
typedef struct Walk {
    TraceThread *thread;
    const WalkRules *rules;
    const Beam *beam;
    const BeamRay *start;
    Ray ray;
    Interiors inside;
    double length;      /* gone in all up to the last surface */
    Rgb weight;         /* share of the light that is left */
    Rgb lost;           /* share that was absorbed, until the path is settled */
    bool is_settled;    /* the books know what became of it: it came to a place to be stored at */
    Rgb flux;           /* of a weight of 1 at flux_length; fixed at the first diffuse surface */
    double flux_length; /* negative: not known yet */
    int level;
    bool is_aimed;    /* has met its target, or needs none */
    bool is_specular; /* was reflected or refracted */
    bool is_diffuse;  /* was reflected diffusely */
    int diffuse;      /* how often */
    bool is_straight; /* the last surface did not bend it */
    bool has_chosen;  /* thrown the dice before */
    bool is_scout;
    uint64_t index; /* of the photon */
    Rng *rng;
} Walk;

typedef enum Branch {
    BRANCH_ABSORB,
    BRANCH_DIFFUSE,
    BRANCH_BACK, /* diffusely to the other side */
    BRANCH_REFLECT,
    BRANCH_TRANSMIT
} Branch;

/* What a surface does with light, each channel, and how likely each branch is. */
typedef struct Roulette {
    Rgb diffuse, back, reflect, transmit;
    double p_diffuse, p_back, p_reflect, p_transmit;
    V3 reflect_dir;
} Roulette;

static Rgb not_negative(Rgb c)
{
    return rgb(fmaxf(c.r, 0), fmaxf(c.g, 0), fmaxf(c.b, 0));
}

static Rgb flux_here(Walk *walk)
{
    if (!walk->is_diffuse && walk->flux_length != walk->length) {
        walk->flux = beam_flux(walk->beam, walk->start, walk->length);
        walk->flux_length = walk->length;
    }
    return walk->flux;
}

/* Multiply the weight by what a surface or a way lets go on of it. */
static void weaken(Walk *walk, Rgb share)
{
    Rgb rest = rgb_mul(walk->weight, share);
    walk->lost = rgb_add(walk->lost, rgb_sub(walk->weight, rest));
    walk->weight = rest;
}

/* Close the books on the path: it began with a flux of `emitted` and has this share of it left. */
static void settle(Walk *walk, Rgb emitted, Rgb share, WalkResult *result)
{
    if (walk->is_settled)
        return;
    walk->is_settled = true;
    result->emitted = emitted;
    result->left = rgb_mul(emitted, share);
    result->balance = rgb_add(walk->lost, share);
}

/* --- the roulette ----------------------------------------------------------------------- */

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

static void set_roulette(const Walk *walk, const SurfaceSample *s, Roulette *out)
{
    *out = (Roulette){.diffuse = not_negative(surface_diffuse_from(s, s->wo)),
                      .back = not_negative(surface_diffuse_back(s))};
    if (s->has_transmission && may_refract(walk, s->surface))
        out->transmit = s->is_total_reflection ? RGB_WHITE : not_negative(s->filter);
    if (may_reflect(walk, s->surface))
        for (int i = 0; i < s->layer_count; i++) {
            Rgb reflect = not_negative(s->layers[i].reflect);
            if (rgb_is_black(reflect))
                continue;
            if (rgb_is_black(out->reflect))
                out->reflect_dir = s->layers[i].reflect_dir;
            out->reflect = rgb_add(out->reflect, reflect);
        }
    set_odds(out);
}

/* Is some light scattered diffusely, to either side? */
static bool is_diffuse(const Roulette *r)
{
    return !rgb_is_black(r->diffuse) || !rgb_is_black(r->back);
}

/* The first choice of the photons of a beam is stratified over them. */
static double next_choice(Walk *walk)
{
    if (walk->has_chosen)
        return rng_double(walk->rng);
    walk->has_chosen = true;
    return sample_1d((uint32_t)walk->index, walk->beam->choice_key);
}

static Branch spin(Walk *walk, const Roulette *r)
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

/* --- storing ---------------------------------------------------------------------------- */

static bool make_room(PhotonList *list)
{
    void *items = list->items;
    if (mem_grow(&items, list->count, &list->capacity, sizeof *list->items) != 0)
        list->is_short = true;
    list->items = items;
    return list->count < list->capacity;
}

/* Return how many times its power a photon is to have: of little power 0 but for the chance that
 * makes up for more. */
static float thin_out(Walk *walk, Rgb power, float least)
{
    float most = rgb_max(power);
    if (!(most > 0) || !rgb_is_finite(power))
        return 0;
    if (most >= least)
        return 1;
    return rng_float(walk->rng) * least < most ? least / most : 0;
}

static bool store(Walk *walk, V3 p, V3 from, unsigned flags, Rgb power, PhotonList *out)
{
    if (!(rgb_max(power) > 0) || !rgb_is_finite(power) || !make_room(out))
        return false;
    V3 at = v3_sub(p, walk->rules->center);
    Photon *photon = &out->items[out->count++];
    *photon = (Photon){.pos = {(float)at.x, (float)at.y, (float)at.z}, .flags = (uint16_t)flags};
    rgbe_encode(power, walk->rng, photon->rgbe);
    direction_encode(from, &photon->phi, &photon->theta);
    return true;
}

static const Surface *tied_surface(const Walk *walk, const HitTie *tie)
{
    return &tracer_scene(walk->thread->tracer)->surfaces[tie->crossing.leaf->surface];
}

/* Clear glass that collects nothing does not keep the table it stands on from it. */
static bool is_collecting(const Walk *walk, const Hit *hit)
{
    bool is = hit->surface->photons.is_collecting;
    for (int i = 0; i < hit->tie_count; i++)
        is = is || tied_surface(walk, &hit->ties[i])->photons.is_collecting;
    return is;
}

/* Light that a surface gives off has one reflection less to go: the eye sees it directly, light
 * of a light source by its first reflection. */
static int most_diffuse(const Walk *walk)
{
    return walk->rules->max_diffuse - (walk->beam->light == NULL);
}

/* Is a photon kept where a surface scatters diffusely? */
static bool is_kept(const Walk *walk, const Hit *hit)
{
    if (walk->rules->map == MAP_GLOBAL)
        return (walk->is_diffuse || walk->rules->keeps_first || !walk->beam->light) &&
               walk->diffuse <= most_diffuse(walk);
    return walk->rules->map == MAP_CAUSTIC && walk->is_specular && is_collecting(walk, hit);
}

/* Keep the photon where it hits a surface. */
static void keep(Walk *walk, const Hit *hit, float least, PhotonList *out, WalkResult *result)
{
    Rgb flux = flux_here(walk), power = rgb_mul(flux, walk->weight);
    V3 n = hit->point.ng;
    n = v3_dot(n, walk->ray.d) > 0 ? v3_neg(n) : n;
    unsigned flags = (unsigned)normal14_encode(n) << 2;
    if (shape_point_is_inside(&hit->point, n))
        flags |= PHOTON_INSIDE;
    float times = thin_out(walk, power, least);
    settle(walk, flux, rgb_scale(walk->weight, times), result);
    result->stored +=
        store(walk, hit->point.p, v3_neg(walk->ray.d), flags, rgb_scale(power, times), out);
}

/* --- the way ---------------------------------------------------------------------------- */

static void begin(Walk *walk, TraceThread *thread, const WalkRules *rules, const Beam *beam,
                  const BeamRay *start, Rng *rng)
{
    walk->thread = thread;
    walk->rules = rules;
    walk->beam = beam;
    walk->start = start;
    walk->ray = start->ray;
    if (beam->light)
        interiors_copy(&walk->inside, &rules->inside[beam->source]);
    else
        interiors_at(thread->tracer, walk->ray.o, &walk->inside);
    walk->length = 0;
    walk->weight = RGB_WHITE;
    walk->lost = walk->flux = RGB_BLACK;
    walk->flux_length = -1;
    walk->level = walk->diffuse = 0;
    walk->is_aimed = beam->target == NULL;
    walk->is_settled = walk->is_specular = walk->is_diffuse = walk->is_straight = false;
    walk->has_chosen = walk->is_scout = false;
    walk->index = 0;
    walk->rng = rng;
}

/* Go on in direction d from a surface. */
static void leave(Walk *walk, const SurfaceSample *s, V3 d, bool is_straight)
{
    walk->ray = trace_ray_from(&s->at, d);
    walk->is_straight = is_straight;
}

/* Pass an object that photons do not see, straight on. */
static void pass_through(Walk *walk, const SurfaceSample *s)
{
    weaken(walk, s->has_transmission ? not_negative(s->filter) : RGB_BLACK);
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
    flux_here(walk);
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
    transmit(walk, &s, rgb_scale(rgb_mul(color, not_negative(s.through)), (float)(1 / p_transmit)));
    return true;
}

/* Follow the branch the dice chose; returns false when the path ends here. */
static bool follow(Walk *walk, const Hit *hit, const SurfaceSample *s, const Roulette *r,
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

/* Is the beam's target what was hit first?  Of targets in one place, the one written first is. */
static bool is_target(const Walk *walk, const Hit *hit)
{
    const Beam *beam = walk->beam;
    const Scene *scene = tracer_scene(walk->thread->tracer);
    const Object *object = hit->object;
    for (int i = 0; i < hit->tie_count && !object->is_target; i++)
        object = &scene->objects[hit->ties[i].object];
    return object == beam->target &&
           (isinf(beam->reach) || v3_dist(hit->point.p, beam->center) <= beam->reach);
}

static Rgb flux_at(Walk *walk, double length)
{
    return walk->is_diffuse ? walk->flux : beam_flux(walk->beam, walk->start, length);
}

/* Store a photon at the stop of a leg: its power is what passes there, times the length of way it
 * stands for. */
static void store_stop(Walk *walk, const MediaLeg *leg, PhotonList *out, WalkResult *result)
{
    unsigned flags = walk->rules->map == MAP_FOCUS ? PHOTON_FOCUSED : 0;
    Rgb flux = flux_at(walk, walk->length + leg->stop), power = rgb_mul(flux, leg->power);
    Rgb weight = rgb_mul(walk->weight, interiors_fade(&walk->inside, leg->stop));
    V3 p = ray_at(&walk->ray, leg->stop), from = v3_neg(walk->ray.d);
    settle(walk, flux, walk->weight, result);
    result->stored += store(walk, p, from, flags, rgb_mul(power, weight), out);
}

/* Cross the media up to the next surface; returns true when the photon was scattered on the way.
 * out is NULL when nothing is to be stored. */
static bool cross_media(Walk *walk, double length, PhotonList *out, WalkResult *result)
{
    MapKind map = walk->rules->map;
    bool is_kept_there =
        map == MAP_FOCUS ? walk->is_specular : walk->is_diffuse || !walk->beam->light;
    bool may_stop = out && is_kept_there && (map == MAP_FOCUS || map == MAP_VOLUME);
    MediaLeg leg;
    if (!media_leg(walk->thread, walk->rules, &walk->ray, length, &walk->inside, may_stop,
                   !map_is_aimed(map), walk->weight, walk->rng, &leg))
        return false;
    if (leg.has_stop)
        store_stop(walk, &leg, out, result);
    weaken(walk, leg.weight);
    if (!leg.is_scattered)
        return false;
    weaken(walk, interiors_fade(&walk->inside, leg.t));
    walk->length += leg.t;
    flux_here(walk);
    walk->is_diffuse = true;
    walk->is_straight = false;
    walk->is_aimed = true;
    if (walk->level < walk->rules->max_level)
        walk->level = 0;
    walk->ray = (Ray){ray_at(&walk->ray, leg.t), leg.d, 0, INFINITY};
    return true;
}

typedef enum Step { STEP_END, STEP_SURFACE, STEP_SCATTERED } Step;

/* Go to the next surface, or to where a medium scatters the photon.  `end` is set to the end of the
 * path when there is none to go on from. */
static Step advance(Walk *walk, Hit *hit, PhotonList *out, WalkResult *result)
{
    RayKind kind = map_is_aimed(walk->rules->map) ? RAY_PHOTON : RAY_LIGHT;
    bool is_hit = trace_closest(walk->thread, &walk->ray, kind, hit);
    if (walk->rules->has_media && cross_media(walk, is_hit ? hit->t : INFINITY, out, result)) {
        result->end = rgb_is_black(walk->weight) ? PATH_ABSORBED : PATH_CUT;
        return STEP_SCATTERED;
    }
    if (!is_hit) {
        result->end = PATH_ESCAPED;
        return STEP_END;
    }
    walk->length += hit->t;
    const PhotonFlags *flags = &hit->surface->photons;
    if (!walk->is_aimed && !flags->is_pass_through) {
        walk->is_aimed = is_target(walk, hit);
        if (!walk->is_aimed) { /* something is in the way; if a target, it has its own beam */
            result->end = PATH_CUT;
            return STEP_END;
        }
    }
    if (!walk->is_straight)
        walk->level++;
    if (walk->inside.count > 0)
        weaken(walk, interiors_fade(&walk->inside, hit->t));
    return STEP_SURFACE;
}

/* The limits of the language. */
static bool is_over_limit(const Walk *walk)
{
    return walk->level >= walk->rules->max_level || walk->diffuse > most_diffuse(walk) ||
           !(rgb_max(walk->weight) >= walk->rules->adc_bailout);
}

/* What no branch sends on is absorbed, whatever the dice say. */
static void note_loss(Walk *walk, const Roulette *r)
{
    Rgb on = rgb_add(r->reflect, r->transmit);
    if (!map_is_aimed(walk->rules->map))
        on = rgb_mad(on, walk->rules->brightness, rgb_add(r->diffuse, r->back));
    Rgb off = rgb(1 - on.r, 1 - on.g, 1 - on.b);
    walk->lost = rgb_add(walk->lost, rgb_mul(walk->weight, off));
}

static bool is_beyond_reach(const Walk *walk, const SurfaceSample *s)
{
    return !map_is_aimed(walk->rules->map) && !walk->is_diffuse &&
           v3_dist(s->at.p, walk->rules->center) > walk->rules->reach;
}

static bool passes_through(const Walk *walk, const Hit *hit)
{
    return hit->surface->photons.is_pass_through && map_is_aimed(walk->rules->map);
}

/* Does the path end here, whatever the surface looks like? */
static bool is_last(const Walk *walk, const Hit *hit)
{
    return map_is_aimed(walk->rules->map) && hit->surface->is_matt && hit->tie_count == 0 &&
           !hit->surface->photons.is_pass_through;
}

/* Absorb what is left. */
static void absorb(Walk *walk, WalkResult *result)
{
    weaken(walk, RGB_BLACK);
    result->end = PATH_ABSORBED;
}

/* Meet a surface where the path ends. */
static void end_on_surface(Walk *walk, const Hit *hit, float least, PhotonList *out,
                           WalkResult *result)
{
    if (is_kept(walk, hit))
        keep(walk, hit, least, out, result);
    absorb(walk, result);
}

/* Store what is to be stored and throw the dice; returns false when the path ends here. */
static bool meet_surface(Walk *walk, const Hit *hit, const SurfaceSample *s, float least,
                         PhotonList *out, WalkResult *result)
{
    Roulette roulette;
    set_roulette(walk, s, &roulette);
    if (is_diffuse(&roulette) && is_beyond_reach(walk, s)) {
        result->end = PATH_CUT;
        return false;
    }
    if (is_diffuse(&roulette) && is_kept(walk, hit))
        keep(walk, hit, least, out, result);
    note_loss(walk, &roulette);
    if (!follow(walk, hit, s, &roulette, spin(walk, &roulette))) {
        walk->weight = RGB_BLACK;
        result->end = PATH_ABSORBED;
        return false;
    }
    result->end = PATH_CUT;
    return !is_over_limit(walk);
}

void photon_walk(TraceThread *thread, const WalkRules *rules, const Beam *beam,
                 const BeamRay *start, uint64_t index, float least, Rng *rng, PhotonList *out,
                 WalkResult *result)
{
    Walk walk;
    begin(&walk, thread, rules, beam, start, rng);
    walk.index = index;
    *result = (WalkResult){.end = PATH_CUT};
    for (int surfaces = 0; surfaces < PATH_SURFACES_MAX; surfaces++) {
        Hit hit;
        SurfaceSample s;
        Step step = advance(&walk, &hit, out, result);
        if (step == STEP_END || (step == STEP_SCATTERED && is_over_limit(&walk)))
            break;
        if (step == STEP_SCATTERED)
            continue;
        if (is_last(&walk, &hit)) {
            end_on_surface(&walk, &hit, least, out, result);
            break;
        }
        surface_sample(thread, &walk.ray, &hit, &walk.inside, &s);
        if (passes_through(&walk, &hit)) {
            pass_through(&walk, &s);
            if (is_over_limit(&walk))
                break;
        } else if (!meet_surface(&walk, &hit, &s, least, out, result)) {
            break;
        }
    }
    arena_reset(thread->scratch);
    settle(&walk, flux_here(&walk), walk.weight, result);
    if (result->stored > 0)
        result->end = PATH_STORED;
}

Rgb photon_scout(TraceThread *thread, const WalkRules *rules, const Beam *beam,
                 const BeamRay *start, Rng *rng, V3 *at)
{
    Walk walk;
    begin(&walk, thread, rules, beam, start, rng);
    walk.has_chosen = walk.is_scout = true;
    Rgb found = RGB_BLACK;
    WalkResult none;
    for (int surfaces = 0; surfaces < PATH_SURFACES_MAX; surfaces++) {
        Hit hit;
        SurfaceSample s;
        Step step = advance(&walk, &hit, NULL, &none);
        if (step == STEP_SCATTERED) {
            found = rgb_mul(flux_here(&walk), walk.weight);
            *at = walk.ray.o;
        }
        if (step != STEP_SURFACE || is_last(&walk, &hit))
            break;
        surface_sample(thread, &walk.ray, &hit, &walk.inside, &s);
        Roulette roulette;
        if (passes_through(&walk, &hit)) {
            pass_through(&walk, &s);
            if (is_over_limit(&walk))
                break;
            continue;
        }
        set_roulette(&walk, &s, &roulette);
        bool is_there = map_is_aimed(rules->map)
                            ? roulette.p_reflect + roulette.p_transmit > 0
                            : is_diffuse(&roulette) && !is_beyond_reach(&walk, &s);
        if (is_there) {
            found = rgb_mul(flux_here(&walk), walk.weight);
            *at = s.at.p;
        }
        if (is_there || map_is_aimed(rules->map) || is_diffuse(&roulette) ||
            !follow(&walk, &hit, &s, &roulette, spin(&walk, &roulette)) || is_over_limit(&walk))
            break;
    }
    arena_reset(thread->scratch);
    return found;
}
