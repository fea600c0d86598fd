/* Isosurfaces: the solid where a function is at most a threshold, within a box or a sphere.
 *
 * Parts: 0 the surface itself, from 1 on those of the container.
 *
 * No root is guessed and no bound on the gradient is needed.  A tree of boxes (iso_tree.c), made
 * once, tells a line where there may be surface; in most of its cells the function is known to be
 * monotone along the line, and where the root is to within a little.  In others interval arithmetic
 * (func_range) says of a stretch of the line that the function has no zero there, or that it is
 * monotone there and so has one at most, which its ends tell; other stretches are halved.  What is
 * still undecided at the end of the digits is a touching, where both ends are on the same side.
 * Where a function jumps intervals may never decide: there stretches are samples after a while.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/iso_int.h"

enum {
    STRETCHES_MAX = 20000, /* of a line: then only the ends of those that are left are looked at */
    HALVINGS_MAX = 52,
    MEAN_VALUE_MAX = 24,
    JUMPY_MAX = 12, /* halvings where the function may jump: no finer than that it is looked at */
    REFINE_MAX = 100,
    PART_CONTAINER = 1
};

/* Values of a function, next to its magnitudes along a stretch, are rounded by less than this. */
#define VALUE_ROUNDING 0x1p-36

Shape *shape_isosurface(Arena *arena, const Func *func, double threshold, const Shape *container,
                        bool is_open)
{
    Shape *shape = leaf_new(arena, SHAPE_ISOSURFACE);
    if (!shape)
        return NULL;
    Bound box = shape_ops(container)->bound(container);
    const IsoTree *tree = iso_tree_new(arena, func, threshold, &box);
    if (!tree)
        return NULL;
    shape->u.iso = (IsosurfaceParams){func, container, threshold, tree};
    shape->is_open = is_open;
    leaf_place(shape, &XFORM_IDENTITY);
    return shape;
}

double shape_isosurface_steepest(const Shape *shape)
{
    return iso_tree_steepest(shape->u.iso.tree, shape->u.iso.func);
}

/* --- the function along a line -------------------------------------------------------------- */

/* A line about its middle in the container: p = middle + s d, t = base + s. */
typedef struct IsoLine {
    const IsosurfaceParams *iso;
    V3 middle, d, inverse;
    double base;
    double least;  /* stretches are not halved further */
    int stretches; /* that may still be looked at */
    FuncRanges *work;
} IsoLine;

/* A root between lo and hi. */
typedef struct IsoRoot {
    double s;
    int8_t change;       /* +1: from outside to inside */
    const IsoCell *cell; /* in which it is the only one; NULL: none was asked */
} IsoRoot;

/* Take a root; return true to end the search. */
typedef bool (*TakeRoot)(void *ctx, const IsoRoot *root);

static double value_at(const IsoLine *line, double s)
{
    V3 p = v3_mad(line->middle, s, line->d);
    return func_value(line->iso->func, (double[]){p.x, p.y, p.z}) - line->iso->threshold;
}

/* What is no number is outside. */
static bool is_in(double value)
{
    return value <= 0;
}

static Range axis_range(double middle, double d, double lo, double hi)
{
    double a = middle + (d < 0 ? hi : lo) * d, b = middle + (d < 0 ? lo : hi) * d;
    double rounding = 4 * EPS_DOUBLE * (fabs(middle) + fabs(a) + fabs(b));
    return (Range){a - rounding, b + rounding};
}

static Range value_over(const IsoLine *line, double lo, double hi, FuncRanges *work)
{
    const Range at[3] = {axis_range(line->middle.x, line->d.x, lo, hi),
                         axis_range(line->middle.y, line->d.y, lo, hi),
                         axis_range(line->middle.z, line->d.z, lo, hi)};
    Range r = func_range(line->iso->func, at, work);
    return (Range){r.lo - line->iso->threshold, r.hi - line->iso->threshold};
}

static Range slope_over(const IsoLine *line, FuncRanges *work)
{
    const Range slopes[3] = {
        {line->d.x, line->d.x}, {line->d.y, line->d.y}, {line->d.z, line->d.z}};
    return func_slope(line->iso->func, slopes, work);
}

/* The end of a stretch. */
typedef struct End {
    double s, value;
} End;

/* Find the root between two ends on different sides: false position, where the end that stays
 * counts half as much each time (the Illinois rule), and halving when that is slow. */
static double refine(const IsoLine *line, End a, End b)
{
    double width = b.s - a.s, fa = a.value, fb = b.value;
    for (int i = 0; i < REFINE_MAX && b.s - a.s > line->least; i++) {
        double s = a.s + (b.s - a.s) * (fa / (fa - fb));
        bool is_slow = i % 4 == 3 && b.s - a.s > 0.25 * width;
        if (is_slow || !(s > a.s && s < b.s))
            s = 0.5 * (a.s + b.s);
        if (!(s > a.s && s < b.s))
            break;
        if (i % 4 == 3)
            width = b.s - a.s;
        double f = value_at(line, s);
        if (is_in(f) == is_in(a.value)) {
            a = (End){s, f};
            fa = f;
            fb *= 0.5;
        } else {
            b = (End){s, f};
            fb = f;
            fa *= 0.5;
        }
    }
    return fabs(a.value) < fabs(b.value) ? a.s : b.s;
}

static bool take_between(const IsoLine *line, End a, End b, TakeRoot take, void *ctx)
{
    if (is_in(a.value) == is_in(b.value))
        return false;
    IsoRoot root = {refine(line, a, b), is_in(b.value) ? 1 : -1, NULL};
    return take(ctx, &root);
}

/* Does the mean value theorem keep the function from zero along a stretch?  Not to be asked of
 * stretches so short that the rounding of points counts. */
static bool is_kept_away(Range value, Range slope, double middle, double half)
{
    double most = fmax(fabs(slope.lo), fabs(slope.hi)) * half;
    double doubt = VALUE_ROUNDING * (fabs(value.lo) + fabs(value.hi));
    return fabs(middle) > most + doubt; /* false where a bound is infinite */
}

static bool search_stretch(IsoLine *line, End a, End b, int depth, TakeRoot take, void *ctx)
{
    if (line->stretches-- <= 0 || depth >= HALVINGS_MAX || b.s - a.s <= line->least)
        return take_between(line, a, b, take, ctx);
    Range value = value_over(line, a.s, b.s, line->work);
    if (line->work->has_no_value || value.lo > 0 || value.hi <= 0)
        return false;
    Range slope = slope_over(line, line->work);
    if (slope.lo > 0 || slope.hi < 0)
        return take_between(line, a, b, take, ctx);
    End middle = {0.5 * (a.s + b.s), 0};
    middle.value = value_at(line, middle.s);
    if (depth < MEAN_VALUE_MAX && is_kept_away(value, slope, middle.value, 0.5 * (b.s - a.s)))
        return false;
    bool may_jump = slope.lo == -INFINITY && slope.hi == INFINITY;
    if (may_jump && depth >= JUMPY_MAX)
        return take_between(line, a, middle, take, ctx) || take_between(line, middle, b, take, ctx);
    return search_stretch(line, a, middle, depth + 1, take, ctx) ||
           search_stretch(line, middle, b, depth + 1, take, ctx);
}

/* --- cells ---------------------------------------------------------------------------------- */

/* The line's part in a cell, and what the cell knows of it: the function is value + slope s, off by
 * less than the cell's. */
typedef struct Pass {
    const IsoCell *cell;
    End a, b;
    double value, slope, spread;
} Pass;

/* Find the root between two ends on different sides of a monotone stretch: where the line through
 * the last two places is zero, halving where that leads out. */
static double refine_monotone(const IsoLine *line, const Pass *pass, double lo, double hi)
{
    bool is_lo_in = is_in(pass->a.value);
    double s = fmin(fmax(-pass->value / pass->slope, lo), hi), slope = pass->slope, last = s, f = 0;
    for (int i = 0; i < REFINE_MAX && hi - lo > line->least; i++) {
        double value = value_at(line, s);
        if (fabs(value) <= pass->cell->doubt)
            return s;
        if (is_in(value) == is_lo_in)
            lo = s;
        else
            hi = s;
        if (i > 0 && s != last && value != f)
            slope = fmin(fmax((value - f) / (s - last), pass->slope - pass->spread),
                         pass->slope + pass->spread);
        last = s;
        f = value;
        double next = s - value / slope;
        if (fabs(next - s) <= line->least)
            return s;
        s = next > lo && next < hi ? next : 0.5 * (lo + hi);
    }
    return s;
}

/* Take the one root that a stretch may have; its ends have been looked at, or their sides are
 * known. */
static bool take_monotone(const IsoLine *line, Pass *pass, TakeRoot take, void *ctx)
{
    if (is_in(pass->a.value) == is_in(pass->b.value))
        return false;
    double s = refine_monotone(line, pass, pass->a.s, pass->b.s);
    IsoRoot root = {s, is_in(pass->b.value) ? 1 : -1, pass->cell};
    return take(ctx, &root);
}

/* Narrow a monotone stretch to where the function may be zero.  Where that leaves out an end, the
 * side that the line is on there is known. */
static void narrow(const IsoLine *line, Pass *pass)
{
    double off = pass->cell->off, rounding = 1 + 8 * EPS_DOUBLE;
    double reach = rounding * off / fabs(pass->slope), root = -pass->value / pass->slope;
    double rises = pass->slope < 0 ? -1 : 1;
    if (root - reach > pass->a.s)
        pass->a = (End){root - reach, -rises * off};
    else
        pass->a.value = value_at(line, pass->a.s);
    if (root + reach < pass->b.s)
        pass->b = (End){root + reach, rises * off};
    else
        pass->b.value = value_at(line, pass->b.s);
}

/* Search the part of a line in a cell. */
static bool search_cell(IsoLine *line, const IsoCell *cell, double lo, double hi, TakeRoot take,
                        void *ctx)
{
    Pass pass = {.cell = cell, .a = {lo, 0}, .b = {hi, 0}};
    if (cell->is_smooth) {
        pass.value = cell->value + v3_dot(cell->slope, v3_sub(line->middle, cell->center));
        pass.slope = v3_dot(cell->slope, line->d);
        pass.spread = v3_dot(cell->spread, v3_abs(line->d));
        double a = pass.value + pass.slope * lo, b = pass.value + pass.slope * hi;
        if (fmin(a, b) > cell->off || fmax(a, b) < -cell->off)
            return false;
        if (fabs(pass.slope) > 1.01 * pass.spread) {
            narrow(line, &pass);
            return take_monotone(line, &pass, take, ctx);
        }
    }
    pass.a.value = value_at(line, lo);
    pass.b.value = value_at(line, hi);
    /* As if the whole line had been halved to this part. */
    int depth = ilogb(line->least / (EPS_DOUBLE * (hi - lo)));
    return search_stretch(line, pass.a, pass.b, depth > 0 ? depth : 0, take, ctx);
}

/* --- crossings ------------------------------------------------------------------------------ */

/* A search along a ray. */
typedef struct IsoSearch {
    const Shape *shape;
    const LocalRay *ray;
    IsoLine line;
    LeafHits container; /* where the line enters and leaves it */
    double near, far;   /* t of what is looked at */
    bool is_inside;     /* at the beginning of that */
    bool is_in_now;     /* where it has been looked at, if that is known */
    bool is_side_known;
    ShapeScratch *scratch; /* where crossings go; NULL: the first one is wanted */
    Crossing *first;
} IsoSearch;

/* Bound the error of a root: that of the value there over the slope. */
static double error_at(const IsoSearch *search, double s, double doubt, double slope)
{
    double most = 1e-6 * (search->far - search->near) + search->line.least;
    double error = doubt / slope;
    return fmin(isfinite(error) ? error : most, most) + 2 * search->line.least +
           4 * EPS_DOUBLE * fabs(search->line.base + s);
}

/* The same for the only root in a cell, which knows about values and slopes. */
static double root_error_in(const IsoSearch *search, const IsoRoot *root)
{
    const IsoCell *cell = root->cell;
    const IsoLine *line = &search->line;
    V3 p = v3_mad(line->middle, root->s, line->d);
    V3 off = v3_mad(local_error(search->ray, line->base + root->s), PLACE_EPS, v3_abs(p));
    double doubt = cell->doubt + v3_dot(v3_add(v3_abs(cell->slope), cell->spread), off);
    double slope = fabs(v3_dot(cell->slope, line->d)) - v3_dot(cell->spread, v3_abs(line->d));
    return error_at(search, root->s, doubt, slope);
}

static double root_error(const IsoSearch *search, double s)
{
    const IsoLine *line = &search->line;
    V3 p = v3_mad(line->middle, s, line->d), gradient;
    func_gradient(line->iso->func, (double[]){p.x, p.y, p.z}, &gradient);
    Range here = value_over(line, s, s, line->work);
    V3 off = v3_add(local_error(search->ray, line->base + s), v3_scale(v3_abs(p), PLACE_EPS));
    double doubt = here.hi - here.lo + v3_dot(v3_abs(gradient), off);
    return error_at(search, s, doubt, fabs(v3_dot(gradient, line->d)));
}

static bool take_crossing(IsoSearch *search, const LeafHit *hit)
{
    Crossing crossing;
    crossing_fill(search->shape, hit, &crossing);
    if (search->scratch) {
        scratch_push(search->scratch, &crossing);
        return false;
    }
    if (!hit->is_visible || !(hit->t > search->near && hit->t < search->far))
        return false;
    *search->first = crossing;
    return true;
}

static bool take_root(void *ctx, const IsoRoot *root)
{
    IsoSearch *search = ctx;
    const LeafHit *ends = search->container.at;
    double t = fmin(fmax(search->line.base + root->s, ends[0].t), ends[1].t);
    double error = root->cell ? root_error_in(search, root) : root_error(search, root->s);
    LeafHit hit = {t, error, 0, root->change, true};
    search->is_in_now = root->change > 0;
    search->is_side_known = true;
    return take_crossing(search, &hit);
}

/* Take a crossing of the container's surface, where that bounds the solid. */
static bool take_container(IsoSearch *search, int end)
{
    LeafHit hit = search->container.at[end];
    hit.part += PART_CONTAINER;
    hit.is_visible = !search->shape->is_open;
    return take_crossing(search, &hit);
}

/* Begin a search; false when the line misses the container there. */
static bool begin(IsoSearch *search, const Shape *shape, const LocalRay *ray)
{
    const IsosurfaceParams *iso = &shape->u.iso;
    search->shape = shape;
    search->ray = ray;
    shape_ops(iso->container)->hits(iso->container, ray, &search->container);
    if (search->container.count != 2)
        return false;
    double in = search->container.at[0].t, out = search->container.at[1].t;
    double base = 0.5 * (in + out);
    search->line = (IsoLine){.iso = iso,
                             .middle = v3_mad(ray->o, base, ray->d),
                             .d = ray->d,
                             .inverse = v3(1 / ray->d.x, 1 / ray->d.y, 1 / ray->d.z),
                             .base = base,
                             .least = EPS_DOUBLE * (out - in),
                             .stretches = STRETCHES_MAX};
    return in < search->far && out > search->near;
}

/* A part of the line, in a box of the tree. */
typedef struct Walk {
    double lo, hi;
    uint32_t node;
} Walk;

/* Go to the box that the line enters first; what is behind it waits on the stack. */
static const IsoNode *descend(const IsoLine *line, Walk *at, Walk *stack, int *count)
{
    const IsoNode *nodes = line->iso->tree->nodes, *node = &nodes[at->node];
    const double middle[3] = {line->middle.x, line->middle.y, line->middle.z};
    const double d[3] = {line->d.x, line->d.y, line->d.z};
    const double inverse[3] = {line->inverse.x, line->inverse.y, line->inverse.z};
    while (node->kind == ISO_HALVED) {
        double to = node->at - middle[node->axis], along = d[node->axis];
        double s = to * inverse[node->axis];
        bool is_high = along > 0 ? at->lo >= s : along < 0 ? at->lo < s : to <= 0;
        bool is_both = along != 0 && s > at->lo && s < at->hi;
        if (is_both) {
            is_high = along < 0;
            stack[(*count)++] = (Walk){s, at->hi, node->first + !is_high};
            at->hi = s;
        }
        at->node = node->first + is_high;
        node = &nodes[at->node];
    }
    return node;
}

/* Find out on which side the line begins, in a box. */
static void begin_side(IsoSearch *search, const IsoNode *node, double lo)
{
    bool is_cell = node->kind == ISO_CELL;
    search->is_in_now = is_cell ? is_in(value_at(&search->line, lo)) : node->kind == ISO_IN;
    search->is_side_known = true;
}

/* Look for roots in the boxes along the line; returns whether the search was ended. */
static bool search_boxes(IsoSearch *search, const IsoNode *node, Walk at, Walk *stack, int count)
{
    IsoLine *line = &search->line;
    for (;;) {
        if (node->kind != ISO_CELL) {
            search->is_in_now = node->kind == ISO_IN;
            search->is_side_known = true;
        } else if (search_cell(line, &line->iso->tree->cells[node->first], at.lo, at.hi, take_root,
                               search)) {
            return true;
        }
        if (count == 0)
            return false;
        at = stack[--count];
        node = descend(line, &at, stack, &count);
    }
}

/* Look at what the container and [near, far] share; returns whether the search was ended. */
static bool run(IsoSearch *search)
{
    FuncRanges work;
    Walk stack[ISO_DEPTH_MAX];
    IsoLine *line = &search->line;
    line->work = &work;
    double in = search->container.at[0].t, out = search->container.at[1].t;
    Walk at = {fmax(in, search->near) - line->base, fmin(out, search->far) - line->base, 0};
    double lo = at.lo;
    bool has_entry = in > search->near;
    int count = 0;
    const IsoNode *node = descend(line, &at, stack, &count);
    if (has_entry || search->scratch) {
        begin_side(search, node, lo);
        search->is_inside = search->is_in_now && !has_entry;
        if (has_entry && search->is_in_now && take_container(search, 0))
            return true;
    }
    if (search_boxes(search, node, at, stack, count))
        return true;
    if (out >= search->far)
        return false;
    if (!search->is_side_known)
        begin_side(search, &(IsoNode){.kind = ISO_CELL}, lo);
    return search->is_in_now && take_container(search, 1);
}

static bool iso_list(const Shape *shape, const Line *part, ShapeScratch *scratch)
{
    LocalRay local;
    IsoSearch search = {.near = part->near, .far = part->far, .scratch = scratch};
    local_ray(shape, part->ray, &local);
    if (begin(&search, shape, &local))
        run(&search);
    return search.is_inside;
}

static bool iso_closest(const Shape *shape, const Ray *ray, ShapeScratch *scratch, Crossing *out)
{
    LocalRay local;
    IsoSearch search = {.near = ray->tmin, .far = ray->tmax, .first = out};
    (void)scratch;
    local_ray(shape, ray, &local);
    return begin(&search, shape, &local) && run(&search);
}

/* --- the other operations ------------------------------------------------------------------- */

static double value_of(const IsosurfaceParams *iso, V3 p, V3 *gradient)
{
    return func_gradient(iso->func, (double[]){p.x, p.y, p.z}, gradient) - iso->threshold;
}

/* Bound the rounding of the function's value at a point. */
static double rounding_at(const IsosurfaceParams *iso, V3 p)
{
    FuncRanges work;
    const Range at[3] = {{p.x, p.x}, {p.y, p.y}, {p.z, p.z}};
    Range value = func_range(iso->func, at, &work);
    return value.hi - value.lo;
}

/* A Newton step along the gradient takes p to the surface. */
static void surface_point(const IsosurfaceParams *iso, V3 p, LocalPoint *out)
{
    V3 gradient;
    double value = value_of(iso, p, &gradient), length = v3_len(gradient);
    bool is_steep = length > 0 && isfinite(length);
    double off = is_steep ? value / length : 0;
    out->ng = is_steep ? v3_scale(gradient, 1 / length) : v3(1, 0, 0);
    V3 moved = v3_mad(p, -off, out->ng);
    V3 turned;
    double left = value_of(iso, moved, &turned);
    bool is_nearer = fabs(left) < fabs(value);
    out->p = is_nearer ? moved : p;
    if (is_nearer && v3_len2(turned) > 0 && v3_is_finite(turned))
        out->ng = v3_unit(turned);
    double doubt = 2 * rounding_at(iso, out->p) + fabs(is_nearer ? left : value);
    out->error = (is_steep ? doubt / length : 0) + 2 * PLACE_EPS * v3_sum_abs(p);
}

static void iso_point(const Shape *shape, const Crossing *crossing, V3 p, LocalPoint *out)
{
    const IsosurfaceParams *iso = &shape->u.iso;
    if (crossing->part < PART_CONTAINER) {
        surface_point(iso, p, out);
        return;
    }
    Crossing side = *crossing;
    side.part -= PART_CONTAINER;
    shape_ops(iso->container)->point(iso->container, &side, p, out);
}

static bool iso_is_inside(const Shape *shape, V3 p)
{
    const IsosurfaceParams *iso = &shape->u.iso;
    return shape_ops(iso->container)->is_inside(iso->container, p) &&
           is_in(func_value(iso->func, (double[]){p.x, p.y, p.z}) - iso->threshold);
}

static Bound iso_bound(const Shape *shape)
{
    const Shape *container = shape->u.iso.container;
    Bound b = shape_ops(container)->bound(container);
    return shape->is_transformed ? bound_pad(bound_transform(b, &shape->xform)) : b;
}

static V3 iso_farthest(const Shape *shape, V3 n)
{
    const Shape *container = shape->u.iso.container;
    return shape_ops(container)->farthest(container, n);
}

const ShapeOps isosurface_ops = {.list = iso_list,
                                 .closest = iso_closest,
                                 .point = iso_point,
                                 .is_inside = iso_is_inside,
                                 .bound = iso_bound,
                                 .farthest = iso_farthest};
