/* Building box trees: halved at the middle of the longest side, by number.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/box_tree.h"

#include <stdlib.h>

/* Items of a leaf. */
enum { LEAF_ITEMS = 2 };

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

static int by_key(const void *a, const void *b)
{
    const Item *x = a, *y = b;
    if (x->key != y->key)
        return x->key < y->key ? -1 : 1;
    return x->box < y->box ? -1 : x->box > y->box;
}

static void build(Builder *b, uint32_t at, uint32_t first, uint32_t count)
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
    V3 size = v3_sub(box.hi, box.lo);
    int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    for (uint32_t i = first; i < first + count; i++)
        b->items[i].key = v3_at(bound_center(b->boxes[b->items[i].box]), axis);
    qsort(b->items + first, count, sizeof *b->items, by_key);
    uint32_t child = b->node_count, half = count / 2;
    b->node_count += 2;
    b->nodes[at].first = child;
    b->nodes[at].count = 0;
    build(b, child, first, half);
    build(b, child + 1, first + half, count - half);
}

bool box_tree_new(Arena *arena, const Bound *boxes, uint32_t count, BoxTree *out)
{
    uint32_t *numbers = ARENA_ARRAY(arena, uint32_t, count);
    Builder b = {boxes, ARENA_ARRAY(arena, Item, count), ARENA_ARRAY(arena, BoxNode, 2 * count), 1};
    if (!numbers || !b.items || !b.nodes)
        return false;
    for (uint32_t i = 0; i < count; i++)
        b.items[i].box = i;
    build(&b, 0, 0, count);
    for (uint32_t i = 0; i < count; i++)
        numbers[i] = b.items[i].box;
    *out = (BoxTree){b.nodes, numbers};
    return true;
}
