/* Eggs: crossings against the definition, probes of POV-Ray 3.7.
 * SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

#include "solid_kit.h"

typedef struct Egg {
    double bottom, top;
} Egg;

/* By the language's definition: heights part the two balls and the arc. */
static int is_in_egg(const void *form, V3 p)
{
    const Egg *egg = form;
    double b = egg->bottom, t = egg->top, rho = hypot(p.x, p.z);
    double arc = b > t ? 2 * b : 2 * t;
    double vy = b > t ? 2 * t - b - t * t / (2 * b) : b - 2 * t + 3 * t * t / (2 * b);
    double h = b > t ? sqrt(b * b - vy * vy) : sqrt(t * t - (vy - b) * (vy - b));
    double lo = b > t ? -vy : -vy * b / (arc - b);
    double hi = b > t ? (b - vy) * t / (arc - t) + b : 2 * b - vy;
    double bottom = hypot(rho, p.y) - b, top = hypot(rho, p.y - b) - t;
    double side = hypot(rho + h, p.y - vy) - arc;
    double over = p.y < lo ? bottom : p.y > hi ? top : side;
    return fabs(over) < 1e-9 ? -1 : over < 0;
}

static void test_lines(void **state)
{
    (void)state;
    static const Egg eggs[] = {{1, .5}, {1, 1.5}, {1, 1}, {1, 1.99}, {1, .01}, {3, 2.5}};
    for (size_t i = 0; i < sizeof eggs / sizeof *eggs; i++) {
        Shape *shape = shape_ovus(arena, eggs[i].bottom, eggs[i].top);
        assert_true(check_solid(shape, 5000, is_in_egg, &eggs[i]) > 2000);
        shape_finish(arena, shape);
        assert_true(shape_is_convex(shape));
        /* No point is further along a direction than shape_farthest. */
        Rng rng = rng_at(3, 1, i);
        for (int k = 0; k < 300; k++) {
            V3 n = random_dir(&rng), d = random_dir(&rng);
            Ray ray = {v3(0, 0.2, 0), d, 0, INFINITY};
            Crossing c;
            assert_true(shape_closest(shape, &ray, scratch, &c));
            assert_true(v3_dot(n, shape_farthest(shape, n)) >=
                        v3_dot(n, ray_at(&ray, c.t)) - 1e-12);
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
    if (!(v3_dist(point.p, v3(r, y, 0)) < 2e-6 && v3_dist(point.ng, v3(nr, ny, 0)) < 2e-6))
        fail_msg("r %g normal %g,%g", point.p.x, point.ng.x, point.ng.y);
}

static void test_probes(void **state)
{
    (void)state;
    Shape *a = shape_ovus(arena, 1, .5), *b = shape_ovus(arena, 1, 1.5);
    check_side(a, -.5, .866025, .866025, -.5);
    check_side(a, .5, .907679, .949918, .3125);
    check_side(a, 1.3, .411187, .701672, .7125);
    check_side(b, -.5, .889505, .780625, -.625);
    check_side(b, .5, 1.417191, .956520, -.291667);
    check_side(b, 1.3, 1.469694, .979796, .2);
    check_side(b, 2.3, .748331, .498888, .866667);
    Bound box = shape_bound(a);
    assert_true(fabs(box.hi.x - 1.007843) < 1e-6 && fabs(box.hi.y - 1.5) < 1e-12);
    box = shape_bound(b);
    assert_true(fabs(box.hi.x - 1.547631) < 1e-6 && fabs(box.lo.y + 1) < 1e-12);
    Ray ray = {v3(.55, .55, -5), v3(0, 0, 1), 0, INFINITY};
    Crossing c;
    assert_true(shape_closest(a, &ray, scratch, &c));
    V2 uv = shape_uv(c.leaf, c.part, c.u, c.v, ray_at(&ray, c.t));
    assert_true(fabs(uv.u - .8560) < 2e-3 && fabs(uv.v - .6034) < 2e-3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_lines), cmocka_unit_test(test_probes)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
