/* The table of cells that hold photons: it never hides one.
 * SPDX-License-Identifier: Apache-2.0 */
#include "eye/photon_reach.h"

#include "base/mem.h"
#include "base/rng.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

enum { COUNT = 500 };

/* A cluster of photons around the centre, and a few far away. */
static PhotonMap *cluster(V3 center, size_t count)
{
    Rng rng = rng_at(3, 1, count);
    Photon *photons = mem_array(count + 1, sizeof *photons);
    assert_non_null(photons);
    for (size_t i = 0; i < count; i++)
        for (int axis = 0; axis < 3; axis++) {
            double size = i % 50 == 0 ? 1e4 : 1;
            photons[i].pos[axis] = (float)(size * (2 * rng_double(&rng) - 1));
        }
    PhotonMap *map;
    assert_int_equal(photon_map_new(NULL, photons, count, center, 1, &map), OK);
    return map;
}

static double nearest(const PhotonMap *map, V3 p)
{
    double least = INFINITY;
    for (size_t i = 0; i < photon_map_count(map); i++) {
        Photon photon = photon_map_at(map, i);
        V3 at = v3((double)photon.pos[0], (double)photon.pos[1], (double)photon.pos[2]);
        least = fmin(least, v3_dist(p, v3_add(photon_map_center(map), at)));
    }
    return least;
}

static void photons_within_the_radius_are_seen(void **state)
{
    (void)state;
    const V3 centers[] = {{0, 0, 0}, {1e5, -2e5, 3}};
    for (int c = 0; c < 2; c++) {
        PhotonMap *map = cluster(centers[c], COUNT);
        PhotonReach reach;
        double radius = 0.1;
        assert_int_equal(photon_reach_init(&reach, map, radius, NULL), OK);
        Rng rng = rng_at(4, 1, (uint64_t)c);
        int near = 0, empty = 0, passed = 0;
        for (int i = 0; i < 3000; i++) {
            V3 p = v3_add(centers[c], v3(4 * rng_double(&rng) - 2, 4 * rng_double(&rng) - 2,
                                         4 * rng_double(&rng) - 2));
            bool has = photon_reach_has(&reach, p);
            if (nearest(map, p) < radius) {
                near++;
                assert_true(has);
            } else {
                empty++;
                passed += !has;
            }
        }
        /* The balls around the photons fill about 3 % of where the points are, the cluster an
         * eighth. */
        assert_true(near > 40 && passed > empty / 2);
        photon_reach_done(&reach);
        photon_map_free(map);
    }
}

static void what_cannot_be_told_looks_full(void **state)
{
    (void)state;
    PhotonMap *map = cluster(v3(0, 0, 0), COUNT);
    const double radii[] = {INFINITY, NAN};
    for (int i = 0; i < 2; i++) {
        PhotonReach reach;
        assert_int_equal(photon_reach_init(&reach, map, radii[i], NULL), OK);
        assert_true(photon_reach_has(&reach, v3(9, 9, 9)));
        photon_reach_done(&reach);
    }
    PhotonReach reach;
    assert_int_equal(photon_reach_init(&reach, map, 0.1, NULL), OK);
    assert_true(photon_reach_has(&reach, v3(1e300, 0, 0)));
    assert_true(photon_reach_has(&reach, v3(NAN, 0, 0)));
    photon_reach_done(&reach);
    photon_map_free(map);
}

static void an_empty_map_is_empty_everywhere(void **state)
{
    (void)state;
    PhotonMap *map = cluster(v3(0, 0, 0), 0);
    PhotonReach reach;
    assert_int_equal(photon_reach_init(&reach, map, 0.1, NULL), OK);
    assert_false(photon_reach_has(&reach, v3(0, 0, 0)));
    photon_reach_done(&reach);
    photon_map_free(map);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(photons_within_the_radius_are_seen),
        cmocka_unit_test(what_cannot_be_told_looks_full),
        cmocka_unit_test(an_empty_map_is_empty_everywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
