/* Sending the photons, in chunks that any thread may take and that are put together in order.
 * SPDX-License-Identifier: Apache-2.0 */
#include "photon/emission_int.h"

#include "base/mem.h"
#include "base/work.h"

#include <string.h>

enum { CHUNK_PHOTONS = 1024 };

/* Photons of less than this part of the mean power of their light are thinned out. */
#define THIN_PART (1.0f / 16)

/* Sums of flux, by what became of it. */
typedef struct FluxSum {
    double rgb[3];
} FluxSum;

typedef struct Chunk {
    Beam *beam;
    uint64_t first; /* photon of the beam */
    uint32_t count; /* rays */
    uint32_t sent;  /* photons */
    PhotonList photons;
    uint64_t ends[PATH_END_COUNT];
    FluxSum emitted, left[PATH_END_COUNT];
    FluxSum off, off2; /* what the photons' balances differ from 1 by, and the squares of that */
} Chunk;

typedef struct EmitWork {
    Emission *emission;
    bool has_books; /* what is sent counts */
    Chunk *chunks;
    size_t count;
} EmitWork;

static void flux_add(FluxSum *sum, Rgb flux)
{
    sum->rgb[0] += (double)flux.r;
    sum->rgb[1] += (double)flux.g;
    sum->rgb[2] += (double)flux.b;
}

static Rgb flux_rgb(const FluxSum *sum)
{
    return rgb((float)sum->rgb[0], (float)sum->rgb[1], (float)sum->rgb[2]);
}

static void emit_photon(Emission *emission, TraceThread *thread, Chunk *chunk, uint64_t index,
                        float least)
{
    const Beam *beam = chunk->beam;
    BeamRay ray;
    WalkResult result = {.end = PATH_CUT};
    bool is_lit = emission_ray(thread, beam, index, &ray);
    if (!is_lit && !beam->light) /* a line that met nothing that glows is no photon */
        return;
    if (is_lit) {
        Rng rng = emission_rng(emission, beam, index);
        photon_walk(thread, &emission->rules, beam, &ray, index, least, &rng, &chunk->photons,
                    &result);
    }
    chunk->sent++;
    chunk->ends[result.end]++;
    if (!rgb_is_finite(result.emitted) || !rgb_is_finite(result.left))
        return;
    flux_add(&chunk->emitted, result.emitted);
    flux_add(&chunk->left[result.end], result.left);
    if (is_lit) {
        Rgb off = rgb_sub(result.balance, RGB_WHITE);
        flux_add(&chunk->off, off);
        flux_add(&chunk->off2, rgb_mul(off, off));
    }
}

static void emit_chunk(void *ctx, size_t index, int thread)
{
    EmitWork *work = ctx;
    Emission *emission = work->emission;
    const PhotonOptions *options = emission->options;
    Chunk *chunk = &work->chunks[index];
    const LightBooks *books = &emission->books[chunk->beam->source];
    double thinned = (double)chunk->beam->budget / (double)chunk->beam->rays;
    float mean = (float)(books->power / (3 * (double)books->budget) * fmax(1, thinned));
    uint64_t *counts = emission->threads[thread].stats.count, before = counts[STAT_PHOTON_RAYS];
    for (uint32_t i = 0; i < chunk->count; i++)
        emit_photon(emission, &emission->threads[thread], chunk, chunk->first + i,
                    mean * THIN_PART);
    counts[emission_ray_counter(emission, chunk->beam)] += counts[STAT_PHOTON_RAYS] - before;
    if (thread == 0 && work->has_books && options->progress)
        options->progress(options->progress_ctx, (double)index / (double)work->count);
}

static Status make_chunks(Emission *emission, EmitWork *work)
{
    size_t count = 0;
    for (int i = 0; i < emission->beam_count; i++)
        count += (size_t)((emission->beams[i].rays + CHUNK_PHOTONS - 1) / CHUNK_PHOTONS);
    *work = (EmitWork){.emission = emission, .chunks = mem_array(count + 1, sizeof *work->chunks)};
    if (!work->chunks)
        return diag_no_memory(emission->diag, "photons");
    for (int i = 0; i < emission->beam_count; i++) {
        Beam *beam = &emission->beams[i];
        for (uint64_t first = 0; first < beam->rays; first += CHUNK_PHOTONS) {
            uint64_t rest = beam->rays - first;
            uint32_t size = rest < CHUNK_PHOTONS ? (uint32_t)rest : CHUNK_PHOTONS;
            work->chunks[work->count++] = (Chunk){.beam = beam, .first = first, .count = size};
        }
    }
    return OK;
}

static void add_rgb(Rgb *sum, const FluxSum *flux)
{
    *sum = rgb_add(*sum, flux_rgb(flux));
}

/* Add to the mean balance of the books: before they had `emitted` photons. */
static void add_balance(LightBooks *books, const Chunk *chunk)
{
    double before = (double)books->emitted, all = before + chunk->sent;
    float *mean[3] = {&books->balance.r, &books->balance.g, &books->balance.b};
    float *error[3] = {&books->balance_error.r, &books->balance_error.g, &books->balance_error.b};
    for (int c = 0; c < 3 && all > 0; c++) {
        double sum = (double)*mean[c] * before + chunk->off.rgb[c] + chunk->sent;
        *mean[c] = (float)(sum / all);
        *error[c] = (float)(hypot((double)*error[c] * before, sqrt(chunk->off2.rgb[c])) / all);
    }
}

/* What a path had less than it started with was absorbed on the way. */
static void keep_books(LightBooks *books, const Chunk *chunk)
{
    FluxSum absorbed = chunk->emitted;
    for (int end = 0; end < PATH_END_COUNT; end++)
        for (int c = 0; c < 3; c++)
            if (end != PATH_ABSORBED)
                absorbed.rgb[c] -= chunk->left[end].rgb[c];
    add_balance(books, chunk);
    books->emitted += chunk->sent;
    books->stored_paths += chunk->ends[PATH_STORED];
    books->absorbed += chunk->ends[PATH_ABSORBED];
    books->escaped += chunk->ends[PATH_ESCAPED];
    books->cut += chunk->ends[PATH_CUT];
    books->stored += chunk->photons.count;
    add_rgb(&books->flux_emitted, &chunk->emitted);
    add_rgb(&books->flux_stored, &chunk->left[PATH_STORED]);
    add_rgb(&books->flux_absorbed, &absorbed);
    add_rgb(&books->flux_escaped, &chunk->left[PATH_ESCAPED]);
    add_rgb(&books->flux_cut, &chunk->left[PATH_CUT]);
}

static Status merge_chunks(const EmitWork *work, PhotonList *out)
{
    size_t total = 0;
    bool is_short = false;
    for (size_t i = 0; i < work->count; i++) {
        total += work->chunks[i].photons.count;
        is_short |= work->chunks[i].photons.is_short;
    }
    *out = (PhotonList){.items = is_short ? NULL : mem_array(total, sizeof *out->items)};
    if (out->items && work->emission->rules.keeps_light)
        out->lights = mem_array(total, sizeof *out->lights);
    if (!out->items || (work->emission->rules.keeps_light && !out->lights))
        return diag_no_memory(work->emission->diag, "photons");
    for (size_t i = 0; i < work->count; i++) {
        Chunk *chunk = &work->chunks[i];
        photon_list_append(out, &chunk->photons);
        if (work->has_books)
            keep_books(&work->emission->books[chunk->beam->source], chunk);
    }
    out->capacity = total;
    return OK;
}

static Status run(Emission *emission, bool has_books, PhotonList *out)
{
    EmitWork work;
    *out = (PhotonList){0};
    TRY(make_chunks(emission, &work));
    work.has_books = has_books;
    Status status = work_for(emission->thread_count, work.count, emit_chunk, &work);
    if (status == OK)
        status = merge_chunks(&work, out);
    if (status != OK)
        photon_list_free(out);
    for (size_t i = 0; i < work.count; i++)
        photon_list_free(&work.chunks[i].photons);
    mem_free(work.chunks);
    return status;
}

Status emission_run(Emission *emission, PhotonList *out)
{
    return run(emission, true, out);
}

Status emission_run_places(Emission *emission, double part, PhotonList *out)
{
    emission_set_keys(emission, 1);
    emission->rules.keeps_light = false;
    for (int i = 0; i < emission->beam_count; i++) {
        Beam *beam = &emission->beams[i];
        beam->rays = (uint64_t)ceil((double)beam->rays / part);
    }
    return run(emission, false, out);
}
