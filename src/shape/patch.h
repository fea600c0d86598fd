/* Bicubic patches, cut into triangles.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SHAPE_PATCH_H
#define PMS_SHAPE_PATCH_H

#include "shape/mesh.h"

enum { PATCH_HALVINGS_MAX = 20 }; /* of both directions together: a million cells */

/* A patch: u runs along the first index of its points, v along the second. */
typedef struct Patch {
    V3 point[4][4];
    double
        flatness; /* how far the points of a part that is not halved may be from a plane; 0: none */
    int u_steps, v_steps; /* times it may be halved; >= 0 */
    V2 uv[4];             /* at (u,v) = (0,0), (0,1), (1,1), (1,0) */
} Patch;

/* Return how often a patch has to be halved in u and in v, or false: more than
 * PATCH_HALVINGS_MAX times. */
bool patch_halvings(const Patch *patch, int *u, int *v);

/* Cut a patch, halved so often, into triangles with the patch's own normals at their corners.
 *
 * Edges depend on their own points alone, whichever way they run: patches that share the points
 * of an edge, its steps and the flatness have no gap beyond rounding, and none at all where both
 * are halved as often.
 * Returns false when memory is out; *out may have no triangle (a patch without area). */
bool patch_mesh(Arena *arena, const Patch *patch, int u_halvings, int v_halvings, MeshData *out);

#endif
