/* The cursor: where the next token comes from.
 *
 * parse_peek carries out the directives and macro calls in its way, so readers see only what
 * is left.  No token is copied: frames and loops move pointers over the arrays of the lexer.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"

#include "base/work.h"

enum { CHECK_TOKENS = 1024 };

Frame *frame_top(Parser *p)
{
    return &p->frames[p->frame_count - 1];
}

static void frame_push(Parser *p, Frame frame)
{
    frame.block_base = p->block_count;
    frame.serial = p->frame_serial++;
    p->frames[p->frame_count++] = frame;
    p->is_ready = false;
}

void frame_push_file(Parser *p, const TokenFile *file, Span call)
{
    frame_push(p, (Frame){.file = file,
                          .at = file->tokens,
                          .end = file->tokens + file->count - 1,
                          .call = call});
}

void frame_push_macro(Parser *p, const Macro *macro, Span call)
{
    if (p->macro_depth == MACRO_DEPTH_MAX)
        parse_fail(p, call, "macros nest too deep (limit %d)", MACRO_DEPTH_MAX);
    p->macro_depth++;
    frame_push(p, (Frame){.file = macro->file,
                          .at = macro->begin,
                          .end = macro->end,
                          .macro = macro,
                          .call = call});
}

noreturn void fail_no_end(Parser *p, const TokenFile *file, const Token *branch)
{
    const Token *opener = branch;
    const Token *last = &file->tokens[file->count >= 2 ? file->count - 2 : 0];
    if (last->kind == TOKEN_ILLEGAL)
        parse_fail(p, last->span, "%s", last->text);
    for (const Token *at = branch; at-- > file->tokens;)
        if (at->kind == TOKEN_HASH && at->jump && &file->tokens[at->jump] == opener)
            opener = at;
    parse_fail(p, opener[1].span, "this `#%s` has no `#end`", keyword_text(opener[1].kind));
}

static void frame_pop(Parser *p)
{
    Frame *frame = frame_top(p);
    if (p->block_count > frame->block_base)
        fail_no_end(p, frame->file, p->blocks[p->block_count - 1].hash);
    symbols_drop(p, frame);
    if (frame->macro)
        p->macro_depth--;
    else
        p->include_depth--;
    p->frame_count--;
}

void nest_enter(Parser *p)
{
    if (++p->nest > NEST_MAX)
        parse_fail(p, p->last, "this is nested too deep (limit %d)", NEST_MAX);
}

void nest_leave(Parser *p)
{
    p->nest--;
}

/* --- tokens as they stand ------------------------------------------------------------------ */

static void check_rarely(Parser *p, Span span)
{
    if (work_interrupted)
        parse_fail_status(p, diag_fail(p->diag, ERR_INTERRUPTED, "interrupted"));
    if (arena_bytes(p->scene->arena) > p->bytes_max)
        parse_fail(p, span, "the scene takes more than %zu bytes of memory", p->bytes_max);
}

/* Count against the limits; memory and Ctrl-C are looked at only now and then. */
static void count_token(Parser *p, Span span)
{
    if (--p->tokens_left < 0)
        parse_fail(p, span, "more than %ld tokens evaluated; raise with --max-tokens",
                   p->tokens_max);
    if (p->tokens_left % CHECK_TOKENS == 0)
        check_rarely(p, span);
}

static void take(Parser *p, const Token *token)
{
    count_token(p, token->span);
    p->last = token->span;
    p->last_kind = token->kind;
    p->is_ready = false;
}

const Token *raw_peek(Parser *p)
{
    return frame_top(p)->at;
}

Token raw_next(Parser *p)
{
    Frame *frame = frame_top(p);
    const Token *token = frame->at;
    if (token == frame->end && frame->macro)
        parse_fail(p, token->span, "macro '%s' ends too early here", frame->macro->name->text);
    if (token->kind == TOKEN_ILLEGAL)
        parse_fail(p, token->span, "%s", token->text);
    take(p, token);
    if (token != frame->end)
        frame->at++;
    return *token;
}

void cursor_move(Parser *p, const Token *at)
{
    Frame *frame = frame_top(p);
    count_token(p, at->span);
    frame->at = at;
    p->is_ready = false;
}

/* --- tokens as readers see them ------------------------------------------------------------ */

/* Return true if the directive at `hash` must wait until the value before it is assigned. */
static bool is_held(const Parser *p, const Token *hash)
{
    if (p->held != HOLD_STATEMENTS)
        return p->held == HOLD_ALL;
    size_t top = p->frames[p->frame_count - 1].block_base;
    bool is_in_loop = p->block_count > top && p->blocks[p->block_count - 1].kind >= BLOCK_WHILE;
    switch ((int)hash[1].kind) {
    case KW_IF:
    case KW_IFDEF:
    case KW_IFNDEF:
    case KW_ELSEIF:
    case KW_ELSE:
    case KW_SWITCH:
    case KW_CASE:
    case KW_RANGE:
    case KW_BREAK:
        return false;
    case KW_END:
        return is_in_loop;
    default:
        return true;
    }
}

/* Take one step towards a token for a reader: leave a frame that is done, carry out a
 * directive, enter a macro, or set p->next. */
static void advance(Parser *p)
{
    Frame *frame = frame_top(p);
    const Token *token = frame->at;
    p->next = token;
    if (token == frame->end && p->frame_count > 1) {
        if (p->held != HOLD_NONE && p->frame_count <= p->hold_frames)
            p->is_ready = true;
        else
            frame_pop(p);
    } else if (token == frame->end && p->block_count > 0) {
        fail_no_end(p, frame->file, p->blocks[p->block_count - 1].hash);
    } else if (token->kind == TOKEN_HASH && !is_held(p, token)) {
        directive(p);
    } else if (token->kind == TOKEN_IDENTIFIER) {
        const Symbol *symbol = symbol_find(name_of(token));
        if (symbol && symbol->target->kind == VALUE_MACRO && p->held != HOLD_ALL)
            macro_call(p, symbol->target->node);
        else
            p->is_ready = true;
    } else if (token->kind == TOKEN_ILLEGAL) {
        parse_fail(p, token->span, "%s", token->text);
    } else {
        p->is_ready = true;
    }
}

const Token *parse_peek(Parser *p)
{
    while (!p->is_ready)
        advance(p);
    return p->next;
}

const Token *peek_operator(Parser *p)
{
    if (p->is_ready)
        return p->next;
    p->held = p->hold;
    const Token *token = parse_peek(p);
    p->held = HOLD_NONE;
    return token;
}

bool parse_is_next(Parser *p, TokenKind kind)
{
    p->is_ready = false;
    p->held = HOLD_ALL;
    bool is_next = parse_peek(p)->kind == kind;
    p->held = HOLD_NONE;
    release_hold(p);
    return is_next;
}

void hold_set(Parser *p, Hold hold)
{
    p->hold = hold;
    p->hold_frames = p->frame_count;
}

HoldState hold_aside(Parser *p)
{
    HoldState state = {p->hold, p->held, p->hold_frames};
    p->hold = p->held = HOLD_NONE;
    p->hold_frames = 0;
    return state;
}

void hold_restore(Parser *p, HoldState state)
{
    p->hold = state.hold;
    p->held = state.held;
    p->hold_frames = state.frames;
}

void release_hold(Parser *p)
{
    p->is_ready = false;
}

static void count_brace(Parser *p, const Token *token)
{
    if (token->kind == TOKEN_LBRACE) {
        if (p->braces == BRACE_MAX)
            parse_fail(p, token->span, "braces nest too deep (limit %d)", BRACE_MAX);
        p->brace_spans[p->braces++] = token->span;
    } else if (token->kind == TOKEN_RBRACE && p->braces > 0) {
        p->braces--;
    }
}

Token parse_next(Parser *p)
{
    const Token *token = parse_peek(p);
    Frame *frame = frame_top(p);
    take(p, token);
    count_brace(p, token);
    if (token != frame->end)
        frame->at++;
    return *token;
}

bool parse_accept(Parser *p, TokenKind kind)
{
    if (parse_peek(p)->kind != kind)
        return false;
    parse_next(p);
    return true;
}

/* Describe a token as found: keywords and marks by their spelling, names with theirs. */
static noreturn void fail_wanted(Parser *p, TokenKind kind, const char *after)
{
    const Token *found = parse_peek(p);
    const char *wanted = token_kind_text(kind);
    if (found->kind == TOKEN_IDENTIFIER)
        parse_fail(p, found->span, "%s wanted after %s, found `%s`", wanted, after, found->text);
    parse_fail(p, found->span, "%s wanted after %s, found %s", wanted, after,
               token_kind_text(found->kind));
}

Token parse_expect(Parser *p, TokenKind kind, const char *after)
{
    if (parse_peek(p)->kind != kind)
        fail_wanted(p, kind, after);
    return parse_next(p);
}

void parse_comma(Parser *p)
{
    parse_accept(p, TOKEN_COMMA);
}

Span parse_last_span(const Parser *p)
{
    return p->last;
}
