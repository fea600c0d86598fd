/* Indirect light as the eye sees it.
 *
 * The cache is filled in rounds over a grid of pixels that gets finer.  In a round every row of
 * the grid is a piece of work of its own: it reads the cache as it was when the round began, and
 * what the row itself has found; what is new is added in the order of the rows when the round
 * ends.  A last round looks at every pixel for what the picture would not find covered.  The
 * picture then only reads; a point that no record covers gathers for itself.
 * SPDX-License-Identifier: Apache-2.0 */
#include "eye/indirect.h"

#include "base/mem.h"
#include "base/work.h"

/* error_bound is in units in which the language's default gives a good picture; so much of it is
 * the error bound here. */
#define ERROR_UNIT 0.25

enum {
    ROW_LOOKBACK = 64, /* records of its own that a row looks at */
    FAINT_PART = 8,    /* what hardly shows is gathered with so many times fewer rays */
    RAYS_MIN = 8,
    PRETRACE_INDEX = 1 << 24 /* sample number, far from those of the picture */
};

/* --- one point ----------------------------------------------------------------------------------
 */

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

static Rgb gather_point(EyeThread *eye, const SurfaceSample *s, V3 n, const Interiors *inside,
                        bool is_faint)
{
    const RadiositySettings *settings = &eye->scene->settings.radiosity;
    int rays = is_faint ? settings->count / FAINT_PART : settings->count;
    GatheredLight light;
    final_gather(eye, &s->at, n, inside, rays < RAYS_MIN ? RAYS_MIN : rays, &light);
    if (eye->fresh) {
        double far = v3_dist(s->at.p, eye->scene->camera.location);
        IrradianceRecord record;
        irradiance_record_init(&record, s->at.p, n, &light, settings->minimum_reuse * far,
                               settings->maximum_reuse * far);
        keep_record(eye, &record);
    }
    return light.irradiance;
}

/* The irradiance on the side of n. */
static Rgb irradiance_seen(EyeThread *eye, const SurfaceSample *s, V3 n, const Interiors *inside,
                           bool is_faint)
{
    const RadiositySettings *settings = &eye->scene->settings.radiosity;
    if (eye->options.is_progressive)
        return final_gather_few(eye, &s->at, n, inside);
    if (!eye->options.cache)
        return gather_point(eye, s, n, inside, is_faint);
    double error = settings->error_bound * ERROR_UNIT;
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
    if (read.count >= needed && read.weight > 0)
        return cache_read_irradiance(&read);
    return gather_point(eye, s, n, inside, is_faint);
}

Rgb gathered_light(EyeThread *eye, const SurfaceSample *s, const Interiors *inside, float weight)
{
    const RadiositySettings *settings = &eye->scene->settings.radiosity;
    Rgb diffuse = surface_diffuse_even(s), back = surface_diffuse_back(s), light = RGB_BLACK;
    bool is_faint = !eye->fresh && (double)weight < settings->adc_bailout;
    /* Without normals of a texture; towards the eye. */
    V3 n = v3_dot(s->at.ns, s->ng) < 0 ? v3_neg(s->at.ns) : s->at.ns;
    if (!rgb_is_black(diffuse))
        light = rgb_mul(diffuse, irradiance_seen(eye, s, n, inside, is_faint));
    if (!rgb_is_black(back))
        light = rgb_add(light, rgb_mul(back, irradiance_seen(eye, s, v3_neg(n), inside, is_faint)));
    float gray = (float)settings->gray_threshold;
    return rgb_scale(rgb_lerp(light, rgb_gray(rgb_grey(light)), gray), (float)settings->brightness);
}

/* --- the rounds ----------------------------------------------------------------------------------
 */

typedef struct Round {
    const EyeOptions *options;
    EyeThread **eyes;
    FreshRecords *rows; /* of this round */
    int step;           /* of the grid, pixels */
    int first, stride;  /* rows of the grid that this round does */
    bool is_last;       /* every pixel, for those that would have to gather for themselves */
} Round;

static void do_row(void *ctx, size_t index, int thread)
{
    Round *round = ctx;
    EyeThread *eye = round->eyes[thread];
    int width = round->options->width, height = round->options->height, step = round->step;
    int y = (round->first + (int)index * round->stride) * step + step / 2;
    y = y < height ? y : height - 1;
    eye->fresh = &round->rows[index];
    eye->fresh->is_last = round->is_last;
    for (int left = 0; left < width && !work_interrupted; left += step) {
        int x = left + step / 2 < width ? left + step / 2 : width - 1;
        EyeSample sample;
        eye_sample(eye, x + 0.5, y + 0.5, (uint32_t)y * (uint32_t)width + (uint32_t)x,
                   PRETRACE_INDEX + (uint32_t)step, &sample);
    }
    eye->fresh = NULL;
}

/* Do some rows of a grid and add what they found. */
static Status do_rows(Round *round, size_t count, int threads, IrradianceCache *cache, Diag *diag)
{
    round->rows = mem_array(count + 1, sizeof *round->rows);
    if (!round->rows)
        return diag_no_memory(diag, "the irradiance cache");
    Status status = work_for(threads, count, do_row, round);
    for (size_t i = 0; i < count; i++) {
        FreshRecords *row = &round->rows[i];
        if (row->is_short && status == OK)
            status = diag_no_memory(diag, "the irradiance cache");
        for (size_t k = 0; k < row->count && status == OK; k++)
            status = irradiance_cache_add(cache, &row->items[k], diag);
        mem_free(row->items);
    }
    mem_free(round->rows);
    return status;
}

static int block_size(double part, const EyeOptions *options)
{
    int side = options->width > options->height ? options->width : options->height;
    double size = part * side;
    return size < 1 ? 1 : size > side ? side : (int)size;
}

/* All rounds: each grid in two, every other row of it, so that rows beside each other do not both
 * gather the same light. */
static Status do_rounds(Round *round, const CacheFilling *filling, IrradianceCache *cache,
                        Diag *diag)
{
    const RadiositySettings *settings =
        &tracer_scene(round->eyes[0]->trace.tracer)->settings.radiosity;
    int last = block_size(settings->pretrace_end, round->options);
    int step = block_size(settings->pretrace_start, round->options), grids = 2, done = 0;
    for (int s = step; s > last; s /= 2)
        grids++;
    while (done < grids) {
        int rows = (round->options->height + step - 1) / step;
        round->step = step;
        round->stride = 2;
        for (round->first = 0; round->first < 2 && round->first < rows; round->first++)
            TRY(do_rows(round, (size_t)(rows - round->first + 1) / 2, filling->threads, cache,
                        diag));
        done++;
        if (filling->progress)
            filling->progress(filling->progress_ctx, (double)done / grids);
        round->is_last = done == grids - 1;
        step = round->is_last ? 1 : step / 2 > last ? step / 2 : last;
    }
    return OK;
}

Status indirect_cache_fill(const Tracer *tracer, const EyeOptions *options,
                           const CacheFilling *filling, Diag *diag, Stats *stats,
                           IrradianceCache **out)
{
    *out = NULL;
    if (!plan_has(tracer_plan(tracer), FEATURE_IRRADIANCE_CACHE))
        return OK;
    double reach = tracer_scene(tracer)->settings.radiosity.error_bound * ERROR_UNIT;
    IrradianceCache *cache = irradiance_cache_new(bound_center(tracer_bound(tracer)), reach);
    EyeThread **eyes = mem_array((size_t)filling->threads, sizeof *eyes);
    Status status = cache && eyes ? OK : diag_no_memory(diag, "the irradiance cache");
    EyeOptions own = *options;
    own.cache = cache;
    int made = 0;
    for (; status == OK && made < filling->threads; made++)
        status = eye_thread_new(tracer, &own, diag, &eyes[made]);
    if (status == OK) {
        Round round = {.options = options, .eyes = eyes};
        status = do_rounds(&round, filling, cache, diag);
    }
    for (int i = 0; i < made; i++)
        eye_thread_free(eyes[i], stats);
    mem_free(eyes);
    if (status == OK) {
        stats->count[STAT_CACHE_RECORDS] += irradiance_cache_count(cache);
        *out = cache;
    } else {
        irradiance_cache_free(cache);
    }
    return status;
}
