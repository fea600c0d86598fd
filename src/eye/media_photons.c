/* Light of photons in media: what mirrors and lenses focus there, and what media scatter more than
 * once.  SPDX-License-Identifier: Apache-2.0 */
#include "eye/air_int.h"

/* Photons with more than this optical depth between them and the ray ask for the surface behind
 * them: with less, a plane will do.  Those deeper than the other are hardly seen. */
#define BENT_DEPTH 0.05
#define DARK_DEPTH 12

/* Where that surface may be, beyond the plane: times the way from the ray. */
#define BENT_FAR 8

typedef struct PhotonSum {
    EyeThread *eye;
    const Object *from; /* whose surface the ray comes from; NULL: none */
    MediaLobes lobes;
    const MediaProfile *profile;
    const Ray *ray;
    double begin, end; /* t of the part that is looked at */
    double focused[3], scattered[3];
    double blur[3], noise2[3]; /* see LightEstimate */
    uint64_t count;
} PhotonSum;

/* How far a photon lies from the surface that its own parallel ray comes from, where it matters
 * that this is not the plane it was taken for. */
static double photon_way(PhotonSum *sum, const VolumePhoton *photon)
{
    Rgb x = sum->profile->cells[0].point.extinction;
    double aside = v3_len(photon->aside);
    if (!sum->from || !((double)rgb_max(x) * aside > BENT_DEPTH) ||
        (double)rgb_min(x) * photon->way > DARK_DEPTH)
        return photon->way;
    Hit hit;
    uint32_t object = (uint32_t)(sum->from - sum->eye->scene->objects);
    V3 p = v3_add(ray_at(sum->ray, sum->begin + photon->t), photon->aside);
    Ray back = {p, v3_neg(sum->ray->d), 0, photon->way + BENT_FAR * aside};
    return trace_object(&sum->eye->trace, &back, object, &hit) ? hit.t : photon->way;
}

static void add_photon(void *ctx, const VolumePhoton *photon)
{
    PhotonSum *sum = ctx;
    double way = sum->begin + photon_way(sum, photon);
    const MediaCell *cell = air_cell_at(sum->profile, way);
    V3 p = ray_at(sum->ray, fmin(sum->end, fmax(0, sum->begin + photon->t)));
    Rgb scattered = media_scattered(&sum->lobes, p, v3_dot(photon->from, sum->ray->d));
    Rgb depth = rgb_mad(cell->depth, (float)(way - cell->begin), cell->point.extinction);
    Rgb light = rgb_mul(rgb_mul(scattered, photon->power), media_clear(depth));
    const double values[3] = {(double)light.r, (double)light.g, (double)light.b};
    double *to = photon->is_focused ? sum->focused : sum->scattered;
    for (int i = 0; i < 3; i++) {
        to[i] += values[i];
        sum->blur[i] += values[i] * (double)photon->excess;
        sum->noise2[i] += values[i] * values[i];
    }
    sum->count++;
}

static Rgb rgb_of(const double sum[3])
{
    return rgb((float)sum[0], (float)sum[1], (float)sum[2]);
}

void media_photons(EyeThread *eye, const MediaHere *here, const MediaProfile *profile,
                   const Ray *ray, double begin, double end, const AirEnds *ends,
                   Rgb light[PART_COUNT])
{
    PhotonSum sum = {
        .eye = eye, .from = ends->from, .profile = profile, .ray = ray, .begin = begin, .end = end};
    Ray part = {ray_at(ray, begin), ray->d, 0, INFINITY};
    media_lobes(here, &sum.lobes);
    volume_along(eye->options.volume, begin > 0 ? &part : ray, end - begin, &ends->planes,
                 add_photon, &sum);
    eye->trace.stats.count[STAT_GATHERS]++;
    eye->trace.stats.count[STAT_GATHERED] += sum.count;
    eye->trace.stats.count[STAT_GATHERED_VOLUME] += sum.count;
    light[PART_CAUSTIC] = rgb_add(light[PART_CAUSTIC], rgb_of(sum.focused));
    light[PART_INDIRECT] = rgb_add(light[PART_INDIRECT], rgb_of(sum.scattered));
    if (!eye->options.has_error)
        return;
    const double noise[3] = {sqrt(sum.noise2[0]), sqrt(sum.noise2[1]), sqrt(sum.noise2[2])};
    light[PART_BLUR] = rgb_add(light[PART_BLUR], rgb_of(sum.blur));
    light[PART_NOISE] = rgb_add(light[PART_NOISE], rgb_of(noise));
}
