/* Surfaces given by an equation: coefficients of a polynomial, or exponents.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/read_int.h"

#include "math/roots.h"

Node *read_quadric(Parser *p)
{
    Span first = parse_peek(p)->span;
    V3 square = parse_v3(p);
    parse_comma(p);
    V3 mixed = parse_v3(p);
    parse_comma(p);
    V3 linear = parse_v3(p);
    parse_comma(p);
    double constant = read_finite(p, "the constant of a quadric", NULL);
    if (v3_max_abs(square) == 0 && v3_max_abs(mixed) == 0 && v3_max_abs(linear) == 0)
        parse_warn(p, WARN_GEOMETRY, span_join(first, parse_last_span(p)),
                   "all coefficients but the last are 0: it is not seen");
    return read_leaf(p, shape_quadric(parse_arena(p), square, mixed, linear, constant));
}

/* Exponents that povray takes without a word, and what is nearest to them. */
#define EXPONENT_MIN 1e-6
#define EXPONENT_MAX 100

Node *read_superellipsoid(Parser *p)
{
    Span first = parse_peek(p)->span;
    V2 v = parse_v2(p);
    Span span = span_join(first, parse_last_span(p));
    double e = num_min(num_max(v.u, EXPONENT_MIN), EXPONENT_MAX);
    double n = num_min(num_max(v.v, EXPONENT_MIN), EXPONENT_MAX);
    if (e != v.u || n != v.v)
        parse_warn(p, WARN_GEOMETRY, span,
                   "the exponents of a superellipsoid go from %g to %g: %g and %g are used",
                   EXPONENT_MIN, (double)EXPONENT_MAX, e, n);
    return read_leaf(p, shape_superellipsoid(parse_arena(p), e, n));
}

/* Make the leaf; a polynomial that is 0 or constant has no surface. */
static Node *poly_leaf(Parser *p, Span span, int degree, const double *c)
{
    bool has_term = false;
    for (int i = 0; i < poly_term_count(degree) - 1; i++)
        has_term |= c[i] != 0;
    if (!has_term) {
        parse_warn(p, WARN_GEOMETRY, span, "all coefficients but the last are 0: it is not seen");
        return read_empty(p);
    }
    return read_leaf(p, shape_poly(parse_arena(p), degree, c));
}

/* Read the coefficients between < and >. */
static Node *read_coefficients(Parser *p, int degree, const char *what)
{
    int count = poly_term_count(degree);
    double *c = parse_alloc(p, (size_t)count * sizeof *c);
    Span begin = parse_expect(p, TOKEN_LESS, what).span;
    for (int i = 0; i < count; i++) {
        if (parse_peek(p)->kind == TOKEN_GREATER)
            parse_fail(p, parse_peek(p)->span, "%d coefficients wanted, got %d", count, i);
        c[i] = read_finite(p, "a coefficient", NULL);
        parse_comma(p);
    }
    if (parse_peek(p)->kind != TOKEN_GREATER)
        parse_fail(p, parse_peek(p)->span, "`>` wanted after %d coefficients", count);
    parse_next(p);
    return poly_leaf(p, span_join(begin, parse_last_span(p)), degree, c);
}

Node *read_cubic(Parser *p)
{
    return read_coefficients(p, 3, "`cubic {`");
}

Node *read_quartic(Parser *p)
{
    return read_coefficients(p, 4, "`quartic {`");
}

static int read_degree(Parser *p)
{
    return (int)parse_int(p, "the degree of a polynomial", 2, ROOTS_DEGREE_MAX);
}

Node *read_poly(Parser *p)
{
    int degree = read_degree(p);
    parse_comma(p);
    return read_coefficients(p, degree, "the degree");
}

/* Read xyz(i, j, k): value. */
static void read_monomial(Parser *p, int degree, double *c)
{
    parse_expect(p, KW_XYZ, "the degree");
    Span begin = parse_expect(p, TOKEN_LPAREN, "`xyz`").span;
    int power[3];
    for (int i = 0; i < 3; i++) {
        power[i] = (int)parse_int(p, "a power", 0, degree);
        parse_comma(p);
    }
    parse_expect(p, TOKEN_RPAREN, "the powers of x, y and z");
    int sum = power[0] + power[1] + power[2];
    if (sum > degree)
        parse_fail(p, span_join(begin, parse_last_span(p)),
                   "powers that add up to the degree %d at most wanted, got %d", degree, sum);
    parse_expect(p, TOKEN_COLON, "the powers of x, y and z");
    c[poly_term_index(degree, power[0], power[1], power[2])] =
        read_finite(p, "a coefficient", NULL);
    parse_comma(p);
}

Node *read_polynomial(Parser *p)
{
    Span begin = parse_peek(p)->span;
    int degree = read_degree(p);
    parse_comma(p);
    double *c = parse_alloc(p, (size_t)poly_term_count(degree) * sizeof *c);
    while (parse_peek(p)->kind == KW_XYZ)
        read_monomial(p, degree, c);
    return poly_leaf(p, span_join(begin, parse_last_span(p)), degree, c);
}
