/* julia_fractal { C ... }  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"
#include "sdl/read_int.h"

#include <math.h>

enum { ITERATIONS_MAX = 10000 };

#define PRECISION_MAX 1e6

/* Read four numbers in brackets, or one for all. */
static void read_four(Parser *p, const char *what, double out[4])
{
    Span begin = parse_peek(p)->span;
    Terms terms;
    parse_short(p, &terms);
    Span span = span_join(begin, parse_last_span(p));
    if (terms.count != 1 && terms.count != 4)
        parse_fail(p, span, "%s wants a vector of 4, got one of %d", what, terms.count);
    for (int i = 0; i < 4; i++) {
        out[i] = terms.n[terms.count == 1 ? 0 : i];
        if (!isfinite(out[i]))
            parse_fail(p, span, "%s is not finite", what);
    }
}

/* Return the function a word names, or false. */
static bool function_of(TokenKind word, JuliaFunction *out)
{
    static const struct {
        TokenKind word;
        JuliaFunction function;
    } table[] = {
        {KW_SQR, JULIA_SQR},     {KW_CUBE, JULIA_CUBE},   {KW_EXP, JULIA_EXP},
        {KW_SIN, JULIA_SIN},     {KW_ASIN, JULIA_ASIN},   {KW_SINH, JULIA_SINH},
        {KW_ASINH, JULIA_ASINH}, {KW_COS, JULIA_COS},     {KW_ACOS, JULIA_ACOS},
        {KW_COSH, JULIA_COSH},   {KW_ACOSH, JULIA_ACOSH}, {KW_TAN, JULIA_TAN},
        {KW_ATAN, JULIA_ATAN},   {KW_TANH, JULIA_TANH},   {KW_ATANH, JULIA_ATANH},
        {KW_LN, JULIA_LN},       {KW_PWR, JULIA_PWR},     {KW_RECIPROCAL, JULIA_RECIPROCAL}};
    for (size_t i = 0; i < sizeof table / sizeof *table; i++)
        if (table[i].word == word) {
            *out = table[i].function;
            return true;
        }
    return false;
}

/* pwr(X, Y) */
static void read_power(Parser *p, double power[2])
{
    parse_expect(p, TOKEN_LPAREN, "pwr");
    power[0] = read_finite(p, "the exponent of pwr", NULL);
    parse_comma(p);
    power[1] = read_finite(p, "the exponent of pwr", NULL);
    parse_expect(p, TOKEN_RPAREN, "the exponent");
}

static void read_slice(Parser *p, JuliaForm *form)
{
    Span begin = parse_peek(p)->span;
    read_four(p, "the normal of a slice", form->slice);
    Span span = span_join(begin, parse_last_span(p));
    double *n = form->slice;
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] + n[3] * n[3]);
    if (!(fabs(n[3]) > 1e-10 * length))
        parse_fail(p, span, "the fourth part of a slice's normal is 0: it has no w for x, y and z");
    for (int i = 0; i < 4; i++)
        n[i] /= length;
    parse_comma(p);
    form->slice_distance = read_finite(p, "the distance of a slice", NULL);
}

/* Read a number that is 1 at least: less is taken for that, as in POV-Ray. */
static double read_least_one(Parser *p, const char *what, double most)
{
    Span span;
    double value = read_finite(p, what, &span);
    if (value > most)
        parse_fail(p, span, "%s is at most %g, not %g", what, most, value);
    if (value < 1)
        parse_warn(p, WARN_GEOMETRY, span, "%s is %g: 1 is used", what, value);
    return fmax(value, 1);
}

static bool read_item(Parser *p, JuliaForm *form)
{
    if (function_of(parse_peek(p)->kind, &form->function)) {
        if (parse_next(p).kind == KW_PWR)
            read_power(p, form->power);
    } else if (parse_accept(p, KW_QUATERNION)) {
        form->is_hypercomplex = false;
    } else if (parse_accept(p, KW_HYPERCOMPLEX)) {
        form->is_hypercomplex = true;
    } else if (parse_accept(p, KW_MAX_ITERATION)) {
        form->iterations =
            (int)read_least_one(p, "max_iteration of a julia_fractal", ITERATIONS_MAX);
    } else if (parse_accept(p, KW_PRECISION)) {
        form->precision = read_least_one(p, "the precision of a julia_fractal", PRECISION_MAX);
    } else if (parse_accept(p, KW_SLICE)) {
        read_slice(p, form);
    } else {
        return false;
    }
    return true;
}

Node *read_julia_fractal(Parser *p)
{
    JuliaForm form = {.c = {1, 0, 0, 0}, .iterations = 20, .precision = 20, .slice = {0, 0, 0, 1}};
    Span first = parse_peek(p)->span;
    if (parse_is_expression(p) && !function_of(parse_peek(p)->kind, &form.function))
        read_four(p, "the parameter of a julia_fractal", form.c);
    parse_comma(p);
    while (read_item(p, &form))
        parse_comma(p);
    if (!form.is_hypercomplex && form.function > JULIA_CUBE)
        parse_fail(p, span_join(first, parse_last_span(p)),
                   "quaternions have sqr and cube only; the others are for hypercomplex");
    return read_leaf(p, shape_julia(parse_arena(p), &form));
}
