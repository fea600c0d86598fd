/* A path on its way, for path.c and path_media.c.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_EYE_PATH_INT_H
#define PMS_EYE_PATH_INT_H

#include "eye/air_int.h"

enum { ROOTS_MAX = 16 /* reflections with an exponent; more are taken to have none */ };

/* A reflection whose light is bent by an exponent once the rest of the path is known. */
typedef struct Root {
    Radiance before; /* found before it */
    Rgb weight;
    float exponent;
} Root;

/* A path on its way. */
typedef struct Path {
    Ray ray;
    RayKind kind;
    Interiors inside;
    Rgb weight;       /* of what is met from here on */
    Rgb shine;        /* of lights met: the same with the highlights of the surface the eye sees */
    float transmit;   /* the weight of a picture behind everything */
    int turns;        /* surfaces met, and places in media where it was scattered */
    int diffuse;      /* diffuse surfaces that it left, and those places */
    double length;    /* gone since it left the last of them, up to the last surface */
    bool is_mirrored; /* the background it sees is opaque */
    bool is_shadowed; /* since then it went where shadow rays do not */
    int root_count;
    Root roots[ROOTS_MAX];
} Path;

static inline void path_weigh(Path *path, Rgb factor)
{
    path->weight = rgb_mul(path->weight, factor);
    path->shine = rgb_mul(path->shine, factor);
}

static inline LightPart path_part(const Path *path)
{
    return path->diffuse == 0 ? PART_DIRECT : PART_INDIRECT;
}

/* Take the light of what lies before the next surface, `length` scene units away; returns true if
 * the path is scattered there and does not get to it. */
bool path_cross_air(EyeThread *eye, Path *path, double length, Radiance *out);

#endif
