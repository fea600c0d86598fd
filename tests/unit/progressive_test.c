/* Renders of many passes: the same bytes however they are cut up, whole pictures whenever they
 * end, and the mean that single renders have.  SPDX-License-Identifier: Apache-2.0 */
#include "render/progressive.h"

#include "base/work.h"
#include "sdl/sdl.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "folder.h"
#include "quiet.h"

enum { WIDTH = 32, HEIGHT = 24 };

/* A bit of everything that draws random numbers. */
static const char EVERYTHING[] =
    "#version 3.7; global_settings { assumed_gamma 1 photons { count 500 }\n"
    "  pms { gi on global_photons 500 } }\n"
    "camera { location <0,3,-7> look_at <0,1,0> angle 45 aperture 0.4 focal_point <0,1,0>\n"
    "  blur_samples 12 }\n"
    "light_source { <5,8,-6> rgb 1 area_light <3,0,0>, <0,0,3>, 3, 3 jitter }\n"
    "plane { y, 0 pigment { checker rgb 0.9 rgb 0.3 } }\n"
    "sphere { 0, 15 hollow pigment { rgb 0.7 } }\n"
    "sphere { <-1,1,0>, 1 pigment { rgbf 0.9 } finish { phong 1 reflection 0.2 }\n"
    "  interior { ior 1.5 } photons { target refraction on } }\n"
    "box { <0.3,0,-0.8>, <1.8,1.5,0.7> pigment { rgb <0.2,0.7,0.3> } }\n";

typedef struct Run {
    RenderOptions options;
    const char *scene;
    Diag *diag;
    RenderResult result;
    /* what happened meanwhile */
    int shown;
    uint64_t shown_at[32];
    float shown_pixel[32];
    uint64_t fail_from;            /* showing fails from this pass on */
    uint64_t end_in, interrupt_in; /* passes in which Ctrl-C or SIGTERM comes */
    volatile sig_atomic_t *flag;
} Run;

static Run new_run(const char *scene)
{
    Run run = {.options = RENDER_OPTIONS_DEFAULT, .scene = scene};
    run.options.width = WIDTH;
    run.options.height = HEIGHT;
    run.options.plan.is_progressive = true;
    return run;
}

static Status see(void *ctx, RenderResult *so_far)
{
    Run *run = ctx;
    run->shown_at[run->shown] = so_far->passes;
    run->shown_pixel[run->shown++] = so_far->image.layers[0].pixels[1000];
    return run->fail_from && so_far->passes >= run->fail_from ? ERR_FILE : OK;
}

static void signals(void *ctx, const RenderProgress *progress)
{
    Run *run = ctx;
    if (progress->pass && progress->pass == run->end_in)
        work_ending = 1;
    if (progress->pass && progress->pass == run->interrupt_in)
        work_interrupted = 1;
}

static Status go(Run *run)
{
    SdlOptions sdl = {.width = WIDTH, .height = HEIGHT, .threads = 1};
    Scene *scene;
    run->diag = quiet();
    run->options.progressive.show = see;
    run->options.progressive.show_ctx = run;
    run->options.progress = signals;
    run->options.progress_ctx = run;
    assert_int_equal(
        sdl_load_text(run->diag, "test.pms", run->scene, strlen(run->scene), &sdl, &scene), OK);
    Status status = render_scene(scene, &run->options, run->diag, &run->result);
    scene_free(scene);
    assert_false(work_interrupted || work_ending || work_is_patient);
    return status;
}

static Run passes(const char *scene, uint64_t count)
{
    Run run = new_run(scene);
    run.options.progressive.passes = count;
    assert_int_equal(go(&run), OK);
    assert_int_equal(run.result.passes, count);
    return run;
}

static void assert_same_picture(const Run *a, const Run *b)
{
    assert_int_equal(a->result.image.layer_count, b->result.image.layer_count);
    for (int i = 0; i < a->result.image.layer_count; i++) {
        const ImageLayer *layer = &a->result.image.layers[i];
        size_t size = (size_t)layer->channel_count * WIDTH * HEIGHT * sizeof(float);
        assert_memory_equal(layer->pixels, b->result.image.layers[i].pixels, size);
    }
}

static void done(Run *run)
{
    render_result_done(&run->result);
}

static void passes_may_be_spread_over_runs_and_threads(void **state)
{
    (void)state;
    char *bytes[2];
    size_t sizes[2];
    Run runs[2];
    const char *paths[2] = {in_folder("whole"), in_folder("parts")};
    for (int i = 0; i < 2; i++) {
        runs[i] = new_run(EVERYTHING);
        runs[i].options.progressive.state_path = paths[i];
        runs[i].options.progressive.is_resumed = true; /* from nothing, at first */
        runs[i].options.layers = LAYER_DIRECT | LAYER_CAUSTIC | LAYER_INDIRECT | LAYER_Z | LAYER_N;
    }
    runs[0].options.progressive.passes = 7;
    assert_int_equal(go(&runs[0]), OK);
    const int ends[] = {1, 3, 6, 7, 7};
    for (int i = 0; i < 5; i++) {
        runs[1].options.progressive.passes = (uint64_t)ends[i];
        runs[1].options.threads = 1 + i;
        if (i > 0)
            done(&runs[1]);
        assert_int_equal(go(&runs[1]), OK);
        assert_int_equal(runs[1].result.new_passes, ends[i] - (i > 0 ? ends[i - 1] : 0));
    }
    assert_same_picture(&runs[0], &runs[1]);
    for (int i = 0; i < 2; i++)
        sizes[i] = slurp(paths[i], &bytes[i]);
    assert_int_equal(sizes[0], sizes[1]);
    assert_memory_equal(bytes[0], bytes[1], sizes[0]);
    assert_memory_equal(&runs[0].result.last_radii, &runs[1].result.last_radii, sizeof(PassRadii));
    assert_true(runs[0].result.last_radii.caustic < runs[0].result.first_radii.caustic);
    assert_true(runs[0].result.last_radii.global < runs[0].result.first_radii.global);
    for (int i = 0; i < 2; i++) {
        free(bytes[i]);
        done(&runs[i]);
    }
}

static void every_pass_is_another(void **state)
{
    (void)state;
    Run one = passes(EVERYTHING, 1), two = passes(EVERYTHING, 2), seed = new_run(EVERYTHING);
    assert_true(one.result.caustic_hash && one.result.global_hash);
    assert_true(one.result.caustic_hash != two.result.caustic_hash);
    assert_true(one.result.global_hash != two.result.global_hash);
    assert_int_equal(two.result.stats.count[STAT_SAMPLES], 2 * WIDTH * HEIGHT);
    assert_int_equal(two.result.stats.count[STAT_PIXELS], WIDTH * HEIGHT);
    assert_int_equal(two.result.books.caustic[0].emitted + two.result.books.global[0].emitted,
                     two.result.stats.count[STAT_PHOTONS_EMITTED]);
    double flux = (double)two.result.books.global[0].flux_emitted.g;
    assert_true(fabs(flux / (double)one.result.books.global[0].flux_emitted.g - 1) < 0.2);
    seed.options.progressive.passes = 1;
    seed.options.seed = 1;
    assert_int_equal(go(&seed), OK);
    assert_true(one.result.caustic_hash != seed.result.caustic_hash);
    done(&one);
    done(&two);
    done(&seed);
}

/* The product of (j + a) / (j + 1) is a quotient of gamma functions, and goes as passes^(a - 1). */
static void radii_shrink_by_the_rule(void **state)
{
    (void)state;
    const double a = 2.0 / 3;
    assert_true(progressive_shrink(1) == 1);
    assert_true(fabs(progressive_shrink(2) - sqrt((1 + a) / 2)) < 1e-15);
    for (uint64_t n = 2; n <= 200000; n *= 10) {
        double x = (double)n, expected = exp(lgamma(x + a) - lgamma(1 + a) - lgamma(x + 1));
        double square = progressive_shrink(n) * progressive_shrink(n);
        assert_true(fabs(square / expected - 1) < 1e-9);
    }
    /* Far off by the first term of its expansion, at once; near the seam by the factors. */
    double far = progressive_shrink(UINT32_MAX);
    double expected = pow((double)UINT32_MAX + a / 2, (a - 1) / 2) / sqrt(tgamma(1 + a));
    assert_true(fabs(far / expected - 1) < 1e-12);
    for (uint64_t n = 4000; n < 4200; n++) {
        double step = progressive_shrink(n + 1) / progressive_shrink(n), x = (double)n;
        assert_true(fabs(step - sqrt((x + a) / (x + 1))) < 1e-14);
    }
    Run run = passes(EVERYTHING, 5);
    double ratio = run.result.last_radii.caustic / run.result.first_radii.caustic;
    assert_true(fabs(ratio / progressive_shrink(5) - 1) < 1e-12);
    ratio = run.result.last_radii.global / run.result.first_radii.global;
    assert_true(fabs(ratio / progressive_shrink(5) - 1) < 1e-12);
    done(&run);
}

static void pictures_are_shown_at_powers_of_two(void **state)
{
    (void)state;
    Run nine = passes(EVERYTHING, 9);
    assert_int_equal(nine.shown, 4); /* the ninth is the result */
    for (int i = 0; i < nine.shown; i++) {
        assert_int_equal(nine.shown_at[i], 1 << i);
        Run so_far = passes(EVERYTHING, (uint64_t)1 << i);
        assert_true(so_far.result.image.layers[0].pixels[1000] == nine.shown_pixel[i]);
        done(&so_far);
    }
    done(&nine);
}

/* Ctrl-C lets the pass at hand be finished; SIGTERM leaves it out. */
static void an_interrupted_render_has_whole_passes(void **state)
{
    (void)state;
    Run three = passes(EVERYTHING, 3), ended = new_run(EVERYTHING), cut = new_run(EVERYTHING);
    ended.end_in = 3;
    assert_int_equal(go(&ended), ERR_INTERRUPTED);
    assert_int_equal(ended.result.passes, 3);
    assert_same_picture(&three, &ended);
    cut.interrupt_in = 4;
    cut.options.threads = 2;
    assert_int_equal(go(&cut), ERR_INTERRUPTED);
    assert_int_equal(cut.result.passes, 3);
    assert_same_picture(&three, &cut);
    done(&ended);
    done(&cut);
    ended.end_in = cut.interrupt_in = 1;
    assert_int_equal(go(&ended), ERR_INTERRUPTED);
    assert_int_equal(ended.result.passes, 1);
    work_interrupted = 0;
    cut.result = (RenderResult){0};
    SdlOptions sdl = {.width = WIDTH, .height = HEIGHT, .threads = 1};
    Scene *scene;
    Diag *diag = quiet();
    sdl_load_text(diag, "test.pms", EVERYTHING, strlen(EVERYTHING), &sdl, &scene);
    assert_int_equal(render_scene(scene, &cut.options, diag, &cut.result), ERR_INTERRUPTED);
    assert_int_equal(cut.result.image.layer_count, 0);
    work_interrupted = 0;
    scene_free(scene);
    done(&ended);
    done(&cut);
    done(&three);
}

/* However short the time, there is a pass of either half: every pixel is there, and its error
 * known.
 */
static void time_ends_a_render_after_a_pass_of_each_half(void **state)
{
    (void)state;
    Run run = new_run(EVERYTHING);
    run.options.progressive.seconds = 1e-9;
    assert_int_equal(go(&run), OK);
    assert_int_equal(run.result.passes, 2);
    assert_true(run.result.error.is_known);
    done(&run);
    run.options.progressive.seconds = 1e9;
    run.options.progressive.passes = 2;
    assert_int_equal(go(&run), OK);
    assert_int_equal(run.result.passes, 2);
    done(&run);
}

/* Passes end when the bound is found to be below what is wanted: not with the first plan. */
static void an_error_wanted_ends_a_render(void **state)
{
    (void)state;
    Run few = passes(EVERYTHING, 4), run = new_run(EVERYTHING);
    run.options.progressive.error = 0.5 * few.result.error.bound;
    assert_int_equal(go(&run), OK);
    assert_true(run.result.passes > 4 && run.result.error.bound <= run.options.progressive.error);
    assert_true(run.result.error.whole <= run.result.error.bound);
    done(&few);
    done(&run);
}

/* Where it ends is the same whether pictures are shown, which measures them, or not; and going on
 * from the end makes no pass more. */
static void showing_ends_no_render(void **state)
{
    (void)state;
    Run few = passes(EVERYTHING, 4), plain = new_run(EVERYTHING), kept = new_run(EVERYTHING);
    plain.options.progressive.error = kept.options.progressive.error = 0.7 * few.result.error.bound;
    assert_int_equal(go(&plain), OK);
    kept.options.progressive.state_path = in_folder("shown");
    assert_int_equal(go(&kept), OK);
    assert_int_equal(kept.result.passes, plain.result.passes);
    done(&kept);
    kept.options.progressive.is_resumed = true;
    assert_int_equal(go(&kept), OK);
    assert_int_equal(kept.result.passes, plain.result.passes);
    assert_int_equal(kept.result.new_passes, 0);
    done(&few);
    done(&plain);
    done(&kept);
}

/* The plan is kept with the sums: 4 passes, 2 of the next plan, and the rest. */
static void a_steered_render_may_be_spread_over_runs_and_threads(void **state)
{
    (void)state;
    Run whole = new_run(EVERYTHING), parts;
    whole.options.progressive.error = 1e-4;
    whole.options.progressive.passes = 11;
    assert_int_equal(go(&whole), OK);
    const uint64_t ends[] = {3, 6, 11};
    for (int i = 0; i < 3; i++) {
        parts = new_run(EVERYTHING);
        parts.options.progressive.error = 1e-4;
        parts.options.progressive.passes = ends[i];
        parts.options.progressive.state_path = in_folder("steered");
        parts.options.progressive.is_resumed = i > 0;
        parts.options.threads = 1 + i;
        assert_int_equal(go(&parts), OK);
        if (i < 2)
            done(&parts);
    }
    assert_same_picture(&whole, &parts);
    Run even = passes(EVERYTHING, 11); /* steering does something */
    size_t size = (size_t)WIDTH * HEIGHT * 4 * sizeof(float);
    assert_int_not_equal(
        memcmp(whole.result.image.layers[0].pixels, even.result.image.layers[0].pixels, size), 0);
    done(&whole);
    done(&parts);
    done(&even);
}

/* What cannot be shown first ends the render; what cannot be shown later does not. */
static void a_full_disk_stops_only_the_beginning(void **state)
{
    (void)state;
    Run run = new_run(EVERYTHING);
    run.options.progressive.passes = 5;
    run.fail_from = 1;
    assert_int_equal(go(&run), ERR_FILE);
    assert_int_equal(run.result.new_passes, 1);
    done(&run);
    run.fail_from = 2;
    run.shown = 0;
    assert_int_equal(go(&run), OK);
    assert_int_equal(run.result.passes, 5);
    assert_int_equal(run.shown, 3);
    done(&run);
    run.fail_from = 0;
    run.options.progressive.state_path = "/no/such/folder/state";
    assert_int_equal(go(&run), ERR_FILE);
    done(&run);
}

static void a_state_of_more_passes_is_shown_as_it_is(void **state)
{
    (void)state;
    Run run = new_run(EVERYTHING);
    run.options.progressive.state_path = in_folder("more");
    run.options.progressive.passes = 3;
    assert_int_equal(go(&run), OK);
    Run again = run;
    again.options.progressive.is_resumed = true;
    again.options.progressive.passes = 2;
    assert_int_equal(go(&again), OK);
    assert_non_null(strstr(last_message, "has 3 passes already"));
    assert_int_equal(again.result.passes, 3);
    assert_same_picture(&run, &again);
    done(&again);
    again.options.seed = 5;
    assert_int_equal(go(&again), ERR_USAGE);
    done(&again);
    done(&run);
}

/* So few photons that some passes store none.  Light that the map stands for must not come
 * straight through the glass in these. */
static const char FEW[] =
    "#version 3.7; global_settings { assumed_gamma 1 photons { count 1 } }\n"
    "camera { orthographic location <0,0.4,0> direction -y right 0.2*x up 0.2*z }\n"
    "light_source { <0,6,0> rgb 1 }\n"
    "plane { y, 0 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
    "sphere { <0,1.5,0>, 1 pigment { rgbt 1 } finish { ambient 0 diffuse 0 reflection 0.9 }\n"
    "  interior { ior 1.5 } photons { target refraction on reflection on collect off } }\n";

static void an_empty_map_lets_no_light_through(void **state)
{
    (void)state;
    Run run = new_run(FEW);
    run.options.layers = LAYER_DIRECT;
    run.options.progressive.passes = 40;
    assert_int_equal(go(&run), OK);
    assert_in_range(run.result.stats.count[STAT_PHOTONS_CAUSTIC], 1, 39);
    const float *direct = image_find_layer(&run.result.image, "direct")->pixels;
    for (int i = 0; i < 3 * WIDTH * HEIGHT; i++)
        assert_true(direct[i] == 0);
    assert_int_equal(run.diag->warnings[WARN_RENDER] <= 1, 1);
    done(&run);
}

/* --- the mean -------------------------------------------------------------------------------- */

/* Means of blocks of 8 by 8 pixels. */
enum { BLOCKS = WIDTH / 8 * HEIGHT / 8 };

static void block_means(const Run *run, double means[BLOCKS])
{
    const float *pixels = run->result.image.layers[0].pixels;
    memset(means, 0, BLOCKS * sizeof *means);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            means[y / 8 * (WIDTH / 8) + x / 8] += (double)pixels[4 * (y * WIDTH + x) + 1] / 64;
}

/* Lenses, lights and pixels: many passes of single rays have the mean of one render of many rays,
 * within 4 standard errors of what differs between seeds. */
static void check_mean(const char *scene)
{
    enum { SEEDS = 8 };
    double sum[BLOCKS] = {0}, squares[BLOCKS] = {0}, expected[BLOCKS], means[BLOCKS];
    for (int seed = 0; seed < SEEDS; seed++) {
        Run run = new_run(scene);
        run.options.progressive.passes = 16;
        run.options.seed = (uint64_t)seed;
        assert_int_equal(go(&run), OK);
        block_means(&run, means);
        for (int i = 0; i < BLOCKS; i++) {
            sum[i] += means[i] / SEEDS;
            squares[i] += means[i] * means[i] / SEEDS;
        }
        done(&run);
    }
    Run single = new_run(scene);
    single.options.plan.is_progressive = false;
    single.options.aa = AA_UNIFORM;
    single.options.samples = 2048;
    assert_int_equal(go(&single), OK);
    block_means(&single, expected);
    double worst = 0;
    for (int i = 0; i < BLOCKS; i++) {
        double error = sqrt(fmax(0, squares[i] - sum[i] * sum[i]) / (SEEDS - 1)) + 1e-4;
        worst = fmax(worst, fabs(sum[i] - expected[i]) / error);
    }
    print_message("# worst difference of %d blocks: %.2f standard errors\n", BLOCKS, worst);
    assert_true(worst < 4.5); /* 4 would be met by chance in 1 of 200 blocks, with 8 seeds */
    done(&single);
}

#define HEAD "#version 3.7; global_settings { assumed_gamma 1 } "

static void the_mean_is_that_of_a_single_render(void **state)
{
    (void)state;
    check_mean(HEAD "camera { location <0,3,-7> look_at <0,1,0> angle 45 aperture 1.5"
                    " focal_point <0,1,0> blur_samples 64 variance 0 }"
                    "light_source { <5,8,-6> rgb 1 }"
                    "plane { y, 0 pigment { checker rgb 0.9 rgb 0.1 } }"
                    "box { <0.3,0,-2.8>, <1.8,1.5,-2> pigment { rgb <0.2,0.7,0.3> } }");
    check_mean(HEAD "camera { location <0,3,-7> look_at <0,1,0> angle 45 }"
                    "light_source { <5,8,-6> rgb 1 area_light <3,0,0>, <0,0,3>, 4, 5 jitter }"
                    "light_source { <-5,8,-6> rgb 1 area_light <3,0,0>, <0,0,3>, 3, 2"
                    " circular orient area_illumination jitter }"
                    "plane { y, 0 pigment { rgb 0.9 } finish { phong 1 phong_size 5 } }"
                    "box { <0.3,0,-0.8>, <1.8,1.5,0> pigment { rgb <0.2,0.7,0.3> } }");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(passes_may_be_spread_over_runs_and_threads),
        cmocka_unit_test(every_pass_is_another),
        cmocka_unit_test(radii_shrink_by_the_rule),
        cmocka_unit_test(pictures_are_shown_at_powers_of_two),
        cmocka_unit_test(an_interrupted_render_has_whole_passes),
        cmocka_unit_test(time_ends_a_render_after_a_pass_of_each_half),
        cmocka_unit_test(an_error_wanted_ends_a_render),
        cmocka_unit_test(showing_ends_no_render),
        cmocka_unit_test(a_steered_render_may_be_spread_over_runs_and_threads),
        cmocka_unit_test(a_full_disk_stops_only_the_beginning),
        cmocka_unit_test(a_state_of_more_passes_is_shown_as_it_is),
        cmocka_unit_test(an_empty_map_lets_no_light_through),
        cmocka_unit_test(the_mean_is_that_of_a_single_render),
    };
    return cmocka_run_group_tests_name("progressive", tests, make_folder, remove_folder);
}
