/* What the gather's settings do to a caustic with a sharp edge, in whole renders: how far each
 * filter spreads the edge, and that disk and sphere are the shapes they say.
 * SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "lit_scene.h"
#include "render/render.h"

enum { WIDTH = 128, HEIGHT = 40 };
#define RADIUS 0.2

/* A screen seen along z, x from -0.4 to 0.4.  A clear pane over x < 0 makes a caustic there, of
 * irradiance 1, that ends at x = 0; beyond it the screen is `step` further back.  `edge` gets the
 * caustic, averaged over y, by column.  Returns the photons a unit of area. */
static double render_edge(const char *gather, double step, double edge[WIDTH])
{
    char text[1024];
    snprintf(
        text, sizeof text,
        "global_settings { assumed_gamma 1\n"
        "  photons { count 150000 radius %g gather 1, 1000000 } pms { %s } }\n"
        "camera { orthographic location <0,0,-0.5> direction z right 0.8*x up 2*y }\n"
        "light_source { <0,0,-3> rgb 1 parallel point_at 0 }\n"
        "box { <-1.5,-1.5,-1.1>, <0,1.5,-1> pigment { rgbt 1 } finish { ambient 0 diffuse 0 }\n"
        "  interior { ior 1 } photons { target refraction on collect off } }\n"
        "box { <-9,-9,0>, <0,9,1> pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
        "box { <0,-9,%g>, <9,9,1> pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n",
        RADIUS, gather, step);
    LitScene lit;
    lit_read(&lit, text, 1, 1);
    RenderOptions options = RENDER_OPTIONS_DEFAULT;
    options.width = WIDTH;
    options.height = HEIGHT;
    options.threads = 2;
    options.layers = LAYER_CAUSTIC;
    RenderResult result;
    assert_int_equal(render_scene(lit.scene, &options, &lit.diag, &result), OK);
    const ImageLayer *layer = image_find_layer(&result.image, "caustic");
    assert_non_null(layer);
    for (int x = 0; x < WIDTH; x++) {
        edge[x] = 0;
        for (int y = 0; y < HEIGHT; y++) {
            size_t at = (size_t)(y * WIDTH + x) * (size_t)layer->channel_count;
            edge[x] += (double)layer->pixels[at + 1] / HEIGHT;
        }
    }
    double photons = (double)result.stats.count[STAT_PHOTONS_CAUSTIC];
    render_result_done(&result);
    lit_done(&lit);
    return photons / (1.5 * 3);
}

static const char *const names[] = {"flat", "cone", "epanechnikov", "gaussian", "gaussian_jensen"};

/* The filters as the requirements write them, x the squared distance over r^2.  The Gaussian's
 * scale is what keeps the light; the printed 0.918 is another filter. */
static double filter(int name, double x)
{
    double bell = 1 - (1 - exp(-1.953 * x / 2)) / (1 - exp(-1.953));
    switch (name) {
    case 1:
        return 3 * (1 - sqrt(x));
    case 2:
        return 2 * (1 - x);
    case 3:
        return 1.72831 * bell;
    case 4:
        return 0.918 * bell;
    default:
        return 1;
    }
}

/* Irradiance `at` radii inside the edge of a half plane of irradiance 1, by the midpoint rule. */
static double edge_at(int name, double at)
{
    enum { STEPS = 400 };
    double sum = 0;
    for (int i = 0; i < STEPS; i++)
        for (int j = 0; j < STEPS; j++) {
            double u = (2 * i + 1.0) / STEPS - 1, v = (2 * j + 1.0) / STEPS - 1;
            if (u < at && u * u + v * v < 1)
                sum += filter(name, u * u + v * v);
        }
    return sum * 4 / (STEPS * STEPS) / PMS_PI;
}

/* Radii between where the edge has 9/10 and 1/10 of the plateau; falls along x. */
static double spread_of(const double edge[WIDTH], double plateau)
{
    double place[2];
    for (int k = 0; k < 2; k++) {
        double level = plateau * (k ? 0.1 : 0.9);
        int x = 0;
        while (x < WIDTH - 2 && edge[x + 1] > level)
            x++;
        place[k] = x + (edge[x] - level) / (edge[x] - edge[x + 1]);
    }
    return (place[1] - place[0]) * 0.8 / WIDTH / RADIUS;
}

/* Row S15: the filter is a setting, and does to a sharp edge what its formula says: every column
 * within 4 standard errors.  2 / (2 r) disks side by side fill a column; the mean squares of
 * the filters are at most 1.5. */
static void filters_spread_an_edge_as_they_should(void **state)
{
    (void)state;
    double spread[5];
    for (int name = 0; name < 5; name++) {
        char gather[64];
        double edge[WIDTH], theory[WIDTH], plateau = name == 4 ? 0.5312 : 1;
        snprintf(gather, sizeof gather, "kernel %s", names[name]);
        double photons = render_edge(gather, 0, edge);
        for (int x = 0; x < WIDTH; x++) {
            theory[x] = edge_at(name, (WIDTH / 2 - x - 0.5) * 0.8 / WIDTH / RADIUS);
            double disks = 2 / (2 * RADIUS), each = PMS_PI * RADIUS * RADIUS * photons;
            double error = plateau * sqrt(1.5 / (disks * each));
            if (fabs(edge[x] - theory[x]) > 4 * error)
                fail_msg("%s, column %d: %g, expected %g +- %g", names[name], x, edge[x], theory[x],
                         4 * error);
        }
        spread[name] = spread_of(edge, plateau);
        print_message("# %s: an edge is spread over %.3f radii, by its formula %.3f\n", names[name],
                      spread[name], spread_of(theory, plateau));
        assert_true(fabs(spread[name] / spread_of(theory, plateau) - 1) < 0.05);
    }
    /* Filters that weigh the middle more keep edges sharper. */
    assert_true(spread[1] < spread[2] && spread[2] < spread[3] && spread[3] < spread[0]);
}

/* Row S12: the shape is a setting.  Beyond the edge of a lit step, a quarter of the radius high,
 * a disk finds nothing of the light above and a ball does. */
static void disk_and_sphere_at_a_step(void **state)
{
    (void)state;
    double disk[WIDTH], sphere[WIDTH];
    render_edge("gather disk", 0.05, disk);
    render_edge("gather sphere", 0.05, sphere);
    for (int x = WIDTH / 2; x < WIDTH; x++) {
        assert_true(disk[x] == 0);
        double beyond = (x - WIDTH / 2 + 0.5) * 0.8 / WIDTH; /* the ball reaches 0.194 */
        assert_true(beyond > 0.18 || sphere[x] > 0);
        assert_true(beyond < 0.195 || sphere[x] == 0);
    }
    assert_true(sphere[WIDTH / 2] > 0.3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(filters_spread_an_edge_as_they_should),
        cmocka_unit_test(disk_and_sphere_at_a_step),
    };
    return cmocka_run_group_tests_name("filter", tests, NULL, NULL);
}
