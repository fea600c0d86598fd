/* Discs: a ring in the plane z = 0 that, as a solid, is the half space z < 0; outside the ring
 * its plane bounds the solid unseen.  SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape_int.h"

void disc_hits(const Shape *shape, const LocalRay *ray, LeafHits *out)
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

void disc_point(const Shape *shape, V3 p, LocalPoint *out)
{
    (void)shape;
    *out = (LocalPoint){v3(p.x, p.y, 0), v3(0, 0, 1), 0};
}

bool disc_is_inside(const Shape *shape, V3 p)
{
    (void)shape;
    return p.z < 0;
}

Bound disc_bound(const Shape *shape)
{
    const double(*m)[4] = shape->xform.to;
    double r = shape->u.disc.radius;
    V3 c = xform_point(&shape->xform, v3(0, 0, 0));
    V3 half =
        v3(r * hypot(m[0][0], m[0][1]), r * hypot(m[1][0], m[1][1]), r * hypot(m[2][0], m[2][1]));
    return bound_pad((Bound){v3_sub(c, half), v3_add(c, half)});
}
