/* The base floor: memory, arenas, diagnostics, maps, random numbers, threads, statistics.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/arena.h"
#include "base/diag.h"
#include "base/guess.h"
#include "base/json.h"
#include "base/mem.h"
#include "base/rng.h"
#include "base/stats.h"
#include "base/strmap.h"
#include "base/work.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void test_mem_fails_on_order(void **state)
{
    (void)state;
    assert_null(mem_array(SIZE_MAX / 2, 4));
    mem_fail_from(3);
    void *a = mem_alloc(8), *b = mem_alloc(8), *c = mem_alloc(8), *d = mem_alloc(8);
    mem_fail_from(0);
    assert_non_null(a);
    assert_non_null(b);
    assert_null(c);
    assert_null(d);
    mem_free(a);
    mem_free(b);
    mem_free(NULL);
}

static void test_mem_grow(void **state)
{
    (void)state;
    int *items = NULL;
    size_t capacity = 0;
    for (size_t i = 0; i < 1000; i++) {
        assert_int_equal(mem_grow((void **)&items, i, &capacity, sizeof *items), 0);
        items[i] = (int)i;
    }
    for (int i = 0; i < 1000; i++)
        assert_int_equal(items[i], i);
    size_t before = capacity;
    mem_fail_from(1);
    assert_int_equal(mem_grow((void **)&items, capacity, &capacity, sizeof *items), -1);
    mem_fail_from(0);
    assert_int_equal(capacity, before);
    mem_free(items);
}

static void test_arena(void **state)
{
    (void)state;
    Arena *arena = arena_new();
    char *small = arena_strndup(arena, "photon map", 6);
    assert_string_equal(small, "photon");
    /* Items are zeroed, aligned, and apart, also when larger than a block. */
    unsigned char *large = arena_alloc(arena, 1 << 23);
    assert_int_equal(large[0] | large[(1 << 23) - 1], 0);
    for (size_t size = 0; size < 300; size++) {
        unsigned char *item = arena_alloc(arena, size);
        assert_int_equal((uintptr_t)item % 16, 0);
        memset(item, 0xff, size);
    }
    assert_string_equal(small, "photon");
    assert_null(arena_array(arena, SIZE_MAX / 4, 8));
    assert_null(arena_alloc(arena, SIZE_MAX - 3));
    assert_true(arena_bytes(arena) > 1 << 23);
    arena_reset(arena);
    assert_int_equal(arena_bytes(arena), 0);
    unsigned char *again = arena_alloc(arena, 300);
    for (int i = 0; i < 300; i++)
        assert_int_equal(again[i], 0);
    arena_free(arena);
    arena_free(NULL);
}

static void keep_message(void *ctx, const char *text)
{
    strncat(ctx, text, 8000 - strlen(ctx));
}

static void test_diag_points(void **state)
{
    (void)state;
    static const char text[] = "sphere { 0, 1 }\r\n\tsphere { <0,0,0>, R + <1,2> }\n";
    Source source = {"scenes/a.pov", text, sizeof text - 1};
    uint32_t at = (uint32_t)(strstr(text, "R +") - text);
    char said[8192] = "";
    Diag diag;
    diag_init(&diag, keep_message, said);
    diag_error(&diag, (Span){&source, at, at + 9}, "radius wants a float, got a vector of %d", 2);
    diag_note(&diag, (Span){&source, 0, 6}, "included from here");
    assert_string_equal(said, "scenes/a.pov:2:20: error: radius wants a float, got a vector of 2\n"
                              "    2 |     sphere { <0,0,0>, R + <1,2> }\n"
                              "      |                       ^~~~~~~~~\n"
                              "scenes/a.pov:1:1: note: included from here\n");
    assert_int_equal(diag.errors, 1);
    diag_done(&diag);
}

static void test_diag_edges(void **state)
{
    (void)state;
    char said[8192] = "";
    char line[3000];
    memset(line, 'x', sizeof line);
    Source source = {"long", line, sizeof line};
    Diag diag;
    diag_init(&diag, keep_message, said);
    /* A span past the end, and a line without end, stay inside the text. */
    diag_error(&diag, (Span){&source, 2999, 5000}, "%s", "at the end");
    diag_error(&diag, (Span){&source, 0, 3000}, "all of it");
    assert_true(strlen(said) < 2000);
    said[0] = 0;
    for (int i = 0; i < 15; i++)
        diag_warn(&diag, WARN_LANGUAGE, SPAN_NONE, "odd");
    assert_int_equal(diag.warnings[WARN_LANGUAGE], 15);
    diag_done(&diag);
    assert_non_null(strstr(said, "(5 more)"));
}

static void test_strmap(void **state)
{
    (void)state;
    Arena *arena = arena_new();
    StrMap map;
    static int values[2000];
    strmap_init(&map, arena);
    assert_null(strmap_find(&map, "x", 1));
    for (int i = 0; i < 2000; i++) {
        char key[16];
        int length = snprintf(key, sizeof key, "key%d", i);
        assert_int_equal(strmap_set(&map, key, (size_t)length, &values[i]), 0);
    }
    assert_ptr_equal(strmap_find(&map, "key1999", 7), &values[1999]);
    assert_ptr_equal(strmap_find(&map, "key19990", 4), &values[1]);
    strmap_set(&map, "key7", 4, NULL);
    assert_null(strmap_find(&map, "key7", 4));
    assert_ptr_equal(strmap_find(&map, "key8", 4), &values[8]);
    arena_free(arena);
}

static void test_words(void **state)
{
    (void)state;
    assert_int_equal(word_distance("sphere", 6, "sphere", 6, 3), 0);
    assert_int_equal(word_distance("shpere", 6, "sphere", 6, 3), 1);
    assert_int_equal(word_distance("spere", 5, "sphere", 6, 3), 1);
    assert_int_equal(word_distance("", 0, "abc", 3, 3), 3);
    assert_int_equal(word_distance("union", 5, "torus", 5, 3), 4);
}

/* What is offered in any order gives the same; a word that shares nothing is no guess. */
static void test_guess(void **state)
{
    (void)state;
    static const char *const words[] = {"pigment", "finish", "cone", "cones", "cane", "x"};
    static const struct {
        const char *word, *best;
    } cases[] = {{"pigmnet", "pigment"}, {"camera", NULL}, {"cine", "cane"}, {"cone", "cone"},
                 {"finsh", "finish"},    {"y", NULL},      {"", NULL}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        Guess up = guess_begin(cases[i].word, strlen(cases[i].word)), down = up;
        for (int k = 0; k < 6; k++) {
            guess_try(&up, words[k]);
            guess_try(&down, words[5 - k]);
        }
        assert_ptr_equal(up.best, down.best);
        if (cases[i].best)
            assert_string_equal(up.best, cases[i].best);
        else
            assert_null(up.best);
    }
}

/* Uniform numbers: mean 1/2, and no correlation of neighbours, within 4 standard errors. */
static void test_rng(void **state)
{
    (void)state;
    enum { N = 100000 };
    double sum = 0, product = 0, last = 0;
    for (uint64_t i = 0; i < N; i++) {
        Rng rng = rng_at(1, 2, i);
        double u = rng_double(&rng);
        assert_true(u >= 0 && u < 1);
        sum += u;
        product += (u - 0.5) * (last - 0.5);
        last = u;
        assert_true(rng_float(&rng) < 1);
    }
    assert_true(fabs(sum / N - 0.5) < 4 * sqrt(1.0 / 12 / N));
    assert_true(fabs(product / N) < 4 * (1.0 / 12) / sqrt(N));
    Rng a = rng_at(1, 2, 3), b = rng_at(1, 2, 3), c = rng_at(1, 3, 3), d = rng_at(2, 2, 3);
    uint64_t first = rng_u64(&a);
    assert_true(first == rng_u64(&b) && first != rng_u64(&c) && first != rng_u64(&d));
    assert_true(rng_u64(&a) != first);
}

typedef struct Tally {
    int done[1000];
    int limit;
} Tally;

static void tally(void *ctx, size_t index, int thread)
{
    Tally *t = ctx;
    t->done[index] += 1 + 0 * thread;
    if (t->limit && index >= (size_t)t->limit)
        work_interrupted = 1;
}

static void test_work(void **state)
{
    (void)state;
    for (int threads = 1; threads <= 8; threads += 7) {
        Tally t = {.limit = 0};
        assert_int_equal(work_for(threads, 1000, tally, &t), OK);
        for (int i = 0; i < 1000; i++)
            assert_int_equal(t.done[i], 1);
    }
    Tally cut = {.limit = 10};
    assert_int_equal(work_for(2, 1000, tally, &cut), ERR_INTERRUPTED);
    work_interrupted = 0;
    assert_int_equal(cut.done[999], 0);
    Tally late = {.limit = 999}; /* the last item may have cut itself short */
    assert_int_equal(work_for(2, 1000, tally, &late), ERR_INTERRUPTED);
    work_interrupted = 0;
    assert_int_equal(work_for(4, 0, tally, &cut), OK);
    assert_true(work_thread_count() >= 1);
}

static void test_status_and_stats(void **state)
{
    (void)state;
    assert_int_equal(status_exit_code(OK), 0);
    assert_int_equal(status_exit_code(ERR_SYNTAX), 2);
    assert_int_equal(status_exit_code(ERR_MEMORY), 3);
    assert_int_equal(status_exit_code(ERR_INTERRUPTED), 130);
    Stats a = {.count = {[STAT_PIXELS] = 2}, .seconds = {[PHASE_EYE] = 1}}, b = a;
    stats_add(&a, &b);
    assert_int_equal(a.count[STAT_PIXELS], 4);
    assert_true(a.seconds[PHASE_EYE] == 2);
    assert_string_equal(stat_name(STAT_PIXELS), "film.pixels");
    assert_string_equal(phase_name(PHASE_EYE), "eye");
}

/* Return what json_string prints of a text; free it. */
static char *as_json(const char *text)
{
    char *out;
    size_t size;
    FILE *file = open_memstream(&out, &size);
    assert_non_null(file);
    json_string(file, text);
    assert_int_equal(fclose(file), 0);
    return out;
}

#define FFFD "\xEF\xBF\xBD"

/* What is no UTF-8 becomes U+FFFD, one for each part that a character could begin with; the last
 * and the first characters of every length stay. */
static void test_json_is_utf8(void **state)
{
    (void)state;
    static const char *const cases[][2] = {
        {"", ""},
        {"a\"b\\\n\x7f", "a\\\"b\\\\\\u000a\\u007f"},
        {"\xC2\x80 \xDF\xBF", "\xC2\x80 \xDF\xBF"},
        {"\xE0\xA0\x80 \xED\x9F\xBF", "\xE0\xA0\x80 \xED\x9F\xBF"},
        {"\xEE\x80\x80 \xEF\xBF\xBF", "\xEE\x80\x80 \xEF\xBF\xBF"},
        {"\xF0\x90\x80\x80 \xF4\x8F\xBF\xBF", "\xF0\x90\x80\x80 \xF4\x8F\xBF\xBF"},
        {"gr\xFC"
         "n",
         "gr" FFFD "n"},                                /* Latin-1 */
        {"\x80\xBF", FFFD FFFD},                        /* nothing before them */
        {"\xC0\xAF \xC1\xBF", FFFD FFFD " " FFFD FFFD}, /* overlong */
        {"\xE0\x9F\xBF", FFFD FFFD FFFD},
        {"\xF0\x8F\xBF\xBF", FFFD FFFD FFFD FFFD},
        {"\xED\xA0\x80\xED\xBF\xBF", FFFD FFFD FFFD FFFD FFFD FFFD}, /* surrogates */
        {"\xF4\x90\x80\x80", FFFD FFFD FFFD FFFD},                   /* beyond U+10FFFF */
        {"\xF5\x80\xFE\xFF", FFFD FFFD FFFD FFFD},
        {"\xC3\"", FFFD "\\\""}, /* cut short */
        {"\xE2\x82"
         "A",
         FFFD "A"},
        {"\xF0\x9F\x92\xE2\x82\xAC", FFFD "\xE2\x82\xAC"},
        {"x\xC3", "x" FFFD},
        {"\xE2\x82", FFFD},
        {"\xF0\x9F\x92", FFFD}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char wanted[128], *found = as_json(cases[i][0]);
        snprintf(wanted, sizeof wanted, "\"%s\"", cases[i][1]);
        assert_string_equal(found, wanted);
        free(found);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_mem_fails_on_order),
        cmocka_unit_test(test_mem_grow),
        cmocka_unit_test(test_arena),
        cmocka_unit_test(test_diag_points),
        cmocka_unit_test(test_diag_edges),
        cmocka_unit_test(test_strmap),
        cmocka_unit_test(test_words),
        cmocka_unit_test(test_guess),
        cmocka_unit_test(test_rng),
        cmocka_unit_test(test_work),
        cmocka_unit_test(test_status_and_stats),
        cmocka_unit_test(test_json_is_utf8),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
