/* The cells of an isosurface: where it may be, found once.
 *
 * The container's box is halved, the largest boxes first, until interval arithmetic says that the
 * function is not zero in a box, that it hardly bends there, or there are as many cells as may be.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/iso_int.h"

#include "base/mem.h"

enum {
    CELLS_MAX = 1 << 13,
    NODES_MAX = 8 * CELLS_MAX,
    DEPTH_COARSE = 6, /* halvings before derivatives are looked at */
    DEPTH_JUMPY = 12, /* halvings where the function may jump */
    DEPTH_MOST = 30
};

/* Derivatives of a good cell change by less than this, next to themselves. */
#define SPREAD_WANTED 0.12

/* What a line's points may be outside of a cell by rounding, next to the container. */
#define CELL_SLACK 0x1p-40

typedef struct Builder {
    const Func *func;
    double threshold;
    V3 slack;
    IsoNode *nodes;
    Bound *boxes;
    uint8_t *depths;
    IsoCell *cells;
    uint32_t count, cell_count;
    FuncRanges *work;
} Builder;

static double reach_of(Range r, double from)
{
    return (1 + 4 * EPS_DOUBLE) * fmax(r.hi - from, from - r.lo);
}

/* Bound the function less its threshold in a box. */
static Range value_in(Builder *b, const Bound *box)
{
    V3 lo = v3_sub(box->lo, b->slack), hi = v3_add(box->hi, b->slack);
    const Range at[3] = {{lo.x, hi.x}, {lo.y, hi.y}, {lo.z, hi.z}};
    Range r = func_range(b->func, at, b->work);
    double rounding = 2 * EPS_DOUBLE * fabs(b->threshold);
    return (Range){(r.lo - b->threshold) * (1 - copysign(2 * EPS_DOUBLE, r.lo)) - rounding,
                   (r.hi - b->threshold) * (1 + copysign(2 * EPS_DOUBLE, r.hi)) + rounding};
}

/* Bound the derivatives in the box just asked about. */
static void slopes_in(Builder *b, IsoCell *cell)
{
    double middle[3], spread[3];
    for (int i = 0; i < 3; i++) {
        Range axes[3] = {{0, 0}, {0, 0}, {0, 0}};
        axes[i] = (Range){1, 1};
        Range r = func_slope(b->func, axes, b->work);
        middle[i] = 0.5 * r.lo + 0.5 * r.hi;
        spread[i] = reach_of(r, middle[i]);
    }
    cell->slope = v3(middle[0], middle[1], middle[2]);
    cell->spread = v3(spread[0], spread[1], spread[2]);
}

static void make_cell(Builder *b, const Bound *box, IsoCell *cell)
{
    slopes_in(b, cell);
    V3 center = cell->center = bound_center(*box);
    const Range at[3] = {{center.x, center.x}, {center.y, center.y}, {center.z, center.z}};
    Range here = func_range(b->func, at, b->work);
    cell->value = 0.5 * here.lo + 0.5 * here.hi - b->threshold;
    cell->doubt = 2 * (here.hi - here.lo) + 4 * EPS_DOUBLE * fabs(b->threshold);
    V3 reach = v3_add(v3_sub(box->hi, center), b->slack);
    double sizes = v3_dot(v3_add(v3_abs(cell->slope), cell->spread), reach);
    cell->off = v3_dot(cell->spread, reach) + 2 * cell->doubt + 64 * EPS_DOUBLE * sizes;
    cell->is_smooth = isfinite(cell->value) && isfinite(cell->off) && v3_is_finite(cell->slope);
}

static bool is_good(const IsoCell *cell)
{
    return cell->is_smooth &&
           v3_len2(cell->spread) < SPREAD_WANTED * SPREAD_WANTED * v3_len2(cell->slope);
}

/* Look at a box: is there nothing in it, or is it as good as it will be? */
static void look(Builder *b, uint32_t at)
{
    IsoNode *node = &b->nodes[at];
    Range value = value_in(b, &b->boxes[at]);
    bool is_out = b->work->has_no_value || value.lo > 0;
    node->kind = is_out ? ISO_OUT : value.hi <= 0 ? ISO_IN : ISO_HALVED;
    if (node->kind != ISO_HALVED || b->depths[at] < DEPTH_COARSE)
        return;
    IsoCell cell;
    make_cell(b, &b->boxes[at], &cell);
    bool is_off = cell.is_smooth &&
                  fabs(cell.value) >
                      cell.off + v3_dot(v3_abs(cell.slope), v3_sub(b->boxes[at].hi, cell.center));
    if (is_off) {
        node->kind = cell.value > 0 ? ISO_OUT : ISO_IN;
    } else if (is_good(&cell) || (!cell.is_smooth && b->depths[at] >= DEPTH_JUMPY)) {
        node->kind = ISO_CELL;
        node->first = b->cell_count;
        b->cells[b->cell_count++] = cell;
    }
}

static void halve(Builder *b, uint32_t at)
{
    IsoNode *node = &b->nodes[at];
    Bound box = b->boxes[at], low = box, high = box;
    V3 size = v3_sub(box.hi, box.lo), middle = bound_center(box);
    node->axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    node->at = v3_at(middle, node->axis);
    if (node->axis == 0)
        low.hi.x = high.lo.x = node->at;
    else if (node->axis == 1)
        low.hi.y = high.lo.y = node->at;
    else
        low.hi.z = high.lo.z = node->at;
    node->first = b->count;
    for (int i = 0; i < 2; i++) {
        b->boxes[b->count] = i ? high : low;
        b->depths[b->count] = (uint8_t)(b->depths[at] + 1);
        look(b, b->count++);
    }
}

/* Halve boxes in the order they were made; those left at the end are cells. */
static void divide(Builder *b)
{
    look(b, 0);
    b->count = 1;
    uint32_t open = 1;
    for (uint32_t at = 0; at < b->count; at++) {
        if (b->nodes[at].kind != ISO_HALVED)
            continue;
        open--;
        bool is_end = b->depths[at] == DEPTH_MOST || b->count + 2 > NODES_MAX ||
                      b->cell_count + open + 2 >= CELLS_MAX;
        if (is_end) {
            value_in(b, &b->boxes[at]);
            make_cell(b, &b->boxes[at], &b->cells[b->cell_count]);
            b->nodes[at].kind = ISO_CELL;
            b->nodes[at].first = b->cell_count++;
            continue;
        }
        halve(b, at);
        open += (uint32_t)(b->nodes[b->count - 1].kind == ISO_HALVED) +
                (uint32_t)(b->nodes[b->count - 2].kind == ISO_HALVED);
    }
}

static const IsoTree *keep(const Builder *b, Arena *arena)
{
    IsoTree *tree = ARENA_NEW(arena, IsoTree);
    if (!tree)
        return NULL;
    tree->cell_count = b->cell_count;
    tree->nodes = arena_copy(arena, b->nodes, b->count * sizeof *b->nodes);
    tree->cells = b->cell_count ? arena_copy(arena, b->cells, b->cell_count * sizeof *b->cells)
                                : b->cells; /* never looked at */
    return tree->nodes && tree->cells ? tree : NULL;
}

const IsoTree *iso_tree_new(Arena *arena, const Func *func, double threshold, const Bound *box)
{
    FuncRanges work;
    V3 size = v3_sub(box->hi, box->lo);
    V3 far = v3_max(v3_abs(box->lo), v3_abs(box->hi));
    Builder b = {.func = func,
                 .threshold = threshold,
                 .slack = v3_add(v3_scale(size, CELL_SLACK), v3_scale(far, 16 * EPS_DOUBLE)),
                 .nodes = mem_alloc(NODES_MAX * sizeof *b.nodes),
                 .boxes = mem_alloc(NODES_MAX * sizeof *b.boxes),
                 .depths = mem_alloc(NODES_MAX),
                 .cells = mem_alloc(CELLS_MAX * sizeof *b.cells),
                 .work = &work};
    const IsoTree *tree = NULL;
    if (b.nodes && b.boxes && b.depths && b.cells) {
        b.boxes[0] = *box;
        b.depths[0] = 0;
        divide(&b);
        tree = keep(&b, arena);
    }
    mem_free(b.nodes);
    mem_free(b.boxes);
    mem_free(b.depths);
    mem_free(b.cells);
    return tree;
}

double iso_tree_steepest(const IsoTree *tree, const Func *func)
{
    double most = 0;
    for (uint32_t i = 0; i < tree->cell_count; i++) {
        V3 p = tree->cells[i].center, gradient;
        func_gradient(func, (double[]){p.x, p.y, p.z}, &gradient);
        if (v3_is_finite(gradient))
            most = fmax(most, v3_len(gradient));
    }
    return most;
}
