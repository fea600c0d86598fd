/* Reading scenes.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_SDL_SDL_H
#define PMS_SDL_SDL_H

#include "base/file.h"
#include "scene/scene.h"
#include "scene/scene_transform.h"

typedef struct SdlDeclare {
    const char *name;
    const char *value; /* a number, or a string in double quotes */
} SdlDeclare;

typedef struct SdlOptions {
    const char *const *library_paths; /* searched in order for includes, after the current folder
                                         and the folder of the including file */
    int library_path_count;
    const char *const *povray_folders; /* where POV-Ray's own include files may lie, up to a NULL:
                                          never read, but told of when one of them is missing;
                                          NULL: the usual places */
    const SdlDeclare *declares;
    int declare_count;
    int width, height;      /* for image_width and image_height */
    double clock;
    long max_tokens;        /* tokens evaluated; 0: SDL_MAX_TOKENS */
    size_t max_bytes;       /* of the scene in memory while it is read; 0: what the machine has */
    int threads;            /* for building mesh indices */
    const Similarity *moved_by; /* moves the whole scene once it is read; NULL: it stays */
} SdlOptions;

/* Return the i-th folder of pms's own include files ("" or one that does not exist: not here),
 * searched after all others; NULL past the last.  `out` is room for it. */
const char *sdl_own_folder(int i, char out[FILE_PATH_MAX]);

#define SDL_MAX_TOKENS 200000000L

/* Read the scene file at `path` and everything it includes.
 *
 * Fails with ERR_SYNTAX, ERR_SCENE, ERR_FILE or ERR_MEMORY after giving the messages; *out is
 * then NULL.  Free the scene with scene_free. */
Status sdl_load(Diag *diag, const char *path, const SdlOptions *options, Scene **out);

/* The same for a text in memory; `path` is what messages call it. */
Status sdl_load_text(Diag *diag, const char *path, const char *text, size_t size,
                     const SdlOptions *options, Scene **out);

#endif
