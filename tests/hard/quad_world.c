/* One of the two worlds of quad_world.h: which, the compiler's options say (quad_real.h).
 * SPDX-License-Identifier: Apache-2.0 */
#include "quad_world.h"
#include "quad_shapes.h"

#include <stdlib.h>

struct Model {
    ShapeKit kit;
    ShapeScratch *scratch;
    const Shape *leaf[MODEL_LEAVES_MAX];
    int leaf_count;
    Plain3 mark[MODEL_MARKS_MAX];
};

static V3 narrow(Quad3 a)
{
    return v3((double)a.x, (double)a.y, (double)a.z);
}

static Quad3 widen(V3 a)
{
    return (Quad3){a.x, a.y, a.z};
}

static Plain3 plain(V3 a)
{
    return (Plain3){(Plain)a.x, (Plain)a.y, (Plain)a.z};
}

static const char *world_name(int which)
{
    const ShapeCase *of = shape_case(which);
    return of ? of->name : NULL;
}

static bool world_may_skip(int which)
{
    return shape_case(which)->may_skip;
}

static void world_free(Model *model)
{
    if (!model)
        return;
    shape_kit_done(&model->kit);
    shape_scratch_free(model->scratch);
    arena_free(model->kit.arena);
    free(model);
}

/* Number the leaves in the order they are written. */
static void number_leaves(Model *model, Shape *shape)
{
    if (shape->child_count == 0 && model->leaf_count < MODEL_LEAVES_MAX) {
        shape->surface = (uint32_t)model->leaf_count;
        model->leaf[model->leaf_count++] = shape;
    }
    for (int i = 0; i < shape->child_count; i++)
        number_leaves(model, shape->children[i]);
}

static Model *world_make(int which, uint64_t seed)
{
    Model *model = calloc(1, sizeof *model);
    if (!model)
        return NULL;
    model->kit.arena = arena_new();
    model->kit.rng = rng_at(seed, (uint32_t)which, 0);
    model->scratch = shape_scratch_new();
    Shape *shape = NULL;
    if (model->kit.arena && model->scratch)
        shape = shape_kit_make(&model->kit, shape_case(which));
    if (!shape) {
        world_free(model);
        return NULL;
    }
    number_leaves(model, shape);
    for (int i = 0; i < model->kit.mark_count; i++)
        model->mark[i] = plain(xform_point(&model->kit.place, model->kit.mark[i]));
    return model;
}

static void world_bound(const Model *model, Plain3 *lo, Plain3 *hi)
{
    Bound b = shape_bound(model->kit.shape);
    *lo = plain(b.lo);
    *hi = plain(b.hi);
}

static int world_marks(const Model *model, const Plain3 **out)
{
    *out = model->mark;
    return model->kit.mark_count;
}

static Plain3 world_turn(const Model *model, Plain3 d)
{
    return plain(v3_unit(xform_dir(&model->kit.place, v3(d.x, d.y, d.z))));
}

static void tell(const Crossing *c, const Ray *ray, Meeting *out)
{
    ShapePoint point;
    shape_point(c, ray, &point);
    *out = (Meeting){.t = c->t,
                     .t_error = c->t_error,
                     .u = c->u,
                     .v = c->v,
                     .p = widen(point.p),
                     .n = widen(point.ng),
                     .p_error = point.p_error,
                     .leaf = (int)c->leaf->surface,
                     .part = c->part,
                     .change = c->change,
                     .is_visible = c->is_visible,
                     .is_flipped = c->is_flipped};
}

static int world_meet(Model *model, Quad3 o, Quad3 d, bool *is_inside_before, Meeting *out,
                      int capacity)
{
    Ray ray = {narrow(o), narrow(d), -INFINITY, INFINITY};
    CrossList list;
    shape_crossings(model->kit.shape, &ray, model->scratch, &list);
    *is_inside_before = list.is_inside_before;
    for (int i = 0; i < list.count && i < capacity; i++)
        tell(&list.items[i], &ray, &out[i]);
    return list.count;
}

static bool world_closest(Model *model, Quad3 o, Quad3 d, Meeting *out)
{
    Ray ray = {narrow(o), narrow(d), 0, INFINITY};
    Crossing crossing;
    if (!shape_closest(model->kit.shape, &ray, model->scratch, &crossing))
        return false;
    tell(&crossing, &ray, out);
    return true;
}

static void world_pull(const Model *model, Quad3 p, Meeting *at)
{
    /* A ray that starts there. */
    Ray ray = {narrow(p), v3(0, 0, 1), -INFINITY, INFINITY};
    Crossing crossing = {.leaf = model->leaf[at->leaf],
                         .part = at->part,
                         .t_error = (double)at->t_error,
                         .u = (double)at->u,
                         .v = (double)at->v,
                         .is_visible = true,
                         .is_flipped = at->is_flipped};
    ShapePoint point;
    shape_point(&crossing, &ray, &point);
    at->p = widen(point.p);
    at->n = widen(point.ng);
    at->p_error = point.p_error;
}

static bool world_is_inside(const Model *model, Quad3 p)
{
    return shape_is_inside(model->kit.shape, narrow(p));
}

#ifdef PMS_QUAD
#define WORLD quad_world
#else
#define WORLD double_world
#endif

const World WORLD = {
    .name = world_name,
    .may_skip = world_may_skip,
    .make = world_make,
    .free = world_free,
    .bound = world_bound,
    .marks = world_marks,
    .turn = world_turn,
    .meet = world_meet,
    .closest = world_closest,
    .pull = world_pull,
    .is_inside = world_is_inside,
};
