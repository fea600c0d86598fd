/* How long the roots of a quartic take, in the mean over those of rays that pass near a torus: as
 * polynomials, and as the torus finds its first crossing.  One thread, least of several rounds.
 * SPDX-License-Identifier: Apache-2.0 */
#include "base/rng.h"
#include "base/stats.h"
#include "math/roots.h"
#include "math/sample.h"
#include "shape/shape.h"

#include <stdio.h>
#include <stdlib.h>

enum { RAYS = 100000, ROUNDS = 7 };

#define MAJOR 1.0
#define MINOR 0.35

typedef struct Bench {
    Ray ray[RAYS];
    double quartic[RAYS][5];
    Shape *torus;
    ShapeScratch *scratch;
} Bench;

/* From three radii away to somewhere in the ball around the torus. */
static Ray random_ray(Rng *rng)
{
    V2 u = {rng_double(rng), 0}, v = {rng_double(rng), 0};
    u.v = rng_double(rng);
    v.v = rng_double(rng);
    V3 o = v3_scale(v3_unit(warp_sphere(u)), 3);
    V3 to = v3_scale(v3_unit(warp_sphere(v)), (MAJOR + MINOR) * cbrt(rng_double(rng)));
    return (Ray){o, v3_unit(v3_sub(to, o)), 0, INFINITY};
}

/* (p^2 + R^2 - r^2)^2 = 4 R^2 (x^2 + z^2), about the point of the ray nearest to the centre. */
static void expand(const Ray *ray, double c[5])
{
    V3 e = ray->d, f = v3_mad(ray->o, -v3_dot(ray->o, e), e);
    double ring = MAJOR * MAJOR, m = v3_len2(f) + ring - MINOR * MINOR, k = v3_dot(f, e);
    c[4] = 1;
    c[3] = 4 * k;
    c[2] = 2 * m + 4 * k * k - 4 * ring * (e.x * e.x + e.z * e.z);
    c[1] = 4 * k * m - 8 * ring * (f.x * e.x + f.z * e.z);
    c[0] = m * m - 4 * ring * (f.x * f.x + f.z * f.z);
}

static int solve_quartics(const Bench *b)
{
    Root roots[4];
    int found = 0;
    for (int i = 0; i < RAYS; i++)
        found += roots_within(b->quartic[i], NULL, 4, -INFINITY, INFINITY, roots);
    return found;
}

static int meet_torus(const Bench *b)
{
    Crossing crossing;
    int found = 0;
    for (int i = 0; i < RAYS; i++)
        found += shape_closest(b->torus, &b->ray[i], b->scratch, &crossing);
    return found;
}

static void measure(const char *name, const Bench *b, int (*run)(const Bench *b), const char *reach)
{
    double least = INFINITY;
    int found = 0;
    for (int i = 0; i < ROUNDS; i++) {
        double begin = clock_cpu();
        found = run(b);
        least = fmin(least, clock_cpu() - begin);
    }
    printf("%s: %.0f ns a ray%s; %.2f found\n", name, 1e9 * least / RAYS, reach,
           (double)found / RAYS);
}

int main(void)
{
    Arena *arena = arena_new();
    Bench *b = arena ? ARENA_NEW(arena, Bench) : NULL;
    if (!b || !(b->torus = shape_torus(arena, MAJOR, MINOR)) || !(b->scratch = shape_scratch_new()))
        return EXIT_FAILURE;
    shape_finish(arena, b->torus);
    for (uint32_t i = 0; i < RAYS; i++) {
        Rng rng = rng_at(1, 1, i);
        b->ray[i] = random_ray(&rng);
        expand(&b->ray[i], b->quartic[i]);
    }
    measure("roots of torus quartics", b, solve_quartics, " (reach 200)");
    measure("first crossing of a torus", b, meet_torus, "");
    shape_scratch_free(b->scratch);
    arena_free(arena);
    return EXIT_SUCCESS;
}
