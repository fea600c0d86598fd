/* Lathes and surfaces of revolution: crossings against dense polygons, lines at the height of
 * knots, nearly level and nearly upright lines, probes of POV-Ray 3.7. SPDX-License-Identifier:
 * Apache-2.0 */
#include "math/bernstein.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include "solid_kit.h"

enum { POINTS_MAX = 512, STEPS = 400 };

/* A profile as a dense polygon. */
typedef struct Profile {
    int count;
    double r[POINTS_MAX * STEPS], y[POINTS_MAX * STEPS];
    bool is_gap[POINTS_MAX * STEPS]; /* nothing between this point and the one before */
} Profile;

static Profile profile;

static int is_in_profile(const void *form, V3 p)
{
    const Profile *f = form;
    double rho = sqrt(p.x * p.x + p.z * p.z), nearest = INFINITY;
    int inside = 0;
    for (int i = 1; i < f->count; i++) {
        if (f->is_gap[i])
            continue;
        double ar = fabs(f->r[i - 1]), br = fabs(f->r[i]), ay = f->y[i - 1], by = f->y[i];
        if ((ay <= p.y) != (by <= p.y) && ar + (p.y - ay) / (by - ay) * (br - ar) > rho)
            inside ^= 1;
        nearest = fmin(nearest, hypot(ar - rho, ay - p.y));
    }
    return nearest < 0.03 ? -1 : inside;
}

static void add_point(double r, double y, bool is_gap)
{
    profile.r[profile.count] = r;
    profile.y[profile.count] = y;
    profile.is_gap[profile.count++] = is_gap;
}

static Shape *lathe_of(SplineKind kind, double (*points)[2], int count)
{
    static CurveSpan spans[POINTS_MAX];
    int n = spline_span_count(kind, count), degree = spline_degree(kind);
    profile.count = 0;
    for (int i = 0; i < n; i++) {
        spline_span(kind, &points[0][0], 2, i, spans[i].a);
        spline_span(kind, &points[0][1], 2, i, spans[i].b);
        double ignored;
        for (int k = 0; k <= STEPS; k++)
            add_point(bernstein_at(spans[i].a, degree, (double)k / STEPS, &ignored),
                      bernstein_at(spans[i].b, degree, (double)k / STEPS, &ignored), k == 0);
    }
    CurveSpan *kept = arena_copy(arena, spans, (size_t)n * sizeof *spans);
    return shape_lathe(arena, degree, kept, (uint32_t)n);
}

static Shape *sor_of(V2 *points, int count)
{
    profile.count = 0;
    for (int i = 1; i + 2 < count; i++) {
        V2 *p = &points[i];
        double h = p[1].v - p[0].v;
        double d0 = 2 * p[0].u * (p[1].u - p[-1].u) / (p[1].v - p[-1].v);
        double d1 = 2 * p[1].u * (p[2].u - p[0].u) / (p[2].v - p[0].v);
        for (int k = 0; k <= STEPS; k++) {
            double t = (double)k / STEPS, u = 1 - t;
            double square = u * u * (1 + 2 * t) * p[0].u * p[0].u + t * u * u * h * d0 +
                            t * t * (3 - 2 * t) * p[1].u * p[1].u - t * t * u * h * d1;
            add_point(sqrt(fmax(square, 0)), p[0].v + t * h, k == 0);
        }
    }
    return shape_sor(arena, points, count, false);
}

static void check_revolved(Shape *shape, long least)
{
    assert_true(check_solid(shape, 3000, is_in_profile, &profile) > least);
    shape_finish(arena, shape);
    check_solid(shape, 1000, is_in_profile, &profile);
}

static double vase[6][2] = {{1, -1}, {1, 0}, {2, 1}, {1, 2}, {1.5, 3}, {1, 4}};
static double ring[9][2] = {{1, -.3}, {.8, -.1}, {1, 0}, {1.4, .1}, {1.2, .3},
                            {.8, .3}, {.8, -.1}, {1, 0}, {1.2, 0}};
static double bezier[8][2] = {{1, 0}, {2, 1}, {.5, 2}, {1, 3}, {1, 3}, {0, 5}, {3, 0}, {0, 1}};
static double kinds[7][2] = {{0, 0}, {1, 0}, {1.2, 1}, {1.2, 2}, {.6, 1.5}, {.6, .5}, {0, .5}};

static void test_lathe(void **state)
{
    (void)state;
    check_revolved(lathe_of(SPLINE_CUBIC, vase, 6), 2000);
    check_revolved(lathe_of(SPLINE_QUADRATIC, vase, 6), 2000);
    check_revolved(lathe_of(SPLINE_LINEAR, vase, 6), 2000);
    check_revolved(lathe_of(SPLINE_CUBIC, ring, 8), 1000);
    check_revolved(lathe_of(SPLINE_BEZIER, bezier, 8), 2000);
    check_revolved(lathe_of(SPLINE_LINEAR, kinds, 7), 2000);
    check_revolved(lathe_of(SPLINE_QUADRATIC, kinds, 7), 1000);
}

static void test_sor(void **state)
{
    (void)state;
    V2 first[6] = {{1, -1}, {1, 0}, {2, 1}, {1, 2}, {1.5, 3}, {1, 4}};
    check_revolved(sor_of(first, 6), 2000);
    V2 next[6] = {{0, -1}, {1, 0}, {1.5, 1}, {.5, 2}, {1, 3}, {0, 4}};
    check_revolved(sor_of(next, 6), 2000);
    /* The squared radius falls below 0 between the last two: a gap. */
    V2 gap[6] = {{0, -1}, {0, 0}, {1.5, 1}, {.1, 2}, {.1, 3}, {9, 3.5}};
    check_revolved(sor_of(gap, 6), 1000);
}

/* Many knots, met exactly by lines of all kinds. */
static void test_knots(void **state)
{
    (void)state;
    static double comb[302][2];
    for (int i = 0; i < 300; i++) {
        comb[i][0] = i % 2 ? 2 + 0.25 * (i % 5) : 1;
        comb[i][1] = 0.0625 * (i / 2);
    }
    comb[300][0] = 0, comb[300][1] = 10;
    Shape *shape = lathe_of(SPLINE_LINEAR, comb, 301);
    shape_finish(arena, shape);
    for (int i = 0; i < 300; i++) {
        for (int k = 0; k < 40; k++) {
            double a = k * 0.15625, slope = k % 4 ? ldexp(k % 3 - 1, -7 * (k % 4)) : 0;
            V3 at = v3(comb[i][0] * cos(a), comb[i][1], comb[i][0] * sin(a));
            V3 d = v3_unit(v3(1, slope, 0.125 * (k % 5)));
            check_line(shape, v3_mad(at, -16, d), d, 20, NULL, NULL);
            check_line(shape, v3(comb[i][0], 30, 0), v3(0, -1, 0), 20, NULL, NULL);
            V3 to = v3_unit(v3_sub(v3(comb[k][0], comb[k][1], 0), v3(-4, comb[i][1], 0)));
            check_line(shape, v3(-4, comb[i][1], 0), to, 20, NULL, NULL);
        }
    }
}

static void check_side(const Shape *shape, double y, double r, double nr, double ny)
{
    Ray ray = {v3(9, y, 0), v3(-1, 0, 0), 0, INFINITY};
    Crossing c;
    ShapePoint point;
    assert_true(shape_closest(shape, &ray, scratch, &c));
    shape_point(&c, &ray, &point);
    if (!(v3_dist(point.p, v3(r, y, 0)) < 2e-6 && v3_dist(point.ng, v3(nr, ny, 0)) < 4e-6))
        fail_msg("r %g normal %g,%g", point.p.x, point.ng.x, point.ng.y);
}

static void test_probes(void **state)
{
    (void)state;
    Shape *quadratic = lathe_of(SPLINE_QUADRATIC, vase, 5);
    check_side(quadratic, .25, 1.15625, .8, -.6);
    check_side(quadratic, 1.5, 1.75, .707107, .707107);
    check_side(quadratic, 2.5, 1.0625, .894427, -.447214);
    Shape *cubic = lathe_of(SPLINE_CUBIC, vase, 6);
    check_side(cubic, .25, 1.226562, .634317, -.773073);
    check_side(cubic, 1.5, 1.531250, .571065, .820903);
    check_side(cubic, 2.5, 1.218750, .776114, -.630593);
    Shape *curve = lathe_of(SPLINE_BEZIER, bezier, 4);
    check_side(curve, .25, 1.200521, .851963, -.523602);
    check_side(curve, 1.5, 1.1875, .936329, .351123);
    V2 points[5] = {{1, -1}, {1, 0}, {2, 1}, {1, 2}, {1.5, 3}};
    Shape *sor = sor_of(points, 5);
    check_side(sor, .25, 1.268611, .580114, -.814535);
    check_side(sor, .5, 1.620185, .606313, -.795227);
    check_side(sor, 1.5, 1.600781, .590551, .807);
    double seen[6][2] = {{0, 0}, {1, 0}, {2, 1}, {1.5, 2}, {0, 3}, {0, 4}};
    Bound box = shape_bound(lathe_of(SPLINE_CUBIC, seen, 6));
    assert_true(fabs(box.hi.x - 2.016151) < 1e-6 && fabs(box.hi.y - 3) < 1e-12);
    V2 wide[6] = {{0, -1}, {1, 0}, {1.5, 1}, {.5, 2}, {1, 3}, {0, 4}};
    box = shape_bound(sor_of(wide, 6));
    assert_true(fabs(box.lo.z + 1.513098) < 1e-6 && fabs(box.lo.y) < 1e-12);
}

static void test_uv(void **state)
{
    (void)state;
    double line[3][2] = {{1, -1}, {.5, 0}, {1, 1}};
    V3 p = v3(.55, .55, -sqrt(.775 * .775 - .55 * .55));
    Ray ray = {v3(.55, .55, -5), v3(0, 0, 1), 0, INFINITY};
    Shape *lathe = lathe_of(SPLINE_LINEAR, line, 3);
    Crossing c;
    assert_true(shape_closest(lathe, &ray, scratch, &c));
    V2 uv = shape_uv(c.leaf, c.part, c.u, c.v, p);
    assert_true(fabs(uv.u - .8756) < 2e-3 && fabs(uv.v - .775) < 1e-4);
    V2 points[5] = {{1, -2}, {1, -1}, {.5, 0}, {1, 1}, {1, 2}};
    Shape *sor = sor_of(points, 5);
    assert_true(shape_closest(sor, &ray, scratch, &c));
    uv = shape_uv(c.leaf, c.part, c.u, c.v, ray_at(&ray, c.t));
    assert_true(fabs(uv.u - .8740) < 2e-3 && fabs(uv.v - .775) < 1e-4);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lathe),  cmocka_unit_test(test_sor), cmocka_unit_test(test_knots),
        cmocka_unit_test(test_probes), cmocka_unit_test(test_uv),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
