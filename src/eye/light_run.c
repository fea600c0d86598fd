/* Light along a ray, without shadows.  SPDX-License-Identifier: Apache-2.0 */
#include "eye/light_run.h"

enum {
    HALVINGS_MAX = 10, /* of a piece */
    CELLS_SMALL = 32,  /* more cells than these are small enough as they are */
    BREAKS_BY_ANGLE = 3,
    NEWTON_STEPS = 4
};

/* Pieces of the light are halved until the rules that sum them differ by less than this part of
 * what is known of the whole: what they are wrong by is far below that. */
#define PIECE_ERROR 1e-3f

/* Places in a part of a cell that is thinner than this are even. */
#define THIN_DEPTH 0.25

/* --- places in a cell ------------------------------------------------------------------------- */

static MediaWarp make_warp(const MediaCell *cell, double begin, double end)
{
    MediaWarp warp = {.cell = cell, .begin = begin, .length = end - begin};
    warp.x = (double)rgb_min(cell->point.extinction);
    warp.lost = warp.x * warp.length > THIN_DEPTH ? -expm1(-warp.x * warp.length) : 0;
    return warp;
}

static double warp_t(const MediaWarp *warp, double v)
{
    if (warp->lost == 0)
        return warp->begin + v * warp->length;
    return warp->begin + num_min(warp->length, -log1p(-v * warp->lost) / warp->x);
}

static double warp_v(const MediaWarp *warp, double t)
{
    double way = t - warp->begin;
    return warp->lost == 0 ? way / warp->length : -expm1(-warp->x * way) / warp->lost;
}

/* --- pieces ----------------------------------------------------------------------------------- */

static void add_piece(LightRun *run, const LightPiece *piece, Rgb light)
{
    if (run->count == LIGHT_PIECES_MAX)
        return;
    run->whole = rgb_add(run->whole, light);
    run->pieces[run->count] = *piece;
    run->pieces[run->count++].sum = run->whole;
}

/* Say what part of the whole each piece ends; returns false when there is no light at all. */
static bool finish_run(LightRun *run)
{
    double all = (double)rgb_sum(run->whole);
    for (int i = 0; i < run->count; i++)
        run->pieces[i].part = i + 1 < run->count ? (double)rgb_sum(run->pieces[i].sum) / all : 1;
    return all > 0 && isfinite(all);
}

static void set_parabola(LightPiece *piece, double first, double middle, double last)
{
    double mean = (first + 4 * middle + last) / 6, scale = mean > 0 ? 1 / mean : 0;
    piece->light[0] = mean > 0 ? num_max(0, first * scale) : 1;
    piece->light[1] = mean > 0 ? num_max(0, middle * scale) : 1;
    piece->light[2] = mean > 0 ? num_max(0, last * scale) : 1;
}

/* Light at x, from 0 to 1 in the piece, over the mean. */
static double piece_light(const LightPiece *piece, double x)
{
    const double *f = piece->light;
    return f[0] * (1 - x) * (1 - 2 * x) + 4 * f[1] * x * (1 - x) + f[2] * x * (2 * x - 1);
}

/* Share of the light that comes before x. */
static double piece_share(const LightPiece *piece, double x)
{
    const double *f = piece->light;
    double cube = 2 * (f[0] - 2 * f[1] + f[2]) / 3, square = 2 * f[1] - 1.5 * f[0] - 0.5 * f[2];
    return x * (f[0] + x * (square + x * cube));
}

/* Where a share of the light is: Newton's method, kept between 0 and 1. */
static double piece_place(const LightPiece *piece, double share)
{
    double low = 0, high = 1, x = share;
    for (int i = 0; i < NEWTON_STEPS; i++) {
        double over = piece_share(piece, x) - share, slope = piece_light(piece, x);
        if (over > 0)
            high = x;
        else
            low = x;
        double next = x - over / slope;
        x = next >= low && next <= high ? next : 0.5 * (low + high);
    }
    return x;
}

/* --- summing up ------------------------------------------------------------------------------- */

/* Light per unit of v at a place. */
static Rgb light_here(const RunSource *s, const MediaWarp *warp, double v)
{
    double t = warp_t(warp, v);
    const MediaCell *cell = warp->cell;
    const Light *light = s->light;
    LightSample sample = light_at(light, light->location, ray_at(s->ray, t));
    if (rgb_is_black(sample.color))
        return RGB_BLACK;
    V3 p = ray_at(s->ray, cell->at);
    Rgb scattered = media_scattered(s->lobes, p, v3_dot(sample.to_light, s->ray->d));
    /* What passes up to here, over the part of it that v stands for. */
    Rgb x = cell->point.extinction;
    float way = (float)(t - warp->begin), rest = warp->lost == 0 ? 0 : (float)warp->x;
    Rgb depth = rgb_mad(cell->depth, (float)(warp->begin - cell->begin), x);
    depth = rgb_add(depth, rgb((x.r - rest) * way, (x.g - rest) * way, (x.b - rest) * way));
    double measure = warp->lost == 0 ? warp->length : warp->lost / warp->x;
    return rgb_scale(rgb_mul(rgb_mul(scattered, sample.color), media_clear(depth)), (float)measure);
}

/* Sum up the light between two values of v by Simpson's rule, halving where that differs from the
 * rule of trapezes. */
static void sum_light(const RunSource *s, const MediaWarp *warp, double low, Rgb first, double high,
                      Rgb last, int halvings, LightRun *out)
{
    double middle = 0.5 * (low + high);
    Rgb between = light_here(s, warp, middle), ends = rgb_add(first, last);
    float width = (float)(high - low);
    Rgb simpson = rgb_scale(rgb_mad(ends, 4, between), width / 6);
    Rgb trapeze = rgb_scale(rgb_mad(ends, 2, between), width / 4);
    float error = rgb_sum_abs(rgb_sub(simpson, trapeze));
    float limit = fmaxf(s->enough, PIECE_ERROR * rgb_sum_abs(out->whole));
    if (error <= limit || halvings == 0 || out->count > MEDIA_CELLS_MAX) {
        LightPiece piece = {.warp = *warp, .low = low, .high = high};
        set_parabola(&piece, rgb_sum(first), rgb_sum(between), rgb_sum(last));
        add_piece(out, &piece, simpson);
        return;
    }
    sum_light(s, warp, low, first, middle, between, halvings - 1, out);
    sum_light(s, warp, middle, between, high, last, halvings - 1, out);
}

/* Places at equal steps of the angle under which the light is seen. */
static int breaks_by_angle(const Light *light, const Ray *ray, double begin, double end, double *t)
{
    double nearest = v3_dot(v3_sub(light->location, ray->o), ray->d);
    double away = v3_dist(light->location, ray_at(ray, nearest));
    away = fmax(away, 1e-6 * (fabs(nearest) + away));
    if (light_is_parallel(light) || !(away > 0))
        return 0;
    double low = atan2(begin - nearest, away), high = atan2(end - nearest, away);
    for (int i = 0; i < BREAKS_BY_ANGLE; i++)
        t[i] = nearest + away * tan(low + (high - low) * (i + 1) / (BREAKS_BY_ANGLE + 1));
    return BREAKS_BY_ANGLE;
}

/* Sum up the light of a part of a cell. */
static void add_cell(const RunSource *s, const MediaCell *cell, double begin, double end,
                     const double *breaks, int break_count, LightRun *out)
{
    if (!(end > begin) || rgb_is_black(cell->point.scattering))
        return;
    MediaWarp warp = make_warp(cell, begin, end);
    if (s->profile->count > CELLS_SMALL) {
        LightPiece piece = {.warp = warp, .low = 0, .high = 1, .light = {1, 1, 1}};
        add_piece(out, &piece, light_here(s, &warp, 0.5));
        return;
    }
    double low = 0;
    Rgb first = light_here(s, &warp, 0);
    for (int i = 0; i <= break_count; i++) {
        double high = i < break_count ? warp_v(&warp, breaks[i]) : 1;
        if (!(high > low && high <= 1))
            continue;
        Rgb last = light_here(s, &warp, high);
        sum_light(s, &warp, low, first, high, last, HALVINGS_MAX, out);
        low = high;
        first = last;
    }
}

bool light_run_sum(const RunSource *source, double begin, double end, LightRun *out)
{
    double breaks[BREAKS_BY_ANGLE];
    int count = breaks_by_angle(source->light, source->ray, begin, end, breaks);
    out->count = 0;
    out->whole = RGB_BLACK;
    for (int i = 0; i < source->profile->count; i++) {
        const MediaCell *cell = &source->profile->cells[i];
        add_cell(source, cell, num_max(begin, cell->begin), num_min(end, cell->end), breaks, count,
                 out);
    }
    return finish_run(out);
}

/* --- what is known of shadows ----------------------------------------------------------------- */

/* Where t is in a piece, from `low` to 1. */
static double piece_at(const LightPiece *piece, double t, double low)
{
    double x = (warp_v(&piece->warp, t) - piece->low) / (piece->high - piece->low);
    return num_max(low, num_min(1, x));
}

/* Add what a piece has from x = a to b, a share of its light, to a run. */
static void add_part(LightRun *run, const LightPiece *piece, double a, double b, Rgb light)
{
    double width = piece->high - piece->low;
    LightPiece part = {
        .warp = piece->warp, .low = piece->low + a * width, .high = piece->low + b * width};
    set_parabola(&part, piece_light(piece, a), piece_light(piece, 0.5 * (a + b)),
                 piece_light(piece, b));
    add_piece(run, &part, light);
}

/* Sort the light of a piece; `at` is the stretch it begins in, and then that it ends in. */
static Rgb sort_piece(const LightPiece *piece, Rgb light, const LitStretches *known, int *at,
                      LightRun *open)
{
    double end = warp_t(&piece->warp, piece->high), x = 0, share = 0, sure = 0;
    for (; x < 1; ++*at) {
        const LitStretch *cut = &known->items[*at];
        bool is_last = cut->end >= end || *at + 1 == known->count;
        double next = is_last ? 1 : piece_at(piece, cut->end, x);
        double next_share = is_last ? 1 : num_max(share, piece_share(piece, next));
        if (cut->state == LIT_SURE)
            sure += next_share - share;
        if (cut->state == LIT_UNSURE && next_share > share)
            add_part(open, piece, x, next, rgb_scale(light, (float)(next_share - share)));
        x = next;
        share = next_share;
        if (is_last)
            break;
    }
    return rgb_scale(light, (float)sure);
}

Rgb light_run_sort(const LightRun *run, const LitStretches *known, LightRun *open)
{
    Rgb sure = RGB_BLACK, before = RGB_BLACK;
    open->count = 0;
    open->whole = RGB_BLACK;
    int at = 0;
    for (int i = 0; i < run->count; i++) {
        const LightPiece *piece = &run->pieces[i];
        sure = rgb_add(sure, sort_piece(piece, rgb_sub(piece->sum, before), known, &at, open));
        before = piece->sum;
    }
    finish_run(open);
    return sure;
}

/* --- asking ----------------------------------------------------------------------------------- */

/* Return the piece in which a part of the light ends, and where in it (0 to 1). */
static const LightPiece *run_piece(const LightRun *run, double part, double *inside)
{
    int low = 0, high = run->count - 1;
    while (low < high) {
        int middle = (low + high) / 2;
        if (run->pieces[middle].part <= part)
            low = middle + 1;
        else
            high = middle;
    }
    double before = low > 0 ? run->pieces[low - 1].part : 0;
    double width = run->pieces[low].part - before;
    *inside = width > 0 ? fmin(1, (part - before) / width) : 0.5;
    return &run->pieces[low];
}

Rgb light_run_light(const LightRun *run, double part)
{
    double inside;
    const LightPiece *piece = run_piece(run, part, &inside);
    Rgb before = piece > run->pieces ? piece[-1].sum : RGB_BLACK;
    return rgb_lerp(before, piece->sum, (float)inside);
}

double light_run_t(const LightRun *run, double part)
{
    double inside;
    const LightPiece *piece = run_piece(run, part, &inside);
    double x = piece_place(piece, inside);
    return warp_t(&piece->warp, piece->low + (piece->high - piece->low) * x);
}
