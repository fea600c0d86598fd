/* The film.  SPDX-License-Identifier: Apache-2.0 */
#include "render/film.h"

#include <string.h>

typedef struct LayerKind {
    unsigned bit;
    const char *name, *channels;
} LayerKind;

/* Those that are found at the end, from the picture as a whole, not by samples. */
enum { LAYERS_FOUND = LAYER_ERROR_NOISE | LAYER_ERROR_BIAS };

/* In the order of a vector's channels, which film_vector repeats. */
static const LayerKind LAYER_KINDS[] = {
    {0, "", "RGBA"},
    {LAYER_DIRECT, "direct", "RGB"},
    {LAYER_CAUSTIC, "caustic", "RGB"},
    {LAYER_INDIRECT, "indirect", "RGB"},
    {LAYER_Z, "Z", "Z"},
    {LAYER_N, "N", "XYZ"},
    {LAYER_ALBEDO, "albedo", "RGB"},
    {LAYER_ERROR_NOISE, "error.noise", "Y"},
    {LAYER_ERROR_BIAS, "error.bias", "Y"},
};
enum { LAYER_KIND_COUNT = sizeof LAYER_KINDS / sizeof LAYER_KINDS[0] };

const char *film_layer_name(LayerBit layer)
{
    for (int i = 0; i < LAYER_KIND_COUNT; i++)
        if (LAYER_KINDS[i].bit == layer)
            return LAYER_KINDS[i].name;
    return "";
}

static bool add_layers(Film *film, unsigned use)
{
    for (int i = 0; i < LAYER_KIND_COUNT; i++) {
        const LayerKind *kind = &LAYER_KINDS[i];
        bool is_found = kind->bit & LAYERS_FOUND;
        if ((kind->bit && !(film->layers & kind->bit)) || (is_found && !(use & FILM_SHOWN)))
            continue;
        if (!image_add_layer(&film->image, kind->name, kind->channels))
            return false;
        if (is_found)
            continue;
        if (kind->bit == LAYER_Z)
            film->z_channel = film->channels;
        film->channels += (int)strlen(kind->channels);
    }
    film->has_clues = use & FILM_CLUES;
    film->has_shared_indirect = use & FILM_SHARED_INDIRECT;
    film->channels += film->has_clues ? CLUE_CHANNELS : 0;
    return !film->has_clues || image_add_layer(&film->image, "clues", "NBCSL");
}

Status film_init(Film *film, const RenderOptions *options, unsigned use, Diag *diag)
{
    *film = (Film){.width = options->width,
                   .height = options->height,
                   .z_channel = -1,
                   .layers = options->layers,
                   .has_alpha = options->has_alpha};
    image_init(&film->image, film->width, film->height);
    if (add_layers(film, use))
        return OK;
    film_done(film);
    return diag_no_memory(diag, "the image");
}

void film_done(Film *film)
{
    image_done(&film->image);
}

Status film_show_errors(Film *film, Diag *diag)
{
    image_drop_layer(&film->image);
    film->channels -= CLUE_CHANNELS;
    film->has_clues = false;
    for (int i = 0; i < LAYER_KIND_COUNT; i++) {
        const LayerKind *kind = &LAYER_KINDS[i];
        if (kind->bit & LAYERS_FOUND & film->layers &&
            !image_add_layer(&film->image, kind->name, kind->channels))
            return diag_no_memory(diag, "the image");
    }
    return OK;
}

static float *put_rgb(float *out, Rgb c)
{
    out[0] = c.r;
    out[1] = c.g;
    out[2] = c.b;
    return out + 3;
}

void film_vector(const Film *film, const EyeSample *s, float *out)
{
    Rgb beauty =
        rgb_add(rgb_add(s->part[PART_DIRECT], s->part[PART_CAUSTIC]), s->part[PART_INDIRECT]);
    float *at = put_rgb(out, beauty);
    *at++ = film->has_alpha ? s->alpha : 1;
    for (int i = 0; i < PART_LIGHTS; i++)
        if (film->layers & (unsigned)LAYER_DIRECT << i)
            at = put_rgb(at, s->part[i]);
    if (film->layers & LAYER_Z)
        *at++ = (float)s->depth;
    if (film->layers & LAYER_N)
        at = put_rgb(at, rgb((float)s->normal.x, (float)s->normal.y, (float)s->normal.z));
    if (film->layers & LAYER_ALBEDO)
        at = put_rgb(at, s->albedo);
    if (!film->has_clues)
        return;
    at[CLUE_NOISE] = rgb_luminance(s->part[PART_NOISE]);
    at[CLUE_BLUR] = rgb_luminance(s->part[PART_BLUR]);
    at[CLUE_SHARED] = rgb_luminance(s->part[PART_CAUSTIC]);
    if (film->has_shared_indirect)
        at[CLUE_SHARED] += rgb_luminance(s->part[PART_INDIRECT]);
    float lens = rgb_luminance(s->lens_noise);
    at[CLUE_LENS] = lens * lens;
    at[CLUE_SQUARE] = rgb_luminance(beauty) * rgb_luminance(beauty);
}

static size_t row_offset(const Film *film, int x, int y)
{
    return (size_t)y * (size_t)film->width + (size_t)x;
}

void film_store(Film *film, FilmRect rect, const float *vectors)
{
    for (int y = rect.y1; y < rect.y2; y++)
        for (int x = rect.x1; x < rect.x2; x++)
            for (int i = 0; i < film->image.layer_count; i++) {
                ImageLayer *layer = &film->image.layers[i];
                size_t count = (size_t)layer->channel_count;
                memcpy(layer->pixels + row_offset(film, x, y) * count, vectors,
                       count * sizeof *vectors);
                vectors += count;
            }
}

void film_fetch(const Film *film, FilmRect rect, float *vectors)
{
    for (int y = rect.y1; y < rect.y2; y++)
        for (int x = rect.x1; x < rect.x2; x++)
            for (int i = 0; i < film->image.layer_count; i++) {
                const ImageLayer *layer = &film->image.layers[i];
                size_t count = (size_t)layer->channel_count;
                memcpy(vectors, layer->pixels + row_offset(film, x, y) * count,
                       count * sizeof *vectors);
                vectors += count;
            }
}

static int blocks_along(int length, int side)
{
    return (length + side - 1) / side;
}

size_t film_block_count(const Film *film, int side)
{
    return (size_t)blocks_along(film->width, side) * (size_t)blocks_along(film->height, side);
}

FilmRect film_block(const Film *film, int side, size_t index)
{
    size_t across = (size_t)blocks_along(film->width, side);
    int x1 = (int)(index % across) * side, y1 = (int)(index / across) * side;
    int x2 = x1 + side, y2 = y1 + side;
    return (FilmRect){x1, y1, x2 < film->width ? x2 : film->width,
                      y2 < film->height ? y2 : film->height};
}

/* --- working values to linear light --------------------------------------------------------- */

/* Scenes of before 3.7 without assumed_gamma work on display values. */
double film_linear(const SceneSettings *settings, double v)
{
    if (settings->is_gamma_off)
        return v <= 0.04045 ? v / 12.92 : pow((v + 0.055) / 1.055, 2.4);
    return !(v > 0) ? 0 : settings->assumed_gamma == 1 ? v : pow(v, settings->assumed_gamma);
}

double film_slope(const SceneSettings *settings, double value)
{
    double gamma = settings->assumed_gamma;
    if (settings->is_gamma_off)
        return value <= 0.04045 ? 1 / 12.92 : 2.4 / 1.055 * pow((value + 0.055) / 1.055, 1.4);
    return gamma == 1 ? 1 : value > 0 ? gamma * pow(value, gamma - 1) : 0;
}

static void scale_light_layers(Image *picture, size_t pixel, const float factor[3])
{
    for (int i = 1; i < picture->layer_count; i++) {
        ImageLayer *layer = &picture->layers[i];
        if (strcmp(layer->name, "direct") != 0 && strcmp(layer->name, "caustic") != 0 &&
            strcmp(layer->name, "indirect") != 0)
            continue;
        for (size_t c = 0; c < 3; c++)
            layer->pixels[pixel * 3 + c] *= factor[c];
    }
}

void film_linearize(Image *picture, const SceneSettings *settings)
{
    if (!settings->is_gamma_off && settings->assumed_gamma == 1)
        return;
    float *beauty = picture->layers[0].pixels;
    size_t pixels = (size_t)picture->width * (size_t)picture->height;
    for (size_t i = 0; i < pixels; i++) {
        float factor[3];
        for (size_t c = 0; c < 3; c++) {
            float *v = &beauty[i * 4 + c];
            float linear = (float)film_linear(settings, (double)*v);
            factor[c] = *v != 0 ? linear / *v : 0;
            *v = linear;
        }
        scale_light_layers(picture, i, factor);
    }
}
