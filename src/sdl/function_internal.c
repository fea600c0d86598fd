/* The library of functions that the language numbers.
 *
 * Each is made from its formula as if the scene had it, so that bounds and derivatives come with
 * it.  Formulas were found from the names and from values of POV-Ray.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"

static const struct {
    int number, params;
    const char *formula;
} formulas[] = {
#define X(number, name, params, formula) {number, params, formula},
#include "sdl/internal.def"
#undef X
};

/* f_noise3d(x, y, z): by the generator of the scene. */
static int scene_noise(const Parser *p, FuncBuilder *code)
{
    int from[] = {0, 1, 2, 0};
    return func_step(code, (FuncOp)(FUNC_NOISE1 + parse_noise_generator(p) - 1), from);
}

static int by_formula(FuncBuilder *code, const char *text)
{
    return formula_code(code, text, code->param_count);
}

/* Return how many parameters a function has, 0: pms has it not; and its formula, if it has one. */
static int find_formula(int number, const char **text)
{
    for (size_t i = 0; i < sizeof formulas / sizeof *formulas; i++) {
        if (formulas[i].number == number) {
            *text = formulas[i].formula;
            return formulas[i].params;
        }
    }
    return 0;
}

/* Those without a formula. */
enum { HETERO_MF = 29, RIDGE = 58, RIDGED_MF = 59, NOISE3D = 76, FRACTAL_PARAMS = 9 };

const Func *function_internal(Parser *p, int number)
{
    FuncBuilder code;
    const char *text = NULL;
    bool is_fractal = number == HETERO_MF || number == RIDGE || number == RIDGED_MF;
    int params = is_fractal ? FRACTAL_PARAMS : number == NOISE3D ? 3 : find_formula(number, &text);
    if (params == 0)
        return NULL;
    func_begin(&code, params);
    code.noise = parse_noise(p);
    int result = text                  ? by_formula(&code, text)
                 : number == NOISE3D   ? scene_noise(p, &code)
                 : number == RIDGE     ? fractal_ridge(&code)
                 : number == HETERO_MF ? fractal_hetero(&code)
                                       : fractal_ridged(&code);
    return parse_no_null(p, func_end(parse_arena(p), &code, result));
}
