/* Single triangles, flat and smooth.  SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape_int.h"

Shape *shape_triangle(Arena *arena, const V3 corner[3], const V3 *normal_or_null)
{
    Shape *shape = leaf_new(arena, SHAPE_TRIANGLE);
    if (!shape)
        return NULL;
    shape->u.triangle.is_smooth = normal_or_null != NULL;
    for (int i = 0; i < 3; i++) {
        shape->u.triangle.corner[i] = corner[i];
        if (normal_or_null)
            shape->u.triangle.normal[i] = v3_unit(normal_or_null[i]);
    }
    leaf_place(shape, &XFORM_IDENTITY);
    return shape;
}

static bool triangle_closest(const Shape *shape, const Ray *ray, ShapeScratch *scratch,
                             Crossing *out)
{
    (void)scratch;
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

static void triangle_point(const Shape *shape, const Crossing *crossing, V3 p, LocalPoint *out)
{
    const TriangleParams *t = &shape->u.triangle;
    V3 ab = v3_sub(t->corner[1], t->corner[0]), ac = v3_sub(t->corner[2], t->corner[0]);
    double u = crossing->u, v = crossing->v;
    (void)p;
    out->p = v3_mad(v3_mad(t->corner[0], u, ab), v, ac);
    out->error = 2 * shape->rounding.place;
    out->ng = v3_unit(v3_cross(ac, ab));
    if (!t->is_smooth)
        return;
    V3 n = v3_mad(v3_mad(v3_scale(t->normal[0], 1 - u - v), u, t->normal[1]), v, t->normal[2]);
    n = v3_unit(n);
    out->is_smooth = v3_len2(n) > 0;
    out->ns = v3_dot(n, out->ng) < 0 ? v3_neg(n) : n;
    const double weight[3] = {1 - u - v, u, v};
    out->lift = triangle_lift(out->p, t->corner, t->normal, weight);
}

static Bound triangle_bound(const Shape *shape)
{
    Bound b = BOUND_EMPTY;
    for (int i = 0; i < 3; i++)
        b = bound_add(b, shape->u.triangle.corner[i]);
    return bound_pad(b);
}

static bool triangle_list(const Shape *shape, const Line *line, ShapeScratch *scratch)
{
    Crossing crossing;
    Ray all = {line->ray->o, line->ray->d, -INFINITY, INFINITY};
    if (triangle_closest(shape, &all, scratch, &crossing))
        scratch_push(scratch, &crossing);
    return false;
}

static V3 triangle_farthest(const Shape *shape, V3 n)
{
    const V3 *corner = shape->u.triangle.corner;
    V3 farthest = corner[0];
    for (int i = 1; i < 3; i++)
        if (v3_dot(corner[i], n) > v3_dot(farthest, n))
            farthest = corner[i];
    return farthest;
}

static double triangle_size(const Shape *shape)
{
    double size = 0;
    for (int i = 0; i < 3; i++)
        size = num_max(size, v3_sum_abs(shape->u.triangle.corner[i]));
    return size;
}

static bool triangle_transform(Shape *shape, const Xform *x)
{
    TriangleParams *triangle = &shape->u.triangle;
    for (int i = 0; i < 3; i++) {
        triangle->corner[i] = xform_point(x, triangle->corner[i]);
        triangle->normal[i] = turn_normal(triangle->normal[i], x);
    }
    return true;
}

const ShapeOps triangle_ops = {.list = triangle_list,
                               .closest = triangle_closest,
                               .point = triangle_point,
                               .bound = triangle_bound,
                               .farthest = triangle_farthest,
                               .size = triangle_size,
                               .transform = triangle_transform};
