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

/* The weight of a cell: how much light gets to its places, in the mean of the channels.  That the
 * density does not count keeps places as dense as light is: where they thinned out at a step of the
 * density, estimates from them would be wrong there. */
static double cell_weight(const MediaCell *cell, double most)
{
    double scattering = mean(cell->point.scattering);
    if (!(scattering > CLEAR_PART * most))
        return 0;
    double x = mean(cell->point.extinction), length = cell->end - cell->begin;
    double within = x * length > 1e-4 ? -expm1(-x * length) / x : length;
    return exp(-mean(cell->depth)) * within;
}

/* The place in a cell before which the part u of what it lets through is lost. */
static double place_in_cell(const MediaCell *cell, double u)
{
    double x = mean(cell->point.extinction), length = cell->end - cell->begin;
    double way = x * length > 1e-4 ? -log1p(u * expm1(-x * length)) / x : u * length;
    return cell->begin + fmin(way, length);
}

bool media_place(const MediaProfile *profile, double u, double *t, Rgb *weight)
{
    double all = 0, most = densest(profile);
    for (int i = 0; i < profile->count; i++)
        all += cell_weight(&profile->cells[i], most);
    if (!(all > 0))
        return false;
    double rest = u * all, own = 0;
    const MediaCell *cell = NULL;
    for (int i = 0; i < profile->count; i++) {
        double here = cell_weight(&profile->cells[i], most);
        if (!(here > 0))
            continue;
        rest -= own;
        cell = &profile->cells[i];
        own = here;
        if (rest < here)
            break;
    }
    *t = place_in_cell(cell, fmin(1, rest / own));
    double way = *t - cell->begin;
    double density = exp(-mean(cell->depth) - mean(cell->point.extinction) * way) / all;
    *weight = rgb_scale(clear_at(cell, *t), (float)(1 / density));
    return true;
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
