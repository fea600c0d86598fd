/* The streams behind OpenEXRCore: reads and writes on a descriptor of ours, so that a full disk
 * or a short file is reported in the system's words.  SPDX-License-Identifier: Apache-2.0 */
#include "image/exr_int.h"

#include "base/mem.h"
#include "image/image.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static int64_t stream_size(exr_const_context_t context, void *user)
{
    (void)context;
    struct stat info;
    return fstat(((ExrStream *)user)->fd, &info) == 0 ? (int64_t)info.st_size : -1;
}

static int64_t stream_read(exr_const_context_t context, void *user, void *buffer, uint64_t size,
                           uint64_t offset, exr_stream_error_func_ptr_t error)
{
    (void)context;
    (void)error;
    ExrStream *stream = user;
    uint64_t got = 0;
    while (got < size) {
        ssize_t n = pread(stream->fd, (char *)buffer + got, size - got, (off_t)(offset + got));
        if (n < 0 && errno == EINTR)
            continue;
        if (n < 0) {
            stream->error = errno;
            return -1;
        }
        if (n == 0) {
            stream->is_truncated = true;
            break;
        }
        got += (uint64_t)n;
    }
    return (int64_t)got;
}

static int64_t stream_write(exr_const_context_t context, void *user, const void *buffer,
                            uint64_t size, uint64_t offset, exr_stream_error_func_ptr_t error)
{
    (void)context;
    (void)error;
    ExrStream *stream = user;
    uint64_t put = 0;
    while (put < size) {
        ssize_t n =
            pwrite(stream->fd, (const char *)buffer + put, size - put, (off_t)(offset + put));
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0) {
            stream->error = n < 0 ? errno : ENOSPC;
            return -1;
        }
        put += (uint64_t)n;
    }
    return (int64_t)put;
}

static void keep_message(exr_const_context_t context, exr_result_t code, const char *message)
{
    void *user = NULL;
    if (!context || exr_get_user_data(context, &user) != EXR_ERR_SUCCESS || !user)
        return;
    ExrStream *stream = user;
    stream->is_memory |= code == EXR_ERR_OUT_OF_MEMORY;
    if (!stream->message[0])
        snprintf(stream->message, sizeof stream->message, "%s", message ? message : "");
}

/* A context being written holds its lock when it complains, and asking it for its user data
 * would wait for that lock: of a write, the code and errno are enough. */
static void drop_message(exr_const_context_t context, exr_result_t code, const char *message)
{
    (void)context;
    (void)code;
    (void)message;
}

exr_context_initializer_t exr_stream_settings(ExrStream *stream, bool is_reading)
{
    exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    settings.error_handler_fn = is_reading ? keep_message : drop_message;
    settings.alloc_fn = mem_alloc;
    settings.free_fn = mem_free;
    settings.user_data = stream;
    settings.read_fn = stream_read;
    settings.size_fn = stream_size;
    settings.write_fn = stream_write;
    settings.max_image_width = settings.max_image_height = IMAGE_SIDE_MAX;
    settings.max_tile_width = settings.max_tile_height = IMAGE_SIDE_MAX;
    settings.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    return settings;
}

Status exr_refuse(Diag *diag, const char *verb, const char *path, const ExrStream *stream,
                  exr_result_t code)
{
    if (code == EXR_ERR_OUT_OF_MEMORY || stream->is_memory)
        return diag_no_memory(diag, path);
    const char *reason = stream->message[0] ? stream->message : exr_get_default_error_message(code);
    if (stream->error)
        reason = strerror(stream->error);
    else if (stream->is_truncated)
        reason = "the file ends too early";
    return diag_fail(diag, ERR_FILE, "cannot %s '%s': %s", verb, path, reason);
}
