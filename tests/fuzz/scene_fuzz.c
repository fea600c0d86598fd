/* Fuzzing the scene reader: any bytes must give a scene or a message, never a crash or a hang.
 *
 * Seeds are the language cases; tests/fuzz/run.sh builds and runs it.  Includes are searched
 * as always, but the input is text in memory, so it can only include what lies on the paths.
 * SPDX-License-Identifier: Apache-2.0 */
#include "sdl/sdl.h"

#include <stddef.h>
#include <stdint.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void drop(void *ctx, const char *text)
{
    (void)ctx;
    (void)text;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    SdlOptions options = {.width = 32, .height = 24, .threads = 1, .max_tokens = 20000};
    Diag diag;
    Scene *scene;
    diag_init(&diag, drop, NULL);
    sdl_load_text(&diag, "fuzz.pms", (const char *)data, size, &options, &scene);
    scene_free(scene);
    diag_done(&diag);
    return 0;
}
