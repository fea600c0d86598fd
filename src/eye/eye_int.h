/* Inside the eye pass.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_EYE_EYE_INT_H
#define PMS_EYE_EYE_INT_H

#include "eye/camera.h"
#include "eye/eye.h"

/* A light as the pass uses it. */
typedef struct EyeLight {
    const Light *light;
    int index; /* among the scene's lights */
    bool has_shadow, is_area, has_highlights;
    bool is_met;         /* paths may meet it, where it has a size */
    bool makes_caustics; /* the caustic map alone brings what targets refract of it */
    bool lights_media;   /* media scatter its light */
    bool makes_volume;   /* the volume map alone brings what targets refract of it */
} EyeLight;

/* Radiance along a ray, by where the light comes from. */
typedef struct Radiance {
    Rgb part[PART_COUNT];
    float transmit; /* what the ray lets through of a picture behind everything */
} Radiance;

/* The sequences of points that the paths of a pixel draw from, and the number of the path. */
typedef struct PathKeys {
    uint64_t choice, bounce, wave;
    uint64_t gather; /* of gather rays in one of many passes; another one at each point */
    uint32_t index;
} PathKeys;

/* Records made in a row of a round that fills the irradiance cache. */
typedef struct FreshRecords {
    struct IrradianceRecord *items;
    size_t count, capacity;
    struct IrradianceCache *near; /* those where gather rays saw what is near by */
    bool is_last;  /* what the picture would use is enough: the rest is made up for */
    bool is_short; /* memory ran out */
} FreshRecords;

struct EyeThread {
    TraceThread trace;
    const Scene *scene;
    const Plan *plan;
    EyeOptions options;
    GatherScratch *gather;
    EyeLight *lights;
    int light_count;
    bool has_air; /* media, fog or rainbows */
    CameraRays camera;
    double pixel, pixel_angle;  /* width of a pixel: scene units, and more of them per scene unit
                                   of distance */
    bool has_eye_point;         /* all camera rays start at one point */
    Interiors camera_interiors; /* around that point */
    double *blur_limits;        /* variance of the mean below which n rays are enough */
    Rng rng;                    /* of the sample being traced */
    uint64_t eye_pass, path_pass, media_pass; /* what the random numbers of samples are of */
    FreshRecords *fresh;        /* not NULL: the cache is being filled, no picture made */
    const EyeWitness *witness;  /* NULL: nobody */
    PathKeys path;
    /* Shadow samples of the area light at hand, valid where the mark is the current one. */
    Rgb *grid;
    uint32_t *grid_marks, grid_mark;
};

/* Rays of focal blur before their variance is looked at. */
enum { BLUR_MIN = 8 };

/* The two axes of an area light as seen from a point in direction to_light of it. */
typedef struct AreaFrame {
    V3 axis1, axis2;
} AreaFrame;
AreaFrame area_frame(const Light *light, V3 to_light);

/* Return how far point (i, j) of an area light's grid lies from its centre.  rng is used by a
 * light with jitter. */
V3 area_offset(const Light *light, const AreaFrame *frame, int i, int j, Rng *rng);

/* Return a point of a light as seen from p: of an area light any of its grid. */
V3 light_point(EyeThread *eye, const EyeLight *light, V3 p);

/* Return the fraction of an area light's light that arrives, averaged over its grid as the
 * language does it; `center` is the light as seen from its centre. */
Rgb area_shadow(EyeThread *eye, const EyeLight *light, const SurfaceSample *s,
                const LightSample *center);

/* Return the light that all layers of s send to the viewer per unit of light from a direction. */
Rgb layers_direct(const SurfaceSample *s, V3 to_light, bool has_highlights);

/* Return the light of all light sources that a surface sends to the viewer. */
Rgb direct_light(EyeThread *eye, const SurfaceSample *s, bool has_highlights);

/* Return the light of the caustic map (of the global map) that a surface sends to the viewer. */
LightEstimate caustic_light(EyeThread *eye, const SurfaceSample *s);
LightEstimate mapped_light(EyeThread *eye, const SurfaceSample *s);

/* Return the indirect light that a surface sends to the viewer, by final gathering.
 *
 * inside  the interiors before it.
 * weight  how much of the picture it can be, at most. */
LightEstimate gathered_light(EyeThread *eye, const SurfaceSample *s, const Interiors *inside,
                             float weight);

/* Return what a ray that met nothing sees.  transmit: how much of a picture behind the sky shows
 * through it; nothing in a mirror. */
Rgb sky_light(const EyeThread *eye, V3 direction, bool is_mirrored, float *transmit);

/* Add light, of which `through` arrives, to a part. */
void add_part(Radiance *out, LightPart part, Rgb through, Rgb light);

/* The same of the light of a photon map, with its errors. */
void add_estimate(Radiance *out, LightPart part, Rgb through, const LightEstimate *estimate);

/* Bend the sum of the parts to sum^(1/exponent), each part in proportion. */
void apply_exponent(Radiance *light, float exponent);

/* Set depth, normal and albedo from the first surface. */
void describe_first(const Hit *hit, const SurfaceSample *s, EyeSample *first);

/* Trace a camera ray; depth, normal and albedo of `first` are taken from the first surface. */
void camera_radiance(EyeThread *eye, const Ray *ray, const Interiors *interiors, Radiance *out,
                     EyeSample *first);

/* Follow one path from the camera, chosen at random; else as camera_radiance.  The mean over
 * many is the light along the ray.  Uses eye->path. */
void path_radiance(EyeThread *eye, const Ray *ray, const Interiors *interiors, Radiance *out,
                   EyeSample *first);

/* Where a path meets a light. */
typedef struct LightMeeting {
    double t;     /* of the ray */
    Rgb radiance; /* towards where the ray comes from */
} LightMeeting;

/* Return true if the ray, up to tmax, meets a light that is a disk of light_radius where it has
 * no area of its own (0: then it is never met).
 *
 * length  gone before the ray by the light that goes back along it, from the diffuse surface it
 *         is for; scene units. */
bool light_meet(const Light *light, double light_radius, const Ray *ray, double tmax,
                double length, LightMeeting *out);

/* Tell the witness of a ray.
 *
 * hit    what it meets; NULL: nothing.
 * light  that the sample has got from there. */
void witness_tell(const EyeThread *eye, const Ray *ray, RayKind kind, int level, const Hit *hit,
                  Rgb through, Rgb light);

/* Return the light of all parts. */
static inline Rgb radiance_sum(const Radiance *r)
{
    return rgb_add(rgb_add(r->part[PART_DIRECT], r->part[PART_CAUSTIC]), r->part[PART_INDIRECT]);
}

/* Fill limits[0..n] for up to n rays: the average of m is good enough when its variance is
 * below limits[m]. */
void blur_limits_fill(double *limits, int n, double variance, double confidence);

#endif
