/* Moving whole scenes: a scaling by a power of two changes no bit of the picture, shifts and turns
 * only what rounding and noise explain.  The scenes here have every quantity with a unit of length
 * in them; one that scene_transform forgets shows as a changed picture.
 * SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "render/render.h"
#include "sdl/sdl.h"

#include <dirent.h>
#include <stdio.h>
#include <string.h>

enum { WIDTH = 40, HEIGHT = 30, PIXELS = WIDTH * HEIGHT, PHOTONS = 20000 };

/* Read a scene from a text, or where that is NULL from a file, moved. */
static Scene *load(const char *path, const char *text, const Similarity *by, Diag *diag)
{
    static const char *const library = "stdlib";
    SdlOptions options = {.library_paths = &library,
                          .library_path_count = 1,
                          .width = WIDTH,
                          .height = HEIGHT,
                          .threads = 2,
                          .moved_by = by};
    Scene *scene;
    Status status = text ? sdl_load_text(diag, path, text, strlen(text), &options, &scene)
                         : sdl_load(diag, path, &options, &scene);
    if (status != OK)
        fail_msg("cannot read %s", path);
    return scene;
}

static void swallow(void *ctx, const char *text)
{
    (void)ctx;
    (void)text;
}

/* Render with few photons. */
static Image render(const char *path, const char *text, const Similarity *by, bool has_indirect)
{
    Diag diag;
    diag_init(&diag, swallow, NULL);
    Scene *scene = load(path, text, by, &diag);
    PhotonSettings *photons = &scene->settings.photons;
    photons->count = photons->count > PHOTONS ? PHOTONS : photons->count;
    scene->settings.pms.global_count = PHOTONS;
    RenderOptions options = RENDER_OPTIONS_DEFAULT;
    RenderResult result;
    options.width = WIDTH;
    options.height = HEIGHT;
    options.threads = 2;
    options.plan.has_indirect = has_indirect;
    assert_int_equal(render_scene(scene, &options, &diag, &result), OK);
    Image image = result.image;
    result.image = (Image){0};
    render_result_done(&result);
    scene_free(scene);
    diag_done(&diag);
    return image;
}

static const float *pixels_of(const Image *image)
{
    return image_find_layer(image, "")->pixels;
}

static int count_changed(const Image *a, const Image *b)
{
    int count = 0;
    for (size_t i = 0; i < PIXELS; i++)
        count += memcmp(pixels_of(a) + 4 * i, pixels_of(b) + 4 * i, 4 * sizeof(float)) != 0;
    return count;
}

/* --- powers of two ------------------------------------------------------------------------- */

static void check_scales(const char *path, const char *text, bool has_indirect)
{
    static const double scales[] = {0x1p-20, 0x1p10};
    const Xform upright = XFORM_IDENTITY;
    Image still = render(path, text, NULL, has_indirect);
    for (size_t i = 0; i < sizeof scales / sizeof *scales; i++) {
        Similarity by = similarity_make(&upright, scales[i], v3(0, 0, 0));
        Image scaled = render(path, text, &by, has_indirect);
        int changed = count_changed(&still, &scaled);
        if (changed > 0)
            fail_msg("%s scaled by %g: %d of %d pixels changed", path, scales[i], changed, PIXELS);
        image_done(&scaled);
    }
    image_done(&still);
}

static void scenes_keep_every_bit(void **state)
{
    (void)state;
    DIR *folder = opendir("scenes");
    assert_non_null(folder);
    int count = 0;
    for (struct dirent *entry; (entry = readdir(folder));) {
        char path[300];
        if (!strstr(entry->d_name, ".pms"))
            continue;
        snprintf(path, sizeof path, "scenes/%s", entry->d_name);
        check_scales(path, NULL, false);
        count++;
    }
    closedir(folder);
    assert_true(count >= 10);
}

#define FLOOR "plane { y, 0 hollow pigment { checker rgb 0.9, rgb 0.4 } finish { diffuse 0.8 } }\n"

/* Everything that has a length of its own; each scene needs each of its items to look as it does.
 */
static const char *const lengths[] = {
    /* a lens of some width; lamps that fade, a beam, a panel; fading glass; a gradient */
    "#version 3.7; global_settings { assumed_gamma 1 photons { spacing 0.02 radius 0.4 } }\n"
    "camera { location <0,3,-6> look_at <0,0.8,0> aperture 0.6 focal_point <0,1,0>\n"
    "  blur_samples 8 }\n"
    "light_source { <4,6,-3> rgb 2 fade_distance 4 fade_power 2 }\n"
    "light_source { <-3,5,0> rgb 1 cylinder radius 0.6 falloff 1.1 tightness 0\n"
    "  point_at <-2,0,1> }\n"
    "light_source { <0,4,3> rgb 0.5 area_light x, z, 3, 3 jitter\n"
    "  looks_like { sphere { 0, 0.2 finish { emission 1 } } } }\n"
    "sphere { <0,1,0>, 1 pigment { rgbt 1 } finish { ambient 0 diffuse 0 }\n"
    "  interior { ior 1.5 fade_distance 0.7 fade_power 1001 fade_color <1,0.4,0.2> }\n"
    "  photons { target refraction on } }\n"
    "torus { 0.5, 0.2 pigment { gradient x color_map { [0 rgb x] [1 rgb z] } scale 0.3 }\n"
    "  rotate x*40 translate <1.7,1,1> }\n"
    "plane { <1,2,3>, 9 pigment { rgb 0.2 } inverse }\n" FLOOR,
    /* what fills space: media, ground fog, fog, a rainbow, a sky; photons in media */
    "#version 3.7; global_settings { assumed_gamma 1 photons { count 5000 radius 0.5, 1, 0.3\n"
    "  media 1 } }\n"
    "camera { orthographic location <0,2,-6> right x*6 up y*4.5 look_at <0,1.5,0> }\n"
    "light_source { <4,6,-3> rgb 1.5 }\n"
    "media { absorption 0.02 scattering { 1, 0.03 } density { gradient y color_map {\n"
    "  [0 rgb 0.5] [1 rgb 2] } scale 0.7 } }\n"
    "fog { fog_type 2 distance 9 fog_alt 0.5 fog_offset 0.4 rgb <0.5,0.6,0.7> }\n"
    "fog { distance 40 rgb 0.3 }\n"
    "rainbow { angle 42 width 20 distance 8 direction <0,-0.4,1> up y\n"
    "  color_map { [0 rgbt <1,0,0,0.3>] [1 rgbt <0,0,1,0.3>] } }\n"
    "sky_sphere { pigment { gradient y color_map { [0 rgb 0.2] [1 rgb <0.2,0.3,1>] } } }\n"
    "sphere { <-1,1,0>, 0.9 hollow pigment { rgbt 1 } interior { media { emission 0.5\n"
    "  absorption 0.4 density { gradient y color_map { [0 rgb 0] [1 rgb 2] } scale 0.4 } } } }\n"
    "sphere { <1.2,1,0>, 0.8 pigment { rgbt 1 } finish { ambient 0 diffuse 0 }\n"
    "  interior { ior 1.5 } photons { target refraction on } }\n" FLOOR,
};

static void lengths_keep_every_bit(void **state)
{
    (void)state;
    for (size_t i = 0; i < sizeof lengths / sizeof *lengths; i++)
        for (int has_indirect = 0; has_indirect < 2; has_indirect++)
            check_scales(i ? "air.pms" : "things.pms", lengths[i], has_indirect);
}

/* A mesh, a ring and a cylinder on the z axis have no transform until they are scaled. */
static void first_transform_keeps_every_bit(void **state)
{
    (void)state;
    static const char text[] =
        "#version 3.7; global_settings { assumed_gamma 1 }\n"
        "camera { location <3,4,-6> look_at 0 } light_source { <4,6,-3> rgb 1 }\n"
        "torus { 2, 0.3 pigment { rgb 1 } finish { reflection 0.4 } }\n"
        "cylinder { 0, z, 0.5 pigment { rgb y } finish { reflection 0.4 } }\n"
        "mesh { triangle { <-2,-1,-2>, <2,-1,-2>, <0,-1,3> } triangle { <-2,-1,-2>, <2,-1,-2>,\n"
        "  <0,-3,-2> } inside_vector y pigment { rgb x } finish { reflection 0.3 } }\n";
    check_scales("first.pms", text, true);
}

/* --- shifts and turns ---------------------------------------------------------------------- */

/* The root mean square of the difference. */
static double difference(const Image *a, const Image *b)
{
    double sum = 0;
    for (size_t i = 0; i < 4 * (size_t)PIXELS; i++) {
        double d = (double)pixels_of(a)[i] - (double)pixels_of(b)[i];
        sum += d * d;
    }
    return sqrt(sum / (4 * PIXELS));
}

/* What has a place or a direction and no noise: all must follow. */
static const char directed[] =
    "#version 3.7; global_settings { assumed_gamma 1 }\n"
    "#default { pigment { gradient x color_map { [0 rgb 1] [1 rgb y] } scale 0.4 } }\n"
    "light_source { <0,9,0> rgb 0.1 looks_like { box { <-2,-9,2>, <-1.5,-7,2.1>\n"
    "  finish { emission 1 } } } }\n"
    "camera { location <0,3,-6> look_at <0,0.8,0> }\n"
    "light_source { <4,6,-3> rgb 1 spotlight radius 20 falloff 40 point_at <0,0,0> }\n"
    "light_source { <-3,5,0> rgb 1 parallel point_at <0,0,1> }\n"
    "fog { fog_type 2 distance 9 fog_alt 0.5 fog_offset 0.4 rgb <0.5,0.6,0.7> }\n"
    "rainbow { angle 42 width 20 distance 8 direction <0,-0.4,1> arc_angle 200 up y\n"
    "  color_map { [0 rgbt <1,0,0,0.3>] [1 rgbt <0,0,1,0.3>] } }\n"
    "sky_sphere { pigment { gradient <1,2,1> color_map { [0 rgb 0.2] [1 rgb z] } } }\n"
    "difference { box { -1, 1 } sphere { <0.5,1,-1>, 0.8 } pigment { gradient x color_map {\n"
    "  [0 rgb x] [1 rgb z] } } translate y }\n"
    "torus { 0.5, 0.2 clipped_by { plane { x, 0 } } rotate x*40 translate <1.7,1,1>\n"
    "  pigment { rgb 1 } finish { reflection 0.4 } }\n" FLOOR;

static void check_moved(const char *what, const Xform *turn, V3 shift, double limit)
{
    Similarity by = similarity_make(turn, 1, shift);
    Image still = render("directed.pms", directed, NULL, false);
    Image moved = render("directed.pms", directed, &by, false);
    double rms = difference(&still, &moved);
    print_message("# %s: rms %g\n", what, rms);
    assert_true(rms < limit);
    image_done(&still);
    image_done(&moved);
}

/* A pixel or two may show the other side of an edge; the rest nothing. */
#define EDGES 0.005

static void shifts_change_little(void **state)
{
    (void)state;
    const Xform upright = XFORM_IDENTITY;
    V3 way = v3(0.48, 0.6, 0.64);
    check_moved("shifted by 10", &upright, v3_scale(way, 10), 1e-6);
    check_moved("shifted by 1e3", &upright, v3_scale(way, 1e3), 1e-5);
    check_moved("shifted by 1e6", &upright, v3_scale(way, 1e6), EDGES);
}

static void turns_change_little(void **state)
{
    (void)state;
    const V3 axes[] = {v3(1, 0, 0), v3(0, 1, 0), v3(0, 0, 1), v3(0.48, 0.6, 0.64)};
    for (int i = 0; i < 4; i++) {
        Xform quarter = xform_axis_rotate(axes[i], PMS_PI / 2);
        Xform some = xform_axis_rotate(axes[i], PMS_PI / 6);
        check_moved("a quarter turn", &quarter, v3(0, 0, 0), EDGES);
        check_moved("30 degrees", &some, v3(0, 0, 0), EDGES);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(scenes_keep_every_bit),
        cmocka_unit_test(lengths_keep_every_bit),
        cmocka_unit_test(first_transform_keeps_every_bit),
        cmocka_unit_test(shifts_change_little),
        cmocka_unit_test(turns_change_little),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
