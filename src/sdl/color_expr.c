/* Colours in all their spellings.
 *
 *     color = [ "color" | "colour" ] item { item }
 *     item  = ( "rgb" | "rgbf" | "rgbt" | "rgbft" | "srgb" ... | nothing ) full
 *           | ( "red" | "green" | "blue" | "filter" | "transmit" | "alpha" ) short
 *
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"

#include <math.h>
#include <string.h>

enum { RED, GREEN, BLUE, FILTER, TRANSMIT, CHANNELS };

/* Return the channel a word sets, or -1. */
static int channel_of(TokenKind kind)
{
    switch ((int)kind) {
    case KW_RED:
        return RED;
    case KW_GREEN:
        return GREEN;
    case KW_BLUE:
        return BLUE;
    case KW_FILTER:
    case KW_ALPHA:
        return FILTER;
    case KW_TRANSMIT:
        return TRANSMIT;
    default:
        return -1;
    }
}

static bool is_srgb_word(TokenKind kind)
{
    return kind == KW_SRGB || kind == KW_SRGBF || kind == KW_SRGBT || kind == KW_SRGBFT;
}

/* Return how many numbers a word of the rgb family wants, or 0. */
static int size_of(TokenKind kind)
{
    switch ((int)kind) {
    case KW_RGB:
    case KW_SRGB:
        return 3;
    case KW_RGBF:
    case KW_RGBT:
    case KW_SRGBF:
    case KW_SRGBT:
        return 4;
    case KW_RGBFT:
    case KW_SRGBFT:
        return 5;
    default:
        return 0;
    }
}

bool is_color_word(TokenKind kind)
{
    return kind == KW_COLOR || kind == KW_COLOUR || size_of(kind) > 0 || channel_of(kind) >= 0;
}

bool parse_is_color(Parser *p)
{
    return is_color_word(parse_peek(p)->kind) || peek_value_kind(p) == VALUE_COLOR;
}

/* From the sRGB curve to the scene's working space. */
static double from_srgb(Parser *p, double x)
{
    const SceneSettings *settings = &p->scene->settings;
    double linear = x < 0.04045 ? x / 12.92 : pow((x + 0.055) / 1.055, 2.4);
    return settings->assumed_gamma == 1 ? linear : pow(linear, 1 / settings->assumed_gamma);
}

static void decode_srgb(Parser *p, Terms *color, Span word)
{
    if (!p->scene->settings.has_assumed_gamma)
        parse_fail(p, word,
                   "`srgb` colours need `global_settings { assumed_gamma ... }` before them");
    for (int i = RED; i <= BLUE; i++)
        color->n[i] = from_srgb(p, color->n[i]);
}

/* A word of the rgb family and its numbers. */
static void take_rgb(Parser *p, Terms *out)
{
    Token word = parse_next(p);
    int size = size_of(word.kind);
    Span begin = parse_peek(p)->span;
    Terms given;
    parse_full(p, &given);
    if (given.count > size)
        parse_warn(p, WARN_VALUE, span_join(begin, p->last), "%s wants %d numbers, got %d",
                   token_kind_text(word.kind), size, given.count);
    bool is_transmit = word.kind == KW_RGBT || word.kind == KW_SRGBT;
    for (int i = 0; i < CHANNELS; i++) {
        bool is_filled = given.count == 1 && i < size;
        out->n[i] = is_filled ? given.n[0] : i < given.count ? given.n[i] : 0;
    }
    if (is_transmit) {
        out->n[TRANSMIT] = out->n[FILTER];
        out->n[FILTER] = 0;
    }
    if (is_srgb_word(word.kind))
        decode_srgb(p, out, word.span);
}

/* A float fills all five channels, a vector is padded with 0. */
static void take_bare(Parser *p, Terms *out)
{
    Terms given;
    parse_full(p, &given);
    for (int i = 0; i < CHANNELS; i++)
        out->n[i] = i < given.count ? given.n[i] : given.count == 1 ? given.n[0] : 0;
}

static void take_channels(Parser *p, Terms *out)
{
    int channel;
    while ((channel = channel_of(peek_operator(p)->kind)) >= 0) {
        Token word = parse_next(p);
        if (word.kind == KW_ALPHA)
            parse_warn(p, WARN_LANGUAGE, word.span, "`alpha` is an old name of `filter`");
        out->n[channel] = parse_float(p);
    }
}

static void check_finite(Parser *p, const Terms *color, Span begin)
{
    for (int i = 0; i < CHANNELS; i++)
        if (!isfinite((float)color->n[i]))
            parse_fail(p, span_join(begin, p->last), "a part of this colour is %g", color->n[i]);
}

void parse_color_form(Parser *p, Terms *out)
{
    Span begin = parse_peek(p)->span;
    *out = (Terms){.count = CHANNELS};
    if (!parse_accept(p, KW_COLOR))
        parse_accept(p, KW_COLOUR);
    TokenKind kind = parse_peek(p)->kind;
    if (size_of(kind))
        take_rgb(p, out);
    else if (channel_of(kind) < 0)
        take_bare(p, out);
    take_channels(p, out);
    check_finite(p, out, begin);
}

Color5 parse_color(Parser *p)
{
    Terms c;
    parse_color_form(p, &c);
    return (Color5){(float)c.n[RED], (float)c.n[GREEN], (float)c.n[BLUE], (float)c.n[FILTER],
                    (float)c.n[TRANSMIT]};
}

Rgb parse_rgb(Parser *p)
{
    Span begin = parse_peek(p)->span;
    bool is_color = parse_is_color(p);
    Color5 color = parse_color(p);
    if (is_color && (color.filter != 0 || color.transmit != 0))
        parse_warn(p, WARN_VALUE, span_join(begin, p->last),
                   "filter and transmit mean nothing here");
    return color5_rgb(color);
}
