/* One render: plan, ray index, pass, image.  SPDX-License-Identifier: Apache-2.0 */
#include "render/render.h"

#include "base/work.h"
#include "render/error_map.h"
#include "render/forecast.h"
#include "render/pass.h"
#include "render/progressive.h"

static Status make_tracer(const Scene *scene, const RenderOptions *options, Diag *diag,
                          RenderResult *out, Tracer **tracer)
{
    double started = clock_wall();
    Status status = tracer_new(scene, &out->plan, options->threads, diag, tracer);
    out->stats.seconds[PHASE_INDEX] += clock_wall() - started;
    return status;
}

static void report_end(const RenderOptions *options)
{
    RenderProgress progress = {.phase = "eye", .fraction = 1};
    if (options->progress)
        options->progress(options->progress_ctx, &progress);
}

/* Hand image and what else a pass left to the result. */
static void take_result(Film *film, PassResult *pass, RenderResult *out)
{
    out->image = film->image;
    out->caustic_hash = pass->caustic_hash;
    out->global_hash = pass->global_hash;
    out->volume_hash = pass->volume_hash;
    out->books = pass->books;
    out->first_radii = out->last_radii = pass->radii;
    film->image = (Image){0};
    pass->books = (PhotonBooks){0};
}

/* How many samples a pixel has that has more than one; `rays` of focal blur count as samples. */
static int samples_of(const RenderOptions *options, int rays)
{
    if (options->aa == AA_UNIFORM)
        return (options->samples > rays ? options->samples + rays - 1 : rays) / rays;
    return options->aa == AA_NONE ? 1 : options->aa_depth * options->aa_depth;
}

/* Make the picture of a film: linear light, and its errors instead of what they are found from. */
static Status show_film(const Scene *scene, const RenderOptions *options, Film *film, Diag *diag,
                        RenderResult *out)
{
    ErrorMap errors;
    TRY(error_map_init(&errors, film, diag));
    bool is_blurred = plan_has(&out->plan, FEATURE_FOCAL_BLUR);
    int samples = samples_of(options, is_blurred ? scene->camera.blur_samples : 1);
    PixelSampling sampling = is_blurred                            ? SAMPLED_ALL_OVER
                             : plan_has(&out->plan, FEATURE_PATHS) ? SAMPLED_AT_RANDOM
                                                                   : SAMPLED_EVENLY;
    error_map_of_film(film, sampling, samples, &scene->settings, &errors);
    film_linearize(&film->image, &scene->settings);
    out->error = error_figure(&errors);
    Status status = film_show_errors(film, diag);
    if (status == OK)
        status = error_map_show(&errors, &film->image, options, diag, &out->error_picture);
    error_map_done(&errors);
    return status;
}

static Status render_once(const Tracer *tracer, const RenderOptions *options, Diag *diag,
                          RenderResult *out)
{
    Film film;
    PassResult result;
    PassOptions pass = {.render = options, .photon_seed = options->seed};
    TRY(film_init(&film, options, FILM_SAMPLES | FILM_CLUES, diag));
    Status status = pass_render(tracer, &pass, diag, &out->stats, &film, &result);
    if (status == OK)
        status = show_film(tracer_scene(tracer), options, &film, diag, out);
    if (status == OK) {
        report_end(options);
        take_result(&film, &result, out);
    }
    pass_result_done(&result);
    film_done(&film);
    return status;
}

static Status check_options(const RenderOptions *options, Diag *diag)
{
    if (options->width < 1 || options->height < 1 || options->width > IMAGE_SIDE_MAX ||
        options->height > IMAGE_SIDE_MAX)
        return diag_fail(diag, ERR_USAGE, "image size wanted between 1x1 and %dx%d, got %dx%d",
                         IMAGE_SIDE_MAX, IMAGE_SIDE_MAX, options->width, options->height);
    if (options->threads < 1 || options->threads > WORK_THREADS_MAX)
        return diag_fail(diag, ERR_USAGE, "number of threads wanted between 1 and %d, got %d",
                         WORK_THREADS_MAX, options->threads);
    return OK;
}

static void warn_of_missing(const Plan *plan, Diag *diag)
{
    if (plan->unmet_lights > 0)
        diag_warn(diag, WARN_RENDER, plan->rows[FEATURE_PATH_CAUSTICS].why,
                  "paths cannot meet %d light%s without an area, whose caustics are missing: "
                  "--light-radius gives lights a size",
                  plan->unmet_lights, plan->unmet_lights == 1 ? "" : "s");
}

static void warn_of_crowds(const Stats *stats, Diag *diag)
{
    uint64_t count = stats->count[STAT_INTERIORS_CUT];
    if (count > 0)
        diag_warn(diag, WARN_RENDER, SPAN_NONE,
                  "more than %d bodies lie over each other: the outermost did not count at %llu "
                  "surfaces that rays met",
                  INTERIORS_MAX, (unsigned long long)count);
}

Status render_scene(const Scene *scene, const RenderOptions *options, Diag *diag, RenderResult *out)
{
    Tracer *tracer = NULL;
    double started = clock_wall();
    *out = (RenderResult){0};
    TRY(check_options(options, diag));
    if (plan_make(scene, &options->plan, scene->arena, &out->plan) != OK)
        return diag_no_memory(diag, "the plan");
    TRY(plan_check(&out->plan, diag));
    warn_of_missing(&out->plan, diag);
    Status status = make_tracer(scene, options, diag, out, &tracer);
    if (status == OK && options->plan.is_progressive)
        status = progressive_render(tracer, options, started, diag, out);
    else if (status == OK)
        status = render_once(tracer, options, diag, out);
    if (status == OK)
        warn_of_crowds(&out->stats, diag);
    tracer_free(tracer);
    return status;
}

void render_result_done(RenderResult *result)
{
    image_done(&result->image);
    image_done(&result->error_picture);
    photon_books_done(&result->books);
}

Status render_forecast(const Scene *scene, const RenderOptions *options, Diag *diag, Arena *arena,
                       Plan *plan, Forecast *out)
{
    Tracer *tracer = NULL;
    *out = (Forecast){0};
    TRY(check_options(options, diag));
    if (plan_make(scene, &options->plan, arena, plan) != OK)
        return diag_no_memory(diag, "the plan");
    TRY(plan_check(plan, diag));
    Status status = tracer_new(scene, plan, options->threads, diag, &tracer);
    if (status == OK)
        status = forecast_make(tracer, options, diag, out);
    tracer_free(tracer);
    return status;
}
