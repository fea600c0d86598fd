/* Blobs: known crossings, random ones against samples of the field, looks, and what scaling
 * and distance leave as it is.  SPDX-License-Identifier: Apache-2.0 */
#include "shape/mesh.h"
#include "shape/shape.h"

#include "base/rng.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

static BlobComponent ball(V3 center, double radius, double strength)
{
    Xform scale = xform_scale(v3(radius, radius, radius)), move = xform_translate(center);
    return (BlobComponent){
        .place = xform_then(&scale, &move), .strength = strength, .texture = MESH_NO_TEXTURE};
}

static BlobComponent tube(V3 from, V3 to, double radius, double strength)
{
    V3 n = v3_unit(v3_sub(to, from)), s, t;
    v3_frame(n, &s, &t);
    Xform scale = xform_scale(v3(radius, radius, radius)), frame = xform_frame(s, t, n, from);
    return (BlobComponent){.place = xform_then(&scale, &frame),
                           .length = v3_dist(from, to) / radius,
                           .strength = strength,
                           .texture = MESH_NO_TEXTURE};
}

static Shape *make(Arena *arena, double threshold, const BlobComponent *c, uint32_t count)
{
    Shape *s = shape_blob(arena, threshold, c, count, false);
    assert_non_null(s);
    shape_finish(arena, s);
    return s;
}

static V3 random_v3(Rng *rng, double size)
{
    double x = rng_double(rng), y = rng_double(rng), z = rng_double(rng);
    return v3((2 * x - 1) * size, (2 * y - 1) * size, (2 * z - 1) * size);
}

static double field_of(const BlobComponent *c, uint32_t count, V3 p)
{
    double sum = 0;
    for (uint32_t i = 0; i < count; i++) {
        V3 u = xform_point_back(&c[i].place, p);
        u.z -= u.z < 0 ? 0 : u.z > c[i].length ? c[i].length : u.z;
        double q = v3_len2(u);
        sum += q < 1 ? c[i].strength * (1 - q) * (1 - q) : 0;
    }
    return sum;
}

static void expect_hit(const Shape *s, V3 o, V3 d, V3 at, V3 n)
{
    ShapeScratch *scratch = shape_scratch_new();
    Ray ray = {o, d, 0, INFINITY};
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
    V3 o = v3(0, 0, 0), x = v3(1, 0, 0), none = o;
    BlobComponent one = ball(o, 2, 1);
    expect_hit(make(arena, 0.5, &one, 1), v3(-5, 0, 0), x, v3(-1.082392, 0, 0), v3(-1, 0, 0));
    one = ball(o, 1, 2);
    expect_hit(make(arena, 1, &one, 1), v3(5, 0, 0), v3(-1, 0, 0), v3(0.541196, 0, 0), x);
    one = tube(o, v3(2, 0, 0), 1, 1);
    Shape *s = make(arena, 0.3, &one, 1);
    expect_hit(s, v3(1, 5, 0), v3(0, -1, 0), v3(1, 0.672516, 0), v3(0, 1, 0));
    expect_hit(s, v3(5, 0, 0), v3(-1, 0, 0), v3(2.672516, 0, 0), x);
    one = ball(o, 1, 1);
    Xform wide = xform_scale(v3(2, 1, 1));
    one.place = xform_then(&one.place, &wide);
    s = make(arena, 0.3, &one, 1);
    expect_hit(s, v3(5, 0, 0), v3(-1, 0, 0), v3(1.345032, 0, 0), none);
    expect_hit(s, v3(1, 5, 0), v3(0, -1, 0), v3(1, 0.449753, 0), v3(0.485847, 0.874044, 0));
    BlobComponent two[] = {ball(o, 1, 2), ball(v3(0.5, 0, 0), 0.5, -1)};
    expect_hit(make(arena, 0.5, two, 2), v3(5, 0, 0), v3(-1, 0, 0), v3(0.397545, 0, 0), x);
    Bound b = shape_bound(make(arena, 0.5, two, 2));
    assert_true(fabs(b.hi.x - 1) < 1e-6 && fabs(b.lo.y + 1) < 1e-6);
    arena_free(arena);
}

enum { MANY = 120 };

static void random_components(uint32_t seed, BlobComponent *c, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        Rng rng = rng_at(13, seed, i);
        V3 at = random_v3(&rng, 1), to = random_v3(&rng, 1);
        double radius = 0.2 + 0.5 * rng_double(&rng), strength = 1.6 * rng_double(&rng) - 0.4;
        c[i] = i % 3 == 0 ? tube(at, to, radius, strength) : ball(at, radius, strength);
        if (i % 4 == 0) {
            Xform squeeze = xform_scale(v3(1, 0.7, 1.3));
            c[i].place = xform_then(&c[i].place, &squeeze);
        }
    }
}

/* Crossings follow the sign of the field; points are on the surface with its normal. */
static void check_line(const Shape *s, const BlobComponent *c, uint32_t count, double threshold,
                       const Ray *ray, ShapeScratch *scratch, int *found)
{
    CrossList list;
    shape_crossings(s, ray, scratch, &list);
    bool is_inside = list.is_inside_before;
    assert_true(is_inside == (threshold < 0));
    int next = 0;
    for (int i = 0; i <= 600; i++) {
        double t = -4 + 8.0 * i / 600;
        for (; next < list.count && list.items[next].t < t; next++) {
            const Crossing *x = &list.items[next];
            assert_int_equal(x->change, is_inside ? -1 : 1);
            is_inside = !is_inside;
            ShapePoint point;
            shape_point(x, ray, &point);
            double f = field_of(c, count, point.p) - threshold, h = 1e-6;
            double slope = (field_of(c, count, v3_mad(point.p, -h, point.ng)) - threshold - f) / h;
            if (slope < 0.05)
                continue;
            assert_true(fabs(f) <= slope * point.p_error * 1.1 + 1e-15);
            assert_true(point.p_error < 1e-11 && x->t_error < 1e-6);
            (*found)++;
        }
        double f = field_of(c, count, ray_at(ray, t)) - threshold;
        if (fabs(f) > 1e-12) {
            assert_true((f > 0) == is_inside);
            assert_true(shape_is_inside(s, ray_at(ray, t)) == is_inside);
        }
    }
    /* Going on from each finds the next. */
    Ray walk = {ray->o, ray->d, -100, INFINITY};
    Crossing at;
    int steps = 0;
    for (; shape_closest(s, &walk, scratch, &at); steps++, walk.tmin = at.t)
        assert_true(at.t > walk.tmin && steps < 1000);
    /* The first one alone. */
    Ray from = {ray->o, ray->d, 0, INFINITY};
    Crossing first;
    bool is_hit = shape_closest(s, &from, scratch, &first);
    shape_crossings(s, ray, scratch, &list);
    for (int i = 0; i < list.count; i++)
        if (list.items[i].t > 0) {
            assert_true(is_hit);
            assert_true(fabs(first.t - list.items[i].t) <= first.t_error + list.items[i].t_error);
            return;
        }
    assert_false(is_hit);
}

static void test_random(void **state)
{
    (void)state;
    Arena *arena = arena_new();
    ShapeScratch *scratch = shape_scratch_new();
    BlobComponent c[MANY];
    int found = 0;
    for (uint32_t i = 0; i < 60; i++) {
        uint32_t count = i % 10 == 0 ? MANY : 1 + i % 12;
        double threshold = i % 15 == 1 ? -0.2 : 0.2 + 0.1 * (i % 5);
        random_components(i, c, count);
        Shape *s = make(arena, threshold, c, count);
        for (uint32_t k = 0; k < 15; k++) {
            Rng rng = rng_at(13, 1000 + i, k);
            V3 o = random_v3(&rng, 1.2), d = k == 0 ? v3(0, 0, 1) : v3_unit(random_v3(&rng, 1));
            Ray ray = {o, d, -INFINITY, INFINITY};
            check_line(s, c, count, threshold, &ray, scratch, &found);
        }
    }
    assert_true(found > 500);
    shape_scratch_free(scratch);
    arena_free(arena);
}

/* A million sizes away the same surface is met, and light that leaves it does not meet it where
 * it starts. */
static void test_far(void **state)
{
    (void)state;
    Arena *arena = arena_new();
    ShapeScratch *scratch = shape_scratch_new();
    BlobComponent c[20];
    random_components(77, c, 20);
    Shape *s = make(arena, 0.3, c, 20);
    int hits = 0;
    for (uint32_t i = 0; i < 3000; i++) {
        Rng rng = rng_at(13, 3, i);
        double far = pow(10, i % 7);
        V3 o = v3_scale(v3_unit(random_v3(&rng, 1)), 4 * far);
        Ray ray = {o, v3_unit(v3_sub(random_v3(&rng, 0.5), o)), 0, INFINITY};
        Crossing x;
        if (!shape_closest(s, &ray, scratch, &x))
            continue;
        ShapePoint p;
        shape_point(&x, &ray, &p);
        assert_true(fabs(field_of(c, 20, p.p) - 0.3) < 1e-12 && p.p_error < 1e-10);
        V3 d = v3_unit(random_v3(&rng, 1));
        d = v3_dot(d, p.ng) < 0 ? v3_neg(d) : d;
        Ray from = {v3_mad(p.p, 2 * p.p_error, p.ng), d, 0, INFINITY};
        if (shape_closest(s, &from, scratch, &x))
            assert_true(x.t > 1e-6 || v3_dot(d, p.ng) < 0.01);
        hits++;
    }
    assert_true(hits > 1000);
    shape_scratch_free(scratch);
    arena_free(arena);
}

/* Scaled by powers of two, the same bits. */
static void test_scale(void **state)
{
    (void)state;
    Arena *arena = arena_new();
    ShapeScratch *scratch = shape_scratch_new();
    BlobComponent c[9];
    random_components(5, c, 9);
    for (int e = -20; e <= 20; e += 5) {
        double size = ldexp(1, e);
        Shape *a = make(arena, 0.3, c, 9), *b = make(arena, 0.3, c, 9);
        Xform big = xform_scale(v3(size, size, size));
        shape_transform(b, &big);
        shape_finish(arena, b);
        for (uint32_t i = 0; i < 100; i++) {
            Rng rng = rng_at(13, 4, i);
            V3 o = random_v3(&rng, 4), d = v3_unit(v3_sub(random_v3(&rng, 1), o));
            Ray ray = {o, d, 0, INFINITY}, far = {v3_scale(o, size), d, 0, INFINITY};
            Crossing x, y;
            bool is_hit = shape_closest(a, &ray, scratch, &x);
            assert_true(shape_closest(b, &far, scratch, &y) == is_hit);
            if (!is_hit)
                continue;
            assert_true(y.t == x.t * size && y.t_error == x.t_error * size);
            ShapePoint p, q;
            shape_point(&x, &ray, &p);
            shape_point(&y, &far, &q);
            assert_true(v3_dist(q.p, v3_scale(p.p, size)) == 0 && v3_dist(p.ng, q.ng) == 0);
        }
    }
    shape_scratch_free(scratch);
    arena_free(arena);
}

/* Looks are blended by the strengths of the fields. */
static void test_blend(void **state)
{
    (void)state;
    Arena *arena = arena_new();
    BlobComponent c[] = {ball(v3(0, 0, 0), 1, 1), ball(v3(0.5, 0, 0), 1, 2),
                         ball(v3(9, 0, 0), 1, 1)};
    c[0].texture = 7;
    Shape *s = shape_blob(arena, 0.5, c, 3, true);
    ShapeBlend blend;
    assert_true(shape_blend(s, v3(0.2, 0.1, 0), &blend));
    double a = field_of(c, 1, v3(0.2, 0.1, 0)), b = field_of(c + 1, 1, v3(0.2, 0.1, 0));
    assert_int_equal(blend.count, 2);
    int own = blend.texture[0] == 7 ? 0 : 1;
    assert_true(blend.texture[1 - own] == MESH_NO_TEXTURE);
    assert_true(fabs(blend.weight[own] - a / (a + b)) < 1e-12);
    assert_true(fabs(blend.weight[1 - own] - b / (a + b)) < 1e-12);
    assert_false(shape_blend(shape_blob(arena, 0.5, c, 3, false), v3(0, 0, 0), &blend));
    arena_free(arena);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_known), cmocka_unit_test(test_random), cmocka_unit_test(test_far),
        cmocka_unit_test(test_scale), cmocka_unit_test(test_blend),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
