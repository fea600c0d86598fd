/* Sharing photons among lights.  SPDX-License-Identifier: Apache-2.0 */
#include "photon/photon_pass.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

/* Row S4: the deck's table.  Powers 9 and 1, 100 photons: 90 and 10.  Row S3: each of power 0.1. */
static void the_decks_table(void **state)
{
    (void)state;
    const double power[2] = {9, 1};
    uint64_t share[2];
    photon_budget(power, 2, 100, share);
    assert_int_equal(share[0], 90);
    assert_int_equal(share[1], 10);
    for (int i = 0; i < 2; i++)
        assert_true(fabs(power[i] / (double)share[i] - 0.1) < 1e-12);
}

static uint64_t sum_of(const uint64_t *shares, int count)
{
    uint64_t sum = 0;
    for (int i = 0; i < count; i++)
        sum += shares[i];
    return sum;
}

/* Row S4: shares add up exactly and are within one of the exact share. */
static void shares_add_up(void **state)
{
    (void)state;
    for (int trial = 0; trial < 2000; trial++) {
        Rng rng = rng_at(1, 0, (uint64_t)trial);
        int count = 1 + (int)(rng_u32(&rng) % 40);
        uint64_t total = rng_u32(&rng) % (trial % 2 ? 100u : 4000000000u), share[40];
        double weight[40], sum = 0;
        for (int i = 0; i < count; i++) {
            weight[i] = rng_u32(&rng) % 4 ? pow(rng_double(&rng), 6) : 0;
            sum += weight[i];
        }
        photon_budget(weight, count, total, share);
        assert_true(sum_of(share, count) == (sum > 0 ? total : 0));
        for (int i = 0; i < count && sum > 0; i++) {
            double exact = weight[i] / sum * (double)total;
            assert_true(fabs((double)share[i] - exact) < 1 + 1e-9 * (double)total);
            if (weight[i] == 0)
                assert_true(share[i] == 0);
        }
    }
}

static void the_largest_remainders_are_rounded_up(void **state)
{
    (void)state;
    const double weight[4] = {47000, 16000, 15800, 12000};
    uint64_t share[4]; /* exact: 5.176 1.762 1.740 1.322 */
    photon_budget(weight, 4, 10, share);
    assert_int_equal(share[0], 5);
    assert_int_equal(share[1], 2);
    assert_int_equal(share[2], 2);
    assert_int_equal(share[3], 1);
    const double equal[3] = {1, 1, 1};
    photon_budget(equal, 3, 10, share);
    assert_int_equal(share[0], 4);
    assert_int_equal(share[1], 3);
    assert_int_equal(share[2], 3);
}

/* Row S4: a light of no power gets no photon. */
static void lights_without_power_get_none(void **state)
{
    (void)state;
    const double weight[5] = {0, 1, -1, NAN, 0};
    uint64_t share[5];
    photon_budget(weight, 5, 1000, share);
    for (int i = 0; i < 5; i++)
        assert_int_equal(share[i], i == 1 ? 1000 : 0);
    const double none[2] = {0, -0.0};
    photon_budget(none, 2, 1000, share);
    assert_int_equal(share[0], 0);
    assert_int_equal(share[1], 0);
    photon_budget(none, 0, 1000, share);
    const double few[3] = {1, 1, 1};
    photon_budget(few, 3, 0, share);
    assert_int_equal(sum_of(share, 3), 0);
}

static void extreme_weights(void **state)
{
    (void)state;
    const double huge[3] = {1e308, 1e308, 1e308};
    uint64_t share[3];
    photon_budget(huge, 3, 300, share);
    for (int i = 0; i < 3; i++)
        assert_int_equal(share[i], 100);
    const double tiny[3] = {5e-324, 5e-324, 0};
    photon_budget(tiny, 3, 300, share);
    assert_int_equal(share[0], 150);
    assert_int_equal(share[1], 150);
    const double spread[2] = {1e300, 1e-300};
    photon_budget(spread, 2, 1000000, share);
    assert_int_equal(share[0], 1000000);
    assert_int_equal(share[1], 0);
    const double infinite[2] = {INFINITY, 1};
    photon_budget(infinite, 2, 10, share);
    assert_int_equal(sum_of(share, 2), 10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_decks_table),
        cmocka_unit_test(shares_add_up),
        cmocka_unit_test(the_largest_remainders_are_rounded_up),
        cmocka_unit_test(lights_without_power_get_none),
        cmocka_unit_test(extreme_weights),
    };
    return cmocka_run_group_tests_name("budget", tests, NULL, NULL);
}
