/* pigment, its patterns and colour maps.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/read_int.h"

/* --- color_map ----------------------------------------------------------------------------- */

typedef struct MapDraft {
    MapEntry *entries;
    size_t count, capacity;
} MapDraft;

static void add_entry(Parser *p, MapDraft *d, float key, Color5 color)
{
    d->entries = read_grow(p, d->entries, d->count, &d->capacity, sizeof *d->entries);
    d->entries[d->count++] = (MapEntry){key, color};
}

/* [ F COLOR ], or the old [ F F COLOR COLOR ] from one key to the next. */
static void read_map_entry(Parser *p, MapDraft *d)
{
    parse_expect(p, TOKEN_LBRACKET, "color_map");
    float key = (float)read_finite(p, "a key of a color_map", NULL);
    parse_comma(p);
    Color5 color = parse_color(p);
    parse_comma(p);
    if (parse_is_color(p)) {
        /* What looked like a colour was the second key. */
        add_entry(p, d, key, parse_color(p));
        key = color.r;
        parse_comma(p);
        color = parse_color(p);
    }
    add_entry(p, d, key, color);
    parse_expect(p, TOKEN_RBRACKET, "an entry of a color_map");
}

const ColorMap *read_color_map(Parser *p)
{
    Token word = read_open(p);
    const Value *value = parse_accept_value(p, VALUE_COLOR_MAP);
    if (value) {
        const ColorMap *map = value->node; /* before the value is forgotten */
        parse_expect(p, TOKEN_RBRACE, "color_map");
        return map;
    }
    MapDraft d = {0};
    while (!read_close(p))
        read_map_entry(p, &d);
    if (d.count == 0)
        parse_fail(p, word.span, "a color_map wants at least one entry");
    ColorMap *map = parse_alloc(p, sizeof *map);
    *map = (ColorMap){d.entries, (int)d.count};
    return map;
}

/* --- patterns ------------------------------------------------------------------------------ */

static Color5 color5(float r, float g, float b)
{
    return (Color5){r, g, b, 0, 0};
}

static const Pigment *solid_pigment(Parser *p, Color5 color, Span span)
{
    Pigment *pigment = parse_alloc(p, sizeof *pigment);
    *pigment = (Pigment){.span = span, .is_solid = true, .color = color};
    return pigment;
}

static Pattern plain_pattern(PatternKind kind, float frequency)
{
    return (Pattern){.kind = kind, .frequency = frequency, .exponent = 1, .xform = XFORM_IDENTITY};
}

/* Read one item of a list pattern: a colour, a pigment or density; NULL if none comes next. */
static const Pigment *read_list_item(Parser *p)
{
    Span span = parse_peek(p)->span;
    if (parse_peek(p)->kind == KW_PIGMENT)
        return read_pigment(p, solid_pigment(p, color5(0, 0, 0), span));
    if (parse_peek(p)->kind == KW_DENSITY) {
        const Density *density = read_density(p);
        if (density->map)
            parse_fail_not_yet(p, span, "a density_map in a list of densities");
        return density->pigment;
    }
    if (parse_is_color(p) || parse_is_expression(p))
        return solid_pigment(p, parse_color(p), span);
    return NULL;
}

/* checker [ITEM [ITEM]]: blue and green fill what is left out. */
static void read_checker(Parser *p, Pigment *pigment)
{
    Token word = parse_next(p);
    const Pigment **list = parse_alloc(p, 2 * sizeof *list);
    list[0] = solid_pigment(p, color5(0, 0, 1), word.span);
    list[1] = solid_pigment(p, color5(0, 1, 0), word.span);
    for (int i = 0; i < 2; i++) {
        const Pigment *item = read_list_item(p);
        if (!item)
            break;
        list[i] = item;
        parse_comma(p);
    }
    *pigment = (Pigment){.span = pigment->span,
                         .pattern = plain_pattern(PATTERN_CHECKER, 0),
                         .list = (const Pigment *const *)list,
                         .list_count = 2};
}

/* gradient V: black to white along it unless a map follows. */
static void read_gradient(Parser *p, Pigment *pigment)
{
    parse_next(p);
    Span first = parse_peek(p)->span;
    V3 direction = v3_unit(parse_v3(p));
    if (!(v3_len2(direction) > 0))
        parse_fail(p, span_join(first, parse_last_span(p)), "the direction of a gradient is 0");
    MapEntry *map = parse_alloc(p, 2 * sizeof *map);
    map[1] = (MapEntry){1, color5(1, 1, 1)};
    *pigment = (Pigment){.span = pigment->span,
                         .pattern = plain_pattern(PATTERN_GRADIENT, 1),
                         .map = map,
                         .map_count = 2};
    pigment->pattern.direction = direction;
}

bool read_pigment_type(Parser *p, Pigment *pigment)
{
    Token head = *parse_peek(p);
    if (head.kind == KW_CHECKER) {
        read_checker(p, pigment);
    } else if (head.kind == KW_GRADIENT) {
        read_gradient(p, pigment);
    } else if (parse_is_color(p)) {
        *pigment = (Pigment){.span = pigment->span, .is_solid = true, .color = parse_color(p)};
    } else {
        if (head.kind == TOKEN_LESS || head.kind == TOKEN_NUMBER)
            parse_fail(p, head.span, "a pigment wants `rgb` or `color` before numbers");
        return false;
    }
    return true;
}

/* --- modifiers ----------------------------------------------------------------------------- */

static bool read_wave(Parser *p, Pattern *pattern)
{
    switch (parse_peek(p)->kind) {
    case KW_RAMP_WAVE:
        pattern->wave = WAVE_RAMP;
        break;
    case KW_TRIANGLE_WAVE:
        pattern->wave = WAVE_TRIANGLE;
        break;
    case KW_SINE_WAVE:
        pattern->wave = WAVE_SINE;
        break;
    case KW_SCALLOP_WAVE:
        pattern->wave = WAVE_SCALLOP;
        break;
    case KW_CUBIC_WAVE:
        pattern->wave = WAVE_CUBIC;
        break;
    case KW_POLY_WAVE:
        parse_next(p);
        pattern->wave = WAVE_POLY;
        pattern->exponent = parse_is_expression(p) ? (float)read_finite(p, "poly_wave", NULL) : 1;
        return true;
    default:
        return false;
    }
    parse_next(p);
    return true;
}

static void read_map_modifier(Parser *p, Pigment *pigment)
{
    Span span = parse_peek(p)->span;
    const ColorMap *map = read_color_map(p);
    if (pigment->is_solid || pigment->list)
        parse_fail(p, span, "a color_map wants a pattern like gradient before it");
    pigment->map = map->entries;
    pigment->map_count = map->count;
}

/* A transform may replace *pigment. */
void read_pigment_modifier(Parser *p, Pigment *pigment)
{
    if (parse_is_xform(p)) {
        Xform xform = parse_xform(p);
        *pigment = *(const Pigment *)parse_no_null(
            p, pigment_transform(parse_arena(p), parse_copy(p, pigment, sizeof *pigment), &xform));
        return;
    }
    if (read_wave(p, &pigment->pattern))
        return;
    Token head = *parse_peek(p);
    switch (head.kind) {
    case KW_COLOR_MAP:
    case KW_COLOUR_MAP:
        read_map_modifier(p, pigment);
        break;
    case KW_FREQUENCY:
        parse_next(p);
        pigment->pattern.frequency = (float)read_finite(p, "frequency", NULL);
        break;
    case KW_PHASE:
        parse_next(p);
        pigment->pattern.phase = (float)read_finite(p, "phase", NULL);
        break;
    case KW_QUICK_COLOR: /* for previews, which pms does not make */
    case KW_QUICK_COLOUR:
        parse_next(p);
        parse_color(p);
        break;
    case KW_TURBULENCE:
        parse_fail_not_yet(p, head.span, "turbulence in a pigment");
    default:
        parse_fail_here(p, "in a pigment");
    }
}

/* Does the pigment, or one of its list, see uv? */
static bool sees_uv(const Pigment *pigment)
{
    bool has_uv = pigment->is_uv;
    for (int i = 0; i < pigment->list_count; i++)
        has_uv |= pigment->list[i]->has_uv;
    return has_uv;
}

const Pigment *read_as_uv(Parser *p, const Pigment *pigment)
{
    if (pigment->is_solid || pigment->is_uv)
        return pigment;
    Pigment *mapped = parse_copy(p, pigment, sizeof *pigment);
    mapped->is_uv = mapped->has_uv = true;
    return mapped;
}

const Pigment *read_pigment(Parser *p, const Pigment *base)
{
    Token word = read_open(p);
    bool is_uv = parse_accept(p, KW_UV_MAPPING); /* transforms in the block come before it */
    Pigment pigment = *base;
    pigment.span = word.span;
    const Value *value = parse_accept_value(p, VALUE_PIGMENT);
    if (value)
        pigment = *(const Pigment *)value->node;
    bool has_type = read_pigment_type(p, &pigment);
    if (!value && !has_type && parse_peek(p)->kind == TOKEN_RBRACE)
        parse_warn(p, WARN_LANGUAGE, word.span, "the pigment is empty");
    while (!read_close(p))
        read_pigment_modifier(p, &pigment);
    pigment.has_uv = sees_uv(&pigment);
    const Pigment *kept = parse_copy(p, &pigment, sizeof pigment);
    return is_uv ? read_as_uv(p, kept) : kept;
}
