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

#include <string.h>

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
    Arena *scratch;     /* reset by the pass after each sample or photon */
    uint32_t *blockers; /* per light: the object that blocked its last shadow ray, or none */
    Crossing *crossed;   /* by the shadow ray at hand, of what lets light through */
    size_t crossed_capacity;
    Rng media_rng;      /* of the sample or photon at hand: where media are looked at */
    bool is_dimmed;     /* all lights dim in media, as photons do: what shadow rays find will be
                           reflected or scattered again */
    Stats stats;
} TraceThread;
Status trace_thread_init(TraceThread *thread, const Tracer *tracer, Diag *diag);
void trace_thread_done(TraceThread *thread);

/* Camera, refracted and photon rays do not see no_image objects, reflected ones do not see
 * no_reflection objects, photons do not see no_shadow objects either.  What follows a reflected ray
 * through glass is a reflected ray.  Diffuse rays, and what follows them, see what shadow rays
 * meet: all but no_shadow objects, and of these not what is no_radiosity either. */
typedef enum RayKind {
    RAY_CAMERA,
    RAY_REFLECTED,
    RAY_REFRACTED,
    RAY_PHOTON,
    RAY_DIFFUSE, /* gathers the light that a diffuse surface reflects */
    RAY_LIGHT,   /* a photon for the global map: sees what diffuse rays see */
    RAY_KIND_COUNT
} RayKind;

/* Another surface in the place of a hit. */
typedef struct HitTie {
    Crossing crossing;
    uint32_t object;
    ShapePoint point;
} HitTie;

enum { HIT_TIES_MAX = 3 };

typedef struct Hit {
    double t;
    ShapePoint point; /* p, ng, ns; ng outward of the solid */
    const Surface *surface;
    const Object *object;
    const Shape *leaf;
    uint32_t part;    /* of the leaf */
    double u, v;      /* barycentrics of a triangle */
    bool is_entering; /* the ray goes into the leaf here (against ng) */
    bool is_wall;     /* the object is on both sides: its members touch here */
    int tie_count;    /* other objects with a surface in the same place, to within the errors */
    HitTie ties[HIT_TIES_MAX]; /* in written order; first in it is this hit */
} Hit;

/* Find the nearest surface with ray->tmin < t < ray->tmax that rays of this kind see.
 * Surfaces of several objects closer together than the error of their t: the object written
 * first.  Counts the ray in the thread's statistics under its kind. */
bool trace_closest(TraceThread *thread, const Ray *ray, RayKind kind, Hit *out);

/* Find the nearest surface of one object with ray->tmin < t < ray->tmax, whoever sees it. */
bool trace_object(TraceThread *thread, const Ray *ray, uint32_t object, Hit *out);

/* Return true if nothing but a surface of the object itself can be seen from inside it: it is made
 * of closed solids that let no light through, and the camera is outside. */
bool tracer_is_opaque_solid(const Tracer *tracer, uint32_t object);

/* Return the ray that leaves a surface point in unit direction d: origin pushed off the surface,
 * to the side d points to, by more than the point's error bound; (0, infinity). */
Ray trace_ray_from(const ShapePoint *point, V3 d);

/* Return true if a facet is turned away from direction d and the curved surface that it stands for
 * is not: a shadow ray then starts at that, or its neighbours would draw the facets in shadows. */
bool trace_lifted_from(const ShapePoint *point, V3 d, Ray *out);

/* The interiors a ray is inside of.  The last is what it is in: of those with the highest priority
 * the one entered last. */
enum { INTERIORS_MAX = 32 };
typedef struct Interiors {
    int count;
    float wavelength; /* nm: of light that was dispersed; 0: all wavelengths together */
    int left_out;     /* more that it is inside of, the outermost: there was no room */
    bool is_clear;    /* absorption is left out */
    const Interior *in[INTERIORS_MAX];
    uint32_t
        object[INTERIORS_MAX]; /* the surface's object: entering and leaving are paired by it */
} Interiors;

/* Copy the part that is used; the first few always, as that is cheaper than to count them. */
static inline void interiors_copy(Interiors *to, const Interiors *from)
{
    enum { FEW = 4 };
    to->count = from->count;
    to->wavelength = from->wavelength;
    to->left_out = from->left_out;
    to->is_clear = from->is_clear;
    memcpy(to->in, from->in, FEW * sizeof *to->in);
    memcpy(to->object, from->object, FEW * sizeof *to->object);
    if (from->count > FEW) {
        size_t rest = (size_t)(from->count - FEW);
        memcpy(to->in + FEW, from->in + FEW, rest * sizeof *to->in);
        memcpy(to->object + FEW, from->object + FEW, rest * sizeof *to->object);
    }
}

/* Fill `out` with the interiors that contain p (for a camera or light inside glass): those of
 * objects that let light through, by priority, then by size; where there are media, fog or rainbows
 * those of opaque ones too. */
void interiors_at(const Tracer *tracer, V3 p, Interiors *out);

/* Return what the innermost interior lets pass of light that goes t scene units in it.  Every leg
 * of a ray or photon is absorbed so, whatever it ends at. */
static inline Rgb interiors_fade(const Interiors *inside, double t)
{
    bool absorbs = inside->count > 0 && !inside->is_clear;
    return absorbs ? interior_fade(inside->in[inside->count - 1], t, false) : RGB_WHITE;
}

/* One layer of a surface, evaluated.  Colours are pov-facts' symbols: see finish arithmetic in
 * man/pms.5. */
typedef struct SurfaceLayer {
    Rgb color;     /* pigment */
    float opacity; /* 1 - filter - transmit (before 3.7 otherwise), may be negative */
    Rgb above;     /* what reaches this layer through the ones above */
    const Finish *finish;
    V3 n;           /* unit, on the side of ng, faces the viewer */
    Rgb reflect;    /* reflectivity at this angle, metallic, fresnel and irid applied; not
                       filtered by the layers above; the reflected colour is to be raised to
                       1/finish->reflection_exponent first */
    V3 reflect_dir; /* unit; above the geometric surface; set if reflect is not black */
} SurfaceLayer;

enum { SURFACE_LAYERS_MAX = 16 };
typedef struct SurfaceSample {
    ShapePoint at;
    V3 wo; /* unit, to where the ray came from */
    V3 ng; /* geometric normal turned to wo */
    const Surface *surface;
    bool is_entering;
    int layer_count; /* those that light reaches: below an opaque layer there are no more */
    SurfaceLayer layers[SURFACE_LAYERS_MAX]; /* top first */
    Rgb filter;                              /* what passes all layers: decides on bailing out */
    bool has_transmission;    /* filter is above adc_bailout and a ray should follow; what is
                                 below, but is_total_reflection, is set only then */
    bool is_total_reflection; /* then transmit_dir is the mirror direction */
    bool is_straight;         /* the ior does not change: the trace level does not count this (but
                                 level + 1 < max_trace_level must hold all the same) */
    Rgb through;            /* throughput of the transmitted ray: filter, 1 if total reflection */
    V3 transmit_dir;        /* unit */
    double ior_ratio;       /* of this side to the far side */
    int spectrum; /* above 0: light of all wavelengths is dispersed here, and the eye wants
                     this many bands of it; see surface_sample */
    Interiors inside_after; /* of the transmitted ray */
    const SceneSettings *settings;
} SurfaceSample;

/* Evaluate the surface at a hit for a ray inside `interiors`.  Surfaces tied to the hit follow as
 * layers below its own, so that glass shows the table it touches.
 *
 * Where light of all wavelengths is dispersed, what is reflected and what passes (filter) are
 * means over them, and the transmitted ray is that of none in particular.  One of a wavelength
 * is had by asking again with that in `interiors`, and has it from then on (inside_after). */
void surface_sample(TraceThread *thread, const Ray *ray, const Hit *hit, const Interiors *interiors,
                    SurfaceSample *out);

/* Give light that a hit disperses a wavelength, chosen by u in [0,1), and evaluate the surface for
 * it.  The wavelength goes into `interiors`; *color is to be weighed with and has the mean white.
 * Returns false if none of that wavelength passes. */
bool surface_sample_wave(TraceThread *thread, const Ray *ray, const Hit *hit, Interiors *interiors,
                         double u, SurfaceSample *out, Rgb *color);

/* Return the fraction of the light that goes from p (pushed off its surface) towards `to` for
 * `distance` scene units and arrives: black when blocked, filtered by what is transparent.
 *
 * distance        what light_at gave; behind a parallel light it is negative: no shadow.
 * light           index of the light, for the thread's memory of the last blocker; -1: none.
 * blocks_targets  objects that are photon targets with refraction cast full shadows (their
 *                 light comes with the caustic map).
 *
 * With path tracing all that bends or mirrors light casts full shadows: see plan_filters_shadow. */
Rgb trace_shadow(TraceThread *thread, const ShapePoint *from, V3 to, double distance, int light,
                 bool blocks_targets);

/* The objects that shadow rays from one point to the points of one area light may meet. */
enum { SHADOW_BUNDLE_MAX = 24 };
typedef struct ShadowBundle {
    int count; /* negative: more than fit, every ray asks for itself */
    uint32_t object[SHADOW_BUNDLE_MAX];
} ShadowBundle;

/* Find the objects for rays from `from` to points within `radius` of from->p + to_center.  None
 * means that all the rays arrive. */
void trace_shadow_bundle(const Tracer *tracer, const ShapePoint *from, V3 to_center, double radius,
                         ShadowBundle *out);

/* trace_shadow for a ray of a bundle. */
Rgb trace_shadow_of(TraceThread *thread, const ShadowBundle *bundle, const ShapePoint *from, V3 to,
                    double distance, int light, bool blocks_targets);

/* What is known of a light's shadows along a ray without sending shadow rays. */
typedef enum LitState {
    LIT_UNSURE,
    LIT_SURE, /* nothing is between it and the light */
    LIT_NOT   /* something opaque is */
} LitState;

typedef struct LitStretch {
    double begin, end; /* t */
    LitState state;
} LitStretch;

/* One follows on the other. */
enum { LIT_STRETCHES_MAX = 64 };
typedef struct LitStretches {
    int count;
    LitStretch items[LIT_STRETCHES_MAX];
} LitStretches;

/* Cut a ray from begin to end, finite, by what is known of light `light` (index).  Returns false
 * if nothing is: that is kept for lights without size that media scatter. */
bool trace_lit_stretches(const Tracer *tracer, int light, const Ray *ray, double begin, double end,
                         LitStretches *out);

/* Light arriving at a point from one light source, before any shadow. */
typedef struct LightSample {
    V3 to_light;     /* unit */
    double distance; /* scene units; of parallel lights: to their plane, may be negative */
    Rgb color;       /* colour times spot, cylinder and distance attenuation; black: none */
} LightSample;

/* Return the light of `light` at p as if its centre were at `location` (light->location, or a
 * point of its area). */
LightSample light_at(const Light *light, V3 location, V3 p);

/* Return the attenuation by the light's cone or beam at p (no distance fading). */
double light_shape_factor(const Light *light, V3 location, V3 p);

/* Return 2/(1+(d/fade_distance)^fade_power), or 1 for a light without fading. */
double light_fade(const Light *light, double distance);

/* Return the brightness per unit of incoming light that a layer sends to wo (diffuse term:
 * colour, opacity and what is above included; cosine and highlights included). */
Rgb layer_direct(const SurfaceLayer *layer, const SurfaceSample *s, V3 to_light,
                 bool has_highlights, bool is_double_illuminated);

/* Return the diffuse reflectance of all layers together (for irradiance from photons): sum of
 * above * opacity * color * diffuse. */
Rgb surface_diffuse(const SurfaceSample *s);

/* Photons at glancing angles count as if they came at this cosine: their power is spread over the
 * surface already, and what depends on the direction must not be divided by next to nothing. */
#define PHOTON_COSINE_MIN 0.1

/* Return the diffuse reflectance for light from one direction (unit), as the roulette of a photon
 * wants it: of a finish with brilliance, cosine^(brilliance - 1) times as much. */
Rgb surface_diffuse_from(const SurfaceSample *s, V3 from);

/* Return true if that depends on the direction. */
bool surface_has_brilliance(const SurfaceSample *s);
/* Return the diffuse reflectance for light from all directions alike. */
Rgb surface_diffuse_even(const SurfaceSample *s);

/* Return how much of the light that comes to the other side shows on this one. */
Rgb surface_diffuse_back(const SurfaceSample *s);

/* Return what a surface gives off: emission, ambient light where it counts, and in unlit pictures
 * the pigment itself. */
Rgb surface_glow(const Tracer *tracer, const SurfaceSample *s);

/* Return what the sky spheres show in a direction; *seen is the part of the background that shows
 * through them. */
Rgb sky_glow(const Tracer *tracer, V3 direction, Rgb *seen);

/* Return the light that comes to surfaces from the sky spheres and the background. */
Rgb sky_light_from(const Tracer *tracer, V3 direction);

#endif
