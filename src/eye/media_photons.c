/* Light of photons in media: what mirrors and lenses focus there, and what media scatter more than
 * once.  SPDX-License-Identifier: Apache-2.0 */
#include "eye/air_int.h"

typedef struct PhotonSum {
    MediaLobes lobes;
    const MediaProfile *profile;
    const Ray *ray;
    double focused[3], scattered[3];
    uint64_t count;
} PhotonSum;

/* Return the cell of a profile at t. */
static const MediaCell *cell_at(const MediaProfile *profile, double t)
{
    int low = 0, high = profile->count - 1;
    while (low < high) {
        int middle = (low + high) / 2;
        if (profile->cells[middle].end <= t)
            low = middle + 1;
        else
            high = middle;
    }
    return &profile->cells[low];
}

static void add_photon(void *ctx, const VolumePhoton *photon)
{
    PhotonSum *sum = ctx;
    const MediaCell *cell = cell_at(sum->profile, photon->t);
    V3 p = ray_at(sum->ray, photon->t);
    Rgb scattered = media_scattered(&sum->lobes, p, v3_dot(photon->from, sum->ray->d));
    Rgb depth = rgb_mad(cell->depth, (float)(photon->t - cell->begin), cell->point.extinction);
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
                   const Ray *ray, Rgb light[PART_COUNT])
{
    PhotonSum sum = {.profile = profile, .ray = ray};
    media_lobes(here, &sum.lobes);
    double end = profile->cells[profile->count - 1].end;
    volume_along(eye->options.volume, ray, end, add_photon, &sum);
    eye->trace.stats.count[STAT_GATHERS]++;
    eye->trace.stats.count[STAT_GATHERED] += sum.count;
    light[PART_CAUSTIC] = rgb_add(light[PART_CAUSTIC], rgb_of(sum.focused));
    light[PART_INDIRECT] = rgb_add(light[PART_INDIRECT], rgb_of(sum.scattered));
}
