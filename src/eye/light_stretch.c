/* Where along a ray a light can shine.  SPDX-License-Identifier: Apache-2.0 */
#include "eye/air_int.h"

#include "math/roots.h"

/* The cone of a spot light: cosine to its axis above that of the falloff. */
static bool is_in_cone(const Light *light, V3 p)
{
    V3 from = v3_sub(p, light->location);
    return v3_dot(from, light->direction) > light->cos_falloff * v3_len(from);
}

static bool is_in_beam(const Light *light, V3 p)
{
    V3 from = v3_sub(p, light->location);
    double along = v3_dot(from, light->direction);
    return along > 0 && v3_len2(from) - along * along < light->falloff * light->falloff;
}

static bool is_lit(const Light *light, V3 p)
{
    return light->kind == LIGHT_SPOT ? is_in_cone(light, p) : is_in_beam(light, p);
}

/* The places where a line may enter or leave: roots of a t^2 + 2 b t + c. */
static int solve(double a, double b, double c, double t[2])
{
    if (a == 0) {
        t[0] = b != 0 ? -c / (2 * b) : 0;
        return b != 0;
    }
    double under = b * b - a * c;
    if (!(under >= 0))
        return 0;
    double q = -(b + copysign(sqrt(under), b));
    t[0] = q / a;
    t[1] = q != 0 ? c / q : 0;
    return 2;
}

static int light_crossings(const Light *light, const Ray *ray, double t[3])
{
    V3 from = v3_sub(ray->o, light->location);
    double along = v3_dot(from, light->direction), step = v3_dot(ray->d, light->direction);
    double od = v3_dot(from, ray->d), oo = v3_len2(from);
    int count;
    if (light->kind == LIGHT_SPOT) {
        double c2 = light->cos_falloff * light->cos_falloff;
        count = solve(step * step - c2, along * step - c2 * od, along * along - c2 * oo, t);
    } else {
        double r2 = light->falloff * light->falloff;
        count = solve(1 - step * step, od - along * step, oo - along * along - r2, t);
    }
    if (step != 0)
        t[count++] = -along / step;
    return count;
}

bool light_stretch(const Light *light, const Ray *ray, double *begin, double *end)
{
    bool is_cone = light->kind == LIGHT_SPOT && light->falloff < PMS_PI / 2;
    if (!is_cone && light->kind != LIGHT_CYLINDER)
        return *end > *begin;
    double t[5] = {*begin, *end};
    int count = 2 + light_crossings(light, ray, t + 2);
    for (int i = 1; i < count; i++) {
        double value = fmin(*end, fmax(*begin, t[i]));
        int j = i;
        for (; j > 0 && t[j - 1] > value; j--)
            t[j] = t[j - 1];
        t[j] = value;
    }
    /* What is lit is convex: one stretch. */
    double low = INFINITY, high = -INFINITY;
    for (int i = 0; i + 1 < count; i++)
        if (t[i + 1] > t[i] && is_lit(light, ray_at(ray, 0.5 * (t[i] + t[i + 1])))) {
            low = fmin(low, t[i]);
            high = fmax(high, t[i + 1]);
        }
    *begin = low;
    *end = high;
    return high > low;
}
