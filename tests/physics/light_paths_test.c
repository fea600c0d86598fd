/* Which map holds which paths of light, and that direct light, caustics and indirect light add up
 * to all of it: no path is counted twice, none is lost.  SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "lit_eye.h"
#include "lit_methods.h"

#include "math/sample.h"

#define WHITE_ROOM(size)                                                                           \
    "box { -" #size ", " #size " hollow pigment { rgb 1 } finish { ambient 0 diffuse 0.5 } }\n"

/* --- what calls for which map ---------------------------------------------------------------- */

/* Row S11: a map is built only if the scene calls for it. */
static void maps_are_made_when_called_for(void **state)
{
    (void)state;
#define BALL "sphere { 0, 1 pigment { rgbt 1 } finish { reflection 0.1 } interior { ior 1.5 } "
#define ON "global_settings { assumed_gamma 1 photons { count 2000 } }\n"
#define GI "global_settings { assumed_gamma 1 pms { gi on gi_method map global_photons 2000 } }\n"
    static const struct {
        const char *text;
        bool caustic, global;
    } cases[] = {
        {BALL "photons { target refraction on } }", false, false},
        {ON "sphere { 0, 1 pigment { rgb 1 } }", false, false},
        {ON "sphere { 0, 1 pigment { rgb 1 } photons { target } }", false, false},
        {ON BALL "photons { target } }", false, false},
        {ON BALL "photons { target refraction off reflection off } }", false, false},
        {ON BALL "photons { target refraction on } }", true, false},
        {ON BALL "photons { target reflection on } }", true, false},
        {ON BALL "}", true, false}, /* nothing is marked: what bends or mirrors is a target */
        {GI BALL "photons { target refraction on } }", false, true},
        {GI "sphere { 0, 1 pigment { rgb 1 } }", false, true},
        {ON GI BALL "photons { target refraction on } }", true, true},
        {ON GI "sphere { 0, 1 pigment { rgb 1 } }", false, true},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[1024];
        snprintf(text, sizeof text, "%s\nlight_source { <0,3,0> rgb 1 }\n" WHITE_ROOM(4),
                 cases[i].text);
        LitScene lit;
        lit_make(&lit, text, 1, 1);
        if ((lit.maps.caustic != NULL) != cases[i].caustic ||
            (lit.maps.global != NULL) != cases[i].global)
            fail_msg("%s: caustic %d global %d", cases[i].text, lit.maps.caustic != NULL,
                     lit.maps.global != NULL);
        assert_true((lit.maps.books.caustic != NULL) == cases[i].caustic);
        assert_true((lit.maps.books.global != NULL) == cases[i].global);
        assert_true((lit.stats.count[STAT_PHOTONS_EMITTED] > 0) ==
                    (cases[i].caustic || cases[i].global));
        assert_true((lit.stats.count[STAT_PHOTON_RAYS] > 0) ==
                    (cases[i].caustic || cases[i].global));
        lit_done(&lit);
    }
}

/* --- what each map holds --------------------------------------------------------------------- */

static bool is_on_line(V3 from, V3 p, V3 box_lo, V3 box_hi)
{
    double enter = 0, leave = 1;
    const double o[3] = {from.x, from.y, from.z}, q[3] = {p.x, p.y, p.z};
    const double lo[3] = {box_lo.x, box_lo.y, box_lo.z}, hi[3] = {box_hi.x, box_hi.y, box_hi.z};
    for (int a = 0; a < 3; a++) {
        double t0 = (lo[a] - 1e-9 - o[a]) / (q[a] - o[a]);
        double t1 = (hi[a] + 1e-9 - o[a]) / (q[a] - o[a]);
        enter = fmax(enter, fmin(t0, t1));
        leave = fmin(leave, fmax(t0, t1));
    }
    return enter <= leave;
}

/* Row S11: every photon of the caustic map came over at least one mirror or through glass, and
 * over nothing diffuse.  The glass does not bend, so it came straight from the lamp through the
 * pane, or from the lamp's image behind the mirror; light that had been diffuse before, in the
 * room or on the mirror, comes from anywhere.  The floor, the walls, the mirror itself are
 * somewhat diffuse and the floor a mirror as well, but no target. */
static void caustic_map_holds_specular_paths_only(void **state)
{
    (void)state;
    LitScene lit;
    lit_make(
        &lit,
        "global_settings { assumed_gamma 1 max_trace_level 20 photons { count 60000 } }\n"
        "light_source { <1,2,0> rgb 1 }\n" WHITE_ROOM(
            4) "box { <-4,-3.9,-4>, <4,-3.8,4> pigment { rgb 1 } finish { ambient 0 diffuse 0.4\n"
               "  reflection 0.5 } }\n"
               "disc { <0,-1,0>, y, 0.8 pigment { rgb 1 } finish { ambient 0 diffuse 0.4\n"
               "  reflection 0.5 } photons { target reflection on } }\n"
               "box { <-2,0,-1>, <-1.5,1,1> pigment { rgbt 1 } finish { ambient 0 diffuse 0 }\n"
               "  interior { ior 1 } photons { target refraction on } }\n",
        2, 1);
    const V3 lamp = {1, 2, 0}, image = {1, -4, 0}, lo = {-2, 0, -1}, hi = {-1.5, 1, 1};
    size_t mirrored = 0, refracted = 0, count = photon_map_count(lit.maps.caustic);
    for (size_t i = 0; i < count; i++) {
        V3 p = lit_photon_place(lit.maps.caustic, i);
        Photon photon = photon_map_at(lit.maps.caustic, i);
        V3 from = direction_decode(photon.phi, photon.theta);
        double to_lamp = v3_dist(from, v3_unit(v3_sub(lamp, p)));
        double to_image = v3_dist(from, v3_unit(v3_sub(image, p)));
        double across = (p.y + 1) / (p.y + 4); /* of the way to the image, where the mirror is */
        V3 at = v3_add(p, v3_scale(v3_sub(image, p), across));
        if (to_lamp < DIRECTION_MAX_ERROR + 1e-6 && is_on_line(lamp, p, lo, hi))
            refracted++;
        else if (to_image < DIRECTION_MAX_ERROR + 1e-6 && p.y > -1 && hypot(at.x, at.z) < 0.8001)
            mirrored++;
        else
            fail_msg("photon at %g %g %g from %g %g %g", p.x, p.y, p.z, from.x, from.y, from.z);
    }
    print_message("# %zu photons over the mirror, %zu through the pane\n", mirrored, refracted);
    assert_true(mirrored > 1000 && refracted > 1000);
    lit_done(&lit);
}

/* Row S11: the global map holds every diffuse hit but a path's first, which is direct light or the
 * caustic map's: with reflectance rho a path has rho/(1-rho) of them, and no photon lies where
 * light can come only from the lamp. */
static void global_map_holds_all_hits_but_the_first(void **state)
{
    (void)state;
    for (int tenths = 2; tenths <= 8; tenths += 3) {
        char text[1024];
        double rho = tenths / 10.0;
        snprintf(text, sizeof text,
                 "global_settings { assumed_gamma 1 max_trace_level 400\n"
                 "  pms { gi on gi_method map global_photons 50000 } }\n"
                 "light_source { <0.1,0.2,0.3> rgb 1 }\n"
                 "sphere { 0, 1 hollow pigment { rgb 1 } finish { ambient 0 diffuse %g } }\n",
                 rho);
        LitScene lit;
        lit_make(&lit, text, 2, 1);
        const LightBooks *books = &lit.maps.books.global[0];
        double expected = 50000 * rho / (1 - rho), error = sqrt(50000 * rho) / (1 - rho);
        print_message("# rho %g: %.0f of %.0f (+- %.0f)\n", rho, (double)books->stored, expected,
                      4 * error);
        assert_true(fabs((double)books->stored - expected) < 4 * error);
        assert_true(fabs((double)books->stored_paths - 50000 * rho) < 4 * sqrt(50000 * rho));
        assert_int_equal(books->stored, photon_map_count(lit.maps.global));
        lit_done(&lit);
    }
    LitScene lit; /* a lone floor has direct light only */
    lit_make(&lit,
             "global_settings { assumed_gamma 1 pms { gi on gi_method map global_photons 5000 } }\n"
             "light_source { <0,2,0> rgb 1 }\n"
             "box { <-2,-1,-2>, <2,0,2> pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n",
             1, 1);
    assert_null(lit.maps.global);
    lit_done(&lit);
}

/* --- no path twice, none lost ---------------------------------------------------------------- */

/* The lamp fades by the inverse square, so that its flux is the same however long the way:
 * 4 pi 2 c f^2 with c = 5000, f = 1/100, but for f^2/d^2. */
#define LAMP_AT "light_source { <0.2,0.5,-0.3> rgb 5000 fade_distance 0.01 fade_power 2 }\n"

typedef struct Ball {
    V3 center;
    double radius;
    double absorbs, sends_on; /* parts of the light that falls on it: swallowed; mirrored or let
                                 through; the rest is reflected diffusely */
    const char *look;
} Ball;

typedef struct Flux {
    double sum[3], square[3];
} Flux;

/* Add what photons bring to the ball (to the room). */
static void add_photons(const PhotonMap *map, const Ball *ball, bool is_room, Flux *flux)
{
    for (size_t i = 0; map && i < photon_map_count(map); i++) {
        V3 p = lit_photon_place(map, i);
        Rgb power = lit_photon_power(map, i);
        double channel[3] = {(double)power.r, (double)power.g, (double)power.b};
        bool is_on_ball = fabs(v3_dist(p, ball->center) / ball->radius - 1) < 1e-4;
        for (int c = 0; c < 3 && is_on_ball != is_room; c++) {
            flux->sum[c] += channel[c];
            flux->square[c] += channel[c] * channel[c];
        }
    }
}

/* The part of all directions of the lamp whose light reaches the room by shadow rays. */
static double lit_directions(LitScene *lit, int rays)
{
    TraceThread thread;
    assert_int_equal(trace_thread_init(&thread, lit->tracer, &lit->diag), OK);
    V3 lamp = lit->scene->lights[0].location;
    double sum = 0;
    for (int i = 0; i < rays; i++) {
        V3 d = warp_sphere(sample_2d((uint32_t)i, 77));
        double b = v3_dot(lamp, d), t = -b + sqrt(b * b - v3_len2(lamp) + 4); /* the room */
        V3 p = v3_mad(lamp, t, d), n = v3_scale(p, -0.5);
        ShapePoint wall = {.p = p, .p_error = 1e-9, .ng = n, .ns = n};
        sum += (double)trace_shadow(&thread, &wall, v3_neg(d), t, 0, true).g / rays;
    }
    trace_thread_done(&thread);
    return sum;
}

static double part_of_directions(V3 lamp, const Ball *ball)
{
    double sine = ball->radius / v3_dist(lamp, ball->center);
    return (1 - sqrt(1 - sine * sine)) / 2;
}

static const double rho[3] = {0.6, 0.4, 0.2}; /* of the room */

static void make_room(LitScene *lit, const Ball *ball)
{
    char text[1024];
    snprintf(
        text, sizeof text,
        "global_settings { assumed_gamma 1 max_trace_level 300 adc_bailout 1e-5\n"
        "  photons { count 200000 } pms { gi on gi_method map global_photons 200000 } }\n" LAMP_AT
        "sphere { 0, 2 hollow pigment { rgb <%g,%g,%g> } finish { ambient 0 diffuse 1 } }\n"
        "sphere { <%g,%g,%g>, %g %s }\n",
        rho[0], rho[1], rho[2], ball->center.x, ball->center.y, ball->center.z, ball->radius,
        ball->look);
    lit_make(lit, text, 2, 3);
    assert_non_null(lit->maps.caustic);
}

/* Check that what arrives is what the lamp, whose flux is 4 pi, gives off.  `met`: the part of it
 * that meets the ball first. */
static void check_balance(LitScene *lit, const Ball *ball, double met)
{
    const double all = 4 * PMS_PI, direct = lit_directions(lit, 65536);
    assert_true(fabs(direct - (1 - met)) < 0.002);
    Flux caustic = {0}, wall = {0}, own = {0};
    add_photons(lit->maps.caustic, ball, true, &caustic);
    add_photons(lit->maps.caustic, ball, true, &wall);
    add_photons(lit->maps.global, ball, true, &wall);
    add_photons(lit->maps.caustic, ball, false, &own);
    add_photons(lit->maps.global, ball, false, &own);
    double sent_on = met * ball->sends_on;
    for (int c = 0; c < 3; c++) {
        double error = sqrt(caustic.square[c]);
        assert_true(fabs(caustic.sum[c] - all * sent_on) < 4 * error + 2e-3 * all);
        double absorbed =
            (1 - rho[c]) * (all * direct + wall.sum[c]) + ball->absorbs * (all * met + own.sum[c]);
        /* A path leaves several photons, which are not independent: with reflectance r the
         * variance is at most (1+r)/(1-r) times the sum of their squares. */
        error = sqrt((wall.square[c] + own.square[c]) * (1 + rho[0]) / (1 - rho[0])) * (1 - rho[c]);
        print_message("# channel %d: caustic %.4f of %.4f, absorbed %.4f (+- %.4f)\n", c,
                      caustic.sum[c] / all, sent_on, absorbed / all, 4 * error / all);
        assert_true(fabs(absorbed - all) < 4 * error + 2e-3 * all);
    }
}

#define TARGET " photons { target reflection on refraction on } "
#define CLEAR "pigment { rgbt 1 } finish { diffuse 0 "

/* Row S14: a lamp, a ball of glass or mirror that is a target, a room of reflectance rho.  All
 * of the lamp's light arrives once, as direct light or as caustic; and what the room and the
 * ball absorb of direct light, caustics and indirect light is what the lamp gives off. */
static void all_light_arrives_once(void **state)
{
    (void)state;
    static const Ball balls[] = {
        {{-0.5, -0.3, 0.4}, 0.9, 0, 1, "pigment { rgb 0 } finish { reflection 1 }" TARGET},
        {{-0.5, -0.3, 0.4},
         0.9,
         0,
         1,
         CLEAR "reflection { 0, 1 fresnel } conserve_energy } interior { ior 1.5 }" TARGET},
        {{-0.5, -0.3, 0.4}, 0.9, 0, 1, CLEAR "} interior { ior 1 }" TARGET},
        {{-0.5, -0.3, 0.4},
         0.9,
         0.2,
         0.5,
         "pigment { rgb 1 } finish { diffuse 0.3 reflection 0.5 }" TARGET},
        {{0.2, 0.5, 0}, 0.5, 0, 1, CLEAR "} interior { ior 1.5 }" TARGET}, /* around the lamp */
    };
    for (size_t i = 0; i < sizeof balls / sizeof balls[0]; i++) {
        LitScene lit;
        make_room(&lit, &balls[i]);
        V3 lamp = lit.scene->lights[0].location;
        bool is_inside = v3_dist(lamp, balls[i].center) < balls[i].radius;
        print_message("# ball %zu\n", i);
        check_balance(&lit, &balls[i], is_inside ? 1 : part_of_directions(lamp, &balls[i]));
        lit_done(&lit);
    }
}

/* Mean light of a screen behind a clear pane, as the eye sees it, in parts. */
static void look_behind_pane(const char *light_flags, const char *pane_flags,
                             const char *screen_flags, double part[PART_COUNT])
{
    char text[1024];
    snprintf(text, sizeof text,
             "global_settings { assumed_gamma 1 photons { count 20000 } }\n"
             "camera { orthographic location <0,0,-0.5> direction z right x up y }\n"
             "light_source { <0,0,-3> rgb 1 parallel point_at 0 photons { %s } }\n"
             "box { <-2,-2,-1.1>, <2,2,-1> pigment { rgbt 1 } finish { ambient 0 diffuse 0 }\n"
             "  interior { ior 1 } photons { %s } }\n"
             "box { <-9,-9,0>, <9,9,1> pigment { rgb 1 } finish { ambient 0 diffuse 1 }\n"
             "  photons { %s } }\n"
             /* something else that makes a caustic and keeps it: there is a map in any case */
             "box { <4,4,-0.2>, <6,6,-0.1> pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
             "sphere { <5,5,-1>, 0.2 pigment { rgbt 1 } finish { reflection 1 }\n"
             "  interior { ior 1.5 } photons { target refraction on reflection on } }\n",
             light_flags, pane_flags, screen_flags);
    LitScene lit;
    LitEye eye;
    lit_make(&lit, text, 2, 1);
    assert_non_null(lit.maps.caustic);
    lit_eye_open(&eye, &lit, lit_within(0.3));
    memset(part, 0, PART_COUNT * sizeof *part);
    for (int i = 0; i < 64; i++) {
        EyeSample seen = lit_look(&eye, (i % 8 + 0.5) / 8, (i / 8 + 0.5) / 8);
        for (int k = 0; k < PART_COUNT; k++)
            part[k] += (double)seen.part[k].g / 64;
    }
    lit_eye_close(&eye);
    lit_done(&lit);
}

/* Row S14: whatever the flags of light, object and receiver say, what comes through a clear pane
 * comes as direct light or from the caustic map, and never both or neither. */
static void flags_never_count_twice(void **state)
{
    (void)state;
    const char *const lights[] = {"", "refraction on", "refraction off", "reflection on",
                                  "refraction on reflection off"};
    const char *const panes[] = {"",
                                 "target",
                                 "target refraction on",
                                 "target refraction off",
                                 "target reflection on",
                                 "target refraction on reflection on",
                                 "target reflection on refraction off",
                                 "target refraction on collect off",
                                 "refraction on",
                                 "pass_through"};
    const char *const screens[] = {"", "collect off"};
    int as_caustic = 0, as_direct = 0;
    for (size_t l = 0; l < sizeof lights / sizeof *lights; l++)
        for (size_t p = 0; p < sizeof panes / sizeof *panes; p++)
            for (size_t s = 0; s < 2; s++) {
                double part[PART_COUNT];
                look_behind_pane(lights[l], panes[p], screens[s], part);
                as_caustic += part[PART_CAUSTIC] > 0.5;
                as_direct += part[PART_DIRECT] > 0.5;
                /* 64 disks of 0.28 hold over 1000 photons; they overlap in a square of 1.6 */
                if (fabs(part[PART_DIRECT] + part[PART_CAUSTIC] - 1) > 0.04)
                    fail_msg("light { %s } pane { %s } screen { %s }: direct %.3f caustic %.3f",
                             lights[l], panes[p], screens[s], part[PART_DIRECT],
                             part[PART_CAUSTIC]);
            }
    print_message("# %d ways as caustic, %d as direct light\n", as_caustic, as_direct);
    assert_true(as_caustic > 10 && as_direct > 50 && as_caustic + as_direct == 100);
}

/* Row S14: the eye adds the three parts: in a closed ball of reflectance 1/2 around a lamp it sees
 * direct 1/2 and indirect 1/2 everywhere; with a clear target around the lamp the direct part comes
 * as caustic.  Row S1: looking changes nothing in the maps. */
static void the_eye_adds_three_parts(void **state)
{
    (void)state;
    for (int is_target = 0; is_target < 2; is_target++) {
        char text[1024];
        snprintf(text, sizeof text,
                 "#version 3.7;\n"
                 "global_settings { assumed_gamma 1 max_trace_level 200 photons { count 200000 }\n"
                 "  pms { gi on gi_method map global_photons 200000 } }\n"
                 "camera { location <0.6,0,0> direction z right 4*x up 4*y }\n"
                 "light_source { <0,0,0> rgb 1 }\n"
                 "sphere { 0, 1 hollow pigment { rgb 1 } finish { ambient 0 diffuse 0.5 } }\n"
                 "sphere { 0, 0.5 pigment { rgbt 1 } finish { ambient 0 diffuse 0 }\n"
                 "  interior { ior 1 } photons { %s } }\n",
                 is_target ? "target refraction on collect off" : "refraction off");
        LitScene lit;
        LitEye eye;
        lit_make(&lit, text, 2, 3);
        uint64_t before = photon_map_hash(lit.maps.global);
        uint64_t caustic_before = is_target ? photon_map_hash(lit.maps.caustic) : 0;
        lit_eye_open(&eye, &lit, lit_within(0.2));
        double part[PART_COUNT] = {0};
        for (int i = 0; i < 256; i++) {
            EyeSample seen = lit_look(&eye, (i % 16 + 0.5) / 16, (i / 16 + 0.5) / 16);
            for (int k = 0; k < PART_COUNT; k++)
                part[k] += (double)seen.part[k].g / 256;
        }
        lit_eye_close(&eye);
        assert_true(photon_map_hash(lit.maps.global) == before);
        assert_true(!is_target || photon_map_hash(lit.maps.caustic) == caustic_before);
        print_message("# direct %.4f caustic %.4f indirect %.4f\n", part[PART_DIRECT],
                      part[PART_CAUSTIC], part[PART_INDIRECT]);
        /* About 25 separate disks of 2000 photons; of the indirect ones two come on a path. */
        assert_true(fabs(part[PART_DIRECT] - (is_target ? 0 : 0.5)) < 1e-6);
        assert_true(fabs(part[PART_CAUSTIC] - (is_target ? 0.5 : 0)) < 4 * 0.5 / sqrt(50000));
        assert_true(fabs(part[PART_INDIRECT] - 0.5) < 4 * 0.5 * sqrt(3) / sqrt(50000));
        lit_done(&lit);
    }
}

/* A lamp in a ball of paper, which reflects a and lets b through diffusely, in a white ball twice
 * as wide: each side of the paper, and the ball, is evenly lit.  A quarter of what the ball sends
 * falls on the paper, the rest on itself. */
static void paper_glows_on_both_sides(void **state)
{
    (void)state;
    const double a = 0.3, b = 0.5, r = 0.5;
    /* What comes back to the outside of the paper of what it sends there; what that sends, and
     * what comes back to it, of light on the inside; and that light. */
    const double returned = r / (4 - 3 * r);
    const double outer = b / (1 - a * returned), back = outer * returned;
    const double inside = 1 / (1 - a - b * back);
    const struct {
        const char *camera;
        double direct, all;
    } views[] = {
        {"location <0.5,0.1,0> look_at <1,0.2,0.1>", a, inside - 1},
        {"location <1.5,0,0> look_at 0", b, inside * outer},
        {"location <1.5,0,0> look_at <2,0,0>", 0, inside * back},
    };
    for (int i = 0; i < 3; i++) {
        char text[1024];
        snprintf(text, sizeof text,
                 "#version 3.7;\n"
                 "global_settings { assumed_gamma 1 max_trace_level 200\n"
                 "  pms { gi on gi_method map global_photons 400000 } }\n"
                 "camera { %s right x up y angle 30 }\n"
                 "light_source { <0,0,0> rgb 1 }\n"
                 "sphere { 0, 1 hollow pigment { rgb 1 } finish { ambient 0 diffuse %g, %g } }\n"
                 "sphere { 0, 2 hollow pigment { rgb 1 } finish { ambient 0 diffuse %g } }\n",
                 views[i].camera, a, b, r);
        LitScene lit;
        LitEye eye;
        lit_make(&lit, text, 2, 3);
        lit_eye_open(&eye, &lit, lit_within(0.3));
        double direct = 0, indirect = 0;
        for (int k = 0; k < 64; k++) {
            EyeSample seen = lit_look(&eye, (k % 8 + 0.5) / 8, (k / 8 + 0.5) / 8);
            direct += (double)seen.part[PART_DIRECT].g / 64;
            indirect += (double)seen.part[PART_INDIRECT].g / 64;
        }
        lit_eye_close(&eye);
        lit_done(&lit);
        double expected = views[i].all - views[i].direct;
        print_message("# direct %.4f of %.4f, indirect %.4f of %.4f\n", direct, views[i].direct,
                      indirect, expected);
        assert_true(fabs(direct - views[i].direct) < 1e-5);
        /* Each disk of 0.3 has some thousand photons of either side. */
        assert_true(fabs(indirect / expected - 1) < 0.03);
    }
}

/* A ball of paper that glows on both sides, with an emission of e, in that white ball.  What its
 * inside sends stays there but for what shows outside; both faces send photons, each once. */
static void glowing_paper_lights_through_itself(void **state)
{
    (void)state;
    const double a = 0.3, b = 0.5, e = 0.4, r = 0.5, returned = r / (4 - 3 * r);
    const double outside = e * (1 + b / (1 - a)) / (1 - a * returned - b * b * returned / (1 - a));
    char text[1024];
    snprintf(text, sizeof text,
             "#version 3.7;\n"
             "global_settings { assumed_gamma 1 max_trace_level 200\n"
             "  pms { gi on gi_method map global_photons 400000 } }\n"
             "camera { location <1.5,0,0> look_at 0 right x up y angle 30 }\n"
             "sphere { 0, 1 pigment { rgb 1 }\n"
             "  finish { ambient 0 diffuse %g, %g emission %g } }\n"
             "sphere { 0, 2 hollow pigment { rgb 1 } finish { ambient 0 diffuse %g } }\n",
             a, b, e, r);
    LitScene lit;
    LitEye eye;
    lit_make(&lit, text, 2, 3);
    const LightBooks *books = &lit.maps.books.global[0];
    double sent = (double)books->flux_emitted.g, faces = 2 * 4 * PMS_PI * e;
    print_message("# sent %.4f of %.4f, balance %.5f +- %.5f\n", sent, faces,
                  (double)books->balance.g, (double)books->balance_error.g);
    assert_true(fabs(sent / faces - 1) < 0.01);
    assert_true(fabs((double)books->balance.g - 1) < 4 * (double)books->balance_error.g + 1e-5);
    assert_true(books->emitted ==
                books->stored_paths + books->absorbed + books->escaped + books->cut);
    lit_eye_open(&eye, &lit, lit_within(0.3));
    double indirect = 0;
    for (int k = 0; k < 64; k++) {
        EyeSample seen = lit_look(&eye, (k % 8 + 0.5) / 8, (k / 8 + 0.5) / 8);
        assert_true(fabs((double)seen.part[PART_DIRECT].g - e) < 1e-5);
        indirect += (double)seen.part[PART_INDIRECT].g / 64;
    }
    lit_eye_close(&eye);
    lit_done(&lit);
    print_message("# indirect %.4f of %.4f\n", indirect, outside - e);
    /* Each disk of 0.3 has some thousand photons of either side. */
    assert_true(fabs(indirect / (outside - e) - 1) < 0.03);
}

/* --- thin solids ----------------------------------------------------------------------------- */

/* Row S12: inside a slab that lets light through diffusely, and is far thinner than an estimate is
 * wide, lie as many photons as outside, with the same normals; in a furnace twice as many as there
 * should be would show by any method. */
static void thin_solids_keep_their_sides_apart(void **state)
{
    (void)state;
    const char *text =
        "#version 3.7;\n"
        "global_settings { assumed_gamma 1 max_trace_level 100 adc_bailout 1e-5\n"
        "  pms { global_photons 50000 } radiosity { count 60 } }\n"
        "#default { pigment { rgb 1 } finish { ambient 0 diffuse 0.5 emission 0.5 } }\n"
        "camera { location <0,0,-0.9> look_at z angle 60 right x up y }\n"
        "box { -1, 1 hollow }\n"
        "box { <-0.8,-0.8,0.1>, <0.8,0.8,0.1001>\n"
        "  finish { diffuse 0.5, 0.5 emission 0 } }\n";
    static const int ways[] = {BY_CACHE, BY_MAP, BY_PASSES};
    bool is_good = true;
    for (int i = 0; i < 3; i++) {
        Method method = methods[ways[i]];
        method.seeds = 2;
        method.samples = 1;
        method.passes = method.passes > 0 ? 8 : 0;
        is_good &= method_expect("thin slab that lets light through", text, &method, 1, 0.03);
    }
    assert_true(is_good);
}

/* --- shadows of targets ---------------------------------------------------------------------- */

/* A prism throws all its photons past a small disk in its shadow.  That they were sent decides, not
 * that they came: the disk is dark if it takes photons and the prism refracts them, else it sees
 * the lamp through the glass. */
static void shadows_of_targets_are_dark_without_a_photon(void **state)
{
    (void)state;
#define SENT "photons { count 2000 }"
    static const struct {
        const char *settings, *light, *prism, *disk;
        bool has_caustics;
        double expected;
    } cases[] = {
        {SENT, "", "photons { target refraction on }", "", true, 0},
        {SENT, "", "photons { target refraction on pass_through }", "", true, 0},
        {SENT, "", "photons { target refraction on }", "photons { collect off }", true, 1},
        {SENT, "photons { refraction off }", "photons { target refraction on }", "", false, 1},
        {SENT, "", "photons { target refraction off }", "", false, 1},
        {"", "", "photons { target refraction on }", "", false, 1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[1024];
        snprintf(text, sizeof text,
                 "#version 3.7; global_settings { assumed_gamma 1 %s }\n"
                 "camera { location <0,1.5,-4> look_at 0 angle 1 right x up y }\n"
                 "light_source { <0,20,0> rgb 1 %s }\n"
                 "intersection { plane { y, 2.3 rotate z*20 } plane { -y, -2 }\n"
                 "  box { <-.5,0,-.5>, <.5,4,.5> } pigment { rgbt 1 }\n"
                 "  finish { ambient 0 diffuse 0 } interior { ior 1.9 } %s }\n"
                 "disc { 0, y, 0.15 pigment { rgb 1 } finish { ambient 0 diffuse 1 } %s }\n",
                 cases[i].settings, cases[i].light, cases[i].prism, cases[i].disk);
        LitScene lit;
        LitEye eye;
        lit_make(&lit, text, 1, 1);
        assert_null(lit.maps.caustic);
        assert_true((lit.maps.books.caustic != NULL) == cases[i].has_caustics);
        lit_eye_open(&eye, &lit, lit_within(0.1));
        EyeSample seen = lit_look(&eye, 0.5, 0.5);
        lit_eye_close(&eye);
        lit_done(&lit);
        if (!(fabs((double)seen.part[PART_DIRECT].g - cases[i].expected) < 1e-3))
            fail_msg("case %zu: direct light %g, not %g", i, (double)seen.part[PART_DIRECT].g,
                     cases[i].expected);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(maps_are_made_when_called_for),
        cmocka_unit_test(caustic_map_holds_specular_paths_only),
        cmocka_unit_test(global_map_holds_all_hits_but_the_first),
        cmocka_unit_test(all_light_arrives_once),
        cmocka_unit_test(flags_never_count_twice),
        cmocka_unit_test(the_eye_adds_three_parts),
        cmocka_unit_test(paper_glows_on_both_sides),
        cmocka_unit_test(glowing_paper_lights_through_itself),
        cmocka_unit_test(thin_solids_keep_their_sides_apart),
        cmocka_unit_test(shadows_of_targets_are_dark_without_a_photon),
    };
    return cmocka_run_group_tests_name("light_paths", tests, NULL, NULL);
}
