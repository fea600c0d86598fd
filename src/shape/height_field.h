/* Height fields: a grid of heights, two triangles a cell, shared between instances.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SHAPE_HEIGHT_FIELD_H
#define PMS_SHAPE_HEIGHT_FIELD_H

#include "shape/shape.h"

enum {
    HEIGHT_SCALE = 65536, /* heights per unit of length */
    HEIGHT_LEVELS_MAX = 20,
    HEIGHT_POINTS_MAX = 1 << 30
};

/* The lowest and highest point of a block of cells. */
typedef struct HeightRange {
    uint16_t lo, hi;
} HeightRange;

struct HeightData {
    const uint16_t *heights; /* row z = 0 first */
    int columns, rows;       /* of points, >= 2 */
    double water;            /* what is lower is cut away, in heights */
    bool is_smooth;
    double unit;                           /* of heights in the shape's space: see height_prepare */
    int top;                               /* the level whose one block is all */
    HeightRange *level[HEIGHT_LEVELS_MAX]; /* from 2 on: blocks of 2^level cells a side */
};

/* Derive what follows from the fields before `unit`.  False when memory is out. */
bool height_prepare(Arena *arena, HeightData *data);

#endif
