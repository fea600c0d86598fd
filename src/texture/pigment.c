/* Pigments: a colour for every point of space.  SPDX-License-Identifier: Apache-2.0 */
#include "texture/texture.h"

static float mix(float a, float b, float t)
{
    return a + t * (b - a);
}

/* Look v up in a map in written order: at and past the last key its colour, below the first
 * key the first colour, between two a straight mix of all five channels. */
static Color5 map_color(const MapEntry *map, int count, double v)
{
    if (v >= (double)map[count - 1].key)
        return map[count - 1].color;
    int i = 0;
    while (i < count - 1 && !((double)map[i].key >= v))
        i++;
    const MapEntry *b = &map[i];
    if (i == 0 || (double)b->key == v)
        return b->color;
    const MapEntry *a = b - 1;
    float t = (float)((v - (double)a->key) / ((double)b->key - (double)a->key));
    return (Color5){mix(a->color.r, b->color.r, t), mix(a->color.g, b->color.g, t),
                    mix(a->color.b, b->color.b, t), mix(a->color.filter, b->color.filter, t),
                    mix(a->color.transmit, b->color.transmit, t)};
}

Color5 pigment_map_color(const Pigment *pigment, double value)
{
    return map_color(pigment->map, pigment->map_count, value);
}

Color5 pigment_at(const Pigment *pigment, V3 p)
{
    return pigment_at_uv(pigment, p, (V2){p.x, p.y});
}

Color5 pigment_at_uv(const Pigment *pigment, V3 p, V2 uv)
{
    /* Lists nest: walk down without recursion. */
    while (!pigment->is_solid) {
        if (pigment->is_uv)
            p = v3(uv.u, uv.v, 0);
        double v = pattern_value(&pigment->pattern, p);
        if (!pigment->list)
            return map_color(pigment->map, pigment->map_count, v);
        p = pattern_point(&pigment->pattern, p);
        int last = pigment->list_count - 1;
        pigment = pigment->list[v >= last ? last : v > 0 ? (int)v : 0];
    }
    return pigment->color;
}

const Pigment *pigment_transform(Arena *arena, const Pigment *pigment, const Xform *xform)
{
    if (pigment->is_solid || pigment->is_uv || xform_is_identity(xform))
        return pigment;
    Pigment *moved = arena_copy(arena, pigment, sizeof *pigment);
    if (!moved)
        return NULL;
    Pattern *pattern = &moved->pattern;
    pattern->xform = pattern->is_transformed ? xform_then(&pattern->xform, xform) : *xform;
    pattern->is_transformed = true;
    return moved;
}

static bool color_transmits(Color5 c)
{
    return c.filter != 0 || c.transmit != 0;
}

bool pigment_may_transmit(const Pigment *pigment)
{
    if (pigment->is_solid)
        return color_transmits(pigment->color);
    for (int i = 0; i < pigment->map_count; i++)
        if (color_transmits(pigment->map[i].color))
            return true;
    for (int i = 0; i < pigment->list_count; i++)
        if (pigment_may_transmit(pigment->list[i]))
            return true;
    return false;
}
