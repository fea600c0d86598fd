/* An eye for a lit scene: what one camera ray sees of it, by where the light comes from.
 * Include after cmocka.h.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TESTS_LIT_EYE_H
#define PMS_TESTS_LIT_EYE_H

#include "lit_scene.h"

#include "eye/eye.h"

typedef struct LitEye {
    PhotonReach reach;
    EyeThread *thread;
} LitEye;

/* Open an eye on the scene and whatever maps it has.  Film positions go from 0 to 1. */
static inline void lit_eye_open(LitEye *eye, LitScene *lit, GatherLimits limits)
{
    *eye = (LitEye){0};
    if (lit->maps.caustic) {
        Status status =
            photon_reach_init(&eye->reach, lit->maps.caustic, limits.max_radius, &lit->diag);
        assert_int_equal(status, OK);
    }
    EyeOptions options = {.width = 1,
                          .height = 1,
                          .caustic = lit->maps.caustic,
                          .global = lit->maps.global,
                          .caustic_reach = &eye->reach,
                          .caustic_limits = limits,
                          .global_limits = limits};
    assert_int_equal(eye_thread_new(lit->tracer, &options, &lit->diag, &eye->thread), OK);
}

static inline void lit_eye_close(LitEye *eye)
{
    eye_thread_free(eye->thread, NULL);
    photon_reach_done(&eye->reach);
}

static inline EyeSample lit_look(LitEye *eye, double x, double y)
{
    EyeSample sample;
    assert_true(eye_sample(eye->thread, x, y, 0, 0, &sample));
    return sample;
}

#endif
