/* Planes of an intersection, packed for convex_core: in blocks, and of many a tree over these.
 *
 * A node of the tree knows a cone around the normals of its planes, and the least of their
 * distances.  So it tells of a point that it is inside all of them.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape_int.h"

#include <stdlib.h>

/* Fewer planes have no tree. */
enum { TREE_MIN = 200, LEAF_PLANES = 2 * BLOCK };

typedef struct Item {
    double key;
    int child;
} Item;

typedef struct Packer {
    const Shape *node;
    Item *items;
    PlaneBlock *blocks;
    PlaneNode *nodes;
    uint32_t node_count;
} Packer;

static bool is_packable(const Shape *shape)
{
    return shape->is_convex_leaf && shape->kind == SHAPE_PLANE;
}

/* Return a plane's normal, turned so that the inside is n . p < d. */
static V3 normal_of(const Shape *plane)
{
    return plane->is_inverted ? v3_neg(plane->u.plane.normal) : plane->u.plane.normal;
}

static double distance_of(const Shape *plane)
{
    return plane->is_inverted ? -plane->u.plane.distance : plane->u.plane.distance;
}

/* Fill a block with items [first, first + count); the last one fills it up. */
static void fill_block(const Packer *p, PlaneBlock *block, int first, int count)
{
    for (int k = 0; k < BLOCK; k++) {
        int child = p->items[first + (k < count ? k : count - 1)].child;
        const Shape *leaf = p->node->children[child];
        for (int axis = 0; axis < 3; axis++)
            block->n[axis][k] = v3_at(normal_of(leaf), axis);
        block->d[k] = distance_of(leaf);
        block->place[k] = leaf->rounding.place;
        block->turn_doubt[k] = leaf->u.plane.turn_doubt;
        block->child[k] = child;
    }
}

static int by_key(const void *a, const void *b)
{
    const Item *x = a, *y = b;
    if (x->key != y->key)
        return x->key < y->key ? -1 : 1;
    return x->child < y->child ? -1 : x->child > y->child;
}

/* Sort items along the axis on which their normals differ most. */
static void sort_items(const Packer *p, const Bound *normals, int first, int count)
{
    V3 size = v3_sub(normals->hi, normals->lo);
    int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    for (int i = first; i < first + count; i++)
        p->items[i].key = v3_at(normal_of(p->node->children[p->items[i].child]), axis);
    qsort(p->items + first, (size_t)count, sizeof *p->items, by_key);
}

/* Put a cone around the normals of items; *normals: the box around them. */
static void enclose(const Packer *p, PlaneNode *node, int first, int count, Bound *normals)
{
    *normals = BOUND_EMPTY;
    for (int i = first; i < first + count; i++)
        *normals = bound_add(*normals, normal_of(p->node->children[p->items[i].child]));
    node->axis = v3_unit(bound_center(*normals));
    node->cosine = v3_len2(node->axis) > 0 ? 1 : -1;
    for (int i = first; i < first + count; i++) {
        V3 n = normal_of(p->node->children[p->items[i].child]);
        node->cosine = num_min(node->cosine, v3_dot(node->axis, n) - 16 * EPS_DOUBLE);
    }
    node->cosine = num_max(node->cosine, -1);
    node->sine = sqrt(1 - node->cosine * node->cosine);
}

/* Make the node of items [first, first + count), first a multiple of BLOCK, and those below it. */
static void pack_tree(Packer *p, int first, int count)
{
    PlaneNode *node = &p->nodes[p->node_count++];
    Bound normals;
    *node = (PlaneNode){.d = INFINITY,
                        .first = (uint32_t)(first / BLOCK),
                        .count = (uint32_t)((count + BLOCK - 1) / BLOCK)};
    for (int i = first; i < first + count; i++) {
        const Shape *leaf = p->node->children[p->items[i].child];
        node->d = num_min(node->d, distance_of(leaf));
        node->place = num_max(node->place, leaf->rounding.place);
        node->turn_doubt = num_max(node->turn_doubt, leaf->u.plane.turn_doubt);
    }
    enclose(p, node, first, count, &normals);
    if (count <= LEAF_PLANES)
        return;
    sort_items(p, &normals, first, count);
    int left = (count / 2 + BLOCK - 1) / BLOCK * BLOCK;
    pack_tree(p, first, left);
    node->right = p->node_count;
    pack_tree(p, first + left, count - left);
}

static bool pack(Packer *p, Arena *arena, int planes, int blocks)
{
    int next = 0;
    for (int i = 0; i < p->node->child_count; i++)
        if (is_packable(p->node->children[i]))
            p->items[next++].child = i;
    if (planes >= TREE_MIN) {
        p->nodes = ARENA_ARRAY(arena, PlaneNode, (size_t)blocks * 2);
        if (!p->nodes)
            return false;
        pack_tree(p, 0, planes);
    }
    for (int i = 0; i < blocks; i++)
        fill_block(p, &p->blocks[i], i * BLOCK, i < blocks - 1 ? BLOCK : planes - i * BLOCK);
    return true;
}

void convex_pack_planes(Arena *arena, Shape *node)
{
    node->planes = NULL;
    node->plane_tree = NULL;
    node->plane_blocks = node->plane_count = 0;
    for (int i = 0; i < node->child_count; i++)
        node->plane_count += is_packable(node->children[i]);
    if (node->kind != SHAPE_INTERSECTION || node->plane_count < 2)
        return;
    int blocks = (node->plane_count + BLOCK - 1) / BLOCK;
    Packer p = {.node = node,
                .items = ARENA_ARRAY(arena, Item, (size_t)node->plane_count),
                .blocks = ARENA_ARRAY(arena, PlaneBlock, (size_t)blocks)};
    if (!p.items || !p.blocks || !pack(&p, arena, node->plane_count, blocks))
        return;
    node->planes = p.blocks;
    node->plane_tree = p.nodes;
    node->plane_blocks = blocks;
}
