/* pms validate: the same file through pms and through the installed povray, side by side.
 *
 * Each side's time is that of a whole run, from reading the scene to a written PNG.
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/povray_run.h"
#include "cli/verdict.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static Status render_loaded(Args *args, const Scene *scene, const RenderOptions *options,
                            const char *folder, SideRun *out)
{
    char picture[FILE_PATH_MAX];
    const char *paths[1] = {picture};
    RenderResult result;
    snprintf(picture, sizeof picture, "%s/pms.png", folder);
    TRY(render_scene(scene, options, args->diag, &result));
    Status status = output_write(args, scene, &result, paths, 1);
    if (status == OK) {
        out->image = result.image;
        result.image = (Image){0};
    }
    render_result_done(&result);
    return status;
}

static Status pms_run(Args *args, const RenderOptions *options, const char *folder, SideRun *out)
{
    double start = clock_wall(), parse_seconds;
    Scene *scene;
    TRY(args_load_scene(args, 0, &scene, &parse_seconds));
    Status status = render_loaded(args, scene, options, folder, out);
    scene_free(scene);
    out->wall_seconds = clock_wall() - start;
    out->cpu_seconds = clock_cpu(); /* with the program's own start */
    return status;
}

/* Copy the colours of a display image to column `x` of a wider one. */
static void place(const Image *from, Image *to, int x)
{
    const ImageLayer *source = image_find_layer(from, "");
    float *target = image_find_layer(to, "")->pixels;
    for (int y = 0; y < from->height; y++) {
        for (int i = 0; i < from->width; i++) {
            size_t at = (size_t)y * (size_t)from->width + (size_t)i;
            size_t there = (size_t)y * (size_t)to->width + (size_t)(x + i);
            memcpy(target + 3 * there, source->pixels + at * (size_t)source->channel_count,
                   3 * sizeof *target);
        }
    }
}

/* Write pms's picture, povray's and their difference side by side. */
static Status write_side_by_side(const Args *args, const SideRun *pms, const SideRun *povray,
                                 double gain)
{
    Image difference, wide;
    int width = pms->image.width;
    if (width > IMAGE_SIDE_MAX / 3)
        return diag_fail(args->diag, ERR_USAGE, "pictures this wide do not fit side by side");
    TRY(image_difference(args->diag, &pms->image, &povray->image, (float)gain, &difference));
    image_init(&wide, 3 * width, pms->image.height);
    wide.is_display = true;
    Status status = OK;
    if (image_add_layer(&wide, "", "RGB")) {
        place(&pms->image, &wide, 0);
        place(&povray->image, &wide, width);
        place(&difference, &wide, 2 * width);
    } else {
        status = diag_no_memory(args->diag, "the pictures side by side");
    }
    for (int i = 0; i < args->output_count && status == OK; i++)
        status = picture_write(args->diag, args->outputs[i], &wide);
    image_done(&wide);
    image_done(&difference);
    return status;
}

static void print_json(const SideRun *pms, const SideRun *povray, const CompareResult *result)
{
    const struct {
        const char *name;
        double value;
    } items[] = {{"pms_cpu_seconds", pms->cpu_seconds},
                 {"povray_cpu_seconds", povray->cpu_seconds},
                 {"pms_wall_seconds", pms->wall_seconds},
                 {"povray_wall_seconds", povray->wall_seconds}};
    printf("{");
    metrics_print_json(stdout, result);
    for (size_t i = 0; i < sizeof items / sizeof *items; i++) {
        json_field(stdout, items[i].name, items[i].value);
    }
    printf("}\n");
}

static void print_lines(const SideRun *pms, const SideRun *povray, const CompareResult *result)
{
    metrics_print(stdout, result);
    printf("pms      %8.3f s cpu %8.3f s wall\n", pms->cpu_seconds, pms->wall_seconds);
    printf("povray   %8.3f s cpu %8.3f s wall\n", povray->cpu_seconds, povray->wall_seconds);
    if (pms->cpu_seconds > 0)
        printf("povray used %.2f times the processor time of pms\n",
               povray->cpu_seconds / pms->cpu_seconds);
}

static Status compare_sides(const Args *args, SideRun *pms, SideRun *povray)
{
    Thresholds limits;
    CompareResult result;
    double gain;
    int corner[2];
    TRY(thresholds_read(args, &limits));
    TRY(args_number(args, OPT_GAIN, 0, 1e6, 4, &gain));
    TRY(crop_apply(args, &pms->image, &povray->image, corner));
    TRY(image_compare(args->diag, &pms->image, &povray->image, &result));
    if (args->output_count)
        TRY(write_side_by_side(args, pms, povray, gain));
    if (args_has(args, OPT_JSON))
        print_json(pms, povray, &result);
    else
        print_lines(pms, povray, &result);
    return thresholds_check(args->diag, &limits, &result);
}

static Status validate_in(Args *args, const char *folder)
{
    RenderOptions options;
    SideRun pms = {0}, povray = {0};
    TRY(args_render_options(args, &options));
    TRY(output_preflight(args, args->outputs, args->output_count));
    Status status = pms_run(args, &options, folder, &pms);
    if (status == OK)
        status = povray_run(args, &options, folder, &povray);
    if (status == OK) {
        image_to_display(&pms.image);
        status = compare_sides(args, &pms, &povray);
    }
    image_done(&pms.image);
    image_done(&povray.image);
    return status;
}

static void remove_folder(const char *folder)
{
    static const char *const names[] = {"pms.png", "povray.png", "povray.log"};
    char path[FILE_PATH_MAX];
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        unlink(path);
    }
    rmdir(folder);
}

Status validate_cmd(Args *args)
{
    TRY(args_want_operands(args, 1, "one scene file"));
    /* povray is allowed to write in few places; /tmp is one of them. */
    const char *temp = getenv("TMPDIR");
    char folder[FILE_PATH_MAX / 2];
    int length =
        snprintf(folder, sizeof folder, "%s/pms-validate-XXXXXX", temp && *temp ? temp : "/tmp");
    if (length >= (int)sizeof folder || !mkdtemp(folder))
        return diag_fail(args->diag, ERR_FILE, "cannot make a temporary folder in '%.200s'",
                         temp && *temp ? temp : "/tmp");
    Status status = validate_in(args, folder);
    remove_folder(folder);
    return status;
}
