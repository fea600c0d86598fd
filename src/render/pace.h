/* The pace of a series of passes: what one takes, and how much of one fits into the time left.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_RENDER_PACE_H
#define PMS_RENDER_PACE_H

#include "base/stats.h"

#include <stdbool.h>

typedef struct Pace {
    double seconds;        /* for the whole render; 0: no limit */
    double started;        /* of the render, by clock_wall */
    double ending;         /* seconds that writing the picture takes */
    double photon_seconds; /* of all photons of a pass; 0: not known yet */
    double record_seconds; /* of the records of indirect light of a pass, however many photons */
    double sample_seconds; /* of one sample of the eye; 0: not known yet */
    double photon_part;    /* of the photons asked for, in each pass */
} Pace;

/* Learn from a pass that was `photon_part` of the photons and so many samples.
 *
 * spent  seconds by phase, of this pass alone. */
void pace_learn(Pace *pace, const double spent[PHASE_COUNT], double photon_part, double samples);

/* Return the seconds of a pass with so many samples. */
double pace_pass_seconds(const Pace *pace, double samples);

/* Return the seconds left for passes; infinite without a limit. */
double pace_left(const Pace *pace);

/* Choose a part of the photons such that some passes of so many samples fit into the time left. */
void pace_fit_photons(Pace *pace, double samples);

/* Return the part, at most 1, of so many samples a pass with which `passes` fit into the time
 * left. */
double pace_fit_samples(const Pace *pace, double samples, double passes);

/* Return how much of the next pass there is time for, at most 1; 0: none worth its while. */
double pace_part(const Pace *pace, double samples);

#endif
