/* The scene's own storage and the values everything starts with.
 * SPDX-License-Identifier: Apache-2.0 */
#include "scene/node.h"

#include <string.h>

static void set_defaults(Scene *scene)
{
    scene->camera = CAMERA_DEFAULT;
    scene->background.color.transmit = 1;
    scene->sky.emission = RGB_WHITE;
    scene->atmosphere = ATMOSPHERE_DEFAULT;
    scene->settings = (SceneSettings){.version = 3.7,
                                      .assumed_gamma = 1,
                                      .ambient_light = RGB_WHITE,
                                      .irid_wavelength = {0.70f, 0.52f, 0.48f},
                                      .max_trace_level = 5,
                                      .adc_bailout = 1.0 / 255};
    scene->settings.photons = (PhotonSettings){
        .spacing = 1, .gather_min = 20, .gather_max = 100, .jitter = 0.4, .autostop = 0.5};
    scene->settings.radiosity = (RadiositySettings){.count = 200,
                                                    .nearest_count = 5,
                                                    .error_bound = 1.8,
                                                    .low_error_factor = 0.5,
                                                    .minimum_reuse = 0.015,
                                                    .maximum_reuse = 0.2,
                                                    .pretrace_start = 0.08,
                                                    .pretrace_end = 0.01,
                                                    .brightness = 1,
                                                    .adc_bailout = 0.01};
    scene->settings.pms = (PmsSettings){.global_count = 200000, .kernel = KERNEL_CONE};
}

Scene *scene_new(void)
{
    Arena *arena = arena_new();
    Arena *text = arena_new();
    Scene *scene = arena && text ? ARENA_NEW(arena, Scene) : NULL;
    if (!scene) {
        arena_free(arena);
        arena_free(text);
        return NULL;
    }
    scene->arena = arena;
    scene->text = text;
    set_defaults(scene);
    return scene;
}

void scene_free(Scene *scene)
{
    if (!scene)
        return;
    for (int i = 0; i < scene->mesh_count; i++)
        mesh_done(scene->meshes[i]);
    Arena *text = scene->text;
    arena_free(scene->arena); /* the Scene itself lies in it */
    arena_free(text);
}

bool scene_add_mesh(Scene *scene, MeshData *mesh)
{
    /* The array is full whenever its count is a power of two. */
    int count = scene->mesh_count;
    if ((count & (count - 1)) == 0) {
        size_t capacity = count ? (size_t)count * 2 : 1;
        MeshData **grown = ARENA_ARRAY(scene->arena, MeshData *, capacity);
        if (!grown)
            return false;
        if (count)
            memcpy(grown, scene->meshes, (size_t)count * sizeof *grown);
        scene->meshes = grown;
    }
    scene->meshes[scene->mesh_count++] = mesh;
    return true;
}
