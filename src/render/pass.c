/* One pass: photon maps, then the film.  SPDX-License-Identifier: Apache-2.0 */
#include "render/pass.h"

#include "eye/cache_fill.h"
#include "render/tiles.h"

/* Photons whose surface is turned further from the surface at hand than this (its cosine) lie
 * on another one: walls of a corner do not light each other. */
#define GATHER_NORMAL_COSINE 0.5

/* Photons gathered at a point in the first of many passes, about.  Fewer than in a single pass:
 * their noise is averaged away.  They lie within a part of the radius that more photons set: had
 * that radius itself a photon on its border, that one would count half too little where photons are
 * spread evenly, as those of a beam are. */
enum { SERIES_PHOTONS = 12, SERIES_REACH = 48 };

/* That radius is at most so many times what it is where the map is of common density
 * (photon_map_radius). */
#define SERIES_WIDEN 6

/* One of many passes shoots so many times fewer rays for a record of the irradiance cache, but at
 * least so many. */
enum { SERIES_RAYS_PART = 4, SERIES_RAYS_LEAST = 16 };

/* Photons in the ball around one in a medium, across which its light is spread. */
enum { VOLUME_PHOTONS = 30 };

typedef struct Pass {
    const Tracer *tracer;
    const PassOptions *options;
    Diag *diag;
    Stats *stats;
    bool has_error; /* what errors are estimated from is asked for */
    PhotonMaps maps;
    PhotonReach caustic_reach;
    VolumeIndex *volume;
    GatherLimits caustic_limits, global_limits;
    IrradianceCaches caches;
    uint64_t cache_rays; /* that filled them */
} Pass;

/* --- photons -------------------------------------------------------------------------------- */

static void photon_progress(void *ctx, double fraction)
{
    const RenderOptions *options = ctx;
    RenderProgress progress = {
        .phase = "photons", .fraction = fraction < 1 ? fraction : 1 - 0x1p-20, .seconds_left = -1};
    options->progress(options->progress_ctx, &progress);
}

PhotonOptions pass_photon_options(const RenderOptions *options, uint64_t seed)
{
    return (PhotonOptions){.seed = seed,
                           .threads = options->threads,
                           .is_watched = options->is_watched,
                           .is_full = options->has_full_photons,
                           .progress = options->progress ? photon_progress : NULL,
                           .progress_ctx = (void *)(uintptr_t)options};
}

bool pass_needs_photons(const Plan *plan)
{
    return plan_has(plan, FEATURE_CAUSTIC_MAP) || plan_has(plan, FEATURE_GLOBAL_MAP) ||
           plan_has(plan, FEATURE_VOLUME_MAP);
}

static GatherLimits gather_limits(const Pass *pass, double radius, double far_radius)
{
    const SceneSettings *settings = &tracer_scene(pass->tracer)->settings;
    const PhotonSettings *photons = &settings->photons;
    const Miniature *miniature = pass->options->miniature;
    return (GatherLimits){.min_photons = photons->gather_min > 0
                                             ? miniature_photons(miniature, photons->gather_min)
                                             : photons->gather_min,
                          .max_photons = miniature_photons(miniature, gather_most(photons)),
                          .max_radius = radius,
                          .far_radius = far_radius,
                          .shape = settings->pms.gather_shape,
                          .kernel = settings->pms.kernel,
                          .normal_cosine = GATHER_NORMAL_COSINE,
                          .has_error = pass->has_error};
}

/* The same for one pass of many: a part, smaller from pass to pass, of the radius that fits how
 * dense photons are at the point, or of the one asked for.
 *
 * asked  radius of the first pass that the scene asks for; 0: none.
 * first  of it, or where the map is of common density; found here if it is 0. */
static GatherLimits series_limits(const Pass *pass, const PhotonMap *map, double asked,
                                  double *first)
{
    double part = pass->options->series->shrink;
    const Miniature *miniature = pass->options->miniature;
    if (*first == 0 && map)
        *first = asked > 0 ? miniature_radius(miniature, asked)
                           : photon_map_radius(map, miniature_photons(miniature, SERIES_PHOTONS));
    GatherLimits limits = gather_limits(pass, asked > 0 ? part * *first : SERIES_WIDEN * *first, 0);
    limits.min_photons = 0;
    limits.max_photons = asked > 0 ? 0 : miniature_photons(miniature, SERIES_REACH) + 1;
    limits.shrink = asked > 0 ? 0 : part * sqrt((double)SERIES_PHOTONS / SERIES_REACH);
    return limits;
}

static void set_limits(Pass *pass)
{
    const PhotonMaps *maps = &pass->maps;
    const PassSeries *series = pass->options->series;
    if (series) {
        double asked = tracer_scene(pass->tracer)->settings.photons.radius;
        PassRadii *first = series->first;
        pass->caustic_limits = series_limits(pass, maps->caustic, asked, &first->caustic);
        pass->global_limits = series_limits(pass, maps->global, 0, &first->global);
    } else {
        pass->caustic_limits = gather_limits(pass, maps->caustic_radius, maps->caustic_far);
        pass->global_limits = gather_limits(pass, maps->global_radius, maps->global_far);
    }
}

/* Make photons in media be found by rays.  In one pass of many all balls are alike.  Rays see them
 * as disks, so they shrink as the disks on surfaces do. */
static Status make_volume(Pass *pass)
{
    const PhotonMap *map = pass->maps.volume;
    const PassSeries *series = pass->options->series;
    int threads = pass->options->render->threads;
    const Miniature *small = pass->options->miniature;
    double radius = tracer_scene(pass->tracer)->settings.photons.media_radius;
    radius = miniature_radius(small, radius);
    int photons = miniature_ball(small, VOLUME_PHOTONS);
    if (!map)
        return OK;
    if (series) {
        if (series->first->volume == 0)
            series->first->volume = radius > 0 ? radius : volume_radius(map, photons);
        radius = series->first->volume * series->shrink;
    }
    return volume_index_new(pass->tracer, map, photons, radius, threads, pass->diag, &pass->volume);
}

static Status make_maps(Pass *pass)
{
    if (!pass_needs_photons(tracer_plan(pass->tracer)))
        return OK;
    const PassSeries *series = pass->options->series;
    PhotonOptions options = pass_photon_options(pass->options->render, pass->options->photon_seed);
    options.part = series ? series->photon_part : 0;
    options.shrink = series ? series->shrink : 0;
    options.has_radii = series != NULL;
    options.is_repeat = (series && series->is_repeat) || pass->options->miniature;
    options.miniature = pass->options->miniature;
    TRY(photon_pass(pass->tracer, &options, pass->diag, pass->stats, &pass->maps));
    set_limits(pass);
    TRY(make_volume(pass));
    if (!pass->maps.caustic)
        return OK;
    const GatherLimits *limits = &pass->caustic_limits;
    double far = limits->min_photons > 0 ? limits->far_radius : 0;
    double radius = fmax(limits->max_radius, far);
    return photon_reach_init(&pass->caustic_reach, pass->maps.caustic, radius, pass->diag);
}

/* --- the film ------------------------------------------------------------------------------- */

static void cache_progress(void *ctx, double fraction)
{
    const RenderOptions *options = ctx;
    RenderProgress progress = {.phase = "indirect light",
                               .fraction = fraction < 1 ? fraction : 1 - 0x1p-20,
                               .seconds_left = -1};
    options->progress(options->progress_ctx, &progress);
}

/* Rays but those of photons. */
static uint64_t eye_rays(const Stats *stats)
{
    return stats->count[STAT_CAMERA_RAYS] + stats->count[STAT_CACHE_RAYS] +
           stats->count[STAT_REFLECTED_RAYS] + stats->count[STAT_REFRACTED_RAYS] +
           stats->count[STAT_DIFFUSE_RAYS] + stats->count[STAT_SHADOW_RAYS];
}

/* Fill the irradiance cache for a picture, if it has one. */
static Status fill_cache(Pass *pass, EyeOptions *eye)
{
    const RenderOptions *options = pass->options->render;
    double started = clock_wall();
    uint64_t before = eye_rays(pass->stats);
    CacheFilling filling = {.threads = options->threads,
                            .seed = pass->options->photon_seed,
                            .progress = options->progress ? cache_progress : NULL,
                            .progress_ctx = (void *)(uintptr_t)options};
    Status status =
        irradiance_cache_fill(pass->tracer, eye, &filling, pass->diag, pass->stats, &pass->caches);
    pass->stats->seconds[PHASE_IRRADIANCE] += clock_wall() - started;
    pass->cache_rays = eye_rays(pass->stats) - before;
    eye->cache = pass->caches.seen;
    eye->near_cache = pass->caches.near;
    return status;
}

/* Rays of a record. */
static int gather_rays(const Pass *pass)
{
    const PassSeries *series = pass->options->series;
    int asked = tracer_scene(pass->tracer)->settings.radiosity.count;
    double rays = series ? series->photon_part * asked / SERIES_RAYS_PART : asked;
    int least = asked < SERIES_RAYS_LEAST ? asked : SERIES_RAYS_LEAST;
    return rays > least ? (int)rays : least;
}

/* Once a render, and not of a miniature, whose pixels are others. */
static void warn_of_fault(const Pass *pass, FilmFault *fault)
{
    if (fault->count == 0 || fault->is_told || pass->options->miniature ||
        pass->options->render->replay)
        return;
    fault->is_told = true;
    diag_warn(pass->diag, WARN_RENDER, fault->object ? fault->object->span : SPAN_NONE,
              "light that is no number came from %s in sample %u of pixel %d,%d, the first of %llu "
              "samples that are left out: --replay %d,%d tells more",
              fault->object ? "here" : "the sky or the camera", fault->index, fault->x, fault->y,
              (unsigned long long)fault->count, fault->x, fault->y);
}

static Status fill_film(Pass *pass, Film *film)
{
    const RenderOptions *options = pass->options->render;
    const PassSeries *series = pass->options->series;
    EyeOptions eye = {.width = options->width,
                      .height = options->height,
                      .has_alpha = options->has_alpha,
                      .seed = options->seed,
                      .is_progressive = series != NULL,
                      .has_error = film->has_clues,
                      .caustic = pass->maps.caustic,
                      .global = pass->maps.global,
                      .irradiance = pass->maps.irradiance,
                      .record_reach = series ? series->shrink : 1,
                      .gather_rays = gather_rays(pass),
                      .volume = pass->volume,
                      .has_no_caustics = pass->maps.has_no_caustics,
                      .has_no_focus = pass->maps.has_no_focus,
                      .caustic_reach = &pass->caustic_reach,
                      .caustic_limits = pass->caustic_limits,
                      .global_limits = pass->global_limits};
    TRY(fill_cache(pass, &eye));
    TRY(tiles_render(pass->tracer, options, &eye, pass->diag, pass->stats, film));
    warn_of_fault(pass, &film->fault);
    return OK;
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
    Pass pass = {.tracer = tracer,
                 .options = options,
                 .diag = diag,
                 .stats = stats,
                 .has_error = film->has_clues};
    *out = (PassResult){0};
    Stats before = *stats;
    Status status = make_maps(&pass);
    for (int i = 0; i < STAT_COUNT; i++)
        out->photon_stats.count[i] = stats->count[i] - before.count[i];
    if (status == OK)
        status = fill_film(&pass, film);
    out->shared_rays =
        stats->count[STAT_PHOTON_RAYS] - before.count[STAT_PHOTON_RAYS] + pass.cache_rays;
    out->eye_rays = eye_rays(stats) - eye_rays(&before) - pass.cache_rays;
    if (status == OK && options->render->is_watched)
        status = photon_maps_count_seen(&pass.maps, diag);
    if (status == OK) {
        out->caustic_hash = map_hash(pass.maps.caustic);
        out->global_hash = map_hash(pass.maps.global);
        out->volume_hash = map_hash(pass.maps.volume);
        out->radii = (PassRadii){pass.maps.caustic_radius, pass.maps.global_radius,
                                 tracer_scene(tracer)->settings.photons.media_radius};
        out->books = pass.maps.books;
        pass.maps.books = (PhotonBooks){0};
    }
    irradiance_caches_done(&pass.caches);
    volume_index_free(pass.volume);
    photon_reach_done(&pass.caustic_reach);
    photon_maps_done(&pass.maps);
    return status;
}

void pass_result_done(PassResult *result)
{
    photon_books_done(&result->books);
}
