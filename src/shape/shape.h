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
#include "math/func.h"
#include "math/ray.h"
#include "math/spline_curve.h"
#include "math/xform.h"

#include <stdint.h>

typedef enum ShapeKind {
#define LEAF(id, ops, is_solid, is_closed) id,
#define NODE(id) id,
#include "shape/shape.def"
#undef LEAF
#undef NODE
    SHAPE_COUNT
} ShapeKind;

typedef struct Shape Shape;
typedef struct MeshData MeshData;
typedef struct PolygonData PolygonData;
typedef struct PrismData PrismData;
typedef struct RevolveData RevolveData;
typedef struct SweepData SweepData;
typedef struct HeightData HeightData;
typedef struct ReachBlock ReachBlock;
typedef struct PlaneBlock PlaneBlock;
typedef struct PlaneNode PlaneNode;
typedef struct CsgIndex CsgIndex;

/* Forms in object space; Shape.xform takes them to the world.  Spheres, boxes, planes and
 * triangles fold simple transforms into their numbers, so that most have none. */
typedef struct SphereParams {
    V3 center;
    double radius;
} SphereParams;

typedef struct BoxParams {
    V3 lo, hi; /* lo <= hi; equal ones make a sheet */
} BoxParams;

typedef struct PlaneParams {
    V3 normal; /* unit; inside is normal . p < distance.  Never transformed. */
    double distance;
    double turn_doubt, place_doubt; /* bounds on the rounding that transforms brought */
} PlaneParams;

typedef struct ConeParams {
    double bottom,
        top;       /* radii at z = 0 and z = height, both >= 0; a cylinder has two equal ones */
    double height; /* > 0 */
} ConeParams;

typedef struct TorusParams {
    double major, minor; /* around the y axis, both >= 0 */
} TorusParams;

typedef struct OvusParams {
    double bottom, top; /* radii of the balls: about the origin, and about (0, bottom, 0) */
    double arc, height; /* radius of the arc between them, and height of its centre */
    double beyond;      /* how far that is beyond the axis */
} OvusParams;

/* What is left of a quadric's terms about some place. */
typedef struct QuadricPlace {
    V3 center;
    V3 linear;
    double constant;
    double linear_doubt, doubt; /* bounds on the rounding of the move there */
    double linear_size;         /* of the vector */
} QuadricPlace;

typedef struct QuadricParams {
    V3 square;             /* of x^2, y^2, z^2 */
    V3 mixed;              /* of xy, xz, yz */
    QuadricPlace place[2]; /* about the origin, and where the gradient is 0 */
    int place_count;       /* 2 if there is such a place, not the origin */
    double square_size;    /* of the matrix */
} QuadricParams;

typedef struct SuperParams {
    double p, q; /* of x and y, and of both and z: (|x|^p + |y|^p)^(q/p) + |z|^q = 1 */
} SuperParams;

typedef struct PolyData PolyData; /* shape/poly.c */

/* A component of a blob.  In its own space the field is `strength` at the origin, or from there to
 * (0, 0, length), and vanishes at the distance 1 from that. */
typedef struct BlobComponent {
    Xform place;           /* from there to the blob's space */
    double length;         /* 0: a ball */
    double strength;
    uint32_t texture;      /* into the surface's list, or MESH_NO_TEXTURE: the blob's */
    double spread, offset; /* of place.from: set by shape_blob */
} BlobComponent;

typedef struct BlobData BlobData; /* shape/blob.c */

typedef struct DiscParams {
    double hole, radius; /* in the plane z = 0, inside is z < 0 */
} DiscParams;

typedef struct TriangleParams {
    V3 corner[3]; /* world space: never transformed */
    V3 normal[3]; /* unit; used if is_smooth */
    bool is_smooth;
} TriangleParams;

typedef struct IsoTree IsoTree; /* shape/iso_int.h */

typedef struct IsosurfaceParams {
    const Func *func;       /* of x, y, z */
    const Shape *container; /* a box or sphere in the same space, not transformed */
    double threshold;       /* inside is func <= threshold */
    const IsoTree *tree;
} IsosurfaceParams;

/* What is iterated: z -> f(z) + c. */
typedef enum JuliaFunction {
    JULIA_SQR,
    JULIA_CUBE,
    JULIA_EXP,
    JULIA_RECIPROCAL,
    JULIA_SIN,
    JULIA_ASIN,
    JULIA_SINH,
    JULIA_ASINH,
    JULIA_COS,
    JULIA_ACOS,
    JULIA_COSH,
    JULIA_ACOSH,
    JULIA_TAN,
    JULIA_ATAN,
    JULIA_TANH,
    JULIA_ATANH,
    JULIA_LN,
    JULIA_PWR
} JuliaFunction;

/* Points x, y, z of the slice n . (x, y, z, w) = slice_distance that do not escape in so many
 * iterations. */
typedef struct JuliaForm {
    bool is_hypercomplex; /* else quaternions, of which there are only squares and cubes */
    JuliaFunction function;
    double c[4], power[2]; /* the exponent of JULIA_PWR */
    int iterations;        /* at least 1 */
    double precision;      /* what is smaller than 1 over this may be missed */
    double slice[4];       /* n, unit; n[3] is not 0 */
    double slice_distance;
} JuliaForm;
typedef struct JuliaData JuliaData;

/* How much rounding a leaf's own numbers bring: derived when it is made or transformed. */
typedef struct ShapeRounding {
    V3 row;       /* lengths of the rows of xform.from: object units per scene unit */
    V3 offset;    /* magnitudes of the translation of xform.from */
    V3 column;    /* lengths of the columns of xform.to: scene units per object unit */
    double place; /* object units: rounding of the form's numbers */
    bool is_exact; /* xform rounds nothing: it is none, or a scaling by a power of two */
} ShapeRounding;

typedef struct ParametricData ParametricData; /* shape/parametric_int.h */

struct Shape {
    ShapeKind kind;
    bool is_inverted;    /* of a leaf */
    bool is_transformed; /* xform is not the identity */
    bool is_open;        /* of a leaf: it has no caps, though they bound it */
    uint32_t surface;    /* of a leaf: which Surface of the scene it shows */
    Xform xform;         /* of a leaf: object space to world space */
    union {
        SphereParams sphere;
        BoxParams box;
        PlaneParams plane;
        ConeParams cone;
        TorusParams torus;
        QuadricParams quadric;
        SuperParams super;
        const PolyData *poly;
        const BlobData *blob; /* shared by copies */
        DiscParams disc;
        OvusParams ovus;
        TriangleParams triangle;
        IsosurfaceParams iso;
        const JuliaData *julia;
        const ParametricData *parametric; /* shared by copies */
        const MeshData *mesh; /* shared between instances, like those below */
        const PolygonData *polygon;
        const PrismData *prism;
        const RevolveData *revolve; /* of lathe and sor */
        const SweepData *sweep;
        const HeightData *height_field;
    } u;
    Shape **children; /* of a CSG node; difference is an intersection with inverted ones */
    int child_count;
    Shape **clips; /* only what is inside all of these exists (applied after the inversion);
                      never textured */
    int clip_count;
    ShapeRounding rounding;
    bool is_finished;      /* the fields below are set: shape_finish */
    bool is_bounded;       /* a leaf whose surface, unclipped, is within a finite box */
    bool is_convex_leaf;   /* every line is inside it along one stretch */
    int convex_count;      /* convex leaves among the children of an intersection */
    bool is_inside_beyond; /* what lies outside `reach` is inside the solid */
    Bound reach;           /* around every crossing, visible or not */
    const ReachBlock *reaches; /* of the children, packed; NULL: not made */
    const CsgIndex *index;     /* of many children; NULL: none */
    const PlaneNode *plane_tree; /* over many planes; NULL: none */
    const PlaneBlock *planes;  /* of an intersection, packed; NULL: not made */
    int plane_count, plane_blocks;
};

/* One crossing of a line and a surface. */
typedef struct Crossing {
    double t;          /* scene units */
    double t_error;    /* bound on the absolute error of t, scene units; the last few bits of
                          the shape's own numbers count as error too.  Two crossings whose
                          bounds overlap may be a touching, or a near miss. */
    const Shape *leaf; /* the primitive crossed */
    uint32_t part;     /* which side, cap or triangle of the leaf */
    uint32_t child, order; /* used while lists are merged */
    int8_t change; /* +1 the line enters the solid here, -1 it leaves, 0 a sheet or inner wall */
    int8_t leaf_change; /* the same for the leaf alone (inversions above it applied); where walls
                           of several leaves coincide, the net change: 0 at a wall shared by two */
    bool is_visible;    /* false: bounds the solid but shows no surface (clip, disc's plane) */
    bool
        is_flipped; /* an odd number of inversions, the leaf's own included: its normal points in */
    double u, v;    /* of triangles: barycentrics; of parametrics: parameters; else unused */
} Crossing;

/* A list of crossings, ascending in t.  Its memory is the scratch's: it lives until the next
 * call with the same scratch. */
typedef struct CrossList {
    const Crossing *items;
    int count;
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
/* e, n > 0: the language's. */
Shape *shape_superellipsoid(Arena *arena, double e, double n);
/* count > 0.  has_textures: some component has one of its own. */
Shape *shape_blob(Arena *arena, double threshold, const BlobComponent *components, uint32_t count,
                  bool has_textures);
/* square . (x^2, y^2, z^2) + mixed . (xy, xz, yz) + linear . (x, y, z) + constant = 0 */
Shape *shape_quadric(Arena *arena, V3 square, V3 mixed, V3 linear, double constant);
/* A polynomial of degree 2 to ROOTS_DEGREE_MAX; c: poly_term_count numbers, ordered by falling
 * powers of x, then y, then z. */
Shape *shape_poly(Arena *arena, int degree, const double *c);
int poly_term_count(int degree);
int poly_term_index(int degree, int i, int j, int k); /* of x^i y^j z^k */
Shape *shape_disc(Arena *arena, V3 center, V3 normal, double radius, double hole);
Shape *shape_triangle(Arena *arena, const V3 corner[3], const V3 *normal_or_null);
Shape *shape_mesh(Arena *arena, const MeshData *mesh); /* after mesh_index */
Shape *shape_polygon(Arena *arena, const PolygonData *data); /* after polygon_prepare, if flat */

/* What lies between the heights lo <= hi and inside an odd number of closed loops.
 *
 * spans     x and z; each begins at the point where the one before ends, to the last bit, or begins
 *           another loop.  At least one; borrowed.
 * is_conic  at height y the curves are y times as large. */
typedef struct PrismForm {
    double lo, hi;
    bool is_conic, is_open;
    int degree; /* of the spans */
    uint32_t span_count;
    const CurveSpan *spans;
} PrismForm;
Shape *shape_prism(Arena *arena, const PrismForm *form);

/* Curves of (radius, height), turned around the y axis; open where they do not close.  spans: as in
 * PrismForm, but loops need not close. */
Shape *shape_lathe(Arena *arena, int degree, const CurveSpan *spans, uint32_t count);

/* All balls along a curve; negative radii are none. */
typedef struct SweepSpan {
    double c[3][SPLINE_POINTS_MAX]; /* Bernstein coefficients: of the centre's coordinates */
    double r[SPLINE_POINTS_MAX];    /* and of the radius */
} SweepSpan;

/* degree: 1 or 3.  spans: at least one; each begins where the one before ends, to the last bit;
 * borrowed. */
Shape *shape_sphere_sweep(Arena *arena, int degree, const SweepSpan *spans, uint32_t count);

/* Radii above 0, top < 2 bottom. */
Shape *shape_ovus(Arena *arena, double bottom, double top);

/* points: at least four of (radius, height); heights grow from the second to the last but one.  The
 * first and the last only set slopes. */
Shape *shape_sor(Arena *arena, const V2 *points, int count, bool is_open);

Shape *shape_julia(Arena *arena, const JuliaForm *form); /* form is copied */
Shape *shape_isosurface(Arena *arena, const Func *func, double threshold, const Shape *container,
                        bool is_open);

/* Return the largest slope of an isosurface's function that was found where surface may be. */
double shape_isosurface_steepest(const Shape *shape);


/* The points that functions of u and v give for u from lo.u to hi.u, v from lo.v to hi.v, where
 * they are within a box or a sphere: a sheet without an inside.  container: not transformed. */
Shape *shape_parametric(Arena *arena, const FuncTriple *func, V2 lo, V2 hi, const Shape *container);
Shape *shape_height_field(Arena *arena, const HeightData *data); /* after height_prepare */
/* kind: SHAPE_UNION, SHAPE_MERGE or SHAPE_INTERSECTION; children are borrowed. */
Shape *shape_csg(Arena *arena, ShapeKind kind, Shape **children, int child_count);

/* Apply a transform to a shape, its children and clips, in place.  Mesh data stays shared. */
void shape_transform(Shape *shape, const Xform *xform);

/* Deep copy (mesh data shared), or NULL. */
Shape *shape_copy(Arena *arena, const Shape *shape);

/* Swap inside and outside, in place: of a union, intersection or merge the children are inverted,
 * and it becomes an intersection or a merge.  So the inner walls of a union are gone for good. */
void shape_invert(Shape *shape);

/* Derive what speeds up the questions below (bounds of CSG children, an index of many), once the
 * shape, its children and clips are complete; nodes within nodes may dissolve.  Changing any of
 * them afterwards needs another call on the root.  Without it, or when memory is out, answers are
 * the same, only slower. */
void shape_finish(Arena *arena, Shape *shape);

/* --- asking (any thread) ---------------------------------------------------------------- */

bool shape_is_solid(const Shape *shape);

/* Return whether a leaf is a solid that its visible surface alone bounds. */
bool shape_is_closed(const Shape *leaf);

/* List every crossing of the whole line of `ray` (tmin and tmax are ignored), for solids and
 * CSG.  The list is replaced. */
void shape_crossings(const Shape *shape, const Ray *ray, ShapeScratch *scratch, CrossList *out);

/* Find the first visible crossing with tmin < t < tmax; does not build lists for primitives.
 * Returns false when there is none. */
bool shape_closest(const Shape *shape, const Ray *ray, ShapeScratch *scratch, Crossing *out);

/* List the visible crossings with tmin < t < tmax, of any shape; of several at the same t the
 * first.  To ask for the next one behind a crossing instead would not do: how a shape rounds t may
 * depend on which part of the ray is wanted, and the same wall be met twice.  The list is replaced.
 */
void shape_crossings_ahead(const Shape *shape, const Ray *ray, ShapeScratch *scratch,
                           CrossList *out);

/* Return whether there is a visible crossing with tmin < t < tmax: what shape_closest returns,
 * found for less. */
bool shape_is_met(const Shape *shape, const Ray *ray, ShapeScratch *scratch);

bool shape_is_inside(const Shape *shape, V3 p);

/* Refine and describe the point of a crossing.
 *
 * p        the point ray_at(t), pulled onto the surface where that can be done exactly.
 * p_error  bound on the distance of p from the surface, scene units, rounding of later
 *          rays from there included: a ray that starts p_error off the surface stays off it.
 * ng       geometric normal, unit, outward of the solid the crossing belongs to (is_flipped
 *          and is_inverted applied).
 * ns       interpolated normal of smooth triangles, else ng; same orientation. */
typedef struct ShapePoint {
    V3 p;
    double p_error;
    V3 ng, ns;
    V3 lift;         /* of smooth triangles: from p to about the curved surface that they stand for;
                        else 0 */
    bool has_inside; /* the surface is a solid's: ng tells its sides apart.  Those of triangles
                        beside each other may point either way. */
} ShapePoint;
void shape_point(const Crossing *crossing, const Ray *ray, ShapePoint *out);

/* Is the side that n points to the inside of a solid? */
static inline bool shape_point_is_inside(const ShapePoint *point, V3 n)
{
    return point->has_inside && v3_dot(point->ng, n) < 0;
}

/* Return the language's uv of the point p on `part` of `leaf`; u and v are the crossing's. */
V2 shape_uv(const Shape *leaf, uint32_t part, double u, double v, V3 p);

/* Which textures of a surface's list a leaf blends at a point. */
enum { SHAPE_BLEND_MAX = 12 };
typedef struct ShapeBlend {
    int count;
    uint32_t texture[SHAPE_BLEND_MAX]; /* or MESH_NO_TEXTURE: the surface's own */
    double weight[SHAPE_BLEND_MAX];    /* add up to 1 */
} ShapeBlend;

/* Find the blend of a leaf at a point of its surface; false if it has none.  Components of blobs
 * beyond the SHAPE_BLEND_MAX strongest textures are left out. */
bool shape_blend(const Shape *leaf, V3 p, ShapeBlend *out);

/* Return a box around all that can be seen of the shape; sides may be infinite (see
 * bound_is_finite). */
Bound shape_bound(const Shape *shape);

/* Return the point p of a primitive, not a plane or CSG, for which n . p is largest, up to
 * rounding; of a mesh, a point of the box around it.  n need not be of unit length. */
V3 shape_farthest(const Shape *leaf, V3 n);

/* Return true if the shape is a solid that every line is inside of along one stretch at most. */
bool shape_is_convex(const Shape *shape);

#endif
