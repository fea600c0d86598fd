/* What is known of a lamp's shadows: made by quartering.
 *
 * Cells are quartered until what casts shadows in them is enclosed closely, or nothing does, or
 * they are as small as cells get.  SPDX-License-Identifier: Apache-2.0 */
#include "trace/shadow_int.h"

#include "base/mem.h"
#include "base/work.h"

#include <float.h>
#include <stdlib.h>

/* Members of unions are looked at each for itself, up to so many. */
enum { PARTS_MAX = 4096 };

/* A spot of up to this half angle has one face; radians. */
#define ONE_FACE_ANGLE 1.1

/* A face is wider than its lamp's light by this part, for the rounding. */
#define EDGE_SLACK 1e-5

#define HALF_SIDE (SHADOW_SIDE / 2.0)

typedef struct Builder {
    ShadowFace *face;
    long looks; /* so many parts were looked at in cells */
    Sight sight;
    size_t count, capacity;
    Part *parts;   /* those in the cells that are being looked at, one list behind the other */
    bool is_short; /* memory ran out */
} Builder;

/* --- the cells -------------------------------------------------------------------------------- */

/* In smallest cells, from the corner of the face on. */
static ShadowPlane to_cells(const Plane *plane)
{
    return (ShadowPlane){plane->a / HALF_SIDE, plane->b / HALF_SIDE,
                         plane->c - plane->a - plane->b};
}

static ShadowEdge edge_to_cells(const ShadowEdge *edge)
{
    double move = edge->a + edge->b;
    return (ShadowEdge){edge->a, edge->b, (edge->inside + move) * HALF_SIDE,
                        (edge->outside + move) * HALF_SIDE};
}

static void push_part(Builder *b, const Part *part)
{
    void *parts = b->parts;
    if (mem_grow(&parts, b->count, &b->capacity, sizeof *b->parts)) {
        b->is_short = true;
        return;
    }
    b->parts = parts;
    b->parts[b->count++] = *part;
}

static ShadowPlanes both_to_cells(const Enclosure *e)
{
    return (ShadowPlanes){to_cells(&e->lit), to_cells(&e->dark)};
}

static void fill_square(Builder *b, const Cell *cell, size_t index)
{
    for (uint32_t j = 0; j < cell->side; j++)
        for (uint32_t i = 0; i < cell->side; i++)
            b->face->cell[cell->j + j][cell->i + i] = (uint32_t)index;
}

/* edge: NULL if there is none; `rest` encloses what is on its outer side. */
static void finish_cell(Builder *b, const Cell *cell, const ShadowEdge *edge, const Enclosure *all,
                        const Enclosure *rest)
{
    ShadowFace *face = b->face;
    void *cells = face->cells;
    if (mem_grow(&cells, face->count, &face->capacity, sizeof *face->cells)) {
        b->is_short = true;
        return;
    }
    face->cells = cells;
    face->cells[face->count] = (ShadowCell){.size = cell->side,
                                            .has_edge = edge != NULL,
                                            .edge = edge ? edge_to_cells(edge) : (ShadowEdge){0},
                                            .all = both_to_cells(all),
                                            .rest = both_to_cells(rest)};
    fill_square(b, cell, face->count++);
}

static bool is_same_plane(const ShadowPlane *x, const ShadowPlane *y)
{
    return x->a == y->a && x->b == y->b && x->c == y->c;
}

/* Join the cells of a square, from `first` on, if quartering it told nothing new. */
static void join_quarters(Builder *b, const Cell *cell, size_t first)
{
    ShadowFace *face = b->face;
    if (b->is_short || face->count != first + 4)
        return;
    ShadowCell *c = face->cells + first;
    for (int i = 0; i < 4; i++)
        if (c[i].has_edge || !is_same_plane(&c[i].all.lit, &c->all.lit) ||
            !is_same_plane(&c[i].all.dark, &c->all.dark))
            return;
    c->size = cell->side;
    face->count = first + 1;
    fill_square(b, cell, first);
}

static Cell quarter_of(const Cell *cell, int quarter)
{
    uint32_t right = quarter & 1, up = (uint32_t)quarter >> 1, side = cell->side / 2;
    double size = cell->size / 2;
    return (Cell){cell->u + right * size, cell->v + up * size, size,
                  cell->i + right * side, cell->j + up * side, side};
}

/* Look at the parts from `first` to `end` in a cell.  Those that are not enclosed well enough are
 * pushed behind the others; `known` gets what encloses the rest, `all` what encloses them all. */
static void look_at_parts(Builder *b, const Cell *cell, size_t first, size_t end, Enclosure *known,
                          Enclosure *all)
{
    b->looks += (long)(end - first);
    for (size_t i = first; i < end && !b->is_short; i++) {
        Part part = b->parts[i];
        if (!part.is_at_lamp && part_is_missed(b->face, cell, part.shape))
            continue;
        Enclosure e = part_enclose(&b->sight, cell, &part);
        if (plane_is_over(&all->dark, &e.lit, cell))
            continue;
        /* Of surfaces that cross each other neither encloses the other. */
        bool is_settled =
            enclosure_is_close(&e, cell) &&
            (plane_is_over(&e.lit, &known->lit, cell) || plane_is_over(&known->lit, &e.lit, cell));
        if (!part.is_opaque)
            e.dark = b->sight.nothing.dark;
        enclosure_add(all, &e, cell);
        if (is_settled)
            enclosure_add(known, &e, cell);
        else
            push_part(b, &part);
    }
}

static void make_cells(Builder *b, const Cell *cell, size_t first, size_t end,
                       const Enclosure *settled, long looks);

/* Quarter a square; the quarters share the looks that are left. */
static void make_quarters(Builder *b, const Cell *cell, size_t first, size_t end,
                          const Enclosure *settled, long looks)
{
    size_t cells = b->face->count;
    long begin = b->looks;
    for (int i = 0; i < 4 && !b->is_short; i++) {
        Cell quarter = quarter_of(cell, i);
        make_cells(b, &quarter, first, end, settled, (looks - (b->looks - begin)) / (4 - i));
    }
    join_quarters(b, cell, cells);
}

/* Make the cells of a square with the parts from `first` to `end` and what `settled` encloses,
 * with about so many looks at parts. */
static void make_cells(Builder *b, const Cell *cell, size_t first, size_t end,
                       const Enclosure *settled, long looks)
{
    Enclosure known = *settled, all = *settled;
    size_t open = b->count;
    look_at_parts(b, cell, first, end, &known, &all);
    size_t open_end = b->count;
    looks -= (long)(end - first);
    bool is_done = open_end == open || cell->side == 1 || looks < 4 * (long)(open_end - open) ||
                   work_interrupted || plane_is_over(&all.dark, &all.lit, cell);
    ShadowEdge edge;
    Plane dark;
    if (open_end == open + 1 && part_edge(&b->sight, cell, &b->parts[open], &edge, &dark)) {
        const Enclosure inside = {all.lit, dark};
        enclosure_add(&all, &inside, cell);
        finish_cell(b, cell, &edge, &all, &known);
    } else if (is_done) {
        finish_cell(b, cell, NULL, &all, &all);
    } else {
        make_quarters(b, cell, open, open_end, &known, looks);
    }
    b->count = open;
}

/* --- what is looked at ------------------------------------------------------------------------ */

/* The depths between which a shape is. */
static void depths(const ShadowFace *face, const Shape *shape, double *near, double *far)
{
    Bound bound = shape_bound(shape);
    V3 half = v3_scale(v3_sub(bound.hi, bound.lo), 0.5);
    double middle = v3_dot(face->w, v3_sub(bound_center(bound), face->origin));
    double reach = fabs(face->w.x) * half.x + fabs(face->w.y) * half.y + fabs(face->w.z) * half.z;
    bool is_finite = bound_is_finite(bound);
    *near = is_finite ? middle - reach : -INFINITY;
    *far = is_finite ? middle + reach : INFINITY;
}

/* A lamp this near a surface, in parts of the size of the numbers, may be on either side of it. */
#define TOUCH 1e-7

/* How near to a surface counts as on it, for a lamp at p: by the size of the shape, where it has
 * one. */
static double touch_of(const Shape *shape, V3 p)
{
    Bound bound = shape_bound(shape);
    const double sides[] = {p.x,        p.y,        p.z,        bound.lo.x, bound.lo.y,
                            bound.lo.z, bound.hi.x, bound.hi.y, bound.hi.z};
    double most = shape->kind == SHAPE_PLANE ? fabs(shape->u.plane.distance) : 0;
    for (size_t i = 0; i < sizeof sides / sizeof *sides; i++)
        most = isfinite(sides[i]) ? num_max(most, fabs(sides[i])) : most;
    return TOUCH * most;
}

/* Is p on the surface of a solid, or within `touch` of it?  Looks at points around it, and at one
 * towards the middle: at a tip none of the others may be inside. */
static bool is_at_surface(const Shape *shape, V3 p, double touch)
{
    if (!shape_is_solid(shape))
        return false;
    Bound bound = shape_bound(shape);
    V3 inward = bound_is_finite(bound) ? v3_unit(v3_sub(bound_center(bound), p)) : v3(0, 0, 0);
    bool is_inside = shape_is_inside(shape, p);
    for (int i = 0; i < 27; i++) {
        V3 move = i == 13 ? inward : v3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        if (shape_is_inside(shape, v3_mad(p, touch, move)) != is_inside)
            return true;
    }
    return false;
}

/* Add the parts of a shape: members of a union cast shadows each for itself. */
static void add_shape(Builder *b, const Shape *shape, bool is_opaque)
{
    bool is_plain = shape->kind == SHAPE_UNION && shape->clip_count == 0;
    if (is_plain && b->count + (size_t)shape->child_count <= PARTS_MAX) {
        for (int i = 0; i < shape->child_count; i++)
            add_shape(b, shape->children[i], is_opaque);
        return;
    }
    double near, far;
    depths(b->face, shape, &near, &far);
    if (far < 0)
        return;
    double nearest = b->face->is_parallel ? -near : near > 0 ? 1 / near : INFINITY;
    Part part = {.shape = shape,
                 .is_convex = shape_is_convex(shape),
                 .is_opaque = is_opaque,
                 .nearest = nearest,
                 .touch = touch_of(shape, b->face->origin)};
    part.is_at_lamp = !b->face->is_parallel && is_at_surface(shape, b->face->origin, part.touch);
    push_part(b, &part);
}

static int nearer_first(const void *a, const void *b)
{
    double x = ((const Part *)a)->nearest, y = ((const Part *)b)->nearest;
    return x > y ? -1 : x < y;
}

static bool has_one_face(const Light *light)
{
    return light_is_parallel(light) ||
           (light->kind == LIGHT_SPOT && light->falloff < ONE_FACE_ANGLE);
}

/* Half the side of a face, at depth 1. */
static double face_edge(const Tracer *tracer, const Light *light)
{
    if (light->kind == LIGHT_CYLINDER)
        return light->falloff;
    if (light->is_parallel)
        return bound_radius(tracer->bound) + v3_dist(light->location, bound_center(tracer->bound));
    return has_one_face(light) ? tan(light->falloff) : 1;
}

static void place_face(ShadowFace *face, const Tracer *tracer, const Light *light, int i)
{
    double sign = i & 1 ? -1 : 1, edge = face_edge(tracer, light) * (1 + EDGE_SLACK);
    face->origin = light->location;
    face->is_parallel = light_is_parallel(light);
    face->w = v3(i / 2 == 0 ? sign : 0, i / 2 == 1 ? sign : 0, i / 2 == 2 ? sign : 0);
    if (has_one_face(light))
        face->w = light->direction;
    v3_frame(face->w, &face->u, &face->v);
    face->u = v3_scale(face->u, edge);
    face->v = v3_scale(face->v, edge);
}

bool shadow_view_is_of_use(const Tracer *tracer, const Light *light)
{
    double edge = face_edge(tracer, light);
    bool is_point = !plan_light_has_area(tracer->plan, light) && !light->is_shadowless;
    bool has_bound = !light->is_parallel || bound_radius(tracer->bound) > 0;
    return is_point && has_bound && edge > 0 && isfinite(edge);
}

ShadowView *shadow_view_new(const Tracer *tracer, const Light *light)
{
    ShadowView *view = mem_alloc(sizeof *view);
    if (!view)
        return NULL;
    view->face_count = has_one_face(light) ? 1 : SHADOW_FACES_MAX;
    view->faces = mem_array((size_t)view->face_count, sizeof *view->faces);
    if (!view->faces) {
        mem_free(view);
        return NULL;
    }
    for (int i = 0; i < view->face_count; i++)
        place_face(&view->faces[i], tracer, light, i);
    return view;
}

bool shadow_view_prove(ShadowView *view, int face, const Tracer *tracer, long looks)
{
    ShadowFace *f = &view->faces[face];
    double far = f->is_parallel ? -DBL_MAX : 0;
    Builder b = {.face = f, .sight = {.face = f, .shapes = shape_scratch_new()}};
    b.sight.nothing = (Enclosure){{0, 0, far}, {0, 0, far}};
    b.is_short = !b.sight.shapes;
    for (uint32_t i = 0; i < tracer->scene->object_count && !b.is_short; i++)
        if (tracer->objects[i].shadow != SHADOW_NONE)
            add_shape(&b, tracer->objects[i].shape, tracer->objects[i].shadow == SHADOW_BLOCK);
    if (b.count > 1)
        qsort(b.parts, b.count, sizeof *b.parts, nearer_first);
    Cell whole = {-1, -1, 2, 0, 0, SHADOW_SIDE};
    if (!b.is_short)
        make_cells(&b, &whole, 0, b.count, &b.sight.nothing, looks);
    mem_free(b.parts);
    shape_scratch_free(b.sight.shapes);
    return !b.is_short;
}

void shadow_view_free(ShadowView *view)
{
    if (!view)
        return;
    for (int i = 0; i < view->face_count; i++)
        mem_free(view->faces[i].cells);
    mem_free(view->faces);
    mem_free(view);
}
