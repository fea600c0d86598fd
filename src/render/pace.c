/* The pace of a series of passes.  SPDX-License-Identifier: Apache-2.0 */
#include "render/pace.h"

#include <math.h>

/* Photons are cut until so many passes fit into the time, but neither to less work than the eye's
 * nor to less than this part. */
enum { PASSES_LEAST = 8 };
#define PHOTON_PART_LEAST 0.05

/* A part of a pass below this is not begun. */
#define PART_LEAST 0.05

/* What is learned of a pass replaces what was known by so much. */
#define LEARNING 0.5

static double learned(double known, double seen)
{
    return known > 0 ? known + LEARNING * (seen - known) : seen;
}

void pace_learn(Pace *pace, const double spent[PHASE_COUNT], double photon_part, double samples)
{
    double photons = spent[PHASE_PHOTON_EMIT] + spent[PHASE_PHOTON_BUILD];
    pace->photon_seconds = learned(pace->photon_seconds, photons / photon_part);
    pace->record_seconds = learned(pace->record_seconds, spent[PHASE_IRRADIANCE]);
    if (samples > 0)
        pace->sample_seconds = learned(pace->sample_seconds, spent[PHASE_EYE] / samples);
}

/* Of a pass, without its samples. */
static double shared_seconds(const Pace *pace)
{
    return pace->photon_part * pace->photon_seconds + pace->record_seconds;
}

double pace_pass_seconds(const Pace *pace, double samples)
{
    return shared_seconds(pace) + samples * pace->sample_seconds;
}

double pace_left(const Pace *pace)
{
    if (!(pace->seconds > 0))
        return INFINITY;
    return pace->started + pace->seconds - pace->ending - clock_wall();
}

void pace_fit_photons(Pace *pace, double samples)
{
    double eye = samples * pace->sample_seconds + pace->record_seconds;
    double room = pace_left(pace) / PASSES_LEAST - eye;
    double fitting = fmax(room, eye) / pace->photon_seconds;
    pace->photon_part = fitting < 1 ? fmax(PHOTON_PART_LEAST, fitting) : 1;
}

double pace_fit_samples(const Pace *pace, double samples, double passes)
{
    double room = pace_left(pace) / passes - shared_seconds(pace);
    return fmin(1, fmax(0, room / (samples * pace->sample_seconds)));
}

double pace_part(const Pace *pace, double samples)
{
    double part = pace_left(pace) / pace_pass_seconds(pace, samples);
    return part >= 1 ? 1 : part >= PART_LEAST ? part : 0;
}
