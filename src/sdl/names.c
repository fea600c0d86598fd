/* Names: every word of a scene is kept once, keywords from the start.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/lex.h"

#include <stddef.h>
#include <string.h>

typedef struct Keyword {
    const char *text;   /* as spelled */
    const char *quoted; /* as messages show it */
    bool has;
} Keyword;

/* In the order of keywords.def, which is that of strcmp. */
static const Keyword keywords[] = {
#define X(id, text, has) {text, "`" text "`", has},
#include "sdl/keywords.def"
#undef X
};

enum { KEYWORD_FIRST = TOKEN_HASH + 1, KEYWORD_COUNT = sizeof keywords / sizeof keywords[0] };

_Static_assert(KEYWORD_FIRST + KEYWORD_COUNT == TOKEN_KIND_COUNT, "keywords follow the tokens");

static const Keyword *keyword_at(TokenKind kind)
{
    return &keywords[(int)kind - KEYWORD_FIRST];
}

TokenKind keyword_find(const char *text, size_t length)
{
    size_t low = 0, high = KEYWORD_COUNT;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        int order = strncmp(text, keywords[middle].text, length);
        if (order == 0 && keywords[middle].text[length] != 0)
            order = -1;
        if (order == 0)
            return (TokenKind)((size_t)KEYWORD_FIRST + middle);
        if (order < 0)
            high = middle;
        else
            low = middle + 1;
    }
    return TOKEN_IDENTIFIER;
}

const char *token_kind_text(TokenKind kind)
{
    static const char *const tokens[] = {
#define X(id, text) text,
#include "sdl/tokens.def"
#undef X
    };
    return token_is_keyword(kind) ? keyword_at(kind)->quoted : tokens[kind];
}

const char *keyword_text(TokenKind keyword)
{
    return keyword_at(keyword)->text;
}

bool keyword_has(TokenKind keyword)
{
    return token_is_keyword(keyword) && keyword_at(keyword)->has;
}

static Name *name_new(Names *names, const char *text, size_t length, TokenKind kind)
{
    Name *name = arena_alloc(names->arena, sizeof *name + length + 1);
    if (!name)
        return NULL;
    name->kind = kind;
    name->length = (uint32_t)length;
    memcpy(name->text, text, length);
    return strmap_set(&names->map, text, length, name) == 0 ? name : NULL;
}

Status names_init(Diag *diag, Names *names, Arena *arena)
{
    *names = (Names){.arena = arena};
    strmap_init(&names->map, arena);
    for (int i = 0; i < KEYWORD_COUNT; i++) {
        const char *text = keywords[i].text;
        if (!name_new(names, text, strlen(text), (TokenKind)(KEYWORD_FIRST + i)))
            return diag_no_memory(diag, "the keywords");
    }
    return OK;
}

Name *name_intern(Names *names, const char *text, size_t length)
{
    Name *name = strmap_find(&names->map, text, length);
    return name ? name : name_new(names, text, length, TOKEN_IDENTIFIER);
}

Name *name_of(const Token *identifier)
{
    return (Name *)(identifier->text - offsetof(Name, text));
}
