/* Comparing pictures of a scene, and of the same scene moved.
 * SPDX-License-Identifier: Apache-2.0 */
#include "selftest/change.h"

#include "base/mem.h"
#include "image/srgb.h"

#include <math.h>
#include <string.h>

enum {
    CHANCE_REACH = 2, /* pixels: how far around what other seeds change counts */
    EDGE_REACH = 1    /* pixels: how far beside it an edge shows what is there */
};

/* A picture darker than this is black. */
#define LIGHT_LEAST 1e-6

/* What a display shows of light; what is no number is shown as none is. */
static float shown(float light)
{
    return isfinite(light) ? srgb_encode(fminf(fmaxf(light, 0), 1)) : -1;
}

static const float *pixels_of(const Image *image)
{
    return image_find_layer(image, "")->pixels;
}

static void show(const Image *image, float *out)
{
    size_t count = (size_t)image->width * (size_t)image->height;
    for (size_t i = 0; i < 3 * count; i++)
        out[i] = shown(pixels_of(image)[i / 3 * 4 + i % 3]);
}

static double mean_of(const float *values, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        sum += (double)values[i];
    return sum / (double)count;
}

static double rmse_of(const float *a, const float *b, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        double d = (double)a[i] - (double)b[i];
        sum += d * d;
    }
    return sqrt(sum / (double)count);
}

/* The smallest and largest value of a channel around a pixel. */
typedef struct Range {
    float low, high;
} Range;

static Range around(const float *values, const ChangeBase *base, int x, int y, int channel,
                    int reach)
{
    Range out = {INFINITY, -INFINITY};
    for (int v = y - reach; v <= y + reach; v++)
        for (int u = x - reach; u <= x + reach; u++) {
            if (u < 0 || v < 0 || u >= base->width || v >= base->height)
                continue;
            float value =
                values[3 * ((size_t)v * (size_t)base->width + (size_t)u) + (size_t)channel];
            out.low = fminf(out.low, value);
            out.high = fmaxf(out.high, value);
        }
    return out;
}

/* --- one pixel ------------------------------------------------------------------------------- */

typedef enum PixelChange { PIXEL_SAME, PIXEL_EDGE, PIXEL_ODD, PIXEL_SEEN } PixelChange;

/* Judge a pixel by its channels; *most gets its largest difference. */
static PixelChange judge(const ChangeBase *base, const float *moved, int x, int y, double *most)
{
    size_t at = 3 * ((size_t)y * (size_t)base->width + (size_t)x);
    bool is_seen = false, is_sure = false, is_edge = true;
    *most = 0;
    for (int c = 0; c < 3; c++) {
        float value = moved[at + (size_t)c];
        double off = fabs((double)value - (double)base->mean[at + (size_t)c]);
        double chance = (double)around(base->noise, base, x, y, c, CHANCE_REACH).high;
        Range beside = around(base->mean, base, x, y, c, EDGE_REACH);
        is_seen |= off > CHANGE_VISIBLE && off > CHANGE_HARDLY * chance;
        is_sure |= off > CHANGE_VISIBLE && off > CHANGE_SURELY * chance;
        is_edge &= (double)value > (double)beside.low - CHANGE_VISIBLE &&
                   (double)value < (double)beside.high + CHANGE_VISIBLE;
        *most = fmax(*most, off);
    }
    if (!is_seen)
        return PIXEL_SAME;
    return is_edge ? PIXEL_EDGE : is_sure ? PIXEL_SEEN : PIXEL_ODD;
}

/* Count what changed; *worst_x and *worst_y get the pixel that did most. */
static ChangeCounts judge_all(const ChangeBase *base, const float *moved, int *worst_x,
                              int *worst_y)
{
    ChangeCounts out = {0};
    PixelChange worst = PIXEL_SAME;
    double most = -1;
    for (int y = 0; y < base->height; y++)
        for (int x = 0; x < base->width; x++) {
            double off;
            PixelChange change = judge(base, moved, x, y, &off);
            out.seen += change != PIXEL_SAME;
            out.edges += change == PIXEL_EDGE;
            out.odd += change == PIXEL_ODD;
            if (change > worst || (change == worst && off > most)) {
                worst = change;
                most = off;
                *worst_x = x;
                *worst_y = y;
            }
        }
    return out;
}

/* --- the unmoved scene ----------------------------------------------------------------------- */

/* The display values of all seeds. */
typedef struct Shown {
    float *values; /* of one picture after the other */
    size_t count;  /* of values of a picture */
    int pictures;
} Shown;

static const float *shown_at(const Shown *shown, int picture)
{
    return shown->values + (size_t)picture * shown->count;
}

/* Set the mean and the noise of all pictures but `without` (negative: of all). */
static void fill(ChangeBase *base, const Shown *shown, int without)
{
    float used = (float)(without < 0 ? shown->pictures : shown->pictures - 1);
    for (size_t i = 0; i < shown->count; i++) {
        float sum = 0, low = INFINITY, high = -INFINITY;
        for (int k = 0; k < shown->pictures; k++) {
            float value = shown_at(shown, k)[i];
            if (k == without)
                continue;
            sum += value;
            low = fminf(low, value);
            high = fmaxf(high, value);
        }
        base->mean[i] = low < high ? sum / used : low;
        base->noise[i] = high - low;
    }
}

static size_t larger(size_t a, size_t b)
{
    return a > b ? a : b;
}

/* Judge each seed by the others. */
static void find_chance(ChangeBase *base, const Shown *shown)
{
    ChangeCounts *chance = &base->chance;
    for (int k = 0; k < shown->pictures; k++) {
        int x, y;
        fill(base, shown, k);
        ChangeCounts counts = judge_all(base, shown_at(shown, k), &x, &y);
        chance->seen = larger(chance->seen, counts.seen - counts.edges - counts.odd);
        chance->edges = larger(chance->edges, counts.edges);
        chance->odd = larger(chance->odd, counts.odd);
    }
}

static void find_light(ChangeBase *base, const Shown *shown)
{
    base->light = mean_of(shown_at(shown, 0), shown->count);
    base->seed_rmse = rmse_of(shown_at(shown, 0), shown_at(shown, 1), shown->count);
    for (int k = 1; k < shown->pictures; k++) {
        double light = mean_of(shown_at(shown, k), shown->count);
        base->light_range = fmax(base->light_range, fabs(light - base->light));
    }
}

Status change_base_init(ChangeBase *base, const Image *pictures, int count, Diag *diag)
{
    size_t values = 3 * (size_t)pictures->width * (size_t)pictures->height;
    *base = (ChangeBase){.width = pictures->width,
                         .height = pictures->height,
                         .mean = mem_array(values, sizeof(float)),
                         .noise = mem_array(values, sizeof(float)),
                         .first = pictures};
    Shown shown = {mem_array((size_t)count * values, sizeof(float)), values, count};
    Status status = base->mean && base->noise && shown.values
                        ? OK
                        : diag_no_memory(diag, "pictures to compare");
    for (int k = 0; k < count && status == OK; k++)
        show(&pictures[k], shown.values + (size_t)k * values);
    if (status == OK) {
        find_chance(base, &shown);
        find_light(base, &shown);
        fill(base, &shown, -1);
    } else {
        change_base_done(base);
    }
    mem_free(shown.values);
    return status;
}

void change_base_done(ChangeBase *base)
{
    mem_free(base->mean);
    mem_free(base->noise);
    *base = (ChangeBase){0};
}

/* --- the moved scene ------------------------------------------------------------------------- */

/* How far a pixel is off the mean. */
static double off_mean(const ChangeBase *base, const Image *image, size_t pixel)
{
    double most = 0;
    for (size_t c = 0; c < 3; c++) {
        float value = shown(pixels_of(image)[4 * pixel + c]);
        most = fmax(most, fabs((double)value - (double)base->mean[3 * pixel + c]));
    }
    return most;
}

void change_keep_less(const ChangeBase *base, Image *moved, const Image *again)
{
    float *pixels = image_find_layer(moved, "")->pixels;
    size_t count = (size_t)base->width * (size_t)base->height;
    for (size_t i = 0; i < count; i++)
        if (off_mean(base, again, i) < off_mean(base, moved, i))
            memcpy(pixels + 4 * i, pixels_of(again) + 4 * i, 4 * sizeof *pixels);
}

size_t change_bits(const Image *a, const Image *b)
{
    size_t pixels = (size_t)a->width * (size_t)a->height, count = 0;
    for (size_t i = 0; i < pixels; i++)
        count += memcmp(pixels_of(a) + 4 * i, pixels_of(b) + 4 * i, 4 * sizeof(float)) != 0;
    return count;
}

double change_largest(const Image *a, const Image *b)
{
    size_t values = 4 * (size_t)a->width * (size_t)a->height;
    double largest = 0;
    for (size_t i = 0; i < values; i++)
        largest =
            fmax(largest, fabs((double)shown(pixels_of(a)[i]) - (double)shown(pixels_of(b)[i])));
    return largest;
}

/* Find the pixel that changed most from the first picture, chance or not. */
static void find_worst(const Image *first, const Image *moved, Change *out)
{
    double most = -1;
    for (size_t i = 0; i < out->pixels; i++)
        for (size_t c = 4 * i; c < 4 * i + 3; c++) {
            double off = fabs((double)pixels_of(moved)[c] - (double)pixels_of(first)[c]);
            if (!(off <= most)) { /* no number is worst */
                most = isfinite(off) ? off : INFINITY;
                out->x = (int)(i % (size_t)first->width);
                out->y = (int)(i / (size_t)first->width);
            }
        }
}

Status change_find(const ChangeBase *base, const Image *moved, Diag *diag, Change *out)
{
    size_t pixels = (size_t)base->width * (size_t)base->height, values = 3 * pixels;
    float *still = mem_array(2 * values, sizeof *still);
    if (!still)
        return diag_no_memory(diag, "pictures to compare");
    float *now = still + values;
    double light = fmax(base->light, LIGHT_LEAST);
    show(base->first, still);
    show(moved, now);
    *out = (Change){.is_exact = out->is_exact, .pixels = pixels, .chance = base->chance};
    out->bits = change_bits(base->first, moved);
    out->largest = change_largest(base->first, moved);
    out->rmse = rmse_of(still, now, values);
    out->mean_off = fabs(mean_of(now, values) - base->light) / light;
    out->mean_allowed = CHANGE_MEAN_PART + CHANGE_MEAN_RANGES * base->light_range / light;
    out->counts = judge_all(base, now, &out->x, &out->y);
    if (out->is_exact)
        find_worst(base->first, moved, out);
    mem_free(still);
    return OK;
}

/* Are there more than a part of the pixels, and what chance has? */
static bool are_many(size_t count, size_t chance, double part, const Change *change)
{
    return (double)count > part * (double)change->pixels + CHANGE_CHANCES * (double)chance;
}

ChangeKind change_kind(const Change *change)
{
    const ChangeCounts *counts = &change->counts, *chance = &change->chance;
    if (change->bits == 0)
        return CHANGE_NONE;
    if (change->is_exact)
        return CHANGE_BITS;
    if (are_many(counts->seen - counts->edges - counts->odd, chance->seen, 0, change) ||
        are_many(counts->edges, chance->edges, CHANGE_EDGES_MOST, change) ||
        are_many(counts->odd, chance->odd, CHANGE_ODD_MOST, change) ||
        change->mean_off > change->mean_allowed)
        return CHANGE_SEEN;
    return counts->edges > 0 ? CHANGE_EDGES : CHANGE_HOLDS;
}

bool change_is_good(const Change *change)
{
    return change_kind(change) <= CHANGE_EDGES;
}
