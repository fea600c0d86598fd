/* Nodes: copying, moving and inverting what has been read.
 *
 * A declared object is a tree of nodes that each use of its name copies.  Transforms are
 * applied when they are read, to the geometry and to the looks attached so far, so nothing of
 * the written order has to be remembered.  SPDX-License-Identifier: Apache-2.0 */
#include "scene/node.h"

#include "texture/media.h"

/* Many children share one texture or interior: the last answer saves making a copy for each. */
typedef struct Move {
    Arena *arena;
    const Xform *xform;
    const Texture *from, *to;
    const Interior *inside_from, *inside_to;
} Move;

/* --- copying ------------------------------------------------------------------------------- */

static bool copy_list(Arena *arena, Node ***list, int count)
{
    if (count == 0)
        return true;
    Node **copy = ARENA_ARRAY(arena, Node *, (size_t)count);
    if (!copy)
        return false;
    for (int i = 0; i < count; i++) {
        copy[i] = node_copy(arena, (*list)[i]);
        if (!copy[i])
            return false;
    }
    *list = copy;
    return true;
}

Node *node_copy(Arena *arena, const Node *node)
{
    Node *copy = arena_copy(arena, node, sizeof *node);
    if (!copy)
        return NULL;
    if (node->shape && !(copy->shape = shape_copy(arena, node->shape)))
        return NULL;
    if (node->light && !(copy->light = arena_copy(arena, node->light, sizeof *node->light)))
        return NULL;
    if (!copy_list(arena, &copy->children, copy->child_count) ||
        !copy_list(arena, &copy->clips, copy->clip_count) ||
        !copy_list(arena, &copy->bounds, copy->bound_count))
        return NULL;
    return copy;
}

/* --- transforming --------------------------------------------------------------------------- */

static bool move_texture(Move *move, const Texture **texture)
{
    if (!*texture)
        return true;
    if (*texture != move->from) {
        move->from = *texture;
        move->to = texture_transform(move->arena, *texture, move->xform);
    }
    *texture = move->to;
    return move->to != NULL;
}

static bool move_interior(Move *move, const Interior **interior)
{
    if (!*interior)
        return true;
    if (*interior != move->inside_from) {
        move->inside_from = *interior;
        move->inside_to = interior_transform(move->arena, *interior, move->xform);
    }
    *interior = move->inside_to;
    return move->inside_to != NULL;
}

static bool move_part_textures(Move *move, Node *node)
{
    if (node->part_texture_count == 0)
        return true;
    size_t count = (size_t)node->part_texture_count;
    const Texture **moved = ARENA_ARRAY(move->arena, const Texture *, count);
    if (!moved)
        return false;
    for (size_t i = 0; i < count; i++) {
        moved[i] = node->part_textures[i];
        if (!move_texture(move, &moved[i]))
            return false;
    }
    node->part_textures = moved;
    return true;
}

/* Scaling leaves a light's cone, beam and fading as they are: they are not geometry. */
static void move_light(Light *light, const Xform *xform)
{
    light->location = xform_point(xform, light->location);
    light->point_at = xform_point(xform, light->point_at);
    light->direction = v3_unit(v3_sub(light->point_at, light->location));
    light->area.axis1 = xform_dir(xform, light->area.axis1);
    light->area.axis2 = xform_dir(xform, light->area.axis2);
}

static bool move_node(Move *move, Node *node);

static bool move_list(Move *move, Node **list, int count)
{
    for (int i = 0; i < count; i++)
        if (!move_node(move, list[i]))
            return false;
    return true;
}

static bool move_node(Move *move, Node *node)
{
    if (node->shape)
        shape_transform(node->shape, move->xform);
    if (node->light)
        move_light(node->light, move->xform);
    return move_texture(move, &node->texture) && move_texture(move, &node->inner_texture) &&
           move_interior(move, &node->interior) && move_part_textures(move, node) &&
           move_list(move, node->children, node->child_count) &&
           move_list(move, node->clips, node->clip_count) &&
           move_list(move, node->bounds, node->bound_count);
}

bool node_transform(Arena *arena, Node *node, const Xform *xform)
{
    Move move = {.arena = arena, .xform = xform};
    return move_node(&move, node);
}

/* --- inside and outside ----------------------------------------------------------------------- */

void node_invert(Node *node)
{
    if (node->kind == NODE_LEAF)
        shape_invert(node->shape);
    else if (node->kind == NODE_CSG)
        node->is_inverted = !node->is_inverted;
}

bool node_is_solid(const Node *node)
{
    if (node->kind == NODE_LEAF)
        return shape_is_solid(node->shape);
    for (int i = 0; i < node->child_count; i++)
        if (!node_is_solid(node->children[i]))
            return false;
    return true;
}
