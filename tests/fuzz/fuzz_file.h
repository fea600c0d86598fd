/* What the fuzz targets of the file readers share: the input as a file in memory, and a place
 * for messages.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_TESTS_FUZZ_FILE_H
#define PMS_TESTS_FUZZ_FILE_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void fuzz_drop_message(void *ctx, const char *text)
{
    (void)ctx;
    (void)text;
}

/* Return the name of a file that holds these bytes; the same one each time. */
static const char *fuzz_file(const uint8_t *data, size_t size)
{
    static char path[] = "/dev/shm/pms_fuzz_XXXXXX", name[32];
    static int fd = -1;
    if (fd < 0) {
        fd = mkstemp(path);
        if (fd < 0)
            abort();
        unlink(path); /* reached through the descriptor from now on */
        snprintf(name, sizeof name, "/proc/self/fd/%d", fd);
    }
    if (ftruncate(fd, 0) != 0 || pwrite(fd, data, size, 0) != (ssize_t)size)
        abort();
    return name;
}

#endif
