/* Lists of crossings of the two worlds, and whether they tell the same story.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TESTS_QUAD_LISTS_H
#define PMS_TESTS_QUAD_LISTS_H

#include "quad_world.h"

enum { MEETINGS_MAX = 512, NO_PARTNER = -1 };

typedef struct List {
    Meeting at[MEETINGS_MAX];
    int count;
    bool is_inside_before;
} List;

/* List the crossings of a line with -far <= t <= far. */
void list_line(const World *world, Model *model, Quad3 o, Quad3 d, Plain far, List *out);

/* Does the bound of crossing i overlap that of one beside it?  It may be a touching. */
bool list_is_touching(const List *list, int i);

/* Does the list of double tell the story of the list of quad?
 *
 * What double cannot tell apart by its bounds is one event: crossings in quad whose bounds would
 * overlap in double have to change together what those of double do, and pairs of double whose
 * bounds overlap may be nothing.
 *
 * slack    by how much t may be off besides the bounds, where the line is square to the surface.
 * size     of the shape.
 * partner  for each crossing of double: the one it is in quad, or NO_PARTNER in such events. */
bool list_align(const List *d, const List *q, Quad3 way, Plain slack, Plain size, int *partner);

/* --- numbers of both ------------------------------------------------------------------------ */

static inline Plain quad_dot(Quad3 a, Quad3 b)
{
    return (Plain)(a.x * b.x + a.y * b.y + a.z * b.z);
}

static inline Quad3 quad_minus(Quad3 a, Quad3 b)
{
    return (Quad3){a.x - b.x, a.y - b.y, a.z - b.z};
}

static inline Quad3 quad_mad(Quad3 a, Quad s, Quad3 b)
{
    return (Quad3){a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

static inline Plain quad_abs(Quad x)
{
    return (Plain)(x < 0 ? -x : x);
}

#endif
