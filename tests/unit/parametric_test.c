/* Parametrics: crossings against spheres, tori and planes, at seams, poles, folds and kinks.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape_kit.h"

#include <stdlib.h>
#include <string.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>

enum { RAYS = 20000 };

static FuncBuilder code;

static int op(FuncOp what, int a, int b)
{
    return func_step(&code, what, (int[]){a, b, a, a});
}

static int one(FuncOp what, int a)
{
    return op(what, a, a);
}

static int number(double x)
{
    return func_const(&code, x);
}

/* A function of u and v, as long as it is being made. */
typedef int (*Formula)(int u, int v, const double *p);

static const Func *make(Formula formula, const double *p)
{
    func_begin(&code, 2);
    int result = formula(func_param(&code, 0), func_param(&code, 1), p);
    return func_end(arena, &code, result);
}

static Shape *sheet(const Formula formula[3], const double *p, V2 lo, V2 hi, double half)
{
    FuncTriple triple;
    const Func *const parts[3] = {make(formula[0], p), make(formula[1], p), make(formula[2], p)};
    assert_true(func_join(arena, parts, &triple));
    Shape *box = shape_box(arena, v3(-half, -half, -half), v3(half, half, half));
    Shape *shape = shape_parametric(arena, &triple, lo, hi, box);
    assert_non_null(shape);
    shape_finish(arena, shape);
    return shape;
}

/* --- tori: u around y, v around the tube; p: major and minor radius ------------------------- */

static int ring(int v, const double *p)
{
    return op(FUNC_ADD, number(p[0]), op(FUNC_MUL, number(p[1]), one(FUNC_COS, v)));
}

static int torus_x(int u, int v, const double *p)
{
    return op(FUNC_MUL, one(FUNC_COS, u), ring(v, p));
}

static int torus_y(int u, int v, const double *p)
{
    (void)u;
    return op(FUNC_MUL, number(p[1]), one(FUNC_SIN, v));
}

static int torus_z(int u, int v, const double *p)
{
    return op(FUNC_MUL, one(FUNC_SIN, u), ring(v, p));
}

static Shape *torus_sheet(double major, double minor)
{
    const Formula formulas[3] = {torus_x, torus_y, torus_z};
    return sheet(formulas, (double[]){major, minor}, (V2){0, 0}, (V2){2 * PMS_PI, 2 * PMS_PI},
                 2 * (major + minor));
}

/* Count the crossings of a list that are clear of each other. */
static bool is_clear(const CrossList *list)
{
    for (int k = 0; k + 1 < list->count; k++)
        if (list->items[k + 1].t - list->items[k].t < 1e-6)
            return false;
    return true;
}

static void check_crossing(const Crossing *a, const Crossing *b, const Ray *ray, const Shape *shape)
{
    ShapePoint p, q;
    assert_true(fabs(a->t - b->t) <= a->t_error + b->t_error);
    shape_point(a, ray, &p);
    shape_point(b, ray, &q);
    assert_true(fabs(v3_dot(p.ng, q.ng)) > 1 - 1e-9);
    assert_true(v3_dist(p.p, q.p) <= 1e-9 * (1 + fabs(a->t)));
    V2 uv = shape_uv(shape, 0, a->u, a->v, p.p);
    assert_true(uv.u >= 0 && uv.u <= 2 * PMS_PI);
    assert_true(v3_dot(p.p, v3(-sin(uv.u), 0, cos(uv.u))) < 1e-9);
}

static void compare(Shape *shape, Shape *solid, const double *far, int far_count, double aim)
{
    Rng rng = rng_at(21, 0, 0);
    int hits = 0;
    for (int i = 0; i < RAYS; i++) {
        V3 o = v3_scale(random_dir(&rng), far[i % far_count]);
        V3 to = v3_scale(random_dir(&rng), aim * rng_double(&rng));
        Ray ray = {o, v3_unit(v3_sub(to, o)), 0, INFINITY};
        CrossList list;
        Crossing seen[8], nearest;
        shape_crossings(shape, &ray, scratch, &list);
        int count = list.count < 8 ? list.count : 8;
        bool is_sheet_clear = is_clear(&list);
        memcpy(seen, list.items, (size_t)count * sizeof *seen);
        shape_crossings(solid, &ray, scratch, &list);
        if (!is_clear(&list) || !is_sheet_clear)
            continue; /* nearly touching: told otherwise below */
        assert_int_equal(count, list.count);
        for (int k = 0; k < count; k++)
            check_crossing(&seen[k], &list.items[k], &ray, shape);
        int ahead = 0;
        while (ahead < count && seen[ahead].t < 0)
            ahead++;
        bool is_met = shape_closest(shape, &ray, scratch, &nearest);
        assert_int_equal(is_met, ahead < count);
        assert_true(!is_met ||
                    fabs(nearest.t - seen[ahead].t) <= nearest.t_error + seen[ahead].t_error);
        hits += count;
    }
    assert_true(hits > RAYS / 2);
}

static void a_torus_is_a_torus(void **state)
{
    (void)state;
    static const double far[] = {0.1, 1, 3, 1e3};
    Shape *shape = torus_sheet(1, 0.4), *solid = shape_torus(arena, 1, 0.4);
    compare(shape, solid, far, 4, 1.5);
}

/* Placed anywhere, of any size. */
static void placed_it_is_the_same(void **state)
{
    (void)state;
    static const double far[] = {2e-4, 1e-3, 0.5};
    Shape *shape = torus_sheet(1, 0.4), *solid = shape_torus(arena, 1, 0.4);
    Xform x = xform_scale(v3(1e-4, 2e-4, 1e-4)), turn = xform_rotate(v3(0.3, 1, 2));
    x = xform_then(&x, &turn);
    Shape *shapes[] = {shape, solid};
    for (int i = 0; i < 2; i++) {
        shape_transform(shapes[i], &x);
        shape_finish(arena, shapes[i]);
    }
    Rng rng = rng_at(22, 0, 0);
    int hits = 0;
    for (int i = 0; i < RAYS / 4; i++) {
        V3 o = v3_scale(random_dir(&rng), far[i % 3]);
        V3 to = v3_scale(random_dir(&rng), 2e-4 * rng_double(&rng));
        Ray ray = {o, v3_unit(v3_sub(to, o)), 0, INFINITY};
        Crossing a, b;
        bool is_hit = shape_closest(shape, &ray, scratch, &a);
        if (!is_hit || !shape_closest(solid, &ray, scratch, &b))
            continue;
        hits += fabs(a.t - b.t) <= a.t_error + b.t_error;
    }
    assert_true(hits > RAYS / 8);
}

/* Straight at seams, where patches and the ends of the domain meet, nothing leaks, and what is met
 * in several patches is met once. */
static void seams_do_not_leak(void **state)
{
    (void)state;
    Shape *shape = torus_sheet(1, 0.5);
    for (int i = 0; i < 4096; i++) {
        double u = 2 * PMS_PI * (i % 64) / 64, v = 2 * PMS_PI * (i / 64) / 64;
        V3 n = v3(cos(u) * cos(v), sin(v), sin(u) * cos(v)), middle = v3(cos(u), 0, sin(u));
        V3 p = v3_mad(middle, 0.5, n);
        Ray ray = {v3_mad(p, 0.25, n), v3_neg(n), 0, 0.5};
        CrossList list;
        Crossing hit;
        assert_true(shape_closest(shape, &ray, scratch, &hit));
        assert_true(fabs(hit.t - 0.25) <= 2 * hit.t_error && hit.t_error < 1e-12);
        ray.tmax = INFINITY;
        shape_crossings(shape, &ray, scratch, &list);
        assert_int_equal(list.count % 2, 0);
    }
}

/* --- a ball, pointed at its poles ----------------------------------------------------------- */

static int ball_x(int u, int v, const double *p)
{
    (void)p;
    return op(FUNC_MUL, one(FUNC_COS, u), one(FUNC_SIN, v));
}

static int ball_y(int u, int v, const double *p)
{
    (void)u;
    (void)p;
    return one(FUNC_COS, v);
}

static int ball_z(int u, int v, const double *p)
{
    (void)p;
    return op(FUNC_MUL, one(FUNC_SIN, u), one(FUNC_SIN, v));
}

static Shape *ball_sheet(void)
{
    const Formula formulas[3] = {ball_x, ball_y, ball_z};
    return sheet(formulas, NULL, (V2){0, 0}, (V2){2 * PMS_PI, PMS_PI}, 1.5);
}

static void poles_are_met(void **state)
{
    (void)state;
    Shape *shape = ball_sheet();
    Crossing hit;
    ShapePoint point;
    for (int i = -40; i <= 40; i++) {
        double off = i == 0 ? 0 : copysign(exp2(-abs(i)), i) * 0.5;
        Ray ray = {v3(off, 3, 0), v3(0, -1, 0), 0, INFINITY};
        assert_true(shape_closest(shape, &ray, scratch, &hit));
        double t = 3 - sqrt(1 - off * off);
        assert_true(fabs(hit.t - t) <= 2 * hit.t_error && hit.t_error < 1e-6);
        shape_point(&hit, &ray, &point);
        assert_true(fabs(point.ng.y) > sqrt(1 - off * off) - 1e-3);
    }
}

/* Grazing rays pass outside and meet inside, up to rounding. */
static void outlines_are_sharp(void **state)
{
    (void)state;
    Shape *shape = ball_sheet();
    Rng rng = rng_at(23, 0, 0);
    for (int i = 0; i < 2000; i++) {
        V3 d = random_dir(&rng), side = v3_unit(v3_cross(d, random_dir(&rng)));
        double off = exp2(-4 - i % 28);
        Crossing hit;
        Ray out = {v3_mad(v3_scale(side, 1 + off), -3, d), d, 0, INFINITY};
        Ray in = {v3_mad(v3_scale(side, 1 - off), -3, d), d, 0, INFINITY};
        assert_false(shape_closest(shape, &out, scratch, &hit));
        assert_true(shape_closest(shape, &in, scratch, &hit));
        double half = sqrt(off * (2 - off));
        assert_true(fabs(hit.t - (3 - half)) <= 2 * hit.t_error + 1e-12 / half);
    }
}

/* --- functions that bend, jump, or have no value -------------------------------------------- */

static int is_u(int u, int v, const double *p)
{
    (void)v;
    (void)p;
    return u;
}

static int is_v(int u, int v, const double *p)
{
    (void)u;
    (void)p;
    return v;
}

static int roof(int u, int v, const double *p)
{
    (void)v;
    (void)p;
    return one(FUNC_ABS, u);
}

static int stairs(int u, int v, const double *p)
{
    (void)v;
    (void)p;
    return one(FUNC_FLOOR, op(FUNC_MUL, u, number(2)));
}

static int bowl(int u, int v, const double *p)
{
    (void)p;
    int rest = op(FUNC_SUB, number(1), op(FUNC_MUL, u, u));
    return one(FUNC_SQRT, op(FUNC_SUB, rest, op(FUNC_MUL, v, v)));
}

static int flat(int u, int v, const double *p)
{
    (void)u;
    (void)v;
    (void)p;
    return number(0);
}

static Shape *field(Formula height)
{
    const Formula formulas[3] = {is_u, height, is_v};
    return sheet(formulas, NULL, (V2){-1, -1}, (V2){1, 1}, 3);
}

static double height_at(Formula height, double x, double z)
{
    return height == roof     ? fabs(x)
           : height == stairs ? floor(2 * x)
           : height == bowl   ? sqrt(1 - x * x - z * z)
                              : 0;
}

static void from_above(Formula height)
{
    Shape *shape = field(height);
    Rng rng = rng_at(24, 0, 0);
    for (int i = 0; i < 3000; i++) {
        double x = 2.4 * rng_double(&rng) - 1.2, z = 2.4 * rng_double(&rng) - 1.2;
        if (i % 8 == 0)
            x = floor(x * 8) / 8; /* at sides of patches, kinks and jumps */
        if (fabs(fabs(x) - 1) < 1e-6 || fabs(fabs(z) - 1) < 1e-6 ||
            (height == bowl && fabs(x * x + z * z - 1) < 1e-2))
            continue;
        double y = height_at(height, x, z);
        bool is_there = fabs(x) <= 1 && fabs(z) <= 1 && isfinite(y);
        Ray ray = {v3(x, 5, z), v3(0, -1, 0), 0, INFINITY};
        Crossing hit;
        CrossList list;
        bool is_jump = height == stairs && floor(2 * x) == 2 * x;
        bool is_met = shape_closest(shape, &ray, scratch, &hit);
        assert_int_equal(is_met, is_there);
        if (!is_met)
            continue;
        assert_true(is_jump || fabs(hit.t - (5 - y)) <= 2 * hit.t_error + 1e-9);
        shape_crossings(shape, &ray, scratch, &list);
        assert_true(list.count == 1 || is_jump);
    }
}

static void odd_functions_have_surfaces(void **state)
{
    (void)state;
    from_above(flat);
    from_above(roof);
    from_above(stairs);
    from_above(bowl);
}

/* Along a flat sheet a ray takes a bounded time. */
static void in_the_sheet_is_no_trap(void **state)
{
    (void)state;
    Shape *shape = field(flat);
    Ray ray = {v3(-5, 0, 0.25), v3(1, 0, 0), 0, INFINITY};
    CrossList list;
    shape_crossings(shape, &ray, scratch, &list);
    assert_true(list.count < 1000);
}

/* Only what is in the container is there. */
static void containers_cut(void **state)
{
    (void)state;
    const Formula formulas[3] = {torus_x, torus_y, torus_z};
    Shape *shape =
        sheet(formulas, (double[]){1, 0.4}, (V2){0, 0}, (V2){2 * PMS_PI, 2 * PMS_PI}, 0.9);
    Ray ray = {v3(5, 0.1, 0.2), v3(-1, 0, 0), 0, INFINITY};
    Crossing hit;
    assert_true(shape_closest(shape, &ray, scratch, &hit));
    assert_true(5 - hit.t <= 0.9);
    Bound box = shape_bound(shape);
    assert_true(box.hi.x < 0.9001 && box.hi.y < 0.4001);
    const Formula away[3] = {is_u, stairs, is_v};
    Shape *none = sheet(away, NULL, (V2){5, 5}, (V2){6, 6}, 1);
    assert_false(shape_closest(none, &ray, scratch, &hit));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_torus_is_a_torus, set_up, tear_down),
        cmocka_unit_test_setup_teardown(placed_it_is_the_same, set_up, tear_down),
        cmocka_unit_test_setup_teardown(seams_do_not_leak, set_up, tear_down),
        cmocka_unit_test_setup_teardown(poles_are_met, set_up, tear_down),
        cmocka_unit_test_setup_teardown(outlines_are_sharp, set_up, tear_down),
        cmocka_unit_test_setup_teardown(odd_functions_have_surfaces, set_up, tear_down),
        cmocka_unit_test_setup_teardown(in_the_sheet_is_no_trap, set_up, tear_down),
        cmocka_unit_test_setup_teardown(containers_cut, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
