/* What one part does to the light of a lamp in a cell of directions.
 *
 * What matters about convex solids is simple, as a face sees them: the nearness of their near side
 * is a concave function of u and v, over what joins any of its points and under its tangents; seen
 * from inside, that of the side where light leaves is a convex one, the other way round.  Points
 * and tangents at the four corners of a cell thus enclose it between two planes.  Where its outline
 * crosses a cell, the outline lies between what joins two of its points and the line beside that
 * that no point is beyond.  SPDX-License-Identifier: Apache-2.0 */
#include "trace/shadow_int.h"

#include <float.h>

enum {
    SEARCH_STEPS = 8,  /* for a line between a cell and a part */
    OUTLINE_STEPS = 8, /* for where a side of a cell leaves a part, in halvings */
    REACH_STEPS = 8,   /* for how far a part goes in some direction */
    CORNERS = 4        /* of a cell: u low, high, low, high; v low, low, high, high */
};

/* Planes closer together than this part of the nearness enclose a surface well enough. */
#define GAP_ENOUGH 0.02

/* An outline may be this part of a cell's size wide. */
#define OUTLINE_WIDTH 0.1

/* Corners that an outline passes by this near, in parts of the cell's size, are on neither side. */
#define CLEAR_SIDE 1e-3

/* Planes stand off what they enclose by this part of the nearness, and cells are wider by this part
 * of their size: far above the rounding of corners and of a cell's numbers. */
#define SLACK 1e-5

/* --- planes over a cell ----------------------------------------------------------------------- */

static double corner_u(const Cell *cell, int corner)
{
    return cell->u + (corner & 1 ? cell->size : 0);
}

static double corner_v(const Cell *cell, int corner)
{
    return cell->v + (corner & 2 ? cell->size : 0);
}

static double plane_at(const Plane *plane, const Cell *cell, int corner)
{
    return plane->a * corner_u(cell, corner) + plane->b * corner_v(cell, corner) + plane->c;
}

static double plane_mean(const Plane *plane, const Cell *cell)
{
    return plane->a * (cell->u + cell->size / 2) + plane->b * (cell->v + cell->size / 2) + plane->c;
}

bool plane_is_over(const Plane *a, const Plane *b, const Cell *cell)
{
    for (int i = 0; i < CORNERS; i++)
        if (!(plane_at(a, cell, i) >= plane_at(b, cell, i)))
            return false;
    return true;
}

static double plane_most(const Plane *plane, const Cell *cell)
{
    double most = -INFINITY;
    for (int i = 0; i < CORNERS; i++)
        most = num_max(most, plane_at(plane, cell, i));
    return most;
}

/* Return a plane over both. */
static Plane over_both(const Plane *a, const Plane *b, const Cell *cell)
{
    if (plane_is_over(a, b, cell))
        return *a;
    if (plane_is_over(b, a, cell))
        return *b;
    return (Plane){0, 0, num_max(plane_most(a, cell), plane_most(b, cell))};
}

void enclosure_add(Enclosure *sum, const Enclosure *e, const Cell *cell)
{
    sum->lit = over_both(&sum->lit, &e->lit, cell);
    if (plane_mean(&e->dark, cell) > plane_mean(&sum->dark, cell))
        sum->dark = e->dark;
}

bool enclosure_is_close(const Enclosure *e, const Cell *cell)
{
    for (int i = 0; i < CORNERS; i++) {
        double lit = plane_at(&e->lit, cell, i), dark = plane_at(&e->dark, cell, i);
        if (!(lit - dark <= GAP_ENOUGH * fabs(lit)))
            return false;
    }
    return true;
}

/* Return the plane next to four points that is over (side 1) or under (-1) all of them. */
static Plane plane_beside(const double s[CORNERS], const Cell *cell, int side)
{
    double twist = fabs(s[0] + s[3] - s[1] - s[2]) / 4;
    Plane out = {(s[1] + s[3] - s[0] - s[2]) / (2 * cell->size),
                 (s[2] + s[3] - s[0] - s[1]) / (2 * cell->size), 0};
    double middle = (s[0] + s[1] + s[2] + s[3]) / 4 + side * twist;
    out.c = middle - plane_mean(&out, cell);
    return out;
}

/* --- what a part does in a cell --------------------------------------------------------------- */

/* Return the ray of the lamp through a point of the face.  `d` is not of unit length: t is the
 * depth. */
static Ray lamp_ray(const ShadowFace *face, double u, double v)
{
    V3 aside = v3_add(v3_scale(face->u, u), v3_scale(face->v, v));
    Ray ray = {face->origin, face->w, 0, INFINITY};
    if (face->is_parallel)
        ray.o = v3_add(face->origin, aside);
    else
        ray.d = v3_add(face->w, aside);
    return ray;
}

/* Return the plane n . p = n . at. */
static Plane plane_through(const ShadowFace *face, V3 n, V3 at)
{
    double way = v3_dot(n, v3_sub(at, face->origin));
    double u = v3_dot(n, face->u), v = v3_dot(n, face->v), w = v3_dot(n, face->w);
    return face->is_parallel ? (Plane){u / w, v / w, -way / w} : (Plane){u / way, v / way, w / way};
}

/* Where a point is on a face. */
static V2 project(const ShadowFace *face, V3 p)
{
    V3 to = v3_sub(p, face->origin);
    double w = face->is_parallel ? 1 : v3_dot(face->w, to);
    return (V2){v3_dot(face->u, to) / (v3_len2(face->u) * w),
                v3_dot(face->v, to) / (v3_len2(face->v) * w)};
}

/* Find the point of a leaf that is furthest in direction n of the face, where that meets a cell;
 * returns true if it does not get there. */
static bool is_apart(const ShadowFace *face, const Cell *cell, const Shape *leaf, V2 n,
                     V2 *furthest)
{
    double edge = INFINITY;
    for (int i = 0; i < CORNERS; i++)
        edge = num_min(edge, n.u * corner_u(cell, i) + n.v * corner_v(cell, i));
    edge -= SLACK * cell->size * (fabs(n.u) + fabs(n.v));
    V3 u = v3_scale(face->u, n.u / v3_len2(face->u)), v = v3_scale(face->v, n.v / v3_len2(face->v));
    V3 across = v3_add(u, v);
    if (!face->is_parallel)
        across = v3_mad(across, -edge, face->w);
    V3 p = shape_farthest(leaf, across);
    *furthest = project(face, p);
    return v3_dot(across, v3_sub(p, face->origin)) < (face->is_parallel ? edge : 0);
}

static V2 v2_between(V2 a, V2 b, double x)
{
    return (V2){a.u + x * (b.u - a.u), a.v + x * (b.v - a.v)};
}

static double v2_dist2(V2 a, V2 b)
{
    return (a.u - b.u) * (a.u - b.u) + (a.v - b.v) * (a.v - b.v);
}

/* Part of the way from a to b at which p is nearest. */
static double nearest_place(V2 a, V2 b, V2 p)
{
    double way = (p.u - a.u) * (b.u - a.u) + (p.v - a.v) * (b.v - a.v), length2 = v2_dist2(a, b);
    return length2 > 0 ? num_max(0, num_min(1, way / length2)) : 0;
}

/* Two points of a leaf, and the one between them that is nearest to a cell. */
typedef struct Nearest {
    V2 a, b, at;
} Nearest;

/* Go on to the nearest side of the triangle with a third point; returns false if that is not
 * nearer. */
static bool come_nearer(Nearest *n, V2 third, V2 p)
{
    Nearest best = *n;
    const V2 other[] = {n->a, n->b};
    for (int i = 0; i < 2; i++) {
        V2 at = v2_between(other[i], third, nearest_place(other[i], third, p));
        if (v2_dist2(at, p) < v2_dist2(best.at, p))
            best = (Nearest){other[i], third, at};
    }
    bool is_nearer = v2_dist2(best.at, p) < v2_dist2(n->at, p);
    *n = best;
    return is_nearer;
}

/* Return true if it is proved that no ray in the cell meets a leaf: a line is looked for on the
 * face that keeps them apart, by going to the point of the leaf that is nearest to the cell's
 * middle (in two dimensions what Gilbert, Johnson and Keerthi do in three). */
static bool is_leaf_missed(const ShadowFace *face, const Cell *cell, const Shape *leaf)
{
    V2 center = {cell->u + cell->size / 2, cell->v + cell->size / 2}, next;
    V2 middle = project(face, bound_center(shape_bound(leaf)));
    Nearest nearest = {middle, middle, middle};
    for (int i = 0; i < SEARCH_STEPS; i++) {
        V2 n = {center.u - nearest.at.u, center.v - nearest.at.v};
        if (is_apart(face, cell, leaf, n, &next))
            return true;
        if (!come_nearer(&nearest, next, center))
            return false;
    }
    return false;
}

/* Is the inside of a solid, not turned inside out, all between its surfaces? */
static bool is_between_surfaces(const Shape *solid)
{
    bool is_leaf = solid->kind < SHAPE_UNION;
    if (solid->is_inverted || (is_leaf && (!solid->is_bounded || solid->kind == SHAPE_DISC)))
        return false;
    for (int i = 0; i < solid->child_count; i++) {
        bool is_child = is_between_surfaces(solid->children[i]);
        if (is_child == (solid->kind == SHAPE_INTERSECTION))
            return is_child;
    }
    return solid->kind != SHAPE_INTERSECTION;
}

bool part_is_missed(const ShadowFace *face, const Cell *cell, const Shape *shape)
{
    switch (shape->kind) {
    case SHAPE_UNION:
    case SHAPE_MERGE:
        for (int i = 0; i < shape->child_count; i++)
            if (!part_is_missed(face, cell, shape->children[i]))
                return false;
        return true;
    case SHAPE_INTERSECTION:
        for (int i = 0; i < shape->child_count; i++) {
            const Shape *child = shape->children[i];
            if (is_between_surfaces(child) && part_is_missed(face, cell, child))
                return true;
        }
        return false;
    default:
        return shape->is_bounded && is_leaf_missed(face, cell, shape);
    }
}

/* A point of a face, and how the ray of the lamp through it meets a part. */
typedef struct FacePoint {
    double u, v;
    bool is_met, is_entering;
    bool is_at_lamp; /* where the ray begins */
    double nearness;
    V3 p, n; /* on the surface, and its normal */
} FacePoint;

static FacePoint meet(const Sight *sight, const Part *part, double u, double v)
{
    Ray ray = lamp_ray(sight->face, u, v);
    double length = v3_len(ray.d);
    ray.d = v3_scale(ray.d, 1 / length);
    Crossing crossing;
    ShapePoint point;
    FacePoint out = {.u = u, .v = v};
    if (!shape_closest(part->shape, &ray, sight->shapes, &crossing))
        return out;
    shape_point(&crossing, &ray, &point);
    out.is_met = true;
    out.is_entering = v3_dot(point.ng, ray.d) < 0;
    out.is_at_lamp = crossing.t <= part->touch;
    out.nearness = sight->face->is_parallel ? -crossing.t : length / crossing.t;
    out.p = point.p;
    out.n = point.ng;
    return out;
}

/* How the rays through the corners meet a convex part. */
typedef struct CornerHits {
    int count, entering;
    bool is_at_lamp; /* one of them is */
    double nearness[CORNERS];
    Plane tangents[CORNERS]; /* of those that meet it, one after the other */
} CornerHits;

static void meet_corners(const Sight *sight, const Cell *cell, const Part *part, CornerHits *out)
{
    out->count = out->entering = 0;
    out->is_at_lamp = false;
    for (int i = 0; i < CORNERS; i++) {
        FacePoint hit = meet(sight, part, corner_u(cell, i), corner_v(cell, i));
        if (!hit.is_met)
            continue;
        out->is_at_lamp |= hit.is_at_lamp;
        out->entering += hit.is_entering;
        out->nearness[i] = hit.nearness;
        out->tangents[out->count++] = plane_through(sight->face, hit.n, hit.p);
    }
}

/* Return the lowest (side 1) or the highest (-1) of the tangents. */
static Plane best_tangent(const CornerHits *hits, const Cell *cell, int side)
{
    Plane best = hits->tangents[0];
    for (int i = 1; i < hits->count; i++)
        if (side * plane_mean(&hits->tangents[i], cell) < side * plane_mean(&best, cell))
            best = hits->tangents[i];
    return best;
}

static bool is_finite(const Plane *plane)
{
    return isfinite(plane->a) && isfinite(plane->b) && isfinite(plane->c);
}

/* Keep off the surface; what cannot be told is taken for unknown. */
static void stand_off(const Sight *sight, const Cell *cell, Enclosure *e)
{
    double most = fabs(plane_most(&e->lit, cell));
    e->lit.c += SLACK * most;
    e->dark.c -= SLACK * most;
    if (!is_finite(&e->lit))
        e->lit = (Plane){0, 0, DBL_MAX};
    if (!is_finite(&e->dark))
        e->dark = sight->nothing.dark;
}

/* Parallel rays may begin inside of what reaches behind where they begin. */
static bool may_begin_inside(const Sight *sight, const Part *part)
{
    return sight->face->is_parallel && !(part->nearest < 0);
}

/* A plane is its own tangent.  Parallel rays that may begin behind it tell nothing. */
static Enclosure enclose_plane(const Sight *sight, const Cell *cell, const PlaneParams *params)
{
    V3 at = v3_scale(params->normal, params->distance);
    Plane plane = plane_through(sight->face, params->normal, at);
    const Plane start = {0, 0, 0};
    if (sight->face->is_parallel && plane_is_over(&plane, &start, cell))
        return sight->nothing; /* it is behind where the rays begin */
    if (sight->face->is_parallel && !(plane_most(&plane, cell) < 0))
        return (Enclosure){start, sight->nothing.dark};
    return (Enclosure){plane, plane};
}

Enclosure part_enclose(const Sight *sight, const Cell *cell, const Part *part)
{
    Enclosure out = {{0, 0, part->nearest}, sight->nothing.dark};
    CornerHits hits = {.count = 0};
    bool is_plane = part->shape->kind == SHAPE_PLANE && part->shape->clip_count == 0;
    if (is_plane)
        out = enclose_plane(sight, cell, &part->shape->u.plane);
    else if (part->is_convex)
        meet_corners(sight, cell, part, &hits);
    bool is_outside =
        hits.entering > 0 && hits.entering == hits.count && !may_begin_inside(sight, part);
    if (is_outside) {
        Plane tangent = best_tangent(&hits, cell, 1);
        if (plane_mean(&tangent, cell) < part->nearest)
            out.lit = tangent;
    }
    if (is_outside && hits.count == CORNERS)
        out.dark = plane_beside(hits.nearness, cell, -1);
    if (hits.entering == 0 && hits.count == CORNERS) {
        out.lit = plane_beside(hits.nearness, cell, 1);
        out.dark = best_tangent(&hits, cell, -1);
    }
    if (part->is_at_lamp || hits.is_at_lamp)
        out = (Enclosure){{0, 0, INFINITY}, sight->nothing.dark};
    stand_off(sight, cell, &out);
    return out;
}

/* --- the outline of a part in a cell ---------------------------------------------------------- */

/* The part of a cell that something convex fills: corners and where the outline crosses sides. */
typedef struct Filled {
    int count, end_count;
    FacePoint points[CORNERS + 2];
    FacePoint ends[2]; /* those of the outline */
    int outside_count;
    V2 outside[CORNERS]; /* corners that are not met */
} Filled;

/* Return the last point met between one that is and one that is not. */
static FacePoint find_outline(const Sight *sight, const Part *part, FacePoint in, FacePoint out)
{
    for (int i = 0; i < OUTLINE_STEPS; i++) {
        FacePoint middle = meet(sight, part, 0.5 * (in.u + out.u), 0.5 * (in.v + out.v));
        *(middle.is_met ? &in : &out) = middle;
    }
    return in;
}

/* Returns false if the outline does not cross the cell from side to side. */
static bool find_filled(const Sight *sight, const Cell *cell, const Part *part, Filled *out)
{
    static const int around[] = {0, 1, 3, 2};
    FacePoint corners[CORNERS];
    int changes = 0;
    out->count = out->end_count = out->outside_count = 0;
    for (int i = 0; i < CORNERS; i++) {
        corners[i] = meet(sight, part, corner_u(cell, around[i]), corner_v(cell, around[i]));
        if (corners[i].is_met)
            out->points[out->count++] = corners[i];
        else
            out->outside[out->outside_count++] = (V2){corners[i].u, corners[i].v};
    }
    for (int i = 0; i < CORNERS; i++) {
        changes += corners[i].is_met != corners[(i + 1) % CORNERS].is_met;
        if (corners[i].is_met && (corners[i].is_at_lamp || !corners[i].is_entering))
            return false;
    }
    for (int i = 0; i < CORNERS && changes == 2; i++) {
        const FacePoint *from = &corners[i], *to = &corners[(i + 1) % CORNERS];
        if (from->is_met == to->is_met)
            continue;
        FacePoint end =
            find_outline(sight, part, from->is_met ? *from : *to, from->is_met ? *to : *from);
        out->ends[out->end_count++] = out->points[out->count++] = end;
    }
    return changes == 2;
}

/* Return a plane behind which all is dark where the cell is filled: through the ends of the outline
 * and a corner, or even, and under all of the points. */
static Plane filled_dark(const Filled *filled)
{
    const FacePoint *p = filled->ends, *q = filled->points;
    double u1 = p[1].u - p[0].u, v1 = p[1].v - p[0].v, s1 = p[1].nearness - p[0].nearness;
    double u2 = q->u - p[0].u, v2 = q->v - p[0].v, s2 = q->nearness - p[0].nearness;
    double area = u1 * v2 - u2 * v1;
    Plane plane = {(s1 * v2 - s2 * v1) / area, (s2 * u1 - s1 * u2) / area, 0};
    if (!isfinite(plane.a) || !isfinite(plane.b))
        plane.a = plane.b = 0;
    plane.c = INFINITY;
    for (int i = 0; i < filled->count; i++) {
        double rest = q[i].nearness - plane.a * q[i].u - plane.b * q[i].v;
        plane.c = num_min(plane.c, rest);
    }
    plane.c -= SLACK * fabs(p[0].nearness);
    return plane;
}

/* Return how far a leaf goes in direction n (unit) of the face, from `reach` on, to within `slack`:
 * through the furthest point a line is laid, until no point is beyond it (Dinkelbach's method for
 * the largest of some quotients).  Infinite: not found. */
static double reach_of(const ShadowFace *face, const Shape *leaf, V2 n, double reach, double slack)
{
    V3 u = v3_scale(face->u, n.u / v3_len2(face->u)), v = v3_scale(face->v, n.v / v3_len2(face->v));
    V3 along = v3_add(u, v);
    for (int i = 0; i < REACH_STEPS; i++) {
        V3 across = face->is_parallel ? along : v3_mad(along, -reach, face->w);
        V3 p = v3_sub(shape_farthest(leaf, across), face->origin);
        double w = face->is_parallel ? 1 : v3_dot(face->w, p);
        if (!(w > 0))
            break;
        double there = v3_dot(along, p) / w;
        if (there <= reach + slack)
            return reach + 2 * slack;
        reach = there;
    }
    return INFINITY;
}

/* Find the unit direction across the outline, out of the part.  Returns false when the outline is
 * not clearly between what is met and what is not. */
static bool outward(const Filled *filled, double size, V2 *n)
{
    const FacePoint *p = filled->ends, *q = filled->points;
    *n = (V2){p[1].v - p[0].v, p[0].u - p[1].u};
    double length = hypot(n->u, n->v), first = filled->outside[0].u - p[0].u;
    double side = n->u * first + n->v * (filled->outside[0].v - p[0].v);
    length = copysign(length, side);
    *n = (V2){n->u / length, n->v / length};
    double limit = CLEAR_SIDE * size;
    for (int i = 0; i < filled->outside_count; i++)
        if (!(n->u * (filled->outside[i].u - p->u) + n->v * (filled->outside[i].v - p->v) > limit))
            return false;
    for (int i = 0; i < filled->count - 2; i++)
        if (!(n->u * (q[i].u - p->u) + n->v * (q[i].v - p->v) <= 0))
            return false;
    return true;
}

bool part_edge(const Sight *sight, const Cell *cell, const Part *part, ShadowEdge *edge,
               Plane *dark)
{
    Filled filled;
    const Shape *shape = part->shape;
    bool is_simple = part->is_opaque && part->is_convex && !part->is_at_lamp &&
                     shape->kind < SHAPE_UNION && shape->is_bounded;
    if (!is_simple || may_begin_inside(sight, part) || !find_filled(sight, cell, part, &filled))
        return false;
    V2 n;
    if (!outward(&filled, cell->size, &n))
        return false;
    const FacePoint *p = filled.ends;
    double slack = SLACK * cell->size, inside = n.u * p[0].u + n.v * p[0].v;
    double outside = reach_of(sight->face, shape, n, inside, slack);
    if (!(outside - inside <= OUTLINE_WIDTH * cell->size))
        return false;
    *edge = (ShadowEdge){n.u, n.v, inside - slack, outside + slack};
    *dark = filled_dark(&filled);
    return true;
}
