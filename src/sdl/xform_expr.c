/* Transforms: translate, rotate, scale, matrix, transform.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"

#include <math.h>

enum { MATRIX_ROWS = 4, MATRIX_COLUMNS = 3 };

bool parse_is_xform(Parser *p)
{
    switch ((int)parse_peek(p)->kind) {
    case KW_TRANSLATE:
    case KW_ROTATE:
    case KW_SCALE:
    case KW_MATRIX:
    case KW_TRANSFORM:
        return true;
    default:
        return false;
    }
}

/* A factor of 0 would flatten everything: it becomes 1, as the language has it. */
static double scale_factor(Parser *p, double factor, Span span)
{
    if (factor != 0)
        return factor;
    parse_warn(p, WARN_VALUE, span, "a scale of 0 is taken as 1");
    return 1;
}

static Xform take_scale(Parser *p)
{
    Span begin = parse_peek(p)->span;
    V3 by = parse_v3(p);
    Span span = span_join(begin, p->last);
    by = v3(scale_factor(p, by.x, span), scale_factor(p, by.y, span), scale_factor(p, by.z, span));
    return xform_scale(by);
}

/* Twelve numbers, by rows: the images of x, y and z, then the translation. */
static Xform take_matrix(Parser *p)
{
    double to[3][4];
    Span begin = parse_expect(p, TOKEN_LESS, "`matrix`").span;
    for (int row = 0; row < MATRIX_ROWS; row++)
        for (int column = 0; column < MATRIX_COLUMNS; column++) {
            to[column][row] = parse_float(p);
            if (!isfinite(to[column][row]))
                parse_fail(p, p->last, "a number of this matrix is %g", to[column][row]);
            parse_comma(p);
        }
    parse_expect(p, TOKEN_GREATER, "the twelve numbers of the matrix");
    Xform xform;
    if (!xform_from_matrix((const double(*)[4])to, &xform))
        parse_fail(p, span_join(begin, p->last), "this matrix is singular: it has no inverse");
    return xform;
}

static bool take_named(Parser *p, Xform *out)
{
    const Value *value = parse_accept_value(p, VALUE_TRANSFORM);
    if (value)
        *out = *(const Xform *)value->node;
    return value != NULL;
}

/* transform { items }: `inverse` turns the whole round, wherever it stands. */
static Xform take_block(Parser *p)
{
    Xform all = XFORM_IDENTITY, item;
    bool is_inverse = false;
    while (!parse_accept(p, TOKEN_RBRACE)) {
        if (parse_accept(p, KW_INVERSE)) {
            is_inverse = true;
            continue;
        }
        if (parse_is_xform(p))
            item = parse_xform(p);
        else if (!take_named(p, &item))
            parse_fail_here(p, "in a transform");
        all = xform_then(&all, &item);
    }
    return is_inverse ? xform_inverse(&all) : all;
}

static Xform take_transform(Parser *p)
{
    Xform xform;
    if (parse_accept(p, TOKEN_LBRACE))
        return take_block(p);
    if (!take_named(p, &xform))
        parse_fail_here(p, "after `transform`");
    return xform;
}

Xform parse_xform(Parser *p)
{
    Token word = parse_next(p);
    switch ((int)word.kind) {
    case KW_TRANSLATE:
        return xform_translate(parse_v3(p));
    case KW_ROTATE:
        return xform_rotate(v3_scale(parse_v3(p), PMS_PI / 180));
    case KW_SCALE:
        return take_scale(p);
    case KW_MATRIX:
        return take_matrix(p);
    default:
        return take_transform(p);
    }
}
