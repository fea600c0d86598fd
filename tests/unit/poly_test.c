/* Algebraic surfaces: crossings against samples of the polynomial in long double, tori against
 * the torus, sheets, and what stays the same far away.  SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape.h"

#include "base/rng.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

enum { TERMS = 8436 }; /* of degree 35 */

static long double poly_value(int degree, const double *c, V3 p)
{
    long double f = 0;
    for (int i = degree; i >= 0; i--)
        for (int j = degree - i; j >= 0; j--)
            for (int k = degree - i - j; k >= 0; k--)
                f += *c++ * powl(p.x, i) * powl(p.y, j) * powl(p.z, k);
    return f;
}

static V3 random_v3(Rng *rng, double size)
{
    double x = rng_double(rng), y = rng_double(rng), z = rng_double(rng);
    return v3((2 * x - 1) * size, (2 * y - 1) * size, (2 * z - 1) * size);
}

static Shape *make(Arena *arena, int degree, const double *c)
{
    Shape *s = shape_poly(arena, degree, c);
    assert_non_null(s);
    shape_finish(arena, s);
    return s;
}

/* The order of the coefficients. */
static void test_order(void **state)
{
    (void)state;
    for (int n = 2; n <= 35; n++) {
        int at = 0;
        for (int i = n; i >= 0; i--)
            for (int j = n - i; j >= 0; j--)
                for (int k = n - i - j; k >= 0; k--)
                    assert_int_equal(poly_term_index(n, i, j, k), at++);
        assert_int_equal(poly_term_count(n), at);
    }
}

/* Check the crossings of a line on [-3, 3] against samples. */
static int check_line(const Shape *s, int degree, const double *c, const Ray *ray,
                      ShapeScratch *scratch)
{
    CrossList list;
    shape_crossings(s, ray, scratch, &list);
    int next = 0, found = 0;
    bool is_inside = list.is_inside_before;
    enum { STEPS = 300 };
    for (int i = 0; i <= STEPS; i++) {
        double t = -3 + 6.0 * i / STEPS;
        for (; next < list.count && list.items[next].t < t; next++) {
            const Crossing *x = &list.items[next];
            is_inside ^= x->change != 0;
            ShapePoint point;
            shape_point(x, ray, &point);
            if (fabs(x->t) > 3)
                continue;
            long double f = poly_value(degree, c, point.p), h = 1e-5L;
            V3 away = v3_mad(point.p, (double)h, point.ng);
            double slope = (double)((poly_value(degree, c, away) - f) / h);
            if (slope < 1e-2)
                continue;
            assert_true(fabs((double)f) <= slope * point.p_error * 1.01);
            assert_true(point.p_error < 1e-9);
            found++;
        }
        V3 p = ray_at(ray, t);
        long double f = poly_value(degree, c, p);
        if (fabsl(f) > 1e-10L) {
            assert_true((f < 0) == is_inside);
            assert_true(shape_is_inside(s, p) == is_inside);
        }
    }
    return found;
}

static void test_samples(void **state)
{
    (void)state;
    Arena *arena = arena_new();
    ShapeScratch *scratch = shape_scratch_new();
    int found = 0;
    for (uint32_t i = 0; i < 60; i++) {
        Rng rng = rng_at(12, 1, i);
        int degree = 2 + (int)(i % 7);
        double *c = arena_array(arena, TERMS, sizeof *c);
        for (int k = 0; k < poly_term_count(degree); k++)
            c[k] = i % 2 && rng_u32(&rng) % 3 ? 0 : 2 * rng_double(&rng) - 1;
        Shape *s = make(arena, degree, c);
        for (int k = 0; k < 10; k++) {
            V3 o = random_v3(&rng, 1);
            V3 d = v3_unit(k == 0 ? v3(0, 0, 1) : random_v3(&rng, 1));
            Ray ray = {o, d, -INFINITY, INFINITY};
            found += check_line(s, degree, c, &ray, scratch);
        }
    }
    assert_true(found > 300);
    shape_scratch_free(scratch);
    arena_free(arena);
}

/* (r^2 + R^2 - a^2)^2 = 4 R^2 (x^2 + z^2) */
static Shape *torus_quartic(Arena *arena, double major, double minor)
{
    double c[35] = {0}, k = major * major - minor * minor, flat = 2 * k - 4 * major * major;
    c[poly_term_index(4, 4, 0, 0)] = c[poly_term_index(4, 0, 4, 0)] = 1;
    c[poly_term_index(4, 0, 0, 4)] = 1;
    c[poly_term_index(4, 2, 2, 0)] = c[poly_term_index(4, 2, 0, 2)] = 2;
    c[poly_term_index(4, 0, 2, 2)] = 2;
    c[poly_term_index(4, 2, 0, 0)] = c[poly_term_index(4, 0, 0, 2)] = flat;
    c[poly_term_index(4, 0, 2, 0)] = 2 * k;
    c[poly_term_index(4, 0, 0, 0)] = k * k;
    return make(arena, 4, c);
}

/* From anywhere, near and a million sizes away, the quartic is the torus, and light that leaves
 * it does not meet it where it starts. */
static void test_torus(void **state)
{
    (void)state;
    Arena *arena = arena_new();
    ShapeScratch *scratch = shape_scratch_new();
    Shape *quartic = torus_quartic(arena, 1, 0.5), *torus = shape_torus(arena, 1, 0.5);
    shape_finish(arena, torus);
    for (uint32_t i = 0; i < 6000; i++) {
        Rng rng = rng_at(12, 2, i);
        double far = pow(10, i % 7);
        V3 o = v3_scale(v3_unit(random_v3(&rng, 1)), 2 * far);
        Ray ray = {o, v3_unit(v3_sub(random_v3(&rng, 1.2), o)), 0, INFINITY};
        Crossing a, b;
        bool is_hit = shape_closest(torus, &ray, scratch, &a);
        bool is_same = shape_closest(quartic, &ray, scratch, &b) == is_hit;
        if (!is_hit || !is_same || fabs(a.t - b.t) > 1e-6) {
            /* Only where it is touched, and the sheet that makes is not far. */
            CrossList list;
            shape_crossings(torus, &ray, scratch, &list);
            assert_true(is_same || list.count == 0 || list.items[1].t - list.items[0].t < 1e-3);
            continue;
        }
        assert_true(fabs(a.t - b.t) <= a.t_error + b.t_error);
        ShapePoint p, q;
        shape_point(&a, &ray, &p);
        shape_point(&b, &ray, &q);
        assert_true(v3_dist(p.ng, q.ng) < 1e-6 + 4e-15 * far);
        assert_true(q.p_error < 1e-12);
        V3 d = v3_unit(random_v3(&rng, 1));
        if (v3_dot(d, q.ng) < 0)
            d = v3_neg(d);
        Ray from = {v3_mad(q.p, 2 * q.p_error, q.ng), d, 0, 10};
        if (shape_closest(quartic, &from, scratch, &b))
            assert_true(b.t > 1e-5 || v3_dot(d, q.ng) < 0.1);
        if (shape_closest(torus, &from, scratch, &a))
            assert_true(shape_closest(quartic, &from, scratch, &b));
    }
    shape_scratch_free(scratch);
    arena_free(arena);
}

/* A plane that is there three times is seen as one: its normal is that of the plane, and light that
 * leaves it does not meet it again. */
static void test_triple(void **state)
{
    (void)state;
    Arena *arena = arena_new();
    ShapeScratch *scratch = shape_scratch_new();
    double c[20] = {0};
    c[poly_term_index(3, 0, 3, 0)] = 1;
    Shape *s = make(arena, 3, c);
    shape_finish(arena, s);
    for (uint32_t i = 0; i < 2000; i++) {
        Rng rng = rng_at(12, 7, i);
        V3 o = random_v3(&rng, 1);
        o.y = 0.5 + fabs(o.y);
        Ray ray = {o, v3_unit(v3(o.z, -1, o.x)), 0, INFINITY};
        Crossing a, b;
        ShapePoint p;
        assert_true(shape_closest(s, &ray, scratch, &a));
        shape_point(&a, &ray, &p);
        assert_true(p.ng.y > 1 - 1e-9 && fabs(p.p.y) <= p.p_error);
        V3 d = random_v3(&rng, 1);
        d.y = 0.1 + fabs(d.y);
        Ray from = {v3_mad(p.p, 2 * p.p_error, p.ng), v3_unit(d), 0, INFINITY};
        assert_false(shape_closest(s, &from, scratch, &b));
    }
    shape_scratch_free(scratch);
    arena_free(arena);
}

/* The square of a sphere's equation is a sheet seen from both sides, everywhere. */
static void test_sheet(void **state)
{
    (void)state;
    Arena *arena = arena_new();
    ShapeScratch *scratch = shape_scratch_new();
    double c[35] = {0};
    for (int axis = 0; axis < 3; axis++) {
        int e[3] = {axis == 0, axis == 1, axis == 2};
        c[poly_term_index(4, 4 * e[0], 4 * e[1], 4 * e[2])] = 1;
        c[poly_term_index(4, 2 * e[0], 2 * e[1], 2 * e[2])] = -0.6;
        c[poly_term_index(4, 2 * !e[0], 2 * !e[1], 2 * !e[2])] = 2;
    }
    c[34] = 0.09;
    Shape *s = make(arena, 4, c);
    Xform turn = xform_rotate(v3(0.3, 0.7, 0.1)), move = xform_translate(v3(0.3, -0.2, 0.1));
    shape_transform(s, &turn);
    shape_transform(s, &move);
    shape_finish(arena, s);
    double radius = sqrt(0.3);
    V3 center = v3(0.3, -0.2, 0.1);
    for (uint32_t i = 0; i < 6000; i++) {
        Rng rng = rng_at(12, 3, i);
        double far = pow(10, i % 5);
        V3 o = v3_mad(center, far, v3_unit(random_v3(&rng, 1)));
        V3 at = v3_add(center, random_v3(&rng, 0.99 * radius / sqrt(3)));
        Ray ray = {o, v3_unit(v3_sub(at, o)), 0, INFINITY};
        CrossList list;
        shape_crossings(s, &ray, scratch, &list);
        assert_int_equal(list.count, 2);
        assert_false(list.is_inside_before);
        for (int k = 0; k < 2; k++) {
            const Crossing *x = &list.items[k];
            assert_true(x->change == 0 && x->is_visible);
            ShapePoint p;
            shape_point(x, &ray, &p);
            V3 n = v3_unit(v3_sub(p.p, center));
            assert_true(fabs(v3_dist(p.p, center) - radius) <= p.p_error && p.p_error < 1e-5);
            assert_true(fabs(v3_dot(n, p.ng)) > 1 - 1e-9);
            V3 d = v3_unit(random_v3(&rng, 1));
            double push = copysign(2 * p.p_error, v3_dot(p.ng, d));
            Ray from = {v3_mad(p.p, push, p.ng), d, 0, 10};
            Crossing y;
            if (shape_closest(s, &from, scratch, &y))
                assert_true(y.t > 1e-2 || fabs(v3_dot(n, d)) < 0.02);
        }
    }
    shape_scratch_free(scratch);
    arena_free(arena);
}

/* Scaled by powers of two, the same bits. */
static void test_scale(void **state)
{
    (void)state;
    Arena *arena = arena_new();
    ShapeScratch *scratch = shape_scratch_new();
    for (int e = -20; e <= 20; e += 5) {
        double size = ldexp(1, e);
        Shape *a = torus_quartic(arena, 1, 0.25), *b = torus_quartic(arena, 1, 0.25);
        Xform big = xform_scale(v3(size, size, size));
        shape_transform(b, &big);
        shape_finish(arena, b);
        for (uint32_t i = 0; i < 100; i++) {
            Rng rng = rng_at(12, 4, i);
            V3 o = random_v3(&rng, 4), d = v3_unit(v3_sub(random_v3(&rng, 1), o));
            Ray ray = {o, d, 0, INFINITY}, far = {v3_scale(o, size), d, 0, INFINITY};
            Crossing c, k;
            bool is_hit = shape_closest(a, &ray, scratch, &c);
            assert_true(shape_closest(b, &far, scratch, &k) == is_hit);
            if (!is_hit)
                continue;
            assert_true(k.t == c.t * size && k.t_error == c.t_error * size);
            ShapePoint p, q;
            shape_point(&c, &ray, &p);
            shape_point(&k, &far, &q);
            assert_true(v3_dist(q.p, v3_scale(p.p, size)) == 0 && v3_dist(p.ng, q.ng) == 0);
        }
    }
    shape_scratch_free(scratch);
    arena_free(arena);
}

/* Degree 35. */
static void test_high_degree(void **state)
{
    (void)state;
    Arena *arena = arena_new();
    ShapeScratch *scratch = shape_scratch_new();
    double *c = arena_array(arena, TERMS, sizeof *c);
    c[poly_term_index(35, 35, 0, 0)] = 1;
    c[poly_term_index(35, 0, 35, 0)] = 1;
    c[poly_term_index(35, 0, 0, 1)] = -1;
    Shape *s = make(arena, 35, c);
    Ray ray = {v3(0.9, 0.3, 5), v3(0, 0, -1), 0, INFINITY};
    Crossing x;
    assert_true(shape_closest(s, &ray, scratch, &x));
    double z = pow(0.9, 35) + pow(0.3, 35);
    assert_true(fabs(x.t - (5 - z)) <= x.t_error && x.t_error < 1e-9);
    Ray side = {v3(5, 0.3, 0.25), v3(-1, 0, 0), 0, INFINITY};
    assert_true(shape_closest(s, &side, scratch, &x));
    assert_true(fabs(x.t - (5 - pow(0.25, 1 / 35.))) < 1e-9);
    shape_scratch_free(scratch);
    arena_free(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_order),       cmocka_unit_test(test_samples),
        cmocka_unit_test(test_torus),       cmocka_unit_test(test_sheet),
        cmocka_unit_test(test_triple),      cmocka_unit_test(test_scale),
        cmocka_unit_test(test_high_degree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
