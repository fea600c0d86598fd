/* The film: samples as rows of floats, and the image they end in.
 *
 * A sample of a pixel is a vector of channels: R G B A, then those of the layers asked for.
 * Antialiasing averages whole vectors, so light layers add up to the beauty however a pixel
 * was sampled.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_RENDER_FILM_H
#define PMS_RENDER_FILM_H

#include "eye/eye.h"
#include "render/render.h"

/* RGBA, three light layers, Z, N, albedo. */
enum { FILM_CHANNELS_MAX = 4 + 3 * 3 + 1 + 3 + 3 };

/* Pixel blocks of the language's antialiasing methods. */
enum { FILM_BLOCK = 32 };

typedef struct Film {
    int width, height;
    int channels;    /* of a vector */
    int z_channel;   /* of depth: the nearest counts, not the average; -1: none */
    unsigned layers; /* LayerBits */
    bool has_alpha;
    Image image;
} Film;

/* Part of the film, pixels; x2 and y2 are one past the last. */
typedef struct FilmRect {
    int x1, y1, x2, y2;
} FilmRect;

/* Return the name of a layer. */
const char *film_layer_name(LayerBit layer);

/* Make an image with the layers asked for.  Free with film_done. */
Status film_init(Film *film, const RenderOptions *options, Diag *diag);
void film_done(Film *film);

/* Turn a sample into a vector. */
void film_vector(const Film *film, const EyeSample *sample, float *out);

/* Copy a rectangle between the image and rows of vectors. */
void film_store(Film *film, FilmRect rect, const float *vectors);
void film_fetch(const Film *film, FilmRect rect, float *vectors);

/* Return how many blocks of a side cover the film, and block `index` of them, row by row. */
size_t film_block_count(const Film *film, int side);
FilmRect film_block(const Film *film, int side, size_t index);

/* Turn working values into linear light, as the scene's assumed_gamma says; layers keep their
 * share of each pixel's beauty. */
void film_linearize(Film *film, const SceneSettings *settings);

#endif
