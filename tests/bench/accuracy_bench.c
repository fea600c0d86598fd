/* Estimated errors against true ones: of pictures of one pass and of several, with a quarter, all
 * and four times the photons; and of renders that are asked for an error.
 *
 * accuracy_bench [-r SECONDS] [-e PERCENT] [-n SEEDS] [-w WIDTH] [-k FOLDER] SCENE...
 *
 * The truth is a long progressive render of the scene with random numbers of its own, of SECONDS.
 * What that is wrong itself, by its own estimate, is taken off the square of the difference; where
 * it is more than 0.6 of the difference, the whole difference is taken for the error; that is too
 * much, and the case is only counted where an error was asked for and even so is reached.  With -k
 * the truth is kept in a folder and taken from there the next time.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/mem.h"
#include "base/work.h"
#include "image/percentile.h"
#include "render/render.h"
#include "sdl/sdl.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    WIDTH_MOST = 640,
    PIXELS_MOST = WIDTH_MOST * WIDTH_MOST * 3 / 4,
    TRUTH_SEED = 77,
    CASES_MAX = 4096
};

/* The error of the reference, at most, over that which it is to measure. */
#define REFERENCE_PART 0.6

typedef struct Case {
    double estimate, bound, truth;
} Case;

typedef struct Bench {
    double seconds, error; /* of the reference; wanted, 0: none */
    int seeds;
    int width, height;  /* of pictures, pixels */
    const char *folder; /* of kept references; NULL: none */
    Diag diag;
    Case cases[CASES_MAX];
    int count;
} Bench;

static void say(void *ctx, const char *text)
{
    (void)ctx;
    fputs(text, stderr);
}

static size_t pixels_of(const Bench *bench)
{
    return (size_t)bench->width * (size_t)bench->height;
}

static RenderOptions base_options(const Bench *bench)
{
    RenderOptions options = RENDER_OPTIONS_DEFAULT;
    options.width = bench->width;
    options.height = bench->height;
    options.threads = work_thread_count();
    return options;
}

static void render(Bench *bench, const Scene *scene, const RenderOptions *options,
                   RenderResult *out)
{
    if (render_scene(scene, options, &bench->diag, out) != OK)
        exit(3);
}

static void colours_of(const Bench *bench, const RenderResult *result, float *out)
{
    for (size_t i = 0; i < pixels_of(bench); i++)
        memcpy(out + 3 * i, result->image.layers[0].pixels + 4 * i, 3 * sizeof *out);
}

/* --- a case --------------------------------------------------------------------------------- */

typedef struct Truth {
    float colours[3 * PIXELS_MOST];
    double error;
} Truth;

static void make_truth(Bench *bench, const Scene *scene, Truth *out)
{
    RenderResult result;
    RenderOptions options = base_options(bench);
    options.seed = TRUTH_SEED;
    options.plan.is_progressive = true;
    options.progressive.seconds = bench->seconds;
    render(bench, scene, &options, &result);
    colours_of(bench, &result, out->colours);
    out->error = result.error.whole;
    render_result_done(&result);
}

/* The file of a scene's reference: its path with a '-' for every '/'. */
static bool truth_file(const Bench *bench, const char *scene, char out[static 512])
{
    if (!bench->folder)
        return false;
    int start = snprintf(out, 512, "%s/", bench->folder);
    snprintf(out + start, 512 - (size_t)start, "%s.%d.%gs", scene, bench->width, bench->seconds);
    for (char *c = out + start; *c; c++)
        if (*c == '/')
            *c = '-';
    return true;
}

static void find_truth(Bench *bench, const Scene *scene, Truth *out)
{
    char path[512];
    bool is_kept = truth_file(bench, scene->path, path);
    FILE *file = is_kept ? fopen(path, "rb") : NULL;
    bool is_read = file && fread(out, sizeof *out, 1, file) == 1;
    if (file)
        fclose(file);
    if (is_read)
        return;
    make_truth(bench, scene, out);
    file = is_kept ? fopen(path, "wb") : NULL;
    if (is_kept && (!file || fwrite(out, sizeof *out, 1, file) != 1))
        fprintf(stderr, "cannot keep %s\n", path);
    if (file)
        fclose(file);
}

/* Render, and print and keep how far estimate and truth are apart. */
static void try_case(Bench *bench, const Scene *scene, const RenderOptions *options,
                     const Truth *truth, const char *name)
{
    static float colours[3 * PIXELS_MOST];
    RenderResult result;
    double apart, started = clock_wall();
    render(bench, scene, options, &result);
    double seconds = clock_wall() - started;
    colours_of(bench, &result, colours);
    if (!error_between(colours, truth->colours, pixels_of(bench), &apart))
        exit(3);
    const ErrorFigure *error = &result.error;
    bool is_known = truth->error <= REFERENCE_PART * apart;
    bool is_counted = is_known || apart <= bench->error;
    double own = is_known ? sqrt(apart * apart - truth->error * truth->error) : apart;
    if (is_counted)
        bench->cases[bench->count++] = (Case){error->whole, error->bound, own};
    printf("%-28s %-16s %8.3f %8.3f %8.3f %7.2f %8s %7.1f\n", scene->path, name, 100 * error->whole,
           100 * error->bound, 100 * own, error->whole / own,
           !is_counted           ? "unknown"
           : own <= error->bound ? "yes"
                                 : "no",
           seconds);
    fflush(stdout);
    render_result_done(&result);
}

/* --- a scene -------------------------------------------------------------------------------- */

static Scene scaled_photons(const Scene *scene, double factor)
{
    Scene scaled = *scene;
    PhotonSettings *photons = &scaled.settings.photons;
    photons->count = (long)ceil((double)photons->count * factor);
    photons->spacing /= sqrt(factor);
    long global = scaled.settings.pms.global_count;
    scaled.settings.pms.global_count = (long)ceil((double)(global > 0 ? global : 0) * factor);
    return scaled;
}

static void try_photons(Bench *bench, const Scene *scene, const Truth *truth)
{
    static const double factors[] = {0.25, 1, 4};
    for (int i = 0; i < 3; i++) {
        Scene scaled = scaled_photons(scene, factors[i]);
        RenderOptions options = base_options(bench);
        char name[32];
        options.aa = AA_UNIFORM;
        options.samples = 4;
        snprintf(name, sizeof name, "x%g, 4 samples", factors[i]);
        try_case(bench, &scaled, &options, truth, name);
        options.samples = 1;
        options.plan.is_progressive = true;
        options.progressive.passes = 8;
        snprintf(name, sizeof name, "x%g, 8 passes", factors[i]);
        try_case(bench, &scaled, &options, truth, name);
    }
}

static void try_seeds(Bench *bench, const Scene *scene, const Truth *truth)
{
    for (int seed = 0; seed < bench->seeds; seed++) {
        RenderOptions options = base_options(bench);
        char name[32];
        options.seed = (uint64_t)seed;
        options.plan.is_progressive = true;
        options.progressive.error = bench->error;
        snprintf(name, sizeof name, "error %g%%, %d", 100 * bench->error, seed);
        try_case(bench, scene, &options, truth, name);
    }
}

static void try_scene(Bench *bench, const char *path)
{
    static Truth truth;
    static const char *const folders[] = {"stdlib"};
    SdlOptions sdl = {.library_paths = folders,
                      .library_path_count = 1,
                      .width = bench->width,
                      .height = bench->height,
                      .threads = work_thread_count()};
    Scene *scene;
    if (sdl_load(&bench->diag, path, &sdl, &scene) != OK)
        exit(2);
    find_truth(bench, scene, &truth);
    printf("%-28s %-16s %8.3f\n", path, "the reference", 100 * truth.error);
    if (bench->error > 0)
        try_seeds(bench, scene, &truth);
    else
        try_photons(bench, scene, &truth);
    scene_free(scene);
}

/* --- all ------------------------------------------------------------------------------------ */

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void print_summary(Bench *bench)
{
    double ratios[CASES_MAX];
    int inside = 0, reached = 0, far = 0;
    for (int i = 0; i < bench->count; i++) {
        const Case *c = &bench->cases[i];
        ratios[i] = c->truth > 0 ? c->estimate / c->truth : INFINITY;
        inside += c->truth <= c->bound;
        reached += c->truth <= bench->error;
        far += c->truth > 1.5 * bench->error;
    }
    qsort(ratios, (size_t)bench->count, sizeof *ratios, compare_doubles);
    printf(
        "\n%d cases; truth within the bound in %.1f %%; estimate over truth %.2f in the median\n",
        bench->count, 100.0 * inside / bench->count, ratios[bench->count / 2]);
    if (bench->error > 0)
        printf("truth within %g %% in %.1f %%, above %g %% in %d\n", 100 * bench->error,
               100.0 * reached / bench->count, 150 * bench->error, far);
}

int main(int argc, char **argv)
{
    static Bench bench = {.seconds = 60, .seeds = 3, .width = 160};
    int letter;
    while ((letter = getopt(argc, argv, "r:e:n:w:k:")) != -1) {
        if (letter == 'r')
            bench.seconds = atof(optarg);
        else if (letter == 'e')
            bench.error = atof(optarg) / 100;
        else if (letter == 'n')
            bench.seeds = atoi(optarg);
        else if (letter == 'w')
            bench.width = atoi(optarg);
        else if (letter == 'k')
            bench.folder = optarg;
        else
            return 2;
    }
    if (bench.width < 4 || bench.width > WIDTH_MOST)
        return 2;
    bench.height = bench.width * 3 / 4;
    diag_init(&bench.diag, say, NULL);
    printf("errors that 95 %% of the pixels are within, in %% of their luminance, %dx%d\n\n",
           bench.width, bench.height);
    printf("%-28s %-16s %8s %8s %8s %7s %8s %7s\n", "scene", "photons, way", "estimate", "90 %",
           "truth", "ratio", "within", "seconds");
    for (int i = optind; i < argc; i++)
        try_scene(&bench, argv[i]);
    if (bench.count > 0)
        print_summary(&bench);
    diag_done(&bench.diag);
    return 0;
}
