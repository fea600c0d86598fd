/* Building box trees: each split is the one of a few that lets a line look at the fewest boxes, as
 * far as the areas of the halves tell; far down, and where that says nothing, it is at the middle
 * by number.  SPDX-License-Identifier: Apache-2.0 */
#include "shape/box_tree.h"

#include <stdlib.h>

/* Items of a leaf. */
enum { LEAF_ITEMS = 2 };

/* Places tried for a split; deeper than this, halves have the same number of items, which bounds
 * the depth. */
enum { BINS = 16, AREA_DEPTH_MAX = 15 };

typedef struct Item {
    double key;
    uint32_t box;
} Item;

typedef struct Builder {
    const Bound *boxes;
    Item *items;
    BoxNode *nodes;
    uint32_t node_count;
} Builder;

typedef struct Bin {
    Bound box;
    uint32_t count;
} Bin;

static int by_key(const void *a, const void *b)
{
    const Item *x = a, *y = b;
    if (x->key != y->key)
        return x->key < y->key ? -1 : 1;
    return x->box < y->box ? -1 : x->box > y->box;
}

static Bin bin_join(Bin a, Bin b)
{
    return (Bin){bound_union(a.box, b.box), a.count + b.count};
}

/* What is looked at of one side. */
static double bin_cost(Bin bin)
{
    return bin.count == 0 ? 0 : bound_half_area(bin.box) * bin.count;
}

/* Return the number of the first bin that goes to the right; 0: no split is of use. */
static int best_split(const Bin bins[BINS])
{
    double right_cost[BINS];
    uint32_t right_count[BINS];
    Bin right = {BOUND_EMPTY, 0}, left = {BOUND_EMPTY, 0};
    for (int i = BINS - 1; i > 0; i--) {
        right = bin_join(right, bins[i]);
        right_cost[i] = bin_cost(right);
        right_count[i] = right.count;
    }
    int best = 0;
    double best_cost = INFINITY;
    uint32_t best_larger = UINT32_MAX;
    for (int i = 1; i < BINS; i++) {
        left = bin_join(left, bins[i - 1]);
        double cost = bin_cost(left) + right_cost[i];
        uint32_t larger = left.count > right_count[i] ? left.count : right_count[i];
        if (left.count == 0 || right_count[i] == 0 || cost > best_cost ||
            (cost == best_cost && larger >= best_larger))
            continue;
        best = i;
        best_cost = cost;
        best_larger = larger;
    }
    return best;
}

/* Sort `count` items into two parts along their keys, which lie in [lo, hi]; returns the number of
 * the first part, 0 when no split is of use. */
static uint32_t split_by_area(Builder *b, Item *items, uint32_t count, double lo, double hi)
{
    Bin bins[BINS];
    for (int i = 0; i < BINS; i++)
        bins[i] = (Bin){BOUND_EMPTY, 0};
    double scale = BINS / (hi - lo);
    if (!(scale > 0 && isfinite(scale)))
        return 0;
#define BIN_OF(item)                                                                               \
    ((int)(((item).key - lo) * scale) < BINS ? (int)(((item).key - lo) * scale) : BINS - 1)
    for (uint32_t i = 0; i < count; i++) {
        Bin *bin = &bins[BIN_OF(items[i])];
        *bin = bin_join(*bin, (Bin){b->boxes[items[i].box], 1});
    }
    int split = best_split(bins);
    uint32_t left = 0;
    for (uint32_t i = 0; split > 0 && i < count; i++) {
        if (BIN_OF(items[i]) >= split)
            continue;
        Item item = items[i];
        items[i] = items[left];
        items[left++] = item;
    }
#undef BIN_OF
    return left;
}

/* Sort items into two parts; returns the number of the first. */
static uint32_t split(Builder *b, uint32_t first, uint32_t count, int depth)
{
    Item *items = b->items + first;
    Bound centers = BOUND_EMPTY;
    for (uint32_t i = 0; i < count; i++)
        centers = bound_add(centers, bound_center(b->boxes[items[i].box]));
    V3 size = v3_sub(centers.hi, centers.lo);
    int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    for (uint32_t i = 0; i < count; i++)
        items[i].key = v3_at(bound_center(b->boxes[items[i].box]), axis);
    uint32_t left = 0;
    if (depth < AREA_DEPTH_MAX)
        left = split_by_area(b, items, count, v3_at(centers.lo, axis), v3_at(centers.hi, axis));
    if (left > 0)
        return left;
    qsort(items, count, sizeof *items, by_key);
    return count / 2;
}

static void build(Builder *b, uint32_t at, uint32_t first, uint32_t count, int depth)
{
    Bound box = BOUND_EMPTY;
    for (uint32_t i = first; i < first + count; i++)
        box = bound_union(box, b->boxes[b->items[i].box]);
    b->nodes[at].box = box;
    if (count <= LEAF_ITEMS) {
        b->nodes[at].first = first;
        b->nodes[at].count = count;
        return;
    }
    uint32_t left = split(b, first, count, depth), child = b->node_count;
    b->node_count += 2;
    b->nodes[at].first = child;
    b->nodes[at].count = 0;
    build(b, child, first, left, depth + 1);
    build(b, child + 1, first + left, count - left, depth + 1);
}

bool box_tree_new(Arena *arena, const Bound *boxes, uint32_t count, BoxTree *out)
{
    uint32_t *numbers = ARENA_ARRAY(arena, uint32_t, count);
    Builder b = {boxes, ARENA_ARRAY(arena, Item, count), ARENA_ARRAY(arena, BoxNode, 2 * count), 1};
    if (!numbers || !b.items || !b.nodes)
        return false;
    for (uint32_t i = 0; i < count; i++)
        b.items[i].box = i;
    build(&b, 0, 0, count, 0);
    for (uint32_t i = 0; i < count; i++)
        numbers[i] = b.items[i].box;
    *out = (BoxTree){b.nodes, numbers};
    return true;
}
