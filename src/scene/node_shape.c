/* The shapes of nodes alone, without looks.  SPDX-License-Identifier: Apache-2.0 */
#include "scene/node.h"

static void set_surface(Shape *shape, uint32_t surface)
{
    shape->surface = surface;
    for (int i = 0; i < shape->child_count; i++)
        set_surface(shape->children[i], surface);
}

bool node_add_clips(Arena *arena, const Node *node, Shape *shape, uint32_t surface)
{
    if (node->clip_count == 0)
        return true;
    shape->clips = ARENA_ARRAY(arena, Shape *, (size_t)node->clip_count);
    if (!shape->clips)
        return false;
    for (int i = 0; i < node->clip_count; i++) {
        Shape *clip = node_shape(arena, node->clips[i]);
        if (!clip)
            return false;
        set_surface(clip, surface);
        shape->clips[shape->clip_count++] = clip;
    }
    return true;
}

static Shape *csg_of(Arena *arena, const Node *node)
{
    Shape **children = ARENA_ARRAY(arena, Shape *, (size_t)node->child_count);
    int used = 0;
    for (int i = 0; children && i < node->child_count; i++)
        if (node->children[i]->kind != NODE_LIGHT &&
            !(children[used++] = node_shape(arena, node->children[i])))
            return NULL;
    Shape *shape = children ? shape_csg(arena, node->csg, children, used) : NULL;
    if (shape && node->is_inverted)
        shape_invert(shape);
    return shape;
}

Shape *node_shape(Arena *arena, const Node *node)
{
    Shape *shape = node->kind == NODE_CSG ? csg_of(arena, node) : node->shape;
    return shape && node_add_clips(arena, node, shape, 0) ? shape : NULL;
}
