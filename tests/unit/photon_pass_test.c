/* The photon pass: books, budgets, determinism, flags, and scenes in which it can do nothing.
 * SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "../physics/lit_scene.h"

#include "base/mem.h"
#include "base/work.h"

#define FLOOR "plane { y, 0 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
#define GLASS "pigment { rgbt 1 } finish { ambient 0 diffuse 0 } interior { ior 1.5 }\n"
#define MIRROR "pigment { rgb 0 } finish { ambient 0 diffuse 0 reflection 0.9 }\n"
#define SETTINGS(n)                                                                                \
    "global_settings { assumed_gamma 1 max_trace_level 8 photons { count " #n " } }\n"

/* Many lights, mirrors, glass, colour, absorption, indirect light. */
static const char busy_scene[] =
    "global_settings { assumed_gamma 1 max_trace_level 8 photons { count 30000 }\n"
    "  pms { gi on gi_method map global_photons 30000 } }\n"
    "light_source { <3,6,0> rgb <1,0.9,0.8> }\n"
    "light_source { <-3,5,1> rgb 0.3 spotlight point_at <0,1,0> radius 15 falloff 25 }\n"
    "light_source { <0,9,2> rgb 0.2 parallel point_at 0 }\n"
    "light_source { <1,4,-4> rgb 0.5 area_light x, y, 4, 4 photons { area_light } }\n"
    "light_source { <0,-5,0> rgb 0 }\n" FLOOR
    "box { <-8,0,6>, <8,8,6.1> pigment { rgb <0.7,0.2,0.1> } finish { ambient 0 diffuse 0.6 } }\n"
    "sphere { <0,1.5,0>, 1 " GLASS " photons { target refraction on reflection on } }\n"
    "sphere { <0.8,1.2,-1.5>, 0.7 pigment { rgbf <1,0.5,0.3,0.9> }\n"
    "  finish { ambient 0 diffuse 0.1 reflection 0.1 }\n"
    "  interior { ior 1.3 fade_distance 1 fade_power 2 fade_color <1,0.2,0.1> }\n"
    "  photons { target refraction on reflection on } }\n"
    "cylinder { <-2.5,0,0>, <-2.5,1,0>, 0.8 open " MIRROR " photons { target reflection on } }\n";

/* Emitted = stored + absorbed + escaped + cut: in counts exactly, in flux to rounding. */
static uint64_t check_books(const LightBooks *books, int lights)
{
    uint64_t budget = 0;
    for (int i = 0; i < lights; i++) {
        const LightBooks *b = &books[i];
        budget += b->budget;
        assert_true(b->emitted == b->budget);
        assert_true(b->emitted == b->stored_paths + b->absorbed + b->escaped + b->cut);
        assert_true(b->stored >= b->stored_paths);
        Rgb sum = rgb_add(rgb_add(b->flux_stored, b->flux_absorbed),
                          rgb_add(b->flux_escaped, b->flux_cut));
        assert_true(rgb_max_abs(rgb_sub(sum, b->flux_emitted)) <= 1e-4f * rgb_max(b->flux_emitted));
    }
    return budget;
}

static void books_balance(void **state)
{
    (void)state;
    LitScene lit;
    lit_make(&lit, busy_scene, 2, 1);
    const PhotonBooks *books = &lit.maps.books;
    assert_int_equal(books->caustic_count, 5);
    assert_int_equal(books->global_count, 5);
    uint64_t sent = check_books(books->caustic, 5);
    assert_true(sent > 10000 && sent < 40000); /* as many as the language makes of count 30000 */
    assert_int_equal(check_books(books->global, 5), 30000);
    uint64_t stored[2] = {0};
    double share = 0;
    for (int i = 0; i < 5; i++) {
        stored[0] += books->caustic[i].stored;
        stored[1] += books->global[i].stored;
        share += books->caustic[i].share;
        assert_true((books->caustic[i].budget > 0) == (i < 4));
        assert_true((books->global[i].budget > 0) == (i < 4));
        assert_true((books->caustic[i].power > 0) == (i < 4));
    }
    assert_true(fabs(share - 1) < 1e-9);
    assert_true(stored[0] == photon_map_count(lit.maps.caustic));
    assert_true(stored[1] == photon_map_count(lit.maps.global));
    const uint64_t *count = lit.stats.count;
    assert_true(count[STAT_PHOTONS_EMITTED] == sent + 30000);
    assert_true(count[STAT_PHOTONS_CAUSTIC] == stored[0]);
    assert_true(count[STAT_PHOTONS_GLOBAL] == stored[1]);
    assert_true(count[STAT_PHOTONS_EMITTED] ==
                count[STAT_PHOTONS_STORED_PATHS] + count[STAT_PHOTONS_ABSORBED] +
                    count[STAT_PHOTONS_ESCAPED] + count[STAT_PHOTONS_CUT]);
    assert_true(count[STAT_PHOTON_RAYS] > sent + 30000);
    assert_true(lit.maps.caustic_radius > 0 && lit.maps.global_radius > 0);
    lit_done(&lit);
}

/* Row S1: the same maps, byte for byte, and the same books for any number of threads. */
static void threads_make_no_difference(void **state)
{
    (void)state;
    LitScene one;
    lit_make(&one, busy_scene, 1, 1);
    const int threads[] = {2, 3, 7};
    for (int t = 0; t < 3; t++) {
        LitScene many;
        lit_make(&many, busy_scene, threads[t], 1);
        assert_true(photon_map_hash(one.maps.caustic) == photon_map_hash(many.maps.caustic));
        assert_true(photon_map_hash(one.maps.global) == photon_map_hash(many.maps.global));
        assert_memory_equal(one.maps.books.caustic, many.maps.books.caustic,
                            5 * sizeof(LightBooks));
        assert_memory_equal(one.maps.books.global, many.maps.books.global, 5 * sizeof(LightBooks));
        lit_done(&many);
    }
    LitScene other;
    lit_make(&other, busy_scene, 1, 2);
    assert_true(photon_map_hash(one.maps.caustic) != photon_map_hash(other.maps.caustic));
    lit_done(&other);
    lit_done(&one);
}

/* Row S4: photons of all lights are alike in power: the mean power of a light's stored photons is
 * within a factor of two of that of the others. */
static void powers_are_alike(void **state)
{
    (void)state;
    LitScene lit;
    lit_make(&lit,
             SETTINGS(40000) "light_source { <0,6,0> rgb 9 fade_distance 0.1 fade_power 2 }\n"
                             "light_source { <2,6,0> rgb 1 fade_distance 0.1 fade_power 2 }\n" FLOOR
                             "sphere { <0,1.5,0>, 1 " GLASS " photons { target refraction on } }\n",
             1, 1);
    const LightBooks *b = lit.maps.books.caustic;
    assert_true(b[0].budget + b[1].budget > 10000);
    double ratio = b[0].power / b[1].power;
    assert_true(fabs((double)b[0].budget / (double)b[1].budget / ratio - 1) < 0.001);
    /* nearer by 36/40: 9 times the colour is 10 times the flux */
    assert_true(ratio > 9 && ratio < 11.5);
    double mean[2];
    for (int i = 0; i < 2; i++)
        mean[i] = (double)b[i].flux_stored.g / (double)b[i].stored;
    assert_true(fabs(mean[0] / mean[1] - 1) < 0.05);
    lit_done(&lit);
}

static void share_can_be_overridden(void **state)
{
    (void)state;
    LitScene lit;
    lit_read(
        &lit,
        SETTINGS(10000) "light_source { <0,6,0> rgb 1 }\n light_source { <0,6,0> rgb 1 }\n" FLOOR
                        "sphere { <0,1.5,0>, 1 " GLASS " photons { target refraction on } }\n",
        1, 1);
    lit.scene->lights[0].photon_share = 3;
    PhotonBooks books;
    assert_int_equal(photon_plan_budgets(lit.tracer, &lit.options, &lit.diag, &books), OK);
    assert_int_equal(books.caustic[0].emitted, 0);
    double sent = (double)(books.caustic[0].budget + books.caustic[1].budget);
    assert_true(fabs((double)books.caustic[0].budget / sent - 0.75) < 0.01); /* the pilot's error */
    assert_true(fabs(books.caustic[0].share - 0.75) < 0.01);
    photon_books_done(&books);
    lit_done(&lit);
}

static double stored_flux(const char *text, uint64_t *stored)
{
    LitScene lit;
    lit_make(&lit, text, 2, 1);
    double flux = 0;
    if (stored)
        *stored = lit.maps.caustic ? photon_map_count(lit.maps.caustic) : 0;
    for (int i = 0; lit.maps.books.caustic && i < lit.maps.books.caustic_count; i++)
        flux += (double)lit.maps.books.caustic[i].flux_stored.g;
    lit_done(&lit);
    return flux;
}

#define SUN "light_source { <0,9,0> rgb 1 parallel point_at 0 }\n"
#define BOX_AT(x) "box { <" #x ",1,-1>, <" #x "+2,2,1> "

/* Two targets, one above the other: the ball around each covers the other, and still every
 * ray counts once. */
static void overlapping_targets_count_once(void **state)
{
    (void)state;
    double one = stored_flux(
        SETTINGS(40000) SUN FLOOR BOX_AT(0) GLASS " photons { target refraction on } }\n", NULL);
    double two =
        stored_flux(SETTINGS(40000) SUN FLOOR BOX_AT(0) GLASS
                    " photons { target refraction on } }\n"
                    "box { <0,3,-1>, <2,4,1> " GLASS " photons { target refraction on } }\n",
                    NULL);
    double beside = stored_flux(SETTINGS(40000) SUN FLOOR BOX_AT(0) GLASS
                                " photons { target refraction on } }\n" BOX_AT(2) GLASS
                                " photons { target refraction on } }\n",
                                NULL);
    assert_true(fabs(one / 4 - 1) < 0.01);
    assert_true(fabs(two / 4 - 1) < 0.01);
    assert_true(fabs(beside / 8 - 1) < 0.01);
}

/* What the flags of objects and lights mean. */
static void flags_mean_what_they_say(void **state)
{
    (void)state;
    uint64_t n;
    /* not collecting */
    stored_flux(SETTINGS(5000) SUN "plane { y, 0 pigment { rgb 1 } finish { ambient 0 diffuse 1 }\n"
                                   "  photons { collect off } }\n" BOX_AT(0) GLASS
                " photons { target refraction on } }\n",
                &n);
    assert_int_equal(n, 0);
    /* the light says on, the object nothing */
    double flux = stored_flux(SETTINGS(5000) "light_source { <0,9,0> rgb 1 parallel point_at 0 "
                                             "photons { refraction on } }\n" FLOOR BOX_AT(0) GLASS
                              " photons { target } }\n",
                              &n);
    assert_true(fabs(flux / 4 - 1) < 0.03);
    /* the light says off: no light makes caustics */
    stored_flux(SETTINGS(5000) "light_source { <0,9,0> rgb 1 parallel point_at 0\n"
                               "  photons { refraction off } }\n" FLOOR BOX_AT(0) GLASS
                " photons { target refraction on } }\n",
                &n);
    assert_int_equal(n, 0);
    /* an opaque lid in the way; the same lid, photons passing through it unseen but filtered */
    stored_flux(SETTINGS(5000) SUN FLOOR BOX_AT(0) GLASS
                " photons { target refraction on } }\n"
                "box { <-3,5,-3>, <5,5.1,3> pigment { rgb 1 } }\n",
                &n);
    assert_int_equal(n, 0);
    flux = stored_flux(SETTINGS(20000) SUN FLOOR BOX_AT(0) GLASS
                       " photons { target refraction on } }\n"
                       "box { <-3,5,-3>, <5,5.1,3> pigment { rgbt <1,1,1,0.5> }\n"
                       "  interior { ior 2 } photons { pass_through } }\n",
                       &n);
    assert_true(fabs(flux / (4 * 0.25) - 1) < 0.02);
}

/* Photons do not see what is not in the picture or casts no shadow, as measured in povray. */
static void hidden_objects(void **state)
{
    (void)state;
    const char *const flags[] = {"no_shadow", "no_image"};
    for (int i = 0; i < 2; i++) {
        char text[1024];
        uint64_t n;
        snprintf(text, sizeof text,
                 SETTINGS(5000) SUN FLOOR BOX_AT(0) GLASS
                 " photons { target refraction on } }\n"
                 "box { <-3,5,-3>, <5,5.1,3> pigment { rgb 1 } %s }\n",
                 flags[i]);
        double flux = stored_flux(text, NULL);
        assert_true(fabs(flux / 4 - 1) < 0.03);
        snprintf(text, sizeof text,
                 SETTINGS(5000) SUN FLOOR BOX_AT(0) GLASS
                 " photons { target refraction on } %s }\n",
                 flags[i]);
        stored_flux(text, &n);
        assert_int_equal(n, 0);
    }
}

/* Row S11: the diffuse surface itself, lit directly, keeps nothing: no specular bounce, no caustic.
 */
static void direct_light_is_not_in_the_map(void **state)
{
    (void)state;
    LitScene lit;
    lit_make(&lit,
             SETTINGS(20000) SUN
             "box { <-4,-1,-4>, <4,0,4> pigment { rgb 1 } finish { ambient 0 diffuse 0.5\n"
             "  reflection 0.5 } photons { target reflection on } }\n"
             "box { <-4,9.5,-4>, <4,10,4> pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n",
             2, 1);
    /* half of it is mirrored to the ceiling and kept there */
    for (size_t i = 0; i < photon_map_count(lit.maps.caustic); i++)
        assert_true(lit_photon_place(lit.maps.caustic, i).y > 9);
    assert_true(fabs((double)lit.maps.books.caustic[0].flux_stored.g / 32 - 1) < 0.03);
    lit_done(&lit);
}

/* Row S2: every kind of light sends photons, and they come from where the light is. */
static void every_light_emits(void **state)
{
    (void)state;
    const char *const lights[] = {
        "light_source { <0,6,0> rgb 1 }",
        "light_source { <0,6,0> rgb 1 spotlight point_at 0 radius 5 falloff 8 }",
        "light_source { <0,6,0> rgb 1 spotlight point_at 0 radius 50 falloff 60 }",
        "light_source { <0,6,0> rgb 1 cylinder point_at 0 radius 0.3 falloff 0.4 }",
        "light_source { <0,6,0> rgb 1 cylinder point_at 0 radius 5 falloff 9 }",
        "light_source { <0,6,0> rgb 1 parallel point_at 0 }",
        "light_source { <0,6,0> rgb 1 area_light x, z, 5, 5 }",
        "light_source { <0,6,0> rgb 1 area_light x, z, 5, 5 photons { area_light } }",
        "light_source { <0,6,0> rgb 1 area_light x, z, 5, 5 circular orient\n"
        "  photons { area_light } }",
        "light_source { <0,6,0> rgb 1 area_light x, z, 5, 1 photons { area_light } }",
        "light_source { <0,1.5,0.2> rgb 1 }", /* inside the target */
    };
    for (size_t i = 0; i < sizeof lights / sizeof lights[0]; i++) {
        char text[1024];
        snprintf(text, sizeof text,
                 SETTINGS(20000) "%s\n" FLOOR "sphere { <0,1.5,0>, 1 " GLASS
                                 " photons { target refraction on collect off } }\n",
                 lights[i]);
        LitScene lit;
        lit_make(&lit, text, 2, 1);
        assert_non_null(lit.maps.caustic);
        print_message("# light %zu: %zu\n", i, photon_map_count(lit.maps.caustic));
        assert_true(photon_map_count(lit.maps.caustic) > 1000);
        for (size_t k = 0; k < photon_map_count(lit.maps.caustic); k++) {
            Photon photon = photon_map_at(lit.maps.caustic, k);
            assert_true(direction_decode(photon.phi, photon.theta).y > -0.02);
            assert_true(v3_dist(normal14_decode(photon.flags >> 2), v3(0, 1, 0)) < 1e-6);
        }
        lit_done(&lit);
    }
}

/* Row S2: what is dark, shadowless or turned away sends none. */
static void dark_lights_emit_nothing(void **state)
{
    (void)state;
    uint64_t n;
    const char *const lights[] = {
        "light_source { <0,6,0> rgb 0 }",
        "light_source { <0,6,0> rgb 1 shadowless }",
        "light_source { <0,6,0> rgb 1 spotlight point_at <0,9,0> radius 5 falloff 8 }",
        "light_source { <0,6,0> rgb 1 cylinder point_at <0,9,0> radius 5 falloff 8 }",
        "light_source { <0,6,0> rgb 1 parallel point_at <0,9,0> }",
    };
    for (size_t i = 0; i < sizeof lights / sizeof lights[0]; i++) {
        char text[1024];
        snprintf(text, sizeof text,
                 SETTINGS(5000) "%s\n" FLOOR "sphere { <0,1.5,0>, 1 " GLASS
                                " photons { target refraction on collect off } }\n",
                 lights[i]);
        stored_flux(text, &n);
        assert_int_equal(n, 0);
    }
}

/* A pass that can store nothing says so and ends: H28. */
static void nothing_to_hit(void **state)
{
    (void)state;
    LitScene lit;
    lit_make(&lit,
             SETTINGS(100000000) SUN "sphere { <0,1.5,0>, 1 " GLASS
                                     " photons { target refraction on } }\n"
                                     "box { <-9,4,-9>, <9,5,9> pigment { rgb 1 } }\n",
             1, 1);
    assert_null(lit.maps.caustic);
    assert_non_null(strstr(lit.messages, "no caustic map"));
    assert_int_equal(lit.stats.count[STAT_PHOTONS_EMITTED], 0);
    assert_true(lit.stats.count[STAT_PHOTON_RAYS] < 20000);
    lit_done(&lit);
    lit_make(&lit,
             SETTINGS(2000) SUN "sphere { <0,1.5,0>, 1 " GLASS
                                " photons { target refraction on } }\n",
             1, 1); /* all of it leaves the scene */
    assert_null(lit.maps.caustic);
    assert_non_null(strstr(lit.messages, "no photon was stored"));
    const LightBooks *books = &lit.maps.books.caustic[0];
    assert_true(books->emitted > 500 && books->escaped > books->emitted / 3);
    assert_true(books->escaped + books->cut == books->emitted);
    lit_done(&lit);
}

/* A thin ring fills little of the ball around it: few photons are wasted beside it, and its
 * light is all there. */
static void small_targets_are_found(void **state)
{
    (void)state;
    LitScene lit;
    lit_make(&lit,
             SETTINGS(50000) SUN FLOOR
             "torus { 2, 0.05 translate 3*y " MIRROR " photons { target reflection on } }\n"
             "box { <-9,9.5,-9>, <9,10,9> pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n",
             2, 1);
    const LightBooks *b = &lit.maps.books.caustic[0];
    double area = PMS_PI * (2.05 * 2.05 - 1.95 * 1.95); /* of 4.2 pi */
    assert_true(b->cut < b->emitted * 17 / 20);         /* 97 % of the ball is not ring */
    /* 0.9 of what falls on it is mirrored; what goes up or down beyond the boxes is lost */
    double mirrored = (double)rgb_sum(rgb_add(b->flux_stored, b->flux_escaped)) / 3;
    print_message("# cut %.2f, mirrored %.4f of %.4f\n", (double)b->cut / (double)b->emitted,
                  mirrored, 0.9 * area);
    assert_true(fabs(mirrored / (0.9 * area) - 1) < 0.03);
    lit_done(&lit);
}

/* count is what the language expects to be stored, so fewer are sent at targets that store or
 * split (POV-Ray's ratios), and they are as dense as the language's: two for each of count over
 * the disk across the ball around the target, none beside the target but for the rim. */
static void count_means_stored(void **state)
{
    (void)state;
    static const struct {
        const char *flags;
        double stores;
    } cases[] = {{"refraction on collect off", 1},
                 {"refraction on", 2},
                 {"refraction on reflection on collect off", 1.5},
                 {"refraction on reflection on", 4.5}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        char text[1024];
        snprintf(text, sizeof text,
                 SETTINGS(100000) SUN FLOOR BOX_AT(0) GLASS
                 " finish { reflection 0.1 } photons { target %s } }\n",
                 cases[i].flags);
        LitScene lit;
        lit_make(&lit, text, 1, 1);
        const LightBooks *books = &lit.maps.books.caustic[0];
        /* the box is 4 of the disk's 2.25 pi, the floor around it is cut */
        double hits = 200000 / cases[i].stores * 4 / (2.25 * PMS_PI);
        assert_true(fabs((double)(books->emitted - books->cut) / hits - 1) < 0.05);
        assert_true((double)books->emitted < 1.4 * hits);
        lit_done(&lit);
    }
}

/* spacing: neighbours so far apart at the target. */
static void spacing_sets_the_count(void **state)
{
    (void)state;
    LitScene lit;
    lit_make(&lit,
             "global_settings { assumed_gamma 1 photons { spacing 0.02 } }\n" SUN FLOOR BOX_AT(0)
                 GLASS " photons { target refraction on } }\n",
             2, 1);
    double ideal = 4 / (0.02 * 0.02);
    assert_true((double)lit.maps.books.caustic[0].stored > 0.9 * ideal);
    assert_true((double)lit.maps.books.caustic[0].stored < 1.3 * ideal);
    lit_done(&lit);
}

/* Photons kept in full are the same photons; what they carry is what the 20 bytes round. */
static void full_light_is_what_20_bytes_round(void **state)
{
    (void)state;
    enum { NEAR = 200 };
    LitScene lit;
    PhotonMaps full;
    const GatheredPhoton *packed, *exact;
    lit_make(&lit, busy_scene, 2, 1);
    lit.options.is_full = true;
    assert_int_equal(photon_pass(lit.tracer, &lit.options, &lit.diag, &lit.stats, &full), OK);
    size_t count = photon_map_count(lit.maps.caustic);
    assert_true(photon_map_count(full.caustic) == count && count > NEAR);
    assert_true(photon_map_bytes(full.caustic) ==
                photon_map_bytes(lit.maps.caustic) + count * sizeof(PhotonLight));
    assert_true(photon_map_hash(full.caustic) != photon_map_hash(lit.maps.caustic));
    GatherScratch *a = gather_scratch_new(), *b = gather_scratch_new();
    GatherLimits limits = GATHER_LIMITS_DEFAULT;
    limits.max_photons = NEAR;
    V3 p = v3(0, 0, 0), n = v3(0, 1, 0);
    int found = photon_gather_list(lit.maps.caustic, p, n, &limits, a, &packed);
    assert_int_equal(photon_gather_list(full.caustic, p, n, &limits, b, &exact), found);
    int different = 0;
    for (int i = 0; i < found; i++) {
        float step = rgb_max(exact[i].irradiance) / 128;
        assert_true(rgb_max_abs(rgb_sub(packed[i].irradiance, exact[i].irradiance)) <= step);
        assert_true(v3_dot(packed[i].from, exact[i].from) > cos(DIRECTION_MAX_ERROR) - 1e-6);
        different += rgb_max_abs(rgb_sub(packed[i].irradiance, exact[i].irradiance)) > 0;
    }
    assert_true(found > NEAR / 2 && different > found / 2);
    gather_scratch_free(a);
    gather_scratch_free(b);
    photon_maps_done(&full);
    lit_done(&lit);
}

static void interruption_stops_the_pass(void **state)
{
    (void)state;
    LitScene lit;
    lit_read(&lit, busy_scene, 2, 1);
    work_interrupted = 1;
    Status status = photon_pass(lit.tracer, &lit.options, &lit.diag, &lit.stats, &lit.maps);
    work_interrupted = 0;
    assert_int_equal(status, ERR_INTERRUPTED);
    assert_null(lit.maps.caustic);
    lit_done(&lit);
}

static void scarce_memory_is_reported(void **state)
{
    (void)state;
    int failures = 0;
    Status status = ERR_MEMORY;
    for (int n = 1; status != OK; n += n < 60 ? 1 : n / 8) {
        LitScene lit;
        lit_read(&lit, busy_scene, 1, 1);
        mem_fail_from(n);
        status = photon_pass(lit.tracer, &lit.options, &lit.diag, &lit.stats, &lit.maps);
        mem_fail_from(0);
        assert_true(status == OK || status == ERR_MEMORY);
        failures += status == ERR_MEMORY;
        if (status == ERR_MEMORY)
            assert_non_null(strstr(lit.messages, "memory"));
        lit_done(&lit);
    }
    assert_true(failures > 20);
}

typedef struct Watch {
    int calls;
    double last;
} Watch;

static void watch(void *ctx, double fraction)
{
    Watch *w = ctx;
    assert_true(fraction >= w->last && fraction >= 0 && fraction < 1);
    w->last = fraction;
    w->calls++;
}

static void progress_goes_forward(void **state)
{
    (void)state;
    LitScene lit;
    Watch w = {0};
    lit_read(&lit, busy_scene, 1, 1);
    lit.options.progress = watch;
    lit.options.progress_ctx = &w;
    assert_int_equal(photon_pass(lit.tracer, &lit.options, &lit.diag, &lit.stats, &lit.maps), OK);
    assert_true(w.calls > 20 && w.last > 0.9);
    lit_done(&lit);
}

/* A red light and a blue one, both through clear glass. */
static const char two_colours[] =
    "global_settings { assumed_gamma 1 photons { count 6000 } }\n"
    "light_source { <3,6,0> rgb <1,0,0> }\n"
    "light_source { <-3,5,1> rgb <0,0,0.3> }\n" FLOOR "sphere { <0,1.5,0>, 1 " GLASS
    " photons { target refraction on reflection on } }\n";

static bool is_red(const PhotonMap *map, size_t index)
{
    Photon photon = photon_map_at(map, index);
    return photon.rgbe[0] > 0;
}

static void photons_seen_are_in_the_books_of_their_light(void **state)
{
    (void)state;
    LitScene lit;
    PhotonMaps maps;
    lit_make(&lit, two_colours, 2, 1);
    assert_int_equal(lit.maps.books.caustic[0].seen + lit.maps.books.caustic[1].seen, 0);
    photon_map_see(lit.maps.caustic, 0); /* of a map that is not watched: nothing happens */
    assert_false(photon_map_is_seen(lit.maps.caustic, 0));
    lit.options.is_watched = true;
    assert_int_equal(photon_pass(lit.tracer, &lit.options, &lit.diag, &lit.stats, &maps), OK);
    assert_true(photon_map_hash(maps.caustic) == photon_map_hash(lit.maps.caustic));
    size_t red = 0, blue = 0;
    for (size_t i = 0; i < photon_map_count(maps.caustic); i++) {
        bool is_its = is_red(maps.caustic, i);
        if (is_its || blue < 10)
            photon_map_see(maps.caustic, i);
        red += is_its;
        blue += !is_its && blue < 10;
    }
    assert_int_equal(photon_maps_count_seen(&maps, &lit.diag), OK);
    const LightBooks *books = maps.books.caustic;
    assert_true(red > 1000 && books[0].stored == red && books[0].seen == red);
    assert_true(books[1].stored > 100 && books[1].seen == 10);
    photon_maps_done(&maps);
    lit_done(&lit);
}

/* In small there are fewer photons, on which the same part of the budgets falls. */
static void a_miniature_sends_a_part(void **state)
{
    (void)state;
    LitScene lit;
    PhotonMaps maps;
    lit_make(&lit, busy_scene, 2, 1);
    const Miniature small = {.side = 4, .photons = 0.1};
    lit.options.miniature = &small;
    assert_int_equal(photon_pass(lit.tracer, &lit.options, &lit.diag, &lit.stats, &maps), OK);
    for (int i = 0; i < 4; i++) {
        const LightBooks *full = &lit.maps.books.caustic[i], *part = &maps.books.caustic[i];
        assert_true(fabs((double)part->emitted - 0.1 * (double)full->emitted) <= 2);
        assert_true(part->power == full->power && part->share == full->share);
    }
    assert_true(maps.caustic_radius > 2.5 * lit.maps.caustic_radius &&
                maps.caustic_radius < 6 * lit.maps.caustic_radius);
    assert_int_equal(miniature_photons(&small, 100), 160);
    assert_int_equal(miniature_photons(NULL, 100), 100);
    assert_int_equal(miniature_ball(&small, 30), 192);
    photon_maps_done(&maps);
    lit_done(&lit);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(books_balance),
        cmocka_unit_test(threads_make_no_difference),
        cmocka_unit_test(powers_are_alike),
        cmocka_unit_test(share_can_be_overridden),
        cmocka_unit_test(overlapping_targets_count_once),
        cmocka_unit_test(flags_mean_what_they_say),
        cmocka_unit_test(hidden_objects),
        cmocka_unit_test(direct_light_is_not_in_the_map),
        cmocka_unit_test(every_light_emits),
        cmocka_unit_test(dark_lights_emit_nothing),
        cmocka_unit_test(nothing_to_hit),
        cmocka_unit_test(small_targets_are_found),
        cmocka_unit_test(count_means_stored),
        cmocka_unit_test(spacing_sets_the_count),
        cmocka_unit_test(full_light_is_what_20_bytes_round),
        cmocka_unit_test(photons_seen_are_in_the_books_of_their_light),
        cmocka_unit_test(a_miniature_sends_a_part),
        cmocka_unit_test(interruption_stops_the_pass),
        cmocka_unit_test(scarce_memory_is_reported),
        cmocka_unit_test(progress_goes_forward),
    };
    return cmocka_run_group_tests_name("photon_pass", tests, NULL, NULL);
}
