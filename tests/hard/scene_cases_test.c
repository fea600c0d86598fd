/* Scenes with something hard in them, against the same without: where surfaces coincide, bodies are
 * thin, lamps are behind walls, bodies are described in an unlikely way; and caustics of scenes
 * that are moved as a whole.
 *
 * The cases stand in the scenes: "#case (N) // NAME; LIMIT".  Case=N declares one, Sound=1 the
 * scene that it must look like.  LIMIT is how many pixels of 19200 may differ visibly, 0 that none
 * may change at all; with "blocks" behind it, how many blocks of 10 by 10 pixels may have another
 * mean, for scenes whose photons go other ways.  An argument names the cases to run, by a part of
 * their names.  SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "hard.h"
#include "verdict.h"

enum { CASES_MAX = 256, NAME_BYTES = 96 };

static const char *const scenes[] = {
    "tests/hard/coincide.pov", "tests/hard/thin.pov",  "tests/hard/same_body.pov",
    "tests/hard/leaks.pov",    "tests/hard/light.pov", "tests/hard/caustic.pov",
};
enum { SCENES = sizeof scenes / sizeof *scenes };

typedef struct SceneCase {
    char name[NAME_BYTES], declares[32];
    const char *scene;
    int limit;
    bool is_in_blocks;
} SceneCase;

static Verdict verdict_of(const SceneCase *c, bool is_by_povray)
{
    Pair pair = {.scene = {c->scene, c->scene},
                 .declares = c->declares,
                 .variant = "Sound=1",
                 .width = hard_is_long() || is_by_povray || c->is_in_blocks ? 160 : 80};
    return verdict_of_pair(&pair, is_by_povray);
}

static int wrong_of(const SceneCase *c, const Verdict *v)
{
    return c->is_in_blocks ? v->blocks : c->limit == 0 ? v->changed : v->visible;
}

static void check_scene(void **state)
{
    const SceneCase *c = *state;
    Verdict pms = verdict_of(c, false);
    int wrong = wrong_of(c, &pms);
    char text[32];
    snprintf(text, sizeof text, c->limit ? "at most %d" : "%d", c->limit);
    hard_row(c->name, text, "%d %s differ", wrong, c->is_in_blocks ? "blocks" : "pixels");
    if (verdict_wants_povray()) {
        Verdict povray = verdict_of(c, true);
        verdict_row_povray(c->name, &povray, wrong_of(c, &povray),
                           c->is_in_blocks ? "blocks" : "pixels", c->limit);
    }
    assert_true(wrong <= c->limit);
}

/* Read the cases of a scene. */
static size_t read_cases(const char *scene, const char *wanted, SceneCase *out)
{
    FILE *file = fopen(scene, "r");
    char line[512], rest[32];
    size_t count = 0;
    int number;
    assert_non_null(file);
    while (fgets(line, sizeof line, file)) {
        SceneCase *c = &out[count];
        *c = (SceneCase){.scene = scene};
        rest[0] = 0;
        if (sscanf(line, "#case (%d) // %95[^;]; %d %20s", &number, c->name, &c->limit, rest) < 3)
            continue;
        snprintf(c->declares, sizeof c->declares, "Case=%d", number);
        c->is_in_blocks = strcmp(rest, "blocks") == 0;
        if (!wanted || strstr(c->name, wanted))
            count++;
    }
    fclose(file);
    return count;
}

int main(int argc, char **argv)
{
    static SceneCase cases[CASES_MAX];
    static struct CMUnitTest tests[CASES_MAX];
    size_t count = 0;
    for (int i = 0; i < SCENES; i++)
        count += read_cases(scenes[i], argc > 1 ? argv[1] : NULL, &cases[count]);
    for (size_t i = 0; i < count; i++)
        tests[i] = (struct CMUnitTest){cases[i].name, check_scene, NULL, NULL, &cases[i]};
    return _cmocka_run_group_tests("scene_cases", tests, count, NULL, NULL);
}
