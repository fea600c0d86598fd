/* Beams: the light of one source towards one target, or of what glows; for photon/ only.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_PHOTON_BEAM_INT_H
#define PMS_PHOTON_BEAM_INT_H

#include "math/sample.h"
#include "trace/trace.h"

enum { BEAM_GUIDES = 256 };

/* Rays are drawn from the unit square: onto the cone around a ball, or the disk across it.
 * The square is divided into cells, each with a density of its own. */
typedef struct Beam {
    const Light *light; /* NULL: of an object that glows, or of the sky */
    bool is_spread;     /* its photons start anywhere on the light's area */
    int source;         /* whose books it is in: the light's number, or one after those */
    const Object *emitter; /* that glows; NULL (with no light): the sky */
    Bound box;             /* around what glows; for the sky, what it shines on */
    bool is_outside_only;  /* what the emitter's surfaces send inward comes to nothing seen */
    bool is_endless;       /* something outside of the box may stand before the sky */
    double brightness;     /* factor of what glows */
    double part_lit;       /* of its rays, those that carry light */
    const Object *target; /* NULL: the whole scene */
    V3 center;            /* of a ball around the target, scene units */
    double radius;
    double reach;          /* a target met further from the centre does not count */
    double spacing_factor; /* the target's */
    double stores;         /* photons expected to be stored for two that are sent */
    int side;              /* cells a side */
    float *cumulative;     /* of the weights of cells, row by row; side * side, ends with 1 */
    uint16_t guide[BEAM_GUIDES + 1]; /* the cell in which each part of the weight begins */
    uint64_t square_key, shift_key, area_key, choice_key, wave_key; /* of its point sequences */
    double flux;     /* onto the target, summed RGB, estimated by a pilot */
    double filled;   /* mean weight of the cells over that of the best */
    uint64_t budget; /* photons to send */
    uint64_t rays;   /* to try for it: as many, or more where some carry no light */
} Beam;

/* A ray of a beam, and how to weigh what it carries. */
typedef struct BeamRay {
    V3 location; /* of the light for this ray: its centre, or a place on its area */
    Ray ray;
    Rgb flux;       /* without a light: of a measure of 1, wherever it goes */
    double measure; /* solid angle, or area across a parallel beam, that the square stands for
                       at this place, times the inverse of the density */
} BeamRay;

/* Make the ray at a point of the square.  `area` picks the place on an area light.
 * Returns false where the light does not shine. */
bool beam_ray(const Beam *beam, V2 square, V2 area, BeamRay *out);

/* The same for a beam without a light; `choice` picks among the places where it may start. */
bool emitter_ray(TraceThread *thread, const Beam *beam, V2 square, V2 direction, double choice,
                 BeamRay *out);

/* Return the surface area of a box. */
double box_area(Bound box);

/* Return the point of the square for a uniform one, and its density. */
V2 beam_warp(const Beam *beam, V2 uniform, double *density);

/* Return whether the light can shine on the ball at all. */
bool beam_can_shine(const Beam *beam);

/* Return the flux a ray carries when it has gone `length` in all: the light it would give, had
 * the way been straight, over the area it then covers. */
Rgb beam_flux(const Beam *beam, const BeamRay *ray, double length);

/* Set the densities of beam->side squared cells from what a pilot found in each (>= 0), into
 * beam->cumulative, which is there.  Cells beside good ones count too, and none is left out. */
void beam_set_cells(Beam *beam, const float *found);

#endif
