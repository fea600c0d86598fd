/* The story of a pixel.  SPDX-License-Identifier: Apache-2.0 */
#include "cli/replay.h"

#include <stdio.h>

/* What was told so far. */
typedef struct Story {
    int samples;
    uint64_t rays;
} Story;

static void print_rgb(const char *before, Rgb c)
{
    printf("%s %.6g %.6g %.6g", before, (double)c.r, (double)c.g, (double)c.b);
}

static void print_v3(const char *before, V3 v)
{
    printf("%s <%.9g, %.9g, %.9g>", before, v.x, v.y, v.z);
}

static void print_met(const EyeStep *step)
{
    const Object *object = step->object;
    Place place = span_place(object->span);
    printf("    %s %s", step->is_entering ? "enters" : "leaves", object->name);
    if (object->span.source)
        printf(" (%s:%d:%d)", object->span.source->path, place.line, place.column);
    printf(" at t %.9g,", step->t);
    print_v3("", step->p);
    printf(" to within %.2g,", step->p_error);
    print_v3(" normal", step->n);
    printf("\n");
}

static void tell_step(void *ctx, const EyeStep *step)
{
    static const char *const kinds[RAY_KIND_COUNT] = {"camera", "reflected", "refracted",
                                                      "photon", "diffuse",   "light"};
    Story *story = ctx;
    story->rays++;
    printf("  %s ray, level %d,", kinds[step->kind], step->level);
    print_v3(" from", step->ray.o);
    print_v3(" along", step->ray.d);
    printf("\n");
    if (step->object)
        print_met(step);
    else
        printf("    meets nothing\n");
    print_rgb("    counts", step->through);
    print_rgb(", light got", step->light);
    printf("%s\n", eye_step_is_finite(step) ? "" : " - NOT A NUMBER");
}

static void tell_sample(void *ctx, double x, double y, uint32_t index, const EyeSample *sample)
{
    Story *story = ctx;
    story->samples++;
    printf("  sample %u at %.6g, %.6g:", index, x, y);
    if (!sample) {
        printf(" not a number, left out\n");
        return;
    }
    Rgb sum = RGB_BLACK;
    for (int i = 0; i < PART_LIGHTS; i++)
        sum = rgb_add(sum, sample->part[i]);
    print_rgb("", sum);
    printf("\n");
}

static Status read_pixel(const Args *args, const RenderOptions *options, int *x, int *y)
{
    const char *text = args->value[OPT_REPLAY];
    int length = 0;
    if (sscanf(text, "%9d,%9d%n", x, y, &length) != 2 || text[length])
        return diag_fail(args->diag, ERR_USAGE, "--replay wants X,Y, got '%s'", text);
    if (*x < 0 || *y < 0 || *x >= options->width || *y >= options->height)
        return diag_fail(args->diag, ERR_USAGE, "pixel %s does not lie in the picture of %dx%d",
                         text, options->width, options->height);
    if (args->output_count > 0 || args_has(args, OPT_STATS) || args_has(args, OPT_ERROR_MAP))
        return diag_fail(args->diag, ERR_USAGE,
                         "--replay writes no files: leave out -o, --stats and --error-map");
    if (options->plan.is_progressive)
        return diag_fail(args->diag, ERR_USAGE,
                         "--replay wants a render of one pass: leave out --progressive, --time "
                         "and --error");
    return OK;
}

static void print_pixel(const Image *image, int x, int y)
{
    const ImageLayer *layer = &image->layers[0];
    const float *c = layer->pixels +
                     ((size_t)y * (size_t)image->width + (size_t)x) * (size_t)layer->channel_count;
    printf("pixel %d,%d:", x, y);
    print_rgb("", rgb(c[0], c[1], c[2]));
    printf("\n");
}

Status replay_run(const Args *args, const Scene *scene, RenderOptions *options)
{
    RenderResult result;
    Story story = {.samples = 0};
    Replay replay = {.witness = {tell_step, &story}, .sample = tell_sample};
    TRY(read_pixel(args, options, &replay.x, &replay.y));
    options->replay = &replay;
    Status status = render_scene(scene, options, args->diag, &result);
    if (status == OK) {
        printf("%d sample%s, %llu ray%s\n", story.samples, story.samples == 1 ? "" : "s",
               (unsigned long long)story.rays, story.rays == 1 ? "" : "s");
        print_pixel(&result.image, replay.x, replay.y);
    }
    render_result_done(&result);
    return status;
}
