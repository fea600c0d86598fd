/* What the files of the isosurfaces share: cells that may hold surface, and the tree of them.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SHAPE_ISO_INT_H
#define PMS_SHAPE_ISO_INT_H

#include "shape/shape_int.h"

/* A cell that may hold surface: the function less its threshold is value + slope . (p - center),
 * off by less than `off`, and has derivatives that are off `slope` by less than `spread`. */
typedef struct IsoCell {
    V3 center, slope, spread;
    double value, off;
    double doubt;   /* bound on the rounding of the function's value */
    bool is_smooth; /* else nothing of this is known */
} IsoCell;

/* A box: within the solid, outside of it, one that may hold surface, or halved. */
typedef enum IsoKind { ISO_IN, ISO_OUT, ISO_CELL, ISO_HALVED } IsoKind;

typedef struct IsoNode {
    double at;      /* where it is halved */
    uint32_t first; /* of the halves, that of lower coordinates; or the number of the cell */
    uint8_t kind, axis;
} IsoNode;

struct IsoTree {
    const IsoNode *nodes; /* nodes[0] is the container's box */
    const IsoCell *cells;
    uint32_t cell_count;
};

enum { ISO_DEPTH_MAX = 40 };

/* Build the tree; NULL when memory is out. */
const IsoTree *iso_tree_new(Arena *arena, const Func *func, double threshold, const Bound *box);

/* Return the largest slope of the function in the middle of a cell. */
double iso_tree_steepest(const IsoTree *tree, const Func *func);

#endif
