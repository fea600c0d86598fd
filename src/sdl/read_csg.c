/* union, merge, intersection, difference; clipped_by and bounded_by.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/read_int.h"

typedef struct NodeList {
    Node **items;
    size_t count, capacity;
    int depth; /* of the deepest item */
    long size; /* of all items */
} NodeList;

/* Read objects as long as there are any. */
static NodeList read_objects(Parser *p)
{
    NodeList list = {0};
    for (Node *node; (node = read_object(p));) {
        list.items = read_grow(p, list.items, list.count, &list.capacity, sizeof *list.items);
        list.items[list.count++] = node;
        if (node->depth > list.depth)
            list.depth = node->depth;
        list.size += node->size;
        if (list.depth >= NODE_DEPTH_MAX)
            parse_fail(p, node->span, "objects nest too deep (limit %d)", NODE_DEPTH_MAX);
    }
    return list;
}

static Node *csg_node(Parser *p, ShapeKind kind, NodeList list)
{
    Node *node = parse_alloc(p, sizeof *node);
    node->kind = NODE_CSG;
    node->csg = kind;
    node->children = list.items;
    node->child_count = (int)list.count;
    node->depth = list.depth + 1;
    node->size = list.size + 1;
    return node;
}

static Node *read_csg(Parser *p, ShapeKind kind, const char *word)
{
    Span brace = parse_last_span(p);
    NodeList list = read_objects(p);
    if (list.count < 2)
        parse_warn(p, WARN_LANGUAGE, brace, "%s wants at least two objects, found %d", word,
                   (int)list.count);
    return csg_node(p, kind, list);
}

/* A sheet has no inside: what CSG keeps of it is rarely what its author means. */
static void warn_sheets(Parser *p, const Node *node, const char *word)
{
    for (int i = 0; i < node->child_count; i++)
        if (!node_is_solid(node->children[i]))
            parse_warn(p, WARN_GEOMETRY, node->children[i]->span,
                       "an object without an inside in %s", word);
}

Node *read_union(Parser *p)
{
    return read_csg(p, SHAPE_UNION, "a union");
}

Node *read_merge(Parser *p)
{
    return read_csg(p, SHAPE_MERGE, "a merge");
}

Node *read_intersection(Parser *p)
{
    Node *node = read_csg(p, SHAPE_INTERSECTION, "an intersection");
    warn_sheets(p, node, "an intersection");
    return node;
}

Node *read_difference(Parser *p)
{
    Node *node = read_csg(p, SHAPE_INTERSECTION, "a difference");
    warn_sheets(p, node, "a difference");
    node->is_difference = true;
    for (int i = 1; i < node->child_count; i++)
        node_invert(node->children[i]);
    return node;
}

/* --- clipped_by, bounded_by ---------------------------------------------------------------- */

/* Copy a list of nodes: each transform of the object moves both lists. */
static Node **copy_nodes(Parser *p, Node *const *from, int count)
{
    Node **nodes = parse_alloc(p, (size_t)count * sizeof *nodes);
    for (int i = 0; i < count; i++)
        nodes[i] = parse_no_null(p, node_copy(parse_arena(p), from[i]));
    return nodes;
}

/* Read objects and the transforms that follow them, up to and including the brace. */
static NodeList read_region(Parser *p, const char *where)
{
    NodeList list = read_objects(p);
    while (!read_close(p)) {
        if (!parse_is_xform(p))
            parse_fail_here(p, where);
        Xform xform = parse_xform(p);
        for (size_t i = 0; i < list.count; i++)
            if (!node_transform(parse_arena(p), list.items[i], &xform))
                parse_no_null(p, NULL);
    }
    return list;
}

/* Append to the clips or bounds of `owner`, whose depth and size grow with them. */
static void append_nodes(Parser *p, Node *owner, Node ***nodes, int *count, Node **more,
                         size_t more_count)
{
    size_t old = (size_t)*count;
    Node **all = parse_alloc(p, (old + more_count) * sizeof *all);
    for (size_t i = 0; i < old; i++)
        all[i] = (*nodes)[i];
    for (size_t i = 0; i < more_count; i++)
        all[old + i] = more[i];
    for (size_t i = 0; i < more_count; i++) {
        owner->size += more[i]->size;
        if (more[i]->depth + 1 > owner->depth)
            owner->depth = more[i]->depth + 1;
    }
    *nodes = all;
    *count = (int)(old + more_count);
}

static bool has_texture(const Node *node)
{
    if (node->texture)
        return true;
    for (int i = 0; i < node->child_count; i++)
        if (has_texture(node->children[i]))
            return true;
    return false;
}

void read_clipped_by(Parser *p, Node *node)
{
    read_open(p);
    if (parse_accept(p, KW_BOUNDED_BY)) {
        parse_expect(p, TOKEN_RBRACE, "bounded_by");
        append_nodes(p, node, &node->clips, &node->clip_count,
                     copy_nodes(p, node->bounds, node->bound_count), (size_t)node->bound_count);
    } else {
        NodeList list = read_region(p, "in clipped_by");
        append_nodes(p, node, &node->clips, &node->clip_count, list.items, list.count);
    }
    for (int i = 0; i < node->clip_count; i++) {
        const Node *clip = node->clips[i];
        if (clip->kind == NODE_LIGHT || !node_is_solid(clip))
            parse_fail(p, clip->span, "clipped_by wants objects that have an inside");
        if (has_texture(clip))
            parse_fail(p, clip->span, "objects in clipped_by may have no texture");
    }
}

void read_bounded_by(Parser *p, Node *node)
{
    read_open(p);
    if (parse_accept(p, KW_CLIPPED_BY)) {
        parse_expect(p, TOKEN_RBRACE, "clipped_by");
        append_nodes(p, node, &node->bounds, &node->bound_count,
                     copy_nodes(p, node->clips, node->clip_count), (size_t)node->clip_count);
        return;
    }
    NodeList list = read_region(p, "in bounded_by");
    append_nodes(p, node, &node->bounds, &node->bound_count, list.items, list.count);
}
