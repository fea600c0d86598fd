/* mesh and mesh2: triangle lists.
 *
 * Both end in one MeshData whose arrays lie in the scene arena.  Triangles without area are
 * dropped.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/read_int.h"
#include "sdl/vector_scan.h"

#include <string.h>

enum { MESH_ITEMS_MAX = 500 * 1000 * 1000 }; /* of one list; far above what memory holds */

/* Finds vectors that are the same to the last bit, so that they need be kept once. */
typedef struct Weld {
    uint32_t *numbers; /* of the vectors, by their hash; UINT32_MAX: nothing there */
    size_t capacity;   /* a power of two */
} Weld;

/* A mesh being read. */
typedef struct MeshDraft {
    MeshData *mesh;
    Weld vertex_weld, normal_weld; /* of a mesh without lists */
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

/* Return a normal as it is kept. */
static V3 unit_normal(Parser *p, MeshDraft *d, V3 normal, Span span)
{
    normal = v3_unit(normal);
    if (v3_len2(normal) > 0)
        return normal;
    if (!d->has_warned_normal)
        parse_warn(p, WARN_GEOMETRY, span, "a normal of the mesh is 0: <1,0,0> is used");
    d->has_warned_normal = true;
    return v3(1, 0, 0);
}

static uint32_t add_normal(Parser *p, MeshDraft *d, V3 unit)
{
    MeshData *m = d->mesh;
    m->normals = read_grow(p, m->normals, d->normal_count, &d->normal_capacity, sizeof *m->normals);
    m->normals[d->normal_count] = unit;
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

/* Make room for `wanted` items in all. */
static void *reserve(Parser *p, void *items, size_t count, size_t wanted, size_t *capacity,
                     size_t item_size)
{
    if (wanted <= *capacity)
        return items;
    *capacity = wanted > 2 * *capacity ? wanted : 2 * *capacity;
    void *grown = parse_alloc(p, *capacity * item_size);
    if (count)
        memcpy(grown, items, count * item_size);
    return grown;
}

/* Append three indices to one of the mesh's corner arrays. */
static uint32_t *add_corners(Parser *p, uint32_t *corners, uint32_t triangle, size_t *capacity,
                             const uint32_t three[3])
{
    size_t count = (size_t)triangle * 3;
    corners = reserve(p, corners, count, count + 3, capacity, sizeof *corners);
    memcpy(corners + count, three, 3 * sizeof *three);
    return corners;
}

/* The same for an array that only some triangles need: it begins with the first that does. */
static uint32_t *add_some_corners(Parser *p, uint32_t *corners, uint32_t triangle, size_t *capacity,
                                  const uint32_t three[3])
{
    if (!corners && three[0] == UINT32_MAX)
        return NULL;
    size_t count = (size_t)triangle * 3;
    if (!corners) {
        corners = reserve(p, corners, 0, count + 3, capacity, sizeof *corners);
        memset(corners, 0xff, count * sizeof *corners);
    }
    return add_corners(p, corners, triangle, capacity, three);
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
    m->normal_corners =
        add_some_corners(p, m->normal_corners, n, &d->normal_corner_capacity, t->normal);
    m->uv_corners = add_some_corners(p, m->uv_corners, n, &d->uv_corner_capacity, t->uv);
    m->textures = add_some_corners(p, m->textures, n, &d->texture_corner_capacity, t->texture);
    d->has_smooth |= t->normal[0] != UINT32_MAX;
    d->has_uv |= t->uv[0] != UINT32_MAX;
    d->has_texture |= t->texture[0] != MESH_NO_TEXTURE;
    m->triangle_count++;
}

/* --- welding ------------------------------------------------------------------------------- */

static size_t weld_place(const Weld *weld, V3 v)
{
    uint64_t bits[3];
    memcpy(bits, &v, sizeof bits);
    uint64_t hash = bits[0];
    for (int i = 1; i < 3; i++)
        hash = (hash ^ (hash >> 29)) * 0x9e3779b97f4a7c15u + bits[i];
    hash = (hash ^ (hash >> 32)) * 0xbf58476d1ce4e5b9u;
    return (size_t)(hash >> 20) & (weld->capacity - 1);
}

/* Return where the number of a vector is, or would be. */
static uint32_t *weld_find(const Weld *weld, const V3 *vectors, V3 v)
{
    size_t place = weld_place(weld, v);
    while (weld->numbers[place] != UINT32_MAX &&
           memcmp(&vectors[weld->numbers[place]], &v, sizeof v) != 0)
        place = (place + 1) & (weld->capacity - 1);
    return &weld->numbers[place];
}

/* Make room for `wanted` vectors, of which there are `count`. */
static void weld_reserve(Parser *p, Weld *weld, const V3 *vectors, uint32_t count, size_t wanted)
{
    if (wanted + wanted / 4 <= weld->capacity)
        return;
    weld->capacity = weld->capacity ? weld->capacity : 64;
    while (weld->capacity < wanted + wanted / 2)
        weld->capacity *= 2;
    weld->numbers = parse_alloc(p, weld->capacity * sizeof *weld->numbers);
    memset(weld->numbers, 0xff, weld->capacity * sizeof *weld->numbers);
    for (uint32_t i = 0; i < count; i++)
        *weld_find(weld, vectors, vectors[i]) = i;
}

static uint32_t weld_vertex(Parser *p, MeshDraft *d, V3 v)
{
    weld_reserve(p, &d->vertex_weld, d->mesh->vertices, d->mesh->vertex_count,
                 (size_t)d->mesh->vertex_count + 1);
    uint32_t *number = weld_find(&d->vertex_weld, d->mesh->vertices, v);
    if (*number == UINT32_MAX)
        *number = add_vertex(p, d, v);
    return *number;
}

static uint32_t weld_normal(Parser *p, MeshDraft *d, V3 v)
{
    weld_reserve(p, &d->normal_weld, d->mesh->normals, d->normal_count,
                 (size_t)d->normal_count + 1);
    uint32_t *number = weld_find(&d->normal_weld, d->mesh->normals, v);
    if (*number == UINT32_MAX)
        *number = add_normal(p, d, v);
    return *number;
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

/* Add a triangle whose other looks are in *t; normal: NULL for a flat one. */
static void keep_triangle(Parser *p, MeshDraft *d, const V3 corner[3], const V3 *normal,
                          MeshTriangle *t, Span span)
{
    if (read_triangle_is_flat(corner)) {
        parse_warn(p, WARN_GEOMETRY, span, "degenerate triangle: it has no area");
        return;
    }
    for (int i = 0; i < 3; i++) {
        t->corner[i] = weld_vertex(p, d, corner[i]);
        t->normal[i] = normal ? weld_normal(p, d, unit_normal(p, d, normal[i], span)) : UINT32_MAX;
    }
    add_triangle(p, d, t);
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
    keep_triangle(p, d, corner, is_smooth ? normal : NULL, &t, word.span);
}

/* Make room for so many more triangles, which share their vertices as those of surfaces do. */
static void expect_triangles(Parser *p, MeshDraft *d, uint32_t more, bool is_smooth)
{
    MeshData *m = d->mesh;
    size_t corners = 3 * (size_t)m->triangle_count, vertices = m->vertex_count;
    size_t wanted = vertices + more / 2 + more / 8;
    if (is_smooth) {
        size_t normals = d->normal_count, want = normals + more / 2 + more / 8;
        m->normals = reserve(p, m->normals, normals, want, &d->normal_capacity, sizeof *m->normals);
        weld_reserve(p, &d->normal_weld, m->normals, d->normal_count, want);
        m->normal_corners = reserve(p, m->normal_corners, corners, corners + 3 * (size_t)more,
                                    &d->normal_corner_capacity, sizeof *m->corners);
        if (!d->has_smooth)
            memset(m->normal_corners, 0xff, corners * sizeof *m->corners);
    }
    m->corners = reserve(p, m->corners, corners, corners + 3 * (size_t)more, &d->corner_capacity,
                         sizeof *m->corners);
    m->vertices =
        reserve(p, m->vertices, vertices, wanted, &d->vertex_capacity, sizeof *m->vertices);
    weld_reserve(p, &d->vertex_weld, m->vertices, m->vertex_count, wanted);
}

/* Triangles of plain vectors, which are one token. */
static void read_plain_triangles(Parser *p, MeshDraft *d)
{
    Token token = parse_next(p);
    const char *text = token.span.source->text, *end = text + token.span.end, *at = token.text;
    expect_triangles(p, d, token.length, *at == 's');
    for (uint32_t i = 0; i < token.length; i++) {
        PlainTriangle plain;
        MeshTriangle t;
        V3 corner[3], normal[3];
        Span span = {token.span.source, (uint32_t)(at - text), 0};
        at = scan_triangle(at, end, &plain);
        span.end = (uint32_t)(at - text);
        at = scan_blanks(at, end);
        for (int k = 0; k < 3; k++) {
            corner[k] = v3(plain.corner[k][0], plain.corner[k][1], plain.corner[k][2]);
            if (plain.is_smooth)
                normal[k] = v3(plain.normal[k][0], plain.normal[k][1], plain.normal[k][2]);
        }
        memcpy(t.uv, no_corners, sizeof t.uv);
        memcpy(t.texture, no_corners, sizeof t.texture);
        keep_triangle(p, d, corner, plain.is_smooth ? normal : NULL, &t, span);
    }
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
        node->part_textures = (const Texture *const *)d->textures;
        node->part_texture_count = (int)d->texture_count;
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
        else if (kind == TOKEN_TRIANGLES)
            read_plain_triangles(p, &d);
        else if (parse_accept(p, KW_INSIDE_VECTOR))
            read_inside_vector(p, d.mesh);
        else
            return finish_mesh(p, &d, brace);
    }
}

/* --- mesh2 --------------------------------------------------------------------------------- */

/* A list of mesh2 being read. */
typedef struct ListReader {
    Parser *p;
    const char *at, *end; /* of plain vectors that are one token */
    uint32_t left;        /* of them */
    uint32_t count;       /* wanted */
} ListReader;

/* Take the word of a list, its brace and its count. */
static ListReader open_list(Parser *p)
{
    read_open(p);
    long count = parse_int(p, "the count of a mesh list", 0, MESH_ITEMS_MAX);
    parse_comma(p);
    return (ListReader){.p = p, .count = (uint32_t)count};
}

/* Take the brace of a list that has been read. */
static void close_list(ListReader *list, const char *word)
{
    if (list->left)
        parse_fail(list->p, parse_last_span(list->p), "%s has more vectors than its count, %u",
                   word, list->count);
    parse_expect(list->p, TOKEN_RBRACE, word);
}

/* Return room for a list: as many items as it says, but no more than its text may have. */
static void *list_room(const ListReader *list, size_t item_size, size_t *capacity)
{
    size_t most = parse_last_span(list->p).source->size;
    *capacity = list->count < most ? list->count : most;
    return *capacity ? parse_alloc(list->p, *capacity * item_size) : NULL;
}

/* Read the next vector of 2 or 3 numbers, and the comma behind it. */
static V3 next_vector(ListReader *list, int size)
{
    Parser *p = list->p;
    double n[3] = {0};
    if (list->left == 0 && parse_peek(p)->kind == TOKEN_VECTORS) {
        Token token = parse_next(p);
        list->at = token.text;
        list->end = token.span.source->text + token.span.end;
        list->left = token.length;
    }
    if (list->left) {
        list->at = scan_vector(list->at, list->end, size, n);
        if (!list->at)
            parse_fail(p, parse_last_span(p), "vectors of %d numbers wanted here", size);
        list->at = scan_blanks(list->at, list->end);
        if (--list->left && *list->at == ',')
            list->at = scan_blanks(list->at + 1, list->end);
    } else if (size == 2) {
        V2 v = parse_v2(p);
        n[0] = v.u, n[1] = v.v;
    } else {
        V3 v = parse_v3(p);
        n[0] = v.x, n[1] = v.y, n[2] = v.z;
    }
    if (list->left == 0)
        parse_comma(p);
    return v3(n[0], n[1], n[2]);
}

/* Warn of a list that has been read before: the later one holds. */
static void warn_again(Parser *p, bool is_again, const char *word)
{
    if (is_again)
        parse_warn(p, WARN_LANGUAGE, parse_peek(p)->span, "a second %s: the first is dropped",
                   word);
}

static void read_vertex_vectors(Parser *p, MeshDraft *d)
{
    warn_again(p, d->mesh->vertex_count > 0, "vertex_vectors");
    ListReader list = open_list(p);
    d->mesh->vertices = list_room(&list, sizeof(V3), &d->vertex_capacity);
    d->mesh->vertex_count = 0;
    for (uint32_t i = 0; i < list.count; i++)
        add_vertex(p, d, next_vector(&list, 3));
    close_list(&list, "vertex_vectors");
}

static void read_normal_vectors(Parser *p, MeshDraft *d)
{
    warn_again(p, d->normal_count > 0, "normal_vectors");
    ListReader list = open_list(p);
    d->mesh->normals = list_room(&list, sizeof(V3), &d->normal_capacity);
    d->normal_count = 0;
    for (uint32_t i = 0; i < list.count; i++) {
        V3 normal = next_vector(&list, 3);
        add_normal(p, d, unit_normal(p, d, normal, parse_last_span(p)));
    }
    close_list(&list, "normal_vectors");
}

static void read_uv_vectors(Parser *p, MeshDraft *d)
{
    warn_again(p, d->uv_count > 0, "uv_vectors");
    ListReader list = open_list(p);
    d->mesh->uvs = list_room(&list, sizeof(V2), &d->uv_capacity);
    d->uv_count = 0;
    for (uint32_t i = 0; i < list.count; i++) {
        V3 v = next_vector(&list, 2);
        add_uv(p, d, (V2){v.x, v.y});
    }
    close_list(&list, "uv_vectors");
}

static void read_texture_list(Parser *p, MeshDraft *d)
{
    warn_again(p, d->texture_count > 0, "texture_list");
    ListReader list = open_list(p);
    d->texture_count = 0;
    for (uint32_t i = 0; i < list.count; i++) {
        if (parse_peek(p)->kind != KW_TEXTURE)
            parse_fail_here(p, "in texture_list, which wants texture blocks");
        const Texture *texture = read_texture(p);
        d->textures =
            read_grow(p, d->textures, d->texture_count, &d->texture_capacity, sizeof *d->textures);
        d->textures[d->texture_count++] = texture;
        parse_comma(p);
    }
    close_list(&list, "texture_list");
}

/* Read one vector of three indices below `limit`. */
static void read_indices(ListReader *list, uint32_t limit, const char *what, uint32_t out[3])
{
    Span first = list->left ? parse_last_span(list->p) : parse_peek(list->p)->span;
    V3 v = next_vector(list, 3);
    const double values[3] = {v.x, v.y, v.z};
    for (int i = 0; i < 3; i++) {
        if (!(values[i] > -1 && values[i] < limit))
            parse_fail(list->p, list->left ? parse_last_span(list->p) : first,
                       "%s %g is out of range: there are %u", what, trunc(values[i]), limit);
        out[i] = (uint32_t)values[i];
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
        /* Without a texture_list a name is that of the next vector. */
        if (d->texture_count == 0 && kind != TOKEN_NUMBER)
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

/* Keep the textures of a face; the list begins with the first face that has some. */
static void keep_textures(ListReader *list, MeshDraft *d, const uint32_t texture[3])
{
    MeshData *m = d->mesh;
    if (!m->textures) {
        if (texture[0] == MESH_NO_TEXTURE)
            return;
        m->textures = parse_alloc(list->p, 3 * (size_t)list->count * sizeof *m->textures);
        memset(m->textures, 0xff, 3 * (size_t)list->count * sizeof *m->textures);
        d->has_texture = true;
    }
    memcpy(m->textures + 3 * (size_t)m->triangle_count, texture, 3 * sizeof *texture);
}

static void read_face_indices(Parser *p, MeshDraft *d)
{
    ListReader list = open_list(p);
    MeshData *m = d->mesh;
    m->corners = list_room(&list, 3 * sizeof *m->corners, &d->corner_capacity);
    d->corner_capacity *= 3;
    for (uint32_t i = 0; i < list.count; i++) {
        uint32_t corner[3], texture[3] = {MESH_NO_TEXTURE, MESH_NO_TEXTURE, MESH_NO_TEXTURE};
        read_indices(&list, m->vertex_count, "vertex", corner);
        if (list.left == 0)
            read_face_textures(p, d, texture);
        m->corners = add_corners(p, m->corners, m->triangle_count, &d->corner_capacity, corner);
        keep_textures(&list, d, texture);
        m->triangle_count++;
    }
    close_list(&list, "face_indices");
}

/* Return room for three numbers a face, none of them given yet. */
static uint32_t *face_room(Parser *p, const MeshDraft *d)
{
    size_t bytes = 3 * (size_t)d->mesh->triangle_count * sizeof(uint32_t);
    uint32_t *room = parse_alloc(p, bytes);
    memset(room, 0xff, bytes);
    return room;
}

/* uv_indices: one for each face. */
static void read_uv_indices(Parser *p, MeshDraft *d)
{
    Span span = parse_peek(p)->span;
    ListReader list = open_list(p);
    if (list.count != d->mesh->triangle_count)
        parse_fail(p, span, "uv_indices wants one for each of the %u faces, got %u",
                   d->mesh->triangle_count, list.count);
    uint32_t *room = d->mesh->uv_corners = face_room(p, d);
    for (uint32_t i = 0; i < list.count; i++)
        read_indices(&list, d->uv_count, "uv vector", room + 3 * (size_t)i);
    d->has_uv |= list.count > 0;
    close_list(&list, "uv_indices");
}

/* normal_indices: for the first faces; the rest stay flat. */
static void read_normal_indices(Parser *p, MeshDraft *d)
{
    Span span = parse_peek(p)->span;
    ListReader list = open_list(p);
    if (list.count > d->mesh->triangle_count)
        parse_fail(p, span, "normal_indices has %u entries for %u faces", list.count,
                   d->mesh->triangle_count);
    uint32_t *room = d->mesh->normal_corners = face_room(p, d);
    for (uint32_t i = 0; i < list.count; i++)
        read_indices(&list, d->normal_count, "normal", room + 3 * (size_t)i);
    d->has_smooth |= list.count > 0;
    close_list(&list, "normal_indices");
}

/* What has been read of a mesh2, besides its arrays. */
typedef struct Mesh2State {
    bool has_faces, has_uv_indices, has_normal_indices;
} Mesh2State;

/* Without indices of their own, uvs and normals go with the vertices. */
static void share_indices(Parser *p, MeshDraft *d, const Mesh2State *state, Span span)
{
    MeshData *m = d->mesh;
    if (!state->has_uv_indices && d->uv_count == m->vertex_count && d->uv_count > 0) {
        m->uv_corners = m->corners;
        d->has_uv = true;
    } else if (!state->has_uv_indices && d->uv_count == 1) {
        m->uv_corners = parse_alloc(p, 3 * (size_t)m->triangle_count * sizeof *m->uv_corners);
        d->has_uv = true;
    } else if (!state->has_uv_indices && d->uv_count > 0) {
        parse_fail(p, span, "%u uv_vectors for %u vertices, and no uv_indices", d->uv_count,
                   m->vertex_count);
    }
    if (!state->has_normal_indices && d->normal_count == m->vertex_count && d->normal_count > 0) {
        m->normal_corners = m->corners;
        d->has_smooth = true;
    } else if (!state->has_normal_indices && d->normal_count > 0) {
        parse_fail(p, span, "%u normal_vectors for %u vertices, and no normal_indices",
                   d->normal_count, m->vertex_count);
    }
}

static bool is_flat_face(const MeshData *m, uint32_t face)
{
    const uint32_t *c = m->corners + 3 * (size_t)face;
    const V3 corner[3] = {m->vertices[c[0]], m->vertices[c[1]], m->vertices[c[2]]};
    return read_triangle_is_flat(corner);
}

/* Move the entries of one list of three numbers a face together that stay. */
static void keep_faces(uint32_t *list, const bool *is_dropped, uint32_t count)
{
    size_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (is_dropped[i])
            continue;
        memmove(list + 3 * kept, list + 3 * (size_t)i, 3 * sizeof *list);
        kept++;
    }
}

/* Drop faces without area, keeping the others in order. */
static void drop_flat_faces(Parser *p, MeshDraft *d, Span span)
{
    MeshData *m = d->mesh;
    uint32_t first = 0, count = m->triangle_count, flat = 0;
    while (first < count && !is_flat_face(m, first))
        first++;
    if (first == count)
        return;
    bool *is_dropped = parse_alloc(p, count);
    for (uint32_t i = first; i < count; i++)
        flat += is_dropped[i] = is_flat_face(m, i);
    /* Lists may be one. */
    uint32_t *uvs = m->uv_corners == m->corners ? NULL : m->uv_corners;
    uint32_t *normals = m->normal_corners == m->corners ? NULL : m->normal_corners;
    uint32_t *lists[4] = {m->corners, uvs, normals, m->textures};
    for (int i = 0; i < 4; i++)
        if (lists[i])
            keep_faces(lists[i], is_dropped, count);
    parse_warn(p, WARN_GEOMETRY, span, "%u degenerate triangles: they have no area", flat);
    m->triangle_count = count - flat;
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
