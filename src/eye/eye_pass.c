/* The eye pass: what each thread keeps, and one sample of the film.
 * SPDX-License-Identifier: Apache-2.0 */
#include "eye/eye_int.h"

#include "base/mem.h"
#include "math/sample.h"

/* Names the random numbers of this pass. */
enum { EYE_RNG = 0x657965, PATH_RNG = 0x706174, LENS_RNG = 0x6c656e, MEDIA_RNG = 0x6d6564 };

/* --- a thread's state --------------------------------------------------------------------- */

static EyeLight eye_light(const EyeThread *eye, int index)
{
    const Plan *plan = eye->plan;
    const Light *light = &eye->scene->lights[index];
    bool has_area = light->area.size1 > 0 && light->area.size2 > 0;
    /* The plan decides, not the map: where photons were sent and none landed, the light they stand
     * for must not come straight instead.  But where no lamp has a way to a target, its shadow is
     * that of any object, as in the language. */
    bool is_refracted = plan->light_makes_caustics[index] && light->photon_refraction != TRI_OFF &&
                        plan_has(plan, FEATURE_REFRACTION);
    return (EyeLight){
        .light = light,
        .index = index,
        .has_shadow = !light->is_shadowless && plan_has(plan, FEATURE_SHADOWS),
        .is_met = plan_has(plan, FEATURE_PATH_CAUSTICS) && !light->is_shadowless &&
                  !(has_area && plan_forbids(plan, FEATURE_AREA_LIGHTS)),
        .is_area = has_area && !light->is_shadowless && plan_has(plan, FEATURE_AREA_LIGHTS),
        .has_highlights = !light->is_shadowless && plan_has(plan, FEATURE_HIGHLIGHTS),
        .makes_caustics = is_refracted && !eye->options.has_no_caustics,
        .lights_media = light->lights_media && !light->is_shadowless,
        .makes_volume = is_refracted && plan->has_volume_focus && !eye->options.has_no_focus,
    };
}

static Status make_lights(EyeThread *eye, Diag *diag)
{
    const Scene *scene = eye->scene;
    size_t cells = 0;
    eye->lights = mem_array((size_t)scene->light_count + 1, sizeof *eye->lights);
    if (!eye->lights)
        return diag_no_memory(diag, "lights");
    for (int i = 0; i < scene->light_count; i++) {
        const Light *light = &scene->lights[i];
        if (rgb_is_black(light->color))
            continue;
        EyeLight made = eye_light(eye, i);
        eye->lights[eye->light_count++] = made;
        size_t its_cells = made.is_area ? (size_t)light->area.size1 * (size_t)light->area.size2 : 0;
        if (its_cells > cells)
            cells = its_cells;
    }
    eye->grid = mem_array(cells + 1, sizeof *eye->grid);
    eye->grid_marks = mem_array(cells + 1, sizeof *eye->grid_marks);
    return eye->grid && eye->grid_marks ? OK : diag_no_memory(diag, "area lights");
}

static Status make_blur(EyeThread *eye, Diag *diag)
{
    if (!plan_has(eye->plan, FEATURE_FOCAL_BLUR))
        return OK;
    const Camera *camera = &eye->scene->camera;
    eye->blur_limits = mem_array((size_t)camera->blur_samples + 1, sizeof *eye->blur_limits);
    if (!eye->blur_limits)
        return diag_no_memory(diag, "focal blur");
    blur_limits_fill(eye->blur_limits, camera->blur_samples, camera->blur_variance,
                     camera->blur_confidence);
    return OK;
}

/* Measure a pixel in the middle of the film. */
static void set_pixel(EyeThread *eye, int width, int height)
{
    Ray a = camera_ray(&eye->camera, 0.5 * width, 0.5 * height);
    Ray b = camera_ray(&eye->camera, 0.5 * width + 1, 0.5 * height);
    eye->pixel = v3_dist(a.o, b.o);
    eye->pixel_angle = v3_dist(a.d, b.d);
}

Status eye_thread_new(const Tracer *tracer, const EyeOptions *options, Diag *diag, EyeThread **out)
{
    EyeThread *eye = mem_alloc(sizeof *eye);
    *out = NULL;
    if (!eye)
        return diag_no_memory(diag, "an eye thread");
    Status status = trace_thread_init(&eye->trace, tracer, diag);
    if (status != OK) {
        mem_free(eye);
        return status;
    }
    eye->scene = tracer_scene(tracer);
    eye->plan = tracer_plan(tracer);
    eye->has_air = plan_has_air(eye->plan);
    eye->options = *options;
    eye->eye_pass = rng_pass(options->seed, EYE_RNG);
    eye->path_pass = rng_pass(options->seed, PATH_RNG);
    eye->media_pass = rng_pass(options->seed, MEDIA_RNG);
    eye->gather = gather_scratch_new();
    if (!eye->gather)
        status = diag_no_memory(diag, "gathering photons");
    if (status == OK)
        status = make_lights(eye, diag);
    if (status == OK)
        status = make_blur(eye, diag);
    if (status != OK) {
        eye_thread_free(eye, NULL);
        return status;
    }
    const Camera *camera = &eye->scene->camera;
    camera_rays_init(&eye->camera, camera, options->width, options->height);
    eye->has_eye_point = camera->kind == CAMERA_PERSPECTIVE && !eye->blur_limits;
    set_pixel(eye, options->width, options->height);
    if (eye->has_eye_point)
        interiors_at(tracer, camera->location, &eye->camera_interiors);
    *out = eye;
    return OK;
}

void eye_thread_free(EyeThread *eye, Stats *add_to)
{
    if (!eye)
        return;
    if (add_to)
        stats_add(add_to, &eye->trace.stats);
    trace_thread_done(&eye->trace);
    gather_scratch_free(eye->gather);
    mem_free(eye->lights);
    mem_free(eye->grid);
    mem_free(eye->grid_marks);
    mem_free(eye->blur_limits);
    mem_free(eye);
}

/* --- one sample --------------------------------------------------------------------------- */

static void trace_camera_ray(EyeThread *eye, const Ray *ray, EyeSample *out)
{
    Radiance seen;
    Interiors around;
    const Interiors *inside = &eye->camera_interiors;
    *out = (EyeSample){.depth = INFINITY};
    if (!eye->has_eye_point) {
        interiors_at(eye->trace.tracer, ray->o, &around);
        inside = &around;
    }
    if (plan_has(eye->plan, FEATURE_PATHS))
        path_radiance(eye, ray, inside, &seen, out);
    else
        camera_radiance(eye, ray, inside, &seen, out);
    for (int i = 0; i < PART_COUNT; i++)
        out->part[i] = seen.part[i];
    out->alpha = 1 - seen.transmit;
}

/* Sums over the rays of focal blur. */
typedef struct Blur {
    int count;
    double part[PART_COUNT][3], alpha, albedo[3];
    double mean[3], squares[3]; /* of the whole light: mean, and squared deviations from it */
    double depth;
    V3 normal;
} Blur;

static void add_rgb(double sum[3], Rgb c)
{
    sum[0] += (double)c.r;
    sum[1] += (double)c.g;
    sum[2] += (double)c.b;
}

static void blur_add(Blur *blur, const EyeSample *ray)
{
    double whole[3] = {0};
    blur->count++;
    for (int i = 0; i < PART_COUNT; i++) {
        add_rgb(blur->part[i], ray->part[i]);
        if (i < PART_LIGHTS)
            add_rgb(whole, ray->part[i]);
    }
    for (int i = 0; i < 3; i++) {
        double delta = whole[i] - blur->mean[i];
        blur->mean[i] += delta / blur->count;
        blur->squares[i] += delta * (whole[i] - blur->mean[i]);
    }
    add_rgb(blur->albedo, ray->albedo);
    blur->alpha += (double)ray->alpha;
    blur->depth = fmin(blur->depth, ray->depth);
    blur->normal = v3_add(blur->normal, ray->normal);
}

/* Is the variance of the mean below the limit in every channel? */
static bool blur_is_done(const Blur *blur, const double *limits)
{
    int n = blur->count;
    if (n < BLUR_MIN || n % 4 != 0)
        return false;
    double worst = fmax(blur->squares[0], fmax(blur->squares[1], blur->squares[2]));
    return worst < limits[n] * (n - 1) * n;
}

static Rgb mean_rgb(const double sum[3], int count)
{
    return rgb((float)(sum[0] / count), (float)(sum[1] / count), (float)(sum[2] / count));
}

/* The standard error of a blurred sample, as its rays tell. */
static Rgb blur_noise(const Blur *blur)
{
    double n = blur->count, scale = n > 1 ? 1 / (n * (n - 1)) : 0;
    return rgb((float)sqrt(blur->squares[0] * scale), (float)sqrt(blur->squares[1] * scale),
               (float)sqrt(blur->squares[2] * scale));
}

static void blur_mean(const Blur *blur, EyeSample *out)
{
    for (int i = 0; i < PART_COUNT; i++)
        out->part[i] = mean_rgb(blur->part[i], blur->count);
    out->lens_noise = blur_noise(blur);
    out->alpha = (float)(blur->alpha / blur->count);
    out->depth = blur->depth;
    out->normal = v3_scale(blur->normal, 1.0 / blur->count);
    out->albedo = mean_rgb(blur->albedo, blur->count);
}

static void blurred_sample(EyeThread *eye, double x, double y, EyeSample *out)
{
    uint64_t place_key = rng_u64(&eye->rng), lens_key = rng_u64(&eye->rng);
    int rays = eye->scene->camera.blur_samples;
    uint32_t first = eye->path.index * (uint32_t)rays;
    Blur blur = {.depth = INFINITY};
    for (int i = 0; i < rays; i++) {
        eye->path.index = first + (uint32_t)i;
        V2 place = sample_2d((uint32_t)i, place_key);
        V2 lens = warp_disk(sample_2d((uint32_t)i, lens_key));
        Ray ray = camera_lens_ray(&eye->camera, x + place.u - 0.5, y + place.v - 0.5, lens);
        trace_camera_ray(eye, &ray, out);
        eye->trace.stats.count[STAT_BLUR_RAYS] += i > 0;
        blur_add(&blur, out);
        if (blur_is_done(&blur, eye->blur_limits))
            break;
    }
    blur_mean(&blur, out);
}

/* One ray of focal blur; those of all samples of a pixel cover the lens evenly. */
static void lens_sample(EyeThread *eye, double x, double y, uint32_t pixel, uint32_t index,
                        EyeSample *out)
{
    Rng of_pixel = rng_at(eye->options.seed, LENS_RNG, pixel);
    V2 lens = warp_disk(sample_2d(index, rng_u64(&of_pixel)));
    Ray ray = camera_lens_ray(&eye->camera, x, y, lens);
    trace_camera_ray(eye, &ray, out);
}

/* The depth alone may be infinite. */
static bool sample_is_finite(const EyeSample *s)
{
    for (int i = 0; i < PART_COUNT; i++)
        if (!rgb_is_finite(s->part[i]))
            return false;
    return isfinite(s->alpha) && !isnan(s->depth) && v3_is_finite(s->normal) &&
           rgb_is_finite(s->albedo);
}

bool eye_sample(EyeThread *eye, double x, double y, uint32_t pixel, uint32_t index, EyeSample *out)
{
    eye->rng = rng_of(eye->eye_pass, (uint64_t)pixel << 32 | index);
    Rng of_pixel = rng_of(eye->path_pass, pixel);
    eye->path.choice = rng_u64(&of_pixel);
    eye->path.bounce = rng_u64(&of_pixel);
    eye->path.wave = rng_u64(&of_pixel);
    eye->path.gather = rng_u64(&of_pixel);
    eye->path.index = index;
    eye->trace.media_rng = rng_of(eye->media_pass, (uint64_t)pixel << 32 | index);
    arena_reset(eye->trace.scratch);
    eye->trace.stats.count[STAT_SAMPLES]++;
    if (eye->blur_limits && eye->options.is_progressive) {
        lens_sample(eye, x, y, pixel, index, out);
    } else if (eye->blur_limits) {
        blurred_sample(eye, x, y, out);
    } else {
        Ray ray = camera_ray(&eye->camera, x, y);
        trace_camera_ray(eye, &ray, out);
    }
    if (!stat_rare(&eye->trace.stats, STAT_NAN_SAMPLE, !sample_is_finite(out)))
        return true;
    *out = (EyeSample){.depth = INFINITY};
    return false;
}
