/* POV-Ray's switches: +W320 +H240 +A0.1 -A +Iscene.pov ...
 *
 * A switch begins with + (any) or - (only the on/off ones, whose letters pms does not use
 * itself).  Letters may be of either case.  SPDX-License-Identifier: Apache-2.0 */
#include "cli/args_int.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

typedef enum SwitchValue { NO_VALUE, MAYBE_VALUE, A_VALUE } SwitchValue;

typedef struct Switch {
    const char *letters; /* upper case */
    SwitchValue value;
    bool has_minus; /* -X means something */
    Status (*apply)(Args *args, const char *value, bool is_on);
} Switch;

/* Copy a value where an option's would be. */
static Status set(Args *args, OptionId id, const char *value)
{
    args->value[id] = value;
    return OK;
}

static Status bad_value(Args *args, const char *letters, const char *wanted, const char *value)
{
    return diag_fail(args->diag, ERR_USAGE, "+%s wants %s, got '%s'", letters, wanted, value);
}

static Status number_in(Args *args, const char *letters, const char *value, double lowest,
                        double highest, double *out)
{
    char *end;
    *out = strtod(value, &end);
    if (end == value || *end || !(*out >= lowest && *out <= highest)) {
        char wanted[64];
        snprintf(wanted, sizeof wanted, "a number from %g to %g", lowest, highest);
        return bad_value(args, letters, wanted, value);
    }
    return OK;
}

static Status apply_width(Args *args, const char *value, bool is_on)
{
    (void)is_on;
    return set(args, OPT_WIDTH, value);
}

static Status apply_height(Args *args, const char *value, bool is_on)
{
    (void)is_on;
    return set(args, OPT_HEIGHT, value);
}

static Status apply_input(Args *args, const char *value, bool is_on)
{
    (void)is_on;
    return args_add_operand(args, value);
}

static Status apply_library(Args *args, const char *value, bool is_on)
{
    (void)is_on;
    return args_add_library(args, value);
}

static Status apply_threads(Args *args, const char *value, bool is_on)
{
    (void)is_on;
    return set(args, OPT_THREADS, value);
}

static Status apply_quality(Args *args, const char *value, bool is_on)
{
    (void)is_on;
    return set(args, OPT_QUALITY, value);
}

/* +Ofoo means foo.png, as there; +O with a known extension is taken as it is. */
static Status apply_output(Args *args, const char *value, bool is_on)
{
    (void)is_on;
    size_t length = strlen(value);
    bool is_known = length > 4 && (strcasecmp(value + length - 4, ".png") == 0 ||
                                   strcasecmp(value + length - 4, ".exr") == 0);
    if (is_known)
        return args_add_output(args, value);
    char *path = arena_alloc(args->arena, length + sizeof ".png");
    if (!path)
        return diag_no_memory(args->diag, "the command line");
    memcpy(path, value, length);
    memcpy(path + length, length && value[length - 1] == '.' ? "png" : ".png",
           length && value[length - 1] == '.' ? sizeof "png" : sizeof ".png");
    return args_add_output(args, path);
}

static Status apply_antialias(Args *args, const char *value, bool is_on)
{
    args->has_pov_aa = is_on;
    if (!is_on)
        args->value[OPT_AA] = NULL;
    return *value ? number_in(args, "A", value, 0, 1, &args->aa_threshold) : OK;
}

static Status apply_method(Args *args, const char *value, bool is_on)
{
    (void)is_on;
    double method;
    TRY(number_in(args, "AM", value, 1, 2, &method));
    args->aa_method = (int)method;
    return OK;
}

static Status apply_depth(Args *args, const char *value, bool is_on)
{
    (void)is_on;
    double depth;
    TRY(number_in(args, "R", value, 1, 9, &depth));
    args->aa_depth = (int)depth;
    return OK;
}

static Status apply_jitter(Args *args, const char *value, bool is_on)
{
    args->is_jitter_off = !is_on;
    return *value ? number_in(args, "J", value, 0, 1, &args->aa_jitter) : OK;
}

static Status apply_alpha(Args *args, const char *value, bool is_on)
{
    (void)value;
    return set(args, OPT_ALPHA, is_on ? "" : NULL);
}

/* Preview, pause, verbose: pms shows no window. */
static Status apply_nothing(Args *args, const char *value, bool is_on)
{
    (void)args, (void)value, (void)is_on;
    return OK;
}

/* Longer letters first: the first match wins. */
static const Switch switches[] = {
    {"AM", A_VALUE, false, apply_method},  {"UA", NO_VALUE, true, apply_alpha},
    {"WT", A_VALUE, false, apply_threads}, {"A", MAYBE_VALUE, true, apply_antialias},
    {"D", NO_VALUE, true, apply_nothing},  {"H", A_VALUE, false, apply_height},
    {"I", A_VALUE, false, apply_input},    {"J", MAYBE_VALUE, true, apply_jitter},
    {"L", A_VALUE, false, apply_library},  {"O", A_VALUE, false, apply_output},
    {"P", NO_VALUE, true, apply_nothing},  {"Q", A_VALUE, false, apply_quality},
    {"R", A_VALUE, false, apply_depth},    {"V", NO_VALUE, true, apply_nothing},
    {"W", A_VALUE, false, apply_width},
};

static bool fits(const Switch *s, const char *word)
{
    size_t length = strlen(s->letters);
    if (strncasecmp(word + 1, s->letters, length) != 0)
        return false;
    /* With a minus only upper case counts, so that -o and -j stay pms's own. */
    if (word[0] == '-' && (!s->has_minus || strncmp(word + 1, s->letters, length) != 0))
        return false;
    const char *value = word + 1 + length;
    if (s->value == NO_VALUE)
        return *value == 0;
    if (s->value == A_VALUE)
        return *value != 0;
    return *value == 0 || isdigit((unsigned char)*value) || *value == '.';
}

/* -D is POV-Ray's "no preview" when nothing that looks like NAME=VALUE is attached. */
static Status keyword(Args *args, const char *word, bool *is_taken)
{
    static const char declare[] = "Declare=";
    *is_taken = strncasecmp(word, declare, sizeof declare - 1) == 0;
    return *is_taken ? args_add_declare(args, word + sizeof declare - 1) : OK;
}

Status pov_switch(Args *args, const char *word, bool *is_taken)
{
    *is_taken = false;
    if (word[0] != '+' && word[0] != '-')
        return keyword(args, word, is_taken);
    for (size_t i = 0; i < sizeof switches / sizeof switches[0]; i++) {
        if (!fits(&switches[i], word))
            continue;
        *is_taken = true;
        return switches[i].apply(args, word + 1 + strlen(switches[i].letters), word[0] == '+');
    }
    if (word[0] == '+')
        return diag_fail(args->diag, ERR_USAGE, "pms does not know the switch %s", word);
    return OK;
}
