/* The sweep of CSG: what is left of the sorted crossings of a node's children.
 *
 * The sweep knows which children it is inside of, and each event is kept, dropped or turned into an
 * inner wall by the state before and after it.
 *
 * Crossings of different children whose error intervals overlap are one event.  So identical
 * faces never leave a skin, and abutting solids have no gap, however the numbers were rounded.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/csg_int.h"

#include "base/mem.h"

Sweep sweep_of(const Shape *node, const ShapeScratch *scratch)
{
    return (Sweep){.rule = node->kind == SHAPE_INTERSECTION ? RULE_INTERSECTION
                           : node->kind == SHAPE_UNION      ? RULE_UNION
                                                            : RULE_MERGE,
                   .first_slot = scratch->slot_count,
                   .lister = NO_LISTER};
}

bool sweep_is_inside(const Sweep *s)
{
    return s->rule == RULE_INTERSECTION ? s->inside_count == s->slot_count : s->inside_count > 0;
}

bool sweep_is_done(const Sweep *s)
{
    if (s->lister < 0)
        return s->lister == NO_LISTER;
    int others = s->inside_count - s->slots[s->lister].is_inside;
    return others == (s->rule == RULE_INTERSECTION ? s->slot_count - 1 : 0);
}

static ChildSlot *push_slot(ShapeScratch *scratch)
{
    if (scratch->slot_count == scratch->slot_capacity) {
        void *slots = scratch->slots;
        if (mem_grow(&slots, scratch->slot_capacity, &scratch->slot_capacity, sizeof(ChildSlot))) {
            scratch->is_overflown = true;
            return NULL;
        }
        scratch->slots = slots;
    }
    return &scratch->slots[scratch->slot_count++];
}

void sweep_add(Sweep *s, uint32_t place, bool is_inside, int from, ShapeScratch *scratch)
{
    ChildSlot *slot = push_slot(scratch);
    if (!slot) {
        scratch->count = from;
        return;
    }
    *slot = (ChildSlot){place, is_inside};
    s->inside_count += is_inside;
    if (scratch->count > from)
        s->lister = s->lister == NO_LISTER ? s->slot_count : MANY_LISTERS;
    for (int i = from; i < scratch->count; i++)
        scratch->items[i].child = (uint32_t)s->slot_count;
    s->slot_count++;
}

/* Would a wall of slot `child` be seen, as far as the other children go? */
static bool is_bare(const Sweep *s, uint32_t child)
{
    int others = s->inside_count - s->slots[child].is_inside;
    if (s->rule == RULE_INTERSECTION)
        return others == s->slot_count - 1;
    return s->rule == RULE_UNION || others == 0;
}

static void step_over(Sweep *s, const Crossing *c)
{
    if (c->change == 0)
        return;
    bool now = c->change > 0;
    s->inside_count += now - s->slots[c->child].is_inside;
    s->slots[c->child].is_inside = now;
}

/* An event of one child alone: item `at`. */
static void sweep_single(Sweep *s, int at)
{
    const Crossing *c = &s->items[at];
    bool before = sweep_is_inside(s), is_kept = is_bare(s, c->child);
    step_over(s, c);
    bool is_wall = before == sweep_is_inside(s);
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
    if (!s->core || c->child != s->core_slot)
        return s->slots[c->child].place;
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
    bool before = sweep_is_inside(s);
    int net = 0, sheet = -1;
    for (int i = from; i < to; i++) {
        net += s->items[i].leaf_change;
        if (sheet < 0 && s->items[i].change == 0 && is_bare(s, s->items[i].child))
            sheet = i;
    }
    for (int i = from; i < to; i++)
        step_over(s, &s->items[i]);
    bool after = sweep_is_inside(s);
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

SweepEvent sweep_event(const Sweep *s, int at, int count)
{
    const Crossing *first = &s->items[at];
    SweepEvent event = {at + 1, first->t + first->t_error, first->t_error, true};
    for (; event.next < count; event.next++) {
        const Crossing *c = &s->items[event.next];
        if (c->t - c->t_error > event.end)
            break;
        event.end = num_max(event.end, c->t + c->t_error);
        event.error = num_max(event.error, c->t_error);
        event.is_single &= c->child == first->child;
    }
    return event;
}

void sweep_over(Sweep *s, int at, const SweepEvent *event)
{
    if (!event->is_single)
        sweep_together(s, at, event->next);
    else
        for (int i = at; i < event->next; i++)
            sweep_single(s, i);
}

static bool is_before(const Crossing *a, const Crossing *b)
{
    if (a->t != b->t)
        return a->t < b->t;
    return a->child != b->child ? a->child < b->child : a->order < b->order;
}

/* Shell sort, which is an insertion sort for short lists. */
void crossings_sort(Crossing *items, int count)
{
    static const int gaps[] = {28703, 10301, 4193, 1073, 281, 77, 23, 8, 1};
    enum { GAPS = sizeof gaps / sizeof *gaps };
    for (int i = 0; i < count; i++)
        items[i].order = (uint32_t)i;
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
