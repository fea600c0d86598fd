/* pms render: a scene in, OpenEXR and PNG out.  SPDX-License-Identifier: Apache-2.0 */
#include "cli/cli.h"
#include "cli/progress.h"

#include "base/file.h"

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

static Status render_loaded(Args *args, const Scene *scene, double parse_seconds)
{
    RenderOptions options;
    RenderResult result;
    Progress progress;
    TRY(args_render_options(args, &options));
    TRY(progress_init(&progress, args));
    options.progress = progress_show;
    options.progress_ctx = &progress;
    Status status = render_scene(scene, &options, args->diag, &result);
    progress_done(&progress);
    if (status == ERR_INTERRUPTED)
        return diag_fail(args->diag, status, "interrupted; no picture was written");
    TRY(status);
    double start = clock_wall();
    result.stats.seconds[PHASE_PARSE] = parse_seconds;
    status = output_write(args, scene, &result, args->outputs, args->output_count);
    result.stats.seconds[PHASE_WRITE] = clock_wall() - start;
    if (status == OK)
        status = write_stats(args, scene, &result);
    render_result_done(&result);
    return status;
}

Status render_cmd(Args *args)
{
    TRY(args_want_operands(args, 1, "one scene file"));
    if (args->output_count == 0)
        TRY(default_outputs(args));
    Scene *scene;
    double seconds;
    TRY(args_load_scene(args, 0, &scene, &seconds));
    Status status = output_preflight(args, args->outputs, args->output_count);
    if (status == OK)
        status = render_loaded(args, scene, seconds);
    scene_free(scene);
    return status;
}
