/* Asking shapes: the questions of shape.h, handed to the file of each kind.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape_int.h"

#include "base/mem.h"

const ShapeOps *shape_ops(const Shape *leaf)
{
    static const ShapeOps *const table[] = {
#define LEAF(id, ops, is_solid, is_closed) [id] = &(ops),
#define NODE(id)
#include "shape/shape.def"
#undef LEAF
#undef NODE
    };
    return table[leaf->kind];
}

void leaf_hits(const Shape *shape, const Ray *ray, LeafHits *out)
{
    LocalRay local;
    local_ray(shape, ray, &local);
    shape_ops(shape)->hits(shape, &local, out);
}

/* Where a line nearly touches a part, how far the surface may be off, over the slope, is no bound
 * worth having: without end it would make one event of all that is on the line.  But a short chord
 * is that of a parabola, which when it is moved by as much changes its ends by less. */
static void bound_touching(Crossing *items, int count)
{
    for (int i = 0; i + 1 < count; i++) {
        Crossing *a = &items[i], *b = a + 1;
        double half = 0.5 * (b->t - a->t);
        if (a->part != b->part || a->change + b->change != 0 || !(half > 0))
            continue;
        if (a->t_error > 4 * half)
            a->t_error = half + sqrt(half * (half + 2 * a->t_error));
        if (b->t_error > 4 * half)
            b->t_error = half + sqrt(half * (half + 2 * b->t_error));
    }
}

bool leaf_list(const Shape *shape, const Line *line, ShapeScratch *scratch)
{
    const ShapeOps *ops = shape_ops(shape);
    int base = scratch->count;
    bool is_inside = false;
    if (ops->list) {
        is_inside = ops->list(shape, line, scratch);
    } else {
        Crossing crossing;
        LeafHits hits;
        leaf_hits(shape, line->ray, &hits);
        is_inside = hits.is_inside_before;
        for (int i = 0; i < hits.count; i++) {
            crossing_fill(shape, &hits.at[i], &crossing);
            scratch_push(scratch, &crossing);
        }
    }
    bound_touching(scratch->items + base, scratch->count - base);
    return is_inside;
}

bool hits_closest(const Shape *leaf, const LeafHits *hits, const Ray *ray, Crossing *out)
{
    for (int i = 0; i < hits->count; i++) {
        const LeafHit *hit = &hits->at[i];
        if (hit->t > ray->tmin && hit->t < ray->tmax && hit->is_visible) {
            crossing_fill(leaf, hit, out);
            return true;
        }
    }
    return false;
}

Line scratch_line(const Ray *ray, double near, double far, ShapeScratch *scratch)
{
    scratch->count = 0;
    scratch->slot_count = scratch->entry_count = 0;
    scratch->is_overflown = false;
    return (Line){ray, v3(1 / ray->d.x, 1 / ray->d.y, 1 / ray->d.z), near, far, false};
}

/* Take the first visible crossing of the list with tmin < t < tmax. */
static bool first_of_list(const ShapeScratch *scratch, const Ray *ray, Crossing *out)
{
    for (int i = 0; i < scratch->count; i++) {
        const Crossing *c = &scratch->items[i];
        if (c->is_visible && c->t > ray->tmin && c->t < ray->tmax) {
            *out = *c;
            return true;
        }
    }
    return false;
}

static bool list_closest(const Shape *shape, const Ray *ray, ShapeScratch *scratch, Crossing *out)
{
    Line line = scratch_line(ray, ray->tmin, ray->tmax, scratch);
    csg_list(shape, &line, scratch);
    return first_of_list(scratch, ray, out);
}

/* The first crossing of a leaf without its clips. */
static bool leaf_closest(const Shape *leaf, const Ray *ray, ShapeScratch *scratch, Crossing *out)
{
    const ShapeOps *ops = shape_ops(leaf);
    LeafHits hits;
    bool is_hit;
    if (ops->closest) {
        is_hit = ops->closest(leaf, ray, scratch, out);
    } else if (ops->hits) {
        leaf_hits(leaf, ray, &hits);
        is_hit = hits_closest(leaf, &hits, ray, out);
    } else {
        Line line = scratch_line(ray, ray->tmin, ray->tmax, scratch);
        line.is_first_only = true;
        if (leaf->is_finished && !line_cut(&line, &leaf->reach))
            return false;
        leaf_list(leaf, &line, scratch);
        is_hit = first_of_list(scratch, ray, out);
    }
    if (is_hit && leaf->is_inverted)
        crossing_invert(out);
    return is_hit;
}

/* The stretch of a line that all clips leave, with room for the errors of its ends, and the part of
 * it that is left for sure. */
typedef struct Clipped {
    double near, far, sure_near, sure_far;
} Clipped;

static void clip_from(Clipped *c, const LeafHit *hit)
{
    c->near = num_max(c->near, hit->t - 2 * hit->t_error);
    c->sure_near = num_max(c->sure_near, hit->t + hit->t_error);
}

static void clip_to(Clipped *c, const LeafHit *hit)
{
    c->far = num_min(c->far, hit->t + 2 * hit->t_error);
    c->sure_far = num_min(c->sure_far, hit->t - hit->t_error);
}

/* Clip by what is convex; false when nothing is left. */
static bool clip_convex(const Shape *clip, const Ray *ray, Clipped *c)
{
    LeafHits hits;
    leaf_hits(clip, ray, &hits);
    for (int i = 0; i < hits.count; i++) {
        bool is_entry = (hits.at[i].change > 0) != clip->is_inverted;
        (is_entry ? clip_from : clip_to)(c, &hits.at[i]);
    }
    return hits.count > 0 || hits.is_inside_before != clip->is_inverted;
}

/* What became of a question that was asked the short way. */
typedef enum Answer { ANSWER_NO, ANSWER_YES, ANSWER_UNSURE } Answer;

/* Find the first crossing of a leaf whose clips are convex: within the stretch they leave.  Next to
 * its ends it takes lists to tell. */
static Answer clipped_closest(const Shape *leaf, const Ray *ray, ShapeScratch *scratch,
                              Crossing *out)
{
    Clipped c = {ray->tmin, ray->tmax, -INFINITY, INFINITY};
    for (int i = 0; i < leaf->clip_count; i++) {
        if (!leaf->clips[i]->is_convex_leaf)
            return ANSWER_UNSURE;
        if (!clip_convex(leaf->clips[i], ray, &c))
            return ANSWER_NO;
    }
    Ray part = {ray->o, ray->d, c.near, c.far};
    if (!(part.tmin < part.tmax) || !leaf_closest(leaf, &part, scratch, out))
        return ANSWER_NO;
    bool is_sure = out->t - out->t_error > c.sure_near && out->t + out->t_error < c.sure_far;
    return is_sure ? ANSWER_YES : ANSWER_UNSURE;
}

bool shape_closest(const Shape *shape, const Ray *ray, ShapeScratch *scratch, Crossing *out)
{
    if (shape->kind >= SHAPE_UNION) {
        bool has_index = shape->is_finished && shape->index && shape->clip_count == 0;
        return (has_index ? csg_first : list_closest)(shape, ray, scratch, out);
    }
    if (shape->clip_count == 0)
        return leaf_closest(shape, ray, scratch, out);
    Answer answer = clipped_closest(shape, ray, scratch, out);
    return answer == ANSWER_UNSURE ? list_closest(shape, ray, scratch, out) : answer == ANSWER_YES;
}

bool shape_is_met(const Shape *shape, const Ray *ray, ShapeScratch *scratch)
{
    Crossing crossing;
    if (shape->kind != SHAPE_SPHERE || shape->clip_count)
        return shape_closest(shape, ray, scratch, &crossing);
    LocalRay local;
    local_ray(shape, ray, &local);
    return sphere_is_met(shape, &local, ray->tmin, ray->tmax);
}

void shape_crossings(const Shape *shape, const Ray *ray, ShapeScratch *scratch, CrossList *out)
{
    Line line = scratch_line(ray, -INFINITY, INFINITY, scratch);
    out->is_inside_before = csg_list(shape, &line, scratch);
    out->items = scratch->items;
    out->count = scratch->count;
    out->is_overflown = scratch->is_overflown;
}

void shape_crossings_ahead(const Shape *shape, const Ray *ray, ShapeScratch *scratch,
                           CrossList *out)
{
    Line line = scratch_line(ray, ray->tmin, ray->tmax, scratch);
    out->is_inside_before = csg_list(shape, &line, scratch);
    int kept = 0;
    for (int i = 0; i < scratch->count; i++) {
        const Crossing *c = &scratch->items[i];
        if (c->is_visible && c->t > ray->tmin && c->t < ray->tmax &&
            (kept == 0 || c->t > scratch->items[kept - 1].t))
            scratch->items[kept++] = *c;
    }
    out->items = scratch->items;
    out->count = kept;
    out->is_overflown = scratch->is_overflown;
}

bool shape_is_solid(const Shape *shape)
{
    static const bool is_solid[SHAPE_COUNT] = {
#define LEAF(id, ops, is_solid, is_closed) [id] = is_solid,
#define NODE(id) [id] = true,
#include "shape/shape.def"
#undef LEAF
#undef NODE
    };
    if (shape->kind == SHAPE_MESH)
        return shape->u.mesh->has_inside;
    return is_solid[shape->kind];
}

bool shape_is_closed(const Shape *leaf)
{
    static const bool is_closed[SHAPE_COUNT] = {
#define LEAF(id, ops, is_solid, is_closed) [id] = is_closed,
#define NODE(id)
#include "shape/shape.def"
#undef LEAF
#undef NODE
    };
    return is_closed[leaf->kind] && !leaf->is_open;
}

static bool leaf_is_inside(const Shape *shape, V3 p)
{
    if (shape->is_transformed)
        p = xform_point_back(&shape->xform, p);
    const ShapeOps *ops = shape_ops(shape);
    return ops->is_inside && ops->is_inside(shape, p);
}

/* Are any (or all) of the parts around p? */
static bool count_inside(Shape *const *parts, int count, V3 p, bool is_all)
{
    for (int i = 0; i < count; i++)
        if (shape_is_inside(parts[i], p) != is_all)
            return !is_all;
    return is_all;
}

/* Is p inside some child of a node, or all of them? */
static bool node_is_inside(const Shape *node, V3 p)
{
    bool is_all = node->kind == SHAPE_INTERSECTION;
    if (node->is_finished && node->index)
        return index_holds(node, p, is_all);
    return count_inside(node->children, node->child_count, p, is_all);
}

bool shape_is_inside(const Shape *shape, V3 p)
{
    if (shape->is_finished && !bound_holds(&shape->reach, p))
        return shape->is_inside_beyond;
    bool is_inside =
        shape->kind < SHAPE_UNION ? leaf_is_inside(shape, p) : node_is_inside(shape, p);
    return is_inside != shape->is_inverted &&
           count_inside(shape->clips, shape->clip_count, p, true);
}

/* Bound how far, in scene units, rounding takes a point from where the shape sees it. */
static double world_error(const Shape *leaf, V3 p, double local_error)
{
    const ShapeRounding *r = &leaf->rounding;
    double size = v3_sum_abs(p);
    V3 local = v3_scale(v3_mad(r->offset, size, r->row), 2 * PLACE_EPS);
    local = v3_add(local, v3(local_error, local_error, local_error));
    return v3_dot(local, r->column) + 4 * EPS_DOUBLE * size;
}

static void to_world(const Shape *leaf, const LocalPoint *local, ShapePoint *out)
{
    out->p = leaf->is_transformed ? xform_point(&leaf->xform, local->p) : local->p;
    out->ng = local->ng;
    out->ns = local->is_smooth ? local->ns : local->ng;
    out->lift = leaf->is_transformed && local->is_smooth ? xform_dir(&leaf->xform, local->lift)
                                                         : local->lift;
    if (leaf->rounding.is_exact) {
        double scale = leaf->xform.to[0][0];
        out->p_error = 2 * scale * local->error + 8 * EPS_DOUBLE * v3_sum_abs(out->p);
        return;
    }
    out->p_error = world_error(leaf, out->p, local->error);
    out->ng = v3_unit(xform_normal(&leaf->xform, out->ng));
    out->ns = local->is_smooth ? v3_unit(xform_normal(&leaf->xform, out->ns)) : out->ng;
}

void shape_point(const Crossing *crossing, const Ray *ray, ShapePoint *out)
{
    const Shape *leaf = crossing->leaf;
    V3 p = ray_at(ray, crossing->t);
    LocalPoint local = {.is_smooth = false};
    if (leaf->is_transformed)
        p = xform_point_back(&leaf->xform, p);
    shape_ops(leaf)->point(leaf, crossing, p, &local);
    to_world(leaf, &local, out);
    out->has_inside = shape_is_solid(leaf);
    if (crossing->is_flipped) {
        out->ng = v3_neg(out->ng);
        out->ns = v3_neg(out->ns);
    }
}

V2 shape_uv(const Shape *leaf, uint32_t part, double u, double v, V3 p)
{
    const ShapeOps *ops = shape_ops(leaf);
    if (!ops->uv)
        return (V2){p.x, p.y}; /* the language's way: the world's x and y */
    return ops->uv(leaf, part, u, v, leaf->is_transformed ? xform_point_back(&leaf->xform, p) : p);
}

ShapeScratch *shape_scratch_new(void)
{
    return mem_alloc(sizeof(ShapeScratch));
}

void shape_scratch_free(ShapeScratch *scratch)
{
    if (!scratch)
        return;
    mem_free(scratch->items);
    mem_free(scratch->slots);
    mem_free(scratch->entries);
    mem_free(scratch->triangles);
    mem_free(scratch->room);
    mem_free(scratch);
}

void scratch_push(ShapeScratch *scratch, const Crossing *crossing)
{
    if ((size_t)scratch->count == scratch->capacity) {
        void *items = scratch->items;
        if (scratch->count >= CROSSINGS_MAX ||
            mem_grow(&items, scratch->capacity, &scratch->capacity, sizeof *crossing)) {
            scratch->is_overflown = true;
            return;
        }
        scratch->items = items;
    }
    scratch->items[scratch->count++] = *crossing;
}

void *scratch_room(ShapeScratch *scratch, size_t size)
{
    while (scratch->room_capacity < size) {
        void *room = scratch->room;
        if (mem_grow(&room, scratch->room_capacity, &scratch->room_capacity, 1)) {
            scratch->is_overflown = true;
            return NULL;
        }
        scratch->room = room;
    }
    return scratch->room;
}
