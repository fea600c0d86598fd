/* The inside of the parser: cursor, blocks, symbols.  Only the core looks in here; readers use
 * sdl_int.h.
 *
 * The cursor is a stack of frames, each a run of tokens: the main file, an include, a macro's
 * body.  The stack is also the backtrace of an error.  Conditionals and loops are blocks on a
 * second stack; a loop goes round by moving the cursor of its frame.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SDL_PARSER_INT_H
#define PMS_SDL_PARSER_INT_H

#include "math/func.h"
#include "sdl/sdl_int.h"

#include <setjmp.h>

#define SDL_EPSILON 1e-10 /* the language's own tolerance, absolute */

enum {
    MACRO_DEPTH_MAX = 200,
    INCLUDE_DEPTH_MAX = 200,
    INCLUDE_SELF_MAX = 32,  /* times one file may be open at once */
    FRAME_MAX = MACRO_DEPTH_MAX + INCLUDE_DEPTH_MAX + 1,
    BLOCK_MAX = 10000,      /* open conditionals and loops */
    NEST_MAX = 1000,        /* expressions and directives within each other */
    BRACE_MAX = 256,
    PARAMETER_MAX = 64,     /* of a macro */
    ARRAY_DIMENSION_MAX = 5,
    BACKTRACE_MAX = 12,     /* notes under an error */
    TAKEN_COUNT = 16,       /* values parse_accept_value keeps */
    PATH_MAX_BYTES = 4096,
};

#define SOURCE_SIZE_MAX ((size_t)1 << 30)   /* bytes of one file */
#define STRING_SIZE_MAX ((size_t)1 << 24)   /* bytes of one string */
#define ARRAY_ITEM_MAX 10000000.0           /* items of one array */
#define SEED_MAX 1000000                    /* random streams */
#define VALUE_BYTES_MAX ((size_t)1 << 30)   /* strings, arrays and variables together */

typedef struct Symbol Symbol;
struct Symbol {
    Name *name;
    Symbol *outer;          /* the one it hides */
    Symbol *next_local;     /* in the list of its frame, or the free list */
    int frame;              /* owner; 0: global */
    long frame_serial;
    bool is_removed;        /* by #undef */
    bool is_deprecated_once;
    const char *deprecated; /* what to say at use, or NULL */
    Value *target;          /* &value, or the variable a macro parameter stands for */
    Value value;
};

typedef struct Macro {
    const Name *name;
    const TokenFile *file;
    const Token *begin, *end; /* the body; end is the `#` of its #end */
    Name **parameters;
    int parameter_count;
    Span span;
} Macro;

typedef struct Array {
    int dimension_count;
    int size[ARRAY_DIMENSION_MAX];
    size_t item_count;
    ValueKind item_kind; /* VALUE_NONE until the first assignment */
    int number_count;    /* of items that are numbers */
    Value *items;        /* kind VALUE_NONE: not assigned */
} Array;

typedef struct Frame {
    const TokenFile *file;
    const Token *at, *end; /* next token; end is not part of the frame */
    const Macro *macro;    /* NULL: a file */
    Span call;             /* where it was called or included */
    Symbol *locals;
    size_t block_base;     /* blocks from here on are its own */
    long serial;           /* no two frames of a parse have the same */
} Frame;

typedef enum BlockKind { BLOCK_IF, BLOCK_SWITCH, BLOCK_WHILE, BLOCK_FOR } BlockKind;

typedef struct Block {
    BlockKind kind;
    const Token *hash;  /* of the word that opened it */
    const Token *body;  /* of a #for */
    Symbol *variable;   /* of a #for */
    double end, step;   /* of a #for */
} Block;

/* What an operator may not lie behind: directives that make a statement, or any directive and
 * any macro call.  The right side of a #declare is assigned before the next one is carried out,
 * whether its semicolon is there or not. */
typedef enum Hold { HOLD_NONE, HOLD_STATEMENTS, HOLD_ALL } Hold;

/* One argument of a macro call: a value, or the variable it stands for. */
typedef struct Argument {
    Value *alias;
    Value value;
} Argument;

/* A float, vector or colour being worked out. */
typedef struct Terms {
    int count; /* 1 to 5 */
    double n[5];
} Terms;

/* The shape of a declared object. */
typedef struct AskedShape {
    const Node *node;
    const Shape *shape;
} AskedShape;

enum { ASKED_SHAPES = 16 };

struct Parser {
    jmp_buf failed;
    Status status;
    Diag *diag;
    const SdlOptions *options;
    Arena *arena; /* values, symbols, tokens: freed when sdl_load returns */
    Scene *scene;
    SceneBuild build;
    size_t value_bytes;

    Names names;
    StrMap files;          /* path to TokenFile */
    Frame *frames;
    int frame_count, macro_depth, include_depth;
    long frame_serial;
    Block *blocks;
    size_t block_count, block_capacity;
    const Token *next;     /* of the top frame, when is_ready */
    bool is_ready;
    Hold hold, held;       /* of the expression being read; of the token being looked for */
    int hold_frames;       /* frames open when hold was set: held tokens leave none of them */
    Span last;             /* token taken last */
    TokenKind last_kind;
    int nest, braces;
    Span brace_spans[BRACE_MAX]; /* of the open ones, innermost last */
    long tokens_left, tokens_max;
    size_t bytes_max; /* of the scene arena */

    Symbol *free_symbols;
    Argument *arguments;   /* of calls being made, innermost last */
    size_t argument_count, argument_capacity;
    Value taken[TAKEN_COUNT];
    unsigned taken_count;

    AskedShape asked[ASKED_SHAPES]; /* of objects asked about last; node NULL: none */
    unsigned asked_count;
    const Noise *noise;  /* made when needed */
    int noise_generator; /* of the scene, as far as read */
    ShapeScratch *shape_scratch;    /* made when needed; freed by sdl_load */

    double version;
    bool has_version, is_utf8;
    uint32_t *seeds;
    size_t seed_count, seed_capacity;
};

/* --- parse_fail.c ----------------------------------------------------------------------------- */

noreturn void parse_fail_memory(Parser *p);
/* Return what a word in a message ends in for so many. */
static inline const char *plural(int count) { return count == 1 ? "" : "s"; }
/* Fail on a word nobody knows: "unknown `what` ...; did you mean ...?" */
noreturn void parse_fail_unknown(Parser *p, const Token *token, const char *what);
/* Return the word of the scene or the language nearest to this one, or NULL. */
const char *word_nearest(const Parser *p, const char *word, size_t length);
/* Grow an array in the parse arena for one more item. */
void parse_grow(Parser *p, void **items, size_t count, size_t *capacity, size_t item_size);

/* --- cursor.c ------------------------------------------------------------------------------ */

Frame *frame_top(Parser *p);
void frame_push_file(Parser *p, const TokenFile *file, Span call);
void frame_push_macro(Parser *p, const Macro *macro, Span call);
/* Take the next token of the top frame as it stands: no directive, no macro. */
Token raw_next(Parser *p);
/* Return the next token of the top frame as it stands. */
const Token *raw_peek(Parser *p);
/* Move the top frame to `at`. */
void cursor_move(Parser *p, const Token *at);
/* parse_peek, but a directive that p->hold names is left alone: the `#` is returned. */
const Token *peek_operator(Parser *p);
/* Fail on the conditional or loop one of whose branches begins at the `#` `branch`; a string or
 * comment that swallowed its #end comes first. */
noreturn void fail_no_end(Parser *p, const TokenFile *file, const Token *branch);
/* Set p->hold, and back. */
void hold_set(Parser *p, Hold hold);
/* Forget what was left standing for a hold: it is looked at afresh. */
void release_hold(Parser *p);
/* Put the hold aside while something between brackets is read, and back. */
typedef struct HoldState {
    Hold hold, held;
    int frames;
} HoldState;
HoldState hold_aside(Parser *p);
void hold_restore(Parser *p, HoldState state);
/* Count one level of something that recurs, and back. */
void nest_enter(Parser *p);
void nest_leave(Parser *p);

/* --- symbol.c ------------------------------------------------------------------------------ */

/* Return the innermost visible symbol of a name, or NULL. */
Symbol *symbol_find(const Name *name);
/* The same for a use in an expression: warns when it is deprecated. */
Symbol *symbol_use(Parser *p, const Token *identifier);
/* Make a symbol in the innermost scope, or return the one that is there. */
Symbol *symbol_local(Parser *p, Name *name);
/* Return the visible symbol, or make a global one. */
Symbol *symbol_visible(Parser *p, Name *name);
/* Return the global symbol, made if need be, whatever hides it. */
Symbol *symbol_global(Parser *p, Name *name);
void symbol_undef(Symbol *symbol);
void symbols_drop(Parser *p, Frame *frame);
/* Return true while the frame that owns (frame, serial) is open. */
bool frame_is_open(const Parser *p, int frame, long serial);
void symbol_set_number(Parser *p, const char *name, double value);
void symbol_set_string(Parser *p, const char *name, const char *text, size_t length);

/* --- condition.c, declare.c, macro.c, include.c, directive.c -------------------------------- */

void directive(Parser *p);
void directive_word(Parser *p, const Token *hash, Token word);
void if_directive(Parser *p, const Token *hash);
void switch_directive(Parser *p, const Token *hash);
void while_directive(Parser *p, const Token *hash);
void for_directive(Parser *p, const Token *hash);
void branch_directive(Parser *p, const Token *hash, Token word);
void end_directive(Parser *p, Token word);
void break_directive(Parser *p, Token word);
/* Return whether the variable in parentheses exists, see 'defined'. */
bool is_defined(Parser *p); /* after `(`, up to and including `)` */
void declare_directive(Parser *p, Token word);
void undef_directive(Parser *p);
void macro_directive(Parser *p, const Token *hash);
void macro_call(Parser *p, const Macro *macro);
void include_directive(Parser *p);
void version_directive(Parser *p);
/* Open a scene or include file that was found; `call` is where it was asked for. */
void file_open(Parser *p, const char *path, Span call);
/* Cut a source into tokens and remember it under its path. */
TokenFile *file_lex(Parser *p, const Source *source);

/* --- value.c, array.c ------------------------------------------------------------------------ */

/* Memory of values (the parse arena), counted against VALUE_BYTES_MAX. */
void *value_alloc(Parser *p, size_t size);
/* Read whatever may stand on the right of a #declare or as an argument. */
void parse_value(Parser *p, Value *out);
/* The same for an argument, which may stand for a variable. */
void parse_argument(Parser *p, Argument *out);
/* Take an identifier and its subscripts; fails when there is no such variable or nothing in
 * it.  `owner` may be NULL. */
Value *parse_variable(Parser *p, Symbol **owner);
/* Return the kind the next token would have as a value, VALUE_NONE if it is no variable. */
ValueKind peek_value_kind(Parser *p);
/* Describe a value for a message: "a float", "a vector of 3", "a texture". */
const char *value_text(const Value *value);
void value_from_terms(Value *out, const Terms *terms);
Value *array_item(Parser *p, const Array *array, const Token *name);
bool array_item_is_set(Parser *p, const Array *array, const Token *name);
void array_assign(Parser *p, Array *array, Value *item, const Value *from, Span span);
void parse_array(Parser *p, Value *out);
Array *array_copy(Parser *p, const Array *array);

/* --- expr.c ----------------------------------------------------------------------------------- */

void parse_full(Parser *p, Terms *out);
void parse_short(Parser *p, Terms *out);
/* Go on with an expression whose first operand has been taken. */
void parse_short_after(Parser *p, Terms *first);
double parse_condition(Parser *p); /* a full expression in parentheses, one float */
double terms_float(Parser *p, const Terms *terms, Span begin, TokenKind after);
V3 terms_v3(Parser *p, const Terms *terms, Span begin);

/* --- formula.c ------------------------------------------------------------------------------- */

/* Add the steps of a formula, see formula.c, to code of so many parameters, of which there are
 * three at least; returns its slot. */
int formula_code(FuncBuilder *code, const char *text, int param_count);

/* --- function_fractal.c --------------------------------------------------------------------- */

/* Add the steps of f_ridged_mf, f_hetero_mf and f_ridge; return their slots. */
int fractal_ridged(FuncBuilder *code);
int fractal_hetero(FuncBuilder *code);
int fractal_ridge(FuncBuilder *code);

/* --- function.c, function_internal.c ---------------------------------------------------------- */

/* Read function { ... }. */
void parse_function(Parser *p, Value *out);
/* Read function COLUMNS, ROWS { ... }: an image of at most `most` pixels a side. */
void parse_grid_function(Parser *p, long most, int *columns, int *rows, Value *out);
/* Work out a call of a function whose name has been taken. */
void parse_function_call(Parser *p, const Value *function, Span name, Terms *out);
/* Return the code of a function, or fail where pms has it not. */
const Func *function_code(Parser *p, const Value *value, Span span);
/* Return the function of the language's library that has this number, or NULL: pms has it not
 * yet. */
const Func *function_internal(Parser *p, int number);

/* --- builtin_*.c ------------------------------------------------------------------------------ */

bool is_number_word(TokenKind kind);
bool is_string_word(TokenKind kind);
void parse_number_word(Parser *p, Terms *out);
void parse_vector_call(Parser *p, TokenKind word, Terms *out);
/* Return true for the functions that ask an object, and work out a call of one. */
bool is_object_word(TokenKind word);
void parse_object_call(Parser *p, TokenKind word, Terms *out);
double random_next(Parser *p, double stream, Span span);
double random_seed(Parser *p, double number);

typedef struct Text {
    const char *bytes; /* UTF-8 in 16-bit units at most, terminated */
    size_t length;     /* bytes */
} Text;

bool is_text_start(Parser *p);
Text parse_text(Parser *p);
int text_compare(Text a, Text b); /* difference of the first codes that differ */
/* Decode one UTF-8 character of at most `length` bytes; returns the bytes used.  What is no
 * UTF-8, or beyond 16 bits, becomes the unknown unit. */
size_t unit_decode(const char *text, size_t length, unsigned *unit);
size_t text_units(Text text);
int text_first_unit(Text text);

/* --- color_expr.c ----------------------------------------------------------------------------- */

/* Return true if the token is a word that begins a colour. */
bool is_color_word(TokenKind kind);
/* Read a colour that begins with a colour word. */
void parse_color_form(Parser *p, Terms *out);

#endif
