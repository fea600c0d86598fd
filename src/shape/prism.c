/* Prisms: curves in the xz plane swept along y, straight or towards the origin.  Parts: the spans
 * of the curves, then the lower and the upper cap.  A crossing's u is the place on the span, v the
 * side of the span's normal that is outside.
 *
 * A line and its copies along the sweep make a plane, which cuts the plane of the curves along a
 * line: a x + b z + c = 0.  Where a span meets that line the prism's wall is crossed.  Spans know
 * on which side of it their ends are; they share these with their neighbours, so that every line
 * crosses a loop an even number of times, and enters and leaves in turn.
 * SPDX-License-Identifier: Apache-2.0 */
#include "math/bernstein.h"
#include "shape/box_tree.h"
#include "shape/shape_int.h"

#include <string.h>

struct PrismData {
    PrismForm form;
    BoxTree tree; /* over the spans, in the xz plane */
    Bound box;    /* of the curves */
    double reach; /* largest coordinate of the curves */
};

/* Return the box around a conic or straight sweep of the curves' box. */
static Bound swept_box(const PrismData *prism)
{
    const PrismForm *form = &prism->form;
    Bound box = prism->box, all = BOUND_EMPTY;
    for (int end = 0; end < 2; end++) {
        double y = end ? form->hi : form->lo, size = form->is_conic ? y : 1;
        all = bound_add(all, v3(box.lo.x * size, y, box.lo.z * size));
        all = bound_add(all, v3(box.hi.x * size, y, box.hi.z * size));
    }
    return all;
}

Shape *shape_prism(Arena *arena, const PrismForm *form)
{
    Shape *shape = leaf_new(arena, SHAPE_PRISM);
    PrismData *prism = ARENA_NEW(arena, PrismData);
    Bound *boxes = ARENA_ARRAY(arena, Bound, form->span_count);
    if (!shape || !prism || !boxes)
        return NULL;
    prism->form = *form;
    prism->box = BOUND_EMPTY;
    for (uint32_t i = 0; i < form->span_count; i++) {
        Bound b = BOUND_EMPTY;
        bernstein_range(form->spans[i].a, form->degree, &b.lo.x, &b.hi.x);
        bernstein_range(form->spans[i].b, form->degree, &b.lo.z, &b.hi.z);
        b.lo.y = b.hi.y = 0;
        boxes[i] = b;
        prism->box = bound_union(prism->box, b);
    }
    prism->reach = num_max(v3_max_abs(prism->box.lo), v3_max_abs(prism->box.hi));
    if (!box_tree_new(arena, boxes, form->span_count, &prism->tree))
        return NULL;
    shape->u.prism = prism;
    shape->is_open = form->is_open;
    leaf_place(shape, &XFORM_IDENTITY);
    return shape;
}

/* --- where a line of the curves' plane meets the curves --------------------------------------- */

/* A walk over the spans near a line a x + b z + c = 0. */
typedef struct SpanWalk {
    const PrismData *prism;
    double a, b, c, slack;
    uint32_t stack[BOX_TREE_DEPTH_MAX], stack_count;
    uint32_t item, item_end; /* left of a leaf */
} SpanWalk;

static void walk_begin(SpanWalk *w, const PrismData *prism, double a, double b, double c)
{
    w->prism = prism;
    w->a = a;
    w->b = b;
    w->c = c;
    /* More than the rounding of the values at the knots. */
    w->slack = 32 * EPS_DOUBLE * ((fabs(a) + fabs(b)) * prism->reach + fabs(c));
    w->stack[0] = 0;
    w->stack_count = 1;
    w->item = w->item_end = 0;
}

static bool is_near(const SpanWalk *w, const Bound *box)
{
    double x = 0.5 * (box->lo.x + box->hi.x), z = 0.5 * (box->lo.z + box->hi.z);
    double extent = fabs(w->a) * (box->hi.x - x) + fabs(w->b) * (box->hi.z - z);
    return fabs(w->a * x + w->b * z + w->c) <= extent + w->slack;
}

/* Return the next span, or NULL. */
static const CurveSpan *walk_next(SpanWalk *w, uint32_t *number)
{
    const BoxTree *tree = &w->prism->tree;
    while (w->item == w->item_end) {
        if (w->stack_count == 0)
            return NULL;
        const BoxNode *node = &tree->nodes[w->stack[--w->stack_count]];
        if (!is_near(w, &node->box))
            continue;
        if (node->count) {
            w->item = node->first;
            w->item_end = node->first + node->count;
        } else {
            w->stack[w->stack_count++] = node->first + 1;
            w->stack[w->stack_count++] = node->first;
        }
    }
    *number = tree->items[w->item++];
    return &w->prism->form.spans[*number];
}

/* Find where a span crosses the line; *is_rising: the first time towards positive sides. */
static int span_roots(const SpanWalk *w, const CurveSpan *span, double *out, bool *is_rising)
{
    double side[SPLINE_POINTS_MAX];
    int degree = w->prism->form.degree;
    for (int i = 0; i <= degree; i++)
        side[i] = w->a * span->a[i] + w->b * span->b[i] + w->c;
    *is_rising = side[0] < 0;
    return bernstein_roots(side, degree, out);
}

/* Does a span cross the line an odd number of times? */
static bool span_crosses(const SpanWalk *w, const CurveSpan *span)
{
    int n = w->prism->form.degree;
    double first = w->a * span->a[0] + w->b * span->b[0] + w->c;
    double last = w->a * span->a[n] + w->b * span->b[n] + w->c;
    return (first < 0) != (last < 0);
}

/* Return whether a point of the curves' plane is inside. */
static bool is_in_curves(const PrismData *prism, double x, double z)
{
    SpanWalk walk;
    const CurveSpan *span;
    uint32_t number;
    bool is_inside = false, is_rising;
    int degree = prism->form.degree;
    walk_begin(&walk, prism, 0, 1, -z);
    while ((span = walk_next(&walk, &number))) {
        double roots[SPLINE_POINTS_MAX];
        int count = span_roots(&walk, span, roots, &is_rising);
        for (int i = 0; i < count; i++)
            is_inside ^= bernstein_value(span->a, degree, roots[i]) > x;
    }
    return is_inside;
}

/* --- lines -------------------------------------------------------------------------------- */

/* A line in units of length about a point f of it near the prism. */
typedef struct PrismLine {
    const PrismData *prism;
    const LocalRay *ray;
    V3 f, e;            /* e unit */
    double base, speed; /* t = base + s / speed */
    double in, out;     /* s between the planes of the caps */
    double near, far;   /* s where crossings are wanted */
    double pole;        /* s where the line's place in the curves' plane is at infinity */
} PrismLine;

/* A place on a wall. */
typedef struct WallPlace {
    double x, z; /* of the curve */
    V3 n;        /* normal, on either side, not unit */
} WallPlace;

static WallPlace wall_at(const PrismData *prism, uint32_t number, double u)
{
    const CurveSpan *span = &prism->form.spans[number];
    int degree = prism->form.degree;
    double dx, dz;
    WallPlace at;
    at.x = bernstein_at(span->a, degree, u, &dx);
    at.z = bernstein_at(span->b, degree, u, &dz);
    if (dx == 0 && dz == 0) { /* a cusp: as it is beside it */
        double beside = u < 0.5 ? u + 0x1p-20 : u - 0x1p-20;
        bernstein_at(span->a, degree, beside, &dx);
        bernstein_at(span->b, degree, beside, &dz);
    }
    at.n = v3(dz, prism->form.is_conic ? at.z * dx - at.x * dz : 0, -dx);
    return at;
}

/* A line through the tip of a cone is in one place of the curves' plane. */
static bool is_through_tip(const PrismLine *l)
{
    return v3_len2(v3_cross(l->f, l->e)) == 0;
}

/* Return s of the place of the curves' plane that is on the line. */
static double s_of(const PrismLine *l, double x, double z)
{
    if (!l->prism->form.is_conic) {
        double across = l->e.x * l->e.x + l->e.z * l->e.z;
        double along = (x - l->f.x) * l->e.x + (z - l->f.z) * l->e.z;
        if (across == 0)
            return x < l->f.x ? -INFINITY : INFINITY;
        return along / across;
    }
    V3 q = v3(x, 1, z), cross = v3_cross(l->e, q);
    double size = v3_len2(cross);
    if (size == 0 || is_through_tip(l))
        return x * l->e.y < l->e.x ? -INFINITY : INFINITY;
    return -v3_dot(v3_cross(l->f, q), cross) / size;
}

/* Cut to the slab between the caps; false when nothing is left. */
static bool cut_caps(PrismLine *l)
{
    const PrismForm *form = &l->prism->form;
    if (l->e.y == 0) {
        l->in = l->pole = -INFINITY;
        l->out = INFINITY;
        return l->f.y >= form->lo && l->f.y < form->hi;
    }
    double lo = (form->lo - l->f.y) / l->e.y, hi = (form->hi - l->f.y) / l->e.y;
    l->in = num_min(lo, hi);
    l->out = num_max(lo, hi);
    l->pole = form->is_conic && !is_through_tip(l) ? -l->f.y / l->e.y : -INFINITY;
    return l->in <= l->out; /* equal: a prism without height is a sheet */
}

static void line_begin(PrismLine *l, const PrismData *prism, const LocalRay *ray)
{
    double speed2 = v3_len2(ray->d);
    V3 middle = prism->form.is_conic ? v3(0, 0, 0) : bound_center(swept_box(prism));
    l->prism = prism;
    l->ray = ray;
    l->base = v3_dot(v3_sub(middle, ray->o), ray->d) / speed2;
    l->speed = sqrt(speed2);
    l->f = v3_mad(ray->o, l->base, ray->d);
    l->e = v3_scale(ray->d, 1 / l->speed);
}

/* Where a span of a straight sweep is along the line: -1 before what is wanted, 1 beyond it, 0
 * maybe in it. */
static int place_along(const PrismLine *l, const CurveSpan *span)
{
    double lo = INFINITY, hi = -INFINITY, across = l->e.x * l->e.x + l->e.z * l->e.z;
    if (l->prism->form.is_conic || across == 0)
        return 0;
    for (int i = 0; i <= l->prism->form.degree; i++) {
        double along = (span->a[i] - l->f.x) * l->e.x + (span->b[i] - l->f.z) * l->e.z;
        lo = num_min(lo, along);
        hi = num_max(hi, along);
    }
    double room = 0x1p-40 * l->prism->reach;
    return hi + room < num_max(l->in, l->near) * across   ? -1
           : lo - room > num_min(l->out, l->far) * across ? 1
                                                          : 0;
}

/* Push the places where the line meets the walls: t is s, v tells which way the curve goes. Returns
 * whether an odd number before what is wanted were left out. */
static bool push_walls(const PrismLine *l, ShapeScratch *scratch)
{
    const PrismForm *form = &l->prism->form;
    SpanWalk walk;
    const CurveSpan *span;
    Crossing c = {.change = 0};
    bool is_odd = false;
    if (form->is_conic) {
        V3 n = v3_cross(l->e, l->f);
        if (v3_len2(n) == 0)
            n = v3(0, -l->e.z, l->e.y); /* any plane through the tip */
        walk_begin(&walk, l->prism, n.x, n.z, n.y);
    } else {
        V3 e = l->e.x == 0 && l->e.z == 0 ? v3(1, 0, 0) : l->e;
        walk_begin(&walk, l->prism, -e.z, e.x, e.z * l->f.x - e.x * l->f.z);
    }
    while ((span = walk_next(&walk, &c.part))) {
        double roots[SPLINE_POINTS_MAX];
        bool is_rising;
        int place = place_along(l, span);
        if (place < 0)
            is_odd ^= span_crosses(&walk, span);
        if (place)
            continue;
        int count = span_roots(&walk, span, roots, &is_rising);
        for (int i = 0; i < count; i++, is_rising = !is_rising) {
            c.u = roots[i];
            c.v = is_rising ? 1 : -1;
            c.t = s_of(l, bernstein_value(span->a, form->degree, c.u),
                       bernstein_value(span->b, form->degree, c.u));
            scratch_push(scratch, &c);
        }
    }
    return is_odd;
}

/* Finish a crossing of a wall that push_walls has made. */
static Crossing wall_crossing(const Shape *shape, const PrismLine *l, const Line *line,
                              const Crossing *found, bool is_entry)
{
    const PrismForm *form = &l->prism->form;
    double t = l->base + found->t / l->speed, y = l->f.y + found->t * l->e.y;
    /* Along a rising curve the normal points the way the line goes; beyond the tip all is turned
     * round. */
    bool is_along = (found->v > 0) != (form->is_conic && y < 0);
    double error = 4 * EPS_DOUBLE * (fabs(l->base) + fabs(t));
    if (line_wants(line, t)) {
        WallPlace at = wall_at(l->prism, found->part, found->u);
        double height = num_max(fabs(form->lo), fabs(form->hi));
        double size = l->prism->reach * (form->is_conic ? height : 1);
        double off = v3_sum_abs(local_error(l->ray, t)) + PLACE_EPS * size;
        error += off * v3_len(at.n) / fabs(v3_dot(at.n, l->ray->d));
    }
    int8_t change = is_entry ? 1 : -1;
    return (Crossing){.t = t,
                      .t_error = error,
                      .leaf = shape,
                      .part = found->part,
                      .change = change,
                      .leaf_change = change,
                      .is_visible = true,
                      .u = found->u,
                      .v = is_entry == is_along ? -1 : 1};
}

static Crossing cap_crossing(const Shape *shape, const PrismLine *l, bool is_entry)
{
    const PrismForm *form = &l->prism->form;
    bool is_top = is_entry == (l->e.y < 0);
    double s = is_entry ? l->in : l->out, t = l->base + s / l->speed;
    double off = local_error(l->ray, t).y + PLACE_EPS * num_max(fabs(form->lo), fabs(form->hi));
    int8_t change = is_entry ? 1 : -1;
    return (Crossing){.t = t,
                      .t_error =
                          off / fabs(l->ray->d.y) + 4 * EPS_DOUBLE * (fabs(l->base) + fabs(t)),
                      .leaf = shape,
                      .part = form->span_count + is_top,
                      .change = change,
                      .leaf_change = change,
                      .is_visible = !shape->is_open};
}

/* Is the line inside the loops where it meets the first cap?  It is outside at the pole. */
static bool starts_inside(const PrismLine *l, const Crossing *walls, int count)
{
    double lo = num_min(l->pole, l->in), hi = num_max(l->pole, l->in);
    bool is_inside = false;
    for (int i = 0; i < count; i++)
        is_inside ^= walls[i].t >= lo && walls[i].t < hi;
    return is_inside;
}

static bool prism_list(const Shape *shape, const Line *line, ShapeScratch *scratch)
{
    LocalRay ray;
    PrismLine l;
    local_ray(shape, line->ray, &ray);
    line_begin(&l, shape->u.prism, &ray);
    if (!cut_caps(&l))
        return false;
    int base = scratch->count;
    l.near = (line->near - l.base) * l.speed;
    l.far = (line->far - l.base) * l.speed;
    /* Else spans could be both before and beyond what is wanted, and be counted wrong. */
    if (num_max(l.in, l.near) > num_min(l.out, l.far))
        return false;
    bool is_inside = push_walls(&l, scratch);
    int count = scratch->count - base;
    crossings_sort(scratch->items + base, count);
    is_inside ^= starts_inside(&l, scratch->items + base, count);
    Crossing cap = {.t = 0};
    bool has_cap = is_inside;
    int written = base;
    if (has_cap)
        cap = cap_crossing(shape, &l, true);
    if (has_cap) /* room for the cap in front */
        scratch_push(scratch, &cap);
    if (has_cap && scratch->is_overflown)
        has_cap = false;
    if (has_cap) {
        memmove(scratch->items + base + 1, scratch->items + base, (size_t)count * sizeof cap);
        scratch->items[written++] = cap;
    }
    bool is_done = has_cap && line_ends_with(line, &cap);
    for (int i = base + has_cap; i < base + has_cap + count && !is_done; i++) {
        const Crossing *found = &scratch->items[i];
        if (found->t < l.in || found->t >= l.out)
            continue;
        is_inside = !is_inside;
        Crossing wall = wall_crossing(shape, &l, line, found, is_inside);
        scratch->items[written++] = wall;
        is_done = line_ends_with(line, &wall);
    }
    scratch->count = written;
    if (is_inside && !is_done) {
        cap = cap_crossing(shape, &l, false);
        scratch_push(scratch, &cap);
    }
    return false;
}

/* --- the rest ------------------------------------------------------------------------------ */

static void prism_point(const Shape *shape, const Crossing *crossing, V3 p, LocalPoint *out)
{
    const PrismData *prism = shape->u.prism;
    const PrismForm *form = &prism->form;
    double height = num_max(fabs(form->lo), fabs(form->hi));
    if (crossing->part >= form->span_count) {
        bool is_top = crossing->part > form->span_count;
        out->p = v3(p.x, is_top ? form->hi : form->lo, p.z);
        out->ng = v3(0, is_top ? 1 : -1, 0);
        out->error = 2 * PLACE_EPS * height;
        return;
    }
    WallPlace at = wall_at(prism, crossing->part, crossing->u);
    double size = form->is_conic ? p.y : 1;
    out->p = v3(at.x * size, p.y, at.z * size);
    out->ng = v3_scale(v3_unit(at.n), crossing->v);
    out->error = 2 * PLACE_EPS * prism->reach * (form->is_conic ? num_max(1, height) : 1);
}

static bool prism_is_inside(const Shape *shape, V3 p)
{
    const PrismForm *form = &shape->u.prism->form;
    double size = form->is_conic ? p.y : 1;
    if (!(p.y >= form->lo && p.y < form->hi) || size == 0)
        return false;
    return is_in_curves(shape->u.prism, p.x / size, p.z / size);
}

static Bound prism_bound(const Shape *shape)
{
    return bound_pad(bound_transform(bound_pad(swept_box(shape->u.prism)), &shape->xform));
}

static V3 prism_farthest(const Shape *shape, V3 n)
{
    return bound_farthest(swept_box(shape->u.prism), n);
}

static double prism_size(const Shape *shape)
{
    Bound box = swept_box(shape->u.prism);
    return num_max(v3_max_abs(box.lo), v3_max_abs(box.hi));
}

const ShapeOps prism_ops = {.list = prism_list,
                            .point = prism_point,
                            .is_inside = prism_is_inside,
                            .bound = prism_bound,
                            .farthest = prism_farthest,
                            .size = prism_size};
