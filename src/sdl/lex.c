/* The lexer.
 *
 * One pass over the bytes.  While it runs, the `#` of each conditional and loop is linked to
 * the `#` of its next branch or its #end, so that skipping a false block is one move.
 * Grammar: the lexical rules of grammar/pms.ebnf.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/lex.h"

#include "base/mem.h"
#include "sdl/decimal.h"
#include "sdl/vector_scan.h"

#include <stdlib.h>
#include <string.h>

enum {
    CTRL_Z = 0x1A,         /* ends a text file of old systems */
    NUMBER_MAX = 255,      /* characters */
    EXPONENT_MAX = 100000, /* beyond, the value is 0 or infinite anyhow */
};

/* A conditional, loop or macro whose #end has not been seen. */
typedef struct Open {
    TokenKind word; /* the one it began with */
    size_t last;    /* index of the `#` of its latest branch */
} Open;

typedef struct Lexer {
    const Source *source;
    const char *text;
    size_t size, at; /* bytes */
    Names *names;
    Token *tokens; /* heap, ours until the end */
    size_t count, capacity;
    Open *open; /* heap, ours until the end */
    size_t open_count, open_capacity;
    int list_size;  /* known to be in a list of mesh2: numbers of its vectors; else 0 */
    int list_depth; /* parentheses open in it */
    int mesh_depth; /* braces open in a mesh, its own included; 0: not known to be in one */
    bool is_out_of_memory;
    Token spare; /* handed out when memory is; nobody reads it */
} Lexer;

static Token *add(Lexer *lx, TokenKind kind, size_t begin, size_t end)
{
    if (mem_grow((void **)&lx->tokens, lx->count, &lx->capacity, sizeof *lx->tokens) != 0) {
        lx->is_out_of_memory = true;
        return &lx->spare;
    }
    Token *token = &lx->tokens[lx->count++];
    *token = (Token){.kind = kind, .span = {lx->source, (uint32_t)begin, (uint32_t)end}};
    lx->at = end;
    return token;
}

static void add_illegal(Lexer *lx, size_t begin, size_t end, const char *what)
{
    Token *token = add(lx, TOKEN_ILLEGAL, begin, end);
    token->text = what;
    token->length = (uint32_t)strlen(what);
}

static bool is_space(char c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

static bool is_beyond_ascii(char c)
{
    return (unsigned char)c > 127;
}

/* Return the byte `ahead` of the current one, or 0 past the end. */
static char byte_at(const Lexer *lx, size_t ahead)
{
    return lx->at + ahead < lx->size ? lx->text[lx->at + ahead] : 0;
}

static size_t line_end(const Lexer *lx, size_t from)
{
    while (from < lx->size && lx->text[from] != '\n' && lx->text[from] != '\r')
        from++;
    return from;
}

/* Skip a block comment; they nest. */
static void skip_block_comment(Lexer *lx)
{
    size_t begin = lx->at;
    int depth = 0;
    bool has_inner = false;
    while (lx->at < lx->size) {
        char c = byte_at(lx, 0), next = byte_at(lx, 1);
        bool is_open = c == '/' && next == '*', is_close = c == '*' && next == '/';
        lx->at += is_open || is_close ? 2 : 1;
        depth += is_open - is_close;
        has_inner = has_inner || depth > 1;
        if (depth == 0)
            return;
    }
    add_illegal(lx, begin, begin + 2,
                has_inner ? "this comment has no end; comments nest, so a `/*` in it wants its own"
                          : "this comment has no end");
    lx->at = lx->size;
}

static void skip_space_and_comments(Lexer *lx)
{
    for (;;) {
        char c = byte_at(lx, 0);
        if (is_space(c))
            lx->at++;
        else if (c == '/' && byte_at(lx, 1) == '/')
            lx->at = line_end(lx, lx->at);
        else if (c == '/' && byte_at(lx, 1) == '*')
            skip_block_comment(lx);
        else if (c == CTRL_Z)
            lx->size = lx->at;
        else
            return;
    }
}

/* A decimal as scanned: digits * 10^exponent when is_exact. */
typedef struct Decimal {
    uint64_t digits;
    int digit_count; /* without leading zeros */
    int exponent;
} Decimal;

static void take_digits(Lexer *lx, Decimal *d, bool is_fraction)
{
    for (; is_digit(byte_at(lx, 0)); lx->at++) {
        int digit = byte_at(lx, 0) - '0';
        if (d->digit_count || digit)
            d->digit_count++;
        if (d->digit_count <= DECIMAL_DIGITS) {
            d->digits = d->digits * 10 + (uint64_t)digit;
            d->exponent -= is_fraction;
        }
    }
}

/* Take an exponent; the letter alone counts as none. */
static void take_exponent(Lexer *lx, Decimal *d)
{
    if (byte_at(lx, 0) != 'e' && byte_at(lx, 0) != 'E')
        return;
    lx->at++;
    bool is_negative = byte_at(lx, 0) == '-';
    if ((byte_at(lx, 0) == '-' || byte_at(lx, 0) == '+') && is_digit(byte_at(lx, 1)))
        lx->at++;
    int exponent = 0;
    for (; is_digit(byte_at(lx, 0)); lx->at++)
        if (exponent < EXPONENT_MAX)
            exponent = exponent * 10 + (byte_at(lx, 0) - '0');
    d->exponent += is_negative ? -exponent : exponent;
}

/* Return the value of a number: by exact arithmetic where that will do, by the C library else. */
static double number_value(const Lexer *lx, const Decimal *d, size_t begin)
{
    if (decimal_is_exact(d->digit_count, d->exponent))
        return decimal_value(d->digits, d->exponent);
    char text[NUMBER_MAX + 1];
    size_t length = lx->at - begin;
    memcpy(text, lx->text + begin, length);
    text[length] = 0;
    return strtod(text, NULL);
}

static void lex_number(Lexer *lx)
{
    size_t begin = lx->at;
    Decimal d = {0};
    take_digits(lx, &d, false);
    if (byte_at(lx, 0) == '.') {
        lx->at++;
        take_digits(lx, &d, true);
    }
    take_exponent(lx, &d);
    if (byte_at(lx, 0) == '.' && is_digit(byte_at(lx, 1))) {
        add_illegal(lx, lx->at, lx->at + 1, "a number has one decimal point, this is a second");
        return;
    }
    if (lx->at - begin > NUMBER_MAX) {
        add_illegal(lx, begin, lx->at, "a number has at most 255 characters");
        return;
    }
    double value = number_value(lx, &d, begin);
    add(lx, TOKEN_NUMBER, begin, lx->at)->number = value;
}

static void lex_string(Lexer *lx)
{
    size_t begin = lx->at, i = begin + 1;
    for (; i < lx->size && lx->text[i] != '"'; i++)
        if (lx->text[i] == '\\' && i + 1 < lx->size && lx->text[i + 1] == '"')
            i++;
    if (i >= lx->size) {
        add_illegal(lx, begin, line_end(lx, begin), "this string has no end");
        lx->at = lx->size;
        return;
    }
    Token *token = add(lx, TOKEN_STRING, begin, i + 1);
    token->text = lx->text + begin + 1;
    token->length = (uint32_t)(i - begin - 1);
}

/* Link the branch at index `hash` to the one before it. */
static void link_branch(Lexer *lx, size_t hash, bool is_end)
{
    Open *open = &lx->open[lx->open_count - 1];
    lx->tokens[open->last].jump = hash;
    open->last = hash;
    lx->open_count -= is_end;
}

static bool can_branch(TokenKind opener, TokenKind word)
{
    bool is_switch = opener == KW_SWITCH;
    bool is_if = opener == KW_IF || opener == KW_IFDEF || opener == KW_IFNDEF;
    if (word == KW_CASE || word == KW_RANGE)
        return is_switch;
    return word == KW_ELSEIF ? is_if : is_if || is_switch;
}

/* Link a directive word whose `#` has index `hash`, if it is a branch. */
static void link_directive(Lexer *lx, TokenKind word, size_t hash)
{
    TokenKind opener = lx->open_count ? lx->open[lx->open_count - 1].word : TOKEN_END;
    switch ((int)word) {
    case KW_IF:
    case KW_IFDEF:
    case KW_IFNDEF:
    case KW_WHILE:
    case KW_FOR:
    case KW_SWITCH:
    case KW_MACRO:
        if (mem_grow((void **)&lx->open, lx->open_count, &lx->open_capacity, sizeof *lx->open) != 0)
            lx->is_out_of_memory = true;
        else
            lx->open[lx->open_count++] = (Open){word, hash};
        break;
    case KW_ELSE:
    case KW_ELSEIF:
    case KW_CASE:
    case KW_RANGE:
        if (can_branch(opener, word))
            link_branch(lx, hash, false);
        break;
    case KW_END:
        if (lx->open_count)
            link_branch(lx, hash, true);
        break;
    default:
        break;
    }
}

/* Take the triangles of plain vectors that come next in a mesh as one token.  False if there are
 * none. */
static bool lex_triangles(Lexer *lx)
{
    const char *text = lx->text + lx->at, *end = lx->text + lx->size, *at = text, *last = text;
    TokenKind before = lx->tokens[lx->count - 1].kind;
    uint32_t count = 0;
    if (before != TOKEN_LBRACE && before != TOKEN_RBRACE && before != TOKEN_TRIANGLES)
        return false;
    PlainTriangle triangle;
    for (; (at = scan_triangle(at, end, &triangle)); at = scan_blanks(at, end)) {
        last = at;
        count++;
    }
    if (count == 0)
        return false;
    Token *token = add(lx, TOKEN_TRIANGLES, lx->at, lx->at + (size_t)(last - text));
    token->text = text;
    token->length = count;
    return true;
}

static void lex_word(Lexer *lx)
{
    size_t begin = lx->at, end = begin;
    char first = byte_at(lx, 0);
    if (lx->mesh_depth == 1 && (first == 't' || first == 's') && lex_triangles(lx))
        return;
    while (end < lx->size && (is_letter(lx->text[end]) || is_digit(lx->text[end])))
        end++;
    if (end - begin > IDENTIFIER_MAX) {
        add_illegal(lx, begin, end, "a name has at most 255 characters");
        return;
    }
    const Name *name = name_intern(lx->names, lx->text + begin, end - begin);
    if (!name) {
        lx->is_out_of_memory = true;
        return;
    }
    bool is_directive = lx->count && lx->tokens[lx->count - 1].kind == TOKEN_HASH;
    Token *token = add(lx, name->kind, begin, end);
    token->text = name->text;
    token->length = name->length;
    if (is_directive && !lx->is_out_of_memory)
        link_directive(lx, name->kind, lx->count - 2);
}

static TokenKind punctuation(char c, char next, size_t *length)
{
    *length = 1;
    if (next == '=' && (c == '<' || c == '>' || c == '!')) {
        *length = 2;
        return c == '<' ? TOKEN_LESS_EQUAL : c == '>' ? TOKEN_GREATER_EQUAL : TOKEN_NOT_EQUAL;
    }
    static const char marks[] = "{}()[]<>=,;:?.+-*/!&|#";
    static const TokenKind kinds[] = {
        TOKEN_LBRACE,   TOKEN_RBRACE,  TOKEN_LPAREN, TOKEN_RPAREN, TOKEN_LBRACKET,  TOKEN_RBRACKET,
        TOKEN_LESS,     TOKEN_GREATER, TOKEN_EQUAL,  TOKEN_COMMA,  TOKEN_SEMICOLON, TOKEN_COLON,
        TOKEN_QUESTION, TOKEN_DOT,     TOKEN_PLUS,   TOKEN_MINUS,  TOKEN_STAR,      TOKEN_SLASH,
        TOKEN_NOT,      TOKEN_AND,     TOKEN_OR,     TOKEN_HASH};
    const char *mark = c ? strchr(marks, c) : NULL;
    return mark ? kinds[mark - marks] : TOKEN_ILLEGAL;
}

static TokenKind last_kind(const Lexer *lx)
{
    return lx->count ? lx->tokens[lx->count - 1].kind : TOKEN_END;
}

/* Return how many numbers the vectors of a list have, if one begins with the brace here. */
static int list_size(const Lexer *lx)
{
    switch ((int)last_kind(lx)) {
    case KW_UV_VECTORS:
        return 2;
    case KW_VERTEX_VECTORS:
    case KW_NORMAL_VECTORS:
    case KW_FACE_INDICES:
    case KW_NORMAL_INDICES:
    case KW_UV_INDICES:
        return 3;
    default:
        return 0;
    }
}

/* Keep track of the mesh and the list of mesh2 that the mark ahead begins, ends or nests in.  Where
 * a directive or a call of a macro may lead elsewhere than on in the text, both are forgotten. */
static void track_mesh(Lexer *lx, TokenKind mark)
{
    if (mark == TOKEN_HASH || (mark == TOKEN_LPAREN && last_kind(lx) == TOKEN_IDENTIFIER))
        lx->mesh_depth = lx->list_size = 0;
    if (mark == TOKEN_LBRACE && (lx->mesh_depth > 0 || last_kind(lx) == KW_MESH))
        lx->mesh_depth++;
    if (mark == TOKEN_RBRACE && lx->mesh_depth > 0)
        lx->mesh_depth--;
    if (mark == TOKEN_LBRACE || mark == TOKEN_RBRACE) {
        lx->list_size = mark == TOKEN_LBRACE ? list_size(lx) : 0;
        lx->list_depth = 0;
    } else if (mark == TOKEN_LPAREN || mark == TOKEN_RPAREN) {
        lx->list_depth += mark == TOKEN_LPAREN ? 1 : -1;
    }
}

/* Take the plain vectors that come next in a list of mesh2 as one token: a big mesh would be
 * millions.  What may go on as an expression is left to the parser.  False if there are none. */
static bool lex_vectors(Lexer *lx)
{
    const char *text = lx->text + lx->at, *end = lx->text + lx->size, *at = text, *last = text;
    TokenKind before = lx->tokens[lx->count - 1].kind;
    uint32_t count = 0;
    if (lx->list_depth != 0 || (before != TOKEN_COMMA && before != TOKEN_NUMBER))
        return false;
    double numbers[3];
    while (at < end && *at == '<' && (at = scan_vector(at, end, lx->list_size, numbers))) {
        const char *next = scan_blanks(at, end);
        if (next >= end || (*next != ',' && *next != '<' && *next != '}'))
            break;
        last = at;
        count++;
        at = *next == ',' ? scan_blanks(next + 1, end) : next;
    }
    if (count == 0)
        return false;
    Token *token = add(lx, TOKEN_VECTORS, lx->at, lx->at + (size_t)(last - text));
    token->text = text;
    token->length = count;
    return true;
}

static void lex_mark(Lexer *lx)
{
    size_t length, end = lx->at + 1;
    TokenKind kind = punctuation(byte_at(lx, 0), byte_at(lx, 1), &length);
    if (kind == TOKEN_LESS && lx->list_size && lex_vectors(lx))
        return;
    if (kind != TOKEN_ILLEGAL) {
        track_mesh(lx, kind);
        add(lx, kind, lx->at, lx->at + length);
    } else if (is_beyond_ascii(byte_at(lx, 0))) {
        while (end < lx->size && is_beyond_ascii(lx->text[end]))
            end++;
        add_illegal(lx, lx->at, end, "letters beyond ASCII stand only in strings and comments");
    } else if ((unsigned char)byte_at(lx, 0) < ' ') {
        add_illegal(lx, lx->at, end, "this byte belongs to no text; is the file a scene?");
    } else {
        add_illegal(lx, lx->at, end, "this character has no meaning in the language");
    }
}

static void lex_token(Lexer *lx)
{
    char c = byte_at(lx, 0);
    if (is_letter(c))
        lex_word(lx);
    else if (is_digit(c) || (c == '.' && is_digit(byte_at(lx, 1))))
        lex_number(lx);
    else if (c == '"')
        lex_string(lx);
    else
        lex_mark(lx);
}

static void lex_all(Lexer *lx)
{
    while (lx->at < lx->size && is_beyond_ascii(lx->text[lx->at]))
        lx->at++;
    while (!lx->is_out_of_memory) {
        skip_space_and_comments(lx);
        if (lx->at >= lx->size)
            break;
        lex_token(lx);
    }
    add(lx, TOKEN_END, lx->size, lx->size);
}

Status lex_source(Diag *diag, const Source *source, Names *names, Arena *arena, TokenFile *out)
{
    Lexer lx = {.source = source, .text = source->text, .size = source->size, .names = names};
    lex_all(&lx);
    Token *tokens = NULL;
    if (!lx.is_out_of_memory)
        tokens = arena_copy(arena, lx.tokens, lx.count * sizeof *tokens);
    *out = (TokenFile){.source = source, .tokens = tokens, .count = tokens ? lx.count : 0};
    mem_free(lx.tokens);
    mem_free(lx.open);
    return tokens ? OK : diag_no_memory(diag, source->path);
}
