/* Hulls and shapes.
 *
 * A convex shape is missed when some plane has it on one side and the hull on the other, or when
 * the hull lies within it; CSG asks its members.  Where the apex is compared with a shape there
 * is no slack: it was pushed off its own surface by more than the rounding of that surface, and
 * the test of a single ray would compare the same numbers.  SPDX-License-Identifier: Apache-2.0 */
#include "trace/hull.h"

#include "shape/mesh.h"

/* Slack of the far end, by the size of the numbers: far above their rounding. */
#define FAR_SLACK 1e-9

/* Nested nodes looked into; what is deeper counts as touched. */
enum { HULL_DEPTH_MAX = 8 };

/* Where a hull is with respect to a solid.  Inside and outside it meets no surface. */
typedef enum Side { SIDE_OUTSIDE, SIDE_INSIDE, SIDE_TOUCHES } Side;

bool hull_init(Hull *hull, V3 apex, double apex_error, V3 center, double radius)
{
    V3 to = v3_sub(center, apex);
    double distance = v3_len(to);
    hull->apex = apex;
    hull->center = center;
    hull->radius = radius + FAR_SLACK * (radius + v3_max_abs(center) + v3_max_abs(apex));
    if (!(hull->radius < distance))
        return false;
    hull->axis = v3_scale(to, 1 / distance);
    hull->length = distance + hull->radius;
    hull->sine = hull->radius / distance;
    hull->cosine = sqrt(1 - hull->sine * hull->sine);
    hull->slack = apex_error;
    return true;
}

/* --- leaves --------------------------------------------------------------------------------- */

/* A hull in the space of a leaf. */
typedef struct LocalHull {
    V3 apex, center;
    V3 reach; /* how far the far ball extends along each axis */
} LocalHull;

static double row_length(const double row[4])
{
    return sqrt(row[0] * row[0] + row[1] * row[1] + row[2] * row[2]);
}

static void to_local(const Hull *hull, const Shape *shape, LocalHull *out)
{
    double r = hull->radius;
    if (!shape->is_transformed) {
        *out = (LocalHull){hull->apex, hull->center, v3(r, r, r)};
        return;
    }
    const double(*from)[4] = shape->xform.from;
    out->apex = xform_point_back(&shape->xform, hull->apex);
    out->center = xform_point_back(&shape->xform, hull->center);
    double slack = FAR_SLACK * (v3_max_abs(out->apex) + v3_max_abs(out->center));
    out->reach = v3(r * row_length(from[0]) + slack, r * row_length(from[1]) + slack,
                    r * row_length(from[2]) + slack);
}

/* Which side of the slab a..b along one axis. */
static Side slab_side(double apex, double center, double reach, double a, double b)
{
    if ((apex > b && center - reach > b) || (apex < a && center + reach < a))
        return SIDE_OUTSIDE;
    bool is_inside = apex > a && apex < b && center - reach > a && center + reach < b;
    return is_inside ? SIDE_INSIDE : SIDE_TOUCHES;
}

static Side box_side(const LocalHull *h, V3 lo, V3 hi)
{
    Side x = slab_side(h->apex.x, h->center.x, h->reach.x, lo.x, hi.x);
    Side y = slab_side(h->apex.y, h->center.y, h->reach.y, lo.y, hi.y);
    Side z = slab_side(h->apex.z, h->center.z, h->reach.z, lo.z, hi.z);
    if (x == SIDE_OUTSIDE || y == SIDE_OUTSIDE || z == SIDE_OUTSIDE)
        return SIDE_OUTSIDE;
    return x == SIDE_INSIDE && y == SIDE_INSIDE && z == SIDE_INSIDE ? SIDE_INSIDE : SIDE_TOUCHES;
}

/* The box around a shape that does not fill it: to be inside the box says nothing. */
static Side around_side(const LocalHull *h, V3 lo, V3 hi)
{
    return box_side(h, lo, hi) == SIDE_OUTSIDE ? SIDE_OUTSIDE : SIDE_TOUCHES;
}

static Side sphere_side(const LocalHull *h, const SphereParams *sphere)
{
    double r2 = sphere->radius * sphere->radius, reach = v3_len(h->reach);
    V3 apex = v3_sub(h->apex, sphere->center), end = v3_sub(h->center, sphere->center);
    double near2 = v3_len2(apex), far = v3_len(end) + reach;
    if (near2 < r2)
        return far * far * (1 + FAR_SLACK) < r2 ? SIDE_INSIDE : SIDE_TOUCHES;
    /* Does the plane through the apex, square to the way to the centre, have all on its side? */
    double above = v3_dot(apex, end) - reach * sqrt(near2);
    return near2 > r2 && above > near2 * (1 + FAR_SLACK) ? SIDE_OUTSIDE : SIDE_TOUCHES;
}

static Side plane_side(const Hull *hull, const PlaneParams *plane)
{
    double apex = v3_dot(plane->normal, hull->apex) - plane->distance;
    double end = v3_dot(plane->normal, hull->center) - plane->distance;
    double room = hull->radius + FAR_SLACK * fabs(plane->distance);
    if (apex > 0 && end > room)
        return SIDE_OUTSIDE;
    return apex < 0 && end < -room ? SIDE_INSIDE : SIDE_TOUCHES;
}

static Side cone_side(const LocalHull *h, const ConeParams *cone)
{
    double r = fmax(cone->bottom, cone->top);
    return around_side(h, v3(-r, -r, 0), v3(r, r, cone->height));
}

static Side torus_side(const LocalHull *h, const TorusParams *torus)
{
    double r = torus->major + torus->minor;
    return around_side(h, v3(-r, -torus->minor, -r), v3(r, torus->minor, r));
}

/* As a member of CSG a disc is the half space under its plane. */
static Side disc_side(const LocalHull *h)
{
    if (h->apex.z > 0 && h->center.z - h->reach.z > 0)
        return SIDE_OUTSIDE;
    return h->apex.z < 0 && h->center.z + h->reach.z < 0 ? SIDE_INSIDE : SIDE_TOUCHES;
}

static Side world_box_side(const Hull *hull, const Shape *shape)
{
    double r = hull->radius;
    LocalHull world = {hull->apex, hull->center, v3(r, r, r)};
    Bound box = shape_bound(shape);
    return around_side(&world, box.lo, box.hi);
}

static Side leaf_side(const Hull *hull, const Shape *shape)
{
    if (shape->kind == SHAPE_PLANE)
        return plane_side(hull, &shape->u.plane);
    if (shape->kind == SHAPE_SPHERE && !shape->is_transformed &&
        hull_misses_ball(hull, shape->u.sphere.center, shape->u.sphere.radius))
        return SIDE_OUTSIDE;
    LocalHull local;
    to_local(hull, shape, &local);
    switch (shape->kind) {
    case SHAPE_SPHERE:
        return sphere_side(&local, &shape->u.sphere);
    case SHAPE_BOX:
        return box_side(&local, shape->u.box.lo, shape->u.box.hi);
    case SHAPE_CONE:
        return cone_side(&local, &shape->u.cone);
    case SHAPE_TORUS:
        return torus_side(&local, &shape->u.torus);
    case SHAPE_DISC:
        return disc_side(&local);
    case SHAPE_MESH:
        return around_side(&local, shape->u.mesh->bound.lo, shape->u.mesh->bound.hi);
    case SHAPE_HEIGHT_FIELD: /* as a member of CSG it has no end below */
        return SIDE_TOUCHES;
    default:
        return world_box_side(hull, shape);
    }
}

/* --- trees of shapes ------------------------------------------------------------------------ */

static Side shape_side(const Hull *hull, const Shape *shape, int depth);

/* Outside one is outside all; inside all is inside. */
static Side side_of_all(const Hull *hull, Shape *const *parts, int count, int depth)
{
    Side sum = SIDE_INSIDE;
    for (int i = 0; i < count; i++) {
        Side side = shape_side(hull, parts[i], depth);
        if (side == SIDE_OUTSIDE)
            return SIDE_OUTSIDE;
        if (side == SIDE_TOUCHES)
            sum = SIDE_TOUCHES;
    }
    return sum;
}

/* No part may be touched: a union keeps the surfaces inside it. */
static Side side_of_any(const Hull *hull, Shape *const *parts, int count, int depth)
{
    Side sum = SIDE_OUTSIDE;
    for (int i = 0; i < count; i++) {
        Side side = shape_side(hull, parts[i], depth);
        if (side == SIDE_TOUCHES)
            return SIDE_TOUCHES;
        if (side == SIDE_INSIDE)
            sum = SIDE_INSIDE;
    }
    return sum;
}

static Side opposite(Side side)
{
    return side == SIDE_TOUCHES ? side : side == SIDE_INSIDE ? SIDE_OUTSIDE : SIDE_INSIDE;
}

static Side shape_side(const Hull *hull, const Shape *shape, int depth)
{
    if (depth == HULL_DEPTH_MAX)
        return SIDE_TOUCHES;
    Side side;
    if (shape->kind == SHAPE_INTERSECTION)
        side = side_of_all(hull, shape->children, shape->child_count, depth + 1);
    else if (shape->kind == SHAPE_UNION || shape->kind == SHAPE_MERGE)
        side = side_of_any(hull, shape->children, shape->child_count, depth + 1);
    else
        side = leaf_side(hull, shape);
    if (shape->is_inverted)
        side = opposite(side);
    if (shape->clip_count == 0 || side == SIDE_OUTSIDE)
        return side;
    Side clips = side_of_all(hull, shape->clips, shape->clip_count, depth + 1);
    return clips == SIDE_INSIDE ? side : clips;
}

bool hull_misses_shape(const Hull *hull, const Shape *shape)
{
    return shape_side(hull, shape, 0) != SIDE_TOUCHES;
}
