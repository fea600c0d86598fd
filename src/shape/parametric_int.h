/* What the files of the parametrics share: patches, and the tree of them.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SHAPE_PARAMETRIC_INT_H
#define PMS_SHAPE_PARAMETRIC_INT_H

#include "shape/box_tree.h"
#include "shape/shape_int.h"

/* What is met up to so many times the rounding beside a patch is met in it: so nothing falls
 * between two patches. */
enum { PATCH_SLACK = 4 };

/* A rectangle of parameters. */
typedef struct Rect {
    Range u, v;
} Rect;

/* The surface over a rectangle: center + s along_u + t along_v + what spread bounds per axis, for
 * s and t from -1 to 1. */
typedef struct Patch {
    Rect rect;
    V2 middle, half; /* of the parameters */
    V3 center, along_u, along_v;
    V3 spread_u, spread_v; /* how far the derivatives differ from along_u and along_v */
    V3 doubt;              /* bound on the rounding of the surface's points */
    bool is_bounded;       /* every point has a place */
    bool is_smooth;        /* else only the box is known */
    Bound box;
} Patch;

struct ParametricData {
    FuncTriple func;
    Rect domain;
    const Shape *container;
    Bound box;            /* around all that is in the container */
    const BoxNode *nodes; /* a leaf has one patch */
    const Patch *patches;
};

/* Fill in a patch from its rectangle.  What lies outside the container is cut from its box. */
void parametric_patch(const ParametricData *data, Rect rect, Patch *out);

/* Cut a patch in two rectangles, where that helps most; false when there is no number between. */
bool parametric_halve(const Patch *patch, Rect halves[2]);

/* Build the tree; false when memory is out. */
bool parametric_tree(Arena *arena, ParametricData *data);

#endif
