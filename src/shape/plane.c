/* Planes, in world space always: a transformed plane is another plane.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape_int.h"

Shape *shape_plane(Arena *arena, V3 normal, double distance)
{
    Shape *shape = leaf_new(arena, SHAPE_PLANE);
    if (!shape)
        return NULL;
    shape->u.plane = (PlaneParams){.normal = v3_unit(normal), .distance = distance};
    leaf_place(shape, &XFORM_IDENTITY);
    return shape;
}

static void plane_hits(const Shape *shape, const LocalRay *ray, LeafHits *out)
{
    const PlaneParams *plane = &shape->u.plane;
    V3 n = plane->normal;
    double height = v3_dot(n, ray->o) - plane->distance, speed = v3_dot(n, ray->d);
    double at = v3_sum_abs(v3_mul(n, ray->o)), per_t = v3_sum_abs(v3_mul(n, ray->d));
    double off = PLANE_EPS * at + plane->turn_doubt * v3_sum_abs(ray->o) + shape->rounding.place;
    double speed_off = PLANE_EPS * per_t + plane->turn_doubt * v3_sum_abs(ray->d);
    double t = -height / speed, room = fabs(speed) - speed_off;
    out->count = 0;
    if (!(room > (PLANE_STEEPNESS - 1) * speed_off) || !isfinite(t)) {
        out->is_inside_before = height < 0;
        return;
    }
    double error = (off + fabs(t) * speed_off) / room + 2 * EPS_DOUBLE * fabs(t);
    out->is_inside_before = speed > 0;
    out->at[out->count++] = (LeafHit){t, error, 0, speed > 0 ? -1 : 1, true};
}

static void plane_point(const Shape *shape, const Crossing *crossing, V3 p, LocalPoint *out)
{
    (void)crossing;
    V3 n = shape->u.plane.normal;
    out->p = v3_mad(p, shape->u.plane.distance - v3_dot(n, p), n);
    out->ng = n;
    out->error = shape->rounding.place + PLANE_EPS * v3_sum_abs(v3_mul(n, out->p)) +
                 shape->u.plane.turn_doubt * v3_sum_abs(out->p);
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
    return fabs(shape->u.plane.distance) + shape->u.plane.place_doubt / PLACE_EPS;
}

/* The largest sum of the magnitudes of a column. */
static double column_size(const double m[3][4])
{
    double most = 0;
    for (int i = 0; i < 3; i++)
        most = num_max(most, fabs(m[0][i]) + fabs(m[1][i]) + fabs(m[2][i]));
    return most;
}

static bool plane_transform(Shape *shape, const Xform *x)
{
    PlaneParams *plane = &shape->u.plane;
    V3 moved = v3(x->from[0][3], x->from[1][3], x->from[2][3]);
    bool is_kept = xform_keeps_normals(x);
    double length = is_kept ? x->from[0][0] : v3_len(xform_normal(x, plane->normal));
    double by = v3_sum_abs(v3_mul(plane->normal, moved));
    double terms = v3_max_abs(moved) > 0 ? fabs(plane->distance) + by : 0;
    plane->place_doubt =
        (plane->place_doubt + PLACE_EPS * terms + plane->turn_doubt * v3_sum_abs(moved)) / length;
    if (!is_kept)
        plane->turn_doubt = (plane->turn_doubt + PLACE_EPS) * column_size(x->from) / length;
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
