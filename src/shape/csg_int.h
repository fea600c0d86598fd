/* What the files of CSG share: the sweep over sorted crossings, and the index of nodes with many
 * children.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SHAPE_CSG_INT_H
#define PMS_SHAPE_CSG_INT_H

#include "shape/shape_int.h"

typedef enum Rule { RULE_UNION, RULE_MERGE, RULE_INTERSECTION } Rule;

/* A sweep over the crossings of a node's children.  Children that a line meets have slots on the
 * scratch's stack, and Crossing.child is the number of a slot. */
typedef struct Sweep {
    Rule rule;
    Crossing *items;
    ChildSlot *slots;
    size_t first_slot; /* on the stack */
    int slot_count;
    int inside_count;       /* slots whose inside the line is in; for unions with those it never
                               leaves, which have no slot */
    int written;            /* results so far, from the start of items */
    int lister;             /* the only slot with crossings, or one of the two below */
    const ConvexCore *core; /* stands for all convex leaves, in one slot */
    uint32_t core_slot;
} Sweep;

enum { NO_LISTER = -1, MANY_LISTERS = -2 };

/* Begin the sweep of a node's children. */
Sweep sweep_of(const Shape *node, const ShapeScratch *scratch);

/* Is the line inside the node where the sweep is? */
bool sweep_is_inside(const Sweep *s);

/* Are the crossings what is left already: of one slot at most, which the others leave as it is? */
bool sweep_is_done(const Sweep *s);

/* Does a child that the line misses leave anything of an intersection? */
static inline bool sweep_skip(Sweep *s, bool is_inside_beyond)
{
    if (s->rule == RULE_INTERSECTION)
        return is_inside_beyond;
    s->inside_count += is_inside_beyond;
    return true;
}

/* Give the child written at `place` a slot, and it the crossings from `from` on; a slot is lost,
 * and the scratch says so, when memory is out. */
void sweep_add(Sweep *s, uint32_t place, bool is_inside, int from, ShapeScratch *scratch);

/* An event: crossings linked by error intervals that overlap. */
typedef struct SweepEvent {
    int next;     /* the first item behind it */
    double end;   /* of the intervals */
    double error; /* the largest */
    bool is_single; /* all are of one slot */
} SweepEvent;

/* Find the event at item `at` of `count` sorted ones. */
SweepEvent sweep_event(const Sweep *s, int at, int count);

/* Sweep over an event; what is kept of it is written. */
void sweep_over(Sweep *s, int at, const SweepEvent *event);

/* List the children of a node that an index does not hold, or all; false if the line never enters
 * an intersection.  *line narrows to what is left of that. */
bool list_plain_children(const Shape *node, Line *line, ShapeScratch *scratch, Sweep *s,
                         ConvexCore *core);

/* List one child. */
void list_child(const Shape *node, uint32_t number, const Line *line, ShapeScratch *scratch,
                Sweep *s);

/* --- csg_index.c ------------------------------------------------------------------------------ */

/* A node of the tree of boxes: what is in it are children of the shape, or nodes. */
typedef struct IndexNode {
    BoxBlock boxes;
    uint32_t what[BLOCK];
    bool is_child[BLOCK];
} IndexNode;

struct CsgIndex {
    const IndexNode *nodes; /* the first is the root */
    const uint32_t *plain;  /* numbers of the children that are not in the tree */
    int plain_count;
    int beyond_count;       /* children in the tree that are inside beyond their boxes */
};

/* Push the children in the tree whose boxes a line meets on the scratch's stack of entries. */
void index_meet(const CsgIndex *index, const Line *line, ShapeScratch *scratch);

/* Push what is in a node of the tree, where the line meets it. */
void index_open(const IndexNode *node, const Line *line, ShapeScratch *scratch);

#endif
