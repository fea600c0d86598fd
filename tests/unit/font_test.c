/* Fonts: measured places of letters, closed outlines, and files that are none.
 * SPDX-License-Identifier: Apache-2.0 */
#include "image/font.h"

#include "base/file.h"
#include "base/mem.h"
#include "base/rng.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define TIMROM "/usr/share/povray-3.7/include/timrom.ttf" /* of the package the tests install */

static Diag diag;
static Arena *arena;

static int set_up(void **state)
{
    (void)state;
    diag_init(&diag, diag_drop, NULL);
    arena = arena_new();
    return !arena;
}

static int tear_down(void **state)
{
    (void)state;
    arena_free(arena);
    diag_done(&diag);
    return 0;
}

static Font *timrom(void)
{
    Font *font;
    assert_int_equal(font_open(&diag, TIMROM, &font), OK);
    return font;
}

static Glyph glyph_of(Font *font, uint32_t character)
{
    Glyph glyph;
    assert_int_equal(font_glyph(&diag, font, font_glyph_number(font, character), arena, &glyph),
                     OK);
    return glyph;
}

/* Return where a text ends: the right side of its last glyph. */
static double width_of(Font *font, const char *text, double offset)
{
    double pen = 0, right = 0;
    uint32_t before = 0;
    for (int i = 0; text[i]; i++) {
        uint32_t number = font_glyph_number(font, (uint32_t)text[i]);
        Glyph glyph = glyph_of(font, (uint32_t)text[i]);
        pen += i ? font_kerning(font, before, number) : -glyph.left;
        for (uint32_t k = 0; k < glyph.span_count; k++)
            right = fmax(right, pen + glyph.spans[k].a[0]);
        pen += glyph.advance + offset;
        before = number;
    }
    return right;
}

static void test_measured_widths(void **state)
{
    (void)state;
    Font *font = timrom();
    assert_true(fabs(width_of(font, "A", 0) - .736) < 2e-5); /* probes */
    assert_true(fabs(width_of(font, "AV", 0) - 1.278) < 2e-5);
    assert_true(fabs(width_of(font, "AV", .1) - 1.378) < 2e-5);
    assert_true(fabs(width_of(font, "VA", 0) - 1.316) < 2e-5);
    assert_true(fabs(width_of(font, "A A", 0) - 1.74) < 2e-5);
    assert_true(fabs(width_of(font, " A", 0) - .996) < 2e-5);
    assert_true(fabs(width_of(font, "I", 0) - .296) < 2e-5);
    font_close(font);
}

/* Every span begins where the one before ends, or the loop before is closed. */
static void test_outlines_are_closed(void **state)
{
    (void)state;
    Font *font = timrom();
    uint32_t loops = 0;
    for (uint32_t c = 33; c < 127; c++) {
        Glyph glyph = glyph_of(font, c);
        const CurveSpan *first = glyph.spans;
        assert_true(glyph.degree == 2 && glyph.span_count > 2);
        for (uint32_t i = 0; i < glyph.span_count; i++) {
            const CurveSpan *span = &glyph.spans[i];
            if (span->a[2] == first->a[0] && span->b[2] == first->b[0]) {
                loops++;
                first = span + 1;
                continue;
            }
            assert_true(i + 1 < glyph.span_count);
            assert_true(span[0].a[2] == span[1].a[0] && span[0].b[2] == span[1].b[0]);
        }
        assert_true(first == glyph.spans + glyph.span_count);
    }
    assert_true(loops > 110); /* holes and dots */
    assert_int_equal(glyph_of(font, ' ').span_count, 0);
    font_close(font);
}

static void test_broken_files_are_refused(void **state)
{
    (void)state;
    const char *text;
    size_t size;
    assert_int_equal(file_read(&diag, TIMROM, 1 << 24, arena, &text, &size), OK);
    char path[] = "/tmp/pms_font_XXXXXX", *bytes = arena_copy(arena, text, size);
    int fd = mkstemp(path), opened = 0, refused = 0;
    assert_true(fd >= 0);
    Rng rng = rng_at(4, 1, 0);
    for (int round = 0; round < 120; round++) {
        memcpy(bytes, text, size);
        for (int i = 0; i < round; i++)
            bytes[rng_u32(&rng) % (i % 2 ? size : 300)] = (char)rng_u32(&rng);
        size_t length = round % 3 ? size : size * (size_t)(round % 40) / 40;
        assert_true(ftruncate(fd, 0) == 0 && pwrite(fd, bytes, length, 0) == (ssize_t)length);
        Font *font;
        Status status = font_open(&diag, path, &font);
        opened += status == OK;
        refused += status != OK;
        for (uint32_t c = 32; status == OK && c < 127; c++) {
            Glyph glyph;
            font_glyph(&diag, font, font_glyph_number(font, c), arena, &glyph);
        }
        font_close(font);
    }
    assert_true(opened > 5 && refused > 5);
    close(fd);
    unlink(path);
}

static void test_memory_that_is_out_is_no_accident(void **state)
{
    (void)state;
    Status status = ERR_MEMORY;
    for (long n = 1; status != OK && n < 3000; n++) {
        Font *font;
        Glyph glyph;
        mem_fail_from(n);
        status = font_open(&diag, TIMROM, &font);
        if (status == OK)
            status = font_glyph(&diag, font, font_glyph_number(font, 'a'), arena, &glyph);
        mem_fail_from(0);
        font_close(font);
    }
    assert_int_equal(status, OK);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_measured_widths, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_outlines_are_closed, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_broken_files_are_refused, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_memory_that_is_out_is_no_accident, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
