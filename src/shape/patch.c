/* Bicubic patches.
 *
 * A patch is a grid of as many cells as its least flat part asks for, two triangles each.  An
 * edge that is flat with fewer cells has its other corners moved onto the chords: so patches
 * beside each other fit, but for rounding, however finely each is cut inside.
 * SPDX-License-Identifier: Apache-2.0 */
#include "shape/patch.h"

#include <math.h>
#include <string.h>

/* Below this sine, squared, two tangents have no normal. */
#define TANGENT_SINE2 1e-10

/* How far into the patch a normal is looked for where its edge has none. */
#define INWARD 1e-4

/* --- curves -------------------------------------------------------------------------------- */

/* The same, to the last bit, when a and b, t and 1-t change places. */
static V3 between(V3 a, V3 b, double t)
{
    double s = 1 - t;
    return v3(a.x * s + b.x * t, a.y * s + b.y * t, a.z * s + b.z * t);
}

/* Return the point of a Bezier curve, and its direction (a third of the derivative). */
static V3 curve_at(const V3 p[4], double t, V3 *direction)
{
    V3 a = between(p[0], p[1], t), b = between(p[1], p[2], t), c = between(p[2], p[3], t);
    V3 d = between(a, b, t), e = between(b, c, t);
    *direction = v3_sub(e, d);
    return between(d, e, t);
}

/* Cut a curve in two halves. */
static void halve(const V3 p[4], V3 low[4], V3 high[4])
{
    V3 b = between(p[1], p[2], .5);
    low[0] = p[0], high[3] = p[3];
    low[1] = between(p[0], p[1], .5), high[2] = between(p[2], p[3], .5);
    low[2] = between(low[1], b, .5), high[1] = between(b, high[2], .5);
    low[3] = high[0] = between(low[2], high[1], .5);
}

static bool curve_is_flat(const V3 p[4], double flatness)
{
    V3 chord = v3_sub(p[3], p[0]);
    double length = v3_len(chord);
    for (int i = 1; i < 3; i++) {
        V3 off = v3_sub(p[i], p[i == 1 ? 0 : 3]);
        double distance = length > 0 ? v3_len(v3_cross(off, chord)) / length : v3_len(off);
        if (!(distance < flatness))
            return false;
    }
    return true;
}

/* Return how often a curve has to be halved, at most `most` times. */
static int curve_halvings(const V3 p[4], double flatness, int most)
{
    if (most <= 0 || curve_is_flat(p, flatness))
        return 0;
    V3 low[4], high[4];
    halve(p, low, high);
    int a = curve_halvings(low, flatness, most - 1);
    if (a == most - 1)
        return most;
    int b = curve_halvings(high, flatness, most - 1);
    return 1 + (a > b ? a : b);
}

static void column_of(V3 p[4][4], int column, V3 out[4])
{
    for (int i = 0; i < 4; i++)
        out[i] = p[i][column];
}

/* --- how finely ---------------------------------------------------------------------------- */

/* Do all points lie near the plane through three corners? */
static bool patch_is_flat(V3 p[4][4], double flatness)
{
    V3 n = v3_unit(v3_cross(v3_sub(p[0][3], p[0][0]), v3_sub(p[3][0], p[0][0])));
    if (!(v3_len2(n) > 0))
        n = v3_unit(v3_cross(v3_sub(p[0][3], p[0][0]), v3_sub(p[3][3], p[0][0])));
    if (!(v3_len2(n) > 0))
        return false;
    for (int i = 0; i < 16; i++)
        if (!(fabs(v3_dot(n, v3_sub(p[i / 4][i % 4], p[0][0]))) < flatness))
            return false;
    return true;
}

static void halve_rows(V3 p[4][4], V3 low[4][4], V3 high[4][4])
{
    for (int i = 0; i < 4; i++)
        halve(p[i], low[i], high[i]);
}

static void halve_columns(V3 p[4][4], V3 low[4][4], V3 high[4][4])
{
    for (int j = 0; j < 4; j++) {
        V3 column[4], a[4], b[4];
        column_of(p, j, column);
        halve(column, a, b);
        for (int i = 0; i < 4; i++)
            low[i][j] = a[i], high[i][j] = b[i];
    }
}

/* Return how often a part has to be halved in both directions, at most `most` times. */
static int part_halvings(V3 p[4][4], double flatness, int u_steps, int v_steps, int most)
{
    if (most <= 0 || patch_is_flat(p, flatness))
        return 0;
    V3 parts[4][4][4], all[4][4];
    int count = 1, deepest = 0;
    memcpy(parts[0], p, sizeof parts[0]);
    if (u_steps > 0) {
        halve_columns(p, parts[0], parts[1]);
        count = 2;
    }
    for (int i = 0, whole = count; v_steps > 0 && i < whole; i++) {
        memcpy(all, parts[i], sizeof all);
        halve_rows(all, parts[i], parts[count++]);
    }
    for (int i = 0; i < count && deepest < most - 1; i++) {
        int depth = part_halvings(parts[i], flatness, u_steps - 1, v_steps - 1, most - 1);
        deepest = depth > deepest ? depth : deepest;
    }
    return 1 + deepest;
}

static int least(int a, int b)
{
    return a < b ? a : b;
}

static int greatest(int a, int b)
{
    return a > b ? a : b;
}

/* Return how often the four edges have to be halved: v=0, v=1, u=0, u=1. */
static void edge_halvings(const Patch *patch, int out[4])
{
    V3 points[4][4], side[4];
    memcpy(points, patch->point, sizeof points);
    for (int i = 0; i < 4; i++) {
        int steps = least(i < 2 ? patch->u_steps : patch->v_steps, PATCH_HALVINGS_MAX);
        if (i < 2)
            column_of(points, 3 * i, side);
        out[i] = curve_halvings(i < 2 ? side : points[3 * (i - 2)], patch->flatness, steps);
    }
}

bool patch_halvings(const Patch *patch, int *u, int *v)
{
    int most = greatest(patch->u_steps, patch->v_steps), edges[4];
    if (!(patch->flatness > 0)) {
        *u = patch->u_steps, *v = patch->v_steps;
        return *u <= PATCH_HALVINGS_MAX && *v <= PATCH_HALVINGS_MAX - *u;
    }
    V3 points[4][4];
    memcpy(points, patch->point, sizeof points);
    /* Deeper than this there are more cells than may be. */
    int limit = least(most, greatest(PATCH_HALVINGS_MAX / 2,
                                     PATCH_HALVINGS_MAX - least(patch->u_steps, patch->v_steps)));
    int both = part_halvings(points, patch->flatness, patch->u_steps, patch->v_steps, limit + 1);
    if (both > limit && limit < most)
        return false;
    edge_halvings(patch, edges);
    *u = greatest(least(both, patch->u_steps), greatest(edges[0], edges[1]));
    *v = greatest(least(both, patch->v_steps), greatest(edges[2], edges[3]));
    return *u + *v <= PATCH_HALVINGS_MAX;
}

/* --- triangles ----------------------------------------------------------------------------- */

/* Return the point at (u, v) and the tangents' cross product; `n` is 0 where they have none. */
static V3 patch_at(const Patch *patch, double u, double v, V3 *n)
{
    V3 row[4], slope[4], along_v, along_u, unused;
    for (int j = 0; j < 4; j++) {
        V3 column[4];
        for (int i = 0; i < 4; i++)
            column[i] = patch->point[i][j];
        row[j] = curve_at(column, u, &slope[j]);
    }
    V3 p = curve_at(row, v, &along_v);
    along_u = curve_at(slope, v, &unused);
    *n = v3_cross(along_u, along_v);
    if (!(v3_len2(*n) > TANGENT_SINE2 * v3_len2(along_u) * v3_len2(along_v)))
        *n = v3(0, 0, 0);
    return p;
}

static void make_corners(const Patch *patch, int rows, int columns, MeshData *out)
{
    const V2 *uv = patch->uv;
    for (int i = 0; i <= rows; i++) {
        for (int j = 0; j <= columns; j++) {
            uint32_t at = out->vertex_count++;
            double u = (double)i / rows, v = (double)j / columns;
            V3 n;
            out->vertices[at] = patch_at(patch, u, v, &n);
            if (v3_len2(n) == 0)
                patch_at(patch, u + INWARD * (.5 - u), v + INWARD * (.5 - v), &n);
            out->normals[at] = v3_unit(n);
            double a = (1 - u) * (1 - v), b = (1 - u) * v, c = u * v, d = u * (1 - v);
            out->uvs[at] = (V2){a * uv[0].u + b * uv[1].u + c * uv[2].u + d * uv[3].u,
                                a * uv[0].v + b * uv[1].v + c * uv[2].v + d * uv[3].v};
        }
    }
}

/* Move the corners along an edge onto the chords between every `coarse`-th of them. */
static void straighten(MeshData *out, size_t first, size_t step, int count, int coarse)
{
    for (int i = 0; i < count; i++) {
        size_t from = first + step * (size_t)(i - i % coarse), to = from + step * (size_t)coarse;
        if (i % coarse)
            out->vertices[first + step * (size_t)i] =
                between(out->vertices[from], out->vertices[to], (double)(i % coarse) / coarse);
    }
}

static void add_triangle(MeshData *out, uint32_t a, uint32_t b, uint32_t c)
{
    V3 ab = v3_sub(out->vertices[b], out->vertices[a]),
       ac = v3_sub(out->vertices[c], out->vertices[a]);
    if (a == b || b == c || c == a || !(v3_max_abs(v3_cross(ab, ac)) > 0))
        return;
    uint32_t *corners = out->corners + 3 * (size_t)out->triangle_count;
    uint32_t *normals = out->normal_corners + 3 * (size_t)out->triangle_count++;
    corners[0] = normals[0] = a, corners[1] = normals[1] = b, corners[2] = normals[2] = c;
    bool is_smooth = v3_len2(out->normals[a]) > 0 && v3_len2(out->normals[b]) > 0 &&
                     v3_len2(out->normals[c]) > 0;
    if (!is_smooth)
        normals[0] = normals[1] = normals[2] = UINT32_MAX;
}

static void make_triangles(int rows, int columns, MeshData *out)
{
    for (int i = 0; i < rows; i++) {
        for (int j = 0; j < columns; j++) {
            uint32_t wide = (uint32_t)columns + 1, c0 = (uint32_t)i * wide + (uint32_t)j;
            add_triangle(out, c0, c0 + 1, c0 + wide + 1);
            add_triangle(out, c0, c0 + wide + 1, c0 + wide);
        }
    }
}

bool patch_mesh(Arena *arena, const Patch *patch, int u_halvings, int v_halvings, MeshData *out)
{
    int rows = 1 << u_halvings, columns = 1 << v_halvings, edges[4];
    size_t corners = ((size_t)rows + 1) * ((size_t)columns + 1);
    size_t triangles = 2 * (size_t)rows * (size_t)columns;
    *out = (MeshData){.vertices = ARENA_ARRAY(arena, V3, corners),
                      .normals = ARENA_ARRAY(arena, V3, corners),
                      .uvs = ARENA_ARRAY(arena, V2, corners),
                      .corners = ARENA_ARRAY(arena, uint32_t, 3 * triangles),
                      .normal_corners = ARENA_ARRAY(arena, uint32_t, 3 * triangles)};
    out->uv_corners = out->corners;
    out->is_smooth_by_equals = true;
    if (!out->vertices || !out->normals || !out->uvs || !out->corners || !out->normal_corners)
        return false;
    make_corners(patch, rows, columns, out);
    edge_halvings(patch, edges);
    size_t wide = (size_t)columns + 1, last = wide * (size_t)rows;
    if (patch->flatness > 0) {
        straighten(out, 0, wide, rows, 1 << (u_halvings - edges[0]));
        straighten(out, (size_t)columns, wide, rows, 1 << (u_halvings - edges[1]));
        straighten(out, 0, 1, columns, 1 << (v_halvings - edges[2]));
        straighten(out, last, 1, columns, 1 << (v_halvings - edges[3]));
    }
    make_triangles(rows, columns, out);
    return true;
}
