/* Solids that are not hollow keep media and fog out, of what the eye sees, of shadows and of the
 * way of photons alike.  povray's shadow rays do so too, but for a medium all of which lies in
 * such a solid, and for the atmosphere.  SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "lit_eye.h"

#define HEAD "#version 3.7;\nglobal_settings { assumed_gamma 1 max_trace_level 20\n"
#define CLEAR " pigment { rgbt 1 } finish { ambient 0 diffuse 0 } "
#define MEDIUM "box { <-9,-9,1>, <9,9,3> hollow" CLEAR "interior { media { absorption 1 } } }\n"

typedef struct Case {
    const char *objects;
    double depth;
} Case;

static const Case cases[] = {
    {MEDIUM, 2},
    {MEDIUM "box { <-8,-8,1.5>, <8,8,2.5>" CLEAR "}\n", 1},
    {MEDIUM "box { <-8,-8,1.5>, <8,8,2.5>" CLEAR "interior { media { absorption 1 } } }\n", 1},
    {MEDIUM "box { <-8,-8,1.5>, <8,8,2.5> hollow" CLEAR "}\n", 2},
    {MEDIUM "box { <-8,-8,1.5>, <8,8,2.5> hollow" CLEAR "interior { media { absorption 1 } } }\n",
     3},
    {MEDIUM "box { <-8,-8,2>, <8,8,4>" CLEAR "}\n", 1},
    {MEDIUM "box { <-8,-8,0.5>, <8,8,4>" CLEAR "}\n", 0},
    {MEDIUM "box { <-8,-8,1.5>, <8,8,2.5>" CLEAR "}\n"
            "box { <-7,-7,1.7>, <7,7,2.3> hollow" CLEAR "interior { media { absorption 1 } } }\n",
     1},
    {MEDIUM "box { <-8,-8,1.2>, <8,8,1.4>" CLEAR "} box { <-8,-8,1.3>, <8,8,1.6>" CLEAR "}\n"
            "box { <-8,-8,2>, <8,8,2.25>" CLEAR "}\n",
     1.35},
    {MEDIUM "merge { box { <-8,-8,1.5>, <8,8,2> } box { <-8,-8,1.8>, <8,8,2.5> }" CLEAR "}\n", 1},
};

static double look(LitScene *lit, const char *text, LightPart part)
{
    LitEye eye;
    lit_make(lit, text, 2, 1);
    lit_eye_open(&eye, lit, lit_within(0.5));
    double got = (double)lit_look(&eye, 0.5, 0.5).part[part].g;
    lit_eye_close(&eye);
    lit_done(lit);
    return got;
}

static void eye_shadows_and_photons_agree(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[2048];
        LitScene lit;
        double expected = exp(-cases[i].depth);
        snprintf(text, sizeof text,
                 HEAD
                 "}\ncamera { orthographic location <0,0,-1> direction z right x*.1 up y*.1 }\n"
                 "plane { -z, -9 pigment { rgb 1 } finish { ambient 0 diffuse 0 emission 1 } }\n"
                 "%s",
                 cases[i].objects);
        double seen = look(&lit, text, PART_DIRECT);
        const char *lit_floor =
            HEAD "photons { count 40000 } }\n"
                 "camera { orthographic location <0,0,0.1> direction -z right x*.1 up y*.1 }\n"
                 "light_source { <0,0,9> 1 parallel point_at 0 photons { refraction on } }\n"
                 "disc { 0, z, 5 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
                 "box { <-3,-3,5>, <3,3,5.1> hollow" CLEAR "photons { %s } }\n%s";
        snprintf(text, sizeof text, lit_floor, "refraction off", cases[i].objects);
        double shadowed = look(&lit, text, PART_DIRECT);
        snprintf(text, sizeof text, lit_floor, "target refraction on collect off",
                 cases[i].objects);
        double brought = look(&lit, text, PART_CAUSTIC);
        print_message("# case %zu: %.4f seen, %.4f by shadow rays, %.4f by photons; %.4f\n", i,
                      seen, shadowed, brought, expected);
        assert_true(fabs(seen / expected - 1) < 1e-5);
        assert_true(fabs(shadowed / expected - 1) < 1e-5);
        assert_true(fabs(brought / expected - 1) < 0.02); /* of some 900 photons */
    }
}

/* Where lamps dim, and all of space is in a solid. */
static void air_is_kept_out_too(void **state)
{
    (void)state;
    static const Case airs[] = {
        {"media { absorption 0.5 }\n", 1.995},
        {"media { absorption 0.5 } box { <-8,-8,1.5>, <8,8,2.5>" CLEAR "}\n", 1.495},
        {"media { absorption 0.5 } box { <-8,-8,1.5>, <8,8,5>" CLEAR "}\n", 0.75},
        {"media { absorption 0.5 } plane { z, 200 }\n", 0},
        {"media { absorption 0.5 } box { <-8,-8,-1>, <8,8,8> pigment { rgb 1 } }\n", 0},
        {"fog { distance 2 rgb 0 }\n", 1.995},
        {"fog { distance 2 rgb 0 } box { <-8,-8,1.5>, <8,8,2.5>" CLEAR "}\n", 1.495},
        {"fog { distance 2 rgb 0 } plane { z, 200 }\n", 0},
    };
    for (size_t i = 0; i < sizeof airs / sizeof *airs; i++) {
        char text[2048];
        LitScene lit;
        snprintf(text, sizeof text,
                 HEAD "}\n"
                      "camera { orthographic location <0,0,1e-9> direction -z right x up y }\n"
                      "light_source { <0,0,3.99> 1 media_attenuation on }\n"
                      "disc { 0, z, 5 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n%s",
                 airs[i].objects);
        double got = look(&lit, text, PART_DIRECT), expected = exp(-airs[i].depth);
        print_message("# air %zu: %.5f, expected %.5f\n", i, got, expected);
        assert_true(fabs(got / expected - 1) < 1e-5);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(eye_shadows_and_photons_agree),
        cmocka_unit_test(air_is_kept_out_too),
    };
    return cmocka_run_group_tests_name("hollow", tests, NULL, NULL);
}
