/* The parameters of shapes made of curves: prism, lathe, sor, ovus, sphere_sweep.
 *
 * Points that the language takes for the same are made the same here, to the last bit, so that
 * spans meet in their knots.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/read_int.h"

#include "math/eps.h"

/* Points of a curve; more are a mistake. */
enum { CURVE_POINTS_MAX = 10000000 };

/* Take the word for a kind of spline, if one of these comes next. */
static bool read_spline_word(Parser *p, SplineKind *kind)
{
    if (parse_accept(p, KW_LINEAR_SPLINE))
        *kind = SPLINE_LINEAR;
    else if (parse_accept(p, KW_QUADRATIC_SPLINE))
        *kind = SPLINE_QUADRATIC;
    else if (parse_accept(p, KW_CUBIC_SPLINE))
        *kind = SPLINE_CUBIC;
    else if (parse_accept(p, KW_BEZIER_SPLINE))
        *kind = SPLINE_BEZIER;
    else
        return false;
    return true;
}

/* Read how many points there are, at least `least`. */
static int read_point_count(Parser *p, const char *what, int least)
{
    Span first = parse_peek(p)->span;
    long count = parse_int(p, what, -CURVE_POINTS_MAX, CURVE_POINTS_MAX);
    if (count < least)
        parse_fail(p, span_join(first, parse_last_span(p)), "%s wants at least %d, got %ld", what,
                   least, count);
    parse_comma(p);
    return (int)count;
}

/* Read the points of a curve in a plane.  The list grows as they are read: their number is only
 * what the scene says. */
static V2 *read_points(Parser *p, int count)
{
    V2 *points = NULL;
    size_t capacity = 0;
    for (int i = 0; i < count; i++) {
        if ((size_t)i == capacity)
            points = read_grow(p, points, (size_t)i, &capacity, sizeof *points);
        Span first = parse_peek(p)->span;
        points[i] = parse_v2(p);
        if (!isfinite(points[i].u) || !isfinite(points[i].v))
            parse_fail(p, span_join(first, parse_last_span(p)), "a point of a curve is not finite");
        parse_comma(p);
    }
    return points;
}

/* Write the spans of a run of points; returns how many. */
static uint32_t make_spans(SplineKind kind, const V2 *points, int count, CurveSpan *out)
{
    int spans = spline_span_count(kind, count);
    for (int i = 0; i < spans; i++) {
        spline_span(kind, &points->u, 2, i, out[i].a);
        spline_span(kind, &points->v, 2, i, out[i].b);
    }
    return (uint32_t)spans;
}

/* --- prism --------------------------------------------------------------------------------- */

static bool is_same(V2 a, V2 b)
{
    return fabs(a.u - b.u) <= EPS_LANGUAGE && fabs(a.v - b.v) <= EPS_LANGUAGE;
}

/* Find the point that closes the loop which starts at points[start], and make it that point;
 * returns its number, or -1. */
static int close_loop(SplineKind kind, V2 *points, int start, int count)
{
    bool is_bezier = kind == SPLINE_BEZIER;
    for (int i = start + (is_bezier ? 3 : 1); i < count; i += is_bezier ? 4 : 1) {
        if (is_same(points[i], points[start])) {
            points[i] = points[start];
            return i;
        }
        if (!is_bezier || i + 1 == count)
            continue;
        if (!is_same(points[i + 1], points[i]))
            return -1;
        points[i + 1] = points[i];
    }
    return -1;
}

/* Make the spans of all loops; returns how many, or 0 if one is not closed. */
static uint32_t make_loops(Parser *p, Span span, SplineKind kind, V2 *points, int count,
                           CurveSpan *out)
{
    bool is_free = kind == SPLINE_LINEAR || kind == SPLINE_BEZIER;
    int before = is_free ? 0 : 1, after = kind == SPLINE_CUBIC ? 1 : 0;
    uint32_t made = 0;
    for (int first = 0; first < count;) {
        int start = first + before;
        int end = start < count ? close_loop(kind, points, start, count) : -1;
        if (end < 0 && kind == SPLINE_LINEAR) {
            parse_warn(p, WARN_GEOMETRY, span,
                       "a loop of a prism is not closed: it gets one more side");
            made += make_spans(kind, points + first, count - first, out + made);
            V2 ends[2] = {points[count - 1], points[first]};
            return made + make_spans(kind, ends, 2, out + made);
        }
        if (end < 0 || end + after >= count) {
            parse_warn(p, WARN_GEOMETRY, span, "a loop of a prism is not closed: it is not seen");
            return 0;
        }
        int last = end + after;
        made += make_spans(kind, points + first, last - first + 1, out + made);
        first = last + 1;
    }
    return made;
}

Node *read_prism(Parser *p)
{
    SplineKind kind = SPLINE_LINEAR;
    PrismForm form = {.is_conic = false};
    for (;;) {
        if (parse_accept(p, KW_CONIC_SWEEP))
            form.is_conic = true;
        else if (parse_accept(p, KW_LINEAR_SWEEP))
            form.is_conic = false;
        else if (!read_spline_word(p, &kind))
            break;
    }
    double a = read_finite(p, "a height of a prism", NULL);
    parse_comma(p);
    double b = read_finite(p, "a height of a prism", NULL);
    parse_comma(p);
    form.lo = a < b ? a : b;
    form.hi = a < b ? b : a;
    Span first = parse_peek(p)->span;
    /* A curve that bends wants a control point before its loop, or after it, too. */
    static const int least[] = {3, 5, 6, 4};
    int count = read_point_count(p, "the number of points of a prism", least[kind]);
    if (kind == SPLINE_BEZIER && count % 4)
        parse_fail(p, first, "the points of a bezier_spline come in fours, got %d", count);
    V2 *points = read_points(p, count);
    Span span = span_join(first, parse_last_span(p));
    form.is_open = parse_accept(p, KW_OPEN);
    CurveSpan *spans = parse_alloc(p, ((size_t)count + 1) * sizeof *spans);
    form.span_count = make_loops(p, span, kind, points, count, spans);
    if (form.span_count == 0)
        return read_empty(p);
    form.spans = spans;
    form.degree = spline_degree(kind);
    return read_leaf(p, shape_prism(parse_arena(p), &form));
}

/* --- lathe and sor ------------------------------------------------------------------------- */

Node *read_lathe(Parser *p)
{
    SplineKind kind = SPLINE_LINEAR;
    read_spline_word(p, &kind);
    Span first = parse_peek(p)->span;
    int count = read_point_count(p, "the number of points of a lathe", spline_points_min(kind));
    if (kind == SPLINE_BEZIER && count % 4)
        parse_fail(p, first, "the points of a bezier_spline come in fours, got %d", count);
    first = parse_peek(p)->span;
    V2 *points = read_points(p, count);
    Span span = span_join(first, parse_last_span(p));
    for (int i = 1; i + 1 < count; i++)
        if (points[i].u < 0)
            parse_fail(p, span, "radius %d of a lathe is negative: %g", i + 1, points[i].u);
    for (int i = 4; kind == SPLINE_BEZIER && i < count; i += 4)
        if (is_same(points[i], points[i - 1]))
            points[i] = points[i - 1];
    int before = kind == SPLINE_QUADRATIC || kind == SPLINE_CUBIC, after = kind == SPLINE_CUBIC;
    if (is_same(points[count - 1 - after], points[before]))
        points[count - 1 - after] = points[before];
    CurveSpan *spans = parse_alloc(p, (size_t)count * sizeof *spans);
    uint32_t span_count = make_spans(kind, points, count, spans);
    Arena *arena = parse_arena(p);
    return read_leaf(p, shape_lathe(arena, spline_degree(kind), spans, span_count));
}

Node *read_sor(Parser *p)
{
    int count = read_point_count(p, "the number of points of a sor", 4);
    Span first = parse_peek(p)->span;
    V2 *points = read_points(p, count);
    Span span = span_join(first, parse_last_span(p));
    for (int i = 0; i < count; i++) {
        if (points[i].u < 0)
            parse_fail(p, span, "radius %d of a sor is negative: %g", i + 1, points[i].u);
        if (i > 1 && i + 1 < count && !(points[i].v > points[i - 1].v))
            parse_fail(p, span, "height %d of a sor is not above the one before it", i + 1);
        if (i > 1 && !(fabs(points[i].v - points[i - 2].v) >= EPS_LANGUAGE))
            parse_fail(p, span, "heights %d and %d of a sor are the same", i - 1, i + 1);
    }
    bool is_open = parse_accept(p, KW_OPEN);
    return read_leaf(p, shape_sor(parse_arena(p), points, count, is_open));
}

Node *read_ovus(Parser *p)
{
    Span first = parse_peek(p)->span;
    double bottom = read_not_negative(p, "the lower radius of an ovus");
    parse_comma(p);
    double top = read_not_negative(p, "the upper radius of an ovus");
    Span span = span_join(first, parse_last_span(p));
    if (top >= 2 * bottom && top > 0) {
        parse_warn(p, WARN_GEOMETRY, span,
                   "the upper radius of an ovus is at least twice the lower: it is a sphere");
        return read_leaf(p, shape_sphere(parse_arena(p), v3(0, bottom, 0), top));
    }
    if (!(bottom > 0)) {
        parse_warn(p, WARN_GEOMETRY, span, "both radii of an ovus are 0");
        return read_empty(p);
    }
    return read_leaf(p, shape_ovus(parse_arena(p), bottom, top));
}

/* --- sphere_sweep -------------------------------------------------------------------------- */

/* One ball of a sweep as it is written. */
typedef struct Ball {
    double n[4]; /* centre, radius */
} Ball;

static Ball *read_balls(Parser *p, int count)
{
    Ball *balls = NULL;
    size_t capacity = 0;
    for (int i = 0; i < count; i++) {
        if ((size_t)i == capacity)
            balls = read_grow(p, balls, (size_t)i, &capacity, sizeof *balls);
        V3 c = parse_v3(p);
        parse_comma(p);
        double radius = read_finite(p, "a radius of a sphere_sweep", NULL);
        parse_comma(p);
        balls[i] = (Ball){{c.x, c.y, c.z, radius}};
    }
    return balls;
}

/* Read which spline a sweep follows. */
static SplineKind read_sweep_word(Parser *p)
{
    if (parse_accept(p, KW_LINEAR_SPLINE))
        return SPLINE_LINEAR;
    if (parse_accept(p, KW_B_SPLINE))
        return SPLINE_B;
    if (parse_accept(p, KW_CUBIC_SPLINE))
        return SPLINE_CUBIC;
    parse_fail_here(p, "in a sphere_sweep, which wants linear_spline, b_spline or cubic_spline");
}

Node *read_sphere_sweep(Parser *p)
{
    SplineKind kind = read_sweep_word(p);
    parse_comma(p);
    int count =
        read_point_count(p, "the number of spheres of a sphere_sweep", spline_points_min(kind));
    Ball *balls = read_balls(p, count);
    if (parse_accept(p, KW_TOLERANCE)) {
        read_finite(p, "tolerance", NULL);
        parse_comma(p);
    }
    int span_count = spline_span_count(kind, count);
    SweepSpan *spans = parse_alloc(p, (size_t)span_count * sizeof *spans);
    for (int i = 0; i < span_count; i++) {
        for (int axis = 0; axis < 3; axis++)
            spline_span(kind, &balls->n[axis], 4, i, spans[i].c[axis]);
        spline_span(kind, &balls->n[3], 4, i, spans[i].r);
    }
    return read_leaf(
        p, shape_sphere_sweep(parse_arena(p), spline_degree(kind), spans, (uint32_t)span_count));
}
