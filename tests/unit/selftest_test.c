/* The verdicts of the self-tests: that what is wrong is called wrong.
 * SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "base/rng.h"
#include "selftest/selftest.h"

#include <math.h>

/* --- claims ---------------------------------------------------------------------------------- */

static void sure_claims(void **state)
{
    (void)state;
    const double measured[] = {0.2, 0.2, 0.2};
    Claim claim = claim_of_mean("a", "b", measured, 3, 0.2, 1e-6);
    assert_false(claim_has_chance(&claim));
    assert_true(claim_holds(&claim));
    claim.expected = 0.2001; /* as a wrong closed form would be */
    assert_false(claim_holds(&claim));
    claim.expected = NAN;
    assert_false(claim_holds(&claim));
    Claim none = {.expected = 0, .measured = 0, .limit = 0};
    assert_true(claim_holds(&none));
    none.measured = 1; /* one pixel */
    assert_false(claim_holds(&none));
}

static void claims_of_chance(void **state)
{
    (void)state;
    const double measured[] = {0.99, 1.01, 1, 0.99, 1.01, 1};
    Claim claim = claim_of_mean("a", "b", measured, 6, 1, 1e-4);
    assert_true(claim_has_chance(&claim));
    assert_true(fabs(claim.error - 0.01 * sqrt(4.0 / 5 / 6)) < 1e-12);
    assert_true(claim_holds(&claim));
    claim.expected = 1 + 3.9 * claim.error;
    assert_true(claim_holds(&claim));
    claim.expected = 1 + 4.2 * claim.error;
    assert_false(claim_holds(&claim));
    const double wild[] = {0.5, 1.5, 1};
    Claim blunt = claim_of_mean("a", "b", wild, 3, 1, 1e-4);
    assert_false(claim_holds(&blunt)); /* it would hold whatever were measured */
}

/* --- changes --------------------------------------------------------------------------------- */

enum { SIDE = 32, PICTURES = 4 };

/* A grey picture whose right half is white, with noise of a size. */
static void make_picture(Image *image, float noise, uint64_t seed)
{
    image_init(image, SIDE, SIDE);
    ImageLayer *layer = image_add_layer(image, "", "RGBA");
    assert_non_null(layer);
    Rng rng = rng_at(seed, 1, 1);
    for (size_t i = 0; i < 4 * SIDE * SIDE; i++)
        layer->pixels[i] =
            (i / 4 % SIDE < SIDE / 2 ? 0.2f : 0.9f) + noise * (rng_float(&rng) - 0.5f);
}

typedef struct Fixture {
    Image pictures[PICTURES], moved;
    ChangeBase base;
    Diag diag;
} Fixture;

static void fixture_init(Fixture *f, float noise)
{
    diag_init(&f->diag, NULL, NULL);
    for (int i = 0; i < PICTURES; i++)
        make_picture(&f->pictures[i], noise, (uint64_t)i);
    assert_int_equal(change_base_init(&f->base, f->pictures, PICTURES, &f->diag), OK);
    make_picture(&f->moved, noise, 0);
}

static void fixture_done(Fixture *f)
{
    change_base_done(&f->base);
    for (int i = 0; i < PICTURES; i++)
        image_done(&f->pictures[i]);
    image_done(&f->moved);
    diag_done(&f->diag);
}

static Change find(Fixture *f, bool is_exact)
{
    Change change = {.is_exact = is_exact};
    assert_int_equal(change_find(&f->base, &f->moved, &f->diag, &change), OK);
    return change;
}

static float *pixel(Fixture *f, int x, int y)
{
    return f->moved.layers[0].pixels + 4 * (y * SIDE + x);
}

static void same_bits(void **state)
{
    (void)state;
    Fixture f;
    fixture_init(&f, 0.1f);
    Change change = find(&f, true);
    assert_int_equal(change_kind(&change), CHANGE_NONE);
    pixel(&f, 3, 4)[1] = nextafterf(pixel(&f, 3, 4)[1], 1);
    change = find(&f, true);
    assert_int_equal(change_kind(&change), CHANGE_BITS);
    assert_false(change_is_good(&change));
    assert_true(change.x == 3 && change.y == 4);
    change = find(&f, false);
    assert_int_equal(change_kind(&change), CHANGE_HOLDS);
    fixture_done(&f);
}

static void chance_is_no_change(void **state)
{
    (void)state;
    Fixture f;
    fixture_init(&f, 0.02f);
    image_done(&f.moved);
    make_picture(&f.moved, 0.02f, 77);
    Change change = find(&f, false);
    assert_true(change.rmse > 2e-3 && change.largest > 5e-3);
    assert_true(change_is_good(&change));
    pixel(&f, 5, 6)[0] += 0.1f; /* one bright spot */
    change = find(&f, false);
    assert_int_equal(change.counts.odd, 1);
    assert_int_equal(change_kind(&change), CHANGE_HOLDS);
    pixel(&f, 5, 6)[0] += 0.6f;
    change = find(&f, false);
    assert_int_equal(change_kind(&change), CHANGE_SEEN);
    pixel(&f, 5, 6)[0] -= 0.7f;
    for (int i = 0; i < SIDE * SIDE; i++) /* as much darker as no seed is */
        f.moved.layers[0].pixels[4 * i + 1] -= 0.02f;
    change = find(&f, false);
    assert_int_equal(change.counts.seen, 0);
    assert_int_equal(change_kind(&change), CHANGE_SEEN);
    fixture_done(&f);
}

static void add_spot(Image *image, int x, int y)
{
    for (int v = y; v < y + 3; v++)
        for (int u = x; u < x + 3; u++)
            for (int c = 0; c < 3; c++)
                image->layers[0].pixels[4 * (v * SIDE + u) + c] += 0.05f;
}

/* One seed has a bright spot where the others have none: another may have one elsewhere, but not
 * ten. */
static void rare_spots(void **state)
{
    (void)state;
    Fixture f;
    fixture_init(&f, 0.01f);
    add_spot(&f.moved, 3, 20);
    Change change = find(&f, false);
    assert_true(change.counts.odd > 0.0025 * SIDE * SIDE);
    assert_int_equal(change_kind(&change), CHANGE_SEEN);
    change_base_done(&f.base);
    add_spot(&f.pictures[2], 4, 4);
    assert_int_equal(change_base_init(&f.base, f.pictures, PICTURES, &f.diag), OK);
    assert_true(f.base.chance.odd > 0);
    change = find(&f, false);
    assert_true(change_is_good(&change));
    for (int i = 0; i < 5; i++)
        add_spot(&f.moved, 22, 2 + 5 * i);
    change = find(&f, false);
    assert_int_equal(change_kind(&change), CHANGE_SEEN);
    fixture_done(&f);
}

/* A change is in pictures of all seeds, a spot of chance in one. */
static void seen_again(void **state)
{
    (void)state;
    Fixture f;
    Image again;
    fixture_init(&f, 0.01f);
    make_picture(&again, 0.01f, 99);
    for (int i = 0; i < 9; i++)
        add_spot(&f.moved, 3, 2 + 3 * i);
    add_spot(&again, 20, 2);
    Change change = find(&f, false);
    assert_int_equal(change_kind(&change), CHANGE_SEEN);
    change_keep_less(&f.base, &f.moved, &again);
    change = find(&f, false);
    assert_int_equal(change_kind(&change), CHANGE_HOLDS);
    for (int i = 0; i < 9; i++) {
        add_spot(&f.moved, 3, 2 + 3 * i);
        add_spot(&again, 3, 2 + 3 * i);
    }
    change_keep_less(&f.base, &f.moved, &again);
    change = find(&f, false);
    assert_int_equal(change_kind(&change), CHANGE_SEEN);
    image_done(&again);
    fixture_done(&f);
}

static void without_chance_all_is_seen(void **state)
{
    (void)state;
    Fixture f;
    fixture_init(&f, 0);
    pixel(&f, 3, 4)[1] += 0.05f;
    Change change = find(&f, false);
    assert_int_equal(change.counts.seen, 1);
    assert_int_equal(change.counts.edges, 0);
    assert_int_equal(change.x, 3);
    assert_int_equal(change.y, 4);
    assert_int_equal(change_kind(&change), CHANGE_SEEN);
    pixel(&f, 3, 4)[1] = NAN;
    change = find(&f, false);
    assert_int_equal(change_kind(&change), CHANGE_SEEN);
    fixture_done(&f);
}

static void edges_may_move_a_little(void **state)
{
    (void)state;
    Fixture f;
    fixture_init(&f, 0);
    for (int c = 0; c < 3; c++)
        pixel(&f, SIDE / 2, 5)[c] = 0.2f; /* as its left neighbour */
    Change change = find(&f, false);
    assert_int_equal(change.counts.edges, 1);
    assert_int_equal(change_kind(&change), CHANGE_EDGES);
    assert_true(change_is_good(&change));
    for (int y = 0; y < SIDE; y++) /* the whole edge is another one */
        for (int c = 0; c < 3; c++)
            pixel(&f, SIDE / 2, y)[c] = 0.2f;
    change = find(&f, false);
    assert_int_equal(change_kind(&change), CHANGE_SEEN);
    fixture_done(&f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sure_claims),
        cmocka_unit_test(claims_of_chance),
        cmocka_unit_test(same_bits),
        cmocka_unit_test(chance_is_no_change),
        cmocka_unit_test(rare_spots),
        cmocka_unit_test(seen_again),
        cmocka_unit_test(without_chance_all_is_seen),
        cmocka_unit_test(edges_may_move_a_little),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
