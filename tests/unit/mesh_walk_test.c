/* Walking along a line through a mesh from hit to hit meets each triangle once, as a query for
 * all of them does.  SPDX-License-Identifier: Apache-2.0 */
#include "base/rng.h"
#include "math/sample.h"
#include "shape/mesh.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

enum { SIDES = 24, RINGS = 12, HITS_MAX = 64 };

/* A closed ball of triangles. */
static void make_ball(MeshData *mesh, V3 *vertices, uint32_t *corners)
{
    uint32_t n = 0;
    for (int i = 0; i <= RINGS; i++)
        for (int j = 0; j < SIDES; j++) {
            double a = PMS_PI * i / RINGS, b = 2 * PMS_PI * j / SIDES;
            vertices[i * SIDES + j] = v3(3 * sin(a) * cos(b), 3 * cos(a), 3 * sin(a) * sin(b));
        }
    for (uint32_t i = 0; i < RINGS; i++)
        for (uint32_t j = 0; j < SIDES; j++) {
            uint32_t a = i * SIDES + j, b = i * SIDES + (j + 1) % SIDES;
            uint32_t quad[6] = {a, b, a + SIDES, b, b + SIDES, a + SIDES};
            for (int k = 0; k < 6; k++)
                corners[n++] = quad[k];
        }
    *mesh = (MeshData){.vertices = vertices,
                       .vertex_count = (RINGS + 1) * SIDES,
                       .corners = corners,
                       .triangle_count = n / 3};
}

static void test_walk(void **state)
{
    (void)state;
    static V3 vertices[(RINGS + 1) * SIDES];
    static uint32_t corners[RINGS * SIDES * 6];
    MeshData mesh;
    Diag diag;
    diag_init(&diag, NULL, NULL);
    make_ball(&mesh, vertices, corners);
    assert_int_equal(mesh_index(&diag, &mesh, 1), OK);
    Rng rng = rng_at(3, 0, 0);
    for (int i = 0; i < 20000; i++) {
        V3 from = v3_scale(warp_sphere((V2){rng_double(&rng), rng_double(&rng)}), 37.3);
        V3 to = v3_scale(warp_sphere((V2){rng_double(&rng), rng_double(&rng)}), 2.9);
        Ray ray = {from, v3_unit(v3_sub(to, from)), 0, INFINITY};
        TriHit all[HITS_MAX], hit;
        int count = tri_index_all(mesh.index, &ray, all, HITS_MAX), met = 0;
        while (tri_index_closest(mesh.index, &ray, &hit)) {
            assert_true(met < count && hit.t == all[met].t);
            while (met < count && all[met].t == hit.t)
                met++;
            ray.tmin = hit.t;
        }
        assert_int_equal(met, count);
        assert_true(count >= 2);
    }
    mesh_done(&mesh);
    diag_done(&diag);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_walk)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
