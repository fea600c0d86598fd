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

enum { PIXELS = 5 * 3 };

static PixelSamples samples[PIXELS]; /* of the films */

static Film make_film(unsigned layers)
{
    Film film;
    RenderOptions options = RENDER_OPTIONS_DEFAULT;
    options.width = 5;
    options.height = 3;
    options.layers = layers;
    assert_int_equal(film_init(&film, &options, FILM_SAMPLES | FILM_CLUES, NULL), OK);
    film.samples = samples;
    return film;
}

static SeriesState make_state(unsigned layers)
{
    SeriesState made;
    Film film = make_film(layers);
    assert_int_equal(series_state_init(&made, &film, 1, 4, NULL), OK);
    film_done(&film);
    return made;
}

/* A state of some passes, of all kinds of values. */
static SeriesState some_state(void)
{
    SeriesState made = make_state(LAYER_Z);
    made.first = RADII;
    made.shared_rays = UINT64_MAX - 3;
    made.eye_rays = 5;
    made.steering.until = 44;
    for (int h = 0; h < 2; h++) {
        FilmSum *sum = &made.halves[h];
        for (size_t i = 0; i < sum->count; i++)
            sum->values[i] = i % 7 == 0   ? INFINITY
                             : i % 3 == 0 ? -1e-310
                                          : 1.0 / (double)(i + 1 + (size_t)h);
        for (uint32_t i = 0; i < PIXELS; i++) {
            sum->taken[i] = UINT32_MAX - i;
            sum->good[i] = 100 * i + (uint32_t)h;
            made.steering.rate[i] = 1.0f / (float)(i + 1);
        }
        sum->passes = h ? 12 : 13;
    }
    return made;
}

static const char *write_state(const char *name)
{
    SeriesState made = some_state();
    const char *path = in_folder(name);
    assert_int_equal(checkpoint_write(quiet(), path, SETTINGS, &made), OK);
    series_state_done(&made);
    return path;
}

/* Read a state with the settings; returns what comes of it. */
static Status read_state(const char *path, const char *settings)
{
    bool is_there;
    SeriesState made = make_state(LAYER_Z);
    Status status = checkpoint_read(quiet(), path, settings, &made, &is_there);
    if (status != OK)
        assert_int_equal(series_passes(&made), 0);
    series_state_done(&made);
    return status;
}

static void what_is_read_is_what_was_written(void **state)
{
    (void)state;
    bool is_there = false;
    SeriesState read = make_state(LAYER_Z), expected = some_state();
    const char *path = write_state("good");
    assert_int_equal(checkpoint_read(quiet(), path, SETTINGS, &read, &is_there), OK);
    assert_true(is_there);
    assert_memory_equal(&read.first, &RADII, sizeof RADII);
    assert_int_equal(read.shared_rays, UINT64_MAX - 3);
    assert_int_equal(read.eye_rays, 5);
    assert_int_equal(read.steering.until, 44);
    assert_memory_equal(read.steering.rate, expected.steering.rate, PIXELS * sizeof(float));
    for (int i = 0; i < 2; i++) {
        FilmSum *sum = &read.halves[i], *wanted = &expected.halves[i];
        assert_int_equal(sum->passes, wanted->passes);
        assert_memory_equal(sum->values, wanted->values, sum->count * sizeof *sum->values);
        assert_memory_equal(sum->taken, wanted->taken, PIXELS * sizeof *sum->taken);
        assert_memory_equal(sum->good, wanted->good, PIXELS * sizeof *sum->good);
    }
    series_state_done(&read);
    series_state_done(&expected);
}

static void no_file_is_no_error(void **state)
{
    (void)state;
    bool is_there = true;
    SeriesState made = make_state(0);
    Status status = checkpoint_read(quiet(), in_folder("none"), SETTINGS, &made, &is_there);
    assert_int_equal(status, OK);
    assert_false(is_there);
    assert_int_equal(series_passes(&made), 0);
    series_state_done(&made);
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

typedef enum Spot { RATE, PLANNED, CAUSTIC, GLOBAL, VOLUME, VALUE, DEPTH, CLUE } Spot;

/* Put a number somewhere into a state. */
static void put_number(SeriesState *made, Spot place, double number)
{
    FilmSum *sum = &made->halves[1];
    double *places[] = {
        [CAUSTIC] = &made->first.caustic,         [GLOBAL] = &made->first.global,
        [VOLUME] = &made->first.volume,           [VALUE] = &sum->values[2],
        [DEPTH] = &sum->values[sum->z_begin + 1], [CLUE] = &sum->values[sum->clues]};
    if (place == RATE)
        made->steering.rate[PIXELS - 1] = (float)number;
    else if (place == PLANNED)
        made->steering.until = (uint64_t)number;
    else
        *places[place] = number;
}

/* Write a state with a number in it and read it again. */
static Status read_with(Spot place, double number)
{
    const char *path = in_folder("senseless");
    SeriesState made = some_state();
    put_number(&made, place, number);
    assert_int_equal(checkpoint_write(quiet(), path, SETTINGS, &made), OK);
    series_state_done(&made);
    return read_state(path, SETTINGS);
}

/* Numbers that no series has are refused, though the checksum is that of what was written. */
static void what_makes_no_sense_is_refused(void **state)
{
    (void)state;
    static const struct {
        Spot place;
        double number;
        bool is_good;
        const char *what;
    } cases[] = {{RATE, 0, true, ""},
                 {RATE, UINT16_MAX, true, ""},
                 {RATE, -1e-3, false, "rate of samples"},
                 {RATE, NAN, false, "rate of samples"},
                 {RATE, INFINITY, false, "rate of samples"},
                 {RATE, 65536, false, "rate of samples"},
                 {RATE, 1e30, false, "rate of samples"},
                 {PLANNED, 4, true, ""},
                 {PLANNED, 1e18, false, "plan for more passes"},
                 {CAUSTIC, 0, true, ""},
                 {CAUSTIC, -1, false, "gather radius"},
                 {GLOBAL, NAN, false, "gather radius"},
                 {VOLUME, INFINITY, false, "gather radius"},
                 {VALUE, -3, true, ""}, /* filters may be negative */
                 {VALUE, NAN, false, "no numbers"},
                 {DEPTH, INFINITY, true, ""},
                 {DEPTH, NAN, false, "no numbers"},
                 {CLUE, NAN, true, ""}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        assert_int_equal(read_with(cases[i].place, cases[i].number),
                         cases[i].is_good ? OK : ERR_FILE);
        if (cases[i].is_good)
            continue;
        assert_non_null(strstr(last_message, "senseless' is damaged"));
        assert_non_null(strstr(last_message, cases[i].what));
    }
}

static void no_more_samples_are_used_than_taken(void **state)
{
    (void)state;
    const char *path = in_folder("counts");
    SeriesState made = some_state();
    made.halves[0].good[3] = 8;
    made.halves[0].taken[3] = 7;
    assert_int_equal(checkpoint_write(quiet(), path, SETTINGS, &made), OK);
    series_state_done(&made);
    assert_int_equal(read_state(path, SETTINGS), ERR_FILE);
    assert_non_null(strstr(last_message, "counts' is damaged"));
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
    SeriesState made = some_state();
    made.halves[1].passes = 13;
    struct rlimit old, small = {.rlim_cur = 100};
    signal(SIGXFSZ, SIG_IGN);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
    small.rlim_max = old.rlim_max;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    Status status = checkpoint_write(quiet(), path, SETTINGS, &made);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &old), 0);
    assert_int_equal(status, ERR_FILE);
    assert_non_null(strstr(last_message, "cannot write"));
    assert_int_equal(slurp(path, &after), size);
    assert_memory_equal(before, after, size);
    snprintf(before, 300, "%s.part%ld", path, (long)getpid());
    assert_int_equal(access(before, F_OK), -1);
    status = checkpoint_write(quiet(), in_folder("no/such"), SETTINGS, &made);
    assert_int_equal(status, ERR_FILE);
    series_state_done(&made);
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

/* Let each pixel of a film have so many samples, and so many that can be used. */
static void set_samples(uint16_t wanted, uint16_t good)
{
    for (int i = 0; i < PIXELS; i++)
        samples[i] = (PixelSamples){0, wanted, good};
}

/* Colours are averaged over samples, whichever half they belong to; of depths the nearest is kept;
 * a pixel without a usable sample adds nothing. */
static void sums_become_means(void **state)
{
    (void)state;
    Film film = make_film(LAYER_Z), picture = make_film(LAYER_Z);
    SeriesState made = make_state(LAYER_Z);
    const float *beauty = picture.image.layers[0].pixels, *depth = picture.image.layers[1].pixels;
    film_sum_mean(made.halves, 2, &picture.image);
    assert_true(beauty[7] == 0);
    set_samples(1, 1);
    set_film(&film, 1, INFINITY);
    film_sum_add(&made.halves[0], &film);
    set_film(&film, 4, 3);
    film_sum_add(&made.halves[1], &film);
    set_samples(4, 3);
    samples[1].good = 0;
    set_film(&film, 1e9f, 5);
    film.image.layers[1].pixels[2] = NAN;
    film_sum_add(&made.halves[0], &film);
    film_sum_mean(made.halves, 2, &picture.image);
    assert_int_equal(made.halves[0].passes, 2);
    assert_true(beauty[7] == 2.5f);
    assert_true(beauty[3] == (float)((5 + 3e9) / 5));
    assert_true(depth[0] == 3 && depth[2] == 3);
    film_sum_follow(&made.halves[0], &film);
    assert_int_equal(samples[1].first, 5);
    series_state_done(&made);
    film_done(&film);
    film_done(&picture);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_read_is_what_was_written),
        cmocka_unit_test(no_file_is_no_error),
        cmocka_unit_test(another_length_is_refused),
        cmocka_unit_test(any_damage_is_seen),
        cmocka_unit_test(what_makes_no_sense_is_refused),
        cmocka_unit_test(no_more_samples_are_used_than_taken),
        cmocka_unit_test(other_settings_are_named),
        cmocka_unit_test(settings_are_described),
        cmocka_unit_test(a_full_disk_leaves_the_old_state),
        cmocka_unit_test(sums_become_means),
    };
    return cmocka_run_group_tests_name("checkpoint", tests, make_folder, remove_folder);
}
