/* A scene that must look the same wherever it stands, whatever its unit, on any number of threads.
 *
 * Rays meet its solids at edges, tangents and walls that coincide; light bends, is focused, goes
 * through media and from surface to surface.  SPDX-License-Identifier: Apache-2.0 */
#include "selftest/selftest_int.h"

enum { SIDE = 40, SIZE = 10 /* of the scene, its units */ };

#define HEAD(more) "#version 3.7; global_settings { assumed_gamma 1 max_trace_level 8 " more " }\n"
#define THINGS                                                                                     \
    "camera { location <2,4,-9> look_at <0,1,0> angle 40 right x up y }\n"                         \
    "light_source { <4,9,-5> rgb 2 fade_distance 8 fade_power 2 }\n"                               \
    "light_source { <-6,7,-3> rgb 0.4 area_light x, z, 3, 3 }\n"                                   \
    "sky_sphere { pigment { gradient y color_map { [0 rgb 0.1] [1 rgb <0.2,0.3,0.6>] } } }\n"      \
    "plane { y, 0 hollow pigment { checker rgb 0.9, rgb <0.5,0.3,0.2> } }\n"                       \
    "difference { box { <-2.4,0,-1>, <-0.4,2,1> } cylinder { <-1.4,1,-2>, <-1.4,1,1>, 0.8 }\n"     \
    "  sphere { <-1.4,2,0>, 0.6 } pigment { gradient x color_map { [0 rgb x] [1 rgb 1] } }\n"      \
    "  finish { specular 0.4 reflection 0.2 } }\n"                                                 \
    "torus { 0.5, 0.15 rotate x*70 translate <-1.4,2.6,0> pigment { rgb y } }\n"
#define GLASS                                                                                      \
    "union { sphere { <1,2,0>, 1 interior { ior 1.5 fade_distance 1 fade_power 2\n"                \
    "  fade_color <1,0.6,0.3> } } box { <2,0,-1>, <3,1,0> interior { ior 1.33 } }\n"               \
    "  box { <2,1,-1>, <3,1.4,0> interior { ior 1.5 } } pigment { rgbt 1 } finish { ambient 0\n"   \
    "  diffuse 0 conserve_energy reflection { 0, 1 fresnel on } }\n"                               \
    "  photons { target refraction on reflection on } }\n"                                         \
    "sphere { <0.4,0.8,0.7>, 0.6 hollow pigment { rgbt 1 } interior { media {\n"                   \
    "  scattering { 1, 0.8 } absorption 0.2 density { gradient y } } } photons { pass_through } "  \
    "}\n"

/* All there is; and what chance has no part in. */
static const char whole[] =
    HEAD("photons { count 4000 media 1 } pms { global_photons 4000 }") THINGS GLASS;
static const char solid[] = HEAD("") THINGS;

typedef struct Move {
    const char *name, *what, *scene;
    double scale, shift; /* shift: in sizes of the scene */
    double limit;        /* of the largest change; 0: not one bit may */
} Move;

/* Places have 53 bits: at 1e6 times the size of the scene they are known to 1e-10 of it, at 1e9 to
 * 1e-7, which is a few millionths of a pixel. */
static const Move moves[] = {
    {"many threads", "pixels that have another bit than by one", whole, 1, 0, 0},
    {"scaled by 2^-20", "pixels that have another bit", whole, 0x1p-20, 0, 0},
    {"scaled by 2^20", "pixels that have another bit", whole, 0x1p20, 0, 0},
    {"shifted by 1e6 sizes", "largest change of a pixel, white is 1", solid, 1, 1e6, 1e-5},
    {"shifted by 1e9 sizes", "largest change of a pixel, white is 1", solid, 1, 1e9, 1.0 / 255},
};

static Status draw(const Move *move, int threads, const SelftestOptions *options, Diag *diag,
                   Image *out)
{
    const Xform upright = XFORM_IDENTITY;
    V3 shift = v3_scale(v3(0.48, 0.6, 0.64), SIZE * move->shift);
    Similarity by = similarity_make(&upright, move->scale, shift);
    RenderOptions render = RENDER_OPTIONS_DEFAULT;
    render.width = render.height = SIDE;
    render.threads = threads;
    render.seed = options->seed;
    render.plan.has_indirect = move->scene == whole;
    return selftest_draw(move->scene, &by, &render, diag, out);
}

static Status check_move(const Move *move, const Image *still, const SelftestOptions *options,
                         Diag *diag, int *failed)
{
    Image moved;
    TRY(draw(move, options->threads > 1 ? options->threads : 2, options, diag, &moved));
    double change =
        move->limit > 0 ? change_largest(still, &moved) : (double)change_bits(still, &moved);
    image_done(&moved);
    Claim claim = {move->name, move->what, 0, change, 0, move->limit};
    selftest_claim(options, &claim, failed);
    return OK;
}

Status stability_claims(const SelftestOptions *options, Diag *diag, int *failed)
{
    for (size_t i = 0; i < sizeof moves / sizeof *moves; i++) {
        const Move as_written = {.scene = moves[i].scene, .scale = 1};
        Image still;
        TRY(draw(&as_written, 1, options, diag, &still));
        Status status = check_move(&moves[i], &still, options, diag, failed);
        image_done(&still);
        TRY(status);
    }
    return OK;
}
