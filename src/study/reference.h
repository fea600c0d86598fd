/* Building a reference: two long renders of the same scene with different random numbers.
 *
 * It is rendered in passes, by paths where they show the same light as photons do, else with
 * photons whose gather radius shrinks.  Its state is kept on disk after each growth, so an
 * interrupted one goes on.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_STUDY_REFERENCE_H
#define PMS_STUDY_REFERENCE_H

#include "render/render.h"
#include "study/truth.h"

typedef struct ReferenceOptions {
    const Scene *scene;
    RenderOptions render; /* of a picture of the study; its progress is called */
    const char *folder;
    bool is_path;         /* by paths */
    double seconds;       /* to spend at most, but for what the first passes take */
    const Image *own;     /* the picture as it stands: the noise of the reference is to be ... */
    double error_part;    /* ... no more than this part of its error */
} ReferenceOptions;

/* Return true if path tracing shows the light that photons do: all of it, from lights that paths
 * can meet, in a scene without mirrors, glass and media.  `plan` is of the study's pictures. */
bool reference_can_be_path(const Scene *scene, const RenderOptions *options, const Plan *plan);

/* Build the reference.  ERR_INTERRUPTED leaves none, but its state on disk. */
Status reference_build(const ReferenceOptions *options, Diag *diag, Truth *out);

/* Remove the states that building left in a folder: it is finished. */
void reference_forget_states(const char *folder);

#endif
