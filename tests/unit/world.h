/* A scene made by hand, for tests that trace rays, and an eye that knows ambient light only.
 * Include after cmocka.h.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TESTS_WORLD_H
#define PMS_TESTS_WORLD_H

#include "trace/trace.h"

#include <string.h>

enum { OBJECTS_MAX = 64 };

typedef struct World {
    Scene scene;
    Plan plan;
    Object objects[OBJECTS_MAX];
    Surface surfaces[OBJECTS_MAX];
    Light lights[2];
    Tracer *tracer;
    TraceThread thread;
    Diag diag;
} World;

static inline void world_init(World *w)
{
    memset(w, 0, sizeof *w);
    w->scene.arena = arena_new();
    w->scene.objects = w->objects;
    w->scene.surfaces = w->surfaces;
    w->scene.lights = w->lights;
    w->scene.light_count = 2;
    w->lights[0].is_parallel = w->lights[1].is_parallel = true; /* rays to it go anywhere */
    w->scene.settings.version = 3.7;
    w->scene.settings.adc_bailout = 1 / 255.0;
    w->scene.settings.max_trace_level = 5;
    w->scene.settings.irid_wavelength = rgb(0.70f, 0.52f, 0.48f);
    w->scene.settings.ambient_light = RGB_WHITE;
    w->plan.rows[FEATURE_TRANSPARENT_SHADOWS].is_on = true;
    w->plan.rows[FEATURE_ABSORPTION].is_on = true;
    diag_init(&w->diag, NULL, NULL);
}

static inline void world_ready(World *w)
{
    assert_int_equal(tracer_new(&w->scene, &w->plan, 1, &w->diag, &w->tracer), OK);
    assert_int_equal(trace_thread_init(&w->thread, w->tracer, &w->diag), OK);
}

static inline void world_done(World *w)
{
    trace_thread_done(&w->thread);
    tracer_free(w->tracer);
    arena_free(w->scene.arena);
    diag_done(&w->diag);
}

static inline void set_surface(Shape *shape, uint32_t surface)
{
    shape->surface = surface;
    for (int i = 0; i < shape->child_count; i++)
        set_surface(shape->children[i], surface);
}

static inline Surface *world_add(World *w, Shape *shape, const Texture *texture,
                                 const Interior *interior)
{
    uint32_t i = w->scene.object_count++;
    w->scene.surface_count++;
    set_surface(shape, i);
    w->objects[i] = (Object){.shape = shape, .bound = shape_bound(shape)};
    w->surfaces[i] = (Surface){.texture = texture,
                               .interior = interior,
                               .photons = PHOTON_FLAGS_DEFAULT,
                               .may_transmit = texture_may_transmit(texture),
                               .object = i};
    return &w->surfaces[i];
}

/* One layer of a colour; ambient and diffuse are 0 unless a finish is given. */
static const Finish dull = {.brilliance = 1, .reflection_falloff = 1, .reflection_exponent = 1};

static inline const Texture *flat(World *w, Color5 color, const Finish *finish)
{
    Arena *arena = w->scene.arena;
    Pigment pigment = {.is_solid = true, .color = color};
    Finish *own = arena_copy(arena, finish, sizeof *finish);
    Layer layer = {arena_copy(arena, &pigment, sizeof pigment), own};
    Texture texture = {.layers = arena_copy(arena, &layer, sizeof layer), .layer_count = 1};
    return arena_copy(arena, &texture, sizeof texture);
}

static inline const Texture *two_layers(World *w, const Texture *bottom, const Texture *top)
{
    Layer layers[2] = {bottom->layers[0], top->layers[0]};
    Texture texture = {.layers = arena_copy(w->scene.arena, layers, sizeof layers),
                       .layer_count = 2};
    return arena_copy(w->scene.arena, &texture, sizeof texture);
}

static inline const Texture *emitter(World *w, float r, float g, float b)
{
    Finish finish = dull;
    finish.ambient = RGB_WHITE;
    return flat(w, (Color5){r, g, b, 0, 0}, &finish);
}

static inline const Texture *clear(World *w)
{
    return flat(w, (Color5){1, 1, 1, 0, 1}, &dull);
}

static const Interior air = {.ior = 1};

/* Absorption that is exponential: exp(-(1 - color) d) after d units. */
static inline Interior fading(Rgb color)
{
    return (Interior){.ior = 1, .fade_distance = 1, .fade_power = 1000, .fade_color = color};
}

static inline Shape *box(World *w, V3 lo, V3 hi)
{
    return shape_box(w->scene.arena, lo, hi);
}

static inline Rgb look_along(World *w, const Ray *ray, RayKind kind, const Interiors *inside,
                             int level, float weight, bool is_straight)
{
    Hit hit;
    SurfaceSample s;
    const SceneSettings *settings = &w->scene.settings;
    if (!trace_closest(&w->thread, ray, kind, &hit))
        return color5_rgb(w->scene.background.color);
    if (!is_straight)
        level++;
    surface_sample(&w->thread, ray, &hit, inside, &s);
    Rgb sum = RGB_BLACK, faded = interiors_fade(inside, hit.t);
    for (int i = 0; i < s.layer_count; i++) {
        const SurfaceLayer *layer = &s.layers[i];
        Rgb own = rgb_mul(layer->color, layer->finish->ambient);
        sum = rgb_add(sum, rgb_mul(layer->above, rgb_scale(own, layer->opacity)));
        float share = weight * rgb_max_abs(layer->reflect);
        if (rgb_is_black(layer->reflect) || level >= settings->max_trace_level ||
            (double)share < settings->adc_bailout)
            continue;
        Ray mirrored = trace_ray_from(&s.at, layer->reflect_dir);
        Rgb seen = look_along(w, &mirrored, RAY_REFLECTED, inside, level, share, false);
        sum = rgb_add(sum, rgb_mul(layer->reflect, seen));
    }
    float next = weight * (s.is_total_reflection ? 1 : rgb_max_abs(s.filter));
    if (s.has_transmission && level < settings->max_trace_level &&
        (double)next >= settings->adc_bailout) {
        Ray through = trace_ray_from(&s.at, s.transmit_dir);
        Rgb seen = look_along(w, &through, kind, &s.inside_after, level, next, s.is_straight);
        sum = rgb_add(sum, rgb_mul(s.through, seen));
    }
    return rgb_mul(faded, sum);
}

/* Look along +z through x = y = 0 from z = -10, as the measured pixels do. */
static inline Rgb look(World *w)
{
    Ray ray = {{0, 0, -10}, {0, 0, 1}, 0, INFINITY};
    Interiors inside;
    interiors_at(w->tracer, ray.o, &inside);
    return look_along(w, &ray, RAY_CAMERA, &inside, 0, 1, false);
}

/* Half a step of 16 bits, five digits, float colours. */
#define PIXEL_TOLERANCE 1.6e-5

static inline void check_rgb(Rgb c, double r, double g, double b)
{
    if (!(fabs((double)c.r - r) < PIXEL_TOLERANCE && fabs((double)c.g - g) < PIXEL_TOLERANCE &&
          fabs((double)c.b - b) < PIXEL_TOLERANCE))
        fail_msg("got %.5f %.5f %.5f, wanted %.5f %.5f %.5f", (double)c.r, (double)c.g, (double)c.b,
                 r, g, b);
}

#endif
