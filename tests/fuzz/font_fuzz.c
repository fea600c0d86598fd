/* Fuzzing fonts: any bytes must give outlines or a message, never a crash or a hang.
 * SPDX-License-Identifier: Apache-2.0 */
#include "fuzz_file.h"
#include "image/font.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    Diag diag;
    Font *font;
    Arena *arena = arena_new();
    diag_init(&diag, fuzz_drop_message, NULL);
    if (arena && font_open(&diag, fuzz_file(data, size), &font) == OK) {
        for (uint32_t character = ' '; character < 127; character++) {
            Glyph glyph;
            font_glyph(&diag, font, font_glyph_number(font, character), arena, &glyph);
        }
        font_close(font);
    }
    diag_done(&diag);
    arena_free(arena);
    return 0;
}
