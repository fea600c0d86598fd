/* The tree of a photon map: nothing lost, same bytes for any threads, and its size.
 * SPDX-License-Identifier: Apache-2.0 */
#include "photon/gather.h"

#include "base/mem.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

typedef V3 (*PlaceFn)(size_t index, Rng *rng);

static V3 place_cube(size_t index, Rng *rng)
{
    (void)index;
    return v3(rng_double(rng), rng_double(rng), rng_double(rng));
}

static V3 place_plane(size_t index, Rng *rng)
{
    (void)index;
    return v3(rng_double(rng), 0, rng_double(rng));
}

static V3 place_line(size_t index, Rng *rng)
{
    (void)rng;
    return v3(0, 0, (double)index);
}

static V3 place_line_back(size_t index, Rng *rng)
{
    (void)rng;
    return v3(-(double)index, 0, 0);
}

static V3 place_one(size_t index, Rng *rng)
{
    (void)index, (void)rng;
    return v3(1, 2, 3);
}

/* Half the photons in one point, the others in few: equal keys everywhere. */
static V3 place_few(size_t index, Rng *rng)
{
    return index % 2 ? v3(1, 1, 1) : v3(rng_u32(rng) % 4, rng_u32(rng) % 3, 0);
}

static V3 place_tiny(size_t index, Rng *rng)
{
    (void)index;
    return v3_scale(v3(rng_double(rng), rng_double(rng), rng_double(rng)), 1e-40);
}

static V3 place_huge(size_t index, Rng *rng)
{
    (void)index;
    return v3_scale(v3(rng_double(rng), rng_double(rng), rng_double(rng)), 1e18);
}

static Photon *make_photons(size_t count, PlaceFn place)
{
    Photon *photons = mem_array(count, sizeof *photons);
    for (size_t i = 0; i < count; i++) {
        Rng rng = rng_at(2, 0, i);
        V3 p = place(i, &rng);
        photons[i] = (Photon){.pos = {(float)p.x, (float)p.y, (float)p.z},
                              .phi = (uint8_t)i,
                              .theta = (uint8_t)(i >> 8),
                              .flags = (uint16_t)(i >> 16)};
        rgbe_encode(RGB_WHITE, &rng, photons[i].rgbe);
    }
    return photons;
}

static PhotonMap *make_map(size_t count, PlaceFn place, int threads)
{
    Diag diag;
    diag_init(&diag, NULL, NULL);
    PhotonMap *map = NULL;
    Status status =
        photon_map_new(&diag, make_photons(count, place), count, v3(0, 0, 0), threads, &map);
    assert_int_equal(status, OK);
    diag_done(&diag);
    return map;
}

static const PlaceFn places[] = {place_cube, place_plane, place_line, place_line_back,
                                 place_one,  place_few,   place_tiny, place_huge};
enum { PLACES = sizeof places / sizeof places[0] };

/* Every photon comes out of the tree exactly once, unchanged. */
static void nothing_is_lost(void **state)
{
    (void)state;
    const size_t counts[] = {1, 2, 15, 16, 17, 31, 32, 33, 48, 49, 100, 1000, 4095, 20000};
    for (int place = 0; place < PLACES; place++)
        for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++) {
            size_t count = counts[c];
            Photon *expected = make_photons(count, places[place]);
            PhotonMap *map = make_map(count, places[place], 2);
            assert_int_equal(photon_map_count(map), count);
            unsigned char *seen = calloc(count, 1);
            for (size_t i = 0; i < count; i++) {
                Photon photon = photon_map_at(map, i);
                size_t id = photon.phi | (size_t)photon.theta << 8 | (size_t)photon.flags << 16;
                assert_true(id < count && !seen[id]);
                seen[id] = 1;
                assert_memory_equal(&photon, &expected[id], sizeof photon);
            }
            free(seen);
            mem_free(expected);
            photon_map_free(map);
        }
}

/* Row S1: the same bytes for any number of threads. */
static void threads_make_no_difference(void **state)
{
    (void)state;
    const int threads[] = {2, 3, 7, 16};
    for (int place = 0; place < PLACES; place++) {
        PhotonMap *one = make_map(50000, places[place], 1);
        for (int t = 0; t < 4; t++) {
            PhotonMap *many = make_map(50000, places[place], threads[t]);
            assert_true(photon_map_hash(one) == photon_map_hash(many));
            photon_map_free(many);
        }
        photon_map_free(one);
    }
}

static void hash_sees_every_change(void **state)
{
    (void)state;
    PhotonMap *a = make_map(1000, place_cube, 1), *b = make_map(1001, place_cube, 1);
    PhotonMap *c = make_map(1000, place_plane, 1);
    assert_true(photon_map_hash(a) != photon_map_hash(b));
    assert_true(photon_map_hash(a) != photon_map_hash(c));
    assert_true(photon_map_hash(a) != 0);
    photon_map_free(a);
    photon_map_free(b);
    photon_map_free(c);
}

enum { BLOCK = 16 };

/* Check that some plane parts the photons of the first `left` blocks from the other ones. */
static void check_cut(const PhotonMap *map, size_t first, size_t left, size_t blocks)
{
    float lo[3] = {-INFINITY, -INFINITY, -INFINITY}, hi[3] = {INFINITY, INFINITY, INFINITY};
    size_t end = (first + blocks) * BLOCK, count = photon_map_count(map);
    for (size_t i = first * BLOCK; i < end && i < count; i++) {
        Photon photon = photon_map_at(map, i);
        for (int a = 0; a < 3; a++)
            if (i < (first + left) * BLOCK)
                lo[a] = fmaxf(lo[a], photon.pos[a]);
            else
                hi[a] = fminf(hi[a], photon.pos[a]);
    }
    assert_true(lo[0] <= hi[0] || lo[1] <= hi[1] || lo[2] <= hi[2]);
}

/* Walk a left-balanced tree of blocks: its last level is filled from the left.  Returns its depth.
 */
static int check_tree(const PhotonMap *map, size_t first, size_t blocks)
{
    if (blocks < 2)
        return 0;
    size_t level = 1;
    while (level * 2 <= blocks)
        level *= 2;
    size_t deeper = blocks - level, left = level / 2 + (deeper < level / 2 ? deeper : level / 2);
    check_cut(map, first, left, blocks);
    int a = check_tree(map, first, left), b = check_tree(map, first + left, blocks - left);
    return 1 + (a > b ? a : b);
}

/* Row S10: a kd-tree in one array, as balanced as can be: blocks of 16 photons, at every node cut
 * by a plane, and no deeper than the logarithm of their number. */
static void tree_is_balanced(void **state)
{
    (void)state;
    const size_t counts[] = {17, 100, 1000, 4095, 4096, 4097, 50000};
    for (int place = 0; place < PLACES; place++)
        for (size_t c = 0; c < sizeof counts / sizeof counts[0]; c++) {
            PhotonMap *map = make_map(counts[c], places[place], 2);
            size_t blocks = (counts[c] + BLOCK - 1) / BLOCK;
            assert_int_equal(check_tree(map, 0, blocks), (int)ceil(log2((double)blocks)));
            photon_map_free(map);
        }
}

/* Row S10: 20 bytes a photon, at most 2 % more. */
static void memory_is_20_bytes_a_photon(void **state)
{
    (void)state;
    for (size_t count = 10000; count < 400000; count = count * 7 / 3 + 1) {
        PhotonMap *map = make_map(count, place_cube, 1);
        assert_true((double)photon_map_bytes(map) <= 20.0 * 1.02 * (double)count);
        photon_map_free(map);
    }
}

static void photons_nowhere_are_dropped(void **state)
{
    (void)state;
    Diag diag;
    diag_init(&diag, NULL, NULL);
    Photon *photons = make_photons(100, place_cube);
    photons[3].pos[0] = NAN;
    photons[50].pos[1] = INFINITY;
    photons[99].pos[2] = -INFINITY;
    PhotonMap *map;
    assert_int_equal(photon_map_new(&diag, photons, 100, v3(0, 0, 0), 1, &map), OK);
    assert_int_equal(photon_map_count(map), 97);
    for (size_t i = 0; i < 97; i++)
        assert_true(isfinite(photon_map_at(map, i).pos[0]));
    photon_map_free(map);
    diag_done(&diag);
}

static void empty_map(void **state)
{
    (void)state;
    PhotonMap *map = make_map(0, place_cube, 2);
    assert_int_equal(photon_map_count(map), 0);
    assert_true(photon_map_radius(map, 100) == 0);
    GatherScratch *scratch = gather_scratch_new();
    GatherLimits limits = GATHER_LIMITS_DEFAULT;
    Rgb out;
    assert_int_equal(photon_gather(map, v3(0, 0, 0), v3(0, 1, 0), &limits, scratch, &out), 0);
    assert_true(rgb_is_black(out));
    gather_scratch_free(scratch);
    photon_map_free(map);
    photon_map_free(NULL);
}

static void quiet(void *ctx, const char *text)
{
    (void)ctx, (void)text;
}

static void out_of_memory_is_reported(void **state)
{
    (void)state;
    for (int n = 1; n <= 4; n++) {
        Diag diag;
        diag_init(&diag, quiet, NULL);
        Photon *photons = make_photons(1000, place_cube);
        PhotonMap *map;
        mem_fail_from(n);
        Status status = photon_map_new(&diag, photons, 1000, v3(0, 0, 0), 1, &map);
        mem_fail_from(0);
        assert_int_equal(status, ERR_MEMORY);
        assert_null(map);
        diag_done(&diag);
    }
}

/* The automatic radius holds about k photons on a uniform field, and scales with the scene. */
static void radius_follows_density(void **state)
{
    (void)state;
    PhotonMap *map = make_map(40000, place_plane, 1);
    double radius = photon_map_radius(map, 100);
    double ideal = sqrt(100 / (PMS_PI * 40000));
    assert_true(radius > 0.9 * ideal && radius < 2 * ideal);
    photon_map_free(map);
    PhotonMap *point = make_map(1000, place_one, 1);
    assert_true(photon_map_radius(point, 100) == 0);
    photon_map_free(point);
}

/* A map that is asked tells where its photons were before, and which of them were seen. */
static void order_and_seen(void **state)
{
    (void)state;
    enum { COUNT = 5000 };
    Diag diag;
    diag_init(&diag, NULL, NULL);
    PhotonMap *map;
    uint32_t *order;
    Photon *before = make_photons(COUNT, place_cube);
    Photon *photons = make_photons(COUNT, place_cube);
    assert_int_equal(photon_map_new_full(&diag, photons, NULL, COUNT, v3(0, 0, 0), 2, &order, &map),
                     OK);
    for (size_t i = 0; i < COUNT; i++) {
        Photon photon = photon_map_at(map, i);
        assert_memory_equal(&photon, &before[order[i]], sizeof photon);
    }
    assert_int_equal(photon_map_watch(&diag, map), OK);
    GatherScratch *scratch = gather_scratch_new();
    GatherLimits limits = GATHER_LIMITS_DEFAULT;
    limits.normal_cosine = -1;
    const uint32_t *near;
    double radius2;
    Rgb light;
    int used = photon_gather(map, v3(0.5, 0.5, 0.5), v3(0, 1, 0), &limits, scratch, &light);
    photon_gather_see(map, scratch);
    int found =
        photon_nearest(map, v3(0.5, 0.5, 0.5), v3(0, 1, 0), &limits, scratch, &near, &radius2);
    size_t seen = 0;
    for (size_t i = 0; i < COUNT; i++)
        seen += photon_map_is_seen(map, i);
    assert_true(used > 50 && found == used && seen == (size_t)used);
    for (int i = 0; i < found; i++)
        assert_true(photon_map_is_seen(map, near[i]));
    gather_scratch_free(scratch);
    mem_free(before);
    mem_free(order);
    photon_map_free(map);
    diag_done(&diag);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_is_lost),
        cmocka_unit_test(threads_make_no_difference),
        cmocka_unit_test(hash_sees_every_change),
        cmocka_unit_test(tree_is_balanced),
        cmocka_unit_test(memory_is_20_bytes_a_photon),
        cmocka_unit_test(photons_nowhere_are_dropped),
        cmocka_unit_test(empty_map),
        cmocka_unit_test(out_of_memory_is_reported),
        cmocka_unit_test(radius_follows_density),
        cmocka_unit_test(order_and_seen),
    };
    return cmocka_run_group_tests_name("photon_map", tests, NULL, NULL);
}
