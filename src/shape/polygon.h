/* Polygons: flat loops of points, filled even-odd, shared between instances.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SHAPE_POLYGON_H
#define PMS_SHAPE_POLYGON_H

#include "shape/shape.h"

/* An edge in the polygon's plane. */
typedef struct PolygonEdge {
    V2 from, to;
    double length;
} PolygonEdge;

struct PolygonData {
    V3 *points;       /* those that close a loop left out */
    uint32_t *next;   /* of each point, the other end of its edge */
    uint32_t count;
    V3 origin;        /* of the plane; the first point */
    V3 u, v, normal;  /* unit, square to each other */
    double offset;    /* of the point furthest off the plane */
    double pad;       /* bands list the edges that come as near as this */
    V2 lo, hi;        /* around the points, in the plane */
    PolygonEdge *edges;
    uint32_t *bands;  /* band_count + 1: where each band's part of band_edges begins */
    uint32_t *band_edges;
    uint32_t band_count; /* bands of equal height along v */
    double band_scale;   /* bands per unit of length */
    Bound bound;
};

/* Derive all that follows from points and next, which stay borrowed.  Returns false when memory
 * is out; *is_flat tells whether the points lie in one plane and not on a line, without which
 * the data is not fit for a shape. */
bool polygon_prepare(Arena *arena, PolygonData *data, bool *is_flat);

#endif
