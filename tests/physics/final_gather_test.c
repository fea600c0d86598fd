/* Indirect light by final gathering, with and without the irradiance cache, where it is known.
 *
 * In the language's unit a closed room of reflectance 1/2 whose walls give off 1/2, or get as much
 * from lamps, has radiance 1 everywhere.  SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "lit_scene.h"
#include "table.h"
#include "render/render.h"

enum { SIDE = 24 };

/* A part of the picture. */
typedef struct Area {
    int x, y, width, height;
} Area;

static const Area whole = {0, 0, SIDE, SIDE};

typedef struct Picture {
    LitScene lit;
    RenderResult result;
} Picture;

static void make_picture(Picture *picture, const char *text, PlanOptions plan, int threads,
                         uint64_t seed, int samples)
{
    lit_read_as(&picture->lit, text, 1, 1, plan);
    RenderOptions options = RENDER_OPTIONS_DEFAULT;
    options.width = options.height = SIDE;
    options.threads = threads;
    options.seed = seed;
    options.plan = plan;
    options.samples = plan.integrator == INTEGRATOR_PATH ? 400 : samples;
    options.aa = AA_UNIFORM;
    options.layers = LAYER_INDIRECT;
    Status status =
        render_scene(picture->lit.scene, &options, &picture->lit.diag, &picture->result);
    if (status != OK)
        print_message("%s", picture->lit.messages);
    assert_int_equal(status, OK);
}

static void picture_done(Picture *picture)
{
    render_result_done(&picture->result);
    lit_done(&picture->lit);
}

static double mean_of(const Picture *picture, Area area, int channel)
{
    const ImageLayer *layer = &picture->result.image.layers[0];
    double sum = 0;
    for (int y = area.y; y < area.y + area.height; y++)
        for (int x = area.x; x < area.x + area.width; x++)
            sum += (double)layer->pixels[(y * SIDE + x) * layer->channel_count + channel];
    return sum / (area.width * area.height);
}

/* The mean over a few seeds, and its standard error. */
static double mean_over_seeds(const char *text, PlanOptions plan, Area area, double *error)
{
    enum { SEEDS = 3 };
    double sum = 0, squares = 0;
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        Picture picture;
        make_picture(&picture, text, plan, 2, seed, 1);
        double mean = mean_of(&picture, area, 1);
        sum += mean / SEEDS;
        squares += mean * mean / SEEDS;
        picture_done(&picture);
    }
    *error = sqrt(fmax(0, squares - sum * sum) / (SEEDS - 1)) + 1e-5 * sum;
    return sum;
}

static void expect_mean(const char *what, const char *text, PlanOptions plan, double expected,
                        double part)
{
    double error, mean = mean_over_seeds(text, plan, whole, &error);
    table_row(what, mean, expected, error);
    assert_true(fabs(mean / expected - 1) < part);
    assert_true(fabs(mean - expected) < 4 * error + 0.001 * expected);
}

/* The same where estimates from few photons are a little off. */
static void expect_near(const char *what, const char *text, PlanOptions plan, double expected,
                        double part)
{
    double error, mean = mean_over_seeds(text, plan, whole, &error);
    table_row(what, mean, expected, error);
    assert_true(fabs(mean - expected) < 4 * error + part * expected);
}

static const PlanOptions by_gather = {
    .quality = 9, .has_indirect = true, .indirect = INDIRECT_GATHER};
static const PlanOptions by_cache = {.quality = 9, .has_indirect = true};

#define HEAD                                                                                       \
    "#version 3.7;\n"                                                                              \
    "global_settings { assumed_gamma 1 max_trace_level 30 adc_bailout 1e-4\n"                      \
    "  pms { global_photons 100000 } %s }\n"                                                       \
    "camera { location <0,0,-0.3> look_at z angle 90 right x up y }\n"

static const char *scene_text(const char *settings, const char *objects)
{
    static char text[2048];
    int head = snprintf(text, sizeof text, HEAD, settings);
    snprintf(text + head, sizeof text - (size_t)head, "%s", objects);
    return text;
}

#define ROOM "sphere { 0, 1 hollow pigment { rgb 1 } finish { ambient 0 diffuse 0.5 %s } }\n"

static const char *room(const char *finish, const char *lamps)
{
    static char text[1024];
    int used = snprintf(text, sizeof text, ROOM, finish);
    snprintf(text + used, sizeof text - (size_t)used, "%s", lamps);
    return text;
}

static void sphere_with_a_lamp(void **state)
{
    (void)state;
    const char *text = scene_text("", room("", "light_source { 0 rgb 1 }"));
    expect_mean("closed sphere, one lamp, gathered", text, by_gather, 1, 0.005);
    expect_mean("closed sphere, one lamp, cached", text, by_cache, 1, 0.005);
}

/* Light of four lamps off the middle falls unevenly; in a sphere what is reflected is even again:
 * flux over area.  Their irradiance is 1 in the mean, so the mean over the whole sphere is 1 and
 * the indirect part is half of it everywhere. */
static void sphere_with_four_lamps(void **state)
{
    (void)state;
    const char *text =
        scene_text("", room("", "#declare P = rgb 1.25e11;\n"
                                "light_source { <0.3,0,0> P fade_distance 1e-6 fade_power 2 }\n"
                                "light_source { <-0.3,0,0> P fade_distance 1e-6 fade_power 2 }\n"
                                "light_source { <0,0.3,0> P fade_distance 1e-6 fade_power 2 }\n"
                                "light_source { <0,-0.3,0> P fade_distance 1e-6 fade_power 2 }\n"));
    Picture picture;
    make_picture(&picture, text, by_cache, 2, 1, 1);
    const ImageLayer *layer = image_find_layer(&picture.result.image, "indirect");
    assert_non_null(layer);
    double sum = 0;
    for (int i = 0; i < SIDE * SIDE; i++)
        sum += (double)layer->pixels[i * layer->channel_count + 1] / (SIDE * SIDE);
    table_row("closed sphere, four lamps, cached: indirect", sum, 0.5, 0);
    assert_true(fabs(sum / 0.5 - 1) < 0.005);
    picture_done(&picture);
}

static void sphere_that_glows(void **state)
{
    (void)state;
    const char *text = scene_text("", room("emission 0.5", ""));
    expect_mean("closed sphere, glow, gathered", text, by_gather, 1, 0.005);
    expect_mean("closed sphere, glow, cached", text, by_cache, 1, 0.005);
}

/* Half of what is reflected is mirrored.  A path of light has the same length in reflections
 * either way: radiance is emission / (1 - reflectance). */
static void sphere_half_of_mirror(void **state)
{
    (void)state;
    const char *text =
        scene_text("", "sphere { 0, 1 hollow pigment { rgb 1 }\n"
                       "  finish { ambient 0 diffuse 0.25 reflection 0.25 emission 0.5 } }\n");
    expect_mean("closed sphere, half a mirror, cached", text, by_cache, 1, 0.005);
}

/* radiosity{}: reflections up to its limit, each with its brightness; ambient before 3.7. */
static void settings_of_radiosity(void **state)
{
    (void)state;
    const PlanOptions plain = PLAN_OPTIONS_DEFAULT;
    const char *objects = room("emission 0.1", "");
    for (int limit = 1; limit <= 3; limit++) {
        char settings[64];
        double expected = 0.1;
        for (int i = 0, n = limit; i < n; i++)
            expected = 0.1 + 0.5 * expected;
        snprintf(settings, sizeof settings, "radiosity { recursion_limit %d }", limit);
        expect_mean("recursion_limit", scene_text(settings, objects), plain, expected, 0.005);
    }
    expect_mean("brightness", scene_text("radiosity { brightness 1.2 }", objects), plain,
                0.1 / (1 - 0.6), 0.005);
    char text[2048];
    snprintf(
        text, sizeof text, "#version 3.6;\n%s",
        strchr(scene_text("radiosity { brightness 1 }", "sphere { 0, 1 hollow pigment { rgb 1 }\n"
                                                        "  finish { ambient 0.2 diffuse 0.5 } }\n"),
               '\n'));
    expect_mean("ambient of old scenes", text, plain, 0.4, 0.005);
}

/* The sky: a horizontal surface under an even one of radiance 1 shows its reflectance. */
static void light_of_the_sky(void **state)
{
    (void)state;
    const char *floor = "#version 3.7;\n"
                        "global_settings { assumed_gamma 1 pms { global_photons 50000 } }\n"
                        "camera { orthographic location <0,3,0> direction -y right x up z }\n"
                        "%s disc { 0, y, 5 pigment { rgb 1 } finish { ambient 0 diffuse 0.7 } }\n";
    char text[1024];
    snprintf(text, sizeof text, floor, "background { rgb 1 }\n");
    expect_mean("under a background", text, by_gather, 0.7, 0.005);
    snprintf(text, sizeof text, floor,
             "sky_sphere { pigment { gradient y color_map { [0 rgb 0] [1 rgb 1] } } }\n");
    /* The gradient is the cosine itself: its mean weighed by the cosine is 2/3. */
    expect_mean("under a sky", text, by_gather, 0.7 * 2 / 3, 0.01);
}

/* A disc that glows over a parallel one: at the middle the form factor is R^2 / (R^2 + h^2). */
static void parallel_discs(void **state)
{
    (void)state;
    const char *text =
        "#version 3.7;\n"
        "global_settings { assumed_gamma 1 pms { global_photons 50000 } }\n"
        "camera { orthographic location <0,0.2,0> direction -y right 0.02*x up 0.02*z }\n"
        "disc { <0,0.5,0>, y, 0.5 pigment { rgb 1 } finish { ambient 0 diffuse 0 emission 1 } }\n"
        "disc { 0, y, 1 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n";
    expect_mean("parallel discs", text, by_gather, 0.5, 0.005);
}

/* Two rooms beside each other, the wall between them a millionth thin, a lamp in one of them: the
 * other stays black, however near the wall. */
static void rooms_do_not_leak(void **state)
{
    (void)state;
    const char *text = "#version 3.7;\n"
                       "global_settings { assumed_gamma 1 pms { global_photons 100000 } }\n"
                       "camera { location <1,1,-0.9> look_at <0.6,0.6,1> angle 90 right x up y }\n"
                       "light_source { <-1,1,0>, rgb 1 }\n"
                       "#default { pigment { rgb 1 } finish { ambient 0 diffuse 0.7 } }\n"
                       "box { <-2,0,-1>, <2,2,1> hollow }\n"
                       "box { <0,-1,-2>, <1e-6,3,2> }\n";
    for (int i = 0; i < 2; i++) {
        Picture picture;
        make_picture(&picture, text, i ? by_gather : by_cache, 2, 1, 1);
        double mean = mean_of(&picture, whole, 1);
        print_message("# the dark room: %g\n", mean);
        assert_true(mean < 1e-6);
        picture_done(&picture);
    }
}

/* The same box with an open door has light in both; the paths say how much, wall by wall. */
static void rooms_agree_with_paths(void **state)
{
    (void)state;
    const char *text = "#version 3.7;\n"
                       "global_settings { assumed_gamma 1 pms { global_photons 200000 } }\n"
                       "camera { location <0,1,-0.95> look_at <0,1,1> angle 80 right x up y }\n"
                       "light_source { <0.3,1.7,0>, rgb 2 fade_distance 1 fade_power 2 }\n"
                       "#default { finish { ambient 0 diffuse 0.7 } }\n"
                       "box { <-1,0,-1>, <1,2,1> hollow pigment { rgb <1,0.9,0.8> } }\n"
                       "box { <-0.6,0,0>, <0,0.9,0.5> pigment { rgb <0.9,0.3,0.2> } }\n"
                       "box { <0.4,0.3,0.2>, <0.8,0.301,0.6> pigment { rgb 0.9 } }\n";
    const Area areas[] = {
        {0, 0, SIDE, 6}, {0, 6, 6, 12}, {18, 6, 6, 12}, {0, 18, SIDE, 6}, {0, 0, SIDE, SIDE}};
    const PlanOptions paths = {.quality = 9, .integrator = INTEGRATOR_PATH};
    Picture reference, cached;
    make_picture(&reference, text, paths, 2, 1, 1);
    make_picture(&cached, text, by_cache, 2, 1, 32);
    for (size_t i = 0; i < sizeof areas / sizeof areas[0]; i++) {
        double a = mean_of(&cached, areas[i], 1), b = mean_of(&reference, areas[i], 1);
        print_message("# area %zu: %.4f cached, %.4f by paths\n", i, a, b);
        assert_true(fabs(a / b - 1) < 0.02);
    }
    double a = mean_of(&cached, whole, 1), b = mean_of(&reference, whole, 1);
    assert_true(fabs(a / b - 1) < 0.01);
    picture_done(&cached);
    picture_done(&reference);
}

/* The same bytes on any number of threads. */
static void threads_change_nothing(void **state)
{
    (void)state;
    const char *text = scene_text(
        "", "light_source { <0.2,0.5,0>, rgb 1 }\n"
            "box { -1, 1 hollow pigment { rgb <1,0.7,0.5> } finish { ambient 0 diffuse 0.6 } }\n"
            "sphere { <0.3,-0.5,0.4>, 0.4 pigment { rgb 1 }\n"
            "  finish { ambient 0 diffuse 0.4 reflection 0.4 emission 0.1 } }\n");
    const int threads[] = {1, 2, 7};
    Picture first, other;
    make_picture(&first, text, by_cache, threads[0], 5, 2);
    for (int i = 1; i < 3; i++) {
        make_picture(&other, text, by_cache, threads[i], 5, 2);
        const ImageLayer *a = &first.result.image.layers[0], *b = &other.result.image.layers[0];
        assert_memory_equal(a->pixels, b->pixels,
                            sizeof(float) * SIDE * SIDE * (size_t)a->channel_count);
        picture_done(&other);
    }
    picture_done(&first);
}

/* A ceiling over a round patch of light with a sharp border, in the dark otherwise. */
#define PATCH                                                                                      \
    "#version 3.7;\n"                                                                              \
    "global_settings { assumed_gamma 1 pms { global_photons 5000 } }\n"                            \
    "camera { location <0,1.9,0> look_at 2*y sky z angle 10 right x up y }\n"                      \
    "light_source { y, 1 spotlight point_at 0 radius 15 falloff 15 }\n"                            \
    "plane { y, 0 pigment { rgb 1 } finish { ambient 0 diffuse 0.5 } }\n"                          \
    "plane { -y, -2 pigment { rgb 1 } finish { ambient 0 diffuse 0.01 } }\n"

/* The lamp is one unit above the floor, the ceiling two. */
static double light_over_patch(void)
{
    enum { RINGS = 1000 };
    double edge = tan(15 * PMS_PI / 180), sum = 0, height2 = 4;
    for (int i = 0; i < RINGS; i++) {
        double r = (i + 0.5) * edge / RINGS, to2 = height2 + r * r;
        double floor = 0.5 / sqrt(1 + r * r);
        sum += floor * height2 / (to2 * to2) * 2 * r * edge / RINGS;
    }
    return 0.01 * sum;
}

/* The patch is no larger for the few photons that make it up: neither where it ends nor around the
 * foot of a ball that rests on it, which is clear as air. */
static void patches_do_not_grow(void **state)
{
    (void)state;
    const char *ball =
        PATCH "sphere { 0.3*y, 0.3 pigment { rgbt 1 } finish { diffuse 0 }\n"
              "  interior { ior 1 } }\n";
    expect_near("over a patch of light", PATCH, by_gather, light_over_patch(), 0.03);
    expect_near("over a patch of light under a ball", ball, by_gather, light_over_patch(), 0.03);
}

/* Fewer photons than an estimate takes. */
static void few_photons(void **state)
{
    (void)state;
    const char *text = "#version 3.7;\n"
                       "global_settings { assumed_gamma 1 pms { global_photons 10 } }\n"
                       "camera { location <0,0,-0.3> look_at z }\n"
                       "light_source { 0 rgb 1 }\n"
                       "sphere { 0, 1 hollow pigment { rgb 1 } finish { diffuse 0.5 } }\n";
    Picture picture;
    make_picture(&picture, text, by_cache, 2, 1, 1);
    double mean = mean_of(&picture, whole, 1);
    print_message("# ten photons: %.3f\n", mean);
    assert_true(isfinite(mean) && mean >= 0.5 && mean < 3);
    picture_done(&picture);
}

/* Glass that scatters a little, and so few photons that every estimate reaches around it: all that
 * gather rays meet is near, and inside they are reflected totally, on and on.  The dice leave a ray
 * 5 + 4 (1/5 + 1/6 + ... + 1/63) < 16 lookups in the mean.  A point that is seen has 200 rays; one
 * that gathers anew on its way, once at most, has 24 at another point. */
static void glass_in_few_photons(void **state)
{
    (void)state;
    const char *text =
        "#version 3.7;\n"
        "global_settings { assumed_gamma 1 pms { global_photons 3000 } }\n"
        "camera { location <0,0,-3> look_at 0 }\n"
        "light_source { <2,4,-4>, 1 }\n"
        "sphere { 0, 1 pigment { rgbt <1,1,1,0.9> } finish { ambient 0 diffuse 0.3 }\n"
        "  interior { ior 1.5 } }\n"
        "plane { y, -1 pigment { rgb 1 } finish { ambient 0 diffuse 0.5 } }\n";
    Picture picture;
    make_picture(&picture, text, by_cache, 2, 1, 1);
    const uint64_t *count = picture.result.stats.count;
    print_message("# %llu lookups at %llu points\n", (unsigned long long)count[STAT_LOOKUPS],
                  (unsigned long long)count[STAT_FINAL_GATHERS]);
    assert_true(count[STAT_FINAL_GATHERS] > 100);
    uint64_t seen = count[STAT_CACHE_RECORDS] + count[STAT_CACHE_MISSES];
    uint64_t rays = 200 * seen + 24 * (count[STAT_FINAL_GATHERS] - seen);
    assert_true(count[STAT_LOOKUPS] < 16 * rays);
    picture_done(&picture);
}

/* A room with a window on a plain without end, which takes most of the photons: in the room their
 * estimates are as large as it is, and all that gather rays meet is near.  What they ask for there
 * is kept, and what no pixel's centre shows is covered by what is a pixel away. */
static void light_nearby_is_kept(void **state)
{
    (void)state;
    const char *text =
        "#version 3.7;\n"
        "global_settings { assumed_gamma 1 pms { global_photons 20000 } }\n"
        "#default { finish { ambient 0 diffuse 0.8 } }\n"
        "camera { location <0,1.5,-1.9> look_at <0.3,1.1,2> angle 80 right x up y }\n"
        "light_source { <14,18,4>, rgb 9 parallel point_at <0,0,0.8> }\n"
        "sky_sphere { pigment { rgb <0.3,0.45,0.8> } }\n"
        "difference { box { <-2.05,-0.05,-2.05>, <2.05,3.05,2.05> }\n"
        "  box { <-2,0,-2>, <2,3,2> } box { <1.5,1,0>, <2.5,2.2,1.5> } pigment { rgb 0.85 } }\n"
        "sphere { <0.5,0.4,0.8>, 0.4 pigment { rgb 0.9 } }\n"
        "plane { y, -0.05 pigment { rgb <0.3,0.5,0.2> } }\n";
    Picture picture;
    make_picture(&picture, text, by_cache, 2, 1, 9);
    const uint64_t *count = picture.result.stats.count;
    print_message("# %llu points for %llu records, %llu of %llu reads missed\n",
                  (unsigned long long)count[STAT_FINAL_GATHERS],
                  (unsigned long long)count[STAT_CACHE_RECORDS],
                  (unsigned long long)count[STAT_CACHE_MISSES],
                  (unsigned long long)count[STAT_CACHE_READS]);
    assert_true(count[STAT_CACHE_RECORDS] > 100);
    assert_true(count[STAT_FINAL_GATHERS] < 5 * count[STAT_CACHE_RECORDS]);
    assert_true(25 * count[STAT_CACHE_MISSES] < count[STAT_CACHE_READS]);
    picture_done(&picture);
}

/* The books of what glows balance too. */
static void books_of_glow_balance(void **state)
{
    (void)state;
    LitScene lit;
    lit_make(&lit,
             "global_settings { assumed_gamma 1 pms { gi on global_photons 40000 } }\n"
             "camera { location -3*z }\n"
             "background { rgb 0.2 }\n"
             "#default { pigment { rgb 1 } finish { ambient 0 diffuse 0.5 } }\n"
             "box { <-1,-1.1,-1>, <1,-1,1> }\n"
             "sphere { 0, 0.5 finish { emission 2 } }\n"
             "torus { 0.8, 0.05 finish { emission <1,0.5,0.2> } }\n"
             "difference { box { <-1,1,-1>, <1,1.2,1> } sphere { <0,1,0>, 0.5 }\n"
             "  finish { emission 0.3 } }\n",
             2, 1);
    const PhotonBooks *books = &lit.maps.books;
    assert_int_equal(books->global_count, 4);
    uint64_t sent = 0;
    for (int i = 0; i < books->global_count; i++) {
        const LightBooks *b = &books->global[i];
        assert_true(b->emitted == b->stored_paths + b->absorbed + b->escaped + b->cut);
        assert_true(b->emitted > 0);
        Rgb sum = rgb_add(rgb_add(b->flux_stored, b->flux_absorbed),
                          rgb_add(b->flux_escaped, b->flux_cut));
        assert_true(rgb_max_abs(rgb_sub(sum, b->flux_emitted)) <= 1e-4f * rgb_max(b->flux_emitted));
        sent += b->emitted;
    }
    assert_true(fabs((double)sent / 40000 - 1) < 0.15);
    /* Flux is surface times emission: the sphere's, and the torus's 4 pi^2 R r. */
    double sphere = 2 * PMS_PI, torus = 4 * PMS_PI * PMS_PI * 0.8 * 0.05;
    print_message("# flux of the sphere %.4f of %.4f, of the torus %.4f of %.4f\n",
                  (double)books->global[0].flux_emitted.g, sphere,
                  (double)books->global[1].flux_emitted.r, torus);
    assert_true(fabs((double)books->global[0].flux_emitted.g / sphere - 1) <
                4 / sqrt((double)books->global[0].emitted));
    assert_true(fabs((double)books->global[1].flux_emitted.r / torus - 1) <
                4 / sqrt((double)books->global[1].emitted));
    assert_string_equal(books->global[3].name, "sky");
    lit_done(&lit);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sphere_with_a_lamp),     cmocka_unit_test(sphere_with_four_lamps),
        cmocka_unit_test(sphere_that_glows),      cmocka_unit_test(sphere_half_of_mirror),
        cmocka_unit_test(settings_of_radiosity),  cmocka_unit_test(light_of_the_sky),
        cmocka_unit_test(parallel_discs),         cmocka_unit_test(rooms_do_not_leak),
        cmocka_unit_test(rooms_agree_with_paths), cmocka_unit_test(threads_change_nothing),
        cmocka_unit_test(patches_do_not_grow),    cmocka_unit_test(few_photons),
        cmocka_unit_test(glass_in_few_photons),   cmocka_unit_test(light_nearby_is_kept),
        cmocka_unit_test(books_of_glow_balance),
    };
    return cmocka_run_group_tests_name("final_gather", tests, NULL, NULL);
}
