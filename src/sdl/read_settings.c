/* global_settings, with photons{} and pms{}.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/read_int.h"

enum { TRACE_LEVEL_MAX = 256, GATHER_MAX = 1000000, PHOTONS_MAX = 2000000000 };

/* --- photons ------------------------------------------------------------------------------- */

static void read_gather(Parser *p, PhotonSettings *photons)
{
    Span first = parse_next(p).span;
    photons->gather_min = (int)parse_int(p, "gather", 0, GATHER_MAX);
    parse_comma(p);
    photons->gather_max = (int)parse_int(p, "gather", 0, GATHER_MAX);
    if (photons->gather_min > photons->gather_max && photons->gather_max > 0)
        parse_fail(p, span_join(first, parse_last_span(p)),
                   "gather wants the smaller number first, got %d and %d", photons->gather_min,
                   photons->gather_max);
}

/* radius F [, F [, F [, F]]]: gather radius, its factor, and both again for media. */
static void read_photon_radius(Parser *p, PhotonSettings *photons)
{
    Token word = parse_next(p);
    double radius = parse_is_expression(p) ? read_finite(p, "radius", NULL) : 0;
    photons->radius = radius > 0 ? radius : 0;
    for (int i = 1; i < 4; i++) {
        parse_comma(p);
        if (!parse_is_expression(p))
            return;
        double value = read_finite(p, "radius", NULL);
        if (i == 2)
            photons->media_radius = value > 0 ? value : 0;
        else if (value != 1)
            parse_warn(p, WARN_LANGUAGE, word.span, "the factors of radius have no effect in pms");
    }
}

/* media STEPS [FACTOR]: any steps at all make photons stay in media; pms chooses how many. */
static void read_photon_media(Parser *p, PhotonSettings *photons)
{
    Token word = parse_next(p);
    photons->media_steps = read_not_negative(p, "media");
    parse_comma(p);
    if (parse_is_expression(p) && read_above_zero(p, "the factor of media") != 1)
        parse_warn(p, WARN_LANGUAGE, word.span, "the factor of media has no effect in pms");
}

/* pms takes the nearest photons there are; it does not widen its search by trial. */
static void read_expand_thresholds(Parser *p)
{
    Token word = parse_next(p);
    read_finite(p, "expand_thresholds", NULL);
    parse_comma(p);
    read_finite(p, "expand_thresholds", NULL);
    parse_warn(p, WARN_LANGUAGE, word.span, "expand_thresholds has no effect in pms");
}

static int read_trace_level(Parser *p)
{
    Token word = parse_next(p);
    long level = parse_int(p, "max_trace_level", -1000000000, 1000000000);
    if (level >= 1 && level <= TRACE_LEVEL_MAX)
        return (int)level;
    long used = level < 1 ? 1 : TRACE_LEVEL_MAX;
    parse_warn(p, WARN_VALUE, word.span, "max_trace_level wants 1 to %d, got %ld: %ld is used",
               TRACE_LEVEL_MAX, level, used);
    return (int)used;
}

/* A number of photons.  `on` is one in this language, and hardly meant. */
static long read_photon_count(Parser *p, const char *what, long lowest)
{
    const Token first = *parse_peek(p);
    bool is_flag = first.kind == KW_ON || first.kind == KW_YES || first.kind == KW_TRUE;
    long count = parse_int(p, what, lowest, PHOTONS_MAX);
    if (is_flag && count == 1)
        parse_warn(p, WARN_VALUE, first.span, "%s wants a number of photons; `%s` is one photon",
                   what, keyword_text(first.kind));
    return count;
}

/* *spacing gets the place of spacing. */
static void read_photon_item(Parser *p, PhotonSettings *photons, Span *spacing)
{
    Token head = *parse_peek(p);
    switch (head.kind) {
    case KW_SPACING:
        *spacing = parse_next(p).span;
        photons->spacing = read_above_zero(p, "spacing");
        break;
    case KW_COUNT:
        parse_next(p);
        photons->count = read_photon_count(p, "count", 0);
        break;
    case KW_GATHER:
        read_gather(p, photons);
        break;
    case KW_JITTER:
        parse_next(p);
        photons->jitter = read_not_negative(p, "jitter");
        break;
    case KW_AUTOSTOP:
        parse_next(p);
        photons->autostop = read_not_negative(p, "autostop");
        break;
    case KW_MAX_TRACE_LEVEL:
        photons->max_trace_level = read_trace_level(p);
        break;
    case KW_ADC_BAILOUT:
        parse_next(p);
        photons->adc_bailout = read_not_negative(p, "adc_bailout");
        break;
    case KW_RADIUS:
        read_photon_radius(p, photons);
        break;
    case KW_MEDIA:
        read_photon_media(p, photons);
        break;
    case KW_EXPAND_THRESHOLDS:
        read_expand_thresholds(p);
        break;
    default:
        parse_fail_here(p, "in photons");
    }
}

void read_global_photons(Parser *p, PhotonSettings *photons)
{
    Token word = read_open(p);
    photons->span = word.span;
    Span spacing = SPAN_NONE;
    while (!read_close(p))
        read_photon_item(p, photons, &spacing);
    if (photons->count > 0 && spacing.source)
        parse_warn(p, WARN_VALUE, spacing, "spacing has no effect beside count %ld",
                   photons->count);
    photons->is_on = photons->gather_max > 0;
}

/* --- pms: what the common language has no word for ----------------------------------------- */

static void read_kernel(Parser *p, PmsSettings *pms)
{
    static const char *const words[KERNEL_COUNT] = {"flat", "cone", "epanechnikov", "gaussian",
                                                    "gaussian_jensen"};
    pms->kernel = (GatherKernel)read_choice(p, "kernel", words, KERNEL_COUNT);
}

static void read_gather_shape(Parser *p, PmsSettings *pms)
{
    static const char *const words[2] = {"disk", "sphere"};
    pms->gather_shape = (GatherShape)read_choice(p, "gather", words, 2);
}

static void read_gi_method(Parser *p, PmsSettings *pms)
{
    static const char *const words[INDIRECT_COUNT] = {"", "cache", "gather", "map"};
    pms->method = (IndirectMethod)read_choice(p, "gi_method", words, INDIRECT_COUNT);
}

static void read_pms_setting(Parser *p, PmsSettings *pms)
{
    enum { GI, GI_METHOD, GLOBAL_PHOTONS, KERNEL, GATHER, COUNT };
    static const char *const words[COUNT] = {"gi", "gi_method", "global_photons", "kernel",
                                             "gather"};
    switch (read_choice(p, "pms { } of global_settings", words, COUNT)) {
    case GI:
        pms->has_indirect = parse_flag(p);
        break;
    case GI_METHOD:
        read_gi_method(p, pms);
        break;
    case GLOBAL_PHOTONS:
        pms->global_count = read_photon_count(p, "global_photons", 1);
        break;
    case KERNEL:
        read_kernel(p, pms);
        break;
    default:
        read_gather_shape(p, pms);
    }
}

void read_pms_settings(Parser *p, PmsSettings *pms)
{
    Token head = read_open(p);
    pms->span = head.span;
    while (!read_close(p))
        read_pms_setting(p, pms);
}

/* --- global_settings ----------------------------------------------------------------------- */

static void read_assumed_gamma(Parser *p, SceneSettings *settings)
{
    Token word = parse_next(p);
    if (parse_accept(p, KW_SRGB))
        parse_fail_not_yet(p, word.span, "assumed_gamma srgb");
    double gamma = read_above_zero(p, "assumed_gamma");
    if (settings->has_assumed_gamma) {
        parse_warn(p, WARN_LANGUAGE, word.span, "assumed_gamma was given before: that one holds");
        return;
    }
    settings->assumed_gamma = gamma;
    settings->has_assumed_gamma = true;
}

static void read_charset(Parser *p)
{
    parse_next(p);
    bool is_utf8 = parse_accept(p, KW_UTF8) || parse_accept(p, KW_SYS);
    if (!is_utf8 && !parse_accept(p, KW_ASCII))
        parse_fail_here(p, "after charset, which wants ascii, utf8 or sys");
    parse_set_utf8(p, is_utf8);
}

/* Settings of effects that are asked for elsewhere and fail there: checked, then dropped. */
static bool read_unused_setting(Parser *p)
{
    switch (parse_peek(p)->kind) {
    case KW_MAX_INTERSECTIONS:
    case KW_NUMBER_OF_WAVES:
        parse_next(p);
        read_finite(p, "this setting", NULL);
        return true;
    case KW_HF_GRAY_16:
        parse_next(p);
        parse_flag(p);
        return true;
    case KW_NOISE_GENERATOR:
        parse_next(p);
        parse_set_noise_generator(p, (int)parse_int(p, "noise_generator", 1, NOISE_GENERATORS));
        return true;
    case KW_MM_PER_UNIT:
        parse_next(p);
        read_above_zero(p, "mm_per_unit");
        return true;
    case KW_CHARSET:
        read_charset(p);
        return true;
    default:
        return false;
    }
}

static void read_setting(Parser *p, SceneSettings *settings)
{
    Token head = *parse_peek(p);
    if (read_unused_setting(p))
        return;
    switch (head.kind) {
    case KW_ADC_BAILOUT:
        parse_next(p);
        settings->adc_bailout = read_not_negative(p, "adc_bailout");
        break;
    case KW_AMBIENT_LIGHT:
        parse_next(p);
        settings->ambient_light = read_rgb(p, "ambient_light");
        break;
    case KW_ASSUMED_GAMMA:
        read_assumed_gamma(p, settings);
        break;
    case KW_IRID_WAVELENGTH:
        parse_next(p);
        settings->irid_wavelength = read_rgb(p, "irid_wavelength");
        break;
    case KW_MAX_TRACE_LEVEL:
        settings->max_trace_level = read_trace_level(p);
        break;
    case KW_PHOTONS:
        read_global_photons(p, &settings->photons);
        break;
    case KW_RADIOSITY:
        read_radiosity(p, &settings->radiosity);
        break;
    case KW_SUBSURFACE:
        parse_fail_not_yet(p, head.span, "subsurface");
    default:
        if (!read_is_word(&head, "pms"))
            parse_fail_here(p, "in global_settings");
        read_pms_settings(p, &settings->pms);
    }
}

void read_global_settings(Parser *p)
{
    read_open(p);
    while (!read_close(p))
        read_setting(p, &parse_scene(p)->settings);
}
