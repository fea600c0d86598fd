/* OpenEXR out.
 *
 * One scanline part, zip-compressed in chunks of 16 lines: a round of them at once, written in
 * order.  The bytes depend on nothing but the image, the fields and the options: no date, no
 * host, not on the threads.
 * SPDX-License-Identifier: Apache-2.0 */
#include "image/exr.h"

#include "base/file.h"
#include "base/mem.h"
#include "base/work.h"
#include "image/exr_int.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum {
    ZIP_LEVEL = 4,     /* nearly as small as 9, several times as fast */
    ZIP_LINES = 16,    /* lines of a chunk, fixed by the format */
    ROUND_CHUNKS = 16, /* of a round, for each thread: bounds the memory */
    EXR_CHANNELS_MAX = 1024
};

#define HALF_MAX 65504.0f

/* One channel of the file and where its numbers are. */
typedef struct ExrChannel {
    char name[IMAGE_NAME_MAX + 8];
    const float *from; /* first pixel */
    int stride;        /* floats between pixels */
    bool is_half;
} ExrChannel;

/* Sixteen lines on their way into the file. */
typedef struct ExrChunk {
    int y;
    exr_encode_pipeline_t encoder; /* holds the compressed bytes until they are written */
    bool is_compressed;
    exr_result_t code;
} ExrChunk;

typedef struct ExrWriter {
    const Image *image;
    int threads;
    ExrStream stream;
    exr_context_t context;
    ExrChannel *channels;
    int channel_count;
    size_t block_size; /* floats: ZIP_LINES lines of each channel */
    float *blocks;     /* one a thread */
    ExrChunk *round;
} ExrWriter;

/* Return true if a channel holds colours, which may be stored as half. */
static bool is_colour(const ImageLayer *layer, char letter)
{
    bool is_rgb = image_channel(layer, 'R') >= 0 || image_channel(layer, 'Y') == 0;
    return is_rgb && strchr("RGBAY", letter);
}

static void name_channel(ExrChannel *channel, const ImageLayer *layer, char letter)
{
    bool is_plain = !layer->name[0] ||
                    (layer->channel_count == 1 && layer->name[0] == letter && !layer->name[1]);
    if (is_plain)
        snprintf(channel->name, sizeof channel->name, "%c", letter);
    else
        snprintf(channel->name, sizeof channel->name, "%s.%c", layer->name, letter);
}

static void list_channels(ExrWriter *w, bool is_half)
{
    for (int i = 0; i < w->image->layer_count; i++) {
        const ImageLayer *layer = &w->image->layers[i];
        for (int c = 0; c < layer->channel_count; c++) {
            ExrChannel *channel = &w->channels[w->channel_count++];
            name_channel(channel, layer, layer->channels[c]);
            channel->from = layer->pixels + c;
            channel->stride = layer->channel_count;
            channel->is_half = is_half && is_colour(layer, layer->channels[c]);
        }
    }
}

static exr_result_t declare_image(ExrWriter *w, const Meta *meta)
{
    static const exr_attr_chromaticities_t rec709 = {0.64f, 0.33f, 0.30f,   0.60f,
                                                     0.15f, 0.06f, 0.3127f, 0.3290f};
    int part = 0;
    exr_result_t code = exr_add_part(w->context, NULL, EXR_STORAGE_SCANLINE, &part);
    if (code == EXR_ERR_SUCCESS)
        code = exr_initialize_required_attr_simple(w->context, part, w->image->width,
                                                   w->image->height, EXR_COMPRESSION_ZIP);
    if (code == EXR_ERR_SUCCESS)
        code = exr_set_zip_compression_level(w->context, part, ZIP_LEVEL);
    for (int i = 0; i < w->channel_count && code == EXR_ERR_SUCCESS; i++)
        code = exr_add_channel(w->context, part, w->channels[i].name,
                               w->channels[i].is_half ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT,
                               EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    if (code == EXR_ERR_SUCCESS)
        code = exr_attr_set_chromaticities(w->context, part, "chromaticities", &rec709);
    for (int i = 0; meta && i < meta->count && code == EXR_ERR_SUCCESS; i++)
        code = exr_attr_set_string(w->context, part, meta->items[i].name, meta->items[i].value);
    return code;
}

static const ExrChannel *find_channel(const ExrWriter *w, const char *name)
{
    for (int i = 0; i < w->channel_count; i++) {
        if (strcmp(w->channels[i].name, name) == 0)
            return &w->channels[i];
    }
    return NULL;
}

/* Copy `count` numbers of a channel into one block; half channels are kept in range, so that a
 * very bright pixel does not become infinite. */
static void copy_line(const ExrChannel *channel, size_t first_pixel, size_t count, float *to)
{
    const float *from = channel->from + first_pixel * (size_t)channel->stride;
    float limit = channel->is_half ? HALF_MAX : INFINITY;
    for (size_t i = 0; i < count; i++, from += channel->stride) {
        float v = *from;
        to[i] = v > limit ? limit : v < -limit ? -limit : v;
    }
}

/* Lay out the lines of a chunk in `block`, and tell the encoder where they are. */
static void fill_chunk(const ExrWriter *w, ExrChunk *chunk, float *block)
{
    size_t width = (size_t)w->image->width;
    for (int16_t c = 0; c < chunk->encoder.channel_count; c++, block += ZIP_LINES * width) {
        exr_coding_channel_info_t *info = &chunk->encoder.channels[c];
        const ExrChannel *channel = find_channel(w, info->channel_name);
        for (size_t line = 0; line < (size_t)info->height; line++)
            copy_line(channel, ((size_t)chunk->y + line) * width, width, block + line * width);
        info->encode_from_ptr = (const uint8_t *)block;
        info->user_data_type = EXR_PIXEL_FLOAT;
        info->user_bytes_per_element = sizeof(float);
        info->user_pixel_stride = sizeof(float);
        info->user_line_stride = (int32_t)(width * sizeof(float));
    }
}

/* The library asks, with the bytes ready, for this chunk's turn to be written, or writes them.  The
 * round is written when all of it is ready. */
static exr_result_t keep_bytes(exr_encode_pipeline_t *encoder)
{
    ((ExrChunk *)encoder->encoding_user_data)->is_compressed = true;
    return EXR_ERR_INCORRECT_CHUNK;
}

static exr_result_t compress_chunk(const ExrWriter *w, ExrChunk *chunk, float *block)
{
    exr_chunk_info_t info;
    exr_result_t code = exr_write_scanline_chunk_info(w->context, 0, chunk->y, &info);
    if (code == EXR_ERR_SUCCESS)
        code = exr_encoding_initialize(w->context, 0, &info, &chunk->encoder);
    if (code != EXR_ERR_SUCCESS)
        return code;
    fill_chunk(w, chunk, block);
    code = exr_encoding_choose_default_routines(w->context, 0, &chunk->encoder);
    if (code != EXR_ERR_SUCCESS)
        return code;
    chunk->encoder.encoding_user_data = chunk;
    chunk->encoder.yield_until_ready_fn = chunk->encoder.write_fn = keep_bytes;
    code = exr_encoding_run(w->context, 0, &chunk->encoder);
    return chunk->is_compressed ? EXR_ERR_SUCCESS : code;
}

static void compress_item(void *ctx, size_t index, int thread)
{
    const ExrWriter *w = ctx;
    ExrChunk *chunk = &w->round[index];
    chunk->code = compress_chunk(w, chunk, w->blocks + (size_t)thread * w->block_size);
}

/* A chunk of the size it has uncompressed is read as such; the library (3.1.5) stores the
 * compressed bytes also when they happen to be just as many. */
static exr_result_t write_chunk(const ExrWriter *w, ExrChunk *chunk)
{
    const exr_encode_pipeline_t *encoder = &chunk->encoder;
    if (chunk->code != EXR_ERR_SUCCESS)
        return chunk->code;
    bool is_smaller = encoder->compressed_bytes < encoder->packed_bytes;
    return exr_write_scanline_chunk(
        w->context, 0, chunk->y, is_smaller ? encoder->compressed_buffer : encoder->packed_buffer,
        is_smaller ? encoder->compressed_bytes : encoder->packed_bytes);
}

/* Compress some chunks and write them; *y is the first line, and that after the last.  A picture
 * that is done is written even when the program is interrupted. */
static exr_result_t write_round(ExrWriter *w, int *y)
{
    size_t count = 0, most = (size_t)w->threads * ROUND_CHUNKS;
    for (; count < most && *y < w->image->height; *y += ZIP_LINES)
        w->round[count++] = (ExrChunk){.y = *y, .encoder = EXR_ENCODE_PIPELINE_INITIALIZER};
    exr_result_t code = EXR_ERR_SUCCESS;
    bool is_interrupted = work_for(w->threads, count, compress_item, w) != OK;
    for (size_t i = 0; i < count; i++) {
        if (is_interrupted && !w->round[i].encoder.context)
            compress_item(w, i, 0);
        if (code == EXR_ERR_SUCCESS)
            code = write_chunk(w, &w->round[i]);
        if (w->round[i].encoder.context)
            exr_encoding_destroy(w->context, &w->round[i].encoder);
    }
    return code;
}

static exr_result_t write_chunks(ExrWriter *w)
{
    exr_result_t code = EXR_ERR_SUCCESS;
    for (int y = 0; y < w->image->height && code == EXR_ERR_SUCCESS;)
        code = write_round(w, &y);
    return code;
}

static exr_result_t write_stream(ExrWriter *w, const char *path, const Meta *meta)
{
    exr_context_initializer_t settings = exr_stream_settings(&w->stream, false);
    exr_result_t code = exr_start_write(&w->context, path, EXR_WRITE_FILE_DIRECTLY, &settings);
    if (code != EXR_ERR_SUCCESS)
        return code;
    exr_set_longname_support(w->context, 1);
    code = declare_image(w, meta);
    if (code == EXR_ERR_SUCCESS)
        code = exr_write_header(w->context);
    if (code == EXR_ERR_SUCCESS)
        code = write_chunks(w);
    exr_result_t finished = exr_finish(&w->context);
    return code == EXR_ERR_SUCCESS ? finished : code;
}

static Status write_to(Diag *diag, ExrWriter *w, const OutFile *out, const Meta *meta)
{
    w->stream.fd = open(out->temp_path, O_WRONLY | O_CLOEXEC);
    if (w->stream.fd < 0) {
        w->stream.error = errno;
        return exr_refuse(diag, "write", out->path, &w->stream, EXR_ERR_FILE_ACCESS);
    }
    exr_result_t code = write_stream(w, out->path, meta);
    if (close(w->stream.fd) != 0 && !w->stream.error)
        w->stream.error = errno;
    if (code == EXR_ERR_SUCCESS && !w->stream.error)
        return OK;
    return exr_refuse(diag, "write", out->path, &w->stream, code);
}

static size_t count_channels(const Image *image)
{
    size_t count = 0;
    for (int i = 0; i < image->layer_count; i++)
        count += (size_t)image->layers[i].channel_count;
    return count;
}

Status exr_write(Diag *diag, const char *path, const Image *image, const Meta *meta,
                 ExrOptions options)
{
    size_t count = count_channels(image);
    assert(count >= 1 && count <= EXR_CHANNELS_MAX);
    OutFile out;
    TRY(out_begin(diag, path, &out));
    size_t threads = options.threads > 0 ? (size_t)options.threads : 1;
    ExrWriter w = {.image = image, .threads = (int)threads};
    w.block_size = count * ZIP_LINES * (size_t)image->width;
    w.channels = mem_array(count, sizeof *w.channels);
    w.blocks = mem_array(threads, w.block_size * sizeof *w.blocks);
    w.round = mem_array(threads * ROUND_CHUNKS, sizeof *w.round);
    Status status = OK;
    if (w.channels && w.blocks && w.round) {
        list_channels(&w, options.is_half);
        status = write_to(diag, &w, &out, meta);
    } else {
        status = diag_no_memory(diag, path);
    }
    mem_free(w.round);
    mem_free(w.blocks);
    mem_free(w.channels);
    if (status == OK)
        return out_commit(diag, &out);
    out_discard(&out);
    return status;
}
