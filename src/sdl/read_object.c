/* Objects: which word reads what, and the modifiers they all have.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/read_int.h"

/* --- which object -------------------------------------------------------------------------- */

typedef struct ObjectRule {
    TokenKind word;
    Node *(*read)(Parser *p);
} ObjectRule;

static Node *read_object_of(Parser *p);

static const ObjectRule *object_rule(TokenKind word)
{
    static const ObjectRule rules[] = {
        {KW_SPHERE, read_sphere},
        {KW_BOX, read_box},
        {KW_CYLINDER, read_cylinder},
        {KW_CONE, read_cone},
        {KW_TORUS, read_torus},
        {KW_PLANE, read_plane},
        {KW_DISC, read_disc},
        {KW_BLOB, read_blob},
        {KW_SUPERELLIPSOID, read_superellipsoid},
        {KW_QUADRIC, read_quadric},
        {KW_CUBIC, read_cubic},
        {KW_QUARTIC, read_quartic},
        {KW_POLY, read_poly},
        {KW_POLYNOMIAL, read_polynomial},
        {KW_TRIANGLE, read_triangle},
        {KW_SMOOTH_TRIANGLE, read_smooth_triangle},
        {KW_POLYGON, read_polygon},
        {KW_TEXT, read_text},
        {KW_BICUBIC_PATCH, read_bicubic_patch},
        {KW_PRISM, read_prism},
        {KW_LATHE, read_lathe},
        {KW_SOR, read_sor},
        {KW_OVUS, read_ovus},
        {KW_SPHERE_SWEEP, read_sphere_sweep},
        {KW_HEIGHT_FIELD, read_height_field},
        {KW_MESH, read_mesh},
        {KW_MESH2, read_mesh2},
        {KW_ISOSURFACE, read_isosurface},
        {KW_PARAMETRIC, read_parametric},
        {KW_JULIA_FRACTAL, read_julia_fractal},
        {KW_UNION, read_union},
        {KW_COMPOSITE, read_union},
        {KW_MERGE, read_merge},
        {KW_INTERSECTION, read_intersection},
        {KW_DIFFERENCE, read_difference},
        {KW_OBJECT, read_object_of},
    };
    for (size_t i = 0; i < sizeof rules / sizeof rules[0]; i++)
        if (rules[i].word == word)
            return &rules[i];
    return NULL;
}

/* Read the name of a declared object as a copy of it; NULL if none comes next. */
static Node *read_named_object(Parser *p)
{
    Token head = *parse_peek(p);
    const Value *value = parse_accept_value(p, VALUE_OBJECT);
    if (!value)
        return NULL;
    const Node *declared = value->node;
    SceneBuild *build = parse_build(p);
    build->copies += declared->size;
    if (build->copies > NODE_COPIES_MAX)
        parse_fail(p, head.span, "declared objects are copied too often (limit %d parts)",
                   NODE_COPIES_MAX);
    Node *node = parse_no_null(p, node_copy(parse_arena(p), declared));
    node->span = head.span;
    node->name = read_word(p, &head);
    node->is_named = true;
    return node;
}

/* object { OBJECT ... } */
static Node *read_object_of(Parser *p)
{
    Node *node = read_object_block(p);
    if (!node)
        parse_fail_here(p, "in `object`, which wants an object first");
    return node;
}

Node *read_object_block(Parser *p)
{
    Token head = *parse_peek(p);
    const ObjectRule *rule = object_rule(head.kind);
    if (!rule && head.kind != KW_LIGHT_SOURCE)
        return NULL;
    read_open(p);
    Node *node = read_named_object(p);
    if (!node) {
        node = rule ? rule->read(p) : read_light_source(p);
        if (!node->is_named)
            node->name = read_word(p, &head);
    }
    node->span = head.span;
    /* A light_source has items of its own and has taken its brace with them. */
    if (rule || node->is_named)
        read_object_modifiers(p, node, head.kind);
    return node;
}

Node *read_object(Parser *p)
{
    Node *node = read_named_object(p);
    return node ? node : read_object_block(p);
}

/* --- modifiers ----------------------------------------------------------------------------- */

static const Texture *texture_of(Parser *p, const Node *node)
{
    return node->texture ? node->texture : read_default_texture(p);
}

/* Attach a material: its texture is laid on what is there. */
static void add_material(Parser *p, Node *node)
{
    const Material *material = read_material(p);
    if (material->texture)
        node->texture = read_layers(p, node->texture, material->texture);
    if (material->inner_texture)
        node->inner_texture = material->inner_texture;
    if (material->interior)
        node->interior = material->interior;
}

static void read_interior_texture(Parser *p, Node *node)
{
    Token word = *parse_peek(p);
    if (!node->texture)
        parse_fail(p, word.span, "interior_texture wants a texture before it");
    node->inner_texture = read_layers(p, node->inner_texture, read_texture(p));
}

/* Read a look; returns false if none comes next. */
static bool read_plain_look(Parser *p, Node *node)
{
    switch (parse_peek(p)->kind) {
    case KW_TEXTURE:
        node->texture = read_layers(p, node->texture, read_texture(p));
        return true;
    case KW_PIGMENT: {
        const Texture *texture = texture_of(p, node);
        const Pigment *base = texture->layers[texture->layer_count - 1].pigment;
        node->texture = read_with_pigment(p, texture, read_pigment(p, base));
        return true;
    }
    case KW_FINISH: {
        const Texture *texture = texture_of(p, node);
        const Finish *base = texture->layers[texture->layer_count - 1].finish;
        node->texture = read_with_finish(p, texture, read_finish(p, base));
        return true;
    }
    case KW_INTERIOR_TEXTURE:
        read_interior_texture(p, node);
        return true;
    case KW_INTERIOR:
        node->interior = read_interior(p, node->interior);
        return true;
    case KW_MATERIAL:
        add_material(p, node);
        return true;
    default:
        return false;
    }
}

static void read_cutaway_textures(Parser *p, Node *node)
{
    Token word = parse_next(p);
    if (node->kind != NODE_CSG || node->csg != SHAPE_INTERSECTION)
        parse_fail(p, word.span, "cutaway_textures fits an intersection or difference only");
    node->is_cutaway = true;
}

static void read_uv_mapping(Parser *p, Node *node)
{
    Token word = parse_next(p);
    if (node->texture)
        parse_fail(p, word.span, "uv_mapping wants to stand before the texture");
    node->is_uv = true;
}

bool read_look(Parser *p, Node *node)
{
    if (parse_peek(p)->kind == KW_UV_MAPPING) {
        read_uv_mapping(p, node);
        return true;
    }
    if (!read_plain_look(p, node))
        return false;
    if (node->is_uv && node->texture)
        node->texture = read_texture_as_uv(p, node->texture);
    if (node->is_uv && node->inner_texture)
        node->inner_texture = read_texture_as_uv(p, node->inner_texture);
    return true;
}

static Tri read_tri(Parser *p)
{
    parse_next(p);
    return parse_flag(p) ? TRI_ON : TRI_OFF;
}

static bool read_flag_word(Parser *p)
{
    parse_next(p);
    return parse_flag(p);
}

/* no_shadow has no on or off, unlike its brothers. */
static void read_no_shadow(Parser *p, Node *node)
{
    parse_next(p);
    if (parse_is_expression(p))
        parse_fail(p, parse_peek(p)->span, "no_shadow takes no value");
    node->no_shadow = true;
}

static void read_inverse(Parser *p, Node *node)
{
    Token word = parse_next(p);
    if (!node_is_solid(node))
        parse_warn(p, WARN_GEOMETRY, word.span, "an object without an inside cannot be inverted");
    node_invert(node);
}

/* radiosity { importance F } has an effect only on radiosity, which fails by itself. */
static void read_object_radiosity(Parser *p)
{
    read_open(p);
    while (!read_close(p)) {
        if (!parse_accept(p, KW_IMPORTANCE))
            parse_fail_here(p, "in the radiosity block of an object");
        Span span;
        double importance = read_finite(p, "importance", &span);
        if (!(importance > 0 && importance <= 1))
            parse_fail(p, span, "importance wants a number above 0 and up to 1, got %g",
                       importance);
    }
}

/* Read a modifier of what rays do with the object; returns false if none comes next. */
static bool read_behaviour(Parser *p, Node *node)
{
    switch (parse_peek(p)->kind) {
    case KW_NO_SHADOW:
        read_no_shadow(p, node);
        return true;
    case KW_NO_IMAGE:
        node->no_image = read_flag_word(p);
        return true;
    case KW_NO_REFLECTION:
        node->no_reflection = read_flag_word(p);
        return true;
    case KW_NO_RADIOSITY:
        node->no_radiosity = read_flag_word(p);
        return true;
    case KW_DOUBLE_ILLUMINATE:
        node->double_illuminate = read_tri(p);
        return true;
    case KW_HOLLOW:
        node->hollow = read_tri(p);
        return true;
    case KW_INVERSE:
        read_inverse(p, node);
        return true;
    case KW_RADIOSITY:
        read_object_radiosity(p);
        return true;
    case KW_CUTAWAY_TEXTURES:
        read_cutaway_textures(p, node);
        return true;
    case KW_PHOTONS:
        read_object_photons(p, &node->photons);
        node->has_photons = true;
        return true;
    default:
        return false;
    }
}

/* Does sturm fit a shape?  It chooses how roots of polynomials are found. */
static bool is_sturm_shape(TokenKind word)
{
    return word == KW_TORUS || word == KW_PRISM || word == KW_LATHE || word == KW_SOR ||
           word == KW_OVUS || word == KW_CUBIC || word == KW_QUARTIC || word == KW_POLY ||
           word == KW_POLYNOMIAL || word == KW_BLOB || word == KW_OBJECT;
}

/* Words that choose a method of POV-Ray's and change nothing in what is seen here. */
static bool read_method(Parser *p, TokenKind object_word)
{
    TokenKind kind = parse_peek(p)->kind;
    bool fits = false;
    const char *where = NULL;
    if (kind == KW_STURM) {
        fits = is_sturm_shape(object_word);
        where = "sturm fits shapes made of polynomials only";
    } else if (kind == KW_HIERARCHY) {
        fits = object_word == KW_MESH || object_word == KW_MESH2 || object_word == KW_BLOB ||
               object_word == KW_HEIGHT_FIELD || object_word == KW_OBJECT;
        where = "hierarchy fits a mesh, blob or height_field only";
    } else if (kind == KW_SPLIT_UNION) {
        fits = object_word == KW_UNION || object_word == KW_MERGE || object_word == KW_COMPOSITE ||
               object_word == KW_OBJECT;
        where = "split_union fits a union only";
    } else {
        return false;
    }
    Token word = parse_next(p);
    if (!fits)
        parse_fail(p, word.span, "%s", where);
    parse_flag(p);
    return true;
}

/* A colour among the modifiers did something once. */
static void read_stray_color(Parser *p)
{
    Span span = parse_peek(p)->span;
    parse_color(p);
    parse_warn(p, WARN_LANGUAGE, span, "a colour here has no effect: it belongs in a pigment");
}

static void read_object_modifier(Parser *p, Node *node, TokenKind object_word)
{
    if (parse_is_xform(p)) {
        Xform xform = parse_xform(p);
        if (!node_transform(parse_arena(p), node, &xform))
            parse_no_null(p, NULL);
    } else if (read_look(p, node) || read_behaviour(p, node) || read_method(p, object_word)) {
        return;
    } else if (parse_peek(p)->kind == KW_CLIPPED_BY) {
        read_clipped_by(p, node);
    } else if (parse_peek(p)->kind == KW_BOUNDED_BY) {
        read_bounded_by(p, node);
    } else if (parse_accept(p, KW_DTAG)) {
        parse_string(p);
    } else if (parse_is_color(p)) {
        read_stray_color(p);
    } else {
        parse_fail_here(p, "among the modifiers of an object");
    }
}

void read_object_modifiers(Parser *p, Node *node, TokenKind object_word)
{
    while (!read_close(p))
        read_object_modifier(p, node, object_word);
}

/* --- photons ------------------------------------------------------------------------------- */

void read_object_photons(Parser *p, PhotonFlags *flags)
{
    Token word = read_open(p);
    if (!flags->span.source)
        *flags = PHOTON_FLAGS_DEFAULT;
    flags->span = word.span;
    while (!read_close(p)) {
        switch (parse_peek(p)->kind) {
        case KW_TARGET: {
            parse_next(p);
            double factor = parse_is_expression(p) ? read_not_negative(p, "target") : 1;
            flags->is_target = factor > 0;
            flags->spacing_factor = factor > 0 ? (float)factor : 1;
            break;
        }
        case KW_REFLECTION:
            flags->reflection = read_tri(p);
            break;
        case KW_REFRACTION:
            flags->refraction = read_tri(p);
            break;
        case KW_COLLECT:
            flags->is_collecting = read_flag_word(p);
            break;
        case KW_PASS_THROUGH:
            flags->is_pass_through = read_flag_word(p);
            break;
        default:
            parse_fail_here(p, "in the photons block of an object");
        }
    }
    if (flags->is_pass_through && flags->is_target && flags->refraction == TRI_ON)
        parse_warn(p, WARN_VALUE, word.span,
                   "pass_through and target with refraction contradict each other");
}
