/* Superellipsoids: known crossings, random exponents against samples, flat and spiky ones.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape.h"

#include "base/rng.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

static Shape *make(Arena *arena, double e, double n)
{
    Shape *s = shape_superellipsoid(arena, e, n);
    assert_non_null(s);
    shape_finish(arena, s);
    return s;
}

static V3 random_v3(Rng *rng, double size)
{
    double x = rng_double(rng), y = rng_double(rng), z = rng_double(rng);
    return v3((2 * x - 1) * size, (2 * y - 1) * size, (2 * z - 1) * size);
}

/* The norm in long double, scaled so that nothing overflows. */
static long double norm_of(double e, double n, V3 p)
{
    long double x = fabs(p.x), y = fabs(p.y), z = fabs(p.z), a = fmaxl(x, y);
    long double flat =
        a > 0 ? a * powl(powl(x / a, 2 / (long double)e) + powl(y / a, 2 / (long double)e),
                         (long double)e / 2)
              : 0;
    long double most = fmaxl(flat, z);
    return most > 0 ? most * powl(powl(flat / most, 2 / (long double)n) +
                                      powl(z / most, 2 / (long double)n),
                                  (long double)n / 2)
                    : 0;
}

static void expect_hit(const Shape *s, V3 o, V3 d, V3 at, V3 n)
{
    ShapeScratch *scratch = shape_scratch_new();
    Ray ray = {o, v3_unit(d), 0, INFINITY};
    Crossing c;
    assert_true(shape_closest(s, &ray, scratch, &c));
    ShapePoint p;
    shape_point(&c, &ray, &p);
    assert_true(v3_dist(p.p, at) < 2e-6);
    if (v3_len(n) > 0)
        assert_true(v3_dist(p.ng, n) < 2e-6);
    shape_scratch_free(scratch);
}

/* What povray shows. */
static void test_known(void **state)
{
    (void)state;
    Arena *arena = arena_new();
    Shape *s = make(arena, 0.3, 0.6);
    V3 none = v3(0, 0, 0);
    expect_hit(s, v3(5, 5, 5), v3(-1, -1, -1), v3(0.767657, 0.767657, 0.767657),
               v3(0.5, 0.5, 0.7071068));
    expect_hit(s, v3(5, 5, 0), v3(-1, -1, 0), v3(0.901250, 0.901250, 0), none);
    expect_hit(s, v3(5, 0, 5), v3(-1, 0, -1), v3(0.812252, 0, 0.812252), none);
    s = make(arena, 0.5, 2);
    expect_hit(s, v3(0.1, 0.2, -5), v3(0, 0, 1), v3(0.1, 0.2, -0.7969457),
               v3(0.0860367, 0.6882939, -0.7203119));
    arena_free(arena);
}

static int check_line(const Shape *s, double e, double n, const Ray *ray, ShapeScratch *scratch)
{
    CrossList list;
    shape_crossings(s, ray, scratch, &list);
    assert_false(list.is_inside_before);
    bool is_inside = false;
    int next = 0, found = 0;
    for (int i = 0; i <= 1000; i++) {
        double t = -4 + 8.0 * i / 1000;
        for (; next < list.count && list.items[next].t < t; next++) {
            const Crossing *x = &list.items[next];
            assert_int_equal(x->change, is_inside ? -1 : 1);
            is_inside = !is_inside;
            ShapePoint point;
            shape_point(x, ray, &point);
            assert_true(fabs((double)(norm_of(e, n, point.p) - 1)) < 1e-12);
            assert_true(v3_dist(point.p, ray_at(ray, x->t)) < 1e-6 || e > 2 || n > 2);
            assert_true(fabs(v3_len(point.ng) - 1) < 1e-12 && point.p_error < 1e-12);
            found++;
        }
        V3 p = ray_at(ray, t);
        long double f = norm_of(e, n, p) - 1;
        if (fabsl(f) > 1e-9L) {
            assert_true((f < 0) == is_inside);
            assert_true(shape_is_inside(s, p) == is_inside);
        }
    }
    assert_int_equal(next, list.count);
    return found;
}

static void test_random(void **state)
{
    (void)state;
    static const double exponents[] = {1e-3, 0.02, 0.1, 0.3, 0.7, 1, 1.5, 2, 2.5, 3, 5};
    enum { EXPONENTS = sizeof exponents / sizeof exponents[0] };
    Arena *arena = arena_new();
    ShapeScratch *scratch = shape_scratch_new();
    int found = 0;
    for (uint32_t i = 0; i < EXPONENTS * EXPONENTS; i++) {
        double e = exponents[i % EXPONENTS], n = exponents[i / EXPONENTS];
        Shape *s = make(arena, e, n);
        for (uint32_t k = 0; k < 25; k++) {
            Rng rng = rng_at(14, i, k);
            V3 o = random_v3(&rng, k % 2 ? 0.9 : 0.3), d = v3_unit(random_v3(&rng, 1));
            if (k < 3) /* along an axis */
                d = v3(k == 0, k == 1, k == 2);
            Ray ray = {o, d, -INFINITY, INFINITY};
            found += check_line(s, e, n, &ray, scratch);
        }
    }
    assert_true(found > 2000);
    shape_scratch_free(scratch);
    arena_free(arena);
}

/* Normals against differences of the norm. */
static void test_normals(void **state)
{
    (void)state;
    Arena *arena = arena_new();
    ShapeScratch *scratch = shape_scratch_new();
    static const double exponents[][2] = {{0.3, 0.6}, {1, 1}, {2, 0.5}, {3, 1.5}, {0.5, 4}};
    for (uint32_t i = 0; i < 5; i++) {
        double e = exponents[i][0], n = exponents[i][1], h = 1e-6;
        Shape *s = make(arena, e, n);
        for (uint32_t k = 0; k < 300; k++) {
            Rng rng = rng_at(14, 1000 + i, k);
            V3 o = v3_scale(v3_unit(random_v3(&rng, 1)), 5);
            Ray ray = {o, v3_unit(v3_sub(random_v3(&rng, 0.4), o)), 0, INFINITY};
            Crossing c;
            if (!shape_closest(s, &ray, scratch, &c))
                continue;
            ShapePoint point;
            shape_point(&c, &ray, &point);
            V3 p = point.p, a = v3(fabs(p.x), fabs(p.y), fabs(p.z));
            if (num_min(num_min(a.x, a.y), a.z) < 0.02)
                continue;
            V3 g = v3((double)(norm_of(e, n, v3(p.x + h, p.y, p.z)) -
                               norm_of(e, n, v3(p.x - h, p.y, p.z))),
                      (double)(norm_of(e, n, v3(p.x, p.y + h, p.z)) -
                               norm_of(e, n, v3(p.x, p.y - h, p.z))),
                      (double)(norm_of(e, n, v3(p.x, p.y, p.z + h)) -
                               norm_of(e, n, v3(p.x, p.y, p.z - h))));
            assert_true(v3_dist(v3_unit(g), point.ng) < 1e-5);
        }
    }
    shape_scratch_free(scratch);
    arena_free(arena);
}

/* From far away, and scaled by powers of two, it stays the same; light that leaves it does not
 * meet it where it starts. */
static void test_far(void **state)
{
    (void)state;
    Arena *arena = arena_new();
    ShapeScratch *scratch = shape_scratch_new();
    Shape *s = make(arena, 0.2, 0.4), *b = make(arena, 0.2, 0.4);
    Xform big = xform_scale(v3(0x1p-20, 0x1p-20, 0x1p-20));
    shape_transform(b, &big);
    shape_finish(arena, b);
    for (uint32_t i = 0; i < 3000; i++) {
        Rng rng = rng_at(14, 3, i);
        double far = pow(10, i % 7);
        V3 o = v3_scale(v3_unit(random_v3(&rng, 1)), 4 * far);
        V3 way = v3_unit(v3_sub(random_v3(&rng, 0.8), o));
        Ray ray = {o, way, 0, INFINITY}, small = {v3_scale(o, 0x1p-20), way, 0, INFINITY};
        Crossing c, k;
        assert_true(shape_closest(s, &ray, scratch, &c));
        assert_true(shape_closest(b, &small, scratch, &k));
        assert_true(k.t == c.t * 0x1p-20);
        ShapePoint p;
        shape_point(&c, &ray, &p);
        V3 d = v3_unit(random_v3(&rng, 1));
        d = v3_dot(d, p.ng) < 0 ? v3_neg(d) : d;
        Ray from = {v3_mad(p.p, 2 * p.p_error, p.ng), d, 0, INFINITY};
        assert_false(shape_closest(s, &from, scratch, &c));
    }
    shape_scratch_free(scratch);
    arena_free(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_known),
        cmocka_unit_test(test_random),
        cmocka_unit_test(test_normals),
        cmocka_unit_test(test_far),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
