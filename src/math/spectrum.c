/* The colours of the spectrum.
 *
 * Cumulative curves were read off POV-Ray 3.7: plane glass that some of 350 wavelengths pass and
 * others do not, looked at from within at all angles.  They are those of parabolas, two for red,
 * to 6e-4.  SPDX-License-Identifier: Apache-2.0 */
#include "math/spectrum.h"

#include <math.h>

/* A parabola over [middle - half, middle + half], of area 1. */
typedef struct Lobe {
    double middle, half; /* nm */
} Lobe;

static const Lobe red_lobe = {653.88, 83.94}, violet_lobe = {407.64, 33.97},
                  green_lobe = {583.57, 91.09}, blue_lobe = {470.20, 97.68};

/* The part of red that is violet. */
#define VIOLET_PART 0.04045

/* The area of a lobe up to a wavelength. */
static double lobe_area(Lobe lobe, double wavelength)
{
    double u = fmax(-1, fmin(1, (wavelength - lobe.middle) / lobe.half));
    return 0.5 + 0.75 * u - 0.25 * u * u * u;
}

static double lobe_height(Lobe lobe, double wavelength)
{
    double u = (wavelength - lobe.middle) / lobe.half;
    return fabs(u) < 1 ? 0.75 * (1 - u * u) / lobe.half : 0;
}

typedef struct Curves {
    double rgb[3];
} Curves;

static Curves raw_areas(double wavelength)
{
    double violet = VIOLET_PART * lobe_area(violet_lobe, wavelength);
    return (Curves){{violet + (1 - VIOLET_PART) * lobe_area(red_lobe, wavelength),
                     lobe_area(green_lobe, wavelength), lobe_area(blue_lobe, wavelength)}};
}

static Curves heights(double wavelength)
{
    double violet = VIOLET_PART * lobe_height(violet_lobe, wavelength);
    Curves out = {{violet + (1 - VIOLET_PART) * lobe_height(red_lobe, wavelength),
                   lobe_height(green_lobe, wavelength), lobe_height(blue_lobe, wavelength)}};
    Curves first = raw_areas(SPECTRUM_FIRST), last = raw_areas(SPECTRUM_LAST);
    for (int c = 0; c < 3; c++)
        out.rgb[c] /= last.rgb[c] - first.rgb[c];
    return out;
}

/* The share of white up to a wavelength: from 0 to 1. */
static Curves areas(double wavelength)
{
    Curves first = raw_areas(SPECTRUM_FIRST), last = raw_areas(SPECTRUM_LAST);
    Curves out = raw_areas(wavelength);
    for (int c = 0; c < 3; c++)
        out.rgb[c] = (out.rgb[c] - first.rgb[c]) / (last.rgb[c] - first.rgb[c]);
    return out;
}

/* The colour of the light between two wavelengths. */
static Rgb color_between(double first, double last)
{
    Curves from = areas(first), to = areas(last);
    return rgb((float)(to.rgb[0] - from.rgb[0]), (float)(to.rgb[1] - from.rgb[1]),
               (float)(to.rgb[2] - from.rgb[2]));
}

SpectrumBand spectrum_band(int i, int n)
{
    double width = (SPECTRUM_LAST - SPECTRUM_FIRST) / n;
    Rgb color = color_between(SPECTRUM_FIRST + i * width, SPECTRUM_FIRST + (i + 1) * width);
    return (SpectrumBand){SPECTRUM_FIRST + (i + 0.5) * width, color};
}

SpectrumBand spectrum_band_moved(int i, int n, double shift)
{
    double width = (SPECTRUM_LAST - SPECTRUM_FIRST) / n, start = SPECTRUM_FIRST - shift * width;
    double first = fmax(SPECTRUM_FIRST, start + i * width);
    double last = fmin(SPECTRUM_LAST, start + (i + 1) * width);
    return (SpectrumBand){0.5 * (first + last), color_between(first, last)};
}

static double sum(Curves c)
{
    return c.rgb[0] + c.rgb[1] + c.rgb[2];
}

/* Halvings that take the spectrum to far less than a picture can show: 1e-7 nm. */
enum { HALVINGS = 32 };

double spectrum_choose(double u, Rgb *color)
{
    double lo = SPECTRUM_FIRST, hi = SPECTRUM_LAST;
    for (int i = 0; i < HALVINGS; i++) {
        double middle = 0.5 * (lo + hi);
        if (sum(areas(middle)) > 3 * u)
            hi = middle;
        else
            lo = middle;
    }
    double wavelength = 0.5 * (lo + hi);
    Curves height = heights(wavelength);
    double density = sum(height) / 3;
    *color = RGB_WHITE;
    if (density > 0)
        *color = rgb((float)(height.rgb[0] / density), (float)(height.rgb[1] / density),
                     (float)(height.rgb[2] / density));
    return wavelength;
}
