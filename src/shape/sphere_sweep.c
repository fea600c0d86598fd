/* Sphere sweeps: all balls C(u), r(u) along a spline.  Parts: the spans; a crossing's u is the
 * place on its span of the ball that it is on.
 *
 * A line is inside the ball at u from s - sqrt(D) to s + sqrt(D), where s(u) is how far along the
 * line its centre is, and D(u) = r^2 - (distance of the centre from the line)^2.  Over a stretch of
 * the span on which D is not negative these pieces of the line change without a jump: together they
 * are one, from the least s - sqrt(D) to the largest s + sqrt(D).  Spans share the balls at
 * their joints, so that there the pieces of both overlap and become one.
 * SPDX-License-Identifier: Apache-2.0 */
#include "math/bernstein.h"
#include "math/bracket.h"
#include "shape/box_tree.h"
#include "shape/shape_int.h"

struct SweepData {
    int degree;
    uint32_t span_count;
    const SweepSpan *spans;
    BoxTree tree;
    Bound box;
    double size; /* largest coordinate or radius */
};

/* Return the box around a span, with room for rounding. */
static Bound span_box(int degree, const SweepSpan *span)
{
    double lo[3], hi[3];
    for (int axis = 0; axis < 3; axis++) {
        double less[4], more[4];
        for (int i = 0; i <= degree; i++) {
            less[i] = span->c[axis][i] - span->r[i];
            more[i] = span->c[axis][i] + span->r[i];
        }
        lo[axis] = INFINITY;
        hi[axis] = -INFINITY;
        bernstein_range(less, degree, &lo[axis], &hi[axis]);
        bernstein_range(more, degree, &lo[axis], &hi[axis]);
        double pad = 0x1p-46 * num_max(fabs(lo[axis]), fabs(hi[axis]));
        lo[axis] -= pad;
        hi[axis] += pad;
    }
    return (Bound){v3(lo[0], lo[1], lo[2]), v3(hi[0], hi[1], hi[2])};
}

Shape *shape_sphere_sweep(Arena *arena, int degree, const SweepSpan *spans, uint32_t count)
{
    Shape *shape = leaf_new(arena, SHAPE_SPHERE_SWEEP);
    SweepData *data = ARENA_NEW(arena, SweepData);
    Bound *boxes = ARENA_ARRAY(arena, Bound, count);
    if (!shape || !data || !boxes)
        return NULL;
    *data = (SweepData){.degree = degree, .span_count = count, .spans = spans, .box = BOUND_EMPTY};
    for (uint32_t i = 0; i < count; i++) {
        boxes[i] = span_box(degree, &spans[i]);
        data->box = bound_union(data->box, boxes[i]);
    }
    data->size = num_max(v3_max_abs(data->box.lo), v3_max_abs(data->box.hi));
    if (!box_tree_new(arena, boxes, count, &data->tree))
        return NULL;
    shape->u.sweep = data;
    leaf_place(shape, &XFORM_IDENTITY);
    return shape;
}

/* --- a line and a span --------------------------------------------------------------------- */

/* A line in units of length about a point f of it near the shape. */
typedef struct SweepLine {
    V3 f, e, p, q;      /* orthonormal: e along the line */
    V3 inverse;         /* of e */
    double base, speed; /* t = base + s / speed */
    double tmin;        /* t where crossings are wanted from */
    double near, far;   /* s where crossings are wanted */
    bool is_first_only; /* of these */
} SweepLine;

/* Is what happens at s seen, once t is rounded? */
static bool is_after_start(const SweepLine *l, double s)
{
    return l->base + s / l->speed > l->tmin;
}

/* A span as a line sees it. */
typedef struct SpanView {
    int degree;
    double s[4];                        /* how far along the line the centres are */
    double d[BERNSTEIN_DEGREE_MAX + 1]; /* D: of twice the degree */
    double discriminant;                /* of D, if the span is straight */
    BernsteinCenter s_center, d_center; /* the same s and D, if it is not */
} SpanView;

static void view_span(const SweepData *data, const SweepSpan *span, const SweepLine *l, SpanView *v)
{
    int n = data->degree;
    double p[4], q[4];
    *v = (SpanView){.degree = n};
    for (int i = 0; i <= n; i++) {
        V3 c = v3_sub(v3(span->c[0][i], span->c[1][i], span->c[2][i]), l->f);
        v->s[i] = v3_dot(c, l->e);
        p[i] = v3_dot(c, l->p);
        q[i] = v3_dot(c, l->q);
    }
    bernstein_add_product(span->r, span->r, n, 1, v->d);
    bernstein_add_product(p, p, n, -1, v->d);
    bernstein_add_product(q, q, n, -1, v->d);
    if (n == 1) {
        double rp = span->r[0] * p[1] - span->r[1] * p[0];
        double rq = span->r[0] * q[1] - span->r[1] * q[0], pq = p[0] * q[1] - p[1] * q[0];
        v->discriminant = rp * rp + rq * rq - pq * pq;
    }
}

/* An end of a piece of the line: where, and of which ball. */
typedef struct SweepEnd {
    double s, u;
} SweepEnd;

/* Return s and sqrt(D) at u; at the knots with all digits, as the spans beside have them. */
static void ball_at(const SpanView *v, double u, double *s, double *half)
{
    double d, slope;
    int n = v->degree;
    if (u == 0 || u == 1) {
        *s = v->s[u == 0 ? 0 : n];
        d = v->d[u == 0 ? 0 : 2 * n];
    } else if (n == 1) {
        *s = bernstein_value(v->s, 1, u);
        d = bernstein_value(v->d, 2, u);
    } else {
        *s = bernstein_center_at(&v->s_center, u, &slope);
        d = bernstein_center_at(&v->d_center, u, &slope);
    }
    *half = sqrt(num_max(d, 0));
}

/* Return the end of the ball at u: way -1 the first, 1 the last. */
static SweepEnd ball_end(const SpanView *v, double way, double u)
{
    double s, half;
    ball_at(v, u, &s, &half);
    return (SweepEnd){s + way * half, u};
}

/* Take an end if it is further out. */
static void take_end(SweepEnd *best, double way, SweepEnd end)
{
    if (way * (end.s - best->s) > 0)
        *best = end;
}

/* The end of a stretch [from, to] of a straight span: at one of its own ends, or where s + way
 * sqrt(D) turns, which its derivative gives. */
static SweepEnd straight_end(const SpanView *v, double way, double from, double to)
{
    SweepEnd best = ball_end(v, way, from);
    take_end(&best, way, ball_end(v, way, to));
    /* D = a u^2 + 2 b u + c turns there as k u = -b - way g s', k the cone's steepness. */
    double c = v->d[0], b = v->d[1] - c, a = v->d[2] - v->d[1] - b, along = v->s[1] - v->s[0];
    double steep = along * along - a;
    if (!(v->discriminant > 0) || !(steep > 0))
        return best;
    double g = -way * along * sqrt(v->discriminant / steep);
    double u = g * b > 0 ? (b * b - along * along * c) / (steep * (g + b)) : (g - b) / a;
    if (u > from && u < to)
        take_end(&best, way, ball_end(v, way, u));
    return best;
}

/* One of the two surfaces of a span. */
typedef struct SpanSide {
    const SpanView *v;
    double way;
} SpanSide;

/* Return a number whose sign is that of the derivative of way s + sqrt(D). */
static double end_slope(const void *ctx, double u)
{
    const SpanSide *side = ctx;
    double slope, along, d = bernstein_center_at(&side->v->d_center, u, &slope);
    bernstein_center_at(&side->v->s_center, u, &along);
    return slope + 2 * side->way * along * sqrt(num_max(d, 0));
}

/* Find where the derivative turns from positive to negative between lo and hi. */
static double find_turn(const SpanView *v, double way, double lo, double hi)
{
    SpanSide side = {v, way};
    double g_lo = end_slope(&side, lo), g_hi = end_slope(&side, hi);
    if (!(g_lo > 0))
        return lo;
    return g_hi < 0 ? bracket_zero(end_slope, &side, lo, g_lo, hi, g_hi, 0) : hi;
}

enum { SAMPLES = 6, MANY_SAMPLES = 96 };

/* Balls spread over a stretch. */
typedef struct Samples {
    int count; /* less one */
    double from, to, s[MANY_SAMPLES + 1], half[MANY_SAMPLES + 1];
} Samples;

static double sample_place(const Samples *all, int i)
{
    return i == all->count ? all->to : all->from + (all->to - all->from) * i / all->count;
}

static void take_samples(const SpanView *v, double from, double to, int count, Samples *out)
{
    out->count = count;
    out->from = from;
    out->to = to;
    for (int i = 0; i <= count; i++)
        ball_at(v, sample_place(out, i), &out->s[i], &out->half[i]);
}

/* The end of a stretch, looked for around the best of some samples. */
static SweepEnd sampled_end(const SpanView *v, double way, const Samples *all)
{
    int at = 0;
    double most = -INFINITY;
    for (int i = 0; i <= all->count; i++) {
        double reach = way * all->s[i] + all->half[i];
        if (reach > most) {
            most = reach;
            at = i;
        }
    }
    SweepEnd best = {way * most, sample_place(all, at)};
    double lo = sample_place(all, at > 0 ? at - 1 : 0);
    double hi = sample_place(all, at < all->count ? at + 1 : all->count);
    take_end(&best, way, ball_end(v, way, find_turn(v, way, lo, hi)));
    return best;
}

/* Does a polynomial go below -slack somewhere on [0, 1]? */
static bool goes_below(const double *b, int degree, double slack, int depth)
{
    double low = INFINITY, half[2][BERNSTEIN_DEGREE_MAX + 1];
    for (int i = 0; i <= degree; i++)
        low = num_min(low, b[i]);
    if (low >= -slack || depth == 0)
        return false;
    if (b[0] < -slack || b[degree] < -slack)
        return true;
    bernstein_part(b, degree, 0, 0.5, half[0]);
    bernstein_part(b, degree, 0.5, 1, half[1]);
    return goes_below(half[0], degree, slack, depth - 1) ||
           goes_below(half[1], degree, slack, depth - 1);
}

/* Prove that no ball reaches beyond an end: (s - s(u))^2 - D(u) is the power of that point with
 * respect to the ball at u, and nowhere negative.  Outside the stretch, where D is negative, it
 * cannot be. */
static bool is_proved(const SpanView *v, SweepEnd end, double from, double to)
{
    int n = v->degree;
    double off[4], power[BERNSTEIN_DEGREE_MAX + 1], part[BERNSTEIN_DEGREE_MAX + 1], size = 0;
    for (int i = 0; i <= n; i++) {
        off[i] = v->s[i] - end.s;
        size = num_max(size, off[i] * off[i]);
    }
    for (int i = 0; i <= 2 * n; i++) {
        power[i] = -v->d[i];
        size = num_max(size, fabs(v->d[i]));
    }
    bernstein_add_product(off, off, n, 1, power);
    double slack = 0x1p-40 * size;
    if (!isfinite(slack)) /* numbers too large to be asked */
        return true;
    for (int side = 0; side < 2; side++) {
        if (side ? end.u >= to : end.u <= from)
            continue;
        bernstein_part(power, 2 * n, side ? end.u : 0, side ? 1 : end.u, part);
        if (goes_below(part, 2 * n, slack, 24))
            return false;
    }
    return true;
}

/* Find an end of the stretch that the samples are spread over. */
static SweepEnd curved_end(const SpanView *v, double way, const Samples *few)
{
    SweepEnd end = sampled_end(v, way, few);
    if (is_proved(v, end, few->from, few->to))
        return end;
    Samples many;
    take_samples(v, few->from, few->to, MANY_SAMPLES, &many);
    return sampled_end(v, way, &many);
}

static V3 center_at(const SweepData *data, const SweepSpan *span, double u)
{
    return v3(bernstein_value(span->c[0], data->degree, u),
              bernstein_value(span->c[1], data->degree, u),
              bernstein_value(span->c[2], data->degree, u));
}

/* Return where the line enters or leaves the ball at u, with all digits. */
static double exact_end(const SweepData *data, const SweepSpan *span, const SweepLine *l,
                        double way, double u)
{
    V3 c = v3_sub(center_at(data, span, u), l->f);
    double p = v3_dot(c, l->p), q = v3_dot(c, l->q), off = sqrt(p * p + q * q);
    double r = bernstein_value(span->r, data->degree, u);
    return v3_dot(c, l->e) + way * sqrt(num_max(0, (r - off) * (r + off)));
}

/* Push the piece of the line inside the balls of a stretch; t is s, child tells the order at one
 * place: entries first.  If only the first crossing is wanted and that is where the piece begins,
 * its end is not looked for. */
static void push_stretch(const SweepData *data, uint32_t number, const SweepLine *l,
                         const SpanView *v, double from, double to, ShapeScratch *scratch)
{
    const SweepSpan *span = &data->spans[number];
    Samples samples;
    if (v->degree > 1)
        take_samples(v, from, to, SAMPLES, &samples);
    Crossing c = {.part = number};
    for (int end = 0; end < 2; end++) {
        double way = end ? 1 : -1;
        if (end == 0 || !l->is_first_only || !is_after_start(l, c.t)) {
            SweepEnd place =
                v->degree > 1 ? curved_end(v, way, &samples) : straight_end(v, way, from, to);
            c.t = exact_end(data, span, l, way, place.u);
            c.u = place.u;
        }
        c.child = (uint32_t)end;
        c.change = end ? -1 : 1;
        scratch_push(scratch, &c);
    }
}

/* Push the pieces of the line inside the balls of a span. */
static void push_span(const SweepData *data, uint32_t number, const SweepLine *l,
                      ShapeScratch *scratch)
{
    SpanView v;
    const SweepSpan *span = &data->spans[number];
    view_span(data, span, l, &v);
    double at[BERNSTEIN_DEGREE_MAX + 2], roots[BERNSTEIN_DEGREE_MAX];
    int count = v.degree == 1 ? bernstein_quadratic(v.d, v.discriminant, roots)
                              : bernstein_roots(v.d, 2 * v.degree, roots);
    at[0] = 0;
    for (int i = 0; i < count; i++)
        at[i + 1] = roots[i];
    at[count + 1] = 1;
    if (count == 0 && v.d[0] < 0)
        return;
    if (v.degree > 1) {
        bernstein_center(v.s, v.degree, &v.s_center);
        bernstein_center(v.d, 2 * v.degree, &v.d_center);
    }
    for (int i = v.d[0] < 0; i <= count; i += 2) {
        /* Between balls of positive and negative radius D is negative. */
        if (bernstein_value(span->r, v.degree, 0.5 * (at[i] + at[i + 1])) >= 0)
            push_stretch(data, number, l, &v, at[i], at[i + 1], scratch);
    }
}

/* --- lines --------------------------------------------------------------------------------- */

/* Does the wanted part of the line meet a box?  A line along a side is on it.  Balls that it is not
 * in there do not count. */
static bool meets_box(const SweepLine *l, const Bound *box)
{
    double near = l->near, far = l->far;
    for (int axis = 0; axis < 3; axis++) {
        double o = v3_at(l->f, axis), inverse = v3_at(l->inverse, axis);
        double a = (v3_at(box->lo, axis) - o) * inverse, b = (v3_at(box->hi, axis) - o) * inverse;
        double first = a < b ? a : b, last = a < b ? b : a;
        near = first > near ? first : near;
        far = last < far ? last : far;
    }
    return !(near - 0x1p-44 * fabs(near) > far + 0x1p-44 * fabs(far));
}

/* Note what was pushed from `from` on; false when only the first crossing is looked for, but the
 * line starts inside, so that all pieces are needed. */
static bool note_pieces(SweepLine *l, const ShapeScratch *scratch, int from)
{
    for (int i = from; l->is_first_only && i + 1 < scratch->count; i += 2) {
        double in = scratch->items[i].t;
        bool is_before = !is_after_start(l, in);
        if (is_before && is_after_start(l, scratch->items[i + 1].t))
            return false;
        if (!is_before)
            l->far = num_min(l->far, in);
    }
    return true;
}

/* Push the pieces of the line inside the balls of all spans; false as note_pieces. */
static bool push_spans(const SweepData *data, SweepLine *l, ShapeScratch *scratch)
{
    uint32_t stack[BOX_TREE_DEPTH_MAX], count = 1;
    stack[0] = 0;
    while (count) {
        const BoxNode *node = &data->tree.nodes[stack[--count]];
        if (!meets_box(l, &node->box))
            continue;
        for (uint32_t i = 0; i < node->count; i++) {
            int from = scratch->count;
            push_span(data, data->tree.items[node->first + i], l, scratch);
            if (!note_pieces(l, scratch, from))
                return false;
        }
        if (!node->count) {
            /* First the one that the line comes to first. */
            V3 a = bound_center(data->tree.nodes[node->first].box);
            V3 b = bound_center(data->tree.nodes[node->first + 1].box);
            bool is_swapped = v3_dot(v3_sub(a, b), l->e) > 0;
            stack[count++] = node->first + !is_swapped;
            stack[count++] = node->first + is_swapped;
        }
    }
    return true;
}

static void line_begin(SweepLine *l, const SweepData *data, const LocalRay *ray, const Line *line)
{
    double speed2 = v3_len2(ray->d);
    l->base = v3_dot(v3_sub(bound_center(data->box), ray->o), ray->d) / speed2;
    l->speed = sqrt(speed2);
    l->f = v3_mad(ray->o, l->base, ray->d);
    l->e = v3_scale(ray->d, 1 / l->speed);
    v3_frame(l->e, &l->p, &l->q);
    l->inverse = v3(1 / l->e.x, 1 / l->e.y, 1 / l->e.z);
    l->tmin = line->near;
    l->near = (line->near - l->base) * l->speed;
    l->far = (line->far - l->base) * l->speed;
    l->is_first_only = line->is_first_only;
}

/* Finish a crossing that push_span has made. */
static void finish(const Shape *shape, const SweepLine *l, const LocalRay *ray, const Line *line,
                   Crossing *c)
{
    const SweepData *data = shape->u.sweep;
    double s = c->t, t = l->base + s / l->speed;
    c->t = t;
    c->t_error = 4 * EPS_DOUBLE * (fabs(l->base) + fabs(t));
    if (line_wants(line, t)) {
        V3 c0 = center_at(data, &data->spans[c->part], c->u);
        V3 n = v3_unit(v3_sub(v3_mad(l->f, s, l->e), c0));
        double off = v3_sum_abs(local_error(ray, t)) + PLACE_EPS * data->size;
        c->t_error += off / fabs(v3_dot(n, ray->d));
    }
    c->leaf = shape;
    c->leaf_change = c->change;
    c->is_visible = true;
    c->child = 0;
}

static bool sweep_list(const Shape *shape, const Line *line, ShapeScratch *scratch)
{
    LocalRay ray;
    SweepLine l;
    local_ray(shape, line->ray, &ray);
    line_begin(&l, shape->u.sweep, &ray, line);
    int base = scratch->count, written = base, depth = 0;
    if (!push_spans(shape->u.sweep, &l, scratch)) {
        scratch->count = base;
        line_begin(&l, shape->u.sweep, &ray, line);
        l.is_first_only = false;
        push_spans(shape->u.sweep, &l, scratch);
    }
    crossings_sort(scratch->items + base, scratch->count - base);
    for (int i = base; i < scratch->count; i++) {
        Crossing c = scratch->items[i];
        int before = depth;
        depth += c.change;
        if (before > 0 && depth > 0)
            continue;
        finish(shape, &l, &ray, line, &c);
        scratch->items[written++] = c;
    }
    scratch->count = written;
    return false;
}

/* --- the rest ------------------------------------------------------------------------------ */

static void sweep_point(const Shape *shape, const Crossing *crossing, V3 p, LocalPoint *out)
{
    const SweepData *data = shape->u.sweep;
    V3 c = center_at(data, &data->spans[crossing->part], crossing->u), n = v3_unit(v3_sub(p, c));
    double r = bernstein_value(data->spans[crossing->part].r, data->degree, crossing->u);
    out->ng = v3_len2(n) > 0 ? n : v3(0, 1, 0);
    out->p = v3_mad(c, r, out->ng);
    out->error = 4 * PLACE_EPS * data->size;
}

/* Is p in a ball of the span? */
static bool is_in_span(const SweepData *data, const SweepSpan *span, V3 p)
{
    int n = data->degree;
    double power[BERNSTEIN_DEGREE_MAX + 1] = {0}, off[4], roots[BERNSTEIN_DEGREE_MAX];
    for (int axis = 0; axis < 3; axis++) {
        for (int i = 0; i <= n; i++)
            off[i] = span->c[axis][i] - v3_at(p, axis);
        bernstein_add_product(off, off, n, 1, power);
    }
    bernstein_add_product(span->r, span->r, n, -1, power);
    int count = bernstein_roots(power, 2 * n, roots);
    for (int i = power[0] >= 0; i <= count; i += 2) {
        double from = i > 0 ? roots[i - 1] : 0, to = i < count ? roots[i] : 1;
        if (bernstein_value(span->r, n, 0.5 * (from + to)) > 0)
            return true;
    }
    return false;
}

static bool sweep_is_inside(const Shape *shape, V3 p)
{
    const SweepData *data = shape->u.sweep;
    uint32_t stack[BOX_TREE_DEPTH_MAX], count = 1;
    stack[0] = 0;
    while (count) {
        const BoxNode *node = &data->tree.nodes[stack[--count]];
        const Bound *b = &node->box;
        if (p.x < b->lo.x || p.x > b->hi.x || p.y < b->lo.y || p.y > b->hi.y || p.z < b->lo.z ||
            p.z > b->hi.z)
            continue;
        for (uint32_t i = 0; i < node->count; i++)
            if (is_in_span(data, &data->spans[data->tree.items[node->first + i]], p))
                return true;
        if (!node->count) {
            stack[count++] = node->first + 1;
            stack[count++] = node->first;
        }
    }
    return false;
}

static Bound sweep_bound(const Shape *shape)
{
    return bound_pad(bound_transform(shape->u.sweep->box, &shape->xform));
}

static V3 sweep_farthest(const Shape *shape, V3 n)
{
    return bound_farthest(shape->u.sweep->box, n);
}

static double sweep_size(const Shape *shape)
{
    return shape->u.sweep->size;
}

const ShapeOps sphere_sweep_ops = {.list = sweep_list,
                                   .point = sweep_point,
                                   .is_inside = sweep_is_inside,
                                   .bound = sweep_bound,
                                   .farthest = sweep_farthest,
                                   .size = sweep_size};
