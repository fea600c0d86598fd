/* pms explain: which effects a scene calls for, who asked, and what each light gets.
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/cli.h"

#include "render/progressive.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

typedef struct Explanation {
    const Scene *scene;
    RenderOptions options;
    Plan plan;
    PhotonBooks books;
} Explanation;

static void print_place(FILE *file, Span span)
{
    Place place = span_place(span);
    if (span.source)
        fprintf(file, "%s:%d:%d", span.source->path, place.line, place.column);
}

static void print_features(const Explanation *e)
{
    printf("%-20s %-4s %s\n", "effect", "on", "why");
    for (int i = 0; i < FEATURE_COUNT; i++) {
        const PlanRow *row = &e->plan.rows[i];
        printf("%-20s %-4s %s", feature_name((FeatureId)i), row->is_on ? "yes" : "no", row->reason);
        if (row->why.source)
            printf(" (");
        print_place(stdout, row->why);
        printf("%s\n", row->why.source ? ")" : "");
    }
}

/* What a map was asked for by: by targets, or by indirect light. */
typedef struct Asked {
    double count, spacing, global; /* NAN: not by this */
} Asked;

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

/* A map's sources of light, what it was asked for by, and its name. */
typedef struct MapRows {
    const char *name;
    const LightBooks *books; /* NULL: the map is not made */
    int count;
    Asked asked;
} MapRows;

enum { MAP_ROWS = 3 };

static void map_rows(const Explanation *e, MapRows rows[MAP_ROWS])
{
    const PhotonBooks *books = &e->books;
    const Plan *plan = &e->plan;
    rows[0] = (MapRows){"caustic", books->caustic, books->caustic_count, asked_for(e, true, false)};
    rows[1] = (MapRows){"global", books->global, books->global_count, asked_for(e, false, true)};
    rows[2] = (MapRows){"volume", books->volume, books->volume_count,
                        asked_for(e, plan->has_volume_focus, plan->has_volume_indirect)};
}

static void print_asked(const Asked *asked)
{
    if (!isnan(asked->count))
        printf("count %.0f", asked->count);
    if (!isnan(asked->spacing))
        printf("spacing %g", asked->spacing);
    if (!isnan(asked->global))
        printf("%sglobal_photons %.0f", isnan(asked->count) && isnan(asked->spacing) ? "" : " and ",
               asked->global);
}

static void print_lights(const MapRows *map)
{
    const LightBooks *books = map->books;
    if (!books)
        return;
    uint64_t total = 0;
    for (int i = 0; i < map->count; i++)
        total += books[i].budget;
    printf("\n%s photons: ", map->name);
    print_asked(&map->asked);
    printf(" asked for, %" PRIu64 " to send", total);
    printf("\n%-20s %12s %8s %10s\n", "light", "power", "share", "photons");
    for (int i = 0; i < map->count; i++)
        printf("%-20s %12.5g %7.2f%% %10" PRIu64 "\n", books[i].name, books[i].power,
               100 * books[i].share, books[i].budget);
}

/* How many passes there will be, of what. */
static void print_passes(const Explanation *e)
{
    const ProgressiveOptions *progressive = &e->options.progressive;
    int samples = e->options.samples > 1 ? e->options.samples : 1;
    if (!plan_has(&e->plan, FEATURE_PROGRESSIVE))
        return;
    printf("\npasses: ");
    if (progressive->passes)
        printf("%" PRIu64, progressive->passes);
    if (progressive->seconds > 0)
        printf("%swhat fits into %g s", progressive->passes ? ", or " : "", progressive->seconds);
    if (!progressive->passes && !(progressive->seconds > 0))
        printf("until Ctrl-C");
    printf("; %d sample%s a pixel in each", samples, samples == 1 ? "" : "s");
    if (e->books.caustic || e->books.global || e->books.volume)
        printf(", and these photons");
    if ((e->books.caustic || e->books.global || e->books.volume) && progressive->passes)
        printf("; the last gather radius is %.3g of the first",
               progressive_shrink(progressive->passes));
    printf("\n");
}

static void print_text(const Explanation *e)
{
    printf("scene %s: %u object%s, %d light%s\n\n", e->scene->path, e->scene->object_count,
           e->scene->object_count == 1 ? "" : "s", e->scene->light_count,
           e->scene->light_count == 1 ? "" : "s");
    print_features(e);
    MapRows maps[MAP_ROWS];
    map_rows(e, maps);
    for (int i = 0; i < MAP_ROWS; i++)
        print_lights(&maps[i]);
    if (!e->books.caustic && !e->books.global && !e->books.volume)
        printf("\nno photon pass\n");
    print_passes(e);
}

static void print_json_feature(const Explanation *e, int id)
{
    const PlanRow *row = &e->plan.rows[id];
    printf("%s\n    {\"name\": \"%s\", \"on\": %s, \"forced\": %s, \"reason\": ", id ? "," : "",
           feature_name((FeatureId)id), row->is_on ? "true" : "false",
           row->forced ? "true" : "false");
    json_string(stdout, row->reason);
    if (row->why.source) {
        Place place = span_place(row->why);
        printf(", \"file\": ");
        json_string(stdout, row->why.source->path);
        printf(", \"line\": %d, \"column\": %d", place.line, place.column);
    }
    putchar('}');
}

static void print_json_lights(const MapRows *map)
{
    const LightBooks *books = map->books;
    printf(",\n  \"%s_photons\": [", map->name);
    for (int i = 0; books && i < map->count; i++) {
        printf("%s\n    {\"light\": ", i ? "," : "");
        json_string(stdout, books[i].name);
        printf(", \"power\": ");
        json_number(stdout, books[i].power);
        printf(", \"share\": ");
        json_number(stdout, books[i].share);
        printf(", \"photons\": %" PRIu64 "}", books[i].budget);
    }
    printf("%s]", books ? "\n  " : "");
    if (!books)
        return;
    printf(",\n  \"%s_asked\": {\"count\": ", map->name);
    json_number(stdout, map->asked.count);
    printf(", \"spacing\": ");
    json_number(stdout, map->asked.spacing);
    printf(", \"global_photons\": ");
    json_number(stdout, map->asked.global);
    putchar('}');
}

static void print_json_passes(const Explanation *e)
{
    const ProgressiveOptions *progressive = &e->options.progressive;
    if (!plan_has(&e->plan, FEATURE_PROGRESSIVE))
        return;
    printf(",\n  \"progressive\": {\"passes\": ");
    json_number(stdout, progressive->passes ? (double)progressive->passes : NAN);
    printf(", \"seconds\": ");
    json_number(stdout, progressive->seconds > 0 ? progressive->seconds : NAN);
    printf(", \"samples\": %d, \"last_radius\": ", e->options.samples > 1 ? e->options.samples : 1);
    json_number(stdout, progressive->passes ? progressive_shrink(progressive->passes) : NAN);
    putchar('}');
}

static void print_json(const Explanation *e)
{
    printf("{\n  \"scene\": ");
    json_string(stdout, e->scene->path);
    printf(",\n  \"features\": [");
    for (int i = 0; i < FEATURE_COUNT; i++)
        print_json_feature(e, i);
    printf("\n  ]");
    MapRows maps[MAP_ROWS];
    map_rows(e, maps);
    for (int i = 0; i < MAP_ROWS; i++)
        print_json_lights(&maps[i]);
    print_json_passes(e);
    printf("\n}\n");
}

static Status explain_scene(const Args *args, const Scene *scene)
{
    Explanation e = {.scene = scene};
    TRY(args_render_options(args, &e.options));
    TRY(render_explain(scene, &e.options, args->diag, args->arena, &e.plan, &e.books));
    if (args_has(args, OPT_JSON))
        print_json(&e);
    else
        print_text(&e);
    photon_books_done(&e.books);
    return OK;
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
