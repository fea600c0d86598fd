/* OpenEXR out and in.  SPDX-License-Identifier: Apache-2.0 */
#include "base/file.h"
#include "base/mem.h"
#include "base/rng.h"
#include "image/exr.h"

#include <dirent.h>
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cmocka.h>
#include <openexr.h>

#include "folder.h"
#include "quiet.h"

static float value_at(size_t i)
{
    return (float)sin((double)i * 0.7) * 3 + (float)(i % 17) * 100;
}

static void make_image(Image *image, int width, int height)
{
    static const char *const layers[][2] = {
        {"", "RGBA"}, {"direct", "RGB"}, {"N", "XYZ"}, {"Z", "Z"}};
    image_init(image, width, height);
    for (size_t l = 0; l < 4; l++) {
        ImageLayer *layer = image_add_layer(image, layers[l][0], layers[l][1]);
        assert_non_null(layer);
        size_t count = (size_t)width * (size_t)height * (size_t)layer->channel_count;
        for (size_t i = 0; i < count; i++)
            layer->pixels[i] = value_at(i + l * 7);
    }
}

static void assert_same(const Image *a, const Image *b, const char *name, double relative)
{
    const ImageLayer *la = image_find_layer(a, name), *lb = image_find_layer(b, name);
    assert_non_null(la);
    assert_non_null(lb);
    assert_string_equal(la->channels, lb->channels);
    size_t count = (size_t)a->width * (size_t)a->height * (size_t)la->channel_count;
    for (size_t i = 0; i < count; i++) {
        double d = fabs((double)la->pixels[i] - (double)lb->pixels[i]);
        assert_true(d <= relative * fabs((double)la->pixels[i]));
    }
}

static void round_trip(int width, int height)
{
    Image image, back;
    make_image(&image, width, height);
    const char *path = in_folder("a.exr");
    assert_int_equal(exr_write(quiet(), path, &image, NULL, (ExrOptions){0}), OK);
    assert_int_equal(exr_read(quiet(), path, &back), OK);
    assert_int_equal(back.width, width);
    assert_int_equal(back.height, height);
    assert_int_equal(back.layer_count, 4);
    assert_false(back.is_display);
    assert_string_equal(back.layers[0].name, "");
    for (int i = 0; i < 4; i++)
        assert_same(&image, &back, image.layers[i].name, 0);
    image_done(&image);
    image_done(&back);
}

static void floats_come_back_exactly(void **state)
{
    (void)state;
    round_trip(1, 1);
    round_trip(37, 16);
    round_trip(5, 17);
    round_trip(64, 33);
}

/* Noise with a few zeros: in some such pictures compression saves just as many bytes as it adds. */
static void what_cannot_be_compressed_survives(void **state)
{
    (void)state;
    enum { SIDE = 16, PIXELS = SIDE * SIDE, PICTURES = 340, ZEROS = 20 };
    for (int picture = 0; picture < PICTURES; picture++) {
        Image image, back;
        Rng rng = rng_at(3, 0, (uint64_t)picture);
        image_init(&image, SIDE, SIDE);
        ImageLayer *layer = image_add_layer(&image, "", "Y");
        for (int i = picture % ZEROS; i < PIXELS; i++) {
            uint32_t bits = rng_u32(&rng) & 0xbfffffff; /* no exponent of infinity */
            memcpy(&layer->pixels[i], &bits, sizeof bits);
        }
        const char *path = in_folder("noise.exr");
        assert_int_equal(exr_write(quiet(), path, &image, NULL, (ExrOptions){0}), OK);
        assert_int_equal(exr_read(quiet(), path, &back), OK);
        assert_memory_equal(back.layers[0].pixels, layer->pixels, PIXELS * sizeof(float));
        image_done(&image);
        image_done(&back);
    }
}

static void halves_round_colours_and_keep_data(void **state)
{
    (void)state;
    Image image, back;
    make_image(&image, 20, 20);
    image.layers[0].pixels[0] = 1e9f;
    image.layers[0].pixels[1] = -1e9f;
    const char *path = in_folder("half.exr");
    assert_int_equal(exr_write(quiet(), path, &image, NULL, (ExrOptions){.is_half = true}), OK);
    assert_int_equal(exr_read(quiet(), path, &back), OK);
    /* too bright for half: the largest half, not infinity */
    assert_true(back.layers[0].pixels[0] == 65504.0f);
    assert_true(back.layers[0].pixels[1] == -65504.0f);
    image.layers[0].pixels[0] = 65504.0f;
    image.layers[0].pixels[1] = -65504.0f;
    assert_same(&image, &back, "", 0x1p-11);
    assert_same(&image, &back, "direct", 0x1p-11);
    assert_same(&image, &back, "N", 0);
    assert_same(&image, &back, "Z", 0);
    image_done(&image);
    image_done(&back);
}

/* Files of nothing but three or four halves a pixel, which libraries have short cuts for. */
static void plain_halves_keep_their_channels(void **state)
{
    (void)state;
    static const char *const channels[] = {"RGB", "RGBA"};
    for (int k = 0; k < 2; k++) {
        Image image, back;
        image_init(&image, 33, 20);
        ImageLayer *layer = image_add_layer(&image, "", channels[k]);
        for (int i = 0; i < 33 * 20 * layer->channel_count; i++)
            layer->pixels[i] = (float)(i % 1024);
        const char *path = in_folder("plain.exr");
        assert_int_equal(exr_write(quiet(), path, &image, NULL, (ExrOptions){.is_half = true}), OK);
        assert_int_equal(exr_read(quiet(), path, &back), OK);
        assert_same(&image, &back, "", 0);
        image_done(&image);
        image_done(&back);
    }
}

static void numbers_that_are_not_survive(void **state)
{
    (void)state;
    Image image, back;
    image_init(&image, 2, 1);
    ImageLayer *layer = image_add_layer(&image, "", "RGB");
    layer->pixels[0] = NAN;
    layer->pixels[1] = INFINITY;
    const char *path = in_folder("nan.exr");
    assert_int_equal(exr_write(quiet(), path, &image, NULL, (ExrOptions){0}), OK);
    assert_int_equal(exr_read(quiet(), path, &back), OK);
    assert_true(isnan(back.layers[0].pixels[0]));
    assert_true(isinf(back.layers[0].pixels[1]));
    image_done(&image);
    image_done(&back);
}

static const MetaItem fields[] = {
    {"software", "pms"},
    {"pms.command", "pms a.pms -o b.exr"},
    {"a field with a name that is longer than thirty-one bytes", "long"},
    {"empty", ""}};
static const Meta meta = {fields, 4};

/* Also on several threads: more chunks than a round holds, and one that is not whole. */
static void same_image_same_bytes(void **state)
{
    (void)state;
    Image image;
    make_image(&image, 33, 16 * 60 + 3);
    char *bytes[2];
    size_t size[2];
    for (int i = 0; i < 2; i++) {
        const char *path = in_folder(i ? "b1.exr" : "b0.exr");
        ExrOptions options = {.threads = 1 + 2 * i};
        assert_int_equal(exr_write(quiet(), path, &image, &meta, options), OK);
        size[i] = slurp(path, &bytes[i]);
    }
    assert_int_equal(size[0], size[1]);
    assert_memory_equal(bytes[0], bytes[1], size[0]);
    free(bytes[0]);
    free(bytes[1]);
    image_done(&image);
}

/* Read the header with the library alone. */
static void header_says_what_it_holds(void **state)
{
    (void)state;
    Image image;
    make_image(&image, 8, 8);
    const char *path = in_folder("meta.exr");
    assert_int_equal(exr_write(quiet(), path, &image, &meta, (ExrOptions){.is_half = true}), OK);
    exr_context_t context;
    assert_int_equal(exr_start_read(&context, path, NULL), EXR_ERR_SUCCESS);
    exr_attr_chromaticities_t c;
    assert_int_equal(exr_attr_get_chromaticities(context, 0, "chromaticities", &c),
                     EXR_ERR_SUCCESS);
    assert_true(fabsf(c.red_x - 0.64f) < 1e-6f && fabsf(c.white_y - 0.329f) < 1e-6f);
    for (int i = 0; i < meta.count; i++) {
        int32_t length;
        const char *text;
        assert_int_equal(exr_attr_get_string(context, 0, fields[i].name, &length, &text),
                         EXR_ERR_SUCCESS);
        assert_string_equal(text, fields[i].value);
    }
    exr_compression_t compression;
    exr_get_compression(context, 0, &compression);
    assert_int_equal(compression, EXR_COMPRESSION_ZIP);
    static const char *const names[] = {"A", "B", "G",        "N.X",      "N.Y",     "N.Z",
                                        "R", "Z", "direct.B", "direct.G", "direct.R"};
    const exr_attr_chlist_t *list;
    exr_get_channels(context, 0, &list);
    assert_int_equal(list->num_channels, 11);
    for (int i = 0; i < 11; i++) {
        assert_string_equal(list->entries[i].name.str, names[i]);
        bool is_data = strchr("NZ", names[i][0]) != NULL;
        assert_int_equal(list->entries[i].pixel_type, is_data ? EXR_PIXEL_FLOAT : EXR_PIXEL_HALF);
    }
    exr_finish(&context);
    image_done(&image);
}

static void refuses(const char *path, const char *message)
{
    Image back;
    assert_int_equal(exr_read(quiet(), path, &back), ERR_FILE);
    assert_non_null(strstr(last_message, message));
    assert_int_equal(back.layer_count, 0);
}

static void cut_files_are_refused(void **state)
{
    (void)state;
    Image image;
    make_image(&image, 30, 50);
    const char *path = in_folder("whole.exr");
    assert_int_equal(exr_write(quiet(), path, &image, NULL, (ExrOptions){0}), OK);
    char *bytes;
    size_t size = slurp(path, &bytes);
    for (size_t cut = 0; cut < size; cut += 1 + cut / 50) {
        spill(in_folder("cut.exr"), bytes, cut);
        refuses(in_folder("cut.exr"), "cannot read");
    }
    free(bytes);
    image_done(&image);
}

/* Any one byte changed: read or refused, never a crash; the header is tried whole. */
static void damaged_files_never_crash(void **state)
{
    (void)state;
    Image image, back;
    make_image(&image, 9, 20);
    const char *path = in_folder("whole2.exr");
    assert_int_equal(exr_write(quiet(), path, &image, NULL, (ExrOptions){.is_half = true}), OK);
    char *bytes;
    size_t size = slurp(path, &bytes);
    for (size_t at = 0; at < size; at += at < 700 ? 1 : 13) {
        for (int k = 0; k < 3; k++) {
            char was = bytes[at];
            bytes[at] = k == 0 ? (char)0xff : k == 1 ? 0x7f : (char)(was ^ 1);
            spill(in_folder("bad.exr"), bytes, size);
            if (exr_read(quiet(), in_folder("bad.exr"), &back) == OK)
                image_done(&back);
            bytes[at] = was;
        }
    }
    free(bytes);
    image_done(&image);
}

static void what_is_not_an_exr_is_refused(void **state)
{
    (void)state;
    refuses(in_folder("missing.exr"), "cannot open");
    refuses(folder, "is a directory");
    refuses("/dev/null", "not a regular file");
    spill(in_folder("text.exr"), "not an image", 12);
    refuses(in_folder("text.exr"), "cannot read");
    spill(in_folder("empty.exr"), "", 0);
    refuses(in_folder("empty.exr"), "cannot read");
}

typedef struct OddFile {
    exr_storage_t storage;
    exr_compression_t compression;
    exr_pixel_type_t type;
    int sampling;
    int origin; /* of the data window */
} OddFile;

enum { ODD_WIDTH = 20, ODD_HEIGHT = 18, ODD_TILE = 8 };

static float odd_value(exr_pixel_type_t type, int x, int y)
{
    return type == EXR_PIXEL_UINT ? (float)(1000 * x + y) : (float)x * 0.5f - (float)y;
}

static void put_chunk(exr_context_t context, const exr_chunk_info_t *chunk, const OddFile *odd,
                      int x0, int y0, int width)
{
    static uint8_t block[ODD_WIDTH * 64 * 4];
    exr_encode_pipeline_t encoder = EXR_ENCODE_PIPELINE_INITIALIZER;
    assert_int_equal(exr_encoding_initialize(context, 0, chunk, &encoder), EXR_ERR_SUCCESS);
    exr_coding_channel_info_t *info = &encoder.channels[0];
    bool is_uint = odd->type == EXR_PIXEL_UINT;
    for (int y = 0; y < info->height; y++) {
        for (int x = 0; x < info->width; x++) {
            float v = odd_value(odd->type, x0 + x, y0 + y);
            uint32_t u = (uint32_t)v;
            memcpy(block + 4 * (y * width + x), is_uint ? (void *)&u : (void *)&v, 4);
        }
    }
    info->encode_from_ptr = block;
    info->user_data_type = is_uint ? EXR_PIXEL_UINT : EXR_PIXEL_FLOAT;
    info->user_bytes_per_element = 4;
    info->user_pixel_stride = 4;
    info->user_line_stride = 4 * width;
    assert_int_equal(exr_encoding_choose_default_routines(context, 0, &encoder), EXR_ERR_SUCCESS);
    assert_int_equal(exr_encoding_run(context, 0, &encoder), EXR_ERR_SUCCESS);
    exr_encoding_destroy(context, &encoder);
}

/* Write a one-channel file as other programs do. */
static void write_odd(const char *path, const OddFile *odd)
{
    exr_context_t context;
    int part;
    exr_attr_box2i_t window = {{{{odd->origin, odd->origin}}},
                               {{{odd->origin + ODD_WIDTH - 1, odd->origin + ODD_HEIGHT - 1}}}};
    exr_attr_v2f_t centre = {{{0, 0}}};
    assert_int_equal(exr_start_write(&context, path, EXR_WRITE_FILE_DIRECTLY, NULL),
                     EXR_ERR_SUCCESS);
    exr_add_part(context, "odd", odd->storage, &part);
    exr_initialize_required_attr(context, 0, &window, &window, 1, &centre, 1,
                                 EXR_LINEORDER_INCREASING_Y, odd->compression);
    exr_add_channel(context, 0, "Y", odd->type, EXR_PERCEPTUALLY_LOGARITHMIC, odd->sampling,
                    odd->sampling);
    if (odd->storage == EXR_STORAGE_TILED)
        exr_set_tile_descriptor(context, 0, ODD_TILE, ODD_TILE, EXR_TILE_ONE_LEVEL,
                                EXR_TILE_ROUND_DOWN);
    assert_int_equal(exr_write_header(context), EXR_ERR_SUCCESS);
    exr_chunk_info_t chunk;
    if (odd->storage == EXR_STORAGE_TILED) {
        for (int y = 0; y < ODD_HEIGHT; y += ODD_TILE) {
            for (int x = 0; x < ODD_WIDTH; x += ODD_TILE) {
                exr_write_tile_chunk_info(context, 0, x / ODD_TILE, y / ODD_TILE, 0, 0, &chunk);
                put_chunk(context, &chunk, odd, x, y, ODD_TILE);
            }
        }
    } else {
        int32_t lines;
        exr_get_scanlines_per_chunk(context, 0, &lines);
        for (int y = 0; y < ODD_HEIGHT; y += lines) {
            exr_write_scanline_chunk_info(context, 0, odd->origin + y, &chunk);
            put_chunk(context, &chunk, odd, 0, y, ODD_WIDTH);
        }
    }
    assert_int_equal(exr_finish(&context), EXR_ERR_SUCCESS);
}

static void files_of_others_are_read(void **state)
{
    (void)state;
    static const OddFile odd[] = {
        {EXR_STORAGE_SCANLINE, EXR_COMPRESSION_NONE, EXR_PIXEL_FLOAT, 1, 0},
        {EXR_STORAGE_SCANLINE, EXR_COMPRESSION_ZIPS, EXR_PIXEL_HALF, 1, -7},
        {EXR_STORAGE_SCANLINE, EXR_COMPRESSION_RLE, EXR_PIXEL_UINT, 1, 5},
        {EXR_STORAGE_SCANLINE, EXR_COMPRESSION_PIZ, EXR_PIXEL_HALF, 1, 0},
        {EXR_STORAGE_TILED, EXR_COMPRESSION_ZIP, EXR_PIXEL_FLOAT, 1, 0},
        {EXR_STORAGE_TILED, EXR_COMPRESSION_NONE, EXR_PIXEL_UINT, 1, 3},
    };
    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
        Image back;
        write_odd(in_folder("odd.exr"), &odd[i]);
        assert_int_equal(exr_read(quiet(), in_folder("odd.exr"), &back), OK);
        assert_int_equal(back.width, ODD_WIDTH);
        assert_int_equal(back.height, ODD_HEIGHT);
        assert_string_equal(back.layers[0].channels, "Y");
        for (int p = 0; p < ODD_WIDTH * ODD_HEIGHT; p++)
            assert_true(back.layers[0].pixels[p] ==
                        odd_value(odd[i].type, p % ODD_WIDTH, p / ODD_WIDTH));
        image_done(&back);
    }
}

static void a_full_disk_leaves_no_file(void **state)
{
    (void)state;
    Image image;
    make_image(&image, 64, 64);
    struct rlimit old;
    getrlimit(RLIMIT_FSIZE, &old);
    signal(SIGXFSZ, SIG_IGN);
    for (rlim_t limit = 0; limit < 40000; limit = limit * 2 + 100) {
        setrlimit(RLIMIT_FSIZE, &(struct rlimit){limit, old.rlim_max});
        Status status = exr_write(quiet(), in_folder("full.exr"), &image, &meta, (ExrOptions){0});
        setrlimit(RLIMIT_FSIZE, &old);
        assert_int_equal(status, ERR_FILE);
        assert_non_null(strstr(last_message, "File too large"));
        assert_false(file_exists(in_folder("full.exr")));
    }
    /* and no temporary file either */
    DIR *listing = opendir(folder);
    assert_non_null(listing);
    for (struct dirent *entry; (entry = readdir(listing));)
        assert_null(strstr(entry->d_name, "full.exr"));
    closedir(listing);
    image_done(&image);
}

static void bad_targets_are_refused(void **state)
{
    (void)state;
    Image image;
    make_image(&image, 4, 4);
    assert_int_equal(exr_write(quiet(), folder, &image, NULL, (ExrOptions){0}), ERR_FILE);
    assert_non_null(strstr(last_message, "directory"));
    assert_int_equal(exr_write(quiet(), in_folder("no/such/a.exr"), &image, NULL, (ExrOptions){0}),
                     ERR_FILE);
    assert_non_null(strstr(last_message, "folder does not exist"));
    image_done(&image);
}

static void every_allocation_may_fail(void **state)
{
    (void)state;
    Image image, back;
    make_image(&image, 12, 20);
    bool is_done = false;
    for (long n = 1; !is_done; n++) {
        mem_fail_from(n);
        Status status = exr_write(quiet(), in_folder("m.exr"), &image, &meta, (ExrOptions){0});
        mem_fail_from(0);
        assert_true(status == OK || status == ERR_MEMORY);
        assert_int_equal(file_exists(in_folder("m.exr")), status == OK);
        is_done = status == OK;
        assert_true(n < 10000);
    }
    is_done = false;
    for (long n = 1; !is_done; n++) {
        mem_fail_from(n);
        Status status = exr_read(quiet(), in_folder("m.exr"), &back);
        mem_fail_from(0);
        assert_true(status == OK || status == ERR_MEMORY);
        is_done = status == OK;
        assert_true(n < 10000);
    }
    image_done(&back);
    image_done(&image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(floats_come_back_exactly),
        cmocka_unit_test(what_cannot_be_compressed_survives),
        cmocka_unit_test(halves_round_colours_and_keep_data),
        cmocka_unit_test(plain_halves_keep_their_channels),
        cmocka_unit_test(numbers_that_are_not_survive),
        cmocka_unit_test(same_image_same_bytes),
        cmocka_unit_test(header_says_what_it_holds),
        cmocka_unit_test(cut_files_are_refused),
        cmocka_unit_test(damaged_files_never_crash),
        cmocka_unit_test(what_is_not_an_exr_is_refused),
        cmocka_unit_test(files_of_others_are_read),
        cmocka_unit_test(a_full_disk_leaves_no_file),
        cmocka_unit_test(bad_targets_are_refused),
        cmocka_unit_test(every_allocation_may_fail),
    };
    return cmocka_run_group_tests_name("exr", tests, make_folder, remove_folder);
}
