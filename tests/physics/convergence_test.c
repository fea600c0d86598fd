/* Progressive renders converge: the mean over passes is right from the first one on where the light
 * is even, and where it is not, noise and blur fall together with the number of passes.
 *
 * The caustic is that of a glass ball, as a fan of bent rays gives it.  PMS_LONG takes more seeds
 * and more passes.  SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "render/render.h"
#include "sdl/sdl.h"
#include "trace/trace.h"

#include "sphere_fan.h"
#include "table.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { SIDE = 32, PIXELS = SIDE * SIDE, SEEDS_MAX = 16, LEVELS_MAX = 12 };

/* Half the side of the picture, scene units. */
#define HALF 1.4

/* Pictures after 1, 2, 4 ... passes, of some seeds. */
typedef struct Series {
    int seeds, levels;
    LayerBit layer;
    float (*pictures)[LEVELS_MAX][PIXELS];
    int seed;
} Series;

static Status keep(void *ctx, RenderResult *so_far)
{
    Series *series = ctx;
    int level = 0;
    while ((uint64_t)1 << (level + 1) <= so_far->passes)
        level++;
    if ((uint64_t)1 << level != so_far->passes)
        return OK; /* shown because time has passed */
    const float *pixels = so_far->image.layers[series->layer ? 1 : 0].pixels;
    int channels = series->layer ? 3 : 4;
    for (int i = 0; i < PIXELS; i++)
        series->pictures[series->seed][level][i] = pixels[channels * i + 1];
    return OK;
}

static void run_seed(Series *series, const Scene *scene, Diag *diag)
{
    RenderResult result;
    RenderOptions options = RENDER_OPTIONS_DEFAULT;
    options.width = options.height = SIDE;
    options.threads = 2;
    options.seed = (uint64_t)series->seed + 1;
    options.layers = series->layer;
    options.plan.is_progressive = true;
    options.progressive.passes = (uint64_t)1 << (series->levels - 1);
    options.progressive.show = keep;
    options.progressive.show_ctx = series;
    assert_int_equal(render_scene(scene, &options, diag, &result), OK);
    keep(series, &result);
    render_result_done(&result);
}

/* Render a scene with seeds 1, 2 ...  Free the pictures. */
static Series run_series(const char *text, LayerBit layer, int seeds, int levels)
{
    Series series = {.seeds = seeds, .levels = levels, .layer = layer};
    series.pictures = calloc((size_t)seeds, sizeof *series.pictures);
    Diag diag;
    Scene *scene;
    SdlOptions sdl = {.width = SIDE, .height = SIDE, .threads = 1};
    diag_init(&diag, NULL, NULL);
    assert_int_equal(sdl_load_text(&diag, "test.pms", text, strlen(text), &sdl, &scene), OK);
    for (; series.seed < seeds; series.seed++)
        run_seed(&series, scene, &diag);
    scene_free(scene);
    diag_done(&diag);
    return series;
}

/* --- even light ----------------------------------------------------------------------------- */

/* The mean over the middle of the picture, and over seeds, at each number of passes. */
static void check_even(const char *what, const char *text, LayerBit layer, double expected)
{
    int seeds = table_is_long() ? SEEDS_MAX : 6, levels = table_is_long() ? 8 : 5;
    Series series = run_series(text, layer, seeds, levels);
    for (int level = 0; level < levels; level++) {
        double sum = 0, squares = 0;
        for (int seed = 0; seed < seeds; seed++) {
            double mean = 0;
            for (int i = 0; i < PIXELS; i++)
                mean += (double)series.pictures[seed][level][i] / PIXELS;
            sum += mean / seeds;
            squares += mean * mean / seeds;
        }
        double error = sqrt(fmax(0, squares - sum * sum) / (seeds - 1));
        char name[100];
        snprintf(name, sizeof name, "%s: mean of %d passes", what, 1 << level);
        table_row(name, sum, expected, error);
        assert_true(error < 0.01 * expected);
        assert_true(fabs(sum - expected) < 4.5 * error + 1e-6);
    }
    free(series.pictures);
}

/* Under a pane that bends nothing the caustic is the light that would come without it. */
static void even_light_is_right_from_the_first_pass(void **state)
{
    (void)state;
    const char *const kernels[] = {"flat", "cone", "gaussian"};
    for (int i = 0; i < 3; i++) {
        char text[1024], what[100];
        snprintf(text, sizeof text,
                 "#version 3.7; global_settings { assumed_gamma 1 photons { count 2000 }\n  pms { "
                 "kernel %s } }\n"
                 "camera { orthographic location <0,0.9,0> direction -y right x up z }\n"
                 "light_source { <0,3,0> rgb 1 parallel point_at 0 }\n"
                 "plane { y, 0 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
                 "box { <-2,1,-2>, <2,1.1,2> pigment { rgbt 1 } finish { ambient 0 diffuse 0 }\n"
                 "  interior { ior 1 } photons { target refraction on collect off } }\n",
                 kernels[i]);
        snprintf(what, sizeof what, "pane of ior 1, kernel %s", kernels[i]);
        check_even(what, text, LAYER_CAUSTIC, 1);
    }
}

/* In a closed sphere of reflectance 0.5 around a light of colour 1 radiance is 1. */
static void a_closed_sphere_is_evenly_lit(void **state)
{
    (void)state;
    const char *const methods[] = {"gather", "map"};
    for (int i = 0; i < 2; i++) {
        char text[1024], what[100];
        snprintf(text, sizeof text,
                 "#version 3.7; global_settings { assumed_gamma 1 max_trace_level 50\n"
                 "  pms { gi on gi_method %s global_photons 4000 } }\n"
                 "camera { location <0,0.3,0> look_at <0,0.2,1> angle 90 }\n"
                 "light_source { 0 rgb 1 }\n"
                 "sphere { 0, 1 hollow pigment { rgb 1 } finish { ambient 0 diffuse 0.5 } }\n",
                 methods[i]);
        snprintf(what, sizeof what, "closed sphere, gi_method %s", methods[i]);
        check_even(what, text, 0, 1);
    }
}

/* --- a caustic ------------------------------------------------------------------------------ */

enum { RINGS = 700 };
#define RING_WIDTH 0.003

/* Mean of the profile over each pixel; 0 where a pixel is not of the smooth part. */
static void fill_truth(double truth[PIXELS])
{
    enum { POINTS = 16 };
    double profile[RINGS], step = 2 * HALF / SIDE;
    fan_profile(profile, RINGS, RING_WIDTH);
    for (int i = 0; i < PIXELS; i++) {
        double x = (i % SIDE - SIDE / 2) * step, z = (SIDE / 2 - i / SIDE - 1) * step;
        double middle = hypot(x + step / 2, z + step / 2);
        truth[i] = 0;
        for (int k = 0; k < POINTS * POINTS && middle > 0.35 && middle < 1.3; k++) {
            double u = x + (k % POINTS + 0.5) / POINTS * step;
            double v = z + (k / POINTS + 0.5) / POINTS * step;
            truth[i] += profile[(int)(hypot(u, v) / RING_WIDTH)] / (POINTS * POINTS);
        }
    }
}

/* Mean over pixels of a squared relative error. */
static double mean_square(const double error[PIXELS], const double truth[PIXELS])
{
    double sum = 0;
    int count = 0;
    for (int i = 0; i < PIXELS; i++)
        if (truth[i] > 0) {
            sum += error[i] / truth[i] * (error[i] / truth[i]);
            count++;
        }
    return sum / count;
}

static double error_of_seed(const Series *series, int seed, int level, const double truth[PIXELS])
{
    double error[PIXELS];
    for (int i = 0; i < PIXELS; i++)
        error[i] = (double)series->pictures[seed][level][i] - truth[i];
    return mean_square(error, truth);
}

/* Slope of log error over log passes, from level `first` on. */
static double fit_slope(const double *errors, int first, int levels)
{
    double n = levels - first, x = 0, y = 0, xx = 0, xy = 0;
    for (int i = first; i < levels; i++) {
        double lx = i * log(2), ly = log(errors[i]);
        x += lx / n;
        y += ly / n;
        xx += lx * lx / n;
        xy += lx * ly / n;
    }
    return (xy - x * y) / (xx - x * x);
}

static double slope_of_seeds(const Series *series, const double truth[PIXELS], int first,
                             double *error)
{
    double sum = 0, squares = 0;
    for (int seed = 0; seed < series->seeds; seed++) {
        double errors[LEVELS_MAX];
        for (int level = 0; level < series->levels; level++)
            errors[level] = error_of_seed(series, seed, level, truth);
        double slope = fit_slope(errors, first, series->levels);
        sum += slope / series->seeds;
        squares += slope * slope / series->seeds;
    }
    *error = sqrt(fmax(0, squares - sum * sum) / (series->seeds - 1));
    return sum;
}

/* What of the squared error is blur and what is noise: the error of the mean over seeds, less the
 * noise that is left in it, and the scatter between seeds. */
static void split_error(const Series *series, int level, const double truth[PIXELS], double *noise,
                        double *blur)
{
    double bias[PIXELS], scatter[PIXELS];
    int seeds = series->seeds;
    for (int i = 0; i < PIXELS; i++) {
        double sum = 0, squares = 0;
        for (int seed = 0; seed < seeds; seed++) {
            double value = (double)series->pictures[seed][level][i];
            sum += value / seeds;
            squares += value * value / seeds;
        }
        bias[i] = sum - truth[i];
        scatter[i] = sqrt(fmax(0, squares - sum * sum) * seeds / (seeds - 1));
    }
    *noise = mean_square(scatter, truth);
    *blur = fmax(mean_square(bias, truth) - *noise / seeds, 1e-12);
}

/* Render a scene and fit how its error falls, over the pixels whose truth is not 0. */
static void check_fall(const char *what, const char *text, LayerBit layer,
                       const double truth[PIXELS], int levels)
{
    int seeds = 8, first = 2;
    double noise[LEVELS_MAX], blur[LEVELS_MAX], error;
    Series series = run_series(text, layer, seeds, levels);
    for (int level = 0; level < levels; level++) {
        split_error(&series, level, truth, &noise[level], &blur[level]);
        double mse = 0;
        for (int seed = 0; seed < seeds; seed++)
            mse += error_of_seed(&series, seed, level, truth) / seeds;
        print_message("# %4d passes: relative error squared %.3g, noise %.3g, blur %.3g\n",
                      1 << level, mse, noise[level], blur[level]);
    }
    double slope = slope_of_seeds(&series, truth, first, &error);
    table_row(what, slope, -2.0 / 3, error);
    double of_noise = fit_slope(noise, first, levels);
    print_message("# slope of noise %.3f, of blur %.3f\n", of_noise,
                  fit_slope(blur, first, levels));
    assert_true(slope < -2.0 / 3 + 4 * error);
    /* Noise that falls faster is bought by blur that falls more slowly. */
    assert_true(slope > -2.0 / 3 - 4 * error - 0.05);
    assert_true(fabs(of_noise + 2.0 / 3) < 0.12);
    assert_true(error < 0.05);
    free(series.pictures);
}

static void the_error_of_a_caustic_falls(void **state)
{
    (void)state;
    bool is_long = table_is_long();
    char text[1024];
    double truth[PIXELS];
    fill_truth(truth);
    snprintf(
        text, sizeof text,
        "#version 3.7;\n"
        "global_settings { assumed_gamma 1 max_trace_level 10\n"
        "  photons { count %d radius %g } }\n"
        "camera { orthographic location <0,0.4,0> direction -y right %g*x up %g*z }\n"
        "light_source { <0,6,0> rgb 1 }\n"
        "plane { y, 0 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
        "sphere { <0,1.5,0>, 1 pigment { rgbt 1 } finish { ambient 0 diffuse 0 }\n"
        "  interior { ior 1.5 } photons { target refraction on reflection off collect off } }\n",
        is_long ? 20000 : 1000, is_long ? 0.3 : 0.25, 2 * HALF, 2 * HALF);
    check_fall("caustic of a ball: slope of error squared over passes", text, LAYER_CAUSTIC, truth,
               is_long ? 10 : 8);
}

/* A beam with soft sides in thin smoke, through a pane that bends nothing: what a ray sees is the
 * light along it times the scattering. */
static void the_error_in_smoke_falls(void **state)
{
    (void)state;
    enum { STEPS = 4000 };
    bool is_long = table_is_long();
    const double wide = 1.2, smoke = 0.01, step = 2 * HALF / SIDE;
    char text[1024];
    double truth[PIXELS];
    Light light = {.kind = LIGHT_CYLINDER,
                   .location = {0, 4, 0},
                   .direction = {0, -1, 0},
                   .color = {1, 1, 1},
                   .falloff = wide};
    for (int i = 0; i < PIXELS; i++) {
        double left = (i % SIDE - SIDE / 2) * step, sum = 0;
        for (int k = 0; k < STEPS && fabs(left + step / 2) < 0.7 * wide; k++) {
            V3 p = {left + (k % 16 + 0.5) / 16 * step, 0, wide * (2 * (k + 0.5) / STEPS - 1)};
            sum += (double)light_at(&light, light.location, p).color.g / STEPS;
        }
        truth[i] = 2 * wide * smoke * sum;
    }
    snprintf(text, sizeof text,
             "#version 3.7;\n"
             "global_settings { assumed_gamma 1\n"
             "  photons { count %d media 1 radius 0.1, 1, %g } }\n"
             "camera { orthographic location <0,0,-5> direction z right %g*x up %g*y }\n"
             "light_source { <0,4,0> rgb 1 cylinder point_at 0 radius 0 falloff %g tightness 0 }\n"
             "media { scattering { 1, %g extinction 0 } }\n"
             "plane { y, -3 pigment { rgb 1 } finish { ambient 0 } }\n"
             "box { <-2,2,-2>, <2,2.1,2> pigment { rgbt 1 } finish { ambient 0 diffuse 0 } hollow\n"
             "  interior { ior 1 } photons { target refraction on collect off } }\n",
             is_long ? 6000 : 2000, is_long ? 0.3 : 0.4, 2 * HALF, 2 * HALF, wide, smoke);
    check_fall("beam in smoke: slope of error squared over passes", text, LAYER_CAUSTIC, truth,
               is_long ? 9 : 7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(even_light_is_right_from_the_first_pass),
        cmocka_unit_test(a_closed_sphere_is_evenly_lit),
        cmocka_unit_test(the_error_of_a_caustic_falls),
        cmocka_unit_test(the_error_in_smoke_falls),
    };
    return cmocka_run_group_tests_name("convergence", tests, NULL, NULL);
}
