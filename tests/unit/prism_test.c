/* Prisms: crossings against dense polygons, knots met exactly, the tips of cones, probes of
 * POV-Ray 3.7.  SPDX-License-Identifier: Apache-2.0 */
#include "math/bernstein.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include "solid_kit.h"

enum { SPANS_MAX = 800, STEPS = 400 };

/* A form and room for its spans. */
typedef struct TestPrism {
    PrismForm form;
    CurveSpan spans[SPANS_MAX];
} TestPrism;

static void add_loop(TestPrism *t, SplineKind kind, double (*points)[2], int count)
{
    int spans = spline_span_count(kind, count);
    for (int i = 0; i < spans; i++) {
        CurveSpan *span = &t->spans[t->form.span_count++];
        spline_span(kind, &points[0][0], 2, i, span->a);
        spline_span(kind, &points[0][1], 2, i, span->b);
    }
    t->form.degree = spline_degree(kind);
    t->form.spans = t->spans;
}

/* Even-odd test against a polygon of many sides. */
static int is_in_polygon(const void *form, V3 p)
{
    const PrismForm *prism = form;
    double y = prism->is_conic ? p.y : 1, x = p.x / y, z = p.z / y, nearest = INFINITY;
    int inside = 0;
    if (p.y < prism->lo || p.y >= prism->hi)
        return 0;
    for (uint32_t i = 0; i < prism->span_count; i++) {
        const CurveSpan *s = &prism->spans[i];
        double ax = s->a[0], az = s->b[0], ignored;
        for (int k = 1; k <= STEPS; k++) {
            double w = (double)k / STEPS;
            double bx = bernstein_at(s->a, prism->degree, w, &ignored);
            double bz = bernstein_at(s->b, prism->degree, w, &ignored);
            if ((az <= z) != (bz <= z) && ax + (z - az) / (bz - az) * (bx - ax) > x)
                inside ^= 1;
            nearest = fmin(nearest, hypot(ax - x, az - z));
            ax = bx, az = bz;
        }
    }
    return nearest < 0.02 ? -1 : inside;
}

static double cubic_points[7][2] = {{0, 1}, {0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}, {1, 0}};
static double star[6][2] = {{0, 1}, {.6, -.8}, {-1, .2}, {1, .2}, {-.6, -.8}, {0, 1}};
static double bezier[8][2] = {{0, 0}, {1, -1}, {2, 1}, {1, 1}, {1, 1}, {.5, 1}, {-.5, .5}, {0, 0}};
static double quadratic[6][2] = {{1, -1}, {0, 0}, {1, -.2}, {1, 1}, {0, 1.2}, {0, 0}};

static void check_kinds(bool is_conic, double lo, double hi)
{
    static TestPrism t[4];
    static const SplineKind kinds[4] = {SPLINE_CUBIC, SPLINE_LINEAR, SPLINE_BEZIER,
                                        SPLINE_QUADRATIC};
    static double(*const points[4])[2] = {cubic_points, star, bezier, quadratic};
    static const int counts[4] = {7, 6, 8, 6};
    for (int i = 0; i < 4; i++) {
        t[i] = (TestPrism){.form = {.lo = lo, .hi = hi, .is_conic = is_conic}};
        add_loop(&t[i], kinds[i], points[i], counts[i]);
        Shape *shape = shape_prism(arena, &t[i].form);
        assert_true(check_solid(shape, 4000, is_in_polygon, &t[i].form) > 2000);
        shape_finish(arena, shape);
        check_solid(shape, 1000, is_in_polygon, &t[i].form);
    }
}

static void test_straight(void **state)
{
    (void)state;
    check_kinds(false, -0.5, 1);
}

static void test_conic(void **state)
{
    (void)state;
    check_kinds(true, 0.25, 1);
    check_kinds(true, 0, 1);
    check_kinds(true, -0.75, 1);
}

/* Lines through knots and corners, and along walls, enter and leave in turn. */
static void test_knots(void **state)
{
    (void)state;
    TestPrism t = {.form = {.lo = 0, .hi = 1}};
    static double comb[202][2];
    for (int i = 0; i < 200; i++) {
        comb[i][0] = i * 0.0625;
        comb[i][1] = i % 2 ? 1 : 0.5 * (i % 3);
    }
    comb[200][0] = 12, comb[200][1] = -1;
    add_loop(&t, SPLINE_LINEAR, comb, 201);
    double back[2][2] = {{12, -1}, {0, 0}};
    add_loop(&t, SPLINE_LINEAR, back, 2);
    Shape *shape = shape_prism(arena, &t.form);
    shape_finish(arena, shape);
    for (int i = 0; i < 200; i++)
        for (int k = 0; k < 200; k++) {
            V3 o = v3(comb[i][0], 0.25 + (k % 3) * 0.25, comb[i][1]);
            V3 d = v3_sub(v3(comb[k][0], 0.5, comb[k][1]), o);
            if (v3_len2(d) > 0)
                check_line(shape, v3_mad(o, -3, d), v3_unit(d), 20, NULL, NULL);
        }
    /* Straight down onto each knot. */
    for (int i = 0; i < 200; i++)
        check_line(shape, v3(comb[i][0], 5, comb[i][1]), v3(0, -1, 0), 20, NULL, NULL);
}

static void check_trace(const Shape *shape, V3 o, V3 d, V3 p, V3 n)
{
    Ray ray = {o, v3_unit(d), 0, INFINITY};
    Crossing c;
    ShapePoint point;
    assert_true(shape_closest(shape, &ray, scratch, &c));
    shape_point(&c, &ray, &point);
    if (!(v3_dist(point.p, p) < 2e-6 && v3_dist(point.ng, n) < 2e-6))
        fail_msg("<%g,%g,%g> normal <%g,%g,%g>", point.p.x, point.p.y, point.p.z, point.ng.x,
                 point.ng.y, point.ng.z);
}

static void test_probes(void **state)
{
    (void)state;
    static double drop[4][2] = {{0, 0}, {2, 0}, {0, 2}, {0, 0}};
    static double square[5][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}, {-1, -1}};
    TestPrism a = {.form = {.lo = 0, .hi = 1}};
    add_loop(&a, SPLINE_BEZIER, drop, 4);
    /* POV-Ray gives the other normal: it does not know which side is outside. */
    check_trace(shape_prism(arena, &a.form), v3(9, .5, .3), v3(-1, 0, 0), v3(.854182, .5, .3),
                v3(.889436, 0, -.457060));
    TestPrism b = {.form = {.lo = 0, .hi = 1, .is_conic = true}};
    add_loop(&b, SPLINE_LINEAR, square, 5);
    Shape *pyramid = shape_prism(arena, &b.form);
    check_trace(pyramid, v3(9, .5, 0), v3(-1, 0, 0), v3(.5, .5, 0), v3(sqrt(.5), -sqrt(.5), 0));
    check_trace(pyramid, v3(0, 5, 0), v3(0, -1, 0), v3(0, 1, 0), v3(0, 1, 0));
    check_line(pyramid, v3(0, 5, 0), v3(0, -1, 0), 2, NULL, NULL);
    TestPrism c = {.form = {.lo = 0, .hi = 1}};
    add_loop(&c, SPLINE_CUBIC, cubic_points, 7);
    Bound box = shape_bound(shape_prism(arena, &c.form));
    assert_true(fabs(box.lo.x + .125) < 1e-12 && fabs(box.hi.z - 1.125) < 1e-12);
    assert_true(shape_is_inside(pyramid, v3(0.1, 0.5, 0)));
    assert_false(shape_is_inside(pyramid, v3(0, 1, 0))); /* probe: top 0, base 1 */
}

/* A turned prism leaves room in the box around it: lines that meet the box above or below the caps
 * only must not be told of the walls there. */
static void test_boxes_change_nothing(void **state)
{
    (void)state;
    static TestPrism star_prism;
    star_prism = (TestPrism){.form = {.lo = -0.1, .hi = 0.1}};
    add_loop(&star_prism, SPLINE_LINEAR, star, 6);
    Shape *plain = shape_prism(arena, &star_prism.form);
    Xform turn = xform_rotate(v3(0.7, 0.4, 1.1));
    shape_transform(plain, &turn);
    Shape *boxed = shape_copy(arena, plain);
    shape_finish(arena, boxed);
    int met = 0;
    for (uint32_t i = 0; i < 20000; i++) {
        Rng rng = rng_at(77, 1, i);
        V3 o = v3_scale(random_dir(&rng), 2), to = v3_scale(random_dir(&rng), 1.2);
        Ray ray = {o, v3_unit(v3_sub(to, o)), 0, INFINITY};
        CrossList list;
        shape_crossings(plain, &ray, scratch, &list);
        int count = list.count;
        double first = count ? list.items[0].t : 0;
        shape_crossings(boxed, &ray, scratch, &list);
        assert_int_equal(list.count, count);
        assert_true(count == 0 || list.items[0].t == first);
        met += count > 0;
    }
    assert_true(met > 2000 && met < 18000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_straight),
        cmocka_unit_test(test_conic),
        cmocka_unit_test(test_knots),
        cmocka_unit_test(test_probes),
        cmocka_unit_test(test_boxes_change_nothing),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
