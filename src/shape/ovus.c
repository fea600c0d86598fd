/* Eggs around the y axis: a ball at the bottom, one on top, and an arc that joins them smoothly.
 * Part: 0.
 *
 * The arc's centre lies beyond the axis; the lines from there through the centres of the balls part
 * what is nearest to each of the three.  SPDX-License-Identifier: Apache-2.0 */
#include "shape/convex_line.h"
#include "shape/revolve_int.h"

Shape *shape_ovus(Arena *arena, double bottom, double top)
{
    Shape *shape = leaf_new(arena, SHAPE_OVUS);
    if (!shape)
        return NULL;
    OvusParams *o = &shape->u.ovus;
    o->bottom = bottom;
    o->top = top;
    if (bottom > top) {
        o->arc = 2 * bottom;
        o->height = 2 * top - bottom - top * top / (2 * bottom);
        o->beyond = sqrt(num_max(0, bottom * bottom - o->height * o->height));
    } else {
        double over =
            3 * top * top / (2 * bottom) - 2 * top; /* the centre above the upper ball's */
        o->arc = 2 * top;
        o->height = bottom + over;
        o->beyond = sqrt(num_max(0, top * top - over * over));
    }
    leaf_place(shape, &XFORM_IDENTITY);
    return shape;
}

/* What of the egg is nearest to a point: a ball, or the arc's, with its centre in the point's
 * half-plane. */
typedef struct OvusPart {
    double rho, y; /* centre; rho < 0: beyond the axis */
    double radius;
} OvusPart;

static OvusPart part_at(const OvusParams *o, double rho, double y)
{
    /* From the arc's centre: the sides of the lines to the balls' centres. */
    double x = rho + o->beyond, v = y - o->height;
    if (o->beyond * v < -o->height * x)
        return (OvusPart){0, 0, o->bottom};
    if (o->beyond * v > (o->bottom - o->height) * x)
        return (OvusPart){0, o->bottom, o->top};
    return (OvusPart){-o->beyond, o->height, o->arc};
}

typedef struct OvusLine {
    const OvusParams *ovus;
    const LocalRay *ray;
    V3 f, e;            /* e unit */
    double base, speed; /* t = base + s / speed */
} OvusLine;

static double ovus_distance(const void *line, double s, double *slope)
{
    const OvusLine *l = line;
    V3 p = v3_mad(l->f, s, l->e);
    double rho = sqrt(p.x * p.x + p.z * p.z);
    OvusPart part = part_at(l->ovus, rho, p.y);
    double x = rho - part.rho, y = p.y - part.y, far = sqrt(x * x + y * y);
    double turn = rho > 0 ? (p.x * l->e.x + p.z * l->e.z) / rho : 0;
    *slope = (x * turn + y * l->e.y) / far;
    return far - part.radius;
}

static double ovus_radius(const OvusParams *o)
{
    return num_max(o->arc - o->beyond, num_max(o->bottom, o->top));
}

static double ovus_size(const Shape *shape)
{
    return ovus_radius(&shape->u.ovus) + 2 * shape->u.ovus.bottom + shape->u.ovus.top;
}

static V3 ovus_normal(const OvusParams *o, V3 p, OvusPart *part)
{
    double rho = sqrt(p.x * p.x + p.z * p.z);
    *part = part_at(o, rho, p.y);
    double out = rho > 0 ? 1 - part->rho / rho : 0;
    return v3_unit(v3(p.x * out, p.y - part->y, p.z * out));
}

/* Set up a line; false when it misses the ball around the egg, else it is outside beyond *reach. */
static bool line_begin(OvusLine *l, const Shape *shape, const LocalRay *ray, double *reach)
{
    const OvusParams *o = &shape->u.ovus;
    double speed2 = v3_len2(ray->d), middle = 0.5 * o->top, half = o->bottom + middle;
    double r = ovus_radius(o);
    l->ovus = o;
    l->ray = ray;
    l->speed = sqrt(speed2);
    l->base = v3_dot(v3_sub(v3(0, middle, 0), ray->o), ray->d) / speed2;
    l->f = v3_mad(ray->o, l->base, ray->d);
    l->e = v3_scale(ray->d, 1 / l->speed);
    double off = l->f.x * l->f.x + l->f.z * l->f.z + (l->f.y - middle) * (l->f.y - middle);
    double room = (r * r + half * half) * (1 + 0x1p-40) - off;
    *reach = sqrt(num_max(room, 0));
    return room > 0;
}

static LeafHit hit_at(const Shape *shape, const OvusLine *l, double s, bool is_entry)
{
    OvusPart part;
    V3 n = ovus_normal(l->ovus, v3_mad(l->f, s, l->e), &part);
    double t = l->base + s / l->speed;
    double off = v3_sum_abs(local_error(l->ray, t)) + PLACE_EPS * ovus_size(shape);
    double error = off / fabs(v3_dot(n, l->ray->d)) + 4 * EPS_DOUBLE * (fabs(l->base) + fabs(t));
    return (LeafHit){t, error, 0, is_entry ? 1 : -1, true};
}

static void ovus_hits(const Shape *shape, const LocalRay *ray, LeafHits *out)
{
    OvusLine l;
    double reach, ends[2], precision = 2 * EPS_DOUBLE * ovus_size(shape);
    out->count = 0;
    out->is_inside_before = false;
    if (!line_begin(&l, shape, ray, &reach) ||
        !convex_line_cross(ovus_distance, &l, -reach, reach, precision, &ends[0], &ends[1]))
        return;
    out->at[0] = hit_at(shape, &l, ends[0], true);
    out->at[1] = hit_at(shape, &l, ends[1], false);
    out->count = 2;
}

static bool ovus_closest(const Shape *shape, const Ray *ray, ShapeScratch *scratch, Crossing *out)
{
    (void)scratch;
    LocalRay local;
    OvusLine l;
    double reach, s, precision = 2 * EPS_DOUBLE * ovus_size(shape);
    bool is_entry;
    local_ray(shape, ray, &local);
    if (!line_begin(&l, shape, &local, &reach))
        return false;
    double lo = num_max(-reach, (ray->tmin - l.base) * l.speed);
    double hi = num_min(reach, (ray->tmax - l.base) * l.speed);
    if (!(lo < hi) ||
        !convex_line_first(ovus_distance, &l, lo, hi, reach, precision, &s, &is_entry))
        return false;
    LeafHit hit = hit_at(shape, &l, s, is_entry);
    crossing_fill(shape, &hit, out);
    return hit.t > ray->tmin && hit.t < ray->tmax;
}

static void ovus_point(const Shape *shape, const Crossing *crossing, V3 p, LocalPoint *out)
{
    (void)crossing;
    OvusPart part;
    out->ng = ovus_normal(&shape->u.ovus, p, &part);
    double rho = sqrt(p.x * p.x + p.z * p.z), to_center = rho > 0 ? part.rho / rho : 0;
    out->p = v3_mad(v3(p.x * to_center, part.y, p.z * to_center), part.radius, out->ng);
    out->error = 2 * PLACE_EPS * (ovus_size(shape) + part.radius);
}

/* As that of a sphere whose centre is half the upper radius above the lower ball's. */
static V2 ovus_uv(const Shape *shape, uint32_t part, double u, double v, V3 p)
{
    (void)part, (void)u, (void)v;
    double y = p.y - 0.5 * shape->u.ovus.top;
    return (V2){revolve_turn(p), 0.5 + atan2(y, sqrt(p.x * p.x + p.z * p.z)) / PMS_PI};
}

static bool ovus_is_inside(const Shape *shape, V3 p)
{
    double rho = sqrt(p.x * p.x + p.z * p.z);
    OvusPart part = part_at(&shape->u.ovus, rho, p.y);
    double x = rho - part.rho, y = p.y - part.y;
    return x * x + y * y < part.radius * part.radius;
}

static Bound ovus_bound(const Shape *shape)
{
    const OvusParams *o = &shape->u.ovus;
    double r = ovus_radius(o) * (1 + 8 * EPS_DOUBLE);
    return circles_bound(shape, r, -o->bottom, r, o->bottom + o->top);
}

static V3 ovus_farthest(const Shape *shape, V3 n)
{
    const OvusParams *o = &shape->u.ovus;
    V3 unit = v3_unit(n);
    double across = sqrt(unit.x * unit.x + unit.z * unit.z);
    /* The part whose normals point that way is the one found in that direction from the arc. */
    OvusPart part = part_at(o, across * o->arc - o->beyond, unit.y * o->arc + o->height);
    V3 center = v3(0, part.y, 0);
    if (across > 0)
        center = v3(unit.x / across * part.rho, part.y, unit.z / across * part.rho);
    return v3_mad(center, part.radius, unit);
}

const ShapeOps ovus_ops = {.hits = ovus_hits,
                           .closest = ovus_closest,
                           .point = ovus_point,
                           .uv = ovus_uv,
                           .is_inside = ovus_is_inside,
                           .bound = ovus_bound,
                           .farthest = ovus_farthest,
                           .size = ovus_size};
