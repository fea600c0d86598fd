/* The installed povray, run on the same scene: its command line, the process, its clock.
 * SPDX-License-Identifier: Apache-2.0 */
#include "cli/povray_run.h"

#include "base/child.h"
#include "base/file.h"
#include "image/png_file.h"

#include <math.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>

enum { WORDS_MAX = 256, WORD_BYTES = FILE_PATH_MAX + 64, LOG_BYTES_MAX = 16 << 20 };

/* A command line being made. */
typedef struct Words {
    const Args *args;
    char *word[WORDS_MAX + 1];
    int count;
    bool is_full; /* too many words, or no memory */
} Words;

static void add(Words *w, const char *format, ...) __attribute__((format(printf, 2, 3)));

static void add(Words *w, const char *format, ...)
{
    char text[WORD_BYTES];
    va_list list;
    va_start(list, format);
    int length = vsnprintf(text, sizeof text, format, list);
    va_end(list);
    char *kept = NULL;
    if (w->count < WORDS_MAX && length >= 0 && length < (int)sizeof text)
        kept = arena_strndup(w->args->arena, text, (size_t)length);
    if (kept)
        w->word[w->count++] = kept;
    w->is_full |= !kept;
}

/* povray has no uniform sampling: its first method with threshold 0 takes R*R samples of every
 * pixel and the centre. */
static void add_antialiasing(Words *w, const RenderOptions *o)
{
    if (o->aa == AA_NONE) {
        add(w, "-A");
        return;
    }
    bool is_uniform = o->aa == AA_UNIFORM;
    int depth = is_uniform ? (int)fmin(9, fmax(1, floor(sqrt(o->samples) + 0.5))) : o->aa_depth;
    add(w, "Antialias=on");
    add(w, "Antialias_Threshold=%g", is_uniform ? 0 : o->aa_threshold);
    add(w, "+AM%d", o->aa == AA_POV2 ? 2 : 1);
    add(w, "+R%d", depth);
    if (o->aa_has_jitter)
        add(w, "+J%g", o->aa_jitter);
    else
        add(w, "-J");
}

static void add_folders(Words *w)
{
    const char *scene = w->args->operands[0];
    size_t length = (size_t)(path_base(scene) - scene);
    if (length)
        add(w, "+L\"%.*s\"", (int)length, scene);
    for (int i = 0; i < w->args->library_count; i++)
        add(w, "+L\"%s\"", w->args->libraries[i]);
    char room[FILE_PATH_MAX];
    const char *folder;
    for (int i = 0; (folder = sdl_own_folder(i, room)); i++) {
        if (*folder)
            add(w, "+L\"%s\"", folder);
    }
}

/* povray takes a string only if the whole declaration is in single quotes. */
static void add_declares(Words *w)
{
    for (int i = 0; i < w->args->declare_count; i++) {
        const SdlDeclare *declare = &w->args->declares[i];
        const char *quote = declare->value[0] == '"' ? "'" : "";
        add(w, "Declare=%s%s=%s%s", quote, declare->name, declare->value, quote);
    }
}

static Status make_words(Words *w, const RenderOptions *o, const char *picture)
{
    bool has_no_photons = o->plan.effects[FEATURE_CAUSTIC_MAP] == TRI_OFF && o->plan.quality > 8;
    add(w, "povray");
    add(w, "+I\"%s\"", w->args->operands[0]);
    add(w, "+O\"%s\"", picture);
    add(w, "+FN16");
    add(w, "+W%d", o->width);
    add(w, "+H%d", o->height);
    add(w, "-D");
    add(w, "-P");
    add(w, "+WT%d", o->threads);
    /* Photons are what povray's best quality has over the next one. */
    add(w, "+Q%d", has_no_photons ? 8 : o->plan.quality);
    if (o->has_alpha)
        add(w, "+UA");
    add_antialiasing(w, o);
    add_folders(w);
    add_declares(w);
    return w->is_full ? diag_fail(w->args->diag, ERR_USAGE, "too many options for povray") : OK;
}

static double children_cpu(void)
{
    struct rusage usage;
    getrusage(RUSAGE_CHILDREN, &usage);
    return (double)usage.ru_utime.tv_sec + (double)usage.ru_stime.tv_sec +
           1e-6 * ((double)usage.ru_utime.tv_usec + (double)usage.ru_stime.tv_usec);
}

/* Return the part of povray's messages that tells most: from the line that names an error, else
 * the last lines. */
static const char *telling_part(const char *text, size_t size)
{
    enum { TAIL_BYTES = 300 };
    const char *part = strstr(text, "Error");
    if (!part)
        part = strstr(text, "error");
    if (!part)
        part = size > TAIL_BYTES ? text + size - TAIL_BYTES : text;
    while (part > text && part[-1] != '\n')
        part--;
    return part;
}

static Status report(const Args *args, const char *log, int wait_status)
{
    enum { SHOWN_BYTES = 600 };
    const char *text = "", *part = "";
    size_t size = 0;
    if (WIFSIGNALED(wait_status))
        return diag_fail(args->diag, ERR_LIBRARY, "povray was ended by signal %d",
                         WTERMSIG(wait_status));
    if (file_exists(log) &&
        file_read(args->diag, log, LOG_BYTES_MAX, args->arena, &text, &size) == OK)
        part = telling_part(text, size);
    int length = (int)strnlen(part, SHOWN_BYTES);
    while (length > 0 && part[length - 1] == '\n')
        length--;
    return diag_fail(args->diag, ERR_LIBRARY, "povray failed (exit code %d):\n%.*s",
                     WEXITSTATUS(wait_status), length, part);
}

static Status run(const Args *args, char *const *words, const char *log, SideRun *out)
{
    double wall = clock_wall(), cpu = children_cpu();
    int wait_status;
    Status status = child_run(args->diag, words, NULL, "/dev/null", log, &wait_status);
    if (status == ERR_FILE)
        return diag_fail(args->diag, ERR_LIBRARY,
                         "povray is not installed (validate runs it on the same scene)");
    TRY(status);
    out->wall_seconds = clock_wall() - wall;
    out->cpu_seconds = children_cpu() - cpu;
    if (WIFEXITED(wait_status) && WEXITSTATUS(wait_status) == 0)
        return OK;
    return report(args, log, wait_status);
}

Status povray_run(const Args *args, const RenderOptions *options, const char *folder, SideRun *out)
{
    Words words = {.args = args};
    char picture[FILE_PATH_MAX], log[FILE_PATH_MAX];
    snprintf(picture, sizeof picture, "%s/povray.png", folder);
    snprintf(log, sizeof log, "%s/povray.log", folder);
    TRY(make_words(&words, options, picture));
    TRY(run(args, words.word, log, out));
    return png_read(args->diag, picture, &out->image);
}
