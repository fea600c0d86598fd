/* Boxes.  Parts: 0 to 5 for the sides -x, +x, -y, +y, -z, +z.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape_int.h"

Shape *shape_box(Arena *arena, V3 corner, V3 opposite)
{
    Shape *shape = leaf_new(arena, SHAPE_BOX);
    if (!shape)
        return NULL;
    shape->u.box = (BoxParams){v3_min(corner, opposite), v3_max(corner, opposite)};
    leaf_place(shape, &XFORM_IDENTITY);
    return shape;
}

/* Where a line enters and leaves a box, and through which sides. */
typedef struct Passage {
    double in, out;
    uint32_t in_part, out_part;
} Passage;

/* Cut the passage to one pair of sides.  A line that runs along them has an infinite inverse:
 * then the t are infinite too, or, on a side, no numbers, and cut nothing. */
static inline void cut(Passage *p, double o, double inverse, double lo, double hi, uint32_t part)
{
    bool is_back = inverse < 0;
    double first = ((is_back ? hi : lo) - o) * inverse;
    double last = ((is_back ? lo : hi) - o) * inverse;
    if (first > p->in) {
        p->in = first;
        p->in_part = part + is_back;
    }
    if (last < p->out) {
        p->out = last;
        p->out_part = part + !is_back;
    }
}

/* Make the hit on a side: bound the error of the local coordinate there, the side's own rounding
 * included, and divide by the speed. */
static LeafHit side_hit(const Shape *shape, const LocalRay *ray, double t, uint32_t part,
                        int8_t change)
{
    int axis = (int)part >> 1;
    double side = fabs(v3_at(part & 1 ? shape->u.box.hi : shape->u.box.lo, axis));
    double far = fabs(v3_at(ray->o, axis)), d = fabs(v3_at(ray->d, axis));
    double error = PLACE_EPS * side + 2 * EPS_DOUBLE * far + v3_at(ray->o_error, axis) +
                   fabs(t) * v3_at(ray->d_error, axis);
    return (LeafHit){t, error / d + 4 * EPS_DOUBLE * fabs(t), part, change, true};
}

static void box_hits(const Shape *shape, const LocalRay *ray, LeafHits *out)
{
    const BoxParams *b = &shape->u.box;
    Passage p = {-INFINITY, INFINITY, 0, 0};
    cut(&p, ray->o.x, 1 / ray->d.x, b->lo.x, b->hi.x, 0);
    cut(&p, ray->o.y, 1 / ray->d.y, b->lo.y, b->hi.y, 2);
    cut(&p, ray->o.z, 1 / ray->d.z, b->lo.z, b->hi.z, 4);
    out->count = 0;
    out->is_inside_before = false;
    if (p.in < p.out) {
        out->count = 2;
        out->at[0] = side_hit(shape, ray, p.in, p.in_part, 1);
        out->at[1] = side_hit(shape, ray, p.out, p.out_part, -1);
    } else if (p.in == p.out && p.in_part >> 1 == p.out_part >> 1) {
        /* A box without thickness on this axis is a sheet. */
        out->count = 1;
        out->at[0] = side_hit(shape, ray, p.in, p.in_part, 0);
    }
}

static void box_point(const Shape *shape, const Crossing *crossing, V3 p, LocalPoint *out)
{
    static const V3 normals[6] = {{-1, 0, 0}, {1, 0, 0},  {0, -1, 0},
                                  {0, 1, 0},  {0, 0, -1}, {0, 0, 1}};
    V3 lo = shape->u.box.lo, hi = shape->u.box.hi;
    switch (crossing->part) {
    case 0:
        p.x = lo.x;
        break;
    case 1:
        p.x = hi.x;
        break;
    case 2:
        p.y = lo.y;
        break;
    case 3:
        p.y = hi.y;
        break;
    case 4:
        p.z = lo.z;
        break;
    default:
        p.z = hi.z;
        break;
    }
    out->p = p;
    out->ng = normals[crossing->part];
    double side = fabs(v3_dot(p, out->ng));
    out->error = PLACE_EPS * side;
}

static V2 box_uv(const Shape *shape, uint32_t part, double u, double v, V3 p)
{
    (void)u, (void)v;
    V3 lo = shape->u.box.lo, size = v3_sub(shape->u.box.hi, lo);
    double x = size.x > 0 ? (p.x - lo.x) / size.x : 0;
    double y = size.y > 0 ? (p.y - lo.y) / size.y : 0;
    double z = size.z > 0 ? (p.z - lo.z) / size.z : 0;
    switch (part) { /* a cross of six squares */
    case 0:
        return (V2){z / 4, (1 + y) / 3};
    case 1:
        return (V2){0.75 - z / 4, (1 + y) / 3};
    case 2:
        return (V2){(1 + x) / 4, z / 3};
    case 3:
        return (V2){(1 + x) / 4, 1 - z / 3};
    case 4:
        return (V2){1 - x / 4, (1 + y) / 3};
    default:
        return (V2){(1 + x) / 4, (1 + y) / 3};
    }
}

static bool box_is_inside(const Shape *shape, V3 p)
{
    V3 lo = shape->u.box.lo, hi = shape->u.box.hi;
    return p.x >= lo.x && p.x <= hi.x && p.y >= lo.y && p.y <= hi.y && p.z >= lo.z && p.z <= hi.z;
}

static Bound box_bound(const Shape *shape)
{
    Bound b = {shape->u.box.lo, shape->u.box.hi};
    return bound_pad(shape->is_transformed ? bound_transform(b, &shape->xform) : b);
}

static V3 box_farthest(const Shape *shape, V3 n)
{
    return bound_farthest((Bound){shape->u.box.lo, shape->u.box.hi}, n);
}

static bool box_transform(Shape *shape, const Xform *x)
{
    if (shape->is_transformed || !xform_is_plain(x))
        return false;
    shape->u.box.lo = xform_point(x, shape->u.box.lo);
    shape->u.box.hi = xform_point(x, shape->u.box.hi);
    return true;
}

const ShapeOps box_ops = {.hits = box_hits,
                          .point = box_point,
                          .uv = box_uv,
                          .is_inside = box_is_inside,
                          .bound = box_bound,
                          .farthest = box_farthest,
                          .transform = box_transform};
