/* The plan: which effects a scene calls for, and who asked.
 *
 * A pure function of the scene and the render options.  Every later pass asks the plan and
 * does nothing that is off.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_PLAN_PLAN_H
#define PMS_PLAN_PLAN_H

#include "scene/scene.h"

typedef enum FeatureId {
#define X(id, name, aliases, quality, text) id,
#include "plan/feature.def"
#undef X
    FEATURE_COUNT
} FeatureId;

typedef struct PlanRow {
    bool is_on;
    Span why;           /* what asked for it, or what rules it out; may be SPAN_NONE */
    Tri forced;         /* what the command line says, if anything */
    char reason[160];   /* in words: "object with refraction, photons { target }" */
} PlanRow;

/* How light finds its way: by photons and rays of the language's kinds, or by paths alone. */
typedef enum Integrator { INTEGRATOR_PHOTONS, INTEGRATOR_PATH } Integrator;

/* Options that change what is simulated, whatever the scene says. */
typedef struct PlanOptions {
    Integrator integrator;  /* --integrator */
    double light_radius;    /* --light-radius, scene units: see Plan */
    bool is_progressive;    /* --progressive */
    bool has_indirect;      /* --gi */
    IndirectMethod indirect; /* how; INDIRECT_ANY: as the scene says */
    int quality;            /* POV's +Q, 0 to 9: leaves out what wants more */
    Tri effects[FEATURE_COUNT]; /* --effect: forced on or off, whatever scene and quality say */
} PlanOptions;

#define PLAN_OPTIONS_DEFAULT ((PlanOptions){.quality = 9})

typedef struct Plan {
    PlanRow rows[FEATURE_COUNT];
    bool *light_makes_caustics; /* per light: takes part in the caustic map */
    bool is_unlit;              /* quality 0 and 1: surfaces show their pigment, nothing more */
    bool has_ambient;           /* finish{ambient} counts (not beside real indirect light, but
                                   with radiosity{} before version 3.7, where it lights too) */
    double light_radius;        /* of the disk that a light without an area is to paths; 0: they
                                   cannot meet it */
    int unmet_lights;           /* lights whose caustics paths would bring, had they a size */
    long caustic_photons;       /* the count of photons{}, expected to be stored; 0: by spacing */
    long global_photons;        /* to emit into the scene, all lights */
    bool has_volume_focus;      /* the volume map holds what targets focus into media */
    bool has_volume_indirect;   /* and what media scatter more than once */
} Plan;

/* Make the plan.  Memory comes from `arena`.  ERR_MEMORY or OK. */
Status plan_make(const Scene *scene, const PlanOptions *options, Arena *arena, Plan *out);

/* ERR_USAGE, after a message for each, if effects were forced on that this scene cannot have. */
Status plan_check(const Plan *plan, Diag *diag);

static inline bool plan_has(const Plan *plan, FeatureId feature)
{
    return plan->rows[feature].is_on;
}

/* Return true if the command line forces an effect off: there are those that path tracing has
 * without a row that is on. */
static inline bool plan_forbids(const Plan *plan, FeatureId feature)
{
    return plan->rows[feature].forced == TRI_OFF;
}

/* Return true if a light has an area, and the command line leaves it that. */
static inline bool plan_light_has_area(const Plan *plan, const Light *light)
{
    return light->area.size1 > 0 && !plan_forbids(plan, FEATURE_AREA_LIGHTS);
}

/* Return true if paths can meet a light: one with an area, or any if lights have a radius. */
bool plan_light_has_size(const Light *light, double light_radius);

/* Return true if shadow rays pass a surface, filtered.  With path tracing only those that light
 * passes straight let them: what bends or mirrors it is left to the paths. */
static inline bool plan_filters_shadow(const Plan *plan, const Surface *surface)
{
    return surface->may_transmit && (surface->is_filter || !plan_has(plan, FEATURE_PATHS));
}

/* Return true if what fills space is seen: media, fog or rainbows. */
static inline bool plan_has_air(const Plan *plan)
{
    return plan_has(plan, FEATURE_MEDIA) || plan_has(plan, FEATURE_FOG) ||
           plan_has(plan, FEATURE_RAINBOW);
}

/* Return true if photons from `light` are to be reflected (refracted) by a surface: the object or
 * the light asks for it and neither forbids it. */
bool plan_photons_reflect(const Light *light, const Surface *surface);
bool plan_photons_refract(const Light *light, const Surface *surface);

/* Return true if a surface gives off light of its own, as far as that counts. */
bool plan_surface_glows(const Plan *plan, const Surface *surface);

/* Return the name of a feature as explain and --stats show it. */
const char *feature_name(FeatureId feature);
const char *feature_text(FeatureId feature);

/* Find an effect by its name or one of its other names; FEATURE_COUNT: there is none. */
FeatureId feature_find(const char *name, size_t length);
/* Return the other names of an effect, with spaces between. */
const char *feature_aliases(FeatureId feature);

#endif
