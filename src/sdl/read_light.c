/* light_source.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/read_int.h"

enum { AREA_SIZE_MAX = 10000, ADAPTIVE_OFF = 100 };

static double radians(double degrees)
{
    return degrees * (PMS_PI / 180);
}

static bool has_direction(const Light *light)
{
    return light->kind != LIGHT_POINT || light->is_parallel;
}

/* spotlight, cylinder and shadowless are one setting: the last one holds. */
static void set_kind(Light *light, LightKind kind)
{
    light->kind = kind;
    light->is_shadowless = false;
    light->tightness = 0;
    if (kind == LIGHT_SPOT) {
        light->radius = radians(30);
        light->falloff = radians(45);
    } else {
        light->radius = 0.75;
        light->falloff = 1;
        light->is_parallel |= kind == LIGHT_CYLINDER;
    }
}

/* Read the angle of a spotlight or the length of a cylinder. */
static double read_spread(Parser *p, const Light *light, const char *what)
{
    Token word = parse_next(p);
    if (light->kind == LIGHT_POINT)
        parse_fail(p, word.span, "%s wants `spotlight` or `cylinder` before it", what);
    double value = read_finite(p, what, NULL);
    return light->kind == LIGHT_SPOT ? radians(value) : value;
}

static void read_tightness(Parser *p, Light *light)
{
    Token word = parse_next(p);
    if (light->kind == LIGHT_POINT)
        parse_fail(p, word.span, "tightness wants `spotlight` or `cylinder` before it");
    light->tightness = read_finite(p, "tightness", NULL);
}

static void read_point_at(Parser *p, Light *light)
{
    Token word = parse_next(p);
    if (!has_direction(light))
        parse_fail(p, word.span, "point_at wants `spotlight`, `cylinder` or `parallel` before it");
    light->point_at = parse_v3(p);
}

/* --- area lights --------------------------------------------------------------------------- */

static int read_area_size(Parser *p)
{
    Span first = parse_peek(p)->span;
    long size = parse_int(p, "a size of an area_light", -AREA_SIZE_MAX, AREA_SIZE_MAX);
    if (size < 1)
        parse_fail(p, span_join(first, parse_last_span(p)),
                   "a size of an area_light wants at least 1, got %ld", size);
    return (int)size;
}

static void read_area_light(Parser *p, Light *light)
{
    parse_next(p);
    light->area.axis1 = parse_v3(p);
    parse_comma(p);
    light->area.axis2 = parse_v3(p);
    parse_comma(p);
    light->area.size1 = read_area_size(p);
    parse_comma(p);
    light->area.size2 = read_area_size(p);
}

/* Levels below 0 or beyond what any grid needs are its ends. */
static int read_adaptive(Parser *p)
{
    long level = parse_int(p, "adaptive", -1000000000, 1000000000);
    return level < 0 ? 0 : level > ADAPTIVE_OFF ? ADAPTIVE_OFF : (int)level;
}

/* The items of area lights; returns false if none comes next. */
static bool read_area_item(Parser *p, Light *light)
{
    switch (parse_peek(p)->kind) {
    case KW_AREA_LIGHT:
        read_area_light(p, light);
        return true;
    case KW_ADAPTIVE:
        parse_next(p);
        light->area.adaptive = read_adaptive(p);
        return true;
    case KW_JITTER:
        parse_next(p);
        light->area.has_jitter = true;
        return true;
    case KW_CIRCULAR:
        parse_next(p);
        light->area.is_circular = true;
        return true;
    case KW_ORIENT:
        parse_next(p);
        light->area.is_oriented = true;
        return true;
    case KW_AREA_ILLUMINATION:
        parse_next(p);
        light->area.has_illumination = parse_flag(p);
        return true;
    default:
        return false;
    }
}

static void check_area(Parser *p, Span span, AreaLight *area)
{
    if (area->is_oriented && !area->is_circular) {
        parse_warn(p, WARN_VALUE, span, "orient wants circular: it is set");
        area->is_circular = true;
    }
    if (area->is_circular && (area->size1 < 2 || area->size2 < 2))
        parse_fail(p, span, "a circular area_light wants at least 2 lamps along each axis");
}

/* --- light_source -------------------------------------------------------------------------- */

static void read_light_photons(Parser *p, Light *light)
{
    read_open(p);
    while (!read_close(p)) {
        switch (parse_peek(p)->kind) {
        case KW_REFLECTION:
            parse_next(p);
            light->photon_reflection = parse_flag(p) ? TRI_ON : TRI_OFF;
            break;
        case KW_REFRACTION:
            parse_next(p);
            light->photon_refraction = parse_flag(p) ? TRI_ON : TRI_OFF;
            break;
        case KW_AREA_LIGHT:
            parse_next(p);
            light->has_area_photons = parse_flag(p);
            break;
        default:
            parse_fail_here(p, "in the photons block of a light");
        }
    }
}

/* The kind of the light and where it shines; returns false if none comes next. */
static bool read_aim_item(Parser *p, Light *light)
{
    switch (parse_peek(p)->kind) {
    case KW_SPOTLIGHT:
        parse_next(p);
        set_kind(light, LIGHT_SPOT);
        return true;
    case KW_CYLINDER:
        parse_next(p);
        set_kind(light, LIGHT_CYLINDER);
        return true;
    case KW_PARALLEL:
        parse_next(p);
        light->is_parallel = true;
        return true;
    case KW_SHADOWLESS:
        parse_next(p);
        set_kind(light, LIGHT_POINT);
        light->is_shadowless = true;
        return true;
    case KW_POINT_AT:
        read_point_at(p, light);
        return true;
    case KW_RADIUS:
        light->radius = read_spread(p, light, "radius");
        return true;
    case KW_FALLOFF:
        light->falloff = read_spread(p, light, "falloff");
        return true;
    case KW_TIGHTNESS:
        read_tightness(p, light);
        return true;
    default:
        return false;
    }
}

/* looks_like { OBJECT modifiers }: the object is moved to where the light is. */
static void read_looks_like(Parser *p, Node *light)
{
    Token word = read_open(p);
    if (light->child_count)
        parse_fail(p, word.span, "a light can look like one object only");
    Node *node = read_object(p);
    if (!node)
        parse_fail_here(p, "in looks_like, which wants an object first");
    read_object_modifiers(p, node, KW_OBJECT);
    Xform move = xform_translate(light->light->location);
    if (!node_transform(parse_arena(p), node, &move))
        parse_no_null(p, NULL);
    light->children = parse_copy(p, &node, sizeof(Node *));
    light->child_count = 1;
    light->size += node->size;
    light->depth = node->depth + 1;
}

static void read_light_item(Parser *p, Node *node)
{
    Light *light = node->light;
    if (parse_is_xform(p)) {
        Xform xform = parse_xform(p);
        if (!node_transform(parse_arena(p), node, &xform))
            parse_no_null(p, NULL);
        return;
    }
    if (read_aim_item(p, light) || read_area_item(p, light))
        return;
    Token head = *parse_peek(p);
    switch (head.kind) {
    case KW_FADE_DISTANCE:
        parse_next(p);
        light->fade_distance = read_not_negative(p, "fade_distance");
        break;
    case KW_FADE_POWER:
        parse_next(p);
        light->fade_power = read_not_negative(p, "fade_power");
        break;
    case KW_PHOTONS:
        read_light_photons(p, light);
        break;
    case KW_MEDIA_ATTENUATION:
        parse_next(p);
        light->is_dimmed_by_media = parse_flag(p);
        break;
    case KW_MEDIA_INTERACTION:
        parse_next(p);
        light->lights_media = parse_flag(p);
        break;
    case KW_LOOKS_LIKE:
        read_looks_like(p, node);
        break;
    case KW_PROJECTED_THROUGH:
        parse_fail_not_yet(p, head.span, "projected_through");
    case KW_COLOR_MAP:
    case KW_COLOUR_MAP:
        parse_fail_not_yet(p, head.span, "color_map in a light");
    default:
        parse_fail_here(p, "in a light_source");
    }
}

Node *read_light_source(Parser *p)
{
    Span brace = parse_last_span(p);
    Node *node = parse_alloc(p, sizeof *node);
    node->kind = NODE_LIGHT;
    node->size = 1;
    Light *light = node->light = parse_alloc(p, sizeof *light);
    *light = (Light){.point_at = {0, 0, 1}, .photon_share = 1, .lights_media = true};
    light->area.adaptive = ADAPTIVE_OFF;
    set_kind(light, LIGHT_POINT);
    light->location = parse_v3(p);
    parse_comma(p);
    light->color = read_rgb(p, "the colour of a light");
    while (!read_close(p))
        read_light_item(p, node);
    check_area(p, brace, &light->area);
    light->direction = v3_unit(v3_sub(light->point_at, light->location));
    return node;
}
