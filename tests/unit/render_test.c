/* Whole renders of small scenes: determinism, layers, interruption, and values that the
 * language fixes.  Numbers called POV-Ray's were read from its 16-bit linear pictures.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/render.h"

#include "base/work.h"
#include "sdl/sdl.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#define HEAD "#version 3.7; global_settings { assumed_gamma 1 } "
#define LOOK_DOWN "camera { orthographic location <0,10,0> direction -y right 8*x up 6*z } "

typedef struct Rendered {
    Diag diag;
    Scene *scene;
    RenderResult result;
    Status status;
} Rendered;

static void quiet(void *ctx, const char *text)
{
    (void)ctx, (void)text;
}

static Rendered render(const char *text, const RenderOptions *options)
{
    Rendered r;
    SdlOptions sdl = {.width = options->width, .height = options->height, .threads = 1};
    memset(&r, 0, sizeof r);
    diag_init(&r.diag, quiet, NULL);
    assert_int_equal(sdl_load_text(&r.diag, "test.pms", text, strlen(text), &sdl, &r.scene), OK);
    r.status = render_scene(r.scene, options, &r.diag, &r.result);
    return r;
}

static void done(Rendered *r)
{
    render_result_done(&r->result);
    scene_free(r->scene);
    diag_done(&r->diag);
}

static const float *pixel(const Rendered *r, const char *layer, int x, int y)
{
    const ImageLayer *found = image_find_layer(&r->result.image, layer);
    assert_non_null(found);
    size_t at = (size_t)y * (size_t)r->result.image.width + (size_t)x;
    return found->pixels + at * (size_t)found->channel_count;
}

static void assert_near(float got, double want, double tolerance)
{
    if (!(fabs((double)got - want) <= tolerance))
        fail_msg("got %.6g, wanted %.6g within %g", (double)got, want, tolerance);
}

static RenderOptions options_for(int width, int height)
{
    RenderOptions options = RENDER_OPTIONS_DEFAULT;
    options.width = width;
    options.height = height;
    return options;
}

/* A bit of everything that draws random numbers. */
static const char EVERYTHING[] =
    HEAD "camera { location <0,3,-7> look_at <0,1,0> angle 45 aperture 0.4 focal_point <0,1,0>"
         " blur_samples 12 }"
         "light_source { <5,8,-6> rgb 1 area_light <3,0,0>, <0,0,3>, 5, 5 adaptive 1 jitter }"
         "plane { y, 0 pigment { checker rgb 0.9 rgb 0.3 } }"
         "sphere { <-1,1,0>, 1 pigment { rgbf 0.9 } finish { phong 1 reflection 0.2 }"
         " interior { ior 1.5 } }"
         "box { <0.3,0,-0.8>, <1.8,1.5,0.7> pigment { rgb <0.2,0.7,0.3> } }";

static void any_number_of_threads_gives_the_same_bytes(void **state)
{
    (void)state;
    const AaMethod methods[] = {AA_NONE, AA_POV1, AA_POV2, AA_UNIFORM};
    const int threads[] = {1, 2, 7};
    for (size_t m = 0; m < 4; m++) {
        Rendered first = {0};
        for (size_t t = 0; t < 3; t++) {
            RenderOptions options = options_for(70, 50);
            options.aa = methods[m];
            options.samples = 3;
            options.threads = threads[t];
            Rendered r = render(EVERYTHING, &options);
            assert_int_equal(r.status, OK);
            if (t == 0) {
                first = r;
                continue;
            }
            assert_memory_equal(r.result.image.layers[0].pixels,
                                first.result.image.layers[0].pixels, 70 * 50 * 4 * sizeof(float));
            assert_memory_equal(r.result.stats.count, first.result.stats.count,
                                sizeof r.result.stats.count);
            done(&r);
        }
        done(&first);
    }
}

static void light_layers_add_up_to_the_beauty(void **state)
{
    (void)state;
    const char *text =
        HEAD "camera { location <0,3,-7> look_at <0,1,0> angle 45 }"
             "global_settings { photons { count 5000 } }"
             "light_source { <2,8,-3> rgb 1 }"
             "plane { y, 0 pigment { rgb 0.8 } finish { reflection { 0.2 exponent 1.5 } } }"
             "sphere { <0,1.2,0>, 1 pigment { rgbf 0.95 } interior { ior 1.5 }"
             " photons { target refraction on } }";
    RenderOptions options = options_for(40, 30);
    options.aa = AA_POV1;
    options.layers = LAYER_DIRECT | LAYER_CAUSTIC | LAYER_INDIRECT | LAYER_Z | LAYER_N;
    options.plan.has_indirect = true;
    Rendered r = render(text, &options);
    assert_int_equal(r.status, OK);
    double parts[3] = {0};
    for (int y = 0; y < 30; y++)
        for (int x = 0; x < 40; x++) {
            const float *beauty = pixel(&r, "", x, y);
            const float *direct = pixel(&r, "direct", x, y), *caustic = pixel(&r, "caustic", x, y);
            const float *indirect = pixel(&r, "indirect", x, y);
            for (int c = 0; c < 3; c++) {
                double sum = (double)direct[c] + (double)caustic[c] + (double)indirect[c];
                assert_near(beauty[c], sum, 2e-6 * (1 + fabs(sum)));
                parts[0] += (double)direct[c];
                parts[1] += (double)caustic[c];
                parts[2] += (double)indirect[c];
            }
        }
    assert_true(parts[0] > 0 && parts[1] > 0 && parts[2] > 0);
    done(&r);
}

static void data_layers_describe_the_first_surface(void **state)
{
    (void)state;
    RenderOptions options = options_for(8, 6);
    options.layers = LAYER_Z | LAYER_N | LAYER_ALBEDO;
    Rendered r =
        render(HEAD LOOK_DOWN "box { <-4,0,-4>, <0,1,4> pigment { rgb <0.1,0.2,0.3> } }", &options);
    assert_int_equal(r.status, OK);
    assert_near(pixel(&r, "Z", 1, 1)[0], 9, 1e-6);
    assert_near(pixel(&r, "N", 1, 1)[1], 1, 1e-6);
    assert_near(pixel(&r, "albedo", 1, 1)[2], 0.3, 1e-6);
    assert_true(isinf(pixel(&r, "Z", 6, 1)[0]));
    assert_true(pixel(&r, "N", 6, 1)[1] == 0 && pixel(&r, "albedo", 6, 1)[0] == 0);
    done(&r);
}

static void interrupt_at_half(void *ctx, const RenderProgress *progress)
{
    (void)ctx;
    if (progress->fraction > 0.5)
        work_interrupted = 1;
}

static void an_interrupted_render_leaves_no_image(void **state)
{
    (void)state;
    RenderOptions options = options_for(160, 120);
    options.progress = interrupt_at_half;
    Rendered r = render(EVERYTHING, &options);
    work_interrupted = 0;
    assert_int_equal(r.status, ERR_INTERRUPTED);
    assert_null(r.result.image.layers);
    done(&r);
}

typedef struct Watched {
    double last;
    int calls, ends;
} Watched;

static void watch(void *ctx, const RenderProgress *progress)
{
    Watched *watched = ctx;
    assert_true(progress->fraction >= watched->last && progress->fraction <= 1);
    assert_true(progress->fraction < 1 || progress->seconds_left == 0);
    watched->last = progress->fraction;
    watched->calls++;
    watched->ends += progress->fraction == 1;
}

static void progress_grows_and_ends_once(void **state)
{
    (void)state;
    Watched watched = {0};
    RenderOptions options = options_for(100, 80);
    options.aa = AA_POV1;
    options.threads = 2;
    options.progress = watch;
    options.progress_ctx = &watched;
    Rendered r = render(HEAD LOOK_DOWN "plane { y, 0 }", &options);
    assert_int_equal(r.status, OK);
    assert_true(watched.calls > 1 && watched.ends == 1 && watched.last == 1);
    done(&r);
}

static void sizes_that_make_no_sense_are_refused(void **state)
{
    (void)state;
    const int sizes[][2] = {{0, 10}, {10, 0}, {-1, 10}, {IMAGE_SIDE_MAX + 1, 1}};
    for (size_t i = 0; i < 4; i++) {
        RenderOptions options = options_for(sizes[i][0], sizes[i][1]);
        RenderResult result;
        Scene scene = {0};
        Diag diag;
        diag_init(&diag, quiet, NULL);
        assert_int_equal(render_scene(&scene, &options, &diag, &result), ERR_USAGE);
        assert_int_equal(diag.errors, 1);
        diag_done(&diag);
    }
}

static void an_empty_scene_is_black(void **state)
{
    (void)state;
    RenderOptions options = options_for(1, 1);
    options.has_alpha = true;
    Rendered r = render(HEAD, &options);
    assert_int_equal(r.status, OK);
    for (int c = 0; c < 4; c++)
        assert_true(pixel(&r, "", 0, 0)[c] == 0);
    done(&r);
}

/* One pixel of a scene seen from above. */
static void one_pixel(const char *text, RenderOptions options, float out[4])
{
    options.width = options.height = 1;
    Rendered r = render(text, &options);
    assert_int_equal(r.status, OK);
    memcpy(out, pixel(&r, "", 0, 0), 4 * sizeof *out);
    done(&r);
}

static void a_white_surface_facing_a_white_light_is_one(void **state)
{
    (void)state;
    float c[4];
    one_pixel(HEAD LOOK_DOWN "light_source { <0,1000,0> rgb 1 }"
                             "plane { y, 0 pigment { rgb 1 } finish { diffuse 1 ambient 0 } }",
              RENDER_OPTIONS_DEFAULT, c);
    assert_near(c[0], 1, 1e-6);
    assert_near(c[3], 1, 0);
}

static void alpha_is_what_surfaces_and_background_keep(void **state)
{
    (void)state;
    const struct {
        const char *text;
        double alpha;
    } cases[] = {
        {"", 0},
        {"background { rgb <0.2,0.4,0.6> }", 1},
        {"background { rgbt <0.2,0.4,0.6,0.3> }", 0.7},
        {"disc { 0, y, 9 pigment { rgbt 0.4 } }", 0.6},
        {"disc { 0, y, 9 pigment { rgbf <1,0.5,0.2,0.4> } }", 0.7543},
        {"disc { 0, y, 9 pigment { rgb 0 } finish { reflection 1 } }", 1},
        {"sky_sphere { pigment { rgbt 0.5 } }", 0.5},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[512];
        float c[4];
        RenderOptions options = RENDER_OPTIONS_DEFAULT;
        snprintf(text, sizeof text, HEAD LOOK_DOWN "%s", cases[i].text);
        options.has_alpha = true;
        one_pixel(text, options, c);
        assert_near(c[3], cases[i].alpha, 1e-4);
        options.has_alpha = false;
        one_pixel(text, options, c);
        assert_near(c[3], 1, 0);
    }
}

static void mirrors_show_the_background_whole(void **state)
{
    (void)state;
    const char *text = HEAD LOOK_DOWN "background { rgbt <0.2,0.4,0.6,0.5> }"
                                      "disc { 0, y, 9 pigment { rgb 0 }"
                                      " finish { ambient 0 reflection 1 } }";
    float c[4];
    RenderOptions options = RENDER_OPTIONS_DEFAULT;
    one_pixel(text, options, c);
    assert_near(c[2], 0.3, 1e-6);
    options.has_alpha = true;
    one_pixel(text, options, c);
    assert_near(c[2], 0.6, 1e-6);
}

static void trace_levels_count_surfaces_seen(void **state)
{
    (void)state;
    for (int level = 1; level <= 7; level += 2) {
        char text[512];
        snprintf(text, sizeof text,
                 "#version 3.7; global_settings { assumed_gamma 1 max_trace_level %d"
                 " adc_bailout 0 } " LOOK_DOWN
                 "disc { 0, y, 9 pigment { rgb 1 } finish { emission 0.01 reflection 1 } }"
                 "disc { <0,11,0>, y, 9 no_image pigment { rgb 1 }"
                 " finish { emission 0.01 reflection 1 } } #default { finish { ambient 0 } }",
                 level);
        float c[4];
        one_pixel(text, RENDER_OPTIONS_DEFAULT, c);
        assert_near(c[0], 0.11 * level, 1e-5); /* emission 0.01 and ambient 0.1 each */
    }
}

static void straight_rays_need_no_level_but_one(void **state)
{
    (void)state;
    const char *format =
        "#version 3.7; global_settings { assumed_gamma 1 max_trace_level %d } " LOOK_DOWN
        "background { rgb 1 }"
        "#declare I = 0; #while (I < 20) disc { <0,I/4,0>, y, 9"
        " pigment { rgbt 1 } } #declare I = I + 1; #end";
    for (int level = 1; level <= 2; level++) {
        char text[512];
        float c[4];
        snprintf(text, sizeof text, format, level);
        one_pixel(text, RENDER_OPTIONS_DEFAULT, c);
        assert_near(c[0], level == 1 ? 0 : 1, 1e-6);
    }
}

static void weights_below_adc_bailout_are_not_followed(void **state)
{
    (void)state;
    const char *format =
        "#version 3.7; global_settings { assumed_gamma 1 adc_bailout 0.1 } " LOOK_DOWN
        "background { rgb 1 } disc { 0, y, 9 pigment { rgb 0 }"
        " finish { ambient 0 reflection %g } }";
    for (int i = 0; i < 2; i++) {
        char text[512];
        float c[4];
        snprintf(text, sizeof text, format, i == 0 ? 0.09 : 0.11);
        one_pixel(text, RENDER_OPTIONS_DEFAULT, c);
        assert_near(c[0], i == 0 ? 0 : 0.11, 1e-6);
    }
}

static void quality_1_shows_pigments_unlit(void **state)
{
    (void)state;
    float c[4];
    RenderOptions options = RENDER_OPTIONS_DEFAULT;
    options.plan.quality = 1;
    one_pixel(HEAD LOOK_DOWN "plane { y, 0 pigment { rgb <0.2,0.4,0.6> } finish { reflection 1 } }",
              options, c);
    assert_near(c[1], 0.4, 1e-6);
}

/* The shadow edge of a bar under a grid of lights; the shades are POV-Ray's. */
static void area_light_edges(const char *light, const double *want, int first, int count)
{
    char text[768];
    snprintf(text, sizeof text,
             HEAD LOOK_DOWN "light_source { %s } plane { y, 0 pigment { rgb 1 }"
                            " finish { ambient 0 diffuse 1 } } %s",
             light,
             strstr(light, "parallel") ? "box { <-8,2,-1>, <3,2.1,1> no_image }"
                                       : "box { <-8,5,-8>, <0,5.1,8> no_image }");
    RenderOptions options = options_for(80, 60);
    Rendered r = render(text, &options);
    assert_int_equal(r.status, OK);
    for (int i = 0; i < count; i++)
        assert_near(pixel(&r, "", first + i, 30)[0], want[i], 1e-4);
    done(&r);
}

static void adaptive_area_lights_average_as_the_language_does(void **state)
{
    (void)state;
    const double bright[] = {0.18747, 0.31247, 0.43749, 0.43749, 0.56249,
                             0.56248, 0.68745, 0.81238, 0.8123};
    area_light_edges("<0,20,0> rgb 1 area_light <4,0,0>, <0,0,4>, 9, 9 adaptive 0", bright, 36, 9);
}

static void adaptive_area_lights_see_edges_by_brightness(void **state)
{
    (void)state;
    /* Too dim a light for its corners to differ: never divided.  0.02 of POV-Ray's 0.5. */
    const double dim[] = {0.0099998, 0.0099999, 0.01, 0.01, 0.01};
    area_light_edges("<0,20,0> rgb 0.02 area_light <4,0,0>, <0,0,4>, 9, 9 adaptive 0", dim, 36, 5);
}

static void parallel_area_lights_shift_their_rays(void **state)
{
    (void)state;
    const double want[] = {0, 0, 0.125, 0.375, 0.625, 0.875, 1, 1};
    area_light_edges("<0,20,0> rgb 1 parallel point_at 0 area_light <4,0,0>, <0,0,4>, 5, 1", want,
                     66, 8);
}

static void assumed_gamma_makes_linear_values(void **state)
{
    (void)state;
    float c[4];
    one_pixel("#version 3.7; global_settings { assumed_gamma 2.2 } " LOOK_DOWN
              "background { rgb 0.5 }",
              RENDER_OPTIONS_DEFAULT, c);
    assert_near(c[0], pow(0.5, 2.2), 1e-6);
}

static void samples_that_are_not_numbers_are_counted_and_dropped(void **state)
{
    (void)state;
    RenderOptions options = options_for(4, 4);
    Rendered r = render(
        HEAD LOOK_DOWN "plane { y, 0 pigment { rgb 1e30 } finish { ambient 1e30 } }", &options);
    assert_int_equal(r.status, OK);
    assert_int_equal(r.result.stats.count[STAT_NAN_SAMPLE], 16);
    assert_true(pixel(&r, "", 0, 0)[0] == 0);
    done(&r);
}

static void keep_text(void *ctx, const char *text)
{
    char *kept = ctx;
    strncat(kept, text, 4095 - strlen(kept));
}

/* The one warning names pixel, sample and place; only what shows the fault is black. */
static void what_made_a_sample_no_number_is_told_once(void **state)
{
    (void)state;
    static const char text[] =
        HEAD LOOK_DOWN "plane { y, -1 pigment { rgb 1 } finish { ambient 1 diffuse 0 } }\n"
                       "sphere { <0,1,0>, 0.5 pigment { rgb 1e30 } finish { ambient 1e30 } }";
    char said[4096] = "", place[64];
    Rendered r = {0};
    RenderOptions options = options_for(9, 9);
    SdlOptions sdl = {.width = 9, .height = 9, .threads = 1};
    options.threads = 3;
    diag_init(&r.diag, keep_text, said);
    assert_int_equal(sdl_load_text(&r.diag, "test.pms", text, strlen(text), &sdl, &r.scene), OK);
    assert_int_equal(render_scene(r.scene, &options, &r.diag, &r.result), OK);
    int bad = 0, first = -1;
    for (int i = 0; i < 81; i++) {
        bool is_black = pixel(&r, "", i % 9, i / 9)[0] == 0;
        bad += is_black;
        first = is_black && first < 0 ? i : first;
    }
    assert_true(bad > 0 && bad < 81);
    assert_int_equal(r.result.stats.count[STAT_NAN_SAMPLE], bad);
    snprintf(place, sizeof place, "sample 0 of pixel %d,%d, the first of %d", first % 9, first / 9,
             bad);
    assert_non_null(strstr(said, "test.pms:2:1: warning"));
    assert_non_null(strstr(said, place));
    assert_null(strstr(strstr(said, "no number") + 1, "no number"));
    done(&r);
}

typedef struct Story {
    int steps, faults, samples, lost;
    float red; /* of the last sample */
} Story;

static void story_step(void *ctx, const EyeStep *step)
{
    Story *story = ctx;
    story->steps++;
    story->faults += !eye_step_is_finite(step);
}

static void story_sample(void *ctx, double x, double y, uint32_t index, const EyeSample *sample)
{
    Story *story = ctx;
    (void)x, (void)y, (void)index;
    story->samples++;
    story->lost += !sample;
    if (sample)
        story->red = sample->part[PART_DIRECT].r;
}

/* A pixel by itself is that of the whole picture, whatever the antialiasing. */
static void a_pixel_is_replayed_with_its_samples(void **state)
{
    (void)state;
    static const char text[] = HEAD LOOK_DOWN
        "plane { y, 0 pigment { checker rgb 1, rgb x scale 0.3 } finish { ambient 1 diffuse 0\n"
        "  reflection 0.5 } }\n"
        "sphere { <0,1,0>, 0.5 pigment { rgb 1e30 } finish { ambient 1e30 } }";
    for (int aa = AA_NONE; aa <= AA_UNIFORM; aa++) {
        RenderOptions options = options_for(48, 40);
        options.aa = (AaMethod)aa;
        options.samples = 5;
        Rendered whole = render(text, &options);
        for (int x = 1; x < 48; x += 15) {
            Story story = {0};
            Replay replay = {x, 20, {story_step, &story}, story_sample};
            options.replay = &replay;
            Rendered one = render(text, &options);
            assert_memory_equal(pixel(&one, "", x, 20), pixel(&whole, "", x, 20),
                                4 * sizeof(float));
            assert_true(story.samples >= (aa == AA_UNIFORM ? 5 : 1));
            assert_true(story.steps >= story.samples);
            assert_true((story.faults > 0) == (story.lost > 0));
            if (aa == AA_NONE && !story.lost)
                assert_true(story.red == pixel(&whole, "", x, 20)[0]);
            done(&one);
            options.replay = NULL;
        }
        done(&whole);
    }
}

static void opaque_scenes_cost_no_photons_and_no_filters(void **state)
{
    (void)state;
    RenderOptions options = options_for(20, 15);
    Rendered r = render(HEAD "global_settings { photons { count 1000 } }" LOOK_DOWN
                             "light_source { <3,9,0> rgb 1 } plane { y, 0 pigment { rgb 1 } }"
                             "sphere { y, 1 pigment { rgb x } }",
                        &options);
    assert_int_equal(r.status, OK);
    const uint64_t *count = r.result.stats.count;
    assert_true(count[STAT_PHOTONS_EMITTED] == 0 && count[STAT_SHADOW_FILTER_WALKS] == 0);
    assert_true(count[STAT_GATHERS] == 0 && r.result.caustic_hash == 0);
    assert_int_equal(count[STAT_PIXELS], 300);
    assert_int_equal(count[STAT_CAMERA_RAYS], 300);
    assert_true(count[STAT_SHADOW_RAYS] <= 300);
    done(&r);
}

static void focal_blur_spreads_an_edge_over_the_lens(void **state)
{
    (void)state;
    /* A wall's edge at distance 20, focus at 10: the blur disk has radius aperture/4 there, so
     * the edge profile runs from dark to bright over 2 * 0.25 scene units. */
    const char *text = HEAD "camera { location 0 direction z right 2*x up y aperture 1"
                            " focal_point <0,0,10> blur_samples 400 variance 0 }"
                            "box { <0,-20,20>, <90,20,21> pigment { rgb 1 }"
                            " finish { emission 1 ambient 0 diffuse 0 } }";
    RenderOptions options = options_for(800, 1);
    Rendered r = render(text, &options);
    assert_int_equal(r.status, OK);
    /* A pixel is 40/800 = 0.05 wide on the wall.  The share of a disk of radius 0.25 right of a
     * line at offset d from its centre: 1/2 + (d sqrt(R2-d2) + R2 asin(d/R)) / (pi R2). */
    for (int i = -7; i < 7; i++) {
        double d = (i + 0.5) * 0.05, R = 0.25;
        double want =
            d <= -R  ? 0
            : d >= R ? 1
                     : 0.5 + (d * sqrt(R * R - d * d) + R * R * asin(d / R)) / (PMS_PI * R * R);
        /* The pixel is a tenth of the disk wide; 400 stratified samples. */
        assert_near(pixel(&r, "", 400 + i, 0)[0], want, 0.02);
    }
    done(&r);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(any_number_of_threads_gives_the_same_bytes),
        cmocka_unit_test(light_layers_add_up_to_the_beauty),
        cmocka_unit_test(data_layers_describe_the_first_surface),
        cmocka_unit_test(an_interrupted_render_leaves_no_image),
        cmocka_unit_test(progress_grows_and_ends_once),
        cmocka_unit_test(sizes_that_make_no_sense_are_refused),
        cmocka_unit_test(an_empty_scene_is_black),
        cmocka_unit_test(a_white_surface_facing_a_white_light_is_one),
        cmocka_unit_test(alpha_is_what_surfaces_and_background_keep),
        cmocka_unit_test(mirrors_show_the_background_whole),
        cmocka_unit_test(trace_levels_count_surfaces_seen),
        cmocka_unit_test(straight_rays_need_no_level_but_one),
        cmocka_unit_test(weights_below_adc_bailout_are_not_followed),
        cmocka_unit_test(quality_1_shows_pigments_unlit),
        cmocka_unit_test(adaptive_area_lights_average_as_the_language_does),
        cmocka_unit_test(adaptive_area_lights_see_edges_by_brightness),
        cmocka_unit_test(parallel_area_lights_shift_their_rays),
        cmocka_unit_test(assumed_gamma_makes_linear_values),
        cmocka_unit_test(samples_that_are_not_numbers_are_counted_and_dropped),
        cmocka_unit_test(what_made_a_sample_no_number_is_told_once),
        cmocka_unit_test(a_pixel_is_replayed_with_its_samples),
        cmocka_unit_test(opaque_scenes_cost_no_photons_and_no_filters),
        cmocka_unit_test(focal_blur_spreads_an_edge_over_the_lens),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
