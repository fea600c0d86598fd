/* The oracle's CSG: solids that cut each other, share faces, or leave thin walls.
 * SPDX-License-Identifier: Apache-2.0 */
#include "quad_shapes.h"

static Shape *node(ShapeKit *kit, ShapeKind kind, Shape *a, Shape *b, Shape *c)
{
    Shape **children = ARENA_ARRAY(kit->arena, Shape *, 3);
    int count = c ? 3 : 2;
    if (!children || !a || !b)
        return NULL;
    children[0] = a;
    children[1] = b;
    children[2] = c;
    return shape_csg(kit->arena, kind, children, count);
}

static Shape *ball(ShapeKit *kit)
{
    V3 center = kit_point(kit, 0.5);
    double radius = kit_number(kit, 0.5, 1);
    return shape_sphere(kit->arena, center, radius);
}

static Shape *brick(ShapeKit *kit)
{
    V3 a = kit_point(kit, 1), b = kit_point(kit, 1);
    return shape_box(kit->arena, a, b);
}

static Shape *rod(ShapeKit *kit)
{
    V3 a = kit_point(kit, 1), b = kit_point(kit, 1);
    double radius = kit_number(kit, 0.1, 0.5);
    return shape_cone(kit->arena, a, radius, b, radius, false);
}

static Shape *make_union(ShapeKit *kit)
{
    Shape *a = ball(kit), *b = brick(kit), *c = rod(kit);
    return node(kit, SHAPE_UNION, a, b, c);
}

static Shape *make_merge(ShapeKit *kit)
{
    Shape *a = ball(kit), *b = brick(kit), *c = rod(kit);
    return node(kit, SHAPE_MERGE, a, b, c);
}

static Shape *make_intersection(ShapeKit *kit)
{
    Shape *a = ball(kit), *b = brick(kit);
    return node(kit, SHAPE_INTERSECTION, a, b, NULL);
}

static Shape *make_difference(ShapeKit *kit)
{
    Shape *a = ball(kit), *b = brick(kit), *c = rod(kit);
    shape_invert(b);
    shape_invert(c);
    return node(kit, SHAPE_INTERSECTION, a, b, c);
}

/* A torus cut by planes through its middle. */
static Shape *make_cut_torus(ShapeKit *kit)
{
    double minor = kit_number(kit, 0.1, 0.4);
    Shape *torus = shape_torus(kit->arena, 0.75, minor);
    Shape *a = shape_plane(kit->arena, v3(0, 1, 0), 0),
          *b = shape_plane(kit->arena, v3(1, 0, 0), 0);
    return node(kit, SHAPE_INTERSECTION, torus, a, b);
}

/* A cube of six planes. */
static Shape *make_plane_cube(ShapeKit *kit)
{
    Shape **sides = ARENA_ARRAY(kit->arena, Shape *, 6);
    for (int i = 0; sides && i < 6; i++) {
        double way = i % 2 ? -1 : 1;
        V3 n = v3(i / 2 == 0 ? way : 0, i / 2 == 1 ? way : 0, i / 2 == 2 ? way : 0);
        sides[i] = shape_plane(kit->arena, n, kit_number(kit, 0.25, 1));
    }
    for (int i = 0; i < 8; i++)
        kit_mark(kit, v3(i & 1 ? -sides[1]->u.plane.distance : sides[0]->u.plane.distance,
                         i & 2 ? -sides[3]->u.plane.distance : sides[2]->u.plane.distance,
                         i & 4 ? -sides[5]->u.plane.distance : sides[4]->u.plane.distance));
    return sides ? shape_csg(kit->arena, SHAPE_INTERSECTION, sides, 6) : NULL;
}

/* Two boxes that share a face, and a hole that ends in it. */
static Shape *make_shared_face(ShapeKit *kit)
{
    V3 lo = v3(-1, -0.5, -0.5), hi = v3(1, 0.5, 0.5);
    double at = kit_short(kit, -0.5, 0.5), radius = kit_number(kit, 0.1, 0.4);
    Shape *a = shape_box(kit->arena, lo, v3(at, hi.y, hi.z));
    Shape *b = shape_box(kit->arena, v3(at, lo.y, lo.z), hi);
    Shape *hole = shape_cone(kit->arena, v3(at, 0, 0), radius, v3(2, 0, 0), radius, false);
    shape_invert(hole);
    Shape *both = node(kit, SHAPE_MERGE, a, b, NULL);
    return node(kit, SHAPE_INTERSECTION, both, hole, NULL);
}

/* A shell of a thickness of a millionth. */
static Shape *make_shell(ShapeKit *kit)
{
    V3 center = kit_point(kit, 0.5);
    double radius = kit_number(kit, 0.5, 1), thin = 0x1p-20;
    Shape *outer = shape_sphere(kit->arena, center, radius);
    Shape *inner = shape_sphere(kit->arena, center, radius - thin);
    shape_invert(inner);
    return node(kit, SHAPE_INTERSECTION, outer, inner, NULL);
}

const ShapeCase csg_cases[] = {
    {.name = "union", .make = make_union},
    {.name = "merge", .make = make_merge},
    {.name = "intersection", .make = make_intersection},
    {.name = "difference", .make = make_difference},
    {.name = "cut torus", .make = make_cut_torus},
    {.name = "cube of planes", .make = make_plane_cube},
    {.name = "shared face", .make = make_shared_face},
    {.name = "shell", .make = make_shell},
    {.name = NULL},
};
