/* The patches of a parametric surface, and a tree of boxes over them.
 *
 * Interval arithmetic bounds a patch twice: by a box, and by a parallelogram and how far its points
 * may be from it, which shrinks with the square of the patch.  Patches are halved, the largest
 * ones first, until their derivatives hardly change, or there are as many as may be.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/parametric_int.h"

#include "base/mem.h"

#include <string.h>

enum {
    PATCHES_MAX = 1 << 14,       /* of the tree */
    NODES_MAX = 4 * PATCHES_MAX, /* with patches that may have no points: those are left out */
    HALVINGS_MAX = 24,           /* of the domain, to the patches of the tree */
};

/* Relative rounding of parameters, with room to spare. */
#define PARAMETER_ROUNDING (8 * EPS_DOUBLE)

/* The derivatives of a patch of the tree change by less than this, next to themselves. */
#define SPREAD_WANTED 0.06

/* --- patches -------------------------------------------------------------------------------- */

static double middle_of(Range r)
{
    double middle = 0.5 * r.lo + 0.5 * r.hi;
    return isfinite(middle) ? middle : 0;
}

/* How far a range reaches from a number in it. */
static double reach_of(Range r, double from)
{
    return (1 + 4 * EPS_DOUBLE) * fmax(r.hi - from, from - r.lo);
}

static V3 middles(const Range r[3])
{
    return v3(middle_of(r[0]), middle_of(r[1]), middle_of(r[2]));
}

static V3 reaches(const Range r[3], V3 from)
{
    return v3(reach_of(r[0], from.x), reach_of(r[1], from.y), reach_of(r[2], from.z));
}

static void results(const FuncTriple *func, const Range *slots, Range out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = slots[func->results[i]];
}

/* Bound the derivative along a half side of the rectangle just asked about. */
static void slopes(const FuncTriple *func, double half_u, double half_v, FuncRanges *work,
                   V3 *along, V3 *spread)
{
    const Range sides[2] = {{half_u, half_u}, {half_v, half_v}};
    Range r[3];
    func_slope(func->func, sides, work);
    results(func, work->slope, r);
    *along = middles(r);
    *spread = reaches(r, *along);
}

/* What is met beside a patch, to within this, counts as met in it. */
static Bound widened(Bound box, V3 doubt)
{
    V3 by = v3_scale(doubt, 2 * PATCH_SLACK);
    return (Bound){v3_sub(box.lo, by), v3_add(box.hi, by)};
}

/* The box around the parallelogram and what may be off it. */
static Bound box_around(const Patch *p)
{
    V3 reach =
        v3_add(v3_add(v3_abs(p->along_u), v3_abs(p->along_v)), v3_add(p->spread_u, p->spread_v));
    return widened((Bound){v3_sub(p->center, reach), v3_add(p->center, reach)}, p->doubt);
}

void parametric_patch(const ParametricData *data, Rect rect, Patch *out)
{
    const FuncTriple *func = &data->func;
    FuncRanges work;
    Range r[3];
    V2 middle = {middle_of(rect.u), middle_of(rect.v)};
    V2 half = {reach_of(rect.u, middle.u), reach_of(rect.v, middle.v)};
    *out = (Patch){.rect = rect, .middle = middle, .half = half};
    const Range at[2] = {{middle.u, middle.u}, {middle.v, middle.v}};
    func_range(func->func, at, &work);
    results(func, work.value, r);
    out->center = middles(r);
    out->doubt = v3_scale(reaches(r, out->center), 2);
    func_range(func->func, (Range[]){rect.u, rect.v}, &work);
    results(func, work.value, r);
    out->is_bounded = v3_is_finite(middles(r)) && v3_is_finite(reaches(r, middles(r)));
    out->box = (Bound){v3(r[0].lo, r[1].lo, r[2].lo), v3(r[0].hi, r[1].hi, r[2].hi)};
    slopes(func, half.u, 0, &work, &out->along_u, &out->spread_u);
    slopes(func, 0, half.v, &work, &out->along_v, &out->spread_v);
    /* Parameters within the patch are rounded, too, and so are the ends of the domain, which may
     * be meant to meet. */
    double coarse_u = PARAMETER_ROUNDING * (1 + fabs(middle.u) / half.u);
    double coarse_v = PARAMETER_ROUNDING * (1 + fabs(middle.v) / half.v);
    out->doubt = v3_mad(out->doubt, coarse_u, v3_add(v3_abs(out->along_u), out->spread_u));
    out->doubt = v3_mad(out->doubt, coarse_v, v3_add(v3_abs(out->along_v), out->spread_v));
    out->is_smooth = v3_is_finite(v3_add(v3_add(out->spread_u, out->spread_v), out->doubt)) &&
                     v3_is_finite(v3_add(out->along_u, out->along_v));
    if (out->is_smooth)
        out->box = bound_intersect(widened(out->box, out->doubt), box_around(out));
    out->box = bound_intersect(out->box, shape_ops(data->container)->bound(data->container));
}

static double longest(V3 a, V3 b)
{
    return v3_len(a) + v3_len(b);
}

bool parametric_halve(const Patch *p, Rect halves[2])
{
    bool is_u = p->is_smooth ? longest(p->along_u, p->spread_u) >= longest(p->along_v, p->spread_v)
                             : p->half.u >= p->half.v;
    if (is_u && !(p->middle.u > p->rect.u.lo && p->middle.u < p->rect.u.hi))
        is_u = false;
    if (!is_u && !(p->middle.v > p->rect.v.lo && p->middle.v < p->rect.v.hi))
        return false;
    halves[0] = halves[1] = p->rect;
    if (is_u)
        halves[0].u.hi = halves[1].u.lo = p->middle.u;
    else
        halves[0].v.hi = halves[1].v.lo = p->middle.v;
    return true;
}

/* --- the tree ------------------------------------------------------------------------------- */

/* Is a patch so flat that a line across it meets it once, as its derivatives tell? */
static bool is_flat(const Patch *p)
{
    V3 n = v3_cross(p->along_u, p->along_v);
    double size = v3_len2(n);
    if (!p->is_smooth || !(size > 0))
        return false;
    V3 spread = v3_add(p->spread_u, p->spread_v);
    double by_u = v3_dot(v3_abs(v3_cross(p->along_v, n)), spread) / size;
    double by_v = v3_dot(v3_abs(v3_cross(n, p->along_u)), spread) / size;
    return by_u < SPREAD_WANTED && by_v < SPREAD_WANTED;
}

typedef struct Builder {
    const ParametricData *data;
    BoxNode *nodes;
    Patch *patches; /* of all nodes */
    uint8_t *depths;
    uint32_t count;
} Builder;

static void add_node(Builder *b, Rect rect, int depth)
{
    uint32_t at = b->count++;
    parametric_patch(b->data, rect, &b->patches[at]);
    Bound box = b->patches[at].box;
    b->nodes[at] = (BoxNode){bound_is_empty(box) ? BOUND_EMPTY : box, 0, 1};
    b->depths[at] = (uint8_t)depth;
}

/* Is a patch as good as it will be? */
static bool is_done(const Builder *b, uint32_t at)
{
    const Patch *patch = &b->patches[at];
    uint32_t most = patch->is_bounded ? 2 * PATCHES_MAX : NODES_MAX;
    return bound_is_empty(b->nodes[at].box) || b->depths[at] == HALVINGS_MAX ||
           b->count + 2 >= most || is_flat(patch);
}

/* Halve patches in the order they were made: so the larger ones come first.  Small ones that may
 * have no points, or some that are infinitely far away, are left out. */
static void divide(Builder *b)
{
    add_node(b, b->data->domain, 0);
    for (uint32_t at = 0; at < b->count; at++) {
        Rect halves[2];
        if (is_done(b, at) || !parametric_halve(&b->patches[at], halves)) {
            if (!b->patches[at].is_bounded)
                b->nodes[at].box = BOUND_EMPTY;
            continue;
        }
        b->nodes[at].first = b->count;
        b->nodes[at].count = 0;
        add_node(b, halves[0], b->depths[at] + 1);
        add_node(b, halves[1], b->depths[at] + 1);
    }
}

/* A box around two halves may be narrower than what is known of the whole. */
static void narrow(Builder *b)
{
    for (uint32_t at = b->count; at-- > 0;) {
        BoxNode *node = &b->nodes[at];
        if (node->count > 0)
            continue;
        const BoxNode *halves = &b->nodes[node->first];
        node->box = bound_intersect(node->box, bound_union(halves[0].box, halves[1].box));
    }
}

/* Keep what was built: the patches of leaves only. */
static bool keep(const Builder *b, Arena *arena, ParametricData *data)
{
    uint32_t leaves = 0;
    for (uint32_t at = 0; at < b->count; at++)
        leaves += b->nodes[at].count;
    Patch *patches = ARENA_ARRAY(arena, Patch, leaves);
    BoxNode *nodes = arena_copy(arena, b->nodes, b->count * sizeof *nodes);
    if (!patches || !nodes)
        return false;
    leaves = 0;
    for (uint32_t at = 0; at < b->count; at++) {
        if (nodes[at].count == 0)
            continue;
        patches[leaves] = b->patches[at];
        nodes[at].first = leaves++;
    }
    data->nodes = nodes;
    data->patches = patches;
    data->box = nodes[0].box;
    return true;
}

bool parametric_tree(Arena *arena, ParametricData *data)
{
    size_t most = NODES_MAX;
    Builder b = {data, mem_alloc(most * sizeof *b.nodes), mem_alloc(most * sizeof *b.patches),
                 mem_alloc(most), 0};
    bool is_built = b.nodes && b.patches && b.depths;
    if (is_built) {
        divide(&b);
        narrow(&b);
        is_built = keep(&b, arena, data);
    }
    mem_free(b.nodes);
    mem_free(b.patches);
    mem_free(b.depths);
    return is_built;
}
