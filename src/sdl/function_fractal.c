/* The functions of the library that add up octaves of noise.
 *
 * Their number is a parameter: as many are made as may be, and each counts where the number says
 * so.  A call with a constant keeps those alone.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"

enum { OCTAVES_MAX = 24 };

/* An octave being added. */
typedef struct Octaves {
    FuncBuilder *code;
    int generator; /* slots: of its number, */
    int count;     /* of how many octaves there are, */
    int rest;      /* and of the part of one more that there is */
} Octaves;

static int op(const Octaves *o, FuncOp op, int a, int b)
{
    return func_step(o->code, op, (int[]){a, b, a, a});
}

static int number(const Octaves *o, double x)
{
    return func_const(o->code, x);
}

static int choose(const Octaves *o, int by, int below, int same, int above)
{
    return func_step(o->code, FUNC_SELECT, (int[]){by, below, same, above});
}

/* The noise at `size` times the place, by the generator that the parameter names. */
static int noise(const Octaves *o, int size)
{
    int from[4];
    for (int i = 0; i < 3; i++)
        from[i] = op(o, FUNC_MUL, func_param(o->code, i), size);
    from[3] = from[0];
    int kinds[NOISE_GENERATORS], generator = op(o, FUNC_FLOOR, o->generator, o->generator);
    int by = op(o, FUNC_SUB, generator, number(o, 2));
    for (int i = 0; i < NOISE_GENERATORS; i++)
        kinds[i] = func_step(o->code, (FuncOp)(FUNC_NOISE1 + i), from);
    return choose(o, by, kinds[0], kinds[1], kinds[2]);
}

/* The same from -1 to 1. */
static int signed_noise(const Octaves *o, int size)
{
    int n = noise(o, size);
    return op(o, FUNC_SUB, op(o, FUNC_MUL, n, number(o, 2)), number(o, 1));
}

/* `added` where octave i is among those wanted, else `sum`. */
static int if_wanted(const Octaves *o, int i, int sum, int added)
{
    int by = op(o, FUNC_SUB, o->count, number(o, i));
    return choose(o, by, sum, sum, added);
}

/* What a number of octaves that is not whole leaves for the last one. */
static int rest_of(const Octaves *o)
{
    return op(o, FUNC_SUB, o->count, op(o, FUNC_FLOOR, o->count, o->count));
}

/* `added` where octave i is wanted; where only the rest is, that is added. */
static int add_octave(const Octaves *o, int i, int sum, int added, int last)
{
    int with_rest = choose(o, o->rest, sum, sum, op(o, FUNC_ADD, sum, last));
    return if_wanted(o, i, if_wanted(o, i - 1, sum, with_rest), added);
}

/* Parameters of the fractals: the exponent, how much finer octaves are, how many, an offset, a
 * strength, the generator. */
enum { EXPONENT = 3, FINER, COUNT, OFFSET, STRENGTH, GENERATOR };

static int param(const Octaves *o, int which)
{
    return func_param(o->code, which);
}

/* How strong octave i is. */
static int fall_off(const Octaves *o, int size)
{
    return op(o, FUNC_POW, size, op(o, FUNC_NEG, param(o, EXPONENT), param(o, EXPONENT)));
}

/* (offset - |noise|)^2 */
static int ridge(const Octaves *o, int size)
{
    int n = signed_noise(o, size), fold = op(o, FUNC_ABS, n, n);
    fold = op(o, FUNC_SUB, param(o, OFFSET), fold);
    return op(o, FUNC_MUL, fold, fold);
}

int fractal_ridged(FuncBuilder *code)
{
    Octaves o = {code, func_param(code, GENERATOR), func_param(code, COUNT), 0};
    int size = number(&o, 1), signal = ridge(&o, size), sum = signal;
    for (int i = 1; i < OCTAVES_MAX; i++) {
        size = op(&o, FUNC_MUL, size, param(&o, FINER));
        int weight = op(&o, FUNC_MUL, signal, param(&o, STRENGTH));
        weight = op(&o, FUNC_MAX, number(&o, 0), op(&o, FUNC_MIN, number(&o, 1), weight));
        signal = op(&o, FUNC_MUL, ridge(&o, size), weight);
        int part = op(&o, FUNC_MUL, signal, fall_off(&o, size));
        sum = if_wanted(&o, i, sum, op(&o, FUNC_ADD, sum, part));
    }
    return sum;
}

/* What octave i adds to the terrain, before its height counts. */
static int rise(const Octaves *o, int size)
{
    int n = op(o, FUNC_ADD, signed_noise(o, size), param(o, OFFSET));
    return op(o, FUNC_MUL, n, fall_off(o, size));
}

/* The higher the terrain is, the more it varies. */
int fractal_hetero(FuncBuilder *code)
{
    Octaves o = {code, func_param(code, GENERATOR), func_param(code, COUNT), 0};
    int rest = o.rest = rest_of(&o);
    int power = op(&o, FUNC_INT, param(&o, STRENGTH), param(&o, STRENGTH));
    int size = number(&o, 1);
    int sum = op(&o, FUNC_ADD, signed_noise(&o, size), param(&o, OFFSET));
    for (int i = 1; i < OCTAVES_MAX; i++) {
        size = op(&o, FUNC_MUL, size, param(&o, FINER));
        int more = rise(&o, size);
        int part = op(&o, FUNC_MUL, more, op(&o, FUNC_POW, sum, power));
        int last = op(&o, FUNC_MUL, rest, op(&o, FUNC_MUL, more, sum));
        sum = add_octave(&o, i, sum, op(&o, FUNC_ADD, sum, part), last);
    }
    return sum;
}

/* Parameters of f_ridge: how much finer octaves are, how many, how much weaker, an offset, where
 * noise is folded, the generator. */
enum { RIDGE_FINER = 3, RIDGE_COUNT, RIDGE_WEAKER, RIDGE_OFFSET, RIDGE_FOLD, RIDGE_GENERATOR };

int fractal_ridge(FuncBuilder *code)
{
    Octaves o = {code, func_param(code, RIDGE_GENERATOR), func_param(code, RIDGE_COUNT), 0};
    int fold = param(&o, RIDGE_FOLD), offset = param(&o, RIDGE_OFFSET), one = number(&o, 1);
    int most = op(&o, FUNC_MAX, fold, op(&o, FUNC_SUB, one, fold));
    int rest = o.rest = rest_of(&o);
    o.count = op(&o, FUNC_MAX, one, op(&o, FUNC_FLOOR, o.count, o.count));
    int size = one, strength = one, sum = number(&o, 0), all = number(&o, 0);
    for (int i = 0; i < OCTAVES_MAX; i++) {
        int off = op(&o, FUNC_SUB, noise(&o, size), fold);
        int part = op(&o, FUNC_MUL, strength, op(&o, FUNC_ABS, off, off));
        sum = add_octave(&o, i, sum, op(&o, FUNC_ADD, sum, part), op(&o, FUNC_MUL, rest, part));
        all = add_octave(&o, i, all, op(&o, FUNC_ADD, all, strength),
                         op(&o, FUNC_MUL, rest, strength));
        size = op(&o, FUNC_MUL, size, param(&o, RIDGE_FINER));
        strength = op(&o, FUNC_MUL, strength, param(&o, RIDGE_WEAKER));
    }
    int mean = op(&o, FUNC_DIV, sum, op(&o, FUNC_MUL, all, most));
    return op(&o, FUNC_DIV, op(&o, FUNC_SUB, mean, offset), op(&o, FUNC_SUB, one, offset));
}
