/* Surfaces of revolution whose squared radius is a cubic of the height, span by span.
 * SPDX-License-Identifier: Apache-2.0 */
#include "math/bernstein.h"
#include "shape/revolve_int.h"

/* Return the slope of the squared radius at a point, as its neighbours have it. */
static double slope_at(const V2 *p)
{
    return 2 * p[0].u * (p[1].u - p[-1].u) / (p[1].v - p[-1].v);
}

Shape *shape_sor(Arena *arena, const V2 *points, int count, bool is_open)
{
    Shape *shape = leaf_new(arena, SHAPE_SOR);
    RevolveData *data = ARENA_NEW(arena, RevolveData);
    uint32_t spans = (uint32_t)count - 3;
    if (!shape || !data)
        return NULL;
    data->pieces = ARENA_ARRAY(arena, RevolvePiece, spans);
    data->lids = ARENA_ARRAY(arena, RevolveLid, 2);
    if (!data->pieces || !data->lids)
        return NULL;
    data->is_square = true;
    data->degree = 3;
    data->span_count = data->piece_count = spans;
    for (uint32_t i = 0; i < spans; i++) {
        const V2 *p = &points[i + 1];
        double third = (p[1].v - p[0].v) / 3;
        double first = p[0].u * p[0].u, last = p[1].u * p[1].u;
        data->pieces[i] = (RevolvePiece){
            .r = {first, first + third * slope_at(p), last - third * slope_at(p + 1), last},
            .y = {p[0].v, p[1].v},
            .to = 1,
            .span = i};
    }
    const V2 *ends[2] = {&points[1], &points[count - 2]};
    for (int i = 0; i < 2; i++)
        if (ends[i]->u > 0)
            data->lids[data->lid_count++] = (RevolveLid){ends[i]->u * ends[i]->u, ends[i]->v};
    shape->is_open = is_open;
    return revolve_place(arena, shape, data);
}

int sor_roots(const RevolveData *data, const RevolvePiece *piece, const RevolvePart *part,
              const RevolveLine *l, RevolveRoot *out, bool is_within[2])
{
    (void)data;
    double r[4], at[3];
    if (part->from > 0 || part->to < 1)
        bernstein_part(piece->r, 3, part->from, part->to, r);
    else
        for (int i = 0; i < 4; i++)
            r[i] = piece->r[i];
    double a = part->s[0], b = part->s[1];
    double x0 = l->f.x + l->e.x * a, z0 = l->f.z + l->e.z * a;
    double x1 = l->f.x + l->e.x * b, z1 = l->f.z + l->e.z * b;
    double first = x0 * x0 + z0 * z0, last = x1 * x1 + z1 * z1, middle = x0 * x1 + z0 * z1;
    double g[4] = {first - r[0], (first + 2 * middle) / 3 - r[1], (2 * middle + last) / 3 - r[2],
                   last - r[3]};
    is_within[0] = g[0] < 0;
    is_within[1] = g[3] < 0;
    int count = bernstein_roots(g, 3, at);
    for (int i = 0; i < count; i++) {
        out[i].terms = num_max(first, last);
        out[i].s = a + (b - a) * at[i];
        out[i].u = part->from + (part->to - part->from) * at[i];
    }
    return count;
}

static V2 sor_uv(const Shape *shape, uint32_t part, double u, double v, V3 p)
{
    const RevolveData *data = shape->u.revolve;
    (void)v;
    if (part < data->piece_count)
        return (V2){revolve_turn(p), (data->pieces[part].span + u) / data->span_count};
    const RevolveLid *lid = &data->lids[part - data->piece_count];
    double share = sqrt((p.x * p.x + p.z * p.z) / lid->r);
    return (V2){revolve_turn(p), lid->y == data->y_lo ? share - 1 : 2 - share};
}

const ShapeOps sor_ops = {.list = revolve_list,
                          .point = revolve_point,
                          .uv = sor_uv,
                          .is_inside = revolve_is_inside,
                          .bound = revolve_bound,
                          .farthest = revolve_farthest,
                          .size = revolve_size};
