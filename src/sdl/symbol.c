/* Symbols: which variable a name means.
 *
 * Scopes nest dynamically (a called macro sees its caller's locals), so each name keeps its
 * symbols as a stack, innermost first: finding one costs nothing, and leaving a scope takes
 * its symbols off.  Symbols of scopes that were left are used again.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"

#include <assert.h>
#include <string.h>

Symbol *symbol_find(const Name *name)
{
    return name->symbol;
}

Symbol *symbol_use(Parser *p, const Token *identifier)
{
    Symbol *symbol = symbol_find(name_of(identifier));
    if (!symbol)
        parse_fail_unknown(p, identifier, "word");
    if (symbol->deprecated) {
        parse_warn(p, WARN_LANGUAGE, identifier->span, "%s", symbol->deprecated);
        if (symbol->is_deprecated_once)
            symbol->deprecated = NULL;
    }
    return symbol;
}

static Symbol *symbol_new(Parser *p, Name *name, int frame)
{
    Symbol *symbol = p->free_symbols;
    if (symbol) {
        p->free_symbols = symbol->next_local;
        memset(symbol, 0, sizeof *symbol);
    } else {
        symbol = value_alloc(p, sizeof *symbol);
    }
    symbol->name = name;
    symbol->frame = frame;
    symbol->frame_serial = p->frames[frame].serial;
    symbol->target = &symbol->value;
    symbol->next_local = p->frames[frame].locals;
    p->frames[frame].locals = symbol;
    return symbol;
}

Symbol *symbol_local(Parser *p, Name *name)
{
    int frame = p->frame_count - 1;
    if (name->symbol && name->symbol->frame == frame)
        return name->symbol;
    Symbol *symbol = symbol_new(p, name, frame);
    symbol->outer = name->symbol;
    name->symbol = symbol;
    return symbol;
}

Symbol *symbol_global(Parser *p, Name *name)
{
    Symbol **place = &name->symbol;
    while (*place && (*place)->frame > 0)
        place = &(*place)->outer;
    if (!*place)
        *place = symbol_new(p, name, 0);
    return *place;
}

Symbol *symbol_visible(Parser *p, Name *name)
{
    return name->symbol ? name->symbol : symbol_global(p, name);
}

/* The memory stays as it is until the frame is left: parameters may stand for it. */
void symbol_undef(Symbol *symbol)
{
    symbol->name->symbol = symbol->outer;
    symbol->is_removed = true;
}

void symbols_drop(Parser *p, Frame *frame)
{
    while (frame->locals) {
        Symbol *symbol = frame->locals;
        frame->locals = symbol->next_local;
        if (!symbol->is_removed) {
            assert(symbol->name->symbol == symbol);
            symbol->name->symbol = symbol->outer;
        }
        symbol->next_local = p->free_symbols;
        p->free_symbols = symbol;
    }
}

bool frame_is_open(const Parser *p, int frame, long serial)
{
    return frame < p->frame_count && p->frames[frame].serial == serial;
}

static Value *predefined(Parser *p, const char *text)
{
    Name *name = name_intern(&p->names, text, strlen(text));
    parse_no_null(p, name);
    if (name->kind != TOKEN_IDENTIFIER)
        parse_fail(p, SPAN_NONE, "`%s` is a word of the language and cannot be declared", text);
    return symbol_global(p, name)->target;
}

void symbol_set_number(Parser *p, const char *name, double value)
{
    *predefined(p, name) = (Value){.kind = VALUE_NUMBERS, .count = 1, .n = {value}};
}

void symbol_set_string(Parser *p, const char *name, const char *text, size_t length)
{
    char *copy = value_alloc(p, length + 1);
    memcpy(copy, text, length);
    *predefined(p, name) = (Value){.kind = VALUE_STRING, .text = copy, .length = length};
}
