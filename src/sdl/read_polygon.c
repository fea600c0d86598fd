/* polygon: loops of points in a plane.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/read_int.h"

#include "shape/polygon.h"

enum { POLYGON_POINTS_MAX = 100 * 1000 * 1000 };

/* Points as near as this, by the polygon's extent, are one. */
#define SAME_POINT 1e-10

static V3 *read_points(Parser *p, uint32_t *count, Span *span)
{
    Span first = parse_peek(p)->span;
    long wanted = parse_int(p, "the count of a polygon", 3, POLYGON_POINTS_MAX);
    V3 *points = NULL;
    size_t capacity = 0;
    for (long i = 0; i < wanted; i++) {
        parse_comma(p);
        points = read_grow(p, points, (size_t)i, &capacity, sizeof *points);
        points[i] = parse_v3(p);
    }
    *count = (uint32_t)wanted;
    *span = span_join(first, parse_last_span(p));
    return points;
}

static double extent_of(const V3 *points, uint32_t count)
{
    Bound all = BOUND_EMPTY;
    for (uint32_t i = 0; i < count; i++)
        all = bound_add(all, points[i]);
    return v3_max_abs(v3_sub(all.hi, all.lo));
}

/* Join the points to loops, dropping those that close one; warns when the last is left open. */
static void join_loops(Parser *p, PolygonData *data, uint32_t count, Span span)
{
    double near = SAME_POINT * extent_of(data->points, count);
    uint32_t kept = 0, first = 0;
    for (uint32_t i = 0; i < count; i++) {
        V3 point = data->points[i];
        if (kept > first && v3_max_abs(v3_sub(point, data->points[first])) <= near) {
            data->next[kept - 1] = first;
            first = kept;
            continue;
        }
        data->points[kept] = point;
        data->next[kept] = kept + 1;
        kept++;
    }
    if (kept > first) {
        parse_warn(p, WARN_GEOMETRY, span, "the last loop of the polygon is not closed: closed");
        data->next[kept - 1] = first;
    }
    data->count = kept;
}

Node *read_polygon(Parser *p)
{
    Span span;
    uint32_t count;
    PolygonData *data = parse_alloc(p, sizeof *data);
    data->points = read_points(p, &count, &span);
    data->next = parse_alloc(p, count * sizeof *data->next);
    join_loops(p, data, count, span);
    bool is_flat;
    if (!polygon_prepare(parse_arena(p), data, &is_flat))
        parse_no_null(p, NULL);
    if (is_flat)
        return read_leaf(p, shape_polygon(parse_arena(p), data));
    parse_warn(p, WARN_GEOMETRY, span,
               "the points of the polygon are not in one plane, or on a line: it is not seen");
    return read_empty(p);
}
