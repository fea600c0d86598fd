/* pms study: what accuracy costs in a scene.  SPDX-License-Identifier: Apache-2.0 */
#include "cli/cli.h"
#include "cli/progress.h"

#include "base/file.h"
#include "base/work.h"
#include "study/report.h"

#include <string.h>

/* Seconds for all of it when nothing else is said. */
#define SECONDS_DEFAULT 600

typedef struct Job {
    Args *args;
    const Scene *scene;
    StudyOptions options;
    ReportLook look;
    Progress progress;
} Job;

/* Without -o: the scene's name with .study, in the current folder. */
static Status choose_folder(Job *job)
{
    Args *args = job->args;
    const char *base = path_base(args->operands[0]), *extension = path_extension(base);
    size_t length = strlen(base) - (*extension ? strlen(extension) + 1 : 0);
    if (args->output_count > 1)
        return diag_fail(args->diag, ERR_USAGE, "a study goes into one folder, got %d with -o",
                         args->output_count);
    if (args->output_count == 1) {
        job->options.folder = args->outputs[0];
        return OK;
    }
    size_t size = length + sizeof ".study";
    char *folder = arena_alloc(args->arena, size);
    if (folder)
        snprintf(folder, size, "%.*s.study", (int)length, base);
    job->options.folder = folder;
    return folder ? OK : diag_no_memory(args->diag, "a study");
}

/* --time bounds the study, not a render of it. */
static Status read_options(Job *job)
{
    Args render = *job->args;
    StudyOptions *options = &job->options;
    options->seconds = SECONDS_DEFAULT;
    TRY(args_time(job->args, &options->seconds));
    render.value[OPT_TIME] = NULL;
    TRY(args_render_options(&render, &options->render));
    options->reference_path = job->args->value[OPT_REFERENCE];
    job->look = (ReportLook){job->args->value[OPT_OCIO], job->args->value[OPT_DISPLAY],
                             job->args->value[OPT_VIEW]};
    TRY(choose_folder(job));
    TRY(progress_init(&job->progress, job->args));
    options->render.progress = progress_show;
    options->render.progress_ctx = &job->progress;
    return OK;
}

static Status tell(const Job *job, const Study *study, Status ended)
{
    const Args *args = job->args;
    Status written = report_write(study, &job->look);
    if (args_has(args, OPT_JSON))
        report_print_json(stdout, study);
    else
        report_print_text(stdout, study);
    if (ended == ERR_INTERRUPTED)
        return diag_fail(args->diag, ended,
                         "interrupted; the report in '%s' is of %d runs of %d, the same command "
                         "goes on from there",
                         study->options.folder, study_done_count(study), study_run_count(study));
    if (written == OK && job->progress.kind != PROGRESS_NONE)
        fprintf(stderr, "pms: the report is '%s/study.html'\n", study->options.folder);
    return ended != OK ? ended : written;
}

static Status study_loaded(Job *job)
{
    Study study;
    TRY(read_options(job));
    Status status = study_run(job->scene, &job->options, job->args->arena, job->args->diag, &study);
    progress_done(&job->progress);
    if (study.analysis.row_count > 0)
        status = tell(job, &study, status);
    else if (status == ERR_INTERRUPTED)
        diag_fail(job->args->diag, status,
                  "interrupted before the first result; the same command goes on from there");
    study_done(&study);
    return status;
}

Status study_cmd(Args *args)
{
    TRY(args_want_operands(args, 1, "one scene file"));
    Scene *scene;
    double seconds;
    TRY(args_load_scene(args, 0, &scene, &seconds));
    Job *job = arena_alloc(args->arena, sizeof *job);
    Status status = job ? OK : diag_no_memory(args->diag, "a study");
    if (job) {
        job->args = args;
        job->scene = scene;
        status = study_loaded(job);
    }
    scene_free(scene);
    return status;
}
