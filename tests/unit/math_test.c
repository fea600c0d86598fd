/* The math floor: vectors, transforms, boxes, samples and warps.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/rng.h"
#include "math/bound.h"
#include "math/eps.h"
#include "math/sample.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>
#include <string.h>

#define DEGREES(a) ((a) * PMS_PI / 180)

static void assert_near(V3 a, V3 b, double tolerance)
{
    if (!(v3_dist(a, b) <= tolerance))
        fail_msg("(%g %g %g) is not (%g %g %g)", a.x, a.y, a.z, b.x, b.y, b.z);
}

static void test_unit_vectors_of_any_length(void **state)
{
    (void)state;
    for (int e = -300; e <= 300; e += 50) {
        double s = pow(10, e);
        assert_near(v3_unit(v3(3 * s, 0, 4 * s)), v3(0.6, 0, 0.8), 1e-15);
    }
    assert_near(v3_unit(v3(0, 0, 0)), v3(0, 0, 0), 0);
}

static void test_frames(void **state)
{
    (void)state;
    Rng rng = rng_at(0, 0, 0);
    for (int i = 0; i < 1000; i++) {
        V3 n = warp_sphere((V2){rng_double(&rng), rng_double(&rng)}), s, t;
        v3_frame(n, &s, &t);
        assert_true(fabs(v3_dot(s, t)) < 1e-14 && fabs(v3_dot(s, n)) < 1e-14);
        assert_near(v3_cross(s, t), n, 1e-14);
    }
    V3 s, t;
    v3_frame(v3(0, 0, -1), &s, &t);
    assert_true(v3_is_finite(s) && fabs(v3_len(s) - 1) < 1e-15);
}

/* Senses and composition as the language has them (measured values). */
static void test_rotations(void **state)
{
    (void)state;
    Xform x = xform_rotate(v3(DEGREES(90), 0, 0)), y = xform_rotate(v3(0, DEGREES(90), 0)),
          z = xform_rotate(v3(0, 0, DEGREES(90)));
    assert_near(xform_point(&x, v3(0, 1, 0)), v3(0, 0, 1), 0);
    assert_near(xform_point(&y, v3(1, 0, 0)), v3(0, 0, -1), 0);
    assert_near(xform_point(&z, v3(1, 0, 0)), v3(0, 1, 0), 0);
    Xform all = xform_rotate(v3(DEGREES(10), DEGREES(20), DEGREES(30)));
    assert_near(xform_point(&all, v3(1, 2, 3)), v3(1.067425, 2.289059, 2.760581), 1e-6);
    Xform axis = xform_axis_rotate(v3_unit(v3(1, 1, 0)), DEGREES(30));
    assert_near(xform_point(&axis, v3(1, 2, 3)), v3(2.127647, 0.872353, 2.951630), 1e-6);
    Xform move = xform_translate(v3(1, 2, 3)), grow = xform_scale(v3(2, 3, 4));
    Xform chain = xform_then(&all, &move);
    chain = xform_then(&chain, &grow);
    assert_near(xform_point(&chain, v3(1, 2, 3)), v3(4.134851, 12.867178, 23.042326), 1e-6);
    assert_near(xform_point_back(&chain, xform_point(&chain, v3(1, 2, 3))), v3(1, 2, 3), 1e-14);
    Xform back = xform_inverse(&chain);
    assert_near(xform_point(&back, xform_point(&chain, v3(4, 5, 6))), v3(4, 5, 6), 1e-13);
}

static void test_normals_stay_normal(void **state)
{
    (void)state;
    Xform squash = xform_scale(v3(1, 5, 0.2)), turn = xform_rotate(v3(1, 2, 3));
    Xform x = xform_then(&squash, &turn);
    V3 n = v3_unit(v3(1, 2, 3)), s, t;
    v3_frame(n, &s, &t);
    V3 moved = xform_normal(&x, n);
    assert_true(fabs(v3_dot(moved, xform_dir(&x, s))) < 1e-13);
    assert_true(fabs(v3_dot(moved, xform_dir(&x, t))) < 1e-13);
}

static void test_matrices(void **state)
{
    (void)state;
    double good[3][4] = {{1, 4, 7, 11}, {2, 5, 8, 12}, {3, 6, 10, 13}};
    double singular[3][4] = {{1, 2, 3, 0}, {2, 4, 6, 0}, {0, 0, 1, 0}};
    double rounded[3][4] = {{0.1, 0.2, 0.3, 0}, {0.2, 0.4, 0.6, 0}, {0.7, 1.1, 1.3, 0}};
    double not_finite[3][4] = {{NAN, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
    double tiny[3][4] = {{1e-90, 0, 0, 0}, {0, 1e-90, 0, 0}, {0, 0, 1e-90, 0}};
    Xform x;
    assert_true(xform_from_matrix((const double(*)[4])good, &x));
    assert_near(xform_point_back(&x, xform_point(&x, v3(1, 2, 3))), v3(1, 2, 3), 1e-12);
    assert_false(xform_from_matrix((const double(*)[4])singular, &x));
    assert_false(xform_from_matrix((const double(*)[4])rounded, &x));
    assert_false(xform_from_matrix((const double(*)[4])not_finite, &x));
    assert_true(xform_from_matrix((const double(*)[4])tiny, &x));
    x = XFORM_IDENTITY;
    assert_true(xform_is_identity(&x));
    x.to[1][2] = 1e-300;
    assert_false(xform_is_identity(&x));
}

static void test_bounds(void **state)
{
    (void)state;
    Bound unit = {v3(-1, -1, -1), v3(1, 1, 1)};
    assert_true(bound_is_empty(BOUND_EMPTY) && !bound_is_finite(BOUND_ALL));
    assert_false(bound_is_empty(unit));
    Xform turn = xform_rotate(v3(0, 0, DEGREES(45)));
    Bound turned = bound_transform(unit, &turn);
    assert_true(fabs(turned.hi.x - sqrt(2)) < 1e-15 && turned.hi.z == 1);
    assert_true(bound_is_empty(bound_transform(BOUND_EMPTY, &turn)));
    assert_false(bound_is_finite(bound_transform(BOUND_ALL, &turn)));
    Bound apart = {v3(2, 2, 2), v3(3, 3, 3)};
    assert_true(bound_is_empty(bound_intersect(unit, apart)));
    assert_true(bound_union(unit, apart).hi.x == 3);
}

/* Every prefix of 2^m points has one point in each of its elementary boxes. */
static void test_points_are_a_net(void **state)
{
    (void)state;
    for (uint64_t key = 0; key < 5; key++) {
        for (int m = 0; m <= 8; m++) {
            for (int split = 0; split <= m; split++) {
                char seen[256] = {0};
                for (uint32_t i = 0; i < 1u << m; i++) {
                    V2 p = sample_2d(i, key);
                    int column = (int)(p.u * (1 << split)), row = (int)(p.v * (1 << (m - split)));
                    seen[(column << (m - split)) + row]++;
                }
                for (int i = 0; i < 1 << m; i++)
                    assert_int_equal(seen[i], 1);
            }
        }
    }
}

/* Mean direction and second moments of the warps, against their integrals. */
static void test_warps(void **state)
{
    (void)state;
    enum { N = 1 << 14 };
    V3 sphere = {0, 0, 0}, cosine = {0, 0, 0};
    double z2 = 0, cone = 0, disk = 0;
    for (uint32_t i = 0; i < N; i++) {
        V2 u = sample_2d(i, 7);
        V3 s = warp_sphere(u), c = warp_cosine(u), k = warp_cone(u, 0.5);
        V2 d = warp_disk(u);
        assert_true(fabs(v3_len(s) - 1) < 1e-12 && fabs(v3_len(c) - 1) < 1e-12);
        assert_true(k.z >= 0.5 && c.z >= 0 && d.u * d.u + d.v * d.v <= 1 + 1e-12);
        sphere = v3_add(sphere, s);
        cosine = v3_add(cosine, c);
        z2 += s.z * s.z;
        cone += k.z;
        disk += d.u * d.u + d.v * d.v;
    }
    /* A net of 2^14 points integrates these smooth functions far better than 1e-3. */
    assert_near(v3_scale(sphere, 1.0 / N), v3(0, 0, 0), 1e-3);
    assert_near(v3_scale(cosine, 1.0 / N), v3(0, 0, 2.0 / 3), 1e-3);
    assert_true(fabs(z2 / N - 1.0 / 3) < 1e-3 && fabs(cone / N - 0.75) < 1e-3);
    assert_true(fabs(disk / N - 0.5) < 1e-3);
    assert_near(warp_to_frame(v3(0, 0, 1), v3(0.6, 0, 0.8)), v3(0.6, 0, 0.8), 1e-15);
}

static void test_gamma_bound(void **state)
{
    (void)state;
    /* A sum of 100 rounded terms stays inside its bound. */
    double sum = 0;
    for (int i = 0; i < 100; i++)
        sum += 0.1;
    assert_true(fabs(sum - 10) <= 10 * eps_gamma(101) && sum != 10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_unit_vectors_of_any_length),
        cmocka_unit_test(test_frames),
        cmocka_unit_test(test_rotations),
        cmocka_unit_test(test_normals_stay_normal),
        cmocka_unit_test(test_matrices),
        cmocka_unit_test(test_bounds),
        cmocka_unit_test(test_points_are_a_net),
        cmocka_unit_test(test_warps),
        cmocka_unit_test(test_gamma_bound),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
