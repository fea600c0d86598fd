/* Self-tests: does this build compute right on this machine, and does a scene look the same
 * wherever it stands?
 *
 * Both go the whole way from a text to a picture, through nothing that a render does not go
 * through. SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SELFTEST_SELFTEST_H
#define PMS_SELFTEST_SELFTEST_H

#include "render/render.h"
#include "sdl/sdl.h"
#include "selftest/change.h"
#include "selftest/claim.h"

/* --- pms selftest ---------------------------------------------------------------------------- */

/* How often and with how many threads the built-in scenes are drawn. */
typedef struct SelftestOptions {
    int threads; /* at least 1 */
    uint64_t seed;
    void (*done)(void *ctx, const Claim *claim); /* called after each claim, in order */
    void *ctx;
} SelftestOptions;

/* Test every claim there is; *failed gets the number of those that do not hold. */
Status selftest_run(const SelftestOptions *options, Diag *diag, int *failed);

/* --- pms selftest SCENE ---------------------------------------------------------------------- */

/* What became of the picture when the scene was moved. */
typedef struct MoveResult {
    const char *name; /* "scaled by 2^10" */
    Change change;
    const Object *worst; /* what is seen at the pixel that changed most; NULL: nothing */
} MoveResult;

typedef struct MovedOptions {
    const char *path; /* of the scene */
    const SdlOptions *sdl;
    const RenderOptions *render;
    /* Called when the unmoved scene was drawn, and after each move; objects live until
     * selftest_moved returns. */
    void (*begun)(void *ctx, const ChangeBase *base, double size);
    void (*done)(void *ctx, const MoveResult *result);
    void *ctx;
} MovedOptions;

/* Draw the scene as it is, with other seeds, and moved in all the ways there are; *failed gets the
 * number of moves that changed more than they may. */
Status selftest_moved(const MovedOptions *options, Diag *diag, int *failed);

#endif
