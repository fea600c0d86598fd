/* Directives: the words behind a `#`.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"

#include <math.h>

static void debug_directive(Parser *p)
{
    Text text = parse_text(p);
    diag_say(p->diag, text.bytes);
}

static void warning_directive(Parser *p, Token word)
{
    Text text = parse_text(p);
    parse_warn(p, WARN_USER, word.span, "%s", text.bytes);
}

static noreturn void error_directive(Parser *p, Token word)
{
    Text text = parse_text(p);
    parse_fail(p, word.span, "%s", text.bytes);
}

static void default_directive(Parser *p)
{
    parse_expect(p, TOKEN_LBRACE, token_kind_text(KW_DEFAULT));
    read_default(p);
}

void version_directive(Parser *p)
{
    const Token *token = raw_peek(p);
    if (token->kind == TOKEN_IDENTIFIER && token->length == 10 && token->text[0] == 'u')
        raw_next(p); /* unofficial */
    Span begin = raw_peek(p)->span;
    hold_set(p, HOLD_ALL);
    double version = floor(100 * parse_float(p) + 0.5) / 100;
    hold_aside(p);
    release_hold(p);
    if (!(version >= 1 && version <= 3.7))
        parse_fail(p, span_join(begin, p->last), "language version %g is not one of 1 to 3.7",
                   version);
    p->version = version;
    p->has_version = true;
    while (raw_peek(p)->kind == TOKEN_SEMICOLON)
        raw_next(p);
}

/* A `#` before any other word is dropped, as the language has it; an unknown word is told. */
static void stray_hash(Parser *p, Token word)
{
    if (word.kind == TOKEN_IDENTIFIER && !symbol_find(name_of(&word)))
        parse_fail_unknown(p, &word, "directive");
}

static void control_directive(Parser *p, const Token *hash, Token word)
{
    switch ((int)word.kind) {
    case KW_IF:
    case KW_IFDEF:
    case KW_IFNDEF:
        if_directive(p, hash);
        break;
    case KW_SWITCH:
        switch_directive(p, hash);
        break;
    case KW_WHILE:
        while_directive(p, hash);
        break;
    case KW_FOR:
        for_directive(p, hash);
        break;
    case KW_END:
        end_directive(p, word);
        break;
    case KW_BREAK:
        break_directive(p, word);
        break;
    default:
        branch_directive(p, hash, word);
        break;
    }
}

/* Carry out a directive whose word has been taken; `hash` is NULL when none was written. */
void directive_word(Parser *p, const Token *hash, Token word)
{
    switch ((int)word.kind) {
    case KW_DECLARE:
    case KW_LOCAL:
        declare_directive(p, word);
        break;
    case KW_UNDEF:
        undef_directive(p);
        break;
    case KW_INCLUDE:
        include_directive(p);
        break;
    case KW_MACRO:
        macro_directive(p, hash);
        break;
    case KW_VERSION:
        version_directive(p);
        break;
    case KW_DEFAULT:
        default_directive(p);
        break;
    case KW_DEBUG:
    case KW_RENDER:
    case KW_STATISTICS:
        debug_directive(p);
        break;
    case KW_WARNING:
        warning_directive(p, word);
        break;
    case KW_ERROR:
        error_directive(p, word);
    case KW_FOPEN:
    case KW_FCLOSE:
    case KW_READ:
    case KW_WRITE:
        parse_fail_not_yet(p, word.span, keyword_text(word.kind));
    default:
        control_directive(p, hash, word);
        break;
    }
}

static bool is_directive_word(TokenKind word)
{
    switch ((int)word) {
    case KW_BREAK:
    case KW_CASE:
    case KW_DEBUG:
    case KW_DECLARE:
    case KW_DEFAULT:
    case KW_ELSE:
    case KW_ELSEIF:
    case KW_END:
    case KW_ERROR:
    case KW_FCLOSE:
    case KW_FOPEN:
    case KW_FOR:
    case KW_IF:
    case KW_IFDEF:
    case KW_IFNDEF:
    case KW_INCLUDE:
    case KW_LOCAL:
    case KW_MACRO:
    case KW_RANGE:
    case KW_READ:
    case KW_RENDER:
    case KW_STATISTICS:
    case KW_SWITCH:
    case KW_UNDEF:
    case KW_VERSION:
    case KW_WARNING:
    case KW_WHILE:
    case KW_WRITE:
        return true;
    default:
        return false;
    }
}

void directive(Parser *p)
{
    HoldState hold = hold_aside(p);
    nest_enter(p);
    const Token *hash = raw_peek(p);
    raw_next(p);
    if (is_directive_word(hash[1].kind))
        directive_word(p, hash, raw_next(p));
    else
        stray_hash(p, hash[1]);
    nest_leave(p);
    hold_restore(p, hold);
}
