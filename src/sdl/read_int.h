/* What the block readers share.  Each read_* function is named after the rule of grammar/
 * pms.ebnf that it reads; unless told otherwise the next token is the rule's first word.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SDL_READ_INT_H
#define PMS_SDL_READ_INT_H

#include "image/bitmap.h"
#include "sdl/sdl_int.h"

/* --- small helpers ---------------------------------------------------------------------------- */

/* Take the keyword and its opening brace; return the keyword's token. */
Token read_open(Parser *p);

/* Return true, having taken it, if the closing brace of a block comes next. */
bool read_close(Parser *p);

/* Return a terminated copy of the word at a token, without backquotes. */
const char *read_word(Parser *p, const Token *token);

/* Return true if a token is this word; words of pms{} are not reserved. */
bool read_is_word(const Token *token, const char *word);

/* Take one of `words` ("" is none) and return its number; else fail with the list of them and the
 * nearest one.  `what` names what wants it. */
int read_choice(Parser *p, const char *what, const char *const words[], int count);

/* Read a float that must be finite; `what` names it in messages; *span gets its place. */
double read_finite(Parser *p, const char *what, Span *span_or_null);

/* Read a finite float that must be above 0, or at least 0. */
double read_above_zero(Parser *p, const char *what);
double read_not_negative(Parser *p, const char *what);

/* Read a float or vector of colour components and check that it is finite. */
Rgb read_rgb(Parser *p, const char *what);

/* Return a list of the scene arena with one more node; the old one stays as it is, as others may
 * share it. */
const void *const *read_append(Parser *p, const void *const *list, int *count, const void *node);

/* Grow a full array of the scene arena for one more item. */
void *read_grow(Parser *p, void *items, size_t count, size_t *capacity, size_t item_size);

/* --- objects ------------------------------------------------------------------------------- */

/* Read an object if the next token begins one (a keyword or the name of an object); NULL if
 * not.  The node is the caller's own. */
Node *read_object(Parser *p);

/* The same for keywords only, not for names. */
Node *read_object_block(Parser *p);

/* Make a leaf, or a node without anything (for shapes too small to be seen). */
Node *read_leaf(Parser *p, const Shape *shape);
Node *read_empty(Parser *p);

/* Index a mesh and make its leaf. */
Node *read_mesh_leaf(Parser *p, MeshData *mesh);

/* The parameters between a shape's brace and its modifiers. */
Node *read_sphere(Parser *p);
Node *read_box(Parser *p);
Node *read_cylinder(Parser *p);
Node *read_cone(Parser *p);
Node *read_torus(Parser *p);
Node *read_blob(Parser *p);
Node *read_superellipsoid(Parser *p);
Node *read_quadric(Parser *p);
Node *read_cubic(Parser *p);
Node *read_quartic(Parser *p);
Node *read_poly(Parser *p);
Node *read_polynomial(Parser *p);
Node *read_plane(Parser *p);
Node *read_disc(Parser *p);
Node *read_triangle(Parser *p);
Node *read_smooth_triangle(Parser *p);
Node *read_polygon(Parser *p);
Node *read_text(Parser *p);
Node *read_bicubic_patch(Parser *p);
Node *read_prism(Parser *p);
Node *read_lathe(Parser *p);
Node *read_sor(Parser *p);
Node *read_ovus(Parser *p);
Node *read_sphere_sweep(Parser *p);
Node *read_height_field(Parser *p);
Node *read_mesh(Parser *p);
Node *read_mesh2(Parser *p);
Node *read_isosurface(Parser *p);
Node *read_parametric(Parser *p);
Node *read_julia_fractal(Parser *p);
Node *read_union(Parser *p);
Node *read_merge(Parser *p);
Node *read_intersection(Parser *p);
Node *read_difference(Parser *p);

/* contained_by and its box or sphere. */
const Shape *read_container(Parser *p);

/* Read a number that must be above 0; others are warned of, as in POV-Ray, and not used: 0. */
double read_positive(Parser *p, const char *what, Span *span);

/* light_source, after its opening brace up to and including the closing one. */
Node *read_light_source(Parser *p);

/* Read the kind (if given), name and gamma of an image file, and the file, found as include files
 * are; returns the gamma, 1 if none is given.  bitmap_done is the caller's. */
double read_image_file(Parser *p, Bitmap *out);

/* Modifiers up to and including the closing brace of the object. */
void read_object_modifiers(Parser *p, Node *node, TokenKind object_word);

/* Read a modifier of how the object looks; returns false if none comes next. */
bool read_look(Parser *p, Node *node);

/* The items of clipped_by and bounded_by. */
void read_clipped_by(Parser *p, Node *node);
void read_bounded_by(Parser *p, Node *node);

/* photons{} of an object; changes what is given. */
void read_object_photons(Parser *p, PhotonFlags *flags);

/* A triangle without area, or with a normal without direction, is dropped with a warning. */
bool read_triangle_is_flat(const V3 corner[3]);

/* --- looks --------------------------------------------------------------------------------- */

/* Blocks with their keyword.  `base` is what they start from and is not changed. */
const Pigment *read_pigment(Parser *p, const Pigment *base);
const Finish *read_finish(Parser *p, const Finish *base);
const Texture *read_texture(Parser *p);

/* Return a pigment or texture that sees uv. */
const Pigment *read_as_uv(Parser *p, const Pigment *pigment);
const Texture *read_texture_as_uv(Parser *p, const Texture *texture);
const Interior *read_interior(Parser *p, const Interior *base_or_null);
const Material *read_material(Parser *p);

/* Read an index of refraction; one that cannot be becomes 1 with a warning. */
double read_ior(Parser *p);

/* pms{} of an interior. */
void read_pms_interior(Parser *p, Interior *interior);

const ColorMap *read_color_map(Parser *p);

/* Read what a pigment is made of (colour, checker, gradient ...) if that comes next. */
bool read_pigment_type(Parser *p, Pigment *pigment);

/* Read one modifier of a pigment into *pigment; fails on anything else. */
void read_pigment_modifier(Parser *p, Pigment *pigment);

/* media{} and what is in it. */
const Medium *read_media(Parser *p);
const Density *read_density(Parser *p);
const Density *read_density_map(Parser *p);

/* Return a texture with another pigment or finish in its top layer. */
const Texture *read_with_pigment(Parser *p, const Texture *texture, const Pigment *pigment);
const Texture *read_with_finish(Parser *p, const Texture *texture, const Finish *finish);

/* Return `over` laid on `under`; `under` may be NULL. */
const Texture *read_layers(Parser *p, const Texture *under, const Texture *over);

/* Return the texture objects start from (#default). */
const Texture *read_default_texture(Parser *p);

/* --- the rest of a scene ------------------------------------------------------------------- */

const Camera *read_camera(Parser *p);
const Sky *read_sky_sphere(Parser *p);
const Fog *read_fog(Parser *p);
const Rainbow *read_rainbow(Parser *p);
void read_background(Parser *p);
void read_global_settings(Parser *p);
void read_global_photons(Parser *p, PhotonSettings *photons);
void read_pms_settings(Parser *p, PmsSettings *pms);
void read_radiosity(Parser *p, RadiositySettings *radiosity);

#endif
