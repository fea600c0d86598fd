/* Estimates from a photon map.  SPDX-License-Identifier: Apache-2.0 */
#include "photon/gather.h"

#include "base/mem.h"
#include "photon/photon_map_int.h"
#include "photon/search_int.h"

#include <stdlib.h>
#include <string.h>

/* The Gaussian of Jensen's course notes; its printed scale, and the one that keeps the light:
 * 1 over the mean of the bracket over the disk, x uniform in [0,1]. */
#define GAUSSIAN_BETA 1.953
#define GAUSSIAN_ALPHA_JENSEN 0.918
#define GAUSSIAN_ALPHA 1.7283093000119807

enum { RADIUS_SAMPLES_MIN = 100, RADIUS_SAMPLES_MAX = 1000, RADIUS_SAMPLES_PART = 20 };

/* The part of the photons around which the search radius of a map holds enough others.  Near the
 * mean density, as a focus sets it, the dim parts of a caustic would be single specks. */
#define RADIUS_QUANTILE 0.8

int gather_most(const PhotonSettings *photons)
{
    return photons->gather_max > 0 ? photons->gather_max : GATHER_LIMITS_DEFAULT.max_photons;
}

GatherScratch *gather_scratch_new(void)
{
    return mem_alloc(sizeof(GatherScratch));
}

void gather_scratch_free(GatherScratch *scratch)
{
    if (!scratch)
        return;
    mem_free(scratch->found.distance2);
    mem_free(scratch->found.index);
    mem_free(scratch->found.excess);
    mem_free(scratch->list);
    mem_free(scratch);
}

double gather_kernel(GatherKernel kernel, double x)
{
    switch (kernel) {
    case KERNEL_CONE:
        return 3 * (1 - sqrt(x));
    case KERNEL_EPANECHNIKOV:
        return 2 * (1 - x);
    case KERNEL_GAUSSIAN:
    case KERNEL_GAUSSIAN_JENSEN: {
        double alpha = kernel == KERNEL_GAUSSIAN ? GAUSSIAN_ALPHA : GAUSSIAN_ALPHA_JENSEN;
        return alpha * (1 - (1 - exp(-GAUSSIAN_BETA / 2 * x)) / (1 - exp(-GAUSSIAN_BETA)));
    }
    case KERNEL_FLAT:
    case KERNEL_COUNT:
        break;
    }
    return 1;
}

double gather_blur_variance(GatherKernel kernel)
{
    enum { RINGS = 64 };
    double light = 0, blur = 0;
    for (int i = 0; i < RINGS; i++) {
        double x = (i + 0.5) / RINGS, weight = gather_kernel(kernel, x);
        double half = x < 0.5 ? 2 * gather_kernel(kernel, 2 * x) : 0;
        light += weight * weight;
        blur += (weight - half) * (weight - half);
    }
    return blur / light;
}

/* Replace squared distances by kernel weights over pi r^2. */
static void weigh(FoundPhotons *found, GatherKernel kernel, float radius2)
{
    float *value = found->distance2;
    const float scale = (float)(1 / (PMS_PI * (double)radius2)), inverse = 1 / radius2;
    if (kernel == KERNEL_CONE) {
        for (size_t i = 0; i < found->count; i++)
            value[i] = scale * 3 * (1 - sqrtf(value[i] * inverse));
    } else if (kernel == KERNEL_EPANECHNIKOV) {
        for (size_t i = 0; i < found->count; i++)
            value[i] = scale * 2 * (1 - value[i] * inverse);
    } else if (kernel == KERNEL_FLAT) {
        for (size_t i = 0; i < found->count; i++)
            value[i] = scale;
    } else {
        for (size_t i = 0; i < found->count; i++)
            value[i] = scale * (float)gather_kernel(kernel, (double)(value[i] * inverse));
    }
}

/* Find of each photon what an estimate on half the area, with the same kernel, would have less of
 * it, as a share of its weight. */
static void find_excess(FoundPhotons *found, GatherKernel kernel, float radius2)
{
    const float inverse = 1 / radius2, half2 = radius2 / 2;
    if (kernel == KERNEL_FLAT) {
        for (size_t i = 0; i < found->count; i++)
            found->excess[i] = found->distance2[i] < half2 ? -1 : 1;
        return;
    }
    for (size_t i = 0; i < found->count; i++) {
        double x = (double)(found->distance2[i] * inverse), whole = gather_kernel(kernel, x);
        double half = x < 0.5 ? 2 * gather_kernel(kernel, 2 * x) : 0;
        found->excess[i] = whole > 0 ? (float)(1 - half / whole) : 0;
    }
}

/* Leave the photons within a part of the radius. */
static void shrink(FoundPhotons *found, double part, float *radius2)
{
    size_t kept = 0;
    *radius2 *= (float)(part * part);
    for (size_t i = 0; i < found->count; i++)
        if (found->distance2[i] < *radius2) {
            found->distance2[kept] = found->distance2[i];
            found->index[kept++] = found->index[i];
        }
    found->count = kept;
}

/* Find what an estimate is made of and replace squared distances by kernel weights over pi r^2.
 * Returns false when there is nothing. */
static bool find_weights(const PhotonMap *map, V3 p, V3 n, const GatherLimits *limits,
                         GatherScratch *scratch)
{
    float radius2;
    bool is_widened = photon_search(map, p, n, limits, scratch, &radius2);
    if (limits->shrink > 0)
        shrink(&scratch->found, limits->shrink, &radius2);
    if (!(radius2 > 0) || scratch->found.count == 0)
        return false;
    bool is_softened = is_widened && limits->kernel == KERNEL_FLAT;
    GatherKernel kernel = is_softened ? KERNEL_EPANECHNIKOV : limits->kernel;
    if (limits->has_error)
        find_excess(&scratch->found, kernel, radius2);
    weigh(&scratch->found, kernel, radius2);
    return true;
}

int photon_gather(const PhotonMap *map, V3 p, V3 n, const GatherLimits *limits,
                  GatherScratch *scratch, Rgb *out)
{
    FoundPhotons *found = &scratch->found;
    *out = RGB_BLACK;
    if (!find_weights(map, p, n, limits, scratch))
        return 0;
    double r = 0, g = 0, b = 0;
    for (size_t i = 0; i < found->count; i++) {
        Rgb power = photon_map_power(map, found->index[i]);
        r += (double)(power.r * found->distance2[i]);
        g += (double)(power.g * found->distance2[i]);
        b += (double)(power.b * found->distance2[i]);
    }
    *out = rgb((float)r, (float)g, (float)b);
    return (int)found->count;
}

int photon_gather_estimate(const PhotonMap *map, V3 p, V3 n, const GatherLimits *limits,
                           GatherScratch *scratch, LightEstimate *out)
{
    FoundPhotons *found = &scratch->found;
    *out = (LightEstimate){.light = RGB_BLACK};
    int count = photon_gather(map, p, n, limits, scratch, &out->light);
    if (!limits->has_error)
        return count;
    Rgb blur = RGB_BLACK, noise2 = RGB_BLACK;
    for (size_t i = 0; i < (size_t)count; i++) {
        Rgb light = rgb_scale(photon_map_power(map, found->index[i]), found->distance2[i]);
        blur = rgb_mad(blur, found->excess[i], light);
        noise2 = rgb_add(noise2, rgb_mul(light, light));
    }
    out->blur = blur;
    out->noise = rgb(sqrtf(noise2.r), sqrtf(noise2.g), sqrtf(noise2.b));
    return count;
}

int photon_gather_list(const PhotonMap *map, V3 p, V3 n, const GatherLimits *limits,
                       GatherScratch *scratch, const GatheredPhoton **out)
{
    FoundPhotons *found = &scratch->found;
    *out = scratch->list;
    if (!find_weights(map, p, n, limits, scratch))
        return 0;
    if (found->count > scratch->list_capacity) {
        size_t capacity = found->capacity;
        GatheredPhoton *list = mem_resize(scratch->list, capacity * sizeof *list);
        if (!list)
            return 0;
        scratch->list = list;
        scratch->list_capacity = capacity;
    }
    for (size_t i = 0; i < found->count; i++) {
        uint32_t index = found->index[i];
        scratch->list[i] =
            (GatheredPhoton){photon_map_from(map, index),
                             rgb_scale(photon_map_power(map, index), found->distance2[i]),
                             limits->has_error ? found->excess[i] : 0};
    }
    *out = scratch->list;
    return (int)found->count;
}

void photon_gather_see(const PhotonMap *map, const GatherScratch *scratch)
{
    for (size_t i = 0; map->seen && i < scratch->found.count; i++)
        photon_map_see(map, scratch->found.index[i]);
}

int photon_nearest(const PhotonMap *map, V3 p, V3 n, const GatherLimits *limits,
                   GatherScratch *scratch, const uint32_t **out, double *radius2)
{
    float found2;
    photon_search(map, p, n, limits, scratch, &found2);
    if (limits->shrink > 0)
        shrink(&scratch->found, limits->shrink, &found2);
    *radius2 = (double)found2;
    *out = scratch->found.index;
    return (int)scratch->found.count;
}

/* Squared radii around a spread of the map's photons. */
static size_t sample_radii(const PhotonMap *map, int max_photons, GatherScratch *scratch,
                           double *radii2)
{
    size_t count = photon_map_count(map), samples = count / RADIUS_SAMPLES_PART;
    samples = samples < RADIUS_SAMPLES_MIN ? RADIUS_SAMPLES_MIN : samples;
    samples = samples > RADIUS_SAMPLES_MAX ? RADIUS_SAMPLES_MAX : samples;
    samples = samples > count ? count : samples;
    GatherLimits limits = {.max_photons = max_photons < (int)count ? max_photons : (int)count,
                           .max_radius = INFINITY,
                           .shape = GATHER_SPHERE,
                           .normal_cosine = -1};
    size_t used = 0;
    for (size_t i = 0; i < samples; i++) {
        Photon photon = photon_map_at(map, (2 * i + 1) * count / (2 * samples));
        V3 p = v3_add(map->center, v3(photon.pos[0], photon.pos[1], photon.pos[2]));
        const uint32_t *index;
        double radius2;
        photon_nearest(map, p, v3(0, 0, 1), &limits, scratch, &index, &radius2);
        radii2[used] = radius2;
        used += radius2 > 0 && isfinite(radius2);
    }
    return used;
}

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double photon_map_radius(const PhotonMap *map, int max_photons)
{
    double radii2[RADIUS_SAMPLES_MAX];
    GatherScratch *scratch = gather_scratch_new();
    if (!scratch || photon_map_count(map) == 0 || max_photons < 1) {
        gather_scratch_free(scratch);
        return 0;
    }
    size_t used = sample_radii(map, max_photons, scratch, radii2);
    gather_scratch_free(scratch);
    if (used == 0)
        return 0;
    qsort(radii2, used, sizeof *radii2, compare_doubles);
    return sqrt(radii2[(size_t)(RADIUS_QUANTILE * (double)(used - 1))]);
}
