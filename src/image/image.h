/* Pixel buffers: named layers of float channels.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_IMAGE_IMAGE_H
#define PMS_IMAGE_IMAGE_H

#include "base/diag.h"

#include <stdbool.h>
#include <stddef.h>

enum { IMAGE_SIDE_MAX = 65536, IMAGE_NAME_MAX = 64 };

typedef struct ImageLayer {
    char name[IMAGE_NAME_MAX]; /* "" for the beauty, else "direct", "N" ... */
    char channels[8];          /* one letter each: "RGBA", "RGB", "Z", "XYZ" */
    int channel_count;
    float *pixels; /* width * height * channel_count, top row first, interleaved */
} ImageLayer;

typedef struct Image {
    int width, height;
    int layer_count;
    ImageLayer *layers;
    bool is_display; /* PNG: values are display encoded, not linear */
} Image;

/* Make an image without layers.  width and height in [1, IMAGE_SIDE_MAX]. */
void image_init(Image *image, int width, int height);

/* Add a zeroed layer; NULL when memory is out.  Borrowed; adding may move earlier layers. */
ImageLayer *image_add_layer(Image *image, const char *name, const char *channels);

/* Remove the last layer. */
void image_drop_layer(Image *image);

/* Return the layer with this name, or NULL. */
ImageLayer *image_find_layer(const Image *image, const char *name);

/* Return the position of `letter` in the layer's channels, or -1. */
int image_channel(const ImageLayer *layer, char letter);

/* Cut every layer to the rectangle at (x, y), which lies inside the image, in place. */
void image_crop(Image *image, int x, int y, int width, int height);

void image_done(Image *image);

/* Text fields that go into a file's header. */
typedef struct MetaItem {
    const char *name, *value;
} MetaItem;
typedef struct Meta {
    const MetaItem *items;
    int count;
} Meta;

#endif
