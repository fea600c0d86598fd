/* PNG out and in.  SPDX-License-Identifier: Apache-2.0 */
#include "base/file.h"
#include "base/mem.h"
#include "base/rng.h"
#include "image/png_file.h"
#include "image/srgb.h"

#include <math.h>
#include <png.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>
#include <cmocka.h>

#include "folder.h"
#include "quiet.h"

static const MetaItem fields[] = {{"Software", "pms"}, {"pms.command", "pms a.pms\nline two"}};
static const Meta meta = {fields, 2};

enum { WIDTH = 13, HEIGHT = 7 };

static void round_trip(int channels, int bits)
{
    float pixels[WIDTH * HEIGHT * 4];
    float top = bits == 8 ? 255.0f : 65535.0f;
    int count = WIDTH * HEIGHT * channels;
    for (int i = 0; i < count; i++)
        pixels[i] = (float)((i * 7919) % (int)(top + 1)) / top;
    const char *path = in_folder("a.png");
    assert_int_equal(png_write(quiet(), path, WIDTH, HEIGHT, channels, pixels, bits, true, &meta),
                     OK);
    Image back;
    assert_int_equal(png_read(quiet(), path, &back), OK);
    assert_true(back.is_display);
    assert_int_equal(back.width, WIDTH);
    assert_int_equal(back.height, HEIGHT);
    assert_string_equal(back.layers[0].channels, channels == 4 ? "RGBA" : "RGB");
    for (int i = 0; i < count; i++)
        assert_true(back.layers[0].pixels[i] == pixels[i]);
    image_done(&back);
}

static void values_come_back_exactly(void **state)
{
    (void)state;
    round_trip(3, 8);
    round_trip(4, 8);
    round_trip(3, 16);
    round_trip(4, 16);
}

static void values_are_clipped_and_rounded(void **state)
{
    (void)state;
    const float pixels[9] = {-1,         2,           NAN, INFINITY,    -INFINITY,
                             0.5f / 255, 0.49f / 255, 1,   254.6f / 255};
    const float wanted[9] = {0, 255, 0, 255, 0, 1, 0, 255, 255};
    const char *path = in_folder("clip.png");
    assert_int_equal(png_write(quiet(), path, 3, 1, 3, pixels, 8, false, NULL), OK);
    Image back;
    assert_int_equal(png_read(quiet(), path, &back), OK);
    for (int i = 0; i < 9; i++)
        assert_true(back.layers[0].pixels[i] == wanted[i] / 255);
    image_done(&back);
}

/* Write a PNG of any kind with libpng alone. */
static void write_odd(const char *path, int type, int bits, int interlace, double gamma)
{
    FILE *file = fopen(path, "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
    png_infop info = png_create_info_struct(png);
    assert_non_null(file);
    assert_int_equal(setjmp(png_jmpbuf(png)), 0);
    png_init_io(png, file);
    png_set_IHDR(png, info, 8, 8, bits, type, interlace, 0, 0);
    if (type == PNG_COLOR_TYPE_PALETTE) {
        png_color palette[2] = {{255, 0, 0}, {0, 0, 255}};
        png_byte alpha[1] = {51};
        png_set_PLTE(png, info, palette, 2);
        png_set_tRNS(png, info, alpha, 1, NULL);
    }
    if (gamma > 0)
        png_set_gAMA(png, info, gamma);
    png_write_info(png, info);
    png_byte row[8 * 8];
    png_bytep rows[8] = {row, row, row, row, row, row, row, row};
    memset(row, type == PNG_COLOR_TYPE_PALETTE ? 0 : 0x80, sizeof row);
    png_write_image(png, rows);
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    fclose(file);
}

static void check_odd(const char *path, const char *channels, float first, float last)
{
    Image back;
    assert_int_equal(png_read(quiet(), path, &back), OK);
    const ImageLayer *layer = &back.layers[0];
    assert_string_equal(layer->channels, channels);
    for (int i = 0; i < 64; i++) {
        const float *pixel = layer->pixels + i * layer->channel_count;
        assert_float_equal(pixel[0], first, 1e-5f);
        assert_float_equal(pixel[layer->channel_count - 1], last, 1e-5f);
    }
    image_done(&back);
}

static void files_of_others_are_read(void **state)
{
    (void)state;
    const char *path = in_folder("odd.png");
    float half = 128.0f / 255, half16 = 32896.0f / 65535;
    for (int interlace = 0; interlace < 2; interlace++) {
        write_odd(path, PNG_COLOR_TYPE_GRAY, 8, interlace, 0);
        check_odd(path, "RGB", half, half);
        write_odd(path, PNG_COLOR_TYPE_GRAY_ALPHA, 16, interlace, 0);
        check_odd(path, "RGBA", half16, half16);
        write_odd(path, PNG_COLOR_TYPE_RGB, 16, interlace, 0.45455);
        check_odd(path, "RGB", half16, half16);
        write_odd(path, PNG_COLOR_TYPE_PALETTE, 1, interlace, 0);
        check_odd(path, "RGBA", 1, 0.2f);
        /* linear values are brought to the display's curve, alpha is not */
        write_odd(path, PNG_COLOR_TYPE_RGBA, 8, interlace, 1);
        check_odd(path, "RGBA", srgb_encode(half), half);
    }
}

static void refuses(const char *path, const char *message)
{
    Image back;
    assert_int_equal(png_read(quiet(), path, &back), ERR_FILE);
    assert_non_null(strstr(last_message, message));
    assert_int_equal(back.layer_count, 0);
}

static void damaged_files_never_crash(void **state)
{
    (void)state;
    float pixels[WIDTH * HEIGHT * 3];
    for (int i = 0; i < WIDTH * HEIGHT * 3; i++)
        pixels[i] = (float)(i % 200) / 255;
    const char *path = in_folder("whole.png");
    png_write(quiet(), path, WIDTH, HEIGHT, 3, pixels, 8, true, &meta);
    char *bytes;
    size_t size = slurp(path, &bytes);
    for (size_t cut = 0; cut < size - 12; cut++) {
        spill(in_folder("cut.png"), bytes, cut);
        refuses(in_folder("cut.png"), "cannot read");
    }
    for (size_t at = 0; at < size; at++) {
        Image back;
        bytes[at] ^= 0x41;
        spill(in_folder("bad.png"), bytes, size);
        if (png_read(quiet(), in_folder("bad.png"), &back) == OK)
            image_done(&back);
        bytes[at] ^= 0x41;
    }
    free(bytes);
}

static void what_is_not_a_png_is_refused(void **state)
{
    (void)state;
    refuses(in_folder("missing.png"), "cannot open");
    refuses(folder, "is a directory");
    spill(in_folder("text.png"), "not an image", 12);
    refuses(in_folder("text.png"), "cannot read");
    spill(in_folder("empty.png"), "", 0);
    refuses(in_folder("empty.png"), "cannot read");
}

/* A header that claims a size no file of its length can hold. */
static void a_bomb_is_refused_unread(void **state)
{
    (void)state;
    static const unsigned char bomb[] = {
        0x89, 'P',  'N',  'G',  13,   10, 26, 10,   0,    0,   0,   13,   'I',  'H',  'D',
        'R',  0,    0,    0xff, 0xff, 0,  0,  0xff, 0xff, 16,  6,   0,    0,    0,    0xb8,
        0xb1, 0xc8, 0x21, 0,    0,    0,  0,  'I',  'D',  'A', 'T', 0x35, 0xaf, 0x06, 0x1e};
    spill(in_folder("bomb.png"), (const char *)bomb, sizeof bomb);
    Image back;
    assert_int_equal(png_read(quiet(), in_folder("bomb.png"), &back), ERR_FILE);
}

static void a_full_disk_leaves_no_file(void **state)
{
    (void)state;
    static float pixels[64 * 64 * 3];
    for (int i = 0; i < 64 * 64 * 3; i++)
        pixels[i] = (float)(rng_mix((uint64_t)i) & 255) / 255;
    struct rlimit old;
    getrlimit(RLIMIT_FSIZE, &old);
    signal(SIGXFSZ, SIG_IGN);
    for (rlim_t limit = 0; limit < 8000; limit = limit * 2 + 100) {
        setrlimit(RLIMIT_FSIZE, &(struct rlimit){limit, old.rlim_max});
        Status status = png_write(quiet(), in_folder("full.png"), 64, 64, 3, pixels, 8, true, NULL);
        setrlimit(RLIMIT_FSIZE, &old);
        assert_int_equal(status, ERR_FILE);
        assert_non_null(strstr(last_message, "File too large"));
        assert_false(file_exists(in_folder("full.png")));
    }
    assert_int_equal(png_write(quiet(), folder, 64, 64, 3, pixels, 8, true, NULL), ERR_FILE);
    assert_int_equal(png_write(quiet(), in_folder("no/a.png"), 64, 64, 3, pixels, 8, true, NULL),
                     ERR_FILE);
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    static float pixels[10 * 10 * 3];
    const char *path = in_folder("m.png");
    bool is_done = false;
    for (long n = 1; !is_done; n++) {
        mem_fail_from(n);
        Status status = png_write(quiet(), path, 10, 10, 3, pixels, 8, true, &meta);
        mem_fail_from(0);
        assert_true(status == OK || status == ERR_MEMORY);
        is_done = status == OK;
        assert_true(n < 1000);
    }
    Image back;
    is_done = false;
    for (long n = 1; !is_done; n++) {
        mem_fail_from(n);
        Status status = png_read(quiet(), path, &back);
        mem_fail_from(0);
        assert_true(status == OK || status == ERR_MEMORY);
        is_done = status == OK;
        assert_true(n < 1000);
    }
    image_done(&back);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(values_come_back_exactly),
        cmocka_unit_test(values_are_clipped_and_rounded),
        cmocka_unit_test(files_of_others_are_read),
        cmocka_unit_test(damaged_files_never_crash),
        cmocka_unit_test(what_is_not_a_png_is_refused),
        cmocka_unit_test(a_bomb_is_refused_unread),
        cmocka_unit_test(a_full_disk_leaves_no_file),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests_name("png", tests, make_folder, remove_folder);
}
