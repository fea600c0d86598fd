/* The state of a progressive render on disk: what is read is what was written, or an error.
 * SPDX-License-Identifier: Apache-2.0 */
#include "render/checkpoint.h"

#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmocka.h>

#include "folder.h"
#include "quiet.h"

static const char SETTINGS[] = "pms 1.2.3\nscene_text #0123456789abcdef\nseed 7\nlayers none\n";
static const PassRadii RADII = {0.25, 1e-9, 3};

static Film make_film(unsigned layers)
{
    Film film;
    RenderOptions options = RENDER_OPTIONS_DEFAULT;
    options.width = 5;
    options.height = 3;
    options.layers = layers;
    assert_int_equal(film_init(&film, &options, NULL), OK);
    return film;
}

static FilmSum make_sum(unsigned layers)
{
    FilmSum sum;
    Film film = make_film(layers);
    assert_int_equal(film_sum_init(&sum, &film, NULL), OK);
    film_done(&film);
    return sum;
}

/* A sum of some passes, of all kinds of values. */
static FilmSum some_sum(void)
{
    FilmSum sum = make_sum(LAYER_Z);
    for (size_t i = 0; i < sum.count; i++)
        sum.values[i] = i % 7 == 0 ? INFINITY : i % 3 == 0 ? -1e-310 : 1.0 / (double)(i + 1);
    sum.passes = 12;
    return sum;
}

static const char *write_state(const char *name)
{
    FilmSum sum = some_sum();
    const char *path = in_folder(name);
    assert_int_equal(checkpoint_write(quiet(), path, SETTINGS, &RADII, &sum), OK);
    film_sum_done(&sum);
    return path;
}

/* Read a state with the settings; returns what comes of it. */
static Status read_state(const char *path, const char *settings)
{
    bool is_there;
    PassRadii radii;
    FilmSum sum = make_sum(LAYER_Z);
    Status status = checkpoint_read(quiet(), path, settings, &radii, &sum, &is_there);
    if (status != OK)
        assert_int_equal(sum.passes, 0);
    film_sum_done(&sum);
    return status;
}

static void what_is_read_is_what_was_written(void **state)
{
    (void)state;
    bool is_there = false;
    PassRadii radii;
    FilmSum sum = make_sum(LAYER_Z), expected = some_sum();
    const char *path = write_state("good");
    assert_int_equal(checkpoint_read(quiet(), path, SETTINGS, &radii, &sum, &is_there), OK);
    assert_true(is_there);
    assert_memory_equal(&radii, &RADII, sizeof radii);
    assert_int_equal(sum.passes, 12);
    assert_memory_equal(sum.values, expected.values, sum.count * sizeof *sum.values);
    film_sum_done(&sum);
    film_sum_done(&expected);
}

static void no_file_is_no_error(void **state)
{
    (void)state;
    bool is_there = true;
    PassRadii radii = RADII;
    FilmSum sum = make_sum(0);
    Status status = checkpoint_read(quiet(), in_folder("none"), SETTINGS, &radii, &sum, &is_there);
    assert_int_equal(status, OK);
    assert_false(is_there);
    assert_int_equal(sum.passes, 0);
    film_sum_done(&sum);
    assert_int_equal(read_state(folder, SETTINGS), ERR_FILE); /* a directory */
}

/* Cut it at every length, and let it grow. */
static void another_length_is_refused(void **state)
{
    (void)state;
    char *bytes;
    size_t size = slurp(write_state("long"), &bytes);
    const char *path = in_folder("short");
    for (size_t length = 0; length < size; length++) {
        spill(path, bytes, length);
        assert_int_equal(read_state(path, SETTINGS), ERR_FILE);
        assert_non_null(strstr(last_message, "is cut short"));
    }
    spill(path, bytes, size + 1);
    assert_int_equal(read_state(path, SETTINGS), ERR_FILE);
    spill(path, bytes, size);
    assert_int_equal(read_state(path, SETTINGS), OK);
    free(bytes);
}

/* Change every bit. */
static void any_damage_is_seen(void **state)
{
    (void)state;
    char *bytes;
    size_t size = slurp(write_state("whole"), &bytes);
    const char *path = in_folder("changed");
    int damaged = 0;
    for (size_t bit = 0; bit < 8 * size; bit++) {
        bytes[bit / 8] ^= (char)(1 << bit % 8);
        spill(path, bytes, size);
        assert_int_equal(read_state(path, SETTINGS), ERR_FILE);
        /* The first words say what kind of file it is, and how long. */
        damaged += strstr(last_message, "is damaged") != NULL;
        bytes[bit / 8] ^= (char)(1 << bit % 8);
    }
    assert_true(damaged >= 8 * ((int)size - 32));
    free(bytes);
}

static void other_settings_are_named(void **state)
{
    (void)state;
    const char *path = write_state("other");
    assert_int_equal(
        read_state(path, "pms 1.2.3\nscene_text #fedcba9876543210\nseed 8\nlayers none\n"),
        ERR_USAGE);
    assert_non_null(strstr(last_message, "another picture: scene_text changed, seed 7, not 8;"));
    assert_int_equal(read_state(path, "pms 1.3\nscene_text #0123456789abcdef\nsize 2x2\n"),
                     ERR_USAGE);
    assert_non_null(strstr(last_message, "another version"));
}

/* Names in the words of the command line, and nothing left out by a text that is too long. */
static void settings_are_described(void **state)
{
    (void)state;
    char settings[CHECKPOINT_SETTINGS_MAX];
    Scene scene = {.text_hash = 1, .declare_hash = 2};
    RenderOptions options = RENDER_OPTIONS_DEFAULT;
    options.layers = LAYER_DIRECT | LAYER_CAUSTIC | LAYER_INDIRECT | LAYER_Z | LAYER_N;
    options.seed = UINT64_MAX;
    checkpoint_describe(&scene, &options, settings);
    assert_non_null(strstr(settings, "\nsize 320x240\n"));
    assert_non_null(strstr(settings, "\nlayers direct,caustic,indirect,Z,N\n"));
    assert_non_null(strstr(settings, "\nseed 18446744073709551615\n"));
    assert_true(strlen(settings) < CHECKPOINT_SETTINGS_MAX / 2);
    options.layers = 0;
    checkpoint_describe(&scene, &options, settings);
    assert_non_null(strstr(settings, "\nlayers none\n"));
}

/* A disk that is full: the old state stays, and nothing else. */
static void a_full_disk_leaves_the_old_state(void **state)
{
    (void)state;
    char *before, *after;
    const char *path = write_state("kept");
    size_t size = slurp(path, &before);
    FilmSum sum = some_sum();
    sum.passes = 13;
    struct rlimit old, small = {.rlim_cur = 100};
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
    small.rlim_max = old.rlim_max;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    Status status = checkpoint_write(quiet(), path, SETTINGS, &RADII, &sum);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &old), 0);
    assert_int_equal(status, ERR_FILE);
    assert_non_null(strstr(last_message, "cannot write"));
    assert_int_equal(slurp(path, &after), size);
    assert_memory_equal(before, after, size);
    snprintf(before, 300, "%s.part%ld", path, (long)getpid());
    assert_int_equal(access(before, F_OK), -1);
    status = checkpoint_write(quiet(), in_folder("no/such"), SETTINGS, &RADII, &sum);
    assert_int_equal(status, ERR_FILE);
    film_sum_done(&sum);
    free(before);
    free(after);
}

/* --- sums ----------------------------------------------------------------------------------- */

static void set_film(Film *film, float beauty, float depth)
{
    for (int i = 0; i < 5 * 3 * 4; i++)
        film->image.layers[0].pixels[i] = beauty;
    for (int i = 0; i < 5 * 3; i++)
        film->image.layers[1].pixels[i] = depth;
}

/* Colours are averaged, of depths the nearest is kept; what is no number counts as the mean of
 * what came before. */
static void sums_become_means(void **state)
{
    (void)state;
    Film film = make_film(LAYER_Z);
    FilmSum sum = make_sum(LAYER_Z);
    film_sum_mean(&sum, &film);
    assert_true(film.image.layers[0].pixels[7] == 0);
    set_film(&film, 1, INFINITY);
    film_sum_add(&sum, &film);
    set_film(&film, 4, 3);
    film_sum_add(&sum, &film);
    set_film(&film, 1e9f, 5);
    film.image.layers[0].pixels[7] = NAN;
    film.image.layers[1].pixels[2] = NAN;
    film_sum_add(&sum, &film);
    film_sum_mean(&sum, &film);
    assert_int_equal(sum.passes, 3);
    assert_true(film.image.layers[0].pixels[7] == 2.5f);
    assert_true(film.image.layers[0].pixels[6] == (float)((5 + 1e9) / 3));
    assert_true(film.image.layers[1].pixels[0] == 3 && film.image.layers[1].pixels[2] == 3);
    film_sum_done(&sum);
    film_done(&film);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_read_is_what_was_written),
        cmocka_unit_test(no_file_is_no_error),
        cmocka_unit_test(another_length_is_refused),
        cmocka_unit_test(any_damage_is_seen),
        cmocka_unit_test(other_settings_are_named),
        cmocka_unit_test(settings_are_described),
        cmocka_unit_test(a_full_disk_leaves_the_old_state),
        cmocka_unit_test(sums_become_means),
    };
    return cmocka_run_group_tests_name("checkpoint", tests, make_folder, remove_folder);
}
