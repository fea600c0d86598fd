/* Rays at the edges and corners that triangles share: meshes, height fields and patches must not
 * let one through.  SPDX-License-Identifier: Apache-2.0 */
#include "shape/height_field.h"
#include "shape/patch.h"

#include "base/mem.h"
#include "base/rng.h"
#include "base/work.h"
#include "math/sample.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { CHUNK = 20000 };

/* Surfaces that together have no gap, and points on what they share. */
typedef struct Shower {
    const char *name;
    uint32_t pass;
    const Shape *shape[2];
    V3 (*target)(const struct Shower *shower, Rng *rng);
    V3 (*origin)(const struct Shower *shower, V3 target, Rng *rng);
    const MeshData *mesh[2];
    const HeightData *field;
    Xform place;
    atomic_long rays, leaks;
} Shower;

static Arena *arena;
static Diag diag;

static V3 random_dir(Rng *rng)
{
    V2 u = {rng_double(rng), 0};
    u.v = rng_double(rng);
    return v3_unit(warp_sphere(u));
}

/* --- running -------------------------------------------------------------------------------- */

/* Is the line stopped before it is past the point it goes to? */
static bool is_stopped(const Shower *s, V3 o, V3 target, ShapeScratch *scratch)
{
    V3 way = v3_sub(target, o);
    double far = v3_len(way);
    Ray ray = {o, v3_scale(way, 1 / far), 0, far * (1 + 1e-9)};
    Crossing c;
    for (int i = 0; i < 2; i++)
        if (s->shape[i] && shape_closest(s->shape[i], &ray, scratch, &c))
            return true;
    return false;
}

static void run_chunk(void *ctx, size_t index, int thread)
{
    (void)thread;
    Shower *s = ctx;
    ShapeScratch *scratch = shape_scratch_new();
    Rng rng = rng_at(41, s->pass, index);
    long leaks = 0;
    for (int i = 0; scratch && i < CHUNK; i++) {
        V3 target = s->target(s, &rng);
        leaks += !is_stopped(s, s->origin(s, target, &rng), target, scratch);
    }
    shape_scratch_free(scratch);
    atomic_fetch_add(&s->leaks, leaks);
    atomic_fetch_add(&s->rays, CHUNK);
}

/* HARD=long: a hundred million in all. */
static void run(Shower *s)
{
    static uint32_t pass;
    const char *hard = getenv("HARD");
    size_t chunks = hard && !strcmp(hard, "long") ? 900 : 8;
    s->pass = pass++;
    assert_int_equal(work_for(work_thread_count(), chunks, run_chunk, s), OK);
    printf("# hard: watertight %s: %ld rays at edges and corners, leaks %ld (0)\n", s->name,
           (long)s->rays, (long)s->leaks);
    assert_int_equal(s->leaks, 0);
}

/* --- meshes --------------------------------------------------------------------------------- */

static V3 on_edge(V3 a, V3 b, Rng *rng)
{
    double share = rng_u32(rng) % 2 ? 0 : rng_double(rng);
    return v3_mad(a, share, v3_sub(b, a));
}

/* A corner, or a point of an edge. */
static V3 mesh_target(const Shower *s, Rng *rng)
{
    const MeshData *m = s->mesh[rng_u32(rng) % 2 && s->mesh[1]];
    const uint32_t *c = m->corners + 3 * (size_t)(rng_u32(rng) % m->triangle_count);
    uint32_t k = rng_u32(rng) % 3;
    return xform_point(&s->place, on_edge(m->vertices[c[k]], m->vertices[c[(k + 1) % 3]], rng));
}

/* Near the middle of the ball. */
static V3 inner_origin(const Shower *s, V3 target, Rng *rng)
{
    (void)target;
    return xform_point(&s->place, v3_scale(random_dir(rng), 0.5 * rng_double(rng)));
}

/* A closed ball, its corners off by a little. */
static MeshData *make_ball(uint32_t rings, uint32_t sides)
{
    MeshData *mesh = ARENA_NEW(arena, MeshData);
    uint32_t count = 2 + (rings - 1) * sides, n = 0;
    V3 *at = ARENA_ARRAY(arena, V3, count);
    uint32_t *corners = ARENA_ARRAY(arena, uint32_t, (size_t)6 * (rings - 1) * sides);
    assert_true(mesh && at && corners);
    at[count - 2] = v3(0, 1, 0);
    at[count - 1] = v3(0, -1, 0);
    for (uint32_t i = 0; i < rings - 1; i++) {
        for (uint32_t j = 0; j < sides; j++) {
            double a = PMS_PI * (i + 1) / rings, b = 2 * PMS_PI * j / sides;
            Rng rng = rng_at(42, i, j);
            double r = 1 + 0.1 * rng_double(&rng) / rings;
            at[i * sides + j] = v3_scale(v3(sin(a) * cos(b), cos(a), sin(a) * sin(b)), r);
            uint32_t p = i * sides + j, q = i * sides + (j + 1) % sides;
            bool is_last = i == rings - 2;
            const uint32_t up[3] = {i ? p - sides : count - 2, q, p};
            const uint32_t down[3] = {p, q, is_last ? count - 1 : q + sides};
            memcpy(corners + n, up, sizeof up);
            memcpy(corners + n + 3, down, sizeof down);
            n += 6;
        }
    }
    /* Between two rings: p's triangle up has the ring above's corner of its own column, down that
     * of the ring below of the next one. */
    *mesh = (MeshData){
        .vertices = at, .vertex_count = count, .corners = corners, .triangle_count = n / 3};
    assert_int_equal(mesh_index(&diag, mesh, 1), OK);
    return mesh;
}

static void turn(Shower *s)
{
    Xform x = xform_scale(v3(3, 1, 0.3)), y = xform_rotate(v3(1, 2, 3));
    Xform z = xform_translate(v3(100, -30, 7));
    s->place = xform_then(&x, &y);
    s->place = xform_then(&s->place, &z);
}

static Shape *placed(Shape *shape, const Shower *s)
{
    assert_non_null(shape);
    shape_transform(shape, &s->place);
    return shape;
}

static void shower_ball(const char *name, uint32_t rings, uint32_t sides, bool is_turned)
{
    MeshData *mesh = make_ball(rings, sides);
    Shower s = {.name = name, .target = mesh_target, .origin = inner_origin, .mesh = {mesh}};
    s.place = XFORM_IDENTITY;
    if (is_turned)
        turn(&s);
    s.shape[0] = placed(shape_mesh(arena, mesh), &s);
    run(&s);
    mesh_done(mesh);
}

static void test_mesh(void **state)
{
    (void)state;
    shower_ball("mesh", 12, 24, false);
    shower_ball("mesh, stretched and turned", 12, 24, true);
}

/* So many triangles that Embree chooses the candidates. */
static void test_large_mesh(void **state)
{
    (void)state;
    shower_ball("mesh of 130000 triangles", 256, 256, true);
}

/* --- height fields -------------------------------------------------------------------------- */

enum { COLUMNS = 33, ROWS = 17 };

static V3 field_point(const HeightData *d, uint32_t x, uint32_t z)
{
    double y = d->heights[z * COLUMNS + x];
    return v3((double)x / (COLUMNS - 1), y / HEIGHT_SCALE, (double)z / (ROWS - 1));
}

/* On an edge of a cell or its diagonal, not on the border. */
static V3 field_target(const Shower *s, Rng *rng)
{
    uint32_t x = 1 + rng_u32(rng) % (COLUMNS - 3), z = 1 + rng_u32(rng) % (ROWS - 3);
    uint32_t way = rng_u32(rng) % 3;
    V3 a = field_point(s->field, way == 2 ? x + 1 : x, z);
    V3 b = field_point(s->field, way == 0 ? x + 1 : x, way == 0 ? z : z + 1);
    return xform_point(&s->place, on_edge(a, b, rng));
}

/* Above, so that no part hides another. */
static V3 upper_origin(const Shower *s, V3 target, Rng *rng)
{
    V3 up = xform_dir(&s->place, v3(0, 1, 0)), side = random_dir(rng);
    side = xform_dir(&s->place, v3(side.x, 0, side.z));
    double far = 1 + 9 * rng_double(rng), tilt = 0.2 * rng_double(rng);
    return v3_mad(target, far, v3_mad(up, tilt, side));
}

static void shower_field(const char *name, bool is_turned)
{
    HeightData *d = ARENA_NEW(arena, HeightData);
    uint16_t *heights = ARENA_ARRAY(arena, uint16_t, COLUMNS * ROWS);
    assert_true(d && heights);
    for (uint32_t i = 0; i < COLUMNS * ROWS; i++) {
        Rng rng = rng_at(43, 0, i);
        heights[i] = (uint16_t)(20000 + rng_u32(&rng) % 4000);
    }
    *d = (HeightData){.heights = heights, .columns = COLUMNS, .rows = ROWS};
    assert_true(height_prepare(arena, d));
    Shower s = {.name = name, .target = field_target, .origin = upper_origin, .field = d};
    s.place = XFORM_IDENTITY;
    if (is_turned)
        turn(&s);
    s.shape[0] = placed(shape_height_field(arena, d), &s);
    run(&s);
}

static void test_height_field(void **state)
{
    (void)state;
    shower_field("height_field", false);
    shower_field("height_field, stretched and turned", true);
}

/* --- patches -------------------------------------------------------------------------------- */

static MeshData *cut_patch(const Patch *patch)
{
    MeshData *mesh = ARENA_NEW(arena, MeshData);
    int u, v;
    assert_true(mesh && patch_halvings(patch, &u, &v));
    assert_true(patch_mesh(arena, patch, u, v, mesh));
    assert_int_equal(mesh_index(&diag, mesh, 1), OK);
    return mesh;
}

/* On the edge that both patches have, between two corners of the first one's triangles. */
static V3 seam_target(const Shower *s, Rng *rng)
{
    const MeshData *m = s->mesh[0];
    for (;;) {
        const uint32_t *c = m->corners + 3 * (size_t)(rng_u32(rng) % m->triangle_count);
        for (int k = 0; k < 3; k++) {
            V3 a = m->vertices[c[k]], b = m->vertices[c[(k + 1) % 3]];
            bool is_inner = fabs(a.z) < 0.9 && fabs(b.z) < 0.9;
            if (a.x == 0 && b.x == 0 && is_inner)
                return xform_point(&s->place, on_edge(a, b, rng));
        }
    }
}

/* Two patches with a common edge at x = 0, or what is within one of them. */
static void shower_patches(const char *name, bool is_turned)
{
    Patch patch[2];
    MeshData *mesh[2];
    for (int side = 0; side < 2; side++) {
        patch[side] = (Patch){.u_steps = 3, .v_steps = 3};
        for (int i = 0; i < 4; i++)
            for (int j = 0; j < 4; j++) {
                int column = side ? i : 3 - i; /* from the edge outward */
                Rng rng = rng_at(44, column ? (uint32_t)(4 * side + column) : 0, (uint64_t)j);
                double y = 0.2 * rng_double(&rng), x = (side ? 1 : -1) * column / 3.;
                patch[side].point[i][j] = v3(x, y, j * 2 / 3. - 1);
            }
        mesh[side] = cut_patch(&patch[side]);
    }
    Shower s = {.name = name,
                .target = seam_target,
                .origin = upper_origin,
                .mesh = {mesh[0], mesh[1]},
                .place = XFORM_IDENTITY};
    if (is_turned)
        turn(&s);
    for (int side = 0; side < 2; side++)
        s.shape[side] = placed(shape_mesh(arena, mesh[side]), &s);
    run(&s);
    for (int side = 0; side < 2; side++)
        mesh_done(mesh[side]);
}

static void test_patches(void **state)
{
    (void)state;
    shower_patches("bicubic_patches beside each other", false);
    shower_patches("bicubic_patches, stretched and turned", true);
}

static int set_up(void **state)
{
    (void)state;
    arena = arena_new();
    diag_init(&diag, diag_drop, NULL);
    return !arena;
}

static int tear_down(void **state)
{
    (void)state;
    arena_free(arena);
    return 0;
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_mesh),
        cmocka_unit_test(test_large_mesh),
        cmocka_unit_test(test_height_field),
        cmocka_unit_test(test_patches),
    };
    return cmocka_run_group_tests_name("leak_hard", tests, set_up, tear_down);
}
