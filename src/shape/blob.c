/* Blobs: where the fields of balls and rounded cylinders add up to a threshold.
 *
 * A component has the field s (1 - q)^2 where q, the squared distance from its middle in units of
 * its radius, is below 1; along a line q is a parabola, kept as its least value, where that is, and
 * its bend, which has all its digits however far away the line starts.  The line is swept from
 * where a field begins to where one ends: between, the sum is one polynomial of degree 4 about the
 * middle of the stretch.  Stretches whose fields cannot reach the threshold are passed by.
 * SPDX-License-Identifier: Apache-2.0 */
#include "math/roots.h"
#include "shape/box_tree.h"
#include "shape/shape_int.h"

#include <string.h>

/* Half again of what fits the rounding of a field's coefficients. */
#define FIELD_EPS (32 * EPS_DOUBLE)

/* Boxes of components, where their fields vanish anyhow, are as much larger. */
#define BOX_SLACK 0x1p-30

struct BlobData {
    double threshold;
    const BlobComponent *components;
    uint32_t count;
    BoxTree tree;
    V3 center;
    bool has_textures;
};

/* --- making -------------------------------------------------------------------------------- */

/* The box around a component placed by a transform. */
static Bound component_box(const Xform *place, double length)
{
    V3 a = xform_point(place, v3(0, 0, 0)), b = xform_point(place, v3(0, 0, length));
    const double(*m)[4] = place->to;
    V3 half = v3(v3_len(v3(m[0][0], m[0][1], m[0][2])), v3_len(v3(m[1][0], m[1][1], m[1][2])),
                 v3_len(v3(m[2][0], m[2][1], m[2][2])));
    half = v3_scale(half, 1 + BOX_SLACK);
    return bound_pad((Bound){v3_sub(v3_min(a, b), half), v3_add(v3_max(a, b), half)});
}

static void measure(BlobComponent *c)
{
    double(*m)[4] = c->place.from;
    double sum = 0, offset = 0;
    for (int i = 0; i < 3; i++) {
        sum += m[i][0] * m[i][0] + m[i][1] * m[i][1] + m[i][2] * m[i][2];
        offset += fabs(m[i][3]);
    }
    c->spread = sqrt(sum);
    c->offset = offset;
}

Shape *shape_blob(Arena *arena, double threshold, const BlobComponent *components, uint32_t count,
                  bool has_textures)
{
    Shape *shape = leaf_new(arena, SHAPE_BLOB);
    BlobData *blob = ARENA_NEW(arena, BlobData);
    BlobComponent *own = arena_copy(arena, components, count * sizeof *own);
    Bound *boxes = ARENA_ARRAY(arena, Bound, count), all = BOUND_EMPTY;
    if (!shape || !blob || !own || !boxes)
        return NULL;
    for (uint32_t i = 0; i < count; i++) {
        measure(&own[i]);
        boxes[i] = component_box(&own[i].place, own[i].length);
        all = bound_union(all, boxes[i]);
    }
    *blob = (BlobData){.threshold = threshold,
                       .components = own,
                       .count = count,
                       .center = bound_center(all),
                       .has_textures = has_textures};
    if (!box_tree_new(arena, boxes, count, &blob->tree))
        return NULL;
    shape->u.blob = blob;
    leaf_place(shape, &XFORM_IDENTITY);
    return shape;
}

/* --- components along a line --------------------------------------------------------------- */

/* One smooth field along the line: q = least + bend (t - middle)^2 for from < t < to. */
typedef struct Stretch {
    double strength, least, bend, middle;
    double from, to;
    double error; /* of the field, from where the line is not certain */
} Stretch;

typedef struct Sweep {
    const BlobData *blob;
    ShapeScratch *scratch;
    Stretch *stretches; /* the scratch's */
    uint32_t count, next, capacity;
    uint32_t active_count;
    uint32_t *active;  /* numbers of the ones that overlap here */
    V3 p, d, p_error;  /* the line about t = 0 */
    double tmin, tmax; /* of what is wanted, in the ray's t */
    double near, far;  /* of what is wanted */
    double base;       /* t of the ray for 0 here */
    bool is_first;     /* only the first crossing is wanted */
    bool is_beyond;    /* the state where there are no fields */
    bool is_inside, is_inside_before;
    bool is_done;
    const Shape *shape;
    Crossing *first;
} Sweep;

/* Make room for twice as many stretches, and for their numbers behind them. */
static bool grow(Sweep *s)
{
    uint32_t wanted = s->capacity ? 2 * s->capacity : 32;
    void *room = scratch_room(s->scratch, wanted * (sizeof(Stretch) + sizeof(uint32_t)));
    if (!room)
        return false;
    s->stretches = room;
    s->capacity = wanted;
    return true;
}

static void add_stretch(Sweep *s, const BlobComponent *c, V3 u, V3 w, double from, double to)
{
    double bend = v3_len2(w), middle = bend > 0 ? -v3_dot(u, w) / bend : 0;
    double least = v3_len2(v3_mad(u, middle, w));
    if (!(least < 1))
        return;
    double half = sqrt((1 - least) / bend);
    from = num_max(num_max(from, middle - half), s->near);
    to = num_min(num_min(to, middle + half), s->far);
    if (!(from < to))
        return;
    if (s->count == s->capacity && !grow(s))
        return;
    double off = c->spread * (v3_sum_abs(s->p_error) + 8 * EPS_DOUBLE * v3_sum_abs(s->p)) +
                 8 * EPS_DOUBLE * c->offset;
    s->stretches[s->count++] = (Stretch){.strength = c->strength,
                                         .least = least,
                                         .bend = bend,
                                         .middle = middle,
                                         .from = from,
                                         .to = to,
                                         .error = 4 * fabs(c->strength) * off};
}

/* A ball, or a tube between two half balls. */
static void add_component(Sweep *s, const BlobComponent *c)
{
    V3 u = xform_point_back(&c->place, s->p), w = xform_dir_back(&c->place, s->d);
    if (c->length == 0) {
        add_stretch(s, c, u, w, -INFINITY, INFINITY);
        return;
    }
    double from_end[2] = {-INFINITY, -INFINITY}, to_end[2] = {INFINITY, INFINITY};
    double from = -INFINITY, to = INFINITY, a = -u.z / w.z, b = (c->length - u.z) / w.z;
    if (w.z > 0) {
        to_end[0] = from = a;
        from_end[1] = to = b;
    } else if (w.z < 0) {
        from_end[0] = to = a;
        to_end[1] = from = b;
    } else {
        bool is_below = u.z<0, is_above = u.z> c->length;
        to_end[0] = is_below ? INFINITY : -INFINITY;
        from_end[1] = is_above ? -INFINITY : INFINITY;
        to = is_below || is_above ? -INFINITY : INFINITY;
    }
    add_stretch(s, c, u, w, from_end[0], to_end[0]);
    add_stretch(s, c, v3(u.x, u.y, u.z - c->length), w, from_end[1], to_end[1]);
    add_stretch(s, c, v3(u.x, u.y, 0), v3(w.x, w.y, 0), from, to);
}

/* Find the components that the line meets. */
static void gather(Sweep *s)
{
    const BoxTree *tree = &s->blob->tree;
    Ray ray = {s->p, s->d, s->near, s->far};
    Line line = {&ray, v3(1 / s->d.x, 1 / s->d.y, 1 / s->d.z), s->near, s->far, false};
    uint32_t stack[BOX_TREE_DEPTH_MAX], depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
        const BoxNode *node = &tree->nodes[stack[--depth]];
        Line part = line;
        if (!line_cut(&part, &node->box))
            continue;
        for (uint32_t i = 0; i < node->count; i++)
            add_component(s, &s->blob->components[tree->items[node->first + i]]);
        if (node->count == 0) {
            stack[depth++] = node->first + 1;
            stack[depth++] = node->first;
        }
    }
}

/* Sort by where they begin: shell sort, which is an insertion sort for few. */
static void sort_stretches(Stretch *items, uint32_t count)
{
    static const uint32_t gaps[] = {10301, 1073, 281, 77, 23, 8, 1};
    for (size_t g = 0; g < sizeof gaps / sizeof gaps[0]; g++)
        for (uint32_t i = gaps[g]; i < count; i++) {
            Stretch item = items[i];
            uint32_t place = i;
            for (; place >= gaps[g] && items[place - gaps[g]].from > item.from; place -= gaps[g])
                items[place] = items[place - gaps[g]];
            items[place] = item;
        }
}

/* --- the sweep ----------------------------------------------------------------------------- */

/* Cross the surface at t. */
static void cross(Sweep *s, double t, double error)
{
    double at = s->base + t;
    LeafHit hit = {at, error + 4 * EPS_DOUBLE * (fabs(s->base) + fabs(t)), 0, s->is_inside ? -1 : 1,
                   true};
    s->is_inside = !s->is_inside;
    Crossing crossing;
    crossing_fill(s->shape, &hit, &crossing);
    if (!s->is_first) {
        scratch_push(s->scratch, &crossing);
    } else if (at > s->tmin && at < s->tmax) {
        *s->first = crossing;
        s->is_done = true;
    }
}

/* Can the fields reach the threshold between two t? */
static bool may_reach(const Sweep *s, double from, double to)
{
    double most = 0, sum = 0;
    for (uint32_t i = 0; i < s->active_count; i++) {
        const Stretch *f = &s->stretches[s->active[i]];
        if (f->strength <= 0)
            continue;
        double w = num_min(num_max(f->middle, from), to) - f->middle;
        double a = 1 - f->least - f->bend * w * w;
        most += f->strength * a * a;
        sum += f->strength;
    }
    return most + FIELD_EPS * sum >= s->blob->threshold;
}

/* Add up the fields about t, less the threshold. */
static void add_fields(const Sweep *s, double t, double c[5], double e[5])
{
    c[0] = -s->blob->threshold;
    e[0] = EPS_DOUBLE * fabs(c[0]);
    for (int i = 1; i < 5; i++)
        c[i] = e[i] = 0;
    for (uint32_t i = 0; i < s->active_count; i++) {
        const Stretch *f = &s->stretches[s->active[i]];
        double w = t - f->middle, k = f->strength, size = FIELD_EPS * fabs(k);
        double a0 = 1 - f->least - f->bend * w * w, a1 = -2 * f->bend * w, a2 = -f->bend;
        double m0 = 1 + f->least + f->bend * w * w, m1 = fabs(a1), m2 = f->bend;
        c[0] += k * a0 * a0;
        c[1] += 2 * k * a0 * a1;
        c[2] += k * (a1 * a1 + 2 * a0 * a2);
        c[3] += 2 * k * a1 * a2;
        c[4] += k * a2 * a2;
        e[0] += size * m0 * m0 + f->error;
        e[1] += 2 * size * m0 * m1;
        e[2] += size * (m1 * m1 + 2 * m0 * m2);
        e[3] += 2 * size * m1 * m2;
        e[4] += size * m2 * m2;
    }
}

/* The state changed where two stretches meet: the surface is as near as the rounding of both lets
 * it be. */
static void cross_between(Sweep *s, double t, double half, const double c[5], const double e[5])
{
    double f = 0, slope = 0, error = 0;
    for (int i = 4; i >= 0; i--) {
        slope = slope * -half + f;
        f = f * -half + c[i];
        error = error * half + e[i];
    }
    double off = 2 * (fabs(f) + error) / fabs(slope);
    cross(s, t, off < half ? off : half);
}

static void cross_roots(Sweep *s, double middle, const Root *root, int count)
{
    for (int i = 0; i < count && !s->is_done; i++) {
        if (i + 1 < count && root[i].x == root[i + 1].x)
            i++; /* touched only */
        else
            cross(s, middle + root[i].x, root[i].error);
    }
}

/* Find the crossings from one event to the next. */
static void sweep_part(Sweep *s, double from, double to)
{
    bool is_start = from == s->near, is_negative = true;
    double c[5], e[5], half = 0.5 * (to - from), middle = from + half;
    Root root[4];
    int count = 0;
    if (may_reach(s, from, to)) {
        add_fields(s, middle, c, e);
        count = roots_first(c, e, 4, from - middle, to - middle, s->is_first ? 1 : 4, &is_negative,
                            root);
    } else {
        c[0] = c[1] = c[2] = c[3] = c[4] = 0;
        memcpy(e, c, sizeof e);
    }
    if (is_start)
        s->is_inside = s->is_inside_before = !is_negative;
    else if (s->is_inside == is_negative)
        cross_between(s, from, half, c, e);
    cross_roots(s, middle, root, count);
    if (s->is_first && !s->is_done && count > 0) { /* the first root was not what is wanted */
        count = roots_first(c, e, 4, from - middle, to - middle, 4, &is_negative, root);
        s->is_inside = !is_negative;
        cross_roots(s, middle, root, count);
    }
}

/* Take up the fields that begin by t, and drop those that ended; returns the next event. */
static double update_active(Sweep *s, double t)
{
    uint32_t kept = 0;
    for (uint32_t i = 0; i < s->active_count; i++)
        if (s->stretches[s->active[i]].to > t)
            s->active[kept++] = s->active[i];
    for (; s->next < s->count && s->stretches[s->next].from <= t; s->next++)
        if (s->stretches[s->next].to > t)
            s->active[kept++] = s->next;
    s->active_count = kept;
    double end = s->next < s->count ? s->stretches[s->next].from : INFINITY;
    for (uint32_t i = 0; i < kept; i++)
        end = num_min(end, s->stretches[s->active[i]].to);
    return end;
}

static void sweep(Sweep *s)
{
    sort_stretches(s->stretches, s->count);
    s->active = (uint32_t *)(void *)(s->stretches + s->count);
    double at = s->count ? s->stretches[0].from : 0;
    while (!s->is_done) {
        double end = update_active(s, at);
        if (s->active_count > 0)
            sweep_part(s, at, end);
        else if (s->is_inside != s->is_beyond)
            cross(s, at, 0); /* by rounding: the field ends here */
        if (!isfinite(end))
            return;
        at = end;
    }
}

/* Follow a ray from near to far; returns the state before. */
static bool follow(Sweep *s, const Shape *shape, const Ray *ray, double near, double far)
{
    const BlobData *blob = shape->u.blob;
    LocalRay l;
    local_ray(shape, ray, &l);
    s->blob = blob;
    s->shape = shape;
    s->base = v3_dot(v3_sub(blob->center, l.o), l.d) / v3_len2(l.d);
    s->p = v3_mad(l.o, s->base, l.d);
    s->p_error = local_error(&l, s->base);
    s->d = l.d;
    s->tmin = near;
    s->tmax = far;
    s->near = near - s->base;
    s->far = far - s->base;
    s->is_beyond = s->is_inside = s->is_inside_before = blob->threshold < 0;
    gather(s);
    sweep(s);
    return s->is_inside_before;
}

static bool blob_list(const Shape *shape, const Line *line, ShapeScratch *scratch)
{
    Sweep s = {.scratch = scratch};
    return follow(&s, shape, line->ray, line->near, line->far);
}

static bool blob_closest(const Shape *shape, const Ray *ray, ShapeScratch *scratch, Crossing *out)
{
    Sweep s = {.scratch = scratch, .is_first = true, .first = out};
    follow(&s, shape, ray, ray->tmin, ray->tmax);
    return s.is_done;
}

/* --- at a point ---------------------------------------------------------------------------- */

/* The squared distance from the middle of a component in its own space, and the way from there. */
static V3 from_middle(const BlobComponent *c, V3 u)
{
    u.z -= num_min(num_max(u.z, 0), c->length);
    return u;
}

typedef void FieldSink(void *sink, const BlobComponent *c, double field, V3 gradient);

/* Call `add` for each component whose field is not zero at p. */
static void each_field(const BlobData *blob, V3 p, FieldSink *add, void *sink)
{
    const BoxTree *tree = &blob->tree;
    uint32_t stack[BOX_TREE_DEPTH_MAX], depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
        const BoxNode *node = &tree->nodes[stack[--depth]];
        const Bound *b = &node->box;
        if (p.x < b->lo.x || p.x > b->hi.x || p.y < b->lo.y || p.y > b->hi.y || p.z < b->lo.z ||
            p.z > b->hi.z)
            continue;
        for (uint32_t i = 0; i < node->count; i++) {
            const BlobComponent *c = &blob->components[tree->items[node->first + i]];
            V3 u = from_middle(c, xform_point_back(&c->place, p));
            double rest = 1 - v3_len2(u);
            if (rest > 0)
                add(sink, c, c->strength * rest * rest,
                    v3_scale(xform_normal(&c->place, u), -4 * c->strength * rest));
        }
        if (node->count == 0) {
            stack[depth++] = node->first + 1;
            stack[depth++] = node->first;
        }
    }
}

typedef struct Value {
    double f, error;
    V3 gradient, at;
} Value;

static void add_value(void *sink, const BlobComponent *c, double field, V3 gradient)
{
    Value *v = sink;
    v->f += field;
    v->gradient = v3_add(v->gradient, gradient);
    double off = 8 * EPS_DOUBLE * (c->spread * v3_sum_abs(v->at) + c->offset);
    v->error += fabs(c->strength) * (4 * FIELD_EPS + 4 * off);
}

static Value value_at(const BlobData *blob, V3 p)
{
    Value v = {.f = -blob->threshold,
               .error = 2 * EPS_DOUBLE * fabs(blob->threshold),
               .gradient = {0, 0, 0},
               .at = p};
    each_field(blob, p, add_value, &v);
    return v;
}

static void blob_point(const Shape *shape, const Crossing *crossing, V3 p, LocalPoint *out)
{
    const BlobData *blob = shape->u.blob;
    double reach =
        4 * crossing->t_error * v3_len(shape->rounding.row) + 16 * EPS_DOUBLE * v3_sum_abs(p);
    Value v = value_at(blob, p);
    for (int i = 0; i < 3 && fabs(v.f) > v.error; i++) {
        double step = v.f / v3_len2(v.gradient);
        if (!(fabs(step) * v3_len(v.gradient) <= reach))
            break;
        V3 next = v3_mad(p, -step, v.gradient);
        Value better = value_at(blob, next);
        if (!(fabs(better.f) < fabs(v.f)))
            break;
        p = next;
        v = better;
    }
    double slope = v3_len(v.gradient), error = 4 * v.error / slope;
    out->p = p;
    out->ng = slope > 0 ? v3_neg(v3_unit(v.gradient)) : v3(1, 0, 0);
    out->error = (error < reach ? error : reach) + 8 * EPS_DOUBLE * v3_sum_abs(p);
}

static bool blob_is_inside(const Shape *shape, V3 p)
{
    return value_at(shape->u.blob, p).f >= 0;
}

static Bound blob_bound(const Shape *shape)
{
    const BlobData *blob = shape->u.blob;
    Bound all = BOUND_EMPTY;
    if (blob->threshold < 0)
        return BOUND_ALL; /* what is far away is inside */
    for (uint32_t i = 0; i < blob->count; i++) {
        const BlobComponent *c = &blob->components[i];
        Xform place = xform_then(&c->place, &shape->xform);
        if (c->strength > 0)
            all = bound_union(all, component_box(&place, c->length));
    }
    return all;
}

/* --- textures ------------------------------------------------------------------------------ */

static void add_blend(void *sink, const BlobComponent *c, double field, V3 gradient)
{
    (void)gradient;
    ShapeBlend *blend = sink;
    double weight = fabs(field);
    int at = 0;
    while (at < blend->count && blend->texture[at] != c->texture)
        at++;
    if (at == SHAPE_BLEND_MAX) { /* the weakest goes */
        at = 0;
        for (int i = 1; i < blend->count; i++)
            at = blend->weight[i] < blend->weight[at] ? i : at;
        if (blend->weight[at] >= weight)
            return;
        blend->weight[at] = 0;
    } else if (at == blend->count) {
        blend->weight[blend->count++] = 0;
    }
    blend->texture[at] = c->texture;
    blend->weight[at] += weight;
}

bool shape_blend(const Shape *leaf, V3 p, ShapeBlend *out)
{
    out->count = 0;
    if (leaf->kind != SHAPE_BLOB || !leaf->u.blob->has_textures)
        return false;
    each_field(leaf->u.blob, leaf->is_transformed ? xform_point_back(&leaf->xform, p) : p,
               add_blend, out);
    double sum = 0;
    for (int i = 0; i < out->count; i++)
        sum += out->weight[i];
    for (int i = 0; i < out->count; i++)
        out->weight[i] /= sum;
    return sum > 0;
}

const ShapeOps blob_ops = {.list = blob_list,
                           .closest = blob_closest,
                           .point = blob_point,
                           .is_inside = blob_is_inside,
                           .bound = blob_bound};
