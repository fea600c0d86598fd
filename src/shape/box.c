/* Boxes.  Parts: 0 to 5 for the sides -x, +x, -y, +y, -z, +z.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/shape_int.h"

bool chord_cut_slab(Chord *chord, double o, double d, double error, double lo, double hi,
                    uint32_t lo_part, uint32_t hi_part, bool is_visible)
{
    if (d == 0)
        return o >= lo && o <= hi;
    double first = (lo - o) / d, last = (hi - o) / d;
    if (d < 0) {
        double swap = first;
        first = last, last = swap;
        uint32_t swap_part = lo_part;
        lo_part = hi_part, hi_part = swap_part;
    }
    double per = 1 / fabs(d);
    if (first > chord->in.t)
        chord->in =
            (LeafHit){first, error * per + 4 * EPS_DOUBLE * fabs(first), lo_part, 1, is_visible};
    if (last < chord->out.t)
        chord->out =
            (LeafHit){last, error * per + 4 * EPS_DOUBLE * fabs(last), hi_part, -1, is_visible};
    return chord->in.t <= chord->out.t;
}

void chord_hits(const Chord *chord, LeafHits *out)
{
    out->count = 0;
    out->is_inside_before = chord->in.t == -INFINITY;
    if (chord->in.t > -INFINITY)
        out->at[out->count++] = chord->in;
    if (chord->out.t < INFINITY)
        out->at[out->count++] = chord->out;
}

/* Bound the error of the local coordinate on one axis where the line meets the slab's sides;
 * the sides' own rounding included. */
static double axis_error(double o, double o_error, double d, double d_error, double lo, double hi)
{
    double side = fmax(fabs(lo), fabs(hi));
    double error = PLACE_EPS * side + 2 * EPS_DOUBLE * fabs(o) + o_error;
    return d_error > 0 ? error + d_error * (fabs(o) + side) / fabs(d) : error;
}

void box_hits(const Shape *shape, const LocalRay *ray, LeafHits *out)
{
    V3 lo = shape->u.box.lo, hi = shape->u.box.hi;
    Chord chord = CHORD_LINE;
    out->count = 0;
    out->is_inside_before = false;
#define CUT(axis, part)                                                                            \
    if (!chord_cut_slab(&chord, ray->o.axis, ray->d.axis,                                          \
                        axis_error(ray->o.axis, ray->o_error.axis, ray->d.axis, ray->d_error.axis, \
                                   lo.axis, hi.axis),                                              \
                        lo.axis, hi.axis, part, part + 1, true))                                   \
        return;
    CUT(x, 0)
    CUT(y, 2)
    CUT(z, 4)
#undef CUT
    if (chord.in.t < chord.out.t) {
        chord_hits(&chord, out);
    } else if (chord.in.part >> 1 == chord.out.part >> 1) {
        /* A box without thickness on this axis is a sheet. */
        out->count = 1;
        out->at[0] = chord.in;
        out->at[0].change = 0;
    }
}

void box_point(const Shape *shape, uint32_t part, V3 p, LocalPoint *out)
{
    static const V3 normals[6] = {{-1, 0, 0}, {1, 0, 0},  {0, -1, 0},
                                  {0, 1, 0},  {0, 0, -1}, {0, 0, 1}};
    V3 lo = shape->u.box.lo, hi = shape->u.box.hi;
    switch (part) {
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
    out->n = normals[part];
    double side = fabs(v3_dot(p, normals[part]));
    out->error = PLACE_EPS * side;
}

V2 box_uv(const Shape *shape, uint32_t part, V3 p)
{
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

bool box_is_inside(const Shape *shape, V3 p)
{
    V3 lo = shape->u.box.lo, hi = shape->u.box.hi;
    return p.x >= lo.x && p.x <= hi.x && p.y >= lo.y && p.y <= hi.y && p.z >= lo.z && p.z <= hi.z;
}

Bound box_bound(const Shape *shape)
{
    Bound b = {shape->u.box.lo, shape->u.box.hi};
    return bound_pad(shape->is_transformed ? bound_transform(b, &shape->xform) : b);
}
