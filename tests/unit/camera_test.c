/* Camera rays against the formulas of the language.  SPDX-License-Identifier: Apache-2.0 */
#include "eye/camera.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static Camera camera(CameraKind kind)
{
    return (Camera){.kind = kind,
                    .location = v3(1, 2, -3),
                    .direction = v3(0, 0, 2),
                    .right = v3(1.5, 0, 0),
                    .up = v3(0, 1, 0)};
}

static void assert_v3(V3 got, V3 want)
{
    assert_true(v3_dist(got, want) < 1e-12);
}

static void perspective_goes_through_pixel_centres(void **state)
{
    (void)state;
    Camera c = camera(CAMERA_PERSPECTIVE);
    CameraRays rays;
    camera_rays_init(&rays, &c, 4, 2);
    Ray ray = camera_ray(&rays, 0.5, 0.5); /* the top left pixel */
    assert_v3(ray.o, c.location);
    assert_v3(ray.d, v3_unit(v3(-0.375 * 1.5, 0.25, 2)));
    ray = camera_ray(&rays, 2, 1); /* the middle of the film */
    assert_v3(ray.d, v3(0, 0, 1));
    assert_true(ray.tmin == 0 && isinf(ray.tmax));
}

static void orthographic_rays_are_parallel(void **state)
{
    (void)state;
    Camera c = camera(CAMERA_ORTHOGRAPHIC);
    CameraRays rays;
    camera_rays_init(&rays, &c, 10, 10);
    Ray ray = camera_ray(&rays, 10, 10); /* the lower right corner */
    assert_v3(ray.o, v3(1 + 0.75, 2 - 0.5, -3));
    assert_v3(ray.d, v3(0, 0, 1));
}

static void lens_rays_meet_on_the_plane_of_focus(void **state)
{
    (void)state;
    Camera c = camera(CAMERA_PERSPECTIVE);
    c.aperture = 0.8;
    c.focal_distance = 7;
    CameraRays rays;
    camera_rays_init(&rays, &c, 64, 48);
    /* The plane of focus lies 7 scene units along the direction. */
    Ray pinhole = camera_ray(&rays, 11.25, 40.5);
    V3 focus = ray_at(&pinhole, 7 / pinhole.d.z);
    V2 lens[] = {{0, 0}, {1, 0}, {0, -1}, {0.6, 0.8}};
    for (int i = 0; i < 4; i++) {
        Ray ray = camera_lens_ray(&rays, 11.25, 40.5, lens[i]);
        V3 off = v3_sub(ray.o, c.location);
        assert_true(fabs(v3_len(off) - 0.2 * hypot(lens[i].u, lens[i].v)) < 1e-12);
        assert_true(fabs(off.z) < 1e-12);
        assert_v3(ray_at(&ray, (focus.z - ray.o.z) / ray.d.z), focus);
        assert_true(fabs(v3_len(ray.d) - 1) < 1e-12);
    }
}

static void degenerate_cameras_give_no_garbage(void **state)
{
    (void)state;
    Camera c = {.kind = CAMERA_PERSPECTIVE, .aperture = 1, .focal_distance = 1};
    CameraRays rays;
    camera_rays_init(&rays, &c, 1, 1);
    Ray ray = camera_lens_ray(&rays, 0.5, 0.5, (V2){1, 1});
    assert_true(v3_is_finite(ray.o) && v3_is_finite(ray.d));
    c = camera(CAMERA_PERSPECTIVE);
    c.direction = v3_scale(c.direction, 1e-150);
    c.right = v3_scale(c.right, 1e-150);
    c.up = v3_scale(c.up, 1e-150);
    camera_rays_init(&rays, &c, 4, 2);
    assert_v3(camera_ray(&rays, 0.5, 0.5).d, v3_unit(v3(-0.375 * 1.5, 0.25, 2)));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(perspective_goes_through_pixel_centres),
        cmocka_unit_test(orthographic_rays_are_parallel),
        cmocka_unit_test(lens_rays_meet_on_the_plane_of_focus),
        cmocka_unit_test(degenerate_cameras_give_no_garbage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
