/* Expressions against known values: tests/lang/points.csv.
 *
 * Columns: kind, text of the language, expected.  float: what str(e,0,12) gives; vec3, vec5:
 * vstr; color: of a declared colour; string: the string itself; debug: the debug text of a
 * whole scene; error: the scene must be refused; not_yet: refused with a message that says so.
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

enum { TEXT_MAX = 8192 };

/* What a scene said. */
typedef struct Heard {
    char text[TEXT_MAX];
} Heard;

static void hear(void *ctx, const char *text)
{
    Heard *heard = ctx;
    size_t length = strlen(heard->text);
    snprintf(heard->text + length, sizeof heard->text - length, "%s", text);
}

static Status load_text(const char *text, Heard *heard)
{
    Diag diag;
    SdlOptions options = {.width = 4, .height = 3, .threads = 1, .max_tokens = 1000000};
    Scene *scene;
    heard->text[0] = 0;
    diag_init(&diag, hear, heard);
    Status status = sdl_load_text(&diag, "row.pms", text, strlen(text), &options, &scene);
    assert_int_equal(status == OK, scene != NULL);
    scene_free(scene);
    diag_done(&diag);
    return status;
}

/* --- the table ------------------------------------------------------------------------------ */

typedef struct Row {
    char kind[16], sdl[TEXT_MAX / 4], expected[TEXT_MAX / 4];
} Row;

/* Take one field of comma-separated values; a field in quotes holds "" for ". */
static const char *take_field(const char *at, char *out)
{
    bool is_quoted = *at == '"';
    at += is_quoted;
    while (*at && (is_quoted || (*at != ',' && *at != '\n'))) {
        if (is_quoted && *at == '"') {
            if (at[1] != '"')
                break;
            at++;
        }
        *out++ = *at++;
    }
    *out = 0;
    at += is_quoted;
    return *at == ',' ? at + 1 : at;
}

static bool read_row(FILE *file, Row *row)
{
    char line[TEXT_MAX / 4];
    if (!fgets(line, sizeof line, file))
        return false;
    take_field(take_field(take_field(line, row->kind), row->sdl), row->expected);
    return true;
}

/* Write the scene that shows the value of a row with #debug. */
static void scene_of(const Row *row, char scene[TEXT_MAX])
{
    static const struct {
        const char *kind, *format;
    } forms[] = {
        {"float", "#debug str(%s,0,12)"},
        {"vec3", "#debug vstr(3,%s,\",\",0,9)"},
        {"vec5", "#debug vstr(5,%s,\",\",0,6)"},
        {"colour", "#declare C=%s; #debug vstr(5,C,\",\",0,7)"},
        {"string", "#debug %s"},
    };
    const char *format = "%s";
    for (size_t i = 0; i < sizeof forms / sizeof forms[0]; i++)
        if (strcmp(forms[i].kind, row->kind) == 0)
            format = forms[i].format;
    char body[TEXT_MAX / 2];
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral"
    snprintf(body, sizeof body, format, row->sdl);
#pragma GCC diagnostic pop
    snprintf(scene, TEXT_MAX,
             "#version 3.7; global_settings{assumed_gamma 1}\n%s\n#debug \"|\"\nsphere{0,1}\n",
             body);
}

/* Drop warnings, which come before the text of interest, and what follows the mark. */
static void value_in(const char *heard, char out[TEXT_MAX])
{
    const char *end = strrchr(heard, '|');
    const char *begin = end ? end : heard;
    while (begin > heard && begin[-1] != '\n')
        begin--;
    snprintf(out, TEXT_MAX, "%.*s", end ? (int)(end - begin) : 0, begin);
}

static bool row_holds(const Row *row)
{
    char scene[TEXT_MAX], value[TEXT_MAX];
    Heard heard;
    scene_of(row, scene);
    Status status = load_text(scene, &heard);
    bool is_right;
    if (strcmp(row->kind, "error") == 0)
        is_right = status == ERR_SYNTAX || status == ERR_SCENE;
    else if (strcmp(row->kind, "not_yet") == 0)
        is_right = status == ERR_SYNTAX && strstr(heard.text, "pms has no `");
    else if (strcmp(row->kind, "debug") == 0)
        is_right = status == OK && strstr(heard.text, row->expected);
    else {
        value_in(heard.text, value);
        is_right = status == OK && strcmp(value, row->expected) == 0;
    }
    if (!is_right)
        print_error("%s: %s\n  expected %s, got status %s and\n%s\n", row->kind, row->sdl,
                    row->expected, status_text(status), heard.text);
    return is_right;
}

static void test_points(void **state)
{
    (void)state;
    FILE *file = fopen("tests/lang/points.csv", "r");
    assert_non_null(file);
    Row row;
    int rows = 0, wrong = 0;
    read_row(file, &row);
    for (; read_row(file, &row); rows++)
        wrong += !row_holds(&row);
    fclose(file);
    assert_int_equal(wrong, 0);
    assert_true(rows > 240);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_points),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
