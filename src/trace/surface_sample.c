/* The look of a surface at a hit: layers, reflection, and where transmitted light goes.
 *
 * The order of the steps is the language's: layers from the top, each seen through the filter
 * of those above, until too little passes; then one transmitted ray, bent at the top layer's
 * normal; reflections are not filtered by the layers above.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/trace_int.h"

#include "math/eps.h"
#include "math/spectrum.h"

/* The means over all wavelengths are taken of so many at most. */
enum { MEAN_BANDS_MAX = 32 };

/* What the steps share. */
typedef struct Sampling {
    const Tracer *tracer;
    const Ray *ray;
    const Hit *hit;
    const Interiors *interiors;
    SurfaceSample *out;
    V3 n;              /* shading normal, on the side of ng */
    double cosine;     /* of n and wo */
    InteriorStep step; /* set, with out->inside_after, if has_step */
    bool has_step;
    V3 mirror; /* direction of reflection, set if has_mirror */
    bool has_mirror;
    bool is_interface_in; /* a surface above reflects as the interface does: tied ones are it too */
} Sampling;

/* Pass the hit's surface and those tied to it. */
static const InteriorStep *step_of(Sampling *s)
{
    if (s->has_step)
        return &s->step;
    const Hit *hit = s->hit;
    const Scene *scene = s->tracer->scene;
    Passage passages[PASSAGES_MAX] = {{(uint32_t)(hit->object - scene->objects),
                                       hit->surface->interior, hit->is_entering, hit->is_wall}};
    for (int i = 0; i < hit->tie_count; i++) {
        const HitTie *tie = &hit->ties[i];
        const Crossing *crossing = &tie->crossing;
        passages[i + 1] = (Passage){tie->object, scene->surfaces[crossing->leaf->surface].interior,
                                    crossing_is_entering(crossing, tie->point.ng, s->ray->d),
                                    crossing->leaf_change == 0};
    }
    s->step = interiors_pass(s->tracer, passages, 1 + hit->tie_count, s->interiors,
                             &s->out->inside_after);
    s->has_step = true;
    return &s->step;
}

/* The mirror direction at the shading normal, kept above the geometric surface. */
static V3 mirror_of(Sampling *s)
{
    if (s->has_mirror)
        return s->mirror;
    V3 d = s->ray->d, ng = s->out->ng;
    V3 m = v3_reflect(d, s->n);
    double above = v3_dot(m, ng);
    if (above < 0)
        m = v3_dot(m, s->n) < 0 ? v3_reflect(d, ng) : v3_mad(m, -2 * above, ng);
    s->mirror = v3_unit(m);
    s->has_mirror = true;
    return s->mirror;
}

/* Fresnel reflectance of unpolarised light; ior is that of the far side over the near. */
static double fresnel(double cosine, double ior)
{
    double g2 = ior * ior + cosine * cosine - 1;
    if (ior == 1)
        return 0;
    if (!(g2 > 0))
        return 1;
    double g = sqrt(g2), a = (g - cosine) / (g + cosine);
    double b = (cosine * (g + cosine) - 1) / (cosine * (g - cosine) + 1);
    return 0.5 * a * a * (1 + b * b);
}

static bool is_same(Rgb a, Rgb b)
{
    return a.r == b.r && a.g == b.g && a.b == b.b;
}

/* The reflectivity without iridescence. */
static Rgb reflectivity(Sampling *s, const Finish *finish, Rgb color)
{
    Rgb low = finish->reflection_min, high = finish->reflection_max, out = high;
    if (finish->is_fresnel) {
        const InteriorStep *step = step_of(s);
        out = rgb_lerp(low, high, (float)fresnel(s->cosine, step->ior_to / step->ior_from));
    } else if (!is_same(low, high)) {
        double k = 1 - s->cosine;
        if (finish->reflection_falloff != 1)
            k = pow(k, (double)finish->reflection_falloff);
        out = rgb_lerp(low, high, (float)k);
    }
    if (finish->reflection_metallic != 0)
        out = rgb_mul(out, metallic_tint(finish->reflection_metallic, s->cosine, color));
    return out;
}

static void sample_reflection(Sampling *s, SurfaceLayer *layer, float weight, Rgb *filter)
{
    const Finish *finish = layer->finish;
    layer->reflect = RGB_BLACK;
    if (rgb_is_black(finish->reflection_max) && rgb_is_black(finish->reflection_min))
        return;
    if (s->is_interface_in && finish->is_fresnel)
        return;
    Rgb r = reflectivity(s, finish, layer->color);
    if (finish->conserves_energy)
        *filter = rgb_mul(*filter, rgb(1 - fminf(1, r.r), 1 - fminf(1, r.g), 1 - fminf(1, r.b)));
    if (rgb_is_black(r) || plan_forbids(s->tracer->plan, FEATURE_REFLECTION))
        return;
    layer->reflect_dir = mirror_of(s);
    if (finish->irid != 0)
        r = rgb_mul(r, irid_factor(finish, s->out->settings->irid_wavelength,
                                   v3_dot(s->n, layer->reflect_dir), s->cosine));
    layer->reflect = rgb_scale(r, weight);
}

/* How much of a layer's own light is seen.  Before 3.7 the language weighed filter with the
 * strongest channel. */
static float opacity_of(const SceneSettings *settings, Color5 c)
{
    float filter = settings->version < 3.7 ? c.filter * rgb_max(color5_rgb(c)) : c.filter;
    return 1 - filter - c.transmit;
}

/* Append the layers of texture k of a choice, seen through `above`; returns what passes them too.
 */
static Rgb sample_texture(Sampling *s, const TextureChoice *choice, int k, Rgb above)
{
    const Texture *texture = choice->texture[k];
    float weight = choice->weight[k];
    SurfaceSample *out = s->out;
    float bailout = (float)out->settings->adc_bailout;
    Rgb filter = above;
    for (int i = texture->layer_count - 1; i >= 0 && out->layer_count < SURFACE_LAYERS_MAX; i--) {
        if (!(fabsf(rgb_grey(filter)) > bailout))
            break;
        SurfaceLayer *layer = &out->layers[out->layer_count++];
        Color5 color = pigment_at_uv(texture->layers[i].pigment, out->at.p, choice->uv);
        layer->color = color5_rgb(color);
        layer->opacity = opacity_of(out->settings, color);
        layer->above = rgb_scale(filter, weight);
        layer->finish = texture->layers[i].finish;
        layer->n = s->n;
        filter = rgb_mul(filter, color5_through(color));
        sample_reflection(s, layer, weight, &filter);
    }
    return rgb_scale(filter, weight);
}

/* The interpolated normal on the side of ng.  Near a silhouette it may look away from the
 * viewer: then it is bent until it just does not, so that no dark seam appears. */
static V3 shading_normal(V3 ns, V3 ng, V3 wo)
{
    V3 n = v3_dot(ns, ng) < 0 ? v3_neg(ns) : ns;
    double away = v3_dot(n, wo);
    if (away < 0)
        n = v3_unit(v3_mad(n, -away, wo));
    return v3_len2(n) > 0 ? n : ng;
}

/* Take the normals of a surface for the steps that follow; returns whether it is met from its
 * inside. */
static bool set_normals(Sampling *s, const ShapePoint *point)
{
    bool is_inside = v3_dot(point->ng, s->ray->d) > 0;
    s->n = shading_normal(point->ns, is_inside ? v3_neg(point->ng) : point->ng, s->out->wo);
    double cosine = v3_dot(s->n, s->out->wo);
    s->cosine = cosine > 1 ? 1 : cosine > 0 ? cosine : 0;
    s->has_mirror = false;
    return is_inside;
}

/* Append the layers of one surface below those there are. */
static void sample_surface(Sampling *s, const TextureChoice *choice)
{
    Rgb sum = RGB_BLACK, above = s->out->filter;
    for (int i = 0; i < choice->count; i++)
        sum = rgb_add(sum, sample_texture(s, choice, i, above));
    s->out->filter = sum;
}

/* Does a layer so far reflect by Fresnel's law? */
static bool has_fresnel(const SurfaceSample *s)
{
    for (int i = 0; i < s->layer_count; i++) {
        const Finish *finish = s->layers[i].finish;
        if (finish->is_fresnel && !rgb_is_black(finish->reflection_max))
            return true;
    }
    return false;
}

/* Append the surfaces tied to the hit, as far as the ones above let them be seen.  Together they
 * are one interface, from what the ray is in before all of them to what it is in behind: what
 * Fresnel's law says of it counts once. */
static void sample_ties(Sampling *s)
{
    const Hit *hit = s->hit;
    for (int i = 0; i < hit->tie_count && !rgb_is_black(s->out->filter); i++) {
        const Crossing *crossing = &hit->ties[i].crossing;
        const Surface *surface = &s->tracer->scene->surfaces[crossing->leaf->surface];
        TextureChoice choice;
        bool is_inside = set_normals(s, &hit->ties[i].point);
        s->is_interface_in = has_fresnel(s->out);
        texture_choose(surface, crossing->leaf, crossing->part, crossing->u, crossing->v,
                       hit->ties[i].point.p, is_inside, &choice);
        sample_surface(s, &choice);
    }
    set_normals(s, &hit->point);
}

/* Bend d at the normal n, which faces it; returns false for total reflection. */
static bool refract(V3 d, V3 n, double ratio, V3 *out)
{
    double cosine = fmin(1, -v3_dot(d, n));
    double rest = 1 + ratio * ratio * (cosine * cosine - 1);
    if (rest < 0)
        return false;
    *out = v3_unit(v3_mad(v3_scale(d, ratio), ratio * cosine - sqrt(rest), n));
    return true;
}

static void set_total_reflection(Sampling *s)
{
    SurfaceSample *out = s->out;
    out->is_total_reflection = true;
    out->transmit_dir = mirror_of(s);
    interiors_copy(&out->inside_after, s->interiors);
    /* The reflection at this normal is this one: it counts once. */
    for (int i = 0; i < out->layer_count; i++)
        out->layers[i].reflect = RGB_BLACK;
}

static void sample_transmission(Sampling *s)
{
    SurfaceSample *out = s->out;
    V3 d = s->ray->d;
    const InteriorStep *step = step_of(s);
    double ratio = step->ior_from / step->ior_to;
    out->ior_ratio = ratio;
    out->is_straight = fabs(ratio - 1) < EPS_LANGUAGE;
    if (out->is_straight) {
        out->transmit_dir = d;
    } else {
        /* An interpolated normal may send the ray back above the true surface: then the true
         * normal decides. */
        bool is_through = refract(d, s->n, ratio, &out->transmit_dir);
        if (is_through && !(v3_dot(out->transmit_dir, out->ng) < 0))
            is_through = refract(d, out->ng, ratio, &out->transmit_dir);
        if (!is_through)
            set_total_reflection(s);
    }
    out->through = out->is_total_reflection ? RGB_WHITE : out->filter;
}

/* Add what a wavelength's sample sends on, of which there is `color`, to the means. */
static void add_wave(const SurfaceSample *one, Rgb color, SurfaceSample *out)
{
    if (one->has_transmission) {
        out->has_transmission = true;
        out->filter = rgb_add(out->filter, rgb_mul(color, one->through));
    }
    for (int i = 0; i < out->layer_count && i < one->layer_count; i++) {
        const SurfaceLayer *layer = &one->layers[i];
        if (rgb_is_black(layer->reflect))
            continue;
        out->layers[i].reflect = rgb_add(out->layers[i].reflect, rgb_mul(color, layer->reflect));
        out->layers[i].reflect_dir = layer->reflect_dir;
    }
}

/* Make of the sample of light as a whole the mean over its wavelengths. */
static void disperse(TraceThread *thread, Sampling *s)
{
    SurfaceSample *out = s->out;
    if (!s->hit->surface->may_transmit || !(s->has_step || out->has_transmission))
        return;
    int bands = step_of(s)->spectrum;
    if (bands == 0)
        return;
    if (!out->has_transmission) /* others may pass: let it be as complete as they are */
        sample_transmission(s);
    out->has_transmission = out->is_total_reflection = out->is_straight = false;
    out->filter = RGB_BLACK;
    for (int i = 0; i < out->layer_count; i++)
        out->layers[i].reflect = RGB_BLACK;
    Interiors interiors;
    interiors_copy(&interiors, s->interiors);
    int looked_at = bands < MEAN_BANDS_MAX ? bands : MEAN_BANDS_MAX;
    for (int i = 0; i < looked_at; i++) {
        SpectrumBand band = spectrum_band(i, looked_at);
        SurfaceSample one;
        interiors.wavelength = (float)band.wavelength;
        surface_sample(thread, s->ray, s->hit, &interiors, &one);
        add_wave(&one, band.color, out);
    }
    out->through = out->filter;
    out->spectrum = out->has_transmission ? bands : 0;
}

void surface_sample(TraceThread *thread, const Ray *ray, const Hit *hit, const Interiors *interiors,
                    SurfaceSample *out)
{
    const Tracer *tracer = thread->tracer;
    Sampling s;
    s.tracer = tracer;
    s.ray = ray;
    s.hit = hit;
    s.interiors = interiors;
    s.out = out;
    s.has_step = false;
    s.is_interface_in = false;
    out->at = hit->point;
    out->wo = v3_neg(ray->d);
    bool is_inside = set_normals(&s, &hit->point);
    out->ng = is_inside ? v3_neg(hit->point.ng) : hit->point.ng;
    out->surface = hit->surface;
    out->is_entering = hit->is_entering;
    out->settings = &tracer->scene->settings;
    out->layer_count = 0;
    out->filter = RGB_WHITE;
    out->is_total_reflection = false;

    TextureChoice choice;
    texture_choose(hit->surface, hit->leaf, hit->part, hit->u, hit->v, hit->point.p, is_inside,
                   &choice);
    sample_surface(&s, &choice);
    if (hit->tie_count > 0)
        sample_ties(&s);
    out->has_transmission = fabsf(rgb_grey(out->filter)) > (float)out->settings->adc_bailout &&
                            !plan_forbids(tracer->plan, FEATURE_REFRACTION);
    if (out->has_transmission) {
        sample_transmission(&s);
        thread->stats.count[STAT_INTERIORS_CUT] += out->inside_after.left_out > 0;
    }
    out->spectrum = 0;
    if (tracer->has_dispersion && interiors->wavelength == 0)
        disperse(thread, &s);
}

bool surface_sample_wave(TraceThread *thread, const Ray *ray, const Hit *hit, Interiors *interiors,
                         double u, SurfaceSample *out, Rgb *color)
{
    interiors->wavelength = (float)spectrum_choose(u, color);
    surface_sample(thread, ray, hit, interiors, out);
    return out->has_transmission;
}
