/* Where a photon on its way is stored: on surfaces that scatter its light diffusely, and in media.
 * SPDX-License-Identifier: Apache-2.0 */
#include "photon/way_int.h"

#include "base/mem.h"

/* Let the lights keep pace with the items. */
static bool make_light_room(PhotonList *list)
{
    PhotonLight *lights = mem_resize(list->lights, list->capacity * sizeof *lights);
    if (lights)
        list->lights = lights;
    return lights != NULL;
}

static bool make_room(PhotonList *list, bool has_lights)
{
    void *items = list->items;
    size_t before = list->capacity;
    if (mem_grow(&items, list->count, &list->capacity, sizeof *list->items) != 0)
        list->is_short = true;
    list->items = items;
    if (has_lights && list->capacity != before && !make_light_room(list)) {
        list->is_short = true;
        list->capacity = before;
    }
    return list->count < list->capacity;
}

/* Return how many times its power a photon is to have: of little power 0 but for the chance that
 * makes up for more. */
static float thin_out(Walk *walk, Rgb power, float least)
{
    float most = rgb_max(power);
    if (!(most > 0) || !rgb_is_finite(power))
        return 0;
    if (most >= least)
        return 1;
    return rng_float(walk->rng) * least < most ? least / most : 0;
}

static bool store(Walk *walk, V3 p, V3 from, unsigned flags, Rgb power, PhotonList *out)
{
    if (!(rgb_max(power) > 0) || !rgb_is_finite(power) || !make_room(out, walk->rules->keeps_light))
        return false;
    V3 at = v3_sub(p, walk->rules->center);
    if (walk->rules->keeps_light)
        out->lights[out->count] =
            (PhotonLight){power, {(float)from.x, (float)from.y, (float)from.z}};
    Photon *photon = &out->items[out->count++];
    *photon = (Photon){.pos = {(float)at.x, (float)at.y, (float)at.z}, .flags = (uint16_t)flags};
    rgbe_encode(power, walk->rng, photon->rgbe);
    direction_encode(from, &photon->phi, &photon->theta);
    return true;
}

static const Surface *tied_surface(const Walk *walk, const HitTie *tie)
{
    return &tracer_scene(walk->thread->tracer)->surfaces[tie->crossing.leaf->surface];
}

/* Clear glass that collects nothing does not keep the table it stands on from it. */
static bool is_collecting(const Walk *walk, const Hit *hit)
{
    bool is = hit->surface->photons.is_collecting;
    for (int i = 0; i < hit->tie_count; i++)
        is = is || tied_surface(walk, &hit->ties[i])->photons.is_collecting;
    return is;
}

bool walk_keeps(const Walk *walk, const Hit *hit)
{
    if (walk->rules->map == MAP_GLOBAL)
        return (walk->is_diffuse || walk->rules->keeps_first || !walk->beam->light) &&
               walk->diffuse <= walk_most_diffuse(walk);
    return walk->rules->map == MAP_CAUSTIC && walk->is_specular && is_collecting(walk, hit);
}

void walk_keep(Walk *walk, const Hit *hit, float least, PhotonList *out, WalkResult *result)
{
    Rgb flux = walk_flux(walk), power = rgb_mul(flux, walk->weight);
    V3 n = hit->point.ng;
    n = v3_dot(n, walk->ray.d) > 0 ? v3_neg(n) : n;
    unsigned flags = (unsigned)normal14_encode(n) << 2;
    if (shape_point_is_inside(&hit->point, n))
        flags |= PHOTON_INSIDE;
    float times = thin_out(walk, power, least);
    walk_settle(walk, flux, rgb_scale(walk->weight, times), result);
    result->stored +=
        store(walk, hit->point.p, v3_neg(walk->ray.d), flags, rgb_scale(power, times), out);
}

static Rgb flux_at(Walk *walk, double length)
{
    return walk->is_diffuse ? walk->flux : beam_flux(walk->beam, walk->start, length);
}

void walk_keep_stop(Walk *walk, const MediaLeg *leg, PhotonList *out, WalkResult *result)
{
    unsigned flags = walk->rules->map == MAP_FOCUS ? PHOTON_FOCUSED : 0;
    Rgb flux = flux_at(walk, walk->length + leg->stop), power = rgb_mul(flux, leg->power);
    Rgb weight = rgb_mul(walk->weight, interiors_fade(&walk->inside, leg->stop));
    V3 p = ray_at(&walk->ray, leg->stop), from = v3_neg(walk->ray.d);
    walk_settle(walk, flux, walk->weight, result);
    result->stored += store(walk, p, from, flags, rgb_mul(power, weight), out);
}
