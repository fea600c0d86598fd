/* The plan.
 *
 * One pass over the surfaces and lights finds the first of each kind that calls for an effect;
 * then each row is filled by a function of its own, from that evidence and the options.
 * SPDX-License-Identifier: Apache-2.0 */
#include "plan/plan_int.h"

#include "math/eps.h"

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
    for (int i = 0; i < surface->part_texture_count; i++)
        if (texture_has_highlights(surface->part_textures[i]))
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
    for (int i = 0; i < surface->part_texture_count; i++)
        if (texture_glows(surface->part_textures[i], has_ambient))
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

/* Do photons of a light go on from a surface, as far as they may? */
static bool photons_go_on(const PlanOptions *options, const Light *light, const Surface *surface)
{
    return (options->effects[FEATURE_REFLECTION] != TRI_OFF &&
            plan_photons_reflect(light, surface)) ||
           (options->effects[FEATURE_REFRACTION] != TRI_OFF &&
            plan_photons_refract(light, surface));
}

static bool light_makes_caustics(const Scene *scene, const PlanOptions *options, const Light *light)
{
    if (light->is_shadowless || !light_shines(light) || !(light->photon_share > 0))
        return false;
    for (uint32_t i = 0; i < scene->surface_count; i++) {
        const Surface *surface = &scene->surfaces[i];
        if (surface->is_target && photons_go_on(options, light, surface))
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
    bool is_shrunk = light->area.size1 > 0 && options->effects[FEATURE_AREA_LIGHTS] == TRI_OFF;
    bool has_size = !is_shrunk && plan_light_has_size(light, options->light_radius);
    found->sized_lights += has_size && !light->is_shadowless;
    found->sizeless_lights += !has_size && !light->is_shadowless;
    first_light(&found->sized, light, has_size && !light->is_shadowless);
    first_light(&found->sizeless, light, !has_size && !light->is_shadowless);
    *makes_caustics = light_makes_caustics(scene, options, light);
    found->caustic_lights += *makes_caustics;
    first_light(&found->light, light, true);
    first_light(&found->shadowing, light, !light->is_shadowless);
    first_light(&found->area, light, light->area.size1 > 0 && !light->is_shadowless);
    first_light(&found->lit_area, light,
                light->area.size1 > 0 && !light->is_shadowless && light->area.has_illumination);
    first_light(&found->caustic_light, light, *makes_caustics);
}

/* --- rows ------------------------------------------------------------------------------- */

static void plan_passes(const PlanOptions *options, PlanRow *row)
{
    row_set(row, options->is_progressive, SPAN_NONE, "%s",
            options->is_progressive ? "asked for on the command line"
                                    : "not asked for (--progressive)");
}

static void plan_paths(const PlanOptions *options, const Evidence *found, Plan *plan)
{
    PlanRow *row = &plan->rows[FEATURE_PATHS], *caustics = &plan->rows[FEATURE_PATH_CAUSTICS];
    bool has_paths =
        options->integrator == INTEGRATOR_PATH || options->effects[FEATURE_PATHS] == TRI_ON;
    if (!has_paths)
        row_set(row, false, SPAN_NONE, "not asked for (--integrator path)");
    else if (!row_ruled_out(options, FEATURE_PATHS, plan->rows))
        row_set(row, true, SPAN_NONE,
                "asked for on the command line; finish ambient does not count");
    if (row_ruled_out(options, FEATURE_PATH_CAUSTICS, plan->rows))
        return;
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
                          PlanRow *rows)
{
    const PhotonSettings *photons = &scene->settings.photons;
    PlanRow *row = &rows[FEATURE_CAUSTIC_MAP];
    if (row_ruled_out(options, FEATURE_CAUSTIC_MAP, rows))
        return;
    if (!found->transmitting && !found->reflecting)
        row_set(row, false, SPAN_NONE, "no surface reflects or transmits");
    else if (rows[FEATURE_PATHS].is_on)
        row_set(row, false, SPAN_NONE, "path tracing finds that light itself");
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

static bool sky_shines(const Scene *scene, const PlanOptions *options)
{
    Color5 c = scene->background.color;
    bool has_sky = scene->sky.pigment_count > 0 && options->effects[FEATURE_SKY] != TRI_OFF;
    return has_sky || !rgb_is_black(rgb_scale(color5_rgb(c), 1 - c.transmit));
}

/* How indirect light is found: as the effects that are forced have it, else as asked for. */
static IndirectMethod indirect_method(const PlanOptions *options, const PmsSettings *pms)
{
    Tri gather = options->effects[FEATURE_FINAL_GATHER];
    Tri cache = options->effects[FEATURE_IRRADIANCE_CACHE];
    IndirectMethod method = options->indirect ? options->indirect : pms->method;
    if (gather == TRI_OFF)
        return INDIRECT_MAP;
    if (cache == TRI_ON || (gather == TRI_ON && method == INDIRECT_MAP))
        method = INDIRECT_CACHE;
    return cache == TRI_OFF && method != INDIRECT_MAP ? INDIRECT_GATHER : method;
}

static void plan_indirect_method(const Scene *scene, const PlanOptions *options, Plan *plan)
{
    static const char *const off[] = {"no indirect light from photons",
                                      "the global map is looked at directly",
                                      "gathered everywhere"};
    const PmsSettings *pms = &scene->settings.pms;
    PlanRow *gather = &plan->rows[FEATURE_FINAL_GATHER];
    PlanRow *cache = &plan->rows[FEATURE_IRRADIANCE_CACHE];
    const PlanRow *map = &plan->rows[FEATURE_GLOBAL_MAP];
    IndirectMethod method = indirect_method(options, pms);
    const char *asked = options->indirect ? "asked for on the command line"
                        : pms->method     ? "gi_method in pms{}"
                                      : "the way indirect light is found if nothing else is said";
    bool has_gather = map->is_on && method != INDIRECT_MAP;
    bool has_cache = has_gather && method != INDIRECT_GATHER;
    if (!row_ruled_out(options, FEATURE_FINAL_GATHER, plan->rows))
        row_set(gather, has_gather, has_gather ? map->why : SPAN_NONE, "%s",
                has_gather ? asked : off[map->is_on]);
    if (!row_ruled_out(options, FEATURE_IRRADIANCE_CACHE, plan->rows))
        row_set(cache, has_cache, has_gather ? map->why : SPAN_NONE, "%s",
                has_cache ? asked : off[has_gather ? 2 : map->is_on]);
}

static void plan_glow(const Scene *scene, const PlanOptions *options, Plan *plan)
{
    bool is_indirect = plan_has(plan, FEATURE_GLOBAL_MAP);
    const char *none = plan_has(plan, FEATURE_PATHS) ? "path tracing finds that light itself"
                                                     : "no indirect light";
    const Surface *s = is_indirect ? glowing_surface(scene, plan) : NULL;
    bool is_sky = is_indirect && sky_shines(scene, options);
    if (!row_ruled_out(options, FEATURE_GLOW, plan->rows))
        row_set(&plan->rows[FEATURE_GLOW], s, s ? s->span : SPAN_NONE, "%s",
                s             ? "a finish that gives off light"
                : is_indirect ? "no finish that casts a shadow gives off light"
                              : none);
    if (!row_ruled_out(options, FEATURE_SKY_LIGHT, plan->rows))
        row_set(&plan->rows[FEATURE_SKY_LIGHT], is_sky,
                scene->sky.pigment_count > 0 ? scene->sky.span : scene->background.span, "%s",
                is_sky        ? "sky_sphere or background that is not black"
                : is_indirect ? "the background is black"
                              : none);
}

/* Does the command line force an effect on that is there with indirect light only? */
static bool forces_indirect(const PlanOptions *options)
{
    static const FeatureId needing[] = {FEATURE_GLOBAL_MAP, FEATURE_FINAL_GATHER,
                                        FEATURE_IRRADIANCE_CACHE, FEATURE_GLOW, FEATURE_SKY_LIGHT};
    bool forces = false;
    for (size_t i = 0; i < sizeof needing / sizeof *needing; i++)
        forces |= options->effects[needing[i]] == TRI_ON;
    return forces;
}

static void plan_indirect(const Scene *scene, const PlanOptions *options, const Evidence *found,
                          Plan *plan)
{
    const PmsSettings *pms = &scene->settings.pms;
    const RadiositySettings *radiosity = &scene->settings.radiosity;
    PlanRow *row = &plan->rows[FEATURE_GLOBAL_MAP];
    bool is_line = options->has_indirect || forces_indirect(options);
    bool is_asked = is_line || pms->has_indirect || radiosity->is_on;
    bool has_paths = plan_has(plan, FEATURE_PATHS);
    bool is_old = radiosity->is_on && scene->settings.version < 3.7;
    bool is_off = row_ruled_out(options, FEATURE_GLOBAL_MAP, plan->rows);
    bool may_be = !is_off && is_asked && !has_paths;
    plan->has_ambient = !has_paths && (!may_be || is_old);
    bool has_light = found->light || sky_shines(scene, options) || glowing_surface(scene, plan) ||
                     plan_media_glow(scene);
    if (is_off)
        return;
    if (has_paths)
        row_set(row, false, SPAN_NONE, "path tracing finds that light itself");
    else if (!is_asked)
        row_set(row, false, SPAN_NONE, "not asked for (gi, radiosity)");
    else if (!has_light || scene->surface_count == 0)
        row_set(row, false, pms->has_indirect ? pms->span : radiosity->span,
                "asked for, but there is no light or no surface");
    else
        row_set(row, true, pms->has_indirect ? pms->span : radiosity->span, "%s; finish ambient %s",
                is_line             ? "asked for on the command line"
                : pms->has_indirect ? "gi in pms{}"
                                    : "radiosity{}",
                is_old ? "counts as emission" : "does not count");
    plan->has_ambient = !has_paths && (!row->is_on || is_old);
}

static void plan_filtered_shadows(const PlanOptions *options, const Evidence *found, Plan *plan)
{
    PlanRow *row = &plan->rows[FEATURE_TRANSPARENT_SHADOWS];
    if (row_ruled_out(options, FEATURE_TRANSPARENT_SHADOWS, plan->rows))
        return;
    if (!plan_has(plan, FEATURE_SHADOWS))
        row_set(row, false, SPAN_NONE, "no shadow rays");
    else if (plan_has(plan, FEATURE_PATHS))
        row_set(row, found->clear, found->clear ? found->clear->span : SPAN_NONE, "%s",
                found->clear ? "an object that casts a shadow and that light passes straight"
                             : "no object that casts a shadow lets light pass straight");
    else
        row_set(row, found->filtering, found->filtering ? found->filtering->span : SPAN_NONE, "%s",
                found->filtering ? "an object that casts a shadow may transmit light"
                                 : "every object that casts a shadow is opaque");
}

static void plan_lights(const PlanOptions *options, const Evidence *found, Plan *plan)
{
    PlanRow *rows = plan->rows;
    if (!row_ruled_out(options, FEATURE_LIGHTS, rows))
        row_set(&rows[FEATURE_LIGHTS], found->light, found->light ? found->light->span : SPAN_NONE,
                "%s", found->light ? "a light source" : "no light source");

    PlanRow *row = &rows[FEATURE_SHADOWS];
    if (!row_ruled_out(options, FEATURE_SHADOWS, rows)) {
        bool is_on = found->shadowing && found->blocking;
        row_set(row, is_on, is_on ? found->shadowing->span : SPAN_NONE, "%s",
                is_on               ? "a light that casts shadows"
                : !found->shadowing ? "no light casts shadows"
                                    : "no object casts a shadow");
    }
    bool has_shadows = row->is_on;

    plan_filtered_shadows(options, found, plan);
    row = &rows[FEATURE_AREA_LIGHTS];
    if (row_ruled_out(options, FEATURE_AREA_LIGHTS, rows))
        return;
    if (found->area && !has_shadows && !found->lit_area)
        row_set(row, false, found->area->span, "area_light, but no object casts a shadow");
    else
        row_set(row, found->area, found->area ? found->area->span : SPAN_NONE, "%s",
                found->area ? "area_light" : "no area_light that casts shadows");
}

static void plan_dispersion(const PlanOptions *options, const Evidence *found, PlanRow *rows)
{
    const Surface *s = found->dispersing;
    PlanRow *row = &rows[FEATURE_DISPERSION];
    if (row_ruled_out(options, FEATURE_DISPERSION, rows))
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
    if (!row_ruled_out(options, FEATURE_REFLECTION, rows))
        row_set(&rows[FEATURE_REFLECTION], s, s ? s->span : SPAN_NONE, "%s",
                s ? "a finish with reflection" : "no finish reflects");

    s = found->transmitting;
    if (!row_ruled_out(options, FEATURE_REFRACTION, rows))
        row_set(&rows[FEATURE_REFRACTION], s, s ? s->span : SPAN_NONE, "%s",
                s ? "a pigment with filter or transmit" : "no pigment has filter or transmit");

    plan_dispersion(options, found, rows);
    s = found->absorbing;
    if (!row_ruled_out(options, FEATURE_ABSORPTION, rows))
        row_set(&rows[FEATURE_ABSORPTION], s, s ? s->span : SPAN_NONE, "%s",
                s ? "an interior with fade_distance" : "no transparent object has fade_distance");

    s = found->highlighted;
    if (!row_ruled_out(options, FEATURE_HIGHLIGHTS, rows)) {
        bool is_on = s && found->shadowing;
        row_set(&rows[FEATURE_HIGHLIGHTS], is_on, is_on ? s->span : SPAN_NONE, "%s",
                is_on ? "a finish with phong or specular"
                : s   ? "phong or specular, but no light that makes highlights"
                      : "no finish has phong or specular");
    }
}

static void plan_camera_and_sky(const Scene *scene, const PlanOptions *options, PlanRow *rows)
{
    const Camera *camera = &scene->camera;
    bool is_blurred = camera->aperture != 0 && camera->blur_samples > 0;
    if (!row_ruled_out(options, FEATURE_FOCAL_BLUR, rows))
        row_set(&rows[FEATURE_FOCAL_BLUR], is_blurred, camera->span, "%s",
                is_blurred              ? "camera with aperture and blur_samples"
                : camera->aperture != 0 ? "camera with aperture, but no blur_samples"
                                        : "camera without aperture");
    bool has_sky = scene->sky.pigment_count > 0;
    if (!row_ruled_out(options, FEATURE_SKY, rows))
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
    plan_caustics(scene, options, &found, out->rows);
    plan_indirect(scene, options, &found, out);
    plan_indirect_method(scene, options, out);
    plan_glow(scene, options, out);
    plan_lights(options, &found, out);
    plan_surfaces(options, &found, out->rows);
    plan_camera_and_sky(scene, options, out->rows);
    plan_media(scene, options, out->rows);
    plan_volume(scene, options, out);
    rows_tell_forced(options, out->rows);

    out->is_unlit = !row_has_quality(options, FEATURE_LIGHTS);
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
