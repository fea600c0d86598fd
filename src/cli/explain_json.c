/* What `pms explain --json` prints.  SPDX-License-Identifier: Apache-2.0 */
#include "cli/explain_int.h"

#include "render/progressive.h"

#include <inttypes.h>
#include <math.h>

static void print_feature(const Explanation *e, int id)
{
    const PlanRow *row = &e->plan.rows[id];
    printf("%s\n    {\"name\": \"%s\", \"on\": %s, \"forced\": %s, \"reason\": ", id ? "," : "",
           feature_name((FeatureId)id), row->is_on ? "true" : "false",
           row->forced ? "true" : "false");
    json_string(stdout, row->reason);
    if (row->why.source) {
        Place place = span_place(row->why);
        json_text(stdout, "file", row->why.source->path);
        printf(", \"line\": %d, \"column\": %d", place.line, place.column);
    }
    putchar('}');
}

/* What becomes of a light's photons. */
static void print_fate(const char *when, const LightBooks *book)
{
    printf(", \"%s\": {\"emitted\": %" PRIu64 ", \"absorbed\": %" PRIu64 ", \"escaped\": %" PRIu64
           ", \"cut\": %" PRIu64 ", \"stored\": %" PRIu64 ", \"seen\": %" PRIu64
           ", \"wasted\": %" PRIu64 "}",
           when, book->emitted, book->absorbed, book->escaped, book->cut, book->stored, book->seen,
           book->stored - book->seen);
}

static void print_override(const Explanation *e, const MapRows *map, int source)
{
    char text[256];
    explain_override(e, map, source, text, sizeof text);
    printf(", \"override\": ");
    if (*text)
        json_string(stdout, text);
    else
        printf("null");
}

static void print_lights(const Explanation *e, const MapRows *map)
{
    const LightBooks *books = map->expected;
    printf(",\n  \"%s_photons\": [", map->name);
    for (int i = 0; books && i < map->count; i++) {
        printf("%s\n    {\"light\": ", i ? "," : "");
        json_string(stdout, books[i].name);
        json_field(stdout, "power", books[i].power);
        json_field(stdout, "share", books[i].share);
        printf(", \"photons\": %" PRIu64, books[i].budget);
        print_fate("expected", &books[i]);
        if (map->had)
            print_fate("had", &map->had[i]);
        print_override(e, map, i);
        putchar('}');
    }
    printf("%s]", books ? "\n  " : "");
    if (!books)
        return;
    printf(",\n  \"%s_asked\": {\"count\": ", map->name);
    json_number(stdout, map->asked.count);
    json_field(stdout, "spacing", map->asked.spacing);
    json_field(stdout, "global_photons", map->asked.global);
    putchar('}');
}

static void print_passes(const Explanation *e)
{
    const ProgressiveOptions *progressive = &e->options.progressive;
    if (!plan_has(&e->plan, FEATURE_PROGRESSIVE))
        return;
    printf(",\n  \"progressive\": {\"passes\": ");
    json_number(stdout, progressive->passes ? (double)progressive->passes : NAN);
    json_field(stdout, "seconds", progressive->seconds > 0 ? progressive->seconds : NAN);
    printf(", \"samples\": %d, \"last_radius\": ", e->options.samples > 1 ? e->options.samples : 1);
    json_number(stdout, progressive->passes ? progressive_shrink(progressive->passes) : NAN);
    putchar('}');
}

static void print_cost(const char *when, const Costs *costs, int cost)
{
    printf(", \"%s\": {\"count\": %.0f, \"share\": ", when, costs->count[cost]);
    json_number(stdout, costs_share_of(costs, cost));
    putchar('}');
}

/* The work of the effects that are on. */
static void print_work(const Explanation *e)
{
    const char *comma = "";
    printf(",\n  \"work\": [");
    for (int i = 0; i < COST_COUNT; i++) {
        FeatureId feature = cost_feature(i);
        bool is_any = feature == FEATURE_COUNT;
        if (!is_any && !plan_has(&e->plan, feature))
            continue;
        printf("%s\n    {\"effect\": %s%s%s, \"unit\": \"%s\"", comma, is_any ? "" : "\"",
               is_any ? "null" : feature_name(feature), is_any ? "" : "\"", cost_unit(i));
        print_cost("expected", &e->expected.costs, i);
        if (e->is_measured)
            print_cost("had", &e->had, i);
        putchar('}');
        comma = ",";
    }
    printf("\n  ]");
}

void explain_print_json(const Explanation *e)
{
    printf("{\n  \"scene\": ");
    json_string(stdout, e->scene->path);
    printf(",\n  \"features\": [");
    for (int i = 0; i < FEATURE_COUNT; i++)
        print_feature(e, i);
    printf("\n  ]");
    print_work(e);
    MapRows maps[MAP_ROWS];
    explain_maps(e, maps);
    for (int i = 0; i < MAP_ROWS; i++)
        print_lights(e, &maps[i]);
    print_passes(e);
    printf("\n}\n");
}
