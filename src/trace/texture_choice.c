/* Which texture a surface shows at a point.  SPDX-License-Identifier: Apache-2.0 */
#include "trace/trace_int.h"

static void add(TextureChoice *choice, const Texture *texture, double weight)
{
    for (int i = 0; i < choice->count; i++) {
        if (choice->texture[i] == texture) {
            choice->weight[i] += (float)weight;
            return;
        }
    }
    if (choice->count == SHAPE_BLEND_MAX)
        return;
    choice->texture[choice->count] = texture;
    choice->weight[choice->count++] = (float)weight;
}

static const Texture *part_texture(const Surface *surface, uint32_t number)
{
    return number == MESH_NO_TEXTURE ? surface->texture : surface->part_textures[number];
}

/* The components of a blob that have a field at p. */
static bool choose_blend(const Surface *surface, const Shape *leaf, V3 p, TextureChoice *out)
{
    ShapeBlend blend;
    if (!shape_blend(leaf, p, &blend))
        return false;
    for (int i = 0; i < blend.count; i++)
        add(out, part_texture(surface, blend.texture[i]), blend.weight[i]);
    return true;
}

/* The solids that hold p, alike; false if there is none. */
static bool choose_cut(const Cutaway *cutaway, V3 p, TextureChoice *out)
{
    for (int i = 0; i < cutaway->count; i++)
        if (shape_is_inside(cutaway->solids[i], p))
            add(out, cutaway->textures[i], 1);
    float sum = 0;
    for (int i = 0; i < out->count; i++)
        sum += out->weight[i];
    for (int i = 0; i < out->count; i++)
        out->weight[i] /= sum;
    return out->count > 0;
}

static void choose(const Surface *surface, const Shape *leaf, uint32_t part, double u, double v,
                   V3 p, bool is_inside, TextureChoice *out)
{
    if (is_inside && surface->inner_texture) {
        add(out, surface->inner_texture, 1);
        return;
    }
    if (surface->cutaway ? choose_cut(surface->cutaway, p, out)
                         : surface->part_textures && choose_blend(surface, leaf, p, out))
        return;
    if (!surface->part_textures || surface->cutaway || leaf->kind != SHAPE_MESH ||
        !leaf->u.mesh->textures) {
        out->texture[0] = surface->texture;
        out->weight[0] = 1;
        out->count = 1;
        return;
    }
    /* Corners with textures of their own: a blend by barycentrics. */
    const uint32_t *corners = leaf->u.mesh->textures + 3 * (size_t)part;
    if (corners[0] == corners[1] && corners[0] == corners[2]) {
        add(out, part_texture(surface, corners[0]), 1);
        return;
    }
    add(out, part_texture(surface, corners[0]), 1 - u - v);
    add(out, part_texture(surface, corners[1]), u);
    add(out, part_texture(surface, corners[2]), v);
}

void texture_choose(const Surface *surface, const Shape *leaf, uint32_t part, double u, double v,
                    V3 p, bool is_inside, TextureChoice *out)
{
    out->count = 0;
    choose(surface, leaf, part, u, v, p, is_inside, out);
    out->uv = (V2){0, 0};
    for (int i = 0; i < out->count; i++) {
        if (texture_has_uv(out->texture[i])) {
            out->uv = shape_uv(leaf, part, u, v, p);
            return;
        }
    }
}
