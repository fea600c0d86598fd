/* What may be seen from one point, by direction: a short cut for rays that start or end there.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TRACE_VIEW_INDEX_H
#define PMS_TRACE_VIEW_INDEX_H

#include "math/bound.h"

#include <stdint.h>

enum {
    VIEW_CELL_MAX = 7,
    VIEW_CELL_FULL = 255,
    VIEW_SIDE = 32 /* cells along an edge of the cube of directions; a power of two */
};

/* The objects some direction may meet, nearest boxes first. */
typedef struct ViewCell {
    uint32_t count; /* VIEW_CELL_FULL: more than it holds, ask the index */
    uint32_t object[VIEW_CELL_MAX];
} ViewCell;

typedef struct ViewIndex {
    V3 from;
    float *near; /* per object: a distance at which its box cannot yet begin */
    ViewCell cells[6 * VIEW_SIDE * VIEW_SIDE];
} ViewIndex;

/* Build the index for rays from or to `from`.
 *
 * bounds, objects  `count` finite boxes and the objects they are of, ascending.
 * object_count     all object numbers are below this.
 *
 * Returns NULL when memory is out.  Free with view_index_free. */
ViewIndex *view_index_new(V3 from, const Bound *bounds, const uint32_t *objects, uint32_t count,
                          uint32_t object_count);
void view_index_free(ViewIndex *view);

static inline int view_place(double x)
{
    int i = (int)((x + 1) * (VIEW_SIDE / 2));
    return i < 0 ? 0 : i >= VIEW_SIDE ? VIEW_SIDE - 1 : i;
}

/* Return the objects that a ray leaving in direction d (not 0) may meet. */
static inline const ViewCell *view_cell(const ViewIndex *view, V3 d)
{
    double x = fabs(d.x), y = fabs(d.y), z = fabs(d.z);
    int face;
    double u, v, w;
    if (x >= y && x >= z)
        face = d.x < 0, w = x, u = d.y, v = d.z;
    else if (y >= z)
        face = 2 + (d.y < 0), w = y, u = d.z, v = d.x;
    else
        face = 4 + (d.z < 0), w = z, u = d.x, v = d.y;
    double inverse = 1 / w;
    int i = view_place(u * inverse), j = view_place(v * inverse);
    return &view->cells[(face * VIEW_SIDE + j) * VIEW_SIDE + i];
}

/* Return true if the index is exactly for p. */
static inline bool view_is_from(const ViewIndex *view, V3 p)
{
    return view->from.x == p.x && view->from.y == p.y && view->from.z == p.z;
}

#endif
