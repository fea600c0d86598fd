/* Sphere sweeps: crossings against thousands of balls, joints, fat spans, probes of POV-Ray 3.7.
 * SPDX-License-Identifier: Apache-2.0 */
#include "math/bernstein.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include "solid_kit.h"

enum { SPANS_MAX = 600, STEPS = 500 };

typedef struct Sweep {
    int degree, count;
    SweepSpan spans[SPANS_MAX];
} Sweep;

static Sweep sweep;

static int is_in_balls(const void *form, V3 p)
{
    const Sweep *s = form;
    double least = INFINITY;
    for (int i = 0; i < s->count; i++)
        for (int k = 0; k <= STEPS; k++) {
            double u = (double)k / STEPS, at[3], slope;
            for (int axis = 0; axis < 3; axis++)
                at[axis] = bernstein_at(s->spans[i].c[axis], s->degree, u, &slope);
            double r = bernstein_at(s->spans[i].r, s->degree, u, &slope);
            if (r > 0)
                least = fmin(least, v3_dist(p, v3(at[0], at[1], at[2])) - r);
        }
    return fabs(least) < 1e-3 ? -1 : least < 0;
}

static Shape *sweep_of(SplineKind kind, const double (*balls)[4], int count)
{
    sweep.degree = spline_degree(kind);
    sweep.count = spline_span_count(kind, count);
    for (int i = 0; i < sweep.count; i++) {
        for (int axis = 0; axis < 3; axis++)
            spline_span(kind, &balls[0][axis], 4, i, sweep.spans[i].c[axis]);
        spline_span(kind, &balls[0][3], 4, i, sweep.spans[i].r);
    }
    SweepSpan *kept = arena_copy(arena, sweep.spans, (size_t)sweep.count * sizeof *kept);
    return shape_sphere_sweep(arena, sweep.degree, kept, (uint32_t)sweep.count);
}

static void check_sweep(Shape *shape, long least)
{
    assert_true(check_solid(shape, 1500, is_in_balls, &sweep) > least);
    shape_finish(arena, shape);
    check_solid(shape, 300, is_in_balls, &sweep);
}

static const double bend[5][4] = {
    {-1, 0, 0, 1}, {0, 0, 0, .5}, {1, 1, 0, .3}, {2, 0, 0, 1}, {2, -1, 1, .2}};
/* Fat: the balls of one span hold much of each other. */
static const double fat[4][4] = {{0, 0, 0, 1}, {.3, 0, 0, 1.1}, {.3, .4, 0, .9}, {0, .3, .5, 2}};
/* Balls that grow faster than they move, and ones of no or negative radius. */
static const double odd[6][4] = {{0, 0, 0, .2}, {.1, 0, 0, 1},  {2, 0, 0, 0},
                                 {3, 1, 0, .5}, {4, 1, 0, -.5}, {5, 0, 0, .6}};
/* A curve that comes back through itself. */
static const double knot[6][4] = {{0, 0, 0, .3},   {3, 0, 0, .2},  {0, 3, 0, .4},
                                  {0, -3, .1, .3}, {-3, 2, 0, .2}, {3, 2, 0, .3}};

static void test_linear(void **state)
{
    (void)state;
    check_sweep(sweep_of(SPLINE_LINEAR, bend, 5), 500);
    check_sweep(sweep_of(SPLINE_LINEAR, fat, 4), 500);
    check_sweep(sweep_of(SPLINE_LINEAR, odd, 6), 200);
    check_sweep(sweep_of(SPLINE_LINEAR, knot, 6), 200);
}

static void test_curved(void **state)
{
    (void)state;
    static const SplineKind kinds[2] = {SPLINE_CUBIC, SPLINE_B};
    for (int i = 0; i < 2; i++) {
        check_sweep(sweep_of(kinds[i], bend, 5), 400);
        check_sweep(sweep_of(kinds[i], fat, 4), 400);
        check_sweep(sweep_of(kinds[i], odd, 6), 100);
        check_sweep(sweep_of(kinds[i], knot, 6), 100);
    }
}

/* A rod of many spans has no walls inside, whichever way a line goes. */
static void test_joints(void **state)
{
    (void)state;
    static double rod[401][4];
    for (int i = 0; i < 401; i++) {
        rod[i][0] = 0.01 * i;
        rod[i][1] = 0.3 * rod[i][0];
        rod[i][3] = 0.25;
    }
    for (int kind = 0; kind < 2; kind++) {
        Shape *shape = sweep_of(kind ? SPLINE_B : SPLINE_LINEAR, (const double(*)[4])rod, 401);
        shape_finish(arena, shape);
        V3 along = v3_unit(v3(1, 0.3, 0));
        for (int i = 0; i < 100; i++) {
            double side = 0.249 * i / 100;
            V3 o = v3(-9 * along.x, -9 * along.y, side);
            assert_int_equal(check_line(shape, o, along, 5, NULL, NULL), 2);
            V3 down = v3(rod[4 * i + 2][0], 9, side);
            assert_int_equal(check_line(shape, down, v3(0, -1, 0), 5, NULL, NULL), 2);
        }
    }
}

/* How far a ball of a span reaches beyond p, at u. */
static double reach_at(int span, double u, V3 p)
{
    double at[3], slope;
    for (int axis = 0; axis < 3; axis++)
        at[axis] = bernstein_at(sweep.spans[span].c[axis], sweep.degree, u, &slope);
    double r = bernstein_at(sweep.spans[span].r, sweep.degree, u, &slope);
    return r > 0 ? r - v3_dist(p, v3(at[0], at[1], at[2])) : -INFINITY;
}

/* The furthest that any ball reaches beyond p: from samples, by golden sections. */
static double most_reach(V3 p)
{
    double most = -INFINITY;
    for (int i = 0; i < sweep.count; i++) {
        int best = 0;
        for (int k = 1; k <= STEPS; k++)
            if (reach_at(i, (double)k / STEPS, p) > reach_at(i, (double)best / STEPS, p))
                best = k;
        double lo = fmax(0, best - 1) / STEPS, hi = fmin(STEPS, best + 1) / STEPS;
        for (int k = 0; k < 60; k++) {
            double a = hi - 0.618034 * (hi - lo), b = lo + 0.618034 * (hi - lo);
            if (reach_at(i, a, p) > reach_at(i, b, p))
                hi = b;
            else
                lo = a;
        }
        most = fmax(most, fmax(reach_at(i, lo, p), reach_at(i, hi, p)));
        most = fmax(most, fmax(reach_at(i, 0, p), reach_at(i, 1, p)));
    }
    return most;
}

/* Points of crossings are on the surface to the error they state, from grazing lines too: rays that
 * leave there must not be caught by the balls. */
static void test_points(void **state)
{
    (void)state;
    static const SplineKind kinds[3] = {SPLINE_CUBIC, SPLINE_B, SPLINE_LINEAR};
    double worst = 0;
    for (int kind = 0; kind < 3; kind++) {
        Shape *shape = sweep_of(kinds[kind], bend, 5);
        shape_finish(arena, shape);
        Rng rng = rng_at(5, 2, (uint64_t)kind);
        for (int i = 0; i < 3000; i++) {
            V3 at = v3(4 * rng_double(&rng) - 1, 2 * rng_double(&rng) - .5, rng_double(&rng) - .5);
            V3 d = random_dir(&rng);
            Ray ray = {v3_mad(at, -9, d), d, -INFINITY, INFINITY};
            CrossList list;
            shape_crossings(shape, &ray, scratch, &list);
            for (int k = 0; k < list.count; k++) {
                ShapePoint point;
                shape_point(&list.items[k], &ray, &point);
                worst = fmax(worst, most_reach(point.p) / point.p_error);
                if (k > 0)
                    continue;
                /* Lines that graze the surface there. */
                V3 side = v3_unit(v3_cross(point.ng, random_dir(&rng)));
                double lift = 0.01 * ldexp(1, -(int)(rng_double(&rng) * 50));
                Ray low = {v3_mad(v3_mad(point.p, -lift, point.ng), -9, side), side, 0, INFINITY};
                Crossing c;
                bool is_met = shape_closest(shape, &low, scratch, &c);
                if (is_met)
                    shape_point(&c, &low, &point);
                if (is_met)
                    worst = fmax(worst, most_reach(point.p) / point.p_error);
                break; /* the list is gone */
            }
        }
    }
    if (worst > 1)
        fail_msg("a ball reaches %g times the stated error beyond a point", worst);
}

static void check_front(const Shape *shape, double x, double y, double z, V3 n)
{
    Ray ray = {v3(x, y, -9), v3(0, 0, 1), 0, INFINITY};
    Crossing c;
    ShapePoint point;
    assert_true(shape_closest(shape, &ray, scratch, &c));
    shape_point(&c, &ray, &point);
    if (!(v3_dist(point.p, v3(x, y, z)) < 2e-6 && v3_dist(point.ng, n) < 2e-6))
        fail_msg("z %g normal <%g,%g,%g>", point.p.z, point.ng.x, point.ng.y, point.ng.z);
}

static void test_probes(void **state)
{
    (void)state;
    check_front(sweep_of(SPLINE_CUBIC, bend, 4), .5, .5, -.336749, v3(.192529, .085211, -.977585));
    check_front(sweep_of(SPLINE_B, bend, 4), .5, .5, -.426147, v3(.081524, .100095, -.991632));
    const double line[3][4] = {{-1, 0, 0, 1}, {1, 0, 0, .5}, {2, 1, 0, .5}};
    check_front(sweep_of(SPLINE_LINEAR, line, 3), .25, 0, -.710047, v3(.25, 0, -.968246));
    const double ends[2][4] = {{0, 0, 0, 1}, {3, 0, 0, .5}};
    Bound box = shape_bound(sweep_of(SPLINE_LINEAR, ends, 2));
    assert_true(fabs(box.hi.x - 3.5) < 1e-9 && fabs(box.lo.y + 1) < 1e-9);
    /* POV-Ray has a hole here. */
    const double wide[2][4] = {{0, 0, 0, 1}, {1, 0, 0, 1}};
    assert_true(shape_is_inside(sweep_of(SPLINE_LINEAR, wide, 2), v3(.5, 0, 0)));
}

/* Numbers whose squares overflow: any answer will do, but soon. */
static void test_huge(void **state)
{
    (void)state;
    double huge[5][4];
    for (int i = 0; i < 5; i++)
        for (int k = 0; k < 4; k++)
            huge[i][k] = bend[i][k] * 1e150;
    Shape *shape = sweep_of(SPLINE_CUBIC, (const double(*)[4])huge, 5);
    Rng rng = rng_at(9, 9, 9);
    for (int i = 0; i < 200; i++) {
        V3 d = random_dir(&rng);
        Ray ray = {v3_scale(d, -9e150), d, -INFINITY, INFINITY};
        CrossList list;
        shape_crossings(shape, &ray, scratch, &list);
        assert_true(list.count < 64);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_linear), cmocka_unit_test(test_curved), cmocka_unit_test(test_joints),
        cmocka_unit_test(test_points), cmocka_unit_test(test_huge),   cmocka_unit_test(test_probes),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
