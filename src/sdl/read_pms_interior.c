/* pms{} of an interior: what pms knows of transparent matter beyond the common language.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/read_int.h"

enum { PRIORITY_MAX = 1000000 };

/* Read `least` numbers and as many more as there are, up to `most`; returns how many. */
static int read_numbers(Parser *p, const char *name, int least, int most, double *out)
{
    int count = 0;
    while (count < most && (count < least || parse_is_expression(p))) {
        out[count++] = read_finite(p, name, NULL);
        parse_comma(p);
    }
    return count;
}

static void set_formula(Parser *p, Interior *interior, DispersionKind kind, const Token *word,
                        const double coefficients[DISPERSION_COEFFICIENTS])
{
    if (!interior_set_formula(interior, kind, coefficients))
        parse_fail(p, span_join(word->span, parse_last_span(p)),
                   "this gives no index of refraction for all light from 380 to 730 nm "
                   "(wavelengths are in micrometres)");
}

static void read_cauchy(Parser *p, Interior *interior, const Token *word)
{
    double coefficients[DISPERSION_COEFFICIENTS] = {0};
    read_numbers(p, "cauchy", 2, 3, coefficients);
    set_formula(p, interior, DISPERSION_CAUCHY, word, coefficients);
}

static void read_sellmeier(Parser *p, Interior *interior, const Token *word)
{
    double coefficients[DISPERSION_COEFFICIENTS] = {0};
    int count = read_numbers(p, "sellmeier", 2, DISPERSION_COEFFICIENTS, coefficients);
    if (count % 2)
        parse_fail(p, parse_last_span(p), "sellmeier wants pairs of numbers B, C; got %d numbers",
                   count);
    set_formula(p, interior, DISPERSION_SELLMEIER, word, coefficients);
}

void read_pms_interior(Parser *p, Interior *interior)
{
    enum { PRIORITY, CAUCHY, SELLMEIER, COUNT };
    static const char *const words[COUNT] = {"priority", "cauchy", "sellmeier"};
    read_open(p);
    while (!read_close(p)) {
        Token word = *parse_peek(p);
        int choice = read_choice(p, "pms { } of an interior", words, COUNT);
        if (choice == PRIORITY)
            interior->priority = (int)parse_int(p, "priority", -PRIORITY_MAX, PRIORITY_MAX);
        else if (choice == CAUCHY)
            read_cauchy(p, interior, &word);
        else
            read_sellmeier(p, interior, &word);
    }
}
