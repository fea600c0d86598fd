/* The library of functions that the language numbers: those with a plain formula.
 *
 * Solids are where the value is below 0.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"

/* The code of one, being made. */
typedef struct Formula {
    FuncBuilder code;
} Formula;

static int param(Formula *f, int number)
{
    return func_param(&f->code, number);
}

static int op(Formula *f, FuncOp op, int a, int b)
{
    return func_step(&f->code, op, (int[]){a, b, a, a});
}

static int square(Formula *f, int a)
{
    return op(f, FUNC_MUL, a, a);
}

static int sum(Formula *f, int a, int b)
{
    return op(f, FUNC_ADD, a, b);
}

static int less(Formula *f, int a, int b)
{
    return op(f, FUNC_SUB, a, b);
}

static int root(Formula *f, int a)
{
    return op(f, FUNC_SQRT, a, a);
}

/* Distance from the origin in the plane, and in space. */
static int length2(Formula *f, int a, int b)
{
    return root(f, sum(f, square(f, a), square(f, b)));
}

static int length3(Formula *f, int a, int b, int c)
{
    return root(f, sum(f, sum(f, square(f, a), square(f, b)), square(f, c)));
}

/* f_r(x, y, z) */
static int radius(Formula *f)
{
    return length3(f, param(f, 0), param(f, 1), param(f, 2));
}

/* f_th(x, y, z): the angle around y */
static int theta(Formula *f)
{
    return op(f, FUNC_ATAN2, param(f, 0), param(f, 2));
}

/* f_ph(x, y, z): the angle from y */
static int phi(Formula *f)
{
    return op(f, FUNC_ATAN2, length2(f, param(f, 0), param(f, 2)), param(f, 1));
}

/* f_sphere(x, y, z, radius) */
static int sphere(Formula *f)
{
    return less(f, radius(f), param(f, 3));
}

/* f_torus(x, y, z, major, minor) */
static int torus(Formula *f)
{
    int ring = less(f, length2(f, param(f, 0), param(f, 2)), param(f, 3));
    return less(f, length2(f, ring, param(f, 1)), param(f, 4));
}

/* f_ellipsoid(x, y, z, a, b, c): their inverses are the half axes; 0 at the centre */
static int ellipsoid(Formula *f)
{
    int side[3];
    for (int i = 0; i < 3; i++)
        side[i] = op(f, FUNC_MUL, param(f, i), param(f, 3 + i));
    return length3(f, side[0], side[1], side[2]);
}

/* f_paraboloid(x, y, z, strength) */
static int paraboloid(Formula *f)
{
    int flat = sum(f, square(f, param(f, 0)), square(f, param(f, 2)));
    return op(f, FUNC_MUL, less(f, flat, param(f, 1)), op(f, FUNC_NEG, param(f, 3), param(f, 3)));
}

static const struct {
    int number, params;
    int (*make)(Formula *);
} formulas[] = {
    {17, 6, ellipsoid}, {45, 4, paraboloid}, {47, 3, phi},   {57, 3, radius},
    {61, 4, sphere},    {69, 3, theta},      {70, 5, torus},
};

const Func *function_internal(Parser *p, int number)
{
    for (size_t i = 0; i < sizeof formulas / sizeof *formulas; i++) {
        if (formulas[i].number != number)
            continue;
        Formula f;
        func_begin(&f.code, formulas[i].params);
        int result = formulas[i].make(&f);
        return parse_no_null(p, func_end(parse_arena(p), &f.code, result));
    }
    return NULL;
}
