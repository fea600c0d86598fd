/* Looks: pigments, normals, finishes, and the textures made of them; interiors.
 *
 * All nodes live in the scene arena and are immutable once read: applying a transform makes a
 * new node that wraps or copies the old one.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TEXTURE_TEXTURE_H
#define PMS_TEXTURE_TEXTURE_H

#include "base/arena.h"
#include "base/span.h"
#include "math/rgb.h"
#include "math/xform.h"

/* The language's five-part colour. */
typedef struct Color5 {
    float r, g, b, filter, transmit;
} Color5;

static inline Rgb color5_rgb(Color5 c) { return rgb(c.r, c.g, c.b); }

/* Return what passes through a surface of this colour: filter*rgb + transmit. */
static inline Rgb color5_through(Color5 c)
{
    return rgb(c.filter * c.r + c.transmit, c.filter * c.g + c.transmit,
               c.filter * c.b + c.transmit);
}

typedef enum PatternKind { PATTERN_CHECKER, PATTERN_GRADIENT, PATTERN_COUNT } PatternKind;

typedef enum WaveKind {
    WAVE_RAMP,
    WAVE_TRIANGLE,
    WAVE_SINE,
    WAVE_SCALLOP,
    WAVE_CUBIC,
    WAVE_POLY
} WaveKind;

/* A scalar field over space. */
typedef struct Pattern {
    PatternKind kind;
    V3 direction;             /* gradient: unit */
    float frequency, phase;   /* frequency 0: no wrap */
    WaveKind wave;
    float exponent;           /* WAVE_POLY */
    bool is_transformed;
    Xform xform;              /* pattern space to world space */
} Pattern;

/* Return the pattern's value at a world point: wrapped by frequency and phase, shaped by the
 * wave; block patterns give the number of the entry.  Never fails.  Any thread. */
double pattern_value(const Pattern *pattern, V3 p);

/* Return the world point p where the pattern's own space has it. */
V3 pattern_point(const Pattern *pattern, V3 p);

typedef struct MapEntry {
    float key;
    Color5 color;
} MapEntry;

typedef struct Pigment Pigment;
struct Pigment {
    Span span;
    bool is_solid;                /* color alone */
    bool is_uv;                   /* it sees uv instead of places, and no transform moves it */
    bool has_uv;                  /* it, or one of its list, is such */
    Color5 color;
    Pattern pattern;
    const MapEntry *map;          /* color_map, in written order; NULL for a list */
    int map_count;
    const Pigment *const *list;   /* checker's pigments; NULL for a map */
    int list_count;
};

/* Everything of finish{}, in the language's terms (defaults: FINISH_DEFAULT). */
typedef struct Finish {
    Rgb ambient, emission;
    float diffuse, diffuse_back, brilliance; /* diffuse: albedo factor already applied */
    float phong, phong_size;
    float specular, roughness;
    float metallic;
    Rgb reflection_min, reflection_max;
    float reflection_falloff;
    float reflection_exponent; /* as written: the reflected colour is raised to 1/exponent */
    float reflection_metallic;
    bool is_fresnel, conserves_energy;
    float irid, irid_thickness, irid_turbulence;
    float crand;
    float ior, caustics; /* old place of an interior's; 0: not given */
    /* The amounts were written as albedo: the readers need it when more items follow. */
    bool is_diffuse_albedo, is_phong_albedo, is_specular_albedo;
} Finish;

#define FINISH_DEFAULT                                                                             \
    ((Finish){.ambient = {0.1f, 0.1f, 0.1f},                                                       \
              .diffuse = 0.6f,                                                                     \
              .brilliance = 1,                                                                     \
              .phong_size = 40,                                                                    \
              .roughness = 0.05f,                                                                  \
              .reflection_falloff = 1,                                                             \
              .reflection_exponent = 1})

enum { TEXTURE_LAYERS_MAX = 16 }; /* more are refused */

typedef struct Layer {
    const Pigment *pigment; /* never NULL after scene_check */
    const Finish *finish;   /* never NULL after scene_check */
} Layer;

/* Layers from the bottom (first written) to the top. */
typedef struct Texture {
    Span span;
    const Layer *layers;
    int layer_count; /* at least 1 */
    bool is_uv;      /* uv_mapping stands in its block: it may lie on no other */
} Texture;

typedef struct Medium Medium; /* texture/media.h */

/* How the index of refraction depends on the wavelength. */
typedef enum DispersionKind {
    DISPERSION_NONE,
    DISPERSION_RATIO,    /* a power of the wavelength; coefficient: index of violet over red */
    DISPERSION_CAUCHY,   /* A + B/w^2 + C/w^4 */
    DISPERSION_SELLMEIER /* n^2 = 1 + the sum of B w^2 / (w^2 - C) over pairs B C */
} DispersionKind;

enum { DISPERSION_COEFFICIENTS = 8 }; /* those not given are 0 */

typedef struct Interior {
    Span span;
    double ior;      /* 1: as outside; of formulas at the helium d line */
    bool has_ior;    /* it was written, be it 1 */
    double fade_distance, fade_power; /* scene units; distance 0: no absorption */
    Rgb fade_color;
    float caustics;
    const Medium *const *media; /* in written order; they count in hollow objects only */
    int media_count;
    bool is_hollow; /* of hollow objects: set when the scene is built */
    int priority;   /* where interiors overlap the highest counts; of equals the one entered last */
    DispersionKind dispersion;
    int dispersion_samples; /* wavelengths that the eye sees through it; at least 2 */
    double coefficients[DISPERSION_COEFFICIENTS]; /* w in micrometres */
} Interior;

#define INTERIOR_DEFAULT ((Interior){.ior = 1, .dispersion_samples = 7})

/* Return the pigment's colour at a world point.  Pigments in a list are evaluated at the point
 * the outer pattern sees.  Never fails.  Any thread. */
Color5 pigment_at(const Pigment *pigment, V3 p);

/* The same where the surface has these uv; pigment_at takes the x and y of p. */
Color5 pigment_at_uv(const Pigment *pigment, V3 p, V2 uv);

/* Return true if some pigment of the texture depends on uv. */
bool texture_has_uv(const Texture *texture);

/* Return the colour of a pigment's color_map for a value of its pattern. */
Color5 pigment_map_color(const Pigment *pigment, double value);

/* Return a pigment or texture seen through `xform` (a new node, or the old one when nothing
 * depends on place); NULL when memory is out. */
const Pigment *pigment_transform(Arena *arena, const Pigment *pigment, const Xform *xform);
const Texture *texture_transform(Arena *arena, const Texture *texture, const Xform *xform);

/* Return true if some part of the pigment may let light through (any filter or transmit in any
 * colour it can take); of the texture: if every one of its layers may. */
bool pigment_may_transmit(const Pigment *pigment);
bool texture_may_transmit(const Texture *texture);

/* Return true if any finish of the texture reflects. */
bool texture_may_reflect(const Texture *texture);

/* Return true if some layer may scatter light diffusely: it is not black all over. */
bool texture_may_scatter(const Texture *texture);

/* Return true if some layer may let light through diffusely: by `diffuse a, b`. */
bool texture_may_show_back(const Texture *texture);

/* Return the index of refraction at a wavelength in nm; 0: of light as a whole. */
double interior_ior(const Interior *interior, double wavelength);

/* Set the ior to a formula's; false, without a change, if the formula makes no sense for light. */
bool interior_set_formula(Interior *interior, DispersionKind kind,
                          const double coefficients[DISPERSION_COEFFICIENTS]);

/* Return whether light may be bent where an interior begins in the open. */
static inline bool interior_bends(const Interior *interior)
{
    return interior->ior != 1 || interior->dispersion != DISPERSION_NONE;
}

/* Return the transmittance of `distance` scene units inside an interior.
 *
 * is_shadow  shadow rays ignore fade_power 0, view rays do not. */
Rgb interior_fade(const Interior *interior, double distance, bool is_shadow);

#endif
