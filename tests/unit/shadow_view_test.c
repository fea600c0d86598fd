/* What is known of a lamp's shadows: shadow rays find the same.
 * SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "../physics/lit_scene.h"

#include "base/rng.h"

#define HEAD                                                                                       \
    "#version 3.7;\nglobal_settings { assumed_gamma 1 }\n"                                         \
    "media { scattering { 1, 0.01 } }\ncamera { location <0,1,-9> look_at 0 }\n"

static const char *const lamps[] = {
    "light_source { <0.1,3.2,0.3> 1 }",
    "light_source { <-4,3,2> 1 spotlight point_at <0,0,0> radius 15 falloff 25 }",
    "light_source { <-4,3,2> 1 spotlight point_at <0,0,0> radius 15 falloff 80 }",
    "light_source { <-4,6,2> 1 parallel point_at <0,0,0> }",
    "light_source { <-4,4,2> 1 cylinder point_at <0,0,0> radius 1.5 falloff 2 }",
    /* within things and on their edges */
    "light_source { <2,0,0> 1 }",
    "light_source { <-1,0.5,0> 1 }",
    "light_source { 0 1 }",
};

static const char *const things[] = {
    "sphere { <2,0,0>, 1 } box { <-1,-1,-1>, <0,0.5,1> rotate 20*y }",
    "cylinder { <-2,-1,0>, <1,2,0.5>, 0.1 } cylinder { <-2,-1,0.4>, <1,2,1>, 0.05 }\n"
    "cone { <2,-1,0>, 0.6, <2,1.5,0.2>, 0 } cone { <-2,0,1>, 0.5, <-2,2,1>, 0.2 open }",
    "plane { y, -1.5 } plane { x, -6 inverse } torus { 1, 0.3 rotate 50*x }",
    "union { sphere { <1,0,0>, 0.5 } box { <-1,-1,-1>, <0,0,0> rotate 30*z } }\n"
    "difference { box { <1,-1,1>, <3,1,2> } cylinder { <2,0,0>, <2,0,3>, 0.6 } }\n"
    "intersection { sphere { <-2,0,0>, 1 } box { <-3,-1,-0.2>, <-1,1,0.2> } }",
    "sphere { 0, 1 scale <3,0.2,1> rotate <20,30,40> } box { -1, 1 scale <0.05,2,0.3> rotate 33 }\n"
    "triangle { <-3,0,-1>, <-1,2,0>, <-2,-1,2> } disc { <1,1,0>, <1,2,3>, 1, 0.3 }\n"
    "mesh { triangle { <3,0,0>, <3,2,0>, <2,0,1> } triangle { <3,0,0>, <2,0,1>, <4,0,2> } }",
    "sphere { <1,0,0>, 1 pigment { rgbf <1,0.5,0.5,0.7> } } sphere { <1,-1,0>, 0.4 }\n"
    "box { -5, 5 hollow } box { <-2,-1,-1>, <-1,0,1> no_shadow }\n"
    "sphere { <-2,1,0>, 0.7 clipped_by { plane { y, 1 } } }",
    /* what is clipped away casts no shadow; thin things along the edges of cells; endless insides
     */
    "plane { z, 3 clipped_by { box { <-3,-3,2>, <3,3,4> } } }\n"
    "plane { y, -2 clipped_by { box { -3, <3,3,4> } } } plane { x, -5 }",
    "cylinder { <-3,0,0>, <2,0,0>, 0.01 } cylinder { <0.1,-3,0.3>, <0.1,2,0.3>, 0.001 }",
    "intersection { box { <-2,-1,-2>, <2,0,2> } union { cylinder { -2*y, 2*y, 0.3 }\n"
    "  sphere { 0, 1.5 inverse } } }\n"
    "intersection { box { <2,0,0>, 3 } union { disc { 2.5, y, 1 } cone { 3, 0.1, 4, 0 } } }",
    "sphere { -1e6 * y, 1e6 } sphere { <1,0,0>, 1 rotate <20,30,40> } cone { <2,0,0>, 0, <4,1,0>, "
    "0.5 }",
    "plane { -z, -1 }",
    "plane { y, -1 } plane { y, -1.3 } sphere { <0,-0.9,0>, 0.1 } sphere { <0.21,-0.9,0>, 0.1 }",
};

static V3 somewhere(Rng *rng, double size)
{
    double x = rng_double(rng), y = rng_double(rng), z = rng_double(rng);
    return v3((2 * x - 1) * size, (2 * y - 1) * size, (2 * z - 1) * size);
}

/* What the shadow ray from a point finds; -1: not worth a look. */
static int shadow_at(TraceThread *thread, const Light *light, V3 p)
{
    LightSample sample = light_at(light, light->location, p);
    if (!(sample.distance > 1e-6))
        return -1;
    ShapePoint from = {.p = p, .ng = sample.to_light, .ns = sample.to_light};
    Rgb passed = trace_shadow(thread, &from, sample.to_light, sample.distance, 0, false);
    return rgb_is_black(passed) ? 0 : passed.r == 1 && passed.g == 1 && passed.b == 1 ? 1 : 2;
}

#define FAR 1e7

typedef struct Tally {
    long count[3], wrong;
    double unsure, all; /* lengths, of rays that do not go far */
} Tally;

/* Compare stretches of a ray with shadow rays. */
static void check_ray(TraceThread *thread, const Light *light, const Ray *ray, double begin,
                      double end, Rng *rng, Tally *tally)
{
    LitStretches known;
    if (!trace_lit_stretches(thread->tracer, 0, ray, begin, end, &known))
        return; /* parallel light on endless things alone */
    assert_true(known.count >= 1 && known.count <= LIT_STRETCHES_MAX);
    assert_true(known.items[0].begin == begin && known.items[known.count - 1].end == end);
    for (int i = 0; i < known.count; i++) {
        const LitStretch *s = &known.items[i];
        assert_true(s->end > s->begin);
        if (i > 0)
            assert_true(s->begin == s[-1].end);
        if (end < FAR) {
            tally->all += s->end - s->begin;
            tally->unsure += s->state == LIT_UNSURE ? s->end - s->begin : 0;
        }
        for (int k = 0; k < 3; k++) {
            double t = s->begin + (s->end - s->begin) * rng_double(rng);
            int found = shadow_at(thread, light, ray_at(ray, t));
            tally->count[s->state]++;
            if (found >= 0 && s->state != LIT_UNSURE && (s->state == LIT_SURE) != (found != 0)) {
                V3 p = ray_at(ray, t);
                if (tally->wrong++ < 3)
                    print_message("at %.9g %.9g %.9g: said %s\n", p.x, p.y, p.z,
                                  s->state == LIT_SURE ? "lit" : "dark");
            }
            if (s->state == LIT_SURE && found == 2)
                tally->wrong++;
        }
    }
}

static Tally check_scene(const char *lamp, const char *objects, int rays)
{
    static LitScene lit;
    char text[4096];
    snprintf(text, sizeof text, HEAD "%s\n%s\n", lamp, objects);
    lit_read(&lit, text, 1, 1);
    TraceThread thread;
    assert_int_equal(trace_thread_init(&thread, lit.tracer, &lit.diag), OK);
    const Light *light = &lit.scene->lights[0];
    Tally tally = {.wrong = 0};
    Rng rng = rng_at(7, 0, 1);
    for (int i = 0; i < rays; i++) {
        V3 from = somewhere(&rng, 4), to = somewhere(&rng, 4);
        if (i % 8 == 0)
            to = light->location;
        if (i % 16 == 1)
            to = v3_mad(from, 3, light->direction);
        if (v3_dist(from, to) < 1e-3)
            continue;
        Ray ray = {from, v3_unit(v3_sub(to, from)), 0, INFINITY};
        check_ray(&thread, light, &ray, 0, i % 5 == 0 ? FAR : v3_dist(from, to) * 1.5, &rng,
                  &tally);
    }
    if (tally.wrong > 0)
        print_message("%ld wrong: %s with %s\n", tally.wrong, lamp, objects);
    trace_thread_done(&thread);
    lit_done(&lit);
    return tally;
}

static void shadow_rays_agree(void **state)
{
    (void)state;
    long wrong = 0, known = 0;
    for (size_t i = 0; i < sizeof lamps / sizeof *lamps; i++)
        for (size_t k = 0; k < sizeof things / sizeof *things; k++) {
            Tally tally = check_scene(lamps[i], things[k], 300);
            wrong += tally.wrong;
            known += tally.count[LIT_SURE] > 0;
        }
    assert_int_equal(wrong, 0);
    assert_true(known > 30);
}

/* Of convex things little stays unsure. */
static void most_is_known(void **state)
{
    (void)state;
    static const char *const objects[] = {
        "box { -8, 8 hollow } sphere { <0,0,0>, 0.5 }",
        "box { -8, 8 hollow } cylinder { <-2,-1,0>, <1,2,0.5>, 0.1 }\n"
        "cylinder { <-2,-1.5,0>, <1,1.5,0.5>, 0.1 } box { <-1,-2,-1>, <0.4,-1,1> rotate 20*y }",
        "plane { y, -3 } plane { x, -6 } union { sphere { 0, 0.4 } cylinder { -y, y, 0.2 } }",
    };
    for (size_t i = 0; i < sizeof objects / sizeof *objects; i++)
        for (int k = 0; k < 5; k++) {
            Tally tally = check_scene(lamps[k], objects[i], 400);
            assert_int_equal(tally.wrong, 0);
            assert_true(tally.count[LIT_NOT] > 0);
            /* Most rays are outside of what these light; parallel rays may begin outside the room.
             */
            if (k == 1 || k == 4 || (k == 3 && i < 2))
                continue;
            if (!(tally.unsure < 0.2 * tally.all))
                print_message("%s %s: %.3f unsure\n", lamps[k], objects[i],
                              tally.unsure / tally.all);
            assert_true(tally.unsure < 0.2 * tally.all);
        }
}

/* Nothing is kept for lights with size, and where no media are. */
static void nothing_is_kept_without_need(void **state)
{
    (void)state;
    static const char *const texts[] = {
        HEAD "light_source { y 1 area_light x, z, 2, 2 } sphere { 0, 0.1 }",
        HEAD "light_source { y 1 shadowless } sphere { 0, 0.1 }",
        HEAD "light_source { y 1 media_interaction off } sphere { 0, 0.1 }",
        "#version 3.7;\nlight_source { y 1 } sphere { 0, 0.1 pigment { rgb 1 } }",
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        static LitScene lit;
        lit_read(&lit, texts[i], 1, 1);
        Ray ray = {v3(0, 0, -3), v3(0, 0, 1), 0, INFINITY};
        LitStretches known;
        assert_false(trace_lit_stretches(lit.tracer, 0, &ray, 0, 5, &known));
        lit_done(&lit);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shadow_rays_agree),
        cmocka_unit_test(most_is_known),
        cmocka_unit_test(nothing_is_kept_without_need),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
