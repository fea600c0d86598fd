/* pms render: a scene in, OpenEXR and PNG out.  SPDX-License-Identifier: Apache-2.0 */
#include "cli/cli.h"
#include "cli/progress.h"
#include "cli/replay.h"
#include "cli/verdict.h"

#include "base/file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Without -o: the scene's name with .exr and .png, in the current folder. */
static Status default_outputs(Args *args)
{
    const char *base = path_base(args->operands[0]);
    const char *extension = path_extension(base);
    size_t length = strlen(base) - (*extension ? strlen(extension) + 1 : 0);
    const char **paths = ARENA_ARRAY(args->arena, const char *, 2);
    static const char *const endings[2] = {".exr", ".png"};
    for (int i = 0; paths && i < 2; i++) {
        char *path = arena_alloc(args->arena, length + sizeof ".exr");
        if (!path)
            return diag_no_memory(args->diag, "the command line");
        memcpy(path, base, length);
        memcpy(path + length, endings[i], sizeof ".exr");
        paths[i] = path;
    }
    args->outputs = paths;
    args->output_count = 2;
    return paths ? OK : diag_no_memory(args->diag, "the command line");
}

static Status write_stats(const Args *args, const Scene *scene, const RenderResult *result)
{
    const char *path = args->value[OPT_STATS];
    if (!path)
        return OK;
    if (strcmp(path, "-") == 0) {
        stats_print_json(stdout, scene, result);
        return OK;
    }
    char *text = NULL;
    size_t size = 0;
    FILE *file = open_memstream(&text, &size);
    if (!file)
        return diag_no_memory(args->diag, "the statistics");
    stats_print_json(file, scene, result);
    Status status = fclose(file) == 0 ? file_write(args->diag, path, text, size)
                                      : diag_no_memory(args->diag, "the statistics");
    free(text);
    return status;
}

typedef struct Job {
    const Args *args;
    const Scene *scene;
    double parse_seconds;
    Progress progress;
} Job;

/* Write the pictures. */
static Status write_pictures(const Job *job, RenderResult *result)
{
    const Args *args = job->args;
    const char *errors = args->value[OPT_ERROR_MAP];
    double start = clock_wall();
    TRY(output_write(args, job->scene, result, args->outputs, args->output_count));
    if (errors && result->error_picture.layer_count > 0)
        TRY(picture_write(args->diag, errors, &result->error_picture));
    result->stats.seconds[PHASE_WRITE] += clock_wall() - start;
    return OK;
}

/* Write pictures and statistics. */
static Status write_all(const Job *job, RenderResult *result)
{
    result->stats.seconds[PHASE_PARSE] = job->parse_seconds;
    TRY(write_pictures(job, result));
    return write_stats(job->args, job->scene, result);
}

/* Write the pictures of the passes so far. */
static Status show_so_far(void *ctx, RenderResult *so_far)
{
    Job *job = ctx;
    progress_done(&job->progress);
    return write_pictures(job, so_far);
}

static Status tell_interrupted(const Job *job, const RenderResult *result)
{
    if (result->passes == 0)
        return diag_fail(job->args->diag, ERR_INTERRUPTED, "interrupted; no picture was written");
    bool is_kept = args_has(job->args, OPT_PROGRESSIVE);
    return diag_fail(
        job->args->diag, ERR_INTERRUPTED, "interrupted; the picture is of %llu pass%s, %s",
        (unsigned long long)result->passes, result->passes == 1 ? "" : "es",
        is_kept ? "--resume goes on from there" : "which only --progressive keeps for --resume");
}

/* A progressive render that ends early has a picture all the same. */
static Status render_loaded(Job *job, const RenderOptions *options)
{
    RenderResult result;
    double start = clock_wall();
    Status status = render_scene(job->scene, options, job->args->diag, &result);
    progress_done(&job->progress);
    Status written = OK;
    if (status == OK || result.image.layer_count > 0)
        written = write_all(job, &result);
    if (written == ERR_INTERRUPTED)
        diag_fail(job->args->diag, written, "interrupted; the picture was not written");
    else if (status == ERR_INTERRUPTED)
        tell_interrupted(job, &result);
    else if (status == OK && written == OK && result.passes > 0)
        progress_say_passes(&job->progress, job->args, &result, clock_wall() - start,
                            options->progressive.error);
    render_result_done(&result);
    return status != OK ? status : written;
}

static Status prepare(Job *job, RenderOptions *options)
{
    const Args *args = job->args;
    TRY(args_render_options(args, options));
    TRY(output_preflight(args, args->outputs, args->output_count));
    if (options->has_error_picture)
        TRY(picture_preflight(args, args->value[OPT_ERROR_MAP]));
    if (options->progressive.state_path)
        TRY(output_can_write(args, options->progressive.state_path));
    TRY(progress_init(&job->progress, args));
    options->progress = progress_show;
    options->progress_ctx = &job->progress;
    options->progressive.show = args_has(args, OPT_PROGRESSIVE) ? show_so_far : NULL;
    options->progressive.show_ctx = job;
    options->progressive.tell = progress_tell_plan;
    options->progressive.tell_ctx = &job->progress;
    if (options->progressive.seconds > 0) /* reading the scene is a part of it */
        options->progressive.seconds =
            fmax(1e-3, options->progressive.seconds - job->parse_seconds);
    return OK;
}

Status render_cmd(Args *args)
{
    TRY(args_want_operands(args, 1, "one scene file"));
    bool is_replay = args_has(args, OPT_REPLAY);
    if (args->output_count == 0 && !is_replay)
        TRY(default_outputs(args));
    Scene *scene;
    RenderOptions options;
    Job job = {.args = args};
    TRY(args_load_scene(args, 0, &scene, &job.parse_seconds));
    job.scene = scene;
    Status status = is_replay ? args_render_options(args, &options) : prepare(&job, &options);
    if (status == OK)
        status = is_replay ? replay_run(args, scene, &options) : render_loaded(&job, &options);
    scene_free(scene);
    return status;
}
