/* The index of a node with many children: a tree of their boxes, four to a node.
 *
 * A child that is not met is inside or outside along the whole line: nothing need be done about
 * it.  In an intersection only children that hold all beyond their boxes (cutters) are in the
 * tree: the others bound the whole, and are looked at first.  SPDX-License-Identifier: Apache-2.0
 */
#include "shape/csg_int.h"

#include <string.h>

#include "base/mem.h"
#include "shape/box_tree.h"

/* Fewer children are faster cut one block after the other. */
enum { INDEX_MIN = 16 };

/* --- building --------------------------------------------------------------------------------- */

static bool is_in_tree(const Shape *node, const Shape *child)
{
    return bound_is_finite(child->reach) &&
           (node->kind != SHAPE_INTERSECTION || child->is_inside_beyond);
}

typedef struct Builder {
    const BoxTree *tree;
    const uint32_t *numbers; /* of the boxes' children */
    const Bound *boxes;
    IndexNode *nodes;
    uint32_t node_count;
} Builder;

/* What goes into one node: nodes of the binary tree, or boxes. */
typedef struct Brood {
    uint32_t what[BLOCK];
    bool is_box[BLOCK];
    int count;
} Brood;

/* Put the items of a leaf of the binary tree, or its children, in place of brood member k. */
static void split_member(const BoxTree *tree, Brood *brood, int k)
{
    const BoxNode *node = &tree->nodes[brood->what[k]];
    uint32_t parts = node->count ? node->count : 2;
    for (uint32_t i = 0; i < parts; i++) {
        int at = i == 0 ? k : brood->count++;
        brood->is_box[at] = node->count > 0;
        brood->what[at] = node->count ? tree->items[node->first + i] : node->first + i;
    }
}

/* Return the member with the largest box that can be split without there being too many; -1: none.
 */
static int widest(const BoxTree *tree, const Brood *brood)
{
    int best = -1;
    double best_area = -1;
    for (int k = 0; k < brood->count; k++) {
        if (brood->is_box[k])
            continue;
        const BoxNode *node = &tree->nodes[brood->what[k]];
        int more = node->count ? (int)node->count - 1 : 1;
        double area = bound_half_area(node->box);
        /* The root is split even if its area is no number: it must not hold itself. */
        if (brood->count + more <= BLOCK && (best < 0 || area > best_area)) {
            best = k;
            best_area = area;
        }
    }
    return best;
}

static void build_node(Builder *b, uint32_t at, uint32_t root)
{
    Brood brood = {.what = {root}, .count = 1};
    for (int k; (k = widest(b->tree, &brood)) >= 0;)
        split_member(b->tree, &brood, k);
    for (int k = 0; k < BLOCK; k++) {
        IndexNode *node = &b->nodes[at];
        bool is_box = k < brood.count && brood.is_box[k];
        Bound box = k >= brood.count ? BOUND_EMPTY
                    : is_box         ? b->boxes[brood.what[k]]
                                     : b->tree->nodes[brood.what[k]].box;
        block_set(&node->boxes, k, &box);
        node->is_child[k] = is_box;
        if (is_box)
            node->what[k] = b->numbers[brood.what[k]];
        else if (k < brood.count)
            build_node(b, node->what[k] = b->node_count++, brood.what[k]);
    }
}

/* Sort the children into those in the tree, whose boxes these are, and the others. */
typedef struct Sorted {
    Bound *boxes;
    uint32_t *in_tree, *plain;
    uint32_t tree_count;
    int plain_count, beyond_count;
} Sorted;

static bool sort_children(Arena *scratch, const Shape *node, Sorted *out)
{
    size_t count = (size_t)node->child_count;
    *out = (Sorted){.boxes = ARENA_ARRAY(scratch, Bound, count),
                    .in_tree = ARENA_ARRAY(scratch, uint32_t, count),
                    .plain = ARENA_ARRAY(scratch, uint32_t, count)};
    if (!out->boxes || !out->in_tree || !out->plain)
        return false;
    for (uint32_t i = 0; i < count; i++) {
        const Shape *child = node->children[i];
        if (!is_in_tree(node, child)) {
            out->plain[out->plain_count++] = i;
            continue;
        }
        out->boxes[out->tree_count] = child->reach;
        out->in_tree[out->tree_count++] = i;
        out->beyond_count += child->is_inside_beyond;
    }
    return true;
}

static void build_in(Arena *arena, Arena *scratch, Shape *node)
{
    Sorted sorted;
    BoxTree tree;
    if (!sort_children(scratch, node, &sorted) || sorted.tree_count < INDEX_MIN ||
        !box_tree_new(scratch, sorted.boxes, sorted.tree_count, &tree))
        return;
    /* Every node but the last ones has four parts, and none has fewer than two. */
    IndexNode *nodes = ARENA_ARRAY(scratch, IndexNode, sorted.tree_count);
    CsgIndex *index = ARENA_NEW(arena, CsgIndex);
    uint32_t *plain = ARENA_ARRAY(arena, uint32_t, (size_t)sorted.plain_count);
    if (!nodes || !index || !plain)
        return;
    Builder b = {&tree, sorted.in_tree, sorted.boxes, nodes, 1};
    build_node(&b, 0, 0);
    if (sorted.plain_count)
        memcpy(plain, sorted.plain, (size_t)sorted.plain_count * sizeof *plain);
    *index = (CsgIndex){arena_copy(arena, nodes, b.node_count * sizeof *nodes), plain,
                        sorted.plain_count, sorted.beyond_count};
    node->index = index->nodes ? index : NULL;
}

void index_build(Arena *arena, Shape *node)
{
    node->index = NULL;
    if (node->child_count < INDEX_MIN)
        return;
    Arena *scratch = arena_new();
    if (scratch)
        build_in(arena, scratch, node);
    arena_free(scratch);
}

/* --- walking ---------------------------------------------------------------------------------- */

static bool push_entry(ShapeScratch *scratch, const IndexEntry *entry)
{
    if (scratch->entry_count == scratch->entry_capacity) {
        void *entries = scratch->entries;
        if (mem_grow(&entries, scratch->entry_capacity, &scratch->entry_capacity, sizeof *entry)) {
            scratch->is_overflown = true;
            return false;
        }
        scratch->entries = entries;
    }
    scratch->entries[scratch->entry_count++] = *entry;
    return true;
}

void index_open(const IndexNode *node, const Line *line, ShapeScratch *scratch)
{
    BlockCut cut;
    block_cut(&node->boxes, line, &cut);
    for (int k = 0; k < BLOCK; k++)
        if (cut.near[k] <= cut.far[k])
            push_entry(scratch, &(IndexEntry){cut.near[k], node->what[k], node->is_child[k]});
}

void index_meet(const CsgIndex *index, const Line *line, ShapeScratch *scratch)
{
    /* Children are moved to the front of the stack as they are found, and nodes are opened at its
     * end until none is left. */
    size_t kept = scratch->entry_count;
    index_open(index->nodes, line, scratch);
    while (scratch->entry_count > kept) {
        IndexEntry entry = scratch->entries[scratch->entry_count - 1];
        if (entry.is_child) {
            scratch->entries[scratch->entry_count - 1] = scratch->entries[kept];
            scratch->entries[kept++] = entry;
            continue;
        }
        scratch->entry_count--;
        index_open(&index->nodes[entry.what], line, scratch);
    }
}

/* --- points ----------------------------------------------------------------------------------- */

/* What is known of the children in the tree, at a point. */
typedef struct Holders {
    const Shape *node;
    V3 p;
    int beyond_met; /* children that are inside beyond their boxes, but whose boxes hold p */
    bool is_all;    /* asked: inside all of them? */
    bool is_known;  /* one decides it */
} Holders;

static void ask_node(Holders *h, uint32_t at)
{
    const IndexNode *node = &h->node->index->nodes[at];
    for (int k = 0; k < BLOCK && !h->is_known; k++) {
        bool is_held = true;
        for (int axis = 0; axis < 3; axis++)
            is_held &= v3_at(h->p, axis) >= node->boxes.lo[axis][k] &&
                       v3_at(h->p, axis) <= node->boxes.hi[axis][k];
        if (!is_held)
            continue;
        if (!node->is_child[k]) {
            ask_node(h, node->what[k]);
            continue;
        }
        const Shape *child = h->node->children[node->what[k]];
        h->beyond_met += child->is_inside_beyond;
        h->is_known = shape_is_inside(child, h->p) != h->is_all;
    }
}

bool index_holds(const Shape *node, V3 p, bool is_all)
{
    const CsgIndex *index = node->index;
    for (int i = 0; i < index->plain_count; i++)
        if (shape_is_inside(node->children[index->plain[i]], p) != is_all)
            return !is_all;
    Holders h = {.node = node, .p = p, .is_all = is_all};
    ask_node(&h, 0);
    if (h.is_known)
        return !is_all;
    return is_all || h.beyond_met < index->beyond_count;
}
