/* Light of photons in media: what mirrors and lenses focus there, and what media scatter more than
 * once.  SPDX-License-Identifier: Apache-2.0 */
#include "eye/air_int.h"

typedef struct PhotonSum {
    MediaLobes lobes;
    const MediaProfile *profile;
    const Ray *ray;
    double begin; /* t where the part that is looked at begins */
    double focused[3], scattered[3];
    uint64_t count;
} PhotonSum;

static void add_photon(void *ctx, const VolumePhoton *photon)
{
    PhotonSum *sum = ctx;
    double t = sum->begin + photon->t;
    const MediaCell *cell = air_cell_at(sum->profile, t);
    V3 p = ray_at(sum->ray, t);
    Rgb scattered = media_scattered(&sum->lobes, p, v3_dot(photon->from, sum->ray->d));
    Rgb depth = rgb_mad(cell->depth, (float)(t - cell->begin), cell->point.extinction);
    Rgb light = rgb_mul(rgb_mul(scattered, photon->power), media_clear(depth));
    double *to = photon->is_focused ? sum->focused : sum->scattered;
    to[0] += (double)light.r;
    to[1] += (double)light.g;
    to[2] += (double)light.b;
    sum->count++;
}

static Rgb rgb_of(const double sum[3])
{
    return rgb((float)sum[0], (float)sum[1], (float)sum[2]);
}

void media_photons(EyeThread *eye, const MediaHere *here, const MediaProfile *profile,
                   const Ray *ray, double begin, double end, Rgb light[PART_COUNT])
{
    PhotonSum sum = {.profile = profile, .ray = ray, .begin = begin};
    Ray part = {ray_at(ray, begin), ray->d, 0, INFINITY};
    media_lobes(here, &sum.lobes);
    volume_along(eye->options.volume, begin > 0 ? &part : ray, end - begin, add_photon, &sum);
    eye->trace.stats.count[STAT_GATHERS]++;
    eye->trace.stats.count[STAT_GATHERED] += sum.count;
    light[PART_CAUSTIC] = rgb_add(light[PART_CAUSTIC], rgb_of(sum.focused));
    light[PART_INDIRECT] = rgb_add(light[PART_INDIRECT], rgb_of(sum.scattered));
}
