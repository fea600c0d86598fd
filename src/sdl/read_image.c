/* Image files that scenes name, and height_field.  SPDX-License-Identifier: Apache-2.0 */
#include "sdl/parser_int.h"
#include "sdl/read_int.h"

#include "image/bitmap_height.h"
#include "math/func.h"
#include "shape/height_field.h"

enum { HEIGHT_FUNCTION_MAX = 20000 }; /* pixels a side of a function's image */

/* Take the word of a kind of image; BITMAP_KIND_COUNT if none comes next. */
static BitmapKind read_image_kind(Parser *p)
{
    static const struct {
        TokenKind word;
        BitmapKind kind;
    } words[] = {{KW_PNG, BITMAP_PNG},   {KW_JPEG, BITMAP_JPEG}, {KW_GIF, BITMAP_GIF},
                 {KW_TIFF, BITMAP_TIFF}, {KW_PGM, BITMAP_PNM},   {KW_PPM, BITMAP_PNM},
                 {KW_TGA, BITMAP_TGA},   {KW_BMP, BITMAP_BMP},   {KW_EXR, BITMAP_EXR},
                 {KW_HDR, BITMAP_HDR}};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        if (parse_accept(p, words[i].word))
            return words[i].kind;
    return BITMAP_KIND_COUNT;
}

double read_image_file(Parser *p, Bitmap *out)
{
    BitmapKind kind = read_image_kind(p);
    const char *name = parse_path(p);
    Span span = parse_last_span(p);
    const char *path = file_find(p, name, NULL);
    if (!path)
        parse_fail(p, span, "the image '%s' is not found", name);
    if (kind == BITMAP_KIND_COUNT)
        kind = bitmap_kind_of(path);
    if (kind == BITMAP_KIND_COUNT)
        parse_fail(p, span,
                   "'%s' has the extension of no image that pms can read (png, jpeg, gif, "
                   "tiff, pgm, ppm, tga, bmp, exr, hdr): wants the kind before its name",
                   name);
    double gamma = 1;
    if (parse_accept(p, KW_GAMMA))
        gamma = read_above_zero(p, "the gamma of an image");
    Status status = bitmap_read(parse_diag(p), path, kind, out);
    if (status == ERR_FILE)
        parse_fail(p, span, "the image '%s' cannot be used", name);
    if (status != OK)
        parse_fail_status(p, status);
    return gamma;
}

/* Take the heights of an image into the scene's memory. */
static void read_heights(Parser *p, HeightData *data)
{
    Bitmap bitmap;
    Span span = parse_peek(p)->span;
    double gamma = read_image_file(p, &bitmap);
    size_t count = (size_t)bitmap.width * (size_t)bitmap.height;
    uint16_t *heights =
        count <= HEIGHT_POINTS_MAX ? ARENA_ARRAY(parse_arena(p), uint16_t, count) : NULL;
    if (heights)
        bitmap_heights(&bitmap, gamma, heights);
    bitmap_done(&bitmap);
    if (count > HEIGHT_POINTS_MAX)
        parse_fail(p, span, "the image has more than %d pixels", HEIGHT_POINTS_MAX);
    data->heights = parse_no_null(p, heights);
    data->columns = bitmap.width;
    data->rows = bitmap.height;
}

/* Take the heights of a function of x and y, from 0 to 1 each, the image's upper row first. */
static void read_function_heights(Parser *p, HeightData *data)
{
    Value value;
    Span span = parse_peek(p)->span;
    parse_grid_function(p, HEIGHT_FUNCTION_MAX, &data->columns, &data->rows, &value);
    const Func *func = value.node;
    if (!func || func->param_count > 3)
        parse_fail(p, span_join(span, parse_last_span(p)),
                   "a height_field wants a function of up to 3 parameters");
    size_t wide = (size_t)data->columns;
    uint16_t *heights = parse_alloc(p, wide * (size_t)data->rows * sizeof *heights);
    for (int row = 0; row < data->rows; row++) {
        for (int column = 0; column < data->columns; column++) {
            const double at[3] = {column / fmax(data->columns - 1, 1),
                                  row / fmax(data->rows - 1, 1), 0};
            double height = func_value(func, at) * UINT16_MAX;
            uint16_t *to = heights + (size_t)(data->rows - 1 - row) * wide + (size_t)column;
            *to = height > 0 ? (uint16_t)(height < UINT16_MAX ? height : UINT16_MAX) : 0;
        }
    }
    data->heights = heights;
}

/* Read one of the settings after the image; returns false if none comes next. */
static bool read_height_item(Parser *p, HeightData *data)
{
    if (parse_accept(p, KW_SMOOTH)) {
        data->is_smooth = parse_flag(p);
        return true;
    }
    if (parse_accept(p, KW_HIERARCHY)) {
        parse_flag(p);
        return true;
    }
    if (!parse_accept(p, KW_WATER_LEVEL))
        return false;
    double level = read_finite(p, "water_level", NULL);
    data->water = level * HEIGHT_SCALE;
    return true;
}

Node *read_height_field(Parser *p)
{
    HeightData *data = parse_alloc(p, sizeof *data);
    if (parse_peek(p)->kind == KW_FUNCTION)
        read_function_heights(p, data);
    else
        read_heights(p, data);
    while (read_height_item(p, data))
        ;
    if (data->columns < 2 || data->rows < 2)
        return read_empty(p);
    if (!height_prepare(parse_arena(p), data))
        parse_no_null(p, NULL);
    return read_leaf(p, shape_height_field(parse_arena(p), data));
}
