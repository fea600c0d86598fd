/* What the files of trace/ share.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TRACE_TRACE_INT_H
#define PMS_TRACE_TRACE_INT_H

#include "accel/accel.h"
#include "trace/trace.h"
#include "trace/view_index.h"

/* What an object does to a shadow ray. */
typedef enum ShadowKind {
    SHADOW_NONE,   /* nothing */
    SHADOW_TARGET, /* lets some pass, unless photon targets block: all of it is one */
    SHADOW_FILTER, /* lets some pass */
    SHADOW_BLOCK   /* every hit blocks */
} ShadowKind;

/* Per object, what queries ask for again and again. */
typedef struct TracedObject {
    const Shape *shape;
    V3 center;              /* of a ball around it */
    double radius, radius2; /* of the ball */
    bool has_ball;          /* and the ball is worth a test */
    uint8_t shadow;         /* ShadowKind */
    bool is_hidden[RAY_KIND_COUNT];
    bool is_closed; /* made of closed solids: normals tell entering from leaving */
    bool may_transmit; /* some surface of it lets light through */
    bool keeps_air_out; /* not hollow, shadow rays may be inside of it, and there is air to keep out
                         */
} TracedObject;

/* Objects grouped for bundles of shadow rays. */
typedef struct BundleIndex BundleIndex;
BundleIndex *bundle_index_new(const TracedObject *objects, uint32_t object_count); /* or NULL */
void bundle_index_free(BundleIndex *index);

struct Tracer {
    const Scene *scene;
    const Plan *plan;
    TracedObject *objects;   /* as scene->objects */
    BoxIndex *index;         /* over the bounded objects; NULL: there are none */
    uint32_t *index_objects; /* item of the index to object; ascending */
    uint32_t *unbounded;     /* objects apart, ascending */
    uint32_t unbounded_count;
    uint32_t *clear; /* solids a ray may be inside of, ascending */
    uint32_t clear_count;
    uint32_t *media; /* solids with media in them that are seen, ascending */
    uint32_t media_count;
    uint32_t solid_count; /* objects that keep air out */
    BundleIndex *bundles;
    ViewIndex *camera_view;  /* NULL: none */
    ViewIndex **light_views; /* per light; NULL: none */
    struct ShadowView **shadow_views; /* per light; NULL: none */
    Bound bound;
    bool has_dispersion;
    const Interior **light_interiors; /* per light: what it stands in, NULL: nothing that absorbs */
};

enum { NO_OBJECT = UINT32_MAX };

/* Return true if the ray passes an object by; false proves nothing.  The slack is above the
 * rounding of the sums. */
static inline bool object_is_missed(const TracedObject *object, const Ray *ray)
{
    if (!object->has_ball)
        return false;
    V3 to = v3_sub(object->center, ray->o);
    double along = v3_dot(to, ray->d), far2 = v3_len2(to);
    double limit = object->radius2 + far2 * 1e-12;
    return far2 - along * along > limit || (along < 0 && far2 > limit);
}

/* Which texture a surface shows at a point; several are blended between the corners of a mesh
 * triangle and the components of a blob. */
typedef struct TextureChoice {
    const Texture *texture[SHAPE_BLEND_MAX];
    float weight[SHAPE_BLEND_MAX]; /* add up to 1 */
    int count;
    V2 uv; /* of the point, if one of them depends on that */
} TextureChoice;

/* Choose the texture of a surface point.
 *
 * part, u, v  of the crossing or hit.
 * p           the point in the world.
 * is_inside   met from the inside. */
void texture_choose(const Surface *surface, const Shape *leaf, uint32_t part, double u, double v,
                    V3 p, bool is_inside, TextureChoice *out);

/* The factor of metallic highlights and reflection at a cosine: from 1 at grazing angles to the
 * surface's colour. */
Rgb metallic_tint(float metallic, double cosine, Rgb color);

/* The factor of thin-film interference; both cosines are taken by magnitude. */
Rgb irid_factor(const Finish *finish, Rgb wavelength, double cos_light, double cos_view);

/* One surface that a ray passes. */
typedef struct Passage {
    uint32_t object;
    const Interior *interior;
    bool is_entering; /* by the normal; ignored for objects that are not closed */
    bool is_wall;
} Passage;

enum { PASSAGES_MAX = 1 + HIT_TIES_MAX };

/* What becomes of the interiors of a ray. */
typedef struct InteriorStep {
    double ior_from, ior_to; /* at the ray's wavelength; equal: no bend */
    int spectrum; /* bands that light of all wavelengths is dispersed into; 0: it is not */
} InteriorStep;

/* Pass surfaces in one place, those left before those entered; `after` is set to what a ray in
 * `before` is in then. */
InteriorStep interiors_pass(const Tracer *tracer, const Passage *passages, int count,
                            const Interiors *before, Interiors *after);

/* Add what is entered to a list; take off what is left, returning false if it was not there. */
void interiors_enter(Interiors *list, const Interior *interior, uint32_t object);
bool interiors_leave(Interiors *list, const Interior *interior, uint32_t object);

/* Return which way a crossing at a point leads. */
static inline bool crossing_is_entering(const Crossing *crossing, V3 ng, V3 d)
{
    return crossing->leaf_change != 0 ? crossing->leaf_change > 0 : v3_dot(ng, d) < 0;
}

#endif
