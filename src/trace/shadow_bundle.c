/* Bundles of shadow rays: from one point to the points of one area light.
 *
 * What is missed by the hull of the point and the light cannot meet any of the rays; most points
 * see nothing between them and the light, and then not one ray need be traced.  Objects near
 * each other are looked at together first.  SPDX-License-Identifier: Apache-2.0 */
#include "trace/trace_int.h"

#include "base/mem.h"
#include "trace/hull.h"

#include <stdlib.h>

/* Objects looked at together when a ball around them is touched. */
enum { GROUP_OBJECTS = 4 };

/* Widens the light by more than the rounding of the places of its points. */
#define WIDER (1 + 1e-9)

/* Objects near each other and a ball around them all.  Groups stand depth first: after one come
 * its parts, and `skip` is where to go on without them. */
typedef struct Group {
    V3 center;
    double radius;
    uint32_t skip;
    uint32_t first, count; /* in BundleIndex.objects; count 0: the group has parts */
} Group;

struct BundleIndex {
    Group *groups;
    uint32_t group_count;
    uint32_t *objects;
};

/* --- grouping ------------------------------------------------------------------------------- */

typedef struct Placed {
    double key;
    uint32_t object;
} Placed;

static int by_key(const void *a, const void *b)
{
    const Placed *x = a, *y = b;
    if (x->key != y->key)
        return x->key < y->key ? -1 : 1;
    return x->object < y->object ? -1 : x->object > y->object;
}

static Group *add_group(BundleIndex *index, const TracedObject *objects, const Placed *items,
                        uint32_t count, const Bound *box)
{
    Group *group = &index->groups[index->group_count++];
    *group = (Group){.center = bound_center(*box)};
    for (uint32_t i = 0; i < count; i++) {
        const TracedObject *object = &objects[items[i].object];
        double reach = v3_dist(group->center, object->center) + object->radius;
        group->radius = fmax(group->radius, reach * WIDER);
    }
    return group;
}

/* Group the items, halving along the longest side of the box of centres until few are left. */
static void build(BundleIndex *index, const TracedObject *objects, Placed *items, uint32_t first,
                  uint32_t count)
{
    Bound box = BOUND_EMPTY;
    for (uint32_t i = 0; i < count; i++)
        box = bound_add(box, objects[items[i].object].center);
    Group *group = add_group(index, objects, items, count, &box);
    if (count <= GROUP_OBJECTS) {
        group->first = first;
        group->count = count;
        for (uint32_t i = 0; i < count; i++)
            index->objects[first + i] = items[i].object;
    } else {
        V3 size = v3_sub(box.hi, box.lo);
        int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        for (uint32_t i = 0; i < count; i++)
            items[i].key = v3_at(objects[items[i].object].center, axis);
        qsort(items, count, sizeof *items, by_key);
        build(index, objects, items, first, count / 2);
        build(index, objects, items + count / 2, first + count / 2, count - count / 2);
    }
    group->skip = index->group_count;
}

BundleIndex *bundle_index_new(const TracedObject *objects, uint32_t object_count)
{
    BundleIndex *index = mem_alloc(sizeof *index);
    Placed *items = mem_array((size_t)object_count + 1, sizeof *items);
    if (index) {
        index->groups = mem_array((size_t)object_count * 2 + 1, sizeof *index->groups);
        index->objects = mem_array((size_t)object_count + 1, sizeof *index->objects);
    }
    if (!index || !items || !index->groups || !index->objects) {
        mem_free(items);
        bundle_index_free(index);
        return NULL;
    }
    uint32_t count = 0;
    for (uint32_t i = 0; i < object_count; i++)
        if (objects[i].shadow != SHADOW_NONE && objects[i].has_ball)
            items[count++].object = i;
    if (count > 0)
        build(index, objects, items, 0, count);
    mem_free(items);
    return index;
}

void bundle_index_free(BundleIndex *index)
{
    if (!index)
        return;
    mem_free(index->groups);
    mem_free(index->objects);
    mem_free(index);
}

/* --- asking --------------------------------------------------------------------------------- */

/* Returns false when the bundle is full. */
static bool note(const TracedObject *objects, uint32_t object, const Hull *hull, ShadowBundle *out)
{
    if (hull_misses_shape(hull, objects[object].shape))
        return true;
    if (out->count == SHADOW_BUNDLE_MAX)
        return false;
    out->object[out->count++] = object;
    return true;
}

static bool note_group(const Tracer *tracer, const Group *group, const Hull *hull,
                       ShadowBundle *out)
{
    for (uint32_t i = 0; i < group->count; i++) {
        uint32_t number = tracer->bundles->objects[group->first + i];
        const TracedObject *object = &tracer->objects[number];
        if (!hull_misses_ball(hull, object->center, object->radius) &&
            !note(tracer->objects, number, hull, out))
            return false;
    }
    return true;
}

static bool note_all(const Tracer *tracer, const Hull *hull, ShadowBundle *out)
{
    const BundleIndex *index = tracer->bundles;
    for (uint32_t i = 0; i < tracer->unbounded_count; i++) {
        uint32_t number = tracer->unbounded[i];
        if (tracer->objects[number].shadow != SHADOW_NONE &&
            !note(tracer->objects, number, hull, out))
            return false;
    }
    for (uint32_t i = 0; i < index->group_count;) {
        const Group *group = &index->groups[i];
        if (hull_misses_ball(hull, group->center, group->radius)) {
            i = group->skip;
            continue;
        }
        if (!note_group(tracer, group, hull, out))
            return false;
        i++;
    }
    return true;
}

void trace_shadow_bundle(const Tracer *tracer, const ShapePoint *from, V3 to_center, double radius,
                         ShadowBundle *out)
{
    double distance = v3_len(to_center);
    out->count = -1;
    radius = radius * WIDER + 1e-9 * distance;
    if (!tracer->bundles || !(radius < distance))
        return;
    /* All rays must leave on one side of the surface: then they start at the same point. */
    double above = fabs(v3_dot(to_center, from->ng));
    if (!(above > radius))
        return;
    double shown = v3_dot(to_center, from->ns), facet = v3_dot(to_center, from->ng);
    if (v3_len2(from->lift) > 0 && !(shown * facet > 0 && fabs(shown) > radius))
        return;
    Hull hull;
    V3 apex = trace_ray_from(from, to_center).o;
    if (!hull_init(&hull, apex, 16 * from->p_error, v3_add(from->p, to_center), radius))
        return;
    out->count = 0;
    if (!note_all(tracer, &hull, out))
        out->count = -1;
}
