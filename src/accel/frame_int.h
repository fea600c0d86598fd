/* The float frame of an index: coordinates re-centred and scaled so that all boxes lie within
 * [-1,1]^3, and rays moved to where they enter.
 *
 * A ray in the frame has a unit direction and starts just before the index, so its rounding to
 * float moves none of its points by more than FRAME_PAD; boxes are padded by that much.  What a
 * double ray meets, the float ray is offered.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_ACCEL_FRAME_INT_H
#define PMS_ACCEL_FRAME_INT_H

#include "accel/accel.h"
#include "math/eps.h"

#include <embree3/rtcore.h>

/* Frame units.  Within the frame a ray is at most 4 long and its origin within 2 of the middle
 * on each axis: rounding origin and direction moves a point by less than 2*sqrt(3) + 4 halves
 * of a float ulp of 1. */
#define FRAME_PAD (16 * EPS_FLOAT)

/* From so far away, in frame units, the digits of a double are no better than a float's. */
#define FRAME_FAR 0x1p24

typedef struct IndexFrame {
    Bound bound; /* of all items, scene units */
    V3 center;
    double scale; /* frame units per scene unit, a power of two */
} IndexFrame;

/* Make the frame of a finite box. */
IndexFrame frame_of(Bound bound);

/* Round a box outward into the frame. */
void frame_box(const IndexFrame *frame, Bound box, struct RTCBounds *out);

/* A ray on its way through an index. */
typedef struct FrameRay {
    struct RTCRayHit hit; /* for Embree */
    double start;         /* where the frame ray starts, in t of the ray */
    double line_start;    /* where the line enters a box that is FRAME_FAR ahead of the ray's
                             origin, in t; else 0.  The same for all rays of one line, and for
                             things beside each other, which let no ray through. */
    double per_t;         /* frame units per unit of t */
} FrameRay;

/* Move a ray into the frame; returns false when it misses the frame's box. */
bool frame_enter(const IndexFrame *frame, const Ray *ray, FrameRay *out);

/* Return the frame's end of a ray that ends at tmax, rounded up (never negative:
 * that would tell Embree that the ray is done). */
static inline float frame_end(const FrameRay *at, double tmax)
{
    double far = (tmax - at->start) * at->per_t + FRAME_PAD;
    return !(far < 8) ? 8 : far > 0 ? (float)far * (1 + 2 * (float)EPS_FLOAT) : 0;
}

/* Make a device, and a scene of one user geometry with `count` items; `bounds` tells their
 * boxes, `intersect` and `occluded` are Embree's callbacks with `data` as their user pointer. */
typedef struct FrameScene {
    RTCDevice device;
    RTCScene scene;
} FrameScene;

typedef struct FrameCallbacks {
    RTCBoundsFunction bounds;
    RTCIntersectFunctionN intersect;
    RTCOccludedFunctionN occluded;
} FrameCallbacks;

Status frame_scene_new(Diag *diag, uint32_t count, int threads, const FrameCallbacks *calls,
                       void *data, FrameScene *out);
void frame_scene_done(FrameScene *scene);

#endif
