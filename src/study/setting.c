/* The settings a study tries.
 *
 * Of each there are two functions: NAME_own returns the scene's own value, or NaN where the setting
 * does nothing, and NAME_set changes a copy of the scene or its options, says how a user would, and
 * guesses what that costs.  SPDX-License-Identifier: Apache-2.0 */
#include "study/setting.h"

#include "photon/gather.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

typedef struct Setting {
    const char *name, *title;
    SettingKind kind;
    double (*own)(const StudyBase *base);
    Status (*set)(const StudyBase *base, double value, StudyPoint *point);
    double values[SETTING_VALUES_MAX];
    int count;
} Setting;

static const char *const kernel_words[] = {"flat", "cone", "epanechnikov", "gaussian"};
static const char *const shape_words[] = {"disk", "sphere"};
static const char *const method_words[] = {"cache", "gather", "map"};
static const char *const precision_words[] = {"20 bytes", "44 bytes"};

static void say(StudyPoint *point, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Add to what a user writes. */
static void say(StudyPoint *point, const char *format, ...)
{
    va_list args;
    size_t used = strlen(point->how);
    va_start(args, format);
    vsnprintf(point->how + used, sizeof point->how - used, format, args);
    va_end(args);
}

static bool has(const StudyBase *base, FeatureId feature)
{
    return plan_has(base->plan, feature);
}

static bool has_photons(const StudyBase *base)
{
    return has(base, FEATURE_CAUSTIC_MAP) || has(base, FEATURE_GLOBAL_MAP) ||
           has(base, FEATURE_VOLUME_MAP);
}

/* Return true if photons are sent towards targets. */
static bool is_aimed(const StudyBase *base)
{
    return has(base, FEATURE_CAUSTIC_MAP) || base->plan->has_volume_focus;
}

/* --- the picture ------------------------------------------------------------------------- */

static double samples_own(const StudyBase *base)
{
    return base->options->aa == AA_UNIFORM ? base->options->samples : 1;
}

static Status samples_set(const StudyBase *base, double value, StudyPoint *point)
{
    point->options.aa = AA_UNIFORM;
    point->options.samples = (int)value;
    point->eye_cost *= value / samples_own(base);
    say(point, "--aa %.0f", value);
    return OK;
}

static double blur_own(const StudyBase *base)
{
    return has(base, FEATURE_FOCAL_BLUR) ? (double)base->scene->camera.blur_samples : NAN;
}

static Status blur_set(const StudyBase *base, double value, StudyPoint *point)
{
    point->scene.camera.blur_samples = (int)value;
    point->eye_cost *= value / blur_own(base);
    say(point, "camera { ... blur_samples %.0f }", value);
    return OK;
}

static double level_own(const StudyBase *base)
{
    bool matters = has(base, FEATURE_REFLECTION) || has(base, FEATURE_REFRACTION);
    return matters ? (double)base->scene->settings.max_trace_level : NAN;
}

static Status level_set(const StudyBase *base, double value, StudyPoint *point)
{
    (void)base;
    point->scene.settings.max_trace_level = (int)value;
    say(point, "global_settings { max_trace_level %.0f }", value);
    return OK;
}

static double bailout_own(const StudyBase *base)
{
    double own = base->scene->settings.adc_bailout;
    return !isnan(level_own(base)) && own > 0 ? own : NAN;
}

static Status bailout_set(const StudyBase *base, double value, StudyPoint *point)
{
    (void)base;
    point->scene.settings.adc_bailout = value;
    say(point, "global_settings { adc_bailout %.3g }", value);
    return OK;
}

/* --- caustics ---------------------------------------------------------------------------- */

static double photons_own(const StudyBase *base)
{
    long count = base->scene->settings.photons.count;
    return is_aimed(base) && count > 0 ? (double)count : NAN;
}

static Status photons_set(const StudyBase *base, double value, StudyPoint *point)
{
    point->scene.settings.photons.count = (long)value;
    point->photon_cost *= value / photons_own(base);
    say(point, "global_settings { photons { count %.0f } }", value);
    return OK;
}

static double spacing_own(const StudyBase *base)
{
    const PhotonSettings *photons = &base->scene->settings.photons;
    return is_aimed(base) && photons->count == 0 ? photons->spacing : NAN;
}

static Status spacing_set(const StudyBase *base, double value, StudyPoint *point)
{
    double part = spacing_own(base) / value;
    point->scene.settings.photons.spacing = value;
    point->photon_cost *= part * part;
    say(point, "global_settings { photons { spacing %g } }", value);
    return OK;
}

static double gather_own(const StudyBase *base)
{
    return has(base, FEATURE_CAUSTIC_MAP) ? (double)gather_most(&base->scene->settings.photons)
                                          : NAN;
}

static Status gather_set(const StudyBase *base, double value, StudyPoint *point)
{
    PhotonSettings *photons = &point->scene.settings.photons;
    double part = value / gather_most(&base->scene->settings.photons);
    photons->gather_min = (int)lround(photons->gather_min * part);
    photons->gather_max = (int)value;
    point->eye_cost *= part > 1 ? sqrt(part) : 1;
    say(point, "global_settings { photons { gather %d, %d } }", photons->gather_min,
        photons->gather_max);
    return OK;
}

static double radius_own(const StudyBase *base)
{
    return has(base, FEATURE_CAUSTIC_MAP) && base->radius > 0 ? base->radius : NAN;
}

static Status radius_set(const StudyBase *base, double value, StudyPoint *point)
{
    (void)base;
    point->scene.settings.photons.radius = value;
    say(point, "global_settings { photons { radius %.4g } }", value);
    return OK;
}

static double kernel_own(const StudyBase *base)
{
    GatherKernel kernel = base->scene->settings.pms.kernel;
    return has(base, FEATURE_CAUSTIC_MAP) && kernel <= KERNEL_GAUSSIAN ? (double)kernel : NAN;
}

static Status kernel_set(const StudyBase *base, double value, StudyPoint *point)
{
    (void)base;
    point->scene.settings.pms.kernel = (GatherKernel)value;
    say(point, "global_settings { pms { kernel %s } }", kernel_words[(int)value]);
    return OK;
}

static double shape_own(const StudyBase *base)
{
    return has(base, FEATURE_CAUSTIC_MAP) ? (double)base->scene->settings.pms.gather_shape : NAN;
}

static Status shape_set(const StudyBase *base, double value, StudyPoint *point)
{
    (void)base;
    point->scene.settings.pms.gather_shape = (GatherShape)value;
    say(point, "global_settings { pms { gather %s } }", shape_words[(int)value]);
    return OK;
}

static double precision_own(const StudyBase *base)
{
    return has_photons(base) ? (double)base->options->has_full_photons : NAN;
}

static Status precision_set(const StudyBase *base, double value, StudyPoint *point)
{
    (void)base;
    point->options.has_full_photons = value > 0;
    say(point, "(no setting: it shows what packing a photon into 20 bytes costs)");
    return OK;
}

/* --- indirect light ---------------------------------------------------------------------- */

static double global_own(const StudyBase *base)
{
    return has(base, FEATURE_GLOBAL_MAP) ? (double)base->plan->global_photons : NAN;
}

static Status global_set(const StudyBase *base, double value, StudyPoint *point)
{
    point->scene.settings.pms.global_count = (long)value;
    point->photon_cost *= value / global_own(base);
    say(point, "global_settings { pms { global_photons %.0f } }", value);
    return OK;
}

static IndirectMethod method_asked(const StudyBase *base)
{
    IndirectMethod asked = base->options->plan.indirect;
    IndirectMethod method = asked ? asked : base->scene->settings.pms.method;
    return method ? method : INDIRECT_CACHE;
}

static double method_own(const StudyBase *base)
{
    return has(base, FEATURE_GLOBAL_MAP) ? (double)(method_asked(base) - INDIRECT_CACHE) : NAN;
}

static Status method_set(const StudyBase *base, double value, StudyPoint *point)
{
    enum { EVERYWHERE_COST = 10 }; /* about: gathering at every point, over the cache */
    (void)base;
    point->options.plan.indirect = (IndirectMethod)(INDIRECT_CACHE + (int)value);
    point->eye_cost *= point->options.plan.indirect == INDIRECT_GATHER ? EVERYWHERE_COST : 1;
    say(point, "global_settings { pms { gi_method %s } }", method_words[(int)value]);
    return OK;
}

static double rays_own(const StudyBase *base)
{
    return has(base, FEATURE_FINAL_GATHER) ? (double)base->scene->settings.radiosity.count : NAN;
}

static Status rays_set(const StudyBase *base, double value, StudyPoint *point)
{
    point->scene.settings.radiosity.count = (int)value;
    point->eye_cost *= value / rays_own(base);
    say(point, "global_settings { radiosity { count %.0f } }", value);
    return OK;
}

static double cache_own(const StudyBase *base)
{
    return has(base, FEATURE_IRRADIANCE_CACHE) ? base->scene->settings.radiosity.error_bound : NAN;
}

static Status cache_set(const StudyBase *base, double value, StudyPoint *point)
{
    point->scene.settings.radiosity.error_bound = value;
    point->eye_cost *= fmax(1, cache_own(base) / value);
    say(point, "global_settings { radiosity { error_bound %g } }", value);
    return OK;
}

/* --- media ------------------------------------------------------------------------------- */

static const Medium *first_medium(const Scene *scene)
{
    if (scene->atmosphere.media_count > 0)
        return scene->atmosphere.media[0];
    for (uint32_t i = 0; i < scene->surface_count; i++)
        if (scene->surfaces[i].interior->media_count > 0)
            return scene->surfaces[i].interior->media[0];
    return NULL;
}

static double media_own(const StudyBase *base)
{
    const Medium *medium = has(base, FEATURE_MEDIA) ? first_medium(base->scene) : NULL;
    return medium ? (double)medium->variance : NAN;
}

/* Copy media with their variance times `part`; NULL when memory is out. */
static const Medium *const *scale_media(Arena *arena, const Medium *const *media, int count,
                                        double part)
{
    const Medium **list = ARENA_ARRAY(arena, const Medium *, (size_t)count);
    for (int i = 0; list && i < count; i++) {
        Medium *copy = arena_copy(arena, media[i], sizeof *copy);
        if (!copy)
            return NULL;
        copy->variance = (float)(part * (double)copy->variance);
        list[i] = copy;
    }
    return list;
}

static const Interior *scale_interior(Arena *arena, const Interior *interior, double part)
{
    Interior *copy = arena_copy(arena, interior, sizeof *copy);
    if (copy)
        copy->media = scale_media(arena, interior->media, interior->media_count, part);
    return copy && copy->media ? copy : NULL;
}

/* Surfaces of one object share its interior, and stand together. */
static Status scale_surfaces(Scene *scene, double part)
{
    const Interior *before = NULL, *scaled = NULL;
    Surface *surfaces =
        arena_copy(scene->arena, scene->surfaces, scene->surface_count * sizeof *surfaces);
    for (uint32_t i = 0; surfaces && i < scene->surface_count; i++) {
        const Interior *interior = surfaces[i].interior;
        if (interior->media_count == 0)
            continue;
        if (interior != before)
            scaled = scale_interior(scene->arena, interior, part);
        if (!scaled)
            return ERR_MEMORY;
        before = interior;
        surfaces[i].interior = scaled;
    }
    scene->surfaces = surfaces;
    return surfaces ? OK : ERR_MEMORY;
}

static Status media_set(const StudyBase *base, double value, StudyPoint *point)
{
    Scene *scene = &point->scene;
    Atmosphere *air = &scene->atmosphere;
    double part = value / media_own(base);
    if (air->media_count > 0)
        air->media = scale_media(scene->arena, air->media, air->media_count, part);
    point->eye_cost *= fmax(1, pow(part, -0.25));
    say(point, "media { ... variance %g }", value);
    return air->media_count > 0 && !air->media ? ERR_MEMORY : scale_surfaces(scene, part);
}

/* --- ways to render ---------------------------------------------------------------------- */

/* What is cut off does not become better with more samples or photons: ways that are to come as
 * near as one likes cut off less. */
static void raise_limits(const StudyBase *base, StudyPoint *point)
{
    enum { LEVEL_TIMES = 2, LEVEL_MOST = 256, BAILOUT_PARTS = 4 };
    const double cost = 1.3; /* about */
    SceneSettings *own = &point->scene.settings;
    if (isnan(level_own(base)))
        return;
    own->max_trace_level = (int)fmin(LEVEL_MOST, LEVEL_TIMES * own->max_trace_level);
    own->adc_bailout /= BAILOUT_PARTS;
    point->eye_cost *= cost;
    say(point, " max_trace_level %d adc_bailout %.3g", own->max_trace_level, own->adc_bailout);
}

static double balanced_own(const StudyBase *base)
{
    return has_photons(base) ? 1 : NAN;
}

/* More photons blur less only if each estimate's area shrinks, and are less noisy only if more of
 * them are in it: both errors fall alike when that number goes as the power 2/3 of all. */
static void raise_aimed(double times, StudyPoint *point)
{
    PhotonSettings *photons = &point->scene.settings.photons;
    double more = pow(times, 2.0 / 3);
    photons->gather_min = (int)lround(photons->gather_min * more);
    photons->gather_max = (int)lround(gather_most(photons) * more);
    photons->count = (long)((double)photons->count * times);
    photons->spacing /= sqrt(times);
    say(point, " photons { ");
    if (photons->count > 0)
        say(point, "count %ld", photons->count);
    else
        say(point, "spacing %.3g", photons->spacing);
    say(point, " gather %d, %d }", photons->gather_min, photons->gather_max);
}

static void raise_indirect(const StudyBase *base, double times, StudyPoint *point)
{
    SceneSettings *settings = &point->scene.settings;
    RadiositySettings *radiosity = &settings->radiosity;
    settings->pms.global_count = (long)(global_own(base) * times);
    say(point, " pms { global_photons %ld }", settings->pms.global_count);
    if (isnan(rays_own(base)))
        return;
    double more = sqrt(times);
    radiosity->count = (int)lround(radiosity->count * more);
    point->eye_cost *= more;
    say(point, " radiosity { count %d", radiosity->count);
    if (!isnan(cache_own(base))) {
        radiosity->error_bound /= more;
        say(point, " error_bound %.3g", radiosity->error_bound);
    }
    say(point, " }");
}

/* Samples and photons are raised together, so that neither hides what the other brings: the value
 * is the factor of the samples, its half that of the photons. */
static Status balanced_set(const StudyBase *base, double value, StudyPoint *point)
{
    double times = value / 2;
    TRY(samples_set(base, value * samples_own(base), point));
    point->photon_cost *= times;
    say(point, " and global_settings {");
    if (is_aimed(base))
        raise_aimed(times, point);
    if (has(base, FEATURE_GLOBAL_MAP))
        raise_indirect(base, times, point);
    raise_limits(base, point);
    say(point, " }");
    return OK;
}

/* The limits where they are all that is set in the scene. */
static void say_limits(const StudyBase *base, StudyPoint *point)
{
    if (isnan(level_own(base)))
        return;
    say(point, " and global_settings {");
    raise_limits(base, point);
    say(point, " }");
}

static double passes_own(const StudyBase *base)
{
    (void)base;
    return 1;
}

/* Make a point one of many passes of one sample each. */
static void set_passes(const ProgressiveOptions *passes, StudyPoint *point)
{
    point->options.plan.is_progressive = true;
    point->options.aa = AA_UNIFORM;
    point->options.samples = 1;
    point->options.progressive = *passes;
}

static Status passes_set(const StudyBase *base, double value, StudyPoint *point)
{
    set_passes(&(ProgressiveOptions){.passes = (uint64_t)value}, point);
    point->photon_cost *= value;
    point->eye_cost *= value / samples_own(base);
    say(point, "--progressive --passes %.0f", value);
    say_limits(base, point);
    return OK;
}

static double timed_own(const StudyBase *base)
{
    return passes_own(base);
}

static Status timed_set(const StudyBase *base, double value, StudyPoint *point)
{
    set_passes(&(ProgressiveOptions){.seconds = value}, point);
    point->seconds = value;
    say(point, "--time %.0fs", value);
    say_limits(base, point);
    return OK;
}

static double paths_own(const StudyBase *base)
{
    return base->has_path_truth ? 1 : NAN;
}

static Status paths_set(const StudyBase *base, double value, StudyPoint *point)
{
    TRY(samples_set(base, value, point));
    point->options.plan.integrator = INTEGRATOR_PATH;
    say(point, " --integrator path");
    say_limits(base, point);
    return OK;
}

/* --- the table --------------------------------------------------------------------------- */

#define COUNT_OF(...) (int)(sizeof((double[]){__VA_ARGS__}) / sizeof(double))

static const Setting settings[] = {
#define X(id, name, stem, kind, title, ...)                                                        \
    {name, title, kind, stem##_own, stem##_set, {__VA_ARGS__}, COUNT_OF(__VA_ARGS__)},
#include "study/setting.def"
#undef X
};

const char *setting_name(SettingId id)
{
    return settings[id].name;
}

const char *setting_title(SettingId id)
{
    return settings[id].title;
}

SettingKind setting_kind(SettingId id)
{
    return settings[id].kind;
}

double setting_own(SettingId id, const StudyBase *base)
{
    return settings[id].own(base);
}

/* Counts are whole, and none is less than 1. */
static bool is_whole(SettingId id)
{
    return id != SETTING_SPACING && id != SETTING_RADIUS && id != SETTING_CACHE &&
           id != SETTING_MEDIA && id != SETTING_BAILOUT;
}

int setting_values(SettingId id, const StudyBase *base, double out[SETTING_VALUES_MAX])
{
    const Setting *setting = &settings[id];
    double own = setting->own(base);
    int count = 0;
    for (int i = 0; i < setting->count && !isnan(own); i++) {
        double value = setting->values[i];
        if (setting->kind == SETTING_TIMES)
            value *= own;
        if (setting->kind == SETTING_TIMES && is_whole(id))
            value = fmax(1, round(value));
        if (setting->kind == SETTING_WAYS || value != own)
            out[count++] = value;
    }
    return count;
}

void setting_label(SettingId id, double value, char out[SETTING_LABEL_MAX])
{
    const char *const *words = id == SETTING_KERNEL   ? kernel_words
                               : id == SETTING_SHAPE  ? shape_words
                               : id == SETTING_METHOD ? method_words
                                                      : precision_words;
    if (settings[id].kind == SETTING_WORDS)
        snprintf(out, SETTING_LABEL_MAX, "%s", words[(int)value]);
    else if (id == SETTING_BALANCED)
        snprintf(out, SETTING_LABEL_MAX, "%.0fx samples and %.0fx photons", value, value / 2);
    else if (is_whole(id))
        snprintf(out, SETTING_LABEL_MAX, "%.0f", value);
    else
        snprintf(out, SETTING_LABEL_MAX, "%.4g", value);
}

void setting_point_own(const StudyBase *base, StudyPoint *out)
{
    *out = (StudyPoint){.setting = SETTING_OWN,
                        .label = "as it stands",
                        .how = "(the scene as it stands)",
                        .scene = *base->scene,
                        .options = *base->options,
                        .photon_cost = 1,
                        .eye_cost = 1};
}

Status setting_point(SettingId id, const StudyBase *base, double value, bool is_fine,
                     StudyPoint *out)
{
    setting_point_own(base, out);
    out->setting = (int)id;
    out->value = value;
    out->is_fine = is_fine;
    out->how[0] = 0;
    setting_label(id, value, out->label);
    if (is_fine) {
        TRY(samples_set(base, FINE_SAMPLES, out));
        say(out, " and ");
    }
    return settings[id].set(base, value, out);
}

/* Return whether a setting is tried with more samples of a pixel, too. */
static bool has_fine(SettingId id, const StudyBase *base)
{
    enum { SAMPLES_ENOUGH = 4 };
    bool is_other = id != SETTING_SAMPLES && settings[id].kind != SETTING_WAYS;
    return is_other && samples_own(base) < SAMPLES_ENOUGH;
}

static Status add_points(const StudyBase *base, bool is_fine, StudyPoint *points, int *count)
{
    double values[SETTING_VALUES_MAX];
    for (int id = 0; id < SETTING_COUNT; id++) {
        int tried = setting_values((SettingId)id, base, values);
        for (int i = 0; i < tried && (!is_fine || has_fine((SettingId)id, base)); i++)
            TRY(setting_point((SettingId)id, base, values[i], is_fine, &points[(*count)++]));
    }
    return OK;
}

Status setting_grid(const StudyBase *base, Arena *arena, StudyPoint **points, int *count)
{
    *points = ARENA_ARRAY(arena, StudyPoint, 1 + 2 * SETTING_COUNT * SETTING_VALUES_MAX);
    if (!*points)
        return ERR_MEMORY;
    setting_point_own(base, *points);
    *count = 1;
    TRY(add_points(base, false, *points, count));
    return add_points(base, true, *points, count);
}
