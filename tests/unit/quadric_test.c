/* Quadrics: crossings against the polynomial itself, points, insides and boxes.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape.h"

#include "base/rng.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

typedef struct Form {
    V3 square, mixed, linear;
    double constant;
} Form;

static double form_at(const Form *f, V3 p)
{
    return v3_dot(f->square, v3_mul(p, p)) + v3_dot(f->mixed, v3(p.x * p.y, p.x * p.z, p.y * p.z)) +
           v3_dot(f->linear, p) + f->constant;
}

static V3 gradient_at(const Form *f, V3 p)
{
    V3 m = f->mixed;
    return v3(2 * f->square.x * p.x + m.x * p.y + m.y * p.z + f->linear.x,
              2 * f->square.y * p.y + m.x * p.x + m.z * p.z + f->linear.y,
              2 * f->square.z * p.z + m.y * p.x + m.z * p.y + f->linear.z);
}

static V3 random_v3(Rng *rng, double size)
{
    double x = rng_double(rng), y = rng_double(rng), z = rng_double(rng);
    return v3((2 * x - 1) * size, (2 * y - 1) * size, (2 * z - 1) * size);
}

static Shape *make(Arena *arena, const Form *f)
{
    Shape *s = shape_quadric(arena, f->square, f->mixed, f->linear, f->constant);
    assert_non_null(s);
    shape_finish(arena, s);
    return s;
}

/* Random forms and lines: the state after each crossing is the sign of the form there, and points
 * are on the surface with its normal. */
static void test_crossings(void **state)
{
    (void)state;
    Arena *arena = arena_new();
    ShapeScratch *scratch = shape_scratch_new();
    int seen = 0;
    for (uint32_t i = 0; i < 4000; i++) {
        Rng rng = rng_at(11, 1, i);
        Form f = {random_v3(&rng, 1), random_v3(&rng, i % 3 ? 1 : 0),
                  random_v3(&rng, i % 5 ? 1 : 0), rng_double(&rng) - 0.5};
        if (i % 7 == 0)
            f.square.z = f.mixed.y = f.mixed.z = 0;
        Shape *s = make(arena, &f);
        Ray ray = {random_v3(&rng, 5), v3_unit(random_v3(&rng, 1)), -INFINITY, INFINITY};
        CrossList list;
        shape_crossings(s, &ray, scratch, &list);
        bool is_inside = list.is_inside_before;
        for (int k = 0; k <= list.count; k++) {
            double from = k > 0 ? list.items[k - 1].t : -1e4;
            double to = k < list.count ? list.items[k].t : 1e4;
            if (fabs(from) < 1e3 && fabs(to) < 1e3 && to - from > 1e-3) {
                V3 p = ray_at(&ray, 0.5 * (from + to));
                assert_true((form_at(&f, p) < 0) == is_inside);
                assert_true(shape_is_inside(s, p) == is_inside);
            }
            if (k == list.count)
                break;
            const Crossing *c = &list.items[k];
            assert_int_equal(c->change, is_inside ? -1 : 1);
            is_inside = !is_inside;
            if (fabs(c->t) > 100)
                continue;
            ShapePoint point;
            shape_point(c, &ray, &point);
            V3 g = gradient_at(&f, point.p);
            if (v3_len(g) < 1e-3)
                continue;
            assert_true(fabs(form_at(&f, point.p)) / v3_len(g) <= point.p_error);
            assert_true(v3_dist(point.ng, v3_unit(g)) < 1e-9);
            assert_true(point.p_error < 1e-7 && c->t_error < 1e-2);
            seen++;
        }
    }
    assert_true(seen > 2000);
    shape_scratch_free(scratch);
    arena_free(arena);
}

/* Ellipsoids of any place have tight boxes; cylinders along an axis are infinite along it only. */
static void test_bounds(void **state)
{
    (void)state;
    Arena *arena = arena_new();
    Form ball = {v3(1, 1, 1), v3(0, 0, 0), v3(-2, 0, 0), -3}; /* centre x, radius 2 */
    Bound b = shape_bound(make(arena, &ball));
    assert_true(fabs(b.lo.x + 1) < 1e-6 && fabs(b.hi.x - 3) < 1e-6 && fabs(b.hi.y - 2) < 1e-6);
    Form egg = {v3(1, 1, 4), v3(0.5, 0, 1), v3(0, 0, 0), -1};
    Shape *s = make(arena, &egg);
    Bound box = shape_bound(s);
    double most = 0;
    for (uint32_t i = 0; i < 20000; i++) {
        Rng rng = rng_at(11, 2, i);
        V3 d = v3_unit(random_v3(&rng, 1));
        V3 p = v3_scale(d, sqrt(1 / (form_at(&egg, d) + 1)));
        most = num_max(most, p.z);
        assert_true(p.x >= box.lo.x && p.x <= box.hi.x && p.z >= box.lo.z && p.z <= box.hi.z);
    }
    assert_true(box.hi.z < most * 1.01);
    Form tube = {v3(1, 0, 1), v3(0, 0, 0), v3(0, 0, 0), -1};
    Bound t = shape_bound(make(arena, &tube));
    assert_true(fabs(t.hi.x - 1) < 1e-6 && fabs(t.lo.z + 1) < 1e-6 && isinf(t.hi.y));
    Form hollow = {v3(-1, -1, -1), v3(0, 0, 0), v3(0, 0, 0), 1}; /* all but a ball is inside */
    Shape *h = make(arena, &hollow);
    assert_true(shape_is_inside(h, v3(5, 0, 0)) && !shape_is_inside(h, v3(0.5, 0, 0)));
    assert_true(isinf(shape_bound(h).hi.x));
    arena_free(arena);
}

/* A plane that is there twice, and what is only touched, are not seen. */
static void test_touched(void **state)
{
    (void)state;
    Arena *arena = arena_new();
    ShapeScratch *scratch = shape_scratch_new();
    Form twice = {v3(1, 0, 0), v3(0, 0, 0), v3(0, 0, 0), 0};
    Shape *s = make(arena, &twice);
    Crossing c;
    for (uint32_t i = 0; i < 200; i++) {
        Rng rng = rng_at(11, 3, i);
        Ray ray = {v3(-5, rng_double(&rng), 0), v3_unit(v3(1, rng_double(&rng), 0.3)), 0, INFINITY};
        assert_false(shape_closest(s, &ray, scratch, &c));
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
    Form f = {v3(1, -0.3, 0.7), v3(0.2, 0.1, 0), v3(0.1, -0.4, 0), -0.5};
    for (int e = -20; e <= 20; e += 5) {
        double size = ldexp(1, e);
        Shape *a = make(arena, &f), *b = make(arena, &f);
        Xform big = xform_scale(v3(size, size, size));
        shape_transform(b, &big);
        shape_finish(arena, b);
        for (uint32_t i = 0; i < 50; i++) {
            Rng rng = rng_at(11, 4, i);
            V3 o = random_v3(&rng, 4), d = v3_unit(random_v3(&rng, 1));
            Ray ray = {o, d, 0, INFINITY}, far = {v3_scale(o, size), d, 0, INFINITY};
            Crossing c, k;
            bool is_hit = shape_closest(a, &ray, scratch, &c);
            assert_true(shape_closest(b, &far, scratch, &k) == is_hit);
            if (!is_hit)
                continue;
            assert_true(k.t == c.t * size);
            ShapePoint p, q;
            shape_point(&c, &ray, &p);
            shape_point(&k, &far, &q);
            assert_true(v3_dist(q.p, v3_scale(p.p, size)) == 0 && v3_dist(p.ng, q.ng) == 0);
        }
    }
    shape_scratch_free(scratch);
    arena_free(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_crossings),
        cmocka_unit_test(test_bounds),
        cmocka_unit_test(test_touched),
        cmocka_unit_test(test_scale),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
