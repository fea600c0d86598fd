/* fog and rainbow.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/read_int.h"

#define RAINBOW_FAR 1e7 /* the language's distance when none is written, scene units */

static double radians(double degrees)
{
    return degrees * (PMS_PI / 180);
}

static V3 read_way(Parser *p, const char *what)
{
    Span first = parse_next(p).span;
    V3 way = v3_unit(parse_v3(p));
    if (!(v3_len2(way) > 0))
        parse_fail(p, span_join(first, parse_last_span(p)), "%s is 0", what);
    return way;
}

/* --- fog ---------------------------------------------------------------------------------- */

/* Fog is the same everywhere on a level: only the way up can be moved. */
static void move_fog(Parser *p, Fog *fog)
{
    Span span = parse_peek(p)->span;
    bool is_translation = parse_peek(p)->kind == KW_TRANSLATE;
    Xform xform = parse_xform(p);
    if (is_translation) {
        parse_warn(p, WARN_LANGUAGE, span, "fog cannot be translated: fog_offset moves it");
        return;
    }
    fog->up = v3_unit(xform_dir(&xform, fog->up));
}

static void read_fog_turbulence(Parser *p)
{
    Token word = parse_next(p);
    V3 amount = parse_v3(p);
    if (v3_len2(amount) > 0)
        parse_fail_not_yet(p, word.span, "turbulence in a fog");
}

static void read_fog_type(Parser *p, Fog *fog)
{
    Token word = parse_next(p);
    long type = parse_int(p, "fog_type", -1000000000, 1000000000);
    if (type != 1 && type != 2)
        parse_warn(p, WARN_VALUE, word.span, "fog_type wants 1 or 2, got %ld: 1 is used", type);
    fog->is_ground = type == 2;
}

static void read_fog_item(Parser *p, Fog *fog)
{
    if (parse_is_xform(p)) {
        move_fog(p, fog);
        return;
    }
    switch (parse_peek(p)->kind) {
    case KW_FOG_TYPE:
        read_fog_type(p, fog);
        break;
    case KW_DISTANCE:
        parse_next(p);
        fog->distance = read_not_negative(p, "the distance of a fog");
        break;
    case KW_FOG_ALT:
        parse_next(p);
        fog->altitude = read_finite(p, "fog_alt", NULL);
        break;
    case KW_FOG_OFFSET:
        parse_next(p);
        fog->offset = read_finite(p, "fog_offset", NULL);
        break;
    case KW_UP:
        fog->up = read_way(p, "the way up of a fog");
        break;
    case KW_TURBULENCE:
        read_fog_turbulence(p);
        break;
    case KW_TURB_DEPTH: /* of turbulence, which fails by itself */
    case KW_OCTAVES:
    case KW_OMEGA:
    case KW_LAMBDA:
        parse_next(p);
        read_finite(p, "this item of turbulence", NULL);
        break;
    default:
        if (!parse_is_color(p))
            parse_fail_here(p, "in a fog");
        fog->color = parse_color(p);
    }
}

const Fog *read_fog(Parser *p)
{
    Token word = read_open(p);
    Fog fog = {.up = {0, 1, 0}};
    const Value *value = parse_accept_value(p, VALUE_FOG);
    if (value)
        fog = *(const Fog *)value->node;
    fog.span = word.span;
    while (!read_close(p))
        read_fog_item(p, &fog);
    if (fog.is_ground && !(fog.altitude > 0))
        parse_fail(p, word.span, "a fog of type 2 wants a fog_alt above 0");
    return parse_copy(p, &fog, sizeof fog);
}

/* --- rainbow ------------------------------------------------------------------------------ */

/* Read degrees from 0 to `most`. */
static double read_angle(Parser *p, const char *what, double most)
{
    parse_next(p);
    Span span;
    double value = read_finite(p, what, &span);
    if (!(value >= 0 && value <= most))
        parse_fail(p, span, "%s wants an angle of 0 to %g degrees, got %g", what, most, value);
    return radians(value);
}

/* What is read of a rainbow besides what it is made into. */
typedef struct RainbowDraft {
    Rainbow bow;
    bool has_direction, has_falloff;
} RainbowDraft;

static void read_rainbow_map(Parser *p, Rainbow *bow)
{
    const ColorMap *map = read_color_map(p);
    bow->map = map->entries;
    bow->map_count = map->count;
}

static void read_rainbow_item(Parser *p, RainbowDraft *draft)
{
    Rainbow *bow = &draft->bow;
    switch (parse_peek(p)->kind) {
    case KW_DIRECTION:
        bow->toward = read_way(p, "the direction of a rainbow");
        draft->has_direction = true;
        break;
    case KW_ANGLE:
        bow->angle = read_angle(p, "angle", 360);
        break;
    case KW_WIDTH:
        bow->width = read_angle(p, "width", 360);
        break;
    case KW_DISTANCE:
        parse_next(p);
        bow->distance = read_above_zero(p, "the distance of a rainbow");
        break;
    case KW_JITTER:
        parse_next(p);
        bow->jitter = read_not_negative(p, "jitter");
        break;
    case KW_UP:
        bow->up = read_way(p, "the way up of a rainbow");
        break;
    case KW_ARC_ANGLE:
        bow->arc = read_angle(p, "arc_angle", 360) / 2;
        break;
    case KW_FALLOFF_ANGLE:
        bow->falloff = read_angle(p, "falloff_angle", 360) / 2;
        draft->has_falloff = true;
        break;
    case KW_COLOR_MAP:
    case KW_COLOUR_MAP:
        read_rainbow_map(p, bow);
        break;
    default:
        parse_fail_here(p, "in a rainbow");
    }
}

const Rainbow *read_rainbow(Parser *p)
{
    Token word = read_open(p);
    RainbowDraft draft = {
        .bow = {.up = {0, 1, 0}, .arc = PMS_PI, .falloff = PMS_PI, .distance = RAINBOW_FAR}};
    Rainbow *bow = &draft.bow;
    const Value *value = parse_accept_value(p, VALUE_RAINBOW);
    if (value) {
        *bow = *(const Rainbow *)value->node;
        draft.has_direction = draft.has_falloff = true;
    }
    bow->span = word.span;
    while (!read_close(p))
        read_rainbow_item(p, &draft);
    if (!draft.has_direction)
        parse_fail(p, word.span, "a rainbow wants a direction");
    if (!draft.has_falloff)
        bow->falloff = bow->arc;
    if (bow->arc < bow->falloff)
        parse_fail(p, word.span, "the arc_angle of a rainbow is smaller than its falloff_angle");
    bow->right = v3_unit(v3_cross(bow->up, bow->toward));
    if (!(v3_len2(bow->right) > 0))
        parse_fail(p, word.span, "the direction of a rainbow is its way up");
    bow->up = v3_cross(bow->toward, bow->right);
    return parse_copy(p, bow, sizeof *bow);
}
