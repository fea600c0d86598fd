/* The interiors a ray is in, and how they change at a surface.
 *
 * The language pairs entering and leaving by object.  For objects made of closed solids the
 * normal says which it is, so that a missed entry (a light or an eye on the surface, surfaces
 * that coincide) is mended at the exit; for open ones, whose normals say little, a ray enters
 * what it is not in and leaves what it is in.  SPDX-License-Identifier: Apache-2.0 */
#include "trace/trace_int.h"

/* Find the innermost entry of an object, preferring the same interior; -1: none. */
static int entry_of(const Interiors *list, uint32_t object, const Interior *interior)
{
    int found = -1;
    for (int i = list->count - 1; i >= 0; i--) {
        if (list->object[i] != object)
            continue;
        if (list->in[i] == interior)
            return i;
        if (found < 0)
            found = i;
    }
    return found;
}

static double innermost_ior(const Interiors *list)
{
    return list->count > 0 ? list->in[list->count - 1]->ior : 1;
}

/* When the list is full the outermost entry goes. */
static void push(Interiors *list, const Interior *interior, uint32_t object)
{
    if (list->count == INTERIORS_MAX) {
        list->count--;
        for (int i = 0; i < list->count; i++) {
            list->in[i] = list->in[i + 1];
            list->object[i] = list->object[i + 1];
        }
    }
    list->in[list->count] = interior;
    list->object[list->count++] = object;
}

static void drop(Interiors *list, int entry)
{
    list->count--;
    for (int i = entry; i < list->count; i++) {
        list->in[i] = list->in[i + 1];
        list->object[i] = list->object[i + 1];
    }
}

/* Copy the used part only. */
static void copy(Interiors *to, const Interiors *from)
{
    to->count = from->count;
    for (int i = 0; i < from->count; i++) {
        to->in[i] = from->in[i];
        to->object[i] = from->object[i];
    }
}

InteriorStep interiors_pass(const Tracer *tracer, const Passage *passages, int count,
                            const Interiors *before, Interiors *after)
{
    InteriorStep step = {.ior_from = innermost_ior(before)};
    bool is_entered[PASSAGES_MAX];
    copy(after, before);
    for (int i = 0; i < count; i++) {
        const Passage *passage = &passages[i];
        bool is_closed = tracer->objects[passage->object].is_closed;
        is_entered[i] = false;
        if (is_closed && passage->is_wall)
            continue;
        int entry = entry_of(after, passage->object, passage->interior);
        is_entered[i] = is_closed ? passage->is_entering : entry < 0;
        if (is_entered[i])
            continue;
        if (entry >= 0)
            drop(after, entry);
        else
            step.ior_from = passage->interior->ior;
    }
    for (int i = 0; i < count; i++)
        if (is_entered[i])
            push(after, passages[i].interior, passages[i].object);
    step.ior_to = innermost_ior(after);
    return step;
}

Rgb interiors_fade(const Interiors *inside, double t)
{
    return inside->count > 0 ? interior_fade(inside->in[inside->count - 1], t, false) : RGB_WHITE;
}

/* Find the leaf that lends its interior to a point inside a shape: the first child that holds
 * it, in an intersection one that was not inverted. */
static const Shape *leaf_around(const Shape *shape, V3 p)
{
    while (shape->child_count > 0) {
        const Shape *next = shape->children[0];
        for (int i = 0; i < shape->child_count; i++) {
            const Shape *child = shape->children[i];
            if (!child->is_inverted && shape_is_inside(child, p)) {
                next = child;
                break;
            }
        }
        shape = next;
    }
    return shape;
}

/* Volumes order the list: what is inside is smaller. */
static double volume(const Object *object)
{
    if (!bound_is_finite(object->bound) || object->shape->is_inverted)
        return INFINITY;
    V3 size = v3_sub(object->bound.hi, object->bound.lo);
    return size.x * size.y * size.z;
}

void interiors_at(const Tracer *tracer, V3 p, Interiors *out)
{
    double volumes[INTERIORS_MAX];
    out->count = 0;
    for (uint32_t k = 0; k < tracer->clear_count && out->count < INTERIORS_MAX; k++) {
        uint32_t i = tracer->clear[k];
        const Object *object = &tracer->scene->objects[i];
        if (!shape_is_inside(object->shape, p))
            continue;
        double size = volume(object);
        int at = out->count;
        while (at > 0 && volumes[at - 1] < size)
            at--;
        for (int j = out->count++; j > at; j--) {
            volumes[j] = volumes[j - 1];
            out->in[j] = out->in[j - 1];
            out->object[j] = out->object[j - 1];
        }
        const Shape *leaf = leaf_around(object->shape, p);
        volumes[at] = size;
        out->in[at] = tracer->scene->surfaces[leaf->surface].interior;
        out->object[at] = i;
    }
}
