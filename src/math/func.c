/* Making functions, and their values.  SPDX-License-Identifier: Apache-2.0 */
#include "math/func.h"

#include <math.h>
#include <string.h>

/* While a function is made, nodes are numbered by kind, since constants are added in between:
 * parameters from 0, constants from FIRST_CONST, steps from FIRST_STEP. */
enum { FIRST_CONST = 2048, FIRST_STEP = 2 * FIRST_CONST };

static int from_count(FuncOp op)
{
    static const int counts[] = {
#define X(id, count) count,
#include "math/func.def"
#undef X
    };
    return counts[op];
}

/* --- values --------------------------------------------------------------------------------- */

/* As the language truncates: to 32 bits. */
static double whole(double x)
{
    double t = trunc(x);
    return t >= INT32_MIN && t <= INT32_MAX ? t : INT32_MIN;
}

static double compute(FuncOp op, const double x[FUNC_FROM_MAX], const Noise *noise)
{
    double a = x[0], b = x[1];
    switch (op) {
    case FUNC_ADD:
        return a + b;
    case FUNC_SUB:
        return a - b;
    case FUNC_MUL:
        return a * b;
    case FUNC_DIV:
        return a / b;
    case FUNC_MOD:
        return fmod(a, b);
    case FUNC_POW:
        return b == 2 ? a * a : pow(a, b);
    case FUNC_ATAN2:
        return atan2(a, b);
    case FUNC_MIN:
        return a < b ? a : b;
    case FUNC_MAX:
        return a > b ? a : b;
    case FUNC_LESS:
        return a < b;
    case FUNC_LESS_EQUAL:
        return a <= b;
    case FUNC_EQUAL:
        return a == b;
    case FUNC_NOT_EQUAL:
        return a != b;
    case FUNC_AND:
        return a != 0 && b != 0;
    case FUNC_OR:
        return a != 0 || b != 0;
    case FUNC_SELECT:
        return a < 0 ? b : a == 0 ? x[2] : x[3];
    case FUNC_NOISE1:
    case FUNC_NOISE2:
    case FUNC_NOISE3:
        return noise_value(noise, (int)op - FUNC_NOISE1 + 1, v3(a, b, x[2]));
    case FUNC_NEG:
        return -a;
    case FUNC_ABS:
        return fabs(a);
    case FUNC_SQRT:
        return sqrt(a);
    case FUNC_EXP:
        return exp(a);
    case FUNC_LN:
        return log(a);
    case FUNC_SIN:
        return sin(a);
    case FUNC_COS:
        return cos(a);
    case FUNC_TAN:
        return tan(a);
    case FUNC_ASIN:
        return asin(a);
    case FUNC_ACOS:
        return acos(a);
    case FUNC_ATAN:
        return atan(a);
    case FUNC_SINH:
        return sinh(a);
    case FUNC_COSH:
        return cosh(a);
    case FUNC_TANH:
        return tanh(a);
    case FUNC_ASINH:
        return asinh(a);
    case FUNC_ACOSH:
        return acosh(a);
    case FUNC_ATANH:
        return atanh(a);
    case FUNC_FLOOR:
        return floor(a);
    case FUNC_CEIL:
        return ceil(a);
    case FUNC_INT:
        return whole(a);
    default:
        return NAN;
    }
}

static void load(const Func *func, const double *arguments, double *slots)
{
    memcpy(slots, arguments, (size_t)func->param_count * sizeof *slots);
    memcpy(slots + func->param_count, func->consts, (size_t)func->const_count * sizeof *slots);
}

static void take(const FuncStep *step, const double *slots, double x[FUNC_FROM_MAX])
{
    for (int i = 0; i < FUNC_FROM_MAX; i++)
        x[i] = slots[step->from[i]];
}

/* The steps that most functions are made of, without ado. */
static inline double compute_fast(const FuncStep *step, const double *slots, const Noise *noise)
{
    double a = slots[step->from[0]], b = slots[step->from[1]], x[FUNC_FROM_MAX];
    switch (step->op) {
    case FUNC_ADD:
        return a + b;
    case FUNC_SUB:
        return a - b;
    case FUNC_MUL:
        return a * b;
    default:
        take(step, slots, x);
        return compute((FuncOp)step->op, x, noise);
    }
}

double func_value(const Func *func, const double *arguments)
{
    double slots[FUNC_SLOTS_MAX];
    load(func, arguments, slots);
    double *out = slots + func->param_count + func->const_count;
    for (int i = 0; i < func->step_count; i++)
        out[i] = compute_fast(&func->steps[i], slots, func->noise);
    return slots[func->result];
}

/* --- derivatives ---------------------------------------------------------------------------- */

/* Derivative of a step of one number. */
static double derivative(FuncOp op, double a, double value)
{
    switch (op) {
    case FUNC_NEG:
        return -1;
    case FUNC_ABS:
        return a < 0 ? -1 : 1;
    case FUNC_SQRT:
        return 0.5 / value;
    case FUNC_EXP:
        return value;
    case FUNC_LN:
        return 1 / a;
    case FUNC_SIN:
        return cos(a);
    case FUNC_COS:
        return -sin(a);
    case FUNC_TAN:
        return 1 + value * value;
    case FUNC_ASIN:
        return 1 / sqrt((1 - a) * (1 + a));
    case FUNC_ACOS:
        return -1 / sqrt((1 - a) * (1 + a));
    case FUNC_ATAN:
        return 1 / (1 + a * a);
    case FUNC_SINH:
        return cosh(a);
    case FUNC_COSH:
        return sinh(a);
    case FUNC_TANH:
        return (1 - value) * (1 + value);
    case FUNC_ASINH:
        return 1 / sqrt(a * a + 1);
    case FUNC_ACOSH:
        return 1 / sqrt((a - 1) * (a + 1));
    case FUNC_ATANH:
        return 1 / ((1 - a) * (1 + a));
    default:
        return 0; /* steps and comparisons */
    }
}

/* Add up n vectors with weights; what is 0 counts nothing, whatever it is multiplied with. */
static V3 weigh(const V3 *g, const double *weight, int n)
{
    V3 sum = v3(0, 0, 0);
    for (int i = 0; i < n; i++)
        if (weight[i] != 0 && v3_max_abs(g[i]) > 0)
            sum = v3_mad(sum, weight[i], g[i]);
    return sum;
}

static V3 power_gradient(double a, double b, double value, const V3 *g)
{
    bool is_fixed = v3_max_abs(g[1]) == 0;
    double by_base = b == 0 ? 0 : b * pow(a, b - 1);
    return weigh(g, (double[]){by_base, is_fixed ? 0 : value * log(a)}, 2);
}

static V3 step_gradient(FuncOp op, const double x[FUNC_FROM_MAX], double value,
                        const V3 g[FUNC_FROM_MAX])
{
    double a = x[0], b = x[1], square = a * a + b * b;
    switch (op) {
    case FUNC_ADD:
        return v3_add(g[0], g[1]);
    case FUNC_SUB:
        return v3_sub(g[0], g[1]);
    case FUNC_MUL:
        return weigh(g, (double[]){b, a}, 2);
    case FUNC_DIV:
        return weigh(g, (double[]){1 / b, -value / b}, 2);
    case FUNC_MOD:
        return weigh(g, (double[]){1, -trunc(a / b)}, 2);
    case FUNC_POW:
        return power_gradient(a, b, value, g);
    case FUNC_ATAN2:
        return weigh(g, (double[]){b / square, -a / square}, 2);
    case FUNC_MIN:
        return a < b ? g[0] : g[1];
    case FUNC_MAX:
        return a > b ? g[0] : g[1];
    case FUNC_SELECT:
        return a < 0 ? g[1] : a == 0 ? g[2] : g[3];
    default:
        return from_count(op) == 1 ? weigh(g, (double[]){derivative(op, a, value)}, 1)
                                   : v3(0, 0, 0);
    }
}

static V3 noise_slope(const Noise *noise, FuncOp op, const double *x, const V3 *g)
{
    V3 slope;
    noise_gradient(noise, (int)op - FUNC_NOISE1 + 1, v3(x[0], x[1], x[2]), &slope);
    return weigh(g, (double[]){slope.x, slope.y, slope.z}, 3);
}

/* Compute all slots, and their derivatives by the first three parameters. */
static void differentiate(const Func *func, const double *arguments, double *slots, V3 *slopes)
{
    static const V3 axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double x[FUNC_FROM_MAX];
    V3 g[FUNC_FROM_MAX];
    load(func, arguments, slots);
    int first = func->param_count + func->const_count;
    for (int i = 0; i < first; i++)
        slopes[i] = i < func->param_count && i < 3 ? axes[i] : v3(0, 0, 0);
    for (int i = 0; i < func->step_count; i++) {
        const FuncStep *step = &func->steps[i];
        take(step, slots, x);
        for (int k = 0; k < FUNC_FROM_MAX; k++)
            g[k] = slopes[step->from[k]];
        double value = slots[first + i] = compute((FuncOp)step->op, x, func->noise);
        slopes[first + i] = func_is_noise((FuncOp)step->op)
                                ? noise_slope(func->noise, (FuncOp)step->op, x, g)
                                : step_gradient((FuncOp)step->op, x, value, g);
    }
}

double func_gradient(const Func *func, const double *arguments, V3 *gradient)
{
    double slots[FUNC_SLOTS_MAX];
    V3 slopes[FUNC_SLOTS_MAX];
    differentiate(func, arguments, slots, slopes);
    *gradient = slopes[func->result];
    return slots[func->result];
}

V3 func_triple(const FuncTriple *triple, const double *arguments, V3 *by_first, V3 *by_second)
{
    double slots[FUNC_SLOTS_MAX];
    V3 slopes[FUNC_SLOTS_MAX];
    differentiate(triple->func, arguments, slots, slopes);
    V3 x = slopes[triple->results[0]], y = slopes[triple->results[1]],
       z = slopes[triple->results[2]];
    *by_first = v3(x.x, y.x, z.x);
    *by_second = v3(x.y, y.y, z.y);
    return v3(slots[triple->results[0]], slots[triple->results[1]], slots[triple->results[2]]);
}

/* --- making --------------------------------------------------------------------------------- */

void func_begin(FuncBuilder *builder, int param_count)
{
    builder->param_count = param_count;
    builder->const_count = builder->step_count = 0;
    builder->noise = NULL;
}

static bool is_full(const FuncBuilder *b)
{
    return b->param_count + b->const_count + b->step_count >= FUNC_SLOTS_MAX;
}

int func_param(const FuncBuilder *builder, int number)
{
    (void)builder;
    return number;
}

int func_const(FuncBuilder *b, double value)
{
    for (int i = 0; i < b->const_count; i++)
        if (memcmp(&b->consts[i], &value, sizeof value) == 0)
            return FIRST_CONST + i;
    if (is_full(b))
        return NO_SLOT;
    b->consts[b->const_count] = value;
    return FIRST_CONST + b->const_count++;
}

bool func_is_const(const FuncBuilder *b, int slot, double *value)
{
    if (slot < FIRST_CONST || slot >= FIRST_STEP)
        return false;
    *value = b->consts[slot - FIRST_CONST];
    return true;
}

/* Find a step that is there already, or return the number of steps. */
static int find_step(const FuncBuilder *b, const FuncStep *step)
{
    int at = 0;
    while (at < b->step_count && memcmp(&b->steps[at], step, sizeof *step) != 0)
        at++;
    return at;
}

static bool is_one(const FuncBuilder *b, int slot)
{
    double value;
    return func_is_const(b, slot, &value) && value == 1;
}

int func_step(FuncBuilder *b, FuncOp op, const int *from)
{
    FuncStep step = {.op = (uint16_t)op, .from = {0}};
    double x[FUNC_FROM_MAX] = {0};
    bool is_const = true;
    int count = from_count(op);
    if (op == FUNC_SELECT && func_is_const(b, from[0], &x[0]))
        return from[x[0] < 0 ? 1 : x[0] == 0 ? 2 : 3];
    for (int i = 0; i < count; i++) {
        if (from[i] == NO_SLOT)
            return NO_SLOT;
        step.from[i] = (uint16_t)from[i];
        is_const &= func_is_const(b, from[i], &x[i]);
    }
    for (int i = count; i < FUNC_FROM_MAX; i++)
        step.from[i] = (uint16_t)from[0]; /* any slot will do */
    if (is_const)
        return func_const(b, compute(op, x, b->noise));
    bool is_times = op == FUNC_MUL, is_power = op == FUNC_POW;
    if ((is_times || is_power) && is_one(b, from[1]))
        return from[0];
    if (is_times && is_one(b, from[0]))
        return from[1];
    int at = find_step(b, &step);
    if (at == b->step_count) {
        if (is_full(b))
            return NO_SLOT;
        b->steps[b->step_count++] = step;
    }
    return FIRST_STEP + at;
}

/* A function being called: what its slots are here. */
typedef struct Call {
    const Func *callee;
    int nodes[FUNC_SLOTS_MAX];
    bool is_needed[FUNC_SLOTS_MAX];
    bool is_known[FUNC_SLOTS_MAX]; /* with these arguments it is a constant */
    double value[FUNC_SLOTS_MAX];
} Call;

/* Find the constants among the steps. */
static void find_known(const FuncBuilder *b, Call *call, const int *arguments)
{
    const Func *callee = call->callee;
    int first = callee->param_count + callee->const_count;
    for (int i = 0; i < first; i++) {
        bool is_param = i < callee->param_count;
        call->value[i] = 0;
        call->is_known[i] = !is_param || func_is_const(b, arguments[i], &call->value[i]);
        if (!is_param)
            call->value[i] = callee->consts[i - callee->param_count];
    }
    for (int i = 0; i < callee->step_count; i++) {
        const FuncStep *step = &callee->steps[i];
        double x[FUNC_FROM_MAX];
        take(step, call->value, x);
        bool is_known = true;
        for (int k = 0; k < FUNC_FROM_MAX; k++)
            is_known &= call->is_known[step->from[k]];
        call->is_known[first + i] = is_known;
        call->value[first + i] = is_known ? compute((FuncOp)step->op, x, callee->noise) : 0;
    }
}

/* Mark what the result is made of: of a choice that is known, what is chosen. */
static void find_needed(Call *call)
{
    const Func *callee = call->callee;
    int first = callee->param_count + callee->const_count;
    for (int i = 0; i < first + callee->step_count; i++)
        call->is_needed[i] = i == callee->result;
    for (int i = callee->step_count - 1; i >= 0; i--) {
        const FuncStep *step = &callee->steps[i];
        if (!call->is_needed[first + i])
            continue;
        bool is_chosen = step->op == FUNC_SELECT && call->is_known[step->from[0]];
        double by = call->value[step->from[0]];
        int only = by < 0 ? 1 : by == 0 ? 2 : 3;
        for (int k = 0; k < FUNC_FROM_MAX; k++)
            if (!is_chosen || k == only || k == 0)
                call->is_needed[step->from[k]] = true;
    }
}

int func_call(FuncBuilder *b, const Func *callee, const int *arguments)
{
    Call call;
    int first = callee->param_count + callee->const_count;
    call.callee = callee;
    if (callee->noise)
        b->noise = callee->noise;
    find_known(b, &call, arguments);
    find_needed(&call);
    for (int i = 0; i < first + callee->step_count; i++) {
        int from[FUNC_FROM_MAX];
        if (!call.is_needed[i])
            call.nodes[i] = NO_SLOT;
        else if (i < callee->param_count)
            call.nodes[i] = arguments[i];
        else if (i < first)
            call.nodes[i] = func_const(b, callee->consts[i - callee->param_count]);
        else {
            const FuncStep *step = &callee->steps[i - first];
            for (int k = 0; k < FUNC_FROM_MAX; k++)
                from[k] = call.nodes[step->from[k]];
            call.nodes[i] = func_step(b, (FuncOp)step->op, from);
        }
    }
    return call.nodes[callee->result];
}

static uint16_t slot_of(const FuncBuilder *b, int node)
{
    int slot = node < FIRST_CONST  ? node
               : node < FIRST_STEP ? b->param_count + node - FIRST_CONST
                                   : b->param_count + b->const_count + node - FIRST_STEP;
    return (uint16_t)slot;
}

const Func *func_end(Arena *arena, const FuncBuilder *b, int result)
{
    Func *func = ARENA_NEW(arena, Func);
    FuncStep *steps = ARENA_ARRAY(arena, FuncStep, (size_t)b->step_count);
    double *consts = ARENA_ARRAY(arena, double, (size_t)b->const_count);
    if (!func || !steps || !consts)
        return NULL;
    memcpy(consts, b->consts, (size_t)b->const_count * sizeof *consts);
    for (int i = 0; i < b->step_count; i++) {
        steps[i].op = b->steps[i].op;
        for (int k = 0; k < FUNC_FROM_MAX; k++)
            steps[i].from[k] = slot_of(b, b->steps[i].from[k]);
    }
    *func = (Func){b->param_count, b->const_count,     b->step_count, consts,
                   steps,          slot_of(b, result), b->noise};
    return func;
}

bool func_join(Arena *arena, const Func *const parts[3], FuncTriple *out)
{
    FuncBuilder code;
    func_begin(&code, 2);
    int results[3];
    const int arguments[3] = {func_param(&code, 0), func_param(&code, 1), func_const(&code, 0)};
    for (int i = 0; i < 3; i++) {
        results[i] = func_call(&code, parts[i], arguments);
        if (results[i] == NO_SLOT)
            return false;
    }
    out->func = func_end(arena, &code, results[0]);
    for (int i = 0; i < 3; i++)
        out->results[i] = slot_of(&code, results[i]);
    return true;
}
