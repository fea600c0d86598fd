/* Shapes: geometry alone, without looks.
 *
 * A Shape is a primitive or a CSG node.  Every kind answers the same five questions: where a
 * line crosses its surface, whether a point is inside, the normal, the uv of a point, and a
 * box around it.  CSG works on crossings only: along the whole line each solid is a sorted
 * list of entries and exits, and the operators merge such lists; no point is tested for being
 * inside, so no epsilon decides.
 *
 * Crossings carry the error bound of their t.  Crossings of two solids whose error intervals
 * overlap are one event: the state before and after it decides what is seen, and the solid
 * written first lends its look.
 *
 * Shapes are made by the scene readers in the scene arena and are const from then on.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SHAPE_SHAPE_H
#define PMS_SHAPE_SHAPE_H

#include "accel/accel.h"
#include "base/arena.h"
#include "math/bound.h"
#include "math/ray.h"
#include "math/xform.h"

#include <stdint.h>

typedef enum ShapeKind {
#define X(id, name, is_solid) id,
#include "shape/shape.def"
#undef X
    SHAPE_COUNT
} ShapeKind;

typedef struct Shape Shape;
typedef struct MeshData MeshData;

/* Canonical forms, all in object space; Shape.xform takes them to the world. */
typedef struct ConeParams {
    double bottom, top; /* radii at z = 0 and z = 1, both >= 0; a cylinder has two equal ones */
    bool is_open;       /* no caps */
} ConeParams;

typedef struct TorusParams {
    double major, minor; /* around the y axis, both >= 0 */
} TorusParams;

typedef struct DiscParams {
    double hole, radius; /* in the plane z = 0, inside is z < 0 */
} DiscParams;

typedef struct TriangleParams {
    V3 corner[3]; /* world space when xform is the identity */
    V3 normal[3]; /* unit; used if is_smooth */
    bool is_smooth;
} TriangleParams;

struct Shape {
    ShapeKind kind;
    bool is_inverted;
    bool is_transformed;  /* xform is not the identity */
    uint32_t surface;     /* of a leaf: which Surface of the scene it shows */
    Xform xform;          /* of a leaf: object space to world space */
    union {
        ConeParams cone;  /* unit z axis */
        TorusParams torus;
        DiscParams disc;
        TriangleParams triangle;
        const MeshData *mesh; /* shared between instances */
    } u;                  /* sphere: unit sphere; box: [-1,1]^3; plane: z < 0 is inside */
    Shape **children;     /* of a CSG node; difference is an intersection with inverted ones */
    int child_count;
    Shape **clips;        /* only what is inside all of these exists; never textured */
    int clip_count;
};

/* One crossing of a line and a surface. */
typedef struct Crossing {
    double t;          /* scene units */
    double t_error;    /* bound on the absolute error of t, scene units */
    const Shape *leaf; /* the primitive crossed */
    uint32_t part;     /* which side, cap or triangle of the leaf */
    int8_t change;     /* +1 the line enters the solid here, -1 it leaves, 0 a sheet or inner wall */
    int8_t leaf_change; /* the same for the leaf alone (inversions above it applied) */
    bool is_visible;   /* false: bounds the solid but shows no surface (clip, disc's plane) */
    bool is_flipped;   /* an odd number of inversions above the leaf: its normal points in */
    double u, v;       /* of triangles: barycentrics; else unused */
} Crossing;

/* A growing list of crossings, ascending in t.  Its memory is a thread's scratch. */
typedef struct CrossList {
    Crossing *items;
    int count, capacity;
    bool is_inside_before; /* the line starts (t = -infinity) inside the solid */
    bool is_overflown;     /* more crossings than CROSSINGS_MAX: some were dropped */
} CrossList;

enum { CROSSINGS_MAX = 1 << 16 };

/* Per-thread working memory of the shape code. */
typedef struct ShapeScratch ShapeScratch;
ShapeScratch *shape_scratch_new(void); /* NULL when memory is out */
void shape_scratch_free(ShapeScratch *scratch);

/* --- making (sdl and scene) ------------------------------------------------------------- */

/* Each returns a shape in `arena`, or NULL when memory is out.  Arguments are in world space
 * and already validated by the reader: radii >= 0 and finite, axes not zero. */
Shape *shape_sphere(Arena *arena, V3 center, double radius);
Shape *shape_box(Arena *arena, V3 corner, V3 opposite);
Shape *shape_cone(Arena *arena, V3 bottom, double bottom_radius, V3 top, double top_radius,
                  bool is_open);
Shape *shape_plane(Arena *arena, V3 normal, double distance);
Shape *shape_torus(Arena *arena, double major, double minor);
Shape *shape_disc(Arena *arena, V3 center, V3 normal, double radius, double hole);
Shape *shape_triangle(Arena *arena, const V3 corner[3], const V3 *normal_or_null);
Shape *shape_mesh(Arena *arena, const MeshData *mesh);
/* kind: SHAPE_UNION, SHAPE_MERGE or SHAPE_INTERSECTION; children are borrowed. */
Shape *shape_csg(Arena *arena, ShapeKind kind, Shape **children, int child_count);

/* Apply a transform to a shape, its children and clips, in place.  Mesh data stays shared. */
void shape_transform(Shape *shape, const Xform *xform);

/* Deep copy (mesh data shared), or NULL. */
Shape *shape_copy(Arena *arena, const Shape *shape);

/* Swap inside and outside, in place (De Morgan is implied: the flag sits on the node). */
void shape_invert(Shape *shape);

/* --- asking (any thread) ---------------------------------------------------------------- */

bool shape_is_solid(const Shape *shape);

/* List every crossing of the whole line of `ray` (tmin and tmax are ignored), for solids and
 * CSG.  The list is replaced. */
void shape_crossings(const Shape *shape, const Ray *ray, ShapeScratch *scratch, CrossList *out);

/* Find the first visible crossing with tmin < t < tmax; does not build lists for primitives.
 * Returns false when there is none. */
bool shape_closest(const Shape *shape, const Ray *ray, ShapeScratch *scratch, Crossing *out);

bool shape_is_inside(const Shape *shape, V3 p);

/* Refine and describe the point of a crossing.
 *
 * p        the point ray_at(t), pulled onto the surface where that can be done exactly.
 * p_error  bound on the distance of p from the true surface point, scene units.
 * ng       geometric normal, unit, outward of the solid the crossing belongs to (is_flipped
 *          and is_inverted applied).
 * ns       interpolated normal of smooth triangles, else ng; same orientation.
 * uv       the language's uv of the primitive. */
typedef struct ShapePoint {
    V3 p;
    double p_error;
    V3 ng, ns;
    V2 uv;
} ShapePoint;
void shape_point(const Crossing *crossing, const Ray *ray, ShapePoint *out);

/* Return a box around the shape; BOUND_ALL when it is not bounded. */
Bound shape_bound(const Shape *shape);

#endif
