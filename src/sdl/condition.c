/* Conditionals and loops: #if #ifdef #ifndef #elseif #else #switch #case #range #while #for
 * #break #end.
 *
 * The lexer has linked the `#` of each branch to the next one, so a false branch is one move
 * of the cursor.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"

#include <math.h>

static void block_push(Parser *p, Block block)
{
    if (p->block_count == BLOCK_MAX)
        parse_fail(p, block.hash[1].span, "conditionals and loops nest too deep (limit %d)",
                   BLOCK_MAX);
    parse_grow(p, (void **)&p->blocks, p->block_count, &p->block_capacity, sizeof *p->blocks);
    p->blocks[p->block_count++] = block;
}

/* Return the innermost block of the top frame, or NULL. */
static Block *block_top(Parser *p)
{
    return p->block_count > frame_top(p)->block_base ? &p->blocks[p->block_count - 1] : NULL;
}

/* Return the `#` of the branch after this one. */
static const Token *next_branch(Parser *p, const Token *hash)
{
    const TokenFile *file = frame_top(p)->file;
    if (!hash->jump)
        fail_no_end(p, file, hash);
    return &file->tokens[hash->jump];
}

static const Token *end_of(Parser *p, const Token *hash)
{
    while (hash[1].kind != KW_END)
        hash = next_branch(p, hash);
    return hash;
}

/* Move to the token after a directive word. */
static void move_past(Parser *p, const Token *hash)
{
    cursor_move(p, hash + 2);
}

/* A condition's parentheses must close in the file or macro they opened in, else the cursor
 * would jump in the wrong one. */
static void check_frame(Parser *p, long serial, const Token *hash)
{
    if (frame_top(p)->serial != serial)
        parse_fail(p, hash[1].span, "what follows `#%s` must end in the same file or macro",
                   keyword_text(hash[1].kind));
}

/* Evaluate what follows #if, #elseif, #while, #ifdef or #ifndef. */
static bool is_true(Parser *p, const Token *hash)
{
    long serial = frame_top(p)->serial;
    bool result;
    if (hash[1].kind == KW_IFDEF || hash[1].kind == KW_IFNDEF) {
        parse_expect(p, TOKEN_LPAREN, token_kind_text(hash[1].kind));
        result = is_defined(p) == (hash[1].kind == KW_IFDEF);
    } else {
        result = fabs(parse_condition(p)) > SDL_EPSILON;
    }
    check_frame(p, serial, hash);
    return result;
}

void if_directive(Parser *p, const Token *hash)
{
    bool is_taken = is_true(p, hash);
    const Token *branch = hash;
    while (!is_taken) {
        branch = next_branch(p, branch);
        move_past(p, branch);
        if (branch[1].kind == KW_END)
            return;
        is_taken = branch[1].kind == KW_ELSE || is_true(p, branch);
    }
    block_push(p, (Block){.kind = BLOCK_IF, .hash = branch});
}

/* Return whether `value` belongs to this #case or #range, whose arguments come next. */
static bool is_matched(Parser *p, const Token *branch, double value)
{
    long serial = frame_top(p)->serial;
    bool result;
    if (branch[1].kind == KW_CASE) {
        double wanted = parse_condition(p);
        result = fabs(value - wanted) <= SDL_EPSILON;
    } else {
        parse_expect(p, TOKEN_LPAREN, token_kind_text(KW_RANGE));
        double low = parse_float(p);
        parse_comma(p);
        double high = parse_float(p);
        parse_expect(p, TOKEN_RPAREN, "the range");
        result = low <= value && value <= high;
    }
    check_frame(p, serial, branch);
    return result;
}

void switch_directive(Parser *p, const Token *hash)
{
    long serial = frame_top(p)->serial;
    double value = parse_condition(p);
    check_frame(p, serial, hash);
    const Token *branch = next_branch(p, hash);
    if (raw_peek(p) != branch)
        parse_fail(p, raw_peek(p)->span, "`#case` or `#range` wanted right after `#switch (...)`");
    for (;; branch = next_branch(p, branch)) {
        move_past(p, branch);
        if (branch[1].kind == KW_END)
            return;
        if (branch[1].kind == KW_ELSE || is_matched(p, branch, value))
            break;
    }
    block_push(p, (Block){.kind = BLOCK_SWITCH, .hash = hash});
}

/* A branch word met while the branch before it was being read. */
void branch_directive(Parser *p, const Token *hash, Token word)
{
    const Block *block = block_top(p);
    bool is_case = word.kind == KW_CASE || word.kind == KW_RANGE;
    if (block && block->kind == BLOCK_SWITCH && word.kind != KW_ELSEIF) {
        if (is_case)
            is_matched(p, hash, 0); /* execution falls through */
        return;
    }
    if (!block || block->kind != BLOCK_IF || is_case)
        parse_fail(p, word.span, "`#%s` stands in no `#%s`", keyword_text(word.kind),
                   is_case ? "switch" : "if");
    p->block_count--;
    move_past(p, end_of(p, hash));
}

void while_directive(Parser *p, const Token *hash)
{
    if (is_true(p, hash))
        block_push(p, (Block){.kind = BLOCK_WHILE, .hash = hash});
    else
        move_past(p, end_of(p, hash));
}

static bool is_in_range(double value, double end, double step)
{
    return step > 0 ? value < end + SDL_EPSILON : value > end - SDL_EPSILON;
}

void for_directive(Parser *p, const Token *hash)
{
    long serial = frame_top(p)->serial;
    parse_expect(p, TOKEN_LPAREN, token_kind_text(KW_FOR));
    Token name = raw_next(p);
    if (name.kind != TOKEN_IDENTIFIER)
        parse_fail(p, name.span, "the name of a loop variable wanted, found %s",
                   token_kind_text(name.kind));
    parse_comma(p);
    double start = parse_float(p);
    parse_comma(p);
    double end = parse_float(p);
    parse_comma(p);
    double step = parse_peek(p)->kind == TOKEN_RPAREN ? 1 : parse_float(p);
    if (!(fabs(step) >= SDL_EPSILON))
        parse_fail(p, p->last, "the step of `#for` must not be 0");
    parse_expect(p, TOKEN_RPAREN, "the range of `#for`");
    check_frame(p, serial, hash);
    Symbol *variable = symbol_local(p, name_of(&name));
    *variable->target = (Value){.kind = VALUE_NUMBERS, .count = 1, .n = {start}, .span = name.span};
    if (is_in_range(start, end, step))
        block_push(p, (Block){BLOCK_FOR, hash, raw_peek(p), variable, end, step});
    else
        move_past(p, end_of(p, hash));
}

/* Go round a loop again, or leave it. */
static void for_again(Parser *p, Block *block, Token word)
{
    Value *value = block->variable->target;
    if (block->variable->is_removed || value->kind != VALUE_NUMBERS || value->count != 1)
        parse_fail(p, word.span, "the variable of this `#for` is no float any more");
    value->n[0] += block->step;
    if (is_in_range(value->n[0], block->end, block->step))
        cursor_move(p, block->body);
    else
        p->block_count--;
}

static void while_again(Parser *p, const Block *block, const Token *after)
{
    const Token *hash = block->hash;
    move_past(p, hash);
    if (is_true(p, hash))
        return;
    p->block_count--;
    cursor_move(p, after);
}

void end_directive(Parser *p, Token word)
{
    Block *block = block_top(p);
    if (!block)
        parse_fail(p, word.span,
                   "`#end` without an `#if`, `#switch`, `#for`, `#while` or `#macro`");
    if (block->kind == BLOCK_FOR)
        for_again(p, block, word);
    else if (block->kind == BLOCK_WHILE)
        while_again(p, block, raw_peek(p));
    else
        p->block_count--;
}

/* Leave the innermost loop or #switch, else the macro. */
void break_directive(Parser *p, Token word)
{
    Frame *frame = frame_top(p);
    while (p->block_count > frame->block_base) {
        const Block *block = &p->blocks[--p->block_count];
        if (block->kind != BLOCK_IF) {
            move_past(p, end_of(p, block->hash));
            return;
        }
    }
    if (!frame->macro)
        parse_fail(p, word.span, "`#break` stands in no loop, `#switch` or macro");
    cursor_move(p, frame->end);
}
