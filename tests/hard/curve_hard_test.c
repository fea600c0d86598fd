/* Curved shapes where numbers are hard: scaled by powers of two, seen from far away, grazed.
 * SPDX-License-Identifier: Apache-2.0 */
#include "math/bernstein.h"
#include "shape/shape.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include "../unit/shape_kit.h"

enum { SHAPES = 9, LINES = 1500 };

static double outline[9][2] = {{-1, .2},  {0, -1}, {1, -.7}, {.8, .5}, {.2, .1},
                               {-.5, .9}, {0, -1}, {1, -.7}, {.8, .5}};
static double profile[7][2] = {{0, -1}, {.3, -1}, {.9, -.3}, {.4, .2}, {.7, .6}, {.2, .9}, {0, 1}};
static double balls[6][4] = {{-1, 0, 0, .3},    {-.5, .2, .3, .2}, {.1, -.4, 0, .3},
                             {.5, .3, -.3, .1}, {.9, 0, .4, .3},   {0, .8, 0, .2}};

static CurveSpan *spans_of(SplineKind kind, double (*points)[2], int count, uint32_t *spans)
{
    *spans = (uint32_t)spline_span_count(kind, count);
    CurveSpan *out = arena_alloc(arena, *spans * sizeof *out);
    for (uint32_t i = 0; i < *spans; i++) {
        spline_span(kind, &points[0][0], 2, (int)i, out[i].a);
        spline_span(kind, &points[0][1], 2, (int)i, out[i].b);
    }
    return out;
}

static Shape *prism(SplineKind kind, bool is_conic)
{
    PrismForm form = {.lo = is_conic ? .125 : -.5, .hi = 1, .is_conic = is_conic};
    form.degree = spline_degree(kind);
    /* Linear: from the second point to the one that repeats it. */
    bool is_linear = kind == SPLINE_LINEAR;
    form.spans = spans_of(kind, outline + is_linear, is_linear ? 6 : 8, &form.span_count);
    return shape_prism(arena, &form);
}

static Shape *lathe(SplineKind kind)
{
    uint32_t count;
    CurveSpan *spans = spans_of(kind, profile, 7, &count);
    return shape_lathe(arena, spline_degree(kind), spans, count);
}

static Shape *sor(void)
{
    static V2 points[7];
    for (int i = 0; i < 7; i++)
        points[i] = (V2){profile[i][0], profile[i][1] + (i ? 0 : -.25)};
    return shape_sor(arena, points, 7, false);
}

static Shape *sweep(SplineKind kind)
{
    uint32_t count = (uint32_t)spline_span_count(kind, 6);
    SweepSpan *spans = arena_alloc(arena, count * sizeof *spans);
    for (uint32_t i = 0; i < count; i++) {
        for (int axis = 0; axis < 3; axis++)
            spline_span(kind, &balls[0][axis], 4, (int)i, spans[i].c[axis]);
        spline_span(kind, &balls[0][3], 4, (int)i, spans[i].r);
    }
    return shape_sphere_sweep(arena, spline_degree(kind), spans, count);
}

static Shape *shape_number(int i)
{
    switch (i) {
    case 0:
        return prism(SPLINE_CUBIC, false);
    case 1:
        return prism(SPLINE_LINEAR, false);
    case 2:
        return prism(SPLINE_CUBIC, true);
    case 3:
        return lathe(SPLINE_CUBIC);
    case 4:
        return lathe(SPLINE_LINEAR);
    case 5:
        return sor();
    case 6:
        return shape_ovus(arena, .75, .5);
    case 7:
        return sweep(SPLINE_LINEAR);
    default:
        return sweep(SPLINE_CUBIC);
    }
}

/* A random multiple of 2^-bits below 1 in size. */
static double coarse(Rng *rng, int bits)
{
    return ldexp(floor(ldexp(2 * rng_double(rng) - 1, bits)), -bits);
}

static int list_of(const Shape *shape, const Ray *ray, Crossing *out)
{
    CrossList list;
    shape_crossings(shape, ray, scratch, &list);
    assert_true(list.count < 64);
    for (int i = 0; i < list.count; i++)
        out[i] = list.items[i];
    return list.count;
}

/* Scaling by a power of two changes no digit. */
static void test_scale(void **state)
{
    (void)state;
    for (int i = 0; i < SHAPES; i++)
        for (int power = -20; power <= 20; power += 20) {
            double factor = ldexp(1, power);
            Shape *shape = shape_number(i), *scaled = shape_copy(arena, shape);
            Xform by = xform_scale(v3(factor, factor, factor));
            shape_transform(scaled, &by);
            shape_finish(arena, shape);
            shape_finish(arena, scaled);
            Rng rng = rng_at(1, 2, (uint64_t)i);
            for (int k = 0; k < LINES; k++) {
                V3 at = v3(coarse(&rng, 40), coarse(&rng, 40), coarse(&rng, 40));
                V3 d = random_dir(&rng), o = v3_mad(at, -4, d);
                Ray ray = {o, d, -INFINITY, INFINITY};
                Ray large = {v3_scale(o, factor), d, -INFINITY, INFINITY};
                Crossing a[64], b[64];
                int count = list_of(shape, &ray, a);
                assert_int_equal(list_of(scaled, &large, b), count);
                for (int c = 0; c < count; c++) {
                    assert_true(b[c].t == a[c].t * factor);
                    assert_true(b[c].t_error == a[c].t_error * factor);
                    ShapePoint p, q;
                    shape_point(&a[c], &ray, &p);
                    shape_point(&b[c], &large, &q);
                    assert_true(v3_dist(v3_scale(p.p, factor), q.p) == 0);
                    assert_true(v3_dist(p.ng, q.ng) == 0);
                }
            }
        }
}

/* Compare what is found along a line with what is found along the same line given by a point that
 * is `back` directions before; the numbers of both are exact.  *worst_share: the most that was off
 * of what was stated. */
static void compare_lines(const Shape *shape, V3 at, V3 d, double back, double *worst_share)
{
    Ray near = {at, d, -INFINITY, INFINITY};
    Ray far = {v3_mad(at, -back, d), d, -INFINITY, INFINITY};
    Crossing a[64], b[64];
    int count = list_of(shape, &near, a);
    if (list_of(shape, &far, b) != count) {
        /* A touching may be seen from one place only. */
        bool touches = count == 0;
        for (int c = 0; c + 1 < count; c++)
            touches |= a[c + 1].t - a[c].t < 1e-6;
        assert_true(touches);
        return;
    }
    for (int c = 0; c < count; c++) {
        double off = fabs(b[c].t - back - a[c].t), error = a[c].t_error + b[c].t_error;
        if (!(off <= error))
            fail_msg("%g off, errors %g", off, error);
        *worst_share = fmax(*worst_share, off / error);
        assert_true(b[c].t_error < 1e-6 || a[c].t_error > 1e-13);
    }
}

/* The errors stated are no less than what is off, and not much more. */
static void test_far(void **state)
{
    (void)state;
    static const double backs[4] = {1, -3, 37, 0x1p20};
    for (int i = 0; i < SHAPES; i++) {
        Shape *shape = shape_number(i);
        shape_finish(arena, shape);
        double share = 0;
        for (int n = 0; n < 4; n++) {
            Rng rng = rng_at(3, 4, (uint64_t)i);
            for (int k = 0; k < LINES; k++) {
                V3 at = v3(coarse(&rng, 12), coarse(&rng, 12), coarse(&rng, 12));
                V3 d = v3(coarse(&rng, 8), coarse(&rng, 8), coarse(&rng, 8));
                if (v3_len2(d) > 0.1)
                    compare_lines(shape, at, d, backs[n], &share);
            }
        }
        if (!(share > 0.002))
            fail_msg("shape %d: errors are stated %g times as large as need be", i, 1 / share);
    }
}

/* Lines that graze: lifted off a point of the surface, along it, by less and less.  They enter and
 * leave in turn, and what is found lies on the surface. */
static void test_grazing(void **state)
{
    (void)state;
    for (int i = 0; i < SHAPES; i++) {
        Shape *shape = shape_number(i);
        shape_finish(arena, shape);
        Rng rng = rng_at(5, 6, (uint64_t)i);
        for (int k = 0; k < LINES; k++) {
            V3 d = random_dir(&rng);
            Ray ray = {v3(-3 * d.x + .3 * d.y, -3 * d.y, -3 * d.z), d, 0, INFINITY};
            Crossing c, items[64];
            if (!shape_closest(shape, &ray, scratch, &c))
                continue;
            ShapePoint point;
            shape_point(&c, &ray, &point);
            V3 side = v3_unit(v3_cross(point.ng, random_dir(&rng)));
            double lift = ldexp(rng_double(&rng) - 0.5, -(int)(50 * rng_double(&rng)));
            Ray low = {v3_mad(v3_mad(point.p, lift, point.ng), -2, side), side, -INFINITY,
                       INFINITY};
            int count = list_of(shape, &low, items);
            assert_int_equal(count % 2, 0);
            for (int n = 0; n < count; n++) {
                assert_int_equal(items[n].change, n % 2 ? -1 : 1);
                shape_point(&items[n], &low, &point);
                double off = v3_dist(point.p, ray_at(&low, items[n].t));
                if (!(off <= 1e-12 + 2 * items[n].t_error))
                    fail_msg("shape %d: %g off its ray, error %g", i, off, items[n].t_error);
            }
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_scale), cmocka_unit_test(test_far),
                                       cmocka_unit_test(test_grazing)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
