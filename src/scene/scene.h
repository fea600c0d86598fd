/* The scene as plain data: what the readers made, const after scene_check.
 *
 * Top-level unions are dissolved into their members; every leaf shape has a Surface, which
 * says how it looks.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SCENE_SCENE_H
#define PMS_SCENE_SCENE_H

#include "base/arena.h"
#include "base/diag.h"
#include "shape/mesh.h"
#include "shape/shape.h"
#include "texture/media.h"
#include "texture/texture.h"

typedef enum Tri { TRI_UNSET, TRI_OFF, TRI_ON } Tri;

/* photons{} of an object or a light. */
typedef struct PhotonFlags {
    bool is_target;
    float spacing_factor;        /* of target, 1 by default */
    Tri reflection, refraction;
    bool is_collecting;          /* collect, on by default */
    bool is_pass_through;
    Span span;
} PhotonFlags;

#define PHOTON_FLAGS_DEFAULT ((PhotonFlags){.spacing_factor = 1, .is_collecting = true})

/* How a leaf shape looks and behaves. */
/* Leaves that lend their textures to cuts through them. */
typedef struct Cutaway {
    const Shape *const *solids;
    const Texture *const *textures; /* of the solids */
    int count;
} Cutaway;

typedef struct Surface {
    const Texture *texture;       /* never NULL after scene_check */
    const Texture *inner_texture; /* interior_texture, or NULL: as texture */
    const Texture *const *part_textures; /* that parts of it have: of a mesh or blob with its own,
                                            of a cut; else NULL */
    int part_texture_count;
    const Interior *interior;     /* never NULL after scene_check */
    PhotonFlags photons;
    bool no_shadow, no_image, no_reflection, no_radiosity;
    bool is_double_illuminated, is_hollow;
    bool may_transmit, may_reflect; /* some light passes / is reflected: set by scene_check */
    bool is_matt;                 /* all it does with light is to scatter it diffusely: set by
                                     scene_check */
    bool may_show_back;           /* light on one side of it may show on the other, diffusely: set
                                     by scene_check */
    bool is_filter;               /* what passes goes straight on and loses what the pigment takes,
                                     nothing else: set by scene_check */
    bool is_target;               /* photons are sent at it: set by scene_check */
    const Cutaway *cutaway;       /* what it shows of cut solids, or NULL */
    uint32_t object;              /* which top-level object it belongs to */
    Span span;                    /* of the object statement */
} Surface;

/* A top-level object. */
typedef struct Object {
    Shape *shape;
    Bound bound;      /* finite, or BOUND_ALL */
    bool no_shadow, no_image, no_reflection; /* of every surface in it */
    bool is_target;   /* some surface in it is */
    Span span;
    const char *name; /* the identifier it was declared as, or its keyword */
} Object;

typedef enum LightKind { LIGHT_POINT, LIGHT_SPOT, LIGHT_CYLINDER, LIGHT_KIND_COUNT } LightKind;

/* area_light */
typedef struct AreaLight {
    V3 axis1, axis2;
    int size1, size2;  /* 0: not an area light */
    int adaptive;      /* 100: off */
    bool has_jitter, is_circular, is_oriented, has_illumination;
} AreaLight;

typedef struct Light {
    LightKind kind;
    bool is_parallel, is_shadowless;
    V3 location, point_at;
    V3 direction;                  /* unit, location to point_at */
    Rgb color;
    double radius, falloff, tightness; /* spot: radians; cylinder: scene units */
    double cos_radius, cos_falloff;    /* of a spot: set by scene_check */
    double fade_distance, fade_power;  /* 0: no fading */
    AreaLight area;
    Tri photon_reflection, photon_refraction;
    bool has_area_photons;
    bool lights_media;             /* media_interaction: media scatter its light */
    bool is_dimmed_by_media;       /* media_attenuation: fog and atmosphere take from it */
    float photon_share;            /* weight of its photon budget, 1 by default */
    Span span;
    const char *name;              /* "light 1" ... or its identifier */
} Light;

/* Return true if its rays are parallel: they come from a plane through its location. */
static inline bool light_is_parallel(const Light *light)
{
    return light->is_parallel || light->kind == LIGHT_CYLINDER;
}

typedef enum CameraKind { CAMERA_PERSPECTIVE, CAMERA_ORTHOGRAPHIC, CAMERA_KIND_COUNT } CameraKind;

typedef struct Camera {
    CameraKind kind;
    V3 location, direction, right, up; /* finished: angle, look_at, transforms applied */
    double aperture, focal_distance;   /* aperture 0: pinhole; distance along |direction| units */
    int blur_samples;
    double blur_confidence, blur_variance;
    Span span;                         /* SPAN_NONE: the default camera */
} Camera;

#define CAMERA_DEFAULT                                                                             \
    ((Camera){.direction = {0, 0, 1},                                                              \
              .right = {1.33, 0, 0},                                                               \
              .up = {0, 1, 0},                                                                     \
              .focal_distance = 1,                                                                 \
              .blur_confidence = 0.9,                                                              \
              .blur_variance = 1e-4})

/* global_settings { photons { ... } } and pms { ... } */
typedef struct PhotonSettings {
    bool is_on;               /* photons{} was written */
    double spacing;           /* used when count is 0 */
    long count;               /* photons to send towards targets; 0: from spacing */
    int gather_min, gather_max;
    double radius;            /* 0: found from the density */
    double jitter, autostop;
    int max_trace_level;      /* 0: the scene's */
    double adc_bailout;       /* 0: the scene's */
    double media_steps;       /* media: above 0 photons are stored in media too */
    double media_radius;      /* of the gathering there; 0: found from the density */
    Span span;
} PhotonSettings;

typedef enum GatherKernel {
    KERNEL_FLAT, KERNEL_CONE, KERNEL_EPANECHNIKOV, KERNEL_GAUSSIAN, KERNEL_GAUSSIAN_JENSEN,
    KERNEL_COUNT
} GatherKernel;

typedef enum GatherShape { GATHER_DISK, GATHER_SPHERE } GatherShape;

/* How indirect light is found from the global map. */
typedef enum IndirectMethod {
    INDIRECT_ANY,    /* not said: as INDIRECT_CACHE */
    INDIRECT_CACHE,  /* final gathering where the irradiance cache needs it */
    INDIRECT_GATHER, /* final gathering at every point seen */
    INDIRECT_MAP,    /* by looking at the map: a quick preview */
    INDIRECT_COUNT
} IndirectMethod;

/* pms { ... }: what pms does beyond the common language. */
typedef struct PmsSettings {
    bool has_indirect;        /* gi: indirect light from the global map */
    IndirectMethod method;    /* gi_method */
    long global_count;        /* photons to emit into the scene for it */
    GatherKernel kernel;
    GatherShape gather_shape;
    Span span;                /* SPAN_NONE: not written */
} PmsSettings;

/* global_settings { radiosity { ... } }, and what holds without it. */
typedef struct RadiositySettings {
    bool is_on;               /* radiosity{} was written */
    int count;                /* gather rays of a record */
    int nearest_count;        /* records that cover a point before no more are made */
    int recursion_limit;      /* diffuse reflections between light and eye; 0: any number */
    double error_bound, low_error_factor;
    double minimum_reuse, maximum_reuse; /* of a record's radius, parts of the camera's distance */
    double pretrace_start, pretrace_end; /* parts of the picture's larger side */
    double brightness, gray_threshold;
    double adc_bailout;       /* what counts for less in the picture looks at the map */
    double max_sample;        /* most that a gather ray may bring, a channel; 0: anything */
    bool is_always_sampling;
    Span span;
} RadiositySettings;

typedef struct SceneSettings {
    double version;           /* language version, 3.7 */
    double assumed_gamma;     /* 1: linear */
    bool has_assumed_gamma, is_gamma_off; /* off: pre-3.7 scenes without assumed_gamma */
    Rgb ambient_light;
    Rgb irid_wavelength;
    int max_trace_level;
    double adc_bailout;
    PhotonSettings photons;
    RadiositySettings radiosity;
    PmsSettings pms;
} SceneSettings;

typedef struct Background {
    Color5 color;
    bool is_given;
    Span span;
} Background;

/* sky_sphere: a pigment of direction. */
typedef struct Sky {
    const Pigment *const *pigments; /* bottom to top; NULL: none */
    int pigment_count;
    Rgb emission;
    Span span;
} Sky;

/* What fills all space but the inside of objects that are not hollow. */
typedef struct Atmosphere {
    const Medium *const *media; /* in written order, as are the others */
    const Fog *const *fogs;
    const Rainbow *const *rainbows;
    int media_count, fog_count, rainbow_count;
    double media_end; /* how far a ray that meets nothing goes through media, scene units */
} Atmosphere;

#define ATMOSPHERE_DEFAULT ((Atmosphere){.media_end = 2e10}) /* the language's */

typedef struct Scene {
    Arena *arena;       /* all that is reached from here */
    Arena *text;        /* sources that spans point into */
    const char *path;
    uint64_t text_hash;    /* of every file that was read, and of `now` if it is used */
    uint64_t declare_hash; /* of what the command line declared */
    Object *objects;
    uint32_t object_count;
    Surface *surfaces;
    uint32_t surface_count;
    Light *lights;
    int light_count;
    MeshData **meshes;  /* their indices are freed with the scene */
    int mesh_count;
    Camera camera;
    Background background;
    Sky sky;
    Atmosphere atmosphere;
    SceneSettings settings;
} Scene;

/* Free a scene and everything it owns; NULL is allowed. */
void scene_free(Scene *scene);

/* Set the fields derived from others, then look for what makes no sense across items: every
 * problem is reported, ERR_SCENE follows if any is an error. */
Status scene_check(Scene *scene, Diag *diag);

/* Do as if photons { count ... } stood in a checked scene that has no photons{}: what reflects or
 * refracts becomes a target, if none is marked. */
void scene_add_photons(Scene *scene);

#endif
