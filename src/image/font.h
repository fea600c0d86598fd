/* Fonts: the outlines of glyphs, through FreeType.
 *
 * Lengths are in ems: the size of the letters is 1.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_IMAGE_FONT_H
#define PMS_IMAGE_FONT_H

#include "base/arena.h"
#include "base/diag.h"
#include "math/spline_curve.h"

#include <stdbool.h>
#include <stdint.h>

typedef struct Font Font;

/* Read the font file at `path`.  ERR_FILE or ERR_MEMORY, the message given.  Free with
 * font_close.  One thread at a time. */
Status font_open(Diag *diag, const char *path, Font **out);
void font_close(Font *font);

/* The form of a glyph: closed loops, one after another, filled even-odd. */
typedef struct Glyph {
    double advance; /* to where the next glyph begins */
    double left;    /* of its leftmost point; 0: it is blank */
    int degree;     /* of the spans */
    uint32_t span_count;
    CurveSpan *spans; /* in `arena` */
} Glyph;

/* Return the number of the glyph of a character (16 bits); 0, a box, if there is none. */
uint32_t font_glyph_number(const Font *font, uint32_t character);

/* Load the outline of a glyph. */
Status font_glyph(Diag *diag, Font *font, uint32_t number, Arena *arena, Glyph *out);

/* Return how much nearer (negative) or further the second of two glyphs stands. */
double font_kerning(const Font *font, uint32_t first, uint32_t second);

#endif
