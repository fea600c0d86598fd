/* The convex core of an intersection.
 *
 * What convex solids share along a line is one stretch of it: from the last of their entries to
 * the first of their exits.  No lists and no sorting are needed, and the other children need
 * be asked only about that stretch.  SPDX-License-Identifier: Apache-2.0 */
#include "shape/csg_int.h"

#include <string.h>

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

bool convex_core(const Shape *node, const Ray *ray, double near, double far, ConvexCore *core)
{
    core->entry.child = core->exit.child = NO_CONVEX;
    for (int i = 0; i < node->plane_blocks; i++)
        if (!cut_by_planes(node, &node->planes[i], ray, core) || is_empty(core, near, far))
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

static bool is_packable(const Shape *shape)
{
    return shape->is_convex_leaf && shape->kind == SHAPE_PLANE;
}

void convex_pack_planes(Arena *arena, Shape *node)
{
    node->planes = NULL;
    node->plane_blocks = node->plane_count = 0;
    for (int i = 0; i < node->child_count; i++)
        node->plane_count += is_packable(node->children[i]);
    if (node->kind != SHAPE_INTERSECTION || node->plane_count < 2)
        return;
    int blocks = (node->plane_count + BLOCK - 1) / BLOCK, next = 0;
    PlaneBlock *out = ARENA_ARRAY(arena, PlaneBlock, (size_t)blocks);
    if (!out)
        return;
    int last = 0;
    for (int i = 0; next < blocks * BLOCK; i++) {
        if (i < node->child_count && !is_packable(node->children[i]))
            continue;
        last = i < node->child_count ? i : last; /* the last plane fills the last block up */
        const Shape *leaf = node->children[last];
        double sign = leaf->is_inverted ? -1 : 1;
        PlaneBlock *block = &out[next / BLOCK];
        for (int axis = 0; axis < 3; axis++)
            block->n[axis][next % BLOCK] = sign * v3_at(leaf->u.plane.normal, axis);
        block->d[next % BLOCK] = sign * leaf->u.plane.distance;
        block->place[next % BLOCK] = leaf->rounding.place;
        block->turn_doubt[next % BLOCK] = leaf->u.plane.turn_doubt;
        block->child[next++ % BLOCK] = last;
    }
    node->planes = out;
    node->plane_blocks = blocks;
}

void convex_push(const ConvexEnd *end, ShapeScratch *scratch)
{
    Crossing crossing;
    crossing_fill(end->leaf, &end->hit, &crossing);
    if (end->leaf->is_inverted)
        crossing_invert(&crossing);
    scratch_push(scratch, &crossing);
}
