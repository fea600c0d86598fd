/* radiosity{} of global_settings.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/read_int.h"

enum { RAYS_MAX = 6000, RECURSION_MAX = 20, NEAREST_MAX = 20 };

/* The further numbers of count and nearest_count steer methods that pms has not. */
static void skip_second(Parser *p, const char *what)
{
    parse_comma(p);
    if (!parse_is_expression(p))
        return;
    Span span;
    read_finite(p, what, &span);
    parse_warn(p, WARN_LANGUAGE, span, "the second number of %s has no effect in pms", what);
}

static double read_part(Parser *p, const char *what, double lowest, double highest)
{
    Span span;
    double value = read_finite(p, what, &span);
    if (!(value >= lowest && value <= highest))
        parse_fail(p, span, "%s wants a number from %g to %g, got %g", what, lowest, highest,
                   value);
    return value;
}

/* A flag that must be written out, as the language wants it in this block. */
static bool read_bool(Parser *p)
{
    parse_next(p);
    return parse_flag(p);
}

static void read_without_effect(Parser *p, const char *why)
{
    Token word = parse_next(p);
    if (parse_flag(p))
        parse_warn(p, WARN_LANGUAGE, word.span, "%s", why);
}

static void read_file(Parser *p)
{
    Token word = parse_next(p);
    parse_string(p);
    parse_warn(p, WARN_LANGUAGE, word.span,
               "files of radiosity have no effect in pms: it finds the light anew");
}

/* Settings that are one number. */
static bool read_number(Parser *p, RadiositySettings *r)
{
    switch (parse_peek(p)->kind) {
    case KW_ADC_BAILOUT:
        parse_next(p);
        r->adc_bailout = read_above_zero(p, "adc_bailout");
        return true;
    case KW_BRIGHTNESS:
        parse_next(p);
        r->brightness = read_above_zero(p, "brightness");
        return true;
    case KW_ERROR_BOUND:
        parse_next(p);
        r->error_bound = read_above_zero(p, "error_bound");
        return true;
    case KW_GRAY_THRESHOLD:
        parse_next(p);
        r->gray_threshold = read_part(p, "gray_threshold", 0, 1);
        return true;
    case KW_LOW_ERROR_FACTOR:
        parse_next(p);
        r->low_error_factor = read_above_zero(p, "low_error_factor");
        return true;
    case KW_MAXIMUM_REUSE:
        parse_next(p);
        r->maximum_reuse = read_above_zero(p, "maximum_reuse");
        return true;
    case KW_MINIMUM_REUSE:
        parse_next(p);
        r->minimum_reuse = read_not_negative(p, "minimum_reuse");
        return true;
    case KW_MAX_SAMPLE:
        parse_next(p);
        r->max_sample = fmax(0, read_finite(p, "max_sample", NULL));
        return true;
    case KW_PRETRACE_START:
        parse_next(p);
        r->pretrace_start = read_part(p, "pretrace_start", 1e-6, 1);
        return true;
    case KW_PRETRACE_END:
        parse_next(p);
        r->pretrace_end = read_part(p, "pretrace_end", 1e-6, 1);
        return true;
    default:
        return false;
    }
}

static void read_radiosity_item(Parser *p, RadiositySettings *r)
{
    if (read_number(p, r))
        return;
    switch (parse_peek(p)->kind) {
    case KW_COUNT:
        parse_next(p);
        r->count = (int)parse_int(p, "count", 1, RAYS_MAX);
        skip_second(p, "count");
        break;
    case KW_NEAREST_COUNT:
        parse_next(p);
        r->nearest_count = (int)parse_int(p, "nearest_count", 1, NEAREST_MAX);
        skip_second(p, "nearest_count");
        break;
    case KW_RECURSION_LIMIT:
        parse_next(p);
        r->recursion_limit = (int)parse_int(p, "recursion_limit", 1, RECURSION_MAX);
        break;
    case KW_ALWAYS_SAMPLE:
        r->is_always_sampling = read_bool(p);
        break;
    case KW_NORMAL:
        read_without_effect(p, "normal has no effect in pms: indirect light does not see bumps");
        break;
    case KW_MEDIA:
        read_without_effect(p, "media has no effect in pms: indirect light does not see media");
        break;
    case KW_SUBSURFACE:
        read_without_effect(p, "subsurface has no effect in pms");
        break;
    case KW_LOAD_FILE:
    case KW_SAVE_FILE:
        read_file(p);
        break;
    default:
        parse_fail_here(p, "in radiosity");
    }
}

void read_radiosity(Parser *p, RadiositySettings *radiosity)
{
    Token word = read_open(p);
    radiosity->span = word.span;
    radiosity->is_on = true;
    while (!read_close(p))
        read_radiosity_item(p, radiosity);
    if (!(radiosity->maximum_reuse > radiosity->minimum_reuse))
        parse_warn(p, WARN_VALUE, word.span,
                   "maximum_reuse %g is not above minimum_reuse %g: records of all sizes are one",
                   radiosity->maximum_reuse, radiosity->minimum_reuse);
}
