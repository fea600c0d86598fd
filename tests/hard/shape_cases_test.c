/* Every shape of the language, opaque and in glass, keeps its picture when the scene is scaled,
 * shifted or turned, and when the shape's numbers change in their last bit.
 *
 * The shapes are those of scenes/every_shape.inc, the scene is one_shape.pov.  Far away numbers are
 * coarse, and glass magnifies that: there as many pixels may change as would if the shape changed
 * by the error of a place there.  An argument names the cases to run, by a part of their names.
 * SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "hard.h"
#include "verdict.h"

enum { SHAPES_MAX = 64, NAME_BYTES = 96, VARIANTS_MAX = 48 };

/* So many pixels of 19200 may change visibly where numbers are rounded; at 1e8, where a place is
 * known to a millionth at best, a thousandth of them. */
enum { PIXELS_WRONG = 2, PIXELS_WRONG_FAR = 20 };

typedef enum ShapeSet { SHAPES_ALL, SHAPES_GLASS, SHAPES_CONVEX, SHAPES_AROUND } ShapeSet;

/* A change that should not show: the numbers to declare, of which the first few are enough for
 * povray, and the first for short runs. */
typedef struct Move {
    const char *name, *scene;
    const char *declare;              /* printf, of a double */
    double all[VARIANTS_MAX], few[8]; /* up to a 0 */
    int limit;                        /* pixels that may change; 0: not one bit of one */
    ShapeSet shapes;                  /* that it is tried on */
    bool is_quick;                    /* short runs have it */
    double error;                     /* of places, in sizes of the shape; 0: too small to show */
} Move;

#define ONE "tests/hard/one_shape.pov"
#define CLEAR "tests/hard/clear_shape.pov"
#define SELF "tests/hard/self_shadow.pov"
#define LEAK "tests/hard/lamp_inside.pov"

/* clang-format off */
static const Move moves[] = {
    {"scaled by 2^-20 to 2^20", ONE, "Scale=%.17g",
     {0x1p-20, 0x1p-19, 0x1p-18, 0x1p-17, 0x1p-16, 0x1p-15, 0x1p-14, 0x1p-13, 0x1p-12, 0x1p-11,
      0x1p-10, 0x1p-9, 0x1p-8, 0x1p-7, 0x1p-6, 0x1p-5, 0x1p-4, 0x1p-3, 0x1p-2, 0x1p-1,
      0x1p20, 0x1p19, 0x1p18, 0x1p17, 0x1p16, 0x1p15, 0x1p14, 0x1p13, 0x1p12, 0x1p11,
      0x1p10, 0x1p9, 0x1p8, 0x1p7, 0x1p6, 0x1p5, 0x1p4, 0x1p3, 0x1p2, 0x1p1},
     {0x1p-20, 0x1p-10, 0x1p10, 0x1p20}, 0, SHAPES_ALL, true, 0},
    {"scaled by 1e-6 to 1e6", ONE, "Scale=%.17g",
     {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 1e-1, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6},
     {1e-6, 1e-3, 1e3, 1e6}, PIXELS_WRONG, SHAPES_ALL, false, 0},
    {"shifted by 1e3", ONE, "Away=%.17g", {1e3, -1e3}, {1e3},
     PIXELS_WRONG, SHAPES_ALL, false, 1.2e-11},
    {"shifted by 1e6", ONE, "Away=%.17g", {1e6, -1e6}, {1e6},
     PIXELS_WRONG, SHAPES_ALL, true, 1.2e-8},
    {"shifted by 1e8", ONE, "Away=%.17g", {1e8, -1e8}, {1e8},
     PIXELS_WRONG_FAR, SHAPES_ALL, false, 1.2e-6},
    {"turned", ONE, "Turn=%.17g", {37.3, 90, 143.7, 271}, {37.3},
     PIXELS_WRONG, SHAPES_ALL, false, 0},
    {"changed in the last bit", ONE, "Nudge=%.17g", {0x1p-52, -0x1p-53}, {0x1p-52},
     PIXELS_WRONG, SHAPES_ALL, true, 0},
    {"seen from 1e2 to 1e6", ONE, "Far=%.17g", {1e2, 1e3, 1e4, 1e5, 1e6}, {1e6, 1e4},
     PIXELS_WRONG, SHAPES_ALL, true, 1.2e-8},
    {"invisible where it bends no light", CLEAR, "Sound=%g", {1}, {1},
     PIXELS_WRONG, SHAPES_GLASS, true, 0},
    {"casts no shadow on itself", SELF, "Sound=%g", {1}, {1}, PIXELS_WRONG, SHAPES_CONVEX, true, 0},
    {"keeps in the light of a lamp", LEAK, "Sound=%g", {1}, {1}, 0, SHAPES_AROUND, true, 0},
};
/* clang-format on */
enum { MOVES = sizeof moves / sizeof *moves };

typedef struct ShapeCase {
    char name[NAME_BYTES];
    char declares[64];
    const Move *move;
    bool is_slow;
} ShapeCase;

static int width_of(bool is_by_povray)
{
    return hard_is_long() || is_by_povray ? 160 : 80;
}

static Verdict verdict_of_value(const ShapeCase *c, const char *declare, double value,
                                bool is_by_povray)
{
    char moved[64];
    snprintf(moved, sizeof moved, declare, value);
    Pair pair = {.scene = {c->move->scene, c->move->scene},
                 .declares = c->declares,
                 .variant = moved,
                 .width = width_of(is_by_povray)};
    return verdict_of_pair(&pair, is_by_povray);
}

static Verdict verdict_of(const ShapeCase *c, bool is_by_povray)
{
    const Move *move = c->move;
    const double *values = hard_is_long() && !is_by_povray ? move->all : move->few;
    Verdict worst = {.pairs = 0};
    for (int i = 0; values[i] != 0 && (i == 0 || hard_is_long()); i++)
        verdict_add(&worst, verdict_of_value(c, move->declare, values[i], is_by_povray));
    return worst;
}

/* Return how many pixels may change. */
static int limit_of(const ShapeCase *c)
{
    Verdict worst = {.pairs = 0};
    for (int sign = -1; c->move->error > 0 && sign <= 1; sign += 2)
        verdict_add(&worst, verdict_of_value(c, "Nudge=%.17g", sign * c->move->error, false));
    return c->move->limit + 2 * worst.visible;
}

static void check_shape(void **state)
{
    const ShapeCase *c = *state;
    bool is_exact = c->move->limit == 0;
    Verdict pms = verdict_of(c, false);
    int wrong = is_exact ? pms.changed : pms.visible, limit = limit_of(c);
    char text[32];
    snprintf(text, sizeof text, "at most %d", limit);
    hard_row(c->name, text, "%d pixels %s", wrong, is_exact ? "changed" : "differ");
    if (verdict_wants_povray() && !c->is_slow) {
        Verdict povray = verdict_of(c, true);
        verdict_row_povray(c->name, &povray, is_exact ? povray.changed : povray.visible, "pixels",
                           limit);
    }
    assert_true(wrong <= limit);
}

typedef struct ListedShape {
    char name[NAME_BYTES];
    bool is_convex, is_around; /* around the origin, without a gap */
    bool is_slow;              /* in povray */
} ListedShape;

/* Read the list: "#case (N) // NAME, convex, around". */
static int read_shapes(ListedShape *out)
{
    FILE *file = fopen("scenes/every_shape.inc", "r");
    char line[512], rest[128];
    int count = 0, number;
    assert_non_null(file);
    while (fgets(line, sizeof line, file)) {
        ListedShape *shape = &out[count];
        rest[0] = 0;
        if (sscanf(line, "#case (%d) // %60[^,\n]%100[^\n]", &number, shape->name, rest) < 2)
            continue;
        shape->is_convex = strstr(rest, "convex");
        shape->is_around = strstr(rest, "around");
        shape->is_slow = strstr(rest, "slow");
        assert_int_equal(++count, number);
    }
    fclose(file);
    return count;
}

/* Is a case wanted?  A short run takes glass where it can: what is wrong shows there first. */
static bool is_wanted(const ListedShape *shape, const Move *move, bool is_glass)
{
    if (!hard_is_long() && (!move->is_quick || (move->shapes == SHAPES_ALL && !is_glass)))
        return false;
    switch (move->shapes) {
    case SHAPES_GLASS:
        return is_glass;
    case SHAPES_CONVEX:
        return !is_glass && shape->is_convex;
    case SHAPES_AROUND:
        return !is_glass && shape->is_around;
    case SHAPES_ALL:
        break;
    }
    return true;
}

static bool make_case(const ListedShape *shape, int number, const Move *move, bool is_glass,
                      ShapeCase *out)
{
    snprintf(out->name, sizeof out->name, "%.40s, %s, %s", shape->name,
             is_glass ? "glass" : "opaque", move->name);
    snprintf(out->declares, sizeof out->declares, "Shape=%d Glass=%d%s", number, is_glass,
             strstr(move->declare, "Far") ? " Far=4" : "");
    out->move = move;
    out->is_slow = shape->is_slow;
    return is_wanted(shape, move, is_glass);
}

int main(int argc, char **argv)
{
    static ListedShape shapes[SHAPES_MAX];
    static ShapeCase cases[SHAPES_MAX * 2 * MOVES];
    static struct CMUnitTest tests[SHAPES_MAX * 2 * MOVES];
    size_t count = 0;
    int shape_count = read_shapes(shapes);
    for (int i = 0; i < shape_count; i++)
        for (int glass = 0; glass < 2; glass++)
            for (int k = 0; k < MOVES; k++) {
                ShapeCase *c = &cases[count];
                if (!make_case(&shapes[i], i + 1, &moves[k], glass, c) ||
                    (argc > 1 && !strstr(c->name, argv[1])))
                    continue;
                tests[count++] = (struct CMUnitTest){c->name, check_shape, NULL, NULL, c};
            }
    return _cmocka_run_group_tests("shape_cases", tests, count, NULL, NULL);
}
