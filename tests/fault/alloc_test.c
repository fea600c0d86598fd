/* Every allocation can fail: loading and rendering a small scene with the n-th allocation
 * refused, for n = 1, 2, 3 ..., must end in ERR_MEMORY (or a picture), never in a crash.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/mem.h"
#include "render/forecast.h"
#include "sdl/sdl.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>
#include <string.h>

static const char scene_text[] =
    "#version 3.7; global_settings { assumed_gamma 1 photons { count 200 } }\n"
    "camera { location <0,1,-5> look_at 0 } light_source { <2,4,-3>, rgb 1 }\n"
    "#macro Ball(P) sphere { P, 0.5 texture { pigment { rgb 1 } finish { diffuse 0.7 } } } #end\n"
    "#declare I = 0; #while (I < 2) Ball(<I, 0, 1>) #declare I = I + 1; #end\n"
    "difference { box { -1, 0 } sphere { 0, 0.5 } pigment { checker rgb 1 rgb 0 } }\n"
    "sphere { <1, 0.6, -1>, 0.4 pigment { rgbf 1 } interior { ior 1.5 }\n"
    "  photons { target refraction on } }\n"
    "mesh { triangle { <0,0,2>, <1,0,2>, <0,1,2> } pigment { rgb <1,0,0> } }\n"
    "plane { y, -1 pigment { gradient x color_map { [0 rgb 0] [1 rgb 1] } } }\n";

static void ignore(void *ctx, const char *text)
{
    (void)ctx, (void)text;
}

/* What is done with a scene: rendering in passes, at once, or saying what that would take. */
typedef enum Deed { PASSES, PICTURE, FORECAST } Deed;

static Status render(const Scene *scene, const RenderOptions *options, Diag *diag)
{
    RenderResult result;
    Status status = render_scene(scene, options, diag, &result);
    if (status == OK)
        render_result_done(&result);
    return status;
}

static Status forecast(const Scene *scene, const RenderOptions *options, Diag *diag)
{
    Plan plan;
    Forecast found;
    Status status = render_forecast(scene, options, diag, scene->arena, &plan, &found);
    if (status == OK)
        forecast_done(&found);
    return status;
}

/* Load a scene and do something with it on a single thread; returns the status. */
static Status attempt(Deed deed)
{
    Diag diag;
    diag_init(&diag, ignore, NULL);
    SdlOptions sdl = {.width = 8, .height = 6, .threads = 1};
    RenderOptions options = RENDER_OPTIONS_DEFAULT;
    options.width = 8;
    options.height = 6;
    options.layers = LAYER_DIRECT | LAYER_CAUSTIC;
    options.plan.is_progressive = deed == PASSES;
    options.progressive.passes = 2;
    options.plan.has_indirect = deed == FORECAST;
    Scene *scene = NULL;
    Status status = sdl_load_text(&diag, "fault.pms", scene_text, strlen(scene_text), &sdl, &scene);
    if (status == OK)
        status =
            deed == FORECAST ? forecast(scene, &options, &diag) : render(scene, &options, &diag);
    scene_free(scene);
    diag_done(&diag);
    return status;
}

static void try_each(Deed deed)
{
    enum { MANY = 100000 };
    assert_int_equal(attempt(deed), OK);
    int successes = 0, n = 1;
    for (; n < MANY && !successes; n += n < 200 ? 1 : n / 50) {
        mem_fail_from(n);
        Status status = attempt(deed);
        mem_fail_from(0);
        assert_true(status == OK || status == ERR_MEMORY || status == ERR_LIBRARY);
        successes += status == OK;
    }
    /* The loop ends because nothing was left to fail, not because it gave up. */
    assert_true(successes > 0 && n > 20);
}

static void test_each_allocation(void **state)
{
    (void)state;
    try_each(PICTURE);
}

static void test_each_allocation_of_passes(void **state)
{
    (void)state;
    try_each(PASSES);
}

static void test_each_allocation_of_a_forecast(void **state)
{
    (void)state;
    try_each(FORECAST);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_each_allocation),
                                       cmocka_unit_test(test_each_allocation_of_passes),
                                       cmocka_unit_test(test_each_allocation_of_a_forecast)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
