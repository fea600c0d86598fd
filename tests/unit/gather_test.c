/* Gathering: exactly the k nearest, unbiased for every kernel, and no leaks through walls.
 * SPDX-License-Identifier: Apache-2.0 */
#include "photon/gather.h"

#include "base/mem.h"
#include "math/sample.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static Photon photon_at(V3 p, V3 n, Rgb power, uint64_t key)
{
    Rng rng = rng_at(9, 9, key);
    Photon photon = {.pos = {(float)p.x, (float)p.y, (float)p.z},
                     .flags = (uint16_t)(normal14_encode(n) << 2)};
    rgbe_encode(power, &rng, photon.rgbe);
    direction_encode(n, &photon.phi, &photon.theta);
    return photon;
}

static PhotonMap *map_of(Photon *photons, size_t count, V3 center)
{
    Diag diag;
    diag_init(&diag, NULL, NULL);
    PhotonMap *map = NULL;
    assert_int_equal(photon_map_new(&diag, photons, count, center, 2, &map), OK);
    diag_done(&diag);
    return map;
}

/* --- exactly the k nearest -------------------------------------------------------------- */

static float brute_distance(const Photon *photon, const float q[3], const float n[3], bool is_disk)
{
    float dx = photon->pos[0] - q[0], dy = photon->pos[1] - q[1], dz = photon->pos[2] - q[2];
    float d2 = dx * dx + dy * dy + dz * dz, height = n[0] * dx + n[1] * dy + n[2] * dz;
    float slab2 = height * height * (float)(1 / (GATHER_SLAB * GATHER_SLAB));
    return is_disk && slab2 > d2 ? slab2 : d2;
}

typedef struct Near {
    float distance2;
    uint32_t index;
} Near;

static int by_distance(const void *a, const void *b)
{
    const Near *x = a, *y = b;
    if (x->distance2 != y->distance2)
        return x->distance2 < y->distance2 ? -1 : 1;
    return x->index < y->index ? -1 : x->index > y->index;
}

static int by_index(const void *a, const void *b)
{
    uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
    return x < y ? -1 : x > y;
}

static void check_nearest(const PhotonMap *map, V3 q, V3 n, const GatherLimits *limits,
                          GatherScratch *scratch, Near *all)
{
    size_t total = photon_map_count(map);
    float qf[3] = {(float)q.x, (float)q.y, (float)q.z},
          nf[3] = {(float)n.x, (float)n.y, (float)n.z};
    for (size_t i = 0; i < total; i++) {
        Photon photon = photon_map_at(map, i);
        all[i] = (Near){brute_distance(&photon, qf, nf, limits->shape == GATHER_DISK), (uint32_t)i};
    }
    qsort(all, total, sizeof *all, by_distance);
    const uint32_t *got;
    double radius2;
    int count = photon_nearest(map, q, n, limits, scratch, &got, &radius2);
    float most = (float)(limits->max_radius * limits->max_radius);
    size_t within = 0;
    while (within < total && all[within].distance2 <= most)
        within++;
    bool is_full = limits->max_photons > 0 && within >= (size_t)limits->max_photons;
    size_t expected = is_full ? (size_t)limits->max_photons - 1 : within;
    assert_int_equal(count, expected);
    assert_true((float)radius2 == (is_full ? all[expected].distance2 : most));
    uint32_t *a = malloc((expected + 1) * sizeof *a), *b = malloc((expected + 1) * sizeof *b);
    for (size_t i = 0; i < expected; i++) {
        a[i] = all[i].index;
        b[i] = got[i];
    }
    qsort(a, expected, sizeof *a, by_index);
    qsort(b, expected, sizeof *b, by_index);
    assert_memory_equal(a, b, expected * sizeof *a);
    free(a);
    free(b);
}

static V3 cloud_point(int kind, Rng *rng)
{
    double x = rng_double(rng), y = rng_double(rng), z = rng_double(rng);
    switch (kind) {
    case 0:
        return v3(x, y, z); /* a cube */
    case 1:
        return v3(x, 0, z); /* a plane */
    case 2:
        return v3(floor(8 * x), floor(8 * y), 0); /* many at equal distance */
    case 3:
        return v3(pow(x, 8), pow(y, 8), 0); /* a steep density */
    case 4:
        return v3_add(v3(1e6, 1e6, 1e6), v3(x, y, z)); /* few bits left */
    default:
        return v3(1, 1, 1); /* all in one place */
    }
}

/* Row S12: the photons found are the k nearest, by either shape, no others. */
static void exactly_the_k_nearest(void **state)
{
    (void)state;
    enum { COUNT = 3000, KINDS = 6 };
    Near *all = malloc(COUNT * sizeof *all);
    GatherScratch *scratch = gather_scratch_new(); /* one for all: its memory must not matter */
    const int ks[] = {1, 2, 10, 50, 100, 500, 2999, 3000, 5000, 0};
    const double radii[] = {INFINITY, 0.3, 0.01, 0};
    for (int kind = 0; kind < KINDS; kind++) {
        Photon *photons = mem_array(COUNT, sizeof *photons);
        for (size_t i = 0; i < COUNT; i++) {
            Rng rng = rng_at(21, (uint32_t)kind, i);
            photons[i] = photon_at(cloud_point(kind, &rng), v3(0, 0, 1), RGB_WHITE, i);
        }
        PhotonMap *map = map_of(photons, COUNT, v3(0, 0, 0));
        for (int trial = 0; trial < 120; trial++) {
            Rng rng = rng_at(22, (uint32_t)kind, (uint64_t)trial);
            V3 q = cloud_point(kind, &rng);
            if (trial % 3 == 1)
                q = v3_add(q, v3(0.01, -0.02, 0.03));
            if (trial % 11 == 10)
                q = v3_scale(q, 40);
            GatherLimits limits = {.max_photons = ks[trial % 10],
                                   .max_radius = radii[trial / 10 % 4],
                                   .shape = trial % 2 ? GATHER_DISK : GATHER_SPHERE,
                                   .normal_cosine = -1};
            if (limits.max_photons == 0 && isinf(limits.max_radius))
                limits.max_radius = 0.5;
            V3 n = v3_unit(v3(rng_double(&rng) - 0.5, rng_double(&rng) - 0.5, 0.7));
            check_nearest(map, q, n, &limits, scratch, all);
        }
        photon_map_free(map);
    }
    gather_scratch_free(scratch);
    free(all);
}

/* Tens of thousands equally far: the slab makes all photons of a far plane so. */
static void many_equally_far(void **state)
{
    (void)state;
    enum { COUNT = 30000 };
    Near *all = malloc(COUNT * sizeof *all);
    Photon *photons = mem_array(COUNT, sizeof *photons);
    for (size_t i = 0; i < COUNT; i++) {
        Rng rng = rng_at(25, 0, i);
        photons[i] = photon_at(cloud_point(1, &rng), v3(0, 1, 0), RGB_WHITE, i);
    }
    PhotonMap *map = map_of(photons, COUNT, v3(0, 0, 0));
    GatherScratch *scratch = gather_scratch_new();
    GatherLimits limits = {.max_photons = 100, .max_radius = INFINITY, .normal_cosine = -1};
    for (int i = 0; i < 5; i++)
        check_nearest(map, v3(0.2 * i, 0.5, 0.5), v3(0, 1, 0), &limits, scratch, all);
    gather_scratch_free(scratch);
    photon_map_free(map);
    free(all);
}

/* The estimate does not depend, to the last bit, on what was asked before. */
static void history_makes_no_difference(void **state)
{
    (void)state;
    enum { COUNT = 20000, QUERIES = 200 };
    Photon *photons = mem_array(COUNT, sizeof *photons);
    for (size_t i = 0; i < COUNT; i++) {
        Rng rng = rng_at(23, 0, i);
        Rgb power = rgb(rng_float(&rng), rng_float(&rng), rng_float(&rng));
        photons[i] = photon_at(cloud_point(3, &rng), v3(0, 0, 1), power, i);
    }
    PhotonMap *map = map_of(photons, COUNT, v3(0, 0, 0));
    GatherScratch *forth = gather_scratch_new();
    GatherLimits limits = GATHER_LIMITS_DEFAULT;
    limits.max_radius = 0.2;
    Rgb first[QUERIES];
    for (int pass = 0; pass < 2; pass++)
        for (int i = 0; i < QUERIES; i++) {
            int at = pass ? QUERIES - 1 - i : i;
            Rng rng = rng_at(24, 0, (uint64_t)at);
            GatherScratch *fresh = gather_scratch_new();
            V3 q = cloud_point(3, &rng);
            Rgb out, alone;
            photon_gather(map, q, v3(0, 0, 1), &limits, forth, &out);
            photon_gather(map, q, v3(0, 0, 1), &limits, fresh, &alone);
            assert_memory_equal(&out, &alone, sizeof out);
            if (pass == 0)
                first[at] = out;
            else
                assert_memory_equal(&out, &first[at], sizeof out);
            gather_scratch_free(fresh);
        }
    gather_scratch_free(forth);
    photon_map_free(map);
}

/* --- unbiased --------------------------------------------------------------------------- */

/* Row S15: the mean of the kernels over the disk is 1, but for the Gaussian with the printed scale,
 * which loses 46.9 %. */
static void kernels_keep_the_light(void **state)
{
    (void)state;
    for (int kernel = 0; kernel < KERNEL_COUNT; kernel++) {
        double sum = 0;
        for (int i = 0; i < 100000; i++)
            sum += gather_kernel((GatherKernel)kernel, (i + 0.5) / 100000) / 100000;
        double expected = kernel == KERNEL_GAUSSIAN_JENSEN ? 0.5312 : 1;
        assert_true(fabs(sum - expected) < (kernel == KERNEL_GAUSSIAN_JENSEN ? 1e-4 : 1e-6));
        assert_true(gather_kernel((GatherKernel)kernel, 0) >=
                    gather_kernel((GatherKernel)kernel, 1));
    }
}

enum { FIELDS = 24, FIELD_PHOTONS = 100000, FIELD_QUERIES = 40 };

/* Random photons of power 1/density on the unit square: irradiance 1 (a new set each time, for
 * the mean over fields is what must be 1). */
static PhotonMap *uniform_field(uint64_t seed)
{
    Photon *photons = mem_array(FIELD_PHOTONS, sizeof *photons);
    for (size_t i = 0; i < FIELD_PHOTONS; i++) {
        Rng rng = rng_at(seed, 31, i);
        V3 p = v3(rng_double(&rng), rng_double(&rng), 0);
        photons[i] = photon_at(p, v3(0, 0, 1), rgb_gray(1.0f / FIELD_PHOTONS), seed * 77777 + i);
    }
    return map_of(photons, FIELD_PHOTONS, v3(0, 0, 0.25));
}

/* Of even light a blur is by chance alone, and varies as it is said to for its noise. */
static void blur_of_even_light_is_noise(void **state)
{
    (void)state;
    assert_true(fabs(gather_blur_variance(KERNEL_FLAT) - 1) < 1e-12);
    assert_true(fabs(gather_blur_variance(KERNEL_EPANECHNIKOV) - 0.5) < 1e-3);
    GatherScratch *scratch = gather_scratch_new();
    PhotonMap *map = uniform_field(1);
    for (int kernel = 0; kernel <= KERNEL_GAUSSIAN; kernel++) {
        double blur2 = 0, noise2 = 0;
        GatherLimits limits = {.max_photons = 50,
                               .max_radius = INFINITY,
                               .kernel = (GatherKernel)kernel,
                               .normal_cosine = 0.9,
                               .has_error = true};
        for (int i = 0; i < FIELD_QUERIES * FIELD_QUERIES; i++) {
            V3 q = v3(0.1 + 0.8 * (i % FIELD_QUERIES) / FIELD_QUERIES,
                      0.1 + 0.8 * (i / FIELD_QUERIES) / FIELD_QUERIES, 0.25);
            LightEstimate found;
            photon_gather_estimate(map, q, v3(0, 0, 1), &limits, scratch, &found);
            blur2 += (double)found.blur.g * (double)found.blur.g;
            noise2 += (double)found.noise.g * (double)found.noise.g;
        }
        double expected = gather_blur_variance((GatherKernel)kernel);
        print_message("# kernel %d: %.3f of %.3f\n", kernel, blur2 / noise2, expected);
        assert_true(fabs(blur2 / noise2 / expected - 1) < 0.15); /* 4 standard errors */
    }
    photon_map_free(map);
    gather_scratch_free(scratch);
}

typedef struct Setup {
    GatherKernel kernel;
    GatherShape shape;
    int k, least;
    double radius, sum, sum2;
} Setup;

/* Row S12: every kernel, k = 10 to 500, disk and sphere, fixed radius, and the widening search:
 * mean error below 0.3 %.  Row S15: so for all filters.  Queries of one field share photons, so the
 * standard error comes from the spread of whole fields. */
static void every_estimate_is_unbiased(void **state)
{
    (void)state;
    Setup setups[96];
    int count = 0;
    const int ks[] = {10, 20, 50, 100, 500};
    for (int kernel = 0; kernel < KERNEL_COUNT; kernel++)
        for (int shape = 0; shape < 2; shape++) {
            if (kernel == KERNEL_GAUSSIAN_JENSEN)
                continue;
            for (int i = 0; i < 5; i++)
                setups[count++] =
                    (Setup){(GatherKernel)kernel, (GatherShape)shape, ks[i], 0, INFINITY, 0, 0};
            /* a radius that holds 30: all within; the 30 nearest at most; 40 at least */
            double radius = sqrt(30 / (PMS_PI * FIELD_PHOTONS));
            setups[count++] = (Setup){(GatherKernel)kernel, (GatherShape)shape, 0, 0, radius, 0, 0};
            setups[count++] =
                (Setup){(GatherKernel)kernel, (GatherShape)shape, 30, 0, radius, 0, 0};
            setups[count++] =
                (Setup){(GatherKernel)kernel, (GatherShape)shape, 60, 30, radius, 0, 0};
            setups[count++] =
                (Setup){(GatherKernel)kernel, (GatherShape)shape, 90, 40, radius, 0, 0};
        }
    GatherScratch *scratch = gather_scratch_new();
    for (int field = 0; field < FIELDS; field++) {
        PhotonMap *map = uniform_field((uint64_t)field + 1);
        for (int s = 0; s < count; s++) {
            Setup *setup = &setups[s];
            GatherLimits limits = {.max_photons = setup->k,
                                   .min_photons = setup->least,
                                   .max_radius = setup->radius,
                                   .far_radius = 3 * setup->radius,
                                   .shape = setup->shape,
                                   .kernel = setup->kernel,
                                   .normal_cosine = 0.9};
            double mean = 0;
            for (int y = 0; y < FIELD_QUERIES; y++)
                for (int x = 0; x < FIELD_QUERIES; x++) {
                    V3 q = v3(0.1 + 0.8 * x / FIELD_QUERIES, 0.1 + 0.8 * y / FIELD_QUERIES, 0.25);
                    Rgb out;
                    photon_gather(map, q, v3(0, 0, 1), &limits, scratch, &out);
                    mean += (double)out.g / (FIELD_QUERIES * FIELD_QUERIES);
                }
            setup->sum += mean;
            setup->sum2 += mean * mean;
        }
        photon_map_free(map);
    }
    for (int s = 0; s < count; s++) {
        double mean = setups[s].sum / FIELDS;
        double spread = sqrt(fmax(0, setups[s].sum2 / FIELDS - mean * mean) / (FIELDS - 1));
        if (fabs(mean - 1) >= fmin(4 * spread, 0.003))
            print_message("# kernel %d %s k %d least %d radius %.4f: mean %.5f +- %.5f\n",
                          (int)setups[s].kernel, setups[s].shape ? "sphere" : "disk", setups[s].k,
                          setups[s].least, setups[s].radius, mean, spread);
        assert_true(fabs(mean - 1) < 4 * spread);
        assert_true(fabs(mean - 1) < 0.003);
    }
    gather_scratch_free(scratch);
}

/* On a ball the slab cuts nothing as long as the radius is small, and area is exact. */
static void curvature_makes_no_bias(void **state)
{
    (void)state;
    enum { COUNT = 200000 };
    Photon *photons = mem_array(COUNT, sizeof *photons);
    for (size_t i = 0; i < COUNT; i++) {
        Rng rng = rng_at(41, 0, i);
        double z = 2 * rng_double(&rng) - 1, a = 2 * PMS_PI * rng_double(&rng);
        V3 n = v3(sqrt(1 - z * z) * cos(a), sqrt(1 - z * z) * sin(a), z);
        photons[i] = photon_at(n, n, rgb_gray((float)(4 * PMS_PI / COUNT)), i);
    }
    PhotonMap *map = map_of(photons, COUNT, v3(0, 0, 0));
    GatherScratch *scratch = gather_scratch_new();
    /* radius 0.28 < 2 * 0.2; cosine of the cap's edge is 0.96 */
    GatherLimits limits = {
        .max_radius = 0.28, .shape = GATHER_DISK, .kernel = KERNEL_FLAT, .normal_cosine = 0.9};
    double sum = 0;
    const int queries = 400;
    for (int i = 0; i < queries; i++) {
        Rng rng = rng_at(42, 0, (uint64_t)i);
        double z = 2 * rng_double(&rng) - 1, a = 2 * PMS_PI * rng_double(&rng);
        V3 n = v3(sqrt(1 - z * z) * cos(a), sqrt(1 - z * z) * sin(a), z);
        Rgb out;
        photon_gather(map, n, n, &limits, scratch, &out);
        sum += (double)out.r / queries;
    }
    /* the caps cover the ball many times over: the error is below that of one cap's count */
    double one_cap = 1 / sqrt(COUNT * 0.28 * 0.28 / 4);
    assert_true(fabs(sum - 1) < 4 * one_cap / sqrt(queries * 0.2));
    gather_scratch_free(scratch);
    photon_map_free(map);
}

/* --- leaks ------------------------------------------------------------------------------ */

/* Row S12: both faces of a sheet 1e-6 thick, lit on one side only: the other is black. */
static void thin_wall_does_not_leak(void **state)
{
    (void)state;
    enum { COUNT = 20000 };
    Photon *photons = mem_array(COUNT, sizeof *photons);
    for (size_t i = 0; i < COUNT; i++) {
        Rng rng = rng_at(51, 0, i);
        photons[i] = photon_at(v3(rng_double(&rng), rng_double(&rng), 0), v3(0, 0, 1),
                               rgb_gray(1.0f / COUNT), i);
    }
    PhotonMap *map = map_of(photons, COUNT, v3(0, 0, 0));
    GatherScratch *scratch = gather_scratch_new();
    GatherLimits limits = GATHER_LIMITS_DEFAULT;
    limits.max_radius = 0.1;
    Rgb out;
    assert_int_equal(photon_gather(map, v3(0.5, 0.5, -1e-6), v3(0, 0, -1), &limits, scratch, &out),
                     0);
    assert_true(rgb_is_black(out));
    assert_true(photon_gather(map, v3(0.5, 0.5, 0), v3(0, 0, 1), &limits, scratch, &out) > 90);
    assert_true(fabsf(out.r - 1) < 0.5f);
    gather_scratch_free(scratch);
    photon_map_free(map);
}

/* Row S12: a lit wall next to a dark floor: nothing of the wall's light counts on the floor,
 * whatever the distance from the edge, and a ball without normals does leak (so the test can fail).
 */
static void corner_does_not_leak(void **state)
{
    (void)state;
    enum { COUNT = 20000 };
    Photon *photons = mem_array(COUNT, sizeof *photons);
    for (size_t i = 0; i < COUNT; i++) {
        Rng rng = rng_at(52, 0, i);
        photons[i] = photon_at(v3(0, rng_double(&rng), rng_double(&rng)), v3(1, 0, 0),
                               rgb_gray(1.0f / COUNT), i);
    }
    PhotonMap *map = map_of(photons, COUNT, v3(0, 0, 0));
    GatherScratch *scratch = gather_scratch_new();
    for (int i = 0; i <= 20; i++) {
        V3 floor_point = v3(i * 0.005, 0, 0.5);
        Rgb out;
        GatherLimits limits = GATHER_LIMITS_DEFAULT;
        limits.max_radius = 0.05;
        limits.far_radius = 0.15;
        photon_gather(map, floor_point, v3(0, 1, 0), &limits, scratch, &out);
        assert_true(rgb_is_black(out));
        limits.shape = GATHER_SPHERE;
        limits.normal_cosine = -1;
        photon_gather(map, floor_point, v3(0, 1, 0), &limits, scratch, &out);
        assert_true(rgb_is_black(out) == (i * 0.005 > 0.15));
        if (i <= 5)
            assert_true(out.r > 0.1f);
    }
    gather_scratch_free(scratch);
    photon_map_free(map);
}

/* Row S12: a floor under a shelf: parallel sheets further apart than the slab do not mix. */
static void parallel_sheets_do_not_mix(void **state)
{
    (void)state;
    enum { COUNT = 20000 };
    Photon *photons = mem_array(COUNT, sizeof *photons);
    for (size_t i = 0; i < COUNT; i++) {
        Rng rng = rng_at(53, 0, i);
        photons[i] = photon_at(v3(rng_double(&rng), 0.02, rng_double(&rng)), v3(0, 1, 0),
                               rgb_gray(1.0f / COUNT), i);
    }
    PhotonMap *map = map_of(photons, COUNT, v3(0, 0, 0));
    GatherScratch *scratch = gather_scratch_new();
    GatherLimits limits = {.max_radius = 0.09, .shape = GATHER_DISK, .normal_cosine = 0.5};
    Rgb out;
    assert_int_equal(photon_gather(map, v3(0.5, 0, 0.5), v3(0, 1, 0), &limits, scratch, &out), 0);
    limits.shape = GATHER_SPHERE;
    assert_true(photon_gather(map, v3(0.5, 0, 0.5), v3(0, 1, 0), &limits, scratch, &out) > 100);
    gather_scratch_free(scratch);
    photon_map_free(map);
}

/* Beside a bright disk of light of radius 0.3 the search widens, and takes in little of it; in the
 * middle of the disk, where it need not, nothing changes. */
static void bright_spots_do_not_spill(void **state)
{
    (void)state;
    enum { COUNT = 50000 };
    Photon *photons = mem_array(COUNT, sizeof *photons);
    for (size_t i = 0; i < COUNT; i++) {
        Rng rng = rng_at(54, 0, i);
        V2 u = {rng_double(&rng), 0};
        u.v = rng_double(&rng);
        V2 at = warp_disk(u);
        photons[i] = photon_at(v3(0.3 * at.u, 0, 0.3 * at.v), v3(0, 1, 0),
                               rgb_gray((float)(0.09 * PMS_PI) / COUNT), i);
    }
    PhotonMap *map = map_of(photons, COUNT, v3(0, 0, 0));
    GatherScratch *scratch = gather_scratch_new();
    GatherLimits limits = GATHER_LIMITS_DEFAULT;
    limits.max_radius = 0.02;
    limits.far_radius = 0.3;
    Rgb out;
    for (int i = 1; i <= 14; i++) {
        double away = 0.02 * i;
        photon_gather(map, v3(0.3 + away, 0, 0), v3(0, 1, 0), &limits, scratch, &out);
        /* A flat mean over the disk that holds 20 photons would be 0.09 at 0.02 away. */
        assert_true(out.r < 0.02f);
    }
    assert_true(photon_gather(map, v3(0.59, 0, 0), v3(0, 1, 0), &limits, scratch, &out) > 0);
    assert_int_equal(photon_gather(map, v3(0.61, 0, 0), v3(0, 1, 0), &limits, scratch, &out), 0);
    photon_gather(map, v3(0, 0, 0), v3(0, 1, 0), &limits, scratch, &out);
    assert_true(fabsf(out.r - 1) < 0.4f); /* 99 photons: a standard error of 0.1 */
    gather_scratch_free(scratch);
    photon_map_free(map);
}

/* --- the list, and odd queries ---------------------------------------------------------- */

static void list_adds_up_to_the_estimate(void **state)
{
    (void)state;
    PhotonMap *map = uniform_field(99);
    GatherScratch *scratch = gather_scratch_new();
    for (int kernel = 0; kernel < KERNEL_COUNT; kernel++) {
        GatherLimits limits = GATHER_LIMITS_DEFAULT;
        limits.kernel = (GatherKernel)kernel;
        const GatheredPhoton *list;
        V3 q = v3(0.5, 0.4, 0.25), n = v3(0, 0, 1);
        Rgb out;
        int used = photon_gather(map, q, n, &limits, scratch, &out);
        assert_int_equal(used, 99);
        assert_int_equal(photon_gather_list(map, q, n, &limits, scratch, &list), used);
        Rgb sum = RGB_BLACK;
        for (int i = 0; i < used; i++) {
            sum = rgb_add(sum, list[i].irradiance);
            assert_true(v3_dot(list[i].from, n) > 0.999);
        }
        assert_true(fabsf(sum.g - out.g) < 1e-5f * out.g);
    }
    gather_scratch_free(scratch);
    photon_map_free(map);
}

static void odd_queries(void **state)
{
    (void)state;
    PhotonMap *map = uniform_field(98);
    GatherScratch *scratch = gather_scratch_new();
    GatherLimits limits = GATHER_LIMITS_DEFAULT;
    Rgb out;
    V3 n = v3(0, 0, 1);
    assert_int_equal(photon_gather(map, v3(NAN, 0, 0), n, &limits, scratch, &out), 0);
    assert_int_equal(photon_gather(map, v3(INFINITY, 0, 0), n, &limits, scratch, &out), 0);
    assert_true(rgb_is_black(out));
    photon_gather(map, v3(1e30, 0, 0), n, &limits, scratch, &out);
    assert_true(rgb_is_finite(out));
    limits.max_radius = 0;
    assert_int_equal(photon_gather(map, v3(0.5, 0.5, 0.25), n, &limits, scratch, &out), 0);
    limits.max_radius = NAN;
    assert_int_equal(photon_gather(map, v3(0.5, 0.5, 0.25), n, &limits, scratch, &out), 0);
    limits.max_radius = INFINITY;
    limits.max_photons = 1; /* the one photon sets the radius; nothing is left to count */
    assert_int_equal(photon_gather(map, v3(0.5, 0.5, 0.25), n, &limits, scratch, &out), 0);
    gather_scratch_free(scratch);
    gather_scratch_free(NULL);
    photon_map_free(map);
}

/* Memory that runs out shrinks the radius; the estimate stays near. */
static void scarce_memory_shrinks_the_radius(void **state)
{
    (void)state;
    PhotonMap *map = uniform_field(97);
    GatherScratch *scratch = gather_scratch_new();
    GatherLimits limits = {.max_radius = 0.01, .normal_cosine = -1};
    Rgb out;
    photon_gather(map, v3(0.5, 0.5, 0.25), v3(0, 0, 1), &limits, scratch, &out);
    limits.max_radius = 0.4; /* 50000 photons */
    mem_fail_from(1);
    int used = photon_gather(map, v3(0.5, 0.5, 0.25), v3(0, 0, 1), &limits, scratch, &out);
    mem_fail_from(0);
    assert_true(used > 50 && used < 1000);
    assert_true(fabsf(out.g - 1) < 0.5f);
    gather_scratch_free(scratch);
    mem_fail_from(2);
    scratch = gather_scratch_new();
    used = photon_gather(map, v3(0.5, 0.5, 0.25), v3(0, 0, 1), &limits, scratch, &out);
    mem_fail_from(0);
    assert_int_equal(used, 0);
    assert_true(rgb_is_black(out));
    gather_scratch_free(scratch);
    photon_map_free(map);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(exactly_the_k_nearest),
        cmocka_unit_test(many_equally_far),
        cmocka_unit_test(history_makes_no_difference),
        cmocka_unit_test(kernels_keep_the_light),
        cmocka_unit_test(blur_of_even_light_is_noise),
        cmocka_unit_test(every_estimate_is_unbiased),
        cmocka_unit_test(curvature_makes_no_bias),
        cmocka_unit_test(thin_wall_does_not_leak),
        cmocka_unit_test(corner_does_not_leak),
        cmocka_unit_test(parallel_sheets_do_not_mix),
        cmocka_unit_test(bright_spots_do_not_spill),
        cmocka_unit_test(list_adds_up_to_the_estimate),
        cmocka_unit_test(odd_queries),
        cmocka_unit_test(scarce_memory_shrinks_the_radius),
    };
    return cmocka_run_group_tests_name("gather", tests, NULL, NULL);
}
