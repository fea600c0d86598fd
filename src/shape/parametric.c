/* Parametric surfaces: what functions of u and v draw.
 *
 * A line is taken through the tree of patches (parametric_tree.c).  Of a patch that is flat enough
 * it is proved that the line meets it once at most, and Newton's method, kept within the patch,
 * tells whether and where; other patches, at outlines and where the surface is pointed, are halved
 * further.  Patches share the sides they have in common: what is found on one by several of them
 * is the same to within its error, and counts once.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/parametric_int.h"

enum {
    PATCHES_MADE_MAX = 3000, /* of a line: then what is undecided is not met */
    HALVINGS_MAX = 90,
    NEWTON_MAX = 16,
    STACK_MAX = 64, /* more than the tree is deep */
};

/* What is undecided and this small, next to the surface, is met where the line passes it. */
#define TINY 0x1p-40
#define SMALL 0x1p-24

/* A line meets a patch once if its derivatives change by less than this along it. */
#define SPREAD_MAX 0.3

/* How far into the domain a normal is looked for where the surface has none. */
#define INWARD 1e-4

Shape *shape_parametric(Arena *arena, const FuncTriple *func, V2 lo, V2 hi, const Shape *container)
{
    Shape *shape = leaf_new(arena, SHAPE_PARAMETRIC);
    ParametricData *data = ARENA_NEW(arena, ParametricData);
    if (!shape || !data)
        return NULL;
    data->func = *func;
    data->domain = (Rect){{lo.u, hi.u}, {lo.v, hi.v}};
    data->container = container;
    shape->u.parametric = data;
    if (!parametric_tree(arena, data))
        return NULL;
    leaf_place(shape, &XFORM_IDENTITY);
    return shape;
}

/* --- lines ---------------------------------------------------------------------------------- */

/* A search along a ray, about a point of it near the surface: p = o + s d, t = base + s. */
typedef struct Search {
    const Shape *shape;
    const ParametricData *data;
    V3 o, d, inverse;
    V3 doubt; /* bound on the error of the line's points */
    double base;
    double near, far;      /* of s */
    double size;           /* of the surface */
    int patches;           /* that may still be made */
    ShapeScratch *scratch; /* where crossings go; NULL: the first one is wanted */
    Crossing *first;
} Search;

/* Where a line may meet a patch. */
typedef struct Meeting {
    double a, b, s;                   /* along the patch's sides, -1 to 1; along the line */
    double a_error, b_error, s_error; /* where the surface is `spread` off the parallelogram */
    double a_doubt, b_doubt, s_doubt; /* where it is as far off as points are rounded */
} Meeting;

/* Solve for where a line meets the plane through `at`; false where it is parallel. */
static bool meet_plane(const Search *search, V3 at, V3 along_u, V3 along_v, V3 spread, V3 doubt,
                       Meeting *out)
{
    V3 w = v3_sub(search->o, at), d = search->d;
    V3 by_a = v3_cross(along_v, d), by_b = v3_cross(d, along_u), n = v3_cross(along_u, along_v);
    double inverse = 1 / v3_dot(n, d), most = fabs(inverse);
    V3 off_a = v3_abs(by_a), off_b = v3_abs(by_b), off_s = v3_abs(n);
    out->a = v3_dot(w, by_a) * inverse;
    out->b = v3_dot(w, by_b) * inverse;
    out->s = -v3_dot(w, n) * inverse;
    out->a_error = v3_dot(off_a, spread) * most;
    out->b_error = v3_dot(off_b, spread) * most;
    out->s_error = v3_dot(off_s, spread) * most;
    V3 rounding = v3_mad(doubt, 16 * EPS_DOUBLE, v3_abs(w));
    out->a_doubt = v3_dot(off_a, rounding) * most;
    out->b_doubt = v3_dot(off_b, rounding) * most;
    out->s_doubt = v3_dot(off_s, rounding) * most;
    return isfinite(out->a + out->b + out->s) && isfinite(out->a_doubt + out->b_doubt);
}

/* Cut the part of the line that is looked at to a box; false when it misses it. */
static bool cut(const Search *search, const Bound *box, double *near, double *far)
{
    *near = search->near, *far = search->far;
    const double o[3] = {search->o.x, search->o.y, search->o.z};
    const double doubt[3] = {search->doubt.x, search->doubt.y, search->doubt.z};
    const double inverse[3] = {search->inverse.x, search->inverse.y, search->inverse.z};
    const double lo[3] = {box->lo.x, box->lo.y, box->lo.z};
    const double hi[3] = {box->hi.x, box->hi.y, box->hi.z};
    for (int i = 0; i < 3; i++) {
        /* A line along a side has an infinite inverse: what is no number then cuts nothing. */
        double a = (lo[i] - doubt[i] - o[i]) * inverse[i];
        double b = (hi[i] + doubt[i] - o[i]) * inverse[i];
        double first = inverse[i] < 0 ? b : a, last = inverse[i] < 0 ? a : b;
        *near = first > *near ? first : *near;
        *far = last < *far ? last : *far;
    }
    return *near <= *far;
}

/* Take a crossing; of the first one only what is nearer than it is still looked at. */
static void take(Search *search, const Meeting *at, V2 uv)
{
    double t = search->base + at->s;
    double error = at->s_doubt + 8 * EPS_DOUBLE * (fabs(t) + fabs(search->base));
    if (!(at->s > search->near && at->s < search->far))
        return;
    const Rect *domain = &search->data->domain;
    Crossing crossing = {.t = t,
                         .t_error = error,
                         .leaf = search->shape,
                         .is_visible = true,
                         .u = fmin(fmax(uv.u, domain->u.lo), domain->u.hi),
                         .v = fmin(fmax(uv.v, domain->v.lo), domain->v.hi)};
    if (search->scratch) {
        scratch_push(search->scratch, &crossing);
        return;
    }
    *search->first = crossing;
    search->far = at->s;
}

static double clamp_one(double x)
{
    return x < -1 ? -1 : x > 1 ? 1 : x;
}

/* Find where the line meets a patch that it meets once at most; false when that cannot be told. */
static bool newton(Search *search, const Patch *patch, Meeting at)
{
    V2 uv;
    for (int i = 0; i < NEWTON_MAX; i++) {
        double a = clamp_one(at.a), b = clamp_one(at.b);
        V3 by_u, by_v;
        uv = (V2){patch->middle.u + a * patch->half.u, patch->middle.v + b * patch->half.v};
        V3 p = func_triple(&search->data->func, (double[]){uv.u, uv.v}, &by_u, &by_v);
        V3 along_u = v3_scale(by_u, patch->half.u), along_v = v3_scale(by_v, patch->half.v);
        V3 doubt = v3_add(search->doubt, patch->doubt);
        if (!meet_plane(search, p, along_u, along_v, v3(0, 0, 0), doubt, &at))
            return false;
        double step_a = fabs(at.a), step_b = fabs(at.b);
        at.a += a;
        at.b += b;
        double left_a = fabs(clamp_one(at.a) - a), left_b = fabs(clamp_one(at.b) - b);
        if (left_a > at.a_doubt || left_b > at.b_doubt)
            continue;
        /* Outside by more than rounding: no meeting in this patch. */
        if (step_a <= PATCH_SLACK * at.a_doubt && step_b <= PATCH_SLACK * at.b_doubt)
            take(search, &at, uv);
        return true;
    }
    return false;
}

static void search_patch(Search *search, const Patch *patch, int depth);

/* What cannot be told of a small patch is that it is met where the line passes it. */
static void take_small(Search *search, const Patch *patch, double near, double far)
{
    double size = v3_len(v3_sub(patch->box.hi, patch->box.lo));
    double middle = 0.5 * (near + far);
    Meeting at = {.s = middle, .s_doubt = far - middle};
    if (size <= SMALL * search->size)
        take(search, &at, patch->middle);
}

static void search_halves(Search *search, const Patch *patch, int depth, double near, double far)
{
    Rect halves[2];
    double size = v3_len(v3_sub(patch->box.hi, patch->box.lo));
    bool is_end = depth == HALVINGS_MAX || size <= TINY * search->size || search->patches < 2;
    if (is_end || !parametric_halve(patch, halves)) {
        take_small(search, patch, near, far);
        return;
    }
    Patch half;
    for (int i = 0; i < 2; i++) {
        search->patches--;
        parametric_patch(search->data, halves[i], &half);
        if (half.is_bounded && !bound_is_empty(half.box))
            search_patch(search, &half, depth + 1);
    }
}

static void search_patch(Search *search, const Patch *patch, int depth)
{
    double near, far;
    Meeting at;
    if (!cut(search, &patch->box, &near, &far))
        return;
    bool is_met =
        patch->is_smooth && meet_plane(search, patch->center, patch->along_u, patch->along_v,
                                       v3_add(patch->spread_u, patch->spread_v),
                                       v3_add(search->doubt, patch->doubt), &at);
    if (is_met) {
        double s_off = at.s_error + at.s_doubt;
        if (fabs(at.a) > 1 + at.a_error + PATCH_SLACK * at.a_doubt ||
            fabs(at.b) > 1 + at.b_error + PATCH_SLACK * at.b_doubt || at.s - s_off > search->far ||
            at.s + s_off < search->near)
            return;
        bool is_once = at.a_error < SPREAD_MAX && at.b_error < SPREAD_MAX;
        if (is_once && newton(search, patch, at))
            return;
    }
    search_halves(search, patch, depth, near, far);
}

/* Walk the tree, the nearer one of two boxes first. */
static void walk(Search *search)
{
    const BoxNode *nodes = search->data->nodes;
    uint32_t stack[STACK_MAX];
    double entry[STACK_MAX], far;
    int count = 0;
    if (cut(search, &nodes[0].box, &entry[0], &far))
        stack[count++] = 0;
    while (count > 0) {
        const BoxNode *node = &nodes[stack[--count]];
        if (entry[count] > search->far)
            continue;
        if (node->count > 0) {
            search_patch(search, &search->data->patches[node->first], 0);
            continue;
        }
        double first, second;
        bool has_first = cut(search, &nodes[node->first].box, &first, &far);
        bool has_second = cut(search, &nodes[node->first + 1].box, &second, &far);
        bool is_second_near = has_second && second < first;
        for (int i = 0; i < 2; i++) {
            bool is_second = (i == 0) != is_second_near;
            if (!(is_second ? has_second : has_first))
                continue;
            entry[count] = is_second ? second : first;
            stack[count++] = node->first + is_second;
        }
    }
}

/* Narrow a search to the container; false when the line misses it. */
static bool narrow(Search *search, const LocalRay *ray)
{
    const Shape *container = search->data->container;
    LeafHits hits;
    shape_ops(container)->hits(container, ray, &hits);
    if (hits.count != 2)
        return false;
    double in = hits.at[0].t - 2 * hits.at[0].t_error, out = hits.at[1].t + 2 * hits.at[1].t_error;
    search->near = fmax(search->near, in - search->base);
    search->far = fmin(search->far, out - search->base);
    return search->near <= search->far;
}

static void run(Search *search, const Shape *shape, const Ray *ray)
{
    LocalRay local;
    local_ray(shape, ray, &local);
    const ParametricData *data = shape->u.parametric;
    if (bound_is_empty(data->box))
        return;
    search->shape = shape;
    search->data = data;
    search->d = local.d;
    search->base = v3_dot(v3_sub(bound_center(data->box), local.o), local.d) / v3_len2(local.d);
    search->o = v3_mad(local.o, search->base, local.d);
    search->inverse = v3(1 / local.d.x, 1 / local.d.y, 1 / local.d.z);
    search->size = v3_len(v3_sub(data->box.hi, data->box.lo));
    search->patches = PATCHES_MADE_MAX;
    search->near -= search->base;
    search->far -= search->base;
    if (!narrow(search, &local))
        return;
    double most = fmax(fabs(search->base + search->near), fabs(search->base + search->far));
    search->doubt = local_error(&local, fmax(most, fabs(search->base)));
    walk(search);
}

static bool parametric_closest(const Shape *shape, const Ray *ray, ShapeScratch *scratch,
                               Crossing *out)
{
    (void)scratch;
    *out = (Crossing){.leaf = NULL};
    Search search = {.near = ray->tmin, .far = ray->tmax, .first = out};
    run(&search, shape, ray);
    return out->leaf && out->t > ray->tmin && out->t < ray->tmax;
}

/* Keep one of the crossings that were found in several patches. */
static void drop_copies(ShapeScratch *scratch, int first)
{
    Crossing *items = scratch->items;
    int kept = first;
    crossings_sort(items + first, scratch->count - first);
    for (int i = first; i < scratch->count; i++) {
        const Crossing *last = &items[kept - 1];
        if (kept == first || items[i].t - last->t > items[i].t_error + last->t_error)
            items[kept++] = items[i];
    }
    scratch->count = kept;
}

static bool parametric_list(const Shape *shape, const Line *line, ShapeScratch *scratch)
{
    Search search = {.near = line->near, .far = line->far, .scratch = scratch};
    int first = scratch->count;
    run(&search, shape, line->ray);
    drop_copies(scratch, first);
    return false;
}

/* --- the other operations ------------------------------------------------------------------- */

/* Return the normal for parameters, not unit; 0 where there is none. */
static V3 normal_at(const ParametricData *data, double u, double v)
{
    V3 by_u, by_v;
    func_triple(&data->func, (double[]){u, v}, &by_u, &by_v);
    V3 n = v3_cross(v3_unit(by_u), v3_unit(by_v));
    return v3_is_finite(n) ? n : v3(0, 0, 0);
}

static V3 unit_normal(const ParametricData *data, double u, double v)
{
    V3 n = normal_at(data, u, v);
    if (!(v3_len2(n) > 0)) {
        double to_u = 0.5 * (data->domain.u.lo + data->domain.u.hi) - u,
               to_v = 0.5 * (data->domain.v.lo + data->domain.v.hi) - v;
        n = normal_at(data, u + INWARD * to_u, v + INWARD * to_v);
    }
    return v3_len2(n) > 0 ? v3_unit(n) : v3(1, 0, 0);
}

static void parametric_point(const Shape *shape, const Crossing *crossing, V3 p, LocalPoint *out)
{
    const ParametricData *data = shape->u.parametric;
    FuncRanges work;
    V3 by_u, by_v;
    const Range at[2] = {{crossing->u, crossing->u}, {crossing->v, crossing->v}};
    double width = 0;
    func_range(data->func.func, at, &work);
    for (int i = 0; i < 3; i++) {
        Range r = work.value[data->func.results[i]];
        width += r.hi - r.lo;
    }
    V3 on = func_triple(&data->func, (double[]){crossing->u, crossing->v}, &by_u, &by_v);
    bool is_known = v3_is_finite(on) && isfinite(width);
    out->p = is_known ? on : p;
    out->error = (is_known ? width : 0) + 2 * shape->rounding.place;
    out->ng = unit_normal(data, crossing->u, crossing->v);
}

static V2 parametric_uv(const Shape *shape, uint32_t part, double u, double v, V3 p)
{
    (void)shape;
    (void)part;
    (void)p;
    return (V2){u, v};
}

static Bound parametric_bound(const Shape *shape)
{
    Bound b = shape->u.parametric->box;
    if (shape->is_transformed)
        b = bound_transform(b, &shape->xform);
    return shape->rounding.is_exact ? b : bound_pad(b);
}

static V3 parametric_farthest(const Shape *shape, V3 n)
{
    return bound_farthest(shape->u.parametric->box, n);
}

static double parametric_size(const Shape *shape)
{
    const Bound *b = &shape->u.parametric->box;
    return bound_is_empty(*b) ? 0 : num_max(v3_max_abs(b->lo), v3_max_abs(b->hi));
}

const ShapeOps parametric_ops = {.list = parametric_list,
                                 .closest = parametric_closest,
                                 .point = parametric_point,
                                 .uv = parametric_uv,
                                 .bound = parametric_bound,
                                 .farthest = parametric_farthest,
                                 .size = parametric_size};
