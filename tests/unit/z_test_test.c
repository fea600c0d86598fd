/* Whether two noisy pictures show the same.  SPDX-License-Identifier: Apache-2.0 */
#include "base/rng.h"
#include "image/z_test.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

#include "quiet.h"

enum { WIDTH = 40, HEIGHT = 25, PIXELS = WIDTH * HEIGHT };

/* Make a grey picture with noise in its layer; `noise` NULL: none. */
static Image make(int width, int height, const float *values, const float *noise)
{
    Image image;
    image_init(&image, width, height);
    ImageLayer *beauty = image_add_layer(&image, "", "Y");
    assert_non_null(beauty);
    memcpy(beauty->pixels, values, (size_t)(width * height) * sizeof *values);
    if (noise) {
        ImageLayer *layer = image_add_layer(&image, "error.noise", "Y");
        assert_non_null(layer);
        memcpy(layer->pixels, noise, (size_t)(width * height) * sizeof *noise);
    }
    return image;
}

static ZTest test(const Image *a, const Image *b)
{
    ZTest z;
    assert_int_equal(z_test(quiet(), a, b, &z), OK);
    return z;
}

/* A value of the normal distribution: its own for every index. */
static double normal(uint64_t index)
{
    Rng rng = rng_at(7, 0, index);
    double radius = sqrt(-2 * log(1 - rng_double(&rng)));
    return radius * cos(6.283185307179586 * rng_double(&rng));
}

static void fill(float *values, float value)
{
    for (int i = 0; i < PIXELS; i++)
        values[i] = value;
}

/* Test pictures of 1, with noise of that much, that differ by `shift` in every `step`-th pixel. */
static ZTest test_shifted(double shift, int step)
{
    float a[PIXELS], b[PIXELS], noise[PIXELS];
    fill(noise, 0.1f);
    for (int i = 0; i < PIXELS; i++) {
        a[i] = (float)(1 + 0.1 * normal((uint64_t)(2 * i)));
        b[i] = (float)(1 + 0.1 * normal((uint64_t)(2 * i + 1)) + (i % step == 0 ? shift : 0));
    }
    Image image_a = make(WIDTH, HEIGHT, a, noise), image_b = make(WIDTH, HEIGHT, b, noise);
    ZTest z = test(&image_a, &image_b);
    image_done(&image_a);
    image_done(&image_b);
    return z;
}

/* Student's t for nine degrees of freedom, from tables; the last by numerical integration. */
static void quantiles_are_those_of_the_tables(void **state)
{
    (void)state;
    static const double known[][2] = {{0.5, 0.702722},
                                      {0.05, 2.262157},
                                      {0.01, 3.249836},
                                      {0.001, 4.780913},
                                      {5.23e-7, 12.55611}};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        assert_true(fabs(z_test_quantile(known[i][0]) - known[i][1]) < 2e-5);
        assert_true(fabs(z_test_p_value(known[i][1]) / known[i][0] - 1) < 1e-5);
    }
    assert_true(fabs(z_test_p_value(0) - 1) < 1e-15);
}

static void the_level_is_shared_among_the_pixels(void **state)
{
    (void)state;
    assert_true(fabs(z_test_sidak(0.01, 1) - 0.01) < 1e-15);
    for (size_t count = 10; count < 10000000; count *= 10) {
        double level = z_test_sidak(0.01, count);
        assert_true(fabs(-expm1((double)count * log1p(-level)) - 0.01) < 1e-12);
    }
}

/* Pictures of one pixel whose standard error is itself an estimate from nine values: 99 % pass. */
static void noise_passes_99_percent_of_the_time(void **state)
{
    (void)state;
    enum { TRIALS = 20000 };
    int passed = 0;
    for (int i = 0; i < TRIALS; i++) {
        double square = 0;
        for (int k = 1; k < 10; k++)
            square += pow(normal((uint64_t)(10 * i + k)), 2) / 9;
        float value = (float)(1 + 0.1 * normal((uint64_t)(10 * i))), exact = 1;
        float noise = (float)(0.1 * sqrt(square));
        Image a = make(1, 1, &value, &noise), b = make(1, 1, &exact, NULL);
        ZTest z = test(&a, &b);
        assert_true(z.is_exact_b && !z.is_exact_a);
        passed += z.passes ? 1 : 0;
        image_done(&a);
        image_done(&b);
    }
    double part = (double)passed / TRIALS, error = sqrt(0.99 * 0.01 / TRIALS);
    assert_true(fabs(part - 0.99) < 4 * error);
}

static void equal_means_pass_and_a_shifted_one_fails(void **state)
{
    (void)state;
    ZTest z = test_shifted(0, 1);
    assert_true(z.passes && z.accepted == PIXELS && z.worst < 6);
    z = test_shifted(3, 1);
    assert_true(!z.passes && z.share < 0.01 && z.worst > 15);
    z = test_shifted(3, 250); /* 4 of 1000 */
    assert_true(!z.passes && z.accepted == PIXELS - 4);
    z = test_shifted(3, 500); /* 2 of 1000 are those let pass */
    assert_true(z.passes && z.accepted == PIXELS - 2);
}

static void without_noise_only_equal_pixels_accept(void **state)
{
    (void)state;
    float a[PIXELS], b[PIXELS], noise[PIXELS];
    fill(a, 0.5f);
    fill(b, 0.5f);
    fill(noise, 0);
    b[3] = 0.5f * (1 + 2e-7f); /* rounding */
    Image image_a = make(WIDTH, HEIGHT, a, noise), image_b = make(WIDTH, HEIGHT, b, noise);
    ZTest z = test(&image_a, &image_b);
    assert_true(z.passes && z.accepted == PIXELS && z.worst == 0);
    image_b.layers[0].pixels[2 * WIDTH + 5] = 0.5001f;
    z = test(&image_a, &image_b);
    assert_true(z.accepted == PIXELS - 1 && isinf(z.worst) && z.bad == 0);
    assert_true(z.worst_x == 5 && z.worst_y == 2);
    image_done(&image_a);
    image_done(&image_b);
}

static void what_is_no_number_rejects(void **state)
{
    (void)state;
    float values[PIXELS], noise[PIXELS];
    fill(values, 0.5f);
    fill(noise, 0.1f);
    values[0] = NAN;
    values[1] = INFINITY;
    noise[2] = NAN;
    noise[3] = INFINITY;
    Image a = make(WIDTH, HEIGHT, values, noise), b = make(WIDTH, HEIGHT, values, noise);
    ZTest z = test(&a, &b);
    assert_true(z.bad == 4 && z.accepted == PIXELS - 4 && isinf(z.worst) && !z.passes);
    image_done(&a);
    image_done(&b);
}

static void bias_is_allowed_for(void **state)
{
    (void)state;
    float values[PIXELS], noise[PIXELS];
    fill(values, 1);
    fill(noise, 0.01f);
    Image a = make(WIDTH, HEIGHT, values, noise);
    fill(values, 1.5f);
    Image b = make(WIDTH, HEIGHT, values, noise);
    ZTest z = test(&a, &b);
    assert_true(!z.passes && !z.has_bias);
    assert_true(fabs(z.worst - 0.5 / (0.01 * sqrt(2))) < 1e-3);
    ImageLayer *bias = image_add_layer(&b, "error.bias", "Y");
    assert_non_null(bias);
    fill(bias->pixels, 0.48f);
    z = test(&a, &b);
    assert_true(z.passes && z.has_bias);
    assert_true(fabs(z.worst - 0.02 / (0.01 * sqrt(2))) < 1e-3);
    image_done(&a);
    image_done(&b);
}

static void assert_refused(const Image *a, const Image *b, const char *words)
{
    ZTest z;
    assert_int_equal(z_test(quiet(), a, b, &z), ERR_USAGE);
    assert_non_null(strstr(last_message, words));
}

static void what_cannot_be_tested_is_refused(void **state)
{
    (void)state;
    float values[PIXELS];
    fill(values, 1);
    Image plain = make(WIDTH, HEIGHT, values, NULL), noisy = make(WIDTH, HEIGHT, values, values);
    Image turned = make(HEIGHT, WIDTH, values, values);
    assert_refused(&plain, &plain, "--layers error.noise");
    assert_refused(&noisy, &turned, "differ in size");
    plain.is_display = true;
    assert_refused(&noisy, &plain, "PNG");
    assert_refused(&plain, &noisy, "PNG");
    image_done(&plain);
    image_done(&noisy);
    image_done(&turned);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(quantiles_are_those_of_the_tables),
        cmocka_unit_test(the_level_is_shared_among_the_pixels),
        cmocka_unit_test(noise_passes_99_percent_of_the_time),
        cmocka_unit_test(equal_means_pass_and_a_shifted_one_fails),
        cmocka_unit_test(without_noise_only_equal_pixels_accept),
        cmocka_unit_test(what_is_no_number_rejects),
        cmocka_unit_test(bias_is_allowed_for),
        cmocka_unit_test(what_cannot_be_tested_is_refused),
    };
    return cmocka_run_group_tests_name("z_test", tests, NULL, NULL);
}
