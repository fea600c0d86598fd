/* isosurface { function { ... } ... }
 *
 * No max_gradient is needed.  One that is given is compared with slopes found near the surface,
 * since other programs would miss the surface where it is too small.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"
#include "sdl/read_int.h"

#include <math.h>

/* Points along each side of the container where slopes are looked at. */
enum { SLOPE_POINTS = 24 };

typedef struct IsosurfaceItems {
    const Func *func;
    const Shape *container;
    double threshold;
    double max_gradient; /* 0: not given */
    Span gradient;
    bool is_open;
} IsosurfaceItems;

static const Func *read_surface_function(Parser *p)
{
    Value value;
    Span span = parse_peek(p)->span;
    parse_function(p, &value);
    span = span_join(span, parse_last_span(p));
    const Func *func = function_code(p, &value, span);
    if (func->param_count != 3)
        parse_fail(p, span, "an isosurface wants a function of 3 parameters, this has %d",
                   func->param_count);
    return func;
}

/* evaluate F, F, F: how other programs find out about the gradient. */
static void skip_evaluate(Parser *p)
{
    for (int i = 0; i < 3; i++) {
        parse_float(p);
        parse_comma(p);
    }
}

static bool read_item(Parser *p, IsosurfaceItems *items)
{
    Span span;
    if (parse_peek(p)->kind == KW_FUNCTION)
        items->func = read_surface_function(p);
    else if (parse_peek(p)->kind == KW_CONTAINED_BY)
        items->container = read_container(p);
    else if (parse_accept(p, KW_THRESHOLD))
        items->threshold = read_finite(p, "the threshold of an isosurface", NULL);
    else if (parse_accept(p, KW_ACCURACY))
        read_positive(p, "the accuracy of an isosurface", &span);
    else if (parse_accept(p, KW_MAX_GRADIENT))
        items->max_gradient =
            read_positive(p, "the max_gradient of an isosurface", &items->gradient);
    else if (parse_accept(p, KW_EVALUATE))
        skip_evaluate(p);
    else if (parse_accept(p, KW_MAX_TRACE))
        read_positive(p, "the max_trace of an isosurface", &span);
    else if (parse_accept(p, KW_OPEN))
        items->is_open = true;
    else
        return parse_accept(p, KW_ALL_INTERSECTIONS);
    return true;
}

/* Return the largest slope of the function at points of a grid whose cell may hold surface. */
static double steepest(const IsosurfaceItems *items)
{
    const Bound box = shape_bound(items->container);
    V3 cell = v3_scale(v3_sub(box.hi, box.lo), 1.0 / SLOPE_POINTS);
    double most = 0, reach = v3_len(cell);
    for (int i = 0; i < SLOPE_POINTS * SLOPE_POINTS * SLOPE_POINTS; i++) {
        V3 at = v3(i % SLOPE_POINTS + 0.5, i / SLOPE_POINTS % SLOPE_POINTS + 0.5,
                   (double)(i / (SLOPE_POINTS * SLOPE_POINTS)) + 0.5);
        V3 p = v3_add(box.lo, v3_mul(at, cell)), gradient;
        double value = func_gradient(items->func, (double[]){p.x, p.y, p.z}, &gradient);
        double slope = v3_len(gradient);
        if (isfinite(slope) && fabs(value - items->threshold) < slope * reach)
            most = fmax(most, slope);
    }
    return most;
}

/* POV-Ray tells of what is off by a tenth. */
static void check_gradient(Parser *p, const IsosurfaceItems *items)
{
    double most = items->max_gradient > 0 ? steepest(items) : 0;
    if (most > 1.1 * items->max_gradient)
        parse_warn(p, WARN_GEOMETRY, items->gradient,
                   "max_gradient is %g, but the function has slopes of %.3g: programs that rely on "
                   "it miss some of the surface; pms does not",
                   items->max_gradient, most);
}

Node *read_isosurface(Parser *p)
{
    IsosurfaceItems items = {.func = NULL};
    Span first = parse_peek(p)->span;
    while (read_item(p, &items))
        parse_comma(p);
    if (!items.func)
        parse_fail(p, first, "an isosurface wants a function");
    if (!items.container)
        items.container = parse_no_null(p, shape_box(parse_arena(p), v3(-1, -1, -1), v3(1, 1, 1)));
    check_gradient(p, &items);
    return read_leaf(p, shape_isosurface(parse_arena(p), items.func, items.threshold,
                                         items.container, items.is_open));
}
