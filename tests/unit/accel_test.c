/* The ray index against brute force.  SPDX-License-Identifier: Apache-2.0 */
#include "accel/accel.h"

#include "base/rng.h"
#include "math/sample.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static void no_sink(void *ctx, const char *text)
{
    (void)ctx, (void)text;
}

static V3 random_in_cube(Rng *rng)
{
    double x = rng_double(rng), y = rng_double(rng), z = rng_double(rng);
    return v3(2 * x - 1, 2 * y - 1, 2 * z - 1);
}

static V3 random_dir(Rng *rng)
{
    V2 u = {rng_double(rng), 0};
    u.v = rng_double(rng);
    return v3_unit(warp_sphere(u));
}

/* Spheres stand for the items of a box index. */
typedef struct Balls {
    V3 *center;
    double *radius;
    uint32_t count;
    double best;
    int item;
    int tests;
} Balls;

static double ball_hit(const Balls *b, uint32_t i, const Ray *ray)
{
    V3 o = v3_sub(ray->o, b->center[i]);
    double tc = -v3_dot(o, ray->d);
    V3 f = v3_mad(o, tc, ray->d);
    double h2 = b->radius[i] * b->radius[i] - v3_len2(f);
    if (!(h2 >= 0))
        return INFINITY;
    double t = tc - sqrt(h2);
    return t > ray->tmin ? t : tc + sqrt(h2);
}

static bool ball_closest(void *query, uint32_t item, Ray *ray)
{
    Balls *b = query;
    b->tests++;
    double t = ball_hit(b, item, ray);
    if (!(t > ray->tmin && t < ray->tmax)) {
        if (t == ray->tmax && b->item > (int)item)
            b->item = (int)item;
        return false;
    }
    ray->tmax = t;
    b->item = (int)item;
    return true;
}

static bool ball_any(void *query, uint32_t item, Ray *ray)
{
    Balls *b = query;
    double t = ball_hit(b, item, ray);
    return t > ray->tmin && t < ray->tmax;
}

static Balls make_balls(uint32_t count, double scale, V3 shift, Bound *boxes)
{
    Balls b = {calloc(count, sizeof(V3)), calloc(count, sizeof(double)), count, 0, -1, 0};
    for (uint32_t i = 0; i < count; i++) {
        Rng rng = rng_at(7, 1, i);
        b.center[i] = v3_mad(shift, scale, random_in_cube(&rng));
        b.radius[i] = scale * 0.1 * rng_double(&rng) * (i % 5 ? 1 : 1e-3);
        V3 r = v3(b.radius[i], b.radius[i], b.radius[i]);
        boxes[i] = (Bound){v3_sub(b.center[i], r), v3_add(b.center[i], r)};
    }
    return b;
}

/* One ray: index and brute force agree exactly. */
static void compare_one(const BoxIndex *index, Balls *b, Ray ray)
{
    Ray mine = ray, all = ray;
    b->item = -1;
    box_index_closest(index, &mine, ball_closest, b);
    int found = b->item;
    b->item = -1;
    for (uint32_t i = 0; i < b->count; i++)
        ball_closest(b, i, &all);
    assert_int_equal(found, b->item);
    assert_true(mine.tmax == all.tmax);
    mine = ray;
    assert_int_equal(box_index_any(index, &mine, ball_any, b), found >= 0);
}

static void check_balls(uint32_t count, double scale, V3 shift, double away, int rays)
{
    Diag diag;
    diag_init(&diag, no_sink, NULL);
    Bound *boxes = calloc(count, sizeof *boxes);
    Balls b = make_balls(count, scale, shift, boxes);
    BoxIndex *index;
    assert_int_equal(box_index_new(&diag, boxes, count, 2, &index), OK);
    for (int i = 0; i < rays; i++) {
        Rng rng = rng_at(9, 1, (uint64_t)i);
        uint32_t aim = rng_u32(&rng) % count;
        V3 d = random_dir(&rng), side = random_in_cube(&rng);
        /* Aim at the rim of a ball as often as at its middle. */
        V3 at = v3_mad(b.center[aim], b.radius[aim] * (i & 1 ? 1 : 0.1), v3_unit(side));
        Ray ray = {v3_mad(at, -away * scale * (1 + rng_double(&rng)), d), d, 0, INFINITY};
        if (i % 7 == 0)
            ray.tmax = away * scale * 1.4;
        compare_one(index, &b, ray);
        ray.d = v3(i % 3 == 0, i % 3 == 1, i % 3 == 2);
        ray.o = v3_mad(at, -away * scale, ray.d);
        compare_one(index, &b, ray);
    }
    box_index_free(index);
    free(boxes), free(b.center), free(b.radius);
    diag_done(&diag);
}

static void test_boxes(void **state)
{
    (void)state;
    for (uint32_t count = 1; count < 12; count++)
        check_balls(count, 1, v3(0, 0, 0), 2, 300);
    check_balls(500, 1, v3(0, 0, 0), 0.5, 3000);
    check_balls(500, 1, v3(0, 0, 0), 3, 3000);
}

/* Size, place and distance do not matter. */
static void test_boxes_extreme(void **state)
{
    (void)state;
    check_balls(300, 1e-6, v3(0, 0, 0), 2, 1500);
    check_balls(300, 1e6, v3(0, 0, 0), 2, 1500);
    check_balls(300, 1e-150, v3(0, 0, 0), 2, 500);
    check_balls(300, 1e150, v3(0, 0, 0), 2, 500);
    check_balls(300, 1, v3(1e6, -3e5, 2e6), 2, 1500);
    check_balls(300, 1, v3(0, 0, 0), 1e6, 1500);
    check_balls(300, 1, v3(0, 0, 0), 1e7, 1500);
}

/* No items, items without a box, flat boxes. */
static void test_boxes_degenerate(void **state)
{
    (void)state;
    Diag diag;
    diag_init(&diag, no_sink, NULL);
    BoxIndex *index;
    Balls b = {.item = -1};
    Ray ray = {{0, 0, -5}, {0, 0, 1}, 0, INFINITY};
    assert_int_equal(box_index_new(&diag, NULL, 0, 1, &index), OK);
    box_index_closest(index, &ray, ball_closest, &b);
    assert_int_equal(b.tests, 0);
    box_index_free(index);
    V3 centers[9];
    double radii[9];
    Bound boxes[9];
    for (int i = 0; i < 9; i++) {
        centers[i] = v3(0, 0, i);
        radii[i] = 0.25;
        boxes[i] = i == 4 ? (Bound){{-1, -1, 4}, {1, 1, 4}} : BOUND_EMPTY;
    }
    b = (Balls){centers, radii, 9, 0, -1, 0};
    for (int count = 5; count <= 9; count += 4) {
        assert_int_equal(box_index_new(&diag, boxes, (uint32_t)count, 1, &index), OK);
        ray = (Ray){{0, 0, -5}, {0, 0, 1}, 0, INFINITY};
        b.item = -1;
        box_index_closest(index, &ray, ball_closest, &b);
        assert_int_equal(b.item, 4);
        assert_true(ray.tmax == 8.75);
        box_index_free(index);
    }
    diag_done(&diag);
}

/* --- triangles --------------------------------------------------------------------------- */

typedef struct Tris {
    V3 *vertices;
    uint32_t vertex_count, *corners, count;
} Tris;

/* A closed bumpy ball: a grid of latitudes and longitudes with shared vertices. */
static Tris make_ball(uint32_t rows, uint32_t columns, double scale, V3 shift)
{
    Tris t = {.vertex_count = rows * columns + 2};
    t.vertices = calloc(t.vertex_count, sizeof(V3));
    t.corners = calloc(6 * (size_t)(rows + 1) * columns, sizeof(uint32_t));
    uint32_t north = rows * columns, south = north + 1, n = 0;
    for (uint32_t i = 0; i < rows; i++) {
        for (uint32_t k = 0; k < columns; k++) {
            double theta = PMS_PI * (i + 1) / (rows + 1), phi = 2 * PMS_PI * k / columns;
            double r = 1 + 0.1 * sin(5 * phi) * sin(3 * theta);
            V3 p = v3(r * sin(theta) * cos(phi), r * cos(theta), r * sin(theta) * sin(phi));
            t.vertices[i * columns + k] = v3_mad(shift, scale, p);
        }
    }
    t.vertices[north] = v3_mad(shift, scale, v3(0, 1, 0));
    t.vertices[south] = v3_mad(shift, scale, v3(0, -1, 0));
    for (uint32_t i = 0; i <= rows; i++) {
        for (uint32_t k = 0; k < columns; k++) {
            uint32_t next = (k + 1) % columns;
            uint32_t a = i > 0 ? (i - 1) * columns + k : north;
            uint32_t b = i > 0 ? (i - 1) * columns + next : north;
            uint32_t c = i < rows ? i * columns + k : south;
            uint32_t d = i < rows ? i * columns + next : south;
            if (i > 0)
                t.corners[n++] = a, t.corners[n++] = b, t.corners[n++] = d;
            if (i < rows)
                t.corners[n++] = a, t.corners[n++] = d, t.corners[n++] = c;
        }
    }
    t.count = n / 3;
    return t;
}

static TriIndex *index_of(Diag *diag, const Tris *t)
{
    TriIndex *index;
    assert_int_equal(
        tri_index_new(diag, t->vertices, t->vertex_count, t->corners, t->count, 1, &index), OK);
    return index;
}

/* The index finds what testing every triangle finds, and the number of crossings of a closed
 * mesh is even, through edges and corners too. */
static void check_tris(double scale, V3 shift, double away, int rays)
{
    Diag diag;
    diag_init(&diag, no_sink, NULL);
    Tris t = make_ball(13, 20, scale, shift);
    TriIndex *index = index_of(&diag, &t);
    TriHit hits[64];
    for (int i = 0; i < rays; i++) {
        Rng rng = rng_at(11, 1, (uint64_t)i);
        V3 d = random_dir(&rng);
        const uint32_t *c = t.corners + 3 * (rng_u32(&rng) % t.count);
        double u = rng_double(&rng);
        V3 at = v3_mad(v3_scale(t.vertices[c[0]], 1 - u), u, t.vertices[c[1]]);
        at = i % 3 == 0   ? t.vertices[c[0]]
             : i % 3 == 1 ? at
                          : v3_mad(shift, 0.5 * scale, random_dir(&rng));
        Ray ray = {v3_mad(at, -away * scale, d), d, -INFINITY, INFINITY};
        assert_true(v3_is_finite(ray.o));
        int n = tri_index_all(index, &ray, hits, 64);
        assert_in_range(n, 0, 64);
        assert_int_equal(n % 2, 0);
        if (i % 3 != 0 && away < 1e3 && v3_len(shift) == 0)
            assert_true(n >= 2 || i % 3 == 1);
        for (int k = 1; k < n; k++)
            assert_true(hits[k].t >= hits[k - 1].t);
        /* Brute force with the same test: the nearest of all in front. */
        TriHit nearest, best = {.t = INFINITY};
        ray.tmin = 0;
        for (uint32_t k = 0; k < t.count; k++) {
            V3 corner[3];
            TriHit hit;
            for (int j = 0; j < 3; j++)
                corner[j] = t.vertices[t.corners[3 * k + (uint32_t)j]];
            if (tri_test(corner, &ray, &hit) && hit.t < best.t) {
                best = hit;
                best.triangle = k;
            }
        }
        bool is_hit = tri_index_closest(index, &ray, &nearest);
        if (i % 3 == 2) { /* away from edges both must agree */
            assert_int_equal(is_hit, best.t < INFINITY);
            assert_true(!is_hit || fabs(nearest.t - best.t) <= nearest.t_error + best.t_error);
        }
    }
    tri_index_free(index);
    free(t.vertices), free(t.corners);
    diag_done(&diag);
}

static void test_triangles(void **state)
{
    (void)state;
    check_tris(1, v3(0, 0, 0), 3, 4000);
    check_tris(1e-6, v3(0, 0, 0), 3, 1000);
    check_tris(1e6, v3(0, 0, 0), 3, 1000);
    check_tris(1, v3(1e5, 2e5, -3e5), 3, 1000);
    check_tris(1, v3(0, 0, 0), 1e6, 1000);
}

/* Rays from inside a closed mesh never escape through its edges and corners. */
static void test_watertight(void **state)
{
    (void)state;
    Diag diag;
    diag_init(&diag, no_sink, NULL);
    Tris t = make_ball(20, 30, 1, v3(0, 0, 0));
    TriIndex *index = index_of(&diag, &t);
    TriHit hit;
    for (uint32_t i = 0; i < 3 * t.count; i++) {
        Rng rng = rng_at(13, 1, i);
        V3 o = v3_scale(random_dir(&rng), 0.6 * rng_double(&rng));
        V3 a = t.vertices[t.corners[i]], b = t.vertices[t.corners[i % 3 == 2 ? i - 2 : i + 1]];
        Ray ray = {o, v3_unit(v3_sub(a, o)), 0, INFINITY};
        assert_true(tri_index_closest(index, &ray, &hit));
        for (int k = 0; k < 4; k++) {
            V3 p = v3_mad(a, rng_double(&rng), v3_sub(b, a));
            ray.d = v3_unit(v3_sub(p, o));
            assert_true(tri_index_closest(index, &ray, &hit));
            assert_true(fabs(hit.t - v3_dist(p, o)) < 1e-9);
        }
    }
    tri_index_free(index);
    free(t.vertices), free(t.corners);
    diag_done(&diag);
}

/* Ties: of equal triangles the first wins; degenerate ones are never hit. */
static void test_ties(void **state)
{
    (void)state;
    Diag diag;
    diag_init(&diag, no_sink, NULL);
    V3 vertices[4] = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}, {0.5, -1, 0}};
    uint32_t corners[40 * 3];
    for (uint32_t i = 0; i < 40; i++) {
        corners[3 * i] = 0, corners[3 * i + 1] = 1;
        corners[3 * i + 2] = i < 5 ? 3 : 2; /* the first five have no area */
    }
    Tris t = {vertices, 4, corners, 40};
    TriIndex *index = index_of(&diag, &t);
    TriHit hit;
    Ray ray = {{0.1, 0, -2}, {0, 0, 1}, 0, INFINITY};
    assert_true(tri_index_closest(index, &ray, &hit));
    assert_int_equal(hit.triangle, 5);
    assert_true(hit.t == 2);
    TriHit all[4];
    assert_int_equal(tri_index_all(index, &ray, all, 4), 35);
    ray.d = v3(0, 0, 4); /* any length: t counts in it */
    assert_true(tri_index_closest(index, &ray, &hit));
    assert_true(hit.t == 0.5);
    ray.tmax = 0.5;
    assert_false(tri_index_closest(index, &ray, &hit));
    tri_index_free(index);
    corners[7] = 4;
    assert_int_equal(tri_index_new(&diag, vertices, 4, corners, 40, 1, &index), ERR_SCENE);
    corners[7] = 1;
    vertices[1].y = NAN;
    assert_int_equal(tri_index_new(&diag, vertices, 4, corners, 40, 1, &index), ERR_SCENE);
    diag_done(&diag);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_boxes),
        cmocka_unit_test(test_boxes_extreme),
        cmocka_unit_test(test_boxes_degenerate),
        cmocka_unit_test(test_triangles),
        cmocka_unit_test(test_watertight),
        cmocka_unit_test(test_ties),
    };
    return cmocka_run_group_tests_name("accel", tests, NULL, NULL);
}
