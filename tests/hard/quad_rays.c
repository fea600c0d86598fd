/* Random and hard rays.  The hard ones start from what random ones meet: a tangent there, a ray
 * from there; or they are the last ray before something else is met.
 * SPDX-License-Identifier: Apache-2.0 */
#include "quad_rays.h"

#include "math/bound.h"
#include "math/sample.h"

static const World *const world = &double_world;

V3 random_unit(Rng *rng)
{
    V2 u = {rng_double(rng), 0};
    u.v = rng_double(rng);
    return v3_unit(warp_sphere(u));
}

static V3 random_point(RayMaker *m)
{
    double x = rng_double(&m->rng), y = rng_double(&m->rng), z = rng_double(&m->rng);
    V3 width = v3_sub(m->hi, m->lo);
    return v3_add(m->lo, v3(x * width.x, y * width.y, z * width.z));
}

/* Return a number between 10^-digits and 1, small ones as often as large ones. */
static double random_share(RayMaker *m, double digits)
{
    return pow(10, -digits * rng_double(&m->rng));
}

static Quad3 wide(V3 a)
{
    return (Quad3){a.x, a.y, a.z};
}

static V3 narrow(Quad3 a)
{
    return v3((double)a.x, (double)a.y, (double)a.z);
}

static bool first_meeting(RayMaker *m, TestRay ray, Meeting *out)
{
    return world->closest(m->model, wide(ray.o), wide(ray.d), out);
}

/* --- random ones ---------------------------------------------------------------------------- */

static TestRay outer_ray(RayMaker *m)
{
    V3 at = random_point(m), d = random_unit(&m->rng);
    return (TestRay){v3_mad(at, -3 * m->size, d), d};
}

static TestRay inner_ray(RayMaker *m)
{
    V3 at = random_point(m);
    return (TestRay){at, random_unit(&m->rng)};
}

/* --- hard ones ------------------------------------------------------------------------------ */

/* Find some point of the surface. */
static bool find_surface(RayMaker *m, Meeting *out)
{
    for (int i = 0; i < 8; i++)
        if (first_meeting(m, outer_ray(m), out))
            return true;
    return false;
}

static TestRay tangent_at(RayMaker *m, double depth, double away)
{
    Meeting at;
    if (!find_surface(m, &at))
        return outer_ray(m);
    V3 n = narrow(at.n), side = v3_unit(v3_cross(n, random_unit(&m->rng)));
    V3 p = v3_mad(narrow(at.p), -depth * m->size, n);
    return (TestRay){v3_mad(p, -away * m->size, side), side};
}

static TestRay grazing_ray(RayMaker *m)
{
    double depth = random_share(m, 16), side = rng_double(&m->rng) < 0.3 ? -1 : 1;
    return tangent_at(m, side * depth, 3 * random_share(m, 3));
}

static TestRay tangent_ray(RayMaker *m)
{
    return tangent_at(m, 0, 3 * random_share(m, 3));
}

static bool meets_alike(RayMaker *m, TestRay a, TestRay b)
{
    Meeting p, q;
    bool has_p = first_meeting(m, a, &p), has_q = first_meeting(m, b, &q);
    return has_p == has_q && (!has_p || (p.leaf == q.leaf && p.part == q.part));
}

/* Through an edge, or past an outline: halve the way to a ray that meets something else. */
static TestRay edge_ray(RayMaker *m)
{
    TestRay a = outer_ray(m), b = a;
    for (int i = 0; i < 16 && meets_alike(m, a, b); i++)
        b.d = v3_unit(v3_sub(random_point(m), a.o));
    if (meets_alike(m, a, b))
        return a;
    for (int i = 0; i < 60; i++) {
        TestRay middle = {a.o, v3_unit(v3_add(a.d, b.d))};
        *(meets_alike(m, a, middle) ? &a : &b) = middle;
    }
    return a;
}

/* Through a marked point; with none, through the middle of the box. */
static TestRay vertex_ray(RayMaker *m)
{
    const Plain3 *marks;
    int count = world->marks(m->model, &marks);
    V3 at = v3_scale(v3_add(m->lo, m->hi), 0.5);
    if (count > 0) {
        Plain3 p = marks[rng_u32(&m->rng) % (uint32_t)count];
        at = v3(p.x, p.y, p.z);
    }
    V3 o = v3_mad(at, 3 * m->size * random_share(m, 2), random_unit(&m->rng));
    return (TestRay){o, v3_unit(v3_sub(at, o))};
}

/* From a point of the surface, to anywhere. */
static TestRay surface_ray(RayMaker *m)
{
    Meeting at;
    if (!find_surface(m, &at))
        return inner_ray(m);
    return (TestRay){narrow(at.p), random_unit(&m->rng)};
}

static TestRay far_ray(RayMaker *m)
{
    V3 at = random_point(m), d = random_unit(&m->rng);
    return (TestRay){v3_mad(at, -1e6 * m->size, d), d};
}

/* Nearly along or square to an axis of the shape. */
static TestRay parallel_ray(RayMaker *m)
{
    double tilt = rng_u32(&m->rng) % 3 ? random_share(m, 16) : 0;
    V3 off = v3_scale(random_unit(&m->rng), tilt);
    Plain3 d = {off.x, off.y, off.z};
    switch (rng_u32(&m->rng) % 4) {
    case 0:
        d.x = 1;
        break;
    case 1:
        d.y = 1;
        break;
    case 2:
        d.z = 1;
        break;
    default:
        d.x = rng_double(&m->rng) - 0.5;
        d.z = rng_double(&m->rng) - 0.5;
    }
    d = world->turn(m->model, d);
    V3 way = v3_unit(v3(d.x, d.y, d.z)), at = random_point(m);
    return (TestRay){v3_mad(at, -3 * m->size, way), way};
}

const RayKind ray_kinds[RAY_KINDS] = {
    {"from outside", false, outer_ray},
    {"from within", false, inner_ray},
    {"grazing", true, grazing_ray},
    {"tangent", true, tangent_ray},
    {"edge", true, edge_ray},
    {"vertex", true, vertex_ray},
    {"on the surface", true, surface_ray},
    {"from 1e6 away", true, far_ray},
    {"nearly parallel", true, parallel_ray},
};

void ray_maker_init(RayMaker *maker, Model *model, uint64_t seed)
{
    Plain3 lo, hi;
    world->bound(model, &lo, &hi);
    *maker = (RayMaker){model, rng_at(seed, 99, 0), v3(lo.x, lo.y, lo.z), v3(hi.x, hi.y, hi.z), 0};
    if (!v3_is_finite(maker->lo) || !v3_is_finite(maker->hi)) {
        maker->lo = v3(-2, -2, -2);
        maker->hi = v3(2, 2, 2);
    }
    maker->size = v3_dist(maker->lo, maker->hi);
}

TestRay ray_make(RayMaker *maker, long i, const RayKind **kind)
{
    int first_hard = 0;
    while (!ray_kinds[first_hard].is_hard)
        first_hard++;
    long k = i / 2;
    *kind = &ray_kinds[i % 2 ? first_hard + k % (RAY_KINDS - first_hard) : k % first_hard];
    return (*kind)->make(maker);
}
