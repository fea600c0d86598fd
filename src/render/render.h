/* One render: from a scene to an image with layers.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_RENDER_RENDER_H
#define PMS_RENDER_RENDER_H

#include "base/stats.h"
#include "eye/eye.h"
#include "image/image.h"
#include "photon/photon_pass.h"
#include "plan/plan.h"

typedef enum AaMethod { AA_NONE, AA_POV1, AA_POV2, AA_UNIFORM } AaMethod;

/* Layers a user may ask for, as bits. */
typedef enum LayerBit {
    LAYER_DIRECT = 1, LAYER_CAUSTIC = 2, LAYER_INDIRECT = 4, LAYER_Z = 8, LAYER_N = 16,
    LAYER_ALBEDO = 32, LAYER_ERROR_NOISE = 64, LAYER_ERROR_BIAS = 128
} LayerBit;

typedef struct RenderProgress {
    const char *phase;
    double fraction;     /* of the phase, 0 to 1, never 1 before it is done */
    double seconds_left; /* estimate for the phase, or all passes; negative: unknown */
    uint64_t pass;       /* of a progressive render, from 1; else 0 */
    uint64_t passes;     /* to be made in all; 0: unknown */
    double error, error_wanted; /* of a progressive render, as last known; 0: unknown, not asked */
} RenderProgress;

/* What a progressive render is going to do, as far as is known after its first passes. */
typedef struct SeriesPlan {
    double passes;          /* in all, about; infinite: no limit */
    double seconds;         /* of a pass */
    double photons;         /* part of those that the scene asks for, in each pass */
    double samples;         /* of a pixel in each pass */
    double error;           /* now */
    uint64_t passes_so_far;
} SeriesPlan;


/* Gather radii, scene units; 0: there was no map. */
typedef struct PassRadii {
    double caustic, global, volume;
} PassRadii;

/* The estimated error of a picture, relative to the luminance of each pixel (where that is less
 * than a tenth of the picture's mean, to about this tenth): what 95 % of the pixels stay below. */
typedef struct ErrorFigure {
    bool is_known;
    double whole;       /* of noise and bias together */
    double bound;       /* the whole is below this with a confidence of 90 % */
    double noise, bias; /* of each alone */
} ErrorFigure;

typedef struct RenderResult RenderResult;

/* plan.is_progressive: many passes of fresh photons and samples, whose mean is the picture.  The
 * gather radius shrinks from pass to pass such that noise and blur both go to zero, in the memory
 * of one pass. */
typedef struct ProgressiveOptions {
    uint64_t passes;        /* in all, with those of runs before; 0: no limit */
    double seconds;         /* for all of the render, which are used up; 0: no limit */
    double error;           /* stop when the bound of the relative error is below; 0: no limit.
                               With this or seconds, samples go where the errors are */
    const char *state_path; /* where the sums of passes are kept; NULL: nowhere */
    bool is_resumed;        /* go on from the state kept there, if there is one */
    /* Called with the picture so far now and then; it may fail now and succeed later. */
    Status (*show)(void *ctx, RenderResult *so_far);
    void *show_ctx;
    void (*tell)(void *ctx, const SeriesPlan *plan); /* called once, if there is a limit by time or
                                                        error; or NULL */
    void *tell_ctx;
} ProgressiveOptions;

/* One pixel alone is wanted, and all that becomes of its rays: the samples are those of the whole
 * picture.  The functions are called by one thread at a time. */
typedef struct Replay {
    int x, y; /* pixels from the upper left */
    EyeWitness witness;
    /* Called after the steps of sample `index`, at (x, y) in the picture.  sample: what came of it;
     * NULL: no number. */
    void (*sample)(void *ctx, double x, double y, uint32_t index, const EyeSample *sample);
} Replay;

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
    bool is_watched;         /* books say which photons were seen */
    bool has_alpha;          /* background transparent (+UA) */
    bool has_full_photons;   /* photons keep their light in full precision: see PhotonOptions */
    bool has_error_picture;  /* a picture of the errors is asked for */
    PlanOptions plan;
    ProgressiveOptions progressive;
    const Replay *replay;    /* NULL: the whole picture; not with plan.is_progressive */
    void (*progress)(void *ctx, const RenderProgress *progress);
    void *progress_ctx;
} RenderOptions;

#define RENDER_OPTIONS_DEFAULT                                                                     \
    ((RenderOptions){.width = 320, .height = 240, .threads = 1, .aa_threshold = 0.3,               \
                     .aa_depth = 3, .aa_has_jitter = true, .aa_jitter = 1,                         \
                     .plan = PLAN_OPTIONS_DEFAULT})

struct RenderResult {
    Image image;      /* beauty RGBA first, then the layers asked for */
    uint64_t passes, new_passes; /* of a progressive render: in all, and of this run; else 0 */
    PassRadii first_radii, last_radii; /* of a single pass: both what it gathered within */
    ErrorFigure error;
    Image error_picture; /* the relative errors as heat, display values: black 0.1 %, white 100 %,
                            the logarithm between; without layers if not asked for */
    Stats stats;
    PhotonBooks books;
    Plan plan;        /* its memory is the scene's arena */
    uint64_t caustic_hash, global_hash, volume_hash; /* of the photon maps' bytes (of the last
                                           pass), 0: no map */
};

/* Render.  ERR_INTERRUPTED leaves no image, but of a progressive render that of the passes done,
 * if there is any.  Free the result with render_result_done. */
Status render_scene(const Scene *scene, const RenderOptions *options, Diag *diag,
                    RenderResult *out);
void render_result_done(RenderResult *result);

#endif
