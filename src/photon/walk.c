/* The way of one photon: from the light over reflections and refractions to where it is stored,
 * with one throw of the dice a surface.  SPDX-License-Identifier: Apache-2.0 */
#include "photon/way_int.h"

/* Surfaces one path may pass: straight ones do not count as levels. */
enum { PATH_SURFACES_MAX = 10000 };

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
        walk_keep_stop(walk, &leg, out, result);
    walk_weaken(walk, leg.weight);
    if (!leg.is_scattered)
        return false;
    walk_weaken(walk, interiors_fade(&walk->inside, leg.t));
    walk->length += leg.t;
    walk_flux(walk);
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
        walk_weaken(walk, interiors_fade(&walk->inside, hit->t));
    return STEP_SURFACE;
}

/* The limits of the language. */
static bool is_over_limit(const Walk *walk)
{
    return walk->level >= walk->rules->max_level || walk->diffuse > walk_most_diffuse(walk) ||
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
    walk_weaken(walk, RGB_BLACK);
    result->end = PATH_ABSORBED;
}

/* Meet a surface where the path ends. */
static void end_on_surface(Walk *walk, const Hit *hit, float least, PhotonList *out,
                           WalkResult *result)
{
    if (walk_keeps(walk, hit))
        walk_keep(walk, hit, least, out, result);
    absorb(walk, result);
}

/* Store what is to be stored and throw the dice; returns false when the path ends here. */
static bool meet_surface(Walk *walk, const Hit *hit, const SurfaceSample *s, float least,
                         PhotonList *out, WalkResult *result)
{
    Roulette roulette;
    roulette_set(walk, s, &roulette);
    if (roulette_is_diffuse(&roulette) && is_beyond_reach(walk, s)) {
        result->end = PATH_CUT;
        return false;
    }
    if (roulette_is_diffuse(&roulette) && walk_keeps(walk, hit))
        walk_keep(walk, hit, least, out, result);
    note_loss(walk, &roulette);
    if (!walk_follow(walk, hit, s, &roulette, roulette_spin(walk, &roulette))) {
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
            walk_pass_through(&walk, &s);
            if (is_over_limit(&walk))
                break;
        } else if (!meet_surface(&walk, &hit, &s, least, out, result)) {
            break;
        }
    }
    arena_reset(thread->scratch);
    walk_settle(&walk, walk_flux(&walk), walk.weight, result);
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
            found = rgb_mul(walk_flux(&walk), walk.weight);
            *at = walk.ray.o;
        }
        if (step != STEP_SURFACE || is_last(&walk, &hit))
            break;
        surface_sample(thread, &walk.ray, &hit, &walk.inside, &s);
        Roulette roulette;
        if (passes_through(&walk, &hit)) {
            walk_pass_through(&walk, &s);
            if (is_over_limit(&walk))
                break;
            continue;
        }
        roulette_set(&walk, &s, &roulette);
        bool is_there = map_is_aimed(rules->map)
                            ? roulette.p_reflect + roulette.p_transmit > 0
                            : roulette_is_diffuse(&roulette) && !is_beyond_reach(&walk, &s);
        if (is_there) {
            found = rgb_mul(walk_flux(&walk), walk.weight);
            *at = s.at.p;
        }
        if (is_there || map_is_aimed(rules->map) || roulette_is_diffuse(&roulette) ||
            !walk_follow(&walk, &hit, &s, &roulette, roulette_spin(&walk, &roulette)) ||
            is_over_limit(&walk))
            break;
    }
    arena_reset(thread->scratch);
    return found;
}
