/* What interiors do to light: refraction by wavelength, absorption.
 * SPDX-License-Identifier: Apache-2.0 */
#include "texture/texture.h"

#include "math/spectrum.h"

/* The wavelength, nm, that the language's ior is for: the middle of the spectrum; and the helium
 * d line, which the index of a glass by formula is given at. */
#define WAVELENGTH_MIDDLE (0.5 * (SPECTRUM_FIRST + SPECTRUM_LAST))
#define WAVELENGTH_D 587.56

/* Return the index of a formula at a wavelength, or NAN. */
static double formula_ior(DispersionKind kind, const double *c, double wavelength)
{
    double w = wavelength * 1e-3, w2 = w * w;
    if (kind == DISPERSION_CAUCHY)
        return c[0] + (c[1] + c[2] / w2) / w2;
    double n2 = 1;
    for (int i = 0; i < DISPERSION_COEFFICIENTS; i += 2)
        n2 += c[i] * w2 / (w2 - c[i + 1]);
    return sqrt(n2);
}

double interior_ior(const Interior *interior, double wavelength)
{
    if (wavelength == 0 || interior->dispersion == DISPERSION_NONE)
        return interior->ior;
    if (interior->dispersion == DISPERSION_RATIO) {
        double part = (WAVELENGTH_MIDDLE - wavelength) / (SPECTRUM_LAST - SPECTRUM_FIRST);
        return interior->ior * pow(interior->coefficients[0], part);
    }
    return formula_ior(interior->dispersion, interior->coefficients, wavelength);
}

/* Resonances lie between wavelengths, so the formula is tried at many of them. */
enum { TRIALS = 351 };

bool interior_set_formula(Interior *interior, DispersionKind kind,
                          const double coefficients[DISPERSION_COEFFICIENTS])
{
    for (int i = 0; i < TRIALS; i++) {
        double part = (double)i / (TRIALS - 1);
        double wavelength = SPECTRUM_FIRST + part * (SPECTRUM_LAST - SPECTRUM_FIRST);
        double ior = formula_ior(kind, coefficients, wavelength);
        if (!(ior > 0 && isfinite(ior)))
            return false;
    }
    interior->ior = formula_ior(kind, coefficients, WAVELENGTH_D);
    interior->dispersion = kind;
    for (int i = 0; i < DISPERSION_COEFFICIENTS; i++)
        interior->coefficients[i] = coefficients[i];
    return true;
}

/* From this power on the language means the exponential law. */
#define EXPONENTIAL_POWER 1000.0

Rgb interior_fade(const Interior *interior, double distance, bool is_shadow)
{
    double power = interior->fade_power;
    if (interior->fade_distance == 0 || (is_shadow && !(power > 0)))
        return RGB_WHITE;
    Rgb k = interior->fade_color;
    double depth = distance / interior->fade_distance;
    if (power >= EXPONENTIAL_POWER) {
        return rgb((float)exp(-(1 - (double)k.r) * depth), (float)exp(-(1 - (double)k.g) * depth),
                   (float)exp(-(1 - (double)k.b) * depth));
    }
    float rest = (float)(1 / (1 + pow(depth, power)));
    return rgb(k.r + (1 - k.r) * rest, k.g + (1 - k.g) * rest, k.b + (1 - k.b) * rest);
}
