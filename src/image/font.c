/* Fonts, through FreeType.  SPDX-License-Identifier: Apache-2.0 */
#include "image/font.h"

#include "base/file.h"
#include "base/mem.h"

#include <math.h>
#include <string.h>

#include <ft2build.h>
#include FT_FREETYPE_H
#include FT_MODULE_H
#include FT_OUTLINE_H

enum {
    FONT_BYTES_MAX = 1 << 28,
    SYMBOL_CODES = 0xF000 /* where fonts of symbols have their characters */
};

struct Font {
    struct FT_MemoryRec_ memory;
    FT_Library library;
    FT_Face face;
    Arena *arena; /* holds the file */
    const char *path;
    double em;
};

static void *font_alloc(FT_Memory memory, long size)
{
    (void)memory;
    return mem_alloc((size_t)size);
}

static void font_free(FT_Memory memory, void *block)
{
    (void)memory;
    mem_free(block);
}

static void *font_realloc(FT_Memory memory, long before, long size, void *block)
{
    (void)memory, (void)before;
    return mem_resize(block, (size_t)size);
}

static Status refuse(Diag *diag, const Font *font, FT_Error error)
{
    if (error == FT_Err_Out_Of_Memory)
        return diag_no_memory(diag, font->path);
    return diag_fail(diag, ERR_FILE,
                     "cannot read '%s': FreeType finds no outlines in it (error %d)", font->path,
                     (int)error);
}

static Status open_face(Diag *diag, const char *path, Font *font)
{
    const char *bytes;
    size_t size;
    font->arena = arena_new();
    if (!font->arena)
        return diag_no_memory(diag, path);
    font->path = arena_strndup(font->arena, path, strlen(path));
    if (!font->path)
        return diag_no_memory(diag, path);
    TRY(file_read(diag, path, FONT_BYTES_MAX, font->arena, &bytes, &size));
    font->memory = (struct FT_MemoryRec_){NULL, font_alloc, font_free, font_realloc};
    FT_Error error = FT_New_Library(&font->memory, &font->library);
    if (error)
        return refuse(diag, font, error);
    FT_Add_Default_Modules(font->library);
    error =
        FT_New_Memory_Face(font->library, (const FT_Byte *)bytes, (FT_Long)size, 0, &font->face);
    if (error || !FT_IS_SCALABLE(font->face) || font->face->units_per_EM == 0)
        return refuse(diag, font, error);
    font->em = font->face->units_per_EM;
    /* Without Unicode, any table of characters will do. */
    if (!font->face->charmap && font->face->num_charmaps > 0)
        FT_Set_Charmap(font->face, font->face->charmaps[0]);
    return OK;
}

Status font_open(Diag *diag, const char *path, Font **out)
{
    Font *font = mem_alloc(sizeof *font);
    *out = NULL;
    if (!font)
        return diag_no_memory(diag, path);
    Status status = open_face(diag, path, font);
    if (status == OK)
        *out = font;
    else
        font_close(font);
    return status;
}

void font_close(Font *font)
{
    if (!font)
        return;
    if (font->library)
        FT_Done_Library(font->library); /* and its face */
    arena_free(font->arena);
    mem_free(font);
}

uint32_t font_glyph_number(const Font *font, uint32_t character)
{
    FT_UInt number = FT_Get_Char_Index(font->face, character);
    return number ? number : FT_Get_Char_Index(font->face, SYMBOL_CODES | character);
}

double font_kerning(const Font *font, uint32_t first, uint32_t second)
{
    FT_Vector kerning;
    if (FT_Get_Kerning(font->face, first, second, FT_KERNING_UNSCALED, &kerning))
        return 0;
    return (double)kerning.x / font->em;
}

/* --- outlines ------------------------------------------------------------------------------ */

/* An outline on its way into spans. */
typedef struct Tracing {
    CurveSpan *spans;
    uint32_t count;
    int degree;
    double em;
    FT_Vector start, at;
} Tracing;

static double part_way(double a, double b, double t)
{
    return a + (b - a) * t;
}

/* Add a curve of `degree` to the point at its end, raised to the degree of all. */
static void add_span(Tracing *t, int degree, const FT_Vector *points)
{
    double c[2][4];
    for (int i = 0; i <= degree; i++) {
        const FT_Vector *p = i ? &points[i - 1] : &t->at;
        c[0][i] = (double)p->x / t->em;
        c[1][i] = (double)p->y / t->em;
    }
    t->at = points[degree - 1];
    CurveSpan *span = &t->spans[t->count++];
    for (int axis = 0; axis < 2; axis++) {
        double *out = axis ? span->b : span->a;
        const double *b = c[axis];
        out[0] = b[0];
        out[t->degree] = b[degree];
        if (degree == t->degree)
            memcpy(out, b, sizeof *b * (size_t)(degree + 1));
        else if (t->degree == 2)
            out[1] = part_way(b[0], b[1], .5);
        else if (degree == 1)
            out[1] = part_way(b[0], b[1], 1 / 3.), out[2] = part_way(b[1], b[0], 1 / 3.);
        else
            out[1] = part_way(b[0], b[1], 2 / 3.), out[2] = part_way(b[2], b[1], 2 / 3.);
    }
}

static int line_to(const FT_Vector *to, void *data)
{
    Tracing *t = data;
    if (to->x != t->at.x || to->y != t->at.y)
        add_span(t, 1, to);
    return 0;
}

static int conic_to(const FT_Vector *control, const FT_Vector *to, void *data)
{
    const FT_Vector points[2] = {*control, *to};
    add_span(data, 2, points);
    return 0;
}

static int cubic_to(const FT_Vector *one, const FT_Vector *two, const FT_Vector *to, void *data)
{
    const FT_Vector points[3] = {*one, *two, *to};
    add_span(data, 3, points);
    return 0;
}

static int move_to(const FT_Vector *to, void *data)
{
    Tracing *t = data;
    line_to(&t->start, t); /* close the loop before */
    t->start = t->at = *to;
    return 0;
}

static bool has_cubics(const FT_Outline *outline)
{
    for (int i = 0; i < outline->n_points; i++)
        if (FT_CURVE_TAG(outline->tags[i]) == FT_CURVE_TAG_CUBIC)
            return true;
    return false;
}

static double leftmost(const Glyph *glyph)
{
    double left = INFINITY;
    for (uint32_t i = 0; i < glyph->span_count; i++)
        left = glyph->spans[i].a[0] < left ? glyph->spans[i].a[0] : left;
    return glyph->span_count ? left : 0;
}

Status font_glyph(Diag *diag, Font *font, uint32_t number, Arena *arena, Glyph *out)
{
    *out = (Glyph){.degree = 2};
    FT_Error error = FT_Load_Glyph(font->face, number, FT_LOAD_NO_SCALE | FT_LOAD_NO_BITMAP);
    FT_GlyphSlot slot = font->face->glyph;
    if (error || slot->format != FT_GLYPH_FORMAT_OUTLINE)
        return refuse(diag, font, error);
    FT_Outline *outline = &slot->outline;
    out->advance = (double)slot->metrics.horiAdvance / font->em;
    /* A point off the curve may stand for two spans, and each loop needs one to close it. */
    size_t room = 2 * (size_t)outline->n_points + (size_t)outline->n_contours + 1;
    Tracing t = {.degree = has_cubics(outline) ? 3 : 2, .em = font->em};
    t.spans = ARENA_ARRAY(arena, CurveSpan, room);
    if (!t.spans)
        return diag_no_memory(diag, font->path);
    static const FT_Outline_Funcs calls = {move_to, line_to, conic_to, cubic_to, 0, 0};
    error = FT_Outline_Decompose(outline, &calls, &t);
    if (error)
        return refuse(diag, font, error);
    line_to(&t.start, &t);
    out->degree = t.degree;
    out->spans = t.spans;
    out->span_count = t.count;
    out->left = leftmost(out);
    return OK;
}
