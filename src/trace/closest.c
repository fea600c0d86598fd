/* The nearest surface along a ray.
 *
 * Each hit's t is known to within its error.  Hits of several objects that overlap within
 * their errors are one place, and the object written first is what is seen there, whatever
 * order the index offers them in; the error of the place then covers them all, so that a ray
 * leaving it meets none of them again.  SPDX-License-Identifier: Apache-2.0 */
#include "trace/trace_int.h"

/* More objects than this in one place: the first ones stay. */
enum { TIES_MAX = 1 + HIT_TIES_MAX };

/* Hits closer than this many of their errors are one place: a ray that leaves a surface starts
 * somewhat off it, and what lies between must have been met.  Links in a row make a place as
 * large as TIE_LINKS of them at most. */
#define TIE_ERRORS 16.0
#define TIE_LINKS 4.0

/* But no two are that are further apart than this part of t and of where the ray starts, whatever
 * their errors. */
#define TIE_CAP 0x1p-30

typedef struct Candidate {
    Crossing crossing;
    double slack; /* others whose t and slack overlap it are in the same place */
    uint32_t object;
} Candidate;

typedef struct ClosestQuery {
    TraceThread *thread;
    const TracedObject *objects;
    const uint32_t *index_objects;
    RayKind kind;
    double t, slack; /* of the nearest so far */
    double limit;    /* its place reaches no further */
    int count;
    Candidate found[TIES_MAX]; /* all that may be in its place, by object */
} ClosestQuery;

/* Drop what is behind `end`. */
static void drop_far(ClosestQuery *query, double end)
{
    int kept = 0;
    for (int i = 0; i < query->count; i++)
        if (query->found[i].crossing.t - query->found[i].slack <= end)
            query->found[kept++] = query->found[i];
    query->count = kept;
}

/* Keep what is in the place of the nearest hit: linked to it by slacks that overlap. */
static void keep_place(ClosestQuery *query)
{
    double end = query->t + query->slack, before;
    do {
        before = end;
        for (int i = 0; i < query->count; i++) {
            const Candidate *c = &query->found[i];
            if (c->crossing.t - c->slack <= end)
                end = fmax(end, c->crossing.t + c->slack);
        }
    } while (end > before);
    drop_far(query, end);
}

static void insert(ClosestQuery *query, const Crossing *crossing, double slack, uint32_t object)
{
    int at = query->count;
    while (at > 0 && query->found[at - 1].object > object)
        at--;
    if (at == TIES_MAX)
        return;
    if (query->count < TIES_MAX)
        query->count++;
    for (int i = query->count - 1; i > at; i--)
        query->found[i] = query->found[i - 1];
    query->found[at].crossing = *crossing;
    query->found[at].slack = slack;
    query->found[at].object = object;
}

static inline void test_object(ClosestQuery *query, uint32_t object, Ray *ray)
{
    const TracedObject *traced = &query->objects[object];
    Crossing crossing;
    if (traced->is_hidden[query->kind] ||
        !shape_closest(traced->shape, ray, query->thread->shapes, &crossing))
        return;
    double t = crossing.t, slack = TIE_ERRORS * crossing.t_error;
    if (slack > t * TIE_CAP)
        slack = fmin(slack, (t + v3_max_abs(ray->o)) * TIE_CAP);
    bool is_first = query->count == 0 || t + TIE_LINKS * slack < query->t - query->slack;
    if (!is_first && t - slack > query->limit)
        return;
    if (is_first || t < query->t) {
        query->t = t;
        query->slack = slack;
        query->limit = t + TIE_LINKS * slack;
        if (is_first)
            query->count = 0;
        else
            drop_far(query, query->limit);
        /* Far enough to see one in the place whose slack is no larger, and the same t again. */
        double end = query->limit + slack + t * 0x1p-51;
        if (end < ray->tmax)
            ray->tmax = end;
    }
    insert(query, &crossing, slack, object);
}

static bool test_item(void *ctx, uint32_t item, Ray *ray)
{
    ClosestQuery *query = ctx;
    test_object(query, query->index_objects[item], ray);
    return false;
}

/* Hand on the other surfaces in the place, and let its error cover them. */
static void fill_ties(const ClosestQuery *query, const Ray *ray, Hit *out)
{
    ShapePoint *point = &out->point;
    double error = point->p_error;
    out->tie_count = query->count - 1;
    for (int i = 0; i < out->tie_count; i++) {
        const Candidate *other = &query->found[i + 1];
        HitTie *tie = &out->ties[i];
        tie->crossing = other->crossing;
        tie->object = other->object;
        shape_point(&tie->crossing, ray, &tie->point);
        double apart = fabs(v3_dot(v3_sub(tie->point.p, point->p), point->ng));
        error = fmax(error, apart + tie->point.p_error);
    }
    point->p_error = error;
}

static void fill_hit(const ClosestQuery *query, const Ray *ray, Hit *out)
{
    const Crossing *crossing = &query->found[0].crossing;
    const Scene *scene = query->thread->tracer->scene;
    shape_point(crossing, ray, &out->point);
    out->t = crossing->t;
    out->leaf = crossing->leaf;
    out->surface = &scene->surfaces[crossing->leaf->surface];
    out->object = &scene->objects[query->found[0].object];
    out->part = crossing->part;
    out->u = crossing->u;
    out->v = crossing->v;
    out->is_entering = crossing_is_entering(crossing, out->point.ng, ray->d);
    out->is_wall = crossing->leaf_change == 0;
    fill_ties(query, ray, out);
}

/* The view of the ray's origin, if there is one. */
static const ViewIndex *view_of(const Tracer *tracer, const Ray *ray, RayKind kind)
{
    if (kind == RAY_CAMERA)
        return tracer->camera_view && view_is_from(tracer->camera_view, ray->o)
                   ? tracer->camera_view
                   : NULL;
    if (kind != RAY_PHOTON && kind != RAY_LIGHT)
        return NULL;
    for (int i = 0; i < tracer->scene->light_count; i++)
        if (tracer->light_views[i] && view_is_from(tracer->light_views[i], ray->o))
            return tracer->light_views[i];
    return NULL;
}

/* Test the objects of a cell, nearest first; returns false if it does not know them all. */
static bool test_view(ClosestQuery *query, const ViewIndex *view, Ray *ray)
{
    const ViewCell *cell = view_cell(view, ray->d);
    if (cell->count == VIEW_CELL_FULL)
        return false;
    for (uint32_t i = 0; i < cell->count; i++) {
        uint32_t object = cell->object[i];
        if ((double)view->near[object] > ray->tmax)
            break;
        if (!object_is_missed(&query->objects[object], ray))
            test_object(query, object, ray);
    }
    return true;
}

bool trace_closest(TraceThread *thread, const Ray *ray, RayKind kind, Hit *out)
{
    static const StatId counters[RAY_KIND_COUNT] = {STAT_CAMERA_RAYS,    STAT_REFLECTED_RAYS,
                                                    STAT_REFRACTED_RAYS, STAT_PHOTON_RAYS,
                                                    STAT_DIFFUSE_RAYS,   STAT_PHOTON_RAYS};
    const Tracer *tracer = thread->tracer;
    thread->stats.count[counters[kind]]++;
    ClosestQuery query;
    query.thread = thread;
    query.objects = tracer->objects;
    query.index_objects = tracer->index_objects;
    query.kind = kind;
    query.count = 0;
    Ray rest = *ray;
    for (uint32_t i = 0; i < tracer->unbounded_count; i++)
        test_object(&query, tracer->unbounded[i], &rest);
    const ViewIndex *view = view_of(tracer, ray, kind);
    if (tracer->index && !(view && test_view(&query, view, &rest)))
        box_index_closest(tracer->index, &rest, test_item, &query);
    if (query.count == 0)
        return false;
    if (query.count > 1)
        keep_place(&query);
    fill_hit(&query, ray, out);
    return true;
}

bool trace_object(TraceThread *thread, const Ray *ray, uint32_t object, Hit *out)
{
    ClosestQuery query;
    query.thread = thread;
    query.count = 1;
    if (!shape_closest(thread->tracer->objects[object].shape, ray, thread->shapes,
                       &query.found[0].crossing))
        return false;
    query.found[0].object = object;
    fill_hit(&query, ray, out);
    return true;
}

bool tracer_is_opaque_solid(const Tracer *tracer, uint32_t object)
{
    const TracedObject *traced = &tracer->objects[object];
    return traced->is_closed && !traced->may_transmit &&
           !shape_is_inside(traced->shape, tracer->scene->camera.location);
}

/* One error keeps the surface behind the new ray; the other is for rounding the sum. */
#define PUSH 2.0

Ray trace_ray_from(const ShapePoint *point, V3 d)
{
    double push = copysign(PUSH * point->p_error, v3_dot(d, point->ng));
    return (Ray){v3_mad(point->p, push, point->ng), d, 0, INFINITY};
}

bool trace_lifted_from(const ShapePoint *point, V3 d, Ray *out)
{
    double shown = v3_dot(d, point->ns);
    if (!(shown * v3_dot(d, point->ng) < 0) || !(shown * v3_dot(point->lift, point->ns) > 0))
        return false;
    V3 start =
        v3_mad(v3_add(point->p, point->lift), copysign(PUSH * point->p_error, shown), point->ns);
    *out = (Ray){start, d, 0, INFINITY};
    return true;
}
