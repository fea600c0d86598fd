/* Constructive solid geometry on crossing lists.
 *
 * The lists of the children that a line meets are put one behind the other on the scratch's stack,
 * sorted along the line and swept once (csg_sweep.c).  Of nodes with many children an index tells
 * which a line may meet (csg_index.c).  SPDX-License-Identifier: Apache-2.0 */
#include "shape/csg_int.h"

/* Sort items [base, count) of the scratch and sweep over them; what is kept replaces them. */
static void sweep(ShapeScratch *scratch, int base, Sweep *s)
{
    s->items = scratch->items + base;
    s->slots = scratch->slots + s->first_slot;
    int count = scratch->count - base;
    crossings_sort(s->items, count);
    for (int i = 0; i < count;) {
        SweepEvent event = sweep_event(s, i, count);
        sweep_over(s, i, &event);
        i = event.next;
    }
    scratch->count = base + s->written;
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

static bool list_reached(const Shape *shape, const Line *line, ShapeScratch *scratch);

/* List the convex leaves of an intersection as one child; false when they share nothing. */
static bool list_core(const Shape *node, Line *line, ShapeScratch *scratch, Sweep *s,
                      ConvexCore *core)
{
    if (!convex_core(node, line->ray, line->near, line->far, core))
        return false;
    bool has_entry = core->entry.child != NO_CONVEX, has_exit = core->exit.child != NO_CONVEX;
    if (!has_entry && !has_exit)
        return true;
    int from = scratch->count;
    if (has_entry) {
        convex_push(&core->entry, scratch);
        line->near = num_max(line->near, 2 * core->entry.lo - core->entry.hi);
    }
    if (has_exit) {
        convex_push(&core->exit, scratch);
        line->far = num_min(line->far, 2 * core->exit.hi - core->exit.lo);
    }
    s->core = core;
    s->core_slot = (uint32_t)s->slot_count;
    sweep_add(s, 0, !has_entry, from, scratch);
    return true;
}

/* Go on with an intersection whose child was listed from `from` on; false if the line never enters
 * it. */
static bool narrow_to_child(Line *line, const ShapeScratch *scratch, int from, bool is_inside)
{
    if (is_inside)
        return true;
    if (scratch->count == from)
        return false;
    if (is_closed_list(scratch, from))
        narrow_to_list(line, scratch, from);
    return true;
}

/* List child i where the line meets its box; *cut is that of its block, if reaches are known. */
static bool list_plain_child(const Shape *node, int i, Line *line, const BlockCut *cut,
                             ShapeScratch *scratch, Sweep *s)
{
    int from = scratch->count;
    bool is_inside;
    if (cut) {
        int k = i % BLOCK;
        if (cut->near[k] > cut->far[k])
            return sweep_skip(s, node->reaches[i / BLOCK].is_inside_beyond[k]);
        Line part = {line->ray, line->inverse, cut->near[k], cut->far[k], false};
        is_inside = list_reached(node->children[i], &part, scratch);
    } else {
        is_inside = csg_list(node->children[i], line, scratch);
    }
    sweep_add(s, (uint32_t)i, is_inside, from, scratch);
    return s->rule != RULE_INTERSECTION || narrow_to_child(line, scratch, from, is_inside);
}

bool list_plain_children(const Shape *node, Line *line, ShapeScratch *scratch, Sweep *s,
                         ConvexCore *core)
{
    bool has_core = s->rule == RULE_INTERSECTION && node->is_finished && node->convex_count > 1;
    if (has_core && !list_core(node, line, scratch, s, core))
        return false;
    if (has_core && node->convex_count == node->child_count)
        return true;
    const CsgIndex *index = node->is_finished ? node->index : NULL;
    bool has_reaches = node->is_finished && node->reaches;
    int count = index ? index->plain_count : node->child_count;
    BlockCut cut;
    for (int k = 0; k < count; k++) {
        int i = index ? (int)index->plain[k] : k;
        if (has_reaches && i % BLOCK == 0)
            block_cut(&node->reaches[i / BLOCK].boxes, line, &cut);
        if (has_core && node->children[i]->is_convex_leaf)
            continue;
        if (!list_plain_child(node, i, line, has_reaches ? &cut : NULL, scratch, s))
            return false;
    }
    return true;
}

void list_child(const Shape *node, uint32_t number, const Line *line, ShapeScratch *scratch,
                Sweep *s)
{
    int from = scratch->count;
    const Shape *child = node->children[number];
    if (s->rule != RULE_INTERSECTION)
        s->inside_count -= child->is_inside_beyond;
    bool is_inside = csg_list(child, line, scratch);
    sweep_add(s, number, is_inside, from, scratch);
}

/* List the children that the index finds. */
static void list_indexed_children(const Shape *node, const Line *line, ShapeScratch *scratch,
                                  Sweep *s)
{
    size_t first = scratch->entry_count;
    if (s->rule != RULE_INTERSECTION)
        s->inside_count += node->index->beyond_count;
    index_meet(node->index, line, scratch);
    for (size_t i = first; i < scratch->entry_count; i++)
        list_child(node, scratch->entries[i].what, line, scratch, s);
    scratch->entry_count = first;
}

/* List a node's children and merge them. */
static bool node_list(const Shape *node, const Line *line, ShapeScratch *scratch)
{
    Sweep s = sweep_of(node, scratch);
    Line part = *line;
    int base = scratch->count;
    bool inside_before = false;
    ConvexCore core;
    if (list_plain_children(node, &part, scratch, &s, &core)) {
        if (node->is_finished && node->index)
            list_indexed_children(node, &part, scratch, &s);
        inside_before = sweep_is_inside(&s);
        s.slots = scratch->slots + s.first_slot;
        if (!sweep_is_done(&s))
            sweep(scratch, base, &s);
    } else {
        scratch->count = base;
    }
    scratch->slot_count = s.first_slot;
    return inside_before;
}

/* Cut the list from `base` on to the inside of the clips, whose own surfaces are not seen. */
static bool clip_list(const Shape *shape, const Line *line, ShapeScratch *scratch, int base,
                      bool is_inside)
{
    Sweep s = {.rule = RULE_INTERSECTION, .first_slot = scratch->slot_count, .lister = NO_LISTER};
    sweep_add(&s, 0, is_inside, base, scratch);
    for (int i = 0; i < shape->clip_count; i++) {
        int from = scratch->count;
        bool inside = csg_list(shape->clips[i], line, scratch);
        for (int k = from; k < scratch->count; k++)
            scratch->items[k].is_visible = false;
        sweep_add(&s, (uint32_t)i + 1, inside, from, scratch);
    }
    bool inside_before = sweep_is_inside(&s);
    sweep(scratch, base, &s);
    scratch->slot_count = s.first_slot;
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
