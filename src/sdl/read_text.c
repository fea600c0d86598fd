/* text: a union of glyphs, each a prism.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"
#include "sdl/read_int.h"

#include "base/file.h"
#include "image/font.h"

#include <stdio.h>
#include <string.h>

enum { TEXT_GLYPHS_MAX = 100000 };

/* A text, set: which glyphs, and where.  Arrays have an item for each character. */
typedef struct TextSetting {
    uint32_t count, glyph_count;
    uint32_t *characters;
    uint32_t *numbers; /* of the different glyphs, in the font */
    Glyph *glyphs;     /* their forms */
    uint32_t *which;   /* of them each character shows */
    double *kerning;   /* before each character */
} TextSetting;

/* --- which font ---------------------------------------------------------------------------- */

/* Where POV-Ray's own fonts lie when they are installed. */
static const char *find_povray_font(Parser *p, const char *name)
{
    static const char *const folders[] = {
        "/usr/share/povray-3.7/include", "/usr/share/povray-3.8/include",
        "/usr/share/povray/include", "/usr/local/share/povray-3.7/include",
        "/usr/local/share/povray-3.8/include"};
    char path[FILE_PATH_MAX];
    for (size_t i = 0; i < sizeof folders / sizeof folders[0]; i++) {
        int length = snprintf(path, sizeof path, "%s/%s", folders[i], name);
        if (length < FILE_PATH_MAX && file_exists(path))
            return parse_copy(p, path, (size_t)length + 1);
    }
    return NULL;
}

static const char *find_font(Parser *p, const char *name)
{
    static const char *const extensions[] = {".ttf", NULL};
    const char *path = file_find(p, name, extensions);
    return path ? path : find_povray_font(p, name);
}

/* Read `ttf "file"` or `internal n` and return the path of the font. */
static const char *read_font(Parser *p)
{
    static const char *const internal[] = {"povlogo.ttf", "timrom.ttf", "cyrvetic.ttf",
                                           "crystal.ttf"};
    if (parse_accept(p, KW_INTERNAL)) {
        double number = read_finite(p, "the number of an internal font", NULL);
        const char *name = internal[number >= 1 && number < 4 ? (int)number : 0];
        const char *path = find_font(p, name);
        if (!path)
            parse_fail(p, parse_last_span(p),
                       "this font is POV-Ray's '%s', which is not found: install POV-Ray's include "
                       "files (Debian: povray-includes), or give a font with `ttf`",
                       name);
        return path;
    }
    parse_expect(p, KW_TTF, "text");
    const char *name = parse_path(p);
    const char *path = find_font(p, name);
    if (!path)
        parse_fail(p, parse_last_span(p), "the font '%s' is not found", name);
    return path;
}

/* --- glyphs -------------------------------------------------------------------------------- */

/* Cut a text into characters, and make room for what becomes of them. */
static void take_characters(Parser *p, const char *text, Span span, TextSetting *out)
{
    size_t length = strlen(text);
    out->characters = parse_alloc(p, length * sizeof *out->characters);
    for (size_t at = 0; at < length;) {
        unsigned character;
        at += unit_decode(text + at, length - at, &character);
        out->characters[out->count++] = character;
        if (out->count > TEXT_GLYPHS_MAX)
            parse_fail(p, span, "the text has more than %d characters", TEXT_GLYPHS_MAX);
    }
    out->numbers = parse_alloc(p, out->count * sizeof *out->numbers);
    out->glyphs = parse_alloc(p, out->count * sizeof *out->glyphs);
    out->which = parse_alloc(p, out->count * sizeof *out->which);
    out->kerning = parse_alloc(p, out->count * sizeof *out->kerning);
}

/* Load the glyphs of a text, each once.  The font is open: nothing here may end the parse. */
static Status set_text(Diag *diag, Arena *arena, Font *font, TextSetting *text)
{
    uint32_t before = 0;
    for (uint32_t i = 0; i < text->count; i++) {
        uint32_t number = font_glyph_number(font, text->characters[i]), which = 0;
        while (which < text->glyph_count && text->numbers[which] != number)
            which++;
        if (which == text->glyph_count) {
            TRY(font_glyph(diag, font, number, arena, &text->glyphs[which]));
            text->numbers[text->glyph_count++] = number;
        }
        text->which[i] = which;
        text->kerning[i] = i ? font_kerning(font, before, number) : 0;
        before = number;
    }
    return OK;
}

/* Make the shape of a glyph; NULL if there is nothing to see. */
static Shape *make_glyph(Parser *p, const Glyph *glyph, double thickness)
{
    if (glyph->span_count == 0 || thickness == 0)
        return NULL;
    PrismForm form = {.lo = fmin(0, thickness),
                      .hi = fmax(0, thickness),
                      .degree = glyph->degree,
                      .span_count = glyph->span_count,
                      .spans = glyph->spans};
    /* A prism has its curves in x and z and is swept along y; text stands in x and y. */
    static const double turn[3][4] = {{1, 0, 0, 0}, {0, 0, 1, 0}, {0, 1, 0, 0}};
    Xform upright;
    Shape *shape = parse_no_null(p, shape_prism(parse_arena(p), &form));
    if (xform_from_matrix(turn, &upright))
        shape_transform(shape, &upright);
    return shape;
}

/* Put the glyphs side by side: the leftmost point of the first one is at 0. */
static void place_glyphs(Parser *p, const TextSetting *text, double thickness, V3 offset,
                         Node *node)
{
    V3 pen = v3(0, 0, 0);
    Shape **shapes = parse_alloc(p, text->glyph_count * sizeof *shapes);
    for (uint32_t i = 0; i < text->glyph_count; i++)
        shapes[i] = make_glyph(p, &text->glyphs[i], thickness);
    node->children = parse_alloc(p, text->count * sizeof *node->children);
    for (uint32_t i = 0; i < text->count; i++) {
        const Glyph *glyph = &text->glyphs[text->which[i]];
        const Shape *shape = shapes[text->which[i]];
        pen.x += i ? text->kerning[i] : -glyph->left;
        if (shape) {
            Shape *own = parse_no_null(p, shape_copy(parse_arena(p), shape));
            Xform move = xform_translate(pen);
            shape_transform(own, &move);
            node->children[node->child_count++] = read_leaf(p, own);
        }
        pen.x += glyph->advance;
        pen = v3_add(pen, offset);
    }
    node->size += node->child_count;
}

Node *read_text(Parser *p)
{
    Font *font;
    TextSetting setting = {0};
    Node *node = read_empty(p);
    const char *path = read_font(p);
    Span font_span = parse_last_span(p);
    parse_comma(p);
    const char *text = parse_string(p);
    take_characters(p, text, parse_last_span(p), &setting);
    parse_comma(p);
    double thickness = read_finite(p, "the thickness of a text", NULL);
    parse_comma(p);
    V3 offset = parse_v3(p);
    Status status = font_open(parse_diag(p), path, &font);
    if (status == OK)
        status = set_text(parse_diag(p), parse_arena(p), font, &setting);
    font_close(font);
    if (status == ERR_FILE)
        parse_fail(p, font_span, "the font cannot be used");
    if (status != OK)
        parse_fail_status(p, status);
    place_glyphs(p, &setting, thickness, offset, node);
    return node;
}
