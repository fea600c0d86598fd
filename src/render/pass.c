/* One pass: photon maps, then the film.  SPDX-License-Identifier: Apache-2.0 */
#include "render/pass.h"

#include "render/tiles.h"

/* Photons whose surface is turned further from the surface at hand than this (its cosine) lie
 * on another one: walls of a corner do not light each other. */
#define GATHER_NORMAL_COSINE 0.5

typedef struct Pass {
    const Tracer *tracer;
    const PassOptions *options;
    Diag *diag;
    Stats *stats;
    PhotonMaps maps;
    PhotonReach caustic_reach;
} Pass;

/* --- photons -------------------------------------------------------------------------------- */

static void photon_progress(void *ctx, double fraction)
{
    const RenderOptions *options = ctx;
    RenderProgress progress = {"photons", fraction < 1 ? fraction : 1 - 0x1p-20, -1};
    options->progress(options->progress_ctx, &progress);
}

PhotonOptions pass_photon_options(const RenderOptions *options, uint64_t seed)
{
    return (PhotonOptions){.seed = seed,
                           .threads = options->threads,
                           .progress = options->progress ? photon_progress : NULL,
                           .progress_ctx = (void *)(uintptr_t)options};
}

bool pass_needs_photons(const Plan *plan)
{
    return plan_has(plan, FEATURE_CAUSTIC_MAP) || plan_has(plan, FEATURE_GLOBAL_MAP);
}

static GatherLimits gather_limits(const Pass *pass, double radius, double far_radius)
{
    const SceneSettings *settings = &tracer_scene(pass->tracer)->settings;
    const PhotonSettings *photons = &settings->photons;
    return (GatherLimits){.min_photons = photons->gather_min,
                          .max_photons = gather_most(photons),
                          .max_radius = radius,
                          .far_radius = far_radius,
                          .shape = settings->pms.gather_shape,
                          .kernel = settings->pms.kernel,
                          .normal_cosine = GATHER_NORMAL_COSINE};
}

static Status make_maps(Pass *pass)
{
    if (!pass_needs_photons(tracer_plan(pass->tracer)))
        return OK;
    PhotonOptions options = pass_photon_options(pass->options->render, pass->options->photon_seed);
    TRY(photon_pass(pass->tracer, &options, pass->diag, pass->stats, &pass->maps));
    if (!pass->maps.caustic)
        return OK;
    bool is_widening = tracer_scene(pass->tracer)->settings.photons.gather_min > 0;
    double radius = is_widening ? pass->maps.caustic_far : pass->maps.caustic_radius;
    return photon_reach_init(&pass->caustic_reach, pass->maps.caustic, radius, pass->diag);
}

/* --- the film ------------------------------------------------------------------------------- */

static Status fill_film(Pass *pass, Film *film)
{
    const RenderOptions *options = pass->options->render;
    EyeOptions eye = {
        .width = options->width,
        .height = options->height,
        .has_alpha = options->has_alpha,
        .seed = options->seed,
        .caustic = pass->maps.caustic,
        .global = pass->maps.global,
        .caustic_reach = &pass->caustic_reach,
        .caustic_limits = gather_limits(pass, pass->maps.caustic_radius, pass->maps.caustic_far),
        .global_limits = gather_limits(pass, pass->maps.global_radius, pass->maps.global_far)};
    return tiles_render(pass->tracer, options, &eye, pass->diag, pass->stats, film);
}

/* --- the pass ------------------------------------------------------------------------------- */

/* Return a number that differs when any byte of the map does; 0 is kept for no map. */
static uint64_t map_hash(const PhotonMap *map)
{
    return map ? photon_map_hash(map) : 0;
}

Status pass_render(const Tracer *tracer, const PassOptions *options, Diag *diag, Stats *stats,
                   Film *film, PassResult *out)
{
    Pass pass = {.tracer = tracer, .options = options, .diag = diag, .stats = stats};
    *out = (PassResult){0};
    Status status = make_maps(&pass);
    if (status == OK)
        status = fill_film(&pass, film);
    if (status == OK) {
        out->caustic_hash = map_hash(pass.maps.caustic);
        out->global_hash = map_hash(pass.maps.global);
        out->books = pass.maps.books;
        pass.maps.books = (PhotonBooks){0};
    }
    photon_reach_done(&pass.caustic_reach);
    photon_maps_done(&pass.maps);
    return status;
}

void pass_result_done(PassResult *result)
{
    photon_books_done(&result->books);
}
