/* The last look at a scene before it is const: derived flags, and what makes no sense across
 * items.  SPDX-License-Identifier: Apache-2.0 */
#include "scene/scene.h"

/* --- what follows from the looks ----------------------------------------------------------- */

static bool mesh_texture_has(const Surface *s, bool (*has)(const Texture *texture))
{
    for (int i = 0; i < s->part_texture_count; i++)
        if (has(s->part_textures[i]))
            return true;
    return false;
}

static bool surface_has(const Surface *s, bool (*has)(const Texture *texture))
{
    return has(s->texture) || (s->inner_texture && has(s->inner_texture)) ||
           mesh_texture_has(s, has);
}

static bool texture_conserves(const Texture *texture)
{
    for (int i = 0; i < texture->layer_count; i++)
        if (texture->layers[i].finish->conserves_energy)
            return true;
    return false;
}

/* Fake caustics brighten what passes; a mirror that conserves energy takes its part of it. */
static bool only_filters(const Surface *s)
{
    return !interior_bends(s->interior) && s->interior->caustics == 0 &&
           !(s->may_reflect && surface_has(s, texture_conserves));
}

/* A flag of an object is that of all its surfaces together. */
static void set_object_flags(Scene *scene)
{
    for (uint32_t i = 0; i < scene->object_count; i++) {
        Object *o = &scene->objects[i];
        o->no_shadow = o->no_image = o->no_reflection = true;
        o->is_target = false;
    }
    for (uint32_t i = 0; i < scene->surface_count; i++) {
        const Surface *s = &scene->surfaces[i];
        Object *o = &scene->objects[s->object];
        o->no_shadow &= s->no_shadow;
        o->no_image &= s->no_image;
        o->no_reflection &= s->no_reflection;
        o->is_target |= s->is_target;
    }
}

/* --- photon targets ------------------------------------------------------------------------ */

static bool light_asks(const Scene *scene, bool is_reflection)
{
    for (int i = 0; i < scene->light_count; i++) {
        const Light *l = &scene->lights[i];
        if ((is_reflection ? l->photon_reflection : l->photon_refraction) == TRI_ON)
            return true;
    }
    return false;
}

/* Photons are sent at the box of an object: one without a box cannot be a target. */
static bool has_bounds(const Scene *scene, const Surface *s)
{
    return bound_is_finite(scene->objects[s->object].bound);
}

/* Photons reach only a part of an object without bounds, which would leave the rest in its full
 * shadow: it reflects them, and lets no photons but shadow rays through. */
static void mark_endless_target(Surface *s, Diag *diag)
{
    if (s->photons.refraction == TRI_ON && s->may_transmit)
        diag_warn(diag, WARN_RENDER, s->photons.span,
                  "photons are not sent through an object without bounds: its shadow is filtered "
                  "instead");
    s->photons.refraction = TRI_OFF;
}

static bool mark_written_targets(Scene *scene, Diag *diag)
{
    bool any = false;
    bool reflects = light_asks(scene, true), refracts = light_asks(scene, false);
    for (uint32_t i = 0; i < scene->surface_count; i++) {
        Surface *s = &scene->surfaces[i];
        if (!s->photons.is_target)
            continue;
        any = true;
        s->is_target = true;
        if (!has_bounds(scene, s))
            mark_endless_target(s, diag);
        if (s->photons.reflection != TRI_ON && s->photons.refraction != TRI_ON && !reflects &&
            !refracts)
            diag_warn(diag, WARN_RENDER, s->photons.span,
                      "this photon target has neither reflection nor refraction on, and no light "
                      "asks for them: no photon will leave it");
    }
    return any;
}

/* A scene that asks for photons and marks nothing gets what reflects or refracts. */
static bool mark_specular_targets(Scene *scene)
{
    bool any = false;
    for (uint32_t i = 0; i < scene->surface_count; i++) {
        Surface *s = &scene->surfaces[i];
        bool reflects = s->may_reflect && s->photons.reflection != TRI_OFF;
        bool transmits =
            s->may_transmit && s->photons.refraction != TRI_OFF && !s->photons.is_pass_through;
        bool refracts = transmits && interior_bends(s->interior);
        if (transmits) /* photons on their way: a bubble in glass, a film behind it */
            s->photons.refraction = TRI_ON;
        if (!has_bounds(scene, s) || !(reflects || refracts))
            continue;
        s->is_target = any = true;
        if (reflects)
            s->photons.reflection = TRI_ON;
    }
    return any;
}

static void mark_targets(Scene *scene, Diag *diag)
{
    bool has_written = mark_written_targets(scene, diag);
    const PhotonSettings *photons = &scene->settings.photons;
    if (has_written || !photons->is_on)
        return;
    if (!mark_specular_targets(scene))
        diag_warn(diag, WARN_RENDER, photons->span,
                  "photons are asked for, but no object with bounds reflects or refracts");
}

/* --- problems ------------------------------------------------------------------------------ */

static bool check_camera(const Scene *scene, Diag *diag)
{
    const Camera *c = &scene->camera;
    V3 across = v3_cross(v3_unit(c->right), v3_unit(c->up));
    double volume = fabs(v3_dot(across, v3_unit(c->direction)));
    if (!v3_is_finite(c->location) || !v3_is_finite(c->direction) || !v3_is_finite(c->right) ||
        !v3_is_finite(c->up)) {
        diag_error(diag, c->span, "the camera's vectors are not finite numbers");
        return false;
    }
    /* The volume of the unit vectors: 1 when perpendicular, 0 when they lie in a plane. */
    if (volume < 1e-9) {
        diag_error(diag, c->span,
                   "the camera's right, up and direction lie in one plane: it sees nothing");
        return false;
    }
    if (volume < 0.9)
        diag_warn(diag, WARN_RENDER, c->span,
                  "the camera's vectors are not perpendicular: the picture will be skewed");
    return true;
}

static bool check_light(const Light *l, Diag *diag)
{
    bool needs_direction = l->kind != LIGHT_POINT || l->is_parallel;
    if (!v3_is_finite(l->location) || !rgb_is_finite(l->color)) {
        diag_error(diag, l->span, "the light's place or colour is not a finite number");
        return false;
    }
    if (needs_direction && !(v3_len2(l->direction) > 0)) {
        diag_error(diag, l->span,
                   "the light's point_at is where the light is: it has no direction");
        return false;
    }
    if (rgb_is_black(l->color))
        diag_warn(diag, WARN_RENDER, l->span, "the light is black: it has no effect");
    else if (l->kind != LIGHT_POINT && !(l->falloff > 0))
        diag_warn(diag, WARN_RENDER, l->span, "the light's falloff is 0: it has no effect");
    return true;
}

static void check_content(const Scene *scene, Diag *diag)
{
    if (scene->object_count == 0)
        diag_warn(diag, WARN_RENDER, SPAN_NONE, "there is no object in the scene");
}

/* --- media --------------------------------------------------------------------------------- */

static void check_media(const Scene *scene, Diag *diag)
{
    for (uint32_t i = 0; i < scene->surface_count; i++) {
        const Surface *s = &scene->surfaces[i];
        if (s->interior->media_count > 0 && !s->is_hollow)
            diag_warn(diag, WARN_RENDER, s->interior->media[0]->span,
                      "media are seen in hollow objects only, and this object is not");
    }
}

/* --- mirrors --------------------------------------------------------------------------------- */

static bool texture_is_fresnel(const Texture *texture)
{
    for (int i = 0; i < texture->layer_count; i++)
        if (texture->layers[i].finish->is_fresnel &&
            !rgb_is_black(texture->layers[i].finish->reflection_max))
            return true;
    return false;
}

/* Fresnel's law takes an index of 1 for one that is not written.  One warning: objects share looks.
 */
static void check_fresnel(const Scene *scene, Diag *diag)
{
    for (uint32_t i = 0; i < scene->surface_count; i++) {
        const Surface *s = &scene->surfaces[i];
        if (s->interior->has_ior || interior_bends(s->interior) ||
            !surface_has(s, texture_is_fresnel))
            continue;
        diag_warn(diag, WARN_RENDER, s->span,
                  "reflection by `fresnel` wants an interior with an ior, and this object has "
                  "none: it only reflects the first colour");
        return;
    }
}

static bool has_atmosphere(const Scene *scene)
{
    const Atmosphere *air = &scene->atmosphere;
    return air->media_count > 0 || air->fog_count > 0 || air->rainbow_count > 0;
}

/* The first surface of a shape, which lends its interior to all that is not said otherwise. */
static const Surface *first_surface(const Scene *scene, const Shape *shape)
{
    while (shape->child_count > 0)
        shape = shape->children[0];
    return &scene->surfaces[shape->surface];
}

static void check_air(const Scene *scene, Diag *diag)
{
    for (uint32_t i = 0; has_atmosphere(scene) && i < scene->object_count; i++) {
        const Object *o = &scene->objects[i];
        if (shape_is_solid(o->shape) && !first_surface(scene, o->shape)->is_hollow &&
            shape_is_inside(o->shape, scene->camera.location))
            diag_warn(diag, WARN_RENDER, o->span,
                      "the camera is inside this object, which is not hollow: no fog, rainbow or "
                      "media of the atmosphere there");
    }
}

/* Photons to send at targets when the scene does not say how many. */
enum { ADDED_PHOTONS = 200000 };

void scene_add_photons(Scene *scene)
{
    PhotonSettings *photons = &scene->settings.photons;
    bool has_target = false;
    if (photons->is_on)
        return;
    photons->is_on = true;
    photons->count = ADDED_PHOTONS;
    for (uint32_t i = 0; i < scene->surface_count; i++)
        has_target |= scene->surfaces[i].is_target;
    if (!has_target)
        mark_specular_targets(scene);
    set_object_flags(scene);
}

Status scene_check(Scene *scene, Diag *diag)
{
    for (uint32_t i = 0; i < scene->surface_count; i++) {
        Surface *s = &scene->surfaces[i];
        s->may_transmit = surface_has(s, texture_may_transmit);
        s->may_reflect = surface_has(s, texture_may_reflect);
        s->is_matt = !s->may_transmit && !s->may_reflect && surface_has(s, texture_may_scatter);
        s->may_show_back = s->is_double_illuminated || surface_has(s, texture_may_show_back);
        s->is_filter = only_filters(s);
        s->is_target = false;
    }
    mark_targets(scene, diag);
    set_object_flags(scene);

    bool is_good = check_camera(scene, diag);
    for (int i = 0; i < scene->light_count; i++) {
        Light *l = &scene->lights[i];
        l->cos_radius = cos(l->radius);
        l->cos_falloff = cos(l->falloff);
        is_good &= check_light(l, diag);
    }
    check_content(scene, diag);
    check_media(scene, diag);
    check_fresnel(scene, diag);
    if (is_good)
        check_air(scene, diag);
    return is_good ? OK : ERR_SCENE;
}
