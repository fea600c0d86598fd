/* texture: layers of pigment and finish.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/read_int.h"

#include <string.h>

/* Make a texture whose top layer is another. */
static const Texture *with_top(Parser *p, const Texture *texture, Layer top)
{
    size_t count = (size_t)texture->layer_count;
    Layer *layers = parse_copy(p, texture->layers, count * sizeof *layers);
    layers[count - 1] = top;
    Texture *changed = parse_copy(p, texture, sizeof *texture);
    changed->layers = layers;
    return changed;
}

static Layer top_of(const Texture *texture)
{
    return texture->layers[texture->layer_count - 1];
}

const Texture *read_with_pigment(Parser *p, const Texture *texture, const Pigment *pigment)
{
    return with_top(p, texture, (Layer){pigment, top_of(texture).finish});
}

const Texture *read_with_finish(Parser *p, const Texture *texture, const Finish *finish)
{
    return with_top(p, texture, (Layer){top_of(texture).pigment, finish});
}

const Texture *read_texture_as_uv(Parser *p, const Texture *texture)
{
    size_t count = (size_t)texture->layer_count;
    Layer *layers = parse_copy(p, texture->layers, count * sizeof *layers);
    for (size_t i = 0; i < count; i++)
        layers[i].pigment = read_as_uv(p, layers[i].pigment);
    Texture *mapped = parse_copy(p, texture, sizeof *texture);
    mapped->layers = layers;
    return mapped;
}

const Texture *read_layers(Parser *p, const Texture *under, const Texture *over)
{
    if (!under)
        return over;
    if (over->is_uv)
        parse_fail(p, over->span,
                   "a texture with uv_mapping may lie on no other: give it to the "
                   "pigment, or to the object");
    size_t lower = (size_t)under->layer_count, upper = (size_t)over->layer_count;
    if (lower + upper > TEXTURE_LAYERS_MAX)
        parse_fail(p, over->span, "a texture of %d layers (limit %d)", (int)(lower + upper),
                   TEXTURE_LAYERS_MAX);
    Layer *layers = parse_alloc(p, (lower + upper) * sizeof *layers);
    memcpy(layers, under->layers, lower * sizeof *layers);
    memcpy(layers + lower, over->layers, upper * sizeof *layers);
    Texture *both = parse_copy(p, under, sizeof *under);
    both->layers = layers;
    both->layer_count = (int)(lower + upper);
    return both;
}

const Texture *read_default_texture(Parser *p)
{
    return parse_no_null(p, scene_build_default(parse_build(p)));
}

/* Read the name of a pigment or finish that stands bare in a texture. */
static bool read_named_part(Parser *p, const Texture **texture)
{
    const Value *value = parse_accept_value(p, VALUE_PIGMENT);
    if (value) {
        *texture = read_with_pigment(p, *texture, value->node);
        return true;
    }
    value = parse_accept_value(p, VALUE_FINISH);
    if (value)
        *texture = read_with_finish(p, *texture, value->node);
    return value != NULL;
}

/* Read one item of a texture; *texture becomes a new one. */
static void read_texture_item(Parser *p, const Texture **texture)
{
    if (parse_is_xform(p)) {
        Xform xform = parse_xform(p);
        *texture = parse_no_null(p, texture_transform(parse_arena(p), *texture, &xform));
        return;
    }
    if (read_named_part(p, texture))
        return;
    Token head = *parse_peek(p);
    switch (head.kind) {
    case KW_PIGMENT:
        *texture = read_with_pigment(p, *texture, read_pigment(p, top_of(*texture).pigment));
        break;
    case KW_FINISH:
        *texture = read_with_finish(p, *texture, read_finish(p, top_of(*texture).finish));
        break;
    case KW_CHECKER:
    case KW_GRADIENT:
        parse_fail_not_yet(p, head.span, "patterns of whole textures");
    default:
        parse_fail_here(p, "in a texture");
    }
}

const Texture *read_texture(Parser *p)
{
    Token word = read_open(p);
    bool is_uv = parse_accept(p, KW_UV_MAPPING);
    const Value *value = parse_accept_value(p, VALUE_TEXTURE);
    const Texture *base = value ? value->node : read_default_texture(p);
    Texture *own = parse_copy(p, base, sizeof *base);
    own->span = word.span;
    own->is_uv |= is_uv;
    const Texture *texture = own;
    while (!read_close(p))
        read_texture_item(p, &texture);
    return is_uv ? read_texture_as_uv(p, texture) : texture;
}
