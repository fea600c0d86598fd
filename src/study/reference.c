/* Building a reference.  SPDX-License-Identifier: Apache-2.0 */
#include "study/reference.h"

#include "base/file.h"
#include "base/mem.h"
#include "base/work.h"
#include "render/progressive.h"

#include <math.h>
#include <string.h>
#include <unistd.h>

/* Seeds of the halves: others than those of the study's runs. */
static const uint64_t half_seed[2] = {0x68616c6641, 0x68616c6642};

static const char *const half_state[2] = {"reference_a.pmsstate", "reference_b.pmsstate"};

/* The first growth may take this part of the time; each next one as long as all before. */
#define FIRST_PART (1.0 / 16)

/* Reflections that the reference follows at least: what max_trace_level cuts is an error. */
enum { REFERENCE_LEVEL = 32 };

/* Weights below which it follows no ray. */
#define REFERENCE_BAILOUT (1.0 / 1024)

typedef struct Builder {
    const ReferenceOptions *options;
    Diag *diag;
    Truth *truth;
    Scene scene;     /* the study's, with fewer limits */
    uint64_t passes; /* of each half */
    double started;
    float *before[2]; /* the halves as they were before the last growth */
    uint64_t passes_before;
} Builder;

/* Return true if the plan has effects that photons bring only where the scene asks for them, or
 * only so far: paths bring all of that light. */
static bool has_partial_light(const Plan *plan)
{
    return plan_has(plan, FEATURE_REFLECTION) || plan_has(plan, FEATURE_REFRACTION) ||
           plan_has_air(plan);
}

bool reference_can_be_path(const Scene *scene, const RenderOptions *options, const Plan *plan)
{
    const RadiositySettings *radiosity = &scene->settings.radiosity;
    PlanOptions paths = options->plan;
    Plan other;
    paths.integrator = INTEGRATOR_PATH;
    if (!plan_has(plan, FEATURE_GLOBAL_MAP) || plan->has_ambient || has_partial_light(plan) ||
        radiosity->recursion_limit > 0 || radiosity->brightness != 1 ||
        plan_make(scene, &paths, scene->arena, &other) != OK)
        return false;
    return plan_has(&other, FEATURE_PATHS) && other.unmet_lights == 0;
}

static void state_path(const char *folder, int half, char out[FILE_PATH_MAX])
{
    snprintf(out, FILE_PATH_MAX, "%s/%s", folder, half_state[half]);
}

void reference_forget_states(const char *folder)
{
    char path[FILE_PATH_MAX];
    for (int i = 0; i < 2; i++) {
        state_path(folder, i, path);
        unlink(path);
    }
}

/* Let go of effects forced on that this way to render cannot have: they are other ways to the same
 * light. */
static Status free_effects(const Scene *scene, PlanOptions *options)
{
    Plan plan;
    TRY(plan_make(scene, options, scene->arena, &plan));
    for (int i = 0; i < FEATURE_COUNT; i++)
        if (plan.rows[i].forced == TRI_ON && !plan.rows[i].is_on)
            options->effects[i] = TRI_UNSET;
    return OK;
}

/* Let a half grow, by passes for some seconds or (0) up to a number of them. */
static Status grow_half(Builder *b, int half, double seconds, uint64_t passes)
{
    char path[FILE_PATH_MAX];
    RenderResult result;
    state_path(b->options->folder, half, path);
    RenderOptions render = b->options->render;
    render.seed = half_seed[half];
    render.aa = AA_UNIFORM;
    render.samples = 1;
    render.plan.is_progressive = true;
    render.plan.integrator = b->options->is_path ? INTEGRATOR_PATH : INTEGRATOR_PHOTONS;
    if (free_effects(&b->scene, &render.plan) != OK)
        return diag_no_memory(b->diag, "the reference");
    render.progressive = (ProgressiveOptions){
        .passes = passes, .seconds = seconds, .state_path = path, .is_resumed = file_exists(path)};
    Status status = render_scene(&b->scene, &render, b->diag, &result);
    if (status == OK) {
        truth_colours(&result.image, b->truth->half[half]);
        b->passes = result.passes;
    }
    render_result_done(&result);
    return status;
}

/* Let both halves grow, to the same number of passes. */
static Status grow(Builder *b, double seconds)
{
    TRY(grow_half(b, 0, seconds / 2, 0));
    uint64_t first = b->passes;
    TRY(grow_half(b, 1, 0, first));
    if (b->passes > first) /* a run before ended between the two */
        TRY(grow_half(b, 0, 0, b->passes));
    return truth_settle(b->diag, b->truth);
}

/* --- blur ----------------------------------------------------------------------------------- */

/* Return the mean of the areas that photons were gathered in over so many passes, over the first.
 */
static double mean_area(uint64_t passes)
{
    double sum = 0;
    for (uint64_t i = 1; i <= passes; i++) {
        double shrink = progressive_shrink(i);
        sum += shrink * shrink;
    }
    return sum / (double)passes;
}

static Status remember(Builder *b)
{
    size_t size = (size_t)b->truth->width * (size_t)b->truth->height * 3 * sizeof(float);
    for (int i = 0; i < 2; i++) {
        if (!b->before[i])
            b->before[i] = mem_alloc(size);
        if (!b->before[i])
            return diag_no_memory(b->diag, "the reference");
        memcpy(b->before[i], b->truth->half[i], size);
    }
    b->passes_before = b->passes;
    return OK;
}

/* The blur of a mean of passes goes as the mean area of their estimates.  What both halves lost of
 * it alike by the last growth tells what is left; their noise is not alike. */
static void find_blur(Builder *b)
{
    Truth *truth = b->truth;
    if (b->options->is_path) {
        truth->rel_blur2 = 0;
        return;
    }
    if (b->passes_before == 0 || b->passes_before == b->passes)
        return;
    const float *of_a[2] = {b->before[0], truth->half[0]};
    const float *of_b[2] = {b->before[1], truth->half[1]};
    double now = mean_area(b->passes), part = now / (mean_area(b->passes_before) - now);
    truth->rel_blur2 = fmax(0, truth_common(truth, of_a, of_b)) * part * part;
}

/* --- growth --------------------------------------------------------------------------------- */

static Status is_good_enough(const Builder *b, bool *out)
{
    TruthError own;
    TRY(truth_compare(b->diag, b->truth, b->options->own, &own));
    *out = b->truth->noise.percentile <= b->options->error_part * own.percentile;
    return OK;
}

static Status build(Builder *b)
{
    double seconds = b->options->seconds, step = seconds * FIRST_PART;
    for (;;) {
        TRY(grow(b, step));
        double used = clock_wall() - b->started;
        bool is_enough;
        TRY(is_good_enough(b, &is_enough));
        if (is_enough || used * 1.5 > seconds)
            return OK;
        TRY(remember(b));
        step = fmin(used, seconds - used);
    }
}

static void set_limits(Scene *scene)
{
    SceneSettings *settings = &scene->settings;
    if (settings->max_trace_level < REFERENCE_LEVEL)
        settings->max_trace_level = REFERENCE_LEVEL;
    settings->adc_bailout = fmin(settings->adc_bailout, REFERENCE_BAILOUT);
}

Status reference_build(const ReferenceOptions *options, Diag *diag, Truth *out)
{
    Builder b = {.options = options,
                 .diag = diag,
                 .truth = out,
                 .scene = *options->scene,
                 .started = clock_wall()};
    set_limits(&b.scene);
    TRY(truth_init(diag, options->render.width, options->render.height, true, out));
    Status status = build(&b);
    if (status == OK)
        find_blur(&b);
    out->passes = 2 * (double)b.passes;
    out->seconds = clock_wall() - b.started;
    snprintf(out->method, sizeof out->method, "%s, %.0f passes",
             options->is_path ? "path tracing" : "progressive photon mapping", out->passes);
    mem_free(b.before[0]);
    mem_free(b.before[1]);
    if (status != OK)
        truth_done(out);
    return status;
}
