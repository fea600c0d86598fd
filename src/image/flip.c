/* FLIP.
 *
 * Both pictures go two ways: blurred as far as the eye cannot resolve them, in an opponent colour
 * space, they are compared in one that is even to the eye; and edges and points are looked for in
 * their brightness.  All filters are products of one along x and one along y, or sums of two such.
 * SPDX-License-Identifier: Apache-2.0 */
#include "image/flip.h"

#include "base/mem.h"
#include "image/srgb.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* Pixels in a degree of sight. */
#define PIXELS_PER_DEGREE (0.7 * 3840 / 0.7 * 3.14159265358979323846 / 180)

enum { RADIUS_MAX = 16, TAPS_MAX = 2 * RADIUS_MAX + 1 };

/* Contrast sensitivity of the channels: two Gaussians of weight a and width b each. */
typedef struct Sensitivity {
    double a1, b1, a2, b2;
} Sensitivity;

static const Sensitivity sensitivities[3] = {{1, 0.0047, 0, 1e-5},       /* brightness */
                                             {1, 0.0053, 0, 1e-5},       /* red to green */
                                             {34.1, 0.04, 13.5, 0.025}}; /* blue to yellow */

static const double widest = 0.04;

/* Colour differences count to this power, and up to this part of the largest one fill that part of
 * the scale. */
static const double color_power = 0.7, scale_end = 0.4, scale_part = 0.95;

/* Width of an edge to the eye, degrees; power that features count to. */
static const double edge_width = 0.082, feature_power = 0.5;

/* A picture's colours, even to the eye, and the strength of its edges and points; planes. */
typedef struct Seen {
    float *lab[3], *edges, *points;
} Seen;

/* A filter along one axis. */
typedef struct Taps {
    int radius;
    double weight[TAPS_MAX];
} Taps;

/* --- colours ---------------------------------------------------------------------------------- */

typedef struct Triple {
    double x, y, z;
} Triple;

/* Relative to the white of the D65 illuminant. */
static Triple to_xyz(Triple c)
{
    Triple xyz = {(10135552 * c.x + 8788810 * c.y + 4435075 * c.z) / 24577794,
                  (2613072 * c.x + 8788810 * c.y + 887015 * c.z) / 12288897,
                  (1425312 * c.x + 8788810 * c.y + 70074185 * c.z) / 73733382};
    return (Triple){xyz.x * 1.052156925, xyz.y, xyz.z * 0.918357670};
}

static Triple from_xyz(Triple c)
{
    c.x *= 0.950428545;
    c.z *= 1.088900371;
    return (Triple){3.241003275 * c.x - 1.537398934 * c.y - 0.498615861 * c.z,
                    -0.969224334 * c.x + 1.875930071 * c.y + 0.041554224 * c.z,
                    0.055639423 * c.x - 0.204011202 * c.y + 1.057148933 * c.z};
}

/* The linear opponent space Y Cx Cz. */
static Triple to_opponent(Triple rgb)
{
    Triple c = to_xyz(rgb);
    return (Triple){116 * c.y - 16, 500 * (c.x - c.y), 200 * (c.y - c.z)};
}

static Triple from_opponent(Triple c)
{
    double y = (c.x + 16) / 116;
    return from_xyz((Triple){y + c.y / 500, y, y - c.z / 200});
}

static double lab_curve(double x)
{
    const double delta = 6.0 / 29;
    return x > delta * delta * delta ? cbrt(x) : x / (3 * delta * delta) + 4.0 / 29;
}

/* L*a*b*; dim colours are less colourful (Hunt's effect). */
static Triple to_lab(Triple rgb)
{
    Triple c = to_xyz(rgb);
    double x = lab_curve(c.x), y = lab_curve(c.y), z = lab_curve(c.z), lightness = 116 * y - 16;
    return (Triple){lightness, 0.01 * lightness * 500 * (x - y), 0.01 * lightness * 200 * (y - z)};
}

/* HyAB: lightness and colour apart. */
static double color_distance(Triple a, Triple b)
{
    return fabs(a.x - b.x) + hypot(a.y - b.y, a.z - b.z);
}

/* --- filters ---------------------------------------------------------------------------------- */

static int clamped(int i, int count)
{
    return i < 0 ? 0 : i >= count ? count - 1 : i;
}

/* Filter along lines `step` apart from pixel to pixel; the picture goes on as it ends. */
static void filter_line(const float *in, ptrdiff_t step, int count, const Taps *taps, float *out)
{
    for (int i = 0; i < count; i++) {
        double sum = 0;
        for (int k = -taps->radius; k <= taps->radius; k++)
            sum += taps->weight[k + taps->radius] * (double)in[clamped(i + k, count) * step];
        out[i * step] = (float)sum;
    }
}

/* Filter along x and y; `between` is room for a plane. */
static void filter_plane(const float *in, int width, int height, const Taps *x, const Taps *y,
                         float *between, float *out)
{
    for (int j = 0; j < height; j++)
        filter_line(in + (size_t)j * (size_t)width, 1, width, x,
                    between + (size_t)j * (size_t)width);
    for (int i = 0; i < width; i++)
        filter_line(between + i, width, height, y, out + i);
}

static double sum_of(const Taps *taps)
{
    double sum = 0;
    for (int i = 0; i <= 2 * taps->radius; i++)
        sum += taps->weight[i];
    return sum;
}

/* A Gaussian of sensitivity width b; returns the sum of its weights before they were made to add up
 * to 1. */
static double sensitivity_taps(double b, Taps *taps)
{
    const double pi = 3.14159265358979323846;
    taps->radius = (int)ceil(3 * sqrt(widest / (2 * pi * pi)) * PIXELS_PER_DEGREE);
    for (int k = -taps->radius; k <= taps->radius; k++) {
        double x = k / PIXELS_PER_DEGREE;
        taps->weight[k + taps->radius] = exp(-pi * pi * x * x / b);
    }
    double sum = sum_of(taps);
    for (int i = 0; i <= 2 * taps->radius; i++)
        taps->weight[i] /= sum;
    return sum;
}

/* Blur a plane in place as the eye does a channel. */
static void blur(float *plane, int width, int height, const Sensitivity *s, float *room[3])
{
    Taps first, second;
    size_t count = (size_t)width * (size_t)height;
    double sum1 = sensitivity_taps(s->b1, &first), sum2 = sensitivity_taps(s->b2, &second);
    double weight1 = s->a1 / sqrt(s->b1) * sum1 * sum1, weight2 = s->a2 / sqrt(s->b2) * sum2 * sum2;
    double share = weight1 / (weight1 + weight2);
    filter_plane(plane, width, height, &first, &first, room[0], room[1]);
    if (share < 1)
        filter_plane(plane, width, height, &second, &second, room[0], room[2]);
    for (size_t i = 0; i < count; i++)
        plane[i] = share < 1
                       ? (float)(share * (double)room[1][i] + (1 - share) * (double)room[2][i])
                       : room[1][i];
}

/* What looks for edges (1) or points (2): derivatives of a Gaussian, whose weights above 0 add up
 * to 1 and those below to -1; and the Gaussian itself (0). */
static void feature_taps(int derivative, Taps *taps)
{
    double sd = 0.5 * edge_width * PIXELS_PER_DEGREE, above = 0, below = 0;
    taps->radius = (int)ceil(3 * sd);
    for (int k = -taps->radius; k <= taps->radius; k++) {
        double factors[] = {1, -k, k * k / (sd * sd) - 1};
        double w = factors[derivative] * exp(-k * k / (2 * sd * sd));
        taps->weight[k + taps->radius] = w;
        above += w > 0 ? w : 0;
        below -= w < 0 ? w : 0;
    }
    for (int i = 0; i <= 2 * taps->radius; i++)
        taps->weight[i] /= taps->weight[i] > 0 ? above : below > 0 ? below : 1;
}

/* The strength of a feature: the length of its response along x and y. */
static void find_features(const float *brightness, int width, int height, int derivative,
                          float *room[3], float *out)
{
    Taps along, across;
    feature_taps(derivative, &along);
    feature_taps(0, &across);
    filter_plane(brightness, width, height, &along, &across, room[0], room[1]);
    filter_plane(brightness, width, height, &across, &along, room[0], room[2]);
    for (size_t i = 0; i < (size_t)width * (size_t)height; i++)
        out[i] = hypotf(room[1][i], room[2][i]);
}

/* --- the map ---------------------------------------------------------------------------------- */

/* See a picture of linear colours from 0 to 1. */
static void see(const float *rgb, int width, int height, float *room[4], Seen *out)
{
    size_t count = (size_t)width * (size_t)height;
    for (size_t i = 0; i < count; i++) {
        const float *p = rgb + 3 * i;
        Triple c = to_opponent((Triple){(double)p[0], (double)p[1], (double)p[2]});
        out->lab[0][i] = (float)c.x;
        out->lab[1][i] = (float)c.y;
        out->lab[2][i] = (float)c.z;
        room[3][i] = (float)((c.x + 16) / 116);
    }
    find_features(room[3], width, height, 1, room, out->edges);
    find_features(room[3], width, height, 2, room, out->points);
    for (int k = 0; k < 3; k++)
        blur(out->lab[k], width, height, &sensitivities[k], room);
    for (size_t i = 0; i < count; i++) {
        Triple c = from_opponent(
            (Triple){(double)out->lab[0][i], (double)out->lab[1][i], (double)out->lab[2][i]});
        c = to_lab((Triple){fmin(1, fmax(0, c.x)), fmin(1, fmax(0, c.y)), fmin(1, fmax(0, c.z))});
        out->lab[0][i] = (float)c.x;
        out->lab[1][i] = (float)c.y;
        out->lab[2][i] = (float)c.z;
    }
}

static Triple lab_at(const Seen *s, size_t i)
{
    return (Triple){(double)s->lab[0][i], (double)s->lab[1][i], (double)s->lab[2][i]};
}

/* Spread the differences of colours over 0 to 1: most of it for those that are not extreme. */
static double color_error(Triple a, Triple b, double largest)
{
    double error = pow(color_distance(a, b), color_power), end = scale_end * largest;
    if (error < end)
        return scale_part / end * error;
    return scale_part + (error - end) / (largest - end) * (1 - scale_part);
}

/* Raise the map to the differences of two pictures where these are larger. */
static void raise_map(const Seen *a, const Seen *b, size_t count, float *map)
{
    Triple green = to_lab((Triple){0, 1, 0}), blue = to_lab((Triple){0, 0, 1});
    double largest = pow(color_distance(green, blue), color_power);
    for (size_t i = 0; i < count; i++) {
        double edge = fabs((double)a->edges[i] - (double)b->edges[i]);
        double point = fabs((double)a->points[i] - (double)b->points[i]);
        double feature = pow(fmax(edge, point) / sqrt(2), feature_power);
        double error = pow(color_error(lab_at(a, i), lab_at(b, i), largest), 1 - feature);
        map[i] = fmaxf(map[i], (float)error);
    }
}

/* --- exposures -------------------------------------------------------------------------------- */

/* The film curve: (k0 x^2 + k1 x) / (k3 x^2 + k4 x + k5). */
static const double k0 = 0.6 * 0.6 * 2.51, k1 = 0.6 * 0.03, k3 = 0.6 * 0.6 * 2.43, k4 = 0.6 * 0.59,
                    k5 = 0.14;

static float film(double x)
{
    double y = (k0 * x * x + k1 * x) / (k3 * x * x + k4 * x + k5);
    return isfinite(y) ? (float)fmin(1, fmax(0, y)) : 1;
}

/* Where the curve gets to 0.85: the brightness that exposures bring the picture's to. */
static double film_bright(void)
{
    const double t = 0.85;
    double a = k0 - k3 * t, b = (k1 - k4 * t) / a, c = -k5 * t / a;
    return -0.5 * b + sqrt(0.25 * b * b - c);
}

/* Exposures cover no more than this, in stops, where half of a picture is black. */
static const double stops_most = 24;

static int by_size(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return x < y ? -1 : x > y;
}

/* Find the exposures, in stops, from that for the brightest pixel to that for the median one. */
static int find_exposures(const float *rgb, size_t count, float *room, double *first, double *step)
{
    for (size_t i = 0; i < count; i++) {
        const float *p = rgb + 3 * i;
        room[i] = 0.2126f * fmaxf(0, p[0]) + 0.7152f * fmaxf(0, p[1]) + 0.0722f * fmaxf(0, p[2]);
    }
    qsort(room, count, sizeof *room, by_size);
    double most = (double)room[count - 1],
           middle = 0.5 * ((double)room[(count - 1) / 2] + (double)room[count / 2]);
    *first = *step = 0;
    if (!(most > 0))
        return 1;
    *first = log2(film_bright() / most);
    double last = log2(film_bright() / fmax(middle, most * exp2(-stops_most)));
    int exposures = (int)fmax(2, ceil(last - *first));
    *step = (last - *first) / (exposures - 1);
    return exposures;
}

static void expose(const float *rgb, size_t count, double stops, float *out)
{
    for (size_t i = 0; i < 3 * count; i++)
        out[i] = film(fmax(0, (double)rgb[i]) * exp2(stops));
}

/* Planes: five of each picture, four of room, and three and three for what they look like exposed.
 */
enum { SEEN_PLANES = 5, ROOM_PLANES = 4, ALL_PLANES = 2 * SEEN_PLANES + ROOM_PLANES + 6 };

static void cut_room(float *at, size_t count, Seen seen[2], float *room[ROOM_PLANES],
                     float *exposed[2])
{
    for (int i = 0; i < 2; i++) {
        for (int k = 0; k < 3; k++, at += count)
            seen[i].lab[k] = at;
        seen[i].edges = at;
        seen[i].points = at + count;
        at += 2 * count;
    }
    for (int i = 0; i < ROOM_PLANES; i++, at += count)
        room[i] = at;
    exposed[0] = at;
    exposed[1] = at + 3 * count;
}

bool flip_map(const float *reference, const float *test, int width, int height, bool is_display,
              float *out)
{
    size_t count = (size_t)width * (size_t)height;
    float *all = mem_array(count, ALL_PLANES * sizeof *all);
    if (!all)
        return false;
    Seen seen[2];
    float *room[ROOM_PLANES], *exposed[2];
    cut_room(all, count, seen, room, exposed);
    memset(out, 0, count * sizeof *out);
    double first = 0, step = 0;
    int exposures = is_display ? 1 : find_exposures(reference, count, room[0], &first, &step);
    const float *pictures[] = {reference, test};
    for (int e = 0; e < exposures; e++) {
        for (int i = 0; i < 2; i++) {
            if (!is_display)
                expose(pictures[i], count, first + e * step, exposed[i]);
            see(is_display ? pictures[i] : exposed[i], width, height, room, &seen[i]);
        }
        raise_map(&seen[0], &seen[1], count, out);
    }
    mem_free(all);
    return true;
}
