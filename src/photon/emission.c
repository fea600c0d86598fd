/* Aiming beams and sharing photons.
 *
 * Each light has a beam for each target (for the global map, one for the whole scene).  The flux
 * a pilot finds in them is what lights and targets share the budget by, so that photons are
 * alike in power.
 * SPDX-License-Identifier: Apache-2.0 */
#include "photon/emission_int.h"

#include "base/mem.h"
#include "base/work.h"

#include <limits.h>
#include <stdio.h>

/* Random numbers, by map: of photons, and of the keys of their points. */
enum { PASS_PHOTON = 0x700, PASS_KEYS = 0x720 };

/* Most photons that may be asked for. */
#define SPACED_PHOTONS_MAX 1e8

/* In a scene with endless objects, first diffuse hits of photons for the global map further from
 * the middle than this many radii of its bounded part are cut: an endless plane lit by a light
 * without falloff gives off endless flux, of which less than a hundredth would come back.
 * Parallel light is sent to a smaller part, for it has no centre its photons thin out from. */
#define REACH_RADII 20
#define REACH_RADII_PARALLEL 4

/* --- beams ------------------------------------------------------------------------------ */

static bool takes_part(const Emission *emission, int light)
{
    const Scene *scene = tracer_scene(emission->tracer);
    if (map_is_aimed(emission->rules.map))
        return tracer_plan(emission->tracer)->light_makes_caustics[light];
    return !rgb_is_black(scene->lights[light].color) && scene->lights[light].photon_share > 0;
}

static bool add_beam(Emission *emission, size_t *capacity, const Beam *beam)
{
    if (!beam_can_shine(beam))
        return true;
    void *beams = emission->beams;
    bool is_done =
        mem_grow(&beams, (size_t)emission->beam_count, capacity, sizeof *emission->beams) == 0;
    emission->beams = beams;
    if (is_done)
        emission->beams[emission->beam_count++] = *beam;
    return is_done;
}

/* Return the first target surface of an object; NULL: it has none. */
static const Surface *target_surface(const Scene *scene, uint32_t object)
{
    for (uint32_t i = 0; i < scene->surface_count; i++)
        if (scene->surfaces[i].object == object && scene->surfaces[i].is_target)
            return &scene->surfaces[i];
    return NULL;
}

/* Photons for a target without bounds are sent at what lies within this many radii of the bounded
 * part of the scene and the camera. */
#define ENDLESS_TARGET_RADII 2

static void aim_at_endless(Beam *beam, const Emission *emission)
{
    const Scene *scene = tracer_scene(emission->tracer);
    Bound part = bound_add(tracer_bound(emission->tracer), scene->camera.location);
    beam->center = bound_center(part);
    beam->reach = beam->radius = bound_radius(part) * ENDLESS_TARGET_RADII;
}

/* Set what the target's photons{} says of the beam.  `stores` is how many photons the language
 * expects to be stored for two that are sent (measured with POV-Ray: targets that collect
 * store photons themselves, those that reflect and refract split them). */
static void set_target(Beam *beam, const Emission *emission, uint32_t object)
{
    const Scene *scene = tracer_scene(emission->tracer);
    const Surface *surface = target_surface(scene, object);
    beam->target = &scene->objects[object];
    beam->center = bound_center(beam->target->bound);
    beam->radius = bound_radius(beam->target->bound);
    if (!bound_is_finite(beam->target->bound))
        aim_at_endless(beam, emission);
    else
        beam->reach = INFINITY;
    beam->spacing_factor = beam->stores = 1;
    if (!surface)
        return;
    if (surface->photons.spacing_factor > 0)
        beam->spacing_factor = (double)surface->photons.spacing_factor;
    bool refracts = plan_photons_refract(beam->light, surface);
    bool is_both = refracts && plan_photons_reflect(beam->light, surface);
    if (refracts && surface->photons.is_collecting)
        beam->stores = is_both ? 3 : 2;
    beam->stores *= is_both ? 1.5 : 1;
}

static bool add_target_beams(Emission *emission, size_t *capacity, Beam beam)
{
    const Scene *scene = tracer_scene(emission->tracer);
    for (uint32_t i = 0; i < scene->object_count; i++) {
        const Object *object = &scene->objects[i];
        if (!object->is_target || object->no_image || object->no_shadow ||
            bound_is_empty(object->bound))
            continue;
        set_target(&beam, emission, i);
        if (!add_beam(emission, capacity, &beam))
            return false;
    }
    return true;
}

/* What a beam of glow shines through: of endless things, what is within reach. */
static Bound glow_box(const Emission *emission, Bound bound)
{
    const WalkRules *rules = &emission->rules;
    double reach = REACH_RADII_PARALLEL * rules->radius;
    V3 half = v3(reach, reach, reach);
    return bound_intersect(bound,
                           (Bound){v3_sub(rules->center, half), v3_add(rules->center, half)});
}

/* What an object's surfaces do: some light others; what is inside shows outside, diffusely. */
typedef struct Glow {
    bool is_glowing, shows_back;
} Glow;

static void find_glowing(const Emission *emission, Glow *glows)
{
    const Scene *scene = tracer_scene(emission->tracer);
    const Plan *plan = tracer_plan(emission->tracer);
    for (uint32_t i = 0; i < scene->surface_count; i++) {
        const Surface *s = &scene->surfaces[i];
        glows[s->object].shows_back |= s->may_show_back;
        if (!s->no_radiosity && !scene->objects[s->object].no_shadow && plan_surface_glows(plan, s))
            glows[s->object].is_glowing = true;
    }
}

static int new_source(Emission *emission, const char *name)
{
    LightBooks *books = &emission->books[emission->source_count];
    snprintf(books->name, sizeof books->name, "%s", name);
    return emission->source_count++;
}

static bool add_glow_beam(Emission *emission, size_t *capacity, Beam *beam, Bound bound,
                          const char *name)
{
    beam->box = glow_box(emission, bound);
    if (bound_is_empty(beam->box) || !(box_area(beam->box) > 0))
        return true;
    beam->source = new_source(emission, name);
    beam->spacing_factor = 1;
    beam->brightness = (double)emission->rules.brightness;
    return add_beam(emission, capacity, beam);
}

static bool add_object_beams(Emission *emission, size_t *capacity, const Glow *glows)
{
    const Scene *scene = tracer_scene(emission->tracer);
    for (uint32_t i = 0; i < scene->object_count; i++) {
        const Object *object = &scene->objects[i];
        Beam beam = {.emitter = object};
        if (!glows[i].is_glowing)
            continue;
        beam.is_outside_only = !glows[i].shows_back && tracer_is_opaque_solid(emission->tracer, i);
        if (!add_glow_beam(emission, capacity, &beam, object->bound, object->name))
            return false;
    }
    return true;
}

/* The sky's box is a little larger than what it shines on, so that nothing lies on its faces. */
static bool add_sky_beam(Emission *emission, size_t *capacity)
{
    const WalkRules *rules = &emission->rules;
    Beam beam = {.is_endless = isfinite(rules->reach)};
    double grow = 1e-6 * rules->radius;
    Bound box = {v3_sub(rules->part.lo, v3(grow, grow, grow)),
                 v3_add(rules->part.hi, v3(grow, grow, grow))};
    return add_glow_beam(emission, capacity, &beam, beam.is_endless ? BOUND_ALL : box, "sky");
}

/* Add the beams of what glows, with a book for each. */
static Status add_glow(Emission *emission, size_t *capacity)
{
    const Scene *scene = tracer_scene(emission->tracer);
    const Plan *plan = tracer_plan(emission->tracer);
    Glow *glows = mem_array((size_t)scene->object_count + 1, sizeof *glows);
    bool is_good = glows != NULL;
    if (is_good && plan_has(plan, FEATURE_GLOW)) {
        find_glowing(emission, glows);
        is_good = add_object_beams(emission, capacity, glows);
    }
    if (is_good && plan_has(plan, FEATURE_SKY_LIGHT))
        is_good = add_sky_beam(emission, capacity);
    mem_free(glows);
    return is_good ? OK : diag_no_memory(emission->diag, "photon beams");
}

static Status make_beams(Emission *emission)
{
    const Scene *scene = tracer_scene(emission->tracer);
    size_t capacity = 0;
    bool is_good = true;
    for (int i = 0; i < scene->light_count && is_good; i++) {
        const Light *light = &scene->lights[i];
        Beam beam = {.light = light, .source = i, .spacing_factor = 1};
        if (!takes_part(emission, i))
            continue;
        beam.is_spread =
            light->has_area_photons && plan_light_has_area(tracer_plan(emission->tracer), light);
        if (map_is_aimed(emission->rules.map)) {
            is_good = add_target_beams(emission, &capacity, beam);
        } else {
            const WalkRules *rules = &emission->rules;
            beam.center = rules->center;
            beam.radius = rules->radius;
            if (isfinite(rules->reach))
                beam.radius *= light_is_parallel(beam.light) ? REACH_RADII_PARALLEL : REACH_RADII;
            is_good = add_beam(emission, &capacity, &beam);
        }
    }
    if (!is_good)
        return diag_no_memory(emission->diag, "photon beams");
    return map_is_aimed(emission->rules.map) ? OK : add_glow(emission, &capacity);
}

/* --- random numbers --------------------------------------------------------------------- */

Rng emission_rng(const Emission *emission, const Beam *beam, uint64_t index)
{
    uint64_t item = (emission->draw << 62) + (emission_beam_number(emission, beam) << 40) + index;
    return rng_at(emission->options->seed, PASS_PHOTON + (uint32_t)emission->rules.map, item);
}

void emission_set_keys(Emission *emission, uint64_t draw)
{
    emission->draw = draw;
    for (int i = 0; i < emission->beam_count; i++) {
        Beam *beam = &emission->beams[i];
        Rng keys = rng_at(emission->options->seed, PASS_KEYS + (uint32_t)emission->rules.map,
                          (draw << 32) + (uint64_t)i);
        beam->square_key = rng_u64(&keys);
        beam->shift_key = rng_u64(&keys);
        beam->area_key = rng_u64(&keys);
        beam->choice_key = rng_u64(&keys);
        beam->wave_key = rng_u64(&keys);
    }
}

/* The points of a beam's square are a Hammersley set in its own order, so that photons that
 * follow each other go nearly the same way through the scene. */
bool emission_ray(TraceThread *thread, const Beam *beam, uint64_t index, BeamRay *out)
{
    uint32_t number = (uint32_t)index;
    Rng shift = {beam->shift_key, index};
    V2 u = {((double)index + rng_double(&shift)) / (double)beam->rays,
            sample_inverse(number, beam->square_key)};
    double density;
    V2 square = beam_warp(beam, u, &density);
    V2 area = {0.5, 0.5};
    if (!beam->light || beam->is_spread)
        area = sample_2d(number, beam->area_key);
    double choice = beam->light ? 0 : rng_double(&shift);
    bool is_lit = emission_ray_at(thread, beam, square, area, choice, out);
    out->measure /= density * (double)beam->rays;
    return is_lit;
}

/* --- budgets ---------------------------------------------------------------------------- */

/* Photons a beam needs for neighbours to be `spacing` apart at its target. */
static double spaced_photons(const Beam *beam, double spacing)
{
    BeamRay middle;
    if (!beam_ray(beam, (V2){0.5, 0.5}, (V2){0.5, 0.5}, &middle))
        return 0;
    double step = spacing * beam->spacing_factor;
    if (!light_is_parallel(beam->light))
        step /= fmax(v3_dist(beam->center, middle.location), fmax(beam->radius, 1e-300));
    return middle.measure / (step * step);
}

/* Return the distance between photons at their targets: as written, or such that the language
 * would expect the number that was to be stored (if half the disk across the ball around a target
 * were target). */
static double photon_spacing(const Emission *emission)
{
    const Scene *scene = tracer_scene(emission->tracer);
    long count = tracer_plan(emission->tracer)->caustic_photons;
    double estimate = 0;
    if (count <= 0)
        return scene->settings.photons.spacing;
    for (int i = 0; i < emission->beam_count; i++) {
        const Beam *beam = &emission->beams[i];
        double across = beam->radius / beam->spacing_factor;
        estimate += PMS_PI * across * across * beam->stores / 2;
    }
    return sqrt(estimate / (double)count);
}

/* At least this part of the photons asked for is sent: a beam much thinner than its target lights
 * so little of it that a spacing over all of the target would leave it next to none. */
#define LEAST_PART (1.0 / 32)

/* Return how many photons to send, or, before the pilot, at most. */
static double photons_wanted(const Emission *emission, bool is_after_pilot)
{
    if (!map_is_aimed(emission->rules.map))
        return (double)tracer_plan(emission->tracer)->global_photons;
    double spacing = photon_spacing(emission), wanted = 0;
    for (int i = 0; i < emission->beam_count; i++) {
        const Beam *beam = &emission->beams[i];
        double photons = spaced_photons(beam, spacing);
        wanted += is_after_pilot ? photons * (beam->flux > 0 ? beam->filled : 0) : photons;
    }
    if (wanted > 0)
        wanted = fmax(wanted, LEAST_PART * (double)tracer_plan(emission->tracer)->caustic_photons);
    if (wanted <= SPACED_PHOTONS_MAX)
        return ceil(wanted);
    if (is_after_pilot && !emission->options->is_repeat)
        diag_warn(
            emission->diag, WARN_RENDER, tracer_scene(emission->tracer)->settings.photons.span,
            "spacing %g asks for %.3g photons: %.0f are sent", spacing, wanted, SPACED_PHOTONS_MAX);
    return SPACED_PHOTONS_MAX;
}

static void set_rays(Beam *beam, uint64_t photons)
{
    beam->budget = beam->rays = photons;
    if (!beam->light)
        beam->rays = (uint64_t)ceil((double)photons / beam->part_lit);
}

static Status share_beams(Emission *emission, int light, uint64_t total)
{
    int first = 0, count = 0;
    for (int i = emission->beam_count - 1; i >= 0; i--)
        if (emission->beams[i].source == light) {
            first = i;
            count++;
        }
    double *weights = mem_array((size_t)count + 1, sizeof *weights);
    uint64_t *shares = mem_array((size_t)count + 1, sizeof *shares);
    if (weights && shares) {
        for (int i = 0; i < count; i++) {
            const Beam *beam = &emission->beams[first + i];
            weights[i] = beam->flux / (beam->spacing_factor * beam->spacing_factor);
        }
        photon_budget(weights, count, total, shares);
        for (int i = 0; i < count; i++)
            set_rays(&emission->beams[first + i], shares[i]);
    }
    bool is_good = weights && shares;
    mem_free(weights);
    mem_free(shares);
    return is_good ? OK : diag_no_memory(emission->diag, "photon budgets");
}

static Status share_sources(Emission *emission, uint64_t total)
{
    int lights = emission->source_count;
    double *weights = mem_array((size_t)lights + 1, sizeof *weights), sum = 0;
    uint64_t *shares = mem_array((size_t)lights + 1, sizeof *shares);
    Status status = weights && shares ? OK : diag_no_memory(emission->diag, "photon budgets");
    for (int i = 0; status == OK && i < emission->beam_count; i++) {
        const Beam *beam = &emission->beams[i];
        double weight = beam->flux * (beam->light ? (double)beam->light->photon_share : 1);
        emission->books[beam->source].power += beam->flux;
        weights[beam->source] += weight;
        sum += weight;
    }
    if (status == OK)
        photon_budget(weights, lights, total, shares);
    for (int i = 0; status == OK && i < lights; i++) {
        emission->books[i].share = sum > 0 ? weights[i] / sum : 0;
        emission->books[i].budget = shares[i];
        emission->budget += shares[i];
        if (shares[i] > 0)
            status = share_beams(emission, i, shares[i]);
    }
    mem_free(weights);
    mem_free(shares);
    return status;
}

/* --- the emission ----------------------------------------------------------------------- */

/* The part of the scene that indirect light is for: all of it, or what is bounded of it. */
static Bound indirect_part(const Tracer *tracer, bool *is_endless)
{
    const Scene *scene = tracer_scene(tracer);
    Bound objects = BOUND_EMPTY;
    *is_endless = false;
    for (uint32_t i = 0; i < scene->object_count; i++) {
        Bound bound = scene->objects[i].bound;
        if (bound_is_empty(bound))
            continue;
        if (bound_is_finite(bound))
            objects = bound_union(objects, bound);
        else
            *is_endless = true;
    }
    if (*is_endless || bound_is_empty(objects))
        return bound_add(tracer_bound(tracer), scene->camera.location);
    return objects;
}

static void set_rules(Emission *emission, MapKind map)
{
    const Scene *scene = tracer_scene(emission->tracer);
    const SceneSettings *settings = &scene->settings;
    const PhotonSettings *photons = &settings->photons;
    bool is_endless = false;
    Bound bound = map_is_aimed(map) ? tracer_bound(emission->tracer)
                                    : indirect_part(emission->tracer, &is_endless);
    if (map == MAP_FOCUS || map == MAP_VOLUME)
        bound = bound_add(indirect_part(emission->tracer, &is_endless), scene->camera.location);
    emission->rules =
        (WalkRules){.map = map,
                    .part = bound,
                    .center = bound_center(bound),
                    .radius = bound_radius(bound),
                    .reach = is_endless ? REACH_RADII * bound_radius(bound) : INFINITY,
                    .max_level = photons->max_trace_level > 0 ? photons->max_trace_level
                                                              : settings->max_trace_level,
                    .adc_bailout = (float)(photons->adc_bailout > 0 ? photons->adc_bailout
                                                                    : settings->adc_bailout),
                    .keeps_first = plan_has(tracer_plan(emission->tracer), FEATURE_FINAL_GATHER),
                    .max_diffuse = INT_MAX,
                    .brightness = (float)settings->radiosity.brightness,
                    .inside = emission->inside,
                    .has_media = plan_has(tracer_plan(emission->tracer), FEATURE_MEDIA),
                    .keeps_light = emission->options->is_full};
    if (settings->radiosity.recursion_limit > 0) /* the eye's own look, or gather rays, is one */
        emission->rules.max_diffuse = settings->radiosity.recursion_limit - 1;
}

static Status make_threads(Emission *emission)
{
    int count = emission->options->threads;
    emission->threads = mem_array((size_t)count, sizeof *emission->threads);
    if (!emission->threads)
        return diag_no_memory(emission->diag, "the photon pass");
    for (; emission->thread_count < count; emission->thread_count++)
        TRY(trace_thread_init(&emission->threads[emission->thread_count], emission->tracer,
                              emission->diag));
    return OK;
}

Status emission_init(Emission *emission, const Tracer *tracer, MapKind map,
                     const PhotonOptions *options, Diag *diag)
{
    const Scene *scene = tracer_scene(tracer);
    size_t lights = (size_t)scene->light_count, sources = lights + scene->object_count + 1;
    *emission = (Emission){.tracer = tracer, .options = options, .diag = diag};
    emission->books = mem_array(sources, sizeof *emission->books);
    emission->inside = mem_array(lights + 1, sizeof *emission->inside);
    if (!emission->books || !emission->inside)
        return diag_no_memory(diag, "the photon pass");
    for (size_t i = 0; i < lights; i++)
        new_source(emission, scene->lights[i].name);
    set_rules(emission, map);
    for (size_t i = 0; i < lights; i++)
        interiors_at(tracer, scene->lights[i].location, &emission->inside[i]);
    TRY(make_threads(emission));
    TRY(make_beams(emission));
    if (emission->beam_count == 0)
        return OK;
    emission_set_keys(emission, 0);
    double part = options->part > 0 ? options->part : 1;
    part *= options->miniature ? options->miniature->photons : 1;
    TRY(emission_pilot(emission, photons_wanted(emission, false)));
    return share_sources(emission, (uint64_t)ceil(part * photons_wanted(emission, true)));
}

void emission_done(Emission *emission, Stats *add_to)
{
    for (int i = 0; i < emission->thread_count; i++) {
        if (add_to)
            stats_add(add_to, &emission->threads[i].stats);
        trace_thread_done(&emission->threads[i]);
    }
    for (int i = 0; i < emission->beam_count; i++)
        mem_free(emission->beams[i].cumulative);
    mem_free(emission->threads);
    mem_free(emission->beams);
    mem_free(emission->inside);
    mem_free(emission->books);
    *emission = (Emission){0};
}
