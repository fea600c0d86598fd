/* Values: what a variable holds and what an argument may be.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"

#include <string.h>

const char *value_text(const Value *value)
{
    static const char *const numbers[] = {"nothing",       "a float",       "a vector of 2",
                                          "a vector of 3", "a vector of 4", "a vector of 5"};
    static const char *const kinds[VALUE_KIND_COUNT] = {
        [VALUE_NONE] = "nothing",        [VALUE_COLOR] = "a colour",
        [VALUE_STRING] = "a string",     [VALUE_ARRAY] = "an array",
        [VALUE_MACRO] = "a macro",       [VALUE_OBJECT] = "an object",
        [VALUE_TEXTURE] = "a texture",   [VALUE_PIGMENT] = "a pigment",
        [VALUE_FINISH] = "a finish",     [VALUE_INTERIOR] = "an interior",
        [VALUE_MATERIAL] = "a material", [VALUE_TRANSFORM] = "a transform",
        [VALUE_CAMERA] = "a camera",     [VALUE_COLOR_MAP] = "a color_map",
        [VALUE_SKY] = "a sky_sphere",    [VALUE_MEDIA] = "a media",
        [VALUE_DENSITY] = "a density",   [VALUE_DENSITY_MAP] = "a density_map",
        [VALUE_FOG] = "a fog",           [VALUE_RAINBOW] = "a rainbow",
        [VALUE_FUNCTION] = "a function"};
    return value->kind == VALUE_NUMBERS ? numbers[value->count] : kinds[value->kind];
}

/* Five terms are a colour, and colours are kept as 32-bit floats. */
void value_from_terms(Value *out, const Terms *terms)
{
    *out = (Value){.kind = terms->count == 5 ? VALUE_COLOR : VALUE_NUMBERS, .count = terms->count};
    for (int i = 0; i < terms->count; i++)
        out->n[i] = terms->count == 5 ? (double)(float)terms->n[i] : terms->n[i];
}

Value *parse_variable(Parser *p, Symbol **owner)
{
    Token name = parse_next(p);
    Symbol *symbol = symbol_use(p, &name);
    if (owner)
        *owner = symbol;
    Value *value = symbol->target;
    if (value->kind != VALUE_ARRAY || raw_peek(p)->kind != TOKEN_LBRACKET)
        return value;
    value = array_item(p, value->node, &name);
    if (value->kind == VALUE_NONE)
        parse_fail(p, span_join(name.span, p->last), "this element of `%s` has no value yet",
                   name.text);
    return value;
}

ValueKind peek_value_kind(Parser *p)
{
    const Token *token = parse_peek(p);
    const Symbol *symbol = token->kind == TOKEN_IDENTIFIER ? symbol_find(name_of(token)) : NULL;
    if (!symbol)
        return VALUE_NONE;
    if (symbol->target->kind == VALUE_ARRAY)
        return ((const Array *)symbol->target->node)->item_kind;
    return symbol->target->kind;
}

const Value *parse_accept_value(Parser *p, ValueKind kind)
{
    if (peek_value_kind(p) != kind)
        return NULL;
    Span begin = parse_peek(p)->span;
    const Value *value = parse_variable(p, NULL);
    if (value->kind != kind)
        parse_fail(p, span_join(begin, p->last), "%s wanted, found %s",
                   value_text(&(Value){.kind = kind, .count = 1}), value_text(value));
    Value *kept = &p->taken[p->taken_count++ % TAKEN_COUNT];
    *kept = *value;
    kept->span = span_join(begin, p->last);
    return kept;
}

static bool is_numbers(const Value *value)
{
    return value->kind == VALUE_NUMBERS || value->kind == VALUE_COLOR;
}

static void terms_from_value(Terms *out, const Value *value)
{
    out->count = value->count;
    memcpy(out->n, value->n, sizeof out->n);
}

/* The rest of a value that begins with a variable.  Arrays are copied whole. */
static void value_after(Parser *p, const Value *first, Value *out)
{
    *out = *first;
    if (first->kind == VALUE_ARRAY)
        out->node = array_copy(p, first->node);
    Terms terms;
    if (is_numbers(first))
        terms_from_value(&terms, first);
    else if (first->kind == VALUE_FUNCTION && parse_is_next(p, TOKEN_LPAREN))
        parse_function_call(p, first, p->last, &terms);
    else
        return;
    parse_short_after(p, &terms);
    value_from_terms(out, &terms);
}

static void text_value(Parser *p, Value *out)
{
    Text text = parse_text(p);
    *out = (Value){.kind = VALUE_STRING, .text = text.bytes, .length = text.length};
}

static void color_value(Parser *p, Value *out)
{
    Terms terms;
    parse_color_form(p, &terms);
    value_from_terms(out, &terms);
}

static void number_value(Parser *p, Value *out)
{
    Terms terms;
    if (parse_peek(p)->kind == KW_T)
        parse_fail(p, parse_peek(p)->span, "`t` cannot begin a value; write `+t`");
    parse_short(p, &terms);
    value_from_terms(out, &terms);
}

static void other_value(Parser *p, Value *out)
{
    if (parse_peek(p)->kind == KW_ARRAY) {
        parse_array(p, out);
        return;
    }
    if (parse_peek(p)->kind == KW_FUNCTION) {
        parse_function(p, out);
        return;
    }
    /* Directives inside a block are carried out where they stand, in a #declare too. */
    HoldState hold = hold_aside(p);
    if (!read_value(p, out))
        parse_fail_here(p, "as a value");
    hold_restore(p, hold);
}

void parse_value(Parser *p, Value *out)
{
    Span begin = parse_peek(p)->span;
    if (parse_peek(p)->kind == TOKEN_IDENTIFIER) {
        Value first = *parse_variable(p, NULL);
        value_after(p, &first, out);
    } else if (is_text_start(p)) {
        text_value(p, out);
    } else if (is_color_word(parse_peek(p)->kind)) {
        color_value(p, out);
    } else if (parse_is_expression(p)) {
        number_value(p, out);
    } else {
        other_value(p, out);
    }
    out->span = span_join(begin, p->last);
}

static bool is_operator(TokenKind kind)
{
    return kind == TOKEN_PLUS || kind == TOKEN_MINUS || kind == TOKEN_STAR || kind == TOKEN_SLASH ||
           kind == TOKEN_DOT;
}

/* An argument that is one variable stands for it, unless the variable's scope has been left by
 * the time the argument ends. */
void parse_argument(Parser *p, Argument *out)
{
    *out = (Argument){0};
    if (parse_peek(p)->kind != TOKEN_IDENTIFIER) {
        parse_value(p, &out->value);
        return;
    }
    Symbol *owner;
    Value *variable = parse_variable(p, &owner);
    Value first = *variable;
    int frame = owner->frame;
    long serial = owner->frame_serial;
    TokenKind next = parse_peek(p)->kind;
    bool is_call = next == TOKEN_LPAREN && first.kind == VALUE_FUNCTION;
    if (is_call || (is_operator(next) && is_numbers(&first))) {
        value_after(p, &first, &out->value);
        return;
    }
    out->value = first;
    if (frame_is_open(p, frame, serial))
        out->alias = variable;
}
