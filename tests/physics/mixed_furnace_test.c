/* Furnaces of many kinds of surfaces: where every surface gives off what it does not send on, or
 * loses nothing under an even sky, radiance is 1 everywhere, by whatever way light is found.
 * SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "lit_methods.h"

#define HEAD                                                                                       \
    "#version 3.7;\n"                                                                              \
    "global_settings { assumed_gamma 1 max_trace_level 100 adc_bailout 1e-5\n"                     \
    "  pms { global_photons 200000 } }\n"                                                          \
    "#default { pigment { rgb 1 } finish { ambient 0 diffuse 0.5 emission 0.5 } }\n"               \
    "camera { location <0,0.1,-0.9> look_at <0,0,1> angle 80 right x up y }\n"

#define GLASS                                                                                      \
    "pigment { rgbt 1 } finish { diffuse 0 emission 0 reflection { 0, 1 fresnel }\n"               \
    "  conserve_energy } interior { ior 1.5 }"
#define HALF_MIRROR "finish { diffuse 0.25 emission 0.25 reflection 0.5 }"

typedef struct Furnace {
    const char *name, *text;
} Furnace;

/* Estimates from the map at an edge see half a disk: the map alone is too dark there. */
#define EDGES_PART 0.02

/* The last one has everything; the long run has time for the others. */
static void expect_one(const Furnace *furnaces, int count)
{
    bool is_good = true;
    for (int i = table_is_long() ? 0 : count - 1; i < count; i++)
        for (int k = 0; k < METHOD_COUNT; k++)
            is_good &= method_expect(furnaces[i].name, furnaces[i].text, &methods[k], 1,
                                     k == BY_MAP ? EDGES_PART : 0.0025);
    assert_true(is_good);
}

static void rooms(void **state)
{
    (void)state;
    static const Furnace furnaces[] = {
        {"matt room",
         HEAD "box { -1, 1 hollow }\n"
              "box { <-0.6,-0.9,0>, <0,0.3,0.5> finish { diffuse 0.2 emission 0.8 } }\n"
              "sphere { <0.4,-0.3,0.3>, 0.3 finish { diffuse 0.8 emission 0.2 } }\n"},
        {"half mirrors", HEAD "box { -1, 1 hollow }\n"
                              "box { <-0.6,-0.9,0>, <0,0.3,0.5> " HALF_MIRROR " }\n"
                              "sphere { <0.4,-0.3,0.3>, 0.3 finish { diffuse 0 emission 0.2\n"
                              "  reflection 0.8 } }\n"},
        {"glass", HEAD "box { -1, 1 hollow }\n"
                       "sphere { <0.4,-0.3,0.3>, 0.3 " GLASS " }\n"
                       "box { <-0.6,-0.9,0>, <0,0.3,0.5> " GLASS " }\n"},
        {"all of them", HEAD "box { -1, 1 hollow finish { diffuse 0.4 emission 0.4\n"
                             "  reflection 0.2 } }\n"
                             "box { <-0.6,-0.9,0>, <-0.1,0.3,0.5> " HALF_MIRROR " }\n"
                             "sphere { <0.4,-0.3,0.3>, 0.3 " GLASS " }\n"
                             "box { <0,-0.95,-0.2>, <0.3,-0.7,0.1>\n"
                             "  finish { diffuse 0.9 emission 0.1 } }\n"},
    };
    expect_one(furnaces, sizeof furnaces / sizeof *furnaces);
}

#define SKY                                                                                        \
    "#version 3.7;\n"                                                                              \
    "global_settings { assumed_gamma 1 max_trace_level 100 adc_bailout 1e-5\n"                     \
    "  pms { global_photons 200000 } }\n"                                                          \
    "#default { pigment { rgb 1 } finish { ambient 0 diffuse 1 emission 0 } }\n"                   \
    "background { rgb 1 }\n"                                                                       \
    "camera { location <0,0.6,-2.5> look_at 0 angle 50 right x up y }\n"

static void under_a_sky(void **state)
{
    (void)state;
    static const Furnace furnaces[] = {
        {"white balls", SKY "sphere { <-0.6,0,0>, 0.5 } sphere { <0.5,0,0.2>, 0.6 }\n"},
        {"half mirrors under a sky", SKY "sphere { <-0.6,0,0>, 0.5 finish { diffuse 0.5\n"
                                         "  reflection 0.5 } }\n"
                                         "box { <-2,-0.7,-2>, <2,-0.6,2> }\n"
                                         "sphere { <0.5,0,0.2>, 0.6 finish { diffuse 0\n"
                                         "  reflection 1 } }\n"},
        {"glass under a sky", SKY "box { <-2,-0.7,-2>, <2,-0.6,2> }\n"
                                  "sphere { <0.5,0,0.2>, 0.6 pigment { rgbt 1 }\n"
                                  "  finish { diffuse 0 reflection { 0, 1 fresnel }\n"
                                  "  conserve_energy } interior { ior 1.5 } }\n"},
    };
    expect_one(furnaces, sizeof furnaces / sizeof *furnaces);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rooms),
        cmocka_unit_test(under_a_sky),
    };
    return cmocka_run_group_tests_name("mixed_furnace", tests, NULL, NULL);
}
