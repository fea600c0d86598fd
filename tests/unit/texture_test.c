/* Pigments, textures and interiors.  SPDX-License-Identifier: Apache-2.0 */
#include "texture/texture.h"

#include "base/mem.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#define RAMP                                                                                       \
    {                                                                                              \
        .kind = PATTERN_GRADIENT, .direction = {1, 0, 0}, .frequency = 1                           \
    }

static bool is_near(double a, double b)
{
    return fabs(a - b) < 1e-6;
}

static void test_map_lookup(void **state)
{
    (void)state;
    /* keys start late, jump at one key, and end early */
    const MapEntry map[] = {{0.2f, {1, 0, 0, 0, 0}},
                            {0.4f, {0, 1, 0, 0.5f, 0.25f}},
                            {0.4f, {0, 0, 1, 0, 0}},
                            {0.8f, {1, 1, 1, 0, 1}}};
    Pigment pigment = {.pattern = RAMP, .map = map, .map_count = 4};
    assert_true(pigment_at(&pigment, v3(0.1, 0, 0)).r == 1);
    Color5 half = pigment_at(&pigment, v3(0.3, 0, 0));
    assert_true(is_near(half.r, 0.5) && is_near(half.g, 0.5) && is_near(half.filter, 0.25) &&
                is_near(half.transmit, 0.125));
    assert_true(pigment_at(&pigment, v3((double)0.4f, 0, 0)).g == 1);
    Color5 late = pigment_at(&pigment, v3(0.6, 0, 0));
    assert_true(is_near(late.r, 0.5) && is_near(late.b, 1) && is_near(late.transmit, 0.5));
    assert_true(pigment_at(&pigment, v3(0.9, 0, 0)).transmit == 1);
    assert_true(pigment_at(&pigment, v3(1, 0, 0)).r == 1);
}

static void test_list_is_nested_at_the_outer_point(void **state)
{
    (void)state;
    const MapEntry map[] = {{0, {0, 0, 0, 0, 0}}, {1, {1, 1, 1, 0, 0}}};
    const Pigment solid = {.is_solid = true, .color = {0.25f, 0, 0, 0, 0}};
    const Pigment ramp = {.pattern = RAMP, .map = map, .map_count = 2};
    const Pigment *list[] = {&solid, &ramp};
    Pigment checker = {.pattern = {.kind = PATTERN_CHECKER, .is_transformed = true},
                       .list = list,
                       .list_count = 2};
    checker.pattern.xform = xform_scale(v3(4, 4, 4));
    assert_true(pigment_at(&checker, v3(1, 1, 1)).r == 0.25f);
    /* 5/4 in the pattern's space: the second square, a quarter up the ramp */
    assert_true(is_near(pigment_at(&checker, v3(5, 1, 1)).r, 0.25));
    assert_true(is_near(pigment_at(&checker, v3(7, 1, 1)).r, 0.75));
}

static void test_transform_wraps(void **state)
{
    (void)state;
    Arena *arena = arena_new();
    const MapEntry map[] = {{0, {0, 0, 0, 0, 0}}, {1, {1, 1, 1, 0, 0}}};
    const Pigment solid = {.is_solid = true}, ramp = {.pattern = RAMP, .map = map, .map_count = 2};
    Xform grow = xform_scale(v3(2, 1, 1)), move = xform_translate(v3(1, 0, 0));
    assert_ptr_equal(pigment_transform(arena, &solid, &grow), &solid);
    const Pigment *moved = pigment_transform(arena, &ramp, &grow);
    moved = pigment_transform(arena, moved, &move);
    assert_true(is_near(pigment_at(moved, v3(2, 0, 0)).r, 0.5));
    assert_true(is_near(pigment_at(&ramp, v3(0.125, 0, 0)).r, 0.125));

    const Finish finish = FINISH_DEFAULT;
    const Layer layers[] = {{&solid, &finish}, {&ramp, &finish}};
    const Texture plain = {.layers = layers, .layer_count = 1};
    const Texture both = {.layers = layers, .layer_count = 2};
    assert_ptr_equal(texture_transform(arena, &plain, &grow), &plain);
    const Texture *turned = texture_transform(arena, &both, &grow);
    assert_ptr_equal(turned->layers[0].pigment, &solid);
    assert_true(is_near(pigment_at(turned->layers[1].pigment, v3(1, 0, 0)).r, 0.5));
    arena_free(arena);
}

static void test_may_transmit(void **state)
{
    (void)state;
    const Pigment matte = {.is_solid = true, .color = {1, 1, 1, 0, 0}};
    const Pigment glass = {.is_solid = true, .color = {1, 1, 1, 0, 1}};
    const Pigment *list[] = {&matte, &glass};
    const Pigment checker = {.pattern = {.kind = PATTERN_CHECKER}, .list = list, .list_count = 2};
    const MapEntry map[] = {{0, {0, 0, 0, 0, 0}}, {1, {1, 1, 1, 0.1f, 0}}};
    const Pigment ramp = {.pattern = RAMP, .map = map, .map_count = 2};
    assert_false(pigment_may_transmit(&matte));
    assert_true(pigment_may_transmit(&checker) && pigment_may_transmit(&ramp));
    const Finish dull = FINISH_DEFAULT;
    Finish shiny = dull;
    shiny.reflection_max = rgb(0, 0, 0.1f);
    const Layer layers[] = {{&matte, &dull}, {&glass, &dull}, {&ramp, &shiny}};
    assert_false(texture_may_transmit(&(Texture){.layers = layers, .layer_count = 3}));
    assert_true(texture_may_transmit(&(Texture){.layers = layers + 1, .layer_count = 2}));
    assert_false(texture_may_reflect(&(Texture){.layers = layers, .layer_count = 2}));
    assert_true(texture_may_reflect(&(Texture){.layers = layers, .layer_count = 3}));
    const Pigment black = {.is_solid = true, .color = {0, 0, 0, 0, 0}};
    Finish dark = dull;
    dark.diffuse = 0;
    const Layer few[] = {{&black, &dull}, {&matte, &dark}, {&ramp, &dull}};
    assert_false(texture_may_scatter(&(Texture){.layers = few, .layer_count = 2}));
    assert_true(texture_may_scatter(&(Texture){.layers = few, .layer_count = 3}));
    Finish paper = dull;
    paper.diffuse_back = 0.1f;
    const Layer thin[] = {{&black, &paper}, {&matte, &dull}, {&ramp, &paper}};
    assert_false(texture_may_show_back(&(Texture){.layers = thin, .layer_count = 2}));
    assert_true(texture_may_show_back(&(Texture){.layers = thin, .layer_count = 3}));
}

static void test_fade(void **state)
{
    (void)state;
    Interior clear = INTERIOR_DEFAULT;
    assert_true(interior_fade(&clear, 5, false).r == 1);
    Interior tinted = {.ior = 1, .fade_distance = 2, .fade_power = 2, .fade_color = {0.5f, 0, 1}};
    Rgb one = interior_fade(&tinted, 2, true);
    assert_true(is_near(one.r, 0.75) && is_near(one.g, 0.5) && one.b == 1);
    Rgb two = interior_fade(&tinted, 4, false);
    assert_true(is_near(two.r, 0.6) && is_near(two.g, 0.2) && two.b == 1);
    tinted.fade_power = 1001;
    Rgb beer = interior_fade(&tinted, 4, true);
    assert_true(is_near(beer.r, exp(-1)) && is_near(beer.g, exp(-2)) && beer.b == 1);
    tinted.fade_power = 0;
    assert_true(interior_fade(&tinted, 4, true).g == 1);
    assert_true(is_near(interior_fade(&tinted, 4, false).g, 0.5));
    assert_true(is_near(interior_fade(&tinted, 4, false).r, 0.75));
    tinted.fade_power = 2;
    assert_true(rgb_is_finite(interior_fade(&tinted, INFINITY, false)));
}

static void test_transform_without_memory(void **state)
{
    (void)state;
    Arena *arena = arena_new();
    const MapEntry map[] = {{0, {0, 0, 0, 0, 0}}};
    const Pigment ramp = {.pattern = RAMP, .map = map, .map_count = 1};
    const Finish finish = FINISH_DEFAULT;
    const Layer layer = {&ramp, &finish};
    const Texture texture = {.layers = &layer, .layer_count = 1};
    Xform grow = xform_scale(v3(2, 1, 1));
    mem_fail_from(1);
    const Pigment *pigment = pigment_transform(arena, &ramp, &grow);
    const Texture *moved = texture_transform(arena, &texture, &grow);
    mem_fail_from(0);
    assert_null(pigment);
    assert_null(moved);
    arena_free(arena);
}

/* A pigment that sees uv, alone or in a list, is moved by no transform. */
static void test_uv(void **state)
{
    (void)state;
    MapEntry map[2] = {{0, {0, 0, 0, 0, 0}}, {1, {1, 1, 1, 0, 0}}};
    Pigment ramp = {.is_uv = true,
                    .has_uv = true,
                    .pattern = {.kind = PATTERN_GRADIENT,
                                .direction = {0, 1, 0},
                                .frequency = 1,
                                .exponent = 1,
                                .xform = XFORM_IDENTITY},
                    .map = map,
                    .map_count = 2};
    V3 p = v3(0.5, 0.125, 0.5);
    assert_true(is_near(pigment_at_uv(&ramp, p, (V2){0.25, 0.75}).r, 0.75));
    assert_true(is_near(pigment_at(&ramp, p).r, 0.125));
    Xform grow = xform_scale(v3(2, 2, 2));
    Arena *arena = arena_new();
    assert_ptr_equal(pigment_transform(arena, &ramp, &grow), &ramp);
    arena_free(arena);
    const Pigment *list[2] = {&ramp, &ramp};
    Pigment checker = {.has_uv = true,
                       .pattern = {.kind = PATTERN_CHECKER, .exponent = 1, .xform = XFORM_IDENTITY},
                       .list = list,
                       .list_count = 2};
    assert_true(is_near(pigment_at_uv(&checker, p, (V2){0.25, 0.75}).r, 0.75));
    Finish finish = FINISH_DEFAULT;
    Layer layer = {&checker, &finish};
    assert_true(texture_has_uv(&(Texture){.layers = &layer, .layer_count = 1}));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_map_lookup),
        cmocka_unit_test(test_list_is_nested_at_the_outer_point),
        cmocka_unit_test(test_transform_wraps),
        cmocka_unit_test(test_may_transmit),
        cmocka_unit_test(test_fade),
        cmocka_unit_test(test_transform_without_memory),
        cmocka_unit_test(test_uv),
    };
    return cmocka_run_group_tests_name("texture", tests, NULL, NULL);
}
