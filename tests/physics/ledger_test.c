/* The photons' books, for every scene in scenes/: each photon sent was stored, absorbed, escaped or
 * was cut; and what the dice left them is, with what reflectances say was absorbed, all they
 * started with.  Row S5: chance takes and gives nothing.  SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "lit_scene.h"
#include "table.h"

#include <glob.h>

/* What rounding may add up to. */
#define ROUNDING 1e-5

static void check_balance(const char *name, const char *map, const LightBooks *books)
{
    char what[64];
    double measured = (double)books->balance.g, error = (double)books->balance_error.g;
    snprintf(what, sizeof what, "%s, %s map, %s", name, map, books->name);
    table_row(what, measured, 1, error);
    const float mean[3] = {books->balance.r, books->balance.g, books->balance.b};
    const float off[3] = {books->balance_error.r, books->balance_error.g, books->balance_error.b};
    for (int c = 0; c < 3; c++)
        assert_true(fabs((double)mean[c] - 1) < 4 * (double)off[c] + ROUNDING);
}

static uint64_t check_map(const char *name, const char *map, const LightBooks *books, int count)
{
    uint64_t stored = 0;
    for (int i = 0; books && i < count; i++) {
        const LightBooks *b = &books[i];
        assert_true(b->emitted == b->stored_paths + b->absorbed + b->escaped + b->cut);
        stored += b->stored;
        if (b->emitted > 0)
            check_balance(name, map, b);
    }
    return stored;
}

static size_t map_size(const PhotonMap *map)
{
    return map ? photon_map_count(map) : 0;
}

static void check_scene(const char *path)
{
    LitScene lit;
    lit_make_file(&lit, path, 2, 1);
    const PhotonMaps *maps = &lit.maps;
    const PhotonBooks *books = &maps->books;
    const char *name = strrchr(path, '/') + 1;
    uint64_t caustic = check_map(name, "caustic", books->caustic, books->caustic_count);
    uint64_t global = check_map(name, "global", books->global, books->global_count);
    uint64_t volume = check_map(name, "volume", books->volume, books->volume_count);
    assert_true(caustic == map_size(maps->caustic) && global == map_size(maps->global));
    assert_true(volume == map_size(maps->volume));
    lit_done(&lit);
}

static void books_of_all_scenes_close(void **state)
{
    (void)state;
    glob_t files;
    assert_int_equal(glob("scenes/*.pms", 0, NULL, &files), 0);
    for (size_t i = 0; i < files.gl_pathc; i++)
        check_scene(files.gl_pathv[i]);
    assert_true(files.gl_pathc > 10);
    globfree(&files);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(books_of_all_scenes_close)};
    return cmocka_run_group_tests_name("ledger", tests, NULL, NULL);
}
