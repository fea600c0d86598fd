/* What lathe and sor share: lines and the pieces near them, lids, entering and leaving in turn.
 * Parts: the pieces, then the lids.  A crossing's u is the place on the piece, v the side of its
 * normal (of a lid: of y) that is outside.  SPDX-License-Identifier: Apache-2.0 */
#include "shape/revolve_int.h"

#include "math/bernstein.h"

#include <stdlib.h>

/* Room around what must not be missed, relative; rounding needs far less. */
#define MARGIN 0x1p-30

static double radius_of(const RevolveData *data, double r)
{
    return data->is_square ? sqrt(num_max(r, 0)) : fabs(r);
}

/* Return the range of radii and heights of a piece: x and y of a box. */
static Bound piece_box(const RevolveData *data, const RevolvePiece *piece)
{
    double lo = INFINITY, hi = -INFINITY;
    bernstein_range(piece->r, data->degree, &lo, &hi);
    Bound b = BOUND_EMPTY;
    double y0 = piece->y[0], y1 = piece->y[data->is_square ? 1 : data->degree];
    double least = lo < 0 && hi > 0 ? 0 : num_min(radius_of(data, lo), radius_of(data, hi));
    b.lo = v3(least, num_min(y0, y1), 0);
    b.hi = v3(num_max(radius_of(data, lo), radius_of(data, hi)), num_max(y0, y1), 0);
    return b;
}

static int by_height(const void *a, const void *b)
{
    const RevolveLid *x = a, *y = b;
    return (x->y > y->y) - (x->y < y->y);
}

Shape *revolve_place(Arena *arena, Shape *shape, RevolveData *data)
{
    Bound *boxes = ARENA_ARRAY(arena, Bound, data->piece_count), all = BOUND_EMPTY;
    if (!shape || !boxes)
        return NULL;
    for (uint32_t i = 0; i < data->piece_count; i++) {
        boxes[i] = piece_box(data, &data->pieces[i]);
        all = bound_union(all, boxes[i]);
    }
    data->r_max = all.hi.x;
    data->y_lo = all.lo.y;
    data->y_hi = all.hi.y;
    if (data->lid_count)
        qsort(data->lids, data->lid_count, sizeof *data->lids, by_height);
    if (!box_tree_new(arena, boxes, data->piece_count, &data->tree))
        return NULL;
    shape->u.revolve = data;
    leaf_place(shape, &XFORM_IDENTITY);
    return shape;
}

/* --- a line and a piece -------------------------------------------------------------------- */

/* Return u where a piece is at height y, of which it is on both sides. */
static double u_at(const RevolveData *data, const RevolvePiece *piece, double y)
{
    if (data->is_square)
        return num_max(0, num_min(1, (y - piece->y[0]) / (piece->y[1] - piece->y[0])));
    double over[4], roots[4];
    for (int i = 0; i <= data->degree; i++)
        over[i] = piece->y[i] - y;
    if (bernstein_roots(over, data->degree, roots))
        return roots[0];
    return fabs(over[0]) < fabs(over[data->degree]) ? 0 : 1; /* rounded to beyond an end */
}

/* Return s where a piece ends. */
static double end_s(const RevolveData *data, const RevolvePiece *piece, const RevolveLine *l,
                    int end)
{
    return (piece->y[end ? (data->is_square ? 1 : data->degree) : 0] - l->f.y) / l->e.y;
}

/* Cut a level line's piece, which it is on both sides of, if it is. */
static bool cut_level(const RevolveData *data, const RevolvePiece *piece, const RevolveLine *l,
                      RevolvePart *out)
{
    double y0 = piece->y[0], y1 = piece->y[data->is_square ? 1 : data->degree];
    bool is_below[2] = {y0 - l->f.y < 0, y1 - l->f.y < 0};
    if (is_below[0] == is_below[1])
        return false;
    out->from = out->to = u_at(data, piece, l->f.y);
    out->s[0] = is_below[0] ? l->near : l->far;
    out->s[1] = is_below[0] ? l->far : l->near;
    out->is_tiny = out->is_cut[0] = out->is_cut[1] = true;
    return true;
}

/* Cut a piece to where crossings are wanted; false when that is nothing. */
static bool cut_piece(const RevolveData *data, const RevolvePiece *piece, const RevolveLine *l,
                      RevolvePart *out)
{
    *out = (RevolvePart){.from = 0, .to = 1};
    if (l->e.y == 0)
        return cut_level(data, piece, l, out);
    for (int end = 0; end < 2; end++)
        out->s[end] = end_s(data, piece, l, end);
    if (num_max(out->s[0], out->s[1]) < l->near || num_min(out->s[0], out->s[1]) > l->far)
        return false;
    /* Where the line is further out than all pieces, a little more does no harm, and cutting it off
     * costs more. */
    double room = 2 * (l->hi - l->lo);
    double lo = l->near - (l->near > l->lo ? 0 : room), hi = l->far + (l->far < l->hi ? 0 : room);
    for (int end = 0; end < 2; end++) {
        double s = out->s[end];
        if (s >= lo && s <= hi)
            continue;
        out->s[end] = s < lo ? l->near : l->far;
        out->is_cut[end] = true;
        *(end ? &out->to : &out->from) = u_at(data, piece, l->f.y + out->s[end] * l->e.y);
    }
    double size = num_max(fabs(data->y_lo), fabs(data->y_hi));
    out->is_tiny = fabs(out->s[1] - out->s[0]) * fabs(l->e.y) <= MARGIN * size;
    return true;
}

/* --- lines --------------------------------------------------------------------------------- */

/* Set up a line; false when it misses the cylinder around the profile. */
static bool line_begin(RevolveLine *l, const RevolveData *data, const LocalRay *ray,
                       const Line *line)
{
    double speed2 = v3_len2(ray->d), middle = 0.5 * (data->y_lo + data->y_hi);
    l->base = v3_dot(v3_sub(v3(0, middle, 0), ray->o), ray->d) / speed2;
    l->speed = sqrt(speed2);
    l->tmin = line->near;
    l->f = v3_mad(ray->o, l->base, ray->d);
    l->e = v3_scale(ray->d, 1 / l->speed);
    l->lo = -INFINITY;
    l->hi = INFINITY;
    l->axis = 0;
    l->per_y = 1 / l->e.y;
    double size = num_max(data->r_max, num_max(fabs(data->y_lo), fabs(data->y_hi)));
    double y_lo = data->y_lo - MARGIN * size, y_hi = data->y_hi + MARGIN * size;
    if (l->e.y != 0) {
        double a = (y_lo - l->f.y) / l->e.y, b = (y_hi - l->f.y) / l->e.y;
        l->lo = num_min(a, b);
        l->hi = num_max(a, b);
    } else if (l->f.y < y_lo || l->f.y > y_hi) {
        return false;
    }
    double across = l->e.x * l->e.x + l->e.z * l->e.z, r = data->r_max * (1 + MARGIN);
    double cross = l->f.x * l->e.z - l->f.z * l->e.x;
    double room = r * r * across - cross * cross;
    if (room > 0) {
        double half = sqrt(room) / across;
        l->axis = -(l->f.x * l->e.x + l->f.z * l->e.z) / across;
        l->lo = num_max(l->lo, l->axis - half);
        l->hi = num_min(l->hi, l->axis + half);
    } else if (across != 0 || l->f.x * l->f.x + l->f.z * l->f.z >= r * r) {
        return false;
    }
    l->near = num_max(l->lo, (line->near - l->base) * l->speed);
    l->far = num_min(l->hi, (line->far - l->base) * l->speed);
    return l->near < l->far;
}

/* Can the line cross a piece in a box of radii and heights? */
static bool is_near(const RevolveLine *l, const Bound *box, double size)
{
    double lo = l->lo, hi = l->far, pad = 0x1p-45 * size;
    if (l->e.y != 0) {
        double a = (box->lo.y - pad - l->f.y) * l->per_y;
        double b = (box->hi.y + pad - l->f.y) * l->per_y;
        lo = num_max(lo, num_min(a, b));
        hi = num_min(hi, num_max(a, b));
        if (lo > hi)
            return false;
    } else if (l->f.y < box->lo.y - pad || l->f.y > box->hi.y + pad) {
        return false;
    }
    double inner = (box->lo.x - pad) * (1 - MARGIN), outer = (box->hi.x + pad) * (1 + MARGIN);
    if (inner > 0) {
        double x0 = l->f.x + lo * l->e.x, z0 = l->f.z + lo * l->e.z;
        double x1 = l->f.x + hi * l->e.x, z1 = l->f.z + hi * l->e.z;
        if (num_max(x0 * x0 + z0 * z0, x1 * x1 + z1 * z1) < inner * inner)
            return false;
    }
    double s = num_max(lo, num_min(hi, l->axis));
    double x = l->f.x + s * l->e.x, z = l->f.z + s * l->e.z;
    return x * x + z * z <= outer * outer;
}

/* Is the line, where a piece ends, less far out than that? */
static bool is_within_end(const RevolveData *data, const RevolvePiece *piece, const RevolveLine *l,
                          int end)
{
    double s = end_s(data, piece, l, end);
    if (!(s > l->lo && s < l->hi))
        return false;
    double x = l->f.x + l->e.x * s, z = l->f.z + l->e.z * s;
    double r = piece->r[end ? data->degree : 0];
    return x * x + z * z - (data->is_square ? r : r * r) < 0;
}

/* Push the crossings of a piece that are wanted; returns whether an odd number lies before. */
static bool push_piece(const RevolveData *data, uint32_t number, const RevolveLine *l,
                       ShapeScratch *scratch)
{
    RevolveRoot roots[REVOLVE_ROOTS_MAX];
    RevolvePart part;
    const RevolvePiece *piece = &data->pieces[number];
    bool is_within[2], has_before = l->near > l->lo;
    if (!cut_piece(data, piece, l, &part)) {
        double first = end_s(data, piece, l, 0);
        return has_before && l->e.y != 0 && first < l->near &&
               is_within_end(data, piece, l, 0) != is_within_end(data, piece, l, 1);
    }
    int count = data->is_square ? sor_roots(data, piece, &part, l, roots, is_within)
                                : lathe_roots(data, piece, &part, l, roots, is_within);
    bool is_rising = is_within[0];
    for (int i = 0; i < count; i++, is_rising = !is_rising) {
        /* v: whether the line goes along the piece's normal. */
        double along = is_rising == (l->e.y >= 0) ? 1 : -1;
        Crossing c = {.t = roots[i].s,
                      .t_error = roots[i].terms,
                      .part = number,
                      .u = roots[i].u,
                      .v = along};
        scratch_push(scratch, &c);
    }
    int low = part.s[0] <= part.s[1] ? 0 : 1;
    if (!has_before || !part.is_cut[low])
        return false;
    return is_within[low] != (l->e.y != 0 && is_within_end(data, piece, l, low));
}

/* Is what happens at s seen, once t is rounded? */
static bool is_after_start(const RevolveLine *l, double s)
{
    return l->base + s / l->speed > l->tmin;
}

/* Push the crossings of all pieces; returns whether an odd number lies before what is wanted. */
static bool push_pieces(const RevolveData *data, RevolveLine *l, bool is_first_only,
                        ShapeScratch *scratch)
{
    uint32_t stack[BOX_TREE_DEPTH_MAX], count = 1;
    double size = data->r_max + num_max(fabs(data->y_lo), fabs(data->y_hi));
    bool is_odd = false;
    stack[0] = 0;
    while (count) {
        const BoxNode *node = &data->tree.nodes[stack[--count]];
        if (!is_near(l, &node->box, size))
            continue;
        for (uint32_t i = 0; i < node->count; i++) {
            int from = scratch->count;
            is_odd ^= push_piece(data, data->tree.items[node->first + i], l, scratch);
            for (int k = from; is_first_only && k < scratch->count; k++)
                if (is_after_start(l, scratch->items[k].t))
                    l->far = num_max(l->near, num_min(l->far, scratch->items[k].t));
        }
        if (!node->count) {
            /* First the one that the line comes to first, as far as heights tell. */
            const Bound *a = &data->tree.nodes[node->first].box, *b = a;
            b = &data->tree.nodes[node->first + 1].box;
            bool is_swapped = (a->lo.y + a->hi.y - b->lo.y - b->hi.y) * l->e.y > 0;
            stack[count++] = node->first + !is_swapped;
            stack[count++] = node->first + is_swapped;
        }
    }
    return is_odd;
}

/* Push the lids that are crossed; of several at one height, one if that is an odd number.  Returns
 * whether an odd number lies before what is wanted. */
static bool push_lids(const RevolveData *data, const RevolveLine *l, ShapeScratch *scratch)
{
    bool is_odd = false;
    for (uint32_t i = 0; l->e.y != 0 && i < data->lid_count;) {
        const RevolveLid *lid = &data->lids[i];
        double s = (lid->y - l->f.y) / l->e.y;
        double x = l->f.x + l->e.x * s, z = l->f.z + l->e.z * s;
        bool is_crossed = false;
        Crossing c = {.t = s, .part = data->piece_count + i, .v = l->e.y > 0 ? 1 : -1};
        for (; i < data->lid_count && data->lids[i].y == lid->y; i++) {
            double r = data->lids[i].r, square = data->is_square ? r : r * r;
            is_crossed ^= x * x + z * z - square < 0;
        }
        if (is_crossed && s < l->near)
            is_odd = !is_odd;
        else if (is_crossed)
            scratch_push(scratch, &c);
    }
    return is_odd;
}

/* Return the normal of a piece at u and a point of it, unit unless there is none. */
static V3 piece_normal(const RevolveData *data, const RevolvePiece *piece, double u, V3 p)
{
    double r_slope, y_slope, rho = sqrt(p.x * p.x + p.z * p.z);
    double r = bernstein_at(piece->r, data->degree, u, &r_slope);
    if (data->is_square)
        return v3_unit(v3(p.x, -0.5 * r_slope / (piece->y[1] - piece->y[0]), p.z));
    bernstein_at(piece->y, data->degree, u, &y_slope);
    if (r_slope == 0 && y_slope == 0) { /* a cusp: as it is beside it */
        double beside = u < 0.5 ? u + 0x1p-20 : u - 0x1p-20;
        bernstein_at(piece->r, data->degree, beside, &r_slope);
        bernstein_at(piece->y, data->degree, beside, &y_slope);
    }
    if (rho == 0)
        return v3(0, r_slope < 0 ? 1 : -1, 0);
    return v3_unit(v3(y_slope * p.x / rho, r < 0 ? r_slope : -r_slope, y_slope * p.z / rho));
}

/* Finish a crossing found by push_piece or push_lids; t is s, t_error the terms of a root. */
static void finish(const Shape *shape, const RevolveLine *l, const LocalRay *ray, const Line *line,
                   bool is_entry, Crossing *c)
{
    const RevolveData *data = shape->u.revolve;
    double s = c->t, t = l->base + s / l->speed, terms = c->t_error;
    bool is_lid = c->part >= data->piece_count;
    c->t = t;
    c->t_error = 4 * EPS_DOUBLE * (fabs(l->base) + fabs(t));
    if (line_wants(line, t)) {
        V3 n = v3(0, 1, 0), p = v3_mad(l->f, s, l->e);
        if (!is_lid)
            n = piece_normal(data, &data->pieces[c->part], c->u, p);
        double off = v3_sum_abs(local_error(ray, t)) + PLACE_EPS * revolve_size(shape);
        if (terms > 0)
            off += 40 * EPS_DOUBLE * terms / sqrt(p.x * p.x + p.z * p.z);
        c->t_error += off / fabs(v3_dot(n, ray->d));
    }
    c->leaf = shape;
    c->change = c->leaf_change = is_entry ? 1 : -1;
    c->is_visible = !(is_lid && shape->is_open);
    c->v = is_entry == (c->v < 0) ? 1 : -1;
}

bool revolve_list(const Shape *shape, const Line *line, ShapeScratch *scratch)
{
    LocalRay ray;
    RevolveLine l;
    local_ray(shape, line->ray, &ray);
    if (!line_begin(&l, shape->u.revolve, &ray, line))
        return false;
    int base = scratch->count;
    bool is_inside = push_pieces(shape->u.revolve, &l, line->is_first_only, scratch);
    is_inside ^= push_lids(shape->u.revolve, &l, scratch);
    crossings_sort(scratch->items + base, scratch->count - base);
    bool is_entry = !is_inside;
    for (int i = base; i < scratch->count; i++, is_entry = !is_entry) {
        finish(shape, &l, &ray, line, is_entry, &scratch->items[i]);
        if (line_ends_with(line, &scratch->items[i]))
            scratch->count = i + 1;
    }
    return is_inside;
}

/* --- points -------------------------------------------------------------------------------- */

/* Pull p onto a piece of which the squares of the radii are known. */
static V3 onto_square(const RevolvePiece *piece, V3 p, double *u)
{
    double height = piece->y[1] - piece->y[0];
    for (int i = 0; i < 3; i++) {
        double slope;
        *u = num_max(0, num_min(1, (p.y - piece->y[0]) / height));
        double over = p.x * p.x + p.z * p.z - bernstein_at(piece->r, 3, *u, &slope);
        V3 gradient = v3(2 * p.x, -slope / height, 2 * p.z);
        double steep = v3_len2(gradient);
        if (!(steep > 0))
            break;
        p = v3_mad(p, -over / steep, gradient);
    }
    return p;
}

static V3 onto_curve(const RevolveData *data, const RevolvePiece *piece, double u, V3 p)
{
    double r = fabs(bernstein_value(piece->r, data->degree, u));
    double rho = sqrt(p.x * p.x + p.z * p.z), pull = rho > 0 ? r / rho : 0;
    double y = bernstein_value(piece->y, data->degree, u);
    return rho > 0 ? v3(p.x * pull, y, p.z * pull) : v3(r, y, 0);
}

void revolve_point(const Shape *shape, const Crossing *crossing, V3 p, LocalPoint *out)
{
    const RevolveData *data = shape->u.revolve;
    out->error = 4 * PLACE_EPS * revolve_size(shape);
    if (crossing->part >= data->piece_count) {
        out->p = v3(p.x, data->lids[crossing->part - data->piece_count].y, p.z);
        out->ng = v3(0, crossing->v, 0);
        return;
    }
    const RevolvePiece *piece = &data->pieces[crossing->part];
    double u = crossing->u;
    out->p = data->is_square ? onto_square(piece, p, &u) : onto_curve(data, piece, u, p);
    V3 n = piece_normal(data, piece, u, out->p);
    out->ng = v3_len2(n) > 0 ? v3_scale(n, crossing->v) : v3(0, 1, 0);
}

double revolve_turn(V3 p)
{
    double turn = atan2(p.z, p.x) / (2 * PMS_PI);
    return turn < 0 ? turn + 1 : turn;
}

/* --- the rest ------------------------------------------------------------------------------ */

bool revolve_is_inside(const Shape *shape, V3 p)
{
    const RevolveData *data = shape->u.revolve;
    double square = p.x * p.x + p.z * p.z, ignored;
    uint32_t stack[BOX_TREE_DEPTH_MAX], count = 1;
    bool is_inside = false;
    int last = data->is_square ? 1 : data->degree;
    stack[0] = 0;
    while (count) {
        const BoxNode *node = &data->tree.nodes[stack[--count]];
        double r = node->box.hi.x * (1 + MARGIN);
        if (p.y < node->box.lo.y || p.y > node->box.hi.y || square > r * r)
            continue;
        for (uint32_t i = 0; i < node->count; i++) {
            const RevolvePiece *piece = &data->pieces[data->tree.items[node->first + i]];
            if ((piece->y[0] - p.y < 0) == (piece->y[last] - p.y < 0))
                continue;
            double u = u_at(data, piece, p.y);
            double at = bernstein_at(piece->r, data->degree, u, &ignored);
            is_inside ^= (data->is_square ? at : at * at) > square;
        }
        if (!node->count) {
            stack[count++] = node->first + 1;
            stack[count++] = node->first;
        }
    }
    return is_inside;
}

Bound circles_bound(const Shape *shape, double r_lo, double y_lo, double r_hi, double y_hi)
{
    const double(*m)[4] = shape->xform.to;
    V3 reach = v3(hypot(m[0][0], m[0][2]), hypot(m[1][0], m[1][2]), hypot(m[2][0], m[2][2]));
    Bound b = BOUND_EMPTY;
    for (int end = 0; end < 2; end++) {
        V3 c = xform_point(&shape->xform, v3(0, end ? y_hi : y_lo, 0));
        double r = end ? r_hi : r_lo;
        b = bound_add(bound_add(b, v3_mad(c, r, reach)), v3_mad(c, -r, reach));
    }
    return bound_pad(b);
}

V3 circles_farthest(double r_lo, double y_lo, double r_hi, double y_hi, V3 n)
{
    V3 lo = circle_farthest(r_lo, y_lo, v3(n.z, n.x, n.y));
    V3 hi = circle_farthest(r_hi, y_hi, v3(n.z, n.x, n.y));
    V3 bottom = v3(lo.y, lo.z, lo.x), top = v3(hi.y, hi.z, hi.x);
    return v3_dot(bottom, n) > v3_dot(top, n) ? bottom : top;
}

Bound revolve_bound(const Shape *shape)
{
    const RevolveData *d = shape->u.revolve;
    double r = d->r_max * (1 + 4 * EPS_DOUBLE);
    return circles_bound(shape, r, d->y_lo, r, d->y_hi);
}

V3 revolve_farthest(const Shape *shape, V3 n)
{
    const RevolveData *d = shape->u.revolve;
    return circles_farthest(d->r_max, d->y_lo, d->r_max, d->y_hi, n);
}

double revolve_size(const Shape *shape)
{
    const RevolveData *d = shape->u.revolve;
    return num_max(d->r_max, num_max(fabs(d->y_lo), fabs(d->y_hi)));
}
