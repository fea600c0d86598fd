/* Where the light of a lamp without size arrives for certain, and where for certain it does not.
 *
 * Seen from the lamp, space is cut into cells of directions.  For each a plane is known in front of
 * which nothing stands, and one behind which all is in the shadow of something opaque: what lies
 * before the one or behind the other needs no shadow ray.
 *
 * A face maps a part of space, seen from the lamp, to a square: u and v from -1 to 1 are the
 * direction, and nearness is how close to the lamp something is along it: of a lamp that is a point
 * 1 over the depth along the face's axis, of parallel light the depth below zero.  So measured,
 * planes are linear: nearness = a u + b v + c.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TRACE_SHADOW_VIEW_H
#define PMS_TRACE_SHADOW_VIEW_H

#include "trace/trace_int.h"

enum {
    SHADOW_LEVELS = 7, /* how often a face may be quartered */
    SHADOW_SIDE = 1 << SHADOW_LEVELS,
    SHADOW_FACES_MAX = 6
};

/* nearness = a u + b v + c, u and v in smallest cells from the corner of the face on */
typedef struct ShadowPlane {
    double a, b, c;
} ShadowPlane;

/* What is nearer than `lit` is lit, what is behind `dark` dark. */
typedef struct ShadowPlanes {
    ShadowPlane lit, dark;
} ShadowPlanes;

/* The outline of something in a cell: where a u + b v is below `inside` it is met, above `outside`
 * it is not; in smallest cells. */
typedef struct ShadowEdge {
    double a, b, inside, outside;
} ShadowEdge;

typedef struct ShadowCell {
    uint32_t size; /* along its side, in smallest cells; a power of two */
    bool has_edge;
    ShadowEdge edge;
    ShadowPlanes all;  /* of everything in the cell; with an edge, inside it */
    ShadowPlanes rest; /* outside the edge, if there is one */
} ShadowCell;

typedef struct ShadowFace {
    V3 origin;
    V3 u, v, w; /* w: unit, along it is the depth; u and v lead to the edge at depth 1 */
    bool is_parallel;
    size_t count, capacity;
    ShadowCell *cells;
    uint32_t cell[SHADOW_SIDE][SHADOW_SIDE]; /* by v, then u */
} ShadowFace;

typedef struct ShadowView {
    int face_count;
    ShadowFace *faces;
} ShadowView;

/* Can anything be known of a light?  It must be met as one point by shadow rays, or be parallel,
 * and have something to shine on. */
bool shadow_view_is_of_use(const Tracer *tracer, const Light *light);

/* Make the faces of the view of such a light, nothing known yet.  Returns NULL when memory is out.
 * Free with shadow_view_free. */
ShadowView *shadow_view_new(const Tracer *tracer, const Light *light);

/* Prove what can be proved about a face, looking at no more than `looks` parts of objects in cells,
 * but at all of them once.  Returns false when memory is out. */
bool shadow_view_prove(ShadowView *view, int face, const Tracer *tracer, long looks);
void shadow_view_free(ShadowView *view);

/* Cut a ray from begin to end, finite, by what is known. */
void shadow_view_cut(const ShadowView *view, const Ray *ray, double begin, double end,
                     LitStretches *out);

#endif
