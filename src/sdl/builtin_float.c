/* Built-in functions and constants that yield numbers.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"

#include "base/hash.h"

#include <math.h>
#include <stdlib.h>
#include <time.h>

enum { EPOCH_2000 = 946684800, DAY_SECONDS = 86400 };

/* Truncate to 32 bits; what does not fit becomes the lowest number. */
static int32_t to_int(double value)
{
    double whole = trunc(value);
    return whole >= INT32_MIN && whole <= INT32_MAX ? (int32_t)whole : INT32_MIN;
}

/* --- random streams ------------------------------------------------------------------------ */

double random_seed(Parser *p, double number)
{
    if (p->seed_count == SEED_MAX)
        parse_fail(p, p->last, "more than %d random streams", SEED_MAX);
    parse_grow(p, (void **)&p->seeds, p->seed_count, &p->seed_capacity, sizeof *p->seeds);
    p->seeds[p->seed_count] = (uint32_t)to_int(number);
    return (double)p->seed_count++;
}

double random_next(Parser *p, double stream, Span span)
{
    double index = trunc(stream);
    if (!(index >= 0 && index < (double)p->seed_count))
        parse_fail(p, span, "no random stream %g: `seed` makes one", stream);
    uint32_t *state = &p->seeds[(size_t)index];
    *state = *state * 1812433253u + 12345u;
    return *state / 4294967295.0;
}

/* --- constants ----------------------------------------------------------------------------- */

static double days_now(void)
{
    return (double)(time(NULL) - EPOCH_2000) / DAY_SECONDS;
}

static void set_terms(Terms *out, int count, double a, double b, double c)
{
    *out = (Terms){.count = count, .n = {a, b, c, 0, 0}};
}

/* Return whether the word is a constant; if so set *out. */
static bool constant(Parser *p, TokenKind word, Terms *out)
{
    out->count = 1;
    switch ((int)word) {
    case KW_PI:
        out->n[0] = PMS_PI;
        return true;
    case KW_TRUE:
    case KW_ON:
    case KW_YES:
        out->n[0] = 1;
        return true;
    case KW_FALSE:
    case KW_OFF:
    case KW_NO:
        out->n[0] = 0;
        return true;
    case KW_CLOCK:
        out->n[0] = p->options->clock;
        return true;
    case KW_CLOCK_ON:
        out->n[0] = p->options->clock != 0;
        return true;
    case KW_NOW:
        out->n[0] = days_now();
        p->scene->text_hash = hash_bytes(p->scene->text_hash, out->n, sizeof out->n[0]);
        return true;
    case KW_VERSION:
        out->n[0] = p->version;
        return true;
    case KW_X:
        set_terms(out, 3, 1, 0, 0);
        return true;
    case KW_Y:
        set_terms(out, 3, 0, 1, 0);
        return true;
    case KW_Z:
        set_terms(out, 3, 0, 0, 1);
        return true;
    case KW_U:
        set_terms(out, 2, 1, 0, 0);
        return true;
    case KW_V:
        set_terms(out, 2, 0, 1, 0);
        return true;
    case KW_T:
        *out = (Terms){.count = 4, .n = {0, 0, 0, 1, 0}};
        return true;
    default:
        return false;
    }
}

/* --- functions of one float ---------------------------------------------------------------- */

typedef double (*Function)(double);

static double to_degrees(double x)
{
    return x * (180 / PMS_PI);
}

static double to_radians(double x)
{
    return x * (PMS_PI / 180);
}

static double to_whole(double x)
{
    return to_int(x);
}

/* Return the function of one float this word names, or NULL. */
static Function function_of(TokenKind word)
{
    static const struct {
        TokenKind word;
        Function function;
    } table[] = {{KW_ABS, fabs},    {KW_ACOS, acos},          {KW_ACOSH, acosh},
                 {KW_ASIN, asin},   {KW_ASINH, asinh},        {KW_ATAN, atan},
                 {KW_ATANH, atanh}, {KW_CEIL, ceil},          {KW_COS, cos},
                 {KW_COSH, cosh},   {KW_DEGREES, to_degrees}, {KW_EXP, exp},
                 {KW_FLOOR, floor}, {KW_INT, to_whole},       {KW_LN, log},
                 {KW_LOG, log10},   {KW_RADIANS, to_radians}, {KW_SIN, sin},
                 {KW_SINH, sinh},   {KW_SQRT, sqrt},          {KW_TAN, tan},
                 {KW_TANH, tanh}};
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++)
        if (table[i].word == word)
            return table[i].function;
    return NULL;
}

static double checked_argument(Parser *p, TokenKind word, double x, Span span)
{
    if ((word == KW_SQRT && x < 0) || ((word == KW_LN || word == KW_LOG) && x <= 0))
        parse_fail(p, span, "`%s` of %g is no number", keyword_text(word), x);
    if ((word == KW_ACOS || word == KW_ASIN) && fabs(x) > 1) {
        parse_warn(p, WARN_VALUE, span, "`%s` of %g, taken as of %g", keyword_text(word), x,
                   copysign(1, x));
        return copysign(1, x);
    }
    return x;
}

static double call_function(Parser *p, TokenKind word, Function function)
{
    Span begin = parse_peek(p)->span;
    Terms terms;
    parse_full(p, &terms);
    double x = terms_float(p, &terms, begin, word);
    return function(checked_argument(p, word, x, span_join(begin, p->last)));
}

/* --- functions of two floats, and of lists ------------------------------------------------- */

static double checked_pow(Parser *p, double base, double exponent, Span span)
{
    if (base == 0 && exponent == 0)
        parse_fail(p, span, "`pow` of 0 and 0 is no number");
    return pow(base, exponent);
}

static double checked_atan2(Parser *p, double y, double x, Span span)
{
    if (y == 0 && x == 0)
        parse_fail(p, span, "`atan2` of 0 and 0 is no number");
    return atan2(y, x);
}

static double call_of_two(Parser *p, TokenKind word)
{
    Span begin = parse_peek(p)->span;
    double a = parse_float(p);
    parse_comma(p);
    double b = parse_float(p);
    Span span = span_join(begin, p->last);
    switch ((int)word) {
    case KW_ATAN2:
        return checked_atan2(p, a, b, span);
    case KW_POW:
        return checked_pow(p, a, b, span);
    case KW_MOD:
        return fmod(a, b);
    default:
        return to_int(a / b);
    }
}

static double fold(TokenKind word, double a, double b)
{
    switch ((int)word) {
    case KW_MIN:
        return a < b ? a : b;
    case KW_MAX:
        return a > b ? a : b;
    case KW_BITWISE_AND:
        return to_int(a) & to_int(b);
    case KW_BITWISE_OR:
        return to_int(a) | to_int(b);
    default:
        return to_int(a) ^ to_int(b);
    }
}

/* The commas of these lists are not optional. */
static double call_of_list(Parser *p, TokenKind word)
{
    bool is_bitwise = word != KW_MIN && word != KW_MAX;
    double result = parse_float(p);
    if (is_bitwise)
        parse_expect(p, TOKEN_COMMA, "the first argument");
    if (!is_bitwise && !parse_accept(p, TOKEN_COMMA))
        return result;
    do
        result = fold(word, result, parse_float(p));
    while (parse_accept(p, TOKEN_COMMA));
    return result;
}

static double call_select(Parser *p)
{
    double value = parse_float(p);
    parse_comma(p);
    double negative = parse_float(p);
    parse_comma(p);
    double zero = parse_float(p);
    double positive = parse_accept(p, TOKEN_COMMA) ? parse_float(p) : zero;
    return value < 0 ? negative : value == 0 ? zero : positive;
}

/* --- functions of strings, arrays and vectors ---------------------------------------------- */

static double call_of_text(Parser *p, TokenKind word)
{
    if (word == KW_FILE_EXISTS)
        return file_find(p, parse_path(p), NULL) != NULL;
    Text text = parse_text(p);
    switch ((int)word) {
    case KW_ASC:
        return text_first_unit(text);
    case KW_VAL:
        return strtod(text.bytes, NULL);
    case KW_STRLEN:
        return (double)text_units(text);
    default:
        parse_comma(p);
        return text_compare(text, parse_text(p));
    }
}

static double call_of_array(Parser *p, TokenKind word)
{
    const Token *token = parse_peek(p);
    const Symbol *symbol = token->kind == TOKEN_IDENTIFIER ? symbol_use(p, token) : NULL;
    if (!symbol || symbol->target->kind != VALUE_ARRAY)
        parse_fail(p, token->span, "`%s` wants the name of an array", keyword_text(word));
    const Array *array = symbol->target->node;
    parse_next(p);
    if (word == KW_DIMENSIONS)
        return array->dimension_count;
    parse_comma(p);
    double number = trunc(parse_float(p));
    return number >= 1 && number <= array->dimension_count ? array->size[(int)number - 1] : 0;
}

static V3 vector_argument(Parser *p)
{
    Span begin = parse_peek(p)->span;
    Terms terms;
    parse_short(p, &terms);
    return terms_v3(p, &terms, begin);
}

static double call_of_vectors(Parser *p, TokenKind word)
{
    V3 a = vector_argument(p);
    if (word == KW_VLENGTH)
        return sqrt(v3_dot(a, a));
    parse_comma(p);
    return v3_dot(a, vector_argument(p));
}

static double call_random(Parser *p, TokenKind word)
{
    Span begin = parse_peek(p)->span;
    double argument = parse_float_full(p);
    return word == KW_SEED ? random_seed(p, argument)
                           : random_next(p, argument, span_join(begin, p->last));
}

/* Work out a call that yields a float; its parentheses are the caller's. */
static double float_call(Parser *p, Token word)
{
    Function function = function_of(word.kind);
    if (function)
        return call_function(p, word.kind, function);
    switch ((int)word.kind) {
    case KW_ATAN2:
    case KW_DIV:
    case KW_MOD:
    case KW_POW:
        return call_of_two(p, word.kind);
    case KW_MIN:
    case KW_MAX:
    case KW_BITWISE_AND:
    case KW_BITWISE_OR:
    case KW_BITWISE_XOR:
        return call_of_list(p, word.kind);
    case KW_SELECT:
        return call_select(p);
    case KW_ASC:
    case KW_FILE_EXISTS:
    case KW_STRCMP:
    case KW_STRLEN:
    case KW_VAL:
        return call_of_text(p, word.kind);
    case KW_DIMENSIONS:
    case KW_DIMENSION_SIZE:
        return call_of_array(p, word.kind);
    case KW_VDOT:
    case KW_VLENGTH:
        return call_of_vectors(p, word.kind);
    case KW_RAND:
    case KW_SEED:
        return call_random(p, word.kind);
    default:
        parse_fail(p, word.span, "`%s` is no function here", keyword_text(word.kind));
    }
}

bool is_number_word(TokenKind kind)
{
    switch ((int)kind) {
    case KW_PI:
    case KW_TRUE:
    case KW_ON:
    case KW_YES:
    case KW_FALSE:
    case KW_OFF:
    case KW_NO:
    case KW_CLOCK:
    case KW_CLOCK_ON:
    case KW_NOW:
    case KW_VERSION:
    case KW_X:
    case KW_Y:
    case KW_Z:
    case KW_U:
    case KW_V:
    case KW_T:
    case KW_ATAN2:
    case KW_DIV:
    case KW_MOD:
    case KW_POW:
    case KW_MIN:
    case KW_MAX:
    case KW_BITWISE_AND:
    case KW_BITWISE_OR:
    case KW_BITWISE_XOR:
    case KW_SELECT:
    case KW_ASC:
    case KW_FILE_EXISTS:
    case KW_STRCMP:
    case KW_STRLEN:
    case KW_VAL:
    case KW_DIMENSIONS:
    case KW_DIMENSION_SIZE:
    case KW_VDOT:
    case KW_VLENGTH:
    case KW_DEFINED:
    case KW_RAND:
    case KW_SEED:
    case KW_INSIDE:
    case KW_SUM:
    case KW_PROD:
    case KW_VCROSS:
    case KW_VNORMALIZE:
    case KW_VROTATE:
    case KW_VAXIS_ROTATE:
    case KW_VTURBULENCE:
    case KW_TRACE:
    case KW_MIN_EXTENT:
    case KW_MAX_EXTENT:
        return true;
    default:
        return function_of(kind) != NULL;
    }
}

static bool is_vector_word(TokenKind kind)
{
    return kind == KW_VCROSS || kind == KW_VNORMALIZE || kind == KW_VROTATE ||
           kind == KW_VAXIS_ROTATE;
}

void parse_number_word(Parser *p, Terms *out)
{
    Token word = parse_next(p);
    if (constant(p, word.kind, out))
        return;
    if (!keyword_has(word.kind))
        parse_fail_not_yet(p, word.span, keyword_text(word.kind));
    HoldState hold = hold_aside(p);
    parse_expect(p, TOKEN_LPAREN, token_kind_text(word.kind));
    if (word.kind == KW_DEFINED) {
        out->n[0] = is_defined(p); /* takes the `)` too */
    } else {
        if (is_vector_word(word.kind))
            parse_vector_call(p, word.kind, out);
        else if (is_object_word(word.kind))
            parse_object_call(p, word.kind, out);
        else
            out->n[0] = float_call(p, word);
        parse_expect(p, TOKEN_RPAREN, "the arguments");
    }
    hold_restore(p, hold);
}
