/* Functions that scenes define, as code.
 *
 * The code of a function is a list of steps without jumps: each takes numbers from slots and puts
 * one into a slot of its own.  The first slots are the parameters, then come constants.  So the
 * same code yields values, derivatives, or bounds on both over whole stretches (interval
 * arithmetic, rounded outward), and what is written twice is computed once.
 *
 * Comparisons are exact and yield 1 or 0; what is not 0 is true.  Outside of what a step is defined
 * for (roots of negative numbers ...) values are no numbers.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_MATH_FUNC_H
#define PMS_MATH_FUNC_H

#include "base/arena.h"
#include "math/noise.h"
#include "math/range.h"
#include "math/v3.h"

#include <stdint.h>

typedef enum FuncOp {
#define X(id, count) id,
#include "math/func.def"
#undef X
    FUNC_OP_COUNT
} FuncOp;

/* Is this noise of a place? */
static inline bool func_is_noise(FuncOp op)
{
    return op >= FUNC_NOISE1 && op <= FUNC_NOISE3;
}

enum { FUNC_SLOTS_MAX = 1024, FUNC_PARAMS_MAX = 56, FUNC_FROM_MAX = 4 };

typedef struct FuncStep {
    uint16_t op;
    uint16_t from[FUNC_FROM_MAX]; /* slots */
} FuncStep;

typedef struct Func {
    int param_count, const_count, step_count;
    const double *consts;
    const FuncStep *steps;
    int result;         /* slot */
    const Noise *noise; /* NULL where no step needs it */
} Func;

/* Ranges of all slots of a function: of its values, and of its derivatives. */
typedef struct FuncRanges {
    Range value[FUNC_SLOTS_MAX], slope[FUNC_SLOTS_MAX];
    bool has_no_value; /* the function has none anywhere there: set by func_range */
} FuncRanges;

/* --- making --------------------------------------------------------------------------------- */

/* A function being made.  Slots are numbers >= 0 for its users, too; NO_SLOT stands for all that
 * follows from a function that became too long. */
enum { NO_SLOT = -1 };

typedef struct FuncBuilder {
    int param_count, const_count, step_count;
    double consts[FUNC_SLOTS_MAX];
    FuncStep steps[FUNC_SLOTS_MAX]; /* from: numbers of nodes, see func.c */
    const Noise *noise;             /* to be set before the first step of noise */
} FuncBuilder;

void func_begin(FuncBuilder *builder, int param_count);

/* Return the slot of a parameter, of a constant, of a step.  Steps of constants are computed at
 * once; those that are there already are used again. */
int func_param(const FuncBuilder *builder, int number);
int func_const(FuncBuilder *builder, double value);
int func_step(FuncBuilder *builder, FuncOp op, const int *from);

/* Return the constant that a slot holds, or false. */
bool func_is_const(const FuncBuilder *builder, int slot, double *value);

/* Return the slot of a function's value for arguments in slots. */
int func_call(FuncBuilder *builder, const Func *callee, const int *arguments);

/* Return the function whose value is in a slot, in `arena`; NULL when memory is out. */
const Func *func_end(Arena *arena, const FuncBuilder *builder, int result);

/* Three functions of the same parameters as one, so that what they share is computed once.
 * func.result is the first of the results. */
typedef struct FuncTriple {
    const Func *func;
    int results[3]; /* slots: of FuncRanges, too */
} FuncTriple;

/* Join three functions of up to three parameters: of the first two, the third being 0.  Returns
 * false when they are too long together; out->func is NULL when memory is out. */
bool func_join(Arena *arena, const Func *const parts[3], FuncTriple *out);

/* --- asking (any thread) -------------------------------------------------------------------- */

/* Return the value for param_count arguments. */
double func_value(const Func *func, const double *arguments);

/* Return the value, and its derivatives by the first three parameters; where the function jumps
 * or bends, those of one side. */
double func_gradient(const Func *func, const double *arguments, V3 *gradient);

/* Return the values as a vector, and its derivatives by the first two parameters. */
V3 func_triple(const FuncTriple *triple, const double *arguments, V3 *by_first, V3 *by_second);

/* Bound the value over ranges of the arguments.  With rounding, the bounds hold for func_value.
 *
 * work  for func_slope. */
Range func_range(const Func *func, const Range *arguments, FuncRanges *work);

/* Bound the derivative along a stretch, or in a box, of which func_range was asked just before;
 * `slopes` are those of the arguments along it.  It is RANGE_ALL where the value may jump. */
Range func_slope(const Func *func, const Range *slopes, FuncRanges *work);

#endif
