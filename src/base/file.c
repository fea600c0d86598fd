/* Files: read whole, written whole or not at all.  SPDX-License-Identifier: Apache-2.0 */
#include "base/file.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static Status refuse(Diag *diag, const char *verb, const char *path, int error)
{
    return diag_fail(diag, ERR_FILE, "cannot %s '%s': %s", verb, path, strerror(error));
}

static Status read_all(Diag *diag, int fd, const char *path, char *into, size_t size, size_t *got)
{
    *got = 0;
    while (*got < size) {
        ssize_t n = read(fd, into + *got, size - *got);
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0)
            return refuse(diag, "read", path, errno);
        if (n == 0)
            break;
        *got += (size_t)n;
    }
    return OK;
}

Status file_open_input(Diag *diag, const char *path, int *fd, size_t *size)
{
    *fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (*fd < 0)
        return refuse(diag, "open", path, errno);
    struct stat info;
    Status status = OK;
    if (fstat(*fd, &info) != 0)
        status = refuse(diag, "open", path, errno);
    else if (S_ISDIR(info.st_mode))
        status = diag_fail(diag, ERR_FILE, "'%s' is a directory, not a file", path);
    else if (!S_ISREG(info.st_mode))
        status = diag_fail(diag, ERR_FILE, "'%s' is not a regular file", path);
    if (status != OK)
        close(*fd);
    else
        *size = (size_t)info.st_size;
    return status;
}

Status file_read(Diag *diag, const char *path, size_t limit_bytes, Arena *arena, const char **text,
                 size_t *size)
{
    int fd;
    size_t wanted;
    TRY(file_open_input(diag, path, &fd, &wanted));
    Status status = OK;
    char *buffer = NULL;
    if (wanted > limit_bytes)
        status = diag_fail(diag, ERR_FILE, "'%s' has %zu bytes, more than the limit of %zu", path,
                           wanted, limit_bytes);
    else if (!(buffer = arena_alloc(arena, wanted + 1)))
        status = diag_no_memory(diag, path);
    else
        status = read_all(diag, fd, path, buffer, wanted, size);
    close(fd);
    *text = buffer;
    return status;
}

/* Put the path of the folder that a file is in, without links, into `out`; false if there is none.
 */
static bool folder_of(const char *path, char out[PATH_MAX])
{
    char folder[PATH_MAX];
    size_t length = (size_t)(path_base(path) - path);
    if (length >= sizeof folder)
        return false;
    memcpy(folder, path, length);
    folder[length] = '\0';
    return realpath(length ? folder : ".", out) != NULL;
}

bool file_is_same(const char *a, const char *b)
{
    struct stat of_a, of_b;
    if (stat(a, &of_a) == 0 && stat(b, &of_b) == 0)
        return S_ISREG(of_a.st_mode) && of_a.st_dev == of_b.st_dev && of_a.st_ino == of_b.st_ino;
    char in_a[PATH_MAX], in_b[PATH_MAX];
    return folder_of(a, in_a) && folder_of(b, in_b) && strcmp(in_a, in_b) == 0 &&
           strcmp(path_base(a), path_base(b)) == 0;
}

bool file_exists(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && S_ISREG(info.st_mode) && access(path, R_OK) == 0;
}

/* Resolve links, so that the rename replaces what a link points at and not the link. */
static Status choose_names(Diag *diag, const char *path, OutFile *out)
{
    char target[PATH_MAX];
    const char *final = realpath(path, target) ? target : path;
    int length = snprintf(out->path, sizeof out->path, "%s", final);
    int temp_length =
        snprintf(out->temp_path, sizeof out->temp_path, "%s.part%ld", final, (long)getpid());
    if (length >= (int)sizeof out->path || temp_length >= (int)sizeof out->temp_path)
        return diag_fail(diag, ERR_FILE, "the path '%.60s...' is too long", path);
    return OK;
}

Status out_begin(Diag *diag, const char *path, OutFile *out)
{
    struct stat info;
    bool is_there = stat(path, &info) == 0;
    if (is_there && S_ISDIR(info.st_mode))
        return diag_fail(diag, ERR_FILE, "cannot write '%s': it is a directory", path);
    /* A rename would put a plain file where the device or pipe was. */
    if (is_there && !S_ISREG(info.st_mode))
        return diag_fail(diag, ERR_FILE, "cannot write '%s': it is not a regular file", path);
    TRY(choose_names(diag, path, out));
    int fd = open(out->temp_path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (fd < 0 && errno == ENOENT)
        return diag_fail(diag, ERR_FILE, "cannot write '%s': its folder does not exist", path);
    if (fd < 0)
        return refuse(diag, "write", path, errno);
    close(fd);
    return OK;
}

Status out_commit(Diag *diag, OutFile *out)
{
    int fd = open(out->temp_path, O_RDONLY | O_CLOEXEC);
    bool is_safe = fd >= 0 && fsync(fd) == 0;
    int error = errno;
    if (fd >= 0)
        close(fd);
    if (is_safe && rename(out->temp_path, out->path) == 0)
        return OK;
    error = is_safe ? errno : error;
    out_discard(out);
    return refuse(diag, "write", out->path, error);
}

void out_discard(OutFile *out)
{
    unlink(out->temp_path);
}

/* Write all bytes to the file at `at`; returns 0 or the errno. */
static int write_all(const char *at, const void *bytes, size_t size)
{
    FILE *file = fopen(at, "wb");
    if (!file)
        return errno;
    int error = fwrite(bytes, 1, size, file) == size ? 0 : errno;
    if (fclose(file) != 0 && !error)
        error = errno;
    return error;
}

/* A device or a pipe is written as it stands: there is nothing to keep whole. */
static bool is_stream(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode);
}

Status file_write(Diag *diag, const char *path, const void *bytes, size_t size)
{
    OutFile out;
    bool is_direct = is_stream(path);
    if (!is_direct)
        TRY(out_begin(diag, path, &out));
    int error = write_all(is_direct ? path : out.temp_path, bytes, size);
    if (!error)
        return is_direct ? OK : out_commit(diag, &out);
    if (!is_direct)
        out_discard(&out);
    return refuse(diag, "write", path, error);
}

const char *path_base(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}

const char *path_extension(const char *path)
{
    const char *base = path_base(path);
    const char *dot = strrchr(base, '.');
    return dot && dot != base ? dot + 1 : "";
}
