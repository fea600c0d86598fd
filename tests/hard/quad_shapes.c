/* The shapes of the oracle.  Numbers are drawn as plain doubles and go into the constructors as
 * they are, so that both worlds make the same shape.  SPDX-License-Identifier: Apache-2.0 */
#include "quad_shapes.h"

Plain kit_number(ShapeKit *kit, Plain lo, Plain hi)
{
    Plain share = (Plain)rng_double(&kit->rng), width = hi - lo;
    Plain part = width * share;
    return lo + part;
}

Plain kit_short(ShapeKit *kit, Plain lo, Plain hi)
{
    Plain steps = 0x1p20, number = kit_number(kit, lo, hi) * steps;
    return (Plain)(int32_t)number / steps;
}

V3 kit_short_point(ShapeKit *kit, Plain size)
{
    V3 p;
    p.x = kit_short(kit, -size, size);
    p.y = kit_short(kit, -size, size);
    p.z = kit_short(kit, -size, size);
    return p;
}

V3 kit_point(ShapeKit *kit, Plain size)
{
    V3 p;
    p.x = kit_number(kit, -size, size);
    p.y = kit_number(kit, -size, size);
    p.z = kit_number(kit, -size, size);
    return p;
}

void kit_mark(ShapeKit *kit, V3 p)
{
    if (kit->mark_count < MODEL_MARKS_MAX)
        kit->mark[kit->mark_count++] = p;
}

/* --- quadrics and what is flat -------------------------------------------------------------- */

static Shape *make_sphere(ShapeKit *kit)
{
    V3 center = kit_point(kit, 1);
    double radius = kit_number(kit, 0.01, 1);
    return shape_sphere(kit->arena, center, radius);
}

static Shape *make_box(ShapeKit *kit)
{
    V3 a = kit_point(kit, 1), b = kit_point(kit, 1);
    for (int i = 0; i < 8; i++)
        kit_mark(kit, v3(i & 1 ? a.x : b.x, i & 2 ? a.y : b.y, i & 4 ? a.z : b.z));
    return shape_box(kit->arena, a, b);
}

static Shape *make_cone_of(ShapeKit *kit, bool is_open, bool is_tip)
{
    V3 a = kit_point(kit, 1), b = kit_point(kit, 1);
    double bottom = kit_number(kit, 0.1, 1), top = is_tip ? 0 : kit_number(kit, 0.1, 1);
    kit_mark(kit, a);
    kit_mark(kit, b);
    return shape_cone(kit->arena, a, bottom, b, top, is_open);
}

static Shape *make_cone(ShapeKit *kit)
{
    return make_cone_of(kit, false, true);
}

static Shape *make_open_cone(ShapeKit *kit)
{
    return make_cone_of(kit, true, false);
}

static Shape *make_cylinder(ShapeKit *kit)
{
    V3 a = kit_point(kit, 1), b = kit_point(kit, 1);
    double r = kit_number(kit, 0.1, 1);
    kit_mark(kit, a);
    kit_mark(kit, b);
    return shape_cone(kit->arena, a, r, b, r, false);
}

static Shape *make_plane(ShapeKit *kit)
{
    V3 n = kit_point(kit, 1);
    double distance = kit_number(kit, -1, 1);
    return shape_plane(kit->arena, n, distance);
}

static Shape *make_torus_of(ShapeKit *kit, Plain major_lo, Plain major_hi, Plain minor_lo,
                            Plain minor_hi)
{
    double major = kit_number(kit, major_lo, major_hi);
    double minor = kit_number(kit, minor_lo, minor_hi);
    return shape_torus(kit->arena, major, minor);
}

static Shape *make_torus(ShapeKit *kit)
{
    return make_torus_of(kit, 0.5, 1, 0.05, 0.5);
}

static Shape *make_thin_torus(ShapeKit *kit)
{
    return make_torus_of(kit, 0.5, 1, 1e-4, 2e-4);
}

static Shape *make_spindle_torus(ShapeKit *kit)
{
    return make_torus_of(kit, 0.1, 0.5, 0.5, 1);
}

static Shape *make_disc(ShapeKit *kit)
{
    V3 center = kit_point(kit, 1), normal = kit_point(kit, 1);
    double hole = kit_number(kit, 0, 0.3), radius = kit_number(kit, 0.3, 1);
    kit_mark(kit, center);
    return shape_disc(kit->arena, center, normal, radius, hole);
}

static Shape *make_triangle_of(ShapeKit *kit, bool is_smooth)
{
    V3 corner[3], normal[3];
    for (int i = 0; i < 3; i++) {
        corner[i] = kit_point(kit, 1);
        normal[i] = kit_point(kit, 0.25);
        normal[i].z += 1;
        kit_mark(kit, corner[i]);
    }
    return shape_triangle(kit->arena, corner, is_smooth ? normal : NULL);
}

static Shape *make_triangle(ShapeKit *kit)
{
    return make_triangle_of(kit, false);
}

static Shape *make_smooth_triangle(ShapeKit *kit)
{
    return make_triangle_of(kit, true);
}

static Shape *make_quadric(ShapeKit *kit)
{
    V3 square = kit_point(kit, 1), mixed = kit_point(kit, 1), linear = kit_point(kit, 1);
    double constant = kit_number(kit, -1, 1);
    return shape_quadric(kit->arena, square, mixed, linear, constant);
}

const ShapeCase plain_cases[] = {
    {.name = "sphere", .make = make_sphere},
    {.name = "box", .make = make_box},
    {.name = "cone", .make = make_cone},
    {.name = "open cone", .make = make_open_cone},
    {.name = "cylinder", .make = make_cylinder},
    {.name = "plane", .make = make_plane},
    {.name = "torus", .make = make_torus},
    {.name = "thin torus", .make = make_thin_torus},
    {.name = "spindle torus", .make = make_spindle_torus},
    {.name = "disc", .make = make_disc},
    {.name = "triangle", .make = make_triangle},
    {.name = "smooth triangle", .make = make_smooth_triangle},
    {.name = "quadric", .make = make_quadric},
    {.name = NULL},
};

const ShapeCase *shape_case(int i)
{
    static const ShapeCase *const lists[] = {plain_cases, solid_cases, facet_cases, csg_cases};
    for (size_t k = 0; k < sizeof lists / sizeof *lists; k++)
        for (const ShapeCase *c = lists[k]; c->name; c++)
            if (i-- == 0)
                return c;
    return NULL;
}

/* --- placing -------------------------------------------------------------------------------- */

static void place(ShapeKit *kit, Xform x)
{
    shape_transform(kit->shape, &x);
    kit->place = xform_then(&kit->place, &x);
}

static void place_stretched(ShapeKit *kit)
{
    V3 by = kit_point(kit, 1);
    place(kit, xform_scale(v3(by.x < 0 ? by.x - 0.25 : by.x + 0.25, 0.75, 1.5)));
}

static void place_sheared(ShapeKit *kit)
{
    V3 by = kit_point(kit, 1);
    Xform x;
    if (xform_from_matrix((const double[3][4]){{1, by.x, by.y, 0}, {0, 1, by.z, 0}, {0, 0, 1, 0}},
                          &x))
        place(kit, x);
}

/* As it is, a power of two smaller, turned and moved, stretched, sheared. */
static void place_all(ShapeKit *kit)
{
    uint32_t kind = rng_u32(&kit->rng) % 5;
    if (kind == 1)
        place(kit, xform_scale(v3(0.25, 0.25, 0.25)));
    if (kind == 3)
        place_stretched(kit);
    if (kind == 4)
        place_sheared(kit);
    if (kind >= 2) {
        place(kit, xform_rotate(kit_point(kit, 3)));
        place(kit, xform_translate(kit_point(kit, 3)));
    }
}

Shape *shape_kit_make(ShapeKit *kit, const ShapeCase *which)
{
    kit->place = XFORM_IDENTITY;
    kit->shape = which->make(kit);
    if (!kit->shape)
        return NULL;
    place_all(kit);
    shape_finish(kit->arena, kit->shape);
    return kit->shape;
}

void shape_kit_done(ShapeKit *kit)
{
    if (kit->mesh)
        mesh_done(kit->mesh);
}
