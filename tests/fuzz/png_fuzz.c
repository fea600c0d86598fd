/* Fuzzing the PNG reader: any bytes must give an image or a message, never a crash or a hang.
 * SPDX-License-Identifier: Apache-2.0 */
#include "fuzz_file.h"
#include "image/png_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    Diag diag;
    Image image;
    diag_init(&diag, fuzz_drop_message, NULL);
    if (png_read(&diag, fuzz_file(data, size), &image) == OK)
        image_done(&image);
    diag_done(&diag);
    return 0;
}
