/* #macro and calls.
 *
 * A macro is a stretch of tokens.  A call works out its arguments, opens a scope with the
 * parameters in it, and moves the cursor to the stretch; at its end the cursor comes back.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"

#include <string.h>

static void take_parameters(Parser *p, Macro *macro)
{
    Name *names[PARAMETER_MAX];
    int count = 0;
    for (;;) {
        Token token = raw_next(p);
        if (token.kind == TOKEN_RPAREN)
            break;
        if (token.kind != TOKEN_IDENTIFIER)
            parse_fail(p, token.span, "a parameter or `)` wanted, found %s",
                       token_kind_text(token.kind));
        if (count == PARAMETER_MAX)
            parse_fail(p, token.span, "a macro has at most %d parameters", PARAMETER_MAX);
        names[count++] = name_of(&token);
        if (raw_peek(p)->kind == TOKEN_COMMA)
            raw_next(p);
    }
    macro->parameter_count = count;
    macro->parameters = value_alloc(p, (size_t)count * sizeof *macro->parameters);
    memcpy(macro->parameters, names, (size_t)count * sizeof *names);
}

void macro_directive(Parser *p, const Token *hash)
{
    if (!hash)
        parse_fail(p, p->last, "`#` wanted before `macro`");
    Token name = raw_next(p);
    if (name.kind != TOKEN_IDENTIFIER)
        parse_fail(p, name.span, "the name of the macro wanted, found %s",
                   token_kind_text(name.kind));
    Token paren = raw_next(p);
    if (paren.kind != TOKEN_LPAREN)
        parse_fail(p, paren.span, "`(` wanted after the name of macro `%s`", name.text);
    Macro *macro = value_alloc(p, sizeof *macro);
    macro->name = name_of(&name);
    macro->span = name.span;
    macro->file = frame_top(p)->file;
    take_parameters(p, macro);
    if (!hash->jump)
        fail_no_end(p, macro->file, hash);
    macro->begin = raw_peek(p);
    macro->end = &macro->file->tokens[hash->jump];
    cursor_move(p, macro->end + 2);
    Symbol *symbol = symbol_global(p, name_of(&name));
    *symbol->target = (Value){.kind = VALUE_MACRO, .node = macro, .span = name.span};
}

static Argument *argument_push(Parser *p)
{
    parse_grow(p, (void **)&p->arguments, p->argument_count, &p->argument_capacity,
               sizeof *p->arguments);
    return &p->arguments[p->argument_count++];
}

static void take_arguments(Parser *p, const Macro *macro, Span call)
{
    for (int i = 0; i < macro->parameter_count; i++) {
        if (parse_peek(p)->kind == TOKEN_RPAREN)
            parse_fail(p, call, "macro '%s' wants %d argument%s, got %d", macro->name->text,
                       macro->parameter_count, plural(macro->parameter_count), i);
        Argument argument = {0};
        parse_argument(p, &argument);
        *argument_push(p) = argument;
        parse_comma(p);
    }
    if (parse_peek(p)->kind != TOKEN_RPAREN)
        parse_fail(p, parse_peek(p)->span, "`)` wanted: macro '%s' has %d parameter%s, found %s",
                   macro->name->text, macro->parameter_count, plural(macro->parameter_count),
                   token_kind_text(parse_peek(p)->kind));
    parse_next(p);
}

/* `base`: the first of the call's arguments. */
static void bind_parameters(Parser *p, const Macro *macro, size_t base)
{
    for (int i = 0; i < macro->parameter_count; i++) {
        const Argument *argument = &p->arguments[base + (size_t)i];
        Symbol *symbol = symbol_local(p, macro->parameters[i]);
        if (argument->alias)
            symbol->target = argument->alias;
        else
            symbol->value = argument->value;
    }
}

/* The cursor stands on the macro's name. */
void macro_call(Parser *p, const Macro *macro)
{
    HoldState hold = hold_aside(p);
    nest_enter(p);
    size_t base = p->argument_count;
    Token name = raw_next(p);
    if (parse_peek(p)->kind != TOKEN_LPAREN)
        parse_fail(p, name.span, "`(` wanted after macro '%s'", macro->name->text);
    parse_next(p);
    take_arguments(p, macro, name.span);
    frame_push_macro(p, macro, span_join(name.span, p->last));
    bind_parameters(p, macro, base);
    p->argument_count = base;
    nest_leave(p);
    hold_restore(p, hold);
}
