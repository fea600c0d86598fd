/* What the files of the shapes share.
 *
 * A leaf lists the crossings of a whole line in its own space, t staying in scene units: a ray
 * is taken there without making its direction unit.  Bounds on the rounding of the ray go
 * with it.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SHAPE_SHAPE_INT_H
#define PMS_SHAPE_SHAPE_INT_H

#include "math/eps.h"
#include "shape/mesh.h"
#include "shape/shape.h"

/* Relative rounding allowed for the numbers that place a shape: its matrices are products of a
 * few transforms, its corners sums of a few terms. */
#define PLACE_EPS (8 * EPS_DOUBLE)

/* A ray in the space of a leaf.  d is not unit. */
typedef struct LocalRay {
    V3 o, d;
    V3 o_error, d_error; /* bounds per axis; 0 where the transform is exact */
} LocalRay;

typedef struct LeafHit {
    double t, t_error;
    uint32_t part;
    int8_t change;
    bool is_visible;
} LeafHit;

/* The crossings of a leaf and a line, ascending, before any inversion. */
enum { LEAF_HITS_MAX = 4 };
typedef struct LeafHits {
    int count;
    bool is_inside_before;
    LeafHit at[LEAF_HITS_MAX];
} LeafHits;

/* A point in the space of a leaf, pulled onto its surface. */
typedef struct LocalPoint {
    V3 p, ng;     /* ng: outward, unit */
    V3 ns;        /* if is_smooth: interpolated, unit, on the side of ng */
    V3 lift;      /* see ShapePoint */
    double error; /* bound on the distance from the surface, rounding of p alone */
    bool is_smooth;
} LocalPoint;

/* Return the lift of a point of a triangle: on the planes through its corners, square to their
 * normals, p has three places, of which the mean counts.  weight: of the corners at p. */
static inline V3 triangle_lift(V3 p, const V3 corner[3], const V3 normal[3], const double weight[3])
{
    V3 lift = v3(0, 0, 0);
    for (int i = 0; i < 3; i++) {
        double below = v3_dot(v3_sub(corner[i], p), normal[i]);
        lift = v3_mad(lift, weight[i] * below, normal[i]);
    }
    return lift;
}

typedef struct Line Line;

/* What a kind of leaf can do: those that may be NULL say so.  Points and normals are in the space
 * of the leaf. */
typedef struct ShapeOps {
    /* List the crossings of a line, ascending, before any inversion: kinds that have few. */
    void (*hits)(const Shape *leaf, const LocalRay *ray, LeafHits *out);

    /* The same for kinds without `hits`: push them; returns whether the line starts inside. */
    bool (*list)(const Shape *leaf, const Line *line, ShapeScratch *scratch);

    /* Find the first visible crossing with tmin < t < tmax, before any inversion.  NULL: the first
     * of the list. */
    bool (*closest)(const Shape *leaf, const Ray *ray, ShapeScratch *scratch, Crossing *out);

    /* Pull the point p of a crossing onto the surface. */
    void (*point)(const Shape *leaf, const Crossing *crossing, V3 p, LocalPoint *out);

    /* Return the language's uv; u and v are a crossing's.  NULL: the world's x and y. */
    V2 (*uv)(const Shape *leaf, uint32_t part, double u, double v, V3 p);

    /* NULL: nothing is inside. */
    bool (*is_inside)(const Shape *leaf, V3 p);

    /* Return a box in world space around the surface. */
    Bound (*bound)(const Shape *leaf);

    /* Return the point for which n . p is largest, up to rounding.  NULL: of the box around it. */
    V3 (*farthest)(const Shape *leaf, V3 n);

    /* Return the magnitude of the numbers that place the form in its space.  NULL: the kind allows
     * for their rounding by itself. */
    double (*size)(const Shape *leaf);

    /* Fold a transform into the numbers of the form; false when they cannot take it.  NULL: never.
     */
    bool (*transform)(Shape *leaf, const Xform *xform);
} ShapeOps;

#define LEAF(id, ops, is_solid, is_closed) extern const ShapeOps ops;
#define NODE(id)
#include "shape/shape.def"
#undef LEAF
#undef NODE

/* Return the operations of a leaf. */
const ShapeOps *shape_ops(const Shape *leaf);

static inline double v3_sum_abs(V3 a)
{
    return fabs(a.x) + fabs(a.y) + fabs(a.z);
}
static inline V3 v3_abs(V3 a)
{
    return v3(fabs(a.x), fabs(a.y), fabs(a.z));
}

static inline void local_ray(const Shape *shape, const Ray *ray, LocalRay *out)
{
    if (!shape->is_transformed) {
        *out = (LocalRay){.o = ray->o, .d = ray->d};
        return;
    }
    const ShapeRounding *r = &shape->rounding;
    double size = v3_sum_abs(ray->o);
    out->o = xform_point_back(&shape->xform, ray->o);
    out->d = xform_dir_back(&shape->xform, ray->d);
    if (r->is_exact) {
        out->o_error = out->d_error = v3(0, 0, 0);
        return;
    }
    out->o_error = v3_scale(v3_mad(r->offset, size, r->row), PLACE_EPS);
    out->d_error = v3_scale(r->row, PLACE_EPS);
}

/* Bound the error of the local points at t, per axis, without the shape's own. */
static inline V3 local_error(const LocalRay *ray, double t)
{
    t = fabs(t);
    return v3(ray->o_error.x + t * ray->d_error.x +
                  4 * EPS_DOUBLE * (fabs(ray->o.x) + t * fabs(ray->d.x)),
              ray->o_error.y + t * ray->d_error.y +
                  4 * EPS_DOUBLE * (fabs(ray->o.y) + t * fabs(ray->d.y)),
              ray->o_error.z + t * ray->d_error.z +
                  4 * EPS_DOUBLE * (fabs(ray->o.z) + t * fabs(ray->d.z)));
}

/* Return the point of a box that is furthest along n, and that of a circle around the z axis. */
V3 bound_farthest(Bound box, V3 n);
V3 circle_farthest(double radius, double z, V3 n);

/* Return whether a ray meets a sphere with tmin < t < tmax. */
bool sphere_is_met(const Shape *shape, const LocalRay *ray, double tmin, double tmax);

/* Rounding of the product of a plane's normal with something, relative to its terms, and how much
 * larger the product with a direction has to be than its error: a line less steep is parallel. */
#define PLANE_EPS (8 * EPS_DOUBLE)
enum { PLANE_STEEPNESS = 4 };

/* Return the box around a plane's inside. */
Bound plane_inside_bound(const PlaneParams *plane);

/* Make a leaf whose parameters are still to be filled in, or NULL. */
Shape *leaf_new(Arena *arena, ShapeKind kind);

/* Place a leaf, and derive what its numbers say about their rounding. */
void leaf_place(Shape *leaf, const Xform *xform);

/* Is this a scaling along the axes, by positive factors, and a move? */
bool xform_is_plain(const Xform *x);

/* Scaling alike in all directions leaves normals as they are, to the last bit: making them unit
 * again would not. */
bool xform_keeps_normals(const Xform *x);

/* Turn a unit normal. */
V3 turn_normal(V3 n, const Xform *x);

/* Enlarge a box by the rounding of the numbers it was made of. */
static inline Bound bound_pad(Bound b)
{
    V3 pad = v3_scale(v3_add(v3_abs(b.lo), v3_abs(b.hi)), 2 * PLACE_EPS);
    return (Bound){v3_sub(b.lo, pad), v3_add(b.hi, pad)};
}

/* The part of a ray's line whose crossings are wanted: what happens outside [near, far] may be
 * told wrong. */
struct Line {
    const Ray *ray;
    V3 inverse; /* of the direction */
    double near, far;
    bool is_first_only; /* what lies beyond the first visible crossing may be told wrong, too */
};

/* Is what happens at t wanted? */
static inline bool line_wants(const Line *line, double t)
{
    return t >= line->near && t <= line->far;
}

/* Is nothing wanted beyond a crossing? */
static inline bool line_ends_with(const Line *line, const Crossing *c)
{
    return line->is_first_only && c->is_visible && c->t > line->near && c->t < line->far;
}

/* Move a t that is exact to a few of its own ulps to where it is early for sure. */
static inline double earlier(double t)
{
    return t * (t < 0 ? 1 + 8 * EPS_DOUBLE : 1 - 8 * EPS_DOUBLE);
}

/* Narrow a line to a box; false when it misses it.  Never says no by rounding. */
bool line_cut(Line *line, const Bound *box);

/* BLOCK numbers computed with at once. */
enum { BLOCK = 4 };
typedef double Lanes __attribute__((vector_size(sizeof(double) * BLOCK)));
typedef __typeof__((Lanes){0} < (Lanes){0}) LaneMask;
#define LANES_PICK(mask, a, b) ((Lanes)(((mask) & (LaneMask)(a)) | (~(mask) & (LaneMask)(b))))
#define LANES_ABS(x) LANES_PICK((x) < 0, -(x), (x))

/* Boxes side by side, so that they are cut together. */
typedef struct BoxBlock {
    double lo[3][BLOCK], hi[3][BLOCK];
} BoxBlock;

/* Set box k of a block. */
static inline void block_set(BoxBlock *block, int k, const Bound *box)
{
    for (int axis = 0; axis < 3; axis++) {
        block->lo[axis][k] = v3_at(box->lo, axis);
        block->hi[axis][k] = v3_at(box->hi, axis);
    }
}

/* The parts of a line within the boxes of a block; near > far where it misses one. */
typedef struct BlockCut {
    double near[BLOCK], far[BLOCK];
} BlockCut;

/* As line_cut, for a block of boxes at once. */
void block_cut(const BoxBlock *block, const Line *line, BlockCut *out);

/* The reaches of four children. */
struct ReachBlock {
    BoxBlock boxes;
    bool is_inside_beyond[BLOCK];
};

/* Planes among the children of an intersection, side by side; turned, so that the inside is
 * n . p < d.  The last ones of the last block repeat. */
struct PlaneBlock {
    double n[3][BLOCK], d[BLOCK], place[BLOCK], turn_doubt[BLOCK];
    int child[BLOCK];
};

/* A node of the tree over the planes of an intersection.  Those of its left part come next, those
 * of the right begin at `right`; 0: it has no parts. */
typedef struct PlaneNode {
    V3 axis;                     /* unit: of a cone around the normals */
    double cosine, sine;         /* of its half angle, which is too large rather than too small */
    double d;                    /* the least distance */
    double place, turn_doubt;    /* the largest */
    uint32_t first, count;       /* its blocks */
    uint32_t right;
} PlaneNode;

enum { PLANE_TREE_DEPTH_MAX = 64 };

/* Return the box that holds every crossing of a shape; *is_inside_beyond: the state of what
 * lies outside it. */
Bound shape_reach(const Shape *shape, bool *is_inside_beyond);

/* A child of a node whose children are merged. */
typedef struct ChildSlot {
    uint32_t place; /* its number, in written order */
    bool is_inside; /* the line is in it, where the sweep is */
} ChildSlot;

/* What a line meets next in the index of a node: a child of the shape or a node of the tree. */
typedef struct IndexEntry {
    double near; /* where the line may enter it */
    uint32_t what;
    bool is_child;
} IndexEntry;

/* The scratch memory: a stack of crossings. */
struct ShapeScratch {
    Crossing *items;
    size_t capacity;
    int count;
    bool is_overflown;
    ChildSlot *slots; /* of the nodes being merged */
    size_t slot_capacity, slot_count;
    IndexEntry *entries; /* of the nodes whose index is being walked */
    size_t entry_capacity, entry_count;
    TriHit *triangles;
    size_t triangle_capacity;
    void *room; /* for one leaf at a time */
    size_t room_capacity;
};

/* Return the scratch's room for a leaf, grown to `size` bytes with what was in it kept; NULL, and
 * the scratch says so, when memory is out. */
void *scratch_room(ShapeScratch *scratch, size_t size);

/* Start the scratch afresh for a part of a line. */
Line scratch_line(const Ray *ray, double near, double far, ShapeScratch *scratch);

/* Push a crossing; when the stack is full or memory is out it is dropped and the scratch says
 * so. */
void scratch_push(ShapeScratch *scratch, const Crossing *crossing);

/* Sort by t, then by child, in place; what is alike in both stays in order. */
void crossings_sort(Crossing *items, int count);

/* Find the crossings of a leaf that has few, before any inversion. */
void leaf_hits(const Shape *shape, const Ray *ray, LeafHits *out);

/* Take the first visible hit with tmin < t < tmax; false: there is none. */
bool hits_closest(const Shape *leaf, const LeafHits *hits, const Ray *ray, Crossing *out);

/* One end of the core: a hit of the child that lends it its look, and where the hits of all
 * children that end there may be. */
typedef struct ConvexEnd {
    LeafHit hit;
    const Shape *leaf;
    double lo, hi;
    int child; /* NO_CONVEX: the core has no such end */
} ConvexEnd;

enum { NO_CONVEX = -1 };

/* What the convex leaves among the children of an intersection share along a line. */
typedef struct ConvexCore {
    ConvexEnd entry, exit;
} ConvexCore;

/* Pack the planes of an intersection for convex_core. */
void convex_pack_planes(Arena *arena, Shape *node);

/* Return whether every line is inside the leaf (its inversion applied) along one stretch. */
bool shape_is_convex_leaf(const Shape *shape);

/* Find the core of an intersection; false when it is empty on [near, far]. */
bool convex_core(const Shape *node, const Ray *ray, double near, double far, ConvexCore *core);

/* Push an end of the core as a crossing. */
void convex_push(const ConvexEnd *end, ShapeScratch *scratch);

/* Push the crossings of a leaf, without inversion and clips; returns whether the line starts
 * inside. */
bool leaf_list(const Shape *shape, const Line *line, ShapeScratch *scratch);

/* Push the crossings of any shape along a line, inversion and clips applied; returns whether the
 * line starts inside. */
bool csg_list(const Shape *shape, const Line *line, ShapeScratch *scratch);

/* Find the first visible crossing, tmin < t < tmax, of a finished node that has an index and no
 * clips. */
bool csg_first(const Shape *node, const Ray *ray, ShapeScratch *scratch, Crossing *out);

/* Dissolve nodes in nodes of their own kind. */
void csg_flatten(Arena *arena, Shape *node);

/* Give a node with many children an index over those that are bounded; when there are few of
 * them, or memory is out, it has none. */
void index_build(Arena *arena, Shape *node);

/* Is p inside some child in the index, or (is_all) in all of them? */
bool index_holds(const Shape *node, V3 p, bool is_all);

/* Fill a crossing from a leaf's hit (no inversion applied). */
static inline void crossing_fill(const Shape *leaf, const LeafHit *hit, Crossing *out)
{
    *out = (Crossing){.t = hit->t,
                      .t_error = hit->t_error,
                      .leaf = leaf,
                      .part = hit->part,
                      .change = hit->change,
                      .leaf_change = hit->change,
                      .is_visible = hit->is_visible};
}

/* Turn a crossing into that of the complement. */
static inline void crossing_invert(Crossing *c)
{
    c->change = (int8_t)-c->change;
    c->leaf_change = (int8_t)-c->leaf_change;
    c->is_flipped = !c->is_flipped;
}

#endif
