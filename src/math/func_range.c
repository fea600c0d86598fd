/* Bounds on functions over stretches: interval arithmetic, with derivatives.
 *
 * Every bound is moved outward by more than the rounding of what it was computed with, so that what
 * holds for the ranges holds for the values as func_value rounds them.  What may be no number has
 * the range of all, since steps like `min` may make a number of it again.
 * SPDX-License-Identifier: Apache-2.0 */
#include "math/eps.h"
#include "math/func.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Rounding of arithmetic, and of the library's functions, with room to spare. */
#define ROUND_EXACT (2 * EPS_DOUBLE)
#define ROUND_LIBRARY (8 * EPS_DOUBLE)

static inline Range range(double lo, double hi)
{
    return (Range){lo, hi};
}

static Range outward(Range r, double rounding)
{
    return range(r.lo - rounding * fabs(r.lo), r.hi + rounding * fabs(r.hi));
}

static bool is_point(Range r)
{
    return r.lo == r.hi;
}

static inline bool is_finite(Range r)
{
    return r.lo > -INFINITY && r.hi < INFINITY;
}

static bool has_zero(Range r)
{
    return !(r.lo > 0 || r.hi < 0);
}

static Range hull(Range a, Range b)
{
    return range(num_min(a.lo, b.lo), num_max(a.hi, b.hi));
}

static Range negative(Range a)
{
    return range(-a.hi, -a.lo);
}

static Range sum(Range a, Range b)
{
    return outward(range(a.lo + b.lo, a.hi + b.hi), ROUND_EXACT);
}

/* 0 times what is infinite is 0: the bound is not reached. */
static inline double product(double a, double b)
{
    double p = a * b;
    return isnan(p) ? 0 : p;
}

/* The product with a number. */
static Range scaled(double a, Range b)
{
    double p = product(a, b.lo), q = product(a, b.hi);
    return outward(a < 0 ? range(q, p) : range(p, q), ROUND_EXACT);
}

static Range times(Range a, Range b)
{
    if (is_point(a))
        return scaled(a.lo, b);
    if (is_point(b))
        return scaled(b.lo, a);
    double p = product(a.lo, b.lo), q = product(a.lo, b.hi);
    double r = product(a.hi, b.lo), s = product(a.hi, b.hi);
    return outward(
        range(num_min(num_min(p, q), num_min(r, s)), num_max(num_max(p, q), num_max(r, s))),
        ROUND_EXACT);
}

/* The same for values: 0 times what is infinite is no number. */
static Range product_of(Range a, Range b)
{
    bool is_none = (!is_finite(a) && has_zero(b)) || (!is_finite(b) && has_zero(a));
    return is_none ? RANGE_ALL : times(a, b);
}

static Range square(Range a)
{
    double lo = a.lo * a.lo, hi = a.hi * a.hi;
    double least = has_zero(a) ? 0 : num_min(lo, hi);
    return outward(range(least, num_max(lo, hi)), ROUND_EXACT);
}

static Range inverse(Range a)
{
    return has_zero(a) ? RANGE_ALL : outward(range(1 / a.hi, 1 / a.lo), ROUND_EXACT);
}

/* --- functions of one number: values --------------------------------------------------------- */

/* Where a monotone function is defined. */
static Range domain_of(FuncOp op)
{
    switch (op) {
    case FUNC_SQRT:
    case FUNC_LN:
        return range(0, INFINITY);
    case FUNC_ASIN:
    case FUNC_ACOS:
    case FUNC_ATANH:
        return range(-1, 1);
    case FUNC_ACOSH:
        return range(1, INFINITY);
    default:
        return RANGE_ALL;
    }
}

static double at(FuncOp op, double x)
{
    switch (op) {
    case FUNC_SQRT:
        return sqrt(x);
    case FUNC_EXP:
        return exp(x);
    case FUNC_LN:
        return log(x);
    case FUNC_ASIN:
        return asin(x);
    case FUNC_ACOS:
        return acos(x);
    case FUNC_ATAN:
        return atan(x);
    case FUNC_SINH:
        return sinh(x);
    case FUNC_TANH:
        return tanh(x);
    case FUNC_ASINH:
        return asinh(x);
    case FUNC_ACOSH:
        return acosh(x);
    case FUNC_ATANH:
        return atanh(x);
    default:
        return x;
    }
}

static Range within(Range a, Range domain)
{
    return range(num_max(a.lo, domain.lo), num_min(a.hi, domain.hi));
}

static Range monotone(FuncOp op, Range a)
{
    Range domain = domain_of(op);
    if (!(a.lo >= domain.lo && a.hi <= domain.hi))
        return RANGE_ALL;
    Range v = range(at(op, a.lo), at(op, a.hi));
    v = outward(op == FUNC_ACOS ? range(v.hi, v.lo) : v, ROUND_LIBRARY);
    if (op == FUNC_SQRT || op == FUNC_EXP)
        v.lo = num_max(v.lo, 0);
    return v;
}

/* Does a stretch contain a multiple of the period plus an offset?  Yes when in doubt. */
static bool has_multiple(Range a, double offset, double period)
{
    double lo = (a.lo - offset) / period, hi = (a.hi - offset) / period;
    double doubt = ROUND_LIBRARY * (1 + fabs(lo) + fabs(hi));
    return !(floor(hi + doubt) < ceil(lo - doubt));
}

/* A sine whose values at the ends are given, and which is 1 at `top` and -1 half a turn on. */
static Range wave(Range a, double lo, double hi, double top)
{
    if (!(a.hi - a.lo < 2 * PMS_PI))
        return is_finite(a) ? range(-1, 1) : RANGE_ALL;
    Range v = outward(range(num_min(lo, hi), num_max(lo, hi)), ROUND_LIBRARY);
    if (has_multiple(a, top, 2 * PMS_PI))
        v.hi = 1;
    if (has_multiple(a, top - PMS_PI, 2 * PMS_PI))
        v.lo = -1;
    return within(v, range(-1, 1));
}

static Range sine(Range a)
{
    return wave(a, sin(a.lo), sin(a.hi), PMS_PI / 2);
}

static Range cosine(Range a)
{
    return wave(a, cos(a.lo), cos(a.hi), 0);
}

static Range tangent(Range a)
{
    if (!(a.hi - a.lo < PMS_PI) || has_multiple(a, PMS_PI / 2, PMS_PI))
        return RANGE_ALL;
    return outward(range(tan(a.lo), tan(a.hi)), ROUND_LIBRARY);
}

static Range hyperbolic_cosine(Range a)
{
    double lo = cosh(a.lo), hi = cosh(a.hi);
    return outward(range(has_zero(a) ? 1 : num_min(lo, hi), num_max(lo, hi)), ROUND_LIBRARY);
}

static Range magnitude(Range a)
{
    return a.lo >= 0 ? a : a.hi <= 0 ? negative(a) : range(0, num_max(-a.lo, a.hi));
}

static Range truncated(Range a)
{
    bool is_known = a.lo >= INT32_MIN && a.hi <= INT32_MAX;
    return is_known ? range(trunc(a.lo), trunc(a.hi)) : range(INT32_MIN, INT32_MAX);
}

/* --- functions of several numbers: values ----------------------------------------------------- */

/* Does a mod b keep to one stretch of it, where it is a less a constant? */
static bool is_one_turn(Range a, Range b)
{
    return is_point(b) && b.lo != 0 && trunc(a.lo / b.lo) == trunc(a.hi / b.lo);
}

static Range modulo(Range a, Range b)
{
    double most = num_max(fabs(b.lo), fabs(b.hi));
    if (!is_finite(a) || has_zero(b))
        return RANGE_ALL;
    if (is_one_turn(a, b))
        return range(fmod(a.lo, b.lo), fmod(a.hi, b.lo));
    return range(a.lo < 0 ? -most : 0, a.hi > 0 ? most : 0);
}

/* x^n for a whole n >= 0. */
static Range whole_power(Range a, double n)
{
    if (n == 0)
        return range(1, 1);
    if (n == 2)
        return square(a);
    double lo = pow(a.lo, n), hi = pow(a.hi, n);
    bool is_even = fmod(n, 2) == 0;
    Range v = range(is_even && has_zero(a) ? 0 : num_min(lo, hi), num_max(lo, hi));
    return outward(v, ROUND_LIBRARY);
}

static bool is_whole_power(Range exponent)
{
    return is_point(exponent) && rint(exponent.lo) == exponent.lo && fabs(exponent.lo) < 1e6;
}

/* Other powers of negative numbers are none. */
static Range power(Range a, Range b)
{
    if (is_whole_power(b))
        return b.lo >= 0 ? whole_power(a, b.lo) : inverse(whole_power(a, -b.lo));
    if (!(a.lo >= 0))
        return RANGE_ALL;
    double p = pow(a.lo, b.lo), q = pow(a.lo, b.hi), r = pow(a.hi, b.lo), s = pow(a.hi, b.hi);
    Range v =
        outward(range(num_min(num_min(p, q), num_min(r, s)), num_max(num_max(p, q), num_max(r, s))),
                ROUND_LIBRARY);
    return range(num_max(0, v.lo), v.hi);
}

/* May atan2 jump from one side of the negative axis to the other? */
static bool is_cut(Range y, Range x)
{
    return x.lo <= 0 && has_zero(y);
}

static Range angle(Range y, Range x)
{
    if (is_cut(y, x))
        return outward(range(-PMS_PI, PMS_PI), ROUND_LIBRARY);
    /* Not around the origin: the extremes are at corners of the box. */
    double p = atan2(y.lo, x.lo), q = atan2(y.lo, x.hi);
    double r = atan2(y.hi, x.lo), s = atan2(y.hi, x.hi);
    return outward(
        range(num_min(num_min(p, q), num_min(r, s)), num_max(num_max(p, q), num_max(r, s))),
        ROUND_LIBRARY);
}

/* What is known of something that is true or false. */
static Range truth(bool may_be_false, bool may_be_true)
{
    return range(may_be_false ? 0 : 1, may_be_true ? 1 : 0);
}

static Range compare(FuncOp op, Range a, Range b)
{
    bool may_meet = a.lo <= b.hi && b.lo <= a.hi, is_same = is_point(a) && is_point(b) && may_meet;
    switch (op) {
    case FUNC_LESS:
        return truth(a.hi >= b.lo, a.lo < b.hi);
    case FUNC_LESS_EQUAL:
        return truth(a.hi > b.lo, a.lo <= b.hi);
    case FUNC_EQUAL:
        return truth(!is_same, may_meet);
    default:
        return truth(may_meet, !is_same);
    }
}

static Range combine(FuncOp op, Range a, Range b)
{
    bool a_false = has_zero(a), a_true = a.lo != 0 || a.hi != 0;
    bool b_false = has_zero(b), b_true = b.lo != 0 || b.hi != 0;
    return op == FUNC_AND ? truth(a_false || b_false, a_true && b_true)
                          : truth(a_false && b_false, a_true || b_true);
}

/* Return which of its three choices `select` takes, or 0: more than one. */
static int chosen(Range by)
{
    return by.hi < 0 ? 1 : by.lo > 0 ? 3 : by.lo == 0 && by.hi == 0 ? 2 : 0;
}

static Range choose(const Range *x)
{
    if (chosen(x[0]))
        return x[chosen(x[0])];
    Range all = hull(x[0].lo < 0 ? x[1] : x[2], x[2]);
    return x[0].hi > 0 ? hull(all, x[3]) : all;
}

static Range step_value(const FuncStep *step, const Range x[FUNC_FROM_MAX])
{
    FuncOp op = (FuncOp)step->op;
    Range a = x[0], b = x[1];
    switch (op) {
    case FUNC_ADD:
        return sum(a, b);
    case FUNC_SUB:
        return sum(a, negative(b));
    case FUNC_MUL:
        return step->from[0] == step->from[1] ? square(a) : product_of(a, b);
    case FUNC_DIV:
        return product_of(a, inverse(b));
    case FUNC_MOD:
        return modulo(a, b);
    case FUNC_POW:
        return power(a, b);
    case FUNC_ATAN2:
        return angle(a, b);
    case FUNC_MIN:
        return range(num_min(a.lo, b.lo), num_min(a.hi, b.hi));
    case FUNC_MAX:
        return range(num_max(a.lo, b.lo), num_max(a.hi, b.hi));
    case FUNC_LESS:
    case FUNC_LESS_EQUAL:
    case FUNC_EQUAL:
    case FUNC_NOT_EQUAL:
        return compare(op, a, b);
    case FUNC_AND:
    case FUNC_OR:
        return combine(op, a, b);
    case FUNC_SELECT:
        return choose(x);
    case FUNC_NEG:
        return negative(a);
    case FUNC_ABS:
        return magnitude(a);
    case FUNC_SIN:
        return sine(a);
    case FUNC_COS:
        return cosine(a);
    case FUNC_TAN:
        return tangent(a);
    case FUNC_COSH:
        return hyperbolic_cosine(a);
    case FUNC_FLOOR:
        return range(floor(a.lo), floor(a.hi));
    case FUNC_CEIL:
        return range(ceil(a.lo), ceil(a.hi));
    case FUNC_INT:
        return truncated(a);
    default:
        return monotone(op, a);
    }
}

/* --- slopes ----------------------------------------------------------------------------------- */

/* 1 over the root of a range of squares. */
static Range inverse_root(Range a)
{
    double most = sqrt(num_max(0, a.hi)), least = sqrt(num_max(0, a.lo));
    return outward(range(1 / most, 1 / least), ROUND_LIBRARY);
}

/* Bound the derivative of a monotone function where its value is v. */
static Range derivative(FuncOp op, Range a, Range v)
{
    const Range one = {1, 1};
    switch (op) {
    case FUNC_SQRT:
        return outward(range(0.5 / v.hi, 0.5 / v.lo), ROUND_EXACT);
    case FUNC_EXP:
        return v;
    case FUNC_LN:
        return outward(range(1 / a.hi, 1 / num_max(0, a.lo)), ROUND_EXACT);
    case FUNC_ASIN:
        return inverse_root(sum(one, negative(square(a))));
    case FUNC_ACOS:
        return negative(inverse_root(sum(one, negative(square(a)))));
    case FUNC_ATAN:
        return inverse(sum(one, square(a)));
    case FUNC_SINH:
        return hyperbolic_cosine(a);
    case FUNC_TANH:
        return sum(one, negative(square(v)));
    case FUNC_ASINH:
        return inverse_root(sum(one, square(a)));
    case FUNC_ACOSH:
        return inverse_root(sum(square(a), negative(one)));
    default: { /* FUNC_ATANH */
        Range room = sum(one, negative(square(a)));
        return outward(range(1 / room.hi, 1 / num_max(0, room.lo)), ROUND_EXACT);
    }
    }
}

static Range monotone_slope(FuncOp op, Range a, Range slope, Range v)
{
    Range domain = domain_of(op);
    bool is_all_in = a.lo >= domain.lo && a.hi <= domain.hi;
    return is_all_in ? times(derivative(op, a, v), slope) : RANGE_ALL;
}

/* Of a function that jumps from one level to the next. */
static Range stairs_slope(Range v)
{
    return is_point(v) ? range(0, 0) : RANGE_ALL;
}

static Range quotient_slope(const Range *x, const Range *s, Range v)
{
    return has_zero(x[1]) ? RANGE_ALL : times(sum(s[0], negative(times(v, s[1]))), inverse(x[1]));
}

static Range power_slope(const Range *x, const Range *s, Range v)
{
    if (is_whole_power(x[1])) {
        double n = x[1].lo;
        if (n == 0)
            return range(0, 0);
        Range less = n > 0 ? whole_power(x[0], n - 1) : inverse(whole_power(x[0], 1 - n));
        return n < 0 && has_zero(x[0]) ? RANGE_ALL : times(scaled(n, less), s[0]);
    }
    if (!(x[0].lo > 0))
        return RANGE_ALL;
    /* The derivative of exp(b ln a). */
    Range log_base = monotone(FUNC_LN, x[0]), log_slope = times(inverse(x[0]), s[0]);
    return times(v, sum(times(x[1], log_slope), times(s[1], log_base)));
}

static Range angle_slope(const Range *x, const Range *s)
{
    if (is_cut(x[0], x[1]))
        return RANGE_ALL;
    Range turn = sum(times(x[1], s[0]), negative(times(x[0], s[1])));
    return times(turn, inverse(sum(square(x[0]), square(x[1]))));
}

/* That of the lesser of two, or of the greater one. */
static Range extreme_slope(Range least, Range other, Range slope, Range other_slope)
{
    return least.hi <= other.lo   ? slope
           : other.hi <= least.lo ? other_slope
                                  : hull(slope, other_slope);
}

static Range step_slope(const FuncStep *step, const Range x[FUNC_FROM_MAX],
                        const Range s[FUNC_FROM_MAX], Range v)
{
    FuncOp op = (FuncOp)step->op;
    switch (op) {
    case FUNC_ADD:
        return sum(s[0], s[1]);
    case FUNC_SUB:
        return sum(s[0], negative(s[1]));
    case FUNC_MUL:
        return step->from[0] == step->from[1] ? scaled(2, times(x[0], s[0]))
                                              : sum(times(s[0], x[1]), times(x[0], s[1]));
    case FUNC_DIV:
        return quotient_slope(x, s, v);
    case FUNC_MOD:
        return is_one_turn(x[0], x[1]) ? s[0] : RANGE_ALL;
    case FUNC_POW:
        return power_slope(x, s, v);
    case FUNC_ATAN2:
        return angle_slope(x, s);
    case FUNC_MIN:
        return extreme_slope(x[0], x[1], s[0], s[1]);
    case FUNC_MAX:
        return extreme_slope(x[1], x[0], s[0], s[1]);
    case FUNC_SELECT:
        return chosen(x[0]) ? s[chosen(x[0])] : RANGE_ALL;
    case FUNC_NEG:
        return negative(s[0]);
    case FUNC_ABS:
        return x[0].lo >= 0 ? s[0] : x[0].hi <= 0 ? negative(s[0]) : hull(s[0], negative(s[0]));
    case FUNC_SIN:
        return times(cosine(x[0]), s[0]);
    case FUNC_COS:
        return times(negative(sine(x[0])), s[0]);
    case FUNC_TAN:
        return times(sum(range(1, 1), square(v)), s[0]);
    case FUNC_COSH:
        return times(monotone(FUNC_SINH, x[0]), s[0]);
    case FUNC_SQRT:
    case FUNC_EXP:
    case FUNC_LN:
    case FUNC_ASIN:
    case FUNC_ACOS:
    case FUNC_ATAN:
    case FUNC_SINH:
    case FUNC_TANH:
    case FUNC_ASINH:
    case FUNC_ACOSH:
    case FUNC_ATANH:
        return monotone_slope(op, x[0], s[0], v);
    default: /* steps and comparisons */
        return stairs_slope(v);
    }
}

/* --- functions -------------------------------------------------------------------------------- */

/* What overflow has made of a bound is no bound. */
static Range mended(Range r)
{
    return range(isnan(r.lo) ? -INFINITY : r.lo, isnan(r.hi) ? INFINITY : r.hi);
}

/* What stands for no number anywhere. */
static Range none(void)
{
    return range(NAN, NAN);
}

static bool is_none(Range r)
{
    return isnan(r.lo);
}

/* May the values in a range be no numbers? */
static bool may_be_none(Range r)
{
    return is_none(r) || (r.lo == -INFINITY && r.hi == INFINITY);
}

/* Is a step no number where one of its own is none?  A power may be 1 all the same, and of two the
 * least or the largest may be the other. */
static bool keeps_none(FuncOp op)
{
    return op != FUNC_POW && op != FUNC_MIN && op != FUNC_MAX;
}

/* Is the step no number for any of these? */
static bool has_no_value(FuncOp op, const Range x[FUNC_FROM_MAX])
{
    switch (op) {
    case FUNC_SQRT:
    case FUNC_LN:
        return x[0].hi < 0;
    case FUNC_POW:
        return x[0].hi < 0 && is_point(x[1]) && rint(x[1].lo) != x[1].lo;
    default:
        return false;
    }
}

/* Does a step make a number of what is none, and do its own bounds say so? */
static bool is_sure(FuncOp op)
{
    return op == FUNC_SELECT || op == FUNC_INT || (op >= FUNC_LESS && op <= FUNC_OR);
}

/* All but the choice and noise have two numbers at most; of those that have one, both are that. */
static Range sure_value(const FuncStep *step, const Range x[FUNC_FROM_MAX], const Noise *noise)
{
    FuncOp op = (FuncOp)step->op;
    if (func_is_noise(op))
        return noise_range(noise, step->op - FUNC_NOISE1 + 1, x, NULL);
    if (!is_sure(op) && (may_be_none(x[0]) || may_be_none(x[1])))
        return keeps_none(op) && (is_none(x[0]) || is_none(x[1])) ? none() : RANGE_ALL;
    return has_no_value(op, x) ? none() : mended(step_value(step, x));
}

static void take(const FuncStep *step, const Range *slots, Range x[FUNC_FROM_MAX])
{
    x[0] = slots[step->from[0]];
    x[1] = slots[step->from[1]];
    if (step->op < FUNC_SELECT || step->op > FUNC_NOISE3)
        return;
    x[2] = slots[step->from[2]];
    x[3] = slots[step->from[3]];
}

Range func_range(const Func *func, const Range *arguments, FuncRanges *work)
{
    Range *slots = work->value, x[FUNC_FROM_MAX] = {{0, 0}};
    memcpy(slots, arguments, (size_t)func->param_count * sizeof *slots);
    Range *consts = slots + func->param_count, *out = consts + func->const_count;
    for (int i = 0; i < func->const_count; i++)
        consts[i] = mended(range(func->consts[i], func->consts[i]));
    for (int i = 0; i < func->step_count; i++) {
        take(&func->steps[i], slots, x);
        FuncOp op = (FuncOp)func->steps[i].op;
        for (int k = 0; k < FUNC_FROM_MAX && (is_sure(op) || func_is_noise(op)); k++)
            x[k] = mended(x[k]);
        out[i] = sure_value(&func->steps[i], x, func->noise);
    }
    work->has_no_value = is_none(slots[func->result]);
    return mended(slots[func->result]);
}

static Range noise_slope(const FuncStep *step, const Range *x, const Range *s, const Noise *noise)
{
    Range slopes[3];
    noise_range(noise, step->op - FUNC_NOISE1 + 1, x, slopes);
    return sum(sum(times(slopes[0], s[0]), times(slopes[1], s[1])), times(slopes[2], s[2]));
}

Range func_slope(const Func *func, const Range *slopes, FuncRanges *work)
{
    Range *slots = work->slope, x[FUNC_FROM_MAX], s[FUNC_FROM_MAX];
    memcpy(slots, slopes, (size_t)func->param_count * sizeof *slots);
    int first = func->param_count + func->const_count;
    for (int i = func->param_count; i < first; i++)
        slots[i] = range(0, 0);
    for (int i = 0; i < func->step_count; i++) {
        Range value = work->value[first + i];
        take(&func->steps[i], work->value, x);
        take(&func->steps[i], slots, s);
        /* Around a pole there is no slope, nor where there may be no value. */
        slots[first + i] = may_be_none(value) ? RANGE_ALL
                           : func_is_noise((FuncOp)func->steps[i].op)
                               ? mended(noise_slope(&func->steps[i], x, s, func->noise))
                               : mended(step_slope(&func->steps[i], x, s, value));
    }
    return slots[func->result];
}
