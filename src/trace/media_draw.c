/* Chance along a stretch of media: where light is looked for, where it collides, which medium it
 * meets.  SPDX-License-Identifier: Apache-2.0 */
#include "trace/media_along.h"

#include "trace/trace_int.h"

static double mean(Rgb c)
{
    return ((double)c.r + (double)c.g + (double)c.b) / 3;
}

/* What passes up to a place in a cell. */
static Rgb clear_at(const MediaCell *cell, double t)
{
    return media_clear(rgb_mad(cell->depth, (float)(t - cell->begin), cell->point.extinction));
}

/* Cells that scatter less than this part of the densest count as clear. */
#define CLEAR_PART 1e-3

static double densest(const MediaProfile *profile)
{
    double most = 0;
    for (int i = 0; i < profile->count; i++)
        most = fmax(most, mean(profile->cells[i].point.scattering));
    return most;
}

/* One channel's share of the light. */
static void shares(Rgb light, double out[3])
{
    double sum = (double)rgb_sum(light);
    out[0] = sum > 0 ? (double)light.r / sum : 1.0 / 3;
    out[1] = sum > 0 ? (double)light.g / sum : 1.0 / 3;
    out[2] = sum > 0 ? (double)light.b / sum : 1.0 / 3;
}

static double channel(Rgb c, int i)
{
    return (double)(i == 0 ? c.r : i == 1 ? c.g : c.b);
}

static double weighted(Rgb c, const double share[3])
{
    return (double)c.r * share[0] + (double)c.g * share[1] + (double)c.b * share[2];
}

/* How much light of a channel gets to the places of a cell, times its length.  That the density
 * does not count keeps places as dense as light is: where they thinned out at a step of the
 * density, estimates from them would be wrong there. */
static double cell_weight(const MediaCell *cell, int c, double most)
{
    if (!(mean(cell->point.scattering) > CLEAR_PART * most))
        return 0;
    double x = channel(cell->point.extinction, c), length = cell->end - cell->begin;
    double within = x * length > 1e-4 ? -expm1(-x * length) / x : length;
    return exp(-channel(cell->depth, c)) * within;
}

static double channel_weight(const MediaProfile *profile, int c, double most)
{
    double sum = 0;
    for (int i = 0; i < profile->count; i++)
        sum += cell_weight(&profile->cells[i], c, most);
    return sum;
}

/* The place before which the part u of what a channel's light does in a cell is done. */
static double place_in_cell(const MediaCell *cell, int c, double u)
{
    double x = channel(cell->point.extinction, c), length = cell->end - cell->begin;
    double way = x * length > 1e-4 ? -log1p(u * expm1(-x * length)) / x : u * length;
    return cell->begin + fmin(way, length);
}

/* Draw by the light of one channel; `all` is its weight, above 0. */
static const MediaCell *draw_place(const MediaProfile *profile, int c, double most, double all,
                                   double u, double *t)
{
    double rest = u * all, own = 0;
    const MediaCell *cell = NULL;
    for (int i = 0; i < profile->count; i++) {
        double here = cell_weight(&profile->cells[i], c, most);
        if (!(here > 0))
            continue;
        rest -= own;
        cell = &profile->cells[i];
        own = here;
        if (rest < here)
            break;
    }
    *t = place_in_cell(cell, c, fmin(1, rest / own));
    return cell;
}

bool media_place(const MediaProfile *profile, Rgb light, double u, double *t, Rgb *weight)
{
    double share[3], part[3], all = 0, most = densest(profile);
    shares(light, share);
    for (int c = 0; c < 3; c++) {
        part[c] = share[c] > 0 ? share[c] * channel_weight(profile, c, most) : 0;
        all += part[c];
    }
    if (!(all > 0))
        return false;
    /* The channel is drawn by what it has; the chance counts for all that could have been. */
    int own = 0;
    double rest = u * all;
    while (own < 2 && !(rest < part[own]))
        rest -= part[own++];
    while (!(part[own] > 0)) /* by rounding */
        own--;
    const MediaCell *cell =
        draw_place(profile, own, most, part[own] / share[own], fmin(1, rest / part[own]), t);
    Rgb clear = clear_at(cell, *t);
    double density = weighted(clear, share) / all;
    *weight = density > 0 ? rgb_scale(clear, (float)(1 / density)) : RGB_BLACK;
    return true;
}

bool media_collide(const MediaProfile *profile, Rgb light, Rng *rng, double *t, Rgb *weight,
                   const MediaCell **cell)
{
    double share[3], pick = rng_double(rng);
    shares(light, share);
    int own = pick < share[0] ? 0 : pick < share[0] + share[1] ? 1 : 2;
    double depth = -log1p(-rng_double(rng));
    /* The channel that was picked collides where its depth is that; the chance counts for all
     * channels that could have been. */
    for (int i = 0; i < profile->count; i++) {
        const MediaCell *c = &profile->cells[i];
        double x = channel(c->point.extinction, own), before = channel(c->depth, own);
        double way = x > 0 ? (depth - before) / x : INFINITY;
        if (!(way < c->end - c->begin))
            continue;
        *t = c->begin + fmax(0, way);
        Rgb clear = clear_at(c, *t);
        double density = weighted(rgb_mul(clear, c->point.extinction), share);
        *weight = rgb_scale(clear, (float)(1 / density));
        *cell = c;
        return true;
    }
    Rgb clear = media_clear(profile->depth);
    double chance = weighted(clear, share);
    *weight = chance > 0 ? rgb_scale(clear, (float)(1 / chance)) : RGB_BLACK;
    return false;
}

Rgb medium_kept(const Medium *medium, V3 p)
{
    return rgb_mul(medium_density(medium, p), rgb_scale(medium->scattering, medium->extinction));
}

const Medium *media_choose(const MediaHere *here, V3 p, Rgb light,
                           Rgb (*share)(const Medium *medium, V3 p), Rng *rng, Rgb *weight)
{
    double all = 0;
    for (int l = 0; l < here->list_count; l++)
        for (int i = 0; i < here->lists[l].count; i++)
            all += (double)rgb_sum(rgb_mul(share(here->lists[l].media[i], p), light));
    double rest = rng_double(rng) * all;
    const Medium *chosen = NULL;
    double chance = 0;
    for (int l = 0; l < here->list_count && rest >= 0; l++)
        for (int i = 0; i < here->lists[l].count && rest >= 0; i++) {
            const Medium *medium = here->lists[l].media[i];
            double own = (double)rgb_sum(rgb_mul(share(medium, p), light));
            if (!(own > 0))
                continue;
            chosen = medium;
            chance = own / all;
            rest -= own;
        }
    if (chosen)
        *weight = rgb_scale(share(chosen, p), (float)(1 / chance));
    return chosen;
}
