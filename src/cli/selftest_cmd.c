/* pms selftest: what is claimed, what is found, and whether that holds.
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/cli.h"
#include "selftest/selftest.h"

#include <math.h>

enum { MOVED_WIDTH = 160 /* pixels, of the picture of a scene */ };

/* --- without a scene ------------------------------------------------------------------------- */

typedef struct ClaimPrinter {
    bool is_json;
    int count;
} ClaimPrinter;

static void print_claim_json(ClaimPrinter *printer, const Claim *claim)
{
    const struct {
        const char *name;
        double value;
    } numbers[] = {{"expected", claim->expected},
                   {"measured", claim->measured},
                   {"standard_error", claim->error},
                   {"off", claim_off(claim)},
                   {"limit", claim_limit(claim)}};
    printf("%s\n  {\"name\": ", printer->count ? "," : "{\"claims\": [");
    json_string(stdout, claim->name);
    json_text(stdout, "what", claim->what);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        json_field(stdout, numbers[i].name, numbers[i].value);
    }
    printf(", \"in_standard_errors\": %s, \"holds\": %s}",
           claim_has_chance(claim) ? "true" : "false", claim_holds(claim) ? "true" : "false");
}

static void print_claim_line(ClaimPrinter *printer, const Claim *claim)
{
    const char *unit = claim_has_chance(claim) ? "se" : "";
    if (printer->count == 0)
        printf("%-4s %-22s %11s %11s %10s %10s  %s\n", "", "claim", "expected", "measured", "off",
               "limit", "what is measured");
    printf("%-4s %-22s %11.6g %11.6g %7.2g %-2s %7.2g %-2s  %s\n",
           claim_holds(claim) ? "ok" : "FAIL", claim->name, claim->expected, claim->measured,
           claim_off(claim), unit, claim_limit(claim), unit, claim->what);
    fflush(stdout);
}

static void print_claim(void *ctx, const Claim *claim)
{
    ClaimPrinter *printer = ctx;
    if (printer->is_json)
        print_claim_json(printer, claim);
    else
        print_claim_line(printer, claim);
    printer->count++;
}

static Status test_build(const Args *args)
{
    RenderOptions render;
    TRY(args_render_options(args, &render));
    ClaimPrinter printer = {.is_json = args_has(args, OPT_JSON)};
    const SelftestOptions options = {
        .threads = render.threads, .seed = render.seed, .done = print_claim, .ctx = &printer};
    int failed;
    TRY(selftest_run(&options, args->diag, &failed));
    if (printer.is_json)
        printf("\n], \"failed\": %d}\n", failed);
    else
        printf("%d of %d claims hold; off: relative, or in standard errors (se)\n",
               printer.count - failed, printer.count);
    if (failed > 0)
        return diag_fail(args->diag, ERR_COMPARE,
                         "%d of %d claims do not hold: this build does not compute right here",
                         failed, printer.count);
    return OK;
}

/* --- with a scene ---------------------------------------------------------------------------- */

typedef struct MovePrinter {
    bool is_json;
    int count;
} MovePrinter;

static const char *const verdicts[] = {
    [CHANGE_NONE] = "same to the last bit",
    [CHANGE_HOLDS] = "holds",
    [CHANGE_EDGES] = "differs at edges only",
    [CHANGE_SEEN] = "changes",
    [CHANGE_BITS] = "changes bits that nothing rounds",
};

static double part(size_t count, const Change *change)
{
    return (double)count / (double)change->pixels;
}

static void print_base(void *ctx, const ChangeBase *base, double size)
{
    const MovePrinter *printer = ctx;
    if (printer->is_json) {
        printf("{\"width\": %d, \"height\": %d, \"size\": ", base->width, base->height);
        json_number(stdout, size);
        json_field(stdout, "seed_rmse", base->seed_rmse);
        printf(", \"moves\": [");
        return;
    }
    printf("%dx%d pixels, scene %.4g units across, rmse between two seeds %.3g\n\n", base->width,
           base->height, size, base->seed_rmse);
    printf("%-27s %7s %7s %9s %9s %9s  %s\n", "", "seen %", "edges %", "rmse", "largest", "mean %",
           "verdict");
    fflush(stdout);
}

static void print_worst(const MoveResult *result)
{
    const Change *change = &result->change;
    printf("%27s worst at %d,%d: ", "", change->x, change->y);
    if (result->worst) {
        Place place = span_place(result->worst->span);
        printf("%s (%s:%d:%d)\n", result->worst->name, result->worst->span.source->path, place.line,
               place.column);
    } else {
        printf("no object\n");
    }
}

static void print_move_line(const MoveResult *result)
{
    const Change *change = &result->change;
    ChangeKind kind = change_kind(change);
    printf("%-27s %7.3f %7.3f %9.3g %9.3g %9.3g  %s\n", result->name,
           100 * part(change->counts.seen, change), 100 * part(change->counts.edges, change),
           change->rmse, change->largest, 100 * change->mean_off, verdicts[kind]);
    if (kind >= CHANGE_EDGES)
        print_worst(result);
    fflush(stdout);
}

static void print_worst_json(const MoveResult *result)
{
    printf(", \"worst\": {\"x\": %d, \"y\": %d, \"object\": ", result->change.x, result->change.y);
    if (!result->worst) {
        printf("null}");
        return;
    }
    Place place = span_place(result->worst->span);
    json_string(stdout, result->worst->name);
    json_text(stdout, "file", result->worst->span.source->path);
    printf(", \"line\": %d}", place.line);
}

static void print_move_json(const MovePrinter *printer, const MoveResult *result)
{
    const Change *change = &result->change;
    const struct {
        const char *name;
        double value;
    } numbers[] = {{"bits", part(change->bits, change)},
                   {"seen", part(change->counts.seen, change)},
                   {"edges", part(change->counts.edges, change)},
                   {"odd", part(change->counts.odd, change)},
                   {"rmse", change->rmse},
                   {"largest", change->largest},
                   {"mean_off", change->mean_off},
                   {"mean_allowed", change->mean_allowed}};
    printf("%s\n  {\"name\": ", printer->count ? "," : "");
    json_string(stdout, result->name);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        json_field(stdout, numbers[i].name, numbers[i].value);
    }
    print_worst_json(result);
    printf(", \"verdict\": \"%s\", \"holds\": %s}", verdicts[change_kind(change)],
           change_is_good(change) ? "true" : "false");
}

static void print_move(void *ctx, const MoveResult *result)
{
    MovePrinter *printer = ctx;
    if (printer->is_json)
        print_move_json(printer, result);
    else
        print_move_line(result);
    printer->count++;
}

/* Return the camera's width over its height.  What is wrong with the scene is said when it is read
 * again, to be drawn. */
static double camera_shape(const Args *args, const SdlOptions *sdl)
{
    Diag quiet;
    Scene *scene;
    double shape = (double)sdl->width / sdl->height;
    diag_init(&quiet, diag_drop, NULL);
    if (sdl_load(&quiet, args->operands[0], sdl, &scene) == OK)
        shape = v3_len(scene->camera.right) / v3_len(scene->camera.up);
    scene_free(scene);
    diag_done(&quiet);
    return shape;
}

/* Without a size asked for, the picture is small and of the camera's own shape. */
static Status choose_size(const Args *args, SdlOptions *sdl, RenderOptions *render)
{
    long width, height;
    TRY(args_int(args, OPT_WIDTH, 1, IMAGE_SIDE_MAX, MOVED_WIDTH, &width));
    TRY(args_int(args, OPT_HEIGHT, 1, IMAGE_SIDE_MAX, width > 1 ? width * 3 / 4 : 1, &height));
    sdl->width = (int)width;
    sdl->height = (int)height;
    if (!args_has(args, OPT_HEIGHT))
        sdl->height =
            (int)lrint(fmin(fmax(sdl->width / camera_shape(args, sdl), 1), IMAGE_SIDE_MAX));
    render->width = sdl->width;
    render->height = sdl->height;
    return OK;
}

static Status test_scene(Args *args)
{
    RenderOptions render;
    SdlOptions sdl;
    int failed;
    MovePrinter printer = {.is_json = args_has(args, OPT_JSON)};
    TRY(args_render_options(args, &render));
    TRY(args_sdl_options(args, &sdl));
    TRY(choose_size(args, &sdl, &render));
    const MovedOptions options = {.path = args->operands[0],
                                  .sdl = &sdl,
                                  .render = &render,
                                  .begun = print_base,
                                  .done = print_move,
                                  .ctx = &printer};
    TRY(selftest_moved(&options, args->diag, &failed));
    if (printer.is_json)
        printf("\n], \"failed\": %d}\n", failed);
    if (failed > 0)
        return diag_fail(args->diag, ERR_COMPARE, "the picture changes in %d of %d moves", failed,
                         printer.count);
    return OK;
}

Status selftest_cmd(Args *args)
{
    if (args->operand_count == 0)
        return test_build(args);
    TRY(args_want_operands(args, 1, "one scene file or none"));
    return test_scene(args);
}
