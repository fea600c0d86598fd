/* What the files of the self-tests share.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SELFTEST_SELFTEST_INT_H
#define PMS_SELFTEST_SELFTEST_INT_H

#include "selftest/selftest.h"

/* Draw a scene; the caller frees *out with image_done. */
Status selftest_draw_scene(const Scene *scene, const RenderOptions *options, Diag *diag,
                           Image *out);

/* Draw a built-in text, moved by `by` unless that is NULL.  */
Status selftest_draw(const char *text, const Similarity *by, const RenderOptions *options,
                     Diag *diag, Image *out);

/* The claims of each file; they call options->done for each. */
Status analytic_claims(const SelftestOptions *options, Diag *diag, int *failed);
Status stability_claims(const SelftestOptions *options, Diag *diag, int *failed);

/* Hand a claim on. */
void selftest_claim(const SelftestOptions *options, const Claim *claim, int *failed);

#endif
