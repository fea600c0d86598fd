/* #declare, #local, #undef, and the question whether something is defined.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"

#include <stdio.h>
#include <string.h>

/* Where a value goes. */
typedef struct LeftSide {
    Symbol *symbol;
    Array *array; /* NULL: the symbol itself */
    Value *item;
} LeftSide;

/* What `deprecated` says about the name it stands before. */
typedef struct Deprecation {
    bool is_given, is_once;
    const char *text; /* NULL: the usual one */
} Deprecation;

static Deprecation take_deprecation(Parser *p)
{
    Deprecation deprecation = {0};
    if (raw_peek(p)->kind != KW_DEPRECATED)
        return deprecation;
    raw_next(p);
    deprecation.is_given = true;
    if (raw_peek(p)->kind == KW_ONCE) {
        raw_next(p);
        deprecation.is_once = true;
    }
    if (raw_peek(p)->kind == TOKEN_STRING)
        deprecation.text = parse_text(p).bytes;
    return deprecation;
}

static void set_deprecation(Parser *p, Symbol *symbol, Deprecation deprecation)
{
    if (!deprecation.is_given)
        return;
    symbol->is_deprecated_once = deprecation.is_once;
    symbol->deprecated = deprecation.text;
    if (!deprecation.text) {
        const char *format = "`%s` is deprecated";
        size_t size = strlen(format) + symbol->name->length + 1;
        char *text = value_alloc(p, size);
        snprintf(text, size, format, symbol->name->text);
        symbol->deprecated = text;
    }
}

static Token take_name(Parser *p, Token word)
{
    Token name = raw_next(p);
    if (token_is_keyword(name.kind))
        parse_fail(p, name.span, "`%s` is a word of the language and cannot be declared",
                   keyword_text(name.kind));
    if (name.kind != TOKEN_IDENTIFIER)
        parse_fail(p, name.span, "a name wanted after `#%s`, found %s", keyword_text(word.kind),
                   token_kind_text(name.kind));
    return name;
}

/* Take the subscripts of an array element on the left side. */
static LeftSide take_element(Parser *p, const Token *name)
{
    Symbol *symbol = symbol_find(name_of(name));
    if (!symbol)
        parse_fail_unknown(p, name, "array");
    if (symbol->target->kind != VALUE_ARRAY)
        parse_fail(p, name->span, "`%s` is %s, not an array", name->text,
                   value_text(symbol->target));
    Array *array = (Array *)(uintptr_t)symbol->target->node;
    return (LeftSide){symbol, array, array_item(p, array, name)};
}

/* A number needs its semicolon; other values may have one.  Nothing behind the declaration is
 * looked at, since it has not been carried out yet. */
static void take_semicolon(Parser *p, const Value *value, const Token *name)
{
    bool is_found = false;
    if (p->is_ready && p->next->kind == TOKEN_SEMICOLON) {
        parse_next(p);
        is_found = true;
    }
    release_hold(p);
    while (raw_peek(p)->kind == TOKEN_SEMICOLON && raw_peek(p) != frame_top(p)->end) {
        raw_next(p);
        is_found = true;
    }
    bool is_needed = value->kind == VALUE_NUMBERS || value->kind == VALUE_COLOR;
    if (is_found || !is_needed || p->version < 3.5)
        return;
    Span after = {p->last.source, p->last.end, p->last.end};
    parse_fail(p, after, "`;` wanted after the value of `%s`", name->text);
}

void declare_directive(Parser *p, Token word)
{
    Deprecation deprecation = take_deprecation(p);
    Token name = take_name(p, word);
    LeftSide left = {0};
    if (raw_peek(p)->kind == TOKEN_LBRACKET)
        left = take_element(p, &name);
    parse_expect(p, TOKEN_EQUAL, "the name");

    Value value;
    hold_set(p, p->version < 3.5 ? HOLD_ALL : HOLD_STATEMENTS);
    parse_value(p, &value);
    hold_aside(p);
    value.span = name.span;
    if (!left.symbol)
        left.symbol = word.kind == KW_LOCAL ? symbol_local(p, name_of(&name))
                                            : symbol_visible(p, name_of(&name));
    if (!left.array && left.symbol->target->kind == VALUE_FUNCTION)
        parse_fail(p, name.span, "`%s` is a function already; #undef it first", name.text);
    if (left.array)
        array_assign(p, left.array, left.item, &value, name.span);
    else
        *left.symbol->target = value;
    set_deprecation(p, left.symbol, deprecation);
    take_semicolon(p, &value, &name);
}

void undef_directive(Parser *p)
{
    Token name = raw_next(p);
    Symbol *symbol = name.kind == TOKEN_IDENTIFIER ? symbol_find(name_of(&name)) : NULL;
    if (!symbol)
        parse_warn(p, WARN_LANGUAGE, name.span, "nothing to undefine");
    else if (raw_peek(p)->kind == TOKEN_LBRACKET)
        *take_element(p, &name).item = (Value){0};
    else
        symbol_undef(symbol);
}

/* Only variables are defined: a word of the language is not. */
bool is_defined(Parser *p)
{
    Token name = raw_next(p);
    bool result = false;
    if (!token_is_keyword(name.kind) && name.kind != TOKEN_IDENTIFIER)
        parse_fail(p, name.span, "a name wanted, found %s", token_kind_text(name.kind));
    const Symbol *symbol = name.kind == TOKEN_IDENTIFIER ? symbol_find(name_of(&name)) : NULL;
    if (raw_peek(p)->kind == TOKEN_LBRACKET) {
        if (!symbol || symbol->target->kind != VALUE_ARRAY)
            parse_fail(p, name.span, "`%s` is no array", name.text);
        result = array_item_is_set(p, symbol->target->node, &name);
    } else {
        result = symbol != NULL;
    }
    parse_expect(p, TOKEN_RPAREN, "the name");
    return result;
}
