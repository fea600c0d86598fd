/* A scene read from text and its photon maps, for tests of light.  Include after cmocka.h.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TESTS_LIT_SCENE_H
#define PMS_TESTS_LIT_SCENE_H

#include "photon/gather.h"
#include "photon/photon_pass.h"
#include "sdl/sdl.h"

#include <stdio.h>
#include <string.h>

typedef struct LitScene {
    Diag diag;
    char messages[4096]; /* what was said */
    Scene *scene;
    Plan plan;
    Tracer *tracer;
    PhotonOptions options;
    Stats stats;
    PhotonMaps maps;
    GatherScratch *scratch;
} LitScene;

static inline void lit_listen(void *ctx, const char *text)
{
    LitScene *lit = ctx;
    size_t used = strlen(lit->messages);
    snprintf(lit->messages + used, sizeof lit->messages - used, "%s", text);
}

/* Make plan and tracer of a scene that was read. */
static inline void lit_prepare(LitScene *lit, Status status, int threads, uint64_t seed,
                               PlanOptions plan_options)
{
    if (status != OK)
        print_message("%s", lit->messages);
    assert_int_equal(status, OK);
    assert_int_equal(plan_make(lit->scene, &plan_options, lit->scene->arena, &lit->plan), OK);
    assert_int_equal(tracer_new(lit->scene, &lit->plan, 1, &lit->diag, &lit->tracer), OK);
    lit->options = (PhotonOptions){.seed = seed, .threads = threads};
    lit->scratch = gather_scratch_new();
}

/* Read a scene and make its plan and tracer. */
static inline void lit_read_as(LitScene *lit, const char *text, int threads, uint64_t seed,
                               PlanOptions plan_options)
{
    memset(lit, 0, sizeof *lit);
    diag_init(&lit->diag, lit_listen, lit);
    SdlOptions options = {.width = 320, .height = 240, .threads = 1};
    Status status =
        sdl_load_text(&lit->diag, "test.pms", text, strlen(text), &options, &lit->scene);
    lit_prepare(lit, status, threads, seed, plan_options);
}

static inline void lit_read(LitScene *lit, const char *text, int threads, uint64_t seed)
{
    lit_read_as(lit, text, threads, seed, PLAN_OPTIONS_DEFAULT);
}

/* Read a scene and run its photon pass. */
static inline void lit_make(LitScene *lit, const char *text, int threads, uint64_t seed)
{
    lit_read(lit, text, threads, seed);
    Status status = photon_pass(lit->tracer, &lit->options, &lit->diag, &lit->stats, &lit->maps);
    assert_int_equal(status, OK);
}

/* Read a scene file and run its photon pass. */
static inline void lit_make_file(LitScene *lit, const char *path, int threads, uint64_t seed)
{
    memset(lit, 0, sizeof *lit);
    diag_init(&lit->diag, lit_listen, lit);
    static const char *const library = "stdlib";
    SdlOptions options = {.library_paths = &library,
                          .library_path_count = 1,
                          .width = 320,
                          .height = 240,
                          .threads = 1};
    Status status = sdl_load(&lit->diag, path, &options, &lit->scene);
    lit_prepare(lit, status, threads, seed, PLAN_OPTIONS_DEFAULT);
    status = photon_pass(lit->tracer, &lit->options, &lit->diag, &lit->stats, &lit->maps);
    assert_int_equal(status, OK);
}

static inline void lit_done(LitScene *lit)
{
    gather_scratch_free(lit->scratch);
    photon_maps_done(&lit->maps);
    tracer_free(lit->tracer);
    scene_free(lit->scene);
    diag_done(&lit->diag);
}

/* Everything within a radius, nothing else: an estimate that keeps the light. */
static inline GatherLimits lit_within(double radius)
{
    return (GatherLimits){.max_radius = radius, .shape = GATHER_DISK, .normal_cosine = 0.5};
}

static inline Rgb lit_photon_power(const PhotonMap *map, size_t index)
{
    Photon photon = photon_map_at(map, index);
    return rgbe_decode(photon.rgbe);
}

static inline V3 lit_photon_place(const PhotonMap *map, size_t index)
{
    Photon photon = photon_map_at(map, index);
    return v3_add(photon_map_center(map), v3(photon.pos[0], photon.pos[1], photon.pos[2]));
}

#endif
