/* Textures: layers of pigment and finish.  SPDX-License-Identifier: Apache-2.0 */
#include "texture/texture.h"

const Texture *texture_transform(Arena *arena, const Texture *texture, const Xform *xform)
{
    Layer *layers =
        arena_copy(arena, texture->layers, (size_t)texture->layer_count * sizeof *texture->layers);
    if (!layers)
        return NULL;
    bool is_changed = false;
    for (int i = 0; i < texture->layer_count; i++) {
        layers[i].pigment = pigment_transform(arena, layers[i].pigment, xform);
        if (!layers[i].pigment)
            return NULL;
        is_changed |= layers[i].pigment != texture->layers[i].pigment;
    }
    if (!is_changed)
        return texture;
    Texture *moved = arena_copy(arena, texture, sizeof *texture);
    if (!moved)
        return NULL;
    moved->layers = layers;
    return moved;
}

bool texture_may_transmit(const Texture *texture)
{
    for (int i = 0; i < texture->layer_count; i++)
        if (!pigment_may_transmit(texture->layers[i].pigment))
            return false;
    return true;
}

bool texture_has_uv(const Texture *texture)
{
    for (int i = 0; i < texture->layer_count; i++)
        if (texture->layers[i].pigment->has_uv)
            return true;
    return false;
}

static bool is_black(const Layer *layer)
{
    const Pigment *pigment = layer->pigment;
    return pigment->is_solid && rgb_is_black(color5_rgb(pigment->color));
}

bool texture_may_scatter(const Texture *texture)
{
    for (int i = 0; i < texture->layer_count; i++) {
        const Finish *finish = texture->layers[i].finish;
        if (!is_black(&texture->layers[i]) && (finish->diffuse > 0 || finish->diffuse_back > 0))
            return true;
    }
    return false;
}

bool texture_may_show_back(const Texture *texture)
{
    for (int i = 0; i < texture->layer_count; i++)
        if (!is_black(&texture->layers[i]) && texture->layers[i].finish->diffuse_back > 0)
            return true;
    return false;
}

bool texture_may_reflect(const Texture *texture)
{
    for (int i = 0; i < texture->layer_count; i++) {
        const Finish *finish = texture->layers[i].finish;
        if (!rgb_is_black(finish->reflection_min) || !rgb_is_black(finish->reflection_max))
            return true;
    }
    return false;
}
