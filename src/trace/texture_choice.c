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
    choice->texture[choice->count] = texture;
    choice->weight[choice->count++] = (float)weight;
}

static const Texture *mesh_texture(const Surface *surface, uint32_t number)
{
    return number == MESH_NO_TEXTURE ? surface->texture : surface->mesh_textures[number];
}

/* The components of a blob that have a field at p. */
static bool choose_blend(const Surface *surface, const Shape *leaf, V3 p, TextureChoice *out)
{
    ShapeBlend blend;
    if (!shape_blend(leaf, p, &blend))
        return false;
    for (int i = 0; i < blend.count; i++)
        add(out, mesh_texture(surface, blend.texture[i]), blend.weight[i]);
    return true;
}

void texture_choose(const Surface *surface, const Shape *leaf, uint32_t part, double u, double v,
                    V3 p, bool is_inside, TextureChoice *out)
{
    out->count = 0;
    if (is_inside && surface->inner_texture) {
        add(out, surface->inner_texture, 1);
        return;
    }
    if (surface->mesh_textures && choose_blend(surface, leaf, p, out))
        return;
    if (!surface->mesh_textures || leaf->kind != SHAPE_MESH || !leaf->u.mesh->textures) {
        out->texture[0] = surface->texture;
        out->weight[0] = 1;
        out->count = 1;
        return;
    }
    /* Corners with textures of their own: a blend by barycentrics. */
    const uint32_t *corners = leaf->u.mesh->textures + 3 * (size_t)part;
    if (corners[0] == corners[1] && corners[0] == corners[2]) {
        add(out, mesh_texture(surface, corners[0]), 1);
        return;
    }
    add(out, mesh_texture(surface, corners[0]), 1 - u - v);
    add(out, mesh_texture(surface, corners[1]), u);
    add(out, mesh_texture(surface, corners[2]), v);
}
