/* Media: phase functions and densities.  SPDX-License-Identifier: Apache-2.0 */
#include "texture/media.h"

/* --- phase functions ---------------------------------------------------------------------- */

/* The language's Mie scattering: scale (1 + strength ((1+cos)/2)^power). */
typedef struct MieLobe {
    double scale;
    int strength, power;
    int squarings; /* power is 2 to this */
} MieLobe;

static const MieLobe hazy = {0.576655375, 9, 8, 3}, murky = {0.495714547, 50, 32, 5};

#define RAYLEIGH_SCALE 0.799372013

/* Below this eccentricity Henyey-Greenstein is isotropic to all digits of a float. */
#define ECCENTRICITY_LEAST 1e-8

static double mie_value(const MieLobe *mie, double cosine)
{
    double lobe = (1 + cosine) / 2;
    for (int i = 0; i < mie->squarings; i++)
        lobe *= lobe;
    return mie->scale * (1 + mie->strength * lobe);
}

/* Draw from the lobe with the chance it has of the whole, else from all directions. */
static double mie_sample(const MieLobe *mie, double u)
{
    double even = 1 / (1 + mie->strength / (mie->power + 1.0));
    if (u < even)
        return 2 * u / even - 1;
    return 2 * pow((u - even) / (1 - even), 1 / (mie->power + 1.0)) - 1;
}

/* The root of c^3 + 3c = 8u - 4: what the integral of 1 + c^2 makes of u. */
static double rayleigh_sample(double u)
{
    double half = 4 * u - 2, root = cbrt(half + sqrt(half * half + 1));
    return root - 1 / root;
}

static double henyey_value(double g, double cosine)
{
    double under = 1 + g * g - 2 * g * cosine;
    return under > 0 ? (1 - g * g) / (under * sqrt(under)) : 0;
}

static double henyey_sample(double g, double u)
{
    if (fabs(g) < ECCENTRICITY_LEAST)
        return 2 * u - 1;
    double part = (1 - g * g) / (1 - g + 2 * g * u);
    return fmin(1, fmax(-1, (1 + g * g - part * part) / (2 * g)));
}

double phase_value(PhaseKind kind, double eccentricity, double cosine)
{
    switch (kind) {
    case PHASE_MIE_HAZY:
        return mie_value(&hazy, cosine);
    case PHASE_MIE_MURKY:
        return mie_value(&murky, cosine);
    case PHASE_RAYLEIGH:
        return RAYLEIGH_SCALE * (1 + cosine * cosine);
    case PHASE_HENYEY_GREENSTEIN:
        return henyey_value(eccentricity, cosine);
    case PHASE_ISOTROPIC:
        return 1;
    case PHASE_NONE:
    case PHASE_KIND_COUNT:
        break;
    }
    return 0;
}

double phase_mean(PhaseKind kind)
{
    switch (kind) {
    case PHASE_MIE_HAZY:
        return hazy.scale * (1 + hazy.strength / (hazy.power + 1.0));
    case PHASE_MIE_MURKY:
        return murky.scale * (1 + murky.strength / (murky.power + 1.0));
    case PHASE_RAYLEIGH:
        return RAYLEIGH_SCALE * 4 / 3;
    default:
        return 1;
    }
}

double phase_sample(PhaseKind kind, double eccentricity, double u)
{
    switch (kind) {
    case PHASE_MIE_HAZY:
        return mie_sample(&hazy, u);
    case PHASE_MIE_MURKY:
        return mie_sample(&murky, u);
    case PHASE_RAYLEIGH:
        return rayleigh_sample(u);
    case PHASE_HENYEY_GREENSTEIN:
        return henyey_sample(eccentricity, u);
    default:
        return 2 * u - 1;
    }
}

/* --- density ------------------------------------------------------------------------------ */

bool medium_is_homogeneous(const Medium *medium)
{
    for (int i = 0; i < medium->density_count; i++)
        if (!medium->densities[i]->pigment->is_solid)
            return false;
    return true;
}

bool medium_is_seen(const Medium *medium)
{
    return !rgb_is_black(medium->absorption) || !rgb_is_black(medium->emission) ||
           !rgb_is_black(medium->scattering);
}

static Rgb density_at(const Density *density, V3 p)
{
    if (!density->map)
        return color5_rgb(pigment_at(density->pigment, p));
    const Pattern *pattern = &density->pigment->pattern;
    double v = pattern_value(pattern, p);
    V3 q = pattern_point(pattern, p);
    const DensityEntry *map = density->map;
    int last = density->map_count - 1, i = 0;
    if (v >= (double)map[last].key)
        return density_at(map[last].density, q);
    while (i < last && !((double)map[i].key >= v))
        i++;
    if (i == 0 || (double)map[i].key == v)
        return density_at(map[i].density, q);
    double low = (double)map[i - 1].key, high = (double)map[i].key;
    return rgb_lerp(density_at(map[i - 1].density, q), density_at(map[i].density, q),
                    (float)((v - low) / (high - low)));
}

Rgb medium_density(const Medium *medium, V3 p)
{
    Rgb product = RGB_WHITE;
    for (int i = 0; i < medium->density_count; i++)
        product = rgb_mul(product, density_at(medium->densities[i], p));
    return rgb(fmaxf(product.r, 0), fmaxf(product.g, 0), fmaxf(product.b, 0));
}

/* --- transforms --------------------------------------------------------------------------- */

const Density *density_transform(Arena *arena, const Density *density, const Xform *xform)
{
    const Pigment *pigment = pigment_transform(arena, density->pigment, xform);
    if (!pigment || pigment == density->pigment)
        return pigment ? density : NULL;
    Density *moved = arena_copy(arena, density, sizeof *density);
    if (moved)
        moved->pigment = pigment;
    return moved;
}

const Medium *medium_transform(Arena *arena, const Medium *medium, const Xform *xform)
{
    if (medium_is_homogeneous(medium) || xform_is_identity(xform))
        return medium;
    size_t count = (size_t)medium->density_count;
    Medium *moved = arena_copy(arena, medium, sizeof *medium);
    const Density **densities = ARENA_ARRAY(arena, const Density *, count);
    if (!moved || !densities)
        return NULL;
    for (size_t i = 0; i < count; i++) {
        densities[i] = density_transform(arena, medium->densities[i], xform);
        if (!densities[i])
            return NULL;
    }
    moved->densities = densities;
    return moved;
}

const Interior *interior_transform(Arena *arena, const Interior *interior, const Xform *xform)
{
    bool is_moving = false;
    for (int i = 0; i < interior->media_count; i++)
        is_moving |= !medium_is_homogeneous(interior->media[i]);
    if (!is_moving || xform_is_identity(xform))
        return interior;
    size_t count = (size_t)interior->media_count;
    Interior *moved = arena_copy(arena, interior, sizeof *interior);
    const Medium **media = ARENA_ARRAY(arena, const Medium *, count);
    if (!moved || !media)
        return NULL;
    for (size_t i = 0; i < count; i++) {
        media[i] = medium_transform(arena, interior->media[i], xform);
        if (!media[i])
            return NULL;
    }
    moved->media = media;
    return moved;
}

/* --- fog ---------------------------------------------------------------------------------- */

/* The integral of the density 1/(1+h^2) above the ground, 1 below, over heights. */
static double ground_integral(double height)
{
    return height > 0 ? atan(height) : height;
}

/* Mean density between two heights, in altitudes above the offset. */
static double ground_density(double start, double end)
{
    double rise = end - start, low = fmax(fmin(start, end), 0);
    /* Where the heights are nearly the same the difference of integrals has no digits. */
    if (fabs(rise) < 1e-6 * (1 + fabs(start)))
        return 1 / (1 + low * low);
    if (!isfinite(end))
        return end > 0 ? 0 : 1;
    return (ground_integral(end) - ground_integral(start)) / rise;
}

double fog_clearness(const Fog *fog, V3 from, V3 to, double distance)
{
    if (!fog->is_ground)
        return exp(-distance / fog->distance);
    double start = (v3_dot(from, fog->up) - fog->offset) / fog->altitude;
    if (isfinite(distance)) {
        double end = (v3_dot(to, fog->up) - fog->offset) / fog->altitude;
        return exp(-distance * ground_density(start, end) / fog->distance);
    }
    /* Upwards the thinning fog has a finite thickness; elsewhere it has no end. */
    double climb = v3_dot(to, fog->up) / fog->altitude;
    if (!(climb > 0))
        return 0;
    double thickness = (PMS_PI / 2 - ground_integral(start)) / climb;
    return exp(-thickness / fog->distance);
}
