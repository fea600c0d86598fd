/* interior and material.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/read_int.h"

enum { SAMPLES_MAX = 1000 };

double read_ior(Parser *p)
{
    Span span;
    double ior = read_finite(p, "ior", &span);
    if (ior > 0)
        return ior;
    parse_warn(p, WARN_VALUE, span, "ior wants a number above 0, got %g: 1 is used", ior);
    return 1;
}

/* The last of ior, dispersion and a formula holds. */
static void read_dispersion(Parser *p, Interior *interior)
{
    Span span;
    parse_next(p);
    double ratio = read_finite(p, "dispersion", &span);
    if (!(ratio > 0)) {
        parse_warn(p, WARN_VALUE, span, "dispersion wants a number above 0, got %g: 1 is used",
                   ratio);
        ratio = 1;
    }
    interior->dispersion = ratio == 1 ? DISPERSION_NONE : DISPERSION_RATIO;
    interior->coefficients[0] = ratio;
}

static void read_interior_ior(Parser *p, Interior *interior)
{
    parse_next(p);
    interior->ior = read_ior(p);
    interior->has_ior = true;
    if (interior->dispersion != DISPERSION_RATIO)
        interior->dispersion = DISPERSION_NONE;
}

static void read_interior_item(Parser *p, Interior *interior)
{
    Token head = *parse_peek(p);
    switch (head.kind) {
    case KW_IOR:
        read_interior_ior(p, interior);
        break;
    case KW_CAUSTICS:
        parse_next(p);
        interior->caustics = (float)read_not_negative(p, "caustics");
        break;
    case KW_FADE_DISTANCE:
        parse_next(p);
        interior->fade_distance = read_not_negative(p, "fade_distance");
        break;
    case KW_FADE_POWER:
        parse_next(p);
        interior->fade_power = read_not_negative(p, "fade_power");
        break;
    case KW_FADE_COLOR:
    case KW_FADE_COLOUR:
        parse_next(p);
        interior->fade_color = read_rgb(p, "fade_color");
        break;
    case KW_DISPERSION:
        read_dispersion(p, interior);
        break;
    case KW_DISPERSION_SAMPLES:
        parse_next(p);
        interior->dispersion_samples = (int)parse_int(p, "dispersion_samples", 2, SAMPLES_MAX);
        break;
    case KW_MEDIA:
        interior->media = (const Medium *const *)read_append(
            p, (const void *const *)interior->media, &interior->media_count, read_media(p));
        break;
    default:
        if (!read_is_word(&head, "pms"))
            parse_fail_here(p, "in an interior");
        read_pms_interior(p, interior);
    }
}

const Interior *read_interior(Parser *p, const Interior *base_or_null)
{
    Token word = read_open(p);
    Interior interior = base_or_null ? *base_or_null : INTERIOR_DEFAULT;
    const Value *value = parse_accept_value(p, VALUE_INTERIOR);
    if (value)
        interior = *(const Interior *)value->node;
    interior.span = word.span;
    while (!read_close(p))
        read_interior_item(p, &interior);
    return parse_copy(p, &interior, sizeof interior);
}

static void move_material(Parser *p, Material *material)
{
    Xform xform = parse_xform(p);
    if (material->texture)
        material->texture =
            parse_no_null(p, texture_transform(parse_arena(p), material->texture, &xform));
    if (material->inner_texture)
        material->inner_texture =
            parse_no_null(p, texture_transform(parse_arena(p), material->inner_texture, &xform));
    if (material->interior)
        material->interior =
            parse_no_null(p, interior_transform(parse_arena(p), material->interior, &xform));
}

static void read_material_item(Parser *p, Material *material)
{
    if (parse_is_xform(p)) {
        move_material(p, material);
        return;
    }
    Token head = *parse_peek(p);
    switch (head.kind) {
    case KW_TEXTURE:
        material->texture = read_layers(p, material->texture, read_texture(p));
        break;
    case KW_INTERIOR_TEXTURE:
        if (!material->texture)
            parse_fail(p, head.span, "interior_texture wants a texture before it");
        material->inner_texture = read_layers(p, material->inner_texture, read_texture(p));
        break;
    case KW_INTERIOR:
        material->interior = read_interior(p, material->interior);
        break;
    default:
        parse_fail_here(p, "in a material");
    }
}

const Material *read_material(Parser *p)
{
    read_open(p);
    Material material = {0};
    const Value *value = parse_accept_value(p, VALUE_MATERIAL);
    if (value)
        material = *(const Material *)value->node;
    while (!read_close(p))
        read_material_item(p, &material);
    return parse_copy(p, &material, sizeof material);
}
