/* The plan.
 *
 * One pass over the surfaces and lights finds the first of each kind that calls for an effect;
 * then each row is filled by a function of its own, from that evidence and the options.
 * SPDX-License-Identifier: Apache-2.0 */
#include "plan/plan_int.h"

#include "math/eps.h"

#include <stdarg.h>
#include <stdio.h>

enum {
    QUALITY_LIGHTS = 2,      /* below: pigments only */
    QUALITY_SHADOWS = 4,     /* shadow rays, area lights as points */
    QUALITY_AREA_LIGHTS = 5, /* soft shadows */
    QUALITY_REFRACTION = 6,  /* light through surfaces */
    QUALITY_REFLECTION = 8,
    QUALITY_PHOTONS = 9
};

/* Photons sent into the scene for indirect light when the scene names no number. */
enum { GLOBAL_PHOTONS_DEFAULT = 200000 };

/* The first surface or light that shows each trait, and how many do. */
typedef struct Evidence {
    const Surface *transmitting, *reflecting, *absorbing, *highlighted, *filtering, *target;
    const Surface *dispersing;
    const Surface *blocking; /* casts a shadow */
    const Light *light;      /* with any colour */
    const Light *shadowing;  /* not shadowless */
    const Light *area;       /* an area light that casts shadows */
    const Light *lit_area;   /* one with area_illumination */
    const Light *caustic_light;
    int targets, caustic_lights;
    const Surface *bending;        /* mirrors light, or lets it through other than straight */
    const Surface *clear;          /* casts a shadow that light passes straight */
    const Light *sized, *sizeless; /* casts shadows, and paths can (cannot) meet it */
    int sized_lights, sizeless_lights;
} Evidence;

const char *feature_name(FeatureId feature)
{
    static const char *const names[] = {
#define X(id, name, text) name,
#include "plan/feature.def"
#undef X
    };
    return names[feature];
}

const char *feature_text(FeatureId feature)
{
    static const char *const texts[] = {
#define X(id, name, text) text,
#include "plan/feature.def"
#undef X
    };
    return texts[feature];
}

/* --- evidence --------------------------------------------------------------------------- */

static bool light_shines(const Light *light)
{
    return !rgb_is_black(light->color);
}

static bool finish_has_highlights(const Finish *finish)
{
    return finish->phong != 0 || finish->specular != 0;
}

static bool texture_has_highlights(const Texture *texture)
{
    for (int i = 0; texture && i < texture->layer_count; i++)
        if (finish_has_highlights(texture->layers[i].finish))
            return true;
    return false;
}

static bool surface_has_highlights(const Surface *surface)
{
    if (texture_has_highlights(surface->texture) || texture_has_highlights(surface->inner_texture))
        return true;
    for (int i = 0; i < surface->mesh_texture_count; i++)
        if (texture_has_highlights(surface->mesh_textures[i]))
            return true;
    return false;
}

/* Does some layer give off light? */
static bool texture_glows(const Texture *texture, bool has_ambient)
{
    for (int i = 0; texture && i < texture->layer_count; i++) {
        const Finish *finish = texture->layers[i].finish;
        if (!rgb_is_black(finish->emission) || (has_ambient && !rgb_is_black(finish->ambient)))
            return true;
    }
    return false;
}

bool plan_surface_glows(const Plan *plan, const Surface *surface)
{
    bool has_ambient = plan->has_ambient;
    if (texture_glows(surface->texture, has_ambient) ||
        texture_glows(surface->inner_texture, has_ambient))
        return true;
    for (int i = 0; i < surface->mesh_texture_count; i++)
        if (texture_glows(surface->mesh_textures[i], has_ambient))
            return true;
    return false;
}

static bool photons_do(Tri of_light, Tri of_object)
{
    if (of_light == TRI_OFF || of_object == TRI_OFF)
        return false;
    return of_light == TRI_ON || of_object == TRI_ON;
}

bool plan_photons_reflect(const Light *light, const Surface *surface)
{
    return surface->may_reflect &&
           photons_do(light->photon_reflection, surface->photons.reflection);
}

bool plan_photons_refract(const Light *light, const Surface *surface)
{
    return surface->may_transmit &&
           photons_do(light->photon_refraction, surface->photons.refraction);
}

static bool light_makes_caustics(const Scene *scene, const Light *light)
{
    if (light->is_shadowless || !light_shines(light) || !(light->photon_share > 0))
        return false;
    for (uint32_t i = 0; i < scene->surface_count; i++) {
        const Surface *surface = &scene->surfaces[i];
        if (surface->is_target &&
            (plan_photons_reflect(light, surface) || plan_photons_refract(light, surface)))
            return true;
    }
    return false;
}

static void first_surface(const Surface **slot, const Surface *surface, bool is_such)
{
    if (is_such && !*slot)
        *slot = surface;
}

static void first_light(const Light **slot, const Light *light, bool is_such)
{
    if (is_such && !*slot)
        *slot = light;
}

static void look_at_surface(const Surface *s, Evidence *found)
{
    first_surface(&found->transmitting, s, s->may_transmit);
    first_surface(&found->reflecting, s, s->may_reflect);
    first_surface(&found->absorbing, s, s->may_transmit && s->interior->fade_distance > 0);
    first_surface(&found->dispersing, s,
                  s->may_transmit && s->interior->dispersion != DISPERSION_NONE);
    first_surface(&found->highlighted, s, surface_has_highlights(s));
    first_surface(&found->blocking, s, !s->no_shadow);
    first_surface(&found->filtering, s, s->may_transmit && !s->no_shadow);
    first_surface(&found->bending, s,
                  (s->may_reflect || (s->may_transmit && !s->is_filter)) && !s->no_shadow);
    first_surface(&found->clear, s, s->may_transmit && s->is_filter && !s->no_shadow);
    first_surface(&found->target, s, s->is_target);
    found->targets += s->is_target;
}

bool plan_light_has_size(const Light *light, double light_radius)
{
    bool is_parallel = light->is_parallel || light->kind == LIGHT_CYLINDER;
    return light_radius > 0 || (!is_parallel && light->area.size1 > 1 && light->area.size2 > 1);
}

static void look_at_light(const Scene *scene, const PlanOptions *options, const Light *light,
                          bool *makes_caustics, Evidence *found)
{
    if (!light_shines(light))
        return;
    bool has_size = plan_light_has_size(light, options->light_radius);
    found->sized_lights += has_size && !light->is_shadowless;
    found->sizeless_lights += !has_size && !light->is_shadowless;
    first_light(&found->sized, light, has_size && !light->is_shadowless);
    first_light(&found->sizeless, light, !has_size && !light->is_shadowless);
    *makes_caustics = light_makes_caustics(scene, light);
    found->caustic_lights += *makes_caustics;
    first_light(&found->light, light, true);
    first_light(&found->shadowing, light, !light->is_shadowless);
    first_light(&found->area, light, light->area.size1 > 0 && !light->is_shadowless);
    first_light(&found->lit_area, light,
                light->area.size1 > 0 && !light->is_shadowless && light->area.has_illumination);
    first_light(&found->caustic_light, light, *makes_caustics);
}

/* --- rows ------------------------------------------------------------------------------- */

static bool row_set(PlanRow *row, bool is_on, Span why, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

static bool row_set(PlanRow *row, bool is_on, Span why, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    vsnprintf(row->reason, sizeof row->reason, format, args);
    va_end(args);
    row->is_on = is_on;
    row->why = why;
    return is_on;
}

/* Rule a row out for the quality asked for; returns whether it was. */
static bool row_below(PlanRow *row, int quality, int needed)
{
    if (quality >= needed)
        return false;
    row_set(row, false, SPAN_NONE, "quality %d (from %d on)", quality, needed);
    return true;
}

static void plan_passes(const PlanOptions *options, PlanRow *row)
{
    row_set(row, options->is_progressive, SPAN_NONE, "%s",
            options->is_progressive ? "asked for on the command line"
                                    : "not asked for (--progressive)");
}

static void plan_paths(const PlanOptions *options, const Evidence *found, Plan *plan)
{
    PlanRow *row = &plan->rows[FEATURE_PATHS], *caustics = &plan->rows[FEATURE_PATH_CAUSTICS];
    bool has_paths = options->integrator == INTEGRATOR_PATH;
    if (!has_paths)
        row_set(row, false, SPAN_NONE, "not asked for (--integrator path)");
    else if (!row_below(row, options->quality, QUALITY_PHOTONS))
        row_set(row, true, SPAN_NONE,
                "asked for on the command line; finish ambient does not count");
    if (!row->is_on)
        row_set(caustics, false, SPAN_NONE, "no path tracing");
    else if (!found->bending)
        row_set(caustics, false, SPAN_NONE,
                "no surface that casts a shadow bends or mirrors light");
    else if (!found->shadowing)
        row_set(caustics, false, SPAN_NONE, "no light casts shadows");
    else if (!found->sized)
        row_set(caustics, false, found->sizeless->span,
                "MISSING: no light has a size (--light-radius gives them one)");
    else if (found->sizeless)
        row_set(caustics, true, found->sizeless->span,
                "lights with a size: %d; MISSING are those of %d without (--light-radius)",
                found->sized_lights, found->sizeless_lights);
    else
        row_set(caustics, true, found->bending->span, "lights with a size: %d",
                found->sized_lights);
    if (row->is_on && found->bending)
        plan->unmet_lights = found->sizeless_lights;
}

static void plan_caustics(const Scene *scene, const PlanOptions *options, const Evidence *found,
                          bool has_paths, PlanRow *row)
{
    const PhotonSettings *photons = &scene->settings.photons;
    if (row_below(row, options->quality, QUALITY_PHOTONS))
        return;
    if (!found->transmitting && !found->reflecting)
        row_set(row, false, SPAN_NONE, "no surface reflects or transmits");
    else if (has_paths)
        row_set(row, false, SPAN_NONE, "path tracing finds that light itself");
    else if (options->has_no_photons)
        row_set(row, false, SPAN_NONE, "switched off on the command line");
    else if (!photons->is_on)
        row_set(row, false, SPAN_NONE,
                "no photons{} in global_settings: transparent objects cast filtered shadows");
    else if (photons->gather_max <= 0)
        row_set(row, false, photons->span, "photons{} gathers no photons");
    else if (!found->target)
        row_set(row, false, photons->span, "photons{}, but nothing is a target");
    else if (!found->caustic_light)
        row_set(row, false, found->target->span, "%s",
                found->shadowing ? "no light is reflected or refracted by a target"
                                 : "no light casts shadows");
    else
        row_set(row, true, photons->span, "photons{}, %d target surface%s, %d light%s",
                found->targets, found->targets == 1 ? "" : "s", found->caustic_lights,
                found->caustic_lights == 1 ? "" : "s");
}

/* The first surface whose own light reaches others. */
static const Surface *glowing_surface(const Scene *scene, const Plan *plan)
{
    for (uint32_t i = 0; i < scene->surface_count; i++) {
        const Surface *s = &scene->surfaces[i];
        if (!s->no_shadow && !s->no_radiosity && plan_surface_glows(plan, s))
            return s;
    }
    return NULL;
}

static bool sky_shines(const Scene *scene)
{
    Color5 c = scene->background.color;
    return scene->sky.pigment_count > 0 || !rgb_is_black(rgb_scale(color5_rgb(c), 1 - c.transmit));
}

static void plan_indirect_method(const Scene *scene, const PlanOptions *options, Plan *plan)
{
    static const char *const off[] = {"no indirect light from photons",
                                      "the global map is looked at directly", "gathered everywhere",
                                      "every pass gathers anew"};
    const PmsSettings *pms = &scene->settings.pms;
    PlanRow *gather = &plan->rows[FEATURE_FINAL_GATHER];
    PlanRow *cache = &plan->rows[FEATURE_IRRADIANCE_CACHE];
    const PlanRow *map = &plan->rows[FEATURE_GLOBAL_MAP];
    IndirectMethod method = options->indirect ? options->indirect : pms->method;
    bool is_progressive = plan_has(plan, FEATURE_PROGRESSIVE);
    const char *asked = options->indirect ? "asked for on the command line"
                        : pms->method     ? "gi_method in pms{}"
                                      : "the way indirect light is found if nothing else is said";
    if (!map->is_on || method == INDIRECT_MAP) {
        const char *why = off[map->is_on];
        row_set(gather, false, SPAN_NONE, "%s", why);
        row_set(cache, false, SPAN_NONE, "%s", why);
        return;
    }
    row_set(gather, true, map->why, "%s", asked);
    bool has_cache = method != INDIRECT_GATHER && !is_progressive;
    row_set(cache, has_cache, map->why, "%s", has_cache ? asked : off[is_progressive ? 3 : 2]);
}

static void plan_glow(const Scene *scene, Plan *plan)
{
    bool is_indirect = plan_has(plan, FEATURE_GLOBAL_MAP);
    const char *none = plan_has(plan, FEATURE_PATHS) ? "path tracing finds that light itself"
                                                     : "no indirect light";
    const Surface *s = is_indirect ? glowing_surface(scene, plan) : NULL;
    bool is_sky = is_indirect && sky_shines(scene);
    row_set(&plan->rows[FEATURE_GLOW], s, s ? s->span : SPAN_NONE, "%s",
            s             ? "a finish that gives off light"
            : is_indirect ? "no finish that casts a shadow gives off light"
                          : none);
    row_set(&plan->rows[FEATURE_SKY_LIGHT], is_sky,
            scene->sky.pigment_count > 0 ? scene->sky.span : scene->background.span, "%s",
            is_sky        ? "sky_sphere or background that is not black"
            : is_indirect ? "the background is black"
                          : none);
}

static void plan_indirect(const Scene *scene, const PlanOptions *options, const Evidence *found,
                          Plan *plan)
{
    const PmsSettings *pms = &scene->settings.pms;
    const RadiositySettings *radiosity = &scene->settings.radiosity;
    PlanRow *row = &plan->rows[FEATURE_GLOBAL_MAP];
    bool is_asked = options->has_indirect || pms->has_indirect || radiosity->is_on;
    bool has_paths = plan_has(plan, FEATURE_PATHS);
    bool is_old = radiosity->is_on && scene->settings.version < 3.7;
    bool may_be =
        options->quality >= QUALITY_PHOTONS && is_asked && !has_paths && !options->has_no_photons;
    plan->has_ambient = !has_paths && (!may_be || is_old);
    bool has_light = found->light || sky_shines(scene) || glowing_surface(scene, plan) ||
                     plan_media_glow(scene);
    if (row_below(row, options->quality, QUALITY_PHOTONS))
        return;
    if (has_paths)
        row_set(row, false, SPAN_NONE, "path tracing finds that light itself");
    else if (!is_asked)
        row_set(row, false, SPAN_NONE, "not asked for (gi, radiosity)");
    else if (options->has_no_photons)
        row_set(row, false, SPAN_NONE, "switched off on the command line");
    else if (!has_light || scene->surface_count == 0)
        row_set(row, false, pms->has_indirect ? pms->span : radiosity->span,
                "asked for, but there is no light or no surface");
    else
        row_set(row, true, pms->has_indirect ? pms->span : radiosity->span, "%s; finish ambient %s",
                options->has_indirect ? "asked for on the command line"
                : pms->has_indirect   ? "gi in pms{}"
                                      : "radiosity{}",
                is_old ? "counts as emission" : "does not count");
    plan->has_ambient = !has_paths && (!row->is_on || is_old);
}

static void plan_lights(const PlanOptions *options, const Evidence *found, Plan *plan)
{
    PlanRow *rows = plan->rows;
    int quality = options->quality;
    if (!row_below(&rows[FEATURE_LIGHTS], quality, QUALITY_LIGHTS))
        row_set(&rows[FEATURE_LIGHTS], found->light, found->light ? found->light->span : SPAN_NONE,
                "%s", found->light ? "a light source" : "no light source");

    PlanRow *row = &rows[FEATURE_SHADOWS];
    if (!row_below(row, quality, QUALITY_SHADOWS)) {
        bool is_on = found->shadowing && found->blocking;
        row_set(row, is_on, is_on ? found->shadowing->span : SPAN_NONE, "%s",
                is_on               ? "a light that casts shadows"
                : !found->shadowing ? "no light casts shadows"
                                    : "no object casts a shadow");
    }
    bool has_shadows = row->is_on;

    row = &rows[FEATURE_TRANSPARENT_SHADOWS];
    if (!has_shadows)
        row_set(row, false, SPAN_NONE, "no shadow rays");
    else if (plan_has(plan, FEATURE_PATHS))
        row_set(row, found->clear, found->clear ? found->clear->span : SPAN_NONE, "%s",
                found->clear ? "an object that casts a shadow and that light passes straight"
                             : "no object that casts a shadow lets light pass straight");
    else
        row_set(row, found->filtering, found->filtering ? found->filtering->span : SPAN_NONE, "%s",
                found->filtering ? "an object that casts a shadow may transmit light"
                                 : "every object that casts a shadow is opaque");

    row = &rows[FEATURE_AREA_LIGHTS];
    if (row_below(row, quality, QUALITY_AREA_LIGHTS))
        return;
    if (found->area && !has_shadows && !found->lit_area)
        row_set(row, false, found->area->span, "area_light, but no object casts a shadow");
    else
        row_set(row, found->area, found->area ? found->area->span : SPAN_NONE, "%s",
                found->area ? "area_light" : "no area_light that casts shadows");
}

static void plan_dispersion(const PlanOptions *options, const Evidence *found, PlanRow *row)
{
    const Surface *s = found->dispersing;
    if (row_below(row, options->quality, QUALITY_REFRACTION))
        return;
    if (!s)
        row_set(row, false, SPAN_NONE, "no transparent object has dispersion");
    else if (s->interior->dispersion == DISPERSION_RATIO)
        row_set(row, true, s->span, "an interior with dispersion %g, seen in %d bands",
                s->interior->coefficients[0], s->interior->dispersion_samples);
    else
        row_set(row, true, s->span, "an interior with %s in pms{}, seen in %d bands",
                s->interior->dispersion == DISPERSION_CAUCHY ? "cauchy" : "sellmeier",
                s->interior->dispersion_samples);
}

static void plan_surfaces(const PlanOptions *options, const Evidence *found, PlanRow *rows)
{
    const Surface *s = found->reflecting;
    if (!row_below(&rows[FEATURE_REFLECTION], options->quality, QUALITY_REFLECTION))
        row_set(&rows[FEATURE_REFLECTION], s, s ? s->span : SPAN_NONE, "%s",
                s ? "a finish with reflection" : "no finish reflects");

    s = found->transmitting;
    if (!row_below(&rows[FEATURE_REFRACTION], options->quality, QUALITY_REFRACTION))
        row_set(&rows[FEATURE_REFRACTION], s, s ? s->span : SPAN_NONE, "%s",
                s ? "a pigment with filter or transmit" : "no pigment has filter or transmit");

    plan_dispersion(options, found, &rows[FEATURE_DISPERSION]);
    s = found->absorbing;
    row_set(&rows[FEATURE_ABSORPTION], s, s ? s->span : SPAN_NONE, "%s",
            s ? "an interior with fade_distance" : "no transparent object has fade_distance");

    s = found->highlighted;
    if (!row_below(&rows[FEATURE_HIGHLIGHTS], options->quality, QUALITY_LIGHTS)) {
        bool is_on = s && found->shadowing;
        row_set(&rows[FEATURE_HIGHLIGHTS], is_on, is_on ? s->span : SPAN_NONE, "%s",
                is_on ? "a finish with phong or specular"
                : s   ? "phong or specular, but no light that makes highlights"
                      : "no finish has phong or specular");
    }
}

static void plan_camera_and_sky(const Scene *scene, PlanRow *rows)
{
    const Camera *camera = &scene->camera;
    bool is_blurred = camera->aperture != 0 && camera->blur_samples > 0;
    row_set(&rows[FEATURE_FOCAL_BLUR], is_blurred, camera->span, "%s",
            is_blurred              ? "camera with aperture and blur_samples"
            : camera->aperture != 0 ? "camera with aperture, but no blur_samples"
                                    : "camera without aperture");
    bool has_sky = scene->sky.pigment_count > 0;
    row_set(&rows[FEATURE_SKY], has_sky, scene->sky.span, "%s",
            has_sky ? "sky_sphere" : "no sky_sphere");
}

static long global_photons(const Scene *scene)
{
    long asked = scene->settings.pms.global_count;
    return asked > 0 ? asked : GLOBAL_PHOTONS_DEFAULT;
}

Status plan_make(const Scene *scene, const PlanOptions *options, Arena *arena, Plan *out)
{
    *out = (Plan){0};
    out->light_makes_caustics = ARENA_ARRAY(arena, bool, (size_t)scene->light_count + 1);
    if (!out->light_makes_caustics)
        return ERR_MEMORY;
    Evidence found = {0};
    for (uint32_t i = 0; i < scene->surface_count; i++)
        look_at_surface(&scene->surfaces[i], &found);
    for (int i = 0; i < scene->light_count; i++)
        look_at_light(scene, options, &scene->lights[i], &out->light_makes_caustics[i], &found);

    plan_passes(options, &out->rows[FEATURE_PROGRESSIVE]);
    plan_paths(options, &found, out);
    bool has_paths = plan_has(out, FEATURE_PATHS);
    plan_caustics(scene, options, &found, has_paths, &out->rows[FEATURE_CAUSTIC_MAP]);
    plan_indirect(scene, options, &found, out);
    plan_indirect_method(scene, options, out);
    plan_glow(scene, out);
    plan_lights(options, &found, out);
    plan_surfaces(options, &found, out->rows);
    plan_camera_and_sky(scene, out->rows);
    plan_media(scene, options->quality, out->rows);

    plan_volume(scene, out);

    out->is_unlit = options->quality < QUALITY_LIGHTS;
    out->light_radius = options->light_radius;
    if (plan_has(out, FEATURE_CAUSTIC_MAP))
        out->caustic_photons = scene->settings.photons.count;
    else
        for (int i = 0; i < scene->light_count; i++)
            out->light_makes_caustics[i] = false;
    if (plan_has(out, FEATURE_GLOBAL_MAP))
        out->global_photons = global_photons(scene);
    return OK;
}
