/* The primitives: crossings, points, normals, uv, inside and boxes.  The values marked "probe"
 * were measured with POV-Ray 3.7.  SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape.h"

#include "base/rng.h"
#include "math/sample.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include "shape_kit.h"

static void assert_near(V3 a, V3 b, double tolerance)
{
    if (!(v3_dist(a, b) <= tolerance))
        fail_msg("<%.9g,%.9g,%.9g> is not <%.9g,%.9g,%.9g>", a.x, a.y, a.z, b.x, b.y, b.z);
}

/* What the language's trace() gives: point and raw normal. */
static bool trace(const Shape *shape, V3 o, V3 d, V3 *p, V3 *n)
{
    Ray ray = {o, v3_unit(d), 0, INFINITY};
    Crossing c;
    if (!shape_closest(shape, &ray, scratch, &c))
        return false;
    ShapePoint point;
    shape_point(&c, &ray, &point);
    *p = point.p;
    *n = point.ns;
    return true;
}

static void check_trace(const Shape *shape, V3 o, V3 d, V3 p, V3 n)
{
    V3 hit = {0}, normal = {0};
    assert_true(trace(shape, o, d, &hit, &normal));
    assert_near(hit, p, 2e-6);
    assert_near(normal, n, 2e-6);
}

static Shape *turned(Shape *shape, V3 rotate_deg, V3 move)
{
    Xform turn = xform_rotate(v3_scale(rotate_deg, PMS_PI / 180)), shift = xform_translate(move);
    shape_transform(shape, &turn);
    shape_transform(shape, &shift);
    return shape;
}

static Shape *scaled(Shape *shape, V3 by)
{
    Xform x = xform_scale(by);
    shape_transform(shape, &x);
    return shape;
}

static Shape *unit_sphere(void)
{
    return shape_sphere(arena, v3(0, 0, 0), 1);
}
static Shape *unit_box(void)
{
    return shape_box(arena, v3(1, 1, 1), v3(-1, -1, -1));
}

static void test_sphere(void **state)
{
    (void)state;
    check_trace(unit_sphere(), v3(-3, 0, 0), v3(1, 0, 0), v3(-1, 0, 0), v3(-1, 0, 0));
    Shape *inverse = unit_sphere();
    shape_invert(inverse);
    check_trace(inverse, v3(-3, 0, 0), v3(1, 0, 0), v3(-1, 0, 0), v3(1, 0, 0)); /* probe */
    check_trace(unit_sphere(), v3(-9e6, 0, 0), v3(1, 0, 0), v3(-1, 0, 0), v3(-1, 0, 0));
    check_trace(unit_sphere(), v3(0, 0, 0), v3(0, 1, 0), v3(0, 1, 0), v3(0, 1, 0));
    V3 p = {0}, n = {0};
    assert_false(trace(unit_sphere(), v3(-3, 1.0000001, 0), v3(1, 0, 0), &p, &n));
    assert_false(trace(unit_sphere(), v3(3, 0, 0), v3(1, 0, 0), &p, &n));
    assert_false(trace(shape_sphere(arena, v3(0, 0, 0), 0), v3(3, 0, 0), v3(-1, 0, 0), &p, &n));
    Shape *egg = turned(scaled(unit_sphere(), v3(2, 1, 1)), v3(0, 0, 90), v3(5, 0, 0));
    check_trace(egg, v3(5, 9, 0), v3(0, -1, 0), v3(5, 2, 0), v3(0, 1, 0));
    assert_true(shape_is_inside(egg, v3(5, 1.99, 0)));
    assert_false(shape_is_inside(egg, v3(6.01, 0, 0)));
    assert_false(shape_is_inside(unit_sphere(), v3(1, 0, 0)));
    /* Folding a move and a uniform scale into the numbers keeps it untransformed. */
    Shape *moved = scaled(turned(unit_sphere(), v3(0, 0, 0), v3(1, 2, 3)), v3(2, 2, 2));
    assert_false(moved->is_transformed);
    assert_near(moved->u.sphere.center, v3(2, 4, 6), 0);
}

static void test_box(void **state)
{
    (void)state;
    check_trace(unit_box(), v3(-5, -5, -5), v3(1, 1, 1), v3(-1, -1, -1), v3(-1, 0, 0)); /* probe */
    check_trace(unit_box(), v3(0, -5, -5), v3(0, 1, 1), v3(0, -1, -1), v3(0, -1, 0));   /* probe */
    check_trace(unit_box(), v3(0, 0, 0), v3(0, 0, 1), v3(0, 0, 1), v3(0, 0, 1));
    check_trace(unit_box(), v3(-1e8, 0, 0), v3(1, 0, 0), v3(-1, 0, 0), v3(-1, 0, 0));
    Shape *b = turned(unit_box(), v3(0, 45, 0), v3(0, 0, 0));
    check_trace(b, v3(0.1, 0.5, -9), v3(0, 0, 1), v3(0.1, 0.5, -sqrt(2) + 0.1),
                v3(sqrt(0.5), 0, -sqrt(0.5)));
    assert_true(shape_is_inside(unit_box(), v3(1, 1, 1))); /* probe */
    Shape *sheet = shape_box(arena, v3(0, 0, 0), v3(1, 1, 0));
    check_trace(sheet, v3(0.5, 0.5, -3), v3(0, 0, 1), v3(0.5, 0.5, 0), v3(0, 0, -1));
    check_trace(sheet, v3(0.5, 0.5, 3), v3(0, 0, -1), v3(0.5, 0.5, 0), v3(0, 0, 1));
    V3 p = {0}, n = {0};
    assert_false(trace(sheet, v3(1.5, 0.5, -3), v3(0, 0, 1), &p, &n));
    assert_false(trace(unit_box(), v3(0, 2, -3), v3(0, 0, 1), &p, &n));
}

static void test_cone(void **state)
{
    (void)state;
    Shape *cone = shape_cone(arena, v3(0, 0, 0), 1, v3(0, 2, 0), 0, false);
    check_trace(cone, v3(5, 1, 0), v3(-1, 0, 0), v3(0.5, 1, 0),
                v3(0.894427, 0.447214, 0)); /* probe */
    V3 p = {0}, n = {0};
    assert_true(trace(cone, v3(0, 5, 0), v3(0, -1, 0), &p, &n));
    assert_near(p, v3(0, 2, 0), 1e-12);
    assert_true(v3_is_finite(n));
    check_trace(cone, v3(0.2, -5, 0.3), v3(0, 1, 0), v3(0.2, 0, 0.3), v3(0, -1, 0));
    /* Along the wall: the quadratic loses its leading term. */
    check_trace(cone, v3(2, -2.2, 0), v3(-1, 2, 0), v3(0.9, 0, 0), v3(0, -1, 0));
    Shape *tube = shape_cone(arena, v3(0, 0, 0), 1, v3(3, 0, 0), 1, true);
    check_trace(tube, v3(-5, 0.5, 0), v3(1, 0.08, 0), v3(1.25, 1, 0), v3(0, 1, 0));
    assert_false(trace(tube, v3(-5, 0.5, 0), v3(1, 0, 0), &p, &n));
    assert_false(trace(tube, v3(-1, 3, 0), v3(0, -1, 0), &p, &n));
    Shape *closed = shape_cone(arena, v3(0, 0, 0), 1, v3(3, 0, 0), 1, false);
    check_trace(closed, v3(-5, 0.5, 0), v3(1, 0, 0), v3(0, 0.5, 0), v3(-1, 0, 0));
    check_trace(closed, v3(1, 5, 0), v3(0, -1, 0), v3(1, 1, 0), v3(0, 1, 0));
    /* Probes of the rim: a closed one is open at its surface, an open one closed. */
    assert_false(shape_is_inside(closed, v3(3, 0, 0)));
    assert_true(shape_is_inside(tube, v3(3, 0, 0)));
    assert_true(shape_is_inside(closed, v3(1.5, 0.9, 0)));
    assert_false(shape_is_inside(closed, v3(1.5, 0.9, 0.9)));
}

static void test_plane(void **state)
{
    (void)state;
    Shape *plane = shape_plane(arena, v3(0, 3, 0), 1);
    check_trace(plane, v3(7, 5, 1), v3(0, -1, 0), v3(7, 1, 1), v3(0, 1, 0));
    check_trace(plane, v3(7, 1e8, 1), v3(0, -1, 0), v3(7, 1, 1), v3(0, 1, 0));
    V3 p = {0}, n = {0};
    assert_false(trace(plane, v3(7, 5, 1), v3(1, 0, 0), &p, &n));
    assert_true(shape_is_inside(plane, v3(0, 1, 0)));
    assert_false(shape_is_inside(plane, v3(0, 1.0001, 0)));
    turned(plane, v3(0, 0, 90), v3(5, 0, 0)); /* y becomes -x */
    check_trace(plane, v3(0, 0, 0), v3(1, 0, 0), v3(4, 0, 0), v3(-1, 0, 0));
    scaled(plane, v3(2, 1, 1));
    check_trace(plane, v3(0, 0, 0), v3(1, 0, 0), v3(8, 0, 0), v3(-1, 0, 0));
    Ray inside = {{0, 0, 0}, {0, 1, 0}, 0, INFINITY};
    CrossList list;
    shape_crossings(shape_plane(arena, v3(1, 0, 0), 1), &inside, scratch, &list);
    assert_int_equal(list.count, 0);
    assert_true(list.is_inside_before);
}

static void test_torus(void **state)
{
    (void)state;
    check_trace(shape_torus(arena, 2, 0.5), v3(2, 5, 0), v3(0, -1, 0), v3(2, 0.5, 0), v3(0, 1, 0));
    Shape *spindle = shape_torus(arena, 0.5, 1);
    check_trace(spindle, v3(0, 5, 0), v3(0, -1, 0), v3(0, 0.866025, 0), v3(0, 1, 0)); /* probe */
    assert_true(shape_is_inside(spindle, v3(0, 0, 0)));                               /* probe */
    Ray ray = {{-9, 0, 0}, {1, 0, 0}, 0, INFINITY};
    CrossList list;
    shape_crossings(shape_torus(arena, 2, 0.5), &ray, scratch, &list);
    assert_int_equal(list.count, 4);
    for (int i = 0; i < 4; i++) {
        static const double at[4] = {6.5, 7.5, 10.5, 11.5};
        assert_true(fabs(list.items[i].t - at[i]) <= list.items[i].t_error);
        assert_true(list.items[i].t_error < 1e-13);
        assert_int_equal(list.items[i].change, i % 2 ? -1 : 1);
    }
    shape_crossings(spindle, &ray, scratch, &list);
    assert_int_equal(list.count, 4);
    static const int changes[4] = {1, 0, 0, -1};
    static const double at[4] = {7.5, 8.5, 9.5, 10.5};
    for (int i = 0; i < 4; i++) {
        assert_int_equal(list.items[i].change, changes[i]);
        assert_true(fabs(list.items[i].t - at[i]) <= 1e-14);
    }
    V3 p = {0}, n = {0};
    assert_false(trace(shape_torus(arena, 2, 0.5), v3(0, 5, 0), v3(0, -1, 0), &p, &n));
    assert_false(trace(shape_torus(arena, 2, 0), v3(-5, 0, 0), v3(1, 0, 0), &p, &n));
    check_trace(shape_torus(arena, 0, 1), v3(-5, 0, 0), v3(1, 0, 0), v3(-1, 0, 0), v3(-1, 0, 0));
    /* From far away. */
    V3 o = v3_scale(v3_unit(v3(1, 2, 3)), 5e6);
    Shape *torus = shape_torus(arena, 2, 0.5);
    assert_true(trace(torus, o, v3_sub(v3(2, 0, 0), o), &p, &n));
    double w = sqrt(p.x * p.x + p.z * p.z) - 2;
    assert_true(fabs(sqrt(w * w + p.y * p.y) - 0.5) < 1e-9);
}

static void test_disc(void **state)
{
    (void)state;
    Shape *disc = shape_disc(arena, v3(0, 2, 0), v3(0, 1, 0), 2, 1);
    check_trace(disc, v3(1.5, 9, 0), v3(0, -1, 0), v3(1.5, 2, 0), v3(0, 1, 0));
    V3 p = {0}, n = {0};
    assert_false(trace(disc, v3(0.5, 9, 0), v3(0, -1, 0), &p, &n));
    assert_false(trace(disc, v3(0, 9, 2.1), v3(0, -1, 0), &p, &n));
    assert_true(shape_is_inside(disc, v3(100, 1, 0))); /* probe: half a world */
    assert_false(shape_is_inside(disc, v3(0, 2, 0)));
    Bound b = shape_bound(disc);
    assert_near(b.lo, v3(-2, 2, -2), 1e-12);
    assert_near(b.hi, v3(2, 2, 2), 1e-12);
}

static void test_triangle(void **state)
{
    (void)state;
    V3 corner[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    V3 normal[3] = {{-1, 0, -1}, {1, 0, -1}, {0, 1, -1}};
    Shape *flat = shape_triangle(arena, corner, NULL);
    check_trace(flat, v3(0.3, 0.2, -5), v3(0, 0, 1), v3(0.3, 0.2, 0), v3(0, 0, -1));
    Shape *smooth = shape_triangle(arena, corner, normal);
    check_trace(smooth, v3(0.3, 0.2, -5), v3(0, 0, 1), v3(0.3, 0.2, 0),
                v3(-0.192450, 0.192450, -0.962250)); /* probe */
    check_trace(smooth, v3(0.3, 0.2, 5), v3(0, 0, -1), v3(0.3, 0.2, 0),
                v3(-0.192450, 0.192450, -0.962250));
    assert_false(shape_is_inside(flat, v3(0.3, 0.2, 0)));
    V3 p = {0}, n = {0};
    corner[2] = v3(2, 0, 0);
    assert_false(trace(shape_triangle(arena, corner, NULL), v3(0.5, 0, -1), v3(0, 0, 1), &p, &n));
}

static void test_uv(void **state)
{
    (void)state;
    V2 a =
        shape_uv(unit_sphere(), 0, 0, 0, v3(0.55, 0.55, -sqrt(1 - 2 * 0.55 * 0.55))); /* probes */
    assert_true(fabs(a.u - 0.8644) < 1e-4 && fabs(a.v - 0.6854) < 1e-4);
    a = shape_uv(unit_sphere(), 0, 0, 0, v3(-0.55, -0.25, -sqrt(1 - 0.55 * 0.55 - 0.0625)));
    assert_true(fabs(a.u - 0.6538) < 1e-4 && fabs(a.v - 0.4196) < 1e-4);
    Shape *torus = shape_torus(arena, 1, 0.5);
    V3 p = {0}, n = {0};
    assert_true(trace(torus, v3(0.25, -0.25, -9), v3(0, 0, 1), &p, &n));
    a = shape_uv(torus, 0, 0, 0, p);
    assert_true(fabs(a.u - 0.7221) < 1e-4 && fabs(a.v - 0.4167) < 1e-4);
    a = shape_uv(unit_box(), 0, 0, 0, v3(-1, 0.5, 0.2));
    assert_true(fabs(a.u - 0.15) < 1e-12 && fabs(a.v - 1.75 / 3) < 1e-12);
    a = shape_uv(turned(unit_box(), v3(0, 0, 0), v3(3, 0, 0)), 3, 0, 0, v3(3.5, 1, -0.5));
    assert_true(fabs(a.u - 0.4375) < 1e-12 && fabs(a.v - 2.75 / 3) < 1e-12);
    a = shape_uv(shape_plane(arena, v3(0, 0, 1), 0), 0, 0, 0, v3(3, 4, 0));
    assert_true(a.u == 3 && a.v == 4);
}

/* Boxes: the ones the language reports, and tight ones for turned shapes. */
static void test_bounds(void **state)
{
    (void)state;
    Bound b = shape_bound(turned(scaled(unit_sphere(), v3(1, 2, 3)), v3(0, 0, 30), v3(0, 0, 0)));
    assert_near(b.hi, v3(sqrt(1.75), sqrt(3.25), 3), 1e-12);
    b = shape_bound(shape_cone(arena, v3(0, 0, 0), 1, v3(0, 2, 0), 0.5, false));
    assert_near(b.lo, v3(-1, 0, -1), 1e-12); /* probe */
    assert_near(b.hi, v3(1, 2, 1), 1e-12);
    b = shape_bound(shape_torus(arena, 1, 0.5));
    assert_near(b.hi, v3(1.5, 0.5, 1.5), 1e-12);
    b = shape_bound(turned(shape_torus(arena, 1, 0.5), v3(90, 0, 0), v3(0, 0, 0)));
    assert_near(b.hi, v3(1.5, 1.5, 0.5), 1e-12);
    assert_false(bound_is_finite(shape_bound(shape_plane(arena, v3(0, 1, 0), 1))));
    assert_false(bound_is_finite(shape_bound(shape_plane(arena, v3(1, 1, 0), 1))));
    Shape *inverse = unit_sphere();
    shape_invert(inverse);
    assert_true(bound_is_finite(shape_bound(inverse)));
}

static Shape *random_shape(uint32_t i, Rng *rng)
{
    double a = 0.2 + rng_double(rng), b = 0.2 + rng_double(rng);
    V3 p = v3(a, b - 1, 0.3), q = v3(-b, a, -0.4);
    Shape *s = i % 6 == 0   ? shape_sphere(arena, p, a)
               : i % 6 == 1 ? shape_box(arena, p, q)
               : i % 6 == 2 ? shape_cone(arena, p, a, q, b, false)
               : i % 6 == 3 ? shape_cone(arena, p, a, q, a, false)
               : i % 6 == 4 ? shape_torus(arena, a, 0.5 * b)
                            : shape_torus(arena, a, 1.1 * b);
    if (i % 4 == 1)
        turned(s, v3(30 * a, 200 * b, 50), v3(a, -b, 3));
    if (i % 4 == 2)
        turned(scaled(s, v3(a, -b, 0.7)), v3(20 * b, 10, 40 * a), v3(1, 2, 3));
    return s;
}

/* shape_is_met says what shape_closest says, for any part of the line. */
static void check_met(const Shape *shape, Ray ray, Rng *rng)
{
    Crossing first;
    for (int i = 0; i < 4; i++) {
        assert_int_equal(shape_is_met(shape, &ray, scratch),
                         shape_closest(shape, &ray, scratch, &first));
        ray.tmin = 8 * rng_double(rng);
        ray.tmax = ray.tmin + 4 * rng_double(rng);
    }
}

/* Between two crossings the state of a line is the state of its points; every crossing lies
 * in the box and its point on the surface; normals point out; shape_closest agrees. */
static void test_consistency(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 24000; i++) {
        Rng rng = rng_at(21, 1, i);
        Shape *shape = random_shape(i, &rng);
        V2 u = {rng_double(&rng), 0}, w = {rng_double(&rng), 0};
        u.v = rng_double(&rng), w.v = rng_double(&rng);
        Bound box = shape_bound(shape);
        assert_true(bound_is_finite(box));
        V3 target = v3_mad(bound_center(box), 0.7 * bound_radius(box), warp_sphere(w));
        Ray ray = {v3_mad(target, -5, warp_sphere(u)), warp_sphere(u), 0, INFINITY};
        CrossList list;
        shape_crossings(shape, &ray, scratch, &list);
        assert_false(list.is_inside_before);
        int inside = 0;
        double last = -100;
        for (int k = 0; k <= list.count; k++) {
            double t = k < list.count ? list.items[k].t : 100;
            double gap = t - last;
            assert_true(gap >= 0);
            if (gap > 1e-6)
                assert_int_equal(shape_is_inside(shape, ray_at(&ray, 0.5 * (t + last))), inside);
            if (k == list.count)
                break;
            const Crossing *c = &list.items[k];
            inside += c->change;
            last = t;
            ShapePoint point;
            shape_point(c, &ray, &point);
            assert_true(point.p.x >= box.lo.x && point.p.x <= box.hi.x && point.p.y >= box.lo.y &&
                        point.p.y <= box.hi.y && point.p.z >= box.lo.z && point.p.z <= box.hi.z);
            assert_true(fabs(v3_len(point.ng) - 1) < 1e-12);
            assert_true(point.p_error < 1e-12);
            assert_true(v3_dist(point.p, ray_at(&ray, t)) <=
                        2 * c->t_error + point.p_error + 1e-14);
            double away = v3_dot(point.ng, ray.d);
            if (c->change && fabs(away) > 1e-6)
                assert_true(away > 0 ? c->change < 0 : c->change > 0);
        }
        Crossing first;
        bool is_hit = shape_closest(shape, &ray, scratch, &first);
        int expected = 0;
        while (expected < list.count && !(list.items[expected].t > 0))
            expected++;
        assert_int_equal(is_hit, expected < list.count);
        if (is_hit)
            assert_true(first.t == list.items[expected].t);
        check_met(shape, ray, &rng);
    }
}

/* A ray that starts p_error off the surface does not meet it again where it starts. */
static void test_restart(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 24000; i++) {
        Rng rng = rng_at(22, 1, i);
        Shape *shape = random_shape(i, &rng);
        V2 u = {rng_double(&rng), 0}, w = {rng_double(&rng), 0};
        u.v = rng_double(&rng), w.v = rng_double(&rng);
        Bound box = shape_bound(shape);
        double away = i % 5 == 0 ? 1e6 : 5;
        Ray ray = {v3_mad(bound_center(box), -away, warp_sphere(u)), warp_sphere(u), 0, INFINITY};
        Crossing c;
        if (!shape_closest(shape, &ray, scratch, &c) || c.part >= 1)
            continue;
        ShapePoint point;
        shape_point(&c, &ray, &point);
        V3 d = warp_sphere(w);
        double side = v3_dot(d, point.ng);
        if (side < 0)
            d = v3_neg(d);
        Ray next = {v3_mad(point.p, point.p_error, point.ng), d, 0, INFINITY};
        check_met(shape, next, &rng);
        if (shape->kind != SHAPE_TORUS) {
            assert_false(shape_closest(shape, &next, scratch, &c)); /* convex */
        } else if (shape_closest(shape, &next, scratch, &c)) {
            assert_true(c.t > 1e-9);
        }
        next = (Ray){v3_mad(point.p, -point.p_error, point.ng), v3_neg(d), 0, INFINITY};
        assert_true(shape_closest(shape, &next, scratch, &c));
        check_met(shape, next, &rng);
    }
}

static void test_copy(void **state)
{
    (void)state;
    Shape *children[2] = {unit_sphere(), unit_box()};
    Shape *csg = shape_csg(arena, SHAPE_UNION, children, 2);
    Shape *copy = shape_copy(arena, csg);
    turned(copy, v3(0, 0, 0), v3(10, 0, 0));
    assert_near(children[0]->u.sphere.center, v3(0, 0, 0), 0);
    assert_near(copy->children[0]->u.sphere.center, v3(10, 0, 0), 0);
    assert_true(shape_is_solid(copy));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_sphere),   cmocka_unit_test(test_box),
        cmocka_unit_test(test_cone),     cmocka_unit_test(test_plane),
        cmocka_unit_test(test_torus),    cmocka_unit_test(test_disc),
        cmocka_unit_test(test_triangle), cmocka_unit_test(test_uv),
        cmocka_unit_test(test_bounds),   cmocka_unit_test(test_consistency),
        cmocka_unit_test(test_restart),  cmocka_unit_test(test_copy),
    };
    return cmocka_run_group_tests_name("shape", tests, set_up, tear_down);
}
