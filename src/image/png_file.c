/* PNG in and out, through libpng.
 *
 * libpng reports errors by a jump, so this file has to use setjmp; what must survive the jump
 * lives in a PngJob, and no function that calls setjmp has locals that change after it.
 * SPDX-License-Identifier: Apache-2.0 */
#include "image/png_file.h"

#include "base/file.h"
#include "base/mem.h"
#include "image/png_int.h"
#include "image/srgb.h"

#include <assert.h>
#include <errno.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

enum {
    PNG_LEVEL = 4,                  /* a quarter larger than 6, at a third of its time */
    PNG_CHUNK_BYTES_MAX = 8 << 20,  /* of a text or profile chunk that is read */
    PNG_BLOCK_BYTES_MAX = 32 << 20, /* libpng asks for at a time; pixels are not among it */
    PNG_CHUNKS_MAX = 1000,          /* kept chunks; a file with more is refused */
    PNG_RATIO_MAX = 1100            /* deflate packs 1032 to 1 at best */
};

static void fail_job(png_structp png, png_const_charp message)
{
    PngJob *job = png_get_error_ptr(png);
    job->error = errno;
    snprintf(job->message, sizeof job->message, "%s", message ? message : "unknown error");
    png_longjmp(png, 1);
}

static void ignore_warning(png_structp png, png_const_charp message)
{
    (void)png;
    (void)message;
}

/* A broken file may ask libpng for gigabytes with one chunk's length. */
static png_voidp job_alloc(png_structp png, png_alloc_size_t size)
{
    if (size > PNG_BLOCK_BYTES_MAX)
        return NULL;
    void *block = mem_alloc(size);
    PngJob *job = png_get_mem_ptr(png);
    job->is_memory |= !block;
    return block;
}

static void job_free(png_structp png, png_voidp block)
{
    (void)png;
    mem_free(block);
}

static Status refuse(const PngJob *job, const char *verb)
{
    if (job->is_memory)
        return diag_no_memory(job->diag, job->path);
    bool is_system = job->error && job->file && ferror(job->file);
    return diag_fail(job->diag, ERR_FILE, "cannot %s '%s': %s", verb, job->path,
                     is_system ? strerror(job->error) : job->message);
}

static Status alloc_rows(PngJob *job, size_t height, size_t row_bytes)
{
    job->bytes = mem_array(height, row_bytes);
    job->rows = mem_array(height, sizeof *job->rows);
    if (!job->bytes || !job->rows) {
        job->is_memory = true;
        return refuse(job, "hold");
    }
    for (size_t y = 0; y < height; y++)
        job->rows[y] = job->bytes + y * row_bytes;
    return OK;
}

/* --- out --- */

static uint32_t quantise(float value, float top)
{
    /* Written so that a NaN becomes 0. */
    float clipped = value > 0 ? (value < 1 ? value : 1) : 0;
    return (uint32_t)(clipped * top + 0.5f);
}

static void pack_pixels(uint8_t *bytes, const float *pixels, size_t count, int bits)
{
    if (bits == 8) {
        for (size_t i = 0; i < count; i++)
            bytes[i] = (uint8_t)quantise(pixels[i], 255);
        return;
    }
    for (size_t i = 0; i < count; i++) {
        uint32_t v = quantise(pixels[i], 65535);
        bytes[2 * i] = (uint8_t)(v >> 8);
        bytes[2 * i + 1] = (uint8_t)(v & 255);
    }
}

static void write_text(PngJob *job, const Meta *meta)
{
    for (int i = 0; meta && i < meta->count; i++) {
        png_text text = {.compression = PNG_TEXT_COMPRESSION_NONE,
                         .key = (png_charp)(uintptr_t)meta->items[i].name,
                         .text = (png_charp)(uintptr_t)meta->items[i].value};
        png_set_text(job->png, job->info, &text, 1);
    }
}

static bool write_stream(PngJob *job, png_uint_32 width, png_uint_32 height, int channels, int bits,
                         bool is_srgb, const Meta *meta)
{
    job->png = png_create_write_struct_2(PNG_LIBPNG_VER_STRING, job, fail_job, ignore_warning, job,
                                         job_alloc, job_free);
    job->info = job->png ? png_create_info_struct(job->png) : NULL;
    if (!job->info)
        return false;
    if (setjmp(png_jmpbuf(job->png)))
        return false;
    png_init_io(job->png, job->file);
    png_set_user_limits(job->png, IMAGE_SIDE_MAX, IMAGE_SIDE_MAX);
    png_set_compression_level(job->png, PNG_LEVEL);
    /* For renders these two make files as small as all five do, in less time. */
    png_set_filter(job->png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB | PNG_FILTER_UP);
    png_set_IHDR(job->png, job->info, width, height, bits,
                 channels == 4 ? PNG_COLOR_TYPE_RGBA : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (is_srgb)
        png_set_sRGB_gAMA_and_cHRM(job->png, job->info, PNG_sRGB_INTENT_PERCEPTUAL);
    write_text(job, meta);
    png_write_info(job->png, job->info);
    png_write_image(job->png, job->rows);
    png_write_end(job->png, job->info);
    return true;
}

Status png_write(Diag *diag, const char *path, int width, int height, int channels,
                 const float *pixels, int bits, bool is_srgb, const Meta *meta)
{
    assert((channels == 3 || channels == 4) && (bits == 8 || bits == 16));
    assert(width >= 1 && width <= IMAGE_SIDE_MAX && height >= 1 && height <= IMAGE_SIDE_MAX);
    OutFile out;
    TRY(out_begin(diag, path, &out));
    PngJob job = {.diag = diag, .path = path};
    size_t row_values = (size_t)width * (size_t)channels;
    Status status = alloc_rows(&job, (size_t)height, row_values * (size_t)(bits / 8));
    if (status == OK) {
        pack_pixels(job.bytes, pixels, row_values * (size_t)height, bits);
        job.file = fopen(out.temp_path, "wb");
        job.error = errno;
        bool is_written = job.file && write_stream(&job, (png_uint_32)width, (png_uint_32)height,
                                                   channels, bits, is_srgb, meta);
        if (!job.file)
            snprintf(job.message, sizeof job.message, "%s", strerror(job.error));
        if (!is_written)
            status = refuse(&job, "write");
        if (job.file && fclose(job.file) != 0 && status == OK)
            status = diag_fail(diag, ERR_FILE, "cannot write '%s': %s", path, strerror(errno));
    }
    png_destroy_write_struct(&job.png, &job.info);
    mem_free(job.rows);
    mem_free(job.bytes);
    if (status == OK)
        return out_commit(diag, &out);
    out_discard(&out);
    return status;
}

/* --- in --- */

/* Ask libpng for RGB or RGBA of 8 or 16 bits, whatever the file has. */
static void normalise(PngJob *job)
{
    png_set_expand(job->png);
    png_set_gray_to_rgb(job->png);
    png_set_interlace_handling(job->png);
    png_read_update_info(job->png, job->info);
}

static bool open_stream(PngJob *job, void (*prepare)(PngJob *job))
{
    job->png = png_create_read_struct_2(PNG_LIBPNG_VER_STRING, job, fail_job, ignore_warning, job,
                                        job_alloc, job_free);
    job->info = job->png ? png_create_info_struct(job->png) : NULL;
    if (!job->info)
        return false;
    if (setjmp(png_jmpbuf(job->png)))
        return false;
    png_init_io(job->png, job->file);
    png_set_user_limits(job->png, IMAGE_SIDE_MAX, IMAGE_SIDE_MAX);
    png_set_chunk_malloc_max(job->png, PNG_CHUNK_BYTES_MAX);
    png_set_chunk_cache_max(job->png, PNG_CHUNKS_MAX);
    png_read_info(job->png, job->info);
    /* The compressed pixels cannot hold more than so much: refuse the rest unread. */
    double packed = (double)png_get_rowbytes(job->png, job->info) *
                    (double)png_get_image_height(job->png, job->info);
    if (packed > (double)PNG_RATIO_MAX * (double)job->file_bytes)
        png_error(job->png, "the file ends too early");
    prepare(job);
    return true;
}

static bool read_rows(PngJob *job)
{
    if (setjmp(png_jmpbuf(job->png)))
        return false;
    png_read_image(job->png, job->rows);
    png_read_end(job->png, NULL);
    return true;
}

double png_job_gamma(PngJob *job)
{
    int intent;
    double gamma;
    if (png_get_sRGB(job->png, job->info, &intent) || !png_get_gAMA(job->png, job->info, &gamma) ||
        !(gamma > 0.01 && gamma < 100))
        return 0;
    return fabs(gamma - 1 / 2.2) < 0.02 ? 0 : 1 / gamma;
}

static void unpack_pixels(const PngJob *job, ImageLayer *layer, size_t count, int bits)
{
    if (bits == 16) {
        for (size_t i = 0; i < count; i++)
            layer->pixels[i] = (float)(job->bytes[2 * i] << 8 | job->bytes[2 * i + 1]) / 65535.0f;
        return;
    }
    for (size_t i = 0; i < count; i++)
        layer->pixels[i] = (float)job->bytes[i] / 255.0f;
}

/* Bring colours with another gamma than a display's to the sRGB curve. */
static void encode_pixels(ImageLayer *layer, size_t pixel_count, double exponent)
{
    for (size_t i = 0; i < pixel_count; i++) {
        float *pixel = layer->pixels + i * (size_t)layer->channel_count;
        for (int c = 0; c < 3; c++)
            pixel[c] = srgb_encode((float)pow(pixel[c], exponent));
    }
}

static Status read_pixels(PngJob *job, Image *out)
{
    png_uint_32 width = png_get_image_width(job->png, job->info);
    png_uint_32 height = png_get_image_height(job->png, job->info);
    int channels = png_get_channels(job->png, job->info);
    int bits = png_get_bit_depth(job->png, job->info);
    assert((channels == 3 || channels == 4) && (bits == 8 || bits == 16));
    double exponent = png_job_gamma(job);

    TRY(png_job_rows(job));
    image_init(out, (int)width, (int)height);
    ImageLayer *layer = image_add_layer(out, "", channels == 4 ? "RGBA" : "RGB");
    if (!layer)
        return diag_no_memory(job->diag, job->path);
    out->is_display = true;
    size_t pixel_count = (size_t)width * height;
    unpack_pixels(job, layer, pixel_count * (size_t)channels, bits);
    if (exponent > 0)
        encode_pixels(layer, pixel_count, exponent);
    return OK;
}

Status png_job_begin(PngJob *job, void (*prepare)(PngJob *job))
{
    int fd;
    TRY(file_open_input(job->diag, job->path, &fd, &job->file_bytes));
    job->file = fdopen(fd, "rb");
    if (!job->file) {
        close(fd);
        return diag_fail(job->diag, ERR_FILE, "cannot open '%s': %s", job->path, strerror(errno));
    }
    return open_stream(job, prepare) ? OK : refuse(job, "read");
}

Status png_job_rows(PngJob *job)
{
    TRY(alloc_rows(job, png_get_image_height(job->png, job->info),
                   png_get_rowbytes(job->png, job->info)));
    return read_rows(job) ? OK : refuse(job, "read");
}

void png_job_end(PngJob *job)
{
    png_destroy_read_struct(&job->png, &job->info, NULL);
    if (job->file)
        fclose(job->file);
    mem_free(job->rows);
    mem_free(job->bytes);
}

Status png_read(Diag *diag, const char *path, Image *out)
{
    *out = (Image){0};
    PngJob job = {.diag = diag, .path = path};
    Status status = png_job_begin(&job, normalise);
    if (status == OK)
        status = read_pixels(&job, out);
    png_job_end(&job);
    if (status != OK)
        image_done(out);
    return status;
}
