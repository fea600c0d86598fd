/* The eye pass over the film.
 *
 * One sweep over the blocks samples every pixel; POV-Ray's method 1 needs a second sweep that
 * refines, since a block looks at the centres of its neighbours.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/tiles.h"

#include "base/mem.h"
#include "base/work.h"
#include "render/aa.h"

#include <stdatomic.h>

/* Blocks of the sweeps that need no particular size: small, so that threads end together. */
enum { SWEEP_BLOCK = 16 };

typedef struct EyePass EyePass;

/* What a sweep does with one block. */
typedef void (*BlockFn)(EyePass *pass, FilmRect rect, int thread);

/* The first sample of a thread that is no number. */
typedef struct Fault {
    bool is_found;
    double x, y;
    uint32_t pixel, index;
} Fault;

/* What one thread works with. */
typedef struct Seat {
    EyeThread *eye;
    AaScratch scratch;
    const Film *film;
    const Replay *replay;
    Fault fault;
} Seat;

struct EyePass {
    const RenderOptions *options;
    Film *film;
    Aa aa;
    Seat *seats; /* one a thread */
    int seat_count;
    int uniform_samples;    /* a pixel */
    bool is_spread_by_blur; /* focal blur spreads a sample over its pixel */
    AaKey *above, *left;    /* method 1: centres of the last row (column) of each block */
    BlockFn fn;             /* of the sweep at hand */
    int side;               /* of its blocks, pixels */
    size_t sweeps_before, sweeps;
    atomic_size_t done; /* blocks of this sweep */
    double started;     /* seconds of clock_wall */
};

/* --- blocks --------------------------------------------------------------------------------- */

static void note_fault(Fault *fault, double x, double y, uint32_t pixel, uint32_t index)
{
    if (!fault->is_found || pixel < fault->pixel || (pixel == fault->pixel && index < fault->index))
        *fault = (Fault){true, x, y, pixel, index};
}

/* Is it a sample of the pixel that is wanted?  Those at its corners are. */
static bool is_replayed(const Replay *replay, double x, double y)
{
    return x >= replay->x && x <= replay->x + 1 && y >= replay->y && y <= replay->y + 1;
}

static bool sample_film(void *ctx, double x, double y, uint32_t pixel, uint32_t index,
                        float *vector)
{
    Seat *seat = ctx;
    EyeSample sample = {.depth = INFINITY};
    bool is_watched = seat->replay && is_replayed(seat->replay, x, y);
    if (is_watched)
        eye_watch(seat->eye, &seat->replay->witness);
    /* What is left of an interrupted picture is not looked at. */
    bool is_whole = !work_interrupted;
    bool is_good = is_whole && eye_sample(seat->eye, x, y, pixel, index, &sample);
    film_vector(seat->film, &sample, vector);
    if (is_watched) {
        eye_watch(seat->eye, NULL);
        seat->replay->sample(seat->replay->witness.ctx, x, y, index, is_good ? &sample : NULL);
    }
    if (is_whole && !is_good)
        note_fault(&seat->fault, x, y, pixel, index);
    return is_good;
}

static void block_centers(EyePass *pass, FilmRect rect, int thread)
{
    Seat *seat = &pass->seats[thread];
    aa_centers(&pass->aa, rect, sample_film, seat, seat->scratch.block);
    film_store(pass->film, rect, seat->scratch.block);
}

static void block_uniform(EyePass *pass, FilmRect rect, int thread)
{
    Seat *seat = &pass->seats[thread];
    aa_uniform(&pass->aa, rect, pass->uniform_samples, pass->is_spread_by_blur, sample_film, seat,
               seat->scratch.block);
    film_store(pass->film, rect, seat->scratch.block);
}

static void block_series(EyePass *pass, FilmRect rect, int thread)
{
    Seat *seat = &pass->seats[thread];
    aa_series(&pass->aa, rect, pass->film->samples, sample_film, seat, seat->scratch.block);
    film_store(pass->film, rect, seat->scratch.block);
}

static void block_corners(EyePass *pass, FilmRect rect, int thread)
{
    Seat *seat = &pass->seats[thread];
    aa_corners(&pass->aa, rect, sample_film, seat, &seat->scratch);
    film_store(pass->film, rect, seat->scratch.block);
}

static void block_refine(EyePass *pass, FilmRect rect, int thread)
{
    Seat *seat = &pass->seats[thread];
    size_t row = (size_t)(rect.y1 / FILM_BLOCK), column = (size_t)(rect.x1 / FILM_BLOCK);
    const AaKey *above = NULL, *left = NULL;
    if (row > 0)
        above = pass->above + (row - 1) * (size_t)pass->film->width + (size_t)rect.x1;
    if (column > 0)
        left = pass->left + (column - 1) * (size_t)pass->film->height + (size_t)rect.y1;
    film_fetch(pass->film, rect, seat->scratch.block);
    aa_refine(&pass->aa, rect, above, left, sample_film, seat, &seat->scratch);
    film_store(pass->film, rect, seat->scratch.block);
}

/* --- sweeps --------------------------------------------------------------------------------- */

/* Only the calling thread reports, so the callback needs no lock. */
static void report(EyePass *pass, size_t done, size_t count)
{
    if (!pass->options->progress)
        return;
    double part = (double)done / (double)count;
    double fraction = ((double)pass->sweeps_before + part) / (double)pass->sweeps;
    if (fraction >= 1)
        fraction = 1 - 0x1p-20; /* the end is reported when it is reached */
    double spent = clock_wall() - pass->started;
    RenderProgress progress = {.phase = "eye",
                               .fraction = fraction,
                               .seconds_left = fraction > 0 ? spent / fraction - spent : -1};
    pass->options->progress(pass->options->progress_ctx, &progress);
}

/* Is the block to be done?  Where one pixel is wanted, only the one that it is in, and those whose
 * centres antialiasing compares with that. */
static bool is_block_wanted(const EyePass *pass, FilmRect rect)
{
    const Replay *replay = pass->options->replay;
    bool is_compared = pass->options->aa == AA_POV1 && pass->fn == block_centers;
    int reach = is_compared ? FILM_BLOCK : 0;
    return !replay || (replay->x >= rect.x1 - reach && replay->x < rect.x2 + reach &&
                       replay->y >= rect.y1 - reach && replay->y < rect.y2 + reach);
}

static void do_block(void *ctx, size_t index, int thread)
{
    EyePass *pass = ctx;
    FilmRect rect = film_block(pass->film, pass->side, index);
    if (is_block_wanted(pass, rect))
        pass->fn(pass, rect, thread);
    size_t done = atomic_fetch_add(&pass->done, 1) + 1;
    if (thread == 0)
        report(pass, done, film_block_count(pass->film, pass->side));
}

static Status sweep(EyePass *pass, BlockFn fn, int side)
{
    pass->fn = fn;
    pass->side = side;
    atomic_store(&pass->done, 0);
    Status status = work_for(pass->seat_count, film_block_count(pass->film, side), do_block, pass);
    pass->sweeps_before++;
    return status;
}

static AaKey pixel_key(const EyePass *pass, int x, int y)
{
    float vector[FILM_CHANNELS_MAX];
    film_fetch(pass->film, (FilmRect){x, y, x + 1, y + 1}, vector);
    return aa_key(&pass->aa, vector);
}

/* Keep what blocks show their right and lower neighbours before it is refined. */
static Status keep_borders(EyePass *pass, Diag *diag)
{
    int width = pass->film->width, height = pass->film->height;
    size_t rows = (size_t)(height - 1) / FILM_BLOCK, columns = (size_t)(width - 1) / FILM_BLOCK;
    pass->above = mem_array(rows * (size_t)width + 1, sizeof *pass->above);
    pass->left = mem_array(columns * (size_t)height + 1, sizeof *pass->left);
    if (!pass->above || !pass->left)
        return diag_no_memory(diag, "antialiasing");
    for (size_t k = 0; k < rows; k++)
        for (int x = 0; x < width; x++)
            pass->above[k * (size_t)width + (size_t)x] =
                pixel_key(pass, x, (int)(k + 1) * FILM_BLOCK - 1);
    for (size_t k = 0; k < columns; k++)
        for (int y = 0; y < height; y++)
            pass->left[k * (size_t)height + (size_t)y] =
                pixel_key(pass, (int)(k + 1) * FILM_BLOCK - 1, y);
    return OK;
}

static Status run_sweeps(EyePass *pass, Diag *diag)
{
    if (pass->film->samples)
        return sweep(pass, block_series, SWEEP_BLOCK);
    switch (pass->options->aa) {
    case AA_UNIFORM:
        return sweep(pass, block_uniform, SWEEP_BLOCK);
    case AA_POV2:
        return sweep(pass, block_corners, FILM_BLOCK);
    case AA_POV1:
        TRY(sweep(pass, block_centers, SWEEP_BLOCK));
        TRY(keep_borders(pass, diag));
        return sweep(pass, block_refine, FILM_BLOCK);
    case AA_NONE:
        break;
    }
    return sweep(pass, block_centers, SWEEP_BLOCK);
}

/* --- the pass ------------------------------------------------------------------------------- */

static Status make_seats(EyePass *pass, const Tracer *tracer, const EyeOptions *eye, Diag *diag)
{
    int threads = pass->options->threads;
    pass->seats = mem_array((size_t)threads, sizeof *pass->seats);
    if (!pass->seats)
        return diag_no_memory(diag, "threads");
    for (; pass->seat_count < threads; pass->seat_count++) {
        Seat *seat = &pass->seats[pass->seat_count];
        seat->film = pass->film;
        seat->replay = pass->options->replay;
        TRY(aa_scratch_init(&seat->scratch, &pass->aa, pass->options->aa, diag));
        Status status = eye_thread_new(tracer, eye, diag, &seat->eye);
        if (status != OK) {
            aa_scratch_done(&seat->scratch);
            return status;
        }
    }
    return OK;
}

/* Find the first of the samples that are no numbers, and where it became that. */
static void find_fault(EyePass *pass)
{
    Fault first = {.is_found = false};
    FilmFault *out = &pass->film->fault;
    *out = (FilmFault){.is_told = out->is_told};
    for (int i = 0; i < pass->seat_count; i++) {
        const Fault *fault = &pass->seats[i].fault;
        if (fault->is_found)
            note_fault(&first, fault->x, fault->y, fault->pixel, fault->index);
        out->count += eye_fault_count(pass->seats[i].eye);
    }
    if (!first.is_found)
        return;
    out->x = (int)fmin(first.x, pass->film->width - 1);
    out->y = (int)fmin(first.y, pass->film->height - 1);
    out->index = first.index;
    out->object = eye_find_fault(pass->seats[0].eye, first.x, first.y, first.pixel, first.index);
}

static void pass_done(EyePass *pass, Stats *stats)
{
    for (int i = 0; i < pass->seat_count; i++) {
        eye_thread_free(pass->seats[i].eye, stats);
        aa_scratch_done(&pass->seats[i].scratch);
    }
    mem_free(pass->seats);
    mem_free(pass->above);
    mem_free(pass->left);
}

/* With focal blur a sample is many rays already, spread over its pixel. */
static void plan_samples(EyePass *pass, const Tracer *tracer)
{
    int samples = pass->options->samples > 1 ? pass->options->samples : 1;
    if (plan_has(tracer_plan(tracer), FEATURE_FOCAL_BLUR)) {
        int rays = tracer_scene(tracer)->camera.blur_samples;
        samples = (samples + rays - 1) / rays;
        pass->is_spread_by_blur = true;
    }
    pass->uniform_samples = samples;
}

Status tiles_render(const Tracer *tracer, const RenderOptions *options, const EyeOptions *eye,
                    Diag *diag, Stats *stats, Film *film)
{
    EyePass pass = {.options = options,
                    .film = film,
                    .sweeps = options->aa == AA_POV1 && !film->samples ? 2 : 1,
                    .started = clock_wall()};
    aa_init(&pass.aa, film, options, &tracer_scene(tracer)->settings);
    plan_samples(&pass, tracer);
    Status status = make_seats(&pass, tracer, eye, diag);
    if (status == OK)
        status = run_sweeps(&pass, diag);
    if (status == OK)
        find_fault(&pass);
    pass_done(&pass, stats);
    stats->count[STAT_PIXELS] += (uint64_t)film->width * (uint64_t)film->height;
    stats->seconds[PHASE_EYE] += clock_wall() - pass.started;
    return status;
}
