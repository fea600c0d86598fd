/* Moving a whole scene.
 *
 * Objects and the looks attached to them move as they do under the language's own transforms.
 * Those leave lengths alone that are said in numbers of their own, as how far fog reaches; here
 * they are scaled, each once, by the functions named scale_*.  **Whoever gives the scene a new
 * quantity with a unit of length in it adds it to one of them.**  tests/hard/scene_transform_test.c
 * finds one that was forgotten, as soon as a scene uses it.
 *
 * What is no length stays: colours of lights (light that fades is scaled by its fade_distance,
 * other light is the same at any distance), angles, counts, parts of a distance or of the picture,
 * and all that patterns do in their own space.  SPDX-License-Identifier: Apache-2.0 */
#include "scene/scene_transform.h"

Similarity similarity_make(const Xform *turn, double scale, V3 shift)
{
    Xform grow = xform_scale(v3(scale, scale, scale)), move = xform_translate(shift);
    Similarity out = {.scale = scale, .turn = *turn};
    out.place = xform_then(turn, &grow);
    out.place = xform_then(&out.place, &move);
    return out;
}

/* --- lengths ------------------------------------------------------------------------------- */

static void scale_light(Light *light, double scale)
{
    light->fade_distance *= scale;
    if (light->kind == LIGHT_CYLINDER) { /* of a spot these are angles */
        light->radius *= scale;
        light->falloff *= scale;
    }
}

/* Per length: by the inverse. */
static void scale_medium(Medium *medium, double scale)
{
    float inverse = (float)(1 / scale);
    medium->absorption = rgb_scale(medium->absorption, inverse);
    medium->emission = rgb_scale(medium->emission, inverse);
    medium->scattering = rgb_scale(medium->scattering, inverse);
}

static void scale_interior(Interior *interior, double scale)
{
    interior->fade_distance *= scale;
}

static void scale_fog(Fog *fog, double scale)
{
    fog->distance *= scale;
    fog->altitude *= scale;
    fog->offset *= scale;
}

static void scale_rainbow(Rainbow *bow, double scale)
{
    bow->distance *= scale;
}

static void scale_camera(Camera *camera, double scale)
{
    camera->aperture *= scale;
    camera->focal_distance *= scale;
}

static void scale_settings(SceneSettings *settings, double scale)
{
    settings->photons.spacing *= scale;
    settings->photons.radius *= scale;
    settings->photons.media_radius *= scale;
}

/* --- objects ------------------------------------------------------------------------------- */

/* Many objects share one interior: the last answer saves making a copy for each. */
typedef struct Walk {
    Arena *arena;
    const Similarity *by;
    const Interior *from, *to;
} Walk;

/* Return media that are moved already with their lengths scaled; NULL when memory is out. */
static const Medium *const *scaled_media(Walk *walk, const Medium *const *media, int count)
{
    const Medium **list = ARENA_ARRAY(walk->arena, const Medium *, (size_t)count);
    for (int i = 0; list && i < count; i++) {
        Medium *medium = arena_copy(walk->arena, media[i], sizeof *medium);
        if (!medium)
            return NULL;
        scale_medium(medium, walk->by->scale);
        list[i] = medium;
    }
    return list;
}

static const Interior *scaled_interior(Walk *walk, const Interior *interior)
{
    if (interior == walk->from)
        return walk->to;
    Interior *scaled = arena_copy(walk->arena, interior, sizeof *interior);
    if (!scaled)
        return NULL;
    scale_interior(scaled, walk->by->scale);
    scaled->media = scaled_media(walk, interior->media, interior->media_count);
    if (!scaled->media)
        return NULL;
    walk->from = interior;
    walk->to = scaled;
    return scaled;
}

static bool scale_node(Walk *walk, Node *node);

static bool scale_list(Walk *walk, Node **list, int count)
{
    for (int i = 0; i < count; i++)
        if (!scale_node(walk, list[i]))
            return false;
    return true;
}

static bool scale_node(Walk *walk, Node *node)
{
    if (node->light)
        scale_light(node->light, walk->by->scale);
    if (node->interior && !(node->interior = scaled_interior(walk, node->interior)))
        return false;
    return scale_list(walk, node->children, node->child_count);
}

static bool move_objects(Walk *walk, SceneBuild *build)
{
    const Texture **bare = &build->default_texture;
    if (*bare && !(*bare = texture_transform(walk->arena, *bare, &walk->by->place)))
        return false;
    for (size_t i = 0; i < build->node_count; i++)
        if (!node_transform(walk->arena, build->nodes[i], &walk->by->place))
            return false;
    return true;
}

/* Separate from the moving: there objects that share an interior must find it as it was. */
static bool scale_objects(Walk *walk, SceneBuild *build)
{
    return scale_list(walk, build->nodes, (int)build->node_count);
}

/* --- what is around them ------------------------------------------------------------------- */

static void move_camera(Camera *camera, const Xform *place)
{
    camera->location = xform_point(place, camera->location);
    camera->direction = xform_dir(place, camera->direction);
    camera->right = xform_dir(place, camera->right);
    camera->up = xform_dir(place, camera->up);
}

static bool move_sky(Arena *arena, Sky *sky, const Xform *turn)
{
    const Pigment **moved = ARENA_ARRAY(arena, const Pigment *, (size_t)sky->pigment_count);
    for (int i = 0; moved && i < sky->pigment_count; i++)
        if (!(moved[i] = pigment_transform(arena, sky->pigments[i], turn)))
            return false;
    sky->pigments = sky->pigment_count ? moved : NULL;
    return moved != NULL;
}

static bool move_media(Walk *walk, Atmosphere *air)
{
    size_t count = (size_t)air->media_count;
    const Medium **moved = ARENA_ARRAY(walk->arena, const Medium *, count);
    for (int i = 0; moved && i < air->media_count; i++)
        if (!(moved[i] = medium_transform(walk->arena, air->media[i], &walk->by->place)))
            return false;
    air->media = moved ? scaled_media(walk, moved, air->media_count) : NULL;
    return air->media != NULL;
}

/* The level fog begins at is shifted with the scene. */
static void move_fog(Fog *fog, const Similarity *by)
{
    V3 shift = xform_point(&by->place, v3(0, 0, 0));
    fog->up = xform_dir(&by->turn, fog->up);
    fog->offset += v3_dot(fog->up, shift);
}

static bool move_fogs(Walk *walk, Atmosphere *air)
{
    const Fog **moved = ARENA_ARRAY(walk->arena, const Fog *, (size_t)air->fog_count);
    for (int i = 0; moved && i < air->fog_count; i++) {
        Fog *fog = arena_copy(walk->arena, air->fogs[i], sizeof *fog);
        if (!fog)
            return false;
        scale_fog(fog, walk->by->scale);
        move_fog(fog, walk->by);
        moved[i] = fog;
    }
    air->fogs = moved;
    return moved != NULL;
}

static bool move_rainbows(Walk *walk, Atmosphere *air)
{
    const Rainbow **moved = ARENA_ARRAY(walk->arena, const Rainbow *, (size_t)air->rainbow_count);
    const Xform *turn = &walk->by->turn;
    for (int i = 0; moved && i < air->rainbow_count; i++) {
        Rainbow *bow = arena_copy(walk->arena, air->rainbows[i], sizeof *bow);
        if (!bow)
            return false;
        bow->toward = xform_dir(turn, bow->toward);
        bow->up = xform_dir(turn, bow->up);
        bow->right = xform_dir(turn, bow->right);
        scale_rainbow(bow, walk->by->scale);
        moved[i] = bow;
    }
    air->rainbows = moved;
    return moved != NULL;
}

bool scene_transform(SceneBuild *build, Scene *scene, const Similarity *by)
{
    Walk walk = {.arena = build->arena, .by = by};
    move_camera(&scene->camera, &by->place);
    scale_camera(&scene->camera, by->scale);
    scale_settings(&scene->settings, by->scale);
    scene->atmosphere.media_end *= by->scale;
    return move_objects(&walk, build) && scale_objects(&walk, build) &&
           move_sky(walk.arena, &scene->sky, &by->turn) && move_media(&walk, &scene->atmosphere) &&
           move_fogs(&walk, &scene->atmosphere) && move_rainbows(&walk, &scene->atmosphere);
}
