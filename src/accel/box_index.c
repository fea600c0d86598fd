/* An index over boxes: Embree finds the boxes, the caller's test finds the hits.
 *
 * Few items are tried one after another, nearest first: that is faster than a tree.
 * SPDX-License-Identifier: Apache-2.0 */
#include "accel/frame_int.h"

#include "base/mem.h"

#include <assert.h>

/* Up to this many items no tree is made. */
enum { LIST_MAX = 6 };

struct BoxIndex {
    IndexFrame frame;
    FrameScene scene;
    Bound *boxes; /* of the items that have one, in item order */
    uint32_t *items;
    uint32_t count;
};

typedef struct BoxQuery {
    struct RTCIntersectContext context; /* first: Embree hands it back */
    const BoxIndex *index;
    AccelTest test;
    void *query;
    Ray *ray;
    FrameRay at;
    bool is_found; /* an any query has its answer */
} BoxQuery;

static void box_bounds(const struct RTCBoundsFunctionArguments *args)
{
    const BoxIndex *index = args->geometryUserPtr;
    frame_box(&index->frame, index->boxes[args->primID], args->bounds_o);
}

static void box_intersect(const struct RTCIntersectFunctionNArguments *args)
{
    BoxQuery *q = (BoxQuery *)args->context;
    assert(args->N == 1);
    double before = q->ray->tmax;
    q->test(q->query, q->index->items[args->primID], q->ray);
    if (q->ray->tmax < before)
        ((struct RTCRayHit *)args->rayhit)->ray.tfar = frame_end(&q->at, q->ray->tmax);
}

static void box_occluded(const struct RTCOccludedFunctionNArguments *args)
{
    BoxQuery *q = (BoxQuery *)args->context;
    struct RTCRay *ray = (struct RTCRay *)args->ray;
    assert(args->N == 1);
    q->is_found = q->test(q->query, q->index->items[args->primID], q->ray);
    /* Minus infinity is Embree's sign for: occluded. */
    ray->tfar = q->is_found ? -INFINITY : frame_end(&q->at, q->ray->tmax);
}

static Status build(BoxIndex *index, Diag *diag, int threads)
{
    Bound all = BOUND_EMPTY;
    for (uint32_t i = 0; i < index->count; i++)
        all = bound_union(all, index->boxes[i]);
    index->frame = frame_of(all);
    static const FrameCallbacks calls = {box_bounds, box_intersect, box_occluded};
    if (index->count <= LIST_MAX)
        return OK;
    return frame_scene_new(diag, index->count, threads, &calls, index, &index->scene);
}

Status box_index_new(Diag *diag, const Bound *boxes, uint32_t count, int threads, BoxIndex **out)
{
    *out = NULL;
    BoxIndex *index = mem_alloc(sizeof *index);
    if (!index)
        return diag_no_memory(diag, "the ray index");
    index->boxes = mem_array(count, sizeof *index->boxes);
    index->items = mem_array(count, sizeof *index->items);
    if (!index->boxes || !index->items) {
        box_index_free(index);
        return diag_no_memory(diag, "the ray index");
    }
    for (uint32_t i = 0; i < count; i++) {
        if (bound_is_empty(boxes[i]))
            continue;
        assert(bound_is_finite(boxes[i]));
        index->boxes[index->count] = boxes[i];
        index->items[index->count++] = i;
    }
    Status status = build(index, diag, threads);
    if (status == OK)
        *out = index;
    else
        box_index_free(index);
    return status;
}

void box_index_free(BoxIndex *index)
{
    if (!index)
        return;
    frame_scene_done(&index->scene);
    mem_free(index->boxes);
    mem_free(index->items);
    mem_free(index);
}

/* Where a ray enters a box, or infinity.  Conservative: t may be a few ulps early. */
static double box_entry(const Bound *b, const Ray *ray, V3 inverse)
{
    double near = ray->tmin, far = ray->tmax;
    const double slack = 1 + 8 * EPS_DOUBLE;
#define SLAB(axis)                                                                                 \
    if (ray->d.axis != 0) {                                                                        \
        double t0 = (b->lo.axis - ray->o.axis) * inverse.axis;                                     \
        double t1 = (b->hi.axis - ray->o.axis) * inverse.axis;                                     \
        double first = t0 < t1 ? t0 : t1, last = t0 < t1 ? t1 : t0;                                \
        first = first < 0 ? first * slack : first * (2 - slack);                                   \
        last = last < 0 ? last * (2 - slack) : last * slack;                                       \
        near = first > near ? first : near;                                                        \
        far = last < far ? last : far;                                                             \
    } else if (ray->o.axis < b->lo.axis || ray->o.axis > b->hi.axis) {                             \
        return INFINITY;                                                                           \
    }
    SLAB(x)
    SLAB(y)
    SLAB(z)
#undef SLAB
    return near <= far ? near : INFINITY;
}

/* Try the items of a short list, nearest first. */
static bool list_query(const BoxIndex *index, Ray *ray, AccelTest test, void *query, bool is_any)
{
    double entry[LIST_MAX];
    uint32_t order[LIST_MAX], count = 0;
    V3 inverse = v3(1 / ray->d.x, 1 / ray->d.y, 1 / ray->d.z);
    for (uint32_t i = 0; i < index->count; i++) {
        double t = box_entry(&index->boxes[i], ray, inverse);
        if (!(t < INFINITY))
            continue;
        uint32_t place = count++;
        for (; place > 0 && entry[place - 1] > t; place--) {
            entry[place] = entry[place - 1];
            order[place] = order[place - 1];
        }
        entry[place] = t;
        order[place] = i;
    }
    for (uint32_t i = 0; i < count && entry[i] <= ray->tmax; i++)
        if (test(query, index->items[order[i]], ray) && is_any)
            return true;
    return false;
}

void box_index_closest(const BoxIndex *index, Ray *ray, AccelTest test, void *query)
{
    if (!index->scene.scene) {
        list_query(index, ray, test, query, false);
        return;
    }
    BoxQuery q = {.index = index, .test = test, .query = query, .ray = ray};
    if (!frame_enter(&index->frame, ray, &q.at))
        return;
    rtcInitIntersectContext(&q.context);
    rtcIntersect1(index->scene.scene, &q.context, &q.at.hit);
}

bool box_index_any(const BoxIndex *index, Ray *ray, AccelTest test, void *query)
{
    if (!index->scene.scene)
        return list_query(index, ray, test, query, true);
    BoxQuery q = {.index = index, .test = test, .query = query, .ray = ray};
    if (!frame_enter(&index->frame, ray, &q.at))
        return false;
    rtcInitIntersectContext(&q.context);
    rtcOccluded1(index->scene.scene, &q.context, &q.at.hit.ray);
    return q.is_found;
}
