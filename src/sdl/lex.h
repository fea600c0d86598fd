/* The lexer: one array of tokens per file.
 *
 * Loops and macros are then moves of a cursor over tokens; no text is read twice.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SDL_LEX_H
#define PMS_SDL_LEX_H

#include "base/arena.h"
#include "base/diag.h"

#include <stdbool.h>

/* tokens.def: X(TOKEN_LBRACE, "{") ... for punctuation and classes;
 * keywords.def: X(KW_SPHERE, "sphere", has) for each reserved word, `has` saying whether pms
 * has it yet.  Kinds of keywords follow those of tokens. */
typedef enum TokenKind {
#define X(id, text) id,
#include "sdl/tokens.def"
#undef X
#define X(id, text, has) id,
#include "sdl/keywords.def"
#undef X
    TOKEN_KIND_COUNT
} TokenKind;

typedef struct Token {
    TokenKind kind;
    Span span;
    double number;      /* of TOKEN_NUMBER */
    const char *text;   /* of identifiers, interned: equal names have equal pointers; of strings
                           the raw bytes between the quotes, escapes not decoded */
    uint32_t length;    /* of text, bytes */
} Token;

typedef struct TokenFile {
    const Source *source;
    Token *tokens;      /* the last one is TOKEN_END */
    size_t count;
} TokenFile;

/* What is wrong with a TOKEN_ILLEGAL is in its text.  The lexer itself reports nothing but
 * memory: the parser reports an illegal token where it is used, so a skipped block may hold
 * what it likes. */
Status lex_source(Diag *diag, const Source *source, Arena *arena, TokenFile *out);

/* Return the keyword spelled so, or TOKEN_IDENTIFIER. */
TokenKind keyword_find(const char *text, size_t length);

/* Return the text of a token kind as messages show it ("`{`", "`sphere`", "a number"). */
const char *token_kind_text(TokenKind kind);

/* Return true if pms can do something with this reserved word. */
bool keyword_has(TokenKind keyword);

#endif
