/* What becomes of a photon at a surface: the odds of each branch and the power it goes on with.
 *
 * In the middle of a ball every photon starts with the same power, FLUX / n, and meets the wall
 * head on, so counts and powers can be told exactly.  With max_trace_level 1 a photon stops after
 * its first throw of the dice, with 2 it is stored at its next surface and stops there.
 * SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "lit_scene.h"

enum { PHOTONS = 16384 };

/* A lamp that fades by the inverse square, so that mirrors on the way do not change its flux in
 * the language's units: 4 pi 2 c / (1 + 1/f^2) with c = 5000, f = 1/100. */
#define LAMP "light_source { 0 rgb 5000 fade_distance 0.01 fade_power 2 }\n"
#define FLUX (4 * PMS_PI * 10000 / 10001)

/* The stratified first throw hits an interval of the unit line as often as its length says, but
 * for a few photons at its ends; independent throws would miss by sqrt(n p (1-p)), up to 64. */
#define MISSES 8

typedef struct Wall {
    double d[3], s[3]; /* diffuse and specular reflectance */
} Wall;

static const Wall walls[] = {
    {{0.5, 0.5, 0.5}, {0, 0, 0}},       {{0.6, 0.3, 0.1}, {0, 0, 0}},
    {{0.3, 0.3, 0.3}, {0.4, 0.4, 0.4}}, {{0.2, 0.4, 0.1}, {0.3, 0.1, 0.5}},
    {{0.7, 0, 0}, {0, 0, 0.6}},         {{0.1, 0.1, 0.1}, {0.9, 0.8, 0.7}},
    {{0.8, 0.8, 0.8}, {0.8, 0.8, 0.8}}, {{0.05, 0.9, 0.2}, {0.02, 0.01, 0.03}},
    {{0.3, 0.02, 0.02}, {0, 0, 0}},
};
enum { WALLS = sizeof walls / sizeof walls[0] };

/* The rule, from its text: P_r is the largest channel of d + s, at most 1; it is shared between
 * the branches in proportion to their sums. */
static void odds(const Wall *w, double *diffuse, double *specular)
{
    double sum_d = w->d[0] + w->d[1] + w->d[2], sum_s = w->s[0] + w->s[1] + w->s[2], most = 0;
    for (int c = 0; c < 3; c++)
        most = fmax(most, w->d[c] + w->s[c]);
    most = fmin(1, most);
    *diffuse = sum_d / (sum_d + sum_s) * most;
    *specular = most - *diffuse;
}

static void make_ball(LitScene *lit, const Wall *w, int level, int photons)
{
    char text[1024];
    snprintf(text, sizeof text,
             "global_settings { assumed_gamma 1 max_trace_level %d adc_bailout 1e-5\n"
             "  pms { gi on gi_method map global_photons %d } }\n" LAMP
             "sphere { 0, 1 hollow pigment { rgb <%g,%g,%g> }\n"
             "  finish { ambient 0 diffuse 1 reflection <%g,%g,%g> } }\n",
             level, photons, w->d[0], w->d[1], w->d[2], w->s[0], w->s[1], w->s[2]);
    lit_read(lit, text, 2, 11);
    lit->scene->settings.radiosity.recursion_limit = level; /* of diffuse reflections */
    assert_int_equal(photon_pass(lit->tracer, &lit->options, &lit->diag, &lit->stats, &lit->maps),
                     OK);
}

/* Row S5: the share that is absorbed is 1 - P_r, that of the diffuse branch P_D; both to within a
 * few photons of n, so one stratified number decides. */
static void shares_of_the_branches(void **state)
{
    (void)state;
    for (int i = 0; i < WALLS; i++) {
        double p_diffuse, p_specular;
        odds(&walls[i], &p_diffuse, &p_specular);
        LitScene lit;
        make_ball(&lit, &walls[i], 1, PHOTONS);
        const LightBooks *books = &lit.maps.books.global[0];
        assert_int_equal(books->emitted, PHOTONS);
        double absorbed = (1 - p_diffuse - p_specular) * PHOTONS;
        assert_true(fabs((double)books->absorbed - absorbed) < MISSES);
        assert_int_equal(books->absorbed + books->cut, PHOTONS);
        lit_done(&lit);
        make_ball(&lit, &walls[i], 2, PHOTONS);
        double stored = (double)lit.maps.books.global[0].stored_paths;
        print_message("# wall %d: absorbed %.0f, diffuse %.0f of %.1f\n", i, absorbed, stored,
                      p_diffuse * PHOTONS);
        assert_true(fabs(stored - p_diffuse * PHOTONS) < MISSES);
        lit_done(&lit);
    }
}

/* One step of the stored power's brightest channel, and what single floats lose. */
static double rgbe_step(const double power[3])
{
    return fmax(power[0], fmax(power[1], power[2])) / 127;
}

/* Row S5: a photon of the diffuse branch goes on with P_inc d / P_D, channel by channel. */
static void power_of_the_diffuse_branch(void **state)
{
    (void)state;
    for (int i = 0; i < WALLS; i++) {
        double p_diffuse, p_specular, expected[3], sum[3] = {0};
        odds(&walls[i], &p_diffuse, &p_specular);
        for (int c = 0; c < 3; c++)
            expected[c] = FLUX / PHOTONS * walls[i].d[c] / p_diffuse;
        LitScene lit;
        make_ball(&lit, &walls[i], 2, PHOTONS);
        double step = rgbe_step(expected), count = 0;
        for (size_t k = 0; k < photon_map_count(lit.maps.global); k++) {
            Rgb power = lit_photon_power(lit.maps.global, k);
            double channel[3] = {(double)power.r, (double)power.g, (double)power.b};
            bool is_such = true; /* others were mirrored once more after it */
            for (int c = 0; c < 3; c++)
                is_such = is_such && fabs(channel[c] - expected[c]) <= step;
            count += is_such;
            for (int c = 0; c < 3 && is_such; c++)
                sum[c] += channel[c];
        }
        assert_true(count > p_diffuse * PHOTONS - MISSES);
        /* Rounding to steps has a standard deviation of half a step at most. */
        for (int c = 0; c < 3; c++)
            assert_true(fabs(sum[c] / count - expected[c]) < 4 * step / 2 / sqrt(count));
        lit_done(&lit);
    }
}

/* A parallel beam straight down on the top of a target, and a ceiling above the light for what it
 * mirrors.  `inner` gets the photons well inside the image of the target: they have the power of
 * a full cell, all alike. */
typedef struct Inner {
    double count, sum[3], least[3], most[3];
} Inner;

static void mirror_up(const Wall *w, Inner *inner)
{
    char text[1024];
    snprintf(text, sizeof text,
             "global_settings { assumed_gamma 1 photons { count 60000 } }\n"
             "light_source { <0,9,0> rgb 1 parallel point_at 0 }\n"
             "box { <-4,9.5,-4>, <4,10,4> pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
             "box { <-1,-1,-1>, <1,0,1> pigment { rgb <%g,%g,%g> } finish { ambient 0 diffuse 1\n"
             "  reflection <%g,%g,%g> } photons { target reflection on collect off } }\n",
             w->d[0], w->d[1], w->d[2], w->s[0], w->s[1], w->s[2]);
    LitScene lit;
    lit_make(&lit, text, 2, 5);
    *inner = (Inner){.least = {INFINITY, INFINITY, INFINITY}};
    for (size_t k = 0; k < photon_map_count(lit.maps.caustic); k++) {
        V3 p = lit_photon_place(lit.maps.caustic, k);
        Rgb power = lit_photon_power(lit.maps.caustic, k);
        double channel[3] = {(double)power.r, (double)power.g, (double)power.b};
        assert_true(p.y > 9);
        if (fabs(p.x) > 0.8 || fabs(p.z) > 0.8)
            continue;
        inner->count++;
        for (int c = 0; c < 3; c++) {
            inner->sum[c] += channel[c];
            inner->least[c] = fmin(inner->least[c], channel[c]);
            inner->most[c] = fmax(inner->most[c], channel[c]);
        }
    }
    lit_done(&lit);
}

/* Row S5: the specular branch is taken by P_S of the photons and goes on with P_inc s / P_S; both
 * against a perfect mirror, which all photons leave as they came. */
static void share_and_power_of_the_specular_branch(void **state)
{
    (void)state;
    const Wall perfect = {{0, 0, 0}, {1, 1, 1}};
    Inner all;
    mirror_up(&perfect, &all);
    double incoming = all.sum[1] / all.count;
    assert_true(all.most[1] / all.least[1] < 1 + 1.01 / 128);
    for (int i = 0; i < WALLS; i++) {
        double p_diffuse, p_specular, expected[3];
        odds(&walls[i], &p_diffuse, &p_specular);
        if (p_specular == 0)
            continue;
        for (int c = 0; c < 3; c++)
            expected[c] = incoming * walls[i].s[c] / p_specular;
        Inner got;
        mirror_up(&walls[i], &got);
        double error = sqrt(all.count * p_specular * (1 - p_specular)), step = rgbe_step(expected);
        print_message("# wall %d: specular %.0f of %.0f\n", i, got.count, all.count * p_specular);
        assert_true(fabs(got.count - all.count * p_specular) < 4 * error + 1);
        for (int c = 0; c < 3; c++) {
            assert_true(got.least[c] >= expected[c] - step && got.most[c] <= expected[c] + step);
            double mean = got.sum[c] / got.count, spread = step / 2 / sqrt(got.count);
            assert_true(fabs(mean - expected[c]) < 4 * spread + 1e-4 * expected[c]);
        }
    }
}

/* Row S5: power is kept in the mean over paths of any length.  Per channel, light that came over
 * mirrors alone is 1 + s + s^2 ... of the direct light; d of it starts the indirect light, of which
 * each surface keeps d + s: d / ((1-s)(1-d-s)) in all.
 *
 * The longest paths decide the error: photons a path K, power the same; the variance of the sum
 * is at most n p^2 E[K^2], here by (1+r)/(1-r) of n p^2 E[K] with r the largest d + s. */
static void power_is_kept_over_many_bounces(void **state)
{
    (void)state;
    const Wall rooms[] = {{{0.5, 0.3, 0.7}, {0, 0, 0}},
                          {{0.4, 0.2, 0.1}, {0.3, 0.3, 0.3}},
                          {{0.2, 0.5, 0.3}, {0.5, 0.1, 0.2}}};
    for (size_t i = 0; i < sizeof rooms / sizeof rooms[0]; i++) {
        LitScene lit;
        make_ball(&lit, &rooms[i], 200, 200000);
        double sum[3] = {0}, square[3] = {0}, r = 0;
        for (size_t k = 0; k < photon_map_count(lit.maps.global); k++) {
            Rgb power = lit_photon_power(lit.maps.global, k);
            double channel[3] = {(double)power.r, (double)power.g, (double)power.b};
            for (int c = 0; c < 3; c++) {
                sum[c] += channel[c];
                square[c] += channel[c] * channel[c];
            }
        }
        for (int c = 0; c < 3; c++)
            r = fmax(r, rooms[i].d[c] + rooms[i].s[c]);
        for (int c = 0; c < 3; c++) {
            double d = rooms[i].d[c], s = rooms[i].s[c];
            double expected = FLUX * d / ((1 - s) * (1 - d - s));
            double error = sqrt(square[c] * (1 + r) / (1 - r));
            print_message("# room %zu channel %d: %.4f of it (+- %.4f)\n", i, c, sum[c] / expected,
                          4 * error / expected);
            assert_true(fabs(sum[c] - expected) < 4 * error);
        }
        lit_done(&lit);
    }
}

/* Row S5: black surfaces absorb everything and divide nothing by zero, also those that are met
 * later: a room with one white wall. */
static void black_surfaces_absorb(void **state)
{
    (void)state;
    LitScene lit;
    const Wall black = {{0, 0, 0}, {0, 0, 0}};
    make_ball(&lit, &black, 200, PHOTONS);
    assert_null(lit.maps.global);
    assert_int_equal(lit.maps.books.global[0].emitted, 0); /* the pilot finds nothing to light */
    lit_done(&lit);
    lit_make(&lit,
             "global_settings { assumed_gamma 1 max_trace_level 20\n"
             "  pms { gi on gi_method map global_photons 20000 } }\n"
             "light_source { <0,1,0> rgb 1 }\n"
             "box { <-2,-0.1,-2>, <2,0,2> pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
             "box { <-2,-2,-2>, <2,4,2> hollow pigment { rgb 0 } finish { ambient 0 diffuse 1\n"
             "  reflection 0 } }\n",
             2, 1);
    const LightBooks *books = &lit.maps.books.global[0];
    assert_null(lit.maps.global); /* the floor alone cannot light itself */
    assert_int_equal(books->emitted, 20000);
    assert_int_equal(books->absorbed, 20000);
    Rgb sum = books->flux_absorbed;
    assert_true(rgb_is_finite(sum) && rgb_is_finite(books->flux_emitted));
    assert_true(fabsf(sum.g / books->flux_emitted.g - 1) < 1e-5f);
    lit_done(&lit);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shares_of_the_branches),
        cmocka_unit_test(power_of_the_diffuse_branch),
        cmocka_unit_test(share_and_power_of_the_specular_branch),
        cmocka_unit_test(power_is_kept_over_many_bounces),
        cmocka_unit_test(black_surfaces_absorb),
    };
    return cmocka_run_group_tests_name("roulette", tests, NULL, NULL);
}
