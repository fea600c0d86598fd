/* isosurface { function { ... } ... }
 *
 * No max_gradient is needed.  One that is given is compared with slopes in the cells that hold
 * surface, since other programs would miss the surface where it is too small.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"
#include "sdl/read_int.h"

#include <math.h>

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

/* POV-Ray tells of what is off by a tenth. */
static void check_gradient(Parser *p, const IsosurfaceItems *items, const Shape *shape)
{
    double most = items->max_gradient > 0 ? shape_isosurface_steepest(shape) : 0;
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
    const Shape *shape =
        parse_no_null(p, shape_isosurface(parse_arena(p), items.func, items.threshold,
                                          items.container, items.is_open));
    check_gradient(p, &items, shape);
    return read_leaf(p, shape);
}
