/* Antialiasing: how many samples a pixel gets, where, and how they are averaged.
 *
 * The methods see the picture only through a callback, and know vectors of channels, not
 * colours; only R G B A, the first four, are compared.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_RENDER_AA_H
#define PMS_RENDER_AA_H

#include "render/film.h"

/* Sample the picture at film position (x, y) into `vector`; `pixel` and `index` name the
 * sample.  Returns false when there is no usable value (the vector is black then). */
typedef bool (*AaSampler)(void *ctx, double x, double y, uint32_t pixel, uint32_t index,
                          float *vector);

typedef struct Aa {
    int width, height;       /* of the film */
    int channels, z_channel; /* as Film */
    double threshold;
    int depth;     /* R, 1 to 9 */
    double jitter; /* amount, 0: none */
    float power;   /* colours are compared as c^power */
    uint64_t seed;
} Aa;

void aa_init(Aa *aa, const Film *film, const RenderOptions *options, const SceneSettings *settings);

/* What colours are compared by: R G B encoded, A as it is. */
typedef struct AaKey {
    float v[4];
} AaKey;
AaKey aa_key(const Aa *aa, const float *vector);

/* Working memory of one thread. */
typedef struct AaScratch {
    float *block;   /* a block's vectors */
    float *corners; /* method 2: vectors of a block's pixel corners */
    float *cells;   /* method 2: vectors inside a pixel */
    bool *has_cell;
    AaKey *keys;      /* method 1: of a block's pixels */
    bool *is_refined; /* method 1 */
} AaScratch;
Status aa_scratch_init(AaScratch *scratch, const Aa *aa, AaMethod method, Diag *diag);
void aa_scratch_done(AaScratch *scratch);

/* One sample in the middle of each pixel of a block (at most FILM_BLOCK pixels a side). */
void aa_centers(const Aa *aa, FilmRect rect, AaSampler sampler, void *ctx, float *vectors);

/* `samples` low-discrepancy samples in each pixel; is_centered: all at its centre, for a
 * sampler that spreads them itself. */
void aa_uniform(const Aa *aa, FilmRect rect, int samples, bool is_centered, AaSampler sampler,
                void *ctx, float *vectors);

/* The same for one of many passes: of every pixel what film->samples asks for, where the usable
 * ones are counted. */
void aa_series(const Aa *aa, FilmRect rect, PixelSamples *samples, AaSampler sampler, void *ctx,
               float *vectors);

/* POV-Ray's method 1 on a block whose centres are in scratch->block: pixels that differ from
 * their left or upper neighbour get R x R samples more, and so do those neighbours.
 *
 * above, left  keys of the centres beside the block (they are compared, not refined); NULL at
 *              the film's edge. */
void aa_refine(const Aa *aa, FilmRect rect, const AaKey *above, const AaKey *left,
               AaSampler sampler, void *ctx, AaScratch *scratch);

/* POV-Ray's method 2: pixel corners, and recursive quartering where they differ.  The result
 * is in scratch->block. */
void aa_corners(const Aa *aa, FilmRect rect, AaSampler sampler, void *ctx, AaScratch *scratch);

#endif
