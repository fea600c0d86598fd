/* The ray index: which of many things a ray may meet.
 *
 * Two kinds, both over Embree, behind this one header.  BoxIndex holds items known only by
 * their boxes and calls back for the exact test; TriIndex holds triangles.  Embree computes
 * in float: it only chooses candidates.  Boxes are rounded outward, coordinates re-centred,
 * and every answer comes from a double computation.  Ties are broken by item order.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_ACCEL_ACCEL_H
#define PMS_ACCEL_ACCEL_H

#include "base/diag.h"
#include "math/bound.h"
#include "math/ray.h"

#include <stdint.h>

typedef struct BoxIndex BoxIndex;
typedef struct TriIndex TriIndex;

/* Test item `item` against the ray's current interval (ray->tmin, ray->tmax).  For a closest
 * query: on a hit at t, keep what is known of it in `query` and set ray->tmax = t.  For an any
 * query return true to end it.  Called on the thread that made the query. */
typedef bool (*AccelTest)(void *query, uint32_t item, Ray *ray);

/* Build an index over `count` finite boxes.  Fails with ERR_MEMORY or ERR_LIBRARY.
 * Free with box_index_free.  Queries may run on any number of threads. */
Status box_index_new(Diag *diag, const Bound *boxes, uint32_t count, int threads, BoxIndex **out);
void box_index_free(BoxIndex *index);

/* Offer the items whose boxes the ray may meet, nearest boxes first, until none is left
 * before ray->tmax.  `test` may shrink ray->tmax; items may be offered in any order, so a
 * test that finds an equal t must decide by item number. */
void box_index_closest(const BoxIndex *index, Ray *ray, AccelTest test, void *query);

/* Like box_index_closest but stops at the first `test` that returns true; returns whether
 * one did. */
bool box_index_any(const BoxIndex *index, Ray *ray, AccelTest test, void *query);

/* A triangle met by a ray, in double: p = (1-u-v) a + u b + v c. */
typedef struct TriHit {
    double t, u, v;
    double t_error; /* bound on the error of t */
    double t_slope; /* how far t may move when the ray is moved sideways by 1 */
    uint32_t triangle;
    bool is_along; /* the ray goes the way of (b - a) x (c - a); with the same sign for all
                      triangles that share edges, when they are seen from their edges, too */
} TriHit;

/* Build an index over triangles.
 *
 * vertices  vertex_count points, borrowed for the life of the index.
 * corners   3 indices a triangle, borrowed likewise. */
Status tri_index_new(Diag *diag, const V3 *vertices, uint32_t vertex_count, const uint32_t *corners,
                     uint32_t triangle_count, int threads, TriIndex **out);
void tri_index_free(TriIndex *index);

/* Rays of triangle queries may have directions of any length; t is in units of it. */

/* Find the nearest triangle with tmin < t < tmax; equal t: the lowest number wins.  The test
 * is watertight: a ray through a shared edge meets one of its triangles at least. */
bool tri_index_closest(const TriIndex *index, const Ray *ray, TriHit *out);

/* Test one triangle as the index does; `triangle` of the hit is 0. */
bool tri_test(const V3 corner[3], const Ray *ray, TriHit *out);

/* Return whether the line of a ray passes through loops of points, filled even-odd: point i is
 * joined to point next[i], and every point ends two edges.  Watertight like tri_test, of which
 * it has the rule for edges. */
bool loops_hold(const V3 *points, const uint32_t *next, uint32_t count, const Ray *ray);

/* Find all triangles along (tmin, tmax), ascending in t, at most `capacity`; returns how many
 * there are (may exceed capacity). */
int tri_index_all(const TriIndex *index, const Ray *ray, TriHit *out, int capacity);

#endif
