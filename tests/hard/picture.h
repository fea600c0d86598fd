/* Pictures of a scene file with numbers declared, by pms and by the installed povray, and how many
 * pixels of two of them differ.  Include after cmocka.h.
 *
 * povray writes 16 bits a channel, so that both are looked at about equally closely.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TESTS_PICTURE_H
#define PMS_TESTS_PICTURE_H

#include "base/child.h"
#include "base/work.h"
#include "image/compare.h"
#include "render/render.h"
#include "sdl/sdl.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { DECLARES_MAX = 16, DECLARES_BYTES = 512 };

/* What makes a picture. */
typedef struct Shot {
    const char *scene;
    const char *declares[2]; /* "NAME=VALUE ..."; the second may be NULL and wins */
    int width, height;
    bool is_by_povray;
} Shot;

typedef struct Declares {
    int count;
    char text[DECLARES_BYTES];
    SdlDeclare items[DECLARES_MAX];
} Declares;

static inline void declares_read(const Shot *shot, Declares *out)
{
    out->count = 0;
    snprintf(out->text, sizeof out->text, "%s %s", shot->declares[0],
             shot->declares[1] ? shot->declares[1] : "");
    for (char *word = strtok(out->text, " "); word; word = strtok(NULL, " ")) {
        char *equals = strchr(word, '=');
        assert_non_null(equals);
        assert_true(out->count < DECLARES_MAX);
        *equals = 0;
        int at = 0;
        while (at < out->count && strcmp(out->items[at].name, word) != 0)
            at++;
        out->items[at] = (SdlDeclare){word, equals + 1};
        out->count += at == out->count;
    }
}

/* Keep the last message, for when something is wrong. */
static inline void picture_keep_message(void *ctx, const char *text)
{
    snprintf(ctx, 1024, "%s", text);
}

static inline bool picture_by_pms(const Shot *shot, Image *out)
{
    static const char *const folders[] = {"tests/hard", "scenes", "stdlib"};
    static char message[1024];
    Declares declares;
    declares_read(shot, &declares);
    Diag diag;
    diag_init(&diag, picture_keep_message, message);
    SdlOptions sdl = {.library_paths = folders,
                      .library_path_count = 3,
                      .declares = declares.items,
                      .declare_count = declares.count,
                      .width = shot->width,
                      .height = shot->height,
                      .threads = work_thread_count()};
    Scene *scene;
    if (sdl_load(&diag, shot->scene, &sdl, &scene) != OK)
        fail_msg("%s: %s", shot->scene, message);
    RenderOptions options = RENDER_OPTIONS_DEFAULT;
    RenderResult result;
    options.width = shot->width;
    options.height = shot->height;
    options.threads = work_thread_count();
    if (render_scene(scene, &options, &diag, &result) != OK)
        fail_msg("%s: %s", shot->scene, message);
    assert_int_equal(result.stats.count[STAT_NAN_SAMPLE], 0);
    *out = result.image;
    result.image = (Image){0};
    render_result_done(&result);
    scene_free(scene);
    diag_done(&diag);
    return true;
}

static inline bool run_povray(const Shot *shot, Image *out)
{
    Declares declares;
    declares_read(shot, &declares);
    char path[64], log[64], words[DECLARES_MAX + 5][300];
    char *argv[DECLARES_MAX + 20] = {"povray",       "-D",       "-A",       "+FN16", "-GA",
                                     "+Ltests/hard", "+Lscenes", "+Lstdlib", "+WT2"};
    int count = 0, word = 9;
    snprintf(path, sizeof path, "/tmp/pms_hard_%ld.png", (long)getpid());
    snprintf(log, sizeof log, "/tmp/pms_hard_%ld.log", (long)getpid());
    snprintf(words[count++], 300, "+I%s", shot->scene);
    snprintf(words[count++], 300, "+O%s", path);
    snprintf(words[count++], 300, "+W%d", shot->width);
    snprintf(words[count++], 300, "+H%d", shot->height);
    for (int i = 0; i < declares.count; i++)
        snprintf(words[count++], 300, "Declare=%s=%s", declares.items[i].name,
                 declares.items[i].value);
    for (int i = 0; i < count; i++)
        argv[word++] = words[i];
    Diag diag;
    diag_init(&diag, diag_drop, NULL);
    int ended = 1;
    remove(path);
    Status status = child_run(&diag, argv, NULL, log, log, &ended);
    bool is_made = status == OK && WIFEXITED(ended) && WEXITSTATUS(ended) == 0 &&
                   image_load(&diag, path, out) == OK;
    remove(path);
    remove(log);
    diag_done(&diag);
    return is_made;
}

/* Returns false if povray makes no picture of it, twice: a crowded machine may be in its way. */
static inline bool picture_by_povray(const Shot *shot, Image *out)
{
    return run_povray(shot, out) || run_povray(shot, out);
}

static inline bool picture_make(const Shot *shot, Image *out)
{
    return shot->is_by_povray ? picture_by_povray(shot, out) : picture_by_pms(shot, out);
}

typedef struct Difference {
    int changed; /* pixels of which any bit differs */
    int visible; /* pixels of which a display value differs by more than 1/255 */
    int blocks;  /* of pixels: their mean display value differs by more than BLOCK_LIMIT */
} Difference;

enum { BLOCK_SIDE = 10 };
#define BLOCK_LIMIT 0.03

/* Count blocks of display values whose means differ. */
static inline int count_blocks(const Image *a, const Image *b)
{
    int count = 0, channels = a->layers[0].channel_count;
    for (int y = 0; y < a->height; y += BLOCK_SIDE)
        for (int x = 0; x < a->width; x += BLOCK_SIDE) {
            double sum = 0;
            for (int i = 0; i < BLOCK_SIDE * BLOCK_SIDE; i++) {
                int row = y + i / BLOCK_SIDE, column = x + i % BLOCK_SIDE;
                if (row >= a->height || column >= a->width)
                    continue;
                const float *p = a->layers[0].pixels + (row * a->width + column) * channels;
                const float *q = b->layers[0].pixels + (row * a->width + column) * channels;
                sum += (double)(p[0] + p[1] + p[2]) - (double)(q[0] + q[1] + q[2]);
            }
            count += !(fabs(sum) / (3 * BLOCK_SIDE * BLOCK_SIDE) <= BLOCK_LIMIT);
        }
    return count;
}

/* Both are display values afterwards. */
static inline Difference picture_difference(Image *a, Image *b)
{
    Difference out = {0, 0, 0};
    ImageLayer *p = &a->layers[0], *q = &b->layers[0];
    int pixels = a->width * a->height, channels = p->channel_count;
    assert_true(a->width == b->width && a->height == b->height);
    assert_int_equal(channels, q->channel_count);
    for (int i = 0; i < pixels; i++)
        out.changed += memcmp(p->pixels + i * channels, q->pixels + i * channels,
                              (size_t)channels * sizeof(float)) != 0;
    image_to_display(a);
    image_to_display(b);
    for (int i = 0; i < pixels; i++) {
        bool is_visible = false;
        for (int c = 0; c < 3; c++) {
            float d = p->pixels[i * channels + c] - q->pixels[i * channels + c];
            is_visible |= !(fabsf(d) <= 1 / 255.0F);
        }
        out.visible += is_visible;
    }
    out.blocks = count_blocks(a, b);
    return out;
}

/* The picture that was made last; most cases compare with the one before. */
typedef struct Kept {
    Image image;
    char key[DECLARES_BYTES];
} Kept;

static inline bool picture_base(const Shot *shot, Image *out)
{
    static Kept kept;
    char key[DECLARES_BYTES];
    snprintf(key, sizeof key, "%d %d %s %s", shot->is_by_povray, shot->width, shot->scene,
             shot->declares[0]);
    if (strcmp(key, kept.key) != 0) {
        image_done(&kept.image);
        kept = (Kept){0};
        if (!picture_make(shot, &kept.image))
            return false;
        memcpy(kept.key, key, sizeof key);
    }
    const ImageLayer *layer = &kept.image.layers[0];
    image_init(out, kept.image.width, kept.image.height);
    out->is_display = kept.image.is_display;
    ImageLayer *copy = image_add_layer(out, "", layer->channels);
    assert_non_null(copy);
    memcpy(copy->pixels, layer->pixels,
           (size_t)(out->width * out->height * layer->channel_count) * sizeof(float));
    return true;
}

#endif
