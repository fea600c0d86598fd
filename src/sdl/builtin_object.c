/* Built-in functions that ask declared objects about their shape.
 *
 * The shape of an object is made when it is first asked, and kept for the next question.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"

#include <math.h>

/* A ray that `trace` sends meets nothing nearer than this, and what has no end is said to end at
 * that: absolute, because the language says so. */
#define TRACE_NEAREST 1e-4
#define EXTENT_MOST 1e10

static const AskedShape *find_shape(Parser *p, const Node *node)
{
    for (int i = 0; i < ASKED_SHAPES; i++)
        if (p->asked[i].node == node)
            return &p->asked[i];
    AskedShape *place = &p->asked[p->asked_count++ % ASKED_SHAPES];
    const Node *own = parse_no_null(p, node_copy(p->arena, node));
    Shape *shape = parse_no_null(p, node_shape(p->arena, own));
    shape_finish(p->arena, shape);
    *place = (AskedShape){node, shape};
    return place;
}

/* Take the name of an object, and return its shape. */
static const Shape *take_object(Parser *p, TokenKind word, bool is_solid)
{
    Span span = parse_peek(p)->span;
    const Value *value = parse_accept_value(p, VALUE_OBJECT);
    if (!value)
        parse_fail(p, span, "`%s` wants the name of an object", keyword_text(word));
    const Node *node = value->node;
    if (node->kind == NODE_LIGHT)
        parse_fail(p, value->span, "`%s` wants an object with a shape, this is a light",
                   keyword_text(word));
    if (is_solid && !node_is_solid(node))
        parse_fail(p, value->span, "`%s` wants a solid object, this has no inside",
                   keyword_text(word));
    return find_shape(p, node)->shape;
}

static V3 vector_argument(Parser *p)
{
    parse_comma(p);
    return parse_v3(p);
}

/* The variable that a normal goes to. */
static Value *take_normal_variable(Parser *p)
{
    if (!parse_accept(p, TOKEN_COMMA))
        return NULL;
    Span span = parse_peek(p)->span;
    bool is_name = parse_peek(p)->kind == TOKEN_IDENTIFIER;
    Value *value = is_name ? parse_variable(p, NULL) : NULL;
    if (!value || value->kind != VALUE_NUMBERS)
        parse_fail(p, span, "`trace` wants the name of a vector for the normal");
    return value;
}

static void set_vector(double n[5], V3 v)
{
    n[0] = v.x;
    n[1] = v.y;
    n[2] = v.z;
}

static void call_trace(Parser *p, Terms *out)
{
    const Shape *shape = take_object(p, KW_TRACE, false);
    V3 origin = vector_argument(p), direction = v3_unit(vector_argument(p)), normal = v3(0, 0, 0);
    Value *variable = take_normal_variable(p);
    Ray ray = {origin, direction, TRACE_NEAREST, INFINITY};
    Crossing hit;
    ShapePoint point = {.p = v3(0, 0, 0)};
    bool is_ray = v3_len2(direction) > 0;
    if (!p->shape_scratch)
        p->shape_scratch = shape_scratch_new();
    parse_no_null(p, p->shape_scratch);
    if (is_ray && shape_closest(shape, &ray, p->shape_scratch, &hit)) {
        shape_point(&hit, &ray, &point);
        normal = point.ns;
    }
    set_vector(out->n, point.p);
    out->count = 3;
    if (!variable)
        return;
    *variable = (Value){.kind = VALUE_NUMBERS, .count = 3, .span = variable->span};
    set_vector(variable->n, normal);
}

/* A number without the rounding that boxes are enlarged by. */
static double within_extent(double x, double size)
{
    double unit = size * 0x1p-44, round = size < EXTENT_MOST ? rint(x / unit) * unit : x;
    return fmin(fmax(isnan(round) ? x : round, -EXTENT_MOST), EXTENT_MOST) + 0.0;
}

static void call_extent(Parser *p, TokenKind word, Terms *out)
{
    Bound bound = shape_bound(take_object(p, word, false));
    V3 end = word == KW_MIN_EXTENT ? bound.lo : bound.hi;
    if (bound_is_empty(bound))
        end = v3(0, 0, 0);
    double size = fmax(v3_max_abs(bound.lo), v3_max_abs(bound.hi));
    set_vector(out->n, v3(within_extent(end.x, size), within_extent(end.y, size),
                          within_extent(end.z, size)));
    out->count = 3;
}

bool is_object_word(TokenKind word)
{
    return word == KW_TRACE || word == KW_INSIDE || word == KW_MIN_EXTENT || word == KW_MAX_EXTENT;
}

void parse_object_call(Parser *p, TokenKind word, Terms *out)
{
    if (word == KW_TRACE) {
        call_trace(p, out);
    } else if (word == KW_INSIDE) {
        const Shape *shape = take_object(p, word, true);
        out->n[0] = shape_is_inside(shape, vector_argument(p));
        out->count = 1;
    } else {
        call_extent(p, word, out);
    }
}
