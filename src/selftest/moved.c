/* pms selftest SCENE: a scene scaled, shifted and turned as a whole.
 *
 * A scaling by a power of two rounds no number, so that every random number and every decision is
 * what it was.  Shifts and turns round, and so photons and gather rays may go other ways; what they
 * may change is what other seeds change.  SPDX-License-Identifier: Apache-2.0 */
#include "selftest/selftest_int.h"

#include "eye/camera.h"
#include "trace/trace.h"

enum { SEEDS = 4 /* pictures of the unmoved scene, to see how far chance reaches */ };

typedef enum MoveKind { MOVE_SCALE, MOVE_SHIFT, MOVE_TURN } MoveKind;

typedef struct Move {
    const char *name;
    MoveKind kind;
    double amount; /* factor; sizes of the scene; radians */
    V3 axis;       /* unit: of the shift or turn */
} Move;

#define ASLANT                                                                                     \
    {                                                                                              \
        0.48, 0.6, 0.64                                                                            \
    }

static const Move moves[] = {
    {"scaled by 2^-10", MOVE_SCALE, 0x1p-10, {0, 0, 0}},
    {"scaled by 2^10", MOVE_SCALE, 0x1p10, {0, 0, 0}},
    {"scaled by 2^20", MOVE_SCALE, 0x1p20, {0, 0, 0}},
    {"shifted by 10 sizes", MOVE_SHIFT, 10, ASLANT},
    {"shifted by 1e3 sizes", MOVE_SHIFT, 1e3, ASLANT},
    {"shifted by 1e6 sizes", MOVE_SHIFT, 1e6, ASLANT},
    {"turned 90 degrees about x", MOVE_TURN, PMS_PI / 2, {1, 0, 0}},
    {"turned 90 degrees about y", MOVE_TURN, PMS_PI / 2, {0, 1, 0}},
    {"turned 90 degrees about z", MOVE_TURN, PMS_PI / 2, {0, 0, 1}},
    {"turned 30 degrees aslant", MOVE_TURN, PMS_PI / 6, ASLANT},
};

/* The unmoved scene, to ask what is where. */
typedef struct Original {
    Scene *scene;
    Plan plan;
    Tracer *tracer;
    TraceThread thread;
    CameraRays rays;
    double size; /* scene units */
} Original;

/* --- the scene as it is ---------------------------------------------------------------------- */

/* Read the scene as the command `pms render` would. */
static Status load(const MovedOptions *options, const SdlOptions *sdl, Diag *diag, Scene **out)
{
    TRY(sdl_load(diag, options->path, sdl, out));
    if (options->render->plan.effects[FEATURE_CAUSTIC_MAP] == TRI_ON)
        scene_add_photons(*out);
    return OK;
}

/* The size of what has bounds; 1 if nothing has. */
static double scene_size(const Scene *scene)
{
    Bound all = BOUND_EMPTY;
    for (uint32_t i = 0; i < scene->object_count; i++)
        if (bound_is_finite(scene->objects[i].bound))
            all = bound_union(all, scene->objects[i].bound);
    return bound_is_empty(all) ? 1 : 2 * bound_radius(all);
}

static Status original_init(Original *original, const MovedOptions *options, Diag *diag)
{
    const RenderOptions *render = options->render;
    Scene *scene = original->scene;
    original->size = scene_size(scene);
    camera_rays_init(&original->rays, &scene->camera, render->width, render->height);
    if (plan_make(scene, &render->plan, scene->arena, &original->plan) != OK)
        return diag_no_memory(diag, "the plan");
    TRY(tracer_new(scene, &original->plan, render->threads, diag, &original->tracer));
    return trace_thread_init(&original->thread, original->tracer, diag);
}

static void original_done(Original *original)
{
    if (original->thread.tracer)
        trace_thread_done(&original->thread);
    tracer_free(original->tracer);
    scene_free(original->scene);
}

/* Return the object that the middle of a pixel shows, or NULL. */
static const Object *object_at(Original *original, int x, int y)
{
    Hit hit;
    Ray ray = camera_ray(&original->rays, x + 0.5, y + 0.5);
    return trace_closest(&original->thread, &ray, RAY_CAMERA, &hit) ? hit.object : NULL;
}

/* --- drawing --------------------------------------------------------------------------------- */

static Similarity move_by(const Move *move, double size)
{
    const Xform upright = XFORM_IDENTITY;
    if (move->kind == MOVE_SCALE)
        return similarity_make(&upright, move->amount, v3(0, 0, 0));
    if (move->kind == MOVE_SHIFT)
        return similarity_make(&upright, 1, v3_scale(move->axis, move->amount * size));
    Xform turn = xform_axis_rotate(move->axis, move->amount);
    return similarity_make(&turn, 1, v3(0, 0, 0));
}

/* Draw the scene moved, without a word: all there is to warn of was said of the unmoved scene. */
static Status draw_moved(const MovedOptions *options, const Similarity *by, uint64_t more_seed,
                         Image *out)
{
    SdlOptions sdl = *options->sdl;
    RenderOptions render = *options->render;
    Diag quiet;
    Scene *scene;
    sdl.moved_by = by;
    render.plan.light_radius *= by->scale;
    render.seed += more_seed;
    diag_init(&quiet, diag_drop, NULL);
    Status status = load(options, &sdl, &quiet, &scene);
    if (status == OK)
        status = selftest_draw_scene(scene, &render, &quiet, out);
    scene_free(scene);
    diag_done(&quiet);
    return status;
}

/* What chance may have done is looked at again with another seed. */
static Status look_again(const MovedOptions *options, const Similarity *by, const ChangeBase *base,
                         Diag *diag, Image *picture, Change *change)
{
    Image again;
    if (change_kind(change) != CHANGE_SEEN || base->seed_rmse == 0)
        return OK;
    TRY(draw_moved(options, by, SEEDS, &again));
    change_keep_less(base, picture, &again);
    image_done(&again);
    return change_find(base, picture, diag, change);
}

static Status find_change(const MovedOptions *options, const Similarity *by, const ChangeBase *base,
                          Diag *diag, Change *change)
{
    Image picture;
    TRY(draw_moved(options, by, 0, &picture));
    Status status = change_find(base, &picture, diag, change);
    if (status == OK)
        status = look_again(options, by, base, diag, &picture, change);
    image_done(&picture);
    return status;
}

static Status do_move(const Move *move, Original *original, const ChangeBase *base,
                      const MovedOptions *options, Diag *diag, int *failed)
{
    Similarity by = move_by(move, original->size);
    MoveResult result = {.name = move->name, .change.is_exact = move->kind == MOVE_SCALE};
    Status status = find_change(options, &by, base, diag, &result.change);
    if (status == ERR_INTERRUPTED)
        return status;
    if (status != OK)
        return diag_fail(diag, status, "the scene cannot be drawn %s", move->name);
    result.worst = object_at(original, result.change.x, result.change.y);
    *failed += !change_is_good(&result.change);
    options->done(options->ctx, &result);
    return OK;
}

static Status do_moves(Original *original, const Image *pictures, const MovedOptions *options,
                       Diag *diag, int *failed)
{
    ChangeBase base;
    TRY(change_base_init(&base, pictures, SEEDS, diag));
    options->begun(options->ctx, &base, original->size);
    Status status = OK;
    for (size_t i = 0; i < sizeof moves / sizeof *moves && status == OK; i++)
        status = do_move(&moves[i], original, &base, options, diag, failed);
    change_base_done(&base);
    return status;
}

/* Draw the unmoved scene with several seeds; the first time warnings are shown. */
static Status draw_seeds(const Scene *scene, const RenderOptions *options, Diag *diag, Image *out)
{
    Diag quiet;
    diag_init(&quiet, diag_drop, NULL);
    Status status = OK;
    for (int i = 0; i < SEEDS && status == OK; i++) {
        RenderOptions render = *options;
        render.seed += (uint64_t)i;
        status = selftest_draw_scene(scene, &render, i ? &quiet : diag, &out[i]);
    }
    diag_done(&quiet);
    return status;
}

static Status do_scene(Original *original, const MovedOptions *options, Diag *diag, int *failed)
{
    Image pictures[SEEDS] = {0};
    Status status = original_init(original, options, diag);
    if (status == OK)
        status = draw_seeds(original->scene, options->render, diag, pictures);
    if (status == OK)
        status = do_moves(original, pictures, options, diag, failed);
    for (int i = 0; i < SEEDS; i++)
        image_done(&pictures[i]);
    return status;
}

Status selftest_moved(const MovedOptions *options, Diag *diag, int *failed)
{
    Original original = {.scene = NULL};
    *failed = 0;
    TRY(load(options, options->sdl, diag, &original.scene));
    Status status = do_scene(&original, options, diag, failed);
    original_done(&original);
    return status;
}
