/* Taking a command line apart: GNU-style options, and POV-Ray's switches beside them.
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/cli.h"
#include "cli/args_int.h"

#include "base/file.h"
#include "base/guess.h"
#include "base/work.h"

#include <ctype.h>
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct Option {
    char letter;
    const char *name, *argument;
    int commands;
    const char *text;
} Option;

static const Option options[] = {
#define X(id, letter, name, argument, commands, text) {letter, name, argument, commands, text},
#include "cli/option.def"
#undef X
};

typedef struct CommandInfo {
    const char *name, *operands, *text;
    int bit;
} CommandInfo;

static const CommandInfo command_infos[] = {
#define X(name, function, bit, operands, text) {name, operands, text, bit},
#include "cli/command.def"
#undef X
};

enum { COMMAND_COUNT = sizeof command_infos / sizeof command_infos[0], HELP_COLUMN = 26 };

static const CommandInfo *command_info(const char *name)
{
    for (int i = 0; i < COMMAND_COUNT; i++)
        if (strcmp(command_infos[i].name, name) == 0)
            return &command_infos[i];
    return &command_infos[0];
}

/* Written in brackets: an argument that may be left out. */
static bool is_optional(const Option *option)
{
    return option->argument && option->argument[0] == '[';
}

/* Return the help of an option, which for some commands is another. */
static const char *option_text(const Option *option, int command)
{
    if (option == &options[OPT_OUTPUT] && command == CMD_VALIDATE)
        return "write both pictures and their difference, side by side, to FILE, .exr or .png";
    if (option == &options[OPT_OUTPUT] && command == CMD_STUDY)
        return "put the report into the folder FILE (SCENE.study)";
    if (option == &options[OPT_TIME] && command == CMD_STUDY)
        return "spend no more than T on all of the study: 90s, 5m, 1.5h (10m)";
    if (option == &options[OPT_WIDTH] && command == CMD_SELFTEST)
        return "width of the picture of SCENE in pixels (160)";
    if (option == &options[OPT_HEIGHT] && command == CMD_SELFTEST)
        return "height of that picture in pixels (by the shape of the camera)";
    return option->text;
}

static void print_option(const Option *option, int command)
{
    char left[64];
    const char *argument = option->argument ? option->argument : "";
    snprintf(left, sizeof left, "%s%c%s --%s%s%s", option->letter ? "-" : " ",
             option->letter ? option->letter : ' ', option->letter ? "," : " ", option->name,
             is_optional(option) ? "[="
             : option->argument  ? "="
                                 : "",
             is_optional(option) ? argument + 1 : argument);
    printf("  %-*s %s\n", HELP_COLUMN, left, option_text(option, command));
}

static void print_help(const CommandInfo *info)
{
    bool is_render = info->bit == CMD_RENDER;
    printf("usage: pms %s%s%s [OPTION...] %s\n\n", is_render ? "[" : "", info->name,
           is_render ? "]" : "", info->operands);
    if (is_render) {
        printf("commands (pms COMMAND --help tells more):\n");
        for (int i = 0; i < COMMAND_COUNT; i++)
            printf("  %-*s %s\n", HELP_COLUMN, command_infos[i].name, command_infos[i].text);
        printf("\n");
    } else {
        printf("%s\n\n", info->text);
    }
    printf("options:\n");
    for (int i = 0; i < OPTION_COUNT; i++)
        if (options[i].commands & info->bit)
            print_option(&options[i], info->bit);
    if (info->bit & CMD_SCENE)
        printf("\nPOV-Ray's switches work too: +Ifile +Ofile +Wn +Hn +A[0.n] -A +AMn +Rn +J[n] -J "
               "+Ldir\n"
               "+WTn +Qn +UA -D Declare=name=value\n");
}

/* Append to a list of strings in the arena; returns the new list or NULL. */
static const char **list_add(Arena *arena, const char **list, int *count, const char *item)
{
    const char **grown = ARENA_ARRAY(arena, const char *, (size_t)*count + 1);
    if (!grown)
        return NULL;
    if (*count)
        memcpy(grown, list, (size_t)*count * sizeof *grown);
    grown[(*count)++] = item;
    return grown;
}

static Status keep(Args *args, const char ***list, int *count, const char *item)
{
    *list = list_add(args->arena, *list, count, item);
    return *list ? OK : diag_no_memory(args->diag, "the command line");
}

Status args_add_output(Args *args, const char *path)
{
    return keep(args, &args->outputs, &args->output_count, path);
}

Status args_add_library(Args *args, const char *path)
{
    return keep(args, &args->libraries, &args->library_count, path);
}

Status args_add_operand(Args *args, const char *operand)
{
    return keep(args, &args->operands, &args->operand_count, operand);
}

static bool is_name(const char *text, size_t length)
{
    for (size_t i = 0; i < length; i++)
        if (!isalpha((unsigned char)text[i]) && text[i] != '_' &&
            (i == 0 || !isdigit((unsigned char)text[i])))
            return false;
    return true;
}

Status args_add_declare(Args *args, const char *text)
{
    const char *equals = strchr(text, '=');
    if (!equals || equals == text || !is_name(text, (size_t)(equals - text)))
        return diag_fail(args->diag, ERR_USAGE, "a declaration looks like NAME=VALUE, got '%s'",
                         text);
    SdlDeclare *grown = ARENA_ARRAY(args->arena, SdlDeclare, (size_t)args->declare_count + 1);
    char *name = arena_strndup(args->arena, text, (size_t)(equals - text));
    if (!grown || !name)
        return diag_no_memory(args->diag, "the command line");
    if (args->declare_count)
        memcpy(grown, args->declares, (size_t)args->declare_count * sizeof *grown);
    grown[args->declare_count++] = (SdlDeclare){name, equals + 1};
    args->declares = grown;
    return OK;
}

static Status set_option(Args *args, int id, const char *value)
{
    args->value[id] = value;
    if (id == OPT_OUTPUT)
        return args_add_output(args, value);
    if (id == OPT_LIBRARY)
        return args_add_library(args, value);
    if (id == OPT_DECLARE)
        return args_add_declare(args, value);
    if (id == OPT_EFFECT)
        return args_add_effects(args, value);
    if (id == OPT_NO_PHOTONS)
        args_add_no_photons(args);
    return OK;
}

/* Set an option that has an argument: `joined` to it, or, if that is NULL, the next word.  `form`
 * is the option as it was written. */
static Status take_value(Args *args, int id, const char *form, const char *joined, int *i)
{
    const char *argument = options[id].argument;
    const char *value = joined ? joined : *i + 1 < args->argc ? args->argv[++*i] : "";
    int brackets = is_optional(&options[id]);
    if (!*value)
        return diag_fail(args->diag, ERR_USAGE, "%s wants %.*s after it (%s)", form,
                         (int)strlen(argument) - 2 * brackets, argument + brackets,
                         option_text(&options[id], 0));
    return set_option(args, id, value);
}

static bool is_option(const Option *option, int bit, const char *name, size_t length)
{
    return (option->commands & bit) && strlen(option->name) == length &&
           memcmp(option->name, name, length) == 0;
}

static Status unknown_option(const Args *args, const char *word, const char *name, size_t length,
                             int bit)
{
    Guess guess = guess_begin(name, length);
    for (int i = 0; i < OPTION_COUNT; i++)
        if (options[i].commands & bit)
            guess_try(&guess, options[i].name);
    return diag_fail(args->diag, ERR_USAGE, "pms %s has no option %.*s%s%s%s", args->command,
                     (int)(name + length - word), word,
                     guess.best ? "; did you mean --" : " (--help lists them)",
                     guess.best ? guess.best : "", guess.best ? "?" : "");
}

/* A --name, --name=value or --name value at argv[*i]. */
static Status parse_long(Args *args, int bit, int *i)
{
    const char *word = args->argv[*i], *name = word + 2;
    const char *equals = strchr(name, '=');
    size_t length = equals ? (size_t)(equals - name) : strlen(name);
    for (int id = 0; id < OPTION_COUNT; id++) {
        const Option *option = &options[id];
        if (!is_option(option, bit, name, length))
            continue;
        if (!option->argument && equals)
            return diag_fail(args->diag, ERR_USAGE, "--%s takes no value", option->name);
        if (!is_optional(option) && option->argument)
            return take_value(args, id, word, equals ? equals + 1 : NULL, i);
        if (equals)
            return take_value(args, id, word, equals + 1, i);
        args->parted = is_optional(option) ? *i : args->parted;
        return set_option(args, id, "");
    }
    return unknown_option(args, word, name, length, bit);
}

/* Return true if letters behind one dash are the name of an option, or a slip of the fingers for
 * one that begins alike: -width and -widht are no -w with a value. */
static bool is_long_name(int bit, const char *name, size_t length)
{
    Guess guess = guess_begin(name, length);
    for (int id = 0; id < OPTION_COUNT && length > 1; id++) {
        if (is_option(&options[id], bit, name, length))
            return true;
        if ((options[id].commands & bit) && options[id].name[0] == name[0])
            guess_try(&guess, options[id].name);
    }
    return length > 1 && guess.best;
}

/* A -x, -xvalue, -x=value or -x value at argv[*i]. */
static Status parse_short(Args *args, int bit, int *i)
{
    const char *word = args->argv[*i], *name = word + 1;
    size_t length = strcspn(name, "=");
    bool is_long = is_long_name(bit, name, length);
    for (int id = 0; id < OPTION_COUNT && !is_long; id++) {
        const Option *option = &options[id];
        if (!(option->commands & bit) || option->letter != name[0])
            continue;
        const char form[] = {'-', option->letter, 0};
        const char *joined = name[1] ? name + 1 + (name[1] == '=') : NULL;
        if (option->argument)
            return take_value(args, id, form, joined, i);
        if (!joined)
            return set_option(args, id, "");
    }
    return unknown_option(args, word, name, length, bit);
}

static Status parse_word(Args *args, int bit, int *i)
{
    const char *word = args->argv[*i];
    bool reads_scene = (bit & CMD_SCENE) != 0;
    bool is_taken = false;
    if (word[0] == '-' && word[1] == '-')
        return parse_long(args, bit, i);
    if (reads_scene)
        TRY(pov_switch(args, word, &is_taken));
    if (is_taken)
        return OK;
    if (word[0] == '-' && word[1])
        return parse_short(args, bit, i);
    return args_add_operand(args, word);
}

Status args_parse(Args *args, const char *command, int argc, char **argv, bool *is_done)
{
    const CommandInfo *info = command_info(command);
    args->command = command;
    args->argc = argc;
    args->argv = argv;
    args->aa_threshold = args->aa_jitter = -1;
    *is_done = false;
    bool has_ended = false; /* after --, all words are operands */
    for (int i = 1; i < argc; i++) {
        if (has_ended)
            TRY(args_add_operand(args, argv[i]));
        else if (strcmp(argv[i], "--") == 0)
            has_ended = true;
        else
            TRY(parse_word(args, info->bit, &i));
    }
    if (args_has(args, OPT_HELP)) {
        print_help(info);
        *is_done = true;
    } else if (args_has(args, OPT_VERSION)) {
        printf("pms %s\n", PMS_VERSION);
        *is_done = true;
    }
    return OK;
}

static Status too_many_operands(const Args *args, const char *what)
{
    const char *parted = args->parted ? args->argv[args->parted + 1] : NULL;
    if (parted && *parted != '-' && !file_exists(parted))
        return diag_fail(args->diag, ERR_USAGE,
                         "%s wants its value joined to it by =; did you mean %s=%s?",
                         args->argv[args->parted], args->argv[args->parted], parted);
    return diag_fail(args->diag, ERR_USAGE, "pms %s wants %s, got %d: '%s', '%s'%s", args->command,
                     what, args->operand_count, args->operands[0], args->operands[1],
                     args->operand_count > 2 ? ", ..." : "");
}

Status args_want_operands(const Args *args, int count, const char *what)
{
    if (args->operand_count == count)
        return OK;
    if (args->operand_count > count)
        return too_many_operands(args, what);
    return diag_fail(args->diag, ERR_USAGE, "pms %s wants %s, got %d (--help tells more)",
                     args->command, what, args->operand_count);
}

Status args_number(const Args *args, OptionId id, double lowest, double highest, double fallback,
                   double *out)
{
    const char *text = args->value[id];
    *out = fallback;
    if (!text)
        return OK;
    char *end;
    *out = strtod(text, &end);
    if (end == text || *end || !(*out >= lowest && *out <= highest))
        return diag_fail(args->diag, ERR_USAGE, "--%s wants a number from %g to %g, got '%s'",
                         options[id].name, lowest, highest, text);
    return OK;
}

Status args_int(const Args *args, OptionId id, long lowest, long highest, long fallback, long *out)
{
    const char letter[] = {'-', options[id].letter, ',', ' ', 0};
    const char *text = args->value[id];
    *out = fallback;
    if (!text)
        return OK;
    char *end;
    errno = 0;
    *out = strtol(text, &end, 10);
    if (end == text || *end || errno || *out < lowest || *out > highest)
        return diag_fail(args->diag, ERR_USAGE,
                         "%s--%s wants a whole number from %ld to %ld, got '%s'",
                         letter[1] ? letter : "", options[id].name, lowest, highest, text);
    return OK;
}

#define LIGHT_RADIUS_MAX 1e30

enum { WIDTH_DEFAULT = 640, HEIGHT_DEFAULT = 480, SAMPLES_MAX = 1 << 20 };

static Status read_size(const Args *args, int *width, int *height)
{
    long w, h;
    TRY(args_int(args, OPT_WIDTH, 1, IMAGE_SIDE_MAX, WIDTH_DEFAULT, &w));
    TRY(args_int(args, OPT_HEIGHT, 1, IMAGE_SIDE_MAX, HEIGHT_DEFAULT, &h));
    *width = (int)w;
    *height = (int)h;
    return OK;
}

Status args_sdl_options(const Args *args, SdlOptions *out)
{
    *out = (SdlOptions){.library_paths = args->libraries,
                        .library_path_count = args->library_count,
                        .declares = args->declares,
                        .declare_count = args->declare_count};
    long threads;
    TRY(read_size(args, &out->width, &out->height));
    TRY(args_int(args, OPT_MAX_TOKENS, 1, LONG_MAX, SDL_MAX_TOKENS, &out->max_tokens));
    TRY(args_int(args, OPT_THREADS, 1, WORK_THREADS_MAX, work_thread_count(), &threads));
    out->threads = (int)threads;
    return OK;
}

Status args_load_scene(const Args *args, int index, Scene **out, double *seconds)
{
    SdlOptions sdl;
    TRY(args_sdl_options(args, &sdl));
    double start = clock_wall();
    Status status = sdl_load(args->diag, args->operands[index], &sdl, out);
    *seconds = clock_wall() - start;
    if (status == OK && args->effects[FEATURE_CAUSTIC_MAP] == TRI_ON)
        scene_add_photons(*out);
    return status;
}

static Status read_layers(const Args *args, unsigned *out)
{
    static const struct {
        const char *name;
        unsigned bit;
    } layers[] = {{"direct", LAYER_DIRECT},
                  {"caustic", LAYER_CAUSTIC},
                  {"indirect", LAYER_INDIRECT},
                  {"Z", LAYER_Z},
                  {"N", LAYER_N},
                  {"albedo", LAYER_ALBEDO},
                  {"error.noise", LAYER_ERROR_NOISE},
                  {"error.bias", LAYER_ERROR_BIAS}};
    const char *text = args->value[OPT_LAYERS];
    while (text && *text) {
        size_t length = strcspn(text, ",");
        unsigned bit = 0;
        for (size_t i = 0; i < sizeof layers / sizeof layers[0]; i++)
            if (strlen(layers[i].name) == length && memcmp(layers[i].name, text, length) == 0)
                bit = layers[i].bit;
        if (!bit)
            return diag_fail(args->diag, ERR_USAGE,
                             "there is no layer '%.*s'; there are direct, caustic, indirect, Z, "
                             "N, albedo, error.noise and error.bias",
                             (int)length, text);
        *out |= bit;
        text += length + (text[length] == ',');
    }
    return OK;
}

static Status read_antialiasing(const Args *args, RenderOptions *out)
{
    long samples;
    TRY(args_int(args, OPT_AA, 1, SAMPLES_MAX, 0, &samples));
    if (args->has_pov_aa && samples)
        return diag_fail(args->diag, ERR_USAGE,
                         "+A has no meaning with --aa, which takes %ld samples of every pixel; "
                         "leave one of them out",
                         samples);
    if (args->has_pov_aa) {
        out->aa = args->aa_method == 2 ? AA_POV2 : AA_POV1;
    } else if (samples) {
        out->aa = AA_UNIFORM;
        out->samples = (int)samples;
    }
    if (args->aa_threshold >= 0)
        out->aa_threshold = args->aa_threshold;
    if (args->aa_depth)
        out->aa_depth = args->aa_depth;
    if (args->aa_jitter >= 0)
        out->aa_jitter = args->aa_jitter;
    out->aa_has_jitter = !args->is_jitter_off;
    return OK;
}

static Status read_integrator(const Args *args, PlanOptions *out)
{
    const char *name = args->value[OPT_INTEGRATOR];
    if (name && strcmp(name, "path") == 0)
        out->integrator = INTEGRATOR_PATH;
    else if (name && strcmp(name, "photons") != 0)
        return diag_fail(args->diag, ERR_USAGE, "--integrator wants photons or path, got '%s'",
                         name);
    return args_number(args, OPT_LIGHT_RADIUS, 0, LIGHT_RADIUS_MAX, 0, &out->light_radius);
}

static Status read_indirect(const Args *args, PlanOptions *out)
{
    static const char *const words[INDIRECT_COUNT] = {"", "cache", "gather", "map"};
    const char *text = args->value[OPT_GI];
    out->has_indirect = args_has(args, OPT_GI);
    for (int i = 0; text && i < INDIRECT_COUNT; i++)
        if (strcmp(text, words[i]) == 0) {
            out->indirect = (IndirectMethod)i;
            return OK;
        }
    return text
               ? diag_fail(args->diag, ERR_USAGE, "--gi wants cache, gather or map, got '%s'", text)
               : OK;
}

Status args_render_options(const Args *args, RenderOptions *out)
{
    long threads, seed, quality;
    *out = RENDER_OPTIONS_DEFAULT;
    TRY(read_size(args, &out->width, &out->height));
    TRY(args_int(args, OPT_THREADS, 1, WORK_THREADS_MAX, work_thread_count(), &threads));
    TRY(args_int(args, OPT_SEED, 0, LONG_MAX, 0, &seed));
    TRY(args_int(args, OPT_QUALITY, 0, 11, 9, &quality));
    TRY(read_layers(args, &out->layers));
    out->has_error_picture = args_has(args, OPT_ERROR_MAP);
    TRY(read_antialiasing(args, out));
    TRY(read_integrator(args, &out->plan));
    TRY(args_progressive(args, out));
    TRY(read_indirect(args, &out->plan));
    out->threads = (int)threads;
    out->seed = (uint64_t)seed;
    out->plan.quality = (int)(quality > 9 ? 9 : quality);
    memcpy(out->plan.effects, args->effects, sizeof args->effects);
    out->has_alpha = args_has(args, OPT_ALPHA);
    return OK;
}
