/* function { ... }: its own grammar of expressions, made into code.
 *
 *     f_full     = f_and { "|" f_and }
 *     f_and      = f_relation { "&" f_relation }
 *     f_relation = f_sum { ("<" | "<=" | "=" | "!=" | ">=" | ">") f_sum }
 *     f_sum      = f_product { ("+" | "-") f_product }
 *     f_product  = f_sign { ("*" | "/") f_sign }
 *     f_sign     = [ "+" | "-" ] f_primary
 *
 * It differs from that of other expressions: comparisons are exact, all values are floats, and
 * variables are taken as they are when the function is defined.  Calls of other functions become
 * part of the code.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"

#include <math.h>
#include <stdio.h>

/* A sum or product of more terms is refused. */
enum { FUNCTION_TERMS_MAX = 10000, INTERNAL_MAX = 78 };

/* Names that mean numbers in a function: parameters, then variables of sums around. */
typedef struct FunctionReader {
    Parser *p;
    FuncBuilder *code;
    int count;
    TokenKind kind[FUNC_PARAMS_MAX];
    const char *text[FUNC_PARAMS_MAX]; /* of identifiers, interned */
    bool is_default;                   /* x, y, z; then u and v are x and y */
    const char *missing;               /* what it calls that pms has not; NULL: nothing */
} FunctionReader;

static int full(FunctionReader *r);

static int step(FunctionReader *r, FuncOp op, int a, int b)
{
    int slot = func_step(r->code, op, (int[]){a, b, a, a});
    if (slot == NO_SLOT)
        parse_fail(r->p, r->p->last, "the function is too long (limit %d steps and constants)",
                   FUNC_SLOTS_MAX);
    return slot;
}

static int constant(FunctionReader *r, double value)
{
    int slot = func_const(r->code, value);
    return slot == NO_SLOT ? step(r, FUNC_ADD, slot, slot) : slot;
}

/* --- names ---------------------------------------------------------------------------------- */

static int find_name(const FunctionReader *r, const Token *token)
{
    for (int i = r->count - 1; i >= 0; i--) {
        bool is_same = r->kind[i] == token->kind &&
                       (token->kind != TOKEN_IDENTIFIER || r->text[i] == token->text);
        if (is_same)
            return i;
    }
    if (r->is_default && (token->kind == KW_U || token->kind == KW_V))
        return token->kind == KW_U ? 0 : 1;
    return NO_SLOT;
}

static void add_name(FunctionReader *r, const Token *token)
{
    bool is_axis = token->kind == KW_X || token->kind == KW_Y || token->kind == KW_Z ||
                   token->kind == KW_U || token->kind == KW_V || token->kind == KW_T;
    if (token->kind != TOKEN_IDENTIFIER && !is_axis)
        parse_fail(r->p, token->span, "the name of a parameter wanted, found %s",
                   token_kind_text(token->kind));
    if (r->count == FUNC_PARAMS_MAX)
        parse_fail(r->p, token->span, "a function has at most %d parameters", FUNC_PARAMS_MAX);
    r->kind[r->count] = token->kind;
    r->text[r->count++] = token->kind == TOKEN_IDENTIFIER ? token->text : NULL;
}

static void read_parameters(FunctionReader *r)
{
    static const TokenKind axes[] = {KW_X, KW_Y, KW_Z};
    if (parse_peek(r->p)->kind != TOKEN_LPAREN) {
        for (int i = 0; i < 3; i++)
            r->kind[r->count++] = axes[i];
        r->is_default = true;
        return;
    }
    parse_next(r->p);
    while (!parse_accept(r->p, TOKEN_RPAREN)) {
        Token token = raw_next(r->p);
        add_name(r, &token);
        parse_comma(r->p);
    }
}

/* --- calls ---------------------------------------------------------------------------------- */

static int argument_after(FunctionReader *r, const char *what)
{
    parse_expect(r->p, TOKEN_COMMA, what);
    return full(r);
}

static FuncOp unary_op(TokenKind word)
{
    static const struct {
        TokenKind word;
        FuncOp op;
    } table[] = {{KW_ABS, FUNC_ABS},     {KW_ACOS, FUNC_ACOS},   {KW_ACOSH, FUNC_ACOSH},
                 {KW_ASIN, FUNC_ASIN},   {KW_ASINH, FUNC_ASINH}, {KW_ATAN, FUNC_ATAN},
                 {KW_ATANH, FUNC_ATANH}, {KW_CEIL, FUNC_CEIL},   {KW_COS, FUNC_COS},
                 {KW_COSH, FUNC_COSH},   {KW_EXP, FUNC_EXP},     {KW_FLOOR, FUNC_FLOOR},
                 {KW_INT, FUNC_INT},     {KW_LN, FUNC_LN},       {KW_LOG, FUNC_LN},
                 {KW_SIN, FUNC_SIN},     {KW_SINH, FUNC_SINH},   {KW_SQRT, FUNC_SQRT},
                 {KW_TAN, FUNC_TAN},     {KW_TANH, FUNC_TANH}};
    for (size_t i = 0; i < sizeof table / sizeof *table; i++)
        if (table[i].word == word)
            return table[i].op;
    return FUNC_OP_COUNT;
}

static int unary_call(FunctionReader *r, TokenKind word, FuncOp op)
{
    Span begin = parse_peek(r->p)->span;
    int a = full(r);
    double x;
    if (op == FUNC_LN && func_is_const(r->code, a, &x) && !(x > 0))
        parse_fail(r->p, span_join(begin, r->p->last), "`%s` of %g is no number",
                   keyword_text(word), x);
    int value = step(r, op, a, a);
    return word == KW_LOG ? step(r, FUNC_MUL, value, constant(r, 1 / log(10))) : value;
}

static int extreme_call(FunctionReader *r, FuncOp op)
{
    int value = full(r);
    value = step(r, op, value, argument_after(r, "the first argument"));
    while (parse_accept(r->p, TOKEN_COMMA))
        value = step(r, op, value, full(r));
    return value;
}

static int select_call(FunctionReader *r)
{
    int from[4] = {full(r)};
    from[1] = argument_after(r, "the first argument");
    from[2] = argument_after(r, "the second argument");
    from[3] = parse_accept(r->p, TOKEN_COMMA) ? full(r) : from[2];
    int slot = func_step(r->code, FUNC_SELECT, from);
    return slot == NO_SLOT ? step(r, FUNC_ADD, slot, slot) : slot;
}

static double bound_after(FunctionReader *r, const char *what)
{
    double value;
    parse_expect(r->p, TOKEN_COMMA, what);
    Span begin = parse_peek(r->p)->span;
    if (!func_is_const(r->code, full(r), &value))
        parse_fail(r->p, span_join(begin, r->p->last),
                   "pms wants the bounds of `sum` and `prod` to be constant");
    return value;
}

/* sum(i, a, b, term): the term becomes a function of its own that is called for each i. */
static int series_call(FunctionReader *r, FuncOp op)
{
    Token name = raw_next(r->p);
    double first = bound_after(r, "the variable"), last = bound_after(r, "the first bound");
    Span bounds = r->p->last;
    parse_expect(r->p, TOKEN_COMMA, "the second bound");
    FunctionReader inner = *r;
    inner.code = value_alloc(r->p, sizeof *inner.code);
    add_name(&inner, &name);
    func_begin(inner.code, inner.count);
    int result = full(&inner);
    r->missing = inner.missing;
    const Func *term = parse_no_null(r->p, func_end(r->p->arena, inner.code, result));
    if (!(last - first < FUNCTION_TERMS_MAX))
        parse_fail(r->p, bounds, "more than %d terms", FUNCTION_TERMS_MAX);
    int value = constant(r, op == FUNC_ADD ? 0 : 1), arguments[FUNC_PARAMS_MAX];
    for (int i = 0; i < r->count; i++)
        arguments[i] = func_param(r->code, i);
    for (double i = first; i <= last; i++) {
        arguments[r->count] = constant(r, i);
        value = step(r, op, value, func_call(r->code, term, arguments));
    }
    return value;
}

static int word_call(FunctionReader *r, Token word)
{
    FuncOp op = unary_op(word.kind);
    if (op != FUNC_OP_COUNT)
        return unary_call(r, word.kind, op);
    int a;
    switch ((int)word.kind) {
    case KW_DEGREES:
        return step(r, FUNC_MUL, full(r), constant(r, 180 / PMS_PI));
    case KW_RADIANS:
        return step(r, FUNC_MUL, full(r), constant(r, PMS_PI / 180));
    case KW_MIN:
        return extreme_call(r, FUNC_MIN);
    case KW_MAX:
        return extreme_call(r, FUNC_MAX);
    case KW_SELECT:
        return select_call(r);
    case KW_SUM:
        return series_call(r, FUNC_ADD);
    case KW_PROD:
        return series_call(r, FUNC_MUL);
    case KW_ATAN2:
    case KW_POW:
    case KW_MOD:
    case KW_DIV:
        a = full(r);
        a = step(r,
                 word.kind == KW_ATAN2 ? FUNC_ATAN2
                 : word.kind == KW_POW ? FUNC_POW
                 : word.kind == KW_MOD ? FUNC_MOD
                                       : FUNC_DIV,
                 a, argument_after(r, "the first argument"));
        return word.kind == KW_DIV ? step(r, FUNC_INT, a, a) : a;
    default:
        parse_fail(r->p, word.span, "a function cannot use `%s`", keyword_text(word.kind));
    }
}

/* The code of a value that is a function, or fail where pms has it not. */
const Func *function_code(Parser *p, const Value *value, Span span)
{
    if (!value->node)
        parse_fail_not_yet(p, span, value->text);
    return value->node;
}

/* A call of what pms has not: the function that calls it is missing as well, but only a call of
 * that from outside fails.  Include files define many that a scene does not use. */
static int missing_call(FunctionReader *r, const Value *value)
{
    r->missing = value->text;
    parse_expect(r->p, TOKEN_LPAREN, "the name of a function");
    while (!parse_accept(r->p, TOKEN_RPAREN)) {
        full(r);
        if (parse_peek(r->p)->kind != TOKEN_RPAREN)
            parse_expect(r->p, TOKEN_COMMA, "an argument");
    }
    while (parse_accept(r->p, TOKEN_DOT))
        parse_next(r->p);
    return constant(r, 0);
}

static int function_call(FunctionReader *r, const Value *value, Span name)
{
    if (!value->node)
        return missing_call(r, value);
    const Func *callee = function_code(r->p, value, name);
    int arguments[FUNC_PARAMS_MAX];
    parse_expect(r->p, TOKEN_LPAREN, "the name of a function");
    for (int i = 0; i < callee->param_count; i++) {
        if (i > 0)
            parse_expect(r->p, TOKEN_COMMA, "an argument");
        arguments[i] = full(r);
    }
    if (parse_peek(r->p)->kind != TOKEN_RPAREN)
        parse_fail(r->p, parse_peek(r->p)->span, "this function has %d parameter%s, more follow",
                   callee->param_count, plural(callee->param_count));
    parse_next(r->p);
    int slot = func_call(r->code, callee, arguments);
    return slot == NO_SLOT ? step(r, FUNC_ADD, slot, slot) : slot;
}

/* --- expressions ---------------------------------------------------------------------------- */

static int variable(FunctionReader *r)
{
    Span name = parse_peek(r->p)->span;
    const Value value = *parse_variable(r->p, NULL);
    name = span_join(name, r->p->last);
    if (value.kind == VALUE_FUNCTION)
        return function_call(r, &value, name);
    if (value.kind != VALUE_NUMBERS || value.count != 1)
        parse_fail(r->p, name, "a function wants floats, this is %s", value_text(&value));
    return constant(r, value.n[0]);
}

static int group(FunctionReader *r)
{
    parse_next(r->p);
    int slot = full(r);
    parse_expect(r->p, TOKEN_RPAREN, "the expression");
    return slot;
}

static int word(FunctionReader *r)
{
    Token word = parse_next(r->p);
    if (word.kind == KW_PI)
        return constant(r, PMS_PI);
    if (word.kind == KW_CLOCK)
        return constant(r, r->p->options->clock);
    if (!is_number_word(word.kind))
        parse_fail(r->p, word.span, "a float wanted, found %s", token_kind_text(word.kind));
    if (parse_peek(r->p)->kind != TOKEN_LPAREN)
        parse_fail(r->p, word.span, "`%s` is no parameter of this function",
                   keyword_text(word.kind));
    parse_next(r->p);
    int slot = word_call(r, word);
    parse_expect(r->p, TOKEN_RPAREN, "the arguments");
    return slot;
}

static int primary(FunctionReader *r)
{
    const Token *token = parse_peek(r->p);
    int parameter = find_name(r, token);
    if (parameter != NO_SLOT) {
        parse_next(r->p);
        return func_param(r->code, parameter);
    }
    switch ((int)token->kind) {
    case TOKEN_NUMBER:
        return constant(r, parse_next(r->p).number);
    case TOKEN_IDENTIFIER:
        return variable(r);
    case TOKEN_LPAREN:
        return group(r);
    case TOKEN_LESS:
        parse_fail(r->p, token->span, "a function knows floats only, no vectors");
    default:
        return word(r);
    }
}

static int sign(FunctionReader *r)
{
    nest_enter(r->p);
    bool is_negative = parse_peek(r->p)->kind == TOKEN_MINUS;
    if (is_negative || parse_peek(r->p)->kind == TOKEN_PLUS)
        parse_next(r->p);
    int slot = primary(r);
    nest_leave(r->p);
    return is_negative ? step(r, FUNC_NEG, slot, slot) : slot;
}

static int product(FunctionReader *r)
{
    int left = sign(r);
    TokenKind op;
    while ((op = parse_peek(r->p)->kind) == TOKEN_STAR || op == TOKEN_SLASH) {
        parse_next(r->p);
        left = step(r, op == TOKEN_STAR ? FUNC_MUL : FUNC_DIV, left, sign(r));
    }
    return left;
}

static int sum(FunctionReader *r)
{
    int left = product(r);
    TokenKind op;
    while ((op = parse_peek(r->p)->kind) == TOKEN_PLUS || op == TOKEN_MINUS) {
        parse_next(r->p);
        left = step(r, op == TOKEN_PLUS ? FUNC_ADD : FUNC_SUB, left, product(r));
    }
    return left;
}

/* Greater is less the other way round. */
static int relation(FunctionReader *r)
{
    int left = sum(r);
    for (;;) {
        TokenKind op = parse_peek(r->p)->kind;
        FuncOp compare = op == TOKEN_LESS || op == TOKEN_GREATER               ? FUNC_LESS
                         : op == TOKEN_LESS_EQUAL || op == TOKEN_GREATER_EQUAL ? FUNC_LESS_EQUAL
                         : op == TOKEN_EQUAL                                   ? FUNC_EQUAL
                         : op == TOKEN_NOT_EQUAL                               ? FUNC_NOT_EQUAL
                                                                               : FUNC_OP_COUNT;
        if (compare == FUNC_OP_COUNT)
            return left;
        parse_next(r->p);
        int right = sum(r);
        bool is_turned = op == TOKEN_GREATER || op == TOKEN_GREATER_EQUAL;
        left = is_turned ? step(r, compare, right, left) : step(r, compare, left, right);
    }
}

static int both(FunctionReader *r)
{
    int left = relation(r);
    while (parse_accept(r->p, TOKEN_AND))
        left = step(r, FUNC_AND, left, relation(r));
    return left;
}

static int full(FunctionReader *r)
{
    int left = both(r);
    while (parse_accept(r->p, TOKEN_OR))
        left = step(r, FUNC_OR, left, both(r));
    return left;
}

/* --- what others ask for -------------------------------------------------------------------- */

static bool begins_other(TokenKind kind)
{
    return kind == KW_PIGMENT || kind == KW_PATTERN || kind == KW_TRANSFORM || kind == KW_SPLINE;
}

/* Function { pattern { ... } } and its like: skipped. */
static void skip_other(Parser *p, Value *out)
{
    *out = (Value){.kind = VALUE_FUNCTION,
                   .text = "function { pigment, pattern, transform or spline }"};
    for (int depth = 0; depth > 0 || parse_peek(p)->kind != TOKEN_RBRACE;) {
        Token token = parse_next(p);
        if (token.kind == TOKEN_END)
            parse_fail(p, token.span, "`}` wanted after the function, found the end");
        depth += (token.kind == TOKEN_LBRACE) - (token.kind == TOKEN_RBRACE);
    }
}

static const char *name_internal(Parser *p, int number)
{
    char *text = value_alloc(p, sizeof "internal(999)");
    snprintf(text, sizeof "internal(999)", "internal(%d)", number);
    return text;
}

/* internal(N): pms makes those it has as if they were written in the language. */
static void read_internal(Parser *p, Value *out)
{
    parse_next(p);
    parse_expect(p, TOKEN_LPAREN, "internal");
    int number = (int)parse_int(p, "the number of an internal function", 0, INTERNAL_MAX);
    *out = (Value){.kind = VALUE_FUNCTION,
                   .text = name_internal(p, number),
                   .node = function_internal(p, number)};
    parse_expect(p, TOKEN_RPAREN, "the number");
}

static void read_body(FunctionReader *r, Value *out)
{
    FuncBuilder code;
    r->code = &code;
    func_begin(&code, r->count);
    int result = full(r);
    const Func *func = parse_no_null(r->p, func_end(parse_arena(r->p), &code, result));
    *out = (Value){.kind = VALUE_FUNCTION, .text = r->missing, .node = r->missing ? NULL : func};
}

/* Read a function from its parameters on. */
static void read_function(Parser *p, Value *out)
{
    FunctionReader r = {.p = p};
    read_parameters(&r);
    parse_expect(p, TOKEN_LBRACE, "function");
    const Token *first = parse_peek(p);
    if (begins_other(first->kind))
        skip_other(p, out);
    else if (first->kind == KW_INTERNAL)
        read_internal(p, out);
    else
        read_body(&r, out);
    parse_expect(p, TOKEN_RBRACE, "the function");
}

void parse_function(Parser *p, Value *out)
{
    HoldState hold = hold_aside(p);
    parse_expect(p, KW_FUNCTION, "a value");
    read_function(p, out);
    hold_restore(p, hold);
}

void parse_grid_function(Parser *p, long most, int *columns, int *rows, Value *out)
{
    HoldState hold = hold_aside(p);
    parse_expect(p, KW_FUNCTION, "a value");
    *columns = (int)parse_int(p, "the width of a function's image", 1, most);
    parse_comma(p);
    *rows = (int)parse_int(p, "the height of a function's image", 1, most);
    parse_comma(p);
    read_function(p, out);
    hold_restore(p, hold);
}

void parse_function_call(Parser *p, const Value *function, Span name, Terms *out)
{
    const Func *func = function_code(p, function, name);
    double arguments[FUNC_PARAMS_MAX];
    HoldState hold = hold_aside(p);
    parse_expect(p, TOKEN_LPAREN, "the name of a function");
    for (int i = 0; i < func->param_count; i++) {
        if (parse_peek(p)->kind == TOKEN_RPAREN)
            parse_fail(p, name, "this function wants %d argument%s, got %d", func->param_count,
                       plural(func->param_count), i);
        arguments[i] = parse_float(p);
        parse_comma(p);
    }
    parse_expect(p, TOKEN_RPAREN, "the arguments");
    hold_restore(p, hold);
    out->count = 1;
    out->n[0] = func_value(func, arguments);
}
