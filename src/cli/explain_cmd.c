/* pms explain: which effects a scene calls for, who asked, what they cost, and what each light
 * gets.  SPDX-License-Identifier: Apache-2.0 */
#include "cli/explain_int.h"
#include "cli/progress.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static Asked asked_for(const Explanation *e, bool is_aimed, bool is_indirect)
{
    const Plan *plan = &e->plan;
    bool has_count = is_aimed && plan->caustic_photons > 0;
    return (Asked){
        .count = has_count ? (double)plan->caustic_photons : NAN,
        .spacing = is_aimed && !has_count ? e->scene->settings.photons.spacing : NAN,
        .global = is_indirect ? (double)plan->global_photons : NAN,
    };
}

void explain_maps(const Explanation *e, MapRows rows[MAP_ROWS])
{
    const PhotonBooks *books = &e->expected.books, *had = &e->result.books;
    const Plan *plan = &e->plan;
    rows[0] = (MapRows){"caustic", books->caustic,           had->caustic, books->caustic_count,
                        true,      asked_for(e, true, false)};
    rows[1] = (MapRows){"global",    books->global,
                        had->global, books->global_count,
                        false,       asked_for(e, false, true)};
    rows[2] = (MapRows){"volume",
                        books->volume,
                        had->volume,
                        books->volume_count,
                        !plan->has_volume_indirect,
                        asked_for(e, plan->has_volume_focus, plan->has_volume_indirect)};
}

/* What photons{} of a light says, where it takes part. */
static void say_flags(const Light *light, char *out, size_t size)
{
    static const char *const words[] = {"", " off", " on"};
    Tri reflection = light->photon_reflection, refraction = light->photon_refraction;
    if (reflection == TRI_UNSET && refraction == TRI_UNSET && !light->has_area_photons)
        return;
    snprintf(out, size, "photons {%s%s%s%s%s }", reflection ? " reflection" : "", words[reflection],
             refraction ? " refraction" : "", words[refraction],
             light->has_area_photons ? " area_light on" : "");
}

Span explain_override(const Explanation *e, const MapRows *map, int source, char *out, size_t size)
{
    *out = 0;
    if (source >= e->scene->light_count)
        return SPAN_NONE;
    const Light *light = &e->scene->lights[source];
    bool has_none = map->expected[source].budget == 0;
    if (rgb_is_black(light->color))
        snprintf(out, size, "black: sends none");
    else if (map->is_aimed && light->is_shadowless)
        snprintf(out, size, "shadowless: sends none");
    else if (map->is_aimed)
        say_flags(light, out, size);
    if (has_none && !*out)
        snprintf(out, size, map->is_aimed ? "no target of its light" : "lights nothing");
    return *out ? light->span : SPAN_NONE;
}

static void books_per_pass(LightBooks *books, int count, uint64_t passes)
{
    for (int i = 0; books && i < count; i++) {
        uint64_t *counts[] = {&books[i].emitted, &books[i].absorbed, &books[i].escaped,
                              &books[i].cut,     &books[i].stored,   &books[i].seen};
        for (size_t k = 0; k < sizeof counts / sizeof *counts; k++)
            *counts[k] /= passes;
    }
}

/* Make of what many passes had that of one. */
static void take_per_pass(Explanation *e)
{
    uint64_t passes = e->result.new_passes;
    PhotonBooks *books = &e->result.books;
    if (passes < 2)
        return;
    for (int i = 0; i < COST_COUNT; i++)
        e->had.count[i] /= (double)passes;
    books_per_pass(books->caustic, books->caustic_count, passes);
    books_per_pass(books->global, books->global_count, passes);
    books_per_pass(books->volume, books->volume_count, passes);
}

/* Render, and keep what it took. */
static Status measure(const Args *args, Explanation *e)
{
    RenderOptions options = e->options;
    const ProgressiveOptions *progressive = &options.progressive;
    bool has_end = progressive->passes || progressive->seconds > 0 || progressive->error > 0;
    if (options.plan.is_progressive && !has_end)
        return diag_fail(args->diag, ERR_USAGE,
                         "--measure wants --passes, --time or --error beside "
                         "--progressive: a render that ends");
    options.is_watched = true;
    options.progressive.state_path = NULL;
    options.progressive.is_resumed = false;
    Progress progress;
    TRY(progress_init(&progress, args));
    options.progress = progress_show;
    options.progress_ctx = &progress;
    Status status = render_scene(e->scene, &options, args->diag, &e->result);
    progress_done(&progress);
    if (status != OK)
        return status;
    e->is_measured = true;
    costs_find(&e->result.plan, &e->result.stats, &e->had);
    take_per_pass(e);
    return OK;
}

static Status explain_scene(const Args *args, const Scene *scene)
{
    Explanation e = {.scene = scene, .has_all = args_has(args, OPT_ALL)};
    TRY(args_render_options(args, &e.options));
    TRY(render_forecast(scene, &e.options, args->diag, args->arena, &e.plan, &e.expected));
    Status status = args_has(args, OPT_MEASURE) ? measure(args, &e) : OK;
    if (status == OK && args_has(args, OPT_JSON))
        explain_print_json(&e);
    else if (status == OK)
        explain_print_text(&e);
    if (status == ERR_INTERRUPTED)
        diag_fail(args->diag, status, "interrupted; nothing was measured");
    forecast_done(&e.expected);
    render_result_done(&e.result);
    return status;
}

Status explain_cmd(Args *args)
{
    TRY(args_want_operands(args, 1, "one scene file"));
    Scene *scene;
    double seconds;
    TRY(args_load_scene(args, 0, &scene, &seconds));
    Status status = explain_scene(args, scene);
    scene_free(scene);
    return status;
}
