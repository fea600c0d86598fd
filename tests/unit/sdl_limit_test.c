/* Scenes that would never end: each stops at a limit, with a message that names it.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/sdl.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { HEARD_MAX = 8192, REPEATS = 100000 };

static void hear(void *ctx, const char *text)
{
    char *heard = ctx;
    size_t length = strlen(heard);
    snprintf(heard + length, HEARD_MAX - length, "%s", text);
}

static Status load(const char *text, const SdlOptions *options, char heard[HEARD_MAX])
{
    Diag diag;
    Scene *scene;
    heard[0] = 0;
    diag_init(&diag, hear, heard);
    Status status = sdl_load_text(&diag, "limit.pms", text, strlen(text), options, &scene);
    scene_free(scene);
    diag_done(&diag);
    return status;
}

static void assert_stops(const char *text, const SdlOptions *options, const char *message)
{
    char heard[HEARD_MAX];
    assert_int_equal(load(text, options, heard), ERR_SYNTAX);
    if (!strstr(heard, message))
        print_error("wanted `%s`, got\n%s\n", message, heard);
    assert_non_null(strstr(heard, message));
}

static void test_tokens(void **state)
{
    (void)state;
    SdlOptions options = {.max_tokens = 1000, .threads = 1};
    assert_stops("#while (1) #end", &options, "more than 1000 tokens");
    assert_stops("#for (I, 0, 1, 1e-9) #end", &options, "more than 1000 tokens");
    assert_stops("#for (I, 1e30, 2e30) #end", &options, "more than 1000 tokens");
    assert_stops("sphere { #while (1) #if (1) #end #end", &options, "more than 1000 tokens");
}

static void test_memory(void **state)
{
    (void)state;
    SdlOptions options = {.max_bytes = 1 << 20, .threads = 1};
    assert_stops("#while (1) sphere { 0, 1 } #end", &options, "more than 1048576 bytes of memory");
}

/* Repeat a piece of text, so deep that careless recursion would leave the stack. */
static char *repeated(const char *piece)
{
    size_t length = strlen(piece);
    char *text = malloc(length * REPEATS + 1);
    assert_non_null(text);
    for (size_t i = 0; i < REPEATS; i++)
        memcpy(text + i * length, piece, length);
    text[length * REPEATS] = 0;
    return text;
}

static void test_nesting(void **state)
{
    (void)state;
    static const struct {
        const char *begin, *piece;
    } rows[] = {
        {"#declare A = ", "("},
        {"#declare A = ", "<1,"},
        {"#declare A = ", "-"},
        {"#declare A = ", "!"},
        {"#declare A = ", "(0?1:"},
        {"#declare A = ", "sin("},
        {"#declare A = ", "max(1,"},
        {"#declare A = ", "concat("},
        {"#declare A = ", "asc(strupr("},
        {"#declare A = array[1]; #declare B = ", "A["},
        {"#macro M(A) A #end ", "M("},
        {"", "#declare A = "},
        {"", "#if ("},
        {"", "#switch ("},
        {"", "#for (I, "},
        {"", "#include "},
        {"", "#debug "},
        {"", "#default {"},
        {"", "union {"},
        {"", "sphere { 0, 1 clipped_by {"},
        {"#declare A = ", "array[1] {"},
        {"sphere { 0, 1 ", "transform {"},
        {"sphere { 0, 1 ", "pigment { checker "},
        {"", "#declare T = texture { pigment {} } "},
        {"#macro M() ", "#macro N() "},
    };
    SdlOptions options = {.max_tokens = 1000000, .threads = 1};
    char heard[HEARD_MAX];
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        char *tail = repeated(rows[i].piece);
        size_t size = strlen(rows[i].begin) + strlen(tail) + 1;
        char *text = malloc(size);
        assert_non_null(text);
        snprintf(text, size, "%s%s", rows[i].begin, tail);
        Status status = load(text, &options, heard);
        assert_true(status == OK || status == ERR_SYNTAX);
        free(text);
        free(tail);
    }
}

static void test_macro_recursion(void **state)
{
    (void)state;
    SdlOptions options = {.max_tokens = 1000000, .threads = 1};
    assert_stops("#macro M() M() #end M()", &options, "macros nest too deep (limit 200)");
    assert_stops("#macro M(A) #local B = M(A); B #end #declare C = M(1);", &options, "too deep");
    assert_stops("#macro M(A) union { M(A) } #end M(1)", &options, "too deep");
    assert_stops("#macro A() B() #end #macro B() A() #end A()", &options, "macros nest too deep");
}

/* Each level doubles what a place costs. */
static void test_density_maps(void **state)
{
    (void)state;
    SdlOptions options = {.max_tokens = 1000000, .threads = 1};
    assert_stops("#declare D = density { gradient y }\n"
                 "#declare I = 0; #while (I < 30)\n"
                 "  #declare D = density { gradient x density_map { [0 D] [1 D] } }\n"
                 "  #declare I = I + 1;\n"
                 "#end\n",
                 &options, "patterns of a place, more than 1000");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_tokens),
        cmocka_unit_test(test_memory),
        cmocka_unit_test(test_nesting),
        cmocka_unit_test(test_macro_recursion),
        cmocka_unit_test(test_density_maps),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
