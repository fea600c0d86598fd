/* The film: samples as rows of floats, and the image they end in.
 *
 * A sample of a pixel is a vector of channels: R G B A, then those of the layers asked for, then
 * what errors are estimated from.  Antialiasing averages whole vectors, so light layers add up to
 * the beauty however a pixel was sampled.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_RENDER_FILM_H
#define PMS_RENDER_FILM_H

#include "eye/eye.h"
#include "render/render.h"

/* What errors are estimated from: luminances. */
typedef enum ClueChannel {
    CLUE_NOISE,   /* standard error of the light of photons */
    CLUE_BLUR,    /* see LightEstimate */
    CLUE_SHARED,  /* light that the samples of a pass take from the same photons or records */
    CLUE_SQUARE,  /* of the whole light */
    CLUE_LENS,    /* square of the standard error that the rays of focal blur leave */
    CLUE_CHANNELS
} ClueChannel;

/* RGBA, three light layers, Z, N, albedo, clues. */
enum { FILM_CHANNELS_MAX = 4 + 3 * 3 + 1 + 3 + 3 + CLUE_CHANNELS };

/* Pixel blocks of the language's antialiasing methods. */
enum { FILM_BLOCK = 32 };

/* What a pixel gets of one pass of many. */
typedef struct PixelSamples {
    uint32_t first; /* number of the first of these samples */
    uint16_t wanted;
    uint16_t good; /* of them that could be used, when the pass is done */
} PixelSamples;

/* A sample that is no number: the first one of the film, by its pixel and then its own number. */
typedef struct FilmFault {
    uint64_t count; /* of such samples */
    int x, y;
    uint32_t index;
    const Object *object; /* where it came to be; NULL: the sky or the camera */
    bool is_told;         /* the user has been told of one, in this pass or before */
} FilmFault;

typedef struct Film {
    int width, height;
    int channels;    /* of a vector */
    int z_channel;   /* of depth: the nearest counts, not the average; -1: none */
    unsigned layers; /* LayerBits */
    bool has_alpha;
    bool has_shared_indirect; /* the samples of a pass share photons or records of indirect light */
    bool has_clues;        /* the last layer of the image is what errors are estimated from */
    PixelSamples *samples; /* of all pixels, of one of many passes; NULL: as the options say */
    FilmFault fault;       /* of the last time that the film was filled; count 0: none */
    Image image;
} Film;

/* Part of the film, pixels; x2 and y2 are one past the last. */
typedef struct FilmRect {
    int x1, y1, x2, y2;
} FilmRect;

/* Return the name of a layer. */
const char *film_layer_name(LayerBit layer);

/* What a film is for. */
typedef enum FilmUse {
    FILM_SAMPLES = 1, /* its layers are means of samples */
    FILM_CLUES = 2,   /* what errors are estimated from is kept too */
    FILM_SHARED_INDIRECT = 8, /* see has_shared_indirect */
    FILM_SHOWN = 4    /* it has the layers that are found from others at the end */
} FilmUse;

/* Make an image with the layers asked for.  Free with film_done.
 *
 * use  of FilmUse, as bits. */
Status film_init(Film *film, const RenderOptions *options, unsigned use, Diag *diag);
void film_done(Film *film);

/* Turn the image of samples and clues into one that is shown: instead of the clues it has the
 * layers that are found at the end. */
Status film_show_errors(Film *film, Diag *diag);

/* Turn a sample into a vector. */
void film_vector(const Film *film, const EyeSample *sample, float *out);

/* Copy a rectangle between the image and rows of vectors. */
void film_store(Film *film, FilmRect rect, const float *vectors);
void film_fetch(const Film *film, FilmRect rect, float *vectors);

/* Return how many blocks of a side cover the film, and block `index` of them, row by row. */
size_t film_block_count(const Film *film, int side);
FilmRect film_block(const Film *film, int side, size_t index);

/* Turn the working values of a picture into linear light, as the scene's assumed_gamma says; layers
 * keep their share of each pixel's beauty. */
void film_linearize(Image *picture, const SceneSettings *settings);

/* Return the linear light of a working value. */
double film_linear(const SceneSettings *settings, double value);

/* Return by how much linear light changes with a working value. */
double film_slope(const SceneSettings *settings, double value);

#endif
