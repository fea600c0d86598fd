/* The codecs of the 20-byte photon: bias of RGBE, errors of directions and normals.
 * SPDX-License-Identifier: Apache-2.0 */
#include "photon/photon.h"

#include <float.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

static Rgb round_trip(Rgb power, Rng *rng)
{
    uint8_t code[4];
    rgbe_encode(power, rng, code);
    return rgbe_decode(code);
}

/* Row S7: the stored photon is 20 bytes: three floats of position, four bytes of power, two of
 * direction, two of flags, and nothing between them. */
static void photon_is_20_bytes(void **state)
{
    (void)state;
    static_assert(sizeof(Photon) == 20, "20 bytes");
    static_assert(sizeof((Photon){0}.pos) == 12 && sizeof((Photon){0}.pos[0]) == 4, "3 floats");
    assert_int_equal(offsetof(Photon, rgbe), 12);
    assert_int_equal(offsetof(Photon, phi), 16);
    assert_int_equal(offsetof(Photon, theta), 17);
    assert_int_equal(offsetof(Photon, flags), 18);
}

/* Row S8: the mean over many photons of one colour is that colour, in every channel, up to 1:300.
 * The brightest channel has at least 127 steps; a channel 300 times dimmer less than half a
 * step, whose standard error is known: sqrt(p(1-p)/n) steps. */
static void rgbe_has_no_bias(void **state)
{
    (void)state;
    const int n = 4000000;
    const float ratios[] = {1, 3, 10, 100, 300};
    for (int i = 0; i < 5; i++) {
        float dim = 0.7713f / ratios[i];
        double sum = 0, bright = 0;
        for (int j = 0; j < n; j++) {
            Rng rng = rng_at(7, 0, (uint64_t)j + (uint64_t)i * 1000003u);
            Rgb out = round_trip(rgb(0.7713f, dim, 0), &rng);
            bright += out.r;
            sum += out.g;
        }
        double step = 0x1p-8; /* 0.7713 is in [1/2, 1) */
        double fraction = dim / step - floor(dim / step);
        double error = step * sqrt(fraction * (1 - fraction) / n);
        assert_true(fabs(sum / n - dim) <= 4 * error + 1e-6 * dim);
        assert_true(fabs(sum / n / dim - 1) < 0.001); /* the requirement itself */
        assert_true(fabs(bright / n / 0.7713 - 1) < 1e-5 * 4);
    }
}

/* The same over random colours and scales, weighted by power. */
static void rgbe_has_no_bias_at_any_scale(void **state)
{
    (void)state;
    double in = 0, out = 0, variance = 0;
    for (int i = 0; i < 400000; i++) {
        Rng rng = rng_at(11, 1, (uint64_t)i);
        float scale = ldexpf(1, (int)(rng_u32(&rng) % 40) - 20);
        Rgb power = rgb(rng_float(&rng), rng_float(&rng) / 50, rng_float(&rng) / 300);
        Rgb got = round_trip(rgb_scale(power, scale), &rng);
        in += (double)(power.r + power.g + power.b);
        out += (double)rgb_sum(got) / (double)scale;
        variance += 3 * 0.25 * pow(0x1p-7 * (double)rgb_max(power), 2);
    }
    assert_true(fabs(out - in) < 4 * sqrt(variance));
}

/* Row S8: the rounding is the photon's own: its random key decides, and nothing else. */
static void rgbe_is_a_function_of_the_key(void **state)
{
    (void)state;
    int differing = 0;
    for (uint64_t i = 0; i < 1000; i++) {
        uint8_t a[4], b[4], c[4];
        Rng one = rng_at(9, 2, i), same = rng_at(9, 2, i), other = rng_at(9, 2, i + 1000);
        rgbe_encode(rgb(0.7f, 0.1234f, 0.001f), &one, a);
        rgbe_encode(rgb(0.7f, 0.1234f, 0.001f), &same, b);
        rgbe_encode(rgb(0.7f, 0.1234f, 0.001f), &other, c);
        assert_memory_equal(a, b, sizeof a);
        assert_true(one.counter == 1);
        differing += memcmp(a, c, sizeof a) != 0;
    }
    assert_true(differing > 300);
}

static void rgbe_carries_into_the_next_exponent(void **state)
{
    (void)state;
    double sum = 0;
    for (int i = 0; i < 100000; i++) {
        Rng rng = rng_at(3, 0, (uint64_t)i);
        Rgb out = round_trip(rgb(0.9999f, 0.9999f, 0.9999f), &rng);
        assert_true(out.r > 0.98f && out.r <= 1.01f);
        sum += out.r;
    }
    assert_true(fabs(sum / 1e5 - 0.9999) < 4 * 0x1p-8 / sqrt(1e5));
}

/* Row S8: black, NaN, infinite, huge, negative and denormal powers have defined results. */
static void rgbe_edge_cases(void **state)
{
    (void)state;
    Rng rng = rng_at(1, 0, 0);
    float most = 255 * 0x1p119f;
    Rgb out = round_trip(RGB_BLACK, &rng);
    assert_true(rgb_is_black(out));
    out = round_trip(rgb(NAN, -1, 0.5f), &rng);
    assert_true(out.r == 0 && out.g == 0 && out.b == 0.5f);
    out = round_trip(rgb(INFINITY, FLT_MAX, 0), &rng);
    assert_true(out.r == most && out.g == most && out.b == 0);
    out = round_trip(rgb(-INFINITY, -0.0f, -1), &rng);
    assert_true(rgb_is_black(out));
    for (int i = 0; i < 64; i++) { /* denormals: nothing, or the smallest step */
        out = round_trip(rgb(0x1p-127f, 0x1p-149f, 0), &rng);
        assert_true(out.r == 0 || out.r == 0x1p-126f);
        assert_true(out.g == 0 || out.g == 0x1p-126f);
    }
    out = round_trip(rgb(0x1p-119f, 0, 0), &rng);
    assert_true(out.r == 0x1p-119f);
    uint8_t code[4];
    rgbe_encode(RGB_BLACK, &rng, code);
    assert_true(code[0] == 0 && code[1] == 0 && code[2] == 0 && code[3] == 0);
}

static double angle_between(V3 a, V3 b)
{
    return 2 * asin(fmin(1, v3_dist(v3_unit(a), v3_unit(b)) / 2));
}

/* Row S9: the stated error holds everywhere and is nearly reached. */
static void direction_error_is_bounded(void **state)
{
    (void)state;
    double worst = 0;
    for (int i = 0; i < 1000000; i++) {
        Rng rng = rng_at(5, 0, (uint64_t)i);
        double z = 2 * rng_double(&rng) - 1, a = 2 * PMS_PI * rng_double(&rng);
        double s = sqrt(1 - z * z);
        V3 d = v3(s * cos(a), s * sin(a), z);
        uint8_t phi, theta;
        direction_encode(d, &phi, &theta);
        V3 back = direction_decode(phi, theta);
        assert_true(fabs(v3_len(back) - 1) < 1e-6);
        worst = fmax(worst, angle_between(d, back));
    }
    assert_true(worst < DIRECTION_MAX_ERROR);
    assert_true(worst > 0.95 * DIRECTION_MAX_ERROR);
}

/* Row S9: azimuth wraps, both poles are reached. */
static void direction_poles_and_wrap(void **state)
{
    (void)state;
    const V3 axes[] = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
    for (int i = 0; i < 6; i++) {
        uint8_t phi, theta;
        direction_encode(axes[i], &phi, &theta);
        double error = angle_between(axes[i], direction_decode(phi, theta));
        assert_true(error < (i < 2 ? 1e-6 : PMS_PI / 510 + 1e-6));
    }
    /* Just below and above the negative x axis the azimuth jumps from pi to -pi. */
    for (int i = -1; i <= 1; i += 2) {
        uint8_t phi, theta;
        V3 d = v3_unit(v3(-1, i * 1e-9, 0));
        direction_encode(d, &phi, &theta);
        assert_int_equal(phi, 128);
        d = v3_unit(v3(1, i * 1e-9, 0));
        direction_encode(d, &phi, &theta);
        assert_int_equal(phi, 0);
    }
    uint8_t phi, theta;
    direction_encode(v3(NAN, 0, 1), &phi, &theta);
    assert_true(fabs(v3_len(direction_decode(phi, theta)) - 1) < 1e-6);
    direction_encode(v3(0, 0, 1 + 1e-9), &phi, &theta);
    assert_int_equal(theta, 0);
}

/* Every code decodes to a unit vector that encodes to the same place. */
static void direction_codes_are_stable(void **state)
{
    (void)state;
    for (int t = 0; t < 256; t++)
        for (int p = 0; p < 256; p++) {
            V3 d = direction_decode((uint8_t)p, (uint8_t)t);
            uint8_t phi, theta;
            direction_encode(d, &phi, &theta);
            assert_int_equal(theta, t);
            if (t != 0 && t != 255)
                assert_int_equal(phi, p);
        }
}

static void normal_error_is_bounded(void **state)
{
    (void)state;
    double worst = 0;
    for (int i = 0; i < 1000000; i++) {
        Rng rng = rng_at(6, 0, (uint64_t)i);
        double z = 2 * rng_double(&rng) - 1, a = 2 * PMS_PI * rng_double(&rng);
        double s = sqrt(1 - z * z);
        V3 n = v3(s * cos(a), s * sin(a), z);
        uint16_t code = normal14_encode(n);
        assert_true(code < 1 << 14);
        worst = fmax(worst, angle_between(n, normal14_decode(code)));
    }
    print_message("# worst normal error %.5f\n", worst);
    assert_true(worst < NORMAL14_MAX_ERROR);
    assert_true(worst > 0.9 * NORMAL14_MAX_ERROR);
    for (int axis = 0; axis < 3; axis++)
        for (int sign = -1; sign <= 1; sign += 2) {
            V3 n = v3(axis == 0 ? sign : 0, axis == 1 ? sign : 0, axis == 2 ? sign : 0);
            assert_true(v3_dist(n, normal14_decode(normal14_encode(n))) == 0);
        }
    assert_true(fabs(v3_len(normal14_decode(normal14_encode(v3(NAN, 0, 0)))) - 1) < 1e-6);
    assert_true(fabs(v3_len(normal14_decode(normal14_encode(v3(0, 0, 0)))) - 1) < 1e-6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(photon_is_20_bytes),
        cmocka_unit_test(rgbe_has_no_bias),
        cmocka_unit_test(rgbe_has_no_bias_at_any_scale),
        cmocka_unit_test(rgbe_is_a_function_of_the_key),
        cmocka_unit_test(rgbe_carries_into_the_next_exponent),
        cmocka_unit_test(rgbe_edge_cases),
        cmocka_unit_test(direction_error_is_bounded),
        cmocka_unit_test(direction_poles_and_wrap),
        cmocka_unit_test(direction_codes_are_stable),
        cmocka_unit_test(normal_error_is_bounded),
    };
    return cmocka_run_group_tests_name("photon", tests, NULL, NULL);
}
