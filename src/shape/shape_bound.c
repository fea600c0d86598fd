/* Boxes around shapes.
 *
 * Two boxes matter: one around what can be seen (shape_bound, for the ray index), and one around
 * every crossing, seen or not (the reach), beyond which all is inside or all outside; a line
 * that misses it needs no list.  SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape_int.h"

#include <string.h>

/* Narrow `box` to the reach of what all `parts` must contain; returns false if one of them is
 * not inside beyond its reach, and then the box is as narrow as they say. */
static void narrow_to(Shape *const *parts, int count, Bound *box, bool *is_inside_beyond)
{
    for (int i = 0; i < count; i++) {
        bool beyond;
        Bound reach = shape_reach(parts[i], &beyond);
        if (!beyond)
            *box = bound_intersect(*box, reach);
        *is_inside_beyond &= beyond;
    }
}

static Bound intersection_reach(const Shape *shape, bool *is_inside_beyond)
{
    Bound box = BOUND_ALL, all = BOUND_EMPTY;
    *is_inside_beyond = true;
    narrow_to(shape->children, shape->child_count, &box, is_inside_beyond);
    if (!*is_inside_beyond)
        return box;
    for (int i = 0; i < shape->child_count; i++) {
        bool beyond;
        all = bound_union(all, shape_reach(shape->children[i], &beyond));
    }
    return all;
}

static Bound union_reach(const Shape *shape, bool *is_inside_beyond)
{
    Bound all = BOUND_EMPTY;
    *is_inside_beyond = false;
    for (int i = 0; i < shape->child_count; i++) {
        bool beyond;
        all = bound_union(all, shape_reach(shape->children[i], &beyond));
        *is_inside_beyond |= beyond;
    }
    return all;
}

static Bound plane_reach(const Shape *shape)
{
    PlaneParams plane = shape->u.plane;
    if (shape->is_inverted) {
        plane.normal = v3_neg(plane.normal);
        plane.distance = -plane.distance;
    }
    return plane_inside_bound(&plane);
}

/* Does a leaf have an inside beyond the box of what is seen of it? */
static bool is_endless(const Shape *leaf)
{
    return leaf->kind == SHAPE_DISC || leaf->kind == SHAPE_HEIGHT_FIELD;
}

Bound shape_reach(const Shape *shape, bool *is_inside_beyond)
{
    *is_inside_beyond = shape->is_inside_beyond;
    if (shape->is_finished)
        return shape->reach;
    Bound box;
    if (shape->kind == SHAPE_INTERSECTION)
        box = intersection_reach(shape, is_inside_beyond);
    else if (shape->kind >= SHAPE_UNION)
        box = union_reach(shape, is_inside_beyond);
    else
        box = is_endless(shape) ? BOUND_ALL : shape_ops(shape)->bound(shape);
    if (shape->kind == SHAPE_PLANE) /* half the world: nothing beyond is inside */
        box = plane_reach(shape);
    else if (shape->is_inverted)
        *is_inside_beyond = !*is_inside_beyond;
    bool is_inside = *is_inside_beyond;
    Bound clipped = box;
    narrow_to(shape->clips, shape->clip_count, &clipped, is_inside_beyond);
    if (is_inside && shape->clip_count) {
        /* All of the world but a hole: what is left of it by the clips. */
        Bound world = BOUND_ALL;
        bool beyond = true;
        narrow_to(shape->clips, shape->clip_count, &world, &beyond);
        return beyond ? BOUND_ALL : world;
    }
    return clipped;
}

Bound shape_bound(const Shape *shape)
{
    bool beyond;
    Bound seen = BOUND_EMPTY, reach = shape_reach(shape, &beyond);
    if (shape->kind < SHAPE_UNION)
        return bound_intersect(shape_ops(shape)->bound(shape), reach);
    for (int i = 0; i < shape->child_count; i++)
        seen = bound_union(seen, shape_bound(shape->children[i]));
    return bound_intersect(seen, reach);
}

/* Cut [near, far] to a slab.  A line along the slab has an infinite inverse: then the t are
 * infinite too, or, on a side, no numbers, and cut nothing. */
#define CUT(axis)                                                                                  \
    do {                                                                                           \
        bool is_back = line->inverse.axis < 0;                                                     \
        double first = ((is_back ? box->hi.axis : box->lo.axis) - o.axis) * line->inverse.axis;    \
        double last = ((is_back ? box->lo.axis : box->hi.axis) - o.axis) * line->inverse.axis;     \
        near = first > near ? first : near;                                                        \
        far = last < far ? last : far;                                                             \
    } while (0)

bool line_cut(Line *line, const Bound *box)
{
    V3 o = line->ray->o;
    double near = line->near, far = line->far;
    CUT(x);
    CUT(y);
    CUT(z);
    near = earlier(near);
    far = -earlier(-far);
    if (near > far)
        return false;
    line->near = near;
    line->far = far;
    return true;
}
#undef CUT

void block_cut(const BoxBlock *b, const Line *line, BlockCut *out)
{
    const double o[3] = {line->ray->o.x, line->ray->o.y, line->ray->o.z};
    const double inverse[3] = {line->inverse.x, line->inverse.y, line->inverse.z};
    const Lanes zero = {0};
    Lanes near = zero + line->near, far = zero + line->far;
    for (int axis = 0; axis < 3; axis++) {
        bool is_back = inverse[axis] < 0;
        Lanes first, last;
        memcpy(&first, is_back ? b->hi[axis] : b->lo[axis], sizeof first);
        memcpy(&last, is_back ? b->lo[axis] : b->hi[axis], sizeof last);
        first = (first - o[axis]) * inverse[axis];
        last = (last - o[axis]) * inverse[axis];
        near = LANES_PICK(first > near, first, near);
        far = LANES_PICK(last < far, last, far);
    }
    /* The t are exact to a few of their own ulps. */
    const double slack = 8 * EPS_DOUBLE;
    near *= LANES_PICK(near < zero, zero + (1 + slack), zero + (1 - slack));
    far *= LANES_PICK(far < zero, zero + (1 - slack), zero + (1 + slack));
    memcpy(out->near, &near, sizeof near);
    memcpy(out->far, &far, sizeof far);
}
