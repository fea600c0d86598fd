/* Comparing lists of crossings.  SPDX-License-Identifier: Apache-2.0 */
#include "quad_lists.h"

#include <math.h>
#include <string.h>

/* Bounds of the world of quad times this are those of double, about: the ratio of the rounding
 * units, and a little. */
#define BOUND_RATIO (1.5 * 0x1p60)

/* No bound says that less than this share of the size cannot be told apart. */
#define WIDEST_EVENT 1e-5

/* Nor is what no bound of more than this share goes with left of a touching. */
#define NARROWEST_SHEET 1e-9

void list_line(const World *world, Model *model, Quad3 o, Quad3 d, Plain far, List *out)
{
    int count = world->meet(model, o, d, &out->is_inside_before, out->at, MEETINGS_MAX), first = 0;
    if (count > MEETINGS_MAX)
        count = MEETINGS_MAX;
    for (; first < count && out->at[first].t < -far; first++)
        out->is_inside_before ^= out->at[first].change != 0;
    while (count > first && out->at[count - 1].t > far)
        count--;
    out->count = count - first;
    memmove(out->at, out->at + first, (size_t)out->count * sizeof *out->at);
}

static bool overlaps(const Meeting *a, const Meeting *b)
{
    return quad_abs(a->t - b->t) <= (Plain)(a->t_error + b->t_error);
}

bool list_is_touching(const List *list, int i)
{
    return (i > 0 && overlaps(&list->at[i - 1], &list->at[i])) ||
           (i + 1 < list->count && overlaps(&list->at[i], &list->at[i + 1]));
}

/* Where double may see an event, and what it changes there. */
typedef struct Event {
    Quad lo, hi;
    int first, end, change;
} Event;

typedef struct Aligner {
    const List *d, *q;
    Quad3 way;
    Plain slack, size;
    int *partner;
} Aligner;

static Plain bound_in_double(const Aligner *a, const Meeting *m)
{
    Plain bound = fmin((Plain)m->t_error * BOUND_RATIO, WIDEST_EVENT * a->size);
    return bound + a->slack / fabs(quad_dot(m->n, a->way));
}

/* Return the event of quad that begins with crossing k. */
static Event next_event(const Aligner *a, int k)
{
    const Meeting *m = &a->q->at[k];
    Plain bound = bound_in_double(a, m);
    Event e = {m->t - bound, m->t + bound, k, k + 1, m->change};
    for (; e.end < a->q->count; e.end++) {
        m = &a->q->at[e.end];
        bound = bound_in_double(a, m);
        if (m->t - bound > e.hi)
            break;
        e.hi = m->t + bound > e.hi ? m->t + bound : e.hi;
        e.change += m->change;
    }
    return e;
}

static bool is_at(const Meeting *d, const Event *e)
{
    return d->t + d->t_error >= e->lo && d->t - d->t_error <= e->hi;
}

/* How many crossings of double from i on may be nothing, by their bounds: two that undo each other,
 * or the sheet that stands for them. */
static int touch_at(const Aligner *a, int i)
{
    const Meeting *m = &a->d->at[i];
    if (m->change == 0 && (Plain)m->t_error > NARROWEST_SHEET * a->size)
        return 1;
    bool is_pair = i + 1 < a->d->count && m->change + m[1].change == 0 && overlaps(m, m + 1);
    return is_pair ? 2 : 0;
}

/* Take what double has at one crossing of quad: the same, or that of another leaf which lies as
 * near.  Returns the number of the next crossing, or -1. */
static int take_single(const Aligner *a, const Event *e, int i)
{
    const Meeting *q = &a->q->at[e->first];
    while (i < a->d->count) {
        const Meeting *d = &a->d->at[i];
        int touch = touch_at(a, i);
        bool is_same = d->change == q->change && d->is_visible == q->is_visible;
        bool is_known_leaf = d->is_visible && d->leaf == q->leaf;
        if (is_same && (is_at(d, e) || (is_known_leaf && !touch))) {
            bool is_known = d->leaf == q->leaf && d->part == q->part;
            a->partner[i] = is_known ? e->first : NO_PARTNER;
            return i + 1;
        }
        if (!touch)
            return -1;
        i += touch;
    }
    return -1;
}

/* Take all that double has at an event of several crossings. */
static int take_together(const Aligner *a, const Event *e, int i)
{
    int change = 0;
    for (; i < a->d->count && is_at(&a->d->at[i], e); i++)
        change += a->d->at[i].change;
    return change == e->change ? i : -1;
}

bool list_align(const List *d, const List *q, Quad3 way, Plain slack, Plain size, int *partner)
{
    Aligner a = {d, q, way, slack, size, partner};
    int i = 0;
    for (int k = 0; k < d->count; k++)
        partner[k] = NO_PARTNER;
    if (d->is_inside_before != q->is_inside_before)
        return false;
    for (int k = 0; k < q->count;) {
        Event e = next_event(&a, k);
        i = e.end - e.first == 1 ? take_single(&a, &e, i) : take_together(&a, &e, i);
        if (i < 0)
            return false;
        k = e.end;
    }
    for (int touch; i < d->count; i += touch) {
        touch = touch_at(&a, i);
        if (!touch)
            return false;
    }
    return true;
}
