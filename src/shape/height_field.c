/* Height fields.
 *
 * In the space of the leaf a cell is 1 wide and heights are as the image has them, so that all
 * corners are small whole numbers.  A ray goes through a tree of blocks of cells that knows
 * between which heights each lies, nearest first; the triangles have the watertight test of
 * meshes.
 *
 * As a solid all that lies under the surface is inside, without end, and under the water level
 * as well; what bounds it there is not seen.  SPDX-License-Identifier: Apache-2.0 */
#include "shape/height_field.h"

#include "accel/shear.h"
#include "shape/shape_int.h"

#include <stdlib.h>

enum { LEVEL_FIRST = 2 }; /* smaller blocks are looked up in the heights themselves */

/* Blocks are this much wider and higher than they are, in cells and heights: far above what
 * rounding moves a ray that starts at the field. */
#define BLOCK_PAD 1e-3

Shape *shape_height_field(Arena *arena, const HeightData *data)
{
    Shape *shape = leaf_new(arena, SHAPE_HEIGHT_FIELD);
    if (!shape)
        return NULL;
    shape->u.height_field = data;
    const double one = 1;
    Xform size = xform_scale(
        v3(one / (data->columns - 1), one / (HEIGHT_SCALE * data->unit), one / (data->rows - 1)));
    leaf_place(shape, &size);
    return shape;
}

/* --- the tree ------------------------------------------------------------------------------ */

static int blocks_along(int cells, int level)
{
    return (cells + (1 << level) - 1) >> level;
}

static uint16_t whole_height_at(const HeightData *d, int x, int z)
{
    return d->heights[(size_t)z * (size_t)d->columns + (size_t)x];
}

static double height_at(const HeightData *d, int x, int z)
{
    return d->unit * whole_height_at(d, x, z);
}

static HeightRange range_add(HeightRange a, HeightRange b)
{
    return (HeightRange){a.lo < b.lo ? a.lo : b.lo, a.hi > b.hi ? a.hi : b.hi};
}

/* Return the range of the cells [x0, x1) by [z0, z1). */
static HeightRange range_of(const HeightData *d, int x0, int x1, int z0, int z1)
{
    HeightRange range = {UINT16_MAX, 0};
    for (int z = z0; z <= z1 && z < d->rows; z++) {
        for (int x = x0; x <= x1 && x < d->columns; x++) {
            uint16_t h = whole_height_at(d, x, z);
            range = range_add(range, (HeightRange){h, h});
        }
    }
    return range;
}

static HeightRange block_at(const HeightData *d, int level, int x, int z)
{
    int wide = blocks_along(d->columns - 1, level);
    return d->level[level][(size_t)z * (size_t)wide + (size_t)x];
}

/* Fill a level from the one below it. */
static void fill_level(HeightData *d, int level)
{
    int wide = blocks_along(d->columns - 1, level), deep = blocks_along(d->rows - 1, level);
    HeightRange *to = d->level[level];
    for (int z = 0; z < deep; z++) {
        for (int x = 0; x < wide; x++, to++) {
            int size = 1 << level;
            if (level == LEVEL_FIRST) {
                *to = range_of(d, x * size, x * size + size, z * size, z * size + size);
                continue;
            }
            int below_wide = blocks_along(d->columns - 1, level - 1);
            int below_deep = blocks_along(d->rows - 1, level - 1);
            *to = (HeightRange){UINT16_MAX, 0};
            for (int i = 0; i < 4; i++)
                if (2 * x + i % 2 < below_wide && 2 * z + i / 2 < below_deep)
                    *to = range_add(*to, block_at(d, level - 1, 2 * x + i % 2, 2 * z + i / 2));
        }
    }
}

/* Heights get a unit that makes the field about as high as it is wide: else shearing loses digits.
 * It is a power of two, so that nothing is rounded. */
bool height_prepare(Arena *arena, HeightData *d)
{
    int cells = d->columns > d->rows ? d->columns - 1 : d->rows - 1;
    for (d->unit = 1; d->unit * HEIGHT_SCALE > cells;)
        d->unit *= 0.5;
    for (int level = LEVEL_FIRST;; level++) {
        int wide = blocks_along(d->columns - 1, level), deep = blocks_along(d->rows - 1, level);
        d->level[level] = ARENA_ARRAY(arena, HeightRange, (size_t)wide * (size_t)deep);
        if (!d->level[level])
            return false;
        fill_level(d, level);
        d->top = level;
        if (wide == 1 && deep == 1)
            return true;
    }
}

/* --- triangles ----------------------------------------------------------------------------- */

/* The corners of a triangle: its cell's, without the one furthest from the origin (even) or the
 * nearest (odd). */
static void corners_of(const HeightData *d, uint32_t part, V3 out[3])
{
    uint32_t wide = (uint32_t)d->columns - 1, cell = part / 2;
    int x = (int)(cell % wide), z = (int)(cell / wide);
    int own = (int)(part % 2);
    out[0] = v3(x + own, height_at(d, x + own, z + own), z + own);
    out[1] = v3(x + 1, height_at(d, x + 1, z), z);
    out[2] = v3(x, height_at(d, x, z + 1), z + 1);
}

/* Return the normal of a triangle, up, not unit. */
static V3 normal_of(const V3 corner[3])
{
    V3 n = v3_cross(v3_sub(corner[1], corner[0]), v3_sub(corner[2], corner[0]));
    return n.y < 0 ? v3_neg(n) : n;
}

/* --- rays ---------------------------------------------------------------------------------- */

/* A ray on its way through the tree. */
typedef struct HeightWalk {
    const Shape *shape;
    const HeightData *data;
    Shear shear;
    V3 d, inverse;
    double off; /* bound on how far the local ray is off */
    double tmin, tmax;
    ShapeScratch *scratch; /* all crossings are pushed; NULL: only the first visible one counts */
    Crossing best;
    bool is_found;
} HeightWalk;

/* A stretch of the ray, from where it was moved to. */
typedef struct Stretch {
    double from, to;
} Stretch;

/* Cut a stretch to a <= o + t d <= b. */
static Stretch cut(Stretch s, double o, double inverse, double a, double b)
{
    double first = (a - o) * inverse, last = (b - o) * inverse;
    double near = inverse < 0 ? last : first, far = inverse < 0 ? first : last;
    return (Stretch){near > s.from ? near : s.from, far < s.to ? far : s.to};
}

static void keep(HeightWalk *w, const TriHit *hit, const V3 corner[3])
{
    double y = (1 - hit->u - hit->v) * corner[0].y + hit->u * corner[1].y + hit->v * corner[2].y;
    bool is_dry = y >= w->data->water * w->data->unit;
    if (!w->scratch && (!is_dry || (w->is_found && hit->t >= w->best.t)))
        return;
    /* Even ones have their corners' normal down. */
    bool is_entering = hit->is_along == (hit->triangle % 2 == 0);
    Crossing c = {.t = hit->t,
                  .t_error = hit->t_error + hit->t_slope * w->off,
                  .leaf = w->shape,
                  .part = hit->triangle,
                  .change = is_entering ? 1 : -1,
                  .leaf_change = is_entering ? 1 : -1,
                  .is_visible = is_dry,
                  .u = hit->u,
                  .v = hit->v};
    if (w->scratch) {
        scratch_push(w->scratch, &c);
        return;
    }
    w->best = c;
    w->is_found = true;
    w->tmax = hit->t;
}

static void test_cell(HeightWalk *w, int x, int z)
{
    const HeightData *d = w->data;
    uint32_t part = 2 * ((uint32_t)z * (uint32_t)(d->columns - 1) + (uint32_t)x);
    /* The corners of both triangles: see corners_of. */
    const V3 corner[4] = {v3(x, height_at(d, x, z), z), v3(x + 1, height_at(d, x + 1, z), z),
                          v3(x, height_at(d, x, z + 1), z + 1),
                          v3(x + 1, height_at(d, x + 1, z + 1), z + 1)};
    Sheared at[4];
    for (int i = 0; i < 4; i++)
        at[i] = shear_point(&w->shear, corner[i]);
    for (int i = 0; i < 2; i++) {
        const Sheared side[3] = {at[3 * i], at[1], at[2]};
        TriHit hit;
        if (!sheared_meets(&w->shear, side, w->tmin, w->tmax, &hit))
            continue;
        hit.triangle = part + (uint32_t)i;
        keep(w, &hit, (const V3[3]){corner[3 * i], corner[1], corner[2]});
    }
}

/* Does the stretch of the ray pass between the heights of a block? */
static inline bool is_between(const HeightWalk *w, Stretch s, HeightRange range)
{
    double a = w->shear.o.y + s.from * w->d.y, b = w->shear.o.y + s.to * w->d.y;
    double low = a < b ? a : b, high = a < b ? b : a;
    double unit = w->data->unit;
    return high >= unit * (range.lo - BLOCK_PAD) && low <= unit * (range.hi + BLOCK_PAD);
}

static inline HeightRange cell_range(const HeightData *d, int x, int z)
{
    const uint16_t *h = d->heights + (size_t)z * (size_t)d->columns + (size_t)x;
    uint16_t a = h[0], b = h[1], c = h[d->columns], e = h[d->columns + 1];
    uint16_t low1 = a < b ? a : b, high1 = a < b ? b : a;
    uint16_t low2 = c < e ? c : e, high2 = c < e ? e : c;
    return (HeightRange){low1 < low2 ? low1 : low2, high1 > high2 ? high1 : high2};
}

/* The stretches of a ray before (0) and behind (1) the plane between two halves of a block. */
static inline void halve(Stretch s, double o, double inverse, double plane, Stretch out[2])
{
    double t = (plane - o) * inverse, pad = BLOCK_PAD * (inverse < 0 ? -inverse : inverse);
    out[0] = (Stretch){s.from, t + pad < s.to ? t + pad : s.to};
    out[1] = (Stretch){t - pad > s.from ? t - pad : s.from, s.to};
}

/* Go through a block that the ray passes on a stretch: the nearest of its four parts first. */
static void walk_block(HeightWalk *w, int level, int x, int z, Stretch s)
{
    const HeightData *d = w->data;
    int right = w->d.x < 0, back = w->d.z < 0, below = level - 1;
    Stretch across[2], along[2];
    halve(s, w->shear.o.x, w->inverse.x, (double)((2 * x + 1) << below), across);
    halve(s, w->shear.o.z, w->inverse.z, (double)((2 * z + 1) << below), along);
    for (int i = 0; i < 4; i++) {
        Stretch a = across[i % 2], b = along[i / 2];
        Stretch part = {a.from > b.from ? a.from : b.from, a.to < b.to ? a.to : b.to};
        int px = 2 * x + (i % 2 ^ right), pz = 2 * z + (i / 2 ^ back);
        if (!(part.from <= part.to) || part.from + w->shear.start > w->tmax ||
            px << below >= d->columns - 1 || pz << below >= d->rows - 1)
            continue;
        if (below == 0) {
            if (is_between(w, part, cell_range(d, px, pz)))
                test_cell(w, px, pz);
        } else if (below < LEVEL_FIRST || is_between(w, part, block_at(d, below, px, pz))) {
            walk_block(w, below, px, pz, part);
        }
    }
}

/* Return 1/d, and where d is next to nothing beside the rest a number so large that the ray
 * does not come to any other plane. */
static double inverse_of(double d, double size)
{
    double least = 1e-30 * size;
    return 1 / (d < 0 ? (d < -least ? d : -least) : d > least ? d : least);
}

/* Return the cell a place lies in, moved to the field if it is beside it. */
static inline uint32_t cell_at(double place, int cells)
{
    return place > 0 ? (uint32_t)(place < cells ? place : cells - 1) : 0;
}

/* Send a ray through the smallest block that holds a stretch of it. */
static void walk_stretch(HeightWalk *w, Stretch s)
{
    const HeightData *d = w->data;
    double xa = w->shear.o.x + s.from * w->d.x, xb = w->shear.o.x + s.to * w->d.x;
    double za = w->shear.o.z + s.from * w->d.z, zb = w->shear.o.z + s.to * w->d.z;
    uint32_t x0 = cell_at((xa < xb ? xa : xb) - BLOCK_PAD, d->columns - 1);
    uint32_t x1 = cell_at((xa < xb ? xb : xa) + BLOCK_PAD, d->columns - 1);
    uint32_t z0 = cell_at((za < zb ? za : zb) - BLOCK_PAD, d->rows - 1);
    uint32_t z1 = cell_at((za < zb ? zb : za) + BLOCK_PAD, d->rows - 1);
    int level = 0;
    for (uint32_t differ = (x0 ^ x1) | (z0 ^ z1); differ; differ >>= 1)
        level++;
    if (level)
        walk_block(w, level, (int)(x0 >> level), (int)(z0 >> level), s);
    else
        test_cell(w, (int)x0, (int)z0);
}

/* Move a ray to the box around the field and send it through; false when it misses the box.
 * What the arithmetic does depends on the line alone, not on the part that is asked for. */
static bool walk(HeightWalk *w, const Shape *shape, const LocalRay *local)
{
    const HeightData *d = w->data = shape->u.height_field;
    HeightRange all = block_at(d, d->top, 0, 0);
    w->shape = shape;
    w->d = local->d;
    double size = v3_max_abs(w->d);
    w->inverse = v3(inverse_of(w->d.x, size), inverse_of(w->d.y, size), inverse_of(w->d.z, size));
    Stretch s = {-INFINITY, INFINITY};
    s = cut(s, local->o.x, w->inverse.x, -1, d->columns);
    s = cut(s, local->o.z, w->inverse.z, -1, d->rows);
    s = cut(s, local->o.y, w->inverse.y, d->unit * (all.lo - 1), d->unit * (all.hi + 1));
    if (!(s.from <= s.to))
        return false;
    Ray ray = {local->o, local->d, 0, INFINITY};
    shear_init(&w->shear, &ray, s.from > 0 ? s.from : 0);
    w->off =
        v3_sum_abs(local->o_error) + fmax(fabs(s.from), fabs(s.to)) * v3_sum_abs(local->d_error);
    s = (Stretch){fmax(s.from, w->tmin) - w->shear.start, fmin(s.to, w->tmax) - w->shear.start};
    if (s.from <= s.to)
        walk_stretch(w, s);
    return true;
}

static bool height_closest(const Shape *shape, const Ray *ray, ShapeScratch *scratch, Crossing *out)
{
    (void)scratch;
    LocalRay local;
    local_ray(shape, ray, &local);
    HeightWalk w = {.tmin = ray->tmin, .tmax = ray->tmax};
    walk(&w, shape, &local);
    if (w.is_found)
        *out = w.best;
    return w.is_found;
}

/* Return the height of the surface at a place, which is moved to the field if it is beside it. */
static double surface_height(const HeightData *d, double px, double pz)
{
    int x = (int)fmin(fmax(px, 0), d->columns - 2), z = (int)fmin(fmax(pz, 0), d->rows - 2);
    double fx = px - x, fz = pz - z;
    double b = height_at(d, x + 1, z), c = height_at(d, x, z + 1);
    if (fx + fz <= 1) {
        double a = height_at(d, x, z);
        return a + fx * (b - a) + fz * (c - a);
    }
    double a = height_at(d, x + 1, z + 1);
    return a + (1 - fx) * (c - a) + (1 - fz) * (b - a);
}

/* --- as a solid ---------------------------------------------------------------------------- */

static int compare_crossings(const void *a, const void *b)
{
    const Crossing *p = a, *q = b;
    return p->t != q->t ? (p->t < q->t ? -1 : 1) : (p->part > q->part) - (p->part < q->part);
}

/* What changes along a line besides the surface: where it enters the field's four walls, where it
 * leaves them, and where it goes through the water. */
typedef enum HeightEvent { EVENT_ENTRY, EVENT_EXIT, EVENT_WATER, EVENT_COUNT } HeightEvent;

typedef struct Unseen {
    double t, error;
} Unseen;

typedef struct HeightState {
    bool is_within, is_under, is_wet; /* the walls, the surface, the water */
} HeightState;

/* An event where the line comes to a place on an axis. */
static Unseen unseen_at(const LocalRay *local, int axis, double t)
{
    double off = v3_at(local_error(local, t), axis) + PLACE_EPS * fabs(v3_at(local->d, axis) * t);
    return (Unseen){t, off / fabs(v3_at(local->d, axis)) + 4 * EPS_DOUBLE * fabs(t)};
}

static bool is_solid_at(HeightState s)
{
    return s.is_within && (s.is_under || s.is_wet);
}

/* Push a crossing that changes the state, if the solid begins or ends there. */
static void push_change(const HeightWalk *w, HeightState *state, HeightState next, Crossing c)
{
    bool before = is_solid_at(*state), after = is_solid_at(next);
    *state = next;
    if (before == after)
        return;
    c.leaf = w->shape;
    c.change = c.leaf_change = after ? 1 : -1;
    scratch_push(w->scratch, &c);
}

static bool may_be_swapped(const Crossing *a, const Crossing *b)
{
    return b->t - b->t_error <= a->t + a->t_error;
}

static bool is_under_at(const HeightWalk *w, const LocalRay *local, double t)
{
    V3 p = v3_mad(local->o, t, local->d);
    return p.y < surface_height(w->data, p.x, p.z);
}

/* May a crossing of the surface be where the line goes through a wall? */
static bool is_at_border(const Stretch *walls, const Crossing *c)
{
    double off = 2 * c->t_error;
    return fabs(c->t - walls->from) <= off || fabs(c->t - walls->to) <= off;
}

/* Is a line that is not upright under the surface where it enters the walls?  What it crosses
 * tells; if that is rounding, the point in the middle of the longest stretch without crossings
 * does. */
static bool starts_under(const HeightWalk *w, const LocalRay *local, const Stretch *walls,
                         const Crossing *items, int count)
{
    int sum = 0;
    for (int i = 0; i < count; i++)
        sum += items[i].change;
    if (sum && !(count == 1 && is_at_border(walls, items)))
        return sum < 0;
    if (count > 1 && (items[0].change == items[1].change || !may_be_swapped(&items[0], &items[1])))
        return items[0].change < 0;
    double first = count ? items[0].t : walls->to, last = count ? items[count - 1].t : first;
    bool is_before = first - walls->from >= walls->to - last;
    return is_under_at(w, local, .5 * (is_before ? walls->from + first : last + walls->to));
}

/* Bring a crossing that goes a way to the front, if there is one that the first cannot be told
 * from; the one whose place is less certain moves. */
static bool bring(Crossing *items, int count, int way)
{
    int k = 0;
    while (k < count && items[k].change != way)
        k++;
    if (k == count || !may_be_swapped(&items[0], &items[k]))
        return false;
    Crossing found = items[k];
    if (found.t_error > items[0].t_error)
        found.t = items[0].t;
    for (; k > 0; k--) {
        items[k] = items[k - 1];
        items[k].t = fmax(items[k].t, found.t);
    }
    items[0] = found;
    return true;
}

/* Let the crossings of the surface go down and up in turn; returns how many are left.  At corners
 * their order is rounding, and on the border of the field one may be missing: of two in one place
 * what comes next tells which there is. */
static int settle(Crossing *items, int count, bool is_under)
{
    int written = 0;
    for (int i = 0; i < count; i++) {
        if (!bring(items + i, count - i, is_under ? -1 : 1)) {
            if (written < 2 || !may_be_swapped(&items[written - 2], &items[written - 1]))
                continue;
            written--;
            is_under = !is_under;
        }
        items[written++] = items[i];
        is_under = !is_under;
    }
    return written;
}

/* Merge the crossings of the surface, from `first` on, with the unseen ones. */
static void merge_events(const HeightWalk *w, int first, const Unseen unseen[EVENT_COUNT],
                         HeightState *state)
{
    ShapeScratch *scratch = w->scratch;
    int surface = scratch->count - first, next = 0;
    bool is_done[EVENT_COUNT] = {false};
    for (;;) {
        int event = -1;
        for (int i = 0; i < EVENT_COUNT; i++)
            if (!is_done[i] && isfinite(unseen[i].t) &&
                (event < 0 || unseen[i].t < unseen[event].t))
                event = i;
        HeightState after = *state;
        /* The merged crossings go behind the surface's own, which are read meanwhile. */
        if (next < surface && (event < 0 || scratch->items[first + next].t <= unseen[event].t)) {
            Crossing c = scratch->items[first + next++];
            after.is_under = !state->is_under;
            push_change(w, state, after, c);
            continue;
        }
        if (event < 0)
            break;
        is_done[event] = true;
        after.is_within = event == EVENT_WATER ? state->is_within : event == EVENT_ENTRY;
        after.is_wet = event == EVENT_WATER ? !state->is_wet : state->is_wet;
        push_change(w, state, after,
                    (Crossing){.t = unseen[event].t, .t_error = unseen[event].error});
    }
    int merged = scratch->count - first - surface;
    for (int i = 0; i < merged; i++)
        scratch->items[first + i] = scratch->items[first + surface + i];
    scratch->count = first + merged;
}

static bool height_list(const Shape *shape, const Line *line, ShapeScratch *scratch)
{
    LocalRay local;
    local_ray(shape, line->ray, &local);
    const HeightData *d = shape->u.height_field;
    HeightWalk w = {.tmin = -INFINITY, .tmax = INFINITY, .scratch = scratch};
    int first = scratch->count;
    walk(&w, shape, &local);
    w.shape = shape, w.data = d, w.d = local.d;
    if (scratch->count > first + 1)
        qsort(scratch->items + first, (size_t)(scratch->count - first), sizeof(Crossing),
              compare_crossings);
    Stretch x = {-INFINITY, INFINITY}, z = x;
    if (w.d.x != 0)
        x = cut(x, local.o.x, 1 / w.d.x, 0, d->columns - 1);
    if (w.d.z != 0)
        z = cut(z, local.o.z, 1 / w.d.z, 0, d->rows - 1);
    Stretch walls = {fmax(x.from, z.from), fmin(x.to, z.to)};
    bool is_beside = (w.d.x == 0 && !(local.o.x >= 0 && local.o.x <= d->columns - 1)) ||
                     (w.d.z == 0 && !(local.o.z >= 0 && local.o.z <= d->rows - 1));
    if (is_beside || !(walls.from <= walls.to)) {
        scratch->count = first;
        return false;
    }
    double water = w.d.y != 0 ? (d->water * d->unit - local.o.y) / w.d.y : INFINITY;
    const Unseen unseen[EVENT_COUNT] = {
        [EVENT_ENTRY] = unseen_at(&local, x.from > z.from ? 0 : 2, walls.from),
        [EVENT_EXIT] = unseen_at(&local, x.to < z.to ? 0 : 2, walls.to),
        [EVENT_WATER] = unseen_at(&local, 1, water)};
    HeightState state = {.is_within = !isfinite(walls.from),
                         .is_wet = w.d.y > 0 || (w.d.y == 0 && local.o.y < d->water * d->unit)};
    Crossing *items = scratch->items + first;
    int count = scratch->count - first;
    state.is_under = state.is_within ? w.d.y > 0 : starts_under(&w, &local, &walls, items, count);
    scratch->count = first + settle(items, count, state.is_under);
    bool is_inside = is_solid_at(state);
    merge_events(&w, first, unseen, &state);
    return is_inside;
}

static bool height_is_inside(const Shape *shape, V3 p)
{
    const HeightData *d = shape->u.height_field;
    if (!(p.x >= 0 && p.z >= 0 && p.x < d->columns - 1 && p.z < d->rows - 1))
        return false;
    if (p.y < d->water * d->unit)
        return true;
    if (p.y >= d->unit * block_at(d, d->top, 0, 0).hi)
        return false;
    return p.y < surface_height(d, p.x, p.z);
}

/* --- looks --------------------------------------------------------------------------------- */

/* Return the mean of the normals of the triangles between a point and its neighbours, taken where
 * heights are whole numbers. */
static V3 smooth_normal(const HeightData *d, int x, int z)
{
    static const int side[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
    V3 sum = v3(0, 0, 0);
    double h = whole_height_at(d, x, z);
    for (int i = 0; i < 4; i++) {
        int nx = x + side[i][0], nz = z + side[i][1];
        if (nx < 0 || nz < 0 || nx >= d->columns || nz >= d->rows)
            continue;
        double across = (whole_height_at(d, nx, z) - h) * side[i][0];
        double along = (whole_height_at(d, x, nz) - h) * side[i][1];
        sum = v3_add(sum, v3_unit(v3(-across, 1, -along)));
    }
    return v3_unit(v3(sum.x, sum.y / d->unit, sum.z));
}

/* Blend the normals of a cell's corners as they are in the scene. */
static V3 blended_normal(const Shape *shape, V3 p)
{
    const HeightData *d = shape->u.height_field;
    int x = (int)fmin(fmax(p.x, 0), d->columns - 2), z = (int)fmin(fmax(p.z, 0), d->rows - 2);
    double fx = p.x - x, fz = p.z - z;
    V3 sum = v3(0, 0, 0);
    for (int i = 0; i < 4; i++) {
        V3 n = v3_unit(xform_normal(&shape->xform, smooth_normal(d, x + i % 2, z + i / 2)));
        sum = v3_mad(sum, (i % 2 ? fx : 1 - fx) * (i / 2 ? fz : 1 - fz), n);
    }
    /* Back to the leaf's space: normals turn by the transpose of `from`, so back by that of `to`.
     */
    const double(*m)[4] = shape->xform.to;
    return v3(m[0][0] * sum.x + m[1][0] * sum.y + m[2][0] * sum.z,
              m[0][1] * sum.x + m[1][1] * sum.y + m[2][1] * sum.z,
              m[0][2] * sum.x + m[1][2] * sum.y + m[2][2] * sum.z);
}

static void height_point(const Shape *shape, const Crossing *crossing, V3 p, LocalPoint *out)
{
    V3 corner[3];
    corners_of(shape->u.height_field, crossing->part, corner);
    double u = crossing->u, v = crossing->v;
    (void)p;
    V3 ab = v3_sub(corner[1], corner[0]), ac = v3_sub(corner[2], corner[0]);
    out->p = v3_mad(v3_mad(corner[0], u, ab), v, ac);
    out->ng = v3_unit(normal_of(corner));
    out->error = 2 * shape->rounding.place;
    if (!shape->u.height_field->is_smooth)
        return;
    V3 n = v3_unit(blended_normal(shape, out->p));
    out->is_smooth = v3_len2(n) > 0;
    out->ns = v3_dot(n, out->ng) < 0 ? v3_neg(n) : n;
}

static Bound local_bound(const HeightData *d)
{
    HeightRange all = block_at(d, d->top, 0, 0);
    double low = fmax(all.lo, d->water);
    if (low > all.hi)
        return BOUND_EMPTY;
    return (Bound){v3(0, d->unit * low, 0), v3(d->columns - 1, d->unit * all.hi, d->rows - 1)};
}

static Bound height_bound(const Shape *shape)
{
    Bound b = local_bound(shape->u.height_field);
    return bound_is_empty(b) ? b : bound_pad(bound_transform(b, &shape->xform));
}

static double height_size(const Shape *shape)
{
    const HeightData *d = shape->u.height_field;
    return fmax(fmax(d->columns, d->rows), d->unit * block_at(d, d->top, 0, 0).hi);
}

const ShapeOps height_field_ops = {.list = height_list,
                                   .closest = height_closest,
                                   .point = height_point,
                                   .is_inside = height_is_inside,
                                   .bound = height_bound,
                                   .size = height_size};
