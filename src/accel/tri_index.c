/* An index over triangles: Embree, or for a small mesh a tree of ours, finds the
 * boxes of the triangles; the test is ours.  SPDX-License-Identifier: Apache-2.0 */
#include "accel/shear.h"
#include "accel/tri_tree_int.h"

#include "base/mem.h"

#include <assert.h>
#include <stdlib.h>

struct TriIndex {
    IndexFrame frame;
    FrameScene scene; /* of a big mesh */
    TriTree tree;     /* of a small one */
    const V3 *vertices;
    const uint32_t *corners;
    uint32_t count;
};

typedef struct TriQuery {
    struct RTCIntersectContext context; /* first: Embree hands it back */
    const TriIndex *index;
    Shear shear;
    double tmin, tmax;
    TriHit best;
    TriHit *all; /* NULL: only the best */
    int count, capacity;
    FrameRay at;
} TriQuery;

/* Test a triangle and keep the hit; returns whether tmax shrank. */
static bool offer(TriQuery *q, uint32_t triangle)
{
    TriHit hit;
    const uint32_t *c = q->index->corners + 3 * (size_t)triangle;
    const V3 *v = q->index->vertices;
    if (!sheared_test(&q->shear, &v[c[0]], &v[c[1]], &v[c[2]], q->tmin, q->tmax, &hit))
        return false;
    hit.triangle = triangle;
    if (q->all) {
        if (q->count < q->capacity)
            q->all[q->count] = hit;
        q->count++;
        return false;
    }
    if (q->count && (hit.t > q->best.t || (hit.t == q->best.t && triangle > q->best.triangle)))
        return false;
    q->best = hit;
    q->count = 1;
    return true;
}

static void box_of(const TriIndex *index, uint32_t triangle, struct RTCBounds *out)
{
    const uint32_t *c = index->corners + 3 * (size_t)triangle;
    Bound box = BOUND_EMPTY;
    for (int i = 0; i < 3; i++)
        box = bound_add(box, index->vertices[c[i]]);
    frame_box(&index->frame, box, out);
}

static void triangle_bounds(const struct RTCBoundsFunctionArguments *args)
{
    box_of(args->geometryUserPtr, args->primID, args->bounds_o);
}

static float offer_of_tree(void *query, uint32_t triangle, float far)
{
    TriQuery *q = query;
    return offer(q, triangle) ? frame_end(&q->at, q->best.t) : far;
}

static void triangle_intersect(const struct RTCIntersectFunctionNArguments *args)
{
    TriQuery *q = (TriQuery *)args->context;
    assert(args->N == 1);
    if (offer(q, args->primID))
        ((struct RTCRayHit *)args->rayhit)->ray.tfar = frame_end(&q->at, q->best.t);
}

static Status make_tree(Diag *diag, TriIndex *index)
{
    struct RTCBounds *boxes = mem_array(index->count, sizeof *boxes);
    if (!boxes)
        return diag_no_memory(diag, "the index of a mesh");
    for (uint32_t i = 0; i < index->count; i++)
        box_of(index, i, &boxes[i]);
    Status status = tri_tree_init(diag, boxes, index->count, &index->tree);
    mem_free(boxes);
    return status;
}

/* Corner numbers out of range or vertices that are not numbers would break the index. */
static Status check(Diag *diag, const V3 *vertices, uint32_t vertex_count, const uint32_t *corners,
                    uint32_t triangle_count, Bound *all)
{
    *all = BOUND_EMPTY;
    for (size_t i = 0; i < 3 * (size_t)triangle_count; i++) {
        if (corners[i] >= vertex_count)
            return diag_fail(diag, ERR_SCENE, "a triangle of a mesh has corner %u of %u",
                             corners[i], vertex_count);
        if (!v3_is_finite(vertices[corners[i]]))
            return diag_fail(diag, ERR_SCENE, "vertex %u of a mesh is not finite", corners[i]);
        *all = bound_add(*all, vertices[corners[i]]);
    }
    return OK;
}

Status tri_index_new(Diag *diag, const V3 *vertices, uint32_t vertex_count, const uint32_t *corners,
                     uint32_t triangle_count, int threads, TriIndex **out)
{
    *out = NULL;
    Bound all;
    TRY(check(diag, vertices, vertex_count, corners, triangle_count, &all));
    TriIndex *index = mem_alloc(sizeof *index);
    if (!index)
        return diag_no_memory(diag, "the index of a mesh");
    index->vertices = vertices;
    index->corners = corners;
    index->count = triangle_count;
    *out = index;
    if (triangle_count == 0)
        return OK;
    index->frame = frame_of(all);
    static const FrameCallbacks calls = {triangle_bounds, triangle_intersect, NULL};
    Status status = triangle_count <= TRI_TREE_MAX ? make_tree(diag, index)
                                                   : frame_scene_new(diag, triangle_count, threads,
                                                                     &calls, index, &index->scene);
    if (status != OK) {
        tri_index_free(index);
        *out = NULL;
    }
    return status;
}

void tri_index_free(TriIndex *index)
{
    if (!index)
        return;
    frame_scene_done(&index->scene);
    tri_tree_done(&index->tree);
    mem_free(index);
}

/* Run a query whose kind of result is set up; results are in it. */
static void run(const TriIndex *index, const Ray *ray, TriQuery *q)
{
    if (index->count == 0 || !frame_enter(&index->frame, ray, &q->at))
        return;
    q->index = index;
    q->tmin = ray->tmin;
    q->tmax = ray->tmax;
    /* The arithmetic depends on the line alone, not on the part asked for: who walks along a
     * line from hit to hit gets the same t for a triangle every time, and never meets it twice. */
    shear_init(&q->shear, ray, q->at.line_start);
    if (index->tree.nodes) {
        tri_tree_walk(&index->tree, &q->at.hit.ray, offer_of_tree, q);
        return;
    }
    rtcInitIntersectContext(&q->context);
    rtcIntersect1(index->scene.scene, &q->context, &q->at.hit);
}

bool tri_index_closest(const TriIndex *index, const Ray *ray, TriHit *out)
{
    TriQuery q = {0};
    run(index, ray, &q);
    if (q.count)
        *out = q.best;
    return q.count > 0;
}

bool tri_test(const V3 corner[3], const Ray *ray, TriHit *out)
{
    Shear shear;
    shear_init(&shear, ray, 0);
    out->triangle = 0;
    return sheared_test(&shear, &corner[0], &corner[1], &corner[2], ray->tmin, ray->tmax, out);
}

bool loops_hold(const V3 *points, const uint32_t *next, uint32_t count, const Ray *ray)
{
    Shear shear;
    bool is_inside = false;
    shear_init(&shear, ray, 0);
    for (uint32_t i = 0; i < count; i++) {
        Sheared a = shear_point(&shear, points[i]), b = shear_point(&shear, points[next[i]]);
        /* The ray is moved a little up, too: a point at its height is below it. */
        bool is_up = b.y > 0;
        if ((a.y > 0) != is_up)
            is_inside ^= shear_is_left(shear_edge(a, b), a, b) == is_up;
    }
    return is_inside;
}

static int compare_hits(const void *a, const void *b)
{
    const TriHit *p = a, *q = b;
    if (p->t != q->t)
        return p->t < q->t ? -1 : 1;
    return (p->triangle > q->triangle) - (p->triangle < q->triangle);
}

int tri_index_all(const TriIndex *index, const Ray *ray, TriHit *out, int capacity)
{
    TriHit none;
    TriQuery q = {.all = capacity > 0 ? out : &none, .capacity = capacity};
    run(index, ray, &q);
    int kept = q.count < capacity ? q.count : capacity;
    if (kept > 1)
        qsort(out, (size_t)kept, sizeof *out, compare_hits);
    return q.count;
}
