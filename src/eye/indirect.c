/* Indirect light as the eye sees it: what the irradiance cache holds, or a gathering.
 * SPDX-License-Identifier: Apache-2.0 */
#include "eye/irradiance_cache.h"

#include "base/mem.h"
#include "eye/eye_int.h"

enum {
    ROW_LOOKBACK = 64, /* records of its own that a row looks at while the cache is filled */
    FAINT_PART = 8,    /* what hardly shows is gathered with so many times fewer rays */
    RAYS_MIN = 8
};

/* How far a record reaches at least, in pixels. */
#define PIXEL_REACH 1

static void keep_record(EyeThread *eye, const IrradianceRecord *record)
{
    FreshRecords *fresh = eye->fresh;
    void *items = fresh->items;
    if (mem_grow(&items, fresh->count, &fresh->capacity, sizeof *fresh->items) != 0) {
        fresh->is_short = true;
        return;
    }
    fresh->items = items;
    fresh->items[fresh->count++] = *record;
}

/* The largest error of a record that is used. */
static double cache_error(const EyeThread *eye)
{
    return eye->scene->settings.radiosity.error_bound * CACHE_ERROR_UNIT *
           eye->options.record_reach;
}

/* The least radius of a record.  What reaches less than a pixel would be gathered for one sample of
 * the picture alone. */
static double least_radius(const EyeThread *eye, double far)
{
    const RadiositySettings *settings = &eye->scene->settings.radiosity;
    double pixel = eye->pixel + eye->pixel_angle * far;
    double least = settings->minimum_reuse * eye->options.record_reach * far;
    return fmax(least, PIXEL_REACH * pixel / cache_error(eye));
}

/* Make a record of what was gathered at a point. */
static IrradianceRecord make_record(const EyeThread *eye, V3 p, V3 n, const GatheredLight *light)
{
    const RadiositySettings *settings = &eye->scene->settings.radiosity;
    double far = v3_dist(p, eye->scene->camera.location), least = least_radius(eye, far);
    IrradianceRecord record;
    irradiance_record_init(&record, p, n, light, eye->options.is_progressive, least,
                           fmax(least, settings->maximum_reuse * far));
    return record;
}

static LightEstimate gather_point(EyeThread *eye, const SurfaceSample *s, V3 n,
                                  const Interiors *inside, bool is_faint)
{
    int rays = eye->options.gather_rays / (is_faint ? FAINT_PART : 1);
    GatheredLight light;
    final_gather(eye, &s->at, n, inside, rays < RAYS_MIN ? RAYS_MIN : rays, &light);
    if (eye->fresh) {
        IrradianceRecord record = make_record(eye, s->at.p, n, &light);
        keep_record(eye, &record);
    }
    return (LightEstimate){.light = light.irradiance, .noise = rgb_gray(light.noise)};
}

/* Read the irradiance on the side of n from the cache; returns false if it does not hold there. */
static bool read_cache(EyeThread *eye, const SurfaceSample *s, V3 n, LightEstimate *out)
{
    const RadiositySettings *settings = &eye->scene->settings.radiosity;
    double error = cache_error(eye);
    int needed = settings->is_always_sampling ? settings->nearest_count : 1;
    if (eye->fresh && !eye->fresh->is_last) {
        error *= settings->low_error_factor;
        needed = settings->nearest_count;
    }
    CacheRead read = {.p = s->at.p, .n = n, .error = error};
    irradiance_cache_read(eye->options.cache, &read);
    if (eye->fresh) {
        size_t first = eye->fresh->count > ROW_LOOKBACK ? eye->fresh->count - ROW_LOOKBACK : 0;
        for (size_t i = first; i < eye->fresh->count; i++)
            cache_read_add(&read, &eye->fresh->items[i]);
    } else {
        eye->trace.stats.count[STAT_CACHE_READS]++;
        eye->trace.stats.count[STAT_CACHE_MISSES] += read.count < needed;
    }
    *out = (LightEstimate){.light = cache_read_irradiance(&read),
                           .noise = rgb_gray((float)cache_read_noise(&read))};
    return read.count >= needed && read.weight > 0;
}

/* The irradiance on the side of n. */
static LightEstimate irradiance_seen(EyeThread *eye, const SurfaceSample *s, V3 n,
                                     const Interiors *inside, bool is_faint)
{
    LightEstimate found;
    if (eye->options.cache && read_cache(eye, s, n, &found))
        return found;
    if (eye->options.is_progressive && !eye->fresh)
        return (LightEstimate){.light = final_gather_few(eye, &s->at, n, inside)};
    return gather_point(eye, s, n, inside, is_faint);
}

bool nearby_light_read(EyeThread *eye, V3 p, V3 n, Rgb *light)
{
    if (!eye->options.cache)
        return false;
    double error = cache_error(eye);
    CacheRead read = {.p = p, .n = n, .error = error};
    irradiance_cache_read(eye->options.cache, &read);
    if (!(read.weight > 0)) {
        read.error = NEAR_ERROR * error;
        irradiance_cache_read(eye->options.near_cache, &read);
        if (eye->fresh)
            irradiance_cache_read(eye->fresh->near, &read);
    }
    *light = cache_read_irradiance(&read);
    return read.weight > 0;
}

void nearby_light_keep(EyeThread *eye, V3 p, V3 n, const GatheredLight *light)
{
    if (!eye->fresh)
        return;
    IrradianceRecord record = make_record(eye, p, n, light);
    if (!irradiance_cache_add(eye->fresh->near, &record))
        eye->fresh->is_short = true;
}

LightEstimate gathered_light(EyeThread *eye, const SurfaceSample *s, const Interiors *inside,
                             float weight)
{
    const RadiositySettings *settings = &eye->scene->settings.radiosity;
    Rgb diffuse = surface_diffuse_even(s), back = surface_diffuse_back(s);
    LightEstimate sum = {.light = RGB_BLACK};
    bool is_faint = !eye->fresh && (double)weight < settings->adc_bailout;
    /* Without normals of a texture; towards the eye. */
    V3 n = v3_dot(s->at.ns, s->ng) < 0 ? v3_neg(s->at.ns) : s->at.ns;
    if (!rgb_is_black(diffuse)) {
        LightEstimate front = irradiance_seen(eye, s, n, inside, is_faint);
        light_estimate_add(&sum, diffuse, &front);
    }
    if (!rgb_is_black(back)) {
        LightEstimate behind = irradiance_seen(eye, s, v3_neg(n), inside, is_faint);
        light_estimate_add(&sum, back, &behind);
    }
    float gray = (float)settings->gray_threshold, brightness = (float)settings->brightness;
    sum.light = rgb_scale(rgb_lerp(sum.light, rgb_gray(rgb_grey(sum.light)), gray), brightness);
    sum.noise = rgb_scale(sum.noise, brightness);
    return sum;
}
