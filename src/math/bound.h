/* Axis-parallel boxes.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_MATH_BOUND_H
#define PMS_MATH_BOUND_H

#include "math/xform.h"

typedef struct Bound {
    V3 lo, hi; /* empty when lo > hi on some axis; infinite sides are allowed */
} Bound;

#define BOUND_EMPTY ((Bound){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}})
#define BOUND_ALL ((Bound){{-INFINITY, -INFINITY, -INFINITY}, {INFINITY, INFINITY, INFINITY}})

static inline Bound bound_union(Bound a, Bound b)
{
    return (Bound){v3_min(a.lo, b.lo), v3_max(a.hi, b.hi)};
}

static inline Bound bound_intersect(Bound a, Bound b)
{
    return (Bound){v3_max(a.lo, b.lo), v3_min(a.hi, b.hi)};
}

static inline Bound bound_add(Bound b, V3 p)
{
    return (Bound){v3_min(b.lo, p), v3_max(b.hi, p)};
}

static inline bool bound_is_empty(Bound b)
{
    return !(b.lo.x <= b.hi.x && b.lo.y <= b.hi.y && b.lo.z <= b.hi.z);
}

static inline bool bound_holds(const Bound *b, V3 p)
{
    return p.x >= b->lo.x && p.x <= b->hi.x && p.y >= b->lo.y && p.y <= b->hi.y &&
           p.z >= b->lo.z && p.z <= b->hi.z;
}

static inline bool bound_is_finite(Bound b) { return v3_is_finite(b.lo) && v3_is_finite(b.hi); }

/* Return half of the area of the surface. */
static inline double bound_half_area(Bound b)
{
    V3 size = v3_sub(b.hi, b.lo);
    return size.x * size.y + size.y * size.z + size.z * size.x;
}

static inline V3 bound_center(Bound b) { return v3_scale(v3_add(b.lo, b.hi), 0.5); }

/* Return the radius of the sphere through the corners of a finite box. */
static inline double bound_radius(Bound b) { return 0.5 * v3_dist(b.lo, b.hi); }

/* Return the box around a transformed box; an infinite box stays infinite on every side. */
Bound bound_transform(Bound b, const Xform *x);

#endif
