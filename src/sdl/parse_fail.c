/* How a parse ends early: a message with its place, the way there, and the one jump.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"

#include "base/guess.h"

#include <string.h>

/* Say how the cursor came to where it is, innermost first. */
static void backtrace(Parser *p)
{
    int shown = 0;
    for (int i = p->frame_count - 1; i > 0; i--, shown++) {
        const Frame *frame = &p->frames[i];
        if (shown == BACKTRACE_MAX) {
            diag_note(p->diag, SPAN_NONE, "%d more calls and includes above these", i);
            return;
        }
        if (frame->macro)
            diag_note(p->diag, frame->call, "in macro '%s' called here", frame->macro->name->text);
        else
            diag_note(p->diag, frame->call, "included from here");
    }
}

/* At the end of the file, and at a block that fits nowhere: say where what should have been closed
 * was opened. */
static void note_open_brace(Parser *p, Span span)
{
    if (p->frame_count != 1 || p->braces == 0)
        return;
    const Token *end = frame_top(p)->end, *at = raw_peek(p);
    Span opener = p->brace_spans[p->braces - 1];
    if (span.source == end->span.source && span.begin == end->span.begin)
        diag_note(p->diag, opener, "this `{` has no `}`");
    else if (span.begin == at->span.begin && token_is_keyword(at->kind) && at < end &&
             at[1].kind == TOKEN_LBRACE)
        diag_note(p->diag, opener, "is the `}` of this `{` missing?");
}

/* A quote that is missing turns the text around it inside out: if what went wrong stands right
 * behind a string of several lines, say where that began. */
static void note_long_string(Parser *p)
{
    const Token *at = raw_peek(p);
    if (at == frame_top(p)->file->tokens || at[-1].kind != TOKEN_STRING)
        return;
    if (memchr(at[-1].text, '\n', at[-1].length))
        diag_note(p->diag, at[-1].span,
                  "this string runs over several lines; is its closing `\"` missing?");
}

static noreturn void leave(Parser *p, Status status)
{
    p->status = status;
    longjmp(p->failed, 1);
}

noreturn void parse_fail(Parser *p, Span span, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    diag_error_v(p->diag, span, format, args);
    va_end(args);
    if (p->frame_count > 0) {
        note_open_brace(p, span);
        note_long_string(p);
    }
    backtrace(p);
    leave(p, ERR_SYNTAX);
}

noreturn void parse_fail_status(Parser *p, Status status)
{
    backtrace(p);
    leave(p, status);
}

noreturn void parse_fail_memory(Parser *p)
{
    leave(p, diag_no_memory(p->diag, "the scene"));
}

noreturn void parse_fail_not_yet(Parser *p, Span span, const char *what)
{
    parse_fail(p, span, "pms has no `%s` yet", what);
}

void parse_warn(Parser *p, WarnKind kind, Span span, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    diag_warn_v(p->diag, kind, span, format, args);
    va_end(args);
}

const char *word_nearest(const Parser *p, const char *word, size_t length)
{
    Guess guess = guess_begin(word, length);
    for (size_t i = 0; i < p->names.map.capacity; i++) {
        const Name *name = p->names.map.entries[i].value;
        if (name &&
            (name->kind == TOKEN_IDENTIFIER ? name->symbol != NULL : keyword_has(name->kind)))
            guess_try(&guess, name->text);
    }
    return guess.best;
}

noreturn void parse_fail_unknown(Parser *p, const Token *token, const char *what)
{
    const char *guess = word_nearest(p, token->text, token->length);
    if (guess)
        parse_fail(p, token->span, "unknown %s `%s`; did you mean `%s`?", what, token->text, guess);
    parse_fail(p, token->span, "unknown %s `%s`", what, token->text);
}

static noreturn void fail_on_identifier(Parser *p, const Token *token, const char *where)
{
    const Symbol *symbol = symbol_find(name_of(token));
    if (!symbol)
        parse_fail_unknown(p, token, "word");
    parse_fail(p, token->span, "`%s` is %s, which fits nowhere %s", token->text,
               value_text(symbol->target), where);
}

noreturn void parse_fail_here(Parser *p, const char *where)
{
    const Token *token = parse_peek(p);
    if (token->kind == TOKEN_IDENTIFIER)
        fail_on_identifier(p, token, where);
    if (token_is_keyword(token->kind) && !keyword_has(token->kind))
        parse_fail_not_yet(p, token->span, keyword_text(token->kind));
    if (token->kind == TOKEN_END)
        parse_fail(p, token->span, "the file ends %s", where);
    parse_fail(p, token->span, "%s fits nowhere %s", token_kind_text(token->kind), where);
}

/* --- memory: what runs out here ends the parse --------------------------------------------- */

void *parse_no_null(Parser *p, const void *node)
{
    if (!node)
        parse_fail_memory(p);
    return (void *)(uintptr_t)node;
}

void *parse_alloc(Parser *p, size_t size)
{
    return parse_no_null(p, arena_alloc(p->scene->arena, size));
}

void *parse_copy(Parser *p, const void *from, size_t size)
{
    return parse_no_null(p, arena_copy(p->scene->arena, from, size));
}

void *value_alloc(Parser *p, size_t size)
{
    if (size > VALUE_BYTES_MAX - p->value_bytes)
        parse_fail(p, p->last, "strings, arrays and variables take more than %zu bytes",
                   VALUE_BYTES_MAX);
    p->value_bytes += size;
    return parse_no_null(p, arena_alloc(p->arena, size));
}

void parse_grow(Parser *p, void **items, size_t count, size_t *capacity, size_t item_size)
{
    if (count < *capacity)
        return;
    size_t wanted = *capacity ? *capacity * 2 : 16;
    void *grown = parse_no_null(p, arena_array(p->arena, wanted, item_size));
    if (count)
        memcpy(grown, *items, count * item_size);
    *items = grown;
    *capacity = wanted;
}

Arena *parse_arena(Parser *p)
{
    return p->scene->arena;
}

Scene *parse_scene(Parser *p)
{
    return p->scene;
}

SceneBuild *parse_build(Parser *p)
{
    return &p->build;
}

Diag *parse_diag(Parser *p)
{
    return p->diag;
}

const SdlOptions *parse_options(Parser *p)
{
    return p->options;
}

const Noise *parse_noise(Parser *p)
{
    if (!p->noise)
        p->noise = parse_no_null(p, noise_new(parse_arena(p)));
    return p->noise;
}

int parse_noise_generator(const Parser *p)
{
    return p->noise_generator;
}

void parse_set_noise_generator(Parser *p, int generator)
{
    p->noise_generator = generator;
}
