/* A tree of boxes for shapes made of many pieces, so that a line looks at few of them.
 *
 * The shapes walk it themselves, as each asks another question of a box.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SHAPE_BOX_TREE_H
#define PMS_SHAPE_BOX_TREE_H

#include "base/arena.h"
#include "math/bound.h"

#include <stdint.h>

typedef struct BoxNode {
    Bound box;      /* around all below */
    uint32_t first; /* of the items of a leaf; else the first of two nodes beside each other */
    uint32_t count; /* of items; 0: not a leaf */
} BoxNode;

typedef struct BoxTree {
    const BoxNode *nodes;  /* nodes[0] is the root */
    const uint32_t *items; /* numbers of the boxes */
} BoxTree;

enum { BOX_TREE_DEPTH_MAX = 48 }; /* of the stack a walk needs */

/* Build a tree over boxes, of which there is at least one; false when memory is out. */
bool box_tree_new(Arena *arena, const Bound *boxes, uint32_t count, BoxTree *out);

#endif
