/* OpenEXR in.
 *
 * Files come from anywhere: every size is checked against the file's own length before memory
 * is asked for, and a chunk that is missing or broken refuses the whole file.
 * SPDX-License-Identifier: Apache-2.0 */
#include "image/exr.h"

#include "base/file.h"
#include "base/mem.h"
#include "image/exr_int.h"

#include <stdint.h>
#include <string.h>
#include <unistd.h>

#include <half.h>

enum {
    READ_CHANNELS_MAX = 1024,
    PACK_RATIO_MAX = 1100 /* deflate packs 1032 to 1 at best, the other methods less */
};

/* Where a channel of the file goes. */
typedef struct ReadChannel {
    int layer;  /* -1: not read */
    int offset; /* floats from the start of a pixel */
} ReadChannel;

typedef struct ExrReader {
    Diag *diag;
    const char *path;
    ExrStream stream;
    size_t file_bytes;
    exr_context_t context;
    const exr_attr_chlist_t *list;
    exr_attr_box2i_t window;
    ReadChannel *channels;
    Image *image;
} ExrReader;

static Status refuse(const ExrReader *r, const char *reason)
{
    return diag_fail(r->diag, ERR_FILE, "cannot read '%s': %s", r->path, reason);
}

static Status refuse_code(const ExrReader *r, exr_result_t code)
{
    return exr_refuse(r->diag, "read", r->path, &r->stream, code);
}

/* A channel's name is layer.letter; a name without a dot belongs to the beauty if it is one of
 * its letters, else it is a layer of its own.  Returns false when the layer's name is too
 * long for us. */
static bool split_name(const char *name, char layer[IMAGE_NAME_MAX], char *letter)
{
    const char *dot = strrchr(name, '.');
    bool is_beauty = !dot && name[0] && !name[1] && strchr("RGBAY", name[0]);
    bool is_layer = dot && dot[1] && !dot[2];
    size_t length = is_beauty ? 0 : is_layer ? (size_t)(dot - name) : strlen(name);
    if (length >= IMAGE_NAME_MAX)
        return false;
    memcpy(layer, name, length);
    layer[length] = 0;
    *letter = is_beauty ? name[0] : is_layer ? dot[1] : name[0] && !name[1] ? name[0] : 'Y';
    return true;
}

/* Return where a channel's letter stands in a pixel. */
static int letter_rank(char letter)
{
    static const char order[] = "RGBAXYZUVW";
    const char *found = letter ? strchr(order, letter) : NULL;
    return found ? (int)(found - order) : (int)sizeof order + (unsigned char)letter;
}

static void insert_letter(char *letters, size_t room, char letter)
{
    size_t length = strlen(letters);
    if (strchr(letters, letter) || length + 1 >= room)
        return;
    size_t at = length;
    while (at > 0 && letter_rank(letters[at - 1]) > letter_rank(letter)) {
        letters[at] = letters[at - 1];
        at--;
    }
    letters[at] = letter;
    letters[length + 1] = 0;
}

/* Collect the letters of the layer `name` among the channels of the file. */
static void layer_letters(const ExrReader *r, const char *name, char *letters, size_t room)
{
    letters[0] = 0;
    for (int i = 0; i < r->list->num_channels; i++) {
        char layer[IMAGE_NAME_MAX];
        char letter;
        if (split_name(r->list->entries[i].name.str, layer, &letter) && strcmp(layer, name) == 0)
            insert_letter(letters, room, letter);
    }
}

static int layer_index(const Image *image, const char *name)
{
    ImageLayer *layer = image_find_layer(image, name);
    return layer ? (int)(layer - image->layers) : -1;
}

/* Make the layers (the beauty first) and note where each channel goes. */
static Status make_layers(ExrReader *r, bool is_beauty)
{
    for (int i = 0; i < r->list->num_channels; i++) {
        const char *name = r->list->entries[i].name.str;
        char layer[IMAGE_NAME_MAX];
        char letters[sizeof r->image->layers->channels];
        char letter;
        if (!split_name(name, layer, &letter)) {
            r->channels[i].layer = -1;
            if (is_beauty)
                diag_warn(r->diag, WARN_FILE, SPAN_NONE,
                          "'%s': channel '%.40s...' is not read: its name is too long", r->path,
                          name);
            continue;
        }
        if ((layer[0] == 0) != is_beauty)
            continue;
        if (layer_index(r->image, layer) < 0) {
            layer_letters(r, layer, letters, sizeof letters);
            if (!image_add_layer(r->image, layer, letters))
                return diag_no_memory(r->diag, r->path);
        }
        r->channels[i].layer = layer_index(r->image, layer);
        r->channels[i].offset = image_channel(&r->image->layers[r->channels[i].layer], letter);
        if (r->channels[i].offset < 0)
            return refuse(r, "a layer has more than 7 channels");
    }
    return OK;
}

static Status check_channels(const ExrReader *r)
{
    if (r->list->num_channels < 1)
        return refuse(r, "it has no channels");
    if (r->list->num_channels > READ_CHANNELS_MAX)
        return refuse(r, "it has more than 1024 channels");
    for (int i = 0; i < r->list->num_channels; i++) {
        const exr_attr_chlist_entry_t *entry = &r->list->entries[i];
        if (entry->x_sampling != 1 || entry->y_sampling != 1)
            return refuse(r, "sub-sampled channels are not supported");
        if (entry->pixel_type < EXR_PIXEL_UINT || entry->pixel_type > EXR_PIXEL_FLOAT)
            return refuse(r, "a channel has an unknown pixel type");
    }
    return OK;
}

/* Refuse sizes that the file is too short to hold, before memory is asked for. */
static Status check_size(const ExrReader *r, int width, int height)
{
    int32_t chunks = 0;
    exr_get_chunk_count(r->context, 0, &chunks);
    double bytes = 2.0 * width * height * r->list->num_channels;
    if (chunks < 1 || (double)chunks * 16 > (double)r->file_bytes ||
        bytes > PACK_RATIO_MAX * (double)r->file_bytes)
        return refuse(r, "the file ends too early");
    return OK;
}

static Status check_header(ExrReader *r)
{
    int parts = 0;
    exr_storage_t storage = EXR_STORAGE_LAST_TYPE;
    exr_get_count(r->context, &parts);
    if (parts != 1)
        return refuse(r, "it has more than one part");
    exr_get_storage(r->context, 0, &storage);
    if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED)
        return refuse(r, "deep images are not supported");
    exr_result_t code = exr_get_data_window(r->context, 0, &r->window);
    if (code == EXR_ERR_SUCCESS)
        code = exr_get_channels(r->context, 0, &r->list);
    if (code != EXR_ERR_SUCCESS)
        return refuse_code(r, code);

    int64_t width = (int64_t)r->window.max.x - r->window.min.x + 1;
    int64_t height = (int64_t)r->window.max.y - r->window.min.y + 1;
    if (width < 1 || height < 1 || width > IMAGE_SIDE_MAX || height > IMAGE_SIDE_MAX)
        return diag_fail(r->diag, ERR_FILE, "cannot read '%s': its size is %lldx%lld", r->path,
                         (long long)width, (long long)height);
    TRY(check_channels(r));
    TRY(check_size(r, (int)width, (int)height));
    image_init(r->image, (int)width, (int)height);
    return OK;
}

/* Return number `i` of a line of a channel as the file holds it, little-endian. */
static float number_at(const uint8_t *line, int i, exr_pixel_type_t type)
{
    const uint8_t *at = line + (size_t)i * (type == EXR_PIXEL_HALF ? 2 : 4);
    if (type == EXR_PIXEL_HALF)
        return imath_half_to_float((uint16_t)(at[0] | at[1] << 8));
    uint32_t bits =
        (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
    float number;
    memcpy(&number, &bits, sizeof number);
    return type == EXR_PIXEL_UINT ? (float)bits : number;
}

/* Take a chunk apart: line by line, channel by channel.  The library's own routine for files of
 * four half channels mixes them up (3.1.5). */
static exr_result_t unpack(exr_decode_pipeline_t *decoder)
{
    /* What is not compressed stays where it was read to. */
    bool is_packed = !decoder->unpacked_buffer;
    const uint8_t *from = is_packed ? decoder->packed_buffer : decoder->unpacked_buffer;
    uint64_t size = is_packed ? decoder->chunk.packed_size : decoder->chunk.unpacked_size;
    uint64_t needed = 0;
    for (int16_t c = 0; c < decoder->channel_count; c++)
        needed += (uint64_t)decoder->channels[c].width * (uint64_t)decoder->chunk.height *
                  (uint64_t)decoder->channels[c].bytes_per_element;
    if (!from || size < needed)
        return EXR_ERR_CORRUPT_CHUNK;
    for (int line = 0; line < decoder->chunk.height; line++) {
        for (int16_t c = 0; c < decoder->channel_count; c++) {
            const exr_coding_channel_info_t *info = &decoder->channels[c];
            exr_pixel_type_t type = (exr_pixel_type_t)info->data_type;
            uint8_t *to = info->decode_to_ptr;
            if (to)
                to += (ptrdiff_t)line * info->user_line_stride;
            for (int i = 0; to && i < info->width; i++, to += info->user_pixel_stride) {
                float number = number_at(from, i, type);
                memcpy(to, &number, sizeof number);
            }
            from += (size_t)info->width * (size_t)info->bytes_per_element;
        }
    }
    return EXR_ERR_SUCCESS;
}

/* Point the decoder's channels at the pixel (x, y) of our layers. */
static void aim_decoder(const ExrReader *r, exr_decode_pipeline_t *decoder, int x, int y)
{
    size_t pixel = (size_t)y * (size_t)r->image->width + (size_t)x;
    for (int16_t c = 0; c < decoder->channel_count; c++) {
        exr_coding_channel_info_t *info = &decoder->channels[c];
        const ReadChannel *channel = &r->channels[c];
        if (channel->layer < 0) {
            info->decode_to_ptr = NULL;
            continue;
        }
        const ImageLayer *layer = &r->image->layers[channel->layer];
        int stride = layer->channel_count * (int)sizeof(float);
        float *to = layer->pixels + pixel * (size_t)layer->channel_count + channel->offset;
        info->decode_to_ptr = (uint8_t *)to;
        info->user_data_type = EXR_PIXEL_FLOAT;
        info->user_bytes_per_element = sizeof(float);
        info->user_pixel_stride = stride;
        info->user_line_stride = stride * r->image->width;
    }
}

static exr_result_t decode_chunk(const ExrReader *r, exr_decode_pipeline_t *decoder,
                                 const exr_chunk_info_t *chunk, int x, int y)
{
    exr_result_t code = decoder->context ? exr_decoding_update(r->context, 0, chunk, decoder)
                                         : exr_decoding_initialize(r->context, 0, chunk, decoder);
    if (code != EXR_ERR_SUCCESS)
        return code;
    if (decoder->channel_count != r->list->num_channels)
        return EXR_ERR_INVALID_ATTR;
    aim_decoder(r, decoder, x, y);
    code = exr_decoding_choose_default_routines(r->context, 0, decoder);
    if (decoder->unpack_and_convert_fn) /* else floats are read straight to their place */
        decoder->unpack_and_convert_fn = unpack;
    return code == EXR_ERR_SUCCESS ? exr_decoding_run(r->context, 0, decoder) : code;
}

static exr_result_t decode_scanlines(const ExrReader *r, exr_decode_pipeline_t *decoder)
{
    int32_t lines = 0;
    exr_result_t code = exr_get_scanlines_per_chunk(r->context, 0, &lines);
    if (code != EXR_ERR_SUCCESS || lines < 1)
        return EXR_ERR_INVALID_ATTR;
    for (int y = 0; y < r->image->height && code == EXR_ERR_SUCCESS; y += lines) {
        exr_chunk_info_t chunk;
        code = exr_read_scanline_chunk_info(r->context, 0, r->window.min.y + y, &chunk);
        if (code == EXR_ERR_SUCCESS)
            code = decode_chunk(r, decoder, &chunk, 0, y);
    }
    return code;
}

static exr_result_t decode_tiles(const ExrReader *r, exr_decode_pipeline_t *decoder)
{
    int32_t width = 0, height = 0;
    exr_result_t code = exr_get_tile_sizes(r->context, 0, 0, 0, &width, &height);
    if (code != EXR_ERR_SUCCESS || width < 1 || height < 1)
        return EXR_ERR_INVALID_ATTR;
    for (int y = 0; y < r->image->height && code == EXR_ERR_SUCCESS; y += height) {
        for (int x = 0; x < r->image->width && code == EXR_ERR_SUCCESS; x += width) {
            exr_chunk_info_t chunk;
            code = exr_read_tile_chunk_info(r->context, 0, x / width, y / height, 0, 0, &chunk);
            if (code == EXR_ERR_SUCCESS)
                code = decode_chunk(r, decoder, &chunk, x, y);
        }
    }
    return code;
}

static Status read_pixels(ExrReader *r)
{
    exr_storage_t storage = EXR_STORAGE_SCANLINE;
    exr_get_storage(r->context, 0, &storage);
    exr_decode_pipeline_t decoder = EXR_DECODE_PIPELINE_INITIALIZER;
    exr_result_t code =
        storage == EXR_STORAGE_TILED ? decode_tiles(r, &decoder) : decode_scanlines(r, &decoder);
    if (decoder.context)
        exr_decoding_destroy(r->context, &decoder);
    if (code != EXR_ERR_SUCCESS)
        return refuse_code(r, code);
    return OK;
}

static Status read_stream(ExrReader *r)
{
    exr_context_initializer_t settings = exr_stream_settings(&r->stream, true);
    exr_result_t code = exr_start_read(&r->context, r->path, &settings);
    if (code != EXR_ERR_SUCCESS)
        return refuse_code(r, code);
    Status status = check_header(r);
    if (status == OK) {
        r->channels = mem_array((size_t)r->list->num_channels, sizeof *r->channels);
        status = r->channels ? OK : diag_no_memory(r->diag, r->path);
    }
    if (status == OK)
        status = make_layers(r, true);
    if (status == OK)
        status = make_layers(r, false);
    if (status == OK)
        status = read_pixels(r);
    mem_free(r->channels);
    exr_finish(&r->context);
    return status;
}

Status exr_read(Diag *diag, const char *path, Image *out)
{
    *out = (Image){0};
    ExrReader r = {.diag = diag, .path = path, .image = out};
    TRY(file_open_input(diag, path, &r.stream.fd, &r.file_bytes));
    Status status = read_stream(&r);
    close(r.stream.fd);
    if (status != OK)
        image_done(out);
    return status;
}
