/* What media and fog take from light on its way to a point.
 *
 * The solids with media on the way are asked where the ray enters and leaves them: no stack of
 * interiors is needed for that, and a ray may begin anywhere.  SPDX-License-Identifier: Apache-2.0
 */
#include "trace/media_along.h"

#include "trace/trace_int.h"

enum { STRETCHES_MAX = 64 };

/* A part of the ray inside one interior. */
typedef struct Stretch {
    double begin, end;
    const Interior *interior;
} Stretch;

/* Where the crossings of a solid say that the ray is inside, between 0 and tmax.  Stretches
 * without end there are left out unless the light dims. */
static int find_stretches(const Tracer *tracer, const CrossList *list, double tmax,
                          bool is_to_light, Stretch *out)
{
    int count = 0, inside = list->is_inside_before;
    double begin = -INFINITY;
    const Shape *leaf = NULL;
    for (int i = 0; i <= list->count && count < STRETCHES_MAX; i++) {
        const Crossing *c = i < list->count ? &list->items[i] : NULL;
        double t = c ? c->t : INFINITY;
        if (c && c->change > 0) {
            begin = t;
            leaf = c->leaf;
            inside = true;
        } else if (inside && (!c || c->change < 0)) {
            const Shape *lender = leaf ? leaf : c ? c->leaf : NULL;
            inside = false;
            if (!lender || !(t > 0) || !(begin < tmax) || (t >= tmax && !is_to_light))
                continue;
            out[count++] = (Stretch){fmax(0, begin), fmin(tmax, t),
                                     tracer->scene->surfaces[lender->surface].interior};
        }
    }
    return count;
}

static Rgb object_media(TraceThread *thread, uint32_t object, const Ray *ray, bool is_to_light)
{
    const Tracer *tracer = thread->tracer;
    const TracedObject *traced = &tracer->objects[object];
    if (traced->shadow == SHADOW_NONE || object_is_missed(traced, ray))
        return RGB_WHITE;
    CrossList list;
    Stretch stretches[STRETCHES_MAX];
    shape_crossings(traced->shape, ray, thread->shapes, &list);
    int count = find_stretches(tracer, &list, ray->tmax, is_to_light, stretches);
    Rgb light = RGB_WHITE;
    for (int i = 0; i < count; i++) {
        const Stretch *s = &stretches[i];
        MediaHere here;
        media_of_interior(s->interior, &here);
        light = rgb_mul(
            light, media_transmittance(&here, ray, s->begin, s->end, s->end, &thread->media_rng));
    }
    return light;
}

Rgb media_shadow(TraceThread *thread, const Ray *ray, bool is_to_light)
{
    const Tracer *tracer = thread->tracer;
    Rgb light = RGB_WHITE;
    for (uint32_t i = 0; i < tracer->media_count && !rgb_is_black(light); i++)
        light = rgb_mul(light, object_media(thread, tracer->media[i], ray, is_to_light));
    return light;
}

/* Fog keeps light off, and adds no colour of its own to it. */
static Rgb fog_shadow(const Scene *scene, V3 p, V3 to, double distance)
{
    Rgb light = RGB_WHITE;
    for (int i = 0; i < scene->atmosphere.fog_count; i++) {
        const Fog *fog = scene->atmosphere.fogs[i];
        if (!(fog->distance > 0))
            continue;
        double clear = fog_clearness(fog, p, v3_mad(p, distance, to), distance);
        clear = fmax(clear, (double)fog->color.transmit);
        Rgb tint = rgb_lerp(RGB_WHITE, color5_rgb(fog->color), fog->color.filter);
        light = rgb_mul(light, rgb_scale(tint, (float)clear));
    }
    return light;
}

Rgb media_air_shadow(TraceThread *thread, V3 p, V3 to, double distance, int light)
{
    const Tracer *tracer = thread->tracer;
    const Light *source = &tracer->scene->lights[light];
    bool is_dimmed = source->is_dimmed_by_media && source->lights_media;
    if (!(is_dimmed || thread->is_dimmed) || !(distance > 0))
        return RGB_WHITE;
    Rgb passed = RGB_WHITE;
    if (is_dimmed && plan_has(tracer->plan, FEATURE_FOG))
        passed = fog_shadow(tracer->scene, p, to, distance);
    if (!plan_has(tracer->plan, FEATURE_MEDIA))
        return passed;
    MediaHere here;
    Ray ray = {p, to, 0, distance};
    media_of_air(tracer, &here);
    return rgb_mul(passed,
                   media_transmittance(&here, &ray, 0, distance, distance, &thread->media_rng));
}
