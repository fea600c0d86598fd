/* Shapes where numbers are hard: size, place, distance, grazing rays, thin shells; with an
 * oracle in quad precision for every error bound.  SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape.h"

#include "base/rng.h"
#include "math/sample.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

__extension__ typedef __float128 Quad;

#include "../unit/shape_kit.h"

/* --- the oracle: the implicit function of a part of a leaf, along the ray, in quad --------- */

typedef struct Q3 {
    Quad x, y, z;
} Q3;

static Q3 quad_point(const Shape *s, const Ray *r, Quad t)
{
    Q3 p = {r->o.x + t * r->d.x, r->o.y + t * r->d.y, r->o.z + t * r->d.z};
    if (!s->is_transformed)
        return p;
    const Xform *m = &s->xform;
    Quad q[3];
    for (int i = 0; i < 3; i++)
        q[i] = m->from[i][0] * p.x + m->from[i][1] * p.y + m->from[i][2] * p.z + m->from[i][3];
    return (Q3){q[0], q[1], q[2]};
}

static Quad implicit(const Shape *s, uint32_t part, const Ray *ray, Quad t)
{
    Q3 p = quad_point(s, ray, t);
    switch (s->kind) {
    case SHAPE_SPHERE: {
        Quad x = p.x - s->u.sphere.center.x, y = p.y - s->u.sphere.center.y;
        Quad z = p.z - s->u.sphere.center.z, r = s->u.sphere.radius;
        return x * x + y * y + z * z - r * r;
    }
    case SHAPE_BOX: {
        Quad c = part < 2 ? p.x : part < 4 ? p.y : p.z;
        V3 side = part & 1 ? s->u.box.hi : s->u.box.lo;
        return c - v3_at(side, (int)part / 2);
    }
    case SHAPE_CONE: {
        const ConeParams *c = &s->u.cone;
        if (part)
            return p.z - (part == 1 ? 0 : c->height);
        Quad r = c->bottom + ((Quad)c->top - c->bottom) / c->height * p.z;
        return p.x * p.x + p.y * p.y - r * r;
    }
    case SHAPE_PLANE: {
        V3 n = s->u.plane.normal;
        return p.x * n.x + p.y * n.y + p.z * n.z - s->u.plane.distance;
    }
    default: {
        Quad major = s->u.torus.major, minor = s->u.torus.minor, w = p.x * p.x + p.z * p.z;
        Quad k = w + p.y * p.y + major * major - minor * minor;
        return k * k - 4 * major * major * w;
    }
    }
}

/* Is there a root within the bound of a crossing? */
static bool is_honest(const Crossing *c, const Ray *ray)
{
    enum { STEPS = 64 };
    bool first = implicit(c->leaf, c->part, ray, (Quad)c->t - c->t_error) > 0;
    for (int i = 1; i <= STEPS; i++) {
        Quad t = (Quad)c->t + (Quad)c->t_error * (2 * i - STEPS) / STEPS;
        if ((implicit(c->leaf, c->part, ray, t) > 0) != first)
            return true;
    }
    return false;
}

/* A line that comes within its rounding of a tangent may have two crossings that are none; then
 * their bounds overlap. */
static bool is_touching(const CrossList *list, int k)
{
    for (int other = k - 1; other <= k + 1; other += 2) {
        if (other < 0 || other >= list->count)
            continue;
        const Crossing *a = &list->items[k], *b = &list->items[other];
        if (fabs(a->t - b->t) <= a->t_error + b->t_error)
            return true;
    }
    return false;
}

static Shape *random_shape(uint32_t i, Rng *rng, double size)
{
    double a = size * (0.2 + rng_double(rng)), b = size * (0.2 + rng_double(rng));
    V3 p = v3(a, b - size, 0.3 * size), q = v3(-b, a, -0.4 * size);
    double thin = i % 3 == 0 ? 1e-4 : 0.5;
    switch (i % 7) {
    case 0:
        return shape_sphere(arena, p, a);
    case 1:
        return shape_box(arena, p, q);
    case 2:
        return shape_cone(arena, p, a, q, b, false);
    case 3:
        return shape_cone(arena, p, a, q, a, true);
    case 4:
        return shape_torus(arena, a, thin * b);
    case 5:
        return shape_torus(arena, a, a + b);
    default:
        return shape_cone(arena, p, a * thin, q, 0, false);
    }
}

static void transform(Shape *shape, Rng *rng, uint32_t i, double size)
{
    Xform stretch = xform_scale(v3(0.3 + rng_double(rng), -1 - rng_double(rng), 0.7));
    Xform turn = xform_rotate(v3_scale(random_dir(rng), 3));
    Xform move = xform_translate(v3_scale(random_dir(rng), 4 * size));
    if (i & 1)
        shape_transform(shape, &stretch);
    if (i & 2)
        shape_transform(shape, &turn);
    if (i & 4)
        shape_transform(shape, &move);
}

/* Every crossing lies within its bound of the exact one, near and far, for big and small, plain
 * and transformed shapes, also where the ray only grazes them; and the bounds are small. */
static void test_error_bounds(void **state)
{
    (void)state;
    long seen = 0, liars = 0;
    for (uint32_t i = 0; i < 40000; i++) {
        Rng rng = rng_at(51, 1, i);
        double size = pow(10, 12 * rng_double(&rng) - 6), away = pow(10, 7 * rng_double(&rng));
        Shape *shape = random_shape(i, &rng, size);
        transform(shape, &rng, i / 7 % 8, size);
        Bound box = shape_bound(shape);
        V3 at =
            v3_mad(bound_center(box), 0.6 * bound_radius(box) * rng_double(&rng), random_dir(&rng));
        V3 d = random_dir(&rng);
        Ray ray = {v3_mad(at, -away * size, d), d, 0, INFINITY};
        Crossing c;
        if (i % 4 == 0 && shape_closest(shape, &ray, scratch, &c)) {
            /* Graze: turn the ray to a tangent of where it hit, off by a little. */
            ShapePoint point;
            shape_point(&c, &ray, &point);
            V3 side = v3_unit(v3_cross(point.ng, random_dir(&rng)));
            double depth = size * pow(10, -12 * rng_double(&rng));
            ray = (Ray){v3_mad(v3_mad(point.p, -depth, point.ng), -away * size, side), side, 0,
                        INFINITY};
        }
        CrossList list;
        shape_crossings(shape, &ray, scratch, &list);
        for (int k = 0; k < list.count; k++) {
            seen++;
            liars += !is_honest(&list.items[k], &ray) && !is_touching(&list, k);
            /* Away from grazing the bound is some ulps of the distance, not more. */
            ShapePoint point;
            shape_point(&list.items[k], &ray, &point);
            double slant = fabs(v3_dot(point.ng, d)), most = away * size + 10 * bound_radius(box);
            most += v3_len(bound_center(box));
            if (i % 4 && slant > 0.1 && shape->kind != SHAPE_TORUS)
                assert_true(list.items[k].t_error < 2e-13 * most / slant);
        }
    }
    assert_true(seen > 30000);
    assert_int_equal(liars, 0);
}

/* What a line misses it misses in quad precision too, but for a sliver. */
static void test_no_lost_hits(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 20000; i++) {
        Rng rng = rng_at(52, 1, i);
        Shape *shape =
            i % 2 ? shape_sphere(arena, v3(1, 2, 3), 1) : shape_torus(arena, 2, i % 3 ? 0.5 : 1e-3);
        double depth = pow(10, -12 * rng_double(&rng)), away = pow(10, 6 * rng_double(&rng));
        /* A tangent at a point of the surface, moved in by `depth` times the radius. */
        V3 n = random_dir(&rng), p;
        if (i % 2) {
            p = v3_mad(v3(1, 2, 3), 1 - depth, n);
        } else {
            double r = shape->u.torus.minor * (1 - depth), phi = 6 * rng_double(&rng);
            double psi = 6 * rng_double(&rng);
            n = v3(cos(psi) * cos(phi), sin(psi), cos(psi) * sin(phi));
            p = v3_mad(v3(2 * cos(phi), 0, 2 * sin(phi)), r, n);
        }
        V3 d = v3_unit(v3_cross(n, random_dir(&rng)));
        Ray ray = {v3_mad(p, -away, d), d, 0, INFINITY};
        double near = away * (1 - 0x1p-52); /* the middle of the chord is inside: count around it */
        Quad inside = implicit(shape, 0, &ray, near);
        CrossList list;
        shape_crossings(shape, &ray, scratch, &list);
        double noise = 64 * 0x1p-53 * (away + 5);
        if (inside < 0 && depth * (i % 2 ? 1 : shape->u.torus.minor) > noise) {
            int before = 0, after = 0;
            for (int k = 0; k < list.count; k++)
                *(list.items[k].t < away ? &before : &after) += 1;
            assert_true(before % 2 == 1 && after % 2 == 1);
        }
    }
}

/* --- invariance ------------------------------------------------------------------------- */

/* One shape of each kind, and CSG of them, built at a size of s. */
static Shape *scene_shape(int which, double s)
{
    V3 corner[3] = {{0, 0, 0.1 * s}, {s, 0.3 * s, 0}, {0, s, -0.7 * s}};
    switch (which) {
    case 0:
        return shape_sphere(arena, v3(0.1 * s, 0.2 * s, 0.3 * s), 0.9 * s);
    case 1:
        return shape_box(arena, v3(-0.3 * s, -0.7 * s, -s), v3(0.6 * s, 0.2 * s, 0.9 * s));
    case 2:
        return shape_cone(arena, v3(0.1 * s, -s, 0), 0.7 * s, v3(0, s, 0.2 * s), 0.2 * s, false);
    case 3:
        return shape_plane(arena, v3(0.1, 1, 0.3), 0.2 * s);
    case 4:
        return shape_torus(arena, 0.8 * s, 0.3 * s);
    case 5:
        return shape_torus(arena, 0.4 * s, 0.6 * s);
    case 6:
        return shape_disc(arena, v3(0.1 * s, 0, 0), v3(0.2, 1, 0.4), s, 0.2 * s);
    case 7:
        return shape_triangle(arena, corner, NULL);
    default: {
        Shape **children = ARENA_ARRAY(arena, Shape *, 3);
        children[0] = scene_shape(0, s);
        children[1] = scene_shape(which == 8 ? 1 : 4, s);
        children[2] = scene_shape(2, s);
        shape_invert(children[2]);
        Shape *csg = shape_csg(arena, SHAPE_INTERSECTION, children, 3);
        shape_finish(arena, csg);
        return csg;
    }
    }
}
enum { SCENE_SHAPES = 10 };

/* Scaling by a power of two scales t, its error and the point, and changes no bit of them. */
static void test_scale(void **state)
{
    (void)state;
    static const int powers[6] = {-60, -20, -1, 3, 20, 60};
    for (int which = 0; which < SCENE_SHAPES; which++) {
        for (int power = 0; power < 6; power++) {
            double s = ldexp(1, powers[power]);
            Shape *a = scene_shape(which, 1), *b = scene_shape(which, s);
            for (uint32_t i = 0; i < 300; i++) {
                Rng rng = rng_at(53, (uint32_t)which, i);
                V3 o = v3_scale(random_dir(&rng), 3), d = random_dir(&rng);
                if (i % 2)
                    d = v3_unit(v3_sub(v3_scale(random_dir(&rng), 0.7), o));
                Ray ray = {o, d, 0, INFINITY}, big = {v3_scale(o, s), d, 0, INFINITY};
                Crossing c, e;
                bool is_hit = shape_closest(a, &ray, scratch, &c);
                assert_int_equal(shape_closest(b, &big, scratch, &e), is_hit);
                if (!is_hit)
                    continue;
                assert_true(e.t == c.t * s);
                assert_true(e.t_error == c.t_error * s);
                assert_int_equal(e.part, c.part);
                ShapePoint p, q;
                shape_point(&c, &ray, &p);
                shape_point(&e, &big, &q);
                assert_true(v3_dist(q.p, v3_scale(p.p, s)) == 0);
                assert_true(v3_dist(q.ng, p.ng) == 0);
                assert_true(q.p_error == p.p_error * s);
            }
        }
    }
}

/* Moving shape and ray together changes t only within the bounds. */
static void test_shift(void **state)
{
    (void)state;
    static const double places[3] = {1, 1e3, 1e6};
    for (int which = 0; which < 8; which++) {
        for (int k = 0; k < 3; k++) {
            V3 by = v3_scale(v3(0.7, -1, 0.4), places[k]);
            Xform move = xform_translate(by);
            Shape *a = scene_shape(which, 1), *b = scene_shape(which, 1);
            shape_transform(b, &move);
            for (uint32_t i = 0; i < 1000; i++) {
                Rng rng = rng_at(54, (uint32_t)which, i);
                V3 o = v3_scale(random_dir(&rng), 3);
                V3 d = v3_unit(v3_sub(v3_scale(random_dir(&rng), 0.7), o));
                Ray ray = {o, d, 0, INFINITY}, moved = {v3_add(o, by), d, 0, INFINITY};
                Crossing c, e;
                bool is_hit = shape_closest(a, &ray, scratch, &c);
                bool is_too = shape_closest(b, &moved, scratch, &e);
                if (is_hit != is_too || !is_hit || c.part != e.part)
                    continue; /* past an edge; counted as luck, the next line sees the rest */
                /* The moved origin itself is rounded: that much more. */
                double slope = fabs(e.t_error) + fabs(c.t_error);
                assert_true(fabs(c.t - e.t) <= 2 * slope);
            }
        }
    }
}

/* A camera that backs away along the ray sees the same point, to the rounding of its place. */
static void test_distance(void **state)
{
    (void)state;
    for (int which = 0; which < SCENE_SHAPES; which++) {
        Shape *shape = scene_shape(which, 1);
        for (uint32_t i = 0; i < 500; i++) {
            Rng rng = rng_at(55, (uint32_t)which, i);
            V3 d = random_dir(&rng), at = v3_scale(random_dir(&rng), 0.5);
            double away = pow(10, 7 * rng_double(&rng));
            Ray near = {v3_mad(at, -4, d), d, 0, INFINITY}, far = near;
            far.o = v3_mad(at, -away - 4, d);
            Crossing c, e;
            if (!shape_closest(shape, &near, scratch, &c) ||
                !shape_closest(shape, &far, scratch, &e) || c.leaf != e.leaf || c.part != e.part)
                continue;
            ShapePoint p, q;
            shape_point(&c, &near, &p);
            shape_point(&e, &far, &q);
            double slant = fabs(v3_dot(p.ng, d));
            if (slant > 0.01)
                assert_true(v3_dist(p.p, q.p) <= 2e-15 * (away + 10) / slant / slant + 1e-13);
            assert_true(q.p_error < 1e-13 * (1 + v3_len(q.p))); /* pulled onto the surface */
        }
    }
}

/* Shells thinner than a millionth of a millionth keep both walls, near and at some distance. */
static void test_thin_shells(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 2000; i++) {
        Rng rng = rng_at(56, 1, i);
        Shape *children[2] = {shape_sphere(arena, v3(1, -2, 0.5), 1),
                              shape_sphere(arena, v3(1, -2, 0.5), 1 - 1e-12)};
        shape_invert(children[1]);
        Shape *shell = shape_csg(arena, SHAPE_INTERSECTION, children, 2);
        V3 at = v3_mad(v3(1, -2, 0.5), 0.8 * rng_double(&rng), random_dir(&rng));
        V3 d = random_dir(&rng);
        Ray ray = {v3_mad(at, -5, d), d, 0, INFINITY};
        CrossList list;
        shape_crossings(shell, &ray, scratch, &list);
        assert_int_equal(list.count, 4);
        for (int k = 0; k < 4; k++) {
            assert_ptr_equal(list.items[k].leaf, children[k == 1 || k == 2]);
            assert_int_equal(list.items[k].change, k % 2 ? -1 : 1);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_error_bounds), cmocka_unit_test(test_no_lost_hits),
        cmocka_unit_test(test_scale),        cmocka_unit_test(test_shift),
        cmocka_unit_test(test_distance),     cmocka_unit_test(test_thin_shells),
    };
    return cmocka_run_group_tests_name("shape_hard", tests, set_up, tear_down);
}
