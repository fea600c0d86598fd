/* The statements of a scene, the blocks that can be declared, and #default.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/read_int.h"

/* --- top level ----------------------------------------------------------------------------- */

static void read_camera_statement(Parser *p)
{
    Scene *scene = parse_scene(p);
    Span span = parse_peek(p)->span;
    const Camera *camera = read_camera(p);
    if (scene->camera.span.source)
        parse_warn(p, WARN_LANGUAGE, span, "a second camera: the last one holds");
    scene->camera = *camera;
}

static void read_sky_statement(Parser *p)
{
    Scene *scene = parse_scene(p);
    Span span = parse_peek(p)->span;
    const Sky *sky = read_sky_sphere(p);
    if (scene->sky.pigments)
        parse_warn(p, WARN_LANGUAGE, span, "a second sky_sphere: the last one holds");
    scene->sky = *sky;
}

/* Old scenes have these settings at top level; they never had an effect there. */
static void read_stray_setting(Parser *p)
{
    Token word = parse_next(p);
    read_finite(p, "this setting", NULL);
    parse_warn(p, WARN_LANGUAGE, word.span, "this belongs in global_settings: it is ignored");
}

/* A declared fog may be finished by whoever uses it; one in the scene is not. */
static const Fog *read_fog_statement(Parser *p)
{
    const Fog *fog = read_fog(p);
    if (!(fog->distance > 0))
        parse_warn(p, WARN_VALUE, fog->span, "a fog without a distance is not seen");
    return fog;
}

static const Rainbow *read_rainbow_statement(Parser *p)
{
    const Rainbow *bow = read_rainbow(p);
    if (bow->map_count == 0)
        parse_warn(p, WARN_VALUE, bow->span, "a rainbow without a color_map is not seen");
    else if (!(bow->width > 0))
        parse_warn(p, WARN_VALUE, bow->span, "a rainbow without a width is not seen");
    return bow;
}

/* media, fog and rainbow add up. */
static void read_atmosphere(Parser *p, TokenKind word)
{
    Atmosphere *air = &parse_scene(p)->atmosphere;
    if (word == KW_MEDIA)
        air->media = (const Medium *const *)read_append(p, (const void *const *)air->media,
                                                        &air->media_count, read_media(p));
    else if (word == KW_FOG)
        air->fogs = (const Fog *const *)read_append(p, (const void *const *)air->fogs,
                                                    &air->fog_count, read_fog_statement(p));
    else
        air->rainbows = (const Rainbow *const *)read_append(
            p, (const void *const *)air->rainbows, &air->rainbow_count, read_rainbow_statement(p));
}

void read_statement(Parser *p)
{
    switch (parse_peek(p)->kind) {
    case KW_CAMERA:
        read_camera_statement(p);
        return;
    case KW_BACKGROUND:
        read_background(p);
        return;
    case KW_SKY_SPHERE:
        read_sky_statement(p);
        return;
    case KW_MEDIA:
    case KW_FOG:
    case KW_RAINBOW:
        read_atmosphere(p, parse_peek(p)->kind);
        return;
    case KW_GLOBAL_SETTINGS:
        read_global_settings(p);
        return;
    case KW_MAX_TRACE_LEVEL:
    case KW_MAX_INTERSECTIONS:
        read_stray_setting(p);
        return;
    default:
        break;
    }
    Node *node = read_object(p);
    if (!node)
        parse_fail_here(p, "at top level");
    if (!scene_build_add(parse_build(p), node))
        parse_no_null(p, NULL);
}

/* --- values -------------------------------------------------------------------------------- */

static void set_value(Value *out, ValueKind kind, const void *node, Span span)
{
    *out = (Value){.kind = kind, .node = node, .span = span};
}

/* texture { } texture { }: the layers of one value. */
static const Texture *read_texture_value(Parser *p)
{
    const Texture *texture = read_texture(p);
    while (parse_is_next(p, KW_TEXTURE))
        texture = read_layers(p, texture, read_texture(p));
    return texture;
}

static const Xform *read_transform_value(Parser *p)
{
    Xform xform = parse_xform(p);
    return parse_copy(p, &xform, sizeof xform);
}

static const Pigment *read_pigment_value(Parser *p)
{
    const Texture *base = read_default_texture(p);
    return read_pigment(p, base->layers[base->layer_count - 1].pigment);
}

static const Finish *read_finish_value(Parser *p)
{
    const Texture *base = read_default_texture(p);
    return read_finish(p, base->layers[base->layer_count - 1].finish);
}

bool read_value(Parser *p, Value *out)
{
    Span span = parse_peek(p)->span;
    switch (parse_peek(p)->kind) {
    case KW_TEXTURE:
        set_value(out, VALUE_TEXTURE, read_texture_value(p), span);
        return true;
    case KW_PIGMENT:
        set_value(out, VALUE_PIGMENT, read_pigment_value(p), span);
        return true;
    case KW_FINISH:
        set_value(out, VALUE_FINISH, read_finish_value(p), span);
        return true;
    case KW_INTERIOR:
        set_value(out, VALUE_INTERIOR, read_interior(p, NULL), span);
        return true;
    case KW_MATERIAL:
        set_value(out, VALUE_MATERIAL, read_material(p), span);
        return true;
    case KW_TRANSFORM:
        set_value(out, VALUE_TRANSFORM, read_transform_value(p), span);
        return true;
    case KW_CAMERA:
        set_value(out, VALUE_CAMERA, read_camera(p), span);
        return true;
    case KW_SKY_SPHERE:
        set_value(out, VALUE_SKY, read_sky_sphere(p), span);
        return true;
    case KW_COLOR_MAP:
    case KW_COLOUR_MAP:
        set_value(out, VALUE_COLOR_MAP, read_color_map(p), span);
        return true;
    case KW_MEDIA:
        set_value(out, VALUE_MEDIA, read_media(p), span);
        return true;
    case KW_DENSITY:
        set_value(out, VALUE_DENSITY, read_density(p), span);
        return true;
    case KW_DENSITY_MAP:
        set_value(out, VALUE_DENSITY_MAP, read_density_map(p), span);
        return true;
    case KW_FOG:
        set_value(out, VALUE_FOG, read_fog(p), span);
        return true;
    case KW_RAINBOW:
        set_value(out, VALUE_RAINBOW, read_rainbow(p), span);
        return true;
    default:
        break;
    }
    const Node *node = read_object_block(p);
    if (node)
        set_value(out, VALUE_OBJECT, node, span);
    return node != NULL;
}

/* --- #default ------------------------------------------------------------------------------ */

static void read_default_item(Parser *p, const Texture **texture)
{
    Token head = *parse_peek(p);
    const Layer top = (*texture)->layers[(*texture)->layer_count - 1];
    switch (head.kind) {
    case KW_TEXTURE:
        *texture = read_texture(p);
        if ((*texture)->layer_count != 1)
            parse_fail(p, head.span, "the default texture may have one layer only");
        break;
    case KW_PIGMENT:
        *texture = read_with_pigment(p, *texture, read_pigment(p, top.pigment));
        break;
    case KW_FINISH:
        *texture = read_with_finish(p, *texture, read_finish(p, top.finish));
        break;
    case KW_CAMERA:
        parse_fail_not_yet(p, head.span, "a default camera");
    default:
        parse_fail_here(p, "in #default");
    }
}

void read_default(Parser *p)
{
    while (!read_close(p)) {
        const Texture *texture = read_default_texture(p);
        read_default_item(p, &texture);
        parse_build(p)->default_texture = texture;
    }
}
