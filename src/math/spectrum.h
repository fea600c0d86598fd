/* Light by wavelength, for dispersion: which colours white is made of.
 *
 * White light is cut into the wavelengths from 380 to 730 nm.  The colour each has is the one
 * POV-Ray's dispersion shows, measured, and scaled so that all of them together are white.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_MATH_SPECTRUM_H
#define PMS_MATH_SPECTRUM_H

#include "math/rgb.h"

/* Ends of the spectrum, nm. */
#define SPECTRUM_FIRST 380.0
#define SPECTRUM_LAST 730.0

/* One of the equal bands that the spectrum is cut into. */
typedef struct SpectrumBand {
    double wavelength; /* of its middle, nm */
    Rgb color;         /* its share of white light; the colours of all bands add up to white */
} SpectrumBand;

/* Return band i of n. */
SpectrumBand spectrum_band(int i, int n);

/* Return band i of n + 1: those of n bands moved by -`shift` of one, in [0,1), and what is left at
 * the ends.  Over all shifts no wavelength is before others. */
SpectrumBand spectrum_band_moved(int i, int n, double shift);

/* Choose a wavelength in proportion to what it gives to red, green and blue together; u is in
 * [0,1).  *color is its colour over the density of the choice, so its mean is white. */
double spectrum_choose(double u, Rgb *color);

#endif
