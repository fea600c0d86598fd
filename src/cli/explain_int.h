/* What `pms explain` found out, and who prints it; for cli/ only.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_CLI_EXPLAIN_INT_H
#define PMS_CLI_EXPLAIN_INT_H

#include "cli/cli.h"
#include "render/forecast.h"

typedef struct Explanation {
    const Scene *scene;
    RenderOptions options;
    Plan plan;
    Forecast expected;
    bool is_measured;
    RenderResult result; /* of --measure */
    Costs had;
    bool has_all; /* --all */
} Explanation;

/* What a map was asked for by: by targets, or by indirect light. */
typedef struct Asked {
    double count, spacing, global; /* NAN: not by this */
} Asked;

/* A map's sources of light, what it was asked for by, and its name. */
typedef struct MapRows {
    const char *name;
    const LightBooks *expected; /* NULL: the map is not made */
    const LightBooks *had;      /* NULL: not measured */
    int count;
    bool is_aimed; /* for caustics alone: what photons{} of a light says counts */
    Asked asked;
} MapRows;

enum { MAP_ROWS = 3 };
void explain_maps(const Explanation *e, MapRows rows[MAP_ROWS]);

/* Put into words what changes the share that a source has of a map, or forbids it; empty: nothing.
 * Returns the place in the scene. */
Span explain_override(const Explanation *e, const MapRows *map, int source, char *out, size_t size);

/* Print it all. */
void explain_print_text(const Explanation *e);
void explain_print_json(const Explanation *e);

#endif
