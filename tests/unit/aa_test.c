/* Antialiasing methods on pictures known in closed form.  The averages of method 1 and 2 at an
 * edge, and the number of samples, are POV-Ray's.  SPDX-License-Identifier: Apache-2.0 */
#include "render/aa.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

/* A picture that is dark left of x = edge and bright from there on. */
typedef struct Picture {
    double edge;
    float dark, bright;
    int samples;
    bool is_broken; /* every second sample is unusable */
} Picture;

enum { CHANNELS = 5, Z = 4 };

static bool sample_edge(void *ctx, double x, double y, uint32_t pixel, uint32_t index, float *out)
{
    (void)y, (void)pixel;
    Picture *picture = ctx;
    picture->samples++;
    float v = x < picture->edge ? picture->dark : picture->bright;
    out[0] = out[1] = out[2] = v;
    out[3] = 1;
    out[Z] = x < picture->edge ? INFINITY : 3;
    if (!picture->is_broken || index % 2 == 0)
        return true;
    memset(out, 0, CHANNELS * sizeof *out);
    return false;
}

static Aa aa_for(int width, int height, int depth)
{
    return (Aa){.width = width,
                .height = height,
                .channels = CHANNELS,
                .z_channel = Z,
                .threshold = 0.3,
                .depth = depth,
                .power = 0.4f};
}

/* Red of pixel x of the top row after a method has run on one 8x8 block. */
static float run(AaMethod method, int depth, Picture *picture, int x)
{
    Aa aa = aa_for(8, 8, depth);
    AaScratch scratch;
    assert_int_equal(aa_scratch_init(&scratch, &aa, method, NULL), OK);
    FilmRect rect = {0, 0, 8, 8};
    if (method == AA_POV2) {
        aa_corners(&aa, rect, sample_edge, picture, &scratch);
    } else {
        aa_centers(&aa, rect, sample_edge, picture, scratch.block);
        aa_refine(&aa, rect, NULL, NULL, sample_edge, picture, &scratch);
    }
    float red = scratch.block[x * CHANNELS];
    aa_scratch_done(&scratch);
    return red;
}

static void method_1_keeps_the_centre_sample(void **state)
{
    (void)state;
    const double want[] = {0, 0, 0.6, 0.7, 0.76471};
    for (int depth = 2; depth <= 4; depth++) {
        Picture picture = {3.3, 0, 1, 0, false};
        float got = run(AA_POV1, depth, &picture, 3);
        assert_true(fabs((double)got - want[depth]) < 1e-5);
        /* In each of 8 rows the edge pixel, the one before it, and the one after it, which
         * differs from the average that the edge pixel has become. */
        assert_int_equal(picture.samples, 64 + 8 * 3 * depth * depth);
    }
}

static void method_1_refines_from_the_threshold_on(void **state)
{
    (void)state;
    double step = pow(0.1, 2.5); /* three channels of 0.1 make the threshold */
    Picture below = {4, 0, (float)(step * 0.99), 0, false};
    run(AA_POV1, 3, &below, 4);
    assert_int_equal(below.samples, 64);
    Picture over = {4, 0, (float)(step * 1.01), 0, false};
    run(AA_POV1, 3, &over, 4);
    assert_int_equal(over.samples, 64 + 8 * 2 * 9);
}

static void method_1_only_looks_at_other_blocks(void **state)
{
    (void)state;
    Aa aa = aa_for(16, 8, 3);
    AaScratch scratch;
    assert_int_equal(aa_scratch_init(&scratch, &aa, AA_POV1, NULL), OK);
    Picture picture = {8, 0, 1, 0, false};
    FilmRect rect = {8, 0, 16, 8};
    aa_centers(&aa, rect, sample_edge, &picture, scratch.block);
    AaKey left[8] = {0};
    for (int i = 0; i < 8; i++)
        left[i].v[3] = 1;
    aa_refine(&aa, rect, NULL, left, sample_edge, &picture, &scratch);
    assert_int_equal(picture.samples, 64 + 8 * 9); /* the left column of this block alone */
    aa_scratch_done(&scratch);
}

static void method_2_quarters_where_corners_differ(void **state)
{
    (void)state;
    const double want[] = {0, 0.5, 0.75, 0.625, 0.6875};
    const int extra[] = {0, 0, 40, 112, 248};
    for (int depth = 1; depth <= 4; depth++) {
        Picture picture = {3.3, 0, 1, 0, false};
        float got = run(AA_POV2, depth, &picture, 3);
        assert_true(fabs((double)got - want[depth]) < 1e-6);
        assert_int_equal(picture.samples, 81 + extra[depth]);
    }
}

static void jitter_stays_within_its_cell(void **state)
{
    (void)state;
    Picture picture = {3.3, 0, 1, 0, false};
    Aa aa = aa_for(8, 8, 3);
    aa.jitter = 1;
    AaScratch scratch;
    assert_int_equal(aa_scratch_init(&scratch, &aa, AA_POV1, NULL), OK);
    FilmRect rect = {0, 0, 8, 8};
    aa_centers(&aa, rect, sample_edge, &picture, scratch.block);
    aa_refine(&aa, rect, NULL, NULL, sample_edge, &picture, &scratch);
    /* The edge is at 0.3 of the pixel: the left third of the samples may be on either side,
     * the others are bright with any jitter of at most a cell. */
    float red = scratch.block[3 * CHANNELS];
    assert_true(red >= 0.7f - 1e-6f && red <= 1);
    aa_scratch_done(&scratch);
}

static void uniform_samples_average_to_the_area(void **state)
{
    (void)state;
    Picture picture = {3.3, 0, 1, 0, false};
    Aa aa = aa_for(8, 8, 3);
    float out[8 * CHANNELS];
    aa_uniform(&aa, (FilmRect){0, 0, 8, 1}, 64, false, sample_edge, &picture, out);
    assert_int_equal(picture.samples, 8 * 64);
    /* 64 points of a net are stratified in 64 columns: the error is below one of them. */
    assert_true(fabs((double)out[3 * CHANNELS] - 0.7) <= 1.0 / 64);
    assert_true(out[2 * CHANNELS] == 0 && out[4 * CHANNELS] == 1);
}

static void depth_is_the_nearest_not_the_mean(void **state)
{
    (void)state;
    Picture picture = {3.3, 0, 1, 0, false};
    Aa aa = aa_for(8, 8, 3);
    float out[8 * CHANNELS];
    aa_uniform(&aa, (FilmRect){0, 0, 8, 1}, 16, false, sample_edge, &picture, out);
    assert_true(isinf(out[2 * CHANNELS + Z]));
    assert_true(out[3 * CHANNELS + Z] == 3);
}

static void unusable_samples_are_left_out(void **state)
{
    (void)state;
    Picture picture = {0, 0, 1, 0, true};
    Aa aa = aa_for(8, 8, 3);
    float out[8 * CHANNELS];
    aa_uniform(&aa, (FilmRect){0, 0, 8, 1}, 16, false, sample_edge, &picture, out);
    assert_true(out[0] == 1);
    assert_true(fabs((double)run(AA_POV1, 3, &picture, 0) - 1) < 1e-6);
}

static void negative_light_compares_as_black(void **state)
{
    (void)state;
    Aa aa = aa_for(8, 8, 3);
    float vector[CHANNELS] = {-1, 0, 1, 0.5f, 0};
    AaKey key = aa_key(&aa, vector);
    assert_true(key.v[0] == 0 && key.v[1] == 0 && key.v[2] == 1 && key.v[3] == 0.5f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(method_1_keeps_the_centre_sample),
        cmocka_unit_test(method_1_refines_from_the_threshold_on),
        cmocka_unit_test(method_1_only_looks_at_other_blocks),
        cmocka_unit_test(method_2_quarters_where_corners_differ),
        cmocka_unit_test(jitter_stays_within_its_cell),
        cmocka_unit_test(uniform_samples_average_to_the_area),
        cmocka_unit_test(depth_is_the_nearest_not_the_mean),
        cmocka_unit_test(unusable_samples_are_left_out),
        cmocka_unit_test(negative_light_compares_as_black),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
