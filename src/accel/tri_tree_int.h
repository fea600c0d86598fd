/* A tree of boxes around the triangles of a small mesh.
 *
 * Embree takes a device for each index, of which a process can have about a thousand; scenes may
 * have far more small meshes than that.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_ACCEL_TRI_TREE_INT_H
#define PMS_ACCEL_TRI_TREE_INT_H

#include "accel/frame_int.h"

/* Up to this many triangles a mesh has a tree of ours. */
enum { TRI_TREE_MAX = 1 << 16 };

enum { TRI_NODE_WIDTH = 4 };

/* The boxes of up to four children, in the frame and padded: lower and upper sides, side by side so
 * that they are tested together.  A child that is missing has an empty box. */
typedef struct TriNode {
    float side[2][3][TRI_NODE_WIDTH];
    uint32_t first[TRI_NODE_WIDTH]; /* the child's node, or its place in items */
    uint32_t count[TRI_NODE_WIDTH]; /* of its items; 0: it is a node */
} TriNode;

typedef struct TriTree {
    TriNode *nodes;  /* the first is the root */
    uint32_t *items; /* triangle numbers */
    uint32_t node_count;
} TriTree;

/* Build the tree of `count` boxes of the frame.  ERR_MEMORY or OK; free with tri_tree_done. */
Status tri_tree_init(Diag *diag, const struct RTCBounds *boxes, uint32_t count, TriTree *out);
void tri_tree_done(TriTree *tree);

/* Offer each triangle whose box the ray may meet; `offer` returns the frame's new end of the
 * ray.  Near boxes come first. */
void tri_tree_walk(const TriTree *tree, const struct RTCRay *ray,
                   float (*offer)(void *query, uint32_t triangle, float far), void *query);

#endif
