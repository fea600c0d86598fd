/* Making shapes and changing them.  SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape_int.h"

bool xform_is_plain(const Xform *x)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (i == j ? !(x->to[i][j] > 0) : x->to[i][j] != 0)
                return false;
    return true;
}

static bool is_uniform(const Xform *x)
{
    return x->to[0][0] == x->to[1][1] && x->to[1][1] == x->to[2][2];
}

/* Is this nothing, or a scaling by a power of two alone?  Then no number of it is rounded. */
static bool is_exact(const Xform *x)
{
    int exponent;
    return xform_is_plain(x) && is_uniform(x) && frexp(x->to[0][0], &exponent) == 0.5 &&
           x->to[0][3] == 0 && x->to[1][3] == 0 && x->to[2][3] == 0;
}

/* Derive what a leaf's numbers say about their own rounding. */
static void derive_rounding(Shape *s)
{
    const Xform *x = &s->xform;
    ShapeRounding *r = &s->rounding;
    r->row = v3(v3_len(v3(x->from[0][0], x->from[0][1], x->from[0][2])),
                v3_len(v3(x->from[1][0], x->from[1][1], x->from[1][2])),
                v3_len(v3(x->from[2][0], x->from[2][1], x->from[2][2])));
    r->offset = v3(fabs(x->from[0][3]), fabs(x->from[1][3]), fabs(x->from[2][3]));
    r->column = v3(v3_len(v3(x->to[0][0], x->to[1][0], x->to[2][0])),
                   v3_len(v3(x->to[0][1], x->to[1][1], x->to[2][1])),
                   v3_len(v3(x->to[0][2], x->to[1][2], x->to[2][2])));
    const ShapeOps *ops = shape_ops(s);
    r->place = ops->size ? PLACE_EPS * ops->size(s) : 0;
    r->is_exact = is_exact(x);
}

Shape *leaf_new(Arena *arena, ShapeKind kind)
{
    Shape *shape = ARENA_NEW(arena, Shape);
    if (shape) {
        shape->kind = kind;
        shape->xform = XFORM_IDENTITY;
    }
    return shape;
}

void leaf_place(Shape *shape, const Xform *xform)
{
    shape->xform = *xform;
    shape->is_transformed = !xform_is_identity(xform);
    derive_rounding(shape);
}

Shape *shape_csg(Arena *arena, ShapeKind kind, Shape **children, int child_count)
{
    Shape *shape = leaf_new(arena, kind);
    if (!shape)
        return NULL;
    shape->children = children;
    shape->child_count = child_count;
    return shape;
}

bool xform_keeps_normals(const Xform *x)
{
    return xform_is_plain(x) && is_uniform(x);
}

V3 turn_normal(V3 n, const Xform *x)
{
    return xform_keeps_normals(x) ? n : v3_unit(xform_normal(x, n));
}

static void transform_leaf(Shape *shape, const Xform *x)
{
    const ShapeOps *ops = shape_ops(shape);
    Xform placed = shape->xform;
    if (!ops->transform || !ops->transform(shape, x))
        placed = xform_then(&shape->xform, x);
    leaf_place(shape, &placed);
}

void shape_transform(Shape *shape, const Xform *xform)
{
    shape->is_finished = false;
    if (shape->kind < SHAPE_UNION)
        transform_leaf(shape, xform);
    for (int i = 0; i < shape->child_count; i++)
        shape_transform(shape->children[i], xform);
    for (int i = 0; i < shape->clip_count; i++)
        shape_transform(shape->clips[i], xform);
}

static Shape **copy_list(Arena *arena, Shape *const *list, int count)
{
    Shape **out = ARENA_ARRAY(arena, Shape *, (size_t)count);
    for (int i = 0; out && i < count; i++) {
        out[i] = shape_copy(arena, list[i]);
        if (!out[i])
            return NULL;
    }
    return out;
}

Shape *shape_copy(Arena *arena, const Shape *shape)
{
    Shape *copy = arena_copy(arena, shape, sizeof *shape);
    if (!copy)
        return NULL;
    if (shape->child_count) {
        copy->children = copy_list(arena, shape->children, shape->child_count);
        if (!copy->children)
            return NULL;
    }
    if (shape->clip_count) {
        copy->clips = copy_list(arena, shape->clips, shape->clip_count);
        if (!copy->clips)
            return NULL;
    }
    return copy;
}

void shape_invert(Shape *shape)
{
    shape->is_finished = false;
    if (shape->kind < SHAPE_UNION) {
        shape->is_inverted = !shape->is_inverted;
        return;
    }
    /* The complement of a union is what the complements share, and the other way round. */
    shape->kind = shape->kind == SHAPE_INTERSECTION ? SHAPE_MERGE : SHAPE_INTERSECTION;
    for (int i = 0; i < shape->child_count; i++)
        shape_invert(shape->children[i]);
}

/* Pack the reaches of a node's children; returns NULL when there are none or memory is out. */
static const ReachBlock *pack_reaches(Arena *arena, const Shape *node)
{
    if (node->child_count == 0 || node->index)
        return NULL;
    int blocks = (node->child_count + BLOCK - 1) / BLOCK;
    ReachBlock *out = ARENA_ARRAY(arena, ReachBlock, (size_t)blocks);
    for (int i = 0; out && i < blocks * BLOCK; i++) {
        ReachBlock *block = &out[i / BLOCK];
        Bound reach = i < node->child_count ? node->children[i]->reach : BOUND_EMPTY;
        block_set(&block->boxes, i % BLOCK, &reach);
        if (i < node->child_count)
            block->is_inside_beyond[i % BLOCK] = node->children[i]->is_inside_beyond;
    }
    return out;
}

/* shape_finish for a flat tree, or a part of one. */
static void finish(Arena *arena, Shape *shape)
{
    for (int i = 0; i < shape->child_count; i++)
        finish(arena, shape->children[i]);
    for (int i = 0; i < shape->clip_count; i++)
        shape_finish(arena, shape->clips[i]);
    shape->reach = shape_reach(shape, &shape->is_inside_beyond);
    shape->is_bounded =
        shape->kind < SHAPE_UNION && bound_is_finite(shape_ops(shape)->bound(shape));
    index_build(arena, shape);
    shape->reaches = pack_reaches(arena, shape);
    shape->is_convex_leaf = shape_is_convex_leaf(shape);
    shape->convex_count = 0;
    for (int i = 0; i < shape->child_count; i++)
        shape->convex_count += shape->children[i]->is_convex_leaf;
    convex_pack_planes(arena, shape);
    shape->is_finished = true;
}

void shape_finish(Arena *arena, Shape *shape)
{
    if (shape->kind >= SHAPE_UNION)
        csg_flatten(arena, shape);
    finish(arena, shape);
}
