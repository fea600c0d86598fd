/* Image files: what is read is what was written, and broken files are refused.
 * SPDX-License-Identifier: Apache-2.0 */
#include "image/bitmap_height.h"

#include "base/file.h"
#include "base/mem.h"
#include "base/rng.h"
#include "image/exr.h"
#include "image/png_file.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <cmocka.h>
#include <gif_lib.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <tiffio.h>
#include <unistd.h>

#include <jpeglib.h>

enum { WIDE = 20, HIGH = 13 };

static char folder[] = "/tmp/pms_bitmap_XXXXXX";
static Diag diag;

static int set_up(void **state)
{
    (void)state;
    diag_init(&diag, diag_drop, NULL);
    strcpy(folder + strlen(folder) - 6, "XXXXXX");
    return mkdtemp(folder) ? 0 : 1;
}

static int tear_down(void **state)
{
    (void)state;
    diag_done(&diag);
    char command[64];
    snprintf(command, sizeof command, "rm -r %s", folder);
    return system(command);
}

static const char *path_of(const char *name)
{
    static char path[128];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static void put(const char *name, const void *bytes, size_t size)
{
    assert_int_equal(file_write(&diag, path_of(name), bytes, size), OK);
}

/* The picture every writer writes. */
static int level(int x, int y, int channel)
{
    return (x * 11 + y * 5 + channel * 50) % 256;
}

/* --- writers ------------------------------------------------------------------------------- */

static void write_pnm(const char *name, int channels, int bits)
{
    char bytes[4096];
    int size = snprintf(bytes, sizeof bytes, "P%d\n# a comment\n%d %d\n%d\n", channels == 1 ? 5 : 6,
                        WIDE, HIGH, bits == 8 ? 255 : 65535);
    for (int i = 0; i < WIDE * HIGH * channels; i++) {
        int v = level(i / channels % WIDE, i / channels / WIDE, i % channels);
        if (bits == 16)
            bytes[size++] = (char)v;
        bytes[size++] = (char)v;
    }
    put(name, bytes, (size_t)size);
}

static void write_text_pnm(const char *name)
{
    char bytes[8192];
    int size = snprintf(bytes, sizeof bytes, "P2 %d %d 255", WIDE, HIGH);
    for (int i = 0; i < WIDE * HIGH; i++)
        size += snprintf(bytes + size, sizeof bytes - (size_t)size, "\n%d",
                         level(i % WIDE, i / WIDE, 0));
    put(name, bytes, (size_t)size);
}

/* True colour, plain or in packets of one pixel, upper or lower row first. */
static void write_tga(const char *name, bool is_packed, bool is_top_down)
{
    uint8_t bytes[4096] = {[2] = 2, [12] = WIDE, [14] = HIGH, [16] = 24};
    bytes[2] = (uint8_t)(is_packed ? 10 : 2);
    bytes[17] = (uint8_t)(is_top_down ? 0x20 : 0);
    size_t size = 18;
    for (int row = 0; row < HIGH; row++) {
        for (int x = 0; x < WIDE; x++) {
            if (is_packed)
                bytes[size++] = (uint8_t)(x % 2 ? 0x80 : 0); /* a run of one, or one as it is */
            for (int c = 2; c >= 0; c--)
                bytes[size++] = (uint8_t)level(x, is_top_down ? row : HIGH - 1 - row, c);
        }
    }
    put(name, bytes, size);
}

static void write_bmp(const char *name)
{
    uint8_t bytes[4096] = {'B', 'M', [10] = 54, [14] = 40, [18] = WIDE, [22] = HIGH, [28] = 24};
    size_t size = 54;
    for (int y = HIGH - 1; y >= 0; y--) /* rows of 60 bytes need no padding */
        for (int x = 0; x < WIDE; x++)
            for (int c = 2; c >= 0; c--)
                bytes[size++] = (uint8_t)level(x, y, c);
    put(name, bytes, size);
}

/* Eight bits in runs: each row one literal of all its pixels. */
static void write_bmp_runs(const char *name)
{
    uint8_t bytes[4096] = {'B',         'M',      [10] = 54 + 64, [14] = 40, [18] = WIDE,
                           [22] = HIGH, [28] = 8, [30] = 1,       [46] = 16};
    size_t size = 54;
    for (int i = 0; i < 64; i++)
        bytes[size++] = (uint8_t)(i / 4);
    for (int y = HIGH - 1; y >= 0; y--) {
        bytes[size++] = 0, bytes[size++] = WIDE;
        for (int x = 0; x < WIDE; x++)
            bytes[size++] = (uint8_t)(level(x, y, 0) % 16);
        bytes[size++] = 0, bytes[size++] = (uint8_t)(y == 0);
    }
    put(name, bytes, size);
}

static void write_hdr(const char *name)
{
    char bytes[8192];
    int size = snprintf(bytes, sizeof bytes, "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y %d +X %d\n",
                        HIGH, WIDE);
    for (int y = 0; y < HIGH; y++) {
        bytes[size++] = 2, bytes[size++] = 2, bytes[size++] = 0, bytes[size++] = WIDE;
        for (int c = 0; c < 4; c++) {
            bytes[size++] = WIDE - 5;
            for (int x = 0; x < WIDE - 5; x++)
                bytes[size++] = (char)(c == 3 ? 128 : level(x, y, c));
            bytes[size++] = (char)(128 + 5); /* the last five alike */
            bytes[size++] = (char)(c == 3 ? 128 : level(WIDE - 5, y, c));
        }
    }
    put(name, bytes, (size_t)size);
}

static void write_png(const char *name, int color_type, int bits, bool is_interlaced)
{
    FILE *file = fopen(path_of(name), "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_set_IHDR(png, info, WIDE, HIGH, bits, color_type,
                 is_interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, 0, 0);
    png_color colors[16];
    for (int i = 0; i < 16; i++)
        colors[i] = (png_color){(png_byte)i, (png_byte)(2 * i), (png_byte)(3 * i)};
    if (color_type == PNG_COLOR_TYPE_PALETTE)
        png_set_PLTE(png, info, colors, 16);
    png_write_info(png, info);
    if (color_type == PNG_COLOR_TYPE_PALETTE)
        png_set_packing(png);
    int channels = png_get_channels(png, info);
    for (int pass = 0, passes = png_set_interlace_handling(png); pass < passes; pass++) {
        for (int y = 0; y < HIGH; y++) {
            png_byte row[WIDE * 8];
            size_t at = 0;
            for (int i = 0; i < WIDE * channels; i++) {
                int v = level(i / channels, y, i % channels);
                if (bits == 16)
                    row[at++] = (png_byte)v;
                row[at++] = (png_byte)(bits == 4 ? v % 16 : v);
            }
            png_write_row(png, row);
        }
    }
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    fclose(file);
}

static void write_tiff(const char *name, int channels, int bits, int compression)
{
    TIFF *tiff = TIFFOpen(path_of(name), "w");
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, WIDE);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, HIGH);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, bits);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, channels);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC,
                 channels == 1 ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, compression);
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 4);
    for (int y = 0; y < HIGH; y++) {
        uint8_t row[WIDE * 8];
        for (int i = 0; i < WIDE * channels; i++) {
            int v = level(i / channels, y, i % channels);
            uint16_t wide = (uint16_t)(257 * v);
            if (bits == 16)
                memcpy(row + 2 * i, &wide, 2);
            else
                row[i] = (uint8_t)v;
        }
        TIFFWriteScanline(tiff, row, (uint32_t)y, 0);
    }
    TIFFClose(tiff);
}

static void write_gif(const char *name, bool is_interlaced)
{
    int error;
    GifFileType *gif = EGifOpenFileName(path_of(name), false, &error);
    GifColorType colors[16];
    for (int i = 0; i < 16; i++)
        colors[i] = (GifColorType){(GifByteType)i, (GifByteType)(2 * i), (GifByteType)(3 * i)};
    ColorMapObject *map = GifMakeMapObject(16, colors);
    EGifPutScreenDesc(gif, WIDE, HIGH, 4, 0, map);
    EGifPutImageDesc(gif, 0, 0, WIDE, HIGH, is_interlaced, NULL);
    static const int first[5] = {0, 4, 2, 1, 0}, step[5] = {8, 8, 4, 2, 1};
    for (int pass = is_interlaced ? 0 : 4; pass < (is_interlaced ? 4 : 5); pass++) {
        for (int y = first[pass]; y < HIGH; y += step[pass]) {
            GifPixelType row[WIDE];
            for (int x = 0; x < WIDE; x++)
                row[x] = (GifPixelType)(level(x, y, 0) % 16);
            EGifPutLine(gif, row, WIDE);
        }
    }
    EGifCloseFile(gif, &error);
    GifFreeMapObject(map);
}

static void write_jpeg(const char *name, int channels)
{
    struct jpeg_compress_struct jpeg;
    struct jpeg_error_mgr errors;
    FILE *file = fopen(path_of(name), "wb");
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_compress(&jpeg);
    jpeg_stdio_dest(&jpeg, file);
    jpeg.image_width = WIDE, jpeg.image_height = HIGH;
    jpeg.input_components = channels;
    jpeg.in_color_space = channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
    jpeg_set_defaults(&jpeg);
    jpeg_set_quality(&jpeg, 100, TRUE);
    jpeg_start_compress(&jpeg, TRUE);
    for (int y = 0; y < HIGH; y++) {
        JSAMPLE row[WIDE * 3], *rows = row;
        for (int i = 0; i < WIDE * channels; i++)
            row[i] =
                (JSAMPLE)(100 + 3 * (i / channels) + 2 * y); /* smooth, so that little is lost */
        jpeg_write_scanlines(&jpeg, &rows, 1);
    }
    jpeg_finish_compress(&jpeg);
    jpeg_destroy_compress(&jpeg);
    fclose(file);
}

static void write_exr(const char *name)
{
    Image image;
    image_init(&image, WIDE, HIGH);
    ImageLayer *layer = image_add_layer(&image, "", "RGB");
    for (int i = 0; i < WIDE * HIGH * 3; i++)
        layer->pixels[i] = (float)level(i / 3 % WIDE, i / 3 / WIDE, i % 3);
    assert_int_equal(exr_write(&diag, path_of(name), &image, NULL, (ExrOptions){0}), OK);
    image_done(&image);
}

/* --- reading back -------------------------------------------------------------------------- */

static Bitmap read_back(const char *name)
{
    Bitmap bitmap;
    assert_int_equal(bitmap_read(&diag, path_of(name), bitmap_kind_of(name), &bitmap), OK);
    assert_int_equal(bitmap.width, WIDE);
    assert_int_equal(bitmap.height, HIGH);
    return bitmap;
}

/* Every sample is the level times `scale`, modulo `base`. */
static void check(const char *name, int channels, int bits, double scale, int base)
{
    Bitmap b = read_back(name);
    assert_int_equal(b.channels, channels);
    assert_int_equal(b.bits, bits);
    for (int y = 0; y < HIGH; y++)
        for (int x = 0; x < WIDE; x++)
            for (int c = 0; c < channels; c++)
                assert_true(bitmap_at(&b, x, y, c) == scale * (level(x, y, c) % base));
    assert_int_equal(b.is_indexed, base == 16);
    for (int i = 0; b.is_indexed && i < 16 && b.kind != BITMAP_BMP; i++)
        assert_true(b.palette[i][0] == i && b.palette[i][1] == 2 * i && b.palette[i][2] == 3 * i &&
                    b.palette[i][3] == 255);
    bitmap_done(&b);
}

static void check_smooth(const char *name, int channels)
{
    Bitmap b = read_back(name);
    assert_int_equal(b.channels, channels);
    for (int y = 0; y < HIGH; y++)
        for (int x = 0; x < WIDE; x++)
            assert_true(abs((int)bitmap_at(&b, x, y, 0) - (100 + 3 * x + 2 * y)) <= 2);
    bitmap_done(&b);
}

static const char *const names[] = {
    "a.pgm", "b.pgm",  "c.ppm",  "d.ppm", "e.pgm", "a.tga", "b.tga",  "c.tga", "a.bmp",
    "b.bmp", "a.hdr",  "a.png",  "b.png", "c.png", "d.png", "e.png",  "f.png", "a.tif",
    "b.tif", "c.tiff", "d.tiff", "a.gif", "b.gif", "a.jpg", "b.jpeg", "a.exr"};

static void write_all(void)
{
    write_pnm("a.pgm", 1, 8), write_pnm("b.pgm", 1, 16);
    write_pnm("c.ppm", 3, 8), write_pnm("d.ppm", 3, 16);
    write_text_pnm("e.pgm");
    write_tga("a.tga", false, true), write_tga("b.tga", false, false),
        write_tga("c.tga", true, false);
    write_bmp("a.bmp"), write_bmp_runs("b.bmp");
    write_hdr("a.hdr");
    write_png("a.png", PNG_COLOR_TYPE_GRAY, 8, false),
        write_png("b.png", PNG_COLOR_TYPE_GRAY, 16, true);
    write_png("c.png", PNG_COLOR_TYPE_RGB, 8, true),
        write_png("d.png", PNG_COLOR_TYPE_RGBA, 16, false);
    write_png("e.png", PNG_COLOR_TYPE_PALETTE, 4, false);
    write_png("f.png", PNG_COLOR_TYPE_GRAY_ALPHA, 8, false);
    write_tiff("a.tif", 1, 8, COMPRESSION_NONE), write_tiff("b.tif", 3, 8, COMPRESSION_LZW);
    write_tiff("c.tiff", 1, 16, COMPRESSION_LZW), write_tiff("d.tiff", 3, 16, COMPRESSION_NONE);
    write_gif("a.gif", false), write_gif("b.gif", true);
    write_jpeg("a.jpg", 1), write_jpeg("b.jpeg", 3);
    write_exr("a.exr");
}

static void test_every_kind_is_read_back(void **state)
{
    (void)state;
    write_all();
    check("a.pgm", 1, 8, 1, 256), check("b.pgm", 1, 16, 257, 256);
    check("c.ppm", 3, 8, 1, 256), check("d.ppm", 3, 16, 257, 256);
    check("e.pgm", 1, 8, 1, 256);
    check("a.tga", 3, 8, 1, 256), check("b.tga", 3, 8, 1, 256), check("c.tga", 3, 8, 1, 256);
    check("a.bmp", 3, 8, 1, 256), check("b.bmp", 1, 8, 1, 16);
    check("a.png", 1, 8, 1, 256), check("b.png", 1, 16, 257, 256);
    check("c.png", 3, 8, 1, 256), check("d.png", 4, 16, 257, 256);
    check("e.png", 1, 8, 1, 16), check("f.png", 2, 8, 1, 256);
    check("a.tif", 1, 8, 1, 256), check("b.tif", 3, 8, 1, 256);
    check("c.tiff", 1, 16, 257, 256), check("d.tiff", 3, 16, 257, 256);
    check("a.gif", 1, 8, 1, 16), check("b.gif", 1, 8, 1, 16);
    check("a.exr", 3, 32, 1, 256);
    check_smooth("a.jpg", 1), check_smooth("b.jpeg", 3);
    Bitmap hdr = read_back("a.hdr");
    assert_true(bitmap_at(&hdr, 3, 4, 1) == level(3, 4, 1) / 256.);
    assert_true(bitmap_at(&hdr, WIDE - 1, 4, 1) == level(WIDE - 5, 4, 1) / 256.);
    bitmap_done(&hdr);
}

/* Whatever a broken file is taken for, it is no accident. */
static void test_broken_files_are_refused(void **state)
{
    (void)state;
    write_all();
    Arena *arena = arena_new();
    long refused = 0, tried = 0;
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        const char *text;
        size_t size;
        BitmapKind kind = bitmap_kind_of(names[i]);
        assert_int_equal(file_read(&diag, path_of(names[i]), 1 << 20, arena, &text, &size), OK);
        char *bytes = arena_copy(arena, text, size);
        Rng rng = rng_at(3, 1, i);
        for (int round = 0; round < 150; round++) {
            size_t length = round < 60 ? size * (size_t)round / 60 : size;
            memcpy(bytes, text, size);
            for (int flips = 0; round >= 60 && flips < 1 + round % 4; flips++) {
                size_t at = rng_u32(&rng) % (round % 2 ? size : size < 64 ? size : 64);
                bytes[at] = (char)rng_u32(&rng);
            }
            FILE *file = fopen(path_of("broken"), "wb");
            fwrite(bytes, 1, length, file);
            fclose(file);
            Bitmap bitmap;
            Status status = bitmap_read(&diag, path_of("broken"), kind, &bitmap);
            assert_true(status == OK || status == ERR_FILE || status == ERR_MEMORY);
            if (status == OK)
                bitmap_done(&bitmap);
            refused += status != OK;
            tried++;
            if (round == 0)
                assert_int_equal(status, ERR_FILE); /* an empty file */
        }
    }
    assert_true(refused > tried / 4);
    assert_true(diag.errors >= refused);
    arena_free(arena);
}

static void test_memory_that_is_out_is_no_accident(void **state)
{
    (void)state;
    write_all();
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        Status status = ERR_MEMORY;
        for (long n = 1; status != OK && n < 200; n++) {
            Bitmap bitmap;
            mem_fail_from(n);
            status = bitmap_read(&diag, path_of(names[i]), bitmap_kind_of(names[i]), &bitmap);
            mem_fail_from(0);
            if (status == OK)
                bitmap_done(&bitmap);
        }
        assert_int_equal(status, OK);
    }
}

static void test_heights_are_the_languages(void **state)
{
    (void)state;
    uint16_t heights[4];
    uint8_t grey[4] = {3, 100, 200, 254}, color[6] = {10, 20, 30, 255, 255, 0};
    uint16_t wide[3] = {100, 1000, 10000};
    Bitmap b = {.kind = BITMAP_PNG, .width = 4, .height = 1, .channels = 1, .bits = 8};
    b.samples = grey;
    bitmap_heights(&b, 1, heights); /* probe */
    assert_true(heights[0] == 2 * 257 && heights[1] == 99 * 257 && heights[2] == 199 * 257);
    b.kind = BITMAP_PNM;
    bitmap_heights(&b, 1, heights);
    assert_true(heights[0] == 3 * 257 && heights[1] == 100 * 257);
    bitmap_heights(&b, 2.2, heights);
    assert_int_equal(heights[1], 8224); /* probe */
    b.is_indexed = true;
    bitmap_heights(&b, 1, heights);
    assert_true(heights[1] == 25600 && heights[3] == 254 * 256);
    b = (Bitmap){.width = 1, .height = 2, .channels = 3, .bits = 8, .samples = color};
    bitmap_heights(&b, 1, heights);
    assert_true(heights[1] == 2580 && heights[0] == 65535); /* the bottom row first */
    b = (Bitmap){.width = 1, .height = 1, .channels = 3, .bits = 16, .samples = wide};
    bitmap_heights(&b, 1, heights);
    assert_int_equal(heights[0], (int)(29.7 + 589 + 1140));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_every_kind_is_read_back, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_broken_files_are_refused, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_memory_that_is_out_is_no_accident, set_up, tear_down),
        cmocka_unit_test(test_heights_are_the_languages),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
