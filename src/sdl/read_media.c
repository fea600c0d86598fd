/* media and density.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/read_int.h"

enum { INTERVALS_MAX = 10000, SAMPLES_MAX = 10000, AA_LEVEL_MAX = 30 };

/* Of density_maps in one another: with each level a place has twice as many. */
enum { COST_MAX = 1000 };

/* --- density ------------------------------------------------------------------------------ */

static const Pigment *white_pigment(Parser *p, Span span)
{
    Pigment pigment = {.span = span, .is_solid = true, .color = {1, 1, 1, 0, 0}};
    return parse_copy(p, &pigment, sizeof pigment);
}

static void move_density(Parser *p, Density *density)
{
    Xform xform = parse_xform(p);
    const Density copy = *density;
    *density = *(const Density *)parse_no_null(
        p, density_transform(parse_arena(p), parse_copy(p, &copy, sizeof copy), &xform));
}

static void read_density_item(Parser *p, Density *density)
{
    Token head = *parse_peek(p);
    if (parse_is_xform(p)) {
        move_density(p, density);
        return;
    }
    if (head.kind == KW_DENSITY_MAP) {
        const Density *map = read_density_map(p);
        if (density->pigment->is_solid || density->pigment->list)
            parse_fail(p, head.span, "a density_map wants a pattern like gradient before it");
        density->map = map->map;
        density->map_count = map->map_count;
        density->cost = map->cost;
        return;
    }
    if (head.kind == KW_COLOR_MAP || head.kind == KW_COLOUR_MAP)
        density->map = NULL;
    Pigment pigment = *density->pigment;
    read_pigment_modifier(p, &pigment);
    density->pigment = parse_copy(p, &pigment, sizeof pigment);
}

/* What stands in the braces of a density, or in the brackets of a density_map. */
static const Density *read_density_body(Parser *p, Span span, TokenKind end)
{
    Density density = {.pigment = white_pigment(p, span)};
    const Value *value = parse_accept_value(p, VALUE_DENSITY);
    if (value)
        density = *(const Density *)value->node;
    Pigment pigment = *density.pigment;
    if (read_pigment_type(p, &pigment)) {
        density = (Density){.pigment = parse_copy(p, &pigment, sizeof pigment)};
    }
    while (!parse_accept(p, end))
        read_density_item(p, &density);
    return parse_copy(p, &density, sizeof density);
}

const Density *read_density(Parser *p)
{
    Token word = read_open(p);
    return read_density_body(p, word.span, TOKEN_RBRACE);
}

/* How many patterns a map looks at for a place between two of its entries. */
static int map_cost(const DensityEntry *entries, size_t count)
{
    int most = 0;
    for (size_t i = 0; i < count; i++) {
        int before = i > 0 ? 1 + entries[i - 1].density->cost : 0;
        int own = before + 1 + entries[i].density->cost;
        most = own > most ? own : most;
    }
    return most;
}

const Density *read_density_map(Parser *p)
{
    Token word = read_open(p);
    const Value *value = parse_accept_value(p, VALUE_DENSITY_MAP);
    if (value) {
        const Density *map = value->node; /* before the value is forgotten */
        parse_expect(p, TOKEN_RBRACE, "density_map");
        return map;
    }
    DensityEntry *entries = NULL;
    size_t count = 0, capacity = 0;
    while (!read_close(p)) {
        Token bracket = parse_expect(p, TOKEN_LBRACKET, "density_map");
        entries = read_grow(p, entries, count, &capacity, sizeof *entries);
        entries[count].key = (float)read_finite(p, "a key of a density_map", NULL);
        parse_comma(p);
        entries[count++].density = read_density_body(p, bracket.span, TOKEN_RBRACKET);
    }
    if (count == 0)
        parse_fail(p, word.span, "a density_map wants at least one entry");
    Density map = {.map = entries, .map_count = (int)count, .cost = map_cost(entries, count)};
    if (map.cost > COST_MAX)
        parse_fail(p, word.span,
                   "density_maps in one another make %d patterns of a place, more than %d",
                   map.cost, COST_MAX);
    return parse_copy(p, &map, sizeof map);
}

/* --- media -------------------------------------------------------------------------------- */

static Rgb read_coefficient(Parser *p, const char *what)
{
    Token word = parse_next(p);
    Rgb value = read_rgb(p, what);
    if (rgb_min(value) < 0)
        parse_fail(p, span_join(word.span, parse_last_span(p)),
                   "%s of a media wants numbers of at least 0", what);
    return value;
}

static double read_eccentricity(Parser *p, PhaseKind phase)
{
    Token word = parse_next(p);
    Span span;
    double value = read_finite(p, "eccentricity", &span);
    if (phase != PHASE_HENYEY_GREENSTEIN)
        parse_fail(p, word.span, "eccentricity fits scattering of type 5 only");
    if (!(fabs(value) < 1))
        parse_fail(p, span, "eccentricity wants a number between -1 and 1, got %g", value);
    return value;
}

/* scattering { TYPE, RGB items } */
static void read_scattering(Parser *p, Medium *medium)
{
    read_open(p);
    medium->phase = (PhaseKind)parse_int(p, "the type of a scattering", PHASE_ISOTROPIC,
                                         PHASE_HENYEY_GREENSTEIN);
    medium->eccentricity = 0;
    medium->extinction = 1;
    parse_comma(p);
    Span first = parse_peek(p)->span;
    medium->scattering = read_rgb(p, "scattering");
    if (rgb_min(medium->scattering) < 0)
        parse_fail(p, span_join(first, parse_last_span(p)),
                   "scattering of a media wants numbers of at least 0");
    while (!read_close(p)) {
        parse_comma(p);
        if (parse_peek(p)->kind == KW_ECCENTRICITY)
            medium->eccentricity = (float)read_eccentricity(p, medium->phase);
        else if (parse_accept(p, KW_EXTINCTION))
            medium->extinction = (float)read_not_negative(p, "extinction");
        else
            parse_fail_here(p, "in a scattering");
    }
}

/* samples LEAST [, MOST]: the most is found from the error. */
static void read_samples(Parser *p, Medium *medium)
{
    Token word = parse_next(p);
    medium->samples = (int)parse_int(p, "samples", 1, SAMPLES_MAX);
    parse_comma(p);
    if (!parse_is_expression(p))
        return;
    long most = parse_int(p, "samples", 1, SAMPLES_MAX);
    if (most < medium->samples)
        parse_fail(p, span_join(word.span, parse_last_span(p)),
                   "samples wants the smaller number first, got %d and %ld", medium->samples, most);
}

static double read_confidence(Parser *p)
{
    Span span;
    double value = read_finite(p, "confidence", &span);
    if (!(value >= 0 && value < 1))
        parse_fail(p, span, "confidence wants a number from 0 to below 1, got %g", value);
    return value;
}

/* Settings of POV-Ray's ways of sampling, of which pms has one of its own. */
static bool read_unused(Parser *p)
{
    Token word = *parse_peek(p);
    const char *name;
    double standard;
    if (word.kind == KW_METHOD) {
        parse_next(p);
        standard = 3;
        if (parse_int(p, "method", 1, 3) == 3)
            return true;
        name = "method";
    } else if (word.kind == KW_RATIO || word.kind == KW_JITTER) {
        parse_next(p);
        name = word.kind == KW_RATIO ? "ratio" : "jitter";
        standard = word.kind == KW_RATIO ? 0.9 : 0;
        if (word.kind == KW_JITTER && !parse_is_expression(p))
            standard = -1;
        else if (read_finite(p, name, NULL) == standard)
            return true;
    } else {
        return false;
    }
    parse_warn(p, WARN_LANGUAGE, word.span,
               "%s has no effect in pms: where a media is sampled follows from the error", name);
    return true;
}

/* How finely the medium is sampled; returns false if none of these comes next. */
static bool read_sampling(Parser *p, Medium *medium)
{
    switch (parse_peek(p)->kind) {
    case KW_INTERVALS:
        parse_next(p);
        medium->intervals = (int)parse_int(p, "intervals", 1, INTERVALS_MAX);
        return true;
    case KW_SAMPLES:
        read_samples(p, medium);
        return true;
    case KW_CONFIDENCE:
        parse_next(p);
        medium->confidence = (float)read_confidence(p);
        return true;
    case KW_VARIANCE:
        parse_next(p);
        medium->variance = (float)read_above_zero(p, "variance");
        return true;
    case KW_AA_THRESHOLD:
        parse_next(p);
        medium->aa_threshold = (float)read_above_zero(p, "aa_threshold");
        return true;
    case KW_AA_LEVEL:
        parse_next(p);
        medium->aa_level = (int)parse_int(p, "aa_level", 1, AA_LEVEL_MAX);
        return true;
    default:
        return read_unused(p);
    }
}

static void move_medium(Parser *p, Medium *medium)
{
    Xform xform = parse_xform(p);
    const Medium copy = *medium;
    *medium = *(const Medium *)parse_no_null(
        p, medium_transform(parse_arena(p), parse_copy(p, &copy, sizeof copy), &xform));
}

static void read_media_item(Parser *p, Medium *medium)
{
    if (parse_is_xform(p)) {
        move_medium(p, medium);
        return;
    }
    if (read_sampling(p, medium))
        return;
    switch (parse_peek(p)->kind) {
    case KW_ABSORPTION:
        medium->absorption = read_coefficient(p, "absorption");
        break;
    case KW_EMISSION:
        medium->emission = read_coefficient(p, "emission");
        break;
    case KW_SCATTERING:
        read_scattering(p, medium);
        break;
    case KW_DENSITY:
        medium->densities = (const Density *const *)read_append(
            p, (const void *const *)medium->densities, &medium->density_count, read_density(p));
        break;
    case KW_COLLECT:
        parse_next(p);
        medium->is_collecting = parse_flag(p);
        break;
    default:
        parse_fail_here(p, "in a media");
    }
}

const Medium *read_media(Parser *p)
{
    Token word = read_open(p);
    Medium medium = MEDIUM_DEFAULT;
    const Value *value = parse_accept_value(p, VALUE_MEDIA);
    if (value)
        medium = *(const Medium *)value->node;
    medium.span = word.span;
    while (!read_close(p))
        read_media_item(p, &medium);
    return parse_copy(p, &medium, sizeof medium);
}
