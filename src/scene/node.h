/* Objects while a scene is being read: a tree of shapes with looks, and its way into a Scene.
 *
 * Nodes mirror what was written.  scene_build_finish hands textures and flags down from parents
 * to children, dissolves top-level unions, gives every leaf its Surface and fills the Scene.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SCENE_NODE_H
#define PMS_SCENE_NODE_H

#include "scene/scene.h"

typedef struct ColorMap {
    const MapEntry *entries;
    int count;
} ColorMap;

typedef struct Material {
    const Texture *texture, *inner_texture;
    const Interior *interior;
} Material;

enum {
    NODE_DEPTH_MAX = 1000,        /* what nests deeper is refused: every walk is recursive */
    NODE_COPIES_MAX = 10 * 1000 * 1000 /* copies of declared objects, counted by their nodes */
};

typedef enum NodeKind { NODE_LEAF, NODE_CSG, NODE_LIGHT } NodeKind;

typedef struct Node Node;
struct Node {
    NodeKind kind;
    Span span;
    const char *name;           /* identifier or keyword, for messages and explain */
    bool is_named;              /* name is an identifier */
    long size;                  /* nodes in this tree, itself included */
    int depth;                  /* of a CSG node: 1 + that of its deepest child; a leaf has 0 */
    Shape *shape;               /* of a leaf */
    ShapeKind csg;              /* of a CSG node: union, merge or intersection */
    bool is_difference;         /* an intersection whose later children were inverted */
    bool is_inverted;           /* of a CSG node */
    Node **children;
    int child_count;
    Node **clips, **bounds;
    int clip_count, bound_count;
    Light *light;               /* of a NODE_LIGHT; its looks_like is its only child */
    const Texture *texture, *inner_texture;
    const Texture *const *part_textures;
    int part_texture_count;
    const Interior *interior;
    PhotonFlags photons;
    bool has_photons;           /* photons{} was written here */
    bool is_uv;                 /* its textures see uv */
    bool is_bare;               /* its texture is the default one */
    bool is_cutaway;            /* of an intersection: cuts show the textures of what they cut */
    Tri hollow, double_illuminate;
    bool no_shadow, no_image, no_reflection, no_radiosity;
};

typedef struct SceneBuild {
    Arena *arena;               /* the scene's */
    Node **nodes;               /* top-level objects in written order, lights too */
    size_t node_count, node_capacity;
    long copies;                /* nodes copied from declared objects so far */
    const Texture *default_texture; /* #default; applied when a top-level object is added */
} SceneBuild;

/* Make an empty scene and its arenas, or NULL. */
Scene *scene_new(void);

/* Remember a mesh, so that scene_free frees its index.  Returns false when memory is out. */
bool scene_add_mesh(Scene *scene, MeshData *mesh);

/* Deep copy of a node tree in `arena`, or NULL. */
Node *node_copy(Arena *arena, const Node *node);

/* Apply a transform to a node: geometry, clips, bounds, lights and the looks attached so far.
 * Returns false when memory is out. */
bool node_transform(Arena *arena, Node *node, const Xform *xform);

/* Swap inside and outside of a node, in place. */
void node_invert(Node *node);

/* Return the shape of a node that is no light, made of those of its leaves, which it takes: a node
 * has one.  NULL when memory is out. */
Shape *node_shape(Arena *arena, const Node *node);

/* Attach the clips of a node to its shape.  Clips show no surface; theirs is that of what they
 * clip, so that no leaf is without one.  Returns false when memory is out. */
bool node_add_clips(Arena *arena, const Node *node, Shape *shape, uint32_t surface);

/* Return true if every shape of the node has an inside; lights do not count. */
bool node_is_solid(const Node *node);

/* Return the texture of objects that have none: #default's, or black with the default finish.
 * NULL when memory is out. */
const Texture *scene_build_default(SceneBuild *build);

/* Add a top-level node (textures missing so far get the current default texture).  Returns
 * false when memory is out. */
bool scene_build_add(SceneBuild *build, Node *node);

/* Turn the nodes into the objects, surfaces and lights of `scene`.  ERR_MEMORY or OK. */
Status scene_build_finish(SceneBuild *build, Scene *scene, Diag *diag);

#endif
