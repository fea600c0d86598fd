/* One render: plan, ray index, photon pass, eye pass, image.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/render.h"

#include "base/rng.h"
#include "base/work.h"
#include "render/tiles.h"

#include <string.h>

/* Photons whose surface is turned further from the surface at hand than this (its cosine) lie
 * on another one: walls of a corner do not light each other. */
#define GATHER_NORMAL_COSINE 0.5

/* --- photons -------------------------------------------------------------------------------- */

static void photon_progress(void *ctx, double fraction)
{
    const RenderOptions *options = ctx;
    RenderProgress progress = {"photons", fraction < 1 ? fraction : 1 - 0x1p-20, -1};
    options->progress(options->progress_ctx, &progress);
}

static PhotonOptions photon_options(const RenderOptions *options)
{
    return (PhotonOptions){.seed = options->seed,
                           .threads = options->threads,
                           .progress = options->progress ? photon_progress : NULL,
                           .progress_ctx = (void *)(uintptr_t)options};
}

static bool needs_photons(const Plan *plan)
{
    return plan_has(plan, FEATURE_CAUSTIC_MAP) || plan_has(plan, FEATURE_GLOBAL_MAP);
}

static GatherLimits gather_limits(const SceneSettings *settings, double radius)
{
    const PhotonSettings *photons = &settings->photons;
    return (GatherLimits){.min_photons = photons->gather_min,
                          .max_photons = gather_most(photons),
                          .max_radius = radius,
                          .shape = settings->pms.gather_shape,
                          .kernel = settings->pms.kernel,
                          .normal_cosine = GATHER_NORMAL_COSINE};
}

/* Return a number that differs when any byte of the map does; 0 is kept for no map. */
static uint64_t map_hash(const PhotonMap *map)
{
    return map ? photon_map_hash(map) : 0;
}

/* --- the render ----------------------------------------------------------------------------- */

typedef struct Render {
    const Scene *scene;
    const RenderOptions *options;
    Diag *diag;
    Tracer *tracer;
    PhotonMaps maps;
    PhotonReach caustic_reach;
    Film film;
    RenderResult *out;
} Render;

static Status make_tracer(Render *r, const Plan *plan)
{
    double started = clock_wall();
    Status status = tracer_new(r->scene, plan, r->options->threads, r->diag, &r->tracer);
    r->out->stats.seconds[PHASE_INDEX] += clock_wall() - started;
    return status;
}

static Status make_maps(Render *r)
{
    if (!needs_photons(&r->out->plan))
        return OK;
    PhotonOptions options = photon_options(r->options);
    TRY(photon_pass(r->tracer, &options, r->diag, &r->out->stats, &r->maps));
    if (!r->maps.caustic)
        return OK;
    GatherLimits limits = gather_limits(&r->scene->settings, r->maps.caustic_radius);
    double radius = limits.max_radius * (limits.min_photons > 0 ? GATHER_WIDEN : 1);
    return photon_reach_init(&r->caustic_reach, r->maps.caustic, radius, r->diag);
}

static Status make_image(Render *r)
{
    const SceneSettings *settings = &r->scene->settings;
    EyeOptions eye = {.width = r->options->width,
                      .height = r->options->height,
                      .has_alpha = r->options->has_alpha,
                      .seed = r->options->seed,
                      .caustic = r->maps.caustic,
                      .global = r->maps.global,
                      .caustic_reach = &r->caustic_reach,
                      .caustic_limits = gather_limits(settings, r->maps.caustic_radius),
                      .global_limits = gather_limits(settings, r->maps.global_radius)};
    TRY(film_init(&r->film, r->options, r->diag));
    TRY(tiles_render(r->tracer, r->options, &eye, r->diag, &r->out->stats, &r->film));
    film_linearize(&r->film, settings);
    return OK;
}

static void report_end(const RenderOptions *options)
{
    RenderProgress progress = {"eye", 1, 0};
    if (options->progress)
        options->progress(options->progress_ctx, &progress);
}

static Status run(Render *r)
{
    TRY(make_tracer(r, &r->out->plan));
    TRY(make_maps(r));
    TRY(make_image(r));
    report_end(r->options);
    return OK;
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

Status render_scene(const Scene *scene, const RenderOptions *options, Diag *diag, RenderResult *out)
{
    Render r = {.scene = scene, .options = options, .diag = diag, .out = out};
    *out = (RenderResult){0};
    TRY(check_options(options, diag));
    if (plan_make(scene, &options->plan, scene->arena, &out->plan) != OK)
        return diag_no_memory(diag, "the plan");
    warn_of_missing(&out->plan, diag);
    Status status = run(&r);
    if (status == OK) {
        out->image = r.film.image;
        r.film.image = (Image){0};
        out->caustic_hash = map_hash(r.maps.caustic);
        out->global_hash = map_hash(r.maps.global);
        out->books = r.maps.books;
        r.maps.books = (PhotonBooks){0};
    }
    film_done(&r.film);
    photon_reach_done(&r.caustic_reach);
    photon_maps_done(&r.maps);
    tracer_free(r.tracer);
    return status;
}

void render_result_done(RenderResult *result)
{
    image_done(&result->image);
    photon_books_done(&result->books);
}

Status render_explain(const Scene *scene, const RenderOptions *options, Diag *diag, Arena *arena,
                      Plan *plan, PhotonBooks *books)
{
    *books = (PhotonBooks){0};
    if (plan_make(scene, &options->plan, arena, plan) != OK)
        return diag_no_memory(diag, "the plan");
    if (!needs_photons(plan))
        return OK;
    Tracer *tracer = NULL;
    Status status = tracer_new(scene, plan, options->threads, diag, &tracer);
    if (status == OK) {
        PhotonOptions photons = photon_options(options);
        photons.progress = NULL;
        status = photon_plan_budgets(tracer, &photons, diag, books);
    }
    tracer_free(tracer);
    return status;
}
