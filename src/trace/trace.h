/* What both passes share: the nearest surface, its look, where light goes from there, and what
 * a shadow ray meets.
 *
 * Secondary rays start at the hit point pushed off the surface by the error bound of the point,
 * so no fixed epsilon is needed.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TRACE_TRACE_H
#define PMS_TRACE_TRACE_H

#include "base/rng.h"
#include "base/stats.h"
#include "plan/plan.h"
#include "scene/scene.h"

typedef struct Tracer Tracer; /* scene, plan and ray index; const while rays are traced */

/* Build the ray index.  scene and plan are borrowed.  Free with tracer_free. */
Status tracer_new(const Scene *scene, const Plan *plan, int threads, Diag *diag, Tracer **out);
void tracer_free(Tracer *tracer);
const Scene *tracer_scene(const Tracer *tracer);
const Plan *tracer_plan(const Tracer *tracer);
/* Return a finite box around all bounded objects and lights. */
Bound tracer_bound(const Tracer *tracer);

/* What one thread needs to trace: scratch memory and its own counters. */
typedef struct TraceThread {
    const Tracer *tracer;
    ShapeScratch *shapes;
    Arena *scratch; /* reset by the pass after each sample or photon */
    Stats stats;
} TraceThread;
Status trace_thread_init(TraceThread *thread, const Tracer *tracer, Diag *diag);
void trace_thread_done(TraceThread *thread);

typedef enum RayKind { RAY_CAMERA, RAY_REFLECTED, RAY_REFRACTED, RAY_PHOTON, RAY_KIND_COUNT } RayKind;

typedef struct Hit {
    double t;
    ShapePoint point;        /* p, ng, ns, uv; ng outward of the solid */
    const Surface *surface;
    const Object *object;
    const Shape *leaf;
    uint32_t part;           /* of the leaf */
    double u, v;             /* barycentrics of a triangle */
    bool is_entering;        /* the ray goes into the leaf here (against ng) */
} Hit;

/* Find the nearest surface with ray->tmin < t < ray->tmax that rays of this kind see.
 * Equal t: the object written first. */
bool trace_closest(TraceThread *thread, const Ray *ray, RayKind kind, Hit *out);

/* Return the ray that leaves a surface point in unit direction d: origin pushed to the side d
 * points to by the point's error bound; (0, infinity). */
Ray trace_ray_from(const ShapePoint *point, V3 d);

/* The interiors a ray is inside of, innermost last. */
enum { INTERIORS_MAX = 12 };
typedef struct Interiors {
    int count;
    const Interior *in[INTERIORS_MAX];
    uint32_t object[INTERIORS_MAX]; /* the surface's object: entering and leaving are paired by it */
} Interiors;

/* Fill `out` with the interiors that contain p (for a camera or light inside glass). */
void interiors_at(const Tracer *tracer, V3 p, Interiors *out);

/* One layer of a surface, evaluated.  Colours are pov-facts' symbols: see finish arithmetic in
 * man/pms.5. */
typedef struct SurfaceLayer {
    Rgb color;        /* pigment */
    float opacity;    /* 1 - filter - transmit, may be negative */
    Rgb above;        /* what reaches this layer through the ones above */
    const Finish *finish;
    V3 n;             /* unit, faces the viewer */
    Rgb reflect;      /* reflectivity at this angle, metallic and fresnel applied; not filtered
                         by the layers above */
    V3 reflect_dir;   /* unit; above the geometric surface */
} SurfaceLayer;

enum { SURFACE_LAYERS_MAX = 16 };
typedef struct SurfaceSample {
    ShapePoint at;
    V3 wo;            /* unit, to where the ray came from */
    V3 ng;            /* geometric normal turned to wo */
    const Surface *surface;
    bool is_entering;
    int layer_count;
    SurfaceLayer layers[SURFACE_LAYERS_MAX]; /* top first */
    Rgb through;      /* what passes all layers: throughput of the transmitted ray */
    bool has_transmission; /* through is above nothing and a ray should follow */
    bool is_total_reflection; /* then transmit_dir is the mirror direction, throughput 1 */
    bool is_straight; /* the ior does not change: the trace level does not count this */
    V3 transmit_dir;  /* unit */
    Interiors inside_after; /* of the transmitted ray */
    Rgb segment;      /* absorption along the ray that led here */
} SurfaceSample;

/* Evaluate the surface at a hit for a ray inside `interiors`. */
void surface_sample(TraceThread *thread, const Ray *ray, const Hit *hit,
                    const Interiors *interiors, SurfaceSample *out);

/* Return the fraction of the light that goes from p (pushed off its surface) towards `to` for
 * `distance` scene units and arrives: black when blocked, filtered by what is transparent.
 *
 * blocks_targets  objects that are photon targets with refraction cast full shadows (their
 *                 light comes with the caustic map). */
Rgb trace_shadow(TraceThread *thread, const ShapePoint *from, V3 to, double distance,
                 bool blocks_targets);

/* Light arriving at a point from one light source, before any shadow. */
typedef struct LightSample {
    V3 to_light;     /* unit */
    double distance; /* scene units */
    Rgb color;       /* colour times spot, cylinder and distance attenuation; black: none */
} LightSample;

/* Return the light of `light` at p as if its centre were at `location` (light->location, or a
 * point of its area). */
LightSample light_at(const Light *light, V3 location, V3 p);

/* Return the attenuation by the light's cone or beam towards a point (no distance fading). */
double light_shape_factor(const Light *light, V3 location, V3 p);

/* Return 2/(1+(d/fade_distance)^fade_power), or 1 for a light without fading. */
double light_fade(const Light *light, double distance);

/* Return the brightness per unit of incoming light that a layer sends to wo (diffuse term:
 * colour, opacity and what is above included; cosine and highlights included). */
Rgb layer_direct(const SurfaceLayer *layer, const SurfaceSample *s, V3 to_light,
                 bool has_highlights, bool is_double_illuminated);

/* Return the diffuse reflectance of all layers together (for irradiance from photons and for
 * the roulette of a photon): sum of above * opacity * color * diffuse. */
Rgb surface_diffuse(const SurfaceSample *s);

#endif
