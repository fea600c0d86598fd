/* Error metrics between images.  SPDX-License-Identifier: Apache-2.0 */
#include "base/mem.h"
#include "image/compare.h"
#include "image/srgb.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <cmocka.h>

#include "quiet.h"

static void assert_near(double found, double wanted, double tolerance)
{
    assert_true(fabs(found - wanted) <= tolerance);
}

static float *make(Image *image, int width, int height, const char *channels, float value)
{
    image_init(image, width, height);
    ImageLayer *layer = image_add_layer(image, "", channels);
    assert_non_null(layer);
    for (int i = 0; i < width * height * layer->channel_count; i++)
        layer->pixels[i] = value;
    return layer->pixels;
}

static CompareResult compare(const Image *a, const Image *b)
{
    CompareResult result;
    assert_int_equal(image_compare(quiet(), a, b, &result), OK);
    return result;
}

static void equal_images_are_equal(void **state)
{
    (void)state;
    static const int sizes[][2] = {{1, 1}, {5, 3}, {10, 40}, {11, 11}, {40, 30}};
    for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
        Image a, b;
        int w = sizes[s][0], h = sizes[s][1];
        float *pa = make(&a, w, h, "RGB", 0), *pb = make(&b, w, h, "RGB", 0);
        for (int i = 0; i < w * h * 3; i++)
            pa[i] = pb[i] = (float)fmod(i * 0.37, 1.3);
        CompareResult r = compare(&a, &b);
        assert_true(r.rmse == 0 && r.rel_mse == 0 && r.max_error == 0);
        assert_true(isinf(r.psnr) && r.psnr > 0);
        assert_near(r.ssim, 1, 1e-12);
        assert_true(r.mean_a == r.mean_b);
        image_done(&a);
        image_done(&b);
    }
}

static void constant_images_have_known_metrics(void **state)
{
    (void)state;
    Image a, b;
    make(&a, 20, 20, "RGB", 0.5f);
    make(&b, 20, 20, "RGB", 0.25f);
    CompareResult r = compare(&a, &b);
    assert_false(r.is_display);
    assert_near(r.rmse, 0.25, 1e-9);
    assert_near(r.rel_mse, 0.0625 / (0.0625 + 0.01), 1e-9);
    assert_near(r.psnr, -20 * log10(0.25), 1e-9);
    assert_near(r.max_error, 0.25, 1e-9);
    assert_near(r.error95, 0.25 / hypot(0.25, 0.025), 0.03);
    assert_near(r.mean_a, 0.5, 1e-9);
    assert_near(r.light_a, 0.5, 1e-9);
    /* of constants only the luminance term is left */
    double la = (double)srgb_encode(0.5f), lb = (double)srgb_encode(0.25f), c1 = 1e-4;
    assert_near(r.ssim, (2 * la * lb + c1) / (la * la + lb * lb + c1), 1e-5);
    image_done(&a);
    image_done(&b);
}

/* The definition, written as plainly as can be, for one window. */
static void one_window_agrees_with_the_definition(void **state)
{
    (void)state;
    Image a, b;
    float *pa = make(&a, 11, 11, "RGB", 0), *pb = make(&b, 11, 11, "RGB", 0);
    a.is_display = b.is_display = true;
    double w[121], sum = 0, ma = 0, mb = 0, va = 0, vb = 0, cov = 0;
    for (int i = 0; i < 121; i++) {
        int x = i % 11 - 5, y = i / 11 - 5;
        w[i] = exp(-(x * x + y * y) / (2 * 1.5 * 1.5));
        sum += w[i];
        for (int c = 0; c < 3; c++) {
            pa[3 * i + c] = (float)fmod(i * 0.618, 1);
            pb[3 * i + c] = (float)fmod(i * 0.618 + 0.1 * (i % 5), 1);
        }
    }
    for (int i = 0; i < 121; i++) {
        ma += w[i] / sum * (double)pa[3 * i];
        mb += w[i] / sum * (double)pb[3 * i];
    }
    for (int i = 0; i < 121; i++) {
        double da = (double)pa[3 * i] - ma, db = (double)pb[3 * i] - mb;
        va += w[i] / sum * da * da;
        vb += w[i] / sum * db * db;
        cov += w[i] / sum * da * db;
    }
    double wanted =
        (2 * ma * mb + 1e-4) * (2 * cov + 9e-4) / ((ma * ma + mb * mb + 1e-4) * (va + vb + 9e-4));
    assert_true(wanted < 0.9);
    assert_near(compare(&a, &b).ssim, wanted, 1e-6);
    image_done(&a);
    image_done(&b);
}

static void bad_pixels_are_counted_not_spread(void **state)
{
    (void)state;
    Image a, b;
    float *pa = make(&a, 16, 16, "RGBA", 0.5f), *pb = make(&b, 16, 16, "RGBA", 0.5f);
    pa[0] = NAN;
    pa[4] = INFINITY;
    pb[0] = -INFINITY;
    CompareResult r = compare(&a, &b);
    assert_int_equal(r.bad_a, 2);
    assert_int_equal(r.bad_b, 1);
    assert_true(r.rmse == 0 && r.max_error == 0);
    assert_near(r.mean_a, 0.5, 1e-9);
    assert_true(isfinite(r.ssim));
    for (int i = 0; i < 16 * 16 * 4; i++)
        pa[i] = NAN;
    r = compare(&a, &b);
    assert_int_equal(r.bad_a, 256);
    assert_true(r.rmse == 0 && r.mean_a == 0 && isfinite(r.ssim));
    image_done(&a);
    image_done(&b);
}

static void light_meets_display(void **state)
{
    (void)state;
    Image light, display;
    float *pl = make(&light, 12, 12, "RGB", 0), *pd = make(&display, 12, 12, "RGBA", 1);
    display.is_display = true;
    for (int i = 0; i < 12 * 12; i++) {
        for (int c = 0; c < 3; c++) {
            pl[3 * i + c] = (float)i / 100 - 0.1f; /* also below 0 and above 1 */
            pd[4 * i + c] = srgb_encode(fminf(fmaxf(pl[3 * i + c], 0), 1));
        }
    }
    CompareResult r = compare(&light, &display);
    assert_true(r.is_display);
    assert_true(r.rmse < 1e-7);
    assert_near(r.light_a, r.light_b, 1e-6);
    assert_true(r.light_a < r.mean_a);
    assert_near(compare(&display, &light).ssim, 1, 1e-6);
    /* half-transparent display colours lie over black */
    for (int i = 0; i < 12 * 12; i++) {
        pd[4 * i + 3] = 0.5f;
        for (int c = 0; c < 3; c++)
            pl[3 * i + c] = 0.5f * srgb_decode(pd[4 * i + c]);
    }
    assert_true(compare(&light, &display).rmse < 1e-6);
    image_done(&light);
    image_done(&display);
}

static void grey_is_all_three(void **state)
{
    (void)state;
    Image grey, colour;
    make(&grey, 4, 4, "Y", 0.3f);
    make(&colour, 4, 4, "RGB", 0.3f);
    assert_true(compare(&grey, &colour).rmse == 0);
    image_done(&grey);
    image_done(&colour);
}

static void what_cannot_be_compared_is_refused(void **state)
{
    (void)state;
    Image a, b, depth, empty;
    CompareResult r;
    make(&a, 4, 4, "RGB", 0);
    make(&b, 4, 5, "RGB", 0);
    make(&depth, 4, 4, "Z", 0);
    image_init(&empty, 4, 4);
    assert_int_equal(image_compare(quiet(), &a, &b, &r), ERR_USAGE);
    assert_non_null(strstr(last_message, "4x4 and 4x5"));
    assert_int_equal(image_compare(quiet(), &a, &depth, &r), ERR_USAGE);
    assert_int_equal(image_compare(quiet(), &empty, &a, &r), ERR_USAGE);
    Image difference;
    assert_int_equal(image_difference(quiet(), &a, &b, 1, &difference), ERR_USAGE);
    assert_int_equal(difference.layer_count, 0);
    image_done(&a);
    image_done(&b);
    image_done(&depth);
}

static void difference_is_scaled(void **state)
{
    (void)state;
    Image a, b, d;
    float *pa = make(&a, 3, 1, "RGB", 0.5f);
    make(&b, 3, 1, "RGBA", 0.75f);
    pa[3] = NAN;
    assert_int_equal(image_difference(quiet(), &a, &b, 4, &d), OK);
    assert_true(d.layers[0].pixels[0] == 1);
    assert_true(d.layers[0].pixels[3] == 1 && d.layers[0].pixels[4] == 0);
    assert_false(d.is_display);
    image_done(&a);
    image_done(&b);
    image_done(&d);
}

static void the_flip_map_comes_with_the_metrics(void **state)
{
    (void)state;
    Image a, b, with, alone;
    float *pa = make(&a, 20, 20, "RGB", 0.5f);
    make(&b, 20, 20, "RGB", 0.25f);
    pa[30] = 3;
    CompareResult r;
    assert_int_equal(image_compare_flip(quiet(), &a, &b, &r, &with), OK);
    assert_true(r.flip == compare(&a, &b).flip && r.flip > 0);
    assert_int_equal(image_flip(quiet(), &a, &b, &alone), OK);
    assert_true(with.is_display && with.width == 20 && with.height == 20);
    assert_memory_equal(with.layers[0].pixels, alone.layers[0].pixels, 1200 * sizeof(float));
    image_done(&a);
    image_done(&b);
    image_done(&with);
    image_done(&alone);
}

static void memory_may_run_out(void **state)
{
    (void)state;
    Image a, b;
    make(&a, 20, 20, "RGB", 0.5f);
    make(&b, 20, 20, "RGB", 0.25f);
    CompareResult r;
    Image flip;
    Status status = ERR_MEMORY;
    for (long n = 1; status != OK; n++) {
        mem_fail_from(n);
        status = image_compare_flip(quiet(), &a, &b, &r, &flip);
        mem_fail_from(0);
        assert_true(status == OK || status == ERR_MEMORY);
        image_done(&flip);
        assert_true(n < 20);
    }
    image_done(&a);
    image_done(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_images_are_equal),
        cmocka_unit_test(constant_images_have_known_metrics),
        cmocka_unit_test(one_window_agrees_with_the_definition),
        cmocka_unit_test(bad_pixels_are_counted_not_spread),
        cmocka_unit_test(light_meets_display),
        cmocka_unit_test(grey_is_all_three),
        cmocka_unit_test(what_cannot_be_compared_is_refused),
        cmocka_unit_test(difference_is_scaled),
        cmocka_unit_test(the_flip_map_comes_with_the_metrics),
        cmocka_unit_test(memory_may_run_out),
    };
    return cmocka_run_group_tests_name("compare", tests, NULL, NULL);
}
