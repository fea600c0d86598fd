/* Files: whole or not at all.  SPDX-License-Identifier: Apache-2.0 */
#include "base/file.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char said[8192];

static void keep_message(void *ctx, const char *text)
{
    (void)ctx;
    snprintf(said, sizeof said, "%s", text);
}

typedef struct Folder {
    Diag diag;
    Arena *arena;
    char path[64];
} Folder;

static int set_up(void **state)
{
    Folder *folder = calloc(1, sizeof *folder);
    diag_init(&folder->diag, keep_message, NULL);
    folder->arena = arena_new();
    strcpy(folder->path, "/tmp/pms-file-XXXXXX");
    *state = folder;
    return mkdtemp(folder->path) ? 0 : -1;
}

static int tear_down(void **state)
{
    Folder *folder = *state;
    rmdir(folder->path);
    arena_free(folder->arena);
    diag_done(&folder->diag);
    free(folder);
    return 0;
}

static void test_round_trip(void **state)
{
    Folder *f = *state;
    char path[128];
    const char *text;
    size_t size;
    snprintf(path, sizeof path, "%s/a.txt", f->path);
    assert_false(file_exists(path));
    assert_int_equal(file_write(&f->diag, path, "one\0two", 7), OK);
    assert_true(file_exists(path));
    assert_int_equal(file_read(&f->diag, path, 100, f->arena, &text, &size), OK);
    assert_int_equal(size, 7);
    assert_memory_equal(text, "one\0two", 8);
    assert_int_equal(file_read(&f->diag, path, 6, f->arena, &text, &size), ERR_FILE);
    assert_non_null(strstr(said, "limit of 6"));
    unlink(path);
}

static void test_refusals(void **state)
{
    Folder *f = *state;
    const char *text;
    size_t size;
    assert_int_equal(file_read(&f->diag, f->path, 100, f->arena, &text, &size), ERR_FILE);
    assert_non_null(strstr(said, "is a directory"));
    assert_int_equal(file_read(&f->diag, "/nowhere/x", 100, f->arena, &text, &size), ERR_FILE);
    assert_non_null(strstr(said, "cannot open '/nowhere/x'"));
    assert_int_equal(file_read(&f->diag, "/dev/null", 100, f->arena, &text, &size), ERR_FILE);
    assert_int_equal(file_write(&f->diag, "/nowhere/x", "a", 1), ERR_FILE);
    assert_int_equal(file_write(&f->diag, f->path, "a", 1), ERR_FILE);
    char long_path[FILE_PATH_MAX + 10];
    memset(long_path, 'a', sizeof long_path - 1);
    long_path[sizeof long_path - 1] = 0;
    assert_int_equal(file_write(&f->diag, long_path, "a", 1), ERR_FILE);
}

static void test_discard_leaves_old_file(void **state)
{
    Folder *f = *state;
    char path[128];
    const char *text;
    size_t size;
    OutFile out;
    snprintf(path, sizeof path, "%s/b.txt", f->path);
    assert_int_equal(file_write(&f->diag, path, "old", 3), OK);
    assert_int_equal(out_begin(&f->diag, path, &out), OK);
    FILE *file = fopen(out.temp_path, "w");
    fputs("half of the new", file);
    fclose(file);
    out_discard(&out);
    assert_false(file_exists(out.temp_path));
    assert_int_equal(file_read(&f->diag, path, 100, f->arena, &text, &size), OK);
    assert_string_equal(text, "old");
    unlink(path);
}

static void test_link_stays_a_link(void **state)
{
    Folder *f = *state;
    char real[128], link[128];
    struct stat info;
    snprintf(real, sizeof real, "%s/real.txt", f->path);
    snprintf(link, sizeof link, "%s/link.txt", f->path);
    assert_int_equal(file_write(&f->diag, real, "old", 3), OK);
    assert_int_equal(symlink(real, link), 0);
    assert_int_equal(file_write(&f->diag, link, "newer", 5), OK);
    assert_int_equal(lstat(link, &info), 0);
    assert_true(S_ISLNK(info.st_mode));
    assert_int_equal(stat(real, &info), 0);
    assert_int_equal(info.st_size, 5);
    unlink(link);
    unlink(real);
}

/* A pipe stays a pipe: bytes go through it, and no picture takes its place. */
static void test_pipe_stays_a_pipe(void **state)
{
    Folder *f = *state;
    char path[128], got[8] = "";
    struct stat info;
    OutFile out;
    snprintf(path, sizeof path, "%s/pipe", f->path);
    assert_int_equal(mkfifo(path, 0600), 0);
    int fd = open(path, O_RDWR | O_NONBLOCK);
    assert_true(fd >= 0);
    assert_int_equal(file_write(&f->diag, path, "abc", 3), OK);
    assert_int_equal(read(fd, got, sizeof got), 3);
    assert_string_equal(got, "abc");
    assert_int_equal(out_begin(&f->diag, path, &out), ERR_FILE);
    assert_non_null(strstr(said, "not a regular file"));
    assert_int_equal(stat(path, &info), 0);
    assert_true(S_ISFIFO(info.st_mode));
    close(fd);
    unlink(path);
}

static void test_paths(void **state)
{
    (void)state;
    assert_string_equal(path_base("a/b/c.pms"), "c.pms");
    assert_string_equal(path_base("c"), "c");
    assert_string_equal(path_extension("a.b/c"), "");
    assert_string_equal(path_extension("a/.hidden"), "");
    assert_string_equal(path_extension("x.tar.gz"), "gz");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_round_trip),
        cmocka_unit_test(test_refusals),
        cmocka_unit_test(test_discard_leaves_old_file),
        cmocka_unit_test(test_link_stays_a_link),
        cmocka_unit_test(test_pipe_stays_a_pipe),
        cmocka_unit_test(test_paths),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
