/* Photons in media: what targets focus, what media scatter more than once, and that no light is
 * lost or counted twice.
 *
 * Expected values are closed forms, shadow rays, or a walk through a slab written here that shares
 * nothing with the photons.  SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "lit_scene.h"
#include "table.h"
#include "slab_walk.h"

#include "base/mem.h"
#include "eye/eye.h"
#include "math/sample.h"
#include "photon/photon_map.h"
#include "texture/media.h"

enum { NEAREST = 30 };

/* The mean over the film, by part (green). */
typedef struct View {
    double part[PART_COUNT], sum, error;
} View;

static View view_within(LitScene *lit, double radius, int samples)
{
    EyeThread *eye;
    VolumeIndex *volume = NULL;
    if (lit->maps.volume)
        assert_int_equal(volume_index_new(lit->tracer, lit->maps.volume, NEAREST, radius, 2,
                                          &lit->diag, &volume),
                         OK);
    EyeOptions options = {.width = 1, .height = 1, .seed = 3, .volume = volume};
    assert_int_equal(eye_thread_new(lit->tracer, &options, &lit->diag, &eye), OK);
    View out = {.sum = 0};
    double squares = 0;
    for (int i = 0; i < samples; i++) {
        EyeSample s;
        Rng rng = rng_at(11, 0, (uint64_t)i);
        double x = rng_double(&rng), y = rng_double(&rng), sum = 0;
        assert_true(eye_sample(eye, x, y, 0, (uint32_t)i, &s));
        for (int k = 0; k < PART_COUNT; k++) {
            out.part[k] += (double)s.part[k].g / samples;
            sum += (double)s.part[k].g;
        }
        out.sum += sum / samples;
        squares += sum * sum / samples;
    }
    out.error = sqrt(fmax(0, squares - out.sum * out.sum) / samples);
    eye_thread_free(eye, NULL);
    volume_index_free(volume);
    return out;
}

static View view(LitScene *lit, int samples)
{
    return view_within(lit, 0, samples);
}

#define HEAD "#version 3.7;\nglobal_settings { assumed_gamma 1 max_trace_level 200\n"
#define EYE "camera { orthographic location <0,0,-10> direction z right x*1 up y*1 }\n"

/* --- focused light -------------------------------------------------------------------------- */

/* Row S11: the volume map is made when media scatter, and photons are asked for in them. */
static void volume_map_only_when_called_for(void **state)
{
    (void)state;
    const struct {
        const char *settings, *media;
        bool is_made;
    } cases[] = {
        {"photons { count 2000 media 1 }", "media { scattering { 1, 0.1 } }", true},
        {"photons { count 2000 media 0 }", "media { scattering { 1, 0.1 } }", false},
        {"photons { count 2000 media 1 }", "media { absorption 0.1 }", false},
        {"photons { count 2000 media 1 }", "media { scattering { 1, 0.1 } collect off }", false},
        {"photons { count 2000 media 1 }", "", false},
        {"pms { gi on global_photons 2000 }", "media { scattering { 1, 0.1 } }", true},
        {"pms { gi on global_photons 2000 }", "media { emission 0.1 }", false},
        {"", "media { scattering { 1, 0.1 } }", false},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[1024];
        snprintf(text, sizeof text,
                 HEAD "%s }\nlight_source { <0,4,0> 1 }\n%s\n"
                      "box { <-9,-3,-11>, <9,6,4> hollow pigment { rgb 0.5 } }\n"
                      "sphere { <0,2,0>, 1 pigment { rgbt 1 } interior { ior 1.5 }\n"
                      "  photons { target refraction on } }\n",
                 cases[i].settings, cases[i].media);
        LitScene lit;
        lit_make(&lit, text, 1, 1);
        if ((lit.maps.volume != NULL) != cases[i].is_made)
            fail_msg("%s, %s: %d", cases[i].settings, cases[i].media, lit.maps.volume != NULL);
        assert_true((lit.maps.books.volume != NULL) == cases[i].is_made);
        lit_done(&lit);
    }
}

/* A pane that does not bend light casts no shadow in smoke, whether the light behind it comes by
 * shadow rays or, as it is a target, by photons. */
static void a_pane_of_ior_1_changes_nothing(void **state)
{
    (void)state;
    const char *const lights[] = {
        "light_source { <0,4,0> 1 media_attenuation on }",
        "light_source { <0,4,0> 3 fade_distance 2 fade_power 2 media_attenuation on }",
        "light_source { <1,4,0> 1 spotlight point_at 0 radius 20 falloff 30\n  media_attenuation "
        "on }",
        "light_source { <0,4,0> 1 parallel point_at 0 media_attenuation on }",
    };
    const char *const media[] = {
        "media { scattering { 1, 0.1 } }",
        "media { scattering { 5, 0.2 eccentricity 0.5 } absorption 0.1 }",
        "media { scattering { 2, 0.2 extinction 0 } }",
        "media { scattering { 1, 0.3 } density { gradient y scale 3 } }",
    };
    for (int i = 0; i < 4; i++) {
        double sum[2];
        for (int is_target = 0; is_target < 2; is_target++) {
            char text[2048];
            snprintf(text, sizeof text,
                     HEAD "photons { count 100000 media 10 } }\n" EYE "%s\n%s\n"
                          "box { <-9,-3,-11>, <9,6,4> hollow pigment { rgb 0 }\n"
                          "  finish { ambient 0 diffuse 0 } }\n"
                          "box { <-2,2,-2>, <2,2.01,2> hollow pigment { rgbt 1 }\n"
                          "  finish { ambient 0 diffuse 0 } interior { ior 1 } photons { %s } }\n",
                     lights[i], media[i],
                     is_target ? "target refraction on collect off" : "refraction off");
            LitScene lit;
            lit_make(&lit, text, 2, 3);
            assert_true((lit.maps.volume != NULL) == (is_target != 0));
            View got = view(&lit, 400);
            sum[is_target] = got.sum;
            if (is_target)
                assert_true(got.part[PART_CAUSTIC] > 0.1 * got.sum);
            assert_true(got.part[PART_INDIRECT] == 0);
            lit_done(&lit);
        }
        print_message("# light %d: %.5f with photons, %.5f without\n", i, sum[1], sum[0]);
        assert_true(fabs(sum[1] / sum[0] - 1) < 0.02);
    }
}

/* --- what is scattered more than once ------------------------------------------------------- */

/* In units of light without pi, scattering 1/4 with extinction 4 is physical: what comes back of
 * irradiance 1 is (1/4) of what the walk sends per unit of depth. */
static void multiple_scattering_in_a_slab(void **state)
{
    (void)state;
    const double depths[] = {0.5, 2}, albedos[] = {1, 0.7};
    for (int i = 0; i < 4; i++) {
        double depth = depths[i / 2], albedo = albedos[i % 2], walk_error;
        char text[2048];
        snprintf(text, sizeof text,
                 HEAD
                 "photons { count 1 } pms { gi on gi_method map global_photons 100000 } }\n" EYE
                 "light_source { <0,0,-50> 1 parallel point_at 0 }\n"
                 "box { <-10,-10,0>, <10,10,%g> hollow pigment { rgbt 1 }\n"
                 "  finish { ambient 0 diffuse 0 } interior {\n"
                 "  media { scattering { 1, %g extinction 4 } absorption %g } } }\n"
                 "box { <50,50,50>, <51,51,51> pigment { rgb 1 } }\n",
                 depth, albedo / 4, 1 - albedo);
        LitScene lit;
        lit_make(&lit, text, 2, 3);
        assert_non_null(lit.maps.volume);
        View got = view(&lit, 400);
        double expected = slab_walk(depth, albedo, 400000, &walk_error) / 4;
        double single = albedo / 4 * (1 - exp(-2 * depth)) / 2;
        /* A unit square of the slab has so many photons that are seen. */
        double seen = (double)photon_map_count(lit.maps.volume) / 400;
        double error = expected * 2 / sqrt(seen) + walk_error / 4;
        print_message(
            "# depth %g albedo %g: %.4f, expected %.4f +- %.4f; once %.4f, expected %.4f\n", depth,
            albedo, got.part[PART_INDIRECT], expected, error, got.part[PART_DIRECT], single);
        assert_true(fabs(got.part[PART_INDIRECT] - expected) < 4 * error);
        assert_true(fabs(got.part[PART_DIRECT] / single - 1) < 0.005);
        lit_done(&lit);
    }
}

/* A lamp in the middle of a closed sphere of smoke that loses no light, with a wall that keeps the
 * part 1 - rho: what falls on the wall in all is flux / (area (1 - rho)), however thick the smoke.
 */
static void no_light_is_lost_in_smoke(void **state)
{
    (void)state;
    const double rho = 0.5, far = 2e-4, flux = 4 * PMS_PI * 2 * far * far;
    const double thick[] = {1e-6, 0.5, 3};
    for (int i = 0; i < 3; i++) {
        char text[1024];
        snprintf(text, sizeof text,
                 HEAD "pms { gi on gi_method map global_photons 100000 } }\n"
                      "light_source { 0 1 fade_distance %g fade_power 2 media_attenuation on }\n"
                      "media { scattering { 5, %g eccentricity 0.5 extinction 4 } }\n"
                      "sphere { 0, 1 hollow pigment { rgb 1 } finish { ambient 0 diffuse %g } }\n",
                 far, thick[i] / 4, rho);
        LitScene lit;
        lit_make(&lit, text, 2, 3);
        const PhotonMap *map = lit.maps.global;
        double stored = 0;
        for (size_t k = 0; k < photon_map_count(map); k++)
            stored += (double)lit_photon_power(map, k).g;
        double direct = flux * exp(-thick[i]), expected = flux / (1 - rho);
        double error = 3 * stored / sqrt((double)photon_map_count(map));
        print_message("# depth %g: %.6f on the wall, expected %.6f +- %.6f\n", thick[i],
                      direct + stored, expected, error);
        /* The fading is not the inverse square beside the lamp: 1 in 1000 is lost there. */
        assert_true(fabs(direct + stored - expected) < 4 * error + 0.002 * expected);
        const LightBooks *books = &lit.maps.books.global[0];
        assert_true(books->emitted ==
                    books->stored_paths + books->absorbed + books->escaped + books->cut);
        books = &lit.maps.books.volume[0];
        assert_true(books->emitted ==
                    books->stored_paths + books->absorbed + books->escaped + books->cut);
        lit_done(&lit);
    }
}

/* White furnace: a ball of smoke that loses no light, under a white sky, cannot be seen. */
static void white_furnace(void **state)
{
    (void)state;
    const double thick[] = {0.3, 1};
    for (int type = 1; type <= 5; type += 4)
        for (int i = 0; i < 2; i++) {
            char text[1024];
            snprintf(text, sizeof text,
                     HEAD "pms { gi on gi_method map global_photons 200000 } }\n" EYE
                          "background { rgb 1 }\n"
                          "sphere { 0, 1 hollow pigment { rgbt 1 } finish { ambient 0 diffuse 0 }\n"
                          "  interior { media { scattering { %d, %g extinction 4 %s } } } }\n",
                     type, thick[i] / 4, type == 5 ? "eccentricity 0.6" : "");
            LitScene lit;
            lit_make(&lit, text, 2, 3);
            assert_non_null(lit.maps.volume);
            View got = view(&lit, 500);
            /* Photons of a thousandth of the ball's shadow are one independent estimate. */
            double error = 2 / sqrt((double)photon_map_count(lit.maps.volume) / 4);
            print_message("# type %d, depth %g: %.4f, expected 1 +- %.4f; of photons %.4f\n", type,
                          thick[i], got.sum, error, got.part[PART_INDIRECT]);
            assert_true(fabs(got.sum - 1) < 4 * error + 0.005);
            lit_done(&lit);
        }
}

/* Photons as they are in a furnace: spread evenly over a hull (by a recurrence that fills space, so
 * that there is little noise), from all sides, and bright enough for radiance 1.
 *
 * core  this part of the hull, around its middle, is left out: nothing is seen so deep. */
static PhotonMap *furnace_photons(Diag *diag, V3 half, bool is_ball, V3 core, size_t count)
{
    Photon *photons = mem_array(count, sizeof *photons);
    PhotonMap *map;
    double part = is_ball ? PMS_PI / 6 : 1, left_out = core.x * core.y * core.z;
    double volume = 8 * half.x * half.y * half.z * part * (1 - left_out);
    float power = (float)(4 * volume / (double)count);
    for (uint64_t i = 0, stored = 0; stored < count; i++) {
        Rng rng = rng_at(31, 0, i);
        double n = (double)i + 0.5;
        V3 at = v3(2 * fmod(n * 0.8191725133961645, 1) - 1, 2 * fmod(n * 0.6710436067037893, 1) - 1,
                   2 * fmod(n * 0.5497004779019703, 1) - 1);
        bool is_core = is_ball ? v3_len(at) < core.x
                               : fabs(at.x) < core.x && fabs(at.y) < core.y && fabs(at.z) < core.z;
        if (is_core || (is_ball && v3_len2(at) > 1))
            continue;
        double u = rng_double(&rng), v = rng_double(&rng);
        V3 p = v3(at.x * half.x, at.y * half.y, at.z * half.z), from = warp_sphere((V2){u, v});
        Photon *photon = &photons[stored++];
        *photon = (Photon){.pos = {(float)p.x, (float)p.y, (float)p.z}};
        rgbe_encode(rgb(power, power, power), &rng, photon->rgbe);
        direction_encode(from, &photon->phi, &photon->theta);
    }
    assert_int_equal(photon_map_new(diag, photons, count, v3(0, 0, 0), 2, &map), OK);
    return map;
}

static double core_part(double half, double extinction)
{
    return fmax(0, 1 - 9 / (extinction * half));
}

/* White furnace, from thin smoke to smoke so dense that light goes less far than the balls of the
 * photons are wide: a photon beside a ray is cut off, and dimmed, as by the surfaces that its own
 * parallel ray comes from and goes to. */
static void furnace_thin_to_dense(void **state)
{
    (void)state;
    const struct {
        const char *name, *camera, *hull;
        V3 half;
    } cases[] = {
        {"closed ball",
         "camera { orthographic location <0.1,0.2,-0.5> direction z right x*0.5 up y*0.5 }",
         "sphere { 0, 1 hollow pigment { rgb 1 } finish { ambient 0 diffuse 0 emission 1 }",
         {1, 1, 1}},
        {"ball",
         "camera { orthographic location -z*5 direction z right x up y }",
         "sphere { 0, 1 hollow pigment { rgbt 1 } finish { ambient 0 diffuse 0 }",
         {1, 1, 1}},
        {"ball at a slant",
         "camera { orthographic location <0.65,0,-5> direction z right x*0.2 up y*0.2 }",
         "sphere { 0, 1 hollow pigment { rgbt 1 } finish { ambient 0 diffuse 0 }",
         {1, 1, 1}},
        {"box",
         "camera { orthographic location <3,5,-4>*2 right x up y look_at <0.4,0.4,-1> }",
         "box { -1, 1 hollow pigment { rgbt 1 } finish { ambient 0 diffuse 0 }",
         {1, 1, 1}},
        {"slab",
         "camera { orthographic location <4,0,-4> right x up y look_at 0 }",
         "box { <-1.3,-1.3,-0.3>, <1.3,1.3,0.3> hollow pigment { rgbt 1 } finish { ambient 0 "
         "diffuse 0 }",
         {1.3, 1.3, 0.3}},
    };
    enum { CASES = sizeof cases / sizeof cases[0] };
    const double depths[] = {0.1, 1, 10, 100};
    bool is_long = table_is_long();
    for (int i = 0; i < 4; i++) {
        double sum = 0;
        int count = 0;
        for (int k = 0; k < CASES; k++) {
            if (!is_long && k != 1 && k != 3)
                continue;
            char text[1024], what[64];
            bool is_ball = strstr(cases[k].hull, "sphere") != NULL;
            snprintf(text, sizeof text,
                     HEAD "}\n%s\n%s\n%s\n"
                          "  interior { media { scattering { 1, %g extinction 4 } } } }\n",
                     cases[k].camera, k == 0 ? "" : "background { rgb 1 }", cases[k].hull,
                     depths[i] / (2 * cases[k].half.z) / 4);
            LitScene lit;
            lit_read(&lit, text, 2, 3);
            V3 half = cases[k].half, core = {0, 0, 0};
            double x = depths[i] / (2 * half.z);
            if (k > 0)
                core = v3(core_part(half.x, x), core_part(half.y, x), core_part(half.z, x));
            lit.maps.volume =
                furnace_photons(&lit.diag, half, is_ball, core, i < 2 ? 200000 : 2000000);
            View got = view_within(&lit, 0.05, i < 2 ? 1000 : 500);
            snprintf(what, sizeof what, "white furnace, %s of depth %g", cases[k].name, depths[i]);
            /* What even places leave of the noise of photons is below this where few are seen. */
            double error = got.error + (i < 2 ? 0.0005 : 0.003);
            table_row(what, got.sum, 1, error);
            assert_true(fabs(got.sum - 1) < 4 * error);
            sum += got.sum;
            count++;
            lit_done(&lit);
        }
        assert_true(fabs(sum / count - 1) < 0.005);
    }
}

/* --- hard cases ----------------------------------------------------------------------------- */

static void extreme_media_end(void **state)
{
    (void)state;
    const char *const media[] = {
        "media { scattering { 1, 1e6 extinction 4 } }",
        "media { scattering { 1, 1e-6 } }",
        "media { scattering { 1, 1 extinction 0 } }",
        "media { absorption 1e6 }",
        "media { scattering { 5, 1 eccentricity 0.999 extinction 4 } }",
        "media { scattering { 1, <0, 1, 1e3> extinction 4 } absorption <1e3, 0, 1e-3> }"};
    for (size_t i = 0; i < sizeof media / sizeof media[0]; i++) {
        char text[1024];
        snprintf(text, sizeof text,
                 HEAD "photons { count 2000 media 1 } pms { gi on global_photons 2000 } }\n" EYE
                      "light_source { <0,4,0> 1 }\n%s\n"
                      "box { <-9,-3,-11>, <9,6,4> hollow pigment { rgb 0.5 } }\n"
                      "sphere { <0,2,0>, 1 pigment { rgbt 1 } finish { ambient 0 diffuse 0 }\n"
                      "  interior { ior 1.5 } photons { target refraction on } }\n",
                 media[i]);
        LitScene lit;
        lit_make(&lit, text, 2, 3);
        View got = view(&lit, 20);
        assert_true(isfinite(got.sum) && got.sum >= 0);
        for (int k = 0; k < 2; k++) {
            const LightBooks *books = k ? lit.maps.books.volume : lit.maps.books.global;
            if (!books)
                continue;
            assert_true(books->emitted ==
                        books->stored_paths + books->absorbed + books->escaped + books->cut);
        }
        lit_done(&lit);
    }
}

/* One seed, one map, on any number of threads. */
static void threads_do_not_matter(void **state)
{
    (void)state;
    uint64_t first = 0;
    double seen = 0;
    for (int threads = 1; threads <= 3; threads++) {
        LitScene lit;
        lit_make(&lit,
                 HEAD "photons { count 20000 media 1 } pms { gi on global_photons 5000 } }\n" EYE
                      "light_source { <0,4,0> 1 }\nmedia { scattering { 2, 0.2 } }\n"
                      "box { <-9,-3,-11>, <9,6,4> hollow pigment { rgb 0.5 } }\n"
                      "sphere { <0,2,0>, 1 pigment { rgbt 1 } finish { ambient 0 diffuse 0 }\n"
                      "  interior { ior 1.5 } photons { target refraction on } }\n",
                 threads, 3);
        uint64_t hash = photon_map_hash(lit.maps.volume);
        double sum = view(&lit, 20).sum;
        first = threads == 1 ? hash : first;
        seen = threads == 1 ? sum : seen;
        assert_true(hash == first && sum == seen);
        lit_done(&lit);
    }
}

/* --- how far a photon glows ----------------------------------------------------------------- */

static void count_photon(void *ctx, const VolumePhoton *photon)
{
    int *count = ctx;
    *count += rgb_max(photon->power) > 0;
}

static int photons_on_ray(const VolumeIndex *index, double x)
{
    int count = 0;
    Ray ray = {v3(x, -20, 0), v3(0, 1, 0), 0, INFINITY};
    VolumeEnds none = {v3(0, 0, 0), v3(0, 0, 0)};
    volume_along(index, &ray, 40, &none, count_photon, &count);
    return count;
}

/* Photons in two heaps, far apart: the nearest of most of one lie in the other.  `power` by heap.
 */
static PhotonMap *two_heaps(LitScene *lit, double apart, const double power[2])
{
    enum { HEAP = 32 }; /* whole blocks */
    Photon *photons = mem_array(2 * HEAP, sizeof *photons);
    PhotonMap *map;
    Rng rng = rng_at(5, 0, 0);
    for (int i = 0; i < 2 * HEAP; i++) {
        V3 at = warp_sphere((V2){rng_double(&rng), rng_double(&rng)});
        at = v3_mad(v3(i < HEAP ? 0 : apart, 0, 0), 0.1, at);
        float its = (float)power[i / HEAP];
        photons[i] = (Photon){.pos = {(float)at.x, (float)at.y, (float)at.z}};
        rgbe_encode(rgb(its, its, its), &rng, photons[i].rgbe);
        direction_encode(v3(0, 1, 0), &photons[i].phi, &photons[i].theta);
    }
    assert_int_equal(photon_map_new(&lit->diag, photons, 2 * HEAP, v3(0, 0, 0), 1, &map), OK);
    return map;
}

/* A photon is spread no further than where it gives half the first step of a picture of 8 bits,
 * 0.5/255/12.92, of what rays get where photons are of common density: with 16 photons, of light p
 * each, within R of one, these send the ray through it 1.5 16 p / (pi R^2), and one alone, spread
 * over r, at most 2 p / (pi r^2).  However bright all are, and whatever lamps there are elsewhere;
 * but those of a brighter heap go further.  Between two heaps it is dark. */
static void no_glow_where_no_light_goes(void **state)
{
    (void)state;
    const double part = 0.5 / 255 / 12.92, apart = 10;
    const struct {
        const char *lamp;
        double powers[2];
    } cases[] = {
        {"light_source { <0,4,0> 1 }", {1e-3, 1e-3}},
        {"light_source { <0,4,0> 1 }", {1, 1}},
        {"light_source { <0,4,0> 1e6 }", {1e-3, 1e-3}},
        {"", {1e-3, 1e-3}},
        {"", {1e-3, 3e-3}},
        {"", {1e-3, 4e-4}},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        LitScene lit;
        char text[512];
        snprintf(text, sizeof text, HEAD "}\n" EYE "%s\nmedia { scattering { 1, 0.5 } }\n",
                 cases[i].lamp);
        lit_read(&lit, text, 1, 1);
        const double *powers = cases[i].powers, mean = (powers[0] + powers[1]) / 2;
        PhotonMap *map = two_heaps(&lit, apart, powers);
        VolumeIndex *index;
        assert_int_equal(volume_index_new(lit.tracer, map, NEAREST + 10, 0, 1, &lit.diag, &index),
                         OK);
        double common = photon_map_radius(map, 16);
        double reach = common * sqrt(2 * powers[0] / (1.5 * 16 * mean * part));
        assert_true(reach > 1 && reach + 0.2 < apart);
        assert_int_equal(photons_on_ray(index, 0), 32);
        assert_int_equal(photons_on_ray(index, -0.95 * reach + 0.1), 32);
        assert_int_equal(photons_on_ray(index, -1.05 * reach - 0.1), 0);
        if (powers[0] == powers[1] && 2 * (reach + 0.2) < apart)
            assert_int_equal(photons_on_ray(index, apart / 2), 0);
        volume_index_free(index);
        photon_map_free(map);
        lit_done(&lit);
    }
}

/* A block of photons in a row, one of which is bright, and far off a heap of such bright ones. */
static PhotonMap *row_and_heap(LitScene *lit, int bright)
{
    enum { ROW = 16, ALL = 8 * ROW };
    Photon *photons = mem_array(ALL, sizeof *photons);
    PhotonMap *map;
    Rng rng = rng_at(5, 0, 0);
    for (int i = 0; i < ALL; i++) {
        V3 at = warp_sphere((V2){rng_double(&rng), rng_double(&rng)});
        at = i < ROW ? v3(0.5 * i, 0, 0) : v3_mad(v3(90, 0, 0), 0.1, at);
        float power = i < ROW && i != bright ? 1e-9f : 1e-3f;
        photons[i] = (Photon){.pos = {(float)at.x, (float)at.y, (float)at.z}};
        rgbe_encode(rgb(power, power, power), &rng, photons[i].rgbe);
        direction_encode(v3(0, 1, 0), &photons[i].phi, &photons[i].theta);
    }
    assert_int_equal(photon_map_new(&lit->diag, photons, ALL, v3(0, 0, 0), 1, &map), OK);
    return map;
}

/* One photon of a block may be far brighter than the others: it goes as far as its light asks for,
 * so that it is no speck, whichever it is. */
static void the_brightest_of_a_block_counts(void **state)
{
    (void)state;
    for (int bright = 0; bright < 16; bright++) {
        LitScene lit;
        VolumeIndex *index;
        lit_read(&lit, HEAD "}\n" EYE "media { scattering { 1, 0.5 } }\n", 1, 1);
        PhotonMap *map = row_and_heap(&lit, bright);
        assert_int_equal(volume_index_new(lit.tracer, map, NEAREST / 2, 0, 1, &lit.diag, &index),
                         OK);
        double reach = photon_map_radius(map, 16) * sqrt(2 / (1.5 * 16 * (0.5 / 255 / 12.92)));
        assert_true(reach > 1 && reach < 3);
        assert_true(photons_on_ray(index, -0.9 * reach) > 0);
        assert_int_equal(photons_on_ray(index, -1.1 * reach), 0);
        volume_index_free(index);
        photon_map_free(map);
        lit_done(&lit);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(volume_map_only_when_called_for),
        cmocka_unit_test(a_pane_of_ior_1_changes_nothing),
        cmocka_unit_test(multiple_scattering_in_a_slab),
        cmocka_unit_test(no_light_is_lost_in_smoke),
        cmocka_unit_test(white_furnace),
        cmocka_unit_test(furnace_thin_to_dense),
        cmocka_unit_test(extreme_media_end),
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(no_glow_where_no_light_goes),
        cmocka_unit_test(the_brightest_of_a_block_counts),
    };
    return cmocka_run_group_tests_name("volume", tests, NULL, NULL);
}
