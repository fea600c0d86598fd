/* Direct light on one layer: diffuse, highlights, metallic, iridescence.
 *
 * The formulas are the language's finish arithmetic: a white surface of diffuse 1 under light
 * of colour 1 has radiance 1.  SPDX-License-Identifier: Apache-2.0 */
#include "trace/trace_int.h"

#include "math/eps.h"

#include <string.h>

/* The language's Fresnel-like curve over the angle, 0 at right angles, 1 at grazing. */
#define METAL_SCALE 0.014567225
#define METAL_POLE 1.12
#define METAL_SHIFT 0.011612903

Rgb metallic_tint(float metallic, double cosine, Rgb color)
{
    double x = acos(fmin(fabs(cosine), 1)) / (PMS_PI / 2) - METAL_POLE;
    double fresnel = fmin(1, fmax(0, METAL_SCALE / (x * x) - METAL_SHIFT));
    float k = metallic * (float)(1 - fresnel);
    return rgb(1 + k * (color.r - 1), 1 + k * (color.g - 1), 1 + k * (color.b - 1));
}

Rgb irid_factor(const Finish *finish, Rgb wavelength, double cos_light, double cos_view)
{
    double path = 2 * PMS_PI * (double)finish->irid_thickness * (fabs(cos_light) + fabs(cos_view));
    double amount = (double)finish->irid;
    return rgb((float)(1 + amount * cos(path / (double)wavelength.r)),
               (float)(1 + amount * cos(path / (double)wavelength.g)),
               (float)(1 + amount * cos(path / (double)wavelength.b)));
}

/* A number in [0,1) that depends on the point and the light's direction only. */
static double grain(V3 p, V3 to_light)
{
    uint64_t bits[6], key = 0;
    memcpy(bits, &p, sizeof p);
    memcpy(bits + 3, &to_light, sizeof to_light);
    for (int i = 0; i < 6; i++)
        key = rng_mix(key ^ bits[i]) + 0x9e3779b97f4a7c15u;
    return (double)(rng_mix(key) >> 11) * 0x1p-53;
}

/* Phong and specular together, as a factor of the light before the metallic tint. */
static double highlight(const Finish *finish, V3 n, V3 wo, V3 to_light)
{
    double sum = 0;
    if (finish->phong > 0) {
        V3 mirror = v3_sub(v3_scale(n, 2 * v3_dot(n, wo)), wo);
        double k = v3_dot(mirror, to_light);
        if (k > 0)
            sum += (double)finish->phong * pow(k, (double)finish->phong_size);
    }
    if (finish->specular > 0) {
        V3 half = v3_add(wo, to_light);
        double k = v3_dot(n, half);
        if (k > 0)
            sum += (double)finish->specular *
                   pow(fmin(1, k / v3_len(half)), 1 / (double)finish->roughness);
    }
    return sum;
}

Rgb layer_direct(const SurfaceLayer *layer, const SurfaceSample *s, V3 to_light,
                 bool has_highlights, bool is_double_illuminated)
{
    const Finish *finish = layer->finish;
    double cosine = v3_dot(layer->n, to_light), diffuse = (double)finish->diffuse;
    if (cosine < EPS_LANGUAGE && !is_double_illuminated) {
        diffuse = (double)finish->diffuse_back;
        if (diffuse == 0)
            return RGB_BLACK;
        has_highlights = false;
    }
    double size = fabs(cosine);
    double intensity = diffuse * (double)layer->opacity *
                       (finish->brilliance == 1 ? size : pow(size, (double)finish->brilliance));
    if (finish->crand != 0)
        intensity -= grain(s->at.p, to_light) * (double)finish->crand;
    Rgb sum = rgb_scale(layer->color, (float)intensity);
    if (has_highlights && (finish->phong > 0 || finish->specular > 0)) {
        float shine = (float)highlight(finish, layer->n, s->wo, to_light);
        Rgb tint = finish->metallic != 0 ? metallic_tint(finish->metallic, cosine, layer->color)
                                         : RGB_WHITE;
        sum = rgb_mad(sum, shine, tint);
    }
    if (finish->irid != 0)
        sum = rgb_mul(sum, irid_factor(finish, s->settings->irid_wavelength, cosine,
                                       v3_dot(layer->n, s->wo)));
    return rgb_mul(sum, layer->above);
}

static Rgb layer_diffuse(const SurfaceLayer *layer)
{
    return rgb_scale(rgb_mul(layer->above, layer->color), layer->opacity * layer->finish->diffuse);
}

Rgb surface_diffuse(const SurfaceSample *s)
{
    Rgb sum = RGB_BLACK;
    for (int i = 0; i < s->layer_count; i++)
        sum = rgb_add(sum, layer_diffuse(&s->layers[i]));
    return sum;
}

Rgb surface_diffuse_from(const SurfaceSample *s, V3 from)
{
    Rgb sum = RGB_BLACK;
    for (int i = 0; i < s->layer_count; i++) {
        const SurfaceLayer *layer = &s->layers[i];
        double brilliance = (double)layer->finish->brilliance, factor = 1;
        if (brilliance != 1)
            factor = pow(fmax(PHOTON_COSINE_MIN, v3_dot(layer->n, from)), brilliance - 1);
        sum = rgb_mad(sum, (float)factor, layer_diffuse(layer));
    }
    return sum;
}

bool surface_has_brilliance(const SurfaceSample *s)
{
    for (int i = 0; i < s->layer_count; i++)
        if (s->layers[i].finish->brilliance != 1)
            return true;
    return false;
}

Rgb surface_diffuse_even(const SurfaceSample *s)
{
    Rgb sum = RGB_BLACK;
    for (int i = 0; i < s->layer_count; i++) {
        float brilliance = s->layers[i].finish->brilliance;
        sum = rgb_mad(sum, 2 / (brilliance + 1), layer_diffuse(&s->layers[i]));
    }
    return sum;
}

Rgb surface_diffuse_back(const SurfaceSample *s)
{
    Rgb sum = RGB_BLACK;
    bool is_double = s->surface->is_double_illuminated;
    for (int i = 0; i < s->layer_count; i++) {
        const SurfaceLayer *layer = &s->layers[i];
        float diffuse = is_double ? layer->finish->diffuse : layer->finish->diffuse_back;
        sum =
            rgb_add(sum, rgb_scale(rgb_mul(layer->above, layer->color), layer->opacity * diffuse));
    }
    return sum;
}
