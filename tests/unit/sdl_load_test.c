/* Loading as a whole: what the caller hands in, what the scene's settings say, which status.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/sdl.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "folder.h"

enum { HEARD_MAX = 8192 };

typedef struct Loaded {
    Status status;
    char heard[HEARD_MAX];
    SceneSettings settings;
} Loaded;

static void hear(void *ctx, const char *text)
{
    Loaded *loaded = ctx;
    size_t length = strlen(loaded->heard);
    snprintf(loaded->heard + length, HEARD_MAX - length, "%s", text);
}

/* Load a text, or the file at `path` when it is NULL. */
static void load(Loaded *loaded, const char *path, const char *text, const SdlOptions *options)
{
    Diag diag;
    Scene *scene;
    loaded->heard[0] = 0;
    diag_init(&diag, hear, loaded);
    loaded->status = text ? sdl_load_text(&diag, path, text, strlen(text), options, &scene)
                          : sdl_load(&diag, path, options, &scene);
    assert_int_equal(loaded->status == OK, scene != NULL);
    if (scene)
        loaded->settings = scene->settings;
    scene_free(scene);
    diag_done(&diag);
}

static void assert_heard(const Loaded *loaded, const char *text)
{
    if (!strstr(loaded->heard, text))
        print_error("wanted `%s`, got\n%s\n", text, loaded->heard);
    assert_non_null(strstr(loaded->heard, text));
}

static void test_options(void **state)
{
    (void)state;
    static const SdlDeclare declares[] = {
        {"N", "2.5"}, {"S", "\"abc\""}, {"E", "\"\""}, {"B", "x"}};
    SdlOptions options = {.declares = declares,
                          .declare_count = 4,
                          .width = 320,
                          .height = 200,
                          .clock = 0.25,
                          .threads = 1};
    Loaded loaded;
    load(&loaded, "folder/a.pms",
         "#version 3.7; #debug concat(\"[\", str(N*2,0,1), S, E, str(B,0,0), str(image_width,0,0), "
         "str(image_height,0,0), str(clock,0,2), str(clock_on,0,0), input_file_name, \"]\")",
         &options);
    assert_int_equal(loaded.status, OK);
    assert_heard(&loaded, "[5.0abc03202000.251a.pms]");
    assert_heard(&loaded, "the value of 'B' is 'x', no number");
}

static void test_reserved_declare(void **state)
{
    (void)state;
    static const SdlDeclare declare = {"sphere", "1"};
    SdlOptions options = {.declares = &declare, .declare_count = 1, .threads = 1};
    Loaded loaded;
    load(&loaded, "a.pms", "", &options);
    assert_int_equal(loaded.status, ERR_SYNTAX);
    assert_heard(&loaded, "`sphere` is a word of the language");
}

/* Scenes older than 3.7 that name no assumed_gamma are shown without gamma. */
static void test_gamma(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        double version;
        bool is_off;
    } rows[] = {
        {"#version 3.7;", 3.7, false},
        {"", 3.7, true},
        {"#version 3.5;", 3.5, true},
        {"#version 3.5; global_settings { assumed_gamma 1 }", 3.5, false},
        {"global_settings { assumed_gamma 2.2 }", 3.7, false},
        {"#version 3.7; #declare V = version; #version 3.1; #version V;", 3.7, false},
    };
    SdlOptions options = {.threads = 1};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        Loaded loaded;
        load(&loaded, "a.pms", rows[i].text, &options);
        assert_int_equal(loaded.status, OK);
        assert_true(loaded.settings.version == rows[i].version);
        assert_int_equal(loaded.settings.is_gamma_off, rows[i].is_off);
    }
}

static void test_status(void **state)
{
    (void)state;
    SdlOptions options = {.threads = 1};
    Loaded loaded;
    load(&loaded, "tests/no_such_scene.pms", NULL, &options);
    assert_int_equal(loaded.status, ERR_FILE);
    assert_heard(&loaded, "cannot open 'tests/no_such_scene.pms'");
    load(&loaded, "tests", NULL, &options);
    assert_int_equal(loaded.status, ERR_FILE);
    assert_heard(&loaded, "is a directory");
    load(&loaded, "a.pms", "#include \"no_such.inc\"", &options);
    assert_int_equal(loaded.status, ERR_SYNTAX);
}

/* As in POV-Ray, spacing does not count beside a count above 0, in either order. */
static void test_count_and_spacing(void **state)
{
    (void)state;
    static const struct {
        const char *items;
        long count;
        double spacing;
    } rows[] = {{"count 500 spacing 0.25", 500, 0.25},
                {"spacing 0.25 count 500", 500, 0.25},
                {"count 0 spacing 0.25", 0, 0.25},
                {"spacing 0.25", 0, 0.25}};
    SdlOptions options = {.threads = 1};
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        char text[128];
        Loaded loaded;
        snprintf(text, sizeof text, "#version 3.7; global_settings { photons { %s } }",
                 rows[i].items);
        load(&loaded, "a.pms", text, &options);
        assert_int_equal(loaded.status, OK);
        assert_int_equal(loaded.settings.photons.count, rows[i].count);
        assert_true(loaded.settings.photons.spacing == rows[i].spacing);
        assert_int_equal(strstr(loaded.heard, "spacing has no effect") != NULL, rows[i].count > 0);
    }
}

/* The look of an error: place, line, caret under the word, way there. */
static void test_look(void **state)
{
    (void)state;
    SdlOptions options = {.threads = 1};
    Loaded loaded;
    load(&loaded, "a.pms",
         "#version 3.7;\n#macro Ball(R)\n  sphere { 0, R + <1,2> }\n#end\nunion { Ball(1) }\n",
         &options);
    assert_string_equal(loaded.heard, "a.pms:3:15: error: a float wanted, got a vector of 2\n"
                                      "    3 |   sphere { 0, R + <1,2> }\n"
                                      "      |               ^~~~~~~~~\n"
                                      "a.pms:5:9: note: in macro 'Ball' called here\n");
}

/* A missing file that is POV-Ray's: the message says where it is, or what would bring it; it is
 * never read. */
static void test_povray_include(void **state)
{
    (void)state;
    const char *none[] = {"tests/no_such_folder", NULL};
    const char *some[] = {"tests/no_such_folder", folder, NULL};
    static const struct {
        const char *name;
        bool is_there;
        const char *said; /* behind the usual words */
    } rows[] = {
        {"colors.inc", true, "library path; POV-Ray's own is in '"},
        {"colors", true, "library path; POV-Ray's own is in '"},
        {"colors.inc", false,
         "library path; it is one of POV-Ray's own, which the package "
         "povray-includes has\n"},
        {"textures", false, "package povray-includes has\n"},
        {"my_colors.inc", true, "library path\n"},
    };
    static const char text[] = "#debug \"colours are here\"";
    spill(in_folder("colors.inc"), text, strlen(text));
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        SdlOptions options = {.threads = 1, .povray_folders = rows[i].is_there ? some : none};
        char scene[64];
        Loaded loaded;
        snprintf(scene, sizeof scene, "#include \"%s\"", rows[i].name);
        load(&loaded, "a.pms", scene, &options);
        assert_int_equal(loaded.status, ERR_SYNTAX);
        assert_heard(&loaded, rows[i].said);
        assert_null(strstr(loaded.heard, "colours are here"));
    }
    char wanted[300];
    Loaded loaded;
    load(&loaded, "a.pms", "#include \"colors.inc\"",
         &(SdlOptions){.threads = 1, .povray_folders = some});
    snprintf(wanted, sizeof wanted, "is in '%s', and found with -L %s\n", folder, folder);
    assert_heard(&loaded, wanted);
    const char *library = folder;
    load(&loaded, "a.pms", "#include \"colors.inc\"",
         &(SdlOptions){.threads = 1, .library_paths = &library, .library_path_count = 1});
    assert_int_equal(loaded.status, OK);
    assert_heard(&loaded, "colours are here");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_options),        cmocka_unit_test(test_reserved_declare),
        cmocka_unit_test(test_gamma),          cmocka_unit_test(test_status),
        cmocka_unit_test(test_look),           cmocka_unit_test(test_count_and_spacing),
        cmocka_unit_test(test_povray_include),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
