/* What shines without a light source: surfaces by themselves, and the sky.
 * SPDX-License-Identifier: Apache-2.0 */
#include "trace/trace_int.h"

Rgb surface_glow(const Tracer *tracer, const SurfaceSample *s)
{
    const Plan *plan = tracer->plan;
    Rgb sum = RGB_BLACK;
    for (int i = 0; i < s->layer_count; i++) {
        const SurfaceLayer *layer = &s->layers[i];
        Rgb glow = layer->finish->emission;
        if (plan->is_unlit)
            glow = RGB_WHITE;
        else if (plan->has_ambient)
            glow = rgb_add(glow, rgb_mul(layer->finish->ambient, s->settings->ambient_light));
        Rgb seen = rgb_scale(rgb_mul(layer->above, layer->color), layer->opacity);
        sum = rgb_add(sum, rgb_mul(seen, glow));
    }
    return sum;
}

/* Add one layer of sky in front of what is behind it; `seen` is what passes the layers before. */
static void sky_layer(const Sky *sky, const Pigment *pigment, V3 direction, Rgb *seen, Rgb *sum)
{
    Color5 c = pigment_at(pigment, direction);
    Rgb glow = rgb_mul(color5_rgb(c), sky->emission);
    *sum = rgb_mad(*sum, 1 - c.filter - c.transmit, rgb_mul(glow, *seen));
    *seen = rgb_mul(*seen, color5_through(c));
}

Rgb sky_glow(const Tracer *tracer, V3 direction, Rgb *seen)
{
    Rgb sum = RGB_BLACK;
    *seen = RGB_WHITE;
    if (plan_has(tracer->plan, FEATURE_SKY)) {
        const Sky *sky = &tracer->scene->sky;
        for (int i = sky->pigment_count - 1; i >= 0; i--)
            sky_layer(sky, sky->pigments[i], direction, seen, &sum);
    }
    return sum;
}

Rgb sky_light_from(const Tracer *tracer, V3 direction)
{
    Rgb seen, sum = sky_glow(tracer, direction, &seen);
    Color5 c = tracer->scene->background.color;
    return rgb_add(sum, rgb_mul(rgb_scale(color5_rgb(c), 1 - c.transmit), seen));
}
