/* The photon pass: for each map the plan calls for, emission, tree and gather radius.
 * SPDX-License-Identifier: Apache-2.0 */
#include "photon/photon_pass.h"

#include "base/mem.h"
#include "photon/emission_int.h"
#include "photon/gather.h"
#include "photon/origins_int.h"

#include <string.h>

static const FeatureId map_feature[MAP_COUNT] = {FEATURE_CAUSTIC_MAP, FEATURE_GLOBAL_MAP,
                                                 FEATURE_VOLUME_MAP, FEATURE_VOLUME_MAP};
static const StatId map_counter[MAP_COUNT] = {STAT_PHOTONS_CAUSTIC, STAT_PHOTONS_GLOBAL,
                                              STAT_PHOTONS_VOLUME, STAT_PHOTONS_VOLUME};
static const char *const map_name[MAP_COUNT] = {"caustic", "global", "volume", "volume"};

/* Does the plan call for photons of a kind? */
static bool is_wanted(const Plan *plan, MapKind kind)
{
    if (!plan_has(plan, map_feature[kind]))
        return false;
    return kind == MAP_FOCUS    ? plan->has_volume_focus
           : kind == MAP_VOLUME ? plan->has_volume_indirect
                                : true;
}

/* Is there a kind that adds to this one's map? */
static bool is_first_of_map(const Plan *plan, MapKind kind)
{
    return kind == MAP_FOCUS && is_wanted(plan, MAP_VOLUME);
}

/* Places where irradiance is computed ahead: for one, this many photons are sent, in one of many
 * passes so many more.  There are three of them in the disk of an estimate even so. */
enum { IRRADIANCE_PART = 4, IRRADIANCE_PART_SERIES = 16 };

/* A part of the progress bar. */
typedef struct Progress {
    const PhotonOptions *options;
    double begin, length;
} Progress;

static void progress_part(void *ctx, double fraction)
{
    const Progress *progress = ctx;
    progress->options->progress(progress->options->progress_ctx,
                                progress->begin + progress->length * fraction);
}

static void count_paths(const LightBooks *books, int lights, MapKind map, Stats *stats)
{
    for (int i = 0; i < lights; i++) {
        stats->count[STAT_PHOTONS_EMITTED] += books[i].emitted;
        stats->count[STAT_PHOTONS_STORED_PATHS] += books[i].stored_paths;
        stats->count[STAT_PHOTONS_ABSORBED] += books[i].absorbed;
        stats->count[STAT_PHOTONS_ESCAPED] += books[i].escaped;
        stats->count[STAT_PHOTONS_CUT] += books[i].cut;
        stats->count[map_counter[map]] += books[i].stored;
    }
}

/* Say why there is no map. */
static void warn_of_none(const Emission *emission, MapKind kind, const char *reason)
{
    if (!emission->options->is_repeat)
        diag_warn(emission->diag, WARN_RENDER,
                  tracer_plan(emission->tracer)->rows[map_feature[kind]].why, "no %s map: %s",
                  map_name[kind], reason);
}

/* Make room for so many more photons. */
static bool make_room(PhotonList *list, size_t more)
{
    size_t count = list->count + more;
    Photon *items = mem_resize(list->items, count * sizeof *items);
    list->items = items ? items : list->items;
    if (!items || !list->lights)
        return items;
    PhotonLight *lights = mem_resize(list->lights, count * sizeof *lights);
    list->lights = lights ? lights : list->lights;
    return lights;
}

/* Send the photons of a kind and add them to `photons`; from: note their sources, or NULL. */
static Status emit(Emission *emission, MapKind kind, Stats *stats, PhotonList *photons,
                   PhotonOrigins *from)
{
    if (emission->budget == 0) {
        if (emission->source_count > 0) /* media that glow send no photons */
            warn_of_none(emission, kind,
                         map_is_aimed(kind) ? "no light reaches a target"
                                            : "no light reaches a surface");
        return OK;
    }
    PhotonList sent;
    double started = clock_wall();
    Status status = emission_run(emission, &sent);
    stats->seconds[PHASE_PHOTON_EMIT] += clock_wall() - started;
    if (status != OK)
        return status;
    count_paths(emission->books, emission->source_count, kind, stats);
    if (from && status == OK)
        status = origins_note(from, emission->books, emission->source_count, emission->diag);
    if (status != OK) {
        photon_list_free(&sent);
        return status;
    }
    if (sent.count == 0)
        warn_of_none(emission, kind, "no photon was stored");
    if (photons->count == 0) {
        photon_list_free(photons);
        *photons = sent;
        return OK;
    }
    bool has_room = make_room(photons, sent.count);
    if (has_room)
        photon_list_append(photons, &sent);
    photon_list_free(&sent);
    return has_room ? OK : diag_no_memory(emission->diag, "photons");
}

/* Make the map of what was sent; *map stays NULL when that is nothing. */
static Status build(const Emission *emission, Stats *stats, PhotonList *photons,
                    PhotonOrigins *from, PhotonMap **map)
{
    double started = clock_wall();
    Status status = OK;
    if (photons->count > 0)
        status = photon_map_new_full(emission->diag, photons->items, photons->lights,
                                     photons->count, emission->rules.center,
                                     emission->options->threads, from ? &from->order : NULL, map);
    else
        photon_list_free(photons);
    if (status == OK && from && *map)
        status = photon_map_watch(emission->diag, *map);
    *photons = (PhotonList){0};
    stats->seconds[PHASE_PHOTON_BUILD] += clock_wall() - started;
    return status;
}

static LightBooks **books_of(PhotonBooks *books, MapKind kind)
{
    return kind == MAP_CAUSTIC  ? &books->caustic
           : kind == MAP_GLOBAL ? &books->global
                                : &books->volume;
}

/* The balance of all photons of two books. */
static void join_balance(LightBooks *to, const LightBooks *from)
{
    float all = (float)to->emitted + (float)from->emitted;
    if (!(all > 0))
        return;
    float part = (float)from->emitted / all;
    to->balance = rgb_lerp(to->balance, from->balance, part);
    to->balance_error =
        rgb_hypot(rgb_scale(to->balance_error, 1 - part), rgb_scale(from->balance_error, part));
}

/* What is counted by photon. */
static void join_counts(LightBooks *to, const LightBooks *from)
{
    join_balance(to, from);
    to->budget += from->budget;
    to->emitted += from->emitted;
    to->stored_paths += from->stored_paths;
    to->absorbed += from->absorbed;
    to->escaped += from->escaped;
    to->cut += from->cut;
    to->stored += from->stored;
    to->seen += from->seen;
}

/* Add up the books of two kinds of photons in one map. */
static void join_books(LightBooks *to, const LightBooks *from)
{
    join_counts(to, from);
    to->power += from->power;
    to->flux_emitted = rgb_add(to->flux_emitted, from->flux_emitted);
    to->flux_stored = rgb_add(to->flux_stored, from->flux_stored);
    to->flux_absorbed = rgb_add(to->flux_absorbed, from->flux_absorbed);
    to->flux_escaped = rgb_add(to->flux_escaped, from->flux_escaped);
    to->flux_cut = rgb_add(to->flux_cut, from->flux_cut);
}

/* Each light's share is then that of the power of both. */
static void share_joined(LightBooks *books, int lights)
{
    double power = 0;
    for (int i = 0; i < lights; i++)
        power += books[i].power;
    for (int i = 0; i < lights; i++)
        books[i].share = power > 0 ? books[i].power / power : 0;
}

/* Take over the books of an emission. */
static void take_books(Emission *emission, MapKind kind, PhotonBooks *out)
{
    LightBooks **slot = books_of(out, kind);
    int *count = kind == MAP_CAUSTIC  ? &out->caustic_count
                 : kind == MAP_GLOBAL ? &out->global_count
                                      : &out->volume_count;
    LightBooks *before = *slot;
    for (int i = 0; before && i < *count; i++)
        join_books(&emission->books[i], &before[i]);
    if (before)
        share_joined(emission->books, emission->source_count);
    mem_free(before);
    *count = emission->source_count;
    *slot = emission->books;
    emission->books = NULL;
}

/* Is irradiance looked up where gather rays end?  One of many passes that keeps no records shoots
 * too few of them for that. */
static bool has_places(const Plan *plan)
{
    return plan_has(plan, FEATURE_FINAL_GATHER) &&
           (plan_has(plan, FEATURE_IRRADIANCE_CACHE) || !plan_has(plan, FEATURE_PROGRESSIVE));
}

/* Send photons of their own to find places, and estimate the irradiance there. */
static Status make_irradiance(Emission *emission, Stats *stats, PhotonMaps *maps)
{
    PhotonList places;
    double started = clock_wall(), shrink = emission->options->shrink;
    double area = shrink > 0 ? shrink * shrink : 1;
    double part = shrink > 0 ? IRRADIANCE_PART_SERIES * area : IRRADIANCE_PART;
    int most = miniature_photons(emission->options->miniature,
                                 gather_most(&tracer_scene(emission->tracer)->settings.photons));
    IrradianceOptions options = {.seed = emission->options->seed,
                                 .threads = emission->options->threads,
                                 .stats = stats,
                                 .is_watched = emission->options->is_watched,
                                 .area = area,
                                 .radius = photon_map_radius(maps->global, most)};
    Status status = emission_run_places(emission, part, &places);
    if (status == OK && places.count == 0)
        mem_free(places.items);
    else if (status == OK)
        status = irradiance_map_new(emission->tracer, maps->global, places.items, places.count,
                                    &options, emission->diag, &maps->irradiance);
    stats->seconds[PHASE_PHOTON_BUILD] += clock_wall() - started;
    return status;
}

static Status make_map(const Tracer *tracer, MapKind kind, const PhotonOptions *options, Diag *diag,
                       Stats *stats, PhotonList *photons, PhotonMaps *maps)
{
    Emission emission;
    double started = clock_wall();
    Status status = emission_init(&emission, tracer, kind, options, diag);
    PhotonMap **map = kind == MAP_CAUSTIC  ? &maps->caustic
                      : kind == MAP_GLOBAL ? &maps->global
                                           : &maps->volume;
    PhotonOrigins *from = kind == MAP_CAUSTIC  ? &maps->caustic_from
                          : kind == MAP_GLOBAL ? &maps->global_from
                                               : &maps->volume_from;
    from = options->is_watched ? from : NULL;
    stats->seconds[PHASE_PHOTON_EMIT] += clock_wall() - started;
    if (status == OK)
        status = emit(&emission, kind, stats, photons, from);
    if (kind == MAP_CAUSTIC)
        maps->has_no_caustics = emission.budget == 0;
    if (kind == MAP_FOCUS)
        maps->has_no_focus = emission.budget == 0;
    if (status == OK && !is_first_of_map(tracer_plan(tracer), kind))
        status = build(&emission, stats, photons, from, map);
    if (status == OK && kind == MAP_GLOBAL && *map && has_places(tracer_plan(tracer)))
        status = make_irradiance(&emission, stats, maps);
    if (status == OK)
        take_books(&emission, kind, &maps->books);
    emission_done(&emission, stats);
    return status;
}

/* A photon spread over so much that it gives less than this part of the light of the brightest
 * lamp is not seen as a speck. */
#define FAINT_PHOTON 4e-3

/* How far a gather widens beyond its radius at least. */
#define WIDEN 3

/* Return the radius at which a photon of mean power is too faint to be a speck.  Lamps that no
 * photon comes from do not count: they may light nothing that is seen. */
static double speck_radius(const Tracer *tracer, const PhotonMap *map, const LightBooks *books)
{
    const Scene *scene = tracer_scene(tracer);
    Rgb flux = RGB_BLACK;
    uint64_t stored = 0;
    double lamp = 0;
    for (int i = 0; i < scene->light_count; i++) {
        const Light *light = &scene->lights[i];
        if (books[i].stored == 0)
            continue;
        double far = v3_dist(light->location, photon_map_center(map));
        lamp = fmax(lamp, (double)rgb_max(light->color) * light_fade(light, far));
        flux = rgb_add(flux, books[i].flux_stored);
        stored += books[i].stored;
    }
    double mean = stored > 0 ? (double)rgb_max(flux) / (double)stored : 0;
    return lamp > 0 ? sqrt(mean / (lamp * FAINT_PHOTON * PMS_PI)) : 0;
}

static void set_radii(const Tracer *tracer, const Miniature *miniature, PhotonMaps *maps)
{
    const PhotonSettings *settings = &tracer_scene(tracer)->settings.photons;
    int most = miniature_photons(miniature, gather_most(settings));
    if (maps->caustic) {
        maps->caustic_radius = settings->radius > 0 ? miniature_radius(miniature, settings->radius)
                                                    : photon_map_radius(maps->caustic, most);
        maps->caustic_far = fmax(speck_radius(tracer, maps->caustic, maps->books.caustic),
                                 WIDEN * maps->caustic_radius);
    }
    if (maps->global) {
        maps->global_radius = photon_map_radius(maps->global, most);
        maps->global_far = WIDEN * maps->global_radius;
    }
}

Status photon_pass(const Tracer *tracer, const PhotonOptions *options, Diag *diag, Stats *stats,
                   PhotonMaps *out)
{
    const Plan *plan = tracer_plan(tracer);
    *out = (PhotonMaps){0};
    double sizes[MAP_COUNT] = {(double)plan->caustic_photons, (double)plan->global_photons,
                               (double)plan->caustic_photons, (double)plan->global_photons};
    double done = 0, total = 0;
    for (int kind = 0; kind < MAP_COUNT; kind++)
        total += is_wanted(plan, (MapKind)kind) ? sizes[kind] : 0;
    PhotonList photons = {0};
    Status status = OK;
    for (int kind = 0; kind < MAP_COUNT && status == OK; kind++) {
        if (!is_wanted(plan, (MapKind)kind))
            continue;
        double length = total > 0 ? sizes[kind] / total : 1;
        Progress progress = {options, done, length};
        PhotonOptions part = *options;
        part.progress = options->progress ? progress_part : NULL;
        part.progress_ctx = &progress;
        done += length;
        status = make_map(tracer, (MapKind)kind, &part, diag, stats, &photons, out);
    }
    photon_list_free(&photons);
    if (status != OK)
        photon_maps_done(out);
    else if (!options->has_radii)
        set_radii(tracer, options->miniature, out);
    return status;
}

void photon_maps_done(PhotonMaps *maps)
{
    photon_map_free(maps->caustic);
    photon_map_free(maps->global);
    irradiance_map_free(maps->irradiance);
    photon_map_free(maps->volume);
    origins_done(&maps->caustic_from);
    origins_done(&maps->global_from);
    origins_done(&maps->volume_from);
    photon_books_done(&maps->books);
    *maps = (PhotonMaps){0};
}

Status photon_maps_count_seen(PhotonMaps *maps, Diag *diag)
{
    PhotonBooks *books = &maps->books;
    if (maps->irradiance)
        TRY(irradiance_map_see(maps->irradiance, diag));
    if (maps->caustic)
        origins_count_seen(&maps->caustic_from, maps->caustic, books->caustic);
    if (maps->global)
        origins_count_seen(&maps->global_from, maps->global, books->global);
    if (maps->volume)
        origins_count_seen(&maps->volume_from, maps->volume, books->volume);
    return OK;
}

Status photon_plan_budgets(const Tracer *tracer, const PhotonOptions *options, Diag *diag,
                           PhotonBooks *out)
{
    *out = (PhotonBooks){0};
    Status status = OK;
    for (int kind = 0; kind < MAP_COUNT && status == OK; kind++) {
        if (!is_wanted(tracer_plan(tracer), (MapKind)kind))
            continue;
        Emission emission;
        status = emission_init(&emission, tracer, (MapKind)kind, options, diag);
        if (status == OK)
            take_books(&emission, (MapKind)kind, out);
        emission_done(&emission, NULL);
    }
    if (status != OK)
        photon_books_done(out);
    return status;
}

/* Make `mean` that of `before` values like it and one more. */
static double mean_of(double mean, double value, uint64_t before)
{
    return mean + (value - mean) / ((double)before + 1);
}

static Rgb mean_flux(Rgb mean, Rgb value, uint64_t before)
{
    return rgb_mad(mean, 1 / ((float)before + 1), rgb_sub(value, mean));
}

static void add_book(LightBooks *to, const LightBooks *from, uint64_t before)
{
    join_counts(to, from);
    to->power = mean_of(to->power, from->power, before);
    to->share = mean_of(to->share, from->share, before);
    to->flux_emitted = mean_flux(to->flux_emitted, from->flux_emitted, before);
    to->flux_stored = mean_flux(to->flux_stored, from->flux_stored, before);
    to->flux_absorbed = mean_flux(to->flux_absorbed, from->flux_absorbed, before);
    to->flux_escaped = mean_flux(to->flux_escaped, from->flux_escaped, before);
    to->flux_cut = mean_flux(to->flux_cut, from->flux_cut, before);
}

static void add_map_books(LightBooks **to, LightBooks **from, int count, uint64_t before)
{
    if (!*to) {
        *to = *from;
        *from = NULL;
        return;
    }
    for (int i = 0; *from && i < count; i++)
        add_book(&(*to)[i], &(*from)[i], before);
}

void photon_books_add(PhotonBooks *to, PhotonBooks *from, uint64_t before)
{
    to->caustic_count = from->caustic_count;
    to->global_count = from->global_count;
    to->volume_count = from->volume_count;
    add_map_books(&to->caustic, &from->caustic, from->caustic_count, before);
    add_map_books(&to->global, &from->global, from->global_count, before);
    add_map_books(&to->volume, &from->volume, from->volume_count, before);
}

void photon_books_done(PhotonBooks *books)
{
    mem_free(books->caustic);
    mem_free(books->global);
    mem_free(books->volume);
    *books = (PhotonBooks){0};
}
