/* Trees of small meshes: binary, split where the surface area heuristic finds it cheapest.
 * SPDX-License-Identifier: Apache-2.0 */
#include "accel/tri_tree_int.h"

#include "base/mem.h"

#include <string.h>

enum {
    LEAF_ITEMS = 4,  /* as many or fewer are not split */
    BINS = 16,       /* places to split at that are tried */
    EVEN_DEPTH = 32, /* deeper nodes are split evenly, so that no tree is deeper than the stack */
    STACK_MAX = 64
};

/* Rounding of the slab test: a few operations in float. */
#define SLAB_SLACK (8 * (float)EPS_FLOAT)

typedef struct Box {
    float lo[3], hi[3];
} Box;

typedef struct Build {
    TriTree *tree;
    Box *boxes; /* by triangle */
} Build;

static const Box no_box = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

static void box_add(Box *box, const Box *other)
{
    for (int i = 0; i < 3; i++) {
        box->lo[i] = fminf(box->lo[i], other->lo[i]);
        box->hi[i] = fmaxf(box->hi[i], other->hi[i]);
    }
}

static float half_area(const Box *b)
{
    float x = b->hi[0] - b->lo[0], y = b->hi[1] - b->lo[1], z = b->hi[2] - b->lo[2];
    return x >= 0 ? x * y + y * z + z * x : 0;
}

/* Twice the middle of a box. */
static float middle(const Box *b, int axis)
{
    return b->lo[axis] + b->hi[axis];
}

/* A way to sort items into bins along an axis. */
typedef struct Bins {
    int axis;
    float start, scale;
    Box box[BINS];
    uint32_t count[BINS];
} Bins;

static int bin_of(const Bins *bins, const Box *box)
{
    int bin = (int)((middle(box, bins->axis) - bins->start) * bins->scale);
    return bin < 0 ? 0 : bin >= BINS ? BINS - 1 : bin;
}

/* Fill the bins along the axis on which the middles are spread most; false if they are not. */
static bool fill_bins(const Build *b, uint32_t begin, uint32_t end, Bins *out)
{
    Box middles = no_box;
    for (uint32_t i = begin; i < end; i++) {
        const Box *box = &b->boxes[b->tree->items[i]];
        Box at = {{middle(box, 0), middle(box, 1), middle(box, 2)},
                  {middle(box, 0), middle(box, 1), middle(box, 2)}};
        box_add(&middles, &at);
    }
    out->axis = 0;
    for (int i = 1; i < 3; i++)
        if (middles.hi[i] - middles.lo[i] > middles.hi[out->axis] - middles.lo[out->axis])
            out->axis = i;
    out->start = middles.lo[out->axis];
    float spread = middles.hi[out->axis] - out->start;
    if (!(spread > 0))
        return false;
    out->scale = BINS * (1 - 4 * (float)EPS_FLOAT) / spread;
    for (int i = 0; i < BINS; i++)
        out->box[i] = no_box, out->count[i] = 0;
    for (uint32_t i = begin; i < end; i++) {
        const Box *box = &b->boxes[b->tree->items[i]];
        int bin = bin_of(out, box);
        box_add(&out->box[bin], box);
        out->count[bin]++;
    }
    return true;
}

/* Return the bin the upper part begins with at the cheapest split. */
static int best_split(const Bins *bins)
{
    float above[BINS], best = INFINITY;
    Box sum = no_box;
    uint32_t count = 0;
    int split = BINS / 2;
    for (int i = BINS - 1; i > 0; i--) {
        box_add(&sum, &bins->box[i]);
        count += bins->count[i];
        above[i] = half_area(&sum) * (float)count;
    }
    sum = no_box;
    count = 0;
    for (int i = 1; i < BINS; i++) {
        box_add(&sum, &bins->box[i - 1]);
        count += bins->count[i - 1];
        float cost = half_area(&sum) * (float)count + above[i];
        if (cost < best) {
            best = cost;
            split = i;
        }
    }
    return split;
}

/* Sort the items of a node into two parts; returns where the second begins. */
static uint32_t split_items(const Build *b, uint32_t begin, uint32_t end, int depth)
{
    Bins bins;
    uint32_t *items = b->tree->items, at = begin, last = end;
    if (depth > EVEN_DEPTH || !fill_bins(b, begin, end, &bins))
        return begin + (end - begin) / 2;
    int split = best_split(&bins);
    while (at < last) {
        if (bin_of(&bins, &b->boxes[items[at]]) < split) {
            at++;
            continue;
        }
        uint32_t moved = items[--last];
        items[last] = items[at];
        items[at] = moved;
    }
    return at == begin || at == end ? begin + (end - begin) / 2 : at;
}

static void build(Build *b, uint32_t node, uint32_t begin, uint32_t end, int depth)
{
    TriNode *n = &b->tree->nodes[node];
    Box all = no_box;
    for (uint32_t i = begin; i < end; i++)
        box_add(&all, &b->boxes[b->tree->items[i]]);
    memcpy(n->lo, all.lo, sizeof n->lo);
    memcpy(n->hi, all.hi, sizeof n->hi);
    n->first = begin;
    n->count = end - begin;
    if (n->count <= LEAF_ITEMS)
        return;
    uint32_t between = split_items(b, begin, end, depth);
    n->count = 0;
    n->first = b->tree->node_count;
    b->tree->node_count += 2;
    build(b, n->first, begin, between, depth + 1);
    build(b, n->first + 1, between, end, depth + 1);
}

Status tri_tree_init(Diag *diag, const struct RTCBounds *boxes, uint32_t count, TriTree *out)
{
    *out = (TriTree){.nodes = mem_array(2 * (size_t)count, sizeof *out->nodes),
                     .items = mem_array(count, sizeof *out->items),
                     .node_count = 1};
    Build b = {out, mem_array(count, sizeof *b.boxes)};
    bool is_memory = out->nodes && out->items && b.boxes;
    for (uint32_t i = 0; is_memory && i < count; i++) {
        const struct RTCBounds *box = &boxes[i];
        b.boxes[i] = (Box){{box->lower_x, box->lower_y, box->lower_z},
                           {box->upper_x, box->upper_y, box->upper_z}};
        out->items[i] = i;
    }
    if (is_memory)
        build(&b, 0, 0, count, 0);
    mem_free(b.boxes);
    void *fitted = is_memory ? mem_resize(out->nodes, out->node_count * sizeof *out->nodes) : NULL;
    if (fitted)
        out->nodes = fitted;
    if (is_memory)
        return OK;
    tri_tree_done(out);
    return diag_no_memory(diag, "the index of a mesh");
}

void tri_tree_done(TriTree *tree)
{
    mem_free(tree->nodes);
    mem_free(tree->items);
    *tree = (TriTree){0};
}

typedef struct Walk {
    float o[3], inverse[3];
    float far;
} Walk;

/* Return where the ray enters a node, or infinity.  A ray along a side has no number for it, and
 * is not cut there. */
static inline float node_entry(const Walk *w, const TriNode *n)
{
    float near = 0, far = w->far;
    for (int i = 0; i < 3; i++) {
        float a = (n->lo[i] - w->o[i]) * w->inverse[i], b = (n->hi[i] - w->o[i]) * w->inverse[i];
        float first = w->inverse[i] < 0 ? b : a, last = w->inverse[i] < 0 ? a : b;
        near = first > near ? first : near;
        far = last < far ? last : far;
    }
    return near * (1 - SLAB_SLACK) <= far * (1 + SLAB_SLACK) ? near : INFINITY;
}

void tri_tree_walk(const TriTree *tree, const struct RTCRay *ray,
                   float (*offer)(void *query, uint32_t triangle, float far), void *query)
{
    Walk w = {{ray->org_x, ray->org_y, ray->org_z},
              {1 / ray->dir_x, 1 / ray->dir_y, 1 / ray->dir_z},
              ray->tfar};
    struct {
        uint32_t node;
        float entry;
    } stack[STACK_MAX];
    int top = 0;
    uint32_t at = 0;
    if (!(node_entry(&w, &tree->nodes[0]) < INFINITY))
        return;
    for (;;) {
        const TriNode *n = &tree->nodes[at];
        for (uint32_t i = 0; i < n->count; i++)
            w.far = offer(query, tree->items[n->first + i], w.far);
        if (n->count == 0) {
            float a = node_entry(&w, n + (n->first - at)),
                  b = node_entry(&w, n + (n->first - at) + 1);
            uint32_t swap = b < a, near = n->first + swap, far = n->first + 1 - swap;
            if (a < INFINITY && b < INFINITY) {
                stack[top].node = far;
                stack[top++].entry = a < b ? b : a;
            }
            if (a < INFINITY || b < INFINITY) {
                at = near;
                continue;
            }
        }
        do {
            if (top == 0)
                return;
            top--;
        } while (stack[top].entry * (1 - SLAB_SLACK) > w.far);
        at = stack[top].node;
    }
}
