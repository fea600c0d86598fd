/* Single triangles, flat and smooth.  SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape_int.h"

bool triangle_hit(const Shape *shape, const Ray *ray, Crossing *out)
{
    TriHit hit;
    if (!tri_test(shape->u.triangle.corner, ray, &hit))
        return false;
    *out = (Crossing){.t = hit.t,
                      .t_error = hit.t_error + hit.t_slope * shape->rounding.place,
                      .leaf = shape,
                      .is_visible = true,
                      .u = hit.u,
                      .v = hit.v};
    return true;
}

void triangle_point(const Shape *shape, const Crossing *crossing, V3 p, ShapePoint *out)
{
    const TriangleParams *t = &shape->u.triangle;
    V3 ab = v3_sub(t->corner[1], t->corner[0]), ac = v3_sub(t->corner[2], t->corner[0]);
    double u = crossing->u, v = crossing->v;
    (void)p;
    out->p = v3_mad(v3_mad(t->corner[0], u, ab), v, ac);
    out->p_error = 2 * shape->rounding.place;
    out->ng = out->ns = v3_unit(v3_cross(ac, ab));
    if (!t->is_smooth)
        return;
    V3 n = v3_mad(v3_mad(v3_scale(t->normal[0], 1 - u - v), u, t->normal[1]), v, t->normal[2]);
    n = v3_unit(n);
    if (v3_len2(n) > 0)
        out->ns = v3_dot(n, out->ng) < 0 ? v3_neg(n) : n;
}

Bound triangle_bound(const Shape *shape)
{
    Bound b = BOUND_EMPTY;
    for (int i = 0; i < 3; i++)
        b = bound_add(b, shape->u.triangle.corner[i]);
    return bound_pad(b);
}
