/* sdl_load: from a file to a Scene.
 *
 * Here is the one setjmp of the parser.  Nothing below it owns anything but arena memory, so
 * a parse that fails is dropped by freeing two arenas.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"

#include "base/file.h"
#include "base/hash.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* The language a scene without #version is taken to be for what depends on gamma. */
#define VERSION_UNSAID 3.62

/* The memory of a machine that does not say how much it has. */
#define BYTES_UNKNOWN ((size_t)8 << 30)

/* What a load is asked for; text NULL: read the file. */
typedef struct Request {
    const char *path;
    const char *text;
    size_t size;
} Request;

static void set_predefined(Parser *p)
{
    const SdlOptions *options = p->options;
    static const char *const zeros[] = {"frame_number",  "initial_frame", "final_frame",
                                        "initial_clock", "final_clock",   "clock_delta"};
    symbol_set_number(p, "image_width", options->width);
    symbol_set_number(p, "image_height", options->height);
    for (size_t i = 0; i < sizeof zeros / sizeof zeros[0]; i++)
        symbol_set_number(p, zeros[i], 0);
    symbol_set_number(p, "pms_version", strtod(PMS_VERSION, NULL));
}

/* Declare=name=value of the command line. */
static void set_declares(Parser *p)
{
    for (int i = 0; i < p->options->declare_count; i++) {
        const SdlDeclare *declare = &p->options->declares[i];
        const char *value = declare->value;
        size_t length = strlen(value);
        uint64_t *hash = &p->scene->declare_hash;
        *hash = hash_bytes(*hash, declare->name, strlen(declare->name) + 1);
        *hash = hash_bytes(*hash, value, length + 1);
        char *end;
        double number = strtod(value, &end);
        if (value[0] == '"')
            symbol_set_string(p, declare->name, value + 1, length > 1 ? length - 2 : 0);
        else
            symbol_set_number(p, declare->name, number);
        if (value[0] != '"' && (end == value || *end))
            parse_warn(p, WARN_VALUE, SPAN_NONE,
                       "the value of '%s' is '%s', no number: taken as %g", declare->name, value,
                       number);
    }
}

static void open_main(Parser *p, const Request *request)
{
    if (request->text) {
        Source *source = parse_no_null(p, ARENA_NEW(p->scene->text, Source));
        Arena *text = p->scene->text;
        source->path = parse_no_null(p, arena_strndup(text, request->path, strlen(request->path)));
        source->text = parse_no_null(p, arena_strndup(text, request->text, request->size));
        source->size = request->size;
        file_lex(p, source);
    }
    file_open(p, request->path, SPAN_NONE);
    const Source *source = frame_top(p)->file->source;
    p->scene->path = source->path;
    p->is_utf8 = source->size > 0 && (unsigned char)source->text[0] > 127;
}

/* `declare A = 1;` at top level, without its `#`. */
static bool bare_directive(Parser *p)
{
    switch ((int)parse_peek(p)->kind) {
    case KW_DECLARE:
    case KW_DEFAULT:
    case KW_INCLUDE:
    case KW_VERSION: {
        Token word = parse_next(p);
        parse_warn(p, WARN_LANGUAGE, word.span, "`#` is missing before `%s`",
                   keyword_text(word.kind));
        directive_word(p, NULL, word);
        return true;
    }
    default:
        return false;
    }
}

/* The grammar's start: scene = { directive | statement }. */
static void parse_scene_file(Parser *p)
{
    while (parse_peek(p)->kind != TOKEN_END)
        if (!bare_directive(p))
            read_statement(p);
}

static void finish(Parser *p)
{
    SceneSettings *settings = &p->scene->settings;
    double effective = p->has_version ? p->version : VERSION_UNSAID;
    settings->version = p->version;
    settings->is_gamma_off = effective < 3.7 && !settings->has_assumed_gamma;
    if (!p->has_version)
        parse_warn(p, WARN_LANGUAGE, SPAN_NONE,
                   "'%s' has no `#version`: it is read as older than 3.7%s", p->scene->path,
                   settings->is_gamma_off ? ", without gamma" : "");
    if (p->options->moved_by && !scene_transform(&p->build, p->scene, p->options->moved_by))
        parse_fail_status(p, diag_no_memory(p->diag, "the moved scene"));
    Status status = scene_build_finish(&p->build, p->scene, p->diag);
    if (status == OK)
        status = scene_check(p->scene, p->diag);
    if (status != OK)
        parse_fail_status(p, status);
}

static Status parse_all(Parser *p, const Request *request)
{
    if (setjmp(p->failed))
        return p->status;
    p->frames = parse_no_null(p, ARENA_ARRAY(p->arena, Frame, FRAME_MAX));
    Status status = names_init(p->diag, &p->names, p->scene->text);
    if (status != OK)
        return status;
    open_main(p, request);
    set_predefined(p);
    symbol_set_string(p, "input_file_name", path_base(request->path),
                      strlen(path_base(request->path)));
    set_declares(p);
    parse_scene_file(p);
    finish(p);
    return OK;
}

/* Return the bytes of memory this machine has. */
static size_t machine_bytes(void)
{
    long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
    return pages > 0 && size > 0 ? (size_t)pages * (size_t)size : BYTES_UNKNOWN;
}

static Parser *parser_new(Diag *diag, const SdlOptions *options, Scene *scene, Arena *arena)
{
    Parser *p = ARENA_NEW(arena, Parser);
    if (!p)
        return NULL;
    p->diag = diag;
    p->options = options;
    p->arena = arena;
    p->scene = scene;
    p->build.arena = scene->arena;
    p->version = 3.7;
    p->noise_generator = NOISE_GENERATOR_DEFAULT;
    p->tokens_max = options->max_tokens > 0 ? options->max_tokens : SDL_MAX_TOKENS;
    p->tokens_left = p->tokens_max;
    p->bytes_max = options->max_bytes ? options->max_bytes : machine_bytes();
    strmap_init(&p->files, arena);
    return p;
}

static Status load(Diag *diag, const Request *request, const SdlOptions *options, Scene **out)
{
    *out = NULL;
    Scene *scene = scene_new();
    Arena *arena = arena_new();
    Parser *p = scene && arena ? parser_new(diag, options, scene, arena) : NULL;
    Status status = p ? parse_all(p, request) : diag_no_memory(diag, "the scene");
    if (p)
        shape_scratch_free(p->shape_scratch);
    arena_free(arena);
    if (status == OK)
        *out = scene;
    else
        scene_free(scene);
    return status;
}

Status sdl_load(Diag *diag, const char *path, const SdlOptions *options, Scene **out)
{
    return load(diag, &(Request){.path = path}, options, out);
}

Status sdl_load_text(Diag *diag, const char *path, const char *text, size_t size,
                     const SdlOptions *options, Scene **out)
{
    return load(diag, &(Request){path, text, size}, options, out);
}
