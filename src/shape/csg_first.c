/* The first visible crossing of a node with many children, without listing them all.
 *
 * What the tree of boxes holds is opened in the order in which the line enters it, and an event
 * is swept over as soon as nothing that is still closed can have a part in it.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/csg_int.h"

/* An event waits for what begins within this many of its errors behind its end: crossings of
 * others may be less exact than it. */
#define WAIT_ERRORS 8

typedef struct Walk {
    const Shape *node;
    const Line *line;
    ShapeScratch *scratch; /* its entries are a heap, the nearest first */
    Sweep sweep;
    int at; /* the first crossing that has not been swept over; those behind it are sorted */
} Walk;

static bool is_nearer(const IndexEntry *a, const IndexEntry *b)
{
    return a->near < b->near;
}

/* Move the last of the entries to its place in the heap. */
static void heap_rise(IndexEntry *heap, size_t last)
{
    IndexEntry entry = heap[last];
    for (; last > 0 && is_nearer(&entry, &heap[(last - 1) / 2]); last = (last - 1) / 2)
        heap[last] = heap[(last - 1) / 2];
    heap[last] = entry;
}

static IndexEntry heap_take(ShapeScratch *scratch)
{
    IndexEntry *heap = scratch->entries, first = heap[0];
    size_t count = --scratch->entry_count, at = 0;
    const IndexEntry last = heap[count];
    for (size_t child = 1; child < count; at = child, child = 2 * at + 1) {
        if (child + 1 < count && is_nearer(&heap[child + 1], &heap[child]))
            child++;
        if (!is_nearer(&heap[child], &last))
            break;
        heap[at] = heap[child];
    }
    heap[at] = last;
    return first;
}

/* Open the nearest entry; crossings found so are not sorted. */
static void open_nearest(Walk *walk)
{
    ShapeScratch *scratch = walk->scratch;
    IndexEntry entry = heap_take(scratch);
    if (entry.is_child) {
        list_child(walk->node, entry.what, walk->line, scratch, &walk->sweep);
        return;
    }
    size_t first = scratch->entry_count;
    index_open(&walk->node->index->nodes[entry.what], walk->line, scratch);
    size_t end = scratch->entry_count;
    for (size_t i = first; i < end; i++)
        heap_rise(scratch->entries, i);
}

/* Open the nearest entries: the more crossings wait, which are sorted and looked at again each
 * time, the more entries at once, so that it costs little more than to list all children. */
static void open_some(Walk *walk)
{
    ShapeScratch *scratch = walk->scratch;
    int count = scratch->count, waiting = count - walk->at;
    for (int left = 1 + waiting / 2; left > 0 && scratch->entry_count > 0; left--)
        open_nearest(walk);
    if (scratch->count > count)
        crossings_sort(scratch->items + walk->at, scratch->count - walk->at);
}

/* Sweep over the events that nothing closed can have a part in, as far as the first visible
 * crossing behind tmin; returns it, or NULL. */
static const Crossing *sweep_ready(Walk *walk)
{
    ShapeScratch *scratch = walk->scratch;
    Sweep *s = &walk->sweep;
    double ready = scratch->entry_count ? scratch->entries[0].near : INFINITY;
    s->items = scratch->items;
    s->slots = scratch->slots + s->first_slot;
    while (walk->at < scratch->count) {
        SweepEvent event = sweep_event(s, walk->at, scratch->count);
        if (!(event.end + WAIT_ERRORS * event.error < ready))
            return NULL;
        s->written = walk->at;
        sweep_over(s, walk->at, &event);
        for (int i = walk->at; i < s->written; i++)
            if (s->items[i].is_visible && s->items[i].t > walk->line->ray->tmin)
                return &s->items[i];
        walk->at = event.next;
    }
    return NULL;
}

bool csg_first(const Shape *node, const Ray *ray, ShapeScratch *scratch, Crossing *out)
{
    Line part = scratch_line(ray, ray->tmin, ray->tmax, scratch);
    ConvexCore core;
    Walk walk = {node, &part, scratch, sweep_of(node, scratch), 0};
    if (!line_cut(&part, &node->reach) ||
        !list_plain_children(node, &part, scratch, &walk.sweep, &core))
        return false;
    if (walk.sweep.rule != RULE_INTERSECTION)
        walk.sweep.inside_count += node->index->beyond_count;
    crossings_sort(scratch->items, scratch->count);
    index_open(node->index->nodes, &part, scratch);
    for (size_t i = 0; i < scratch->entry_count; i++)
        heap_rise(scratch->entries, i);
    for (;;) {
        const Crossing *found = sweep_ready(&walk);
        if (found) {
            *out = *found;
            return out->t < ray->tmax;
        }
        if (scratch->entry_count == 0)
            return false;
        open_some(&walk);
    }
}
