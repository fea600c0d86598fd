/* The photon pass: budgets, emission, walks, maps, and the books.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_PHOTON_PHOTON_PASS_H
#define PMS_PHOTON_PHOTON_PASS_H

#include "photon/irradiance.h"
#include "photon/photon_map.h"
#include "trace/trace.h"

/* Per source of light: what it was given and what became of it.  emitted = stored_paths +
 * absorbed + escaped + cut, exactly; so for the flux, to rounding.
 *
 * The language's light has as much flux as the way it goes is long, so a path's flux is what it
 * would be at the surface where the path ended (for stored ones: was first stored); what it lost
 * on the way to there counts as absorbed.  Paths that meet no surface have none.
 *
 * Which paths a map holds, and so what may be added up: caustic L S+ D, from a target on;
 * global L S* D (S* D)+, every hit after a first diffuse reflection; the first diffuse hit itself
 * is direct light, by shadow rays, or the caustic map's.  For final gathering the global map holds
 * that too, L (S* D)+.  Light of surfaces and sky, which no shadow ray brings, is always there.
 * Volume: places in media, see MapKind in walk_int.h. */
typedef struct LightBooks {
    char name[32]; /* of the light, of the object that glows, or "sky" */
    double power; /* flux onto the targets (caustic) or into the scene (global), summed RGB */
    double share; /* of the budget, 0 to 1 */
    uint64_t budget, emitted, stored_paths, absorbed, escaped, cut;
    uint64_t stored; /* photons */
    uint64_t seen;   /* of these, that an estimate of the eye pass was made from; if watched */
    Rgb flux_emitted, flux_stored, flux_absorbed, flux_escaped, flux_cut;
    /* What the photons lost to surfaces and ways, as their reflectances say, and what the dice left
     * them, as shares of what each started with: 1 but for chance, and its standard error. */
    Rgb balance, balance_error;
} LightBooks;

typedef struct PhotonBooks {
    LightBooks *caustic, *global; /* NULL when that map is not made */
    LightBooks *volume;           /* of all photons in media together */
    int caustic_count;            /* the lights of the scene */
    int global_count;             /* the lights, the objects that glow, the sky if it shines */
    int volume_count;             /* as either, the larger that takes part */
} PhotonBooks;

/* Photons of a source, up to number `end`, in the order they were sent in. */
typedef struct PhotonRun {
    uint64_t end;
    int source;
} PhotonRun;

/* Where the photons of a watched map came from. */
typedef struct PhotonOrigins {
    uint32_t *order; /* the number of each photon of the map in the order they were sent in */
    PhotonRun *runs;
    int run_count;
} PhotonOrigins;

typedef struct PhotonMaps {
    PhotonMap *caustic, *global, *volume; /* NULL: the plan does not call for it */
    IrradianceMap *irradiance;            /* for final gathering; NULL: not called for */
    double caustic_radius, global_radius; /* gather radii, scene units */
    double caustic_far, global_far;       /* how far a gather may widen that finds too little */
    bool has_no_caustics, has_no_focus;   /* no light reaches a target: for surfaces, for media */
    PhotonBooks books;
    PhotonOrigins caustic_from, global_from, volume_from; /* if watched */
} PhotonMaps;

/* A pass for a picture in small, to see what one in full will take: with fewer photons, whose
 * estimates reach as much further as its pixels are wider. */
typedef struct Miniature {
    double side;    /* of its pixels, in those of the full picture */
    double photons; /* part of the photons that is sent */
} Miniature;

/* Return of how many photons an estimate in small is made for one of a full picture: as a part. */
double miniature_gather(const Miniature *miniature);
/* Return how many photons an estimate of `most` takes in small, from an area or, in media, from a
 * ball; NULL: a full picture. */
int miniature_photons(const Miniature *miniature, int most);
int miniature_ball(const Miniature *miniature, int most);
/* Return the radius of an estimate in small, whose radius in full was asked for. */
double miniature_radius(const Miniature *miniature, double radius);

typedef struct PhotonOptions {
    uint64_t seed;
    int threads;
    double part;    /* of the photons that the scene asks for; 0: all */
    double shrink;  /* of the radii that irradiance is estimated over ahead; 0: all of them */
    bool is_repeat; /* what there is to warn of was said in a pass before */
    bool is_watched; /* keep which photons are seen, and where they came from */
    const Miniature *miniature; /* NULL: a full picture */
    bool is_full;   /* photons keep their light in full precision beside the 20 bytes */
    bool has_radii; /* the caller knows the gather radii: they are left 0 */
    void (*progress)(void *ctx, double fraction);
    void *progress_ctx;
} PhotonOptions;

/* Share `total` items by weight with largest-remainder rounding: the shares add up exactly;
 * weight 0 gets none.  All weights 0: all shares 0. */
void photon_budget(const double *weights, int count, uint64_t total, uint64_t *shares);

/* Fill the power, share and budget of every light (a small pilot emission), without tracing
 * the rest: what `explain` prints.  Free with photon_books_done. */
Status photon_plan_budgets(const Tracer *tracer, const PhotonOptions *options, Diag *diag,
                           PhotonBooks *out);
void photon_books_done(PhotonBooks *books);

/* Add the books of a pass to those of `before` passes of the same scene: photons add up; power,
 * share and flux become means.  `from` may be emptied; photon_books_done it all the same. */
void photon_books_add(PhotonBooks *to, PhotonBooks *from, uint64_t before);

/* Run the pass the plan calls for.  Warns and goes on without a map when nothing could be
 * stored.  Counters are added to *stats.  Free with photon_maps_done. */
Status photon_pass(const Tracer *tracer, const PhotonOptions *options, Diag *diag, Stats *stats,
                   PhotonMaps *out);
void photon_maps_done(PhotonMaps *maps);

/* When watched maps have been used, enter into the books what was seen of them. */
Status photon_maps_count_seen(PhotonMaps *maps, Diag *diag);

#endif
