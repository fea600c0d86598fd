/* Steering a series of passes: how many samples of each pixel the next ones take, such that the
 * error of the picture falls as fast as it can.
 *
 * What counts is the relative error that 95 % of the pixels are within.  So samples go where the
 * standard error, relative to the pixel's luminance, is above a level that is the same everywhere,
 * as many as bring it down to that level (error falls as the root of samples); the level is found
 * such that all samples together are as many as there is work for.  Noise that the photons of a
 * pass make is the same for all samples of a pixel in it: where it prevails, more than one sample
 * a pass would be wasted.  Nothing random is used, so that a series is the same on any number of
 * threads and however it is spread over runs.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_RENDER_STEER_H
#define PMS_RENDER_STEER_H

#include "render/error_map.h"

/* The most samples of a pixel in a pass, and when the first plan is due.  Later ones are due when
 * as many passes again are made, at the latest. */
enum { STEERING_RATE_MOST = 16, STEERING_FIRST_PLAN = 4 };

typedef struct Steering {
    size_t pixels;
    float *rate;    /* samples of each pixel in a pass, in the mean over passes */
    float *excess;  /* to plan with: samples so far times the square of the relative error */
    float *most;    /* the same: samples of a pass that still help */
    uint64_t until; /* passes in all when the next plan is due */
} Steering;

/* Make a plan of `rate` samples a pixel in every pass.  Free with steering_done. */
Status steering_init(Steering *steering, const Film *film, float rate, uint64_t until, Diag *diag);
void steering_done(Steering *steering);

/* Let every pixel have so many samples in every pass. */
void steering_even(Steering *steering, float rate);

/* What a plan is made for. */
typedef struct SteeringGoal {
    double error;         /* relative error wanted; 0: as little as there is work for */
    double shared_work;   /* of a pass, in samples of a pixel; 0: they share nothing */
    double passes_left;   /* that there is time for; infinite: no limit */
} SteeringGoal;

/* Plan the passes to come from the errors after `passes` passes. */
void steering_plan(Steering *steering, const ErrorMap *map, const FilmSum halves[2],
                   const ErrorFigure *figure, uint64_t passes, const SteeringGoal *goal);

/* Set what the pixels of a film get of pass number `pass`, counted from 0; the two passes of a pair
 * get the same.  part: of a whole pass, above 0. */
void steering_deal(const Steering *steering, uint64_t pass, double part, Film *film);

/* Return how many samples that is for all pixels. */
double steering_samples(const Steering *steering);

#endif
