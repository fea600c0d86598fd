/* background and sky_sphere: what rays that meet nothing see.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/read_int.h"

void read_background(Parser *p)
{
    Token word = read_open(p);
    Background *background = &parse_scene(p)->background;
    if (background->is_given)
        parse_warn(p, WARN_LANGUAGE, word.span, "a second background: the last one holds");
    background->color = parse_color(p);
    background->is_given = true;
    background->span = word.span;
    parse_expect(p, TOKEN_RBRACE, "background");
}

static void move_sky(Parser *p, const Pigment **pigments, size_t count)
{
    Xform xform = parse_xform(p);
    for (size_t i = 0; i < count; i++)
        pigments[i] = parse_no_null(p, pigment_transform(parse_arena(p), pigments[i], &xform));
}

const Sky *read_sky_sphere(Parser *p)
{
    Token word = read_open(p);
    const Value *value = parse_accept_value(p, VALUE_SKY);
    Sky *sky = parse_alloc(p, sizeof *sky);
    *sky = value ? *(const Sky *)value->node : (Sky){.emission = RGB_WHITE};
    sky->span = word.span;
    size_t count = (size_t)sky->pigment_count, capacity = count;
    const Pigment **pigments =
        parse_copy(p, sky->pigments ? (const void *)sky->pigments : "", count * sizeof *pigments);
    const Texture *base = read_default_texture(p);
    while (!read_close(p)) {
        if (parse_is_xform(p)) {
            move_sky(p, pigments, count);
        } else if (parse_peek(p)->kind == KW_PIGMENT) {
            pigments = read_grow(p, pigments, count, &capacity, sizeof *pigments);
            pigments[count++] = read_pigment(p, base->layers[base->layer_count - 1].pigment);
        } else if (parse_accept(p, KW_EMISSION)) {
            sky->emission = read_rgb(p, "emission");
        } else {
            parse_fail_here(p, "in a sky_sphere");
        }
    }
    if (count == 0)
        parse_fail(p, word.span, "a sky_sphere wants at least one pigment");
    sky->pigments = (const Pigment *const *)pigments;
    sky->pigment_count = (int)count;
    return sky;
}
