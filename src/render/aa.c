/* Antialiasing.  SPDX-License-Identifier: Apache-2.0 */
#include "render/aa.h"

#include "base/mem.h"
#include "base/rng.h"
#include "math/sample.h"

#include <string.h>

/* Colours are compared as the eye sees them, roughly: this is the language's default
 * Antialias_Gamma. */
#define AA_GAMMA 2.5

/* Names the random numbers of jittered and uniform samples. */
enum { AA_JITTER_RNG = 0x61616a, AA_UNIFORM_RNG = 0x616175 };

void aa_init(Aa *aa, const Film *film, const RenderOptions *options, const SceneSettings *settings)
{
    double gamma = settings->is_gamma_off ? 1 : settings->assumed_gamma;
    int depth = options->aa_depth < 1 ? 1 : options->aa_depth > 9 ? 9 : options->aa_depth;
    *aa = (Aa){.width = film->width,
               .height = film->height,
               .channels = film->channels,
               .z_channel = film->z_channel,
               .threshold = options->aa_threshold,
               .depth = depth,
               .jitter = options->aa_has_jitter ? options->aa_jitter : 0,
               .power = (float)(gamma / AA_GAMMA),
               .seed = options->seed};
}

/* --- comparing ------------------------------------------------------------------------------ */

AaKey aa_key(const Aa *aa, const float *vector)
{
    AaKey key;
    for (int i = 0; i < 3; i++)
        key.v[i] = vector[i] > 0 ? powf(vector[i], aa->power) : 0;
    key.v[3] = vector[3];
    return key;
}

static bool differs(const Aa *aa, const AaKey *a, const AaKey *b)
{
    float sum = 0;
    for (int i = 0; i < 4; i++)
        sum += fabsf(a->v[i] - b->v[i]);
    return (double)sum >= aa->threshold;
}

/* --- averaging ------------------------------------------------------------------------------ */

typedef struct Sum {
    double v[FILM_CHANNELS_MAX];
    float nearest;
    int count;
} Sum;

static void sum_start(const Aa *aa, Sum *sum)
{
    for (int i = 0; i < aa->channels; i++)
        sum->v[i] = 0;
    sum->nearest = INFINITY;
    sum->count = 0;
}

static void sum_add(const Aa *aa, Sum *sum, const float *vector)
{
    for (int i = 0; i < aa->channels; i++)
        sum->v[i] += (double)vector[i];
    if (aa->z_channel >= 0)
        sum->nearest = fminf(sum->nearest, vector[aa->z_channel]);
    sum->count++;
}

static void sum_mean(const Aa *aa, const Sum *sum, float *out)
{
    double scale = sum->count > 0 ? 1.0 / sum->count : 0;
    for (int i = 0; i < aa->channels; i++)
        out[i] = (float)(sum->v[i] * scale);
    if (aa->z_channel >= 0)
        out[aa->z_channel] = sum->nearest;
}

/* --- scratch -------------------------------------------------------------------------------- */

/* Method 2 divides a pixel into this many cells a side at most. */
static int cells_along(const Aa *aa)
{
    return 1 << (aa->depth - 1);
}

Status aa_scratch_init(AaScratch *scratch, const Aa *aa, AaMethod method, Diag *diag)
{
    size_t channels = (size_t)aa->channels, pixels = FILM_BLOCK * FILM_BLOCK;
    bool is_complete = true;
    *scratch = (AaScratch){.block = mem_array(pixels * channels, sizeof(float))};
    if (method == AA_POV1) {
        scratch->keys = mem_array(pixels, sizeof(AaKey));
        scratch->is_refined = mem_array(pixels, sizeof(bool));
        is_complete = scratch->keys && scratch->is_refined;
    } else if (method == AA_POV2) {
        size_t corners = (FILM_BLOCK + 1) * (FILM_BLOCK + 1);
        size_t side = (size_t)cells_along(aa) + 1;
        scratch->corners = mem_array(corners * channels, sizeof(float));
        scratch->cells = mem_array(side * side * channels, sizeof(float));
        scratch->has_cell = mem_array(side * side, sizeof(bool));
        is_complete = scratch->corners && scratch->cells && scratch->has_cell;
    }
    if (scratch->block && is_complete)
        return OK;
    aa_scratch_done(scratch);
    return diag_no_memory(diag, "antialiasing");
}

void aa_scratch_done(AaScratch *scratch)
{
    mem_free(scratch->block);
    mem_free(scratch->corners);
    mem_free(scratch->cells);
    mem_free(scratch->has_cell);
    mem_free(scratch->keys);
    mem_free(scratch->is_refined);
    *scratch = (AaScratch){0};
}

/* --- one or many samples a pixel ------------------------------------------------------------ */

static uint32_t pixel_name(const Aa *aa, int x, int y)
{
    return (uint32_t)y * (uint32_t)aa->width + (uint32_t)x;
}

void aa_centers(const Aa *aa, FilmRect rect, AaSampler sampler, void *ctx, float *vectors)
{
    for (int y = rect.y1; y < rect.y2; y++)
        for (int x = rect.x1; x < rect.x2; x++) {
            sampler(ctx, x + 0.5, y + 0.5, pixel_name(aa, x, y), 0, vectors);
            vectors += aa->channels;
        }
}

/* Average `samples` of a pixel, from number `first` on; returns how many could be used. */
static int uniform_pixel(const Aa *aa, int x, int y, uint32_t first, int samples, bool is_centered,
                         AaSampler sampler, void *ctx, float *out)
{
    uint32_t pixel = pixel_name(aa, x, y);
    Rng rng = rng_at(aa->seed, AA_UNIFORM_RNG, pixel);
    uint64_t key = rng_u64(&rng);
    Sum sum;
    sum_start(aa, &sum);
    for (int i = 0; i < samples; i++) {
        uint32_t index = first + (uint32_t)i;
        V2 place = is_centered ? (V2){0.5, 0.5} : sample_2d(index, key);
        if (sampler(ctx, x + place.u, y + place.v, pixel, index, out))
            sum_add(aa, &sum, out);
    }
    sum_mean(aa, &sum, out);
    return sum.count;
}

void aa_uniform(const Aa *aa, FilmRect rect, int samples, bool is_centered, AaSampler sampler,
                void *ctx, float *vectors)
{
    for (int y = rect.y1; y < rect.y2; y++)
        for (int x = rect.x1; x < rect.x2; x++) {
            uniform_pixel(aa, x, y, 0, samples, is_centered, sampler, ctx, vectors);
            vectors += aa->channels;
        }
}

void aa_series(const Aa *aa, FilmRect rect, PixelSamples *samples, AaSampler sampler, void *ctx,
               float *vectors)
{
    for (int y = rect.y1; y < rect.y2; y++)
        for (int x = rect.x1; x < rect.x2; x++) {
            PixelSamples *of = &samples[pixel_name(aa, x, y)];
            of->good = (uint16_t)uniform_pixel(aa, x, y, of->first, of->wanted, false, sampler, ctx,
                                               vectors);
            vectors += aa->channels;
        }
}

/* --- method 1 ------------------------------------------------------------------------------- */

typedef struct Refine {
    const Aa *aa;
    FilmRect rect;
    AaSampler sampler;
    void *ctx;
    AaScratch *scratch;
} Refine;

/* Return a shift of a sample in [-amount/2, amount/2) on each axis. */
static V2 jitter_at(const Aa *aa, uint32_t pixel, uint32_t index, double amount)
{
    if (aa->jitter == 0)
        return (V2){0, 0};
    Rng rng = rng_at(aa->seed, AA_JITTER_RNG, (uint64_t)pixel << 32 | index);
    double u = rng_double(&rng) - 0.5, v = rng_double(&rng) - 0.5;
    return (V2){u * amount * aa->jitter, v * amount * aa->jitter};
}

static size_t block_index(const FilmRect *rect, int x, int y)
{
    return (size_t)(y - rect->y1) * (size_t)(rect->x2 - rect->x1) + (size_t)(x - rect->x1);
}

/* Average a pixel's centre with R x R samples spread over it, once. */
static void refine_pixel(Refine *r, int x, int y)
{
    const Aa *aa = r->aa;
    size_t at = block_index(&r->rect, x, y);
    if (r->scratch->is_refined[at])
        return;
    r->scratch->is_refined[at] = true;
    float *out = r->scratch->block + at * (size_t)aa->channels, vector[FILM_CHANNELS_MAX];
    uint32_t pixel = pixel_name(aa, x, y), index = 0;
    Sum sum;
    sum_start(aa, &sum);
    sum_add(aa, &sum, out);
    for (int j = 0; j < aa->depth; j++)
        for (int i = 0; i < aa->depth; i++) {
            V2 shift = jitter_at(aa, pixel, ++index, 1.0 / aa->depth);
            double u = (i + 0.5) / aa->depth + shift.u, v = (j + 0.5) / aa->depth + shift.v;
            if (r->sampler(r->ctx, x + u, y + v, pixel, index, vector))
                sum_add(aa, &sum, vector);
        }
    sum_mean(aa, &sum, out);
    r->scratch->keys[at] = aa_key(aa, out);
}

/* Compare one pixel with its two neighbours; refine what differs.  A neighbour outside the
 * block is only looked at. */
static void refine_at(Refine *r, int x, int y, const AaKey *above, const AaKey *left)
{
    const FilmRect *rect = &r->rect;
    const AaKey *keys = r->scratch->keys, *key = &keys[block_index(rect, x, y)];
    bool has_left = x > rect->x1, has_above = y > rect->y1;
    const AaKey *left_key = has_left ? key - 1 : left ? &left[y - rect->y1] : NULL;
    const AaKey *above_key = has_above ? key - (rect->x2 - rect->x1)
                             : above   ? &above[x - rect->x1]
                                       : NULL;
    bool is_left_edge = left_key && differs(r->aa, key, left_key);
    bool is_above_edge = above_key && differs(r->aa, key, above_key);
    if (is_left_edge && has_left)
        refine_pixel(r, x - 1, y);
    if (is_above_edge && has_above)
        refine_pixel(r, x, y - 1);
    if (is_left_edge || is_above_edge)
        refine_pixel(r, x, y);
}

void aa_refine(const Aa *aa, FilmRect rect, const AaKey *above, const AaKey *left,
               AaSampler sampler, void *ctx, AaScratch *scratch)
{
    Refine r = {aa, rect, sampler, ctx, scratch};
    size_t pixels = (size_t)(rect.x2 - rect.x1) * (size_t)(rect.y2 - rect.y1);
    for (size_t i = 0; i < pixels; i++) {
        scratch->keys[i] = aa_key(aa, scratch->block + i * (size_t)aa->channels);
        scratch->is_refined[i] = false;
    }
    for (int y = rect.y1; y < rect.y2; y++)
        for (int x = rect.x1; x < rect.x2; x++)
            refine_at(&r, x, y, above, left);
}

/* --- method 2 ------------------------------------------------------------------------------- */

typedef struct Quarter {
    const Aa *aa;
    AaSampler sampler;
    void *ctx;
    AaScratch *scratch;
    int x, y; /* the pixel */
    int side; /* cells along a pixel */
} Quarter;

static size_t cell_index(const Quarter *q, int i, int j)
{
    return (size_t)j * (size_t)(q->side + 1) + (size_t)i;
}

/* Return the vector at grid point (i, j) of the pixel, sampling it if nobody has. */
static const float *cell_at(Quarter *q, int i, int j)
{
    const Aa *aa = q->aa;
    size_t at = cell_index(q, i, j);
    float *vector = q->scratch->cells + at * (size_t)aa->channels;
    if (!q->scratch->has_cell[at]) {
        uint32_t pixel = pixel_name(aa, q->x, q->y), index = (uint32_t)at + 1;
        V2 shift = jitter_at(aa, pixel, index, 1.0 / (2 * q->side + 1));
        q->sampler(q->ctx, q->x + (double)i / q->side + shift.u,
                   q->y + (double)j / q->side + shift.v, pixel, index, vector);
        q->scratch->has_cell[at] = true;
    }
    return vector;
}

static bool any_pair_differs(const Aa *aa, const float *const v[4])
{
    AaKey keys[4];
    for (int i = 0; i < 4; i++)
        keys[i] = aa_key(aa, v[i]);
    for (int i = 0; i < 4; i++)
        for (int j = i + 1; j < 4; j++)
            if (differs(aa, &keys[i], &keys[j]))
                return true;
    return false;
}

static void mean_of_4(const Aa *aa, const float *const v[4], float *out)
{
    Sum sum;
    sum_start(aa, &sum);
    for (int i = 0; i < 4; i++)
        sum_add(aa, &sum, v[i]);
    sum_mean(aa, &sum, out);
}

/* Average the square of `size` cells at (i, j): its corners, or its quarters if those differ
 * and the level allows. */
static void quarter(Quarter *q, int i, int j, int size, float *out)
{
    const float *v[4] = {cell_at(q, i, j), cell_at(q, i + size, j), cell_at(q, i, j + size),
                         cell_at(q, i + size, j + size)};
    if (size == 1 || !any_pair_differs(q->aa, v)) {
        mean_of_4(q->aa, v, out);
        return;
    }
    float parts[4][FILM_CHANNELS_MAX];
    int half = size / 2;
    for (int k = 0; k < 4; k++) {
        quarter(q, i + (k & 1) * half, j + (k >> 1) * half, half, parts[k]);
        v[k] = parts[k];
    }
    mean_of_4(q->aa, v, out);
}

/* Sample the corners of all pixels of a block, rows of width + 1. */
static void sample_corners(const Aa *aa, FilmRect rect, AaSampler sampler, void *ctx, float *out)
{
    for (int y = rect.y1; y <= rect.y2; y++)
        for (int x = rect.x1; x <= rect.x2; x++) {
            uint32_t name = (uint32_t)y * ((uint32_t)aa->width + 1) + (uint32_t)x;
            sampler(ctx, x, y, name, 0, out);
            out += aa->channels;
        }
}

static void take_corners(Quarter *q, const FilmRect *rect)
{
    size_t across = (size_t)(rect->x2 - rect->x1) + 1, channels = (size_t)q->aa->channels;
    memset(q->scratch->has_cell, 0, cell_index(q, q->side, q->side) + 1);
    for (int k = 0; k < 4; k++) {
        int dx = k & 1, dy = k >> 1;
        size_t from = (size_t)(q->y - rect->y1 + dy) * across + (size_t)(q->x - rect->x1 + dx);
        size_t to = cell_index(q, dx * q->side, dy * q->side);
        memcpy(q->scratch->cells + to * channels, q->scratch->corners + from * channels,
               channels * sizeof(float));
        q->scratch->has_cell[to] = true;
    }
}

void aa_corners(const Aa *aa, FilmRect rect, AaSampler sampler, void *ctx, AaScratch *scratch)
{
    Quarter q = {aa, sampler, ctx, scratch, 0, 0, cells_along(aa)};
    float *out = scratch->block;
    sample_corners(aa, rect, sampler, ctx, scratch->corners);
    for (q.y = rect.y1; q.y < rect.y2; q.y++)
        for (q.x = rect.x1; q.x < rect.x2; q.x++) {
            take_corners(&q, &rect);
            quarter(&q, 0, 0, q.side, out);
            out += aa->channels;
        }
}
