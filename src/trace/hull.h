/* Where a bundle of rays goes: from one point to every point of a ball.
 *
 * A shape that the hull of point and ball passes by is met by none of the rays.  The answers are
 * one-sided: "missed" is proved, with slack for rounding; its opposite proves nothing.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TRACE_HULL_H
#define PMS_TRACE_HULL_H

#include "shape/shape.h"

typedef struct Hull {
    V3 apex;             /* where all rays start */
    V3 center;           /* of the ball they end in */
    double radius;       /* of the ball */
    V3 axis;             /* unit, apex to centre */
    double length;       /* along the axis, to behind the ball */
    double sine, cosine; /* of half the angle of the cone around the ball */
    double slack;        /* scene units: rounding of the apex */
} Hull;

/* Make a hull; returns false when the ball is too near the apex for a cone around it. */
bool hull_init(Hull *hull, V3 apex, double apex_error, V3 center, double radius);

/* Return true if no ray meets the ball. */
static inline bool hull_misses_ball(const Hull *hull, V3 center, double radius)
{
    V3 to = v3_sub(center, hull->apex);
    double along = v3_dot(to, hull->axis), limit = radius + hull->slack;
    if (along < -limit || along > hull->length + limit)
        return true;
    double far2 = v3_len2(to), aside2 = far2 - along * along;
    double side = limit + along * hull->sine; /* against aside * cosine */
    return side < 0 || aside2 * hull->cosine * hull->cosine > side * side + far2 * 1e-14;
}

/* Return true if no ray meets a surface of the shape. */
bool hull_misses_shape(const Hull *hull, const Shape *shape);

#endif
