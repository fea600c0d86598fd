/* Trees of CSG made flat: nodes dissolve in nodes of their own kind.  So a solid cut again and
 * again, one difference in the other, is one list of cutters, which an index finds its way in.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape_int.h"

static bool is_dissolved(const Shape *node, const Shape *child)
{
    return child->kind == node->kind && child->clip_count == 0;
}

void csg_flatten(Arena *arena, Shape *node)
{
    size_t count = 0;
    bool is_flat = true;
    for (int i = 0; i < node->child_count; i++) {
        Shape *child = node->children[i];
        if (child->kind >= SHAPE_UNION)
            csg_flatten(arena, child);
        bool is_part = is_dissolved(node, child);
        count += is_part ? (size_t)child->child_count : 1;
        is_flat &= !is_part;
    }
    if (is_flat || count > INT32_MAX)
        return;
    Shape **all = ARENA_ARRAY(arena, Shape *, count);
    if (!all)
        return;
    int next = 0;
    for (int i = 0; i < node->child_count; i++) {
        Shape *child = node->children[i];
        bool is_part = is_dissolved(node, child);
        for (int k = 0; is_part && k < child->child_count; k++)
            all[next++] = child->children[k];
        if (!is_part)
            all[next++] = child;
    }
    node->children = all;
    node->child_count = next;
}
