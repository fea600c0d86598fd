/* Planes, in world space always: a transformed plane is another plane.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape_int.h"

Shape *shape_plane(Arena *arena, V3 normal, double distance)
{
    Shape *shape = leaf_new(arena, SHAPE_PLANE);
    if (!shape)
        return NULL;
    shape->u.plane = (PlaneParams){v3_unit(normal), distance};
    leaf_place(shape, &XFORM_IDENTITY);
    return shape;
}

static void plane_hits(const Shape *shape, const LocalRay *ray, LeafHits *out)
{
    V3 n = shape->u.plane.normal;
    double height = v3_dot(n, ray->o) - shape->u.plane.distance;
    double speed = v3_dot(n, ray->d);
    /* A line that runs in the plane to its last bit is parallel to it. */
    out->is_inside_before = speed > 0 || (speed == 0 && height < 0);
    out->count = 0;
    double t = -height / speed;
    if (speed == 0 || !isfinite(t))
        return;
    double a = fabs(n.x * ray->o.x) + fabs(n.y * ray->o.y) + fabs(n.z * ray->o.z);
    double b = fabs(n.x * ray->d.x) + fabs(n.y * ray->d.y) + fabs(n.z * ray->d.z);
    double error = (4 * EPS_DOUBLE * (a + fabs(t) * b) + shape->rounding.place) / fabs(speed) +
                   2 * EPS_DOUBLE * fabs(t);
    out->at[out->count++] = (LeafHit){t, error, 0, speed > 0 ? -1 : 1, true};
}

static void plane_point(const Shape *shape, const Crossing *crossing, V3 p, LocalPoint *out)
{
    (void)crossing;
    V3 n = shape->u.plane.normal;
    out->p = v3_mad(p, shape->u.plane.distance - v3_dot(n, p), n);
    out->ng = n;
    out->error = shape->rounding.place + 4 * EPS_DOUBLE * v3_sum_abs(v3_mul(n, out->p));
}

static bool plane_is_inside(const Shape *shape, V3 p)
{
    return v3_dot(shape->u.plane.normal, p) <= shape->u.plane.distance;
}

/* Return the box around the plane, or around its inside. */
static Bound box_around(const PlaneParams *plane, bool is_solid)
{
    V3 n = plane->normal;
    double d = plane->distance, pad = 4 * PLACE_EPS * fabs(d);
    Bound b = BOUND_ALL;
    double *lo[3] = {&b.lo.x, &b.lo.y, &b.lo.z}, *hi[3] = {&b.hi.x, &b.hi.y, &b.hi.z};
    for (int i = 0; i < 3; i++) {
        double along = v3_at(n, i);
        if (fabs(along) != 1 || v3_sum_abs(n) != 1)
            continue;
        if (along > 0 || !is_solid)
            *hi[i] = along * d + pad;
        if (along < 0 || !is_solid)
            *lo[i] = along * d - pad;
    }
    return b;
}

Bound plane_inside_bound(const PlaneParams *plane)
{
    return box_around(plane, true);
}

static Bound plane_bound(const Shape *shape)
{
    return box_around(&shape->u.plane, false);
}

static double plane_size(const Shape *shape)
{
    return fabs(shape->u.plane.distance);
}

static bool plane_transform(Shape *shape, const Xform *x)
{
    PlaneParams *plane = &shape->u.plane;
    V3 moved = v3(x->from[0][3], x->from[1][3], x->from[2][3]);
    double length = xform_keeps_normals(x) ? x->from[0][0] : v3_len(xform_normal(x, plane->normal));
    plane->distance = (plane->distance - v3_dot(plane->normal, moved)) / length;
    plane->normal = turn_normal(plane->normal, x);
    return true;
}

const ShapeOps plane_ops = {.hits = plane_hits,
                            .point = plane_point,
                            .is_inside = plane_is_inside,
                            .bound = plane_bound,
                            .size = plane_size,
                            .transform = plane_transform};
