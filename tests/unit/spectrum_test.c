/* The colours of the spectrum, and indices of refraction by wavelength.
 * SPDX-License-Identifier: Apache-2.0 */
#include "math/spectrum.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "texture/texture.h"

static void assert_near(Rgb got, Rgb wanted, double tolerance)
{
    Rgb off = rgb_sub(got, wanted);
    if (!((double)rgb_max_abs(off) <= tolerance))
        fail_msg("got %g %g %g, wanted %g %g %g", (double)got.r, (double)got.g, (double)got.b,
                 (double)wanted.r, (double)wanted.g, (double)wanted.b);
}

static void bands_add_up_to_white(void **state)
{
    (void)state;
    static const int counts[] = {1, 2, 3, 7, 100, 5000};
    for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) {
        double sum[3] = {0};
        for (int i = 0; i < counts[k]; i++) {
            SpectrumBand band = spectrum_band(i, counts[k]);
            assert_true(band.wavelength > 380 && band.wavelength < 730);
            assert_true(rgb_min(band.color) >= 0);
            sum[0] += (double)band.color.r;
            sum[1] += (double)band.color.g;
            sum[2] += (double)band.color.b;
        }
        for (int c = 0; c < 3; c++)
            assert_true(fabs(sum[c] - 1) < 1e-6);
    }
}

/* Moved bands too, and each reaches over its own part: over all shifts the colour at a wavelength
 * is spread over a band's width at most. */
static void moved_bands_add_up_to_white(void **state)
{
    (void)state;
    for (int k = 0; k < 50; k++) {
        double shift = k / 50.0, sum[3] = {0}, last = 379.999;
        for (int i = 0; i <= 7; i++) {
            SpectrumBand band = spectrum_band_moved(i, 7, shift);
            assert_true(band.wavelength > last && band.wavelength <= 730);
            assert_true(band.wavelength - last <= 50.001);
            last = band.wavelength;
            sum[0] += (double)band.color.r;
            sum[1] += (double)band.color.g;
            sum[2] += (double)band.color.b;
            if (shift == 0 && i < 7) {
                assert_near(band.color, spectrum_band(i, 7).color, 1e-6);
                assert_true(fabs(band.wavelength - spectrum_band(i, 7).wavelength) < 1e-9);
            }
        }
        for (int c = 0; c < 3; c++)
            assert_true(fabs(sum[c] - 1) < 1e-6);
    }
}

/* The seven bands of POV-Ray 3.7, read off 16-bit pixels; there they add up to .9938, 1, .9962. */
static void bands_are_those_of_the_language(void **state)
{
    (void)state;
    static const Rgb up_to[8] = {{0, 0, 0},
                                 {0.03649f, 0, 0.20470f},
                                 {0.03950f, 0, 0.57121f},
                                 {0.03950f, 0.10950f, 0.89821f},
                                 {0.04930f, 0.47070f, 0.99620f},
                                 {0.32010f, 0.84939f, 0.99620f},
                                 {0.73681f, 1, 0.99620f},
                                 {0.99380f, 1, 0.99620f}};
    for (int i = 0; i < 7; i++) {
        Rgb share = rgb_sub(up_to[i + 1], up_to[i]);
        Rgb wanted = rgb(share.r / 0.9938f, share.g, share.b / 0.9962f);
        assert_near(spectrum_band(i, 7).color, wanted, 1.2e-3);
    }
}

static void chosen_wavelengths_are_white_together(void **state)
{
    (void)state;
    enum { CHOICES = 20000, BINS = 10 };
    double sum[3] = {0}, bin[BINS] = {0}, last = 0;
    for (int i = 0; i < CHOICES; i++) {
        Rgb color;
        double wavelength = spectrum_choose((i + 0.5) / CHOICES, &color);
        assert_true(wavelength > last && wavelength < 730);
        assert_true(rgb_min(color) >= 0 && rgb_max(color) <= 3.001f);
        last = wavelength;
        sum[0] += (double)color.r / CHOICES;
        sum[1] += (double)color.g / CHOICES;
        sum[2] += (double)color.b / CHOICES;
        bin[(int)((wavelength - 380) / 35)] += (double)color.g / CHOICES;
    }
    for (int c = 0; c < 3; c++)
        assert_true(fabs(sum[c] - 1) < 1e-5);
    for (int i = 0; i < BINS; i++)
        assert_true(fabs(bin[i] - (double)spectrum_band(i, BINS).color.g) < 2e-4);
    Rgb color;
    assert_true(fabs(spectrum_choose(0, &color) - 380) < 1e-6);
    assert_true(fabs(spectrum_choose(1 - 1e-16, &color) - 730) < 1e-6);
}

static void the_languages_dispersion(void **state)
{
    (void)state;
    Interior glass = {.ior = 1.5, .dispersion = DISPERSION_RATIO, .coefficients = {1.1}};
    assert_true(interior_ior(&glass, 0) == 1.5);
    assert_true(interior_ior(&glass, 555) == 1.5);
    assert_true(fabs(interior_ior(&glass, 380) / interior_ior(&glass, 730) - 1.1) < 1e-15);
    assert_true(fabs(interior_ior(&glass, 467.5) - 1.5 * pow(1.1, 0.25)) < 1e-15);
    glass.dispersion = DISPERSION_NONE;
    assert_true(interior_ior(&glass, 380) == 1.5);
    assert_true(interior_bends(&glass));
    glass.ior = 1;
    assert_false(interior_bends(&glass));
    glass.dispersion = DISPERSION_RATIO;
    assert_true(interior_bends(&glass));
}

/* Schott's data sheet of N-BK7: coefficients, and the indices it states. */
static void sellmeiers_formula(void **state)
{
    (void)state;
    static const double bk7[8] = {1.03961212,   0.00600069867, 0.231792344,
                                  0.0200179144, 1.01046945,    103.560653};
    static const double stated[][2] = {{404.66, 1.53024}, {435.83, 1.52668}, {486.13, 1.52238},
                                       {546.07, 1.51872}, {587.56, 1.51680}, {656.27, 1.51432},
                                       {706.52, 1.51289}};
    Interior glass = INTERIOR_DEFAULT;
    assert_true(interior_set_formula(&glass, DISPERSION_SELLMEIER, bk7));
    assert_true(fabs(glass.ior - 1.51680) < 5e-6);
    for (size_t i = 0; i < sizeof stated / sizeof *stated; i++)
        assert_true(fabs(interior_ior(&glass, stated[i][0]) - stated[i][1]) < 6e-6);
}

static void cauchys_formula(void **state)
{
    (void)state;
    static const double c[8] = {1.5, 0.004, 0.0001};
    Interior glass = INTERIOR_DEFAULT;
    assert_true(interior_set_formula(&glass, DISPERSION_CAUCHY, c));
    assert_true(fabs(interior_ior(&glass, 500) - (1.5 + 0.016 + 0.0016)) < 1e-15);
}

static void formulas_without_sense(void **state)
{
    (void)state;
    static const double resonance[8] = {1, 0.25}, none[8] = {0.1, -0.1};
    Interior glass = {.ior = 1.25};
    assert_false(interior_set_formula(&glass, DISPERSION_SELLMEIER, resonance));
    assert_false(interior_set_formula(&glass, DISPERSION_CAUCHY, none));
    assert_true(glass.ior == 1.25 && glass.dispersion == DISPERSION_NONE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bands_add_up_to_white),
        cmocka_unit_test(moved_bands_add_up_to_white),
        cmocka_unit_test(bands_are_those_of_the_language),
        cmocka_unit_test(chosen_wavelengths_are_white_together),
        cmocka_unit_test(the_languages_dispersion),
        cmocka_unit_test(sellmeiers_formula),
        cmocka_unit_test(cauchys_formula),
        cmocka_unit_test(formulas_without_sense),
    };
    return cmocka_run_group_tests_name("spectrum", tests, NULL, NULL);
}
