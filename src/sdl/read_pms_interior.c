/* pms{} of an interior: what pms knows of transparent matter beyond the common language.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/read_int.h"

enum { PRIORITY_MAX = 1000000 };

/* Read up to `most` numbers, at least `least`, into coefficients. */
static void read_formula(Parser *p, Interior *interior, DispersionKind kind, int least, int most)
{
    const char *name = kind == DISPERSION_CAUCHY ? "cauchy" : "sellmeier";
    double coefficients[6] = {0};
    Span first = parse_last_span(p);
    for (int i = 0; i < most; i++) {
        if (i >= least && !parse_is_expression(p))
            break;
        coefficients[i] = read_finite(p, name, NULL);
        if (i + 1 < most)
            parse_comma(p);
    }
    if (!interior_set_formula(interior, kind, coefficients))
        parse_fail(p, span_join(first, parse_last_span(p)),
                   "%s gives no index of refraction for all light, 380 to 730 nm (wavelengths are "
                   "in micrometres)",
                   name);
}

void read_pms_interior(Parser *p, Interior *interior)
{
    read_open(p);
    while (!read_close(p)) {
        Token word = parse_next(p);
        if (read_is_word(&word, "priority"))
            interior->priority = (int)parse_int(p, "priority", -PRIORITY_MAX, PRIORITY_MAX);
        else if (read_is_word(&word, "cauchy"))
            read_formula(p, interior, DISPERSION_CAUCHY, 2, 3);
        else if (read_is_word(&word, "sellmeier"))
            read_formula(p, interior, DISPERSION_SELLMEIER, 6, 6);
        else
            parse_fail(p, word.span,
                       "pms{} of an interior has priority, cauchy and sellmeier; this is none");
    }
}
