/* Sums of films.  SPDX-License-Identifier: Apache-2.0 */
#include "render/film_sum.h"

#include "base/mem.h"

#include <string.h>

static size_t layer_size(const Film *film, int layer)
{
    size_t pixels = (size_t)film->width * (size_t)film->height;
    return pixels * (size_t)film->image.layers[layer].channel_count;
}

Status film_sum_init(FilmSum *sum, const Film *film, Diag *diag)
{
    *sum = (FilmSum){.values = NULL};
    for (int i = 0; i < film->image.layer_count; i++) {
        size_t size = layer_size(film, i);
        if (strcmp(film->image.layers[i].name, "Z") == 0) {
            sum->z_begin = sum->count;
            sum->z_end = sum->count + size;
        }
        sum->count += size;
    }
    sum->values = mem_array(sum->count, sizeof *sum->values);
    if (!sum->values)
        return diag_no_memory(diag, "the sums of passes");
    for (size_t i = sum->z_begin; i < sum->z_end; i++)
        sum->values[i] = INFINITY;
    return OK;
}

void film_sum_done(FilmSum *sum)
{
    mem_free(sum->values);
    *sum = (FilmSum){.values = NULL};
}

static void add_values(FilmSum *sum, size_t begin, const float *values, size_t count)
{
    double *to = sum->values + begin, share = sum->passes ? 1 / (double)sum->passes : 0;
    for (size_t i = 0; i < count; i++)
        to[i] += isnan(values[i]) ? to[i] * share : (double)values[i];
}

/* fmin leaves out what is NaN. */
static void add_depths(FilmSum *sum, const float *values, size_t count)
{
    double *to = sum->values + sum->z_begin;
    for (size_t i = 0; i < count; i++)
        to[i] = fmin(to[i], (double)values[i]);
}

void film_sum_add(FilmSum *sum, const Film *film)
{
    size_t begin = 0;
    for (int i = 0; i < film->image.layer_count; i++) {
        const float *values = film->image.layers[i].pixels;
        size_t size = layer_size(film, i);
        if (begin == sum->z_begin && sum->z_end > begin)
            add_depths(sum, values, size);
        else
            add_values(sum, begin, values, size);
        begin += size;
    }
    sum->passes++;
}

void film_sum_mean(const FilmSum *sum, Film *film)
{
    size_t begin = 0;
    double mean = sum->passes ? 1 / (double)sum->passes : 0;
    for (int i = 0; i < film->image.layer_count; i++) {
        float *values = film->image.layers[i].pixels;
        size_t size = layer_size(film, i);
        bool is_depth = begin == sum->z_begin && sum->z_end > begin;
        const double *from = sum->values + begin;
        for (size_t k = 0; k < size; k++)
            values[k] = (float)(is_depth ? from[k] : from[k] * mean);
        begin += size;
    }
}
