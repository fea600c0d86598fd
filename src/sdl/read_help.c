/* What all block readers need: braces, words, checked numbers, growing arrays.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/read_int.h"

#include "base/guess.h"

#include <assert.h>
#include <float.h>
#include <stdio.h>
#include <string.h>

enum {
    LIST_MAX = 1000,     /* nodes of a list that is copied to grow */
    WORDS_TEXT_MAX = 256 /* bytes of the words to choose from, in a message */
};

const char *read_word(Parser *p, const Token *token)
{
    const Span s = token->span;
    if (!s.source)
        return "object";
    char *word = parse_alloc(p, s.end - s.begin + 1);
    memcpy(word, s.source->text + s.begin, s.end - s.begin);
    return word;
}

bool read_is_word(const Token *token, const char *word)
{
    size_t length = strlen(word);
    return token->span.source && token->span.end - token->span.begin == length &&
           memcmp(token->span.source->text + token->span.begin, word, length) == 0;
}

/* Fail on a token that is none of `words`. */
static noreturn void fail_choice(Parser *p, const Token *found, const char *what,
                                 const char *const words[], int count)
{
    char list[WORDS_TEXT_MAX] = "";
    size_t length = 0;
    const char *spelled = read_word(p, found);
    Guess guess = guess_begin(spelled, strlen(spelled));
    for (int i = words[0][0] ? 0 : 1; i < count; i++) {
        const char *after = i + 1 == count ? "" : i + 2 == count ? " or " : ", ";
        length += (size_t)snprintf(list + length, sizeof list - length, "%s%s", words[i], after);
        assert(length < sizeof list);
        guess_try(&guess, words[i]);
    }
    bool is_name = found->kind == TOKEN_IDENTIFIER, has_guess = guess.best != NULL;
    const char *quote = is_name ? "`" : "";
    parse_fail(p, found->span, "%s wants %s, found %s%s%s%s%s%s", what, list, quote,
               is_name ? spelled : token_kind_text(found->kind), quote,
               has_guess ? "; did you mean `" : "", has_guess ? guess.best : "",
               has_guess ? "`?" : "");
}

int read_choice(Parser *p, const char *what, const char *const words[], int count)
{
    const Token *found = parse_peek(p);
    for (int i = 0; i < count; i++)
        if (words[i][0] && read_is_word(found, words[i])) {
            parse_next(p);
            return i;
        }
    fail_choice(p, found, what, words, count);
}

Token read_open(Parser *p)
{
    Token word = parse_next(p);
    parse_expect(p, TOKEN_LBRACE, read_word(p, &word));
    return word;
}

bool read_close(Parser *p)
{
    return parse_accept(p, TOKEN_RBRACE);
}

double read_finite(Parser *p, const char *what, Span *span_or_null)
{
    Span first = parse_peek(p)->span;
    double value = parse_float(p);
    Span span = span_join(first, parse_last_span(p));
    if (!isfinite(value))
        parse_fail(p, span, "%s wants a finite number, got %g", what, value);
    if (span_or_null)
        *span_or_null = span;
    return value;
}

double read_above_zero(Parser *p, const char *what)
{
    Span span;
    double value = read_finite(p, what, &span);
    if (!(value > 0 && value <= (double)FLT_MAX))
        parse_fail(p, span, "%s wants a number above 0 and up to %g, got %g", what, (double)FLT_MAX,
                   value);
    return value;
}

double read_not_negative(Parser *p, const char *what)
{
    Span span;
    double value = read_finite(p, what, &span);
    if (!(value >= 0))
        parse_fail(p, span, "%s wants a number of at least 0, got %g", what, value);
    return value;
}

Rgb read_rgb(Parser *p, const char *what)
{
    Span first = parse_peek(p)->span;
    Rgb value = parse_rgb(p);
    if (!rgb_is_finite(value))
        parse_fail(p, span_join(first, parse_last_span(p)), "%s wants finite numbers", what);
    return value;
}

void *read_grow(Parser *p, void *items, size_t count, size_t *capacity, size_t item_size)
{
    if (count < *capacity)
        return items;
    size_t grown_capacity = *capacity ? *capacity * 2 : 8;
    void *grown = parse_no_null(p, arena_array(parse_arena(p), grown_capacity, item_size));
    if (count)
        memcpy(grown, items, count * item_size);
    *capacity = grown_capacity;
    return grown;
}

const void *const *read_append(Parser *p, const void *const *list, int *count, const void *node)
{
    size_t used = (size_t)*count;
    if (used == LIST_MAX)
        parse_fail(p, parse_last_span(p), "more than %d of these", LIST_MAX);
    const void **grown = parse_alloc(p, (used + 1) * sizeof *grown);
    if (used)
        memcpy(grown, list, used * sizeof *grown);
    grown[used] = node;
    ++*count;
    return (const void *const *)grown;
}
