/* The interiors a ray is in, and how they change at a surface.
 *
 * The language pairs entering and leaving by object.  For objects made of closed solids the
 * normal says which it is, so that a missed entry (a light or an eye on the surface, surfaces
 * that coincide) is mended at the exit; for open ones, whose normals say little, a ray enters
 * what it is not in and leaves what it is in.
 *
 * Where interiors overlap, one of the highest priority counts; of these the one entered last, as
 * in the language.  So a ray meets one interface between two media, wherever in the overlap it is.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/trace_int.h"

#include "math/eps.h"
#include "math/spectrum.h"

#include <string.h>

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

/* What a ray is in; NULL: the open. */
static const Interior *innermost(const Interiors *list)
{
    return list->count > 0 ? list->in[list->count - 1] : NULL;
}

static void drop(Interiors *list, int entry)
{
    list->count--;
    for (int i = entry; i < list->count; i++) {
        list->in[i] = list->in[i + 1];
        list->object[i] = list->object[i + 1];
    }
}

/* Add an entry behind those of its priority.  When the list is full the outermost goes. */
void interiors_enter(Interiors *list, const Interior *interior, uint32_t object)
{
    if (list->count == INTERIORS_MAX) {
        drop(list, 0);
        list->left_out++;
    }
    int at = list->count++;
    for (; at > 0 && list->in[at - 1]->priority > interior->priority; at--) {
        list->in[at] = list->in[at - 1];
        list->object[at] = list->object[at - 1];
    }
    list->in[at] = interior;
    list->object[at] = object;
}

bool interiors_leave(Interiors *list, const Interior *interior, uint32_t object)
{
    int entry = entry_of(list, object, interior);
    if (entry >= 0)
        drop(list, entry);
    return entry >= 0;
}

static double ior_of(const Interior *interior, double wavelength)
{
    return interior ? interior_ior(interior, wavelength) : 1;
}

static int bands_of(const Interior *interior)
{
    bool disperses = interior && interior->dispersion != DISPERSION_NONE;
    return disperses ? interior->dispersion_samples : 0;
}

static double ratio_of(const Interior *from, const Interior *to, double wavelength)
{
    return ior_of(from, wavelength) / ior_of(to, wavelength);
}

/* Set what depends on the wavelength. */
static void disperse(const Interior *from, const Interior *to, double wavelength,
                     InteriorStep *step)
{
    int from_bands = bands_of(from), to_bands = bands_of(to);
    int bands = from_bands > to_bands ? from_bands : to_bands;
    if (bands == 0 || from == to)
        return;
    if (wavelength > 0) {
        step->ior_from = ior_of(from, wavelength);
        step->ior_to = ior_of(to, wavelength);
        return;
    }
    double first = ratio_of(from, to, SPECTRUM_FIRST), last = ratio_of(from, to, SPECTRUM_LAST);
    if (fabs(first - last) > EPS_LANGUAGE * last)
        step->spectrum = bands;
}

/* Leave what a passage leaves; returns whether it enters something instead.  *from: what the ray
 * is in; if it was in what it leaves without having entered it, that. */
static bool leave(const Tracer *tracer, const Passage *passage, Interiors *list,
                  const Interior **from)
{
    bool is_closed = tracer->objects[passage->object].is_closed;
    if (is_closed && passage->is_wall)
        return false;
    if (is_closed && passage->is_entering)
        return true;
    if (interiors_leave(list, passage->interior, passage->object))
        return false;
    if (!is_closed)
        return true;
    if (list->left_out > 0) /* it may be one of these */
        list->left_out--;
    if (!*from || (*from)->priority <= passage->interior->priority)
        *from = passage->interior;
    return false;
}

InteriorStep interiors_pass(const Tracer *tracer, const Passage *passages, int count,
                            const Interiors *before, Interiors *after)
{
    const Interior *from = innermost(before);
    bool is_entered[PASSAGES_MAX];
    interiors_copy(after, before);
    for (int i = 0; i < count; i++)
        is_entered[i] = leave(tracer, &passages[i], after, &from);
    for (int i = 0; i < count; i++)
        if (is_entered[i])
            interiors_enter(after, passages[i].interior, passages[i].object);
    const Interior *to = innermost(after);
    InteriorStep step = {.ior_from = from ? from->ior : 1, .ior_to = to ? to->ior : 1};
    if (tracer->has_dispersion)
        disperse(from, to, (double)before->wavelength, &step);
    return step;
}

/* Has a member of an intersection been turned inside out, to cut the others? */
static bool is_cutter(const Shape *shape)
{
    return shape->child_count > 0 ? shape->is_inside_beyond : shape->is_inverted;
}

/* Find the leaf that lends its interior to a point inside a shape: the first child that holds
 * it, in an intersection one that was not inverted. */
static const Shape *leaf_around(const Shape *shape, V3 p)
{
    while (shape->child_count > 0) {
        const Shape *next = shape->children[0];
        for (int i = 0; i < shape->child_count; i++) {
            const Shape *child = shape->children[i];
            if (!is_cutter(child) && shape_is_inside(child, p)) {
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
    if (!bound_is_finite(object->bound) || object->shape->is_inside_beyond)
        return INFINITY;
    V3 size = v3_sub(object->bound.hi, object->bound.lo);
    return size.x * size.y * size.z;
}

/* Does one of this interior and volume lie around another one? */
static bool is_around(const Interior *a, double a_volume, const Interior *b, double b_volume)
{
    return a->priority != b->priority ? a->priority < b->priority : a_volume > b_volume;
}

/* Make room in a full list for an interior: the outermost goes.  False: it is that itself. */
static bool make_room(Interiors *list, double volumes[INTERIORS_MAX], const Interior *interior,
                      double size)
{
    if (list->count < INTERIORS_MAX)
        return true;
    list->left_out++;
    if (is_around(interior, size, list->in[0], volumes[0]))
        return false;
    drop(list, 0);
    memmove(volumes, volumes + 1, (INTERIORS_MAX - 1) * sizeof *volumes);
    return true;
}

void interiors_at(const Tracer *tracer, V3 p, Interiors *out)
{
    double volumes[INTERIORS_MAX];
    out->count = 0;
    out->wavelength = 0;
    out->left_out = 0;
    out->is_clear = plan_forbids(tracer->plan, FEATURE_ABSORPTION);
    for (uint32_t k = 0; k < tracer->clear_count; k++) {
        uint32_t i = tracer->clear[k];
        const Object *object = &tracer->scene->objects[i];
        if (!shape_is_inside(object->shape, p))
            continue;
        const Shape *leaf = leaf_around(object->shape, p);
        const Interior *interior = tracer->scene->surfaces[leaf->surface].interior;
        double size = volume(object);
        if (!make_room(out, volumes, interior, size))
            continue;
        int at = out->count++;
        for (; at > 0 && is_around(interior, size, out->in[at - 1], volumes[at - 1]); at--) {
            volumes[at] = volumes[at - 1];
            out->in[at] = out->in[at - 1];
            out->object[at] = out->object[at - 1];
        }
        volumes[at] = size;
        out->in[at] = interior;
        out->object[at] = i;
    }
}
