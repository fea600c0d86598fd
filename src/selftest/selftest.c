/* pms selftest.  SPDX-License-Identifier: Apache-2.0 */
#include "selftest/selftest_int.h"

#include <string.h>

Status selftest_draw_scene(const Scene *scene, const RenderOptions *options, Diag *diag, Image *out)
{
    RenderResult result;
    TRY(render_scene(scene, options, diag, &result));
    *out = result.image;
    result.image = (Image){0};
    render_result_done(&result);
    return OK;
}

Status selftest_draw(const char *text, const Similarity *by, const RenderOptions *options,
                     Diag *diag, Image *out)
{
    const SdlOptions sdl = {.width = options->width,
                            .height = options->height,
                            .threads = options->threads,
                            .moved_by = by};
    Scene *scene;
    TRY(sdl_load_text(diag, "built-in scene", text, strlen(text), &sdl, &scene));
    Status status = selftest_draw_scene(scene, options, diag, out);
    scene_free(scene);
    return status;
}

void selftest_claim(const SelftestOptions *options, const Claim *claim, int *failed)
{
    *failed += !claim_holds(claim);
    options->done(options->ctx, claim);
}

Status selftest_run(const SelftestOptions *options, Diag *diag, int *failed)
{
    *failed = 0;
    TRY(analytic_claims(options, diag, failed));
    return stability_claims(options, diag, failed);
}
