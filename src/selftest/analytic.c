/* Scenes whose light has a closed form.
 *
 * The closed forms here share nothing with the renderer but the colours of the spectrum.
 * SPDX-License-Identifier: Apache-2.0 */
#include "selftest/selftest_int.h"

#include "math/spectrum.h"

/* --- closed forms ---------------------------------------------------------------------------- */

/* The part of unpolarised light that is reflected where it goes from index `from` to `to` under an
 * angle of that sine. */
static double reflected(double from, double to, double sine)
{
    double beyond = sine * from / to;
    if (beyond >= 1)
        return 1;
    double a = sqrt(1 - sine * sine), b = sqrt(1 - beyond * beyond);
    double s = (from * a - to * b) / (from * a + to * b);
    double p = (from * b - to * a) / (from * b + to * a);
    return 0.5 * (s * s + p * p);
}

/* Light on a floor `height` below the middle of a square of lamps of colour 1 that do not fade, of
 * sides twice `half`: the mean of the cosine, by the potential of a square. */
static double under_square(double height, double size)
{
    double h = height, a = size / 2;
    double potential = 8 * a * asinh(a / sqrt(a * a + h * h)) -
                       4 * h * atan(a * a / (h * sqrt(2 * a * a + h * h)));
    return h * potential / (4 * a * a);
}

/* Where a ray that goes down beside the middle of a ball of radius 1 by sin(angle) falls on the
 * plane `height` below the middle; infinite if it does not. */
static double behind_ball(double angle, double ior, double height)
{
    double inside = asin(sin(angle) / ior), turned = 2 * (angle - inside), out = 2 * inside - angle;
    if (turned >= PMS_PI / 2)
        return INFINITY;
    return fabs(sin(out) - (height - cos(out)) * tan(turned));
}

/* Parallel light of colour 1 that passes a ball of radius 1, less what its two surfaces reflect,
 * and falls on a disc of `radius` that lies `height` below the middle. */
static double through_ball(double ior, double height, double radius)
{
    enum { STEPS = 20000 };
    double sum = 0;
    for (int i = 0; i < STEPS; i++) {
        double angle = PMS_PI / 2 * (i + 0.5) / STEPS;
        double passed = 1 - reflected(1, ior, sin(angle));
        if (behind_ball(angle, ior, height) < radius)
            sum += passed * passed * 2 * PMS_PI * sin(angle) * cos(angle);
    }
    return sum * PMS_PI / 2 / STEPS;
}

/* What a pile of two panes lets through at right angles, all reflections to and fro counted. */
static double through_three(double first, double second)
{
    const double index[4] = {1, first, second, 1};
    double reflects = 0, passes = 1; /* of the pile so far, from behind; and through it */
    for (int i = 0; i < 3; i++) {
        double r = reflected(index[i], index[i + 1], 0), between = 1 - r * reflects;
        passes *= (1 - r) / between;
        reflects = r + (1 - r) * (1 - r) * reflects / between;
    }
    return passes;
}

/* How much further along a plane `depth` under glass red is seen than blue.  The index of violet is
 * `dispersion` times that of red, and `ior` in the middle. */
static double spread(double ior, double dispersion, double sine, double depth)
{
    enum { BANDS = 1000 };
    double sum = 0;
    for (int i = 0; i < BANDS; i++) {
        SpectrumBand band = spectrum_band(i, BANDS);
        double violet = (SPECTRUM_LAST + SPECTRUM_FIRST - 2 * band.wavelength) /
                        (2 * (SPECTRUM_LAST - SPECTRUM_FIRST));
        double bent = sine / (ior * pow(dispersion, violet));
        sum += ((double)band.color.r - (double)band.color.b) * depth * bent / sqrt(1 - bent * bent);
    }
    return sum;
}

/* Of a slab lit from the eye's side under an angle of that cosine. */
static double scattered_once(double cosine, double depth, double scattering, double absorption)
{
    double x = scattering + absorption, way = 1 + 1 / cosine;
    return scattering * (1 - exp(-x * depth * way)) / (x * way);
}

/* --- the scenes ------------------------------------------------------------------------------ */

#define HEAD                                                                                       \
    "#version 3.7; global_settings { assumed_gamma 1 max_trace_level 60 adc_bailout 1e-7 }\n"
#define NARROW "right 1e-3*x up 1e-3*y "
#define SPOT(place)                                                                                \
    HEAD "camera { orthographic location " place " direction -y right 1e-3*x up 1e-3*z }\n"
#define SLANT(place)                                                                               \
    HEAD "camera { orthographic location " place " direction z " NARROW "look_at 0 }\n"
#define ALONG_Z HEAD "camera { orthographic location -4*z direction z " NARROW "}\n"
#define OBLIQUE HEAD "camera { location <1,2,-5> look_at 0 angle 40 right x up y }\n"
#define WHITE_FLOOR "plane { y, 0 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
#define CLEAR                                                                                      \
    "pigment { rgbt 1 } finish { ambient 0 diffuse 0 conserve_energy\n"                            \
    "  reflection { 0, 1 fresnel on } }\n"
#define FEW "global_settings { pms { global_photons 20000 } }\n"
#define GLOWING_DISC                                                                               \
    SPOT("<0,0.2,0>")                                                                              \
    FEW "disc { <0,0.5,0>, y, 0.5 pigment { rgb 1 } finish { ambient 0 diffuse 0 emission 1 } }\n" \
        "disc { 0, y, 1 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
#define FURNACE                                                                                    \
    HEAD                                                                                           \
        "camera { location <0.3,0.1,0.2> look_at <0,1,0.3> angle 100 right x up y }\n"             \
        "sphere { 0, 1 hollow pigment { rgb 1 } finish { ambient 0 diffuse 0.5 emission 0.5 } }\n"
#define BALL                                                                                       \
    HEAD "global_settings { photons { count 20000 radius 0.2 gather 1, 1000000 } }\n"              \
         "camera { orthographic location <0,0.3,0> direction -y right 6.4*x up 6.4*z }\n"          \
         "light_source { <0,6,0> rgb 1 parallel point_at 0 }\n"                                    \
         "disc { 0, y, 3 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"                     \
         "sphere { <0,1.5,0>, 1 interior { ior 1.5 } " CLEAR                                       \
         "  photons { target refraction on reflection off collect off } }\n"

typedef enum CaseHow { BY_RAYS, BY_GATHER, BY_PATHS, BY_PASSES } CaseHow;
typedef enum CaseChannel { GREEN, RED_LESS_BLUE, CAUSTIC } CaseChannel;

typedef struct Case {
    const char *name, *what;
    CaseHow how;
    CaseChannel channel;
    int side, samples, seeds;
    double limit;
    const char *scene;
} Case;

static const Case cases[] = {
#define X(name, what, how, channel, side, samples, seeds, expected, limit, scene)                  \
    {name, what, how, channel, side, samples, seeds, limit, scene},
#include "selftest/cases.def"
#undef X
};

enum { CASE_COUNT = sizeof cases / sizeof *cases, SEEDS_MAX = 16, PASSES = 4 };

static void expect_all(double expected[CASE_COUNT])
{
    int i = 0;
#define X(name, what, how, channel, side, samples, seeds, value, limit, scene)                     \
    expected[i++] = value;
#include "selftest/cases.def"
#undef X
}

/* --- measuring ------------------------------------------------------------------------------- */

static void case_how(CaseHow how, RenderOptions *options)
{
    PlanOptions *plan = &options->plan;
    if (how == BY_GATHER) {
        plan->has_indirect = true;
        plan->indirect = INDIRECT_GATHER;
    } else if (how == BY_PATHS) {
        plan->integrator = INTEGRATOR_PATH;
    } else if (how == BY_PASSES) {
        plan->is_progressive = true;
        options->progressive.passes = PASSES;
    }
}

static RenderOptions case_options(const Case *item, const SelftestOptions *options, int seed)
{
    RenderOptions render = RENDER_OPTIONS_DEFAULT;
    render.width = render.height = item->side;
    render.threads = options->threads;
    render.seed = options->seed + (uint64_t)seed;
    if (item->samples > 1) {
        render.aa = AA_UNIFORM;
        render.samples = item->samples;
    }
    render.layers = item->channel == CAUSTIC ? LAYER_CAUSTIC : 0;
    case_how(item->how, &render);
    return render;
}

/* The mean over a picture of what the case looks at. */
static double picture_mean(const Image *image, CaseChannel channel)
{
    const ImageLayer *layer = image_find_layer(image, channel == CAUSTIC ? "caustic" : "");
    size_t count = (size_t)image->width * (size_t)image->height;
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        const float *rgb = layer->pixels + i * (size_t)layer->channel_count;
        sum += channel == RED_LESS_BLUE ? (double)rgb[0] - (double)rgb[2] : (double)rgb[1];
    }
    return sum / (double)count;
}

static Status measure(const Case *item, const SelftestOptions *options, int seed, Diag *diag,
                      double *out)
{
    RenderOptions render = case_options(item, options, seed);
    Image image;
    TRY(selftest_draw(item->scene, NULL, &render, diag, &image));
    *out = picture_mean(&image, item->channel);
    image_done(&image);
    return OK;
}

Status analytic_claims(const SelftestOptions *options, Diag *diag, int *failed)
{
    double expected[CASE_COUNT], measured[SEEDS_MAX];
    expect_all(expected);
    for (int i = 0; i < CASE_COUNT; i++) {
        const Case *item = &cases[i];
        for (int seed = 0; seed < item->seeds; seed++)
            TRY(measure(item, options, seed, diag, &measured[seed]));
        Claim claim =
            claim_of_mean(item->name, item->what, measured, item->seeds, expected[i], item->limit);
        selftest_claim(options, &claim, failed);
    }
    return OK;
}
