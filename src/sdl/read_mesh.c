/* mesh and mesh2: triangle lists.
 *
 * Both end in one MeshData whose arrays lie in the scene arena.  Triangles without area are
 * dropped.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/read_int.h"

#include <string.h>

enum { MESH_ITEMS_MAX = 500 * 1000 * 1000 }; /* of one list; far above what memory holds */

/* A mesh being read. */
typedef struct MeshDraft {
    MeshData *mesh;
    size_t vertex_capacity, corner_capacity, normal_capacity, normal_corner_capacity;
    size_t uv_capacity, uv_corner_capacity, texture_corner_capacity, texture_capacity;
    uint32_t normal_count, uv_count;
    const Texture **textures;
    uint32_t texture_count;
    bool has_smooth, has_uv, has_texture, has_warned_normal;
} MeshDraft;

static uint32_t add_vertex(Parser *p, MeshDraft *d, V3 vertex)
{
    MeshData *m = d->mesh;
    m->vertices =
        read_grow(p, m->vertices, m->vertex_count, &d->vertex_capacity, sizeof *m->vertices);
    m->vertices[m->vertex_count] = vertex;
    return m->vertex_count++;
}

static uint32_t add_normal(Parser *p, MeshDraft *d, V3 normal, Span span)
{
    MeshData *m = d->mesh;
    normal = v3_unit(normal);
    if (!(v3_len2(normal) > 0)) {
        normal = v3(1, 0, 0);
        if (!d->has_warned_normal)
            parse_warn(p, WARN_GEOMETRY, span, "a normal of the mesh is 0: <1,0,0> is used");
        d->has_warned_normal = true;
    }
    m->normals = read_grow(p, m->normals, d->normal_count, &d->normal_capacity, sizeof *m->normals);
    m->normals[d->normal_count] = normal;
    return d->normal_count++;
}

static uint32_t add_uv(Parser *p, MeshDraft *d, V2 uv)
{
    MeshData *m = d->mesh;
    m->uvs = read_grow(p, m->uvs, d->uv_count, &d->uv_capacity, sizeof *m->uvs);
    m->uvs[d->uv_count] = uv;
    return d->uv_count++;
}

static uint32_t add_texture(Parser *p, MeshDraft *d, const Texture *texture)
{
    /* Neighbours nearly always share their texture. */
    for (uint32_t i = d->texture_count; i > 0 && i + 8 > d->texture_count; i--)
        if (d->textures[i - 1] == texture)
            return i - 1;
    d->textures =
        read_grow(p, d->textures, d->texture_count, &d->texture_capacity, sizeof *d->textures);
    d->textures[d->texture_count] = texture;
    return d->texture_count++;
}

/* Append three indices to one of the mesh's corner arrays. */
static uint32_t *add_corners(Parser *p, uint32_t *corners, uint32_t triangle, size_t *capacity,
                             const uint32_t three[3])
{
    size_t count = (size_t)triangle * 3;
    while (count + 3 > *capacity)
        corners = read_grow(p, corners, *capacity, capacity, sizeof *corners);
    memcpy(corners + count, three, 3 * sizeof *three);
    return corners;
}

/* What one triangle of a mesh is made of. */
typedef struct MeshTriangle {
    uint32_t corner[3], normal[3], uv[3], texture[3];
} MeshTriangle;

static const uint32_t no_corners[3] = {UINT32_MAX, UINT32_MAX, UINT32_MAX};

static void add_triangle(Parser *p, MeshDraft *d, const MeshTriangle *t)
{
    MeshData *m = d->mesh;
    uint32_t n = m->triangle_count;
    m->corners = add_corners(p, m->corners, n, &d->corner_capacity, t->corner);
    m->normal_corners = add_corners(p, m->normal_corners, n, &d->normal_corner_capacity, t->normal);
    m->uv_corners = add_corners(p, m->uv_corners, n, &d->uv_corner_capacity, t->uv);
    m->textures = add_corners(p, m->textures, n, &d->texture_corner_capacity, t->texture);
    d->has_smooth |= t->normal[0] != UINT32_MAX;
    d->has_uv |= t->uv[0] != UINT32_MAX;
    d->has_texture |= t->texture[0] != MESH_NO_TEXTURE;
    m->triangle_count++;
}

/* --- mesh ---------------------------------------------------------------------------------- */

/* Read `texture { NAME }`: in a mesh it is a look of one triangle. */
static void read_triangle_texture(Parser *p, MeshDraft *d, MeshTriangle *t)
{
    if (parse_peek(p)->kind == KW_TEXTURE) {
        uint32_t texture = add_texture(p, d, read_texture(p));
        t->texture[0] = t->texture[1] = t->texture[2] = texture;
        return;
    }
    read_open(p); /* texture_list */
    for (int i = 0; i < 3; i++) {
        const Value *value = parse_accept_value(p, VALUE_TEXTURE);
        if (!value)
            parse_fail_here(p, "in texture_list, which wants three names of textures");
        t->texture[i] = add_texture(p, d, value->node);
        parse_comma(p);
    }
    parse_expect(p, TOKEN_RBRACE, "texture_list");
}

static void read_triangle_uvs(Parser *p, MeshDraft *d, MeshTriangle *t)
{
    for (int i = 0; i < 3; i++) {
        t->uv[i] = add_uv(p, d, parse_v2(p));
        parse_comma(p);
    }
}

/* triangle or smooth_triangle, from its word to its closing brace. */
static void read_mesh_triangle(Parser *p, MeshDraft *d, bool is_smooth)
{
    Token word = read_open(p);
    V3 corner[3], normal[3];
    for (int i = 0; i < 3; i++) {
        corner[i] = parse_v3(p);
        parse_comma(p);
        if (is_smooth) {
            normal[i] = parse_v3(p);
            parse_comma(p);
        }
    }
    MeshTriangle t;
    memcpy(t.normal, no_corners, sizeof t.normal);
    memcpy(t.uv, no_corners, sizeof t.uv);
    memcpy(t.texture, no_corners, sizeof t.texture);
    while (!read_close(p)) {
        TokenKind kind = parse_peek(p)->kind;
        if (kind == KW_TEXTURE || kind == KW_TEXTURE_LIST)
            read_triangle_texture(p, d, &t);
        else if (parse_accept(p, KW_UV_VECTORS))
            read_triangle_uvs(p, d, &t);
        else
            parse_fail_here(p, "in a triangle of a mesh");
    }
    if (read_triangle_is_flat(corner)) {
        parse_warn(p, WARN_GEOMETRY, word.span, "degenerate triangle: it has no area");
        return;
    }
    for (int i = 0; i < 3; i++) {
        t.corner[i] = add_vertex(p, d, corner[i]);
        if (is_smooth)
            t.normal[i] = add_normal(p, d, normal[i], word.span);
    }
    add_triangle(p, d, &t);
}

static void read_inside_vector(Parser *p, MeshData *mesh)
{
    Span first = parse_peek(p)->span;
    V3 v = v3_unit(parse_v3(p));
    if (!(v3_len2(v) > 0))
        parse_fail(p, span_join(first, parse_last_span(p)), "inside_vector is 0");
    mesh->inside_vector = v;
    mesh->has_inside = true;
}

Node *read_mesh_leaf(Parser *p, MeshData *mesh)
{
    if (!scene_add_mesh(parse_scene(p), mesh)) /* from here on scene_free frees its index */
        parse_no_null(p, NULL);
    Status status = mesh_index(parse_diag(p), mesh, parse_options(p)->threads);
    if (status != OK)
        parse_fail_status(p, status);
    return read_leaf(p, shape_mesh(parse_arena(p), mesh));
}

/* Drop what no triangle uses, build the index, and make the leaf. */
static Node *finish_mesh(Parser *p, MeshDraft *d, Span span)
{
    MeshData *m = d->mesh;
    if (m->triangle_count == 0)
        parse_fail(p, span, "the mesh has no triangle with an area");
    if (!d->has_smooth)
        m->normals = NULL, m->normal_corners = NULL;
    if (!d->has_uv)
        m->uvs = NULL, m->uv_corners = NULL;
    for (size_t i = 0; m->uv_corners && i < (size_t)m->triangle_count * 3; i++)
        if (m->uv_corners[i] == UINT32_MAX)
            m->uv_corners[i] = 0; /* triangles without uvs among others that have them */
    if (!d->has_texture)
        m->textures = NULL;
    Node *node = read_mesh_leaf(p, m);
    if (d->has_texture) {
        node->mesh_textures = (const Texture *const *)d->textures;
        node->mesh_texture_count = (int)d->texture_count;
    }
    return node;
}

Node *read_mesh(Parser *p)
{
    Span brace = parse_last_span(p);
    MeshDraft d = {.mesh = parse_alloc(p, sizeof *d.mesh)};
    for (;;) {
        TokenKind kind = parse_peek(p)->kind;
        if (kind == KW_TRIANGLE || kind == KW_SMOOTH_TRIANGLE)
            read_mesh_triangle(p, &d, kind == KW_SMOOTH_TRIANGLE);
        else if (parse_accept(p, KW_INSIDE_VECTOR))
            read_inside_vector(p, d.mesh);
        else
            return finish_mesh(p, &d, brace);
    }
}

/* --- mesh2 --------------------------------------------------------------------------------- */

/* Take the word of a list, its brace and its count. */
static uint32_t read_list_count(Parser *p)
{
    read_open(p);
    long count = parse_int(p, "the count of a mesh list", 0, MESH_ITEMS_MAX);
    parse_comma(p);
    return (uint32_t)count;
}

static void read_vertex_vectors(Parser *p, MeshDraft *d)
{
    uint32_t count = read_list_count(p);
    for (uint32_t i = 0; i < count; i++) {
        add_vertex(p, d, parse_v3(p));
        parse_comma(p);
    }
    parse_expect(p, TOKEN_RBRACE, "vertex_vectors");
}

static void read_normal_vectors(Parser *p, MeshDraft *d)
{
    uint32_t count = read_list_count(p);
    for (uint32_t i = 0; i < count; i++) {
        Span span = parse_peek(p)->span;
        add_normal(p, d, parse_v3(p), span);
        parse_comma(p);
    }
    parse_expect(p, TOKEN_RBRACE, "normal_vectors");
}

static void read_uv_vectors(Parser *p, MeshDraft *d)
{
    uint32_t count = read_list_count(p);
    for (uint32_t i = 0; i < count; i++) {
        add_uv(p, d, parse_v2(p));
        parse_comma(p);
    }
    parse_expect(p, TOKEN_RBRACE, "uv_vectors");
}

static void read_texture_list(Parser *p, MeshDraft *d)
{
    uint32_t count = read_list_count(p);
    for (uint32_t i = 0; i < count; i++) {
        if (parse_peek(p)->kind != KW_TEXTURE)
            parse_fail_here(p, "in texture_list, which wants texture blocks");
        const Texture *texture = read_texture(p);
        d->textures =
            read_grow(p, d->textures, d->texture_count, &d->texture_capacity, sizeof *d->textures);
        d->textures[d->texture_count++] = texture;
        parse_comma(p);
    }
    parse_expect(p, TOKEN_RBRACE, "texture_list");
}

/* Read one vector of three indices below `limit`. */
static void read_indices(Parser *p, uint32_t limit, const char *what, uint32_t out[3])
{
    Span first = parse_peek(p)->span;
    V3 v = parse_v3(p);
    const double values[3] = {v.x, v.y, v.z};
    for (int i = 0; i < 3; i++) {
        double index = trunc(values[i]);
        if (!(index >= 0 && index < limit))
            parse_fail(p, span_join(first, parse_last_span(p)),
                       "%s %g is out of range: there are %u", what, index, limit);
        out[i] = (uint32_t)index;
    }
}

/* The texture indices after a face: none, one for all corners, or three. */
static void read_face_textures(Parser *p, const MeshDraft *d, uint32_t out[3])
{
    memcpy(out, no_corners, 3 * sizeof *out);
    for (int i = 0; i < 3; i++) {
        TokenKind kind = parse_peek(p)->kind;
        if (kind == TOKEN_LESS || kind == TOKEN_RBRACE || !parse_is_expression(p))
            break;
        Span span = parse_peek(p)->span;
        long index = parse_int(p, "the texture index of a face", 0, MESH_ITEMS_MAX);
        if ((uint32_t)index >= d->texture_count)
            parse_fail(p, span, "texture %ld is out of range: texture_list has %u", index,
                       d->texture_count);
        out[i] = (uint32_t)index;
        if (i == 0)
            out[1] = out[2] = out[0];
        parse_comma(p);
    }
}

static void read_face_indices(Parser *p, MeshDraft *d)
{
    uint32_t count = read_list_count(p);
    for (uint32_t i = 0; i < count; i++) {
        MeshTriangle t;
        read_indices(p, d->mesh->vertex_count, "vertex", t.corner);
        parse_comma(p);
        read_face_textures(p, d, t.texture);
        memcpy(t.normal, no_corners, sizeof t.normal);
        memcpy(t.uv, no_corners, sizeof t.uv);
        add_triangle(p, d, &t);
    }
    parse_expect(p, TOKEN_RBRACE, "face_indices");
}

/* uv_indices: one for each face. */
static void read_uv_indices(Parser *p, MeshDraft *d)
{
    Span span = parse_peek(p)->span;
    uint32_t count = read_list_count(p);
    if (count != d->mesh->triangle_count)
        parse_fail(p, span, "uv_indices wants one for each of the %u faces, got %u",
                   d->mesh->triangle_count, count);
    for (uint32_t i = 0; i < count; i++) {
        read_indices(p, d->uv_count, "uv vector", d->mesh->uv_corners + 3 * (size_t)i);
        parse_comma(p);
    }
    d->has_uv |= count > 0;
    parse_expect(p, TOKEN_RBRACE, "uv_indices");
}

/* normal_indices: for the first faces; the rest stay flat. */
static void read_normal_indices(Parser *p, MeshDraft *d)
{
    Span span = parse_peek(p)->span;
    uint32_t count = read_list_count(p);
    if (count > d->mesh->triangle_count)
        parse_fail(p, span, "normal_indices has %u entries for %u faces", count,
                   d->mesh->triangle_count);
    for (uint32_t i = 0; i < count; i++) {
        read_indices(p, d->normal_count, "normal", d->mesh->normal_corners + 3 * (size_t)i);
        parse_comma(p);
    }
    d->has_smooth |= count > 0;
    parse_expect(p, TOKEN_RBRACE, "normal_indices");
}

/* What has been read of a mesh2, besides its arrays. */
typedef struct Mesh2State {
    bool has_faces, has_uv_indices, has_normal_indices;
} Mesh2State;

/* Without indices of their own, uvs and normals go with the vertices. */
static void share_indices(Parser *p, MeshDraft *d, const Mesh2State *state, Span span)
{
    MeshData *m = d->mesh;
    size_t bytes = (size_t)m->triangle_count * 3 * sizeof *m->corners;
    if (!state->has_uv_indices && d->uv_count == m->vertex_count && d->uv_count > 0) {
        memcpy(m->uv_corners, m->corners, bytes);
        d->has_uv = true;
    } else if (!state->has_uv_indices && d->uv_count == 1) {
        memset(m->uv_corners, 0, bytes); /* the one uv */
        d->has_uv = true;
    } else if (!state->has_uv_indices && d->uv_count > 0) {
        parse_fail(p, span, "%u uv_vectors for %u vertices, and no uv_indices", d->uv_count,
                   m->vertex_count);
    }
    if (!state->has_normal_indices && d->normal_count == m->vertex_count && d->normal_count > 0) {
        memcpy(m->normal_corners, m->corners, bytes);
        d->has_smooth = true;
    } else if (!state->has_normal_indices && d->normal_count > 0) {
        parse_fail(p, span, "%u normal_vectors for %u vertices, and no normal_indices",
                   d->normal_count, m->vertex_count);
    }
}

/* Drop faces without area, keeping the others in order. */
static void drop_flat_faces(Parser *p, MeshDraft *d, Span span)
{
    MeshData *m = d->mesh;
    uint32_t kept = 0;
    uint32_t *lists[4] = {m->corners, m->normal_corners, m->uv_corners, m->textures};
    for (uint32_t i = 0; i < m->triangle_count; i++) {
        const uint32_t *c = m->corners + 3 * (size_t)i;
        V3 corner[3] = {m->vertices[c[0]], m->vertices[c[1]], m->vertices[c[2]]};
        if (read_triangle_is_flat(corner))
            continue;
        for (int list = 0; list < 4; list++)
            memmove(lists[list] + 3 * (size_t)kept, lists[list] + 3 * (size_t)i,
                    3 * sizeof *lists[list]);
        kept++;
    }
    if (kept < m->triangle_count)
        parse_warn(p, WARN_GEOMETRY, span, "%u degenerate triangles: they have no area",
                   m->triangle_count - kept);
    m->triangle_count = kept;
}

/* Read one list if its word comes next; the order of the lists is checked here. */
static bool read_mesh2_list(Parser *p, MeshDraft *d, Mesh2State *state)
{
    Token word = *parse_peek(p);
    bool is_index = word.kind == KW_UV_INDICES || word.kind == KW_NORMAL_INDICES;
    if (is_index && !state->has_faces)
        parse_fail(p, word.span, "this list must come after face_indices");
    switch (word.kind) {
    case KW_UV_INDICES:
        read_uv_indices(p, d);
        return state->has_uv_indices = true;
    case KW_NORMAL_INDICES:
        read_normal_indices(p, d);
        return state->has_normal_indices = true;
    case KW_VERTEX_VECTORS:
    case KW_NORMAL_VECTORS:
    case KW_UV_VECTORS:
    case KW_TEXTURE_LIST:
    case KW_FACE_INDICES:
        break;
    default:
        return false;
    }
    if (state->has_faces)
        parse_fail(p, word.span, "this list must come before face_indices");
    if (word.kind == KW_VERTEX_VECTORS)
        read_vertex_vectors(p, d);
    else if (word.kind == KW_NORMAL_VECTORS)
        read_normal_vectors(p, d);
    else if (word.kind == KW_UV_VECTORS)
        read_uv_vectors(p, d);
    else if (word.kind == KW_TEXTURE_LIST)
        read_texture_list(p, d);
    else
        read_face_indices(p, d), state->has_faces = true;
    return true;
}

Node *read_mesh2(Parser *p)
{
    Span brace = parse_last_span(p);
    MeshDraft d = {.mesh = parse_alloc(p, sizeof *d.mesh)};
    Mesh2State state = {0};
    do {
        parse_comma(p);
    } while (read_mesh2_list(p, &d, &state));
    if (parse_accept(p, KW_INSIDE_VECTOR))
        read_inside_vector(p, d.mesh);
    if (d.mesh->triangle_count == 0)
        parse_fail(p, brace, "the mesh has no faces");
    share_indices(p, &d, &state, brace);
    drop_flat_faces(p, &d, brace);
    return finish_mesh(p, &d, brace);
}
