/* Discs: a ring in the plane z = 0 that, as a solid, is the half space z < 0; outside the ring
 * its plane bounds the solid unseen.  SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape_int.h"

Shape *shape_disc(Arena *arena, V3 center, V3 normal, double radius, double hole)
{
    Shape *shape = leaf_new(arena, SHAPE_DISC);
    if (!shape)
        return NULL;
    shape->u.disc = (DiscParams){hole, radius};
    V3 n = v3_unit(normal), s, t;
    v3_frame(n, &s, &t);
    Xform place = xform_frame(s, t, n, center);
    leaf_place(shape, &place);
    return shape;
}

static void disc_hits(const Shape *shape, const LocalRay *ray, LeafHits *out)
{
    const DiscParams *disc = &shape->u.disc;
    double speed = ray->d.z, t = -ray->o.z / speed;
    out->is_inside_before = speed > 0 || (speed == 0 && ray->o.z < 0);
    out->count = 0;
    if (speed == 0 || !isfinite(t))
        return;
    double x = ray->o.x + t * ray->d.x, y = ray->o.y + t * ray->d.y;
    double w = x * x + y * y;
    bool is_on = w <= disc->radius * disc->radius && w >= disc->hole * disc->hole;
    double error = local_error(ray, t).z / fabs(speed) + 2 * EPS_DOUBLE * fabs(t);
    out->at[out->count++] = (LeafHit){t, error, 0, speed > 0 ? -1 : 1, is_on};
}

static void disc_point(const Shape *shape, const Crossing *crossing, V3 p, LocalPoint *out)
{
    (void)shape, (void)crossing;
    *out = (LocalPoint){.p = v3(p.x, p.y, 0), .ng = v3(0, 0, 1)};
}

static bool disc_is_inside(const Shape *shape, V3 p)
{
    (void)shape;
    return p.z < 0;
}

static Bound disc_bound(const Shape *shape)
{
    const double(*m)[4] = shape->xform.to;
    double r = shape->u.disc.radius;
    V3 c = xform_point(&shape->xform, v3(0, 0, 0));
    V3 half =
        v3(r * hypot(m[0][0], m[0][1]), r * hypot(m[1][0], m[1][1]), r * hypot(m[2][0], m[2][1]));
    return bound_pad((Bound){v3_sub(c, half), v3_add(c, half)});
}

static V3 disc_farthest(const Shape *shape, V3 n)
{
    return circle_farthest(shape->u.disc.radius, 0, n);
}

const ShapeOps disc_ops = {.hits = disc_hits,
                           .point = disc_point,
                           .is_inside = disc_is_inside,
                           .bound = disc_bound,
                           .farthest = disc_farthest};
