/* The convex core of an intersection.
 *
 * What convex solids share along a line is one stretch of it: from the last of their entries to
 * the first of their exits.  No lists and no sorting are needed, and the other children need
 * be asked only about that stretch.  SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape_int.h"

bool shape_is_convex_leaf(const Shape *shape)
{
    if (shape->clip_count)
        return false;
    switch (shape->kind) {
    case SHAPE_PLANE:
        return true; /* a half-space either way */
    case SHAPE_SPHERE:
    case SHAPE_BOX:
        return !shape->is_inverted;
    case SHAPE_CONE:
        return !shape->is_inverted && !shape->u.cone.is_open;
    default:
        return false;
    }
}

/* Take a hit as an end of the core if it is further in.  Ends whose errors overlap are one
 * event, which shows the child written first: the one that is there already. */
static void move_end(ConvexEnd *end, const Shape *leaf, const LeafHit *hit, int child, int way)
{
    double lo = hit->t - hit->t_error, hi = hit->t + hit->t_error;
    bool is_new = end->child == NO_CONVEX || (way > 0 ? lo > end->hi : hi < end->lo);
    bool is_same_place = !is_new && lo <= end->hi && hi >= end->lo;
    if (is_new) {
        *end = (ConvexEnd){*hit, leaf, lo, hi, child};
    } else if (is_same_place) {
        end->lo = lo < end->lo ? lo : end->lo;
        end->hi = hi > end->hi ? hi : end->hi;
    }
}

bool convex_core(const Shape *node, const Ray *ray, double near, double far, ConvexCore *core)
{
    core->entry.child = core->exit.child = NO_CONVEX;
    for (int i = 0; i < node->child_count; i++) {
        const Shape *leaf = node->children[i];
        if (!leaf->is_convex_leaf)
            continue;
        LeafHits hits;
        leaf_hits(leaf, ray, &hits);
        if (hits.count == 0 && hits.is_inside_before == leaf->is_inverted)
            return false;
        for (int k = 0; k < hits.count; k++) {
            int way = leaf->is_inverted ? -hits.at[k].change : hits.at[k].change;
            move_end(way > 0 ? &core->entry : &core->exit, leaf, &hits.at[k], i, way);
        }
        bool has_entry = core->entry.child != NO_CONVEX, has_exit = core->exit.child != NO_CONVEX;
        if ((has_entry && core->entry.lo > far) || (has_exit && core->exit.hi < near))
            return false;
        /* Two faces of one solid may be as near to each other as they like. */
        if (has_entry && has_exit && core->exit.lo <= core->entry.hi &&
            core->entry.leaf != core->exit.leaf)
            return false;
    }
    return true;
}

void convex_push(const ConvexEnd *end, uint32_t slot, ShapeScratch *scratch)
{
    Crossing crossing;
    crossing_fill(end->leaf, &end->hit, &crossing);
    if (end->leaf->is_inverted)
        crossing_invert(&crossing);
    crossing.child = slot;
    scratch_push(scratch, &crossing);
}
