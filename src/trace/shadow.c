/* Shadow rays.
 *
 * One pass over the index looks for anything opaque and notes the objects that let light
 * through; in most scenes that is all.  Otherwise the crossings of the noted objects are listed
 * and visited in order of t, and filter the light.  What the ray is in between them absorbs; that
 * it began inside something shows where it leaves that.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/mem.h"
#include "trace/media_along.h"
#include "trace/trace_int.h"

enum { FILTERS_FEW = 16 }; /* objects noted without asking for memory */

/* An object that may let the ray pass. */
typedef struct Filter {
    uint32_t object;
    bool is_started, is_inside; /* for objects whose normals do not tell */
    size_t next, end;           /* of its crossings: in the thread's list */
} Filter;

typedef struct ShadowQuery {
    TraceThread *thread;
    const Tracer *tracer;
    const Light *light; /* NULL: none in particular */
    int light_index;
    bool blocks_targets;
    uint32_t blocker;
    uint32_t passed; /* an object that is known not to block this ray; NO_OBJECT: none is */
    int count, capacity;
    Filter *filters;
    Filter few[FILTERS_FEW];
} ShadowQuery;

/* Returns false when memory is out. */
static bool note_filter(ShadowQuery *query, uint32_t object)
{
    if (query->count == query->capacity) {
        Filter *more = ARENA_ARRAY(query->thread->scratch, Filter, (size_t)query->capacity * 2);
        if (!more)
            return false;
        for (int i = 0; i < query->count; i++)
            more[i] = query->filters[i];
        query->filters = more;
        query->capacity *= 2;
    }
    query->filters[query->count].object = object;
    query->filters[query->count++].is_started = false;
    return true;
}

/* Return true if any hit of the object blocks. */
static bool may_block(const ShadowQuery *query, uint32_t object)
{
    ShadowKind kind = query->tracer->objects[object].shadow;
    if (kind != SHADOW_TARGET)
        return kind == SHADOW_BLOCK;
    return query->blocks_targets && !(query->light && query->light->photon_refraction == TRI_OFF);
}

/* Returns true if the object blocks all light; notes it if it may filter. */
static bool test_object(ShadowQuery *query, uint32_t object, const Ray *ray)
{
    const TracedObject *traced = &query->tracer->objects[object];
    if (traced->shadow == SHADOW_NONE || object == query->passed)
        return false;
    if (!may_block(query, object) && note_filter(query, object))
        return false;
    if (!shape_is_met(traced->shape, ray, query->thread->shapes))
        return false;
    query->blocker = object;
    return true;
}

static bool test_item(void *ctx, uint32_t item, Ray *ray)
{
    ShadowQuery *query = ctx;
    return test_object(query, query->tracer->index_objects[item], ray);
}

/* Return true if both ends of the ray are on one side of a plane. */
static bool plane_is_missed(const Shape *plane, const Ray *ray)
{
    V3 n = plane->u.plane.normal;
    double start = v3_dot(n, ray->o) - plane->u.plane.distance;
    double end = start + ray->tmax * v3_dot(n, ray->d);
    return (start > 0 && end > 0) || (start < 0 && end < 0);
}

/* Test the objects the light sees in this direction; returns false if the cell does not know
 * them all. */
static bool test_view(ShadowQuery *query, const ViewIndex *view, const Ray *ray, bool *is_blocked)
{
    const ViewCell *cell = view_cell(view, v3_neg(ray->d));
    if (cell->count == VIEW_CELL_FULL)
        return false;
    *is_blocked = false;
    for (uint32_t i = 0; i < cell->count && !*is_blocked; i++) {
        uint32_t object = cell->object[i];
        /* The ray ends at the light, give or take its slack. */
        if ((double)view->near[object] > ray->tmax * (1 + 1e-6))
            break;
        if (!object_is_missed(&query->tracer->objects[object], ray))
            *is_blocked = test_object(query, object, ray);
    }
    return true;
}

/* The view of a light holds for rays that aim at it to within its margin. */
#define VIEW_NEAREST 1e10

/* Look for a blocker among all objects. */
static bool find_blocker(ShadowQuery *query, const Ray *ray, int light, double error)
{
    const Tracer *tracer = query->tracer;
    for (uint32_t i = 0; i < tracer->unbounded_count; i++) {
        uint32_t object = tracer->unbounded[i];
        const Shape *shape = tracer->objects[object].shape;
        if (shape->kind == SHAPE_PLANE && plane_is_missed(shape, ray))
            continue;
        if (test_object(query, object, ray))
            return true;
    }
    if (!tracer->index)
        return false;
    bool is_blocked;
    const ViewIndex *view = light >= 0 ? tracer->light_views[light] : NULL;
    if (view && ray->tmax > VIEW_NEAREST * error && test_view(query, view, ray, &is_blocked))
        return is_blocked;
    Ray rest = *ray;
    return box_index_any(tracer->index, &rest, test_item, query);
}

/* Look for a blocker among the objects of a bundle. */
static bool find_in_bundle(ShadowQuery *query, const Ray *ray, const ShadowBundle *bundle)
{
    for (int i = 0; i < bundle->count; i++) {
        const TracedObject *object = &query->tracer->objects[bundle->object[i]];
        if (object->shape->kind == SHAPE_PLANE ? plane_is_missed(object->shape, ray)
                                               : object_is_missed(object, ray))
            continue;
        if (test_object(query, bundle->object[i], ray))
            return true;
    }
    return false;
}

/* Try what blocked the last ray to this light. */
static bool is_still_blocked(ShadowQuery *query, const Ray *ray, int light)
{
    uint32_t last = light >= 0 ? query->thread->blockers[light] : NO_OBJECT;
    if (last == NO_OBJECT || !may_block(query, last))
        return false;
    if (!object_is_missed(&query->tracer->objects[last], ray) && test_object(query, last, ray))
        return true;
    query->passed = last;
    return false;
}

static bool is_solid_texture(const Texture *texture)
{
    for (int i = 0; i < texture->layer_count; i++)
        if (!texture->layers[i].pigment->is_solid)
            return false;
    return true;
}

/* Return what passes a texture at a point. */
static Rgb texture_filter(const Texture *texture, const Interior *interior, V3 p, V2 uv,
                          double cosine)
{
    Rgb filter = RGB_WHITE;
    for (int i = 0; i < texture->layer_count; i++) {
        filter = rgb_mul(filter, color5_through(pigment_at_uv(texture->layers[i].pigment, p, uv)));
        if (interior->caustics != 0)
            filter =
                rgb_scale(filter, (float)(1 + pow(fabs(cosine), 45 * (double)interior->caustics)));
    }
    return filter;
}

/* Return true if a target's refracted light comes with the caustic map. */
static bool is_blocking_target(const ShadowQuery *query, const Surface *surface)
{
    if (!query->blocks_targets || !surface->is_target)
        return false;
    return query->light ? plan_photons_refract(query->light, surface)
                        : surface->photons.refraction == TRI_ON;
}

/* Return what passes one crossing. */
static Rgb crossing_filter(const ShadowQuery *query, const Crossing *crossing, const Ray *ray)
{
    const Surface *surface = &query->tracer->scene->surfaces[crossing->leaf->surface];
    const Interior *interior = surface->interior;
    if (!plan_filters_shadow(query->tracer->plan, surface) || is_blocking_target(query, surface))
        return RGB_BLACK;
    /* The point is needed only if something depends on it. */
    if (!surface->part_textures && !surface->inner_texture && interior->caustics == 0 &&
        is_solid_texture(surface->texture))
        return texture_filter(surface->texture, interior, v3(0, 0, 0), (V2){0, 0}, 0);

    ShapePoint point;
    shape_point(crossing, ray, &point);
    TextureChoice choice;
    texture_choose(surface, crossing->leaf, crossing->part, crossing->u, crossing->v, point.p,
                   v3_dot(point.ng, ray->d) > 0, &choice);
    Rgb sum = RGB_BLACK;
    double cosine = v3_dot(point.ns, ray->d);
    for (int i = 0; i < choice.count; i++)
        sum = rgb_mad(sum, choice.weight[i],
                      texture_filter(choice.texture[i], interior, point.p, choice.uv, cosine));
    return sum;
}

/* The stretches between crossings. */
typedef struct Legs {
    Interiors inside; /* entered on the way */
    double since;     /* t of the last crossing */
    double open;      /* length gone in nothing that was entered on the way */
} Legs;

/* Which way does the line go through a surface: 1 in, -1 out, 0 neither? */
static int crossing_way(const ShadowQuery *query, Filter *filter, const Crossing *crossing,
                        const Ray *ray)
{
    if (query->tracer->objects[filter->object].is_closed)
        return crossing->leaf_change;
    ShapePoint point;
    if (!filter->is_started) {
        shape_point(crossing, ray, &point);
        filter->is_inside = v3_dot(point.ng, ray->d) > 0;
    }
    filter->is_started = true;
    filter->is_inside = !filter->is_inside;
    return filter->is_inside ? 1 : -1;
}

static Rgb absorbed(const Interiors *inside, double length)
{
    return interior_fade(inside->in[inside->count - 1], length, true);
}

/* End a leg at the crossing of a filter; returns what its interior, and one that the ray turns out
 * to have begun in, let through. */
static Rgb end_leg(const ShadowQuery *query, Filter *filter, const Crossing *crossing,
                   const Ray *ray, Legs *legs)
{
    Rgb passed = RGB_WHITE;
    const Interior *interior = query->tracer->scene->surfaces[crossing->leaf->surface].interior;
    double length = crossing->t - legs->since;
    legs->since = crossing->t;
    if (legs->inside.count > 0)
        passed = absorbed(&legs->inside, length);
    else
        legs->open += length;
    int way = crossing_way(query, filter, crossing, ray);
    if (way > 0) {
        interiors_enter(&legs->inside, interior, filter->object);
    } else if (way < 0 && !interiors_leave(&legs->inside, interior, filter->object)) {
        passed = rgb_mul(passed, interior_fade(interior, legs->open, true));
        legs->open = 0;
    }
    return passed;
}

/* List the crossings of a filter behind those of the ones before; false when memory is out. */
static bool list_crossings(ShadowQuery *query, Filter *filter, const Ray *ray, size_t *count)
{
    TraceThread *thread = query->thread;
    CrossList list;
    const Shape *shape = query->tracer->objects[filter->object].shape;
    shape_crossings_ahead(shape, ray, thread->shapes, &list);
    filter->next = *count;
    for (int i = 0; i < list.count; i++, ++*count) {
        void *items = thread->crossed;
        if (mem_grow(&items, *count, &thread->crossed_capacity, sizeof *list.items))
            return false;
        thread->crossed = items;
        thread->crossed[*count] = list.items[i];
    }
    filter->end = *count;
    return true;
}

/* Keep those filters that the ray meets, with their crossings; false when memory is out. */
static bool list_filters(ShadowQuery *query, const Ray *ray)
{
    int kept = 0;
    size_t count = 0;
    for (int i = 0; i < query->count; i++) {
        Filter *filter = &query->filters[i];
        if (!list_crossings(query, filter, ray, &count))
            return false;
        if (filter->next < filter->end)
            query->filters[kept++] = *filter;
    }
    query->count = kept;
    return true;
}

/* Return which filter has the nearest crossing. */
static int nearest_filter(const ShadowQuery *query)
{
    int nearest = 0;
    const Crossing *crossed = query->thread->crossed;
    for (int i = 1; i < query->count; i++) {
        const Filter *a = &query->filters[i], *b = &query->filters[nearest];
        double t = crossed[a->next].t, least = crossed[b->next].t;
        if (t < least || (t == least && a->object < b->object))
            nearest = i;
    }
    return nearest;
}

/* Return what the last leg lets through: the light may stand in something, and the ray have begun
 * in that. */
static Rgb end_last_leg(const ShadowQuery *query, const Ray *ray, const Legs *legs)
{
    double length = ray->tmax - legs->since;
    if (legs->inside.count > 0)
        return absorbed(&legs->inside, length);
    const Interior *interior = query->tracer->light_interiors[query->light_index];
    return interior ? interior_fade(interior, legs->open + length, true) : RGB_WHITE;
}

/* Visit the crossings of the noted objects in order of t; at equal t in written order. */
static Rgb walk_filters(ShadowQuery *query, const Ray *ray, Legs *legs)
{
    Rgb light = RGB_WHITE;
    bool absorbs = plan_has(query->tracer->plan, FEATURE_ABSORPTION);
    if (!list_filters(query, ray))
        return RGB_BLACK;
    while (query->count > 0 && !rgb_is_black(light)) {
        int nearest = nearest_filter(query);
        Filter *filter = &query->filters[nearest];
        const Crossing *crossing = &query->thread->crossed[filter->next++];
        light = rgb_mul(light, crossing_filter(query, crossing, ray));
        if (absorbs)
            light = rgb_mul(light, end_leg(query, filter, crossing, ray, legs));
        if (filter->next == filter->end)
            *filter = query->filters[--query->count];
    }
    return light;
}

/* Return what passes the noted objects. */
static Rgb pass_filters(ShadowQuery *query, const Ray *ray)
{
    Legs legs;
    legs.inside.count = 0;
    legs.since = legs.open = 0;
    Rgb passed = RGB_WHITE;
    if (query->count > 0) {
        query->thread->stats.count[STAT_SHADOW_FILTER_WALKS]++;
        passed = walk_filters(query, ray, &legs);
    }
    if (query->light && plan_has(query->tracer->plan, FEATURE_ABSORPTION))
        passed = rgb_mul(passed, end_last_leg(query, ray, &legs));
    return passed;
}

/* The parts of the distance to the light within which a hit is the light's own surface: the
 * rounding of the light's place, of the direction and of t. */
#define LIGHT_SLACK 0x1p-48

Rgb trace_shadow_of(TraceThread *thread, const ShadowBundle *bundle, const ShapePoint *from, V3 to,
                    double distance, int light, bool blocks_targets)
{
    Ray ray;
    bool is_lifted = trace_lifted_from(from, to, &ray);
    if (!is_lifted)
        ray = trace_ray_from(from, to);
    ray.tmax = distance - distance * LIGHT_SLACK - 8 * from->p_error;
    if (!(ray.tmax > 0))
        return RGB_WHITE;
    thread->stats.count[STAT_SHADOW_RAYS]++;
    thread->stats.count[STAT_AREA_SHADOW_RAYS] += bundle != NULL;
    ShadowQuery query;
    query.thread = thread;
    query.tracer = thread->tracer;
    query.light = light >= 0 ? &thread->tracer->scene->lights[light] : NULL;
    query.light_index = light;
    query.blocks_targets = blocks_targets;
    query.passed = NO_OBJECT;
    query.count = 0;
    query.capacity = FILTERS_FEW;
    query.filters = query.few;
    if (is_still_blocked(&query, &ray, light) ||
        (bundle && bundle->count >= 0
             ? find_in_bundle(&query, &ray, bundle)
             : find_blocker(&query, &ray, is_lifted ? -1 : light, from->p_error))) {
        if (light >= 0)
            thread->blockers[light] = query.blocker;
        return RGB_BLACK;
    }
    Rgb passed = pass_filters(&query, &ray);
    bool is_dimmed = thread->is_dimmed || (query.light && query.light->is_dimmed_by_media);
    if (thread->tracer->media_count > 0 && !rgb_is_black(passed))
        passed = rgb_mul(passed, media_shadow(thread, &ray, is_dimmed));
    return passed;
}

Rgb trace_shadow(TraceThread *thread, const ShapePoint *from, V3 to, double distance, int light,
                 bool blocks_targets)
{
    return trace_shadow_of(thread, NULL, from, to, distance, light, blocks_targets);
}
