/* --stats: the counters, times and photon books of a render, as JSON.
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/cli.h"
#include "render/cost.h"

#include <inttypes.h>

static void print_counters(FILE *file, const Stats *stats)
{
    fputs("  \"counters\": {", file);
    for (int i = 0; i < STAT_COUNT; i++)
        fprintf(file, "%s\n    \"%s\": %" PRIu64, i ? "," : "", stat_name((StatId)i),
                stats->count[i]);
    fputs("\n  },\n", file);
}

static void print_seconds(FILE *file, const Stats *stats)
{
    fputs("  \"seconds\": {", file);
    for (int i = 0; i < PHASE_COUNT; i++) {
        fprintf(file, "%s\n    \"%s\": ", i ? "," : "", phase_name((PhaseId)i));
        json_number(file, stats->seconds[i]);
    }
    fputs("\n  },\n", file);
}

static void print_flux(FILE *file, const char *name, Rgb flux)
{
    fprintf(file, ", \"%s\": [%.9g, %.9g, %.9g]", name, (double)flux.r, (double)flux.g,
            (double)flux.b);
}

static void print_book(FILE *file, const LightBooks *book)
{
    fputs("\n      {\"light\": ", file);
    json_string(file, book->name);
    json_field(file, "power", book->power);
    json_field(file, "share", book->share);
    fprintf(file,
            ", \"emitted\": %" PRIu64 ", \"stored_paths\": %" PRIu64 ", \"absorbed\": %" PRIu64
            ", \"escaped\": %" PRIu64 ", \"cut\": %" PRIu64 ", \"stored\": %" PRIu64,
            book->emitted, book->stored_paths, book->absorbed, book->escaped, book->cut,
            book->stored);
    print_flux(file, "flux_emitted", book->flux_emitted);
    print_flux(file, "flux_stored", book->flux_stored);
    print_flux(file, "flux_absorbed", book->flux_absorbed);
    print_flux(file, "flux_escaped", book->flux_escaped);
    print_flux(file, "flux_cut", book->flux_cut);
    print_flux(file, "balance", book->balance);
    print_flux(file, "balance_error", book->balance_error);
    fputc('}', file);
}

static void print_books(FILE *file, const char *name, const LightBooks *books, int count,
                        uint64_t hash)
{
    fprintf(file, "    \"%s\": {\"hash\": \"%016" PRIx64 "\", \"lights\": [", name, hash);
    for (int i = 0; books && i < count; i++) {
        fputs(i ? "," : "", file);
        print_book(file, &books[i]);
    }
    fputs("]}", file);
}

static void print_radii(FILE *file, const char *name, double first, double last)
{
    fprintf(file, ", \"%s\": [", name);
    json_number(file, first);
    fputs(", ", file);
    json_number(file, last);
    fputs("]", file);
}

/* Passes in all and of this run, gather radii of the first and the last. */
static void print_passes(FILE *file, const RenderResult *result)
{
    if (result->passes == 0)
        return;
    fprintf(file, "  \"progressive\": {\"passes\": %" PRIu64 ", \"passes_of_this_run\": %" PRIu64,
            result->passes, result->new_passes);
    print_radii(file, "caustic_radius", result->first_radii.caustic, result->last_radii.caustic);
    print_radii(file, "global_radius", result->first_radii.global, result->last_radii.global);
    print_radii(file, "volume_radius", result->first_radii.volume, result->last_radii.volume);
    fputs("},\n", file);
}

/* What was done for each effect, and its share of all the work. */
static void print_work(FILE *file, const RenderResult *result)
{
    Costs costs;
    const char *comma = "";
    costs_find(&result->plan, &result->stats, &costs);
    fputs("  \"work\": [", file);
    for (int i = 0; i < COST_COUNT; i++) {
        FeatureId feature = cost_feature(i);
        bool is_any = feature == FEATURE_COUNT;
        if (!is_any && !plan_has(&result->plan, feature))
            continue;
        fprintf(file, "%s\n    {\"effect\": %s%s%s, \"unit\": \"%s\", \"count\": %.0f, \"share\": ",
                comma, is_any ? "" : "\"", is_any ? "null" : feature_name(feature),
                is_any ? "" : "\"", cost_unit(i), costs.count[i]);
        json_number(file, costs_share_of(&costs, i));
        fputs("}", file);
        comma = ",";
    }
    fputs("\n  ],\n", file);
}

static void print_error(FILE *file, const ErrorFigure *error)
{
    if (!error->is_known)
        return;
    fputs("  \"error\": {\"percentile\": 95", file);
    json_field(file, "relative", error->whole);
    fputs(", \"confidence\": 90", file);
    json_field(file, "bound", error->bound);
    json_field(file, "noise", error->noise);
    json_field(file, "bias", error->bias);
    fputs("},\n", file);
}

void stats_print_json(FILE *file, const Scene *scene, const RenderResult *result)
{
    fputs("{\n  \"program\": \"pms " PMS_VERSION "\",\n  \"scene\": ", file);
    json_string(file, scene->path);
    fputs(",\n", file);
    print_passes(file, result);
    print_error(file, &result->error);
    print_seconds(file, &result->stats);
    print_counters(file, &result->stats);
    print_work(file, result);
    fputs("  \"features\": {", file);
    for (int i = 0; i < FEATURE_COUNT; i++)
        fprintf(file, "%s\n    \"%s\": %s", i ? "," : "", feature_name((FeatureId)i),
                plan_has(&result->plan, (FeatureId)i) ? "true" : "false");
    fputs("\n  },\n  \"photon_maps\": {\n", file);
    print_books(file, "caustic", result->books.caustic, result->books.caustic_count,
                result->caustic_hash);
    fputs(",\n", file);
    print_books(file, "global", result->books.global, result->books.global_count,
                result->global_hash);
    fputs(",\n", file);
    print_books(file, "volume", result->books.volume, result->books.volume_count,
                result->volume_hash);
    fputs("\n  }\n}\n", file);
}
