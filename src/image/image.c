/* Pixel buffers.  SPDX-License-Identifier: Apache-2.0 */
#include "image/image.h"

#include "base/mem.h"

#include <assert.h>
#include <string.h>

void image_init(Image *image, int width, int height)
{
    assert(width >= 1 && width <= IMAGE_SIDE_MAX && height >= 1 && height <= IMAGE_SIDE_MAX);
    *image = (Image){.width = width, .height = height};
}

ImageLayer *image_add_layer(Image *image, const char *name, const char *channels)
{
    size_t name_length = strlen(name);
    size_t channel_count = strlen(channels);
    assert(name_length < IMAGE_NAME_MAX);
    assert(channel_count >= 1 && channel_count < sizeof image->layers->channels);

    size_t count = (size_t)image->layer_count;
    ImageLayer *grown = mem_resize(image->layers, (count + 1) * sizeof *grown);
    if (!grown)
        return NULL;
    image->layers = grown;
    float *pixels =
        mem_array((size_t)image->width * (size_t)image->height, channel_count * sizeof *pixels);
    if (!pixels)
        return NULL;
    ImageLayer *layer = &image->layers[count];
    *layer = (ImageLayer){.channel_count = (int)channel_count, .pixels = pixels};
    memcpy(layer->name, name, name_length + 1);
    memcpy(layer->channels, channels, channel_count + 1);
    image->layer_count++;
    return layer;
}

void image_drop_layer(Image *image)
{
    assert(image->layer_count > 0);
    mem_free(image->layers[--image->layer_count].pixels);
}

ImageLayer *image_find_layer(const Image *image, const char *name)
{
    for (int i = 0; i < image->layer_count; i++) {
        if (strcmp(image->layers[i].name, name) == 0)
            return &image->layers[i];
    }
    return NULL;
}

int image_channel(const ImageLayer *layer, char letter)
{
    const char *found = letter ? strchr(layer->channels, letter) : NULL;
    return found ? (int)(found - layer->channels) : -1;
}

void image_crop(Image *image, int x, int y, int width, int height)
{
    assert(x >= 0 && y >= 0 && width >= 1 && height >= 1);
    assert(width <= image->width - x && height <= image->height - y);
    for (int i = 0; i < image->layer_count; i++) {
        size_t count = (size_t)image->layers[i].channel_count;
        float *pixels = image->layers[i].pixels;
        for (size_t row = 0; row < (size_t)height; row++) {
            size_t from = ((size_t)y + row) * (size_t)image->width + (size_t)x;
            memmove(pixels + row * (size_t)width * count, pixels + from * count,
                    (size_t)width * count * sizeof *pixels);
        }
    }
    image->width = width;
    image->height = height;
}

void image_done(Image *image)
{
    for (int i = 0; i < image->layer_count; i++)
        mem_free(image->layers[i].pixels);
    mem_free(image->layers);
    image->layers = NULL;
    image->layer_count = 0;
}
