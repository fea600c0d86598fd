/* One render: from a scene to an image with layers.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_RENDER_RENDER_H
#define PMS_RENDER_RENDER_H

#include "base/stats.h"
#include "image/image.h"
#include "photon/photon_pass.h"
#include "plan/plan.h"

typedef enum AaMethod { AA_NONE, AA_POV1, AA_POV2, AA_UNIFORM } AaMethod;

/* Layers a user may ask for, as bits. */
typedef enum LayerBit {
    LAYER_DIRECT = 1, LAYER_CAUSTIC = 2, LAYER_INDIRECT = 4, LAYER_Z = 8, LAYER_N = 16,
    LAYER_ALBEDO = 32
} LayerBit;

typedef struct RenderProgress {
    const char *phase;
    double fraction;     /* of the phase, 0 to 1, never 1 before it is done */
    double seconds_left; /* estimate for the phase; negative: unknown */
} RenderProgress;

typedef struct RenderOptions {
    int width, height;
    int threads;             /* at least 1 */
    uint64_t seed;
    AaMethod aa;
    double aa_threshold;     /* of the POV methods */
    int aa_depth;            /* R of the POV methods */
    bool aa_has_jitter;
    double aa_jitter;        /* amount, 0 to 1 */
    int samples;             /* a pixel, of AA_UNIFORM */
    unsigned layers;         /* LayerBits */
    bool has_alpha;          /* background transparent (+UA) */
    PlanOptions plan;
    void (*progress)(void *ctx, const RenderProgress *progress);
    void *progress_ctx;
} RenderOptions;

#define RENDER_OPTIONS_DEFAULT                                                                     \
    ((RenderOptions){.width = 320, .height = 240, .threads = 1, .aa_threshold = 0.3,               \
                     .aa_depth = 3, .aa_has_jitter = true, .aa_jitter = 1,                         \
                     .plan = PLAN_OPTIONS_DEFAULT})

typedef struct RenderResult {
    Image image;      /* beauty RGBA first, then the layers asked for */
    Stats stats;
    PhotonBooks books;
    Plan plan;        /* its memory is the scene's arena */
    uint64_t caustic_hash, global_hash; /* of the photon maps' bytes, 0: no map */
} RenderResult;

/* Render.  ERR_INTERRUPTED leaves no image.  Free the result with render_result_done. */
Status render_scene(const Scene *scene, const RenderOptions *options, Diag *diag,
                    RenderResult *out);
void render_result_done(RenderResult *result);

/* The plan and the photon budgets, without rendering: what `explain` prints. */
Status render_explain(const Scene *scene, const RenderOptions *options, Diag *diag,
                      Arena *arena, Plan *plan, PhotonBooks *books);

#endif
