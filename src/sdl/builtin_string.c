/* Strings: literals with their escapes, and the functions that yield strings.
 *
 * The language's strings are sequences of 16-bit units; here they are kept as UTF-8, of which
 * plain ASCII is the common case.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

enum {
    UNIT_BYTES_MAX = 3, /* UTF-8 of a 16-bit unit */
    UNIT_UNKNOWN = 0xFFFD,
    NUMBER_TEXT_MAX = 254, /* longer numbers are written with %g */
    DATE_MAX = 200,
    EPOCH_2000 = 946684800,
    DAY_SECONDS = 86400,
};

/* A string being put together. */
typedef struct Builder {
    char *bytes;
    size_t length, capacity;
} Builder;

static void builder_reserve(Parser *p, Builder *b, size_t more)
{
    if (b->length >= STRING_SIZE_MAX || more >= STRING_SIZE_MAX - b->length)
        parse_fail(p, p->last, "a string has at most %zu bytes", STRING_SIZE_MAX);
    size_t wanted = b->length + more + 1;
    if (wanted <= b->capacity)
        return;
    size_t capacity = wanted < 2 * b->capacity ? 2 * b->capacity : wanted;
    char *grown = value_alloc(p, capacity);
    if (b->length)
        memcpy(grown, b->bytes, b->length);
    b->bytes = grown;
    b->capacity = capacity;
}

static void builder_add(Parser *p, Builder *b, const char *bytes, size_t length)
{
    builder_reserve(p, b, length);
    memcpy(b->bytes + b->length, bytes, length);
    b->length += length;
}

static Text builder_text(Parser *p, Builder *b)
{
    builder_reserve(p, b, 0);
    b->bytes[b->length] = 0;
    return (Text){b->bytes, b->length};
}

static size_t unit_encode(unsigned unit, char *out)
{
    if (unit < 0x80) {
        out[0] = (char)unit;
        return 1;
    }
    if (unit < 0x800) {
        out[0] = (char)(0xC0 | unit >> 6);
        out[1] = (char)(0x80 | (unit & 0x3F));
        return 2;
    }
    out[0] = (char)(0xE0 | unit >> 12);
    out[1] = (char)(0x80 | (unit >> 6 & 0x3F));
    out[2] = (char)(0x80 | (unit & 0x3F));
    return 3;
}

static void builder_add_unit(Parser *p, Builder *b, unsigned unit)
{
    builder_reserve(p, b, UNIT_BYTES_MAX);
    b->length += unit_encode(unit, b->bytes + b->length);
}

size_t unit_decode(const char *text, size_t length, unsigned *unit)
{
    unsigned char first = (unsigned char)text[0];
    size_t count = first < 0x80 ? 1 : first >= 0xF0 && first < 0xF8 ? 4 : first >= 0xE0 ? 3 : 2;
    static const unsigned char masks[] = {0, 0x7F, 0x1F, 0x0F, 0x07};
    *unit = UNIT_UNKNOWN;
    if (first >= 0xF8 || (first >= 0x80 && first < 0xC0) || count > length)
        return 1;
    unsigned value = first & masks[count];
    for (size_t i = 1; i < count; i++) {
        if (((unsigned char)text[i] & 0xC0) != 0x80)
            return 1;
        value = value << 6 | ((unsigned char)text[i] & 0x3F);
    }
    if (value <= 0xFFFF)
        *unit = value;
    return count;
}

size_t text_units(Text text)
{
    size_t units = 0;
    for (size_t i = 0; i < text.length; i++)
        units += ((unsigned char)text.bytes[i] & 0xC0) != 0x80;
    return units;
}

int text_first_unit(Text text)
{
    unsigned unit = 0;
    if (text.length)
        unit_decode(text.bytes, text.length, &unit);
    return (int)unit;
}

int text_compare(Text a, Text b)
{
    size_t i = 0, j = 0;
    for (;;) {
        unsigned left = 0, right = 0;
        if (i < a.length)
            i += unit_decode(a.bytes + i, a.length - i, &left);
        if (j < b.length)
            j += unit_decode(b.bytes + j, b.length - j, &right);
        if (left != right || (left == 0 && i >= a.length && j >= b.length))
            return (int)left - (int)right;
    }
}

/* --- literals ------------------------------------------------------------------------------ */

/* Return the place of byte `at` of a literal in its file. */
static Span literal_span(const Token *literal, size_t at, size_t length)
{
    uint32_t begin = literal->span.begin + 1 + (uint32_t)at;
    return (Span){literal->span.source, begin, begin + (uint32_t)length};
}

static int hex_digit(char c)
{
    if (c >= '0' && c <= '9')
        return c - '0';
    if (c >= 'a' && c <= 'f')
        return c - 'a' + 10;
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

static unsigned hex_unit(Parser *p, const Token *literal, size_t at)
{
    unsigned unit = 0;
    for (size_t i = at + 2; i < at + 6; i++) {
        int digit = i < literal->length ? hex_digit(literal->text[i]) : -1;
        if (digit < 0)
            parse_fail(p, literal_span(literal, at, 2), "four hex digits wanted after `\\u`");
        unit = unit * 16 + (unsigned)digit;
    }
    return unit;
}

/* Decode the escape at byte `at`; returns the bytes it takes. */
static size_t take_escape(Parser *p, const Token *literal, size_t at, Builder *b)
{
    static const char names[] = "abfnrtv\\\"'";
    static const char codes[] = "\a\b\f\n\r\t\v\\\"'";
    char c = at + 1 < literal->length ? literal->text[at + 1] : 0;
    if (c == 'u') {
        builder_add_unit(p, b, hex_unit(p, literal, at));
        return 6;
    }
    const char *name = c ? strchr(names, c) : NULL;
    if (!name)
        parse_fail(p, literal_span(literal, at, 2),
                   "no such escape in a string; a backslash itself is `\\\\`");
    builder_add(p, b, &codes[name - names], 1);
    return 2;
}

/* Decode bytes beyond ASCII as the charset in force has it; returns the bytes used. */
static size_t take_foreign(Parser *p, const Token *literal, size_t at, Builder *b, bool *is_told)
{
    unsigned unit = (unsigned char)literal->text[at];
    size_t used = 1;
    if (p->is_utf8) {
        used = unit_decode(literal->text + at, literal->length - at, &unit);
    } else if (p->version >= 3.5) {
        unit = ' ';
        if (!*is_told)
            parse_warn(p, WARN_VALUE, literal_span(literal, at, 1),
                       "letters beyond ASCII become blanks; `global_settings { charset utf8 }` "
                       "keeps them");
        *is_told = true;
    }
    builder_add_unit(p, b, unit);
    return used;
}

static Text literal_text(Parser *p, const Token *literal)
{
    Builder b = {0};
    bool is_told = false;
    builder_reserve(p, &b, literal->length);
    for (size_t i = 0; i < literal->length;) {
        char c = literal->text[i];
        if (c == '\\')
            i += take_escape(p, literal, i, &b);
        else if ((unsigned char)c > 127)
            i += take_foreign(p, literal, i, &b, &is_told);
        else
            builder_add(p, &b, &literal->text[i++], 1);
    }
    return builder_text(p, &b);
}

void parse_set_utf8(Parser *p, bool is_utf8)
{
    p->is_utf8 = is_utf8;
}

/* --- functions ----------------------------------------------------------------------------- */

/* Append a number as printf's %L.Pf: width below 0 pads with zeros, precision below 0 is 6. */
static void add_number(Parser *p, Builder *b, double value, double width, double precision)
{
    char text[NUMBER_TEXT_MAX + 2];
    int places = precision < 0 || isnan(precision) ? 6 : precision > 999 ? 999 : (int)precision;
    int columns = !(fabs(width) <= 999) ? 999 : (int)width;
    int length = columns < 0 ? snprintf(text, sizeof text, "%0*.*f", -columns, places, value)
                             : snprintf(text, sizeof text, "%*.*f", columns, places, value);
    if (length > NUMBER_TEXT_MAX)
        length = snprintf(text, sizeof text, "%g", value);
    if (length > 0)
        builder_add(p, b, text, (size_t)length);
}

static Text call_str(Parser *p)
{
    Builder b = {0};
    double value = parse_float(p);
    parse_comma(p);
    double width = parse_float(p);
    parse_comma(p);
    add_number(p, &b, value, width, parse_float(p));
    return builder_text(p, &b);
}

static Text call_vstr(Parser *p)
{
    Builder b = {0};
    double wanted = trunc(parse_float(p));
    int count = !(wanted > 2) ? 2 : wanted > 5 ? 5 : (int)wanted;
    parse_comma(p);
    Terms terms;
    parse_short(p, &terms);
    for (int i = terms.count; i < 5; i++)
        terms.n[i] = 0;
    parse_comma(p);
    Text separator = parse_text(p);
    parse_comma(p);
    double width = parse_float(p);
    parse_comma(p);
    double precision = parse_float(p);
    for (int i = 0; i < count; i++) {
        if (i)
            builder_add(p, &b, separator.bytes, separator.length);
        add_number(p, &b, terms.n[i], width, precision);
    }
    return builder_text(p, &b);
}

static Text call_concat(Parser *p)
{
    Builder b = {0};
    do {
        Text part = parse_text(p);
        builder_add(p, &b, part.bytes, part.length);
        parse_comma(p);
    } while (parse_peek(p)->kind != TOKEN_RPAREN);
    return builder_text(p, &b);
}

static Text call_chr(Parser *p)
{
    Builder b = {0};
    Span begin = parse_peek(p)->span;
    double code = trunc(parse_float_full(p));
    if (!(code >= 0 && code <= 0xFFFF))
        parse_fail(p, span_join(begin, p->last), "`chr` wants 0 to 65535, not %g", code);
    builder_add_unit(p, &b, (unsigned)code);
    return builder_text(p, &b);
}

/* Return where unit `index` begins. */
static size_t unit_place(Text text, size_t index)
{
    size_t at = 0;
    for (; index > 0 && at < text.length; index--) {
        unsigned unit;
        at += unit_decode(text.bytes + at, text.length - at, &unit);
    }
    return at;
}

static Text call_substr(Parser *p)
{
    Builder b = {0};
    Text text = parse_text(p);
    parse_comma(p);
    Span begin = parse_peek(p)->span;
    double start = trunc(parse_float(p)) - 1;
    parse_comma(p);
    double count = trunc(parse_float(p));
    double units = (double)text_units(text);
    if (!(start >= 0 && count >= 0 && start + count <= units))
        parse_fail(p, span_join(begin, p->last), "a string of %g has no %g letters from %g on",
                   units, count, start + 1);
    size_t from = unit_place(text, (size_t)start), to = unit_place(text, (size_t)(start + count));
    builder_add(p, &b, text.bytes + from, to - from);
    return builder_text(p, &b);
}

static Text call_case(Parser *p, bool is_upper)
{
    Builder b = {0};
    Text text = parse_text(p);
    builder_add(p, &b, text.bytes, text.length);
    for (size_t i = 0; i < b.length; i++) {
        char c = b.bytes[i];
        if (is_upper ? c >= 'a' && c <= 'z' : c >= 'A' && c <= 'Z')
            b.bytes[i] = (char)(c ^ 0x20);
    }
    return builder_text(p, &b);
}

static Text call_datetime(Parser *p)
{
    Builder b = {0};
    Span begin = parse_peek(p)->span;
    double seconds = parse_float(p) * DAY_SECONDS + EPOCH_2000;
    const char *format = "%Y-%m-%d %H:%M:%SZ";
    parse_comma(p);
    if (parse_peek(p)->kind != TOKEN_RPAREN)
        format = parse_text(p).bytes;
    struct tm date;
    time_t moment = fabs(seconds) < 1e15 ? (time_t)floor(seconds) : 0;
    if (!(fabs(seconds) < 1e15) || !gmtime_r(&moment, &date))
        parse_fail(p, span_join(begin, p->last), "there is no such day");
    char text[DATE_MAX + 1] = "";
    size_t length = *format ? strftime(text, sizeof text, format, &date) : 0;
    if (length == 0 && *format)
        parse_fail(p, p->last, "the date has more than %d letters, or none", DATE_MAX);
    builder_add(p, &b, text, length);
    return builder_text(p, &b);
}

bool is_string_word(TokenKind kind)
{
    switch ((int)kind) {
    case KW_CHR:
    case KW_CONCAT:
    case KW_DATETIME:
    case KW_STR:
    case KW_STRLWR:
    case KW_STRUPR:
    case KW_SUBSTR:
    case KW_VSTR:
        return true;
    default:
        return false;
    }
}

static Text string_call(Parser *p, TokenKind word)
{
    switch ((int)word) {
    case KW_CHR:
        return call_chr(p);
    case KW_CONCAT:
        return call_concat(p);
    case KW_DATETIME:
        return call_datetime(p);
    case KW_STR:
        return call_str(p);
    case KW_SUBSTR:
        return call_substr(p);
    case KW_VSTR:
        return call_vstr(p);
    default:
        return call_case(p, word == KW_STRUPR);
    }
}

static Text parse_string_call(Parser *p)
{
    nest_enter(p);
    HoldState hold = hold_aside(p);
    TokenKind word = parse_next(p).kind;
    parse_expect(p, TOKEN_LPAREN, token_kind_text(word));
    Text text = string_call(p, word);
    parse_expect(p, TOKEN_RPAREN, "the arguments");
    hold_restore(p, hold);
    nest_leave(p);
    return text;
}

bool is_text_start(Parser *p)
{
    const Token *token = parse_peek(p);
    return token->kind == TOKEN_STRING || is_string_word(token->kind) ||
           peek_value_kind(p) == VALUE_STRING;
}

static noreturn void fail_no_text(Parser *p)
{
    const Token *token = parse_peek(p);
    if (token->kind == TOKEN_IDENTIFIER && !symbol_find(name_of(token)))
        parse_fail_unknown(p, token, "word");
    if (token->kind == TOKEN_IDENTIFIER)
        parse_fail(p, token->span, "a string wanted, `%s` is %s", token->text,
                   value_text(symbol_find(name_of(token))->target));
    parse_fail(p, token->span, "a string wanted, found %s", token_kind_text(token->kind));
}

Text parse_text(Parser *p)
{
    const Token *token = parse_peek(p);
    if (token->kind == TOKEN_STRING) {
        Token literal = parse_next(p);
        return literal_text(p, &literal);
    }
    if (is_string_word(token->kind))
        return parse_string_call(p);
    const Value *value = parse_accept_value(p, VALUE_STRING);
    if (!value)
        fail_no_text(p);
    return (Text){value->text, value->length};
}

const char *parse_string(Parser *p)
{
    Text text = parse_text(p);
    return parse_copy(p, text.bytes, text.length + 1);
}

const char *parse_path(Parser *p)
{
    if (parse_peek(p)->kind != TOKEN_STRING)
        return parse_string(p);
    Token literal = parse_next(p);
    return parse_no_null(p, arena_strndup(parse_arena(p), literal.text, literal.length));
}
