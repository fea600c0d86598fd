/* FLIP: against its definition, written as plainly as can be.  SPDX-License-Identifier: Apache-2.0
 */
#include "image/flip.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

enum { WIDTH = 33, HEIGHT = 26, PIXELS = WIDTH * HEIGHT };

static const double pi = 3.14159265358979323846, degree = 3840 * 3.14159265358979323846 / 180;

static void to_xyz(const double c[3], double out[3])
{
    out[0] = 1.052156925 * (10135552 * c[0] + 8788810 * c[1] + 4435075 * c[2]) / 24577794;
    out[1] = (2613072 * c[0] + 8788810 * c[1] + 887015 * c[2]) / 12288897;
    out[2] = 0.918357670 * (1425312 * c[0] + 8788810 * c[1] + 70074185 * c[2]) / 73733382;
}

static void to_opponent(const double c[3], double out[3])
{
    double x[3];
    to_xyz(c, x);
    out[0] = 116 * x[1] - 16;
    out[1] = 500 * (x[0] - x[1]);
    out[2] = 200 * (x[1] - x[2]);
}

static void to_lab(const double c[3], double out[3])
{
    double x[3];
    to_xyz(c, x);
    for (int i = 0; i < 3; i++)
        x[i] = x[i] > pow(6 / 29.0, 3) ? cbrt(x[i]) : x[i] * 841 / 108 + 4 / 29.0;
    out[0] = 116 * x[1] - 16;
    out[1] = out[0] / 100 * 500 * (x[0] - x[1]);
    out[2] = out[0] / 100 * 200 * (x[1] - x[2]);
}

/* Solve the 3x3 system of to_opponent by Cramer's rule. */
static void from_opponent(const double c[3], double out[3])
{
    double zero[3] = {0}, base[3], m[3][3];
    to_opponent(zero, base);
    for (int k = 0; k < 3; k++) {
        double unit[3] = {0};
        unit[k] = 1;
        to_opponent(unit, m[k]);
        for (int i = 0; i < 3; i++)
            m[k][i] -= base[i];
    }
    double r[3] = {c[0] - base[0], c[1] - base[1], c[2] - base[2]};
#define DET(a, b, c)                                                                               \
    ((a)[0] * ((b)[1] * (c)[2] - (b)[2] * (c)[1]) - (b)[0] * ((a)[1] * (c)[2] - (a)[2] * (c)[1]) + \
     (c)[0] * ((a)[1] * (b)[2] - (a)[2] * (b)[1]))
    double all = DET(m[0], m[1], m[2]);
    out[0] = DET(r, m[1], m[2]) / all;
    out[1] = DET(m[0], r, m[2]) / all;
    out[2] = DET(m[0], m[1], r) / all;
}

static double pixel_of(const double *plane, int x, int y)
{
    x = x < 0 ? 0 : x >= WIDTH ? WIDTH - 1 : x;
    y = y < 0 ? 0 : y >= HEIGHT ? HEIGHT - 1 : y;
    return plane[y * WIDTH + x];
}

/* The kernels in two dimensions; kind 0 to 2: blur of a channel, 3 and 4: edge and point along x.
 */
static double weight_of(int kind, int x, int y)
{
    static const double a[3][4] = {
        {1, 0.0047, 0, 1e-5}, {1, 0.0053, 0, 1e-5}, {34.1, 0.04, 13.5, 0.025}};
    if (kind < 3) {
        double d2 = (x * x + y * y) / (degree * degree), sum = 0;
        for (int i = 0; i < 4; i += 2)
            sum += a[kind][i] * sqrt(pi / a[kind][i + 1]) * exp(-pi * pi * d2 / a[kind][i + 1]);
        return sum;
    }
    double sd = 0.041 * degree, g = exp(-(x * x + y * y) / (2 * sd * sd));
    return kind == 3 ? -x * g : (x * x / (sd * sd) - 1) * g;
}

static double filtered(const double *plane, int kind, bool is_turned, int px, int py)
{
    int r = kind < 3 ? (int)ceil(3 * sqrt(0.04 / (2 * pi * pi)) * degree)
                     : (int)ceil(3 * 0.041 * degree);
    double above = 0, below = 0, sum_above = 0, sum_below = 0;
    for (int y = -r; y <= r; y++)
        for (int x = -r; x <= r; x++) {
            double w = is_turned ? weight_of(kind, y, x) : weight_of(kind, x, y);
            double v = pixel_of(plane, px + x, py + y);
            if (w > 0) {
                above += w;
                sum_above += w * v;
            } else {
                below -= w;
                sum_below += w * v;
            }
        }
    return sum_above / above + (below > 0 ? sum_below / below : 0);
}

static double hyab(const double a[3], const double b[3])
{
    return fabs(a[0] - b[0]) + hypot(a[1] - b[1], a[2] - b[2]);
}

/* What one picture is at a pixel: three colours, edge and point. */
static void see(double planes[4][PIXELS], int x, int y, double out[5])
{
    double opponent[3], rgb[3];
    for (int k = 0; k < 3; k++)
        opponent[k] = filtered(planes[k], k, false, x, y);
    from_opponent(opponent, rgb);
    for (int k = 0; k < 3; k++)
        rgb[k] = fmin(1, fmax(0, rgb[k]));
    to_lab(rgb, out);
    for (int k = 3; k < 5; k++)
        out[k] = hypot(filtered(planes[3], k, false, x, y), filtered(planes[3], k, true, x, y));
}

static void planes_of(const float *rgb, double planes[4][PIXELS])
{
    for (int i = 0; i < PIXELS; i++) {
        double c[3] = {(double)rgb[3 * i], (double)rgb[3 * i + 1], (double)rgb[3 * i + 2]}, o[3];
        to_opponent(c, o);
        for (int k = 0; k < 3; k++)
            planes[k][i] = o[k];
        planes[3][i] = (o[0] + 16) / 116;
    }
}

static void by_definition(const float *reference, const float *test, double *out)
{
    static double a[4][PIXELS], b[4][PIXELS];
    planes_of(reference, a);
    planes_of(test, b);
    const double green[3] = {0, 1, 0}, blue[3] = {0, 0, 1};
    double lab_green[3], lab_blue[3];
    to_lab(green, lab_green);
    to_lab(blue, lab_blue);
    double largest = pow(hyab(lab_green, lab_blue), 0.7);
    for (int i = 0; i < PIXELS; i++) {
        double sa[5], sb[5];
        see(a, i % WIDTH, i / WIDTH, sa);
        see(b, i % WIDTH, i / WIDTH, sb);
        double color = pow(hyab(sa, sb), 0.7), end = 0.4 * largest;
        color = color < end ? 0.95 * color / end : 0.95 + 0.05 * (color - end) / (largest - end);
        double feature = fmax(fabs(sa[3] - sb[3]), fabs(sa[4] - sb[4]));
        out[i] = pow(color, 1 - sqrt(feature / sqrt(2)));
    }
}

/* Patches, an edge, a gradient and points. */
static void paint(float *rgb, int shift, float gain)
{
    for (int i = 0; i < PIXELS; i++) {
        int x = i % WIDTH + shift, y = i / WIDTH;
        rgb[3 * i] = gain * (x < 15 ? 0.8f : 0.1f);
        rgb[3 * i + 1] = gain * (float)(y + 1) / HEIGHT * (x * y % 7 == 0 ? 0.2f : 0.9f);
        rgb[3 * i + 2] = gain * (x > 22 && y > 12 ? 1.0f : 0.3f);
    }
}

static void the_map_agrees_with_the_definition(void **state)
{
    (void)state;
    static float a[3 * PIXELS], b[3 * PIXELS], map[PIXELS];
    static double wanted[PIXELS];
    paint(a, 0, 1);
    paint(b, 2, 0.9f);
    by_definition(a, b, wanted);
    assert_true(flip_map(a, b, WIDTH, HEIGHT, true, map));
    double most = 0;
    for (int i = 0; i < PIXELS; i++) {
        assert_true(fabs((double)map[i] - wanted[i]) < 2e-5);
        most = fmax(most, wanted[i]);
    }
    assert_true(most > 0.3 && most <= 1);
}

static double film(double x)
{
    double k = 0.36 * x * x;
    return fmin(1, (2.51 * k + 0.018 * x) / (2.43 * k + 0.354 * x + 0.14));
}

/* Several exposures, each pixel in the worst. */
static void light_is_looked_at_in_exposures(void **state)
{
    (void)state;
    static float a[3 * PIXELS], b[3 * PIXELS], exposed[2][3 * PIXELS], map[PIXELS];
    static double wanted[PIXELS], worst[PIXELS];
    paint(a, 0, 1);
    paint(b, 1, 1);
    for (int i = 0; i < 60; i++)
        a[i] *= 40; /* a bright stripe */
    double lum[PIXELS];
    for (int i = 0; i < PIXELS; i++)
        lum[i] = 0.2126 * (double)a[3 * i] + 0.7152 * (double)a[3 * i + 1] +
                 0.0722 * (double)a[3 * i + 2];
    for (int i = 1; i < PIXELS; i++)
        for (int k = i; k > 0 && lum[k] < lum[k - 1]; k--) {
            double swap = lum[k];
            lum[k] = lum[k - 1];
            lum[k - 1] = swap;
        }
    double bright = 1; /* film(bright) = 0.85, by halving */
    for (double step = 1; step > 1e-12; step /= 2)
        bright += film(bright) < 0.85 ? step : -step;
    double median = 0.5 * (lum[PIXELS / 2] + lum[(PIXELS - 1) / 2]);
    double first = log2(bright / lum[PIXELS - 1]), last = log2(bright / median);
    int count = (int)fmax(2, ceil(last - first));
    assert_true(count >= 4);
    memset(worst, 0, sizeof worst);
    for (int e = 0; e < count; e++) {
        double gain = exp2(first + (last - first) * e / (count - 1));
        for (int i = 0; i < 3 * PIXELS; i++) {
            exposed[0][i] = (float)film((double)a[i] * gain);
            exposed[1][i] = (float)film((double)b[i] * gain);
        }
        by_definition(exposed[0], exposed[1], wanted);
        for (int i = 0; i < PIXELS; i++)
            worst[i] = fmax(worst[i], wanted[i]);
    }
    assert_true(flip_map(a, b, WIDTH, HEIGHT, false, map));
    for (int i = 0; i < PIXELS; i++)
        assert_true(fabs((double)map[i] - worst[i]) < 5e-5);
}

static void extremes(void **state)
{
    (void)state;
    static float a[3 * PIXELS], b[3 * PIXELS], map[PIXELS];
    /* all black */
    assert_true(flip_map(a, b, WIDTH, HEIGHT, false, map));
    for (int i = 0; i < PIXELS; i++)
        assert_true(map[i] == 0);
    /* brighter than numbers go, below 0, and one pixel */
    for (int i = 0; i < 3 * PIXELS; i++) {
        a[i] = i % 2 ? 3e38f : -3e38f;
        b[i] = i % 5 ? 0 : 1e-38f;
    }
    assert_true(flip_map(a, b, WIDTH, HEIGHT, false, map));
    for (int i = 0; i < PIXELS; i++)
        assert_true(map[i] >= 0 && map[i] <= 1);
    assert_true(flip_map(a, b, 1, 1, false, map));
    assert_true(map[0] >= 0 && map[0] <= 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_map_agrees_with_the_definition),
        cmocka_unit_test(light_is_looked_at_in_exposures),
        cmocka_unit_test(extremes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
