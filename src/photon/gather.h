/* Estimates from a photon map.  With volume.h the only header of photon/
 * that the eye pass sees.
 *
 * What is near: with GATHER_SPHERE the distance d.  With GATHER_DISK the ball is cut to a slab
 * along the tangent plane, GATHER_SLAB radii thick on either side: the distance is the larger
 * of d and |height above the plane| / GATHER_SLAB.  Both count exactly pi r^2 of area on a flat
 * surface, and on a ball of radius R as long as r < 2 GATHER_SLAB R (a cap within distance r of
 * a point of a sphere has area pi r^2 exactly), so neither is biased by curvature.
 *
 * How much each counts: the photon that sets the radius is left out, the others are weighted by
 * a kernel whose mean over the disk is 1 and divided by pi r^2.  A search that had to widen counts
 * what is far off least (Epanechnikov's kernel instead of none), so that a caustic does not spill
 * into the dark around it.  On a uniform field the mean of
 * every estimate is then the true irradiance, for any k (a flat sum of all k would be too bright
 * by k/(k-1)).  So it is if only a part of the radius counts (shrink): where the k - 1 photons
 * lie within the radius that the k-th sets is independent of it.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_PHOTON_GATHER_H
#define PMS_PHOTON_GATHER_H

#include "math/rgb.h"
#include "math/v3.h"
#include "photon/photon_map.h"
#include "scene/scene.h"

/* Half the thickness of the slab of GATHER_DISK, in radii. */
#define GATHER_SLAB 0.2

/* Which photons count on the surface of a solid: those that arrived at its outside, at its inside,
 * or all. */
typedef enum GatherSide { GATHER_ALL_SIDES, GATHER_OUTSIDE, GATHER_INSIDE } GatherSide;

typedef struct GatherLimits {
    int max_photons;   /* k nearest; 0: everything within max_radius */
    int min_photons;   /* when fewer are within max_radius, the radius grows to hold so many, up
                          to far_radius; 0: it never grows */
    double max_radius; /* scene units; may be infinite if max_photons is not 0 */
    double far_radius; /* not above max_radius: it never grows */
    GatherShape shape; /* disk: flattened to the surface; sphere */
    GatherKernel kernel;
    double normal_cosine; /* photons whose surface normal is further off are ignored; -1: none
                             is.  Above 0 those that arrived on the other side never count. */
    GatherSide side;      /* when normals are looked at; see gather_side */
    bool has_error;       /* errors are estimated too */
    double shrink;        /* of the radius that was found only so much counts; 0: all of it */
} GatherLimits;

/* Return which photons count for the light of that side of a surface that n points to. */
static inline GatherSide gather_side(const ShapePoint *at, V3 n)
{
    return shape_point_is_inside(at, n) ? GATHER_INSIDE : GATHER_OUTSIDE;
}

/* Return limits for that side. */
static inline GatherLimits gather_limits_at(const GatherLimits *limits, const ShapePoint *at, V3 n)
{
    GatherLimits own = *limits;
    own.side = gather_side(at, n);
    return own;
}

#define GATHER_LIMITS_DEFAULT                                                                      \
    ((GatherLimits){.max_photons = 100,                                                            \
                    .min_photons = 20,                                                             \
                    .max_radius = INFINITY,                                                        \
                    .shape = GATHER_DISK,                                                          \
                    .kernel = KERNEL_FLAT,                                                         \
                    .normal_cosine = 0.5})

/* Return the most photons an estimate takes: what photons{} says, or the default. */
int gather_most(const PhotonSettings *photons);

/* One photon of an estimate, decoded: power already weighted by kernel and area, so that the
 * sum over all is the irradiance. */
typedef struct GatheredPhoton {
    V3 from; /* unit, towards where it came from */
    Rgb irradiance;
    float excess; /* of it, what an estimate on half the area would not have (negative: what it
                     would have more), as a share; 0 without limits.has_error */
} GatheredPhoton;

/* An estimate, and with limits.has_error how wrong it may be; else blur and noise are black.
 *
 * Where light changes slowly, an estimate is off by a term that goes as the area it is taken over
 * (the second derivative of the light times r^2).  So what half the area would give less is, in the
 * mean over many estimates, half of the error. */
typedef struct LightEstimate {
    Rgb light; /* irradiance, or what a surface sends on of it */
    Rgb blur;  /* above that on half the area */
    Rgb noise; /* standard error: photons come as by chance, independent of each other */
} LightEstimate;

/* Add to an estimate what a surface sends on of another one. */
static inline void light_estimate_add(LightEstimate *to, Rgb share, const LightEstimate *from)
{
    to->light = rgb_add(to->light, rgb_mul(share, from->light));
    to->blur = rgb_add(to->blur, rgb_mul(share, from->blur));
    if (!rgb_is_black(from->noise))
        to->noise = rgb_hypot(to->noise, rgb_mul(share, from->noise));
}

/* Working memory of one thread; grows to what is gathered.  It remembers the last radius to
 * start the next search well; results do not depend on that. */
typedef struct GatherScratch GatherScratch;
GatherScratch *gather_scratch_new(void); /* NULL when memory is out */
void gather_scratch_free(GatherScratch *scratch);

/* Estimate irradiance at p from the photons in `map`.
 *
 * p, n    scene units; n unit, the geometric normal on the side of the viewer.
 * out     irradiance per channel, in the lights' own unit; black if nothing was found.
 *
 * Returns the number of photons used.  Never fails (if memory runs out the radius shrinks to
 * what fits).  Any thread.  O(k + log n). */
int photon_gather(const PhotonMap *map, V3 p, V3 n, const GatherLimits *limits,
                  GatherScratch *scratch, Rgb *out);

/* The same with its errors, as limits->has_error asks. */
int photon_gather_estimate(const PhotonMap *map, V3 p, V3 n, const GatherLimits *limits,
                           GatherScratch *scratch, LightEstimate *out);

/* The same, but hands out the photons, for surfaces that are not merely diffuse.  The array is
 * the scratch's, valid until its next use. */
int photon_gather_list(const PhotonMap *map, V3 p, V3 n, const GatherLimits *limits,
                       GatherScratch *scratch, const GatheredPhoton **out);

/* Note that the photons of the last estimate with `scratch`, from a watched map, were seen. */
void photon_gather_see(const PhotonMap *map, const GatherScratch *scratch);

/* Find the photons an estimate would use: their numbers (photon_map_at) in no particular order,
 * and the square of the radius.  Of photons equally far the lower number is nearer. */
int photon_nearest(const PhotonMap *map, V3 p, V3 n, const GatherLimits *limits,
                   GatherScratch *scratch, const uint32_t **out, double *radius2);

/* Return the weight of a kernel at squared distance x = d^2/r^2 in [0,1].  The mean over the
 * disk, x uniform, is 1, but for KERNEL_GAUSSIAN_JENSEN, whose printed constant loses 46.9 %. */
double gather_kernel(GatherKernel kernel, double x);

/* Return the variance of an estimate's blur over that of its light, where light is even: of photons
 * that come as by chance. */
double gather_blur_variance(GatherKernel kernel);

/* Return the search radius for a map: within it four in five of the map's photons have
 * max_photons around them, so that only the faintest of a caustic is seen as single photons.
 * Scene units; 0 for an empty map.  Deterministic. */
double photon_map_radius(const PhotonMap *map, int max_photons);

#endif
