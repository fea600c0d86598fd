/* Running a study: the folder, the reference, the runs.  SPDX-License-Identifier: Apache-2.0 */
#include "study/study.h"

#include "base/hash.h"
#include "base/mem.h"
#include "base/work.h"
#include "image/exr.h"
#include "render/checkpoint.h"
#include "study/reference.h"
#include "study/schedule.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* The part of the time that the reference may take. */
#define REFERENCE_PART 0.3

/* The reference is good enough when its noise is this part of the error of the scene as it stands:
 * the best pictures of a study have a tenth of that error. */
#define REFERENCE_ERROR_PART 0.03

/* Seconds kept for writing the report, or this part of all if that is less. */
#define REPORT_SECONDS 5
#define REPORT_PART 0.05

enum { TEXT_BYTES_MAX = 1 << 20, REFERENCE_BYTES_MAX = 1 << 30 };

/* Bytes that the longest name in the folder takes, also while it is being written. */
enum { NAME_BYTES_MAX = 128 };

StudyPath study_path(const Study *study, const char *name)
{
    StudyPath path;
    snprintf(path.text, sizeof path.text, "%s/%s", study->options.folder, name);
    return path;
}

StudyPath study_picture_path(const Study *study, const StudyPoint *point)
{
    char picture[NAME_BYTES_MAX];
    const char *name =
        point->setting == SETTING_OWN ? "own" : setting_name((SettingId)point->setting);
    snprintf(picture, sizeof picture, "pictures/%s_%g%s.exr", name, point->value,
             point->is_fine ? "_fine" : "");
    return study_path(study, picture);
}

/* --- time and progress ---------------------------------------------------------------------- */

static double time_left(const Study *study)
{
    double seconds = study->options.seconds;
    double report = fmin(REPORT_SECONDS, REPORT_PART * seconds);
    return study->started + seconds - report - clock_wall();
}

/* Tell how far the study is, whatever a render in it says. */
static void report_progress(void *ctx, const RenderProgress *of_render)
{
    Study *study = ctx;
    const RenderOptions *asked = &study->options.render;
    double elapsed = clock_wall() - study->started, left = fmax(0, time_left(study));
    if (study->run_expected > 0) {
        double of_run = study->run_expected - (clock_wall() - study->run_started);
        left = fmin(left, schedule_rest(study) - study->run_expected + fmax(0, of_run));
    }
    (void)of_render;
    RenderProgress progress = {
        .phase = study->phase, .fraction = elapsed / (elapsed + left + 1e-9), .seconds_left = left};
    asked->progress(asked->progress_ctx, &progress);
}

static void listen(Study *study, RenderOptions *render)
{
    render->threads = study->options.render.threads;
    render->progress = study->options.render.progress ? report_progress : NULL;
    render->progress_ctx = study;
}

/* --- what the folder is of ------------------------------------------------------------------ */

static Status describe_reference(const Study *study, char *text, size_t size)
{
    const char *path = study->options.reference_path, *bytes;
    size_t length = 0;
    if (!path) {
        snprintf(text, size, "reference built\n");
        return OK;
    }
    Arena *scratch = arena_new();
    Status status =
        scratch ? file_read(study->diag, path, REFERENCE_BYTES_MAX, scratch, &bytes, &length)
                : diag_no_memory(study->diag, path);
    if (status == OK)
        snprintf(text, size, "reference #%016llx\n",
                 (unsigned long long)hash_bytes(0, bytes, length));
    arena_free(scratch);
    return status;
}

static Status describe(const Study *study, char text[CHECKPOINT_SETTINGS_MAX])
{
    const RenderOptions *render = &study->options.render;
    checkpoint_describe(study->base.scene, render, text);
    size_t used = strlen(text);
    used += (size_t)snprintf(text + used, CHECKPOINT_SETTINGS_MAX - used,
                             "threads %d\nantialiasing %d %g %d %g\n", render->threads,
                             (int)render->aa, render->aa_threshold, render->aa_depth,
                             render->aa_has_jitter ? render->aa_jitter : 0);
    return describe_reference(study, text + used, CHECKPOINT_SETTINGS_MAX - used);
}

static Status check_folder(const Study *study)
{
    const char *folder = study->options.folder;
    size_t length = strlen(folder), most = FILE_PATH_MAX - NAME_BYTES_MAX;
    if (length <= most)
        return OK;
    return diag_fail(study->diag, ERR_FILE,
                     "the path of the folder '%.60s...' is too long, %zu bytes of at most %zu",
                     folder, length, most);
}

/* Make the folder, or see that what is there is of the same picture. */
static Status open_folder(Study *study)
{
    const char *folder = study->options.folder, *there;
    char here[CHECKPOINT_SETTINGS_MAX], difference[2 * CHECKPOINT_SETTINGS_MAX];
    StudyPath settings = study_path(study, "settings.txt"),
              pictures = study_path(study, "pictures");
    size_t size;
    TRY(check_folder(study));
    TRY(describe(study, here));
    if ((mkdir(folder, 0777) != 0 && errno != EEXIST) ||
        (mkdir(pictures.text, 0777) != 0 && errno != EEXIST))
        return diag_fail(study->diag, ERR_FILE, "cannot make the folder '%s': %s", folder,
                         strerror(errno));
    if (!file_exists(settings.text))
        return file_write(study->diag, settings.text, here, strlen(here));
    TRY(file_read(study->diag, settings.text, TEXT_BYTES_MAX, study->arena, &there, &size));
    if (strcmp(there, here) == 0)
        return OK;
    checkpoint_difference(there, here, difference, sizeof difference);
    return diag_fail(study->diag, ERR_USAGE,
                     "'%s' holds the study of another picture: %s; name another folder with -o, or "
                     "remove that one",
                     folder, difference);
}

/* --- one run -------------------------------------------------------------------------------- */

/* Render a point.  The picture is the caller's. */
static Status render_point(Study *study, const StudyPoint *point, int seed, Diag *diag,
                           StudyRun *run, Image *image)
{
    RenderResult result;
    RenderOptions render = point->options;
    listen(study, &render);
    render.seed = study->options.render.seed + (uint64_t)seed;
    snprintf(study->phase, sizeof study->phase, "%s %s, seed %d",
             point->setting == SETTING_OWN ? "scene" : setting_name((SettingId)point->setting),
             point->label, seed);
    double started = clock_wall();
    Status status = render_scene(&point->scene, &render, diag, &result);
    *run = (StudyRun){.seconds = clock_wall() - started,
                      .estimate = result.error.is_known ? result.error.whole : NAN,
                      .bound = result.error.is_known ? result.error.bound : NAN};
    memcpy(run->phase, result.stats.seconds, sizeof run->phase);
    run->radius = result.first_radii.caustic;
    *image = result.image;
    result.image = (Image){0};
    render_result_done(&result);
    if (status != OK)
        image_done(image);
    return status;
}

static Status keep_picture(const Study *study, const StudyPoint *point, const Image *image)
{
    return exr_write(study->diag, study_picture_path(study, point).text, image, NULL,
                     (ExrOptions){.is_half = true});
}

/* Measure a picture and write down what came of the run. */
static Status settle_run(Study *study, int number, const StudyPoint *point, const Image *image,
                         StudyRun *run)
{
    int seed = number % STUDY_SEEDS;
    RunKey key = {point->setting, point->value, point->is_fine, seed};
    TRY(truth_compare(study->diag, &study->truth, image, &run->error));
    if (seed == 0)
        TRY(keep_picture(study, point, image));
    TRY(record_append(study->diag, study_path(study, "runs.csv").text, &key, run));
    run->is_done = true;
    return OK;
}

/* A point that cannot be rendered is left out, and why is kept for the report. */
static Status refuse_point(Study *study, int point, Status status)
{
    const char *reason = aside_reason(&study->aside, status);
    study->refusals[point] = arena_strndup(study->arena, reason, strlen(reason));
    return study->refusals[point] ? OK : diag_no_memory(study->diag, "a study");
}

static Status do_run(Study *study, int number)
{
    Image image;
    const StudyPoint *point = &study->points[number / STUDY_SEEDS];
    StudyRun run;
    study->run_started = clock_wall();
    aside_clear(&study->aside);
    Status status =
        render_point(study, point, number % STUDY_SEEDS, &study->aside.diag, &run, &image);
    if (status != OK)
        return status == ERR_INTERRUPTED ? status
                                         : refuse_point(study, number / STUDY_SEEDS, status);
    status = settle_run(study, number, point, &image, &run);
    study->runs[number] = run;
    image_done(&image);
    return status;
}

/* --- the reference -------------------------------------------------------------------------- */

/* The numbers of a reference that the pictures do not hold. */
static Status save_reference_facts(const Study *study)
{
    char text[256];
    const Truth *truth = &study->truth;
    int length = snprintf(text, sizeof text, "%s\n%.17g %.17g %.17g\n", truth->method,
                          truth->passes, truth->seconds, truth->rel_blur2);
    return file_write(study->diag, study_path(study, "reference.txt").text, text, (size_t)length);
}

static Status load_reference_facts(Study *study)
{
    const char *text;
    size_t size;
    Truth *truth = &study->truth;
    TRY(file_read(study->diag, study_path(study, "reference.txt").text, TEXT_BYTES_MAX,
                  study->arena, &text, &size));
    int length = (int)strcspn(text, "\n");
    snprintf(truth->method, sizeof truth->method, "%.*s", length, text);
    int count = sscanf(text + length, "%lf %lf %lf", &truth->passes, &truth->seconds,
                       &truth->rel_blur2); /* of which the last may be unknown, a NaN */
    if (count != 3 || !(truth->passes >= 0 && isfinite(truth->passes)) ||
        !(truth->seconds >= 0 && isfinite(truth->seconds)) || truth->rel_blur2 < 0 ||
        isinf(truth->rel_blur2))
        return diag_fail(study->diag, ERR_FILE, "'%s' is damaged: remove the folder '%s'",
                         study_path(study, "reference.txt").text, study->options.folder);
    return OK;
}

/* Build the reference, as good as the error of `own`, the scene as it stands, calls for. */
static Status build_reference(Study *study, const Image *own)
{
    const RenderOptions *render = &study->options.render;
    ReferenceOptions options = {.scene = study->base.scene,
                                .render = *render,
                                .folder = study->options.folder,
                                .is_path = study->base.has_path_truth,
                                .seconds = REFERENCE_PART * time_left(study),
                                .own = own,
                                .error_part = REFERENCE_ERROR_PART};
    listen(study, &options.render);
    snprintf(study->phase, sizeof study->phase, "reference");
    TRY(reference_build(&options, study->diag, &study->truth));
    TRY(truth_save(study->diag, &study->truth, study->options.folder));
    TRY(save_reference_facts(study));
    reference_forget_states(study->options.folder);
    return OK;
}

/* Have the reference that an earlier part of the study built; *is_there: there was one. */
static Status load_reference(Study *study, bool *is_there)
{
    const StudyOptions *options = &study->options;
    int width = options->render.width, height = options->render.height;
    *is_there = true;
    if (options->reference_path)
        return truth_load_file(study->diag, options->reference_path, width, height, &study->truth);
    TRY(truth_load(study->diag, options->folder, width, height, &study->truth, is_there));
    if (!*is_there || !file_exists(study_path(study, "reference.txt").text)) {
        *is_there = false;
        truth_done(&study->truth);
        return OK;
    }
    TRY(load_reference_facts(study));
    return truth_settle(study->diag, &study->truth);
}

/* --- the beginning -------------------------------------------------------------------------- */

typedef struct Kept {
    RunKey key;
    StudyRun run;
} Kept;

typedef struct KeptList {
    Kept *items;
    size_t count, capacity;
    bool is_short; /* memory ran out */
} KeptList;

static void take_kept(void *ctx, const RunKey *key, const StudyRun *run)
{
    KeptList *list = ctx;
    void *items = list->items;
    list->is_short |= mem_grow(&items, list->count, &list->capacity, sizeof *list->items) != 0;
    list->items = items;
    if (!list->is_short)
        list->items[list->count++] = (Kept){*key, *run};
}

static bool is_point(const StudyPoint *point, const RunKey *key)
{
    return point->setting == key->setting && point->is_fine == key->is_fine &&
           fabs(point->value - key->value) <= 1e-9 * fabs(key->value);
}

/* Take up the runs that were done before. */
static void place_kept(Study *study, const KeptList *kept)
{
    for (size_t k = 0; k < kept->count; k++) {
        const RunKey *key = &kept->items[k].key;
        for (int i = 0; i < study->count && key->seed >= 0 && key->seed < STUDY_SEEDS; i++)
            if (is_point(&study->points[i], key))
                study->runs[STUDY_SEEDS * i + key->seed] = kept->items[k].run;
    }
}

/* The run that all begins with: of the scene as it stands, or NULL. */
static const StudyRun *first_kept(const KeptList *kept)
{
    for (size_t i = 0; i < kept->count; i++)
        if (kept->items[i].key.setting == SETTING_OWN && kept->items[i].key.seed == 0)
            return &kept->items[i].run;
    return NULL;
}

/* Render the scene as it stands, which tells what the rest will take; then have a reference. */
static Status begin(Study *study, StudyRun *own)
{
    Image image;
    bool has_reference;
    StudyPoint point;
    setting_point_own(&study->base, &point);
    TRY(load_reference(study, &has_reference));
    TRY(render_point(study, &point, 0, study->diag, own, &image));
    Status status = has_reference ? OK : build_reference(study, &image);
    if (status == OK)
        status = settle_run(study, 0, &point, &image, own);
    image_done(&image);
    return status;
}

/* List the points, none of which is done. */
static Status list_points(Study *study)
{
    Status status = setting_grid(&study->base, study->arena, &study->points, &study->count);
    size_t count = (size_t)study->count, runs = STUDY_SEEDS * count;
    study->runs = ARENA_ARRAY(study->arena, StudyRun, runs);
    study->is_left = ARENA_ARRAY(study->arena, bool, runs);
    study->refusals = ARENA_ARRAY(study->arena, const char *, count);
    if (status != OK || !study->runs || !study->is_left || !study->refusals)
        return diag_no_memory(study->diag, "a study");
    return OK;
}

/* Have the reference, the first run and the list of all others. */
static Status prepare(Study *study, const KeptList *kept)
{
    bool is_there = true;
    StudyRun own;
    const StudyRun *before = first_kept(kept);
    if (before) {
        own = *before;
        TRY(load_reference(study, &is_there));
    } else {
        TRY(begin(study, &own));
    }
    if (!is_there)
        return diag_fail(study->diag, ERR_FILE,
                         "the reference is missing in '%s': remove that folder to begin anew",
                         study->options.folder);
    study->base.radius = own.radius;
    TRY(list_points(study));
    study->runs[0] = own;
    place_kept(study, kept);
    return OK;
}

static Status start(Study *study)
{
    KeptList kept = {0};
    Status status = record_read(study->diag, study_path(study, "runs.csv").text, study->arena,
                                take_kept, &kept);
    if (status == OK && kept.is_short)
        status = diag_no_memory(study->diag, "a study");
    if (status == OK)
        status = prepare(study, &kept);
    mem_free(kept.items);
    return status;
}

/* --- all of it ------------------------------------------------------------------------------ */

static Status run_all(Study *study)
{
    int next;
    while ((next = schedule_next(study)) >= 0) {
        study->run_expected = schedule_cost(study, next / STUDY_SEEDS);
        if (study->run_expected > time_left(study))
            study->is_left[next] = true;
        else
            TRY(do_run(study, next));
    }
    return OK;
}

/* An interruption ends the runs, not the report; neither does a disk that is full. */
static Status analyse(Study *study)
{
    work_interrupted = work_ending = 0;
    if (study_analyse(&study->base, study->points, study->count, study->runs,
                      study->truth.noise.percentile, study->arena, &study->analysis) != OK)
        return diag_no_memory(study->diag, "a study");
    return OK;
}

Status study_run(const Scene *scene, const StudyOptions *options, Arena *arena, Diag *diag,
                 Study *study)
{
    *study = (Study){.options = *options, .arena = arena, .diag = diag, .started = clock_wall()};
    aside_init(&study->aside, diag);
    study->base = (StudyBase){.scene = scene, .options = &study->options.render};
    if (plan_make(scene, &options->render.plan, arena, &study->plan) != OK)
        return diag_no_memory(diag, "the plan");
    TRY(plan_check(&study->plan, diag));
    study->base.plan = &study->plan;
    study->base.has_path_truth = reference_can_be_path(scene, &options->render, &study->plan);
    TRY(open_folder(study));
    TRY(start(study));
    Status status = run_all(study), analysed = analyse(study);
    return analysed == OK ? status : analysed;
}

void study_done(Study *study)
{
    truth_done(&study->truth);
    aside_done(&study->aside);
}

int study_run_count(const Study *study)
{
    return STUDY_SEEDS * study->count;
}

int study_done_count(const Study *study)
{
    int count = 0;
    for (int i = 0; i < study_run_count(study); i++)
        count += study->runs[i].is_done;
    return count;
}

int study_left_count(const Study *study)
{
    int count = 0;
    for (int i = 0; i < study_run_count(study); i++)
        count += !study->runs[i].is_done && !study->refusals[i / STUDY_SEEDS];
    return count;
}

int study_missing_points(const Study *study)
{
    int count = 0;
    for (int i = 0; i < study->count; i++)
        count += !study->runs[STUDY_SEEDS * i].is_done;
    return count;
}
