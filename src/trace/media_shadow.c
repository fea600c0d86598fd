/* What media and fog take from light on its way to a point.
 *
 * The solids with media on the way are asked where the ray enters and leaves them: no stack of
 * interiors is needed for that, and a ray may begin anywhere.  So are those that are not hollow: in
 * them there are no media and no fog.  SPDX-License-Identifier: Apache-2.0
 */
#include "trace/media_along.h"

#include "trace/trace_int.h"

enum { PARTS_MAX = 256 /* of a ray that media count in; what lies behind is one of them */ };

/* A part of the ray inside one interior. */
typedef struct Stretch {
    double begin, end;
    const Interior *interior;
} Stretch;

static const Shape *first_leaf(const Shape *shape)
{
    while (shape->child_count > 0)
        shape = shape->children[0];
    return shape;
}

typedef void (*StretchVisit)(void *ctx, const Stretch *stretch);

/* Visit where the crossings of a solid say that the ray is inside, between 0 and tmax.  Stretches
 * without end there are left out unless the light dims. */
static void visit_list(const Tracer *tracer, const Shape *shape, const CrossList *list, double tmax,
                       bool is_to_light, StretchVisit visit, void *ctx)
{
    bool inside = list->is_inside_before;
    double begin = -INFINITY;
    const Shape *leaf = NULL;
    for (int i = 0; i <= list->count; i++) {
        const Crossing *c = i < list->count ? &list->items[i] : NULL;
        double t = c ? c->t : INFINITY;
        if (c && c->change > 0) {
            begin = t;
            leaf = c->leaf;
            inside = true;
        } else if (inside && (!c || c->change < 0)) {
            const Shape *lender = leaf ? leaf : c ? c->leaf : first_leaf(shape);
            inside = false;
            if (!(t > 0) || !(begin < tmax) || (t >= tmax && !is_to_light))
                continue;
            Stretch stretch = {fmax(0, begin), fmin(tmax, t),
                               tracer->scene->surfaces[lender->surface].interior};
            visit(ctx, &stretch);
        }
    }
}

/* Visit the stretches inside an object; `visit` must not ask shapes. */
static void visit_stretches(TraceThread *thread, uint32_t object, const Ray *ray, bool is_to_light,
                            StretchVisit visit, void *ctx)
{
    const Tracer *tracer = thread->tracer;
    const TracedObject *traced = &tracer->objects[object];
    if (traced->shadow == SHADOW_NONE || object_is_missed(traced, ray))
        return;
    CrossList list;
    shape_crossings(traced->shape, ray, thread->shapes, &list);
    visit_list(tracer, traced->shape, &list, ray->tmax, is_to_light, visit, ctx);
}

/* --- what is not hollow ----------------------------------------------------------------------- */

/* Parts of the ray that are not in solids that are not hollow, in no order. */
typedef struct OpenParts {
    int count;
    double begin[PARTS_MAX], end[PARTS_MAX];
} OpenParts;

static void cut(OpenParts *open, double begin, double end)
{
    for (int i = 0, count = open->count; i < count; i++) {
        double first = open->begin[i], last = open->end[i];
        if (!(begin < last && end > first))
            continue;
        open->end[i] = fmax(first, begin);
        if (!(end < last) || open->count == PARTS_MAX)
            continue;
        open->begin[open->count] = end;
        open->end[open->count++] = last;
    }
}

typedef struct OpenQuery {
    TraceThread *thread;
    const Ray *ray;
    OpenParts *out;
} OpenQuery;

static void cut_stretch(void *ctx, const Stretch *stretch)
{
    if (!stretch->interior->is_hollow)
        cut(ctx, stretch->begin, stretch->end);
}

static void cut_object(OpenQuery *query, uint32_t object)
{
    if (query->thread->tracer->objects[object].keeps_air_out)
        visit_stretches(query->thread, object, query->ray, true, cut_stretch, query->out);
}

static bool cut_item(void *ctx, uint32_t item, Ray *ray)
{
    (void)ray;
    OpenQuery *query = ctx;
    cut_object(query, query->thread->tracer->index_objects[item]);
    return false;
}

/* In order along the ray, whatever order the index found the solids in. */
static void sort_parts(OpenParts *open)
{
    for (int i = 1; i < open->count; i++)
        for (int k = i; k > 0 && open->begin[k] < open->begin[k - 1]; k--) {
            double begin = open->begin[k], end = open->end[k];
            open->begin[k] = open->begin[k - 1];
            open->end[k] = open->end[k - 1];
            open->begin[k - 1] = begin;
            open->end[k - 1] = end;
        }
}

static void find_open(TraceThread *thread, const Ray *ray, OpenParts *out)
{
    const Tracer *tracer = thread->tracer;
    out->count = 1;
    out->begin[0] = 0;
    out->end[0] = ray->tmax;
    if (tracer->solid_count == 0)
        return;
    OpenQuery query = {thread, ray, out};
    for (uint32_t i = 0; i < tracer->unbounded_count; i++)
        cut_object(&query, tracer->unbounded[i]);
    Ray whole = *ray;
    if (tracer->index)
        box_index_any(tracer->index, &whole, cut_item, &query);
    sort_parts(out);
}

/* --- media ------------------------------------------------------------------------------------ */

/* What passes media along the open parts of a stretch. */
static Rgb open_transmittance(TraceThread *thread, const MediaHere *here, const Ray *ray,
                              const OpenParts *open, double begin, double end)
{
    Rgb light = RGB_WHITE;
    for (int i = 0; i < open->count; i++) {
        double first = fmax(begin, open->begin[i]), last = fmin(end, open->end[i]);
        if (last > first)
            light = rgb_mul(light, media_transmittance(here, ray, first, last, last,
                                                       &thread->media_rng, &thread->stats));
    }
    return light;
}

typedef struct Dimming {
    TraceThread *thread;
    const Ray *ray;
    const OpenParts *open;
    Rgb light;
} Dimming;

static void dim(void *ctx, const Stretch *stretch)
{
    Dimming *d = ctx;
    MediaHere here;
    media_of_interior(stretch->interior, &here);
    d->light = rgb_mul(d->light, open_transmittance(d->thread, &here, d->ray, d->open,
                                                    stretch->begin, stretch->end));
}

static void note_stretch(void *ctx, const Stretch *stretch)
{
    (void)stretch;
    *(bool *)ctx = true;
}

Rgb media_shadow(TraceThread *thread, const Ray *ray, bool is_to_light)
{
    const Tracer *tracer = thread->tracer;
    OpenParts open;
    Dimming dimming = {thread, ray, &open, RGB_WHITE};
    bool is_open_known = false;
    for (uint32_t k = 0; k < tracer->media_count && !rgb_is_black(dimming.light); k++) {
        bool is_met = is_open_known;
        if (!is_met)
            visit_stretches(thread, tracer->media[k], ray, is_to_light, note_stretch, &is_met);
        if (!is_met)
            continue;
        if (!is_open_known)
            find_open(thread, ray, &open);
        is_open_known = true;
        visit_stretches(thread, tracer->media[k], ray, is_to_light, dim, &dimming);
    }
    return dimming.light;
}

/* Fog keeps light off, and adds no colour of its own to it. */
static Rgb fog_shadow(const Scene *scene, const Ray *ray, const OpenParts *open)
{
    Rgb light = RGB_WHITE;
    for (int i = 0; i < scene->atmosphere.fog_count; i++) {
        const Fog *fog = scene->atmosphere.fogs[i];
        double clear = 1, length = 0;
        for (int k = 0; k < open->count && fog->distance > 0; k++) {
            double begin = open->begin[k], end = open->end[k];
            if (!(end > begin))
                continue;
            clear *= fog_clearness(fog, ray_at(ray, begin), ray_at(ray, end), end - begin);
            length += end - begin;
        }
        if (!(length > 0))
            continue;
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
    OpenParts open;
    Ray ray = {p, to, 0, distance};
    find_open(thread, &ray, &open);
    if (is_dimmed && plan_has(tracer->plan, FEATURE_FOG))
        passed = fog_shadow(tracer->scene, &ray, &open);
    if (!plan_has(tracer->plan, FEATURE_MEDIA))
        return passed;
    MediaHere here;
    media_of_air(tracer, &here);
    return rgb_mul(passed, open_transmittance(thread, &here, &ray, &open, 0, distance));
}
