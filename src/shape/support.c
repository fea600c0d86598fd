/* How far primitives extend in a direction.
 *
 * That is enough to prove that one lies beyond a plane, whatever the plane's direction, where an
 * axis-parallel box around something slanted proves little.  SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape_int.h"

/* Along a line of half length `half` around 0. */
static double end_towards(double half, double n)
{
    return n > 0 ? half : -half;
}

V3 bound_farthest(Bound box, V3 n)
{
    V3 half = v3_scale(v3_sub(box.hi, box.lo), 0.5);
    V3 corner = v3(end_towards(half.x, n.x), end_towards(half.y, n.y), end_towards(half.z, n.z));
    return v3_add(bound_center(box), corner);
}

V3 circle_farthest(double radius, double z, V3 n)
{
    double across = sqrt(n.x * n.x + n.y * n.y);
    double scale = across > 0 ? radius / across : 0;
    return v3(n.x * scale, n.y * scale, z);
}

V3 shape_farthest(const Shape *leaf, V3 n)
{
    const ShapeOps *ops = shape_ops(leaf);
    if (!ops->farthest)
        return bound_farthest(ops->bound(leaf), n);
    if (!leaf->is_transformed)
        return ops->farthest(leaf, n);
    return xform_point(&leaf->xform, ops->farthest(leaf, xform_normal_back(&leaf->xform, n)));
}
