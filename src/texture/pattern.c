/* Patterns: a number for every point of space.
 *
 * The order of the steps (transform, formula, frequency and phase, wave) and the constants
 * are the language's own.  SPDX-License-Identifier: Apache-2.0 */
#include "texture/texture.h"

#include "math/eps.h"

/* The wrap of frequency and phase is at 1.00001, so that a value of 1 stays the last entry
 * of a map: the language says so. */
#define WRAP 1.00001

static double fraction(double v)
{
    return v - floor(v);
}

V3 pattern_point(const Pattern *pattern, V3 p)
{
    return pattern->is_transformed ? xform_point_back(&pattern->xform, p) : p;
}

/* 0 or 1 by the parity of the unit cube. */
static double checker(V3 p)
{
    double cubes =
        floor(p.x + EPS_LANGUAGE) + floor(p.y + EPS_LANGUAGE) + floor(p.z + EPS_LANGUAGE);
    return cubes - 2 * floor(cubes * 0.5);
}

/* Negative values are wrapped later, with those that frequency and phase make. */
static double gradient(V3 direction, V3 p)
{
    double s = v3_dot(direction, p);
    return s > 1 ? fmod(s, 1) : s;
}

static double wave_shape(const Pattern *pattern, double v)
{
    switch (pattern->wave) {
    case WAVE_RAMP:
        return v;
    case WAVE_TRIANGLE:
        return 1 - fabs(1 - 2 * fraction(v));
    case WAVE_SINE:
        return (1 + sin(2 * PMS_PI * v)) * 0.5;
    case WAVE_SCALLOP:
        return fabs(sin(PMS_PI * v));
    case WAVE_CUBIC:
        return v * v * (3 - 2 * v);
    case WAVE_POLY:
        return pow(v, (double)pattern->exponent);
    }
    return v;
}

double pattern_value(const Pattern *pattern, V3 p)
{
    V3 q = pattern_point(pattern, p);
    double v = pattern->kind == PATTERN_CHECKER ? checker(q) : gradient(pattern->direction, q);
    if (pattern->frequency != 0)
        v = fmod(v * (double)pattern->frequency + (double)pattern->phase, WRAP);
    if (v < 0)
        v -= floor(v);
    return wave_shape(pattern, v);
}
