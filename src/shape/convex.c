/* The convex core of an intersection.
 *
 * What convex solids share along a line is one stretch of it: from the last of their entries to
 * the first of their exits.  No lists and no sorting are needed, and the other children need
 * be asked only about that stretch.  SPDX-License-Identifier: Apache-2.0 */
#include "shape/csg_int.h"

#include <string.h>

/* How many times the error of a plane keeps it from being left out. */
#define CLEARANCE 64.0

bool shape_is_convex_leaf(const Shape *shape)
{
    if (shape->clip_count)
        return false;
    switch (shape->kind) {
    case SHAPE_PLANE:
        return true; /* a half-space either way */
    case SHAPE_SPHERE:
    case SHAPE_BOX:
    case SHAPE_OVUS:
        return !shape->is_inverted;
    case SHAPE_CONE:
        return !shape->is_inverted && !shape->is_open;
    default:
        return false;
    }
}

bool shape_is_convex(const Shape *shape)
{
    if (shape->kind != SHAPE_INTERSECTION)
        return shape_is_convex_leaf(shape);
    bool is_convex = !shape->is_inverted && shape->clip_count == 0;
    for (int i = 0; i < shape->child_count && is_convex; i++)
        is_convex = shape_is_convex(shape->children[i]);
    return is_convex;
}

/* Take a hit as an end of the core if it is further in.  Ends whose errors overlap are one
 * event, which shows the child written first. */
static void move_end(ConvexEnd *end, const Shape *leaf, const LeafHit *hit, int child, int way)
{
    double lo = hit->t - hit->t_error, hi = hit->t + hit->t_error;
    bool is_new = end->child == NO_CONVEX || (way > 0 ? lo > end->hi : hi < end->lo);
    if (is_new) {
        *end = (ConvexEnd){*hit, leaf, lo, hi, child};
        return;
    }
    if (lo > end->hi || hi < end->lo)
        return;
    end->lo = lo < end->lo ? lo : end->lo;
    end->hi = hi > end->hi ? hi : end->hi;
    if (child < end->child) {
        end->hit = *hit;
        end->leaf = leaf;
        end->child = child;
    }
}

/* Is nothing left between the ends on [near, far]? */
static bool is_empty(const ConvexCore *core, double near, double far)
{
    bool has_entry = core->entry.child != NO_CONVEX, has_exit = core->exit.child != NO_CONVEX;
    if ((has_entry && core->entry.lo > far) || (has_exit && core->exit.hi < near))
        return true;
    /* Two faces of one solid may be as near to each other as they like. */
    return has_entry && has_exit && core->exit.lo <= core->entry.hi &&
           core->entry.leaf != core->exit.leaf;
}

/* Cut the core by a leaf; false when the line is outside of it. */
static bool cut_by_leaf(const Shape *node, int child, const Ray *ray, ConvexCore *core)
{
    const Shape *leaf = node->children[child];
    LeafHits hits;
    leaf_hits(leaf, ray, &hits);
    for (int k = 0; k < hits.count; k++) {
        int way = leaf->is_inverted ? -hits.at[k].change : hits.at[k].change;
        move_end(way > 0 ? &core->entry : &core->exit, leaf, &hits.at[k], child, way);
    }
    return hits.count > 0 || hits.is_inside_before != leaf->is_inverted;
}

/* Cut the core by a block of planes: as plane_hits, several at once.  Only those that may move
 * an end are looked at one by one. */
static bool cut_by_planes(const Shape *node, const PlaneBlock *b, const Ray *ray, ConvexCore *core)
{
    const V3 o = ray->o, d = ray->d;
    Lanes x, y, z, distance, place, turn_doubt;
    memcpy(&x, b->n[0], sizeof x);
    memcpy(&y, b->n[1], sizeof y);
    memcpy(&z, b->n[2], sizeof z);
    memcpy(&distance, b->d, sizeof distance);
    memcpy(&place, b->place, sizeof place);
    memcpy(&turn_doubt, b->turn_doubt, sizeof turn_doubt);
    Lanes height = x * o.x + y * o.y + z * o.z - distance;
    Lanes speed = x * d.x + y * d.y + z * d.z, t = -height / speed;
    Lanes at = LANES_ABS(x * o.x) + LANES_ABS(y * o.y) + LANES_ABS(z * o.z);
    Lanes per_t = LANES_ABS(x * d.x) + LANES_ABS(y * d.y) + LANES_ABS(z * d.z);
    Lanes reach = LANES_ABS(t), off = PLANE_EPS * at + turn_doubt * v3_sum_abs(o) + place;
    Lanes speed_off = PLANE_EPS * per_t + turn_doubt * v3_sum_abs(d);
    Lanes room = LANES_ABS(speed) - speed_off;
    Lanes error = (off + reach * speed_off) / room + 2 * EPS_DOUBLE * reach;
    LaneMask is_parallel = ~(room > (PLANE_STEEPNESS - 1) * speed_off);
    double entry = core->entry.child == NO_CONVEX ? -INFINITY : core->entry.lo;
    double exit = core->exit.child == NO_CONVEX ? INFINITY : core->exit.hi;
    LaneMask is_entry = speed < 0;
    /* A line along a plane gives no number here, and is looked at. */
    LaneMask is_idle = (is_entry & (t + error < entry)) | (~is_entry & (t - error > exit));
    is_idle &= ~is_parallel;
    for (int k = 0; k < BLOCK; k++) {
        if (is_idle[k])
            continue;
        if (!isfinite(t[k]) || is_parallel[k]) {
            if (!cut_by_leaf(node, b->child[k], ray, core))
                return false;
            continue;
        }
        const Shape *leaf = node->children[b->child[k]];
        int way = is_entry[k] ? 1 : -1;
        LeafHit hit = {t[k], error[k], 0, (int8_t)(leaf->is_inverted ? -way : way), true};
        move_end(way > 0 ? &core->entry : &core->exit, leaf, &hit, b->child[k], way);
    }
    return true;
}

/* What is looked for: the core on a part of a line. */
typedef struct CoreQuery {
    const Shape *node;
    const Ray *ray;
    double near, far;
    ConvexCore *core;
} CoreQuery;

/* Cut the core by blocks of planes; false when nothing is left. */
static bool cut_by_blocks(const CoreQuery *q, uint32_t first, uint32_t count)
{
    for (uint32_t i = first; i < first + count; i++)
        if (!cut_by_planes(q->node, &q->node->planes[i], q->ray, q->core) ||
            is_empty(q->core, q->near, q->far))
            return false;
    return true;
}

/* The most that n . v can be for the normals of a node. */
static double most_along(const PlaneNode *node, V3 v)
{
    double along = v3_dot(node->axis, v), length2 = v3_len2(v), length = sqrt(length2);
    if (along >= node->cosine * length)
        return length;
    double across2 = length2 - along * along;
    return along * node->cosine + (across2 > 0 ? sqrt(across2) : 0) * node->sine;
}

/* How far the point at t may be outside some plane of a node; below 0: it is inside all, by more
 * than any error. */
static double outside_at(const PlaneNode *node, const Ray *ray, double t)
{
    if (isinf(t)) {
        V3 way = t > 0 ? ray->d : v3_neg(ray->d);
        double doubt = CLEARANCE * (PLANE_EPS + node->turn_doubt) * v3_sum_abs(way);
        return most_along(node, way) + doubt < 0 ? -1 : INFINITY;
    }
    V3 p = v3_mad(ray->o, t, ray->d);
    double size = v3_sum_abs(ray->o) + fabs(t) * v3_sum_abs(ray->d);
    double doubt = (PLANE_EPS + node->turn_doubt) * size + node->place;
    return most_along(node, p) - node->d + CLEARANCE * doubt;
}

/* The same for both ends of the core so far: if they are inside a plane, so is all between them,
 * and the plane does not cut it. */
static double outside_core(const CoreQuery *q, const PlaneNode *node)
{
    const ConvexCore *core = q->core;
    double first = q->near, last = q->far;
    if (core->entry.child != NO_CONVEX)
        first = num_max(first, core->entry.lo);
    if (core->exit.child != NO_CONVEX)
        last = num_min(last, core->exit.hi);
    return num_max(outside_at(node, q->ray, first), outside_at(node, q->ray, last));
}

/* Cut the core by the planes of a tree, those first that the core is most outside of. */
static bool cut_by_tree(const CoreQuery *q)
{
    const PlaneNode *tree = q->node->plane_tree;
    uint32_t stack[PLANE_TREE_DEPTH_MAX], count = 0;
    stack[count++] = 0;
    while (count > 0) {
        const PlaneNode *node = &tree[stack[--count]];
        if (outside_core(q, node) < 0)
            continue;
        if (node->right == 0) {
            if (!cut_by_blocks(q, node->first, node->count))
                return false;
            continue;
        }
        uint32_t left = (uint32_t)(node - tree) + 1, right = node->right;
        bool is_left_first = outside_core(q, &tree[left]) >= outside_core(q, &tree[right]);
        stack[count++] = is_left_first ? right : left;
        stack[count++] = is_left_first ? left : right;
    }
    return true;
}

bool convex_core(const Shape *node, const Ray *ray, double near, double far, ConvexCore *core)
{
    const CoreQuery query = {node, ray, near, far, core};
    core->entry.child = core->exit.child = NO_CONVEX;
    if (node->plane_tree ? !cut_by_tree(&query)
                         : !cut_by_blocks(&query, 0, (uint32_t)node->plane_blocks))
        return false;
    if (node->plane_blocks && node->plane_count == node->convex_count)
        return true;
    /* Convex leaves bound the whole, so that none is in the index. */
    const CsgIndex *index = node->index;
    int count = index ? index->plain_count : node->child_count;
    for (int k = 0; k < count; k++) {
        int i = index ? (int)index->plain[k] : k;
        const Shape *leaf = node->children[i];
        if (!leaf->is_convex_leaf || (node->plane_blocks && leaf->kind == SHAPE_PLANE))
            continue;
        if (!cut_by_leaf(node, i, ray, core) || is_empty(core, near, far))
            return false;
    }
    return true;
}

void convex_push(const ConvexEnd *end, ShapeScratch *scratch)
{
    Crossing crossing;
    crossing_fill(end->leaf, &end->hit, &crossing);
    if (end->leaf->is_inverted)
        crossing_invert(&crossing);
    scratch_push(scratch, &crossing);
}
