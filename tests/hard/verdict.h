/* What becomes of two pictures that should be alike, and what that says.  Include after cmocka.h.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TESTS_VERDICT_H
#define PMS_TESTS_VERDICT_H

#include "picture.h"

/* Two pictures that should be alike: of two scenes, or of one with other numbers. */
typedef struct Pair {
    const char *scene[2];
    const char *declares; /* for both */
    const char *variant;  /* more for the second; or NULL */
    int width;            /* of pictures of 4:3 */
} Pair;

typedef struct Verdict {
    int pairs, refused;           /* of these there are no pictures */
    int changed, visible, blocks; /* see Difference */
} Verdict;

static inline Verdict verdict_of_pair(const Pair *pair, bool is_by_povray)
{
    Shot shot = {.scene = pair->scene[0],
                 .declares = {pair->declares, NULL},
                 .width = pair->width,
                 .height = pair->width * 3 / 4,
                 .is_by_povray = is_by_povray};
    Image a, b;
    if (!picture_base(&shot, &a))
        return (Verdict){.pairs = 1, .refused = 1};
    shot.scene = pair->scene[1];
    shot.declares[1] = pair->variant;
    if (!picture_make(&shot, &b)) {
        image_done(&a);
        return (Verdict){.pairs = 1, .refused = 1};
    }
    Difference d = picture_difference(&a, &b);
    image_done(&a);
    image_done(&b);
    return (Verdict){.pairs = 1, .changed = d.changed, .visible = d.visible, .blocks = d.blocks};
}

/* The worse of two. */
static inline void verdict_add(Verdict *worst, Verdict v)
{
    worst->pairs += v.pairs;
    worst->refused += v.refused;
    worst->changed = v.changed > worst->changed ? v.changed : worst->changed;
    worst->visible = v.visible > worst->visible ? v.visible : worst->visible;
}

static inline bool verdict_wants_povray(void)
{
    return getenv("HARD_POVRAY") != NULL;
}

/* Print what povray does: it passes if what counts is within the limit, and struggles if at most
 * 1 % of the pixels are visibly wrong all the same. */
static inline void verdict_row_povray(const char *name, const Verdict *v, int wrong,
                                      const char *unit, int limit)
{
    enum { STRUGGLES_MAX = 160 * 120 / 100 };
    const char *verdict = wrong <= limit && !v->refused                ? "passes"
                          : v->visible <= STRUGGLES_MAX && !v->refused ? "struggles"
                                                                       : "fails";
    printf("# povray: %s: %s: ", name, verdict);
    if (v->refused)
        printf("no picture of %d in %d%s", v->refused, v->pairs, v->refused < v->pairs ? ", " : "");
    if (v->refused < v->pairs)
        printf("%d %s", wrong, unit);
    printf("\n");
    fflush(stdout);
}

#endif
