/* Means of many paths, in groups, each the paths of one pixel; the standard error is that of the
 * means of the groups.  Include after cmocka.h.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TESTS_LIT_PATHS_H
#define PMS_TESTS_LIT_PATHS_H

#include "lit_scene.h"
#include "table.h"

#include "eye/camera.h"
#include "eye/eye.h"

enum { PATH_GROUP = 64 }; /* paths of a pixel */

/* What a test expects where a camera ray meets p. */
typedef double (*Expected)(const void *ctx, V3 p);

typedef struct Mean {
    double part[PART_COUNT], sum; /* green */
    double part_error[PART_COUNT], error;
    double expected; /* mean of it over the same rays */
    Stats stats;
} Mean;

static inline double error_of(double sum, double squares, int n)
{
    double mean = sum / n;
    return sqrt(fmax(0, squares / n - mean * mean) / (n - 1));
}

static inline void take_group(EyeThread *eye, const CameraRays *camera, int group,
                              Expected expected, const void *ctx, double part[PART_COUNT],
                              double *wanted)
{
    for (int i = 0; i < PATH_GROUP; i++) {
        EyeSample sample;
        Rng rng = rng_at(17, 0, (uint64_t)group * PATH_GROUP + (uint64_t)i);
        double x = rng_double(&rng), y = rng_double(&rng);
        assert_true(eye_sample(eye, x, y, (uint32_t)group, (uint32_t)i, &sample));
        for (int k = 0; k < PART_COUNT; k++)
            part[k] += (double)sample.part[k].g / PATH_GROUP;
        Ray ray = camera_ray(camera, x, y);
        if (expected)
            *wanted += expected(ctx, ray_at(&ray, sample.depth)) / PATH_GROUP;
    }
}

/* Measure the mean over the film of a scene. */
static inline Mean measure(const char *text, double light_radius, int groups, Expected expected,
                    const void *ctx)
{
    LitScene lit;
    EyeThread *eye;
    PlanOptions plan = {.integrator = INTEGRATOR_PATH, .quality = 9, .light_radius = light_radius};
    EyeOptions options = {.width = 1, .height = 1, .seed = 1};
    lit_read_as(&lit, text, 1, 1, plan);
    assert_int_equal(eye_thread_new(lit.tracer, &options, &lit.diag, &eye), OK);
    CameraRays camera;
    camera_rays_init(&camera, &lit.scene->camera, 1, 1);
    Mean mean = {.sum = 0};
    double squares = 0, part_squares[PART_COUNT] = {0};
    for (int group = 0; group < groups; group++) {
        double part[PART_COUNT] = {0}, wanted = 0, sum = 0;
        take_group(eye, &camera, group, expected, ctx, part, &wanted);
        for (int k = 0; k < PART_COUNT; k++) {
            mean.part[k] += part[k];
            part_squares[k] += part[k] * part[k];
            sum += part[k];
        }
        mean.sum += sum;
        mean.expected += wanted / groups;
        squares += (sum - wanted) * (sum - wanted);
    }
    mean.error = error_of(mean.sum - mean.expected * groups, squares, groups);
    for (int k = 0; k < PART_COUNT; k++) {
        mean.part_error[k] = error_of(mean.part[k], part_squares[k], groups);
        mean.part[k] /= groups;
    }
    mean.sum /= groups;
    eye_thread_free(eye, &mean.stats);
    lit_done(&lit);
    return mean;
}

/* Rounding of float sums stands for the error of means that do not scatter. */
#define ROUNDING 2e-6

static inline void check(const char *name, double got, double expected, double error)
{
    table_row(name, got, expected, error);
    assert_true(fabs(got - expected) < 4 * error + ROUNDING * fmax(1, fabs(expected)));
}

#endif
