/* parametric { function { ... }, function { ... }, function { ... } <u, v>, <u, v> ... }, and the
 * container it has in common with isosurfaces.
 *
 * No max_gradient or accuracy is needed.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"
#include "sdl/read_int.h"

enum { PRECOMPUTE_MAX = 20 };

/* contained_by: { box { ... } } or { sphere { ... } } */
const Shape *read_container(Parser *p)
{
    read_open(p);
    Token word = *parse_peek(p);
    bool is_sphere = word.kind == KW_SPHERE;
    if (!is_sphere && word.kind != KW_BOX)
        parse_fail(p, word.span, "contained_by wants box or sphere, found %s",
                   token_kind_text(word.kind));
    read_open(p);
    V3 first = parse_v3(p);
    parse_comma(p);
    Shape *shape = NULL;
    if (is_sphere) {
        Span span;
        double radius = read_finite(p, "the radius of the container", &span);
        if (!(radius > 0))
            parse_fail(p, span, "the radius of the container must be above 0, not %g", radius);
        shape = parse_no_null(p, shape_sphere(parse_arena(p), first, radius));
    } else {
        V3 second = parse_v3(p);
        V3 size = v3_sub(first, second);
        if (size.x == 0 || size.y == 0 || size.z == 0)
            parse_fail(p, parse_last_span(p), "the box of the container has no volume");
        shape = parse_no_null(p, shape_box(parse_arena(p), first, second));
    }
    parse_expect(p, TOKEN_RBRACE, "the container");
    parse_expect(p, TOKEN_RBRACE, "the container");
    return shape;
}

double read_positive(Parser *p, const char *what, Span *span)
{
    double value = read_finite(p, what, span);
    if (!(value > 0))
        parse_warn(p, WARN_GEOMETRY, *span, "%s must be above 0, not %g: it is not used", what,
                   value);
    return value > 0 ? value : 0;
}

static const Func *read_coordinate(Parser *p)
{
    Value value;
    if (parse_peek(p)->kind != KW_FUNCTION)
        parse_fail_here(p, "in `parametric`, which wants a function for each of x, y and z first");
    Span span = parse_peek(p)->span;
    parse_function(p, &value);
    span = span_join(span, parse_last_span(p));
    const Func *func = function_code(p, &value, span);
    if (func->param_count < 2 || func->param_count > 3)
        parse_fail(p, span, "a parametric wants functions of u and v, this has %d parameter%s",
                   func->param_count, func->param_count == 1 ? "" : "s");
    parse_comma(p);
    return func;
}

/* precompute N, x, y, z: how other programs save time. */
static void skip_precompute(Parser *p)
{
    parse_int(p, "the depth of precompute", 1, PRECOMPUTE_MAX);
    parse_comma(p);
    while (parse_accept(p, KW_X) || parse_accept(p, KW_Y) || parse_accept(p, KW_Z))
        parse_comma(p);
}

static bool read_item(Parser *p, const Shape **container)
{
    Span span;
    if (parse_peek(p)->kind == KW_CONTAINED_BY)
        *container = read_container(p);
    else if (parse_accept(p, KW_ACCURACY))
        read_positive(p, "the accuracy of a parametric", &span);
    else if (parse_accept(p, KW_MAX_GRADIENT))
        read_positive(p, "the max_gradient of a parametric", &span);
    else if (parse_accept(p, KW_PRECOMPUTE))
        skip_precompute(p);
    else
        return false;
    return true;
}

static void sort(double *a, double *b)
{
    double lo = *a < *b ? *a : *b, hi = *a < *b ? *b : *a;
    *a = lo;
    *b = hi;
}

/* Read two corners of the parameters' rectangle, in any order; false when it has no area. */
static bool read_domain(Parser *p, V2 *lo, V2 *hi)
{
    Span begin = parse_peek(p)->span;
    *lo = parse_v2(p);
    parse_comma(p);
    *hi = parse_v2(p);
    Span span = span_join(begin, parse_last_span(p));
    sort(&lo->u, &hi->u);
    sort(&lo->v, &hi->v);
    if (!isfinite(lo->u) || !isfinite(lo->v) || !isfinite(hi->u) || !isfinite(hi->v))
        parse_fail(p, span, "the range of a parametric must be finite");
    bool has_area = lo->u < hi->u && lo->v < hi->v;
    if (!has_area)
        parse_warn(p, WARN_GEOMETRY, span, "the parametric has no range of u or v: it is not seen");
    return has_area;
}

static FuncTriple join(Parser *p, const Func *const parts[3], Span span)
{
    FuncTriple all;
    if (!func_join(parse_arena(p), parts, &all))
        parse_fail(p, span, "the functions are too long together (limit %d steps and constants)",
                   FUNC_SLOTS_MAX);
    parse_no_null(p, all.func);
    return all;
}

Node *read_parametric(Parser *p)
{
    Span begin = parse_peek(p)->span;
    const Func *parts[3];
    for (int i = 0; i < 3; i++)
        parts[i] = read_coordinate(p);
    FuncTriple func = join(p, parts, span_join(begin, parse_last_span(p)));
    V2 lo, hi;
    bool has_area = read_domain(p, &lo, &hi);
    const Shape *container = NULL;
    do {
        parse_comma(p);
    } while (read_item(p, &container));
    if (!container)
        container = parse_no_null(p, shape_box(parse_arena(p), v3(-1, -1, -1), v3(1, 1, 1)));
    return has_area ? read_leaf(p, shape_parametric(parse_arena(p), &func, lo, hi, container))
                    : read_empty(p);
}
