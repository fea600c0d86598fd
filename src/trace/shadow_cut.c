/* A ray through what is known of a lamp's shadows.
 *
 * On a face a ray is a straight line, and nearness is linear along it: it is followed from cell to
 * cell.  SPDX-License-Identifier: Apache-2.0 */
#include "trace/shadow_view.h"

/* Rays keep this part of their way off the lamp itself, where they have no direction. */
#define LAMP_SLACK 1e-9

/* A point of a ray on a face: u and v in smallest cells, and nearness.  All are linear in s. */
typedef struct RayPoint {
    double s; /* 0 to 1 on the face */
    double u, v, nearness;
} RayPoint;

/* The part of a ray that a face sees. */
typedef struct FaceRay {
    double begin, end;             /* t */
    double begin_depth, end_depth; /* 1 for parallel light */
    RayPoint first, step;          /* at s = 0, and per unit of s */
} FaceRay;

/* Where the part is that comes before s. */
static double ray_t(const FaceRay *r, double s)
{
    double x = s * r->begin_depth, rest = (1 - s) * r->end_depth;
    return s < 1 ? num_min(r->end, r->begin + (r->end - r->begin) * (x / (x + rest))) : r->end;
}

static inline RayPoint point_at(const FaceRay *r, double s)
{
    const RayPoint *o = &r->first, *d = &r->step;
    return (RayPoint){s, o->u + s * d->u, o->v + s * d->v, o->nearness + s * d->nearness};
}

/* --- in a cell -------------------------------------------------------------------------------- */

/* Add a stretch that begins where the last one ended. */
static inline void add_stretch(LitStretches *out, double end, LitState state)
{
    LitStretch *last = &out->items[out->count - 1];
    if (!(end > last->end))
        return;
    if (last->end == last->begin)
        last->state = state;
    if (last->state != state && out->count < LIT_STRETCHES_MAX) {
        out->items[out->count++] = (LitStretch){last->end, end, state};
        return;
    }
    if (last->state != state)
        last->state = LIT_UNSURE;
    last->end = end;
}

/* How far behind a plane a point is; above 0 it is. */
static inline double behind(const ShadowPlane *plane, const RayPoint *p)
{
    return plane->a * p->u + plane->b * p->v + plane->c - p->nearness;
}

/* Where a number that goes from `first` to `last` changes its sign between begin and end; end: it
 * does not. */
static inline double sign_change(double first, double last, double begin, double end)
{
    if ((first > 0) == (last > 0))
        return end;
    return num_min(end, begin + (end - begin) * (first / (first - last)));
}

static inline LitState state_of(bool is_behind_lit, bool is_dark)
{
    return !is_behind_lit ? LIT_SURE : is_dark ? LIT_NOT : LIT_UNSURE;
}

/* Cut what goes from a to b by planes. */
static inline void cut_by_planes(const ShadowPlane *lit, const ShadowPlane *dark, const RayPoint *a,
                                 const RayPoint *b, LitStretches *out)
{
    double lit_a = behind(lit, a), lit_b = behind(lit, b);
    if (!(lit_a > 0 || lit_b > 0)) {
        add_stretch(out, b->s, LIT_SURE);
        return;
    }
    double dark_a = behind(dark, a), dark_b = behind(dark, b);
    double lit_change = sign_change(lit_a, lit_b, a->s, b->s);
    double dark_change = sign_change(dark_a, dark_b, a->s, b->s);
    if (lit_change < dark_change) {
        add_stretch(out, lit_change, state_of(lit_a > 0, dark_a > 0));
        add_stretch(out, dark_change, state_of(lit_b > 0, dark_a > 0));
    } else {
        add_stretch(out, dark_change, state_of(lit_a > 0, dark_a > 0));
        add_stretch(out, lit_change, state_of(lit_a > 0, dark_b > 0));
    }
    add_stretch(out, b->s, state_of(lit_b > 0, dark_b > 0));
}

/* Cut what is on one side of an edge, or between its lines. */
static void cut_beside_edge(const ShadowCell *cell, bool is_outside, bool is_inside,
                            const RayPoint *a, const RayPoint *b, LitStretches *out)
{
    cut_by_planes(is_outside ? &cell->rest.lit : &cell->all.lit,
                  is_inside ? &cell->all.dark : &cell->rest.dark, a, b, out);
}

static inline void cut_at_edge(const FaceRay *r, const ShadowCell *cell, const RayPoint *a,
                               const RayPoint *b, LitStretches *out)
{
    const ShadowEdge *edge = &cell->edge;
    double at_a = edge->a * a->u + edge->b * a->v;
    double at_b = edge->a * b->u + edge->b * b->v;
    double outer_a = at_a - edge->outside, outer_b = at_b - edge->outside;
    double inner_a = at_a - edge->inside, inner_b = at_b - edge->inside;
    if ((outer_a > 0) == (outer_b > 0) && (inner_a > 0) == (inner_b > 0)) {
        cut_beside_edge(cell, outer_a > 0, !(inner_a > 0), a, b, out);
        return;
    }
    double x = sign_change(outer_a, outer_b, a->s, b->s);
    double y = sign_change(inner_a, inner_b, a->s, b->s);
    RayPoint first = point_at(r, num_min(x, y)), second = point_at(r, num_max(x, y));
    bool is_outer_first = x < y;
    cut_beside_edge(cell, outer_a > 0, !(inner_a > 0), a, &first, out);
    cut_beside_edge(cell, is_outer_first ? outer_b > 0 : outer_a > 0,
                    !(is_outer_first ? inner_a > 0 : inner_b > 0), &first, &second, out);
    cut_beside_edge(cell, outer_b > 0, !(inner_b > 0), &second, b, out);
}

/* --- on a face -------------------------------------------------------------------------------- */

/* A number that is linear along a ray: at t = 0, and per unit of t. */
typedef struct Linear {
    double at0, step;
} Linear;

static Linear linear(const Ray *ray, V3 origin, V3 axis)
{
    return (Linear){v3_dot(axis, v3_sub(ray->o, origin)), v3_dot(axis, ray->d)};
}

static double linear_at(Linear x, double t)
{
    return x.at0 + t * x.step;
}

/* Return a + s b. */
static Linear linear_mad(Linear a, double s, Linear b)
{
    return (Linear){a.at0 + s * b.at0, a.step + s * b.step};
}

/* Narrow begin..end to where x >= 0. */
static void narrow(Linear x, double *begin, double *end)
{
    double t = -x.at0 / x.step;
    if (x.step > 0)
        *begin = num_max(*begin, t);
    else if (x.step < 0)
        *end = num_min(*end, t);
    else if (x.at0 < 0)
        *end = *begin;
}

static V3 per_edge(V3 axis)
{
    return v3_scale(axis, 1 / v3_len2(axis));
}

/* See a ray from begin to end; returns false if nothing of it is on the face. */
static bool see_ray(const ShadowFace *face, const Ray *ray, double begin, double end, FaceRay *r)
{
    Linear u = linear(ray, face->origin, per_edge(face->u));
    Linear v = linear(ray, face->origin, per_edge(face->v));
    Linear depth = linear(ray, face->origin, face->w);
    Linear w = face->is_parallel ? (Linear){1, 0} : depth;
    for (int sign = -1; sign <= 1; sign += 2) {
        narrow(linear_mad(w, sign, u), &begin, &end);
        narrow(linear_mad(w, sign, v), &begin, &end);
    }
    double keep = LAMP_SLACK * (end - begin);
    if (!face->is_parallel && linear_at(w, begin) <= keep * fabs(w.step))
        begin += keep;
    if (!face->is_parallel && linear_at(w, end) <= keep * fabs(w.step))
        end -= keep;
    double a = linear_at(w, begin), b = linear_at(w, end);
    if (!(end > begin && a > 0 && b > 0))
        return false;
    double half = SHADOW_SIDE / 2.0;
    RayPoint from = {0, (linear_at(u, begin) / a + 1) * half, (linear_at(v, begin) / a + 1) * half,
                     face->is_parallel ? -linear_at(depth, begin) : 1 / a};
    RayPoint to = {1, (linear_at(u, end) / b + 1) * half, (linear_at(v, end) / b + 1) * half,
                   face->is_parallel ? -linear_at(depth, end) : 1 / b};
    RayPoint step = {1, to.u - from.u, to.v - from.v, to.nearness - from.nearness};
    *r = (FaceRay){begin, end, a, b, from, step};
    return true;
}

/* The smallest cell in which x is, from `low` to `high`. */
static inline int place_of(double x, int low, int high)
{
    return x > low ? x < high ? (int)x : high : low;
}

/* Follow a ray to its end on the face.  In each step it leaves a cell for good, so that there are
 * no more of them than cells in a row and a column. */
static void follow(const ShadowFace *face, const FaceRay *r, LitStretches *out)
{
    const unsigned side = SHADOW_SIDE;
    const RayPoint *o = &r->first, *d = &r->step;
    double per_u = 1 / d->u, per_v = 1 / d->v;
    int is_u_rising = d->u > 0, is_v_rising = d->v > 0;
    RayPoint a = *o;
    int i = place_of(a.u, 0, SHADOW_SIDE - 1), j = place_of(a.v, 0, SHADOW_SIDE - 1);
    out->count = 1;
    out->items[0] = (LitStretch){0, 0, LIT_UNSURE};
    while (a.s < 1 && (unsigned)i < side && (unsigned)j < side) {
        const ShadowCell *cell = &face->cells[face->cell[j][i]];
        int size = (int)cell->size, low_i = i & -size, low_j = j & -size;
        int edge_i = low_i + (is_u_rising ? size : 0), edge_j = low_j + (is_v_rising ? size : 0);
        double u = d->u != 0 ? (edge_i - o->u) * per_u : INFINITY;
        double v = d->v != 0 ? (edge_j - o->v) * per_v : INFINITY;
        RayPoint b = point_at(r, num_max(a.s, num_min(1, num_min(u, v))));
        if (cell->has_edge)
            cut_at_edge(r, cell, &a, &b, out);
        else
            cut_by_planes(&cell->all.lit, &cell->all.dark, &a, &b, out);
        if (u <= v) {
            i = edge_i - 1 + is_u_rising;
            j = place_of(b.v, low_j, low_j + size - 1);
        } else {
            j = edge_j - 1 + is_v_rising;
            i = place_of(b.u, low_i, low_i + size - 1);
        }
        a = b;
    }
}

void shadow_view_cut(const ShadowView *view, const Ray *ray, double begin, double end,
                     LitStretches *out)
{
    FaceRay rays[SHADOW_FACES_MAX];
    bool is_seen[SHADOW_FACES_MAX];
    for (int i = 0; i < view->face_count; i++)
        is_seen[i] = see_ray(&view->faces[i], ray, begin, end, &rays[i]);
    out->count = 1;
    out->items[0] = (LitStretch){begin, begin, LIT_UNSURE};
    /* The faces see the ray one after the other. */
    for (;;) {
        int next = -1;
        for (int i = 0; i < view->face_count; i++)
            if (is_seen[i] && (next < 0 || rays[i].begin < rays[next].begin))
                next = i;
        if (next < 0)
            break;
        is_seen[next] = false;
        LitStretches found;
        follow(&view->faces[next], &rays[next], &found);
        add_stretch(out, rays[next].begin, LIT_UNSURE);
        for (int i = 0; i < found.count; i++)
            add_stretch(out, ray_t(&rays[next], found.items[i].end), found.items[i].state);
    }
    add_stretch(out, end, LIT_UNSURE);
}
