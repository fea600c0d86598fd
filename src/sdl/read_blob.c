/* Blobs and their components.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/read_int.h"

#include "math/eps.h"
#include "shape/mesh.h"

/* A blob while it is read. */
typedef struct BlobDraft {
    BlobComponent *components;
    size_t count, capacity;
    const Texture **textures;
    size_t texture_count, texture_capacity;
    double threshold;
    bool has_textures, has_any;
} BlobDraft;

/* Read a radius of a component: a negative one means its absolute value. */
static double read_component_radius(Parser *p)
{
    Span span;
    double radius = fabs(read_finite(p, "the radius of a component", &span));
    parse_comma(p);
    if (radius == 0)
        parse_warn(p, WARN_GEOMETRY, span, "the radius of a component is 0: it has no field");
    return radius;
}

/* Remember the texture of a component. */
static uint32_t add_texture(Parser *p, BlobDraft *d, const Texture *texture)
{
    if (!texture)
        return MESH_NO_TEXTURE;
    d->has_textures = true;
    if (d->texture_count > 0 && d->textures[d->texture_count - 1] == texture)
        return (uint32_t)d->texture_count - 1;
    d->textures =
        read_grow(p, d->textures, d->texture_count, &d->texture_capacity, sizeof *d->textures);
    d->textures[d->texture_count] = texture;
    return (uint32_t)d->texture_count++;
}

/* Add a component that is placed and scaled by its radius; one without a radius has no field. */
static void add_component(Parser *p, BlobDraft *d, const BlobComponent *component, double radius)
{
    d->has_any = true;
    if (!(radius > 0))
        return;
    d->components = read_grow(p, d->components, d->count, &d->capacity, sizeof *d->components);
    d->components[d->count++] = *component;
}

/* Read the modifiers of a component, up to and including its brace. */
static void read_component_modifiers(Parser *p, BlobDraft *d, BlobComponent *component)
{
    Node node = {.kind = NODE_LEAF}; /* holds the look, as an object does */
    while (!read_close(p)) {
        TokenKind kind = parse_peek(p)->kind;
        if (parse_is_xform(p)) {
            Xform xform = parse_xform(p);
            component->place = xform_then(&component->place, &xform);
            if (!node_transform(parse_arena(p), &node, &xform))
                parse_no_null(p, NULL);
        } else if (!(kind == KW_TEXTURE || kind == KW_PIGMENT || kind == KW_FINISH) ||
                   !read_look(p, &node)) {
            parse_fail_here(p, "among the modifiers of a component of a blob");
        }
    }
    component->texture = add_texture(p, d, node.texture);
}

static double read_strength(Parser *p)
{
    parse_accept(p, KW_STRENGTH);
    double strength = read_finite(p, "the strength of a component", NULL);
    parse_comma(p);
    return strength;
}

static Xform ball_place(V3 center, double radius)
{
    double size = radius > 0 ? radius : 1;
    Xform scale = xform_scale(v3(size, size, size)), move = xform_translate(center);
    return xform_then(&scale, &move);
}

static void read_blob_sphere(Parser *p, BlobDraft *d)
{
    read_open(p);
    BlobComponent c = {.length = 0};
    V3 center = parse_v3(p);
    parse_comma(p);
    double radius = read_component_radius(p);
    c.place = ball_place(center, radius);
    c.strength = read_strength(p);
    read_component_modifiers(p, d, &c);
    add_component(p, d, &c, radius);
}

static void read_blob_cylinder(Parser *p, BlobDraft *d)
{
    read_open(p);
    BlobComponent c = {.length = 0};
    Span first = parse_peek(p)->span;
    V3 from = parse_v3(p), s, t;
    parse_comma(p);
    V3 to = parse_v3(p), along = v3_sub(to, from);
    if (!(v3_len(along) > EPS_LANGUAGE))
        parse_fail(p, span_join(first, parse_last_span(p)),
                   "the two ends of a cylinder are at the same point");
    parse_comma(p);
    double radius = read_component_radius(p), size = radius > 0 ? radius : 1;
    V3 n = v3_unit(along);
    v3_frame(n, &s, &t);
    Xform scale = xform_scale(v3(size, size, size)), frame = xform_frame(s, t, n, from);
    c.place = xform_then(&scale, &frame);
    c.length = v3_len(along) / size;
    c.strength = read_strength(p);
    read_component_modifiers(p, d, &c);
    add_component(p, d, &c, radius);
}

/* component STRENGTH, RADIUS, CENTRE: the old form. */
static void read_blob_component(Parser *p, BlobDraft *d)
{
    parse_next(p);
    BlobComponent c = {.length = 0, .texture = MESH_NO_TEXTURE};
    c.strength = read_finite(p, "the strength of a component", NULL);
    parse_comma(p);
    double radius = read_component_radius(p);
    c.place = ball_place(parse_v3(p), radius);
    parse_comma(p);
    add_component(p, d, &c, radius);
}

static bool read_blob_item(Parser *p, BlobDraft *d)
{
    switch (parse_peek(p)->kind) {
    case KW_THRESHOLD:
        parse_next(p);
        d->threshold = read_finite(p, "threshold", NULL);
        parse_comma(p);
        return true;
    case KW_SPHERE:
        read_blob_sphere(p, d);
        return true;
    case KW_CYLINDER:
        read_blob_cylinder(p, d);
        return true;
    case KW_COMPONENT:
        read_blob_component(p, d);
        return true;
    default:
        return false;
    }
}

Node *read_blob(Parser *p)
{
    BlobDraft d = {.threshold = 1};
    Span brace = parse_last_span(p);
    while (read_blob_item(p, &d))
        parse_comma(p);
    if (!d.has_any && parse_peek(p)->kind != TOKEN_RBRACE)
        parse_fail_here(p, "in a blob, which wants a component first");
    if (!d.has_any)
        parse_fail(p, brace, "a blob wants at least one component");
    if (d.count == 0)
        return read_empty(p);
    Node *node = read_leaf(p, shape_blob(parse_arena(p), d.threshold, d.components,
                                         (uint32_t)d.count, d.has_textures));
    if (d.has_textures) {
        node->part_textures = (const Texture *const *)d.textures;
        node->part_texture_count = (int)d.texture_count;
    }
    return node;
}
