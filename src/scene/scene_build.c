/* From nodes to the scene: looks are handed down, top-level unions dissolved, and every leaf
 * shape gets its Surface.
 *
 * The tree is walked twice with the same rules: once to count, so that the arrays of the scene
 * are exact, and once to fill them.  SPDX-License-Identifier: Apache-2.0 */
#include "scene/node.h"

#include <stdio.h>
#include <string.h>

/* What a node hands down to its children. */
typedef struct Looks {
    const Texture *texture, *inner_texture;
    bool is_bare;           /* nobody gave a texture: it is the default one, or NULL */
    const Cutaway *cutaway; /* what members without a texture show, or NULL */
    const Texture *const *part_textures;
    int part_texture_count;
    const Interior *interior;
    PhotonFlags photons;
    Tri hollow, double_illuminate;
    bool no_shadow, no_image, no_reflection, no_radiosity;
    const char *name; /* of the innermost named object around, or NULL */
    Bound bound;      /* what bounded_by promises */
} Looks;

typedef struct Finisher {
    Scene *scene;
    bool is_counting;
    bool has_failed; /* memory is out */
    const Texture *default_texture;
    const Interior *default_interior;
    const Interior *solid, *hollow; /* an interior, and its copy for hollow objects */
} Finisher;

/* --- adding -------------------------------------------------------------------------------- */

const Texture *scene_build_default(SceneBuild *build)
{
    if (build->default_texture)
        return build->default_texture;
    Pigment *pigment = ARENA_NEW(build->arena, Pigment);
    const Finish finish = FINISH_DEFAULT;
    Finish *kept = arena_copy(build->arena, &finish, sizeof finish);
    Layer *layer = ARENA_NEW(build->arena, Layer);
    Texture *texture = ARENA_NEW(build->arena, Texture);
    if (!pigment || !kept || !layer || !texture)
        return NULL;
    pigment->is_solid = true;
    *layer = (Layer){pigment, kept};
    *texture = (Texture){.layers = layer, .layer_count = 1};
    build->default_texture = texture;
    return texture;
}

bool scene_build_add(SceneBuild *build, Node *node)
{
    /* Children that have no texture either take it from here when the scene is finished. */
    if (!node->texture && node->kind != NODE_LIGHT) {
        node->texture = scene_build_default(build);
        node->is_bare = true;
    }
    if (build->node_count == build->node_capacity) {
        size_t capacity = build->node_capacity ? build->node_capacity * 2 : 16;
        Node **grown = ARENA_ARRAY(build->arena, Node *, capacity);
        if (!grown)
            return false;
        if (build->node_count)
            memcpy(grown, build->nodes, build->node_count * sizeof *grown);
        build->nodes = grown;
        build->node_capacity = capacity;
    }
    build->nodes[build->node_count++] = node;
    return true;
}

/* --- looks --------------------------------------------------------------------------------- */

/* The box that bounded_by gives: inside all of its objects. */
static Bound bound_of_nodes(Node *const *nodes, int count);

static Bound bound_of_node(const Node *node)
{
    Bound bound = BOUND_ALL;
    if (node->kind == NODE_LEAF) {
        bound = shape_bound(node->shape);
    } else if (node->is_inverted) {
        bound = BOUND_ALL;
    } else if (node->csg == SHAPE_INTERSECTION) {
        bound = bound_of_nodes(node->children, node->child_count);
    } else {
        bound = BOUND_EMPTY;
        for (int i = 0; i < node->child_count; i++)
            bound = bound_union(bound, bound_of_node(node->children[i]));
    }
    return bound_intersect(bound, bound_of_nodes(node->clips, node->clip_count));
}

static Bound bound_of_nodes(Node *const *nodes, int count)
{
    Bound bound = BOUND_ALL;
    for (int i = 0; i < count; i++)
        bound = bound_intersect(bound, bound_of_node(nodes[i]));
    return bound;
}

/* What a CSG object says of photons holds for its members, item by item: target and
 * pass_through once said stay, collect is off where anyone says so. */
static PhotonFlags photons_of(const Node *node, const PhotonFlags *parent)
{
    if (!node->has_photons)
        return *parent;
    PhotonFlags flags = node->photons;
    if (parent->is_target) {
        flags.is_target = true;
        flags.spacing_factor = parent->spacing_factor;
    }
    if (parent->reflection != TRI_UNSET)
        flags.reflection = parent->reflection;
    if (parent->refraction != TRI_UNSET)
        flags.refraction = parent->refraction;
    flags.is_collecting &= parent->is_collecting;
    flags.is_pass_through |= parent->is_pass_through;
    return flags;
}

static Looks looks_of(const Node *node, const Looks *parent)
{
    Looks looks = *parent;
    if (node->texture) {
        looks.texture = node->texture;
        looks.is_bare = node->is_bare;
    }
    /* A union that was turned inside out is an intersection. */
    if (node->kind == NODE_CSG && (node->csg == SHAPE_INTERSECTION) == node->is_inverted)
        looks.cutaway = NULL;
    if (node->inner_texture)
        looks.inner_texture = node->inner_texture;
    if (node->interior)
        looks.interior = node->interior;
    looks.photons = photons_of(node, &parent->photons);
    if (node->hollow != TRI_UNSET)
        looks.hollow = node->hollow;
    if (looks.double_illuminate != TRI_ON && node->double_illuminate != TRI_UNSET)
        looks.double_illuminate = node->double_illuminate;
    looks.part_textures = node->part_textures;
    looks.part_texture_count = node->part_texture_count;
    looks.no_shadow |= node->no_shadow;
    looks.no_image |= node->no_image;
    looks.no_reflection |= node->no_reflection;
    looks.no_radiosity |= node->no_radiosity;
    if (node->is_named)
        looks.name = node->name;
    if (node->bound_count)
        looks.bound = bound_intersect(looks.bound, bound_of_nodes(node->bounds, node->bound_count));
    return looks;
}

/* The interior of an object that has none: from the old `ior` and `caustics` of a finish, or
 * the one all such objects share. */
static const Interior *interior_of_finish(Finisher *f, const Texture *texture)
{
    for (int i = texture->layer_count - 1; i >= 0; i--) {
        const Finish *finish = texture->layers[i].finish;
        if (finish->ior == 0 && finish->caustics == 0)
            continue;
        Interior interior = INTERIOR_DEFAULT;
        interior.span = texture->span;
        interior.ior = finish->ior != 0 ? finish->ior : 1;
        interior.has_ior = finish->ior != 0;
        interior.caustics = finish->caustics;
        const Interior *kept = arena_copy(f->scene->arena, &interior, sizeof interior);
        f->has_failed |= !kept;
        return kept;
    }
    return f->default_interior;
}

/* Return the interior as a hollow object has it. */
static const Interior *hollow_of(Finisher *f, const Interior *interior)
{
    if (interior != f->solid && interior) {
        Interior *hollow = arena_copy(f->scene->arena, interior, sizeof *interior);
        f->has_failed |= !hollow;
        if (!hollow)
            return interior;
        hollow->is_hollow = true;
        f->solid = interior;
        f->hollow = hollow;
    }
    return interior ? f->hollow : NULL;
}

static uint32_t add_surface(Finisher *f, const Node *node, const Looks *looks)
{
    Scene *scene = f->scene;
    if (f->is_counting)
        return scene->surface_count++;
    const Texture *texture = looks->texture ? looks->texture : f->default_texture;
    const Interior *interior = looks->interior ? looks->interior : interior_of_finish(f, texture);
    scene->surfaces[scene->surface_count] = (Surface){
        .texture = texture,
        .inner_texture = looks->inner_texture,
        .part_textures = looks->part_textures,
        .part_texture_count = looks->part_texture_count,
        .cutaway = looks->is_bare && !looks->part_textures ? looks->cutaway : NULL,
        .interior = looks->hollow == TRI_ON ? hollow_of(f, interior) : interior,
        .photons = looks->photons,
        .no_shadow = looks->no_shadow,
        .no_image = looks->no_image,
        .no_reflection = looks->no_reflection,
        .no_radiosity = looks->no_radiosity,
        .is_double_illuminated = looks->double_illuminate == TRI_ON,
        .is_hollow = looks->hollow == TRI_ON,
        .object = scene->object_count,
        .span = node->span,
    };
    return scene->surface_count++;
}

/* --- shapes -------------------------------------------------------------------------------- */

static void add_light(Finisher *f, const Node *node)
{
    Scene *scene = f->scene;
    int number = scene->light_count++;
    if (f->is_counting)
        return;
    Light *light = &scene->lights[number];
    *light = *node->light;
    light->span = node->span;
    light->name = node->name;
    if (!node->is_named) {
        char name[32];
        int length = snprintf(name, sizeof name, "light %d", number + 1);
        light->name = arena_strndup(scene->arena, name, (size_t)length);
        f->has_failed |= !light->name;
    }
}

static bool fail_memory(Finisher *f)
{
    f->has_failed = true;
    return false;
}

/* Make the shape of a node and the surfaces of its leaves; lights inside are moved out.
 * Returns false when memory is out; while counting, *out stays NULL. */
static bool build_shape(Finisher *f, const Node *node, const Looks *parent, Shape **out);

static bool build_csg(Finisher *f, const Node *node, const Looks *looks, Shape **out)
{
    Shape **children =
        ARENA_ARRAY(f->scene->arena, Shape *, f->is_counting ? 0 : (size_t)node->child_count);
    if (!children)
        return fail_memory(f);
    int used = 0;
    for (int i = 0; i < node->child_count; i++) {
        const Node *child = node->children[i];
        Shape *shape = NULL;
        if (child->kind == NODE_LIGHT)
            add_light(f, child);
        else if (!build_shape(f, child, looks, &shape))
            return false;
        if (shape)
            children[used++] = shape;
    }
    if (f->is_counting)
        return true;
    if (used == 1 && !node->is_inverted && node->clip_count == 0) {
        *out = children[0];
        return true;
    }
    *out = shape_csg(f->scene->arena, node->csg, children, used);
    if (!*out)
        return fail_memory(f);
    if (node->is_inverted)
        shape_invert(*out);
    return true;
}

/* A list of what a cut may show, while it is filled. */
typedef struct CutawayDraft {
    const Shape **solids;
    const Texture **textures;
    int count;
} CutawayDraft;

/* List the leaves of a node that have a texture; of a difference what is cut, not the cutters. */
static void list_solids(const Finisher *f, const Node *node, Looks looks, CutawayDraft *draft)
{
    looks = looks_of(node, &looks);
    if (node->kind == NODE_LEAF && !(looks.is_bare && looks.cutaway)) {
        draft->solids[draft->count] = node->shape;
        draft->textures[draft->count++] = looks.texture ? looks.texture : f->default_texture;
    }
    for (int i = 0; i < node->child_count; i++) {
        if (node->children[i]->kind == NODE_LIGHT)
            continue;
        list_solids(f, node->children[i], looks, draft);
        if (node->is_difference)
            return;
    }
}

/* Make the node, and then the list of what cuts through it show. */
static bool build_cutaway(Finisher *f, const Node *node, Looks looks, Shape **out)
{
    Scene *scene = f->scene;
    uint32_t first = scene->surface_count;
    size_t most = f->is_counting ? 0 : (size_t)node->size;
    CutawayDraft draft = {ARENA_ARRAY(scene->arena, const Shape *, most),
                          ARENA_ARRAY(scene->arena, const Texture *, most), 0};
    Cutaway *cutaway = ARENA_NEW(scene->arena, Cutaway);
    if (!draft.solids || !draft.textures || !cutaway)
        return fail_memory(f);
    looks.cutaway = cutaway;
    if (!build_csg(f, node, &looks, out) || f->is_counting)
        return f->is_counting;
    for (int i = 0; i < node->child_count && (i == 0 || !node->is_difference); i++)
        if (node->children[i]->kind != NODE_LIGHT)
            list_solids(f, node->children[i], looks, &draft);
    *cutaway = (Cutaway){draft.solids, draft.textures, draft.count};
    for (uint32_t i = first; i < scene->surface_count; i++) {
        Surface *surface = &scene->surfaces[i];
        if (surface->cutaway == cutaway) {
            surface->part_textures = draft.textures;
            surface->part_texture_count = draft.count;
        }
    }
    return true;
}

static bool build_shape(Finisher *f, const Node *node, const Looks *parent, Shape **out)
{
    Looks looks = looks_of(node, parent);
    uint32_t surface = f->scene->surface_count;
    if (node->kind == NODE_CSG && node->is_cutaway && looks.is_bare && !looks.cutaway) {
        if (!build_cutaway(f, node, looks, out))
            return false;
    } else if (node->kind == NODE_CSG) {
        if (!build_csg(f, node, &looks, out))
            return false;
    } else {
        surface = add_surface(f, node, &looks);
        if (f->is_counting)
            return true;
        *out = node->shape;
        (*out)->surface = surface;
    }
    if (!f->is_counting && !node_add_clips(f->scene->arena, node, *out, surface))
        return fail_memory(f);
    return true;
}

/* --- objects ------------------------------------------------------------------------------- */

static void add_object(Finisher *f, const Node *node, const Looks *parent)
{
    Scene *scene = f->scene;
    Looks looks = looks_of(node, parent);
    Shape *shape = NULL;
    uint32_t first_surface = scene->surface_count;
    if (!build_shape(f, node, parent, &shape))
        return;
    if (scene->surface_count == first_surface)
        return; /* nothing but lights, or nothing at all */
    uint32_t number = scene->object_count++;
    if (f->is_counting)
        return;
    shape_finish(scene->arena, shape);
    Bound bound = shape_bound(shape);
    if (bound_is_empty(bound)) { /* as an intersection of things apart: nothing to see */
        scene->surface_count = first_surface;
        scene->object_count--;
        return;
    }
    Bound promised = bound_intersect(bound, looks.bound);
    if (!bound_is_finite(bound))
        bound = bound_is_finite(promised) && !bound_is_empty(promised) ? promised : BOUND_ALL;
    scene->objects[number] = (Object){.shape = shape,
                                      .bound = bound,
                                      .span = node->span,
                                      .name = looks.name ? looks.name : node->name};
}

static Looks no_looks(void)
{
    return (Looks){.photons = PHOTON_FLAGS_DEFAULT, .bound = BOUND_ALL, .is_bare = true};
}

static void add_top(Finisher *f, const Node *node, const Looks *parent);

/* Add what the lights in a node look like: objects of their own, which cast no shadow. */
static void add_looks_like(Finisher *f, const Node *node)
{
    Looks looks = no_looks();
    looks.no_shadow = true;
    for (int i = 0; i < node->child_count; i++) {
        if (node->kind == NODE_LIGHT)
            add_top(f, node->children[i], &looks);
        else
            add_looks_like(f, node->children[i]);
    }
}

/* Add a node at top level: unions without clips fall apart into their members. */
static void add_top(Finisher *f, const Node *node, const Looks *parent)
{
    if (f->has_failed)
        return;
    if (node->kind == NODE_LIGHT) {
        add_light(f, node);
        add_looks_like(f, node);
        return;
    }
    bool is_dissolved = node->kind == NODE_CSG && node->csg == SHAPE_UNION && !node->is_inverted &&
                        node->clip_count == 0;
    if (!is_dissolved) {
        add_object(f, node, parent);
        add_looks_like(f, node);
        return;
    }
    Looks looks = looks_of(node, parent);
    for (int i = 0; i < node->child_count; i++)
        add_top(f, node->children[i], &looks);
}

static void walk(Finisher *f, const SceneBuild *build, bool is_counting)
{
    f->is_counting = is_counting;
    f->scene->object_count = f->scene->surface_count = 0;
    f->scene->light_count = 0;
    const Looks none = no_looks();
    for (size_t i = 0; i < build->node_count; i++)
        add_top(f, build->nodes[i], &none);
}

Status scene_build_finish(SceneBuild *build, Scene *scene, Diag *diag)
{
    const Interior interior = INTERIOR_DEFAULT;
    Finisher f = {.scene = scene,
                  .default_texture = scene_build_default(build),
                  .default_interior = arena_copy(scene->arena, &interior, sizeof interior)};
    if (!f.default_texture || !f.default_interior)
        return diag_no_memory(diag, "the scene");
    walk(&f, build, true);
    scene->objects = ARENA_ARRAY(scene->arena, Object, scene->object_count);
    scene->surfaces = ARENA_ARRAY(scene->arena, Surface, scene->surface_count);
    scene->lights = ARENA_ARRAY(scene->arena, Light, (size_t)scene->light_count);
    if (f.has_failed || !scene->objects || !scene->surfaces || !scene->lights)
        return diag_no_memory(diag, "the scene");
    walk(&f, build, false);
    return f.has_failed ? diag_no_memory(diag, "the scene") : OK;
}
