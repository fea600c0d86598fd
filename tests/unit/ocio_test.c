/* Scene light to display colours.  SPDX-License-Identifier: Apache-2.0 */
#include "image/ocio.h"
#include "image/srgb.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

#include "quiet.h"

static int open_own(void **state)
{
    unsetenv("OCIO");
    Ocio *ocio;
    if (ocio_new(quiet(), NULL, &ocio) != OK)
        return -1;
    *state = ocio;
    return 0;
}

static int close_own(void **state)
{
    ocio_free(*state);
    return 0;
}

/* The default view is the sRGB curve and nothing else, to the last step of 16 bits. */
static void default_view_is_the_srgb_curve(void **state)
{
    enum { STEPS = 20001 };
    static float pixels[STEPS * 3];
    for (int i = 0; i < STEPS * 3; i++)
        pixels[i] = (float)(i % STEPS) / (STEPS - 1);
    assert_int_equal(ocio_apply(quiet(), *state, NULL, NULL, pixels, STEPS, 3), OK);
    for (int i = 0; i < STEPS * 3; i++) {
        float wanted = srgb_encode((float)(i % STEPS) / (STEPS - 1));
        assert_true(fabsf(pixels[i] - wanted) < 1.5f / 65535);
    }
}

static void alpha_is_left_alone(void **state)
{
    float pixels[8] = {0.2f, 0.4f, 0.6f, 0.25f, 1, 0, 0, 0.75f};
    assert_int_equal(ocio_apply(quiet(), *state, "sRGB", "ACES", pixels, 2, 4), OK);
    assert_true(pixels[3] == 0.25f && pixels[7] == 0.75f);
}

static void raw_view_changes_nothing(void **state)
{
    float pixels[3] = {-1, 0.5f, 40};
    assert_int_equal(ocio_apply(quiet(), *state, "sRGB", "Raw", pixels, 1, 3), OK);
    assert_true(pixels[0] == -1 && pixels[1] == 0.5f && pixels[2] == 40);
    assert_false(ocio_is_srgb(*state, "sRGB", "Raw"));
}

/* Grey stays grey, grows with the light, and rolls off instead of clipping. */
static void aces_view_rolls_off(void **state)
{
    float before = -1;
    for (int i = 0; i < 12; i++) {
        float light = 0.01f * powf(2, (float)i);
        float pixel[3] = {light, light, light};
        assert_int_equal(ocio_apply(quiet(), *state, "sRGB", "ACES", pixel, 1, 3), OK);
        assert_float_equal(pixel[0], pixel[1], 2e-3f);
        assert_float_equal(pixel[0], pixel[2], 2e-3f);
        assert_true(pixel[0] > before);
        before = pixel[0];
    }
    float one[3] = {1, 1, 1}, grey[3] = {0.18f, 0.18f, 0.18f};
    ocio_apply(quiet(), *state, NULL, "ACES", one, 1, 3);
    ocio_apply(quiet(), *state, NULL, "ACES", grey, 1, 3);
    assert_true(one[0] < 0.95f && one[0] > 0.7f);
    /* mid grey of the ACES SDR output transform is 10 % of display light */
    assert_float_equal(srgb_decode(grey[0]), 0.10f, 0.01f);
    assert_true(ocio_is_srgb(*state, NULL, "ACES"));
}

static void unknown_names_list_the_known(void **state)
{
    float pixel[3] = {0};
    assert_int_equal(ocio_apply(quiet(), *state, "projector", NULL, pixel, 1, 3), ERR_USAGE);
    assert_non_null(strstr(last_message, "projector"));
    assert_non_null(strstr(last_message, "'sRGB'"));
    assert_int_equal(ocio_apply(quiet(), *state, NULL, "filmic", pixel, 1, 3), ERR_USAGE);
    assert_non_null(strstr(last_message, "'Standard'"));
    assert_non_null(strstr(last_message, "'ACES'"));
    assert_false(ocio_is_srgb(*state, "projector", NULL));
}

static void every_view_of_every_display_works(void **state)
{
    static const char *const displays[] = {"sRGB", "Rec.1886"};
    static const char *const views[] = {"Standard", "ACES", "Raw"};
    for (int i = 0; i < 6; i++) {
        float pixel[3] = {0.18f, 0.18f, 0.18f};
        assert_int_equal(ocio_apply(quiet(), *state, displays[i / 3], views[i % 3], pixel, 1, 3),
                         OK);
        assert_true(pixel[0] > 0.1f && pixel[0] < 0.6f);
    }
    assert_true(ocio_is_srgb(*state, NULL, NULL));
    assert_false(ocio_is_srgb(*state, "Rec.1886", NULL));
}

static void nothing_to_do_is_fine(void **state)
{
    assert_int_equal(ocio_apply(quiet(), *state, NULL, NULL, NULL, 0, 3), OK);
}

static void a_named_file_is_read(void **state)
{
    (void)state;
    Ocio *ocio;
    assert_int_equal(ocio_new(quiet(), "stdlib/pms.ocio", &ocio), OK);
    assert_string_equal(ocio_name(ocio), "stdlib/pms.ocio");
    ocio_free(ocio);
    setenv("OCIO", "stdlib/pms.ocio", 1);
    assert_int_equal(ocio_new(quiet(), NULL, &ocio), OK);
    assert_string_equal(ocio_name(ocio), "stdlib/pms.ocio");
    ocio_free(ocio);
    unsetenv("OCIO");
    assert_int_equal(ocio_new(quiet(), NULL, &ocio), OK);
    assert_string_equal(ocio_name(ocio), "built in");
    ocio_free(ocio);
}

static void bad_configurations_are_refused(void **state)
{
    (void)state;
    Ocio *ocio;
    Status status = ocio_new(quiet(), "/no/such/file.ocio", &ocio);
    assert_true(status == ERR_FILE || status == ERR_LIBRARY);
    assert_null(ocio);
    assert_non_null(strstr(last_message, "/no/such/file.ocio"));
    status = ocio_new(quiet(), "Makefile", &ocio);
    assert_true(status == ERR_FILE || status == ERR_LIBRARY);
    assert_null(ocio);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(default_view_is_the_srgb_curve),
        cmocka_unit_test(alpha_is_left_alone),
        cmocka_unit_test(raw_view_changes_nothing),
        cmocka_unit_test(aces_view_rolls_off),
        cmocka_unit_test(unknown_names_list_the_known),
        cmocka_unit_test(every_view_of_every_display_works),
        cmocka_unit_test(nothing_to_do_is_fine),
        cmocka_unit_test(a_named_file_is_read),
        cmocka_unit_test(bad_configurations_are_refused),
    };
    return cmocka_run_group_tests_name("ocio", tests, open_own, close_own);
}
