/* Lathes: curves of (radius, height) turned around the y axis.
 *
 * Along a piece of the curve the line is at the piece's height at s = (y - f.y) / e.y, and there
 * x^2 + z^2 - r^2 tells whether it passes outside; all are polynomials of the place on the piece. A
 * nearly level line stays within a short part of the piece, which alone is looked at, so that its
 * digits are kept.  SPDX-License-Identifier: Apache-2.0 */
#include "math/bernstein.h"
#include "shape/revolve_int.h"

/* Add a span, cut where y turns back; returns how many pieces that made. */
static uint32_t add_span(int degree, const CurveSpan *span, uint32_t number, RevolvePiece *out)
{
    double slope[3], cuts[4];
    for (int i = 0; i < degree; i++)
        slope[i] = span->b[i + 1] - span->b[i];
    int count = degree > 1 ? bernstein_roots(slope, degree - 1, cuts) : 0;
    cuts[count] = 1;
    for (int k = 0; k <= count; k++) {
        RevolvePiece *piece = &out[k];
        piece->from = k ? cuts[k - 1] : 0;
        piece->to = cuts[k];
        piece->span = number;
        bernstein_part(span->a, degree, piece->from, piece->to, piece->r);
        bernstein_part(span->b, degree, piece->from, piece->to, piece->y);
        if (k) {
            piece->r[0] = out[k - 1].r[degree];
            piece->y[0] = out[k - 1].y[degree];
        }
    }
    out[count].r[degree] = span->a[degree];
    out[count].y[degree] = span->b[degree];
    return (uint32_t)count + 1;
}

/* Add lids where the curve does not go on; a curve that closes needs none. */
static void add_lids(RevolveData *data, const CurveSpan *spans, uint32_t count)
{
    int n = data->degree;
    uint32_t first = 0;
    for (uint32_t i = 0; i < count; i++) {
        const CurveSpan *s = &spans[i];
        if (i + 1 < count && spans[i + 1].a[0] == s->a[n] && spans[i + 1].b[0] == s->b[n])
            continue;
        const CurveSpan *start = &spans[first];
        bool is_loop = start->a[0] == s->a[n] && start->b[0] == s->b[n];
        if (!is_loop && start->a[0] != 0)
            data->lids[data->lid_count++] = (RevolveLid){start->a[0], start->b[0]};
        if (!is_loop && s->a[n] != 0)
            data->lids[data->lid_count++] = (RevolveLid){s->a[n], s->b[n]};
        first = i + 1;
    }
}

Shape *shape_lathe(Arena *arena, int degree, const CurveSpan *spans, uint32_t count)
{
    Shape *shape = leaf_new(arena, SHAPE_LATHE);
    RevolveData *data = ARENA_NEW(arena, RevolveData);
    if (!shape || !data)
        return NULL;
    data->pieces = ARENA_ARRAY(arena, RevolvePiece, (size_t)count * (size_t)degree);
    data->lids = ARENA_ARRAY(arena, RevolveLid, 2 * (size_t)count);
    if (!data->pieces || !data->lids)
        return NULL;
    data->degree = degree;
    data->span_count = count;
    for (uint32_t i = 0; i < count; i++)
        data->piece_count += add_span(degree, &spans[i], i, &data->pieces[data->piece_count]);
    add_lids(data, spans, count);
    shape->is_open = data->lid_count > 0;
    return revolve_place(arena, shape, data);
}

/* The discriminant of the quadratic form x^2 + z^2 - r^2 along a straight piece, without the
 * cancellation of its coefficients. */
static double straight_discriminant(const double x[2], const double z[2], const double r[2],
                                    double *terms)
{
    double xr = x[0] * r[1] - x[1] * r[0], zr = z[0] * r[1] - z[1] * r[0];
    double xz = x[0] * z[1] - x[1] * z[0];
    *terms = xr * xr + zr * zr + xz * xz;
    return xr * xr + zr * zr - xz * xz;
}

int lathe_roots(const RevolveData *data, const RevolvePiece *piece, const RevolvePart *part,
                const RevolveLine *l, RevolveRoot *out, bool is_within[2])
{
    int n = data->degree;
    double r[4], s[4], x[4], z[4], g[BERNSTEIN_DEGREE_MAX + 1] = {0}, at[BERNSTEIN_DEGREE_MAX];
    bool is_whole = !part->is_cut[0] && !part->is_cut[1];
    if (is_whole) {
        for (int i = 0; i <= n; i++)
            r[i] = piece->r[i], s[i] = (piece->y[i] - l->f.y) / l->e.y;
    } else {
        bernstein_part(piece->r, n, part->from, part->to, r);
        bernstein_part(piece->y, n, part->from, part->to, s);
        for (int i = 0; i <= n; i++)
            s[i] = part->is_tiny ? part->s[0] + (part->s[1] - part->s[0]) * i / n
                                 : (s[i] - l->f.y) / l->e.y;
        s[0] = part->s[0];
        s[n] = part->s[1];
    }
    for (int i = 0; i <= n; i++)
        x[i] = l->f.x + l->e.x * s[i], z[i] = l->f.z + l->e.z * s[i];
    bernstein_add_product(x, x, n, 1, g);
    bernstein_add_product(z, z, n, 1, g);
    bernstein_add_product(r, r, n, -1, g);
    is_within[0] = g[0] < 0;
    is_within[1] = g[2 * n] < 0;
    double terms = 0, straight = 0;
    int count = n == 1 ? bernstein_quadratic(g, straight_discriminant(x, z, r, &straight), at)
                       : bernstein_roots(g, 2 * n, at);
    if (n == 1) /* what the discriminant is off moves the values by that over the bend */
        terms = straight / fabs(g[0] - 2 * g[1] + g[2]);
    for (int i = 0; i <= n; i++)
        terms = num_max(terms, x[i] * x[i] + z[i] * z[i] + r[i] * r[i]);
    for (int i = 0; i < count; i++) {
        out[i].terms = terms;
        out[i].s = bernstein_value(s, n, at[i]);
        out[i].u = part->from + (part->to - part->from) * at[i];
    }
    return count;
}

static V2 lathe_uv(const Shape *shape, uint32_t part, double u, double v, V3 p)
{
    const RevolveData *data = shape->u.revolve;
    (void)v;
    if (part >= data->piece_count)
        return (V2){revolve_turn(p), 0};
    const RevolvePiece *piece = &data->pieces[part];
    double place = piece->span + piece->from + (piece->to - piece->from) * u;
    return (V2){revolve_turn(p), place / data->span_count};
}

const ShapeOps lathe_ops = {.list = revolve_list,
                            .point = revolve_point,
                            .uv = lathe_uv,
                            .is_inside = revolve_is_inside,
                            .bound = revolve_bound,
                            .farthest = revolve_farthest,
                            .size = revolve_size};
