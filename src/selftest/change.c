/* Comparing pictures of a scene and of the same scene moved.  SPDX-License-Identifier: Apache-2.0
 */
#include "selftest/change.h"

#include "base/mem.h"
#include "image/srgb.h"

#include <math.h>
#include <string.h>

enum {
    CHANCE_REACH = 2, /* pixels: how far around what other seeds change counts */
    EDGE_REACH = 1    /* pixels: how far beside it an edge shows what is there */
};

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

/* --- the unmoved scene ----------------------------------------------------------------------- */

/* Add a picture to the mean, the means of light, and what is furthest from the first. */
static void take(ChangeBase *base, const float *picture, size_t count, int pictures)
{
    for (size_t i = 0; i < count; i++) {
        base->mean[i] += picture[i] / (float)pictures;
        base->noise[i] = fmaxf(base->noise[i], fabsf(picture[i] - base->still[i]));
    }
    double light = mean_of(picture, count);
    base->light_range = fmax(base->light_range, fabs(light - base->light));
}

static float *room_for(size_t count)
{
    return mem_array(count, sizeof(float));
}

Status change_base_init(ChangeBase *base, const Image *pictures, int count, Diag *diag)
{
    int width = pictures->width, height = pictures->height;
    size_t values = 3 * (size_t)width * (size_t)height;
    float *other = room_for(values);
    *base = (ChangeBase){.width = width,
                         .height = height,
                         .still = room_for(values),
                         .mean = room_for(values),
                         .noise = room_for(values),
                         .bits = pixels_of(pictures)};
    if (!other || !base->still || !base->mean || !base->noise) {
        mem_free(other);
        change_base_done(base);
        return diag_no_memory(diag, "pictures to compare");
    }
    show(pictures, base->still);
    memset(base->mean, 0, values * sizeof *base->mean);
    memset(base->noise, 0, values * sizeof *base->noise);
    base->light = mean_of(base->still, values);
    for (int i = 0; i < count; i++) {
        show(&pictures[i], other);
        take(base, other, values, count);
        if (i == 1)
            base->seed_rmse = rmse_of(other, base->still, values);
    }
    mem_free(other);
    return OK;
}

void change_base_done(ChangeBase *base)
{
    mem_free(base->still);
    mem_free(base->mean);
    mem_free(base->noise);
    *base = (ChangeBase){0};
}

/* --- the moved scene ------------------------------------------------------------------------- */

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

/* Count what changed; the worst pixel is one of those that changed most. */
static void judge_all(const ChangeBase *base, const float *moved, Change *out)
{
    PixelChange worst = PIXEL_SAME;
    double most = -1;
    for (int y = 0; y < base->height; y++)
        for (int x = 0; x < base->width; x++) {
            double off;
            PixelChange change = judge(base, moved, x, y, &off);
            out->seen += change != PIXEL_SAME;
            out->edges += change == PIXEL_EDGE;
            out->odd += change == PIXEL_ODD;
            if (change > worst || (change == worst && off > most)) {
                worst = change;
                most = off;
                out->x = x;
                out->y = y;
            }
        }
}

Status change_find(const ChangeBase *base, const Image *moved, Diag *diag, Change *out)
{
    size_t pixels = (size_t)base->width * (size_t)base->height;
    float *values = room_for(3 * pixels);
    if (!values)
        return diag_no_memory(diag, "pictures to compare");
    *out = (Change){.is_exact = out->is_exact, .pixels = pixels};
    show(moved, values);
    for (size_t i = 0; i < pixels; i++)
        out->bits += memcmp(pixels_of(moved) + 4 * i, base->bits + 4 * i, 4 * sizeof(float)) != 0;
    for (size_t i = 0; i < 3 * pixels; i++)
        out->largest = fmax(out->largest, fabs((double)values[i] - (double)base->still[i]));
    out->rmse = rmse_of(values, base->still, 3 * pixels);
    out->mean_off = fabs(mean_of(values, 3 * pixels) - base->light) / fmax(base->light, 1e-6);
    out->mean_allowed =
        CHANGE_MEAN_PART + CHANGE_MEAN_RANGES * base->light_range / fmax(base->light, 1e-6);
    judge_all(base, values, out);
    mem_free(values);
    return OK;
}

ChangeKind change_kind(const Change *change)
{
    if (change->bits == 0)
        return CHANGE_NONE;
    if (change->is_exact)
        return CHANGE_BITS;
    double pixels = (double)change->pixels;
    if (change->seen > change->edges + change->odd ||
        (double)change->edges > CHANGE_EDGES_MOST * pixels ||
        (double)change->odd > CHANGE_ODD_MOST * pixels || change->mean_off > change->mean_allowed)
        return CHANGE_SEEN;
    return change->edges > 0 ? CHANGE_EDGES : CHANGE_HOLDS;
}

bool change_is_good(const Change *change)
{
    return change_kind(change) <= CHANGE_EDGES;
}
