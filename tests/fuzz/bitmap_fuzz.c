/* Fuzzing the readers of image files: the first byte tells which one gets the rest.
 * SPDX-License-Identifier: Apache-2.0 */
#include "fuzz_file.h"
#include "image/bitmap.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    Diag diag;
    Bitmap bitmap;
    if (size == 0)
        return 0;
    diag_init(&diag, fuzz_drop_message, NULL);
    BitmapKind kind = (BitmapKind)(data[0] % BITMAP_KIND_COUNT);
    if (bitmap_read(&diag, fuzz_file(data + 1, size - 1), kind, &bitmap) == OK)
        bitmap_done(&bitmap);
    diag_done(&diag);
    return 0;
}
