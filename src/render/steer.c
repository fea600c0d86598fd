/* Steering a series of passes.  SPDX-License-Identifier: Apache-2.0 */
#include "render/steer.h"

#include "base/mem.h"
#include "image/percentile.h"

/* Samples a pass at least: what seems good enough is looked at all the same. */
#define RATE_LEAST 0.125

/* A pass has so many samples for each pixel at least. */
#define SHARE_LEAST 0.5

/* Of the standard error, the part of its square that is taken to be of photons where the light of
 * the global map is gathered; it is not known apart. */
#define HIDDEN_PHOTON_PART 0.1

/* Pixels worse than this part of them get no more samples than the last of these.  The worst, of
 * which five in a hundred do not count, could take all samples there are; and how wrong a pixel is,
 * is known by chance. */
#define WORST_PART 0.8

/* Rounds of bisection for the logarithm of the level. */
enum { LEVEL_ROUNDS = 20 };

Status steering_init(Steering *steering, const Film *film, float rate, uint64_t until, Diag *diag)
{
    size_t pixels = (size_t)film->width * (size_t)film->height;
    *steering = (Steering){.pixels = pixels, .until = until};
    steering->rate = mem_array(pixels, sizeof *steering->rate);
    steering->excess = mem_array(pixels, sizeof *steering->excess);
    steering->most = mem_array(pixels, sizeof *steering->most);
    if (!steering->rate || !steering->excess || !steering->most) {
        steering_done(steering);
        return diag_no_memory(diag, "the samples of pixels");
    }
    steering_even(steering, rate);
    return OK;
}

void steering_even(Steering *steering, float rate)
{
    for (size_t i = 0; i < steering->pixels; i++)
        steering->rate[i] = rate;
}

void steering_done(Steering *steering)
{
    mem_free(steering->rate);
    mem_free(steering->excess);
    mem_free(steering->most);
    *steering = (Steering){0};
}

/* --- the plan ------------------------------------------------------------------------------- */

typedef struct Planning {
    Steering *steering;
    const ErrorMap *map;
    const FilmSum *halves;
    double shared_work; /* of a pass, in samples of every pixel */
    double passes;      /* to come */
} Planning;

static double taken(const Planning *p, size_t i)
{
    return (double)p->halves[0].good[i] + (double)p->halves[1].good[i];
}

/* The samples of a pixel in a pass that still help.  They share its photons and records: with n of
 * them its error squared is these' part and the n-th of the rest, and its work that of these and n;
 * this n makes the most of it. */
static double rate_most(const Planning *p, size_t i)
{
    double error = (double)p->map->smooth[i], shared = (double)p->map->shared[i];
    double part = error > 0 ? shared * shared / (error * error) : 0;
    part = fmin(1, fmax(part, p->shared_work > 0 ? HIDDEN_PHOTON_PART : 0));
    double most = part > 0 ? fmax(1, sqrt((1 - part) / part * p->shared_work)) : INFINITY;
    return fmin(most, STEERING_RATE_MOST);
}

/* Find what of a pixel's rate does not depend on the level. */
static void weigh_pixels(const Planning *p)
{
    double mean = error_map_mean(p->map);
    for (size_t i = 0; i < p->steering->pixels; i++) {
        double relative = error_map_around(p->map, i, mean);
        p->steering->excess[i] = (float)(taken(p, i) * relative * relative);
        p->steering->most[i] = (float)rate_most(p, i);
    }
    float worst = (float)error_percentile(p->steering->excess, p->steering->pixels, WORST_PART);
    for (size_t i = 0; i < p->steering->pixels; i++)
        p->steering->excess[i] = fminf(p->steering->excess[i], worst);
}

/* Return the samples a pass that bring a pixel's relative standard error down to `level` in the
 * passes to come. */
static double rate_for(const Planning *p, size_t i, double level)
{
    double wanted = ((double)p->steering->excess[i] / (level * level) - taken(p, i)) / p->passes;
    return fmin(fmax(wanted, RATE_LEAST), (double)p->steering->most[i]);
}

static double samples_for(const Planning *p, double level)
{
    double sum = 0;
    for (size_t i = 0; i < p->steering->pixels; i++)
        sum += rate_for(p, i, level);
    return sum;
}

/* Return the samples of a pixel in a pass: one, but with photons about what these cost.  Where
 * those are cheap passes are rather more: then samples may gather where the error is, and share
 * none. */
static double affordable_rate(const Planning *p)
{
    double work = p->shared_work > 0 ? p->shared_work : 1;
    return fmin(STEERING_RATE_MOST, fmax(SHARE_LEAST, work));
}

/* Return the level that takes as many samples a pass. */
static double affordable_level(const Planning *p, double now)
{
    double affordable = (double)p->steering->pixels * affordable_rate(p);
    double low = now / 1024, high = now;
    for (int i = 0; i < LEVEL_ROUNDS; i++) {
        double level = sqrt(low * high);
        if (samples_for(p, level) > affordable)
            low = level;
        else
            high = level;
    }
    return high;
}

/* Return how many passes are to come before the next plan: up to as many again, fewer when the goal
 * is nearer than that; an even number. */
static uint64_t passes_ahead(const ErrorFigure *figure, uint64_t passes, const SteeringGoal *goal)
{
    double ahead = (double)passes;
    if (goal->error > 0) {
        double ratio = figure->bound / goal->error;
        ahead = fmin(ahead, (double)passes * (ratio * ratio - 1));
    }
    ahead = fmin(ahead, goal->passes_left);
    uint64_t pairs = (uint64_t)ceil(ahead / 2);
    return 2 * (pairs < 1 ? 1 : pairs);
}

void steering_plan(Steering *steering, const ErrorMap *map, const FilmSum halves[2],
                   const ErrorFigure *figure, uint64_t passes, const SteeringGoal *goal)
{
    uint64_t ahead = passes_ahead(figure, passes, goal);
    Planning p = {.steering = steering,
                  .map = map,
                  .halves = halves,
                  .shared_work = goal->shared_work / (double)steering->pixels,
                  .passes = (double)ahead};
    steering->until = passes + ahead;
    if (!(figure->noise > 0))
        return;
    weigh_pixels(&p);
    double level = affordable_level(&p, figure->noise);
    for (size_t i = 0; i < steering->pixels; i++)
        steering->rate[i] = (float)rate_for(&p, i, level);
}

/* --- dealing out ---------------------------------------------------------------------------- */

/* A number in [0, 1) that is spread evenly over any few pixels. */
static double phase_of(size_t pixel)
{
    double golden = 0.6180339887498949 * (double)(pixel % 0x1000000);
    return golden - floor(golden);
}

void steering_deal(const Steering *steering, uint64_t pass, double part, Film *film)
{
    double pair = (double)(pass / 2 % 0x1000000);
    for (size_t i = 0; i < steering->pixels; i++) {
        double rate = part * (double)steering->rate[i], phase = phase_of(i);
        double samples = floor((pair + 1) * rate + phase) - floor(pair * rate + phase);
        film->samples[i].wanted = (uint16_t)fmin(samples, UINT16_MAX);
    }
}

double steering_samples(const Steering *steering)
{
    double sum = 0;
    for (size_t i = 0; i < steering->pixels; i++)
        sum += (double)steering->rate[i];
    return sum;
}
