/* Light from surfaces that glow, and from the sky.
 *
 * Straight lines spread evenly through a convex body meet every piece of surface inside it with
 * the cosine of the angle, which is how a surface sends equal radiance in all directions; so a
 * photon starts where such a line leaves the surface, whatever the shape.  The lines through a box
 * are those that enter it anywhere with directions spread by the cosine; there are as many as the
 * box has surface, and in the language's unit (radiance 1 all around gives irradiance 1) a line of
 * M carries radiance times that surface / M.  SPDX-License-Identifier: Apache-2.0 */
#include "photon/beam_int.h"

/* Surfaces of one object along one line; photons start at the first of so many. */
enum { LINE_SURFACES_MAX = 256 };

double box_area(Bound box)
{
    V3 d = v3_sub(box.hi, box.lo);
    return 2 * (d.x * d.y + d.y * d.z + d.z * d.x);
}

/* The point of a box's surface at `u`: the faces stand in a row, each as wide as its part of the
 * area.  *inward is set to the face's normal. */
static V3 box_point(Bound box, V2 u, V3 *inward)
{
    V3 d = v3_sub(box.hi, box.lo);
    double faces[3] = {d.y * d.z, d.z * d.x, d.x * d.y};
    double at = u.u * 2 * (faces[0] + faces[1] + faces[2]);
    int face = 0;
    while (face < 5 && at >= faces[face / 2])
        at -= faces[face++ / 2];
    double a = faces[face / 2] > 0 ? fmin(1, at / faces[face / 2]) : 0.5, b = u.v;
    bool is_high = (face & 1) != 0;
    double side = is_high ? -1 : 1;
    switch (face / 2) {
    case 0:
        *inward = v3(side, 0, 0);
        return v3(is_high ? box.hi.x : box.lo.x, box.lo.y + a * d.y, box.lo.z + b * d.z);
    case 1:
        *inward = v3(0, side, 0);
        return v3(box.lo.x + b * d.x, is_high ? box.hi.y : box.lo.y, box.lo.z + a * d.z);
    default:
        *inward = v3(0, 0, side);
        return v3(box.lo.x + a * d.x, box.lo.y + b * d.y, is_high ? box.hi.z : box.lo.z);
    }
}

/* Sky light comes from where the way back meets nothing. */
static bool sky_ray(TraceThread *thread, const Beam *beam, V3 o, V3 d, BeamRay *out)
{
    Hit hit;
    Ray back = {o, v3_neg(d), 0, INFINITY};
    if (beam->is_endless && trace_closest(thread, &back, RAY_LIGHT, &hit))
        return false;
    out->ray = (Ray){o, d, 0, INFINITY};
    out->flux = sky_light_from(thread->tracer, v3_neg(d));
    return true;
}

/* A line through the object: looks at its surfaces from where the photon will go, and chooses
 * one by how much it glows. */
static bool surface_ray(TraceThread *thread, const Beam *beam, V3 o, V3 d, double choice,
                        BeamRay *out)
{
    const Interiors nowhere = {.count = 0};
    double far = 2 * v3_dist(beam->box.lo, beam->box.hi), sum = 0;
    Ray look = {v3_mad(o, far, d), v3_neg(d), 0, INFINITY};
    uint32_t object = (uint32_t)(beam->emitter - tracer_scene(thread->tracer)->objects);
    for (int i = 0; i < LINE_SURFACES_MAX; i++) {
        Hit hit;
        SurfaceSample s;
        if (!trace_object(thread, &look, object, &hit))
            break;
        look.tmin = hit.t + 2 * hit.point.p_error;
        if (beam->is_outside_only && !hit.is_entering)
            continue;
        surface_sample(thread, &look, &hit, &nowhere, &s);
        Rgb glow = surface_glow(thread->tracer, &s);
        double bright = (double)rgb_sum(glow);
        if (hit.surface->no_radiosity || !(bright > 0))
            continue;
        sum += bright;
        if (choice * sum >= bright) { /* the one chosen before stays */
            choice = (choice * sum - bright) / (sum - bright);
            continue;
        }
        choice = choice * sum / bright;
        out->ray = trace_ray_from(&s.at, d);
        out->flux = rgb_scale(glow, (float)(1 / bright));
    }
    arena_reset(thread->scratch);
    out->flux = rgb_scale(out->flux, (float)sum);
    return sum > 0;
}

bool emitter_ray(TraceThread *thread, const Beam *beam, V2 square, V2 direction, double choice,
                 BeamRay *out)
{
    V3 inward, o = box_point(beam->box, square, &inward);
    V3 d = warp_to_frame(warp_cosine(direction), inward);
    *out = (BeamRay){.measure = box_area(beam->box) * beam->brightness};
    return beam->emitter ? surface_ray(thread, beam, o, d, choice, out)
                         : sky_ray(thread, beam, o, d, out);
}
