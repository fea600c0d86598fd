/* Beams.
 *
 * A point light covers its target's ball with a cone of directions, a parallel light with a disk
 * across its direction; where the light's own cone or beam is narrower, that is used.  Both are
 * images of the unit square that keep areas in proportion and cells compact (the concentric map).
 *
 * A light of the language gives L a(d) at distance d, whatever the shape of its beam; so a ray
 * that has gone D in all carries L a(D) D^2 per solid angle, and a parallel one L a(D) per area.
 * SPDX-License-Identifier: Apache-2.0 */
#include "photon/beam_int.h"

/* Cells in which the pilot found nothing are still tried, at this part of the density of the
 * best ones: a feature too small for the pilot is then bright grain, not missing light. */
#define CELL_FLOOR (1.0 / 32)

/* Cells beside one in which it found something count as this part of it: no more than a sliver
 * of the target can reach into them. */
#define NEIGHBOUR_PART 0.25f

/* Direction at a point of the square, within a cone around +z whose rim is at 1 - cosine =
 * `rim`.  Uniform in solid angle: 1 - z is as the square of the radius on the disk. */
static V3 cone_direction(V2 square, double rim)
{
    V2 p = warp_disk(square);
    double z = 1 - rim * (p.u * p.u + p.v * p.v);
    double k = sqrt(rim * (1 + z));
    return v3(k * p.u, k * p.v, z);
}

/* 1 - cosine of the cone that holds a ball seen from a distance; 2 from inside it.  Exact for
 * small balls. */
static double ball_rim(double radius, double distance)
{
    if (!(distance > radius))
        return 2;
    double sine = radius / distance, cosine = sqrt((1 - sine) * (1 + sine));
    return sine * sine / (1 + cosine);
}

static double spot_rim(const Light *light)
{
    double s = sin(light->falloff / 2);
    return 2 * s * s;
}

/* Place on an area light: over its parallelogram, or the ellipse within. */
static V3 area_place(const Beam *beam, V2 square)
{
    const Light *light = beam->light;
    const AreaLight *area = &light->area;
    if (!beam->is_spread)
        return light->location;
    V3 axis1 = area->axis1, axis2 = area->axis2;
    if (area->is_oriented) {
        V3 s, t;
        double length = v3_len(axis1);
        v3_frame(v3_unit(v3_sub(beam->center, light->location)), &s, &t);
        axis1 = v3_scale(s, length);
        axis2 = v3_scale(t, length);
    }
    double a = square.u - 0.5, b = square.v - 0.5;
    if (area->is_circular || area->is_oriented) {
        V2 disk = warp_disk(square);
        a = disk.u / 2;
        b = disk.v / 2;
    }
    a = area->size1 > 1 ? a : 0;
    b = area->size2 > 1 ? b : 0;
    return v3_mad(v3_mad(light->location, a, axis1), b, axis2);
}

static bool cone_ray(const Beam *beam, V2 square, BeamRay *out)
{
    const Light *light = beam->light;
    V3 to_ball = v3_sub(beam->center, out->location);
    double distance = v3_len(to_ball), rim = ball_rim(beam->radius, distance);
    V3 axis = distance > 0 ? v3_scale(to_ball, 1 / distance) : v3(0, 1, 0);
    if (light->kind == LIGHT_SPOT && spot_rim(light) < rim) {
        rim = spot_rim(light);
        axis = light->direction;
    }
    out->ray.o = out->location;
    out->ray.d = warp_to_frame(cone_direction(square, rim), axis);
    out->measure = 2 * PMS_PI * rim;
    return true;
}

/* Parallel rays start in the plane through the light: what is behind it is not lit by them. */
static bool disk_ray(const Beam *beam, V2 square, BeamRay *out)
{
    const Light *light = beam->light;
    V3 d = light->direction, to_ball = v3_sub(beam->center, light->location), s, t;
    double along = v3_dot(to_ball, d), radius = beam->radius;
    V3 middle = v3_mad(to_ball, -along, d);
    if (light->kind == LIGHT_CYLINDER && light->falloff < radius) {
        radius = light->falloff;
        middle = v3(0, 0, 0);
    }
    V2 p = warp_disk(square);
    v3_frame(d, &s, &t);
    V3 aside = v3_mad(v3_mad(middle, radius * p.u, s), radius * p.v, t);
    out->ray.o = v3_add(light->location, aside);
    out->ray.d = d;
    out->measure = PMS_PI * radius * radius;
    return along + beam->radius > 0;
}

bool beam_ray(const Beam *beam, V2 square, V2 area, BeamRay *out)
{
    const Light *light = beam->light;
    out->ray.tmin = 0;
    out->ray.tmax = INFINITY;
    out->location = light->location;
    if (light_is_parallel(light))
        return disk_ray(beam, square, out);
    out->location = area_place(beam, area);
    return cone_ray(beam, square, out);
}

bool beam_can_shine(const Beam *beam)
{
    const Light *light = beam->light;
    if (!light)
        return true;
    V3 to_ball = v3_sub(beam->center, light->location);
    double distance = v3_len(to_ball);
    if (light->kind == LIGHT_CYLINDER) {
        double along = v3_dot(to_ball, light->direction);
        double aside = v3_len(v3_mad(to_ball, -along, light->direction));
        return aside < beam->radius + light->falloff && along + beam->radius > 0;
    }
    if (light->is_parallel)
        return v3_dot(to_ball, light->direction) + beam->radius > 0;
    if (light->kind != LIGHT_SPOT || beam->is_spread || distance <= beam->radius)
        return true;
    double angle = acos(fmin(1, fmax(-1, v3_dot(to_ball, light->direction) / distance)));
    return angle < light->falloff + asin(beam->radius / distance) + 1e-6;
}

Rgb beam_flux(const Beam *beam, const BeamRay *ray, double length)
{
    if (!beam->light)
        return rgb_scale(ray->flux, (float)ray->measure);
    LightSample light = light_at(beam->light, ray->location, ray_at(&ray->ray, length));
    double spread = light_is_parallel(beam->light) ? 1 : length * length;
    return rgb_scale(light.color, (float)(ray->measure * spread));
}

/* The best of a cell and its neighbours: a pilot ray says as much about what is beside it. */
static float best_around(const float *found, int side, int x, int y)
{
    float best = 0;
    for (int j = y - 1; j <= y + 1; j++)
        for (int i = x - 1; i <= x + 1; i++)
            if (i >= 0 && j >= 0 && i < side && j < side)
                best = fmaxf(best, found[j * side + i]);
    return best;
}

void beam_set_cells(Beam *beam, const float *found)
{
    int side = beam->side, cells = side * side;
    float most = 0;
    for (int i = 0; i < cells; i++)
        most = fmaxf(most, found[i]);
    double sum = 0, total = 0;
    for (int pass = 0; pass < 2; pass++)
        for (int i = 0; i < cells; i++) {
            float around = best_around(found, side, i % side, i / side);
            float best = fmaxf(found[i], NEIGHBOUR_PART * around);
            double weight = most > 0 ? fmax(CELL_FLOOR, (double)(best / most)) : 1;
            if (pass == 0) {
                total += weight;
            } else {
                sum += weight;
                beam->cumulative[i] = (float)(sum / total);
            }
        }
    beam->cumulative[cells - 1] = 1;
    beam->filled = total / cells;
    for (int g = 0, cell = 0; g <= BEAM_GUIDES; g++) {
        while (cell < cells - 1 && beam->cumulative[cell] <= (float)g / BEAM_GUIDES)
            cell++;
        beam->guide[g] = (uint16_t)cell;
    }
}

V2 beam_warp(const Beam *beam, V2 uniform, double *density)
{
    int side = beam->side, guide = (int)(fmin(uniform.u, 1 - 0x1p-53) * BEAM_GUIDES);
    int low = beam->guide[guide], high = beam->guide[guide + 1];
    while (low < high) {
        int middle = (low + high) / 2;
        if (uniform.u < (double)beam->cumulative[middle])
            high = middle;
        else
            low = middle + 1;
    }
    double begin = low > 0 ? (double)beam->cumulative[low - 1] : 0;
    double width = (double)beam->cumulative[low] - begin;
    double within = fmin((uniform.u - begin) / width, 1 - 0x1p-53);
    *density = width * side * side;
    return (V2){(low % side + within) / side, (low / side + uniform.v) / side};
}
