/* The lexer: one array of tokens per file.
 *
 * Loops and macros are then moves of a cursor over tokens; no text is read twice.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SDL_LEX_H
#define PMS_SDL_LEX_H

#include "base/arena.h"
#include "base/diag.h"
#include "base/strmap.h"

#include <stdbool.h>

/* Kinds of keywords follow those of tokens. */
typedef enum TokenKind {
#define X(id, text) id,
#include "sdl/tokens.def"
#undef X
#define X(id, text, has) id,
#include "sdl/keywords.def"
#undef X
    TOKEN_KIND_COUNT
} TokenKind;

enum { IDENTIFIER_MAX = 255 };

/* Return true for a reserved word. */
static inline bool token_is_keyword(TokenKind kind)
{
    return kind > TOKEN_HASH;
}

/* A word as spelled, one for each different spelling in a scene: equal names are equal
 * pointers.  The symbol table hangs on it, so finding a variable costs no search. */
typedef struct Name {
    TokenKind kind;        /* TOKEN_IDENTIFIER or a keyword */
    uint32_t length;       /* of text, bytes */
    struct Symbol *symbol; /* the innermost one visible, or NULL */
    char text[];           /* terminated */
} Name;

typedef struct Names {
    StrMap map;   /* to Name */
    Arena *arena; /* borrowed; lives as long as the scene, since names end up in it */
} Names;

typedef struct Token {
    TokenKind kind;
    uint32_t length; /* of text, bytes; of TOKEN_VECTORS and TOKEN_TRIANGLES, how many there are */
    Span span;
    union {
        double number;    /* of TOKEN_NUMBER */
        const char *text; /* of identifiers, interned: equal names have equal pointers; of
                             strings the raw bytes between the quotes, escapes not decoded, not
                             terminated; of TOKEN_ILLEGAL what is wrong, terminated; of
                             TOKEN_VECTORS its beginning in the source: plain vectors with blanks
                             and commas between them, see vector_scan.h; of TOKEN_TRIANGLES that
                             of triangles of a mesh, likewise */
        size_t jump;      /* of the `#` of a conditional or loop: index of the `#` of its next
                             branch or its #end; 0: there is none */
    };
} Token;

typedef struct TokenFile {
    const Source *source;
    Token *tokens; /* the last one is TOKEN_END */
    size_t count;
} TokenFile;

/* Make an empty set of names that knows the keywords.  Fails with ERR_MEMORY. */
Status names_init(Diag *diag, Names *names, Arena *arena);

/* Return the name spelled so, made if new, or NULL when memory is out. */
Name *name_intern(Names *names, const char *text, size_t length);

/* Return the name of an identifier token. */
Name *name_of(const Token *identifier);

/* Cut `source` into tokens, which go to `arena`.
 *
 * What is wrong with a TOKEN_ILLEGAL is in its text.  The lexer itself reports nothing but
 * memory: the parser reports an illegal token where it is used, so a skipped block may hold
 * what it likes.  Fails with ERR_MEMORY.  O(size). */
Status lex_source(Diag *diag, const Source *source, Names *names, Arena *arena, TokenFile *out);

/* Return the keyword spelled so, or TOKEN_IDENTIFIER. */
TokenKind keyword_find(const char *text, size_t length);

/* Return the text of a token kind as messages show it ("`{`", "`sphere`", "a number"). */
const char *token_kind_text(TokenKind kind);

/* Return the spelling of a keyword. */
const char *keyword_text(TokenKind keyword);

/* Return true if pms can do something with this reserved word. */
bool keyword_has(TokenKind keyword);

#endif
