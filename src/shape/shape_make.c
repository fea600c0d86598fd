/* Making shapes and changing them.  SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape_int.h"

/* Is this a scaling along the axes, by positive factors, and a move? */
static bool is_scale_and_move(const Xform *x)
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
    return is_scale_and_move(x) && is_uniform(x) && frexp(x->to[0][0], &exponent) == 0.5 &&
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
    double size = 0;
    switch (s->kind) {
    case SHAPE_SPHERE:
        size = v3_sum_abs(s->u.sphere.center) + s->u.sphere.radius;
        break;
    case SHAPE_PLANE:
        size = fabs(s->u.plane.distance);
        break;
    case SHAPE_TRIANGLE:
        for (int i = 0; i < 3; i++)
            size = num_max(size, v3_sum_abs(s->u.triangle.corner[i]));
        break;
    case SHAPE_MESH:
        if (!bound_is_empty(s->u.mesh->bound))
            size = num_max(v3_max_abs(s->u.mesh->bound.lo), v3_max_abs(s->u.mesh->bound.hi));
        break;
    default:
        break; /* the others account for it per axis */
    }
    r->place = PLACE_EPS * size;
    r->is_exact = is_exact(x);
}

static Shape *shape_new(Arena *arena, ShapeKind kind)
{
    Shape *shape = ARENA_NEW(arena, Shape);
    if (shape) {
        shape->kind = kind;
        shape->xform = XFORM_IDENTITY;
    }
    return shape;
}

static void set_xform(Shape *shape, const Xform *xform)
{
    shape->xform = *xform;
    shape->is_transformed = !xform_is_identity(xform);
    derive_rounding(shape);
}

Shape *shape_sphere(Arena *arena, V3 center, double radius)
{
    Shape *shape = shape_new(arena, SHAPE_SPHERE);
    if (!shape)
        return NULL;
    shape->u.sphere = (SphereParams){center, radius};
    derive_rounding(shape);
    return shape;
}

Shape *shape_box(Arena *arena, V3 corner, V3 opposite)
{
    Shape *shape = shape_new(arena, SHAPE_BOX);
    if (!shape)
        return NULL;
    shape->u.box = (BoxParams){v3_min(corner, opposite), v3_max(corner, opposite)};
    derive_rounding(shape);
    return shape;
}

Shape *shape_cone(Arena *arena, V3 bottom, double bottom_radius, V3 top, double top_radius,
                  bool is_open)
{
    Shape *shape = shape_new(arena, SHAPE_CONE);
    if (!shape)
        return NULL;
    V3 axis = v3_sub(top, bottom), n = v3_unit(axis), s, t;
    shape->u.cone = (ConeParams){bottom_radius, top_radius, v3_dot(axis, n), is_open};
    v3_frame(n, &s, &t);
    Xform place = xform_frame(s, t, n, bottom);
    set_xform(shape, &place);
    return shape;
}

Shape *shape_plane(Arena *arena, V3 normal, double distance)
{
    Shape *shape = shape_new(arena, SHAPE_PLANE);
    if (!shape)
        return NULL;
    shape->u.plane = (PlaneParams){v3_unit(normal), distance};
    derive_rounding(shape);
    return shape;
}

Shape *shape_torus(Arena *arena, double major, double minor)
{
    Shape *shape = shape_new(arena, SHAPE_TORUS);
    if (!shape)
        return NULL;
    shape->u.torus = (TorusParams){major, minor};
    derive_rounding(shape);
    return shape;
}

Shape *shape_disc(Arena *arena, V3 center, V3 normal, double radius, double hole)
{
    Shape *shape = shape_new(arena, SHAPE_DISC);
    if (!shape)
        return NULL;
    shape->u.disc = (DiscParams){hole, radius};
    V3 n = v3_unit(normal), s, t;
    v3_frame(n, &s, &t);
    Xform place = xform_frame(s, t, n, center);
    set_xform(shape, &place);
    return shape;
}

Shape *shape_triangle(Arena *arena, const V3 corner[3], const V3 *normal_or_null)
{
    Shape *shape = shape_new(arena, SHAPE_TRIANGLE);
    if (!shape)
        return NULL;
    shape->u.triangle.is_smooth = normal_or_null != NULL;
    for (int i = 0; i < 3; i++) {
        shape->u.triangle.corner[i] = corner[i];
        if (normal_or_null)
            shape->u.triangle.normal[i] = v3_unit(normal_or_null[i]);
    }
    derive_rounding(shape);
    return shape;
}

Shape *shape_mesh(Arena *arena, const MeshData *mesh)
{
    Shape *shape = shape_new(arena, SHAPE_MESH);
    if (!shape)
        return NULL;
    shape->u.mesh = mesh;
    derive_rounding(shape);
    return shape;
}

Shape *shape_csg(Arena *arena, ShapeKind kind, Shape **children, int child_count)
{
    Shape *shape = shape_new(arena, kind);
    if (!shape)
        return NULL;
    shape->children = children;
    shape->child_count = child_count;
    return shape;
}

/* Scaling alike in all directions leaves normals as they are, to the last bit: making them unit
 * again would not. */
static bool keeps_normals(const Xform *x)
{
    return is_scale_and_move(x) && is_uniform(x);
}

static V3 transform_normal(V3 n, const Xform *x)
{
    return keeps_normals(x) ? n : v3_unit(xform_normal(x, n));
}

static void transform_plane(PlaneParams *plane, const Xform *x)
{
    V3 moved = v3(x->from[0][3], x->from[1][3], x->from[2][3]);
    double length = keeps_normals(x) ? x->from[0][0] : v3_len(xform_normal(x, plane->normal));
    plane->distance = (plane->distance - v3_dot(plane->normal, moved)) / length;
    plane->normal = transform_normal(plane->normal, x);
}

static void transform_triangle(TriangleParams *triangle, const Xform *x)
{
    for (int i = 0; i < 3; i++) {
        triangle->corner[i] = xform_point(x, triangle->corner[i]);
        triangle->normal[i] = transform_normal(triangle->normal[i], x);
    }
}

static void transform_leaf(Shape *shape, const Xform *x)
{
    bool is_plain = !shape->is_transformed && is_scale_and_move(x);
    if (shape->kind == SHAPE_PLANE) {
        transform_plane(&shape->u.plane, x);
    } else if (shape->kind == SHAPE_TRIANGLE) {
        transform_triangle(&shape->u.triangle, x);
    } else if (shape->kind == SHAPE_SPHERE && is_plain && is_uniform(x)) {
        shape->u.sphere.center = xform_point(x, shape->u.sphere.center);
        shape->u.sphere.radius *= x->to[0][0];
    } else if (shape->kind == SHAPE_BOX && is_plain) {
        shape->u.box.lo = xform_point(x, shape->u.box.lo);
        shape->u.box.hi = xform_point(x, shape->u.box.hi);
    } else {
        Xform both = xform_then(&shape->xform, x);
        set_xform(shape, &both);
    }
    derive_rounding(shape);
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
    shape->is_inverted = !shape->is_inverted;
    shape->is_finished = false;
}

/* Pack the reaches of a node's children; returns NULL when there are none or memory is out. */
static const ReachBlock *pack_reaches(Arena *arena, const Shape *node)
{
    if (node->child_count == 0)
        return NULL;
    int blocks = (node->child_count + BLOCK - 1) / BLOCK;
    ReachBlock *out = ARENA_ARRAY(arena, ReachBlock, (size_t)blocks);
    for (int i = 0; out && i < blocks * BLOCK; i++) {
        ReachBlock *block = &out[i / BLOCK];
        Bound reach = i < node->child_count ? node->children[i]->reach : BOUND_EMPTY;
        for (int axis = 0; axis < 3; axis++) {
            block->lo[axis][i % BLOCK] = v3_at(reach.lo, axis);
            block->hi[axis][i % BLOCK] = v3_at(reach.hi, axis);
        }
        if (i < node->child_count)
            block->is_inside_beyond[i % BLOCK] = node->children[i]->is_inside_beyond;
    }
    return out;
}

void shape_finish(Arena *arena, Shape *shape)
{
    for (int i = 0; i < shape->child_count; i++)
        shape_finish(arena, shape->children[i]);
    for (int i = 0; i < shape->clip_count; i++)
        shape_finish(arena, shape->clips[i]);
    shape->reach = shape_reach(shape, &shape->is_inside_beyond);
    shape->reaches = pack_reaches(arena, shape);
    shape->is_convex_leaf = shape_is_convex_leaf(shape);
    shape->convex_count = 0;
    for (int i = 0; i < shape->child_count; i++)
        shape->convex_count += shape->children[i]->is_convex_leaf;
    convex_pack_planes(arena, shape);
    shape->is_finished = true;
}
