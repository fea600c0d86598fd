/* Constructive solid geometry on crossing lists.
 *
 * The lists of the children are put one behind the other on the scratch's stack, sorted along
 * the line and swept once: the sweep knows which children it is inside of, and each event is
 * kept, dropped or turned into an inner wall by the state before and after it.
 *
 * Crossings of different children whose error intervals overlap are one event.  So identical
 * faces never leave a skin, and abutting solids have no gap, however the numbers were rounded.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape_int.h"

#include "base/mem.h"

#include <string.h>

typedef enum Rule { RULE_UNION, RULE_MERGE, RULE_INTERSECTION } Rule;

/* A sweep over the merged lists of the children of one node. */
typedef struct Sweep {
    Rule rule;
    Crossing *items;
    uint8_t *inside; /* per child */
    int child_count, inside_count;
    int written;            /* results so far, from the start of items' range */
    int lister;             /* the only child with crossings, or one of the two below */
    const ConvexCore *core; /* stands for all convex leaves under the number of the first, slot */
    uint32_t slot;
} Sweep;

enum { NO_CHILD = -1, MANY_CHILDREN = -2 };

static bool is_inside_node(const Sweep *s)
{
    return s->rule == RULE_INTERSECTION ? s->inside_count == s->child_count : s->inside_count > 0;
}

/* Would a wall of child `child` be seen, as far as the other children go? */
static bool is_bare(const Sweep *s, uint32_t child)
{
    int others = s->inside_count - s->inside[child];
    if (s->rule == RULE_INTERSECTION)
        return others == s->child_count - 1;
    return s->rule == RULE_UNION || others == 0;
}

/* Do the other children leave a child as it is? */
static bool is_neutral(const Sweep *s, int child)
{
    int others = s->inside_count - s->inside[child];
    return others == (s->rule == RULE_INTERSECTION ? s->child_count - 1 : 0);
}

static void step_over(Sweep *s, const Crossing *c)
{
    if (c->change == 0)
        return;
    uint8_t now = c->change > 0;
    s->inside_count += now - s->inside[c->child];
    s->inside[c->child] = now;
}

/* An event of one child alone: item `at`. */
static void sweep_single(Sweep *s, int at)
{
    const Crossing *c = &s->items[at];
    bool before = is_inside_node(s), is_kept = is_bare(s, c->child);
    step_over(s, c);
    bool is_wall = before == is_inside_node(s);
    if (!is_kept || (is_wall && !c->is_visible))
        return;
    Crossing *kept = &s->items[s->written++];
    if (kept != c)
        *kept = *c;
    if (is_wall)
        kept->change = 0;
}

/* Return the number of the child a crossing is of, in written order. */
static uint32_t written_place(const Sweep *s, const Crossing *c)
{
    if (!s->core || c->child != s->slot)
        return c->child;
    return (uint32_t)(c->change > 0 ? s->core->entry.child : s->core->exit.child);
}

/* Return the crossing that lends an event its look: going the way of the event if it has one
 * (`change` not 0), visible rather than not, of the child written first. */
static int choose(const Sweep *s, int from, int to, int change)
{
    int best = from, best_score = -1;
    for (int i = from; i < to; i++) {
        const Crossing *c = &s->items[i];
        int score = 2 * (change == 0 || c->change == change) + c->is_visible;
        if (score > best_score ||
            (score == best_score && written_place(s, c) < written_place(s, &s->items[best]))) {
            best = i;
            best_score = score;
        }
    }
    return best;
}

/* Events of several children at one place. */
static void sweep_together(Sweep *s, int from, int to)
{
    bool before = is_inside_node(s);
    int net = 0, sheet = -1;
    for (int i = from; i < to; i++) {
        net += s->items[i].leaf_change;
        if (sheet < 0 && s->items[i].change == 0 && is_bare(s, s->items[i].child))
            sheet = i;
    }
    for (int i = from; i < to; i++)
        step_over(s, &s->items[i]);
    bool after = is_inside_node(s);
    int change = after - before;
    Crossing kept;
    if (change) {
        kept = s->items[choose(s, from, to, change)];
    } else if (s->rule == RULE_UNION || (s->rule == RULE_MERGE && !before)) {
        kept = s->items[choose(s, from, to, 0)];
    } else if (sheet >= 0 && is_bare(s, s->items[sheet].child)) {
        kept = s->items[sheet];
    } else {
        return;
    }
    kept.change = (int8_t)change;
    kept.leaf_change = (int8_t)((net > 0) - (net < 0));
    if (kept.change || kept.is_visible)
        s->items[s->written++] = kept;
}

static bool is_before(const Crossing *a, const Crossing *b)
{
    return a->t < b->t || (a->t == b->t && a->child < b->child);
}

/* Shell sort, which is an insertion sort for short lists. */
void crossings_sort(Crossing *items, int count)
{
    static const int gaps[] = {28703, 10301, 4193, 1073, 281, 77, 23, 8, 1};
    enum { GAPS = sizeof gaps / sizeof *gaps };
    for (int g = count > 32 ? 0 : GAPS - 1; g < GAPS; g++) {
        for (int i = gaps[g]; i < count; i++) {
            if (!is_before(&items[i], &items[i - gaps[g]]))
                continue;
            Crossing item = items[i];
            int place = i;
            for (; place >= gaps[g] && is_before(&item, &items[place - gaps[g]]); place -= gaps[g])
                items[place] = items[place - gaps[g]];
            items[place] = item;
        }
    }
}

/* Sweep over items [base, count) of the scratch; what is kept replaces them. */
static void sweep(ShapeScratch *scratch, int base, Sweep *s)
{
    s->items = scratch->items + base;
    int count = scratch->count - base;
    crossings_sort(s->items, count);
    for (int i = 0; i < count;) {
        double end = s->items[i].t + s->items[i].t_error;
        bool is_alone = true;
        int next = i + 1;
        for (; next < count && s->items[next].t - s->items[next].t_error <= end; next++) {
            end = num_max(end, s->items[next].t + s->items[next].t_error);
            is_alone &= s->items[next].child == s->items[i].child;
        }
        if (!is_alone) {
            sweep_together(s, i, next);
            i = next;
        }
        for (; i < next; i++)
            sweep_single(s, i);
    }
    scratch->count = base + s->written;
}

/* Put the states of `count` children on the scratch's stack; returns where, or -1. */
static long push_states(ShapeScratch *scratch, int count)
{
    size_t first = scratch->state_count, wanted = first + (size_t)count;
    while (scratch->state_capacity < wanted) {
        void *states = scratch->states;
        if (mem_grow(&states, scratch->state_capacity, &scratch->state_capacity, 1)) {
            scratch->is_overflown = true;
            return -1;
        }
        scratch->states = states;
    }
    scratch->state_count = wanted;
    return (long)first;
}

static void tag(ShapeScratch *scratch, int from, uint32_t child)
{
    for (int i = from; i < scratch->count; i++)
        scratch->items[i].child = child;
}

/* What is inside a child cannot reach beyond its first and last crossing if the line starts and
 * ends outside of it: nothing else is wanted of an intersection.  The margin is for crossings of
 * others in the same place. */
static void narrow_to_list(Line *line, const ShapeScratch *scratch, int from)
{
    const Crossing *first = &scratch->items[from], *last = &scratch->items[scratch->count - 1];
    double near = first->t - 8 * first->t_error, far = last->t + 8 * last->t_error;
    line->near = near > line->near ? near : line->near;
    line->far = far < line->far ? far : line->far;
}

/* Does a list that starts outside end outside too, and begin with an entry? */
static bool is_closed_list(const ShapeScratch *scratch, int from)
{
    return scratch->items[from].change > 0 && scratch->items[scratch->count - 1].change < 0;
}

/* The parts of a line within the reaches of four children; near > far where it misses one. */
typedef struct BlockCut {
    double near[BLOCK], far[BLOCK];
} BlockCut;

/* As line_cut, for four boxes at once. */
static void block_cut(const ReachBlock *b, const Line *line, BlockCut *out)
{
    const double o[3] = {line->ray->o.x, line->ray->o.y, line->ray->o.z};
    const double inverse[3] = {line->inverse.x, line->inverse.y, line->inverse.z};
    const Lanes zero = {0};
    Lanes near = zero + line->near, far = zero + line->far;
    for (int axis = 0; axis < 3; axis++) {
        bool is_back = inverse[axis] < 0;
        Lanes first, last;
        memcpy(&first, is_back ? b->hi[axis] : b->lo[axis], sizeof first);
        memcpy(&last, is_back ? b->lo[axis] : b->hi[axis], sizeof last);
        first = (first - o[axis]) * inverse[axis];
        last = (last - o[axis]) * inverse[axis];
        near = LANES_PICK(first > near, first, near);
        far = LANES_PICK(last < far, last, far);
    }
    /* The t are exact to a few of their own ulps. */
    const double slack = 8 * EPS_DOUBLE;
    near *= LANES_PICK(near < zero, zero + (1 + slack), zero + (1 - slack));
    far *= LANES_PICK(far < zero, zero + (1 - slack), zero + (1 + slack));
    memcpy(out->near, &near, sizeof near);
    memcpy(out->far, &far, sizeof far);
}

static bool list_reached(const Shape *shape, const Line *line, ShapeScratch *scratch);

/* List child i of a node; *cut is that of its block.  Returns its state before the line. */
static bool list_child(const Shape *node, int i, const Line *line, const BlockCut *cut,
                       ShapeScratch *scratch)
{
    if (!node->is_finished || !node->reaches)
        return csg_list(node->children[i], line, scratch);
    const ReachBlock *block = &node->reaches[i / BLOCK];
    int k = i % BLOCK;
    if (cut->near[k] > cut->far[k])
        return block->is_inside_beyond[k];
    Line part = {line->ray, line->inverse, cut->near[k], cut->far[k], false};
    return list_reached(node->children[i], &part, scratch);
}

static void note_lister(Sweep *s, int child)
{
    s->lister = s->lister == NO_CHILD ? child : MANY_CHILDREN;
}

/* List the convex leaves of an intersection as one child; false when they share nothing. */
static bool list_core(const Shape *node, Line *line, ShapeScratch *scratch, long first, Sweep *s,
                      ConvexCore *core)
{
    if (!convex_core(node, line->ray, line->near, line->far, core))
        return false;
    bool has_entry = core->entry.child != NO_CONVEX, has_exit = core->exit.child != NO_CONVEX;
    s->core = core;
    s->slot = UINT32_MAX;
    for (int i = 0; i < node->child_count; i++) {
        if (!node->children[i]->is_convex_leaf)
            continue;
        s->slot = s->slot == UINT32_MAX ? (uint32_t)i : s->slot;
        bool is_inside = !has_entry || s->slot != (uint32_t)i;
        scratch->states[first + i] = is_inside;
        s->inside_count += is_inside;
    }
    if (has_entry) {
        convex_push(&core->entry, s->slot, scratch);
        line->near = num_max(line->near, 2 * core->entry.lo - core->entry.hi);
    }
    if (has_exit) {
        convex_push(&core->exit, s->slot, scratch);
        line->far = num_min(line->far, 2 * core->exit.hi - core->exit.lo);
    }
    if (has_entry || has_exit)
        note_lister(s, (int)s->slot);
    return true;
}

/* List the children of a node; returns false if the line never enters an intersection. */
static bool list_children(const Shape *node, Line line, ShapeScratch *scratch, long first, Sweep *s,
                          ConvexCore *core)
{
    bool has_core = s->rule == RULE_INTERSECTION && node->is_finished && node->convex_count > 1;
    if (has_core && !list_core(node, &line, scratch, first, s, core))
        return false;
    if (has_core && node->convex_count == node->child_count)
        return true;
    BlockCut cut;
    for (int i = 0; i < node->child_count; i++) {
        bool is_first_of_block = i % BLOCK == 0;
        if (is_first_of_block && node->is_finished && node->reaches)
            block_cut(&node->reaches[i / BLOCK], &line, &cut);
        if (has_core && node->children[i]->is_convex_leaf)
            continue;
        int from = scratch->count;
        bool inside = list_child(node, i, &line, &cut, scratch);
        scratch->states[first + i] = inside;
        s->inside_count += inside;
        if (scratch->count > from) {
            note_lister(s, i);
            tag(scratch, from, (uint32_t)i);
        }
        if (s->rule != RULE_INTERSECTION || inside)
            continue;
        if (scratch->count == from)
            return false;
        if (is_closed_list(scratch, from))
            narrow_to_list(&line, scratch, from);
    }
    return true;
}

/* List a node's children and merge them. */
static bool node_list(const Shape *node, const Line *line, ShapeScratch *scratch)
{
    /* Inner walls of a union disappear when it is turned inside out. */
    Sweep s = {.rule = node->kind == SHAPE_INTERSECTION                  ? RULE_INTERSECTION
                       : node->kind == SHAPE_UNION && !node->is_inverted ? RULE_UNION
                                                                         : RULE_MERGE,
               .child_count = node->child_count,
               .lister = NO_CHILD};
    int base = scratch->count;
    long first = push_states(scratch, node->child_count);
    if (first < 0)
        return false;
    bool inside_before = false;
    ConvexCore core;
    if (list_children(node, *line, scratch, first, &s, &core)) {
        s.inside = scratch->states + first;
        inside_before = is_inside_node(&s);
        /* If only one child has crossings, and the others leave it as it is, all is done. */
        bool is_done = s.lister >= 0 && is_neutral(&s, s.lister);
        if (!is_done)
            sweep(scratch, base, &s);
    } else {
        scratch->count = base;
    }
    scratch->state_count = (size_t)first;
    return inside_before;
}

/* Cut the list from `base` on to the inside of the clips, whose own surfaces are not seen. */
static bool clip_list(const Shape *shape, const Line *line, ShapeScratch *scratch, int base,
                      bool is_inside)
{
    Sweep s = {
        .rule = RULE_INTERSECTION, .child_count = shape->clip_count + 1, .inside_count = is_inside};
    long first = push_states(scratch, s.child_count);
    if (first < 0)
        return false;
    scratch->states[first] = is_inside;
    tag(scratch, base, 0);
    for (int i = 0; i < shape->clip_count; i++) {
        int from = scratch->count;
        bool inside = csg_list(shape->clips[i], line, scratch);
        scratch->states[first + i + 1] = inside;
        s.inside_count += inside;
        tag(scratch, from, (uint32_t)i + 1);
        for (int k = from; k < scratch->count; k++)
            scratch->items[k].is_visible = false;
    }
    s.inside = scratch->states + first;
    bool inside_before = is_inside_node(&s);
    sweep(scratch, base, &s);
    scratch->state_count = (size_t)first;
    return inside_before;
}

/* csg_list for a line that is known to reach the shape. */
static bool list_reached(const Shape *shape, const Line *line, ShapeScratch *scratch)
{
    int base = scratch->count;
    bool is_inside = shape->kind < SHAPE_UNION ? leaf_list(shape, line, scratch)
                                               : node_list(shape, line, scratch);
    if (shape->is_inverted) {
        is_inside = !is_inside;
        for (int i = base; i < scratch->count; i++)
            crossing_invert(&scratch->items[i]);
    }
    if (shape->clip_count)
        is_inside = clip_list(shape, line, scratch, base, is_inside);
    return is_inside;
}

bool csg_list(const Shape *shape, const Line *line, ShapeScratch *scratch)
{
    Line part = *line;
    if (shape->is_finished && !line_cut(&part, &shape->reach))
        return shape->is_inside_beyond;
    return list_reached(shape, &part, scratch);
}
