/* Trees of small meshes: four children a node, split where the surface area heuristic finds it
 * cheapest. SPDX-License-Identifier: Apache-2.0 */
#include "accel/tri_tree_int.h"

#include "base/mem.h"

#include <string.h>

enum {
    LEAF_ITEMS = 4,    /* as many or fewer are not split */
    BINS = 16,         /* places to split at that are tried */
    EVEN_DEPTH = 32,   /* deeper nodes are split evenly, so that no tree is deeper than the stack */
    STACK_MAX = 3 * 64 /* three left over on each level */
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

/* Part of the items, which becomes a child. */
typedef struct Part {
    uint32_t begin, end;
} Part;

/* Split a part in up to four; returns how many. */
static int split_part(const Build *b, Part all, int depth, Part out[TRI_NODE_WIDTH])
{
    int count = 1;
    out[0] = all;
    while (count < TRI_NODE_WIDTH) {
        int largest = 0;
        for (int i = 1; i < count; i++)
            if (out[i].end - out[i].begin > out[largest].end - out[largest].begin)
                largest = i;
        Part *part = &out[largest];
        if (part->end - part->begin <= LEAF_ITEMS)
            break;
        uint32_t between = split_items(b, part->begin, part->end, depth);
        out[count++] = (Part){between, part->end};
        part->end = between;
    }
    return count;
}

static void build(Build *b, uint32_t node, Part all, int depth)
{
    Part parts[TRI_NODE_WIDTH];
    int count = split_part(b, all, depth, parts);
    TriNode *n = &b->tree->nodes[node];
    for (int i = 0; i < TRI_NODE_WIDTH; i++) {
        Box box = no_box;
        for (uint32_t k = i < count ? parts[i].begin : 0; i < count && k < parts[i].end; k++)
            box_add(&box, &b->boxes[b->tree->items[k]]);
        for (int axis = 0; axis < 3; axis++) {
            n->side[0][axis][i] = box.lo[axis];
            n->side[1][axis][i] = box.hi[axis];
        }
        if (i >= count)
            continue;
        n->first[i] = parts[i].begin;
        n->count[i] = parts[i].end - parts[i].begin;
        if (n->count[i] > LEAF_ITEMS) {
            n->count[i] = 0;
            n->first[i] = b->tree->node_count++;
            build(b, n->first[i], parts[i], depth + 1);
        }
    }
}

Status tri_tree_init(Diag *diag, const struct RTCBounds *boxes, uint32_t count, TriTree *out)
{
    *out = (TriTree){.nodes = mem_array(count, sizeof *out->nodes),
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
        build(&b, 0, (Part){0, count}, 0);
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

typedef float Four __attribute__((vector_size(4 * TRI_NODE_WIDTH)));
typedef int32_t FourMask __attribute__((vector_size(4 * TRI_NODE_WIDTH)));
#define FOUR_PICK(mask, a, b) ((Four)(((mask) & (FourMask)(a)) | (~(mask) & (FourMask)(b))))

static inline Four four_of(float x)
{
    return (Four){x, x, x, x};
}

static inline Four four_at(const float x[TRI_NODE_WIDTH])
{
    return (Four){x[0], x[1], x[2], x[3]};
}

typedef struct Walk {
    float o[3], inverse[3], far;
    bool is_back[3]; /* the ray goes down along an axis */
} Walk;

/* Find where the ray enters the children of a node; returns which ones it may meet.  A ray along a
 * side has no number for it, and is not cut there. */
static inline FourMask node_entries(const Walk *w, const TriNode *n, Four *entry)
{
    Four near = four_of(0), far = four_of(w->far);
    for (int i = 0; i < 3; i++) {
        Four o = four_of(w->o[i]), inverse = four_of(w->inverse[i]);
        Four first = (four_at(n->side[w->is_back[i]][i]) - o) * inverse;
        Four last = (four_at(n->side[!w->is_back[i]][i]) - o) * inverse;
        near = FOUR_PICK(first > near, first, near);
        far = FOUR_PICK(last < far, last, far);
    }
    *entry = near * four_of(1 - SLAB_SLACK);
    return *entry <= far * four_of(1 + SLAB_SLACK);
}

/* A child that is still to be looked at. */
typedef struct Waiting {
    uint32_t first, count;
    float entry;
} Waiting;

/* Put the children that the ray may meet on a stack, the nearest on top; returns the new top. */
static inline int push_children(const Walk *w, const TriNode *n, Waiting *stack, int top)
{
    Four entry;
    FourMask is_met = node_entries(w, n, &entry);
    int bottom = top;
    for (int i = 0; i < TRI_NODE_WIDTH; i++) {
        if (!is_met[i])
            continue;
        int at = top++;
        for (; at > bottom && stack[at - 1].entry < entry[i]; at--)
            stack[at] = stack[at - 1];
        stack[at] = (Waiting){n->first[i], n->count[i], entry[i]};
    }
    return top;
}

void tri_tree_walk(const TriTree *tree, const struct RTCRay *ray,
                   float (*offer)(void *query, uint32_t triangle, float far), void *query)
{
    Walk w = {.o = {ray->org_x, ray->org_y, ray->org_z},
              .inverse = {1 / ray->dir_x, 1 / ray->dir_y, 1 / ray->dir_z},
              .far = ray->tfar};
    for (int i = 0; i < 3; i++)
        w.is_back[i] = w.inverse[i] < 0;
    Waiting stack[STACK_MAX];
    int top = push_children(&w, &tree->nodes[0], stack, 0);
    while (top > 0) {
        Waiting next = stack[--top];
        if (next.entry > w.far)
            continue;
        if (next.count == 0)
            top = push_children(&w, &tree->nodes[next.first], stack, top);
        for (uint32_t i = 0; i < next.count; i++)
            w.far = offer(query, tree->items[next.first + i], w.far);
    }
}
