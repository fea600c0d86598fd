/* Expressions: the two grammars of the language.
 *
 *     full     = logic [ "?" full ":" full ]
 *     logic    = relation { ("&" | "|") relation }
 *     relation = short { ("<" | "<=" | "=" | "!=" | ">=" | ">") short } | text compare text
 *     short    = term { ("+" | "-") term }
 *     term     = factor { ("*" | "/") factor }
 *     factor   = ("+" | "-" | "!") factor | primary [ "." component ]
 *
 * A value is a list of one to five numbers; the shorter operand is widened to the longer.
 * Whole expressions in the language stand in parentheses only, so `short` is what most words
 * take.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"

#include <math.h>
#include <string.h>

static TokenKind operator_kind(Parser *p)
{
    return peek_operator(p)->kind;
}

static const char *terms_text(const Terms *terms)
{
    Value value = {.kind = VALUE_NUMBERS, .count = terms->count};
    return value_text(&value);
}

/* A float fills all terms; a vector is padded with 0. */
static void widen(Terms *terms, int count)
{
    for (int i = terms->count; i < count; i++)
        terms->n[i] = terms->count == 1 ? terms->n[0] : 0;
    if (terms->count < count)
        terms->count = count;
}

static bool is_near(double a, double b)
{
    return a == b || fabs(a - b) <= SDL_EPSILON;
}

static bool is_truth(double a)
{
    return !(fabs(a) <= SDL_EPSILON);
}

static double divide(Parser *p, double a, double b)
{
    if (b != 0)
        return a / b;
    parse_warn(p, WARN_VALUE, p->last, "division by 0, taken as infinite");
    return INFINITY;
}

static double operate(Parser *p, TokenKind op, double a, double b)
{
    switch (op) {
    case TOKEN_PLUS:
        return a + b;
    case TOKEN_MINUS:
        return a - b;
    case TOKEN_STAR:
        return a * b;
    case TOKEN_SLASH:
        return divide(p, a, b);
    case TOKEN_LESS:
        return a < b;
    case TOKEN_GREATER:
        return a > b;
    case TOKEN_LESS_EQUAL:
        return a < b || is_near(a, b);
    case TOKEN_GREATER_EQUAL:
        return a > b || is_near(a, b);
    case TOKEN_EQUAL:
        return is_near(a, b);
    case TOKEN_NOT_EQUAL:
        return !is_near(a, b);
    case TOKEN_AND:
        return is_truth(a) && is_truth(b);
    default:
        return is_truth(a) || is_truth(b);
    }
}

static void combine(Parser *p, TokenKind op, Terms *a, Terms *b)
{
    int count = a->count > b->count ? a->count : b->count;
    widen(a, count);
    widen(b, count);
    for (int i = 0; i < count; i++)
        a->n[i] = operate(p, op, a->n[i], b->n[i]);
}

/* --- primaries ----------------------------------------------------------------------------- */

static void parse_group(Parser *p, Terms *out)
{
    HoldState hold = hold_aside(p);
    parse_next(p);
    parse_full(p, out);
    parse_expect(p, TOKEN_RPAREN, "the expression");
    hold_restore(p, hold);
}

static void parse_vector(Parser *p, Terms *out)
{
    HoldState hold = hold_aside(p);
    Span begin = parse_next(p).span;
    int count = 0;
    while (!parse_accept(p, TOKEN_GREATER)) {
        if (count == 5)
            parse_fail(p, parse_peek(p)->span, "a vector has at most 5 components");
        out->n[count++] = parse_float(p);
        parse_comma(p);
    }
    if (count < 2)
        parse_fail(p, span_join(begin, p->last), "a vector has 2 to 5 components, this has %d",
                   count);
    out->count = count;
    hold_restore(p, hold);
}

static void parse_number_variable(Parser *p, Terms *out)
{
    Span begin = parse_peek(p)->span;
    const Value *value = parse_variable(p, NULL);
    if (value->kind == VALUE_FUNCTION) {
        parse_function_call(p, value, span_join(begin, p->last), out);
        return;
    }
    if (value->kind != VALUE_NUMBERS && value->kind != VALUE_COLOR)
        parse_fail(p, span_join(begin, p->last), "a float or vector wanted, found %s",
                   value_text(value));
    out->count = value->count;
    memcpy(out->n, value->n, sizeof out->n);
}

static noreturn void fail_no_operand(Parser *p)
{
    const Token *token = parse_peek(p);
    if (token_is_keyword(token->kind) && !keyword_has(token->kind))
        parse_fail_not_yet(p, token->span, keyword_text(token->kind));
    parse_fail(p, token->span, "a float or vector wanted, found %s", token_kind_text(token->kind));
}

static void parse_primary(Parser *p, Terms *out)
{
    const Token *token = parse_peek(p);
    if (token->kind == TOKEN_NUMBER) {
        out->count = 1;
        out->n[0] = parse_next(p).number;
    } else if (token->kind == TOKEN_IDENTIFIER) {
        parse_number_variable(p, out);
    } else if (token->kind == TOKEN_LESS) {
        parse_vector(p, out);
    } else if (token->kind == TOKEN_LPAREN) {
        parse_group(p, out);
    } else if (is_number_word(token->kind)) {
        parse_number_word(p, out);
    } else {
        fail_no_operand(p);
    }
}

static int component_index(TokenKind kind)
{
    switch ((int)kind) {
    case KW_X:
    case KW_U:
    case KW_RED:
        return 0;
    case KW_Y:
    case KW_V:
    case KW_GREEN:
        return 1;
    case KW_Z:
    case KW_BLUE:
        return 2;
    case KW_T:
    case KW_FILTER:
        return 3;
    case KW_TRANSMIT:
        return 4;
    default:
        return -1;
    }
}

static double gray_of(const Terms *terms)
{
    return 0.297 * terms->n[0] + 0.589 * terms->n[1] + 0.114 * terms->n[2];
}

/* `.x` and its like, after any primary. */
static void parse_component(Parser *p, Terms *out)
{
    parse_next(p);
    Token word = parse_next(p);
    bool is_gray = word.kind == KW_GRAY;
    int index = is_gray ? 2 : component_index(word.kind);
    if (index < 0)
        parse_fail(p, word.span,
                   "a component (x y z t u v red green blue filter transmit gray) "
                   "wanted after `.`, found %s",
                   word.kind == TOKEN_IDENTIFIER ? word.text : token_kind_text(word.kind));
    if (index >= out->count)
        parse_fail(p, word.span, "%s has no component `%s`", terms_text(out),
                   keyword_text(word.kind));
    out->n[0] = is_gray ? gray_of(out) : out->n[index];
    out->count = 1;
}

static void parse_factor(Parser *p, Terms *out)
{
    nest_enter(p);
    TokenKind sign = parse_peek(p)->kind;
    if (sign == TOKEN_MINUS || sign == TOKEN_PLUS || sign == TOKEN_NOT) {
        parse_next(p);
        parse_factor(p, out);
        for (int i = 0; i < out->count && sign != TOKEN_PLUS; i++)
            out->n[i] = sign == TOKEN_MINUS ? -out->n[i] : !is_truth(out->n[i]);
    } else {
        parse_primary(p, out);
        if (operator_kind(p) == TOKEN_DOT)
            parse_component(p, out);
    }
    nest_leave(p);
}

/* --- operators ----------------------------------------------------------------------------- */

static void term_after(Parser *p, Terms *out)
{
    TokenKind op;
    while ((op = operator_kind(p)) == TOKEN_STAR || op == TOKEN_SLASH) {
        Terms right;
        parse_next(p);
        parse_factor(p, &right);
        combine(p, op, out, &right);
    }
}

static void parse_term(Parser *p, Terms *out)
{
    parse_factor(p, out);
    term_after(p, out);
}

static void short_after(Parser *p, Terms *out)
{
    TokenKind op;
    while ((op = operator_kind(p)) == TOKEN_PLUS || op == TOKEN_MINUS) {
        Terms right;
        parse_next(p);
        parse_term(p, &right);
        combine(p, op, out, &right);
    }
}

void parse_short(Parser *p, Terms *out)
{
    parse_term(p, out);
    short_after(p, out);
}

void parse_short_after(Parser *p, Terms *first)
{
    if (operator_kind(p) == TOKEN_DOT)
        parse_component(p, first);
    term_after(p, first);
    short_after(p, first);
}

static bool is_comparison(TokenKind kind)
{
    return kind == TOKEN_LESS || kind == TOKEN_GREATER || kind == TOKEN_LESS_EQUAL ||
           kind == TOKEN_GREATER_EQUAL || kind == TOKEN_EQUAL || kind == TOKEN_NOT_EQUAL;
}

static void parse_text_comparison(Parser *p, Terms *out)
{
    Text left = parse_text(p);
    TokenKind op = operator_kind(p);
    if (!is_comparison(op))
        parse_fail(p, parse_peek(p)->span, "a comparison wanted after a string, found %s",
                   token_kind_text(op));
    parse_next(p);
    out->n[0] = operate(p, op, text_compare(left, parse_text(p)), 0);
    out->count = 1;
}

static void parse_relation(Parser *p, Terms *out)
{
    if (is_text_start(p)) {
        parse_text_comparison(p, out);
        return;
    }
    parse_short(p, out);
    TokenKind op;
    while (is_comparison(op = operator_kind(p))) {
        Terms right;
        parse_next(p);
        parse_short(p, &right);
        combine(p, op, out, &right);
    }
}

static void parse_logic(Parser *p, Terms *out)
{
    parse_relation(p, out);
    TokenKind op;
    while ((op = operator_kind(p)) == TOKEN_AND || op == TOKEN_OR) {
        Terms right;
        parse_next(p);
        parse_relation(p, &right);
        combine(p, op, out, &right);
    }
}

/* Both branches of `?` are evaluated; the result has the size of the one chosen. */
void parse_full(Parser *p, Terms *out)
{
    nest_enter(p);
    Span begin = parse_peek(p)->span;
    parse_logic(p, out);
    if (operator_kind(p) == TOKEN_QUESTION) {
        double condition = terms_float(p, out, begin, TOKEN_QUESTION);
        Terms otherwise;
        parse_next(p);
        parse_full(p, out);
        parse_expect(p, TOKEN_COLON, "the first choice of `?`");
        parse_full(p, &otherwise);
        if (!is_truth(condition))
            *out = otherwise;
    }
    nest_leave(p);
}

/* --- what readers ask for ------------------------------------------------------------------ */

/* `after`: the token before the expression, named in the message when it is a word. */
double terms_float(Parser *p, const Terms *terms, Span begin, TokenKind after)
{
    if (terms->count == 1)
        return terms->n[0];
    Span span = span_join(begin, p->last);
    if (token_is_keyword(after) || after == TOKEN_QUESTION)
        parse_fail(p, span, "%s wants a float, got %s", token_kind_text(after), terms_text(terms));
    parse_fail(p, span, "a float wanted, got %s", terms_text(terms));
}

V3 terms_v3(Parser *p, const Terms *terms, Span begin)
{
    if (terms->count > 3)
        parse_fail(p, span_join(begin, p->last), "a vector of 3 wanted, got %s", terms_text(terms));
    Terms wide = *terms;
    widen(&wide, 3);
    return v3(wide.n[0], wide.n[1], wide.n[2]);
}

double parse_float(Parser *p)
{
    TokenKind after = p->last_kind;
    Span begin = parse_peek(p)->span;
    Terms terms;
    parse_short(p, &terms);
    return terms_float(p, &terms, begin, after);
}

double parse_float_full(Parser *p)
{
    TokenKind after = p->last_kind;
    Span begin = parse_peek(p)->span;
    Terms terms;
    parse_full(p, &terms);
    return terms_float(p, &terms, begin, after);
}

double parse_condition(Parser *p)
{
    TokenKind word = p->last_kind;
    parse_expect(p, TOKEN_LPAREN, token_kind_text(word));
    Span begin = parse_peek(p)->span;
    Terms terms;
    parse_full(p, &terms);
    double value = terms_float(p, &terms, begin, word);
    parse_expect(p, TOKEN_RPAREN, "the expression");
    return value;
}

long parse_int(Parser *p, const char *what, long lowest, long highest)
{
    Span begin = parse_peek(p)->span;
    double value = trunc(parse_float(p));
    if (!(value >= (double)lowest && value <= (double)highest))
        parse_fail(p, span_join(begin, p->last), "%s must be %ld to %ld, not %g", what, lowest,
                   highest, value);
    return (long)value;
}

bool parse_flag(Parser *p)
{
    return parse_is_expression(p) ? parse_float(p) > 0 : true;
}

V3 parse_v3(Parser *p)
{
    Span begin = parse_peek(p)->span;
    Terms terms;
    parse_short(p, &terms);
    V3 value = terms_v3(p, &terms, begin);
    if (!v3_is_finite(value))
        parse_fail(p, span_join(begin, p->last), "<%g, %g, %g> is not finite", value.x, value.y,
                   value.z);
    return value;
}

V2 parse_v2(Parser *p)
{
    Span begin = parse_peek(p)->span;
    Terms terms;
    parse_short(p, &terms);
    Span span = span_join(begin, p->last);
    if (terms.count > 2)
        parse_fail(p, span, "a vector of 2 wanted, got %s", terms_text(&terms));
    widen(&terms, 2);
    if (!isfinite(terms.n[0]) || !isfinite(terms.n[1]))
        parse_fail(p, span, "<%g, %g> is not finite", terms.n[0], terms.n[1]);
    return (V2){terms.n[0], terms.n[1]};
}

bool parse_is_expression(Parser *p)
{
    const Token *token = parse_peek(p);
    switch (token->kind) {
    case TOKEN_NUMBER:
    case TOKEN_LPAREN:
    case TOKEN_LESS:
    case TOKEN_PLUS:
    case TOKEN_MINUS:
    case TOKEN_NOT:
        return true;
    case TOKEN_IDENTIFIER: {
        ValueKind kind = peek_value_kind(p);
        return kind == VALUE_NUMBERS || kind == VALUE_COLOR || kind == VALUE_FUNCTION;
    }
    default:
        return is_number_word(token->kind);
    }
}
