/* What may be seen from one point, by direction.
 *
 * Rays that start or end in the same point (the eye, a light) all ask the same question, so it
 * is answered once: the directions are the cells of a cube around the point, and each lists the
 * objects whose boxes reach into it, nearest first.  A cell with more than it can hold says so,
 * and the ray goes through the index instead.  Boxes and cells are tested by the planes of the
 * cell's pyramid and never missed, so the answers are the same either way.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/view_index.h"

#include "base/mem.h"

/* Pyramids are wider than their cells by this part of a cube's half edge: more than the
 * rounding of a direction and of its place on the cube. */
#define MARGIN 1e-9

/* A box as a face of the cube sees it: w towards the face, u and v along it. */
typedef struct FaceBox {
    double w0, w1, u0, u1, v0, v1;
} FaceBox;

static void add_object(ViewIndex *view, ViewCell *cell, uint32_t object)
{
    if (cell->count == VIEW_CELL_FULL)
        return;
    if (cell->count == VIEW_CELL_MAX) {
        cell->count = VIEW_CELL_FULL;
        return;
    }
    uint32_t at = cell->count++;
    for (; at > 0 && view->near[cell->object[at - 1]] > view->near[object]; at--)
        cell->object[at] = cell->object[at - 1];
    cell->object[at] = object;
}

/* Can some of low <= x <= high lie between a w and b w, for a w of the box? */
static bool reaches(double low, double high, double a, double b, const FaceBox *box)
{
    return high >= fmin(a * box->w0, a * box->w1) && low <= fmax(b * box->w0, b * box->w1);
}

/* Add an object to the cells of a square of a face that its box reaches. */
static void add_square(ViewIndex *view, int face, int i, int j, int size, const FaceBox *box,
                       uint32_t object)
{
    const double step = 2.0 / VIEW_SIDE;
    if (!reaches(box->u0, box->u1, i * step - 1 - MARGIN, (i + size) * step - 1 + MARGIN, box) ||
        !reaches(box->v0, box->v1, j * step - 1 - MARGIN, (j + size) * step - 1 + MARGIN, box))
        return;
    if (size == 1) {
        add_object(view, &view->cells[(face * VIEW_SIDE + j) * VIEW_SIDE + i], object);
        return;
    }
    int half = size / 2;
    add_square(view, face, i, j, half, box, object);
    add_square(view, face, i + half, j, half, box, object);
    add_square(view, face, i, j + half, half, box, object);
    add_square(view, face, i + half, j + half, half, box, object);
}

/* The gap between 0 and an interval. */
static double gap(double lo, double hi)
{
    return lo > 0 ? lo : hi < 0 ? -hi : 0;
}

static void add_box(ViewIndex *view, Bound bound, uint32_t object)
{
    V3 lo = v3_sub(bound.lo, view->from), hi = v3_sub(bound.hi, view->from);
    V3 away = v3(gap(lo.x, hi.x), gap(lo.y, hi.y), gap(lo.z, hi.z));
    view->near[object] = (float)(v3_len(away) * (1 - 1e-6));
    for (int face = 0; face < 6; face++) {
        int a = face / 2, b = (a + 1) % 3, c = (a + 2) % 3;
        double low = v3_at(lo, a), high = v3_at(hi, a);
        FaceBox box = {fmax(0, face & 1 ? -high : low),
                       face & 1 ? -low : high,
                       v3_at(lo, b),
                       v3_at(hi, b),
                       v3_at(lo, c),
                       v3_at(hi, c)};
        if (box.w1 >= 0)
            add_square(view, face, 0, 0, VIEW_SIDE, &box, object);
    }
}

ViewIndex *view_index_new(V3 from, const Bound *bounds, const uint32_t *objects, uint32_t count,
                          uint32_t object_count)
{
    ViewIndex *view = mem_alloc(sizeof *view);
    if (!view)
        return NULL;
    view->from = from;
    view->near = mem_array((size_t)object_count + 1, sizeof *view->near);
    if (!view->near) {
        mem_free(view);
        return NULL;
    }
    for (uint32_t i = 0; i < count; i++)
        add_box(view, bounds[i], objects[i]);
    return view;
}

void view_index_free(ViewIndex *view)
{
    if (!view)
        return;
    mem_free(view->near);
    mem_free(view);
}
