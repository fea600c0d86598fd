/* Files: read whole, written whole or not at all.  SPDX-License-Identifier: Apache-2.0 */
#ifndef PMS_BASE_FILE_H
#define PMS_BASE_FILE_H

#include "base/arena.h"
#include "base/diag.h"

#include <stdbool.h>

enum { FILE_PATH_MAX = 4096 };

/* Read the file at `path` into `arena`, followed by a 0 byte that is not counted.
 *
 * limit_bytes  larger files are refused.
 * Fails with ERR_FILE (missing, a directory, unreadable, too large) or ERR_MEMORY; the
 * message has been given.  The file is closed when this returns. */
Status file_read(Diag *diag, const char *path, size_t limit_bytes, Arena *arena,
                 const char **text, size_t *size);

/* Open the regular file at `path` for reading into `*fd` (yours to close) and tell its size.
 * Fails with ERR_FILE: missing, unreadable, a directory, a pipe or device. */
Status file_open_input(Diag *diag, const char *path, int *fd, size_t *size);

/* Return true if `path` names something that can be opened as a regular file. */
bool file_exists(const char *path);

/* Return true if what is written to one path would replace what is written to the other: the same
 * name in the same folder, or two links to one file.  Devices and pipes replace nothing. */
bool file_is_same(const char *a, const char *b);

/* A file on its way: written under a temporary name beside its final one. */
typedef struct OutFile {
    char path[FILE_PATH_MAX];      /* where it will be */
    char temp_path[FILE_PATH_MAX]; /* where it is now; open this one */
} OutFile;

/* Choose the temporary name for `path` and create it empty.  A link stays a link: what it points
 * at is replaced.  Fails with ERR_FILE, also for a device or a pipe. */
Status out_begin(Diag *diag, const char *path, OutFile *out);

/* Flush the finished temporary file to disk and rename it.  On failure it is removed. */
Status out_commit(Diag *diag, OutFile *out);

/* Remove the temporary file. */
void out_discard(OutFile *out);

/* Write `size` bytes as the whole content of `path` (out_begin .. out_commit), or into the device
 * or pipe that it names. */
Status file_write(Diag *diag, const char *path, const void *bytes, size_t size);

/* Return the extension of `path` without its dot ("" if none), borrowed from `path`. */
const char *path_extension(const char *path);

/* Return the last component of `path`, borrowed from `path`. */
const char *path_base(const char *path);

#endif
