/* Pixel buffers.  SPDX-License-Identifier: Apache-2.0 */
#include "base/mem.h"
#include "image/image.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

static void layers_are_zeroed_and_found(void **state)
{
    (void)state;
    Image image;
    image_init(&image, 3, 2);
    assert_non_null(image_add_layer(&image, "", "RGBA"));
    assert_non_null(image_add_layer(&image, "Z", "Z"));
    ImageLayer *z = image_find_layer(&image, "Z");
    assert_non_null(z);
    assert_int_equal(z->channel_count, 1);
    for (int i = 0; i < 6; i++)
        assert_true(z->pixels[i] == 0);
    assert_ptr_equal(image_find_layer(&image, ""), &image.layers[0]);
    assert_null(image_find_layer(&image, "N"));
    image_done(&image);
    assert_int_equal(image.layer_count, 0);
}

static void channels_have_places(void **state)
{
    (void)state;
    Image image;
    image_init(&image, 1, 1);
    ImageLayer *layer = image_add_layer(&image, "N", "XYZ");
    assert_int_equal(image_channel(layer, 'X'), 0);
    assert_int_equal(image_channel(layer, 'Z'), 2);
    assert_int_equal(image_channel(layer, 'R'), -1);
    assert_int_equal(image_channel(layer, 0), -1);
    image_done(&image);
}

static void cropping_keeps_the_rectangle(void **state)
{
    (void)state;
    Image image;
    image_init(&image, 4, 3);
    ImageLayer *layer = image_add_layer(&image, "", "RG");
    for (int i = 0; i < 24; i++)
        layer->pixels[i] = (float)i;
    image_crop(&image, 1, 1, 2, 2);
    assert_int_equal(image.width, 2);
    assert_int_equal(image.height, 2);
    static const float wanted[8] = {10, 11, 12, 13, 18, 19, 20, 21};
    assert_memory_equal(layer->pixels, wanted, sizeof wanted);
    image_done(&image);
}

static void memory_that_is_out_leaves_an_image_whole(void **state)
{
    (void)state;
    Image image;
    image_init(&image, 4, 4);
    assert_non_null(image_add_layer(&image, "", "RGB"));
    for (long n = 1; n <= 2; n++) {
        mem_fail_from(n);
        assert_null(image_add_layer(&image, "Z", "Z"));
        mem_fail_from(0);
        assert_int_equal(image.layer_count, 1);
    }
    assert_non_null(image_find_layer(&image, ""));
    image_done(&image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(layers_are_zeroed_and_found),
        cmocka_unit_test(channels_have_places),
        cmocka_unit_test(cropping_keeps_the_rectangle),
        cmocka_unit_test(memory_that_is_out_leaves_an_image_whole),
    };
    return cmocka_run_group_tests_name("image", tests, NULL, NULL);
}
