/* The mean of a small picture by each of the ways in which light is found.  Include after cmocka.h.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TESTS_LIT_METHODS_H
#define PMS_TESTS_LIT_METHODS_H

#include "lit_scene.h"
#include "table.h"

#include "render/render.h"

enum { METHOD_SIDE = 16 };

typedef struct Method {
    const char *name;
    PlanOptions plan;
    int samples, seeds;
    uint64_t passes;
} Method;

enum { BY_PATHS, BY_GATHERING, BY_CACHE, BY_MAP, BY_PASSES, METHOD_COUNT };

static const Method methods[METHOD_COUNT] = {
    {"paths", {.quality = 9, .integrator = INTEGRATOR_PATH}, 400, 4, 0},
    {"gathering", {.quality = 9, .has_indirect = true, .indirect = INDIRECT_GATHER}, 1, 4, 0},
    {"the cache", {.quality = 9, .has_indirect = true, .indirect = INDIRECT_CACHE}, 4, 4, 0},
    {"the map", {.quality = 9, .has_indirect = true, .indirect = INDIRECT_MAP}, 4, 4, 0},
    {"passes", {.quality = 9, .has_indirect = true, .is_progressive = true}, 0, 3, 24},
};

static inline double method_picture(const char *text, const Method *method, uint64_t seed)
{
    LitScene lit;
    RenderResult result;
    lit_read_as(&lit, text, 1, 1, method->plan);
    RenderOptions options = RENDER_OPTIONS_DEFAULT;
    options.width = options.height = METHOD_SIDE;
    options.threads = 2;
    options.seed = seed;
    options.plan = method->plan;
    options.aa = AA_UNIFORM;
    options.samples = method->samples > 0 ? method->samples : 1;
    options.progressive.passes = method->passes;
    Status status = render_scene(lit.scene, &options, &lit.diag, &result);
    if (status != OK)
        print_message("%s", lit.messages);
    assert_int_equal(status, OK);
    double sum = 0;
    for (size_t i = 0; i < METHOD_SIDE * METHOD_SIDE; i++)
        sum += (double)result.image.layers[0].pixels[4 * i + 1] / (METHOD_SIDE * METHOD_SIDE);
    render_result_done(&result);
    lit_done(&lit);
    return sum;
}

/* The mean (green) over the picture and a few seeds, and its standard error by the seeds. */
static inline double method_mean(const char *text, const Method *method, double *error)
{
    double sum = 0, squares = 0;
    for (int seed = 1; seed <= method->seeds; seed++) {
        double mean = method_picture(text, method, (uint64_t)seed);
        sum += mean / method->seeds;
        squares += mean * mean / method->seeds;
    }
    *error = sqrt(fmax(0, squares - sum * sum) / (method->seeds - 1)) + 1e-6;
    return sum;
}

/* Expect a mean by one method: within 4 standard errors and `part` of it, a row of the table. */
static inline bool method_expect(const char *what, const char *text, const Method *method,
                                 double expected, double part)
{
    char name[96];
    double error, mean = method_mean(text, method, &error);
    snprintf(name, sizeof name, "%s, by %s", what, method->name);
    table_row(name, mean, expected, error);
    bool is_good = fabs(mean - expected) < 4 * error + part * fabs(expected);
    if (!is_good)
        print_message("# %s: not as expected\n", name);
    return is_good;
}

#endif
