/* How far primitives extend in a direction.
 *
 * That is enough to prove that one lies beyond a plane, whatever the plane's direction, where an
 * axis-parallel box around something slanted proves little.  SPDX-License-Identifier: Apache-2.0 */
#include "shape/mesh.h"
#include "shape/shape_int.h"

/* Along a line of half length `half` around 0. */
static double end_towards(double half, double n)
{
    return n > 0 ? half : -half;
}

static V3 box_farthest(Bound box, V3 n)
{
    V3 half = v3_scale(v3_sub(box.hi, box.lo), 0.5);
    V3 corner = v3(end_towards(half.x, n.x), end_towards(half.y, n.y), end_towards(half.z, n.z));
    return v3_add(bound_center(box), corner);
}

/* On a circle around the z axis. */
static V3 circle_farthest(double radius, double z, V3 n)
{
    double across = sqrt(n.x * n.x + n.y * n.y);
    double scale = across > 0 ? radius / across : 0;
    return v3(n.x * scale, n.y * scale, z);
}

/* On one of the circles at its ends. */
static V3 cone_farthest(const ConeParams *cone, V3 n)
{
    V3 bottom = circle_farthest(cone->bottom, 0, n);
    V3 top = circle_farthest(cone->top, cone->height, n);
    return v3_dot(bottom, n) > v3_dot(top, n) ? bottom : top;
}

static V3 torus_farthest(const TorusParams *torus, V3 n)
{
    V3 ring = circle_farthest(torus->major, 0, v3(n.z, n.x, n.y));
    return v3_mad(v3(ring.y, ring.z, ring.x), torus->minor, v3_unit(n));
}

static V3 triangle_farthest(const TriangleParams *triangle, V3 n)
{
    V3 farthest = triangle->corner[0];
    for (int i = 1; i < 3; i++)
        if (v3_dot(triangle->corner[i], n) > v3_dot(farthest, n))
            farthest = triangle->corner[i];
    return farthest;
}

/* In the space of the leaf. */
static V3 form_farthest(const Shape *leaf, V3 n)
{
    switch (leaf->kind) {
    case SHAPE_SPHERE:
        return v3_mad(leaf->u.sphere.center, leaf->u.sphere.radius, v3_unit(n));
    case SHAPE_BOX:
        return box_farthest((Bound){leaf->u.box.lo, leaf->u.box.hi}, n);
    case SHAPE_CONE:
        return cone_farthest(&leaf->u.cone, n);
    case SHAPE_TORUS:
        return torus_farthest(&leaf->u.torus, n);
    case SHAPE_DISC:
        return circle_farthest(leaf->u.disc.radius, 0, n);
    case SHAPE_TRIANGLE:
        return triangle_farthest(&leaf->u.triangle, n);
    default:
        return box_farthest(leaf->u.mesh->bound, n);
    }
}

V3 shape_farthest(const Shape *leaf, V3 n)
{
    if (!leaf->is_transformed)
        return form_farthest(leaf, n);
    return xform_point(&leaf->xform, form_farthest(leaf, xform_normal_back(&leaf->xform, n)));
}
