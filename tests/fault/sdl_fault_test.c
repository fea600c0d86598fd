/* Reading a scene while the n-th allocation fails, for every n: a message or a scene, never a
 * crash or a leak.  SPDX-License-Identifier: Apache-2.0 */
#include "base/mem.h"
#include "sdl/sdl.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

enum { TRIES_MAX = 5000 };

static const char scene_text[] =
    "#version 3.7;\n"
    "global_settings { assumed_gamma 1 photons { count 100 } }\n"
    "#include \"tests/lang/include_directive/sub/deep.inc\"\n"
    "#declare A = array[3][4];\n"
    "#declare S = concat(\"a\", str(1, 0, 2), strupr(\"b\"));\n"
    "#macro Ball(C, R) sphere { C, R texture { pigment { checker rgb 1 rgb 0 scale 2 } } } #end\n"
    "#declare R = seed(3);\n"
    "#for (I, 0, 3)\n"
    "  #declare A[1][I] = rand(R);\n"
    "  Ball(<I, A[1][I], 0>, 1)\n"
    "#end\n"
    "union { box { 0, 1 } difference { sphere { 0, 1 } plane { y, 0 } } rotate 30*y }\n"
    "mesh { triangle { 0, x, y } triangle { 0, x, z } pigment { rgb 1 } }\n"
    "light_source { 10*y rgb 1 area_light x, z, 3, 3 }\n"
    "media { absorption 0.1 density { gradient x } } fog { distance 9 rgb 1 }\n"
    "rainbow { direction z angle 40 width 5 color_map { [0 rgb 1] [1 rgb 0] } }\n"
    "sky_sphere { pigment { gradient y color_map { [0 rgb 1] [1 rgb 0] } } }\n"
    "sphere { 0, 1 hollow interior { fade_distance 2 media { emission 1 } } }\n"
    "camera { location -5*z look_at 0 }\n";

static void drop(void *ctx, const char *text)
{
    (void)ctx;
    (void)text;
}

static Status load_with_fault(long n, const Similarity *by)
{
    SdlOptions options = {.width = 32, .height = 24, .threads = 1, .moved_by = by};
    Diag diag;
    Scene *scene;
    diag_init(&diag, drop, NULL);
    mem_fail_from(n);
    Status status =
        sdl_load_text(&diag, "fault.pms", scene_text, strlen(scene_text), &options, &scene);
    mem_fail_from(0);
    assert_int_equal(status == OK, scene != NULL);
    assert_true(status == OK || diag.errors > 0);
    scene_free(scene);
    diag_done(&diag);
    return status;
}

static void fail_each(const Similarity *by)
{
    assert_int_equal(load_with_fault(0, by), OK);
    long n = 1;
    Status status = ERR_MEMORY;
    for (; n < TRIES_MAX && status != OK; n++) {
        status = load_with_fault(n, by);
        assert_true(status == OK || status == ERR_MEMORY);
    }
    assert_int_equal(status, OK);
    assert_true(n > 5);
}

static void test_every_allocation(void **state)
{
    (void)state;
    fail_each(NULL);
}

static void test_every_allocation_moved(void **state)
{
    (void)state;
    const Xform turn = xform_rotate(v3(1, 2, 3));
    const Similarity by = similarity_make(&turn, 3, v3(4, 5, 6));
    fail_each(&by);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_allocation),
        cmocka_unit_test(test_every_allocation_moved),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
