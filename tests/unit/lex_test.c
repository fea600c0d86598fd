/* The lexer: tokens, numbers, comments, links of branches, bytes that are no text.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/lex.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* A source cut into tokens. */
typedef struct Cut {
    Arena *arena;
    Diag diag;
    Names names;
    Source source;
    TokenFile file;
} Cut;

static void cut_bytes(Cut *c, const char *bytes, size_t size)
{
    c->arena = arena_new();
    assert_non_null(c->arena);
    diag_init(&c->diag, NULL, NULL);
    assert_int_equal(names_init(&c->diag, &c->names, c->arena), OK);
    char *copy = arena_strndup(c->arena, bytes, size);
    assert_non_null(copy);
    c->source = (Source){"test.pms", copy, size};
    assert_int_equal(lex_source(&c->diag, &c->source, &c->names, c->arena, &c->file), OK);
    assert_int_equal(c->file.tokens[c->file.count - 1].kind, TOKEN_END);
}

static void cut(Cut *c, const char *text)
{
    cut_bytes(c, text, strlen(text));
}

static void cut_done(Cut *c)
{
    arena_free(c->arena);
    diag_done(&c->diag);
}

static void assert_kinds(const char *text, const TokenKind *kinds, size_t count)
{
    Cut c;
    cut(&c, text);
    assert_int_equal(c.file.count, count + 1);
    for (size_t i = 0; i < count; i++)
        assert_int_equal(c.file.tokens[i].kind, kinds[i]);
    cut_done(&c);
}

#define ASSERT_KINDS(text, ...)                                                                    \
    assert_kinds(text, (const TokenKind[]){__VA_ARGS__},                                           \
                 sizeof((const TokenKind[]){__VA_ARGS__}) / sizeof(TokenKind))

static void test_marks(void **state)
{
    (void)state;
    ASSERT_KINDS("{}()[]", TOKEN_LBRACE, TOKEN_RBRACE, TOKEN_LPAREN, TOKEN_RPAREN, TOKEN_LBRACKET,
                 TOKEN_RBRACKET);
    ASSERT_KINDS("<>= <=>=!= ! = <", TOKEN_LESS, TOKEN_GREATER_EQUAL, TOKEN_LESS_EQUAL,
                 TOKEN_GREATER_EQUAL, TOKEN_NOT_EQUAL, TOKEN_NOT, TOKEN_EQUAL, TOKEN_LESS);
    ASSERT_KINDS(",;:?.+-*/&|#", TOKEN_COMMA, TOKEN_SEMICOLON, TOKEN_COLON, TOKEN_QUESTION,
                 TOKEN_DOT, TOKEN_PLUS, TOKEN_MINUS, TOKEN_STAR, TOKEN_SLASH, TOKEN_AND, TOKEN_OR,
                 TOKEN_HASH);
    ASSERT_KINDS("== && <>", TOKEN_EQUAL, TOKEN_EQUAL, TOKEN_AND, TOKEN_AND, TOKEN_LESS,
                 TOKEN_GREATER);
}

static void test_words(void **state)
{
    (void)state;
    ASSERT_KINDS("sphere Sphere _a a1 x xx", KW_SPHERE, TOKEN_IDENTIFIER, TOKEN_IDENTIFIER,
                 TOKEN_IDENTIFIER, KW_X, TOKEN_IDENTIFIER);
    ASSERT_KINDS("V.x V .x V. x", TOKEN_IDENTIFIER, TOKEN_DOT, KW_X, TOKEN_IDENTIFIER, TOKEN_DOT,
                 KW_X, TOKEN_IDENTIFIER, TOKEN_DOT, KW_X);
    Cut c;
    cut(&c, "abc ab abc");
    assert_ptr_equal(c.file.tokens[0].text, c.file.tokens[2].text);
    assert_ptr_not_equal(c.file.tokens[0].text, c.file.tokens[1].text);
    assert_string_equal(c.file.tokens[0].text, "abc");
    assert_ptr_equal(name_of(&c.file.tokens[0]), name_of(&c.file.tokens[2]));
    cut_done(&c);
}

static void assert_number(const char *text, double wanted)
{
    Cut c;
    cut(&c, text);
    assert_int_equal(c.file.count, 2);
    assert_int_equal(c.file.tokens[0].kind, TOKEN_NUMBER);
    assert_memory_equal(&c.file.tokens[0].number, &wanted, sizeof wanted);
    assert_int_equal(c.file.tokens[0].span.end, strlen(text));
    cut_done(&c);
}

/* Every decimal is the double the C library makes of it, whichever way it is worked out. */
static void test_numbers(void **state)
{
    (void)state;
    static const char *const texts[] = {"0",
                                        "007",
                                        "1.e3",
                                        ".5",
                                        "1E+2",
                                        "1e-22",
                                        "1e22",
                                        "1e23",
                                        "0.1",
                                        "123456789012345",
                                        "1234567890123456",
                                        "0.1234567890123456789",
                                        "9007199254740993",
                                        "1e308",
                                        "1e309",
                                        "4.9e-324",
                                        "1e-400",
                                        "2.2250738585072011e-308",
                                        "00000.00001",
                                        "3.14159265358979323846",
                                        "1e100000000000",
                                        "0e999999",
                                        "5e-1",
                                        "999999999999999e7"};
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++)
        assert_number(texts[i], strtod(texts[i], NULL));
    assert_number("1e", 1);
    ASSERT_KINDS("1e+", TOKEN_NUMBER, TOKEN_PLUS);
    ASSERT_KINDS("0x10", TOKEN_NUMBER, TOKEN_IDENTIFIER);
    ASSERT_KINDS("1.5.5", TOKEN_ILLEGAL, TOKEN_NUMBER);
    ASSERT_KINDS("-1", TOKEN_MINUS, TOKEN_NUMBER);
    ASSERT_KINDS("1.x", TOKEN_NUMBER, KW_X);
}

static void test_strings(void **state)
{
    (void)state;
    Cut c;
    cut(&c, "\"a\\\"b // /*\" \"\" \"two\nlines\"");
    assert_int_equal(c.file.count, 4);
    assert_int_equal(c.file.tokens[0].length, 10);
    assert_memory_equal(c.file.tokens[0].text, "a\\\"b // /*", 10);
    assert_int_equal(c.file.tokens[1].length, 0);
    assert_int_equal(c.file.tokens[2].length, 9);
    cut_done(&c);
    cut(&c, "x \"open\ny");
    assert_int_equal(c.file.count, 3);
    assert_int_equal(c.file.tokens[1].kind, TOKEN_ILLEGAL);
    assert_string_equal(c.file.tokens[1].text, "this string has no end");
    cut_done(&c);
}

static void test_comments(void **state)
{
    (void)state;
    ASSERT_KINDS("1 // 2\n3 /* 4 /* 5 */ 6 // */ 7 /**/ 8", TOKEN_NUMBER, TOKEN_NUMBER,
                 TOKEN_NUMBER, TOKEN_NUMBER);
    ASSERT_KINDS("// /*\n1", TOKEN_NUMBER);
    ASSERT_KINDS("1 /* /* */", TOKEN_NUMBER, TOKEN_ILLEGAL);
    ASSERT_KINDS("/*/ 1", TOKEN_ILLEGAL);
    ASSERT_KINDS("*/", TOKEN_STAR, TOKEN_SLASH);
}

static void test_bytes(void **state)
{
    (void)state;
    ASSERT_KINDS("\xef\xbb\xbf x", KW_X);
    ASSERT_KINDS("x \xc3\xa9 y", KW_X, TOKEN_ILLEGAL, KW_Y);
    ASSERT_KINDS("x @ $ %", KW_X, TOKEN_ILLEGAL, TOKEN_ILLEGAL, TOKEN_ILLEGAL);
    ASSERT_KINDS("x \x1a y", KW_X);
    Cut c;
    cut_bytes(&c, "x\0y", 3);
    assert_int_equal(c.file.count, 4);
    assert_int_equal(c.file.tokens[1].kind, TOKEN_ILLEGAL);
    cut_done(&c);
    cut(&c, "");
    assert_int_equal(c.file.count, 1);
    cut_done(&c);
}

/* Return the index of the n-th `#`. */
static size_t hash_at(const Cut *c, int n)
{
    size_t i = 0;
    while (c->file.tokens[i].kind != TOKEN_HASH || n-- > 0)
        i++;
    return i;
}

static void assert_link(const Cut *c, int from, int to)
{
    assert_int_equal(c->file.tokens[hash_at(c, from)].jump, to < 0 ? 0 : hash_at(c, to));
}

static void test_links(void **state)
{
    (void)state;
    Cut c;
    /*          0     1        2       3     4     5       6    */
    cut(&c, "#if 1 #while 2 #end #elseif 3 #else #declare 4 #end");
    assert_link(&c, 0, 3);
    assert_link(&c, 1, 2);
    assert_link(&c, 3, 4);
    assert_link(&c, 4, 6);
    assert_link(&c, 6, -1);
    cut_done(&c);
    /*          0        1         2       3       4    */
    cut(&c, "#switch 1 #case 2 #range 3 #else #end #end #if");
    assert_link(&c, 0, 1);
    assert_link(&c, 1, 2);
    assert_link(&c, 2, 3);
    assert_link(&c, 3, 4);
    assert_link(&c, 5, -1);
    assert_link(&c, 6, -1);
    cut_done(&c);
    /* an #else that belongs to nothing links nothing */
    cut(&c, "#while 1 #else #end");
    assert_link(&c, 0, 2);
    assert_link(&c, 1, -1);
    cut_done(&c);
}

static void test_keywords(void **state)
{
    (void)state;
    static const struct {
        TokenKind kind;
        const char *text;
        bool has;
    } words[] = {
#define X(id, text, has) {id, text, has},
#include "sdl/keywords.def"
#undef X
    };
    assert_int_equal(sizeof words / sizeof words[0], 500);
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        assert_int_equal(keyword_find(words[i].text, strlen(words[i].text)), words[i].kind);
        assert_string_equal(keyword_text(words[i].kind), words[i].text);
        assert_int_equal(keyword_has(words[i].kind), words[i].has);
        assert_true(i == 0 || strcmp(words[i - 1].text, words[i].text) < 0);
    }
    assert_int_equal(keyword_find("spher", 5), TOKEN_IDENTIFIER);
    assert_int_equal(keyword_find("spheres", 7), TOKEN_IDENTIFIER);
    assert_int_equal(keyword_find("", 0), TOKEN_IDENTIFIER);
    assert_string_equal(token_kind_text(KW_SPHERE), "`sphere`");
    assert_string_equal(token_kind_text(TOKEN_LBRACE), "`{`");
    assert_string_equal(token_kind_text(TOKEN_NUMBER), "a number");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_marks),    cmocka_unit_test(test_words),
        cmocka_unit_test(test_numbers),  cmocka_unit_test(test_strings),
        cmocka_unit_test(test_comments), cmocka_unit_test(test_bytes),
        cmocka_unit_test(test_links),    cmocka_unit_test(test_keywords),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
