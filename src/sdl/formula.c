/* Formulas of the program's own, as text, made into code.
 *
 *     formula = { NAME "=" sum ";" } sum
 *     sum     = product { ("+" | "-") product }
 *     product = factor { ("*" | "/") factor }
 *     factor  = ["-"] primary [ "^" DIGIT ]
 *     primary = NUMBER | NAME | NAME "(" sum { "," sum } ")" | "(" sum ")"
 *
 * Names of one letter are numbers: x, y, z, then the other parameters from a on, and what the
 * formula sets.  What is wrong with one is our own mistake.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"

#include <assert.h>
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

typedef struct FormulaReader {
    FuncBuilder *code;
    const char *at;
    int slots['z' + 1]; /* of names */
} FormulaReader;

static int read_sum(FormulaReader *r);

static int step(FormulaReader *r, FuncOp op, const int *from)
{
    return func_step(r->code, op, from);
}

static int binary(FormulaReader *r, FuncOp op, int a, int b)
{
    return step(r, op, (int[]){a, b, a, a});
}

static char peek(FormulaReader *r)
{
    while (*r->at == ' ')
        r->at++;
    return *r->at;
}

static bool accept(FormulaReader *r, char c)
{
    bool is_there = peek(r) == c;
    r->at += is_there;
    return is_there;
}

static void expect(FormulaReader *r, char c)
{
    bool is_there = accept(r, c);
    assert(is_there);
    (void)is_there;
}

static const struct {
    const char *name;
    FuncOp op;
} calls[] = {
    {"abs", FUNC_ABS},       {"atan2", FUNC_ATAN2},   {"cos", FUNC_COS}, {"exp", FUNC_EXP},
    {"floor", FUNC_FLOOR},   {"max", FUNC_MAX},       {"min", FUNC_MIN}, {"noise1", FUNC_NOISE1},
    {"noise2", FUNC_NOISE2}, {"noise3", FUNC_NOISE3}, {"pow", FUNC_POW}, {"select", FUNC_SELECT},
    {"sin", FUNC_SIN},       {"sqrt", FUNC_SQRT},
};

static int read_call(FormulaReader *r, const char *name, size_t length)
{
    int from[FUNC_FROM_MAX], count = 0;
    expect(r, '(');
    do
        from[count++] = read_sum(r);
    while (accept(r, ','));
    expect(r, ')');
    for (int i = count; i < FUNC_FROM_MAX; i++)
        from[i] = from[0];
    for (size_t i = 0; i < sizeof calls / sizeof *calls; i++)
        if (strlen(calls[i].name) == length && memcmp(calls[i].name, name, length) == 0)
            return step(r, calls[i].op, from);
    assert(!"a function of formulas");
    return from[0];
}

static int read_primary(FormulaReader *r)
{
    char c = peek(r);
    if (accept(r, '(')) {
        int slot = read_sum(r);
        expect(r, ')');
        return slot;
    }
    if (isdigit((unsigned char)c)) {
        char *end;
        double value = strtod(r->at, &end);
        r->at = end;
        return func_const(r->code, value);
    }
    const char *name = r->at;
    while (isalnum((unsigned char)*r->at))
        r->at++;
    size_t length = (size_t)(r->at - name);
    if (peek(r) == '(')
        return read_call(r, name, length);
    assert(length == 1 && r->slots[(unsigned char)c] != NO_SLOT);
    return r->slots[(unsigned char)c];
}

/* Squares of squares: their bounds are known not to be negative. */
static int whole_power(FormulaReader *r, int base, int n)
{
    if (n == 1)
        return base;
    int root = whole_power(r, base, n % 2 ? n - 1 : n / 2);
    return binary(r, FUNC_MUL, root, n % 2 ? base : root);
}

static int read_factor(FormulaReader *r)
{
    if (accept(r, '-')) {
        int slot = read_factor(r);
        return binary(r, FUNC_NEG, slot, slot);
    }
    int slot = read_primary(r);
    return accept(r, '^') ? whole_power(r, slot, *r->at++ - '0') : slot;
}

static int read_product(FormulaReader *r)
{
    int left = read_factor(r);
    for (;;) {
        bool is_times = accept(r, '*');
        if (!is_times && !accept(r, '/'))
            return left;
        int right = read_factor(r);
        left = binary(r, is_times ? FUNC_MUL : FUNC_DIV, left, right);
    }
}

static int read_sum(FormulaReader *r)
{
    int left = read_product(r);
    for (;;) {
        bool is_plus = accept(r, '+');
        if (!is_plus && !accept(r, '-'))
            return left;
        int right = read_product(r);
        left = binary(r, is_plus ? FUNC_ADD : FUNC_SUB, left, right);
    }
}

/* Take `NAME =` if that comes next. */
static char accept_setting(FormulaReader *r)
{
    const char *begin = r->at;
    char name = peek(r);
    if (islower((unsigned char)name)) {
        r->at++;
        if (accept(r, '='))
            return name;
    }
    r->at = begin;
    return '\0';
}

int formula_code(FuncBuilder *code, const char *text, int param_count)
{
    FormulaReader r = {.code = code, .at = text};
    for (size_t i = 0; i < sizeof r.slots / sizeof *r.slots; i++)
        r.slots[i] = NO_SLOT;
    for (int i = 0; i < param_count; i++)
        r.slots[i < 3 ? 'x' + i : 'a' + i - 3] = func_param(code, i);
    for (char name; (name = accept_setting(&r));) {
        r.slots[(unsigned char)name] = read_sum(&r);
        expect(&r, ';');
    }
    int result = read_sum(&r);
    assert(peek(&r) == '\0');
    return result;
}
