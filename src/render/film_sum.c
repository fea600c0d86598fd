/* Sums of films.  SPDX-License-Identifier: Apache-2.0 */
#include "render/film_sum.h"

#include "base/mem.h"

#include <string.h>

static bool is_depth(const ImageLayer *layer)
{
    return strcmp(layer->name, "Z") == 0;
}

Status film_sum_init(FilmSum *sum, const Film *film, Diag *diag)
{
    *sum = (FilmSum){.pixels = (size_t)film->width * (size_t)film->height};
    for (int i = 0; i < film->image.layer_count; i++) {
        const ImageLayer *layer = &film->image.layers[i];
        size_t size = sum->pixels * (size_t)layer->channel_count;
        if (is_depth(layer)) {
            sum->z_begin = sum->count;
            sum->z_end = sum->count + size;
        }
        sum->count += size;
    }
    sum->clues = sum->count - (film->has_clues ? sum->pixels * CLUE_CHANNELS : 0);
    sum->values = mem_array(sum->count, sizeof *sum->values);
    sum->taken = mem_array(sum->pixels, sizeof *sum->taken);
    sum->good = mem_array(sum->pixels, sizeof *sum->good);
    if (!sum->values || !sum->taken || !sum->good)
        return diag_no_memory(diag, "the sums of passes");
    for (size_t i = sum->z_begin; i < sum->z_end; i++)
        sum->values[i] = INFINITY;
    return OK;
}

void film_sum_done(FilmSum *sum)
{
    mem_free(sum->values);
    mem_free(sum->taken);
    mem_free(sum->good);
    *sum = (FilmSum){.values = NULL};
}

void film_sum_follow(const FilmSum *sum, Film *film)
{
    for (size_t i = 0; i < sum->pixels; i++)
        film->samples[i].first = sum->taken[i];
}

static void add_layer(double *to, const ImageLayer *layer, const Film *film, size_t pixels)
{
    size_t channels = (size_t)layer->channel_count;
    const float *from = layer->pixels;
    for (size_t i = 0; i < pixels; i++, to += channels, from += channels) {
        double samples = film->samples[i].good;
        for (size_t c = 0; c < channels && samples > 0; c++)
            to[c] += samples * (double)from[c];
    }
}

static void add_depths(double *to, const float *from, size_t count)
{
    for (size_t i = 0; i < count; i++)
        to[i] = fmin(to[i], (double)from[i]);
}

void film_sum_add(FilmSum *sum, const Film *film)
{
    double *to = sum->values;
    for (int i = 0; i < film->image.layer_count; i++) {
        const ImageLayer *layer = &film->image.layers[i];
        if (is_depth(layer))
            add_depths(to, layer->pixels, sum->pixels);
        else
            add_layer(to, layer, film, sum->pixels);
        to += sum->pixels * (size_t)layer->channel_count;
    }
    for (size_t i = 0; i < sum->pixels; i++) {
        sum->taken[i] += film->samples[i].wanted;
        sum->good[i] += film->samples[i].good;
    }
    sum->passes++;
}

static void mean_depths(const FilmSum *sums, int n, size_t begin, float *to)
{
    for (size_t i = 0; i < sums->pixels; i++) {
        double nearest = sums[0].values[begin + i];
        for (int k = 1; k < n; k++)
            nearest = fmin(nearest, sums[k].values[begin + i]);
        to[i] = (float)nearest;
    }
}

static void mean_layer(const FilmSum *sums, int n, size_t begin, size_t channels, float *to)
{
    for (size_t i = 0; i < sums->pixels; i++) {
        double samples = 0;
        for (int k = 0; k < n; k++)
            samples += sums[k].good[i];
        for (size_t c = 0; c < channels; c++) {
            double value = 0;
            for (int k = 0; k < n; k++)
                value += sums[k].values[begin + i * channels + c];
            to[i * channels + c] = samples > 0 ? (float)(value / samples) : 0;
        }
    }
}

void film_sum_mean(const FilmSum *sums, int n, Image *picture)
{
    size_t begin = 0;
    for (int i = 0; i < picture->layer_count && begin < sums->clues; i++) {
        ImageLayer *layer = &picture->layers[i];
        size_t channels = (size_t)layer->channel_count;
        if (is_depth(layer))
            mean_depths(sums, n, begin, layer->pixels);
        else
            mean_layer(sums, n, begin, channels, layer->pixels);
        begin += sums->pixels * channels;
    }
}
