/* The oracle's shapes of flat parts: polygons, meshes, patches, height fields, letters.
 * SPDX-License-Identifier: Apache-2.0 */
#include "quad_shapes.h"

#include "shape/height_field.h"
#include "shape/patch.h"
#include "shape/polygon.h"

/* Two loops, the second a hole, in a plane through three random points. */
static Shape *make_polygon(ShapeKit *kit)
{
    static const double at[8][2] = {{0, 0},       {1, 0.25},   {1.25, 1},    {-0.25, 0.75},
                                    {0.25, 0.25}, {0.75, 0.5}, {0.5, 0.625}, {0.25, 0.5}};
    static const uint32_t next[8] = {1, 2, 3, 0, 5, 6, 7, 4};
    PolygonData *data = ARENA_NEW(kit->arena, PolygonData);
    V3 *points = ARENA_ARRAY(kit->arena, V3, 8);
    V3 o = kit_short_point(kit, 1), s = kit_short_point(kit, 1), t = kit_short_point(kit, 1);
    uint32_t *links = arena_copy(kit->arena, next, sizeof next);
    if (!data || !points || !links)
        return NULL;
    for (int i = 0; i < 8; i++) {
        points[i] = v3_mad(v3_mad(o, at[i][0], s), at[i][1], t);
        kit_mark(kit, points[i]);
    }
    bool is_flat;
    *data = (PolygonData){.points = points, .next = links, .count = 8};
    if (!polygon_prepare(kit->arena, data, &is_flat) || !is_flat)
        return NULL;
    return shape_polygon(kit->arena, data);
}

static Shape *make_mesh_of(ShapeKit *kit, MeshData *mesh)
{
    Diag diag;
    diag_init(&diag, diag_drop, NULL);
    if (mesh_index(&diag, mesh, 1) != OK)
        return NULL;
    kit->mesh = mesh;
    for (uint32_t i = 0; i < mesh->vertex_count; i++)
        kit_mark(kit, mesh->vertices[i]);
    return shape_mesh(kit->arena, mesh);
}

/* An octahedron with dents: its edges are halved, and the new points moved. */
static Shape *make_mesh(ShapeKit *kit)
{
    static const uint32_t face[8][3] = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                        {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    MeshData *mesh = ARENA_NEW(kit->arena, MeshData);
    V3 *at = ARENA_ARRAY(kit->arena, V3, 42);
    uint32_t *corners = ARENA_ARRAY(kit->arena, uint32_t, 96), middle[6][6] = {{0}}, count = 6;
    if (!mesh || !at || !corners)
        return NULL;
    for (int i = 0; i < 6; i++) {
        double far = i % 2 ? -1 : 1;
        at[i] = v3_add(v3(i / 2 == 0 ? far : 0, i / 2 == 1 ? far : 0, i / 2 == 2 ? far : 0),
                       kit_short_point(kit, 0.25));
    }
    for (int f = 0; f < 8; f++) {
        uint32_t m[3];
        for (int k = 0; k < 3; k++) {
            uint32_t a = face[f][k], b = face[f][(k + 1) % 3];
            if (!middle[a][b]) {
                middle[a][b] = middle[b][a] = count;
                at[count++] =
                    v3_add(v3_scale(v3_add(at[a], at[b]), 0.5), kit_short_point(kit, 0.25));
            }
            m[k] = middle[a][b];
        }
        const uint32_t parts[12] = {face[f][0], m[0], m[2], face[f][1], m[1], m[0],
                                    face[f][2], m[2], m[1], m[0],       m[1], m[2]};
        for (int k = 0; k < 12; k++)
            corners[12 * f + k] = parts[k];
    }
    *mesh = (MeshData){.vertices = at,
                       .vertex_count = count,
                       .corners = corners,
                       .triangle_count = 32,
                       .has_inside = true,
                       .inside_vector = v3(0, 0, 1)};
    return make_mesh_of(kit, mesh);
}

static Shape *make_patch(ShapeKit *kit)
{
    Patch patch = {.u_steps = 2, .v_steps = 2};
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++)
            patch.point[i][j] =
                v3_add(v3(0.5 * i - 0.75, 0, 0.5 * j - 0.75), kit_short_point(kit, 0.25));
    MeshData *mesh = ARENA_NEW(kit->arena, MeshData);
    int u, v;
    if (!mesh || !patch_halvings(&patch, &u, &v) || !patch_mesh(kit->arena, &patch, u, v, mesh))
        return NULL;
    return make_mesh_of(kit, mesh);
}

static Shape *make_height_field_of(ShapeKit *kit, bool is_smooth)
{
    enum { COLUMNS = 7, ROWS = 5 };
    HeightData *data = ARENA_NEW(kit->arena, HeightData);
    uint16_t *heights = ARENA_ARRAY(kit->arena, uint16_t, COLUMNS * ROWS);
    if (!data || !heights)
        return NULL;
    for (int i = 0; i < COLUMNS * ROWS; i++) {
        heights[i] = (uint16_t)(rng_u32(&kit->rng) >> 16);
        V3 p = v3(i % COLUMNS, heights[i], i / COLUMNS);
        kit_mark(kit, v3(p.x / (COLUMNS - 1), p.y / HEIGHT_SCALE, p.z / (ROWS - 1)));
    }
    *data = (HeightData){.heights = heights,
                         .columns = COLUMNS,
                         .rows = ROWS,
                         .water = rng_u32(&kit->rng) % 2 ? 20000 : 0,
                         .is_smooth = is_smooth};
    return height_prepare(kit->arena, data) ? shape_height_field(kit->arena, data) : NULL;
}

static Shape *make_height_field(ShapeKit *kit)
{
    return make_height_field_of(kit, false);
}

static Shape *make_smooth_height_field(ShapeKit *kit)
{
    return make_height_field_of(kit, true);
}

/* Letters are prisms of quadratic outlines whose points are whole numbers of font units: an O. */
static Shape *make_text(ShapeKit *kit)
{
    CurveSpan *spans = ARENA_ARRAY(kit->arena, CurveSpan, 8);
    if (!spans)
        return NULL;
    for (int i = 0; i < 8; i++) {
        static const double turn[5][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 0}};
        const double *from = turn[i % 4], *to = turn[i % 4 + 1];
        double wide = (i < 4 ? 700 : 450) / (double)2048, high = (i < 4 ? 750 : 600) / (double)2048;
        spans[i] = (CurveSpan){.a = {wide * from[0], wide * (from[0] + to[0]), wide * to[0]},
                               .b = {high * from[1], high * (from[1] + to[1]), high * to[1]}};
    }
    PrismForm form = {.lo = 0, .degree = 2, .span_count = 8, .spans = spans};
    form.hi = kit_number(kit, 0.1, 0.5);
    return shape_prism(kit->arena, &form);
}

const ShapeCase facet_cases[] = {
    {.name = "polygon", .make = make_polygon},
    {.name = "mesh", .make = make_mesh},
    {.name = "bicubic_patch", .make = make_patch},
    {.name = "height_field", .make = make_height_field},
    {.name = "smooth height_field", .make = make_smooth_height_field},
    {.name = "text", .make = make_text},
    {.name = NULL},
};
