/* The look of a surface at a hit: layers, reflection, and where transmitted light goes.
 *
 * The order of the steps is the language's: layers from the top, each seen through the filter
 * of those above, until too little passes; then one transmitted ray, bent at the top layer's
 * normal; reflections are not filtered by the layers above.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/trace_int.h"

#include "math/eps.h"

/* What the steps share. */
typedef struct Sampling {
    const Tracer *tracer;
    const Ray *ray;
    const Hit *hit;
    const Interiors *interiors;
    SurfaceSample *out;
    V3 n;              /* shading normal, on the side of ng */
    double cosine;     /* of n and wo */
    InteriorStep step; /* set if has_step */
    bool has_step;
    V3 mirror; /* direction of reflection, set if has_mirror */
    bool has_mirror;
} Sampling;

static const InteriorStep *step_of(Sampling *s)
{
    if (!s->has_step) {
        s->step = interiors_step(s->tracer, s->hit, s->interiors, NULL);
        s->has_step = true;
    }
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
    Rgb r = reflectivity(s, finish, layer->color);
    if (finish->conserves_energy)
        *filter = rgb_mul(*filter, rgb(1 - fminf(1, r.r), 1 - fminf(1, r.g), 1 - fminf(1, r.b)));
    if (rgb_is_black(r))
        return;
    layer->reflect_dir = mirror_of(s);
    if (finish->irid != 0)
        r = rgb_mul(r, irid_factor(finish, s->out->settings->irid_wavelength,
                                   v3_dot(s->n, layer->reflect_dir), s->cosine));
    layer->reflect = rgb_scale(r, weight);
}

/* Append the layers of one texture; returns what passes them. */
static Rgb sample_texture(Sampling *s, const Texture *texture, float weight)
{
    SurfaceSample *out = s->out;
    float bailout = (float)out->settings->adc_bailout;
    Rgb filter = RGB_WHITE;
    for (int i = texture->layer_count - 1; i >= 0 && out->layer_count < SURFACE_LAYERS_MAX; i--) {
        if (!(fabsf(rgb_grey(filter)) > bailout))
            break;
        SurfaceLayer *layer = &out->layers[out->layer_count++];
        Color5 color = pigment_at(texture->layers[i].pigment, out->at.p);
        layer->color = color5_rgb(color);
        layer->opacity = 1 - color.filter - color.transmit;
        layer->above = rgb_scale(filter, weight);
        layer->finish = texture->layers[i].finish;
        layer->n = s->n;
        filter = rgb_mul(filter, color5_through(color));
        sample_reflection(s, layer, weight, &filter);
    }
    return rgb_scale(filter, weight);
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
    out->inside_after = *s->interiors;
    /* The reflection at this normal is this one: it counts once. */
    for (int i = 0; i < out->layer_count; i++)
        out->layers[i].reflect = RGB_BLACK;
}

static void sample_transmission(Sampling *s)
{
    SurfaceSample *out = s->out;
    V3 d = s->ray->d;
    s->step = interiors_step(s->tracer, s->hit, s->interiors, &out->inside_after);
    double ratio = s->step.ior_from / s->step.ior_to;
    out->is_total_reflection = false;
    out->is_straight = fabs(ratio - 1) < EPS_LANGUAGE;
    if (out->is_straight) {
        out->transmit_dir = d;
    } else {
        /* An interpolated normal may send the ray back above the true surface: then the true
         * normal decides. */
        V3 n = s->cosine > 0 ? s->n : out->ng;
        bool is_through = refract(d, n, ratio, &out->transmit_dir);
        if (is_through && !(v3_dot(out->transmit_dir, out->ng) < 0))
            is_through = refract(d, out->ng, ratio, &out->transmit_dir);
        if (!is_through)
            set_total_reflection(s);
    }
    out->through = out->is_total_reflection ? RGB_WHITE : out->filter;
    if (s->step.is_leaving)
        out->through =
            rgb_mul(out->through, interior_fade(s->hit->surface->interior, s->hit->t, false));
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

void surface_sample(TraceThread *thread, const Ray *ray, const Hit *hit, const Interiors *interiors,
                    SurfaceSample *out)
{
    const Tracer *tracer = thread->tracer;
    bool is_inside = v3_dot(hit->point.ng, ray->d) > 0;
    out->at = hit->point;
    out->wo = v3_neg(ray->d);
    out->ng = is_inside ? v3_neg(hit->point.ng) : hit->point.ng;
    out->surface = hit->surface;
    out->is_entering = hit->is_entering;
    out->settings = &tracer->scene->settings;
    out->layer_count = 0;

    Sampling s = {.tracer = tracer, .ray = ray, .hit = hit, .interiors = interiors, .out = out};
    s.n = shading_normal(hit->point.ns, out->ng, out->wo);
    s.cosine = fmin(1, fmax(0, v3_dot(s.n, out->wo)));

    TextureChoice choice;
    texture_choose(hit->surface, hit->leaf, hit->part, hit->u, hit->v, is_inside, &choice);
    out->filter = RGB_BLACK;
    for (int i = 0; i < choice.count; i++)
        out->filter = rgb_add(out->filter, sample_texture(&s, choice.texture[i], choice.weight[i]));
    out->has_transmission = fabsf(rgb_grey(out->filter)) > (float)out->settings->adc_bailout;
    if (out->has_transmission)
        sample_transmission(&s);
}
