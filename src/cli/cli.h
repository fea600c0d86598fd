/* The command line: commands, options, and what commands share.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_CLI_CLI_H
#define PMS_CLI_CLI_H

#include "base/arena.h"
#include "base/diag.h"
#include "base/json.h"
#include "render/render.h"
#include "sdl/sdl.h"

#include <stdbool.h>
#include <stdio.h>

enum {
    CMD_RENDER = 1,
    CMD_CHECK = 2,
    CMD_EXPLAIN = 4,
    CMD_COMPARE = 8,
    CMD_VALIDATE = 16,
    CMD_SELFTEST = 32,
    CMD_STUDY = 64,
    CMD_SCENE = CMD_RENDER | CMD_CHECK | CMD_EXPLAIN | CMD_VALIDATE | CMD_SELFTEST |
                CMD_STUDY, /* those that read a scene */
    CMD_ALL = 127
};

typedef enum OptionId {
#define X(id, letter, name, argument, commands, text) id,
#include "cli/option.def"
#undef X
    OPTION_COUNT
} OptionId;

/* A command line, taken apart.  Strings are borrowed from argv or live in `arena`. */
typedef struct Args {
    Arena *arena;
    Diag *diag;
    const char *command;
    const char *value[OPTION_COUNT]; /* last argument given; "" for a flag; NULL: not given */
    const char **operands;
    int operand_count;
    const char **outputs; /* -o, +O */
    int output_count;
    const char **libraries; /* -L, +L */
    int library_count;
    SdlDeclare *declares; /* -D, Declare= */
    int declare_count;
    Tri effects[FEATURE_COUNT]; /* --effect, --no-photons: of each effect the last holds */
    /* what POV-style switches set */
    bool has_pov_aa;
    int aa_method, aa_depth;        /* +AM, +R; 0: not given */
    double aa_threshold, aa_jitter; /* +A0.n, +J; negative: not given */
    bool is_jitter_off;             /* -J */
    int parted; /* index in argv of the last option whose value may be joined to it but is not; 0 */
    int argc;   /* as given, also for the metadata */
    char **argv;
} Args;

/* Take the command line of a command apart (argv[0] is the program; a leading command word
 * has been removed).  ERR_USAGE after a message.  Handles --help and --version by printing to
 * stdout and setting *is_done. */
Status args_parse(Args *args, const char *command, int argc, char **argv, bool *is_done);

/* ERR_USAGE after a message unless there are `count` operands; `what` names them: "two images". */
Status args_want_operands(const Args *args, int count, const char *what);

/* Read an option as an integer or number in [lowest, highest]; `fallback` when not given. */
Status args_int(const Args *args, OptionId id, long lowest, long highest, long fallback, long *out);
Status args_number(const Args *args, OptionId id, double lowest, double highest, double fallback,
                   double *out);
static inline bool args_has(const Args *args, OptionId id)
{
    return args->value[id] != NULL;
}

/* Read --time into *seconds, which stays as it is without one. */
Status args_time(const Args *args, double *seconds);

/* Fill what reading scenes needs from the command line: library paths, declares, size, limits. */
Status args_sdl_options(const Args *args, SdlOptions *out);

/* Read the scene of the command line's operand `index` with its library paths, declares and
 * size.  *seconds gets the time it took. */
Status args_load_scene(const Args *args, int index, Scene **out, double *seconds);

/* Fill render options from the command line. */
Status args_render_options(const Args *args, RenderOptions *out);

/* Write the image to every path of the list by its extension (.exr, .png), for PNG
 * through the OpenColorIO view.  `extra` goes into the header. */
Status output_write(const Args *args, const Scene *scene, RenderResult *result,
                    const char *const *paths, int path_count);

/* Say early what could not be written later: unknown extensions, missing folders, a bad --stats,
 * and for PNG files a bad --bits, --ocio, --display or --view. */
Status output_preflight(const Args *args, const char *const *paths, int path_count);

/* Say early that a file could not be written. */
Status output_can_write(const Args *args, const char *path);

/* Print the counters, times and photon books of a render as JSON. */
void stats_print_json(FILE *file, const Scene *scene, const RenderResult *result);

/* The commands: each does what its parsed command line says. */
#define X(name, function, bit, operands, text) Status function(Args *args);
#include "cli/command.def"
#undef X

#endif
