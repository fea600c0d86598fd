/* Filling the irradiance cache.
 *
 * It is done in rounds over a grid of pixels that gets finer.  In a round every row of the grid is
 * a piece of work of its own: it reads the cache as it was when the round began, and what the row
 * itself has found; what is new is added in the order of the rows when the round ends.  A last
 * round looks at every pixel for what the picture would not find covered.  The picture then only
 * reads; a point that no record covers gathers for itself.  What gather rays saw near by is kept
 * the same way, in a cache of its own.  SPDX-License-Identifier: Apache-2.0 */
#include "eye/cache_fill.h"

#include "base/mem.h"
#include "base/work.h"
#include "eye/eye_int.h"

enum {
    PRETRACE_INDEX = 1 << 24, /* sample number, far from those of the picture */
    CACHE_RNG = 0x636163
};

typedef struct Round {
    const EyeOptions *options;
    EyeThread **eyes;
    FreshRecords *rows; /* of this round */
    int step;           /* of the grid, pixels */
    int first, stride;  /* rows of the grid that this round does */
    double at_x, at_y;  /* which place of a block of pixels is looked at, parts of it */
    bool is_last;       /* every pixel, for those that would have to gather for themselves */
} Round;

static void do_row(void *ctx, size_t index, int thread)
{
    Round *round = ctx;
    if (!round->rows[index].near)
        return; /* memory is out */
    EyeThread *eye = round->eyes[thread];
    int width = round->options->width, height = round->options->height, step = round->step;
    int y = (round->first + (int)index * round->stride) * step + (int)(round->at_y * step);
    y = y < height ? y : height - 1;
    eye->fresh = &round->rows[index];
    eye->fresh->is_last = round->is_last;
    for (int left = 0; left < width && !work_interrupted; left += step) {
        int x = left + (int)(round->at_x * step);
        x = x < width ? x : width - 1;
        EyeSample sample;
        eye_sample(eye, x + round->at_x, y + round->at_y,
                   (uint32_t)y * (uint32_t)width + (uint32_t)x, PRETRACE_INDEX + (uint32_t)step,
                   &sample);
    }
    eye->fresh = NULL;
}

/* Add what a row found; returns false when memory is out. */
static bool take_row(FreshRecords *row, IrradianceCaches *caches)
{
    bool is_kept = row->near && !row->is_short && irradiance_cache_join(caches->near, row->near);
    for (size_t i = 0; i < row->count && is_kept; i++)
        is_kept = irradiance_cache_add(caches->seen, &row->items[i]);
    mem_free(row->items);
    irradiance_cache_free(row->near);
    return is_kept;
}

/* Do some rows of a grid and add what they found. */
static Status do_rows(Round *round, size_t count, int threads, IrradianceCaches *caches, Diag *diag)
{
    round->rows = mem_array(count + 1, sizeof *round->rows);
    if (!round->rows)
        return diag_no_memory(diag, "the irradiance cache");
    bool is_kept = true;
    for (size_t i = 0; i < count; i++)
        round->rows[i].near = irradiance_cache_new_like(caches->near);
    Status status = work_for(threads, count, do_row, round);
    for (size_t i = 0; i < count; i++)
        is_kept = take_row(&round->rows[i], caches) && is_kept;
    mem_free(round->rows);
    return status == OK && !is_kept ? diag_no_memory(diag, "the irradiance cache") : status;
}

static int block_size(double part, const EyeOptions *options)
{
    int side = options->width > options->height ? options->width : options->height;
    double size = part * side;
    return size < 1 ? 1 : size > side ? side : (int)size;
}

/* All rounds: each grid in two, every other row of it, so that rows beside each other do not both
 * gather the same light. */
static Status do_rounds(Round *round, const CacheFilling *filling, IrradianceCaches *caches,
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
            TRY(do_rows(round, (size_t)(rows - round->first + 1) / 2, filling->threads, caches,
                        diag));
        done++;
        if (filling->progress)
            filling->progress(filling->progress_ctx, (double)done / grids);
        round->is_last = done == grids - 1;
        step = round->is_last ? 1 : step / 2 > last ? step / 2 : last;
    }
    return OK;
}

void irradiance_caches_done(IrradianceCaches *caches)
{
    irradiance_cache_free(caches->seen);
    irradiance_cache_free(caches->near);
    *caches = (IrradianceCaches){0};
}

/* Make empty caches; returns false when memory is out. */
static bool make_caches(const Tracer *tracer, double record_reach, IrradianceCaches *out)
{
    double error = tracer_scene(tracer)->settings.radiosity.error_bound * CACHE_ERROR_UNIT;
    double reach = error * record_reach;
    Bound bound = tracer_bound(tracer);
    V3 center = bound_center(bound);
    out->seen = irradiance_cache_new(center, bound_radius(bound), reach);
    out->near = irradiance_cache_new(center, bound_radius(bound), NEAR_ERROR * reach);
    return out->seen && out->near;
}

/* Count rays from the camera on that seek places as what they are: not as those of the picture. */
static void count_rays(Stats *stats)
{
    static const StatId kinds[] = {STAT_CAMERA_RAYS, STAT_REFLECTED_RAYS, STAT_REFRACTED_RAYS};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        stats->count[STAT_CACHE_RAYS] += stats->count[kinds[i]];
        stats->count[kinds[i]] = 0;
    }
    stats->count[STAT_SAMPLES] = stats->count[STAT_BLUR_RAYS] = 0;
    stats->count[STAT_BAND_RAYS] = stats->count[STAT_SKY_RAYS] = 0;
}

/* Each of many passes has its records elsewhere. */
static void move_grid(Round *round, uint64_t seed)
{
    Rng rng = rng_at(seed, CACHE_RNG, 0);
    round->at_x = rng_double(&rng);
    round->at_y = rng_double(&rng);
}

Status irradiance_cache_fill(const Tracer *tracer, const EyeOptions *options,
                             const CacheFilling *filling, Diag *diag, Stats *stats,
                             IrradianceCaches *out)
{
    *out = (IrradianceCaches){0};
    if (!plan_has(tracer_plan(tracer), FEATURE_IRRADIANCE_CACHE))
        return OK;
    EyeThread **eyes = mem_array((size_t)filling->threads, sizeof *eyes);
    Status status = eyes && make_caches(tracer, options->record_reach, out)
                        ? OK
                        : diag_no_memory(diag, "the irradiance cache");
    EyeOptions own = *options;
    own.cache = out->seen;
    own.near_cache = out->near;
    own.seed = options->is_progressive ? filling->seed : options->seed;
    int made = 0;
    for (; status == OK && made < filling->threads; made++)
        status = eye_thread_new(tracer, &own, diag, &eyes[made]);
    if (status == OK) {
        Round round = {.options = options, .eyes = eyes, .at_x = 0.5, .at_y = 0.5};
        if (options->is_progressive)
            move_grid(&round, filling->seed);
        status = do_rounds(&round, filling, out, diag);
    }
    Stats counted = {0};
    for (int i = 0; i < made; i++)
        eye_thread_free(eyes[i], &counted);
    count_rays(&counted);
    stats_add(stats, &counted);
    mem_free(eyes);
    if (status == OK)
        stats->count[STAT_CACHE_RECORDS] += irradiance_cache_count(out->seen);
    else
        irradiance_caches_done(out);
    return status;
}
