/* What the files of this folder share: values, the parser, and the words every reader uses.
 *
 * A reader asks for what it wants (parse_float, parse_expect ...) and gets it, or the parse
 * ends: parse_fail prints and jumps to the one setjmp in sdl_load.  The parser owns nothing
 * but arena memory, so nothing leaks.  Directives, macro calls and loops are carried out
 * inside parse_peek: a reader never sees them.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SDL_SDL_INT_H
#define PMS_SDL_SDL_INT_H

#include "base/strmap.h"
#include "math/noise.h"
#include "scene/node.h"
#include "sdl/lex.h"
#include "sdl/sdl.h"

#include <stdnoreturn.h>

typedef struct Parser Parser; /* parser_int.h has the fields; only the core looks inside */

typedef enum ValueKind {
    VALUE_NONE,
    VALUE_NUMBERS,   /* float or vector: n[0..count-1] */
    VALUE_COLOR,     /* n[0..4] red green blue filter transmit, as 32-bit floats */
    VALUE_STRING,    /* text */
    VALUE_ARRAY,     /* node: Array */
    VALUE_MACRO,     /* node: Macro */
    VALUE_OBJECT,    /* node: const Node (scene/node.h), lights included */
    VALUE_TEXTURE,   /* node: const Texture */
    VALUE_PIGMENT,   /* node: const Pigment */
    VALUE_FINISH,    /* node: const Finish */
    VALUE_INTERIOR,  /* node: const Interior */
    VALUE_MATERIAL,  /* node: const Material (scene/node.h) */
    VALUE_TRANSFORM, /* node: const Xform */
    VALUE_CAMERA,    /* node: const Camera */
    VALUE_COLOR_MAP, /* node: const ColorMap (scene/node.h) */
    VALUE_SKY,       /* node: const Sky */
    VALUE_MEDIA,     /* node: const Medium */
    VALUE_DENSITY,   /* node: const Density */
    VALUE_DENSITY_MAP, /* node: const Density, of which only the map counts */
    VALUE_FOG,       /* node: const Fog */
    VALUE_RAINBOW,   /* node: const Rainbow */
    VALUE_FUNCTION,  /* node: const Func (math/func.h), or NULL: pms has not what text names */
    VALUE_KIND_COUNT
} ValueKind;

typedef struct Value {
    ValueKind kind;
    int count;        /* of numbers, 1 to 5 */
    double n[5];
    const char *text; /* terminated */
    size_t length;    /* of text, bytes */
    const void *node;
    Span span;        /* where it was written */
} Value;

/* --- tokens as readers see them: directives done, macros expanded ------------------------ */

/* Return the next token without taking it.  Valid until the next parse_ call. */
const Token *parse_peek(Parser *p);
/* Return true if the very next token is of this kind, without carrying out a directive that
 * stands before it: for what may or may not follow a finished value (texture{} texture{}). */
bool parse_is_next(Parser *p, TokenKind kind);
/* Take the next token. */
Token parse_next(Parser *p);
/* Take the next token if it is of this kind (punctuation or keyword); return whether it was. */
bool parse_accept(Parser *p, TokenKind kind);
/* Take a token of this kind, or fail: "`{` wanted after `sphere`, found ..." */
Token parse_expect(Parser *p, TokenKind kind, const char *after);
/* Take a comma if one is there. */
void parse_comma(Parser *p);
/* Return the span of the token taken last. */
Span parse_last_span(const Parser *p);

/* --- failing and warning ------------------------------------------------------------------ */

noreturn void parse_fail(Parser *p, Span span, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Fail on the next token, which fits nowhere in `where` ("in a sphere", "at top level"): says
 * "pms has no `blob` yet" for words of the language it lacks, else "unknown word ... did you
 * mean ...?" or what was found. */
noreturn void parse_fail_here(Parser *p, const char *where);
/* Fail because the language has `what` at `span` and pms has not yet. */
noreturn void parse_fail_not_yet(Parser *p, Span span, const char *what);
/* End the parse with a status whose message has been given. */
noreturn void parse_fail_status(Parser *p, Status status);
void parse_warn(Parser *p, WarnKind kind, Span span, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* --- values ------------------------------------------------------------------------------- */

double parse_float(Parser *p);        /* short expression, one finite or infinite number */
double parse_float_full(Parser *p);   /* full expression (conditions) */
long parse_int(Parser *p, const char *what, long lowest, long highest); /* truncated, checked */
bool parse_flag(Parser *p);           /* optional float: missing is true, true if > 0 */
V3 parse_v3(Parser *p);               /* a float fills all three; NaN and infinity are errors */
V2 parse_v2(Parser *p);
Color5 parse_color(Parser *p);        /* full colour, all forms */
Rgb parse_rgb(Parser *p);             /* colour without filter and transmit; a float is grey */
/* Return true if the next token can begin a colour (color, rgb..., a colour identifier). */
bool parse_is_color(Parser *p);
/* Return a terminated string in the scene arena. */
const char *parse_string(Parser *p);
/* The same for the name of a file: a literal keeps its backslashes. */
const char *parse_path(Parser *p);
/* Find a file by the language's search order: as named, beside the including file, on the
 * library path, in the data folders.  Returns its path or NULL. */
const char *file_find(Parser *p, const char *name, const char *const *extensions);
/* Say how the bytes of string literals from here on are read (charset; ASCII at first). */
void parse_set_utf8(Parser *p, bool is_utf8);
/* Return true if the next token can begin a float or vector expression. */
bool parse_is_expression(Parser *p);

/* Take the next token if it is an identifier (or array element) whose value has this kind;
 * return the value (valid until a few more were taken) or NULL. */
const Value *parse_accept_value(Parser *p, ValueKind kind);

/* Transforms: parse_is_xform tells whether the next token begins one (translate, rotate,
 * scale, matrix, transform); parse_xform takes it.  Singular or non-finite ones fail. */
bool parse_is_xform(Parser *p);
Xform parse_xform(Parser *p);

/* --- memory and results -------------------------------------------------------------------- */

/* Scene-arena memory; fails the parse when memory is out. */
void *parse_alloc(Parser *p, size_t size);
void *parse_copy(Parser *p, const void *from, size_t size);
Arena *parse_arena(Parser *p); /* the scene arena */
Scene *parse_scene(Parser *p); /* the scene being filled */
SceneBuild *parse_build(Parser *p); /* top-level nodes and lights so far (scene/node.h) */
Diag *parse_diag(Parser *p);
const SdlOptions *parse_options(Parser *p);
/* Return the tables of noise, made when first asked for, in the scene arena. */
const Noise *parse_noise(Parser *p);
/* Return or set the noise generator of the scene, as far as it has been read. */
int parse_noise_generator(const Parser *p);
void parse_set_noise_generator(Parser *p, int generator);
/* Fail the parse when a constructor of another floor returned NULL. */
void *parse_no_null(Parser *p, const void *node);

/* --- what the readers provide to the core (read_*.c) ---------------------------------------- */

/* Read one top-level statement that is not a directive (an object, camera, light_source,
 * background, global_settings ...); fails on anything else. */
void read_statement(Parser *p);
/* If the next token begins a block that can be a value (an object, texture, pigment, finish,
 * interior, material, media, density, transform, camera, color_map, density_map, sky_sphere, fog,
 * rainbow), read it into *out and return
 * true.  Past the closing brace it may look only with parse_is_next. */
bool read_value(Parser *p, Value *out);
/* #default { ... }, after its opening brace and up to and including the closing one. */
void read_default(Parser *p);

#endif
