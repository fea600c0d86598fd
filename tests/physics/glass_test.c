/* Glass against closed forms: stacks of panes, and where a lens has its focus.
 *
 * A pane at normal incidence reflects R = ((n-1)/(n+1))^2 at each of its two faces.  Light that
 * goes straight through N panes is (1-R)^(2N); with all that is reflected to and fro between the
 * faces it is (1-R)/(1+(2N-1)R), since 1/T - 1 of surfaces in a row adds up.
 * SPDX-License-Identifier: Apache-2.0 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "lit_scene.h"
#include "table.h"

static double stored_flux(const LitScene *lit, double *error)
{
    double sum = 0, squares = 0;
    for (size_t i = 0; i < photon_map_count(lit->maps.caustic); i++) {
        double power = (double)lit_photon_power(lit->maps.caustic, i).g;
        sum += power;
        squares += power * power;
    }
    *error = sqrt(squares);
    return sum;
}

/* --- panes ---------------------------------------------------------------------------------- */

enum { PHOTONS = 400000, PANES_MAX = 6 };

/* Send a beam of width 1 through panes onto a floor that reflects nothing back. */
static double through_panes(int panes, double ior, const char *reflection, double *error)
{
    char text[4096];
    int at = snprintf(text, sizeof text,
                      "#version 3.7; global_settings { assumed_gamma 1 max_trace_level 200\n"
                      "  adc_bailout 1e-9 photons { count %d } }\n"
                      "light_source { <0,20,0> rgb 1 cylinder radius 1 falloff 1 tightness 0\n"
                      "  parallel point_at 0 }\n"
                      "plane { y, 0 pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
                      "union {\n",
                      PHOTONS);
    for (int i = 0; i < panes; i++)
        at += snprintf(text + at, sizeof text - (size_t)at,
                       "box { <-1.1,%d,-1.1>, <1.1,%d.5,1.1> }\n", i + 1, i + 1);
    snprintf(text + at, sizeof text - (size_t)at,
             "pigment { rgbt 1 } finish { ambient 0 diffuse 0 conserve_energy\n"
             "  reflection { 0, 1 fresnel on } } interior { ior %g }\n"
             "photons { target refraction on %s collect off } }\n",
             ior, reflection);
    LitScene lit;
    lit_make(&lit, text, 2, 5);
    assert_non_null(lit.maps.caustic);
    double flux = stored_flux(&lit, error) / PMS_PI;
    *error /= PMS_PI;
    lit_done(&lit);
    return flux;
}

static double reflectance(double ior)
{
    return (ior - 1) / (ior + 1) * (ior - 1) / (ior + 1);
}

static void check(const char *what, double got, double expected, double error)
{
    table_row(what, got, expected, error);
    assert_true(fabs(got - expected) < 4 * error + 1e-6);
    assert_true(fabs(got / expected - 1) < 0.005);
}

static void straight_through_panes(void **state)
{
    (void)state;
    for (int panes = 1; panes <= PANES_MAX; panes += 2)
        for (int i = 0; i < 2; i++) {
            double ior = i ? 2.4 : 1.5, error;
            double got = through_panes(panes, ior, "reflection off", &error);
            char what[64];
            snprintf(what, sizeof what, "%d panes of ior %g, straight", panes, ior);
            check(what, got, pow(1 - reflectance(ior), 2 * panes), error);
        }
}

static void to_and_fro_between_panes(void **state)
{
    (void)state;
    for (int panes = 1; panes <= PANES_MAX; panes += 2) {
        double error, r = reflectance(1.5);
        double got = through_panes(panes, 1.5, "reflection on", &error);
        char what[64];
        snprintf(what, sizeof what, "%d panes of ior 1.5, all light", panes);
        check(what, got, (1 - r) / (1 + (2 * panes - 1) * r), error);
    }
}

/* --- a lens --------------------------------------------------------------------------------- */

/* Return the root of the mean square radius at which a thin beam of radius `beam` along the axis
 * of a lens meets a screen `below` its middle. */
static double spot_radius(double curvature, double thickness, double ior, double beam, double below)
{
    char text[2048];
    double rise = curvature - thickness / 2;
    snprintf(text, sizeof text,
             "#version 3.7; global_settings { assumed_gamma 1 photons { count 20000 } }\n"
             "light_source { <0,9,0> rgb 1 cylinder radius %.17g falloff %.17g tightness 0\n"
             "  parallel point_at 0 }\n"
             "plane { y, %.17g pigment { rgb 1 } finish { ambient 0 diffuse 1 } }\n"
             "intersection { sphere { <0,%.17g,0>, %.17g } sphere { <0,%.17g,0>, %.17g }\n"
             "  pigment { rgbt 1 } finish { ambient 0 diffuse 0 } interior { ior %g }\n"
             "  photons { target refraction on reflection off collect off } }\n",
             beam, beam, -below, rise, curvature, -rise, curvature, ior);
    LitScene lit;
    lit_make(&lit, text, 2, 6);
    assert_non_null(lit.maps.caustic);
    double sum = 0, weight = 0;
    for (size_t i = 0; i < photon_map_count(lit.maps.caustic); i++) {
        V3 p = lit_photon_place(lit.maps.caustic, i);
        double power = (double)lit_photon_power(lit.maps.caustic, i).g;
        sum += power * (p.x * p.x + p.z * p.z);
        weight += power;
    }
    lit_done(&lit);
    return sqrt(sum / weight);
}

/* Near the axis the radius falls evenly with the distance: two screens tell where it is 0.  The
 * focal length of a thick lens is that of the lensmaker's equation, from its second principal
 * plane. */
static void check_focus(double curvature, double thickness, double ior)
{
    double r = curvature, d = thickness, n = ior;
    double power = (n - 1) * (2 / r - (n - 1) * d / (n * r * r)), f = 1 / power;
    double behind_face = f * (1 - (n - 1) * d / (n * r)), expected = behind_face + d / 2;
    double near = 0.3 * expected, far = 0.7 * expected, beam = 0.01 * r;
    double a = spot_radius(r, d, n, beam, near), b = spot_radius(r, d, n, beam, far);
    double focus = near + (far - near) * a / (a - b);
    char what[100];
    snprintf(what, sizeof what, "focus of a lens %g thick, radii %g, ior %g", d, r, n);
    table_row(what, focus, expected, 0);
    assert_true(fabs(focus / expected - 1) < 0.005);
}

static void lens_has_its_focus(void **state)
{
    (void)state;
    check_focus(2, 0.02, 1.5); /* thin: f is nearly 2 */
    check_focus(2, 0.5, 1.5);
    check_focus(1, 0.3, 1.8);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(straight_through_panes),
        cmocka_unit_test(to_and_fro_between_panes),
        cmocka_unit_test(lens_has_its_focus),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
