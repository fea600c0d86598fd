/* The cases of the oracle: shapes made from random numbers, the same in both worlds.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TESTS_QUAD_SHAPES_H
#define PMS_TESTS_QUAD_SHAPES_H

#include "quad_plain.h"

#include "base/rng.h"
#include "shape/mesh.h"

enum { MODEL_LEAVES_MAX = 64, MODEL_MARKS_MAX = 64 };

/* What a case makes its shape with. */
typedef struct ShapeKit {
    Arena *arena;
    Rng rng;
    Shape *shape;
    Xform place;              /* from the space the case works in */
    V3 mark[MODEL_MARKS_MAX]; /* hard points, in that space */
    int mark_count;
    MeshData *mesh; /* to be freed, or NULL */
} ShapeKit;

typedef struct ShapeCase {
    const char *name;
    Shape *(*make)(ShapeKit *kit);
    bool may_skip; /* by what the language says, what is thin may be left out */
} ShapeCase;

/* The cases of each file; a row without a name ends them. */
extern const ShapeCase plain_cases[], solid_cases[], facet_cases[], csg_cases[];

/* Return case number i, or NULL. */
const ShapeCase *shape_case(int i);

/* Make the shape of a case, of a size about 1, and place it by one of some kinds of transforms. */
Shape *shape_kit_make(ShapeKit *kit, const ShapeCase *which);

/* Free what is not in the arena. */
void shape_kit_done(ShapeKit *kit);

/* Return a random number of [lo, hi]. */
Plain kit_number(ShapeKit *kit, Plain lo, Plain hi);
V3 kit_point(ShapeKit *kit, Plain size); /* each coordinate of [-size, size] */

/* The same with few digits, so that sums of some of them are exact. */
Plain kit_short(ShapeKit *kit, Plain lo, Plain hi);
V3 kit_short_point(ShapeKit *kit, Plain size);

void kit_mark(ShapeKit *kit, V3 p);

#endif
