/* The language, case by case: tests/lang/<rule>/<case>.pms.
 *
 * What a case expects stands in its comments, one on a line:
 *     // expect error: LINE:COLUMN: TEXT     the scene is refused there, with TEXT in the message
 *     // expect error: TEXT                  the same, anywhere
 *     // expect warning: TEXT                a warning has TEXT in it, or one at LINE:COLUMN: TEXT
 *     // expect note: TEXT                   a note (the way to the error) has TEXT in it, the same
 *     // expect debug: TEXT                  the debug stream has TEXT in it
 * A case without `expect error` must load, with no more warnings than it expects, except
 * that a scene may be empty.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/sdl.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { HEARD_MAX = 1 << 20, LINE_LENGTH = 1024, CASES_MAX = 2000 };

static const char root[] = "tests/lang";
static const char no_object[] = ": warning: there is no object in the scene";

/* Everything a scene said, message after message. */
typedef struct Heard {
    char *text;
    size_t length;
} Heard;

static void hear(void *ctx, const char *text)
{
    Heard *heard = ctx;
    int wrote = snprintf(heard->text + heard->length, HEARD_MAX - heard->length, "%s", text);
    size_t room = HEARD_MAX - heard->length;
    heard->length += (size_t)wrote < room ? (size_t)wrote : room - 1;
}

/* Find the next line of `text` that has both parts; returns NULL if there is none. */
static const char *find_line(const char *text, const char *first, const char *second)
{
    for (const char *line = text; *line;) {
        const char *end = strchr(line, '\n');
        size_t length = end ? (size_t)(end - line) : strlen(line);
        char copy[LINE_LENGTH];
        snprintf(copy, sizeof copy, "%.*s", (int)length, line);
        const char *found = strstr(copy, first);
        if (found && strstr(found, second))
            return line;
        line += length + (end != NULL);
    }
    return NULL;
}

static int count_of(const char *text, const char *part)
{
    int count = 0;
    for (const char *at = text; (at = strstr(at, part)); at++)
        count++;
    return count;
}

/* What has been found out about a case. */
typedef struct Result {
    bool is_refused, is_right;
    int warnings; /* expected */
} Result;

/* Cut LINE:COLUMN: off `text`, if it is there, into the marker of a message at that place. */
static char *take_place(const char *what, char *text, char marker[LINE_LENGTH])
{
    int line, column, length = 0;
    if (sscanf(text, "%d:%d: %n", &line, &column, &length) != 2 || !length)
        return text;
    snprintf(marker, LINE_LENGTH, ":%d:%d: %s: ", line, column, what);
    return text + length;
}

/* Check one expectation, `what` and its text. */
static void check_line(const char *what, char *text, const char *heard, Result *result)
{
    char marker[LINE_LENGTH];
    snprintf(marker, sizeof marker, " %s: ", what);
    if (strcmp(what, "debug") == 0)
        marker[0] = 0;
    else
        text = take_place(what, text, marker);
    result->is_refused = result->is_refused || strcmp(what, "error") == 0;
    result->warnings += strcmp(what, "warning") == 0;
    if (find_line(heard, marker, text))
        return;
    print_error("  expected `%s`%s`\n", marker, text);
    result->is_right = false;
}

static void check_expectations(const char *path, const char *heard, Result *result)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    char line[LINE_LENGTH];
    while (fgets(line, sizeof line, file)) {
        char what[16];
        int taken = 0;
        line[strcspn(line, "\r\n")] = 0;
        if (sscanf(line, "// expect %15[a-z]: %n", what, &taken) == 1 && taken > 0)
            check_line(what, line + taken, heard, result);
    }
    fclose(file);
}

static bool case_holds(const char *path, Heard *heard)
{
    const char *library[] = {"tests/lang/library"};
    SdlOptions options = {.library_paths = library,
                          .library_path_count = 1,
                          .width = 320,
                          .height = 240,
                          .max_tokens = 200000,
                          .threads = 1};
    Diag diag;
    Scene *scene;
    heard->length = 0;
    heard->text[0] = 0;
    diag_init(&diag, hear, heard);
    Status status = sdl_load(&diag, path, &options, &scene);
    scene_free(scene);
    diag_done(&diag);
    int warnings = count_of(heard->text, ": warning: ") - count_of(heard->text, no_object);
    Result result = {.is_right = true};
    check_expectations(path, heard->text, &result);
    bool is_status_right = status == (result.is_refused ? ERR_SYNTAX : OK) ||
                           (result.is_refused && status == ERR_SCENE);
    if (result.is_right && is_status_right && (result.is_refused || warnings <= result.warnings))
        return true;
    print_error("%s: %s, %d warnings; it said\n%s\n", path, status_text(status), warnings,
                heard->text);
    return false;
}

static int compare_paths(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

/* Collect the .pms files of tests/lang/<folder>. */
static int list_folder(const char *folder, char **paths, int count)
{
    char path[LINE_LENGTH];
    snprintf(path, sizeof path, "%s/%s", root, folder);
    DIR *dir = folder[0] == '.' ? NULL : opendir(path);
    for (struct dirent *entry; dir && (entry = readdir(dir));) {
        size_t length = strlen(entry->d_name);
        if (length < 5 || strcmp(entry->d_name + length - 4, ".pms") != 0)
            continue;
        assert_true(count < CASES_MAX);
        size_t size = strlen(path) + length + 2;
        paths[count] = malloc(size);
        assert_non_null(paths[count]);
        snprintf(paths[count++], size, "%s/%s", path, entry->d_name);
    }
    if (dir)
        closedir(dir);
    return count;
}

static int list_cases(char **paths)
{
    int count = 0;
    DIR *dir = opendir(root);
    assert_non_null(dir);
    for (struct dirent *entry; (entry = readdir(dir));)
        count = list_folder(entry->d_name, paths, count);
    closedir(dir);
    qsort(paths, (size_t)count, sizeof *paths, compare_paths);
    return count;
}

static void test_cases(void **state)
{
    (void)state;
    char **paths = calloc(CASES_MAX, sizeof *paths);
    Heard heard = {malloc(HEARD_MAX), 0};
    assert_non_null(paths);
    assert_non_null(heard.text);
    int count = list_cases(paths), wrong = 0;
    for (int i = 0; i < count; i++) {
        wrong += !case_holds(paths[i], &heard);
        free(paths[i]);
    }
    free(paths);
    free(heard.text);
    print_message("# %d cases\n", count);
    assert_true(count > 0);
    assert_int_equal(wrong, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cases),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
